"""Gradients of objectives, and the differences of values that they are compared with."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]


def value_and_gradient(objective: Any, point: Array) -> tuple[float, Array]:
    """Value of an objective and its gradient, those of its largest component if it has several."""
    which = objective.active(point)
    if which is None:
        value, gradient = objective.value_and_gradient(point)
        return value, gradient
    values, gradients = objective.components(point, which)
    return values.max(), gradients[np.argmax(values)]


def assert_slopes(objective: Any, point: Array, gradient: Array, *, step: float = 1e-6, **tolerance: float) -> None:
    """Assert that derivatives by the logarithms of the point are central differences of the values."""
    steps = point * step * np.eye(point.size)
    ends = objective.values(np.vstack([point + steps, point - steps])).reshape(2, -1)
    assert gradient * point == pytest.approx((ends[0] - ends[1]) / (2.0 * step), **tolerance)
