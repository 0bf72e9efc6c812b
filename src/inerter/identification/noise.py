"""Noise model of a record: larger errors where the force jumps, and their autocorrelation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len

from inerter.records.dropouts import MAD

Matrix = NDArray[np.float64]
_LEAST = 1.0 / 3.0  # of the level: smallest error
_BANDS, _LINES = 6, 20  # of the spectrum of residuals: in an octave, and the fewest lines in each
_NEAR = 2  # samples before and after, whose errors are averaged


@dataclass(frozen=True, eq=False)
class Whitening:
    """Weighting and whitening of the residuals of a record, to independent values of size one.

    The instant at which the force jumps is as uncertain as the displacement: samples there count less. The weighted
    residuals are still coloured, because the smoothed encoder noise passes through the device; their spectrum is
    divided out.
    """

    weight: Matrix  # (samples,) 1/N, zero where samples are not compared
    centre: Matrix  # (bands,) frequencies in cycles a sample, and ...
    density: Matrix  # ... the spectrum of the weighted residuals there, 1 if they were white and of size one
    lines: Matrix | None = None  # a spectrum by which that of the bands is multiplied, at `lines_of` the residuals
    offsets: dict[int, Matrix] = field(default_factory=dict)  # cached, by size

    def __call__(self, residual: Matrix) -> Matrix:
        """Whitened residuals (samples,) or (samples, columns), zero where samples are not compared."""
        size = residual.shape[0]
        weight = self.weight[:size] if residual.ndim == 1 else self.weight[:size, None]
        white = weight * residual
        if self.centre.size or self.lines is not None:
            padded, frequency = _padded_size(size), lines_of(size)
            spectrum = np.ones(frequency.size) if self.lines is None else np.sqrt(self.lines)
            if self.centre.size:
                spectrum = spectrum * np.exp(0.5 * np.interp(frequency, self.centre, np.log(self.density)))
            divided = np.fft.rfft(white, padded, axis=0)
            divided /= spectrum if residual.ndim == 1 else spectrum[:, None]
            white = np.fft.irfft(divided, padded, axis=0)[:size]
        return np.asarray(np.where(weight > 0.0, white, 0.0))

    def of_offset(self, size: int) -> Matrix:
        """Whitened offset of 1 N over the first `size` samples."""
        if size not in self.offsets:
            self.offsets[size] = self(np.ones(size))
        return self.offsets[size]


def lines_of(size: int) -> Matrix:
    """Frequencies, in cycles a sample, of the lines at which so many samples are whitened."""
    return np.asarray(np.fft.rfftfreq(_padded_size(size)))


def _padded_size(size: int) -> int:
    return int(next_fast_len(size + size // 8, real=True))


def uniform_whitening(kept: NDArray[np.bool_], level: float) -> Whitening:
    """Whitening of independent errors of equal size `level` [N]."""
    return Whitening(kept / level, np.zeros(0), np.zeros(0))


def whitening_of(residual: Matrix, by: Whitening) -> Whitening:
    """The whitening `by` rescaled to the size of these residuals."""
    white = by(residual)[by.weight > 0.0]
    size = MAD * float(np.median(np.abs(white - np.median(white))))
    return replace(by, weight=by.weight / max(size, _LEAST), offsets={})


def noise_whitening(draws: Matrix, noise: float, compared: NDArray[np.bool_]) -> Whitening:
    """The whitening by residuals of sensor noise (draws, samples) [N], on the samples that are compared.

    `noise` [N] is that of the load cell; the rest comes from the encoder, at some instants more than at others.
    """
    of_encoder = np.maximum(np.mean(draws**2, axis=0) - noise**2, 0.0)
    window = np.ones(2 * _NEAR + 1)
    near = np.convolve(of_encoder, window, "same") / np.convolve(np.ones(of_encoder.size), window, "same")
    weight = np.where(compared, 1.0 / np.sqrt(noise**2 + near), 0.0)
    return Whitening(weight, *_spectrum(np.clip(weight * draws, -5.0, 5.0), float(np.mean(compared))))


def steady_whitening(draws: Matrix, noise: float, compared: NDArray[np.bool_], lines: Matrix) -> Whitening:
    """The whitening by residuals of noise (draws, samples) [N] whose spectrum is the same at all instants.

    Its spectrum is `lines`, over that of the load cell's `noise` [N], times one of bands.
    """
    by = replace(uniform_whitening(compared, noise), lines=lines)
    centre, density = _spectrum(np.clip(by(draws.T).T, -5.0, 5.0), float(np.mean(compared)))
    return replace(by, centre=centre, density=density)


def _spectrum(values: Matrix, share: float) -> tuple[Matrix, Matrix]:
    """Frequencies and densities of bands, each with enough lines to be estimated; `share` of the values are not zero.

    Of several rows, the mean.
    """
    density = np.mean(np.abs(np.fft.rfft(np.atleast_2d(values))) ** 2, axis=0) / (share * values.shape[-1])
    edges = [1]
    while edges[-1] < density.size:
        edges.append(max(edges[-1] + _LINES, int(edges[-1] * 2.0 ** (1.0 / _BANDS))))
    edges = [edge for edge in edges if edge <= density.size - _LINES]
    if len(edges) < 3:
        return np.zeros(0), np.zeros(0)
    lines = np.diff([*edges, density.size])
    means = np.add.reduceat(density, edges) / lines
    centre = (np.array(edges) + 0.5 * lines) / values.shape[-1]
    return centre, np.maximum(means, 1e-4 * float(means.max()))
