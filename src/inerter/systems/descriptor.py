"""Equations of motion of a mechanism as one linear solve whose coefficients are affine in the element values.

With the states x = (velocities a, elongations g), the inputs u (road velocities, then forces) and the unknowns
eta = (accelerations of R and U, velocities of Y, elongations zeta, velocities of U) of `coordinates`, and the
velocities of Z where an output asks for them:

    S(p) eta = R(p) x + F(p) u
    x'       = X_eta eta + X_x x + X_u u
    y        = Y_eta(p) eta + Y_x(p) x + Y_u(p) u

Each element adds its value times products of its incidence rows, so every array is a constant plus a sum over the
design variables p: an array (1 + m, ...) whose first slice is the constant. Road displacement never appears: the
tyre's elongation is a state and the road's velocity the input, which makes J1 and J3 plain H2 norms.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, LinearSystemError, MechanismError
from inerter.networks.elements import Element, Free, Inerter
from inerter.networks.elements.roles import Linear
from inerter.systems.coordinates import Coordinates, combination, find_coordinates
from inerter.systems.filters import Filter
from inerter.systems.graph import Branch, Graph, full_graph, linear_graph
from inerter.systems.linear import Fine, LinearSystem, Origin
from inerter.systems.outputs import Output, find, main_outputs, outputs
from inerter.systems.polynomials import TransferFunctions
from inerter.systems.transfer import transfer_functions
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]
Rows = tuple[Matrix, Matrix, Matrix]  # on eta, x and u
_ROUNDING = float(np.finfo(np.longdouble).eps)
_TERMS = 8  # roundings in an entry of A, B, C or D: those of its terms, their sums, their products and quotients


@dataclass(frozen=True, eq=False)
class Descriptor:
    """The arrays of the module's docstring, the names of everything, and the design variables with their bounds."""

    S: Matrix
    R: Matrix
    F: Matrix
    X_eta: Matrix
    X_x: Matrix
    X_u: Matrix
    Y_eta: Matrix
    Y_x: Matrix
    Y_u: Matrix
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    variables: dict[str, Free]
    notes: tuple[str, ...]
    sizes: tuple[Matrix, ...]  # of S, R, F, Y_eta, Y_x, Y_u: with the sizes of all terms in place of the terms
    mechanism: Mechanism
    graph: Graph
    filters: tuple[Filter | None, ...] = ()  # that the outputs pass through, if any do (see `filtered`)


def close(descriptor: Descriptor, values: Mapping[str, float]) -> LinearSystem:
    """The linear system at the given values of the design variables.

    Raises `DesignError` if a variable has no value.
    """
    missing = [name for name in descriptor.variables if name not in values]
    if missing:
        raise DesignError(
            f"The value of {', '.join(missing)} is still free. Give numbers with with_values(...), or optimise first."
        )
    p = np.array([1.0, *(values[name] for name in descriptor.variables)], dtype=np.longdouble)
    d = descriptor
    S, R, F, Y_eta, Y_x, Y_u = (_summed(p, stack) for stack in (d.S, d.R, d.F, d.Y_eta, d.Y_x, d.Y_u))
    S_size, R_size, F_size, Y_eta_size, Y_x_size, Y_u_size = (_summed(p.astype(float), stack) for stack in d.sizes)
    T, T_error = _solved(S, np.hstack([R, F]), S_size, np.hstack([R_size, F_size]))
    X, Y = np.hstack([d.X_x, d.X_u]), np.hstack([Y_x, Y_u])
    top, bottom = X + d.X_eta @ T, Y + Y_eta @ T
    size = np.abs(T).astype(float)
    with np.errstate(invalid="ignore"):  # nothing times infinite: as unsure
        top_error = np.abs(d.X_eta) @ (T_error + _ROUNDING * size) + _ROUNDING * np.abs(X)
        bottom_error = np.abs(Y_eta).astype(float) @ T_error
    bottom_error += _TERMS * _ROUNDING * (np.hstack([Y_x_size, Y_u_size]) + Y_eta_size @ size)
    n = R.shape[1]
    for matrix, error in ((top[:, n:], top_error[:, n:]), (bottom[:, n:], bottom_error[:, n:])):
        matrix[np.abs(matrix) <= error] = 0.0  # white noise that reaches an output by rounding only would be infinite
    errors = top_error[:, :n], top_error[:, n:], bottom_error[:, :n], bottom_error[:, n:]
    fine = Fine((top[:, :n], top[:, n:], bottom[:, :n], bottom[:, n:]), errors)
    A, B, C, D = (matrix.astype(float) for matrix in fine.matrices)
    return LinearSystem(
        A=A,
        B=B,
        C=C,
        D=D,
        states=d.states,
        inputs=d.inputs,
        outputs=d.outputs,
        notes=d.notes,
        origin=Origin(partial(_functions, d, dict(values)), (A, B, C, D), fine, d.inputs, d.outputs),
    )


def _summed(p: NDArray[Any], stack: Matrix) -> Matrix:
    return stack[0] if p.size == 1 else np.tensordot(p, stack, 1)


def _solved(S: Matrix, right: Matrix, S_size: Matrix, right_size: Matrix) -> tuple[Matrix, Matrix]:
    """S^-1 right in extended precision, and its error: infinite where S is singular to rounding."""
    size = np.abs(S).max(axis=1, keepdims=True, initial=0.0)
    scaled, right = S / size, right / size
    try:
        inverse = np.linalg.inv(scaled.astype(float))
    except np.linalg.LinAlgError:
        return np.zeros_like(right), np.full(right.shape, np.inf)
    solved = step = (inverse @ right.astype(float)).astype(np.longdouble)
    for _ in range(3):
        step = inverse @ (right - scaled @ solved).astype(float)
        solved = solved + step
    terms = (S_size @ np.abs(solved).astype(float) + right_size) / size.astype(float)
    return solved, np.abs(step) + _TERMS * _ROUNDING * (np.abs(inverse) @ terms)


def _functions(
    descriptor: Descriptor, values: Mapping[str, float], inputs: Sequence[str], outputs: Sequence[str]
) -> TransferFunctions:
    functions = transfer_functions(descriptor.mechanism, descriptor.graph, values, inputs, outputs)
    filters = dict(zip(descriptor.outputs, descriptor.filters, strict=False))
    chosen = [filters.get(name) for name in outputs]
    return functions.filtered([None if one is None else one.whole for one in chosen]) if any(chosen) else functions


def describe(
    mechanism: Mechanism, inputs: Sequence[str] | None = None, outputs: Sequence[str] | None = None
) -> Descriptor:
    """The descriptor of `mechanism` with the named roads and forces as inputs, and the named outputs.

    By default all inputs, and every output that needs no state of its own; the displacement of a body over a moving
    road is such a state (it drifts like the road) and comes only when it is named. A road that is not an input lies
    still. By name there is every other output of `systems.outputs` too, and, for every element, `<label>_force` as an
    input: a force beside the element, positive in tension.

    Raises `MechanismError` for what is ill-posed, `LinearSystemError` for a name that is not there.
    """
    graph = linear_graph(mechanism)
    names = [r.name for r in mechanism.roads] + [f.name for f in mechanism.forces]
    beside = [f"{branch.label}_force" for branch in graph.branches]
    chosen = list(names) if inputs is None else list(inputs)
    for name in chosen:
        if name not in (*names, *beside):
            raise LinearSystemError(f"There is no input named {name!r} (there are: {', '.join(names) or 'none'}).")
    equations = _Equations(
        mechanism, graph, [n for n in dict.fromkeys((*names, *beside)) if n in chosen], outputs or ()
    )
    equations.add_balance()
    for name in equations.possible_outputs() if outputs is None else outputs:
        equations.add_output(name)
    return equations.finish(chosen)


def is_held_by_springs(mechanism: Mechanism) -> bool:
    """Whether springs determine the position of every coordinate when all roads lie still."""
    equations = _Equations(mechanism, linear_graph(mechanism), [], ())
    still = np.zeros(len(mechanism.roads))
    rows = np.eye(len(equations.graph.nodes))[: len(mechanism.coordinates)]
    return all(equations.displacement(row, still) is not None for row in rows)


@dataclass
class _Equations:
    mechanism: Mechanism
    graph: Graph
    inputs: list[str]
    wanted: Sequence[str]
    outputs: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        branches = self.graph.branches
        coordinates = self.mechanism.coordinates
        count = len(self.graph.nodes)
        self.road_names = [r.name for r in self.mechanism.roads if r.name in self.inputs]
        self.road_columns = [i for i, r in enumerate(self.mechanism.roads) if r.name in self.inputs]
        pairs = {f"{branch.label}_force": -branch.nodes for branch in branches}
        rows = pairs | {force.name: self._port(force.port) for force in self.mechanism.forces}
        forces = [rows[name] for name in self.inputs if name not in self.road_names]
        self.force_rows = np.array(forces).reshape(len(forces), count)
        self.springs = [b for b in branches if b.element.linear is Linear.STIFFNESS]
        self.spring_number = {id(branch): i for i, branch in enumerate(self.springs)}
        inerters = [b for b in branches if b.element.linear is Linear.MASS]
        for branch in inerters:
            if np.any(branch.roads):
                raise MechanismError(
                    f"{branch.element.key.capitalize()} {branch.label!r} is mounted on the road itself: its force "
                    f"follows the road's acceleration, which does not exist for a white road velocity. Mount it "
                    f"between moving parts."
                )
        self.spring_rows = np.array([b.nodes for b in self.springs]).reshape(-1, count)
        self.spring_roads = np.array([b.roads[self.road_columns] for b in self.springs]).reshape(
            len(self.springs), len(self.road_columns)
        )
        masses = np.eye(count)[: len(coordinates)]
        self.split: Coordinates = find_coordinates(
            self.graph.nodes,
            inertia=np.vstack([masses, *(b.nodes for b in inerters)]),
            damping=np.array([b.nodes for b in branches if b.element.linear is Linear.DAMPING]).reshape(-1, count),
            springs=self.spring_rows,
            spring_roads=self.spring_roads,
            forces=self.force_rows,
        )
        c = self.split
        self.variables = self._variables()
        self.na, self.ng = c.R.shape[1], c.G.shape[1]
        self.known = outputs(self.mechanism, self.graph)
        sizes = [self.na, c.U.shape[1], c.Y.shape[1], c.Z.shape[1], c.U.shape[1], c.Z.shape[1] * self._settling()]
        edges = np.cumsum([0, *sizes])
        self.a1, self.u1, self.y, self.z, self.u0, self.z1 = (slice(int(i), int(j)) for i, j in pairwise(edges))
        self.a, self.g = slice(0, self.na), slice(self.na, self.na + self.ng)
        k, n, e, m = 1 + len(self.variables), self.na + self.ng, int(edges[-1]), len(self.inputs)
        self.k, self.n, self.e, self.m = k, n, e, m
        self.balance = np.zeros((k, e, e + n + m), np.longdouble)  # S, -R and -F beside each other
        self.size = np.zeros_like(self.balance)
        self.rows: list[Rows] = []
        self.row_sizes: list[Rows] = []
        self.extra: list[tuple[str, Matrix, Matrix, Matrix]] = []  # integrators: name, rows on eta, x, u

    def _settling(self) -> bool:
        """Whether an output asks how fast something moves that only springs hold."""
        asked = [self.known[name].velocity for name in self.wanted if name in self.known]
        return any(np.any(self.split.rate(row)[3]) for row in asked if row.size)

    def _variables(self) -> dict[str, Free]:
        elements = (branch.element for branch in self.graph.branches)
        return {str(e.value.name): e.value for e in elements if isinstance(e.value, Free)}

    def _port(self, port: Mapping[str, float]) -> Matrix:
        row = np.zeros(len(self.graph.nodes))
        for i, coordinate in enumerate(self.mechanism.coordinates):
            row[i] = port.get(coordinate.name, 0.0)
        return row

    def _by_value(self, element: Element, array: Matrix) -> Matrix:
        """`array` times the element's value, as a stack over the design variables."""
        stack = np.zeros((self.k, *array.shape), np.longdouble)
        value = element.value
        if isinstance(value, Free):
            stack[1 + list(self.variables).index(str(value.name))] = element.gain * array.astype(np.longdouble)
        else:
            stack[0] = element.coefficient * array.astype(np.longdouble)
        return stack

    def add_balance(self) -> None:
        """Rows of the balance of forces on R, U, Y, Z, of momentum on U, and of how fast forces change on Z."""
        c = self.split
        masses = [
            Branch(Inerter(coordinate.inertia), coordinate.name, row, np.zeros(0))
            for coordinate, row in zip(self.mechanism.coordinates, np.eye(len(self.graph.nodes)), strict=False)
        ]
        for branch in (*masses, *self.graph.branches):
            on = np.zeros(self.e)  # how the element's force acts on each row of the balance
            on[self.a1], on[self.u1], on[self.y], on[self.z] = c.rate(branch.nodes)
            self._add(branch.element, on, self._elongation_rate(branch))
            if branch.element.linear is Linear.MASS:
                momentum = np.zeros(self.e)
                momentum[self.u0] = on[self.u1]
                eta, x, _ = self._velocity(branch.nodes)
                self._add(branch.element, momentum, (eta, x, np.zeros(self.m)))
            if branch.element.linear is Linear.STIFFNESS and self.z1.stop > self.z1.start:
                change = np.zeros(self.e)
                change[self.z1] = on[self.z]
                self._add(branch.element, change, self._velocity(branch.nodes, branch.roads))
        for j, row in enumerate(self.force_rows):
            force = np.zeros(self.e)
            force[self.a1], _, force[self.y], force[self.z] = c.rate(row)
            if self.z1.stop > self.z1.start and np.any(force[self.z]):
                raise LinearSystemError(
                    "How fast springs settle between each other under a force that jumps is not known."
                )
            column = self.e + self.n + len(self.road_names) + j
            self.balance[0, :, column], self.size[0, :, column] = -force, np.abs(force)

    def _add(self, element: Element, on: Matrix, to: Rows) -> None:
        """Add an element that acts so on the rows of the balance."""
        value, place, on = element.value, 0, on.astype(np.longdouble)
        if isinstance(value, Free):
            place, on = 1 + list(self.variables).index(str(value.name)), element.gain * on
        else:
            on = element.coefficient * on
        term = np.multiply.outer(on, np.concatenate(to))
        self.balance[place] += term
        self.size[place] += np.abs(term)

    def _blank(self) -> Rows:
        return np.zeros(self.e), np.zeros(self.n), np.zeros(self.m)

    def _elongation_rate(self, branch: Branch) -> Rows:
        """What the element's value multiplies: its elongation, velocity or acceleration, as rows on eta, x and u."""
        eta, x, u = self._blank()
        match branch.element.linear:
            case Linear.MASS:
                eta[self.a1], eta[self.u1] = self.split.rate(branch.nodes)[:2]
            case Linear.DAMPING:
                eta, x, u = self._velocity(branch.nodes, branch.roads)
            case Linear.STIFFNESS:
                row = np.zeros(len(self.springs))
                row[self.spring_number[id(branch)]] = 1.0
                eta, x = self._elongation(row)
        return eta, x, u

    def _velocity(self, nodes: Matrix, roads: Matrix | None = None) -> Rows:
        eta, x, u = self._blank()
        x[self.a], eta[self.u0], eta[self.y], settling = self.split.rate(nodes)
        if self.z1.stop > self.z1.start:
            eta[self.z1] = settling
        if roads is not None and roads.size:
            u[: len(self.road_names)] = roads[self.road_columns]
        return eta, x, u

    def _elongation(self, springs: Matrix) -> tuple[Matrix, Matrix]:
        """A combination of spring elongations as rows on eta and x."""
        eta, x, _ = self._blank()
        x[self.g], eta[self.z] = springs @ self.split.G, springs @ self.split.Z_e
        return eta, x

    def displacement(self, nodes: Matrix, roads: Matrix) -> Matrix | None:
        """The combination of spring elongations that is this displacement whatever moves, if there is one."""
        return combination(
            np.hstack([self.spring_rows, self.spring_roads]), np.hstack([nodes, roads[self.road_columns]])
        )

    def possible_outputs(self) -> list[str]:
        """Names of what is asked for by default: motions and mounts, as far as they need no state of their own."""
        still = np.zeros(len(self.mechanism.roads))
        known = ((name, self.known[name]) for name in main_outputs(self.mechanism))
        return [
            name
            for name, output in known
            if not output.displacement.size
            or self.displacement(output.displacement, _or(output.road, still)) is not None
        ]

    def add_output(self, name: str) -> None:
        """One row of y: the sum of what the output is made of."""
        if name not in self.known and name in outputs(self.mechanism, full_graph(self.mechanism)):
            raise LinearSystemError(
                f"There is no output named {name!r} in linear analysis, which leaves friction out and closes gaps. "
                f"Simulate the design: simulate(...), ExpectedValue() or ApproximateLinear()."
            )
        output = find(self.known, name, LinearSystemError)
        rows = self._constant(*map(_fine, self._motion(output)))
        sizes = _absolute(rows)
        for i in np.flatnonzero(output.forces):
            branch = self.graph.branches[i]
            for stack, size, row in zip(rows, sizes, self._elongation_rate(branch), strict=True):
                term = self._by_value(branch.element, row)
                stack += term
                size += np.abs(term)
        if output.displacement.size or output.road.size:
            rows = self._with_displacement(name, output, rows)
            sizes = _absolute(rows)
        self.rows.append(rows)
        self.row_sizes.append(sizes)
        self.outputs.append(name)

    def _motion(self, output: Output) -> Rows:
        """An output's velocities, accelerations and external forces, as rows on eta, x and u."""
        eta, x, u = self._blank()
        if output.velocity.size or output.road_velocity.size:
            eta, x, u = self._velocity(_or(output.velocity, np.zeros(len(self.graph.nodes))), output.road_velocity)
        if output.acceleration.size:
            eta[self.a1], eta[self.u1] = self.split.rate(output.acceleration)[:2]
        for force, weight in zip(self.mechanism.forces, output.external, strict=False):
            if force.name in self.inputs:
                u[self.inputs.index(force.name)] += weight
        return eta, x, u

    def _constant(self, *rows: Matrix) -> Rows:
        eta, x, u = (np.concatenate([row[None], np.zeros((self.k - 1, row.size), row.dtype)]) for row in rows)
        return eta, x, u

    def _with_displacement(self, name: str, output: Output, rows: Rows) -> Rows:
        """An output that is a displacement: a combination of spring elongations, or a state of its own."""
        nodes = _or(output.displacement, np.zeros(len(self.graph.nodes)))
        roads = _or(output.road, np.zeros(len(self.mechanism.roads)))
        weights = self.displacement(nodes, roads)
        if weights is not None:
            return self._constant(*self._elongation(weights), np.zeros(self.m))
        self.extra.append((name, *self._velocity(nodes, roads)))
        eta, x, u = rows
        column = np.zeros((self.k, len(self.extra)))
        column[0, -1] = 1.0
        return eta, np.hstack([x, column]), u

    def finish(self, order: list[str]) -> Descriptor:
        """All arrays, with integrators behind the other states and inputs in the order asked for."""
        c, q = self.split, len(self.extra)
        n = self.n + q
        X_eta, X_x, X_u = np.zeros((n, self.e)), np.zeros((n, n)), np.zeros((n, self.m))
        X_eta[self.a, self.a1] = np.eye(self.na)
        X_x[self.g, self.a], X_eta[self.g, self.y], X_u[self.g, : len(self.road_names)] = c.rates
        for i, (_, eta, x, u) in enumerate(self.extra, start=self.n):
            X_eta[i], X_x[i, : self.n], X_u[i] = eta, x, u
        columns = [self.inputs.index(name) for name in order]
        Y, Y_sizes = (self._output_stacks(rows, columns) for rows in (self.rows, self.row_sizes))
        S, R, F = self._balance_stacks(self.balance, columns)
        return Descriptor(
            S=S,
            R=-R,
            F=-F,
            X_eta=X_eta,
            X_x=X_x,
            X_u=X_u[:, columns],
            Y_eta=Y[0],
            Y_x=Y[1],
            Y_u=Y[2],
            states=self._state_names(),
            inputs=tuple(order),
            outputs=tuple(self.outputs),
            variables=self.variables,
            notes=self.graph.notes,
            sizes=tuple(size.astype(float) for size in (*self._balance_stacks(self.size, columns), *Y_sizes)),
            mechanism=self.mechanism,
            graph=self.graph,
        )

    def _balance_stacks(self, balance: Matrix, columns: list[int]) -> list[Matrix]:
        """Stacks over eta, over all states, and over the inputs in the order asked for."""
        S, R, F = np.split(balance, [self.e, self.e + self.n], axis=2)
        later = np.zeros((self.k, self.e, len(self.extra)), balance.dtype)
        return [S, np.concatenate([R, later], axis=2), F[:, :, columns]]

    def _output_stacks(self, rows: list[Rows], columns: list[int]) -> list[Matrix]:
        """Rows of the outputs, some of which were added before the last state, as stacks over eta, x and u."""
        widths = (self.e, self.n + len(self.extra), self.m)
        stacks = [np.zeros((self.k, len(rows), width), np.longdouble) for width in widths]
        for i, over in enumerate(rows):
            for stack, row in zip(stacks, over, strict=True):
                stack[:, i, : row.shape[1]] = row
        return [*stacks[:2], stacks[2][:, :, columns]]

    def _state_names(self) -> tuple[str, ...]:
        velocities = [f"{self.graph.nodes[int(np.argmax(column))]}_velocity" for column in self.split.R.T]
        elongations = []
        for row in self.split.P:
            labels = [self.springs[i].label for i in np.flatnonzero(row)]
            elongations.append("_".join(labels) + ("_elongation" if len(labels) == 1 else "_mean_elongation"))
        names = [*velocities, *elongations, *(name for name, *_ in self.extra)]
        return tuple(n if names.count(n) == 1 else f"{n}{names[: i + 1].count(n)}" for i, n in enumerate(names))


def _absolute(rows: Rows) -> Rows:
    eta, x, u = rows
    return np.abs(eta), np.abs(x), np.abs(u)


def _fine(array: Matrix) -> Matrix:
    return array.astype(np.longdouble)


def _or(row: Matrix, none: Matrix) -> Matrix:
    """A row of an output, where an empty one is of zeros."""
    return row if row.size else none
