"""A record made ready to be compared with a model: the motion that it is given, and the force that it should answer."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from inerter.errors import IdentificationError, InerterError
from inerter.networks.elements.roles import Guard, Linear
from inerter.records.dropouts import MAD
from inerter.records.record import Record
from inerter.records.saturation import saturated_samples
from inerter.records.smoothing import Motion, quietest, resolution, smooth_displacement
from inerter.signals.signal import Signal
from inerter.simulation import event_driven
from inerter.simulation.inputs import InputTable, tabulate
from inerter.simulation.observe import trajectory_of
from inerter.simulation.start import initial_state
from inerter.simulation.trajectory import Trajectory
from inerter.systems.piecewise import PiecewiseSystem

Matrix = NDArray[np.float64]
MOST_SAMPLES = 400_000  # of one record: with more, a fit would take hours and find nothing new
_ROUNDED = 1e-9  # of an interval, by which times may differ from even ones
_PACE, _MOST_PARTS = 2.0, 7  # steps over the time in which the device answers; parts of an interval, as a power of 2
_AT_REST = 0.02  # of the largest velocity


class Tally:
    """How often a record was simulated, by all that share it, in whichever thread."""

    def __init__(self) -> None:
        self.total = 0
        self._lock = Lock()

    def add(self, count: int = 1) -> None:
        """Some more."""
        with self._lock:
            self.total += count

    def __reduce__(self) -> tuple[type[Tally], tuple[()]]:
        """Another process counts for itself."""
        return Tally, ()


@dataclass(frozen=True, eq=False)
class Experiment:
    """One record with its smoothed motion. Samples that are not `kept` are simulated but not compared.

    Times are counted from the first sample. Experiments that are made of one another share its `tally`.
    """

    record: Record
    motion: Motion
    kept: NDArray[np.bool_]
    table: InputTable  # of the motion
    noise: float  # [N] r.m.s. of the noise of the force
    information: Matrix  # (samples,) how much of the squared force of all samples kept lies up to each
    finer: dict[int, InputTable] = field(default_factory=dict)  # the motion in so many steps an interval
    tally: Tally = field(default_factory=Tally)

    def __getstate__(self) -> dict[str, object]:
        """What another process needs: tables are quicker made than sent."""
        return {**vars(self), "finer": {}}

    @property
    def size(self) -> int:
        return int(self.record.time.size)

    def table_in(self, parts: int) -> InputTable:
        """The motion in `parts` steps an interval."""
        if parts == 1:
            return self.table
        if parts not in self.finer:
            self.finer[parts] = _table(self.motion, parts)
        return self.finer[parts]

    def moved(self, displacement: Matrix, velocity: Matrix) -> Experiment:
        """The same record, had the table moved so."""
        motion = replace(self.motion, displacement=displacement, velocity=velocity)
        value, slope = (displacement - displacement[0])[:, None], velocity[:, None]
        table = replace(self.table, value=value, slope=slope, value_before=value, slope_before=slope)
        return replace(self, motion=motion, table=table, finer={})

    def late(self, delay: float | Matrix) -> Experiment:
        """The same record, had the table moved `delay` [s] later: what a force that is late answers to.

        It may be another one at each sample.

        Before its first sample and after its last the table is taken to stand still.
        """
        time = self.motion.time - self.motion.time[0] - delay
        within = np.clip(time, 0.0, self.motion.time[-1] - self.motion.time[0])
        height, velocity = _signal(self.motion).sample(within)
        return self.moved(height, np.where(time == within, velocity, 0.0))

    def force(self, system: PiecewiseSystem, samples: int | None = None) -> Matrix | None:
        """The force that the load cell would read of this device at the first `samples` samples; None if it fails."""
        run = self.run(system, samples)
        return None if run is None else run[reading_of(self.record)]

    def run(self, system: PiecewiseSystem, samples: int | None = None, moving: bool = False) -> Trajectory | None:
        """The motion of the device, from rest or (`moving`) carried along with the table; None if it fails."""
        self.tally.add()
        state = initial_state(system, self.table.value[0], "rest")
        if moving:
            state = _carried(system, state, self.table.slope[0])
        count = self.size if samples is None else min(samples, self.size)
        integration = event_driven.start(system, _shortened(self.table, count - 1), state)
        parts = parts_for(integration)
        if parts > 1:
            integration = event_driven.start(system, _shortened(self.table_in(parts), (count - 1) * parts), state)
        integration.advance(integration.table.time.size - 1)
        if not integration.status.ok:
            return None
        return trajectory_of(integration, None, self.record.source)


def experiment_of(record: Record, bandwidth: float | None = None, lead: float | None = None) -> Experiment:
    """Smooth the displacement, and leave out samples at which the load cell is saturated or the motion uncertain.

    `lead` [s] at the start are not compared; by default none if the table starts from rest, else a tenth.

    Raises `IdentificationError` for records that are too long, or `RecordError` for uneven ones.
    """
    if record.time.size > MOST_SAMPLES:
        raise IdentificationError(
            f"{record.source!r} has {record.time.size} samples; a fit takes up to {MOST_SAMPLES}. Trim or resample it."
        )
    if np.ptp(record.displacement) == 0.0:
        raise IdentificationError(
            f"The displacement of {record.source!r} is constant: nothing is identifiable from it."
        )
    if np.ptp(record.force) == 0.0:
        raise IdentificationError(f"The force of {record.source!r} is constant: nothing is identifiable from it.")
    motion = smooth_displacement(record, bandwidth)
    interval, count = record.interval, record.time.size
    try:
        table = _table(motion)
    except InerterError as error:
        raise IdentificationError(f"{record.source!r} cannot be simulated: {error}") from None
    kept = (
        np.convolve(saturated_samples(record), np.ones(3), "same") == 0.0
    )  # within a sample of one cut off it was too
    at_rest = abs(motion.velocity[0]) <= _AT_REST * np.abs(motion.velocity).max()
    wait = (0.0 if at_rest else 0.1 * record.duration) if lead is None else lead
    if not 0.0 <= wait < record.duration:
        raise IdentificationError(
            f"What is left out at the start, {wait:g} s, must be shorter than {record.duration:g} s."
        )
    kept[: round(wait / interval)] = False
    edge = min(round(1.0 / (motion.bandwidth * interval)), count // 10)
    kept[count - edge :] = False
    if not at_rest or wait > 0.0:
        kept[:edge] = False
    if kept.sum() < 50:
        raise IdentificationError(
            f"Of {record.source!r} only {kept.sum()} samples can be used; a fit needs 50 or more."
        )
    return Experiment(record, motion, kept, table, _noise(record), _information(record.force, kept))


def _noise(record: Record) -> float:
    """R.m.s. of the noise of the force [N]: as it is known, or as the quietest half-octave of its spectrum says.

    Less where impacts now and then are all of that: sixth differences leave little of any force, and their median
    little of what is not there most of the time.
    """
    if record.force_noise is not None:
        return record.force_noise
    sixth = MAD * float(np.median(np.abs(np.diff(record.force, 6)))) / math.sqrt(math.comb(12, 6))
    intermittent = max(sixth, resolution(record.force) / math.sqrt(12.0))
    return max(min(quietest(record.force, record.interval), intermittent), 1e-9)


def _information(force: Matrix, kept: NDArray[np.bool_]) -> Matrix:
    square = np.where(kept, (force - np.median(force[kept])) ** 2, 0.0)
    total = np.cumsum(square)
    return np.asarray(total / total[-1])


def reading_of(record: Record) -> str:
    """The output of the rig that the load cell of a record reads."""
    return "device_force" if record.force_bandwidth is None else "reading_force"


def disturbed(experiment: Experiment, noise: Matrix) -> Experiment:
    """The same experiment had the encoder's noise been larger by `noise` (samples,) [m]."""
    return experiment.moved(*experiment.motion.smooth(experiment.record.displacement + noise))


def forgotten(experiment: Experiment, system: PiecewiseSystem, level: float) -> int:
    """The sample from which on it no longer matters, beyond `level` [N], whether the device started at rest or not."""
    runs = [experiment.run(system, moving=moving) for moving in (False, True)]
    if runs[0] is None or runs[1] is None:
        return 0
    name = reading_of(experiment.record)
    apart = np.abs(runs[0][name] - runs[1][name]) > level
    return int(np.flatnonzero(apart)[-1]) + 1 if apart.any() else 0


def parts_for(integration: event_driven.Integration) -> int:
    """Into how many steps to part an interval so that whole steps serve where the device answers much faster.

    Else each of them would be gone through in as many pieces, which take a hundred times as long.
    """
    kinds = integration.system.nonlinear_elements
    reach = np.inf
    for friction in (0, 1):  # sticks, slips; gaps touch
        states = [friction if e.switches_by(Guard.FORCE) and e.acts else 1 for e in kinds]
        try:
            integration.mode(np.array(states, dtype=np.int64))
        except InerterError:
            continue
        reach = min(reach, float(integration.modes.reach[integration.count - 1]))
    wanted = integration.table.step / (_PACE * reach)
    return 1 << min(max(math.ceil(math.log2(max(wanted, 1e-9))), 0), _MOST_PARTS)


def _table(motion: Motion, parts: int = 1) -> InputTable:
    duration = float(motion.time[-1] - motion.time[0])
    return tabulate([_signal(motion)], [0.0], duration, duration / (motion.time.size - 1) / parts, every=parts)


def _signal(motion: Motion) -> Signal:
    time = motion.time - motion.time[0]
    even = np.linspace(0.0, time[-1], time.size)
    if np.max(np.abs(time - even)) > _ROUNDED * even[1]:  # times that a file rounds, in even steps all the same
        time = even
    height = motion.displacement - motion.displacement[0]  # where the table stands at the start does not matter
    return Signal.sampled(time, height, derivative=motion.velocity, label="measured displacement")


def _shortened(table: InputTable, segments: int) -> InputTable:
    end = segments + 1
    if end == table.time.size:
        return table
    special = np.append(table.special[table.special < segments], end).astype(np.int64)
    samples = int(np.sum(table.slot[:end] >= 0))
    value, slope = table.value[:end], table.slope[:end]
    return replace(
        table, time=table.time[:end], value=value, slope=slope, value_before=value, slope_before=slope,
        special=special, slot=table.slot[:end], sampled=table.sampled[:samples],
    )  # fmt: skip


def _carried(system: PiecewiseSystem, state: Matrix, velocity: Matrix) -> Matrix:
    """The same state with velocities at which springs, dampers and gaps keep their length."""
    E_a, E_w, E_z = system.rates
    laws = (Linear.STIFFNESS, Linear.DAMPING, Linear.CLOSED)
    soft = [i for i, b in enumerate(system.graph.branches) if b.element.linear in laws]
    rows = np.hstack([E_a, E_w])[soft]
    solved = np.linalg.lstsq(rows, -E_z[soft] @ velocity, rcond=1e-10)[0]
    moved = state.copy()
    moved[: E_a.shape[1]] = solved[: E_a.shape[1]]
    return moved
