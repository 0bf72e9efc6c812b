"""A mechanism with one network in it, over the network's admittance: polynomials without rounding.

All transfer functions of a mechanism are of degree one in the admittance Y of a network between two of its nodes
(numerator and denominator are determinants, and a network adds a matrix of rank one):

    G(s) = (A(s) + Y B(s)) / (P(s) + Y Q(s)),    Y = force / velocity.

P has the poles of the mechanism without the network and Q those with a rigid link in its place; neither has negative
coefficients. Two dampers of 1 and 2 N s/m in the network's place give all four polynomials.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inerter.systems.descriptor import Descriptor, exact_functions
from inerter.systems.polynomials import Polynomial, add, greatest_common_divisor, quotient, scale_by


@dataclass(frozen=True)
class PortFunction:
    """One transfer function: P, Q, A and B with whole coefficients, from the constant upwards; empty if zero."""

    polynomials: tuple[Polynomial, Polynomial, Polynomial, Polynomial]

    @cached_property
    def rounded_coefficients(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The polynomials (4, size) over a common power of two, and what is to be added in twice the precision."""
        bits = max(c.bit_length() for p in self.polynomials for c in p)
        high, low = np.zeros((2, 4, max(map(len, self.polynomials))))
        for row, p in enumerate(self.polynomials):
            for i, c in enumerate(p):
                high[row, i] = c / (1 << bits)
                low[row, i] = (c - int(Fraction(high[row, i]) * (1 << bits))) / (1 << bits)
        return high, low


def port_functions(
    descriptor: Descriptor, place: str, inputs: Sequence[str], outputs: Sequence[str]
) -> list[list[PortFunction]]:
    """Functions [output][input] of a mechanism whose network is a damper with the free value `place`."""
    one, two = (exact_functions(descriptor, {place: y}, inputs, outputs, reduced=False) for y in (1.0, 2.0))
    poles = _split(one.denominator, two.denominator)
    return [
        [_cancel_factors(*poles, *_split(*tops)) for tops in zip(*rows, strict=True)]
        for rows in zip(one.numerators, two.numerators, strict=True)
    ]


def _split(one: Polynomial, two: Polynomial) -> tuple[Polynomial, Polynomial]:
    """P and q of p + y q from its values at y = 1 and 2."""
    slope = add(two, scale_by(one, -1))
    return add(one, scale_by(slope, -1)), slope


def _cancel_factors(*polynomials: Polynomial) -> PortFunction:
    """The polynomials without a factor that all have."""
    factor = greatest_common_divisor(*sorted((p for p in polynomials if p), key=len))
    P, Q, A, B = (quotient(p, factor) if p else [] for p in polynomials)
    return PortFunction((P, Q, A, B))
