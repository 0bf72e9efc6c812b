"""Identification of a device from files of measurements: reading, inspection, preparation, fit, responses."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from inerter.errors import InerterError, RecordError
from inerter.files.identification.loading import CUSTOM, IdentificationRequest
from inerter.files.identification.sections import RecordRequest
from inerter.identification.choice import Candidate, select_model
from inerter.identification.fit import Fit, RecordFit
from inerter.identification.friction_models import QUADRATIC_DAMPING
from inerter.identification.hypotheses import DELAY, GAIN
from inerter.identification.identify import identify
from inerter.identification.models import VISCOUS, with_mount
from inerter.identification.options import FitOptions
from inerter.identification.response import linear_response, model_response
from inerter.networks.elements import Free, Network
from inerter.networks.transform import with_values
from inerter.records.finding import Finding
from inerter.records.inspection import findings
from inerter.records.prepare import detrend, resample, shift_force
from inerter.records.readers import read_record
from inerter.records.record import Record
from inerter.records.repair import repair
from inerter.records.response import frequency_response
from inerter.records.result import Response
from inerter.statements import Severity, by_severity
from inerter.vehicle.rig import Rig
from inerter.work.running import running_on

Progress = Callable[[float], None]
FIT, RESIDUALS = "fit.json", "residuals.csv"
_LINEAR_POINTS = 300
_OF_SENSORS = ("force_bandwidth", "force_noise", "displacement_noise")


@dataclass(frozen=True, eq=False)
class Reading:
    """Record as received and as used, with the findings on it."""

    received: Record
    used: Record
    findings: tuple[Finding, ...]


@dataclass(frozen=True, eq=False)
class Responses:
    """Dynamic stiffness: measured, of the model at the same amplitude, and of the linear model."""

    measured: Response | None
    model: Response | None = None
    linear: Response | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class IdentificationResult:
    """Identification result with everything that its report contains."""

    title: str
    name: str  # of the model
    model: Network  # with its free values named
    device: Network  # the same with its best values
    readings: tuple[Reading, ...]
    fit: Fit
    settings: dict[str, Any]
    candidates: tuple[Candidate, ...] = ()  # the best first
    choice: tuple[Finding, ...] = ()  # of the choice between them

    def bounds(self, parameter: str) -> tuple[float, float] | None:
        """Search bounds of a parameter of the device; None for a parameter of the sensors."""
        free = (e.value for e in self.model.elements())
        return next(((v.lower, v.upper) for v in free if isinstance(v, Free) and v.name == parameter), None)

    @property
    def explains(self) -> bool:
        """Whether the estimates are reliable; if not, all outputs withhold the values."""
        return self.fit.status.ok


def read(path: Path, asked: RecordRequest, progress: Progress | None = None) -> Reading:
    """The record of a file, prepared as the request says, with its findings.

    Raises `RecordError` for a file that cannot be used, or a record that nothing can be fitted to.
    """
    channels: dict[str, Any] = dict(asked.channels)
    received = read_record(
        path,
        **channels,
        units=asked.units or None,
        interval=asked.interval,
        gaps=asked.gaps,
        force_range=asked.force_range,
        period=asked.period,
        progress=progress,
    )
    received = received.with_notes(**{name: getattr(asked, name) for name in _OF_SENSORS})
    if asked.fixture_mass is not None:
        mass = asked.fixture_mass
        received = received.with_notes(fixture_mass=mass.value, fixture_mass_error=mass.uncertainty or None)
    used = repair(received) if asked.repair else received
    if asked.start is not None or asked.stop is not None:
        used = used.trim(asked.start, asked.stop)
    if asked.resample is not None:
        used = resample(used, asked.resample)
    if asked.detrend:
        used = detrend(used)
    found = tuple(findings(used))
    if errors := by_severity(found).get(Severity.ERROR):
        raise RecordError(f"{used.source}: ", *errors[0].text)
    return Reading(received, used, found)


def run_identification(
    readings: Sequence[Reading],
    request: IdentificationRequest,
    progress: Progress | None = None,
    executor: Executor | None = None,
) -> IdentificationResult:
    """Fit the model, or choose one, to the records; an `executor` shares the work.

    Raises what `identify` raises.
    """
    with running_on(executor), warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of units: findings of the readings, which their reader shows
        return _identify(readings, request, progress)


def _identify(
    readings: Sequence[Reading], request: IdentificationRequest, progress: Progress | None
) -> IdentificationResult:
    records = [r.used for r in readings]
    settings = dict(request.settings)
    title = request.title or ", ".join(dict.fromkeys(r.source for r in records))
    if request.chooses:
        return _select_model(title, readings, request, settings, progress)
    ((name, model),) = request.models().items()
    fit = identify(records, with_mount(model), FitOptions(**settings), progress=progress)
    named = Rig(model).device
    return IdentificationResult(title, name, named, _with_best(named, fit), tuple(readings), fit, settings)


def _select_model(
    title: str,
    readings: Sequence[Reading],
    request: IdentificationRequest,
    settings: dict[str, Any],
    progress: Progress | None,
) -> IdentificationResult:
    models = request.models()
    given = {name: models[name] for name in VISCOUS} if request.elements else None
    choice = select_model([r.used for r in readings], given, FitOptions(**settings), progress=progress)
    named, fit = Rig(models[choice.name]).device, choice.fits[choice.name]
    return IdentificationResult(
        *(title, choice.name, named, _with_best(named, fit), tuple(readings), fit, settings),
        candidates=choice.candidates,
        choice=choice.findings,
    )


def _with_best(model: Network, fit: Fit) -> Network:
    return with_values(model, {name: p.best for name, p in fit.parameters.items()})


def responses(found: IdentificationResult) -> Responses:
    """Frequency responses of the records, corrected by the fitted gain and delay of the sensors, and of the model."""
    values = {name: p.best for name, p in found.fit.parameters.items()}
    records = [_correct_force(c, values.get(GAIN, 1.0), values.get(DELAY, 0.0)) for c in found.fit.comparisons]
    try:
        measured = frequency_response(records)
    except InerterError as error:
        return Responses(None, notes=(str(error),))
    if not measured.omega.size:
        return Responses(None, notes=measured.notes)
    notes, model, linear = list(measured.notes), None, None
    if QUADRATIC_DAMPING in values:
        notes.append("The responses of the model are without its quadratic damping.")
    try:
        model = model_response(found.fit.device, records)
        notes += [note for note in model.notes if note not in notes]
        low, high = measured.omega[0], measured.omega[-1]
        reach = 1.3 if high > 2.0 * low else 2.0
        linear = linear_response(
            found.fit.device, np.geomspace(low / reach, high * reach, _LINEAR_POINTS), records[0].force_bandwidth
        )
    except InerterError as error:
        notes.append(str(error))
    return Responses(measured, model, linear, tuple(notes))


def model_title(found: IdentificationResult) -> str:
    """The model in words."""
    return "the model of the configuration" if found.name == CUSTOM else f"the model {found.name}"


def _correct_force(comparison: RecordFit, gain: float, delay: float) -> Record:
    moved = (comparison.record.fixture_mass or 0.0) * comparison.experiment.motion.acceleration
    record = comparison.record.with_notes(force=(comparison.record.force - comparison.offset) / gain - moved)
    return shift_force(record, delay) if delay else record
