"""Frequency responses to hundreds of digits: of a mechanism by nodal equations, and of matrices as they are written."""

from __future__ import annotations

import numpy as np
from flint import acb, acb_mat, arb, ctx, fmpq
from nodal import _LAW, Nodal

from inerter import GROUND, Mechanism, NamedSystem

_BITS = 700


class _Unsolved(Nodal):
    """The placed elements of a mechanism, whose equations nobody has solved."""

    def _solve(self) -> None:
        pass


def of_mechanism(mechanism: Mechanism, s: list[acb], outputs: list[str], inputs: list[str]) -> list[acb_mat]:
    """Responses (outputs, inputs) at each s, of road velocities and forces."""
    placed = _Unsolved(mechanism, np.zeros(1))
    elements = [(e.value, _LAW[type(e)], *placed._rows(*ends)) for e, *ends in placed.elements]
    return [_nodal(mechanism, placed, elements, one, outputs, inputs) for one in s]


def of_matrices(system: NamedSystem, s: list[acb]) -> list[acb_mat]:
    """C (s E - A)^-1 B + D at each s."""
    A, B, C, D = (exact(M) for M in (system.A, system.B, system.C, system.D))
    E = exact(np.eye(len(system.A)) if system.E is None else system.E)
    return [C * (E * one - A).solve(B) + D for one in s]


def deviation(found: list[acb_mat], expected: list[acb_mat]) -> float:
    """Largest difference over the largest value of each channel, or of its output where it is silent."""
    size, off = (
        np.array([[[float(abs(x).mid()) for x in row] for row in M.table()] for M in several])
        for several in (expected, [f - e for f, e in zip(found, expected, strict=True)])
    )
    size = size.max(axis=0)
    whole = size.max(axis=1, keepdims=True)
    size = np.where(size < 1e-12 * whole, whole, size)
    return float(np.max(off.max(axis=0) / np.where(size > 0.0, size, 1.0), initial=0.0))


def at(frequencies: np.ndarray, growth: float = 0.0) -> list[acb]:
    """s = (j + growth) omega."""
    ctx.prec = _BITS
    return [acb(number(growth) * number(w), number(w)) for w in frequencies]


def number(x: float) -> arb:
    return arb(fmpq(*float(x).as_integer_ratio()))


def exact(matrix: np.ndarray) -> acb_mat:
    return acb_mat(*matrix.shape, [acb(number(x)) for x in matrix.ravel()])


def _nodal(mechanism: Mechanism, placed: Nodal, elements: list, s: acb, outputs: list, inputs: list) -> acb_mat:
    K, F = acb_mat(placed.size, placed.size), acb_mat(placed.size, len(placed.inputs))
    for i, coordinate in enumerate(mechanism.coordinates):
        K[i, i] += number(coordinate.inertia) * s * s
    for value, order, nodes, roads in elements:
        stiffness = number(value) * s**order
        for i in np.flatnonzero(nodes).tolist():
            for j in np.flatnonzero(nodes).tolist():
                K[i, j] += stiffness * number(nodes[i]) * number(nodes[j])
            for j in np.flatnonzero(roads).tolist():
                F[i, j] -= stiffness * number(nodes[i]) * number(roads[j])
    for j, force in enumerate(mechanism.forces):
        for name, lever in force.port.items():
            F[placed.coordinates.index(name), len(placed.roads) + j] += number(lever)
    X = K.solve(F)

    def along(nodes: np.ndarray, roads: np.ndarray, j: int) -> acb:
        moved = sum((number(nodes[i]) * X[i, j] for i in np.flatnonzero(nodes).tolist()), acb(0))
        return moved + (number(roads[j]) if j < len(placed.roads) else 0)

    def response(output: str, j: int) -> acb:
        stem, _, what = output.rpartition("_")
        if what in ("displacement", "velocity", "acceleration"):
            return X[placed.coordinates.index(stem), j] * s ** ("displacement", "velocity", "acceleration").index(what)
        if what in ("force", "load"):
            carried = (elements[i] for i in placed.carriers[stem])
            return sum((number(v) * s**order * along(nodes, roads, j) for v, order, nodes, roads in carried), acb(0))
        mount = next(one for one in (*mechanism.struts, *mechanism.tyres) if one.name == stem)
        if hasattr(mount, "port"):
            ends = placed._port(mount.port), {("road", mount.road): 1.0}
        else:
            ends = placed._port(mount.upper), placed._port(mount.lower or GROUND)
        return along(*placed._rows(*ends), j)

    places = [placed.inputs.index(name) for name in inputs]
    rows = [[response(o, j) / (s if j < len(placed.roads) else 1) for j in places] for o in outputs]
    return acb_mat(len(outputs), len(inputs), [x for row in rows for x in row])
