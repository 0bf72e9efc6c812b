"""Static equilibrium over roads that lie still.

It is found from forces, not from displacements: springs in loops between given ends share what strains the loop by
their compliances, which add up without cancellation. Every condition is one on elongations, so that neither the frame
in which heights are measured nor the direction in which a device is written matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SimulationError
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.systems.coordinates import dependencies, null_space
from inerter.systems.lever_arms import independent_rows
from inerter.systems.piecewise import PiecewiseSystem

Matrix = NDArray[np.float64]
_BALANCED = 1e-9  # of the sizes that are added up
_ROUNDING = 1e-13


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Static equilibrium, in which friction carries no force, or the least possible."""

    elongation: Matrix  # (branches,) of springs and gaps [m]; zero for others
    displacement: Matrix  # (nodes,) [m]


def equilibrium(system: PiecewiseSystem, road: Matrix, force: Matrix) -> Equilibrium:
    """The rest over `road` heights [m] under external `force` [N].

    Springs carry the load; a gap that carries some of it is closed. Gaps that are left to themselves are as close to
    their middle, and then other elements as close to no elongation, as the rest allows.

    Raises `SimulationError` if the springs cannot carry the load.
    """
    parts = _parts(system, road, force)
    loose = np.flatnonzero(parts.ends[:, 0] < parts.ends[:, 1])
    ways = [[side for side in (0, 1, -1) if not side or np.isfinite(_end(parts, int(i), side))] for i in loose]

    def closed_and_far(sides: tuple[int, ...]) -> tuple[int, float]:
        """Number of closed gaps, and the sum by which their elongations exceed those at the nearer ends."""
        ends = [(abs(_end(parts, int(i), side)), parts.ends[i]) for i, side in zip(loose, sides, strict=True) if side]
        return len(ends), sum(at - np.abs(both).min() for at, both in ends)

    for sides in sorted(product(*ways), key=closed_and_far):
        found = _touching(parts, {int(i): side for i, side in zip(loose, sides, strict=True) if side})
        if found is not None:
            return found
    way = "Give the initial state as an array" if np.any(own_forces(system)) else "Start at rest"
    raise SimulationError(
        "The static load is not carried by springs: some part of it rests on dampers, inerters or friction alone, "
        f"which cannot hold it. {way}, or add a spring where the load passes."
    )


@dataclass(frozen=True, eq=False)
class _Parts:
    """Branches as rows over nodes, with their elongations where no node is displaced, and the load on the nodes."""

    rows: Matrix
    offset: Matrix  # [m]
    load: Matrix  # [N]
    compliance: Matrix  # [m/N] of springs; zero for others
    ends: Matrix  # (branches, 2) of gaps [m]; zero for others
    springs: list[int]
    gaps: list[int]
    others: list[int]


def _parts(system: PiecewiseSystem, road: Matrix, force: Matrix) -> _Parts:
    branches = system.graph.branches
    springs = [i for i, b in enumerate(branches) if b.element.linear is LinearRole.STIFFNESS]
    gaps = [i for i, b in enumerate(branches) if b.element.switches_by(GuardRole.ELONGATION)]
    rows = np.array([b.nodes for b in branches]).reshape(len(branches), len(system.graph.nodes))
    compliance, ends = np.zeros(len(branches)), np.zeros((len(branches), 2))
    for i in springs:
        compliance[i] = 1.0 / branches[i].element.coefficient
    for i in gaps:
        ends[i] = branches[i].element.limits
    return _Parts(
        rows=rows,
        offset=np.array([b.roads for b in branches]).reshape(len(branches), road.size) @ road,
        load=force @ system.kinematics.ports - own_forces(system) @ rows,
        compliance=compliance,
        ends=ends,
        springs=springs,
        gaps=gaps,
        others=[i for i in range(len(branches)) if i not in springs and i not in gaps],
    )


def own_forces(system: PiecewiseSystem) -> Matrix:
    """The forces of all branches that act also at rest [N]: of a friction that cannot be without one, the smallest."""
    elements = [b.element for b in system.graph.branches]
    return np.array([np.clip(0.0, *e.limits) if e.switches_by(GuardRole.FORCE) else 0.0 for e in elements])


def _end(parts: _Parts, gap: int, side: int) -> float:
    """Elongation of a gap at its upper (`side` >= 0) or lower end [m]."""
    return float(parts.ends[gap, 0 if side < 0 else 1])


def _touching(parts: _Parts, closed: dict[int, int]) -> Equilibrium | None:
    """Equilibrium with exactly these gaps at their upper (1) or lower (-1) ends; None if there is none."""
    rigid = [i for i in parts.gaps if i in closed or not parts.ends[i, 0] < parts.ends[i, 1]]
    held, open_ = [*parts.springs, *rigid], [i for i in parts.gaps if i not in rigid]
    elongation = np.zeros(parts.offset.size)
    elongation[rigid] = [_end(parts, i, closed.get(i, 0)) for i in rigid]
    force = _forces(parts, held, parts.load, elongation[held] - parts.offset[held])
    if force is None:
        return None
    elongation[held] += parts.compliance[held] * force
    displacement = _solution(parts.rows[held], elongation[held] - parts.offset[held])
    ways = null_space(parts.rows[held])
    for branches in (open_, parts.others):
        displacement, ways = _shorten_branches(parts, branches, displacement, ways)
    elongation[open_] = _sum(parts.rows[open_], displacement, parts.offset[open_])
    lower, upper = parts.ends[open_].T
    if np.any(elongation[open_] < lower - _BALANCED * np.abs(lower)):
        return None
    if np.any(elongation[open_] > upper + _BALANCED * np.abs(upper)):
        return None
    # what does not press is at its end only if others would otherwise be further out
    toward = _forces(parts, held, -parts.rows[open_].T @ elongation[open_], np.zeros(len(held)))
    for i, side in closed.items():
        at, loaded = held.index(i), _BALANCED * np.abs(force).max()
        pressing = force[at] if abs(force[at]) > loaded or toward is None else toward[at]
        if side * pressing < 0.0:
            return None
    return Equilibrium(elongation, displacement)


def _forces(parts: _Parts, held: list[int], load: Matrix, given: Matrix) -> Matrix | None:
    """Forces in the held branches that balance `load`, with strains compatible with `given`; None if there are none.

    The stiffest branches carry the load; each other one closes a loop with them, around which a force is in balance.
    """
    order = np.argsort(parts.compliance[held], kind="stable")
    rows, give, given = parts.rows[held][order], parts.compliance[held][order], given[order]
    force, loops = np.zeros(len(held)), dependencies(rows)
    if np.any(load):
        stiffest = independent_rows(rows)
        force[stiffest] = _solution(rows[stiffest].T, load)
        if np.abs(rows.T @ force - load).max(initial=0.0) > _BALANCED * np.abs(load).max():
            return None
    misfit = _sum(loops.T, given + give * force)
    own = np.einsum("ij,i,ij->j", loops, give, loops)
    scale = 1.0 / np.sqrt(np.where(own > 0.0, own, 1.0))
    strained = scale[:, None] * (loops.T @ (give[:, None] * loops)) * scale
    try:  # elimination keeps the digits of small forces beside large ones
        around = np.linalg.solve(strained, scale * misfit)
    except np.linalg.LinAlgError:  # a loop of closed gaps alone
        around = _solution(strained, scale * misfit)
    force = force - loops @ (scale * around)
    strain = give * force
    if np.any(np.abs(loops.T @ (given + strain)) > _BALANCED * (np.abs(loops.T) @ (np.abs(given) + np.abs(strain)))):
        return None
    return np.asarray(force[np.argsort(order)])


def _shorten_branches(
    parts: _Parts, branches: Sequence[int], displacement: Matrix, ways: Matrix
) -> tuple[Matrix, Matrix]:
    """Displacements moved within `ways` to where some branches are shortest; and the ways that leave these alone."""
    rows = parts.rows[list(branches)]
    along = _sum(rows, ways)
    if not along.size:
        return displacement, ways
    far = _sum(rows, displacement, parts.offset[list(branches)])
    return displacement - ways @ _solution(along, far), ways @ null_space(along)


def _sum(rows: Matrix, x: Matrix, offset: Matrix | float = 0.0) -> Matrix:
    """Rows times x plus an offset, zero where that is rounding of the terms."""
    total = rows @ x + offset
    return np.where(np.abs(total) <= _ROUNDING * (np.abs(rows) @ np.abs(x) + np.abs(offset)), 0.0, total)


def _solution(rows: Matrix, right: Matrix) -> Matrix:
    """The least solution of least squares."""
    if not np.any(right):
        return np.zeros(rows.shape[1])
    return np.asarray(np.linalg.lstsq(rows, right, rcond=1e-12)[0])
