"""What is known of the errors of a record: how they grow where the force jumps, and how they hang together in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

Matrix = NDArray[np.float64]
ORDER = 25  # of the autoregression
_MAD = 1.4826  # standard deviations in a median absolute deviation
_FEWEST = 20 * ORDER


@dataclass(frozen=True, eq=False)
class Whitening:
    """Makes residuals of a record independent and of size one, as far as the record tells.

    An instant at which the model's force jumps is known only as well as the displacement: there the residual of a
    sample is `timing` times the change of the force between samples, on top of `level` [N]. What is left is an
    autoregression, because the smoothed noise of the encoder passes through the device.
    """

    weight: Matrix  # (samples,) 1/N, zero where samples are not compared
    filter: Matrix  # (ORDER + 1,)

    def __call__(self, residual: Matrix) -> Matrix:
        """Whitened residuals (samples,) or (samples, columns), zero where samples are not compared."""
        size = residual.shape[0]
        weight = self.weight[:size] if residual.ndim == 1 else self.weight[:size, None]
        white = lfilter(self.filter, [1.0], weight * residual, axis=0)
        return np.asarray(np.where(weight > 0.0, white, 0.0))


def plain(kept: NDArray[np.bool_], level: float) -> Whitening:
    """Every sample with the same error `level` [N], independent of the others."""
    return Whitening(kept / level, np.array([1.0]))


def whitening_of(residual: Matrix, force: Matrix, kept: NDArray[np.bool_], floor: float) -> Whitening:
    """The whitening that the residuals of a model with this `force` ask for; `floor` [N] is the least error."""
    change = np.abs(np.diff(force, prepend=force[0], append=force[-1]))
    change = np.maximum(change[1:], change[:-1])
    r, d = residual[kept] - np.median(residual[kept]), change[kept]
    quiet = d <= np.median(d)
    level = max(_MAD * float(np.median(np.abs(r[quiet]))), floor)
    steep = d >= np.quantile(d, 0.95)
    excess = np.median(np.abs(r[steep])) * _MAD
    timing = max(float(excess) ** 2 - level**2, 0.0) / max(float(np.median(d[steep])) ** 2, 1e-300)
    weight = np.where(kept, 1.0 / np.sqrt(level**2 + timing * change**2), 0.0)
    scaled = np.clip(weight * (residual - np.median(residual[kept])), -5.0, 5.0)
    coefficients = _autoregression(scaled, min(ORDER, int(kept.sum()) // 20))
    white = lfilter(coefficients, [1.0], scaled)[kept]
    return Whitening(weight / max(_MAD * float(np.median(np.abs(white))), 0.05), coefficients)


def _autoregression(values: Matrix, order: int) -> Matrix:
    """Coefficients that leave the least of `values`, by Yule and Walker, of the order that Akaike's criterion asks."""
    size = values.size
    if size < _FEWEST or order < 1:
        return np.array([1.0])
    spectrum = np.abs(np.fft.rfft(values, 2 * size)) ** 2
    lags = np.fft.irfft(spectrum)[: order + 1] / size
    lags[0] *= 1.0 + 1e-9
    best, chosen = size * np.log(lags[0]), np.array([1.0])
    for p in range(1, order + 1):
        a = solve_toeplitz(lags[:p], lags[1 : p + 1])
        left = lags[0] - float(a @ lags[1 : p + 1])
        score = size * np.log(max(left, 1e-12 * lags[0])) + 2.0 * p
        if score < best - 2.0:
            best, chosen = score, np.concatenate([[1.0], -a])
    return chosen
