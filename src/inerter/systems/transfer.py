"""Transfer functions of a mechanism without any rounding.

A double is a whole number times a power of two, so masses and element values are exact; levers are the fractions that
they were meant to be (`systems.lever_arms`); and so the matrix M s^2 + C s + K of all nodes, massless ones included, is
exact at a whole number s. Its determinant and the solutions for the inputs, times it, are polynomials in s whose values
at enough such numbers give their coefficients. No states are chosen, and nothing is eliminated by rank.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import islice
from math import gcd as common
from math import lcm

import numpy as np

from inerter.networks.elements import Element, Free, Tied
from inerter.systems.graph import Graph
from inerter.systems.incidence import Matrix, ports
from inerter.systems.lever_arms import BranchRows
from inerter.systems.outputs import Output, force_of
from inerter.systems.polynomials import Polynomial, TransferFunctions, interpolate_integers, scale_by
from inerter.vehicle.mechanism import Mechanism

Row = dict[int, int]
Rows = tuple[Row, Row]  # over nodes and over roads
Load = tuple[int | None, Row, str]  # the number of a road, or the force on each node, and the name of the input


def transfer_functions(
    mechanism: Mechanism,
    graph: Graph,
    values: Mapping[str, float],
    inputs: Sequence[str],
    asked: Sequence[Output],
    *,
    reduced: bool,
) -> TransferFunctions:
    """Transfer functions from road velocities and forces `inputs` to the outputs `asked`, at these free `values`.

    Unless `reduced`, common factors are left: then numerators and denominator are polynomials of degree one in the
    value of each element, for whole values of it.
    """
    if mechanism.ground_moves:  # whose force has the masses as lever arms
        mechanism = mechanism.with_masses(values)
    nodal = _Nodal(mechanism, graph, values, asked)
    rows = [_OutputRow.of(output, whole, nodal) for output, whole in zip(asked, nodal.outputs, strict=True)]
    loads = [nodal.load(name) for name in inputs]
    samples = [nodal.sample(s, loads, rows) for s in range(1, 2 * len(graph.nodes) + 3)]
    denominator, *numerators = (interpolate_integers(column) for column in zip(*samples, strict=True))
    return nodal.to_transfer_functions(denominator, numerators, loads, rows, reduced)


@dataclass(frozen=True)
class _OutputRow:
    """An output as whole numbers: over nodes and roads by their power of s, and over branches."""

    nodes: tuple[Row, Row, Row]
    roads: tuple[Row, Row]
    forces: Row  # with their signs
    external: frozenset[str]  # forces that it is

    @staticmethod
    def of(output: Output, whole: Sequence[Rows], nodal: _Nodal) -> _OutputRow:
        """The row of an output whose displacement, velocity and acceleration are these, in whole numbers."""
        unit = 1 << nodal.value_bits if any(output.external) else 1  # in the units of forces, and then all else too
        (displacement, road), (velocity, road_velocity), (acceleration, _) = (_scale_rows(rows, unit) for rows in whole)
        return _OutputRow(
            (displacement, velocity, acceleration),
            (road, road_velocity),
            {i: int(sign) for i, sign in enumerate(output.forces) if sign},
            frozenset(name for name, weight in zip(nodal.names, output.external, strict=False) if weight),
        )


def _scale_rows(rows: Rows, unit: int) -> Rows:
    over_nodes, over_roads = ({i: unit * c for i, c in row.items()} for row in rows)
    return over_nodes, over_roads


@dataclass(frozen=True, eq=False)
class _WholeRows:
    """Rows over nodes and roads in whole numbers, times a unit: of branches, outputs and forces. They are only read."""

    lever_unit: int
    branches: list[Rows]
    outputs: list[tuple[Rows, ...]]
    forces: dict[str, Row]  # over nodes


@lru_cache(maxsize=64)
def _whole_rows(graph: Graph, asked: tuple[Output, ...], roads: int, names: tuple[str, ...], ends: bytes) -> _WholeRows:
    """Rows of a graph with this number of roads; the named external forces act on the nodes by the rows `ends`."""
    size = len(graph.nodes)
    pushed = dict(zip(names, np.frombuffer(ends).reshape(len(names), size), strict=True))
    pushed = {force_of(branch.label): -branch.nodes for branch in graph.branches} | pushed
    rows = [(branch.nodes, branch.roads) for branch in graph.branches]
    rows += [pair for output in asked for pair in _pairs(output)]
    rows += [(force, np.zeros(0)) for force in pushed.values()]
    joined = np.zeros((len(rows), size + roads))
    for row, (on_nodes, on_roads) in zip(joined, rows, strict=True):
        row[: on_nodes.size], row[size : size + on_roads.size] = on_nodes, on_roads
    exact = BranchRows.of(graph, range(roads)).exact_rows(joined)
    unit = lcm(*{x.denominator for row in exact for x in row})
    whole = ({i: int(x * unit) for i, x in enumerate(row) if x} for row in exact)
    rest = iter(
        [
            ({i: x for i, x in row.items() if i < size}, {i - size: x for i, x in row.items() if i >= size})
            for row in whole
        ]
    )
    on_branches = list(islice(rest, len(graph.branches)))
    on_outputs = [tuple(islice(rest, 3)) for _ in asked]
    return _WholeRows(unit, on_branches, on_outputs, dict(zip(pushed, (nodes for nodes, _ in rest), strict=True)))


def _pairs(output: Output) -> list[tuple[Matrix, Matrix]]:
    """The rows of an output over nodes, each with that over the roads that moves as it does."""
    return [
        (output.displacement, output.road),
        (output.velocity, output.road_velocity),
        (output.acceleration, np.zeros(0)),
    ]


class _Nodal:
    """M s^2 + C s + K in whole numbers: levers times `lever_unit`, values times 2^values, and so their products."""

    def __init__(
        self, mechanism: Mechanism, graph: Graph, values: Mapping[str, float], asked: Sequence[Output]
    ) -> None:
        self.graph, self.size = graph, len(graph.nodes)
        self.roads = [road.name for road in mechanism.roads]
        self.names = tuple(force.name for force in mechanism.forces)
        whole = _whole_rows(graph, tuple(asked), len(self.roads), self.names, ports(mechanism, graph).tobytes())
        self.lever_unit, self.outputs, self.forces = whole.lever_unit, whole.outputs, whole.forces
        numbers = [_coefficient(b.element, values) for b in graph.branches]
        masses = [0.0 if c.is_massless else _coefficient(c.element, values) for c in mechanism.coordinates]
        self.value_bits = max([*map(_bits, numbers), *map(_bits, masses)], default=0)
        self.masses = [_times(mass, self.value_bits) * self.lever_unit**2 for mass in masses]
        self.branches = [
            (_times(number, self.value_bits), b.element.linear.order, *row)
            for b, number, row in zip(graph.branches, numbers, whole.branches, strict=True)
        ]

    def load(self, name: str) -> Load:
        """An input by name."""
        return (self.roads.index(name), {}, name) if name in self.roads else (None, self.forces[name], name)

    def sample(self, s: int, loads: list[Load], rows: list[_OutputRow]) -> list[int]:
        """The determinant at s and, times it, all outputs for each input (the displacement of a road, or a force)."""
        powers = (1, s, s * s)
        P = [[0] * self.size for _ in range(self.size)]
        for i, mass in enumerate(self.masses):
            P[i][i] += mass * powers[2]
        F = [[0] * len(loads) for _ in range(self.size)]
        for number, order, nodes, roads in self.branches:
            stiffness = number * powers[order]
            for i, a in nodes.items():
                for j, b in nodes.items():
                    P[i][j] += stiffness * a * b
                for j, (road, *_) in enumerate(loads):
                    if road in roads:
                        F[i][j] -= stiffness * a * roads[road]
        for j, (_, force, _) in enumerate(loads):
            for i, lever in force.items():
                F[i][j] += lever
        determinant, X = solve_fraction_free(P, F)
        sampled = [determinant]
        for row in rows:
            for j, (road, _, name) in enumerate(loads):
                x = [line[j] for line in X]
                direct = determinant if name in row.external else 0
                sampled.append(direct + self._output(row, x, determinant, road, powers))
        return sampled

    def _output(
        self, row: _OutputRow, x: list[int], determinant: int, road: int | None, powers: tuple[int, ...]
    ) -> int:
        total = sum(lever * powers[k] * x[i] for k, over in enumerate(row.nodes) for i, lever in over.items())
        if road is not None:
            total += determinant * sum(over.get(road, 0) * powers[k] for k, over in enumerate(row.roads))
        for i, sign in row.forces.items():
            number, order, nodes, roads = self.branches[i]
            elongation = sum(lever * x[node] for node, lever in nodes.items())
            if road is not None:
                elongation += determinant * roads.get(road, 0)
            total += sign * number * powers[order] * elongation
        return total

    def to_transfer_functions(
        self,
        denominator: Polynomial,
        numerators: list[Polynomial],
        loads: list[Load],
        rows: list[_OutputRow],
        reduced: bool,
    ) -> TransferFunctions:
        """Transfer functions with 1/s for inputs that are road velocities; `reduced`: without common factors."""
        force = self.lever_unit << self.value_bits
        factors = [
            (1 if row.forces or row.external else 1 << self.value_bits) * (1 if road is not None else force)
            for row in rows
            for road, *_ in loads
        ]
        velocities = any(road is not None for road, *_ in loads)
        whole = [scale_by(n, factor) for n, factor in zip(numerators, factors, strict=True)]
        whole = [
            [0, *n] if velocities and road is None else n
            for n, (road, *_) in zip(whole, loads * len(rows), strict=True)
        ]
        bottom = scale_by([0, *denominator] if velocities else denominator, force)
        count = len(loads)
        if reduced:
            while bottom[0] == 0 and all(n[0] == 0 for n in whole if n):
                bottom, whole = bottom[1:], [n[1:] for n in whole]
            content = common(*bottom, *(c for n in whole for c in n))
            bottom, whole = [c // content for c in bottom], [[c // content for c in n] for n in whole]
        return TransferFunctions(bottom, tuple(tuple(whole[i * count : (i + 1) * count]) for i in range(len(rows))))


def solve_fraction_free(P: list[list[int]], F: list[list[int]]) -> tuple[int, list[list[int]]]:
    """The determinant of P, and P^-1 F times it, without fractions (Bareiss, 1968); all leading minors are positive."""
    n, before = len(P), 1
    rows = [[*p, *f] for p, f in zip(P, F, strict=True)]
    for k in range(n - 1):
        pivot, top = rows[k][k], rows[k]
        for i in range(k + 1, n):
            row, factor = rows[i], rows[i][k]
            for j in range(k + 1, len(row)):
                row[j] = (pivot * row[j] - factor * top[j]) // before
        before = pivot
    determinant = rows[-1][n - 1] if n else 1
    X = [[0] * len(f) for f in F]
    for i in range(n - 1, -1, -1):
        for j in range(len(F[i])):
            rest = sum(rows[i][m] * X[m][j] for m in range(i + 1, n))
            X[i][j] = (determinant * rows[i][n + j] - rest) // rows[i][i]
    return determinant, X


def _coefficient(element: Element, values: Mapping[str, float]) -> float | Fraction:
    value = element.value
    assert not isinstance(value, Tied)
    number = values[str(value.name)] if isinstance(value, Free) else value
    return number if element.gain == 1.0 else Fraction(number) * Fraction(element.gain)


def _bits(value: float | Fraction) -> int:
    """Number of doublings after which `value` is an integer."""
    return value.as_integer_ratio()[1].bit_length() - 1


def _times(value: float | Fraction, bits: int) -> int:
    """`value` doubled `bits` times, which is a whole number."""
    top, bottom = value.as_integer_ratio()
    return (top << bits) // bottom
