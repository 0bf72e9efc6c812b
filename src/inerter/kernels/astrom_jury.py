"""Squared H2 norm of b(s)/a(s), its adjoint and its rounding error, compiled (Astrom, Jury and Agniel, 1970).

The recursion divides a(s) by its own odd and even part; all quotients alpha are positive if and only if a is stable.
Coefficients run from the highest power downwards, a[0] s^n + ... + a[n] and b[0] s^(n-1) + ... + b[n-1]. The reverse
pass gives the derivative of the result with respect to every coefficient of every step, and so also how far the
roundings of each step may move it, at first order.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from inerter.kernels.arrays import Floats, Matrix
from inerter.kernels.decorators import part
from inerter.kernels.double_double import add_product
from inerter.kernels.lanes import is_between

Array = Any
_EPS = 1.2e-16  # relative error of one operation
_FINE_EPS = 1e-30  # the same in twice the precision, with room to spare
_FIRST_ORDER = 0.1  # relative error of a quotient alpha up to which that of the result is one of first order


class Recursion(NamedTuple):
    """Coefficients of a fraction, the steps of its recursion, and adjoints."""

    a: Floats  # overwritten
    b: Floats
    a_low: Floats
    b_low: Floats
    steps: Matrix  # (degree, degree + 1): a before each step
    before: Matrix  # the same of b
    alpha: Floats
    beta: Floats
    a_adjoint: Floats
    b_adjoint: Floats
    a_error: Floats  # bounds of the error of a, overwritten


@part(borrowing=True)
def _spread_errors(j: int, n: int, alpha: Any, space: Recursion, eps: float) -> Any:
    """Bounds of the error of a after step j, whose a is still there; 1 if that of alpha is small, else 0."""
    a, errors = space.a, space.a_error
    relative = (errors[j] + alpha * errors[j + 1]) / a[j] + eps
    for i in range(j + 2, n, 2):
        product = abs(alpha * a[i + 1])
        errors[i] += relative * product + alpha * errors[i + 1] + eps * (abs(a[i]) + 2.0 * product)
    return is_between(relative, -1.0, _FIRST_ORDER)


@part(borrowing=True)
def forward(n: int, space: Recursion) -> Any:
    """Squared norm; infinite or nan where a is not stable, which rounding may have made it seem, or may hide."""
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
    """Squared norm in twice the precision; see `forward`."""
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
    """(p + p_low) / (q + q_low) as two numbers."""
    high = p / q
    rest, low = add_product(p, p_low, -high, q)
    more = (rest + (low - high * q_low)) / q
    total = high + more
    return total, more - (total - high)


@part(borrowing=True)
def backward(n: int, space: Recursion, fine: bool) -> Any:
    """Fill the adjoints of a and b, and give the rounding error of the squared norm by the recursion itself."""
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
