"""R.m.s. norms and their gradients from the modes of a vehicle, without states for filters and delays.

The autocorrelation of all that does not depend on the design, white noise behind the filters of the inputs and of an
output, is phi(t) = d delta(t) + sum_f r_f exp(m_f |t|). With inputs b_j that arrive at tau_j, the mean square of the
output c x + sum_j D_j w(t - tau_j) is

    c P c' + 2 sum_j D_j c n_j + sum_ij D_i D_j phi(tau_i - tau_j),    A P + P A' + sum_j (n_j b_j' + b_j n_j') = 0,
    n_j = sum_i theta_ij(A) b_i,    theta_ij(s) = int_0^inf phi(t - tau_j + tau_i) exp(s t) dt.

An approximant D(s T) of a delay, in place of exp(-s T), passes all frequencies alike; D(-s T) then takes the place of
exp(s T) in theta. In modes, A = V diag(lambda) V^-1, each of these is a closed form. The remainder of the modes,
E = V^-1 (A V - V diag(lambda)) with A before rounding, is computed in double-double. It corrects the mean squares at
first order, and these are known where that is small. Elsewhere `inerter.kernels.h2` has them, with states for filters.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.close_descriptor import DESCRIPTOR, close_extended, extended_space, pull_back
from inerter.kernels.decorators import kernel, part
from inerter.kernels.dense import balance, factor, multiply, solve_rows
from inerter.kernels.double_double import add_multiple, add_product
from inerter.kernels.eigenproblem import real_eigenvectors

Array = Any
_SMALL = 1e-7  # largest relative size of the terms of its correction
_SEPARATE = 1e-3  # largest remainder of the modes relative to their damping: higher orders are far below the first one
_REGULAR = 1e-3  # largest entry of V^-1 V - I
_EPS = 2.2e-16
_FACTORS = 8.0 * _EPS  # rounding of a product of a few factors
_CLOSE = 3e-3  # relative distance of poles below which a divided difference is an integral of the derivative
_SERIES = 0.5  # size of z up to which (exp(z) - 1) / z is a power series
_TERMS = 16  # of that

TO_REAL = (1.0 + 0j, 1.0 + 0j, 1j, -1j)  # two rows: from a conjugate pair to its real and imaginary part
TO_MODES = (0.5 + 0j, -0.5j, 0.5 + 0j, 0.5j)  # the inverse of that
TO_REAL_TRANSPOSED = (1.0 + 0j, 1j, 1.0 + 0j, -1j)
TO_MODES_TRANSPOSED = (0.5 + 0j, 0.5 + 0j, -0.5j, 0.5j)

_FIELDS = "float64[::1], int64[::1], int64[::1], complex128[::1], complex128[::1], float64[::1], float64[::1]"
NOISE = f"Tuple(({_FIELDS}, complex128[::1], float64))"


class FilteredNoise(NamedTuple):
    """Autocorrelation d delta(t) + sum_f r_f exp(m_f |t|) of the excitation for each group of outputs."""

    delays: Array  # (inputs,) [s] in rising order
    groups: Array  # (outputs,) number of the group: outputs with the same filter
    starts: Array  # (groups + 1,) first pole of each group, and their number
    poles: Array  # m_f [1/s]
    residues: Array  # r_f
    errors: Array  # relative rounding errors of r_f / (m_f + s)
    direct: Array  # (groups,) d
    delay_poles: Array  # q of D(x), the product of (q + x) / (q - x); none where delays are exact
    accurate: float  # relative error of a mean square by rounding up to which it counts as known


class VehicleModes(NamedTuple):
    """Modes of a design."""

    pole: Array  # (n,) lambda
    pair: Array  # (n,) 1 for the first mode of a conjugate pair, 2 for the second one, 0 for a real mode
    vectors: Array  # (n, n) V as columns; of a pair the real and the imaginary part of the first one
    inverse: Array  # (n, n) its inverse
    remainder: Array  # (n, n) E
    real_remainder: Array  # (n, n) the same over `vectors`
    quotient: Array  # (n, n) -1 / (lambda_k + lambda_l)


class CorrectedValues(NamedTuple):
    """Values in modes, their corrections, and bounds of their rounding errors."""

    value: Array
    correction: Array
    error: Array


class ModalRoom(NamedTuple):
    """Work space for one design."""

    modes: VehicleModes
    inputs: CorrectedValues  # (inputs, n) V^-1 b_j
    outputs: CorrectedValues  # (outputs, n) c V
    past: CorrectedValues  # (inputs, n) V^-1 n_j
    covariance: CorrectedValues  # (n, n) V^-1 P V^-T
    ahead: Array  # (pairs, n) theta_ij for inputs i < j, after the row of all i = j
    behind: Array  # (pairs, n) theta_ji
    ahead_slope: Array  # (pairs, n) derivatives of these
    behind_slope: Array
    ahead_change: Array  # (pairs, n, n) divided differences of theta
    behind_change: Array
    error: Array  # (pairs, n) bounds of the rounding errors of both
    exponent: Array  # (pairs, poles) exp(m_f (tau_j - tau_i)), or its approximant
    scale: Array  # (2, n) units of the states and their inverses
    eigen: Array  # (2, n) parts of the eigenvalues
    pivots: Array
    real: Array  # (4, n, n)
    complex: Array  # (2, n, n)
    back: Array  # (inputs, n) gradient over n_j in modes
    row: Array  # (2, max(n, inputs))


@part()
def values_space(rows: int, columns: int) -> Any:
    """Room for `CorrectedValues`."""
    values = np.zeros((2, rows, columns), np.complex128)
    return CorrectedValues(values[0], values[1], np.zeros((rows, columns)))


@part()
def modal_room(n: int, m: int, o: int, poles: int) -> Any:
    """Room for a design of n states, m inputs and o outputs."""
    square, real, pairs = np.zeros((4, n, n), np.complex128), np.zeros((7, n, n)), 1 + m * (m - 1) // 2
    modes = VehicleModes(
        np.zeros(n, np.complex128), np.zeros(n, np.int64), real[0], real[1], square[0], real[2], square[1]
    )  # fmt: skip
    theta = np.zeros((4, pairs, n), np.complex128)
    return ModalRoom(
        modes,
        values_space(m, n),
        values_space(o, n),
        values_space(m, n),
        values_space(n, n),
        theta[0],
        theta[1],
        theta[2],
        theta[3],
        np.zeros((pairs, n, n), np.complex128),
        np.zeros((pairs, n, n), np.complex128),
        np.zeros((pairs, n)),
        np.zeros((pairs, poles), np.complex128),
        np.zeros((2, n)),
        np.zeros((2, n)),
        np.zeros(n, np.int64),
        real[3:],
        square[2:],
        np.zeros((m, n), np.complex128),
        np.zeros((2, max(n, m))),
    )


@part(borrowing=True)
def mix_rows(M: Array, pair: Array, by: Array) -> None:
    """Multiply the rows of each conjugate pair by (a, b; c, d): r and s become a r + b s and c r + d s."""
    a, b, c, d = by
    for k in range(pair.size):
        if pair[k] == 1:
            for j in range(M.shape[1]):
                first, second = M[k, j], M[k + 1, j]
                M[k, j], M[k + 1, j] = a * first + b * second, c * first + d * second


@part(borrowing=True)
def mix_columns(M: Array, pair: Array, by: Array) -> None:
    """Do the same with columns."""
    a, b, c, d = by
    for i in range(M.shape[0]):
        for k in range(pair.size):
            if pair[k] == 1:
                first, second = M[i, k], M[i, k + 1]
                M[i, k], M[i, k + 1] = a * first + b * second, c * first + d * second


@part(borrowing=True)
def one_norm(z: complex) -> float:
    """Sum of the sizes of the parts of a complex number: no less than its size, and no root."""
    return float(abs(z.real) + abs(z.imag))


@part(borrowing=True)
def reciprocal(z: complex) -> complex:
    """Inverse, without the scaling of a quotient."""
    size = z.real * z.real + z.imag * z.imag
    return complex(z.real / size, -z.imag / size)


@part(borrowing=True)
def partner(pair: Array, k: int) -> int:
    """Number of the mode that is conjugate to mode k."""
    if pair[k] == 0:
        return k
    return k + 1 if pair[k] == 1 else k - 1


@part(borrowing=True)
def find_modes(A: Array, remainder_A: Array, room: Array) -> bool:
    """Fill `room.modes`; False unless all modes decay, and faster than what they lack."""
    modes, n = room.modes, A.shape[0]
    scale, inverse = room.scale[0], room.scale[1]
    transposed, rows, high, low = room.real[0], room.real[1], room.real[2], room.real[3]
    real, imaginary = room.eigen[0], room.eigen[1]
    balance(A, scale, inverse)
    total = 0.0
    for i in range(n):
        for j in range(n):
            transposed[j, i] = A[i, j] * scale[j] * inverse[i]
            total += abs(transposed[j, i])
    if not total < np.inf or real_eigenvectors(transposed, real, imaginary, rows) != 0:
        return False
    for k in range(n):
        if not real[k] < 0.0:
            return False
        modes.pole[k] = complex(real[k], imaginary[k])
        modes.pair[k] = 0
        if imaginary[k] != 0.0:
            modes.pair[k] = 1 if imaginary[k] > 0.0 else 2
    for i in range(n):
        for k in range(n):
            modes.vectors[i, k] = rows[k, i] * scale[i]
            transposed[i, k] = rows[k, i]
            modes.inverse[i, k] = 1.0 if i == k else 0.0
    if not factor(transposed, room.pivots):
        return False
    solve_rows(transposed, room.pivots, modes.inverse)
    for k in range(n):
        for i in range(n):
            modes.inverse[k, i] *= inverse[i]
    multiply(modes.inverse, modes.vectors, high)
    for i in range(n):
        for j in range(n):
            if not abs(high[i, j] - (1.0 if i == j else 0.0)) <= _REGULAR:
                return False
    for i in range(n):  # A V - V diag(lambda)
        for k in range(n):
            high[i, k], low[i, k] = 0.0, 0.0
        for j in range(n):
            if A[i, j] != 0.0:
                add_multiple(high[i], low[i], A[i, j], modes.vectors[j], n)
            if remainder_A[i, j] != 0.0:
                for k in range(n):
                    low[i, k] += remainder_A[i, j] * modes.vectors[j, k]
        for k in range(n):
            high[i, k], low[i, k] = add_product(high[i, k], low[i, k], -real[k], modes.vectors[i, k])
            if modes.pair[k] != 0:
                high[i, k], low[i, k] = add_product(
                    high[i, k], low[i, k], imaginary[k], modes.vectors[i, partner(modes.pair, k)]
                )
            high[i, k] += low[i, k]
    multiply(modes.inverse, high, modes.real_remainder)
    for i in range(n):
        for j in range(n):
            modes.remainder[i, j] = modes.real_remainder[i, j]
    mix_rows(modes.remainder, modes.pair, TO_MODES)
    mix_columns(modes.remainder, modes.pair, TO_REAL_TRANSPOSED)
    for k in range(n):
        for j in range(n):
            modes.quotient[k, j] = -reciprocal(modes.pole[k] + modes.pole[j])
    return is_separate(modes)


@part(borrowing=True)
def is_separate(modes: Array) -> bool:
    """Whether the modes lack little of their damping, and so little of each other that second orders do not matter."""
    for k in range(modes.pole.size):
        if not one_norm(modes.remainder[k, k]) <= -_SEPARATE * modes.pole[k].real:
            return False
        for j in range(k):
            damping = min(-modes.pole[k].real, -modes.pole[j].real)
            gap = max(one_norm(modes.pole[k] - modes.pole[j]), damping)
            mixed = one_norm(modes.remainder[k, j]) * one_norm(modes.remainder[j, k])
            if not mixed <= _SEPARATE**2 * damping * gap:
                return False
    return True


@part(borrowing=True)
def find_inputs(B: Array, remainder_B: Array, room: Array) -> None:
    """Fill `room.inputs`."""
    modes, inputs, n, m = room.modes, room.inputs, B.shape[0], B.shape[1]
    for j in range(m):
        value, high = room.row[0], room.row[1]
        for k in range(n):
            value[k] = 0.0
            for i in range(n):
                value[k] += modes.inverse[k, i] * B[i, j]
        for i in range(n):
            total, low = B[i, j], remainder_B[i, j]
            for k in range(n):
                total, low = add_product(total, low, -modes.vectors[i, k], value[k])
            high[i] = total + low
        for k in range(n):
            correction = 0.0
            for i in range(n):
                correction += modes.inverse[k, i] * high[i]
            inputs.value[j, k], inputs.correction[j, k] = value[k], correction
    mix_columns(inputs.value, modes.pair, TO_MODES)
    mix_columns(inputs.correction, modes.pair, TO_MODES)
    for j in range(m):
        for k in range(n):
            inputs.error[j, k] = _FACTORS * one_norm(inputs.value[j, k])


@part(borrowing=True)
def find_outputs(C: Array, remainder_C: Array, room: Array) -> None:
    """Fill `room.outputs`."""
    modes, outputs, n = room.modes, room.outputs, C.shape[1]
    for o in range(C.shape[0]):
        for k in range(n):
            value, correction, size = 0.0, 0.0, 0.0
            for i in range(n):
                value += C[o, i] * modes.vectors[i, k]
                correction += remainder_C[o, i] * modes.vectors[i, k]
                size += abs(C[o, i] * modes.vectors[i, k])
            outputs.value[o, k], outputs.correction[o, k], outputs.error[o, k] = value, correction, n * _EPS * size
    mix_columns(outputs.value, modes.pair, TO_REAL_TRANSPOSED)
    mix_columns(outputs.correction, modes.pair, TO_REAL_TRANSPOSED)
    for o in range(C.shape[0]):
        for k in range(n):
            if modes.pair[k] == 1:
                size = outputs.error[o, k] + outputs.error[o, k + 1]
                outputs.error[o, k], outputs.error[o, k + 1] = size, size


@part(borrowing=True)
def exponential_quotients(z: complex) -> tuple[complex, complex]:
    """(exp(z) - 1) / z and its derivative."""
    if one_norm(z) > _SERIES:
        inverse, power = reciprocal(z), np.exp(z)
        value = (power - 1.0) * inverse
        return value, (power - value) * inverse
    value, slope = 0j, 0j
    for k in range(_TERMS, 0, -1):  # value = 1 + z/2 (1 + z/3 (1 + ...)), and its derivative
        slope = (value + z * slope) / (k + 1.0) if k < _TERMS else 0j
        value = 1.0 + z * value / (k + 1.0) if k < _TERMS else 1.0 + 0j
    return value, slope


@part(borrowing=True)
def delay_at(noise: Array, time: float, s: complex) -> tuple[complex, complex, float]:
    """exp(s time) or its approximant, its derivative over s, and what multiplies the rounding error of a factor."""
    if noise.delay_poles.size == 0 or time == 0.0:
        power = np.exp(s * time)
        return power, time * power, 1.0 + one_norm(s) * time  # rounding of s * time turns the phase
    power, rise, error = 1.0 + 0j, 0j, 1.0
    for pole in noise.delay_poles:
        factor, slope, unsure = delay_factor(s * time, pole)
        error = error * one_norm(factor) + one_norm(power) * unsure
        rise = rise * factor + power * time * slope
        power *= factor
    return power, rise, error


@part(borrowing=True)
def delay_factor(x: complex, pole: complex) -> tuple[complex, complex, float]:
    """The factor (q - x) / (q + x) of an approximant of exp(x), its derivative, and a factor of its rounding error."""
    inverse = reciprocal(pole + x)
    turn = (one_norm(pole) + one_norm(x)) * one_norm(inverse)
    return (pole - x) * inverse, -2.0 * pole * inverse * inverse, turn * (1.0 + turn)


@part(borrowing=True)
def delay_quotient(
    noise: Array, time: float, s: complex, here: tuple[complex, complex, float], m: complex, decay: complex
) -> tuple[complex, complex, float]:
    """Divided difference of `delay_at` between s and m, its derivative over s, and a factor of its rounding error.

    `here` is what that has at s, `decay` its first value at m. The quotient of a product of factors f is that of all
    but one times f(m), and all but one at s times the quotient of f.
    """
    if noise.delay_poles.size == 0:
        apart, (power, rise, turns) = s - m, here
        if one_norm(apart) * time > _SERIES:
            over = reciprocal(apart)
            between = (power - decay) * over
            rising = (rise - between) * over
        else:
            between, rising = exponential_quotients(apart * time)
            between, rising = decay * time * between, decay * time * time * rising
        return between, rising, turns * one_norm(between)
    power, rise, error, between, rising, unsure = 1.0 + 0j, 0j, 1.0, 0j, 0j, 0.0
    for pole in noise.delay_poles:
        factor, slope, turn = delay_factor(s * time, pole)
        other, _, other_turn = delay_factor(m * time, pole)
        inverse = reciprocal(pole + s * time)
        quotient = -2.0 * time * pole * inverse * reciprocal(pole + m * time)
        unsure = unsure * one_norm(other) + one_norm(between) * other_turn
        unsure += one_norm(quotient) * (error + one_norm(power) * (turn + other_turn))
        rising = rising * other + rise * quotient - power * quotient * time * inverse
        between = between * other + power * quotient
        error = error * one_norm(factor) + one_norm(power) * turn
        rise = rise * factor + power * time * slope
        power *= factor
    return between, rising, unsure


@part(borrowing=True)
def theta_at(noise: Array, group: int, time: float, decay: Array, s: complex) -> Any:
    """Theta for a delay and for its negative, their derivatives over s, and a bound of the rounding errors of both.

    `decay` has all exp(m_f time), or their approximants.
    """
    starts, rates, residues, direct = noise.starts, noise.poles, noise.residues, noise.direct
    here = delay_at(noise, time, s)
    power, rise, turns = here
    ahead, behind, ahead_slope, behind_slope, error = 0j, 0j, 0j, 0j, 0.0
    for f in range(starts[group], starts[group + 1]):
        inverse = reciprocal(rates[f] + s)
        term = residues[f] * inverse
        steep = term * inverse
        if time == 0.0:
            behind -= term
            behind_slope += steep
            error += noise.errors[f] * one_norm(term)
            continue
        between, rising, unsure = delay_quotient(noise, time, s, here, rates[f], decay[f])
        ahead += residues[f] * between - power * term
        ahead_slope += residues[f] * rising + power * steep - rise * term
        behind -= decay[f] * term
        behind_slope += decay[f] * steep
        error += noise.errors[f] * (one_norm(residues[f]) * unsure + turns * one_norm(term))
    if time == 0.0:
        behind += 0.5 * direct[group]
        ahead, ahead_slope = behind, behind_slope
    else:
        ahead += direct[group] * power
        ahead_slope += direct[group] * rise
        error += turns * _FACTORS * direct[group] * (one_norm(power) if noise.delay_poles.size == 0 else 1.0)
    return ahead, behind, ahead_slope, behind_slope, error + _FACTORS * (one_norm(ahead) + one_norm(behind))


@part(borrowing=True)
def fill_theta(noise: Array, group: int, room: Array) -> None:
    """Fill `room.ahead`, `room.behind`, their slopes and `room.error` for a group of outputs."""
    delays, pole, pair = noise.delays, room.modes.pole, room.modes.pair
    row = 0
    for i in range(delays.size):
        for j in range(i, delays.size):
            if j == i and i > 0:
                continue
            for k in range(pole.size):
                if pair[k] == 2:
                    room.ahead[row, k] = np.conj(room.ahead[row, k - 1])
                    room.behind[row, k] = np.conj(room.behind[row, k - 1])
                    room.ahead_slope[row, k] = np.conj(room.ahead_slope[row, k - 1])
                    room.behind_slope[row, k] = np.conj(room.behind_slope[row, k - 1])
                    room.error[row, k] = room.error[row, k - 1]
                else:
                    found = theta_at(noise, group, delays[j] - delays[i], room.exponent[row], pole[k])
                    room.ahead[row, k], room.behind[row, k] = found[0], found[1]
                    room.ahead_slope[row, k], room.behind_slope[row, k] = found[2], found[3]
                    room.error[row, k] = found[4]
            row += 1


@part(borrowing=True)
def fill_exponents(noise: Array, room: Array) -> None:
    """Fill `room.exponent`."""
    delays, rates = noise.delays, noise.poles
    row = 0
    for i in range(delays.size):
        for j in range(i + 1, delays.size):
            row += 1
            for f in range(rates.size):
                room.exponent[row, f] = delay_at(noise, delays[j] - delays[i], rates[f])[0]


@part()
def fill_differences(noise: Array, group: int, room: Array) -> None:
    """Fill `room.ahead_change` and `room.behind_change` from `room.ahead` and `room.behind`.

    For the row of all i = j, where both are one, only the first.
    """
    delays, pole, pair = noise.delays, room.modes.pole, room.modes.pair
    row = 0
    for i in range(delays.size):
        for j in range(i, delays.size):
            if j == i and i > 0:
                continue
            time, decay = delays[j] - delays[i], room.exponent[row]
            ahead, behind = room.ahead[row], room.behind[row]
            ahead_slope, behind_slope = room.ahead_slope[row], room.behind_slope[row]
            ahead_change, behind_change = room.ahead_change[row], room.behind_change[row]
            for k in range(pole.size):
                if pair[k] == 2:
                    for q in range(k + 1):
                        other = partner(pair, q)
                        ahead_change[k, q] = np.conj(ahead_change[k - 1, other])
                        ahead_change[q, k] = ahead_change[k, q]
                        if i != j:
                            behind_change[k, q] = np.conj(behind_change[k - 1, other])
                            behind_change[q, k] = behind_change[k, q]
                    continue
                for q in range(k + (2 if pair[k] == 1 else 1)):
                    apart = pole[k] - pole[q]
                    if one_norm(apart) * (1.0 + one_norm(pole[k]) * time) > _CLOSE * one_norm(pole[k]):
                        inverse = reciprocal(apart)
                        ahead_change[k, q] = (ahead[k] - ahead[q]) * inverse
                        if i != j:
                            behind_change[k, q] = (behind[k] - behind[q]) * inverse
                    elif k == q:
                        ahead_change[k, q], behind_change[k, q] = ahead_slope[k], behind_slope[k]
                    else:  # the mean of the derivative, by Simpson's rule
                        middle = theta_at(noise, group, time, decay, pole[k] - 0.5 * apart)
                        ahead_change[k, q] = (ahead_slope[k] + 4.0 * middle[2] + ahead_slope[q]) / 6.0
                        behind_change[k, q] = (behind_slope[k] + 4.0 * middle[3] + behind_slope[q]) / 6.0
                    ahead_change[q, k] = ahead_change[k, q]
                    if i != j:
                        behind_change[q, k] = behind_change[k, q]
            row += 1


@part()
def correct_past(delays: Array, room: Array) -> None:
    """Fill the corrections of `room.past`, from those of the inputs and from the remainder of the modes."""
    modes, inputs, past = room.modes, room.inputs, room.past
    m = delays.size
    for k in range(modes.pole.size):
        if modes.pair[k] == 2:
            for j in range(m):
                past.correction[j, k] = np.conj(past.correction[j, k - 1])
            continue
        for j in range(m):
            past.correction[j, k] = room.ahead[0, k] * inputs.correction[j, k]
            for q in range(modes.pole.size):
                change = modes.remainder[k, q] * room.ahead_change[0, k, q]
                past.correction[j, k] += change * inputs.value[j, q]
        row = 0
        for i in range(m):
            for j in range(i + 1, m):
                row += 1
                past.correction[j, k] += room.ahead[row, k] * inputs.correction[i, k]
                past.correction[i, k] += room.behind[row, k] * inputs.correction[j, k]
                for q in range(modes.pole.size):
                    remainder = modes.remainder[k, q]
                    past.correction[j, k] += remainder * room.ahead_change[row, k, q] * inputs.value[i, q]
                    past.correction[i, k] += remainder * room.behind_change[row, k, q] * inputs.value[j, q]


@part()
def find_covariance(noise: Array, group: int, room: Array) -> None:
    """Fill `room.past` and `room.covariance` for a group of outputs."""
    modes, inputs, past, covariance = room.modes, room.inputs, room.past, room.covariance
    n, m, quotient = modes.pole.size, noise.delays.size, modes.quotient
    for k in range(n):
        for j in range(m):
            past.value[j, k] = room.ahead[0, k] * inputs.value[j, k]
            past.error[j, k] = room.error[0, k] * one_norm(inputs.value[j, k])
        row = 0
        for i in range(m):
            for j in range(i + 1, m):
                row += 1
                past.value[j, k] += room.ahead[row, k] * inputs.value[i, k]
                past.value[i, k] += room.behind[row, k] * inputs.value[j, k]
                past.error[j, k] += room.error[row, k] * one_norm(inputs.value[i, k])
                past.error[i, k] += room.error[row, k] * one_norm(inputs.value[j, k])
    correct_past(noise.delays, room)
    for k in range(n):
        for q in range(k + 1):
            value, error = 0j, 0.0
            for j in range(m):
                value += past.value[j, k] * inputs.value[j, q] + inputs.value[j, k] * past.value[j, q]
                error += past.error[j, k] * one_norm(inputs.value[j, q])
                error += one_norm(inputs.value[j, k]) * past.error[j, q]
            covariance.value[k, q] = value * quotient[k, q]
            covariance.error[k, q] = error * one_norm(quotient[k, q])
            covariance.value[q, k], covariance.error[q, k] = covariance.value[k, q], covariance.error[k, q]
    real_covariance(room)
    change, changed = room.real[1], room.complex[0]
    multiply(modes.real_remainder, room.real[0], change)
    for k in range(n):
        for q in range(n):
            changed[k, q] = change[k, q] + change[q, k]
    mix_rows(changed, modes.pair, TO_MODES)
    mix_columns(changed, modes.pair, TO_MODES)
    for k in range(n):
        for q in range(k + 1):
            value = changed[k, q]
            for j in range(m):
                value += past.correction[j, k] * inputs.value[j, q] + inputs.value[j, k] * past.correction[j, q]
                value += past.value[j, k] * inputs.correction[j, q] + inputs.correction[j, k] * past.value[j, q]
            covariance.correction[k, q] = value * quotient[k, q]
            covariance.correction[q, k] = covariance.correction[k, q]


@part(borrowing=True)
def real_covariance(room: Array) -> None:
    """Fill room.real[0] with the covariance over the real vectors of the modes."""
    P, n, pair = room.complex[0], room.modes.pole.size, room.modes.pair
    for k in range(n):
        for q in range(n):
            P[k, q] = room.covariance.value[k, q]
    mix_rows(P, pair, TO_REAL)
    mix_columns(P, pair, TO_REAL)
    for k in range(n):
        for q in range(n):
            room.real[0][k, q] = P[k, q].real


@part()
def autocorrelation(noise: Array, group: int, time: float) -> tuple[float, float]:
    """Autocorrelation at a time, and a bound of its rounding errors, of a group without a delta function."""
    starts, rates, residues = noise.starts, noise.poles, noise.residues
    value, size = 0.0, 0.0
    for f in range(starts[group], starts[group + 1]):
        term = residues[f] * delay_at(noise, abs(time), rates[f])[0]
        value += term.real
        size += noise.errors[f] * one_norm(term)
    return value, size


@part()
def mean_square(
    noise: Array, group: int, room: Array, o: int, D: Array, remainder_D: Array
) -> tuple[float, float, float]:
    """Mean square of an output, and relative sizes of the terms of its correction and of its rounding errors."""
    outputs, past, covariance, delays = room.outputs, room.past, room.covariance, noise.delays
    n, m = room.modes.pole.size, delays.size
    total, change, terms, rounding = 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        value, correction, size, sizes = 0j, 0j, 0.0, 0.0
        for q in range(n):
            value += covariance.value[k, q] * outputs.value[o, q]
            correction += covariance.correction[k, q] * outputs.value[o, q]
            seen = one_norm(outputs.value[o, q])
            size += one_norm(covariance.correction[k, q]) * seen
            sizes += (covariance.error[k, q] + n * _EPS * one_norm(covariance.value[k, q])) * seen
        for j in range(m):
            if D[o, j] != 0.0:
                value += D[o, j] * past.value[j, k]
                correction += 2.0 * D[o, j] * past.correction[j, k]
                size += 2.0 * abs(D[o, j]) * one_norm(past.correction[j, k])
                sizes += 2.0 * abs(D[o, j]) * past.error[j, k]
        own, lacking, seen = outputs.value[o, k], outputs.correction[o, k], one_norm(outputs.value[o, k])
        direct = 0j
        for j in range(m):
            if D[o, j] != 0.0:
                direct += D[o, j] * past.value[j, k]
            if remainder_D[o, j] != 0.0:
                change += 2.0 * remainder_D[o, j] * (own * past.value[j, k]).real
        total += (own * (value + direct)).real
        change += (own * correction + 2.0 * lacking * value).real
        terms += seen * size + 2.0 * one_norm(lacking) * one_norm(value)
        rounding += seen * sizes + 2.0 * outputs.error[o, k] * one_norm(value)
    for i in range(m):
        for j in range(m):
            if D[o, i] != 0.0 and D[o, j] != 0.0:
                value, size = autocorrelation(noise, group, delays[i] - delays[j])
                total += D[o, i] * D[o, j] * value
                change += 2.0 * remainder_D[o, i] * D[o, j] * value
                rounding += abs(D[o, i] * D[o, j]) * size
    return total + change, terms / total, rounding / total


class Slopes(NamedTuple):
    """Gradients of the weighted sum of norms: over matrices in modes, and over D."""

    system: Array  # (n, n) over the real vectors of the modes
    inputs: Array  # (inputs, n)
    outputs: Array  # (outputs, n)
    direct: Array  # (outputs, inputs)


@part()
def add_slopes(noise: Array, group: int, room: Array, D: Array, shares: Array, slopes: Array) -> None:
    """Add to `slopes` those of the sum of the mean squares of a group of outputs with `shares`."""
    delays, groups, modes = noise.delays, noise.groups, room.modes
    inputs, outputs, past, covariance = room.inputs, room.outputs, room.past, room.covariance
    n, m, Q, G = modes.pole.size, delays.size, room.complex[0], room.complex[1]
    back = room.back
    for k in range(n):
        for q in range(k + 1):
            value = 0j
            for o in range(groups.size):
                if groups[o] == group:
                    value += shares[o] * outputs.value[o, k] * outputs.value[o, q]
            Q[k, q] = value * modes.quotient[k, q]
            Q[q, k] = Q[k, q]
    for k in range(n):
        for j in range(m):
            here, before = 0j, 0j
            for q in range(n):
                here += Q[k, q] * inputs.value[j, q]
                before += Q[k, q] * past.value[j, q]
            for o in range(groups.size):
                if groups[o] == group and D[o, j] != 0.0:
                    here += shares[o] * D[o, j] * outputs.value[o, k]
            back[j, k] = 2.0 * here
            slopes.inputs[j, k] += 2.0 * before
        for o in range(groups.size):
            if groups[o] == group:
                value = 0j
                for q in range(n):
                    value += covariance.value[k, q] * outputs.value[o, q]
                for j in range(m):
                    value += D[o, j] * past.value[j, k]
                    slopes.direct[o, j] += 2.0 * shares[o] * (outputs.value[o, k] * past.value[j, k]).real
                slopes.outputs[o, k] += 2.0 * shares[o] * value
    for o in range(groups.size):
        for j in range(m):
            for i in range(m):
                if groups[o] == group and D[o, i] != 0.0:
                    phi = autocorrelation(noise, group, delays[i] - delays[j])[0]
                    slopes.direct[o, j] += 2.0 * shares[o] * D[o, i] * phi
    add_theta_slopes(delays, room, back, slopes.inputs, G)
    mix_rows(G, modes.pair, TO_MODES_TRANSPOSED)
    mix_columns(G, modes.pair, TO_REAL)
    mix_rows(Q, modes.pair, TO_MODES_TRANSPOSED)
    mix_columns(Q, modes.pair, TO_MODES_TRANSPOSED)
    P, real_Q, product = room.real[0], room.real[1], room.real[2]
    for k in range(n):
        for q in range(n):
            real_Q[k, q] = Q[k, q].real
    multiply(real_Q, P, product)
    for k in range(n):
        for q in range(n):
            slopes.system[k, q] += 2.0 * product[k, q] + G[k, q].real


@part()
def add_theta_slopes(delays: Array, room: Array, back: Array, over_inputs: Array, G: Array) -> None:
    """Fill G, over A in modes, and add to `over_inputs` what follows from the gradient `back` over all n_j."""
    inputs, modes = room.inputs, room.modes
    n, m = modes.pole.size, delays.size
    for k in range(n):
        for j in range(m):
            over_inputs[j, k] += room.ahead[0, k] * back[j, k]
        row = 0
        for i in range(m):
            for j in range(i + 1, m):
                row += 1
                over_inputs[i, k] += room.ahead[row, k] * back[j, k]
                over_inputs[j, k] += room.behind[row, k] * back[i, k]
        if modes.pair[k] == 2:
            for q in range(n):
                G[k, q] = np.conj(G[k - 1, partner(modes.pair, q)])
            continue
        for q in range(n):
            value = 0j
            for j in range(m):
                value += back[j, k] * inputs.value[j, q]
            value, row = value * room.ahead_change[0, k, q], 0
            for i in range(m):
                for j in range(i + 1, m):
                    row += 1
                    value += back[j, k] * room.ahead_change[row, k, q] * inputs.value[i, q]
                    value += back[i, k] * room.behind_change[row, k, q] * inputs.value[j, q]
            G[k, q] = value


@part()
def gradient_of(p: Array, descriptor: Array, closing: Array, room: Array, slopes: Array) -> Array:
    """Gradient over the values p from `slopes`, which are overwritten."""
    _, _, _, _, T, factors, _ = closing
    modes, n, m, o = room.modes, room.modes.pole.size, slopes.inputs.shape[0], slopes.outputs.shape[0]
    half, G_A, G_B, G_C = room.real[0], room.real[1], np.zeros((n, m)), np.zeros((o, n))
    for i in range(n):
        for q in range(n):
            half[i, q] = 0.0
            for k in range(n):
                half[i, q] += slopes.system[i, k] * modes.vectors[q, k]
    for i in range(n):
        for q in range(n):
            G_A[i, q] = 0.0
        for k in range(n):
            for q in range(n):
                G_A[i, q] += modes.inverse[k, i] * half[k, q]
    mix_columns(slopes.inputs, modes.pair, TO_MODES_TRANSPOSED)
    mix_columns(slopes.outputs, modes.pair, TO_REAL)
    for i in range(n):
        for k in range(n):
            for j in range(m):
                G_B[i, j] += modes.inverse[k, i] * slopes.inputs[j, k].real
            for r in range(o):
                G_C[r, i] += slopes.outputs[r, k].real * modes.vectors[i, k]
    return pull_back(p, descriptor, T, factors, G_A, G_B, G_C, slopes.direct)


@kernel(
    "r.m.s. norms by modes",
    f"(float64[:,::1], {DESCRIPTOR}, UniTuple(float64[:,::1], 2), {NOISE}, float64[::1])",
)
def norms_by_modes(points: Array, descriptor: Array, extended: Array, given: Array, weights: Array) -> Any:
    """Norms, gradients and error estimates as `inerter.kernels.h2.norms` has them, by modes.

    `given` has the fields of `FilteredNoise` in order. Where the modes do not suffice, the error estimate is infinite,
    and norms and gradient are nan. Behind a filter with d > 0, D counts as zero: else the norm would be infinite.
    """
    n, m, o = descriptor[1].shape[2], descriptor[2].shape[2], descriptor[7].shape[1]
    noise = FilteredNoise(*given)
    groups, direct = noise.groups, noise.direct
    closing, room = extended_space(descriptor), modal_room(n, m, o, noise.poles.size)
    slopes = Slopes(
        np.zeros((n, n)), np.zeros((m, n), np.complex128), np.zeros((o, n), np.complex128), np.zeros((o, m))
    )
    count = points.shape[0]
    result, errors = np.full((count, o), np.nan), np.full(count, np.inf)
    gradients, shares = np.full((count if weights.size > 0 else 0, points.shape[1]), np.nan), np.zeros(o)
    fill_exponents(noise, room)
    for row in range(count):
        p = points[row]
        if not close_extended(closing, p, descriptor, extended):
            continue
        (A, B, C, D, _, _, _), (remainder_A, remainder_B, remainder_C, remainder_D) = closing[0], closing[1]
        if not find_modes(A, remainder_A, room):
            continue
        for k in range(o):
            if direct[groups[k]] != 0.0:
                for j in range(m):
                    D[k, j], remainder_D[k, j] = 0.0, 0.0
        find_inputs(B, remainder_B, room)
        find_outputs(C, remainder_C, room)
        slopes.system[:, :], slopes.inputs[:, :], slopes.outputs[:, :], slopes.direct[:, :] = 0.0, 0j, 0j, 0.0
        terms, rounding, is_known = 0.0, 0.0, True
        for group in range(direct.size):
            fill_theta(noise, group, room)
            fill_differences(noise, group, room)
            find_covariance(noise, group, room)
            for k in range(o):
                if groups[k] == group:
                    square, more, unsure = mean_square(noise, group, room, k, D, remainder_D)
                    is_known = is_known and square > 0.0 and more <= _SMALL and unsure <= noise.accurate
                    result[row, k] = np.sqrt(square)
                    terms, rounding = terms + more, rounding + unsure
                    if weights.size > 0:
                        shares[k] = 0.5 * weights[k] / result[row, k]
            if not is_known:
                break
            if weights.size > 0:
                add_slopes(noise, group, room, D, shares, slopes)
        if not is_known:
            result[row, :] = np.nan
            continue
        errors[row] = terms + rounding
        if weights.size > 0:
            gradient = gradient_of(p, descriptor, closing[0], room, slopes)
            for k in range(gradient.size):
                gradients[row, k] = gradient[k]
    return result, gradients, errors
