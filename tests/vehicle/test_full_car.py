"""A car on four wheels: against matrices written by hand, and against its half car if both sides are alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from wang_su import ROAD

import inerter as it
from inerter.errors import MechanismError

AXLES, SIDES = ("front", "rear"), ("left", "right")
WHEELS = [(axle, side) for axle in AXLES for side in SIDES]


def car(rng: np.random.Generator, **given: object) -> it.FullCar:
    """Any car; its struts are springs, dampers and inerters side by side, so that matrices can be written down."""
    strut = [
        it.Spring(rng.uniform(1e4, 1e5)) | it.Damper(rng.uniform(500, 5e3)) | it.Inerter(rng.uniform(1, 200))
        for _ in AXLES
    ]
    values: dict[str, object] = {
        "sprung_mass": rng.uniform(800, 2500),
        "pitch_inertia": rng.uniform(1e3, 4e3),
        "roll_inertia": rng.uniform(300, 900),
        "unsprung_mass_front": rng.uniform(20, 60),
        "unsprung_mass_rear": rng.uniform(20, 60),
        "tyre_stiffness_front": rng.uniform(1e5, 3e5),
        "tyre_stiffness_rear": rng.uniform(1e5, 3e5),
        "distance_front": rng.uniform(0.8, 1.6),
        "distance_rear": rng.uniform(0.8, 1.6),
        "track_front": rng.uniform(1.2, 1.7),
        "track_rear": rng.uniform(1.2, 1.7),
        "front": strut[0],
        "rear": strut[1],
    }
    return it.FullCar(**{**values, **given})  # type: ignore[arg-type]


def across(rng: np.random.Generator) -> dict[str, it.Network]:
    """Networks between left and right, front and rear."""
    return {
        "anti_roll_front": it.Spring(rng.uniform(1e3, 3e4)) | it.Inerter(rng.uniform(1, 50)),
        "anti_roll_rear": it.Spring(rng.uniform(1e3, 3e4)) | it.Damper(rng.uniform(10, 1e3)),
        "anti_pitch": it.Spring(rng.uniform(1e3, 3e4)) | it.Damper(rng.uniform(10, 1e3)),
    }


def law(network: it.Network | None) -> np.ndarray:
    """Inertance, damping and stiffness of elements side by side."""
    units = ("kg", "N s/m", "N/m")
    elements = [] if network is None else list(network.elements())
    return np.array([sum(float(e.value) for e in elements if e.unit == unit) for unit in units])


def by_hand(full: it.FullCar, omega: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacements of heave, pitch, roll and four wheels by Newton's laws: under four road displacements, and under a
    force and two moments on the body.

    Where a wheel is follows from right-handed axes: x forwards, y left, z up; roll turns about x, pitch nose up.
    """
    s = 1j * omega
    powers = np.array([s**2, s, 1.0])
    x = {"front": full.distance_front, "rear": -full.distance_rear}
    y = {("front", "left"): full.track_front / 2, ("front", "right"): -full.track_front / 2}
    y |= {("rear", "left"): full.track_rear / 2, ("rear", "right"): -full.track_rear / 2}
    masses = [full.sprung_mass, full.pitch_inertia, full.roll_inertia]
    masses += [getattr(full, f"unsprung_mass_{axle}") for axle, _ in WHEELS]
    dynamic = np.diag(np.array(masses, complex)) * s**2
    travel = {}
    for i, (axle, side) in enumerate(WHEELS):
        travel[axle, side] = np.array([1.0, x[axle], y[axle, side], *(-1.0 if j == i else 0.0 for j in range(4))])
        dynamic += law(getattr(full, axle)) @ powers * np.outer(travel[axle, side], travel[axle, side])
        dynamic[3 + i, 3 + i] += getattr(full, f"tyre_stiffness_{axle}")
    joined = [(full.anti_roll_front, ("front", "left"), ("front", "right"))]
    joined += [(full.anti_roll_rear, ("rear", "left"), ("rear", "right"))]
    joined += [(full.anti_pitch, ("front", side), ("rear", side)) for side in SIDES]
    for network, first, second in joined:
        difference = travel[first] - travel[second]
        dynamic += law(network) @ powers * np.outer(difference, difference)
    tyres = np.zeros((7, 4))
    for i, (axle, _) in enumerate(WHEELS):
        tyres[3 + i, i] = getattr(full, f"tyre_stiffness_{axle}")
    return np.linalg.solve(dynamic, tyres), np.linalg.solve(dynamic, np.eye(7, 3))


@pytest.mark.parametrize("seed", sampled(range(60), range(4), kept=14))
def test_frequency_responses_are_those_of_matrices_written_by_hand(seed: int) -> None:
    rng = np.random.default_rng(seed)
    full = car(rng, **(across(rng) if seed % 2 else {}))
    roads = [f"road_{axle}_{side}" for axle, side in WHEELS]
    names = ["sprung", "pitch", "roll", *(f"unsprung_{axle}_{side}" for axle, side in WHEELS)]
    omega = np.array([0.5, 7.0, 60.0, 400.0])
    found = it.frequency_response(it.state_space(full, roads, [f"{name}_velocity" for name in names]), omega)
    for response, w in zip(found, omega, strict=True):  # velocities over the roads' velocities
        expected, _ = by_hand(full, w)
        np.testing.assert_allclose(response, expected, atol=1e-11 * np.abs(expected).max(), rtol=1e-9)
    forces = ["sprung_force", "pitch_moment", "roll_moment"]
    found = it.frequency_response(it.state_space(full, forces, [f"{name}_velocity" for name in names]), omega)
    for response, w in zip(found, omega, strict=True):
        expected = 1j * w * by_hand(full, w)[1]
        np.testing.assert_allclose(response, expected, atol=1e-11 * np.abs(expected).max(), rtol=1e-9)


STRUTS = {
    "parallel": it.Spring(25e3) | it.Damper(1500) | it.Inerter(30),
    "series": it.Spring(25e3) | it.Damper(1500) - it.Inerter(80),
}


def halves(strut: str) -> tuple[it.FullCar, it.HalfCar]:
    """A car whose sides are alike, and one side of it."""
    front, rear = STRUTS[strut], it.Spring(22e3) | it.Damper(1700)
    full = it.FullCar(
        1400, 2400, 520, 45, 40, 220e3, 210e3, 1.2, 1.5, 1.52, 1.5, front, rear, it.Spring(8e3), it.Spring(5e3)
    )
    return full, it.HalfCar(700, 1200, 45, 40, 220e3, 210e3, 1.2, 1.5, front, rear)


@pytest.mark.parametrize("strut", STRUTS)
@pytest.mark.parametrize("index", [it.RideComfort(ROAD), it.TyreLoad(ROAD), it.TyreLoad(ROAD, high_pass=6.0)])
def test_on_one_track_it_is_two_half_cars(strut: str, index: it.RideComfort | it.TyreLoad) -> None:
    full, half = (it.evaluate(vehicle, index, it.Norm()).value for vehicle in halves(strut))
    tracks = 1.0 if isinstance(index, it.RideComfort) else 2.0  # tyre loads of both sides add up
    assert full == pytest.approx(tracks * half, rel=1e-9)


@pytest.mark.parametrize("strut", STRUTS)
def test_a_force_on_the_body_is_shared_by_both_sides(strut: str) -> None:
    full, half = (it.evaluate(vehicle, it.LoadCarrying(), it.Norm()).value for vehicle in halves(strut))
    assert full == pytest.approx(0.5 * half, rel=1e-9)


def test_on_one_track_it_moves_as_its_half_car_and_the_energy_closes() -> None:
    full, half = halves("series")
    friction = it.Friction(40.0)
    vehicles = (replace(full, rear=full.rear | friction), replace(half, rear=half.rear | friction))
    road = it.multisine(ROAD, seed=3)
    whole, side = (it.simulate(v, road=road, duration=2.0, step=5e-4, energy=True) for v in vehicles)
    for name in ("sprung_acceleration", "pitch_acceleration"):
        np.testing.assert_allclose(whole[name], side[name], atol=1e-9 * np.abs(side[name]).max())
    np.testing.assert_allclose(whole["tyre_rear_right_load"], side["tyre_rear_load"], atol=1e-6)
    assert np.abs(whole["roll_acceleration"]).max() < 1e-9
    assert abs(whole.energy.relative_residual) < 1e-9
    taken, by_one = (sum(run.energy.friction.values()) for run in (whole, side))
    assert taken == pytest.approx(2.0 * by_one, rel=1e-6)


def test_a_bump_under_the_left_wheels_rolls_the_body_to_the_right() -> None:
    full, _ = halves("parallel")
    bump, flat = it.bump(height=0.03, length=2.0, speed=20.0), it.Signal.sampled([0.0, 10.0], [0.0, 0.0])
    roads = {f"road_{axle}_{side}": bump if side == "left" else flat for axle, side in WHEELS}
    run = it.simulate(full, road=roads, duration=0.1, step=1e-3, energy=True)
    assert run["roll_displacement"][50:].min() > 0.0  # left side up
    assert abs(run.energy.relative_residual) < 1e-9


def test_roads_say_where_they_are() -> None:
    roads = {road.name: road for road in halves("series")[0].mechanism().roads}
    assert [(r.distance, r.side) for r in roads.values()] == [(0, "left"), (0, "right"), (2.7, "left"), (2.7, "right")]


def test_a_value_in_a_strut_is_one_value_left_and_right() -> None:
    full, _ = halves("series")
    free = replace(
        full, front=it.Spring(25e3) | it.Damper(it.free(500, 5e3)), rear=it.Damper(it.free(500, 5e3)) | it.Spring(2e4)
    )
    assert list(free.free_values()) == ["c", "c2"]
    fixed = free.with_values({"c": 1500.0, "c2": 1700.0})
    assert {s.name: s.network for s in fixed.mechanism().struts}["front_left"] == it.Spring(25e3) | it.Damper(1500.0)
    best = it.optimise(free, it.RideComfort(ROAD), it.Norm(), seed=0)
    assert best.value <= it.evaluate(fixed, it.RideComfort(ROAD), it.Norm()).value


BAD = {
    "no track": ({"track_front": 0.0}, "track front of the full car must be a positive number of m, got 0.0"),
    "negative inertia": ({"roll_inertia": -1.0}, "roll inertia of the full car must be a positive number of kg m\\^2"),
    "no number": ({"sprung_mass": "1400"}, "sprung mass of the full car must be a positive number of kg, got '1400'"),
}


@pytest.mark.parametrize(("given", "message"), BAD.values(), ids=BAD)
def test_bad_values_are_refused_in_one_sentence(given: dict[str, object], message: str) -> None:
    with pytest.raises(MechanismError, match=message):
        car(np.random.default_rng(0), **given)


@pytest.mark.parametrize("mount", ["front", "anti_roll_rear", "anti_pitch"])
def test_what_is_mounted_must_be_a_network(mount: str) -> None:
    with pytest.raises(it.InerterError, match="got int 8000"):
        car(np.random.default_rng(0), **{mount: 8000})


def test_a_track_is_left_or_right() -> None:
    with pytest.raises(MechanismError, match=r'side of road .* must be "left" or "right"'):
        it.Mechanism(
            (it.Coordinate("a", 1.0),),
            (),
            (it.Tyre("t", it.Spring(1.0), {"a": 1.0}, "r"),),
            (it.RoadInput("r", side="middle"),),
        )
