"""Speed of the event-driven simulation, as ratios measured in one run on one core. Needs the extra "bench".

    python benchmarks/simulation.py

Peers get hand-written, compiled equations and the road from the same signal; all errors are relative L2 errors of the
body's acceleration against the exact solution for a road table of 0.01 ms. Times are from prepared equations and inputs
to the states at every step; ours include building the modes.
"""

from __future__ import annotations

import time
from collections.abc import Callable

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
    state = np.zeros(system.order)
    integration = event_driven.start(system, table, state)
    integration.advance(table.time.size - 1)
    return trajectory_of(integration, None, "", state)


def fastest(work: Callable[[], object], repeats: int = 15) -> float:
    work()
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times)


def against_peers(name: str) -> None:
    problem, system = peers.PROBLEMS[name], piecewise(quarter_car(STRUTS[name]))
    fine = road_table(1e-5, SHORT, stride=5)
    exact = peers.reference(problem, fine)
    rows = []
    for step in STEPS:
        short = run(system, inputs(system, step, SHORT))["sprung_acceleration"]
        error = peers.relative_error(short, exact.acceleration[:: round(step / 5e-5)])
        table = inputs(system, step)
        spent = fastest(lambda table=table: run(system, table)) / LONG
        rows.append((step, spent, error))
        print(f"{name}: ours, {step * 1e3:g} ms: {spent * 1e3:.4f} ms/s, error {error:.1e}")
    found = (
        peers.solve_ivp_run(problem, fine, 1e-7, exact, stop_at_kinks=False),
        peers.solve_ivp_run(problem, road_table(2e-4, SHORT), 1e-7, None),
        *(peers.cvode_run(problem, fine, rtol, exact) for rtol in (1e-6, 1e-7, 1e-8)),
    )
    for peer in found:
        error = peer.error if np.isfinite(peer.error) else 0.0
        step, spent, ours = next(row for row in rows if row[2] <= max(error, rows[-1][2]))
        times = peer.seconds_per_second / spent
        print(
            f"{name}: {peer.peer}, rtol {peer.tolerance:g}: {peer.seconds_per_second * 1e3:.1f} ms/s, error {error:.1e}"
        )
        print(f"   we are {times:.0f} times faster, with a step of {step * 1e3:g} ms and an error of {ours:.1e}")


def whole_steps() -> None:
    """A step inside one mode against a bare loop of the same size."""
    for name, strut in (("A", STRUTS["A"]), ("B", STRUTS["B"])):
        strut = it.network("rest", rest=strut)
        system = piecewise(quarter_car(strut))
        few, many = inputs(system, 0.5e-3), inputs(system, 0.1e-3)
        spent = fastest(lambda system=system, table=many: run(system, table))
        spent -= fastest(lambda system=system, table=few: run(system, table))
        steps = many.time.size - few.time.size
        bare = peers.bare_loop(system.order, 3, 50_000).seconds_per_step
        print(
            f"{name}: a step {spent / steps * 1e9:.1f} ns, a bare loop {bare * 1e9:.1f} ns: {spent / steps / bare:.2f}"
        )


def half_against_quarter() -> None:
    spent = []
    for car in (quarter_car(STRUTS["A"]), half_car(STRUTS["A"])):
        system = piecewise(car)
        table = inputs(system, 2e-4)
        spent.append(fastest(lambda system=system, table=table: run(system, table)))
    print(f"half car / quarter car, friction in every strut: {spent[1] / spent[0]:.2f}")


def batches() -> None:
    cars = [quarter_car(it.Spring(120e3) | it.Damper(3000.0 + 20.0 * i) | FRICTION) for i in range(64)]
    spent = {
        jobs: fastest(
            lambda jobs=jobs: it.simulate_many(
                cars, road=[SIGNAL], outputs=["sprung_acceleration"], duration=20.0, settled=10.0, jobs=jobs
            ),
            5,
        )
        for jobs in (1, 2)
    }
    print(f"64 runs of 20 s: {spent[1]:.2f} s on one core, {spent[1] / spent[2]:.2f} times faster on two")


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
