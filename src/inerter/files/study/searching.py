"""Searching a study into a result folder: the best of all networks that the free networks of its layouts may be."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import partial
from math import nan
from pathlib import Path
from typing import Any

from inerter.atomic_io import write_text
from inerter.errors import OK, Status, StatusKind, WorkError
from inerter.files.common.folder import FIGURES, REPORT, Results, WriteMode, open_results
from inerter.files.study import journal as journals
from inerter.files.study.cases import Case, Outcome
from inerter.files.study.checking import fixed_part, kernels, search_plans
from inerter.files.study.parts import PartResult, StudyPart, lost_part, run_part
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.running import RESOLVED, VERSIONS, Progress, origins
from inerter.files.study.search_tables import networks_table
from inerter.files.study.study import Study, searched_layouts
from inerter.kernels.prepare import ProgressCallback, prepare_on
from inerter.network_search.network_optimum import SearchedNetwork
from inerter.network_search.plan import SearchPlan, search_group
from inerter.network_search.results import SearchResult, collect_results
from inerter.networks.enumeration import Topology
from inerter.networks.parser import names
from inerter.table import csv_rows, csv_text
from inerter.work.journal import Journal
from inerter.work.pool import Pool, worker_pool
from inerter.work.progress import logging_steps

TABLE = "search.csv"


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

    layout: str
    index: str
    number: int
    networks: list[dict[str, Any]]  # the fields of each `SearchedNetwork`
    message: str = ""

    @property
    def part(self) -> NetworkGroup:
        """Group to which the result belongs."""
        return NetworkGroup(self.layout, self.index, self.number)

    @property
    def kind(self) -> str:
        """Kind of status: `failed` if the group as a whole has no result."""
        return (StatusKind.FAILED if self.message else StatusKind.OK).value

    def optima(self) -> Iterator[SearchedNetwork]:
        """The networks with what was found for each."""
        for one in self.networks:
            values = {"topology": Topology(_tree(one["topology"])), "values": tuple(one["values"])}
            yield SearchedNetwork(**{**one, **values})


def _tree(entry: Any) -> Any:
    """The tree of a topology from JSON, which has lists for tuples."""
    return entry if isinstance(entry, str) else tuple(map(_tree, entry))


@dataclass(frozen=True, eq=False)
class LayoutSearch:
    """Networks found for a layout and an index, with the index of the baseline; nan without one."""

    layout: str
    index: str
    heading: str  # index, and layout where there are several
    result: SearchResult
    baseline: float = nan


@dataclass(frozen=True, eq=False)
class StudySearch:
    """Result folder of a search, with the networks found for each layout and index."""

    folder: Path
    study: Study
    searches: tuple[LayoutSearch, ...]
    fixed: tuple[Outcome, ...] = ()  # designs of the layouts without a free network
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
    plans = search_plans(study)
    mode = WriteMode(Path(folder), "search", _result_names(), study.inputs, resume, force)
    with open_results(mode) as results, worker_pool(jobs, executor) as pool:
        done, computed = _compute(study, plans, results, pool, progress, compiling, on_groups)
        outcomes = tuple(one for one in done.values() if isinstance(one, Outcome))
        found = StudySearch(results.folder, study, tuple(_searches(study, plans, done)), outcomes, computed)
        write_text(results.draft / RESOLVED, write_resolved(study))
        write_text(results.draft / VERSIONS, json.dumps(origins(study), indent=2) + "\n")
        write_text(results.draft / TABLE, csv_text(csv_rows(networks_table(found))))
        results.publish()
        finish(found, results.draft)
    return found


def _result_names() -> tuple[str, ...]:
    return (journals.NAME, RESOLVED, TABLE, VERSIONS, f"{FIGURES}/", REPORT)


def _parts(study: Study, plans: Mapping[tuple[str, str], SearchPlan]) -> list[Case | NetworkGroup]:
    """Layouts without a free network, then groups of networks, for each index."""
    fixed = [Case(layout, index) for layout in fixed_part(study).layouts for index in study.indices]
    groups = [
        NetworkGroup(layout, index, number, topologies, plan)
        for (layout, index), plan in plans.items()
        for number, topologies in enumerate(plan.groups())
    ]
    return [*fixed, *groups]


def _compute(
    study: Study,
    plans: Mapping[tuple[str, str], SearchPlan],
    results: Results,
    pool: Pool,
    progress: Progress,
    compiling: ProgressCallback | None,
    on_groups: Callable[[list[GroupResult]], object],
) -> tuple[dict[Any, PartResult], int]:
    """Results of all parts, and the number of networks that were not in the journal."""
    parts = _parts(study, plans)
    sizes = {part: len(part.topologies) if isinstance(part, NetworkGroup) else 1 for part in parts}
    journal = journals.journal_of(study, results.place / journals.NAME)
    done: dict[Any, PartResult] = {one.part: one for one in _read(journal)} if results.resume else {}
    pending = [part for part in parts if part not in done]
    if pending:
        prepare_on(pool, _kernels(study, plans), compiling)

    def tell(ready: Collection[PartResult], last: PartResult | None) -> None:
        on_groups([one for one in ready if isinstance(one, GroupResult)])
        troubled = sum(not one.ok for one in done.values())
        progress(sum(sizes[part] for part in done), sum(sizes.values()), last, troubled)

    tell(done.values(), None)
    results.list_journal(journals.NAME)
    run = partial(_result, study)
    with logging_steps(), journal.appending(results.resume) as append:
        for ready in pool.batches(run, pending, partial(run, threads=pool.jobs), partial(lost_part, study)):
            append(*(one.to_json() for one in ready))
            done |= {one.part: one for one in ready}
            tell(ready, ready[-1])
    lost = len(set(parts) - set(done))
    if lost:
        raise WorkError(f"the executor returned no result for {lost} of {len(parts)} parts, and others twice.")
    return {part: done[part] for part in parts}, sum(sizes[part] for part in pending)


def _result(study: Study, part: StudyPart[Any], threads: int = 1) -> PartResult:
    result: PartResult = run_part(study, {}, part, threads)
    return result


def _read(journal: Journal) -> Iterator[PartResult]:
    for entry in journal.read():
        yield GroupResult(**entry) if "networks" in entry else Outcome(**entry)


def _kernels(study: Study, plans: Mapping[tuple[str, str], SearchPlan]) -> list[Any]:
    """The compiled code that the work calls."""
    found = [kernel for plan in plans.values() for kernel in plan.kernels()]
    fixed = fixed_part(study)
    if fixed.layouts:
        found += kernels(fixed)
    elif others := [plan for plan in plans.values() if plan.compiled is None]:
        found += kernels(study, others[0].design(others[0].topologies[-1]))
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
        baseline = base.values[study.evaluate[0]].get(index, nan) if isinstance(base, Outcome) and base.values else nan
        heading = f"{study.index(index).title} ({index}){f', {layout}' if several else ''}"
        result = collect_results(plan, [network for one in own for network in one.optima()])
        yield LayoutSearch(layout, index, heading, result, baseline)
