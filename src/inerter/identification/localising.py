"""Localisation of a misfit: time, position, speed, force or frequency at which the residual exceeds sensor noise.

Every pattern is measured by the share of the squared residual that a law of its kind would explain (of a Gaussian
likelihood: 1 - exp(-2 gain / samples)), so that they can be ranked. Chance is judged by blocks of time of
a period or so, and no shorter than a stroke: residuals are autocorrelated within them, and hardly between. Signs of
whole blocks are flipped for a dependence on the motion, and blocks permuted for one on time; p-values are multiplied by
the number of tests, which is 29 and one more for each further channel.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label, maximum_filter1d
from scipy.signal import get_window

from inerter.identification.fit import Localisation, RecordFit
from inerter.identification.statements.patterns import FRICTION, TRAVEL, MisfitPattern
from inerter.records.finding import Finding
from inerter.records.gaps import true_runs
from inerter.statements import Severity

Matrix = NDArray[np.float64]
SURE = 0.02  # p-value, of all tests together, below which a pattern is significant
NOTICED = 0.1  # share that a pattern explains, at least
_COEFFICIENTS = (MisfitPattern.COEFFICIENT_STEP, MisfitPattern.COEFFICIENT_TREND)
_TELLING = 0.15  # share by which a change of a coefficient is preferred to one of the level: it is more specific
_MAYBE, _MUCH = 0.1, 0.3  # p-value, of one test, and share of a pattern that is only likely
_DRAWS = 4999
_FEWEST_BLOCKS, _MOST_BLOCKS = 20, 60  # unless there are fewer strokes
_BINS, _PLACES = 8, 24
_QUANTITIES = ("displacement", "velocity", "acceleration", "force", "force rate")
_SIGNALS = ("constant", "direction", *_QUANTITIES)  # whose coefficients may step or go steadily
_MEANS = (*_QUANTITIES, TRAVEL, FRICTION)  # of which the mean may be a function
_SCATTERED = ("velocity", "acceleration", "force", "force rate")  # with whose size the scatter may grow
_TESTS = 2 + 2 * len(_SIGNALS) + len(_MEANS) + len(_SCATTERED) + 2  # level, coefficients, means, scatter; places, line
_CLIP = 8.0  # r.m.s. residuals (of most samples) at which one is clipped in a dependence
_LEAPS = 0.5  # of the residual: second differences of a force that jumps, of which a spike has 2 and a bump little
_RARE = 0.01  # of the samples: those that may be single instants
_AS_GOOD = 0.9  # of the best share: quantities that cannot be distinguished
_EDGE = 0.05  # of a record, within which no change is sought
_NONE = 2.0  # times the noise of the sensors: a part without misfit
_ONE_LINE = 0.9  # of the squared displacement: a motion that mostly consists of one sine ...
_HIGHEST = 20  # ... up to whose harmonics of this order lines count as those of a nonlinear device
_NARROW = 2.5  # highest over lowest frequency of a band, at most
_ALIKE, _VARIES = 0.8, 0.7  # correlation of the logarithms of residual and acceleration, and what those vary by
_CLEAR_LINE = 8.0  # amplitude over the median within an octave


@dataclass(frozen=True, eq=False)
class LocalisedSamples:
    """The samples that are tested: residual [N], level of the sensor noise, and the motion."""

    time: Matrix
    residual: Matrix  # [N]
    level: Matrix  # [N] r.m.s. residual of sensor noise
    motion: Mapping[str, Matrix]
    block: NDArray[np.int64]
    further: Mapping[str, Matrix] = field(default_factory=dict)
    leaps: Matrix | None = None  # [N] second differences of the measured force, where available

    @property
    def tests(self) -> int:
        """Number of p-values, by which each is corrected."""
        return _TESTS + len(self.further)

    @property
    def blocks(self) -> int:
        """Number of blocks of time."""
        return int(self.block[-1]) + 1


def localisation_of(c: RecordFit, seed: int = 0) -> Localisation:
    """Patterns in the residual of one record, those that explain most of it first."""
    random = np.random.default_rng([seed, 7])
    s = _localised_samples(c)
    inside = _winsorise(s.residual)
    bounded = replace(s, residual=inside - float(inside.mean()))
    found = [
        *_outlier_instants(s),
        *_level_changes(bounded, random),
        *_coefficients(bounded, random),
        *_dependences(bounded, random),
        *_channel_dependences(bounded, random),
        *_spectral(s, c),
    ]
    chosen = [f for f in found if _p_value_of(f) * s.tests < SURE and f.numbers["share"] > NOTICED]
    if not chosen:  # the largest, reported as not significant
        chosen = [f for f in found if _p_value_of(f) < _MAYBE and f.numbers["share"] > _MUCH]
    chosen.sort(key=lambda f: -f.numbers["share"] - _TELLING * (f.kind in _COEFFICIENTS))
    return Localisation(c.record.source, tuple(replace(f, numbers=_with_corrected_p(f, s.tests)) for f in chosen))


def _p_value_of(f: Finding) -> float:
    """p-value of one test; 0 for a pattern that is found by its size alone and has none."""
    return float(f.numbers.get("p", 0.0))


def _with_corrected_p(f: Finding, tests: int) -> dict[str, object]:
    return {**f.numbers, "p": min(_p_value_of(f) * tests, 1.0)} if "p" in f.numbers else dict(f.numbers)


def _localised_samples(c: RecordFit) -> LocalisedSamples:
    used = c.fitted | c.checked
    motion, force = c.experiment.motion, c.model - c.offset
    velocity, interval = motion.velocity, c.record.interval
    turned = np.flatnonzero(np.diff(np.sign(velocity)) != 0.0) + 1
    since = np.zeros(velocity.size)
    for start, stop in zip([0, *turned], [*turned, velocity.size], strict=True):
        since[start:stop] = np.abs(motion.displacement[start:stop] - motion.displacement[start])
    signals = {
        "displacement": motion.displacement,
        "velocity": velocity,
        "acceleration": motion.acceleration,
        "force": force,
        "force rate": np.gradient(force, interval),
        TRAVEL: since,
    }
    time = c.record.time[used]
    strokes = int(np.count_nonzero(np.diff(np.sign(velocity[used])))) + 1
    blocks = int(np.clip(strokes // 2, min(_FEWEST_BLOCKS, strokes), _MOST_BLOCKS))
    number = np.floor((time - time[0]) / (time[-1] - time[0]) * (blocks - 1e-9))
    level = np.sqrt(np.mean(c.draws**2, axis=0))
    level = np.sqrt(np.convolve(level**2, np.ones(5) / 5.0, "same")) + 1e-12
    return LocalisedSamples(
        time,
        c.residual[used],
        np.maximum(level, 0.3 * float(np.median(level)))[used],
        {name: values[used] for name, values in signals.items()},
        np.unique(number, return_inverse=True)[1],  # none is empty
        {name: values[used] for name, values in c.record.further.items()},
        np.abs(np.diff(c.record.force, 2, prepend=c.record.force[0], append=c.record.force[-1]))[used],
    )


def _winsorise(residual: Matrix) -> Matrix:
    limit = _CLIP * float(np.sqrt(np.quantile(residual**2, 0.9) / 2.7)) + 1e-300
    return np.clip(residual, -limit, limit)


def _explained_share(before: float, after: float) -> float:
    """Share of a mean square that is explained."""
    return 1.0 - after / max(before, 1e-300)


def _outlier_instants(s: LocalisedSamples) -> Iterator[Finding]:
    """A hundredth of the samples with most of the squared residual."""
    square = (s.residual / s.level) ** 2
    if not square.any():
        return
    ordered = np.sort(square)
    number = max(int(_RARE * square.size), 1)
    most, rest = ordered[-number:], max(float(ordered[:-number].mean()), float(np.finfo(float).tiny))
    inside = float(most.mean())
    share = _explained_share(float(square.mean()), math.exp((1.0 - _RARE) * math.log(rest) + _RARE * math.log(inside)))
    share *= float(most.sum()) / float(square.sum())
    if most.sum() < 0.5 * square.sum() or inside < 30.0 * rest:
        return
    marked = square > max(0.05 * float(square.max()), 25.0 * rest)
    near = np.convolve(marked, np.ones(7), "same") > 0.0
    numbered, count = label(near)
    peaks = [int(np.argmax(np.where(numbered == i, square, 0.0))) for i in range(1, min(count, 200) + 1)]
    leap = np.zeros(square.size) if s.leaps is None else maximum_filter1d(s.leaps, 3)
    numbers = {
        "count": count, "times": tuple(float(s.time[p]) for p in peaks[:6]),
        "longest": max(stop - start for start, stop in true_runs(marked)), "share": share,
        "leaps": float(np.median(leap[peaks] / np.abs(s.residual[peaks]))) > _LEAPS,
        "largest": float(np.abs(s.residual[peaks]).max()), "at": float(s.time[np.argmax(square)]),
    }  # fmt: skip
    yield Finding(MisfitPattern.INSTANTS, Severity.INFO, numbers=numbers)


def _level_changes(s: LocalisedSamples, random: np.random.Generator) -> Iterator[Finding]:
    """A level of the residual that steps or grows."""
    square = (s.residual / s.level) ** 2
    sizes = np.bincount(s.block)
    mean = np.bincount(s.block, square) / sizes
    log = np.log(np.maximum(mean, 1e-12))
    order = np.argsort(random.random((_DRAWS, s.blocks)), axis=1)
    step, trend = _cusum(log), _slope(log)
    p_step = _p_value(step, _cusum(log[order]))
    p_trend = _p_value(trend, _slope(log[order]))
    at = _split_by_level(square)
    before, after = float(square[:at].mean()), float(square[at:].mean())
    w = at / square.size
    of_step = _explained_share(float(square.mean()), math.exp(w * math.log(before) + (1.0 - w) * math.log(after)))
    place = np.arange(s.blocks) - 0.5 * (s.blocks - 1)
    slope = float(place @ (log - log.mean())) / float(place @ place)
    line = slope * place
    line += math.log(max(float(np.mean(mean * np.exp(-line))), 1e-300))
    of_trend = _explained_share(float(mean.mean()), math.exp(float(line.mean())))
    time = float(s.time[at])
    numbers = {
        "before": math.sqrt(before), "after": math.sqrt(after), "time": time, "motion": _motion_steps(s, at)
    }  # fmt: skip
    if of_step > 1.1 * of_trend:
        begins, ends = math.sqrt(before) < _NONE, math.sqrt(after) < _NONE
        kind = MisfitPattern.BEGINS if begins else MisfitPattern.ENDS if ends else MisfitPattern.LEVEL_STEP
        yield Finding(kind, Severity.INFO, numbers={**numbers, "share": of_step, "p": p_step})
    else:
        ends_of = {"before": math.exp(0.5 * float(line[0])), "after": math.exp(0.5 * float(line[-1]))}
        size = np.log(np.maximum(np.bincount(s.block, s.motion["acceleration"] ** 2) / sizes, 1e-300))
        varies = min(float(np.ptp(size)), float(np.ptp(log))) > _VARIES
        alike = varies and float(np.corrcoef(log, size)[0, 1]) > _ALIKE
        yield Finding(
            MisfitPattern.GROWS, Severity.INFO, numbers={**ends_of, "share": of_trend, "p": p_trend, "motion": alike}
        )


def _motion_steps(s: LocalisedSamples, at: int) -> bool:
    """Whether the acceleration of the motion changes by a factor of 2 at a sample: another stage of a test."""
    width = max(s.time.size // 20, 8)
    near = s.motion["acceleration"][max(at - width, 0) : at + width]
    before, after = (float(np.mean(part**2)) for part in np.split(near, [min(width, at)]))
    return not 0.25 < before / max(after, 1e-300) < 4.0


def _split_by_level(square: Matrix) -> int:
    """The sample at which the level of squares steps, by the likelihood of two levels."""
    n = square.size
    edge = max(int(_EDGE * n), 8)
    total = np.cumsum(square)
    k = np.arange(edge, n - edge)
    before, after = total[k - 1] / k, (total[-1] - total[k - 1]) / (n - k)
    cost = k * np.log(np.maximum(before, 1e-300)) + (n - k) * np.log(np.maximum(after, 1e-300))
    return int(k[np.argmin(cost)])


def _cusum(rows: Matrix) -> Matrix:
    """Largest excursion of the cumulative sum of each row about its mean."""
    return np.asarray(np.abs(np.cumsum(rows - rows.mean(axis=-1, keepdims=True), axis=-1)).max(axis=-1))


def _slope(rows: Matrix) -> Matrix:
    place = np.arange(rows.shape[-1]) - 0.5 * (rows.shape[-1] - 1)
    return np.asarray(np.abs((rows - rows.mean(axis=-1, keepdims=True)) @ place))


def _p_value(found: Matrix, drawn: Matrix) -> float:
    return (1.0 + float(np.sum(drawn >= found * (1.0 - 1e-12)))) / (1.0 + drawn.size)


def _coefficients(s: LocalisedSamples, random: np.random.Generator) -> Iterator[Finding]:
    """Coefficients of the residual on a signal that step or drift over time."""
    signals = {"constant": np.ones(s.time.size), "direction": np.sign(s.motion["velocity"])}
    signals |= {name: s.motion[name] for name in _QUANTITIES}
    order = np.argsort(random.random((_DRAWS, s.blocks)), axis=1)
    square = float(s.residual @ s.residual)
    for name, q in signals.items():
        both, own = s.residual * q, q * q
        product, power = np.bincount(s.block, both), np.maximum(np.bincount(s.block, own), 1e-300)
        mean = float(product.sum() / power.sum())
        score = product - mean * power  # of each block; it sums to zero where the coefficient is constant
        constant = square - float(product.sum()) ** 2 / float(power.sum())
        place = np.arange(s.blocks) - 0.5 * (s.blocks - 1)
        columns = np.stack([power, power * place, power * place**2]).sum(axis=1)
        inverse = np.linalg.inv(np.array([[columns[0], columns[1]], [columns[1], columns[2]]]))
        linear = inverse @ np.array([product.sum(), place @ product])
        of_trend = square - float(linear @ np.array([product.sum(), place @ product]))
        at, of_step, change = _coefficient_split(both, own, square)
        if min(of_trend, of_step) > (1.0 - NOTICED) * constant:
            continue
        shares = {
            "share": _explained_share(square, of_step), "time": float(s.time[at]), "change": change,
            "motion": _motion_steps(s, at),
        }  # fmt: skip
        if _explained_share(constant, of_step) > 1.1 * _explained_share(constant, of_trend):
            p = _p_value(_cusum(score), _cusum(score[order]))
            yield Finding(MisfitPattern.COEFFICIENT_STEP, Severity.INFO, name, {**shares, "p": p})
        else:
            p = _p_value(_slope(score), _slope(score[order]))
            size = {"share": _explained_share(square, of_trend), "change": float(linear[1]) * (s.blocks - 1)}
            yield Finding(MisfitPattern.COEFFICIENT_TREND, Severity.INFO, name, {**size, "p": p})


def _coefficient_split(both: Matrix, own: Matrix, square: float) -> tuple[int, float, float]:
    """The sample at which a coefficient steps, the residual squares with two values, and its change."""
    n = both.size
    edge = max(int(_EDGE * n), 8)
    a, b = np.cumsum(both), np.maximum(np.cumsum(own), 1e-300)
    k = np.arange(edge, n - edge)
    later = np.maximum(b[-1] - b[k - 1], 1e-300)
    left = square - a[k - 1] ** 2 / b[k - 1] - (a[-1] - a[k - 1]) ** 2 / later
    best = int(np.argmin(left))
    at = int(k[best])
    return at, float(left[best]), float((a[-1] - a[at - 1]) / later[best] - a[at - 1] / b[at - 1])


def _dependences(s: LocalisedSamples, random: np.random.Generator) -> Iterator[Finding]:
    """The quantity on which the residual depends, and that with which the scatter of the rest grows."""
    best, fitted = _mean_dependence(s, random)
    yield best
    explains = _p_value_of(best) * s.tests < SURE and best.numbers["share"] > NOTICED
    rest = replace(s, residual=s.residual - fitted) if explains else s
    remaining = float(rest.residual @ rest.residual) / max(float(s.residual @ s.residual), 1e-300)
    for found in _scatter_dependence(rest, random):
        yield replace(found, numbers={**found.numbers, "share": remaining * found.numbers["share"]})


def _mean_dependence(s: LocalisedSamples, random: np.random.Generator) -> tuple[Finding, Matrix]:
    """The quantity on which the mean residual depends, with equally good ones, and that function [N]."""
    found, laws = [], {}
    signs = random.choice([-1.0, 1.0], (_DRAWS, s.blocks))
    direction = np.sign(s.motion["velocity"])
    quantities = {**s.motion, FRICTION: s.motion["displacement"]}
    for name, q in quantities.items():
        way = direction if name in (FRICTION, TRAVEL) else 1.0
        bins, centre = _bins(q, _PLACES if name == FRICTION else _BINS)
        means, share, p = _sign_flip_test(s.residual * way, bins, s.block, signs)
        laws[name] = way * means[bins]
        low, high = int(np.argmin(means)), int(np.argmax(means))
        numbers = {
            "share": share, "p": p, "least": float(means[low]), "most": float(means[high]),
            "at_least": float(centre[low]), "at_most": float(centre[high]),
            "centres": tuple(centre.tolist()), "means": tuple(means.tolist()),
        }  # fmt: skip
        found.append(Finding(MisfitPattern.MEAN, Severity.INFO, name, numbers))
    found.sort(key=lambda f: -f.numbers["share"])
    best = found[0]
    others = tuple(f.about for f in found[1:] if f.numbers["share"] > _AS_GOOD * best.numbers["share"])
    return replace(best, numbers={**best.numbers, "others": others}), np.asarray(laws[best.about])


def _sign_flip_test(
    values: Matrix, bins: NDArray[np.int64], block: NDArray[np.int64], signs: Matrix
) -> tuple[Matrix, float, float]:
    """Means in each bin, the share of the squares that they explain beyond chance, and its p-value."""
    count, blocks = int(bins.max()) + 1, int(block[-1]) + 1
    sums = np.bincount(block * count + bins, values, blocks * count).reshape(blocks, count)
    size = np.maximum(np.bincount(bins, minlength=count), 1)
    square = float(values @ values)
    found = float(np.sum(sums.sum(axis=0) ** 2 / size)) / max(square, 1e-300)
    drawn = np.sum((signs @ sums) ** 2 / size, axis=1) / max(square, 1e-300)
    chance = float(drawn.mean())
    return (
        sums.sum(axis=0) / size,
        max((found - chance) / max(1.0 - chance, 1e-9), 0.0),
        _p_value(np.array(found), drawn),
    )


def _bins(q: Matrix, count: int) -> tuple[NDArray[np.int64], Matrix]:
    """Bin of each sample, all with equally many samples, and the medians in each."""
    edges = np.unique(np.quantile(q, np.arange(1, count) / count))
    bins = np.searchsorted(edges, q, side="right")
    return bins, np.array([float(np.median(q[bins == i])) if np.any(bins == i) else 0.0 for i in range(edges.size + 1)])


def _scatter_dependence(s: LocalisedSamples, random: np.random.Generator) -> Iterator[Finding]:
    """The quantity with whose size the scatter of the residual grows, and few positions with most of it."""
    signs = random.choice([-1.0, 1.0], (_DRAWS, s.blocks))
    scaled = np.abs(s.residual) / s.level * float(np.median(s.level))
    square, sizes = scaled**2, np.bincount(s.block)
    within = scaled - (np.bincount(s.block, scaled) / sizes)[s.block]
    found = []
    for name in _SCATTERED:
        bins, _ = _bins(np.abs(s.motion[name]), _BINS)
        _, _, p = _sign_flip_test(within, bins, s.block, signs)
        count = np.bincount(bins)
        means, count = (np.bincount(bins, square) / np.maximum(count, 1))[count > 0], count[count > 0]
        share = _log_share(means, count)
        numbers = {"share": share, "p": p, "low": math.sqrt(means[0]), "high": math.sqrt(means[-1])}
        found.append(Finding(MisfitPattern.SPREAD, Severity.INFO, name, numbers))
    found.sort(key=lambda f: -f.numbers["share"])
    others = tuple(f.about for f in found[1:] if f.numbers["share"] > _AS_GOOD * found[0].numbers["share"])
    yield replace(found[0], numbers={**found[0].numbers, "others": others})
    yield from _misfit_positions(s, square, within, signs)


def _log_share(means: Matrix, weights: NDArray[np.int64]) -> float:
    w = weights / weights.sum()
    return _explained_share(float(w @ means), math.exp(float(w @ np.log(np.maximum(means, 1e-300)))))


def _misfit_positions(s: LocalisedSamples, square: Matrix, within: Matrix, signs: Matrix) -> Iterator[Finding]:
    """Up to three parts of the travel, together a quarter of it, with most of the misfit."""
    x = s.motion["displacement"]
    low, high = np.quantile(x, (0.002, 0.998))
    if not high > low:
        return
    bins = np.clip(((x - low) / (high - low) * _PLACES).astype(np.int64), 0, _PLACES - 1)
    count = np.bincount(bins, minlength=_PLACES)
    means = np.bincount(bins, square, _PLACES) / np.maximum(count, 1)
    share = _log_share(means[count > 0], count[count > 0])
    _, _, p = _sign_flip_test(within, bins, s.block, signs)
    high_places = means > 0.5 * float(means.max())
    number, places = label(high_places)
    held = float(means[high_places] @ count[high_places]) / max(float(square.sum()), 1e-300)
    if not 1 <= places <= 3 or high_places.mean() > 0.25 or held < 0.5:
        return
    centres = low + (np.arange(_PLACES) + 0.5) * (high - low) / _PLACES
    at = tuple(float(np.average(centres[number == i], weights=means[number == i])) for i in range(1, places + 1))
    yield Finding(
        MisfitPattern.POSITIONS, Severity.INFO, "displacement", {"share": share, "p": p, "places": at, "held": held}
    )


def _channel_dependences(s: LocalisedSamples, random: np.random.Generator) -> Iterator[Finding]:
    """Further channels, such as a temperature, with which the level of the residual is correlated over blocks."""
    square = (s.residual / s.level) ** 2
    sizes = np.bincount(s.block)
    log = np.log(np.maximum(np.bincount(s.block, square) / sizes, 1e-12))
    rank = np.argsort(np.argsort(log)).astype(float)
    order = np.argsort(random.random((_DRAWS, s.blocks)), axis=1)
    for name, values in s.further.items():
        usual = np.argsort(np.argsort(np.bincount(s.block, values) / sizes)).astype(float)
        usual -= usual.mean()
        r = float(usual @ rank) / max(float(np.linalg.norm(usual) * np.linalg.norm(rank - rank.mean())), 1e-300)
        p = _p_value(np.array(abs(float(usual @ rank))), np.abs(rank[order] @ usual))
        share = _explained_share(float(np.mean(np.exp(log))), math.exp(float(np.mean(log)))) * r**2
        yield Finding(MisfitPattern.CHANNEL, Severity.INFO, name, {"share": share, "p": p, "correlation": r})


def _spectral(s: LocalisedSamples, c: RecordFit) -> Iterator[Finding]:
    """An isolated line in the spectrum of the residual, or a band with most of it."""
    at = np.flatnonzero(c.fitted | c.checked)
    at -= at[0]  # samples left out in between are zero, which keeps the times of the others
    n = int(at[-1]) + 1
    window = get_window("hann", n)[at]
    scale = 2.0 / float(window.sum())

    def amplitudes(rows: Matrix) -> Matrix:
        spread = np.zeros((*rows.shape[:-1], n))
        spread[..., at] = window * rows
        return np.abs(np.fft.rfft(spread))

    amplitude = scale * amplitudes(s.residual - s.residual.mean())
    moved = amplitudes(s.motion["displacement"] - s.motion["displacement"].mean())
    sound = scale * np.sqrt(np.mean(amplitudes(c.draws[:, c.fitted | c.checked]) ** 2, axis=0))
    frequency = np.asarray(np.fft.rfftfreq(n, c.record.interval), dtype=float)
    excess = np.asarray(np.maximum(amplitude**2 - sound**2, 0.0), dtype=float)
    excess[:2] = 0.0
    total = float(np.sum(amplitude[2:] ** 2))
    highest = c.experiment.motion.highest
    resonance = _resonance(frequency, amplitudes(s.motion["force"] - s.motion["force"].mean()), highest)
    peak = int(np.argmax(excess))
    main = slice(max(peak - 3, 0), peak + 4)
    nearby = np.r_[max(int(peak / 1.4), 2) : max(peak - 4, 2), peak + 5 : min(int(1.4 * peak) + 8, amplitude.size)]
    share = float(np.sum(amplitude[main] ** 2)) / max(total, 1e-300)
    if nearby.size > 8 and amplitude[peak] > _CLEAR_LINE * float(np.median(amplitude[nearby])):
        multiple = _multiple(peak, moved)
        foreign = multiple == 0 and bool(moved[peak] < _CLEAR_LINE * float(np.median(moved[nearby])))
        above = float(amplitude[peak]) / max(float(np.median(amplitude[nearby])), 1e-300)
        chance = float(frequency.size) * math.exp(-math.log(2.0) * above**2)  # of a Rayleigh amplitude of that median
        resonates = resonance[0] <= frequency[peak] <= resonance[1]
        numbers = {
            "frequency": float(frequency[peak]), "amplitude": float(amplitude[peak]), "p": chance, "multiple": multiple,
            "share": share if foreign and not resonates else 0.5 * share, "foreign": foreign, "resonates": resonates,
        }  # fmt: skip
        yield Finding(MisfitPattern.LINE, Severity.INFO, numbers=numbers)
    yield from _band(frequency, excess, total, highest, resonance)


def _multiple(peak: int, moved: Matrix) -> int:
    """Order of the harmonic of a nearly sinusoidal motion at this line of its spectrum; 0 if it is none."""
    main = int(np.argmax(moved[2:])) + 2
    own = moved[max(main - 3, 0) : main + 4]
    if float(np.sum(own**2)) < _ONE_LINE * float(np.sum(moved[2:] ** 2)):
        return 0
    centre = float(np.average(np.arange(max(main - 3, 0), main + 4), weights=own**2))
    multiple = round(peak / centre)
    return multiple if 1 <= multiple <= _HIGHEST and abs(peak - multiple * centre) < 1.0 + 0.1 * multiple else 0


def _resonance(frequency: Matrix, force: Matrix, highest: float) -> tuple[float, float]:
    """The band [Hz] above the motion in which the force of the model is concentrated; (inf, inf) if it is in none.

    A device rings there, by friction and impacts, and whatever is wrong makes it ring otherwise.
    """
    power = np.where(frequency > 0.8 * highest, force**2, 0.0)
    part = np.cumsum(power)
    low, high = (float(frequency[min(int(np.searchsorted(part, q * part[-1])), part.size - 1)]) for q in (0.15, 0.85))
    return (low, high) if 0.0 < low < high < _NARROW * low else (math.inf, math.inf)


def _band(
    frequency: Matrix, excess: Matrix, total: float, highest: float, resonance: tuple[float, float]
) -> Iterator[Finding]:
    """The middle 70 % of the excess, if little more than an octave wide and above the motion."""
    part = np.cumsum(excess)
    if part[-1] < NOTICED * total:
        return
    low, high = (float(frequency[int(np.searchsorted(part, q * part[-1]))]) for q in (0.15, 0.85))
    if 0.8 * highest < low and high < _NARROW * low and high > low:
        both = min(high, resonance[1]) - max(low, resonance[0])
        resonates = both > 0.5 * (high - low)
        share = 0.7 * float(part[-1]) / total * (0.5 if resonates else 1.0)
        numbers = {"low": low, "high": high, "highest": highest, "share": share, "resonates": resonates}
        yield Finding(MisfitPattern.BAND, Severity.INFO, numbers=numbers)
