"""The H2 norm: the root-mean-square response to white noise, exact with delayed inputs too."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from inerter.errors import OK, Status, StatusKind
from inerter.norms.delay import pade, propagate
from inerter.norms.exact import h2_exactly
from inerter.norms.stability import balance, split
from inerter.systems.linear import LinearSystem, check_system

Matrix = NDArray[np.float64]
_LOST = Status(StatusKind.INACCURATE, "some motions are so much slower than others that rounding hides their damping")
_EPS = float(np.finfo(float).eps)
_SOLVED = 1e-3  # share of its terms that the equation for the variance of an excited state may leave over
ACCURATE = 1e-9  # relative error of a mean square up to which double precision is believed


@dataclass(frozen=True, eq=False)
class H2:
    """The norm of each output, and why it is infinite, or nan because it is not known, where it is."""

    outputs: Matrix  # (p,)
    status: Status

    @property
    def value(self) -> float:
        """Root of the sum of the squares over the outputs."""
        return float(np.sqrt(np.sum(self.outputs**2)))


def h2_norm(system: LinearSystem, pade_order: int | None = None) -> float:
    """Root-mean-square response to unit white noise on every source, over all outputs together.

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
    errors = system.errors
    if errors is None:
        return _of_matrices(system, pade_order)
    if not (np.any(system.D) or np.any(errors[3])):
        squares = _squares(system, errors, pade_order)
        if squares is not None:
            return H2(np.sqrt(squares), OK)
    return H2(*h2_exactly(system, pade_order))


def _of_matrices(system: LinearSystem, pade_order: int | None) -> H2:
    direct = np.any(_merged_direct(system) != 0.0, axis=1)
    parts = split(system)
    seen = parts.visible() if parts.poles.size else np.zeros(len(system.outputs), dtype=bool)
    part, drifts = parts.decaying, False
    if np.any(seen) and parts.poles.size == np.sum(_drifting(system.A)):
        drifts = np.allclose(_per_source(system, system.B[_drifting(system.A)]), 0.0, atol=1e-13)
    A, B, C = (system.A, system.B, system.C) if drifts else (part.A, part.B, part.C)
    seen = seen & (not drifts)
    given = LinearSystem(A, B, C, system.D, delays=system.delays, sources=system.sources)
    squares = _squares(given, tuple(np.zeros_like(M) for M in (A, B, C)), pade_order)
    if np.any(seen):
        status = parts.status
    elif np.any(direct):
        names = ", ".join(name for name, is_direct in zip(system.outputs, direct, strict=True) if is_direct)
        status = Status(StatusKind.DIRECT_TERM, f"white noise passes straight to {names}, so its variance is infinite")
    else:
        status = _LOST if squares is None else OK
    norms = np.full(len(system.outputs), np.nan) if squares is None else np.sqrt(squares)
    return H2(np.where(direct | seen, np.inf, norms), status)


def _merged_direct(system: LinearSystem) -> Matrix:
    """D with inputs of one source and one delay added up: they are one input."""
    arrivals = list(zip(system.sources, system.delays.tolist(), strict=True))
    unique = list(dict.fromkeys(arrivals))
    merge = np.array([[arrival == other for other in unique] for arrival in arrivals], dtype=float)
    return np.asarray(system.D @ merge.reshape(len(arrivals), len(unique)))


def _drifting(A: Matrix) -> NDArray[np.bool_]:
    """States that nothing but the inputs moves, such as a share of the road's shape that tyres keep."""
    return np.asarray(~np.any(A, axis=1))


def _per_source(system: LinearSystem, B: Matrix) -> Matrix:
    """What each input column becomes when all columns of its source arrive at once: a drift cancels if it is zero."""
    same = np.array([[a == b for b in system.sources] for a in system.sources], dtype=float)
    return np.asarray(B @ same)


def _drift_covariance(system: LinearSystem, B: Matrix) -> Matrix:
    """Covariance of sums of one random walk at different times whose weights add up to zero."""
    result = np.zeros((B.shape[0], B.shape[0]))
    for i, source in enumerate(system.sources):
        for j, other in enumerate(system.sources):
            if source == other:
                result -= 0.5 * abs(system.delays[i] - system.delays[j]) * np.outer(B[:, i], B[:, j])
    return result


def _squares(system: LinearSystem, errors: tuple[Matrix, ...], pade_order: int | None) -> Matrix | None:
    """The squared norm of each output; None where its relative error may exceed `ACCURATE`.

    The covariance P of the state solves A P + P A' + W = 0 (Bartels and Stewart), where W adds to B B' the covariance
    of each delayed arrival with the state that its earlier arrivals have left: exp(A dt) Bi Bj' and its transpose.
    With the solution Q of A' Q + Q A + C' C = 0 a change of A changes the square by 2 tr(Q dA P), and one of W by
    tr(Q dW): so count what is left of the first equation, and what rounding has done to A, W and C.
    """
    A, scale = balance(system.A)
    B, C = system.B / scale[:, None], system.C * scale
    EA, EB, EC = errors[0] / scale[:, None] * scale, errors[1] / scale[:, None], errors[2] * scale
    drift = _drifting(EA + np.abs(A))
    if np.any(drift):
        walks = system.B[drift]
        if np.any(np.abs(_per_source(system, walks)) > 4.0 * _EPS * _per_source(system, np.abs(walks))):
            return None
    W, EW = _excitation(system, (A, EA), (B, EB), pade_order)
    try:
        P, Q, rest, weights = _solved(system, A, B, C, W, drift)
    except np.linalg.LinAlgError:
        return None
    squares = np.einsum("ij,jk,ik->i", C, P, C)
    size = np.abs(P)
    seen = np.abs(C) @ size
    relative = float(np.sum(np.abs(Q) * (np.abs(rest) + 2.0 * EA @ size + EW)))
    relative += float(np.sum(weights[:, None] * (2.0 * seen * EC + len(A) * _EPS * seen * np.abs(C))))
    return squares if relative <= ACCURATE else None


def _solved(
    system: LinearSystem, A: Matrix, B: Matrix, C: Matrix, W: Matrix, drift: NDArray[np.bool_]
) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """P, Q for outputs with weights that make each square one, what is left of the equation for P, and the weights.

    Of states that only drift the covariance is known, and the others follow them.
    """
    decays, n = np.flatnonzero(~drift), len(A)
    d, w = np.ix_(decays, decays), np.flatnonzero(drift)
    dw = np.ix_(decays, w)
    follow = A[dw]
    P, Q = np.zeros((n, n)), np.zeros((n, n))
    walks = _drift_covariance(system, B[w])
    P[np.ix_(w, w)] = walks
    solve = _Lyapunov(A[d])
    P[dw] = solve.once(-(follow @ walks + W[dw]))
    P[np.ix_(w, decays)] = P[dw].T
    cross = follow @ P[dw].T
    P[d] = solve.refined(W[d] + cross + cross.T)
    half = A.astype(np.longdouble) @ P.astype(np.longdouble)
    rest = np.asarray(half + half.T + W.astype(np.longdouble), dtype=float)
    noise = np.diag(W)
    terms = 2.0 * np.sum(np.abs(A) * np.abs(P), axis=1) + noise
    rest[np.ix_(w, w)] = 8.0 * _EPS * walks
    squares, size = np.einsum("ij,jk,ik->i", C, P, C), np.einsum("ij,jk,ik->i", np.abs(C), np.abs(P), np.abs(C))
    with np.errstate(divide="ignore"):
        weights = np.where(size > 0.0, 1.0 / squares, 0.0)
    if not np.all(weights >= 0.0) or np.any((noise > 0.0) & (np.abs(np.diag(rest)) > _SOLVED * terms)):
        raise np.linalg.LinAlgError("the covariance does not solve its equation")
    goal = (C.T * weights) @ C
    Q[d] = solve.adjoint(goal[d])
    Q[dw] = solve.once(-(goal[dw] + Q[d] @ follow), adjoint=True)
    Q[np.ix_(w, decays)] = Q[dw].T
    cross = Q[dw].T @ follow
    Q[np.ix_(w, w)] = goal[np.ix_(w, w)] + cross + cross.T
    return P, Q, rest, weights


class _Lyapunov:
    """Equations with one matrix A, by one Schur form (Bartels and Stewart, 1972)."""

    def __init__(self, A: Matrix) -> None:
        self.A = A
        self.T, self.Z = scipy.linalg.schur(A, output="real") if len(A) else (A, A)

    def once(self, right: Matrix, adjoint: bool = False) -> Matrix:
        """X with A X = right, or A' X = right."""
        if not right.size:
            return right
        return np.asarray(np.linalg.solve(self.A.T if adjoint else self.A, right))

    def _solve(self, W: Matrix, adjoint: bool) -> Matrix:
        kinds = ("T", "N") if adjoint else ("N", "T")
        right = -(self.Z.T @ W @ self.Z)
        Y, scale, _ = scipy.linalg.lapack.dtrsyl(self.T, self.T, right, trana=kinds[0], tranb=kinds[1])
        P = self.Z @ (Y / scale) @ self.Z.T
        return np.asarray(0.5 * (P + P.T), dtype=float)

    def adjoint(self, W: Matrix) -> Matrix:
        """Q with A' Q + Q A + W = 0."""
        return self._solve(W, adjoint=True) if W.size else W

    def refined(self, W: Matrix) -> Matrix:
        """P with A P + P A' + W = 0, corrected for its residuals in extended precision while that helps."""
        if not W.size:
            return W
        P = self._solve(W, adjoint=False)
        long_A, long_W = self.A.astype(np.longdouble), W.astype(np.longdouble)
        before = np.inf
        for _ in range(20):
            half = long_A @ P.astype(np.longdouble)
            step = self._solve(np.asarray(half + half.T + long_W, dtype=float), adjoint=False)
            change = float(np.linalg.norm(step))
            if not change < 0.5 * before:
                break
            P, before = P + step, change
        return P


def _excitation(
    system: LinearSystem, dynamics: tuple[Matrix, Matrix], entries: tuple[Matrix, Matrix], pade_order: int | None
) -> tuple[Matrix, Matrix]:
    """W of `_squares`, the noise that enters and what of it the state has met before, and its error."""
    (A, EA), (B, EB) = dynamics, entries
    size = np.abs(B)
    W, EW = B @ B.T, _both(EB @ size.T) + 2.0 * _EPS * size @ size.T
    for source in dict.fromkeys(system.sources):
        arrivals = [j for j in np.argsort(system.delays, kind="stable") if system.sources[j] == source]
        met = unsure = np.zeros((B.shape[0], 0))
        for before, now in pairwise(arrivals):
            met, unsure = np.hstack([met, B[:, [before]]]), np.hstack([unsure, EB[:, [before]]])
            time = float(system.delays[now] - system.delays[before])
            met, unsure = propagate(A, EA, met, unsure, time, pade_order)
            W = W + _both(np.outer(met.sum(axis=1), B[:, now]))
            EW = EW + _both(np.outer(unsure.sum(axis=1), size[:, now]) + np.outer(np.abs(met).sum(axis=1), EB[:, now]))
    return W, EW


def _both(matrix: Matrix) -> Matrix:
    return np.asarray(matrix + matrix.T)
