"""Whole steps inside one mode, compiled for each size of system: constant loop bounds make them twice as fast."""

from __future__ import annotations

from functools import cache

import numpy as np

from inerter.kernels.arrays import SHARP, Array, ConstantInts, History, Knots, March, MarchLines, MarchShape, Span
from inerter.kernels.decorators import function_at, kernel, part


def round_up_to_four(rows: int) -> int:
    """Smallest multiple of four that is at least `rows`."""
    return -(-rows // 4) * 4


def lines_of(n: int, inputs: int, elements: int, outputs: int, jumps: int, sharp: bool) -> tuple[int, int, int]:
    """Columns of a step, and its rows: of what follows from them, and of the guards' sway."""
    rows = n + 2 * elements + outputs * (2 if jumps else 1) + (SHARP * elements if sharp else 0)
    return n + inputs + 1, round_up_to_four(rows), round_up_to_four(elements)


@part(inside=True, borrowing=True, fused=True)
def apply_jumps(lines: MarchLines, knots: Knots, k: int, shape: MarchShape, v: Array, before: Array) -> bool:
    """Apply the jumps of inputs at knot k to the positions, and keep the state before; True if an input jumps."""
    leaps, columns = False, shape.states + shape.inputs + 1
    for c in range(shape.jumps):
        leaps = leaps or knots.value[k, c] != knots.value_before[k, c]
    if leaps:
        for i in range(shape.states):
            before[i] = v[i]
        for c in range(shape.jumps):
            rise = knots.value[k, c] - knots.value_before[k, c]
            for i in range(shape.states):
                v[i] += lines.steps[columns + c, i] * rise
    return leaps


@part(inside=True, borrowing=True, fused=True)
def fill_inputs(knots: Knots, k: int, step: float, shape: MarchShape, numbers: Array, v: Array) -> None:
    """Fill `v` with the used `flow.knot_numbers` of the inputs over the step after knot k."""
    for j in range(shape.inputs):
        c, number, at = numbers[j] // 4, numbers[j] % 4, shape.states + j
        if number == 0:
            v[at] = knots.value[k, c]
        elif number == 1:
            v[at] = knots.value_before[k + 1, c] - knots.value[k, c]
        elif number == 2:
            v[at] = step * knots.slope[k, c]
        else:
            v[at] = step * knots.slope_before[k + 1, c]


@part(inside=True, borrowing=True, fused=True)
def evaluate_step(steps: Array, v: Array, shape: MarchShape, y: Array) -> None:
    """State, guards and outputs at the end of the step, and last the largest sway of each guard."""
    columns, sways = shape.states + shape.inputs + 1, (shape.elements + 3) // 4 * 4
    for i in range(0, shape.rows, 4):  # four rows at once, which one instruction does
        y0, y1, y2, y3 = 0.0, 0.0, 0.0, 0.0
        for j in range(columns - 1, -1, -1):  # the inputs first, which need not wait for the state
            y0 += steps[j, i] * v[j]
            y1 += steps[j, i + 1] * v[j]
            y2 += steps[j, i + 2] * v[j]
            y3 += steps[j, i + 3] * v[j]
        y[i], y[i + 1], y[i + 2], y[i + 3] = y0, y1, y2, y3
    for i in range(shape.rows, shape.rows + sways, 4):
        y0, y1, y2, y3 = 0.0, 0.0, 0.0, 0.0
        for j in range(columns):
            size = abs(v[j])
            y0 += steps[j, i] * size
            y1 += steps[j, i + 1] * size
            y2 += steps[j, i + 2] * size
            y3 += steps[j, i + 3] * size
        y[i], y[i + 1], y[i + 2], y[i + 3] = y0, y1, y2, y3


@part(inside=True, borrowing=True, fused=True)
def is_safe(limits: Array, shape: MarchShape, y: Array) -> bool:
    """Whether no guard can be crossed within the step."""
    safe, n = True, shape.states
    bends = n + 2 * shape.elements + shape.squares * (2 if shape.jumps else 1)  # rows of the sway's first terms
    terms = SHARP if shape.sharp else 0
    for e in range(shape.elements):
        end, start, sway = y[n + e], y[n + shape.elements + e], y[shape.rows + e]
        for term in range(terms):
            sway += abs(y[bends + term * shape.elements + e])
        if not (min(start, end) - sway > limits[e, 0] and max(start, end) + sway < limits[e, 1]):
            safe = False
    return safe


@part(inside=True, borrowing=True, fused=True)
def record_jump(record: History, slot: int, counts: bool, shape: MarchShape, v: Array, y: Array) -> None:
    """Replace the sample at a jump, and its squares if it `counts`, by those after the jump."""
    if slot < record.states.shape[0]:
        for i in range(shape.states):
            record.states[slot, i] = v[i]
    if counts:
        for o in range(shape.squares):
            at_start = shape.states + 2 * shape.elements + shape.squares + o
            record.squares[o] += y[at_start] ** 2 - record.last[o]


@part(inside=True, borrowing=True, fused=True)
def record_step(record: History, slots: Array, k: int, span: Span, shape: MarchShape, v: Array, y: Array) -> None:
    """Advance the state to the end of the step, and record its sample and squares."""
    if k >= span.settled and slots[k + 1] >= 0:
        for o in range(shape.squares):
            record.last[o] = y[shape.states + 2 * shape.elements + o] ** 2
            record.squares[o] += record.last[o]
    for i in range(shape.states):
        v[i] = y[i]
    slot = slots[k + 1]
    if slot >= 0 and slot < record.states.shape[0]:
        record.visited[slot] = span.mode
        for i in range(shape.states):
            record.states[slot, i] = y[i]


@part(typed=True, borrowing=True, inside=True, fused=True)
def march_steps(
    lines: MarchLines, knots: Knots, record: History, span: Span, shape: MarchShape, numbers: ConstantInts
) -> int:
    """Step while no guard can be crossed within the step; returns the first segment that needs event detection."""
    columns, sways = shape.states + shape.inputs + 1, (shape.elements + 3) // 4 * 4
    v, y = lines.work[:columns], lines.work[columns : columns + shape.rows + sways]
    before = lines.work[columns + shape.rows + sways :]
    for i in range(shape.states):
        v[i] = lines.state[i]
    v[columns - 1] = 1.0
    k = span.first
    while k < span.stop:
        leaps = apply_jumps(lines, knots, k, shape, v, before)
        fill_inputs(knots, k, span.step, shape, numbers, v)
        evaluate_step(lines.steps, v, shape, y)
        if not is_safe(lines.limits, shape, y):
            if leaps:
                for i in range(shape.states):
                    v[i] = before[i]
            break
        if leaps and knots.slot[k] >= 0:
            record_jump(record, knots.slot[k], k > span.settled, shape, v, y)
        record_step(record, knots.slot, k, span, shape, v, y)
        k += 1
    for i in range(shape.states):
        lines.state[i] = v[i]
    return k


def march_type(lines: MarchLines, knots: Knots, record: History, span: Span) -> int:
    """The type of a march, which is called through its address."""
    raise NotImplementedError


march_at = function_at(march_type)


@part(borrowing=True)
def march_with_sizes(march: March, lines: MarchLines, knots: Knots, record: History, span: Span) -> int:
    """Whole steps by `march_steps` with sizes read at run time: the same numbers, at half the speed."""
    return march_steps(lines, knots, record, span, march.shape, march.numbers)


@part(borrowing=True, plain=march_with_sizes)
def whole_steps(march: March, lines: MarchLines, knots: Knots, record: History, span: Span) -> int:
    """Whole steps by the `march_steps` compiled for this shape.

    Its address is handed over, not the function: that would run Python code within the call, which Ctrl-C can break.
    """
    return int(march_at(march.address)(lines, knots, record, span))


@cache
def march_of(n: int, used: tuple[int, ...], elements: int, outputs: int, jumps: int, sharp: bool) -> March:
    """The march for systems of n states, these of `flow.knot_numbers`, so many nonlinear elements and squared outputs.

    It steps while no guard can be crossed within the step, and returns the first segment that needs event detection.
    Where signals are held, the first `jumps` inputs may jump at every knot: positions follow at once. `sharp`: the
    first terms of the guards' sway are values, not sums of sizes, so that large motions cancel in them.
    """
    _, rows, _ = lines_of(n, len(used), elements, outputs, jumps, sharp)
    shape = MarchShape(n, len(used), elements, outputs, jumps, rows, sharp)
    numbers = np.array(used or (0,), np.int64)

    @kernel("march", typed=True, fused=True, borrowing=True, by_address=True)
    def march(lines: MarchLines, knots: Knots, record: History, span: Span) -> int:
        return march_steps(lines, knots, record, span, shape, numbers)

    return March(march_at.address_of(march), shape, numbers)
