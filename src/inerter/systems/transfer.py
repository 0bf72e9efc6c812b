"""Transfer functions of a mechanism without any rounding.

A double is a whole number times a power of two, so masses, element values and levers are exact, and so is the matrix
M s^2 + C s + K of all nodes, massless ones included, at a whole number s. Its determinant and the solutions for the
inputs, times it, are polynomials in s whose values at enough such numbers give their coefficients. No states are
chosen, nothing is eliminated by rank, and no tolerance decides.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd as common
from typing import Any

from inerter.networks.elements import Element, Free, Tied
from inerter.systems.graph import Graph
from inerter.systems.outputs import Output, force_of, outputs
from inerter.systems.polynomials import Polynomial, TransferFunctions, interpolated, scaled
from inerter.vehicle.mechanism import Mechanism

Row = dict[int, int]
Load = tuple[int | None, Row, str]  # the number of a road, or the force on each node, and the name of the input


def transfer_functions(
    mechanism: Mechanism,
    graph: Graph,
    values: Mapping[str, float],
    inputs: Sequence[str],
    wanted: Sequence[str],
) -> TransferFunctions:
    """From road velocities and forces named `inputs` to the outputs named `wanted`, at `values` of the free values."""
    nodal = _Nodal(mechanism, graph, values)
    known = outputs(mechanism, graph)
    rows = [_Row.of(known[name], nodal) for name in wanted]
    loads = [nodal.load(name) for name in inputs]
    samples = [nodal.sample(s, loads, rows) for s in range(1, 2 * len(graph.nodes) + 3)]
    denominator, *numerators = (interpolated(column) for column in zip(*samples, strict=True))
    return nodal.assembled(denominator, numerators, loads, rows)


@dataclass(frozen=True)
class _Row:
    """An output as whole numbers: over nodes and roads by their power of s, and over branches."""

    nodes: tuple[Row, Row, Row]
    roads: tuple[Row, Row]
    forces: Row
    external: frozenset[str]  # forces that it is

    @staticmethod
    def of(output: Output, nodal: _Nodal) -> _Row:
        carried = any(output.external)  # in the units of forces, and then all else too

        def whole(row: Any) -> Row:
            return {i: c << (nodal.value_bits if carried else 0) for i, c in nodal.whole(row).items()}

        return _Row(
            (whole(output.displacement), whole(output.velocity), whole(output.acceleration)),
            (whole(output.road), whole(output.road_velocity)),
            {i: 1 for i, weight in enumerate(output.forces) if weight},
            frozenset(name for name, weight in zip(nodal.names, output.external, strict=False) if weight),
        )


class _Nodal:
    """M s^2 + C s + K in whole numbers: levers times 2^levers, values times 2^values, and so their products."""

    def __init__(self, mechanism: Mechanism, graph: Graph, values: Mapping[str, float]) -> None:
        self.graph, self.size = graph, len(graph.nodes)
        self.roads = [road.name for road in mechanism.roads]
        self.names = [force.name for force in mechanism.forces]
        ports = {force.name: force.port for force in mechanism.forces}
        names = [coordinate.name for coordinate in mechanism.coordinates]
        forces = {name: {names.index(at): lever for at, lever in port.items() if lever} for name, port in ports.items()}
        forces |= {
            force_of(branch.label): {i: -float(lever) for i, lever in enumerate(branch.nodes) if lever}
            for branch in graph.branches
        }
        levers = [float(x) for b in graph.branches for row in (b.nodes, b.roads) for x in row if x]
        levers += [lever for row in forces.values() for lever in row.values()]
        self.lever_bits = max([_bits(lever) for lever in levers], default=0)
        numbers = [_coefficient(b.element, values) for b in graph.branches]
        masses = [coordinate.inertia for coordinate in mechanism.coordinates]
        self.value_bits = max([*map(_bits, numbers), *map(_bits, masses)], default=0)
        self.masses = [_times(mass, self.value_bits + 2 * self.lever_bits) for mass in masses]
        self.branches = [
            (_times(number, self.value_bits), b.element.linear.order, self.whole(b.nodes), self.whole(b.roads))
            for b, number in zip(graph.branches, numbers, strict=True)
        ]
        self.forces = {
            name: {i: _times(lever, self.lever_bits) for i, lever in row.items()} for name, row in forces.items()
        }

    def whole(self, row: Any) -> Row:
        return {i: _times(float(x), self.lever_bits) for i, x in enumerate(row) if x}

    def load(self, name: str) -> Load:
        """An input by name."""
        return (self.roads.index(name), {}, name) if name in self.roads else (None, self.forces[name], name)

    def sample(self, s: int, loads: list[Load], rows: list[_Row]) -> list[int]:
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
        determinant, X = solved(P, F)
        sampled = [determinant]
        for row in rows:
            for j, (road, _, name) in enumerate(loads):
                x = [line[j] for line in X]
                direct = determinant if name in row.external else 0
                sampled.append(direct + self._output(row, x, determinant, road, powers))
        return sampled

    def _output(self, row: _Row, x: list[int], determinant: int, road: int | None, powers: tuple[int, ...]) -> int:
        total = sum(lever * powers[k] * x[i] for k, over in enumerate(row.nodes) for i, lever in over.items())
        if road is not None:
            total += determinant * sum(over.get(road, 0) * powers[k] for k, over in enumerate(row.roads))
        for i in row.forces:
            number, order, nodes, roads = self.branches[i]
            elongation = sum(lever * x[node] for node, lever in nodes.items())
            if road is not None:
                elongation += determinant * roads.get(road, 0)
            total += number * powers[order] * elongation
        return total

    def assembled(
        self, denominator: Polynomial, numerators: list[Polynomial], loads: list[Load], rows: list[_Row]
    ) -> TransferFunctions:
        """With the powers of two taken out, and 1/s where a road is given by its velocity."""
        both = self.value_bits + self.lever_bits
        shifts = [
            (both if road is None else 0) - (both if row.forces or row.external else self.lever_bits)
            for row in rows
            for road, *_ in loads
        ]
        low = min(shifts, default=0)
        velocities = any(road is not None for road, *_ in loads)
        whole = [scaled(n, 1 << (shift - low)) for n, shift in zip(numerators, shifts, strict=True)]
        whole = [
            [0, *n] if velocities and road is None else n
            for n, (road, *_) in zip(whole, loads * len(rows), strict=True)
        ]
        bottom = scaled([0, *denominator] if velocities else denominator, 1 << max(-low, 0))
        if low > 0:
            whole = [scaled(n, 1 << low) for n in whole]
        while bottom[0] == 0 and all(n[0] == 0 for n in whole if n):
            bottom, whole = bottom[1:], [n[1:] for n in whole]
        content = common(*bottom, *(c for n in whole for c in n))
        count = len(loads)
        reduced = [[c // content for c in n] for n in whole]
        return TransferFunctions(
            [c // content for c in bottom],
            tuple(tuple(reduced[i * count : (i + 1) * count]) for i in range(len(rows))),
        )


def solved(P: list[list[int]], F: list[list[int]]) -> tuple[int, list[list[int]]]:
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


def _coefficient(element: Element, values: Mapping[str, float]) -> Fraction:
    value = element.value
    assert not isinstance(value, Tied)
    return Fraction(values[str(value.name)] if isinstance(value, Free) else value) * Fraction(element.gain)


def _bits(value: float | Fraction) -> int:
    """How many times `value` must be doubled to be whole."""
    return value.as_integer_ratio()[1].bit_length() - 1


def _times(value: float | Fraction, bits: int) -> int:
    return int(Fraction(value) * (1 << bits))
