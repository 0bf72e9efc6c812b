"""`ExpectedValue`: simulation on random roads, averaged, with its standard error. The paper's second method."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import InerterError, LinearSystemError, MechanismError, PerformanceIndexError, StatusKind, worst_of
from inerter.indices.definition import Index, IndexDefinition
from inerter.methods.error_bounds import with_error_sources
from inerter.methods.harmonic_response import ForcedResponse, coarse_maxima, frequency_grid, local_maxima
from inerter.methods.linear import (
    CONVENTIONS,
    Conventions,
    LinearProblem,
    check_conventions,
    linear_problem,
    with_convention_filters,
)
from inerter.methods.method import Estimate, FormerMethodNames, NonlinearitySupport
from inerter.methods.multisine_lines import SampledObjective
from inerter.methods.objective import Objective, rows_of
from inerter.methods.out_of_band import PROMISE, mean_on_roads, on_roads
from inerter.methods.perturbation import first_order
from inerter.methods.realisations import random_excitation, realisation_seeds
from inerter.methods.statistical_linearisation import StatisticalLinearisation
from inerter.networks.elements import middle
from inerter.simulation.event_driven import KERNELS
from inerter.simulation.threads import threads
from inerter.systems.descriptor import close
from inerter.systems.piecewise import PiecewiseSystem, piecewise
from inerter.validation import check_share, check_whole
from inerter.vehicle.vehicle import Vehicle
from inerter.work.blas_threads import one_blas_thread

Array = NDArray[np.float64]
_DEFAULT = 8  # realisations
_FEWEST = 8  # before the scatter of an adaptive estimate is believed
_MORE = 400  # roads on which the first-order change is averaged, which is quick


@dataclass(frozen=True)
class ExpectedValue(FormerMethodNames):
    """Simulation of the nonlinear design, with friction and gaps: on random roads, or under sinusoidal forces.

    Each of `realisations` roads (8 by default), which `seed` decides, is a multisine, 0.1 to 1000 Hz (eq. (17) of the
    source). The design settles on it, and mean squares are taken over the next period of 10 s. The value is made of the
    roots of their means over the roads, `samples` of those on each. A design that remembers the road for longer than a
    period, as one that is hardly damped, gets roads of 40, 160 or 640 s, with lines as much closer; `period` [s] sets
    their length.
    Where no such road shows a steady state, as with a strut that sticks on an undamped tyre, the value is nan. With
    `relative_error`, roads are added, from 8 to 1000, until the standard error is that part of the value. Designs are
    driven over the same roads, so that differences between them are known better than either (see `compare`).

    Under the conventions "exact" the power of the road beyond its lines is added from a linear design that moves alike:
    its frictions are dampers of the r.m.s. velocity that was simulated. Without friction and gaps the value is the
    norm, and is returned as such. "paper2008" samples roads at 1 ms and holds them, adds nothing, takes the mean of
    r.m.s. values, and the tyre load of a half car over s + 2 pi rad/s.

    A peak gain is the largest ratio of r.m.s. displacement to r.m.s. force over all frequencies for a sine of the
    index's `amplitude`; `peaks` holds every local maximum, each found near where harmonic balance has one (with gaps:
    where a grid of frequencies has one). It has no scatter, and is the same under both conventions.

    `jobs` threads share the work (all cores by default). Source: Wang and Su (2008), section 4.

    Raises `PerformanceIndexError` for numbers that cannot be; where it is used, for a peak gain with friction or gaps
    whose index says no amplitude, and under "paper2008" `SimulationError` where a road that jumps moves a damper, an
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
    period: int | None = None
    name = "expected-value"
    description = (
        "means over simulations of the nonlinear design, with friction, gaps and elasticity, on random roads; for a "
        "peak gain the largest response to a sinusoidal force"
    )
    brief = "simulation"
    nonlinearity_support = NonlinearitySupport.BOTH
    needs_amplitude = True
    supports_optimisation = True
    promise = PROMISE

    def __post_init__(self) -> None:
        check_conventions(self.conventions)
        check_whole(PerformanceIndexError, "The seed", self.seed, 0)
        if self.realisations is not None:
            check_whole(PerformanceIndexError, "The number of realisations", self.realisations, 2)
        if self.jobs is not None:
            check_whole(PerformanceIndexError, "The number of threads", self.jobs, 1)
        if self.period is not None:
            check_whole(PerformanceIndexError, "The length of a road in seconds", self.period, 1)
        if self.realisations is not None and self.relative_error is not None:
            raise PerformanceIndexError("Give either realisations or a relative_error to reach, not both.")
        if self.relative_error is not None:
            check_share(PerformanceIndexError, "The relative error to reach", self.relative_error)

    def estimate(self, vehicle: Vehicle, index: Index) -> Estimate:
        """The index of a vehicle without free values."""
        with one_blas_thread(), threads(self.jobs) as pool:
            return self._estimate(vehicle, index, pool)

    def estimate_many(self, vehicle: Vehicle, indices: Sequence[Index], points: Mapping[str, Array]) -> Array:
        """The indices (designs, indices) at many values of the free values; nan where the status is not ok."""
        names = list(points)
        columns = rows_of(points, names)
        result = np.full((columns.shape[0], len(indices)), np.nan)
        with one_blas_thread(), threads(self.jobs) as pool:
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
            halfway = {name: middle(free) for name, free in vehicle.free_values().items()}
            roads = self.estimate(vehicle.with_values(halfway), index).realisations
            fixed = self.with_realisations(max(roads, 2))
        return SampledObjective(fixed.estimate, vehicle, index)

    def with_realisations(self, realisations: int, period: int | None = None) -> ExpectedValue:
        """Copy of the method with a fixed number of roads, and with `period` [s] as their length if given."""
        return replace(self, realisations=realisations, relative_error=None, period=period or self.period)

    def controls(self, vehicle: Vehicle, index: Index, count: int) -> tuple[Array, Array] | None:
        """First-order change of the index by friction on the first `count` roads (count,), and on further roads.

        None for a peak gain, and where there is a gap or friction alone holds a part.
        """
        mechanism, conventions = vehicle.mechanism(), CONVENTIONS[self.conventions]
        definition = with_convention_filters(conventions, mechanism, index.definition(mechanism))
        system = piecewise(definition.drive.excited_mechanism(mechanism))
        if definition.is_peak:
            return None
        if not is_nonlinear(system):
            return np.zeros(count), np.zeros(_MORE)
        change = first_order(system, definition, random_excitation(system, definition, conventions, self.period))
        if change is None:
            return None
        seeds = realisation_seeds(self.seed, 0, count + _MORE)
        changes = change(seeds)
        return changes[:count], changes[count:]

    def kernels(self, definition: IndexDefinition, *, search: Vehicle | None, limited: bool = False) -> tuple[Any, ...]:
        """Compiled functions of simulations, and of the methods that locate peaks and optima."""
        quick = StatisticalLinearisation().kernels(definition, search=search, limited=limited)
        return (*quick, *KERNELS) if search is not None or definition.is_peak else KERNELS

    def _estimate(self, vehicle: Vehicle, index: Index, pool: ThreadPoolExecutor) -> Estimate:
        mechanism, conventions = vehicle.mechanism(), CONVENTIONS[self.conventions]
        definition = with_convention_filters(conventions, mechanism, index.definition(mechanism))
        system = piecewise(definition.drive.excited_mechanism(mechanism))
        if not _is_held(system, definition, conventions) and not is_nonlinear(system):
            linear = _linear(vehicle, definition, conventions)
            assert linear is not None
            return replace(linear.estimate({}), standard_error=0.0)
        if definition.is_peak:
            linear = _linear(vehicle, definition, conventions)
            return self._peak_gain(vehicle, index, system, definition, linear, pool)
        wanted = self.realisations or (_FEWEST if self.relative_error else _DEFAULT)
        design = on_roads(system, definition, conventions, self.seed, self.period)
        return mean_on_roads(design, wanted, self.relative_error, pool)

    def _peak_gain(
        self,
        vehicle: Vehicle,
        index: Index,
        system: PiecewiseSystem,
        definition: IndexDefinition,
        linear: LinearProblem | None,
        pool: ThreadPoolExecutor,
    ) -> Estimate:
        if definition.amplitude is None:
            raise PerformanceIndexError(
                "The peak gain of a design with friction or gaps depends on the force amplitude. Give it, such as 1000 "
                "N."
            )
        (output,) = definition.outputs
        (path,) = definition.input_paths(system.mechanism)
        forced = ForcedResponse(system, path, output.output, definition.amplitude, *definition.filters)
        poles, known = np.zeros(0, dtype=complex), np.zeros(0)
        if linear is not None:
            closed = close(linear.descriptor, {})
            poles = np.linalg.eigvals(closed.A)
            known = np.array([peak.omega for peak in linear.estimate({}).peaks if np.isfinite(peak.omega)])
        expected, visited = _expected_peaks(vehicle, index), None
        if expected is None:
            coarse, visited = coarse_maxima(forced, poles, pool)
            expected = np.concatenate([coarse, known])
        summits = local_maxima(forced, expected, float(frequency_grid(poles)[0]), pool, visited)
        weighted = tuple(replace(one.peak, gain=abs(output.weight) * one.peak.gain) for one in summits)
        status = worst_of(one.status for one in summits)
        value = np.nan if status.kind is StatusKind.FAILED else weighted[0].gain
        estimate = Estimate(value, definition.unit, status, standard_error=0.0, interval=(value, value), peaks=weighted)
        return with_error_sources(estimate, summits[0].errors, PROMISE)


def _expected_peaks(vehicle: Vehicle, index: Index) -> Array | None:
    """Frequencies of the local maxima by harmonic balance [rad/s]; None if it does not apply."""
    try:
        peaks = StatisticalLinearisation().estimate(vehicle, index).peaks
    except InerterError:
        return None
    omegas = np.array([peak.omega for peak in peaks])
    return omegas if omegas.size and np.all(np.isfinite(omegas)) else None


def is_nonlinear(system: PiecewiseSystem) -> bool:
    """Whether an element switches; one that exerts a constant force moves the static equilibrium alone."""
    lower, upper = system.limits.T
    return bool(np.any(lower < upper))


def _is_held(system: PiecewiseSystem, definition: IndexDefinition, conventions: Conventions) -> bool:
    """Whether the conventions change the value of linear designs too, so that it differs from the norm."""
    if conventions.hold is None:
        return False
    return not definition.drive.is_random or random_excitation(system, definition, conventions).hold is not None


def _linear(vehicle: Vehicle, definition: IndexDefinition, conventions: Conventions) -> LinearProblem | None:
    """Linear problem of the design; None if it is ill-posed without friction."""
    try:
        return linear_problem(vehicle.mechanism(), definition, conventions)
    except (MechanismError, LinearSystemError):
        return None
