"""What becomes of the best designs when values scatter, as lines for a terminal and a table for a page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

import numpy as np
import xarray as xr

from inerter.figures.labels import index_title, printed, with_unit
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
        doubt = "" if one.ok else f"not certain ({one.status}: {one.message}): "
        text = f"{one.layout} {one.index}: {doubt + told if one.numbers else f'{one.status}: {one.message}'}"
        yield from wrap(text, width, initial_indent="  ", subsequent_indent="    ")


def tolerance_tables(found: Sequence[ToleranceOutcome]) -> list[Table]:
    """One table, a row for each design; none where nothing scatters."""
    rows = []
    for one in found:
        cells = [Cell(text) for text in _numbers(one, printed)]
        status = "" if one.ok else f"{one.status}: {one.message}"
        rows.append(Row(f"{one.layout}, {one.index}", [*cells, Cell(_due(one), prose=True)], status=status))
    return [Table("Best designs when values scatter", ["Design", *_HEADER], rows)] if rows else []


def tolerance_sentences(
    results: xr.Dataset, found: Sequence[ToleranceOutcome], write: Writer = with_unit
) -> Iterator[str]:
    """For each index that scatters the layout with the lowest quantile, and those of which there is none."""
    for index in dict.fromkeys(one.index for one in found):
        own = [one for one in found if one.index == index]
        title = index_title(results, index)
        known = [one for one in own if np.isfinite(one.numbers.get("quantile", np.nan))]
        told = [_best_sentence(title, known, results.attrs["baseline"], write)] if known else []
        told += [
            f"No answer for {title} of {one.layout} when values scatter: {one.message.rstrip('.')}."
            for one in own
            if one not in known
        ]
        yield " ".join(told)


def _best_sentence(title: str, known: Sequence[ToleranceOutcome], baseline: str | None, write: Writer) -> str:
    """The layout with the lowest quantile, compared with the baseline, and with the order of nominal designs."""
    by_quantile = sorted(known, key=lambda one: one.numbers["quantile"])
    best, nominal = by_quantile[0], min(known, key=lambda one: one.numbers["nominal"])
    _, deviation, quantile, worst = _numbers(best, write)
    base = next((one for one in known if one.layout == baseline), None)
    compared = ""
    if base is not None and base is not best and base.numbers["quantile"] > 0.0:
        part = 100.0 * (1.0 - best.numbers["quantile"] / base.numbers["quantile"])
        compared = f", {part:.3g} % better than {base.layout}, which scatters too"
    elif base is best and len(known) > 1:
        compared = "; no other layout is better than this baseline"
    due = f", mostly due to {next(iter(_shares(best)))[1]}" if best.effects else ""
    order = f" Without scatter {nominal.layout} is best." if nominal is not best else ""
    doubts = dict.fromkeys(one.message.rstrip(".") for one in known if not one.ok)
    certain = "".join(f"Not certain: {doubt}. " for doubt in doubts)
    return (
        f"{certain}Best {title} when values scatter, by what {100 * SHARE:g} % of cases stay below: {best.layout}, "
        f"{quantile.strip()}{compared}; standard deviation {deviation.strip()}{due}, worst {worst.strip()}.{order}"
    )


def _shares(one: ToleranceOutcome) -> list[tuple[float, str]]:
    """Parts of the variance with the values that they are due to, the largest first."""
    return sorted(((total, name) for name, (_, total) in one.effects.items()), reverse=True)


def _numbers(one: ToleranceOutcome, write: Writer) -> list[str]:
    nan = float("nan")
    return [write(one.numbers.get(name, nan), one.unit, nan) for name in _NUMBERS]


def _due(one: ToleranceOutcome) -> str:
    """What the scatter is due to, the largest part first."""
    return ", ".join(f"{name} {100.0 * max(total, 0.0):.0f} %" for total, name in _shares(one)) or "–"
