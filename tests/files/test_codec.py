"""What is declared once is read, written, described to editors, found by place and changed there."""

from __future__ import annotations

import tomllib
from typing import Any

import pytest
from folders import EXAMPLES
from jsonschema import Draft202012Validator

from inerter.files.common.codec import INVALID, TableCodec, key, keyed_dataclass, load_tables, table_of
from inerter.files.common.codecs import NamesCodec, RowsCodec
from inerter.files.common.elements import elements_codec
from inerter.files.common.entries import TEXT, YES_OR_NO, QuantityCodec, not_negative, positive, some_of, whole, word
from inerter.files.identification.sections import identification_codec
from inerter.files.rig.sections import rig_codec
from inerter.files.simulation.sections import simulation_codec
from inerter.files.study.loading import load_study
from inerter.files.study.place import place_of
from inerter.files.study.places import number_at, places, with_numbers
from inerter.files.study.sections import study_codec
from inerter.networks.elements import Free
from inerter.registry import cache_until_registration

TABLES = {path.stem: tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(EXAMPLES.glob("*.toml"))}
STUDIES = [name for name, tables in TABLES.items() if "study" in tables]
CODECS = {"study": study_codec, "simulation": simulation_codec, "rig": rig_codec, "fit": identification_codec}


@keyed_dataclass
class Bush:
    """A rubber bush."""

    stiffness: float | Free = key(QuantityCodec("N/m", free=True), "Of the rubber.", 'stiffness = "1 kN/mm"')
    loss: float = key(not_negative("rad"), "Loss angle.", 'loss = "3 deg"', default=0.0, words="loss angle")


@keyed_dataclass
class Mounting:
    """A made-up file with an entry of every sort."""

    name: str = key(TEXT, "Name.", 'name = "engine"')
    mass: float = key(positive("kg"), "Of the engine.", 'mass = "200 kg"')
    side: str = key(word("a side", ("left", "right")), "Where it is.", 'side = "left"', default="left")
    orders: tuple[str, ...] = key(some_of("an order", ("2", "4")), "Orders.", 'orders = ["2"]', default=("2",))
    count: int = key(whole(1, 9), "How many.", "count = 4", default=4, name="number")
    bonded: bool = key(YES_OR_NO, "Whether it is bonded.", "bonded = true", default=False)
    front: Bush | None = key(table_of(Bush), "One more.", 'front = { stiffness = "1 kN/mm" }', default=None)
    bushes: dict[str, Bush] = key(NamesCodec(table_of(Bush)), "By name.", 'bushes = { a = { stiffness = "1 kN/m" } }')
    steps: tuple[Any, ...] = key(RowsCodec(table_of(Bush, make=dict)), "In turn.", "steps = []", default=())
    elements: dict[str, Any] = key(elements_codec(free=True), "Parts.", 'elements = { k = "1 kN/m" }')


MOUNTING = table_of(Mounting)
WHOLE = {
    "name": "engine",
    "mass": "200.0 kg",
    "side": "right",
    "orders": ["4", "2"],
    "number": 3,
    "bonded": True,
    "front": {"stiffness": {"from": "1000.0 N/m", "to": "2000.0 N/m"}, "loss": "0.1 rad"},
    "bushes": {"a": {"stiffness": "5.0 N/m", "loss": "0.0 rad"}, "b.c": {"stiffness": "6.0 N/m", "loss": "0.0 rad"}},
    "steps": [{"stiffness": "7.0 N/m", "loss": "0.0 rad"}],
    "elements": {"k": "1000.0 N/m", "c": {"from": "1.0 N s/m", "to": "2.0 N s/m"}},
}


def load(tables: dict[str, Any]) -> Mounting:
    found, problems = load_tables(MOUNTING, tables)
    assert [str(problem) for problem in problems] == []
    return found


def test_what_is_dumped_is_read_as_the_same():
    mounting = load(WHOLE)
    assert MOUNTING.dump(mounting) == WHOLE
    assert load(MOUNTING.dump(mounting)) == mounting
    assert (mounting.count, mounting.front.stiffness.upper) == (3, 2000.0)


def test_what_is_left_out_has_its_default():
    needed = {name: WHOLE[name] for name in ("name", "mass", "bushes", "elements")}
    mounting = load(needed)
    assert (mounting.side, mounting.orders, mounting.count, mounting.front) == ("left", ("2",), 4, None)
    assert load(MOUNTING.dump(mounting)) == mounting


def test_numbers_have_places_units_and_words_and_take_others():
    mounting = load(WHOLE)
    known = {".".join(keys): (keys, number) for keys, number in MOUNTING.numbers(mounting, "")}
    assert {place: (number.unit, number.words) for place, (_, number) in known.items()} == {
        "mass": ("kg", "mass"),
        "front.stiffness": ("N/m", "stiffness"),
        "front.stiffness.from": ("N/m", "lower bound of stiffness"),
        "front.stiffness.to": ("N/m", "upper bound of stiffness"),
        "front.loss": ("rad", "loss angle"),
        "bushes.a.stiffness": ("N/m", "stiffness of a"),
        "bushes.a.loss": ("rad", "loss angle of a"),
        "bushes.b.c.stiffness": ("N/m", "stiffness of b.c"),
        "bushes.b.c.loss": ("rad", "loss angle of b.c"),
        "elements.k": ("N/m", "k"),
        "elements.c": ("N s/m", "c"),
        "elements.c.from": ("N s/m", "lower bound of c"),
        "elements.c.to": ("N s/m", "upper bound of c"),
    }
    for place, (_, number) in known.items():
        if isinstance(number.value, float):
            other = MOUNTING.put(mounting, place.split("."), 1.25 * number.value + 0.5)
            found = {".".join(keys): one.value for keys, one in MOUNTING.numbers(other, "")}
            assert found[place] == 1.25 * number.value + 0.5
            changed = {name for name, value in found.items() if value != known[name][1].value}
            assert changed - {place.rpartition(".")[0]} == {place}  # a bound is a part of its range


def test_a_number_that_is_put_must_be_one_that_a_file_may_have():
    def light(bush):
        if bush.loss > 0.5:
            raise ValueError("a loss angle of at most 0.5 rad")
        return bush

    codec = table_of(Bush, check=light)
    bush, _ = load_tables(codec, {"stiffness": "1 kN/m"})
    assert codec.put(bush, ("loss",), 0.4).loss == 0.4
    assert load_tables(codec, {"stiffness": "1 kN/m", "loss": "0.6 rad"})[1]
    with pytest.raises(ValueError, match=r"at most 0\.5 rad"):
        codec.put(bush, ("loss",), 0.6)


def test_a_default_in_the_schema_is_written_as_in_a_file():
    default = MOUNTING.schema()["properties"]["bushes"]["additionalProperties"]["properties"]["loss"]["default"]
    assert not_negative("rad").load(default, None) == 0.0


def test_every_key_is_in_the_schema_which_takes_the_whole():
    schema = MOUNTING.schema()
    Draft202012Validator.check_schema(schema)
    assert [error.message for error in Draft202012Validator(schema).iter_errors(WHOLE)] == []
    assert list(schema["properties"]) == list(WHOLE)
    assert schema["required"] == ["name", "mass", "bushes", "elements"]
    assert (schema["properties"]["number"]["default"], schema["properties"]["mass"]["x-unit"]) == (4, "kg")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"mass": "200"}, ["mass: "]),
        ({"side": "lft"}, ['side: got "lft": not a side', 'Did you mean "left"?']),
        ({"nmber": 3}, ["nmber: unknown key; expected one of name, mass, side", 'Did you mean "number"?']),
        ({"front": 3}, ['front: got 3: not a table; expected front = { stiffness = "1 kN/mm" }.']),
        ({"front": {}}, ['front.stiffness: missing; expected stiffness = "1 kN/mm".']),
        ({"bushes": {"a": {"loss": "-1 rad"}}}, ["bushes.a.stiffness: missing", "bushes.a.loss: got", "negative"]),
        ({"steps": [{}]}, ["steps[1].stiffness: missing"]),
        ({"steps": 3}, ["steps: got 3: not a list of tables"]),
        ({"elements": {}}, ['elements: none given; expected elements = { k = "1 kN/m" }.']),
        ({"mass": "0 kg", "orders": ["2", "2"], "number": True}, ["mass: ", "orders: ", "number: "]),
    ],
)
def test_all_that_is_wrong_is_said_with_its_place(changes, said):
    found, problems = load_tables(MOUNTING, {**WHOLE, **changes})
    text = "\n".join(map(str, problems))
    assert found is INVALID
    assert [words for words in said if words not in text] == []


def declarations(table: TableCodec) -> list[tuple[str, Any]]:
    """All keys of a kind of file, with their places."""
    return [(".".join((*place, one.name)), one) for place, held in table.table_codecs(()) for one in held.keys]


@pytest.mark.parametrize("kind", CODECS)
def test_every_declared_key_has_a_schema_and_its_example_can_be_read(kind):
    codec = cache_until_registration(CODECS[kind])()
    every = declarations(codec)
    assert len(every) > 25
    for place, one in every:
        Draft202012Validator.check_schema(one.schema())
        assert one.sentence or kind != "study" or place.endswith((".from", ".to")), place
        for example in one.schema().get("examples", ()):
            assert Draft202012Validator(one.schema()).is_valid(example), place


@pytest.mark.parametrize("name", TABLES)
def test_the_schema_of_each_kind_of_file_takes_its_examples(name):
    (kind,) = [kind for kind in CODECS if kind in TABLES[name]] or ["fit"]
    errors = Draft202012Validator(CODECS[kind]().schema()).iter_errors(TABLES[name])
    assert [error.message for error in errors] == []


@pytest.mark.parametrize("name", STUDIES)
def test_each_number_of_a_study_takes_another_at_its_place_alone(name):
    study = load_study(EXAMPLES / f"{name}.toml")
    known = places(study)
    assert len(known) > 8
    for label, number in known.items():
        value = 1.01 * number.value if isinstance(number.value, float) else 123.0
        there = with_numbers(study, [(place_of(label), value)])
        assert number_at(there, place_of(label)).value == value
        found = places(there)
        others = {place for place in known if place in found and found[place].value != known[place].value}
        parts = {label, label.rpartition(".")[0], label.removeprefix("elements.").rpartition(".")[0]}
        assert others <= parts, label
