"""One road for all axles: an FMU delays it as `simulate` does."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from designs import design

import inerter as it

pytest.importorskip("fmpy", reason='FMPy steps FMUs: pip install "inerter[test]".')
from fmu_master import Master
from fmu_roads import driven, error, needs_compiler, road

pytestmark = [needs_compiler, pytest.mark.usefixtures("unoptimised")]
K, C, B = it.Spring(30e3), it.Damper(2e3), it.Inerter(100.0)
KINDS = ("fmu", "fmu3")
SHOWN = ("front_force", "rear_force", "tyre_front_load", "tyre_rear_load", "sprung_acceleration")


def half_car(rear: it.Network = K | C - B) -> it.HalfCar:
    return it.HalfCar(700.0, 900.0, 40.0, 40.0, 2e5, 2e5, 1.1, 1.4, K | C, rear)


@pytest.fixture
def masters() -> Iterator[list[Master]]:
    opened: list[Master] = []
    yield opened
    for one in opened:
        one.close()


def opened(
    masters: list[Master], vehicle: it.Vehicle, kind: str, folder: Path, speed: float, at: float | None = None
) -> Master:
    masters.append(
        Master(
            it.export(vehicle, kind, folder / f"{len(masters)}.fmu", speed=speed), {} if at is None else {"speed": at}
        )
    )
    return masters[-1]


def simulated(vehicle: it.Vehicle, signal: it.Signal, speed: float, step: float, shown: tuple[str, ...]) -> np.ndarray:
    run = it.simulate(vehicle, road=signal, speed=speed, step=step, duration=signal.duration)
    assert run.integration_status.ok
    return np.array([run[name][1:] for name in shown]).T


@pytest.mark.parametrize(
    ("kind", "speed"), sampled([("fmu", 20.0), ("fmu", 7.3), ("fmu3", 25.0)], [("fmu", 7.3)], kept=1)
)
def test_the_rear_axle_meets_the_road_later(kind: str, speed: float, masters: list[Master], tmp_path: Path) -> None:
    """After 125, 342.4... and 100 steps of a millisecond; with the speed of the export, and with another one."""
    signal, height, slope = road(1.0, 1e-3)
    expected = simulated(half_car(), signal, speed, 1e-3, SHOWN)
    for master in (
        opened(masters, half_car(), kind, tmp_path, speed),
        opened(masters, half_car(), kind, tmp_path, 31.0, at=speed),
    ):
        assert "road_front_velocity" in master.references
        assert "road_rear_velocity" not in master.references
        assert error(driven(master, height, slope, 1e-3, SHOWN), expected) < 1e-9


@pytest.mark.parametrize("number", sampled([n for n in range(90) if n % 5 in (1, 2)][:30], kept=1))
def test_random_half_and_full_cars(number: int, masters: list[Master], tmp_path: Path) -> None:
    vehicle, step = design(number), 1e-3
    speed = float(np.random.default_rng([741, number]).uniform(5.0, 40.0))
    signal, height, slope = road(0.6, step, number)
    shown = tuple(f"{m.name}_{'force' if isinstance(m, it.Strut) else 'load'}" for m in vehicle.mechanism().mounts())
    expected = simulated(vehicle, signal, speed, step, shown)
    seen = np.sqrt(np.mean(expected**2, axis=0)) > 1e-9 * np.sqrt(np.mean(expected**2))
    found = driven(opened(masters, vehicle, "fmu", tmp_path, speed), height, slope, step, shown)
    assert error(found[:, seen], expected[:, seen]) < 1e-9


@pytest.mark.campaign
def test_friction_and_backlash_behind_a_delay(masters: list[Master], tmp_path: Path) -> None:
    rear = K | C - it.Gap(5e-4) - (it.Spring(1e6) | it.Damper(3200.0)) - (B | it.Friction(20.0))
    signal, height, slope = road(1.0, 1e-3)
    found = driven(opened(masters, half_car(rear), "fmu", tmp_path, 20.0), height, slope, 1e-3, SHOWN)
    assert error(found, simulated(half_car(rear), signal, 20.0, 1e-3, SHOWN)) < 1e-4


@pytest.mark.parametrize("kind", sampled(KINDS, seldom=["fmu3"]))
def test_steps_of_any_length_leave_the_delay(kind: str, masters: list[Master], tmp_path: Path) -> None:
    """The velocity of the road is one cubic for a while, and then zero."""
    master = opened(masters, half_car(), kind, tmp_path, 20.0)
    cubic = np.polynomial.Polynomial([0.3, -2.0, 15.0, -40.0])
    rng = np.random.default_rng(1)
    ends = []
    for cuts in (np.linspace(0.0, 0.4, 9), np.sort([0.0, *rng.uniform(0.0, 0.4, 20), 0.2, 0.4])):
        master.reset()
        for begin, end in pairwise(cuts):
            values = [cubic.deriv(n)(begin) if n else cubic(begin) for n in range(4)]
            master.set("road_front_velocity", *(values if begin < 0.2 - 1e-9 else [0.0] * 4))
            master.step(end - begin)
        ends.append(master.get(*SHOWN))
    assert np.allclose(ends[0], ends[1], rtol=1e-10)


@pytest.mark.parametrize("kind", sampled(KINDS, seldom=["fmu"]))
def test_a_state_brings_the_road_between_the_axles(kind: str, masters: list[Master], tmp_path: Path) -> None:
    _, height, slope = road(0.4, 1e-3)
    one, other = (opened(masters, half_car(), kind, tmp_path, 20.0) for _ in range(2))
    driven(one, height[:201], slope[:201], 1e-3, SHOWN)
    saved, time = one.save(), one.time
    later = driven(one, height[200:], slope[200:], 1e-3, SHOWN)
    for master in (other, one):
        master.restore(saved, time)
        assert np.array_equal(driven(master, height[200:], slope[200:], 1e-3, SHOWN), later)


@pytest.mark.campaign
def test_an_input_that_is_held_arrives_as_it_was(masters: list[Master], tmp_path: Path) -> None:
    """Without derivatives: the rear axle of a car with equal ends sees what the front axle saw."""
    car = it.HalfCar(700.0, 900.0, 40.0, 40.0, 2e5, 2e5, 1.25, 1.25, K | C, K | C)
    master = opened(masters, car, "fmu", tmp_path, 25.0)
    rng = np.random.default_rng(2)
    for _ in range(300):
        master.set("road_front_velocity", rng.normal())
        master.step(1e-3)
    one = it.export(car, "fmu", tmp_path / "two.fmu")
    masters.append(Master(one))
    rng, past = np.random.default_rng(2), [0.0] * 100
    for _ in range(300):
        past.append(rng.normal())
        masters[1].set("road_front_velocity", past[-1])
        masters[1].set("road_rear_velocity", past[-101])
        masters[1].step(1e-3)
    assert np.allclose(master.get(*SHOWN), masters[1].get(*SHOWN), rtol=1e-9)


def test_what_has_no_speed() -> None:
    with pytest.raises(it.InerterError, match=r"speed must be a positive number of m/s, got -1"):
        it.export(half_car(), "fmu", speed=-1.0)
    with pytest.raises(it.InerterError, match=r"speed is 1e-30 m/s; an FMU supports 1e-12 to 1e\+15 m/s"):
        it.export(half_car(), "fmu", speed=1e-30)
