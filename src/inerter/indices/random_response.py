"""The index of any random response."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from inerter.deprecation import RenamedAttribute
from inerter.errors import PerformanceIndexError
from inerter.field_metadata import typed_field
from inerter.indices.definition import Combination, Given, IndexDefinition
from inerter.indices.excitation import Excitation, as_excitation
from inerter.signals.road import Road
from inerter.systems.filters import as_filter
from inerter.systems.outputs import unit_of
from inerter.validation import is_number, use_python_numbers
from inerter.vehicle.mechanism import Mechanism, OutputWeight

Weights = Mapping[str, float]


@dataclass(frozen=True)
class RandomResponse:
    """R.m.s. values of any outputs under any random excitation, each times its weight, added up.

    `outputs` maps names of outputs to weights, `excitation` is a `Road`, a `WhiteForce`, a `GroundAcceleration`, or one
    of these `FilteredExcitation` by a filter. `filter` (a `Filter` or a `LinearSystem`) is on every output.

    Raises `PerformanceIndexError` for what is none of these, `LinearSystemError` for what is no filter.

    >>> import inerter as it
    >>> swing = it.Strut("support", it.Spring(1.0) | it.Damper(0.1), upper={"mass": 1.0}, lower=it.GROUND)
    >>> push = it.Force("push", {"mass": 1.0})
    >>> mass = it.Mechanism(coordinates=(it.Coordinate("mass", 1.0),), struts=(swing,), forces=(push,))
    >>> moved = it.RandomResponse({"mass_displacement": 1.0}, it.WhiteForce("push", intensity=1.0))
    >>> round(it.evaluate(mass, moved, it.Norm()).value ** 2, 9)  # S / (2 c k)
    5.0
    """

    outputs: Weights = field(metadata=typed_field("outputs", "Outputs with their weights.", "{ tyre_load = 1 }"))
    excitation: Road | Excitation = field(
        metadata=typed_field(
            "excitation",
            "Excitation of the vehicle; the road of the study if left out.",
            '{ ground_acceleration = "0.01 (m/s^2)^2/Hz" }',
        )
    )
    filter: Given = field(
        default=None,
        metadata=typed_field(
            "filter",
            "Filter of every output; none if left out.",
            "{ numerator = [1.0, 0.0], denominator = [1.0, 0.5] }",
        ),
    )
    symbol = "random-response"
    title = "random response"
    quantity = "r.m.s. random response"
    unit = ""  # that of its outputs
    response = "gain from excitation"

    def __post_init__(self) -> None:
        use_python_numbers(self)
        if not isinstance(self.outputs, Mapping) or not self.outputs:
            raise PerformanceIndexError(
                f"The outputs of a random response map names to weights, as {{'tyre_load': 1.0}}; got {self.outputs!r}."
            )
        for name, weight in self.outputs.items():
            if not isinstance(name, str) or not is_number(weight) or weight == 0.0:
                raise PerformanceIndexError(f"The weight of output {name!r} is a number other than 0, got {weight!r}.")
        object.__setattr__(self, "outputs", FixedWeights(self.outputs))
        object.__setattr__(self, "excitation", as_excitation(self.excitation, "A random response"))
        object.__setattr__(self, "filter", as_filter(self.filter))

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the excitation does not fit the mechanism."""
        drive = as_excitation(self.excitation, "A random response")
        if not drive.is_random:
            raise PerformanceIndexError(f"A random response needs a random excitation, got {drive!r}.")
        outputs = tuple(OutputWeight(name, weight) for name, weight in self.outputs.items())
        unit = unit_of(drive.excited_mechanism(mechanism), list(self.outputs))
        return IndexDefinition(outputs, Combination.SUM_OF_RMS, drive, unit, self.filter)


class FixedWeights(dict[str, float]):
    """A mapping that is the same for good, so that an index can be a key."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(self.items()))
