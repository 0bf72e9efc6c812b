"""Elongations of all elements in a simulated motion, also where no spring determines the place of an inner node."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import count

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.networks.elements import Bridge, CombinedNetwork, Network, Series
from inerter.networks.elements.roles import GuardRole
from inerter.networks.transform import UpsideDown, expand_elements, to_simulation
from inerter.simulation.trajectory import Trajectory
from inerter.systems.coordinates import clean, null_space
from inerter.systems.graph import full_graph
from inerter.systems.incidence import incidence_rows
from inerter.systems.lever_arms import RANK_TOLERANCE, independent_rows
from inerter.systems.outputs import Output, positioned_rows
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]


def elongations(run: Trajectory, mechanism: Mechanism) -> dict[str, dict[str, Matrix]]:
    """Elongation [m] of each element at `run.time`, by mount and by the label of the element; positive where longer.

    A further element of the same label in the same mount is `label 2`, and so on. What springs, gaps and coordinates
    determine is exact. Other nodes, such as that between a damper and an inerter, have velocities only: elongations of
    as few elements as tell where they are, friction first, are the integrals of their velocities by the trapezoidal
    rule, from elongations at the start that are as small as possible. The elongations around a loop add up to zero.
    """
    motion = _Motion.of(run, mechanism)
    found: dict[str, dict[str, Matrix]] = {}
    branches = count()
    for mount in mechanism.mounts():
        rows = found[mount.name] = {}
        for element in mount.network.elements():
            nodes, roads = _row_of(expand_elements(element, to_simulation), motion.next_row(branches))
            rows[_unique_label(element.label, rows)] = motion.elongation(nodes, roads)
    return found


def _unique_label(label: str, used: Mapping[str, object]) -> str:
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
    """Displacements of the nodes in a run: what springs, gaps and coordinates determine, and a few elongations."""

    run: Trajectory
    rows: Row  # of all branches
    loose: Matrix  # (nodes, m): an orthonormal basis of the motions that nothing determines
    chosen: tuple[int, ...] = ()  # branches whose elongations tell these
    moved: Matrix = field(default_factory=lambda: np.zeros((0, 0)))  # (m, samples): their elongations

    @classmethod
    def of(cls, run: Trajectory, mechanism: Mechanism) -> _Motion:
        graph = full_graph(mechanism)
        nodes, roads = incidence_rows(graph.branches, graph)
        loose = scipy.linalg.orth(null_space(positioned_rows(mechanism, graph)), rcond=RANK_TOLERANCE)
        motion = cls(run, (nodes, roads), loose)
        if not loose.size:
            return motion
        # a friction that sticks has exactly no velocity
        order = sorted(range(len(nodes)), key=lambda i: not graph.branches[i].element.switches_by(GuardRole.FORCE))
        chosen = [order[i] for i in independent_rows(clean(nodes @ loose)[order])]
        rates = np.array([run.evaluate(Output("", "", "", velocity=nodes[i], road_velocity=roads[i])) for i in chosen])
        steps = 0.5 * (rates[:, 1:] + rates[:, :-1]) * np.diff(run.time)
        moved = np.hstack([np.zeros((len(chosen), 1)), np.cumsum(steps, axis=1)])
        motion = replace(motion, chosen=tuple(chosen), moved=moved)
        start = np.array([motion.elongation(*row)[0] for row in zip(nodes, roads, strict=True)])
        free = nodes @ loose
        first = (free @ -np.linalg.lstsq(free, start, rcond=None)[0])[chosen]
        return replace(motion, moved=moved + first[:, None])

    def next_row(self, branches: Iterator[int]) -> Callable[[], Row]:
        """A function that gives the row of the next branch."""

        def row() -> Row:
            i = next(branches)
            return self.rows[0][i], self.rows[1][i]

        return row

    def elongation(self, nodes: Matrix, roads: Matrix) -> Matrix:
        """A combination of the displacements of nodes and roads at the samples."""
        if not self.chosen:
            return self.run.evaluate(Output("", "m", "", displacement=nodes, road=roads))
        told, told_roads = (rows[list(self.chosen)] for rows in self.rows)
        shares = clean(np.asarray(np.linalg.solve((told @ self.loose).T, self.loose.T @ nodes)))
        rest, rest_roads = clean(nodes - shares @ told), roads - shares @ told_roads
        return self.run.evaluate(Output("", "m", "", displacement=rest, road=rest_roads)) + shares @ self.moved
