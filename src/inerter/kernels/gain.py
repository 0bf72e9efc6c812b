"""Gains of single-input single-output systems, their gradients and their peaks, compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.close_descriptor import DESCRIPTOR, close, close_extended, extended_space, pull_back
from inerter.kernels.decorators import kernel, part
from inerter.kernels.double_double import add_product
from inerter.kernels.h2 import units
from inerter.kernels.linalg import factor, merge, solve, solve_rows, solve_transposed, sort

Array = Any
_GOLDEN = 0.6180339887498949
_ACCURATE = 1e-9  # relative error of a gain up to which it is believed
_SMALL = 1e-7  # relative size of the terms of a correction at first order up to which the rest is far below that
_KNOWN = 1e-5  # error of a pole over its distance from the axis up to which a peak is known to the square of that
_EPS = 2.2e-16


@part()
def resolve(A: Array, scale: Array, omega: float, M: Array, pivots: Array) -> bool:
    """M becomes the factors of j omega - A, with the states in units of `scale`."""
    n = A.shape[0]
    for i in range(n):
        for j in range(n):
            M[i, j] = -A[i, j] * scale[j] / scale[i]
        M[i, i] += 1j * omega
    return factor(M, pivots)


@part()
def gain_at(system: Array, lost: Array, scale: Array, omega: float) -> float:
    """|G(j omega)|, infinite at a pole, and nan where it may be off by more than `_ACCURATE`.

    What the state leaves of its equation, with A and B as they were before rounding, corrects it at first order; that
    is believed while it is small.
    """
    A, B, C, D = system
    lost_A, lost_B, lost_C, lost_D = lost
    n = A.shape[0]
    M, pivots = np.empty((n, n), np.complex128), np.empty(n, np.int64)
    r, left = np.empty(n, np.complex128), np.empty(n, np.complex128)
    for i in range(n):
        r[i], left[i] = B[i, 0] / scale[i], C[0, i] * scale[i]
    if not resolve(A, scale, omega, M, pivots):
        return np.inf
    solve(M, pivots, r)
    solve_transposed(M, pivots, left)
    for i in range(n):
        r[i] *= scale[i]
        left[i] /= scale[i]
    G, size, unsure = D[0, 0] + lost_D[0, 0] + 0j, 0.0, 0.0
    for i in range(n):
        real, fine = add_product(B[i, 0], lost_B[i, 0], omega, r[i].imag)
        imag, fine_imag = add_product(0.0, 0.0, -omega, r[i].real)
        for j in range(n):
            if A[i, j] != 0.0:
                real, fine = add_product(real, fine, A[i, j], r[j].real)
                imag, fine_imag = add_product(imag, fine_imag, A[i, j], r[j].imag)
            fine += lost_A[i, j] * r[j].real
            fine_imag += lost_A[i, j] * r[j].imag
        change = left[i] * ((real + fine) + 1j * (imag + fine_imag)) + lost_C[0, i] * r[i]
        G += C[0, i] * r[i] + change
        size += abs(change)
        unsure += n * _EPS * abs(C[0, i] * r[i])
    gain = abs(G)
    return gain if size <= _SMALL * gain and unsure <= _ACCURATE * gain else np.nan


@kernel("gradients of a gain", f"(float64[::1], {DESCRIPTOR}, float64[::1])")
def gains(p: Array, descriptor: Array, omegas: Array) -> Any:
    """|G(j omega)| and its gradient over the values p (frequencies, values) at each of `omegas`."""
    A, B, C, D, T, factors, good = close(p, descriptor)
    n, count = A.shape[0], omegas.size
    values, gradients = np.full(count, np.nan), np.full((count, p.size), np.nan)
    if not good:
        return values, gradients
    M, pivots = np.empty((n, n), np.complex128), np.empty(n, np.int64)
    r, left = np.empty(n, np.complex128), np.empty(n, np.complex128)
    G_A, G_B, G_C, G_D = np.empty((n, n)), np.empty((n, 1)), np.empty((1, n)), np.empty((1, 1))
    scale = units(A)
    for k in range(count):
        for i in range(n):
            r[i], left[i] = B[i, 0] / scale[i], C[0, i] * scale[i]
        if not resolve(A, scale, omegas[k], M, pivots):
            values[k] = np.inf
            continue
        solve(M, pivots, r)
        solve_transposed(M, pivots, left)
        G = D[0, 0] + 0j
        for i in range(n):
            r[i] *= scale[i]
            left[i] /= scale[i]
            G += C[0, i] * r[i]
        values[k] = abs(G)
        h = np.conj(G) / values[k] if values[k] > 0.0 else 0j
        for i in range(n):
            for j in range(n):
                G_A[i, j] = (h * left[i] * r[j]).real
            G_B[i, 0], G_C[0, i] = (h * left[i]).real, (h * r[i]).real
        G_D[0, 0] = h.real
        gradient = pull_back(p, descriptor, T, factors, G_A, G_B, G_C, G_D)
        for i in range(p.size):
            gradients[k, i] = gradient[i]
    return values, gradients


@part()
def partial_fractions(system: Array, lost_A: Array, scale: Array) -> Any:
    """Poles and residues of C (s - A)^-1 B, and whether all poles are known beyond their distance from the axis."""
    A, B, C, _ = system
    n = A.shape[0]
    scaled, largest = np.empty((n, n), np.complex128), 0.0
    for i in range(n):
        for j in range(n):
            scaled[i, j] = A[i, j] * scale[j] / scale[i]
            largest += abs(scaled[i, j])
    if not largest < np.inf:
        return np.zeros(0, np.complex128), np.zeros(0, np.complex128), False
    poles, vectors = np.linalg.eig(scaled)
    LU, pivots, inverse = vectors.copy(), np.empty(n, np.int64), np.empty((n, n), np.complex128)
    residues = np.zeros(n, np.complex128)
    if not factor(LU, pivots):
        return poles, residues, False
    for i in range(n):
        for j in range(n):
            inverse[i, j] = 1.0 if i == j else 0.0
    solve_rows(LU, pivots, inverse)
    for k in range(n):
        seen, excited, error = 0j, 0j, 0.0
        for i in range(n):
            seen += C[0, i] * scale[i] * vectors[i, k]
            excited += inverse[k, i] * (B[i, 0] / scale[i])
            rest = -poles[k] * vectors[i, k]
            for j in range(n):
                rest += (scaled[i, j] + lost_A[i, j] * scale[j] / scale[i]) * vectors[j, k]
            error += abs(inverse[k, i] * rest)
        residues[k] = seen * excited
        if not error < _KNOWN * abs(poles[k].real):
            return poles, residues, False
    return poles, residues, True


@part()
def modal_gain(poles: Array, residues: Array, direct: float, omega: float) -> float:
    """|G(j omega)| from partial fractions."""
    G = direct + 0j
    for i in range(poles.size):
        G += residues[i] / (1j * omega - poles[i])
    return abs(G)


@part()
def largest_pole(poles: Array) -> float:
    """The largest distance of a pole from zero; infinite where one is not finite."""
    size = 0.0
    for pole in poles:
        here = abs(pole)
        if not here < np.inf:
            return np.inf
        size = max(size, here)
    return size


@part()
def frequencies(poles: Array) -> Array:
    """Zero, a logarithmic grid over all time scales, and points on and around every resonance, in order."""
    n, fastest = poles.size, largest_pole(poles)
    slowest = np.inf
    for pole in poles:
        slowest = min(slowest, max(abs(pole), 1e-300))
    slowest = max(slowest, 1e-30 * fastest)
    near, count = np.empty(14 * n), 0
    for pole in poles:
        if pole.imag >= 0.0:
            for offset in (-8.0, -4.0, -2.0, -1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0, 2.0, 4.0, 8.0):
                omega = pole.imag + offset * abs(pole.real)
                if omega > 0.0:
                    near[count] = omega
                    count += 1
            near[count] = abs(pole)
            count += 1
    near = near[:count]
    sort(near)
    low, high = 0.01 * slowest, 10.0 * fastest  # a static maximum may rise to a peak close to zero first
    steps = 1 + int(24.0 * np.log10(high / low))
    grid = np.empty(steps + 1)
    grid[0] = 0.0
    for k in range(steps):
        grid[1 + k] = low * (high / low) ** (k / (steps - 1))
    return merge(grid, near)


@part()
def top(poles: Array, residues: Array, direct: float, low: float, high: float) -> float:
    """Frequency of the largest gain between `low` and `high`, by golden section."""
    width = 1e-5 * (high - low) + 1e-14 * high  # the grid is as fine as a resonance is wide
    a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    ga, gb = modal_gain(poles, residues, direct, a), modal_gain(poles, residues, direct, b)
    while high - low > width:
        if ga > gb:
            high, b, gb = b, a, ga
            a = high - _GOLDEN * (high - low)
            ga = modal_gain(poles, residues, direct, a)
        else:
            low, a, ga = a, b, gb
            b = low + _GOLDEN * (high - low)
            gb = modal_gain(poles, residues, direct, b)
    return 0.5 * (low + high)


@part()
def peaks(system: Array, lost: Array) -> Any:
    """Frequencies and values of the local maxima of the gain, found in partial fractions, valued by a direct solve.

    Partial fractions cost little at each frequency; where they lose digits (nearly equal poles) only the place of a
    peak suffers, because the value at it is computed anew. The value is nan where that is not accurate or the two
    differ; no peak is found where a resonance is narrower than the error of its pole.
    """
    A, _, _, D = system
    scale, direct = units(A), D[0, 0]
    poles, residues, good = partial_fractions(system, lost[0], scale)
    if not good or not largest_pole(poles) < np.inf:
        return np.zeros(0), np.zeros(0)
    grid = frequencies(poles)
    values = np.empty(grid.size)
    count = 0
    for omega in grid:  # points of equal gain count once, or the top of a peak between two of them would be lost
        value = modal_gain(poles, residues, direct, omega)
        if count == 0 or abs(value - values[count - 1]) > 1e-11 * value:
            grid[count], values[count] = omega, value
            count += 1
    omegas, found = np.empty(count), np.empty(count)
    number = 0
    for k in range(count if count == 1 else count - 1):
        above_last = k == 0 or values[k] > values[k - 1]
        above_next = count == 1 or values[k] > values[k + 1]
        if above_last and above_next:
            omegas[number] = 0.0 if k == 0 else top(poles, residues, direct, grid[k - 1], grid[k + 1])
            found[number] = gain_at(system, lost, scale, omegas[number])
            if not abs(found[number] - modal_gain(poles, residues, direct, omegas[number])) <= 1e-6 * found[number]:
                found[number] = np.nan
            number += 1
    return omegas[:number], found[:number]


@kernel("peaks of a gain", f"(float64[:,::1], {DESCRIPTOR}, UniTuple(float64[:,::1], 2))")
def peaks_of(points: Array, descriptor: Array, extended: Array) -> Any:
    """`peaks` at each row of `points`: frequencies and values (designs, order + 2), those of each design in a row.

    The last place is that of an infinite frequency; places without a peak have the frequency nan and the value 0.
    Everything of a design that has no peaks is nan.
    """
    places = descriptor[1].shape[2] + 2
    omegas, values = np.full((points.shape[0], places), np.nan), np.full((points.shape[0], places), np.nan)
    room = extended_space(descriptor)
    A, B, C, D, _, _, _, _ = room[0]
    for i in range(points.shape[0]):
        if not close_extended(room, points[i], descriptor, extended):
            continue
        where, found = peaks((A, B, C, D), room[1])
        if found.size == 0 or found.size >= places:  # there are never more than order + 1
            continue
        for k in range(places):
            values[i, k] = 0.0
        for k in range(found.size):
            omegas[i, k], values[i, k] = where[k], found[k]
        omegas[i, -1], values[i, -1] = np.inf, abs(D[0, 0])
    return omegas, values
