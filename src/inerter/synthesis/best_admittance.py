"""The positive-real admittance of a given degree with the lowest index: a bound on all networks of that degree.

By the positive-real lemma, with the storage function of lowest rank as coordinates, every proper positive-real function
of degree n has the form

    Y(s) = W^2 / 2 + (B + W L)' (s I - J + L L' / 2)^-1 B,    2 Re Y(j w) = |W + L' (j w I - J + L L' / 2)^-1 B|^2,

where J is skew. An orthogonal change of states makes J tridiagonal and B a multiple of the first unit vector, which
leaves 2 n + 1 numbers (Anderson and Vongpanitlerd 1973, "Network Analysis and Synthesis"). All of them are free, so the
search has no constraint, and functions with Re Y = 0 at some frequency lie inside its region. Poles at zero and at
infinity, k / s and b s, are limits of such functions and are searched on their own; so are those of the impedance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from inerter.errors import SynthesisError
from inerter.formatting import format_quantity
from inerter.networks.elements import Network
from inerter.synthesis.realise import realise
from inerter.validation import check_positive, check_whole, is_number
from inerter.work.progress import report

Floats = NDArray[Any]  # of float64, or of fractions in exact arithmetic
Index = Callable[[Floats, Floats], float]  # of numerator and denominator, highest power of s first
Gradient = Callable[[Floats, Floats], tuple[float, Floats, Floats]]  # the index, and its gradients over both

_SAMPLES = 30  # random admittances for each start, the best of which it is
_SPREAD = 2.0  # standard deviation of the search variables; the numbers of the formula are their hyperbolic sines
_WEAK = 0.5  # standard deviation of search variables that are added to a minimum
_LARGEST = 30.0  # search variable
_IDLE = 1e-11  # relative change of the index by a variable that is set to zero
_EQUAL = 1e-10  # relative difference of values between which the simpler admittance is taken
_STEP = 1e-30  # imaginary step of a search variable
_AGREEMENT = 1e-6  # relative difference of values of converged starts


@dataclass(frozen=True)
class BestAdmittance:
    """Admittance numerator / denominator, highest power of s first, with the lowest `value` of all starts."""

    value: float
    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    n_starts: int  # at the highest degree
    n_converged: int  # of these, starts that ended at this value

    def realise(self) -> Network:
        """A network with this admittance; raises `SynthesisError` if none was found."""
        return realise(self.numerator, self.denominator)


def best_admittance(
    index: Index,
    degree: int,
    *,
    damping: float,
    omega: float,
    seed: int = 0,
    starts: int = 42,
    gradient: Gradient | None = None,
) -> BestAdmittance:
    """Minimise an index over all positive-real admittances of at most a degree, from many starts.

    `index(numerator, denominator)` is the index to minimise, nan or infinite where it does not exist. The starts have
    sizes around `damping` [N s/m] and corner frequencies around `omega` [rad/s], over some two decades; every other one
    is a minimum of the degree below with a further state. The highest degree has `starts` of them, each one below half
    as many, and at least one of each form. `gradient` gives the index and its gradients over numerator and denominator;
    without it, differences are taken.

    Raises `SynthesisError` for invalid arguments, or if the index exists at no start.
    """
    check_whole(SynthesisError, "The degree of an admittance", degree)
    check_whole(SynthesisError, "The number of starts", starts, 1)
    check_positive(SynthesisError, "The typical damping", damping, "N s/m")
    check_positive(SynthesisError, "The typical frequency", omega, "rad/s")

    degree, starts = int(degree), int(starts)
    objective = _Objective(index, gradient, damping, omega)
    rng = np.random.default_rng(seed)
    found: list[_Minimum] = []
    latest: list[_Minimum] = []
    with np.errstate(over="ignore", invalid="ignore"):
        for order in range(degree + 1):
            latest = _search(objective, order, max(starts >> degree - order, 1), rng, latest)
            found += latest
    least = min(each.value for each in found)
    if not np.isfinite(least):
        raise SynthesisError(
            f"The index does not exist for any of {len(found) * _SAMPLES} admittances up to degree {degree} around "
            f"{format_quantity(damping, 'N s/m')} and {format_quantity(omega, 'rad/s')}. Give other typical values, "
            "or a higher degree."
        )
    equal = [each for each in found if each.value <= least + _EQUAL * abs(least)]
    best = min(equal, key=lambda each: each.family.size)  # which saves elements
    numerator, denominator = _without_idle(index, *best.family.polynomials(best.x, damping, omega, exact=True))
    converged = sum(each.value <= least + _AGREEMENT * abs(least) for each in latest)
    return BestAdmittance(best.value, tuple(numerator.tolist()), tuple(denominator.tolist()), len(latest), converged)


def _without_idle(index: Index, numerator: Floats, denominator: Floats) -> tuple[Floats, Floats]:
    """The polynomials with coefficients of zero where that changes nothing, which saves elements."""
    n, least = len(numerator), index(numerator, denominator)
    both = np.concatenate([numerator, denominator])
    for i in np.flatnonzero(both):
        changed = np.where(np.arange(both.size) == i, 0.0, both)
        if not (changed[:n].any() and changed[n:].any()):
            continue
        if index(changed[:n], changed[n:]) <= least + _IDLE * abs(least):
            with suppress(SynthesisError):
                realise(changed[:n], changed[n:])  # which also takes what is positive real but for its rounding
                both = changed
    return np.trim_zeros(both[:n], "f"), np.trim_zeros(both[n:], "f")


@dataclass(frozen=True)
class _Family:
    """Admittances, or impedances, that are proper and of a degree, plus a pole at zero, at infinity, both or none."""

    degree: int
    at_zero: bool = False
    at_infinity: bool = False
    is_impedance: bool = False

    @property
    def size(self) -> int:
        """Number of search variables."""
        return 2 * self.degree + 1 + self.at_zero + self.at_infinity

    def extend(self, x: Floats, rng: np.random.Generator) -> Floats:
        """Search variables with a further state, which is weakly coupled to the others, from those of a degree less."""
        n = self.degree - 1
        coupling, damping = _WEAK * rng.standard_normal((2, 1))
        return np.concatenate([x[:n], coupling, x[n : 2 * n], damping, x[2 * n :]])

    def polynomials(self, x: Floats, damping: float, omega: float, exact: bool = False) -> tuple[Floats, Floats]:
        """Numerators and denominators from search variables (..., size); rounded at the end only if `exact`."""
        n, inside = self.degree, abs(x.real) <= _LARGEST
        numbers = np.sinh(np.where(inside, x, np.clip(x.real, -_LARGEST, _LARGEST)))
        if exact:  # cancellation would cost more than the rounding of the result, and positive-realness with it
            numbers = np.array([Fraction(number) for number in numbers.tolist()])
        J, B = np.zeros((*x.shape[:-1], n, n), numbers.dtype), np.zeros((*x.shape[:-1], n), numbers.dtype)
        L, W = numbers[..., n : 2 * n], numbers[..., 2 * n : 2 * n + 1]
        J[..., range(n - 1), range(1, n)] = numbers[..., 1:n]
        B[..., :1] = numbers[..., : min(n, 1)]
        A = J - J.swapaxes(-1, -2) - L[..., :, None] * L[..., None, :] / 2
        top, bottom = _to_polynomials(A, B, B + W * L, W**2 / 2)
        more = [numbers[..., i : i + 1] ** 2 for i in range(2 * n + 1, self.size)]
        if self.at_infinity:
            top = _pad(top, before=1) + more.pop() * _pad(bottom, after=1)
        if self.at_zero:
            top = _pad(top, after=1) + more.pop() * _pad(bottom, before=self.at_infinity + 1)
            bottom = _pad(bottom, after=1)
        if self.is_impedance:
            top, bottom = bottom, top
        return damping * _stretch(top, omega), _stretch(bottom, omega)

    def with_slopes(self, x: Floats, damping: float, omega: float) -> tuple[Floats, Floats, Floats, Floats]:
        """Numerator, denominator and their derivatives (size, coefficients) over the variables, by complex steps."""
        steps = np.eye(self.size + 1, self.size, -1) * _STEP
        top, bottom = self.polynomials(x + 1j * steps, damping, omega)
        return top[0].real, bottom[0].real, top[1:].imag / _STEP, bottom[1:].imag / _STEP


def _families(degree: int) -> list[_Family]:
    """All families of a degree; without poles, the impedances are the inverses of the admittances."""
    poles = [(at_zero, at_infinity) for at_zero in (False, True) for at_infinity in (False, True)]
    return [
        _Family(degree - sum(each), *each, is_impedance)
        for each in poles
        for is_impedance in ((False, True) if any(each) else (False,))
        if sum(each) <= degree
    ]


def _to_polynomials(A: Floats, B: Floats, C: Floats, D: Floats) -> tuple[Floats, Floats]:
    """Numerators and denominators of D + C' (s I - A)^-1 B by the method of Leverrier and Faddeev."""
    n = A.shape[-1]
    identity = np.eye(n, dtype=int).astype(A.dtype)
    top, bottom, adjugate = [D], [D**0], identity
    for k in range(1, n + 1):
        turned = A @ adjugate
        bottom.append(-turned.diagonal(axis1=-2, axis2=-1).sum(axis=-1, keepdims=True) / k)
        top.append((C * (adjugate @ B[..., None])[..., 0]).sum(axis=-1, keepdims=True) + D * bottom[-1])
        adjugate = turned + bottom[-1][..., None] * identity
    return np.concatenate(top, axis=-1), np.concatenate(bottom, axis=-1)


def _pad(p: Floats, before: int = 0, after: int = 0) -> Floats:
    """Coefficients with zeros before them, or after them."""
    result = np.zeros((*p.shape[:-1], before + p.shape[-1] + after), p.dtype)
    result[..., before : before + p.shape[-1]] = p
    return result


def _stretch(p: Floats, omega: float) -> Floats:
    """Polynomial p(s / omega)."""
    return p.astype(complex if np.iscomplexobj(p) else float) / omega ** np.arange(p.shape[-1] - 1.0, -1.0, -1.0)


@dataclass(frozen=True)
class _Objective:
    """The index over the search variables of a family; infinite where it does not exist."""

    index: Index
    gradient: Gradient | None
    damping: float
    omega: float

    def values(self, family: _Family, points: Floats) -> list[float]:
        """Values at rows of search variables."""
        several = zip(*family.polynomials(points, self.damping, self.omega), strict=True)
        values = [self.index(numerator, denominator) for numerator, denominator in several]
        return [float(value) if is_number(value) else np.inf for value in values]

    def value(self, family: _Family, x: Floats) -> float:
        """The value at search variables."""
        return self.values(family, x[None])[0]

    def with_slopes(self, family: _Family, x: Floats) -> tuple[float, Floats]:
        """The value and its gradient over the variables, which is zero where the value is infinite."""
        assert self.gradient is not None
        numerator, denominator, top_slopes, bottom_slopes = family.with_slopes(x, self.damping, self.omega)
        value, top, bottom = self.gradient(numerator, denominator)
        if not is_number(value):
            return np.inf, np.zeros(family.size)
        return float(value), top_slopes @ top + bottom_slopes @ bottom


@dataclass(frozen=True)
class _Minimum:
    """A local minimum: the value, its search variables and their family."""

    value: float
    x: Floats
    family: _Family


def _search(
    objective: _Objective, degree: int, starts: int, rng: np.random.Generator, lower: Sequence[_Minimum]
) -> list[_Minimum]:
    """Local minima of a degree, from random samples and in turn from the minima of the degree below."""
    families = _families(degree)
    found: list[_Minimum] = []
    count = max(starts, len(families))
    for i in range(count):
        turn, family = i // len(families), families[i % len(families)]
        known = [each for each in lower if replace(each.family, degree=each.family.degree + 1) == family]
        if turn % 2 and known:
            known.sort(key=lambda each: each.value)
            x = family.extend(known[turn // 2 % len(known)].x, rng)
        else:
            samples = _SPREAD * rng.standard_normal((_SAMPLES, family.size))
            x = samples[np.argmin(objective.values(family, samples))]
        found.append(_minimise(objective, family, x))
        best = min(each.value for each in found)
        report(f"admittances of degree {degree}", i + 1, count, best=best if np.isfinite(best) else None)
    return found


def _minimise(objective: _Objective, family: _Family, x: Floats) -> _Minimum:
    """The local minimum below a start; variables that do not matter there are zero, which saves elements."""
    least = objective.value(family, x)
    if np.isfinite(least) and least != 0.0:
        size = abs(least)

        def relative_value(x: Floats) -> float:
            return objective.value(family, x) / size

        def relative_value_with_slopes(x: Floats) -> tuple[float, Floats]:
            value, slopes = objective.with_slopes(family, x)
            return value / size, slopes / size

        exact: Any = objective.gradient is not None
        searched: Any = relative_value_with_slopes if exact else relative_value
        result = minimize(searched, x, method="BFGS", jac=exact, options={"gtol": 1e-9, "maxiter": 500})
        if objective.value(family, result.x) < least:
            least, x = objective.value(family, result.x), result.x
        for i in range(len(x)):
            changed = np.where(np.arange(len(x)) == i, 0.0, x)
            value = objective.value(family, changed)
            if value <= least + _IDLE * abs(least):
                least, x = value, changed
    return _Minimum(least, x, family)
