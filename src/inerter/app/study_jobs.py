"""Long work on studies: optima, whole studies, sweeps, comparisons, in calls of what the command line calls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from inerter.app import deciding
from inerter.app.answers import optimum, texts_of
from inerter.app.comparing import compare_designs
from inerter.app.designs import designs_of, problem_digest
from inerter.app.documents import study_for, study_from
from inerter.app.fixed_designs import with_fixed_values
from inerter.app.kinds import RESULTS, Tell, job_arguments
from inerter.errors import StudyError
from inerter.files.common.folder import REPORT
from inerter.files.study.checking import check_study
from inerter.files.study.place import Sweep
from inerter.files.study.running import StudyResult, run_study
from inerter.files.study.study import Study
from inerter.files.study.sweeps import number_of
from inerter.networks.elements import Element
from inerter.report.study_data import as_data
from inerter.report.writing import write_figures_and_report
from inerter.units import parse_quantity

Body = Mapping[str, Any]


def optimise(body: Body, folder: Path, tell: Tell) -> Any:
    return optimum(*study_for(body), tell)


def run(body: Body, folder: Path, tell: Tell) -> Any:
    return _as_data(_run_study(study_from(body["study"]), folder, tell))


def report(body: Body, folder: Path, tell: Tell) -> Any:
    """Report of the study, or of its `designs` with fixed values, as `inerter run` writes it: one HTML file."""
    study = study_from(body["study"])
    if body.get("designs"):
        study = study_from(with_fixed_values(body["study"], study, designs_of(study, body)))
    result = _run_study(study, folder, tell)
    path = folder / RESULTS / REPORT
    return {"file": REPORT, "title": study.title, "size": path.stat().st_size, "status": result.status.kind.value}


def margins(body: Body, folder: Path, tell: Tell) -> Any:
    return deciding.margins(study_from(body["study"]), body, tell)


def sweep(body: Body, folder: Path, tell: Tell) -> Any:
    document = dict(body["study"])
    if not isinstance(asked := document.get("study"), Mapping):
        raise StudyError("A sweep needs a study document with a section [study].")
    settings = {key: value for key, value in asked.items() if key not in ("break_even", "budgets", "trade_off")}
    if body.get("sweep"):
        settings["sweep"] = body["sweep"]
    if indices := body.get("indices") or asked.get("indices") or asked.get("trade_off"):
        settings["indices"] = indices
    document["study"] = settings
    study = study_from(document)
    if not study.sweeps:
        raise StudyError('A sweep needs `sweep`, such as {"k": {"from": "10 kN/m", "to": "300 kN/m", "points": 30}}.')
    wanted = body.get("layouts") or list(study.layouts)
    for layout in wanted:
        study.design(layout)
    layouts = {name: layout for name, layout in study.layouts.items() if name in (*wanted, study.baseline)}
    result = _as_data(_run_study(replace(study, layouts=layouts), folder, tell))
    swept = [_describe_sweep(study, one) for one in study.sweeps]
    return {**result, "swept": swept, "units": study.free_units}


def _describe_sweep(study: Study, swept: Sweep) -> dict[str, Any]:
    """Swept number: its name, what it is, its own value in the study, and the unit in which it is written."""
    element = study.elements.get(swept.label)
    own = number_of(study, swept.place).value
    unit = swept.written or swept.unit
    return {
        "name": swept.label,
        "words": f"{element.key} {swept.label}" if isinstance(element, Element) else swept.words,
        "unit": swept.unit,
        "own": float(own) if isinstance(own, int | float) else None,
        "written": {"unit": unit, "factor": parse_quantity(f"1 {unit}", swept.unit) if unit else 1.0},
    }


def _as_data(result: StudyResult) -> Any:
    """Results as `inerter run --json` prints them, with values as texts, and digests of the problems they solve."""
    data, study = as_data(result), result.study
    for design in data["designs"]:
        here = study.at([design[sweep.label] for sweep in study.sweeps])
        design["texts"] = texts_of(here, design["parameters"])
        design["problem_digests"] = [problem_digest(here, design["layout"], design["index"])]
    return data


def _run_study(study: Study, folder: Path, tell: Tell) -> StudyResult:
    """Run a study as `inerter run` does, into the folder of the job."""
    check_study(study, lambda count, total: tell(0, 0, f"preparing {count} of {total}"))
    arguments = job_arguments(tell, write_figures_and_report, lambda last: (last.name if last else "",))
    return run_study(study, folder / RESULTS, **arguments)


def compare(body: Body, folder: Path, tell: Tell) -> Any:
    return compare_designs(*study_for(body), tell)
