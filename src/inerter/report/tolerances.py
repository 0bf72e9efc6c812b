"""What becomes of the best designs when values scatter, as lines for a terminal and a table for a page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from inerter.figures.labels import printed, with_unit
from inerter.files.study.tolerances import SHARE, ToleranceOutcome
from inerter.report.findings import Writer
from inerter.report.tables import Cell, Row, Table

_NUMBERS = ("mean", "standard_deviation", "quantile", "worst")
_HEADER = ("Mean", "Standard deviation", f"{100 * SHARE:g} % of cases below", "Worst", "Due to")


def tolerance_lines(found: Sequence[ToleranceOutcome], width: int) -> Iterator[str]:
    """A line for each design; nothing where nothing scatters."""
    if found:
        yield ""
        yield "when values scatter:"
    for one in found:
        mean, deviation, quantile, worst = _numbers(one, with_unit)
        told = (
            f"mean {mean}, standard deviation {deviation}, {100 * SHARE:g} % of cases below {quantile}, worst {worst}; "
            f"due to {_due(one)}"
        )
        text = f"{one.layout} {one.index}: {told if one.numbers else f'{one.status}: {one.message}'}"
        yield from wrap(text, width, initial_indent="  ", subsequent_indent="    ")


def tolerance_tables(found: Sequence[ToleranceOutcome]) -> list[Table]:
    """One table, a row for each design; none where nothing scatters."""
    rows = []
    for one in found:
        cells = [Cell(text) for text in _numbers(one, printed)]
        status = "" if one.ok else f"{one.status}: {one.message}"
        rows.append(Row(f"{one.layout}, {one.index}", [*cells, Cell(_due(one), prose=True)], status=status))
    return [Table("Best designs when values scatter", ["Design", *_HEADER], rows)] if rows else []


def _numbers(one: ToleranceOutcome, write: Writer) -> list[str]:
    nan = float("nan")
    return [write(one.numbers.get(name, nan), one.unit, nan) for name in _NUMBERS]


def _due(one: ToleranceOutcome) -> str:
    """What the scatter is due to, the largest part first."""
    parts = sorted(((total, name) for name, (_, total) in one.effects.items()), reverse=True)
    return ", ".join(f"{name} {100.0 * max(total, 0.0):.0f} %" for total, name in parts) or "–"
