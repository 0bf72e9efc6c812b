"""`ApproximateLinear`: gains of the nonlinear design on a random input, read as if it were linear.

Method 1 of Wang and Su (2008). The design is excited periodically until its response repeats; at every harmonic the
gain is the size of the output over that of the input, and takes the place of the linear gain in the index.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, ErrorSource, PerformanceIndexError, Status, StatusKind, worst_of
from inerter.formatting import format_quantity
from inerter.indices.definition import Index, IndexDefinition
from inerter.indices.excitation import error_sources_of, shape_of
from inerter.methods.averages import interval_of
from inerter.methods.equivalent_linear import (
    EquivalentLinearModel,
    equivalent_linear_model,
    few_lines,
    has_play,
    with_velocities,
)
from inerter.methods.error_bounds import with_error_sources
from inerter.methods.excitation import Excitation, ExcitedInputs, MultisineExcitation, NoiseExcitation
from inerter.methods.gains import LinearModel, Runs, largest_gain, linear_model
from inerter.methods.linear import CONVENTIONS, check_conventions, linear_problem, with_convention_filters
from inerter.methods.measured_road_errors import road_errors
from inerter.methods.method import Estimate, FormerMethodNames, NonlinearitySupport
from inerter.methods.multisine_lines import SampledObjective
from inerter.methods.objective import Objective, count_of
from inerter.methods.statistical_linearisation import StatisticalLinearisation
from inerter.norms.hinf import GainPeak
from inerter.simulation.event_driven import KERNELS
from inerter.systems.graph import full_graph
from inerter.systems.input_paths import InputPath
from inerter.systems.outputs import input_names
from inerter.systems.piecewise import piecewise
from inerter.validation import check_share, check_whole, is_number
from inerter.vehicle.mechanism import GROUND_ACCELERATION, Mechanism
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
_ROAD_RMS = math.sqrt(1e-8 / 1e-3)  # [m] noise of 1e-8 m^2/Hz, held for 1 ms
_FORCE_RMS = math.sqrt(200.0 / 1e-3) / 181.75  # [N/kg] 200 N^2/Hz on the quarter car, twice the size on the half car
PROMISE = 0.05  # relative error of a value that is ok, sampling apart
_STEPPED = 1e-4  # relative error of gains by the cubics between four points of the shortest wave, jumps apart
_UNSETTLED = 20.0  # times the change of the state over a period that gains may be off by
_LOST = 1e-2  # of a mean square that may hide between the harmonics, beyond which nothing is known
_UNLIKE = "no equivalent linear model: the gains are used alone, up to the highest excited frequency"
_LOOSE = "the gains are used alone; above the highest excited frequency that of the linear model, with closed gaps"
_HELD = "the noise is held: the gains at the instants of its samples are used alone"
_MOST = 1000  # realisations


@dataclass(frozen=True)
class ApproximateLinear(FormerMethodNames):
    """Gains |Y|/|U| of the design itself on a random input, in the place of linear gains.

    An index of r.m.s. values adds up the squared gains of all harmonics; a peak gain is the largest. `road` (heights,
    in m) and `force` are the excitations; without, multisines of the paper's size, 3.162 mm and 2.461 N for each kg of
    the body that the force acts on, from 0.1 to 500 Hz.

    With the conventions "exact", squared gains are mean |Y|^2 over mean |U|^2 over `realisations`. Of those of the
    linear design that moves alike (frictions as dampers of the r.m.s. velocities found, gaps closed), which are known,
    only the difference is estimated: an r.m.s. value is the root of norm^2 + sum of (gain^2 - linear gain^2), and for a
    peak gain the difference alone is smoothed over neighbouring frequencies, by a Hann window that reaches `smoothing`
    [Hz] to both sides. Play moves as no linear design does: r.m.s. values then are the gains alone, as a note says, and
    the linear design adds the band above the highest frequency only. Where the period is too short for the slowest
    motion, there is no value, or with play a bound by what a period leaves of a motion. A linear design gets its norm.

    With "paper2008" the input is the paper's noise, held for 1 ms and repeated after 100 s, and gains are the raw
    ratios |Y/U| at the instants of the samples, without the linear model; J3 of a half car is divided by s + 2 pi
    instead of s. The value is the median over realisations, because the square of a raw ratio has no mean where
    friction adds what is not of the input: |U| may come close to zero. Peak gains are smoothed here too, as mean |Y|^2
    over mean |U|^2: the largest of 50 000 raw ratios says nothing of the design.

    `seed` decides the realisations, which are the same for every design. The standard error is that of the mean over
    realisations, the interval Student's; that of a median is from the scatter of logarithms, which has an expectation
    where that of raw ratios has none. `relative_error` asks for realisations until the standard error is below that
    part of the value.

    Raises `PerformanceIndexError` for settings that cannot be.

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
    realisations: int = 6
    relative_error: float | None = None
    smoothing: float = 0.2
    seed: int = 0
    conventions: str = "exact"
    name = "approximate-linear"
    description = "norms of the gains, output over input at each frequency, of the nonlinear design on random inputs"
    brief = "measured gains"
    nonlinearity_support = NonlinearitySupport.BOTH
    needs_amplitude = False
    supports_optimisation = True
    promise = PROMISE

    def __post_init__(self) -> None:
        check_conventions(self.conventions)
        for what, given in (("road", self.road), ("force", self.force)):
            if given is not None and not isinstance(given, Excitation):
                raise PerformanceIndexError(
                    f"The {what} is excited by MultisineExcitation(...) or NoiseExcitation(...), got {given!r}."
                )
        check_whole(PerformanceIndexError, "The number of realisations", self.realisations, 2, _MOST)
        check_whole(PerformanceIndexError, "The seed", self.seed, 0, 2**63)
        if self.relative_error is not None:
            check_share(PerformanceIndexError, "The relative error to reach", self.relative_error)
        if not is_number(self.smoothing) or self.smoothing < 0.0:
            raise PerformanceIndexError(f"The reach of the smoothing must be non-negative, got {self.smoothing!r}.")

    def estimate(self, vehicle: Vehicle, index: Index) -> Estimate:
        """The index of a vehicle without free values."""
        return self.estimates(vehicle, [index])[0]

    def estimates(self, vehicle: Vehicle, indices: Sequence[Index], always: bool = False) -> list[Estimate]:
        """Several indices of one vehicle: those with the same input share the simulations.

        `always` simulates a linear design too, which then gets its norm back.
        """
        mechanism = vehicle.mechanism()
        conventions = CONVENTIONS[self.conventions]
        definitions = [
            with_convention_filters(conventions, mechanism, index.definition(mechanism)) for index in indices
        ]
        if not always and not _is_nonlinear(mechanism):
            return [self._estimate_linear(mechanism, definition) for definition in definitions]
        linears = [
            None if self._raw else equivalent_linear_model(mechanism, definition, conventions)
            for definition in definitions
        ]
        drives = [self._drive(mechanism, definition) for definition in definitions]
        driven = [definition.drive.excited_mechanism(mechanism) for definition in definitions]
        moved = [(one.ground_moves, drive) for one, drive in zip(driven, drives, strict=True)]
        systems = {one.ground_moves: with_velocities(piecewise(one)) for one in driven}
        runs = dict[tuple[bool, ExcitedInputs], Runs]()
        for definition, way in zip(definitions, moved, strict=True):
            names = runs[way].outputs if way in runs else ()
            names = tuple(dict.fromkeys((*names, *(output.output for output in definition.outputs))))
            system, frictions = systems[way[0]]
            runs[way] = Runs(system, way[1], names, frictions, int(self.seed))
        return [
            self._estimate_from_runs(definition, linear, runs[way])
            for definition, linear, way in zip(definitions, linears, moved, strict=True)
        ]

    def estimate_many(self, vehicle: Vehicle, indices: Sequence[Index], points: Mapping[str, Array]) -> Array:
        """The indices (designs, indices) at many values of the free values; nan where an estimate is not ok."""
        count = count_of(points)
        result = np.full((count, len(indices)), np.nan)
        for i in range(count):
            design = vehicle.with_values({name: float(column[i]) for name, column in points.items()})
            estimates = self.estimates(design, indices)
            result[i] = [estimate.value if estimate.status.ok else np.nan for estimate in estimates]
        return result

    def kernels(self, definition: IndexDefinition, *, search: Vehicle | None, limited: bool = False) -> tuple[Any, ...]:
        """Compiled functions of simulations, and of the methods that start a search."""
        quick = () if search is None else StatisticalLinearisation().kernels(definition, search=search, limited=limited)
        return (*quick, *KERNELS)

    def objective(self, vehicle: Vehicle, index: Index) -> Objective:
        """The index as a function of the free values: one estimate a point, on the same realisations everywhere."""
        return SampledObjective(self.estimate, vehicle, index)

    def with_realisations(self, realisations: int, period: int | None = None) -> ApproximateLinear:
        """Copy of the method with a fixed number of realisations; `period` is ignored, as the excitation sets it."""
        return replace(self, realisations=realisations, relative_error=None)

    @property
    def _raw(self) -> bool:
        return self.conventions == "paper2008"

    def _estimate_linear(self, mechanism: Mechanism, definition: IndexDefinition) -> Estimate:
        """Estimate of a linear design: its norm, without scatter."""
        problem = linear_problem(mechanism, definition, CONVENTIONS[self.conventions])
        norm = problem.estimate({})
        return replace(norm, standard_error=0.0, interval=(norm.value, norm.value))

    def _drive(self, mechanism: Mechanism, definition: IndexDefinition) -> ExcitedInputs:
        """Excitation of the inputs: signal, r.m.s. value, and delay of each input."""
        driven = definition.drive.excited_mechanism(mechanism)
        paths = definition.input_paths(driven)
        _check_gains(paths)
        delays = {path.input: path.delay for path in paths}
        on_road = paths[0].input in {road.name for road in driven.roads}
        default = NoiseExcitation() if self._raw else MultisineExcitation()
        excitation = (self.road if on_road else self.force) or default
        rms = excitation.rms or (_ROAD_RMS if on_road else _FORCE_RMS * _inertia_felt(driven, paths[0].input))
        return ExcitedInputs(excitation, rms, tuple(delays.get(name) for name in input_names(driven)))

    def _estimate_from_runs(
        self, definition: IndexDefinition, linear: EquivalentLinearModel | None, runs: Runs
    ) -> Estimate:
        notes: tuple[str, ...] = ()
        if definition.amplitude is not None:
            notes = ("the amplitude of a sine is ignored: the excitation sets the size",)
        count = int(self.realisations)
        while True:
            squares, inputs = runs.upto(count)
            if not runs.status.ok:
                return Estimate(math.nan, definition.unit, runs.status, notes=notes)
            places = [runs.outputs.index(output.output) for output in definition.outputs]
            pooled = not self._raw or definition.is_peak
            gains = _gains(squares[:, places], inputs[:, None], pooled)
            factor = _factor(definition, definition.input_paths(runs.system.mechanism)[0], runs)
            estimate, peaked = self._from_gains(definition, linear, gains * factor, runs)
            if self.relative_error is None or count >= _MOST or self._is_accurate_enough(estimate):
                break
            count = min(2 * count, _MOST)
        near = factor * self._near_peak(estimate, runs.drive)
        jumps = 0.0 if self._raw else runs.sampling_error(places, near)  # of raw gains instants are a part
        stepped = ErrorSource("time step", _STEPPED + jumps)
        if not self._raw:
            peaked = max(peaked, runs.peaked_by_play(places, near))
        settled = ErrorSource("periodic steady state", _UNSETTLED * runs.mismatch + runs.unsettled)
        own = stepped, settled, *estimate.error_sources, few_lines(peaked)
        stand_ins = error_sources_of(definition.drive, runs.system.mechanism)
        if shape_of(definition.drive) is not None and linear is not None:
            model = linear_model(linear, runs.speeds, runs.drive.excitation.period)
            stand_ins += road_errors(definition, model.system, linear.problem.pade_order, model.norms)
        status = worst_of([estimate.status, runs.warning])
        estimate = with_error_sources(replace(estimate, status=status, error_sources=stand_ins), own, PROMISE)
        status = estimate.status
        if status.ok and self.relative_error is not None and not self._is_accurate_enough(estimate):
            status = Status(StatusKind.INACCURATE, f"{count} realisations do not reach the requested relative error")
        return replace(estimate, status=status, notes=(*estimate.notes, *notes))

    def _from_gains(
        self, definition: IndexDefinition, linear: EquivalentLinearModel | None, gains: Array, runs: Runs
    ) -> tuple[Estimate, float]:
        """Estimate of the index from squared gains, with the equivalent linear model as control if there is one.

        Also the share of a mean square by which it may be off by friction, as harmonics have lower peaks than a random
        motion.
        """
        drive = runs.drive
        if self._raw:
            return self._combine(definition, None, gains, drive), 0.0
        left = 2.0 * runs.remaining
        if linear is None or drive.excitation.is_held:
            alone = self._combine(definition, None, gains, drive, left)
            return replace(alone, notes=(_HELD if linear else _UNLIKE,)), 0.0
        model = linear_model(linear, runs.speeds, drive.excitation.period)
        if not model.status.ok:
            value = math.inf if np.any(np.isinf(model.norms)) else math.nan
            return Estimate(value, definition.unit, model.status), 0.0
        unseen, loose = model.unseen(gains.mean(axis=0), drive.omega), has_play(runs.system)
        if loose:  # the model closes gaps, which may damp what is not damped while they are open
            unseen = max(unseen, left)
        if unseen <= _LOST and (definition.is_peak or not loose):
            return self._combine(definition, model, gains, drive, unseen, loose=loose), model.peaked
        if loose:
            share, above = (0.0, 0.0) if definition.is_peak else model.above(gains.mean(axis=0), drive.omega)
            alone = self._combine(definition, None, gains, drive, left, above, loose)
            sources = (*alone.error_sources, ErrorSource("band above the highest frequency", 0.5 * share))
            return replace(alone, notes=(_LOOSE,), error_sources=sources), 0.0
        at, decay = format_quantity(abs(model.pole.imag), "rad/s", 3), format_quantity(-model.pole.real, "1/s", 2)
        period = format_quantity(drive.excitation.period, "s", 6)
        message = f"a period of {period} is too short for the motion at {at}, which decays by {decay}; use a longer one"
        return Estimate(math.nan, definition.unit, Status(StatusKind.INACCURATE, message)), 0.0

    def _is_accurate_enough(self, estimate: Estimate) -> bool:
        error, asked = estimate.standard_error or 0.0, self.relative_error or math.inf
        return error <= asked * estimate.value

    def _combine(
        self,
        definition: IndexDefinition,
        known: LinearModel | None,
        gains: Array,
        drive: ExcitedInputs,
        unseen: float = 0.0,
        above: Array | float = 0.0,
        loose: bool = False,
    ) -> Estimate:
        """The index from squared gains (realisations, outputs, harmonics), of which a share may be `unseen`.

        Without a model, squares `above` the harmonics (outputs,) are added. `loose` if there is play: then the model
        may be so unlike the motion that a window is wide for the difference, and one twice as wide would not show it.
        """
        lines = None if known is None else known.squares(drive.omega)
        rest = gains if lines is None else gains - lines
        weights = definition.drive.amplitude_density * np.array([abs(output.weight) for output in definition.outputs])
        smoothed: tuple[ErrorSource, ...] = ()
        if definition.is_peak:
            weight = float(weights[0])
            windows = [self._window(drive.omega, times) for times in ((1.0, 2.0, 0.0) if loose else (1.0, 2.0))]
            best, *others = (largest_gain(rest[:, 0], lines, known, drive.omega, window) for window in windows)
            changes = sum(abs(other.gain - best.gain) for other in others)
            if loose:
                every_second = (
                    largest_gain(
                        rest[:, 0, i::2],
                        None if lines is None else lines[:, i::2],
                        known,
                        drive.omega[i::2],
                        windows[-1],
                    )
                    for i in (0, 1)
                )
                changes += max(abs(other.gain - others[-1].gain) for other in every_second)
            smoothed = (
                ErrorSource("smoothing", changes / max(best.gain, 1e-300)),
                ErrorSource("band below the lowest frequency", best.below),
            )
            value, scatter = weight * best.gain, weight * best.deviations
            peaks = tuple(GainPeak(peak.omega, weight * peak.gain) for peak in best.peaks)
        else:
            sums = drive.omega[0] / np.pi * rest.sum(axis=2)  # both signs of the frequency
            squares = sums.mean(axis=0) + (above if known is None else known.norms**2)
            sizes = np.sqrt(np.maximum(squares, 0.0))
            value, peaks = float(definition.combine(sizes, weights)), ()
            scatter = (sums - sums.mean(axis=0)) @ (0.5 * definition.slopes(sizes, weights) / np.maximum(sizes, 1e-300))
            if self._raw:
                logs = np.log(
                    definition.combine(np.sqrt(sums), weights)
                )  # a standard error of raw ratios has no expectation, theirs has
                value = float(np.exp(np.median(logs)))
                scatter = math.sqrt(0.5 * math.pi) * value * (logs - logs.mean())
        count = scatter.size
        error = float(np.sqrt(np.sum(scatter**2) / (count * (count - 1))))
        interval, samples = interval_of(value, error, count), tuple((value + scatter).tolist())
        sources = (ErrorSource("spacing of harmonics", 0.5 * unseen), *smoothed)
        return Estimate(
            value, definition.unit, OK, error, interval, count, peaks, samples=samples, error_sources=sources
        )

    def _near_peak(self, estimate: Estimate, drive: ExcitedInputs) -> Array:
        """Mask (harmonics,) as 0 or 1: harmonics smoothed together at the peak of a peak gain; else all ones."""
        if not estimate.peaks:
            return np.ones(drive.omega.size)
        reach = max(2.0 * math.pi * self.smoothing, drive.omega[0])
        return np.asarray(np.abs(drive.omega - max(estimate.peaks[0].omega, drive.omega[0])) <= reach, dtype=float)

    def _window(self, omega: Array, times: float) -> Array:
        reach = min(int(2.0 * math.pi * times * self.smoothing / omega[0] * (1.0 + 1e-9)), (omega.size - 1) // 2)
        window: Array = np.hanning(2 * reach + 3)[1:-1]
        return np.asarray(window / window.sum())


def _gains(outputs: Array, inputs: Array, pooled: bool) -> Array:
    """Squared gains of each realisation; their mean is that of the ratios, or, if `pooled`, the ratio of the means.

    What a realisation adds to a ratio of means is its deviation from it, to first order.
    """
    if not pooled:
        return np.asarray(outputs / inputs)
    size = inputs.mean(axis=0)
    ratio = outputs.mean(axis=0) / size
    return np.asarray(ratio + (outputs - ratio * inputs) / size)


def _factor(definition: IndexDefinition, path: InputPath, runs: Runs) -> Array:
    """Factors (outputs, frequencies) from squared gains to the squares that the index sums."""
    omega = runs.drive.omega
    one = np.ones(omega.size)
    squares = np.array([one if f is None else np.abs(f.response(omega)) ** 2 for f in definition.filters])
    if path.filter is not None:
        squares *= np.abs(path.filter.response(omega)) ** 2
    by_height = path.displacement or path.input not in {road.name for road in runs.system.mechanism.roads}
    return squares if by_height else np.asarray(squares / omega**2)


def _check_gains(paths: Sequence[InputPath]) -> None:
    """Raises `PerformanceIndexError` for what is no single source with one filter: gains are from one signal."""
    if len({(a.source, a.lever, a.filter) for a in paths}) > 1 or paths[0].lever != 1.0:
        raise PerformanceIndexError(
            "Method approximate-linear computes gains from one signal, but several signals excite this mechanism. "
            "Use norm, statistical-linearisation or expected-value."
        )


def _is_nonlinear(mechanism: Mechanism) -> bool:
    """Whether the mechanism has a friction or a gap of nonzero size."""
    elements = (branch.element for branch in full_graph(mechanism).branches)
    return any(e.acts and isinstance(e.value, float | int) for e in elements)


def _inertia_felt(mechanism: Mechanism, name: str) -> float:
    """Inertia that resists a force where it acts [kg]; the largest one for a force on a node without mass."""
    if mechanism.ground_moves and name == GROUND_ACCELERATION:
        return 1.0  # an acceleration is a force for each kg
    inertia = {coordinate.name: coordinate.coefficient for coordinate in mechanism.masses.values()}
    (port,) = (force.port for force in mechanism.forces if force.name == name)
    mobilities = [lever**2 / inertia[name] for name, lever in port.items() if lever and name in inertia]
    return 1.0 / sum(mobilities) if mobilities else max(inertia.values())
