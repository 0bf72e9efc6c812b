"""The staged protocol of Wang and Su (2008), section 4: friction, then shaft and backlash, then frequency response."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from inerter.errors import IdentificationError, Status
from inerter.formatting import format_number, format_quantity, format_range
from inerter.identification.fit import Fit, Parameter
from inerter.identification.friction_law import friction_law
from inerter.identification.identify import identify
from inerter.identification.models import MODELS
from inerter.identification.response import linear_response, model_response
from inerter.identification.statements.findings import FitFinding
from inerter.identification.statements.friction import FrictionLaw
from inerter.identification.statements.identifiability import Identifiability, Verdict
from inerter.methods.averages import NORMAL_QUANTILE
from inerter.networks.elements import Element, Free, Network, free
from inerter.networks.elements.roles import LinearRole
from inerter.networks.transform import map_elements, with_values
from inerter.records.finding import Finding
from inerter.records.record import Record
from inerter.records.response import frequency_response
from inerter.records.result import Response
from inerter.records.saturation import saturated_samples
from inerter.records.smoothing import smooth_displacement
from inerter.signals.signal import Signal
from inerter.simulation.simulate import simulate
from inerter.statements import Severity
from inerter.validation import check_positive, checked
from inerter.vehicle.rig import Rig

Matrix = NDArray[np.float64]
_LIGHT = 1.0  # [kg] of an unknown shaft, for the friction test alone
_NARROWEST = 1e-3  # of the friction: the smallest range in the second stage
_FRICTION, _INERTANCE = "f", "b"
_CLOSE = (0.05, math.radians(3.0))  # of gain and phase, within which a band agrees for any scatter
_STEP = 2e-4  # [s] of the simulation of the friction test, at most


@dataclass(frozen=True, eq=False)
class FrictionTest:
    """The first stage: the level of the square wave, and the force of the identified device on the same motion."""

    record: Record
    law: FrictionLaw
    model: Matrix  # (samples,) [N], with the offset of the load cell
    offset: float  # [N]


@dataclass(frozen=True)
class Band:
    """One octave of the check: the median differences of model from measurement, and a verdict."""

    lower: float  # [Hz]
    upper: float  # [Hz]
    lines: int
    gain: float  # model over measurement, less one
    phase: float  # [rad] model less measurement
    scatter: float  # half the width of the measurement's 95 % band, as a part of the gain
    agrees: bool

    @property
    def verdict(self) -> str:
        """The verdict in words."""
        how = "agrees" if self.agrees else "differs"
        gain, phase = _format_signed(100.0 * self.gain), _format_signed(math.degrees(self.phase))
        ends = (self.lower, self.upper)
        band = format_range(*ends, "Hz", 3) if self.lines > 1 else format_quantity(self.lower, "Hz", 3)
        return f"{band}: {how}; deviation of the model {gain} % in gain, {phase} degrees in phase."


def _format_signed(value: float) -> str:
    """The value with its sign, and without one where it rounds to zero."""
    return format_number(round(value, 1), 4, "+")


@dataclass(frozen=True, eq=False)
class ResponseCheck:
    """The third stage: frequency responses from displacement to force, measured and of models."""

    measured: Response
    model: Response  # of the identified device, at the same amplitude
    linear: Response  # of its linear part
    ideal: Response  # of its inertance alone
    bands: tuple[Band, ...]


@dataclass(frozen=True, eq=False)
class StagedIdentification:
    """The result of `identify_staged`.

    >>> import inerter as it
    >>> shaft = it.Spring(1e6) | it.Damper(3200.0)
    >>> bare, whole = (it.VirtualRig(shaft - (it.Inerter(b) | it.Friction(10.0)), sampling=500.0) for b in (1.0, 113.0))
    >>> slow = bare.run(it.cosine(0.01, 0.5), 4.0)  # without the flywheel: m, Hz, s
    >>> fast = whole.run(it.cosine(1e-3, 3.0), 2.0)
    >>> found = it.identify_staged(slow, fast, starts=8)
    >>> [element.label for element in found.device.elements()]
    ['ks', 'cs', 'gap', 'b', 'f']
    """

    parameters: dict[str, Parameter]
    identifiable: dict[str, Identifiability]
    device: Network  # with the best values
    friction: FrictionTest
    fit: Fit  # of the second stage, in which the friction is free within its interval
    response: ResponseCheck | None
    status: Status
    findings: tuple[Finding, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """The findings in sentences."""
        return tuple(finding.sentence for finding in self.findings)


class SearchChanges(TypedDict, total=False):
    """Keywords of the search for the second stage."""

    seed: int
    starts: int


@checked(IdentificationError)
def identify_staged(
    friction: Record,
    fit: Record,
    check: Record | None = None,
    *,
    inertance: float | None = None,
    shaft_inertance: float | None = None,
    model: Network | None = None,
    progress: Callable[[float], None] | None = None,
    executor: Executor | None = None,
    **search: Unpack[SearchChanges],
) -> StagedIdentification:
    """The parameters of a ball-screw inerter from three short tests, one after the other.

    **Friction.** `friction` is of the device without its flywheel, moved slowly: its force is a square wave, whose
    level is f. The inertia of the shaft alone, `shaft_inertance` [kg], is subtracted if it is given. **Shaft and
    backlash.** `fit` is of the whole device in a faster motion: least squares give k_s, c_s and the backlash, and the
    inertance unless `inertance` [kg] is given, such as from the geometry. The friction is free within its interval, so
    that the intervals of the others include its uncertainty. **Validation.** `check`, a sweep or multisine, is not
    fitted: its frequency response is compared, octave by octave, with that of the identified device at the same
    amplitude. An octave agrees if model and measurement differ by no more than the 95 % band of the measurement, or by
    5 % and 3 degrees.

    `model` is by default the ball screw of Wang and Su (2008), Figure 6b; any other requires a friction named f and an
    inerter named b. `seed`, `starts` and `executor` are those of `identify`.

    Raises `IdentificationError` where the friction is not identifiable or the model does not fit; `RecordError` and
    `IdentificationError` as `identify` does. Source: Wang and Su (2008), section 4.

    >>> import inerter as it
    >>> shaft = it.Spring(1e6) | it.Damper(3200.0)
    >>> bare, whole = (it.VirtualRig(shaft - (it.Inerter(b) | it.Friction(10.0)), sampling=500.0) for b in (1.0, 113.0))
    >>> slow = bare.run(it.cosine(0.01, 0.5), 4.0)  # without the flywheel: m, Hz, s
    >>> fast = whole.run(it.cosine(1e-3, 3.0), 2.0)
    >>> found = it.identify_staged(slow, fast, starts=8)
    >>> b, f = found.parameters["b"], found.parameters["f"]
    >>> found.status.ok, abs(b.value - 113.0) < 1.0, abs(f.value - 10.0) < 0.1  # kg, N
    (True, True, True)
    """
    device = _validate_model(MODELS["ball-screw"] if model is None else model, inertance, shaft_inertance)
    law = friction_law(friction, shaft_inertance or 0.0)
    if not law.level > 0.0 or not math.isfinite(law.interval[1]):
        raise IdentificationError(
            f"The friction is not identifiable from {friction.source!r}. {law.sentence} Move slowly, such as a cosine "
            f"of 0.1 Hz and 1 mm, without the flywheel."
        )
    half = max(law.level - law.interval[0], _NARROWEST * law.level)
    within = free(max(law.level - half, 0.0), law.level + half, _FRICTION)
    found = identify(fit, _with_value(device, _FRICTION, within), progress=progress, executor=executor, **search)
    parameters, identifiable = dict(found.parameters), dict(found.identifiable)
    parameters[_FRICTION], identifiable[_FRICTION] = _friction(law)
    values = {name: p.best for name, p in parameters.items()}
    best = with_values(_with_value(device, _FRICTION, within), values)
    order = [e.label for e in device.elements() if e.label in parameters]
    response = None if check is None else _response(best, check)
    return StagedIdentification(
        parameters={name: parameters[name] for name in order},
        identifiable={name: identifiable[name] for name in order},
        device=best,
        friction=_friction_test(best, friction, law, shaft_inertance),
        fit=found,
        response=response,
        status=found.status,
        findings=tuple(_findings(law, within, found, inertance, check, response)),
    )


def _validate_model(model: Network, inertance: float | None, shaft_inertance: float | None) -> Network:
    device = Rig(model).device
    labels = {e.label for e in device.elements()}
    if not {_FRICTION, _INERTANCE} <= labels:
        raise IdentificationError(
            f"The staged protocol requires a friction element named f and an inerter named b, got "
            f"{', '.join(sorted(labels))}."
        )
    for what, value in (("inertance", inertance), ("inertance of the shaft", shaft_inertance)):
        if value is not None:
            check_positive(IdentificationError, f"The {what}", value, "kg")
    return device if inertance is None else _with_value(device, _INERTANCE, inertance)


def _with_value(device: Network, label: str, value: float | Free) -> Network:
    def change(element: Element) -> Network:
        return element.with_value(value) if element.label == label else element

    return map_elements(device, change)


def _friction(law: FrictionLaw) -> tuple[Parameter, Identifiability]:
    error = 0.5 * (law.interval[1] - law.interval[0]) / NORMAL_QUANTILE
    interval = (max(law.interval[0], 0.0), law.interval[1])
    verdict = Identifiability(_FRICTION, Verdict.IDENTIFIED, "N", interval, role=LinearRole.OPEN)
    return Parameter(_FRICTION, "N", law.level, interval, law.level, error), verdict


def _friction_test(device: Network, record: Record, law: FrictionLaw, shaft_inertance: float | None) -> FrictionTest:
    """The device without its flywheel on the smoothed motion of the test."""
    shaft = _with_value(device, _INERTANCE, shaft_inertance or _LIGHT)
    motion = smooth_displacement(record)
    every = math.ceil(record.interval / _STEP * (1.0 - 1e-9))
    moved = Signal.sampled(
        np.arange(record.time.size) * record.interval, motion.displacement, derivative=motion.velocity
    )
    run = simulate(Rig(shaft), displacement=moved, duration=record.duration, step=record.interval / every, every=every)
    force = np.full(record.time.size, np.nan)
    force[: run.time.size] = run["device_force"][: force.size]
    offset = float(np.nanmedian(record.force - force))
    return FrictionTest(record, law, force + offset, offset)


def _response(device: Network, record: Record) -> ResponseCheck:
    measured, model = frequency_response(record), model_response(device, record)
    inertances = [e for e in device.elements() if e.linear is LinearRole.MASS and e.label == _INERTANCE]
    return ResponseCheck(
        measured=measured,
        model=model,
        linear=linear_response(device, measured.omega, record.force_bandwidth),
        ideal=linear_response(inertances[0], measured.omega, record.force_bandwidth),
        bands=tuple(_bands(measured, model)),
    )


def _bands(measured: Response, model: Response) -> list[Band]:
    """Octaves from the lowest common frequency."""
    both = np.abs(model.omega[:, None] / measured.omega - 1.0) < 1e-6
    mine, its = np.nonzero(both)
    if not mine.size:
        return []
    frequency = measured.frequency[its]
    ratio = model.value[mine] / measured.value[its]
    scatter = 0.5 * (measured.band[1] - measured.band[0])[its] / measured.gain[its]
    octave = np.floor(np.log2(frequency / frequency[0]) + 1e-9).astype(int)
    result = []
    for number in np.unique(octave):
        here = octave == number
        middle = complex(np.median(ratio[here].real), np.median(ratio[here].imag))
        gain, phase, wide = abs(middle) - 1.0, math.atan2(middle.imag, middle.real), float(np.median(scatter[here]))
        agrees = abs(middle - 1.0) <= wide or (abs(gain) <= _CLOSE[0] and abs(phase) <= _CLOSE[1])
        low, high = float(frequency[here].min()), float(frequency[here].max())
        result.append(Band(low, high, int(here.sum()), gain, phase, wide, agrees))
    return result


def _findings(
    law: FrictionLaw,
    within: Free,
    found: Fit,
    inertance: float | None,
    check: Record | None,
    response: ResponseCheck | None,
) -> Iterator[Finding]:
    low, high = law.interval
    level = {"level": law.level, "lower": low, "upper": high}
    yield Finding(FitFinding.FRICTION_LEVEL, Severity.INFO, _FRICTION, level)
    yield Finding(FitFinding.FRICTION_LAW, Severity.INFO, _FRICTION, {"law": law})
    friction = found.parameters[_FRICTION]
    inner = friction.interval
    if inner[1] < within.lower * 1.0001 or inner[0] > within.upper * 0.9999:
        yield Finding(FitFinding.OTHER_FRICTION, Severity.WARNING, _FRICTION, {"best": friction.best})
    if inertance is not None:
        yield Finding(FitFinding.GIVEN_INERTANCE, Severity.INFO, _INERTANCE, {"inertance": inertance})
    yield from found.findings
    if check is not None and saturated_samples(check).any():
        share = float(saturated_samples(check).mean())
        yield Finding(FitFinding.SATURATED_CHECK, Severity.WARNING, check.source, {"share": share})
    if response is not None:
        differ = sum(not band.agrees for band in response.bands)
        numbers = {"differ": differ, "octaves": len(response.bands)}
        yield Finding(FitFinding.RESPONSE, Severity.WARNING if differ else Severity.INFO, numbers=numbers)
