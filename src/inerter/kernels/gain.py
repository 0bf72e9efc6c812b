"""Gains of single-input single-output systems, their gradients and their peaks, compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.close_descriptor import DESCRIPTOR, close, close_extended, extended_space, pull_back
from inerter.kernels.decorators import kernel, part
from inerter.kernels.dense import (
    apply_resolvent,
    apply_resolvent_transposed,
    balancing_units,
    eigenvectors,
    factor_resolvent,
    in_units,
)
from inerter.kernels.double_double import add_product

Array = Any
_GOLDEN = 0.6180339887498949
_ACCURATE = 1e-9  # relative error of a gain up to which it counts as known
_SMALL = 1e-7  # relative size of the terms of a correction at first order up to which higher orders are far below that
_KNOWN = 1e-5  # error of a pole over its distance from the axis up to which a peak is known to the square of that
_EPS = 2.2e-16


@part()
def gain_at(system: Array, remainders: Array, scale: Array, omega: float) -> float:
    """|G(j omega)|, infinite at a pole, and nan where it may be off by more than `_ACCURATE`.

    The residual of the equation of the state, with A + remainder_A and B + remainder_B, those before rounding, corrects
    it at first order; the gain counts as known while that is small.
    """
    A, B, C, D = system
    remainder_A, remainder_B, remainder_C, remainder_D = remainders
    n = A.shape[0]
    M, pivots = np.empty((n, n), np.complex128), np.empty(n, np.int64)
    r, left = np.empty(n, np.complex128), np.empty(n, np.complex128)
    for i in range(n):
        r[i], left[i] = B[i, 0], C[0, i]
    if not factor_resolvent(A, scale, omega, M, pivots):
        return np.inf
    apply_resolvent(M, pivots, scale, r)
    apply_resolvent_transposed(M, pivots, scale, left)
    G, size, unsure = D[0, 0] + remainder_D[0, 0] + 0j, 0.0, 0.0
    for i in range(n):
        real, fine = add_product(B[i, 0], remainder_B[i, 0], omega, r[i].imag)
        imag, fine_imag = add_product(0.0, 0.0, -omega, r[i].real)
        for j in range(n):
            if A[i, j] != 0.0:
                real, fine = add_product(real, fine, A[i, j], r[j].real)
                imag, fine_imag = add_product(imag, fine_imag, A[i, j], r[j].imag)
            fine += remainder_A[i, j] * r[j].real
            fine_imag += remainder_A[i, j] * r[j].imag
        change = left[i] * ((real + fine) + 1j * (imag + fine_imag)) + remainder_C[0, i] * r[i]
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
    scale = balancing_units(A)
    for k in range(count):
        for i in range(n):
            r[i], left[i] = B[i, 0], C[0, i]
        if not factor_resolvent(A, scale, omegas[k], M, pivots):
            values[k] = np.inf
            continue
        apply_resolvent(M, pivots, scale, r)
        apply_resolvent_transposed(M, pivots, scale, left)
        G = D[0, 0] + 0j
        for i in range(n):
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
def partial_fractions(system: Array, remainder_A: Array, scale: Array) -> Any:
    """Poles and residues of C (s - A)^-1 B, and whether all poles are known beyond their distance from the axis."""
    A, B, C, _ = system
    n, scaled = A.shape[0], in_units(A, scale)
    residues = np.zeros(n, np.complex128)
    poles, vectors, inverse, good = eigenvectors(scaled)
    if not good:
        return poles, residues, False
    for k in range(n):
        seen, excited, error = 0j, 0j, 0.0
        for i in range(n):
            seen += C[0, i] * scale[i] * vectors[i, k]
            excited += inverse[k, i] * (B[i, 0] / scale[i])
            residual = -poles[k] * vectors[i, k]
            for j in range(n):
                residual += (scaled[i, j] + remainder_A[i, j] * scale[j] / scale[i]) * vectors[j, k]
            error += abs(inverse[k, i] * residual)
        residues[k] = seen * excited
        if not error < _KNOWN * abs(poles[k].real):
            return poles, residues, False
    return poles, residues, True


@part()
def modal_gain(poles: Array, residues: Array, direct: float, omega: float) -> float:
    """|G(j omega)| from partial fractions."""
    real, imaginary = direct, 0.0
    for i in range(poles.size):
        decay, apart = -poles[i].real, omega - poles[i].imag
        size = decay * decay + apart * apart
        real += (residues[i].real * decay + residues[i].imag * apart) / size
        imaginary += (residues[i].imag * decay - residues[i].real * apart) / size
    return float(np.sqrt(real * real + imaginary * imaginary))


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
def sort(values: Array) -> None:
    """Sort a short list in its place, by insertion: the library's sort would compile for a second."""
    for i in range(1, values.size):
        value, at = values[i], i
        while at > 0 and values[at - 1] > value:
            values[at] = values[at - 1]
            at -= 1
        values[at] = value


@part()
def merge(first: Array, second: Array) -> Array:
    """Two sorted lists as one."""
    together, i = np.empty(first.size + second.size), 0
    for k in range(first.size + 1):
        while i < second.size and (k == first.size or second[i] < first[k]):
            together[k + i] = second[i]
            i += 1
        if k < first.size:
            together[k + i] = first[k]
    return together


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
def peaks(system: Array, remainders: Array) -> Any:
    """Frequencies and values of the local maxima of the gain, found in partial fractions, valued by a direct solve.

    Partial fractions cost little at each frequency; where they lose digits (nearly equal poles) only the place of a
    peak suffers, because the value at it is computed anew. The value is nan where that is not accurate or the two
    differ; no peak is found where a resonance is narrower than the error of its pole.
    """
    A, _, _, D = system
    scale, direct = balancing_units(A), D[0, 0]
    poles, residues, good = partial_fractions(system, remainders[0], scale)
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
            found[number] = gain_at(system, remainders, scale, omegas[number])
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
    A, B, C, D, _, _, _ = room[0]
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
