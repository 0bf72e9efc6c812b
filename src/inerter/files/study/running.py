"""Running a study into a result folder, from the start or from where it was interrupted."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from inerter.atomic_io import write_netcdf, write_text
from inerter.deprecation import RenamedAttribute
from inerter.errors import OK, Status, StatusKind, StudyError
from inerter.files.common.folder import FIGURES, REPORT, Results, WriteMode, open_results
from inerter.files.study import journal as journals
from inerter.files.study.cases import Outcome
from inerter.files.study.checking import check_study, kernels
from inerter.files.study.parts import PartResult, StudyPart
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.results import DatasetBuilder
from inerter.files.study.study import Study
from inerter.files.study.summary import write_summary
from inerter.files.study.task_registry import TASKS
from inerter.files.study.tasks import Answer, TaskResults, by_task, parts_of
from inerter.files.study.work import StudyWork
from inerter.formatting import format_list
from inerter.kernels.prepare import ProgressCallback, prepare_on
from inerter.table import csv_rows, csv_text
from inerter.validation import checked
from inerter.work.origin import versions
from inerter.work.pool import Pool, worker_pool
from inerter.work.returns import check_all_results

RESOLVED, SUMMARY, DATASET, VERSIONS = "study.resolved.toml", "summary.csv", "results.nc", "versions.json"
Progress = Callable[[int, int, PartResult | None, int], None]


@dataclass(frozen=True, eq=False)
class StudyResult:
    """Result folder of a study, with its dataset and the answers to its tasks."""

    folder: Path
    study: Study
    data: xr.Dataset
    computed: int  # cases that this run computed; the others were there already
    answers: tuple[Answer, ...] = ()  # to the parts of its tasks
    failed: bool = False  # whether a case or a part has no number at all

    not_ok = RenamedAttribute("n_failures")
    failing = RenamedAttribute("iterate_failures")

    @property
    def status(self) -> Status:
        """`failed` if a case or a part has no number at all, `infeasible` if no design has a value of some index.

        The status of each design is a value of `data`.
        """
        if self.failed:
            return Status(StatusKind.FAILED, "no number for some of the designs or answers")
        values = self.data["value"]
        lost = [index for index in values["index"].values.tolist() if np.isnan(values.sel(index=index).values).all()]
        return Status(StatusKind.INFEASIBLE, f"no feasible design for {format_list(lost)}") if lost else OK

    @property
    def failures(self) -> list[str]:
        """Lines, one for every design or answer whose status is not ok."""
        return list(self.iterate_failures())

    @property
    def n_failures(self) -> int:
        """Number of lines in `failures`."""
        designs = int(np.count_nonzero(self.data.status.values != StatusKind.OK.value))
        return designs + sum(not answer.ok for answer in self.answers)

    def iterate_failures(self) -> Iterator[str]:
        """The lines of `failures`, one by one."""
        return (f"{name}: {status}" for name, status in self.statuses_not_ok())

    def statuses_not_ok(self) -> Iterator[tuple[str, str]]:
        """Name and status of every design or answer whose status is not ok."""
        status = self.data.status
        labels = [status[dim].values.tolist() for dim in status.dims]
        for place in np.argwhere(status.values != StatusKind.OK.value):
            names = (str(column[i]) for column, i in zip(labels, place, strict=True))
            yield " ".join(names), str(status.values[tuple(place)])
        for answer in self.answers:
            if not answer.ok:
                yield answer.name, answer.status_text


@checked(StudyError)
def run_study(
    study: Study,
    folder: str | Path | Results,
    *,
    jobs: int = 1,
    executor: Executor | Pool | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress = lambda done, total, last, n_failures: None,
    compiling: ProgressCallback | None = None,
    finish: Callable[[StudyResult, Path], object] = lambda result, folder: None,
) -> StudyResult:
    """Run `study` into `folder`, and write the resolved study, the summary and the dataset.

    `folder` may be a part of results that are being written. `jobs` is a number of processes of our own: with more
    than one, a script that calls this needs the line `if __name__ == "__main__":`, because processes are started
    afresh and import it. An `executor` (of `concurrent.futures`, of a dask client, of mpi4py) works in their place, and
    goes on afterwards. Results do not depend on it. `progress(done, total, last, not_ok)` is called whenever some are
    done: numbers of designs and parts, the last one, and the number whose status is not ok. `finish` may add files to
    the results, in the folder that it is given. What the work needs of compiled code is compiled first, if it is not
    yet; `compiling` is called when a kernel is begun, with its title, its number from 1 and how many there are.

    Every finished case is in the journal at once, or those that were handed out together when the last of them is done.
    So are searches of a case that goes on, about once a second; `inerter.progress` tells of these. With `resume`, cases
    and searches in the journal are not computed again, and the results are the same, byte for byte, as those of an
    undisturbed run. With `force`, the results that the folder holds stay until these are whole.

    Raises `StudyError` if the folder holds something and neither `resume` nor `force` is given, if it holds what is not
    from this study, or if another run is writing to it, and then nothing has been changed; `WorkError` if the disk is
    full, or an executor has ended, or its processes have another version.

    >>> import inerter as it
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> text = '''
    ... title = "Which damper?"
    ... vehicle = {model = "quarter-car", sprung_mass = "250 kg", unsprung_mass = "35 kg", tyre_stiffness = "180 kN/m"}
    ... road = {speed = "25 m/s", class = "B"}
    ... elements = {k = "60 kN/m", c = {from = "1 kN s/m", to = "9 kN s/m"}}
    ... layouts = {S1 = "k | c"}
    ... study = {indices = ["J1"], optimise = "norm"}
    ... '''
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "damper.toml"
    ...     _ = path.write_text(text)
    ...     done = it.run_study(it.load_study(path), Path(folder) / "out")
    >>> done.data.value.dims, done.n_failures
    (('layout', 'index', 'method'), 0)
    """
    check_study(study)
    with _into(study, folder, resume, force) as results, worker_pool(jobs, executor) as pool:
        gathered, answers, computed = _compute_outcomes(study, results, pool, progress, compiling)
        data = gathered.dataset()
        write_study(study, results.draft)
        for task, own in by_task(answers).items():
            data = task.add_to_dataset(study, data, own)
            table = task.table(TaskResults(study, data, own))
            write_text(results.draft / csv_of(task.key), csv_text(csv_rows(table)))
        write_summary(results.draft / SUMMARY, study, data)
        write_netcdf(results.draft / DATASET, data)
        results.publish()
        kinds = {*gathered.kinds, *(one.status for one in answers)}
        failed = StatusKind.FAILED in kinds
        result = StudyResult(results.folder, study, data, computed, answers, failed)
        finish(result, results.draft)
    return result


def csv_of(key: str) -> str:
    """The name of the file with the answers to the task of that key."""
    return f"{key}.csv"


def result_names() -> tuple[str, ...]:
    """Names of files and folders that a result folder may hold."""
    tables = map(csv_of, TASKS)
    return (journals.NAME, RESOLVED, SUMMARY, DATASET, *tables, VERSIONS, f"{FIGURES}/", REPORT)


def write_study(study: Study, folder: Path) -> None:
    """Write the resolved study, and the provenance of its results: versions, seed, SHA-256 of a measured profile."""
    write_text(folder / RESOLVED, write_resolved(study))
    measured = {} if study.line is None else {"inputs": {study.line.path.name: study.line.digest}}
    origins = {**versions(), "seed": study.seed, **measured}
    write_text(folder / VERSIONS, json.dumps(origins, indent=2) + "\n")


@contextmanager
def _into(study: Study, folder: str | Path | Results, resume: bool, force: bool) -> Iterator[Results]:
    if isinstance(folder, Results):
        yield folder
        return
    with open_results(WriteMode(Path(folder), "run", result_names(), study.inputs, resume, force)) as results:
        yield results


def _compute_outcomes(
    study: Study, results: Results, pool: Pool, progress: Progress, compiling: ProgressCallback | None
) -> tuple[DatasetBuilder, tuple[Answer, ...], int]:
    """All cases, the answers of tasks in the order of their parts, and how many cases were not in the journal."""
    found = DatasetBuilder(study)
    done: dict[StudyPart[Any], Answer] = {}

    def enter(result: PartResult) -> None:
        if isinstance(result, Outcome):
            found.enter(result)
        elif isinstance(result, Answer):
            done[result.part] = result

    work = StudyWork(study, results, pool, enter)
    parts = parts_of(study)
    pending, left = found.pending(), [part for part in parts if part not in done]
    if pending or left:
        _prepare(pool, study, compiling)
    total = len(found.cases) + len(parts)

    def tell(last: PartResult | None) -> None:
        troubled = sum(not one.ok for one in done.values())
        progress(found.count + len(done), total, last, found.n_failures + troubled)

    tell(None)
    with work.journalling():
        for ready in chain(work.compute(pending, {}), work.compute(left, found.designs)):
            tell(ready[-1])
        check_all_results(total - len(found.pending()) - len(set(parts) - set(done)), total)
    return found, tuple(done[part] for part in parts), len(pending)


def _prepare(pool: Pool, study: Study, compiling: ProgressCallback | None) -> None:
    """Compile the kernels that the work needs, where it runs, before several processes would do so at once."""
    if pool.is_cluster and compiling is not None:
        compiling("those that machines of the cluster lack", 1, 1)
    prepare_on(pool, kernels(study), compiling)
