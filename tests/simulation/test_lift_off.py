"""Peaks, and tyres that are pulled: closed forms of a mass on a tyre, and laws of any run."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import inerter as it

G, MASS, STIFFNESS = 9.80665, 40.0, 2e5
OMEGA = math.sqrt(STIFFNESS / MASS)


def wheel():
    """A mass on a tyre that nothing damps, but for a damper to the ground so soft that it does nothing."""
    return it.Mechanism(
        coordinates=(it.Coordinate("mass", MASS),),
        struts=(it.Strut("sky", it.Damper(1e-9), {"mass": 1.0}, it.GROUND),),
        tyres=(it.Tyre("tyre", it.Spring(STIFFNESS), {"mass": 1.0}, "road"),),
        roads=(it.RoadInput("road"),),
    )


@pytest.mark.parametrize("height", [0.003, -0.004, 0.01])
def test_when_a_tyre_would_lift(height):
    # A road that stands at its height from t = 0 on does not kick, so it falls after a while.
    road = it.step(height, time=0.05)
    run = it.simulate(wheel(), road=road, duration=0.25, step=1e-4)
    share = MASS * G / (STIFFNESS * abs(height))
    assert run.static_loads == {"tyre": pytest.approx(MASS * G)}
    within = math.acos(share) / OMEGA  # before and after each greatest pull
    first = 0.05 + (math.pi / OMEGA if height > 0 else 0.0)
    pulls = first + 2 * math.pi / OMEGA * np.arange(3)
    expected = [(max(at - within, 0.05), at + within) for at in pulls]
    whole = [span for span in expected if span[1] < 0.25]
    found = [(one.begin, one.end) for one in run.lift_offs[: len(whole)]]
    np.testing.assert_allclose(found, whole, atol=1.1e-4 if height < 0 else 1e-6)
    assert run.lift_offs[1].beyond == pytest.approx(STIFFNESS * abs(height) - MASS * G, rel=1e-3)
    assert run.integration_status.ok
    assert run.status.kind is it.StatusKind.INACCURATE
    since = re.search(r"^lift-off of tyre for .+: the motion after (\S+) (m?s) is not valid$", run.status.message)
    assert float(since[1]) * {"s": 1.0, "ms": 1e-3}[since[2]] == pytest.approx(expected[0][0], rel=1e-3, abs=1.1e-4)


def test_a_tyre_that_stays():
    run = it.simulate(wheel(), road=it.step(0.0015, time=0.05), duration=0.2, step=1e-4)
    assert run.lift_offs == run.notes == ()
    assert run.status.ok
    least = run.least_tyre_loads["tyre"]
    assert least.value == pytest.approx(MASS * G - STIFFNESS * 0.0015, rel=1e-4)
    assert OMEGA * (least.time - 0.05) % (2 * math.pi) == pytest.approx(math.pi, abs=0.01)


@pytest.mark.parametrize("integrator", ["event-driven", "time-stepping"])
def test_peaks_are_samples(integrator):
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3) - (it.Inerter(30.0) | it.Friction(5.0)))
    run = it.simulate(car, road=it.bump(0.1, 1.0, 10.0), duration=1.0, step=2e-4, integrator=integrator)
    for name in ("sprung_acceleration", "travel", "tyre_load"):
        peak, values = run.peak(name), run[name]
        assert abs(peak.value) == np.abs(values).max()
        assert values[np.searchsorted(run.time, peak.time)] == peak.value
    spans = sum(one.end - one.begin for one in run.lift_offs)
    assert spans == pytest.approx(np.mean(run["tyre_load"] > 285.0 * G), abs=1e-3 * len(run.lift_offs) + 1e-9)
    assert run.least_tyre_loads["tyre"].value == pytest.approx(285.0 * G - run["tyre_load"].max(), rel=1e-12)


def test_a_rig_has_no_tyres():
    run = it.simulate(it.Rig(it.Spring(1e4) | it.Damper(100.0)), displacement=it.sine(1e-3, 2.0), duration=0.5)
    assert run.static_loads == run.least_tyre_loads == {}
    assert run.lift_offs == run.notes == ()


def test_where_the_static_load_is_not_known():
    held = it.Mechanism(
        coordinates=(it.Coordinate("mass", MASS),),
        struts=(it.Strut("sky", it.Spring(1e4), {"mass": 1.0}, it.GROUND),),
        tyres=(it.Tyre("tyre", it.Spring(STIFFNESS), {"mass": 1.0}, "road"),),
        roads=(it.RoadInput("road"),),
    )
    run = it.simulate(held, road=it.step(0.01, time=0.01), duration=0.1, step=1e-4)
    assert run.lift_offs == ()
    assert run.notes[0].startswith("Wheel lift-off cannot be checked. The static tyre loads are not known")


def test_a_profile_of_two_tracks(tmp_path):
    """Each wheel meets the profile of its track, the rear ones later."""
    x = np.linspace(0.0, 30.0, 301)
    lines = ["distance [m];left [mm];right [mm]"]
    lines += [f"{d:.2f};{5 * math.sin(d):.6f};{3 * math.cos(2 * d) - 3:.6f}".replace(".", ",") for d in x]
    (tmp_path / "road.csv").write_text("\n".join(lines))
    profile = it.read_profile(tmp_path / "road.csv")
    strut = it.Spring(25e3) | it.Damper(1500.0)
    car = it.FullCar(1400, 2400, 520, 45, 40, 220e3, 220e3, 1.2, 1.5, 1.52, 1.5, strut, strut)
    run = it.simulate(car, road=profile.signals(speed=10.0), duration=2.0, step=1e-3)
    t = run.time
    np.testing.assert_allclose(run["road_front_left"], 5e-3 * np.sin(10 * t), atol=1e-6)
    late = np.maximum(10 * t - 2.7, 0.0)
    np.testing.assert_allclose(run["road_rear_right"], 3e-3 * (np.cos(2 * late) - 1.0), atol=2e-6)
