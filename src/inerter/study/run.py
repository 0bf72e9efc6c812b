"""Running a study into a result folder, from the start or from where it was interrupted."""

from __future__ import annotations

import json
import platform
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

import xarray as xr
from filelock import FileLock, Timeout

import inerter
from inerter.errors import InerterError, StatusKind, StudyError
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.networks.parser import names
from inerter.optimisation.optimise import check_variables
from inerter.study import journal as journals
from inerter.study.budgets import BudgetOutcome, budget_cases, budgets_csv, run_budget
from inerter.study.cases import Outcome, cases, design_notes
from inerter.study.journal import Journal
from inerter.study.registry import INDEX, METHOD
from inerter.study.results import dataset, summary_csv
from inerter.study.values import Study, write_resolved
from inerter.study.workers import Crew, crewed, run_all
from inerter.vehicle.cars import Vehicle

RESOLVED, SUMMARY, DATASET, VERSIONS = "study.resolved.toml", "summary.csv", "results.nc", "versions.json"
BUDGETS = "budgets.csv"
FIGURES, REPORT = "figures", "report.html"
OWN = (journals.NAME, RESOLVED, SUMMARY, DATASET, BUDGETS, VERSIONS, FIGURES, REPORT)
_LOCK = ".lock"
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


def check_study(study: Study) -> None:
    """Assemble every layout for every index at every swept value, so that what is ill-posed shows before any work.

    Raises `StudyError` with a line for every layout that cannot be analysed.
    """
    problems = []
    for layout in study.layouts:
        for swept in study.sweep.values if study.sweep else (None,):
            try:
                _check_design(study, study.design(layout, swept))
            except InerterError as error:
                problems.append(f"{study.path}: layouts.{layout}: {error}")
                break
    if problems:
        raise StudyError("\n".join(problems))


def _check_design(study: Study, vehicle: Vehicle) -> None:
    mechanism = vehicle.mechanism()
    questions = [INDEX[name](study).question(mechanism) for name in study.indices]
    if "norm" in study.methods:
        for question in questions:
            linear_problem(mechanism, question, CONVENTIONS[study.conventions])
    else:
        from inerter.systems.piecewise import piecewise  # loads the compiler

        free = vehicle.free_values().items()
        piecewise(vehicle.with_values({name: (value.lower * value.upper) ** 0.5 for name, value in free}))
    if study.optimise is not None and vehicle.free_values():
        check_variables(vehicle)
        method = METHOD[study.optimise](replace(study, relative_error=None))  # which would take simulations
        for name in study.indices:
            method.objective(vehicle, INDEX[name](study))


def study_notes(study: Study) -> list[str]:
    """What a person should know before the work: elements that nothing uses, and what linear analysis leaves out."""
    notes: dict[str, list[str]] = {}
    for layout in study.layouts:
        for note in design_notes(study, study.design(layout).mechanism()):
            notes.setdefault(note, []).append(layout)
    used = {name for layout in study.layouts.values() for text in layout.struts.values() for name in names(text)}
    unused = [name for name in study.elements if name not in used]
    return [f"{', '.join(layouts)}: {note}" for note, layouts in notes.items()] + (
        [f"no layout uses {', '.join(unused)}"] if unused else []
    )


def run_study(
    study: Study,
    folder: Path,
    *,
    jobs: int | Crew = 1,
    resume: bool = False,
    force: bool = False,
    progress: Progress = lambda done, total, outcome: None,
) -> StudyResult:
    """Run `study` into `folder`, and write the resolved study, the summary and the dataset.

    `jobs` is a number of processes, or a crew, which goes on afterwards. With more than one process, a script that
    calls this needs the line `if __name__ == "__main__":`, because processes are started afresh and import it.

    Every finished case is in the journal at once. With `resume`, cases in the journal are not computed again, and the
    results are the same, byte for byte, as those of an undisturbed run.

    Raises `StudyError` if the folder holds something and neither `resume` nor `force` is given, if it holds another
    study's results, or if another run is writing to it; `WorkError` if a process is killed.
    """
    check_study(study)
    with claimed(folder, own=OWN, resume=resume, force=force):
        journal = Journal(folder / journals.NAME, study)
        write_text(folder / RESOLVED, write_resolved(study))
        write_text(folder / VERSIONS, json.dumps({**versions(), "seed": study.seed}, indent=2) + "\n")
        done, budgets = journal.read_all() if resume else ({}, {})
        if not done:
            journal.start()
        everything, further = cases(study), budget_cases(study)
        pending = [case for case in everything if case not in done]
        total, computed = len(everything) + len(further), len(pending)
        progress(len(done) + len(budgets), total, None)
        with crewed(jobs) as crew, journal.appending() as writer:
            for outcome in run_all(study, pending, crew):
                writer.write(outcome)
                done[outcome.case] = outcome
                progress(len(done) + len(budgets), total, outcome)
            for case in further:
                if case not in budgets:
                    budgets[case] = run_budget(study, case, done, crew.jobs)
                    writer.write(budgets[case])
                    progress(len(done) + len(budgets), total, budgets[case])
        found = tuple(budgets[case] for case in further)
        if found:
            write_text(folder / BUDGETS, budgets_csv(found))
        data = dataset(study, done)
        write_text(folder / SUMMARY, summary_csv(study, data))
        temporary = folder / f"{DATASET}.part"
        data.to_netcdf(temporary, engine="h5netcdf")
        temporary.replace(folder / DATASET)
    return StudyResult(folder, study, data, computed, found)


@contextmanager
def claimed(folder: Path, *, own: Sequence[str], resume: bool | None, force: bool) -> Iterator[None]:
    """A folder for results that is ours alone while we write; its files named in `own` may be replaced by `force`.

    `resume` is None for work that is done in one go: the old files stay until each is replaced.

    Raises `StudyError` if it is not a folder, cannot be written, is in use, or holds something and neither `resume`
    nor `force` is given.
    """
    if resume and force:
        raise StudyError("--resume keeps what the folder holds and --force replaces it: give one of them.")
    if folder.exists() and not folder.is_dir():
        raise StudyError(f"{folder}: is a file; expected a folder for the results. Choose another with -o.")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / _LOCK)
        lock.acquire(timeout=0)
    except Timeout:
        raise StudyError(f"{folder}: another run is writing to it. Wait for it, or choose another folder.") from None
    except OSError as error:
        raise StudyError(f"{folder}: cannot be written ({error.strerror}). Choose another folder with -o.") from None
    try:
        if not resume and any(path.name != _LOCK for path in folder.iterdir()):
            if not force:
                ours = any((folder / name).exists() for name in own)
                again = "Replace" if resume is None else "Continue with --resume, replace"
                kept = f"{again} the results with --force" if ours else "Use --force to add to it"
                raise StudyError(f"{folder}: is not empty. {kept}, or choose another folder with -o.")
            for name in own if resume is not None else ():
                _remove(folder / name)
        yield
    finally:
        lock.release()
        if not any(path.name != _LOCK for path in folder.iterdir()):
            _remove(folder / _LOCK)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def versions() -> dict[str, str]:
    """The versions of this package, of Python and of the libraries on which numbers depend."""
    libraries = {name: version(name) for name in ("numpy", "scipy", "numba", "xarray")}
    return {"inerter": inerter.__version__, "python": platform.python_version(), **libraries}


def write_text(path: Path, text: str) -> None:
    """Write a file that is there as a whole or not at all."""
    temporary = path.with_name(f"{path.name}.part")
    temporary.write_text(text, encoding="utf-8", newline="\n")
    temporary.replace(path)
