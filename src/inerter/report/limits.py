"""What limits a study keeps, and what they cost, as lines for a terminal and tables for a page."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap

import numpy as np
import xarray as xr

from inerter.errors import StatusKind
from inerter.figures.labels import index_title, indices, layouts, one_method, swept_places, titled, with_unit
from inerter.report.tables import Cell, Row, Table


def limit_lines(results: xr.Dataset, index: str, width: int) -> Iterator[str]:
    """A line for each limit and layout; nothing where there are no limits, or where something is swept."""
    if not _has_limits(results):
        return
    for limit in results["limit"].values.tolist():
        yield f"  within {limit}:"
        for name in layouts(results):
            told = _told(one_method(results).sel(layout=name, index=index, limit=limit), index)
            yield from wrap(f"{name}: {told}", width, initial_indent="    ", subsequent_indent="      ")


def limit_tables(results: xr.Dataset) -> list[Table]:
    """For each index, what is limited in each layout's best design; none where there are no limits."""
    if not _has_limits(results):
        return []
    results = one_method(results)
    return [_table(results, index) for index in indices(results)]


def _has_limits(results: xr.Dataset) -> bool:
    return "limit" in results.dims and not swept_places(results)


def _table(results: xr.Dataset, index: str) -> Table:
    limits = results["limit"].values.tolist()
    rows = []
    for name in layouts(results):
        cells = []
        for limit in limits:
            value, _, cost = _told(results.sel(layout=name, index=index, limit=limit), index).partition(", ")
            cells.append(Cell(value, cost.replace(" -", " \N{MINUS SIGN}")))
        rows.append(Row(name, cells))
    caption = f"Limits of the designs that are best for {titled(index_title(results, index), index)}"
    return Table(caption, ["Layout", *limits], rows)


def _told(entry: xr.Dataset, index: str) -> str:
    """What is limited in a design, whether its limit holds it back, and what that costs."""
    value, cost = float(entry["limit_value"]), float(entry["limit_cost"])
    text = with_unit(value, str(entry["limit_unit"].item())).strip()
    if str(entry["status"].item()).startswith(StatusKind.INFEASIBLE.value):
        return f"{text}, the nearest design"
    if not bool(entry["limit_active"]):
        return text
    told = f"{text}, at its limit"
    return told if np.isnan(cost) else f"{told}: 1 % more of it changes {index} by {cost:+.2g} %"
