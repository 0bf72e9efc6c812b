"""Speed of optima within limits, fronts and tolerances, in seconds of the processor after one call to warm up.

    python benchmarks/trade_off.py

One core is used.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from threadpoolctl import threadpool_limits

import inerter as it

ROAD = it.Road(roughness=5e-7, speed=25)
J1, J3, J5 = it.RideComfort(ROAD), it.TyreLoad(ROAD), it.LoadCarrying()
K, C, B = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))
CAR = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=K | C - B)
NORM = it.Norm()
USE = it.Conditions([it.Condition(0.3, road={"speed": 15.0}), it.Condition(0.7, vehicle={"sprung_mass": 240.0})])
SPREAD = {"c": 0.1, "b": 0.05, "k": 0.05}


def seconds(work: Callable[[], object], repeats: int = 5) -> float:
    """The least processor time of some calls after one."""
    work()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def main() -> None:
    fixed = it.optimise(CAR, J1, NORM).design
    rows: list[tuple[str, Callable[[], object], float | None]] = [
        ("optimum of J1", lambda: it.optimise(CAR, J1, NORM), None),
        ("the same, J5 at most 27 um/N", lambda: it.optimise(CAR, J1, NORM, subject_to=[it.at_most(J5, 27e-6)]), 0.15),
        ("the same, J3 510 N", lambda: it.optimise(CAR, J1, NORM, subject_to=[it.equal(J3, 510.0)]), 0.15),
        (
            "optimum of J5, J1 at most 2.6 m/s^2",
            lambda: it.optimise(CAR, J5, NORM, subject_to=[it.at_most(J1, 2.6)]),
            0.15,
        ),
        ("mean of J1 over two conditions", lambda: it.optimise(CAR, USE.mean(J1), NORM), None),
        ("front of J1 and J3, 25 points", lambda: it.pareto_front(CAR, [J1, J3], NORM, points=25), 2.0),
        ("front of J1 and J5, 25 points", lambda: it.pareto_front(CAR, [J1, J5], NORM, points=25), 2.0),
        ("front of J1, J3 and J5, 25 points", lambda: it.pareto_front(CAR, [J1, J3, J5], NORM, points=25), None),
        ("tolerance of J1, 4096 samples", lambda: it.tolerance_analysis(fixed, J1, NORM, spread=SPREAD), None),
        ("robust J1, 256 samples", lambda: it.optimise_robust(CAR, J1, NORM, spread={"c": 0.3, "b": 0.3}), None),
    ]
    with threadpool_limits(1):
        for title, work, allowed in rows:
            found = seconds(work, 2 if allowed is None else 5)
            asked = "" if allowed is None else f"  (at most {allowed:g} s: {'yes' if found <= allowed else 'NO'})"
            print(f"{title:40s} {found:7.3f} s{asked}")


if __name__ == "__main__":
    main()
