"""Inspection of a record before a model is fitted to it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

from inerter.records import polarity_delay
from inerter.records.apparent_mass import ratio_lines
from inerter.records.clocks import clock_drift, jitter
from inerter.records.dropouts import find_dropouts
from inerter.records.finding import Finding
from inerter.records.finding_texts import COARSE, LARGE, RecordFinding
from inerter.records.instants import Instant
from inerter.records.record import UNIFORM, Record
from inerter.records.repair import faulty_instants, without_faulty_samples
from inerter.records.saturation import plateaus, saturated_samples
from inerter.records.slower_channels import at_readings, slower_channel
from inerter.records.smoothing import Motion, resolution, smooth_displacement
from inerter.records.spectral_lines import HUM, hum_of_displacement, isolated_line
from inerter.statements import Severity, by_severity

Vector = NDArray[np.float64]
FEW = 100  # samples, below which little can be fitted
_FOLDED = 0.8  # of half the sampling rate: motion up to there may go on beyond
_FASTEST = 1e4  # m/s^2 r.m.s., above which times are more often in a wrong unit
_INERTANCE, _LEAST = 1e3, 1e-3  # kg that give less than this share of the force: the same, of too slow a motion
_CERTAIN, _SAME_SCALE = 0.03, 0.05  # rad, of the phase of a line; relative difference of two scales
_READ = 1e-15, 1e15  # in SI units: sizes of what any sensor reads, of which powers are still numbers
PLAUSIBLE = {"displacement": 1.0, "force": 1e6}  # in SI units; more is more often a wrong unit than a large rig


def findings(record: Record) -> list[Finding]:
    """Findings of a record, the most severe first.

    Inspects the sampling and its clock, samples that were dropped, held or replaced by spikes, channels that were
    measured at a lower rate, joints between pieces, the amplitude, noise, resolution, clipping, offset and drift of the
    channels, swapped columns, mains hum and other spectral lines, the sign of the force and its delay.
    """
    found = extreme_sizes(record) or [
        *_count(record),
        *_sampling(record),
        *_dropouts(record),
        *_filled_samples(record),
        *_constant(record),
        *_implausible_sizes(record),
    ]
    if Severity.ERROR not in by_severity(found):
        read = at_readings(record)  # between its readings a slower channel has plateaus and steps of its own
        found += [*_saturation(read), *_steps(record), *_offsets(record), *_drift(record), *_instants(record, read)]
        if record.uniform:
            found += _slower_channels(record)
            found += _motion_findings(read, smooth_displacement(read))
    return [finding for group in by_severity(found).values() for finding in group]


def questionable_units(record: Record) -> list[Finding]:
    """Findings of sizes, and of an even record in motion of other quantities, that wrong units or columns explain."""
    found = _implausible_sizes(record)
    if record.uniform and not _constant(record):
        motion = smooth_displacement(record)
        found += [*_time_scale(record, motion), *inconsistent_scales(record, motion), *_swapped_columns(record)]
    return found


def _motion_findings(record: Record, motion: Motion) -> list[Finding]:
    names = ("bandwidth", "highest", "noise", "attenuation", "velocity_noise", "acceleration_noise", "asked")
    return [
        *_time_scale(record, motion),
        *inconsistent_scales(record, motion),
        *_undersampling(record, motion),
        *_swapped_columns(record),
        *(_hum(record, motion) or _line(record, motion)),
        *_hum_of_displacement(record),
        *_clock(record, motion),
        *polarity_delay.polarity_finding(record, motion),
        *polarity_delay.delay_finding(record, motion),
        Finding(RecordFinding.BANDWIDTH, Severity.INFO, numbers={name: getattr(motion, name) for name in names}),
    ]


def _undersampling(record: Record, motion: Motion) -> list[Finding]:
    """Motion close to half the sampling rate, above which further motion may be aliased."""
    limit = 0.5 / record.interval
    if motion.highest < _FOLDED * limit:
        return []
    return [
        Finding(
            RecordFinding.UNDERSAMPLED, Severity.WARNING, "displacement", {"highest": motion.highest, "limit": limit}
        )
    ]


def _count(record: Record) -> list[Finding]:
    if record.time.size >= FEW:
        return []
    return [Finding(RecordFinding.FEW_SAMPLES, Severity.WARNING, numbers={"samples": float(record.time.size)})]


def _sampling(record: Record) -> list[Finding]:
    steps = np.diff(record.time)
    usual = float(np.median(steps))
    numbers = {"interval": usual, "samples": float(record.time.size), "duration": record.duration}
    if record.uniform:
        return [Finding(RecordFinding.SAMPLING, Severity.INFO, numbers={**numbers, "even": True})]
    gaps = steps > 1.5 * usual
    result = []
    if gaps.any():
        lost = int(np.sum(np.round(steps[gaps] / usual) - 1))
        numbers |= {"gaps": float(gaps.sum()), "lost": float(lost), "longest": float(steps.max())}
        first = {"first": float(record.time[int(np.argmax(gaps))])}
        result.append(Finding(RecordFinding.GAPS, Severity.WARNING, numbers={**numbers, **first}))
    jitter = float(np.std(steps[~gaps])) / usual
    if jitter > UNIFORM:
        scatter = {"jitter": jitter, "step": resolution(record.time)}
        result.append(Finding(RecordFinding.JITTER, Severity.WARNING, numbers={**numbers, **scatter}))
    return result or [Finding(RecordFinding.SAMPLING, Severity.INFO, numbers={**numbers, "even": False})]


def _dropouts(record: Record) -> list[Finding]:
    lost = find_dropouts(record)
    if not lost:
        return []
    count, at = sum(loss.count for loss in lost), float(record.time[lost[0].after])
    numbers = {"places": float(len(lost)), "samples": float(count), "first": at}
    return [Finding(RecordFinding.LOST_SAMPLES, Severity.WARNING, "displacement", numbers)]


def _instants(record: Record, read: Record) -> list[Finding]:
    """Spikes, held values and joints, each kind with the channel that shows it: a slower one in its readings alone."""
    result = []
    of_read = faulty_instants(read)
    for role in ("displacement", "force"):
        is_read = read is record or slower_channel(getattr(record, role)) is not None
        seen, faulty = (read, of_read) if is_read else (record, faulty_instants(record))
        kinds = {RecordFinding.SPIKES: faulty.spikes[role], RecordFinding.HELD: faulty.held[role]}
        if role == "displacement":
            kinds[RecordFinding.JOINED] = faulty.joints
        result += [
            Finding(kind, Severity.WARNING, role, _instant_summary(seen, instants))
            for kind, instants in kinds.items()
            if instants
        ]
    return result


def _instant_summary(record: Record, instants: list[Instant]) -> dict[str, float]:
    return {
        "places": float(len(instants)),
        "samples": float(sum(i.stop - i.start for i in instants)),
        "longest": float(max(i.stop - i.start for i in instants)),
        "first": float(record.time[instants[0].start]),
        "largest": max((i.size for i in instants), key=abs),
    }


def _slower_channels(record: Record) -> list[Finding]:
    """Channels that were read at a lower rate than that of the record."""
    slower = {role: slower_channel(getattr(record, role)) for role in ("displacement", "force")}
    return [
        Finding(RecordFinding.SLOWER, Severity.WARNING, role, {"every": found.every, "way": found.way})
        for role, found in slower.items()
        if found is not None
    ]


def _filled_samples(record: Record) -> list[Finding]:
    result = []
    for role, (count, longest) in record.meta.get("filled", {}).items():
        numbers = {"samples": float(count), "longest": float(longest)}
        result.append(Finding(RecordFinding.FILLED, Severity.WARNING, role, numbers))
    if record.meta.get("cut"):
        result.append(Finding(RecordFinding.CUT, Severity.WARNING))
    return result


def _constant(record: Record) -> list[Finding]:
    result = []
    for role in ("displacement", "force"):
        values = getattr(record, role)
        if np.ptp(values) <= 1e-12 * np.max(np.abs(values)):
            result.append(Finding(RecordFinding.CONSTANT, Severity.ERROR, role, {"value": float(values[0])}))
    return result


def extreme_sizes(record: Record) -> list[Finding]:
    """Findings of channels of a size that no sensor reads, to which no model can be fitted."""
    result = []
    for role, values in record.channels().items():
        size = float(np.max(np.abs(values)))
        if size <= _READ[1]:
            size = record.interval if role == "time" else 0.5 * float(np.ptp(values))
        if size > 0.0 and not _READ[0] <= size <= _READ[1]:
            result.append(Finding(RecordFinding.EXTREME, Severity.ERROR, role, {"size": size}))
    return result


def _implausible_sizes(record: Record) -> list[Finding]:
    result = []
    for role, most in PLAUSIBLE.items():
        size = 0.5 * float(np.ptp(getattr(record, role)))
        if size > most:
            result.append(Finding(RecordFinding.IMPLAUSIBLE, Severity.WARNING, role, {"amplitude": size}))
    return result


def _time_scale(record: Record, motion: Motion) -> list[Finding]:
    """Accelerations that a wrong unit of the times explains better than a test of an inertance."""
    acceleration = float(np.std(motion.acceleration))
    slow = _INERTANCE * acceleration < _LEAST * float(np.std(record.force))
    if not slow and acceleration <= _FASTEST:
        return []
    numbers = {
        "interval": record.interval,
        "samples": float(record.time.size),
        "duration": record.duration,
        "acceleration": acceleration,
        "inertial": _INERTANCE * acceleration if slow else None,
    }
    return [Finding(RecordFinding.TIME_SCALE, Severity.WARNING, "time", numbers)]


def inconsistent_scales(record: Record, motion: Motion) -> list[Finding]:
    """Measured velocities and accelerations that are not as large as the derivatives of the displacement.

    Lines of the spectrum count whose phase is certain: their coherence is so high that noise changes no ratio by as
    much as that.
    """
    result = []
    for role in ("velocity", "acceleration"):
        measured = getattr(record, role)
        if measured is None:
            continue
        within = min(motion.highest, 0.5 * motion.bandwidth)  # where smoothing takes nothing away
        found = ratio_lines(getattr(motion, role), measured, record.interval, highest=within)
        ratio = found.ratio[found.phase_error < _CERTAIN]
        if not ratio.size:
            continue
        factor = math.copysign(float(np.median(np.abs(ratio))), float(np.median(ratio.real)))
        if abs(math.log(abs(factor))) > _SAME_SCALE or factor < 0.0:
            result.append(Finding(RecordFinding.SCALES, Severity.WARNING, role, {"factor": factor}))
    return result


def _saturation(record: Record) -> list[Finding]:
    """The force at a known limit, or flat at its extremes for longer than its motion explains."""
    share = float(np.mean(saturated_samples(record)))
    if share == 0.0:
        return []
    if record.force_range is not None:
        where: dict[str, object] = {"limit": record.force_range}
    else:
        where = {"extremes": [(plateau.value, plateau.longest) for plateau in plateaus(record)]}
    return [Finding(RecordFinding.SATURATION, Severity.WARNING, "force", {"share": share, **where})]


def _steps(record: Record) -> list[Finding]:
    result = []
    for role in ("displacement", "force"):
        values = getattr(record, role)
        step = resolution(values)
        if step == 0.0:
            continue
        levels = float(np.ptp(values)) / step
        kind = RecordFinding[f"{role}_steps".upper()]
        severity = Severity.WARNING if levels < COARSE else Severity.INFO
        result.append(Finding(kind, severity, role, {"step": step, "levels": levels}))
    return result


def _offsets(record: Record) -> list[Finding]:
    result = []
    for role in ("displacement", "force"):
        values = getattr(record, role)
        offset, size = float(np.mean(values)), 0.5 * float(np.ptp(values))
        severity = Severity.WARNING if abs(offset) > LARGE * size else Severity.INFO
        numbers = {"mean": offset, "amplitude": size}
        result.append(Finding(RecordFinding[f"{role}_offset".upper()], severity, role, numbers))
    return result


def _drift(record: Record) -> list[Finding]:
    """Slow change of both the median and the middle of the range, from the first quarter to the last."""
    result = []
    quarter = record.time.size // 4
    for role in ("displacement", "force"):
        values = getattr(record, role)
        turns = int(np.count_nonzero(np.diff(np.sign(values - np.mean(values)))))
        if quarter < 4 or turns < 8:
            continue  # too few periods to separate drift from motion
        first, last = values[:quarter], values[-quarter:]
        changes = (
            float(np.median(last) - np.median(first)),
            float(_median_and_midrange(last) - _median_and_midrange(first)),
        )
        change, size = min(changes, key=abs), float(np.ptp(values))
        if changes[0] * changes[1] > 0.0 and abs(change) > 0.1 * size:
            numbers = {"change": change, "range": size}
            result.append(Finding(RecordFinding[f"{role}_drift".upper()], Severity.WARNING, role, numbers))
    return result


def _median_and_midrange(values: Vector) -> float:
    return 0.5 * float(np.max(values) + np.min(values))


def _swapped_columns(record: Record) -> list[Finding]:
    """A displacement is smoother than the force that it causes; the other way round the columns may be swapped."""
    if _columns_that_look_swapped(record):
        rough = _columns_that_look_swapped(without_faulty_samples(record))  # spikes are rough too
        return [Finding(RecordFinding.SWAPPED, Severity.WARNING, numbers=rough)] if rough else []
    return []


def _columns_that_look_swapped(record: Record) -> dict[str, float]:
    """Roughness of both channels where that of the displacement is far larger; else empty."""
    rough = {role: _roughness(getattr(record, role)) for role in ("displacement", "force")}
    return rough if rough["displacement"] >= max(10.0 * rough["force"], 1e-3) else {}


def _roughness(values: Vector) -> float:
    """R.m.s. of second differences, over the standard deviation."""
    return float(np.std(np.diff(values, 2)) / np.std(values)) if values.size > 4 else 0.0


def _hum(record: Record, motion: Motion) -> list[Finding]:
    """Mains hum: lines in the force that exceed all neighbouring lines, where the displacement has none.

    Friction answers one frequency with its odd multiples, so a multiple of a motion above 4 Hz is not taken for hum.
    """
    rate = 1.0 / record.interval
    if record.duration < 1.0 or min(HUM) > 0.45 * rate:
        return []
    size = min(record.time.size, round(10.0 * rate))
    frequency, density = welch(record.force - np.mean(record.force), rate, nperseg=size)
    _, moving = welch(motion.displacement - np.mean(motion.displacement), rate, nperseg=size)
    main = float(frequency[int(np.argmax(moving))])
    width = 1.0 + 2.0 * float(frequency[1])
    for mains in HUM:
        multiple = main > 4.0 and abs(mains - round(mains / main) * main) < width
        if mains > 0.45 * rate or motion.highest > 0.8 * mains or multiple:
            continue
        line = np.abs(frequency - mains) <= width
        nearby = (np.abs(frequency - mains) > 2.0 * width) & (np.abs(frequency - mains) <= 0.2 * mains)
        amplitude = math.sqrt(2.0 * float(np.sum(density[line])) * float(frequency[1]))
        exceeds = float(np.max(density[line])) > 4.0 * float(np.max(density[nearby]))
        if exceeds and amplitude > 1e-3 * float(np.std(record.force)):
            numbers = {"frequency": mains, "amplitude": amplitude}
            return [Finding(RecordFinding.HUM, Severity.WARNING, "force", numbers)]
    return []


def _hum_of_displacement(record: Record) -> list[Finding]:
    """Mains hum in the displacement, which the force of a device would follow if it were a motion."""
    found = hum_of_displacement(record)
    if found is None:
        return []
    numbers = {"frequency": found[0].frequency, "amplitude": found[0].amplitude}
    return [Finding(RecordFinding.HUM, Severity.WARNING, "displacement", numbers)]


def _line(record: Record, motion: Motion) -> list[Finding]:
    """An isolated line at any other frequency."""
    line = isolated_line(record, motion)
    if line is None:
        return []
    numbers = {"frequency": line.frequency, "amplitude": line.amplitude, "rate": 1.0 / record.interval}
    return [Finding(RecordFinding.LINE, Severity.WARNING, "force", numbers)]


def _clock(record: Record, motion: Motion) -> list[Finding]:
    result = []
    scatter = jitter(record, motion)
    if scatter is not None:
        numbers = {"jitter": scatter, "interval": record.interval}
        result.append(Finding(RecordFinding.HIDDEN_JITTER, Severity.WARNING, "displacement", numbers))
    drift = clock_drift(record, motion)
    if drift is not None:
        numbers = {"growth": drift.growth, "standard_error": drift.error, "rate": drift.rate}
        result.append(Finding(RecordFinding.CLOCK_DRIFT, Severity.WARNING, numbers=numbers))
    return result
