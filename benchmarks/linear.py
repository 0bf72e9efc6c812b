"""Speed of the linear part, as ratios measured in one run. Needs the extra "bench" (python-control).

    python benchmarks/linear.py [--sweep]

One core is used, but for the sweep of Figure 11, which uses two processes.
"""

from __future__ import annotations

import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import control
import numpy as np
from threadpoolctl import threadpool_limits

import inerter as it
from inerter.files.study.running import run_study
from inerter.papers.wang_su_2008.source import study

ROAD = it.Road(roughness=5e-7, speed=25)
K, C = it.Spring(120e3), it.Damper(it.free(100, 100e3, name="c"))
B, SHAFT = it.Inerter(it.free(1, 2000, name="b")), it.Spring(1e6) | it.Damper(3200)
STRUTS = {"S1": K | C, "S2": K | C | B, "S3": K | C - B, "S3 elastic": K | C - SHAFT - B}
INDICES = {"J1": it.RideComfort(ROAD), "J3": it.TyreLoad(ROAD), "J5": it.LoadCarrying()}


def car(strut: it.networks.elements.Network) -> it.QuarterCar:
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


def seconds(work: Callable[[], object], repeats: int = 5) -> float:
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def designs(count: int) -> dict[str, np.ndarray]:
    random = np.random.default_rng(0)
    return {"c": np.exp(random.uniform(np.log(100), np.log(1e5), count)), "b": random.uniform(1, 2000, count)}


def control_systems(points: dict[str, np.ndarray], inputs: str, outputs: str, gain: float) -> list[control.StateSpace]:
    systems = []
    for c, b in zip(points["c"], points["b"], strict=True):
        s = it.state_space(car(STRUTS["S3"]).with_values({"c": c, "b": b}), inputs, outputs)
        systems.append(control.ss(s.A, s.B, gain * s.C, s.D))
    return systems


def norms() -> None:
    few, many = designs(200), designs(100_000)
    scale = ROAD.velocity_intensity
    ours: list[float] = []
    theirs: list[float] = []
    expected = []
    for output in ("sprung_acceleration", "tyre_load"):
        systems = control_systems(few, "road", output, scale)
        theirs.append(seconds(lambda s=systems: [control.norm(x, 2) for x in s]) / 200)
        expected.append([control.norm(x, 2) for x in systems])
    it.evaluate_many(car(STRUTS["S3"]), list(INDICES.values())[:2], few, it.Norm())
    both = list(INDICES.values())[:2]
    ours.append(seconds(lambda: it.evaluate_many(car(STRUTS["S3"]), both, many, it.Norm())) / 200_000)
    values = it.evaluate_many(car(STRUTS["S3"]), both, few, it.Norm())
    difference = np.abs(values / np.array(expected).T - 1.0).max()
    reference = float(np.mean(theirs))
    print(f"J1 and J3, 100 000 designs of S3: {ours[0] * 1e6:.2f} us a norm; python-control {reference * 1e6:.0f} us")
    print(f"  ratio {reference / ours[0]:.0f}; largest relative difference of 400 norms {difference:.1e}")
    for count in (1000, 1_000_000):
        points = designs(count)
        here = seconds(lambda p=points: it.evaluate_many(car(STRUTS["S3"]), both, p, it.Norm())) / (2 * count)
        print(f"  the same, {count} designs: {here * 1e6:.2f} us a norm")
    systems = control_systems(few, "sprung_force", "sprung_displacement", 1e5)
    reference = seconds(lambda: [control.norm(x, "inf", print_warning=False) for x in systems[:50]], 3) / 50
    points = designs(100_000)
    here = seconds(lambda: it.evaluate_many(car(STRUTS["S3"]), INDICES["J5"], points, it.Norm()), 3) / 100_000
    values = it.evaluate_many(car(STRUTS["S3"]), INDICES["J5"], few, it.Norm())[:50, 0] * 1e5
    ratios = np.array([control.norm(x, "inf", print_warning=False) for x in systems[:50]]) / values
    peaks = [it.hinf_norm(it.LinearSystem(x.A, x.B, x.C, x.D)).peaks[0].omega for x in systems[:50]]
    confirmed = [abs(x(1j * omega)) for x, omega in zip(systems, peaks, strict=False)] / values
    print(f"J5, 100 000 designs of S3: {here * 1e6:.2f} us a norm; python-control {reference * 1e6:.0f} us")
    print(
        f"  ratio {reference / here:.0f}; of 50 norms python-control's (to 1e-6) is never more than "
        f"{ratios.max() - 1.0:.0e} above, but {np.sum(ratios < 1.0 - 1e-5)} times more than 1e-5 below "
        f"(lowest {ratios.min():.2f});"
    )
    print(f"  its own frequency response at our peaks confirms ours to {np.abs(confirmed - 1.0).max():.0e}")


def optimisations() -> None:
    for layout, strut in STRUTS.items():
        times = []
        for index in INDICES.values():
            it.optimise(car(strut), index, it.Norm())
            times.append(seconds(lambda i=index, s=strut: it.optimise(car(s), i, it.Norm())))
        shown = ", ".join(f"{name} {1e3 * t:.0f} ms" for name, t in zip(INDICES, times, strict=True))
        print(f"one optimisation from scratch, {layout}: {shown}")


def evaluations() -> None:
    points = designs(200)
    values = [dict(zip(points, row, strict=True)) for row in zip(*points.values(), strict=True)]
    cars = [car(STRUTS["S3"]).with_values(each) for each in values]
    times = []
    for index in INDICES.values():
        it.evaluate(cars[0], index, it.Norm())
        times.append(seconds(lambda i=index: [it.evaluate(each, i, it.Norm()) for each in cars]) / len(cars))
    shown = ", ".join(f"{name} {1e3 * t:.2f} ms" for name, t in zip(INDICES, times, strict=True))
    print(f"one evaluation of a design of S3: {shown}")


def sweep() -> None:
    source = study("figure11")
    count = len(source.layouts) * len(source.indices) * sum(len(sweep.values) for sweep in source.sweeps)
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        run_study(source, Path(folder) / "figure11", jobs=2)
        print(f"sweep of Figure 11, {count} optimisations on 2 processes: {time.perf_counter() - start:.1f} s")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    with threadpool_limits(1):
        norms()
        evaluations()
        optimisations()
    if "--sweep" in sys.argv:
        sweep()
