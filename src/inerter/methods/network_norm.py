"""Indices of a vehicle with one network left open, compiled for any network in its place.

A mechanism enters as polynomials (`systems.network_port`) that are found once, a network as a list of operations on
polynomials (`kernels.network_polynomials`), so that nothing is built or compiled for each network.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import InerterError
from inerter.indices.definition import Combination, Index, IndexDefinition
from inerter.kernels.decorators import TUNED, compiler_mode
from inerter.kernels.network_gains import peaks_in_lanes, peaks_in_turn
from inerter.kernels.network_lanes import indices_in_lanes
from inerter.kernels.network_norms import Port, TradeOff, indices
from inerter.kernels.network_peaks import search_network_peak
from inerter.kernels.network_polynomials import (
    ARMS,
    BRIDGE,
    FORESTS,
    LEAF,
    PARALLEL,
    SERIES,
    TREES,
    Program,
)
from inerter.kernels.network_search import Variables, search_network
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.methods.objective import snap_to_bounds
from inerter.networks.elements import Bridge, Damper, Element, Free, Inerter, Network, Parallel, Spring, Tied, free
from inerter.networks.elements.algebra import CombinedNetwork
from inerter.networks.transform import linearise
from inerter.systems.network_port import PortFunction, port_functions
from inerter.systems.structure import Structure, structure_of
from inerter.vehicle.mechanism import Mechanism, Strut
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
PLACE = "admittance_in_question"
TRIED = 32  # samples of which each start is the best
_INDEX_ALONE = TradeOff(np.zeros(0, np.int64), np.zeros(0), np.zeros(0), 1.0)


@dataclass(frozen=True, eq=False)
class NetworkProgram:
    """A network as a `Program`, with the power of s and the degrees of its admittance s^power n(s) / d(s)."""

    program: Program
    power: int
    top: int
    bottom: int


def network_program(network: Network) -> NetworkProgram:
    """The program of a network of springs, dampers and inerters, whose values come in the order of its elements."""
    rows: list[tuple[int, ...]] = []
    powers: list[int] = []
    bridges: list[list[int]] = []
    leaves = 0

    def add(row: tuple[int, ...], power: int) -> int:
        rows.append(row)
        powers.append(power)
        return len(rows) - 1

    def join(operation: int, one: int, other: int) -> int:
        low = min(powers[one], powers[other])
        shifts = powers[one] - low, powers[other] - low
        (top, bottom), (more, below) = rows[one][-2:], rows[other][-2:]
        mixed = max(shifts[0] + top + below, shifts[1] + more + bottom)
        if operation == PARALLEL:
            return add((operation, one, other, *shifts, mixed, bottom + below), low)
        return add((operation, one, other, *shifts, top + more, mixed), max(powers[one], powers[other]))

    def bridge(arms: list[int]) -> int:
        sums: list[list[int]] = []
        degrees = []
        lowest = []
        for products in (TREES.tolist(), FORESTS.tolist()):
            own = [sum(powers[arms[i]] for i in product) for product in products]
            shifts = [power - min(own) for power in own]
            sizes = [sum(rows[arm][-2 if i in product else -1] for i, arm in enumerate(arms)) for product in products]
            degrees.append(max(s + d for s, d in zip(shifts, sizes, strict=True)))
            sums.append(shifts)
            lowest.append(min(own))
        bridges.append([*arms, *sums[0], *sums[1]])
        return add((BRIDGE, len(bridges) - 1, 0, 0, 0, *degrees), lowest[0] - lowest[1])

    def visit(part: Network) -> int:
        nonlocal leaves
        if isinstance(part, Element):
            leaves += 1
            return add((LEAF, leaves - 1, 0, 0, 0, 0, 0), part.linear.order - 1)
        assert isinstance(part, CombinedNetwork)
        parts = [visit(each) for each in part.parts]
        if isinstance(part, Bridge):
            return bridge(parts)
        operation = PARALLEL if isinstance(part, Parallel) else SERIES
        found = parts[0]
        for other in parts[1:]:
            found = join(operation, found, other)
        return found

    last = visit(network)
    table = np.array(rows, np.int64).reshape(-1, 7)
    more = np.array(bridges, np.int64).reshape(-1, ARMS + 16)
    return NetworkProgram(Program(table, more), powers[last], rows[last][-2], rows[last][-1])


def admittance_program(power: int, top: int, bottom: int) -> NetworkProgram:
    """The program of an admittance s^power N(s) / D(s) of given degrees, for the kernel `admittance_indices`."""
    parts = np.array([[LEAF, 0, 0, 0, 0, top, bottom]], np.int64)
    return NetworkProgram(Program(parts, np.zeros((0, ARMS + 16), np.int64)), power, top, bottom)


@dataclass(frozen=True, eq=False)
class CompiledSearch:
    """Optima that many starts find, in compiled code: element values (starts, variables), values, and evaluations."""

    points: Array
    values: Array
    evaluations: NDArray[np.int64]
    is_regular: bool  # whether no transfer function of the index is zero for all values, or has an infinite norm


@dataclass(frozen=True, eq=False)
class NetworkIndex:
    """An index of a vehicle, of r.m.s. values or a peak gain, over the admittance of one network in it."""

    definition: IndexDefinition
    functions: tuple[PortFunction, ...]
    weights: Array  # of each squared norm
    groups: Array  # roots of sums of squares that add up to the index

    def port(self, program: NetworkProgram) -> Port | None:
        """Data of compiled code for one network; None if the index is infinite for all its values."""
        kept, forms = [], []
        for k, function in enumerate(self.functions):
            form = _form(function, program)
            if form is None:
                return None
            if form:
                kept.append(k)
                forms.append(form)
        arrays = [self.functions[k].rounded_coefficients for k in kept]
        size = max((high.shape[1] for high, _ in arrays), default=1)
        coefficients, low = np.zeros((2, len(kept), 4, size))
        for k, (high, rest) in enumerate(arrays):
            coefficients[k, :, : high.shape[1]], low[k, :, : high.shape[1]] = high, rest
        degrees = [[len(p) - 1 for p in self.functions[k].polynomials] for k in kept]
        return Port(
            coefficients,
            low,
            np.array(degrees, np.int64).reshape(-1, 4),
            np.array(forms, np.int64).reshape(-1, 5),
            self.weights[kept],
            self.groups[kept],
        )

    @property
    def is_peak(self) -> bool:
        """Whether the index is a peak gain."""
        return self.definition.is_peak

    def over(self, network: Network) -> IndexOverNetwork | None:
        """The index over the free values of a network; None if it is infinite for all of them, and for tied values."""
        program = network_program(network)
        port, leaves = self.port(program), [element.value for element in network.elements()]
        if port is None or port.weights.size == 0 or any(isinstance(value, Tied) for value in leaves):
            return None
        if any(element.gain != 1.0 for element in network.elements()):
            return None
        free_values = {str(value.name): value for value in leaves if isinstance(value, Free)}
        names = tuple(free_values)
        of_leaf = [names.index(str(value.name)) if isinstance(value, Free) else -1 for value in leaves]
        numbers = [1.0 if isinstance(value, Free) else float(value) for value in leaves]  # type: ignore[arg-type]
        lower, upper = np.array([[value.lower, value.upper] for value in free_values.values()]).reshape(-1, 2).T
        variables = Variables(np.array(numbers), np.array(of_leaf), np.log(lower), np.log(upper))
        return IndexOverNetwork(self, names, variables, program.program, port, (lower, upper))


@dataclass(frozen=True, eq=False)
class IndexOverNetwork:
    """An index over the free values of one network, in the order in which they first occur, for compiled code."""

    index: NetworkIndex
    names: tuple[str, ...]
    variables: Variables
    program: Program
    port: Port
    ends: tuple[Array, Array]

    def values(self, points: Array) -> Array:
        """The index at each row of free values; infinite where it is not known.

        A design has the same digits side by side with others and, where that is not compiled, in turn.
        """
        of_leaf = self.variables.of_leaf
        rows = np.repeat(self.variables.values[:, None], len(points), axis=1)
        rows[of_leaf >= 0] = points.T[of_leaf[of_leaf >= 0]]
        own, errors, in_lanes = (self.program, self.port), np.empty(len(points)), compiler_mode() == TUNED
        if self.index.is_peak:
            peaks = (peaks_in_lanes if in_lanes else peaks_in_turn)(rows, *own, errors)
            return np.asarray(peaks * np.sqrt(self.port.weights[0]))
        if in_lanes:
            return np.asarray(indices_in_lanes(rows, *own, errors))
        return np.asarray(indices(np.ascontiguousarray(rows.T), *own, np.zeros((0, len(rows))), errors))

    def search(self, samples: Array, tried: int = TRIED, trade_off: TradeOff = _INDEX_ALONE) -> CompiledSearch:
        """Optima of the index from the best of each `tried` rows of `samples` (rows, values) in the unit cube.

        With a trade-off the values are excesses over its aim, whose criteria are sums of the groups of the index.
        """
        lower, upper = self.ends
        starts = samples.shape[0] // tried
        points, counts = np.zeros((starts, lower.size)), np.zeros(starts, np.int64)
        given = samples, tried, self.variables, self.program, self.port
        if self.index.is_peak:
            values = np.asarray(search_network_peak(*given, points, counts)) * np.sqrt(self.port.weights[0])
        else:
            values = np.asarray(search_network(*given, trade_off, points, counts))
        is_regular = self.port.weights.size == len(self.index.functions)
        return CompiledSearch(snap_to_bounds(points, lower, upper), values, counts, is_regular)


def join_indices(several: Sequence[NetworkIndex]) -> tuple[NetworkIndex, NDArray[np.int64]]:
    """Indices of r.m.s. values as one, their sum, and the number of the index to which each of its groups belongs."""
    counts = [int(one.groups.max()) + 1 for one in several]
    first = np.cumsum([0, *counts[:-1]])
    together = NetworkIndex(
        several[0].definition,
        tuple(function for one in several for function in one.functions),
        np.concatenate([one.weights for one in several]),
        np.concatenate([one.groups + start for one, start in zip(several, first, strict=True)]),
    )
    return together, np.repeat(np.arange(len(several)), counts)


def values_kernel() -> Any:
    """The compiled code of an index of r.m.s. values of many designs: side by side, or in turn."""
    return indices_in_lanes if compiler_mode() == TUNED else indices


def network_kernel(definition: IndexDefinition) -> Any:
    """The compiled code that searches for an index over a network."""
    return search_network_peak if definition.is_peak else search_network


def _form(function: PortFunction, program: NetworkProgram) -> tuple[int, ...] | None:
    """A row of `Port.forms`; empty for a function that is zero, None for one whose norm is infinite."""
    power_D, power_N = max(0, -program.power), max(0, program.power)
    terms = ((power_D, program.bottom), (power_N, program.top)) * 2
    lowest, highest = [], []
    for p, (power, degree) in zip(function.polynomials, terms, strict=True):
        zeros = next((i for i, c in enumerate(p) if c), None)
        lowest.append(None if zeros is None else zeros + power)
        highest.append(len(p) - 1 + power + degree if p else -1)
    bottom = min(x for x in lowest[:2] if x is not None)
    top = min((x for x in lowest[2:] if x is not None), default=None)
    if top is None:
        return ()
    dropped = min(bottom, top)
    degree, top_degree = max(highest[:2]) - dropped, max(highest[2:]) - dropped
    if bottom > top or top_degree >= degree:
        return None
    return power_D, power_N, dropped, degree, top_degree


def network_index(mechanism: Mechanism, definition: IndexDefinition, place: str) -> NetworkIndex | None:
    """The index over the admittance of the network at `place`, which is a damper of that free value in `mechanism`.

    None where compiled code cannot give it: for several delays, or a spectrum that is no fraction.
    """
    problem = linear_problem(mechanism, definition, CONVENTIONS["exact"])
    several = np.ptp(problem.delays) > 0.0 or len(set(problem.sources)) < len(problem.sources)
    if several or problem.excesses or set(problem.descriptor.free) != {place}:
        return None
    outputs, inputs = problem.descriptor.outputs, problem.descriptor.inputs
    functions = port_functions(problem.descriptor, place, inputs, outputs)
    squares = problem.weights**2
    together = definition.combination is Combination.ROOT_OF_SQUARES
    rows: list[tuple[PortFunction, float, int]] = [
        (function, float(squares[k]), 0 if together else k) for k, row in enumerate(functions) for function in row
    ]
    return NetworkIndex(
        definition,
        tuple(function for function, *_ in rows),
        np.array([weight for _, weight, _ in rows]),
        np.array([float(group) for *_, group in rows]),
    )


def _free_struts(mechanism: Mechanism) -> list[Strut]:
    return [m for m in mechanism.struts if any(isinstance(e.value, Free | Tied) for e in m.network.elements())]


def has_one_free_strut(mechanism: Mechanism) -> bool:
    """Whether all free values are in one strut."""
    mounts = _free_struts(mechanism)
    own = {str(e.value.name) for m in mounts for e in m.network.elements() if isinstance(e.value, Free)}
    return len(mounts) == 1 and own.issuperset(mechanism.free_values())  # some may have no effect


def index_over_strut(vehicle: Vehicle, index: Index) -> IndexOverNetwork | None:
    """The index over the linearised network of the strut that has all free values.

    None where there is no such strut, and where compiled code cannot give the index.
    """
    mechanism = vehicle.mechanism()
    return definition_over_strut(mechanism, index.definition(mechanism))


def definition_over_strut(mechanism: Mechanism, definition: IndexDefinition) -> IndexOverNetwork | None:
    """`index_over_strut` from the definition of the index."""
    if not has_one_free_strut(mechanism):
        return None
    (mount,) = _free_struts(mechanism)
    network = linearise(mount.network).network
    if network is None or not all(type(element) in (Spring, Damper, Inerter) for element in network.elements()):
        return None
    probe = replace(mount, network=Damper(free(1.0, 2.0, PLACE), PLACE))
    probed = replace(mechanism, struts=tuple(probe if strut is mount else strut for strut in mechanism.struts))
    structure = structure_of(probed)
    try:
        if structure is None or not isinstance(definition, Hashable):
            found = network_index(probed, definition, PLACE)
        else:
            found = _remembered_index(_OpenIndex(structure, tuple(structure.values), definition))
    except InerterError:  # for an output of an element of the strut
        return None
    return None if found is None else found.over(network)


@dataclass(frozen=True)
class _OpenIndex:
    """Index definition of a mechanism with one network left open, by its structure and values."""

    structure: Structure
    values: tuple[float | Free, ...]
    definition: IndexDefinition


@lru_cache(maxsize=64)
def _remembered_index(wanted: _OpenIndex) -> NetworkIndex | None:
    return network_index(wanted.structure.mechanism, wanted.definition, PLACE)


_remembered: Any = lru_cache(64)(index_over_strut)  # designs of one layout may come in parts


def norms_over_strut(vehicle: Vehicle, index: Index, points: Mapping[str, Array]) -> Array | None:
    """The index at many values of the free values, by name, which are all in one strut; nan where it is not known.

    None where compiled code of networks cannot give it.
    """
    try:
        hash((vehicle, index))
        over = _remembered(vehicle, index)
    except TypeError:  # a mechanism, or an index with matrices
        over = index_over_strut(vehicle, index)
    if over is None:
        return None
    count = next(iter(points.values())).size
    values: Array = over.values(np.array([points[name] for name in over.names]).reshape(len(over.names), count).T)
    values[np.isinf(values)] = np.nan
    return values
