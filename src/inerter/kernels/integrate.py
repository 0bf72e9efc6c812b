"""Whole steps inside one mode, compiled for each size of system: constant loop bounds make them twice as fast.

Steps are made and judged in blocks. Two steps follow from one state, so that the second need not wait for the first,
and rows of a step are computed in groups that one instruction takes.
"""

from __future__ import annotations

from collections import Counter
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.arrays import (
    AT_ONCE,
    SHARP,
    Array,
    ConstantInts,
    History,
    Knots,
    March,
    MarchLines,
    MarchShape,
    Span,
)
from inerter.kernels.decorators import FunctionAt, kernel, part
from inerter.kernels.lanes import GROUP, as_numbers, constant_at, in_groups, lane, larger, multiply_add, smaller

BLOCK = 16  # steps that are judged together
_FIRST = 4  # the same in the first block: where one alarm follows another, all steps made beyond it are in vain
_REGISTERS = 28  # of the processor, without those for sums
WORTH_COMPILING = 1_000_000  # steps of one shape: compiled they take 10 ms less, as loading code that is kept takes
_STEPS: Counter[tuple[MarchShape, tuple[int, ...]]] = Counter()  # of each shape, in this process
_EXTREMES = 7  # rows of `Path.extremes`, see there
_STATES, _INPUTS, _BENDS, _LEAST, _MOST, _OF_BLOCK, _OF_STEP = range(_EXTREMES)


class Path(NamedTuple):
    """Work space of a march: numbers, and the same in groups."""

    rows: Array  # (steps + 1, rows): state, guards and outputs at the end of each step, after the state at the start
    row_groups: Array
    inputs: Array  # (steps, inputs)
    input_groups: Array
    extremes: Array  # largest sizes of states, inputs and bends, extremes of guards, sways in the block and in a step
    extreme_groups: Array
    before: Array  # (steps, n + 1): state before the jump of an input, and 1 if there is one


@part(borrowing=True, inside=True)
def round_up(count: int) -> int:
    """Smallest multiple of `GROUP` that is at least `count`."""
    return (count + GROUP - 1) // GROUP * GROUP


def lines_of(n: int, inputs: int, elements: int, outputs: int, jumps: int, sharp: bool) -> tuple[int, int, int]:
    """Lines of the matrix of steps, and its rows: of what follows from them, and of the guards' sway.

    Lines are those of a step, the jumps of the state with each input, and those of two steps.
    """
    rows = n + 2 * elements + outputs * (2 if jumps else 1) + (AT_ONCE * elements if sharp else 0)
    return 2 * n + 3 * inputs + 2 + jumps, round_up(rows), sway_columns(elements)


@part(borrowing=True, inside=True)
def sway_columns(elements: int) -> int:
    """Columns of the sway of guards: sizes of what is no value at once; for the closest bound sizes, and values."""
    return round_up((2 + SHARP) * elements)


def room_of(shape: MarchShape) -> int:
    """Numbers in the work space of a march."""
    inputs = round_up(shape.inputs)
    widest = max(shape.rows, inputs, round_up(shape.elements))
    return (BLOCK + 1) * shape.rows + BLOCK * inputs + _EXTREMES * widest + BLOCK * (shape.states + 1)


@part(inside=True, borrowing=True)
def path_in(work: Array, shape: MarchShape) -> Path:
    """The work space in its parts."""
    wide = round_up(shape.inputs)
    rows, inputs = (BLOCK + 1, shape.rows), (BLOCK, wide)
    extremes = (_EXTREMES, max(shape.rows, wide, round_up(shape.elements)))
    second = rows[0] * rows[1]
    third = second + inputs[0] * inputs[1]
    return Path(
        as_numbers(work, 0, rows),
        in_groups(work, 0, rows),
        as_numbers(work, second, inputs),
        in_groups(work, second, inputs),
        as_numbers(work, third, extremes),
        in_groups(work, third, extremes),
        as_numbers(work, third + extremes[0] * extremes[1], (BLOCK, shape.states + 1)),
    )


@part(inside=True, borrowing=True, fused=True)
def fill_inputs(
    knots: Knots, k: int, step: float, shape: MarchShape, numbers: Array, inputs: Array, count: int
) -> None:
    """Fill the used `flow.knot_numbers` of the inputs over `count` steps from knot k on."""
    value, slope = knots.value[k : k + count], knots.slope[k : k + count]
    next_value, next_slope = knots.value_before[k + 1 : k + count + 1], knots.slope_before[k + 1 : k + count + 1]
    for b in range(count):
        for j in range(shape.inputs):
            c, number = numbers[j] // 4, numbers[j] % 4
            if number == 0:
                inputs[b, j] = value[b, c]
            elif number == 1:
                inputs[b, j] = next_value[b, c] - value[b, c]
            elif number == 2:
                inputs[b, j] = step * slope[b, c]
            else:
                inputs[b, j] = step * next_slope[b, c]


@part(inside=True, borrowing=True, fused=True)
def apply_jumps(jumps: Array, knots: Knots, k: int, path: Path, b: int, shape: MarchShape) -> None:
    """Apply the jumps of inputs at knot k to the positions before step b, and keep the state before."""
    n, leaps = shape.states, False
    for i in range(n):
        path.before[b, i] = path.rows[b, i]
    for c in range(shape.jumps):
        rise = knots.value[k, c] - knots.value_before[k, c]
        leaps = leaps or rise != 0.0
        for i in range(n):
            path.rows[b, i] += jumps[c, i] * rise
    path.before[b, n] = 1.0 if leaps else 0.0


@part(inside=True, borrowing=True)
def groups_of(path: Path, shape: MarchShape, first: int, stop: int) -> tuple[int, int]:
    """The groups that hold these columns of a row: the first, and the one after the last."""
    width = max(shape.rows, 1) // max(path.row_groups.shape[1], 1)
    return first // width, (stop + width - 1) // width


@part(inside=True, borrowing=True)
def groups_with_states(path: Path, shape: MarchShape) -> int:
    """Number of groups of a row that hold the state."""
    return groups_of(path, shape, 0, shape.states)[1]


@part(inside=True, borrowing=True)
def is_state_held(path: Path, shape: MarchShape) -> bool:
    """Whether one group holds the state, and registers that group, its numbers and the lines of both steps."""
    return groups_with_states(path, shape) == 1 and 3 * (shape.states + shape.inputs) < _REGISTERS


@part(inside=True, borrowing=True, fused=True)
def follow(lines: Array, path: Path, state: Any, b: int, steps: int, g: int, shape: MarchShape) -> Any:
    """Group g of what follows from the state before step b and the inputs of so many `steps`.

    `state` is that state if it `is_state_held`: it need not go through memory. Nothing is stored here, so that two of
    these take a number once.
    """
    n, m, is_held = shape.states, shape.inputs, g == 0 and is_state_held(path, shape)
    total, other = constant_at(lines, n + steps * m, g), 0.0
    for s in range(steps):  # the inputs first, which need not wait for the state
        for j in range(m):
            total = multiply_add(constant_at(lines, n + s * m + j, g), path.inputs[b + s, j], total)
    for j in range(0, n - 1, 2):  # two sums, which need not wait for each other
        even, odd = path.rows[b, j], path.rows[b, j + 1]
        if is_held:
            even, odd = lane(state, j), lane(state, j + 1)
        total = multiply_add(constant_at(lines, j, g), even, total)
        other = multiply_add(constant_at(lines, j + 1, g), odd, other)
    if n % 2:
        last = lane(state, n - 1) if is_held else path.rows[b, n - 1]
        other = multiply_add(constant_at(lines, n - 1, g), last, other)
    return total + other


@part(inside=True, borrowing=True)
def find_largest(groups: Array, first: int, stop: int, columns: tuple[int, int], out: Array) -> None:
    """Fill `out` with the largest absolute value of each of some columns in some rows; nan if the last one is."""
    for g in range(*columns):
        most = abs(groups[first, g])
        for b in range(first + 1, stop):
            most = larger(most, abs(groups[b, g]))
        out[g] = most


@part(inside=True, borrowing=True)
def find_extremes(groups: Array, first: int, stop: int, columns: tuple[int, int], low: Array, high: Array) -> None:
    """Fill `low` and `high` with the extremes of each of some columns in some rows; nan if the last one is."""
    for g in range(*columns):
        least, most = groups[first, g], groups[first, g]
        for b in range(first + 1, stop):
            least, most = smaller(least, groups[b, g]), larger(most, groups[b, g])
        low[g], high[g] = least, most


@part(inside=True, borrowing=True)
def fill_sways(steps: Array, path: Path, first: int, stop: int, shape: MarchShape, out: Array) -> None:
    """Fill `out` with bounds of each guard's sway within any of some steps."""
    n, m, k, largest, groups = shape.states, shape.inputs, shape.elements, path.extremes, path.extreme_groups
    bends = n + 2 * k + shape.squares * (2 if shape.jumps else 1)  # rows of the sway's first terms
    find_largest(path.row_groups, first, stop, groups_of(path, shape, 0, n), groups[_STATES])
    find_largest(path.input_groups, first, stop, (0, path.input_groups.shape[1]), groups[_INPUTS])
    if shape.sharp:
        columns = groups_of(path, shape, bends, bends + AT_ONCE * k)
        find_largest(path.row_groups, first + 1, stop + 1, columns, groups[_BENDS])
    for e in range(k):
        sway = steps[n + m, shape.rows + e]
        for j in range(n):
            sway += steps[j, shape.rows + e] * largest[_STATES, j]
        for j in range(m):
            sway += steps[n + j, shape.rows + e] * largest[_INPUTS, j]
        for term in range(AT_ONCE if shape.sharp else 0):
            sway += largest[_BENDS, bends + term * k + e]
        out[e] = sway


@part(inside=True, borrowing=True)
def fill_sharp_sways(steps: Array, path: Path, b: int, shape: MarchShape, out: Array) -> None:
    """Fill `out` with closer bounds of each guard's sway within step b, whose first terms are values."""
    n, m, k, last = shape.states, shape.inputs, shape.elements, shape.rows + shape.elements
    for e in range(k):
        for term in range(1 + SHARP):
            at = last + term * k + e
            total = steps[n + m, at]
            for j in range(n):
                total += steps[j, at] * (abs(path.rows[b, j]) if term == 0 else path.rows[b, j])
            for j in range(m):
                total += steps[n + j, at] * (abs(path.inputs[b, j]) if term == 0 else path.inputs[b, j])
            out[e] = total if term == 0 else out[e] + abs(total)


@part(inside=True, borrowing=True)
def is_safe(limits: Array, low: Array, high: Array, sways: Array, shape: MarchShape) -> bool:
    """Whether no guard can be crossed within steps whose rows are between `low` and `high`, with these sways."""
    safe, n, k = True, shape.states, shape.elements
    for e in range(k):
        least, most = min(low[n + e], low[n + k + e]), max(high[n + e], high[n + k + e])
        if not (least - sways[e] > limits[e, 0] and most + sways[e] < limits[e, 1]):
            safe = False
    return safe


@part(inside=True, borrowing=True)
def count_safe(limits: Array, steps: Array, path: Path, count: int, shape: MarchShape) -> int:
    """Number of steps before the first one within which a guard might be crossed.

    All are safe if the extremes of the guards over all of them are; else each is judged, by the sway of the whole
    block, by its own if it is not safe by that, and by the closest bound of that in the end.
    """
    if shape.elements == 0:
        return count
    extremes, of_block, of_step = path.extremes, path.extremes[_OF_BLOCK], path.extremes[_OF_STEP]
    fill_sways(steps, path, 0, count, shape, of_block)
    guards = groups_of(path, shape, shape.states, shape.states + 2 * shape.elements)
    find_extremes(path.row_groups, 1, count + 1, guards, path.extreme_groups[_LEAST], path.extreme_groups[_MOST])
    if not is_safe(limits, extremes[_LEAST], extremes[_MOST], of_block, shape):
        for b in range(count):
            row = path.rows[b + 1]
            if not is_safe(limits, row, row, of_block, shape):
                fill_sways(steps, path, b, b + 1, shape, of_step)
                if not is_safe(limits, row, row, of_step, shape):
                    fill_sharp_sways(steps, path, b, shape, of_step)
                    if not is_safe(limits, row, row, of_step, shape):
                        return b
    return count


@part(inside=True, borrowing=True, fused=True)
def add_squares(record: History, slots: Array, path: Path, k: int, count: int, span: Span, shape: MarchShape) -> None:
    """Add the squares of the outputs at the ends of steps from knot k on; where an input jumps, those after it."""
    at_end, at_start = shape.states + 2 * shape.elements, shape.states + 2 * shape.elements + shape.squares
    for o in range(shape.squares):
        total, last = record.squares[o], record.last[o]
        for b in range(count):
            if shape.jumps and path.before[b, shape.states] != 0.0 and slots[b] >= 0 and k + b > span.settled:
                value = path.rows[b + 1, at_start + o]
                total += value * value - last
            if slots[b + 1] >= 0 and k + b >= span.settled:
                value = path.rows[b + 1, at_end + o]  # not ** 2: a call of a function where the compiler is cautious
                last = value * value
                total += last
        record.squares[o], record.last[o] = total, last


@part(inside=True, borrowing=True)
def record_states(record: History, slots: Array, path: Path, count: int, span: Span, shape: MarchShape) -> None:
    """Record the samples at the ends of steps, and the one before them if an input jumps there."""
    for b in range(0 if shape.jumps and path.before[0, shape.states] != 0.0 else 1, count + 1):
        slot = slots[b]
        if slot >= 0 and slot < record.states.shape[0]:
            if b > 0:
                record.visited[slot] = span.mode
            for i in range(shape.states):
                record.states[slot, i] = path.rows[b, i]


@part(typed=True, borrowing=True, inside=True, fused=True)
def march_steps(
    lines: MarchLines, knots: Knots, record: History, span: Span, shape: MarchShape, numbers: ConstantInts
) -> int:
    """Step while no guard can be crossed within the step; returns the first segment that needs event detection."""
    n, one = shape.states, shape.states + shape.inputs + 1
    path, columns = path_in(lines.work, shape), shape.rows + sway_columns(shape.elements)
    steps, jumps = (
        as_numbers(lines.steps, 0, (one, columns)),
        as_numbers(lines.steps, one * columns, (shape.jumps, columns)),
    )
    single = in_groups(lines.steps, 0, (one, columns))
    double = in_groups(lines.steps, (one + shape.jumps) * columns, (one + shape.inputs, columns))
    rows, groups = path.row_groups, path.row_groups.shape[1]
    own = groups_with_states(path, shape)
    for i in range(n):
        path.rows[0, i] = lines.state[i]
    k, safe, count, most = span.first, 0, 0, BLOCK if shape.elements == 0 else _FIRST
    while k < span.stop and safe == count:
        count = min(most, span.stop - k)
        most = min(2 * most, BLOCK)
        slots = knots.slot[k : k + count + 1]
        fill_inputs(knots, k, span.step, shape, numbers, path.inputs, count)
        if shape.jumps:
            for b in range(count):
                apply_jumps(jumps, knots, k + b, path, b, shape)
                for g in range(groups):
                    rows[b + 1, g] = follow(single, path, rows[b, 0], b, 1, g, shape)
        else:
            state: Any = 0.0
            for g in range(min(own, 1)):
                state = rows[0, g]
            for b in range(0, count - 1, 2):
                one, two = state, state
                for g in range(own):
                    one, two = follow(single, path, state, b, 1, g, shape), follow(double, path, state, b, 2, g, shape)
                    rows[b + 1, g], rows[b + 2, g] = one, two
                state = two
                for g in range(own, groups):
                    one, two = follow(single, path, one, b, 1, g, shape), follow(single, path, two, b + 1, 1, g, shape)
                    rows[b + 1, g], rows[b + 2, g] = one, two
            if count % 2:
                for g in range(groups):
                    rows[count, g] = follow(single, path, state, count - 1, 1, g, shape)
        safe = count_safe(lines.limits, steps, path, count, shape)
        if shape.jumps and safe < count:
            for i in range(n):
                path.rows[safe, i] = path.before[safe, i]
        if safe > 0:
            add_squares(record, slots, path, k, safe, span, shape)
            record_states(record, slots, path, safe, span, shape)
        for i in range(n):
            path.rows[0, i] = path.rows[safe, i]
        k += safe
    for i in range(n):
        lines.state[i] = path.rows[0, i]
    return k


def march_type(lines: MarchLines, knots: Knots, record: History, span: Span) -> int:
    """The type of a march, which is called through its address."""
    raise NotImplementedError


march_at: Any = FunctionAt(march_type)


@part(borrowing=True, apart=True)
def march_with_sizes(march: March, lines: MarchLines, knots: Knots, record: History, span: Span) -> int:
    """Whole steps by `march_steps` with sizes read at run time: the same numbers, but slower."""
    return march_steps(lines, knots, record, span, march.shape, march.numbers)


@part(borrowing=True, inside=True, plain=march_with_sizes)
def whole_steps(march: March, lines: MarchLines, knots: Knots, record: History, span: Span) -> int:
    """Whole steps by the `march_steps` compiled for this shape, if it is compiled.

    Its address is handed over, not the function: that would run Python code within the call, which Ctrl-C can break.
    """
    if march.address == 0:
        return march_with_sizes(march, lines, knots, record, span)
    return int(march_at(march.address)(lines, knots, record, span))


def march_of(n: int, used: tuple[int, ...], elements: int, outputs: int, jumps: int, sharp: bool) -> March:
    """The march for systems of n states, these of `flow.knot_numbers`, so many nonlinear elements and squared outputs.

    It steps while no guard can be crossed within the step, and returns the first segment that needs event detection.
    Where signals are held, the first `jumps` inputs may jump at every knot: positions follow at once. `sharp`: the
    first terms of the guards' sway are values, not sums of sizes, so that large motions cancel in them. Sizes are read
    at run time, unless `march_for` compiles it.
    """
    _, rows, _ = lines_of(n, len(used), elements, outputs, jumps, sharp)
    return March(0, MarchShape(n, len(used), elements, outputs, jumps, rows, sharp), np.array(used or (0,), np.int64))


def march_for(steps: int, march: March) -> March:
    """The march of a run of so many steps, compiled for its shape once all runs of it in this process repay that."""
    form = march.shape, tuple(march.numbers.tolist())
    _STEPS[form] += steps
    return march if _STEPS[form] < WORTH_COMPILING else _compiled_march(*form)


@cache
def _compiled_march(shape: MarchShape, used: tuple[int, ...]) -> March:
    numbers = np.array(used, np.int64)

    @kernel("march", typed=True, fused=True, borrowing=True, by_address=True)
    def march(lines: MarchLines, knots: Knots, record: History, span: Span) -> int:
        return march_steps(lines, knots, record, span, shape, numbers)

    return March(march_at.address_of(march), shape, numbers)
