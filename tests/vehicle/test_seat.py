"""A seat on any vehicle."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter.errors import DesignError, MechanismError, NetworkError

STRUT = it.Spring(60e3) | it.Damper(3e3) - it.Inerter(100.0)
CUSHION = it.Spring(15e3, "cushion_spring") | it.Damper(500.0, "cushion_damper")
FULL = it.FullCar(1400, 2400, 520, 45, 40, 220e3, 210e3, 1.2, 1.5, 1.52, 1.5, STRUT, STRUT, it.Spring(8e3))
CARS: dict[str, it.QuarterCar | it.HalfCar | it.FullCar | it.Mechanism] = {
    "quarter car": paper_quarter_car(STRUT),
    "half car": paper_half_car(STRUT, STRUT),
    "full car": FULL,
    "mechanism": paper_half_car(STRUT, STRUT).mechanism(),
}


@pytest.mark.parametrize("car", sampled(CARS, ["quarter car"]))
def test_of_no_mass_it_gives_its_car(car: str) -> None:
    vehicle = CARS[car]
    seated = it.Seat(vehicle, 1e-9, CUSHION)
    for index in (it.TyreLoad(ROAD), it.LoadCarrying()):
        plain = it.evaluate(vehicle, index, it.Norm()).value
        assert it.evaluate(seated, index, it.Norm()).value == pytest.approx(plain, rel=1e-8)
    roads = [road.name for road in vehicle.mechanism().roads]
    floor = it.h2_norm(it.state_space(vehicle, roads, "sprung_acceleration"))
    occupant = it.h2_norm(it.state_space(seated, roads, "occupant_acceleration"))
    assert occupant == pytest.approx(floor, rel=1e-8)


def test_of_no_mass_it_feels_what_a_quarter_car_feels() -> None:
    comfort, car = it.RideComfort(ROAD), CARS["quarter car"]
    seated = it.evaluate(it.Seat(car, 1e-9, CUSHION), comfort, it.Norm())
    assert seated.value == pytest.approx(it.evaluate(car, comfort, it.Norm()).value, rel=1e-8)


def test_the_occupant_of_a_full_car_meets_the_floor_at_his_place() -> None:
    """By hand: the occupant is an oscillator on the motion of the floor, and pulls on heave, pitch and roll."""
    ahead, left, mass = -0.3, 0.4, 70.0
    seated = it.Seat(FULL, mass, CUSHION, {"sprung": 1.0, "pitch": ahead, "roll": left})
    omega = np.array([2.0, 12.0, 40.0])
    names = ["occupant_velocity", "sprung_velocity", "pitch_velocity", "roll_velocity", "seat_force"]
    found = it.frequency_response(it.state_space(seated, "road_front_left", names), omega)[:, :, 0].T
    s = 1j * omega
    occupant, sprung, pitch, roll, force = found
    floor = sprung + ahead * pitch + left * roll
    np.testing.assert_allclose(occupant, (500.0 * s + 15e3) / (mass * s**2 + 500.0 * s + 15e3) * floor, rtol=1e-9)
    np.testing.assert_allclose(force, -mass * s * occupant, rtol=1e-9)


@pytest.mark.parametrize("car", CARS)
def test_the_energy_of_a_ride_closes(car: str) -> None:
    seated = it.Seat(CARS[car], 60.0, CUSHION | it.Friction(5.0, "rail"))
    run = it.simulate(seated, road=it.multisine(ROAD, seed=1), duration=1.0, step=5e-4, energy=True)
    assert abs(run.energy.relative_residual) < 1e-9
    assert run.rms("occupant_acceleration") > 0.0


def test_free_values_of_car_and_seat_are_apart_and_found_together() -> None:
    strut = it.Spring(60e3) | it.Damper(it.free(100.0, 1e4))
    seated = it.Seat(paper_quarter_car(strut), 60.0, it.Spring(15e3) | it.Damper(it.free(10.0, 5e3)))
    assert list(seated.free_values()) == ["c", "c2"]
    best = it.optimise(seated, it.RideComfort(ROAD), it.Norm(), seed=0)
    assert set(best.parameters) == {"c", "c2"}
    again = it.evaluate(seated.with_values(best.parameters), it.RideComfort(ROAD), it.Norm())
    assert again.value == pytest.approx(best.value, rel=1e-9)
    assert list(seated.with_values({"c2": 300.0}).free_values()) == ["c"]


def test_bad_seats_are_refused_in_one_sentence() -> None:
    car = CARS["quarter car"]
    with pytest.raises(MechanismError, match="The mass of the occupant must be a positive number of kg, got 0"):
        it.Seat(car, 0, CUSHION)
    with pytest.raises(MechanismError, match="strut 'seat': unknown coordinate 'pitch'"):
        it.Seat(car, 60.0, CUSHION, {"sprung": 1.0, "pitch": 0.3})
    with pytest.raises(DesignError, match="Expected a vehicle"):
        it.Seat(it.QuarterCar, 60.0, CUSHION)  # type: ignore[arg-type]
    with pytest.raises(NetworkError, match="15000"):
        it.Seat(car, 60.0, 15e3)  # type: ignore[arg-type]
    with pytest.raises(MechanismError, match="Duplicate name"):
        it.Seat(it.Seat(car, 60.0, CUSHION), 60.0, CUSHION)
    with pytest.raises(DesignError, match="unknown free value 'c'"):
        it.Seat(car, 60.0, CUSHION).with_values({"c": 1.0})
