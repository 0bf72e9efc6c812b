"""The unknowns of a fit: free values of the device and of the sensors, and their search coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.identification.hypotheses import Hypothesis
from inerter.networks.elements import Element, Free
from inerter.vehicle.rig import Rig

Matrix = NDArray[np.float64]
WIDER = 3000.0  # times: bounds that are tried where values end at those of their search


@dataclass(frozen=True, eq=False)
class Space:
    """Names, units and bounds of the unknowns, in the order of every vector here.

    Coordinates are logarithms where the lower bound is positive, else the value over its upper bound, so that their
    scales are similar for values of any order of magnitude.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    lower: Matrix
    upper: Matrix
    kinds: tuple[type[Element] | None, ...]  # of the element; None for unknowns of hypotheses

    @property
    def logarithmic(self) -> NDArray[np.bool_]:
        return self.lower > 0.0

    @property
    def nonlinear(self) -> NDArray[np.bool_]:
        """Mask of the unknowns that are frictions and gaps."""
        return np.array([kind is not None and kind.switch is not None for kind in self.kinds])

    @property
    def bounds(self) -> tuple[Matrix, Matrix]:
        """Bounds of the coordinates."""
        return self.to_coordinates(self.lower), self.to_coordinates(self.upper)

    def to_coordinates(self, values: Matrix) -> Matrix:
        log = self.logarithmic
        return np.where(log, np.log(np.where(log, values, 1.0)), values / self.upper)

    def to_values(self, coordinates: Matrix) -> Matrix:
        log = self.logarithmic
        values = np.where(log, np.exp(np.where(log, coordinates, 0.0)), coordinates * self.upper)
        return np.clip(values, self.lower, self.upper)

    def values_by_name(self, coordinates: Matrix) -> dict[str, float]:
        return dict(zip(self.names, map(float, self.to_values(coordinates)), strict=True))

    def coordinates_of(self, values: Mapping[str, float]) -> Matrix:
        """Coordinates of named values, moved within the bounds."""
        array = np.array([values[name] for name in self.names])
        return self.to_coordinates(np.clip(array, self.lower, self.upper))

    def coordinate_of(self, index: int, value: float) -> float:
        """Coordinate of one value, moved within its bounds."""
        value = min(max(value, float(self.lower[index])), float(self.upper[index]))
        return float(np.log(value) if self.lower[index] > 0.0 else value / self.upper[index])

    def slopes(self, coordinates: Matrix) -> Matrix:
        """Derivative of each value by its coordinate."""
        return np.where(self.logarithmic, self.to_values(coordinates), self.upper)


def space_of(rig: Rig, assumed: Sequence[Hypothesis] = ()) -> Space:
    """The free values of a device, then those of the hypotheses that are assumed."""
    elements: dict[str, Element] = {}
    for element in rig.device.elements():
        if isinstance(element.value, Free) and element.value.name is not None:
            elements.setdefault(element.value.name, element)
    rows: list[tuple[str, str, float, float, type[Element] | None]] = []
    for name, free in rig.free_values().items():
        rows.append((name, elements[name].unit, free.lower, free.upper, type(elements[name])))
    for hypothesis in assumed:
        rows += [(u.name, u.unit, u.lower, u.upper, None) for u in hypothesis.unknowns]
    names, units, lower, upper, kinds = zip(*rows, strict=True) if rows else ((), (), (), (), ())
    return Space(tuple(names), tuple(units), np.array(lower), np.array(upper), tuple(kinds))
