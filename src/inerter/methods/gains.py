"""Gains of a simulated design: power spectra over random periods, and the largest smoothed gain."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, Status, StatusKind
from inerter.formatting import format_number
from inerter.methods.equivalent_linear import (
    EquivalentLinearModel,
    lower_peaks,
    modal_shares,
    relative_change,
    squares_above,
    travels_with_play,
)
from inerter.methods.excitation import ExcitedInputs
from inerter.methods.steady_squares import jump_scatter, number_of_lines, relative_bound
from inerter.norms.h2 import h2
from inerter.norms.hinf import GainPeak
from inerter.norms.response import modal_response
from inerter.simulation.inputs import check_holds
from inerter.simulation.observe import trajectory_of
from inerter.simulation.periodic_steady_state import recorded_period
from inerter.systems.linear import LinearSystem
from inerter.systems.piecewise import PiecewiseSystem

Array = NDArray[np.float64]
_UNSEEN = 5e-4  # of a mean square that harmonics may miss without a doubt
_REPEATS = 1e-4  # change of the state over a period, relative to its size, that leaves an estimate alone
_REFINED = 2  # times that a maximum is searched on a grid, each 64 times finer
_COMPARED = 2  # realisations that are simulated at twice their size


@dataclass(frozen=True, eq=False)
class LinearModel:
    """Equivalent linear model of a simulated motion, for one index definition."""

    system: LinearSystem
    norms: Array  # of its outputs
    status: Status
    missed: float  # share of a mean square that the harmonics of the period may miss
    unlike: float  # by what part of a mean square another motion would make it another design
    peaked: float  # share of a mean square by which harmonics are off that have lower peaks than a random motion
    pole: complex  # of the motion that outlasts the others
    faster: LinearSystem  # the model if all frictions slip twice as fast
    sticks: bool  # whether a friction sticks, in place of which a damper creeps over long times

    def squares(self, omega: Array) -> Array:
        """Squared gains (outputs, frequencies) from the road's velocity or the force."""
        return _squares(self.system, omega)

    def unseen(self, gains: Array, omega: Array) -> float:
        """Share of a mean square between the harmonics of the squared `gains` (outputs, harmonics).

        It is the share that harmonics may miss, as far as the motion differs from this model's.
        """
        if self.missed <= _UNSEEN:
            return self.missed
        total = np.maximum(gains.sum(axis=1), 1e-300)
        misfit = float(np.max(np.abs(self.squares(omega).sum(axis=1) / total - 1.0)))
        return float(self.missed * min(misfit + self.unlike, 1.0))

    def unsure_below(self, rest: Array, omega: Array) -> float:
        """Share of what the model adds to a gain below the harmonics that is not sure, as `rest` was not its own.

        `rest` (harmonics,) is what the squared gain of the first output has besides the model's.
        """
        lowest = omega[:2]
        own, faster = self.squares(lowest)[0], _squares(self.faster, lowest)[0]
        return float(min(np.max(np.abs(faster - own) / own) + abs(rest[0]) / own[0], 1.0))

    def above(self, gains: Array, omega: Array) -> tuple[float, Array]:
        """Mean square above the harmonics, by this model, over that of the squared `gains` (outputs, harmonics).

        Also the squares there (outputs,), in the units of squared norms.
        """
        squares = squares_above(self.system, float(omega[-1] + 0.5 * omega[0]))
        inside = omega[0] / np.pi * gains.sum(axis=1)
        return float(np.max(squares / np.maximum(inside, 1e-300))), squares


def linear_model(linear: EquivalentLinearModel, speeds: Array, period: float) -> LinearModel:
    """The model for a motion with these r.m.s. velocities across the frictions that repeats after `period` [s]."""
    system = linear.system(speeds)
    whole = h2(system, linear.problem.pade_order)
    faster, sticks = linear.system(2.0 * speeds), linear.sticks(speeds)
    if not whole.status.ok:
        return LinearModel(system, whole.outputs, whole.status, math.inf, math.inf, math.inf, 0j, faster, sticks)
    modes, unlike = modal_shares(system, whole.outputs), linear.unlike(speeds, whole.outputs)
    left, pole = modes.remaining(period)
    peaked = modes.lower_peaks(period, unlike)
    return LinearModel(system, whole.outputs, whole.status, 2.0 * left, unlike, peaked, pole, faster, sticks)


def _squares(system: LinearSystem, omega: Array) -> Array:
    """Squared gains (outputs, frequencies) from the first input of a system."""
    return np.asarray(np.abs(modal_response(system, omega)[:, :, 0].T) ** 2)


@dataclass(eq=False)
class Runs:
    """Power spectra of some outputs of a design, with realisations simulated on demand."""

    system: PiecewiseSystem
    drive: ExcitedInputs
    outputs: tuple[str, ...]
    frictions: tuple[str, ...]  # velocities across them
    seed: int
    squares: list[Array] = field(default_factory=list)  # (outputs, harmonics)
    inputs: list[Array] = field(default_factory=list)  # (harmonics,)
    powers: list[Array] = field(default_factory=list)  # mean squares of the velocities (frictions,)
    scatter: list[Array] = field(default_factory=list)  # by jumps of the outputs between samples (outputs,)
    over_lines: list[float] = field(default_factory=list)  # one over the fewest lines in a travel with backlash
    status: Status = OK
    warning: Status = OK
    mismatch: float = 0.0  # the largest change of the state over a period that was recorded, relative to its size
    remaining: float = 0.0  # the largest share of a motion that remains after a period
    larger: Runs | None = None  # the same realisations at twice the size
    change: float = 0.0  # of a mean square by that size

    def upto(self, count: int) -> tuple[Array, Array]:
        """Squared sizes of outputs (realisations, outputs, harmonics) and of the input (realisations, harmonics).

        Of the first `count` realisations, or fewer if one had to stop, which `status` then tells.
        """
        while len(self.squares) < count and self.status.ok:
            self._add(len(self.squares))
        return np.array(self.squares), np.array(self.inputs)

    @property
    def speeds(self) -> Array:
        """R.m.s. velocities across the frictions so far [m/s]."""
        return np.asarray(np.sqrt(np.mean(self.powers, axis=0)))

    def sampling_error(self, places: Sequence[int], factor: Array) -> float:
        """Relative error from sampling of r.m.s. values of squared gains times `factor` (outputs, harmonics).

        That of the worst realisation: what is folded onto low harmonics adds to all of them.
        """
        samples, shares = self.drive.excitation.samples, []
        for squares, power, scatter in zip(self.squares, self.inputs, self.scatter, strict=True):
            passed = factor / power
            lines = 2.0 * squares[list(places)] / samples**2
            with np.errstate(divide="ignore", invalid="ignore"):
                sizes = (lines * passed).sum(axis=1) / np.sqrt((lines * passed**2).sum(axis=1))
            shares.append(relative_bound(scatter[list(places)], sizes))
        return float(np.max(shares, initial=0.0))

    def peaked_by_play(self, places: Sequence[int], factor: Array) -> float:
        """Share of a mean square by which it may be off with backlash, as harmonics have lower peaks than random input.

        The mean square is of the outputs at `places`, of squared gains times `factor` (outputs, harmonics). Its change
        is that of the motion under an excitation twice as large; infinite where that cannot be simulated.
        """
        if not self.over_lines or self.drive.excitation.is_held:
            return 0.0
        if self.larger is None:
            self.larger = Runs(
                self.system, replace(self.drive, rms=2.0 * self.drive.rms), self.outputs, self.frictions, self.seed
            )
        sums = []
        for runs in (self, self.larger):
            squares, inputs = runs.upto(_COMPARED)
            if not runs.status.ok:
                return math.inf
            gains = squares[:_COMPARED, list(places)].sum(axis=0) / inputs[:_COMPARED].sum(axis=0)
            sums.append((gains * factor).sum(axis=1))
        self.change = relative_change(sums[1], sums[0])
        return lower_peaks(self.change, float(np.mean(self.over_lines)))

    @property
    def unsettled(self) -> float:
        """Relative error by realisations, none of which is known, that reach no periodic steady state.

        Some may where those at twice the size do not. After n that all reach one, the next does not with a probability
        of 1 / (n + 2), by Laplace's rule of succession; its mean square may change by as much as at twice the size.
        """
        if self.larger is None or self.larger.warning.ok:
            return 0.0
        return max(self.change, 1.0) / (len(self.squares) + 2.0)

    def _add(self, number: int) -> None:
        seed = int(np.random.SeedSequence([self.seed, number]).generate_state(1)[0])
        if number == 0:
            check_holds(self.system, self.drive.signals(seed))
        table, power = self.drive.realisation(seed)
        run, mismatch, remaining = recorded_period(self.system, table)
        if not run.status.ok:
            self.status = Status(StatusKind.FAILED, f"realisation {number + 1}: {run.status.message}")
            return
        self.mismatch, self.remaining = max(self.mismatch, mismatch), max(self.remaining, remaining)
        if mismatch > _REPEATS:
            self.warning = Status(
                StatusKind.INACCURATE,
                f"periodic steady state not reached in realisation {number + 1}: relative change of state per period "
                f"{format_number(mismatch, 2)}; use a longer period",
            )
        trajectory = trajectory_of(run, None, "")
        self.squares.append(np.array([self.drive.power(trajectory[name]) for name in self.outputs]))
        self.inputs.append(power)
        self.scatter.append(jump_scatter(run, self.outputs))
        self.powers.append(np.array([np.mean(trajectory[name][:-1] ** 2) for name in self.frictions]))
        travels = [np.abs(np.fft.rfft(trajectory[name][:-1])) ** 2 for name in travels_with_play(self.system)]
        if travels:
            self.over_lines.append(float(np.max(1.0 / number_of_lines(np.array(travels)))))


@dataclass(frozen=True, eq=False)
class LargestGain:
    """The largest gain, with the local maxima, the highest first."""

    gain: float
    deviations: Array  # of each realisation (realisations,)
    peaks: tuple[GainPeak, ...]
    below: float  # what it may be off, relative to it, as nothing below the lowest harmonic is simulated


def largest_gain(
    rest: Array, lines: Array | None, known: LinearModel | None, omega: Array, window: Array
) -> LargestGain:
    """The largest gain of squared gains less those of the linear model, `rest` (realisations, harmonics).

    They are smoothed; the squared gains of the model, `lines`, are not, and between harmonics too they are known, as
    below the lowest one unless a friction sticks.
    """
    share = np.convolve(np.ones(omega.size), window, "same")
    smooth = np.array([np.convolve(row, window, "same") for row in rest]) / share
    mean = smooth.mean(axis=0)
    total = mean if lines is None else mean + lines[0]

    def between(at: Array) -> Array:
        """Squared gains at any frequencies of the band."""
        linear = 0.0 if known is None else known.squares(at)[0]
        return np.asarray(np.maximum(np.interp(at, omega, mean) + linear, 0.0))

    found = sorted((_refine_maximum(between, omega, i) for i in _summits(total, window.size)), key=_by_height)
    inside, below = found[0], 0.0
    if known is not None and not known.sticks:
        lowest = _refine_maximum(between, np.array([0.0, 0.5 * omega[0], omega[0]]), 1)
        found = sorted([*found, lowest], key=_by_height)
        if lowest.gain > inside.gain:
            below = (1.0 - inside.gain / lowest.gain) * known.unsure_below(mean, omega)
    elif inside.omega < omega[1]:  # to zero it may rise by no more than it fell to the next harmonic
        first, second = np.sqrt(between(omega[:2]))
        below = float(max(1.0 - second / max(first, 1e-300), 0.0))
    best = found[0]
    deviations = np.array([np.interp(best.omega, omega, row) for row in smooth - mean])
    return LargestGain(best.gain, deviations / (2.0 * max(best.gain, 1e-300)), tuple(found), below)


def _by_height(peak: GainPeak) -> float:
    return -peak.gain


def _summits(values: Array, reach: int) -> list[int]:
    """Places of values that are the largest within `reach` to both sides, and not below a quarter of the largest."""
    high = np.flatnonzero(values >= 0.25 * values.max())
    return [int(i) for i in high if values[i] >= values[max(i - reach, 0) : i + reach + 1].max()]


def _refine_maximum(squares: Callable[[Array], Array], omega: Array, i: int) -> GainPeak:
    """The maximum between the neighbours of a harmonic."""
    at = omega[[max(i - 1, 0), min(i + 1, omega.size - 1)]]
    for _ in range(_REFINED):
        low, high = at[0], at[-1]
        at = np.linspace(low, high, 129)
        values = squares(at)
        best = int(np.argmax(values))
        found = GainPeak(float(at[best]), float(np.sqrt(values[best])))
        at = at[max(best - 1, 0) : best + 2]
    return found
