"""Indices of the motion and the force of one element."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar

from inerter.deprecation import RenamedAttribute
from inerter.field_metadata import choice_field
from inerter.indices.definition import IndexDefinition, on_road
from inerter.indices.excitation import Excitation
from inerter.signals.road import Road
from inerter.systems.outputs import check_element, force_of, stroke_of, velocity_of
from inerter.vehicle.mechanism import Mechanism, OutputWeight


@dataclass(frozen=True)
class _OfElement(ABC):
    """R.m.s. value on a road of the output of an element that `_output` names."""

    road: Road | Excitation
    element: str = field(metadata=choice_field((), "Name of the element.", example="c", of_element=True))
    symbol: ClassVar[str]
    title: ClassVar[str]
    unit: ClassVar[str]
    response: ClassVar[str]

    question = RenamedAttribute("definition")

    @staticmethod
    @abstractmethod
    def _output(label: str) -> str:
        """Name of the output of the element of this name."""

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no road or no such element."""
        check_element(mechanism, self.element, self._output)
        return on_road(self, mechanism, (OutputWeight(self._output(self.element)),), "element")


@dataclass(frozen=True)
class ElementForce(_OfElement):
    """R.m.s. force of an element on a road [N]; `element` is its name, or its label where it has none.

    Raises `PerformanceIndexError`, where it is used, if there is no such element.

    >>> import inerter as it
    >>> car, road = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3, "coil") | it.Damper(1500.0)), it.Road(5e-7, 25.0)
    >>> force = it.evaluate(car, it.ElementForce(road, "coil"), it.Norm()).value  # N
    >>> stroke = it.evaluate(car, it.ElementStroke(road, "coil"), it.Norm()).value  # m
    >>> round(force / stroke)
    20000
    """

    symbol = "element-force"
    title = "force of an element"
    quantity = "r.m.s. force of an element"
    unit = "N"
    response = "force of an element per road velocity"
    _output = staticmethod(force_of)


@dataclass(frozen=True)
class ElementStroke(_OfElement):
    """R.m.s. stroke of an element on a road [m]; `element` is its name, or its label where it has none.

    Raises `PerformanceIndexError`, where it is used, if there is no such element.

    >>> import inerter as it
    >>> car, road = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0)), it.Road(5e-7, 25.0)
    >>> stroke = it.evaluate(car, it.ElementStroke(road, "c"), it.Norm())
    >>> travel = it.evaluate(car, it.SuspensionTravel(road), it.Norm())
    >>> round(stroke.value / travel.value, 9)  # the damper is as long as the strut
    1.0
    """

    symbol = "element-stroke"
    title = "stroke of an element"
    quantity = "r.m.s. stroke of an element"
    unit = "m"
    response = "stroke of an element per road velocity"
    _output = staticmethod(stroke_of)


@dataclass(frozen=True)
class ElementVelocity(_OfElement):
    """R.m.s. velocity across an element on a road [m/s]; `element` is its name, or its label where it has none.

    Raises `PerformanceIndexError`, where it is used, if there is no such element.

    >>> import inerter as it
    >>> car, road = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0)), it.Road(5e-7, 25.0)
    >>> force = it.evaluate(car, it.ElementForce(road, "c"), it.Norm()).value  # N
    >>> velocity = it.evaluate(car, it.ElementVelocity(road, "c"), it.Norm()).value  # m/s
    >>> round(force / velocity, 6)
    1500.0
    """

    symbol = "element-velocity"
    title = "velocity across an element"
    quantity = "r.m.s. velocity across an element"
    unit = "m/s"
    response = "velocity across an element per road velocity"
    _output = staticmethod(velocity_of)
