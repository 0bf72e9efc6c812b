"""Numbers of the vehicle that a study leaves free: what they are, and what cannot be."""

from __future__ import annotations

from pathlib import Path

import pytest
from folders import EXAMPLES
from study_text import assert_survives, load_text, study_text
from wang_su import ROAD

import inerter as it
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
