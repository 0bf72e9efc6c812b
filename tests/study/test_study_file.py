"""Study files: what a good one means, that it survives being written out, and what is said about a bad one."""

import ast
import contextlib
import copy
import functools
import json
import math
import operator
import re
import tomllib
from dataclasses import replace
from itertools import groupby
from pathlib import Path

import pytest
from folders import ROOT
from hypothesis import given
from hypothesis import strategies as st
from study_text import HALF_CAR, assert_survives, with_changes
from wang_su import ROAD, paper_half_car, paper_quarter_car

from inerter.errors import NetworkError, StudyError
from inerter.field_metadata import fields_of
from inerter.files.common.layouts import StrutLayout
from inerter.files.common.vehicle_tables import MECHANISM
from inerter.files.study.loading import load_study, study_of
from inerter.files.study.place import Sweep, place_of
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.study import Study, searched_layouts
from inerter.indices.registry import INDICES as INDICES_TABLE
from inerter.indices.registry import index_settings
from inerter.methods.registry import METHODS
from inerter.networks.elements import Damper, Free, Friction, Gap, Inerter, Spring
from inerter.networks.elements.registry import ELEMENTS
from inerter.signals.road import Road
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.rig import Rig

EXAMPLES = sorted(path for path in (ROOT / "examples").glob("*.toml") if "[study]" in path.read_text("utf-8"))

GOOD = """
title = "A quarter car"
[vehicle]
model = "quarter-car"
sprung_mass = "181.75 kg"
unsprung_mass = "25 kg"
tyre_stiffness = "120 kN/m"
[road]
speed = "25 m/s"
roughness = "5e-7 m^3/cycle"
[elements]
k = "60 kN/m"
c = { from = "100 N s/m", to = "100 kN s/m" }
b = "300 kg"
[layouts]
S2 = "k | c | b"
S1 = "k | c"
[study]
indices = ["J3", "J1"]
optimise = "norm"
"""

HALF = (
    f"\n[vehicle]\n{HALF_CAR}\n"
    + """[road]
speed = "90 km/h"
roughness = "5e-7 m^3/cycle"
[elements]
k = "120 kN/m"
c = { from = "100 N s/m", to = "100 kN s/m" }
c_r = "2 kN s/m"
[layouts]
alike = "k | c"
unlike = { front = "k | c", rear = "k | c_r" }
[study]
indices = ["J5"]
optimise = "norm"
"""
)


@pytest.fixture
def load(tmp_path):
    """Loads a study from text, with parts of the text replaced first; each part must be there."""

    def load_changed(text, *changes):
        path = tmp_path / "study.toml"
        path.write_bytes(text if isinstance(text, bytes) else with_changes(text, *changes).encode())
        return load_study(path)

    return load_changed


# --- what a good file means ---


def test_every_value_arrives_in_si_units_and_every_default_is_filled_in(load, tmp_path):
    assert load(GOOD) == Study(
        title="A quarter car",
        path=tmp_path / "study.toml",
        vehicle={"model": "quarter-car", "sprung_mass": 181.75, "unsprung_mass": 25.0, "tyre_stiffness": 120e3},
        road=ROAD,
        elements={
            "k": Spring(60e3, "k"),
            "c": Damper(Free(100.0, 100e3, "c"), "c"),
            "b": Inerter(300.0, "b"),
        },
        layouts={"S2": StrutLayout({"strut": "k | c | b"}), "S1": StrutLayout({"strut": "k | c"})},
        indices=("J3", "J1"),
        conventions="exact",
        optimise="norm",
        evaluate=("norm",),
        baseline="S2",
        sweeps=(),
        seed=0,
        settings={},
    )


def test_the_order_of_the_file_is_kept(load):
    study = load(GOOD)
    assert list(study.layouts) == ["S2", "S1"]
    assert list(study.elements) == ["k", "c", "b"]


def test_a_single_layout_has_no_baseline(load):
    assert load(GOOD, ('S1 = "k | c"', "")).baseline is None


def test_a_file_without_a_title_is_called_after_itself(load):
    assert load(GOOD, ('title = "A quarter car"', "")).title == "study"


def test_the_unit_tells_the_kind_of_element(load):
    study = load(GOOD, ('b = "300 kg"', 'b = "300 kg"\nf = "0 N"\ngap = "0.1 mm"'))
    assert study.elements["f"] == Friction(0.0, "f")
    assert study.elements["gap"] == Gap(1e-4, "gap")


@pytest.mark.parametrize(("text", "omega"), [("6.28 rad/s", 6.28), ("1 Hz", 2 * math.pi)])
def test_high_pass_is_an_angular_frequency(load, text, omega):
    assert load(GOOD, ("[study]", f'[study]\nhigh_pass = "{text}"')).settings["high_pass"] == pytest.approx(
        omega, rel=1e-15
    )


@pytest.mark.parametrize(
    ("sweep", "values"),
    [
        ('{ from = "10 kN/m", to = "30 kN/m", points = 3 }', (10e3, 20e3, 30e3)),
        ('{ from = "1 kN/m", to = "100 kN/m", points = 3, spacing = "log" }', (1e3, 10e3, 100e3)),
        ('["20 kN/m", "10 N/mm"]', (20e3, 10e3)),
    ],
)
def test_swept_values(load, sweep, values):
    study = load(GOOD, ("[study]", f"[study]\nsweep = {{ k = {sweep} }}"))
    (swept,) = study.sweeps
    assert swept == Sweep(place_of("k"), pytest.approx(values, rel=1e-14), "N/m", "k")
    assert (swept.values[0], swept.values[-1]) == (values[0], values[-1])


def test_a_design_of_a_quarter_car(load):
    strut = Spring(60e3, "k") | Damper(Free(100.0, 100e3, "c"), "c")
    assert load(GOOD).design("S1") == paper_quarter_car(strut)


def test_a_swept_value_replaces_the_value_of_the_element(load):
    study = load(GOOD, ("[study]", '[study]\nsweep = { k = ["20 kN/m", "10 kN/m"] }'))
    strut = Spring(20e3, "k") | Damper(Free(100.0, 100e3, "c"), "c")
    assert study.design("S1", 20e3) == paper_quarter_car(strut)
    assert study.design("S1") == load(GOOD).design("S1")


def test_places_of_all_sections_are_swept(load, tmp_path):
    """Any number of the file, by its place: each design is that of the file with the number written there."""
    for place, value, old in (
        ("vehicle.sprung_mass", "300 kg", '"181.75 kg"'),
        ("road.speed", "50 km/h", '"25 m/s"'),
        ("elements.k", "10 kN/m", '"60 kN/m"'),
        ("elements.c.to", "3 kN s/m", '"100 kN s/m"'),
    ):
        for key in (f'"{place}"', place):
            swept = load(
                GOOD, ("[study]", f'[study]\nsweep = {{ {key} = ["{value}", "1234 {value.split(" ", 1)[1]}"] }}')
            )
            written = load(GOOD, (old, f'"{value}"'))
            (sweep,) = swept.sweeps
            here = swept.at([sweep.values[0]])
            assert here == written
            assert swept.design("S1", sweep.values[0]) == written.design("S1")
            assert_survives(swept, tmp_path)


def test_two_places_are_swept_together(load, tmp_path):
    both = '{ "road.speed" = ["20 m/s", "30 m/s", "10 m/s"], k = { from = "10 kN/m", to = "40 kN/m", points = 4 } }'
    study = load(GOOD, ("[study]", f"[study]\nsweep = {both}"))
    assert [(sweep.label, sweep.unit, sweep.words) for sweep in study.sweeps] == [
        ("road.speed", "m/s", "speed"),
        ("k", "N/m", "k"),
    ]
    here = study.at([30.0, 20e3])
    assert (here.road.speed, here.elements["k"], here.sweeps) == (30.0, Spring(20e3, "k"), ())
    assert study.design("S1", 30.0, 20e3) == here.design("S1")
    with pytest.raises(StudyError, match=r"Got 1 swept values for road\.speed, k"):
        study.at([30.0])
    assert_survives(study, tmp_path)


def test_a_design_of_a_half_car(load):
    study = load(HALF)
    k, c = Spring(120e3, "k"), Damper(Free(100.0, 100e3, "c"), "c")
    car = paper_half_car(front=k | c, rear=k | Damper(2e3, "c_r"))
    assert study.design("unlike") == car
    assert study.design("alike") == replace(car, rear=k | c)
    assert list(study.design("alike").free_values()) == ["c"]


def test_a_design_says_what_it_cannot_be(load):
    study = load(GOOD)
    with pytest.raises(StudyError, match=r"'S22'; expected one of S2, S1\. Did you mean \"S2\""):
        study.design("S22")
    with pytest.raises(StudyError, match="no sweep"):
        study.design("S1", 1e3)
    swept = load(GOOD, ("[study]", '[study]\nsweep = { k = ["20 kN/m", "10 kN/m"] }'))
    with pytest.raises(NetworkError, match="positive"):
        swept.design("S1", -1.0)


def test_an_element_may_be_unused_or_used_twice(load):
    study = load(GOOD, ('S1 = "k | c"', 'S1 = "k | k - c"'), ('b = "300 kg"', 'b = "300 kg"\nidle = "1 N"'))
    assert [element.name for element in study.design("S1").strut.elements()] == ["k", "k", "c"]


def test_a_byte_order_mark_and_windows_lines_are_read(load):
    assert load(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode()) == load(GOOD)


# --- there and back ---


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_load_build_and_survive_being_written(path, tmp_path):
    study = load_study(path)
    for layout in study.layouts:
        assert bool(study.design(layout).free_values()) or layout in searched_layouts(study)
    assert_survives(study, tmp_path)


def test_there_are_examples():
    assert {path.stem for path in EXAMPLES} >= {"quarter-car", "half-car", "stiffness-sweep"}


def test_every_setting_survives_being_written(load, tmp_path):
    settings = """[study]
high_pass = "1 Hz"
seed = 7
conventions = "paper2008"
baseline = "S1"
sweep = { k = { from = "1 N/m", to = "3 N/m", points = 11, spacing = "log" } }
"""
    names = ('S1 = "k | c"', 'S1 = "k | c"\n"S.3+" = "(k | c) - b"')
    title = ('"A quarter car"', r'"\"Käfer\" \\ 🚗 \u00e9"')
    study = load(GOOD, ("[study]", settings), names, title)
    assert study.title == '"Käfer" \\ 🚗 é'
    assert_survives(study, tmp_path)


def test_a_study_is_the_same_study_in_other_units_and_another_place(load, tmp_path):
    other = tmp_path / "elsewhere.toml"
    other.write_text(GOOD.replace("60 kN/m", "60 N/mm").replace("25 m/s", "90 km/h"), encoding="utf-8")
    assert load_study(other).to_tables() == load(GOOD).to_tables()


@pytest.mark.parametrize("roads", ["realisations = 12", "relative_error = 0.003"])
def test_settings_of_methods_arrive_and_survive_being_written(load, tmp_path, roads):
    study = load(
        GOOD,
        *FRICTION,
        asked(f'{roads}\nforce = "1.5 kN"\nbreak_even = ["f", "b"]\nbaseline = "S1"', "J5"),
    )
    assert (study.realisations, study.relative_error) in ((12, None), (None, 0.003))
    assert (study.settings["force"], study.budgets, study.methods) == (1500.0, ("f", "b"), ("norm", "expected-value"))
    assert_survives(study, tmp_path)


def test_the_former_name_of_a_key_is_read_and_the_new_one_is_written(load, tmp_path):
    settings = ('break_even = ["b"]', 'budgets = ["b"]')
    new, old = (load(GOOD, asked(f'baseline = "S1"\n{line}')) for line in settings)
    assert new.budgets == ("b",)
    assert new == old
    assert write_resolved(new) == write_resolved(old)
    assert_survives(old, tmp_path)
    with pytest.raises(StudyError) as caught:
        load(GOOD, asked("\n".join(['baseline = "S1"', *settings])))
    assert "study.budgets: given together with break_even" in str(caught.value)
    with pytest.raises(StudyError) as caught:
        load(GOOD, asked('baseline = "S1"\nbudgets = ["zz"]'))
    assert 'study.budgets: "zz"' in str(caught.value)


@given(st.lists(st.floats(1e-49, 1e49), min_size=7, max_size=7), st.integers(0, 2**63 - 1))
def test_any_values_survive_to_the_last_bit(tmp_path_factory, numbers, seed):
    mass, wheel, tyre, speed, k, low, omega = numbers
    study = Study(
        title="t",
        path=Path("t.toml"),
        vehicle={"model": "quarter-car", "sprung_mass": mass, "unsprung_mass": wheel, "tyre_stiffness": tyre},
        road=Road(roughness=k, speed=speed),
        elements={"k": Spring(k, "k"), "c": Damper(Free(low, 2 * low, "c"), "c"), "b": Inerter(mass, "b")},
        layouts={"S": StrutLayout({"strut": "k | c | b"})},
        indices=("J3",),
        optimise="norm",
        sweeps=(Sweep(place_of("k"), (tyre, 2 * tyre), "N/m", "k"),),
        seed=seed,
        settings={"high_pass": omega},
    )
    assert_survives(study, tmp_path_factory.mktemp("study"))


# --- what the page says, and what else knows a row ---


def test_the_tables_of_the_page_are_those_of_the_rows():
    page = (ROOT / "docs" / "study-file.md").read_text(encoding="utf-8")
    judged = {model: kind for model, kind in VEHICLES.items() if kind.moved != Rig.moved}
    for model, kind in judged.items():
        by_unit = groupby(fields_of(kind), key=lambda field: field.unit)
        told = [f"{', '.join(f'`{field.key}`' for field in some)} [{unit}]" for unit, some in by_unit]
        assert f"| | {model.replace('-', ' ')} | {', '.join(told)} |" in page
    assert f"| `model` | {' or '.join(f'`{json.dumps(model)}`' for model in (*judged, MECHANISM))} |" in page
    assert f"| `indices` | any of {', '.join(f'`{json.dumps(symbol)}`' for symbol in INDICES_TABLE)} |" in page
    for key, field in index_settings().items():
        sentence = field.sentence.partition(";")[0].removesuffix(".")
        told = (
            f"| | `{key}` | {sentence[0].lower()}{sentence[1:]} [{field.unit}], such as `{json.dumps(field.example)}`;"
        )
        assert told in page
    methods = page[page.index("## Methods") :]
    assert re.findall(r'^[|] `"([a-z-]+)"` [|]', methods, re.MULTILINE) == list(METHODS)


SOURCES = [path for path in (ROOT / "src" / "inerter").rglob("*.py") if "papers" not in path.parts]


def nodes_of(path, words):
    """The nodes of a module, if it has one of these words: to parse all modules takes seconds."""
    source = path.read_text(encoding="utf-8")
    whole = re.sub(r'"[\s\\]+f?"', "", source)  # sentences that are written over several lines
    return ast.walk(ast.parse(source)) if any(word in whole for word in words) else ()


def test_no_module_but_its_own_names_a_row():
    """Papers do, and the section [rig] has the name of a vehicle."""
    keys = {*INDICES_TABLE, *METHODS, *VEHICLES}
    named = {key: set() for key in keys}
    for path in SOURCES:
        for node in nodes_of(path, [f'"{key}"' for key in keys]):
            if isinstance(node, ast.Constant) and node.value in keys:
                named[node.value].add(path.parent.name)
    assert len(SOURCES) > 200
    assert named.pop(Rig.key) == {"vehicle", "rig"}
    assert {key: places for key, places in named.items() if places not in ({"vehicle"}, {"indices"}, {"methods"})} == {}


def test_no_sentence_lists_elements_by_hand_and_no_search_a_method():
    told = [f"{kind.unit} {kind.key}" for kind in ELEMENTS.values()]
    methods = {kind.__name__ for kind in METHODS.values()}
    lists, names = set(), set()
    for path in SOURCES:
        for node in nodes_of(path, [*told, *methods]) if "methods" not in path.parts else ():
            if (
                isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and any(one in node.value for one in told)
            ):
                lists.add(path.name)
            if isinstance(node, ast.Name) and node.id in methods:
                names.add((path.name, node.id))
    assert len(told) >= 5
    assert lists == {"registry.py"}  # an example of what it tells
    assert names == {("optimise.py", "Norm")}  # the best linear design, beside which that of another method is told


# --- what is said about a bad one: the file, the place, and the words that help ---

C = 'c = { from = "100 N s/m", to = "100 kN s/m" }'
INDICES = 'indices = ["J3", "J1"]'


FRICTION = (('"k | c | b"', '"k | c | b | f"'), ('b = "300 kg"', 'b = "300 kg"\nf = "10 N"'))


def asked(settings, index="J1", how="expected"):
    """The settings of a study that simulates, or linearises statistically, and more of them."""
    method = {"expected": "expected-value", "statistical": "statistical-linearisation"}[how]
    return INDICES, f'indices = ["{index}"]\nevaluate = ["{method}"]\n{settings}'


def sweep(text):
    return (INDICES, f"{INDICES}\nsweep = {text}")


BAD = {
    # quantities
    "no unit": (
        [('"300 kg"', '"3000"')],
        "elements.b",
        ['"3000"', "unit missing", "N/m, N s/m, kg, N, m", '"3000 N s/m"'],
    ),
    "number": ([('"300 kg"', "300")], "elements.b", ["300", "unit missing"]),
    "true": ([('"300 kg"', "true")], "elements.b", ["true", "not a quantity"]),
    "date": ([('"300 kg"', "2008-05-01")], "elements.b", ["2008-05-01", "not a quantity"]),
    "huge number": ([('"300 kg"', "9" * 400)], "elements.b", ["unit missing"]),
    "unknown unit": ([('"300 kg"', '"300 kq"')], "elements.b", ['"kq"', "unknown unit"]),
    "no element's unit": ([('"300 kg"', '"300 N m"')], "elements.b", ["not the unit of any element", "inerter", "gap"]),
    "wrong unit": ([('"181.75 kg"', '"181.75 N"')], "vehicle.sprung_mass", ["incompatible unit", '"181.75 kg"']),
    "speed in metres": ([('"25 m/s"', '"25 m"')], "road.speed", ["incompatible unit", '"25 m/s"']),
    "roughness in square metres": (
        [("5e-7 m^3/cycle", "5e-7 m^2")],
        "road.roughness",
        ["incompatible unit", "m^3/cycle"],
    ),
    "vehicle number": ([('"25 kg"', "25")], "vehicle.unsprung_mass", ["unit missing", '"25 kg"']),
    "comma": ([('"300 kg"', '"300,5 kg"')], "elements.b", ["comma"]),
    "nan": ([('"300 kg"', '"nan kg"')], "elements.b", ["not a finite number"]),
    "infinite": ([('"181.75 kg"', '"inf kg"')], "vehicle.sprung_mass", ["not a finite number"]),
    "bare nan": ([('"300 kg"', "nan")], "elements.b", ["unit missing"]),
    "negative element": ([('"300 kg"', '"-300 kg"')], "elements.b", ["not positive", "leave the element out"]),
    "zero element": ([('"60 kN/m"', '"0 kN/m"')], "elements.k", ["not positive", "more than 0 N/m"]),
    "negative friction": ([('"300 kg"', '"-3 N"')], "elements.b", ["not positive"]),
    "negative mass": ([('"181.75 kg"', '"-1 kg"')], "vehicle.sprung_mass", ["not positive", "more than 0 kg"]),
    "zero speed": ([('"25 m/s"', '"0 m/s"')], "road.speed", ["not positive"]),
    "underflow": ([('"300 kg"', '"1e-400 kg"')], "elements.b", ["not positive"]),
    # free values
    "reversed": ([(C, 'c = { from = "2 N s/m", to = "1 N s/m" }')], "elements.c", ["reversed", '"2 N s/m"', "less"]),
    "equal": ([(C, 'c = { from = "2 N s/m", to = "2 N s/m" }')], "elements.c", ["equal", "single value"]),
    "unlike": ([(C, 'c = { from = "2 N s/m", to = "9 N/m" }')], "elements.c", ["unlike units", "N s/m", "N/m"]),
    "no upper": ([(C, 'c = { from = "2 N s/m" }')], "elements.c.to", ["missing", 'to = "2 kN s/m"']),
    "zero lower": ([(C, 'c = { from = "0 N s/m", to = "1 N s/m" }')], "elements.c.from", ["not positive"]),
    "lower word": ([(C, 'c = { frm = "1 kg", to = "2 kg" }')], "elements.c.frm", ["unknown key", '"from"']),
    "list": ([(C, 'c = ["1 N s/m", "2 N s/m"]')], "elements.c", ["a list"]),
    # names
    "element name": ([('b = "300 kg"', '"2b" = "300 kg"')], "elements.2b", ["not a name", "letter"]),
    "dash in name": ([('b = "300 kg"', 'b-1 = "300 kg"')], "elements.b-1", ["not a name"]),
    "newline in name": ([('b = "300 kg"', '"b\\n" = "300 kg"')], 'elements."b\\n"', ["not a name"]),
    "layout name": ([('S1 = "k | c"', '"../S1" = "k | c"')], 'layouts."../S1"', ["not a layout name"]),
    "space in layout name": (
        [('S1 = "k | c"', '"S1 soft" = "k | c"')],
        'layouts."S1 soft"',
        ["without spaces, such as S1_soft."],
    ),
    # layouts
    "undefined": ([('"k | c | b"', '"k | c | cs"')], "layouts.S2", ['"cs"', "not in [elements]", "k, c, b"]),
    "syntax": ([('"k | c | b"', '"k | | b"')], "layouts.S2", ["column 5", "element name or '(' expected"]),
    "character": ([('"k | c | b"', '"k + c"')], "layouts.S2", ["column 3", "'+'"]),
    "bracket": ([('"k | c | b"', '"k | (c - b"')], "layouts.S2", ["column 11", "')'"]),
    "empty": ([('"k | c | b"', '""')], "layouts.S2", ["empty", "k | c - b"]),
    "number for layout": ([('"k | c | b"', "3")], "layouts.S2", ["got 3", "a network in quotes"]),
    "deep": ([('"k | c | b"', f'"{"(" * 90}k{")" * 90}"')], "layouts.S2", ["90 brackets", "fewer"]),
    "no layouts": ([('S2 = "k | c | b"\nS1 = "k | c"', "")], "layouts", ["none given", 'S1 = "k | c"']),
    "two struts": ([('"k | c | b"', '{ front = "k", rear = "c" }')], "layouts.S2", ["a table", "one strut"]),
    "one axle": ([('"k | c | b"', '{ front = "k" }')], "layouts.S2", ["a table", "one strut"]),
    "axle name": ([('"k | c | b"', '{ fornt = "k", rear = "k" }')], "layouts.S2", ["a table", "one strut"]),
    # keys and sections
    "top key": ([("title", "titel")], "titel", ["unknown key", 'Did you mean "title"?']),
    "section": ([("[road]", "[raod]")], "raod", ["unknown key", 'Did you mean "road"?']),
    "section missing": (
        [('[road]\nspeed = "25 m/s"\nroughness = "5e-7 m^3/cycle"\n', "")],
        "road",
        ["missing, but J3, J1 need it", "[road]", "speed"],
    ),
    "section misspelt": ([("[road]", "[raod]")], "raod", ["unknown key", 'Did you mean "road"?']),
    "vehicle key": ([("unsprung_mass", "unsprng_mass")], "vehicle.unsprng_mass", ['Did you mean "unsprung_mass"?']),
    "key missing": ([('sprung_mass = "181.75 kg"\n', "")], "vehicle.sprung_mass", ["missing", '"181.75 kg"']),
    "half car's key": ([('"25 kg"', '"25 kg"\npitch_inertia = "1 kg m^2"')], "vehicle.pitch_inertia", ['"half-car"']),
    "misplaced": ([("[elements]", "seed = 3\n[elements]")], "road.seed", ["unknown key", "belongs in [study]"]),
    "not a section": ([("[vehicle]", "road = 3\n[vehicle]"), ("[road]", "[r]")], "road", ["got 3", "not a table"]),
    "model": ([('"quarter-car"', '"quarter_car"')], "vehicle.model", ['"half-car"', 'Did you mean "quarter-car"?']),
    "no model": ([('model = "quarter-car"', "")], "vehicle.model", ["missing", 'model = "quarter-car"']),
    "rig": ([('"quarter-car"', '"rig"')], "vehicle.model", ["no road", '"half-car"', "inerter simulate"]),
    "simulation": ([("[study]", "[signal]\n[study]")], "signal", ["unknown key", "inerter simulate"]),
    "model number": ([('"quarter-car"', "4")], "vehicle.model", ["got 4", "available in this version"]),
    "title": ([('"A quarter car"', '" "')], "title", ["expected text"]),
    "title with a null": ([('"A quarter car"', '"a\\u0000b"')], "title", ["contains a control character"]),
    "title that colours a terminal": ([('"A quarter car"', '"\\u001b[31m"')], "title", ["a control character"]),
    # settings
    "index": ([('"J3", "J1"', '"J3", "J2"')], "study.indices", ['"J2"', '"J1", "J3", "J5"', "this version"]),
    "index twice": ([('"J3", "J1"', '"J3", "J3"')], "study.indices", ['"J3"', "more than once"]),
    "no index": ([('["J3", "J1"]', "[]")], "study.indices", ["empty list", '["J1"]']),
    "index word": ([('["J3", "J1"]', '"J3"')], "study.indices", ['"J3"', "expected a list"]),
    "indices missing": ([(INDICES, "")], "study.indices", ["missing", '["J1", "J3", "J5"]']),
    "optimise": ([('optimise = "norm"', 'optimise = "nrom"')], "study.optimise", ['"nrom"', 'Did you mean "norm"?']),
    "evaluate": (
        [(INDICES, INDICES + '\nevaluate = ["norm", "expected-values"]')],
        "study.evaluate",
        ['"expected-values"', "available in this version", '"norm"', 'Did you mean "expected-value"?'],
    ),
    # roads, forces, gaps and budgets
    "one road": ([asked("realisations = 1")], "study.realisations", ["got 1", "from 2 to"]),
    "half a road": ([asked("realisations = 2.5")], "study.realisations", ["got 2.5", "whole number"]),
    "error unit": ([asked('relative_error = "1 %"')], "study.relative_error", ['"1 %"', "without quotes", "0.01"]),
    "error of one": ([asked("relative_error = 1")], "study.relative_error", ["got 1", "between 0 and 1"]),
    "roads and error": (
        [asked("realisations = 4\nrelative_error = 0.01")],
        "study.relative_error",
        ["got 0.01", "realisations = 4", "one of the two"],
    ),
    "idle roads": (
        [(INDICES, INDICES + "\nrealisations = 4")],
        "study.realisations",
        ["no method averages", '"expected-value"', '"approximate-linear"'],
    ),
    "no force": ([*FRICTION, asked("", "J5")], "study.force", ["missing", "expected-value", "S2", 'force = "1 kN"']),
    "force unit": ([asked('force = "1 kN/m"', "J5")], "study.force", ["incompatible unit", '"1 kN"']),
    "idle force": ([asked('force = "1 kN"')], "study.force", ["J5", "in indices", "no force"]),
    "gap": (
        [
            ('"k | c | b"', '"k | c | (b - g)"'),
            ('b = "300 kg"', 'b = "300 kg"\ng = "1 mm"'),
            asked("", how="statistical"),
        ],
        "study.evaluate",
        ["no answer for a gap, as in S2", '"expected-value"'],
    ),
    "budget unknown": (
        [asked('break_even = ["bb"]')],
        "study.break_even",
        ['"bb"', "not in [elements]", 'Did you mean "b"?'],
    ),
    "budget twice": ([asked('break_even = ["b", "b"]')], "study.break_even", ['"b"', "more than once"]),
    "budget word": ([asked('break_even = "b"')], "study.break_even", ['"b"', "expected a list"]),
    "budget of the baseline": (
        [asked('break_even = ["b"]\nbaseline = "S2"')],
        "study.break_even",
        ["no layout but the baseline has b"],
    ),
    "budget alone": ([('S1 = "k | c"', ""), asked('break_even = ["b"]')], "study.break_even", ["only one layout"]),
    "budget and sweep": (
        [asked('break_even = ["b"]\nbaseline = "S1"\nsweep = { k = ["1 N/m", "2 N/m"] }')],
        "study.break_even",
        ["together with a sweep"],
    ),
    "budget and condition": (
        [
            asked('break_even = ["b"]\nbaseline = "S1"'),
            ("[study]", '[[conditions]]\n"elements.b" = "200 kg"\n[[conditions]]\n[study]'),
        ],
        "study.break_even",
        ["a condition changes b"],
    ),
    "sweep that norm cannot see": (
        [*FRICTION, (INDICES, INDICES + '\nsweep = { f = ["10 N", "20 N"] }')],
        "study.sweep.f",
        ["f is a friction element", '"expected-value"'],
    ),
    "condition that norm cannot see": (
        [*FRICTION, ("[study]", '[[conditions]]\nf = "20 N"\n[study]')],
        "conditions[1].f",
        ["f is a friction element", '"expected-value"'],
    ),
    "budget that norm cannot see": (
        [*FRICTION, (INDICES, INDICES + '\nbaseline = "S1"\nbreak_even = ["f"]')],
        "study.break_even",
        ["f is a friction element", '"expected-value"'],
    ),
    "conventions": ([(INDICES, INDICES + '\nconventions = "paper"')], "study.conventions", ['"paper2008"']),
    "seed": ([(INDICES, INDICES + "\nseed = -1")], "study.seed", ["got -1", "whole number"]),
    "seed text": ([(INDICES, INDICES + '\nseed = "1"')], "study.seed", ['got "1"', "without quotes"]),
    "high pass unit": ([(INDICES, INDICES + '\nhigh_pass = "1 s"')], "study.high_pass", ["incompatible unit", "rad/s"]),
    "idle high pass": (
        [(INDICES, 'indices = ["J1"]\nhigh_pass = "1 Hz"')],
        "study.high_pass",
        ["filter of J3", "not in indices"],
    ),
    "baseline": ([(INDICES, INDICES + '\nbaseline = "S9"')], "study.baseline", ['"S9"', "S2, S1"]),
    "nothing optimises": ([('optimise = "norm"', "")], "study.optimise", ["missing", "free values, c;", '"norm"']),
    "nothing is free": ([(C, 'c = "3 kN s/m"')], "study.optimise", ['"norm"', "no layout has a free value"]),
    "free but unused": (
        [('"k | c | b"', '"k | b"'), ('"k | c"', '"k"')],
        "study.optimise",
        ["no layout has a free value"],
    ),
    # sweeps
    "sweep unknown": ([sweep('{ q = ["1 N/m", "2 N/m"] }')], "study.sweep.q", ["not in [elements]", "k, c, b"]),
    "sweep free": ([sweep('{ c = ["1 N s/m", "2 N s/m"] }')], "study.sweep.c", ["c is free", "fixed value"]),
    "sweep unused": (
        [sweep('{ f = ["1 N", "2 N"] }'), ('b = "300 kg"', 'b = "300 kg"\nf = "3 N"')],
        "study.sweep.f",
        ["in no layout"],
    ),
    "sweep unit": ([sweep('{ k = ["1 kg", "2 kg"] }')], "study.sweep.k", ["in kg", "k is in N/m"]),
    "sweep units": ([sweep('{ k = ["1 N/m", "2 kg"] }')], "study.sweep.k", ["unlike units"]),
    "sweep twice": ([sweep('{ k = ["1 N/m", "1 N/m"] }')], "study.sweep.k", ["same value"]),
    "sweep of one": ([sweep('{ k = ["1 N/m"] }')], "study.sweep.k", ["list of 1", "expected 2 to 10000"]),
    "sweep of zero": ([sweep('{ k = ["0 N/m", "1 N/m"] }')], "study.sweep.k", ["not positive"]),
    "sweep word": ([sweep('{ k = "10 kN/m" }')], "study.sweep.k", ['"10 kN/m"', "points = 30"]),
    "sweep text": ([sweep('"k"')], "study.sweep", ["not a table", "points = 30"]),
    "no sweep": ([sweep("{}")], "study.sweep", ["0 swept elements", "exactly one"]),
    "three sweeps": (
        [sweep('{ k = ["1 N/m", "2 N/m"], b = ["1 kg", "2 kg"], road.speed = ["1 m/s", "2 m/s"] }')],
        "study.sweep",
        ["3 swept elements", '"k", "b"', "one, or two"],
    ),
    "the same sweep twice": (
        [sweep('{ k = ["1 N/m", "2 N/m"], "elements.k" = ["1 N/m", "2 N/m"] }')],
        "study.sweep",
        ["k twice", "two different key paths"],
    ),
    "a map of too many points": (
        [
            sweep(
                '{ k = { from = "1 N/m", to = "2 N/m", points = 10000 },'
                ' b = { from = "1 kg", to = "2 kg", points = 1001 } }'
            )
        ],
        "study.sweep",
        ["10010000 points", "at most 10000000"],
    ),
    "sweep of no place": (
        [sweep('{ "rode.speed" = ["1 m/s", "2 m/s"] }')],
        'study.sweep."rode.speed"',
        ['"road.speed"'],
    ),
    "sweep of no number": (
        [sweep('{ "vehicle.sprung_mas" = ["1 kg", "2 kg"] }')],
        'study.sweep."vehicle.sprung_mas"',
        ["no number at vehicle.sprung_mas", 'Did you mean "vehicle.sprung_mass"?'],
    ),
    "sweep of another car's number": (
        [sweep('{ "vehicle.pitch_inertia" = ["1 kg m^2", "2 kg m^2"] }')],
        'study.sweep."vehicle.pitch_inertia"',
        ["no number at vehicle.pitch_inertia", "vehicle.sprung_mass"],
    ),
    "sweep of a word": (
        [sweep('{ "vehicle.model" = ["1 kg", "2 kg"] }')],
        'study.sweep."vehicle.model"',
        ["no number"],
    ),
    "sweep of a section": ([sweep('{ road = ["1 kg", "2 kg"] }')], "study.sweep.road", ["not in [elements]"]),
    "sweep of a place in another unit": (
        [sweep('{ "road.speed" = ["1 m", "2 m"] }')],
        'study.sweep."road.speed"',
        ["values in m", "road.speed is in m/s"],
    ),
    "sweep of no speed": (
        [sweep('{ "road.speed" = ["0 m/s", "2 m/s"] }')],
        'study.sweep."road.speed"',
        ["not positive"],
    ),
    "sweep of a number": ([sweep('{ "road.speed" = [10, 20] }')], 'study.sweep."road.speed"', ["unit missing"]),
    "sweep in no unit": ([sweep('{ "road.speed" = ["1 xyz/s", "2 xyz/s"] }')], 'study.sweep."road.speed"', ['"xyz/s"']),
    "sweep of bounds beyond each other": (
        [sweep('{ "elements.c.to" = ["1 N s/m", "200 kN s/m"] }')],
        'study.sweep."elements.c.to"',
        ["lower < upper"],
    ),
    "sweep of a setting of no index": (
        [sweep('{ "study.high_pass" = ["1 Hz", "2 Hz"] }'), ('"J3", "J1"', '"J1"')],
        "study.high_pass",
        ["not in indices"],
    ),
    "one point": (
        [sweep('{ k = { from = "1 N/m", to = "2 N/m", points = 1 } }')],
        "study.sweep.k.points",
        ["got 1", "from 2 to 10000"],
    ),
    "too many points": (
        [sweep('{ k = { from = "1 N/m", to = "2 N/m", points = 10000001 } }')],
        "study.sweep.k.points",
        ["got 10000001"],
    ),
    "half a point": (
        [sweep('{ k = { from = "1 N/m", to = "2 N/m", points = 2.5 } }')],
        "study.sweep.k.points",
        ["got 2.5", "whole number"],
    ),
    "no points": ([sweep('{ k = { from = "1 N/m", to = "2 N/m" } }')], "study.sweep.k.points", ["missing"]),
    "sweep reversed": (
        [sweep('{ k = { from = "2 N/m", to = "1 N/m", points = 5 } }')],
        "study.sweep.k",
        ["reversed"],
    ),
    "spacing": (
        [sweep('{ k = { from = "1 N/m", to = "2 N/m", points = 5, spacing = "lin" } }')],
        "study.sweep.k.spacing",
        ['"lin"', '"linear", "log"'],
    ),
    "log from zero": (
        [
            sweep('{ b = { from = "0 N", to = "2 N", points = 5, spacing = "log" } }'),
            ('b = "300 kg"', 'b = "300 N"'),
        ],
        "study.sweep.b",
        ["from zero", '"linear"'],
    ),
}


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ('{ front = "k" }', 'layouts.alike.rear: missing; expected rear = "k | c".'),
        (
            '{ fornt = "k", front = "k", rear = "k" }',
            'layouts.alike.fornt: unknown key; expected one of front, rear. Did you mean "front"?',
        ),
        ('{ front = "k", rear = 3 }', 'layouts.alike.rear: got 3; expected a network in quotes, such as "k | c - b".'),
    ],
)
def test_a_layout_fills_the_mounts_of_the_vehicle(load, entry, said):
    with pytest.raises(StudyError) as caught:
        load(HALF, ('alike = "k | c"', f"alike = {entry}"))
    assert str(caught.value) == f"study.toml: {said}"


@pytest.mark.parametrize(("changes", "place", "words"), BAD.values(), ids=BAD)
def test_a_bad_file_is_refused_with_the_place_and_what_to_try(load, changes, place, words):
    with pytest.raises(StudyError) as caught:
        load(GOOD, *changes)
    lines = str(caught.value).splitlines()
    assert all(line.startswith("study.toml: ") for line in lines)
    (line,) = [line for line in lines if line.startswith(f"study.toml: {place}: ")]
    assert [word for word in words if word not in line] == []
    assert line.endswith((".", "?"))
    assert "Value error" not in line
    assert "pydantic" not in line


def tables_in(given, place=()):
    for key, value in given.items() if isinstance(given, dict) else enumerate(given):
        if isinstance(value, dict | list):
            yield (*place, key)
            yield from tables_in(value, (*place, key))


@pytest.mark.parametrize("wrong", [0, [], {}], ids=str)
def test_anything_in_the_place_of_any_table_is_refused_or_read(wrong):
    own = {"indices": {"own": {"kind": "tyre-load"}}}
    for path in EXAMPLES:
        given = own | tomllib.loads(path.read_text(encoding="utf-8"))
        for *above, last in tables_in(given):
            changed = copy.deepcopy(given)
            functools.reduce(operator.getitem, above, changed)[last] = wrong
            with contextlib.suppress(StudyError):
                study_of(changed, path)


@pytest.mark.parametrize("name", sorted(BAD.keys() - {"section", "section missing", "not a section"}))
def test_one_mistake_is_one_line_or_belongs_to_the_same_key(load, name):
    changes, place, _ = BAD[name]
    with pytest.raises(StudyError) as caught:
        load(GOOD, *changes)
    parent = place.rpartition(".")[0]
    assert all(line.startswith(f"study.toml: {parent}") for line in str(caught.value).splitlines())


def test_a_half_car_is_checked_as_one(load):
    with pytest.raises(StudyError) as caught:
        load(
            HALF,
            ("pitch_inertia", "pich_inertia"),
            ('"0.775 m"', '"0.775 kg"'),
            ("tyre_stiffness_rear", "tyre_stiffness"),
        )
    message = str(caught.value)
    assert "vehicle.pich_inertia: unknown key" in message
    assert 'Did you mean "pitch_inertia"?' in message
    assert "vehicle.pitch_inertia: missing" not in message  # that is the same mistake
    assert 'vehicle.tyre_stiffness_rear: missing; expected tyre_stiffness_rear = "100 kN/m".' in message
    assert "vehicle.distance_front: " in message
    assert 'It is a key of model = "quarter-car".' in message


def test_every_undefined_name_is_reported(load):
    with pytest.raises(StudyError) as caught:
        load(GOOD, ('"k | c | b"', '"k | cs | kk"'))
    assert ['"cs" is not' in line or '"kk" is not' in line for line in str(caught.value).splitlines()] == [True, True]


def test_a_mistake_at_one_axle_names_it_and_at_both_is_reported_once(load):
    with pytest.raises(StudyError) as caught:
        load(HALF, ('"k | c_r"', '"k | c_x"'), ('"k | c"', '"k | x"'))
    first, second = str(caught.value).splitlines()
    assert first.startswith("study.toml: layouts.alike: ")
    assert second.startswith("study.toml: layouts.unlike.rear: ")
    assert 'Did you mean "c_r"?' in second


def test_all_problems_are_reported_together(load):
    with pytest.raises(StudyError) as caught:
        load(GOOD, ('"300 kg"', '"300"'), ('"25 m/s"', "25"), ("title", "titel"), ('"J3", "J1"', '"J9"'))
    places = {line.split(": ")[1] for line in str(caught.value).splitlines()}
    assert places == {"titel", "road.speed", "elements.b", "study.indices"}


def test_problems_between_sections_are_reported_together(load):
    with pytest.raises(StudyError) as caught:
        load(GOOD, ('"k | c | b"', '"k | x"'), sweep('{ y = ["1 N", "2 N"] }'), (INDICES, INDICES + '\nbaseline = "z"'))
    places = [line.split(": ")[1] for line in str(caught.value).splitlines()]
    assert places == ["layouts.S2", "study.sweep.y", "study.baseline"]


def test_values_all_fixed_need_no_optimiser(load):
    assert load(GOOD, (C, 'c = "3 kN s/m"'), ('optimise = "norm"', "")).optimise is None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("k = 120 kN/m\n", ["line 1, column 9", "quoted"]),
        ('a = 1\n\nb = "x', ["line 3, column 7", "not valid TOML"]),
        ("[vehicle\n", ["line 1", "not valid TOML"]),
        ("[a]\nb = 1\nb = 2\n", ["line 3", "key is given twice"]),
        ("[a]\n[b]\n[a]\n", ["line 3", "section [a] is given twice", "one heading"]),
        ("[a.b]\n[a.b]\n", ["line 2", "section [a.b] is given twice"]),
        ("a = { b = 1, b = 2 }\n", ["line 1", "given twice"]),
        (b"[vehicle]\nmodel = '\xff'\n", ["line 2", "not UTF-8", "save"]),
        ("a = " + "[" * 100_000, ["nested too deeply"]),
        ("a = " + "9" * 5000, ["number too long"]),
        ("#" * 1_000_001, ["larger than"]),
        ("", ["vehicle: missing", "study: missing"]),
    ],
    ids=lambda value: None if isinstance(value, list) else repr(value[:12]),
)
def test_text_that_is_no_study_is_refused(load, text, words):
    with pytest.raises(StudyError) as caught:
        load(text)
    assert all(line.startswith("study.toml: ") for line in str(caught.value).splitlines())
    assert [word for word in words if word not in str(caught.value)] == []


def test_a_missing_file_and_a_folder_are_refused_by_path(tmp_path):
    with pytest.raises(StudyError, match=r"absent\.toml: file not found"):
        load_study(tmp_path / "absent.toml")
    with pytest.raises(StudyError, match="this is a folder"):
        load_study(str(tmp_path))


@given(st.dictionaries(st.text(max_size=5), st.text(max_size=12), max_size=4), st.sampled_from(["elements", "layouts"]))
def test_any_names_and_texts_are_a_study_or_a_study_error(tmp_path_factory, entries, section):
    lines = [f"{json.dumps(key)} = {json.dumps(value)}" for key, value in entries.items()]
    path = tmp_path_factory.mktemp("study") / "study.toml"
    path.write_text(GOOD.replace(f"[{section}]\n", "\n".join([f"[{section}]", *lines, ""])), encoding="utf-8")
    try:
        study = load_study(path)
    except StudyError as error:
        lines = str(error).splitlines()
    else:
        lines = []
        assert [study.design(layout).strut for layout in study.layouts]
    assert [line for line in lines if not line.startswith("study.toml: ")] == []


def test_the_old_name_of_the_tables_of_a_study_warns() -> None:
    study = load_study(ROOT / "examples" / "quarter-car.toml")
    with pytest.warns(DeprecationWarning, match="`resolved` is now `to_tables`"):
        assert study.resolved() == study.to_tables()
