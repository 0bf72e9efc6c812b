"""Long work on free networks: the best of all networks that one may be, as `inerter search` finds them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import isfinite
from pathlib import Path
from typing import Any

from inerter.app.answers import Body, texts_of
from inerter.app.documents import searched_study_from
from inerter.app.kinds import RESULTS, JobStopped, Tell
from inerter.errors import OK, Status, StatusKind, StudyError
from inerter.figures.search import draw_search
from inerter.files.common.folder import FIGURES, REPORT
from inerter.files.study.checking import search_plans
from inerter.files.study.parts import PartResult
from inerter.files.study.search_parts import GroupResult
from inerter.files.study.search_tables import RANKED, improvement
from inerter.files.study.searching import StudySearch, search_study
from inerter.files.study.study import Study, searched_layouts
from inerter.network_search.network_optimum import SearchedNetwork
from inerter.network_search.plan import SearchPlan
from inerter.network_search.results import rank_networks
from inerter.networks.elements import ELEMENT_TYPES
from inerter.networks.enumeration import Topology
from inerter.networks.parser import replace_in_expression
from inerter.report.search import write_search_report


def search(body: Body, folder: Path, tell: Tell) -> Any:
    """The best networks of a layout for an index; while they are searched, `tell` is given the best so far.

    What an interrupted search left in the folder is not searched again.
    """
    document = body["study"]
    study = _one_search(searched_study_from(document), body)
    (layout, index), plan = next(iter(search_plans(study).items()))
    ranking = _Ranking(document, study, layout, index, plan)
    done = [0]

    def on_groups(groups: list[GroupResult]) -> None:
        ranking.add([network for group in groups for network in group.optima()])

    def on_part_done(count: int, total: int, last: PartResult | None, n_failures: int) -> None:
        done[0] = count
        tell(count, total, f"{ranking.n_searched} of {len(plan.topologies)} networks", ranking.so_far())

    def compiling(title: str, number: int, total: int) -> None:
        with suppress(JobStopped):  # other threads tell this too; the next group will stop
            tell(0, 0, f"compiling kernels {number} of {total}: {title}")

    def show(found: StudySearch, into: Path) -> None:
        tell(done[0], done[0], "figures and report")
        draw_search(found, into / FIGURES)
        write_search_report(found, into / FIGURES, into / REPORT)

    found = search_study(
        study,
        folder / RESULTS,
        jobs=max((os.cpu_count() or 2) - 1, 1),
        resume=True,
        progress=on_part_done,
        compiling=compiling,
        on_groups=on_groups,
        finish=show,
    )
    return ranking.final(found)


def _one_search(study: Study, body: Body) -> Study:
    """The study with one layout to search, for one index, and with its baseline if that is a design."""
    searched = searched_layouts(study)
    layout, *more_layouts = body.get("layouts") or [*searched, *study.layouts][:1]
    index, *more_indices = body.get("indices") or study.indices[:1]
    if more_layouts or more_indices:
        raise StudyError("A search in the workbench is one of one layout for one index; got several. Choose one each.")
    study.design(layout)
    study.index(index)
    baseline = study.baseline if study.baseline not in searched else None
    layouts = {name: one for name, one in study.layouts.items() if name in (layout, baseline)}
    return replace(study, layouts=layouts, indices=(index,), baseline=baseline, trade_off=(), real_inerters=None)


@dataclass
class _Ranking:
    """The best networks so far, as data for an answer."""

    document: Mapping[str, Any]
    study: Study
    layout: str
    index: str
    plan: SearchPlan
    best: list[SearchedNetwork] = field(default_factory=list)
    n_searched: int = 0

    def add(self, networks: list[SearchedNetwork]) -> None:
        """Rank further networks with the best."""
        self.n_searched += len(networks)
        self.best = rank_networks(one for one in (*self.best, *networks) if isfinite(one.value))[:RANKED]

    def so_far(self) -> dict[str, Any]:
        """The best of the networks that are searched."""
        unit = str(self.plan.index.unit)
        rows = [
            self._row(one.topology, one.values, one.others)
            | _value(one.value, unit, OK if not one.reason else Status(StatusKind.INACCURATE, one.reason))
            for one in self.best
        ]
        return self._answer(rows, complete=False)

    def final(self, found: StudySearch) -> dict[str, Any]:
        """The best of all networks, whose values are verified, compared with the baseline."""
        (one,) = found.searches
        rows = []
        for network in one.result.ranking[:RANKED]:
            own = network.topology.names(self.plan.taken_names)
            values = [network.parameters[name] for name in own]
            others = {name: value for name, value in network.parameters.items() if name not in own}
            rows.append(
                self._row(network.topology, values, others)
                | _value(network.value, network.unit, network.status)
                | {"improvement_percent": improvement(network.value, one.baseline)}
            )
        return self._answer(rows, complete=True)

    def _answer(self, rows: list[dict[str, Any]], *, complete: bool) -> dict[str, Any]:
        return {
            "layout": self.layout,
            "index": self.index,
            "title": self.study.index(self.index).title,
            "free_networks": searched_layouts(self.study)[self.layout],
            "baseline": self.study.baseline,
            "networks": len(self.plan.topologies),
            "complete": complete,
            "ranking": rows,
        }

    def _row(self, topology: Topology, values: Sequence[float], others: Mapping[str, float]) -> dict[str, Any]:
        """A network with its values, and the entries of a study document that has it in place of the free one."""
        names = topology.names(self.plan.taken_names | set(self.document["elements"]))
        new_names = dict(zip(topology.names(self.plan.taken_names), names, strict=True))
        expression = topology.format_expression(names)
        chosen = dict.fromkeys(searched_layouts(self.study)[self.layout], expression)
        entry = self.document["layouts"][self.layout]
        return {
            "network": expression,
            "elements": {
                name: f"{value!r} {_UNITS[symbol]}"
                for name, value, symbol in zip(names, values, topology.kinds, strict=True)
            },
            "active_bounds": {new_names[name]: end for name, end in self.plan.active_bounds(topology, values).items()},
            "values": texts_of(self.study, others),
            "entry": {mount: replace_in_expression(text, chosen) for mount, text in entry.items()}
            if isinstance(entry, Mapping)
            else replace_in_expression(entry, chosen),
        }


_UNITS = {kind.symbol: kind.unit for kind in ELEMENT_TYPES}


def _value(value: float, unit: str, status: Status) -> dict[str, Any]:
    return {"value": value, "unit": unit, "status": status.kind.value, "message": status.message}
