"""Comparison of two designs on the same roads, with a smaller standard error than of either value."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, Status, worst_of
from inerter.formatting import format_alike, format_percent_size, typeset
from inerter.methods.averages import interval_of, mean_and_error
from inerter.methods.composite_index import IndexLike, is_composite
from inerter.methods.method import AveragingMethod, Estimate, Method, MethodWithControls, evaluate
from inerter.methods.ties import ACCURACY
from inerter.notebook import shown_by
from inerter.vehicle.vehicle import Vehicle
from inerter.work.running import running_on

_FEWEST = 4  # samples for a regression
Controls = tuple[NDArray[np.float64], NDArray[np.float64]]
Known = tuple[Estimate | None, Estimate | None]


@dataclass(frozen=True)
class Difference:
    """A difference of two estimates with its own standard error; `standard_error` is 0 where nothing scatters."""

    value: float
    unit: str
    standard_error: float
    interval: tuple[float, float]  # of 95 % confidence

    @property
    def reach(self) -> float:
        """Half the width of the interval."""
        return 0.5 * (self.interval[1] - self.interval[0])


@dataclass(frozen=True)
class Comparison:
    """Two designs by one index: `difference` is first less second, so negative where the first is better.

    `relative` is that difference as a part of the second's value [%], whose scatter on the same roads counts too.

    >>> import inerter as it
    >>> softer, plain = (it.QuarterCar(250.0, 35.0, 180e3, it.Spring(k) | it.Damper(1500.0)) for k in (10e3, 20e3))
    >>> two = it.compare(softer, plain, it.RideComfort(it.Road(5e-7, 25.0)), it.Norm())
    >>> two.percent < 0, two.is_tie  # per cent of the second; negative where the first is better
    (True, False)
    """

    _repr_html_ = shown_by("inerter.report.notebook:comparison_html")

    first: Estimate
    second: Estimate
    difference: Difference
    relative: Difference

    @property
    def percent(self) -> float:
        """The difference as a part of the second's value [%]."""
        return self.relative.value

    @property
    def percent_error(self) -> float:
        """Standard error of `percent`."""
        return self.relative.standard_error

    @property
    def is_tie(self) -> bool:
        """Whether the difference is not significant at 95 %, or within the accuracy of the values."""
        low, high = self.difference.interval
        accuracy = 2.0 * ACCURACY * min(abs(self.first.value), abs(self.second.value))
        return low - accuracy <= 0.0 <= high + accuracy

    @property
    def status(self) -> Status:
        """Worse of the statuses of both estimates."""
        return worst_of((self.first.status, self.second.status))

    def __str__(self) -> str:
        doubt = "" if self.status.ok else f"not certain ({self.status}): "
        if not np.isfinite(self.percent):
            values = " and ".join(format_alike([self.first.value, self.second.value], self.first.unit))
            return f"{doubt}{values}: the difference is not defined"
        apart = typeset(format_percent_size(abs(self.percent), self.percent_error))
        if self.is_tie:
            return f"{doubt}difference not significant at 95 %: {apart}"
        word = "better" if self.difference.value < 0.0 else "worse"
        return f"{doubt}the first is {apart} {word} than the second"


def compare(
    first: Vehicle,
    second: Vehicle,
    index: IndexLike,
    method: Method,
    *,
    known: Known = (None, None),
    executor: Executor | None = None,
) -> Comparison:
    """Two designs by one index and one method, with the standard error of their difference.

    A method that averages drives both over the same roads, as many and as long for both, and the difference is averaged
    road by road: what the roads do to both alike cancels. What friction does to first order, which is quickly
    computed, is averaged over many more roads by `ExpectedValue`, and only the rest over these (a control variate).
    Standard errors of numbers without samples add up as independent ones. `known` are the estimates of the two
    by this very method, as far as they are there already. An `executor` shares the roads, as that of `evaluate` does.

    Raises what `evaluate` raises.

    >>> import inerter as it
    >>> k, c, b = it.Spring(120e3), it.Damper(7544.2), it.Inerter(366.52)
    >>> one, other = (
    ...     it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    ...     for strut in (k | c - (b | it.Friction(10.0)), k | c - (b | it.Friction(20.0)))
    ... )
    >>> comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25))
    >>> two = it.compare(one, other, comfort, it.ExpectedValue())
    >>> round(two.percent, 1), two.percent_error < 0.02
    (-0.3, True)
    """
    one, other = known if isinstance(known, Sequence) and len(known) == 2 else (known, known)
    if not isinstance(one, Estimate | None) or not isinstance(other, Estimate | None):
        raise DesignError(f"`known` must be two estimates, or None in place of either, got {known!r}.")
    with running_on(executor):
        return _compare(first, second, index, method, (one, other))


def _compare(first: Vehicle, second: Vehicle, index: IndexLike, method: Method, known: Known) -> Comparison:
    one, other, method = _on_common_roads(first, second, index, method, known)
    most = max(one.realisations, other.realisations)
    return compare_estimates(one, other, [controls_of(design, index, method, most) for design in (first, second)])


def compare_samples(first: Vehicle, second: Vehicle, index: IndexLike, method: Method, known: Known) -> Comparison:
    """The comparison of `compare` by its samples alone, without what friction does to first order on further roads."""
    one, other, _ = _on_common_roads(first, second, index, method, known)
    return compare_estimates(one, other)


def _on_common_roads(
    first: Vehicle, second: Vehicle, index: IndexLike, method: Method, known: Known
) -> tuple[Estimate, Estimate, Method]:
    """The estimates of both designs on as many and as long roads, and the method with these."""
    designs = first, second
    one, other = (found or evaluate(design, index, method) for found, design in zip(known, designs, strict=True))
    most, longest = max(one.realisations, other.realisations), max(one.period or 0, other.period or 0) or None
    if most > 0 and isinstance(method, AveragingMethod):
        method = method.with_realisations(most, longest)
        one, other = (
            found
            if found.realisations in (0, most) and found.period in (None, longest)
            else evaluate(design, index, method)
            for found, design in ((one, first), (other, second))
        )
    return one, other, method


def controls_of(design: Vehicle, index: IndexLike, method: Method, count: int) -> Controls | None:
    """Control variates of the first `count` samples of an index, and of many more; None if there are none."""
    if count == 0 or not isinstance(method, MethodWithControls) or is_composite(index):
        return None
    return method.controls(design, index, count)


def compare_estimates(one: Estimate, other: Estimate, controls: Sequence[Controls | None] = ()) -> Comparison:
    """Comparison of two estimates, with the `controls` of `difference_of`."""
    return Comparison(one, other, difference_of(one, other, controls), _relative_difference(one, other, controls))


def _relative_difference(one: Estimate, other: Estimate, controls: Sequence[Controls | None]) -> Difference:
    """Difference as a part of the second's value [%]; its error is that of the ratio of the values, to first order.

    That is the error of the first less the ratio times the second, whose difference is zero.
    """
    ratio = one.value / other.value if other.value else np.nan
    if not np.isfinite(ratio):
        return Difference(np.nan, "%", np.nan, (np.nan, np.nan))
    scaled = replace(
        other,
        value=one.value,
        standard_error=abs(ratio) * (other.standard_error or 0.0),
        samples=tuple(ratio * sample for sample in other.samples),
    )
    scaled_controls = [
        known and (factor * known[0], factor * known[1]) for factor, known in zip((1.0, ratio), controls, strict=False)
    ]
    found, per_cent = difference_of(one, scaled, scaled_controls), 100.0 / other.value
    value = 100.0 * (ratio - 1.0) + per_cent * found.value
    low, high = (value + abs(per_cent) * (end - found.value) for end in found.interval)
    return Difference(value, "%", abs(per_cent) * found.standard_error, (low, high))


def difference_of(one: Estimate, other: Estimate, controls: Sequence[Controls | None] = ()) -> Difference:
    """The difference of two estimates, sample by sample where both have the same samples.

    `controls` hold for each design what is known of the same samples (samples,), and of many more (many,). From four
    samples on, and if the many are more, the difference is regressed on theirs, and is that at their mean over the
    many: exact for normal values, with two degrees of freedom less than samples (Lavenberg and Welch 1981).
    """
    samples = _samples(one, other), _samples(other, one)
    count = samples[0].size
    if not count == samples[1].size > 1:
        value = one.value - other.value
        error = hypot(one.standard_error or 0.0, other.standard_error or 0.0)
        return Difference(value, one.unit, error, interval_of(value, error, max(count, samples[1].size)))
    differences = samples[0] - samples[1]
    mean, error, _ = mean_and_error(differences)
    value = one.value - other.value  # which may be roots of mean squares
    interval = interval_of(value, error, count)
    if count < _FEWEST or len(controls) != 2 or controls[0] is None or controls[1] is None:
        return Difference(value, one.unit, error, interval)
    here, more = (a - b for a, b in zip(*controls, strict=True))
    if more.size <= count:
        return Difference(value, one.unit, error, interval)
    centred, shift = here - here.mean(), float(more.mean() - here.mean())
    spread = float(centred @ centred)
    if spread == 0.0:
        return Difference(value, one.unit, error, interval)
    slope = float(centred @ differences) / spread
    rest = differences - mean - slope * centred
    variance = float(rest @ rest) / (count - 2) * (1.0 / count + shift**2 / spread)
    error = float(np.sqrt(variance + slope**2 * np.var(more, ddof=1) / more.size))
    value += slope * shift
    return Difference(value, one.unit, error, interval_of(value, error, count - 1))


def _samples(estimate: Estimate, other: Estimate) -> NDArray[np.float64]:
    """The samples of an estimate; of a linear design, whose value does not scatter, as many of that as of the other."""
    if not estimate.samples and estimate.standard_error == 0.0:
        return np.full(len(other.samples), estimate.value)
    return np.array(estimate.samples)
