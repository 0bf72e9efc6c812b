"""Rows over the nodes of a graph and over the roads: of branches, of what has inertia, of external forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inerter.networks.elements.roles import LinearRole
from inerter.systems.graph import Branch, Graph
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]


def of_law(graph: Graph, law: LinearRole) -> list[Branch]:
    """The branches whose element is so much to linear analysis."""
    return [branch for branch in graph.branches if branch.element.linear is law]


def incidence_rows(branches: Sequence[Branch], graph: Graph) -> tuple[Matrix, Matrix]:
    """Rows of some branches over nodes and over roads."""
    nodes, roads = len(graph.nodes), next((b.roads.size for b in graph.branches), 0)
    on_nodes = np.array([b.nodes for b in branches]).reshape(len(branches), nodes)
    return on_nodes, np.array([b.roads for b in branches]).reshape(len(branches), roads)


def inertias(mechanism: Mechanism, graph: Graph) -> tuple[Matrix, Matrix]:
    """Rows of what has inertia, coordinates first, then inerters, over nodes and over roads."""
    nodes, roads = incidence_rows(of_law(graph, LinearRole.MASS), graph)
    masses = np.eye(len(graph.nodes))[list(mechanism.masses)]
    return np.vstack([masses, nodes]), np.vstack([np.zeros((len(masses), roads.shape[1])), roads])


def inertia_values(mechanism: Mechanism, graph: Graph) -> Matrix:
    """The values of `inertias`, none of which is free."""
    inerters = (branch.element.coefficient for branch in of_law(graph, LinearRole.MASS))
    return np.array([*(coordinate.coefficient for coordinate in mechanism.masses.values()), *inerters])


def ports(mechanism: Mechanism, graph: Graph) -> Matrix:
    """Rows of the external forces over nodes."""
    rows = np.zeros((len(mechanism.forces), len(graph.nodes)))
    for i, force in enumerate(mechanism.forces):
        rows[i, : len(mechanism.coordinates)] = [force.port.get(c.name, 0.0) for c in mechanism.coordinates]
    return rows
