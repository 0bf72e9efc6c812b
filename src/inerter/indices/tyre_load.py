"""The index of dynamic tyre load."""

from __future__ import annotations

from dataclasses import dataclass, field

from inerter.deprecation import RenamedAttribute
from inerter.errors import PerformanceIndexError
from inerter.field_metadata import quantity
from inerter.indices.definition import IndexDefinition, on_road
from inerter.indices.excitation import Excitation
from inerter.signals.road import Road
from inerter.systems.filters import high_pass
from inerter.validation import check_positive, use_python_numbers
from inerter.vehicle.mechanism import Mechanism


@dataclass(frozen=True)
class TyreLoad:
    """J3: r.m.s. dynamic tyre force on a road [N], added up over the tyres.

    `high_pass` puts a filter s/(s + high_pass), in rad/s, on every tyre force; the paper does so for the half car.
    Source: Wang and Su (2008), eq. (5).

    >>> import inerter as it
    >>> load = it.TyreLoad(it.Road(roughness=5e-7, speed=25.0))
    >>> load.symbol, load.unit
    ('J3', 'N')
    """

    road: Road | Excitation
    high_pass: float | None = field(
        default=None,
        metadata=quantity("rad/s", "Corner of a filter on J3; none if left out.", "1 Hz", words="high-pass filter"),
    )
    symbol = "J3"
    title = "dynamic tyre load"
    quantity = "r.m.s. dynamic tyre load"
    unit = "N"
    response = "tyre force per road velocity"

    def __post_init__(self) -> None:
        use_python_numbers(self)
        if self.high_pass is not None:
            check_positive(PerformanceIndexError, "The high-pass corner of the tyre load", self.high_pass, "rad/s")

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no road or names no tyre load."""
        passed = None if self.high_pass is None else high_pass(self.high_pass)
        return on_road(self, mechanism, mechanism.tyre_loads, "measures.tyre_load", passed)
