"""The algebra of networks: `|` in parallel, `-` in series, and bridges."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import chain
from operator import is_
from typing import TYPE_CHECKING, Any, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import DesignError, NetworkError
from inerter.networks.elements.values import Free, Tied
from inerter.notebook import shown_by

if TYPE_CHECKING:
    from inerter.networks.elements.element import Element

T = TypeVar("T")
Complex = NDArray[np.complex128]
Fraction = tuple[Complex, Complex]  # numerator and denominator


class Network:
    """A two-terminal network: an element, or elements combined by `|`, `-` and `Bridge`.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(7544.2) - it.Inerter(366.52)  # - binds tighter than |
    >>> isinstance(strut, it.Network), [part.label for part in strut.elements()]
    (True, ['k', 'c', 'b'])
    """

    _repr_svg_ = shown_by("inerter.figures.plots.network:network_svg")

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

    def fraction(self, s: Complex) -> Fraction:
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


class CombinedNetwork(Network):
    """Interface of a network of several parts. One with a name stays one part, whose force is an output."""

    parts: tuple[Network, ...]
    name: str | None

    def elements(self) -> Iterator[Element]:
        return chain.from_iterable([part.elements() for part in self.parts])

    def with_parts(self, parts: Sequence[Network]) -> Self:
        """The same combination of other parts; the same object if none differs."""
        if len(parts) == len(self.parts) and all(map(is_, parts, self.parts)):
            return self
        return replace(self, parts=tuple(parts))  # type: ignore[type-var]


@dataclass(frozen=True)
class Parallel(CombinedNetwork):
    """Parts in parallel: equal elongations, forces add."""

    parts: tuple[Network, ...]
    name: str | None = field(default=None, kw_only=True, repr=False)

    def fraction(self, s: Complex) -> Fraction:
        return reduce(_parallel, (part.fraction(s) for part in self.parts))


@dataclass(frozen=True)
class Series(CombinedNetwork):
    """Parts in series, the first at the upper end: equal forces, elongations add."""

    parts: tuple[Network, ...]
    name: str | None = field(default=None, kw_only=True, repr=False)

    def fraction(self, s: Complex) -> Fraction:
        return reduce(_series, (part.fraction(s) for part in self.parts))


@dataclass(frozen=True)
class Bridge(CombinedNetwork):
    """Five arms between the upper end, two inner nodes (left and right) and the lower end.

    The upper end of each arm is named first: a from the upper end to the left node, b from the left node to the lower
    end, c from the upper end to the right node, d from the right node to the lower end, e from the left node to the
    right node.

    Raises `NetworkError` if an arm is not a network.

    >>> from inerter.networks.elements import Damper
    >>> Bridge(Damper(1.0), Damper(2.0), Damper(2.0), Damper(1.0), Damper(1.0)).admittance(1j)
    np.complex128(1.4+0j)
    """

    a: Network
    b: Network
    c: Network
    d: Network
    e: Network
    name: str | None = field(default=None, kw_only=True, repr=False)

    def __post_init__(self) -> None:
        for arm in self.parts:
            check_network(arm)

    @property
    def parts(self) -> tuple[Network, ...]:  # type: ignore[override]
        """The five arms, a to e."""
        return self.a, self.b, self.c, self.d, self.e

    def with_parts(self, parts: Sequence[Network]) -> Bridge:
        return self if all(map(is_, parts, self.parts)) else Bridge(*parts, name=self.name)

    def fraction(self, s: Complex) -> Fraction:
        arms = [_normalise(*arm.fraction(s)) for arm in self.parts]
        whole = _bridge(*arms)
        for i, (n, d) in enumerate(arms):
            for is_rigid, there in ((False, n == 0.0), (True, d == 0.0)):
                if np.any(there):
                    reduced = reduce_bridge(arms, i, is_rigid, _parallel, _series, lambda arm: arm)
                    whole = np.where(there, reduced[0], whole[0]), np.where(there, reduced[1], whole[1])
        return whole


def reduce_bridge(
    arms: Sequence[T],
    which: int,
    is_rigid: bool,
    parallel: Callable[[T, T], T],
    series: Callable[[T, T], T],
    turn: Callable[[T], T],
) -> T:
    """The series-parallel network that a bridge becomes if one of its arms (a to e: 0 to 4) is open or rigid.

    `turn` exchanges the ends of arm e where that then lies the other way round.
    """
    if which == 4:
        a, b, c, d, _ = arms
        return series(parallel(a, c), parallel(b, d)) if is_rigid else parallel(series(a, b), series(c, d))
    e = turn(arms[4]) if is_rigid == (which in (1, 2)) else arms[4]
    follower, neighbour, opposite = (arms[i] for i in _BESIDE[which])
    if is_rigid:
        return parallel(follower, series(parallel(e, neighbour), opposite))
    return series(neighbour, parallel(opposite, series(e, follower)))


# of each arm a to d: the arm that follows at its inner node, its neighbour at the same end, and the opposite arm
_BESIDE = ((1, 2, 3), (0, 3, 2), (3, 0, 1), (2, 1, 0))


def _parallel(one: Fraction, other: Fraction) -> Fraction:
    (n, d), (n2, d2) = one, other
    both_rigid = (d == 0.0) & (d2 == 0.0)
    return _normalise(np.where(both_rigid, 1.0, n * d2 + n2 * d), d * d2)


def _series(one: Fraction, other: Fraction) -> Fraction:
    (n, d), (n2, d2) = one, other
    both_open = (n == 0.0) & (n2 == 0.0)
    return _normalise(n * n2, np.where(both_open, 1.0, n * d2 + n2 * d))


def _bridge(a: Fraction, b: Fraction, c: Fraction, d: Fraction, e: Fraction) -> Fraction:
    """Sum over the spanning trees of the bridge, over that of the bridge with its two ends joined (Kirchhoff)."""
    (na, da), (nb, db), (nc, dc), (nd, dd), (ne, de) = a, b, c, d, e
    ab, cd = na * db + nb * da, nc * dd + nd * dc
    upper, lower = na * dc + nc * da, nb * dd + nd * db
    return _normalise(
        ne * upper * lower + de * (na * nb * cd + nc * nd * ab),
        de * ab * cd + ne * (ab * dc * dd + cd * da * db),
    )


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
