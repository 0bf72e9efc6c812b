"""Norms of a system that comes from a mechanism, from its transfer functions without rounding.

They answer where double precision cannot, and are what it is checked against. A Pade approximant of a delay is a
fraction like the others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, Status, StatusKind
from inerter.formatting import format_complex
from inerter.norms.delay import pade_coefficients
from inerter.norms.mean_square import Transfer, UnknownError, axis_frequencies, mean_square
from inerter.norms.squared_gain import SquaredGain
from inerter.systems.linear import LinearSystem
from inerter.systems.polynomials import Polynomial, TransferFunctions, add, improve_roots, mirror, multiply

Matrix = NDArray[np.float64]
EXACT = 1e-12  # relative error of what is found here: digits in which results agree, and a few roundings


def undamped_status(frequencies: Sequence[float]) -> Status:
    """Status of an infinite norm due to undamped modes at these frequencies [rad/s]."""
    return Status(StatusKind.MARGINAL, f"undamped mode: a pole at {format_complex(1j * frequencies[0])} rad/s")


def h2_exactly(system: LinearSystem, pade_order: int | None) -> tuple[Matrix, Status]:
    """H2 norm of each output, and the reason if it is infinite or unknown."""
    functions = _functions(system)
    squares, direct, status = np.zeros(len(system.outputs)), [], OK
    for i, (name, row) in enumerate(zip(system.outputs, functions.numerators, strict=True)):
        for response in _by_source(functions.denominator, row, system, pade_order):
            try:
                square, frequencies = (math.inf, []) if response.is_direct else mean_square(response)
            except UnknownError as error:
                square, frequencies = math.nan, []
                status = Status(StatusKind.FAILED, str(error)) if status.ok else status
            squares[i] += square
            if response.is_direct:
                direct.append(name)
            if frequencies:
                status = undamped_status(frequencies)
    if direct and status.kind is not StatusKind.MARGINAL:
        names = ", ".join(dict.fromkeys(direct))
        status = Status(StatusKind.DIRECT_TERM, f"infinite variance: direct feedthrough from white noise to {names}")
    return np.sqrt(squares), status


def peaks_exactly(system: LinearSystem) -> tuple[list[tuple[float, float]], Status] | None:
    """Frequencies [rad/s] and values of all local maxima of the gain, the highest first, with one column a source.

    With undamped motions, these and infinity. None for several outputs of several sources: their largest singular
    value is no fraction.
    """
    functions = _functions(system)
    sources = list(dict.fromkeys(system.sources))
    entries = [
        _sum([n for n, of in zip(row, system.sources, strict=True) if of == source])
        for row in functions.numerators
        for source in sources
    ]
    response = Transfer(functions.denominator, tuple(entries), (0.0,) * len(entries)).without_common_roots()
    frequencies = axis_frequencies(response.denominator)
    if frequencies:
        return [(frequency, math.inf) for frequency in frequencies], undamped_status(frequencies)
    if min(len(functions.numerators), len(sources)) > 1:
        return None
    try:
        found = SquaredGain.of(response).peaks()
    except UnknownError as error:
        return [(math.nan, math.nan)], Status(StatusKind.FAILED, str(error))
    return sorted(found, key=lambda peak: -peak[1]), OK


def responses_exactly(system: LinearSystem, omega: Matrix) -> NDArray[np.complex128]:
    """G(j omega), shape (len(omega), outputs, inputs), of inputs that arrive at once, each value rounded once."""
    functions = _functions(system)
    shape = omega.size, len(system.outputs), len(system.inputs)
    return np.array([functions.at(one) for one in omega.tolist()], dtype=complex).reshape(shape)


def poles_exactly(system: LinearSystem) -> NDArray[np.complex128]:
    """Poles [1/s] of the motions of a system, however its values scatter."""
    known = np.linalg.eigvals(system.A).astype(complex)
    known = known[np.argsort(np.abs(known))]
    denominator = _functions(system).denominator
    if len(denominator) != known.size + 1:
        return known
    at_zero = next(i for i, c in enumerate(denominator) if c)
    moving = improve_roots(denominator[at_zero:], known[at_zero:].tolist())
    return np.array([0.0] * at_zero + moving, dtype=complex)


def _functions(system: LinearSystem) -> TransferFunctions:
    assert system.origin is not None
    return system.origin.functions(system.inputs, system.outputs)


def _by_source(
    denominator: Polynomial, row: Sequence[Polynomial], system: LinearSystem, pade_order: int | None
) -> list[Transfer]:
    """Transfer of one output from each source, with simultaneous input paths added; zero ones are left out."""
    found = []
    for source in dict.fromkeys(system.sources):
        arrivals: dict[float, Polynomial] = {}
        for numerator, of, delay in zip(row, system.sources, system.delays.tolist(), strict=True):
            if of == source:
                arrivals[delay] = add(arrivals.get(delay, []), numerator)
        times = sorted(arrivals)
        numerators = [arrivals[time] for time in times]
        response = Transfer(denominator, tuple(numerators), tuple(times))
        found.append(
            (response if pade_order is None else _with_pade_delays(response, pade_order)).without_common_roots()
        )
    return [response for response in found if any(response.numerators)]


def _with_pade_delays(response: Transfer, order: int) -> Transfer:
    """Transfer with Padé approximants of the delays between input paths, combined into one numerator."""
    denominator, total, factor = response.denominator, response.numerators[0], [1]
    for (before, time), numerator in zip(pairwise(response.times), response.numerators[1:], strict=True):
        bottom = _pade(time - before, order)
        factor = multiply(factor, mirror(bottom))
        total = add(multiply(total, bottom), multiply(numerator, factor))
        denominator = multiply(denominator, bottom)
    return Transfer(denominator, (total,), (0.0,))


def _pade(time: float, order: int) -> Polynomial:
    """The denominator of the approximant of exp(-s time), whose mirror image is the numerator."""
    top, bottom = time.as_integer_ratio()
    return [c * top**k * bottom ** (order - k) for k, c in enumerate(pade_coefficients(order))]


def _sum(polynomials: Sequence[Polynomial]) -> Polynomial:
    total: Polynomial = []
    for polynomial in polynomials:
        total = add(total, polynomial)
    return total
