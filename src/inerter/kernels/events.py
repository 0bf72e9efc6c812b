"""Event-driven integration: whole steps while no guard can be crossed, and a piecewise series where one might be."""

from __future__ import annotations

from typing import Any

from inerter.kernels.arrays import (
    BEFORE,
    BROKEN,
    NONE,
    SMOOTH,
    Account,
    Floats,
    History,
    Ints,
    Knots,
    March,
    MarchLines,
    Matrix,
    Run,
    Span,
)
from inerter.kernels.crossing import advance_to, first_crossing
from inerter.kernels.decorators import kernel, part
from inerter.kernels.energy import take_account
from inerter.kernels.flow import inputs_from, knot_numbers, over_columns, series
from inerter.kernels.integrate import whole_steps
from inerter.kernels.switching import CHATTER, DONE, NOT_FINITE, PAUSED, STIFF, switch

PIECES = 1e4  # of a segment: with more, a run would take hours
_PAUSES = 200  # switches without any time between them
_SWITCHES = 20000  # switches within one segment


@kernel("motion from event to event", typed=True, borrowing=True)
def integrate(run: Run, knots: Knots, record: History, account: Account, march: March, h: float, stop: int) -> int:
    """Integrate up to knot `stop`, in whole steps of length h where there may be.

    Returns DONE, or why it stopped before: after PAUSED (no pieces are left), MODE_UNKNOWN (the states are on trial in
    `watch`) and EVENTS_FULL it continues from the same place once there are more, the mode is built, or there is room.
    """
    place, numbers = run.motion.place[0], run.room.numbers
    refused: Any = NONE
    while place.segment < stop:
        k = place.segment
        while knots.special[place.special] < k:
            place.special += 1
        length = h
        if knots.special[place.special] == k:
            length = _length_of(knots, k, h)
        if place.mode < 0:  # what jumps at the first knot jumps in a mode
            before, slope_before = knots.value_before, knots.slope_before
            knot_numbers(before, slope_before, before, slope_before, k, length, numbers)
        else:
            knot_numbers(knots.value, knots.slope, knots.value_before, knots.slope_before, k, length, numbers)
            if (
                k != refused
                and not account.wanted
                and place.clock == 0.0
                and place.jumped == BEFORE
                and place.ended == 0
            ):
                m = place.mode
                lines = MarchLines(run.modes.steps[m], run.modes.limits[m], run.motion.state, run.room.line)
                span = Span(h, m, k, min(stop, knots.special[place.special]), place.settled)
                refused = whole_steps(march, lines, knots, record, span)
                place.segment = refused
                if place.segment > k:
                    continue
            if place.jumped == BEFORE:
                place.jumped = BROKEN if _apply_jump(run, knots, account) else SMOOTH
        code = _integrate_segment(run, knots, record, account, length)
        if code != DONE:
            return code
    return DONE


@part(borrowing=True, inside=True)
def _length_of(knots: Knots, k: int, h: float) -> float:
    """Length of a special segment: the step h, if it is special for another reason."""
    length = knots.time[k + 1] - knots.time[k]
    return h if abs(length - h) < 1e-9 * h else float(length)


@part(borrowing=True, inside=True)
def _integrate_segment(run: Run, knots: Knots, record: History, account: Account, length: float) -> int:
    """Integrate to the end of one segment piece by piece, with every event in between; or find the first mode.

    Modes are switched in one place, since the code for it is long: in the first mode, where inputs jump or turn at the
    knot, and at events.
    """
    place, sizes, room, modes = run.motion.place[0], run.mechanics.sizes, run.room, run.modes
    k, pauses, who = place.segment, 0, NONE
    switches = place.mode < 0 or place.jumped == BROKEN
    while switches or place.clock < length:
        if switches:
            is_first = place.mode < 0
            code = switch(run, record.events, knots.time[k], length, who)
            if code != DONE:
                return code
            if is_first:
                _record_sample(run, record, knots.slot[k])
                return DONE
            _record_switch(run, knots, record, length)
        m, t = place.mode, place.clock
        if length > PIECES * modes.reach[m]:
            return STIFF
        if place.left <= 0:
            return PAUSED
        place.left -= 1
        d = min(length - t, modes.reach[m])
        inputs_from(room.numbers, sizes.roads, sizes.inputs, length, t, d, room.inputs)
        count = series(modes.steps[m], run.motion.state, room.inputs, sizes.states, sizes.inputs, d, room.series)
        s, who = first_crossing(run, count, d, d == length - t)
        if account.wanted and s > 0.0:
            take_account(run, account, count, s, d)
        if not advance_to(run, count, s):
            return NOT_FINITE
        place.clock = length if who < 0 and d == length - t else t + s * d
        pauses = 0 if place.clock > t else pauses + 1
        switches = who >= 0
        if switches:
            place.switches += 1
            if pauses > _PAUSES or place.switches > _SWITCHES:
                return CHATTER
    _finish_segment(run, knots, record, length)
    return DONE


@part(borrowing=True, inside=True)
def _record_switch(run: Run, knots: Knots, record: History, length: float) -> None:
    """Record what a switch at the knot changes: the mode of the sample there, and the values after a break."""
    place = run.motion.place[0]
    slot = knots.slot[place.segment]
    if place.jumped == BROKEN:
        place.jumped = SMOOTH
        _record_break(run, knots, record, length)
    elif place.clock == 0.0 and slot >= 0 and slot < record.visited.shape[0]:
        record.visited[slot] = place.mode


@part(borrowing=True, inside=True)
def _finish_segment(run: Run, knots: Knots, record: History, length: float) -> None:
    """Advance to the next segment, and record the sample and the squares at the knot."""
    place, sizes, rows, room = run.motion.place[0], run.mechanics.sizes, run.mechanics.rows, run.room
    k, m = place.segment, place.mode
    slot = knots.slot[k + 1]
    place.clock, place.jumped, place.switches, place.segment = 0.0, BEFORE, 0, k + 1
    _record_sample(run, record, slot)
    if slot >= 0 and k >= place.settled and sizes.squares > 0:
        inputs_from(room.numbers, sizes.roads, sizes.inputs, length, length, length, room.inputs)
        for o in range(sizes.squares):
            row, state = run.modes.maps[m, rows.output + o], run.motion.state
            record.last[o] = over_columns(row, state, room.inputs[0], sizes.states, sizes.inputs) ** 2
            record.squares[o] += record.last[o]


@part(borrowing=True, inside=True)
def _record_sample(run: Run, record: History, slot: int) -> None:
    if slot >= 0 and slot < record.states.shape[0]:
        record.visited[slot] = run.motion.place[0].mode
        for i in range(run.mechanics.sizes.states):
            record.states[slot, i] = run.motion.state[i]


@part(borrowing=True, inside=True)
def _apply_jump(run: Run, knots: Knots, account: Account) -> bool:
    """Apply the jump of a held road to the positions, with the work of the mean force; True if an input breaks."""
    sizes, k, u = run.mechanics.sizes, run.motion.place[0].segment, run.room.inputs[0]
    nr, maps = sizes.roads, run.modes.maps[run.motion.place[0].mode]
    leaps, kinks = 0.0, 0.0
    for c in range(knots.value.shape[1]):
        leaps += abs(knots.value[k, c] - knots.value_before[k, c])
        kinks += abs(knots.slope[k, c] - knots.slope_before[k, c])
    if leaps == 0.0:
        return kinks > 0.0
    for i in range(nr):
        u[i], u[nr + i], u[2 * nr + i] = knots.value_before[k, i], knots.slope_before[k, i], 0.0
    for i in range(3 * nr, sizes.inputs):
        u[i] = knots.value_before[k, i - 2 * nr]
    first = run.mechanics.rows.output + sizes.squares + account.branch_road.shape[0]
    for c in range(nr):
        rise = knots.value[k, c] - knots.value_before[k, c]
        for half in range(2):
            for b in range(account.branch_road.shape[0]):
                share = account.branch_road[b, c]
                if share != 0.0:
                    force = over_columns(maps[first + b], run.motion.state, u, sizes.states, sizes.inputs)
                    run.motion.energy[c] += 0.5 * force * share * rise
            if half == 0:
                u[c] = knots.value[k, c]
                for i in range(sizes.states):
                    run.motion.state[i] += maps[i, sizes.states + nr + c] * rise
    return True


@part(borrowing=True, inside=True)
def _record_break(run: Run, knots: Knots, record: History, length: float) -> None:
    """Replace the sample where an input breaks, and the squares where it jumps, by those after the knot."""
    sizes, place, u, leaps = run.mechanics.sizes, run.motion.place[0], run.room.inputs, 0.0
    k, maps = place.segment, run.modes.maps[place.mode]
    _record_sample(run, record, knots.slot[k])
    for c in range(knots.value.shape[1]):
        leaps += abs(knots.value[k, c] - knots.value_before[k, c])
    if leaps == 0.0 or knots.slot[k] < 0 or k <= place.settled:
        return
    inputs_from(run.room.numbers, sizes.roads, sizes.inputs, length, 0.0, length, u)
    for o in range(sizes.squares):
        row = maps[run.mechanics.rows.output + o]
        square = over_columns(row, run.motion.state, u[0], sizes.states, sizes.inputs) ** 2
        record.squares[o] += square - record.last[o]


@kernel("outputs of a motion", typed=True, borrowing=True)
def evaluate(rows: Matrix, visited: Ints, states: Matrix, inputs: Matrix, out: Floats) -> None:
    """An output at all samples: each mode's row over the state, the inputs and 1."""
    n, nu = states.shape[1], inputs.shape[1]
    for i in range(out.shape[0]):
        row = rows[visited[i]]
        total = row[n + nu]
        for j in range(n):
            total += row[j] * states[i, j]
        for j in range(nu):
            total += row[n + j] * inputs[i, j]
        out[i] = total
