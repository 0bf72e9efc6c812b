"""Values that scatter: which of a vehicle's, how far, and by what distribution."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.checks import is_number
from inerter.errors import OK, DesignError, Status, StatusKind
from inerter.methods.method import Method, Sees
from inerter.networks.elements import Element, Free, Tied
from inerter.vehicle.replace_values import (
    elements_by_label,
    masses,
    quantities,
    replace_values,
    to_editable,
    with_elements,
)
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
DISTRIBUTIONS = ("uniform", "normal")
_DEVIATIONS = 3.0  # of a normal distribution, at which it is cut off


@dataclass(frozen=True)
class Scatter:
    """By what part values lie above or below their own at the most, by their names.

    Under "uniform" all values between are equally likely; under "normal" the standard deviation is a third of the
    spread, where the distribution is cut off. All scatter by themselves; elements of one label together. It is parts
    that scatter as they are made: what is tied to a value follows that in the design, not in its scatter, and has a
    scatter of its own under its own label.

    Raises `DesignError` for a spread that is not between 0 and 1, or another distribution.
    """

    spread: tuple[tuple[str, float], ...]
    distribution: str = "uniform"

    def __post_init__(self) -> None:
        if not self.spread:
            raise DesignError("A tolerance needs a spread, such as spread={'c': 0.1} for a damping within 10 %.")
        for name, part in self.spread:
            if not is_number(part) or not 0.0 < part < 1.0:
                raise DesignError(f"The spread of {name!r} is a part of its value between 0 and 1, got {part!r}.")
        if self.distribution not in DISTRIBUTIONS:
            known = " or ".join(repr(one) for one in DISTRIBUTIONS)
            raise DesignError(f"The distribution of a tolerance is {known}, got {self.distribution!r}.")

    @property
    def names(self) -> tuple[str, ...]:
        """What scatters."""
        return tuple(name for name, _ in self.spread)

    def factors(self, unit: Array) -> Array:
        """Factors (n, names) of the values, from numbers that are evenly spread between 0 and 1."""
        parts = np.array([part for _, part in self.spread])
        if self.distribution == "uniform":
            return 1.0 + parts * (2.0 * unit - 1.0)
        inside = scipy.stats.truncnorm(-_DEVIATIONS, _DEVIATIONS).ppf(unit)
        return np.asarray(1.0 + parts / _DEVIATIONS * inside)

    def corners(self) -> Array:
        """All combinations of the extreme factors."""
        ends = [(1.0 - part, 1.0 + part) for _, part in self.spread]
        return np.array(np.meshgrid(*ends, indexing="ij")).reshape(len(ends), -1).T


def scatter_of(spread: object, distribution: str) -> Scatter:
    """The scatter; raises `DesignError` for what is none."""
    if not isinstance(spread, Mapping) or not all(isinstance(name, str) for name in spread):
        raise DesignError(f"The spread maps names to parts of values, such as {{'c': 0.1}}, got {spread!r}.")
    return Scatter(tuple(spread.items()), distribution)


def elements_scatter(vehicle: Vehicle, scatter: Scatter) -> bool:
    """Whether all that scatters is values of elements; raises `DesignError` for a name that stands for nothing."""
    nominal(vehicle, scatter)
    return all(name in vehicle.free_values() or _is_of_elements(vehicle, name) for name in scatter.names)


def _is_of_elements(vehicle: Vehicle, name: str) -> bool:
    return name not in quantities(vehicle) and bool(elements_by_label(vehicle, name))


def nominal(vehicle: Vehicle, scatter: Scatter) -> dict[str, float]:
    """What scatters, with its value; nan where that is free. Raises `DesignError` for a name without a value."""
    found = {}
    for name in scatter.names:
        value = _value(vehicle, name)
        if value == 0.0:
            raise DesignError(f"{name!r} is 0, and cannot scatter by a part of itself.")
        found[name] = value
    return found


def _value(vehicle: Vehicle, name: str) -> float:
    if name in vehicle.free_values():
        return np.nan
    if name in quantities(vehicle):
        return _number(name, quantities(vehicle)[name])
    chosen = elements_by_label(vehicle, name)
    if chosen:
        value = chosen[0].value
        if any(element.value != value for element in chosen):
            several = " and ".join(dict.fromkeys(str(element) for element in chosen))
            raise DesignError(f"{name!r} stands for {several}, which cannot scatter as one. Give them different names.")
        return np.nan if isinstance(value, Free | Tied) else value
    if name in masses(vehicle):
        return _number(name, masses(vehicle)[name])
    replace_values(vehicle, {name: 1.0})  # which says what there is
    raise AssertionError("unreachable")


def _number(name: str, value: float | Free) -> float:
    if isinstance(value, Free):
        raise DesignError(f"{name!r} is free by the name of {value.name!r}; name that.")
    return value


def scatter_left_out(vehicle: Vehicle, method: Method, scatter: Scatter, idle: Collection[str] = ()) -> Status:
    """Whether a method sees all that scatters: what linear analysis leaves out would seem not to matter.

    `idle` names values that turned out to have no effect: with friction left out, what carries no force then has none.
    """
    if method.sees is not Sees.NEITHER:
        return OK
    elements = [element for strut in vehicle.mechanism().struts for element in strut.network.elements()]
    switching = {element.label for element in elements if element.acts}
    unseen = [name for name in scatter.names if name in switching or (switching and name in idle)]
    if not unseen:
        return OK
    return Status(
        StatusKind.INACCURATE,
        "linear analysis leaves friction out and closes gaps, and so does not see the scatter of "
        f"{' and '.join(unseen)}, which seems not to matter; take a method that simulates",
    )


def loosened(vehicle: Vehicle, scatter: Scatter) -> Vehicle:
    """The vehicle with a free value of its own, by its name, in the place of all that scatters."""
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


def followed(vehicle: Vehicle, scatter: Scatter) -> dict[str, str]:
    """The free value that each label has its value from, of those labels that scatter and are no free value."""
    vehicle, found = to_editable(vehicle), {}
    for name in set(scatter.names) - set(vehicle.free_values()):
        for element in elements_by_label(vehicle, name):
            if isinstance(element.value, Free):
                found[name] = str(element.value.name)
    return found
