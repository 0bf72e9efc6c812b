"""The index of ride comfort."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from inerter.deprecation import RenamedAttribute
from inerter.errors import PerformanceIndexError
from inerter.field_metadata import choice_field
from inerter.indices.definition import Combination, IndexDefinition, on_road
from inerter.indices.excitation import Excitation
from inerter.indices.iso2631 import ROTATIONS, check_weighting, weighting_filter
from inerter.signals.road import Road
from inerter.systems.filters import Filter
from inerter.vehicle.mechanism import Coordinate, Mechanism, OutputWeight

_FELT = ("Wk", "Wd", "Wf")
_SICKNESS = "Wf"


@dataclass(frozen=True)
class RideComfort:
    """J1: r.m.s. body acceleration on a road [m/s^2].

    Quarter car: 2 pi sqrt(V kappa) times the H2 norm from road velocity to body acceleration. Half car: bounce plus
    pitch times the mean lever (l_f + l_r)/2, each with its own norm. Source: Wang and Su (2008), eq. (4).

    With a `weighting` it is as people feel it, by ISO 2631-1:1997: accelerations pass through "Wk" (vertical) or "Wd"
    (horizontal); pitch and roll accelerations through We, times 0.4 and 0.63 m/rad; the value is the root of the sum
    of the squares. With "Wf" (motion sickness) rotations do not count.

    Raises `PerformanceIndexError` for another weighting.

    >>> import inerter as it
    >>> comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25.0))
    >>> comfort.symbol, comfort.unit
    ('J1', 'm/s^2')
    """

    road: Road | Excitation
    weighting: str | None = field(
        default=None,
        metadata=choice_field(_FELT, "Weighting of ISO 2631-1 on J1; none if left out."),
    )
    symbol = "J1"
    title = "ride comfort"
    quantity = "r.m.s. body acceleration"
    unit = "m/s^2"
    response = "body acceleration per road velocity"

    def __post_init__(self) -> None:
        if self.weighting is not None and check_weighting(self.weighting) not in _FELT:
            raise PerformanceIndexError(
                f"Ride comfort is weighted by {', '.join(_FELT)} or not at all, got {self.weighting!r}; rotations get "
                f"theirs with Wk and Wd."
            )

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no road or no comfort output."""
        comfort, where = mechanism.measures.comfort, "measures.comfort"
        if self.weighting is None:
            return on_road(self, mechanism, comfort, where)
        felt = [part for output in comfort if (part := self._weighted_output(mechanism, output)) is not None]
        outputs, filters = tuple(output for output, _ in felt), tuple(passed for _, passed in felt)
        return on_road(self, mechanism, outputs, where, filters, Combination.ROOT_OF_SQUARES)

    def _weighted_output(self, mechanism: Mechanism, output: OutputWeight) -> tuple[OutputWeight, Filter] | None:
        """Acceleration with its factor in ISO 2631-1 and its weighting filter; None if the standard ignores it."""
        assert self.weighting is not None
        moving = {f"{c.name}_acceleration": c for c in mechanism.coordinates}.get(output.output)
        if moving is None:
            raise PerformanceIndexError(
                f"ISO 2631-1 weights accelerations, and measures.comfort has {output.output!r}. Evaluate it without "
                f"a weighting, or name the acceleration of a coordinate."
            )
        if not moving.angle:
            return output, weighting_filter(self.weighting)
        if self.weighting == _SICKNESS:
            return None
        return replace(output, weight=_lever(moving)), weighting_filter("We")


def _lever(rotating: Coordinate) -> float:
    """Multiplying factor of ISO 2631-1 for a rotation [m/rad]."""
    if rotating.name not in ROTATIONS:
        raise PerformanceIndexError(
            f"ISO 2631-1 weights pitch and roll, but not the rotation {rotating.name!r}. Name the coordinate "
            f"{' or '.join(ROTATIONS)}, or leave it out of measures.comfort."
        )
    return ROTATIONS[rotating.name]
