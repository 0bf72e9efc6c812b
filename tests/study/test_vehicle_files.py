"""Vehicles in files: full cars, absorbers, seats and mechanisms; that they survive being written, and bad ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from folders import ROOT
from study_text import assert_survives, load_text, with_changes
from wang_su import paper_half_car, paper_quarter_car

import inerter as it
from inerter.cli.main import call
from inerter.errors import StudyError
from inerter.files.simulation.loading import load_simulation
from inerter.files.simulation.request import write_simulation
from inerter.files.study.checking import check_study
from inerter.files.study.loading import load_study
from inerter.files.study.study import Study
from inerter.report.problem_statement import vehicle_rows

OURS = ("full-car", "seat", "absorber", "train")
Load = Callable[..., Study]


@pytest.fixture
def load(tmp_path: Path) -> Load:
    """Loads an example with parts of its text replaced first; each part must be there."""

    def load_example(name: str, *changes: tuple[str, str]) -> Study:
        text = (ROOT / "examples" / f"{name}.toml").read_text(encoding="utf-8")
        return load_text(tmp_path, with_changes(text, *changes))

    return load_example


# --- what a good file means ---


def test_a_full_car_is_the_one_of_python(load: Load) -> None:
    c, c_r = (it.Damper(it.free(100.0, 20e3, name=name), name) for name in ("c_f", "c_r"))
    k, bar, rear = it.Spring(25e3, "k_f"), it.Spring(8e3, "k_a"), it.Spring(27e3, "k_r") | c_r
    expected = it.FullCar(
        1400, 2400, 520, 45, 40, 220e3, 220e3, 1.2, 1.5, 1.52, 1.5, k | c, rear, anti_roll_front=bar, anti_roll_rear=bar
    )
    assert load("full-car").design("S1") == expected


NODES = """title = "Bridge over nodes"
[vehicle]
model = "mechanism"
[vehicle.coordinates]
body = "181.75 kg"
wheel = "25 kg"
left = "0 kg"
right = "0 kg"
[vehicle.struts]
a = { upper = { body = 1 }, lower = { left = 1 }, network = "k1" }
b = { upper = { left = 1 }, lower = { wheel = 1 }, network = "c1" }
c = { upper = { body = 1 }, lower = { right = 1 }, network = "b" }
d = { upper = { right = 1 }, lower = { wheel = 1 }, network = "c2" }
e = { upper = { left = 1 }, lower = { right = 1 }, network = "k2" }
strut = { upper = { body = 1 }, lower = { wheel = 1 } }
[vehicle.tyres]
tyre = { port = { wheel = 1 }, road = "road", network = "kt" }
[vehicle.roads]
road = {}
[vehicle.measures]
comfort = { body_acceleration = 1 }
"""
REST = """[road]
speed = "25 m/s"
roughness = "5e-7 m^3/cycle"
[elements]
k = "100 kN/m"
k1 = "10 kN/m"
c1 = "2 kN s/m"
b = "50 kg"
c2 = "1 kN s/m"
k2 = "20 kN/m"
kt = "120 kN/m"
[layouts]
S = "LAYOUT"
[study]
indices = ["J1", "J3"]
"""


def test_a_bridge_in_a_file_and_coordinates_without_mass(tmp_path: Path) -> None:
    quarter = """title = "Bridge"
[vehicle]
model = "quarter-car"
sprung_mass = "181.75 kg"
unsprung_mass = "25 kg"
tyre_stiffness = "120 kN/m"
"""
    bridge = load_text(tmp_path, quarter + REST.replace("LAYOUT", "k | bridge(k1, c1, b, c2, k2)"))
    nodes = load_text(tmp_path, NODES + REST.replace("LAYOUT", "k"))
    for study in (bridge, nodes):
        assert_survives(study, tmp_path)
    parts = {"k1": it.Spring(1e4), "c1": it.Damper(2e3), "b": it.Inerter(50.0), "c2": it.Damper(1e3)}
    strut = it.network("k | bridge(k1, c1, b, c2, k2)", k=it.Spring(1e5), k2=it.Spring(2e4), **parts)
    assert bridge.design("S") == paper_quarter_car(strut)
    for index in ("J1", "J3"):
        values = [it.evaluate(one.design("S"), one.index(index), it.Norm()).value for one in (bridge, nodes)]
        assert values[1] == pytest.approx(values[0], rel=1e-10)


@pytest.mark.parametrize(
    "ask",
    [
        'tolerance = { c2 = "10 %" }',
        'tolerance = { vehicle.coordinates.c2 = "10 %" }',
        '[[conditions]]\nvehicle.coordinates.c2 = "60 kg"',
    ],
)
def test_a_number_with_the_name_of_another_is_refused(tmp_path: Path, ask: str) -> None:
    named = NODES.replace("body = ", "c2 = ").replace("body_", "c2_").replace("{ body", "{ c2")
    study = load_text(tmp_path, named + REST.replace("LAYOUT", "k") + ask)
    with pytest.raises(StudyError, match="'c2' is ambiguous: an element and the mass of a coordinate"):
        check_study(study)


def test_bars_may_be_left_out(load: Load) -> None:
    bars = ', anti_roll_front = "k_a", anti_roll_rear = "k_a"'
    mechanism = load("full-car", (bars, "")).design("S1").mechanism()
    assert [strut.name for strut in mechanism.struts] == ["front_left", "front_right", "rear_left", "rear_right"]


def test_one_text_is_the_strut_of_all_wheels_and_no_bar(load: Load) -> None:
    old = '{ front = "k_f | c_f", rear = "k_r | c_r", anti_roll_front = "k_a", anti_roll_rear = "k_a" }'
    assert load("full-car", (old, '"k_f | c_f"')).layouts["S1"].struts == dict.fromkeys(("front", "rear"), "k_f | c_f")


def test_a_seat_has_its_network_from_the_vehicle_or_from_the_layout(load: Load) -> None:
    study = load("seat", ('S3 = "k | c - b"', 'S3 = { strut = "k | c - b", seat = "ks | cs - b" }'))
    assert study.layouts["S1"].struts == {"strut": "k | c", "seat": "ks | cs"}
    assert study.layouts["S3"].struts == {"strut": "k | c - b", "seat": "ks | cs - b"}
    seated = study.design("S1")
    assert isinstance(seated, it.Seat)
    assert seated.mass == 70.0
    assert list(seated.free_values()) == ["c", "cs"]


def test_drivers_of_several_masses_are_conditions(load: Load) -> None:
    drivers = """
[[conditions]]
"vehicle.seat.mass" = "55 kg"
share = 0.4
[[conditions]]
"vehicle.seat.mass" = "100 kg"
"vehicle.sprung_mass" = "380 kg"
share = 0.6
"""
    study = load("seat", ('baseline = "S1"', f'baseline = "S1"\n{drivers}'))
    values = {"c": 1500.0, "cs": 400.0}
    seated = study.design("S1").with_values(values)
    found = it.evaluate(seated, study.resolve_index("J1", "S1"), it.Norm()).value
    laden = replace(seated, mass=100.0, vehicle=replace(seated.vehicle, sprung_mass=380.0))
    alone = [it.evaluate(one, study.index("J1"), it.Norm()).value for one in (replace(seated, mass=55.0), laden)]
    assert found == pytest.approx(0.4 * alone[0] + 0.6 * alone[1], rel=1e-12)


@pytest.mark.parametrize("place", ['{ sprung = 1, pitch = "-0.3 m", roll = "0.4 m" }', "{ sprung = 1 }"])
def test_a_seat_stands_where_the_file_says(load: Load, place: str) -> None:
    seat = f'[vehicle.seat]\nmass = "70 kg"\nnetwork = "k_f | c_f"\nplace = {place}\n[road]'
    lower = load("full-car", ("[road]", seat)).design("S1").mechanism().struts[-1].lower
    assert lower == ({"sprung": 1.0, "pitch": -0.3, "roll": 0.4} if "roll" in place else {"sprung": 1.0})


def test_an_absorber_needs_no_road_and_fills_its_ground_if_asked(load: Load) -> None:
    study = load("absorber")
    assert study.road is None
    assert [design.ground is None for design in (study.design("TMD"), study.design("TMDI"))] == [True, False]  # type: ignore[attr-defined]
    assert load("absorber", ('primary_damping = "100 N s/m"', "")).vehicle["primary_damping"] == 0.0
    check_study(study)


def test_a_mechanism_is_the_one_of_python(load: Load) -> None:
    """A half car written as a mechanism answers as the half car does."""
    text = """
    title = "half car by hand"
    [vehicle]
    model = "mechanism"
    [vehicle.coordinates]
    sprung = "363.5 kg"
    pitch = "200 kg m^2"
    unsprung_front = "25 kg"
    unsprung_rear = "20 kg"
    [vehicle.struts]
    front = { upper = { sprung = 1, pitch = "0.775 m" }, lower = { unsprung_front = 1 } }
    rear = { upper = { sprung = 1, pitch = "-126.5 cm" }, lower = { unsprung_rear = 1 } }
    [vehicle.tyres]
    tyre_front = { port = { unsprung_front = 1 }, road = "road_front", network = "kf" }
    tyre_rear = { port = { unsprung_rear = 1 }, road = "road_rear", network = "kr" }
    [vehicle.roads]
    road_front = {}
    road_rear = { distance = "2.04 m" }
    [vehicle.forces]
    sprung_force = { sprung = 1 }
    [vehicle.measures]
    comfort = { sprung_acceleration = 1, pitch_acceleration = "1.02 m" }
    load_input = "sprung_force"
    load_output = "sprung_displacement"
    [road]
    speed = "25 m/s"
    roughness = "5e-7 m^3/cycle"
    [elements]
    kf = "120 kN/m"
    kr = "100 kN/m"
    k = "60 kN/m"
    c = "3 kN s/m"
    b = "100 kg"
    [layouts]
    S3 = "k | c - b"
    S1 = { front = "k | c", rear = "k | c | b" }
    [study]
    indices = ["J1", "J3", "J5"]
    """
    path = load("seat").path
    path.write_text(text, encoding="utf-8")
    study = load_study(path)
    k, c, b = it.Spring(60e3), it.Damper(3e3), it.Inerter(100.0)
    for layout, struts in {"S3": (k | c - b, k | c - b), "S1": (k | c, k | c | b)}.items():
        car = paper_half_car(*struts)
        for symbol in study.indices:
            index = study.index(symbol)
            expected = it.evaluate(car, index, it.Norm()).value
            assert it.evaluate(study.design(layout), index, it.Norm()).value == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", OURS)
def test_it_survives_being_written(load: Load, name: str) -> None:
    study = load(name)
    again = assert_survives(study, study.path.parent)
    assert [again.design(layout) for layout in again.layouts] == [study.design(layout) for layout in study.layouts]


@pytest.mark.parametrize("name", ["building_wind"])
def test_a_simulation_survives_being_written(tmp_path: Path, name: str) -> None:
    request = load_simulation(ROOT / "examples" / f"{name}.toml")
    assert request.signal.unit == "N"
    path = tmp_path / f"{name}.toml"
    path.write_text(write_simulation(request), encoding="utf-8")
    assert load_simulation(path) == request


@pytest.mark.parametrize("name", OURS)
def test_a_reader_is_told_of_every_part(load: Load, name: str) -> None:
    rows = dict(vehicle_rows(load(name)))
    told = {"full-car": "Track front", "seat": "Mass on the seat", "absorber": "Primary mass", "train": "Road rail_4"}
    assert rows.keys() >= {told[name]}
    if name == "train":
        assert rows["Strut secondary_rear"] == "body \N{MINUS SIGN} 9.5 m × pitch over bogie_rear"
        assert "21.56" in rows["Road rail_4"]


def test_a_moment_on_an_angle_is_one(tmp_path: Path) -> None:
    text = (ROOT / "examples" / "building_wind.toml").read_text(encoding="utf-8")
    text = text.replace('absorber = "2 t"', 'absorber = "2 t"\ntwist = "1e5 kg m^2"')
    text = text.replace(
        "[vehicle.forces]",
        'spin = { upper = { twist = "3 m" }, network = "ks | cs" }\n[vehicle.forces]\nturn = { twist = "1 m" }',
    )
    text = text.replace('input = "wind"\nrms = "5 kN"', 'input = "turn"\nrms = "5 kN m"')
    path = tmp_path / "turned.toml"
    path.write_text(text, encoding="utf-8")
    assert load_simulation(path).signal.unit == "N m"
    path.write_text(text.replace('"5 kN m"', '"5 kN"'), encoding="utf-8")
    with pytest.raises(StudyError, match=r"signal\.rms"):
        load_simulation(path)


# --- what is said about a bad one ---

STRUT = 'secondary_front = { upper = { body = 1, pitch = "9.5 m" }, lower = { bogie_front = 1 } }'
RAIL = 'rail_4 = { distance = "21.56 m" }'
BAD: dict[str, tuple[str, list[tuple[str, str]], str, list[str]]] = {
    "no track": ("full-car", [('track_front = "1.52 m"', "")], "vehicle.track_front", ["missing", "1.52 m"]),
    "track in kg": ("full-car", [('"1.52 m"', '"1.52 kg"')], "vehicle.track_front", ["m"]),
    "mount": (
        "full-car",
        [("anti_roll_front", "anti_rol_front")],
        "layouts.S1.anti_rol_front",
        ["unknown", "anti_roll_front"],
    ),
    "no rear": ("full-car", [('rear = "k_r | c_r", ', "")], "layouts.S1.rear", ["missing", 'rear = "k | c"']),
    "no road": (
        "full-car",
        [('[road]\nspeed = "25 m/s" ', "#"), ('roughness = "5e-7 m^3/cycle"', "")],
        "road",
        ["missing", "[road]"],
    ),
    "a misspelt road": ("full-car", [("[road]", "[rod]")], "rod", ["unknown key", 'Did you mean "road"?']),
    "seat without mass": ("seat", [('mass = "70 kg" ', "")], "vehicle.seat.mass", ["missing", '"60 kg"']),
    "seat of no mass": ("seat", [('mass = "70 kg"', 'mass = "0 kg"')], "vehicle.seat.mass", ["not positive"]),
    "seat without network": ("seat", [('network = "ks | cs"', "")], "vehicle.seat.network", ["missing"]),
    "seat's element": ("seat", [('network = "ks | cs"', 'network = "ks | cx"')], "layouts.S1.seat", ['"cx"', "cs"]),
    "seat's key": ("seat", [('mass = "70 kg"', 'weight = "70 kg"')], "vehicle.seat.weight", ["unknown key", "mass"]),
    "seat nowhere": (
        "seat",
        [('mass = "70 kg"', 'mass = "70 kg"\nplace = { body = 1 }')],
        "vehicle.seat.place.body",
        ["not a coordinate", "sprung"],
    ),
    "seat on pitch": (
        "seat",
        [('mass = "70 kg"', 'mass = "70 kg"\nplace = { sprung = "1 m" }')],
        "vehicle.seat.place.sprung",
        ["no angle", "a number"],
    ),
    "seat is text": (
        "seat",
        [("[vehicle.seat]\nmass", 'seat = "soft"\nmass')],
        "vehicle.seat",
        ["not a table", "mass"],
    ),
    "seat of an absorber": (
        "absorber",
        [("[elements]", '[vehicle.seat]\nmass = "60 kg"\nnetwork = "k"\n[elements]')],
        "vehicle.seat",
        ["unknown key"],
    ),
    "negative damping": ("absorber", [('"100 N s/m"', '"-100 N s/m"')], "vehicle.primary_damping", ["negative"]),
    "ground alone": ("absorber", [('mount = "k | c", ', "")], "layouts.TMDI.mount", ["missing", "mount ="]),
    "J1 of an absorber": ("absorber", [('["J5"]', '["J1"]')], "road", ["missing", "J1"]),
    "no coordinates": (
        "train",
        [("[vehicle.coordinates]", "[vehicle.cordinates]")],
        "vehicle.cordinates",
        ["coordinates"],
    ),
    "coordinate in N": ("train", [('"19 t"', '"19 kN"')], "vehicle.coordinates.body", ["mass", "moment of inertia"]),
    "negative mass": ("train", [('"19 t"', '"-19 t"')], "vehicle.coordinates.body", ["negative", "0 for a node"]),
    "mass as a number": ("train", [('"19 t"', "19000")], "vehicle.coordinates.body", ["mass"]),
    "coordinate's name": (
        "train",
        [('bogie_front = "1.6 t"', '"1 bogie" = "1.6 t"')],
        "vehicle.coordinates",
        ["not a name"],
    ),
    "no such coordinate": (
        "train",
        [("{ bogie_front = 1 } }", "{ bogie_fornt = 1 } }")],
        "vehicle.struts.secondary_front.lower.bogie_fornt",
        ["not a coordinate", "bogie_front"],
    ),
    "lever without unit": (
        "train",
        [('pitch = "9.5 m"', "pitch = 9.5")],
        "vehicle.struts.secondary_front.upper.pitch",
        ["angle", '"9.5 m"'],
    ),
    "lever with unit": (
        "train",
        [("{ body = 1,", '{ body = "1 m",')],
        "vehicle.struts.secondary_front.upper.body",
        ["no angle"],
    ),
    "lever in kg": (
        "train",
        [('pitch = "9.5 m"', 'pitch = "9.5 kg"')],
        "vehicle.struts.secondary_front.upper.pitch",
        ["m"],
    ),
    "lever is a list": (
        "train",
        [('pitch = "9.5 m"', "pitch = [1]")],
        "vehicle.struts.secondary_front.upper.pitch",
        ["number", "1.2 m"],
    ),
    "no upper": (
        "train",
        [(STRUT, "secondary_front = { lower = { bogie_front = 1 } }")],
        "vehicle.struts.secondary_front.upper",
        ["missing"],
    ),
    "strut's key": (
        "train",
        [("lower = { bogie_front = 1 }", "below = { bogie_front = 1 }")],
        "vehicle.struts.secondary_front.below",
        ["unknown key", "lower"],
    ),
    "strut is text": (
        "train",
        [(STRUT, 'secondary_front = "k | c"')],
        "vehicle.struts.secondary_front",
        ["not a table"],
    ),
    "never moves": (
        "train",
        [("lower = { bogie_front = 1 }", 'lower = { body = 1, pitch = "9.5 m" }')],
        "vehicle",
        ["its travel is zero"],
    ),
    "held by nothing": ("train", [('body = "19 t"', 'body = "19 t"\nalone = "1 t"')], "vehicle", ["unconstrained"]),
    "tyre nowhere": (
        "train",
        [('road = "rail_1"', 'road = "rail_9"')],
        "vehicle.tyres.primary_1.road",
        ['"rail_9"', "rail_1"],
    ),
    "tyre without port": (
        "train",
        [('port = { bogie_front = 1, bogie_pitch_front = "1.28 m" }, ', "")],
        "vehicle.tyres.primary_1.port",
        ["missing"],
    ),
    "distance": ("train", [(RAIL, 'rail_4 = { distance = "-1 m" }')], "vehicle.roads.rail_4.distance", ["negative"]),
    "distance in s": ("train", [(RAIL, 'rail_4 = { distance = "1 s" }')], "vehicle.roads.rail_4.distance", ["m"]),
    "track": ("train", [(RAIL, 'rail_4 = { track = "middle" }')], "vehicle.roads.rail_4.track", ['"left"', '"right"']),
    "road's key": ("train", [(RAIL, 'rail_4 = { behind = "1 m" }')], "vehicle.roads.rail_4.behind", ["distance"]),
    "two alike": ("train", [("load = { body = 1 }", "body = { body = 1 }")], "vehicle", ["name 'body'"]),
    "force nowhere": ("train", [("load = { body = 1 }", "load = { roof = 1 }")], "vehicle.forces.load.roof", ["body"]),
    "measure's key": ("train", [("comfort =", "comfrot =")], "vehicle.measures.comfrot", ["comfort"]),
    "measure": (
        "train",
        [("body_acceleration = 1", "body_acceleration = true")],
        "vehicle.measures.comfort.body_acceleration",
        ["number"],
    ),
    "mount of a mechanism": (
        "train",
        [('S3 = "k | c - b"', 'S3 = { secondary_font = "k", secondary_front = "k", secondary_rear = "k" }')],
        "layouts.S3.secondary_font",
        ["unknown key", "secondary_front"],
    ),
    "mount left out": (
        "train",
        [('S3 = "k | c - b"', 'S3 = { secondary_front = "k | c" }')],
        "layouts.S3.secondary_rear",
        ["missing"],
    ),
    "element of a tyre": (
        "train",
        [('network = "kp | cp - kc"', 'network = "kp | cz"')],
        "layouts.S1.primary_1",
        ['"cz"', "cp"],
    ),
    "network is a number": (
        "train",
        [('network = "kp | cp - kc"', "network = 3")],
        "vehicle.tyres.primary_1.network",
        ["quotes"],
    ),
    "two seats": (
        "train",
        [("secondary_front =", "seat ="), ("[road]", '[vehicle.seat]\nmass = "60 kg"\nnetwork = "k"\n[road]')],
        "vehicle.struts.seat",
        ["another name"],
    ),
    "no such measure": (
        "train",
        [('load_output = "body_displacement"', 'load_output = "roof_displacement"')],
        "layouts.S1",
        ["roof_displacement", "body_displacement"],
    ),
}


@pytest.mark.parametrize(("name", "changes", "place", "words"), BAD.values(), ids=BAD)
def test_a_bad_vehicle_is_refused_in_one_sentence_with_its_place(
    load: Load, name: str, changes: list[tuple[str, str]], place: str, words: list[str]
) -> None:
    with pytest.raises(StudyError) as caught:
        check_study(load(name, *changes))
    lines = str(caught.value).splitlines()
    told = [line for line in lines if line.startswith(f"study.toml: {place}")]
    assert told, lines
    assert all(word in told[0] for word in words), told


@pytest.mark.parametrize("broken", ["[vehicle]\nmodel = 3", '[vehicle]\nmodel = "mechanism"', "vehicle = 3"])
def test_a_broken_vehicle_is_no_traceback(tmp_path: Path, broken: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "study.toml"
    path.write_text(f'{broken}\n[layouts]\nS1 = {{ a = "k" }}\n[elements]\nk = "1 N/m"\n', encoding="utf-8")
    assert call(["check", str(path)]) == 2
    assert "Traceback" not in capsys.readouterr().err
