"""Tables of a search over networks: the best for each number of elements, the ranking, and all networks in a file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite, isnan, nan
from typing import TYPE_CHECKING

from inerter.errors import StatusKind
from inerter.formatting import format_percent, format_quantity, label_with_unit
from inerter.networks.elements import ELEMENT_TYPES, Inerter
from inerter.table import Column, Quantity, Row, Table, cells, columns

if TYPE_CHECKING:
    from inerter.files.study.searching import LayoutSearch, StudySearch
    from inerter.files.study.study import Study
    from inerter.network_search.results import FoundNetwork

RANKED = 10  # networks in a ranking for people


def improvement(value: float, reference: float) -> float:
    """How far a value is below a reference, in per cent of it; nan where that has no meaning."""
    if not (isfinite(value) and isfinite(reference)) or reference == 0.0:
        return nan
    return 100.0 * (reference - value) / abs(reference)


def frontier_table(study: Study, one: LayoutSearch) -> Table:
    """The best network for each number of elements, with what it gains on the one before and on the baseline."""
    found = [(network.n_elements, network) for network in one.result.frontier]
    return _frontier(study, one, "elements", found)


def inerters_table(study: Study, one: LayoutSearch) -> Table:
    """The best network for each number of inerters, as `frontier_table`."""
    symbol = Inerter.symbol
    found = [(network.topology.counts[symbol], network) for network in one.result.frontier_of_inerters]
    return _frontier(study, one, "inerters", found)


def _frontier(study: Study, one: LayoutSearch, counted: str, found: Sequence[tuple[int, FoundNetwork]]) -> Table:
    is_compared = isfinite(one.baseline)
    heads = [
        *columns(_capital(counted), one.index, "Gain", *([f"On {study.baseline}"] if is_compared else [])),
        Column("Network", prose=True),
    ]
    rows, before = [], nan
    for count, network in found:
        gains = [improvement(network.value, before), *([improvement(network.value, one.baseline)] * is_compared)]
        texts = [None if isnan(gain) else format_percent(gain) for gain in gains]
        rows.append(Row(cells(f"{count}", Quantity(network.value, network.unit), *texts, network.layout)))
        before = network.value
    return Table(f"{_capital(one.heading)}: best network for each number of {counted}", heads, rows)


def ranking_table(study: Study, one: LayoutSearch) -> Table:
    """The best networks with their values; an asterisk marks a value at a bound."""
    names = _parameters(one.result.ranking[:RANKED])
    heads = [
        *columns("Rank", one.index),
        Column("Network", words=True),
        Column("Agreement", only_on_pages=True),
        *(Column(name, listed="Values") for name in names),
    ]
    rows = []
    for rank, found in enumerate(one.result.ranking[:RANKED], 1):
        values = [_value_text(study, found, name) if name in found.parameters else None for name in names]
        agreement = f"{found.n_converged} of {found.n_starts}" if found.n_converged else None
        content = cells(f"{rank}", Quantity(found.value, found.unit), found.layout, agreement, *values)
        rows.append(Row(content, status=_doubt(found)))
    count = len(one.result.ranking)
    what = f"{_capital(one.heading)}: the best {min(RANKED, count)} of {one.result.n_networks} networks"
    return Table(f"{what} (* at a bound)" if _any_at_bound(one.result.ranking[:RANKED]) else what, heads, rows)


def fixed_table(found: StudySearch) -> Table | None:
    """The layouts without a free network, with their index; None if there are none."""
    rows = []
    units = {one.index: one.result.unit for one in found.searches}
    for layout in dict.fromkeys(one.layout for one in found.fixed):
        own = {one.index: one for one in found.fixed if one.layout == layout}
        values = [
            Quantity(own[index].values.get(found.study.evaluate[0], {}).get(index, nan), units[index]) for index in own
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
    keys = ("layout", "index", "rank", "network", "elements", "value", "unit", "improvement_percent", "status")
    units = [label_with_unit(name, parameter_unit(found.study, name)) for name in names]
    heads = [Column(key=key) for key in (*keys, *units, "at_bound", "starts", "agreed", "as_good", "equal_networks")]
    return Table("Networks", heads, [Row(cells(*row)) for one in searches for row in _rows(one, names)])


def _rows(one: LayoutSearch, names: list[str]) -> Iterator[list[str | int | float | None]]:
    for rank, found in enumerate(one.result.ranking, 1):
        yield [
            *(one.layout, one.index, rank, found.layout, found.n_elements, found.value, found.unit),
            *(improvement(found.value, one.baseline), str(found.status)),
            *(found.parameters.get(name) for name in names),
            ";".join(f"{name}:{end}" for name, end in found.active_bounds.items()),
            *(found.n_starts, found.n_converged, found.simpler, "; ".join(found.like)),
        ]
    nothing = [None] * len(names)
    for layout, reason in one.result.failed:
        status = f"{StatusKind.FAILED.value}: {reason}"
        yield [
            one.layout,
            one.index,
            None,
            layout,
            None,
            None,
            one.result.unit,
            None,
            status,
            *nothing,
            "",
            None,
            None,
            "",
            "",
        ]


def parameter_unit(study: Study, name: str) -> str:
    """Unit of a free value: one that the file names, or an element of a found network, whose name has its kind."""
    kinds = {kind.symbol: kind.unit for kind in ELEMENT_TYPES}
    return study.free_units.get(name) or kinds.get(name.rstrip("0123456789"), "")


def at_bound_notes(one: LayoutSearch) -> Iterator[str]:
    """Remarks on the best networks with elements at their bounds, and on smaller ones that do as well."""
    for found in dict.fromkeys((*one.result.frontier, *one.result.ranking[:RANKED])):
        if found.active_bounds:
            ends = ", ".join(f"{name} at its {end} bound" for name, end in found.active_bounds.items())
            yield f"{found.layout} has {ends}{f', so {found.simpler} does as well' if found.simpler else ''}"


def _parameters(found: tuple[FoundNetwork, ...] | list[FoundNetwork]) -> list[str]:
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


def _doubt(found: FoundNetwork) -> str:
    return "" if found.status.ok else str(found.status)


def _any_at_bound(found: tuple[FoundNetwork, ...]) -> bool:
    return any(network.active_bounds for network in found)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
