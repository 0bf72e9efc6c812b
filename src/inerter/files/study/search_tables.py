"""Tables of a search over networks: the best for each number of elements, the ranking, and all networks in a file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isfinite, isnan, nan
from typing import TYPE_CHECKING

from inerter.errors import StatusKind
from inerter.files.study.summary import bounds_text
from inerter.formatting import (
    capital,
    format_list,
    format_percent,
    format_percent_size,
    format_quantity,
    label_with_unit,
)
from inerter.methods.ties import percent_below
from inerter.networks.elements import ELEMENT_TYPES, Inerter
from inerter.table import Column, Content, Quantity, Row, Table, cells, columns

if TYPE_CHECKING:
    from inerter.files.study.search_parts import RealResult
    from inerter.files.study.searching import LayoutFront, LayoutSearch, StudySearch
    from inerter.files.study.study import Study
    from inerter.network_search.front_results import FrontNetwork
    from inerter.network_search.results import FoundNetwork

RANKED = 10  # networks in a ranking for people


def frontier_table(study: Study, one: LayoutSearch) -> Table:
    """The best network for each number of elements, with what it gains on the one before and on the baseline."""
    found = [(network.n_elements, network) for network in one.result.frontier]
    return _frontier(study, one, "elements", found)


def _gain_text(gain: float, bound: float = nan) -> str | None:
    return None if isnan(gain) else format_percent(gain, bound=bound)


def inerters_table(study: Study, one: LayoutSearch) -> Table:
    """The best network for each number of inerters, as `frontier_table`."""
    symbol = Inerter.symbol
    found = [(network.topology.counts[symbol], network) for network in one.result.frontier_of_inerters]
    return _frontier(study, one, "inerters", found)


def _frontier(study: Study, one: LayoutSearch, counted: str, found: Sequence[tuple[int, FoundNetwork]]) -> Table:
    is_compared = isfinite(one.baseline)
    heads = [
        *columns(
            capital(counted), one.index, "Gain on previous", *([f"Gain on {study.baseline}"] if is_compared else [])
        ),
        Column("Network", prose=True),
    ]
    rows, before = [], nan
    for count, network in found:
        gains = [percent_below(network.value, before), *([percent_below(network.value, one.baseline)] * is_compared)]
        texts = [_gain_text(gain) for gain in gains]
        rows.append(Row(cells(f"{count}", Quantity(network.value, network.unit), *texts, network.layout)))
        before = network.value
    return Table(f"{capital(one.heading)}: best network for each number of {counted}", heads, rows)


def ranking_table(study: Study, one: LayoutSearch) -> Table:
    """The best networks with their values; an asterisk marks a value at a bound."""
    best = one.result.ranking[:RANKED]
    names = _parameters(best)
    heads = [
        *columns("Rank", one.index),
        Column("Network", words=True),
        Column("Agreement", only_on_pages=True),
        *(Column(name, listed="Values") for name in names),
    ]
    rows = []
    for rank, found in enumerate(best, 1):
        values = [_value_text(study, found, name) if name in found.parameters else None for name in names]
        agreement = f"{found.n_converged} of {found.n_starts}" if found.n_converged else None
        content = cells(f"{rank}", Quantity(found.value, found.unit), found.layout, agreement, *values)
        rows.append(Row(content, status=found.status.doubt))
    what = f"{capital(one.heading)}: the best {len(best)} of {one.result.n_networks} networks"
    return Table(f"{what} (* at a bound)" if any(found.active_bounds for found in best) else what, heads, rows)


def fixed_table(found: StudySearch) -> Table | None:
    """The layouts without a free network, with their index; None if there are none."""
    rows = []
    units = {one.index: one.result.unit for one in found.searches}
    for layout in dict.fromkeys(one.layout for one in found.fixed):
        own = {one.index: one for one in found.fixed if one.layout == layout}
        values = [
            Quantity(own[index].feasible_values(found.study.evaluate[0]).get(index, nan), units[index]) for index in own
        ]
        doubts = [f"{index}: {one.status_text}" for index, one in own.items() if not one.ok]
        rows.append(Row(cells(layout, *values), status="; ".join(doubts)))
    return Table("Layouts without a free network", columns("Layout", *units), rows) if rows else None


def agreement_remark(one: LayoutSearch) -> str:
    """Sentence on how many starts of the best networks found the best value."""
    searched = [found for found in one.result.ranking[:RANKED] if found.n_converged]
    if not searched:
        return ""
    least = min(searched, key=lambda found: found.n_converged / found.n_starts)
    share = f"{least.n_converged} of {least.n_starts}"
    return f"Of the starts of each of these networks, {share} or more found its best value."


def networks_table(found: StudySearch) -> Table:
    """All networks of all searches, those that failed last, with a column for every parameter."""
    searches = found.searches
    names = _parameters([network for one in searches for network in one.result.ranking])
    units = {name: label_with_unit(name, parameter_unit(found.study, name)) for name in names}
    keys = ("layout", "index", "rank", "network", "elements", "value", "unit", "improvement_percent", "status")
    there = [f"value in {label}" for label in found.study.condition_labels]
    every = [*keys, *units.values(), "at_bound", "starts", "agreed", "as_good", "equal_networks", *there]
    rows = [row for one in searches for row in _network_rows(one, units, there)]
    return Table("Networks", [Column(key=key) for key in every], [Row(cells(*map(row.get, every))) for row in rows])


def _network_rows(one: LayoutSearch, units: Mapping[str, str], there: Sequence[str]) -> Iterator[dict[str, Content]]:
    """Contents of `networks_table` by key; `units` are the keys of the parameters, `there` of the conditions."""
    of_search: dict[str, Content] = {"layout": one.layout, "index": one.index, "unit": one.result.unit}
    for rank, found in enumerate(one.result.ranking, 1):
        yield of_search | {
            "rank": rank,
            "network": found.layout,
            "elements": found.n_elements,
            "value": found.value,
            "improvement_percent": percent_below(found.value, one.baseline),
            "status": str(found.status),
            **{units[name]: value for name, value in found.parameters.items()},
            "at_bound": bounds_text(found.active_bounds),
            "starts": found.n_starts,
            "agreed": found.n_converged,
            "as_good": found.simpler,
            "equal_networks": "; ".join(found.like),
            **{key: own.value for key, own in zip(there, found.estimate.in_conditions if there else (), strict=True)},
        }
    for layout, reason in one.result.failed:
        status = f"{StatusKind.FAILED.value}: {reason}"
        yield of_search | {"network": layout, "status": status, "at_bound": "", "as_good": "", "equal_networks": ""}


def front_networks_table(study: Study, one: LayoutFront) -> Table:
    """The networks on a front, each with the ranges in which it is the best."""
    front = one.result.front
    heads = [*columns("Elements", *study.trade_off), Column("Points"), Column("Network", prose=True)]
    rows = []
    for network in one.result.networks:
        own = [point for point in front if point.layout == network]
        ends = [
            f"{format_quantity(min(values), unit)} to {format_quantity(max(values), unit)}"
            if len(own) > 1
            else format_quantity(values[0], unit)
            for values, unit in zip(zip(*(point.values for point in own), strict=True), one.result.units, strict=True)
        ]
        rows.append(Row(cells(f"{own[0].n_elements}", *ends, f"{len(own)}", network)))
    return Table(f"{capital(one.heading)}: networks on the Pareto front", heads, rows)


def front_points_table(study: Study, one: LayoutFront) -> Table:
    """The points of a front, in ascending order of the first index."""
    heads = [*columns("Point", *study.trade_off, "Elements"), Column("Network", words=True)]
    rows = []
    for number, point in enumerate(one.result.front, 1):
        values = [Quantity(value, unit) for value, unit in zip(point.values, one.result.units, strict=True)]
        status = point.status.doubt
        rows.append(Row(cells(f"{number}", *values, f"{point.n_elements}", point.layout), status=status))
    return Table(f"{capital(one.heading)}: the Pareto front over all networks", heads, rows)


def front_sizes_table(study: Study, one: LayoutFront) -> Table:
    """The front of the networks of up to each number of elements: its ends and its networks."""
    heads = [*columns("Elements", *(f"Lowest {index}" for index in study.trade_off)), Column("Networks", prose=True)]
    rows = []
    for count, front in one.result.by_elements.items():
        least = [min(point.values[index] for point in front) for index in range(len(study.trade_off))]
        values = [Quantity(value, unit) for value, unit in zip(least, one.result.units, strict=True)]
        networks = ", ".join(dict.fromkeys(point.layout for point in front))
        rows.append(Row(cells(f"up to {count}", *values, networks)))
    return Table(f"{capital(one.heading)}: Pareto fronts by number of elements", heads, rows)


def front_table(found: StudySearch) -> Table:
    """Points of the fronts of all layouts, by the largest number of elements, with a column for every parameter."""
    study = found.study
    points = [point for one in found.fronts for front in one.result.by_elements.values() for point in front]
    names = _parameters(points)
    values = [label_with_unit(index, study.unit(index)) for index in study.trade_off]
    units = [label_with_unit(name, parameter_unit(study, name)) for name in names]
    there = [f"{index} in {label}" for index in study.trade_off for label in study.condition_labels]
    keys = ("layout", "up_to_elements", "point", "network", "elements", *values, *units, "at_bound", "status", *there)
    rows = []
    for one in found.fronts:
        for count, front in one.result.by_elements.items():
            for number, point in enumerate(front, 1):
                at_bound = bounds_text(point.active_bounds)
                own = [*point.values, *(point.parameters.get(name) for name in names), at_bound, str(point.status)]
                each = [own.value for estimate in point.estimates for own in estimate.in_conditions] if there else []
                rows.append(Row(cells(one.layout, count, number, point.layout, point.n_elements, *own, *each)))
    return Table("Pareto fronts over networks", [Column(key=key) for key in keys], rows)


def real_networks_table(study: Study, one: LayoutSearch) -> Table:
    """The best networks with real inerters, optimised once more, and the part of each gain that is retained."""
    assert study.real_inerters is not None
    several = len(study.real_inerters.methods) > 1
    compared = isfinite(one.baseline)
    heads = [
        Column("Network", words=True),
        *([Column("Method", words=True)] if several else []),
        *columns("Ideal", "Same values", "Optimised"),
        *(columns("Ideal gain", "Gain", "Retained") if compared else []),
        Column("Agreement", only_on_pages=True),
    ]
    rows = []
    for each in one.real:
        if not each.network:
            continue
        unit = one.result.unit
        before, after = real_gains(one, each)
        bound, retained = one.real_gain_bound(each), 100.0 / before if before > 0.0 else nan
        share = None if isnan(retained * after) else format_percent_size(retained * after, bound=retained * bound)
        gains = [_gain_text(before), _gain_text(after, bound), share]
        content = [
            each.network,
            *([each.method] if several else []),
            Quantity(one.ideal_network(each).value, unit),
            Quantity(each.kept, unit, bound=each.kept_bound),
            Quantity(each.value, unit, each.standard_error, each.error_bound),
            *(gains if compared else []),
            f"{each.agreed} of {each.starts}" if each.starts else None,
        ]
        doubts = [
            "" if each.ok else each.status_text,
            each.kept_doubt and f"same values: {each.kept_doubt}",
            one.real_gain_status(each).doubt,
        ]
        rows.append(Row(cells(*content), status="; ".join(filter(None, doubts))))
    which = f"the best networks, their inerters {study.real_inerters.description}"
    return Table(f"{capital(one.heading)} with real inerters: {which}", heads, rows)


def real_gains(one: LayoutSearch, each: RealResult) -> tuple[float, float]:
    """Gains of a network on the baseline with ideal and with real inerters, in per cent."""
    return percent_below(one.ideal_network(each).value, one.baseline), one.real_gain(each)


def real_table(found: StudySearch) -> Table:
    """The best networks with real inerters of all searches, with a column for every parameter."""
    results = [(one, each) for one in found.searches for each in one.real if each.network]
    names = _parameters([each for _, each in results])
    units = [label_with_unit(name, parameter_unit(found.study, name)) for name in names]
    keys = ("layout", "index", "method", "network", "ideal", "same_values", "same_values_doubt", "value")
    errors = ("standard_error", "error_bound", "unit")
    gains = ("ideal_improvement_percent", "improvement_percent", "improvement_bound", "improvement_doubt")
    more = (*gains, *units, "at_bound", "starts", "agreed", "status")
    rows = []
    for one, each in results:
        ideal = one.ideal_network(each).value
        rows.append(
            Row(
                cells(
                    *(each.layout, each.index, each.method, each.network, ideal, each.kept, each.kept_doubt),
                    *(each.value, each.standard_error, each.error_bound, one.result.unit, *real_gains(one, each)),
                    *(one.real_gain_bound(each), one.real_gain_status(each).doubt),
                    *(each.parameters.get(name) for name in names),
                    bounds_text(each.active_bounds),
                    *(each.starts, each.agreed, each.status_text),
                )
            )
        )
    return Table("Networks with real inerters", [Column(key=key) for key in (*keys, *errors, *more)], rows)


def parameter_unit(study: Study, name: str) -> str:
    """Unit of a free value: one that the file names, or an element of a found network, whose name has its kind."""
    kinds = {kind.symbol: kind.unit for kind in ELEMENT_TYPES}
    return study.free_units.get(name) or kinds.get(name.rstrip("0123456789"), "")


def networks_shown(one: LayoutSearch) -> list[FoundNetwork]:
    """Networks that people see: the frontier, then the best of the ranking."""
    return list(dict.fromkeys((*one.result.frontier, *one.result.ranking[:RANKED])))


def equally_good_notes(one: LayoutSearch) -> Iterator[str]:
    """Remarks on networks of the tables that are no better than a smaller one, because elements are at their bounds."""
    for found in networks_shown(one):
        if found.simpler:
            ends = format_list([f"{name} at its {end} bound" for name, end in found.active_bounds.items()])
            yield f"{found.layout} has {ends}, so {found.simpler} is equally good"


def _parameters(found: Iterable[FoundNetwork | FrontNetwork | RealResult]) -> list[str]:
    """Names of all parameters, by kind and number."""
    every = {name for network in found for name in network.parameters}
    ranks = {kind.symbol: rank for rank, kind in enumerate(ELEMENT_TYPES)}

    def order(name: str) -> tuple[int, str, int]:
        stem = name.rstrip("0123456789")
        return ranks.get(stem, len(ranks)), stem, int(name[len(stem) :] or 0)

    return sorted(every, key=order)


def _value_text(study: Study, found: FoundNetwork, name: str) -> str:
    text = format_quantity(found.parameters[name], parameter_unit(study, name))
    return f"{text}*" if name in found.active_bounds else text
