"""`ApproximateLinear`: gains of the nonlinear design on a random input, read as if it were linear.

Method 1 of Wang and Su (2008). The design is excited periodically until its response repeats; at every harmonic the
gain is the size of the output over that of the input, and takes the place of the linear gain in the index.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from inerter.checks import is_number
from inerter.errors import OK, IndicatorError, MechanismError, Status, StatusKind
from inerter.indices.index import Combination, Index, Question
from inerter.methods.excitation import Drive, Excitation, MultisineExcitation, NoiseExcitation
from inerter.methods.linear import CONVENTIONS, LinearProblem, arrivals, corner_of, linear_problem
from inerter.methods.method import Estimate, Objective
from inerter.networks.elements import Friction, Gap
from inerter.norms.h2 import h2
from inerter.norms.hinf import Peak
from inerter.norms.response import frequency_response
from inerter.simulation.inputs import check_holds
from inerter.simulation.observe import trajectory_of
from inerter.simulation.steady import recorded_period
from inerter.systems.descriptor import close
from inerter.systems.graph import full_graph
from inerter.systems.linear import LinearSystem
from inerter.systems.piecewise import PiecewiseSystem, piecewise
from inerter.vehicle.cars import Vehicle
from inerter.vehicle.mechanism import Mechanism

Array = NDArray[np.float64]
_ROAD_RMS = math.sqrt(1e-8 / 1e-3)  # [m] noise of 1e-8 m^2/Hz, held for 1 ms
_FORCE_RMS = math.sqrt(200.0 / 1e-3) / 181.75  # [N/kg] 200 N^2/Hz on the quarter car, twice the size on the half car
_REPEATS = 1e-4  # change of the state over a period, relative to its size, that leaves an estimate alone
_DECAYED = math.log(100.0)  # what a period must take off the linear model's motions for its harmonics to resolve them
_MOST = 1000  # realisations


@dataclass(frozen=True)
class ApproximateLinear:
    """Gains |Y|/|U| of the design itself on a random input, in the place of linear gains.

    An index of r.m.s. values adds up the squared gains of all harmonics; a peak gain is the largest. `road` (heights,
    in m) and `force` are the excitations; without, multisines of the paper's size, 3.162 mm and 2.461 N for each kg of
    the body that the force acts on, from 0.1 to 500 Hz.

    With the conventions "exact", squared gains are mean |Y|^2 over mean |U|^2 over `realisations`. Of those of the
    linear model of the same design (no friction, gaps closed), which are known, only the difference is estimated: an
    r.m.s. value is the root of norm^2 + sum of (gain^2 - linear gain^2), and for a peak gain the difference alone is
    smoothed over neighbouring frequencies, by a Hann window that reaches `smoothing` [Hz] to both sides. Where there
    is no linear model, or its motions outlast the period, gains stand alone, and a note says so. A linear design gets
    its norm.

    With "paper2008" the input is the paper's noise, held for 1 ms and repeated after 100 s, and squared gains are the
    mean of the raw ratios |Y/U|^2 at the instants of the samples, without the linear model; J3 of a half car is
    divided by s + 2 pi instead of s. Peak gains are smoothed here too, as mean |Y|^2 over mean |U|^2: the maximum of
    raw ratios over 50 000 frequencies has no expectation.

    `seed` decides the realisations, which are the same for every design. The standard error is that of the mean over
    realisations, the interval Student's. `relative_error` asks for realisations until the standard error is below that
    part of the value.

    Raises `IndicatorError` for settings that cannot be.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(7544.2) - (it.Inerter(366.52) | it.Friction(10.0))
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25))
    >>> estimate = it.evaluate(car, comfort, it.ApproximateLinear(seed=0))
    >>> estimate.value > 1.02 * it.evaluate(car, comfort, it.Norm()).value  # on this input, friction costs 2.7 %
    True
    """

    road: Excitation | None = None
    force: Excitation | None = None
    realisations: int = 8
    relative_error: float | None = None
    smoothing: float = 0.2
    seed: int = 0
    conventions: str = "exact"
    name = "approximate-linear"

    def __post_init__(self) -> None:
        if not isinstance(self.conventions, str) or self.conventions not in CONVENTIONS:
            known = ", ".join(CONVENTIONS)
            raise IndicatorError(f"There are no conventions named {self.conventions!r} (known: {known}).")
        for what, given in (("road", self.road), ("force", self.force)):
            if given is not None and not isinstance(given, Excitation):
                raise IndicatorError(
                    f"The {what} is excited by MultisineExcitation(...) or NoiseExcitation(...), got {given!r}."
                )
        _check_whole("The number of realisations", self.realisations, 2, _MOST)
        _check_whole("A seed", self.seed, 0, 2**63)
        if self.relative_error is not None and not (is_number(self.relative_error) and 0.0 < self.relative_error < 1.0):
            raise IndicatorError(f"A relative error lies between 0 and 1, got {self.relative_error!r}.")
        if not is_number(self.smoothing) or self.smoothing < 0.0:
            raise IndicatorError(f"The reach of the smoothing is 0 Hz or more, got {self.smoothing!r}.")

    def estimate(self, vehicle: Vehicle, index: Index) -> Estimate:
        """The index of a vehicle without free values."""
        return self.estimates(vehicle, [index])[0]

    def estimates(self, vehicle: Vehicle, indices: Sequence[Index], always: bool = False) -> list[Estimate]:
        """Several indices of one vehicle: those with the same input share the simulations.

        `always` simulates a linear design too, which then gets its norm back.
        """
        mechanism = vehicle.mechanism()
        questions = [index.question(mechanism) for index in indices]
        linears = [_linear_model(mechanism, question, self.conventions) for question in questions]
        if not always and not _is_nonlinear(mechanism):
            problems = [linear_problem(mechanism, question, CONVENTIONS[self.conventions]) for question in questions]
            return [_known(problem.estimate(close(problem.descriptor, {}))) for problem in problems]
        drives = [self._drive(mechanism, question) for question in questions]
        system, runs = piecewise(vehicle), dict[Drive, _Runs]()
        for question, drive in zip(questions, drives, strict=True):
            names = runs[drive].outputs if drive in runs else ()
            names = tuple(dict.fromkeys((*names, *(output.output for output in question.outputs))))
            runs[drive] = _Runs(system, drive, names, self.seed)
        return [
            self._answer(question, linear, runs[drive])
            for question, linear, drive in zip(questions, linears, drives, strict=True)
        ]

    def estimate_many(self, vehicle: Vehicle, indices: Sequence[Index], points: Mapping[str, Array]) -> Array:
        """The indices (designs, indices) at many values of the free values; nan where an estimate is not ok."""
        count = next(iter(points.values())).size if points else 1
        result = np.full((count, len(indices)), np.nan)
        for i in range(count):
            design = vehicle.with_values({name: float(column[i]) for name, column in points.items()})
            estimates = self.estimates(design, indices)
            result[i] = [estimate.value if estimate.status.ok else np.nan for estimate in estimates]
        return result

    def objective(self, vehicle: Vehicle, index: Index) -> Objective:
        """The index as a function of the free values: one estimate a point, on the same realisations everywhere."""
        return SampledObjective(self, vehicle, index)

    @property
    def _raw(self) -> bool:
        return self.conventions == "paper2008"

    def _drive(self, mechanism: Mechanism, question: Question) -> Drive:
        """Which inputs are moved, by what and how late."""
        named, late = arrivals(mechanism, question)
        delays = dict(zip(named, late.tolist(), strict=True))
        on_road = question.road is not None
        default = NoiseExcitation() if self._raw else MultisineExcitation()
        excitation = (self.road if on_road else self.force) or default
        rms = excitation.rms or (_ROAD_RMS if on_road else _FORCE_RMS * _inertia_felt(mechanism, named[0]))
        inputs = [*(r.name for r in mechanism.roads), *(f.name for f in mechanism.forces)]
        return Drive(excitation, rms, tuple(delays.get(name) for name in inputs))

    def _answer(self, question: Question, linear: _LinearModel | None, runs: _Runs) -> Estimate:
        if linear is not None and linear.status.kind is StatusKind.DIRECT_TERM:
            return Estimate(math.inf, question.unit, linear.status)
        known, notes = self._control(linear, runs.drive)
        if question.amplitude is not None:
            notes = (*notes, "the amplitude of a sine says nothing here: the excitation has its own size")
        count, estimate = self.realisations, None
        while estimate is None or not self._is_settled(estimate, count):
            count = count if estimate is None else min(2 * count, _MOST)
            squares, inputs = runs.upto(count)
            if not runs.status.ok:
                return Estimate(math.nan, question.unit, runs.status, notes=notes)
            places = [runs.outputs.index(output.output) for output in question.outputs]
            scale = inputs if self._raw and question.combination is not Combination.PEAK_GAIN else inputs.mean(axis=0)
            gains = squares[:, places] / np.broadcast_to(scale, inputs.shape)[:, None]
            estimate = self._combine(question, known, gains * self._filter(question, runs.drive), runs.drive)
        status = runs.warning
        if status.ok and self.relative_error is not None and not self._reached(estimate):
            status = Status(StatusKind.INACCURATE, f"{count} realisations do not reach the relative error asked for")
        return _with(estimate, status, notes)

    def _is_settled(self, estimate: Estimate, count: int) -> bool:
        return self.relative_error is None or count >= _MOST or self._reached(estimate)

    def _reached(self, estimate: Estimate) -> bool:
        error, asked = estimate.standard_error or 0.0, self.relative_error or math.inf
        return error <= asked * estimate.value

    def _control(self, linear: _LinearModel | None, drive: Drive) -> tuple[_LinearModel | None, tuple[str, ...]]:
        """The linear model if it can serve, and what to say if not."""
        if self._raw:
            return None, ()
        if linear is None:
            return None, ("there is no linear model: gains stand alone, up to the highest frequency excited",)
        if drive.excitation.is_held:
            return None, ("noise is held: gains at the instants of its samples stand alone, without the linear model",)
        if not linear.status.ok or linear.slowest * drive.excitation.period < _DECAYED:
            return None, ("motions of the linear model outlast the period: gains stand alone, without it",)
        return linear, ()

    def _filter(self, question: Question, drive: Drive) -> Array:
        """From the squared gain to what the index adds up, at the excited frequencies."""
        if question.road is None:
            return np.ones(drive.omega.size)
        delays = np.array([delay for delay in drive.delays if delay is not None])
        corner = corner_of(question, delays, CONVENTIONS[self.conventions]) or 0.0
        return np.asarray(1.0 / (drive.omega**2 + corner**2))

    def _combine(self, question: Question, known: _LinearModel | None, gains: Array, drive: Drive) -> Estimate:
        """The index from squared gains (realisations, outputs, harmonics)."""
        lines = None if known is None else known.squares(drive.omega)
        rest = gains if lines is None else gains - lines
        scale = 1.0 if question.road is None else question.road.velocity_intensity
        weights = scale * np.array([abs(output.weight) for output in question.outputs])
        if question.combination is Combination.PEAK_GAIN:
            value, scatter, peaks = _peak(rest[:, 0], lines, known, drive.omega, self._window(drive.omega[0]))
            value, scatter = weights[0] * value, weights[0] * scatter
            peaks = tuple(Peak(peak.omega, weights[0] * peak.gain) for peak in peaks)
        else:
            sums = drive.omega[0] / np.pi * rest.sum(axis=2)  # both signs of the frequency
            squares = sums.mean(axis=0) + (0.0 if known is None else known.norms**2)
            sizes = np.sqrt(np.maximum(squares, 0.0))
            value, peaks = float(weights @ sizes), ()
            scatter = (sums - sums.mean(axis=0)) @ (0.5 * weights / np.maximum(sizes, 1e-300))
        count = scatter.size
        error = float(np.sqrt(np.sum(scatter**2) / (count * (count - 1))))
        reach = float(student.ppf(0.975, count - 1)) * error
        return Estimate(value, question.unit, OK, error, (value - reach, value + reach), count, peaks)

    def _window(self, spacing: float) -> Array:
        reach = int(2.0 * math.pi * self.smoothing / spacing * (1.0 + 1e-9))
        window: Array = np.hanning(2 * reach + 3)[1:-1]
        return np.asarray(window / window.sum())


@dataclass(frozen=True, eq=False)
class SampledObjective:
    """An index by simulation as a function of the free values. Differences use the same realisations at both ends."""

    method: ApproximateLinear
    vehicle: Vehicle
    index: Index

    def values(self, points: Array) -> Array:
        """The index at each row of `points`, infinite where it has no trustworthy value."""
        columns = dict(zip(self.vehicle.free_values(), points.T, strict=True))
        values = self.method.estimate_many(self.vehicle, [self.index], columns)[:, 0]
        return np.where(np.isnan(values), np.inf, values)

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The index and its central differences."""
        steps = 1e-3 * point * np.eye(point.size)
        values = self.values(np.vstack([point, point + steps, point - steps]))
        with np.errstate(invalid="ignore"):  # infinite on both sides: no gradient
            slopes = (values[1 : 1 + point.size] - values[1 + point.size :]) / (2e-3 * point)
        return float(values[0]), np.asarray(slopes)

    def active(self, point: Array) -> Array | None:
        """None: the smoothed index is taken as one function."""
        return None

    def components(self, point: Array, which: Array) -> tuple[Array, Array]:
        """The index itself."""
        value, gradient = self.value_and_gradient(point)
        return np.array([value]), gradient[None]


@dataclass(frozen=True, eq=False)
class _LinearModel:
    """What is known of the linear model of a design for one question."""

    system: LinearSystem
    norms: Array  # of its outputs; infinite for a peak gain, which needs none
    slowest: float  # rate of its slowest motion [rad/s]
    status: Status

    def squares(self, omega: Array) -> Array:
        """Squared gains (outputs, frequencies) from the road's velocity or the force."""
        return np.asarray(np.abs(frequency_response(self.system, omega)[:, :, 0].T) ** 2)


@dataclass(eq=False)
class _Runs:
    """Power spectra of some outputs of a design, one realisation after the other as they are asked for."""

    system: PiecewiseSystem
    drive: Drive
    outputs: tuple[str, ...]
    seed: int
    squares: list[Array] = field(default_factory=list)  # (outputs, harmonics)
    inputs: list[Array] = field(default_factory=list)  # (harmonics,)
    status: Status = OK
    warning: Status = OK

    def upto(self, count: int) -> tuple[Array, Array]:
        """Of the first `count` realisations, or fewer if one had to stop, which `status` then tells."""
        while len(self.squares) < count and self.status.ok:
            self._add(len(self.squares))
        return np.array(self.squares), np.array(self.inputs)

    def _add(self, number: int) -> None:
        seed = int(np.random.SeedSequence([self.seed, number]).generate_state(1)[0])
        if number == 0:
            check_holds(self.system, self.drive.signals(seed))
        table, power = self.drive.realisation(seed)
        run, mismatch = recorded_period(self.system, table)
        if not run.status.ok:
            self.status = Status(StatusKind.FAILED, f"realisation {number + 1}: {run.status.message}")
            return
        if mismatch > _REPEATS:
            self.warning = Status(
                StatusKind.INACCURATE,
                f"in realisation {number + 1} the state still changes by {mismatch:.1e} of its size over a period; "
                f"take a longer one",
            )
        trajectory = trajectory_of(run, None, "", run.state)
        self.squares.append(np.array([self.drive.power(trajectory[name]) for name in self.outputs]))
        self.inputs.append(power)


def _peak(
    rest: Array, lines: Array | None, known: _LinearModel | None, omega: Array, window: Array
) -> tuple[float, Array, tuple[Peak, ...]]:
    """The largest gain, its deviation in each realisation, and the local maxima, the highest first.

    Squared gains less those of the linear model, `rest` (realisations, harmonics), are smoothed; those of the model,
    `lines`, are not, and between harmonics too they are known.
    """
    share = np.convolve(np.ones(omega.size), window, "same")
    smooth = np.array([np.convolve(row, window, "same") for row in rest]) / share
    mean = smooth.mean(axis=0)
    total = mean if lines is None else mean + lines[0]

    def between(at: Array) -> Array:
        """Squared gains at any frequencies of the band."""
        linear = 0.0 if known is None else known.squares(at)[0]
        return np.asarray(np.maximum(np.interp(at, omega, mean) + linear, 0.0))

    found = sorted((_refined(between, omega, i) for i in _summits(total, window.size)), key=lambda peak: -peak.gain)
    best = found[0]
    deviation = np.array([np.interp(best.omega, omega, row) for row in smooth - mean])
    return best.gain, deviation / (2.0 * max(best.gain, 1e-300)), tuple(found)


def _summits(values: Array, reach: int) -> list[int]:
    """Places of values that are the largest within `reach` to both sides, and not below a quarter of the largest."""
    high = np.flatnonzero(values >= 0.25 * values.max())
    return [int(i) for i in high if values[i] >= values[max(i - reach, 0) : i + reach + 1].max()]


def _refined(squares: Callable[[Array], Array], omega: Array, i: int) -> Peak:
    """The maximum between the neighbours of a harmonic."""
    at = np.linspace(omega[max(i - 1, 0)], omega[min(i + 1, omega.size - 1)], 129)
    values = squares(at)
    best = int(np.argmax(values))
    return Peak(float(at[best]), float(np.sqrt(values[best])))


def _linear_model(mechanism: Mechanism, question: Question, conventions: str) -> _LinearModel | None:
    """The linear model of a mechanism, or None where friction or a gap alone holds something."""
    try:
        problem: LinearProblem = linear_problem(mechanism, question, CONVENTIONS[conventions])
        system = problem.system(close(problem.descriptor, {}))
    except MechanismError:
        if not _is_nonlinear(mechanism):
            raise
        return None
    slowest = float(-np.linalg.eigvals(system.A).real.max(initial=-math.inf))
    if question.combination is Combination.PEAK_GAIN:
        return _LinearModel(system, np.full(1, np.inf), slowest, OK)
    norms = h2(system, problem.pade_order)
    return _LinearModel(system, norms.outputs, slowest, norms.status)


def _is_nonlinear(mechanism: Mechanism) -> bool:
    """Whether there is a friction or a gap that is not zero."""
    elements = (branch.element for branch in full_graph(mechanism).branches)
    return any(isinstance(e, Friction | Gap) and isinstance(e.value, float | int) and e.value > 0.0 for e in elements)


def _inertia_felt(mechanism: Mechanism, name: str) -> float:
    """Inertia that resists a force where it acts [kg]."""
    inertia = {coordinate.name: coordinate.inertia for coordinate in mechanism.coordinates}
    (port,) = (force.port for force in mechanism.forces if force.name == name)
    return 1.0 / sum(lever**2 / inertia[coordinate] for coordinate, lever in port.items() if lever)


def _known(estimate: Estimate) -> Estimate:
    """A norm as an estimate without scatter."""
    value = estimate.value
    return Estimate(value, estimate.unit, estimate.status, 0.0, (value, value), 0, estimate.peaks, estimate.notes)


def _with(estimate: Estimate, status: Status, notes: tuple[str, ...]) -> Estimate:
    e = estimate
    return Estimate(e.value, e.unit, status, e.standard_error, e.interval, e.realisations, e.peaks, notes)


def _check_whole(what: str, value: object, least: int, most: int) -> None:
    if not is_number(value) or value != int(value) or not least <= value <= most:
        raise IndicatorError(f"{what} is a whole number from {least} to {most}, got {value!r}.")
