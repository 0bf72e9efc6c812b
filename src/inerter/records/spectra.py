"""Spectra of records at the frequencies of their displacement: periodic lines, and Welch's averages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import RecordError
from inerter.formatting import format_number, format_quantity
from inerter.records.periods import Periods
from inerter.records.record import Record
from inerter.records.smoothing import resolution

Matrix = NDArray[np.float64]
Complex = NDArray[np.complex128]
Chosen = NDArray[np.bool_]

_FAINT = 1e-3  # of the largest amplitude of velocity: smaller ones are not part of the excitation
_BESIDE = 0.05  # the same for the amplitudes within a decade, for lines: smaller ones are distortion
_LEVEL = 1e-3  # significance level: probability that noise alone is significant
_NEIGHBOURS = 21  # harmonics whose scatter is looked at together
_ABOVE_STEPS = 20.0  # times the quantisation noise of the encoder, for the power of a random displacement
_CHANCE = 0.05  # probability that an incoherent frequency is kept
_DECAYED = 3.0  # a period is steady if its force deviates from the last ones at most so many times as they do
_STEADY = 5e-3  # of the size of the force: deviations that never count as a transient
_SEGMENTS = 16.0  # shares of the time of all records in a segment, unless it is given
_LEAST_SAMPLES, _LEAST_BIN = 16, 3  # in a segment; the mean that is taken off reaches into the bins below


@dataclass(frozen=True, eq=False)
class Spectra:
    """Averaged auto and cross spectra of displacement and force at some frequencies, and the number of averages."""

    omega: Matrix  # (lines,) [rad/s]
    xx: Matrix  # (lines,) of the displacement
    ff: Matrix  # (lines,) of the force
    fx: Complex  # (lines,) of force times conjugate displacement
    count: float  # averages, as if they were independent
    notes: tuple[str, ...] = ()

    @property
    def coherence(self) -> Matrix:
        """Magnitude-squared coherence of force and displacement, shape (lines,)."""
        size = self.xx * self.ff
        return np.asarray(np.divide(np.abs(self.fx) ** 2, size, out=np.zeros_like(size), where=size > 0.0).clip(0, 1))

    def at(self, chosen: Chosen) -> Spectra:
        """The spectra at some of the lines."""
        return Spectra(self.omega[chosen], self.xx[chosen], self.ff[chosen], self.fx[chosen], self.count, self.notes)


@dataclass(frozen=True, eq=False)
class HarmonicLines:
    """Complex amplitudes of every period at every harmonic, for each record of one period."""

    omega: Matrix  # (harmonics,) [rad/s]
    displacement: tuple[Complex, ...]  # of each record (periods, harmonics) [m]
    force: tuple[Complex, ...]  # [N]
    least: float  # [m^2] squared amplitude that the steps of the encoder leave at a harmonic

    def is_excited(self) -> Chosen:
        """Mask of the harmonics of the excitation, shape (harmonics,).

        A harmonic counts if it exceeds the scatter between periods (an F test), its velocity is no less than a
        thousandth of the largest and a twentieth of the largest within a decade around it. The strongest counts alone
        if it has nearly all of the velocity: a sine, whose other harmonics are distortion.
        """
        means = np.array([amplitudes.mean(axis=0) for amplitudes in self.displacement])
        power = np.mean(np.abs(means) ** 2, axis=0)
        velocity = self.omega**2 * power
        strongest = int(np.argmax(velocity))
        if velocity[strongest] >= 0.95 * velocity.sum():
            return np.asarray(np.arange(power.size) == strongest)
        strong = np.maximum(_FAINT**2 * velocity.max(), _BESIDE**2 * _local_maximum(velocity))
        return np.asarray(self.significant() & (velocity >= strong))

    def at(self, chosen: Chosen) -> HarmonicLines:
        """The amplitudes at some of the harmonics."""
        return HarmonicLines(
            self.omega[chosen],
            tuple(x[:, chosen] for x in self.displacement),
            tuple(force[:, chosen] for force in self.force),
            self.least,
        )

    def without_transients(self) -> tuple[HarmonicLines, list[int]]:
        """The amplitudes without the transient periods at the start of each record, and their numbers.

        The force of a period is compared with the response of the last half of the periods to its displacement.
        """
        first = [_count_transient_periods(x, force) for x, force in zip(self.displacement, self.force, strict=True)]
        x, force = (
            tuple(values[n:] for values, n in zip(of, first, strict=True)) for of in (self.displacement, self.force)
        )
        return HarmonicLines(self.omega, x, force, self.least), first

    def significant(self) -> Chosen:
        """Mask of the harmonics that exceed the scatter and the quantisation noise of the displacement.

        Their power exceeds their own scatter (an F test), and that of their neighbours by a factor that noise alone
        would not reach at any of the harmonics.
        """
        means = np.array([amplitudes.mean(axis=0) for amplitudes in self.displacement])
        power, squares = np.mean(np.abs(means) ** 2, axis=0), 2 * len(means)
        many = float(scipy.stats.f.isf(_LEVEL / power.size, squares, 1e6))
        least = np.full(power.size, max(many * self.least, np.finfo(float).tiny))
        freedom = 2 * sum(amplitudes.shape[0] - 1 for amplitudes in self.displacement)
        if freedom:
            noise = np.zeros(power.size)
            for amplitudes, mean in zip(self.displacement, means, strict=True):
                count = amplitudes.shape[0]
                if count > 1:
                    noise += np.sum(np.abs(amplitudes - mean) ** 2, axis=0) / (count - 1) / count / len(means)
            usual = scipy.ndimage.median_filter(noise, _NEIGHBOURS, mode="nearest")
            usual = usual * (freedom / scipy.stats.chi2.median(freedom))
            least = np.maximum(
                least, np.maximum(float(scipy.stats.f.isf(_LEVEL, squares, freedom)) * noise, many * usual)
            )
        return np.asarray(power > least)


def lines_of(parts: Sequence[Periods]) -> HarmonicLines:
    """Amplitudes at the harmonics that all records have, below half the lowest rate."""
    period = float(np.mean([part.period for part in parts]))
    harmonics = min((part.displacement.shape[1] - 1) // 2 for part in parts)
    steps = [resolution(part.displacement.ravel()) ** 2 / part.displacement.shape[1] for part in parts]
    amplitudes = [
        tuple(
            np.fft.rfft(values, axis=1)[:, 1 : harmonics + 1] * (2.0 / values.shape[1])
            for values in (getattr(part, name) for part in parts)
        )
        for name in ("displacement", "force")
    ]
    omega = 2.0 * np.pi / period * np.arange(1.0, harmonics + 1.0)
    return HarmonicLines(omega, amplitudes[0], amplitudes[1], 4.0 / 12.0 * max(steps))


def welch(records: Sequence[Record], segment: float | None) -> Spectra:
    """Averages over Hann-windowed segments [s], half overlapping, of all records (Welch 1967).

    Overlapping segments count for less than independent ones by the correlation of their windows (Welch 1967).
    Frequencies below the third of a segment are left out: the mean that is taken off each reaches into them.

    Raises `RecordError` if the rates differ, or the records are too short for two segments.
    """
    interval = records[0].interval
    if any(abs(record.interval - interval) > 1e-6 * interval for record in records):
        rates = ", ".join(format_number(1.0 / record.interval) for record in records)
        raise RecordError(f"The records have different sampling rates ({rates} Hz). Resample them to one.")
    sizes = [record.time.size for record in records]
    length = min(round(sum(sizes) / _SEGMENTS), *sizes) if segment is None else round(segment / interval)
    step = max(length - length // 2, 1)
    counts = np.array([max((size - length) // step + 1, 0) for size in sizes])
    if length < _LEAST_SAMPLES or counts.min() < 1 or counts.sum() < 2:
        lengths = " and ".join(f"{r.source!r} of {format_quantity(r.duration, 's', 6)}" for r in records)
        raise RecordError(
            f"Too short: {lengths} cannot be divided into two or more segments of "
            f"{format_quantity(length * interval, 's', 6)} and at least {_LEAST_SAMPLES} samples."
        )
    window = scipy.signal.windows.hann(length, sym=False)
    sums = [np.zeros(length // 2 + 1, dtype=complex) for _ in range(3)]
    for record, count in zip(records, counts, strict=True):
        x, force = record.displacement, record.force
        for total, (one, other) in zip(sums, ((x, x), (force, force), (x, force)), strict=True):
            total += (
                count
                / counts.sum()
                * scipy.signal.csd(
                    one, other, 1.0 / interval, "hann", nperseg=length, noverlap=length - step, detrend="constant"
                )[1]
            )
    frequency = np.fft.rfftfreq(length, interval)
    xx, ff = sums[0].real, sums[1].real
    count = float(sum(_effective_count(window, step, int(n)) for n in counts))
    floor = max(resolution(record.displacement) for record in records) ** 2 / 12.0 * 2.0 * interval
    velocity = frequency**2 * xx
    inside = slice(_LEAST_BIN, (length - 1) // 2 + 1)
    velocity, significant = velocity[inside], (xx > _ABOVE_STEPS * floor)[inside]
    chosen = significant & (velocity >= _FAINT**2 * velocity.max())
    averages = Spectra(np.asarray(2.0 * np.pi * frequency[inside]), xx[inside], ff[inside], sums[2][inside], count)
    related = _is_coherent(averages.coherence, chosen, count)
    notes = [
        f"Welch: {counts.sum()} Hann segments of {format_quantity(length * interval, 's', 6)}, overlapping by half, "
        f"equivalent to {format_number(count, 3)} independent ones."
    ]
    if np.any(~chosen):
        notes.append(f"No response at {np.sum(~chosen)} frequencies: no displacement there.")
    if np.any(chosen & ~related):
        notes.append(
            f"No response at {np.sum(chosen & ~related)} frequencies: coherence of force and displacement not "
            f"significant (5 % level)."
        )
    found = averages.at(chosen & related)
    return Spectra(found.omega, found.xx, found.ff, found.fx, count, tuple(notes))


def _is_coherent(coherence: Matrix, chosen: Chosen, count: float) -> Chosen:
    """Mask of the lines at which the coherence of force and displacement is significant at the 5 % level.

    False everywhere, if there are no more such lines than noise would have, and none is significant among all.
    """
    chance = np.power(np.maximum(1.0 - coherence, 0.0), max(count - 1.0, 1e-9))  # of so high a one by noise
    related = chosen & (chance < _CHANCE)
    some = related.sum() > scipy.stats.binom.isf(_LEVEL, chosen.sum(), _CHANCE)
    return np.asarray(related & (some or np.min(chance[related], initial=1.0) < _LEVEL / max(chosen.sum(), 1)))


def _local_maximum(power: Matrix) -> Matrix:
    """The largest of the values within a decade around each harmonic, from a tenth of its frequency to ten times."""
    tenth = np.floor(10.0 * np.log10(np.arange(1, power.size + 1))).astype(int)
    peaks = np.zeros(tenth[-1] + 1)
    np.maximum.at(peaks, tenth, power)
    return np.asarray(scipy.ndimage.maximum_filter1d(peaks, 21, mode="nearest")[tenth])


def _count_transient_periods(x: Complex, force: Complex) -> int:
    """Number of transient periods at the start, which deviate more than the later half; 0 of fewer than four."""
    count = x.shape[0]
    half = count // 2
    strays = force - force[half:].mean(axis=0) / x[half:].mean(axis=0) * x
    size = np.sqrt(np.sum(np.abs(strays) ** 2, axis=1))
    usual = max(_DECAYED * float(np.median(size[half:])), _STEADY * float(np.linalg.norm(force[half:].mean(axis=0))))
    return int(np.argmax(np.append(size[:half] <= usual, True))) if count >= 4 else 0


def _effective_count(window: Matrix, step: int, count: int) -> float:
    """Equivalent number of independent segments of some overlapping ones."""
    energy = float(window @ window)
    shifts = [j for j in range(1, count) if j * step < window.size]
    shared = [(float(window[j * step :] @ window[: -j * step]) / energy) ** 2 for j in shifts]
    return count / (1.0 + 2.0 * sum((1.0 - j / count) * c for j, c in zip(shifts, shared, strict=True)))
