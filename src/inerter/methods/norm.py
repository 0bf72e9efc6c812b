"""`Norm`: exact norms of the linear model, which neglects friction and treats gaps as closed, as its notes state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError
from inerter.indices.definition import ExcitedIndex, Index, IndexDefinition
from inerter.methods.compiled_norm import CompiledNorm, evaluate_problems, first_kernel, kernels_of
from inerter.methods.linear import CONVENTIONS, PROMISE, check_conventions, linear_problem, linear_problem_of_design
from inerter.methods.method import Estimate, FormerMethodNames, NonlinearitySupport
from inerter.methods.network_norm import definition_over_strut, network_kernel, norms_over_strut
from inerter.methods.objective import Differentiable, count_of, rows_of
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Norm(FormerMethodNames):
    """Exact norms of the linear design: H2 for indices that are r.m.s. values, H-infinity for peak gains.

    `conventions` is "exact", or "paper2008" for what the printed numbers of Wang and Su (2008) need: a fifth-order
    Pade approximant of the wheelbase delay, and tyre loads over s + 2 pi rad/s where the road arrives at two axles.

    Raises `PerformanceIndexError` for other conventions.

    >>> import inerter as it
    >>> car = it.QuarterCar(181.75, 25.0, 120e3, it.Spring(120e3) | it.Damper(7544.2) - it.Inerter(366.52))
    >>> found = it.evaluate(car, it.RideComfort(it.Road(roughness=5e-7, speed=25.0)), it.Norm())
    >>> round(found.value, 4), found.unit  # Wang and Su (2008), Table 1
    (2.4281, 'm/s^2')
    """

    conventions: str = "exact"
    name = "norm"
    description = "exact norms of the linear model: an H2 norm for an r.m.s. value, an H-infinity norm for a peak gain"
    brief = "exact norms"
    nonlinearity_support = NonlinearitySupport.NEITHER
    needs_amplitude = False
    supports_optimisation = True
    has_gradients = True
    promise = PROMISE

    def __post_init__(self) -> None:
        check_conventions(self.conventions)

    def estimate(self, vehicle: Vehicle, index: Index) -> Estimate:
        """The index of a vehicle without free values."""
        mechanism = vehicle.mechanism()
        return self.estimate_excited(index.definition(mechanism).excite(mechanism))

    def estimate_excited(self, index: ExcitedIndex) -> Estimate:
        """The value of an index for a mechanism without free values."""
        problem, values = linear_problem_of_design(index, CONVENTIONS[self.conventions])
        return problem.estimate(values)

    estimate.of_excited = estimate_excited  # type: ignore[attr-defined]  # in whose place `evaluate` calls it

    def estimate_many(self, vehicle: Vehicle, indices: Sequence[Index], points: Mapping[str, Array]) -> Array:
        """The indices (designs, indices) at many values of the free values, compiled."""
        mechanism = vehicle.mechanism()
        conventions = CONVENTIONS[self.conventions]
        count = count_of(points)
        result: Array = np.full((len(indices), count), np.nan)
        if is_exact_norm(self):  # for one design as for many: shared work gives the same digits
            for row, index in enumerate(indices):
                known = norms_over_strut(vehicle, index, points)
                if known is not None:
                    result[row] = known
        rest = np.flatnonzero(np.isnan(result).any(axis=0))
        if rest.size:
            left = {name: values[rest] for name, values in points.items()}
            definitions = [index.definition(mechanism) for index in indices]
            found = evaluate_problems(mechanism, definitions, conventions, left)
            result[:, rest] = np.where(np.isnan(result[:, rest]), found.T, result[:, rest])
        return result.T

    def share_unsure(self, vehicle: Vehicle, index: Index, points: Mapping[str, Array]) -> float:
        """The part of many designs for which double precision does not suffice, each of which takes some 10 ms.

        Without free values it is that of one design: 0 or 1.
        """
        mechanism = vehicle.mechanism()
        problem = linear_problem(mechanism, index.definition(mechanism), CONVENTIONS[self.conventions])
        rows = rows_of(points, problem.descriptor.free)
        return float(np.mean(CompiledNorm(problem).is_unsure(rows)))

    def objective(self, vehicle: Vehicle, index: Index) -> Differentiable:
        """The index as a function of the free values, compiled, with its gradient."""
        mechanism = vehicle.mechanism()
        problem = linear_problem(mechanism, index.definition(mechanism), CONVENTIONS[self.conventions])
        idle = [name for name in vehicle.free_values() if name not in problem.descriptor.free]
        if idle:
            raise DesignError(
                f"The free value of {', '.join(idle)} has no effect in linear analysis, which neglects friction, "
                "treats gaps as closed and drops elements without force. Fix it, or use a method that models its "
                "element."
            )
        return CompiledNorm(problem)

    def kernels(self, definition: IndexDefinition, *, search: Vehicle | None, limited: bool = False) -> tuple[Any, ...]:
        """The compiled code that a search calls; one design is valued without."""
        if search is None:
            return ()
        mechanism, every = search.mechanism(), kernels_of(definition, by_modes=True)
        if not is_exact_norm(self) or definition_over_strut(mechanism, definition) is None:
            return every
        if limited:
            return (network_kernel(definition), *every)
        problem = linear_problem(mechanism, definition, CONVENTIONS[self.conventions])
        return (network_kernel(definition), first_kernel(problem))  # by which optima are confirmed


EXACT_NORM = Norm()  # which other code may compute in its place


def is_exact_norm(method: object) -> bool:
    """Whether a method is `Norm` under exact conventions."""
    return method == EXACT_NORM
