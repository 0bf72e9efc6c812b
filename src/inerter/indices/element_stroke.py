"""The index of the stroke of an element."""

from __future__ import annotations

from dataclasses import dataclass, field

from inerter.deprecation import RenamedAttribute
from inerter.field_metadata import choice_field
from inerter.indices.definition import IndexDefinition, on_road
from inerter.indices.excitation import Excitation
from inerter.signals.road import Road
from inerter.systems.outputs import check_element, stroke_of
from inerter.vehicle.mechanism import Mechanism, OutputWeight


@dataclass(frozen=True)
class ElementStroke:
    """R.m.s. stroke of an element on a road [m]; `element` is its name, or its label where it has none.

    Raises `PerformanceIndexError`, where it is used, if there is no such element.

    >>> import inerter as it
    >>> car, road = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0)), it.Road(5e-7, 25.0)
    >>> stroke = it.evaluate(car, it.ElementStroke(road, "c"), it.Norm())
    >>> travel = it.evaluate(car, it.SuspensionTravel(road), it.Norm())
    >>> round(stroke.value / travel.value, 9)  # the damper is as long as the strut
    1.0
    """

    road: Road | Excitation
    element: str = field(metadata=choice_field((), "Name of the element.", example="c", of_element=True))
    symbol = "element-stroke"
    title = "stroke of an element"
    quantity = "r.m.s. stroke of an element"
    unit = "m"
    response = "stroke of an element per road velocity"

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no road or no such element."""
        check_element(mechanism, self.element, stroke_of)
        return on_road(self, mechanism, (OutputWeight(stroke_of(self.element)),), "element")
