"""Excitation of the vehicle for an index in a study file: ground, force or road, with an optional shaping filter."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

from inerter.files.common.codec import Codec, KeyPath, LoadContext, TableCodec, key, keyed_dataclass, keys_in
from inerter.files.common.entries import TEXT, Amount, QuantityCodec, exact_text
from inerter.files.common.number import Number
from inerter.files.common.problem import EntryError, invalid_entry
from inerter.files.common.schema import quantity_schema
from inerter.files.study.filters import FILTER, in_s
from inerter.formatting import in_words
from inerter.indices.excitation import Excitation, FilteredExcitation, GroundAcceleration, WhiteForce
from inerter.signals.road import Road
from inerter.systems.filters import Filter
from inerter.units import parse_one_of

_GROUND, _INTENSITY = "ground_acceleration", "intensity"
_OF_GROUND = "(m/s^2)^2/Hz"
_OF_FORCES = {"N^2/Hz": "force", "(N m)^2/Hz": "moment"}


class NameReference(NamedTuple):
    """Name in an entry that must exist in the vehicle: its keys, and whether it is an "output", "input" or "force"."""

    keys: KeyPath
    what: str
    name: str


class SizeReference(NamedTuple):
    """Size in an entry whose unit depends on that of the input: its keys, its unit, and the units expected."""

    keys: KeyPath
    unit: str
    expected: Callable[[str], str]


@dataclass(frozen=True)
class AmountCodec(Codec):
    """Positive quantity in one of `units`, each with the name of its quantity; `what` names all of them."""

    is_number: ClassVar[bool] = True

    units: Mapping[str, str]
    what: str

    def load(self, raw: Any, context: LoadContext) -> Amount:
        """The value with its SI unit."""
        unit, value = parse_one_of(raw, self.units, next(iter(self.units)), self.what)
        if value <= 0.0:
            raise invalid_entry(raw, fault="not positive", expected=f"more than 0 {unit}")
        return Amount(unit, value)

    def dump(self, value: Amount) -> str:
        """The text in that unit."""
        return exact_text(value.value, value.unit)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the text."""
        return quantity_schema(*self.units, least="positive")

    def numbers(self, value: Amount | None, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The quantity, where the file gives it."""
        if value is not None:
            yield (), Number(value.unit, words, value.value)

    def put(self, value: Amount, keys: Sequence[str], number: float) -> Amount:
        """Amount with another value in the same unit."""
        return value._replace(value=number)


@keyed_dataclass
class StatedExcitation:
    """Excitation of the vehicle: white acceleration of the ground, a white force, or the road; perhaps shaped."""

    ground_acceleration: float | None = key(
        QuantityCodec(_OF_GROUND, if_given=True),
        "Two-sided spectral density of a white ground acceleration.",
        'ground_acceleration = "0.01 (m/s^2)^2/Hz"',
        default=None,
        words="intensity of the ground acceleration",
    )
    force: str | None = key(TEXT, "Name of the force that is white noise.", 'force = "sprung_force"', default=None)
    intensity: Amount | None = key(
        AmountCodec(_OF_FORCES, "white force"),
        "Two-sided spectral density of the force; of a moment in (N m)^2/Hz.",
        'intensity = "1 N^2/Hz"',
        default=None,
    )
    shaping: Filter | None = key(
        FILTER,
        "Shaping filter between white noise and vehicle.",
        "shaping = { numerator = [1.0], denominator = [1.0, 2.0] }",
        default=None,
    )

    @property
    def on_road(self) -> bool:
        """Whether the excitation is the road of the study."""
        return self.ground_acceleration is None and self.force is None

    @property
    def source(self) -> str:
        """Excitation in words, such as "road velocity"."""
        plain = "road velocity" if self.force is None else in_words(self.force)
        words = plain if self.ground_acceleration is None else in_words(_GROUND)
        return words if self.shaping is None else f"{words} before its filter"

    def to_excitation(self, road: Road | None) -> Road | Excitation | None:
        """Excitation as an index takes it; `road` is used if neither ground nor force is stated."""
        plain: Road | Excitation | None = road
        if self.ground_acceleration is not None:
            plain = GroundAcceleration(self.ground_acceleration)
        elif self.force is not None and self.intensity is not None:
            plain = WhiteForce(self.force, self.intensity.value)
        return plain if self.shaping is None or plain is None else FilteredExcitation(plain, self.shaping)

    def report_rows(self) -> Iterator[tuple[str, str]]:
        """Rows of a report on the excitation, in addition to its numbers."""
        if self.shaping is not None:
            yield "Shaping filter", in_s(self.shaping)

    def name_references(self) -> Iterator[NameReference]:
        """The force that the vehicle has to have."""
        if self.force is not None:
            yield NameReference(("force",), "force", self.force)

    def size_references(self) -> Iterator[SizeReference]:
        """The intensity, whose unit follows from that of the force."""
        if self.intensity is not None:
            yield SizeReference((_INTENSITY,), self.intensity.unit, _density)


@dataclass(frozen=True)
class ExcitationCodec(TableCodec):
    """The table of an excitation, whose intensity is called by its force."""

    def numbers(self, value: Any, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The intensity of the ground or of the force."""
        for keys, number in super().numbers(value, words):
            of_force = keys == (_INTENSITY,) and value.force is not None
            yield keys, replace(number, words=f"intensity of {in_words(value.force)}") if of_force else number


def _of_one_kind(value: StatedExcitation) -> StatedExcitation:
    given = [name for name, part in vars(value).items() if part is not None]
    others = [name for name in ("force", _INTENSITY) if name in given]
    if not given:
        wanted = "ground_acceleration, force with intensity, or shaping of the road"
        raise EntryError(got="an empty table", expected=wanted)
    if _GROUND in given and others:
        raise EntryError(got=f"both {_GROUND} and {others[0]}", expected="one of the two")
    if others == ["force"]:
        raise EntryError(got="a force alone", expected='its intensity too, such as intensity = "1 N^2/Hz"')
    if others == [_INTENSITY]:
        raise EntryError(got="an intensity alone", expected='its force too, such as force = "sprung_force"')
    return value


EXCITATION = ExcitationCodec(
    keys_in(StatedExcitation), StatedExcitation, check=_of_one_kind, about=str(StatedExcitation.__doc__)
)


def _density(unit: str) -> str:
    """The unit of a spectral density of what has this unit."""
    return f"({unit})^2/Hz" if " " in unit else f"{unit}^2/Hz"
