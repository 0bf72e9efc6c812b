"""The tables of a report as rows of text: best designs, trade-offs, and values over a sweep."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from inerter.errors import StatusKind
from inerter.figures.labels import (
    bound_of,
    by_method,
    by_which,
    compared_layouts,
    design_quantity,
    error_of,
    flat_range,
    improvement_over_baseline,
    improvement_text,
    index_unit,
    index_words,
    indices,
    infeasible,
    layouts,
    marked_layouts,
    method_label,
    methods,
    one_method,
    swept_element,
    swept_places,
    swept_scale,
    swept_words,
)
from inerter.files.study.design_numbers import NUMBER, number_entry, numbers_in
from inerter.files.study.running import DATASET, SUMMARY
from inerter.formatting import Scale, capital, choose_scale, format_number, format_percent, format_quantity
from inerter.report.index_summary import extremes, is_compared, place_text
from inerter.report.verdicts import best_layouts
from inerter.table import Cell, Column, Quantity, Row, Table, columns

_MOST_SWEPT = 16  # rows of a table over a sweep
_MOST_ON_A_TERMINAL = 6  # values of a sweep; of more, the best and the worst
_MOST_ACROSS = 9  # columns of a map
_MOST_BETWEEN = 100  # swept values between two of them
_MOST_FAILURES = 20


def tables_of(results: xr.Dataset) -> list[Table]:
    """Tables of a study: of its designs, or over one or two swept places."""
    return (design_tables, sweep_tables, map_tables)[len(swept_places(results))](results)


def design_tables(results: xr.Dataset) -> list[Table]:
    """Tables of the best design of every layout, one per index."""
    results = one_method(results)
    return [_design_table(results, index) for index in indices(results)]


def trade_off_tables(results: xr.Dataset) -> list[Table]:
    """Tables of all indices at the best designs, one per index; empty with a single index."""
    results = one_method(results)
    return [_trade_off_table(results, index) for index in indices(results)] if len(indices(results)) > 1 else []


def sweep_tables(results: xr.Dataset) -> list[Table]:
    """Tables of value and improvement of every layout at some of the swept values, one per index and method."""
    if len(methods(results)) < 2:
        return [_sweep_table(one_method(results), index) for index in indices(results)]
    return [
        _sweep_table(by_method(results, method), index, f", {method_label(results, method)}")
        for index in indices(results)
        for method in methods(results)
    ]


def map_tables(results: xr.Dataset) -> list[Table]:
    """Tables of the improvement, or the value, at some pairs of swept values, one per index and layout."""
    results = one_method(results)
    names = compared_layouts(results) or layouts(results)
    return [_map_table(results, index, name) for index in indices(results) for name in names]


def _design_table(results: xr.Dataset, index: str) -> Table:
    at_index, versus = results.sel(index=index), bool(compared_layouts(results))
    parameters = at_index["parameter_value"].dropna("parameter", how="all")["parameter"].values.tolist()
    searched, best = is_searched(at_index), next(iter(best_layouts(results, index)), None)
    rows, numbers = [], numbers_in(results)
    for name in layouts(results):
        design = at_index.sel(layout=name)
        cells = [
            Cell(name),
            Cell(design_quantity(design, index_unit(results, index))),
            *([Cell(improvement_over_baseline(design) or "baseline")] if versus else []),
            *(_number(name, design) for name in numbers),
            *(_parameter(design.sel(parameter=parameter)) for parameter in parameters),
            *([Cell(f"{int(design['agreed'])} of {int(design['starts'])}")] if searched else []),
        ]
        rows.append(Row(cells, name == best, problem_of(str(design["status"].item()))))
    heads = [
        *columns("Layout", index, *(["Improvement"] if versus else [])),
        *columns(*(str(at_index[f"{NUMBER}{name}.value"].attrs["heading"]) for name in numbers)),
        *(Column(parameter, listed="Parameters") for parameter in parameters),
        *([Column("Agreement", only_on_pages=True)] if searched else []),
    ]
    what = f"Best for {index_words(results, index)}" if searched else capital(index_words(results, index))
    return Table(f"{what}{by_which(results)}", heads, rows)


def _number(name: str, design: xr.Dataset) -> Cell:
    """Number of a design, with a doubt about it."""
    value, bound, status = (one.item() for one in number_entry(name, design).values())
    unit = design[f"{NUMBER}{name}.value"].attrs["units"]
    return Cell(Quantity(value, unit, bound=bound), problem_of(status))


def is_searched(results: xr.Dataset) -> bool:
    """Whether designs were optimised."""
    return bool((results["starts"] > 0).any())


def _parameter(entry: xr.Dataset) -> Cell:
    value, bound = float(entry["parameter_value"]), str(entry["at_bound"].item())
    if np.isnan(value):
        return Cell()
    flat = flat_range(entry)
    remark = f"at its {bound} bound" if bound else f"{flat} are as good" if flat else ""
    return Cell(Quantity(value, str(entry["parameter_unit"].item())), remark)


def _trade_off_table(results: xr.Dataset, index: str) -> Table:
    others = results["other"].values.tolist()
    rows = []
    for name in layouts(results):
        design = results.sel(layout=name, index=index)
        missed = "infeasible" if bool(infeasible(design)) else ""
        cells = [
            Cell(_other(results, design.sel(other=other), other), missed * (other == index), strong=other == index)
            for other in others
        ]
        missing = [other for other in others if np.isnan(design["other_value"].sel(other=other).item())]
        reasons = {other: problem_of(str(results["status"].sel(layout=name, index=other).item())) for other in missing}
        rows.append(Row([Cell(name), *cells], status="; ".join(f"{o}: {why}" for o, why in reasons.items() if why)))
    caption = f"Designs that are best for {index_words(results, index)}{by_which(results)}"
    return Table(caption, columns("Layout", *others), rows)


def _other(results: xr.Dataset, design: xr.Dataset, other: str) -> Quantity:
    errors = (error_of(design, "other"), bound_of(design, "other"))
    return Quantity(float(design["other_value"]), index_unit(results, other), *errors)


def is_short(results: xr.Dataset) -> bool:
    """Whether a terminal has room for all values of the sweep."""
    return math.prod(results.sizes[place] for place in swept_places(results)) <= _MOST_ON_A_TERMINAL


def extreme_tables(results: xr.Dataset) -> list[Table]:
    """Tables of the best and the worst of every layout over the sweep, one per index: a summary of its tables.

    Compared with a baseline these are the improvements, with the values of the index there.
    """
    results = one_method(results)
    return [_extreme_table(results, index) for index in indices(results)]


def _extreme_table(results: xr.Dataset, index: str) -> Table:
    versus = is_compared(results, index)
    data, unit = results.sel(index=index), index_unit(results, index)
    rows = []
    for name in compared_layouts(results) if versus else layouts(results):
        design = data.sel(layout=name)
        ends = list(extremes(design["improvement" if versus else "value"]) or ())
        cells = [Cell(), Cell()]
        for place, (value, at) in enumerate(ends[::-1] if versus else ends):
            text = format_percent(value) if versus else format_quantity(value, unit)
            remark = str(design_quantity(design.sel(at), unit)) if versus else ""
            cells[place] = Cell(f"{text} at {place_text(results, at)}", remark)
        rows.append(Row([Cell(name), *cells], status=_first_problem(results, name, index)))
    than = f", compared with {results.attrs['baseline']}" if versus else ""
    over = f"over {' and '.join(swept_words(results))}"
    caption = f"{capital(index_words(results, index))}{by_which(results)}{than}, {over}"
    return Table(caption, columns("Layout", "Best", "Worst"), rows, swept=True)


def _first_problem(results: xr.Dataset, layout: str, index: str) -> str:
    """First status over the sweep that is not ok, with the number of such statuses; empty if there is none."""
    every = results["status"].sel(layout=layout, index=index).values.ravel().tolist()
    bad = [text for text in every if problem_of(text)]
    return f"{bad[0]} ({len(bad)} of {len(every)} values are not ok)" if bad else ""


def _sweep_table(results: xr.Dataset, index: str, by: str = "") -> Table:
    element, (words,) = str(swept_element(results)), swept_words(results)
    data = results.sel(index=index).sortby(element)
    swept, values = (
        swept_scale(data, element),
        choose_scale(data["value"].values.ravel().tolist(), index_unit(results, index)),
    )
    points = _some(data, element)
    rows = []
    for point in points:
        here = data.isel({element: point})
        cells = []
        for name in layouts(results):
            design = here.sel(layout=name)
            cells.append(Cell(design_quantity(design, values.unit, values), improvement_over_baseline(design)))
        rows.append(Row([Cell(_swept_number(here, element, swept)), *cells]))
    some = f", {len(points)} of {data.sizes[element]} values" if len(points) < data.sizes[element] else ""
    if _are_far(data.sizes[element]):
        some += ", the extremes among them"
    best, over = _in_unit(index_words(results, index), values.unit), _in_unit(words, swept.unit)
    caption = f"Best {best}, over {over}{by}{some}"
    return Table(caption, columns(words, *marked_layouts(results)), rows, swept=True, failures=_failures(data))


def _map_table(results: xr.Dataset, index: str, layout: str) -> Table:
    """Values of the first place in rows, of the second in columns."""
    first, second = swept_places(results)
    data = results.sel(index=index, layout=layout).sortby([first, second])
    down, across = (swept_scale(data, place) for place in (first, second))
    values = choose_scale(data["value"].values.ravel().tolist(), index_unit(results, index))
    rows = []
    for i in _spread(data.sizes[first], _MOST_SWEPT):
        cells = []
        for j in _spread(data.sizes[second], _MOST_ACROSS):
            design = data.isel({first: i, second: j})
            number = design_quantity(design, values.unit, values)
            cells.append(Cell(improvement_text(design), str(number)) if compared_layouts(results) else Cell(number))
        rows.append(Row([Cell(_swept_number(data.isel({first: i}), first, down)), *cells]))
    over = (data.isel({second: j}) for j in _spread(data.sizes[second], _MOST_ACROSS))
    words = [_in_unit(w, u.unit) for w, u in zip(swept_words(results), (down, across), strict=True)]
    what = f"improvement over {results.attrs['baseline']} and its value" if compared_layouts(results) else "value"
    caption = (
        f"{layout}, best {index_words(results, index)}: {_in_unit(what, values.unit)}, over {words[0]} in rows and "
        f"{words[1]} in columns{by_which(results)}"
    )
    corner = f"{capital(swept_words(results)[0])} ↓, {swept_words(results)[1]} →"
    heads = columns(corner, *(_swept_number(here, second, across) for here in over))
    return Table(caption, heads, rows, swept=True, failures=_failures(results.sel(index=index, layout=[layout])))


def _in_unit(words: str, unit: str) -> str:
    return f"{words} in {unit}" if unit else words


def _spread(size: int, most: int) -> list[int]:
    """Evenly spaced positions in a list of `size` items, at most `most`, including both ends."""
    return sorted({*np.linspace(0, size - 1, min(size, most)).round().astype(int).tolist()})


def where_all_are(results: xr.Dataset) -> list[str]:
    """Sentence on the designs that the tables omit; empty unless they are many."""
    sizes = [results.sizes[place] for place in swept_places(results)]
    words = " and ".join(swept_words(results))
    if len(sizes) == 2:
        left_out = sizes[0] > _MOST_SWEPT or sizes[1] > _MOST_ACROSS
        values = f"{sizes[0]} x {sizes[1]}"
    else:
        left_out, values = _are_far(sizes[0]), f"{sizes[0]}"
    return [f"The designs at all {values} values of {words} are in {SUMMARY} and {DATASET}."] if left_out else []


def _some(data: xr.Dataset, element: str) -> list[int]:
    """Evenly spaced places in a long list, and its last; where much lies between them, the extremes too."""
    size = data.sizes[element]
    places = {*range(0, size, _step(size)), size - 1}
    if _are_far(size):
        names, what = (compared_layouts(data), "improvement") if compared_layouts(data) else (layouts(data), "value")
        for name in names:
            row = data[what].sel(layout=name).values
            known = np.flatnonzero(np.isfinite(row))
            places |= {int(known[find(row[known])]) for find in (np.argmin, np.argmax) if known.size}
    return sorted(places)


def _step(size: int) -> int:
    return -(-(size - 1) // (_MOST_SWEPT - 1)) or 1


def _are_far(size: int) -> bool:
    """Whether so many swept values lie between two rows that a reader misses what happens there."""
    return _step(size) > _MOST_BETWEEN


def _swept_number(here: xr.Dataset, place: str, unit: Scale) -> str:
    return format_number(float(here[place]) * unit.factor, 4)


def problem_of(status: str) -> str:
    """A status that is not ok; else empty."""
    return "" if status == StatusKind.OK.value else status


def _failures(data: xr.Dataset) -> list[str]:
    """Lines on designs whose status is not ok: layout, swept values and status; at most `_MOST_FAILURES`."""
    bad = []
    for name in layouts(data):
        status = data["status"].sel(layout=name)
        bad += [(name, tuple(point)) for point in np.argwhere(status.values != "ok").tolist()]
    lines = []
    for name, point in bad[:_MOST_FAILURES]:
        status = data["status"].sel(layout=name)[point]
        place = {swept: float(status[swept]) for swept in swept_places(data)}
        lines.append(f"{name} at {place_text(data, place, named=True)}: {status.item()}")
    more = len(bad) - _MOST_FAILURES
    return lines if more <= 0 else [*lines, f"and {more} more, which are in the table of results"]
