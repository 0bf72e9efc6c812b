"""What excites the vehicle of an index in a study file: the ground, a force or the road, perhaps through a filter."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, NamedTuple

from pydantic import AfterValidator, Field, model_validator

from inerter.files.common.entries import TEXT, Amount, positive
from inerter.files.common.problem import EntryError
from inerter.files.common.schema import checked, quantity_schema
from inerter.files.common.tables import Shape
from inerter.files.study.filters import FILTER, filter_entry, in_s
from inerter.files.study.number import Number
from inerter.indices.excitation import Excitation, GroundAcceleration, Shaped, WhiteForce
from inerter.signals.road import Road
from inerter.systems.filters import Filter
from inerter.units import parse_one_of, shown

_GROUND, _INTENSITY = "ground_acceleration", "intensity"
_OF_GROUND = "(m/s^2)^2/Hz"
_OF_FORCES = {"N^2/Hz": "force", "(N m)^2/Hz": "moment"}
Path = tuple[str, ...]


class Named(NamedTuple):
    """A name in an entry that has to be the vehicle's: at which keys, of what ("output", "input" or "force")."""

    keys: Path
    what: str
    name: str


class Sized(NamedTuple):
    """A size in an entry whose unit has to follow from that of the input: at which keys, its unit, and how."""

    keys: Path
    unit: str
    expected: Callable[[str], str]


def amount_of(units: Mapping[str, str], what: str) -> Any:
    """A positive quantity in one of these units, each with what it is the unit of; `what` is all of that."""

    def check(text: Any) -> Amount:
        unit, value = parse_one_of(text, units, next(iter(units)), what)
        if value <= 0.0:
            raise EntryError(got=shown(text), fault="not positive", expected=f"more than 0 {unit}")
        return Amount(unit, value)

    return Annotated[Amount, checked(check, lambda: quantity_schema(*units, least="positive"))]


def number_of(amount: Amount, words: str) -> Number:
    """The amount as a number of the file."""
    return Number(amount.unit, words, amount.value)


def in_words(name: str) -> str:
    """A name of an output or an input as it is said."""
    return name.replace("_", " ")


class ExcitationTable(Shape):
    """What excites the vehicle: white acceleration of the ground, a white force, or the road; perhaps shaped."""

    ground_acceleration: Annotated[float | None, positive(_OF_GROUND)] = Field(
        default=None,
        description="White acceleration of the ground: its spectral density, two-sided.",
        examples=['ground_acceleration = "0.01 (m/s^2)^2/Hz"'],
    )
    force: Annotated[str | None, TEXT] = Field(
        default=None, description="A white force of the vehicle.", examples=['force = "sprung_force"']
    )
    intensity: amount_of(_OF_FORCES, "white force") | None = Field(  # type: ignore[valid-type]
        default=None,
        description="Of the force: its spectral density, two-sided; of a moment in (N m)^2/Hz.",
        examples=['intensity = "1 N^2/Hz"'],
    )
    shaping: FILTER | None = Field(
        default=None,
        description="A filter through which it arrives.",
        examples=["shaping = { numerator = [1.0], denominator = [1.0, 2.0] }"],
    )

    @model_validator(mode="after")
    def _of_one_kind(self) -> ExcitationTable:
        given = [key for key in type(self).model_fields if getattr(self, key) is not None]
        others = [key for key in ("force", _INTENSITY) if key in given]
        if not given:
            wanted = "ground_acceleration, force with intensity, or shaping of the road"
            raise EntryError(got="an empty table", expected=wanted)
        if _GROUND in given and others:
            raise EntryError(got=f"both {_GROUND} and {others[0]}", expected="one of the two")
        if others == ["force"]:
            raise EntryError(got="a force alone", expected='its intensity too, such as intensity = "1 N^2/Hz"')
        if others == [_INTENSITY]:
            raise EntryError(got="an intensity alone", expected='its force too, such as force = "sprung_force"')
        return self


@dataclass(frozen=True)
class StatedExcitation:
    """An excitation as a file says it; without ground or force it is the road."""

    ground_acceleration: float | None
    force: str | None
    intensity: Amount | None
    shaping: Filter | None

    @property
    def on_road(self) -> bool:
        """Whether it is the road of the study."""
        return self.ground_acceleration is None and self.force is None

    @property
    def source(self) -> str:
        """What it is, in words."""
        plain = "road velocity" if self.force is None else in_words(self.force)
        words = plain if self.ground_acceleration is None else in_words(_GROUND)
        return words if self.shaping is None else f"{words} before its filter"

    def made(self, road: Road | None) -> Road | Excitation | None:
        """What an index takes, on that road if it is the road."""
        plain: Road | Excitation | None = road
        if self.ground_acceleration is not None:
            plain = GroundAcceleration(self.ground_acceleration)
        elif self.force is not None and self.intensity is not None:
            plain = WhiteForce(self.force, self.intensity.value)
        return plain if self.shaping is None or plain is None else Shaped(plain, self.shaping)

    def entry(self) -> dict[str, Any]:
        """How a file says it."""
        entries = {
            _GROUND: None if self.ground_acceleration is None else f"{self.ground_acceleration!r} {_OF_GROUND}",
            "force": self.force,
            _INTENSITY: None if self.intensity is None else written(self.intensity),
            "shaping": None if self.shaping is None else filter_entry(self.shaping),
        }
        return {key: entry for key, entry in entries.items() if entry is not None}

    def numbers(self) -> dict[str, Number]:
        """The numbers in it, by their keys."""
        if self.ground_acceleration is not None:
            return {_GROUND: Number(_OF_GROUND, "intensity of the ground acceleration", self.ground_acceleration)}
        if self.force is None or self.intensity is None:
            return {}
        return {_INTENSITY: number_of(self.intensity, f"intensity of {in_words(self.force)}")}

    def with_number(self, key: str, number: float) -> StatedExcitation:
        """The same with another number at one of these keys."""
        if key == _GROUND:
            return replace(self, ground_acceleration=number)
        assert self.intensity is not None
        return replace(self, intensity=self.intensity._replace(value=number))

    def told(self) -> Iterator[tuple[str, str]]:
        """What a report says of it beside its numbers."""
        if self.shaping is not None:
            yield "Shaping filter", in_s(self.shaping)

    def named(self) -> Iterator[Named]:
        """The force that the vehicle has to have."""
        if self.force is not None:
            yield Named(("force",), "force", self.force)

    def sized(self) -> Iterator[Sized]:
        """The intensity, whose unit follows from that of the force."""
        if self.intensity is not None:
            yield Sized((_INTENSITY,), self.intensity.unit, _density)


def _stated(table: ExcitationTable) -> StatedExcitation:
    return StatedExcitation(table.ground_acceleration, table.force, table.intensity, table.shaping)


EXCITATION: Any = Annotated[ExcitationTable, AfterValidator(_stated)]


def _density(unit: str) -> str:
    """The unit of a spectral density of what has this unit."""
    return f"({unit})^2/Hz" if " " in unit else f"{unit}^2/Hz"


def written(amount: Amount) -> str:
    """An amount in its SI unit."""
    return f"{amount.value!r} {amount.unit}"
