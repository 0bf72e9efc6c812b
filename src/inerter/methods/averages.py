"""Means of independent values, and their uncertainty."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

CONFIDENCE = 0.95
NORMAL_QUANTILE = 1.959963984540054  # standard errors in half of a confidence interval, for normal errors


def mean_and_error(values: NDArray[np.float64]) -> tuple[float, float, tuple[float, float]]:
    """Mean of independent values, its standard error, and its 95 % confidence interval."""
    mean, error = float(np.mean(values)), float(np.std(values, ddof=1) / np.sqrt(values.size))
    return mean, error, interval_of(mean, error, values.size)


def interval_of(mean: float, error: float, count: int) -> tuple[float, float]:
    """95 % confidence interval about the mean of `count` values: Student's t, or normal for fewer than two values."""
    # As `scipy.stats` has it, which takes a quarter of a second to load, in each process anew.
    quantile = float(scipy.special.stdtrit(count - 1, 0.5 + 0.5 * CONFIDENCE)) if count > 1 else NORMAL_QUANTILE
    reach = quantile * error
    return mean - reach, mean + reach
