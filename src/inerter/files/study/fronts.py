"""The fronts of a study: designs of each layout of which none is better than another in all indices of a trade-off."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from inerter.errors import Status, StatusKind
from inerter.files.study.cases import ENDED, FAILURES, Case, Outcome
from inerter.files.study.limits import limits_in
from inerter.files.study.study import Study
from inerter.files.study.ways import ways
from inerter.methods.registry import deciding
from inerter.optimisation.threads import one_blas_thread
from inerter.trade_off.front import Front
from inerter.trade_off.pareto import pareto
from inerter.units import headed

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class FrontCase:
    """What is the trade-off of a layout?"""

    layout: str

    @property
    def name(self) -> str:
        """What it is, in messages."""
        return f"front of {self.layout}"

    def run(self, study: Study, outcomes: Mapping[Case, Outcome], threads: int = 1) -> FrontOutcome:
        """The front. A failure is an outcome with a status and a sentence."""
        limits = [limit for several in limits_in(study) for limit in several]
        indices = [study.asked(name, self.layout) for name in study.trade_off]
        try:
            with one_blas_thread(), np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                method = study.method(str(study.optimise), threads)
                design = study.design(self.layout)
                vehicle = design if study.conditions else design.mechanism()
                found = pareto(vehicle, indices, method, points=study.points, subject_to=limits, seed=study.seed)
        except FAILURES as error:
            return _without(self.layout, StatusKind.FAILED.value, str(error))
        return _outcome(self.layout, found, str(study.optimise))

    def lost(self, study: Study) -> FrontOutcome:
        """What is known of a front whose processes have ended, each time that it was tried."""
        return _without(self.layout, StatusKind.FAILED.value, ENDED)


@dataclass(frozen=True)
class FrontOutcome:
    """The points of a front in rising order of the first index, in SI units; all of it survives JSON."""

    layout: str
    values: list[list[float]]  # of each point, by index
    parameters: list[dict[str, float]]
    statuses: list[str]
    jumps: list[int]  # points after which the front leaps
    knee: int | None
    status: str
    message: str = ""

    @property
    def case(self) -> FrontCase:
        """The case that it answers."""
        return FrontCase(self.layout)

    @property
    def name(self) -> str:
        """What it is, in messages."""
        return self.case.name

    @property
    def index(self) -> str:
        """What stands in the place of an index while it is told how far the work is."""
        return "front"

    @property
    def ok(self) -> bool:
        """Whether there is an answer."""
        return self.status == StatusKind.OK.value

    def to_json(self) -> dict[str, Any]:
        """A plain dictionary; `FrontOutcome(**...)` undoes it."""
        return dict(vars(self))


def front_cases(study: Study) -> list[FrontCase]:
    """One for each layout that has free values, if a trade-off is asked for."""
    if not study.trade_off:
        return []
    return [FrontCase(layout) for layout in study.layouts if study.design(layout).free_values()]


def _outcome(layout: str, found: Front, method: str) -> FrontOutcome:
    if not len(found.values):
        return _without(layout, found.status.kind.value, found.status.message)
    return FrontOutcome(
        layout,
        values=found.values.tolist(),
        parameters=list(found.parameters),
        statuses=[_text(status) for status in found.statuses],
        jumps=[before for before, _ in found.jumps],
        knee=found.knee,
        status=found.status.kind.value,
        message=found.status.message + ("" if found.status.ok else deciding(method, found.status.message)),
    )


def _without(layout: str, status: str, message: str) -> FrontOutcome:
    return FrontOutcome(layout, [], [], [], [], None, status, message)


def _text(status: Status) -> str:
    return f"{status.kind.value}: {status.message}" if status.message else status.kind.value


def with_fronts(study: Study, data: xr.Dataset, found: Sequence[FrontOutcome]) -> xr.Dataset:
    """The dataset of a study with its fronts: dimensions layout, front_point, criterion, and parameter."""
    if not found:
        return data
    points = max([len(front.values) for front in found] + [1])
    layouts, parameters = data["layout"].values.tolist(), data["parameter"].values.tolist()
    values = np.full((len(layouts), points, len(study.trade_off)), np.nan)
    designs = np.full((len(layouts), points, len(parameters)), np.nan)
    knees, leaps = np.full((len(layouts), points), False), np.full((len(layouts), points), False)
    status = np.full(len(layouts), "missing", dtype=object)
    for front in found:
        row = layouts.index(front.layout)
        status[row] = f"{front.status}: {front.message}" if front.message else front.status
        for i, (numbers, design) in enumerate(zip(front.values, front.parameters, strict=True)):
            values[row, i] = numbers
            designs[row, i] = [design.get(name, np.nan) for name in parameters]
        knees[row, [] if front.knee is None else [front.knee]] = True
        leaps[row, front.jumps] = True
    indices = {name: study.asked(name, layouts[0]) for name in study.trade_off}
    labelled = data.assign_coords(
        criterion=list(indices),
        criterion_title=("criterion", [index.title for index in indices.values()]),
        criterion_unit=("criterion", [study.unit(name) for name in indices]),
    )
    by = ways(replace(study, evaluate=study.methods))[str(study.optimise)] if len(study.methods) > 1 else ""
    told = {"long_name": "index at a point of the front", "method_words": by}
    return labelled.assign(
        front_value=(("layout", "front_point", "criterion"), values, told),
        front_parameter=(("layout", "front_point", "parameter"), designs, {"long_name": "parameter at that point"}),
        front_knee=(("layout", "front_point"), knees, {"long_name": "whether it is the knee"}),
        front_jump=(("layout", "front_point"), leaps, {"long_name": "whether the front leaps after it"}),
        front_status=("layout", status, {"long_name": "status of the front"}),
    )


def fronts_csv(study: Study, found: Sequence[FrontOutcome]) -> str:
    """One row a point."""
    free = study.free_units
    names = [name for name in free if any(name in design for front in found for design in front.parameters)]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    indices = [headed(name, study.unit(name)) for name in study.trade_off]
    parameters = [f"{name} [{free[name]}]" for name in names]
    writer.writerow(["layout", "point", *indices, *parameters, "knee", "jump_after", "status"])
    for front in found:
        for i, (values, design) in enumerate(zip(front.values, front.parameters, strict=True)):
            numbers = [repr(value) for value in values]
            known = [repr(design[name]) if name in design else "" for name in names]
            marks = ["yes" if i == front.knee else "", "yes" if i in front.jumps else ""]
            writer.writerow([front.layout, i + 1, *numbers, *known, *marks, front.statuses[i]])
        if not front.values:
            status = f"{front.status}: {front.message}"
            writer.writerow([front.layout, "", *([""] * (len(indices) + len(names) + 2)), status])
    return text.getvalue()
