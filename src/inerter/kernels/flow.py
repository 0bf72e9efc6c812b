"""The exact flow inside one mode as a Taylor series, and the first root of a polynomial."""

from __future__ import annotations

from typing import Any

from inerter.kernels.decorators import part
from inerter.kernels.lanes import in_groups, larger, largest_lane, multiply_add

Array = Any
CLOSE = 1e-15  # of the time since the piece began: a force that frees a friction must be met to rounding
_SMALL = 1e-18  # coefficients relative to the largest one: far below its rounding


@part(
    "void(float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], int64, float64, float64[::1])", borrowing=True
)
def knot_numbers(
    value: Array, slope: Array, value_before: Array, slope_before: Array, knot: int, length: float, out: Array
) -> None:
    """The cubic of every channel over one segment: z0, z1 - z0, and the slopes at both ends times the length."""
    for c in range(value.shape[1]):
        z0 = value[knot, c]
        out[4 * c] = z0
        out[4 * c + 1] = value_before[knot + 1, c] - z0
        out[4 * c + 2] = length * slope[knot, c]
        out[4 * c + 3] = length * slope_before[knot + 1, c]


@part("void(float64[::1], int64, int64, float64, float64, float64, float64[:,::1])", borrowing=True)
def inputs_from(numbers: Array, nr: int, nu: int, length: float, start: float, d: float, U: Array) -> None:
    """Coefficients (4, inputs) of roads' z, z', z'' and of forces in powers of (t - start) / d."""
    channels = nu - 2 * nr
    s, r = start / length, d / length
    for c in range(channels):
        p0, rise, b, e = numbers[4 * c], numbers[4 * c + 1], numbers[4 * c + 2], numbers[4 * c + 3]
        p1, p2, p3 = b, 3.0 * rise - 2.0 * b - e, b + e - 2.0 * rise
        c0 = p0 + s * (p1 + s * (p2 + s * p3))
        c1 = r * (p1 + s * (2.0 * p2 + s * 3.0 * p3))
        c2 = r * r * (p2 + 3.0 * s * p3)
        c3 = r * r * r * p3
        i = c if c < nr else c + 2 * nr
        U[0, i], U[1, i], U[2, i], U[3, i] = c0, c1, c2, c3
        if c < nr:
            i += nr
            U[0, i], U[1, i], U[2, i], U[3, i] = c1 / d, 2.0 * c2 / d, 3.0 * c3 / d, 0.0
            i += nr
            U[0, i], U[1, i], U[2, i], U[3, i] = 2.0 * c2 / (d * d), 6.0 * c3 / (d * d), 0.0, 0.0


@part("void(float64[::1], int64, int64, float64, float64, float64, float64[:,::1])", borrowing=True)
def input_sizes(numbers: Array, nr: int, nu: int, length: float, start: float, d: float, U: Array) -> None:
    """Sums of absolute values of what `inputs_from` adds up: where a velocity passes zero, its rounding does not."""
    s, r = start / length, d / length
    for c in range(nu - 2 * nr):
        p0, rise, b, e = abs(numbers[4 * c]), abs(numbers[4 * c + 1]), abs(numbers[4 * c + 2]), abs(numbers[4 * c + 3])
        p1, p2, p3 = b, 3.0 * rise + 2.0 * b + e, b + e + 2.0 * rise
        c0 = p0 + s * (p1 + s * (p2 + s * p3))
        c1 = r * (p1 + s * (2.0 * p2 + s * 3.0 * p3))
        c2 = r * r * (p2 + 3.0 * s * p3)
        c3 = r * r * r * p3
        i = c if c < nr else c + 2 * nr
        U[0, i], U[1, i], U[2, i], U[3, i] = c0, c1, c2, c3
        if c < nr:
            i += nr
            U[0, i], U[1, i], U[2, i] = c1 / d, 2.0 * c2 / d, 3.0 * c3 / d
            i += nr
            U[0, i], U[1, i] = 2.0 * c2 / (d * d), 6.0 * c3 / (d * d)


@part("float64(float64[::1], float64[::1], float64[::1], int64, int64)", borrowing=True)
def over_columns(row: Array, x: Array, u: Array, n: int, nu: int) -> float:
    """A row over a mode's columns times (state, inputs, 1)."""
    total = row[n + nu]
    for j in range(n):
        total += row[j] * x[j]
    for j in range(nu):
        total += row[n + j] * u[j]
    return float(total)


@part(borrowing=True, inside=True)
def series_lines(n: int, nu: int) -> int:
    """Lines of the matrix for `series`: columns of states, inputs and 1, and which rows are rates of states."""
    return n + nu + 2


@part(borrowing=True, inside=True)
def orders_in(X: Array) -> int:
    """Number of coefficients that there is room for in `series`."""
    return int((X.shape[0] - 1) // 2)


@part(borrowing=True, inside=True, fused=True)
def series(steps: Array, x: Array, U: Array, n: int, nu: int, d: float, X: Array) -> int:
    """Coefficients X[k] of the flow from x in powers of t / d, until they are below rounding; returns their number.

    The last lines of a mode's `steps` are columns of rates and guards. Guards have coefficients, too, one fewer: those
    of order k are behind the states of X[orders + 1 + k], where `orders_in` X. One row of X is work space.
    """
    last, height, width = orders_in(X), series_lines(n, nu), steps.shape[1]
    lines = in_groups(steps, (steps.shape[0] - height) * width, (height, width))
    groups = in_groups(X, 0, X.shape)
    for i in range(n):
        X[0, i] = x[i]
    for g in range(groups.shape[1]):
        groups[last, g] = abs(groups[0, g])  # the largest coefficient so far
    for k in range(1, last):
        quiet = True
        for g in range(groups.shape[1]):
            total, other = lines[n + nu, g] * (1.0 if k == 1 else 0.0), lines[n + nu, g] * 0.0
            if k <= 4:
                for j in range(nu):
                    total = multiply_add(lines[n + j, g], U[k - 1, j], total)
            for j in range(0, n - 1, 2):  # two sums, which need not wait for each other
                total = multiply_add(lines[j, g], X[k - 1, j], total)
                other = multiply_add(lines[j + 1, g], X[k - 1, j + 1], other)
            if n % 2:
                other = multiply_add(lines[n - 1, g], X[k - 1, n - 1], other)
            total = total + other
            groups[last + k, g] = total
            total = total * (lines[n + nu + 1, g] * (d / k))
            groups[k, g] = total
            size = abs(total)
            largest = larger(size, groups[last, g])
            groups[last, g] = largest
            if largest_lane(size - largest * _SMALL) > 0.0:
                quiet = False
        if quiet and k > 4:  # all further ones follow from these
            return k + 1
    return int(last)


@part("float64(float64[:,::1], int64, int64, float64)", borrowing=True)
def polynomial(coefficients: Array, count: int, i: int, s: float) -> float:
    """The polynomial with coefficients[0, i], ..., coefficients[count - 1, i]."""
    total = coefficients[count - 1, i]
    for j in range(count - 2, -1, -1):
        total = total * s + coefficients[j, i]
    return float(total)


@part("float64(float64[::1], int64, float64)", borrowing=True, fused=True)
def value_at(c: Array, count: int, s: float) -> float:
    """The polynomial with coefficients c[0], ..., c[count - 1]."""
    total = c[count - 1]
    for k in range(count - 2, -1, -1):
        total = total * s + c[k]
    return float(total)


@part("float64(float64[::1], int64, float64)", borrowing=True, fused=True)
def slope_at(c: Array, count: int, s: float) -> float:
    """Derivative of the polynomial with coefficients c[0], ..., c[count - 1]."""
    total = 0.0
    for k in range(count - 1, 0, -1):
        total = total * s + k * c[k]
    return total


@part("float64(float64[::1], int64, float64, float64, float64, float64, float64)", borrowing=True)
def polish(c: Array, count: int, a: float, b: float, at_a: float, at_b: float, bend: float) -> float:
    """The root in [a, b] of a polynomial that is positive at a and not at b: Newton's steps, or else halving.

    They begin where the line through both ends is zero, and end with the step after which the second derivative, at
    most `bend`, leaves no more than rounding.
    """
    s = a + (b - a) * at_a / (at_a - at_b)
    if not (a < s < b):
        s = 0.5 * (a + b)
    for _ in range(80):
        value = value_at(c, count, s)
        if value > 0.0:
            a = s
        else:
            b = s
        slope = slope_at(c, count, s)
        after = s - value / slope if slope < 0.0 else a
        if slope < 0.0 and abs(after - s) <= CLOSE * s:  # also if it is an end of the interval now
            return after
        if not (a < after < b):
            after = 0.5 * (a + b)
        elif bend * (after - s) ** 2 <= -CLOSE * slope * after:
            return after
        if b - a <= CLOSE * b:
            return after
        s = after
    return s


@part("float64(float64[::1], int64, float64[::1])", borrowing=True)
def first_root(c: Array, count: int, ends: Array) -> float:
    """Smallest s in [0, 1] from which on the polynomial is negative; 2 if there is none.

    Between two points where it is positive it stays so if it is above the sway that its second derivative allows;
    otherwise the interval is halved, down to where the sway is below rounding (it may touch zero, but not cross).
    """
    if not (c[0] > 0.0):
        return 0.0
    bend, size = 0.0, c[0]
    for k in range(1, count):
        bend += k * (k - 1) * abs(c[k])
        size += abs(c[k])
    a, at_a, depth = 0.0, c[0], 1
    ends[0] = 1.0
    while depth > 0:
        b = ends[depth - 1]
        at_b = value_at(c, count, b)
        width = b - a
        sway = 0.125 * bend * width * width
        if at_b > 0.0 and (min(at_a, at_b) > sway or sway < 1e-16 * size):
            a, at_a = b, at_b
            depth -= 1
        elif at_b <= 0.0 and (slope_at(c, count, 0.5 * (a + b)) < -0.5 * bend * width or width < 1e-15):
            return polish(c, count, a, b, at_a, at_b, bend)
        elif depth == ends.shape[0]:
            a, at_a = b, at_b
            depth -= 1
        else:
            ends[depth] = 0.5 * (a + b)
            depth += 1
    return 2.0
