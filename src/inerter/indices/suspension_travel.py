"""The index of suspension travel."""

from __future__ import annotations

from dataclasses import dataclass

from inerter.deprecation import RenamedAttribute
from inerter.indices.definition import IndexDefinition, on_road
from inerter.indices.excitation import Excitation
from inerter.signals.road import Road
from inerter.systems.outputs import of_mount
from inerter.vehicle.mechanism import Mechanism, OutputWeight


@dataclass(frozen=True)
class SuspensionTravel:
    """R.m.s. travel of the suspension on a road [m], added up over the struts; a limit on it holds for each.

    These are the struts at one wheel each, that is, at one coordinate that a tyre carries, so that what joins two
    wheels does not count, nor does a seat; where there are none, all struts.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
    >>> slow, fast = (it.evaluate(car, it.SuspensionTravel(it.Road(5e-7, v)), it.Norm()) for v in (10.0, 40.0))  # m/s
    >>> slow.unit, round(fast.value / slow.value, 9)
    ('m', 2.0)
    """

    road: Road | Excitation
    symbol = "suspension-travel"
    title = "suspension travel"
    quantity = "r.m.s. suspension travel"
    unit = "m"
    response = "travel per road velocity"

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no road or no strut."""
        wheels = {name for tyre in mechanism.tyres for name, lever in tyre.port.items() if lever}
        at_wheels = [strut for strut in mechanism.struts if len(wheels & {*strut.upper, *strut.lower}) == 1]
        travels = tuple(OutputWeight(of_mount(strut)[1]) for strut in at_wheels or mechanism.struts)
        return on_road(self, mechanism, travels, "struts")
