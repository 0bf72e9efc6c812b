"""Elements of networks with given admittances, of random positive-real functions of degrees up to 6.

    python benchmarks/synthesis.py [COUNT]

The families are those of the tests: admittances of random networks, of passive state spaces, and of biquadratics that
are joined, most of which have their smallest real part between zero and infinite frequency.
"""

from __future__ import annotations

import sys
import time
from collections import defaultdict
from pathlib import Path

import numpy as np

import inerter as it

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "synthesis"))
from test_realise import FAMILIES, degree, n_reactive

MOST = 6


def main(count: int) -> None:
    for family in FAMILIES:
        rng, elements, reactive = np.random.default_rng(17), defaultdict(list), defaultdict(list)
        start = time.process_time()
        for _ in range(count):
            n, d = family(rng)
            if degree(n, d) <= MOST:
                network = it.realise(n[::-1], d[::-1])
                elements[degree(n, d)].append(len(list(network.elements())))
                reactive[degree(n, d)].append(n_reactive(network))
        taken = time.process_time() - start
        print(f"{family.__name__}: {sum(map(len, elements.values()))} in {taken:.1f} s")
        for order in sorted(elements):
            of = elements[order]
            print(
                f"  degree {order}: {len(of)}, elements {np.mean(of):.2f} (at most {max(of)}), "
                f"springs and inerters {np.mean(reactive[order]):.2f}"
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
