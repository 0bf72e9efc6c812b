"""Dense kernels as plain Python against exact fractions, SciPy, and what defines them."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import scipy.linalg

from inerter.kernels import dense, lyapunov
from inerter.kernels.delay import propagate_adjoint, propagate_columns
from inerter.norms.delay import pade, propagate

EPS = np.finfo(float).eps
Matrix = np.ndarray


def random_systems(seed: int, count: int = 60) -> list[tuple[Matrix, Matrix]]:
    """Matrices of orders 1 to 12 and right-hand sides, both of sizes 1e-8 to 1e8."""
    rng = np.random.default_rng(seed)
    found = []
    for i in range(count):
        n = 1 + i % 12
        sizes = 10.0 ** rng.uniform(-8.0, 8.0, 2)
        found.append((sizes[0] * rng.standard_normal((n, n)), sizes[1] * rng.standard_normal((n, 3))))
    return found


def backward_error(A: Matrix, x: Matrix, b: Matrix) -> float:
    """Largest residual over the sum of the sizes of its terms, without rounding."""
    worst = Fraction(0)
    for row, right in zip(A.tolist(), b.tolist(), strict=True):
        terms = [Fraction(a) * Fraction(value) for a, value in zip(row, x.tolist(), strict=True)]
        size = sum((abs(term) for term in terms), abs(Fraction(right)))
        worst = max(worst, abs(sum(terms, -Fraction(right))) / size)
    return float(worst)


@pytest.mark.parametrize("complex_", [False, True])
def test_solutions_of_one_factorisation_agree(complex_: bool) -> None:
    for A, B in random_systems(1):
        A, B = (A + 1j * A.T, B + 0j) if complex_ else (A, B)
        LU, pivots = A.copy(), np.empty(len(A), np.int64)
        assert dense.factor(LU, pivots)
        together = B.copy()
        dense.solve_rows(LU, pivots, together)
        for column in range(B.shape[1]):
            x = B[:, column].copy()
            dense.solve(LU, pivots, x)
            np.testing.assert_array_equal(x, together[:, column])
        y = B[:, 0].copy()
        dense.solve_transposed(LU, pivots, y)
        known = np.linalg.solve(A.T, B[:, 0])
        np.testing.assert_allclose(y, known, rtol=0.0, atol=1e2 * EPS * np.linalg.cond(A) * np.abs(known).max())


def test_backward_errors_of_both_eliminations_are_a_few_roundings() -> None:
    for A, B in random_systems(2):
        n, b = len(A), B[:, 0]
        LU, pivots, x = A.copy(), np.empty(n, np.int64), b.copy()
        dense.factor(LU, pivots)
        dense.solve(LU, pivots, x)
        quotients, order, y = A.copy(), np.empty(n, np.int64), b.copy()
        dense.factor_by_quotients(quotients, order)
        dense.solve_by_quotients(quotients, order, y)
        np.testing.assert_array_equal(pivots, order)
        assert max(backward_error(A, x, b), backward_error(A, y, b)) < 100 * n * EPS


def test_a_singular_matrix_has_no_factors() -> None:
    for A in (np.zeros((3, 3)), np.ones((2, 2)), np.array([[np.nan]]), np.array([[np.inf]])):
        assert not dense.factor(A.copy(), np.empty(len(A), np.int64))
    for A in (np.zeros((3, 3)), np.ones((2, 2))):
        assert not dense.solve_scaled(A.copy(), np.ones((len(A), 1)))


def test_scaled_equations_do_not_depend_on_units() -> None:
    rng = np.random.default_rng(3)
    for n in range(1, 9):
        A, B = rng.standard_normal((n, n)), rng.standard_normal((n, 2))
        rows, columns = 2.0 ** rng.integers(-40, 40, (2, n))
        S, X = A * rows[:, None] * columns, B * rows[:, None]
        size, Y = A.copy(), B.copy()
        assert dense.solve_scaled(S, X)
        assert dense.solve_scaled(size, Y)
        np.testing.assert_allclose(X * columns[:, None], Y, rtol=1e-9)
        assert np.all(size >= np.abs(A) * (1.0 - n * EPS))  # |L| |U| bounds |L U|


def test_null_space_and_complement_span_all_vectors() -> None:
    rng = np.random.default_rng(4)
    for n in range(1, 9):
        for rank in range(n + 1):
            rows = rng.standard_normal((n + 2, rank)) @ rng.standard_normal((rank, n))
            null, complement = dense.null_space(rows)
            assert null.shape == (n, n - rank)
            assert np.linalg.matrix_rank(np.hstack([null, complement])) == n
            np.testing.assert_allclose(rows @ null, 0.0, atol=1e-9 * max(np.abs(rows).max(), 1.0))


def test_independent_rows_become_an_orthonormal_basis() -> None:
    rng = np.random.default_rng(5)
    rows = rng.standard_normal((3, 5))
    rows = np.vstack([rows[:2], rows[0] - 2.0 * rows[1], rows[2], np.zeros(5)])
    basis, count, residual = np.zeros((5, 5)), 0, np.zeros(5)
    found = []
    for row in rows:
        found.append(bool(dense.is_independent(row, basis, count, residual)))
        if found[-1]:
            basis[count], count = residual, count + 1
    assert found == [True, True, False, True, False]
    np.testing.assert_allclose(basis[:3] @ basis[:3].T, np.eye(3), atol=1e-14)


def test_exponential_and_its_derivative() -> None:
    for A, B in random_systems(6, 36):
        n = len(A)
        X = A / np.abs(A).sum(axis=1).max() * 10.0 ** ((n % 5) - 3)
        N = np.outer(B[:, 0], B[:, 1]) + A
        blocks = np.block([[X, np.zeros_like(X)], [np.zeros_like(X), X]])
        squarings = dense.count_squarings(blocks)
        assert squarings == dense.count_squarings(X)
        blocks[:n, n:] = N
        found = dense.exponential(blocks, squarings)
        value, derivative = scipy.linalg.expm_frechet(X, N)
        np.testing.assert_array_equal(found[:n, :n], dense.exponential(X, squarings))
        np.testing.assert_allclose(found[:n, :n], value, rtol=0.0, atol=1e-12 * np.abs(value).max())
        np.testing.assert_allclose(found[:n, n:], derivative, rtol=0.0, atol=1e-12 * np.abs(derivative).max())


def test_an_infinite_matrix_has_no_exponential_and_ends() -> None:
    assert dense.count_squarings(np.array([[np.inf]])) == 0


def test_units_balance_rows_and_columns() -> None:
    rng = np.random.default_rng(7)
    for n in range(2, 9):
        A = rng.standard_normal((n, n))
        spread = 10.0 ** rng.uniform(-6.0, 6.0, n)
        scale = dense.balancing_units(A / spread[:, None] * spread)
        balanced = A / (scale * spread)[:, None] * (scale * spread)
        off = np.abs(balanced - np.diag(np.diag(balanced)))
        assert np.max(off.sum(axis=0) / off.sum(axis=1)) < 10.0
        assert np.max(off.sum(axis=1) / off.sum(axis=0)) < 10.0


def test_eigenvectors_diagonalise() -> None:
    for A, _ in random_systems(8, 24):
        values, vectors, inverse, good = dense.eigenvectors(dense.in_units(A, np.ones(len(A))))
        assert good
        tolerance = 1e3 * EPS * np.linalg.cond(vectors) * np.abs(A).sum()
        np.testing.assert_allclose(vectors * values @ inverse, A, rtol=0.0, atol=tolerance)
        first = np.flatnonzero(values.imag > 0.0)  # of each pair: both have the same digits
        np.testing.assert_array_equal(values[first].conj(), values[first + 1])
        np.testing.assert_array_equal(vectors[:, first].conj(), vectors[:, first + 1])
        np.testing.assert_array_equal(inverse[first].conj(), inverse[first + 1])
    values, _, _, good = dense.eigenvectors(np.full((2, 2), np.inf))
    assert not good
    assert np.isnan(values).all()
    assert dense.eigenvectors(np.zeros((0, 0)))[3]


@pytest.mark.parametrize("adjoint", [False, True])
def test_lyapunov_equations(adjoint: bool) -> None:
    rng = np.random.default_rng(9)
    for n in range(1, 8):
        A = rng.standard_normal((n, n))
        A -= (np.linalg.eigvals(A).real.max() + 0.5) * np.eye(n)
        W, P, room = A @ A.T, np.empty((n, n)), lyapunov.lyapunov_space(n)
        assert lyapunov.lyapunov_factors(A, np.empty(0, np.int64), room)
        lyapunov.solve_symmetric(room, W, adjoint, P)
        M = A.T if adjoint else A
        np.testing.assert_allclose(M @ P + P @ M.T, -W, rtol=0.0, atol=1e-9 * np.abs(P).max() * np.abs(A).max())


@pytest.mark.parametrize("order", [None, 3])
def test_delayed_inputs_by_both_implementations(order: int | None) -> None:
    """The compiled one, here as plain Python, and the other: values within the sum of their error bounds."""
    rng = np.random.default_rng(10)
    poles = (np.empty(0, complex), np.empty(0, complex), 1.0)
    if order is not None:
        poles = (pade(order).poles, pade(order).residues, pade(order).direct)
    for n in range(1, 7):
        A = rng.standard_normal((n, n))
        A -= (np.linalg.eigvals(A).real.max() + 0.3) * np.eye(n)
        E_A, u, unsure = EPS * np.abs(A), rng.standard_normal(n), EPS * np.ones(n)
        out, error = np.empty(n), np.empty(n)
        propagate_columns(A, E_A, 0.7, u, unsure, poles, out, error)
        other, spread = propagate(A, E_A, u[:, None], unsure[:, None], 0.7, order)
        assert np.all(np.abs(out - other[:, 0]) <= error + spread[:, 0])
        assert np.all(error < 1e-11 * np.abs(out).max())
        bar, G_A, carried = rng.standard_normal(n), np.zeros((n, n)), np.empty(n)
        propagate_adjoint(A, 0.7, u, bar, *poles, G_A, carried)
        assert carried @ u == pytest.approx(bar @ out, rel=1e-11)
        direction, h = rng.standard_normal((n, n)), 1e-5
        ends = []
        for sign in (1.0, -1.0):
            end = np.empty(n)
            propagate_columns(A + sign * h * direction, E_A, 0.7, u, unsure, poles, end, error)
            ends.append(bar @ end)
        assert np.sum(G_A * direction) == pytest.approx((ends[0] - ends[1]) / (2.0 * h), rel=1e-6, abs=1e-8)
