"""Random nonlinear mechanisms with signals that drive them."""

from __future__ import annotations

import numpy as np
from wang_su import ROAD, paper_half_car, paper_quarter_car

from inerter import (
    Damper,
    Friction,
    Gap,
    Inerter,
    Rig,
    Road,
    Signal,
    Spring,
    bump,
    cosine,
    held_noise,
    multisine,
    sine,
)
from inerter.networks.elements import Element, Network, Parallel, Series
from inerter.vehicle.vehicle import Vehicle

RANGES = {Spring: (1e4, 1e6), Damper: (200.0, 1e4), Inerter: (5.0, 300.0), Friction: (2.0, 300.0), Gap: (2e-5, 1e-3)}


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def element(rng: np.random.Generator, kind: type[Element]) -> Element:
    return kind(log_uniform(rng, *RANGES[kind]))  # type: ignore[call-arg]


def network(rng: np.random.Generator, leaves: list[Element]) -> Network:
    """The leaves joined at random."""
    if len(leaves) == 1:
        return leaves[0]
    cut = int(rng.integers(1, len(leaves)))
    parts = network(rng, leaves[:cut]), network(rng, leaves[cut:])
    return Parallel(parts) if rng.random() < 0.5 else Series(parts)


def random_network(rng: np.random.Generator, nonlinear: int) -> Network:
    kinds: list[type[Element]] = [Friction if rng.random() < 0.6 else Gap for _ in range(nonlinear)]
    kinds += [(Spring, Damper, Inerter)[int(rng.integers(3))] for _ in range(int(rng.integers(1, 5)))]
    leaves = [element(rng, kinds[int(i)]) for i in rng.permutation(len(kinds))]
    return network(rng, leaves)


def random_case(seed: int) -> tuple[str, Vehicle, dict[str, object]]:
    """A mechanism of one to four nonlinear elements in a quarter car, half car or rig, and arguments of `simulate`."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 5))
    kind = ("quarter", "half", "rig")[seed % 3]
    base = Spring(log_uniform(rng, 2e4, 2e5)) | Damper(log_uniform(rng, 500.0, 5e3))
    if kind == "rig":
        device = (Spring(log_uniform(rng, 1e5, 1e6)) | Damper(log_uniform(rng, 1e3, 1e4))) - random_network(rng, count)
        return kind, Rig(device), {"displacement": motion(rng)}
    if kind == "quarter":
        car: Vehicle = paper_quarter_car(base | random_network(rng, count))
    else:
        front = int(rng.integers(0, count + 1))
        sides = [base | random_network(rng, n) if n else base for n in (front, count - front)]
        car = paper_half_car(*sides)
    return kind, car, {"road": road(rng)}


def road(rng: np.random.Generator) -> Signal:
    choice = int(rng.integers(4))
    seed = int(rng.integers(1 << 30))
    if choice == 0:
        return multisine(ROAD, seed=seed, highest=100.0)
    if choice == 1:
        return sine(amplitude=rng.uniform(1e-3, 2e-2), frequency=rng.uniform(0.5, 12.0), speed=25.0)
    if choice == 2:
        return bump(height=rng.uniform(0.01, 0.05), length=rng.uniform(0.5, 3.0), speed=10.0, start=0.05)
    return held_noise(seed=seed, power=1e-8, interval=2e-3, duration=2.0, speed=25.5)


def motion(rng: np.random.Generator) -> Signal:
    if rng.random() < 0.5:
        return cosine(amplitude=rng.uniform(5e-4, 5e-3), frequency=rng.uniform(0.5, 10.0))
    return multisine(Road(roughness=1e-7, speed=10.0), seed=int(rng.integers(1 << 30)), highest=50.0)
