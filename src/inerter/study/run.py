"""Running a study into a result folder, from the start or from where it was interrupted."""

from __future__ import annotations

import json
import platform
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import xarray as xr

import inerter
from inerter.errors import InerterError, StudyError
from inerter.study import journal as journals
from inerter.study.cases import Case, Outcome, cases
from inerter.study.journal import Journal
from inerter.study.registry import INDEX
from inerter.study.results import dataset, summary_csv
from inerter.study.values import Study, write_resolved
from inerter.study.workers import run_all
from inerter.systems.graph import linear_graph

RESOLVED, SUMMARY, DATASET, VERSIONS = "study.resolved.toml", "summary.csv", "results.nc", "versions.json"
FIGURES, REPORT = "figures", "report.html"
_OWN = (journals.NAME, RESOLVED, SUMMARY, DATASET, VERSIONS, FIGURES, REPORT)
Progress = Callable[[int, int, Outcome | None], None]


@dataclass(frozen=True, eq=False)
class StudyResult:
    """Where the results are, and what they are."""

    folder: Path
    study: Study
    data: xr.Dataset
    computed: int  # cases that this run computed; the others were there already

    @property
    def failures(self) -> list[str]:
        """One line for every design whose status is not ok."""
        lines = []
        stacked = self.data.status.stack(case=self.data.status.dims)
        for item in stacked:
            if item.item() != "ok":
                lines.append(f"{' '.join(str(part) for part in item.case.item())}: {item.item()}")
        return lines


def check_study(study: Study) -> None:
    """Assemble every layout at every swept value, so that what is ill-posed shows before any work is done.

    Raises `StudyError` with a line for every layout that cannot be analysed.
    """
    problems = []
    for layout in study.layouts:
        for swept in study.sweep.values if study.sweep else (None,):
            try:
                mechanism = study.design(layout, swept).mechanism()
                linear_graph(mechanism)
                for index in study.indices:
                    INDEX[index](study).question(mechanism)
            except InerterError as error:
                problems.append(f"{study.path}: layouts.{layout}: {error}")
                break
    if problems:
        raise StudyError("\n".join(problems))


def run_study(
    study: Study,
    folder: Path,
    *,
    jobs: int = 1,
    resume: bool = False,
    force: bool = False,
    progress: Progress = lambda done, total, outcome: None,
) -> StudyResult:
    """Run `study` into `folder`, and write the resolved study, the summary and the dataset.

    With more than one process, `jobs`, a script that calls this needs the line `if __name__ == "__main__":`, because
    processes are started afresh and import it.

    Every finished case is in the journal at once. With `resume`, cases in the journal are not computed again, and the
    results are the same, byte for byte, as those of an undisturbed run.

    Raises `StudyError` if the folder holds something and neither `resume` nor `force` is given, or if it holds another
    study's results.
    """
    check_study(study)
    journal = Journal(folder / journals.NAME, study)
    done = _prepare(journal, folder, resume=resume, force=force)
    everything = cases(study)
    pending = [case for case in everything if case not in done]
    progress(len(done), len(everything), None)
    with journal.appending() as writer:
        for outcome in run_all(study, pending, jobs):
            writer.write(outcome)
            done[outcome.case] = outcome
            progress(len(done), len(everything), outcome)
    data = dataset(study, done)
    _write(folder / SUMMARY, summary_csv(study, data))
    temporary = folder / f"{DATASET}.part"
    data.to_netcdf(temporary, engine="h5netcdf")
    temporary.replace(folder / DATASET)
    return StudyResult(folder, study, data, len(pending))


def _prepare(journal: Journal, folder: Path, *, resume: bool, force: bool) -> dict[Case, Outcome]:
    """Make the folder ready; returns what it already holds."""
    if folder.exists() and not folder.is_dir():
        raise StudyError(f"{folder}: is a file; expected a folder for the results. Choose another with -o.")
    if resume and journal.path.exists():
        return journal.read()
    if folder.exists() and any(folder.iterdir()):
        if not force:
            kept = "Continue with --resume, or replace them with --force" if journal.path.exists() else "Use --force"
            raise StudyError(f"{folder}: is not empty. {kept}, or choose another folder with -o.")
        for name in _OWN:
            path = folder / name
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        journal.start()
    except OSError as error:
        raise StudyError(f"{folder}: cannot be written ({error.strerror}). Choose another folder with -o.") from None
    _write(folder / RESOLVED, write_resolved(journal.study))
    names = ("numpy", "scipy", "numba", "xarray")
    versions = {"inerter": inerter.__version__, "python": platform.python_version()}
    _write(
        folder / VERSIONS,
        json.dumps({**versions, **{name: version(name) for name in names}, "seed": journal.study.seed}, indent=2)
        + "\n",
    )
    return {}


def _write(path: Path, text: str) -> None:
    temporary = path.with_name(f"{path.name}.part")
    temporary.write_text(text, encoding="utf-8", newline="\n")
    temporary.replace(path)
