"""Parts of a search over networks of a study: networks of a layout for an index, of a front, and with real inerters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from math import nan
from typing import Any

from inerter.errors import Status, StatusKind
from inerter.files.study import journal as journals
from inerter.files.study.cases import Case, Outcome
from inerter.files.study.limits import all_limits
from inerter.files.study.parts import PartResult, StudyPart
from inerter.files.study.study import Study
from inerter.files.study.tasks import best_design
from inerter.methods.composite_index import estimate_of
from inerter.methods.method import Method
from inerter.methods.registry import with_decisive_method
from inerter.network_search.fronts import FrontPlan, FrontScale, FrontTask, NetworkPoints, front_group
from inerter.network_search.network_optimum import SearchedNetwork
from inerter.network_search.plan import SearchPlan, search_group
from inerter.network_search.real_inerters import estimate_with_real_inerters, optimise_with_real_inerters
from inerter.network_search.results import FoundNetwork
from inerter.networks.enumeration import Topology
from inerter.optimisation.optimise import Optimum, optimise
from inerter.systems.descriptor import linear_notes

Designs = Mapping[Case, Outcome]


@dataclass(frozen=True)
class NetworkGroup(StudyPart["GroupResult"]):
    """Some networks of a layout, which are searched together for an index."""

    layout: str
    index: str
    number: int
    topologies: tuple[Topology, ...] = field(default=(), compare=False, repr=False)
    plan: SearchPlan | None = field(default=None, compare=False, repr=False)

    @property
    def name(self) -> str:
        """Name of the group in messages."""
        return f"{self.layout} {self.index} group {self.number + 1}"

    def compute(self, study: Study, designs: Mapping[Case, Outcome], threads: int) -> GroupResult:
        """The best values of each network of the group."""
        assert self.plan is not None
        return self._result(search_group(self.plan, self.topologies))

    def failed_result(self, study: Study, message: str) -> GroupResult:
        """Result in which every network has failed for the same reason."""
        return self._result([SearchedNetwork(topology, reason=message) for topology in self.topologies], message)

    def _result(self, searched: Iterable[SearchedNetwork], message: str = "") -> GroupResult:
        networks = [{**vars(one), "topology": one.topology.tree} for one in searched]
        return GroupResult(self.layout, self.index, self.number, networks, message)


@dataclass(frozen=True)
class GroupResult(PartResult):
    """The best values of some networks, or the reason why there are none; all of it survives JSON."""

    of = NetworkGroup
    layout: str
    index: str
    number: int
    networks: list[dict[str, Any]]  # the fields of each `SearchedNetwork`
    message: str = ""

    def optima(self) -> Iterator[SearchedNetwork]:
        """The networks with what was found for each."""
        for one in self.networks:
            values = {"topology": Topology(_tree(one["topology"])), "values": tuple(one["values"])}
            yield SearchedNetwork(**{**one, **values})


def _tree(entry: Any) -> Any:
    """The tree of a topology from JSON, which has lists for tuples."""
    return entry if isinstance(entry, str) else tuple(map(_tree, entry))


@dataclass(frozen=True)
class NetworkFrontPart(StudyPart["NetworkFrontResult"]):
    """A network of a layout that is searched between its single optima, for the front."""

    layout: str
    wave: int
    network: str
    task: FrontTask | None = field(default=None, compare=False, repr=False)
    plan: FrontPlan | None = field(default=None, compare=False, repr=False)
    scale: FrontScale | None = field(default=None, compare=False, repr=False)

    @property
    def name(self) -> str:
        """Name of the part in messages."""
        return f"{self.layout} front {self.network}"

    def compute(self, study: Study, designs: Designs, threads: int) -> NetworkFrontResult:
        """Points of the network closest to the aims of the front."""
        assert self.task is not None
        assert self.plan is not None
        assert self.scale is not None
        (points,) = front_group(self.plan, self.scale, [self.task])
        return self._result(points)

    def failed_result(self, study: Study, message: str) -> NetworkFrontResult:
        """Result without points."""
        assert self.task is not None
        return self._result(NetworkPoints(self.task.topology, reason=message))

    def _result(self, points: NetworkPoints) -> NetworkFrontResult:
        entry = {**vars(points), "topology": points.topology.tree}
        return NetworkFrontResult(self.layout, self.wave, self.network, entry, points.reason)


@dataclass(frozen=True)
class NetworkFrontResult(PartResult):
    """Points of a network; all of it survives JSON."""

    of = NetworkFrontPart
    layout: str
    wave: int
    network: str
    points: dict[str, Any]  # the fields of `NetworkPoints`
    message: str = ""

    def network_points(self) -> NetworkPoints:
        """The points."""
        given = self.points
        return NetworkPoints(
            Topology(_tree(given["topology"])),
            tuple(given["aims"]),
            tuple(map(tuple, given["values"])),
            tuple(given["parameters"]),
            given["reason"],
            tuple(given.get("doubts", ())),  # which a folder of an earlier version does not have
        )


@dataclass(frozen=True)
class RealPart(StudyPart["RealResult"]):
    """A network of a layout with real inerters, optimised by a method for an index; without a network the baseline."""

    layout: str
    index: str
    method: str
    network: str
    found: FoundNetwork | None = field(default=None, compare=False, repr=False)

    @property
    def name(self) -> str:
        """Name of the part in messages."""
        return f"{self.layout} {self.index} {self.network or 'baseline'} by {self.method}"

    def compute(self, study: Study, designs: Designs, threads: int) -> RealResult:
        """The index with the values of the ideal network, and with the best values of the real one."""
        method = study.method(self.method, threads)
        if self.found is None:
            return self._baseline(study, designs, method)
        assert study.real_inerters is not None
        real, friction = study.real_inerters.shaft, study.real_inerters.friction
        kept = estimate_with_real_inerters(self.found, method, real, friction)
        return self._result_of_search(
            optimise_with_real_inerters(self.found, method, friction=friction, real=real),
            kept=kept.value,
            kept_bound=kept.error_bound,
            kept_doubt=with_decisive_method(kept.status, self.method).doubt,
        )

    def _baseline(self, study: Study, designs: Designs, method: Method) -> RealResult:
        """The baseline at its best values by the method; one without friction and backlash has those of the study."""
        layout = str(study.baseline)
        index, design = study.resolve_index(self.index, layout), study.design(layout)
        if self.method != study.optimise and design.free_values() and linear_notes(design.mechanism()):
            return self._result_of_search(
                optimise(design, index, method, subject_to=all_limits(study, layout), seed=study.seed)
            )
        estimate = estimate_of(best_design(study, designs, layout, self.index), index, method)
        return self._result(
            value=estimate.value,
            error=estimate.standard_error,
            status=with_decisive_method(estimate.status, self.method),
            error_bound=estimate.error_bound,
            shared_errors=estimate.shared_errors,
        )

    def _result_of_search(self, best: Optimum, **more: Any) -> RealResult:
        is_feasible = best.status.kind is not StatusKind.INFEASIBLE
        return self._result(
            value=best.value if is_feasible else nan,
            error=best.estimate.standard_error,
            status=with_decisive_method(best.status, self.method),
            error_bound=best.estimate.error_bound,
            shared_errors=best.estimate.shared_errors,
            parameters=best.parameters,
            active_bounds=best.active_bounds,
            starts=best.n_starts,
            agreed=best.n_converged,
            **more,
        )

    def _result(self, *, value: float, error: float | None, status: Status, **more: Any) -> RealResult:
        return RealResult(
            layout=self.layout,
            index=self.index,
            method=self.method,
            network=self.network,
            value=value,
            standard_error=nan if error is None else error,
            status=status.kind.value,
            message=status.message,
            **more,
        )

    def failed_result(self, study: Study, message: str) -> RealResult:
        """Result without a value."""
        return self._result(value=nan, error=None, status=Status(StatusKind.FAILED, message))


@dataclass(frozen=True, kw_only=True)
class RealResult(PartResult):
    """The best values of a network with real inerters [SI]; all of it survives JSON."""

    of = RealPart
    layout: str
    index: str
    method: str
    network: str
    value: float
    standard_error: float
    status: str
    message: str = ""
    error_bound: float = nan  # relative, sampling apart
    shared_errors: dict[str, tuple[float, ...]] = field(default_factory=dict)  # of that, those of the road
    kept: float = nan  # with the values of the ideal network
    kept_bound: float = nan  # relative
    kept_doubt: str = ""  # why that value is not certain
    parameters: dict[str, float] = field(default_factory=dict)
    active_bounds: dict[str, str] = field(default_factory=dict)
    starts: int = 0
    agreed: int = 0

    @property
    def kind(self) -> str:
        """Kind of status."""
        return self.status


def result_of(entry: Mapping[str, Any]) -> PartResult:
    """The result that a line of the journal of a search has: of networks, or of a design."""
    for key, kind in (("networks", GroupResult), ("points", NetworkFrontResult), ("kept", RealResult)):
        if key in entry:
            made: PartResult = kind(**entry)
            return made
    return journals.result_of(entry)
