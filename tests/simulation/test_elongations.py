"""Elongations of elements: those that springs tell are exact, the others are the integrals of their velocities."""

from __future__ import annotations

from collections import Counter
from typing import Any, Literal

import numpy as np
import pytest
from wang_su import ROAD, paper_quarter_car

import inerter as it
from inerter.networks.elements import CombinedNetwork, Element, Network, Parallel, Series
from inerter.simulation.elongations import elongations
from inerter.simulation.trajectory import Trajectory

STIFFNESS = {"k": 120e3, "ks": 1e6}
PARTS = {
    "k": it.Spring(STIFFNESS["k"]),
    "c": it.Damper(7353.0),
    "ks": it.Spring(STIFFNESS["ks"]),
    "cs": it.Damper(3200.0),
    "b": it.Inerter(328.72),
    "f": it.Friction(50.0),
    "g": it.Gap(1e-3),
    "d": it.Damper(2e3),
}
NETWORKS = [
    "k",
    "k | c",
    "k | c - b",
    "k | c - (ks | cs) - (b | f)",
    "k | c - (ks - g | cs) - (b | f)",
    "k | d - ks - c",
    "k | bridge(c, b, ks, d, cs)",
    "k | bridge(c, b, d, cs, ks - c)",
]


def _run(
    text: str, integrator: Literal["event-driven", "time-stepping"] = "event-driven"
) -> tuple[it.QuarterCar, Trajectory]:
    car = paper_quarter_car(it.network(text, **PARTS))
    road = it.multisine(ROAD, seed=3)
    return car, it.simulate(car, road=road, duration=2.0, step=5e-4, integrator=integrator)


@pytest.mark.parametrize("text", NETWORKS)
def test_elongations_add_up_around_each_loop(text: str) -> None:
    car, run = _run(text)
    network, inside = it.network(text, **PARTS), elongations(run, car.mechanism())["strut"]

    def along(part: Network) -> Any:
        if isinstance(part, Element):
            met[part.label] += 1
            return inside[part.label if met[part.label] == 1 else f"{part.label} {met[part.label]}"]
        assert isinstance(part, CombinedNetwork)
        every = [along(each) for each in part.parts]
        if isinstance(part, Parallel):
            for each in every[1:]:
                np.testing.assert_allclose(each, every[0], atol=1e-12)
            return every[0]
        if isinstance(part, Series):
            return np.sum(every, axis=0)
        a, b, c, d, e = every
        np.testing.assert_allclose(a + b, c + d, atol=1e-12)
        np.testing.assert_allclose(a + e, c, atol=1e-12)
        return a + b

    met: Counter[str] = Counter()
    np.testing.assert_allclose(along(network), run["strut_travel"], atol=1e-10)


@pytest.mark.parametrize("text", NETWORKS)
def test_springs_are_stretched_as_their_forces_say(text: str) -> None:
    car, run = _run(text)
    inside = elongations(run, car.mechanism())["strut"]
    for name in {"k", "ks"} & set(inside):
        np.testing.assert_allclose(inside[name], run[f"{name}_force"] / STIFFNESS[name], atol=1e-12)


def test_a_gap_stays_between_its_ends_and_friction_that_sticks_does_not_move() -> None:
    car, run = _run("k | c - (ks - g | cs) - (b | f)")
    inside = elongations(run, car.mechanism())["strut"]
    assert np.abs(inside["g"]).max() <= 1e-3 * (1.0 + 1e-9)
    sticks = [(begin, end) for begin, end in run.intervals("f", "stick") if end - begin > 0.004]
    assert sticks
    for begin, end in sticks:
        held = inside["f"][(run.time > begin) & (run.time < end)]
        assert np.ptp(held) < 1e-9


def test_a_node_that_no_spring_tells_is_where_a_very_soft_spring_would_say() -> None:
    """A spring of 1 mN/m in parallel with the inerter changes nothing but tells its elongation exactly."""
    car, run = _run("k | c - b")
    soft = paper_quarter_car(it.network("k | c - (b | s)", **PARTS, s=it.Spring(1e-3)))
    road = it.multisine(ROAD, seed=3)
    told = it.simulate(soft, road=road, duration=2.0, step=5e-4)["b_stroke"]
    found = elongations(run, car.mechanism())["strut"]["b"]
    np.testing.assert_allclose(found - found[0], told - told[0], atol=5e-6)


def test_both_integrators_agree() -> None:
    car, run = _run("k | c - (ks | cs) - (b | f)")
    other = elongations(_run("k | c - (ks | cs) - (b | f)", "time-stepping")[1], car.mechanism())["strut"]
    for name, values in elongations(run, car.mechanism())["strut"].items():
        np.testing.assert_allclose(other[name], values, atol=2e-4)


def test_an_element_of_the_same_name_has_a_number() -> None:
    car = paper_quarter_car(it.network("k | c - k", **PARTS))
    run = it.simulate(car, road=it.multisine(ROAD, seed=3), duration=0.1, step=5e-4)
    inside = elongations(run, car.mechanism())
    assert list(inside["strut"]) == ["k", "c", "k 2"]
    np.testing.assert_allclose(inside["strut"]["c"] + inside["strut"]["k 2"], inside["strut"]["k"], atol=1e-12)
    np.testing.assert_allclose(next(iter(inside["tyre"].values())), run["tyre_deflection"], atol=1e-15)
