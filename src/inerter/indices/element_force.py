"""The index of the force of an element."""

from __future__ import annotations

from dataclasses import dataclass, field

from inerter.deprecation import RenamedAttribute
from inerter.field_metadata import choice_field
from inerter.indices.definition import IndexDefinition, on_road
from inerter.indices.excitation import Excitation
from inerter.signals.road import Road
from inerter.systems.outputs import check_element, force_of
from inerter.vehicle.mechanism import Mechanism, OutputWeight


@dataclass(frozen=True)
class ElementForce:
    """R.m.s. force of an element on a road [N]; `element` is its name, or its label where it has none.

    Raises `PerformanceIndexError`, where it is used, if there is no such element.

    >>> import inerter as it
    >>> car, road = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3, "coil") | it.Damper(1500.0)), it.Road(5e-7, 25.0)
    >>> force = it.evaluate(car, it.ElementForce(road, "coil"), it.Norm()).value  # N
    >>> stroke = it.evaluate(car, it.ElementStroke(road, "coil"), it.Norm()).value  # m
    >>> round(force / stroke)
    20000
    """

    road: Road | Excitation
    element: str = field(metadata=choice_field((), "Name of the element.", example="c", of_element=True))
    symbol = "element-force"
    title = "force of an element"
    quantity = "r.m.s. force of an element"
    unit = "N"
    response = "force of an element per road velocity"

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no road or no such element."""
        check_element(mechanism, self.element, force_of)
        return on_road(self, mechanism, (OutputWeight(force_of(self.element)),), "element")
