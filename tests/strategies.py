"""Random networks and vehicles: as hypothesis strategies for laws, and from a seed for long lists."""

from __future__ import annotations

from functools import reduce
from operator import or_, sub

import numpy as np
from hypothesis import strategies as st

from inerter import Damper, HalfCar, Inerter, LinearSystem, QuarterCar, Spring
from inerter.networks.elements import Network

RANGES = {Spring: (1e3, 1e6), Damper: (1e1, 1e5), Inerter: (1e-1, 1e4)}


def logarithmic(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log10(low), np.log10(high)).map(lambda x: float(10.0**x))


def elements() -> st.SearchStrategy[Network]:
    return st.one_of(*(logarithmic(*bounds).map(kind) for kind, bounds in RANGES.items()))


def networks(depth: int = 4, most: int = 10) -> st.SearchStrategy[Network]:
    """Series-parallel networks of up to `most` elements, joined up to `depth` deep."""
    joined = elements()
    for _ in range(depth):
        joined = st.one_of(
            elements(),
            st.builds(
                reduce,
                st.sampled_from([or_, sub]),
                st.lists(joined, min_size=2, max_size=3),
            ),
        )
    return joined.filter(lambda network: len(list(network.elements())) <= most)


def random_network(rng: np.random.Generator, depth: int = 4, most: int = 10) -> Network:
    """The same from a generator; chains of one kind (k - k, b - b) and twins (c | c) are frequent."""
    if depth == 0 or most == 1 or rng.random() < 0.15:
        return random_element(rng)
    parts, count = [], min(int(rng.integers(2, 4)), most)
    for i in range(count):
        rest = most - sum(len(list(p.elements())) for p in parts) - (count - 1 - i)
        parts.append(random_network(rng, depth - 1, rest))
    if rng.random() < 0.2:
        parts[-1] = parts[0] if len(list(parts[0].elements())) == 1 else parts[-1]
    return reduce(or_ if rng.random() < 0.5 else sub, parts)


def random_element(rng: np.random.Generator) -> Network:
    kind = list(RANGES)[int(rng.integers(3))]
    return kind(_between(rng, *RANGES[kind]))


def random_quarter_car(rng: np.random.Generator, strut: Network) -> QuarterCar:
    return QuarterCar(_between(rng, 100, 1000), _between(rng, 10, 90), _between(rng, 5e4, 5e5), strut)


def random_half_car(rng: np.random.Generator, front: Network, rear: Network) -> HalfCar:
    return HalfCar(
        sprung_mass=_between(rng, 200, 1500),
        pitch_inertia=_between(rng, 100, 3000),
        unsprung_mass_front=_between(rng, 10, 90),
        unsprung_mass_rear=_between(rng, 10, 90),
        tyre_stiffness_front=_between(rng, 5e4, 5e5),
        tyre_stiffness_rear=_between(rng, 5e4, 5e5),
        distance_front=_between(rng, 0.6, 2.0),
        distance_rear=_between(rng, 0.6, 2.0),
        front=front,
        rear=rear,
    )


def random_stable(rng: np.random.Generator, order: int, inputs: int, outputs: int, damping: float) -> LinearSystem:
    """Poles over three decades with damping ratios down to `damping`, hidden by an orthogonal change of states."""
    blocks, left = [], order
    while left > 0:
        omega, zeta = _between(rng, 0.1, 100.0), _between(rng, damping, 1.0)
        if left == 1:
            blocks.append(np.array([[-omega]]))
        else:
            s, c = -zeta * omega, omega * np.sqrt(max(1.0 - zeta**2, 0.0))
            blocks.append(np.array([[s, c], [-c, s]]))
        left -= blocks[-1].shape[0]
    A = np.zeros((order, order))
    at = 0
    for block in blocks:
        A[at : at + len(block), at : at + len(block)] = block
        at += len(block)
    Q = np.linalg.qr(rng.standard_normal((order, order)))[0]
    B, C = rng.standard_normal((order, inputs)), rng.standard_normal((outputs, order))
    return LinearSystem(Q @ A @ Q.T, Q @ B, C @ Q.T, np.zeros((outputs, inputs)))


def _between(rng: np.random.Generator, low: float, high: float) -> float:
    """Logarithmically between two bounds."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
