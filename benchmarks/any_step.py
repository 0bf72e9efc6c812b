"""Whether a simulation depends on its step, on a cut, or fails: random cars, rigs and custom mechanisms.

    python benchmarks/any_step.py [--count 1000]

Each member is simulated with twelve steps from 0.5 ms to 5 us: the same events in the same order, at times and with
states that agree to rounding where the input is a table, and to fourth order where it is a formula; those whose events
come and go with one part in 10^6 of the road are listed. Each is cut somewhere and gone on with. Then members with
elements over many decades, which must be simulated, refused, or said to be too stiff. Needs the extra "test".
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import count, islice
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "simulation"))

from members import member
from test_joins import joined, stepped
from test_steps import FLOOR, STEPS, checked, order, survives


def each(number: int, what: Callable[[int], object]) -> Iterator[tuple[int, object]]:
    """Outcomes of the first `number` members that are not refused; a failure is printed, with the outcome "WRONG"."""

    def outcomes() -> Iterator[tuple[int, object]]:
        for seed in count(20_000):
            try:
                result = what(seed)
            except AssertionError as error:
                print(f"WRONG: {seed}: {error}", flush=True)
                result = "WRONG"
            if result is not None:
                yield seed, result

    return islice(outcomes(), number)


def steps(number: int) -> None:
    kinds, orders = Counter[str](), list[float]()
    worst = {"table": np.zeros(2), "formula": np.zeros(2)}
    for seed, result in each(number, lambda seed: checked(seed, STEPS)):
        if not isinstance(result, tuple):
            kinds["WRONG"] += 1
            continue
        kind, in_time, in_state = result
        kinds[kind] += 1
        if kind == "grazing":
            print(f"grazing: {seed}, {member(seed).kind}", flush=True)
        if in_state:
            worst[kind] = np.maximum(worst[kind], [max(in_time), max(in_state)])
        known = order(in_state, STEPS, FLOOR) if kind == "formula" else None
        if known is not None:
            orders.append(known)
            if known < 2.5:
                print(f"of order {known:.2f}: {seed}, {member(seed).kind}", flush=True)
    print(f"{len(STEPS)} steps: {dict(kinds)}")
    for kind, (in_time, in_state) in worst.items():
        print(f"  {kind}: events apart by up to {in_time:.1e} s, states by {in_state:.1e} of the largest")
    if orders:
        print(f"  orders of {len(orders)}: {min(orders):.2f} to {max(orders):.2f}, median {np.median(orders):.2f}")


def cuts(number: int, what: Callable[[int], float | None], allowed: float) -> None:
    errors = [error for _, error in each(number, what)]
    known = [error for error in errors if isinstance(error, float)]
    wrong = len(errors) - len(known) + sum(error >= allowed for error in known)
    print(f"{len(errors)} cuts: {wrong} WRONG; apart by up to {max(known):.1e} of the largest")


def extremes(number: int) -> None:
    found = Counter(str(kind) for _, kind in each(number, lambda seed: survives(seed, (5e-4, 2e-4, 5e-5))))
    print(f"over many decades: {dict(found)}")


def main(number: int) -> None:
    for part in (
        lambda: steps(number),
        lambda: cuts(number, joined, 1e-9),
        lambda: cuts(number, stepped, 1e-7),
        lambda: extremes(number),
    ):
        start = time.perf_counter()
        part()
        print(f"  ({time.perf_counter() - start:.0f} s)", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=1000)
    main(parser.parse_args().count)
