"""Norms by modes of random systems against quadrature over frequency, and compiled code against plain Python."""

import numpy as np
import pytest
from quadrature import h2_by_quadrature

from inerter import Filter
from inerter.kernels import modal
from inerter.methods.modal_norm import delay_poles
from inerter.norms.delay import transfer
from inerter.systems.autocorrelation import autocorrelation

BAND, LOW = Filter([5.0, 0.0], [1.0, 5.0, 40.0]), Filter([2.0, 8.0], [1.0, 4.0, 9.0])
FEED = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, -0.2]])  # direct terms of the output behind the filter


def random_system(rng, n, delays, filters, order=None):
    """A descriptor of a system that decays, affine in two values, and the matrices at any values."""
    m, o = len(delays), len(filters)
    S0 = rng.normal(size=(n, n))
    rates = S0 - S0.T - np.diag(rng.uniform(0.4, 3.0, n))
    A = np.array([rates, 0.1 * np.diag(-rng.uniform(0.0, 1.0, n)), 0.1 * (S0 - S0.T)])
    B = np.array([rng.normal(size=(n, m)), 0.2 * rng.normal(size=(n, m)), np.zeros((n, m))])
    C = np.array([rng.normal(size=(o, n)), 0.2 * rng.normal(size=(o, n)), np.zeros((o, n))])
    D = np.array([FEED[:o, :m], 0.5 * FEED[:o, :m], 0.2 * FEED[:o, :m]])
    S = np.concatenate([np.eye(n)[None], np.zeros((2, n, n))])
    none = np.zeros((3, o, n))
    descriptor = (S, A, B, np.eye(n), np.zeros((n, n)), np.zeros((n, m)), none, C, D)
    stacks = (S, np.concatenate([A, B], axis=2), none, np.concatenate([C, D], axis=2))
    row = np.concatenate([stack.reshape(3, -1) for stack in stacks], axis=1)
    noises = [autocorrelation(one) for one in filters]
    noise = (
        np.array(delays), np.arange(o), np.cumsum([0, *(one.poles.size for one in noises)]),
        np.concatenate([one.poles for one in noises]), np.concatenate([one.residues for one in noises]),
        np.concatenate([one.errors for one in noises]), np.array([one.direct for one in noises]),
        delay_poles(order), 1e-9,
    )  # fmt: skip
    return descriptor, (np.ascontiguousarray(row), np.zeros((0, 0))), noise


def by_quadrature(descriptor, delays, filters, p, order=None):
    """Norms of all outputs from the frequency response of the matrices and of the filters, and of an approximant."""
    matrices = [part[0] + np.tensordot(p, part[1:], 1) if part.ndim == 3 else part for part in descriptor]
    (_, A, B, _, _, _, _, C, D), unit = matrices, np.eye(descriptor[3].shape[0])

    def norm(output, one):
        def response(omega):
            gains = np.linalg.solve(1j * omega[:, None, None] * unit - A, np.broadcast_to(B, (omega.size, *B.shape)))
            late = 1.0 if order is None else np.stack([transfer(omega, delay, order) for delay in delays], axis=1)
            if one is None:
                return C[output] @ gains * late
            return (C[output] @ gains + D[output]) * one.response(omega)[:, None] * late

        return h2_by_quadrature(response, delays if order is None else np.zeros(len(delays)), 100.0)

    return [norm(output, one) for output, one in enumerate(filters)]


CASES = [
    (2, (0.0, 0.1, 0.3), (LOW, BAND)),
    (5, (0.0,), (None, BAND)),
    (6, (0.0, 0.4), (LOW, BAND)),
    (4, (0.0, 0.0, 0.3), (BAND, LOW)),
    (7, (0.0, 0.2, 0.7), (None, LOW)),
]
APPROXIMATED = [(6, (0.0, 0.0, 0.3), (BAND, LOW), 5), (7, (0.0, 0.7), (None, LOW), 4)]


@pytest.mark.parametrize(("n", "delays", "filters", "order"), [*((*case, None) for case in CASES), *APPROXIMATED])
def test_norms_and_gradients_are_those_of_the_integral(n, delays, filters, order):
    rng = np.random.default_rng(n)
    descriptor, extended, noise = random_system(rng, n, delays, filters, order)
    point, weights = rng.uniform(0.5, 1.5, 2), np.array([1.0, 0.7])
    norms, gradients, errors = modal.norms_by_modes(point[None], descriptor, extended, noise, weights)
    assert errors[0] < 1e-10
    assert norms[0] == pytest.approx(
        by_quadrature(descriptor, delays, filters, point, order), rel=2e-6 if None in filters else 1e-8
    )
    for i in range(2):

        def value(shift, i=i):
            at = point + shift * (np.arange(2) == i)
            return float(modal.norms_by_modes(at[None], descriptor, extended, noise, np.empty(0))[0][0] @ weights)

        step = 1e-3
        slope = (8.0 * (value(step) - value(-step)) - value(2.0 * step) + value(-2.0 * step)) / (12.0 * step)
        assert gradients[0, i] == pytest.approx(slope, rel=1e-9, abs=1e-10 * float(norms[0] @ weights))


@pytest.mark.parametrize("case", [CASES[4], APPROXIMATED[1]])
def test_compiled_code_gives_the_numbers_of_plain_python(case):
    rng = np.random.default_rng(0)
    given = random_system(rng, *case)
    points, weights = rng.uniform(0.5, 1.5, (3, 2)), np.ones(2)
    found = modal.norms_by_modes(points, *given, weights)
    plain = modal.norms_by_modes.function(points, *given, weights)
    assert found[0] == pytest.approx(plain[0], rel=1e-13)
    assert found[1] == pytest.approx(plain[1], rel=1e-11, abs=1e-13)


def test_modes_that_do_not_decay_or_are_not_apart_are_refused():
    descriptor, extended, noise = random_system(np.random.default_rng(1), 4, (0.0,), (BAND,))
    for A in (np.diag([1e-3, -1.0, -2.0, -3.0]), np.diag([-1.0, -1.0, -2.0, -3.0]) + np.eye(4, k=1)):
        stack = np.concatenate([A[None], np.zeros((2, 4, 4))])
        parts = (descriptor[0], stack, *descriptor[2:])
        row = extended[0].copy()
        row[:, 16 : 16 + 4 * 5] = np.concatenate([stack, descriptor[2]], axis=2).reshape(3, -1)
        norms, gradients, errors = modal.norms_by_modes(np.zeros((1, 2)), parts, (row, extended[1]), noise, np.ones(1))
        assert np.isinf(errors[0])
        assert np.isnan([*norms[0], *gradients[0]]).all()
