"""The balance of forces of a frame, and the size of its terms, as stacks over the free values."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from inerter.errors import LinearSystemError
from inerter.networks.elements import Element
from inerter.networks.elements.roles import LinearRole
from inerter.systems.coordinate_split import Frame, Long, Matrix, RowBlocks
from inerter.systems.graph import Branch
from inerter.vehicle.mechanism import GROUND_ACCELERATION


def balance(frame: Frame) -> tuple[Long, Long]:
    """S, -R and -F of `systems.descriptor` side by side (1 + values, eta, eta + x + u), and the sizes of their terms.

    Rows are the balances of forces on R, U, Y and Z, of momentum on U, and of how fast forces change on Z.

    Raises `LinearSystemError` for a force where only springs settle, if an output asks how fast.
    """
    k, e = 1 + len(frame.free), frame.unknowns
    terms = np.zeros((k, e, e + frame.states + len(frame.inputs)), np.longdouble)
    sizes = np.zeros_like(terms)
    for element, on, to in _parts(frame):
        place, factor = frame.slice_of(element)
        term = np.multiply.outer(factor * on.astype(np.longdouble), np.concatenate(to))
        terms[place] += term
        sizes[place] += np.abs(term)
    for j, (name, row) in enumerate(zip(frame.inputs[frame.roads :], frame.force_rows, strict=True)):
        column = e + frame.states + frame.roads + j
        for place, factor, part in _force_terms(frame, name, row):
            force = factor * _on_forces(frame, part).astype(np.longdouble)
            terms[place, :, column] -= force
            sizes[place, :, column] += np.abs(force)
    return terms, sizes


def _force_terms(frame: Frame, name: str, row: Matrix) -> Iterator[tuple[int, float, Matrix]]:
    """Slices, factors and rows of a force; ground acceleration acts on each mass in proportion to the mass."""
    if name != GROUND_ACCELERATION or not frame.mechanism.ground_moves:
        yield 0, 1.0, row
        return
    nodes = np.eye(row.size)
    for i, coordinate in frame.mechanism.masses.items():
        if not coordinate.angle:
            place, factor = frame.slice_of(coordinate.element)
            yield place, -factor, nodes[i]


def _parts(frame: Frame) -> Iterator[tuple[Element, Matrix, RowBlocks]]:
    """Masses and elements, each with its rows of the balance and the rows of the quantity its value multiplies."""
    at, nodes = frame.slots, np.eye(len(frame.graph.nodes))
    masses = [Branch(c.element, c.name, nodes[i], np.zeros(0)) for i, c in frame.mechanism.masses.items()]
    for branch in (*masses, *frame.graph.branches):
        on = np.zeros(frame.unknowns)
        on[at.a1], on[at.u1], on[at.y], on[at.z] = frame.split.rate(branch.nodes)
        yield branch.element, on, frame.across(branch)
        if branch.element.linear is LinearRole.MASS:
            momentum = np.zeros(frame.unknowns)
            momentum[at.u0] = on[at.u1]
            yield branch.element, momentum, frame.velocity(branch.nodes)
        if branch.element.linear is LinearRole.STIFFNESS and at.settles:
            change = np.zeros(frame.unknowns)
            change[at.z1] = on[at.z]
            yield branch.element, change, frame.velocity(branch.nodes, branch.roads)


def _on_forces(frame: Frame, row: Matrix) -> Matrix:
    """Rows of the force balance on which an external force acts (eta,)."""
    at, force = frame.slots, np.zeros(frame.unknowns)
    force[at.a1], _, force[at.y], force[at.z] = frame.split.rate(row)
    if at.settles and np.any(force[at.z]):
        at_once = ", ".join(node for node, lever in zip(frame.graph.nodes, row, strict=True) if lever)
        raise LinearSystemError(
            f"A force acts on {at_once}, which only springs hold: they follow it at once, and a force that jumps "
            "leaves them no velocity. Give it a mass, or a damper in parallel with a spring."
        )
    return force
