"""Several designs side by side: numbers of compiled code that are `WIDTH` numbers, one of each design.

Parts that are written for numbers serve for these too: `in_lanes` makes an array of them, all arithmetic is that of
each lane, and a number alone stands for one that is equal in all lanes. Each operation is rounded as it is for one
number. There are no branches: a comparison becomes a number by `is_between`. What is here is the plain form of
each instruction, which acts on one number; compiled code has the definition of its name in `numba_lanes`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import instruction

Array = Any
WIDTH = 16  # two registers of AVX-512
GROUP = 8  # rows of a matrix side by side: one of them


@instruction
def is_between(x: float, low: float, high: float) -> float:
    """1.0 if low < x < high, else 0.0, also for nan."""
    return 1.0 if low < x < high else 0.0


@instruction
def larger(x: float, y: float) -> float:
    """The larger of two numbers; y if one is nan."""
    return x if x > y else y


@instruction
def smaller(x: float, y: float) -> float:
    """The smaller of two numbers; y if one is nan."""
    return x if x < y else y


@instruction
def choose(condition: float, x: Any, y: Any) -> Any:
    """The first of two numbers where the condition is not zero, else the second."""
    return x if condition != 0.0 else y


@instruction
def largest_lane(x: float) -> float:
    """The largest of the numbers in all lanes."""
    return x


@instruction
def root(x: float) -> float:
    """Square root."""
    return np.sqrt(x)  # type: ignore[no-any-return]


@instruction
def in_lanes(flat: Array, shape: tuple[int, ...]) -> Array:
    """Array of lanes in the room of an array of numbers, which has `WIDTH` numbers more than it needs."""
    raise NotImplementedError


@instruction
def in_numbers(lanes: Array) -> Array:
    """The lanes (n, `WIDTH`) of an array (n,), to read and write."""
    raise NotImplementedError


@instruction
def multiply_add(a: Any, b: Any, c: Any) -> Any:
    """Compute a b + c, with one rounding where the processor has that."""
    return a * b + c


@instruction
def as_numbers(array: Array, first: int, shape: tuple[int, int]) -> Array:
    """The numbers of an array from one on, as a matrix: where the shape is constant, so are distances between them."""
    return array.reshape(-1)[first : first + shape[0] * shape[1]].reshape(shape)


@instruction
def in_groups(array: Array, first: int, shape: tuple[int, int]) -> Array:
    """The same with `GROUP` columns side by side, as one column."""
    return as_numbers(array, first, shape)


@instruction
def constant_at(array: Array, i: int, j: int) -> Any:
    """Entry of what nothing changes meanwhile: the compiler may keep it in a register."""
    return array[i, j]


@instruction
def lane(x: float, j: int) -> float:
    """Number j of those in all lanes; of a number alone it is that."""
    return x
