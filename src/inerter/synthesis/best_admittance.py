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

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from inerter.errors import SynthesisError
from inerter.networks.elements import Network
from inerter.synthesis.realise import realise
from inerter.validation import check_positive, is_number

Floats = NDArray[Any]  # of float64, or of fractions in exact arithmetic
Index = Callable[[Floats, Floats], float]  # of numerator and denominator, highest power of s first
Objective = Callable[[Floats], float]

_SAMPLES = 30  # random admittances for each start, the best of which it is
_SPREAD = 2.0  # standard deviation of the search variables; the numbers of the formula are their hyperbolic sines
_LARGEST = 30.0  # search variable
_IDLE = 1e-11  # relative change of the index by a variable that is set to zero
_EQUAL = 1e-10  # relative difference of values between which the simpler admittance is taken
_AGREEMENT = 1e-6  # relative difference of values of converged starts


@dataclass(frozen=True)
class BestAdmittance:
    """Admittance numerator / denominator, highest power of s first, with the lowest `value` of all starts."""

    value: float
    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    n_starts: int
    n_converged: int  # starts that ended at this value

    def realise(self) -> Network:
        """A network with this admittance; raises `SynthesisError` if none was found."""
        return realise(self.numerator, self.denominator)


def best_admittance(
    index: Index, degree: int, *, damping: float, omega: float, seed: int = 0, starts: int = 42
) -> BestAdmittance:
    """Minimise an index over all positive-real admittances of at most a degree, from many random starts.

    `index(numerator, denominator)` is the index to minimise, nan or infinite where it does not exist. The starts have
    sizes around `damping` [N s/m] and corner frequencies around `omega` [rad/s], over some two decades.

    Raises `SynthesisError` for invalid arguments, or if the index exists at no start.
    """
    if not isinstance(degree, int) or isinstance(degree, bool) or degree < 0:
        raise SynthesisError(f"The degree of an admittance must be a non-negative integer, got {degree!r}.")
    if not isinstance(starts, int) or isinstance(starts, bool) or starts < 1:
        raise SynthesisError(f"The number of starts must be a positive integer, got {starts!r}.")
    check_positive(SynthesisError, "The typical damping", damping, "N s/m")
    check_positive(SynthesisError, "The typical frequency", omega, "rad/s")
    rng = np.random.default_rng(seed)
    families = _families(degree)
    found: list[tuple[float, Floats, _Family]] = []
    for i in range(max(starts, len(families))):
        family = families[i % len(families)]

        def objective(x: Floats, family: _Family = family) -> float:
            value = index(*family.polynomials(x, damping, omega))
            return float(value) if is_number(value) else np.inf

        with np.errstate(over="ignore", invalid="ignore"):
            found.append((*_minimise(objective, family.size, rng), family))
    least = min(value for value, _, _ in found)
    if not np.isfinite(least):
        raise SynthesisError(
            f"The index exists for none of {len(found) * _SAMPLES} admittances of degree {degree} around {damping:g} "
            f"N s/m and {omega:g} rad/s. Give other typical values, or a higher degree."
        )
    equal = [each for each in found if each[0] <= least + _EQUAL * abs(least)]
    least, x, family = min(equal, key=lambda each: each[2].size)  # which saves elements
    numerator, denominator = family.polynomials(x, damping, omega, exact=True)
    converged = sum(value <= least + _AGREEMENT * abs(least) for value, _, _ in found)
    return BestAdmittance(least, tuple(numerator.tolist()), tuple(denominator.tolist()), len(found), converged)


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

    def polynomials(self, x: Floats, damping: float, omega: float, exact: bool = False) -> tuple[Floats, Floats]:
        """Numerator and denominator from search variables; rounded at the end only if `exact`."""
        n, numbers = self.degree, np.sinh(np.clip(x, -_LARGEST, _LARGEST))
        if exact:  # cancellation would cost more than the rounding of the result, and positive-realness with it
            numbers = np.array([Fraction(number) for number in numbers.tolist()])
        J, B, L, W = np.zeros((n, n), numbers.dtype), np.zeros(n, numbers.dtype), numbers[n : 2 * n], numbers[2 * n]
        J[range(n - 1), range(1, n)] = numbers[1:n]
        B[:1] = numbers[:1]
        top, bottom = _to_polynomials(J - J.T - np.outer(L, L) / 2, B, B + W * L, W**2 / 2)
        more = list(numbers[2 * n + 1 :] ** 2)
        if self.at_infinity:
            top = np.polyadd(top, np.polymul([more.pop(), 0.0], bottom))
        if self.at_zero:
            top, bottom = np.polyadd(np.polymul(top, [1.0, 0.0]), more.pop() * bottom), np.polymul(bottom, [1.0, 0.0])
        if self.is_impedance:
            top, bottom = bottom, top
        return damping * _stretch(top, omega), _stretch(bottom, omega)


def _families(degree: int) -> list[_Family]:
    """All families of a degree; without poles, the impedances are the inverses of the admittances."""
    poles = [(at_zero, at_infinity) for at_zero in (False, True) for at_infinity in (False, True)]
    return [
        _Family(degree - sum(each), *each, is_impedance)
        for each in poles
        for is_impedance in ((False, True) if any(each) else (False,))
        if sum(each) <= degree
    ]


def _to_polynomials(A: Floats, B: Floats, C: Floats, D: float) -> tuple[Floats, Floats]:
    """Numerator and denominator of D + C' (s I - A)^-1 B by the method of Leverrier and Faddeev."""
    n = len(A)
    top: list[Any] = [D]
    bottom: list[Any] = [D**0]
    adjugate: Floats = np.eye(n, dtype=int)
    identity = adjugate
    for k in range(1, n + 1):
        turned = A @ adjugate
        bottom.append(-turned.trace() / k)
        top.append(C @ adjugate @ B + D * bottom[-1])
        adjugate = turned + bottom[-1] * identity
    return np.array(top), np.array(bottom)


def _stretch(p: Floats, omega: float) -> Floats:
    """Polynomial p(s / omega)."""
    return p.astype(float) / omega ** np.arange(len(p) - 1.0, -1.0, -1.0)


def _minimise(objective: Objective, size: int, rng: np.random.Generator) -> tuple[float, Floats]:
    """The lowest value and its variables: the best of random samples, improved by BFGS."""
    samples = _SPREAD * rng.standard_normal((_SAMPLES, size))
    values = [objective(x) for x in samples]
    best = int(np.argmin(values))
    least, x = values[best], samples[best]
    if not np.isfinite(least) or least == 0.0:
        return least, x

    def scaled(x: Floats) -> float:
        return objective(x) / abs(least)

    result = minimize(scaled, x, method="BFGS", options={"gtol": 1e-9, "maxiter": 500})
    found = objective(result.x)
    return _without_idle(objective, found, result.x) if found < least else (least, x)


def _without_idle(objective: Objective, least: float, x: Floats) -> tuple[float, Floats]:
    """The same minimum with variables that do not matter set to zero, which saves elements of the network."""
    limit = least + _IDLE * abs(least)
    for i in range(len(x)):
        changed = np.where(np.arange(len(x)) == i, 0.0, x)
        value = objective(changed)
        if value <= limit:
            least, x = value, changed
    return least, x
