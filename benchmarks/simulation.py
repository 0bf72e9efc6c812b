"""Speed of the event-driven simulation, as ratios measured in one run on one core. Needs the extra "bench".

    python benchmarks/simulation.py

Peers get hand-written, compiled equations and the road from the same signal; all errors are relative L2 errors of the
body's acceleration against the exact solution for a road table of 0.01 ms. Times are from prepared equations and inputs
to the states at every step; ours include building the modes.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
import simulation_peers as peers

import inerter as it
from inerter.simulation import event_driven
from inerter.simulation.inputs import InputTable, tabulate
from inerter.simulation.observe import trajectory_of
from inerter.systems.piecewise import PiecewiseSystem, piecewise

ROAD = it.Road(roughness=5e-7, speed=25)
SIGNAL = it.multisine(ROAD, seed=0)
FRICTION = it.Friction(10, name="friction")
SCREW = (it.Spring(1e6) | it.Damper(3200)) - (it.Inerter(328.72) | FRICTION)
STRUTS = {
    "A": it.Spring(120e3) | it.Damper(3705.4) | it.Inerter(128.57) | FRICTION,
    "B": it.Spring(120e3) | it.Damper(7353) - SCREW,
}
STEPS = (0.5e-3, 0.4e-3, 0.25e-3, 0.2e-3, 0.1e-3)
LONG, SHORT = 10.0, 2.0  # simulated by us, and by the peers [s]
ROUNDS = 3


def quarter_car(strut) -> it.QuarterCar:
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


def half_car(strut) -> it.HalfCar:
    return it.HalfCar(363.5, 200.0, 25.0, 20.0, 120e3, 100e3, 0.775, 1.265, front=strut, rear=strut)


def road_table(step: float, duration: float, stride: int = 1) -> peers.RoadTable:
    value, slope = SIGNAL.grid(0.0, step, round(duration / step) + 1)
    return peers.RoadTable(step, value, slope, stride)


def inputs(system: PiecewiseSystem, step: float, duration: float = LONG) -> InputTable:
    roads = system.mechanism.roads
    signals = [*(SIGNAL for _ in roads), *(None for _ in system.mechanism.forces)]
    delays = [*(road.distance / ROAD.speed for road in roads), *(0.0 for _ in system.mechanism.forces)]
    return tabulate(signals, delays, duration, step)


def run(system: PiecewiseSystem, table: InputTable) -> it.Trajectory:
    system = replace(system)  # as for a new design: modes are kept for a system
    state = np.zeros(system.order)
    integration = event_driven.start(system, table, state)
    integration.advance(table.time.size - 1)
    return trajectory_of(integration, None, "")


def fastest(work: Callable[[], object], repeats: int = 15) -> float:
    work()
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times)


def rate_of(work: Callable[[], object], simulated: float, at_least: float = 0.0) -> float:
    """Median seconds that a simulated second takes, over as many runs as fill `at_least` seconds."""
    times = []
    while not times or sum(times) < at_least:
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return float(np.median(times)) / simulated


def against_peers(name: str) -> None:
    """Each peer in turn with us, so that a machine that slows down slows both; the median of the ratios."""
    problem, system = peers.PROBLEMS[name], piecewise(quarter_car(STRUTS[name]))
    fine, coarse = road_table(1e-5, SHORT, stride=5), road_table(2e-4, SHORT)
    exact, exact_coarse = peers.reference(problem, fine), peers.reference(problem, coarse)
    errors = {}
    for step in STEPS:
        short = run(system, inputs(system, step, SHORT))["sprung_acceleration"]
        errors[step] = peers.relative_error(short, exact.acceleration[:: round(step / 5e-5)])
    for peer, table, rtol, expected, path in (
        ("DOP853", fine, 1e-7, exact, partial(peers.dop853_path, stop_at_kinks=False)),
        ("DOP853 from knot to knot", coarse, 1e-7, exact_coarse, partial(peers.dop853_path, stop_at_kinks=True)),
        *(("CVODE Adams", fine, rtol, exact, peers.cvode_path) for rtol in (1e-6, 1e-7, 1e-8)),
    ):
        path(problem, table.until(0.1), rtol)  # compiles
        error = peers.relative_error(
            peers.body_acceleration(problem, path(problem, table, rtol)), expected.acceleration
        )
        step = next((step for step in STEPS if errors[step] <= error), STEPS[-1])
        mine = inputs(system, step)
        pairs = [
            (
                rate_of(lambda mine=mine: run(system, mine), LONG, 0.3),
                rate_of(lambda path=path, table=table, rtol=rtol: path(problem, table, rtol), SHORT),
            )
            for _ in range(ROUNDS)
        ]
        ours, theirs = np.median(pairs, axis=0) * 1e3
        ratio = np.median([b / a for a, b in pairs])
        print(f"{name}: {peer}, rtol {rtol:g}: {theirs:.1f} ms/s, error {error:.1e}")
        print(f"   ours, step {step * 1e3:g} ms: {ours:.3f} ms/s, error {errors[step]:.1e}: {ratio:.0f} times faster")


def whole_steps() -> None:
    """A step inside one mode against a bare loop of the same size."""
    for name, strut in (("A", STRUTS["A"]), ("B", STRUTS["B"])):
        strut = it.network("rest", rest=strut)
        system = piecewise(quarter_car(strut))
        few, many = inputs(system, 0.5e-3), inputs(system, 0.1e-3)
        spent = fastest(lambda system=system, table=many: run(system, table), 60)
        spent -= fastest(lambda system=system, table=few: run(system, table), 60)
        steps = many.time.size - few.time.size
        bare = peers.bare_loop(system.order, 3, 50_000).seconds_per_step
        print(
            f"{name}: a step {spent / steps * 1e9:.1f} ns, a bare loop {bare * 1e9:.1f} ns: {spent / steps / bare:.2f}"
        )


def half_against_quarter() -> None:
    tables = []
    for car in (quarter_car(STRUTS["A"]), half_car(STRUTS["A"])):
        system = piecewise(car)
        tables.append((system, inputs(system, 2e-4)))
    rounds = [[rate_of(partial(run, *pair), LONG, 0.2) for pair in tables] for _ in range(7)]
    print(f"half car / quarter car, friction in every strut: {np.median([b / a for a, b in rounds]):.2f}")


def batches() -> None:
    """Beside it the same ratio for a bare loop that touches no memory: what two cores of this machine give at most."""
    cars = [quarter_car(it.Spring(120e3) | it.Damper(3000.0 + 20.0 * i) | FRICTION) for i in range(64)]

    def seconds_with(jobs: int) -> float:
        begin = time.perf_counter()
        it.simulate_many(
            cars, road=[SIGNAL], outputs=["sprung_acceleration"], duration=20.0, discard=10.0, jobs=jobs
        )  # fmt: skip
        return time.perf_counter() - begin

    def bare(jobs: int) -> float:
        begin = time.perf_counter()
        with ThreadPoolExecutor(jobs) as pool:
            list(pool.map(peers.burn, [50_000_000] * 8))
        return time.perf_counter() - begin

    seconds_with(2), bare(2)
    rounds = [(seconds_with(1) / seconds_with(2), bare(1) / bare(2)) for _ in range(7)]
    ours, most = np.median(rounds, axis=0)
    print(f"64 runs of 20 s on two cores: {ours:.2f} times faster than on one; a bare loop: {most:.2f} times")


def whole_call() -> None:
    for name, strut in STRUTS.items():
        spent = fastest(lambda strut=strut: it.simulate(quarter_car(strut), road=SIGNAL, duration=LONG)) / LONG
        print(f"{name}: simulate(...), with the road's FFT and the model: {spent * 1e3:.2f} ms/s")


if __name__ == "__main__":
    for name in STRUTS:
        against_peers(name)
    whole_steps()
    half_against_quarter()
    batches()
    whole_call()
