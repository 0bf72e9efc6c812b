"""The friction of a device from a slow record: its level, and whether it depends on the speed."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as fisher
from scipy.stats import t as student

from inerter.errors import IdentificationError
from inerter.identification.fit import Fit
from inerter.identification.initial_estimate import chain_of
from inerter.identification.statements.friction import SLOW, FrictionLaw, Law, Reason
from inerter.networks.elements import Free, Network, Tied
from inerter.records.record import Record
from inerter.records.smoothing import Motion, resolution, smooth_displacement

Matrix = NDArray[np.float64]
SURE = 0.01  # p-value below which friction depends on the speed
_BLOCKS = 24
_FEWEST = 200  # samples in which the device slides
_REACHED, _WOUND = 0.9, 1.5  # share of the level at which the shaft is preloaded, and travel beyond that is discarded
_NOISES = 5.0  # of the velocity, above which its sign is certain
_RANGE = 4.0  # ratio of speeds, below which no law is identifiable
_OUTLIER, _NINETY = 4.0, 1.645  # standard deviations; 90 % of normal errors lie within the second


def friction_law(source: Record | Fit, inertance: float = 0.0) -> FrictionLaw:
    """Friction law, from a slow record or from the residual of a fit.

    Where the device slides, its force is that of the direction of motion times a level and two slopes over the speed,
    below and above 0.3 of the largest, plus an offset, and a force in proportion to the displacement (`inertance` [kg]
    times the acceleration is subtracted first). After each reversal, the travel that preloads the shaft is discarded.
    The p-value is of Wald's test that both slopes are zero, with errors summed over 24 blocks of time to allow for
    autocorrelation (Liang and Zeger 1986), and never less than those of independent errors. Below 0.01 the friction
    depends on speed: viscous where it grows, Stribeck's where it falls at low speed (Armstrong-Helouvry, Dupont and
    Canudas de Wit 1994). For a fit, the slowest record is used, and the level is that of its residual.

    Raises `IdentificationError` if `source` is neither a record nor a fit, `RecordError` for an uneven record.
    """
    if isinstance(source, Fit):
        parts = [(c.experiment.motion, c.residual, c.fitted | c.checked, c.record) for c in source.comparisons]
        slowest = min(parts, key=lambda part: float(np.abs(part[0].velocity).max()))
        motion, force, kept, record = slowest
        wound = _beyond_travel(motion, _WOUND * _windup_travel(source.device))
        return _law(motion, force, _away_from_reversals(motion) & wound & kept, record, 0.0)
    if not isinstance(source, Record):
        raise IdentificationError(f"friction_law requires a Record or a Fit, got {type(source).__name__}.")
    motion = smooth_displacement(source)
    force = source.force - inertance * motion.acceleration
    level = 0.5 * float(np.quantile(force, 0.9) - np.quantile(force, 0.1))
    return _law(motion, force, _is_preloaded(motion, force, level), source, level)


def _law(motion: Motion, force: Matrix, use: NDArray[np.bool_], record: Record, rough: float) -> FrictionLaw:
    speed = np.abs(motion.velocity)
    use = use & (speed > _NOISES * motion.velocity_noise)
    blocks = np.minimum(_BLOCKS * np.cumsum(use) // max(int(use.sum()), 1), _BLOCKS - 1)[use]
    if use.sum() < _FEWEST:
        return _not_identifiable("samples", int(use.sum()))
    v, y = motion.velocity[use], force[use]
    top = float(np.abs(v).max())
    speeds = (float(np.abs(v).min()), top)
    slow, direction = SLOW * top, np.sign(v)
    nuisance = [np.ones(v.size), motion.displacement[use] - motion.displacement[use].mean()]
    if not rough:  # of a record, the acceleration was taken away as far as it is known
        nuisance.append(motion.acceleration[use])
    plain = _robust_regression(y, [direction, *nuisance], blocks)
    level, error = float(plain[0][0]), math.sqrt(float(plain[1][0, 0]))
    error = math.hypot(error, _rounding(record, plain[2]))
    quantile = float(student.ppf(0.975, _BLOCKS - 1))
    interval = (level - quantile * error, level + quantile * error)
    if rough and level < 3.0 * float(np.std(plain[2])) / math.sqrt(use.sum() / _BLOCKS):
        return _not_identifiable("friction", int(use.sum()), level, interval, speeds)
    if speeds[0] > top / _RANGE:
        return _not_identifiable("speeds", int(use.sum()), level, interval, speeds)
    low, high = np.minimum(np.abs(v), slow), np.maximum(np.abs(v) - slow, 0.0)
    solution, covariance, _ = _robust_regression(y, [direction, direction * low, direction * high, *nuisance], blocks)
    slopes, of_slopes = solution[1:3], covariance[1:3, 1:3]
    degrees = _BLOCKS - 1
    wald = float(slopes @ np.linalg.pinv(of_slopes, hermitian=True) @ slopes) / 2.0 * (degrees - 1) / degrees
    p = float(fisher.sf(wald, 2, degrees - 1))
    widths = quantile * np.sqrt(np.maximum(np.diag(of_slopes), 0.0))
    ends = [(float(s - w), float(s + w)) for s, w in zip(slopes, widths, strict=True)]
    return FrictionLaw(
        law=_classify(p, *ends),
        level=level,
        interval=interval,
        p_value=p,
        slow=float(slopes[0]),
        slow_interval=ends[0],
        fast=float(slopes[1]),
        fast_interval=ends[1],
        speeds=speeds,
        samples=int(use.sum()),
    )


def _classify(p: float, slow: tuple[float, float], fast: tuple[float, float]) -> Law:
    if p >= SURE:
        return "coulomb"
    if slow[1] < 0.0:
        return "stribeck"
    return "viscous" if fast[0] > 0.0 or slow[0] > 0.0 else "other"


def _not_identifiable(
    reason: Reason,
    samples: int,
    level: float = math.nan,
    interval: tuple[float, float] = (0.0, math.inf),
    speeds: tuple[float, float] = (0.0, 0.0),
) -> FrictionLaw:
    nothing = (-math.inf, math.inf)
    return FrictionLaw(
        "not identifiable", level, interval, math.nan, math.nan, nothing, math.nan, nothing, speeds, samples, reason
    )


def _robust_regression(y: Matrix, columns: list[Matrix], blocks: NDArray[np.int64]) -> tuple[Matrix, Matrix, Matrix]:
    """Least squares without outliers, the covariance from sums over blocks, and the residuals."""
    X = np.stack(columns, axis=1)
    size = np.linalg.norm(X, axis=0)
    X = X / np.where(size > 0.0, size, 1.0)
    weight = np.ones(y.size)
    for _ in range(3):
        solution = np.linalg.pinv(X * weight[:, None], rcond=1e-8) @ (weight * y)
        residual = y - X @ solution
        spread = float(np.quantile(np.abs(residual), 0.9)) / _NINETY or 1e-300
        weight = np.where(np.abs(residual) < _OUTLIER * spread, 1.0, 0.0)
    inverse = np.linalg.pinv((X * weight[:, None]).T @ X, rcond=1e-12, hermitian=True)
    scores = X * (weight * residual)[:, None]
    sums = np.stack([scores[blocks == block].sum(axis=0) for block in range(_BLOCKS)])
    together = inverse @ (sums.T @ sums) @ inverse * _BLOCKS / (_BLOCKS - 1)
    covariance = _larger(np.asarray(inverse * float(np.mean(weight * residual**2)), dtype=float), together)
    scale = np.where(size > 0.0, size, 1.0)
    return solution / scale, covariance / np.outer(scale, scale), residual


def _larger(independent: Matrix, together: Matrix) -> Matrix:
    """The second covariance, but in no direction less than the first, as few blocks may cause by chance."""
    values, vectors = np.linalg.eigh(independent)
    kept = values > 1e-12 * float(values.max())
    root = vectors[:, kept] * np.sqrt(values[kept])
    inverse = vectors[:, kept] / np.sqrt(values[kept])
    ratio, axes = np.linalg.eigh(inverse.T @ together @ inverse)
    return np.asarray(root @ (axes * np.maximum(ratio, 1.0)) @ axes.T @ root.T)


def _rounding(record: Record, residual: Matrix) -> float:
    """Largest bias [N] of a friction level by the resolution of a load cell with little noise.

    The first term of the mean of a rounded value with Gaussian noise (Widrow and Kollar 2008, section 9).
    """
    step = resolution(record.force)
    if step == 0.0:
        return 0.0
    noise = max(float(np.var(residual)) - step**2 / 12.0, 0.0)
    return step / math.pi * math.exp(-2.0 * math.pi**2 * noise / step**2)


def _away_from_reversals(motion: Motion) -> NDArray[np.bool_]:
    """Samples away from reversals, at more than 3 % of the largest speed."""
    near = np.abs(motion.velocity) <= 0.03 * float(np.abs(motion.velocity).max())
    return ~near


def _is_preloaded(motion: Motion, force: Matrix, level: float) -> NDArray[np.bool_]:
    """Samples at which the shaft is preloaded: in each stroke, beyond the travel that brings the force to its level."""
    direction = np.sign(motion.velocity)
    travels = []
    for start, stop in pairwise(_strokes(motion)):
        travel = np.abs(motion.displacement[start:stop] - motion.displacement[start])
        reached = np.flatnonzero(direction[start:stop] * force[start:stop] >= _REACHED * level)
        if reached.size and stop - start > 8:
            travels.append(float(travel[reached[0]]))
    return _beyond_travel(motion, _WOUND * float(np.median(travels)) if travels else math.inf)


def _windup_travel(device: Network) -> float:
    """Travel [m] that reverses the friction of a chain through its shaft."""
    chain = chain_of(device)
    if chain is None or chain.friction is None or chain.spring is None:
        return 0.0
    friction, spring = chain.friction.value, chain.spring.value
    assert not isinstance(friction, Free | Tied)
    assert not isinstance(spring, Free | Tied)
    return 2.0 * friction / spring


def _beyond_travel(motion: Motion, travel: float) -> NDArray[np.bool_]:
    """Samples that are further than `travel` [m] from the beginning of their stroke."""
    edges = _strokes(motion)
    use = np.zeros(motion.velocity.size, dtype=bool)
    for start, stop in pairwise(edges):
        use[start:stop] = np.abs(motion.displacement[start:stop] - motion.displacement[start]) > travel
    return use


def _strokes(motion: Motion) -> list[int]:
    """First samples of the strokes, and the end."""
    direction = np.sign(motion.velocity)
    return [0, *(np.flatnonzero(np.diff(direction)) + 1).tolist(), direction.size]
