"""Narrow spectral lines that no motion explains: mains hum, its aliases, and other pickup."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import get_window

from inerter.records.periods import period_of
from inerter.records.record import Record
from inerter.records.smoothing import Motion

Vector = NDArray[np.float64]
HUM = (50.0, 60.0)  # Hz of the mains
_ALONE = 3.0  # amplitude over that of any other line within an octave to either side
_CLEAR = 12.0  # amplitude over the median within that range
_LEAST = 1e-3  # of the standard deviation of the force
_WIDTH = 4  # spectral lines of a Hann window's main lobe, to either side
_TONES = 6  # of the motion, whose multiples are not separate lines
_TONE = 0.05  # of the largest: more than the side lobes of a Hann window
_HIGHEST_MULTIPLE = 60
_MANY = 1 << 20


@dataclass(frozen=True)
class SpectralLine:
    """An isolated sine in the spectrum of a channel: frequency [Hz] and amplitude [unit of the channel]."""

    frequency: float
    amplitude: float


def isolated_line(record: Record, motion: Motion) -> SpectralLine | None:
    """The largest isolated line above the motion that is no harmonic of it; None if there is none.

    Friction and backlash cause lines at the harmonics of a periodic motion, of which each is about as large as the
    next; an isolated line is pickup.
    """
    values = record.force[:_MANY] - float(np.mean(record.force[:_MANY]))
    if values.size < 512 or record.duration < 1.0:
        return None
    window = get_window("hann", values.size)
    amplitude = 2.0 * np.abs(np.fft.rfft(window * values)) / float(window.sum())
    resolution = 1.0 / (values.size * record.interval)
    first = math.ceil(1.2 * motion.highest / resolution) + _WIDTH
    candidates = np.arange(first, amplitude.size - _WIDTH)
    multiples = _multiples(record, motion, amplitude.size)
    for at in candidates[np.argsort(-amplitude[candidates])][:8]:
        low, high = max(int(at / 2), first - _WIDTH), min(2 * int(at), amplitude.size)
        nearby = np.r_[low : at - _WIDTH, at + _WIDTH + 1 : high]
        if nearby.size < 8 * _WIDTH or multiples[at]:
            continue
        size = float(amplitude[at])
        alone = size > _ALONE * float(amplitude[nearby].max()) and size > _CLEAR * float(np.median(amplitude[nearby]))
        if alone and size > _LEAST * float(np.std(values)):
            return SpectralLine(_frequency(amplitude, int(at)) * resolution, size)
    return None


def hum_of_displacement(record: Record) -> tuple[SpectralLine, Vector] | None:
    """A sine of the mains in the displacement that the force does not follow, and its course [m]; None without one."""
    size = record.time.size
    if size < 512 or record.duration < 1.0:
        return None
    window, moved = get_window("hann", size), record.displacement - float(np.mean(record.displacement))
    moving, loading = (
        2.0 * np.abs(np.fft.rfft(window * (values - np.mean(values)))) / float(window.sum())
        for values in (moved, record.force)
    )
    for mains in HUM:
        lines = mains * size * record.interval
        near = np.arange(math.floor(0.99 * lines), math.ceil(1.01 * lines) + 1)
        if near[-1] > moving.size - _WIDTH:
            continue
        at = int(near[np.argmax(moving[near])])
        nearby = np.r_[int(at / 1.4) : at - _WIDTH, at + _WIDTH + 1 : min(int(1.4 * at), moving.size)]
        line = slice(at - _WIDTH, at + _WIDTH + 1)
        alone = moving[at] > max(_ALONE * float(moving[nearby].max()), _CLEAR * float(np.median(moving[nearby])))
        if not alone or loading[line].max() > _ALONE * float(loading[nearby].max()):
            continue
        frequency = _frequency(moving, at) / (size * record.interval)
        phase = 2.0 * math.pi * frequency * (record.time - record.time[0])
        sines = np.column_stack([np.cos(phase), np.sin(phase)])
        course = sines @ np.linalg.lstsq(window[:, None] * sines, window * moved)[0]
        return SpectralLine(frequency, float(math.sqrt(2.0) * np.std(course))), course
    return None


def _frequency(amplitude: Vector, at: int) -> float:
    """Position of a peak between spectral lines, by a parabola through logarithms."""
    a, b, c = np.log(np.maximum(amplitude[at - 1 : at + 2], 1e-300))
    return at + 0.5 * float((a - c) / (a - 2.0 * b + c)) if a - 2.0 * b + c < 0.0 else float(at)


def _multiples(record: Record, motion: Motion, size: int) -> NDArray[np.bool_]:
    """Spectral lines near a multiple of the motion's period, or of one of its strongest tones."""
    values = motion.displacement[:_MANY] - float(np.mean(motion.displacement[:_MANY]))
    spectrum = np.abs(np.fft.rfft(get_window("hann", values.size) * values))
    peaks = np.flatnonzero((spectrum[1:-1] > spectrum[:-2]) & (spectrum[1:-1] >= spectrum[2:])) + 1
    strongest = peaks[np.argsort(-spectrum[peaks])][:_TONES]
    tones = [_frequency(spectrum, int(p)) for p in strongest if spectrum[p] > _TONE * spectrum.max() and p > 2]
    period = record.period or period_of(record.displacement)
    if period is not None:
        samples = period / record.interval if record.period is not None else period
        base = record.time[:_MANY].size / samples
        tones += [base] if base > 4.0 * _WIDTH else []
    result = np.zeros(size, dtype=bool)
    at = np.arange(size)
    for tone in tones:
        order = np.round(at / tone)
        near = np.abs(at - order * tone) <= 1.5 + 0.02 * order
        result |= near & (order >= 1) & (order <= _HIGHEST_MULTIPLE) & (tone > 2.0 * _WIDTH)
    return result
