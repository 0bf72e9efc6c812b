"""Simulation files of designs: read back, they are the same vehicle, and move as it does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from designs import ALWAYS, COUNT, design
from study_text import study_text

import inerter as it
from inerter.cli.main import call
from inerter.errors import ExportError
from inerter.files.simulation.loading import load_simulation
from inerter.vehicle.vehicle import Vehicle

COMFORT = it.RideComfort(it.Road(5e-7, 25.0))


def read_back(vehicle: Vehicle, folder: Path, **options: object) -> it.Trajectory | object:
    """The request of the simulation file of a vehicle."""
    path = it.export(vehicle, "simulation", folder / "design.toml", overwrite=True, **options)
    return load_simulation(path)


@pytest.mark.parametrize("number", sampled(range(COUNT), ALWAYS))
def test_the_file_of_a_design_has_its_equations(number: int, tmp_path: Path) -> None:
    """Of random vehicles of every kind, to the last bit."""
    vehicle = design(number)
    again = read_back(vehicle, tmp_path, indices={"J1": COMFORT}).design()
    one, other = (it.state_space(each.mechanism()) for each in (vehicle, again))
    assert (one.inputs, one.outputs) == (other.inputs, other.outputs)
    for name in ("A", "B", "C", "D"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_a_seated_car_with_friction_and_a_gap_moves_as_from_the_file(tmp_path: Path) -> None:
    """Two different springs have the same name, and so are numbered in the file."""
    screw = (it.Spring(1e6) | it.Damper(3200.0)) - it.Gap(5e-5) - (it.Inerter(300.0) | it.Friction(10.0))
    car = it.HalfCar(363.5, 450.0, 25.0, 27.0, 120e3, 110e3, 1.2, 1.4, it.Spring(6e4) | it.Damper(3e3) | screw,
                     it.Spring(7e4) | it.Damper(2e3))  # fmt: skip
    seated = it.Seat(car, 70.0, it.Spring(9e3) | it.Damper(400.0), {"sprung": 1.0, "pitch": 0.3})
    request = read_back(seated, tmp_path, speed=15.0)
    assert request.vehicle["model"] == "half-car"
    assert {"k", "k_2", "k_3", "k_4"} <= set(request.elements)
    bump = it.bump(height=0.01, length=1.0, start=0.5, speed=15.0)
    run = it.simulate(seated, road=bump, duration=1.0, step=1e-3)
    again = it.simulate(request.design(), road=request.make_signal(), duration=1.0, step=1e-3, speed=request.speed)
    for name in ("occupant_acceleration", "tyre_rear_load", "front_travel"):
        np.testing.assert_array_equal(again[name], run[name])
    assert len(again.events) == len(run.events) > 0


def test_what_files_have_no_model_for_is_written_part_by_part(tmp_path: Path) -> None:
    rig = it.Rig(it.Spring(1e5) | it.Damper(20.0), cell_bandwidth=300.0)
    request = read_back(rig, tmp_path)
    assert request.vehicle["model"] == "mechanism"
    np.testing.assert_array_equal(it.state_space(request.design()).A, it.state_space(rig).A)
    tower = it.Absorber(1000.0, 40e3, 50.0, it.Spring(2e3) | it.Damper(20.0)).mechanism().on_moving_ground()
    shaken = read_back(tower, tmp_path)
    assert shaken.signal.input == "ground_acceleration"
    np.testing.assert_array_equal(it.state_space(shaken.design()).B, it.state_space(tower).B)


def test_what_a_file_cannot_state_is_refused() -> None:
    car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(20e3) | it.Damper(2e3))
    with pytest.raises(
        ExportError, match="simulation does not accept linear: it does not support a model without friction and gaps"
    ):
        it.export(car, "simulation", speed=25.0, linear=True)
    own = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(20e3, name="value"))
    with pytest.raises(
        ExportError, match=r"A simulation file cannot state this vehicle: elements.value: .*another name"
    ):
        it.export(own, "simulation")
    strut = it.Strut("strut", it.Spring(20e3) | it.Damper(2e3), {"body": 1.0}, it.GROUND)
    pushed = it.Mechanism((it.Coordinate("body", 250.0),), (strut,), forces=(it.Force("road", {"body": 1.0}),))
    with pytest.raises(ExportError, match=r"A simulation file cannot state this vehicle: vehicle\.forces\.road: "):
        it.export(pushed, "simulation")


def test_the_best_design_of_a_study_is_simulated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the values of the best design, at the speed of its road, on a first bump."""
    monkeypatch.chdir(tmp_path)
    free = 'k = "20 kN/m"\nc = { from = "0.5 kN s/m", to = "5 kN s/m" }'
    text = study_text('indices = ["J1"]\noptimise = "norm"', elements=free, layouts='S1 = "k | c"')
    Path("car.toml").write_text(text, encoding="utf-8")
    assert call(["export", "car.toml", "--to", "simulation"]) == 0
    request = load_simulation(Path("car-S1-J1.toml"))
    strut = it.Spring(20e3) | it.Damper(it.free(500.0, 5e3, name="c"))
    best = it.optimise(it.QuarterCar(250.0, 35.0, 150e3, strut), COMFORT, it.Norm(), seed=0)
    assert request.elements["c"].value == pytest.approx(best.parameters["c"], rel=1e-6)
    assert (request.speed, request.roughness, request.signal.kind) == (25.0, 5e-7, "bump")
    assert call(["export", "car.toml", "--to", "simulation", "--speed", "36 km/h", "--force"]) == 0
    assert load_simulation(Path("car-S1-J1.toml")).speed == 10.0
    assert call(["check", "car-S1-J1.toml"]) == 0
