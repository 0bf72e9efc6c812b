"""Squared H2 norm of a transfer function b(s)/a(s), its gradient and its rounding error, compiled.

The algorithm is that of Astrom, Jury and Agniel (1970): with the Routh array of a(s), the squared norm is a sum of n
terms beta_j^2 / (2 alpha_j), and no equation is solved. Coefficients are in descending powers as those of
`numpy.polyval`: a[0] s^n + ... + a[n], and b[0] s^(n-1) + ... + b[n-1], so that b/a is strictly proper.

Step j eliminates the leading coefficient: alpha_j = a[j] / a[j+1] and beta_j = b[j] / a[j+1], and every second of the
remaining coefficients of a and b is reduced by that multiple of its right neighbour in a. By the criterion of Routh,
a(s) is stable if and only if all alpha_j are positive.

`forward` computes the norm and keeps each step; `backward` differentiates it with respect to all coefficients (reverse
mode), and bounds its rounding error to first order: the sum over all operations of the derivative of the result with
respect to the rounded number, times its rounding.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from inerter.kernels.arrays import Floats, Matrix
from inerter.kernels.decorators import part
from inerter.kernels.double_double import add_product
from inerter.kernels.lanes import is_between

Array = Any
_EPS = 1.2e-16  # relative rounding error of an operation in double precision
_FINE_EPS = 1e-30  # bound of that in double-double arithmetic
_FIRST_ORDER = 0.1  # largest relative error of an alpha_j for which the bound of the result is trusted


class Recursion(NamedTuple):
    """Coefficients of b(s)/a(s) of degree n, and work space of its recursion.

    The first n + 1 entries of each vector are used. Before `fine_forward` the coefficients are a + a_low and b + b_low.
    """

    a: Floats  # denominator, overwritten by the recursion
    b: Floats  # numerator, overwritten
    a_low: Floats  # low parts of double-double coefficients
    b_low: Floats
    steps: Matrix  # (n, n + 1): a before each step
    before: Matrix  # (n, n + 1): b before each step
    alpha: Floats  # (n)
    beta: Floats  # (n)
    a_adjoint: Floats  # derivatives of the squared norm with respect to the coefficients, filled by `backward`
    b_adjoint: Floats
    a_error: Floats  # absolute error bounds of a: of the coefficients as given, then of those after each step


@part(borrowing=True)
def _spread_errors(j: int, n: int, alpha: Any, space: Recursion, eps: float) -> Any:
    """Update the error bounds of a for step j, called before a itself is; 1.0 if alpha is accurate enough, else 0.0.

    Accurate enough means that the first-order bound of `backward` holds (`_FIRST_ORDER`).
    """
    a, errors = space.a, space.a_error
    relative = (errors[j] + alpha * errors[j + 1]) / a[j] + eps
    for i in range(j + 2, n, 2):
        product = abs(alpha * a[i + 1])
        errors[i] += relative * product + alpha * errors[i + 1] + eps * (abs(a[i]) + 2.0 * product)
    return is_between(relative, -1.0, _FIRST_ORDER)


@part(borrowing=True)
def forward(n: int, space: Recursion) -> Any:
    """Squared H2 norm in double precision; inf or nan where a(s) is not stable, or where rounding leaves that open."""
    a, b, steps, before = space.a, space.b, space.steps, space.before
    total, stable = 0.0, 1.0
    for j in range(n):
        for i in range(j, n + 1):
            steps[j, i] = a[i]
        for i in range(j, n):
            before[j, i] = b[i]
        alpha, beta = a[j] / a[j + 1], b[j] / a[j + 1]
        stable = stable * is_between(alpha, 0.0, 1e300) * _spread_errors(j, n, alpha, space, _EPS)
        space.alpha[j], space.beta[j] = alpha, beta
        total += 0.5 * beta * beta / alpha
        for i in range(j + 2, n, 2):
            a[i] -= alpha * a[i + 1]
            b[i] -= beta * a[i + 1]
    return total / stable


@part(borrowing=True)
def fine_forward(n: int, space: Recursion) -> Any:
    """Squared H2 norm in double-double arithmetic, some 32 digits; inf or nan as `forward`."""
    a, b, a_low, b_low, steps, before = space.a, space.b, space.a_low, space.b_low, space.steps, space.before
    total, rest, stable = 0.0, 0.0, 1.0
    for j in range(n):
        for i in range(j, n + 1):
            steps[j, i] = a[i]
        for i in range(j, n):
            before[j, i] = b[i]
        pivot, pivot_low = a[j + 1], a_low[j + 1]
        alpha, alpha_low = _divide(a[j], a_low[j], pivot, pivot_low)
        beta, beta_low = _divide(b[j], b_low[j], pivot, pivot_low)
        stable = stable * is_between(alpha, 0.0, 1e300) * _spread_errors(j, n, alpha, space, _FINE_EPS)
        space.alpha[j], space.beta[j] = alpha, beta
        square, square_low = add_product(0.0, 0.0, beta, beta)
        term, term_low = _divide(square, square_low + 2.0 * beta * beta_low, alpha, alpha_low)
        total, rest = add_product(total, rest, 0.5, term)
        rest += 0.5 * term_low
        for i in range(j + 2, n, 2):
            high, low = add_product(a[i], a_low[i], -alpha, a[i + 1])
            low -= alpha * a_low[i + 1] + alpha_low * a[i + 1]
            fine, fine_low = add_product(b[i], b_low[i], -beta, a[i + 1])
            fine_low -= beta * a_low[i + 1] + beta_low * a[i + 1]
            a[i] = high + low
            a_low[i] = low - (a[i] - high)
            b[i] = fine + fine_low
            b_low[i] = fine_low - (b[i] - fine)
    return (total + rest) / stable


@part(borrowing=True)
def _divide(p: Any, p_low: Any, q: Any, q_low: Any) -> Any:
    """High and low part of the quotient (p + p_low) / (q + q_low) of double-double numbers."""
    high = p / q
    rest, low = add_product(p, p_low, -high, q)
    more = (rest + (low - high * q_low)) / q
    total = high + more
    return total, more - (total - high)


@part(borrowing=True)
def backward(n: int, space: Recursion, fine: bool) -> Any:
    """Fill `a_adjoint` and `b_adjoint` with the gradient of the squared norm; returns a bound of its rounding error.

    The bound is absolute and counts the roundings of the recursion; those of the coefficients as given are their errors
    times the gradient. Call after `forward`, or with `fine` after `fine_forward`.
    """
    a_, b_, steps, before = space.a_adjoint, space.b_adjoint, space.steps, space.before
    eps = _FINE_EPS if fine else _EPS
    for i in range(n + 1):
        a_[i] = 0.0
        b_[i] = 0.0
    error = 0.0
    for j in range(n - 1, -1, -1):
        a = steps[j]
        alpha, beta, pivot = space.alpha[j], space.beta[j], a[j + 1]
        term = 0.5 * beta * beta / alpha
        alpha_, beta_ = -term / alpha, beta / alpha
        error += 3.0 * eps * term
        for i in range(j + 2, n, 2):
            p, q = a_[i], b_[i]
            alpha_ -= p * a[i + 1]
            beta_ -= q * a[i + 1]
            a_[i + 1] -= alpha * p + beta * q
            error += eps * (abs(p) * (abs(a[i]) + 2.0 * abs(alpha * a[i + 1])))
            error += eps * (abs(q) * (abs(before[j, i]) + 2.0 * abs(beta * a[i + 1])))
        error += eps * (abs(alpha_ * alpha) + abs(beta_ * beta))
        a_[j] = alpha_ / pivot
        a_[j + 1] -= (alpha_ * alpha + beta_ * beta) / pivot
        b_[j] = beta_ / pivot
    return error
