"""Indices of a mechanism in rational and ball arithmetic (python-flint): a second way that shares nothing with ours.

The nodal matrix M s^2 + C s + K is made from the mechanism's definition. Its determinant is the characteristic
polynomial of a companion matrix, shifted to where the nodal matrix is regular; a transfer function is a difference of
two such determinants (a change of rank one). Mean squares are residues at certified roots, and peaks are certified
roots of the slope.
"""

from __future__ import annotations

import math
from fractions import Fraction

import flint
import numpy as np
import pytest

from inerter import GROUND, Damper, Inerter, Mechanism, Norm, Spring, evaluate, evaluate_many
from inerter.indices.definition import Combination
from inerter.indices.excitation import RoadVelocity
from inerter.networks.elements import Bridge, Parallel, Series

_ORDER = {Spring: 0, Damper: 1, Inerter: 2}
INFINITE = "infinite"
S = flint.fmpq_poly([0, 1])


def rational(x: float) -> flint.fmpq:
    exact = Fraction(x)
    return flint.fmpq(exact.numerator, exact.denominator)


class RationalMechanism:
    """Transfer functions of a mechanism without free values."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.names = [c.name for c in mechanism.coordinates]
        self.roads = [r.name for r in mechanism.roads]
        self.size = len(self.names)
        self.branches: list[tuple[flint.fmpq, int, dict, dict]] = []
        self.carriers = {}
        for strut in mechanism.struts:
            self.carriers[strut.name] = self._mount(strut.network, self._end(strut.upper), self._end(strut.lower))
        for tyre in mechanism.tyres:
            self.carriers[tyre.name] = self._mount(tyre.network, self._end(tyre.port), self._end({tyre.road: 1.0}))
        n = self.size
        parts = [flint.fmpq_mat(n, n) for _ in range(3)]
        for i, coordinate in enumerate(mechanism.coordinates):
            parts[2][i, i] += rational(coordinate.inertia)
        for value, order, nodes, _ in self.branches:
            for i, a in nodes.items():
                for j, b in nodes.items():
                    parts[order][i, j] += value * a * b
        self.parts = parts
        self.denominator = self._determinant(None, None)
        self._known: dict = {}

    def _end(self, port: dict) -> dict:
        return {name: rational(lever) for name, lever in (port or GROUND).items() if lever}

    def _mount(self, network, upper: dict, lower: dict) -> list[int]:
        if isinstance(network, Parallel):
            return [i for part in network.parts for i in self._mount(part, upper, lower)]
        if isinstance(network, Series):
            ends = [upper]
            for _ in network.parts[1:]:
                ends.append({self.size: flint.fmpq(1)})
                self.size += 1
            ends.append(lower)
            placed = [self._mount(p, a, b) for p, a, b in zip(network.parts, ends[:-1], ends[1:], strict=True)]
            return placed[0]
        if isinstance(network, Bridge):
            left, right = ({self.size + i: flint.fmpq(1)} for i in range(2))
            self.size += 2
            carried = self._mount(network.a, upper, left) + self._mount(network.c, upper, right)
            for part, one, other in ((network.b, left, lower), (network.d, right, lower), (network.e, left, right)):
                self._mount(part, one, other)
            return carried
        nodes: dict[int, flint.fmpq] = {}
        roads: dict[str, flint.fmpq] = {}
        for end, sign in ((upper, 1), (lower, -1)):
            for name, lever in end.items():
                where, key = (roads, name) if name in self.roads else (nodes, self._number(name))
                where[key] = where.get(key, flint.fmpq(0)) + sign * lever
        self.branches.append((rational(network.value), _ORDER[type(network)], nodes, roads))
        return [len(self.branches) - 1]

    def _number(self, name) -> int:
        return name if isinstance(name, int) else self.names.index(name)

    def _determinant(self, row: dict | None, column: dict | None) -> flint.fmpq_poly:
        """det(M s^2 + C s + K + column row')."""
        n, shift = self.size, flint.fmpq(3)
        K, C, M = (flint.fmpq_mat(part) for part in self.parts)
        for i, a in (column or {}).items():
            for j, b in (row or {}).items():
                K[i, j] += a * b
        whole = M * shift**2 + C * shift + K
        scale = whole.det()
        if scale == 0:
            shift = flint.fmpq(7, 5)
            whole = M * shift**2 + C * shift + K
            scale = whole.det()
        X, Y = whole.solve(M * (2 * shift) + C), whole.solve(M)
        L = flint.fmpq_mat(2 * n, 2 * n)
        for i in range(n):
            L[n + i, i] = flint.fmpq(1)
            for j in range(n):
                L[i, j], L[i, n + j] = -X[i, j], -Y[i, j]
        coefficients = list(reversed(L.charpoly().coeffs()))
        return scale * flint.fmpq_poly(coefficients)(S - shift)

    def _solution(self, row: dict, column: dict) -> flint.fmpq_poly:
        """row' adj(P) column."""
        key = (
            tuple(sorted((k, str(v)) for k, v in row.items())),
            tuple(sorted((k, str(v)) for k, v in column.items())),
        )
        if key not in self._known:
            self._known[key] = self._determinant(row, column) - self.denominator
        return self._known[key]

    def response(self, output: str, source: str) -> tuple[flint.fmpq_poly, flint.fmpq_poly]:
        """Numerator and denominator, from a road's velocity or a force."""
        stem, _, what = output.replace("_relative_", "_").rpartition("_")
        loads = []  # (polynomial, constant column)
        if source in self.roads:
            for value, order, nodes, roads in self.branches:
                if roads.get(source):
                    loads.append((S**order * (-value * roads[source]), nodes))
        else:
            force = next(f for f in self.mechanism.forces if f.name == source)
            loads.append((flint.fmpq_poly([1]), {self._number(k): v for k, v in self._end(force.port).items()}))

        def moved(row: dict) -> flint.fmpq_poly:
            return sum((factor * self._solution(row, column) for factor, column in loads), flint.fmpq_poly([0]))

        if what in ("displacement", "velocity", "acceleration"):
            power = {"displacement": 0, "velocity": 1, "acceleration": 2}[what]
            top = S**power * moved({self.names.index(stem): flint.fmpq(1)})
            masses = {c.name for c in self.mechanism.coordinates if not c.angle}
            if source == "ground_acceleration" and what == "acceleration" and stem in masses:
                top += self.denominator
        elif what == "travel":
            strut = next(strut for strut in self.mechanism.struts if strut.name == stem)
            ends: dict = {}
            for end, sign in ((self._end(strut.upper), 1), (self._end(strut.lower), -1)):
                for name, lever in end.items():
                    ends[self._number(name)] = ends.get(self._number(name), flint.fmpq(0)) + sign * lever
            top = moved(ends)
        else:
            assert what in ("force", "load")
            top = flint.fmpq_poly([0])
            for i in self.carriers[stem]:
                value, order, nodes, roads = self.branches[i]
                stretched = moved(nodes) + self.denominator * roads.get(source, flint.fmpq(0))
                top += S**order * value * stretched
        return top, self.denominator * (S if source in self.roads else 1)


def mean_square(tops: list, bottom, times: list[float]):
    """Variance of the response to one white noise that arrives at `times`; INFINITE; or None if a pole is multiple."""
    common = bottom
    for top in tops:
        common = common.gcd(top)
    tops, bottom = [top // common for top in tops], bottom // common
    if all(top == 0 for top in tops):
        return flint.arb(0)
    if max(top.degree() for top in tops) >= bottom.degree():
        return INFINITE
    drifts = bottom[0] == 0
    if drifts and (bottom[1] == 0 or sum((top[0] for top in tops), flint.fmpq(0)) != 0):
        return INFINITE
    rest = bottom // S if drifts else bottom
    if rest.gcd(rest(-S)).degree() > 0:
        return INFINITE
    if rest.gcd(rest.derivative()).degree() > 0:
        return None
    for precision in (400, 1600, 6400):
        flint.ctx.prec = precision
        moved = rest * (S + flint.fmpq(1, 10**60)) if drifts else bottom  # a drift that dies out after 1e60 s
        found = _residues(tops, moved, times)
        if found.rel_accuracy_bits() > 60:
            return found
    raise ArithmeticError("more digits are needed")


def _residues(tops: list, bottom, times: list[float]):
    slope, mirrored = bottom.derivative(), bottom(-S)
    total = flint.acb(0)
    exact = [flint.arb(flint.fmpq(*time.as_integer_ratio())) for time in times]
    for pole, _ in bottom.complex_roots():
        below = _at(slope, pole) * _at(mirrored, pole)
        values, back = [_at(top, pole) for top in tops], [_at(top, -pole) for top in tops]
        for i, here in enumerate(exact):
            for j, there in enumerate(exact):
                if times[j] >= times[i]:
                    share = values[i] * back[j] * ((there - here) * pole).exp() / below
                    total += share if i == j or times[i] == times[j] else 2 * share
    return total.real


def _at(polynomial, x):
    total = flint.acb(0)
    for c in reversed(polynomial.coeffs()):
        total = total * x + flint.arb(c)
    return total


def peak_gain(top, bottom):
    """The largest gain over all frequencies, or INFINITE."""
    common = bottom.gcd(top)
    top, bottom = top // common, bottom // common
    if top == 0:
        return flint.arb(0)
    if bottom[0] == 0 or bottom.gcd(bottom(-S)).degree() > 0:
        return INFINITE
    p, q = (_squared(x) for x in (top, bottom))
    slope = p.derivative() * q - p * q.derivative()
    for precision in (400, 1600, 6400):
        flint.ctx.prec = precision
        places = [flint.arb(0)]
        if slope != 0:
            places += [x.real for x, _ in slope.complex_roots() if x.imag.contains(0) and x.real > 0]
        gains = [_at(p, flint.acb(x)).real / _at(q, flint.acb(x)).real for x in places]
        if top.degree() == bottom.degree():
            gains.append(flint.arb(p.leading_coefficient() / q.leading_coefficient()))
        best = gains[0]
        for gain in gains[1:]:
            best = best.max(gain)
        if best.rel_accuracy_bits() > 60:
            return best.sqrt()
    raise ArithmeticError("more digits are needed")


def _squared(p):
    square = (p * p(-S)).coeffs()
    return flint.fmpq_poly([c if i % 2 == 0 else -c for i, c in enumerate(square[0::2])])


def index_value(mechanism: Mechanism, index) -> float | str | None:
    """An index with the exact conventions; INFINITE; or None where a pole is multiple."""
    definition = index.definition(mechanism)
    on_road = isinstance(definition.drive, RoadVelocity)  # the whole mechanism, never half of it
    driven = mechanism if on_road else definition.drive.excited_mechanism(mechanism)
    paths, exact = definition.input_paths(driven), RationalMechanism(driven)
    if not definition.drive.is_random:
        (path,) = paths
        top, bottom = exact.response(definition.outputs[0].output, path.input)
        over, under = _filter(definition.filters[0])
        found = peak_gain(top * over * (S if path.displacement else 1), bottom * under)
        return found if found is INFINITE else abs(definition.outputs[0].weight) * float(found)
    sizes = []
    for output, passed in zip(definition.outputs, definition.filters, strict=True):
        square = _square(exact, paths, output.output, passed)
        if square is INFINITE or square is None:
            return square
        sizes.append(abs(output.weight) * float(square.sqrt()))
    power = 2 if definition.combination is Combination.ROOT_OF_SQUARES else 1
    return sum(size**power for size in sizes) ** (1.0 / power) * definition.drive.amplitude_density


def _square(exact: RationalMechanism, paths, output: str, passed):
    """The mean square of an output over all sources; INFINITE; or None."""
    total, over = flint.arb(0), _filter(passed)
    for source in {path.source for path in paths}:
        own = [path for path in paths if path.source == source]
        before = {path.filter: _filter(path.filter) for path in own}
        bottom, tops = over[1], []
        for _, under in before.values():
            bottom = bottom * under
        for path in own:
            top, below = exact.response(output, path.input)
            top = top * over[0] * before[path.filter][0] * rational(path.lever)
            for other, (_, under) in before.items():
                top = top * (under if other != path.filter else 1)
            tops.append(top)
        square = mean_square(tops, bottom * below, [path.delay for path in own])
        if square is INFINITE or square is None:
            return square
        total += square
    return total


def _filter(given):
    """Numerator and denominator of a filter; one over one of none."""
    if given is None:
        return S**0, S**0
    return tuple(flint.fmpq_poly([rational(c) for c in reversed(p)]) for p in (given.numerator, given.denominator))


def is_right(mechanism: Mechanism, index) -> bool:
    """Whether the norm has a value, which is right to 1e-9; False where it has none and says so, or none is known."""
    expected, found = index_value(mechanism, index), evaluate(mechanism, index, Norm())
    if expected is None or (math.isnan(found.value) and not found.status.ok):
        return False
    assert found.value == (math.inf if expected is INFINITE else pytest.approx(expected, rel=1e-9))
    return True


def assert_compiled_value(made: Mechanism, index, values: dict[str, float]) -> None:
    """Compiled code gives the value at these free values, or none."""
    (found,) = evaluate_many(made, index, values, Norm())[:, 0]
    assert np.isnan(found) or found == pytest.approx(index_value(made.with_values(values), index), rel=1e-9)


def assert_gradient(made: Mechanism, index, values: dict[str, float]) -> None:
    """The gradient over the free values is that of differences of fourth order of their logarithms."""
    objective, step = Norm().objective(made, index), 5e-4
    value, gradient = objective.value_and_gradient(np.array(list(values.values())))

    def at(name: str, shift: float):
        return index_value(made.with_values(values | {name: values[name] * math.exp(step * shift)}), index)

    for slope, name in zip(gradient, values, strict=True):
        near, far = (at(name, shift) - at(name, -shift) for shift in (1.0, 2.0))
        expected = (8.0 * near - far) / (12.0 * step)
        assert slope * values[name] == pytest.approx(expected, rel=0.0, abs=1e-7 * value)
