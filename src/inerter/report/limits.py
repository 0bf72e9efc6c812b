"""Constraints of a study and their sensitivities, as tables."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from inerter.figures.labels import (
    index_words,
    indices,
    infeasible,
    layouts,
    one_method,
    swept_places,
    swept_text,
    swept_words,
)
from inerter.formatting import format_list, format_quantity, format_share
from inerter.table import Column, Content, Quantity, Row, Shown, Table, cells

_MOST_RANGES = 3  # of swept values, in a remark


def limit_tables(results: xr.Dataset) -> list[Table]:
    """Table of the limited quantities of each layout's best designs; empty without limits.

    Over a sweep there is one per index, of the values at which each constraint is active, and those without a feasible
    design.
    """
    if "limit" not in results.dims:
        return []
    results = one_method(results)
    return [_swept_table(results, index) for index in indices(results)] if swept_places(results) else [_table(results)]


def _table(results: xr.Dataset) -> Table:
    limits, names = results["limit"].values.tolist(), indices(results)
    shown = [len(names) > 1, len(limits) > 1]  # what the rows name, beside the layout
    rows = [
        Row(
            cells(
                layout,
                *([index] if shown[0] else []),
                *([_words(results, limit)] if shown[1] else []),
                *_describe_limit(_entry(results, layout, index, limit), index),
            )
        )
        for index in names
        for layout in layouts(results)
        for limit in limits
    ]
    heads = [
        Column("Layout"),
        *([Column("Best for", words=True)] if shown[0] else []),
        *([Column("Limit", words=True)] if shown[1] else []),
        *(Column("Value"), Column("Effect of the limit", prose=True)),
    ]
    return Table(f"{_caption(results, names)}{_basis(results)}", heads, rows, labels=1 + sum(shown))


def _swept_table(results: xr.Dataset, index: str) -> Table:
    rows = []
    for name in layouts(results):
        for limit in results["limit"].values.tolist():
            entry = _entry(results, name, index, limit)
            at = _where(entry, entry["limit_active"].values & ~infeasible(entry).values) or ("nowhere", "")
            rows.append(Row(cells(name, _words(results, limit), *at)))
        rows.append(Row(cells(name, "all limits", *_describe_infeasible(_entry(results, name, index)))))
    heads = [Column("Layout"), *(Column(name, words=True) for name in ("Limit", "Active")), Column("Where", prose=True)]
    caption = f"Limits of the designs that are best for {index_words(results, index)}{_basis(results)}"
    return Table(f"{caption}, over {' and '.join(swept_words(results))}", heads, rows)


def _caption(results: xr.Dataset, names: Sequence[str]) -> str:
    """Caption of the table without a sweep, which names what its rows do not: one index, one limit."""
    limits = results["limit"].values.tolist()
    of = f"designs that are best for {index_words(results, names[0])}" if len(names) == 1 else "best designs"
    return f"Limits of the {of}" if len(limits) > 1 else f"Limit of the {of}: {_words(results, limits[0])}"


def _basis(results: xr.Dataset) -> str:
    basis = results["limit_value"].attrs["basis"]
    return f"; values {basis}" if basis else ""


def _words(results: xr.Dataset, limit: str) -> str:
    return str(results["limit.words"].sel(limit=limit).item())


def _entry(results: xr.Dataset, layout: str, index: str, limit: str | None = None) -> xr.Dataset:
    where = {"layout": layout, "index": index} | ({} if limit is None else {"limit": limit})
    return one_method(results).sel(where)


def _describe_limit(entry: xr.Dataset, index: str) -> tuple[Content, str]:
    """Value of a limited quantity, and the sensitivity to an active limit."""
    value, cost, part = float(entry["limit_value"]), float(entry["limit_cost"]), str(entry["limit.part"].item())
    unit, active = str(entry["limit_unit"].item()), bool(entry["limit_active"])
    # a search ends so near an active limit that only zeros would tell the value from it
    errors = float(entry["limit.standard_error"]), float(entry["limit.error_bound"])
    quantity = Shown(value, format_quantity(value, unit)) if active else Quantity(value, unit, *errors)
    content = f"{quantity} ({part})" if part else quantity
    if bool(infeasible(entry)):
        return content, "value of the closest design"
    if not active:
        return content, "not reached"
    if np.isnan(cost):
        return content, "at its limit"
    return content, f"raising it by 1 % changes {index} by {format_share(cost / 100.0, 2, '+')}"


def _describe_infeasible(entry: xr.Dataset) -> tuple[str, str]:
    """At how many swept values no design is feasible, and where."""
    count, where = _where(entry, infeasible(entry).values) or ("", "")
    return (f"no feasible design {count}", where) if count else ("feasible everywhere", "")


def _where(entry: xr.Dataset, wanted: NDArray[np.bool_]) -> tuple[str, str] | None:
    """Number of swept values, or points of a map, and the ranges of those values; None if there is none."""
    if not wanted.any():
        return None
    count, size = int(wanted.sum()), wanted.size
    places = swept_places(entry)
    if len(places) > 1:
        return f"at {'all' if count == size else f'{count} of'} {size} points", ""
    (words,), (place,) = swept_words(entry), places
    if count == size:
        return f"at all {size} values", ""
    order = np.argsort(entry[place].values)
    runs = [
        [i for _, i in run]
        for holds, run in groupby(zip(wanted[order], order, strict=True), lambda one: one[0])
        if holds
    ]
    ends = [[float(entry[place][i]) for i in dict.fromkeys((run[0], run[-1]))] for run in runs]
    ranges = [" to ".join(swept_text(entry, place, end) for end in pair) for pair in ends]
    remark = f"{words} = {format_list(ranges)}" if len(ranges) <= _MOST_RANGES else ""
    return f"at {count} of {size} values", remark
