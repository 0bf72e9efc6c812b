"""Harmonic balance in one harmonic: gains of a mechanism whose frictions are dampers that depend on the motion.

The descriptor is one of `inerter.systems.descriptor` with the inputs (force, a force beside each friction) and the
outputs (displacement, velocity across each friction); the frictions are dampers of `reference` [N s/m] there.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.close_descriptor import DESCRIPTOR, close
from inerter.kernels.decorators import kernel, part
from inerter.kernels.dense import (
    balancing_units,
    eigenvectors,
    factor,
    factor_resolvent,
    in_units,
    solve,
    solve_rows,
)
from inerter.kernels.gain import frequencies, largest_pole, merge, sort

Array = Any
_GOLDEN = 0.6180339887498949
_SWEEPS = 100
_REFLECTIONS = 2000
_SETTLED = 1e-11  # change of the forces in a sweep, relative to the largest, pushes included
_WIDTH = 1e-6  # relative distance from a resonance at which the gain has fallen a hundredfold if nothing damps it
FIRST_HARMONIC = 4.0 / np.pi  # amplitude of the first harmonic of a square wave over its height
_WEAK = 0.6  # first harmonic of friction over the force through it if held, up to which its velocity is near a sine
_OVERTONES = 31  # largest multiple of a frequency that is looked at
_LOCK = 1e9  # a damper that holds, over that of reference
_BEND = 0.1  # of the gain's logarithm between three neighbours: more calls for points between


@part()
def transfer(A: Array, B: Array, C: Array, D: Array, scale: Array, omega: float, G: Array) -> bool:
    """G becomes the frequency response; False at a pole."""
    n, m, o = A.shape[0], B.shape[1], C.shape[0]
    M, pivots, x = np.empty((n, n), np.complex128), np.empty(n, np.int64), np.empty(n, np.complex128)
    if not factor_resolvent(A, scale, omega, M, pivots):
        return False
    for j in range(m):
        for i in range(n):
            x[i] = B[i, j] / scale[i]
        solve(M, pivots, x)
        for k in range(o):
            total = D[k, j] + 0j
            for i in range(n):
                total += C[k, i] * scale[i] * x[i]
            G[k, j] = total
    return True


@part()
def slip(blocked: complex, admittance: complex, limit: float) -> Any:
    """Velocity across a friction with a force of amplitude `limit`, between what pushes with `blocked` if it sticks.

    Its force is blocked - admittance v, of amplitude `limit` and along v: |limit + admittance |v|| = |blocked|, a
    quadratic in |v|.
    """
    excess = abs(blocked) ** 2 - limit**2
    if not excess > 0.0:
        return 0j
    along = limit * admittance.real
    size = abs(admittance) ** 2
    root = np.sqrt(max(along**2 + size * excess, 0.0))
    speed = excess / (along + root) if along > 0.0 else (root - along) / size
    return blocked * speed / (limit + admittance * speed)


@part()
def reflect(Z: Array, velocity: Array, damper: Array, limit: Array, extra: Array) -> bool:
    """Solve for `extra`, all frictions at once, by waves that go to and fro between them and the mechanism.

    Averaged reflections (Douglas and Rachford) settle for any passive mechanism, if slowly.
    """
    count = limit.size
    extra[:] = 0.0
    new = np.empty(count, np.complex128)
    for _ in range(_REFLECTIONS):
        change, largest = 0.0, 0.0
        for j in range(count):
            v = velocity[j]
            for k in range(count):
                v -= Z[j, k] * extra[k]
            wave = extra[j] + 2.0 * damper[j] * v
            force = wave if abs(wave) <= limit[j] else wave * (limit[j] / abs(wave))
            new[j] = force - 0.5 * wave + 0.5 * extra[j]
            change = max(change, abs(new[j] - extra[j]))
            largest = max(largest, abs(new[j]), limit[j])
        for j in range(count):
            extra[j] = new[j]
        if change <= _SETTLED * largest:
            return True
    return False


@part()
def balance(work: Array, limit: Array, amplitude: float, reference: float) -> Any:
    """Gain of the first output with every friction slipping or sticking as it must, and whether that settled.

    `work` is the frequency response and room for the velocity across each friction and for its force over that which
    would hold it, which are filled.

    One friction is one closed form. Several are solved one after the other until none changes. Each sees the others
    as a damper and a force: waves, which a passive mechanism does not amplify, and which are small if the damper is
    near what its friction amounts to. Where that does not settle, as at a resonance of two frictions that nothing else
    damps, averaged reflections of those waves do.
    """
    G, slipping, hold = work
    count = limit.size
    Z, velocity, damper = np.empty((count, count), np.complex128), np.empty(count, np.complex128), np.empty(count)
    for j in range(count):
        velocity[j], damper[j] = G[1 + j, 0] * amplitude, reference
        for k in range(count):
            Z[j, k] = -G[1 + j, 1 + k]
    if count > 1:
        for k in range(count):
            if abs(velocity[k]) > 0.0:
                damper[k] = limit[k] / abs(velocity[k])
        M, pivots = np.empty((count, count), np.complex128), np.empty(count, np.int64)
        for j in range(count):
            for k in range(count):
                M[j, k] = Z[j, k] * (damper[k] - reference)
            M[j, j] += 1.0
        if not factor(M, pivots):
            return np.nan, False
        solve(M, pivots, velocity)
        solve_rows(M, pivots, Z)
    extra = np.zeros(count, np.complex128)  # force of each friction beyond that of its damper
    settled = count == 0
    for _ in range(_SWEEPS):
        change, largest = 0.0, 0.0
        for j in range(count):
            impedance = Z[j, j]
            if impedance == 0.0:  # nothing moves there
                continue
            push = velocity[j]
            for k in range(count):
                if k != j:
                    push -= Z[j, k] * extra[k]
            v = slip(push / impedance, 1.0 / impedance - damper[j], limit[j])
            new = (push - v) / impedance
            change = max(change, abs(new - extra[j]))
            largest = max(largest, abs(new), limit[j], 0.1 * abs(push / impedance))
            extra[j] = new
        if count == 1 or change <= _SETTLED * largest:
            settled = True
            break
    if not settled:
        settled = reflect(Z, velocity, damper, limit, extra)
    response = G[0, 0] * amplitude
    for j in range(count):
        push = velocity[j]
        for k in range(count):
            if k != j:
                push -= Z[j, k] * extra[k]
        slipping[j] = push - Z[j, j] * extra[j]
        response += G[0, 1 + j] * (extra[j] + (damper[j] - reference) * slipping[j])
        hold[j] = limit[j] * abs(Z[j, j]) / abs(push) if abs(push) > 0.0 else np.inf
    return abs(response) / amplitude, settled


@part()
def respond_to_frictions(response: Array, damper: Array, output: Array, velocities: Array) -> bool:
    """Fill the response to a force on each friction, with a `damper` at the place of each; False if it is infinite.

    `response` has none of these dampers: `output` is (frictions,), `velocities` (frictions moved, frictions pushed).
    """
    count = damper.size
    matrix, pivots = np.empty((count, count), np.complex128), np.empty(count, np.int64)
    column = np.empty(count, np.complex128)
    for j in range(count):
        for k in range(count):
            matrix[j, k] = -response[1 + j, 1 + k] * damper[k]
        matrix[j, j] += 1.0
    if not factor(matrix, pivots):
        return False
    for j in range(count):
        for k in range(count):
            column[k] = response[1 + k, 1 + j]
        solve(matrix, pivots, column)
        output[j] = response[0, 1 + j]
        for k in range(count):
            output[j] += response[0, 1 + k] * damper[k] * column[k]
            velocities[k, j] = column[k]
    return True


@part()
def overtones(system: Array, omega: float, third: Array, work: Array, limit: Array, reference: float) -> float:
    """Sum of the squared amplitudes of the response at the odd multiples n of the frequency.

    The force of a friction that slips is a square wave, whose harmonics have the amplitude of the first one over n;
    those of all frictions are taken in phase. Beyond the last multiple frictions act on the response as they do there.
    """
    A, B, C, D, scale = system
    _, slipping, hold = work
    count = limit.size
    damper, output = np.zeros(count), np.empty(count, np.complex128)
    velocities = np.empty((count, count), np.complex128)
    for j in range(count):
        damper[j] = _LOCK * reference if hold[j] >= FIRST_HARMONIC else limit[j] / abs(slipping[j]) - reference
    total, last = 0.0, 0.0
    for n in range(3, _OVERTONES + 1, 2):
        if not transfer(A, B, C, D, scale, n * omega, third):
            return np.inf
        if not respond_to_frictions(third, damper, output, velocities):
            return np.inf
        reached = 0.0
        for j in range(count):
            if hold[j] < FIRST_HARMONIC:
                reached += abs(output[j]) * limit[j] / n
        last = reached**2
        total += last
    return total + 0.5 * _OVERTONES * last


@part()
def distortion(work: Array, third: Array, limit: Array, reference: float, response: float) -> float:
    """The part of the response that is unsure because the force of a friction is no sine.

    The third harmonic of all frictions moves each of them, by `third`, the frequency response at three times the
    frequency; relative to its own velocity that is the angle by which its force may be turned. Infinite where one is
    neither weak nor held.
    """
    G, slipping, hold = work
    count = limit.size
    damper = np.empty(count)
    for j in range(count):
        if hold[j] >= FIRST_HARMONIC:
            damper[j] = _LOCK * reference
        elif hold[j] <= _WEAK:
            damper[j] = limit[j] / abs(slipping[j]) - reference
        else:
            return np.inf
    reached, output = np.empty(count, np.complex128), np.empty(count, np.complex128)
    velocities = np.empty((count, count), np.complex128)
    if not respond_to_frictions(G, damper, reached, velocities):
        return np.inf
    if not respond_to_frictions(third, damper, output, velocities):
        return np.inf
    unsure = 0.0
    for j in range(count):
        if hold[j] < FIRST_HARMONIC:
            moved = 0.0
            for k in range(count):
                if hold[k] < FIRST_HARMONIC:
                    moved += abs(velocities[j, k]) * limit[k] / 3.0
            unsure += abs(reached[j]) * limit[j] / response * min(moved / abs(slipping[j]), 1.0)
    return unsure


@part()
def gain_at(system: Array, omega: float, limit: Array, amplitude: float, reference: float, work: Array) -> Any:
    """Gain at one frequency, infinite at a pole, and whether it settled."""
    A, B, C, D, scale = system
    if not transfer(A, B, C, D, scale, omega, work[0]):
        return np.inf, True
    return balance(work, limit, amplitude, reference)


@part()
def grid_of(row: Array, dampers: Array, reference: float, descriptor: Array) -> Array:
    """Frequencies that show every resonance, from frictions that hardly act to frictions that hardly move.

    The lowest is far below the slowest motion.
    """
    found, near, count = np.empty(0), np.empty(4 * 7 * descriptor[1].shape[2]), 0
    floor = 0.0
    point = row.copy()
    for exponent in (0, -4, -1, 1, 4):
        for place in dampers:
            point[place] = reference * 10.0**exponent
        A, _, _, _, _, _, good = close(point, descriptor)
        if not good:
            continue
        poles, _, _, _ = eigenvectors(in_units(A, balancing_units(A)))
        size = largest_pole(poles)
        if not size < np.inf:
            continue
        if exponent == 0:
            found = frequencies(poles)
            floor = size
            for pole in poles:
                if abs(pole) > 1e-9 * size:
                    floor = min(floor, 0.01 * abs(pole))
            continue
        for pole in poles:
            if pole.imag > 0.0:
                for offset in (-3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0):
                    omega = pole.imag + offset * abs(pole.real)
                    if omega > 0.0:
                        near[count] = omega
                        count += 1
    near = near[:count]
    sort(near)
    grid, first = merge(found, near), 0
    while first < grid.size and grid[first] < floor:
        first += 1
    return grid[first:]


@part()
def merge_samples(grid: Array, values: Array, points: Array, new: Array) -> Any:
    """Merge two sorted lists of points with values; of neighbours with equal values only the first is kept.

    Otherwise a maximum between two of them would be lost.
    """
    omegas, heights = np.empty(grid.size + points.size), np.empty(grid.size + points.size)
    i, count = 0, 0
    for j in range(points.size + 1):
        while i < grid.size and (j == points.size or grid[i] <= points[j]):
            if count == 0 or abs(values[i] - heights[count - 1]) > 1e-12 * values[i]:
                omegas[count], heights[count] = grid[i], values[i]
                count += 1
            i += 1
        if j < points.size and (count == 0 or abs(new[j] - heights[count - 1]) > 1e-12 * new[j]):
            omegas[count], heights[count] = points[j], new[j]
            count += 1
    return omegas[:count].copy(), heights[:count].copy()


@part()
def top(system: Array, low: float, high: float, limit: Array, amplitude: float, reference: float, work: Array) -> float:
    """Frequency of the largest gain between `low` and `high`, by golden section."""
    width = 1e-10 * high
    a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    ga, gb = (
        gain_at(system, a, limit, amplitude, reference, work)[0],
        gain_at(system, b, limit, amplitude, reference, work)[0],
    )
    while high - low > width and not (high - low < 1e6 * width and abs(ga - gb) < 1e-13 * ga):
        if ga > gb:
            high, b, gb = b, a, ga
            a = high - _GOLDEN * (high - low)
            ga = gain_at(system, a, limit, amplitude, reference, work)[0]
        else:
            low, a, ga = a, b, gb
            b = low + _GOLDEN * (high - low)
            gb = gain_at(system, b, limit, amplitude, reference, work)[0]
    return 0.5 * (low + high)


@part()
def refine_grid(grid: Array, values: Array) -> Array:
    """Points between those where the gain bends."""
    extra = np.empty(grid.size)
    count = 0
    for k in range(1, grid.size - 2):
        bend = 0.0
        for i in (k, k + 1):
            left, right = grid[i] - grid[i - 1], grid[i + 1] - grid[i]
            straight = (np.log(values[i - 1]) * right + np.log(values[i + 1]) * left) / (left + right)
            bend = max(bend, abs(np.log(values[i]) - straight))
        if bend > _BEND and grid[k + 1] - grid[k] > 1e-7 * grid[k + 1]:
            extra[count] = 0.5 * (grid[k] + grid[k + 1])
            count += 1
    return extra[:count]


@part()
def peaks(
    system: Array,
    row: Array,
    limit: Array,
    dampers: Array,
    descriptor: Array,
    amplitude: float,
    reference: float,
    work: Array,
) -> Any:
    """Frequencies and values of the local maxima of the gain, 0 standing for the limit of low frequencies; all well.

    The value is infinite where the gain grows without bound.
    """
    grid = grid_of(row, dampers, reference, descriptor)
    if grid.size < 2:
        return np.zeros(0), np.zeros(0), False
    fine = True
    points = grid
    grid, values = np.empty(0), np.empty(0)
    for _ in range(6):
        new = np.empty(points.size)
        for k in range(points.size):
            new[k], settled = gain_at(system, points[k], limit, amplitude, reference, work)
            fine = fine and settled
        grid, values = merge_samples(grid, values, points, new)
        points = refine_grid(grid, values)
        if points.size == 0:
            break
    omegas, found = np.empty(grid.size), np.empty(grid.size)
    number = 0
    for k in range(grid.size):
        if (k > 0 and not values[k] > values[k - 1]) or (k < grid.size - 1 and not values[k] > values[k + 1]):
            continue
        if k == 0:
            lower = 1e-5 * grid[0]
            omegas[0], found[0] = 0.0, gain_at(system, lower, limit, amplitude, reference, work)[0]
            if found[0] > 2.0 * values[0]:
                found[0] = np.inf
        else:
            high = grid[k + 1] if k < grid.size - 1 else grid[k]
            omegas[number] = top(system, grid[k - 1], high, limit, amplitude, reference, work)
            found[number] = gain_at(system, omegas[number], limit, amplitude, reference, work)[0]
            if values[k] > found[number]:
                omegas[number], found[number] = grid[k], values[k]
            beside = gain_at(system, omegas[number] * (1.0 + _WIDTH), limit, amplitude, reference, work)[0]
            if found[number] > 100.0 * beside:  # a resonance that friction cannot hold
                found[number] = np.inf
        number += 1
    return omegas[:number], found[:number], fine


@kernel(
    "harmonic balance",
    f"(float64[::1], float64[::1], int64[::1], {DESCRIPTOR}, float64, float64, float64[::1])",
)
def gains(
    row: Array,
    limit: Array,
    dampers: Array,
    descriptor: Array,
    amplitude: float,
    reference: float,
    omegas: Array,
) -> Any:
    """Frequencies, the gain at each, whether all went well, the largest `distortion` and the largest `overtones`.

    Overtones are over the square of the first harmonic.

    At `omegas`, or at the `peaks` where none is given, which are not judged. There are none where the system cannot be
    closed.
    """
    A, B, C, D, _, _, good = close(row, descriptor)
    if not good:
        return np.zeros(0), np.zeros(0), False, np.inf, np.inf
    system = (A, B, C, D, balancing_units(A))
    G, third = np.empty((C.shape[0], B.shape[1]), np.complex128), np.empty((C.shape[0], B.shape[1]), np.complex128)
    work = (G, np.empty(limit.size, np.complex128), np.empty(limit.size))
    if omegas.size == 0:
        found, heights, fine = peaks(system, row, limit, dampers, descriptor, amplitude, reference, work)
        return found, heights, fine, 0.0, 0.0
    values, fine, unsure, over = np.empty(omegas.size), True, 0.0, 0.0
    for k in range(omegas.size):
        values[k], settled = gain_at(system, omegas[k], limit, amplitude, reference, work)
        fine = fine and settled
        if transfer(*system, 3.0 * omegas[k], third):
            unsure = max(unsure, distortion(work, third, limit, reference, values[k] * amplitude))
        else:
            unsure = np.inf
        if np.isfinite(unsure):
            beside = overtones(system, omegas[k], third, work, limit, reference)
            over = max(over, beside / (values[k] * amplitude) ** 2)
    return omegas, values, fine, unsure, over
