"""Minima of a peak gain over the values of one network, from many starts in one call, compiled.

The gain |b(j omega) / a(j omega)| has its local maxima between the points of a logarithmic grid that spans the moduli
of the poles, which the Newton polygon of a(s) bounds. Intervals are halved until gain and slopes at their ends agree;
each maximum is refined by its slope. A search minimises the largest of
them by sequential quadratic programs: the step minimises the largest linear model of a peak plus a quadratic term (BFGS
with Powell's damping for the weighted peaks), with a correction of second order where that step fails. A grid may miss
a sharp and weak peak, so that an optimum found here is to be evaluated once more.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.arrays import Floats, Ints, Matrix
from inerter.kernels.astrom_jury import forward
from inerter.kernels.decorators import kernel, part
from inerter.kernels.network_norms import DEGREE, NormSpace, Port, fill_fraction, fill_shares, norm_space
from inerter.kernels.network_polynomials import BOTTOM, TOP, Program, admittance, admittance_adjoint
from inerter.kernels.network_search import Variables
from inerter.kernels.quasi_newton import factorise_free, reset, solve_lower, solve_upper, update

Array = Any
_PER_DECADE, _BEYOND = 14, 0.7  # points of the grid, and decades that it goes beyond the moduli of the poles
_ALIKE, _DEEPEST = 1e-3, 9  # difference of the gain and its slopes up to which an interval is not halved; halvings
_ROUGHLY = 3e-2  # the same of a sample from which a search may start
_MOST = 8  # peaks that a search sees, the highest
_ITERATIONS, _HALVINGS, _PAIRS = 200, 12, 300
_STEP, _CONVERGED = 1.0, 1e-12  # longest step of one value, in its logarithm; expected fall of an optimum


class PeakSpace(NamedTuple):
    """Room for a search."""

    norms: NormSpace
    slopes: Floats  # (leaves,)
    a: Floats
    b: Floats
    omega: Floats  # (peaks,) of the present point
    height: Floats  # logarithms of the gains
    gradient: Matrix  # (peaks, variables)
    trial_omega: Floats
    trial_height: Floats
    trial_gradient: Matrix
    shifted: Floats  # (peaks,) models of the peaks at the present point
    weights: Floats  # (peaks,)
    scaled: Matrix  # (peaks, variables)
    point: Floats
    trial: Floats
    step: Floats
    bend: Floats  # change of the weighted peaks' gradient over a step
    change: Floats
    hessian: Matrix
    factor: Matrix
    held: Ints
    count: Ints  # (1,) evaluations


@part(borrowing=True)
def _parts_at(p: Array, degree: int, omega: float) -> Any:
    """Real and imaginary part of a polynomial at j omega, the highest power first."""
    real, imag = 0.0, 0.0
    for i in range(degree + 1):
        real, imag = p[i] - omega * imag, omega * real
    return real, imag


@part(borrowing=True)
def _modulus(p: Array, degree: int, omega: float) -> Any:
    """Square of |p(j omega)|, and the derivative of its logarithm's half with respect to log omega."""
    real, imag, more, more_imag = 0.0, 0.0, 0.0, 0.0
    for i in range(degree + 1):
        weight = (degree - i) * p[i]
        real, imag = p[i] - omega * imag, omega * real
        more, more_imag = weight - omega * more_imag, omega * more
    square = real * real + imag * imag
    return square, (real * more + imag * more_imag) / square


@part(borrowing=True)
def _gain(n: int, space: PeakSpace, omega: float) -> Any:
    """Logarithm of the gain, and its derivative with respect to log omega."""
    over, rise = _modulus(space.b, n - 1, omega)
    under, fall = _modulus(space.a, n, omega)
    return 0.5 * np.log(over / under), rise - fall


@part(borrowing=True)
def _refine(n: int, space: PeakSpace, low: float, high: float) -> float:
    """Logarithm of the frequency of the maximum between two logarithms, by the slope's sign and secants (Illinois)."""
    f_low, f_high = _gain(n, space, np.exp(low))[1], _gain(n, space, np.exp(high))[1]
    if not (f_low > 0.0 and f_high < 0.0):
        return 0.5 * (low + high)
    side, x = 0, low
    for _ in range(60):
        x = (low * f_high - high * f_low) / (f_high - f_low)
        if not low < x < high:
            x = 0.5 * (low + high)
        f = _gain(n, space, np.exp(x))[1]
        if f > 0.0:
            low, f_low = x, f
            if side == 1:
                f_high *= 0.5
            side = 1
        else:
            high, f_high = x, f
            if side == -1:
                f_low *= 0.5
            side = -1
        if high - low < 1e-13 or abs(f) < 1e-13:
            break
    return x


@part(borrowing=True)
def _add_peak(count: int, omega: float, height: float, omegas: Array, heights: Array) -> int:
    """Keep a peak among the highest; the number of peaks."""
    if count < _MOST:
        omegas[count], heights[count] = omega, height
        return count + 1
    lowest = 0
    for i in range(_MOST):
        if heights[i] < heights[lowest]:
            lowest = i
    if height > heights[lowest]:
        omegas[lowest], heights[lowest] = omega, height
    return count


@part(borrowing=True, apart=True)
def _peaks_at(
    point: Array,
    variables: Variables,
    program: Program,
    port: Port,
    space: PeakSpace,
    omegas: Array,
    heights: Array,
    refined: bool,
    enough: float,
) -> int:
    """Fill the peaks at a point, none after one as high as `enough`; their number, 0 where the motion is unstable."""
    space.count[0] += 1
    for leaf in range(variables.of_leaf.size):
        if variables.of_leaf[leaf] >= 0:
            variables.values[leaf] = np.exp(point[variables.of_leaf[leaf]])
    admittance(variables.values, program, space.norms.network, False)
    fill_fraction(0, program, port, space.norms, False)
    n, fraction = port.forms[0, DEGREE], space.norms.fraction
    low, high = np.inf, -np.inf
    for i in range(n + 1):
        space.a[i] = fraction.a[i]
    for i in range(n):
        space.b[i] = fraction.b[i]
    for i in range(n + 1):  # moduli of the poles: slopes of the polygon over the coefficients' logarithms
        for j in range(i + 1, n + 1):
            if space.a[i] > 0.0 and space.a[j] > 0.0 and (i == 0 or j == n):
                ratio = (np.log(space.a[j]) - np.log(space.a[i])) / (j - i)
                if j == n:
                    low = min(low, ratio)
                if i == 0:
                    high = max(high, ratio)
    if not forward(n, fraction) < np.inf or not (low > -700.0 and high < 700.0):
        return 0
    low -= _BEYOND * 2.302585092994046
    high += _BEYOND * 2.302585092994046
    points = int((high - low) / 2.302585092994046 * _PER_DECADE) + 2
    if points > 4000:
        return 0
    spacing = (high - low) / (points - 1)
    count = 0
    if space.b[n - 1] != 0.0:
        count = _add_peak(count, 0.0, np.log(abs(space.b[n - 1] / space.a[n])), omegas, heights)
        if heights[0] >= enough:
            return count
    alike = _ALIKE if refined else _ROUGHLY
    left, depth = low, 0
    left_height, left_slope = _gain(n, space, np.exp(low))
    interval, part_of = 0, 0  # of the grid, and which of its 2^depth parts
    while interval < points - 1:
        right = low + spacing * (interval + (part_of + 1.0) / (1 << depth))
        right_height, right_slope = _gain(n, space, np.exp(right))
        change = 0.5 * (left_slope + right_slope) * (right - left)
        if abs(right_height - left_height - change) > alike and depth < _DEEPEST:
            depth += 1
            part_of *= 2
            continue
        if left_slope > 0.0 and right_slope <= 0.0:
            height, place = max(left_height, right_height), left if left_height > right_height else right
            if refined:
                place = _refine(n, space, left, right)
                height = _gain(n, space, np.exp(place))[0]
            count = _add_peak(count, np.exp(place), height, omegas, heights)
            if height >= enough:
                return count
        left, left_height, left_slope = right, right_height, right_slope
        part_of += 1
        while depth > 0 and part_of % 2 == 0:
            depth -= 1
            part_of //= 2
        if depth == 0:
            interval += part_of
            part_of = 0
    return count


@part(borrowing=True)
def _fill_gradients(
    count: int, variables: Variables, program: Program, port: Port, space: PeakSpace, omegas: Array, gradients: Array
) -> None:
    """Gradients of the logarithms of the gains at `omegas` over the variables, at the point of `_peaks_at`."""
    n, fraction, network = port.forms[0, DEGREE], space.norms.fraction, space.norms.network
    last = program.parts.shape[0] - 1
    for peak in range(count):
        omega = omegas[peak]
        real, imag = _parts_at(space.a, n, omega)
        size = real * real + imag * imag
        power, turn = 1.0, 0
        for i in range(n, -1, -1):  # the real part of (j omega)^k / a(j omega)
            value = real if turn == 0 else imag if turn == 1 else -real if turn == 2 else -imag
            fraction.a_adjoint[i] = -power * value / size
            power *= omega
            turn = (turn + 1) % 4
        real, imag = _parts_at(space.b, n - 1, omega)
        size = real * real + imag * imag
        power, turn = 1.0, 0
        for i in range(n - 1, -1, -1):
            value = real if turn == 0 else imag if turn == 1 else -real if turn == 2 else -imag
            fraction.b_adjoint[i] = power * value / size
            power *= omega
            turn = (turn + 1) % 4
        fill_shares(0, program, port, space.norms, False)
        for i in range(program.parts[last, TOP] + 1):
            network.top_adjoint[last, i] = space.norms.top_shares[0, i]
        for i in range(program.parts[last, BOTTOM] + 1):
            network.bottom_adjoint[last, i] = space.norms.bottom_shares[0, i]
        for leaf in range(space.slopes.size):
            space.slopes[leaf] = 0.0
        admittance_adjoint(program, network, space.slopes)
        for i in range(gradients.shape[1]):
            gradients[peak, i] = 0.0
        for leaf in range(space.slopes.size):
            if variables.of_leaf[leaf] >= 0:
                gradients[peak, variables.of_leaf[leaf]] += space.slopes[leaf] * variables.values[leaf]


@part(borrowing=True)
def _highest(count: int, heights: Array) -> float:
    best = -np.inf
    for i in range(count):
        best = max(best, heights[i])
    return best if count > 0 else np.inf


@part(borrowing=True)
def _weigh(count: int, space: PeakSpace) -> None:
    """Weights of the peaks: the dual of the quadratic program, by steps along pairs of weights."""
    L, k, W, weights = space.factor, space.point.size, space.scaled, space.weights
    highest = 0
    for p in range(count):
        for i in range(k):
            W[p, i] = 0.0 if space.held[i] == 1 else space.gradient[p, i]
        solve_lower(L, W[p])
        weights[p] = 0.0
        if space.shifted[p] > space.shifted[highest]:
            highest = p
    weights[highest] = 1.0
    for _ in range(_PAIRS):
        for i in range(k):
            space.change[i] = 0.0
            for p in range(count):
                space.change[i] += weights[p] * W[p, i]
        least, most, least_value, most_value = 0, -1, np.inf, -np.inf
        for p in range(count):
            q = -space.shifted[p]
            for i in range(k):
                q += W[p, i] * space.change[i]
            if q < least_value:
                least, least_value = p, q
            if weights[p] > 0.0 and q > most_value:
                most, most_value = p, q
        if most_value - least_value < 1e-15:
            return
        distance = 0.0
        for i in range(k):
            distance += (W[least, i] - W[most, i]) ** 2
        t = weights[most] if not distance > 0.0 else min(weights[most], (most_value - least_value) / distance)
        weights[least] += t
        weights[most] -= t


@part(borrowing=True)
def _find_step(count: int, variables: Variables, space: PeakSpace) -> float:
    """Fill the step that minimises the largest model of a peak; the fall that it promises, or 1 if there is none."""
    k, L, step = space.point.size, space.factor, space.step
    for i in range(k):
        space.held[i] = 0
    for _ in range(k + 1):
        if not factorise_free(space.hessian, space.held, L):
            return 1.0
        _weigh(count, space)
        for i in range(k):
            total = 0.0
            for p in range(count):
                total -= space.weights[p] * space.scaled[p, i]
            step[i] = total
        solve_upper(L, step)
        outwards = False
        for i in range(k):
            if space.held[i] == 0 and (
                (space.point[i] <= variables.lower[i] and step[i] < 0.0)
                or (space.point[i] >= variables.upper[i] and step[i] > 0.0)
            ):
                space.held[i] = 1
                outwards = True
        if not outwards:
            break
    longest = 0.0
    for i in range(k):
        if space.held[i] == 1:
            step[i] = 0.0
        longest = max(longest, abs(step[i]))
    if not longest < np.inf:
        return 1.0
    if longest > _STEP:
        for i in range(k):
            step[i] *= _STEP / longest
    fall = -np.inf
    for p in range(count):
        total = space.shifted[p]
        for i in range(k):
            total += space.gradient[p, i] * step[i]
        fall = max(fall, total)
    return fall


@part(borrowing=True)
def _update(count: int, trial_count: int, space: PeakSpace) -> None:
    """BFGS update for the weighted peaks; peaks belong together if they are closest in frequency."""
    s, y, k = space.step, space.bend, space.point.size
    for i in range(k):
        s[i] = space.trial[i] - space.point[i]
        y[i] = 0.0
    for p in range(count):
        if space.weights[p] <= 0.0:
            continue
        nearest, distance = 0, np.inf
        for q in range(trial_count):
            away = abs(np.log((space.trial_omega[q] + 1e-9) / (space.omega[p] + 1e-9)))
            if away < distance:
                nearest, distance = q, away
        for i in range(k):
            y[i] += space.weights[p] * (space.trial_gradient[nearest, i] - space.gradient[p, i])
    update(space.hessian, s, y, space.change)


@part(borrowing=True)
def _go_to(t: float, variables: Variables, space: PeakSpace) -> None:
    for i in range(space.point.size):
        space.trial[i] = min(max(space.point[i] + t * space.step[i], variables.lower[i]), variables.upper[i])


@part(borrowing=True)
def _descend(variables: Variables, program: Program, port: Port, space: PeakSpace) -> float:
    """Minimise from `space.point`, which becomes the optimum; the logarithm of the highest peak."""
    point, trial, k = space.point, space.trial, space.point.size
    count = _peaks_at(point, variables, program, port, space, space.omega, space.height, True, np.inf)
    f = _highest(count, space.height)
    if count == 0:
        return f
    _fill_gradients(count, variables, program, port, space, space.omega, space.gradient)
    reset(space.hessian, 1.0)
    fresh = True
    for _ in range(_ITERATIONS):
        for p in range(count):
            space.shifted[p] = space.height[p] - f
        fall = _find_step(count, variables, space)
        if fall > 0.0:
            if fresh:
                break
            reset(space.hessian, 1.0)
            fresh = True
            continue
        if fall > -_CONVERGED:
            break
        t, taken, trial_count = 1.0, False, 0
        for halving in range(_HALVINGS):
            _go_to(t, variables, space)
            trial_count = _peaks_at(
                trial, variables, program, port, space, space.trial_omega, space.trial_height, True, np.inf
            )
            new = _highest(trial_count, space.trial_height)
            if new <= f + 1e-4 * t * fall:
                taken = True
                break
            if halving == 0 and trial_count > 0:  # second order: the models are to agree with the peaks at the trial
                for p in range(count):
                    nearest, distance = 0, np.inf
                    for q in range(trial_count):
                        away = abs(np.log((space.trial_omega[q] + 1e-9) / (space.omega[p] + 1e-9)))
                        if away < distance:
                            nearest, distance = q, away
                    linear = 0.0
                    for i in range(k):
                        linear += space.gradient[p, i] * (trial[i] - point[i])
                    if distance < 0.5:
                        space.shifted[p] = space.trial_height[nearest] - f - linear
                corrected = _find_step(count, variables, space)
                if corrected <= 0.0:
                    _go_to(1.0, variables, space)
                    trial_count = _peaks_at(
                        trial, variables, program, port, space, space.trial_omega, space.trial_height, True, np.inf
                    )
                    new = _highest(trial_count, space.trial_height)
                    if new <= f + 1e-4 * fall:
                        taken = True
                        break
                for p in range(count):
                    space.shifted[p] = space.height[p] - f
                _find_step(count, variables, space)
            t *= 0.4
        if not taken:
            if fresh:
                break
            reset(space.hessian, 1.0)
            fresh = True
            continue
        fresh = False
        _fill_gradients(trial_count, variables, program, port, space, space.trial_omega, space.trial_gradient)
        _update(count, trial_count, space)
        for i in range(k):
            point[i] = trial[i]
        count, f = trial_count, new
        for p in range(count):
            space.omega[p], space.height[p] = space.trial_omega[p], space.trial_height[p]
            for i in range(k):
                space.gradient[p, i] = space.trial_gradient[p, i]
    return f


@part()
def _peak_space(k: int, leaves: int, program: Program, port: Port) -> PeakSpace:
    norms, n = norm_space(program, port), port.forms[0, DEGREE]
    return PeakSpace(
        norms,
        np.zeros(leaves),
        np.zeros(n + 1),
        np.zeros(n + 1),
        np.zeros(_MOST),
        np.zeros(_MOST),
        np.zeros((_MOST, k)),
        np.zeros(_MOST),
        np.zeros(_MOST),
        np.zeros((_MOST, k)),
        np.zeros(_MOST),
        np.zeros(_MOST),
        np.zeros((_MOST, k)),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros((k, k)),
        np.zeros((k, k)),
        np.zeros(k, np.int64),
        np.zeros(1, np.int64),
    )


@kernel("search of a network for a peak gain", typed=True)
def search_network_peak(
    samples: Matrix, tried: int, variables: Variables, program: Program, port: Port, points: Matrix, counts: Ints
) -> Floats:
    """Minima of a peak gain from the best of each `tried` rows of `samples`, which lie in the unit cube.

    `points` (starts, variables) and `counts` (starts,) are filled with the optima, as element values, and the numbers
    of evaluations; the result has the gains, infinite where all samples of a start are.
    """
    k, starts = samples.shape[1], points.shape[0]
    space = _peak_space(k, variables.of_leaf.size, program, port)
    result = np.zeros(starts)
    for start in range(starts):
        best, chosen = np.inf, -1
        space.count[0] = 0
        for row in range(start * tried, (start + 1) * tried):
            for i in range(k):
                space.trial[i] = variables.lower[i] + samples[row, i] * (variables.upper[i] - variables.lower[i])
            count = _peaks_at(
                space.trial, variables, program, port, space, space.trial_omega, space.trial_height, False, best
            )
            f = _highest(count, space.trial_height)
            if f < best:
                best, chosen = f, row
        if chosen < 0:
            result[start] = np.inf
            continue
        for i in range(k):
            space.point[i] = variables.lower[i] + samples[chosen, i] * (variables.upper[i] - variables.lower[i])
        result[start] = np.exp(_descend(variables, program, port, space))
        counts[start] = space.count[0]
        for i in range(k):
            points[start, i] = np.exp(space.point[i])
    return result
