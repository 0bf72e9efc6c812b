"""A record prepared for comparison with a model: smoothed motion, force and compared samples."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from inerter.errors import IdentificationError, InerterError
from inerter.formatting import format_alike, format_quantity
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.records.dropouts import MAD
from inerter.records.record import CHANNELS, Record
from inerter.records.saturation import saturated_samples
from inerter.records.slower_channels import slower_channel
from inerter.records.smoothing import Motion, interpolate, quietest, resolution, smooth_displacement
from inerter.signals.signal import Signal
from inerter.simulation import event_driven
from inerter.simulation.initial_state import initial_state
from inerter.simulation.inputs import InputTable, tabulate
from inerter.simulation.observe import trajectory_of
from inerter.simulation.trajectory import Trajectory
from inerter.systems.piecewise import PiecewiseSystem

Matrix = NDArray[np.float64]
MOST_SAMPLES = 400_000  # of one record: with more, a fit would take hours without better estimates
_ROUNDED = 1e-9  # of an interval, by which times may differ from even ones
_PACE, _MOST_PARTS = 2.0, 7  # steps over the response time of the device; parts of an interval, as a power of 2
_TOO_MANY = 2.0  # times as many parts are needed: a fit would take hours
_AT_REST, _TURNING = 0.02, 0.3  # of the largest velocity and acceleration: a table that is at rest, not turning back
_END, _SHORT = 16, 0.15  # samples next to an end, at least, where filter and spline of the motion rest on its
# continuation; but of a short record not more than a share of it, as its validation part is a fifth
_FEWEST = 50  # samples that a fit requires
_FASTEST_CELL = 600.0  # of the sampling rate: bandwidth of a load cell, whose equations are solved in steps of its own
_SLOWEST_CELL = 1e-2  # periods of its bandwidth in a record, at least
_HEAVIEST = 1e3  # of the measured force: the inertia of a fixture, which the device would cancel to a thousandth
_DELAYS, _DELAYED_SAMPLES = 6, 100_000  # of which the motion is kept, as for the differences of a fit; at most
_CERTAIN = 10.0  # times the noise of the acceleration, which is larger at the ends of a record
_KNOTS, _MOST_KNOTS = 20.0, 2  # of the motion in its shortest period, at least; of an interval, as a power of 2 ...
_RIGID_KNOTS, _MOST_RIGID_KNOTS = 160.0, 5  # ... and of a rigid device: cubics are worse for accelerations ...
_FILTERED = 0.3  # ... unless a load cell of at most this share of the sampling rate averages them over an interval
_BARELY = 1.0  # largest pole times duration of a free motion that hardly changes over a record, as an offset does not


class SimulationCount:
    """Number of simulations of a record, counted over all threads."""

    def __init__(self) -> None:
        self.total = 0
        self._lock = Lock()

    def add(self, count: int = 1) -> None:
        """Add simulations."""
        with self._lock:
            self.total += count

    def __reduce__(self) -> tuple[type[SimulationCount], tuple[()]]:
        """Pickle as an empty count: each process counts separately."""
        return SimulationCount, ()


@dataclass(frozen=True, eq=False)
class Experiment:
    """One record with its smoothed motion. Samples that are not `kept` are simulated but not compared.

    Times are counted from the first sample. Copies of an experiment share its `tally`.
    """

    record: Record
    motion: Motion
    kept: NDArray[np.bool_]
    table: InputTable  # of the motion
    noise: float  # [N] r.m.s. of the noise of the force
    information: Matrix  # (samples,) cumulative share of the squared force of all samples kept
    rigid: bool = False  # whether the force follows the accelerations of the table, as that of a rigid device
    finer: dict[int, InputTable] = field(default_factory=dict)  # the motion in so many steps an interval
    delayed: dict[float, Experiment] = field(default_factory=dict)  # by the delay, those that were used last
    tally: SimulationCount = field(default_factory=SimulationCount)

    def __getstate__(self) -> dict[str, object]:
        """State for another process, without tables, which are faster to compute than to send."""
        return {**vars(self), "finer": {}, "delayed": {}}

    @property
    def size(self) -> int:
        return int(self.record.time.size)

    def table_in(self, parts: int) -> InputTable:
        """The motion in `parts` steps per interval."""
        if parts == 1:
            return self.table
        if parts not in self.finer:
            knots = _knots_per_interval(self.motion, self.rigid)
            self.finer[parts] = self.table_in(knots).refine(parts // knots) if parts > knots else self._knotted(parts)
        return self.finer[parts]

    def _knotted(self, knots: int) -> InputTable:
        """The motion with so many knots in each interval."""
        height, slope = _between_samples(self.motion, knots)
        value, rate = height[:, None], slope[:, None]
        finer = self.table.refine(knots)
        return replace(finer, value=value, slope=rate, value_before=value, slope_before=rate)

    def with_motion(self, displacement: Matrix, velocity: Matrix) -> Experiment:
        """The same record with another motion of the table."""
        motion = replace(self.motion, displacement=displacement, velocity=velocity)
        value, slope = (displacement - displacement[0])[:, None], velocity[:, None]
        table = replace(self.table, value=value, slope=slope, value_before=value, slope_before=slope)
        return replace(self, motion=motion, table=table, finer={}, delayed={})

    def with_delay(self, delay: float | Matrix) -> Experiment:
        """The same record with the motion of the table delayed by `delay` [s], as a delayed force requires.

        The delay may differ from sample to sample.

        Before the first sample and after the last the table is assumed at rest.
        """
        known = self.delayed.get(delay) if isinstance(delay, float) else None
        if known is None:
            time = self.motion.time - self.motion.time[0] - delay
            within = np.clip(time, 0.0, self.motion.time[-1] - self.motion.time[0])
            height, velocity = _signal(self.motion, _knots_per_interval(self.motion)).sample(within)
            known = self.with_motion(height, np.where(time == within, velocity, 0.0))
        if isinstance(delay, float) and delay not in self.delayed:
            self.delayed[delay] = known
            for earlier in list(self.delayed)[: -max(min(_DELAYS, _DELAYED_SAMPLES // self.size), 1)]:
                self.delayed.pop(earlier, None)
        return replace(self, motion=known.motion, table=known.table, finer=known.finer, delayed={})

    def _first_velocity(self) -> Matrix:
        """The largest velocity of the table in its first period [m/s], since at the first sample it may turn back."""
        first = self.table.slope[: math.ceil(1.0 / (self.motion.highest * self.record.interval)) + 1]
        return np.asarray(first[int(np.argmax(np.abs(first[:, 0])))])

    def is_too_coarse(self, system: PiecewiseSystem) -> bool:
        """Whether the device is so fast for the samples that each interval would take the integrator many steps."""
        motion = _truncate(self.table_in(_knots_per_interval(self.motion, self.rigid)), 1)
        integration = event_driven.start(system, motion, initial_state(system, self.table.value[0], "rest"))
        return _steps_wanted(integration) > _TOO_MANY * 2.0**_MOST_PARTS

    def force(self, system: PiecewiseSystem, samples: int | None = None) -> Matrix | None:
        """Load cell force [N] of this device at the first `samples` samples; None if the simulation fails."""
        run = self.run(system, samples)
        return None if run is None else run[load_cell_output(self.record)]

    def run(self, system: PiecewiseSystem, samples: int | None = None, moving: bool = False) -> Trajectory | None:
        """The motion of the device, from rest or (`moving`) moving with the table; None if the simulation fails."""
        self.tally.add()
        state = initial_state(system, self.table.value[0], "rest")
        if moving:
            state = _consistent_velocities(system, state, self._first_velocity())
        count = self.size if samples is None else min(samples, self.size)
        knots = _knots_per_interval(self.motion, self.rigid)
        integration = event_driven.start(system, _truncate(self.table_in(knots), (count - 1) * knots), state)
        parts = knots * steps_per_interval(integration)
        if parts > knots:
            integration = event_driven.start(system, _truncate(self.table_in(parts), (count - 1) * parts), state)
        integration.advance(integration.table.time.size - 1)
        if not integration.status.ok:
            return None
        return trajectory_of(integration, None, self.record.source)


def free_motions(experiment: Experiment, system: PiecewiseSystem, samples: int) -> Matrix:
    """The free motions of a linear device (samples, motions), of which its unknown initial state sets free forces.

    They decay from the first compared sample, before which they are zero. There are none if the record begins at rest,
    or the device has friction or gaps, with which motions are not sums.
    """
    time = experiment.record.interval * np.arange(samples, dtype=np.float64)
    if experiment.kept[0] or system.nonlinear:
        return np.zeros((samples, 0))
    state = initial_state(system, experiment.table.value[0], "rest")
    n = system.order
    rates = event_driven.start(system, _truncate(experiment.table, 1), state).mode(np.zeros(0, dtype=np.int64))[:n, :n]
    poles = np.linalg.eigvals(rates)
    poles = poles[(poles.imag >= 0.0) & (np.abs(poles) * experiment.record.duration > _BARELY)]
    first = int(np.argmax(experiment.kept))
    free = np.zeros((samples, poles.size), dtype=complex)
    free[first:] = np.exp(np.outer(time[: samples - first], np.minimum(poles.real, 0.0) + 1j * poles.imag))
    return np.hstack([free.real, free.imag[:, poles.imag > 0.0]])


def experiment_of(
    record: Record, bandwidth: float | None = None, lead: float | None = None, rigid: bool = False
) -> Experiment:
    """Smooth the displacement, and leave out samples at which the load cell is saturated or the motion uncertain.

    `lead` [s] at the start are not compared; by default none if the table starts from rest, else a tenth. A table that
    turns back at the first sample does not start from rest. The force of a `rigid` device follows its accelerations.

    Raises `IdentificationError` for records that are too long, or of which the stated sensors leave nothing to fit, or
    `RecordError` for uneven ones.
    """
    if record.time.size > MOST_SAMPLES:
        raise IdentificationError(
            f"{record.source!r} has {record.time.size} samples; a fit supports at most {MOST_SAMPLES}. Trim or "
            f"resample the record."
        )
    if np.ptp(record.displacement) == 0.0:
        raise IdentificationError(
            f"The displacement of {record.source!r} is constant, so no parameter is identifiable."
        )
    if np.ptp(record.force) == 0.0:
        raise IdentificationError(f"The force of {record.source!r} is constant, so no parameter is identifiable.")
    _check_sensors(record)
    motion = smooth_displacement(record, bandwidth)
    _check_fixture(record, motion)
    interval, count = record.interval, record.time.size
    try:
        table = _table(motion)
    except InerterError as error:
        raise IdentificationError(f"{record.source!r} cannot be simulated: {error}") from None
    cell = record.force_bandwidth
    follows = rigid and (cell is None or cell * interval > _FILTERED)
    # A sample next to a clipped one may be clipped too.
    kept = np.convolve(saturated_samples(record), np.ones(3), "same") == 0.0
    at_rest = _begins_at_rest(motion)
    wait = (0.0 if at_rest else 0.1 * record.duration) if lead is None else lead
    if not 0.0 <= wait < record.duration:
        part, whole = format_alike([wait, record.duration], "s")
        raise IdentificationError(
            f"lead: the part discarded at the start, {part}, must be non-negative and shorter than the record, {whole}."
        )
    kept[: round(wait / interval)] = False
    ends = 1 if at_rest and wait == 0.0 else 2
    short = min(round(_SHORT * count), (count - _FEWEST) // ends)
    edge = max(min(round(1.0 / (motion.bandwidth * interval)), count // 10), min(_END, short))
    kept[count - edge :] = False
    if ends > 1:
        kept[:edge] = False
    if kept.sum() < _FEWEST:
        raise IdentificationError(
            f"Only {kept.sum()} samples of {record.source!r} can be used; a fit requires at least {_FEWEST}."
        )
    return Experiment(record, motion, kept, table, _noise(record), _information(record.force, kept), follows)


def _check_sensors(record: Record) -> None:
    """Raise `IdentificationError` for a stated bandwidth or noise with which nothing of the record is left to fit."""
    cell = record.force_bandwidth
    if cell is not None and cell * record.interval > _FASTEST_CELL:
        raise IdentificationError(
            f"The samples of {record.source!r} are {format_quantity(record.interval, 's')} apart, at which a load cell "
            f"of {format_quantity(cell, 'Hz')} is too fast to be computed. Check the unit of its times, or leave out "
            "the bandwidth."
        )
    if cell is not None and cell * record.duration < _SLOWEST_CELL:
        raise IdentificationError(
            f"A load cell of {format_quantity(cell, 'Hz')} reads nothing of {record.source!r}, which lasts "
            f"{format_quantity(record.duration, 's')}. Check the unit of the bandwidth."
        )
    for role, noise in (("displacement", record.displacement_noise), ("force", record.force_noise)):
        size = float(np.std(getattr(record, role)))
        if noise is not None and noise > size:
            unit = CHANNELS[role]
            raise IdentificationError(
                f"The noise of the {role} of {record.source!r} is stated as {format_quantity(noise, unit)} r.m.s., "
                f"more than the {role} itself, {format_quantity(size, unit)} r.m.s. Check its unit."
            )


def _check_fixture(record: Record, motion: Motion) -> None:
    """Raise `IdentificationError` for a fixture whose inertia is far more than the load cell reads."""
    inertia = (record.fixture_mass or 0.0) * float(np.std(motion.acceleration))
    size = float(np.std(record.force))
    if inertia > _HEAVIEST * size:
        raise IdentificationError(
            f"A fixture of {format_quantity(record.fixture_mass or 0.0, 'kg')} between load cell and device takes "
            f"{format_quantity(inertia, 'N')} r.m.s. in {record.source!r}, but the load cell reads "
            f"{format_quantity(size, 'N')} r.m.s. Check the unit of the mass."
        )


def _begins_at_rest(motion: Motion) -> bool:
    """Whether neither the velocity nor the acceleration says that the table moved before; at a turning point it did."""
    speed, acceleration = np.abs(motion.velocity), np.abs(motion.acceleration)
    end = min(_END, acceleration.size // 4)
    largest = float(acceleration[end : acceleration.size - end].max())
    turning = max(_TURNING * largest, _CERTAIN * motion.acceleration_noise)
    return bool(speed[0] <= _AT_REST * speed.max() and acceleration[0] <= turning)


def _noise(record: Record) -> float:
    """R.m.s. noise of the force [N]: as stated, or from the quietest half-octave of its spectrum.

    Less where occasional impacts dominate that: sixth differences suppress the force, and their median suppresses rare
    events. Of a force that was read at a lower rate, that of the readings, between which there is hardly any.
    """
    if record.force_noise is not None:
        return record.force_noise
    slower = slower_channel(record.force)
    force, every = (record.force, 1.0) if slower is None else (slower.readings(record.force), slower.every)
    sixth = MAD * float(np.median(np.abs(np.diff(force, 6)))) / math.sqrt(math.comb(12, 6))
    intermittent = max(sixth, resolution(force) / math.sqrt(12.0))
    return max(min(quietest(force, every * record.interval), intermittent), 1e-9)


def _information(force: Matrix, kept: NDArray[np.bool_]) -> Matrix:
    square = np.where(kept, (force - np.median(force[kept])) ** 2, 0.0)
    total = np.cumsum(square)
    return np.asarray(total / total[-1])


def load_cell_output(record: Record) -> str:
    """The output of the rig that the load cell of a record reads."""
    return "device_force" if record.force_bandwidth is None else "reading_force"


def add_encoder_noise(experiment: Experiment, noise: Matrix) -> Experiment:
    """The same experiment with additional encoder noise `noise` (samples,) [m]."""
    return experiment.with_motion(*experiment.motion.smooth(experiment.record.displacement + noise))


def transient_samples(experiment: Experiment, system: PiecewiseSystem, level: float) -> int:
    """Number of samples after which the initial state of the device changes the force by less than `level` [N]."""
    runs = [experiment.run(system, moving=moving) for moving in (False, True)]
    if runs[0] is None or runs[1] is None:
        return 0
    name = load_cell_output(experiment.record)
    differs = np.abs(runs[0][name] - runs[1][name]) > level
    return int(np.flatnonzero(differs)[-1]) + 1 if differs.any() else 0


def steps_per_interval(integration: event_driven.Integration) -> int:
    """Number of steps per interval, so that a fast device is resolved by whole steps.

    Otherwise each interval would be subdivided by the integrator, which takes a hundred times as long.
    """
    return 1 << min(max(math.ceil(math.log2(max(_steps_wanted(integration), 1e-9))), 0), _MOST_PARTS)


def _steps_wanted(integration: event_driven.Integration) -> float:
    kinds = integration.system.nonlinear_elements
    reach = np.inf
    for friction in (0, 1):  # sticks, slips; gaps touch
        states = [friction if e.switches_by(GuardRole.FORCE) and e.acts else 1 for e in kinds]
        try:
            integration.mode(np.array(states, dtype=np.int64))
        except InerterError:
            continue
        reach = min(reach, float(integration.modes.reach[integration.count - 1]))
    return float(integration.table.step / (_PACE * reach))


def _table(motion: Motion) -> InputTable:
    duration = float(motion.time[-1] - motion.time[0])
    return tabulate([_signal(motion)], [0.0], duration, duration / (motion.time.size - 1))


def _knots_per_interval(motion: Motion, rigid: bool = False) -> int:
    """Number of knots per interval, so that cubics between them follow the fastest motion to 1e-5.

    With them, accelerations are off by 8e-3; of a rigid device, with more knots, by 1e-4.
    """
    interval = float(motion.time[-1] - motion.time[0]) / (motion.time.size - 1)
    per_period, most = (_RIGID_KNOTS, _MOST_RIGID_KNOTS) if rigid else (_KNOTS, _MOST_KNOTS)
    return 1 << min(max(math.ceil(math.log2(per_period * motion.highest * interval)), 0), most)


def _signal(motion: Motion, knots: int = 1) -> Signal:
    """The motion as cubics between so many knots per interval."""
    time = motion.time - motion.time[0]
    even = np.linspace(0.0, time[-1], knots * (time.size - 1) + 1)
    if knots > 1 or np.max(np.abs(time - even)) > _ROUNDED * even[1]:  # times that a file rounds, in even steps
        time = even
    height, slope = _between_samples(motion, knots)
    return Signal.sampled(time, height, derivative=slope, label="measured displacement")


def _between_samples(motion: Motion, knots: int) -> tuple[Matrix, Matrix]:
    """Displacement from the first sample on, and velocity, at so many knots per interval."""
    height = motion.displacement - motion.displacement[0]  # where the table stands at the start does not matter
    if knots == 1:
        return height, motion.velocity
    return interpolate(height, float(motion.time[-1] - motion.time[0]) / (motion.time.size - 1), knots)


def _truncate(table: InputTable, segments: int) -> InputTable:
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


def _consistent_velocities(system: PiecewiseSystem, state: Matrix, velocity: Matrix) -> Matrix:
    """The state with velocities at which springs, dampers and gaps keep their length."""
    E_a, E_w, E_z = system.rates
    laws = (LinearRole.STIFFNESS, LinearRole.DAMPING, LinearRole.CLOSED)
    soft = [i for i, b in enumerate(system.graph.branches) if b.element.linear in laws]
    rows = np.hstack([E_a, E_w])[soft]
    solved = np.linalg.lstsq(rows, -E_z[soft] @ velocity, rcond=1e-10)[0]
    with_motion = state.copy()
    with_motion[: E_a.shape[1]] = solved[: E_a.shape[1]]
    return with_motion
