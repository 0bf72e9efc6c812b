"""Input paths from sources to the inputs of a mechanism: gain, delay, and filter; several may reach one input.

A filter b(s)/a(s) before an input is an equation more: with the solution z of a(d/dt) z = w for the source w, the input
gets b(d/dt) z. The states are z and its derivatives but the highest, which is an unknown. What reaches an input is an
unknown too, so that levers and coefficients enter as they were given, and what is owed to the free values stays affine.
Where no filter has a state, inputs are sums of the sources, and states that only a road moves stay such.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from inerter.errors import LinearSystemError
from inerter.networks.elements import middle
from inerter.signals.coherence import Excess
from inerter.systems.descriptor import Descriptor, Sum, close
from inerter.systems.filters import Filter, with_filter_states
from inerter.systems.polynomials import Polynomial

Column = tuple[str, str, float]  # its name, the source, and the delay
Chain = tuple[int, Filter]  # the number of a column, and a filter behind it


@dataclass(frozen=True)
class InputPath:
    """Input path from a source to an input: `lever` times the source, `delay` seconds late, through `filter`.

    An input that is a road gets its velocity, or with `displacement` its displacement. Where the filter only stands in
    for a density, `excess` tells by what part that exceeds it; all arrivals of a source have the same.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(4000.0)
    >>> car = it.HalfCar(363.5, 200.0, 25.0, 20.0, 120e3, 100e3, 0.775, 1.265, front=strut, rear=strut).mechanism()
    >>> paths = it.RideComfort(it.Road(5e-7, 20.0)).definition(car).input_paths(car)
    >>> [round(path.delay, 4) for path in paths]  # s: 2.04 m at 20 m/s
    [0.0, 0.102]
    """

    input: str
    source: str = ""
    delay: float = 0.0
    lever: float = 1.0
    filter: Filter | None = None
    displacement: bool = False
    excess: Excess | None = None

    @property
    def plain(self) -> bool:
        """Whether the path transmits the source unchanged but for a delay."""
        return self.lever == 1.0 and self.filter is None and not self.displacement

    @property
    def whole(self) -> tuple[Polynomial, Polynomial] | None:
        """Transfer function without delay as integer polynomials, lowest power first; None for the source itself."""
        if self.plain:
            return None
        lever = Fraction(self.lever)
        top, bottom = ([1], [1]) if self.filter is None else self.filter.whole
        top, bottom = [c * lever.numerator for c in top], [c * lever.denominator for c in bottom]
        return ([0, *top] if self.displacement else top), bottom


def inputs_of(paths: Sequence[InputPath]) -> tuple[str, ...]:
    """The inputs that are reached, each once."""
    return tuple(dict.fromkeys(path.input for path in paths))


def columns_of(paths: Sequence[InputPath]) -> list[Column]:
    """Sources at times of arrival, those of one source in the order of time; one for each input if all are plain."""
    if _plain(paths):
        return [(path.input, path.source, path.delay) for path in paths]
    pairs = dict.fromkeys((path.source, path.delay) for path in paths)
    return [(f"{source or 'source'} {i}", source, delay) for i, (source, delay) in enumerate(pairs, start=1)]


@lru_cache(maxsize=32)  # since designs of one structure share their descriptor
def apply_excitation(descriptor: Descriptor, paths: tuple[InputPath, ...]) -> Descriptor:
    """`descriptor`, whose inputs are those that the arrivals reach, with `columns_of` the arrivals as its inputs.

    Raises `LinearSystemError` for the displacement of a road whose velocity a damper transmits to an output directly.
    """
    if _plain(paths):
        return descriptor
    columns = columns_of(paths)
    at = [next(i for i, c in enumerate(columns) if c[1:] == (a.source, a.delay)) for a in paths]
    d = _by_displacement(descriptor, {a.input for a in paths if a.displacement})
    sums = {
        name: tuple((a.input, a.whole) for i, a in zip(at, paths, strict=True) if i == number)
        for number, (name, *_) in enumerate(columns)
    }
    if all(a.filter is None or a.filter.order == 0 for a in paths):
        return _scale_inputs(d, list(zip(at, paths, strict=True)), sums)
    chains = list(dict.fromkeys((i, a.filter) for i, a in zip(at, paths, strict=True) if a.filter is not None))
    filters = [one for _, one in chains]
    X_eta, X_x, places = with_filter_states(np.concatenate((d.X_eta, d.X_u), axis=1), d.X_x, filters)
    n = len(X_x)
    reached = [(i, d.inputs.index(a.input), a) for i, a in zip(at, paths, strict=True)]
    wired = _FilterChains(reached, chains, places, len(columns), n)
    return d.with_stacks(
        wired.stacks(d.stacks),
        wired.stacks(d.sizes, sizes=True),
        X_eta=X_eta,
        X_x=X_x,
        X_u=np.zeros((n, len(columns))),
        states=(*d.states, *(f"filter_{i}_{k}" for i, (_, f) in enumerate(chains, 1) for k in range(1, f.order + 1))),
        inputs=tuple(name for name, *_ in columns),
        sums=sums,
    )


def _scale_inputs(d: Descriptor, reached: Sequence[tuple[int, InputPath]], sums: Mapping[str, Sum]) -> Descriptor:
    """The descriptor whose inputs are columns times numbers."""
    levers = np.zeros((2, len(d.inputs), len(sums)), np.longdouble)  # and the sizes of their terms
    for column, path in reached:
        gain = (
            1.0
            if path.filter is None
            else path.filter.scaled_coefficients[1][0] / path.filter.scaled_coefficients[2][0]
        )
        lever = np.longdouble(path.lever) * gain
        levers[:, d.inputs.index(path.input), column] += lever, abs(lever)
    F, Y_u, X_u = d.F @ levers[0], d.Y_u @ levers[0], (d.X_u @ levers[0]).astype(float)
    F_size, Y_u_size = (d.sizes[i] @ levers[1].astype(float) for i in (2, 5))
    sizes = (*d.sizes[:2], F_size, *d.sizes[3:5], Y_u_size)
    return replace(d, F=F, Y_u=Y_u, X_u=X_u, inputs=tuple(sums), sizes=sizes, sums=sums)


def _plain(paths: Sequence[InputPath]) -> bool:
    return all(path.plain for path in paths) and len(inputs_of(paths)) == len(paths)


@dataclass(frozen=True)
class _FilterChains:
    """Arrivals with the numbers of their columns and inputs, the chains of filters, and where their states are."""

    reached: list[tuple[int, int, InputPath]]
    chains: list[Chain]
    places: list[slice]
    columns: int
    states: int

    def stacks(self, stacks: Any, sizes: bool = False) -> Any:
        """The stacks with an unknown and its equation for each input and each filter chain."""
        S, R, F, Y_eta, Y_x, Y_u = stacks
        _, e, n = R.shape
        q, both = e + F.shape[2], 1.0 if sizes else -1.0
        total, outputs = q + len(self.chains), Y_u.shape[1]
        S2, R2, F2 = (_blank(S, total, width) for width in (total, self.states, self.columns))
        Y_eta2, Y_x2, Y_u2 = (_blank(Y_eta, outputs, width) for width in (total, self.states, self.columns))
        S2[:, :e, :e], S2[:, :e, e:q], R2[:, :e, :n] = S, both * F, R
        Y_eta2[:, :, :e], Y_eta2[:, :, e:q], Y_x2[:, :, :n] = Y_eta, Y_u, Y_x
        S2[0, range(e, q), range(e, q)] = 1.0
        for unknown, ((column, one), place) in enumerate(zip(self.chains, self.places, strict=True), start=q):
            bottom = np.abs(one.scaled_coefficients[2]) if sizes else one.scaled_coefficients[2]
            S2[0, unknown, unknown], R2[0, unknown, place] = bottom[-1], both * bottom[:-1]
            F2[0, unknown, column] = 1.0
        for column, number, path in self.reached:
            lever = np.longdouble(abs(path.lever) if sizes else path.lever)
            if path.filter is None:
                F2[0, e + number, column] += lever
                continue
            chain = self.chains.index((column, path.filter))
            top = lever * (np.abs(path.filter.scaled_coefficients[1]) if sizes else path.filter.scaled_coefficients[1])
            S2[0, e + number, q + chain] += both * top[-1]
            R2[0, e + number, self.places[chain]] += top[:-1]
        return S2, R2, F2, Y_eta2, Y_x2, Y_u2


def _by_displacement(d: Descriptor, names: set[str]) -> Descriptor:
    """Descriptor with the displacements of some roads as inputs in place of their velocities.

    States that follow the velocity w' of a road with some weight N become their remainder x - N w. Where a damper acts
    on w', unknowns follow it too: eta = eta0 + E w' with S E = F, and N = X_eta E + X_u. Then E w are further unknowns,
    which keeps the equations affine in the free values. An output must not follow w' itself: Y_eta E + Y_u = 0.
    """
    columns = [i for i, name in enumerate(d.inputs) if name in names]
    if not columns:
        return d
    _check_proper(d, columns)
    more = d.S.shape[1] if np.any(d.F[:, :, columns]) else 0
    stacks = _driven_by_displacement(d, d.stacks, columns, more)
    sizes = _driven_by_displacement(d, d.sizes, columns, more, sizes=True)
    X_eta, X_u = np.concatenate((d.X_eta, (d.X_x @ d.X_eta)[:, :more]), axis=1), d.X_u.copy()
    X_u[:, columns] = d.X_x @ d.X_u[:, columns]
    return d.with_stacks(stacks, sizes, X_eta=X_eta, X_u=X_u)


def _check_proper(d: Descriptor, columns: Sequence[int]) -> None:
    """Raises `LinearSystemError` for an output that follows the velocities of roads directly, for almost all values."""
    values = {name: middle(free) * (1.0 + 0.01 * i**0.5) for i, (name, free) in enumerate(d.free.items(), start=2)}
    direct = close(d, values).D[:, columns]
    for row, name in zip(direct, d.outputs, strict=True):
        if np.any(row):
            road = d.inputs[columns[int(np.argmax(np.abs(row)))]]
            raise LinearSystemError(
                f"A damper transmits the velocity of {road} directly to {name}, whose gain from the displacement of "
                f"{road} grows with frequency without limit. Use {road}_velocity as the input, or another output."
            )


def _driven_by_displacement(
    d: Descriptor, stacks: Any, columns: Sequence[int], more: int, sizes: bool = False
) -> Iterator[Any]:
    """The stacks with displacements in the `columns`, and with `more` unknowns and equations; or their sizes."""
    S, R, F, Y_eta, Y_x, Y_u = stacks
    followed, moved = (np.abs(one) if sizes else one for one in (d.X_u[:, columns], d.X_eta[:, :more]))
    e = S.shape[1]
    S2, R2, F2 = (_blank(S, e + more, width) for width in (e + more, R.shape[2], F.shape[2]))
    S2[:, :e, :e], R2[:, :e], F2[:, :e] = S, R, F
    F2[:, :e, columns] = R @ followed
    S2[:, e:, e:], S2[:, :e, e:] = S[:, :more, :more], R @ moved if sizes else -(R @ moved)
    F2[:, e:, columns] = F[:, :more, columns]
    Y_u2 = Y_u.copy()
    Y_u2[:, :, columns] = Y_x @ followed
    yield from (S2, R2, F2, np.concatenate((Y_eta, Y_x @ moved), axis=2), Y_x, Y_u2)


def _blank(stack: Any, rows: int, columns: int) -> Any:
    return np.zeros((stack.shape[0], rows, columns), stack.dtype)
