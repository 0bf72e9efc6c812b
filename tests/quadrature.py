"""The H2 norm by quadrature of |G|^2 along the frequency axis, with delays: no matrices, no Lyapunov equation."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import scipy.integrate

Response = Callable[[np.ndarray], np.ndarray]  # omega (n,) -> (n, arrivals)


def h2_by_quadrature(response: Response, delays: Sequence[float], edge: float) -> float:
    """Norm of sum_i G_i exp(-j omega delay_i), where `response` gives all G_i.

    Up to `edge` by Gauss-Legendre panels that grow with omega. Beyond it, where everything is smooth but the delays,
    each product G_i conj(G_j) is integrated by itself: with u = 1/omega where the delays are equal, else against
    its cosine and sine (QUADPACK's Fourier integrals).
    """
    delays = np.asarray(delays)
    ends = np.concatenate([[0.0], np.geomspace(1e-4 * edge, edge, 400)])
    x, w = np.polynomial.legendre.leggauss(20)
    omega = (ends[:-1, None] + np.diff(ends)[:, None] * (x + 1.0) / 2.0).ravel()
    weights = (np.diff(ends)[:, None] * w / 2.0).ravel()
    G = np.sum(response(omega) * np.exp(-1j * omega[:, None] * delays), axis=1)
    near = float(np.sum(np.abs(G) ** 2 * weights))
    return math.sqrt((near + sum(_tail(response, delays, i, j, edge, near) for i, j in _pairs(len(delays)))) / math.pi)


def _pairs(count: int) -> list[tuple[int, int]]:
    return [(i, j) for i in range(count) for j in range(count) if i >= j]


def _tail(response: Response, delays: np.ndarray, i: int, j: int, edge: float, near: float) -> float:
    def product(omega: float) -> complex:
        G = response(np.array([omega]))[0]
        return complex(G[i] * np.conj(G[j]))

    apart = float(delays[i] - delays[j])
    if apart == 0.0:
        x, w = np.polynomial.legendre.leggauss(60)
        u = (x + 1.0) / (2.0 * edge)
        G = response(1.0 / u)
        return float(np.sum((G[:, i] * np.conj(G[:, j])).real / u**2 * w / (2.0 * edge))) * (1.0 if i == j else 2.0)
    options = {"wvar": apart, "epsabs": 1e-12 * near, "limlst": 200, "limit": 200}
    cosine = scipy.integrate.quad(lambda w: product(w).real, edge, np.inf, weight="cos", **options)[0]
    sine = scipy.integrate.quad(lambda w: product(w).imag, edge, np.inf, weight="sin", **options)[0]
    return 2.0 * float(cosine + sine)
