"""Results as data that JSON can hold."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def json_data(value: Any) -> Any:
    """JSON has no infinity, which is text, nothing that is no number, which is null, and no arrays, which are lists.

    >>> json_data({"gain": float("inf"), "error": float("nan"), "values": (np.float64(1.5), 2), "time": np.zeros(2)})
    {'gain': 'inf', 'error': None, 'values': [1.5, 2], 'time': [0.0, 0.0]}
    """
    match value:
        case Mapping():
            return {str(key): json_data(item) for key, item in value.items()}
        case list() | tuple():
            return [json_data(item) for item in value]
        case float():
            return None if math.isnan(value) else float(value) if math.isfinite(value) else str(float(value))
        case np.ndarray():
            is_plain = value.dtype.kind != "f" or bool(np.isfinite(value).all())
            return value.tolist() if is_plain else json_data(value.tolist())
        case np.generic():
            return json_data(value.item())
    return value
