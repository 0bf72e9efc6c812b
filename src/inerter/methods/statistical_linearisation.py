"""`StatisticalLinearisation`: dry friction replaced by equivalent dampers for the resulting motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.indices.definition import Index, IndexDefinition
from inerter.kernels import harmonic
from inerter.methods.compiled_norm import kernels_of
from inerter.methods.describing_function import HarmonicBalance, harmonic_balance
from inerter.methods.equivalent import PROMISE, check_damped, check_outputs, has_friction
from inerter.methods.gaussian_closure import GaussianClosure
from inerter.methods.linear import CONVENTIONS
from inerter.methods.method import Estimate, FormerMethodNames, NonlinearitySupport
from inerter.methods.norm import Norm
from inerter.methods.objective import Differentiable
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StatisticalLinearisation(FormerMethodNames):
    """Dry friction without simulation, for surrogates and trends.

    Indices of r.m.s. values: each friction f [N] becomes a damper sqrt(2/pi) f / sigma, with sigma [m/s] the r.m.s.
    velocity across it on the true (white-velocity) road, taken as Gaussian; all dampers are found together, and the
    index is the norm with them. Peak gains: each friction becomes a damper 4 f / (pi V) at each frequency, with V [m/s]
    the amplitude of the velocity across it under a sinusoidal force of the index's amplitude (harmonic balance in one
    harmonic). A friction that the motion cannot overcome sticks. Without friction the values are those of `Norm`.

    Where friction sticks for a part of the time, or does most of the damping, one damper does not tell what it does,
    and the status is "inaccurate"; "ok" stands for values within 3 % of simulated ones.

    `conventions` is that of `Norm`, for the wheelbase delay and the filter of the index.

    Source: Caughey (1963); Roberts and Spanos, Random Vibration and Statistical Linearization (1990).

    Raises `PerformanceIndexError` for other conventions; where it is used, for a gap with play, and for a peak gain
    with friction whose index says no amplitude.

    >>> import inerter as it
    >>> strut = it.Strut("strut", it.Damper(1.0) | it.Friction(3.0), upper={"mass": 1.0}, lower=it.GROUND)
    >>> mass = it.Mechanism((it.Coordinate("mass", 1.0),), (strut,), forces=(it.Force("push", {"mass": 1.0}),))
    >>> index = it.RandomResponse({"mass_velocity": 1.0}, it.WhiteForce("push", intensity=50.0))
    >>> sigma = it.evaluate(mass, index, it.StatisticalLinearisation()).value  # m/s
    >>> round(2 * sigma**2 * (1.0 + (2 / 3.141592653589793) ** 0.5 * 3.0 / sigma), 6)  # 2 m c sigma^2 = S
    50.0
    """

    conventions: str = "exact"
    name = "statistical-linearisation"
    description = (
        "norms of a linear model in which an equivalent damper replaces each friction element, for the "
        "motion that results; for a peak gain at each frequency under a sinusoidal force"
    )
    brief = "linearisation"
    nonlinearity_support = NonlinearitySupport.FRICTION
    needs_amplitude = True
    supports_optimisation = True
    has_gradients = True
    promise = PROMISE

    def __post_init__(self) -> None:
        Norm(self.conventions)  # refuses what it does not know

    def estimate(self, vehicle: Vehicle, index: Index) -> Estimate:
        """The index of a vehicle without free values; `notes` state the treatment of each friction."""
        closure = self._closure(vehicle, index)
        return Norm(self.conventions).estimate(vehicle, index) if closure is None else closure.estimate()

    def estimate_many(self, vehicle: Vehicle, indices: Sequence[Index], points: Mapping[str, Array]) -> Array:
        """Indices (designs, indices) at many values of the design variables; nan where not accurate."""
        return np.column_stack([self._many(vehicle, index, points) for index in indices])

    def objective(self, vehicle: Vehicle, index: Index) -> Differentiable:
        """The index as a function of the free values, compiled; friction forces may be among them."""
        closure = self._closure(vehicle, index)
        if closure is None:
            return Norm(self.conventions).objective(vehicle, index)
        closure.check_idle()
        return closure

    def check(self, vehicle: Vehicle, index: Index) -> None:
        """Raises what `estimate` would raise for the design's elements and the index's outputs, whatever the values."""
        self._closure(vehicle, index)

    def kernels(self, definition: IndexDefinition, *, search: Vehicle | None, limited: bool = False) -> tuple[Any, ...]:
        """Compiled functions of the method; a search of a design without friction uses those of `Norm`."""
        if definition.is_peak:
            return (*(() if search is None else kernels_of(definition)), harmonic.gains)
        return kernels_of(definition, by_modes=limited)

    def _many(self, vehicle: Vehicle, index: Index, points: Mapping[str, Array]) -> Array:
        closure = self._closure(vehicle, index)
        if closure is None:
            return Norm(self.conventions).estimate_many(vehicle, [index], points)[:, 0]
        columns = [points[name] for name in vehicle.free_values()]
        return closure.evaluate_points(np.column_stack(columns) if columns else np.zeros((1, 0)))

    def _closure(self, vehicle: Vehicle, index: Index) -> GaussianClosure | HarmonicBalance | None:
        """The closure that serves the index; None if no friction acts."""
        mechanism = vehicle.mechanism()
        definition = index.definition(mechanism)
        check_damped(mechanism)
        if not has_friction(mechanism):
            return None
        check_outputs(mechanism, [weighted.output for weighted in definition.outputs])
        if definition.is_peak:
            return harmonic_balance(mechanism, definition)
        return GaussianClosure(mechanism, definition, CONVENTIONS[self.conventions])
