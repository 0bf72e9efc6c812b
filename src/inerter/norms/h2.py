"""The H2 norm: the root-mean-square response to white noise, exact with delayed inputs too."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import OK, Status, StatusKind
from inerter.norms.delay import pade, propagate
from inerter.norms.exact import EXACT, h2_exactly
from inerter.norms.stability import balance, split
from inerter.systems.linear import ExtendedMatrices, LinearSystem, check_system

Matrix = NDArray[np.float64]
_LOST = Status(StatusKind.INACCURATE, "damping lost to rounding: some motions are much slower than others")
_EPS = float(np.finfo(float).eps)
_RESIDUAL = 1e-3  # largest residual of the equation for the variance of an excited state, over its terms
_DAMPED = 1e-4  # relative correction of a variance from which on its motion may be damped by rounding
_STEADY = 1e-12  # relative correction of every variance after which none is sought: what is left is one of first order
_FEW_STATES = 6  # up to which elimination takes less time than the Schur form
_REGULAR = 1e-10  # reciprocal condition of the equations from which on no two poles add up to zero by rounding
_LONG = float(np.finfo(np.longdouble).eps)
_AT_ZERO = 16.0 * _EPS  # size of a pole relative to A that may be rounding
_SMALL = 1e-6  # relative size of the terms of a correction at first order up to which higher orders are below 1e-9
_SECOND_ORDER = 1e-3  # share of the terms of a correction by which it may be off
ACCURATE = 1e-9  # relative error of a mean square up to which it counts as known


@dataclass(frozen=True, eq=False)
class H2:
    """H2 norm of each output, infinite or nan (unknown) with the reason as status.

    `error` is the largest relative error of any of them by rounding.
    """

    outputs: Matrix  # (p,)
    status: Status
    error: float = np.nan

    @property
    def value(self) -> float:
        """Root of the sum of the squares over the outputs."""
        return float(np.sqrt(np.sum(self.outputs**2)))


def h2_norm(system: LinearSystem, pade_order: int | None = None) -> float:
    """Root-mean-square response to unit white noise on every source, over all outputs together.

    Unit noise has the two-sided density 1 per Hz: the squared norm is the integral of |G(j omega)|^2 over omega from
    -infinity to infinity, over 2 pi.

    Inputs that share a source with different delays are treated exactly, or with a Pade approximant of `pade_order`
    for each delay between one arrival and the next. Infinite if a motion that does not decay is excited and seen, or
    if white noise passes straight to an output; `h2` says which.

    >>> h2_norm(LinearSystem([[-1.0]], [[1.0]], [[1.0]], [[0.0]]))
    0.7071067811865476
    """
    return h2(system, pade_order).value


def h2(system: LinearSystem, pade_order: int | None = None) -> H2:
    """The H2 norm of each output of `system`, and a `Status`. See `h2_norm`.

    A system that comes from a mechanism is right to 1e-9: where the error bound of double precision exceeds that, its
    transfer functions are evaluated without rounding. Matrices that are given are taken for exact, but a pole that
    their rounding could put on the imaginary axis counts as lying there; where double precision fails them, the norm
    is nan.
    """
    check_system(system)
    if pade_order is not None:
        pade(pade_order)  # refuses an order that there is not, even where nothing is late
    fine = system.fine
    if fine is None:
        return _of_matrices(system, pade_order)
    if not np.count_nonzero(system.D) and not np.count_nonzero(fine.errors[system.order :, system.order :]):
        found = _squares(system, fine, pade_order)
        if found is not None:
            return H2(np.sqrt(found[0]), OK, 0.5 * found[1])
    return H2(*h2_exactly(system, pade_order), EXACT)


def _of_matrices(system: LinearSystem, pade_order: int | None) -> H2:
    direct = np.any(_merged_direct(system) != 0.0, axis=1)
    parts = split(system)
    seen = parts.visible() if parts.poles.size else np.zeros(len(system.outputs), dtype=bool)
    part, drifts = parts.decaying, False
    if np.any(seen) and parts.poles.size == np.sum(_drifting(system.A)):
        same = np.array([[a == b for b in system.sources] for a in system.sources], dtype=float)
        drifts = np.allclose(system.B[_drifting(system.A)] @ same, 0.0, atol=1e-13)  # where those of a source cancel
    A, B, C = (system.A, system.B, system.C) if drifts else (part.A, part.B, part.C)
    seen = seen & (not drifts)
    given = LinearSystem(A, B, C, system.D, delays=system.delays, sources=system.sources)
    values = np.block([[A, B], [C, system.D]]).astype(np.longdouble)
    found = _squares(given, ExtendedMatrices(values, np.zeros(values.shape), len(A)), pade_order)
    if np.any(seen):
        status = parts.status
    elif np.any(direct):
        names = ", ".join(name for name, is_direct in zip(system.outputs, direct, strict=True) if is_direct)
        status = Status(StatusKind.DIRECT_TERM, f"infinite variance: direct feedthrough from white noise to {names}")
    else:
        status = _LOST if found is None else OK
    norms, error = (np.full(len(system.outputs), np.nan), np.nan) if found is None else (np.sqrt(found[0]), found[1])
    return H2(np.where(direct | seen, np.inf, norms), status, 0.5 * error)


def _merged_direct(system: LinearSystem) -> Matrix:
    """Direct term D with the columns of inputs of the same source and delay added."""
    arrivals = list(zip(system.sources, system.delays.tolist(), strict=True))
    unique = list(dict.fromkeys(arrivals))
    merge = np.array([[arrival == other for other in unique] for arrival in arrivals], dtype=float)
    return np.asarray(system.D @ merge.reshape(len(arrivals), len(unique)))


def _drifting(A: Matrix) -> NDArray[np.bool_]:
    """States driven by the inputs alone, such as a tyre's share of the road profile."""
    return np.asarray(~np.logical_or.reduce(A, axis=1))


def drift_covariance(B: Matrix, delays: Matrix, sources: Sequence[str]) -> Matrix | None:
    """Covariance of states that only the inputs move, B w: sums of random walks at different times.

    None unless the weights of each source add up to zero, so that the sums stay where they are.
    """
    result = np.zeros((B.shape[0], B.shape[0]), B.dtype)
    for source in dict.fromkeys(sources if result.size else ()):
        arrivals = [j for j in np.argsort(delays, kind="stable") if sources[j] == source]
        so_far = np.cumsum(B[:, arrivals], axis=1)
        if np.any(np.abs(so_far[:, -1]) > 4.0 * _EPS * np.sum(np.abs(B[:, arrivals]), axis=1)):
            return None
        result += (so_far[:, :-1] * np.diff(delays[arrivals])) @ so_far[:, :-1].T
    return result


def _squares(system: LinearSystem, fine: ExtendedMatrices, pade_order: int | None) -> tuple[Matrix, float] | None:
    """The squared norm of each output and the relative error of any; None where that may be more than `ACCURATE`.

    The covariance P of the state solves A P + P A' + W = 0 (Bartels and Stewart), where W adds to B B' the covariance
    of each delayed arrival with the state that its earlier arrivals have left: exp(A dt) Bi Bj' and its transpose.
    With the solution Q of A' Q + Q A + C' C = 0 for one output, the residual R of the first equation changes the square
    by tr(Q R). With the matrices before rounding that corrects all rounding errors at first order; the result
    counts as known while the correction is small. Rounding errors of those matrices themselves count as an error, and
    so does a small part of the correction, for its second order.
    """
    A, scale = balance(system.A)
    n = len(A)
    rows, columns = fine.values.shape
    into, out = np.ones(rows), np.ones(columns)
    into[:n] = out[:n] = scale
    units: Any = out / into[:, None]  # powers of two
    values, errors = fine.values * units, fine.errors * units
    fine_A, fine_B, fine_C = values[:n, :n], values[:n, n:], values[n:, :n]
    EA, EB, EC = errors[:n, :n], errors[:n, n:], errors[n:, :n]
    size_A = np.abs(A)
    drifting = _drifting(EA + size_A)
    drift = None
    if np.count_nonzero(drifting):
        covariance = drift_covariance(fine_B[drifting], system.delays, system.sources)
        if covariance is None:
            return None
        drift = _Drift(drifting, covariance.astype(float))
    W, EW = _excitation(system, A, (fine_A, fine_B), (EA, EB), pade_order)
    try:
        solver, P, residual, solved = _covariance(A, (fine_A, W), drift)
        size, C = np.abs(P), fine_C.astype(float)
        weights = np.abs(C)
        seen = weights.dot(size)
        squares = fine_C.dot(P).dot(fine_C.T).diagonal()
        goals = squares.astype(float)
        goals[seen.dot(weights.T).diagonal() == 0.0] = np.inf
        if not all(goal > 0.0 for goal in goals.tolist()):
            return None
        Q = [_adjoint(solver, A, row, drift) / goal for row, goal in zip(C, goals, strict=True)]
    except np.linalg.LinAlgError:
        return None
    change = np.array([np.vdot(one, residual) for one in Q])
    together = sum(map(np.abs, Q))
    unsure = 2.0 * np.vdot(together, EW + (EA + n * _LONG * size_A).dot(size))
    unsure += np.vdot(seen / goals[:, None], 2.0 * EC + n * _LONG * weights)
    terms = float(np.vdot(together, np.abs(residual)))
    if not (unsure <= ACCURATE and terms <= _SMALL and solved):
        return None
    error = float(unsure) + _SECOND_ORDER * terms + n * _EPS
    return np.asarray(squares * (1.0 + change), dtype=float), error


@dataclass(frozen=True, eq=False)
class _Drift:
    """States that only the inputs move, and their covariance."""

    states: NDArray[np.bool_]
    covariance: Matrix

    @property
    def blocks(self) -> tuple[Any, Any, Any, Any]:
        """Indices of the blocks of a matrix: others with others, others with these, the converse, these with these."""
        d, w = np.flatnonzero(~self.states), np.flatnonzero(self.states)
        return np.ix_(d, d), np.ix_(d, w), np.ix_(w, d), np.ix_(w, w)


def _covariance(A: Matrix, fine: tuple[Matrix, Matrix], drift: _Drift | None) -> tuple[_Solver, Matrix, Matrix, bool]:
    """Solver, P, the residual of its equation, and whether that is small against the noise that enters each state.

    Of states that only drift the covariance is known, and the others follow them.
    """
    fine_A, W = fine
    noise = W.astype(float)
    if drift is None:
        solver, P, residual = _solve(A, fine_A, W)
    else:
        P, covariance = np.zeros_like(A), drift.covariance
        d, dw, wd, w = drift.blocks
        solver, follow = _Schur(A[d]), A[dw]
        P[w] = covariance
        P[dw] = np.linalg.solve(A[d], -(follow @ covariance + noise[dw]))
        P[wd] = P[dw].T
        P[d], _ = _refine(solver, fine_A[d], W[d] + _add_transpose(follow @ P[dw].T))
        residual = _residual(fine_A, P, W)
        residual[w] = 8.0 * _EPS * covariance
    enters = noise.diagonal()
    terms = 2.0 * np.abs(A).dot(np.abs(P)).diagonal() + enters
    unbalanced = (enters > 0.0) & (np.abs(residual.diagonal()) > _RESIDUAL * terms)
    return solver, P, residual, not np.count_nonzero(unbalanced)


def _adjoint(solver: _Solver, A: Matrix, row: Matrix, drift: _Drift | None) -> Matrix:
    """Q of `_squares` for one output."""
    goal = row[:, None] * row
    if drift is None:
        return solver.solve(goal, adjoint=True)
    Q = np.zeros_like(A)
    d, dw, wd, w = drift.blocks
    Q[d] = solver.solve(goal[d], adjoint=True)
    Q[dw] = np.linalg.solve(A[d].T, -(goal[dw] + Q[d] @ A[dw]))
    Q[wd] = Q[dw].T
    Q[w] = goal[w] + _add_transpose(Q[dw].T @ A[dw])
    return Q


def _schur(A: Matrix) -> tuple[Matrix, Matrix]:
    """Real Schur form; `scipy.linalg.schur` takes longer to call LAPACK than that for its answer."""
    if not np.isfinite(A).all():
        raise np.linalg.LinAlgError("a matrix has entries that are not finite")
    T, _, _, _, Z, _, info = scipy.linalg.lapack.dgees(_select_none, A)
    if info:
        raise np.linalg.LinAlgError("the Schur form was not found")
    return T, Z


def _select_none(real: float, imaginary: float) -> None:
    """LAPACK calls it for no pole where it is not to sort them."""


class _Solver(Protocol):
    """Equations A P + P A' + W = 0 with one matrix A."""

    def solve(self, W: Matrix, adjoint: bool = False) -> Matrix:
        """P, symmetric as W is, or that of the equation with A' in place of A."""


def _solve(A: Matrix, fine_A: Matrix, W: Matrix) -> tuple[_Solver, Matrix, Matrix]:
    """Solver, P and the residual of its equation: by elimination where that takes less time and is as safe.

    A is stable if a positive definite P solves the equation with a covariance W (Lyapunov); the Schur form has its
    poles, which say so in every case.
    """
    if 0 < len(A) <= _FEW_STATES:
        with suppress(np.linalg.LinAlgError):
            elimination = _Elimination(A)
            P, residual = _refine(elimination, fine_A, W)
            if not scipy.linalg.lapack.dpotrf(P)[1]:
                return elimination, P, residual
    schur = _Schur(A)
    return schur, *_refine(schur, fine_A, W)


class _Elimination:
    """Elimination among the n (n + 1) / 2 different entries of P: p with M p + w = 0 for those w of W.

    The adjoint equation has M' in its place where each entry off the diagonal counts twice.

    Raises `LinAlgError` near a pole that does not decay.
    """

    def __init__(self, A: Matrix) -> None:
        self.places = _places(len(A))
        M = A.ravel().dot(self.places.entries).reshape(self.places.twice.size, -1)
        lapack: Any = scipy.linalg.lapack
        self.factors, self.pivots, _ = lapack.dgetrf(M)
        reciprocal_condition, _ = lapack.dgecon(self.factors, lapack.dlange("1", M))
        if not reciprocal_condition > _REGULAR:
            raise np.linalg.LinAlgError("two poles may add up to zero")

    def solve(self, W: Matrix, adjoint: bool = False) -> Matrix:
        upper, twice, both = self.places.upper, self.places.twice, self.places.both
        w = W.ravel()[upper]
        right = w * twice if adjoint else w
        p, _ = scipy.linalg.lapack.dgetrs(self.factors, self.pivots, right, trans=int(adjoint))
        return np.asarray((p / -twice if adjoint else -p)[both], dtype=float)


@dataclass(frozen=True, eq=False)
class _Places:
    """Positions of the entries of a symmetric (n, n) matrix among those on and above the diagonal."""

    upper: NDArray[np.intp]  # (m,) of the whole matrix, flat
    both: NDArray[np.intp]  # (n, n) of the different ones
    twice: Matrix  # (m,) how often each stands in the matrix
    entries: Matrix  # (n * n, m * m) M over A, both flat


@cache
def _places(n: int) -> _Places:
    rows, columns = np.triu_indices(n)
    both = np.zeros((n, n), dtype=np.intp)
    both[rows, columns] = both[columns, rows] = np.arange(rows.size)
    entries = np.zeros((n, n, rows.size, rows.size))
    for row, (i, j) in enumerate(zip(rows, columns, strict=True)):
        for k in range(n):
            entries[i, k, row, both[k, j]] += 1.0
            entries[j, k, row, both[i, k]] += 1.0
    return _Places(rows * n + columns, both, np.where(rows == columns, 1.0, 2.0), entries.reshape(n * n, -1))


class _Schur:
    """One Schur form of A (Bartels and Stewart, 1972).

    Raises `LinAlgError` for a pole that may lie at zero: the equation then has many solutions, and which one comes out
    is decided by rounding, though the motion may not be excited at all.
    """

    def __init__(self, A: Matrix) -> None:
        self.T, self.Z = _schur(A) if len(A) else (A, A)
        if len(A) and self.T.diagonal().max() >= -_AT_ZERO * np.abs(self.T).max():
            raise np.linalg.LinAlgError("a pole may lie at zero")

    def solve(self, W: Matrix, adjoint: bool = False) -> Matrix:
        if not W.size:
            return W
        kinds = ("T", "N") if adjoint else ("N", "T")
        right = -self.Z.T.dot(W).dot(self.Z)
        Y, scale, _ = scipy.linalg.lapack.dtrsyl(self.T, self.T, right, trana=kinds[0], tranb=kinds[1])
        P = self.Z.dot(Y / scale).dot(self.Z.T)
        return np.asarray(0.5 * (P + P.T), dtype=float)


def _refine(solver: _Solver, A: Matrix, W: Matrix) -> tuple[Matrix, Matrix]:
    """P for an A and a W in extended precision, corrected while that changes a variance, and what remains of W.

    Raises `LinAlgError` where the first correction of a variance is not small: its motion is damped by rounding.
    """
    P, before = solver.solve(W.astype(float)), np.inf
    residual = _residual(A, P, W)
    for turn in range(20):
        step = solver.solve(residual)
        change = math.sqrt(np.vdot(step, step))
        steps, variances = np.abs(step.diagonal()), P.diagonal()
        if turn == 0 and np.count_nonzero(steps > _DAMPED * variances):
            raise np.linalg.LinAlgError("damping lost to rounding")
        if not change < 0.5 * before:
            break
        P, before = P + step, change
        residual = _residual(A, P, W)
        if not np.count_nonzero(steps > _STEADY * variances):
            break
    return P, residual


def _residual(A: Matrix, P: Matrix, W: Matrix) -> Matrix:
    """A P + P A' + W, for a symmetric P."""
    return np.asarray(_add_transpose(A.dot(P)) + W, dtype=float)


def _excitation(
    system: LinearSystem, A: Matrix, fine: tuple[Matrix, Matrix], errors: tuple[Matrix, Matrix], pade_order: int | None
) -> tuple[Matrix, Matrix]:
    """W of `_squares`: the input covariance with that of delayed inputs, and half its error, before its transpose."""
    (fine_A, B), (EA, EB) = fine, errors
    size = np.abs(B).astype(float)
    W, EW = B.dot(B.T), (EB + _LONG * size).dot(size.T)
    if len(set(system.sources)) == len(system.sources):
        return W, EW
    moved = EA + np.abs(fine_A - A).astype(float)
    for source in dict.fromkeys(system.sources):
        arrivals = [j for j in np.argsort(system.delays, kind="stable") if system.sources[j] == source]
        delayed = unsure = np.zeros((B.shape[0], 0))
        for before, now in pairwise(arrivals):
            delayed, unsure = np.hstack([delayed, B[:, [before]]]), np.hstack([unsure, EB[:, [before]]])
            time = float(system.delays[now] - system.delays[before])
            unsure = unsure + _EPS * np.abs(delayed)
            delayed, unsure = propagate(A, moved, delayed.astype(float), unsure, time, pade_order)
            W = W + _add_transpose(np.outer(delayed.sum(axis=1), B[:, now]))
            EW = EW + np.outer(unsure.sum(axis=1), size[:, now]) + np.outer(np.abs(delayed).sum(axis=1), EB[:, now])
    return W, EW


def _add_transpose(matrix: Matrix) -> Matrix:
    return np.asarray(matrix + matrix.T)
