"""Numbers of the vehicle that a study leaves free: what they are, and what cannot be."""

from __future__ import annotations

from pathlib import Path

import pytest
from folders import EXAMPLES
from study_text import assert_survives, load_text, study_text
from wang_su import ROAD

import inerter as it
from inerter.app.designs import Design
from inerter.app.fixed_designs import with_fixed_values
from inerter.errors import InerterError
from inerter.files.simulation.loading import load_simulation
from inerter.files.study.checking import check_study
from inerter.files.study.loading import load_study
from inerter.files.study.place import place_of
from inerter.files.study.places import places, with_numbers
from inerter.files.study.running import run_study
from inerter.files.study.study import Study

FREE = {"unsprung_mass": '{ from = "20 kg", to = "90 kg" }'}
ASK = 'indices = ["J3"]\noptimise = "norm"'
FIXED = {"unsprung_mass": '"35 kg"', "sprung_mass": '"250 kg"', "tyre_stiffness": '"150 kN/m"'}


def text_of(vehicle: dict[str, str], settings: str = ASK) -> str:
    return study_text(
        settings,
        vehicle="\n".join(f"{key} = {entry}" for key, entry in {**FIXED, **vehicle}.items()),
        elements='k = "20 kN/m"\nc = { from = "100 N s/m", to = "10 kN s/m" }\nb = "30 kg"',
    )


def study_of(folder: Path, vehicle: dict[str, str], settings: str = ASK) -> Study:
    return load_text(folder, text_of(vehicle, settings))


def test_a_study_chooses_a_mass_as_python_does(tmp_path: Path) -> None:
    study = study_of(tmp_path, FREE)
    check_study(study)
    found = run_study(study, tmp_path / "out").data.squeeze()
    strut = it.Spring(20e3) | it.Damper(it.free(100.0, 10e3, name="c"))
    car = it.QuarterCar(250.0, it.free(20.0, 90.0, name="unsprung_mass"), 150e3, strut)
    best = it.optimise(car, it.TyreLoad(ROAD), it.Norm(), seed=0)
    one = found.sel(layout="S1")
    assert float(one["value"]) == pytest.approx(best.value, rel=1e-9)
    assert [str(name) for name in one["parameter"].values] == ["c", "unsprung_mass"]
    told = {str(name): float(one["parameter_value"].sel(parameter=name)) for name in one["parameter"].values}
    assert told == pytest.approx(best.parameters, rel=1e-6)


def test_it_reads_back_as_it_was_written(tmp_path: Path) -> None:
    study = study_of(tmp_path, {**FREE, "tyre_stiffness": '{ from = "80 kN/m", to = "0.2 MN/m" }'})
    again = assert_survives(study, tmp_path)
    assert again.vehicle["tyre_stiffness"] == it.Free(80e3, 200e3, "tyre_stiffness")


def test_its_bounds_are_places(tmp_path: Path) -> None:
    study = study_of(tmp_path, FREE)
    assert places(study)["vehicle.unsprung_mass.to"].value == 90.0
    wider = with_numbers(study, [(place_of("vehicle.unsprung_mass.to"), 95.0)])
    assert wider.vehicle["unsprung_mass"] == it.Free(20.0, 95.0, "unsprung_mass")


def seated(folder: Path) -> Study:
    """A study in which the mass on the seat is free."""
    free = '[vehicle.seat]\nmass = { from = "50 kg", to = "90 kg" }\nnetwork = "ks | cs"\n\n[road]'
    seat = 'ks = "12 kN/m"\ncs = "600 N s/m"\nb = "30 kg"'
    text = text_of({}).replace("[road]", free).replace('b = "30 kg"', seat)
    return load_text(folder, text.replace("J3", "J1"))


def test_the_mass_on_a_seat_is_chosen_as_in_python(tmp_path: Path) -> None:
    study = assert_survives(seated(tmp_path), tmp_path)
    check_study(study)
    assert study.free_units == {"c": "N s/m", "mass": "kg"}
    found = run_study(study, tmp_path / "out").data.squeeze().sel(layout="S1")
    strut = it.Spring(20e3) | it.Damper(it.free(100.0, 10e3, name="c"))
    car = it.QuarterCar(250.0, 35.0, 150e3, strut)
    seat = it.Seat(car, it.free(50.0, 90.0, name="mass"), it.Spring(12e3) | it.Damper(600.0))
    best = it.optimise(seat, it.RideComfort(ROAD), it.Norm(), seed=0)
    assert float(found["value"]) == pytest.approx(best.value, rel=1e-9)
    told = {str(name): float(found["parameter_value"].sel(parameter=name)) for name in found["parameter"].values}
    assert told == pytest.approx(best.parameters, rel=1e-6)


def test_the_mass_on_a_seat_has_bounds_that_are_places_and_a_fixed_design(tmp_path: Path) -> None:
    study = seated(tmp_path)
    assert places(study)["vehicle.seat.mass.to"].value == 90.0
    wider = with_numbers(study, [(place_of("vehicle.seat.mass.to"), 95.0)])
    assert wider.vehicle["seat"]["mass"] == it.Free(50.0, 95.0, "mass")
    assert study.with_values({"mass": 70.0, "c": 2e3}).vehicle["seat"]["mass"] == 70.0
    design = Design(study, "S1", "S1", study.design("S1"), {"mass": 70.0, "c": 2e3})
    fixed = with_fixed_values(study.to_tables(), study, [design])
    assert fixed["vehicle"]["seat"]["mass"] == "70.0 kg"


MECHANISM = """
[vehicle]
model = "mechanism"
roads = { road = {} }

[vehicle.coordinates]
body = "250 kg"
wheel = { from = "20 kg", to = "90 kg" }
pitch = { from = "80 kg m^2", to = "0.2 t m^2" }

[vehicle.struts]
s = { upper = { body = 1, pitch = "0.4 m" }, lower = { wheel = 1 } }
t = { upper = { pitch = "1 m" }, network = "kp" }

[vehicle.tyres]
tyre = { port = { wheel = 1 }, road = "road", network = "kt" }

[road]
roughness = "5e-7 m^3/cycle"
speed = "25 m/s"

[elements]
k = "20 kN/m"
c = { from = "100 N s/m", to = "10 kN s/m" }
kp = "10 kN/m"
kt = "150 kN/m"

[layouts]
S1 = "k | c"

[study]
indices = ["J3"]
optimise = "norm"
"""
INERTIAS = {"wheel": it.Free(20.0, 90.0, "wheel"), "pitch": it.Free(80.0, 200.0, "pitch")}


def test_the_inertias_of_a_mechanism_are_chosen_as_in_python(tmp_path: Path) -> None:
    study = assert_survives(load_text(tmp_path, MECHANISM), tmp_path)
    check_study(study)
    assert study.free_units == {"c": "N s/m", "wheel": "kg", "pitch": "kg m^2"}
    found = run_study(study, tmp_path / "out").data.squeeze()
    strut = it.Spring(20e3) | it.Damper(it.free(100.0, 10e3, name="c"))
    coordinates = (
        it.Coordinate("body", 250.0),
        it.Coordinate("wheel", INERTIAS["wheel"]),
        it.Coordinate("pitch", INERTIAS["pitch"], angle=True),
    )
    struts = (
        it.Strut("s", strut, {"body": 1.0, "pitch": 0.4}, {"wheel": 1.0}),
        it.Strut("t", it.Spring(10e3), {"pitch": 1.0}, {}),
    )
    tyre = it.Tyre("tyre", it.Spring(150e3), {"wheel": 1.0}, "road")
    measures = it.PerformanceOutputs(tyre_load=(it.OutputWeight("tyre_load", 1.0),))
    car = it.Mechanism(coordinates, struts, (tyre,), (it.RoadInput("road"),), measures=measures)
    best = it.optimise(car, it.TyreLoad(ROAD), it.Norm(), seed=0)
    assert float(found["value"]) == pytest.approx(best.value, rel=1e-9)


def test_the_inertias_of_a_mechanism_have_bounds_that_are_places_and_a_fixed_design(tmp_path: Path) -> None:
    study = load_text(tmp_path, MECHANISM)
    known = places(study)
    assert known["vehicle.coordinates.pitch"].value == INERTIAS["pitch"]
    assert (known["vehicle.coordinates.pitch.to"].value, known["vehicle.coordinates.pitch.to"].unit) == (
        200.0,
        "kg m^2",
    )
    wider = with_numbers(study, [(place_of("vehicle.coordinates.wheel.from"), 10.0)])
    assert wider.vehicle["coordinates"]["wheel"] == ("kg", it.Free(10.0, 90.0, "wheel"))
    values = {"wheel": 30.0, "pitch": 100.0, "c": 2e3}
    design = Design(study, "S1", "S1", study.design("S1"), values)
    fixed = with_fixed_values(study.to_tables(), study, [design])
    assert fixed["vehicle"]["coordinates"] == {"body": "250.0 kg", "wheel": "30.0 kg", "pitch": "100.0 kg m^2"}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('to = "90 kg"', 'to = "90 kg m^2"', "unlike units, kg and kg m^2"),
        ('from = "20 kg"', 'from = "0 kg"', "more than 0 kg"),
        ('from = "20 kg"', 'from = "20 N"', "a mass such as"),
        ('from = "20 kg", ', "", 'wheel.from: missing; expected from = "1 kg"'),
        ("c = {", 'wheel = "1 kN/m"\nc = {', "free, and there is an element wheel too"),
        ("""pitch = "1 m\"""", "pitch = 1", "pitch is an angle"),
    ],
)
def test_what_an_inertia_cannot_be_is_said(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(InerterError) as error:
        check_study(load_text(tmp_path, MECHANISM.replace(old, new)))
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("vehicle", "settings", "said"),
    [
        ({"unsprung_mass": '{ from = "20 kg" }'}, ASK, "vehicle.unsprung_mass"),
        ({"unsprung_mass": '{ from = "90 kg", to = "20 kg" }'}, ASK, "Swap them"),
        ({"unsprung_mass": '{ from = "0 kg", to = "20 kg" }'}, ASK, "more than 0 kg"),
        ({"unsprung_mass": '{ from = "20 N", to = "90 N" }'}, ASK, "20 N"),
        (FREE, 'indices = ["J3"]', "c, unsprung_mass"),
        (FREE, ASK + '\nsweep = { "vehicle.unsprung_mass" = ["30 kg", "40 kg"] }', "vehicle.unsprung_mass is free"),
        (
            {"sprung_mass": '{ from = "200 kg", to = "300 kg" }'},
            ASK.replace("J3", "dynamic-load-coefficient"),
            "'sprung'",
        ),
    ],
)
def test_what_cannot_be_is_said(tmp_path: Path, vehicle: dict[str, str], settings: str, said: str) -> None:
    with pytest.raises(InerterError) as error:
        check_study(study_of(tmp_path, vehicle, settings))
    assert said in str(error.value)


def test_an_element_cannot_have_the_name_of_a_free_number_of_the_vehicle(tmp_path: Path) -> None:
    """A value is given by name: in results, and in what is fixed to them."""
    text = text_of(FREE).replace('b = "30 kg"', 'unsprung_mass = "30 kg"').replace("c | b", "c | unsprung_mass")
    with pytest.raises(InerterError, match=r"vehicle\.unsprung_mass: free, and there is an element unsprung_mass too"):
        load_text(tmp_path, text)


def test_a_distance_and_a_simulation_have_one_value(tmp_path: Path) -> None:
    path = tmp_path / "half.toml"
    half = EXAMPLES / "half-car.toml"
    lines = half.read_text(encoding="utf-8").splitlines()
    free = 'distance_front = { from = "0.7 m", to = "0.8 m" }'
    path.write_text("\n".join(free if line.startswith("distance_front") else line for line in lines), encoding="utf-8")
    with pytest.raises(InerterError, match=r"vehicle\.distance_front"):
        load_study(path)
    moved = (
        text_of(FREE).partition("[study]")[0].replace('c = { from = "100 N s/m", to = "10 kN s/m" }', 'c = "1 kN s/m"')
    )
    moved += '[signal]\nkind = "sine"\namplitude = "1 mm"\nfrequency = "1 Hz"\n'
    moved += '[simulation]\nlayout = "S1"\nduration = "1 s"\n'
    path.write_text(moved.replace('[road]\nspeed = "25 m/s"\nroughness = "5e-7 m^3/cycle"\n', ""), encoding="utf-8")
    with pytest.raises(InerterError, match=r"vehicle\.unsprung_mass"):
        load_simulation(path)
