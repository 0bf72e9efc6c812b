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
from dataclasses import dataclass, field
from functools import lru_cache, wraps

import numpy as np
from numpy.typing import NDArray

from inerter.errors import MechanismError
from inerter.systems import exact_rank
from inerter.systems.exact_rank import FractionRows
from inerter.systems.lever_arms import (
    RANK_TOLERANCE,
    BranchRows,
    distinct_columns,
    independent_rows,
    orthonormal_null_space,
)

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Node velocities v = R a + U u + Y y + Z z; elongations e = G g + Z_e zeta; g' = P e'.

    `rates` gives g' over a, y and the roads. A share of the roads' shape that nothing can relax, as three axles under
    a rigid body keep it in their tyres, is an elongation of its own whose rate over a and y is zero.
    """

    R: Matrix
    U: Matrix
    Y: Matrix
    Z: Matrix
    G: Matrix
    Z_e: Matrix
    P: Matrix
    rates: tuple[Matrix, Matrix, Matrix]
    motions: FractionRows  # R, U, Y and Z in fractions, a column each
    span: BranchRows
    known: dict[bytes, list[Matrix]] = field(default_factory=dict)  # what `rate` has found

    def rate(self, nodes: Matrix) -> list[Matrix]:
        """The velocity of a combination of nodes over a, u, y and z; what is zero is zero."""
        key = nodes.tobytes()
        if key not in self.known:
            row = exact_rank.product(self.span.exact_rows(nodes[None]), self.motions, nodes.size)
            edges = np.cumsum([self.R.shape[1], self.U.shape[1], self.Y.shape[1]])
            self.known[key] = np.split(exact_rank.to_matrix(row, nodes.size)[0], edges)
        return self.known[key]


def find_coordinates(
    nodes: Sequence[str],
    inertia: Matrix,
    damping: Matrix,
    springs: Matrix,
    spring_roads: Matrix,
    forces: Matrix,
    span: BranchRows,
) -> Coordinates:
    """Split the motions of the nodes, and choose independent elongations.

    `inertia`, `damping`, `springs` hold one incidence row an element (elements, nodes); `spring_roads` the springs'
    rows over the roads; `forces` one row an external force (forces, nodes); `span` tells which levers are one.

    Raises `MechanismError` for a node that is held by nothing.
    """
    found = _analyse_graph(span, *((m.shape, m.tobytes()) for m in (inertia, damping, springs, spring_roads, forces)))
    if isinstance(found, int):
        raise MechanismError(
            f"Node {nodes[found]!r} is unconstrained: no mass, spring, damper or inerter resists its motion."
        )
    return found


def combination(span: BranchRows, rows: Matrix, target: Matrix) -> Matrix | None:
    """Numbers with which the rows, over nodes and perhaps roads, add up to `target`; None if they cannot."""
    return _combination(span, rows.shape, rows.tobytes(), target.tobytes())


@lru_cache(maxsize=512)
def _combination(span: BranchRows, shape: tuple[int, int], rows: bytes, target: bytes) -> Matrix | None:
    matrix, wanted = np.frombuffer(rows).reshape(shape), np.frombuffer(target)[None]
    found = exact_rank.weights(span.exact_rows(matrix), span.exact_rows(wanted))[0]
    return None if found is None else exact_rank.to_matrix([found], shape[0])[0]


@lru_cache(maxsize=512)
def _analyse_graph(span: BranchRows, *matrices: tuple[tuple[int, ...], bytes]) -> Coordinates | int:
    """Coordinates of a graph, or the number of an unconstrained node; cached for all designs of a layout."""
    n, roads = matrices[0][0][1], matrices[3][0][1]
    given = [np.frombuffer(data).reshape(shape) for shape, data in matrices]
    inertia, damping, forces = exact_rank.exact(given[0]), span.exact_rows(given[1]), span.exact_rows(given[4])
    both = span.exact_rows(np.hstack([given[2], given[3]]))
    springs, spring_roads = [row[:n] for row in both], [row[n:] for row in both]
    loose = exact_rank.null_space([*inertia, *damping, *springs], n)
    if loose:
        return max(range(n), key=lambda i: abs(loose[0][i]))
    eye = exact_rank.exact(np.eye(n))
    massless = exact_rank.null_space(inertia, n)
    Z = exact_rank.null_space([*inertia, *damping], n)
    Y = [massless[i] for i in exact_rank.independent(massless, Z)]
    U = exact_rank.null_space([*damping, *springs], n)
    pushed = exact_rank.product(forces, exact_rank.transpose(U, n), len(U))
    U = exact_rank.product(exact_rank.null_space(pushed, len(U)), U, n)
    R = [eye[i] for i in exact_rank.independent(eye, [*U, *massless])]
    stretched = exact_rank.transpose(
        exact_rank.product(Z, exact_rank.transpose(springs, n), len(springs)), len(springs)
    )
    off_Z = _project_out(stretched, len(Z))
    over_a, over_y = (exact_rank.product(springs, exact_rank.transpose(motions, n), len(motions)) for motions in (R, Y))
    stretched_by = [[*a, *y, *u] for a, y, u in zip(over_a, over_y, spring_roads, strict=True)]
    moved, width = len(R) + len(Y), len(R) + len(Y) + roads
    attainable = exact_rank.product(off_Z, stretched_by, width)
    P = _independent_elongations(attainable, off_Z, moved)
    rates = exact_rank.product(P, stretched_by, width)
    whole = exact_rank.to_matrix(rates, width)
    return Coordinates(
        R=exact_rank.to_matrix(R, n).T,
        U=exact_rank.to_matrix(U, n).T,
        Y=exact_rank.to_matrix(Y, n).T,
        Z=exact_rank.to_matrix(Z, n).T,
        G=exact_rank.to_matrix(_shares(rates, attainable), len(P)),
        Z_e=exact_rank.to_matrix(stretched, len(Z)),
        P=exact_rank.to_matrix(P, len(springs)),
        rates=(whole[:, : len(R)], whole[:, len(R) : moved], whole[:, moved:]),
        motions=exact_rank.transpose([*R, *U, *Y, *Z], n),
        span=span,
    )


def _shares(rows: FractionRows, targets: FractionRows) -> FractionRows:
    """`exact_rank.weights` of targets that lie in the span of the rows."""
    return [found for found in exact_rank.weights(rows, targets) if found is not None]


def _project_out(columns: FractionRows, count: int) -> FractionRows:
    """The projection that takes the span of so many independent columns out."""
    size = len(columns)
    turned = exact_rank.transpose(columns, count)
    square = exact_rank.product(turned, columns, count)
    inverse = _shares(square, exact_rank.exact(np.eye(count)))
    spanned = exact_rank.product(exact_rank.product(columns, inverse, count), turned, size)
    eye = exact_rank.exact(np.eye(size))
    return [[x - y for x, y in zip(one, other, strict=True)] for one, other in zip(eye, spanned, strict=True)]


def _independent_elongations(attainable: FractionRows, off_Z: FractionRows, moved: int) -> FractionRows:
    """Combinations of springs whose elongations are independent: first of those that motions stretch, then of what is
    left of the others when these are taken out, which only roads stretch.
    """
    motions = [row[:moved] for row in attainable]
    first = exact_rank.independent(motions)
    others = exact_rank.independent(attainable, [attainable[i] for i in first])
    taken = _shares([motions[i] for i in first], [motions[i] for i in others])
    P = [off_Z[i] for i in first]
    away = exact_rank.product(taken, P, len(off_Z))
    return P + [[x - y for x, y in zip(off_Z[i], row, strict=True)] for i, row in zip(others, away, strict=True)]


def _cache_by_content(function: Callable[..., Matrix]) -> Callable[..., Matrix]:
    """Remember results by what the matrices hold: incidence is the same for all designs of a layout."""

    @lru_cache(maxsize=512)
    def evaluate(*keys: tuple[tuple[int, ...], bytes]) -> Matrix:
        result = function(*(np.frombuffer(data).reshape(shape) for shape, data in keys))
        result.flags.writeable = False
        return result

    @wraps(function)
    def wrapper(*matrices: Matrix) -> Matrix:
        return evaluate(*((m.shape, np.asarray(m, dtype=np.float64).tobytes()) for m in matrices))

    return wrapper


@_cache_by_content
def null_space(rows: Matrix) -> Matrix:
    """A basis (as columns) of the vectors that every row annihilates, with an identity block in it."""
    size = np.abs(rows).max(axis=1, initial=0.0)
    kept = rows[size > 0.0] / size[size > 0.0, None]
    if rows.shape[1] == 0 or kept.shape[0] == 0:
        return np.eye(rows.shape[1])
    basis = orthonormal_null_space(kept, RANK_TOLERANCE)
    if basis.shape[1] == 0:
        return basis
    pivots = distinct_columns(basis.T)
    return clean(np.asarray(np.linalg.solve(basis[pivots].T, basis.T).T, dtype=np.float64))


@_cache_by_content
def complete(basis: Matrix, candidates: Matrix) -> Matrix:
    """The first of the columns `candidates` that together with `basis` are independent and span all of them."""
    spanned = np.zeros((0, candidates.shape[0]))
    if basis.size:
        left, singular, _ = np.linalg.svd(basis, full_matrices=False)
        spanned = left[:, singular > max(basis.shape) * np.finfo(float).eps * singular[0]].T
    return candidates[:, independent_rows(candidates.T, spanned)]


@_cache_by_content
def dependencies(rows: Matrix) -> Matrix:
    """Sums of rows that vanish, as columns: each row that depends on those before it, less what these make of it."""
    first = independent_rows(rows)
    rest = [i for i in range(len(rows)) if i not in first]
    found = np.zeros((len(rows), len(rest)))
    found[rest] = np.eye(len(rest))
    if first and rest:
        found[first] = -clean(rows[rest] @ np.linalg.pinv(rows[first])).T
    return found


@_cache_by_content
def pseudo_inverse(matrix: Matrix) -> Matrix:
    """The Moore-Penrose inverse."""
    return np.asarray(np.linalg.pinv(matrix))


def clean(matrix: Matrix) -> Matrix:
    """Incidence arithmetic is exact but for rounding: zero is zero."""
    return np.where(np.abs(matrix) < 1e-13, 0.0, matrix)
