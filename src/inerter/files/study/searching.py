"""Searching a study into a result folder: the best of all networks that the free networks of its layouts may be."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path
from typing import Any

from inerter.atomic_io import write_text
from inerter.errors import OK, Status, StatusKind
from inerter.files.common.folder import FIGURES, REPORT, Results, WriteMode, open_results
from inerter.files.study import journal as journals
from inerter.files.study.cases import Case, Outcome
from inerter.files.study.checking import fixed_part, kernels, search_plans
from inerter.files.study.parts import PartResult, StudyPart
from inerter.files.study.running import RESOLVED, VERSIONS, Progress, write_study
from inerter.files.study.search_parts import (
    GroupResult,
    NetworkFrontPart,
    NetworkFrontResult,
    NetworkGroup,
    RealPart,
    RealResult,
    result_of,
)
from inerter.files.study.search_tables import front_table, networks_table, real_table
from inerter.files.study.study import Study, searched_layouts
from inerter.files.study.work import StudyWork
from inerter.kernels.prepare import ProgressCallback, prepare_on
from inerter.methods.error_bounds import improvement_bound
from inerter.methods.ties import percent_below
from inerter.network_search.front_results import NetworkFront
from inerter.network_search.fronts import FrontPlan, front_waves
from inerter.network_search.plan import SearchPlan
from inerter.network_search.results import FoundNetwork, SearchResult, collect_results
from inerter.networks.parser import names
from inerter.table import Table, csv_rows, csv_text
from inerter.work.pool import Pool, worker_pool
from inerter.work.returns import check_all_results

TABLE, FRONT_TABLE, REAL_TABLE = "search.csv", "search_front.csv", "search_real_inerters.csv"


@dataclass(frozen=True, eq=False)
class LayoutSearch:
    """Networks found for a layout and an index, with the index of the baseline; nan without one."""

    layout: str
    index: str
    heading: str  # index, and layout where there are several
    result: SearchResult
    baseline: float = nan
    real: tuple[RealResult, ...] = ()  # the best networks with real inerters, and the baseline by the same methods

    def ideal_network(self, each: RealResult) -> FoundNetwork:
        """The network of a result with real inerters, with ideal ones."""
        return next(network for network in self.result.ranking if network.layout == each.network)

    def real_gain(self, each: RealResult) -> float:
        """Gain of a network with real inerters on the baseline, by the same method [%]; nan if it is not known."""
        base = self._real_baseline(each.method)
        return nan if base is None else percent_below(each.value, base.value)

    def real_gain_bound(self, each: RealResult) -> float:
        """Largest error of that gain [%]."""
        base = self._real_baseline(each.method)
        if base is None:
            return nan
        errors = each.error_bound, base.error_bound, each.shared_errors, base.shared_errors
        return improvement_bound(each.value, base.value, *errors)

    def real_gain_status(self, each: RealResult) -> Status:
        """Reliability of the value of the baseline in that gain."""
        base = self._real_baseline(each.method)
        return OK if base is None or base.ok else Status(StatusKind(base.status), f"baseline: {base.message}")

    def _real_baseline(self, method: str) -> RealResult | None:
        return next((one for one in self.real if one.method == method and not one.network), None)


@dataclass(frozen=True, eq=False)
class LayoutFront:
    """The front over the networks of a layout, for the indices of `trade_off`."""

    layout: str
    heading: str
    result: NetworkFront


@dataclass(frozen=True, eq=False)
class StudySearch:
    """Result folder of a search, with the networks found for each layout and index."""

    folder: Path
    study: Study
    searches: tuple[LayoutSearch, ...]
    fixed: tuple[Outcome, ...] = ()  # designs of the layouts without a free network
    fronts: tuple[LayoutFront, ...] = ()
    computed: int = 0  # networks that this run searched; the others were there already

    @property
    def status(self) -> Status:
        """`failed` if no network has a value for some layout and index."""
        if all(one.result.ranking for one in self.searches):
            return OK
        return Status(StatusKind.FAILED, "no network has a value for some of the indices")


def searched_mounts(study: Study, layout: str) -> list[str]:
    """Mounts of a layout whose network has a free network in it."""
    struts = study.layouts[layout].struts
    return [mount for mount, text in struts.items() if any(name in study.free_networks for name in names(text))]


def search_study(
    study: Study,
    folder: str | Path,
    *,
    jobs: int = 1,
    executor: Executor | Pool | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress = lambda done, total, last, n_failures: None,
    compiling: ProgressCallback | None = None,
    on_groups: Callable[[list[GroupResult]], object] = lambda groups: None,
    finish: Callable[[StudySearch, Path], object] = lambda result, folder: None,
) -> StudySearch:
    """Search the networks of `study` into `folder`, and write the resolved study and the table of all networks.

    Arguments and the journal are those of `run_study`; `progress` counts networks. With `resume`, networks in the
    journal are not searched again, and the results are the same, byte for byte. `on_groups` is called with the groups
    of networks in the journal, and then with others as completed, each time before `progress`.

    Raises what `run_study` raises, and `StudyError` for a study that cannot be searched.
    """
    study = replace(study, indices=tuple(dict.fromkeys([*study.indices, *study.trade_off])))
    plans = search_plans(study)
    mode = WriteMode(Path(folder), "search", _result_names(), study.inputs, resume, force)
    with open_results(mode) as results, worker_pool(jobs, executor) as pool:
        search = _Search(study, results, pool, progress, compiling, on_groups)
        with search.work.journalling():
            found = _search(study, plans, search, results.folder)
        write_study(study, results.draft)
        for name, table in tables_of(found).items():
            write_text(results.draft / name, csv_text(csv_rows(table)))
        results.publish()
        finish(found, results.draft)
    return found


def _result_names() -> tuple[str, ...]:
    return (journals.NAME, RESOLVED, TABLE, FRONT_TABLE, REAL_TABLE, VERSIONS, f"{FIGURES}/", REPORT)


def tables_of(found: StudySearch) -> dict[str, Table]:
    """Tables of a search by the names of their files."""
    tables = {TABLE: networks_table(found)}
    if found.fronts:
        tables[FRONT_TABLE] = front_table(found)
    if found.study.real_inerters is not None:
        tables[REAL_TABLE] = real_table(found)
    return tables


def _search(study: Study, plans: Mapping[tuple[str, str], SearchPlan], search: _Search, folder: Path) -> StudySearch:
    """Networks for each index, then their front, then the best of them with real inerters."""
    search.prepare(_kernels(study, plans), *_parts(study, plans))
    outcomes = tuple(one for one in search.compute(_parts(study, plans)) if isinstance(one, Outcome))
    searches = list(_searches(study, plans, search.done))
    fronts = tuple(_fronts(study, plans, searches, search)) if study.trade_off else ()
    parts = [part for one in searches for part in _real_parts(study, one)]
    real = [one for one in search.compute(parts) if isinstance(one, RealResult)]
    search.end()
    searches = [
        replace(one, real=tuple(each for each in real if (each.layout, each.index) == (one.layout, one.index)))
        for one in searches
    ]
    return StudySearch(folder, study, tuple(searches), outcomes, fronts, search.computed)


def _fronts(
    study: Study, plans: Mapping[tuple[str, str], SearchPlan], searches: Sequence[LayoutSearch], search: _Search
) -> Iterator[LayoutFront]:
    """The front over the networks of each layout; the waves are those of an uninterrupted search."""
    layouts = list(dict.fromkeys(layout for layout, _ in plans))
    for layout in layouts:
        plan = FrontPlan(tuple(replace(plans[layout, index]) for index in study.trade_off), study.points)
        own = {one.index: one.result for one in searches if one.layout == layout}
        waves, number = front_waves(plan, [own[index] for index in study.trade_off]), 0
        *titles, last = (study.index(index).title for index in study.trade_off)
        heading = f"trade-off between {', '.join(titles)} and {last}"
        try:
            scale, tasks = next(waves)
            while True:
                sent = replace(plan, plans=tuple(map(replace, plan.plans)))
                parts = [
                    NetworkFrontPart(layout, number, plan.plans[0].topology_text(one.topology), one, sent, scale)
                    for one in tasks
                ]
                found = [one for one in search.compute(parts) if isinstance(one, NetworkFrontResult)]
                scale, tasks = waves.send([one.network_points() for one in found])
                number += 1
        except StopIteration as end:
            yield LayoutFront(layout, f"{heading}{f', {layout}' if len(layouts) > 1 else ''}", end.value)


def _real_parts(study: Study, one: LayoutSearch) -> Iterator[RealPart]:
    """The best networks of a search with inerters in them, and the baseline, by each method of `real_inerters`."""
    if study.real_inerters is None:
        return
    searched = searched_layouts(study)
    chosen = [found for found in one.result.ranking if not found.simpler][: study.real_inerters.best]
    chosen = [found for found in dict.fromkeys([*one.result.frontier, *chosen]) if found.topology.counts["b"]]
    for method in study.real_inerters.methods:
        if study.baseline is not None and study.baseline not in searched:
            yield RealPart(one.layout, one.index, method, "")
        for found in chosen:
            yield RealPart(one.layout, one.index, method, found.layout, replace(found, plan=replace(found.plan)))


def _parts(study: Study, plans: Mapping[tuple[str, str], SearchPlan]) -> list[Case | NetworkGroup]:
    """Layouts without a free network, then groups of networks, for each index."""
    fixed = [Case(layout, index) for layout in fixed_part(study).layouts for index in study.indices]
    groups = [
        NetworkGroup(layout, index, number, topologies, plan)
        for (layout, index), plan in plans.items()
        for number, topologies in enumerate(plan.groups())
    ]
    return [*fixed, *groups]


class _Search:
    """The results of a search so far, by their parts, and their progress."""

    def __init__(
        self,
        study: Study,
        results: Results,
        pool: Pool,
        progress: Progress,
        compiling: ProgressCallback | None,
        on_groups: Callable[[list[GroupResult]], object],
    ) -> None:
        self.done: dict[Any, PartResult] = {}
        self.work = StudyWork(study, results, pool, self._enter, result_of)
        self.progress, self.compiling, self.on_groups = progress, compiling, on_groups
        self.total = self.ready = 0  # networks of all parts so far, and those with a result
        self.computed = 0  # those of this run
        self.more = int(bool(study.trade_off) or study.real_inerters is not None)  # whether further parts will follow

    def _enter(self, result: PartResult) -> None:
        self.done[result.part] = result

    def prepare(self, kernels: list[Any], *parts: StudyPart[Any]) -> None:
        """Compile what the parts call, unless all of them are done."""
        if any(part not in self.done for part in parts):
            prepare_on(self.work.pool, kernels, self.compiling)

    def compute(self, parts: Sequence[StudyPart[Any]]) -> list[PartResult]:
        """Results of the parts, in their order."""
        sizes = {part: len(part.topologies) if isinstance(part, NetworkGroup) else 1 for part in parts}
        known, is_begun = [self.done[part] for part in parts if part in self.done], self.total > 0
        pending = [part for part in parts if part not in self.done]
        self.total += sum(sizes.values())
        self.ready += sum(sizes[one.part] for one in known)
        if not is_begun:
            self._tell(known, None)
        designs = {part: one for part, one in self.done.items() if isinstance(one, Outcome)}
        for ready in self.work.compute(pending, designs):
            self.ready += sum(sizes[one.part] for one in ready)
            self._tell(ready, ready[-1])
        check_all_results(len(parts) - len(set(parts) - set(self.done)), len(parts))
        self.computed += sum(sizes[part] for part in pending)
        return [self.done[part] for part in parts]

    def end(self) -> None:
        """Tell that no more parts follow."""
        if self.more:
            self.more = 0
            self._tell([], next(reversed(self.done.values()), None))

    def _tell(self, ready: Collection[PartResult], last: PartResult | None) -> None:
        self.on_groups([one for one in ready if isinstance(one, GroupResult)])
        troubled = sum(not one.ok for one in self.done.values())
        self.progress(self.ready, self.total + self.more, last, troubled)


def _kernels(study: Study, plans: Mapping[tuple[str, str], SearchPlan]) -> list[Any]:
    """The compiled code that the work calls."""
    found = [kernel for plan in plans.values() for kernel in plan.kernels()]
    if study.trade_off:
        found += FrontPlan(tuple(plans.values()), study.points).kernels()
    fixed = fixed_part(study)
    if fixed.layouts:
        found += kernels(fixed)
    elif others := [plan for plan in plans.values() if plan.compiled_index is None]:
        found += kernels(study, others[0].design(others[0].topologies[-1]))
    for method in study.real_inerters.methods if study.real_inerters is not None else ():
        plan = next(iter(plans.values()))
        found += kernels(replace(study, optimise=method, evaluate=()), plan.design(plan.topologies[-1]))
    return list(dict.fromkeys(found))


def _searches(
    study: Study, plans: Mapping[tuple[str, str], SearchPlan], done: Mapping[Any, PartResult]
) -> Iterator[LayoutSearch]:
    """Results of the search by layout and index."""
    several = len(searched_layouts(study)) > 1
    for (layout, index), plan in plans.items():
        own = [
            one for one in done.values() if isinstance(one, GroupResult) and (one.layout, one.index) == (layout, index)
        ]
        base = done.get(Case(study.baseline or "", index))
        baseline = base.feasible_values(study.evaluate[0]).get(index, nan) if isinstance(base, Outcome) else nan
        heading = f"{study.index(index).title} ({index}){f', {layout}' if several else ''}"
        result = collect_results(plan, [network for one in own for network in one.optima()])
        yield LayoutSearch(layout, index, heading, result, baseline)
