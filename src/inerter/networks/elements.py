"""Two-terminal elements and the algebra that joins them: `|` in parallel, `-` in series.

Signs: an element's elongation is the displacement of its upper end less that of its lower end; its force is positive
in tension, when it pulls its ends together.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.checks import is_number
from inerter.errors import DesignError, NetworkError

Complex = NDArray[np.complex128]

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(frozen=True)
class Free:
    """A value that an optimiser may choose between two bounds. Two of the same name are one variable."""

    lower: float
    upper: float
    name: str | None = None

    def __post_init__(self) -> None:
        for bound in (self.lower, self.upper):
            if not is_number(bound):
                raise NetworkError(f"A bound of a free value must be a finite number, got {bound!r}.")
        if not 0.0 <= self.lower < self.upper:
            raise NetworkError(
                f"The bounds of a free value must satisfy 0 <= lower < upper, got lower = {self.lower:g} and "
                f"upper = {self.upper:g}. Swap them if they are reversed; to fix the value, give the number itself."
            )
        _check_name(self.name)


def free(lower: float, upper: float, name: str | None = None) -> Free:
    """A design variable between `lower` and `upper`, in the unit of the element that it is given to.

    Raises `NetworkError` unless 0 <= lower < upper, both finite.
    """
    return Free(lower, upper, name)


Value = float | Free


class Network:
    """Anything with two ends that can be mounted: an element, or elements joined by `|` and `-`."""

    def __or__(self, other: Network) -> Parallel:
        return Parallel((*_parts(self, Parallel), *_parts(other, Parallel)))

    def __sub__(self, other: Network) -> Series:
        return Series((*_parts(self, Series), *_parts(other, Series)))

    def __ror__(self, other: object) -> Parallel:
        return Parallel((*_parts(other, Parallel), *_parts(self, Parallel)))

    def __rsub__(self, other: object) -> Series:
        return Series((*_parts(other, Series), *_parts(self, Series)))

    def elements(self) -> Iterator[Element]:
        """The elements in the order in which they are written."""
        raise NotImplementedError

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        """Numerator and denominator of the admittance at `s`, up to a common factor; neither is ever infinite."""
        raise NotImplementedError

    def admittance(self, s: ArrayLike) -> Any:
        """Y(s) = force / velocity [N s/m], in the shape of `s` [rad/s].

        Friction is left out (Y = 0) and gaps are closed (Y infinite), as in all linear analysis. Infinite at poles,
        such as a spring at s = 0.

        Raises `DesignError` if a value is still free, `NetworkError` if `s` is not made of numbers.

        >>> (Spring(100.0) | Damper(5.0)).admittance(2j)
        np.complex128(5-50j)
        """
        for element in self.elements():
            if isinstance(element.value, Free):
                raise DesignError(f"The admittance needs numbers, but {element.label!r} is still free. Fix it first.")
        try:
            points = np.asarray(s, dtype=complex)
        except (TypeError, ValueError):
            raise NetworkError(f"An admittance needs complex numbers s [rad/s], got {s!r}.") from None
        numerator, denominator = self.fraction(points)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(denominator == 0.0, np.inf, numerator / denominator)[()]


class Element(Network):
    """Common part of the five elements: one value with a unit, and an optional name."""

    symbol: ClassVar[str]
    quantity: ClassVar[str]
    unit: ClassVar[str]
    may_vanish: ClassVar[bool] = False  # a friction or a gap of zero is an element that is not there
    name: str | None

    def __post_init__(self) -> None:
        _check_name(self.name)
        value = self.value
        number = value.lower if isinstance(value, Free) else value
        what = f"{self.quantity.replace('_', ' ').capitalize()}" + (f" of {self.name!r}" if self.name else "")
        if not is_number(number):
            raise NetworkError(f"{what} must be a finite number of {self.unit} or free(lower, upper), got {value!r}.")
        if isinstance(value, Free):
            if number == 0.0 and not self.may_vanish:
                raise NetworkError(
                    f"{what} must be positive, but its lower bound is 0 {self.unit}. Give a small positive bound; "
                    f"to leave the element out, drop its branch from the network."
                )
            return
        if number < 0.0 or (number == 0.0 and not self.may_vanish):
            raise NetworkError(
                f"{what} must be positive, got {self.symbol} = {number:g} {self.unit}. "
                f"To leave the element out, drop its branch from the network."
            )
        object.__setattr__(self, self.quantity, float(number))

    @property
    def value(self) -> Value:
        """The element's one number, in SI units, or the `Free` that stands for it."""
        return getattr(self, self.quantity)  # type: ignore[no-any-return]

    @property
    def label(self) -> str:
        """Its name, else the name of its free value, else its symbol."""
        if self.name is not None:
            return self.name
        value = self.value
        return value.name if isinstance(value, Free) and value.name is not None else self.symbol

    def with_value(self, value: Value) -> Element:
        """The same element with another value."""
        changes: dict[str, Any] = {self.quantity: value}
        return replace(self, **changes)  # type: ignore[type-var]

    def elements(self) -> Iterator[Element]:
        yield self


@dataclass(frozen=True)
class Spring(Element):
    """Force proportional to elongation: F = k x."""

    stiffness: Value  # [N/m]
    name: str | None = None
    symbol: ClassVar[str] = "k"
    quantity: ClassVar[str] = "stiffness"
    unit: ClassVar[str] = "N/m"

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return np.full_like(s, self.value), s


@dataclass(frozen=True)
class Damper(Element):
    """Force proportional to the rate of elongation: F = c dx/dt."""

    damping: Value  # [N s/m]
    name: str | None = None
    symbol: ClassVar[str] = "c"
    quantity: ClassVar[str] = "damping"
    unit: ClassVar[str] = "N s/m"

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return np.full_like(s, self.value), np.full_like(s, 1.0)


@dataclass(frozen=True)
class Inerter(Element):
    """Force proportional to the relative acceleration of its ends: F = b d2x/dt2."""

    inertance: Value  # [kg]
    name: str | None = None
    symbol: ClassVar[str] = "b"
    quantity: ClassVar[str] = "inertance"
    unit: ClassVar[str] = "kg"

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return np.full_like(s, self.value) * s, np.full_like(s, 1.0)


@dataclass(frozen=True)
class Friction(Element):
    """Dry (Coulomb) friction: a force of size f against the motion, any force in [-f, f] at rest."""

    force: Value  # [N]
    name: str | None = None
    symbol: ClassVar[str] = "f"
    quantity: ClassVar[str] = "force"
    unit: ClassVar[str] = "N"
    may_vanish: ClassVar[bool] = True

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return np.full_like(s, 0.0), np.full_like(s, 1.0)


@dataclass(frozen=True)
class Gap(Element):
    """Backlash: no force while |x| < half_width, rigid contact at -half_width and at +half_width."""

    half_width: Value  # [m]
    name: str | None = None
    symbol: ClassVar[str] = "gap"
    quantity: ClassVar[str] = "half_width"
    unit: ClassVar[str] = "m"
    may_vanish: ClassVar[bool] = True

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return np.full_like(s, 1.0), np.full_like(s, 0.0)


ELEMENT_TYPES: tuple[type[Element], ...] = (Spring, Damper, Inerter, Friction, Gap)


@dataclass(frozen=True)
class Parallel(Network):
    """Parts side by side: one elongation, forces add."""

    parts: tuple[Network, ...]

    def elements(self) -> Iterator[Element]:
        for part in self.parts:
            yield from part.elements()

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return reduce(_parallel, (part.fraction(s) for part in self.parts))


@dataclass(frozen=True)
class Series(Network):
    """Parts end to end, the first at the upper end: one force, elongations add."""

    parts: tuple[Network, ...]

    def elements(self) -> Iterator[Element]:
        for part in self.parts:
            yield from part.elements()

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return reduce(_series, (part.fraction(s) for part in self.parts))


Fraction = tuple[Complex, Complex]


def _parallel(one: Fraction, other: Fraction) -> Fraction:
    (n, d), (n2, d2) = one, other
    both_rigid = (d == 0.0) & (d2 == 0.0)
    return _scaled(np.where(both_rigid, 1.0, n * d2 + n2 * d), d * d2)


def _series(one: Fraction, other: Fraction) -> Fraction:
    (n, d), (n2, d2) = one, other
    both_open = (n == 0.0) & (n2 == 0.0)
    return _scaled(n * n2, np.where(both_open, 1.0, n * d2 + n2 * d))


def _scaled(n: Complex, d: Complex) -> Fraction:
    """Long chains would overflow without this; powers of two change no digit."""
    size = np.ldexp(1.0, np.frexp(np.maximum(np.abs(n), np.abs(d)))[1])
    return n / size, d / size


def check_network(value: object) -> Network:
    """`value` if it is a network; raises `NetworkError` otherwise."""
    if isinstance(value, Network):
        return value
    raise NetworkError(
        f"Expected an element or a network such as Spring(120e3) | Damper(3000), got {type(value).__name__} {value!r}."
    )


def _parts(network: object, kind: type[Parallel] | type[Series]) -> tuple[Network, ...]:
    checked = check_network(network)
    return checked.parts if isinstance(checked, kind) else (checked,)


def _check_name(name: object) -> None:
    if name is not None and (not isinstance(name, str) or not NAME.fullmatch(name)):
        raise NetworkError(f"A name is a letter followed by letters, digits and underscores, got {name!r}.")
