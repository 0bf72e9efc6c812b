"""Further hypotheses on the sensors, the frame and the recorder, some of them suggested by the localised misfit.

A spectral line, a change at an instant and faulty samples are tested where the residual or the record shows them; the
others are tested in any record.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import bilinear, lfilter

from inerter.identification.experiment import Experiment, experiment_of, free_motions, load_cell_output
from inerter.identification.fit import Localisation
from inerter.identification.hypotheses import Hypothesis, Unknown, Values, read_by_load_cell
from inerter.identification.problem import FitProblem
from inerter.identification.statements.causes import Details, Suspect
from inerter.identification.statements.patterns import MisfitPattern
from inerter.records.instants import Instant
from inerter.records.record import CHANNELS, Record
from inerter.records.repair import faulty_instants, without_faulty_samples
from inerter.records.saturation import is_flat
from inerter.records.slower_channels import SlowerChannel, slower_channel
from inerter.records.smoothing import bandwidth_of, noise_of
from inerter.records.spectral_lines import SpectralLine, hum_of_displacement

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
_FASTEST_CLOCK = 0.01  # relative difference of two clocks, at most
_NONLINEAR, _SLIGHT = 0.5, 0.01  # relative change of the gain of a load cell: at most, and starting value
_RESONANCES = (15.0, 40.0, 100.0)  # [Hz] starting values of a frame resonance
_CORNERS, _FASTEST_CORNER = (0.3, 3.0), 300.0  # [rad/s] of high-pass filters: starting values, and the largest
_MARGIN = 10  # samples to either side of repaired ones that are not compared
_SETTLED = 0.3  # [s] after a joint that are not compared, until the transient has decayed
_NOTHING = 1e-5  # of its largest value, below which a change of a parameter is ignored
_FITTED = 0.75  # of a record, after which a change is hardly in the estimation data
_INDEX = (MisfitPattern.COEFFICIENT_STEP, MisfitPattern.BEGINS, MisfitPattern.ENDS, MisfitPattern.LEVEL_STEP)


def recording_faults(problem: FitProblem, places: Sequence[Localisation]) -> Iterator[Hypothesis]:
    """Hypotheses on sensors, frame and recorder that these records and this misfit suggest."""
    peak = max(float(np.abs(e.record.force).max()) for e in problem.experiments)
    stroke = max(0.5 * float(np.ptp(e.motion.displacement)) for e in problem.experiments)
    fastest = max(float(np.abs(e.motion.velocity).max()) for e in problem.experiments)
    yield from nonlinear_load_cells(problem.experiments)
    saturation = _saturation(problem.experiments)
    if saturation is not None:
        yield saturation
    yield _clock(any(h.name is Suspect.DELAY for h in problem.assumed), problem.experiments)
    yield _cross_talk("displacement", "N/m", peak / stroke)
    yield _cross_talk("velocity", "N s/m", peak / fastest)
    yield _frame()
    yield _high_passed_force()
    yield _high_passed_displacement()
    if not any(element.acts for element in problem.rig.device.elements()):
        yield _begun_in_motion(problem)
    for ends in (("upper",), ("lower",), ("upper", "lower")):
        yield _end_stop(ends, stroke, peak)
    for e in problem.experiments:
        yield from _hum_of_displacement(e)
    for e, place in zip(problem.experiments, places, strict=False):
        lines = (f for f in place.patterns if f.kind is MisfitPattern.LINE and f.numbers["foreign"])
        for found in lines:
            yield _hum(e.record, float(found.numbers["frequency"]), float(found.numbers["amplitude"]))
        changes = [float(f.numbers["time"]) for f in place.patterns if f.kind in _INDEX]
        begun = float(e.record.time[0])
        for change in changes[:1]:
            if change - begun < _FITTED * e.record.duration:
                yield _changed_device(problem, e.record, change)


def nonlinear_load_cells(experiments: Sequence[Experiment]) -> list[Hypothesis]:
    """Load cells that read tension and compression with different gains, or with a gain that changes with the load."""
    peak = max(0.5 * float(np.ptp(e.record.force)) for e in experiments)  # without the offset
    kinds: tuple[tuple[Suspect, str, Callable[[Matrix], Matrix]], ...] = (
        (Suspect.ASYMMETRIC_GAIN, "gain in tension over that in compression", np.sign),
        (Suspect.NONLINEAR_GAIN, "gain at the largest force over that near zero", lambda load: (load / peak) ** 2),
    )
    return [_nonlinear_load_cell(*kind) for kind in kinds]


def _nonlinear_load_cell(suspect: Suspect, name: str, change_of_gain: Callable[[Matrix], Matrix]) -> Hypothesis:
    unknown = Unknown(name, "", -_NONLINEAR, _NONLINEAR, _SLIGHT)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        return np.asarray(force * (1.0 + values[name] * change_of_gain(force)))

    return Hypothesis(
        suspect, (unknown,), read=read, details=lambda values: {"share": values[name]}, starts=({name: _SLIGHT},)
    )


def _saturation(experiments: Sequence[Experiment]) -> Hypothesis | None:
    """A force clipped at the extremes at which it is flat, which limits start near; None where it is flat at none."""
    centred = [(e.record.force - float(np.median(e.record.force)), e.noise) for e in experiments]
    extremes = {sign: max(float((sign * force).max()) for force, _ in centred) for sign in (1.0, -1.0)}
    flat = {
        sign: Unknown("upper limit" if sign > 0.0 else "lower limit", "N", 1e-3, 1e6, 1.0)
        for sign, extreme in extremes.items()
        if any(is_flat(sign * force, float((sign * force).max()), noise) for force, noise in centred)
    }
    if not flat:
        return None
    start = {unknown.name: max(0.97 * extremes[sign], 2e-3) for sign, unknown in flat.items()}

    def limit(values: Values, sign: float) -> float:
        return values[flat[sign].name] if sign in flat else math.inf

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        return np.clip(force, -limit(values, -1.0), limit(values, 1.0))

    def details(values: Values) -> Details:
        return {"upper": limit(values, 1.0), "lower": limit(values, -1.0)}

    return Hypothesis(Suspect.SATURATION, tuple(flat.values()), read=read, details=details, starts=(start,))


def _clock(delay_known: bool, experiments: Sequence[Experiment]) -> Hypothesis:
    """A delay that grows with time; its initial value is free too, unless a delay is assumed already."""
    rate, begun = (
        Unknown("clock rate", "", -_FASTEST_CLOCK, _FASTEST_CLOCK, 2e-4),
        Unknown("first delay", "s", -0.02, 0.02, 1e-3),
    )
    duration = max(e.record.duration for e in experiments)

    def change_motion(e: Experiment, values: Values) -> Experiment:
        time = e.motion.time - e.motion.time[0]
        return e.with_delay(values.get(begun.name, 0.0) + values[rate.name] * time)

    def details(values: Values) -> Details:
        return {"rate": values[rate.name], "growth": values[rate.name] * duration}

    unknowns = (rate,) if delay_known else (rate, begun)
    return Hypothesis(Suspect.CLOCK_DRIFT, unknowns, change_motion=change_motion, details=details)


def _cross_talk(signal: str, unit: str, size: float) -> Hypothesis:
    """Cross-talk of displacement or velocity into the force."""
    unknown = Unknown(f"cross-talk of the {signal}", unit, -10.0 * size, 10.0 * size, 0.05 * size)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        reading = getattr(e.motion, signal)[: force.size]
        return np.asarray(force + values[unknown.name] * read_by_load_cell(reading, e))

    def details(values: Values) -> Details:
        return {"signal": signal, "unit": unit, "size": values[unknown.name]}

    return Hypothesis(Suspect.CROSS_TALK, (unknown,), read=read, details=details)


def _frame() -> Hypothesis:
    """A load cell on a resonant frame: the force times the response of a mass on a spring."""
    frequency, ratio = Unknown("frame frequency", "Hz", 3.0, 1e4, 1.0), Unknown("frame damping", "", 1e-3, 2.0, 0.05)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        rate = 1.0 / e.record.interval
        if values[frequency.name] >= 0.45 * rate:
            return force
        w = 2.0 * rate * math.tan(math.pi * values[frequency.name] / rate)
        b, a = bilinear([w**2], [1.0, 2.0 * values[ratio.name] * w, w**2], rate)
        return np.asarray(lfilter(b, a, force - force[0]) + force[0])

    def details(values: Values) -> Details:
        return {"frequency": values[frequency.name], "ratio": values[ratio.name]}

    starts = tuple({frequency.name: f, ratio.name: 0.05} for f in _RESONANCES)
    return Hypothesis(Suspect.FRAME, (frequency, ratio), read=read, details=details, starts=starts)


def _begun_in_motion(problem: FitProblem) -> Hypothesis:
    """Records that look as if they began at rest, and a linear device that moved before: its free motions are added."""
    space, bare = problem.space, replace(problem, assumed=(), systems={})
    least = dict(zip(space.names, space.lower.tolist(), strict=True))

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        system = bare.system(space.coordinates_of({n: values.get(n, least[n]) for n in space.names}), e.record)
        if not e.kept[0] or system is None:
            return force
        free = free_motions(replace(e, kept=np.arange(e.size) > 0), system, force.size)
        used = e.kept[: force.size] & (np.arange(force.size) > 0)
        columns = np.column_stack([free, np.ones(force.size)])[used]
        amplitudes = np.linalg.lstsq(columns, (e.record.force[: force.size] - force)[used], rcond=1e-10)[0]
        return np.concatenate([e.record.force[:1], (force + free @ amplitudes[:-1])[1:]])

    return Hypothesis(Suspect.IN_MOTION, read=read)


def _high_passed_force() -> Hypothesis:
    """A force without its slow part: that of a charge amplifier, or of AC coupling."""
    rate = Unknown("high-pass of the force", "rad/s", 0.0, _FASTEST_CORNER, 0.1)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        b, a = bilinear([1.0, 0.0], [1.0, values[rate.name]], 1.0 / e.record.interval)
        return np.asarray(lfilter(b, a, force))

    starts = tuple({rate.name: corner} for corner in _CORNERS)
    return Hypothesis(
        Suspect.HIGH_PASSED_FORCE, (rate,), read=read, details=lambda values: {"rate": values[rate.name]}, starts=starts
    )


def _high_passed_displacement() -> Hypothesis:
    """A displacement without its slow part, as of AC coupling or integrated accelerations, to which it is added."""
    rate = Unknown("high-pass of the displacement", "rad/s", 0.0, _FASTEST_CORNER, 0.1)

    def change_motion(e: Experiment, values: Values) -> Experiment:
        motion = e.motion
        slow = values[rate.name] * (motion.displacement - motion.displacement.mean())
        lost = np.cumsum(slow) * e.record.interval
        return e.with_motion(motion.displacement + lost, motion.velocity + slow)

    return Hypothesis(
        Suspect.HIGH_PASSED_DISPLACEMENT,
        (rate,),
        change_motion=change_motion,
        details=lambda values: {"rate": values[rate.name]},
        starts=tuple({rate.name: corner} for corner in _CORNERS),
    )


def _end_stop(ends: tuple[str, ...], stroke: float, peak: float) -> Hypothesis:
    """Springs in parallel with the device that it touches within the same distance of these ends of the motion."""
    depth = Unknown(f"reach of the {' and '.join(ends)} stop", "m", 0.0, stroke, 0.1 * stroke)
    stiffness = Unknown("stiffness of the stop", "N/m", 0.0, 1e3 * peak / stroke, 0.1 * peak / stroke)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        z, reach = e.motion.displacement, values[depth.name]
        above = np.maximum(z - z[e.kept].max() + reach, 0.0) if "upper" in ends else 0.0 * z
        below = np.maximum(z[e.kept].min() + reach - z, 0.0) if "lower" in ends else 0.0 * z
        stop = values[stiffness.name] * (above - below)[: force.size]
        return np.asarray(force + read_by_load_cell(stop, e))

    def details(values: Values) -> Details:
        return {"ends": ends, "reach": values[depth.name], "stiffness": values[stiffness.name]}

    start = {depth.name: 0.15 * stroke, stiffness.name: peak / stroke}
    return Hypothesis(Suspect.END_STOP, (depth, stiffness), read=read, details=details, starts=(start,))


def _hum(record: Record, frequency: float, amplitude: float) -> Hypothesis:
    """A sine in the force of one record, near a line of the residual."""
    width = 1.0 / record.duration
    names = ("hum, cosine", "hum, sine", "hum, frequency")
    unknowns = (
        Unknown(names[0], "N", -20.0 * amplitude, 20.0 * amplitude, 0.2 * amplitude),
        Unknown(names[1], "N", -20.0 * amplitude, 20.0 * amplitude, 0.2 * amplitude),
        Unknown(names[2], "Hz", -2.0 * width, 2.0 * width, 0.2 * width),
    )

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        if e.record is not record:
            return force
        time = record.time[: force.size] - record.time.mean()
        phase = 2.0 * math.pi * (frequency + values[names[2]]) * time
        return np.asarray(force + values[names[0]] * np.cos(phase) + values[names[1]] * np.sin(phase))

    def details(values: Values) -> Details:
        size = math.hypot(values[names[0]], values[names[1]])
        return _hum_details(record, "force", SpectralLine(frequency + values[names[2]], size))

    starts = tuple({names[i]: s * amplitude} for i in (0, 1) for s in (1.0, -1.0))
    return Hypothesis(Suspect.HUM, unknowns, read=read, details=details, starts=starts)


def _hum_details(record: Record, channel: str, line: SpectralLine) -> Details:
    return {**vars(line), "channel": channel, "unit": CHANNELS[channel], "rate": 1.0 / record.interval}


def _hum_of_displacement(e: Experiment) -> Iterator[Hypothesis]:
    """The displacement of one record without a sine of the mains that the force does not follow."""
    record, found = e.record, hum_of_displacement(e.record)
    if found is None:
        return
    line, course = found
    bandwidth = e.motion.bandwidth if e.motion.asked else None
    mended = experiment_of(record.with_notes(displacement=record.displacement - course), bandwidth, rigid=e.rigid)
    whole = replace(mended, record=record, kept=e.kept, tally=e.tally)
    yield Hypothesis(
        Suspect.HUM,
        change_motion=lambda other, values: whole if other.record is record else other,
        details=lambda values: _hum_details(record, "displacement", line),
    )


def _changed_device(problem: FitProblem, record: Record, time: float) -> Hypothesis:
    """A device whose values change at one instant of a record."""
    space = problem.space
    later = {
        name: f"{name} afterwards" for name, kind in zip(space.names, space.kinds, strict=True) if kind is not None
    }
    bounds = {n: (float(a), float(b)) for n, a, b in zip(space.names, space.lower, space.upper, strict=True)}
    units = dict(zip(space.names, space.units, strict=True))
    unknowns = tuple(Unknown(later[n], units[n], *bounds[n], 0.1 * bounds[n][1]) for n in later)
    bare = replace(problem, assumed=(), systems={})

    def force_with(e: Experiment, values: Values, size: int) -> Matrix | None:
        known = {n: values.get(n, bounds[n][0]) for n in space.names}
        system = bare.system(space.coordinates_of(known), e.record)
        run = None if system is None else e.run(system, size)
        return None if run is None else run[load_cell_output(e.record)]

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        if e.record is not record:
            return force
        before = force_with(e, values, force.size)
        after = force_with(e, {**values, **{n: values[other] for n, other in later.items()}}, force.size)
        if before is None or after is None:
            return force
        return np.asarray(force + np.where(e.record.time[: force.size] >= time, after - before, 0.0))

    def details(values: Values) -> Details:
        pairs = [(n, units[n], values[n], values[other]) for n, other in later.items()]
        shown = (p for p in pairs if abs(p[3] - p[2]) > max(0.01 * abs(p[2]), _NOTHING * bounds[p[0]][1]))
        return {"time": time, "values": tuple(shown)}

    return Hypothesis(Suspect.CHANGED_DEVICE, unknowns, read=read, details=details, counterparts=later)


def faulty_samples(experiments: Sequence[Experiment]) -> list[Hypothesis]:
    """Readings alone; spikes and held values, interpolated; and joints, closed and not compared for a while."""
    found = [(e, faulty_instants(e.record)) for e in experiments]
    slower = _at_readings(experiments)
    rows = [] if slower is None else [slower]
    kinds = ((Suspect.SPIKES, "spikes"), (Suspect.HELD, "held"))
    for name, kind in kinds:
        marked = {id(e.record): [i for role in getattr(f, kind).values() for i in role] for e, f in found}
        if any(marked.values()):
            rows.append(_repair_hypothesis(name, experiments, marked, without_faulty_samples, _MARGIN))
    joints = {id(e.record): f.joints for e, f in found}
    if any(joints.values()):
        rows.append(
            _repair_hypothesis(Suspect.JOINED, experiments, joints, lambda r: _close_joints(r, joints[id(r)]), None)
        )
    return rows


def _at_readings(experiments: Sequence[Experiment]) -> Hypothesis | None:
    """Channels that were read at a lower rate, between whose readings nothing is compared; None without such a channel.

    A spline goes through the readings of the displacement, and is smoothed to what they show: of the readings alone a
    noise floor can be told.
    """
    whole: dict[int, Experiment] = {}
    read_at: dict[int, SlowerChannel] = {}
    channels: list[tuple[str, float, str]] = []
    for e in experiments:
        record = e.record
        moved, forced = slower_channel(record.displacement), slower_channel(record.force)
        channels += [(n, s.every, s.way) for n, s in (("displacement", moved), ("force", forced)) if s is not None]
        if moved is not None:
            at, readings = moved.positions(e.size), moved.readings(record.displacement)
            through = CubicSpline(at, readings)(np.clip(np.arange(e.size), at[0], at[-1]))
            every = moved.every * record.interval
            bandwidth = e.motion.bandwidth if e.motion.asked else bandwidth_of(noise_of(readings, every), every)
            mended = experiment_of(record.with_notes(displacement=through), bandwidth, rigid=e.rigid)
            whole[id(record)] = replace(mended, record=record, kept=e.kept, tally=e.tally)
        if forced is not None:
            read_at[id(record)] = forced

    def change_motion(e: Experiment, values: Values) -> Experiment:
        return whole.get(id(e.record), e)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        channel = read_at.get(id(e.record))
        if channel is None:
            return force
        at = channel.positions(force.size)
        mask = np.zeros(force.size, dtype=bool)
        mask[np.minimum(np.ceil(at - 1e-3).astype(int), force.size - 1)] = True
        given = channel.record_readings(np.interp(at, np.arange(force.size), force), force.size)
        return as_measured(given, e.record.force, ~mask)

    named = {"channels": tuple(dict.fromkeys(channels))}
    hypothesis = Hypothesis(Suspect.SLOWER, change_motion=change_motion, read=read, details=lambda values: named)
    return hypothesis if channels else None


def as_measured(force: Matrix, measured: Matrix, doubtful: Mask) -> Matrix:
    """The force with the measured one, less the offset of the load cell at all others, at samples not to compare."""
    left = measured[: force.size] - force
    offset = float(np.mean(left[~doubtful])) if not doubtful.all() else 0.0
    return np.where(doubtful, force + left - offset, force)


def _repair_hypothesis(
    name: Suspect,
    experiments: Sequence[Experiment],
    marked: dict[int, list[Instant]],
    mend: Callable[[Record], Record],
    margin: int | None,
) -> Hypothesis:
    """Records with faulty samples repaired, near which no samples are compared."""
    whole: dict[int, Experiment] = {}
    doubtful: dict[int, Mask] = {}
    places = []
    for e in experiments:
        instants = marked[id(e.record)]
        if not instants:
            continue
        size, after = e.size, round(_SETTLED / e.record.interval) if margin is None else margin
        mask = np.zeros(size, dtype=bool)
        for i in instants:
            mask[max(i.start - (margin or _MARGIN), 0) : i.stop + after] = True
            places.append(float(e.record.time[i.start]))
        mended = mend(e.record)
        whole[id(e.record)] = replace(experiment_of(mended, rigid=e.rigid), record=e.record, kept=e.kept, tally=e.tally)
        doubtful[id(e.record)] = mask

    def change_motion(e: Experiment, values: Values) -> Experiment:
        return whole.get(id(e.record), e)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        mask = doubtful.get(id(e.record))
        return force if mask is None else as_measured(force, e.record.force, mask[: force.size])

    details = {"times": tuple(places[:6]), "count": len(places)}
    return Hypothesis(name, change_motion=change_motion, read=read, details=lambda values: details)


def _close_joints(record: Record, joints: Sequence[Instant]) -> Record:
    """The record with the jumps of its displacement removed."""
    jumps = np.zeros(record.time.size)
    for joint in joints:
        jump = record.displacement[joint.start + 1] - record.displacement[joint.start]
        usual = 0.5 * (
            record.displacement[joint.start]
            - record.displacement[joint.start - 1]
            + record.displacement[joint.start + 2]
            - record.displacement[joint.start + 1]
        )
        jumps[joint.start + 1 :] += jump - usual
    return record.with_notes(displacement=record.displacement - jumps)
