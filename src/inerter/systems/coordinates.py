"""State coordinates of a graph, found from its topology alone.

Not every node is a state, and not every spring is one either. Node velocities split into

- R: the ones that inertia makes states;
- U: motions that only inerters and masses resist and that nothing excites (the node between two inerters in series):
  their momentum stays zero, so they follow R at once;
- Y: motions without inertia that dampers resist, which follow from the balance of forces at once;
- Z: motions that only springs resist (the node between two springs in series), for which the springs settle at once;

and what is left over, W, is held by nothing and refused. Spring elongations span a space in which the springs' own
loops (two in parallel) and Z count once. The split depends on which elements are where, never on their values, so it
is made once for all designs of a layout.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, wraps

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from inerter.errors import MechanismError

Matrix = NDArray[np.float64]
_RANK_TOLERANCE = 1e-9  # incidence rows are scaled to one, and levers of a vehicle lie within a few decades


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Node velocities v = R a + U u + Y y + Z z; elongations e = G g + Z_e zeta; g' = P e'."""

    R: Matrix
    U: Matrix
    Y: Matrix
    Z: Matrix
    G: Matrix
    Z_e: Matrix
    P: Matrix


def find_coordinates(
    nodes: Sequence[str],
    inertia: Matrix,
    damping: Matrix,
    springs: Matrix,
    spring_roads: Matrix,
    forces: Matrix,
) -> Coordinates:
    """Split the motions of the nodes, and choose independent elongations.

    `inertia`, `damping`, `springs` hold one incidence row an element (elements, nodes); `spring_roads` the springs'
    rows over the roads; `forces` one row an external force (forces, nodes).

    Raises `MechanismError` for a node that is held by nothing.
    """
    n = len(nodes)
    loose = null_space(np.vstack([inertia, damping, springs]))
    if loose.shape[1]:
        node = nodes[int(np.argmax(np.abs(loose[:, 0])))]
        raise MechanismError(
            f"Node {node!r} is held by nothing: no mass, spring, damper or inerter resists its motion."
        )
    massless = null_space(inertia)
    Z = null_space(np.vstack([inertia, damping]))
    Y = complete(Z, massless)
    U = null_space(np.vstack([damping, springs]))
    U = U @ null_space(forces @ U)
    R = complete(np.hstack([U, massless]), np.eye(n))
    Z_e = springs @ Z
    off_Z = np.eye(springs.shape[0]) - Z_e @ pseudo_inverse(Z_e) if Z.shape[1] else np.eye(springs.shape[0])
    attainable = off_Z @ np.hstack([springs @ R, springs @ Y, spring_roads])
    chosen = independent_rows(attainable)
    G = clean(attainable @ pseudo_inverse(attainable[chosen])) if chosen else np.zeros((springs.shape[0], 0))
    return Coordinates(R, U, Y, Z, G, Z_e, clean(off_Z[chosen]))


def _remembered(function: Callable[..., Matrix]) -> Callable[..., Matrix]:
    """Remember results by what the matrices hold: incidence is the same for all designs of a layout."""

    @lru_cache(maxsize=512)
    def known(*keys: tuple[tuple[int, ...], bytes]) -> Matrix:
        result = function(*(np.frombuffer(data).reshape(shape) for shape, data in keys))
        result.flags.writeable = False
        return result

    @wraps(function)
    def remembering(*matrices: Matrix) -> Matrix:
        return known(*((m.shape, np.asarray(m, dtype=np.float64).tobytes()) for m in matrices))

    return remembering


@_remembered
def null_space(rows: Matrix) -> Matrix:
    """A basis (as columns) of the vectors that every row annihilates, with an identity block in it."""
    size = np.abs(rows).max(axis=1, initial=0.0)
    kept = rows[size > 0.0] / size[size > 0.0, None]
    if rows.shape[1] == 0 or kept.shape[0] == 0:
        return np.eye(rows.shape[1])
    basis = scipy.linalg.null_space(kept, rcond=_RANK_TOLERANCE)
    if basis.shape[1] == 0:
        return basis
    pivots = scipy.linalg.qr(basis.T, mode="r", pivoting=True)[1][: basis.shape[1]]
    return clean(np.linalg.solve(basis[pivots].T, basis.T).T)


@_remembered
def complete(basis: Matrix, candidates: Matrix) -> Matrix:
    """The first of the columns `candidates` that together with `basis` are independent and span all of them."""
    spanned = scipy.linalg.orth(basis).T if basis.size else np.zeros((0, candidates.shape[0]))
    return candidates[:, independent_rows(candidates.T, spanned)]


def independent_rows(rows: Matrix, spanned: Matrix | None = None) -> list[int]:
    """Numbers of the first rows that, with the orthonormal rows `spanned`, are independent and span all rows."""
    directions = np.zeros((0, rows.shape[1])) if spanned is None else spanned
    chosen: list[int] = []
    for i, row in enumerate(rows):
        size = np.linalg.norm(row)
        if size == 0.0:
            continue
        residual = row / size
        for _ in range(2):  # twice is enough for Gram-Schmidt
            residual = residual - directions.T @ (directions @ residual)
        if np.linalg.norm(residual) > _RANK_TOLERANCE:
            directions = np.vstack([directions, residual / np.linalg.norm(residual)])
            chosen.append(i)
    return chosen


@_remembered
def dependencies(rows: Matrix) -> Matrix:
    """Sums of rows that vanish, as columns: each row that depends on those before it, less what these make of it."""
    first = independent_rows(rows)
    rest = [i for i in range(len(rows)) if i not in first]
    found = np.zeros((len(rows), len(rest)))
    found[rest] = np.eye(len(rest))
    if first and rest:
        found[first] = -clean(rows[rest] @ np.linalg.pinv(rows[first])).T
    return found


@_remembered
def pseudo_inverse(matrix: Matrix) -> Matrix:
    """The Moore-Penrose inverse."""
    return np.asarray(np.linalg.pinv(matrix))


def clean(matrix: Matrix) -> Matrix:
    """Incidence arithmetic is exact but for rounding: zero is zero."""
    return np.where(np.abs(matrix) < 1e-13, 0.0, matrix)
