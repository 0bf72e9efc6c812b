"""Reproduction of the whole paper: its parts as lists of small tasks, spread over processes and kept in a journal."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from pathlib import Path

import xarray as xr

from inerter.files.common.folder import FIGURES, REPORT, Results, WriteMode, open_results
from inerter.files.study.running import StudyResult, result_names, run_study
from inerter.kernels.cache import is_kept
from inerter.kernels.prepare import prepare
from inerter.papers.wang_su_2008 import agreement, between, beyond, curves, linear, rig, rows
from inerter.papers.wang_su_2008.claims import judge
from inerter.papers.wang_su_2008.items import Numbers, PaperItem, work
from inerter.papers.wang_su_2008.judging import Claim, Evidence
from inerter.papers.wang_su_2008.linear import LinearTables
from inerter.papers.wang_su_2008.paper import PAPER, PARTS
from inerter.papers.wang_su_2008.rig import RigTest
from inerter.papers.wang_su_2008.rows import SimulatedRow
from inerter.papers.wang_su_2008.source import study
from inerter.simulation.event_driven import KERNELS
from inerter.work.journal import Journal
from inerter.work.pool import Pool, worker_pool

JOURNAL = "tasks.jsonl"
_CLAIMS = ("linear", "table1", "table2", "table3", "figure13", "figure14")  # what all claims need
_ORDER = (
    "rig",
    "table1",
    "table2",
    "table3",
    "curves",
    "between",
    "methods",
    "optima",
    "budgets",
)  # of tasks in results
TABLES = (
    *("rig", "figure8", "figure9", "figure10"),  # of the virtual rig
    *("linear-rows", "designs", "simulated-rows", "curves", "claims", "methods", "optima", "budgets", "origins"),
)
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, eq=False)
class Reproduction:
    """Results of the reproduction; None or empty where not requested."""

    parts: tuple[str, ...]
    studies: dict[str, StudyResult] = field(default_factory=dict)
    rig: RigTest | None = None
    linear: LinearTables | None = None
    rows: dict[tuple[int, str], SimulatedRow] = field(default_factory=dict)
    curves: xr.Dataset | None = None  # Figures 11, 13 and 14 over k
    methods: dict[str, Numbers] = field(default_factory=dict)
    optima: dict[str, Numbers] = field(default_factory=dict)
    budgets: dict[str, Numbers] = field(default_factory=dict)
    claims: list[Claim] = field(default_factory=list)

    @property
    def figure11(self) -> xr.Dataset | None:
        """Dataset of Figure 11."""
        return _figure11(self.studies)


def reproduce(
    folder: Path,
    *,
    only: Sequence[str] = (),
    jobs: int = 1,
    executor: Executor | Pool | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress = lambda what, done, total: None,
    finish: Callable[[Reproduction, Path, Pool], object] = lambda found, folder, pool: None,
) -> Reproduction:
    """Recompute the paper, or some of its `PARTS`, into `folder`; what was finished before is kept with `resume`.

    With `force`, the results that the folder holds stay until these are whole. `finish` may add files to the results,
    in the folder that it is given.

    Raises `StudyError` if `folder` holds something and neither `resume` nor `force` is given.
    """
    wanted = set(only or PARTS) | (set(_CLAIMS) if not only or "claims" in only else set())
    drawn = [figure for figure in ("figure13", "figure14") if figure in wanted]
    needed = linear.STUDIES if "linear" in wanted else ("figure11",) if drawn else ()
    intent = WriteMode(folder, "reproduce", _result_names(), resume=resume, force=force)
    with open_results(intent) as results, worker_pool(jobs, executor) as pool:
        if needed and wanted > {"linear"} and not resume and not pool.on_each_node(_warm_up):
            pool.begin(_warm_up)
        studies = {
            name: run_study(study(name), results.within(name), executor=pool, progress=_with_name(progress, name))
            for name in needed
        }
        listed = {"optima": beyond.optimum_names, "budgets": beyond.budget_names, "methods": agreement.names}
        tasks = [PaperItem("rig", rig.NAME)] if "rig" in wanted else []
        tasks += [PaperItem(part, name) for part, names in listed.items() if part in wanted for name in names()]
        tasks += [
            PaperItem(f"table{number}", name)
            for number in (2, 3, 1)
            if f"table{number}" in wanted
            for name in rows.names(number)
        ]
        figure11 = _figure11(studies)
        if figure11 is not None and "linear" in wanted:
            tasks += [PaperItem("between", name) for name in between.names(figure11)]
        if drawn:
            names = dict.fromkeys(name for figure in drawn for name in curves.names(figure))
            tasks += _curve_points(names, studies["figure11"].data["parameter_value"])
        found = _put_together(
            tuple(part for part in PARTS if part in wanted), studies, _run(tasks, results, pool, progress)
        )
        finish(found, results.draft, pool)
    return found


def _result_names() -> tuple[str, ...]:
    """Names of files and folders that a result folder may hold."""
    studies = (f"{folder}/{name}" for folder in linear.STUDIES for name in ("", *result_names()))
    return (JOURNAL, f"{FIGURES}/", REPORT, *(f"{name}.csv" for name in TABLES), *studies)


def _warm_up() -> None:
    """Go through some quick tasks, which compile what simulations need, while others compile what the studies do.

    What is compiled already is loaded by the first task that needs it.
    """
    if all(map(is_kept, KERNELS)):
        return
    prepare(KERNELS)  # first what the linear studies do not compile themselves
    for part, name in (("table1", "J5 4"), ("table1", "J1 4"), ("table3", "J1 3"), ("table3", "J5 3")):
        work(PaperItem(part, name))


def _put_together(
    parts: tuple[str, ...], studies: dict[str, StudyResult], found: dict[tuple[str, str], Numbers]
) -> Reproduction:
    figure11 = _figure11(studies)

    def of(part: str) -> dict[str, Numbers]:
        return {name: numbers for (p, name), numbers in found.items() if p == part}

    recomputed = linear.recompute(studies) if "linear" in parts else None
    judged = {
        (table, name): rows.row_from_json(table, name, numbers)
        for table in (1, 2, 3)
        for name, numbers in of(f"table{table}").items()
    }
    points = of("curves")
    drawn = curves.dataset(points, figure11) if points and figure11 is not None else None
    evidence = Evidence(
        figure11=figure11 if "linear" in parts else None,
        between=of("between"),
        curves=drawn if {"figure13", "figure14"} <= set(parts) else None,
        rows=judged,
        linear={(c.row.table, f"{c.row.index} {c.row.case}"): c.exact for c in recomputed.compared}
        if recomputed
        else {},
    )
    return Reproduction(
        parts=parts,
        studies=studies,
        rig=next(map(rig.rig_test_from_json, of("rig").values()), None),
        linear=recomputed,
        rows=judged,
        curves=drawn,
        methods=of("methods"),
        optima=of("optima"),
        budgets=of("budgets"),
        claims=judge(evidence),
    )


def _figure11(studies: dict[str, StudyResult]) -> xr.Dataset | None:
    return studies["figure11"].data.sel({"method": "norm"}) if "figure11" in studies else None


def _curve_points(names: Iterable[str], best: xr.DataArray) -> list[PaperItem]:
    """Points of Figures 13 and 14 with the parameters of their linear optima, which Figure 11 has found."""
    layouts, indices, parameters = (best[dimension].values.tolist() for dimension in ("layout", "index", "parameter"))
    optima = best.transpose("layout", "index", "k", "parameter").values
    points = []
    for name in names:
        layout, index, point = name.split()
        found = optima[layouts.index(curves.linear_twin(layout)), indices.index(index), int(point)].tolist()
        given = tuple((p, value) for p, value in zip(parameters, found, strict=True) if value == value)
        points.append(PaperItem("curves", name, given))
    return points


def _run(tasks: list[PaperItem], results: Results, pool: Pool, progress: Progress) -> dict[tuple[str, str], Numbers]:
    """Numbers of all tasks, by their keys; each is written to the journal as soon as it is computed."""
    journal = Journal(results.place / JOURNAL, {"paper": PAPER.name})
    before = journal.read() if results.resume else ()
    found = {(entry["part"], entry["name"]): entry["numbers"] for entry in before}
    pending = [task for task in tasks if task.key not in found]
    pending = pending[::2] + pending[1::2]  # neighbours are similar: two processes would compile the same
    if tasks:
        progress("simulations", len(tasks) - len(pending), len(tasks))
    results.list_journal(JOURNAL)
    with journal.appending(results.resume) as append:
        for i, ((part, name), numbers) in enumerate(pool.spread(work, pending), 1):
            found[part, name] = numbers
            append({"part": part, "name": name, "numbers": numbers})
            progress("simulations", len(tasks) - len(pending) + i, len(tasks))
    return {task.key: found[task.key] for task in sorted(tasks, key=lambda task: _ORDER.index(task.part))}


def _with_name(progress: Progress, name: str) -> Callable[[int, int, object, int], None]:
    return lambda done, total, last, n_failures: progress(name, done, total)
