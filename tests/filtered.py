"""Filters for the tests: that of ISO 2631 for vertical vibration, random ones, and any index with filters on it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from inerter import Filter
from inerter.indices.definition import Index, IndexDefinition
from inerter.vehicle.mechanism import Mechanism


def iso_2631_wk() -> Filter:
    """The weighting Wk of ISO 2631-1, Table 3: band limits, the transition, the upward step."""
    f1, f2, f3, f4, f5, f6 = (2.0 * math.pi * f for f in (0.4, 100.0, 12.5, 12.5, 2.37, 3.35))
    q4, q5, q6, q = 0.63, 0.91, 0.91, math.sqrt(0.5)
    tops = [[1.0, 0.0, 0.0], [f2**2], [1.0 / f3, 1.0], [1.0 / f5**2, 1.0 / (q5 * f5), 1.0], [(f5 / f6) ** 2]]
    bottoms = [
        [1.0, f1 / q, f1**2],
        [1.0, f2 / q, f2**2],
        [1.0 / f4**2, 1.0 / (q4 * f4), 1.0],
        [1.0 / f6**2, 1.0 / (q6 * f6), 1.0],
    ]
    return Filter(reduce(np.polymul, tops), reduce(np.polymul, bottoms))


def random_filter(rng: np.random.Generator) -> Filter:
    """Of order 0 to 8, with poles between 0.05 and 500 rad/s, damped or hardly, and zeros anywhere."""
    bottom, order = np.ones(1), int(rng.integers(0, 9))
    while bottom.size - 1 < order:
        rate = float(np.exp(rng.uniform(np.log(0.05), np.log(500.0))))
        if order - (bottom.size - 1) >= 2 and rng.random() < 0.7:
            bottom = np.polymul(bottom, [1.0, 2.0 * rng.uniform(0.02, 1.2) * rate, rate**2])
        else:
            bottom = np.polymul(bottom, [1.0, rate])
    top, zeros = np.array([float(rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 3.0))]), int(rng.integers(0, order + 1))
    for _ in range(zeros):
        zero = 0.0 if rng.random() < 0.4 else rng.uniform(-200.0, 200.0)
        top = np.polymul(top, [1.0, zero])
    return Filter(top * bottom[-1] ** (rng.random() < 0.5), bottom)


@dataclass(frozen=True)
class Weighed:
    """An index whose outputs pass through filters: one for all, or one (or None) for each."""

    index: Index
    filter: object
    symbol = "JW"
    title = "weighted"

    @property
    def unit(self) -> str:
        return self.index.unit

    @property
    def response(self) -> str:
        return self.index.response

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        return replace(self.index.definition(mechanism), filter=self.filter)


def some_filters(rng: np.random.Generator, definition: IndexDefinition) -> object:
    """One for all outputs, or for each its own or none."""
    found = tuple(None if rng.random() < 0.3 else random_filter(rng) for _ in definition.outputs)
    return found if any(found) and rng.random() < 0.6 else random_filter(rng)
