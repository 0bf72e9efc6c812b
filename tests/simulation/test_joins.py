"""A motion that is cut and gone on with is the motion: samples, events and energy, wherever the cut is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from campaigns import sampled
from members import Member, member
from wang_su import paper_half_car, paper_quarter_car

import inerter as it
from inerter.errors import MechanismError
from inerter.systems.piecewise import piecewise

CLOSE = 1e-9  # of the largest value of its unit
SECONDS = 0.8


@dataclass(frozen=True)
class Cut:
    """A run, the same in two parts, and where they join."""

    whole: it.Trajectory
    begin: it.Trajectory
    rest: it.Trajectory


def cut_anywhere(chosen: Member, rng: np.random.Generator, **request: Any) -> Cut:
    """Cut at a step, at random: where the signal breaks, beside an event, or anywhere."""
    step = float(rng.choice([5e-4, 2e-4]))
    request = {"step": step, **chosen.inputs, **request}
    steps = round(SECONDS / step)
    whole = it.simulate(chosen.vehicle, duration=steps * step, **request)
    (signal,) = chosen.inputs.values()
    places = [rng.uniform(0.0, SECONDS), *signal.breaks(0.0, SECONDS), *(event.time for event in whole.events)]
    at = int(np.clip(np.rint(rng.choice(places) / step), 1, steps - 1))
    begin = it.simulate(chosen.vehicle, duration=at * step, **request)
    return Cut(whole, begin, it.simulate(chosen.vehicle, duration=(steps - at) * step, initial=begin, **request))


def apart(cut: Cut, skipped: int = 0, without: Sequence[str] = ()) -> float:
    """The largest difference of any output, over the largest of its unit (or 1 mN, where nothing but rounding acts)."""
    largest: dict[str, float] = {"N": 1e-3}
    for name in cut.whole.outputs:
        unit = cut.whole.unit(name)
        largest[unit] = max(largest.get(unit, 1e-9), float(np.abs(cut.whole[name]).max()))
    join, worst = cut.begin.time.size - 1, 0.0
    for name in cut.whole.outputs:
        if name in without:
            continue
        both = np.concatenate([cut.begin[name][:-1], cut.rest[name]])
        error = np.abs(both - cut.whole[name])
        error[join : join + skipped] = 0.0
        worst = max(worst, float(error.max()) / largest[cut.whole.unit(name)])
    return worst


def listed(*runs: it.Trajectory) -> list[tuple[str, str, str]]:
    return [(e.element, e.before, e.after) for run in runs for e in run.events]


def balances(cut: Cut) -> float:
    """How far the two accounts are from that of the whole, over all that was put in, stored and dissipated."""
    parts = [run.energy for run in (cut.whole, cut.begin, cut.rest)]
    assert all(part is not None for part in parts)
    sums = np.array([
        [part.input_work, part.stored, sum(part.dampers.values()), sum(part.friction.values()), part.residual]
        for part in parts if part is not None
    ])  # fmt: skip
    return float(np.abs(sums[0] - sums[1] - sums[2]).max() / max(np.abs(sums).max(), 1e-12))


def joined(seed: int) -> float | None:
    """The largest difference between a member and the same in two parts; None if it is refused."""
    rng = np.random.default_rng([seed, 99])
    try:
        cut = cut_anywhere(member(seed), rng, energy=True)
    except MechanismError:
        return None
    assert cut.whole.status.ok
    assert listed(cut.begin, cut.rest) == listed(cut.whole), seed
    assert cut.rest.time[0] == cut.begin.end
    return max(apart(cut), balances(cut))


def assert_close(judge: Callable[[int], float | None], seeds: Iterable[int], least: int, limit: float = CLOSE) -> None:
    """No member is farther off than the limit, and at least so many can be simulated."""
    found = {seed: judge(seed) for seed in seeds}
    known = [value for value in found.values() if value is not None]
    assert max(known) < limit, found
    assert len(known) >= least


@pytest.mark.parametrize("chunk", sampled(range(4), often=[0], kept=0))
def test_two_parts_are_the_whole(chunk: int) -> None:
    assert_close(joined, range(5000 + 100 * chunk, 5000 + 100 * chunk + 10), 6)


@pytest.mark.parametrize("chunk", sampled(range(20), kept=1))
def test_two_parts_are_the_whole_in_many_members(chunk: int) -> None:
    assert_close(joined, range(1000 * chunk, 1000 * chunk + 11), 1)


def stepped(seed: int) -> float | None:
    """The same by time stepping, of which a sample is the mean of both sides, but for the first and the last.

    What frictions and contacts share among them while they hold is not determined, and rounding decides it. Rounding
    of time grows at contacts.
    """
    rng = np.random.default_rng([seed, 98])
    try:
        cut = cut_anywhere(member(seed), rng, integrator="time-stepping")
    except MechanismError:
        return None
    assert cut.whole.status.ok
    system = piecewise(member(seed).vehicle)
    shared = [f"{system.graph.branches[i].label}_force" for group in system.nonlinear for i in group]
    return apart(cut, skipped=1, without=shared)


def test_time_stepping_goes_on_as_well() -> None:
    assert_close(stepped, (0, 2, 3, 5, 6, 8), 1, 1e-7)


@pytest.mark.parametrize("chunk", sampled(range(5), kept=2))
def test_time_stepping_goes_on_in_many_members(chunk: int) -> None:
    assert_close(stepped, range(1000 * chunk, 1000 * chunk + 10), 1, 1e-7)


@pytest.mark.parametrize("integrator", ["event-driven", "time-stepping"])
def test_a_step_of_the_road_where_two_runs_join(integrator: str) -> None:
    """The tyre is compressed at once by the height of the step: 1200 N."""
    car = paper_quarter_car(it.Spring(120e3) | it.Damper(2e3))
    request: dict[str, Any] = {"road": it.step(0.01, 0.1), "step": 1e-3, "integrator": integrator}
    begin = it.simulate(car, duration=0.1, **request)
    assert begin["tyre_load"][-1] == 0.0
    rest = it.simulate(car, duration=0.1, initial=begin, **request)
    assert rest["tyre_load"][0] == pytest.approx(-1200.0, rel=2e-3 if integrator == "time-stepping" else 1e-12)


def test_a_held_road_reaches_the_axles_one_after_the_other() -> None:
    """Cuts at every jump of either axle, some of them between steps."""
    legs = [it.Spring(60e3) | it.Damper(2e3) | it.Friction(f) for f in (80.0, 40.0)]
    car, road = paper_half_car(*legs), it.held_noise(3, 1e-8, interval=7e-3, duration=2.1, speed=30.0)
    whole = it.simulate(car, road=road, duration=0.4, step=1e-3, energy=True)
    for at in (7, 14, 63, 64, 68, 75, 77, 131, 145, 399):
        begin = it.simulate(car, road=road, duration=at * 1e-3, step=1e-3, energy=True)
        rest = it.simulate(car, road=road, duration=(400 - at) * 1e-3, step=1e-3, initial=begin, energy=True)
        cut = Cut(whole, begin, rest)
        assert max(apart(cut), balances(cut)) < CLOSE
        assert listed(begin, rest) == listed(whole)


def test_a_cut_on_an_event() -> None:
    """The first part is stepped so that it ends where the event is, to rounding."""
    car = paper_quarter_car(it.Spring(60e3) | it.Damper(2e3) | it.Friction(120.0, "f"))
    road = it.Signal.sampled(np.linspace(0.0, 2.0, 41), 0.01 * np.sin(np.linspace(0.0, 20.0, 41)))
    whole = it.simulate(car, road=road, duration=1.0, step=1e-3)
    assert len(whole.events) > 8
    for event in whole.events[:8]:
        begin = it.simulate(car, road=road, duration=event.time, step=event.time / 300)
        left = 1.0 - begin.end
        rest = it.simulate(car, road=road, duration=left, step=left / 900, initial=begin)
        assert listed(begin, rest) == listed(whole)
        times = [e.time for run in (begin, rest) for e in run.events]
        assert times == pytest.approx([e.time for e in whole.events], abs=1e-9)
        assert rest.final_state == pytest.approx(whole.final_state, rel=1e-9, abs=1e-11)


def test_a_cut_within_an_open_gap_and_a_loaded_friction() -> None:
    shaft = it.Spring(1e6) | it.Damper(3200.0)
    screw = shaft - it.Gap(1e-4, "gap") - (it.Inerter(300.0) | it.Friction(40.0, "f"))
    car, road = paper_quarter_car(it.Spring(60e3) | it.Damper(5e3) - screw), it.sine(0.01, 2.0)
    whole = it.simulate(car, road=road, duration=1.0, step=5e-4, energy=True)
    for kind, state in (("gap", "open"), ("f", "stick"), ("gap", "upper contact")):
        since, until = max(whole.intervals(kind, state), key=lambda span: span[1] - span[0])
        at = round(0.5 * (since + until) / 5e-4)
        begin = it.simulate(car, road=road, duration=at * 5e-4, step=5e-4, energy=True)
        rest = it.simulate(car, road=road, duration=1.0 - at * 5e-4, step=5e-4, initial=begin, energy=True)
        assert rest.states[kind] == state
        cut = Cut(whole, begin, rest)
        assert max(apart(cut), balances(cut)) < CLOSE


def test_many_runs_go_on_from_where_one_ended() -> None:
    car, road = paper_quarter_car(it.Spring(60e3) | it.Damper(2e3)), it.held_noise(1, 1e-8, interval=1e-2, duration=1.0)
    begin = it.simulate(car, road=road, duration=0.5, step=1e-3)
    rest = it.simulate(car, road=road, duration=0.5, step=1e-3, initial=begin)
    many = it.simulate_many([car], road=[road], outputs=["tyre_load"], duration=0.5, step=1e-3, initial=begin)
    assert many.mean_square[0, 0, 0] == pytest.approx(np.mean(rest["tyre_load"][1:] ** 2), rel=1e-12)


def test_a_period_that_begins_with_a_jump_has_its_energy() -> None:
    car = paper_quarter_car(it.Spring(110e3) | it.Damper(4100.0) | it.Friction(135.0))
    run = it.simulate(car, road=it.sine(0.01, 2.0, phase=1.0).held(0.05), step=1e-3, initial="periodic", energy=True)
    assert run.energy is not None
    assert run.energy.relative_residual < 1e-9
    assert abs(run.energy.stored) < 1e-8 * abs(run.energy.input_work)
