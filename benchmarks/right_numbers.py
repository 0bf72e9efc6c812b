"""Whether every number of `Norm` is right or said not to be: random mechanisms against rational arithmetic.

    python benchmarks/right_numbers.py [--count 335]

Families of random mechanisms, each with usual, wide and extreme values, 1e-12 to 1e13 among them, and in units of mass
1e18 apart; J1, J3 and J5 of each. 335 a family and range are 5025 mechanisms. Needs the extra "test" (python-flint).
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from random_mechanisms import FAMILIES, mechanisms
from rational_norms import INFINITE, index_value

from inerter import LoadCarrying, Norm, RideComfort, Road, TyreLoad, evaluate
from inerter.errors import MechanismError

ROAD = Road(roughness=5e-7, speed=25.0)
INDICES = (RideComfort(ROAD), TyreLoad(ROAD), LoadCarrying())


def verdict_of(mechanism, index) -> tuple[str, float]:
    """Verdict on one number, and its relative error; 0 without one."""
    try:
        estimate = evaluate(mechanism, index, Norm())
    except MechanismError:
        return "refused", 0.0
    expected = index_value(mechanism, index)
    if expected is None:
        return "without a reference (equal poles)", 0.0
    if math.isnan(estimate.value):
        return "nan with a status" if estimate.status.message else "WRONG", 0.0
    if expected is INFINITE:
        return ("right, infinite" if estimate.value == math.inf and not estimate.status.ok else "WRONG"), 0.0
    error = abs(estimate.value / expected - 1.0) if expected else abs(estimate.value)
    return ("right" if error <= 1e-9 and estimate.status.ok else "WRONG"), error


def main(count: int) -> None:
    found: Counter[str] = Counter()
    worst = 0.0
    for family in FAMILIES:
        for extremes in (1.0, 1e2, 1e4):
            start = time.perf_counter()
            here: Counter[str] = Counter()
            for mechanism in mechanisms(family, 11, count, extremes):
                for index in INDICES:
                    outcome, error = verdict_of(mechanism, index)
                    here[outcome] += 1
                    if outcome == "WRONG":
                        print(index.symbol, mechanism)
                    else:
                        worst = max(worst, error)
            found += here
            shares = ", ".join(f"{number} {what}" for what, number in here.items())
            print(f"{family}, values over {extremes:g}: {shares} ({time.perf_counter() - start:.0f} s)", flush=True)
    print(f"together: {dict(found)}; worst relative error {worst:.1e}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=335)
    main(parser.parse_args().count)
