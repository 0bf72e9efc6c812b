"""`optimise_robust`: robust optimisation of a quantile of an index under tolerances; and that quantile as an index."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import DesignError, ErrorSource, worst_of
from inerter.formatting import format_share
from inerter.indices.definition import Index, OfIndex
from inerter.methods.composite_index import IndexLike, estimate_of, objective_of
from inerter.methods.conditions import OverConditions, values_changed
from inerter.methods.method import Estimate, Method, constituents_of
from inerter.methods.objective import Differentiable, Objective, Smooth, rows_of
from inerter.optimisation.limits import Limit
from inerter.optimisation.optimise import Optimum, optimise
from inerter.uncertainty.distributions import (
    Scatter,
    check_sample,
    elements_scatter,
    labels_with_tolerances,
    nominal,
    scatter_left_out,
    scatter_of,
    source_values,
    with_free_scatter,
)
from inerter.uncertainty.tolerance import (
    evaluate_sample,
    quantile_error,
    rank_weights,
    sample_status,
    with_scatter_of_values,
)
from inerter.validation import check_share
from inerter.vehicle.vehicle import Vehicle, check_vehicle

Array = NDArray[np.float64]
_WEIGHT = 1e-6  # smallest weight of a sample that contributes to a gradient


@dataclass(frozen=True)
class Quantile(OfIndex):
    """An index: the quantile of another index at this probability `share`, under tolerances.

    Only element values may have tolerances here. The quantile is a mean of all `samples` weighted by their ranks
    (Harrell and Davis 1982), which changes smoothly with the design; all designs of a search use the same sample. Its
    optimum is slightly overfitted to that sample: `apart` is an independent sample for its evaluation.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(it.free(100, 1e5, name="c")))
    >>> robust = it.optimise_robust(car, it.RideComfort(it.Road(5e-7, 25.0)), it.Norm(), spread={"c": 0.1}, samples=16)
    >>> nominal = it.optimise(car, it.RideComfort(it.Road(5e-7, 25.0)), it.Norm())
    >>> robust.value > nominal.value  # the 95th percentile, above the value without scatter
    True
    """

    index: IndexLike
    scatter: Scatter
    share: float = 0.95
    samples: int = 256
    seed: int = 0

    def __post_init__(self) -> None:
        check_share(DesignError, "The probability of a quantile", self.share)
        check_sample(self.samples, self.seed)

    @property
    def title(self) -> str:
        """Title of the index with the probability."""
        return f"{self.index.title}, {format_share(self.share, 6)} quantile"

    @property
    def factors(self) -> Array:
        """Factors on the values with tolerances, shape (samples, names)."""
        sampler = scipy.stats.qmc.Sobol(len(self.scatter.names), rng=np.random.default_rng(self.seed))
        return self.scatter.factors(sampler.random(self.samples))

    @property
    def apart(self) -> Quantile:
        """The same quantile with an independent sample, four times as large."""
        seed = int(np.random.SeedSequence([int(self.seed), 1]).generate_state(1)[0])
        return replace(self, samples=4 * self.samples, seed=seed)

    @property
    def weights(self) -> Array:
        """Weights of the samples in ascending order."""
        return rank_weights(self.samples, self.share)

    def constituents(self, vehicle: Vehicle) -> Sequence[tuple[Vehicle, Index]]:
        """Vehicles and indices evaluated for each sample; raises `DesignError` unless only elements have tolerances."""
        if not elements_scatter(vehicle, self.scatter):
            raise DesignError("A search supports tolerances of element values only. Name them by their labels.")
        return constituents_of(vehicle, self.index)

    def per_output(self, split: Callable[[Any, Vehicle], Sequence[Any]], vehicle: Vehicle) -> list[Quantile]:
        """The quantile of each output that is constrained separately."""
        return [replace(self, index=one) for one in split(self.index, vehicle)]

    def estimate(self, vehicle: Vehicle, method: Method) -> Estimate:
        """The quantile for a vehicle without free values, with its standard error and interval.

        That of an index over conditions has the quantile in each of them too.
        """
        here, factors = estimate_of(vehicle, self.index, method), self.factors
        if not isinstance(self.index, OverConditions):
            values = evaluate_sample(vehicle, self.index, method, self.scatter, factors)
            return self._estimate_from(values, here, vehicle, method)
        cases = self.index.cases(vehicle)
        table = np.array([evaluate_sample(*case, method, self.scatter, factors) for case in cases])
        each = [self._estimate_from(*one, vehicle, method) for one in zip(table, here.in_conditions, strict=True)]
        over = self._estimate_from(self.index.combine(table), here, vehicle, method)
        return replace(over, in_conditions=tuple(each))

    def _estimate_from(self, values: Array, here: Estimate, vehicle: Vehicle, method: Method) -> Estimate:
        """The quantile of a sample of values about the value `here`."""
        if not (status := sample_status(values)).ok:
            return Estimate(np.nan, self.unit, status)
        value = float(np.sort(values) @ rank_weights(values.size, self.share))
        error, interval = with_scatter_of_values(value, quantile_error(values, self.share), here)
        bound = float(np.maximum(getattr(method, "promise", np.nan), here.error_bound))  # also by a measured road
        sources = (ErrorSource("values of the sample", bound),)
        status = scatter_left_out(vehicle, method, self.scatter)
        return Estimate(value, self.unit, status, error, interval, here.realisations, error_sources=sources)

    def estimate_many(self, vehicle: Vehicle, method: Method, points: Mapping[str, Array]) -> Array:
        """Quantiles (designs,) at many values of the free values, nan where unknown."""
        found = self.as_objective(vehicle, method).values(rows_of(points, vehicle.free_values()))
        return np.where(np.isfinite(found), found, np.nan)

    def as_objective(self, vehicle: Vehicle, method: Method) -> Objective:
        """The quantile as a function of the free values, with its gradient if the index has one.

        Raises `DesignError` for a tolerance of a value that a condition changes.
        """
        if changed := values_changed(self.index) & labels_with_tolerances(vehicle, self.scatter):
            raise DesignError(
                f"A search does not support the tolerance of a value that a condition changes, {sorted(changed)[0]!r}. "
                f"Leave out one of the two."
            )
        loose = with_free_scatter(vehicle, self.scatter)
        inner = objective_of(loose, self.index, method)
        own, after = nominal(vehicle, self.scatter), source_values(vehicle, self.scatter)
        names = tuple(vehicle.free_values()), tuple(loose.free_values())
        plain = _Values(self, inner, *names, tuple(own.items()), tuple(after.items()))
        return _Quantile(plain) if isinstance(inner, Differentiable) else plain


@dataclass(frozen=True, eq=False)
class _Values:
    """The quantile as an `Objective`."""

    of: Quantile
    inner: Any
    names: tuple[str, ...]  # of the free values
    inner_names: tuple[str, ...]  # of the free values and of further values with tolerances
    own: tuple[tuple[str, float], ...]
    after: tuple[tuple[str, str], ...]  # free value about which each label varies

    @cached_property
    def weights(self) -> Array:
        """Weights of the samples in ascending order."""
        return self.of.weights

    @cached_property
    def table(self) -> Array:
        """Factors on the inner values, shape (samples, inner values)."""
        factors = dict(zip(self.of.scatter.names, self.of.factors.T, strict=True))
        return np.column_stack([factors.get(name, np.ones(self.of.samples)) for name in self.inner_names])

    def inner_points(self, point: Array) -> Array:
        """The sample around a point (samples, inner values)."""
        known = dict(self.own) | dict(zip(self.names, point.tolist(), strict=True))
        known |= {name: known[free] for name, free in self.after}
        return np.ascontiguousarray(self.table * np.array([known[name] for name in self.inner_names]))

    @cached_property
    def follows(self) -> Array:
        """Incidence of the free value about which each inner value varies, shape (inner values, names)."""
        after = dict(self.after)
        return np.array([[after.get(inner, inner) == name for name in self.names] for inner in self.inner_names], float)

    def values(self, points: Array) -> Array:
        """The quantile at each row of `points`; infinite where unknown."""
        found = self.inner.values(np.vstack([self.inner_points(point) for point in points]))
        table = np.sort(found.reshape(len(points), -1), axis=1)
        good = np.all(np.isfinite(table), axis=1)
        result = np.full(len(points), np.inf)
        result[good] = table[good] @ self.weights
        return result


@dataclass(frozen=True, eq=False)
class _Quantile(Smooth):
    """The quantile as a `Differentiable`, which is smooth except where two samples change ranks."""

    plain: _Values

    def values(self, points: Array) -> Array:
        """The quantile at each row of `points`; infinite where unknown."""
        return self.plain.values(points)

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The quantile, and the mean of the gradients of the samples by the weights of their ranks."""
        plain = self.plain
        inner = plain.inner_points(point)
        values = plain.inner.values(inner)
        if not np.all(np.isfinite(values)):
            return np.inf, np.zeros(point.size)
        order = np.argsort(values, kind="stable")
        gradient = np.zeros(point.size)
        for rank in np.flatnonzero(plain.weights > _WEIGHT):
            row = order[rank]
            gradient += plain.weights[rank] * (_gradient(plain.inner, inner[row]) * plain.table[row]) @ plain.follows
        return float(values[order] @ plain.weights), gradient


def _gradient(objective: Differentiable, point: Array) -> Array:
    peaks = objective.active(point)
    if peaks is None:
        return objective.value_and_gradient(point)[1]
    values, gradients = objective.components(point, peaks)
    return np.asarray(gradients[int(np.argmax(values))])


def optimise_robust(
    vehicle: Vehicle,
    index: IndexLike,
    method: Method,
    *,
    spread: Mapping[str, float],
    quantile: float = 0.95,
    samples: int = 256,
    subject_to: Sequence[Limit] = (),
    seed: int = 0,
    executor: Executor | None = None,
) -> Optimum:
    """Robust optimisation: minimise a quantile (default: 95 %) of an index under tolerances.

    `spread` is that of `tolerance_analysis`, of element values only, uniformly distributed: free values vary about
    their chosen value, fixed ones about their own, and tied ones, by their labels, about their dependent value. All
    designs of the search use one sample; the value of the optimum, with its interval, is that quantile over an
    independent sample, four times as large. Otherwise as `optimise`, with two starts for each free value. For further
    options use `Quantile`.

    Raises the errors of `optimise` and `tolerance_analysis`.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(it.free(100, 1e5, "c")) - it.Inerter(it.free(1, 2000, "b"))
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25))
    >>> found = it.optimise_robust(car, comfort, it.Norm(), spread={"c": 0.3, "b": 0.3}, samples=32)
    >>> round(found.value, 1)
    2.5
    """
    at = Quantile(index, scatter_of(spread, "uniform"), quantile, samples, seed)
    check_vehicle(vehicle)
    starts = 2 * len(vehicle.free_values()) or None
    found = optimise(vehicle, at, method, subject_to=subject_to, seed=seed, starts=starts, executor=executor)
    if not np.isfinite(found.value):
        return found
    judged = estimate_of(found.design, at.apart, method)
    return replace(found, estimate=replace(judged, status=worst_of((found.status, judged.status))))
