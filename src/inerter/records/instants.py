"""Faults at single instants of a channel: spikes, held values, and joints between pieces.

Each is a contradiction of the samples before and after it: a spike leaves a smooth channel and comes back, a held value
repeats where noise or motion would have changed it, and a joint moves all samples after it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.records.dropouts import MAD
from inerter.records.gaps import true_runs
from inerter.records.record import Record
from inerter.records.smoothing import resolution

Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]
_SIXTH = np.array([1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0]) / -20.0  # a sample less what its neighbours predict
_AROUND = 50  # samples to either side, whose deviations a spike has to exceed too
_CLEAR = 8.0  # standard deviations from the prediction of the neighbours
_RETURN = 0.08  # of a spike: deviation of the adjacent samples, once it is removed
_WIDEST = 3  # samples of a spike
_HELD = 4  # equal samples in a row, at least
_LOCAL = 100  # samples to either side, which say how often values repeat by chance
_RARE = 1e-3  # expected number of such repetitions in a record that holds none
_REST = 3.0  # steps of a channel, within which its values are those before the motion begins, or after it has ended
_FAR = 5.0  # times the noise: departure of fewer repeated values, as others change nothing
_COMMON = 0.2  # of the samples: repetitions of a channel whose values repeat anyway, as friction without noise
_BEFORE, _DEGREE = 6, 2  # samples on either side of a held value, and the degree of the polynomial through them
_JOINT = 10.0  # standard deviations between the extrapolations from both sides
_ALONE = 4.0  # ratio of the largest discontinuities to all others
_MOST_JOINTS = 4
_FORWARD = np.array([-5.0, 21.0, -35.0, 35.0]) / 16.0  # a cubic through four samples, half an interval beyond


@dataclass(frozen=True)
class Instant:
    """Samples from `start` up to `stop` of a channel, and the size of their error [unit of the channel]."""

    start: int
    stop: int
    size: float


def spike_instants(values: Vector, widest: int = _WIDEST) -> list[Instant]:
    """Runs of up to `widest` samples that leave an otherwise smooth channel and return to it at once.

    An impact that passed a load cell takes several samples to decay, and a step does not return: neither is a spike.

    >>> values = np.random.default_rng(0).normal(size=1000)
    >>> values[500] += 40.0
    >>> [(found.start, found.stop) for found in spike_instants(values)]
    [(500, 501)]
    """
    if values.size < 8 * widest:
        return []
    taken = np.zeros(values.size, dtype=bool)
    found = []
    for width in range(1, widest + 1):
        for instant in _spikes_of(values, width):
            if not taken[instant.start : instant.stop].any():
                taken[max(instant.start - 3, 0) : instant.stop + 3] = True
                found.append(instant)
    return sorted(found, key=lambda instant: instant.start)


def _spikes_of(values: Vector, width: int) -> Iterator[Instant]:
    deviation = _deviation(values)
    scale = np.maximum(_local_scale(deviation), resolution(values))
    limit = _CLEAR * np.maximum(scale, 1e-12 * float(np.ptp(values)))
    margin = 4
    for at in np.flatnonzero(np.abs(deviation) > limit):
        for start in range(max(int(at) - width + 1, margin), int(at) + 1):
            stop = start + width
            if stop + margin > values.size:
                continue
            near = np.r_[start - margin : start, stop : stop + margin]
            middle = 0.5 * (start + stop - 1)
            inside = np.arange(start, stop)
            law = np.polynomial.Polynomial.fit(near - middle, values[near], 3)
            height = values[inside] - law(inside - middle)
            left = float(np.max(np.abs(values[near] - law(near - middle))))
            size = float(height[np.argmax(np.abs(height))])
            same = bool(np.all(height * size > 0.3 * size**2))
            if not _leaves_and_returns(values, start, stop, size):
                continue
            if same and abs(size) > limit[at] and left < _RETURN * abs(size) + 3.0 * float(scale[at]):
                yield Instant(start, stop, size)
                break


def _leaves_and_returns(values: Vector, start: int, stop: int, size: float) -> bool:
    """Whether both edges are jumps of about the size, against the slopes before and after; a joint has one edge."""
    before = (values[start - 1] - values[start - 4]) / 3.0
    after = (values[stop + 3] - values[stop]) / 3.0
    into, out = values[start] - values[start - 1] - before, values[stop] - values[stop - 1] - after
    return bool(into * size > 0.5 * size**2 and out * size < -0.5 * size**2)


def _deviation(values: Vector) -> Vector:
    """Each sample less the interpolation of the three before and after it; zero at the ends."""
    result = np.zeros(values.size)
    result[3:-3] = np.convolve(values, _SIXTH, "valid")
    return result


def _local_scale(deviation: Vector) -> Vector:
    """Standard deviation in most of the record, or about each sample if that is larger."""
    whole = MAD * float(np.median(np.abs(deviation)))
    blocks = np.array_split(np.abs(deviation), max(deviation.size // _AROUND, 1))
    level = np.repeat([MAD * float(np.median(block)) for block in blocks], [block.size for block in blocks])
    return np.asarray(np.maximum(whole, level))


def held_value_instants(values: Vector, smooth: bool = True) -> list[Instant]:
    """Runs of at least four equal values where noise or motion would have changed them; fewer where both would have.

    A clipped channel, one at rest and one whose values repeat all the time have no held values; nor has a record before
    its motion begins, or after it has ended, where few samples in a period make noise look larger than steps. A channel
    that is not `smooth` may rest and continue with a jump, as a force does where backlash is open: there only noise is
    decisive.

    >>> values = np.random.default_rng(0).normal(size=1000)
    >>> values[500:506] = values[500]
    >>> [(found.start, found.stop) for found in held_value_instants(values)]
    [(500, 506)]
    """
    same = np.diff(values) == 0.0
    runs = [(a, b + 1) for a, b in true_runs(same)]
    candidates = [(a, b) for a, b in runs if b - a >= _HELD]
    if not runs or values.size < 4 * _BEFORE:
        return []
    inside = np.zeros(values.size, dtype=bool)
    for a, b in candidates:
        inside[a:b] = True
    step, noise = resolution(values), _noise(values)
    ends = float(values.max()), float(values.min())
    away_from = [np.abs(values - values[end]) > _REST * step for end in (0, -1)]
    begun, ended = int(np.argmax(away_from[0])), values.size - int(np.argmax(away_from[1][::-1]))
    alike = step / (math.sqrt(4.0 * math.pi) * noise) if noise > step else 1.0  # noise of size one, in these steps
    found = []
    for a, b in runs:
        if values[a] in ends or a < begun or b > ended:
            continue
        away, scatter = _departure(values, a, b)
        if b - a < _HELD:
            if not smooth and alike ** (b - a - 1) * values.size < _RARE and away > _FAR * max(noise, scatter):
                found.append(Instant(a, b, away))
            continue
        moved = smooth and away > max(3.0 * step, 5.0 * noise, 5.0 * scatter, 1e-9 * float(np.ptp(values)))
        if moved or (noise > step and _by_chance(same, inside, a, b, step / max(noise, 1e-300)) * values.size < _RARE):
            found.append(Instant(a, b, away))
    common = sum(i.stop - i.start for i in found) > _COMMON * values.size
    return [] if common else found


def _noise(values: Vector) -> float:
    """Standard deviation of the noise from sample to sample, by third differences."""
    third = np.diff(values, 3)
    return MAD * float(np.median(np.abs(third))) / math.sqrt(20.0)


def _by_chance(same: Mask, inside: Mask, a: int, b: int, step: float) -> float:
    """Probability that so many consecutive samples are equal, from the share of equal neighbours nearby.

    At least that of noise of size one about a mean that does not move, read in these steps.
    """
    near = slice(max(a - _LOCAL, 0), b + _LOCAL)
    outside = ~inside[:-1][near]
    share = (float(np.sum(same[near] & outside)) + 1.0) / (float(np.sum(outside)) + 2.0)
    return max(share, step / math.sqrt(4.0 * math.pi)) ** (b - a - 1)


def _departure(values: Vector, a: int, b: int) -> tuple[float, float]:
    """Largest distance of a held value from a polynomial through the samples around it, and their scatter."""
    near = np.r_[max(a - _BEFORE, 0) : a + 1, b : min(b + _BEFORE, values.size)]
    if near.size < 2 * _BEFORE:
        return 0.0, 0.0
    middle = 0.5 * (a + b)
    law = np.polynomial.Polynomial.fit(near - middle, values[near], _DEGREE)
    away = float(np.max(np.abs(law(np.arange(a, b) - middle) - values[a])))
    return away, float(np.std(values[near] - law(near - middle)))


def joint_instants(record: Record, excused: Mask) -> list[Instant]:
    """Instants at which the displacement jumps between two smooth parts: joints between pieces.

    They are few, and far larger than any other discontinuity. `excused` are samples with faults of another kind.
    """
    z = record.displacement
    if z.size < 64:
        return []
    windows = np.lib.stride_tricks.sliding_window_view(z, 4)
    jump = windows[4:] @ _FORWARD[::-1] - windows[:-4] @ _FORWARD  # between samples i + 3 and i + 4
    size = np.where(_dilate(excused, 8)[3 : 3 + jump.size], 0.0, np.abs(jump))
    noise = max(MAD * float(np.median(np.abs(jump))), resolution(z))
    found: list[Instant] = []
    rest, kink = size.copy(), np.abs(np.convolve(np.diff(z), [-0.5, 1.0, -0.5], "same"))[3:-3]
    for _ in range(_MOST_JOINTS):
        at = int(np.argmax(rest))
        if rest[at] <= _JOINT * noise:
            break
        near = slice(max(at - 1, 0), at + 2)  # beside a step, extrapolations differ by 19/16 of it
        last = near.start + int(np.argmax(kink[near])) + 3
        found.append(Instant(last, last + 2, float(jump[last - 3])))
        rest[max(at - 8, 0) : at + 9] = 0.0
    others = float(rest.max())
    return sorted(
        (i for i in found if abs(i.size) > _ALONE * others and _is_step(z, i, noise)), key=lambda instant: instant.start
    )


def _is_step(z: Vector, joint: Instant, noise: float) -> bool:
    """Whether all samples after the joint are displaced against those before, not only the neighbouring ones."""
    at = joint.start + 1
    before, after = z[max(at - 12, 0) : at - 2], z[at + 2 : at + 12]
    if min(before.size, after.size) < 8:
        return False
    law = np.polynomial.Polynomial.fit(np.arange(-before.size, 0) - 2.0, before, 2)
    other = np.polynomial.Polynomial.fit(np.arange(after.size) + 2.0, after, 2)
    return abs(float(other(-0.5) - law(-0.5))) > 0.3 * abs(joint.size) + noise


def _dilate(mask: Mask, by: int) -> Mask:
    return np.asarray(np.convolve(mask, np.ones(2 * by + 1), "same") > 0.0)


def mask_of(instants: list[Instant], size: int) -> Mask:
    """Samples (size,) that belong to any of these instants."""
    result = np.zeros(size, dtype=bool)
    for instant in instants:
        result[instant.start : instant.stop] = True
    return result
