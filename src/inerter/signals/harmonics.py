"""Sums of harmonics: sines, and the random multisines of Wang and Su (2008), eq. (17)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SignalError
from inerter.formatting import format_number, format_quantity, format_range
from inerter.signals.arguments import (
    Array,
    check_grid,
    finite_number,
    frequency_band,
    positive_number,
    random_generator,
    speed_or_none,
)
from inerter.signals.road import Road
from inerter.signals.signal import Pair, Signal

Complex = NDArray[np.complex128]

_CHUNK = 2**19  # complex numbers at a time: 8 MB
_LONGEST = 2**24  # points of one Fourier transform
_MOST = 10**7  # harmonics


@dataclass(frozen=True, kw_only=True, eq=False)
class Harmonics(Signal):
    """The real part of the sum of coefficient[k - 1] exp(2 pi i k t / period), k = 1, 2, ..."""

    coefficient: Complex  # (n,) amplitude and phase of each harmonic
    period: float  # [s]

    @property
    def frequencies(self) -> Array:
        """Frequency of each harmonic, k / period [Hz]."""
        return self._orders / self.period

    @property
    def amplitudes(self) -> Array:
        """Amplitude of each harmonic, in the unit of the signal."""
        return np.abs(self.coefficient)

    @property
    def phases(self) -> Array:
        """Phase of each cosine [rad], from -pi to pi."""
        return np.angle(self.coefficient)

    def grid(self, start: float, step: float, count: int) -> Pair:
        check_grid(start, step, count)
        length = round(min(self.period / step, 2.0 * _LONGEST))
        whole = abs(length * step - self.period) <= 1e-15 * self.period
        if whole and length <= min(_LONGEST, count * len(self.coefficient)):
            return self._by_transform(start, length, count)
        return self._by_blocks(start, step, count)

    def _evaluate(self, time: Array) -> Pair:
        flat = time.ravel()
        total = np.empty((2, len(flat)))
        size = max(_CHUNK // len(self.coefficient), 1)
        for i in range(0, len(flat), size):
            total[:, i : i + size] = (self._rows @ self._waves(flat[i : i + size])).real
        return total[0].reshape(time.shape), total[1].reshape(time.shape)

    def _by_transform(self, start: float, length: int, count: int) -> Pair:
        """One Fourier transform for a grid of `length` points per period; higher harmonics are aliased exactly."""
        orders = len(self.coefficient)
        rows = self._rows if start == 0.0 else self._rows * self._waves(np.array([start]))[:, 0]
        if orders <= length / 2:
            half = np.zeros((2, orders + 1), complex)  # the transform pads higher harmonics with zeros
            np.multiply(0.5, rows, out=half[:, 1:])
            if orders == length / 2:  # which has no mirror image
                half[:, -1] = rows[:, -1].real
        else:
            padded = np.pad(rows, ((0, 0), (1, -(orders + 1) % length)))
            spectrum = padded.reshape(2, -1, length).sum(axis=1)
            mirrored = np.roll(spectrum[:, ::-1], 1, axis=1).conj()
            half = 0.5 * (spectrum + mirrored)[:, : length // 2 + 1]
        value, slope = np.fft.irfft(half, length, norm="forward")
        if count <= length:
            return value[:count], slope[:count]
        return np.resize(value, count), np.resize(slope, count)

    def _by_blocks(self, start: float, step: float, count: int) -> Pair:
        """Direct summation: blocks of equal points share their sines, and a matrix product adds them."""
        block = math.isqrt(count) + 1
        coarse = start + step * block * np.arange(-(-count // block), dtype=float)
        fine = step * np.arange(block, dtype=float)
        total = np.zeros((2, len(coarse), block))
        rows, size = self._rows, max(_CHUNK // block, 1)
        for i in range(0, len(self.coefficient), size):
            part = slice(i, i + size)
            left: Complex = rows[:, None, part] * self._waves(coarse, part).T
            total += (left @ self._waves(fine, part)).real
        value, slope = total.reshape(2, -1)[:, :count]
        return value, slope

    @property
    def _orders(self) -> Array:
        return np.arange(1.0, len(self.coefficient) + 1.0)

    @cached_property
    def _rows(self) -> Complex:
        """(2, n): the coefficients of the value and of the derivative."""
        return np.array([self.coefficient, 2j * math.pi / self.period * self._orders * self.coefficient])

    def _waves(self, time: Array, part: slice = slice(None)) -> Complex:
        """(n, times): the unit harmonics."""
        turns = np.outer(self._orders[part], (time / self.period) % 1.0)
        waves: Complex = np.exp(2j * math.pi * (turns % 1.0))
        return waves


def multisine(road: Road, seed: int, lowest: float = 0.1, highest: float = 1000.0) -> Harmonics:
    """Random-phase multisine of a road: harmonics `lowest`, 2 `lowest`, ... up to `highest` [Hz].

    Phases are independent and uniform; the amplitudes A_i = sqrt(8 pi kappa V d_omega) / omega_i give every band the
    power of `road`. Repeats after 1 / lowest seconds. Source: Wang and Su (2008), eq. (17), with the root over the
    numerator alone.

    Raises `SignalError` unless 0 < lowest <= highest and `seed` is a non-negative integer.

    >>> road = multisine(Road(roughness=5e-7, speed=25.0), seed=0)
    >>> road.period, road.highest_frequency
    (10.0, 1000.0)
    """
    if not isinstance(road, Road):
        raise SignalError(f"A multisine requires a road such as Road(5e-7, 25.0), got {road!r}.")
    low, high = frequency_band("multisine", lowest, highest)
    amplitude = np.sqrt(4.0 * road.roughness * road.speed * low) / (low * _orders_up_to(low, high))
    return _random_phases("multisine", amplitude, low, seed, road.speed)


def two_tracks(road: Road, seed: int, lowest: float = 0.1, highest: float = 1000.0) -> dict[str, Harmonics]:
    """Left and right tracks of a random road with its coherence, for `simulate(..., road=...)`.

    Harmonics as in `multisine`; the mean of both tracks and half of their difference are independent. Without a
    coherence both tracks are the multisine of `seed`.

    Raises `SignalError` as `multisine` does.

    >>> import inerter as it
    >>> road = it.Road(5e-7, 25.0, coherence=it.Coherence.isotropic(track=1.5))  # m
    >>> tracks = it.two_tracks(road, seed=0)
    >>> sorted(tracks)
    ['left', 'right']
    """
    own = multisine(road, seed, lowest, highest)
    if road.coherence is None:
        return {"left": own, "right": own}
    s = 2j * math.pi * own.frequencies
    other = multisine(road, int(np.random.SeedSequence([seed, 1]).generate_state(1, np.uint64)[0]), lowest, highest)
    ratios = (road.coherence.in_phase(road.speed), road.coherence.in_anti_phase(road.speed))
    excesses = (road.coherence.excess(sign, road.speed) for sign in (1.0, -1.0))
    mean, half = (
        (0.0 if ratio is None else np.polyval(ratio[0], s) / np.polyval(ratio[1], s))
        * (part.coefficient if excess is None else excess.factor(2.0 * math.pi * own.frequencies) * part.coefficient)
        for ratio, excess, part in zip(ratios, excesses, (own, other), strict=True)
    )
    return {
        side: replace(own, coefficient=np.asarray(total), label=f"{side} track of a {own.label}")
        for side, total in (("left", mean + half), ("right", mean - half))
    }


def random_road(
    road: Road, seed: int, lowest: float = 0.1, highest: float = 1000.0
) -> Harmonics | dict[str, Harmonics]:
    """Road for `simulate(..., road=...)`: left and right tracks if it has a coherence, else a single one."""
    return (multisine if road.coherence is None else two_tracks)(road, seed, lowest, highest)


def flat_multisine(seed: int, rms: float, lowest: float, highest: float, speed: float | None = None) -> Harmonics:
    """Harmonics `lowest`, 2 `lowest`, ... up to `highest` [Hz] of one amplitude, with independent uniform phases.

    `rms` is that of the whole, in the unit of the signal. Repeats after 1 / lowest seconds.

    Raises `SignalError` unless `rms` is positive, 0 < lowest <= highest, and `seed` is a non-negative integer.

    >>> import inerter as it
    >>> motion = it.flat_multisine(0, 3e-4, 0.5, 20.0)  # seed, r.m.s. [m], Hz, Hz
    >>> motion.highest_frequency
    20.0
    """
    size = positive_number("The r.m.s. value of a multisine", rms, "its unit")
    low, high = frequency_band("multisine", lowest, highest)
    count = len(_orders_up_to(low, high))
    amplitude = np.full(count, size * math.sqrt(2.0 / count))
    return _random_phases(f"flat multisine of {format_number(size)} r.m.s.", amplitude, low, seed, speed_or_none(speed))


def sine(amplitude: float, frequency: float, phase: float = 0.0, speed: float | None = None) -> Harmonics:
    """`amplitude` sin(2 pi `frequency` t + `phase`), with the frequency in Hz and the phase in rad.

    Raises `SignalError` unless the frequency is positive and all are finite numbers.

    >>> sine(0.01, frequency=2.0)([0.0, 0.125])
    array([0.  , 0.01])
    """
    return _single("sine", -1j, amplitude, frequency, phase, speed)


def cosine(amplitude: float, frequency: float, phase: float = 0.0, speed: float | None = None) -> Harmonics:
    """`amplitude` cos(2 pi `frequency` t + `phase`), with the frequency in Hz and the phase in rad.

    Raises `SignalError` unless the frequency is positive and all are finite numbers.

    >>> import inerter as it
    >>> motion = it.cosine(1e-3, frequency=4.0)  # m, Hz
    >>> motion.period, float(motion.sample(0.0)[0])  # s, m
    (0.25, 0.001)
    """
    return _single("cosine", 1.0 + 0j, amplitude, frequency, phase, speed)


def _single(
    name: str, turn: complex, amplitude: float, frequency: float, phase: float, speed: float | None
) -> Harmonics:
    size = finite_number(f"The amplitude of a {name}", amplitude, "its unit")
    rate = positive_number(f"The frequency of a {name}", frequency, "Hz")
    angle = finite_number(f"The phase of a {name}", phase, "rad")
    coefficient = np.array([turn * size * np.exp(1j * angle)])
    return _harmonics(
        f"{name} of {format_number(size)}, {format_quantity(rate, 'Hz', 6)}", coefficient, rate, speed_or_none(speed)
    )


def _random_phases(name: str, amplitude: Array, lowest: float, seed: int, speed: float | None) -> Harmonics:
    phase = random_generator(seed).uniform(0.0, 2.0 * math.pi, len(amplitude))
    label = f"{name}, {format_range(lowest, lowest * len(amplitude), 'Hz', 6)}, seed {seed}"
    return _harmonics(label, amplitude * np.exp(1j * phase), lowest, speed)


def _harmonics(label: str, coefficient: Complex, lowest: float, speed: float | None) -> Harmonics:
    coefficient.setflags(write=False)
    highest = lowest * len(coefficient)
    return Harmonics(label=label, coefficient=coefficient, period=1.0 / lowest, highest_frequency=highest, speed=speed)


def _orders_up_to(lowest: float, highest: float) -> Array:
    """Orders 1, 2, ... of the multiples of `lowest` up to `highest` inclusive."""
    count = highest / lowest
    if count > _MOST:
        raise SignalError(
            f"A multisine from {format_range(lowest, highest, 'Hz', 6)} has {format_number(count, 3)} harmonics; at "
            f"most 1e7 are supported."
        )
    return np.arange(1.0, math.floor(count * (1.0 + 1e-12)) + 1.0)
