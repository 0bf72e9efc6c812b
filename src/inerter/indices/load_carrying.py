"""The index of dynamic load carrying."""

from __future__ import annotations

from dataclasses import dataclass, field

from inerter.deprecation import RenamedAttribute
from inerter.errors import PerformanceIndexError
from inerter.field_metadata import quantity
from inerter.indices.definition import Combination, IndexDefinition
from inerter.indices.excitation import SingleInput
from inerter.validation import check_positive, use_python_numbers
from inerter.vehicle.mechanism import Mechanism, OutputWeight


@dataclass(frozen=True)
class LoadCarrying:
    """J5: largest gain from a force on the body to its displacement, over all frequencies [m/N].

    Half car: bounce force to bounce displacement. `amplitude` is that of a sinusoidal force [N]: what a design with
    friction or gaps does depends on it, what a linear one does not. Source: Wang and Su (2008), eq. (6).

    Raises `PerformanceIndexError` unless the amplitude is positive.

    >>> import inerter as it
    >>> strut = it.Spring(20e3) | it.Damper(6000.0)  # overdamped: the largest gain is the static one
    >>> found = it.evaluate(it.QuarterCar(250.0, 35.0, 180e3, strut), it.LoadCarrying(), it.Norm())
    >>> round(found.value, 9) == round(1 / 20e3 + 1 / 180e3, 9)  # m/N
    True
    """

    amplitude: float | None = field(
        default=None,
        metadata=quantity(
            "N", "Amplitude of the sinusoidal force of J5.", "1 kN", key="force", words="amplitude of the force"
        ),
    )
    symbol = "J5"
    title = "dynamic load carrying"
    quantity = "peak displacement per force"
    unit = "m/N"
    response = "displacement per force"  # of the body, or of what a mechanism carries

    def __post_init__(self) -> None:
        use_python_numbers(self)
        if self.amplitude is not None:
            check_positive(PerformanceIndexError, "The amplitude of the force on the body", self.amplitude, "N")

    question = RenamedAttribute("definition")

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Raises `PerformanceIndexError` if the mechanism names no force and displacement for it."""
        measures = mechanism.measures
        if measures.load_input is None or measures.load_output is None:
            raise PerformanceIndexError(
                "The mechanism does not define the force and the displacement of load carrying. "
                "Set measures.load_input and measures.load_output."
            )
        return IndexDefinition(
            outputs=(OutputWeight(measures.load_output),),
            combination=Combination.PEAK_GAIN,
            excitation=SingleInput(measures.load_input),
            unit=self.unit,
            amplitude=self.amplitude,
        )
