"""Corrections of squared norms for a source whose density is not quite that behind its filter, and their gradients.

The same integral as in `inerter.norms.excess`, on the same kind of panels, by Gauss rules and a table of the excess.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.close_descriptor import DESCRIPTOR, close, pull_back
from inerter.kernels.decorators import kernel, part
from inerter.kernels.dense import (
    apply_resolvent,
    apply_resolvent_transposed,
    balancing_units,
    eigenvectors,
    factor_resolvent,
    in_units,
)

Array = Any
EXCESS = "Tuple((float64, float64, float64, Array(float64, 2, 'C', True)))"  # of `Excess.table`, which is read-only
_PLACES = np.array([0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363])
_WEIGHTS = np.array([0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763])
_APART = 1.75  # half-widths of a panel that its centre keeps from each pole; 2 for single values, which need a bound
_ANGLE = 4.0  # [rad] by which a delay turns the phase over half a panel at most
_NEGLIGIBLE = 1e-8  # of a mean square: what a panel may have without resolving the phases of delays
_AT_ZERO = 1e-12  # size of a pole relative to the fastest that is one at zero
_SHORTEST, _FASTEST = 1e4, 1e4  # where to end: times the inverse of the time of the excess, or the fastest pole
_NARROWEST = 1e-14  # width of a panel relative to its frequency
_POWER = 6  # of the variable in the lowest panel, in which densities have a logarithm
_MOST = 20000  # panels
_MODAL = 1e-9  # of the largest gain by which a sum over modes may be off


@part()
def excess_at(excess: Array, omega: float) -> float:
    """Relative excess of the density over that of the filter: a cubic between the knots of the table."""
    time, first, step, table = excess
    place = (np.log(omega * time) - first) / step
    if place <= 0.0:
        return float(table[0, 0] + table[1, 0] * step * place)
    i = min(int(place), table.shape[1] - 2)
    q = min(place - i, 1.0)
    p = 1.0 - q
    ends = table[0, i] * (1.0 + 2.0 * q) * p * p + table[0, i + 1] * q * q * (1.0 + 2.0 * p)
    return float(ends + step * q * p * (table[1, i] * p - table[1, i + 1] * q))


@part()
def fill_phases(omega: float, arrivals: Array, phases: Array) -> None:
    """Fill `phases` with the factors of the delays of all columns."""
    gaps, (poles, residues, direct), _ = arrivals
    phases[0] = 1.0
    for c in range(gaps.size):
        turn = np.exp(-1j * omega * gaps[c])
        if poles.size > 0 and gaps[c] > 0.0:
            turn = direct + 0j
            for k in range(poles.size):
                turn += residues[k] / (1j * omega * gaps[c] - poles[k])
        phases[c + 1] = phases[c] * turn


@part()
def modes(A: Array, scale: Array) -> Any:
    """Poles, the matrix of modes, its inverse, and whether there is one."""
    n = A.shape[0]
    poles, vectors, inverse, good = eigenvectors(in_units(A, scale))
    if good:
        for i in range(n):
            for k in range(n):
                vectors[i, k] *= scale[i]
                inverse[k, i] /= scale[i]
    return poles, vectors, inverse, good


@part()
def respond(system: Array, basis: Array, omega: float, phases: Array, state: Array, out: Array, room: Array) -> bool:
    """Fill `state` with the amplitudes of modes, or where there are none of states, and `out` with the outputs.

    False at the frequency of a pole on the imaginary axis, where compiled code raises an error by dividing.
    """
    A, _, _, D, scale = system
    poles, B, C, is_modal = basis
    M, pivots = room
    n, m = B.shape
    for i in range(n):
        state[i] = 0j
        for c in range(m):
            state[i] += B[i, c] * phases[c]
    if is_modal:
        for k in range(n):
            away = 1j * omega - poles[k]
            if away == 0.0:
                return False
            state[k] /= away
    else:
        if not factor_resolvent(A, scale, omega, M, pivots):
            return False
        apply_resolvent(M, pivots, scale, state)
    for o in range(C.shape[0]):
        out[o] = 0j
        for c in range(m):
            out[o] += D[o, c] * phases[c]
        for k in range(n):
            out[o] += C[o, k] * state[k]
    return True


@part()
def basis_of(system: Array, arrivals: Array, room: Array) -> Any:
    """Poles, B and C in modes, whether these are used, the matrix of modes and its inverse.

    Without modes, which is where a sum over them loses digits at one of the resonances, states stand for themselves.
    """
    A, B, C, _D, scale = system
    n, m, o = A.shape[0], B.shape[1], C.shape[0]
    poles, vectors, inverse, good = modes(A, scale)
    plain = poles, B.astype(np.complex128), C.astype(np.complex128), False
    if not good:
        return plain, vectors, inverse
    excited, seen = np.zeros((n, m), np.complex128), np.zeros((o, n), np.complex128)
    for k in range(n):
        for i in range(n):
            for c in range(m):
                excited[k, c] += inverse[k, i] * B[i, c]
            for r in range(o):
                seen[r, k] += C[r, i] * vectors[i, k]
    modal = poles, excited, seen, True
    phases, state = np.empty(m, np.complex128), np.empty(n, np.complex128)
    one, other = np.empty(o, np.complex128), np.empty(o, np.complex128)
    apart, largest = np.zeros(o), np.zeros(o)
    for pole in poles:
        if pole.imag >= 0.0 and abs(pole) > 0.0:
            fill_phases(abs(pole), arrivals, phases)
            if not respond(system, plain, abs(pole), phases, state, one, room):
                return plain, vectors, inverse
            if not respond(system, modal, abs(pole), phases, state, other, room):
                return plain, vectors, inverse
            for r in range(o):
                apart[r] = max(apart[r], abs(one[r] - other[r]))
                largest[r] = max(largest[r], abs(one[r]))
    for r in range(o):
        if not apart[r] <= _MODAL * largest[r]:
            return plain, vectors, inverse
    return modal, vectors, inverse


@part()
def keeps_away(poles: Array, centre: float, half: float) -> bool:
    """Whether a panel is far enough from all poles for its width."""
    near = False
    for pole in poles:
        near = near or abs(1j * centre - pole) < _APART * half
    return not near


@part()
def integrate(
    design: Array, arrivals: Array, excess: Array, ends: tuple[float, float], power: int, sums: Array
) -> bool:
    """Fill `sums` (2, outputs) with the integrals of the squared gains over a panel, and of them times the excess.

    With a `power` the panel is from zero, in a variable of which the frequency is that power.
    """
    system, basis, room, (phases, state, out) = design
    low, high = ends
    centre, half = 0.5 * (low + high), 0.5 * (high - low)
    sums[:, :] = 0.0
    for k in range(2 * _PLACES.size):
        at = _PLACES[k // 2] * (1.0 if k % 2 == 0 else -1.0)
        omega, weight = centre + half * at, half * _WEIGHTS[k // 2]
        if power > 0:
            t = 0.5 * (1.0 + at)
            omega, weight = high * t**power, 0.5 * _WEIGHTS[k // 2] * high * power * t ** (power - 1)
        fill_phases(omega, arrivals, phases)
        if not respond(system, basis, omega, phases, state, out, room):
            return False
        more = weight * excess_at(excess, omega)
        for o in range(out.size):
            square = out[o].real ** 2 + out[o].imag ** 2
            sums[0, o] += weight * square
            sums[1, o] += more * square
    return True


@part()
def add_up(design: Array, arrivals: Array, excess: Array, panels: Array, total: Array) -> int:
    """Fill `total` as `integrate` does, from zero on, and `panels` with the panels; their number, 0 if that failed.

    The first panel is the one from zero.
    """
    _, (poles, _, _, _), _, (_, _, out) = design
    fastest, slowest, late = 0.0, np.inf, 0.0
    for pole in poles:
        fastest = max(fastest, abs(pole))
    moving, size = np.empty(poles.size, np.complex128), 0
    for pole in poles:
        if abs(pole) > _AT_ZERO * fastest:
            slowest = min(slowest, abs(pole))
            moving[size] = pole
            size += 1
    moving = moving[:size]
    for gap in arrivals[0]:
        late += gap
    high = min(_SHORTEST / excess[0], _FASTEST * fastest)
    low = 0.25 * min(slowest, high, 1.0 / max(late, 1e-300))
    if not (low > 0.0 and high < np.inf):
        return 0
    sums, waiting = np.empty((2, out.size)), np.empty((2000, 2))
    panels[0, 0], panels[0, 1], count = 0.0, low, 1
    if not integrate(design, arrivals, excess, (0.0, low), _POWER, total):
        return 0
    octaves = int(np.ceil(np.log2(high / low)))
    for octave in range(octaves):
        waiting[0, 0], waiting[0, 1], open_ = low * 2.0**octave, low * 2.0 ** (octave + 1), 1
        while open_ > 0:
            open_ -= 1
            a, b = waiting[open_]
            centre, half = 0.5 * (a + b), 0.5 * (b - a)
            near = half > _NARROWEST * centre and not keeps_away(moving, centre, half)
            if not near:
                if not integrate(design, arrivals, excess, (a, b), 0, sums):
                    return 0
                if half * late > _ANGLE:
                    for o in range(out.size):
                        near = near or abs(sums[1, o]) > _NEGLIGIBLE * (total[0, o] + sums[0, o])
            if near:
                if open_ + 2 > waiting.shape[0]:
                    return 0
                waiting[open_, 0], waiting[open_, 1] = centre, b
                waiting[open_ + 1, 0], waiting[open_ + 1, 1] = a, centre
                open_ += 2
                continue
            if count == panels.shape[0]:
                return 0
            panels[count, 0], panels[count, 1] = a, b
            count += 1
            for k in range(2):
                for o in range(out.size):
                    total[k, o] += sums[k, o]
    return count


@part()
def slopes_in(
    design: Array, arrivals: Array, excess: Array, panels: Array, weights: Array, G_A: Array, G_B: Array, G_C: Array,
    G_D: Array,
) -> None:  # fmt: skip
    """Fill the gradients over the matrices, in modes where these are used, of the weighted corrections."""
    (A, _, _, _, scale), basis, (M, pivots), (phases, state, out) = design
    poles, _, C, is_modal = basis
    n, left = A.shape[0], np.empty(A.shape[0], np.complex128)
    for index in range(panels.shape[0]):
        low, high = panels[index]
        for k in range(2 * _PLACES.size):
            at = _PLACES[k // 2] * (1.0 if k % 2 == 0 else -1.0)
            omega, weight = 0.5 * (low + high) + 0.5 * (high - low) * at, 0.5 * (high - low) * _WEIGHTS[k // 2]
            if index == 0:
                t = 0.5 * (1.0 + at)
                omega, weight = high * t**_POWER, 0.5 * _WEIGHTS[k // 2] * high * _POWER * t ** (_POWER - 1)
            fill_phases(omega, arrivals, phases)
            respond(design[0], basis, omega, phases, state, out, design[2])
            more = 2.0 * weight * excess_at(excess, omega) / np.pi
            for i in range(n):
                left[i] = 0j
            for o in range(out.size):
                g = more * weights[o] * np.conj(out[o])
                for i in range(n):
                    left[i] += g * C[o, i]
                    G_C[o, i] += g * state[i]
                for c in range(phases.size):
                    G_D[o, c] += (g * phases[c]).real
            if is_modal:
                for i in range(n):
                    left[i] /= 1j * omega - poles[i]
            else:
                apply_resolvent_transposed(M, pivots, scale, left)
            for i in range(n):
                for j in range(n):
                    G_A[i, j] += left[i] * state[j]
                for c in range(phases.size):
                    G_B[i, c] += left[i] * phases[c]


@part()
def in_states(G: Array, left: Array, right: Array) -> Array:
    """The real part of left' G right', where a matrix without rows stands for one."""
    n, m = G.shape
    result = np.zeros((n, m))
    if left.shape[0] > 0:
        other = np.zeros((n, m), np.complex128)
        for i in range(n):
            for k in range(n):
                for j in range(m):
                    other[i, j] += left[k, i] * G[k, j]
        G = other
    for i in range(n):
        for j in range(m):
            if right.shape[0] == 0:
                result[i, j] = G[i, j].real
            else:
                for k in range(m):
                    result[i, j] += (G[i, k] * right[j, k]).real
    return result


@kernel(
    "corrections of r.m.s. norms",
    f"(float64[:,::1], {DESCRIPTOR}, Tuple((float64[::1], Tuple((complex128[::1], complex128[::1], float64)), "
    f"Tuple((int64[::1], float64[:,::1])))), {EXCESS}, float64[::1])",
)
def corrections(points: Array, descriptor: Array, arrivals: Array, excess: Array, weights: Array) -> Any:
    """Corrections of the squared norms (designs, outputs) at each row of `points`, and gradients over it.

    The gradients (designs, values) are those of the sum of the corrections with `weights`; none without weights. What
    cannot be had is nan.
    """
    outputs = descriptor[7].shape[1]
    result = np.full((points.shape[0], outputs), np.nan)
    gradients = np.full((points.shape[0] if weights.size > 0 else 0, points.shape[1]), np.nan)
    panels, total = np.empty((_MOST, 2)), np.empty((2, outputs))
    for row in range(points.shape[0]):
        A, B, C, D, T, factors, good = close(points[row], descriptor)
        if not good:
            continue
        n, m = B.shape
        room = np.empty((n, n), np.complex128), np.empty(n, np.int64)
        rows = np.empty(m, np.complex128), np.empty(n, np.complex128), np.empty(outputs, np.complex128)
        system = A, B, C, D, balancing_units(A)
        basis, vectors, inverse = basis_of(system, arrivals, room)
        design = system, basis, room, rows
        count = add_up(design, arrivals, excess, panels, total)
        if count == 0:
            continue
        for o in range(outputs):
            result[row, o] = total[1, o] / np.pi
        if weights.size > 0:
            G_A, G_B = np.zeros((n, n), np.complex128), np.zeros((n, m), np.complex128)
            G_C, G_D = np.zeros((outputs, n), np.complex128), np.zeros((outputs, m))
            slopes_in(design, arrivals, excess, panels[:count], weights, G_A, G_B, G_C, G_D)
            none = np.zeros((0, 0), np.complex128)
            left, right = (inverse, vectors) if basis[3] else (none, none)
            gradient = pull_back(
                points[row], descriptor, T, factors,
                in_states(G_A, left, right), in_states(G_B, left, none), in_states(G_C, none, right), G_D,
            )  # fmt: skip
            for j in range(gradient.size):
                gradients[row, j] = gradient[j]
    return result, gradients
