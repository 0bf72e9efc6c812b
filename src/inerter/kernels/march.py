"""Whole steps inside one mode, compiled for each size of system: constant loop bounds make them twice as fast."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from inerter.kernels.arrays import SHARP
from inerter.kernels.declare import instruction, kernel, part

_ARGUMENTS = (
    "float64[:,::1]",  # steps of the mode: a line each column, then the jump of the state with each input
    "float64[:,::1]",  # limits of the guards
    "float64[::1]",  # state, changed in place
    "float64[::1]",  # work space: columns, rows, the state before a jump
    "float64[:,::1]",  # values of the inputs at the knots
    "float64[:,::1]",  # slopes
    "float64[:,::1]",  # values from the left
    "float64[:,::1]",  # slopes from the left
    "int64[::1]",  # sample number at each knot, or -1
    "float64[:,::1]",  # samples of the state
    "int64[::1]",  # modes at the samples
    "float64[:,::1]",  # squared outputs: their sums, and the last that were added
    "float64",  # step
    "int64",  # number of the mode
    "int64",  # first segment
    "int64",  # last
    "int64",  # first segment whose squares count
)
_SIZES = (*("int64",) * 6, "boolean", "Array(int64, 1, 'C', readonly=True)")
SIGNATURE = f"int64({', '.join(_ARGUMENTS)})"


@dataclass(frozen=True)
class March:
    """A march for other compiled code, which takes its address and so need not be compiled anew for each."""

    function: Any
    address: int


@instruction
def march_at(typing: Any, address: Any) -> Any:
    """The march at an address: to pass the function itself runs Python code within the call, which Ctrl-C can break."""
    from numba import types  # noqa: PLC0415 - heavy
    from numba.core import cgutils  # noqa: PLC0415 - heavy

    from inerter.kernels.compiler import parsed  # noqa: PLC0415 - heavy

    kind: Any = types.FunctionType(parsed(SIGNATURE))

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        struct_of: Any = cgutils.create_struct_proxy
        function = struct_of(kind)(context, builder)
        function[0] = builder.inttoptr(given[0], cgutils.voidptr_t)
        return function._getvalue()

    return kind(types.int64), generate


def padded(rows: int) -> int:
    """So many rows, in whole vectors of four."""
    return -(-rows // 4) * 4


def lines_of(n: int, inputs: int, elements: int, outputs: int, jumps: int, sharp: bool) -> tuple[int, int, int]:
    """Columns of a step, and its rows: of what follows from them, and of the guards' sway."""
    rows = n + 2 * elements + outputs * (2 if jumps else 1) + (SHARP * elements if sharp else 0)
    return n + inputs + 1, padded(rows), padded(elements)


@part(f"int64({', '.join((*_ARGUMENTS, *_SIZES))})", borrowing=True, inside=True)
def go_on(  # type: ignore[no-untyped-def]
    steps, limits, x, work, value, slope, value_before, slope_before, slot, states, visited, sums,
    h, mode, first, stop, settled, n, inputs, elements, outputs, jumps, rows, sharp, numbers,
):  # fmt: skip
    """Go on while no guard can be crossed within the step; the first segment that needs more care."""
    columns, sways = n + inputs + 1, (elements + 3) // 4 * 4
    bends = n + 2 * elements + outputs * (2 if jumps else 1)  # rows of the sway's first terms
    terms = SHARP if sharp else 0
    at_end, at_start = n + 2 * elements, n + 2 * elements + outputs  # rows of outputs
    v, y, before = work[:columns], work[columns : columns + rows + sways], work[columns + rows + sways :]
    for i in range(n):
        v[i] = x[i]
    v[columns - 1] = 1.0
    k = first
    while k < stop:
        leaps = False
        for c in range(jumps):
            leaps = leaps or value[k, c] != value_before[k, c]
        if leaps:
            for i in range(n):
                before[i] = v[i]
            for c in range(jumps):
                rise = value[k, c] - value_before[k, c]
                for i in range(n):
                    v[i] += steps[columns + c, i] * rise
        for j in range(inputs):
            c, number = numbers[j] // 4, numbers[j] % 4
            if number == 0:
                v[n + j] = value[k, c]
            elif number == 1:
                v[n + j] = value_before[k + 1, c] - value[k, c]
            elif number == 2:
                v[n + j] = h * slope[k, c]
            else:
                v[n + j] = h * slope_before[k + 1, c]
        for i in range(0, rows, 4):  # four rows at once, which one instruction does
            y0, y1, y2, y3 = 0.0, 0.0, 0.0, 0.0
            for j in range(columns - 1, -1, -1):  # the inputs first, which need not wait for the state
                y0 += steps[j, i] * v[j]
                y1 += steps[j, i + 1] * v[j]
                y2 += steps[j, i + 2] * v[j]
                y3 += steps[j, i + 3] * v[j]
            y[i], y[i + 1], y[i + 2], y[i + 3] = y0, y1, y2, y3
        for i in range(rows, rows + sways, 4):
            y0, y1, y2, y3 = 0.0, 0.0, 0.0, 0.0
            for j in range(columns):
                size = abs(v[j])
                y0 += steps[j, i] * size
                y1 += steps[j, i + 1] * size
                y2 += steps[j, i + 2] * size
                y3 += steps[j, i + 3] * size
            y[i], y[i + 1], y[i + 2], y[i + 3] = y0, y1, y2, y3
        safe = True
        for e in range(elements):
            end, start, sway = y[n + e], y[n + elements + e], y[rows + e]
            for term in range(terms):
                sway += abs(y[bends + term * elements + e])
            if not (min(start, end) - sway > limits[e, 0] and max(start, end) + sway < limits[e, 1]):
                safe = False
        if not safe:
            if leaps:
                for i in range(n):
                    v[i] = before[i]
            break
        if leaps and slot[k] >= 0:  # the sample and its squares are those after the jump
            if slot[k] < states.shape[0]:
                for i in range(n):
                    states[slot[k], i] = v[i]
            if k > settled:
                for o in range(outputs):
                    sums[0, o] += y[at_start + o] ** 2 - sums[1, o]
        if k >= settled and slot[k + 1] >= 0:
            for o in range(outputs):
                sums[1, o] = y[at_end + o] ** 2
                sums[0, o] += sums[1, o]
        for i in range(n):
            v[i] = y[i]
        k += 1
        sample = slot[k]
        if sample >= 0 and sample < states.shape[0]:
            visited[sample] = mode
            for i in range(n):
                states[sample, i] = y[i]
    for i in range(n):
        x[i] = v[i]
    return k


@cache
def march_of(n: int, used: tuple[int, ...], elements: int, outputs: int, jumps: int, sharp: bool) -> March:
    """The march for systems of n states, these of `flow.knot_numbers`, so many nonlinear elements and squared outputs.

    It goes on while no guard can be crossed within the step, and returns the first segment that needs more care. Where
    signals are held, the first `jumps` inputs may jump at every knot: positions follow at once. `sharp`: the first
    terms of the guards' sway are values, not sums of sizes, which sees that large motions cancel in them.
    """
    inputs = len(used)
    _, rows, _ = lines_of(n, inputs, elements, outputs, jumps, sharp)
    numbers = np.array(used or (0,), np.int64)

    @kernel("march", SIGNATURE, fused=True, borrowing=True)
    def march(  # type: ignore[no-untyped-def]
        steps, limits, x, work, value, slope, value_before, slope_before, slot, states, visited, sums,
        h, mode, first, stop, settled,
    ):  # fmt: skip
        return go_on(  # type: ignore[no-untyped-call]
            steps, limits, x, work, value, slope, value_before, slope_before, slot, states, visited, sums,
            h, mode, first, stop, settled, n, inputs, elements, outputs, jumps, rows, sharp, numbers,
        )  # fmt: skip

    from inerter.kernels.compiler import address_of  # noqa: PLC0415 - heavy

    function = march.ready()  # type: ignore[attr-defined]
    return March(function, address_of(function, SIGNATURE))
