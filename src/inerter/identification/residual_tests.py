"""Tests of the residual of a fit against sensor noise, on the estimation and the validation data.

Residuals are whitened here by the spectrum and the size of simulated sensor noise, not by their own, which would hide a
misfit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from inerter.identification.experiment import Experiment
from inerter.identification.fit import NormalisedResidual
from inerter.identification.intervals import soft_squares
from inerter.identification.noise import Whitening, noise_whitening
from inerter.identification.problem import FitProblem
from inerter.identification.sensors import noise_residuals

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
_LAGS = 20
_INSTANTS = 100  # one sample of so many may be wrong with a correct model
_SOUND, _CHANCE = 1.1, 3.0  # allowed misfit, plus standard deviations of that of sensor noise


@dataclass(frozen=True, eq=False)
class NoiseReference:
    """Whitenings of each record by simulated sensor noise, and the draws of that noise."""

    fitted: Sequence[Whitening]
    checked: Sequence[Whitening]
    draws: Sequence[Matrix]  # (draws, samples) [N] residuals of each record by sensor noise alone

    def misfit(self, problem: FitProblem, point: Matrix, slow: int | None = None) -> NormalisedResidual:
        """Normalised residual of the device at a point, without a polynomial of degree `slow` over time in each part.

        Infinite where it cannot be simulated.
        """
        limits = self._sound[0][1], self._sound[1][1]
        centred = []
        for e, force, w in zip(problem.experiments, problem.forces(point), self.fitted, strict=True):
            if force is None:
                return NormalisedResidual(np.inf, np.inf, limits)
            centred.append(_without_offset(e.record.force - force, w) if problem.offset else e.record.force - force)
        fitted, checked = (
            math.sqrt(
                _mean_square(_without_slow(_whitened_residual(w, r), w, slow) for w, r in zip(ws, centred, strict=True))
                / usual
            )
            for ws, (usual, _) in zip((self.fitted, self.checked), self._sound, strict=True)
        )
        return NormalisedResidual(fitted, checked, limits)

    @cached_property
    def _sound(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Mean square of the draws on each part, and the allowed misfit there."""
        return self._usual(self.fitted), self._usual(self.checked)

    def _usual(self, whitenings: Sequence[Whitening]) -> tuple[float, float]:
        """Mean square of the draws, and the allowed misfit, which includes their scatter."""
        if not any(np.any(w.weight > 0.0) for w in whitenings):
            return math.nan, math.nan
        each = zip(*self.draws, strict=True)
        squares = np.array([_mean_square(map(_whitened_residual, whitenings, draws)) for draws in each])
        sizes = np.sqrt(squares)
        return float(np.mean(squares)), _SOUND + _CHANCE * float(np.std(sizes, ddof=1) / np.mean(sizes))

    def pattern(self, number: int, residual: Matrix) -> float:
        """p-value of residuals of one record no more autocorrelated than those of sensor noise."""
        w = self.fitted[number]
        usual = float(np.mean([portmanteau(_whitened_residual(w, draw)) for draw in self.draws[number]]))
        return float(
            chi2.sf(portmanteau(_whitened_residual(w, _without_offset(residual, w))) * _LAGS / max(usual, _LAGS), _LAGS)
        )


def scatter_of(limit: float) -> float:
    """Relative standard deviation of the misfit of sensor noise whose largest value is this limit."""
    return (limit - _SOUND) / _CHANCE


def noise_reference(problem: FitProblem, point: Matrix, checked: Sequence[Mask], seed: int) -> NoiseReference | None:
    """The judge of a device at a point, with independent noise for draws and whitening; None if not simulated."""
    known, draws = noise_residuals(problem, point, (seed, 5)), noise_residuals(problem, point, (seed, 6))
    if known is None or draws is None:
        return None
    rows = list(zip(known, problem.experiments, checked, strict=True))
    return NoiseReference(
        [noise_whitening(k, e.noise, e.kept) for k, e, _ in rows],
        [noise_whitening(k, e.noise, mask) for k, e, mask in rows],
        draws,
    )


def check_parts(fitted: Sequence[Experiment], whole: Sequence[Experiment], leads: Sequence[float]) -> Iterator[Mask]:
    """Mask of the validation samples of each record."""
    for e, all_kept, lead in zip(fitted, whole, leads, strict=True):
        checked = all_kept.kept & ~e.kept
        checked[: round(lead / e.record.interval)] = False
        checked[: int(np.flatnonzero(e.kept)[-1])] = False
        yield checked


def mean_square(white: Matrix) -> float:
    """Mean square of whitened residuals without the largest hundredth, such as an impact that came too early.

    Those beyond `ROBUST` count less than their square.
    """
    most = np.sort(np.abs(white))[: white.size - white.size // _INSTANTS]
    return float(np.mean(soft_squares(most)))


def portmanteau(white: Matrix) -> float:
    """Ljung and Box's statistic (1978) of the first 20 autocorrelations: of chi square with as many if independent."""
    x, n = np.clip(white - np.median(white), -4.0, 4.0), white.size
    square = max(float(x @ x), 1e-300)
    rho = np.array([float(x[k:] @ x[:-k]) / square for k in range(1, _LAGS + 1)])
    return n * (n + 2.0) * float(np.sum(rho**2 / (n - np.arange(1, _LAGS + 1))))


def _whitened_residual(whitening: Whitening, residual: Matrix) -> Matrix:
    return whitening(residual)[whitening.weight > 0.0]


def _mean_square(parts: Iterable[Matrix]) -> float:
    """Mean square of whitened residuals of all records; nan if there are none."""
    white = np.concatenate(list(parts))
    return mean_square(white) if white.size else math.nan


def _without_slow(white: Matrix, whitening: Whitening, degree: int | None) -> Matrix:
    """Whitened residuals without their least-squares polynomial over time."""
    if degree is None or not white.size:
        return white
    time = np.linspace(-1.0, 1.0, whitening.weight.size)
    columns = whitening(np.asarray(np.polynomial.legendre.legvander(time, degree)))[whitening.weight > 0.0]
    return np.asarray(white - columns @ np.linalg.lstsq(columns, white)[0])


def _without_offset(residual: Matrix, whitening: Whitening) -> Matrix:
    """The residual without the offset of the load cell estimated from the fitted part."""
    column, white = whitening.of_offset(residual.size), whitening(residual)
    return residual - float(column @ white / max(float(column @ column), 1e-300))
