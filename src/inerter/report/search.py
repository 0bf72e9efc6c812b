"""The report of a search over networks: sections of tables, sentences, and the page."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any

import inerter
from inerter.atomic_io import write_text
from inerter.figures.labels import capital, format_list
from inerter.figures.search import FRONTIER, best_networks_figure
from inerter.files.study.plausibility import roads_sentence
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.search_tables import (
    agreement_remark,
    at_bound_notes,
    fixed_table,
    frontier_table,
    improvement,
    inerters_table,
    networks_table,
    ranking_table,
)
from inerter.files.study.searching import StudySearch
from inerter.formatting import format_percent, format_quantity
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import words_of
from inerter.report.json_data import json_data
from inerter.report.page import PageFigure, environment, inline, with_contents
from inerter.report.problem_statement import condition_rows, element_rows, further_rows, layout_rows, vehicle_rows
from inerter.report.sections import Section
from inerter.table import records

_NEAR = 0.01  # share within which a smaller network is as good as the best
_MOST_FAILED = 5  # networks that are named for one reason
_MOST_REASONS = 3


def search_sections(found: StudySearch) -> Iterator[Section]:
    """A section for each layout and index: frontier, ranking, and remarks."""
    for one in found.searches:
        if one.result.ranking:
            tables = [make(found.study, one) for make in (frontier_table, inerters_table, ranking_table)]
            brief = [tables[0], tables[-1]]
            remarks = [agreement_remark(one), *(f"{note}." for note in at_bound_notes(one))]
            yield Section(capital(one.heading), tables, remarks=[remark for remark in remarks if remark], brief=brief)
    if (fixed := fixed_table(found)) is not None:
        yield Section("Layouts without a free network", [fixed])


def search_sentences(found: StudySearch) -> Iterator[str]:
    """The best network of each layout and index, and the smallest that is nearly as good."""
    for one in found.searches:
        if not one.result.ranking:
            yield f"{capital(one.heading)}: no network has a value."
            continue
        best, smaller = one.result.ranking[0], one.result.near_optimal(_NEAR)[0]
        gain = improvement(best.value, one.baseline)
        against = f", {format_percent(gain)} on {found.study.baseline}" if isfinite(gain) else ""
        near = ""
        if smaller.n_elements < best.n_elements:
            behind = format_percent(-improvement(smaller.value, best.value))
            near = f"; with {_elements(smaller.n_elements)}, {smaller.layout} is {behind} from that"
        yield (
            f"{capital(one.heading)}: {best.layout} is the best of {one.result.n_networks} networks, "
            f"{format_quantity(best.value, best.unit)}{against}{near}."
        )


def _elements(count: int) -> str:
    return f"{count} element{'' if count == 1 else 's'}"


def search_notes(found: StudySearch) -> list[str]:
    """Notes on networks that failed, with their reasons."""
    notes = []
    for one in found.searches:
        reasons: dict[str, list[str]] = {}
        for network, reason in one.result.failed:
            reasons.setdefault(reason, []).append(network)
        told = sorted(reasons.items(), key=lambda entry: -len(entry[1]))
        for reason, networks in told[:_MOST_REASONS]:
            more = f" and {len(networks) - _MOST_FAILED} more" * (len(networks) > _MOST_FAILED)
            named = ", ".join(networks[:_MOST_FAILED])
            have = "1 network has" if len(networks) == 1 else f"{len(networks)} networks have"
            notes.append(f"{one.heading}: {have} no value ({named}{more}): {reason.rstrip('.')}")
        rest = sum(len(networks) for _, networks in told[_MOST_REASONS:])
        if rest:
            notes.append(f"{one.heading}: {rest} more networks have no value; search.csv has the reason of each")
    return notes


def search_data(found: StudySearch) -> dict[str, Any]:
    """The results as JSON holds them: every network, with the numbers of search.csv."""
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
            "networks": records(networks_table(found)),
        }
    )
    return data


def write_search_report(found: StudySearch, figures: Path, path: Path) -> Path:
    """Write the page of a search to `path`, with the drawings (SVG) in the folder `figures`."""
    study = found.study
    page = (
        environment()
        .get_template("report.html")
        .render(
            title=study.title,
            swept=False,
            searched=True,
            headlines=[*search_sentences(found), *([f"{road}."] if (road := roads_sentence(study)) else [])],
            vehicle=vehicle_rows(study),
            on_road=study.road is not None,
            elements=element_rows(study),
            further=further_rows(study),
            layouts=layout_rows(study),
            drawings={},
            indices=_indices_asked(found),
            sections=list(search_sections(found)),
            further_sections=[],
            conditions=condition_rows(study),
            figures=list(_drawings(found, figures)),
            notes=search_notes(found),
            computation=list(_computation(found)),
            study_file=write_resolved(study),
        )
    )
    write_text(path, with_contents(page))
    return path


def _indices_asked(found: StudySearch) -> str:
    names = [f"{found.study.index(name).title} ({name})" for name in found.study.indices]
    return f"The {'index is' if len(names) == 1 else 'indices are'} {format_list(names)}."


def _drawings(found: StudySearch, folder: Path) -> Iterator[PageFigure]:
    captions = {FRONTIER: "Best value for each number of elements of the networks."}
    for one in found.searches:
        captions[best_networks_figure(one)] = (
            f"{capital(one.heading)}: the best network for each number of elements, with its values."
        )
    for name, caption in captions.items():
        file = folder / f"{name}.svg"
        if file.exists():
            svg = file.read_text(encoding="utf-8")
            yield PageFigure(inline(svg, name, caption, natural=name != FRONTIER), caption)


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
    if study.road is not None:
        yield CONVENTIONS[study.conventions].sentence
    yield f"Computed by inerter {inerter.__version__}."
