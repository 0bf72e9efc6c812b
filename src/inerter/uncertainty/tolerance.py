"""`tolerance_analysis`: distribution of an index under tolerances, and its Sobol' sensitivity indices."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.deprecation import RenamedAttribute
from inerter.errors import OK, DesignError, Status, StatusKind, worst_of
from inerter.formatting import format_percent_size
from inerter.methods.averages import CONFIDENCE, NORMAL_QUANTILE
from inerter.methods.composite_index import IndexLike, estimate_of
from inerter.methods.conditions import OverConditions
from inerter.methods.error_bounds import size_of_effects
from inerter.methods.method import Estimate, Method, MethodWithExactFallback, constituents_of, evaluate, evaluate_many
from inerter.notebook import shown_by
from inerter.uncertainty.distributions import (
    Scatter,
    check_sample,
    elements_scatter,
    neglected_scatter,
    nominal,
    scatter_left_out,
    scatter_of,
    with_free_scatter,
)
from inerter.validation import checked, is_number
from inerter.vehicle.replace_values import replace_values
from inerter.vehicle.vehicle import Vehicle
from inerter.work.blas_threads import one_blas_thread
from inerter.work.running import map_items, running_on

Array = NDArray[np.float64]
SAMPLES = 4096  # of the two samples of a sensitivity analysis each
_MOST_CORNERS = 10  # values with tolerances up to which all extremes are combined
_TRIED, _FEW = 64, 256  # designs tested before the sample, and size of the sample where each takes long
_TRIED_ALONE = 16  # designs tested where each is a separate mechanism
_ROUNDING = 2e-9  # relative range of values that are equal, as of two exact norms


@dataclass(frozen=True, eq=False)
class Tolerance:
    """Distribution of an index under tolerances of a design.

    `first_order` and `total_order` are the Sobol' indices of each value (estimates without error bound, which may
    slightly exceed the range 0 to 1), nan for values that the method neglects. `worst` is the largest value found, at
    the `worst_values`, in the sample and at the corners of the tolerances. All are nan, with a status, where the index
    has no value for some of the sample, or where the method neglects all values with tolerances. The status is
    "inaccurate" too where values may be off by more than they scatter.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(2600.0))
    >>> comfort = it.RideComfort(it.Road(5e-7, 25.0))
    >>> found = it.tolerance_analysis(car, comfort, it.Norm(), spread={"k": 0.05}, samples=16)
    >>> found.quantile(0.5) <= found.quantile(0.95) <= found.worst, found.unit
    (True, 'm/s^2')
    """

    _repr_html_ = shown_by("inerter.report.notebook:tolerance_html")

    nominal: Estimate
    mean: float
    standard_deviation: float
    worst: float
    worst_values: dict[str, float]
    first_order: dict[str, float]
    total_order: dict[str, float]
    values: Array = field(repr=False)  # of the index over the sample
    scatter: Scatter
    seed: int
    status: Status
    main, total = RenamedAttribute("first_order"), RenamedAttribute("total_order")

    @property
    def unit(self) -> str:
        """Unit of the index."""
        return self.nominal.unit

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard errors of `mean` and `standard_deviation`, by the sample and by scatter of its values.

        By the second and fourth moments, as of random points, which is conservative for a Sobol' sequence.
        """
        values, scatter = self.values, self.standard_deviation
        kurtosis = np.mean((values - self.mean) ** 4) / scatter**4 if scatter else 1.0
        of_mean, of_scatter = (scatter * np.sqrt(part / values.size) for part in (1.0, max(kurtosis - 1.0, 0.0) / 4.0))
        relative = (self.nominal.standard_error or 0.0) / self.nominal.value if self.nominal.value else 0.0
        return {
            "mean": float(np.hypot(of_mean, relative * self.mean)),
            "standard_deviation": float(np.hypot(of_scatter, relative * scatter)),
        }

    def quantile(self, share: float) -> float:
        """Quantile of the index at this probability.

        Raises `DesignError` unless the probability is between 0 and 1.
        """
        if not is_number(share) or not 0.0 <= share <= 1.0:
            raise DesignError(f"The probability of a quantile must be between 0 and 1, got {share!r}.")
        return float(np.quantile(self.values, share))

    def quantile_estimate(self, share: float) -> Estimate:
        """Quantile with its standard error and 95 % confidence interval, by the sample and by scatter of its values.

        Raises `DesignError` unless the share is between 0 and 1.
        """
        value = self.quantile(share)
        if not np.isfinite(value):
            return Estimate(value, self.unit, self.status)
        error, interval = with_scatter_of_values(value, quantile_error(self.values, share), self.nominal)
        return Estimate(value, self.unit, self.status, error, interval, self.nominal.realisations)


@checked(DesignError)
def tolerance_analysis(
    design: Vehicle,
    index: IndexLike,
    method: Method,
    *,
    spread: Mapping[str, float],
    samples: int = SAMPLES,
    seed: int = 0,
    distribution: str = "uniform",
    executor: Executor | None = None,
) -> Tolerance:
    """Tolerance analysis: distribution of an index under tolerances of the values of a design.

    `spread` gives the relative tolerance (half-width) of values by name (elements by label, quantities of the vehicle,
    coordinates of a mechanism): {"c": 0.1} is 10 %. Under the `distribution` "uniform" values are uniformly
    distributed; under "normal" the standard deviation is a third of the tolerance, at which it is truncated. A tied
    value has a separate tolerance under its own label. `samples`, a power of two, are points of a scrambled Sobol'
    sequence; the index is evaluated at 2 + n times as many, for n values with tolerances. Element values use compiled
    code where the method has some, other quantities are evaluated one by one, on the `executor` if there is one.

    Raises `DesignError` for an unknown name, a tolerance that is not between 0 and 1, and samples that are not a power
    of two; and the errors of `evaluate`. Where most of the designs require extended precision, at most 256 samples are
    used, and the status is "inaccurate".

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(7544.2) - it.Inerter(366.52)
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25))
    >>> found = it.tolerance_analysis(car, comfort, it.Norm(), spread={"c": 0.1, "b": 0.05, "k": 0.05}, samples=256)
    >>> round(found.mean, 3), round(found.quantile(0.95), 3), max(found.total_order, key=found.total_order.get)
    (2.431, 2.471, 'k')
    """
    scatter = scatter_of(spread, distribution)
    check_sample(samples, seed)
    with one_blas_thread(), running_on(executor):
        here = evaluate(design, index, method)
        fewer = _affordable(design, index, method, scatter, int(samples), int(seed))
        found = _analyse(design, index, method, scatter, fewer, int(seed), here)
        if fewer == samples or not found.status.ok:
            return found
        reason = f"only {fewer} of {samples} designs of the sample evaluated: most require more than double precision"
        return replace(found, status=Status(StatusKind.INACCURATE, reason))


def _affordable(design: Vehicle, index: IndexLike, method: Method, scatter: Scatter, samples: int, seed: int) -> int:
    """Number of samples to use: few where most designs require extended precision.

    For a composite index, such as one over conditions, this applies to each part.
    """
    if samples <= _FEW or not isinstance(method, MethodWithExactFallback):
        return samples
    unit = scipy.stats.qmc.Sobol(len(scatter.names), rng=np.random.default_rng(seed)).random(_TRIED)
    own = nominal(design, scatter)
    table = scatter.factors(unit) * np.array(list(own.values()))
    if elements_scatter(design, scatter):
        tried = [(with_free_scatter(design, scatter), dict(zip(own, table.T, strict=True)))]
    else:
        rows = [dict(zip(own, row, strict=True)) for row in table[:: _TRIED // _TRIED_ALONE].tolist()]
        tried = [(replace_values(design, row), {}) for row in rows]
    unsure = [
        method.share_unsure(vehicle, one, points)
        for whole, points in tried
        for vehicle, one in constituents_of(whole, index)
    ]
    return _FEW if sum(unsure) > 0.5 * len(tried) else samples


def _analyse(
    design: Vehicle, index: IndexLike, method: Method, scatter: Scatter, samples: int, seed: int, here: Estimate
) -> Tolerance:
    count = len(scatter.names)
    unit = scipy.stats.qmc.Sobol(2 * count, rng=np.random.default_rng(seed)).random(samples)
    a, b = scatter.factors(unit[:, :count]), scatter.factors(unit[:, count:])
    crossed = []
    for i in range(count):
        mixed = a.copy()
        mixed[:, i] = b[:, i]
        crossed.append(mixed)
    corners = scatter.corners() if count <= _MOST_CORNERS else np.zeros((0, count))
    values = evaluate_sample(design, index, method, scatter, np.vstack([a, b, *crossed, corners]))
    both, mixed_values = values[: 2 * samples], values[2 * samples : (2 + count) * samples].reshape(count, samples)
    extreme, factors = np.append(both, values[(2 + count) * samples :]), np.vstack([a, b, corners])
    sampled = sample_status(values)
    status, known = here.status, sampled.ok
    if not known and (status.ok or np.isfinite(here.value)):
        status = sampled
    names = scatter.names
    same = np.all(mixed_values == both[:samples], axis=1)
    idle = [name for name, is_same in zip(names, same.tolist(), strict=True) if is_same]
    status, unseen = (
        worst_of((status, scatter_left_out(design, method, scatter, idle))),
        neglected_scatter(design, method, scatter, idle),
    )
    known = known and len(unseen) < count  # nothing is known of a scatter that the method neglects
    if known:
        status = worst_of((status, _scatter_within_errors(both, here)))
    else:
        both = np.full(both.shape, np.nan)
    first, total = _effects(both, mixed_values) if known else (np.full(count, np.nan),) * 2
    effects = [(np.nan,) * 2 if n in unseen else (f, t) for n, f, t in zip(names, first, total, strict=True)]
    top = int(np.argmax(extreme)) if known else 0
    own = nominal(design, scatter)
    return Tolerance(
        nominal=here,
        mean=float(both.mean()),
        standard_deviation=float(both.std(ddof=1)),
        worst=float(extreme[top]) if known else np.nan,
        worst_values={n: own[n] * f if known else np.nan for n, f in zip(names, factors[top].tolist(), strict=True)},
        first_order={name: float(one) for name, (one, _) in zip(names, effects, strict=True)},
        total_order={name: float(one) for name, (_, one) in zip(names, effects, strict=True)},
        values=both,
        scatter=scatter,
        seed=seed,
        status=status,
    )


def _scatter_within_errors(values: Array, nominal: Estimate) -> Status:
    """Status of a scatter that errors of the values may cause: inaccurate if they are larger.

    Errors of a road apart, which all values share: |std(v (1 + e)) - std(v)| <= max |e v|.
    """
    mean, scatter = abs(float(values.mean())), float(values.std())
    bound = nominal.error_bound - size_of_effects(nominal.shared_errors)
    if not bound * mean > max(scatter, _ROUNDING * mean):
        return OK
    message = (
        f"values may be off by {format_percent_size(100.0 * bound)}, more than they scatter: the standard deviation"
    )
    return Status(StatusKind.INACCURATE, f"{message} and what causes it are uncertain")


def rank_weights(count: int, share: float) -> Array:
    """Weights of `count` values in ascending order whose mean is a quantile (Harrell and Davis 1982)."""
    a, b = (count + 1) * share, (count + 1) * (1.0 - share)
    return np.asarray(np.diff(scipy.special.betainc(a, b, np.arange(count + 1) / count)))


def quantile_error(values: Array, share: float) -> tuple[float, tuple[float, float]]:
    """The standard error of a quantile of a sample, and its 95 % confidence interval.

    By order statistics, whose ranks have a binomial distribution whatever that of the values (David and Nagaraja
    2003, 7.1); the standard error is half of the interval over the normal quantile. Points of a Sobol' sequence scatter
    less than random ones, so that both are conservative.
    """
    ordered, count = np.sort(values), values.size
    low, high = (scipy.stats.binom.ppf(p, count, share) for p in (0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE))
    interval = float(ordered[max(int(low) - 1, 0)]), float(ordered[min(int(high), count - 1)])
    return (interval[1] - interval[0]) / (2.0 * NORMAL_QUANTILE), interval


def with_scatter_of_values(
    value: float, of_sample: tuple[float, tuple[float, float]], nominal: Estimate
) -> tuple[float, tuple[float, float]]:
    """Standard error and interval of a quantile, with those of the values themselves added as squares.

    All values of a sample have the same random inputs, such as roads, so that they are off together: by the part by
    which the one without scatter, `nominal`, is.
    """
    if not nominal.standard_error or nominal.interval is None:
        return of_sample
    error, (low, high) = of_sample
    scale, (below, above) = value / nominal.value, nominal.interval
    return float(np.hypot(error, scale * nominal.standard_error)), (
        value - float(np.hypot(value - low, scale * (nominal.value - below))),
        value + float(np.hypot(high - value, scale * (above - nominal.value))),
    )


def _effects(both: Array, mixed: Array) -> tuple[Array, Array]:
    """First-order and total-order Sobol' indices; 0 where nothing varies but by rounding."""
    samples, varies = mixed.shape[1], bool(np.ptp(both) > _ROUNDING * np.abs(both).max())
    if len(mixed) == 1 or not varies:
        share = np.full(len(mixed), float(varies))
        return share, share
    tables = {"f_A": both[None, :samples], "f_B": both[None, samples:], "f_AB": mixed[:, None, :]}
    indices: Any = scipy.stats.sobol_indices  # the stubs do not know this form of tables
    found = indices(func=tables, n=samples)
    return np.ravel(found.first_order), np.ravel(found.total_order)


def evaluate_sample(design: Vehicle, index: IndexLike, method: Method, scatter: Scatter, factors: Array) -> Array:
    """The index at the values of a design times these factors; nan where it has no value.

    A value that a condition changes is there that of the condition times the factor.
    """
    if isinstance(index, OverConditions):
        cases = index.cases(design)
        return index.combine(np.array([evaluate_sample(*case, method, scatter, factors) for case in cases]))
    own = nominal(design, scatter)
    table = factors * np.array(list(own.values()))
    if elements_scatter(design, scatter):
        points = dict(zip(own, table.T, strict=True))
        return evaluate_many(with_free_scatter(design, scatter), index, points, method)[:, 0]
    rows = [dict(zip(own, row, strict=True)) for row in table.tolist()]
    return np.array(map_items(partial(_value, design, index, method), rows))


def sample_status(values: Array) -> Status:
    """Status of what needs all values of a sample: failed where one of them is not finite."""
    lost = int(np.sum(~np.isfinite(values)))
    message = f"{lost} of {values.size} designs of the sample have no reliable value"
    return Status(StatusKind.FAILED, message) if lost else OK


def _value(design: Vehicle, index: IndexLike, method: Method, values: Mapping[str, float]) -> float:
    found = estimate_of(replace_values(design, values), index, method)
    return found.value if found.status.ok else np.nan
