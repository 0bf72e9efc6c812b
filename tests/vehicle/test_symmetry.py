"""One half of a car in place of both: the same numbers, and only where both sides are alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from test_full_car import ROAD, across, car

import inerter as it
from inerter.vehicle.symmetry import half_of


def pair(seed: int) -> tuple[it.FullCar, it.Mechanism]:
    """A full car, and the same as a mechanism that does not know of its sides."""
    rng = np.random.default_rng([9, seed])
    full = car(rng, **(across(rng) if seed % 2 else {}))
    if seed % 3 == 0:
        full = replace(full, front=it.Spring(3e4) | it.Damper(2e3) - it.Inerter(rng.uniform(10, 300)))
    return full, replace(full.mechanism(), mirror=())


@pytest.mark.parametrize("seed", sampled(range(40), range(4), kept=4))
def test_norms_are_those_of_both_halves(seed: int) -> None:
    full, whole = pair(seed)
    names = ["unsprung_front_right_acceleration", "rear_right_travel", "tyre_front_right_load", "pitch_velocity"]
    random = it.RandomResponse(dict.fromkeys(names, 1.0), ROAD)
    for index in (it.RideComfort(ROAD), it.TyreLoad(ROAD), random):
        expected = it.evaluate(whole, index, it.Norm())
        found = it.evaluate(full, index, it.Norm())
        assert found.status.ok
        assert found.value == pytest.approx(expected.value, rel=2e-9)


@pytest.mark.parametrize("name", ["roll_acceleration", "anti_roll_front_force", "anti_roll_rear.k_stroke"])
def test_what_does_not_move_is_zero(name: str) -> None:
    full, _ = pair(1)
    assert it.evaluate(full, it.RandomResponse({name: 1.0}, ROAD), it.Norm()).value == 0.0


def test_a_half_has_less_to_solve_and_as_many_tyres() -> None:
    half = half_of(pair(1)[0].mechanism().on_one_track())
    assert [c.name for c in half.coordinates] == ["sprung", "pitch", "unsprung_front_left", "unsprung_rear_left"]
    assert [(len(half.tyres), len(half.roads)), len(half.struts)] == [(4, 2), 6]
    assert [strut.name for strut in half.still] == ["anti_roll_front", "anti_roll_rear"]


@pytest.mark.marathon
def test_simulated_means_are_those_of_both_halves() -> None:
    full, _ = pair(1)
    full = replace(full, rear=full.rear | it.Friction(60.0))
    method = it.ExpectedValue(realisations=2, seed=4)
    for index in (it.RideComfort(ROAD), it.TyreLoad(ROAD)):
        whole = it.evaluate(replace(full.mechanism(), mirror=()), index, method)
        assert it.evaluate(full, index, method).value == pytest.approx(whole.value, rel=1e-6)


def unlike(mechanism: it.Mechanism, kind: str) -> it.Mechanism:
    """The mechanism with its sides made unlike."""
    coordinates, struts, tyres = list(mechanism.coordinates), list(mechanism.struts), list(mechanism.tyres)
    if kind == "mass":
        coordinates[3] = replace(coordinates[3], inertia=coordinates[3].inertia * (1.0 + 1e-15 * 4))
    elif kind == "strut":
        struts[0] = replace(struts[0], network=struts[0].network | it.Damper(1.0))
    elif kind == "lever":
        struts[0] = replace(struts[0], upper={**struts[0].upper, "roll": 0.7})
    elif kind == "tyre":
        tyres[2] = replace(tyres[2], network=it.Spring(1.5e5))
    else:
        struts.append(it.Strut("seat", it.Spring(1e3), {"sprung": 1.0, "roll": 0.4}, it.GROUND))
    return replace(mechanism, coordinates=tuple(coordinates), struts=tuple(struts), tyres=tuple(tyres))


@pytest.mark.parametrize("kind", ["mass", "strut", "lever", "tyre", "seat"])
def test_sides_that_are_unlike_are_both_kept(kind: str) -> None:
    mechanism = unlike(pair(0)[0].mechanism().on_one_track(), kind)
    assert half_of(mechanism) is mechanism


def test_a_free_value_that_does_nothing_is_still_told_of() -> None:
    full = replace(pair(0)[0], anti_roll_front=it.Spring(it.free(1e3, 1e5, name="bar")))
    best = it.optimise(replace(full, front=it.Spring(2e4) | it.Damper(1e3)), it.RideComfort(ROAD), it.Norm(), starts=1)
    assert set(best.parameters) == {"bar"}


def test_a_point_moves_as_its_port() -> None:
    whole = replace(pair(1)[1], points=(it.TrackedPoint("driver", {"sprung": 1.0, "pitch": 0.3, "roll": 0.4}),))
    names = ["driver_acceleration", "sprung_acceleration", "pitch_acceleration", "roll_acceleration"]
    driver, heave, pitch, roll = it.frequency_response(it.state_space(whole, "road_front_left", names), [3.0, 30.0])[
        ..., 0
    ].T
    np.testing.assert_allclose(driver, heave + 0.3 * pitch + 0.4 * roll, rtol=1e-9)
    run = it.simulate(whole, road=it.multisine(ROAD, seed=0), duration=0.2, step=5e-4)
    expected = run["sprung_acceleration"] + 0.3 * run["pitch_acceleration"] + 0.4 * run["roll_acceleration"]
    np.testing.assert_allclose(run["driver_acceleration"], expected, atol=1e-9 * np.abs(expected).max())
    with pytest.raises(it.InerterError, match="point 'driver': unknown coordinate 'yaw'"):
        replace(whole, points=(it.TrackedPoint("driver", {"yaw": 1.0}),))
