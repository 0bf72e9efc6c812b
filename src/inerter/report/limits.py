"""Constraints of a study and their sensitivities, as lines for a terminal and tables for a page."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from textwrap import wrap

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from inerter.figures.labels import (
    format_list,
    index_title,
    indices,
    infeasible,
    layouts,
    one_method,
    swept_places,
    swept_text,
    swept_words,
    title_with_name,
)
from inerter.formatting import format_quantity, typeset, typeset_quantity
from inerter.report.problem_statement import of_each
from inerter.table import Cell, Row, Table, Writer

_MOST_RANGES = 3  # of swept values, in a remark


def limit_lines(results: xr.Dataset, index: str, width: int) -> Iterator[str]:
    """Lines, one for each limit and layout; empty without limits."""
    if "limit" not in results.dims:
        return
    for limit in results["limit"].values.tolist():
        yield from wrap(f"within {_limit_text(results, limit)}:", width, initial_indent="  ", subsequent_indent="    ")
        for name in layouts(results):
            told = ", ".join(filter(None, _describe_limit(_entry(results, name, index, limit), index)))
            yield from wrap(f"{name}: {told}", width, initial_indent="    ", subsequent_indent="      ")
    for name in layouts(results) if swept_places(results) else ():
        none = _where(_entry(results, name, index), _is_infeasible(_entry(results, name, index)))
        if none[0]:
            text = f"no feasible {name} {none[0]}{f', {none[1]}' if none[1] else ''}"
            yield from wrap(text, width, initial_indent="  ", subsequent_indent="    ")


def limit_tables(results: xr.Dataset) -> list[Table]:
    """Tables of the limited quantities of each layout's best design, one per index; empty without limits.

    Over a sweep, the values at which each constraint is active, and those without a feasible design.
    """
    return [_table(one_method(results), index) for index in indices(results)] if "limit" in results.dims else []


def _table(results: xr.Dataset, index: str) -> Table:
    limits, swept = results["limit"].values.tolist(), bool(swept_places(results))
    rows = []
    for name in layouts(results):
        told = [_describe_limit(_entry(results, name, index, limit), index, typeset_quantity) for limit in limits]
        entry = _entry(results, name, index)
        told += [_where(entry, _is_infeasible(entry), typeset_quantity)] if swept else []
        rows.append(Row(name, [Cell(text or "–", remark.replace(" -", " \N{MINUS SIGN}")) for text, remark in told]))
    caption = f"Limits of the designs that are best for {title_with_name(index_title(results, index), index)}"
    over = f", over {' and '.join(swept_words(results))}" if swept else ""
    return Table(
        f"{caption}{over}",
        ["Layout", *(_limit_text(results, limit) for limit in limits), *(["No design keeps all"] if swept else [])],
        rows,
    )


def _limit_text(results: xr.Dataset, limit: str) -> str:
    """Limit in words, with the part to which it applies if to each separately."""
    name, space, value = limit.partition(" ")
    return f"{of_each(name, str(results['limit.each'].sel(limit=limit).item()))}{space}{typeset(value)}"


def _entry(results: xr.Dataset, layout: str, index: str, limit: str | None = None) -> xr.Dataset:
    where = {"layout": layout, "index": index} | ({} if limit is None else {"limit": limit})
    return one_method(results).sel(where)


def _describe_limit(entry: xr.Dataset, index: str, write: Writer = format_quantity) -> tuple[str, str]:
    """Value of a limited quantity, and a text on an active limit and its sensitivity; over a sweep, where active."""
    if swept_places(entry):
        where, which = _where(entry, entry["limit_active"].values & ~_is_infeasible(entry), write)
        return (f"at its limit {where}", which) if where else ("nowhere at its limit", "")
    value, cost = float(entry["limit_value"]), float(entry["limit_cost"])
    part = str(entry["limit.part"].item())
    text = format_quantity(value, str(entry["limit_unit"].item())).strip() + (f" ({part})" if part else "")
    if bool(infeasible(entry)):
        return text, "the nearest design"
    if not bool(entry["limit_active"]):
        return text, ""
    return text, "at its limit" + ("" if np.isnan(cost) else f": 1 % more of it changes {index} by {cost:+.2g} %")


def _is_infeasible(entry: xr.Dataset) -> NDArray[np.bool_]:
    return np.asarray(infeasible(entry).values)


def _where(entry: xr.Dataset, wanted: NDArray[np.bool_], write: Writer = format_quantity) -> tuple[str, str]:
    """Number of swept values, or points of a map, and the ranges of those values, as text; empty if none."""
    if not wanted.any():
        return "", ""
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
    told = [" to ".join(swept_text(entry, place, end, write) for end in pair) for pair in ends]
    return f"at {count} of {size} values", f"{words} = {format_list(told)}" if len(told) <= _MOST_RANGES else ""
