"""Looking a record over, before anything is fitted to it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

from inerter.records import signs
from inerter.records.finding import Finding
from inerter.records.gaps import runs
from inerter.records.lost import losses
from inerter.records.record import CHANNELS, UNIFORM, Record
from inerter.records.smoothing import Motion, resolution, smooth_displacement

Vector = NDArray[np.float64]
FEW = 100  # samples, below which little can be fitted
FLAT = 3  # samples in a row at the extreme value that look like a limit
HUM = (50.0, 60.0)  # Hz of the mains
PLAUSIBLE = {"displacement": 1.0, "force": 1e6}  # in SI units; more is more often a wrong unit than a large rig


def findings(record: Record) -> list[Finding]:
    """What is worth knowing about a record, the gravest first.

    Looks at the sampling, samples that were lost, the size, noise, steps, limits, offset and drift of the channels,
    swapped columns, hum of the mains, the sign of the force and its delay.
    """
    found = [*_count(record), *_sampling(record), *_lost(record), *_filled(record), *_constant(record), *_sizes(record)]
    if not any(finding.severity == "error" for finding in found):
        found += [*_saturation(record), *_steps(record), *_offsets(record), *_drift(record)]
        if record.uniform:
            found += _of_motion(record, smooth_displacement(record))
    order = ("error", "warning", "info")
    return sorted(found, key=lambda finding: order.index(finding.severity))


def _of_motion(record: Record, motion: Motion) -> list[Finding]:
    noise = {"bandwidth": motion.bandwidth, "highest": motion.highest, "noise": motion.noise}
    return [
        *_swapped(record),
        *_hum(record, motion),
        *signs.sign(record, motion),
        *signs.delay(record, motion),
        Finding("bandwidth", "info", motion.sentence, noise),
    ]


def _count(record: Record) -> list[Finding]:
    if record.time.size >= FEW:
        return []
    said = f"There are only {record.time.size} samples; a fit needs hundreds, over several periods of the motion."
    return [Finding("few-samples", "warning", said, {"samples": float(record.time.size)})]


def _sampling(record: Record) -> list[Finding]:
    steps = np.diff(record.time)
    usual = float(np.median(steps))
    numbers = {"interval": usual, "samples": float(record.time.size), "duration": record.duration}
    said = f"{record.time.size} samples over {record.duration:.6g} s, every {usual:.6g} s ({1.0 / usual:.6g} Hz)"
    if record.uniform:
        return [Finding("sampling", "info", f"{said}, evenly spaced.", numbers)]
    gaps = steps > 1.5 * usual
    result = []
    if gaps.any():
        lost = int(np.sum(np.round(steps[gaps] / usual) - 1))
        numbers |= {"gaps": float(gaps.sum()), "lost": float(lost), "longest": float(steps.max())}
        at = float(record.time[int(np.argmax(gaps))])
        said_of_gaps = (
            f"{said}, with {int(gaps.sum())} gaps of up to {steps.max():.4g} s, the first at {at:.6g} s: about {lost} "
            f"samples are lost. Use fill_gaps(record, longest) for short ones, trim for long ones."
        )
        result.append(Finding("gaps", "warning", said_of_gaps, dict(numbers)))
    jitter = float(np.std(steps[~gaps])) / usual
    if jitter > UNIFORM:
        step = resolution(record.time)
        rounded = f" The times are written in steps of {step:.3g} s." if step > 0.0 else ""
        said_of_jitter = (
            f"{said}, but unevenly: the intervals scatter by {100.0 * jitter:.3g} %.{rounded} If the clock was even, "
            f"read the file with interval={usual:.6g}; else use resample(record)."
        )
        result.append(Finding("jitter", "warning", said_of_jitter, {**numbers, "jitter": jitter}))
    return result or [Finding("sampling", "info", f"{said}, not quite evenly spaced.", numbers)]


def _lost(record: Record) -> list[Finding]:
    lost = losses(record)
    if not lost:
        return []
    count, at = sum(loss.count for loss in lost), float(record.time[lost[0].after])
    said = (
        f"The displacement leaps along itself at {len(lost)} places, the first at {at:.4g} s: about {count} samples "
        f"are lost while the clock goes on. Read the file with gaps='fill', which puts them in."
    )
    return [Finding("lost-samples", "warning", said, {"places": float(len(lost)), "samples": float(count)})]


def _filled(record: Record) -> list[Finding]:
    result = []
    for role, (count, longest) in record.meta.get("filled", {}).items():
        said = f"Samples of the {role} that were missing and interpolated: {count}, up to {longest} in a row."
        result.append(Finding("filled", "warning", said, {"samples": float(count), "longest": float(longest)}))
    if record.meta.get("cut"):
        result.append(Finding("cut", "warning", "The file was cut short; its last samples are missing."))
    return result


def _constant(record: Record) -> list[Finding]:
    result = []
    for role in ("displacement", "force"):
        values = getattr(record, role)
        if np.ptp(values) <= 1e-12 * np.max(np.abs(values)):
            said = (
                f"The {role} is constant, {values[0]:.6g} {CHANNELS[role]}, so nothing can be fitted. Was the sensor "
                f"connected, and is it the right channel?"
            )
            result.append(Finding("constant", "error", said, {"value": float(values[0])}))
    return result


def _sizes(record: Record) -> list[Finding]:
    result = []
    for role, most in PLAUSIBLE.items():
        size = 0.5 * float(np.ptp(getattr(record, role)))
        if size > most:
            said = f"The {role} has an amplitude of {size:.4g} {CHANNELS[role]}, hard to believe. Is its unit right?"
            result.append(Finding("implausible", "warning", said, {"amplitude": size}))
    return result


def _saturation(record: Record) -> list[Finding]:
    """The force at a known limit, or flat at its extremes for longer than its motion explains."""
    force, limit = record.force, record.force_range
    step = resolution(force)
    if limit is not None:
        at = np.abs(force) >= limit - max(0.5 * step, 1e-6 * limit)
        share = float(np.mean(at))
        if share > 0.0:
            said = (
                f"The load cell is at its limit of {limit:.6g} N for {100.0 * share:.2g} % of the samples: {_LIMITED}"
            )
            return [Finding("saturation", "warning", said, {"share": share, "limit": limit})]
        return []
    flat = []
    for value in (float(np.max(force)), float(np.min(force))):
        near = np.abs(force - value) <= 1e-9 * abs(value)
        longest = max(stop - start for start, stop in runs(near))
        if longest >= FLAT and longest > 2.0 * _expected_at_turn(force, value, step):
            flat.append((value, longest, float(np.mean(near))))
    if not flat:
        return []
    where = " and ".join(f"{value:.6g} N for {longest} samples" for value, longest, _ in flat)
    numbers = {"share": sum(share for *_, share in flat), "limit": max(abs(value) for value, *_ in flat)}
    return [Finding("saturation", "warning", f"The force stays at an extreme of {where} in a row: {_LIMITED}", numbers)]


_LIMITED = "it looks cut off there, and what lies above is lost. Reduce the motion, or trim those stretches away."


def _expected_at_turn(force: Vector, extreme: float, step: float) -> float:
    """How long a smooth signal would stay within one step of its extreme, judged by how it leaves 10 % of its range."""
    if step == 0.0:
        return 1.0
    band = max(0.1 * float(np.ptp(force)), 4.0 * step)
    longest = max(stop - start for start, stop in runs(np.abs(force - extreme) <= band))
    return max(1.0, longest * math.sqrt(step / band))


def _steps(record: Record) -> list[Finding]:
    result = []
    for role in ("displacement", "force"):
        values = getattr(record, role)
        step = resolution(values)
        if step == 0.0:
            continue
        levels = float(np.ptp(values)) / step
        said = f"The {role} is read in steps of {step:.3g} {CHANNELS[role]}, {levels:.0f} of them over its range."
        coarse = levels < 20.0
        said += " That is coarse: use more of the sensor's range." if coarse else ""
        numbers = {"step": step, "levels": levels}
        result.append(Finding(f"{role}-steps", "warning" if coarse else "info", said, numbers))
    return result


def _offsets(record: Record) -> list[Finding]:
    result = []
    for role in ("displacement", "force"):
        values = getattr(record, role)
        offset, size = float(np.mean(values)), 0.5 * float(np.ptp(values))
        large = abs(offset) > 0.5 * size
        said = (
            f"The {role} has a mean of {offset:.4g} {CHANNELS[role]}, with an amplitude of {size:.4g} {CHANNELS[role]}."
        )
        said += " If it should be zero at rest, use remove_offset(record)." if large else ""
        numbers = {"mean": offset, "amplitude": size}
        result.append(Finding(f"{role}-offset", "warning" if large else "info", said, numbers))
    return result


def _drift(record: Record) -> list[Finding]:
    """Slow change of both the median and the middle of the range, from the first quarter to the last."""
    result = []
    quarter = record.time.size // 4
    for role in ("displacement", "force"):
        values = getattr(record, role)
        turns = int(np.count_nonzero(np.diff(np.sign(values - np.mean(values)))))
        if quarter < 4 or turns < 8:
            continue  # too few periods to tell drift from motion
        first, last = values[:quarter], values[-quarter:]
        changes = float(np.median(last) - np.median(first)), float(_middle(last) - _middle(first))
        change, size = min(changes, key=abs), float(np.ptp(values))
        if changes[0] * changes[1] > 0.0 and abs(change) > 0.1 * size:
            said = (
                f"The {role} drifts by {change:.4g} {CHANNELS[role]} from the first quarter to the last, "
                f"{100.0 * abs(change) / size:.0f} % of its range. Use detrend(record)."
            )
            result.append(Finding(f"{role}-drift", "warning", said, {"change": change}))
    return result


def _middle(values: Vector) -> float:
    return 0.5 * float(np.max(values) + np.min(values))


def _swapped(record: Record) -> list[Finding]:
    """A displacement is smoother than the force that it causes; the other way round the columns may be swapped."""
    rough = {role: _roughness(getattr(record, role)) for role in ("displacement", "force")}
    if rough["displacement"] < 10.0 * rough["force"] or rough["displacement"] < 1e-3:
        return []
    said = (
        f"The displacement is {rough['displacement'] / max(rough['force'], 1e-12):.3g} times as rough as the force "
        f"from sample to sample, where motion is the smoother one. Are the two columns swapped?"
    )
    return [Finding("swapped", "warning", said, rough)]


def _roughness(values: Vector) -> float:
    """R.m.s. of second differences, over the standard deviation: what jumps from sample to sample."""
    return float(np.std(np.diff(values, 2)) / np.std(values)) if values.size > 4 else 0.0


def _hum(record: Record, motion: Motion) -> list[Finding]:
    """Lines of the mains in the force that stand out of all that is beside them, where nothing moves.

    Friction answers one frequency with its odd multiples, so a multiple of a motion above 4 Hz is not taken for hum.
    """
    rate = 1.0 / record.interval
    if record.duration < 1.0:
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
        beside = (np.abs(frequency - mains) > 2.0 * width) & (np.abs(frequency - mains) <= 0.2 * mains)
        amplitude = math.sqrt(2.0 * float(np.sum(density[line])) * float(frequency[1]))
        stands_out = float(np.max(density[line])) > 4.0 * float(np.max(density[beside]))
        if stands_out and amplitude > 1e-3 * float(np.std(record.force)):
            said = (
                f"The force holds hum of the mains: {amplitude:.3g} N at {mains:g} Hz. Check the grounding of the cell."
            )
            return [Finding("hum", "warning", said, {"frequency": mains, "amplitude": amplitude})]
    return []
