"""The report of a search over networks: sections of tables, sentences, and the page."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any

import inerter
from inerter.atomic_io import write_text
from inerter.decision.results import Improvement
from inerter.figures.search import FRONTIER, draw_search, figure_names
from inerter.files.common.folder import FIGURES, REPORT
from inerter.files.common.suggest import some
from inerter.files.study.cases import NO_EQUILIBRIUM, lacks_equilibrium
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.search_tables import (
    agreement_remark,
    equally_good_notes,
    fixed_table,
    front_networks_table,
    front_points_table,
    front_sizes_table,
    frontier_table,
    inerters_table,
    networks_shown,
    ranking_table,
    real_networks_table,
)
from inerter.files.study.searching import TABLE, LayoutFront, LayoutSearch, StudySearch, tables_of
from inerter.formatting import (
    capital,
    format_count,
    format_list,
    format_percent_size,
    format_quantity,
    format_share,
    format_some,
)
from inerter.indices.names import title_with_name
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import brief_words_of, words_of
from inerter.methods.ties import percent_below
from inerter.report.json_data import json_data
from inerter.report.page import PageFigure, page_figures, study_page
from inerter.report.sections import Section
from inerter.table import records
from inerter.work.progress import report

_NEAR = 0.01  # share within which a smaller network is nearly as good as the best
_MOST_FAILED = 5  # networks that are named for one reason
_MOST_REASONS = 3


def search_sections(found: StudySearch) -> Iterator[Section]:
    """A section for each layout and index: frontier, ranking, and remarks."""
    for one in found.searches:
        if one.result.ranking:
            tables = [make(found.study, one) for make in (frontier_table, inerters_table, ranking_table)]
            brief = [tables[0], tables[-1]]
            if any(each.network for each in one.real):
                tables.append(real_networks_table(found.study, one))
                brief.append(tables[-1])
            remarks = [agreement_remark(one), *(f"{note}." for note in equally_good_notes(one))]
            yield Section(capital(one.heading), tables, remarks=[remark for remark in remarks if remark], brief=brief)
    for front in found.fronts:
        if front.result.front:
            tables = [
                make(found.study, front) for make in (front_networks_table, front_sizes_table, front_points_table)
            ]
            yield Section(capital(front.heading), tables, remarks=[_front_remark(front)], brief=tables[:2])
    if (fixed := fixed_table(found)) is not None:
        yield Section("Layouts without a free network", [fixed])


def search_sentences(found: StudySearch) -> Iterator[str]:
    """The best network of each layout and index, and the smallest that is nearly as good."""
    for one in found.searches:
        if not one.result.ranking:
            yield f"{capital(one.heading)}: no network has a value."
            continue
        best, smaller = one.result.ranking[0], one.result.near_optimal(_NEAR)[0]
        gain = percent_below(best.value, one.baseline)
        against = _comparison(Improvement(gain), found.study.baseline)
        near = ""
        if smaller.n_elements < best.n_elements:
            behind = format_percent_size(-percent_below(smaller.value, best.value))
            near = (
                f"; the smallest network within {format_share(_NEAR)}, {smaller.layout}, has "
                f"{format_count(smaller.n_elements, 'elements')} and is {behind} worse"
            )
        yield (
            f"{capital(one.heading)}: {best.layout} is the best of {format_count(one.result.n_networks, 'networks')}, "
            f"{format_quantity(best.value, best.unit)}{against}{near}."
        )
        unsupported = [each for each in networks_shown(one) if lacks_equilibrium(each.design.mechanism())]
        if unsupported:
            yield (
                f"{capital(one.heading)}: {NO_EQUILIBRIUM} with {some(each.layout for each in unsupported)}. Put a "
                "spring in parallel with the free network, or limit the static stiffness."
            )
        yield from _real_sentences(found, one)
    for front in found.fronts:
        networks, points = front.result.networks, len(front.result.front)
        if not points:
            yield f"{capital(front.heading)}: no network has values of all indices."
        elif points == 1:
            yield f"{capital(front.heading)}: {networks[0]} is the best in all of them; there is no trade-off."
        else:
            verb = "is" if len(networks) == 1 else "are"
            yield (
                f"{capital(front.heading)}: {len(networks)} of {front.result.n_networks} networks {verb} on the Pareto "
                f"front: {format_list(networks)}."
            )


def _comparison(over: Improvement, baseline: str | None) -> str:
    """Clause that compares a network with the baseline; empty without one."""
    return f", {over.than(str(baseline))}" if isfinite(over.percent) else ""


def _real_sentences(found: StudySearch, one: LayoutSearch) -> Iterator[str]:
    """The best network with real inerters by each method, and those without a reliable value."""
    asked = found.study.real_inerters
    if asked is not None and not any(each.network for each in one.real):
        yield f"{capital(one.heading)} with real inerters: the best networks contain no inerter."
    for method in asked.methods if asked is not None else ():
        own = [each for each in one.real if each.method == method and each.network]
        known = [each for each in own if isfinite(each.value)]
        if not known:
            continue
        best = min(known, key=lambda each: each.value)
        gain = one.real_gain(best)
        against = _comparison(Improvement(gain, bound=one.real_gain_bound(best)), found.study.baseline)
        doubts = ["" if best.ok else best.status_text, one.real_gain_status(best).doubt if isfinite(gain) else ""]
        doubt = "; ".join(text.rstrip(".") for text in doubts if text)
        of = f" is the best of {len(own)} networks" if len(own) > 1 else ""
        yield (
            f"{capital(one.heading)} with real inerters ({brief_words_of(method)}): {best.network}{of}, "
            f"{format_quantity(best.value, one.result.unit, bound=best.error_bound)}{against}"
            f"{doubt and f' ({doubt})'}."
        )


def _front_remark(front: LayoutFront) -> str:
    """Sentence on the networks that were and were not searched between their single optima."""
    result = front.result
    were, whose = ("network was", "its") if result.n_searched == 1 else ("networks were", "their")
    searched = f"{result.n_searched} {were} searched between {whose} single optima"
    if not result.n_bounded:
        return f"{searched}."
    were, whose = ("was", "its") if result.n_bounded == 1 else ("were", "their")
    return (
        f"{searched}; {result.n_bounded} {were} not, since even {whose} best values in each index, taken together, are "
        "no better than the front."
    )


def search_notes(found: StudySearch) -> list[str]:
    """Notes on networks that failed, with their reasons."""
    notes = []
    for one in found.searches:
        reasons: dict[str, list[str]] = {}
        for network, reason in one.result.failed:
            reasons.setdefault(reason, []).append(network)
        told = sorted(reasons.items(), key=lambda entry: -len(entry[1]))
        for reason, networks in told[:_MOST_REASONS]:
            have = "1 network has" if len(networks) == 1 else f"{len(networks)} networks have"
            notes.append(
                f"{one.heading}: {have} no value ({format_some(networks, _MOST_FAILED)}): {reason.rstrip('.')}"
            )
        rest = sum(len(networks) for _, networks in told[_MOST_REASONS:])
        if rest:
            have = "1 more network has" if rest == 1 else f"{rest} more networks have"
            notes.append(f"{one.heading}: {have} no value; search.csv has the reason of each")
    return notes


def search_data(found: StudySearch) -> dict[str, Any]:
    """The results as JSON holds them: every network, with the numbers of search.csv."""
    tables = tables_of(found)
    data: dict[str, Any] = json_data(
        {
            "title": found.study.title,
            "seed": found.study.seed,
            "baselines": {one.index: one.baseline for one in found.searches if isfinite(one.baseline)},
            "frontiers": [
                {
                    "layout": one.layout,
                    "index": one.index,
                    "networks": [network.layout for network in one.result.frontier],
                }
                for one in found.searches
            ],
            "networks": records(tables.pop(TABLE)),
            **{Path(name).stem: records(table) for name, table in tables.items()},
        }
    )
    return data


def write_search_report(found: StudySearch, folder: Path) -> None:
    """Draw the networks and fronts of a search, and write the page with these drawings."""
    report("drawing the figures")
    draw_search(found, folder / FIGURES)
    study = found.study
    page = study_page(
        study,
        search_sentences(found),
        [title_with_name(study.index(name).title, name) for name in study.indices],
        title=study.title,
        swept=False,
        searched=True,
        drawings={},
        sections=list(search_sections(found)),
        further_sections=[],
        figures=list(_drawings(found, folder / FIGURES)),
        notes=search_notes(found),
        computation=list(_computation(found)),
        study_file=write_resolved(study),
    )
    write_text(folder / REPORT, page)


def _drawings(found: StudySearch, folder: Path) -> Iterator[PageFigure]:
    captions = {FRONTIER: "Best value for each number of elements of the networks."}
    networks, fronts = figure_names(found)
    for name, one in networks.items():
        captions[name] = f"{capital(one.heading)}: the best network for each number of elements, with its values."
    for name, front in fronts.items():
        what = "Pareto fronts of all networks of up to each number of elements; the networks of the outermost are named"
        if len(front.result.symbols) > 2:
            what = "the Pareto front over all networks, two indices at a time"
        captions[name] = (
            f"{capital(front.heading)}: {what}. A cross marks a layout without a free network. Designs far from the "
            "front over all networks are not in the picture."
        )
    for name, caption in captions.items():
        yield from page_figures(folder, name, caption, natural=name.startswith("networks-"))


def _computation(found: StudySearch) -> Iterator[str]:
    study = found.study
    method = study.optimise or ""
    yield f"Values are {words_of(method)}."
    for one in found.searches:
        yield (f"{capital(one.heading)}: {len(one.result.ranking)} of {one.result.n_networks} networks have a value.")
    yield (
        "The values of each network were optimised by local searches from many starting points (sampled with seed "
        f"{study.seed}), within bounds. Agreement is the number of searches that converged to the best value."
    )
    if found.fronts:
        yield (
            "Points of the Pareto fronts minimise the largest excess over aims that all networks share, normalised by "
            "the single optima."
        )
    if study.real_inerters is not None:
        real = study.real_inerters
        yield (
            f"Real inerters are those {real.description}; the values were optimised once more by "
            f"{format_list([brief_words_of(name) for name in real.methods])}. Gain and retained "
            "gain compare with the baseline by the same method."
        )
    if study.road is not None:
        yield CONVENTIONS[study.conventions].sentence
    yield f"Computed by inerter {inerter.__version__}."
