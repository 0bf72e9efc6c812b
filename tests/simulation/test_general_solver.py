"""Sticking and slipping against a general solver of differential equations with event detection, written from scratch.

A quarter car with spring, damper, inerter and friction side by side. The solver knows no modes but two, slip and
stick, and follows the road as a function of time, not as a table.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
import scipy.integrate
from campaigns import sampled
from mechanisms import log_uniform

import inerter as it

DURATION, STEP = 1.0, 2e-5


class Strut:
    """Masses m, M; k, c, b and f between them; a tyre K; a road z(t). State: body and wheel, heights and velocities."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.M, self.m = log_uniform(rng, 100.0, 500.0), log_uniform(rng, 15.0, 60.0)
        self.k, self.K = log_uniform(rng, 2e4, 2e5), log_uniform(rng, 8e4, 3e5)
        self.c, self.f = log_uniform(rng, 300.0, 5e3), log_uniform(rng, 5.0, 500.0)
        self.b = log_uniform(rng, 5.0, 300.0) if rng.random() < 0.5 else 0.0
        a, frequency = log_uniform(rng, 2e-3, 2e-2), log_uniform(rng, 0.7, 10.0)
        self.road = (
            it.sine(a, frequency, rng.uniform(0.0, 6.0)),
            it.chirp(a, 1.0, frequency + 1.0, 2.0),
            it.flat_multisine(int(rng.integers(1000)), a, 0.5, 12.0),
        )[int(rng.integers(3))]

    @property
    def car(self) -> it.QuarterCar:
        strut = it.Spring(self.k) | it.Damper(self.c) | it.Friction(self.f, "f")
        return it.QuarterCar(self.M, self.m, self.K, strut | it.Inerter(self.b) if self.b else strut)

    def forces(self, t: float, y: np.ndarray) -> tuple[float, float]:
        """On the body and on the wheel, without friction and inerter."""
        strut = self.k * (y[0] - y[1]) + self.c * (y[2] - y[3])
        return -strut, strut - self.K * (y[1] - float(self.road(t)))

    def holding(self, t: float, y: np.ndarray) -> float:
        """The friction with which body and wheel go together."""
        on_body, on_wheel = self.forces(t, y)
        together = (on_body + on_wheel) / (self.M + self.m)
        return on_body - self.M * together

    def slipping(self, t: float, y: np.ndarray, side: float) -> list[float]:
        on_body, on_wheel = self.forces(t, y)
        matrix = np.array([[self.M + self.b, -self.b], [-self.b, self.m + self.b]])
        return [y[2], y[3], *np.linalg.solve(matrix, [on_body - side * self.f, on_wheel + side * self.f])]

    def sticking(self, t: float, y: np.ndarray) -> list[float]:
        together = sum(self.forces(t, y)) / (self.M + self.m)
        return [y[2], y[3], together, together]


def solved(strut: Strut) -> tuple[list[tuple[float, str]], np.ndarray]:
    """Events, and the state at the end."""
    names = {1.0: "slip up", 0.0: "stick", -1.0: "slip down"}
    z0 = float(strut.road(0.0))
    t, y, side, found = 0.0, np.array([z0, z0, 0.0, 0.0]), 0.0, []
    while t < DURATION:
        if side == 0.0:
            events = [lambda t, y, limit=limit: strut.holding(t, y) - limit for limit in (strut.f, -strut.f)]
            run = strut.sticking
        else:
            events = [lambda t, y: y[2] - y[3]]
            run = partial(strut.slipping, side=side)
        for number, event in enumerate(events):
            event.terminal = True  # type: ignore[attr-defined]
            event.direction = -side if side else 1.0 - 2.0 * number  # type: ignore[attr-defined]
        out = scipy.integrate.solve_ivp(
            run, (t, DURATION), y, "DOP853", events=events, rtol=1e-11, atol=1e-13, max_step=2e-3
        )
        t, y = float(out.t[-1]), out.y[:, -1]
        if out.status != 1:
            break
        before = side
        if side == 0.0:
            side = 1.0 if out.t_events[0].size else -1.0
        else:
            y[2:] = (strut.M * y[2] + strut.m * y[3]) / (strut.M + strut.m)
            needed = strut.holding(t, y)
            side = 0.0 if abs(needed) <= strut.f else float(np.sign(needed))
        assert side != before
        found.append((t, names[side]))
    return found, y


def compared(seed: int) -> int:
    """The number of events, which are the same in both; times and states are."""
    strut = Strut(np.random.default_rng([seed, 7]))
    run = it.simulate(strut.car, road=strut.road, duration=DURATION, step=STEP, every=100)
    expected, y = solved(strut)
    assert [e.after for e in run.events] == [after for _, after in expected], seed
    assert [e.time for e in run.events] == pytest.approx([time for time, _ in expected], abs=3e-8), seed
    ends = [run[f"{mass}_{what}"][-1] for what in ("displacement", "velocity") for mass in ("sprung", "unsprung")]
    assert ends[:2] == pytest.approx(y[:2].tolist(), abs=1e-8 * np.abs(run["sprung_displacement"]).max()), seed
    assert ends[2:] == pytest.approx(y[2:].tolist(), abs=1e-8 * np.abs(run["unsprung_velocity"]).max()), seed
    return len(expected)


@pytest.mark.campaign
def test_a_general_solver_finds_the_same() -> None:
    assert sum(compared(seed) for seed in range(4)) > 10


@pytest.mark.parametrize("chunk", sampled(range(20), kept=1))
def test_a_general_solver_finds_the_same_in_a_hundred_cars(chunk: int) -> None:
    assert sum(compared(seed) for seed in range(100 * chunk, 100 * chunk + 5)) > 5
