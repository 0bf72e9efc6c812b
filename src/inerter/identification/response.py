"""Frequency response of a model on the displacement of a record, and its linear response."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from inerter.errors import LinearSystemError, RecordError, Status
from inerter.formatting import format_quantity
from inerter.networks.elements import Network, check_network
from inerter.networks.transform import linearise
from inerter.records.periods import common_periods, whole_periods
from inerter.records.record import Record
from inerter.records.response import Estimator, frequency_response
from inerter.records.result import Response, exact_response
from inerter.records.spectra import lines_of
from inerter.signals.harmonics import Harmonics
from inerter.signals.signal import Signal
from inerter.simulation.simulate import simulate
from inerter.validation import check_positive, checked, real_numbers
from inerter.vehicle.rig import Rig

Matrix = NDArray[np.float64]
_STEP = 2e-4  # [s] longest of the simulation
_ABOVE = 1.25  # times the highest frequency of the response: cut-off frequency of the displacement
_HIGHEST = 0.8  # of half the rate: no filter is applied above that
_ORDER = 4  # of the Butterworth filter, which goes forward and backward


@checked(RecordError)
def model_response(
    model: Network | Rig,
    records: Record | Sequence[Record],
    *,
    estimator: Estimator = "H1",
    segment: float | None = None,
    step: float = _STEP,
) -> Response:
    """The response of a device on the rig to the displacement of the records, with the estimator of the records.

    With friction and backlash the response depends on the amplitude, so a model and a measurement must be compared at
    the same displacement. The displacement is smoothed first, to remove encoder quantisation: where it is periodic, to
    the harmonics of its mean period that exceed the scatter, with the device in its steady state; otherwise by a
    Butterworth filter, forward and backward, a quarter above the highest frequency of their response, with the device
    starting from rest. The frequencies are those of `frequency_response(records)`. `step` [s] is the longest of the
    simulation.

    Raises `RecordError` as `frequency_response` does, and where a simulation fails; `DesignError`, `MechanismError` and
    `SimulationError` as `simulate` does. The accuracy of the simulation is the `status`.

    >>> import inerter as it, numpy as np
    >>> t = np.arange(2000) * 1e-3
    >>> moved = 1e-3 * np.sin(2 * np.pi * 5 * t)
    >>> record = it.Record(t, moved, 2e4 * moved)
    >>> it.model_response(it.Spring(1e4) | it.Damper(10.0), record).gain.round(3)
    array([10004.934])
    """
    rig = model if isinstance(model, Rig) else Rig(model)
    check_positive(RecordError, "The step of the simulation", step, "s")
    chosen = [records] if isinstance(records, Record) else list(records)
    measured = frequency_response(chosen, estimator=estimator, segment=segment)
    if segment is None and (periods := common_periods(chosen)) is not None:
        moved = [_mean_period(record, period) for record, period in zip(chosen, periods, strict=True)]
        answered = [_in_steady_state(rig, motion, record, step) for motion, record in zip(moved, chosen, strict=True)]
    else:
        cutoff = _ABOVE * measured.frequency[-1]
        answered = [_from_rest(rig, smooth_record(record, cutoff), step) for record in chosen]
    answers = [record for record, _ in answered]
    if not any(np.ptp(record.force) for record in answers):  # such as within the backlash of a gap
        found = exact_response(measured.omega, np.zeros(measured.omega.size, dtype=complex), measured.amplitude)
    else:
        found = frequency_response(answers, estimator=estimator, segment=segment)
        found = found.lines(_among(found.omega, measured.omega))
        if found.estimator == "periodic":  # two periods that are the same have no scatter
            found = exact_response(found.omega, found.value, found.amplitude)
    notes = [note for record, _ in answered for note in record.notes]
    status = next((status for _, status in answered if not status.ok), found.status)
    found = replace(found, source="model", status=status, notes=tuple(dict.fromkeys(notes)))
    bands = {record.force_bandwidth for record in chosen}
    return with_load_cell(found, bands.pop()) if len(bands) == 1 else found


def with_load_cell(response: Response, bandwidth: float | None) -> Response:
    """The response of a model with a load cell of this bandwidth [Hz]: Butterworth, second order."""
    if bandwidth is None:
        return response
    s = 1j * response.frequency / bandwidth
    read = exact_response(response.omega, response.value / (s * s + math.sqrt(2.0) * s + 1.0), response.amplitude)
    note = f"With a load cell bandwidth of {format_quantity(bandwidth, 'Hz', 6)}."
    return replace(read, source=response.source, status=response.status, notes=(*response.notes, note))


def linear_response(model: Network | Rig, omega: ArrayLike, cell_bandwidth: float | None = None) -> Response:
    """The linear response of a device, j omega times its admittance: friction neglected, gaps closed.

    With a load cell of `cell_bandwidth` [Hz], if that is given.

    Raises `NetworkError` if there is no network, `DesignError` if a value is free, `LinearSystemError` unless omega
    holds positive frequencies [rad/s], `RecordError` unless the bandwidth is a positive number.

    >>> import inerter as it
    >>> import numpy as np
    >>> response = it.linear_response(it.Inerter(100.0), [1.0, 10.0])  # rad/s
    >>> np.allclose(response.value, [-100.0, -10000.0])  # force over displacement [N/m]: -omega^2 b
    True
    """
    device = check_network(model.device if isinstance(model, Rig) else model)
    if cell_bandwidth is not None:
        check_positive(RecordError, "The bandwidth of a load cell", cell_bandwidth, "Hz")
    given = real_numbers(omega)
    if given is None or given.ndim > 1 or not np.all(np.isfinite(given) & (given > 0.0)):
        raise LinearSystemError("omega must be a list of positive frequencies [rad/s].")
    frequencies = np.atleast_1d(given)
    value = np.asarray(1j * frequencies * device.admittance(1j * frequencies))
    linear = linearise(device)
    left_out = {e.key: [o.label for o in linear.left_out if o.key == e.key] for e in linear.left_out}
    notes = [f"{key.capitalize()} neglected: {', '.join(labels)}." for key, labels in left_out.items()]
    notes += [f"Gaps closed: {', '.join(linear.gaps)}."] if linear.gaps else []
    return with_load_cell(
        replace(exact_response(frequencies, value), source="linear model", notes=tuple(notes)), cell_bandwidth
    )


def smooth_record(record: Record, cutoff: float) -> Record:
    """The record with its displacement low-pass filtered at `cutoff` [Hz]: Butterworth, order 4, forward and backward.

    Unchanged where the cut-off is close to half the rate.
    """
    if cutoff >= _HIGHEST * 0.5 / record.interval:
        return record.with_notes("Displacement not filtered: it extends to nearly half the sampling rate.")
    filter_ = scipy.signal.butter(_ORDER, cutoff, fs=1.0 / record.interval, output="sos")
    return record.with_notes(
        f"Displacement low-pass filtered at {format_quantity(cutoff, 'Hz')} (Butterworth, forward and backward).",
        displacement=scipy.signal.sosfiltfilt(filter_, record.displacement),
    )


def _among(omega: Matrix, others: Matrix) -> NDArray[np.bool_]:
    """Mask of the frequencies that are also among `others`, which increase."""
    after = np.searchsorted(others, omega * (1.0 - 1e-6))
    return np.asarray(np.append(others, np.inf)[after] <= omega * (1.0 + 1e-6))


def _mean_period(record: Record, period: float) -> Harmonics:
    """The mean period of a displacement, with the harmonics that exceed its scatter."""
    part = whole_periods(record, period)
    lines = lines_of([part])
    significant = lines.is_excited() | lines.significant()
    amplitudes = np.where(significant, lines.displacement[0].mean(axis=0), 0.0)
    last = 1 + int(np.max(np.flatnonzero(amplitudes), initial=0))
    return Harmonics(
        label=f"mean period of {record.source}",
        coefficient=amplitudes[:last],
        period=part.period,
        highest_frequency=last / part.period,
    )


def _in_steady_state(rig: Rig, motion: Harmonics, record: Record, step: float) -> tuple[Record, Status]:
    """Two equal periods of the record of a model, and the status of the simulation."""
    count = max(round(motion.period / record.interval), 2 * motion.coefficient.size + 2, 4)
    every = math.ceil(motion.period / count / step * (1.0 - 1e-9))
    run = simulate(rig, displacement=motion, initial="periodic", step=motion.period / (count * every), every=every)
    if not run.status.ok and run.time.size < count:
        raise RecordError(f"The model cannot follow {record.source!r}: {run.status.message}.")
    time = np.asarray(np.arange(2 * count) * (motion.period / count))
    x, force = (np.tile(run[name][:count], 2) for name in ("displacement", "device_force"))
    count_significant = np.count_nonzero(motion.coefficient)
    notes = (f"Steady state of the model on the mean period of the displacement, of {count_significant} harmonics.",)
    return Record(time, x, force, source=record.source, notes=notes, period=motion.period), run.status


def _from_rest(rig: Rig, record: Record, step: float) -> tuple[Record, Status]:
    """The record of the model from rest, and the status of the simulation."""
    every = math.ceil(record.interval / step * (1.0 - 1e-9))
    signal = Signal.sampled(np.arange(record.time.size) * record.interval, record.displacement)
    run = simulate(rig, displacement=signal, duration=record.duration, step=record.interval / every, every=every)
    if run.time.size < record.time.size:
        raise RecordError(f"The model cannot follow {record.source!r}: {run.status.message}.")
    notes = (*record.notes[-1:], "The model starts from rest.")
    return Record(record.time, record.displacement, run["device_force"], source=record.source, notes=notes), run.status
