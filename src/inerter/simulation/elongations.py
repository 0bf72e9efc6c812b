"""Elongations of all elements in a simulated motion, also where no spring determines the place of an inner node."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import count

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.networks.elements import Bridge, CombinedNetwork, Element, Network, Series
from inerter.networks.transform import UpsideDown, expand_elements
from inerter.simulation.trajectory import Trajectory
from inerter.systems.coordinates import null_space
from inerter.systems.graph import full_graph
from inerter.systems.incidence import incidence_rows
from inerter.systems.lever_arms import RANK_TOLERANCE
from inerter.systems.outputs import Output, positioned_rows
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]
_ROUNDING = 1e-12  # of a row that vanishes


def elongations(run: Trajectory, mechanism: Mechanism) -> dict[str, dict[str, Matrix]]:
    """Elongation [m] of each element at `run.time`, by mount and by the label of the element; positive where longer.

    A further element of the same label in the same mount is `label 2`, and so on. What springs, gaps and coordinates
    determine is exact. Other nodes, such as that between a damper and an inerter, have velocities only: their
    displacements are the integrals of these by the trapezoidal rule, from elongations at the start that are as small as
    possible. The elongations around a loop add up to zero.
    """
    motion = _Motion.of(run, mechanism)
    found: dict[str, dict[str, Matrix]] = {}
    branches = count()
    for mount in mechanism.mounts():
        rows = found[mount.name] = {}
        for element in mount.network.elements():
            nodes, roads = _row_of(expand_elements(element, _to_simulation), motion.next_row(branches))
            rows[_unused(element.label, rows)] = motion.elongation(nodes, roads)
    return found


def _to_simulation(element: Element) -> Network:
    return element.as_piecewise()


def _unused(label: str, used: Mapping[str, object]) -> str:
    names = (f"{label} {number}" if number > 1 else label for number in count(1))
    return next(name for name in names if name not in used)


Row = tuple[Matrix, Matrix]  # over nodes and roads


def _row_of(network: Network, next_row: Callable[[], Row]) -> Row:
    """Elongation of a network as a row, from those of its elements, which come in their order."""
    match network:
        case UpsideDown(turned):
            nodes, roads = _row_of(turned, next_row)
            return -nodes, -roads
        case CombinedNetwork(parts=parts):
            rows = [_row_of(part, next_row) for part in parts]
            along = rows if isinstance(network, Series) else rows[: 2 if isinstance(network, Bridge) else 1]
            return sum(nodes for nodes, _ in along), sum(roads for _, roads in along)  # type: ignore[return-value]
    return next_row()


@dataclass(frozen=True, eq=False)
class _Motion:
    """Displacements of the nodes in a run, in two parts."""

    run: Trajectory
    rows: Row  # of all branches
    determined: Matrix  # (n, nodes): an orthonormal basis of what springs, gaps and coordinates determine
    loose: Matrix  # (nodes, m): an orthonormal basis of the other motions
    moved: Matrix  # (m, samples): how far these have moved

    @classmethod
    def of(cls, run: Trajectory, mechanism: Mechanism) -> _Motion:
        graph = full_graph(mechanism)
        rows = incidence_rows(graph.branches, graph)
        known = positioned_rows(mechanism, graph)
        loose = scipy.linalg.orth(null_space(known), rcond=RANK_TOLERANCE)
        determined = scipy.linalg.null_space(loose.T) if loose.size else np.eye(len(graph.nodes))
        motion = cls(run, rows, determined.T, loose, np.zeros((loose.shape[1], run.time.size)))
        if not loose.size:
            return motion
        rates = np.array([run.evaluate(Output("", "", "", velocity=column)) for column in loose.T])
        moved = scipy.integrate.cumulative_trapezoid(rates, x=run.time, axis=1, initial=0)
        start = [motion.elongation(*row)[0] for row in zip(*rows, strict=True)]
        first = -np.linalg.lstsq(rows[0] @ loose, np.array(start), rcond=None)[0]
        return cls(run, rows, determined.T, loose, moved + first[:, None])

    def next_row(self, branches: Iterator[int]) -> Callable[[], Row]:
        """A function that gives the row of the next branch."""

        def row() -> Row:
            i = next(branches)
            return self.rows[0][i], self.rows[1][i]

        return row

    def elongation(self, nodes: Matrix, roads: Matrix) -> Matrix:
        """A combination of the displacements of nodes and roads at the samples."""
        placed = (nodes @ self.determined.T) @ self.determined
        placed = np.where(np.abs(placed) < _ROUNDING, 0.0, placed)
        return self.run.evaluate(Output("", "m", "", displacement=placed, road=roads)) + nodes @ self.loose @ self.moved
