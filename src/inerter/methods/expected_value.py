"""`ExpectedValue`: simulation on random roads, averaged, with its standard error. The paper's second method."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from numbers import Integral

import numpy as np
from numpy.typing import NDArray

from inerter.checks import is_number
from inerter.errors import OK, IndicatorError, InerterError, LinearSystemError, MechanismError, Status, StatusKind
from inerter.indices.index import Combination, Index, Question
from inerter.methods.averages import mean_and_error
from inerter.methods.equivalent import has_friction
from inerter.methods.forced import Forced, coarse_maxima, frequency_grid, local_maxima
from inerter.methods.linear import CONVENTIONS, Conventions, LinearProblem, check_conventions, linear_problem
from inerter.methods.method import Estimate, Objective
from inerter.methods.perturbation import first_order
from inerter.methods.realisations import Drive, check_drive, drive, realisation_seeds, squares, worst
from inerter.methods.sampled import SampledObjective
from inerter.methods.statistical_linearisation import StatisticalLinearisation
from inerter.norms.h2 import h2
from inerter.norms.response import modal_response
from inerter.simulation.threads import threads
from inerter.systems.descriptor import close
from inerter.systems.piecewise import PiecewiseSystem, piecewise
from inerter.vehicle.cars import Vehicle

Array = NDArray[np.float64]
_DEFAULT = 8  # realisations
_FEWEST = 8  # before the scatter of an adaptive estimate is believed
_MOST = 1000
_MOST_BEYOND = 0.1  # of the linear design's power that may be added for the road outside the band
_MORE = 400  # roads on which the first-order change is averaged, which is quick


@dataclass(frozen=True)
class ExpectedValue:
    """What the design does as it is, friction and gaps included: the mean over random roads, or over all sines.

    Each of `realisations` roads (8 by default), which `seed` decides, is a multisine of eq. (17), 0.1 to 1000 Hz; the
    design settles on it, and r.m.s. values are taken over the next period of 10 s. The value is the mean over the
    roads of the index on each. With `relative_error`, roads are added, from 8 to 1000, until the standard error is
    that part of the value. Designs are driven over the same roads, so that differences between them are known better
    than either (see `compare`).

    Under the conventions "exact" the power of the road outside that band is added from the linear design; without
    friction and gaps the value is therefore the norm, and is returned as such. "paper2008" samples roads at 1 ms and
    holds them, adds nothing, and takes the tyre load of a half car over s + 2 pi rad/s.

    A peak gain is the largest ratio of r.m.s. displacement to r.m.s. force over all frequencies for a sine of the
    index's `amplitude`; `peaks` holds every local maximum, each found near where harmonic balance has one (with gaps:
    where a grid of frequencies has one). It has no scatter. Under "paper2008" the value is the local maximum nearest
    to the highest peak of the linear design, which need not be the highest.

    `jobs` threads share the work (all cores by default). Source: Wang and Su (2008), section 4.

    Raises `IndicatorError` for numbers that cannot be; where it is used, for a peak gain with friction or gaps whose
    index says no amplitude, and under "paper2008" `SimulationError` where a road that jumps moves a damper, an
    inerter, friction or a gap directly.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(7544.2) - (it.Inerter(366.52) | it.Friction(10.0))
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25))
    >>> found = it.evaluate(car, comfort, it.ExpectedValue(seed=0))
    >>> round(found.value, 3), round(found.standard_error, 4), found.realisations
    (2.434, 0.0004, 8)
    """

    realisations: int | None = None
    seed: int = 0
    relative_error: float | None = None
    conventions: str = "exact"
    jobs: int | None = None
    name = "expected-value"

    def __post_init__(self) -> None:
        check_conventions(self.conventions)
        _check_whole("The seed", self.seed, 0)
        if self.realisations is not None:
            _check_whole("The number of realisations", self.realisations, 2)
        if self.jobs is not None:
            _check_whole("The number of threads", self.jobs, 1)
        if self.realisations is not None and self.relative_error is not None:
            raise IndicatorError("Give either realisations or a relative_error to reach, not both.")
        if self.relative_error is not None and not (is_number(self.relative_error) and 0.0 < self.relative_error < 1.0):
            raise IndicatorError(f"The relative error to reach lies between 0 and 1, got {self.relative_error!r}.")

    def estimate(self, vehicle: Vehicle, index: Index) -> Estimate:
        """The index of a vehicle without free values."""
        with threads(self.jobs) as pool:
            return self._estimate(vehicle, index, pool)

    def estimate_many(self, vehicle: Vehicle, indices: Sequence[Index], points: Mapping[str, Array]) -> Array:
        """The indices (designs, indices) at many values of the free values; nan where the status is not ok."""
        names = list(points)
        columns = np.column_stack([points[name] for name in names]) if names else np.zeros((1, 0))
        result = np.full((columns.shape[0], len(indices)), np.nan)
        with threads(self.jobs) as pool:
            for i, row in enumerate(columns.tolist()):
                design = vehicle.with_values(dict(zip(names, row, strict=True))) if names else vehicle
                for j, index in enumerate(indices):
                    found = self._estimate(design, index, pool)
                    result[i, j] = found.value if found.status.ok else np.nan
        return result

    def objective(self, vehicle: Vehicle, index: Index) -> Objective:
        """The index as a function of the free values, on the same roads for all.

        With a `relative_error`, as many roads are taken as the middle of the bounds needs.
        """
        fixed = self
        if self.relative_error is not None:
            middle = {name: (free.lower * free.upper) ** 0.5 for name, free in vehicle.free_values().items()}
            roads = self.estimate(vehicle.with_values(middle), index).realisations
            fixed = replace(self, relative_error=None, realisations=max(roads, 2))
        return SampledObjective(fixed.estimate, vehicle, index)

    def controls(self, vehicle: Vehicle, index: Index, count: int) -> tuple[Array, Array] | None:
        """What friction does to the index, to first order, on the first `count` roads (count,), and on many more.

        None for a peak gain, and where there is a gap or friction alone holds a part.
        """
        system = piecewise(vehicle)
        question, conventions = index.question(system.mechanism), CONVENTIONS[self.conventions]
        if question.combination is Combination.PEAK_GAIN:
            return None
        if not is_nonlinear(system):
            return np.zeros(count), np.zeros(_MORE)
        change = first_order(system, question, drive(system, question, conventions))
        if change is None:
            return None
        seeds = realisation_seeds(self.seed, 0, count + _MORE)
        changes = change(seeds)
        return changes[:count], changes[count:]

    def _estimate(self, vehicle: Vehicle, index: Index, pool: ThreadPoolExecutor) -> Estimate:
        mechanism = vehicle.mechanism()
        question, conventions = index.question(mechanism), CONVENTIONS[self.conventions]
        linear = _linear(vehicle, question, conventions)
        system = piecewise(vehicle)
        if conventions.hold is None and not is_nonlinear(system):
            assert linear is not None
            return replace(linear.estimate(close(linear.descriptor, {})), standard_error=0.0)
        if question.combination is Combination.PEAK_GAIN:
            return self._peak_gain(vehicle, index, system, question, linear, pool)
        way = drive(system, question, conventions)
        check_drive(system, way)
        names = tuple(output.output for output in question.outputs)
        weights = np.array([abs(output.weight) for output in question.outputs])
        beyond, status = (None, OK)
        if conventions.hold is None and linear is not None:
            beyond, status = _beyond(linear, way)
        if status.kind is StatusKind.MARGINAL and has_friction(mechanism):
            status = OK  # friction damps what nothing else does
        if beyond is None and not status.ok:
            return Estimate(np.inf, question.unit, status)
        rest = np.zeros(len(names)) if beyond is None else beyond
        values, statuses = np.zeros(0), []
        wanted = self.realisations or (_FEWEST if self.relative_error else _DEFAULT)
        while values.size < wanted:
            seeds = realisation_seeds(self.seed, values.size, wanted)
            found = list(pool.map(partial(squares, system, way, outputs=names), seeds))
            statuses += [s for _, s in found]
            power = np.array([p for p, _ in found])
            values = np.concatenate([values, np.sqrt(np.maximum(power + rest, 0.0)) @ weights])
            if self.relative_error is not None and np.all(np.isfinite(values)):
                wanted = _enough(values, self.relative_error)
        notes = () if beyond is not None or conventions.hold is not None else (_NO_LINEAR,)
        return _averaged(values, question.unit, worst([*statuses, status]), self.relative_error, notes)

    def _peak_gain(
        self,
        vehicle: Vehicle,
        index: Index,
        system: PiecewiseSystem,
        question: Question,
        linear: LinearProblem | None,
        pool: ThreadPoolExecutor,
    ) -> Estimate:
        if question.amplitude is None:
            raise IndicatorError(
                "What a design with friction or gaps carries depends on the size of the force. Give its amplitude, "
                "such as LoadCarrying(amplitude=1000.0)."
            )
        (output,) = question.outputs
        forced = Forced(system, question.inputs[0], output.output, question.amplitude)
        poles, known = np.zeros(0, dtype=complex), np.zeros(0)
        if linear is not None:
            closed = close(linear.descriptor, {})
            poles = np.linalg.eigvals(closed.A)
            known = np.array([peak.omega for peak in linear.estimate(closed).peaks if np.isfinite(peak.omega)])
        expected = _expected_peaks(vehicle, index)
        if expected is None:
            expected = np.concatenate([coarse_maxima(forced, poles, pool), known])
        peaks, statuses = local_maxima(forced, expected, float(frequency_grid(poles)[0]), pool)
        weighted = tuple(replace(peak, gain=abs(output.weight) * peak.gain) for peak in peaks)
        value = weighted[0].gain if weighted else np.nan
        if self.conventions == "paper2008" and weighted and known.size and known[0] > 0.0:
            value = min(weighted, key=lambda peak: abs(np.log(max(peak.omega, 1e-9) / known[0]))).gain
        status = worst(statuses)
        if status.kind is StatusKind.FAILED:
            value = np.nan
        return Estimate(value, question.unit, status, standard_error=0.0, interval=(value, value), peaks=weighted)


_NO_LINEAR = "friction or a gap alone holds or damps a part: nothing is added for the road outside 0.1 to 1000 Hz"


def _expected_peaks(vehicle: Vehicle, index: Index) -> Array | None:
    """Where harmonic balance has local maxima [rad/s]; None where it does not serve."""
    try:
        peaks = StatisticalLinearisation().estimate(vehicle, index).peaks
    except InerterError:
        return None
    omegas = np.array([peak.omega for peak in peaks])
    return omegas if omegas.size and np.all(np.isfinite(omegas)) else None


def is_nonlinear(system: PiecewiseSystem) -> bool:
    """Whether a friction or gap that is not zero is there."""
    return bool(np.any(system.mechanics.limit > 0.0))


def _linear(vehicle: Vehicle, question: Question, conventions: Conventions) -> LinearProblem | None:
    """The linear problem of the design; None if without friction a part is held by nothing."""
    try:
        return linear_problem(vehicle.mechanism(), question, conventions)
    except (MechanismError, LinearSystemError):
        return None


def _beyond(linear: LinearProblem, way: Drive) -> tuple[Array | None, Status]:
    """Mean squares of the linear design's outputs from the road outside the multisine's band.

    A resonance much narrower than the distance of its lines, on one of them or between two, would pass for a part of
    that: it is then inaccurate, and nothing is taken away for it.
    """
    system = linear.system(close(linear.descriptor, {}))
    whole = h2(system, linear.pade_order)
    if not whole.status.ok:
        return None, whole.status
    lines = way.signal(0)
    omega = 2.0 * np.pi * lines.frequencies
    gains = np.abs(modal_response(system, omega, linear.pade_order)[:, :, 0]) ** 2
    inside = 0.5 * (omega * lines.amplitudes) ** 2 @ gains
    power = (way.road.velocity_intensity * whole.outputs) ** 2
    rest = np.asarray(power - inside)
    share = float(np.abs(rest / np.maximum(power, 1e-300)).max(initial=0.0))
    if share <= _MOST_BEYOND:
        return rest, OK
    message = f"the linear design rings so sharply that lines 0.1 Hz apart miss its power by {100.0 * share:.0f} %"
    return np.maximum(rest, 0.0), Status(StatusKind.INACCURATE, message)


def _enough(values: Array, relative_error: float) -> int:
    """How many realisations will do, from the scatter of those that there are."""
    scatter, mean = float(np.std(values, ddof=1)), float(np.mean(values))
    if scatter / np.sqrt(values.size) <= relative_error * mean or values.size >= _MOST:
        return values.size
    guess = 1.05 * (scatter / (relative_error * mean)) ** 2
    return int(min(max(np.ceil(guess), values.size + 2), 4 * values.size, _MOST))


def _averaged(
    values: Array, unit: str, status: Status, relative_error: float | None, notes: tuple[str, ...]
) -> Estimate:
    mean, error, interval = mean_and_error(values)
    if status.ok and relative_error is not None and error > relative_error * mean:
        message = f"after {values.size} roads the standard error is {error / mean:.1e} of the value"
        status = Status(StatusKind.INACCURATE, message)
    return Estimate(
        mean, unit, status, standard_error=error, interval=interval, realisations=values.size, notes=notes,
        samples=tuple(values.tolist()),
    )  # fmt: skip


def _check_whole(what: str, value: object, least: int) -> None:
    if not isinstance(value, Integral) or isinstance(value, bool) or value < least:
        raise IndicatorError(f"{what} is a whole number from {least} on, got {value!r}.")
