"""Excitations of the approximate linear model: periodic inputs of known size and band, as values."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from inerter.errors import PerformanceIndexError
from inerter.formatting import format_quantity, format_range
from inerter.signals.harmonics import flat_multisine
from inerter.signals.records import held_noise
from inerter.signals.signal import Signal
from inerter.simulation.inputs import InputTable, parts_of, tabulate
from inerter.simulation.observe import sampled_input
from inerter.validation import check_positive

Array = NDArray[np.float64]
_COARSEST = 5e-4  # [s] longest step for an input without steps of its own
_SMALL, _LARGE = 100_000, 1_000_000  # samples of all inputs whose table is kept for the next design: a few MB, 60 MB


@dataclass(frozen=True)
class MultisineExcitation:
    """Harmonics `lowest`, 2 `lowest`, ... up to `highest` [Hz] of one amplitude, with independent random phases.

    Every harmonic has the same size in every realisation, so that gains have no small divisors. It repeats after
    1 / `lowest` seconds. `rms` is in m for a road and in N for a force; None stands for that of Wang and Su (2008).

    Raises `PerformanceIndexError` unless all are positive and lowest < highest.

    >>> import inerter as it
    >>> it.MultisineExcitation(rms=2e-3, lowest=0.5, highest=20.0).highest  # m, Hz, Hz
    20.0
    """

    rms: float | None = None
    lowest: float = 0.1
    highest: float = 500.0
    is_held = False

    def __post_init__(self) -> None:
        _check_rms(self.rms)
        for which in ("lowest", "highest"):
            check_positive(PerformanceIndexError, f"The {which} frequency of an excitation", getattr(self, which), "Hz")
        if not 2.0 * self.lowest <= self.highest <= 1e6 * self.lowest:
            raise PerformanceIndexError(
                f"An excitation needs from 2 to 1e6 harmonics, got a band from "
                f"{format_range(self.lowest, self.highest, 'Hz', 6)}."
            )

    @property
    def period(self) -> float:
        """Period [s]."""
        return 1.0 / self.lowest

    @property
    def harmonics(self) -> int:
        """Number of harmonics."""
        return math.floor(self.highest / self.lowest * (1.0 + 1e-12))

    @property
    def samples(self) -> int:
        """Samples per period, at least four per period of the highest harmonic."""
        return max(4 * self.harmonics, math.ceil(self.period / _COARSEST * (1.0 - 1e-12)))

    def signal(self, rms: float, seed: int) -> Signal:
        """Realisation of the multisine with this r.m.s. value and seed."""
        return flat_multisine(seed, rms, self.lowest, self.highest)


@dataclass(frozen=True)
class NoiseExcitation:
    """Band-limited white noise as in Wang and Su (2008): normal samples held for `interval` that repeat after `period`.

    Outputs are sampled at the same instants. `rms` is in m for a road and in N for a force; None stands for that of
    the paper, 3.162 mm for a road.

    Raises `PerformanceIndexError` unless all are positive and the period is a whole number, four or more, of intervals.

    >>> import inerter as it
    >>> it.NoiseExcitation(rms=2e-3, interval=1e-3).is_held  # m, s
    True
    """

    rms: float | None = None
    interval: float = 1e-3  # [s]
    period: float = 100.0  # [s]
    is_held = True

    def __post_init__(self) -> None:
        _check_rms(self.rms)
        for which in ("interval", "period"):
            check_positive(PerformanceIndexError, f"The {which} of an excitation", getattr(self, which), "s")
        count = self.period / self.interval
        if not 4.0 <= count <= 1e8 or abs(count - round(count)) > 1e-6:
            raise PerformanceIndexError(
                f"The period of an excitation is a whole number of intervals, from 4 to 1e8; got "
                f"{format_quantity(self.period, 's', 6)} in intervals of {format_quantity(self.interval, 's', 6)}."
            )

    @property
    def samples(self) -> int:
        """Samples per period, one per interval."""
        return round(self.period / self.interval)

    @property
    def harmonics(self) -> int:
        """Number of harmonics below half the sampling rate."""
        return (self.samples - 1) // 2

    def signal(self, rms: float, seed: int) -> Signal:
        """Realisation of the held noise with this r.m.s. value and seed."""
        return held_noise(seed, rms**2 * self.interval, self.interval, self.period)


Excitation = MultisineExcitation | NoiseExcitation


@dataclass(frozen=True)
class ExcitedInputs:
    """An excitation of some inputs of a mechanism, each with its delay."""

    excitation: Excitation
    rms: float  # [m or N]
    delays: tuple[float | None, ...]  # [s] of roads, then forces; None: at rest

    @property
    def first(self) -> int:
        """Number of the input with the smallest delay, the reference of gains."""
        return min((d, i) for i, d in enumerate(self.delays) if d is not None)[1]

    @property
    def omega(self) -> Array:
        """Excited frequencies [rad/s]."""
        return 2.0 * math.pi / self.excitation.period * np.arange(1.0, self.excitation.harmonics + 1.0)

    def signals(self, seed: int) -> list[Signal | None]:
        """Signal of each input in one realisation, None for an input at rest; all are equal before their delays."""
        signal = self.excitation.signal(self.rms, seed)
        return [None if delay is None else signal for delay in self.delays]

    def realisation(self, seed: int) -> tuple[InputTable, Array]:
        """Input table over one period of a realisation, and its `power`."""
        size = self.excitation.samples * len(self.delays)
        tabulate_it = _kept if size <= _SMALL else _kept_large if size <= _LARGE else _tabulate_realisation
        return tabulate_it(self, seed)

    def power(self, samples: Array) -> Array:
        """Squared sizes of the excited harmonics in the samples of a period, both ends included."""
        spectrum = np.fft.rfft(samples[:-1])
        return np.asarray(np.abs(spectrum[1 : self.excitation.harmonics + 1]) ** 2)


def _tabulate_realisation(drive: ExcitedInputs, seed: int) -> tuple[InputTable, Array]:
    signals, period = drive.signals(seed), drive.excitation.period
    delays = [delay or 0.0 for delay in drive.delays]
    interval = period / drive.excitation.samples
    parts = parts_of(interval, delays) if drive.excitation.is_held else 1
    table = tabulate(signals, delays, period, interval / parts, every=parts)
    power = drive.power(sampled_input(table, 0, drive.first))
    return (table.repeating if drive.excitation.is_held else table), power


_kept, _kept_large = (lru_cache(maxsize=most)(_tabulate_realisation) for most in (32, 4))


def _check_rms(rms: object) -> None:
    if rms is not None:
        check_positive(
            PerformanceIndexError, "The r.m.s. value of an excitation", rms, "m for a road, of N for a force"
        )
