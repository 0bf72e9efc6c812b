"""Outputs in the coordinates of a system: rows over its unknowns, states and inputs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from inerter.errors import LinearSystemError
from inerter.networks.elements import Element
from inerter.systems.coordinate_split import Frame, Long, Matrix, RowBlocks
from inerter.systems.graph import full_graph
from inerter.systems.outputs import Output, find, main_outputs, outputs

OutputStacks = tuple[Any, Any, Any]  # on eta, x and u


class Moving(Protocol):
    """Coordinates in which motions of nodes and roads, and external forces, are rows."""

    def blank(self) -> RowBlocks:
        """Rows of zeros."""
        ...

    def velocity(self, nodes: Matrix, roads: Matrix | None = None) -> RowBlocks:
        """The velocity of a combination of nodes and roads; no nodes are none that move."""
        ...

    def acceleration(self, nodes: Matrix) -> RowBlocks:
        """The acceleration of a combination of nodes that inertia carries."""
        ...

    def external(self, weights: Matrix) -> RowBlocks:
        """A combination of the external forces."""
        ...


def motion(moving: Moving, output: Output, nodes: int) -> RowBlocks:
    """An output's velocities, accelerations and external forces."""
    rows = moving.blank()
    if output.velocity.size or output.road_velocity.size:
        add(rows, moving.velocity(_row_or_zeros(output.velocity, nodes), output.road_velocity))
    if output.acceleration.size:
        add(rows, moving.acceleration(output.acceleration))
    if output.external.size:
        add(rows, moving.external(output.external))
    return rows


def add(rows: RowBlocks, more: Iterable[Matrix]) -> None:
    """Add rows to others in place."""
    for row, other in zip(rows, more, strict=True):
        row += other


@dataclass(frozen=True, eq=False)
class StackedOutput:
    """Output as stacks over the free values, with the sizes of their terms, and with its rate if it is a state."""

    name: str
    rows: OutputStacks
    sizes: OutputStacks
    state: RowBlocks | None  # its rate


def observe(frame: Frame, name: str) -> StackedOutput:
    """An output by name. Raises `LinearSystemError` for one that linear analysis does not have."""
    output = _resolve_output(frame, name)
    if output.displacement.size or output.road.size:
        return _displacement(frame, name, output)
    fixed = motion(frame, output, len(frame.graph.nodes))
    rows = _constant_stacks(frame, *(row.astype(np.longdouble) for row in fixed))
    sizes = _absolute(rows)
    for i in np.flatnonzero(output.forces):
        branch = frame.graph.branches[i]
        for stack, size, row in zip(rows, sizes, frame.across(branch), strict=True):
            term = _times_value(frame, branch.element, output.forces[i] * row)
            stack += term
            size += np.abs(term)
    return StackedOutput(name, rows, sizes, None)


def observed_by_default(frame: Frame) -> list[str]:
    """Names of the default outputs: motions and mounts that need no additional state."""
    return [name for name in main_outputs(frame.mechanism) if not _drifts(frame, frame.known[name])]


def _drifts(frame: Frame, output: Output) -> bool:
    roads = _row_or_zeros(output.road, len(frame.mechanism.roads))
    return bool(output.displacement.size) and frame.displacement(output.displacement, roads) is None


def _resolve_output(frame: Frame, name: str) -> Output:
    if name in frame.known:
        return frame.known[name]
    find(outputs(frame.mechanism, full_graph(frame.mechanism)), name, LinearSystemError)
    raise LinearSystemError(
        f"Output {name!r} is unknown in linear analysis, which neglects friction and treats gaps as closed. "
        f"Simulate the design: inerter simulate, or by expected-value or approximate-linear."
    )


def _displacement(frame: Frame, name: str, output: Output) -> StackedOutput:
    """A displacement: a combination of spring elongations, or a state that follows its velocity."""
    nodes = _row_or_zeros(output.displacement, len(frame.graph.nodes))
    roads = _row_or_zeros(output.road, len(frame.mechanism.roads))
    weights = frame.displacement(nodes, roads)
    rows = _constant_stacks(frame, *(frame.blank() if weights is None else frame.elongation(weights)))
    return StackedOutput(name, rows, _absolute(rows), frame.velocity(nodes, roads) if weights is None else None)


def _constant_stacks(frame: Frame, *rows: Any) -> OutputStacks:
    """Rows that no value changes."""
    k = len(frame.free)
    eta, x, u = (np.concatenate([row[None], np.zeros((k, row.size), row.dtype)]) for row in rows)
    return eta, x, u


def _times_value(frame: Frame, element: Element, row: Matrix) -> Long:
    """A row times an element's value."""
    stack = np.zeros((1 + len(frame.free), row.size), np.longdouble)
    place, factor = frame.slice_of(element)
    stack[place] = factor * row.astype(np.longdouble)
    return stack


def _absolute(rows: OutputStacks) -> OutputStacks:
    eta, x, u = map(np.abs, rows)
    return eta, x, u


def _row_or_zeros(row: Matrix, count: int) -> Matrix:
    """A row of an output, where an empty one is of zeros."""
    return row if row.size else np.zeros(count)
