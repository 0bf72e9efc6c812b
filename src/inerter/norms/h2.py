"""The H2 norm: the root-mean-square response to white noise, exact with delayed inputs too."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from inerter.errors import OK, Status, StatusKind
from inerter.norms.delay import pade, propagate
from inerter.norms.stability import Split, split
from inerter.systems.linear import LinearSystem, check_system

Matrix = NDArray[np.float64]
_LOST = "some motions are so much slower than others that rounding hides their damping"


@dataclass(frozen=True, eq=False)
class H2:
    """The norm of each output, and why it is infinite where it is."""

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

    The covariance P of the state solves A P + P A' + W = 0 (Bartels and Stewart), where W adds to B B' the covariance
    of each delayed arrival with the state that its earlier arrivals have left: exp(A dt) Bi Bj' and its transpose.
    """
    check_system(system)
    if pade_order is not None:
        pade(pade_order)  # refuses an order that there is not, even where nothing is late
    direct = np.any(_merged_direct(system) != 0.0, axis=1)
    parts = split(system)
    square, lasting, status = _squares(system, parts, pade_order)
    outputs = np.where(direct | lasting, np.inf, np.sqrt(np.maximum(square, 0.0)))
    if np.any(direct) and not np.any(lasting):
        names = ", ".join(name for name, is_direct in zip(system.outputs, direct, strict=True) if is_direct)
        status = Status(StatusKind.DIRECT_TERM, f"white noise passes straight to {names}, so its variance is infinite")
    if np.any(np.isnan(outputs)):
        status = Status(StatusKind.FAILED, "the covariance of the state could not be computed")
    return H2(outputs, status)


def _merged_direct(system: LinearSystem) -> Matrix:
    """D with inputs of one source and one delay added up: they are one input."""
    arrivals = list(zip(system.sources, system.delays.tolist(), strict=True))
    unique = list(dict.fromkeys(arrivals))
    merge = np.array([[arrival == other for other in unique] for arrival in arrivals], dtype=float)
    return np.asarray(system.D @ merge.reshape(len(arrivals), len(unique)))


def _squares(system: LinearSystem, parts: Split, pade_order: int | None) -> tuple[Matrix, NDArray[np.bool_], Status]:
    """Squared norms of the decaying part (and of drifts that cancel), which outputs see a lasting motion, and why."""
    decaying, lasting = parts.decaying, parts.lasting
    none = np.zeros(len(system.outputs), dtype=bool)
    seen = parts.visible() if parts.poles.size else none
    drifts = bool(np.any(seen)) and _is_drift(parts)
    if drifts:
        seen = parts.visible(_per_source(system, lasting.B))
    n = decaying.A.shape[0]
    A = scipy.linalg.block_diag(decaying.A, np.zeros_like(lasting.A)) if drifts else decaying.A
    B = np.vstack([decaying.B, lasting.B]) if drifts else decaying.B
    W = _excitation(system, A, B, pade_order)
    P, converged = solve_lyapunov(decaying.A, W[:n, :n])
    square = np.einsum("ij,jk,ik->i", decaying.C, P, decaying.C)
    if drifts:
        cross = -np.linalg.solve(decaying.A, W[:n, n:]) if n else W[:n, n:]
        square = square + 2.0 * np.einsum("ij,jk,ik->i", decaying.C, cross, lasting.C)
        square = square + np.einsum("ij,jk,ik->i", lasting.C, _drift_covariance(system, lasting.B), lasting.C)
    if np.any(seen):
        return square, seen, parts.status
    return square, seen, OK if converged else Status(StatusKind.INACCURATE, _LOST)


def _is_drift(parts: Split) -> bool:
    """Whether the lasting motions are plain integrals of the inputs, such as a tyre's share of the road profile."""
    rate = float(np.linalg.norm(parts.decaying.A)) if parts.decaying.A.size else 1.0
    return bool(np.all(np.abs(parts.lasting.A) <= 1e-11 * rate))


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


def _excitation(system: LinearSystem, A: Matrix, B: Matrix, pade_order: int | None) -> Matrix:
    """W of `h2`: the noise that enters, and what of it the state has met before."""
    W = B @ B.T
    for source in dict.fromkeys(system.sources):
        arrivals = [j for j in np.argsort(system.delays, kind="stable") if system.sources[j] == source]
        met = np.zeros((B.shape[0], 0))
        for before, now in pairwise(arrivals):
            met = np.hstack([met, B[:, [before]]])
            met = propagate(A, met, float(system.delays[now] - system.delays[before]), pade_order)
            cross = np.outer(met.sum(axis=1), B[:, now])
            W = W + cross + cross.T
    return W


def solve_lyapunov(A: Matrix, W: Matrix) -> tuple[Matrix, bool]:
    """The symmetric P with A P + P A' + W = 0, refined with residuals in extended precision; whether that converged.

    Bartels and Stewart (1972), with one Schur form for all steps of refinement.
    """
    if A.shape[0] == 0:
        return np.zeros((0, 0)), True
    T, Z = scipy.linalg.schur(A, output="real")

    def solve(right: Matrix) -> Matrix:
        Y, scale, _ = scipy.linalg.lapack.dtrsyl(T, T, -(Z.T @ right @ Z), tranb="T")
        P = Z @ (Y / scale) @ Z.T
        return np.asarray(0.5 * (P + P.T), dtype=float)

    P = solve(W)
    long_A, long_W = A.astype(np.longdouble), W.astype(np.longdouble)
    before = np.inf
    for _ in range(20):
        half = long_A @ P.astype(np.longdouble)
        step = solve(np.asarray(half + half.T + long_W, dtype=float))
        change = float(np.linalg.norm(step))
        if not change < 0.5 * before:
            break
        P, before = P + step, change
    return P, bool(before <= 1e-9 * float(np.linalg.norm(P)))
