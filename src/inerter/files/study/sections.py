"""The keys of a study file, each declared once: what it may hold, a sentence, and an example."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from inerter.errors import RegistryError
from inerter.field_metadata import fields_of
from inerter.files.common.codec import (
    Codec,
    Scalar,
    TableCodec,
    key,
    keyed_dataclass,
    keys_in,
    section,
    table_of,
    without_none,
)
from inerter.files.common.codecs import ByPlaceCodec, EitherCodec, RowsCodec, by_place
from inerter.files.common.elements import elements_codec
from inerter.files.common.entries import (
    LOWER,
    MOST_POINTS,
    POSITIVE,
    SHARE,
    SHARE_SCHEMA,
    SWEEP_LIST,
    SWEPT,
    TEXT,
    UPPER,
    SomeOfFile,
    declaration_of,
    not_negative,
    one_of,
    positive,
    some_names,
    some_of,
    whole,
    word,
)
from inerter.files.common.layouts import layouts_section
from inerter.files.common.problem import invalid_entry
from inerter.files.common.roads import road_codec
from inerter.files.common.schema import words_schema
from inerter.files.common.titles import title_section
from inerter.files.common.vehicle_tables import vehicle_codec
from inerter.files.common.vehicles import models
from inerter.files.study.limits import LimitsCodec, StudyLimit
from inerter.files.study.own_indices import indices_of, own_indices_codec
from inerter.files.study.place import ELEMENTS, Sweep, place_of
from inerter.files.study.task_registry import TASKS
from inerter.formatting import format_quantity
from inerter.indices.registry import index_settings
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import DEFAULT, METHODS, methods_that, searches, with_gradients
from inerter.network_search.real_inerters import RealInerter
from inerter.networks.elements.registry import format_unit_kinds
from inerter.registry import cache_until_registration
from inerter.units import quote_value
from inerter.validation import is_number
from inerter.vehicle.registry import VEHICLES

_MOST_ROADS = 100_000
_MOST_OF_FRONT = 1000
OVER = ("mean", "worst")
_SHAFT = RealInerter()
SPACINGS = ("linear", "log")
POINTS = 25  # of a front
ROAD_EXAMPLE = 'a section [road] with speed = "25 m/s" and roughness = "5e-7 m^3/cycle"'
_NONE: dict[str, Any] = {}
_NO_ROWS: list[Any] = []


@keyed_dataclass
class SweepRange:
    """Values of a number from one end to the other."""

    lower: str = key(SWEPT, "The first value.", 'from = "10 kN/m"', name=LOWER)
    upper: str = key(SWEPT, "The last value.", 'to = "300 kN/m"', name=UPPER)
    points: int = key(whole(2, MOST_POINTS), "Number of values.", "points = 30")
    spacing: str = key(
        word("a spacing", SPACINGS), "Equal steps, or equal ratios.", 'spacing = "log"', default="linear"
    )


@keyed_dataclass
class ConditionEntry:
    """Operating condition: numbers that differ from those of the file, by key path, and its share of the time."""

    share: float = key(
        POSITIVE, "Share of the operating time, relative to the other conditions.", "share = 0.3", default=1.0
    )
    name: str | None = key(TEXT, "Name of the condition in reports.", 'name = "loaded"', default=None)
    numbers: Mapping[str, Any]


def rename_places(table: Any, names: Mapping[str, str], *, keys: Collection[str] = (), entries: bool = False) -> Any:
    """A table by places, written in either way, with other names of elements in them; `entries` as of `by_place`.

    `keys` are no places. An element whose name alone would be one of them, or a section, is named with its section.
    """
    if not isinstance(table, Mapping):
        return table
    nested = {label for label, entry in table.items() if [*by_place({label: entry}, entries=entries)] != [label]}
    kept = {*keys, *nested, *(label for label in table if label not in names)}
    renamed = {}
    for label, entry in table.items():
        place = place_of(label)
        if label == ELEMENTS and label in nested:
            renamed[label] = {_renamed_key(name, names): one for name, one in entry.items()}
        elif label in nested or label in keys or place.section != ELEMENTS:
            renamed[label] = entry
        else:
            new = _renamed_key(place.key, names)
            is_bare = label == place.key and (new == label or new not in kept)
            renamed[new if is_bare else f"{ELEMENTS}.{new}"] = entry
    return renamed


def _renamed_key(key: str, names: Mapping[str, str]) -> str:
    """A place within the section of elements, with the other name of its element."""
    first, *more = key.split(".")
    return ".".join([names.get(first, first), *more])


class ConditionCodec(TableCodec):
    """The table of a condition, whose other keys are key paths."""

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The table with other names of elements in its key paths."""
        return rename_places(raw, names, keys=self.names)


class PlacesCodec(ByPlaceCodec):
    """A table by key paths, some of them of elements."""

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The table with other names of elements in its key paths."""
        return rename_places(raw, names, entries=self.entries)


_CONDITION = ConditionCodec(
    keys_in(ConditionEntry),
    ConditionEntry,
    before=lambda table: by_place(table, entries=False),
    rest="numbers",
    about=str(ConditionEntry.__doc__),
)


_VALUES = EitherCodec(table_of(SweepRange, about=SweepRange.__doc__), SWEEP_LIST)


@dataclass(frozen=True)
class SweepsCodec(PlacesCodec):
    """Swept values of numbers of the file, by key path."""

    item: Codec = _VALUES
    entries: bool = True

    def dump(self, value: Iterable[Sweep]) -> dict[str, list[str]]:
        """All values, one by one."""
        return {sweep.label: [f"{one!r} {sweep.unit}" for one in sweep.values] for sweep in value}


def study_models() -> list[str]:
    """Vehicle models of study files: all but test rigs, whose displacement is prescribed."""
    return [model for model in models() if model not in VEHICLES or VEHICLES[model].moved != "displacement"]


def _study_model(value: Any) -> str:
    known = tuple(study_models())
    if isinstance(value, str) and value in VEHICLES and value not in known:
        raise ValueError(
            f"Got {quote_value(value)}, which has no road; expected {' or '.join(map(quote_value, known))}. "
            f"A {value.replace('-', ' ')} is for: inerter simulate."
        )
    return one_of("a vehicle model", known)(value)


def _search(value: Any) -> str:
    return one_of("an optimisation method", methods_that(searches))(value)


_SEARCH = Scalar(_search, lambda: words_schema(methods_that(searches)))
_INDICES = SomeOfFile("an index", indices_of)


def _scatter(given: Any) -> float:
    """Relative tolerance: a number, or text with a per cent sign."""
    number = given
    if isinstance(given, str) and given.rstrip().endswith("%"):
        try:
            number = float(given.rstrip()[:-1]) / 100.0
        except ValueError:
            number = None
    if not is_number(number) or not 0.0 < number < 1.0:
        raise invalid_entry(given, expected='a part of the value between 0 and 1, such as 0.1 or "10 %"')
    return float(number)


_SCATTER = Scalar(_scatter, lambda: {"anyOf": [SHARE_SCHEMA, {"type": "string", "pattern": r"%\s*$"}]})


@keyed_dataclass
class RealInerters:
    """Real inerters in the best networks of a search: friction, elastic shaft, and the methods that optimise them."""

    friction: float = key(not_negative("N"), "Friction of each inerter.", 'friction = "10 N"')
    stiffness: float = key(
        positive("N/m"), "Stiffness of the shaft in series.", 'stiffness = "1 MN/m"', default=_SHAFT.stiffness
    )
    damping: float = key(positive("N s/m"), "Damping of the shaft.", 'damping = "3.2 kN s/m"', default=_SHAFT.damping)
    given_methods: tuple[str, ...] = key(
        some_of("a method", METHODS),
        "Methods, each of which optimises the values; statistical linearisation if left out.",
        'methods = ["expected-value"]',
        default=(),
        name="methods",
    )
    best: int = key(
        whole(1, 1000),
        "Number of the best networks, in addition to the best of each number of elements.",
        "best = 3",
        default=3,
    )

    @property
    def description(self) -> str:
        """Friction and shaft, after "real inerters"."""
        return (
            f"with friction of {format_quantity(self.friction, 'N')} and a shaft of "
            f"{format_quantity(self.stiffness, 'N/m')} with {format_quantity(self.damping, 'N s/m')}"
        )

    @property
    def methods(self) -> tuple[str, ...]:
        """Methods that optimise; of the quick methods the one that models most if the file gives none."""
        return self.given_methods or (with_gradients("exact")[0].name,)

    @property
    def shaft(self) -> RealInerter:
        """The shaft of each inerter."""
        return RealInerter(self.stiffness, self.damping)


@keyed_dataclass
class Settings:
    """Indices to compute, and the methods that compute them."""

    indices: tuple[str, ...] = key(
        _INDICES,
        "Performance indices of each layout.",
        'indices = ["J1", "J3", "J5"]',
        implied='trade_off = ["J1", "J3"]',
    )
    conventions: str = key(
        word("a set of conventions", CONVENTIONS),
        "Conventions of the numbers: exact, or those of the paper of 2008.",
        'conventions = "paper2008"',
        default="exact",
    )
    optimise: str | None = key(
        _SEARCH,
        "Method whose value is minimised; required if there are design variables.",
        'optimise = "norm"',
        default=None,
    )
    evaluate: tuple[str, ...] = key(
        some_of("a method", METHODS),
        "Methods that evaluate the designs; tables and figures show the first.",
        'evaluate = ["norm", "expected-value"]',
        default=(DEFAULT,),
    )
    baseline: str | None = key(
        TEXT, "Layout that the others are compared with; the first if left out.", 'baseline = "S1"', default=None
    )
    sweeps: tuple[Sweep, ...] = key(
        SweepsCodec(),
        "Swept numbers of this file, by key path, with their values; two make a map.",
        'sweep = { k = { from = "10 kN/m", to = "300 kN/m", points = 30 } }',
        default=(),
        name="sweep",
    )
    seed: int = key(whole(0, 2**63 - 1), "Seed of the search and of the random roads.", "seed = 1", default=0)
    realisations: int | None = key(
        whole(2, _MOST_ROADS),
        "Number of random roads of methods that average; chosen by the method if left out.",
        "realisations = 20",
        default=None,
    )
    relative_error: float | None = key(
        SHARE,
        "Relative standard error to be reached by the number of roads.",
        "relative_error = 0.002",
        default=None,
    )
    budgets: tuple[str, ...] = key(
        some_names("f"),
        "Elements whose break-even value against the baseline is computed.",
        'break_even = ["f"]',
        default=(),
        name="break_even",
        former="budgets",
    )
    limits: tuple[StudyLimit, ...] = key(
        LimitsCodec(),
        "Constraints on indices (r.m.s. values and peak gains) or static stiffness that every design must satisfy.",
        'subject_to = { tyre-load = { at_most = "600 N" } }',
        default=(),
        name="subject_to",
    )
    over: str = key(
        word("a way to take an index over conditions", OVER),
        "Combination of an index over the [[conditions]].",
        'conditions = "worst"',
        default=OVER[0],
        name="conditions",
    )
    trade_off: tuple[str, ...] = key(
        _INDICES, "Two or three indices whose Pareto front is computed.", 'trade_off = ["J1", "J3"]', default=()
    )
    points: int = key(whole(3, _MOST_OF_FRONT), "Number of designs on a Pareto front.", "points = 25", default=POINTS)
    real_inerters: RealInerters | None = key(
        table_of(RealInerters, about=RealInerters.__doc__),
        "Real inerters with which inerter search optimises its best networks once more.",
        'real_inerters = { friction = "10 N", best = 3 }',
        default=None,
    )
    tolerance: Mapping[str, float] = key(
        PlacesCodec(_SCATTER),
        "Relative tolerance of each value, for the distribution of the index and its Sobol' indices.",
        'tolerance = { c = "10 %", b = "5 %" }',
        default=_NONE,
    )
    quantile: float | None = key(
        SHARE,
        "Quantile of the index over the tolerances that is minimised, in place of the nominal value.",
        "quantile = 0.95",
        default=None,
    )
    limit_quantile: float | None = key(
        SHARE,
        "Share of the designs within the tolerances that satisfies each constraint, in place of the nominal one.",
        "limit_quantile = 0.95",
        default=None,
    )


def _of_a_trade_off(table: Mapping[str, Any]) -> Mapping[str, Any]:
    """Section [study] whose `indices` default to those of `trade_off`."""
    alone = "trade_off" in table and "indices" not in table
    return {**table, "indices": table["trade_off"]} if alone else table


def _settings(**values: Any) -> dict[str, Any]:
    """The arguments of a study that its section [study] gives; those of indices, and of tasks, are together in one."""
    shared = index_settings()
    own = {name: value for name, value in values.items() if name not in shared}
    tasks = {
        row.key: row.keys(**{one.attribute: own.pop(one.attribute) for one in keys_in(row.keys)})
        for row in TASKS.values()
        if row.keys is not None
    }
    settings = without_none(**{name: value for name, value in values.items() if name in shared})
    return {**own, "settings": settings, "tasks": tasks}


def _settings_in(study: Any) -> dict[str, Any]:
    """Section [study] of a study, by attribute, without settings that have no effect or their default."""
    silent = {"over": not study.conditions, "points": not study.trade_off}
    own = {one.attribute: getattr(study, one.attribute) for one in keys_in(Settings)}
    tasks = {
        one.attribute: value
        for asked in study.tasks.values()
        for one in keys_in(asked)
        if (value := getattr(asked, one.attribute)) != one.default
    }
    return {**{name: value for name, value in own.items() if not silent.get(name)}, **study.settings, **tasks}


@cache_until_registration
def study_codec() -> TableCodec:
    """The whole file, as a dictionary by its sections.

    Raises `RegistryError` if an index has a setting whose key is one of the section's own.
    """
    own = [*keys_in(Settings), *(one for row in TASKS.values() if row.keys for one in keys_in(row.keys))]
    taken = sorted(index_settings().keys() & {one.name for one in own})
    if taken:
        raise RegistryError(f"An index has a setting {taken[0]!r}, a key that [study] has already. Choose another key.")
    settings = TableCodec(
        (*own, *(declaration_of(field, optional=True) for field in index_settings().values())),
        _settings,
        _settings_in,
        before=_of_a_trade_off,
        about=str(Settings.__doc__),
    )
    *others, last = map(quote_value, study_models())
    keys = (
        title_section("reports"),
        section(
            "vehicle",
            vehicle_codec(study_models(), _study_model, free=True),
            "Vehicle model; it determines the other keys of this section.",
            f"a section [vehicle] with model = {', '.join(others)} or {last}",
        ),
        section("road", road_codec(), "Road and speed.", ROAD_EXAMPLE, None),
        section(
            "elements",
            elements_codec(free=True, tied=True, networks=True),
            f"Elements of the struts, by names that you choose. The unit determines the kind: {format_unit_kinds()}. "
            "A value is fixed, or a design variable between two bounds. A free network is found by inerter search.",
            'a section [elements] with lines such as k = "120 kN/m"',
        ),
        layouts_section(),
        section(
            "indices",
            own_indices_codec(),
            "User-defined indices: a kind, with its settings.",
            'a section [indices.comfort] with kind = "ride-comfort"',
            _NONE,
        ),
        section(
            "conditions",
            RowsCodec(_CONDITION),
            "Numbers of this file, by key path, in one operating condition.",
            '[[conditions]] with "road.speed" = "15 m/s"',
            _NO_ROWS,
        ),
        section(
            "study",
            settings,
            "Indices to compute, and the methods that compute them.",
            'a section [study] with indices = ["J1", "J3", "J5"]',
        ),
    )
    methods = _methods()
    about = "Settings of methods, a table for each."
    return TableCodec((*keys, section("methods", methods, about, "", _NONE)) if methods.keys else keys)


def _methods() -> TableCodec:
    """Section [methods], with a table for each method that has settings."""
    with_settings = {name: fields_of(kind) for name, kind in METHODS.items() if fields_of(kind)}
    tables = {
        name: TableCodec(tuple(declaration_of(field, optional=True) for field in fields), without_none)
        for name, fields in with_settings.items()
    }
    return TableCodec(
        tuple(section(name, table, f"Settings of the method {name}.", default=_NONE) for name, table in tables.items())
    )
