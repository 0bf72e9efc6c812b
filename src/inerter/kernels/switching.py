"""Mode switching where a guard is crossed or an input breaks: modes are tried until one is consistent."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.arrays import FRICTION, Array, Floats, Matrix, Run
from inerter.kernels.crossing import MET, ORDERS, ROUNDING
from inerter.kernels.decorators import part
from inerter.kernels.flow import input_sizes, inputs_from, over_columns
from inerter.kernels.locking import can_be_in, limit_of

DONE, PAUSED, MODE_UNKNOWN, EVENTS_FULL, CHATTER, IMPACT, NO_MODE, NOT_FINITE, STIFF = range(9)
ACCEPTED, STRUCK, STRANDED = -1, -2, -3  # verdicts on a mode; another one is the element that must change its state
VELOCITY, SPRINGS, LOOSE = range(3)  # groups of conditions on entry
_EPS = 2.2e-16  # the last digit of a number, relative to it
_LARGEST_ZERO = 1e-7  # relative to the largest state so far


@part(borrowing=True, inside=True)
def switch(run: Run, events: Array, start: float, length: float, who: int) -> int:
    """Find and enter the mode that continues the motion, after the guard of element `who` (or nothing, -1) was met.

    Some mode can in exact arithmetic, so if none is found, rounding has taken the place of a zero somewhere: then what
    counts as zero grows until one is, and derivatives of higher order decide where values did.
    """
    place = run.motion.place[0]
    if place.events + run.mechanics.sizes.elements > events.shape[0]:
        return EVENTS_FULL
    if place.mode >= 0:
        _project_state(run, length)
    place.zero, code = ROUNDING, NO_MODE
    while code in (NO_MODE, IMPACT) and place.zero < 2.0 * _LARGEST_ZERO:
        code = _search_modes(run, length, who)
        place.zero *= 10.0
    if code == DONE:
        _enter_mode(run, events, start, _number_on_trial(run))
    return code


@part(borrowing=True, inside=True)
def _search_modes(run: Run, length: float, who: int) -> int:
    """Try modes until one is consistent, and leave it on trial; DONE, or the reason why there is none.

    Starts from the present mode and lets one element after the other change its state, the first that violates its
    guard first (Murty's least-index rule, finite for friction and contact without impacts); if that does not settle,
    all states are tried.
    """
    place, watch, elements = run.motion.place[0], run.motion.watch, run.mechanics.sizes.elements
    _first_trial(run, who)
    tries, code, struck = 20 + 8 * elements, 0, False
    while code < 3 ** min(elements, 6):
        if tries == 0:
            code += 1
            if not _nth_trial(run, code - 1):
                continue
        m = _number_on_trial(run)
        if m < 0:
            return _request_mode(run)
        verdict = check_contact_state(run, m, length, who)
        if verdict == ACCEPTED:
            return DONE
        struck = struck or verdict == STRUCK
        if tries > 0:
            tries = tries - 1 if verdict >= 0 else 0
            if verdict >= 0:
                watch[verdict].trial = place.wanted
    return IMPACT if struck else NO_MODE


@part(borrowing=True, inside=True)
def _first_trial(run: Run, who: int) -> None:
    """Put the present states on trial, with that of the crossed guard changed; before the first mode, all at rest."""
    before, watch = run.motion.place[0].mode, run.motion.watch
    for e in range(run.mechanics.sizes.elements):
        first = 0 if can_be_in(run.mechanics.limits, e, 0) else 1
        watch[e].trial = run.modes.state[before, e] if before >= 0 else first
    if who >= 0 and watch[who].crossed != 0:
        watch[who].trial = watch[who].crossed if watch[who].trial == 0 else 0


@part(borrowing=True, inside=True)
def _nth_trial(run: Run, code: int) -> bool:
    """Put the states on trial that have this number; False if an element cannot have its state."""
    possible = True
    for e in range(run.mechanics.sizes.elements):
        watch = run.motion.watch[e]
        watch.trial = code % 3 - 1
        code //= 3
        possible = possible and can_be_in(run.mechanics.limits, e, watch.trial)
    return possible


@part(borrowing=True, inside=True)
def _number_on_trial(run: Run) -> int:
    """Number of the mode on trial, or -1."""
    code = 0
    for e in range(run.mechanics.sizes.elements):
        code = 3 * code + run.motion.watch[e].trial + 1
    return int(run.modes.number[code])


@part(borrowing=True, inside=True)
def _request_mode(run: Run) -> int:
    """Return MODE_UNKNOWN, so that the mode is built; results about modes on trial are discarded."""
    for e in range(run.mechanics.sizes.elements):
        run.motion.watch[e].touch = 0
    return MODE_UNKNOWN


@part(borrowing=True, inside=True)
def _enter_mode(run: Run, events: Array, start: float, m: int) -> None:
    """Enter mode m, and record the changes of contact state as events."""
    motion, place, before = run.motion, run.motion.place[0], run.motion.place[0].mode
    for i in range(run.mechanics.sizes.states):
        motion.state[i] = run.room.guess[i]
    for e in range(run.mechanics.sizes.elements):
        trial = motion.watch[e].trial
        if before >= 0 and trial != run.modes.state[before, e]:
            event = events[place.events]
            event.time, event.element = start + place.clock, e
            event.before, event.after = run.modes.state[before, e], trial
            place.events += 1
    place.mode = m


@part(borrowing=True, inside=True)
def _project_state(run: Run, length: float) -> None:
    """Project the state onto the conditions of its mode, which removes the drift by rounding.

    A velocity of 1e-13 m/s that a long stick has left behind would otherwise choose the direction of the slip.
    """
    sizes, motion, room, first = run.mechanics.sizes, run.motion, run.room, run.mechanics.rows.projected_state
    m, n, nu = motion.place[0].mode, sizes.states, sizes.inputs
    inputs_from(room.numbers, sizes.roads, nu, length, motion.place[0].clock, length, room.inputs)
    for i in range(n):
        room.guess[i] = over_columns(run.modes.maps[m, first + i], motion.state, room.inputs[0], n, nu)
    for i in range(n):
        motion.state[i] = room.guess[i]
        motion.scale[i] = max(motion.scale[i], abs(motion.state[i]))
    if _is_at_rest(run):
        for i in range(sizes.inertial):
            motion.state[i] = 0.0


@part(borrowing=True, inside=True)
def _is_at_rest(run: Run) -> bool:
    """Whether no velocity would change a position by its last digit while its mode moves: the rounding of a load."""
    sizes, motion, farthest = run.mechanics.sizes, run.motion, 0.0
    for i in range(sizes.inertial, sizes.states):
        farthest = max(farthest, motion.scale[i])
    fastest = 0.0
    for i in range(sizes.inertial):
        fastest = max(fastest, abs(motion.state[i]))
    return bool(fastest * run.modes.reach[motion.place[0].mode] <= _EPS * farthest)


@part(borrowing=True, inside=True)
def check_contact_state(run: Run, m: int, length: float, who: int) -> int:
    """Verdict on mode m in the present state: ACCEPTED, STRUCK, STRANDED, or the element whose state must change.

    First the conditions on entry, then each guard by the sign of its first derivative that is not zero.
    """
    sizes, room, clock = run.mechanics.sizes, run.room, run.motion.place[0].clock
    run.motion.place[0].left -= 1
    d = min(run.modes.reach[m], length)
    inputs_from(room.numbers, sizes.roads, sizes.inputs, length, clock, d, room.inputs)
    input_sizes(room.numbers, sizes.roads, sizes.inputs, length, clock, d, room.input_sizes)
    distance = _reset_guess(run)
    for e in range(sizes.elements):
        if _is_apart(run, e, distance):
            run.motion.place[0].wanted = 0
            return e
    first: Any = np.int64(0)
    for group in range(3):
        last = first + run.modes.conditions[m, group]
        if last > first:
            if _is_broken(run, m, first, last):
                verdict = _verdict_on_conditions(run, m, first, last, group)
                if verdict != ACCEPTED:
                    return verdict
            for j in range(sizes.states):
                room.guess[j] += _condition_impulse(run.modes.reaction[m], j, room.residual, first, last)
        first = last
    return _check_guards(run, m, d, who)


@part(borrowing=True, inside=True)
def _reset_guess(run: Run) -> float:
    """Set the guess and its accuracy from the present state; returns the size of positions.

    What has not moved yet is no finer than what has.
    """
    sizes, motion, room = run.mechanics.sizes, run.motion, run.room
    speed, length_scale = 0.0, 0.0
    for i in range(sizes.states):
        room.guess[i] = motion.state[i]
        if i < sizes.inertial:
            speed = max(speed, motion.scale[i])
        else:
            length_scale = max(length_scale, motion.scale[i])
    for i in range(sizes.states):
        room.sizes[0, i] = speed if i < sizes.inertial else length_scale
    return length_scale


@part(borrowing=True, inside=True)
def _is_apart(run: Run, e: int, length_scale: float) -> bool:
    """Whether a gap that is to touch is not at its limit; if it is, its elongation becomes the limit."""
    mechanics, sizes, trial = run.mechanics, run.mechanics.sizes, run.motion.watch[e].trial
    if mechanics.kind[e] == FRICTION or trial == 0 or not can_be_in(mechanics.limits, e, 0):
        return False
    limit, own = limit_of(mechanics.limits, e, trial), mechanics.own_position[e]
    beyond, size = -limit, abs(limit)
    for j in range(mechanics.lengths.shape[1]):
        at = j + sizes.inertial
        inside = at < sizes.states
        term = mechanics.lengths[e, j] * (run.motion.state[at] if inside else run.room.inputs[0, at - sizes.states])
        beyond += term
        size += abs(term)
    if abs(beyond) > MET * size + ROUNDING * length_scale:
        return True
    if own >= 0:
        run.room.guess[sizes.inertial + own] = limit
    return False


@part(borrowing=True, inside=True)
def _is_broken(run: Run, m: int, first: int, last: int) -> bool:
    """Whether conditions on entry do not hold; how far they are from that goes to `room.residual`."""
    n, nu, room = run.mechanics.sizes.states, run.mechanics.sizes.inputs, run.room
    broken, u = False, room.inputs[0]
    for i in range(first, last):
        row = run.modes.maps[m, run.mechanics.rows.entry + i]
        room.residual[i] = over_columns(row, room.guess, u, n, nu)
        size = _size(row, room.sizes[0], u, n, nu) + abs(row[n + nu])
        broken = broken or abs(room.residual[i]) > max(1e-10, run.motion.place[0].zero) * size
    return broken


@part(borrowing=True, inside=True)
def _verdict_on_conditions(run: Run, m: int, first: int, last: int, group: int) -> int:
    """Element whose limits the impulses of unfulfilled conditions exceed, or a verdict if there is none."""
    mechanics, place, n = run.mechanics, run.motion.place[0], run.mechanics.sizes.states
    reaction, residual, largest = run.modes.reaction[m], run.room.residual, 0.0
    for e in range(mechanics.sizes.elements):
        largest = max(largest, abs(_condition_impulse(reaction, n + e, residual, first, last)))
    for e in range(mechanics.sizes.elements):
        trial = run.motion.watch[e].trial
        s = _condition_impulse(reaction, n + e, residual, first, last)
        if not can_be_in(mechanics.limits, e, 0) or abs(s) <= 1e-9 * largest:
            continue
        if trial == 0 and group == VELOCITY and mechanics.kind[e] == FRICTION:
            place.wanted = 1 if s > 0.0 else -1
            if can_be_in(mechanics.limits, e, place.wanted):
                return e
        if trial * s < 0.0:
            place.wanted = 0
            return e
    if group == SPRINGS:
        return ACCEPTED
    return STRUCK if group == VELOCITY else STRANDED


@part(typed=True, borrowing=True)
def _condition_impulse(reaction: Matrix, row: int, residual: Floats, first: int, last: int) -> float:
    """Jump of a state, or impulse on an element, by the residuals of conditions on entry."""
    total = 0.0
    for i in range(first, last):
        total += reaction[row, i] * residual[i]
    return total


@part(typed=True, borrowing=True)
def _size(row: Floats, size: Floats, u: Floats, n: int, nu: int) -> float:
    """Sum of the sizes of what a row adds up: its rounding is a small multiple of this."""
    total = 0.0
    for j in range(n):
        total += abs(row[j]) * size[j]
    for j in range(nu):
        total += abs(row[n + j] * u[j])
    return total


@part(borrowing=True, inside=True)
def _check_guards(run: Run, m: int, d: float, who: int) -> int:
    """First element whose guard leaves its limits, or ACCEPTED."""
    mechanics, place, before = run.mechanics, run.motion.place[0], run.motion.place[0].mode
    place.known = -1
    for e in range(mechanics.sizes.elements):
        trial = run.motion.watch[e].trial
        was = run.modes.state[max(before, 0), e]  # slip up and slip down have the same guard
        slips = mechanics.kind[e] == FRICTION and trial * was != 0
        side = _guard_violation(run, m, e, d, before >= 0 and e == who and (trial == was or slips))
        if side != 0:
            place.wanted = side if trial == 0 else 0
            return e
    return ACCEPTED


@part(borrowing=True, inside=True)
def _guard_violation(run: Run, m: int, e: int, d: float, met: bool) -> int:
    """Limit (-1, 1) that the guard of element e violates at once, else 0; records the orders of contact with a limit.

    `met`: the guard has just been found to be at a limit.
    """
    place, watch, limits = run.motion.place[0], run.motion.watch[e], run.modes.entry_limits[m, e]
    row, n, nu = run.modes.maps[m, run.mechanics.rows.guard + e], run.mechanics.sizes.states, run.mechanics.sizes.inputs
    room = run.room
    watch.touch = 0
    for at in range(2):
        side, limit = 2 * at - 1, limits[at]
        if abs(limit) == np.inf:
            continue
        for order in range(ORDERS):
            if order > place.known:
                _coefficient(run, m, order, d)
                place.known = order
            size, total = 0.0, 0.0
            for j in range(n):
                total += row[j] * room.series[order, j]
                size += abs(row[j]) * room.sizes[order, j]
            for j in range(nu):
                total += row[n + j] * room.inputs[order, j]
                size += abs(row[n + j]) * room.input_sizes[order, j]
            if order == 0:
                total += row[n + nu] - limit
                size += abs(limit)
            if abs(total) <= max(MET if order == 0 and met else 0.0, place.zero) * size:
                watch.touch, watch.side = order + 1, side
            elif side * total > 0.0:
                return side
            else:
                break
    return 0


@part(borrowing=True, inside=True)
def _coefficient(run: Run, m: int, k: int, d: float) -> None:
    """The k-th coefficient of the flow from the guess, and the sizes of what it was added up from."""
    maps, room, n, nu = run.modes.maps[m], run.room, run.mechanics.sizes.states, run.mechanics.sizes.inputs
    for i in range(n):
        if k == 0:
            room.series[0, i] = room.guess[i]
            continue
        row = maps[i]
        total = row[n + nu] if k == 1 else 0.0
        size = abs(total)
        for j in range(n):
            total += row[j] * room.series[k - 1, j]
            size += abs(row[j]) * room.sizes[k - 1, j]
        for j in range(nu):
            total += row[n + j] * room.inputs[k - 1, j]
            size += abs(row[n + j]) * room.input_sizes[k - 1, j]
        room.series[k, i] = total * d / k
        room.sizes[k, i] = size * d / k
