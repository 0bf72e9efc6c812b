"""Gains of a simulated design: power spectra over random periods, and the largest smoothed gain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, Status, StatusKind
from inerter.methods.excitation import Drive
from inerter.norms.hinf import Peak
from inerter.norms.response import frequency_response
from inerter.simulation.inputs import check_holds
from inerter.simulation.observe import trajectory_of
from inerter.simulation.steady import recorded_period
from inerter.systems.linear import LinearSystem
from inerter.systems.piecewise import PiecewiseSystem

Array = NDArray[np.float64]
_REPEATS = 1e-4  # change of the state over a period, relative to its size, that leaves an estimate alone


@dataclass(frozen=True, eq=False)
class LinearModel:
    """What is known of the linear model of a design for one question."""

    system: LinearSystem
    norms: Array  # of its outputs; infinite for a peak gain, which needs none
    slowest: float  # rate of its slowest motion [rad/s]
    status: Status

    def squares(self, omega: Array) -> Array:
        """Squared gains (outputs, frequencies) from the road's velocity or the force."""
        return np.asarray(np.abs(frequency_response(self.system, omega)[:, :, 0].T) ** 2)


@dataclass(eq=False)
class Runs:
    """Power spectra of some outputs of a design, one realisation after the other as they are asked for."""

    system: PiecewiseSystem
    drive: Drive
    outputs: tuple[str, ...]
    seed: int
    squares: list[Array] = field(default_factory=list)  # (outputs, harmonics)
    inputs: list[Array] = field(default_factory=list)  # (harmonics,)
    status: Status = OK
    warning: Status = OK

    def upto(self, count: int) -> tuple[Array, Array]:
        """Squared sizes of outputs (realisations, outputs, harmonics) and of the input (realisations, harmonics).

        Of the first `count` realisations, or fewer if one had to stop, which `status` then tells.
        """
        while len(self.squares) < count and self.status.ok:
            self._add(len(self.squares))
        return np.array(self.squares), np.array(self.inputs)

    def _add(self, number: int) -> None:
        seed = int(np.random.SeedSequence([self.seed, number]).generate_state(1)[0])
        if number == 0:
            check_holds(self.system, self.drive.signals(seed))
        table, power = self.drive.realisation(seed)
        run, mismatch = recorded_period(self.system, table)
        if not run.status.ok:
            self.status = Status(StatusKind.FAILED, f"realisation {number + 1}: {run.status.message}")
            return
        if mismatch > _REPEATS:
            self.warning = Status(
                StatusKind.INACCURATE,
                f"in realisation {number + 1} the state still changes by {mismatch:.1e} of its size over a period; "
                f"take a longer one",
            )
        trajectory = trajectory_of(run, None, "")
        self.squares.append(np.array([self.drive.power(trajectory[name]) for name in self.outputs]))
        self.inputs.append(power)


def largest_gain(
    rest: Array, lines: Array | None, known: LinearModel | None, omega: Array, window: Array
) -> tuple[float, Array, tuple[Peak, ...]]:
    """The largest gain, its deviation in each realisation, and the local maxima, the highest first.

    Squared gains less those of the linear model, `rest` (realisations, harmonics), are smoothed; those of the model,
    `lines`, are not, and between harmonics too they are known.
    """
    share = np.convolve(np.ones(omega.size), window, "same")
    smooth = np.array([np.convolve(row, window, "same") for row in rest]) / share
    mean = smooth.mean(axis=0)
    total = mean if lines is None else mean + lines[0]

    def between(at: Array) -> Array:
        """Squared gains at any frequencies of the band."""
        linear = 0.0 if known is None else known.squares(at)[0]
        return np.asarray(np.maximum(np.interp(at, omega, mean) + linear, 0.0))

    found = sorted((_refined(between, omega, i) for i in _summits(total, window.size)), key=lambda peak: -peak.gain)
    best = found[0]
    deviation = np.array([np.interp(best.omega, omega, row) for row in smooth - mean])
    return best.gain, deviation / (2.0 * max(best.gain, 1e-300)), tuple(found)


def _summits(values: Array, reach: int) -> list[int]:
    """Places of values that are the largest within `reach` to both sides, and not below a quarter of the largest."""
    high = np.flatnonzero(values >= 0.25 * values.max())
    return [int(i) for i in high if values[i] >= values[max(i - reach, 0) : i + reach + 1].max()]


def _refined(squares: Callable[[Array], Array], omega: Array, i: int) -> Peak:
    """The maximum between the neighbours of a harmonic."""
    at = np.linspace(omega[max(i - 1, 0)], omega[min(i + 1, omega.size - 1)], 129)
    values = squares(at)
    best = int(np.argmax(values))
    return Peak(float(at[best]), float(np.sqrt(values[best])))
