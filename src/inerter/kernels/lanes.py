"""Several designs side by side: numbers of compiled code that are `WIDTH` numbers, one of each design.

Parts that are written for numbers serve for these too: `in_lanes` makes an array of them, all arithmetic is that of
each lane, and a number alone stands for one that is equal in all lanes. Each operation is rounded as it is for one
number. There are no branches: a comparison becomes a number by `is_between`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import instruction, numba_lanes

Array = Any
WIDTH = 16  # two registers of AVX-512
GROUP = 8  # rows of a matrix side by side: one of them


def _is_between(x: float, low: float, high: float) -> float:
    """1.0 if low < x < high, else 0.0, also for nan."""
    return 1.0 if low < x < high else 0.0


@instruction(_is_between)
def is_between(typing: Any, x: Any, low: Any, high: Any) -> Any:
    """Compile `_is_between`, in each lane."""
    return numba_lanes().is_between(x, low, high)


def _larger(x: float, y: float) -> float:
    """The larger of two numbers; y if one is nan."""
    return x if x > y else y


@instruction(_larger)
def larger(typing: Any, x: Any, y: Any) -> Any:
    """Compile `_larger`, in each lane."""
    return numba_lanes().larger(x, y)


def _smaller(x: float, y: float) -> float:
    """The smaller of two numbers; y if one is nan."""
    return x if x < y else y


@instruction(_smaller)
def smaller(typing: Any, x: Any, y: Any) -> Any:
    """Compile `_smaller`, in each lane."""
    return numba_lanes().smaller(x, y)


def _choose(condition: float, x: Any, y: Any) -> Any:
    """The first of two numbers where the condition is not zero, else the second."""
    return x if condition != 0.0 else y


@instruction(_choose)
def choose(typing: Any, condition: Any, x: Any, y: Any) -> Any:
    """Compile `_choose`, in each lane."""
    return numba_lanes().choose(condition, x, y)


def _largest_lane(x: float) -> float:
    """The largest of the numbers in all lanes."""
    return x


@instruction(_largest_lane)
def largest_lane(typing: Any, x: Any) -> Any:
    """Compile `_largest_lane`."""
    return numba_lanes().largest_lane(x)


def _root(x: float) -> float:
    return np.sqrt(x)  # type: ignore[no-any-return]


@instruction(_root)
def root(typing: Any, x: Any) -> Any:
    """Compile the square root, of each lane."""
    return numba_lanes().root(x)


def _in_lanes(flat: Array, shape: tuple[int, ...]) -> Array:
    """Array of lanes in the room of an array of numbers, which has `WIDTH` numbers more than it needs."""
    raise NotImplementedError


@instruction(_in_lanes)
def in_lanes(typing: Any, flat: Any, shape: Any) -> Any:
    """Compile `_in_lanes`."""
    return numba_lanes().in_lanes(flat, shape, WIDTH)


def _in_numbers(lanes: Array) -> Array:
    """The lanes (n, `WIDTH`) of an array (n,), to read and write."""
    raise NotImplementedError


@instruction(_in_numbers)
def in_numbers(typing: Any, lanes: Any) -> Any:
    """Compile `_in_numbers`."""
    return numba_lanes().in_numbers(lanes)


def _multiply_add(a: Any, b: Any, c: Any) -> Any:
    return a * b + c


@instruction(_multiply_add)
def multiply_add(typing: Any, a: Any, b: Any, c: Any) -> Any:
    """Compile a b + c, with one rounding where the processor has that."""
    return numba_lanes().multiply_add(a, b, c)


def _as_numbers(array: Array, first: int, shape: tuple[int, int]) -> Array:
    """The numbers of an array from one on, as a matrix."""
    return array.reshape(-1)[first : first + shape[0] * shape[1]].reshape(shape)


@instruction(_as_numbers)
def as_numbers(typing: Any, array: Any, first: Any, shape: Any) -> Any:
    """Compile `_as_numbers`: where the shape is constant, so are the distances between the numbers."""
    return numba_lanes().over_numbers(array, first, shape, 1)


@instruction(_as_numbers)
def in_groups(typing: Any, array: Any, first: Any, shape: Any) -> Any:
    """Compile `_as_numbers` with `GROUP` columns side by side, as one column."""
    return numba_lanes().over_numbers(array, first, shape, GROUP)


def _constant_at(array: Array, i: int, j: int) -> Any:
    return array[i, j]


@instruction(_constant_at)
def constant_at(typing: Any, array: Any, i: Any, j: Any) -> Any:
    """Compile `array[i, j]` of what nothing changes meanwhile: the compiler may keep it in a register."""
    return numba_lanes().constant_at(array, i, j)


def _lane(x: float, j: int) -> float:
    """Number j of those in all lanes; of a number alone it is that."""
    return x


@instruction(_lane)
def lane(typing: Any, x: Any, j: Any) -> Any:
    """Compile `_lane`."""
    return numba_lanes().lane(x, j)
