"""Tables of results, declared once: terminals, pages and CSV files show the same one in their own ways."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, isnan, nan
from typing import Any

from inerter.errors import Status
from inerter.formatting import (
    Scale,
    format_entry,
    format_number,
    format_quantity_in_table,
    format_uncertain,
    merge_alike,
    shows_error,
)

MISSING = "–"
_FORMULA = ("=", "+", "-", "@", "\t", "\r")  # beginnings of what a spreadsheet takes for a formula


@dataclass(frozen=True)
class Quantity:
    """Number in SI units with its standard `error` and its largest relative error `bound`.

    In a column whose numbers have a common unit, `scale` is that unit, which the caption or heading names.
    """

    value: float
    unit: str = ""
    error: float = nan
    bound: float = nan
    scale: Scale | None = None

    def beside(self, value: float, sampling: float = nan) -> Quantity:
        """Another value of a sample of which this one is the nominal, with its errors.

        All are off by the same part where random inputs make it, and by as much as the nominal one otherwise. The
        standard error `sampling` of a mean or quantile, in which that of random inputs is, takes its place; without
        random inputs it only limits the digits.
        """
        if not value or not self.value or not isfinite(value / self.value):
            return Quantity(value, self.unit)
        part = abs(value / self.value)
        error, bound = self.error * part, self.bound / part
        if not isfinite(sampling):
            return Quantity(value, self.unit, error, bound)
        if error > 0.0:
            return Quantity(value, self.unit, sampling, bound)
        return Quantity(value, self.unit, bound=max(sampling / abs(value), 0.0 if isnan(bound) else bound))

    def __str__(self) -> str:
        if self.scale is None:
            return format_quantity_in_table(self.value, self.unit, error=self.error, bound=self.bound)
        value, error = self.value * self.scale.factor, self.error * self.scale.factor
        if shows_error(value, error, self.bound):
            return format_uncertain(value, error, self.bound)
        return format_entry(value, self.bound) if isfinite(value) else format_number(value)


@dataclass(frozen=True)
class Shown:
    """Content with the text that people read in its place."""

    value: Any
    text: str

    def __str__(self) -> str:
        return self.text


Content = Quantity | Shown | str | float | int | bool | None


@dataclass(frozen=True)
class Cell:
    """Cell of a table: what it contains, and a remark below it."""

    content: Content = None
    remark: str = ""
    strong: bool = False

    @property
    def text(self) -> str:
        """The content as people read it."""
        return MISSING if self.content is None else str(self.content)


@dataclass(frozen=True)
class Column:
    """Column of a table: its heading for people, and its key in data files; one without either is not shown there.

    Texts of `words` are aligned to the left; `prose`, of one column at most, may wrap over several lines too. A
    terminal lists several columns in one, with the heading `listed`.
    """

    heading: str = ""
    key: str = ""
    words: bool = False
    prose: bool = False
    listed: str = ""
    only_on_pages: bool = False


@dataclass(frozen=True)
class Row:
    """Row of a table, a cell for each column; `status` is what makes its numbers doubtful, empty if nothing does.

    `remark` is what else is to be said of the row. A row that is not `shown` is in data files only.
    """

    cells: Sequence[Cell]
    strong: bool = False
    status: str = ""
    remark: str = ""
    shown: bool = True


@dataclass(frozen=True)
class Table:
    """Table with its caption; its first columns, `labels` in number, contain the labels of the rows."""

    caption: str
    columns: Sequence[Column]
    rows: Sequence[Row]
    swept: bool = False
    failures: Sequence[str] = field(default=())
    labels: int = 1

    @property
    def shown(self) -> list[Column]:
        """Columns for people."""
        return [column for column in self.columns if column.heading]

    def shown_rows(self) -> Iterator[tuple[Row, list[Cell]]]:
        """Rows for people, each with its cells in the columns for people."""
        for row in self.rows:
            if row.shown:
                yield row, [cell for column, cell in zip(self.columns, row.cells, strict=True) if column.heading]

    def with_merged_doubts(self) -> Table:
        """Table in which a doubt of several rows, alike but for its numbers, is said once, below them."""
        rows, below = list(self.rows), list(self.failures)
        doubtful = [i for i, row in enumerate(rows) if row.shown and Status.parts(row.status)[1]]
        for text, places in merge_alike([rows[i].status for i in doubtful]):
            if len(places) > 1:
                alike = [doubtful[place] for place in places]
                labels = dict.fromkeys(" ".join(cell.text for cell in rows[i].cells[: self.labels]) for i in alike)
                below.append(f"{'; '.join(labels)}: {text}")
                for i in alike:
                    rows[i] = replace(rows[i], status=f"{Status.parts(text)[0]}: see below")
        return replace(self, rows=rows, failures=below)

    @property
    def has_verdict(self) -> bool:
        """Whether the last column is a verdict in words, which remains visible while the others scroll."""
        return bool(self.rows) and self.shown[-1].prose


def cells(*contents: Content) -> list[Cell]:
    """Cells without remarks."""
    return [Cell(content) for content in contents]


def columns(*headings: str) -> list[Column]:
    """Columns for people only."""
    return [Column(heading) for heading in headings]


def csv_rows(table: Table) -> Iterator[list[Any]]:
    """Keys and contents of a table for a data file: the header, then the rows."""
    kept = [i for i, column in enumerate(table.columns) if column.key]
    yield [table.columns[i].key for i in kept]
    for row in table.rows:
        contents = (row.cells[i].content for i in kept)
        yield [one.value if isinstance(one, Quantity | Shown) else one for one in contents]


def records(table: Table) -> list[dict[str, Any]]:
    """Rows of a table as dictionaries by the keys of its columns."""
    keys, *rows = csv_rows(table)
    return [dict(zip(map(str, keys), row, strict=True)) for row in rows]


def csv_text(rows: Iterable[Sequence[object]]) -> str:
    """Rows as CSV, see `csv_cells`."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(map(csv_cells, rows))
    return text.getvalue()


def csv_cells(row: Iterable[object]) -> list[object]:
    """Cells of a row of CSV: the shortest text that is read back as the same number, empty for a missing number.

    A text that a spreadsheet would take for a formula is quoted.
    """
    return [_csv_cell(one) for one in row]


def _csv_cell(one: object) -> object:
    if isinstance(one, float):
        return "" if isnan(one) else repr(float(one))
    if isinstance(one, str):
        return f"'{one}" if one.startswith(_FORMULA) else one
    return "" if one is None else one
