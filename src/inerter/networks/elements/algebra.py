"""The algebra of networks: `|` in parallel, `-` in series."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import DesignError, NetworkError
from inerter.networks.elements.values import Free, Tied

if TYPE_CHECKING:
    from inerter.networks.elements.element import Element

Complex = NDArray[np.complex128]


class Network:
    """A two-terminal network: an element, or elements combined by `|` and `-`."""

    def __or__(self, other: Network) -> Parallel:
        return Parallel((*_parts(self, Parallel), *_parts(other, Parallel)))

    def __sub__(self, other: Network) -> Series:
        return Series((*_parts(self, Series), *_parts(other, Series)))

    def __ror__(self, other: object) -> Parallel:
        return Parallel((*_parts(other, Parallel), *_parts(self, Parallel)))

    def __rsub__(self, other: object) -> Series:
        return Series((*_parts(other, Series), *_parts(self, Series)))

    def elements(self) -> Iterator[Element]:
        """The elements in the order of the expression."""
        raise NotImplementedError

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        """Numerator and denominator of the admittance at `s`, up to a common factor; neither is ever infinite."""
        raise NotImplementedError

    def admittance(self, s: ArrayLike) -> Any:
        """Y(s) = force / velocity [N s/m], in the shape of `s` [rad/s].

        Friction is neglected (Y = 0) and gaps are closed (Y infinite), as in all linear analysis. Infinite at poles,
        such as a spring at s = 0.

        Raises `DesignError` if a value is still free, `NetworkError` if `s` does not consist of numbers.

        >>> from inerter.networks.elements import Damper, Spring
        >>> (Spring(100.0) | Damper(5.0)).admittance(2j)
        np.complex128(5-50j)
        """
        for element in self.elements():
            if isinstance(element.value, Free | Tied):
                raise DesignError(
                    f"The admittance requires numbers, but {element.label!r} is free. Fix its value first."
                )
        try:
            points = np.asarray(s, dtype=complex)
        except (TypeError, ValueError):
            raise NetworkError(f"An admittance requires complex numbers s [rad/s], got {s!r}.") from None
        numerator, denominator = self.fraction(points)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(denominator == 0.0, np.inf, numerator / denominator)[()]


@dataclass(frozen=True)
class Parallel(Network):
    """Parts in parallel: equal elongations, forces add. Named parts stay one part, whose force is an output."""

    parts: tuple[Network, ...]
    name: str | None = field(default=None, kw_only=True, repr=False)

    def elements(self) -> Iterator[Element]:
        for part in self.parts:
            yield from part.elements()

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return reduce(_parallel, (part.fraction(s) for part in self.parts))


@dataclass(frozen=True)
class Series(Network):
    """Parts in series, the first at the upper end: equal forces, elongations add; named as `Parallel`."""

    parts: tuple[Network, ...]
    name: str | None = field(default=None, kw_only=True, repr=False)

    def elements(self) -> Iterator[Element]:
        for part in self.parts:
            yield from part.elements()

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        return reduce(_series, (part.fraction(s) for part in self.parts))


Fraction = tuple[Complex, Complex]


def _parallel(one: Fraction, other: Fraction) -> Fraction:
    (n, d), (n2, d2) = one, other
    both_rigid = (d == 0.0) & (d2 == 0.0)
    return _normalise(np.where(both_rigid, 1.0, n * d2 + n2 * d), d * d2)


def _series(one: Fraction, other: Fraction) -> Fraction:
    (n, d), (n2, d2) = one, other
    both_open = (n == 0.0) & (n2 == 0.0)
    return _normalise(n * n2, np.where(both_open, 1.0, n * d2 + n2 * d))


def _normalise(n: Complex, d: Complex) -> Fraction:
    """The fraction scaled by a power of two, exactly, to prevent overflow in long chains."""
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
    return checked.parts if isinstance(checked, kind) and checked.name is None else (checked,)
