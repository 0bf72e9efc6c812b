"""Running a study into a result folder, from the start or from where it was interrupted."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import xarray as xr

from inerter.errors import StatusKind
from inerter.files.common.folder import FIGURES, REPORT, Intent, Results, claimed
from inerter.files.study import journal as journals
from inerter.files.study.budgets import BudgetOutcome, budget_cases, budgets_csv, run_budget
from inerter.files.study.cases import Case, Outcome, cases, lost_case, run_case
from inerter.files.study.checking import check_study, kernels
from inerter.files.study.results import dataset, summary_csv
from inerter.files.study.study import Study, write_resolved
from inerter.kernels.prepare import Told, prepare
from inerter.work.origin import versions
from inerter.work.pool import Pool, pooled
from inerter.writing import write_netcdf, write_text

RESOLVED, SUMMARY, DATASET, VERSIONS = "study.resolved.toml", "summary.csv", "results.nc", "versions.json"
BUDGETS = "budgets.csv"
NAMES = (journals.NAME, RESOLVED, SUMMARY, DATASET, BUDGETS, VERSIONS, f"{FIGURES}/", REPORT)
_ANSWERS = (StatusKind.OK.value, StatusKind.UNBOUNDED.value)  # better at every value is an answer too
Progress = Callable[[int, int, Outcome | BudgetOutcome | None], None]


@dataclass(frozen=True, eq=False)
class StudyResult:
    """Where the results are, and what they are."""

    folder: Path
    study: Study
    data: xr.Dataset
    computed: int  # cases that this run computed; the others were there already
    budgets: tuple[BudgetOutcome, ...] = ()
    failed: bool = False  # whether a case or a budget has no number at all

    @property
    def failures(self) -> list[str]:
        """One line for every design whose status is not ok."""
        lines = []
        stacked = self.data.status.stack(case=self.data.status.dims)
        for item in stacked:
            if item.item() != "ok":
                lines.append(f"{' '.join(str(part) for part in item.case.item())}: {item.item()}")
        lines += [
            f"budget of {found.parameter}, {found.layout} {found.index}: {found.status}: {found.message}"
            for found in self.budgets
            if found.status not in _ANSWERS
        ]
        return lines


def run_study(
    study: Study,
    folder: str | Path | Results,
    *,
    jobs: int = 1,
    executor: Executor | Pool | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress = lambda done, total, outcome: None,
    compiling: Told | None = None,
    finish: Callable[[StudyResult, Path], object] = lambda result, folder: None,
) -> StudyResult:
    """Run `study` into `folder`, and write the resolved study, the summary and the dataset.

    `folder` may be a part of results that are being written. `jobs` is a number of processes of our own: with more
    than one, a script that calls this needs the line `if __name__ == "__main__":`, because processes are started
    afresh and import it. An `executor` (of `concurrent.futures`, of a dask client, of mpi4py) works in their place, and
    goes on afterwards. Results do not depend on it. `progress` is told
    how many designs and budgets are done, how many there are, and the last one. `finish` may add files to the results,
    in the folder that it is given. What the work needs of compiled code is compiled first, if it is not yet;
    `compiling` is called when a kernel is begun, with its title, its number from 1 and how many there are.

    Every finished case is in the journal at once. With `resume`, cases in the journal are not computed again, and the
    results are the same, byte for byte, as those of an undisturbed run. With `force`, the results that the folder holds
    stay until these are whole.

    Raises `StudyError` if the folder holds something and neither `resume` nor `force` is given, if it holds what is not
    from this study, or if another run is writing to it, and then nothing has been changed; `WorkError` if the disk is
    full, or an executor has ended, or its processes have another version.
    """
    check_study(study)
    with _into(study, folder, resume, force) as results, pooled(jobs, executor) as pool:
        done, budgets, computed = _computed(study, results, pool, progress, compiling)
        found = tuple(budgets[case] for case in budget_cases(study))
        data = dataset(study, done)
        write_text(results.draft / RESOLVED, write_resolved(study))
        write_text(results.draft / VERSIONS, json.dumps({**versions(), "seed": study.seed}, indent=2) + "\n")
        if found:
            write_text(results.draft / BUDGETS, budgets_csv(found))
        write_text(results.draft / SUMMARY, summary_csv(study, data))
        write_netcdf(results.draft / DATASET, data)
        results.publish()
        kinds = (*(outcome.kind for outcome in done.values()), *(budget.status for budget in found))
        result = StudyResult(results.folder, study, data, computed, found, StatusKind.FAILED in kinds)
        finish(result, results.draft)
    return result


@contextmanager
def _into(study: Study, folder: str | Path | Results, resume: bool, force: bool) -> Iterator[Results]:
    if isinstance(folder, Results):
        yield folder
        return
    with claimed(Intent(Path(folder), "run", NAMES, (study.path,), resume, force)) as results:
        yield results


def _computed(
    study: Study, results: Results, pool: Pool, progress: Progress, compiling: Told | None
) -> tuple[journals.Done, journals.Budgets, int]:
    """All cases and budgets, and how many cases were not in the journal."""
    journal = journals.journal_of(study, results.place / journals.NAME)
    before = journal.read() if results.resume else []
    done, budgets = journals.finished(journal.path, before)
    everything, further = cases(study), budget_cases(study)
    pending = [case for case in everything if case not in done]
    if pending:
        _prepare(pool, study, compiling)
    total, computed = len(everything) + len(further), len(pending)
    progress(len(done) + len(budgets), total, None)
    results.list_journal(journals.NAME)
    with journal.appending(before) as append:
        for outcome in _outcomes(study, pending, pool):
            append(outcome.to_json())
            done[outcome.case] = outcome
            progress(len(done) + len(budgets), total, outcome)
        for case in further:
            if case not in budgets:
                budgets[case] = run_budget(study, case, done, pool.jobs)
                append(budgets[case].to_json())
                progress(len(done) + len(budgets), total, budgets[case])
    return done, budgets, computed


def _outcomes(study: Study, pending: Sequence[Case], pool: Pool) -> Iterator[Outcome]:
    here = partial(run_case, study, threads=pool.jobs)
    return pool.spread(partial(run_case, study), pending, here, partial(lost_case, study))


def _prepare(pool: Pool, study: Study, compiling: Told | None) -> None:
    """Compile what the work calls, where it is done, before several processes would do so at once."""
    wanted = kernels(study)
    if pool.is_cluster and compiling is not None:
        compiling("on each machine of the cluster", 1, 1)
    if not pool.on_each_node(prepare, wanted):
        prepare(wanted, compiling)
