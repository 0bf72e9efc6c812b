"""Sums of products as if in twice the precision, kept in two numbers (Ogita, Rump and Oishi, 2005)."""

from __future__ import annotations

from typing import Any

from inerter.kernels.declare import instruction, part

Array = Any


@instruction
def fused(typing: Any, a: Any, b: Any, c: Any) -> Any:
    """Compile a b + c with one rounding."""
    from numba import types  # noqa: PLC0415 - heavy

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), code


@part(borrowing=True)
def add_multiple(high: Array, low: Array, factor: float, row: Array, count: int) -> None:
    """High + low + factor row, entry by entry."""
    for j in range(count):
        product = factor * row[j]
        before = high[j]
        total = before + product
        came = total - before
        low[j] += (before - (total - came)) + (product - came) + fused(factor, row[j], -product)
        high[j] = total


@part(borrowing=True)
def add_product(high: float, low: float, a: float, b: float) -> Any:
    """High + low + a b."""
    product = a * b
    total = high + product
    came = total - high
    return total, low + ((high - (total - came)) + (product - came) + fused(a, b, -product))
