"""Index of the dynamic load coefficient: r.m.s. dynamic tyre load over static load."""

from __future__ import annotations

from dataclasses import dataclass, replace

from inerter.deprecation import RenamedAttribute
from inerter.errors import MechanismError, PerformanceIndexError
from inerter.indices.definition import IndexDefinition, on_road
from inerter.indices.excitation import Excitation
from inerter.signals.road import Road
from inerter.systems.outputs import of_mount
from inerter.systems.static_loads import static_tyre_loads
from inerter.vehicle.mechanism import Mechanism


@dataclass(frozen=True)
class DynamicLoadCoefficient:
    """R.m.s. dynamic load of the tyres on a road over their static load, added up; a limit on it holds for each.

    The static load follows from masses and levers. A tyre whose coefficient is 1/3 or more leaves the road now and
    then: the linear model, which lets tyres pull, is then no longer the whole truth.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
    >>> road = it.Road(5e-7, 25.0)
    >>> load, coefficient = (
    ...     it.evaluate(car, index(road), it.Norm()).value for index in (it.TyreLoad, it.DynamicLoadCoefficient)
    ... )
    >>> round(load / coefficient, 3) == round((250.0 + 35.0) * 9.80665, 3)  # the static load [N]
    True
    """

    road: Road | Excitation
    symbol = "dynamic-load-coefficient"
    title = "dynamic load coefficient"
    unit = ""  # a ratio
    response = "tyre force over static load per road velocity"

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no road, names no tyre load, or if loads at rest are not
        known.
        """
        measured = mechanism.tyre_loads
        if not measured:
            return on_road(self, mechanism, (), "measures.tyre_load")
        try:
            at_rest = static_tyre_loads(mechanism)
        except MechanismError as error:
            raise PerformanceIndexError(str(error)) from error
        carried = {of_mount(tyre)[0]: at_rest[tyre.name] for tyre in mechanism.tyres}
        unknown = ", ".join(output.output for output in measured if output.output not in carried)
        if unknown:
            raise PerformanceIndexError(
                f"A load coefficient requires tyre loads, but measures.tyre_load has {unknown}."
            )
        outputs = tuple(replace(output, weight=output.weight / carried[output.output]) for output in measured)
        return on_road(self, mechanism, outputs, "measures.tyre_load")
