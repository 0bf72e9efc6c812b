"""Do searches from different seeds find the same optimum? Every design of Tables 1 and 2, 20 seeds each.

    python benchmarks/agreement.py [SEEDS]

Prints, for each design, the lowest value found, the printed one, and the relative spread over the seeds.
"""

from __future__ import annotations

import sys

import inerter as it
from inerter.papers.wang_su_2008.source import linear_rows, study

CLAIM = {"J1": 1e-6, "J3": 1e-6, "J5": 1e-4}


def main(seeds: int) -> None:
    worst = dict.fromkeys(CLAIM, 0.0)
    for row in linear_rows():
        if row.table == 3:
            continue
        source = study("table1" if row.table == 1 else "table2")
        vehicle, index = source.design(row.layout), source.index(row.index)
        values = [it.optimise(vehicle, index, it.Norm("paper2008"), seed=seed).value for seed in range(seeds)]
        spread = max(values) / min(values) - 1.0
        worst[row.index] = max(worst[row.index], spread)
        below = max(values) <= float(row.printed) + 0.5 * row.last_digit
        print(
            f"table {row.table} {row.index} {row.layout:8} lowest {min(values):.9g} printed {row.printed} "
            f"spread {spread:.1e} {'at or below the printed value' if below else 'ABOVE the printed value'}",
            flush=True,
        )
    for index, spread in worst.items():
        print(f"{index}: largest spread over {seeds} seeds {spread:.1e} (claimed {CLAIM[index]:.0e})")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
