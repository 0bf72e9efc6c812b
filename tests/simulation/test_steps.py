"""Whatever the step: nothing fails, the same happens in the same order, and what differs vanishes as it should."""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest
from campaigns import sampled
from members import DURATION, Member, extreme, member, stopping

import inerter as it
from inerter.errors import MechanismError, SimulationError
from inerter.systems.graph import full_graph

STEPS = (5e-4, 4e-4, 2.5e-4, 2e-4, 1e-4, 5e-5, 4e-5, 2.5e-5, 2e-5, 1.25e-5, 1e-5, 5e-6)
SAMPLING = 2e-3
ROUNDING = 1e-8  # of times [s] and states (relative) where a table of samples is the same for every step
FLOOR = 1e-9  # of states: what is left of an error is rounding
FORMULAS = ("sine", "multisine", "chirp", "bump", "sum", "sum with steps")  # tabled at every step, to fourth order


def simulated(chosen: Member, step: float, scale: float = 1.0) -> it.Trajectory:
    inputs = {name: signal * scale for name, signal in chosen.inputs.items()}
    return it.simulate(chosen.vehicle, duration=DURATION, step=step, every=round(SAMPLING / step), **inputs)


def sequence(run: it.Trajectory) -> list[tuple[str, str, str]]:
    return [(e.element, e.before, e.after) for e in run.events]


def state_names(chosen: Member) -> list[str]:
    """Outputs that no event breaks: motions of masses, and forces of springs."""
    mechanism = chosen.vehicle.mechanism()
    springs = [b.label for b in full_graph(mechanism).branches if isinstance(b.element, it.Spring)]
    return [f"{c.name}_{what}" for c in mechanism.coordinates for what in ("displacement", "velocity")] + [
        f"{label}_force" for label in springs
    ]


def apart(chosen: Member, run: it.Trajectory, finest: it.Trajectory) -> float:
    """The largest difference of a state, over the largest of its unit."""
    names, largest = state_names(chosen), dict[str, float]()
    for name in names:
        unit = finest.unit(name)
        largest[unit] = max(largest.get(unit, 1e-9), float(np.abs(finest[name]).max()))
    return max(float(np.abs(run[name] - finest[name]).max()) / largest[finest.unit(name)] for name in names)


def grazes(chosen: Member, run: it.Trajectory, step: float) -> bool:
    """Whether an event comes or goes when the road is one part in 10^6 higher or lower: at one and the same step."""
    return any(sequence(simulated(chosen, step, scale)) != sequence(run) for scale in (1.0 - 1e-6, 1.0 + 1e-6))


def checked(seed: int, steps: tuple[float, ...]) -> tuple[str, list[float], list[float]] | None:
    """What became of a member: the largest errors in time and in state for each step but the last, without gaps."""
    chosen = member(seed)
    try:
        runs = [simulated(chosen, step) for step in steps]
    except MechanismError:  # such as a gap between inertias: ill-posed, and refused
        return None
    for step, run in zip(steps, runs, strict=True):
        assert run.integration_status.ok, (seed, chosen.kind, step, run.integration_status)
    *coarse, finest = runs
    if chosen.gaps:
        return "gap", [], []
    if any(sequence(run) != sequence(finest) for run in coarse):
        assert grazes(chosen, finest, steps[-1]), (seed, chosen.kind, [len(run.events) for run in runs])
        return "grazing", [], []
    times = np.array([[event.time for event in run.events] for run in coarse]).reshape(len(coarse), -1)
    in_time = np.abs(times - [event.time for event in finest.events]).max(axis=1, initial=0.0)
    in_state = [apart(chosen, run, finest) for run in coarse]
    if chosen.kind.rsplit("; ")[1] not in FORMULAS:
        assert max(in_time) < ROUNDING, (seed, chosen.kind, in_time)
        assert max(in_state) < ROUNDING, (seed, chosen.kind, in_state)
        return "table", list(in_time), in_state
    return "formula", list(in_time), in_state


def order(errors: list[float], steps: tuple[float, ...], floor: float) -> float | None:
    """The observed order over the steps at which the error is well above rounding; None if they span too little."""
    seen = [(np.log(step), np.log(error)) for error, step in zip(errors, steps, strict=False) if error > floor]
    if len(seen) < 3 or seen[0][0] - seen[-1][0] < np.log(4.0):
        return None
    return float(np.polyfit(*np.transpose(seen), 1)[0])


def family(seeds: range | list[int], steps: tuple[float, ...], needed: int) -> dict[str, int]:
    """Go through members until so many were simulated, and check what they have in common."""
    found: dict[str, int] = {}
    observed: list[float | None] = []
    for seed in seeds:
        result = checked(seed, steps)
        kind = "refused" if result is None else result[0]
        found[kind] = found.get(kind, 0) + 1
        if kind == "grazing":
            print(f"grazing: member {seed}, {member(seed).kind}")
        if kind == "formula":
            assert result is not None
            observed.append(order(result[2], steps, FLOOR))
            for step, error in zip(steps, result[1], strict=False):  # an error within a step depends on where it is
                allowed = 1e-9 + 30.0 * (step / steps[0]) ** 4 * max(result[1][0], 1e-9)
                assert error < allowed, (seed, step, result[1])
        if sum(n for kind, n in found.items() if kind != "refused") == needed:
            break
    assert found.get("grazing", 0) <= 0.05 * needed
    known = [o for o in observed if o is not None]
    print("orders:", *(f"{o:.2f}" for o in known))
    assert all(o > 2.5 for o in known), known
    assert len(known) < 4 or np.median(known) > 3.5, known
    return found


@pytest.mark.parametrize("chunk", sampled(range(4), [0], kept=1))
def test_the_step_decides_nothing(chunk: int) -> None:
    family(range(1000 * chunk, 1000 * chunk + 20), (5e-4, 2e-4, 5e-5, 1.25e-5), 6)


@pytest.mark.parametrize("chunk", sampled(range(20), kept=1))
def test_the_step_decides_nothing_in_many_members(chunk: int) -> None:
    assert sum(family(range(1000 * chunk, 1000 * chunk + 40), STEPS, 10).values()) >= 10


def survives(seed: int, steps: tuple[float, ...]) -> str:
    """What becomes of an extreme member: it is simulated, refused before the run, or too stiff, which is told."""
    chosen = extreme(seed)
    for step in steps:
        try:
            run = it.simulate(chosen.vehicle, duration=DURATION, step=step, every=round(1e-2 / step), **chosen.inputs)
        except (MechanismError, SimulationError):
            return "refused"
        if not run.integration_status.ok:
            said = run.integration_status.message
            assert "10 000 times faster" in said, (seed, chosen.kind, step, said)
            return "stiff"
    return "simulated"


@pytest.mark.parametrize("chunk", sampled(range(4), [0], kept=1))
def test_extremes_are_simulated_or_refused(chunk: int) -> None:
    found = [survives(seed, (5e-4, 1e-4)) for seed in range(1000 * chunk, 1000 * chunk + 10)]
    assert found.count("simulated") >= 5


@pytest.mark.parametrize("chunk", sampled(range(20), kept=1))
def test_many_extremes_are_simulated_or_refused(chunk: int) -> None:
    found = [survives(seed, (5e-4, 2e-4, 5e-5)) for seed in range(1000 * chunk, 1000 * chunk + 10)]
    print(*found)
    assert found.count("simulated") >= 3


def struck(force: it.Signal, friction: float, mass: float = 2.0) -> it.Trajectory:
    """A mass on dry friction, pushed."""
    slide = it.Mechanism(
        coordinates=(it.Coordinate("mass", mass),),
        struts=(it.Strut("ground", it.Friction(friction), {"mass": 1.0}, {}),),
        forces=(it.Force("push", {"mass": 1.0}),),
    )
    return it.simulate(slide, forces={"push": force}, duration=1.0, step=1e-3)


@pytest.mark.parametrize("friction", [1e-9, 1e-3, 1.0, 135.0, 1e9])
def test_a_force_just_at_break_away_holds_and_a_little_more_does_not(friction: float) -> None:
    for seconds in (0.25, 0.3):
        at = struck(it.step(friction, seconds), friction)
        assert at.integration_status.ok
        assert at.events == ()
        assert not np.any(at["mass_velocity"])
        beyond = struck(it.step(friction * 1.001, seconds), friction)
        assert [(e.time, e.after) for e in beyond.events] == [(pytest.approx(seconds, abs=1e-12), "slip up")]
        expected = 0.001 * friction / 2.0 * np.maximum(beyond.time - seconds, 0.0)
        assert beyond["mass_velocity"] == pytest.approx(expected, rel=1e-6, abs=1e-12 * friction)


def test_a_force_that_rises_to_break_away_and_falls_again_holds() -> None:
    ramp = it.Signal.sampled([0.0, 0.4, 0.6, 1.0], [0.0, 50.0, 50.0, 0.0], "linear")
    run = struck(ramp, 50.0)
    assert run.integration_status.ok
    assert run.events == ()
    assert not np.any(run["mass_velocity"])


@pytest.mark.parametrize("step", [5e-4, 1e-4, 2e-5])
def test_what_slips_until_all_lies_still_sticks_then(step: float) -> None:
    """Springs and dampers ahead of the friction are in balance, and the slip ends with the motion of the rig."""
    ways = (it.bump(7e-3, 2.0, 25.0, 0.11), stopping(np.random.default_rng(3), 7e-3))
    for device in (it.Spring(1e6), it.Spring(1e6) | it.Damper(600.0), it.Damper(600.0)):
        for way in ways:
            run = it.simulate(it.Rig(device - it.Friction(4.0, "f")), displacement=way, duration=1.0, step=step)
            assert run.integration_status.ok
            assert run.states["f"] == "stick"
            assert run.events[-1].time < 0.51


@pytest.mark.parametrize("step", sampled([5e-4, 1e-4, 2e-5], [1e-4]))
def test_after_a_long_stick_the_slip_begins_where_it_must(step: float) -> None:
    """Ten seconds of sticking while the car swings on its tyre; then a slow push breaks the friction loose, once."""
    time = np.array([0.0, 10.0, 11.0])
    road = it.sine(1e-3, 3.0)
    car = it.QuarterCar(200.0, 30.0, 150e3, it.Spring(20e3) | it.Damper(800.0) | it.Friction(900.0))
    push = it.Signal.sampled(time, [0.0, 0.0, 4000.0], "linear")
    run = it.simulate(car, road=road, forces={"sprung_force": push}, duration=11.0, step=step)
    assert run.integration_status.ok
    assert [e.after for e in run.events][:1] == ["slip up"]
    first = run.events[0].time
    assert not np.any(run["f_velocity"][run.time < first])
    finest = it.simulate(car, road=road, forces={"sprung_force": push}, duration=11.0, step=1e-5)
    assert sequence(run) == sequence(finest)
    assert first == pytest.approx(finest.events[0].time, abs=1e-8)


def test_a_member_stays_what_it_is() -> None:
    assert all(member(seed).kind == member(seed).kind for seed in (0, 1, 2))
    assert len({member(seed).kind for seed, _ in zip(count(), range(30), strict=False)}) > 20
