"""Comparison of values of which the least is the best, with ties where their accuracy does not separate them."""

from __future__ import annotations

import math
from collections.abc import Sequence

ACCURACY = 1e-9  # relative, of a value that is ok


def percent_below(value: float, base: float) -> float:
    """Reduction of a value relative to that of the baseline [%]; nan where they cannot be compared.

    >>> percent_below(0.75, 1.0), percent_below(1.0, 0.0)
    (25.0, nan)
    """
    return 100.0 * (1.0 - value / base) if math.isfinite(value) and math.isfinite(base) and base else math.nan


def equally_least(values: Sequence[float]) -> list[int]:
    """Numbers of the values that may be the least, in their order; values that are not finite never are.

    >>> equally_least([2.0, 1.0 + 1e-15, math.nan, 1.0])
    [1, 3]
    """
    finite = [value for value in values if math.isfinite(value)]
    if not finite:
        return []
    level = min(finite) + 2.0 * ACCURACY * abs(min(finite))  # each of two may be off
    return [i for i, value in enumerate(values) if value <= level]
