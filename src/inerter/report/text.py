"""Results as plain text for a terminal of 80 columns: paragraphs, and tables in columns that fit."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from textwrap import wrap

from inerter.report.sections import Section
from inerter.table import MISSING, Cell, Column, Row, Table

WIDTH = 80
_NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
_MEASURED = re.compile(r"\S+ \+- \S+( [^\s,.;)]+)?|\d %")
_NARROWEST = 16  # of a column that wraps, which goes beyond the width where numbers are enormous
_LONGEST_LABEL = 20  # a longer label of a row has a separate line
_GAP = "  "


def wrap_text(text: str, width: int = WIDTH, **indents: str) -> list[str]:
    """Lines of a text for a terminal, without breaks between a number, its standard error and its unit."""
    joined = _MEASURED.sub(lambda found: found[0].replace(" ", _NO_BREAK_SPACE), text)
    return [line.replace(_NO_BREAK_SPACE, " ") for line in wrap(joined, width, **indents)]  # type: ignore[arg-type]


def section_text(sections: Iterable[Section]) -> str:
    """Tables and remarks of the sections of results: ASCII but for names and titles, at most 80 columns."""
    blocks = ["\n".join(block) for section in sections for block in _blocks(section)]
    return "\n\n".join(blocks)


def _blocks(section: Section) -> Iterator[list[str]]:
    for table in section.tables if section.brief is None else section.brief:
        yield list(table_lines(table))
    if section.remarks:
        yield [line for remark in section.remarks for line in wrap_text(remark, subsequent_indent=_GAP)]


def table_lines(table: Table, width: int = WIDTH) -> Iterator[str]:
    """Lines of a table: caption, header and rows; in several parts if it does not fit in `width`.

    Columns that are listed become items "heading = text" of the last one. The reason for a doubt stands below its row.
    """
    table = table.with_merged_doubts()
    yield from wrap(table.caption, width, subsequent_indent=_GAP * 2)
    grid, labels, keys = _with_labels(_grid(table), width, table.labels)
    if not grid.columns[keys:]:
        yield from _lines(grid, labels, width)
    while grid.columns[keys:]:
        count = max(_count_fitting(grid, width), keys + 1)
        yield from _lines(replace(grid, columns=grid.columns[:count]), labels, width)
        rows = [replace(row, status="", remark="") for row in grid.rows]
        grid = _Grid(rows, [*grid.columns[:keys], *grid.columns[count:]])
    for line in table.failures:
        yield from wrap(line, width, initial_indent=f"{_GAP * 2}! ", subsequent_indent=_GAP * 3)


@dataclass(frozen=True)
class _TextColumn:
    """Heading, and for each row the text and the remark below it; one that wraps has items that stay together."""

    heading: str
    cells: Sequence[tuple[str, str]]
    items: Sequence[Sequence[str]] = ()

    @property
    def wraps(self) -> bool:
        return bool(self.items)

    def width(self, cut_heading: bool) -> int:
        """Width of its longest text, and of its heading, which may break at spaces."""
        heading = self.heading.split() if cut_heading else [self.heading]
        return max(map(len, [*heading, *(text for cell in self.cells for text in cell)]))

    def with_short_labels(self, longest: int = _LONGEST_LABEL) -> _TextColumn:
        """Column without its texts longer than `longest`, which stand on separate lines."""
        return replace(self, cells=[("" if len(text) > longest else text, "") for text, _ in self.cells])


@dataclass(frozen=True)
class _Grid:
    """Rows of a table and its columns as text, the labels first."""

    rows: Sequence[Row]
    columns: Sequence[_TextColumn]


def _grid(table: Table) -> _Grid:
    shown = list(table.shown_rows())
    heads = [(i, column) for i, column in enumerate(table.shown) if not column.only_on_pages]
    made = [_text_column(c, [cells[i] for _, cells in shown]) for i, c in heads if not c.listed]
    listed = [(i, column) for i, column in heads if column.listed]
    if listed:
        items = [
            [_item(column, cells[i]) for i, column in listed if cells[i].content is not None] for _, cells in shown
        ]
        made.append(_TextColumn(listed[0][1].listed, [("", "")] * len(shown), items))
    return _Grid([row for row, _ in shown], made)


def _text_column(column: Column, cells: Sequence[Cell]) -> _TextColumn:
    if column.prose:
        items = [_ascii(cell.text).split(", ") for cell in cells]
        return _TextColumn(column.heading, [("", "")] * len(cells), items)
    return _TextColumn(column.heading, [(_ascii(cell.text), cell.remark) for cell in cells])


def _item(column: Column, cell: Cell) -> str:
    return f"{column.heading} = {cell.text}{f' ({cell.remark})' if cell.remark else ''}"


def _with_labels(grid: _Grid, width: int, count: int) -> tuple[_Grid, list[str], int]:
    """Grid whose labels leave room for its numbers, all labels, and the number of columns before every part of it.

    These are `count` where labels repeat, two at least; labels without room stand on a line above each row.
    """
    first, *others = grid.columns
    labels = [text for text, _ in first.cells]
    if _total_width(grid.columns, cut_headings=True) > width:
        first = first.with_short_labels()
    keyed = replace(grid, columns=[first, *others])
    keys, numbers = others[: max(count, 2) - 1], others[max(count, 2) - 1 :]
    if len(set(labels)) == len(labels) or not numbers or any(column.wraps for column in keys):
        return keyed, labels, 1
    if all(_total_width([first, *keys, one], cut_headings=True) <= width for one in numbers):
        return keyed, labels, 1 + len(keys)
    whole = zip(labels, *([text for text, _ in column.cells] for column in keys), strict=True)
    return replace(grid, columns=[first.with_short_labels(0), *numbers]), [_GAP.join(one) for one in whole], 1


def _count_fitting(grid: _Grid, width: int) -> int:
    """Number of columns that fit into `width` side by side, two at least."""
    counts = range(len(grid.columns), 2, -1)
    return next((count for count in counts if _total_width(grid.columns[:count], cut_headings=True) <= width), 2)


def _total_width(columns: Sequence[_TextColumn], *, cut_headings: bool) -> int:
    widths = [_NARROWEST if column.wraps else column.width(cut_headings) for column in columns]
    return sum(widths) + len(_GAP) * len(widths)


def _lines(grid: _Grid, labels: Sequence[str], width: int) -> Iterator[str]:
    """Lines of columns side by side, below their headings, which break at spaces only if need be."""
    cut = _total_width(grid.columns, cut_headings=True) <= width < _total_width(grid.columns, cut_headings=False)
    widths = [column.width(cut) for column in grid.columns if not column.wraps]
    rest = max(width - len(_GAP) * (len(widths) + 1) - sum(widths), _NARROWEST)
    spaces = [rest if c.wraps else c.width(cut) for c in grid.columns]
    headings = [
        wrap(c.heading, space, break_long_words=False, break_on_hyphens=False) or [""]
        for c, space in zip(grid.columns, spaces, strict=True)
    ]
    yield from _side_by_side(headings, widths)
    for i, row in enumerate(grid.rows):
        cells = [_pack_items(c.items[i], rest) if c.wraps else [t for t in c.cells[i] if t] for c in grid.columns]
        if labels[i] and not cells[0]:
            yield from wrap_text(labels[i], width, initial_indent=_GAP, subsequent_indent=_GAP * 2)
        yield from _side_by_side(cells, widths)
        if row.status:
            yield from wrap(row.status, width, initial_indent=f"{_GAP * 2}! ", subsequent_indent=_GAP * 3)
        if row.remark:
            yield from wrap(row.remark, width, initial_indent=_GAP * 3, subsequent_indent=_GAP * 3)


def _ascii(text: str) -> str:
    return text.replace(MISSING, "-")


def _side_by_side(cells: Sequence[Sequence[str]], widths: Sequence[int]) -> Iterator[str]:
    """Lines of cells that have several lines each; the last one may have no width."""
    for line in zip_longest(*cells, fillvalue=""):
        padded = [f"{text:<{width}}" for text, width in zip_longest(line, widths[: len(line)], fillvalue=0)]
        yield f"{_GAP}{_GAP.join(padded)}".rstrip()


def _pack_items(items: Sequence[str], width: int) -> list[str]:
    """The items, separated by commas, on lines of `width`; a line ends between two items where it can."""
    lines: list[str] = []
    for i, item in enumerate(items):
        text = item if i == len(items) - 1 else f"{item},"
        if lines and len(lines[-1]) + 1 + len(text) <= width:
            lines[-1] += f" {text}"
        else:
            lines += wrap_text(text, width)
    return lines
