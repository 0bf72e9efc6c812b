"""Equations of motion of a mechanism as one linear solve whose coefficients are affine in the element values.

With the states x = (velocities a, elongations g), the inputs u (road velocities, then forces) and the unknowns
eta = (accelerations of R and U, velocities of Y, elongations zeta, velocities of U) of `coordinates`:

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
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, LinearSystemError, MechanismError
from inerter.networks.elements import Damper, Element, Free, Inerter, Spring
from inerter.systems.coordinates import Coordinates, combination, find_coordinates
from inerter.systems.graph import Branch, Graph, linear_graph
from inerter.systems.linear import LinearSystem
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]


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


def close(descriptor: Descriptor, values: Mapping[str, float]) -> LinearSystem:
    """The linear system at the given values of the design variables.

    Raises `DesignError` if a variable has no value.
    """
    missing = [name for name in descriptor.variables if name not in values]
    if missing:
        raise DesignError(
            f"The value of {', '.join(missing)} is still free. Give numbers with with_values(...), or optimise first."
        )
    p = np.array([1.0, *(values[name] for name in descriptor.variables)])
    S, R, F, Y_eta, Y_x, Y_u = (
        np.tensordot(p, stack, 1)
        for stack in (descriptor.S, descriptor.R, descriptor.F, descriptor.Y_eta, descriptor.Y_x, descriptor.Y_u)
    )
    size = np.abs(S).max(axis=1, keepdims=True, initial=0.0)
    n = R.shape[1]
    scaled, right = S / size, np.hstack([R, F]) / size
    solved = np.linalg.solve(scaled, right)
    rest = right.astype(np.longdouble) - scaled.astype(np.longdouble) @ solved.astype(np.longdouble)
    solved = solved + np.linalg.solve(scaled, np.asarray(rest, dtype=float))
    T_x, T_u = solved[:, :n], solved[:, n:]
    if np.any(F):  # an input that reaches an acceleration by rounding only would make an r.m.s. value infinite
        T_u = np.where(np.abs(T_u) > 1e-14 * np.abs(np.linalg.inv(scaled)) @ np.abs(F / size), T_u, 0.0)
    return LinearSystem(
        A=descriptor.X_x + descriptor.X_eta @ T_x,
        B=descriptor.X_u + descriptor.X_eta @ T_u,
        C=Y_x + Y_eta @ T_x,
        D=Y_u + Y_eta @ T_u,
        states=descriptor.states,
        inputs=descriptor.inputs,
        outputs=descriptor.outputs,
        notes=descriptor.notes,
    )


def describe(
    mechanism: Mechanism, inputs: Sequence[str] | None = None, outputs: Sequence[str] | None = None
) -> Descriptor:
    """The descriptor of `mechanism` with the named roads and forces as inputs, and the named outputs.

    By default all inputs, and every output that needs no state of its own; the displacement of a body over a moving
    road is such a state (it drifts like the road) and comes only when it is named. A road that is not an input lies
    still. By name there are also, for every element, its `<label>_velocity` as an output, and `<label>_force` as an
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
    equations = _Equations(mechanism, graph, [n for n in dict.fromkeys((*names, *beside)) if n in chosen])
    equations.add_balance()
    for name in equations.possible_outputs() if outputs is None else outputs:
        equations.add_output(name)
    return equations.finish(chosen)


def is_held_by_springs(mechanism: Mechanism) -> bool:
    """Whether springs determine the position of every coordinate when all roads lie still."""
    equations = _Equations(mechanism, linear_graph(mechanism), [])
    still = np.zeros(len(mechanism.roads))
    rows = np.eye(len(equations.graph.nodes))[: len(mechanism.coordinates)]
    return all(equations.displacement(row, still) is not None for row in rows)


@dataclass
class _Equations:
    mechanism: Mechanism
    graph: Graph
    inputs: list[str]
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
        self.springs = [b for b in branches if isinstance(b.element, Spring)]
        self.spring_number = {id(branch): i for i, branch in enumerate(self.springs)}
        inerters = [b for b in branches if isinstance(b.element, Inerter)]
        for branch in inerters:
            if np.any(branch.roads):
                raise MechanismError(
                    f"Inerter {branch.label!r} is mounted on the road itself: its force follows the road's "
                    f"acceleration, which does not exist for a white road velocity. Mount it between moving parts."
                )
        self.spring_rows = np.array([b.nodes for b in self.springs]).reshape(-1, count)
        self.spring_roads = np.array([b.roads[self.road_columns] for b in self.springs]).reshape(
            len(self.springs), len(self.road_columns)
        )
        masses = np.eye(count)[: len(coordinates)]
        self.split: Coordinates = find_coordinates(
            self.graph.nodes,
            inertia=np.vstack([masses, *(b.nodes for b in inerters)]),
            damping=np.array([b.nodes for b in branches if isinstance(b.element, Damper)]).reshape(-1, count),
            springs=self.spring_rows,
            spring_roads=self.spring_roads,
            forces=self.force_rows,
        )
        c = self.split
        self.variables = self._variables()
        self.na, self.ng = c.R.shape[1], c.G.shape[1]
        sizes = [self.na, c.U.shape[1], c.Y.shape[1], c.Z.shape[1], c.U.shape[1]]
        edges = np.cumsum([0, *sizes])
        self.a1, self.u1, self.y, self.z, self.u0 = (slice(int(i), int(j)) for i, j in pairwise(edges))
        self.a, self.g = slice(0, self.na), slice(self.na, self.na + self.ng)
        k, n, e, m = 1 + len(self.variables), self.na + self.ng, int(edges[-1]), len(self.inputs)
        self.k, self.n, self.e, self.m = k, n, e, m
        self.S, self.R, self.F = np.zeros((k, e, e)), np.zeros((k, e, n)), np.zeros((k, e, m))
        self.rows: list[tuple[Matrix, Matrix, Matrix]] = []
        self.extra: list[tuple[str, Matrix, Matrix, Matrix]] = []  # integrators: name, rows on eta, x, u

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
        stack = np.zeros((self.k, *array.shape))
        value = element.value
        if isinstance(value, Free):
            stack[1 + list(self.variables).index(str(value.name))] = array
        else:
            stack[0] = value * array
        return stack

    def add_balance(self) -> None:
        """Rows of the balance of forces on R, U, Y, Z, and of momentum on U."""
        c = self.split
        masses = [
            Branch(Inerter(coordinate.inertia), coordinate.name, row, np.zeros(0))
            for coordinate, row in zip(self.mechanism.coordinates, np.eye(len(self.graph.nodes)), strict=False)
        ]
        for branch in (*masses, *self.graph.branches):
            on = np.zeros(self.e)  # how the element's force acts on each row of the balance
            on[self.a1], on[self.u1] = branch.nodes @ c.R, branch.nodes @ c.U
            on[self.y], on[self.z] = branch.nodes @ c.Y, branch.nodes @ c.Z
            eta, x, u = self._elongation_rate(branch)
            self.S += self._by_value(branch.element, np.outer(on, eta))
            self.R -= self._by_value(branch.element, np.outer(on, x))
            self.F -= self._by_value(branch.element, np.outer(on, u))
            if isinstance(branch.element, Inerter):
                momentum = np.zeros(self.e)
                momentum[self.u0] = branch.nodes @ c.U
                eta, x, _ = self._velocity(branch.nodes)
                self.S += self._by_value(branch.element, np.outer(momentum, eta))
                self.R -= self._by_value(branch.element, np.outer(momentum, x))
        for j, row in enumerate(self.force_rows):
            column = len(self.road_names) + j
            self.F[0, self.a1, column] = row @ c.R
            self.F[0, self.y, column] = row @ c.Y
            self.F[0, self.z, column] = row @ c.Z

    def _blank(self) -> tuple[Matrix, Matrix, Matrix]:
        return np.zeros(self.e), np.zeros(self.n), np.zeros(self.m)

    def _elongation_rate(self, branch: Branch) -> tuple[Matrix, Matrix, Matrix]:
        """What the element's value multiplies: its elongation, velocity or acceleration, as rows on eta, x and u."""
        eta, x, u = self._blank()
        match branch.element:
            case Inerter():
                eta[self.a1], eta[self.u1] = branch.nodes @ self.split.R, branch.nodes @ self.split.U
            case Damper():
                eta, x, u = self._velocity(branch.nodes, branch.roads)
            case Spring():
                row = np.zeros(len(self.springs))
                row[self.spring_number[id(branch)]] = 1.0
                eta, x = self._elongation(row)
        return eta, x, u

    def _velocity(self, nodes: Matrix, roads: Matrix | None = None) -> tuple[Matrix, Matrix, Matrix]:
        eta, x, u = self._blank()
        x[self.a] = nodes @ self.split.R
        eta[self.u0], eta[self.y] = nodes @ self.split.U, nodes @ self.split.Y
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
        """Names of the outputs that need no state of their own."""
        names = [f"{c.name}_{what}" for c in self.mechanism.coordinates for what in ("velocity", "acceleration")]
        names += [f"{strut.name}_force" for strut in self.mechanism.struts]
        names += [f"{tyre.name}_load" for tyre in self.mechanism.tyres]
        for name, (nodes, roads) in self._displacements().items():
            if self.displacement(nodes, roads) is not None:
                names.append(name)
        return names

    def _displacements(self) -> dict[str, tuple[Matrix, Matrix]]:
        still = np.zeros(len(self.mechanism.roads))
        found = {
            f"{coordinate.name}_displacement": (row, still)
            for coordinate, row in zip(self.mechanism.coordinates, np.eye(len(self.graph.nodes)), strict=False)
        }
        for strut in self.mechanism.struts:
            found[f"{strut.name}_travel"] = (self.graph.mounts[strut.name].nodes, still)
        for tyre in self.mechanism.tyres:
            mount = self.graph.mounts[tyre.name]
            found[f"{tyre.name}_deflection"] = (mount.nodes, mount.roads)
        return found

    def add_output(self, name: str) -> None:
        """One row of y: a velocity, an acceleration, a displacement, or the force of a mounted network."""
        coordinates = {c.name: self._port({c.name: 1.0}) for c in self.mechanism.coordinates}
        stem, _, what = name.rpartition("_")
        displacements = self._displacements()
        mounts = {m.name: "force" if m in self.mechanism.struts else "load" for m in self.mechanism.mounts()}
        branches = {branch.label: branch for branch in self.graph.branches}
        if stem in coordinates and what == "velocity":
            rows = self._constant(*self._velocity(coordinates[stem]))
        elif stem in coordinates and what == "acceleration":
            eta, x, u = self._blank()
            eta[self.a1], eta[self.u1] = coordinates[stem] @ self.split.R, coordinates[stem] @ self.split.U
            rows = self._constant(eta, x, u)
        elif name in displacements:
            rows = self._displacement_output(name, *displacements[name])
        elif mounts.get(stem) == what:
            rows = self._force(stem)
        elif stem in branches and what == "velocity":
            rows = self._constant(*self._velocity(branches[stem].nodes, branches[stem].roads))
        else:
            known = [*(f"{c}_{w}" for c in coordinates for w in ("velocity", "acceleration")), *displacements]
            known += [f"{mount}_{w}" for mount, w in mounts.items()]
            raise LinearSystemError(f"There is no output named {name!r} (there are: {', '.join(known)}).")
        self.rows.append(rows)
        self.outputs.append(name)

    def _constant(self, *rows: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        eta, x, u = (np.concatenate([row[None], np.zeros((self.k - 1, row.size))]) for row in rows)
        return eta, x, u

    def _displacement_output(self, name: str, nodes: Matrix, roads: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        weights = self.displacement(nodes, roads)
        if weights is not None:
            return self._constant(*self._elongation(weights), np.zeros(self.m))
        self.extra.append((name, *self._velocity(nodes, roads)))
        eta, x, u = self._constant(*self._blank())
        column = np.zeros((self.k, len(self.extra)))
        column[0, -1] = 1.0
        return eta, np.hstack([x, column]), u

    def _force(self, mount: str) -> tuple[Matrix, Matrix, Matrix]:
        eta, x, u = np.zeros((self.k, self.e)), np.zeros((self.k, self.n)), np.zeros((self.k, self.m))
        for i in self.graph.mounts[mount].carriers:
            branch = self.graph.branches[i]
            on_eta, on_x, on_u = self._elongation_rate(branch)
            eta += self._by_value(branch.element, on_eta)
            x += self._by_value(branch.element, on_x)
            u += self._by_value(branch.element, on_u)
        return eta, x, u

    def finish(self, order: list[str]) -> Descriptor:
        """All arrays, with integrators behind the other states and inputs in the order asked for."""
        c, q = self.split, len(self.extra)
        n = self.n + q
        X_eta, X_x, X_u = np.zeros((n, self.e)), np.zeros((n, n)), np.zeros((n, self.m))
        X_eta[self.a, self.a1] = np.eye(self.na)
        X_x[self.g, self.a], X_eta[self.g, self.y], X_u[self.g, : len(self.road_names)] = c.rates
        for i, (_, eta, x, u) in enumerate(self.extra, start=self.n):
            X_eta[i], X_x[i, : self.n], X_u[i] = eta, x, u
        Y_x = np.zeros((self.k, len(self.rows), n))
        for i, (_, x, _) in enumerate(self.rows):
            Y_x[:, i, : x.shape[1]] = x
        columns = [self.inputs.index(name) for name in order]
        return Descriptor(
            S=self.S,
            R=np.concatenate([self.R, np.zeros((self.k, self.e, q))], axis=2),
            F=self.F[:, :, columns],
            X_eta=X_eta,
            X_x=X_x,
            X_u=X_u[:, columns],
            Y_eta=np.array([eta for eta, _, _ in self.rows]).reshape(-1, self.k, self.e).swapaxes(0, 1).copy(),
            Y_x=Y_x,
            Y_u=np.array([u for _, _, u in self.rows]).reshape(-1, self.k, self.m).swapaxes(0, 1)[:, :, columns],
            states=self._state_names(),
            inputs=tuple(order),
            outputs=tuple(self.outputs),
            variables=self.variables,
            notes=self.graph.notes,
        )

    def _state_names(self) -> tuple[str, ...]:
        velocities = [f"{self.graph.nodes[int(np.argmax(column))]}_velocity" for column in self.split.R.T]
        elongations = []
        for row in self.split.P:
            labels = [self.springs[i].label for i in np.flatnonzero(row)]
            elongations.append("_".join(labels) + ("_elongation" if len(labels) == 1 else "_mean_elongation"))
        names = [*velocities, *elongations, *(name for name, *_ in self.extra)]
        return tuple(n if names.count(n) == 1 else f"{n}{names[: i + 1].count(n)}" for i, n in enumerate(names))
