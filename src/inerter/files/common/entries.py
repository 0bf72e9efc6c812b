"""What a single entry of a study file may be: checks that turn it into its value, or say what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple

from pydantic import PlainValidator, ValidationInfo

from inerter.files.common.kind_entry import KindEntry, kind_entry, names_kind
from inerter.files.common.problem import EntryError
from inerter.files.common.schema import checked, list_schema, or_range_schema, quantity_schema, words_schema
from inerter.files.common.sizes import check_size
from inerter.files.common.suggest import nearest
from inerter.networks.elements import NAME, Element, Free
from inerter.networks.elements.registry import kinds_by_unit, parse_element
from inerter.units import format_quantity, parse_quantity, shown, unit_in

MOST_POINTS = 10_000_000
_LONGEST_EXPRESSION = 500
_WIDEST = 1e24  # ratio of the bounds of a free value
_MOST_BRACKETS = 50  # far from the depth at which Python's stack ends
TEXT_SCHEMA: dict[str, Any] = {"type": "string", "minLength": 1, "maxLength": 200}
SHARE_SCHEMA: dict[str, Any] = {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1}
EXPRESSION_SCHEMA: dict[str, Any] = {
    "type": "string",
    "minLength": 1,
    "maxLength": _LONGEST_EXPRESSION,
    "description": "A network: | puts parts side by side, - end to end and binds tighter.",
    "examples": ['S3 = "k | c - b"'],
}
_LAYOUT_NAME_CHARACTERS = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+.")


class Amount(NamedTuple):
    """The value of an element in the SI unit that tells its kind."""

    unit: str
    value: float


def positive(unit: str) -> PlainValidator:
    """A quantity of `unit` that is greater than zero."""
    return checked(lambda text: positive_in(text, unit), lambda: quantity_schema(unit, least="positive"))


def any_quantity(unit: str) -> PlainValidator:
    """A quantity of `unit` of either sign."""
    return checked(lambda text: parse_quantity(text, unit), lambda: quantity_schema(unit))


def not_negative(unit: str) -> PlainValidator:
    """A quantity of `unit` that may be zero."""
    return checked(lambda text: not_negative_in(text, unit), lambda: quantity_schema(unit, least="not negative"))


def not_negative_in(text: Any, unit: str) -> float:
    """A quantity of `unit` that is zero or more."""
    value = check_size(parse_quantity(text, unit), text, unit)
    if value < 0.0:
        raise EntryError(got=shown(text), fault="negative", expected=f"0 {unit} or more")
    return value


def or_free(unit: str, name: str, *, may_vanish: bool) -> PlainValidator:
    """A quantity of `unit`, or a table with the two ends of a free value, which has this name."""
    ends = ("from", "to")

    def check(entry: Any) -> float | Free:
        if not isinstance(entry, dict):
            return not_negative_in(entry, unit) if may_vanish else positive_in(entry, unit)
        if set(entry) != set(ends):
            given = ", ".join(map(shown, entry)) or "nothing"
            expected = f'one value, or {{ from = "1 {unit}", to = "2 {unit}" }}'
            raise EntryError(got=f"a table with {given}", expected=expected)
        lower, upper = (Amount(unit, positive_in(entry[end], unit)) for end in ends)
        check_order(lower, upper)
        return Free(lower.value, upper.value, name)

    return checked(
        check, lambda: or_range_schema(quantity_schema(unit, least="not negative" if may_vanish else "positive"))
    )


def positive_in(text: Any, unit: str) -> float:
    """A quantity of `unit` that is greater than zero."""
    value = check_size(parse_quantity(text, unit), text, unit)
    if value <= 0.0:
        raise EntryError(got=shown(text), fault="not positive", expected=f"more than 0 {unit}")
    return value


def positive_number(value: Any) -> float:
    """A number greater than zero, without a unit."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < float("inf"):
        raise EntryError(got=shown(value), expected="a positive number without quotes, such as 1.02")
    return float(value)


def yes_or_no(value: Any) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise EntryError(got=shown(value), expected="true or false, without quotes")
    return value


def fixed_amount(text: Any) -> Amount | KindEntry:
    """An element where there is nothing to optimise."""
    if names_kind(text):
        return kind_entry(text, free=False)
    if isinstance(text, dict):
        hint = 'Write one, such as "3 kN s/m", perhaps the best that inerter run found (summary.csv).'
        raise EntryError(got="a range", fault="a simulation needs one value", hint=hint)
    return amount(text)


def amount(text: Any) -> Amount:
    """The value of an element whose kind its unit tells."""
    return _amount(text, kinds_by_unit())


def quantity_text(text: Any) -> str:
    """A number with a unit, whose kind of quantity is known when the place is that it is for."""
    unit_in(text)
    return str(text)


AMOUNT = checked(
    amount,
    lambda: {
        **quantity_schema(*kinds_by_unit(), least="not negative"),
        "description": "An element, which the unit tells, with its value; or a table with the ends of a free value.",
        "examples": [f'{kind.symbol} = "{kind.example}"' for kind in kinds_by_unit().values()],
    },
)
SWEPT = checked(quantity_text, quantity_schema)


def _amount(text: Any, known: Mapping[str, type[Element]]) -> Amount:
    unit, value = parse_element(text, known)
    check_size(value, text, unit)
    if value < 0.0 or (value == 0.0 and not known[unit].may_vanish):
        hint = "To leave the element out, drop its branch from the layouts."
        raise EntryError(got=shown(text), fault="not positive", expected=f"more than 0 {unit}", hint=hint)
    return Amount(unit, value)


def text(value: Any) -> str:
    """A title or a name."""
    if not isinstance(value, str) or not value.strip() or len(value) > 200:
        raise EntryError(got=shown(value), expected='text of 1 to 200 characters in quotes, such as "My car"')
    return value


TEXT = checked(text, lambda: TEXT_SCHEMA)


def one_of(what: str, known: Collection[str]) -> Callable[[Any], str]:
    """One of the words that this version knows, or a key of a table; `what` says what it is, with its article."""

    def check(value: Any) -> str:
        if not isinstance(value, str) or value not in known:
            available = f"not {what}; available in this version: {', '.join(shown(name) for name in known)}"
            raise EntryError(got=shown(value), fault=available, hint=nearest(value, known))
        return value

    return check


def word(what: str, known: Collection[str]) -> PlainValidator:
    """An entry that is `one_of` some words."""
    return checked(one_of(what, known), lambda: words_schema(known))


def some_of(what: str, known: Collection[str]) -> PlainValidator:
    """A list of at least one of `known`, none of them twice."""
    return _list_of(one_of(what, known), lambda: next(iter(known)), lambda: words_schema(known))


def some_of_file(what: str, known: Callable[[Mapping[str, Any]], Collection[str]]) -> PlainValidator:
    """A list of at least one of the words that are `known` in a file, none of them twice."""

    def check(values: Any, info: ValidationInfo) -> tuple[str, ...]:
        words = known(info.context or {})
        return _check_list(values, one_of(what, words), lambda: next(iter(words)))

    return checked(check, lambda: list_schema({"anyOf": [words_schema(known({})), TEXT_SCHEMA]}))


def some_names(example: str) -> PlainValidator:
    """A list of at least one name, none of them twice; whether they are known is seen later."""
    return _list_of(text, lambda: example, lambda: TEXT_SCHEMA)


def _list_of(
    one: Callable[[Any], str], example: Callable[[], str], schema: Callable[[], dict[str, Any]]
) -> PlainValidator:
    return checked(lambda values: _check_list(values, one, example), lambda: list_schema(schema()))


def _check_list(values: Any, one: Callable[[Any], str], example: Callable[[], str]) -> tuple[str, ...]:
    if not isinstance(values, list) or not values:
        got = "an empty list" if values == [] else shown(values)
        raise EntryError(got=got, expected=f"a list of one or more, such as [{shown(example())}]")
    listed = tuple(one(value) for value in values)
    twice = next((value for value in listed if listed.count(value) > 1), None)
    if twice is not None:
        raise EntryError(got=f"{shown(twice)} more than once", expected="each at most once")
    return listed


def whole(lower: int, upper: int) -> PlainValidator:
    """A whole number between two others."""

    def check(value: Any) -> int:
        if not isinstance(value, int) or isinstance(value, bool) or not lower <= value <= upper:
            raise EntryError(got=shown(value), expected=f"a whole number from {lower} to {upper}, without quotes")
        return value

    return checked(check, lambda: {"type": "integer", "minimum": lower, "maximum": upper})


def share(value: Any) -> float:
    """A number between zero and one, without a unit."""
    if not isinstance(value, float) or not 0.0 < value < 1.0:
        raise EntryError(got=shown(value), expected="a number between 0 and 1 without quotes, such as 0.01")
    return value


SHARE = checked(share, lambda: SHARE_SCHEMA)


def expression(value: Any) -> str:
    """The text of a network; whether it can be parsed is seen when all elements are known."""
    if not isinstance(value, str):
        raise EntryError(got=shown(value), expected='a network in quotes, such as "k | c - b"')
    if len(value) > _LONGEST_EXPRESSION or value.count("(") > _MOST_BRACKETS:
        raise EntryError(
            got=f"a network of {len(value)} characters with {value.count('(')} brackets",
            expected=f"at most {_LONGEST_EXPRESSION} and {_MOST_BRACKETS}",
            hint="Write it with fewer brackets and shorter names.",
        )
    return value


EXPRESSION = checked(expression, lambda: EXPRESSION_SCHEMA)
_TAKEN = frozenset(
    (
        "layout index method other parameter point omega value standard_error improvement other_value parameter_value "
        "parameter_low parameter_high at_bound status starts agreed evaluations parameter_unit index_unit index_title "
        "improvement_error realisations over_linear over_linear_error elements method_words limit limit_unit "
        "limit_value limit_active limit_cost error_bound other_error_bound improvement_bound"
    ).split()
)


def element_name(name: Any) -> str:
    """A name that can stand in an expression, and in results beside the names that are there already."""
    if not NAME.fullmatch(name):
        letters = "a letter followed by letters, digits and underscores, such as k1"
        raise EntryError(got=shown(name), fault="not a name", expected=letters)
    if name in _TAKEN:
        taken = "a word that results use themselves"
        raise EntryError(got=shown(name), fault=taken, expected="another name, such as k1")
    return str(name)


def layout_name(name: Any) -> str:
    """A name that can stand in a table and in the name of a file."""
    if not 0 < len(name) <= 40 or not _LAYOUT_NAME_CHARACTERS.issuperset(name) or name[0] in ".-+":
        raise EntryError(
            got=shown(name),
            fault="not a layout name, which also names files",
            expected="up to 40 letters, digits and _ - + . that begin with a letter or a digit, such as S3e",
        )
    return str(name)


def check_order(lower: Amount, upper: Amount) -> None:
    """Raises ValueError unless both ends have one unit and `lower` is the lower."""
    if lower.unit != upper.unit:
        raise EntryError(got=f"ends of unlike units, {lower.unit} and {upper.unit}", expected="one unit for both")
    if lower.value >= upper.value:
        equal = lower.value == upper.value
        how, remedy = ("equal", "Write a single value without from and to.") if equal else ("reversed", "Swap them.")
        first, last = (format_quantity(end.value, end.unit, digits=12) for end in (lower, upper))
        ends = f'{how} ends, from = "{first}" and to = "{last}"'
        raise EntryError(got=ends, expected="from less than to", hint=remedy)
    if lower.value > 0.0 and upper.value > _WIDEST * lower.value:
        ends = " to ".join(format_quantity(end.value, end.unit, digits=12) for end in (lower, upper))
        expected = f"an upper bound of at most {_WIDEST:g} times the lower one"
        raise EntryError(got=ends, fault="wider than a search can cover", expected=expected)


def quantity_list(values: Any) -> tuple[str, ...]:
    """The values of a sweep, one by one."""
    if not isinstance(values, list) or not 2 <= len(values) <= MOST_POINTS:
        got = f"a list of {len(values)}" if isinstance(values, list) else shown(values)
        example = 'k = { from = "10 kN/m", to = "300 kN/m", points = 30 } or k = ["10 kN/m", "20 kN/m"]'
        raise EntryError(got=got, expected=f"2 to {MOST_POINTS} values, as in {example}")
    return tuple(map(quantity_text, values))


SWEEP_LIST = checked(
    quantity_list,
    lambda: {
        **list_schema(quantity_schema()),
        "description": "Its values, one by one, or from one end to the other.",
        "examples": ['k = ["60 kN/m", "120 kN/m", "240 kN/m"]'],
        "minItems": 2,
        "maxItems": MOST_POINTS,
    },
)
