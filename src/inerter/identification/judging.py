"""What a fit leaves against what the errors of sound sensors would leave, on the fitted part and on the check part.

The spectrum and the size by which residuals are whitened here are those of records drawn with errors like those of the
sensors, not the residuals' own: a residual cannot excuse itself.
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
from inerter.identification.fit import Misfit
from inerter.identification.intervals import ROBUST
from inerter.identification.noise import Whitening, yardstick
from inerter.identification.problem import FitProblem
from inerter.identification.sensors import sound

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
_LAGS = 20
_INSTANTS = 100  # one sample of so many may be wrong without the model being so
_SOUND, _CHANCE = 1.1, 3.0  # what a misfit may be, and standard deviations of that of sound sensors


@dataclass(frozen=True, eq=False)
class Judge:
    """How the residuals of each record are judged: whitened by what sound sensors leave, over how much that is."""

    fitted: Sequence[Whitening]
    checked: Sequence[Whitening]
    draws: Sequence[Matrix]  # (draws, samples) [N] that sound sensors leave of each record

    def misfit(self, problem: FitProblem, point: Matrix, slow: int | None = None) -> Misfit:
        """Of the problem's device at a point, but for a polynomial of degree `slow` over time in each part.

        Infinite where it cannot be simulated.
        """
        limits = self._sound[0][1], self._sound[1][1]
        centred = []
        for e, force, w in zip(problem.experiments, problem.forces(point), self.fitted, strict=True):
            if force is None:
                return Misfit(np.inf, np.inf, limits)
            centred.append(_centred(e.record.force - force, w) if problem.offset else e.record.force - force)
        fitted, checked = (
            math.sqrt(
                _mean_square(_without_slow(_compared(w, r), w, slow) for w, r in zip(ws, centred, strict=True)) / usual
            )
            for ws, (usual, _) in zip((self.fitted, self.checked), self._sound, strict=True)
        )
        return Misfit(fitted, checked, limits)

    @cached_property
    def _sound(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The mean square that the draws leave of each part, and what a misfit may be there."""
        return self._usual(self.fitted), self._usual(self.checked)

    def _usual(self, whitenings: Sequence[Whitening]) -> tuple[float, float]:
        """A misfit may be more by chance, and because no record of the sensors is quite like another."""
        if not any(np.any(w.weight > 0.0) for w in whitenings):
            return math.nan, math.nan
        each = zip(*self.draws, strict=True)
        squares = np.array([_mean_square(map(_compared, whitenings, draws)) for draws in each])
        sizes = np.sqrt(squares)
        return float(np.mean(squares)), _SOUND + _CHANCE * float(np.std(sizes, ddof=1) / np.mean(sizes))

    def pattern(self, number: int, residual: Matrix) -> float:
        """The p-value of residuals of one record no more autocorrelated than those of sound sensors are."""
        w = self.fitted[number]
        usual = float(np.mean([portmanteau(_compared(w, draw)) for draw in self.draws[number]]))
        return float(chi2.sf(portmanteau(_compared(w, _centred(residual, w))) * _LAGS / max(usual, _LAGS), _LAGS))


def judge_of(problem: FitProblem, point: Matrix, checked: Sequence[Mask], seed: int) -> Judge | None:
    """The judge of a device at a point, whose draws are of other errors than its whitening; None if it cannot move."""
    known, draws = sound(problem, point, (seed, 5)), sound(problem, point, (seed, 6))
    if known is None or draws is None:
        return None
    rows = list(zip(known, problem.experiments, checked, strict=True))
    return Judge(
        [yardstick(k, e.noise, e.kept) for k, e, _ in rows], [yardstick(k, e.noise, mask) for k, e, mask in rows], draws
    )


def check_parts(fitted: Sequence[Experiment], whole: Sequence[Experiment], leads: Sequence[float]) -> Iterator[Mask]:
    """The samples of each record that are kept to check the fit."""
    for e, all_kept, lead in zip(fitted, whole, leads, strict=True):
        checked = all_kept.kept & ~e.kept
        checked[: round(lead / e.record.interval)] = False
        checked[: int(np.flatnonzero(e.kept)[-1])] = False
        yield checked


def mean_square(white: Matrix) -> float:
    """Of whitened residuals but for the largest hundredth, such as of an impact that came too early.

    Those beyond 3 count less than their square.
    """
    most = np.sort(np.abs(white))[: white.size - white.size // _INSTANTS]
    return float(np.mean(2.0 * ROBUST**2 * (np.sqrt(1.0 + (most / ROBUST) ** 2) - 1.0)))


def portmanteau(white: Matrix) -> float:
    """Ljung and Box's statistic (1978) of the first 20 autocorrelations: of chi square with as many if independent."""
    x, n = np.clip(white - np.median(white), -4.0, 4.0), white.size
    square = max(float(x @ x), 1e-300)
    rho = np.array([float(x[k:] @ x[:-k]) / square for k in range(1, _LAGS + 1)])
    return n * (n + 2.0) * float(np.sum(rho**2 / (n - np.arange(1, _LAGS + 1))))


def _compared(whitening: Whitening, residual: Matrix) -> Matrix:
    return whitening(residual)[whitening.weight > 0.0]


def _mean_square(parts: Iterable[Matrix]) -> float:
    """Of whitened residuals of all records; nan of none."""
    white = np.concatenate(list(parts))
    return mean_square(white) if white.size else math.nan


def _without_slow(white: Matrix, whitening: Whitening, degree: int | None) -> Matrix:
    """Without what a polynomial over time makes of whitened residuals."""
    if degree is None or not white.size:
        return white
    time = np.linspace(-1.0, 1.0, whitening.weight.size)
    columns = whitening(np.asarray(np.polynomial.legendre.legvander(time, degree)))[whitening.weight > 0.0]
    return np.asarray(white - columns @ np.linalg.lstsq(columns, white)[0])


def _centred(residual: Matrix, whitening: Whitening) -> Matrix:
    """Without the offset of the load cell that the fitted part asks for."""
    column, white = whitening.of_offset(residual.size), whitening(residual)
    return residual - float(column @ white / max(float(column @ column), 1e-300))
