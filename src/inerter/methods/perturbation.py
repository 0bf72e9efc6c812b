"""First-order effect of friction: the linear motion determines the sign of the friction force, which perturbs it.

With the friction's force f sgn(v) of the frictionless velocity v as an input, an output y changes by dy, its mean
square by 2 <y, dy> and a sum of weighted r.m.s. values by the sum of w <y, dy> / r.m.s.(y). This costs two Fourier
transforms for a road, and explains most of what one road does that another does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from inerter.indices.definition import IndexDefinition
from inerter.kernels.arrays import FRICTION, KIND
from inerter.methods.realisations import RandomExcitation, table
from inerter.signals.harmonics import multisine
from inerter.signals.road import Road
from inerter.simulation import event_driven
from inerter.simulation.event_driven import Integration
from inerter.systems.piecewise import PiecewiseSystem, output_rows

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
_HIGHEST = 100.0  # [Hz] of the road's lines: what moves a vehicle lies below
_TIMES = 8  # at least, a period of the highest line
_TOGETHER = 2**15  # times of several roads at once: few enough for a cache
_KEPT = 128  # such groups: those of many roads of the usual length, of 64 KB each


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """The change of an index of r.m.s. values by friction, to first order, on one road."""

    excitation: RandomExcitation
    velocities: Complex  # (lines, frictions) across the frictions, for a line of the road of 1 m
    effects: Complex  # (lines, frictions) of a line of sgn(v) on the index, for a line of the road of 1 m

    def __call__(self, seeds: Sequence[int]) -> Array:
        """The change on the roads of realisations' seeds (seeds,), in the unit of the index."""
        size = max(_TOGETHER // self._times, 1)
        parts = [seeds[i : i + size] for i in range(0, len(seeds), size)]
        return np.concatenate([self._changes(part) for part in parts]) if parts else np.zeros(0)

    def _changes(self, seeds: Sequence[int]) -> Array:
        road, period, total = self.excitation.road, self.excitation.period, np.zeros(len(seeds))
        for velocity, effect in zip(self.velocities.T, self.effects.T, strict=True):
            total += np.real(sides_of(road, period, tuple(seeds), self._times, velocity.tobytes()) @ effect)
        return total

    @property
    def _times(self) -> int:
        """Number of time samples per period, a power of two."""
        lines = int(self.velocities.shape[0])
        return 1 << (_TIMES * lines - 1).bit_length()


@lru_cache(maxsize=1024)
def _lines(road: Road, period: float, count: int, seed: int) -> Complex:
    """Complex amplitudes of the lowest `count` spectral lines of a realisation."""
    return multisine(road, seed, lowest=1.0 / period, highest=count / period).coefficient


@lru_cache(maxsize=_KEPT)
def sides_of(road: Road, period: float, seeds: tuple[int, ...], times: int, velocity: bytes) -> Complex:
    """Lines (seeds, lines) of sgn(v), times those of the road, from those of v for a line of the road of 1 m.

    They do not depend on the force of the friction, by which a break-even value is sought.
    """
    per_line = np.frombuffer(velocity, dtype=complex)
    lines = per_line.size
    roads = np.array([_lines(road, period, lines, seed) for seed in seeds])
    spectrum = np.zeros((len(seeds), times // 2 + 1), dtype=complex)
    spectrum[:, 1 : lines + 1] = per_line * roads
    sides = np.sign(np.fft.irfft(spectrum, times))
    return np.asarray(np.conj(roads) * (np.fft.rfft(sides)[:, 1 : lines + 1] * (2.0 / times)))


def first_order(
    system: PiecewiseSystem, definition: IndexDefinition, excitation: RandomExcitation
) -> FirstOrder | None:
    """The first-order effect of every friction.

    None if a gap is there, if a part is loose without friction, if what moves is not one road alone, or if a friction
    differs by its direction.
    """
    kinds, (lower, upper) = system.kinematics.elements[:, KIND], system.limits.T
    if excitation.delays is None or not np.any(lower < upper) or np.any(lower != -upper):
        return None
    if np.any(upper[kinds != FRICTION] > 0.0):
        return None
    count, n, nu = upper.size, system.order, system.inputs
    integration = event_driven.start(system, table(excitation, 0), np.zeros(n))
    slip, forces = _slipping(integration)
    signal = excitation.signal(0)
    lines = round(_HIGHEST * excitation.period)
    omega = 2.0 * np.pi * signal.frequencies[:lines]
    amplitudes = signal.amplitudes[:lines]
    path = np.exp(-1j * np.outer(omega, excitation.delays))
    inputs = np.zeros((omega.size, nu), dtype=complex)
    for order in range(3):
        inputs[:, order * len(excitation.delays) : (order + 1) * len(excitation.delays)] = (
            path * (1j * omega[:, None]) ** order
        )
    try:
        resolvent = np.linalg.inv(1j * omega[:, None, None] * np.eye(n) - slip[:n, :n])
    except np.linalg.LinAlgError:
        return None
    states = np.einsum("kij,kj->ki", resolvent, inputs @ slip[:n, n : n + nu].T)
    on_columns, on_eta = _over_slip(system, definition)
    rows = on_columns + on_eta @ slip[integration.eta]
    direct = on_eta @ forces[integration.eta]
    outputs = states @ rows[:, :n].T + inputs @ rows[:, n : n + nu].T
    responses = np.einsum("oi,kij,jf->kof", rows[:, :n], resolvent, forces[:n]) + direct
    for i, one in enumerate(definition.filters):
        if one is not None:
            passed = one.response(omega)
            outputs[:, i] *= passed
            responses[:, i] *= passed[:, None]
    guards = slip[integration.guards]
    velocities = states @ guards[:, :n].T + inputs @ guards[:, n : n + nu].T
    power = 0.5 * (np.abs(outputs) ** 2 * amplitudes[:, None] ** 2).sum(axis=0)
    if not np.all(np.isfinite(power)) or not np.all(power > 0.0) or count == 0:
        return None
    sizes, given = np.sqrt(power), np.array([abs(output.weight) for output in definition.outputs])
    weights = definition.slopes(sizes, given) / (2.0 * sizes)
    effects = np.einsum("o,ko,kof->kf", weights, np.conj(outputs), responses)
    return FirstOrder(excitation, velocities, effects)


def _over_slip(system: PiecewiseSystem, definition: IndexDefinition) -> tuple[Array, Array]:
    """The outputs as rows over (state, inputs, 1), and over eta."""
    rows = [output_rows(system, system.outputs[output.output]) for output in definition.outputs]
    columns = np.array([np.concatenate([on_x, on_u, [0.0]]) for on_x, on_u, _ in rows])
    return columns, np.array([on_eta for _, _, on_eta in rows])


def _slipping(integration: Integration) -> tuple[Array, Array]:
    """The maps of the mode in which every friction slips up, without friction's force; and the force's own effect."""
    count = len(integration.system.nonlinear)
    sides = np.ones((count + 1, count), dtype=np.int64)
    sides[np.arange(count), np.arange(count)] = -1
    maps = np.array([integration.mode(row) for row in sides])
    forces = 0.5 * (maps[-1, :, -1] - maps[:-1, :, -1])
    return maps[-1], forces.T
