"""Single entries of files: checks that turn one into its value or state its problem, and codecs made of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple
from unicodedata import category

from inerter.field_metadata import Field, TextChoice
from inerter.files.common.codec import (
    INVALID,
    REQUIRED,
    Codec,
    Declaration,
    KeyPath,
    LoadContext,
    Scalar,
    TableCodec,
)
from inerter.files.common.number import Number
from inerter.files.common.problem import EntryError, invalid_entry
from inerter.files.common.schema import list_schema, quantity_schema, words_schema
from inerter.files.common.suggest import nearest
from inerter.formatting import format_alike, format_number, format_range, in_words
from inerter.networks.elements import NAME, Free
from inerter.networks.elements.registry import kinds_by_unit, parse_element
from inerter.networks.parser import rename_in_expression
from inerter.systems.outputs import rename_output
from inerter.units import parse_quantity, quote_value, unit_in
from inerter.validation import is_number

LOWER, UPPER = "from", "to"  # the keys of the bounds of a free value, and of the ends of a range
MOST_POINTS = 10_000_000
_LONGEST_EXPRESSION = 500
_LARGEST = 1e50  # of a quantity in SI units, and the inverse of the smallest
_WIDEST = 1e24  # ratio of the bounds of a free value
_MOST_BRACKETS = 50  # far from the depth at which Python's stack ends
TEXT_SCHEMA: dict[str, Any] = {"type": "string", "minLength": 1, "maxLength": 200}
SHARE_SCHEMA: dict[str, Any] = {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1}
EXPRESSION_SCHEMA: dict[str, Any] = {
    "type": "string",
    "minLength": 1,
    "maxLength": _LONGEST_EXPRESSION,
    "description": "Network: | in parallel; - in series, binds tighter; bridge(a, b, c, d, e) with networks as arms.",
    "examples": ["k | c - b"],
}
_LAYOUT_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]{0,39}")


class Amount(NamedTuple):
    """A value in the SI unit that tells its kind: of an element, of a coordinate, of an excitation."""

    unit: str
    value: Any  # a number; a `Free` where it is a range


@dataclass(frozen=True)
class QuantityCodec(Codec):
    """A number of `unit`; one that may be `free` may be a table with the two ends of a range.

    One that is a place `if_given` has none where the file leaves it out.
    """

    is_number: ClassVar[bool] = True

    unit: str  # SI
    least: str = "positive"  # or "not negative", or empty for either sign
    free: bool = False
    if_given: bool = False

    def load(self, raw: Any, context: LoadContext) -> float | Free:
        """The value in its unit, or the free value, which has the name of its key."""
        if self.free and isinstance(raw, dict):
            found = self._range().load(raw, context)
            return found if found is INVALID else found.free(context.place[-1])  # type: ignore[no-any-return]
        match self.least:
            case "positive":
                return positive_in(raw, self.unit)
            case "not negative":
                return not_negative_in(raw, self.unit)
            case _:
                return parse_quantity(raw, self.unit)

    def dump(self, value: float | Free) -> Any:
        """The text, or a table of two."""
        return text_of(value, self.unit)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the text."""
        one = quantity_schema(self.unit, least=self.least)
        return {"anyOf": [one, self._range().schema()]} if self.free else one

    def _range(self) -> TableCodec:
        def make(lower: float, upper: float) -> Range:
            return range_between(Amount(self.unit, lower), Amount(self.unit, upper))

        return range_codec(positive(self.unit), f"1 {self.unit}", f"2 {self.unit}", make)

    def numbers(self, value: Any, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """Quantity, and its bounds if it is a design variable."""
        if value is not None or not self.if_given:
            yield from with_bounds(
                Number(self.unit, words, value, self.least == "not negative", self.free, self.least == "")
            )

    def put(self, value: Any, keys: Sequence[str], number: float) -> float | Free:
        """The number, or the free value with another bound."""
        return other_bound(value, keys[0], number) if keys else number


class Range(NamedTuple):
    """The two ends of a range, in ascending order."""

    lower: Amount
    upper: Amount

    def free(self, name: str) -> Free:
        """Free value between them."""
        return Free(self.lower.value, self.upper.value, name)


def range_between(lower: Amount, upper: Amount) -> Range:
    """Range of a search; raises `EntryError` unless its ends have one unit, ascend, and are not too far apart."""
    if lower.unit != upper.unit:
        raise EntryError(got=f"ends of unlike units, {lower.unit} and {upper.unit}", expected="one unit for both")
    check_ascending(lower.value, upper.value, lower.unit, "Write a single value without from and to.")
    if lower.value > 0.0 and upper.value > _WIDEST * lower.value:
        ends = format_range(lower.value, upper.value, lower.unit, 12)
        expected = f"an upper bound of at most {format_number(_WIDEST)} times the lower one"
        raise EntryError(got=ends, fault="wider than a search can cover", expected=expected)
    return Range(lower, upper)


def check_ascending(lower: float, upper: float, unit: str, if_equal: str) -> None:
    """Raises `EntryError` unless `lower` is less than `upper`; `if_equal` is the remedy for equal ends."""
    if lower >= upper:
        how, remedy = ("equal", if_equal) if lower == upper else ("reversed", "Swap them.")
        first, last = format_alike([lower, upper], unit, 12)
        ends = f'{how} ends, from = "{first}" and to = "{last}"'
        raise EntryError(got=ends, expected="from less than to", hint=remedy)


def range_codec(
    end: Codec, lower: str, upper: str, make: Callable[..., tuple[Any, Any]] = range_between, about: str = ""
) -> TableCodec:
    """Table of the two ends of a range, each with an example; `make` turns both into one value."""
    return TableCodec(
        (
            Declaration(end, "Lower bound.", f'{LOWER} = "{lower}"', name=LOWER, attribute="lower"),
            Declaration(end, "Upper bound.", f'{UPPER} = "{upper}"', name=UPPER, attribute="upper"),
        ),
        make,
        lambda value: dict(zip(("lower", "upper"), value, strict=True)),
        about=about,
    )


class QuantityText(str):
    """A number with its SI unit as text, to the last bit; other texts of a file may look like one."""

    number: float
    unit: str


def exact_text(number: float, unit: str) -> QuantityText:
    """A number with its SI unit as text."""
    text = QuantityText(f"{number!r} {unit}")
    text.number, text.unit = number, unit
    return text


def text_of(value: float | Free, unit: str) -> str | dict[str, str]:
    """A value with its SI unit as text, to the last bit; a table of two for one that is free."""
    if isinstance(value, Free):
        return {LOWER: exact_text(value.lower, unit), UPPER: exact_text(value.upper, unit)}
    return exact_text(value, unit)


def with_bounds(number: Number) -> Iterator[tuple[KeyPath, Number]]:
    """A number, with its bounds if it is free, by the keys to them."""
    yield (), number
    if isinstance(value := number.value, Free):
        for key, end, bound in ((LOWER, "lower", value.lower), (UPPER, "upper", value.upper)):
            words = f"{end} bound of {number.words}" if number.words else f"{end} bound"
            yield (key,), Number(number.unit, words, bound)


def other_bound(value: Free, key: str, number: float) -> Free:
    """The free value with another bound."""
    lower, upper = (number, value.upper) if key == LOWER else (value.lower, number)
    return Free(lower, upper, value.name)


def positive(unit: str) -> QuantityCodec:
    """A quantity of `unit` that is greater than zero."""
    return QuantityCodec(unit)


def any_quantity(unit: str) -> QuantityCodec:
    """A quantity of `unit` of either sign."""
    return QuantityCodec(unit, "")


def not_negative(unit: str) -> QuantityCodec:
    """A quantity of `unit` that may be zero."""
    return QuantityCodec(unit, "not negative")


def not_negative_in(text: Any, unit: str) -> float:
    """A quantity of `unit` that is zero or more."""
    value = _check_size(parse_quantity(text, unit), text, unit)
    if value < 0.0:
        raise invalid_entry(text, fault="negative", expected=f"0 {unit} or more")
    return value


def positive_in(text: Any, unit: str) -> float:
    """A quantity of `unit` that is greater than zero."""
    value = _check_size(parse_quantity(text, unit), text, unit)
    if value <= 0.0:
        raise invalid_entry(text, fault="not positive", expected=f"more than 0 {unit}")
    return value


def _check_size(value: float, text: Any, unit: str) -> float:
    """`value`; raises `EntryError` for a size whose squares and products leave the range of numbers."""
    if value and not 1.0 / _LARGEST <= abs(value) <= _LARGEST:
        expected = f"a size from {format_range(1.0 / _LARGEST, _LARGEST, unit)}"
        raise invalid_entry(text, fault="a size that nothing has", expected=expected, hint="Check the unit.")
    return value


def declaration_of(one: Field | TextChoice, *, optional: bool = False, free: bool = False) -> Declaration:
    """Key declaration from the metadata of a dataclass field; may be a range if `free` and the field permits it.

    Those without a default must be given, unless all are `optional` here, and those whose default is zero may be zero.
    """
    example = f'{one.key} = "{one.example}"'
    if isinstance(one, TextChoice):
        free_text: Codec = ELEMENT_NAME if one.of_element else TEXT
        codec: Codec = word(f"a {in_words(one.key)}", one.options) if one.options else free_text
        return Declaration(codec, one.sentence, example, REQUIRED if one.needed else None, one.key, one.key)
    least = "not negative" if one.default == 0.0 and not optional else "positive"
    default = None if optional else REQUIRED if one.default is None else one.default
    codec = QuantityCodec(one.unit, least, free and one.may_be_free)
    return Declaration(codec, one.sentence, example, default, one.key, one.key, one.in_words)


def positive_number(value: Any) -> float:
    """A number greater than zero, without a unit."""
    if not is_number(value) or value <= 0.0:
        raise invalid_entry(value, expected="a positive number without quotes, such as 1.02")
    return float(value)


POSITIVE = Scalar(positive_number, lambda: {"type": "number", "exclusiveMinimum": 0})


def yes_or_no(value: Any) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise invalid_entry(value, expected="true or false, without quotes")
    return value


def amount(text: Any) -> Amount:
    """The value of an element whose kind its unit tells."""
    known = kinds_by_unit()
    unit, value = parse_element(text, known)
    _check_size(value, text, unit)
    if value < 0.0 or (value == 0.0 and not known[unit].may_vanish):
        hint = "To leave the element out, drop its branch from the layouts."
        raise invalid_entry(text, fault="not positive", expected=f"more than 0 {unit}", hint=hint)
    return Amount(unit, value)


def quantity_text(text: Any) -> str:
    """Text of a number with a unit; the kind of quantity is checked once its key path is known."""
    unit_in(text)
    return str(text)


AMOUNT = Scalar(
    amount,
    lambda: {
        **quantity_schema(*kinds_by_unit(), least="not negative"),
        "description": "Value whose unit determines the element, or a table with the bounds of a design variable.",
        "examples": [kind.example for kind in kinds_by_unit().values()],
    },
)
SWEPT = Scalar(quantity_text, quantity_schema)


YES_OR_NO = Scalar(yes_or_no, lambda: {"type": "boolean"})


def text(value: Any) -> str:
    """A title or a name."""
    if not isinstance(value, str) or not value.strip() or len(value) > 200:
        raise invalid_entry(value, expected='text of 1 to 200 characters in quotes, such as "My car"')
    if any(category(character) == "Cc" and not character.isspace() for character in value):
        raise invalid_entry(value, fault="contains a control character", expected="printable characters")
    return value


TEXT = Scalar(text, lambda: TEXT_SCHEMA)


def _renamed_element(raw: Any, names: Mapping[str, str]) -> Any:
    return names.get(raw, raw) if isinstance(raw, str) else raw


ELEMENT_NAME = Scalar(text, lambda: TEXT_SCHEMA, renamed=_renamed_element)
OUTPUT_NAME = Scalar(  # which may be one of an element
    text, lambda: TEXT_SCHEMA, renamed=lambda raw, names: rename_output(raw, names) if isinstance(raw, str) else raw
)


def one_of(what: str, known: Collection[str]) -> Callable[[Any], str]:
    """Check that returns a word if it is among the `known` ones; `what` names it in messages, with its article."""

    def check(value: Any) -> str:
        if not isinstance(value, str) or value not in known:
            available = f"not {what}; available in this version: {', '.join(quote_value(name) for name in known)}"
            raise invalid_entry(value, fault=available, hint=nearest(value, known))
        return value

    return check


def word(what: str, known: Collection[str]) -> Codec:
    """An entry that is `one_of` some words."""
    return Scalar(one_of(what, known), lambda: words_schema(known))


def some_of(what: str, known: Collection[str]) -> Codec:
    """A list of at least one of `known`, none of them twice."""
    check = one_of(what, known)
    return Scalar(
        lambda values: _check_list(values, check, lambda: next(iter(known))),
        lambda: list_schema(words_schema(known)),
        list_or_none,
    )


@dataclass(frozen=True)
class SomeOfFile(Codec):
    """A list of at least one of the words that are `known` in a file, none of them twice."""

    what: str
    known: Callable[[Mapping[str, Any]], Collection[str]]

    def load(self, raw: Any, context: LoadContext) -> tuple[str, ...]:
        """List of the words."""
        words = self.known(context.tables)
        return _check_list(raw, one_of(self.what, words), lambda: next(iter(words)))

    def dump(self, value: tuple[str, ...]) -> list[str] | None:
        """The list; None for an empty one."""
        return list_or_none(value)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the list, which takes names of the file's own too."""
        return list_schema({"anyOf": [words_schema(self.known({})), TEXT_SCHEMA]})


def some_names(example: str) -> Codec:
    """List of at least one element, without repetition; whether the elements exist is checked later."""
    return Scalar(
        lambda values: _check_list(values, text, lambda: example),
        lambda: list_schema(TEXT_SCHEMA),
        list_or_none,
        lambda raw, names: [_renamed_element(one, names) for one in raw] if isinstance(raw, list) else raw,
    )


def list_or_none(values: Collection[Any]) -> list[Any] | None:
    """Values as a list; None if empty."""
    return list(values) or None


def _check_list(values: Any, one: Callable[[Any], str], example: Callable[[], str]) -> tuple[str, ...]:
    if not isinstance(values, list) or not values:
        got = "an empty list" if values == [] else quote_value(values)
        raise EntryError(got=got, expected=f"a list of one or more, such as [{quote_value(example())}]")
    listed = tuple(one(value) for value in values)
    twice = next((value for value in listed if listed.count(value) > 1), None)
    if twice is not None:
        raise EntryError(got=f"{quote_value(twice)} more than once", expected="each at most once")
    return listed


def whole(lower: int, upper: int) -> Codec:
    """A whole number between two others."""

    def check(value: Any) -> int:
        if not isinstance(value, int) or isinstance(value, bool) or not lower <= value <= upper:
            raise invalid_entry(value, expected=f"a whole number from {lower} to {upper}, without quotes")
        return value

    return Scalar(check, lambda: {"type": "integer", "minimum": lower, "maximum": upper})


def share(value: Any) -> float:
    """A number between zero and one, without a unit."""
    if not isinstance(value, float) or not 0.0 < value < 1.0:
        raise invalid_entry(value, expected="a number between 0 and 1 without quotes, such as 0.01")
    return value


SHARE = Scalar(share, lambda: SHARE_SCHEMA)


def expression(value: Any) -> str:
    """Expression of a network; its syntax is checked once all elements are known."""
    if not isinstance(value, str):
        raise invalid_entry(value, expected='a network in quotes, such as "k | c - b"')
    if len(value) > _LONGEST_EXPRESSION or value.count("(") > _MOST_BRACKETS:
        raise EntryError(
            got=f"a network of {len(value)} characters with {value.count('(')} brackets",
            expected=f"at most {_LONGEST_EXPRESSION} and {_MOST_BRACKETS}",
            hint="Write it with fewer brackets and shorter names.",
        )
    return value


class ExpressionCodec(Scalar):
    """The expression of a network."""

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The expression with other names, even where it is not finished."""
        return rename_in_expression(raw, names) if isinstance(raw, str) else raw


EXPRESSION = ExpressionCodec(expression, lambda: EXPRESSION_SCHEMA)
_TAKEN = frozenset(
    (
        "layout index method other parameter point omega value standard_error improvement other_value parameter_value "
        "parameter_low parameter_high at_bound status starts agreed evaluations parameter_unit index_unit index_title "
        "improvement_error realisations over_linear over_linear_error elements method_words limit limit_unit "
        "limit_value limit_active limit_cost error_bound other_error_bound improvement_bound"
    ).split()
)


def element_name(name: Any) -> str:
    """Name valid in a network expression and not used by results themselves; raises `EntryError` for another."""
    if not NAME.fullmatch(name):
        letters = "a letter followed by letters, digits and underscores, such as k1"
        raise invalid_entry(name, fault="not a name", expected=letters)
    if name in _TAKEN:
        taken = "a word that results use themselves"
        raise invalid_entry(name, fault=taken, expected="another name, such as k1")
    return str(name)


def layout_name(name: Any) -> str:
    """A name that can stand in a table and in the name of a file."""
    if not _LAYOUT_NAME.fullmatch(name):
        joined = "_".join(name.split())
        raise invalid_entry(
            name,
            fault="not a layout name, which also names files",
            expected="up to 40 letters, digits and _ - + . that begin with a letter or a digit, "
            f"without spaces, such as {joined if _LAYOUT_NAME.fullmatch(joined) else 'S3e'}",
        )
    return str(name)


def quantity_list(values: Any) -> tuple[str, ...]:
    """The values of a sweep, one by one."""
    if not isinstance(values, list) or not 2 <= len(values) <= MOST_POINTS:
        got = f"a list of {len(values)}" if isinstance(values, list) else quote_value(values)
        example = 'k = { from = "10 kN/m", to = "300 kN/m", points = 30 } or k = ["10 kN/m", "20 kN/m"]'
        raise EntryError(got=got, expected=f"2 to {MOST_POINTS} values, as in {example}")
    return tuple(map(quantity_text, values))


SWEEP_LIST = Scalar(
    quantity_list,
    lambda: {
        **list_schema(quantity_schema()),
        "description": "Swept values: a list, or a range with its number of values.",
        "examples": [["60 kN/m", "120 kN/m", "240 kN/m"]],
        "minItems": 2,
        "maxItems": MOST_POINTS,
    },
)
