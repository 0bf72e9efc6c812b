"""Decaying and lasting parts of a system, and visibility of the lasting part in the outputs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import OK, Status, StatusKind
from inerter.formatting import format_complex
from inerter.systems.linear import LinearSystem

Matrix = NDArray[np.float64]
_VISIBLE = 1e-10  # relative size below which rounding, not mechanics, connects input, mode and output


@dataclass(frozen=True, eq=False)
class Subsystem:
    """Matrices of a part of a system, in separate coordinates."""

    A: Matrix
    B: Matrix
    C: Matrix


@dataclass(frozen=True, eq=False)
class Split:
    """A system as the sum of a part that decays and a part that does not; `poles` are those of the latter."""

    decaying: Subsystem
    lasting: Subsystem
    poles: NDArray[np.complex128]
    rate: float = 0.0  # size of the whole system's rates [1/s]

    def visible(self) -> NDArray[np.bool_]:
        """True for outputs to which the lasting part connects the inputs (outputs,).

        Its Markov parameters C A^k B tell, relative to what sizes of rows and columns could make of them.
        """
        part = self.lasting
        rows_seen = np.zeros(part.C.shape[0], dtype=bool)
        row_size = np.hypot(_norms(part.C, 1), _norms(self.decaying.C, 1))
        column_size = np.hypot(_norms(part.B, 0), _norms(self.decaying.B, 0))
        bound = np.outer(row_size, column_size)
        rate = max(float(np.linalg.norm(part.A)), np.finfo(float).tiny)
        product = part.B
        for _ in range(part.A.shape[0]):
            rows_seen |= np.any(np.abs(part.C @ product) > _VISIBLE * bound, axis=1)
            product = part.A @ product / rate
        return rows_seen

    @property
    def status(self) -> Status:
        """Status of the lasting poles: unstable or marginal."""
        worst = self.poles[int(np.argmax(self.poles.real))]
        if worst.real > max(1e-13 * self.rate + 1e-9 * abs(worst.imag), 0.0):
            return Status(StatusKind.UNSTABLE, f"unstable system: a pole at {format_complex(worst)} rad/s")
        return Status(StatusKind.MARGINAL, f"undamped mode: a pole at {format_complex(worst)} rad/s")


def split(system: LinearSystem) -> Split:
    """Split `system` into its decaying and its lasting part.

    A pole counts as lasting when its real part is not negative beyond the rounding error of that very pole, found
    from its left and right eigenvectors; a lightly damped mode beside much faster ones is thus told from an undamped
    one.
    """
    n = system.order
    A, scale = balance(system.A)
    B, C = system.B / scale[:, None], system.C * scale
    rates, errors = pole_rates(A)
    margins = rates + errors
    if np.all(margins < 0.0):
        empty = Subsystem(np.zeros((0, 0)), np.zeros((0, B.shape[1])), np.zeros((C.shape[0], 0)))
        return Split(Subsystem(A, B, C), empty, np.zeros(0, dtype=complex))
    decays = np.sort(rates[margins < 0.0])
    edge = 0.5 * (decays[-1] + np.min(rates[margins >= 0.0])) if decays.size else -np.inf
    T, Z, count = scipy.linalg.schur(A, output="real", sort=lambda re, im: re < edge)
    Bz, Cz = Z.T @ B, C @ Z
    X = (
        scipy.linalg.solve_sylvester(T[:count, :count], -T[count:, count:], -T[:count, count:])
        if 0 < count < n
        else (np.zeros((count, n - count)))
    )
    decaying = Subsystem(T[:count, :count], Bz[:count] - X @ Bz[count:], Cz[:, :count])
    lasting = Subsystem(T[count:, count:], Bz[count:], Cz[:, count:] + Cz[:, :count] @ X)
    return Split(decaying, lasting, np.asarray(np.linalg.eigvals(lasting.A), dtype=complex), float(np.linalg.norm(A)))


def stability(system: LinearSystem) -> Status:
    """`OK` if every pole decays, else what the worst pole is."""
    parts = split(system)
    return OK if parts.poles.size == 0 else parts.status


def balance(A: Matrix) -> tuple[Matrix, Matrix]:
    """A after a diagonal change of units by powers of two, and the units: A_new = A / scale[:, None] * scale.

    Apart from `kernels.dense.balance`, whose units are no powers of two: here a change of units must not round.
    """
    if A.shape[0] == 0:
        return A, np.ones(0)
    balanced, _, _, scale, _ = scipy.linalg.lapack.dgebal(A, scale=1, permute=0)
    return np.asarray(balanced, dtype=float), np.asarray(scale, dtype=float)


def pole_rates(A: Matrix) -> tuple[Matrix, Matrix]:
    """Real parts of the poles, and their rounding errors.

    The quotient of Rayleigh with left and right eigenvectors is taken for each pole: its own error is that of its
    terms, while the eigenvalues themselves carry the error of the largest entries of A.
    """
    if A.shape[0] == 0:
        return np.zeros(0), np.zeros(0)
    eigen: tuple[Any, Any, Any] = scipy.linalg.eig(A, left=True, right=True)  # type: ignore[assignment]
    poles, left, right = eigen
    eps = np.finfo(float).eps
    overlap = np.sum(left.conj() * right, axis=0)
    alone = np.abs(overlap) > np.sqrt(eps)
    apart = np.abs(poles[:, None] - poles)
    near = apart <= 1e-2 * np.abs(poles)[:, None]
    near |= ~alone[:, None] & ~alone & (apart <= np.sqrt(eps) * np.linalg.norm(A))  # a cluster at zero
    close = np.sum(near, axis=1).clip(1)
    poles[alone] = np.sum(left.conj() * (A @ right), axis=0)[alone] / overlap[alone]
    spread = np.einsum("ik,ij,jk->k", np.abs(left), np.abs(A), np.abs(right))
    size = np.maximum(np.abs(overlap), eps ** (1.0 - 1.0 / close))  # k equal poles move by eps^(1/k)
    return np.asarray(poles.real, dtype=float), np.asarray(4.0 * eps * spread / size, dtype=float)


def _norms(matrix: Matrix, axis: int) -> Matrix:
    return np.asarray(np.linalg.norm(matrix, axis=axis), dtype=float)
