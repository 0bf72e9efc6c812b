"""Registries, and properties of all of their entries."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, make_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from study_text import assert_survives, load_text, study_text
from wang_su import ROAD

import inerter as it
from inerter import registry
from inerter.errors import MechanismError, RegistryError, StudyError, UnknownEntryError
from inerter.field_metadata import fields_of, mounts_of
from inerter.files.common.signal_kinds import unit_of
from inerter.files.study.loading import load_study
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.study import Study
from inerter.indices.registry import amplitude_of, index_settings, needed_settings
from inerter.methods.objective import Differentiable
from inerter.methods.registry import averages, nonlinearities_of, with_gradients, words_of
from inerter.registry import Registry, cache_until_registration
from inerter.report.problem_statement import vehicle_rows
from inerter.units import parse_quantity
from inerter.work.origin import origin

STRUT = it.Spring(20e3) | it.Damper(1e3)
TABLES = {"vehicle": it.VEHICLES, "index": it.INDICES, "method": it.METHODS, "element": it.ELEMENTS}


@pytest.fixture(autouse=True)
def known() -> Iterator[None]:
    """Entries removed at the end of their test do not count as sources later, as no other process has them."""
    before = dict(registry._sources)
    yield
    for added in registry._sources.keys() - before.keys():
        del registry._sources[added]
    registry._changes += 1


def row(title: str, /, **attributes: Any) -> type:
    return make_dataclass(title, [], namespace=attributes, frozen=True)


# --- tables ---


def test_a_registry_keeps_the_order_of_registration() -> None:
    table: Registry[type] = Registry("thing", "key", ("size",), (row("B", key="b", size=1), row("A", key="a", size=2)))
    third = row("Third", key="0", size=3)
    assert table.add(third) is third
    assert list(table) == ["b", "a", "0"]
    assert [each.size for each in table.values()] == [1, 2, 3]
    assert repr(table) == "<thing: b, a, 0>"
    assert table.add(third) is third
    assert table.get("c") is None
    with pytest.raises(UnknownEntryError) as caught:
        table["third"]
    assert str(caught.value) == "Unknown thing 'third'; available: b, a, 0."
    table.remove(third)
    assert (list(table), "0" in table, len(table)) == (["b", "a"], False, 2)


def test_only_the_entry_itself_is_removed() -> None:
    own = row("A", key="a")
    table: Registry[type] = Registry("thing", "key", (), (own,))
    table.remove(row("Another", key="a"))
    assert table["a"] is own


def test_loading_that_is_interrupted_begins_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else every registry would lack the entries of other distributions from then on."""
    monkeypatch.setattr(registry, "_loading", False)
    asked = []

    def entries() -> tuple[()]:
        asked.append(1)
        if len(asked) == 1:
            raise KeyboardInterrupt
        return ()

    monkeypatch.setattr(registry, "_entry_points", entries)
    with pytest.raises(KeyboardInterrupt):
        registry.load_plugins()
    registry.load_plugins()
    registry.load_plugins()
    assert len(asked) == 2


def test_values_derived_from_registries_are_recomputed_after_a_change() -> None:
    table: Registry[type] = Registry("thing", "key")
    made = []

    @cache_until_registration
    def listed() -> tuple[str, ...]:
        made.append(1)
        return tuple(table)

    assert (listed(), listed(), len(made)) == ((), (), 1)
    one = table.add(row("One", key="one"))
    assert (listed(), listed(), len(made)) == (("one",), ("one",), 2)
    table.remove(one)
    assert (listed(), len(made)) == ((), 3)


ENTRIES = {
    "function": "entry = make",
    "instance": "entry = SimpleNamespace(key=KEY, make=make)",
    "address": "entry = SimpleNamespace(key=KEY, home=f'{__name__}_code:make')",
}


@pytest.mark.parametrize("kind", ENTRIES)
def test_the_code_of_every_kind_of_entry_is_part_of_the_fingerprint(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A journal is resumed only by the code that wrote it, whether an entry is a class, a function or an address."""
    name = f"own_{kind}_entries"
    source = f"from types import SimpleNamespace\nKEY = {kind!r}\ndef make(): pass\nmake.key = KEY\n{ENTRIES[kind]}\n"
    (tmp_path / f"{name}.py").write_text(source, encoding="utf-8")
    (tmp_path / f"{name}_code.py").write_text("def make(): pass\n", encoding="utf-8")
    code = tmp_path / (f"{name}_code.py" if kind == "address" else f"{name}.py")
    monkeypatch.syspath_prepend(str(tmp_path))
    table: Registry[Any] = Registry("thing", "key")
    without = origin()
    entry = table.add(import_module(name).entry)
    assert code in registry.plugin_paths()
    known = origin()
    assert known != without
    code.write_text(code.read_text(encoding="utf-8") + "# changed\n", encoding="utf-8")
    table.remove(entry)
    assert code not in registry.plugin_paths()
    assert origin() == without
    table.add(entry)
    assert origin() not in {known, without}


def test_an_invalid_entry_is_refused_with_its_missing_attributes() -> None:
    table: Registry[type] = Registry("thing", "key", ("size", "words"), (row("A", key="a", size=2, words="w"),))
    bad = {
        r"B is not a valid thing: missing attributes words": row("B", key="b", size=1),
        r"B is not a valid thing: missing attributes key, size, words": row("B"),
        r"key must be non-empty text, got 3": row("B", key=3, size=1, words=""),
        r"another thing with the key 'a'": row("B", key="a", size=1, words=""),
        r"not a dataclass": type("B", (), {"key": "b", "size": 1, "words": ""}),
    }
    for words, each in bad.items():
        with pytest.raises(RegistryError, match=words):
            table.add(each)
    assert list(table) == ["a"]


@pytest.mark.parametrize("name", TABLES)
def test_entries_of_the_package_cannot_be_replaced(name: str) -> None:
    for known in list(TABLES[name].values()):
        copy = row("Copy", **{word: getattr(known, word) for word in dir(known) if not word.startswith("_")})
        with pytest.raises(
            RegistryError, match=rf"another {'kind of element' if name == 'element' else name} with the"
        ):
            TABLES[name].add(copy)
        assert TABLES[name].add(known) is known


@pytest.mark.parametrize("table", [*TABLES.values(), it.SIGNALS, it.PAPERS])
def test_a_key_that_is_nearly_right_is_proposed(table: Registry[Any]) -> None:
    for key in table:
        with pytest.raises(it.InerterError, match=rf"Unknown .* '{key}x'; available: .*{key}.*\. Did you mean '"):
            table[f"{key}x"]


# --- vehicles ---


def made(model: str, **changed: float) -> it.VehicleModel:
    """The vehicle of its own examples."""
    kind = it.VEHICLES[model]
    values = {f.name: parse_quantity(f.example, f.unit) for f in fields_of(kind)}
    return kind(**{**values, **dict.fromkeys(mounts_of(kind), STRUT), **changed})


@pytest.mark.parametrize("model", it.VEHICLES)
def test_the_examples_of_a_vehicle_make_one(model: str) -> None:
    vehicle = made(model)
    mounts = mounts_of(type(vehicle))  # each is one strut, or one on each side with its name before
    told = [m for s in vehicle.mechanism().struts for m in mounts if s.name == m or s.name.startswith(f"{m}_")]
    assert list(dict.fromkeys(told)) == list(mounts)
    assert set(vehicle.forces) == {force.name for force in vehicle.mechanism().forces}
    if vehicle.moved == "road":
        assert it.evaluate(vehicle, it.RideComfort(ROAD), it.Norm()).value > 0.0


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, "1 kg", True, None])
@pytest.mark.parametrize("model", it.VEHICLES)
def test_every_quantity_of_a_vehicle_is_checked(model: str, bad: Any) -> None:
    for f in fields_of(it.VEHICLES[model]):
        if bad == 0.0 == f.default:
            continue
        told = f"The {f.name.replace('_', ' ')} of the {model.replace('-', ' ')} must be a positive number of {f.unit}"
        with pytest.raises(MechanismError) as caught:
            made(model, **{f.name: bad})
        assert str(caught.value).startswith(told)


@pytest.mark.parametrize("model", it.VEHICLES)
def test_free_values_of_all_mounts_are_fixed_together(model: str) -> None:
    free = it.Spring(20e3) | it.Damper(it.free(1.0, 1e4, "c"))
    vehicle = made(model, **dict.fromkeys(mounts_of(it.VEHICLES[model]), free))
    assert list(vehicle.free_values()) == ["c"]
    assert vehicle.with_values({"c": 1e3}).free_values() == {}


def like_a_car(title: str, *given: Any, **attributes: Any) -> type:
    return make_dataclass(title, given, bases=(it.QuarterCar,), namespace={"key": "sled", **attributes}, frozen=True)


@pytest.mark.parametrize(
    ("forces", "words"),
    [
        ({"pull": "kg"}, r"Pulled has a force 'pull' in kg; a signal is in m, N, N m, m/s\^2\."),
        ({"sprung_force": "N m"}, r"Pulled has 'sprung_force' in N m, and another vehicle in N\."),
    ],
)
def test_a_force_has_one_unit_and_one_that_a_signal_has(forces: dict[str, str], words: str, added: Added) -> None:
    added(it.VEHICLES, like_a_car("Pulled", forces=forces))
    with pytest.raises(RegistryError, match=words):
        unit_of("road")


def test_a_vehicle_has_no_quantity_named_as_the_key_that_names_it(added: Added, tmp_path: Path) -> None:
    given = ("model", float, field(metadata=it.quantity("kg", "A mass.", "1 kg")))
    added(it.VEHICLES, like_a_car("Named", given))
    with pytest.raises(RegistryError, match=r"sled has a quantity 'model', a key that \[vehicle\] has already"):
        load_text(tmp_path, study_text('indices = ["J1"]'))


# --- indices ---


def test_every_setting_of_an_index_is_a_key_of_study_files(tmp_path: Path) -> None:
    assert set(index_settings()) >= {"high_pass", "force"}
    asked = [symbol for symbol in it.INDICES if not needed_settings(symbol)]
    symbols = ", ".join(f'"{symbol}"' for symbol in asked)
    lines = "\n".join(f'{key} = "{f.example}"' for key, f in index_settings().items())
    study = load_text(tmp_path, study_text(f'indices = [{symbols}]\n{lines}\nevaluate = ["expected-value"]'))
    assert study.settings == {key: parse_quantity(f.example, f.unit) for key, f in index_settings().items()}
    assert_survives(study, tmp_path)
    for symbol in asked:
        kind, index = it.INDICES[symbol], study.index(symbol)
        assert type(index) is kind
        assert [getattr(index, f.name) for f in fields_of(kind)] == [study.settings[f.key] for f in fields_of(kind)]


@pytest.mark.parametrize("symbol", it.INDICES)
def test_a_setting_without_its_index_is_told(symbol: str, tmp_path: Path) -> None:
    other = next(known for known in it.INDICES if known != symbol)
    for f in fields_of(it.INDICES[symbol]):
        path = tmp_path / "study.toml"
        path.write_text(study_text(f'indices = ["{other}"]\n{f.key} = "{f.example}"'), encoding="utf-8")
        with pytest.raises(it.InerterError, match=rf"study\.{f.key}: the {f.in_words} of {symbol}.*or no {f.key}\."):
            load_study(path)


Added = Callable[[Registry[Any], type], None]


@pytest.fixture
def added() -> Iterator[Added]:
    """Add entries to registries, for one test."""
    there: list[tuple[Registry[Any], type]] = []

    def add(table: Registry[Any], kind: type) -> None:
        there.append((table, table.add(kind)))

    yield add
    for table, kind in there:
        table.remove(kind)


def index_with(setting: str) -> type:
    """An index that has this setting, in m."""
    given = (setting, float, field(default=1.0, metadata=it.quantity("m", "A length.", "1 m")))
    words = dict.fromkeys(("title", "unit", "response", "definition"), "x")
    return make_dataclass("Other", [given], namespace={"symbol": "X1", **words}, frozen=True)


@pytest.mark.parametrize(
    ("setting", "line", "words"),
    [
        ("seed", "seed = 3", r"setting 'seed', a key that \[study\] has already"),
        ("high_pass", "", r"X1 has a setting 'high_pass' in m, and another index has it in rad/s"),
    ],
)
def test_a_setting_has_a_key_of_its_own_or_the_unit_of_its_namesake(
    setting: str, line: str, words: str, added: Added, tmp_path: Path
) -> None:
    added(it.INDICES, index_with(setting))
    with pytest.raises(RegistryError, match=words):
        load_text(tmp_path, study_text(f'indices = ["J1"]\n{line}'))


@dataclass(frozen=True)
class Heard:
    """How loud something is beside another, whatever excites it."""

    outputs: Any = field(metadata=it.typed_field("outputs", "What is heard.", "{ tyre_load = 1 }"))
    ear: str = field(metadata=it.typed_field("output", "Where.", '"sprung_velocity"'))
    cause: Any = field(metadata=it.typed_field("excitation", "Why.", "{ }", key="because"))
    hearing: Any = field(
        default=None,
        metadata=it.typed_field("filter", "How.", "{ numerator = [1.0], denominator = [1.0, 0.5] }", key="by"),
    )
    symbol, title, unit, response = "X2", "loudness", "", "gain"

    def definition(self, mechanism: it.Mechanism) -> it.IndexDefinition:
        outputs = (*(it.OutputWeight(*one) for one in self.outputs.items()), it.OutputWeight(self.ear))
        return it.IndexDefinition(outputs, it.Combination.SUM_OF_RMS, self.cause, "", self.hearing)


HEARD = """[indices.noise]
kind = "heard"
outputs = { sprung_acceleration = 0.5 }
ear = "unsprung_velocity"
because = { force = "sprung_force", intensity = "3 N^2/Hz" }
by = { numerator = [2.0], denominator = [1.0, 2.0] }
[study]"""


def test_an_index_of_another_distribution_has_settings_of_all_forms(added: Added, tmp_path: Path) -> None:
    added(it.INDICES, Heard)
    path = tmp_path / "study.toml"
    path.write_text(study_text('indices = ["noise"]').replace("[study]", HEARD), encoding="utf-8")
    study, force, low_pass = load_study(path), it.WhiteForce("sprung_force", 3.0), it.Filter([2.0], [1.0, 2.0])
    assert study.index("noise") == Heard({"sprung_acceleration": 0.5}, "unsprung_velocity", force, low_pass)
    assert study.at([]).index("noise") in {study.index("noise")}
    assert_survives(study, tmp_path)
    parts = ({"sprung_acceleration": 0.5}, {"unsprung_velocity": 1.0})
    alone = [it.RandomResponse(part, force, low_pass) for part in parts]
    car = study.design("S1")
    found, *apart = (it.evaluate(car, index, it.Norm()).value for index in (study.index("noise"), *alone))
    assert found == pytest.approx(sum(apart), rel=1e-12)
    path.write_text(path.read_text(encoding="utf-8").replace("unsprung_velocity", "unsprug_velocity"), encoding="utf-8")
    with pytest.raises(it.InerterError, match=r'indices\.noise\.ear: got "unsprug_velocity".*"unsprung_velocity"'):
        load_study(path)


@pytest.mark.parametrize(
    ("metadata", "words"),
    [
        (it.typed_field("filtre", "How.", "{ }"), r"has the form 'filtre'; forms are filter, outputs"),
        (
            it.typed_field("filter", "How.", "{ }", key="kind"),
            r"X3 has a setting 'kind', a key that \[indices\.NAME\] has",
        ),
        (it.typed_field("filter", "How.", "{ }", key="excitation"), r"X3 has a setting 'excitation', a key that"),
    ],
)
def test_a_setting_has_a_form_that_there_is_and_a_key_of_its_own(
    metadata: Any, words: str, added: Added, tmp_path: Path
) -> None:
    words_of_it = dict.fromkeys(("title", "unit", "response", "definition"), "x")
    given: list[Any] = [("road", it.Road), ("by", Any, field(default=None, metadata=metadata))]
    added(it.INDICES, make_dataclass("Third", given, namespace={"symbol": "X3", **words_of_it}, frozen=True))
    with pytest.raises(RegistryError, match=words):
        load_text(tmp_path, study_text('indices = ["J1"]'))


# --- methods ---


@pytest.mark.parametrize("name", it.METHODS)
def test_a_study_gives_a_method_what_it_takes(name: str, tmp_path: Path) -> None:
    roads = "realisations = 3\n" if averages(name) else ""
    settings = f'indices = ["J1"]\nevaluate = ["{name}"]\nseed = 7\nconventions = "paper2008"\n{roads}'
    method: Any = load_text(tmp_path, study_text(settings)).method(name, threads=2)
    given = {"conventions": "paper2008", "seed": 7, "realisations": 3, "jobs": 2}
    taken = {key: value for key, value in given.items() if hasattr(method, key)}
    assert {key: getattr(method, key) for key in taken} == taken
    assert averages(name) == ("realisations" in taken)
    assert isinstance(method.nonlinearity_support, it.NonlinearitySupport)
    assert method.description[0].islower()
    assert not method.description.endswith(".")


@pytest.fixture
def of_its_own() -> Iterator[type]:
    @dataclass(frozen=True)
    class OfItsOwn:
        length: float = field(metadata=it.quantity("m", "How far it looks.", "5 m", words="reach"))
        width: float = field(default=2.0, metadata=it.quantity("m", "How wide it looks.", "1 m", key="breadth"))
        seed: int = 0
        name = "of-its-own"
        description = "guesses"
        nonlinearity_support = it.NonlinearitySupport.BOTH
        needs_amplitude = supports_optimisation = False
        estimate = estimate_many = objective = it.Norm.estimate

    yield it.METHODS.add(OfItsOwn)  # type: ignore[arg-type]
    it.METHODS.remove(OfItsOwn)  # type: ignore[arg-type]


def test_a_method_of_the_previous_version_is_added_with_a_warning() -> None:
    @dataclass(frozen=True)
    class Older(it.Norm):
        name = "older"
        words = "older guesses"
        sees = it.NonlinearitySupport.BOTH

    class Mixin:
        sees = it.NonlinearitySupport.BOTH

    @dataclass(frozen=True)
    class Child(Mixin, it.Norm):
        name = "child"

    try:
        with pytest.warns(DeprecationWarning, match="is now") as said:
            it.METHODS.add(Older)
        assert "`Older.sees` is now `nonlinearity_support`" in str(said[1].message)
        assert (words_of("older"), nonlinearities_of("older")) == ("older guesses", it.NonlinearitySupport.BOTH)
        with pytest.warns(DeprecationWarning, match="is now"):
            it.METHODS.add(Child)
        assert nonlinearities_of("child") is it.NonlinearitySupport.BOTH
    finally:
        it.METHODS.remove(Older)
        it.METHODS.remove(Child)


def loaded(tmp_path: Path, methods: str, evaluate: str = '["norm", "of-its-own"]') -> Study:
    return load_text(tmp_path, study_text(f'indices = ["J1"]\nseed = 3\nevaluate = {evaluate}\n{methods}'))


@pytest.mark.usefixtures("of_its_own")
@given(st.floats(1e-3, 1e3), st.one_of(st.none(), st.floats(1e-3, 1e3)))
@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_method_has_the_settings_of_its_own_section(tmp_path: Path, length: float, breadth: float | None) -> None:
    wide = "" if breadth is None else f'breadth = "{breadth!r} m"\n'
    study = loaded(tmp_path, f'[methods.of-its-own]\nlength = "{length!r} m"\n{wide}')
    method: Any = study.method("of-its-own")
    assert (method.length, method.width, method.seed) == (length, breadth or 2.0, 3)
    again = tmp_path / "again.toml"
    again.write_text(write_resolved(study), encoding="utf-8")
    assert load_study(again) == study
    rows = dict(vehicle_rows(study))
    assert rows["Reach of of-its-own"].startswith(f"{length!r}\xa0m")
    assert ("Width of of-its-own" in rows) == (breadth is not None)


@pytest.mark.usefixtures("of_its_own")
def test_a_setting_of_a_method_is_missing_or_unused_in_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r'methods\.of-its-own\.length: missing; expected length = "5 m"'):
        loaded(tmp_path, "")
    with pytest.raises(StudyError, match=r"methods\.of-its-own: length of .*neither in optimise nor in evaluate"):
        loaded(tmp_path, '[methods.of-its-own]\nlength = "1 m"', '["norm"]')


def test_without_a_method_that_has_settings_there_is_no_section_for_them(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="methods: unknown key"):
        loaded(tmp_path, "[methods]", '["norm"]')


def test_methods_that_see_friction_need_to_know_how_large_a_force_is() -> None:
    """Where a row says so, a peak gain without an amplitude is refused; where not, there is a value."""
    car = it.QuarterCar(250.0, 35.0, 150e3, STRUT | it.Friction(20.0))
    assert [symbol for symbol in it.INDICES if amplitude_of(symbol)] == ["J5", "peak-response"]
    for kind in it.METHODS.values():
        if kind.needs_amplitude:
            with pytest.raises(it.InerterError, match="amplitude"):
                it.evaluate(car, it.LoadCarrying(), kind())
        else:
            assert it.evaluate(car, it.LoadCarrying(), kind()).value > 0.0


SLIPS = it.QuarterCar(180.0, 25.0, 120e3, it.Spring(20e3) | it.Damper(it.free(500.0, 5e3)) | it.Friction(20.0))


@pytest.mark.parametrize("name", [*it.METHODS])
def test_a_method_gives_gradients_if_its_row_says_so(name: str) -> None:
    kind = it.METHODS[name]
    given = kind().objective(SLIPS, it.RideComfort(ROAD))
    assert isinstance(given, Differentiable) == getattr(kind, "has_gradients", False)


def test_a_search_by_what_simulates_begins_where_a_row_with_gradients_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    @dataclass(frozen=True)
    class Sharp(it.StatisticalLinearisation):
        name = "sharp"
        nonlinearity_support = it.NonlinearitySupport.BOTH

        def objective(self, vehicle: Any, index: Any) -> Any:
            asked.append(self.conventions)
            return super().objective(vehicle, index)

    @dataclass(frozen=True)
    class Dull(it.StatisticalLinearisation):
        has_gradients = False

        def objective(self, vehicle: Any, index: Any) -> Any:
            plain = super().objective(vehicle, index)

            class Values:
                values = staticmethod(plain.values)

            return Values()

    monkeypatch.setitem(it.METHODS._entries, Sharp.name, Sharp)
    assert [method.name for method in with_gradients("exact")] == ["sharp", "statistical-linearisation", "norm"]
    found = it.optimise(SLIPS, it.RideComfort(ROAD), Dull("paper2008"), starts=4)
    assert {*asked} == {"paper2008"}
    best = it.optimise(SLIPS, it.RideComfort(ROAD), it.StatisticalLinearisation("paper2008"), starts=4)
    assert found.value == pytest.approx(best.value, rel=1e-6)
