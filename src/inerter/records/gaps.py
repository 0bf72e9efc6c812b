"""Missing samples: refused, filled, or cut away; and channels sampled at different times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import binary_dilation, find_objects, label

from inerter.errors import RecordError
from inerter.formatting import format_alike, format_count, format_quantity
from inerter.records.channels import Samples
from inerter.records.remedy import Action, Remedy
from inerter.validation import is_number

Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]
LONGEST = 10  # samples in a row that gaps="fill" fills
SCATTER, _WHOLE = 0.1, 0.25  # of an interval: largest deviation of an even clock, and of whole intervals
HOLE = 3.0  # intervals without a sample that count as a hole in a raster


def fill_missing(
    source: str, channels: dict[str, Samples], gaps: str | float
) -> tuple[dict[str, Samples], list[str], dict[str, tuple[int, int]]]:
    """The channels without missing samples, notes, and the numbers filled per channel: in all, and in the longest run.

    Raises `RecordError` for gaps that are not to be filled, or are too long.
    """
    if not (gaps in ("refuse", "fill", "longest") or (is_number(gaps) and gaps > 0.0)):
        raise RecordError(f"gaps must be 'refuse', 'fill', 'longest' or the longest gap to fill in s; got {gaps!r}.")
    channels, notes = _without_blank_end(channels)
    missing = {role: ~np.isfinite(samples.values) for role, samples in channels.items()}
    bad = {role: mask for role, mask in missing.items() if mask.any()}
    if not bad:
        return channels, notes, {}
    if "time" in bad:
        raise RecordError(
            f"{source}: {int(bad['time'].sum())} times are missing or not finite, the first at sample "
            f"{int(np.argmax(bad['time']))}. Remove those rows, or give ",
            Remedy(Action.INTERVAL),
            " instead of the times.",
        )
    for role, mask in bad.items():
        if mask.all():
            raise RecordError(
                f"{source}: the {role} has no readings: all of its {mask.size} samples are empty or not finite. Check "
                f"the connection of the sensor, or select another channel."
            )
    if gaps == "refuse":
        raise _refusal(source, bad)
    result, more, filled = (
        _keep_longest(channels, bad) if gaps == "longest" else _interpolate_missing(source, channels, bad, gaps)
    )
    return result, notes + more, filled


def _without_blank_end(channels: dict[str, Samples]) -> tuple[dict[str, Samples], list[str]]:
    """The channels without samples at the end that all channels lack, as spreadsheets leave them, and a note."""
    size = channels["force"].values.size
    kept = size
    while kept and not any(np.isfinite(samples.values[kept - 1]) for samples in channels.values()):
        kept -= 1
    if kept == size:
        return channels, []
    cut = {role: Samples(samples.values[:kept]) for role, samples in channels.items()}
    return cut, [f"Empty samples at the end, cut off: {size - kept}."]


@dataclass(frozen=True, eq=False)
class MissingRows:
    """Samples after which rows are missing in an otherwise even time channel, and their numbers."""

    after: NDArray[np.int64]
    counts: NDArray[np.int64]


def missing_rows(time: Vector) -> MissingRows | None:
    """Rows missing in an otherwise even time channel; None if there are none, or it is not even.

    It is even if its other intervals scatter by less than a tenth, and those are whole intervals to a quarter of one.
    """
    steps = np.diff(time)
    ratio = steps / float(np.median(steps))
    holes = ratio > 1.5
    if not holes.any() or np.std(ratio[~holes]) > SCATTER or np.abs(ratio - np.round(ratio))[holes].max() > _WHOLE:
        return None
    return MissingRows(np.flatnonzero(holes), np.rint(ratio[holes]).astype(np.int64) - 1)


def true_runs(mask: Mask) -> list[tuple[int, int]]:
    """Runs of true samples: the first sample of each and one after its last.

    >>> true_runs(np.array([False, True, True, False, True]))
    [(1, 3), (4, 5)]
    """
    return [(found[0].start, found[0].stop) for found in find_objects(label(mask)[0])]


def fill_missing_values(time: Vector, values: Vector, missing: Mask) -> Vector:
    """The values with those that are missing interpolated by a cubic spline through their neighbours.

    Needs two values that are not missing on either side of the first gap and the last.
    """
    near = binary_dilation(missing, iterations=6) & ~missing  # samples further away have no influence
    result = values.copy()
    result[missing] = CubicSpline(time[near], values[near])(time[missing])
    return result


def resample_onto_force(source: str, channels: dict[str, Samples]) -> tuple[dict[str, Samples], list[str]]:
    """Every channel at the times of the force, by a cubic spline through its own samples.

    Models are fitted to the force, so its samples are not interpolated.

    Raises `RecordError` if the times of a channel do not increase, or the channels do not overlap.
    """
    for role, samples in channels.items():
        if samples.time is None or samples.values.size < 4 or not np.all(np.diff(samples.time) > 0.0):
            raise RecordError(
                f"{source}: the {role} has fewer than four samples at increasing times, so it cannot be interpolated "
                f"to the times of the force. Export all channels with one time raster."
            )
    spans = [(s.time[0], s.time[-1]) for s in channels.values() if s.time is not None]
    start, stop = max(span[0] for span in spans), min(span[1] for span in spans)
    clock = channels["force"].time
    assert clock is not None
    inside = (clock >= start) & (clock <= stop)
    if inside.sum() < 4:
        first, last = format_alike([start, stop], "s", 6)
        raise RecordError(
            f"{source}: the channels do not overlap in time (the latest starts at {first}, the earliest ends at "
            f"{last}). Choose channels of one measurement."
        )
    time = clock[inside]
    result = {"time": Samples(time)}
    result |= {
        role: Samples(s.values[inside] if role == "force" else _interpolate_at(time, s)) for role, s in channels.items()
    }
    steps = {role: float(np.median(np.diff(s.time))) for role, s in channels.items() if s.time is not None}
    others = ", ".join(f"{role} every {format_quantity(step, 's')}" for role, step in steps.items() if role != "force")
    return result, [
        f"The channels have different time rasters ({others}); they were interpolated to the times of the force, "
        f"every {format_quantity(steps['force'], 's')}."
    ]


def have_same_times(rasters: list[Vector]) -> bool:
    """Whether these times agree within a thousandth of an interval."""
    first = rasters[0]
    if first.size < 2 or any(other.size != first.size for other in rasters):
        return False
    slack = 1e-3 * (first[-1] - first[0]) / (first.size - 1)
    return all(other is first or bool(np.max(np.abs(other - first)) <= slack) for other in rasters[1:])


def _interpolate_at(time: Vector, samples: Samples) -> Vector:
    """The spline through finite samples; nan where the samples have a gap."""
    assert samples.time is not None
    good = np.isfinite(samples.values)
    knots, values = samples.time[good], samples.values[good]
    if knots.size < 4:
        return np.full(time.size, np.nan)
    result: Vector = CubicSpline(knots, values)(time)
    steps = np.diff(knots)
    before = np.clip(np.searchsorted(knots, time, side="right") - 1, 0, steps.size - 1)
    on_knot = (time == knots[before]) | (time == knots[before + 1])
    hole = (steps > HOLE * np.median(steps))[before] & ~on_knot
    result[hole | (time < knots[0]) | (time > knots[-1])] = np.nan
    return result


def _refusal(source: str, bad: dict[str, Mask]) -> RecordError:
    role, mask = next(iter(bad.items()))
    found = true_runs(mask)
    longest = max(stop - start for start, stop in found)
    return RecordError(
        f"{source}: the {role} lacks {format_count(int(mask.sum()), 'samples')} (empty, or not finite), up to "
        f"{longest} in a row, the first at sample {found[0][0]}. Read it with ",
        *(Remedy(Action.GAPS, "fill"), " (short ones are interpolated), "),
        *(Remedy(Action.GAPS, 0.05), " (those up to 0.05 s) or "),
        *(Remedy(Action.GAPS, "longest"), " (the longest gap-free part is kept)."),
    )


def _keep_longest(
    channels: dict[str, Samples], bad: dict[str, Mask]
) -> tuple[dict[str, Samples], list[str], dict[str, tuple[int, int]]]:
    good = ~np.logical_or.reduce(list(bad.values()))
    start, stop = max(true_runs(good), key=lambda run: run[1] - run[0], default=(0, 0))
    kept = {role: Samples(samples.values[start:stop].copy()) for role, samples in channels.items()}
    note = f"Samples {start} to {stop - 1} of {good.size} were kept: the longest part without missing samples."
    return kept, [note], {}


def _interpolate_missing(
    source: str, channels: dict[str, Samples], bad: dict[str, Mask], gaps: str | float
) -> tuple[dict[str, Samples], list[str], dict[str, tuple[int, int]]]:
    every = ~np.logical_or.reduce(list(bad.values()))
    inside = np.flatnonzero(every)
    if inside.size < 4:
        raise RecordError(f"{source}: fewer than 4 samples have all channels, so missing samples cannot be filled.")
    first, last = int(inside[0]), int(inside[-1]) + 1
    cut = {role: samples.values[first:last] for role, samples in channels.items()}
    time = cut["time"]
    limit = LONGEST * float(np.median(np.diff(time))) * (1 + 1e-6) if isinstance(gaps, str) else float(gaps)
    notes, filled = [], {}
    for role, mask in bad.items():
        found = true_runs(mask[first:last])
        if not found:
            continue
        start, stop = max(found, key=lambda run: time[run[1]] - time[run[0]])
        if time[stop] - time[start] > limit:
            raise RecordError(
                f"{source}: {stop - start} consecutive samples of the {role} are missing from "
                f"{format_quantity(time[start], 's', 6)}, too many to interpolate (at most "
                f"{format_quantity(limit, 's', 6)}). Use ",
                *(Remedy(Action.GAPS, "longest"), ", or a longer limit in s if interpolation is acceptable."),
            )
        cut[role] = fill_missing_values(time, cut[role], mask[first:last])
        count, longest = int(mask[first:last].sum()), max(b - a for a, b in found)
        filled[role] = (count, longest)
        notes.append(f"Missing samples of the {role}, interpolated: {count}, up to {longest} in a row.")
    if last - first < every.size:
        notes.append(f"Incomplete samples at the ends, cut off: {every.size - last + first}.")
    return {role: Samples(values) for role, values in cut.items()}, notes, filled
