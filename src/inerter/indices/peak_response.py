"""The index of any peak gain."""

from __future__ import annotations

from dataclasses import dataclass, field

from inerter.deprecation import RenamedAttribute
from inerter.errors import PerformanceIndexError
from inerter.field_metadata import typed_field
from inerter.indices.definition import Combination, Given, IndexDefinition
from inerter.indices.excitation import SingleInput
from inerter.systems.filters import as_filter
from inerter.systems.outputs import input_unit, unit_of
from inerter.validation import check_positive, use_python_numbers
from inerter.vehicle.mechanism import Mechanism, OutputWeight


@dataclass(frozen=True)
class PeakResponse:
    """The largest gain from an input to an output over all frequencies; the estimate's `peaks` are all local maxima.

    `input` is an external force, a road (its displacement) or `<road>_velocity`; `filter` (a `Filter` or a
    `LinearSystem`) is on the output. `amplitude` is that of a sinusoidal input, which methods need that see friction
    or gaps.

    Raises `PerformanceIndexError` for names that are no text and for an amplitude that is not positive,
    `LinearSystemError` for what is no filter.

    >>> import inerter as it
    >>> swing = it.Strut("support", it.Spring(1.0) | it.Damper(0.1), upper={"mass": 1.0}, lower=it.GROUND)
    >>> push = it.Force("push", {"mass": 1.0})
    >>> mass = it.Mechanism(coordinates=(it.Coordinate("mass", 1.0),), struts=(swing,), forces=(push,))
    >>> found = it.evaluate(mass, it.PeakResponse("push", "mass_displacement"), it.Norm())
    >>> round(found.value, 6), round(found.peaks[0].omega, 6)  # 1 / (2 D sqrt(1 - D^2)) at sqrt(1 - 2 D^2), D = 0.05
    (10.012523, 0.997497)
    """

    input: str = field(
        metadata=typed_field(
            "input", "A force, a road (its displacement) or NAME_velocity of a road.", '"sprung_force"'
        )
    )
    output: str = field(metadata=typed_field("output", "Output of the response.", '"sprung_displacement"'))
    filter: Given = field(
        default=None,
        metadata=typed_field(
            "filter", "Filter of the output; none if left out.", "{ numerator = [1.0, 0.0], denominator = [1.0, 0.5] }"
        ),
    )
    amplitude: float | None = field(
        default=None,
        metadata=typed_field("amplitude", "Amplitude of the sinusoidal input, for friction and gaps.", '"1 kN"'),
    )
    symbol = "peak-response"
    title = "peak response"
    unit = ""  # that of its output over that of its input
    response = "gain from input to output"

    def __post_init__(self) -> None:
        use_python_numbers(self)
        for what, name in (("input", self.input), ("output", self.output)):
            if not isinstance(name, str):
                raise PerformanceIndexError(f"The {what} of a peak response is given by its name, got {name!r}.")
        if self.amplitude is not None:
            check_positive(PerformanceIndexError, f"The amplitude of {self.input!r}", self.amplitude, "its unit")
        object.__setattr__(self, "filter", as_filter(self.filter))

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism has no such input."""
        unit = _over(unit_of(mechanism, [self.output]), input_unit(mechanism, self.input))
        outputs = (OutputWeight(self.output),)
        return IndexDefinition(
            outputs, Combination.PEAK_GAIN, SingleInput(self.input), unit, self.filter, self.amplitude
        )


def _over(top: str, bottom: str) -> str:
    """A unit over another one; empty for a ratio, and where one is not known."""
    if top == bottom or not (top and bottom):
        return ""
    return f"{f'({top})' if '/' in top else top}/{f'({bottom})' if '/' in bottom or ' ' in bottom else bottom}"
