"""The JSON Schema of study files: it takes what is sound, and what it refuses is refused when the file is read."""

import copy
import json
import re
import tomllib
from itertools import chain
from pathlib import Path
from random import Random

import pytest
from campaigns import sampled
from folders import EXAMPLES
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from inerter.cli.main import call
from inerter.errors import StudyError, UnitError
from inerter.files.common.entries import LOWER, UPPER
from inerter.files.common.kinds import kind_of, kinds
from inerter.files.common.schema import UNIT, USUAL, quantity_schema
from inerter.files.common.toml import as_toml
from inerter.files.study import KIND
from inerter.files.study.loading import load_study
from inerter.roads.reading import Columns
from inerter.units import parse_quantity

STUDIES = [path for path in sorted(EXAMPLES.glob("*.toml")) if "\n[study]" in path.read_text(encoding="utf-8")]
SCHEMA = KIND.schema()
EDITOR = Draft202012Validator(SCHEMA)
NUMBERS = st.one_of(
    st.floats(0.0, 1e9).map(repr),
    st.integers(0, 10**6).map(str),
    st.sampled_from(["1.", ".5", "+3", "-2", "1e3", "2E-4"]),
)
UNITS = st.sampled_from([unit for usual in USUAL.values() for unit in usual] + ["klbf/ft", "kg/s^2", "N*s/m", "N", ""])


def tables(path: Path) -> dict:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def leaves(value: object, place: tuple = ()) -> list[tuple]:
    """Places of all values that are no tables."""
    if not isinstance(value, dict):
        return [place]
    return list(chain.from_iterable(leaves(one, (*place, key)) for key, one in value.items()))


def test_it_is_a_schema_and_takes_every_example(capsys):
    """The printed schema of each kind of files takes the examples of its kind, and those of no other kind."""
    examples = [(path.name, tables(path)) for path in sorted(EXAMPLES.glob("*.toml"))]
    assert len({kind_of(table) for _, table in examples}) >= 3
    for kind in kinds():
        assert call(["schema", kind.name]) == 0
        schema = json.loads(capsys.readouterr().out)
        Draft202012Validator.check_schema(schema)
        editor = Draft202012Validator(schema)
        for name, table in examples:
            assert editor.is_valid(table) == (kind_of(table) is kind), (kind.name, name)


def test_the_schema_of_an_unknown_kind_is_refused(capsys):
    assert call(["schema", "simulate"]) == 2
    *_, said = capsys.readouterr().err.strip().splitlines()
    known = "available: study, identification, rig, simulation."
    assert said.endswith(f'Unknown kind of file "simulate"; {known} Did you mean "simulation"?')


PLAIN = {LOWER, UPPER, *Columns.__annotations__, "distance", "height"}  # in tables whose key tells all of them


def test_every_key_says_what_it_is_and_its_examples_are_sound():
    keys = 0
    for table in everything(SCHEMA):
        for name, key in table.get("properties", {}).items():
            keys += 1
            assert key.get("description") or name in PLAIN, name
            validator = EDITOR.evolve(schema=key)
            for example in key.get("examples", ()):
                assert validator.is_valid(example), (name, example)
            if UNIT in key and "examples" in key:
                assert parse_quantity(key["examples"][0], key[UNIT]) > 0.0
    assert keys > 40


def everything(schema: object) -> list[dict]:
    """All schemas within one, itself among them."""
    inner = schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else ()
    own = [schema] if isinstance(schema, dict) else []
    return own + list(chain.from_iterable(map(everything, inner)))


def test_no_entry_may_be_anything():
    """An alternative that takes all would let every mistake beside it pass."""
    several = [one for schema in everything(SCHEMA) for one in schema.get("anyOf", ())]
    assert len(several) > 20
    assert {} not in several


@pytest.mark.parametrize("unit", USUAL)
def test_usual_units_are_those_of_their_kind(unit):
    for kind, usual in USUAL.items():
        for one in usual:
            taken = re.search(quantity_schema(unit)["pattern"], f"1 {one}") is not None
            assert taken == (kind == unit)
            if taken:
                parse_quantity(f"1 {one}", unit)
            else:
                with pytest.raises(UnitError):
                    parse_quantity(f"1 {one}", unit)


@given(NUMBERS, st.sampled_from(["", " ", "  "]), UNITS, st.sampled_from(list(USUAL)))
def test_a_quantity_that_can_be_read_is_never_refused(number, space, written, unit):
    text = f"{number}{space}{written}"
    try:
        value = parse_quantity(text, unit)
    except UnitError:
        return
    assert re.search(quantity_schema(unit)["pattern"], text)
    assert re.search(quantity_schema(unit, least="positive")["pattern"], text) or value <= 0.0


@pytest.mark.parametrize(
    ("place", "entry"),
    [
        (("vehicle", "sprung_mass"), 181.75),
        (("vehicle", "sprung_mass"), "181.75"),
        (("vehicle", "sprung_mass"), "181.75 kN"),
        (("vehicle", "sprung_mass"), "-1 kg"),
        (("vehicle", "sprung_mas"), "181.75 kg"),
        (("vehicle", "model"), "half-cra"),
        (("road", "speed"), "0 m/s"),
        (("road", "roughness"), "5e-7 m^2"),
        (("elements", "k"), "120"),
        (("elements", "k"), "120 km/h"),
        (("elements", "k"), {"from": "1 kN/m"}),
        (("elements", "k"), {"kind": "springs", "stiffness": "1 kN/m"}),
        (("elements", "k"), {"kind": "spring", "stiffness": "1 kN"}),
        (("layouts", "S1"), 3),
        (("study", "indices"), []),
        (("study", "indices"), ["J1", "J1"]),
        (("study", "optimise"), "norms"),
        (("study", "seed"), -1),
        (("study", "seed"), "0"),
        (("study", "relative_error"), 1.5),
        (("study", "sweep"), {"k": {"from": "1 kN/m", "to": "2 kN/m"}}),
        (("study", "speed"), "25 m/s"),
        (("roads",), {}),
    ],
)
def test_a_mistake_is_seen_as_it_is_typed(place, entry, tmp_path):
    faulty = tables(EXAMPLES / "quarter-car.toml")
    table = faulty
    for key in place[:-1]:
        table = table[key]
    table[place[-1]] = entry
    if place != ("road", "roughness"):  # whose unit is as rare as another
        assert not EDITOR.is_valid(faulty)
    (tmp_path / "faulty.toml").write_text(as_toml(faulty), encoding="utf-8")
    with pytest.raises(StudyError):
        load_study(tmp_path / "faulty.toml")


ENTRIES = [
    "120 kN/m",
    "3 kg",
    "25 m/s",
    "1",
    7,
    -1.5,
    True,
    [],
    ["J1"],
    "k | c",
    "",
    {},
    {"from": "1 kg", "to": "2 kg"},
]


@pytest.mark.parametrize(
    "seed",
    sampled([range(150), range(150, 1000), range(1000, 5000)], [range(150)], [range(1000, 5000)]),
)
def test_what_it_refuses_cannot_be_read(seed, tmp_path):
    """Examples with an entry changed, renamed or gone."""
    refused = 0
    for number in seed:
        random = Random(number)
        changed = copy.deepcopy(tables(random.choice(STUDIES)))
        *above, last = random.choice(leaves(changed))
        table = changed
        for key in above:
            table = table[key]
        match random.randrange(3):
            case 0:
                table[last] = random.choice(ENTRIES)
            case 1:
                table[f"{last}_"] = table.pop(last)
            case _:
                del table[last]
        if not EDITOR.is_valid(changed):
            refused += 1
            path = tmp_path / "changed.toml"
            path.write_text(as_toml(changed), encoding="utf-8")
            with pytest.raises(StudyError):
                load_study(path)
    assert refused > 0.3 * len(seed)


def test_the_command_prints_it(capsys):
    assert call(["schema"]) == 0

    assert json.loads(capsys.readouterr().out) == SCHEMA
