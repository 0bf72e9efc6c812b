"""The H2 norm against closed forms, Kronecker products and quadrature, and what it says when it is infinite."""

import math

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st
from strategies import logarithmic, random_stable

from inerter import LinearSystem, StatusKind, frequency_response, h2_norm
from inerter.norms.h2 import _Schur, _solve, h2
from inerter.norms.mean_square import Transfer, mean_square
from inerter.norms.stability import split, stability

ZERO = [[0.0]]


def oscillator(omega, zeta, C=((1.0, 0.0),)):
    return LinearSystem([[0.0, 1.0], [-(omega**2), -2.0 * zeta * omega]], [[0.0], [1.0]], C, [[0.0]] * len(C))


@given(logarithmic(1e-4, 1e4), logarithmic(1e-6, 30.0))
def test_one_degree_of_freedom(omega, zeta):
    """Textbook: variances 1/(4 zeta omega^3) of displacement and 1/(4 zeta omega) of velocity."""
    displacement, velocity = h2(oscillator(omega, zeta, ((1.0, 0.0), (0.0, 1.0)))).outputs
    assert displacement == pytest.approx(0.5 / math.sqrt(zeta * omega**3), rel=1e-11)
    assert velocity == pytest.approx(0.5 / math.sqrt(zeta * omega), rel=1e-11)


@pytest.mark.parametrize("omega", [1e-3, 1.0, 37.0, 1e4])
def test_critical_damping(omega):
    """Two equal poles have one eigenvector, and are as stable as two different ones."""
    assert h2_norm(oscillator(omega, 1.0)) == pytest.approx(0.5 / omega**1.5, rel=1e-12)


@pytest.mark.parametrize("n", range(1, 11))
def test_a_chain_of_equal_lags(n):
    """Norm of 1/(s + 1)^n: the square is binomial(2 n - 2, n - 1) / 2^(2 n - 1)."""
    A = -np.eye(n) + np.eye(n, k=1)
    B, C = np.eye(n)[:, -1:], np.eye(n)[:1]
    result = h2(LinearSystem(A, B, C, ZERO))
    assert result.status.ok
    assert result.value == pytest.approx(math.sqrt(math.comb(2 * n - 2, n - 1) / 2 ** (2 * n - 1)), rel=1e-12)


def modes(omegas, zetas, weights):
    """Modal form, and its norm in closed form: sum over pairs of modes of residues over sums of poles."""
    n = len(omegas)
    A, B, C = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 1)), np.zeros((1, 2 * n))
    for i, (w, z, p) in enumerate(zip(omegas, zetas, weights, strict=True)):
        A[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[0.0, w], [-w, -2.0 * z * w]]
        B[2 * i + 1, 0], C[0, 2 * i] = p, p
    damped = omegas * np.sqrt(1.0 - zetas**2)
    poles = np.concatenate([-zetas * omegas + 1j * damped, -zetas * omegas - 1j * damped])
    half = weights**2 * omegas / (2j * damped)
    residues = np.concatenate([half, -half])
    square = np.sum(-np.outer(residues, residues.conj()) / (poles[:, None] + poles.conj()[None, :])).real
    return LinearSystem(A, B, C, ZERO), math.sqrt(square)


def changed(system, T, inverse):
    return LinearSystem(T @ system.A @ inverse, T @ system.B, system.C @ inverse, system.D)


@pytest.mark.parametrize("seed", range(20))
def test_lightly_damped_modes_hidden_by_a_rotation(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 21))
    system, norm = modes(10 ** rng.uniform(-0.5, 0.5, n), 10 ** rng.uniform(-6, -0.3, n), rng.standard_normal(n))
    Q = np.linalg.qr(rng.standard_normal((2 * n, 2 * n)))[0]
    assert h2_norm(changed(system, Q, Q.T)) == pytest.approx(norm, rel=1e-8)  # 1e-16 over 1e-6, with room for growth


@pytest.mark.parametrize("seed", range(20))
def test_units_of_the_states_change_nothing(seed):
    """Masses in g or in t: rounding-free changes by up to 1e12 leave every digit."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 21))
    system, norm = modes(10 ** rng.uniform(-2, 2, n), 10 ** rng.uniform(-6, -0.3, n), rng.standard_normal(n))
    units = 10.0 ** rng.uniform(-6, 6, 2 * n)
    scaled = changed(system, np.diag(units), np.diag(1.0 / units))
    assert h2_norm(system) == pytest.approx(norm, rel=1e-10)
    assert h2_norm(scaled) == pytest.approx(norm, rel=1e-10)


@given(logarithmic(1e-9, 1e9), st.integers(0, 30))
def test_time_in_other_units(factor, seed):
    """With time in units of 1/factor, rates grow by it and the norm of the same G by its root."""
    system = random_stable(np.random.default_rng(seed), 6, 2, 2, 1e-3)
    faster = LinearSystem(factor * system.A, factor * system.B, system.C, system.D)
    assert h2_norm(faster) == pytest.approx(math.sqrt(factor) * h2_norm(system), rel=1e-10)


@pytest.mark.parametrize("order", [1, 2, 3, 5, 8, 13, 21, 30, 40])
def test_random_systems_against_kronecker_products(order):
    rng = np.random.default_rng(order)
    system = random_stable(rng, order, int(rng.integers(1, 4)), int(rng.integers(1, 4)), 1e-2)
    eye = np.eye(order)
    operator = np.kron(eye, system.A) + np.kron(system.A, eye)
    P = np.linalg.solve(operator, -(system.B @ system.B.T).ravel()).reshape(order, order)
    np.testing.assert_allclose(h2(system).outputs, np.sqrt(np.diag(system.C @ P @ system.C.T)), rtol=1e-10)


@pytest.mark.parametrize("order", [3, 12, 40])
def test_random_systems_against_quadrature(order):
    """Gauss-Legendre in theta with omega = tan theta, which carries the whole axis to an interval."""
    system = random_stable(np.random.default_rng(100 + order), order, 2, 2, 0.05)
    edges = np.concatenate([[0.0], np.arctan(np.geomspace(1e-3, 1e5, 300)), [np.pi / 2]])
    x, weight = np.polynomial.legendre.leggauss(20)
    theta = (edges[:-1, None] + np.diff(edges)[:, None] * (x + 1) / 2).ravel()
    weights = (np.diff(edges)[:, None] * weight / 2).ravel()
    G = frequency_response(system, np.tan(theta))
    square = np.sum(np.sum(np.abs(G) ** 2, axis=(1, 2)) / np.cos(theta) ** 2 * weights) / np.pi
    assert h2_norm(system) == pytest.approx(math.sqrt(square), rel=1e-10)


def test_elimination_is_for_systems_whose_motions_all_decay():
    """It has a solution also where a motion grows, behind a decaying one too, and then it is no covariance."""
    for seed in range(30):
        system = random_stable(np.random.default_rng(seed), 1 + seed % 6, 2, 1, 1e-2)
        A, W = system.A, system.B @ system.B.T
        (solver, P, _), schur = _solve(A, A.astype(np.longdouble), W), _Schur(A)
        assert not isinstance(solver, _Schur)
        np.testing.assert_allclose(P, schur.solve(W), rtol=1e-9, atol=1e-12 * np.abs(P).max())
        Q = solver.solve(W, adjoint=True)
        np.testing.assert_allclose(Q, schur.solve(W, adjoint=True), rtol=1e-9, atol=1e-12 * np.abs(Q).max())
        grows = np.zeros((len(A) + 1, len(A) + 1))
        grows[:-1, :-1], grows[-1, 0], grows[-1, -1] = A, 1.0, 0.3
        with pytest.raises(np.linalg.LinAlgError):
            _solve(grows, grows.astype(np.longdouble), np.pad(W, (0, 1)))


@given(st.integers(0, 1000), st.integers(1, 12), st.integers(1, 3))
def test_white_noise_on_several_inputs_adds_in_squares(seed, order, inputs):
    system = random_stable(np.random.default_rng(seed), order, inputs, 2, 1e-2)
    alone = [h2_norm(system.subsystem(inputs=name)) for name in system.inputs]
    assert h2_norm(system) == pytest.approx(math.hypot(*alone), rel=1e-11)


def test_no_states_no_inputs_and_no_outputs_are_zero():
    assert h2_norm(LinearSystem(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), ZERO)) == 0.0
    assert h2_norm(LinearSystem([[-1.0]], np.zeros((1, 0)), [[1.0]], np.zeros((1, 0)))) == 0.0
    assert h2_norm(LinearSystem([[-1.0]], [[1.0]], np.zeros((0, 1)), np.zeros((0, 1)))) == 0.0


def block(*parts):
    """Systems side by side on one input, with their outputs added up."""
    return LinearSystem(
        scipy.linalg.block_diag(*(p.A for p in parts)),
        np.vstack([p.B for p in parts]),
        np.hstack([p.C for p in parts]),
        ZERO,
    )


def mute(system, *, inputs=1.0, outputs=1.0):
    return LinearSystem(system.A, inputs * system.B, outputs * system.C, system.D)


LAG = LinearSystem([[-2.0]], [[3.0]], [[1.0]], ZERO)  # norm 3/2
UNDAMPED = oscillator(5.0, 0.0)
INTEGRATOR = LinearSystem(ZERO, [[1.0]], [[1.0]], ZERO)
DOUBLE = LinearSystem([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]], ZERO)
GROWING = LinearSystem([[0.5]], [[1.0]], [[1.0]], ZERO)
FLUTTER = oscillator(5.0, -1e-3)
LASTING = {
    "undamped": (UNDAMPED, StatusKind.MARGINAL),
    "integrator": (INTEGRATOR, StatusKind.MARGINAL),
    "double integrator": (DOUBLE, StatusKind.MARGINAL),
    "growing": (GROWING, StatusKind.UNSTABLE),
    "flutter": (FLUTTER, StatusKind.UNSTABLE),
}


def rotated(system, seed=0):
    Q = np.linalg.qr(np.random.default_rng(seed).standard_normal((system.order, system.order)))[0]
    return changed(system, Q, Q.T)


@pytest.mark.parametrize("name", LASTING)
@pytest.mark.parametrize("hide", [lambda s: s, rotated])
def test_a_motion_that_does_not_decay_makes_the_norm_infinite(name, hide):
    part, kind = LASTING[name]
    result = h2(hide(block(LAG, oscillator(3.0, 0.1), part)))
    assert result.value == math.inf
    assert result.status.kind is kind
    assert "pole at" in result.status.message


@pytest.mark.parametrize("name", LASTING)
@pytest.mark.parametrize("how", [{"inputs": 0.0}, {"outputs": 0.0}])
@pytest.mark.parametrize("hide", [lambda s: s, rotated])
def test_unless_it_is_not_excited_or_not_seen(name, how, hide):
    system = hide(block(LAG, mute(LASTING[name][0], **how)))
    result = h2(system)
    assert result.status.ok
    assert result.value == pytest.approx(1.5, rel=1e-7)  # a double pole moves by the root of a rounding
    assert not stability(system).ok


def test_a_growing_motion_behind_a_decaying_one_is_found():
    """Cascade: the lag feeds the growing state, which nothing else excites."""
    system = LinearSystem([[-1.0, 0.0], [1.0, 0.3]], [[1.0], [0.0]], [[0.0, 1.0]], ZERO)
    assert h2(system).status.kind is StatusKind.UNSTABLE
    assert h2_norm(system) == math.inf


@pytest.mark.parametrize("zeta", [1e-3, 1e-6, 1e-9])
def test_light_damping_beside_fast_motions_is_damping(zeta):
    fast = LinearSystem([[-1e5]], [[1.0]], [[0.0]], ZERO)
    result = h2(block(oscillator(1.0, zeta), fast))
    assert result.status.ok
    assert result.value == pytest.approx(0.5 / math.sqrt(zeta), rel=1e-10)


def test_white_noise_straight_to_an_output_is_infinite():
    system = LinearSystem([[-1.0]], [[1.0]], [[1.0], [1.0]], [[0.0], [0.1]])
    result = h2(system)
    assert result.status.kind is StatusKind.DIRECT_TERM
    assert "y2" in result.status.message
    assert "y1" not in result.status.message
    np.testing.assert_allclose(result.outputs, [math.sqrt(0.5), math.inf])


def test_direct_terms_of_one_source_may_cancel():
    system = LinearSystem([[-1.0]], [[1.0, 1.0]], [[1.0]], [[2.0, -2.0]], sources=("road", "road"))
    assert h2_norm(system) == pytest.approx(math.sqrt(2.0), rel=1e-12)
    assert h2_norm(system.with_delays("road", [0.0, 0.1])) == math.inf


def test_an_output_that_does_not_move_has_the_mean_square_zero():
    """1 / (s + 1) less itself, at once and later."""
    for times in ((0.0, 0.0), (0.3, 0.3)):
        assert mean_square(Transfer([1, 1], ([1], [-1]), times)) == (0.0, [])


@given(st.integers(1, 6), st.integers(1, 3), st.integers(1, 3), st.integers(0, 2**32 - 1))
def test_a_stable_system_has_an_empty_lasting_part(order, inputs, outputs, seed):
    system = random_stable(np.random.default_rng(seed), order, inputs, outputs, 1e-2)
    parts = split(system)
    assert [m.shape for m in (parts.lasting.A, parts.lasting.B, parts.lasting.C)] == [(0, 0), (0, inputs), (outputs, 0)]
    assert parts.decaying.A.shape == (order, order)
