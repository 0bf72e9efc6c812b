"""Limits in a study file: `subject_to`, with indices and static stiffnesses by their names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from inerter.errors import InerterError
from inerter.files.common.codec import Codec, KeyPath, RawEntry, Scalar, key, keyed_dataclass, table_of, without_none
from inerter.files.common.codecs import ByPlaceCodec
from inerter.files.common.entries import exact_text, quantity_text
from inerter.files.common.number import Number
from inerter.files.common.problem import EntryError, Problem, at, collect_problem, invalid_entry
from inerter.files.common.schema import quantity_schema
from inerter.files.common.suggest import nearest, some
from inerter.formatting import format_quantity, format_share, in_words
from inerter.indices.definition import quantity_words
from inerter.indices.names import index_names, title_with_name
from inerter.indices.registry import INDICES, needed_settings
from inerter.methods.composite_index import IndexLike
from inerter.methods.method import constituents_of
from inerter.methods.static_stiffness import static_stiffness
from inerter.optimisation.active_constraints import ConstraintResult
from inerter.optimisation.limits import Limit, Sense, for_each, output_of
from inerter.units import PURE, are_compatible, parse_quantity, quote_value, unit_in
from inerter.vehicle.vehicle import Vehicle

if TYPE_CHECKING:
    from inerter.files.study.study import Study

_STIFFNESS, _STIFFNESS_UNIT = "static-stiffness", "N/m"
SENSES = {sense.name.lower(): sense for sense in Sense}  # by their keys
_EQUAL = "equal"
_PLACE = ("study", "subject_to")


@dataclass(frozen=True)
class StudyLimit:
    """A limit as a file says it: of what, on which side, and how much in the SI unit."""

    of: str  # the name of an index, or static-stiffness.MOUNT
    sense: str
    value: float
    unit: str

    @property
    def is_static(self) -> bool:
        """Whether the static stiffness of a strut is limited."""
        return self.of.partition(".")[0] == _STIFFNESS

    @property
    def words(self) -> str:
        """Quantity of the limit and its sense, as text."""
        return f"{self.of} {in_words(self.sense)}"

    @property
    def place(self) -> str:
        """Label of the place of its value in a study file."""
        return ".".join((*_PLACE, self.of, self.sense))

    @property
    def value_text(self) -> str:
        """Value with its unit, all digits."""
        return format_quantity(self.value, self.unit, digits=12)

    @property
    def side(self) -> str:
        """Sense and value, such as "at most 8 mm"."""
        return f"{in_words(self.sense)} {self.value_text}"

    def entry(self) -> str | float:
        """Value of the limit for the study file: a number if dimensionless, else text with the unit."""
        return self.value if are_compatible(self.unit, PURE) else exact_text(self.value, self.unit)


def _limit_text(value: Any) -> str | float:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    return quantity_text(value)


class LimitTextCodec(Scalar):
    """The value of a limit, whose unit is that of what is limited."""

    is_number: ClassVar[bool] = True

    def numbers(self, value: str | float, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The value, in the unit in which it is written."""
        unit = PURE if isinstance(value, float) else unit_in(value)
        yield (), Number(unit, words, value if isinstance(value, float) else parse_quantity(value, unit))


_LIMIT = LimitTextCodec(_limit_text, lambda: {"anyOf": [{"type": "number"}, quantity_schema()]})


@keyed_dataclass
class LimitTable:
    """Limit of an index, such as tyre-load, or of the static-stiffness of a strut."""

    at_most: str | float | None = key(
        _LIMIT, "Upper limit of the r.m.s. value, peak gain or stiffness.", 'at_most = "3 mm"', default=None
    )
    at_least: str | float | None = key(
        _LIMIT, "Lower limit of the r.m.s. value, peak gain or stiffness.", 'at_least = "1 mm"', default=None
    )
    equal: str | float | None = key(_LIMIT, "Required value.", 'equal = "120 kN/m"', default=None)


_SIDES = table_of(LimitTable, make=without_none, about=LimitTable.__doc__)


@dataclass(frozen=True)
class LimitsCodec(ByPlaceCodec):
    """The limits of a study: tables by the names of indices and static stiffnesses."""

    item: Codec = _SIDES
    example: str = 'a table such as { at_most = "600 N" }'
    entries: bool = True

    def dump(self, value: Iterable[StudyLimit]) -> dict[str, dict[str, str | float]]:
        """The values by index and side."""
        found: dict[str, dict[str, str | float]] = {}
        for limit in value:
            found.setdefault(limit.of, {})[limit.sense] = limit.entry()
        return found

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """Values of all limits, in tables of tables where their names are written without quotes."""
        for name, inside in raw.items() if isinstance(raw, Mapping) else ():
            if name in SENSES:
                yield RawEntry(_LIMIT, inside, (name,), words=in_words(name))
            else:
                for entry in self.raw_entries(inside):
                    yield replace(
                        entry,
                        keys=(name, *entry.keys),
                        words=f"{name}{'.' if len(entry.keys) > 1 else ' '}{entry.words}",
                    )

    def numbers(self, value: Any, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """Values of all limits, by index and side."""
        for limit in value:
            yield (limit.of, limit.sense), Number(limit.unit, limit.words, limit.value)

    def put(self, value: Iterable[StudyLimit], keys: Sequence[str], number: float) -> tuple[StudyLimit, ...]:
        """The limits, one of them with another value."""
        *of, sense = keys
        return tuple(
            replace(limit, value=number) if (limit.of, limit.sense) == (".".join(of), sense) else limit
            for limit in value
        )


def limits_of(
    study: Study, entries: Mapping[str, Mapping[str, str | float]]
) -> tuple[tuple[StudyLimit, ...], list[Problem]]:
    """The limits that a file sets, and what is wrong with them."""
    limits: list[StudyLimit] = []
    problems: list[Problem] = []
    if entries and study.optimise is None:
        problems.append(at(_PLACE, fault="nothing is optimised", expected='optimise = "norm", or no subject_to'))
    for of, sides in entries.items():
        with collect_problem(problems, (*_PLACE, of)):
            if not sides or ("equal" in sides and len(sides) > 1):
                raise EntryError(got=quote_value(sides) if sides else "no limit", expected="at_most, at_least or equal")
            unit = _unit(study, of)
            found = [StudyLimit(of, sense, _value(text, unit), unit) for sense, text in sides.items()]
            if len(found) > 1 and found[0].value < found[1].value:
                raise EntryError(got="at_most below at_least", expected="at_most above it, or equal")
            limits += found
    return tuple(limits), problems


def _value(text: str | float, unit: str) -> float:
    pure = isinstance(text, float) and are_compatible(unit, PURE)
    if not unit and not pure and not _is_ratio(text):
        raise invalid_entry(text, fault="a ratio has no unit", expected="a number without quotes, such as 0.3")
    value = float(text) if pure else parse_quantity(text, unit)  # type: ignore[arg-type]  # refused there
    if value <= 0.0:
        raise invalid_entry(text, fault="not positive", expected=f"more than 0 {unit}".strip())
    return value


def _is_ratio(text: str | float) -> bool:
    """Whether the unit of a quantity is none, as that of 0.3 N/N."""
    return isinstance(text, str) and are_compatible(unit_in(text), PURE)


def _unit(study: Study, of: str) -> str:
    """Unit of the limited quantity; raises `EntryError` if there is no such thing."""
    if of.partition(".")[0] == _STIFFNESS:
        mounts = _mounts(study)
        if of.partition(".")[2] not in mounts:
            which = ", ".join(f"{_STIFFNESS}.{mount}" for mount in mounts)
            raise invalid_entry(of, fault="no strut of this vehicle", expected=which)
        return _STIFFNESS_UNIT
    known = [*study.own_indices, *index_names()]
    if of not in known:
        expected = f"an index ({some(known)}), or {_STIFFNESS} of a strut"
        raise invalid_entry(of, fault="cannot be limited", expected=expected, hint=nearest(of, known))
    return study.unit(of)


def limitable(study: Study) -> dict[str, str]:
    """Unit of each quantity that a limit of the study may be on, by its name in the file.

    These are its own indices and those without required settings, on a road if it has one, and static stiffnesses.
    """
    found = {}
    for name in [*study.own_indices, *(symbol for symbol in INDICES if not needed_settings(symbol))]:
        if study.road is not None or not study.needs_road(name):
            with suppress(InerterError):  # the vehicle has no such quantity
                found[name] = study.unit(name)
    return {**found, **{f"{_STIFFNESS}.{mount}": _STIFFNESS_UNIT for mount in _mounts(study)}}


def _mounts(study: Study) -> list[str]:
    return list(next(iter(study.layouts.values())).struts)


def limited_quantity_words(study: Study, of: str, part: str = "") -> str:
    """Limited quantity in words, such as "r.m.s. suspension travel"; with the part in which it is limited."""
    section, _, mount = of.partition(".")
    known = section == _STIFFNESS
    words = f"static stiffness of {mount}" if known else title_with_name(quantity_words(study.index(of)), of)
    return f"{words}, {part}," if part else words


def limit_words(study: Study, limit: StudyLimit) -> str:
    """Limited quantity and sense of the limit, in words."""
    return f"{limited_quantity_words(study, limit.of, each_of(study, limit))} {in_words(limit.sense)}"


def limit_text(study: Study, limit: StudyLimit, value: str = "") -> str:
    """The limit in words, with this text for its value; without one, the value in SI units."""
    return f"{limit_words(study, limit)} {value or limit.value_text}{cases_clause(study, limit)}"


def cases_clause(study: Study, limit: StudyLimit) -> str:
    """Clause on the share of the designs within tolerances that satisfies a limit; empty without `limit_quantile`."""
    if study.limit_quantile is None:
        return ""
    share = f"in {format_share(study.limit_quantile, 4)} of cases"
    return f" {'with nominal values' if limit.sense == _EQUAL else share}"


def is_swept(study: Study, limit: StudyLimit) -> bool:
    """Whether the study sweeps the value of a limit."""
    return limit.place in study.swept_labels


def quantity_limited(study: Study, of: str) -> IndexLike:
    """Quantity to which a limit applies: static stiffness of a mount, or an index."""
    section, _, mount = of.partition(".")
    return static_stiffness(mount) if section == _STIFFNESS else study.index(of)


def limits_in(study: Study, layout: str) -> list[list[Limit]]:
    """The limits of a study for a layout, each in all of its conditions, at the quantile if the study has one."""
    return [
        [
            Limit(study.at_quantile(index, layout, _share(study, limit)), SENSES[limit.sense], limit.value)
            for index in study.in_each(quantity_limited(study, limit.of))
        ]
        for limit in study.limits
    ]


def _share(study: Study, limit: StudyLimit) -> float | None:
    """Probability level of the limited quantile; None for a nominal value, as that of an equality."""
    share = study.limit_quantile
    if share is None or limit.sense == _EQUAL:
        return None
    return share if SENSES[limit.sense] is Sense.AT_MOST else 1.0 - share


def all_limits(study: Study, layout: str) -> list[Limit]:
    """The limits of a study for a layout in all of its conditions, in one list."""
    return [limit for several in limits_in(study, layout) for limit in several]


def each_of(study: Study, limit: StudyLimit) -> str:
    """Parts to each of which a limit applies where its index is a sum, such as "each tyre"; else empty."""
    vehicle = study.design(next(iter(study.layouts)))
    for index in study.in_each(quantity_limited(study, limit.of)):
        several = for_each(index, vehicle)
        if outputs := list(filter(None, map(output_of, several))):
            return each_like(part_words(vehicle, outputs[0]))
    return ""


def each_like(part: str) -> str:
    """Parts of the kind of one, such as "each tyre" for "front tyre"; empty for none."""
    return f"each {part.rpartition(' ')[2]}" if part else ""


def part_words(vehicle: Vehicle, output: str) -> str:
    """The tyre or strut that an output is about, in words: "front tyre" of "tyre_front_load"; empty for no output."""
    mechanism = vehicle.mechanism()
    for parts, kind in ((mechanism.tyres, "tyre"), (mechanism.struts, "strut")):
        for part in parts:
            if output.startswith(f"{part.name}_"):
                return f"{part.name.removeprefix(f'{kind}_').replace('_', ' ')} {kind}"
    return in_words(output)


def limit_results(
    study: Study, layout: str, vehicle: Vehicle, held: tuple[ConstraintResult, ...]
) -> list[tuple[float, bool, float, str, float, float]]:
    """Value closest to each limit, whether the limit is active, sensitivity to 1 % of the limit [%], part, and errors.

    The part is the tyre or strut of that value where the limit applies to each of several, and the condition where the
    study has some; else empty. The errors are the standard error, and the largest relative one apart from sampling.
    `held` are all limited quantities of an optimum of `vehicle`, one of a layout, in the order of `limits_in`.
    """
    found, rest = [], list(held)
    labels = [f"condition {label}" for label in study.condition_labels] or [""]
    for several in limits_in(study, layout):
        where = [label for one, label in zip(several, labels, strict=True) for _ in for_each(one.of, vehicle)]
        own, rest = rest[: len(where)], rest[len(where) :]
        worst, there = max(zip(own, where, strict=True), key=lambda one: one[0].excess)
        active = [one for one in own if one.active]
        cost = float(sum(one.sensitivity for one in active))
        part = ", ".join(filter(None, (part_words(vehicle, output_of(worst.limit.of)), there)))
        errors = worst.estimate.quantity.error, worst.estimate.error_bound
        found.append((worst.value, bool(active), cost, part, *errors))
    return found


def limited_definitions(study: Study, vehicle: Vehicle) -> list[Any]:
    """Index definitions of all limited quantities for a vehicle."""
    return [
        index.definition(case.mechanism())
        for limit in study.limits
        for one in study.in_each(quantity_limited(study, limit.of))
        for case, index in constituents_of(vehicle, one)
    ]
