"""Struts that are FMUs of their own have the force of `simulate`, and coupled they move a vehicle as it does."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from designs import design, network
from wang_su import paper_quarter_car as car

import inerter as it

pytest.importorskip("fmpy", reason='FMPy steps FMUs: pip install "inerter[test]".')
from fmu_master import Master
from fmu_roads import error, needs_compiler, road
from strut_master import Host, driven

pytestmark = [needs_compiler, pytest.mark.usefixtures("unoptimised")]
K, C, B = it.Spring(120e3), it.Damper(7544.2), it.Inerter(366.52)
SHAFT = it.Spring(1e6) | it.Damper(3200.0)
HEAVY, LIGHT = K | it.Damper(5e3) | it.Inerter(60.0), K | it.Damper(5e3) | it.Inerter(5.0)
BACKLASH = K | C - it.Gap(5e-4) - SHAFT - (B | it.Friction(20.0))
STRUTS = {"S3": K | C - B, "inerter between the ends": HEAVY, "backlash": BACKLASH}
KINDS = ("fmu", "fmu3")


@pytest.fixture
def masters(tmp_path: Path) -> Iterator[list[Master]]:
    opened: list[Master] = []
    yield opened
    for one in opened:
        one.close()


def strut_of(masters: list[Master], vehicle: object, kind: str, folder: Path, part: str = "strut") -> Master:
    masters.append(Master(it.export(vehicle, kind, folder / f"{kind}-{len(masters)}.fmu", part=part)))
    return masters[-1]


def coupled(
    masters: list[Master], vehicle: it.Vehicle, kind: str, folder: Path, way: str, step: float, duration: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Accelerations of the coordinates by a host with struts that are FMUs, and by simulation."""
    signal, height, slope = road(duration, step)
    mechanism = vehicle.mechanism()
    struts = {s.name: strut_of(masters, vehicle, kind, folder, s.name) for s in mechanism.struts}
    names = [one.name for one in mechanism.roads]
    run = it.simulate(vehicle, road=dict.fromkeys(names, signal), step=step, duration=duration)
    expected = np.array([run[f"{c.name}_acceleration"][1:] for c in mechanism.coordinates]).T
    found = driven(
        Host(vehicle, struts),
        lambda time: dict.fromkeys(names, height[round(time / step)]),
        lambda time: dict.fromkeys(names, slope[round(time / step)]),
        step,
        height.size - 1,
        way,
    )
    touched = {round(event.time / step) + i for event in run.events if event.element == "gap" for i in (-1, 0)}
    kept = [i for i in range(len(found)) if i not in touched]  # at a jump a sample is before or after it
    return found[kept], expected[kept]


@pytest.mark.parametrize(
    ("kind", "name"), sampled([(kind, name) for kind in KINDS for name in STRUTS], [("fmu3", "backlash")], kept=1)
)
def test_a_vehicle_of_strut_fmus_moves_as_the_simulation(
    name: str, kind: str, masters: list[Master], tmp_path: Path
) -> None:
    assert error(*coupled(masters, car(STRUTS[name]), kind, tmp_path, "rollback", 1e-3)) < 0.01
    assert not masters[0].messages


@pytest.mark.campaign
def test_directional_derivatives_alone_are_of_second_order(masters: list[Master], tmp_path: Path) -> None:
    errors = [error(*coupled(masters, car(HEAVY), "fmu", tmp_path, "derivatives", step)) for step in (1e-3, 5e-4)]
    assert errors[0] < 0.01
    assert 3.5 < errors[0] / errors[1] < 4.5


@pytest.mark.parametrize("number", sampled([n for n in range(50) if n % 5 < 3], kept=1))
def test_random_vehicles_of_strut_fmus(number: int, masters: list[Master], tmp_path: Path) -> None:
    """One road under all axles at once, and a step of which ten are a period of the fastest motion."""
    vehicle = design(number)
    fastest = float(np.max(np.abs(np.linalg.eigvals(it.state_space(vehicle).A))))
    step = min(1e-3, 0.2 / fastest)
    found, expected = coupled(masters, vehicle, "fmu", tmp_path, "rollback", step, 200 * step)
    seen = np.sqrt(np.mean(expected**2, axis=0)) > 1e-6 * np.sqrt(np.mean(expected**2))
    assert error(found[:, seen], expected[:, seen]) < 0.01


@pytest.mark.parametrize("kind", sampled(KINDS, seldom=["fmu3"]))
def test_accelerations_of_the_step_before(kind: str, masters: list[Master], tmp_path: Path) -> None:
    """They do while b (1/m1 + 1/m2) is below one, to first order; from one on they diverge, and the log says so."""
    found, expected = coupled(masters, car(LIGHT), kind, tmp_path, "explicit", 5e-4)
    assert error(found, expected) < 0.05
    assert not masters[0].messages
    found, _ = coupled(masters, car(HEAVY), kind, tmp_path, "explicit", 5e-4)
    assert np.all(np.isinf(found))
    assert [message.partition(":")[0] for message in masters[1].messages] == ["coupling_ratio is one or more"]


@pytest.mark.parametrize("kind", sampled(KINDS, ["fmu3"]))
def test_a_host_that_gives_no_acceleration_is_told(kind: str, masters: list[Master], tmp_path: Path) -> None:
    for strut, count in ((HEAVY, 1), (K | C - B, 0)):
        master = strut_of(masters, car(strut), kind, tmp_path)
        for _ in range(3):
            master.set("upper_displacement", 0.01)
            master.step(1e-3)
        assert len([one for one in master.messages if "no acceleration was set" in one]) == count


def test_inertance_and_coupling_ratio(masters: list[Master], tmp_path: Path) -> None:
    master = strut_of(masters, car(HEAVY), "fmu", tmp_path)
    assert master.get("inertance", "coupling_ratio") == pytest.approx([60.0, 60.0 / 181.75 + 60.0 / 25.0], rel=1e-12)
    assert list(master.slopes("strut_force", ["upper_acceleration", "lower_acceleration"])) == pytest.approx(
        [60.0, -60.0]
    )
    assert list(master.slopes("strut_force", ["upper_velocity", "lower_displacement"])) == pytest.approx([5e3, -120e3])


@pytest.mark.parametrize("number", sampled(range(30), [0], kept=1))
def test_inertance_is_that_of_the_admittance(number: int, masters: list[Master], tmp_path: Path) -> None:
    """Which is b s at high frequencies."""
    strut = network(np.random.default_rng([74, number]))
    masters.append(Master(it.export(strut, "fmu", tmp_path / "strut.fmu")))
    s = 1e9
    expected = float(np.real(strut.admittance(np.array([s + 0j]))[0])) / s
    assert masters[0].get("inertance")[0] == pytest.approx(expected, rel=1e-6, abs=1e-4)


def test_the_inertance_is_another_where_friction_sticks(masters: list[Master], tmp_path: Path) -> None:
    strut = K | it.Inerter(30.0) - (it.Inerter(60.0) | it.Friction(5.0))
    master = strut_of(masters, car(strut), "fmu", tmp_path)
    assert master.get("inertance") == pytest.approx([30.0], rel=1e-6)
    master.set("upper_acceleration", 1.0)
    assert master.get("strut_force", "inertance") == pytest.approx([(30.0 * 60.0 + 30.0 * 5.0) / 90.0, 20.0], rel=1e-5)


@pytest.mark.parametrize("kind", sampled(KINDS, seldom=["fmu"]))
def test_the_force_follows_from_the_motion(kind: str, masters: list[Master], tmp_path: Path) -> None:
    """Ends that move as the simulation of the vehicle says, with lines as accelerations."""
    vehicle, step = car(BACKLASH), 5e-4
    run = it.simulate(vehicle, road=road(0.5, step)[0], step=step, duration=0.5)
    one, other = (strut_of(masters, vehicle, kind, tmp_path) for _ in range(2))
    found = []
    for at in range(run.time.size - 1):
        if at == 500:
            other.restore(one.save(), one.time)
        for master in (one, *([other] if at >= 500 else [])):
            move(master, run, at, step)
            master.step(step)
            move(master, run, at + 1, step)
        found.append(one.get("strut_force"))
        assert at < 500 or np.array_equal(found[-1], other.get("strut_force"))  # from a state, bit for bit
    assert error(np.array(found), run["strut_force"][1:, None]) < 1e-4


def move(master: Master, run: it.Trajectory, at: int, step: float) -> None:
    for end, mass in (("upper", "sprung"), ("lower", "unsprung")):
        acceleration = run[f"{mass}_acceleration"]
        for what in ("displacement", "velocity"):
            master.set(f"{end}_{what}", run[f"{mass}_{what}"][at])
        rate = (acceleration[at + 1] - acceleration[at]) / step if at + 1 < acceleration.size else 0.0
        master.set(f"{end}_acceleration", acceleration[at], rate)


def test_the_mean_force_is_what_the_ends_have_felt(masters: list[Master], tmp_path: Path) -> None:
    """Of a spring and an inerter at a constant acceleration, by hand."""
    master = strut_of(masters, car(it.Spring(1e4) | it.Inerter(10.0)), "fmu", tmp_path)
    master.set("upper_acceleration", 2.0)
    for at in range(2):
        master.step(0.1)
        begin, end = 0.1 * at, 0.1 * (at + 1)
        assert master.get("mean_force") == pytest.approx([20.0 + 1e4 * (end**3 - begin**3) / 3.0 / 0.1], rel=1e-12)


def test_what_only_a_host_can_know_is_refused() -> None:
    with pytest.raises(it.InerterError, match=r"friction 'f' is between the ends of the strut itself.*whole vehicle"):
        it.export(K | it.Friction(10.0), "fmu")
    with pytest.raises(it.InerterError, match="gap 'gap' is between the ends"):
        it.export(K | it.Gap(0.01), "fmu")


def test_parts_and_speeds_that_a_kind_cannot_say() -> None:
    with pytest.raises(
        it.InerterError, match="An export to matlab does not accept part: it does not support a strut alone"
    ):
        it.export(car(HEAVY), "matlab", part="strut")
    with pytest.raises(it.InerterError, match="An export to spice does not accept speed"):
        it.export(car(HEAVY), "spice", speed=25.0)
    with pytest.raises(it.InerterError, match="Unknown part 'wheel'; available: strut"):
        it.export(car(HEAVY), "fmu", part="wheel")
    half = it.HalfCar(400.0, 200.0, 25.0, 20.0, 1.2e5, 1e5, 0.8, 1.2, K | C, K | C - B)
    assert re.findall(r"^\.subckt (\w+)", it.export(half, "spice", part="rear"), re.MULTILINE) == ["rear"]
