"""Long work on free networks: the best of all networks that one may be, as `inerter search` finds them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, nan
from pathlib import Path
from typing import Any

from inerter.app.answers import Body, texts_of, tree_of
from inerter.app.designs import describe_index
from inerter.app.documents import searched_study_from
from inerter.app.kinds import RESULTS, Tell, job_arguments
from inerter.errors import OK, Status, StatusKind, StudyError
from inerter.files.study.checking import search_plans
from inerter.files.study.parts import PartResult
from inerter.files.study.search_parts import GroupResult, NetworkFrontPart, RealPart, RealResult
from inerter.files.study.search_tables import RANKED, real_gains
from inerter.files.study.searching import LayoutSearch, StudySearch, search_study
from inerter.files.study.study import Study, searched_layouts
from inerter.formatting import format_list, printed_text
from inerter.methods.registry import brief_words_of
from inerter.methods.ties import percent_below
from inerter.network_search.front_results import FrontNetwork
from inerter.network_search.network_optimum import SearchedNetwork
from inerter.network_search.plan import SearchPlan
from inerter.network_search.results import FoundNetwork, rank_networks
from inerter.networks.elements import ELEMENT_TYPES, Element, Inerter, Network
from inerter.networks.enumeration import Topology
from inerter.networks.parser import format_expression, replace_in_expression
from inerter.networks.transform import map_elements
from inerter.report.search import search_sentences, write_search_report


def search(body: Body, folder: Path, tell: Tell) -> Any:
    """The best networks of a layout for each index, their front, and real inerters, as the study asks.

    While they are searched, `tell` is given the best so far. What an interrupted search left in the folder is not
    searched again.
    """
    document = body["study"]
    study = _one_layout(searched_study_from(document), body)
    ranking = _Ranking(document, study, search_plans(study))
    arguments = job_arguments(tell, write_search_report, lambda last: (ranking.progress(last), ranking.so_far()))
    return ranking.final(search_study(study, folder / RESULTS, resume=True, on_groups=ranking.add, **arguments))


def _one_layout(study: Study, body: Body) -> Study:
    """The study with one layout to search, and with its baseline if that is a design.

    Of several indices the front is searched too.
    """
    searched = searched_layouts(study)
    layout, *more_layouts = body.get("layouts") or [*searched, *study.layouts][:1]
    indices = tuple(dict.fromkeys(body.get("indices") or study.trade_off or study.indices[:1]))
    if more_layouts:
        raise StudyError("A search in the workbench covers one layout; got several. Choose one.")
    if len(indices) > _MOST_INDICES:
        raise StudyError(f"A front over networks requires two or three indices; got {len(indices)}. Choose fewer.")
    study.design(layout)
    for index in indices:
        study.index(index)
    baseline = study.baseline if study.baseline not in searched else None
    layouts = {name: one for name, one in study.layouts.items() if name in (layout, baseline)}
    trade_off = indices if len(indices) > 1 else ()
    return replace(study, layouts=layouts, indices=indices, baseline=baseline, trade_off=trade_off)


@dataclass
class _Ranking:
    """The best networks so far for each index, as data for an answer."""

    document: Mapping[str, Any]
    study: Study
    plans: Mapping[tuple[str, str], SearchPlan]
    best: dict[str, list[SearchedNetwork]] = field(default_factory=dict)
    n_searched: int = 0

    @property
    def layout(self) -> str:
        """The layout that is searched."""
        return next(iter(self.plans))[0]

    @property
    def n_networks(self) -> int:
        """Number of networks."""
        return len(next(iter(self.plans.values())).topologies)

    def add(self, groups: Iterable[GroupResult]) -> None:
        """Rank further networks with the best for the same index."""
        for group in groups:
            networks = list(group.optima())
            self.n_searched += len(networks)
            known = self.best.get(group.index, [])
            self.best[group.index] = rank_networks(n for n in (*known, *networks) if isfinite(n.value))[:RANKED]

    def progress(self, last: PartResult | None) -> str:
        """How many networks are optimised, of several indices for all of them; then what was last found."""
        indices = format_list([index for _, index in self.plans])
        total = self.n_networks * len(self.plans)
        match last.part if last and self.n_searched >= total else None:
            case NetworkFrontPart(network=network):
                return f"networks between the best for {indices}: {network} is done"
            case RealPart(network=network, index=index, method=method):
                return f"with real inerters, {index} by {brief_words_of(method)}: {network or 'the baseline'} is done"
        each = " each" if len(self.plans) > 1 else ""
        return f"{self.n_searched // len(self.plans)} of {self.n_networks} networks optimised for {indices}{each}"

    def so_far(self) -> dict[str, Any]:
        """The best of the networks that are searched."""
        found = []
        for (_, index), plan in self.plans.items():
            rows = []
            for one in self.best.get(index, []):
                named = dict(zip(one.topology.names(plan.taken_names), one.values, strict=True))
                status = Status(StatusKind.INACCURATE, one.reason) if one.reason else OK
                rows.append(self._row(plan, one.topology, {**named, **one.others}) | _value(one.value, status))
            found.append(self._of_index(index, rows))
        return self._answer(found, complete=False)

    def final(self, found: StudySearch) -> dict[str, Any]:
        """The best of all networks, whose values are verified, compared with the baseline."""
        searches = []
        for one in found.searches:
            ranking = [self._of_network(one, network) for network in one.result.ranking[:RANKED]]
            values = [nan, *(network.value for network in one.result.frontier)]
            frontier = [
                self._of_network(one, network) | {"gain_on_previous_percent": percent_below(network.value, before)}
                for network, before in zip(one.result.frontier, values, strict=False)
            ]
            real = [self._of_real(one, each) for each in one.real if each.network]
            searches.append(self._of_index(one.index, ranking, frontier, real, one.baseline))
        sentences = [printed_text(sentence) for sentence in search_sentences(found)]
        return {**self._answer(searches, self._front(found), complete=True), "sentences": sentences}

    def _answer(
        self, searches: list[dict[str, Any]], front: dict[str, Any] | None = None, *, complete: bool
    ) -> dict[str, Any]:
        return {
            "layout": self.layout,
            "free_networks": searched_layouts(self.study)[self.layout],
            "baseline": self.study.baseline,
            "networks": self.n_networks,
            "complete": complete,
            "searches": searches,
            "front": front,
        }

    def _of_index(
        self,
        index: str,
        ranking: list[dict[str, Any]],
        frontier: Sequence[dict[str, Any]] = (),
        real: Sequence[dict[str, Any]] = (),
        baseline: float = nan,
    ) -> dict[str, Any]:
        rows = {"ranking": ranking, "frontier": frontier, "real_inerters": real}
        return {**describe_index(self.study, index), "baseline_value": baseline, **rows}

    def _of_network(self, one: LayoutSearch, network: FoundNetwork) -> dict[str, Any]:
        return self._row(self.plans[self.layout, one.index], network.topology, network.parameters) | {
            **_value(network.value, network.status),
            "improvement_percent": percent_below(network.value, one.baseline),
        }

    def _of_real(self, one: LayoutSearch, each: RealResult) -> dict[str, Any]:
        """A network with real inerters; one without a result has its best ideal values."""
        assert self.study.real_inerters is not None
        shaft, friction = self.study.real_inerters.shaft, self.study.real_inerters.friction
        ideal = one.ideal_network(each)
        before, after = real_gains(one, each)

        def change(element: Element) -> Network:
            return shaft.network(element, friction) if isinstance(element, Inerter) else element

        parameters = each.parameters or ideal.parameters
        return self._row(self.plans[self.layout, one.index], ideal.topology, parameters, change) | {
            **_value(each.value, Status(StatusKind(each.status), each.message) or one.real_gain_status(each)),
            "method": each.method,
            "standard_error": each.standard_error,
            "ideal": ideal.value,
            "same_values": each.kept,
            "same_values_doubt": each.kept_doubt,
            "ideal_improvement_percent": before,
            "improvement_percent": after,
        }

    def _front(self, found: StudySearch) -> dict[str, Any] | None:
        """Fronts of the networks of up to each number of elements, those apart that differ; None for one index."""
        if not found.fronts:
            return None
        (one,) = found.fronts
        several = list(one.result.by_elements.items())
        fronts = [
            {"elements": count, "points": [self._of_point(found, point) for point in front]}
            for (count, front), (_, before) in zip(several, [(0, ()), *several[:-1]], strict=True)
            if front != before
        ]
        return {"indices": [describe_index(self.study, index) for index in found.study.trade_off], "fronts": fronts}

    def _of_point(self, found: StudySearch, point: FrontNetwork) -> dict[str, Any]:
        plan = next(iter(self.plans.values()))
        baselines = {one.index: one.baseline for one in found.searches}
        values = dict(zip(found.study.trade_off, point.values, strict=True))
        return self._row(plan, point.topology, point.parameters) | {
            "indices": values,
            "improvements_percent": {index: percent_below(value, baselines[index]) for index, value in values.items()},
            **point.status.to_json(),
        }

    def _row(
        self,
        plan: SearchPlan,
        topology: Topology,
        parameters: Mapping[str, float],
        change: Callable[[Element], Network] = lambda element: element,
    ) -> dict[str, Any]:
        """A network with its values, and the entries of a study document that has it in place of the free one.

        `change` gives the network that takes the place of each of its elements.
        """
        own, known = topology.names(plan.taken_names), self.document["elements"]
        names = topology.names(plan.taken_names | {*known, *(name.rpartition("_")[0] for name in known)})
        new_names, values = dict(zip(own, names, strict=True)), [parameters[name] for name in own]
        ideal = [_KINDS[kind].of(value, name) for kind, value, name in zip(topology.kinds, values, names, strict=True)]
        network = map_elements(topology.network(ideal), change)
        elements = {element.label: element for element in network.elements()}
        expression = replace_in_expression(format_expression(network, elements), {})  # without needless brackets
        chosen = dict.fromkeys(searched_layouts(self.study)[self.layout], expression)
        entry = self.document["layouts"][self.layout]
        return {
            "network": expression,
            "tree": tree_of(network),
            "n_elements": topology.size,
            "elements": {name: f"{element.value!r} {element.unit}" for name, element in elements.items()},
            "active_bounds": {
                new_names.get(name, name): end for name, end in plan.active_bounds(topology, parameters).items()
            },
            "values": texts_of(self.study, {name: value for name, value in parameters.items() if name not in own}),
            "entry": {mount: replace_in_expression(text, chosen) for mount, text in entry.items()}
            if isinstance(entry, Mapping)
            else replace_in_expression(entry, chosen),
        }


_KINDS = {kind.symbol: kind for kind in ELEMENT_TYPES}
_MOST_INDICES = 3  # of a front


def _value(value: float, status: Status) -> dict[str, Any]:
    return {"value": value, **status.to_json()}
