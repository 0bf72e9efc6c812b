"""Requests of `simulate` that cannot be met: one error of the project's own each, with the words that help."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter.errors import DesignError, InerterError, MechanismError, SignalError, SimulationError
from inerter.networks.elements import Network

STRUT = it.Spring(120e3) | it.Damper(2000.0)
CAR = paper_quarter_car(STRUT)
WAVE = it.sine(1e-2, 2.0)
TIME = np.linspace(0.0, 1.0, 101)


def drive(vehicle: Any = CAR, **request: Any) -> it.Trajectory:
    return it.simulate(vehicle, **({"road": WAVE, "duration": 0.1, "step": 1e-3} | request))


def rig(device: Network, **request: Any) -> it.Trajectory:
    return it.simulate(it.Rig(device), **({"displacement": WAVE, "duration": 0.1, "step": 1e-3} | request))


def table(time: Any = TIME, value: Any = None, **how: Any) -> it.Signal:
    return it.Signal.sampled(time, np.zeros(len(time)) if value is None else value, **how)


def spoilt(value: float) -> np.ndarray:
    return np.where(np.arange(TIME.size) == 7, value, 0.0)


BODY = it.Coordinate("x", 10.0)
SLACK = it.Mechanism((BODY,), (it.Strut("s", it.Spring(1e3) - it.Gap(1e-3) - it.Gap(1e-3), {"x": 1.0}, it.GROUND),))
CLASH = it.Mechanism(
    (BODY, it.Coordinate("y", 2.0)),
    (it.Strut("s", it.Gap(1e-3), {"x": 1.0}, {"y": 1.0}), it.Strut("t", it.Spring(1e3), {"y": 1.0}, it.GROUND)),
)

SIGNALS: dict[str, tuple[Callable[[], object], str]] = {
    "a sample that is not a number": (lambda: table(value=spoilt(np.nan)), r"finite"),
    "an infinite sample": (lambda: table(value=spoilt(np.inf)), r"finite"),
    "a time that is not a number": (lambda: table(time=np.where(TIME[3] == TIME, np.nan, TIME)), r"finite"),
    "an unsorted time axis": (lambda: table(time=TIME[::-1]), r"must increase.*Sort the samples"),
    "a repeated time": (lambda: table(time=np.sort(np.append(TIME, 0.5))), r"must increase.*drop repeated ones"),
    "a time axis of one": (lambda: table(time=[0.0]), r"at least two samples, got 1"),
    "a time axis too short": (lambda: table(value=np.zeros(99)), r"one value for each time, got 101 times and 99"),
    "a slope that is not a number": (lambda: table(derivative=spoilt(np.nan)), r"finite"),
    "a hold that is not known": (lambda: table(hold="quintic"), r'one of "cubic", "linear" and "zero", got .quintic.'),
}

MECHANISMS: dict[str, tuple[Callable[[], object], str]] = {
    "a gap between inertias": (
        lambda: drive(paper_quarter_car(STRUT | it.Inerter(5.0) - it.Gap(1e-4))),
        r"Gap 'gap' has inertia .* on both sides and no compliance.*in series with it",
    ),
    "a gap between masses": (lambda: drive(CLASH, road=None), r"Gap 'gap' has inertia .* on both sides"),
    "a gap between a mass and the ground": (
        lambda: drive(it.Mechanism((BODY,), (it.Strut("s", it.Gap(1e-3), {"x": 1.0}, it.GROUND),)), road=None),
        r"no compliance",
    ),
    "a gap between a given motion and an inerter": (
        lambda: rig(it.Gap(1e-4) - it.Inerter(3.0)),
        r"Gap 'gap' has inertia \(or a given motion\) on both sides",
    ),
    "a friction alone on the rig": (
        lambda: rig(it.Friction(10.0)),
        r"force of 'f' is not determined when it does not slip.*in series with it",
    ),
    "a friction beside a spring on the rig": (lambda: rig(it.Friction(10.0) | it.Spring(1e3)), r"not determined"),
    "frictions in a row on the rig": (
        lambda: rig(it.Friction(10.0, name="a") - it.Friction(20.0, name="b")),
        r"force of 'a' and 'b' is not determined",
    ),
    "gaps in a row": (lambda: drive(SLACK, road=None), r"unconstrained while the adjacent gaps are open.*one"),
    "a gap beside nothing but a friction of zero": (
        lambda: rig(it.Spring(1e3) - it.Gap(1e-3) - (it.Friction(0.0) | it.Gap(1e-3))),
        r"unconstrained",
    ),
}

REQUESTS: dict[str, tuple[Callable[[], object], str]] = {
    "a step too long for a formula": (
        lambda: drive(road=it.multisine(ROAD, seed=0), step=1e-3),
        r"step of 1 ms is too long for .*goes up to 1000 Hz\. Take 0.5 ms or less",
    ),
    "a step too long for a table": (
        lambda: drive(road=table(), step=2e-2, duration=0.2),
        r"step of 20 ms is too long .* samples are 10 ms apart\. Take 10 ms or less",
    ),
    "no input": (lambda: drive(road=None), r"motion of road is missing"),
    "no input on the rig": (lambda: rig(it.Spring(1e3), displacement=None), r"motion of displacement is missing"),
    "a road for one wheel alone": (
        lambda: drive(paper_half_car(STRUT, STRUT), road={"road_front": WAVE}),
        r"motion of road_rear is missing",
    ),
    "a road that is not there": (lambda: drive(road={"lane": WAVE}), r"Unknown input 'lane'.*available: road"),
    "a force that is not there": (lambda: drive(forces={"wind": WAVE}), r"Unknown input 'wind'.*sprung_force"),
    "an array for a signal": (lambda: drive(road=np.zeros(101)), r"\(time, value\), got ndarray\.$"),
    "road and displacement": (lambda: drive(displacement=WAVE), r"either road or displacement"),
    "a delay without a speed": (
        lambda: drive(paper_half_car(STRUT, STRUT)),
        r"2.04 m later, but neither the signal nor simulate\(\.\.\., speed=\.\.\.\) states",
    ),
    "a speed of zero": (lambda: drive(paper_half_car(STRUT, STRUT), speed=0.0), r"speed.*0"),
    "a signal that ends too early": (
        lambda: drive(road=table(), duration=1.5),
        r"lasts 1 s, but the simulation lasts until 1.5 s",
    ),
    "a duration between two steps": (
        lambda: drive(duration=0.1005),
        r"whole number of steps, got 0.1005 s in steps of 0.001 s\. Try a step of 0.000995049505 s\.$",
    ),
    "no duration": (lambda: drive(road=table(), duration=None), r"does not repeat: give a duration"),
    "a negative duration": (lambda: drive(duration=-1.0), r"[Dd]uration.*-1"),
    "a step that is not a number": (lambda: drive(step=np.nan), r"step.*nan"),
    "more memory than there may be": (
        lambda: drive(duration=100.0, step=1e-4, memory_limit=2e6),
        r"needs about .* GiB for 1000000 steps, more than the limit .*memory_limit",
    ),
    "more memory than the limit that is set": (
        lambda: drive(duration=1e5, step=1e-4),
        r"more than the limit of 4 GiB\. Take a longer step",
    ),
    "an unknown integrator": (
        lambda: drive(integrator="magic"),
        r'integrator is "event-driven" or "time-stepping", got .magic.',
    ),
    "an unknown initial state": (
        lambda: drive(initial="warm"),
        r'"rest", "preload", "periodic", a trajectory or an array, got .warm.',
    ),
    "an initial state of another length": (
        lambda: drive(initial=[0.0, 1.0]),
        r"needs 4 finite numbers \(sprung_velocity, unsprung_velocity, ",
    ),
    "an initial state that is not finite": (lambda: drive(initial=[0.0, np.nan, 0.0, 0.0]), r"needs 4 finite numbers"),
    "a preload that nothing carries": (
        lambda: drive(
            paper_quarter_car(it.Damper(2000.0)), road=None, forces={"sprung_force": it.step(300.0)}, initial="preload"
        ),
        r"static load is not carried by springs",
    ),
    "a periodic state of what does not repeat": (
        lambda: drive(road=table(), initial="periodic"),  # which has a duration
        r'does not repeat: give a duration, and an initial state other than "periodic"; or a periodic signal',
    ),
    "a periodic state of another length": (
        lambda: drive(initial="periodic", duration=0.3),
        r"recorded over one period, 0.5 s; got duration = 0.3 s",
    ),
    "periods that do not fit": (
        lambda: drive(forces={"sprung_force": it.sine(10.0, 3.0)}, initial="periodic", duration=None),
        r"not multiples of each other",
    ),
    "every half step": (lambda: drive(every=0.5), r"`every` must be a positive whole number of steps, got 0.5"),
    "a held motion on a damper": (
        lambda: drive(
            it.Mechanism((BODY,), (it.Strut("s", STRUT, {"x": 1.0}, {"z": 1.0}),), roads=(it.RoadInput("z"),)),
            road=table(hold="zero"),
        ),
        r"damper follows the velocity of 'z'.*hold=\"cubic\" or \"linear\"",
    ),
    "a held motion on a friction": (
        lambda: rig(it.Friction(20.0) - it.Spring(1e4), displacement=table(hold="zero")),
        r"A friction element or a gap moves with 'displacement' without a mass between",
    ),
    "a held motion on a gap": (
        lambda: rig(it.Gap(1e-3) - it.Spring(1e4), displacement=table(hold="zero")),
        r"A friction element or a gap moves with 'displacement' without a mass between.*hold=\"cubic\" or \"linear\"",
    ),
    "a bent motion on an inerter": (
        lambda: rig(it.Inerter(3.0), displacement=table(hold="linear")),
        r"follows the acceleration of 'displacement'.*hold=\"cubic\"",
    ),
    "an output that is not there": (lambda: drive()["sprung_aceleration"], r"Did you mean sprung_acceleration"),
    "intervals of an element that is not there": (
        lambda: drive().intervals("f", "stick"),
        r"Unknown friction or gap 'f'.*none",
    ),
}


@pytest.mark.parametrize(("make", "words"), SIGNALS.values(), ids=SIGNALS)
def test_signals_that_cannot_be(make: Callable[[], object], words: str) -> None:
    with pytest.raises(SignalError, match=words):
        make()


@pytest.mark.parametrize(("make", "words"), MECHANISMS.values(), ids=MECHANISMS)
def test_mechanisms_that_cannot_be_simulated(make: Callable[[], object], words: str) -> None:
    with pytest.raises(MechanismError, match=words):
        make()


@pytest.mark.parametrize(("make", "words"), REQUESTS.values(), ids=REQUESTS)
def test_requests_that_cannot_be_met(make: Callable[[], object], words: str) -> None:
    with pytest.raises(SimulationError, match=words):
        make()


def test_a_free_value_must_be_fixed_first() -> None:
    with pytest.raises(DesignError, match=r"still has free values: c"):
        drive(paper_quarter_car(it.Spring(1e5) | it.Damper(it.free(1e2, 1e4, "c"))))


@pytest.mark.parametrize("vehicle", [None, 3.0, it.QuarterCar, STRUT])
def test_what_is_no_vehicle(vehicle: object) -> None:
    with pytest.raises(InerterError, match=r"Expected a vehicle"):
        drive(vehicle)


def test_a_memory_limit_stops_a_run_before_it_starts() -> None:
    """No integration has begun: the progress is never told."""
    told: list[float] = []
    with pytest.raises(SimulationError, match=r"limit"):
        drive(duration=50.0, step=1e-4, memory_limit=1e6, progress=told.append)
    assert not told
