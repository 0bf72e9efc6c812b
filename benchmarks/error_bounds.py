"""Whether what estimates say of their errors holds: random members over vehicles, indices and methods.

    python benchmarks/error_bounds.py [--part PART] [--count COUNT] [--first FIRST]

Norms are compared with rational arithmetic, linearisations with simulations on many roads, simulations with the norm
where friction is next to nothing and with the same roads in steps four times as short, and intervals with the mean of
the intervals of other seeds. `tests/bounded.py` draws the members. Needs the extra "test" (python-flint).
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from bounded import (
    Judged,
    Member,
    against_exact,
    intervals,
    linear_member,
    member_under_a_sine,
    member_with_friction,
    of_finer_steps,
    of_hardly_any_friction,
    of_linearisation,
)

import inerter as it

ROADS, GAINS = it.ExpectedValue(realisations=2, jobs=1), it.ApproximateLinear(realisations=2)
PARTS: dict[str, tuple[str, int, Callable[[int], Member], Callable[[Member], Judged | None]]] = {
    "norm": ("norms versus rational arithmetic", 1320, linear_member, against_exact),
    "roads": (
        "simulated roads, negligible friction, versus norms",
        120,
        member_with_friction,
        lambda member: of_hardly_any_friction(member, ROADS),
    ),
    "roads-steps": (
        "simulated roads versus shorter steps",
        120,
        member_with_friction,
        lambda member: of_finer_steps(member, ROADS),
    ),
    "sines": (
        "simulated sines, negligible friction, versus norms",
        60,
        member_under_a_sine,
        lambda member: of_hardly_any_friction(member, ROADS),
    ),
    "sines-steps": (
        "simulated sines versus shorter steps",
        60,
        member_under_a_sine,
        lambda member: of_finer_steps(member, ROADS),
    ),
    "gains-steps": (
        "approximate linear model versus shorter steps",
        60,
        member_with_friction,
        lambda member: of_finer_steps(member, GAINS),
    ),
    "linearisation": (
        "statistical linearisation versus 16 simulated roads",
        120,
        member_with_friction,
        lambda member: of_linearisation(member, 16),
    ),
    "balance": (
        "harmonic balance versus simulated sines",
        120,
        member_under_a_sine,
        lambda member: of_linearisation(member, 2),
    ),
}
SCATTER = {
    "roads-intervals": (40, lambda seed: it.ExpectedValue(realisations=8, seed=seed, jobs=1)),
    "gains-intervals": (24, lambda seed: it.ApproximateLinear(realisations=4, seed=seed)),
}
_SEEDS = 12


def judge(part: str, first: int, count: int) -> None:
    """Members, how many exceed their bound, and how much larger than errors bounds are."""
    words, _, draw, judged = PARTS[part]
    found, exceeded, pessimism, without, start = 0, 0, [], 0, time.process_time()
    for number in range(first, first + count):
        member = draw(number)
        try:
            one = judged(member)
        except it.InerterError:  # a question that the vehicle does not answer
            one = None
        if one is None:
            without += 1
            continue
        found += 1
        if one.exceeded:
            exceeded += 1
            print(f"  EXCEEDED: {part} {number}, {member.name}: {one}", flush=True)
        if one.error > 0.0:
            pessimism.append(one.bound / one.error)
    print(
        f"{words}: {found} members ({without} without a value or a question), {exceeded} exceeded, bound over error "
        f"{np.median(pessimism):.3g} (median; {time.process_time() - start:.0f} s)",
        flush=True,
    )


def cover(part: str, first: int, count: int) -> None:
    """How many intervals of 95 % hold the mean of others, with the binomial interval of that share."""
    held, all_of_them, start = 0, 0, time.process_time()
    for number in range(first, first + count):
        member = member_with_friction(number)
        one = intervals(member, SCATTER[part][1], _SEEDS)
        if one is not None:
            held, all_of_them = held + one[0], all_of_them + one[1]
    ends = scipy.stats.binomtest(held, all_of_them).proportion_ci()
    print(
        f"{part}: {held} of {all_of_them} intervals hold, {held / all_of_them:.3f} ({ends.low:.3f} to {ends.high:.3f}; "
        f"{time.process_time() - start:.0f} s)",
        flush=True,
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--part", choices=[*PARTS, *SCATTER])
    parser.add_argument("--count", type=int)
    parser.add_argument("--first", type=int, default=0)
    asked = parser.parse_args()
    for name in [asked.part] if asked.part else [*PARTS, *SCATTER]:
        usual = PARTS[name][1] if name in PARTS else SCATTER[name][0]
        (judge if name in PARTS else cover)(name, asked.first, asked.count or usual)
