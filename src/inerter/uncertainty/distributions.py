"""Tolerances of the values of a vehicle: names, half-widths, and distribution."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import OK, DesignError, Status, StatusKind
from inerter.methods.method import Method, NonlinearitySupport
from inerter.methods.registry import simulating_method
from inerter.networks.elements import Element, Free, Tied
from inerter.validation import check_share, check_whole, is_whole
from inerter.vehicle.replace_values import (
    check_one_meaning,
    elements_by_label,
    masses,
    mounted_elements,
    quantities,
    replace_values,
    to_editable,
    with_elements,
)
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
DISTRIBUTIONS = ("uniform", "normal")
_DEVIATIONS = 3.0  # standard deviations at which a normal distribution is truncated
_FEWEST = 16  # points of a sample


@dataclass(frozen=True)
class Scatter:
    """Relative tolerances (half-widths) of values, by name.

    Values are uniformly distributed under "uniform"; under "normal" the standard deviation is a third of the tolerance,
    at which the distribution is truncated. All values are independent; elements of one label vary together. A tied
    value follows another one in the design but not in its tolerance: it has a separate tolerance under its own label.

    Raises `DesignError` for a tolerance that is not between 0 and 1, or an unknown distribution.
    """

    spread: tuple[tuple[str, float], ...]
    distribution: str = "uniform"

    def __post_init__(self) -> None:
        if not self.spread:
            raise DesignError("spread is required, such as spread={'c': 0.1} for a damping within 10 %.")
        for name, part in self.spread:
            check_share(DesignError, f"The relative tolerance of {name!r}", part)
        if self.distribution not in DISTRIBUTIONS:
            known = " or ".join(repr(one) for one in DISTRIBUTIONS)
            raise DesignError(f"The distribution of a tolerance must be {known}, got {self.distribution!r}.")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the values with tolerances."""
        return tuple(name for name, _ in self.spread)

    def factors(self, unit: Array) -> Array:
        """Factors (n, names) on the values, from quasi-random numbers between 0 and 1."""
        parts = np.array([part for _, part in self.spread])
        if self.distribution == "uniform":
            return 1.0 + parts * (2.0 * unit - 1.0)
        inside = scipy.stats.truncnorm(-_DEVIATIONS, _DEVIATIONS).ppf(unit)
        return np.asarray(1.0 + parts / _DEVIATIONS * inside)

    def corners(self) -> Array:
        """All combinations of the extreme factors."""
        ends = [(1.0 - part, 1.0 + part) for _, part in self.spread]
        return np.array(np.meshgrid(*ends, indexing="ij")).reshape(len(ends), -1).T


def check_sample(samples: object, seed: object) -> None:
    """Raise `DesignError` unless a quasi-random sample has a power of two points, and a valid seed."""
    if not is_whole(samples, _FEWEST) or samples & (samples - 1):
        raise DesignError(f"The number of samples must be a power of two of at least {_FEWEST}, got {samples!r}.")
    check_whole(DesignError, "The seed", seed)


def scatter_of(spread: object, distribution: str) -> Scatter:
    """Tolerances from a table; raises `DesignError` for an invalid one."""
    if not isinstance(spread, Mapping) or not all(isinstance(name, str) for name in spread):
        raise DesignError(f"spread must map names to relative tolerances, such as {{'c': 0.1}}, got {spread!r}.")
    return Scatter(tuple(spread.items()), distribution)


def elements_scatter(vehicle: Vehicle, scatter: Scatter) -> bool:
    """Whether all tolerances are of element values; raises `DesignError` for an unknown name."""
    nominal(vehicle, scatter)
    return all(name in vehicle.free_values() or _is_of_elements(vehicle, name) for name in scatter.names)


def _is_of_elements(vehicle: Vehicle, name: str) -> bool:
    return name not in quantities(vehicle) and bool(elements_by_label(vehicle, name))


def nominal(vehicle: Vehicle, scatter: Scatter) -> dict[str, float]:
    """Nominal values with tolerances, by name; nan where free. Raises `DesignError` for a name without a value."""
    found = {}
    for name in scatter.names:
        value = _value(vehicle, name)
        if value == 0.0:
            raise DesignError(f"{name!r} is 0, so it cannot have a relative tolerance.")
        found[name] = value
    return found


def _value(vehicle: Vehicle, name: str) -> float:
    if name in vehicle.free_values():
        return np.nan
    check_one_meaning(to_editable(vehicle), name)
    if name in quantities(vehicle):
        return _number(name, quantities(vehicle)[name])
    chosen = elements_by_label(vehicle, name)
    if chosen:
        value = chosen[0].value
        if any(element.value != value for element in chosen):
            several = " and ".join(dict.fromkeys(str(element) for element in chosen))
            raise DesignError(f"{name!r} is ambiguous: {several}. Give them different names.")
        return np.nan if isinstance(value, Free | Tied) else value
    if name in masses(vehicle):
        return _number(name, masses(vehicle)[name])
    replace_values(vehicle, {name: 1.0})  # which raises with the available names
    raise AssertionError("unreachable")


def _number(name: str, value: float | Free) -> float:
    if isinstance(value, Free):
        raise DesignError(f"{name!r} is free under the name {value.name!r}. Use that name.")
    return value


def neglected_scatter(vehicle: Vehicle, method: Method, scatter: Scatter, idle: Collection[str]) -> list[str]:
    """Names of values with tolerances that the method neglects, as linear analysis does.

    `idle` names values without effect: with friction neglected, elements without force have none.
    """
    if method.nonlinearity_support is not NonlinearitySupport.NEITHER:
        return []
    switching = {element.label for element in vehicle.mechanism().strut_elements() if element.acts}
    return [name for name in scatter.names if name in switching or (switching and name in idle)]


def scatter_left_out(vehicle: Vehicle, method: Method, scatter: Scatter, idle: Collection[str] = ()) -> Status:
    """Status of a method that neglects elements with tolerances: `inaccurate`, or `failed` if it neglects all."""
    unseen = neglected_scatter(vehicle, method, scatter, idle)
    if not unseen:
        return OK
    return Status(
        StatusKind.FAILED if len(unseen) == len(scatter.names) else StatusKind.INACCURATE,
        "the linear model neglects friction and treats gaps as closed, and so ignores the tolerance of "
        f"{' and '.join(unseen)}; use a method that models them, such as {simulating_method()}",
    )


def with_free_scatter(vehicle: Vehicle, scatter: Scatter) -> Vehicle:
    """The vehicle with separate free values for all elements with tolerances, by label."""
    parts = dict(scatter.spread)
    vehicle, free = to_editable(vehicle), vehicle.free_values()
    chosen = {id(element) for name in parts if name not in free for element in elements_by_label(vehicle, name)}

    def loose(element: Element) -> Element:
        value, name = element.value, element.label
        if id(element) not in chosen or isinstance(value, Tied):
            return element
        lower, upper = (value.lower, value.upper) if isinstance(value, Free) else (value, value)
        return element.with_value(Free((1.0 - parts[name]) * lower, (1.0 + parts[name]) * upper, name))

    return with_elements(vehicle, loose)


def source_values(vehicle: Vehicle, scatter: Scatter) -> dict[str, str]:
    """Free value by label, for labels with tolerances that are not names of free values."""
    vehicle, found = to_editable(vehicle), {}
    for name in set(scatter.names) - set(vehicle.free_values()):
        for element in elements_by_label(vehicle, name):
            if isinstance(element.value, Free):
                found[name] = str(element.value.name)
    return found


def labels_with_tolerances(vehicle: Vehicle, scatter: Scatter) -> set[str]:
    """Labels of the elements with tolerances, which are named by their labels or by their free values."""
    elements = (element for part in mounted_elements(to_editable(vehicle)) for element in part)
    known = {e.label: e.value.name if isinstance(e.value, Free) else None for e in elements}
    return {label for label, free in known.items() if {label, free}.intersection(scatter.names)}
