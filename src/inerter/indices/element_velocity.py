"""The index of the velocity across an element."""

from __future__ import annotations

from dataclasses import dataclass, field

from inerter.deprecation import RenamedAttribute
from inerter.field_metadata import choice_field
from inerter.indices.definition import IndexDefinition, on_road
from inerter.indices.excitation import Excitation
from inerter.signals.road import Road
from inerter.systems.outputs import check_element, velocity_of
from inerter.vehicle.mechanism import Mechanism, OutputWeight


@dataclass(frozen=True)
class ElementVelocity:
    """R.m.s. velocity across an element on a road [m/s]; `element` is its name, or its label where it has none.

    Raises `PerformanceIndexError`, where it is used, if there is no such element.

    >>> import inerter as it
    >>> car, road = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0)), it.Road(5e-7, 25.0)
    >>> force = it.evaluate(car, it.ElementForce(road, "c"), it.Norm()).value  # N
    >>> velocity = it.evaluate(car, it.ElementVelocity(road, "c"), it.Norm()).value  # m/s
    >>> round(force / velocity, 6)
    1500.0
    """

    road: Road | Excitation
    element: str = field(metadata=choice_field((), "Name of the element.", example="c", of_element=True))
    symbol = "element-velocity"
    title = "velocity across an element"
    quantity = "r.m.s. velocity across an element"
    unit = "m/s"
    response = "velocity across an element per road velocity"

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no road or no such element."""
        check_element(mechanism, self.element, velocity_of)
        return on_road(self, mechanism, (OutputWeight(velocity_of(self.element)),), "element")
