"""A test rig with a known device: a motion table, an encoder and a load cell, with realistic faults."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy  # its signal is loaded at first use: checking a file does not need it
from numpy.typing import NDArray

from inerter.errors import IdentificationError
from inerter.formatting import format_quantity
from inerter.identification.models import with_mount
from inerter.networks.elements import Network
from inerter.records.record import Record
from inerter.signals.signal import Signal
from inerter.simulation.simulate import RunSettings, check_simulation, simulate
from inerter.validation import check_positive, check_whole, is_number
from inerter.vehicle.rig import Rig

Matrix = NDArray[np.float64]
GRAVITY = 9.80665  # [m/s^2] standard, for load cells that are rated in kg
_FINEST = 1e-4  # [s] between the knots of the table's motion, at most
_TABLE_DAMPING = 0.7
_SEEN, _SMALL = 3.0, 1e-4  # least r.m.s. of relevant motion, over the encoder error and over the motion


@dataclass(frozen=True)
class _RunSteps:
    """The steps of a run and the samples among them."""

    parts: int  # steps in the interval of the samples
    first: int  # sample, from the beginning of the command
    samples: int
    step: float  # [s]

    @property
    def steps(self) -> int:
        """Number of steps from the beginning of the command to the last sample."""
        return (self.first + self.samples - 1) * self.parts

    @property
    def sample_steps(self) -> NDArray[np.int64]:
        """Numbers of the steps at which samples are taken."""
        return np.asarray((self.first + np.arange(self.samples)) * self.parts)


@dataclass(frozen=True)
class VirtualRig:
    """A simulated rig with a known device, so that identified values can be compared with the true ones.

    The command drives a motion table of second order with bandwidth `table_bandwidth` [Hz], on which the device has no
    effect. The encoder and the load cell are sampled `sampling` times a second; both have normal noise
    (r.m.s.) before they are rounded to their resolution. The load cell has a bandwidth (Butterworth, second order),
    a range beyond which it saturates, an offset, a gain and a delay; it counts tension as positive unless
    `reversed`.

    The defaults are those of the rig of Wang and Su (2008), section 4: a load cell of 100 kg with a resolution of
    0.02 kg, an encoder of 1 um; values that the paper does not print are assumptions.

    Raises `IdentificationError` for invalid sensor values, `DesignError` if a value of the device is free.

    >>> import inerter as it
    >>> rig = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), seed=0, sampling=500.0)  # Hz
    >>> record = rig.run(it.cosine(1e-3, 3.0), 1.0)  # m, Hz, s
    >>> record.duration, record.interval
    (1.0, 0.002)
    """

    device: Network
    seed: int = 0
    sampling: float = 1000.0  # [Hz]
    table_bandwidth: float = 50.0  # [Hz]
    encoder_resolution: float = 1e-6  # [m]
    encoder_noise: float = 0.2e-6  # [m]
    force_range: float = 100.0 * GRAVITY  # [N]
    force_resolution: float = 0.02 * GRAVITY  # [N]
    force_noise: float = 0.1  # [N]
    force_bandwidth: float = 300.0  # [Hz]
    force_offset: float = 0.0  # [N]
    force_gain: float = 1.0
    force_delay: float = 0.0  # [s]
    reversed: bool = False

    def __post_init__(self) -> None:
        for name in ("sampling", "table_bandwidth", "force_range", "force_bandwidth"):
            check_positive(IdentificationError, f"The {name} of a rig", getattr(self, name), "its unit")
        for name in ("encoder_resolution", "encoder_noise", "force_resolution", "force_noise", "force_delay"):
            value = getattr(self, name)
            if not is_number(value) or value < 0.0:
                raise IdentificationError(f"The {name} of a rig must be a non-negative number, got {value!r}.")
        if not is_number(self.force_offset) or not is_number(self.force_gain) or self.force_gain <= 0.0:
            raise IdentificationError(
                f"The offset of a load cell must be a number of N and its gain positive, got {self.force_offset!r} and "
                f"{self.force_gain!r}. For a load cell that is positive in compression use `reversed`."
            )
        check_whole(IdentificationError, "The seed", self.seed)
        Rig(self.device)

    def check(self, command: Signal, duration: float, start: float = 0.0) -> int:
        """Number of samples; raises the errors that `run` would raise before it simulates."""
        check_positive(IdentificationError, "The duration of a run", duration, "s")
        if not is_number(start) or start < 0.0:
            raise IdentificationError(f"The start of a record must be a non-negative time in s, got {start!r}.")
        if not isinstance(command, Signal):
            raise IdentificationError(f"The command must be a signal, such as cosine(...), got {command!r}.")
        times = self._times(duration, start)
        if times.samples < 4:
            raise IdentificationError(
                f"{format_quantity(duration, 's', 6)} are less than 4 samples at "
                f"{format_quantity(self.sampling, 'Hz', 6)}."
            )
        rig, end = Rig(with_mount(self.device), self.force_bandwidth), times.steps * times.step
        command.sample(end)
        table = Signal.sampled([0.0, end], [0.0, 0.0], label=command.label)  # at rest: the motion does not matter
        check_simulation(rig, {"displacement": table}, RunSettings(duration=end, step=times.step))
        return times.samples

    def _times(self, duration: float, start: float) -> _RunSteps:
        parts = math.ceil(1.0 / self.sampling / _FINEST)
        first, count = round(start * self.sampling), round(duration * self.sampling) + 1
        return _RunSteps(parts, first, count, 1.0 / self.sampling / parts)

    def run(self, command: Signal, duration: float, start: float = 0.0) -> Record:
        """The record of the sensors from `start` to `start` + `duration` [s] under the command.

        The rig is at rest at t = 0 where the command begins. The time of the record begins at zero. The same rig has
        the same noise for the same number of samples. A note reports motion above half the sampling rate.

        Raises `IdentificationError` for an invalid command or times, and errors as `simulate` does.
        """
        self.check(command, duration, start)
        times = self._times(duration, start)
        step, steps, interval = times.step, times.steps, 1.0 / self.sampling
        position, velocity = self._table_motion(command.grid(0.0, step, steps + 1)[0], step)
        time, moved = (
            step * np.arange(steps + 1),
            position - position[0],
        )  # the device is at rest where the table starts
        table = Signal.sampled(time, moved, derivative=velocity, label=command.label)
        rig = Rig(with_mount(self.device), self.force_bandwidth)
        run = simulate(rig, displacement=table, duration=steps * step, step=step)
        if not run.status.ok:
            raise IdentificationError(f"The virtual rig cannot be simulated: {run.status}.")
        at = times.sample_steps
        delayed = np.interp(step * at - self.force_delay, table.time, run[rig.reading])
        record = self._read(position[at], delayed, interval, command)
        error = math.hypot(self.encoder_noise, self.encoder_resolution / math.sqrt(12.0))
        highest = highest_frequency(position[at[0] :], step, _SEEN * error)
        if highest <= 0.5 * self.sampling:
            return record
        return record.with_notes(
            f"The table has components up to {format_quantity(highest, 'Hz', 3)}, above the Nyquist frequency of "
            f"{format_quantity(0.5 * self.sampling, 'Hz', 6)}: faster motion is aliased. Sample at "
            f"{format_quantity(2.5 * highest, 'Hz', 3)} or more."
        )

    def _table_motion(self, command: Matrix, step: float) -> tuple[Matrix, Matrix]:
        """Position and velocity of the table, which begins at rest."""
        position, velocity = _low_pass(command - command[0], self.table_bandwidth, _TABLE_DAMPING, step)
        return command[0] + position, velocity

    def _read(self, displacement: Matrix, force: Matrix, interval: float, command: Signal) -> Record:
        random = np.random.default_rng(self.seed)
        count = displacement.size
        position = _quantise(displacement + self.encoder_noise * random.standard_normal(count), self.encoder_resolution)
        sign = -1.0 if self.reversed else 1.0
        load = sign * self.force_gain * force + self.force_offset + self.force_noise * random.standard_normal(count)
        load = np.clip(_quantise(load, self.force_resolution), -self.force_range, self.force_range)
        return Record(
            time=np.asarray(interval * np.arange(count, dtype=np.float64)),
            displacement=position,
            force=load,
            source=f"virtual rig, {command.label}, seed {self.seed}",
            force_range=self.force_range,
            force_bandwidth=self.force_bandwidth,
            period=command.period,
        )


def highest_frequency(motion: Matrix, step: float, least: float) -> float:
    """The frequency [Hz] above which less than `least` (r.m.s.) of a motion lies, or 1e-4 of it; 0 of none.

    `motion` has a value every `step` [s].
    """
    window = scipy.signal.get_window("hann", motion.size)
    square = (
        np.abs(np.fft.rfft(window * scipy.signal.detrend(motion))) ** 2 * 2.0 / (motion.size * float(window @ window))
    )
    above = np.sqrt(np.cumsum(square[::-1])[::-1])
    seen = np.flatnonzero(above > max(least, _SMALL * float(above[0])))
    return float(seen[-1]) / (motion.size * step) if seen.size else 0.0


def _quantise(values: Matrix, resolution: float) -> Matrix:
    return np.asarray(values if resolution == 0.0 else resolution * np.rint(values / resolution))


def _low_pass(signal: Matrix, bandwidth: float, damping: float, step: float) -> tuple[Matrix, Matrix]:
    """A signal after a low pass of second order, and its derivative; exact for a signal that is linear over a step.

    It starts in the steady state of the first value.
    """
    w = 2.0 * math.pi * bandwidth
    A = np.array([[0.0, 1.0], [-w * w, -2.0 * damping * w]])
    system = (A, np.array([[0.0], [w * w]]), np.eye(2), np.zeros((2, 1)))
    Ad, Bd, Cd, Dd, _ = scipy.signal.cont2discrete(system, step, "foh")
    denominator = np.poly(Ad)
    results = []
    for row in range(2):
        numerator = np.poly(Ad - Bd @ Cd[row : row + 1]) + (Dd[row, 0] - 1.0) * denominator
        start = scipy.signal.lfilter_zi(numerator, denominator) * signal[0]
        results.append(scipy.signal.lfilter(numerator, denominator, signal, zi=start)[0])
    return results[0], results[1]
