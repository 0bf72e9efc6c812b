"""Parts of a mechanism for time stepping: rows, inertia, and the reactions of frictions and gaps.

Every element is a row over nodes and one over roads; its elongation is what they make of displacements. Which motions
inertia carries, and which nothing does, follows from singular values of such rows, not from `systems.coordinates`, on
purpose: this integrator checks the one that is built on those, and shares no more with it than the mechanism's graph.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SimulationError
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.systems.graph import Branch, Graph
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]

SAME = 1e-9  # size below which a direction or a row of order 1 is taken for zero


@dataclass(frozen=True, eq=False)
class Reaction:
    """A gap, or all frictions side by side as one, with the share of its force that each of its branches has."""

    gap: bool
    lower: float  # end of the gap [m], or force [N]
    upper: float
    nodes: Matrix
    roads: Matrix
    shares: dict[int, float]

    @property
    def branch(self) -> int:
        """The first of its branches."""
        return next(iter(self.shares))

    @property
    def even(self) -> bool:
        """Whether the reaction is a friction with equal limits in both directions."""
        return not self.gap and -self.lower == self.upper

    @property
    def acts(self) -> bool:
        """Whether the limits differ: a gap with backlash, or a friction that can stick."""
        return self.lower < self.upper


@dataclass(frozen=True, eq=False)
class InertiaMatrix:
    """The singular inertia matrix M, its coupling B to the roads, its inverse on its range, its null directions."""

    M: Matrix
    B: Matrix
    inverse: Matrix
    massless: Matrix  # orthonormal columns


@dataclass(frozen=True, eq=False)
class Parts:
    """The mechanism as rows over nodes (E) and roads (R), and matrices over nodes."""

    branches: tuple[Branch, ...]
    E: Matrix
    R: Matrix
    ports: Matrix  # nodes x forces
    k: Matrix  # of each branch [N/m], zero if it is no spring
    c: Matrix
    b: Matrix
    masses: Matrix  # of each node [kg]
    reactions: tuple[Reaction, ...]

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return int(self.E.shape[1])

    @property
    def roads(self) -> int:
        """Number of roads."""
        return int(self.R.shape[1])

    @property
    def reaction_rows(self) -> tuple[Matrix, Matrix]:
        """Rows of the reactions over nodes and roads."""
        return _stack(self.reactions, self.nodes, self.roads)

    @cached_property
    def inertia(self) -> InertiaMatrix:
        """Inertia of masses and inerters."""
        M = np.diag(self.masses) + self.nodal(self.b, self.E)
        rows = np.vstack([np.eye(self.nodes)[self.masses > 0.0], unit_rows(self.E[self.b > 0.0])])
        carried, massless = range_and_null(rows)
        inverse = carried @ np.linalg.inv(carried.T @ M @ carried) @ carried.T
        return InertiaMatrix(M, self.nodal(self.b, self.R), inverse, massless)

    @property
    def massless(self) -> NDArray[np.bool_]:
        """Whether each node can move without inertia."""
        return np.asarray(np.linalg.norm(self.inertia.massless, axis=1) > SAME)

    def nodal(self, values: Matrix, rows: Matrix) -> Matrix:
        """Forces on the nodes of branches with forces value x row: sum of E' value row."""
        return (self.E.T * values) @ rows

    def unconstrained_directions(self, linear: NDArray[np.bool_]) -> Matrix:
        """Orthonormal directions that neither masses nor the branches in `linear` hold."""
        masses = np.diag(self.masses > 0.0).astype(float)
        return range_and_null(np.vstack([masses, unit_rows(self.E[linear])]))[1]


def parts_of(mechanism: Mechanism, graph: Graph) -> Parts:
    """Rows and values of all elements.

    Raises `SimulationError` if a value is still free.
    """
    if mechanism.free_values():
        free = ", ".join(mechanism.free_values())
        raise SimulationError(f"A simulation needs numbers, but there are free values: {free}. Fix them first.")
    n, names = len(graph.nodes), [c.name for c in mechanism.coordinates]
    ports = np.zeros((n, len(mechanism.forces)))
    for j, force in enumerate(mechanism.forces):
        for name, lever in force.port.items():
            ports[names.index(name), j] += lever
    masses = np.zeros(n)
    masses[: len(names)] = [c.coefficient for c in mechanism.coordinates]
    E, R = _stack(graph.branches, n, len(mechanism.roads))
    k, c, b = (
        np.array([branch.element.coefficient if branch.element.linear is law else 0.0 for branch in graph.branches])
        for law in (LinearRole.STIFFNESS, LinearRole.DAMPING, LinearRole.MASS)
    )
    return Parts(graph.branches, E, R, ports, k, c, b, masses, _reactions(graph.branches))


def _stack(rows: tuple[Branch, ...] | tuple[Reaction, ...], nodes: int, roads: int) -> tuple[Matrix, Matrix]:
    on_nodes = np.array([row.nodes for row in rows]).reshape(len(rows), nodes)
    return on_nodes, np.array([row.roads for row in rows]).reshape(len(rows), roads)


def _reactions(branches: tuple[Branch, ...]) -> tuple[Reaction, ...]:
    """Reactions: one for each gap, and one for all even frictions between the same ends; zero frictions have none."""
    found: list[Reaction] = []
    for i, branch in enumerate(branches):
        if branch.element.switch is None:
            continue
        lower, upper = branch.element.checked_limits()
        even, gap = -lower == upper, branch.element.switches_by(GuardRole.ELONGATION)
        beside = [j for j, other in enumerate(found) if even and other.even and _sense(branch, other)]
        if gap or not even:
            found.append(Reaction(gap, lower, upper, branch.nodes, branch.roads, {i: 1.0}))
        elif beside:
            other = found[beside[0]]
            shares = {**other.shares, i: _sense(branch, other) * upper}
            together = other.upper + upper
            found[beside[0]] = replace(other, lower=-together, upper=together, shares=shares)
        elif upper > 0.0:
            found.append(Reaction(False, lower, upper, branch.nodes, branch.roads, {i: upper}))
    return tuple(replace(r, shares={i: f / r.upper for i, f in r.shares.items()}) if r.even else r for r in found)


def _sense(branch: Branch, other: Reaction) -> float:
    """1 or -1 if a branch has the same two ends as a reaction, in this order or the other one; else 0."""
    row, beside = (np.concatenate([r.nodes, r.roads]) for r in (branch, other))
    return 1.0 if np.array_equal(row, beside) else -1.0 if np.array_equal(-row, beside) else 0.0


def check_gaps(parts: Parts) -> None:
    """Raises `SimulationError` if closing gaps stops inertia, or joins a road to the ground, with nothing between."""
    massless = parts.inertia.massless
    E, R = parts.reaction_rows
    gaps = np.array([r.gap for r in parts.reactions], dtype=bool)
    closed = gaps & np.array([not r.acts for r in parts.reactions], dtype=bool)

    def rigid(chosen: NDArray[np.bool_], rows: Matrix) -> int:
        impulses = range_and_null(massless.T @ E[chosen].T)[1]
        return rank(impulses.T @ rows[chosen])

    both = np.hstack([E, R])
    if rigid(gaps, both) > rigid(closed, both):
        raise SimulationError(
            "A gap has inertia or a given motion on both sides and no compliance: its impacts are undefined. "
            "Put a spring or damper in series with the gap."
        )
    if rigid(closed, both) > rigid(closed, E):
        raise SimulationError("Gaps of no width join a road to the ground rigidly. Put a spring in series with them.")


def unit_rows(rows: Matrix) -> Matrix:
    """Rows scaled to length 1; zero rows are unchanged."""
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.asarray(rows / np.where(length > 0.0, length, 1.0))


def range_and_null(rows: Matrix) -> tuple[Matrix, Matrix]:
    """Orthonormal columns that span the rows, which are of order 1, and those that are orthogonal to all of them."""
    if rows.shape[0] == 0 or rows.shape[1] == 0:
        return np.zeros((rows.shape[1], 0)), np.eye(rows.shape[1])
    _, size, V = np.linalg.svd(rows)
    found = int(np.sum(size > SAME))
    return V[:found].T, V[found:].T


def rank(rows: Matrix) -> int:
    """Number of independent rows, which are of order 1."""
    return int(range_and_null(rows)[0].shape[1])
