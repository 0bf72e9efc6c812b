"""Norms of vehicles with several axles, filters and two tracks: by modes, and with states for filters, in one run.

    python benchmarks/modes.py [--campaign] [--optima]

One core. `--campaign` compares random cars, over up to seven decades of each value and with light damping, with the
norms in exact arithmetic; `--optima` times whole optimisations, which takes minutes with states for filters.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import scipy.linalg
from threadpoolctl import threadpool_limits

import inerter as it
from inerter.kernels import excess, h2, modal
from inerter.methods.compiled_norm import CompiledNorm

ROAD = it.Road(1e-5, 25.0)
TWO_TRACKS = it.Road(1e-5, 25.0, it.Coherence.isotropic(1.5))
Ranges = dict[str, tuple[float, float]]
USUAL: Ranges = {"k": (1e4, 1e6), "c": (100.0, 1e5), "b": (1.0, 1e3), "k1": (1e3, 1e6)}
WIDE: Ranges = {"k": (1e3, 1e6), "c": (1.0, 1e6), "b": (0.01, 1e5), "k1": (1e2, 1e8)}


def strut(end: str, count: int, ranges: Ranges = USUAL) -> it.networks.elements.Network:
    def free(name: str) -> it.Free:
        return it.free(*ranges[name], name + end)

    if count == 1:
        return it.Spring(3e4) | it.Damper(free("c"))
    if count == 2:
        return it.Spring(3e4) | it.Damper(free("c")) - it.Inerter(free("b"))
    return it.Spring(free("k")) | it.Damper(free("c")) - (it.Inerter(free("b")) | it.Spring(free("k1")))


def half_car(count: int, ranges: Ranges = USUAL) -> it.HalfCar:
    front, rear = strut("f", count, ranges), strut("r", count, ranges)
    return it.HalfCar(700.0, 900.0, 40.0, 40.0, 1.5e5, 1.5e5, 1.2, 1.4, front, rear)


def full_car(count: int, ranges: Ranges = USUAL) -> it.FullCar:
    bars = {"anti_roll_front": it.Spring(8e3), "anti_roll_rear": it.Spring(8e3)}
    front, rear = strut("f", count, ranges), strut("r", count, ranges)
    return it.FullCar(1400, 2400, 520, 45, 40, 220e3, 220e3, 1.2, 1.5, 1.52, 1.5, front=front, rear=rear, **bars)


CASES = {
    "half, 4 values, J3": (half_car(2), it.TyreLoad(ROAD)),
    "half, 8 values, J3": (half_car(4), it.TyreLoad(ROAD)),
    "half, 4 values, Wk": (half_car(2), it.RideComfort(ROAD, weighting="Wk")),
    "half, 8 values, Wk": (half_car(4), it.RideComfort(ROAD, weighting="Wk")),
    "full, 4 values, J1, isotropic": (full_car(2), it.RideComfort(TWO_TRACKS)),
    "full, 8 values, J3, isotropic": (full_car(4), it.TyreLoad(TWO_TRACKS)),
    "full, 8 values, Wk, isotropic": (full_car(4), it.RideComfort(TWO_TRACKS, weighting="Wk")),
}


def draw(car: it.Vehicle, count: int, seed: int) -> np.ndarray:
    bounds = np.log([(value.lower, value.upper) for value in car.free_values().values()])
    return np.exp(np.random.default_rng(seed).uniform(bounds[:, 0], bounds[:, 1], (count, len(bounds))))


def with_states(one: CompiledNorm, points: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Norms and error estimates with states for filters, and an integral for isotropic tracks."""
    norms, _, errors = h2.norms(points, *one.arguments, weights)
    if one._excess is not None:
        own = (one.descriptor, one.arrivals, one._excess.table)
        norms = np.sqrt(norms**2 + excess.corrections(points, *own, weights)[0])
    return norms, errors


def by_modes(one: CompiledNorm, points: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    norms, _, errors = one._by_modes(points, weights)
    return norms, errors


def microseconds(work: Callable[[], object], count: int) -> float:
    times = []
    for _ in range(5):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return float(np.median(times)) / count * 1e6


def values() -> None:
    print(
        "case; states with those of filters, by modes; us a value and with gradient, with states, by modes; difference"
    )
    for name, (car, index) in CASES.items():
        objective, points = it.Norm().objective(car, index), draw(car, 100, 1)
        states, times, difference = np.zeros((2, 0), int), np.zeros((2, 2)), 0.0
        for seen, one in objective.per_source_definitions:
            own, found = np.ascontiguousarray(points[:, objective._columns(one)]), []
            arguments = one._modal_arguments
            assert arguments is not None
            orders = one.descriptor[1].shape[2], arguments[0][1].shape[2]
            states = np.column_stack([states, orders])
            for row, way in enumerate((with_states, by_modes)):
                found.append(way(one, own, np.empty(0)))
                for column, weights in enumerate((np.empty(0), np.ones(int(seen.sum())))):
                    way(one, own[:1], weights)
                    times[row, column] += microseconds(lambda o=own, w=way, e=one, g=weights: w(e, o, g), len(own))
            known = np.isfinite(found[0][1]) & np.isfinite(found[1][1])
            difference = max(difference, float(np.abs(found[1][0][known] / found[0][0][known] - 1.0).max()))
        orders_text = " / ".join("+".join(map(str, row)) for row in states.tolist())
        print(
            f"{name}: {orders_text}; {times[0, 0]:.0f} / {times[0, 1]:.0f}, {times[1, 0]:.0f} / {times[1, 1]:.0f}; "
            f"ratio {times[0, 0] / times[1, 0]:.1f} / {times[0, 1] / times[1, 1]:.1f}; {difference:.0e}"
        )


def lyapunov() -> None:
    """Covariances of random systems of 30 states: here with the check, by SciPy without one."""
    n, rng = 30, np.random.default_rng(0)
    systems = []
    for _ in range(20):
        A = rng.normal(size=(n, n))
        systems.append((A - (1.0 + np.linalg.eigvals(A).real.max()) * np.eye(n), rng.normal(size=(n, 1))))
    ours = []
    C, none = rng.normal(size=(1, n)), np.zeros((1, 1, n))
    noise = (
        np.zeros(1),
        np.zeros(1, int),
        np.zeros(2, int),
        np.zeros(0, complex),
        np.zeros(0, complex),
        np.zeros(0),
        np.ones(1),
    )
    for A, B in systems:
        unit, D = np.eye(n)[None], np.zeros((1, 1, 1))
        stacks = (unit, np.concatenate([A, B], axis=1)[None], none, np.concatenate([C[None], D], axis=2))
        row = np.concatenate([stack.reshape(1, -1) for stack in stacks], axis=1)
        descriptor = (unit, A[None], B[None], unit[0].copy(), 0.0 * A, 0.0 * B, none, C[None], D)
        ours.append((descriptor, (row, np.zeros((0, 0))), noise, np.empty(0)))
    points = np.zeros((1, 0))
    found = [modal.norms_by_modes(points, *given)[0][0, 0] for given in ours]
    scipys = [np.sqrt((C @ scipy.linalg.solve_continuous_lyapunov(A, -B @ B.T) @ C.T).item()) for A, B in systems]
    here, there = np.inf, np.inf
    for _ in range(9):  # in turn: other processes may share the machine
        here = min(here, microseconds(lambda: [modal.norms_by_modes(points, *given) for given in ours], 20))
        there = min(
            there,
            microseconds(lambda: [scipy.linalg.solve_continuous_lyapunov(A, -B @ B.T) for A, B in systems], 20),
        )
    difference = np.abs(np.array(found) / np.array(scipys) - 1.0).max()
    print(
        f"one norm at 30 states: {here:.0f} us, checked; SciPy's Lyapunov equation {there:.0f} us, "
        f"ratio {here / there:.2f}; "
        f"difference {difference:.0e}"
    )


def campaign() -> None:
    """Random cars over wide ranges against the norms with states, and a sample against exact arithmetic."""
    several = it.Road(1e-5, 25.0, it.Coherence.first_order(0.2))
    cases = {
        "half, wide, J3": (half_car(4, WIDE), it.TyreLoad(ROAD)),
        "half, wide, Wk": (half_car(4, WIDE), it.RideComfort(ROAD, weighting="Wk")),
        "half, usual, Wk": (half_car(4), it.RideComfort(ROAD, weighting="Wk")),
        "full, wide, J3, coherence": (full_car(4, WIDE), it.TyreLoad(several)),
    }
    for name, (car, index) in cases.items():
        objective, drawn = it.Norm().objective(car, index), draw(car, 500, 7)
        for _, one in objective.per_source_definitions:
            points = np.ascontiguousarray(drawn[:, objective._columns(one)])
            norms, errors = by_modes(one, points, np.empty(0))
            other, unsure = with_states(one, points, np.empty(0))
            known, before = np.isfinite(errors), np.isfinite(unsure)
            both = np.flatnonzero(known & before)
            worst = np.abs(norms[both] / other[both] - 1.0).max()
            only = np.flatnonzero(known & ~before)
            sample = [*only[:20], *both[np.argsort(-errors[both])[:20]], *np.flatnonzero(known)[:20]]
            exact = [float(np.abs(norms[i] / one._exact_norms(points[i]) - 1.0).max()) for i in sample]
            print(
                f"{name}: {known.mean():.1%} of 500 by modes, {before.mean():.1%} with states, "
                f"{np.mean(known | before):.1%} by either; largest difference {worst:.0e}; "
                f"of {len(sample)} against exact arithmetic {max(exact):.0e}"
            )


@contextmanager
def states_only() -> Iterator[None]:
    """Searches with states for filters alone."""
    before = CompiledNorm._by_modes
    CompiledNorm._by_modes = lambda self, points, weights: (  # type: ignore[method-assign]
        np.full((len(points), self.problem.weights.size), np.nan),
        np.full((len(points) if weights.size else 0, points.shape[1]), np.nan),
        np.full(len(points), np.inf),
    )
    try:
        yield
    finally:
        CompiledNorm._by_modes = before  # type: ignore[method-assign]


def optima() -> None:
    for name in ("half, 4 values, Wk", "half, 8 values, J3", "full, 4 values, J1, isotropic", "half, 8 values, Wk"):
        car, index = CASES[name]
        start = time.process_time()
        found = it.optimise(car, index, it.Norm(), seed=0)
        taken = time.process_time() - start
        with states_only():
            start = time.process_time()
            before = it.optimise(car, index, it.Norm(), seed=0)
            longer = time.process_time() - start
        print(
            f"optimum, {name}: {longer:.2f} s, {taken:.2f} s; values differ by {found.value / before.value - 1.0:.0e}"
        )


def optimum_within_limits() -> None:
    """An optimum over two speeds under two limits: those of the design in the middle of all bounds."""
    car = half_car(4)
    comfort, load = it.RideComfort(ROAD), it.TyreLoad(ROAD)
    use = it.Conditions([it.Condition(share=0.5, road={"speed": speed}) for speed in (15.0, 25.0)])
    middle = car.with_values({name: np.sqrt(v.lower * v.upper) for name, v in car.free_values().items()})
    limits = [it.at_most(index, it.evaluate(middle, index, it.Norm()).value) for index in (comfort, load)]
    start = time.process_time()
    found = it.optimise(car, use.mean(it.RideComfort(ROAD, weighting="Wk")), it.Norm(), subject_to=limits, seed=0)
    taken = time.process_time() - start
    print(
        f"optimum, half, 8 values, Wk at two speeds with two limits: {taken:.2f} s, {found.evaluations} points, "
        f"{found.n_converged} of {found.n_starts} starts, {found.value!r}, {found.status}"
    )


if __name__ == "__main__":
    with threadpool_limits(1):
        values()
        lyapunov()
        if "--campaign" in sys.argv:
            campaign()
        if "--optima" in sys.argv:
            optima()
            optimum_within_limits()
