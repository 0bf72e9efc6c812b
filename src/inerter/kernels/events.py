"""Event-driven integration: whole steps while no guard can be crossed, and a piecewise series where one might be."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.arrays import ENTRY, FRICTION, GUARD, KIND, NA, NR, OUTPUT, OUTPUTS, OWN_POSITION, SEEN, K, N
from inerter.kernels.declare import kernel, part
from inerter.kernels.flow import first_root, input_sizes, inputs_from, knot_numbers, series, slope_at, value_at
from inerter.kernels.march import march_at

Array = Any
DONE, PAUSED, MODE_UNKNOWN, EVENTS_FULL, CHATTER, IMPACT, NO_MODE, NOT_FINITE, STIFF = range(9)
ACCEPTED, STRUCK, STRANDED = -1, -2, -3
SEGMENT, MODE, EVENTS, SPECIAL, JUMPED, SWITCHES = range(6)  # places in `place`
WANTED, SETTLED, ACCOUNT, INPUTS, KNOWN, LEFT, ENDED = range(6, 13)
TRIAL, TOUCH, SIDE, CROSSED = range(4)  # rows of `flags`
ORDERS = 6  # derivatives that are looked at to see on which side of its limit a guard goes
STATE, SCALE, GUESS, CLOCK, NUMBERS, LINE, ENERGY = range(7)  # rows of `work`, then those of these sizes
RESIDUAL, POLYNOMIAL, U, SIZE, INPUT_SIZE, X = 7, 8, 11, 19, 19 + ORDERS, 19 + 2 * ORDERS
ROWS = X + 32
_ROUNDING = 1e-13  # relative to the largest state so far
_MET = 1e-9  # the same where a guard has just been met
PIECES = 1e4  # of a segment: with more, a run would take hours
_PAUSES = 200  # switches without any time between them
_SWITCHES = 20000  # switches within one segment


class Work(NamedTuple):
    """Where an integration is, and what it works with; it can be taken up again at any point."""

    work: Array  # (ROWS, enough): state, its largest size so far, a state on trial, the clock within a segment, ...
    flags: Array  # (4, k) states on trial; leading zero coefficients of each guard just now; its limit; see `_crossing`
    place: Array  # see SEGMENT, ...
    sizes: Array  # as in `Mechanics`, and so the next three
    elements: Array
    limit: Array
    lengths: Array
    number: Array  # as in `Modes`, and so the next four
    state: Array
    maps: Array
    reaction: Array
    limits: Array
    reach: Array


class Record(NamedTuple):
    """What goes in and what comes out along time."""

    time: Array  # (segments + 1,) knots
    value: Array  # (segments + 1, channels) of roads, then of forces
    slope: Array
    value_before: Array  # the same from the left
    slope_before: Array
    special: Array  # segments of another length than the step, then one past the end
    slot: Array  # (segments + 1,) number of the sample at each knot, or -1
    states: Array  # (samples or 0, n)
    visited: Array  # (samples or 0,) mode at each sample
    sums: Array  # (2, outputs) of squares, and the last squares that were added
    events: Array  # (events, 4): time, element, from, to
    branch_road: Array  # (branches or 0, roads)
    gauss: Array  # (2, points) nodes and weights on [0, 1]


@part("float64(float64[::1], float64[::1], float64[::1], int64, int64)", borrowing=True)
def over_columns(row: Array, x: Array, u: Array, n: int, nu: int) -> float:
    """A row over a mode's columns times (state, inputs, 1)."""
    total = row[n + nu]
    for j in range(n):
        total += row[j] * x[j]
    for j in range(nu):
        total += row[n + j] * u[j]
    return float(total)


@part("int64(int64[::1], int64[::1])", borrowing=True)
def mode_number(number: Array, trial: Array) -> int:
    """Number of the mode in which the elements are in these states, or -1."""
    code = 0
    for e in range(trial.shape[0]):
        code = 3 * code + trial[e] + 1
    return int(number[code])


def _signature(types: Any) -> Any:
    """The type of `integrate`."""
    ints, int_table = types.int64[::1], types.int64[:, ::1]
    floats, table, tables = types.float64[::1], types.float64[:, ::1], types.float64[:, :, ::1]
    mechanics, modes = (ints, int_table, floats, table), (ints, int_table, tables, tables, tables, floats)
    history = (ints, ints, table, ints, table, table)
    return types.int64(
        types.int64,
        tables,
        types.NamedTuple((table, int_table, ints, *mechanics, *modes), Work),
        types.NamedTuple((floats, table, table, table, table, *history, table, table), Record),
        types.float64,
        types.int64,
    )


@kernel("motion from event to event", _signature, borrowing=True)
def integrate(address: int, steps: Array, now: Work, record: Record, h: float, stop: int) -> int:
    """Integrate up to knot `stop`, whole steps by the march at an address.

    Returns DONE, or why it stopped before: after PAUSED (no pieces are LEFT), MODE_UNKNOWN (the states are in `flags`)
    and EVENTS_FULL it goes on from the same place once there are more, the mode is built, or there is room.
    """
    place, work, sizes, march = now.place, now.work, now.sizes, march_at(address)
    n, nr, nu = sizes[N], sizes[NR], place[INPUTS]
    nobody: Any = np.int64(-1)  # a plain -1 would be a type of its own, and compile what takes it twice
    while place[SEGMENT] < stop:
        k = place[SEGMENT]
        length = record.time[k + 1] - record.time[k]
        if abs(length - h) < 1e-9 * h:
            length = h
        value, slope, value_before, slope_before = record.value, record.slope, record.value_before, record.slope_before
        if place[MODE] < 0:  # what jumps here jumps in a mode
            knot_numbers(value_before, slope_before, value_before, slope_before, k, length, work[NUMBERS])
            code = switch(now, record.events, record.time[k], length, nobody)
            if code != DONE:
                return code
            _sample(record.states, record.visited, record.slot[k], place[MODE], work, n)
        knot_numbers(value, slope, value_before, slope_before, k, length, work[NUMBERS])
        while record.special[place[SPECIAL]] < k:
            place[SPECIAL] += 1
        m = place[MODE]
        if place[ACCOUNT] == 0 and work[CLOCK, 0] == 0.0 and place[JUMPED] == 0 and place[ENDED] == 0:
            place[SEGMENT] = march(
                steps[m],
                now.limits[m],
                work[STATE],
                work[LINE],
                value,
                slope,
                value_before,
                slope_before,
                record.slot,
                record.states,
                record.visited,
                record.sums,
                h,
                m,
                k,
                min(stop, record.special[place[SPECIAL]]),
                place[SETTLED],
            )
            if place[SEGMENT] > k:
                continue
        if place[JUMPED] == 0:
            place[JUMPED] = 2 if _jump(now.maps[m], sizes, work, record, place, k, nu) else 1
        if place[JUMPED] == 2:  # the sample here is taken anew, in the mode that goes on from here
            code = switch(now, record.events, record.time[k], length, nobody)
            if code != DONE:
                return code
            place[JUMPED] = 1
            _renew(now.maps[place[MODE]], sizes, work, record, place, k, nu, length)
        begun = record.visited[max(record.slot[k], 0) : record.slot[k] + 1]
        code = cross(now, record.events, begun, record.branch_road, record.gauss, record.time[k], length)
        if code != DONE:
            return code
        # close the segment
        m, slot = place[MODE], record.slot[k + 1]
        work[CLOCK, 0] = 0.0
        place[JUMPED], place[SWITCHES], place[SEGMENT] = 0, 0, k + 1
        _sample(record.states, record.visited, slot, m, work, n)
        if slot >= 0 and k >= place[SETTLED] and sizes[OUTPUTS] > 0:
            inputs_from(work[NUMBERS], nr, nu, length, length, length, work[U : U + 8])
            for o in range(sizes[OUTPUTS]):
                record.sums[1, o] = over_columns(now.maps[m, sizes[OUTPUT] + o], work[STATE], work[U], n, nu) ** 2
                record.sums[0, o] += record.sums[1, o]
    return DONE


@part("void(float64[:,::1], int64[::1], int64, int64, float64[:,::1], int64)", borrowing=True)
def _sample(states: Array, visited: Array, slot: int, mode: int, work: Array, n: int) -> None:
    if slot >= 0 and slot < states.shape[0]:
        visited[slot] = mode
        for i in range(n):
            states[slot, i] = work[STATE, i]


@kernel(
    "outputs of a motion",
    "void(float64[:,::1], int64[::1], float64[:,::1], float64[:,::1], float64[::1])",
    borrowing=True,
)
def evaluate(rows: Array, visited: Array, states: Array, inputs: Array, out: Array) -> None:
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


@part(borrowing=True)
def cross(now: Work, events: Array, begun: Array, branch_road: Array, gauss: Array, start: float, length: float) -> int:
    """Go to the end of one segment piece by piece, and through every event on the way.

    `begun`: the mode at the sample at its start, if there is one; what changes at once there changes the sample's mode.
    """
    place, work, sizes = now.place, now.work, now.sizes
    n, nr, nu, elements, guard = sizes[N], sizes[NR], place[INPUTS], sizes[K], sizes[GUARD]
    coefficients, state = work[U : U + 8], work[X:]
    pauses = 0
    while work[CLOCK, 0] < length:
        m, t = place[MODE], work[CLOCK, 0]
        if length > PIECES * now.reach[m]:
            return STIFF
        if place[LEFT] <= 0:
            return PAUSED
        place[LEFT] -= 1
        d = min(length - t, now.reach[m])
        inputs_from(work[NUMBERS], nr, nu, length, t, d, coefficients)
        count = series(now.maps[m], work[STATE], coefficients, n, nu, d, state)
        best = 2.0
        who: Any = np.int64(-1)
        ends, ended = d == length - t, place[ENDED] != 0
        place[ENDED] = 0
        for e in range(elements):
            if now.flags[TOUCH, e] < ORDERS:
                row = now.maps[m, guard + e]
                slips = now.elements[e, KIND] == FRICTION and now.state[m, e] != 0 and now.limit[e] > 0.0
                if slips and ended and _lies_still(row, work, n, nu, min(count, ORDERS), now.reach[m] / d):
                    now.flags[CROSSED, e] = now.state[m, e]
                    best, who = 0.0, e
                    break
                s = _crossing(row, now.limits[m, e], now.flags, e, n, nu, count, work, ends)
                if slips and ends and _comes_to_zero(work[POLYNOMIAL], count):
                    place[ENDED] = 1
                if s < best:
                    best, who = s, e
        s = min(best, 1.0)
        if place[ACCOUNT] > 0 and s > 0.0:
            _account(now.maps[m], sizes, work, branch_road, gauss, nu, count, s, d)
        for i in range(n):
            total = _polynomial(state, count, i, s)
            if not (abs(total) < 1e150):
                return NOT_FINITE
            work[STATE, i] = total
            work[SCALE, i] = max(work[SCALE, i], abs(total))
        if s > 0.0:
            for e in range(elements):
                now.flags[TOUCH, e] = 0
        work[CLOCK, 0] = length if who < 0 and d == length - t else t + s * d
        pauses = 0 if work[CLOCK, 0] > t else pauses + 1
        if who >= 0:
            place[SWITCHES] += 1
            if pauses > _PAUSES or place[SWITCHES] > _SWITCHES:
                return CHATTER
            code = switch(now, events, start, length, who)
            if code != DONE:
                return code
            if work[CLOCK, 0] == 0.0:
                begun[:] = place[MODE]
    return DONE


@part("float64(float64[:,::1], int64, int64, float64)", borrowing=True)
def _polynomial(state: Array, count: int, i: int, s: float) -> float:
    total = state[count - 1, i]
    for j in range(count - 2, -1, -1):
        total = total * s + state[j, i]
    return float(total)


@part(
    "float64(float64[::1], float64[::1], int64[:,::1], int64, int64, int64, int64, float64[:,::1], boolean)",
    borrowing=True,
)
def _crossing(
    row: Array, limits: Array, flags: Array, e: int, n: int, nu: int, count: int, work: Array, ends: bool
) -> float:
    """First time, in units of the piece, at which the guard of element e is crossed; 2 if it is not.

    CROSSED is then the limit, if it is crossed with a slope beyond all rounding, else 0. A limit that is just reached
    where the segment `ends` is left to the next one: inputs may turn there.
    """
    if limits[0] == -np.inf and limits[1] == np.inf:
        return 2.0
    c, g = work[POLYNOMIAL], work[POLYNOMIAL + 1]
    swing = 0.0
    for k in range(count):
        total = 0.0
        for j in range(n):
            total += row[j] * work[X + k, j]
        if k < 4:
            for j in range(nu):
                total += row[n + j] * work[U + k, j]
        c[k] = total
        swing += abs(total)
    swing -= abs(c[0])
    c[0] += row[n + nu]
    best = 2.0
    for at in range(2):
        side, limit = 2 * at - 1, limits[at]
        zeros = flags[TOUCH, e] if flags[SIDE, e] == side else 0
        if abs(limit) == np.inf or (zeros == 0 and side * (limit - c[0]) > swing):
            continue
        for k in range(zeros, count):
            g[k - zeros] = -side * c[k]
        if zeros == 0:
            g[0] += side * limit
        root = first_root(g, count - zeros, work[POLYNOMIAL + 2])
        if ends and root > 1.0 - _MET:
            size = swing + abs(c[0]) + abs(limit)
            root = 2.0 if value_at(g, count - zeros, 1.0) > -_ROUNDING * size else root
        if root < best:
            best = root
            flags[CROSSED, e] = side if slope_at(g, count - zeros, root) < -1e-6 * swing else 0
    return best


@part("boolean(float64[::1], int64)", borrowing=True)
def _comes_to_zero(c: Array, count: int) -> bool:
    """Whether a polynomial is zero at 1, and not before."""
    total, size = 0.0, 0.0
    for k in range(count):
        total += c[k]
        size += abs(c[k])
    return abs(total) <= _ROUNDING * size and abs(c[0]) > _MET * size


@part("boolean(float64[::1], float64[:,::1], int64, int64, int64, float64)", borrowing=True)
def _lies_still(row: Array, work: Array, n: int, nu: int, count: int, longer: float) -> bool:
    """Whether a slip that has come to zero has ended for good: its velocity and the rates of it are rounding.

    What the piece would add up to if it were so many times `longer` counts: in a short one a slip that begins is slow.
    """
    value, size, scale = row[n + nu], abs(row[n + nu]), 1.0
    change = 0.0
    for k in range(count):
        total = 0.0
        for j in range(n):
            total += row[j] * work[X + k, j]
            size += abs(row[j] * work[X, j]) if k == 0 else 0.0
        if k < 4:
            for j in range(nu):
                total += row[n + j] * work[U + k, j]
                size += abs(row[n + j] * work[U, j]) if k == 0 else 0.0
        if k == 0:
            value += total
        else:
            scale *= longer
            change += abs(total) * scale
    return bool(abs(value) + change <= _ROUNDING * size)


@part("int64(int64[:,::1])", borrowing=True)
def _unknown(flags: Array) -> int:
    """Leave to have a mode built; what has been found out about modes on trial must not stay."""
    for e in range(flags.shape[1]):
        flags[TOUCH, e] = 0
    return MODE_UNKNOWN


@part(borrowing=True)
def switch(now: Work, events: Array, start: float, length: float, who: int) -> int:
    """Find the mode that goes on from here, after the guard of element `who` (or nothing, -1) was met.

    Starts from the present mode and lets one element after the other change its state, the first that violates its
    guard first (Murty's least-index rule, finite for friction and contact without impacts); if that does not settle,
    all states are tried.
    """
    place, work, trial = now.place, now.work, now.flags[TRIAL]
    elements, before = now.sizes[K], now.place[MODE]
    if place[EVENTS] + elements > events.shape[0]:
        return EVENTS_FULL
    if before >= 0:
        _as_seen(now, before, length)
    for e in range(elements):
        trial[e] = now.state[before, e] if before >= 0 else (0 if now.limit[e] > 0.0 else 1)
    if who >= 0 and now.flags[CROSSED, who] != 0:
        trial[who] = now.flags[CROSSED, who] if trial[who] == 0 else 0
    verdict, struck, m = 0, False, -1
    for _ in range(20 + 8 * elements):
        m = mode_number(now.number, trial)
        if m < 0:
            return _unknown(now.flags)
        verdict = judge(now, m, length, who)
        if verdict < 0:
            break
        trial[verdict] = place[WANTED]
    codes = 1
    for _ in range(min(elements, 6)):
        codes *= 3
    code = 0
    while verdict != ACCEPTED and code < codes:
        struck = struck or verdict == STRUCK
        rest, possible = code, True
        code += 1
        for e in range(elements):
            trial[e] = rest % 3 - 1
            rest //= 3
            possible = possible and (now.limit[e] > 0.0 or trial[e] == 1)
        if possible:
            m = mode_number(now.number, trial)
            if m < 0:
                return _unknown(now.flags)
            verdict = judge(now, m, length, who)
    if verdict != ACCEPTED:
        return IMPACT if struck else NO_MODE
    # go over to mode m, and note what has changed
    for i in range(now.sizes[N]):
        work[STATE, i] = work[GUESS, i]
    for e in range(elements):
        if before >= 0 and trial[e] != now.state[before, e]:
            i = place[EVENTS]
            events[i, 0] = start + work[CLOCK, 0]
            events[i, 1], events[i, 2], events[i, 3] = e, now.state[before, e], trial[e]
            place[EVENTS] = i + 1
    place[MODE] = m
    return DONE


@part(borrowing=True)
def _as_seen(now: Work, m: int, length: float) -> None:
    """Make the state what mode m has seen of it: without the rounding that drifted off the mode's conditions.

    A velocity of 1e-13 m/s that a long stick has left behind would otherwise choose the direction of the slip.
    """
    sizes, work, n, nu = now.sizes, now.work, now.sizes[N], now.place[INPUTS]
    inputs_from(work[NUMBERS], sizes[NR], nu, length, work[CLOCK, 0], length, work[U : U + 8])
    for i in range(n):
        work[GUESS, i] = over_columns(now.maps[m, sizes[SEEN] + i], work[STATE], work[U], n, nu)
    for i in range(n):
        work[STATE, i] = work[GUESS, i]
        work[SCALE, i] = max(work[SCALE, i], abs(work[STATE, i]))


@part(borrowing=True)
def judge(now: Work, m: int, length: float, who: int) -> int:
    """Whether mode m can go on from here: ACCEPTED, STRUCK, STRANDED, or the element whose state must change.

    First the conditions on entry, then each guard by the sign of its first derivative that is not zero.
    """
    sizes, maps, reaction, work, trial = now.sizes, now.maps[m], now.reaction[m], now.work, now.flags[TRIAL]
    now.place[LEFT] -= 1
    n, nu, elements, d = sizes[N], now.place[INPUTS], sizes[K], min(now.reach[m], length)
    coefficients, residual = work[U : U + 8], work[RESIDUAL]
    inputs_from(work[NUMBERS], sizes[NR], nu, length, work[CLOCK, 0], d, coefficients)
    input_sizes(work[NUMBERS], sizes[NR], nu, length, work[CLOCK, 0], d, work[INPUT_SIZE : INPUT_SIZE + ORDERS])
    speed, length_scale = 0.0, 0.0  # what has not moved yet is no finer than what has
    for i in range(n):
        work[GUESS, i] = work[STATE, i]
        if i < sizes[NA]:
            speed = max(speed, work[SCALE, i])
        else:
            length_scale = max(length_scale, work[SCALE, i])
    for i in range(n):
        work[SIZE, i] = speed if i < sizes[NA] else length_scale
    for e in range(elements):  # only a gap that is at its limit can touch
        if now.elements[e, KIND] != FRICTION and trial[e] != 0 and now.limit[e] > 0.0:
            beyond, size = -trial[e] * now.limit[e], now.limit[e]
            for j in range(now.lengths.shape[1]):
                at = j + sizes[NA]
                term = now.lengths[e, j] * (work[STATE, at] if at < n else work[U, at - n])
                beyond += term
                size += abs(term)
            if abs(beyond) > _MET * size + _ROUNDING * length_scale:
                now.place[WANTED] = 0
                return e
            if now.elements[e, OWN_POSITION] >= 0:
                work[GUESS, sizes[NA] + now.elements[e, OWN_POSITION]] = trial[e] * now.limit[e]
    first = 0
    for group in range(3):
        last = first + now.state[m, elements + group]
        broken = False
        for i in range(first, last):
            row = maps[sizes[ENTRY] + i]
            residual[i] = over_columns(row, work[GUESS], work[U], n, nu)
            broken = broken or abs(residual[i]) > 1e-10 * (_size(row, work[SIZE], work[U], n, nu) + abs(row[n + nu]))
        if broken:
            largest = 0.0
            for e in range(elements):
                largest = max(largest, abs(_asked(reaction, n + e, residual, first, last)))
            for e in range(elements):
                s = _asked(reaction, n + e, residual, first, last)
                if now.limit[e] == 0.0 or abs(s) <= 1e-9 * largest:
                    continue
                if trial[e] == 0 and group == 0 and now.elements[e, KIND] == FRICTION:
                    now.place[WANTED] = 1 if s > 0.0 else -1
                    return e
                if trial[e] * s < 0.0:
                    now.place[WANTED] = 0
                    return e
            if group != 1:
                return STRUCK if group == 0 else STRANDED
        for j in range(n):
            work[GUESS, j] += _asked(reaction, j, residual, first, last)
        first = last
    now.place[KNOWN] = -1
    before = now.place[MODE]
    for e in range(elements):
        was = now.state[max(before, 0), e]  # slip up and slip down have the same guard
        slips = now.elements[e, KIND] == FRICTION and trial[e] * was != 0
        met = before >= 0 and e == who and (trial[e] == was or slips)
        row, limits = maps[sizes[GUARD] + e], now.limits[m, elements + e]
        side = _violated(maps, row, limits, now.flags, now.place, work, e, n, nu, d, met)
        if side != 0:
            now.place[WANTED] = side if trial[e] == 0 else 0
            return e
    return ACCEPTED


@part("float64(float64[:,::1], int64, float64[::1], int64, int64)", borrowing=True)
def _asked(reaction: Array, row: int, residual: Array, first: int, last: int) -> float:
    total = 0.0
    for i in range(first, last):
        total += reaction[row, i] * residual[i]
    return total


@part("float64(float64[::1], float64[::1], float64[::1], int64, int64)", borrowing=True)
def _size(row: Array, size: Array, u: Array, n: int, nu: int) -> float:
    """Sum of the sizes of what a row adds up: its rounding is a small multiple of this."""
    total = 0.0
    for j in range(n):
        total += abs(row[j]) * size[j]
    for j in range(nu):
        total += abs(row[n + j] * u[j])
    return total


@part("void(float64[:,::1], float64[:,::1], int64, int64, int64, float64)", borrowing=True)
def _coefficient(maps: Array, work: Array, k: int, n: int, nu: int, d: float) -> None:
    """The k-th coefficient of the flow from GUESS, and the sizes of what it was added up from."""
    for i in range(n):
        if k == 0:
            work[X, i] = work[GUESS, i]
            continue
        row = maps[i]
        total = row[n + nu] if k == 1 else 0.0
        size = abs(total)
        for j in range(n):
            total += row[j] * work[X + k - 1, j]
            size += abs(row[j]) * work[SIZE + k - 1, j]
        for j in range(nu):
            total += row[n + j] * work[U + k - 1, j]
            size += abs(row[n + j]) * work[INPUT_SIZE + k - 1, j]
        work[X + k, i] = total * d / k
        work[SIZE + k, i] = size * d / k


@part(
    "int64(float64[:,::1], float64[::1], float64[::1], int64[:,::1], int64[::1], float64[:,::1], "
    "int64, int64, int64, float64, boolean)",
    borrowing=True,
)
def _violated(
    maps: Array,
    row: Array,
    limits: Array,
    flags: Array,
    place: Array,
    work: Array,
    e: int,
    n: int,
    nu: int,
    d: float,
    met: bool,
) -> int:
    """At which limit (-1, 1) the guard of element e is violated at once, else 0; notes how long it stays on a limit.

    `met`: the guard has just been found to be at a limit.
    """
    flags[TOUCH, e] = 0
    for at in range(2):
        side, limit = 2 * at - 1, limits[at]
        if abs(limit) == np.inf:
            continue
        for order in range(ORDERS):
            if order > place[KNOWN]:
                _coefficient(maps, work, order, n, nu, d)
                place[KNOWN] = order
            size, total, at_x, at_u = 0.0, 0.0, X + order, U + order
            for j in range(n):
                total += row[j] * work[at_x, j]
                size += abs(row[j]) * work[SIZE + order, j]
            for j in range(nu):
                total += row[n + j] * work[at_u, j]
                size += abs(row[n + j]) * work[INPUT_SIZE + order, j]
            if order == 0:
                total += row[n + nu] - limit
                size += abs(limit)
            if abs(total) <= (_MET if order == 0 and met else _ROUNDING) * size:
                flags[TOUCH, e], flags[SIDE, e] = order + 1, side
            elif side * total > 0.0:
                return side
            else:
                break
    return 0


@part(borrowing=True)
def _jump(maps: Array, sizes: Array, work: Array, record: Record, place: Array, k: int, nu: int) -> bool:
    """Where a held road moves at once, positions follow and the mean force does the work. Whether an input breaks."""
    n, nr, branches = sizes[N], sizes[NR], record.branch_road.shape[0]
    first, u = sizes[OUTPUT] + sizes[OUTPUTS] + branches, work[U]
    leaps, kinks = 0.0, 0.0
    for c in range(record.value.shape[1]):
        leaps += abs(record.value[k, c] - record.value_before[k, c])
        kinks += abs(record.slope[k, c] - record.slope_before[k, c])
    if leaps == 0.0:
        return kinks > 0.0
    for i in range(nr):
        u[i], u[nr + i], u[2 * nr + i] = record.value_before[k, i], record.slope_before[k, i], 0.0
    for i in range(3 * nr, nu):
        u[i] = record.value_before[k, i - 2 * nr]
    for c in range(nr):
        rise = record.value[k, c] - record.value_before[k, c]
        for half in range(2):
            for b in range(branches):
                if record.branch_road[b, c] != 0.0:
                    force = over_columns(maps[first + b], work[STATE], u, n, nu)
                    work[ENERGY, c] += 0.5 * force * record.branch_road[b, c] * rise
            if half == 0:
                u[c] = record.value[k, c]
                for i in range(n):
                    work[STATE, i] += maps[i, n + nr + c] * rise
    return True


@part(borrowing=True)
def _renew(
    maps: Array, sizes: Array, work: Array, record: Record, place: Array, k: int, nu: int, length: float
) -> None:
    """The sample where an input breaks, and the squares where it jumps, are those from the right."""
    n, leaps = sizes[N], 0.0
    _sample(record.states, record.visited, record.slot[k], place[MODE], work, n)
    for c in range(record.value.shape[1]):
        leaps += abs(record.value[k, c] - record.value_before[k, c])
    if leaps == 0.0 or record.slot[k] < 0 or k <= place[SETTLED]:
        return
    inputs_from(work[NUMBERS], sizes[NR], nu, length, 0.0, length, work[U : U + 8])
    for o in range(sizes[OUTPUTS]):
        square = over_columns(maps[sizes[OUTPUT] + o], work[STATE], work[U], n, nu) ** 2
        record.sums[0, o] += square - record.sums[1, o]


@part(borrowing=True)
def _account(
    maps: Array, sizes: Array, work: Array, branch_road: Array, gauss: Array, nu: int, count: int, s: float, d: float
) -> None:
    """Energy through roads, forces and branches during the first part s of a piece, by Gauss's rule."""
    n, nr, branches, first = sizes[N], sizes[NR], branch_road.shape[0], sizes[OUTPUT] + sizes[OUTPUTS]
    nf, x, u, energy = nu - 3 * nr, work[GUESS], work[U + 7], work[ENERGY]
    for g in range(gauss.shape[1]):
        at = s * gauss[0, g]
        weight = s * d * gauss[1, g]
        for i in range(n):
            x[i] = _polynomial(work[X:], count, i, at)
        for j in range(nu):
            u[j] = _polynomial(work[U : U + 8], 4, j, at)
        for b in range(branches):
            force = over_columns(maps[first + branches + b], x, u, n, nu)
            energy[nr + nf + b] += weight * force * over_columns(maps[first + b], x, u, n, nu)
            for c in range(nr):
                energy[c] += weight * force * branch_road[b, c] * u[nr + c]
        for f in range(nf):
            energy[nr + f] += weight * u[3 * nr + f] * over_columns(maps[first + 2 * branches + f], x, u, n, nu)
