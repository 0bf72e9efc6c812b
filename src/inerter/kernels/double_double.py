"""Sums of products as if in twice the precision, kept in two numbers (Ogita, Rump and Oishi, 2005)."""

from __future__ import annotations

from typing import Any

from inerter.kernels.decorators import instruction, part

Array = Any


_SPLIT = 134217729.0  # 2^27 + 1: parts a number into two of half its digits


@instruction
def fused_multiply_add(a: float, b: float, product: float) -> float:
    """Error a b + product of a rounded `-product` of a and b, here by splitting both (Dekker, 1971)."""
    more, further = _SPLIT * a, _SPLIT * b
    a_high, b_high = more - (more - a), further - (further - b)
    a_low, b_low = a - a_high, b - b_high
    return ((a_high * b_high + product) + a_high * b_low + a_low * b_high) + a_low * b_low


@part(borrowing=True, inside=True)
def add_product(high: float, low: float, a: float, b: float) -> Any:
    """(high, low) + a b."""
    product = a * b
    total = high + product
    came = total - high
    return total, low + ((high - (total - came)) + (product - came) + fused_multiply_add(a, b, -product))


@part(borrowing=True)
def add_multiple(high: Array, low: Array, factor: float, row: Array, count: int) -> None:
    """Add `factor` times a row to (high, low), entry by entry."""
    for j in range(count):
        high[j], low[j] = add_product(high[j], low[j], factor, row[j])
