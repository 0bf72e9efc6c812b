"""Equivalent linear model of a simulated motion: each friction a damper of the force and r.m.s. velocity found.

The dampers are those of statistical linearisation (see `equivalent_damper`), for the r.m.s. velocity of the simulated
motion, so that no assumption decides what sticks. Gaps are closed. The model gives the response between the lines of a
multisine, and the time for which a design remembers its input.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import ErrorSource, LinearSystemError, MechanismError
from inerter.formatting import format_list
from inerter.indices.definition import IndexDefinition
from inerter.methods.equivalent import Equivalent, equivalent, slipping_freely
from inerter.methods.equivalent_damper import GAUSSIAN
from inerter.methods.linear import Conventions, LinearProblem, linear_problem
from inerter.networks.elements import Element
from inerter.norms.h2 import h2
from inerter.norms.response import rounded_response
from inerter.norms.stability import balance
from inerter.systems.descriptor import close, describe
from inerter.systems.input_paths import inputs_of
from inerter.systems.linear import LinearSystem
from inerter.systems.output_filters import with_output_filters
from inerter.systems.outputs import Output, of_mount
from inerter.systems.piecewise import PiecewiseSystem
from inerter.vehicle.mechanism import Mechanism, Strut, Tyre

Array = NDArray[np.float64]
_STUCK = 1e6  # times a typical damper is as good as stuck: more would only cost digits
_DECADES, _ABOVE = 4.0, 4001  # above a frequency, and frequencies there
_PEAKED = 1.6  # error of a mean square by lines without the peaks of a road, see `ModalShares.over_lines` and 0011
_DRIFT = 1e-3  # a motion that changes by less over the time asked about is a drift, which `h2` judges


def with_velocities(system: PiecewiseSystem) -> tuple[PiecewiseSystem, tuple[str, ...]]:
    """`system` with the velocities across its frictions with a force as outputs, and their names."""
    branches = (system.graph.branches[i] for i in sorted(i for group in system.nonlinear for i in group))
    across = {
        f"velocity across friction {i}": Output("", "m/s", "", velocity=branch.nodes, road_velocity=branch.roads)
        for i, branch in enumerate(branches)
        if branch.element.is_damped
    }
    return replace(system, outputs={**system.outputs, **across}), tuple(across)


def has_play(system: PiecewiseSystem) -> bool:
    """Whether an element switches that no damper represents, as a gap."""
    return bool(travels_with_play(system))


def travels_with_play(system: PiecewiseSystem) -> tuple[str, ...]:
    """Names of the travels of mounts with an element that switches and that no damper represents, as a gap."""
    return tuple(of_mount(mount)[1] for mount in system.mechanism.mounts() if _without_damper(mount))


def format_elements_with_play(system: PiecewiseSystem) -> str:
    """Elements that switch and that no damper represents, such as `gap 'g' in 'strut'`."""
    mounts = system.mechanism.mounts()
    return format_list([f"{e.key} {e.label!r} in {mount.name!r}" for mount in mounts for e in _without_damper(mount)])


def _without_damper(mount: Strut | Tyre) -> list[Element]:
    return [element for element in mount.network.elements() if element.acts and not element.is_damped]


@dataclass(frozen=True, eq=False)
class EquivalentLinearModel:
    """Linear problem of an index of a mechanism whose frictions are dampers, for any r.m.s. velocities across them."""

    problem: LinearProblem
    parts: Equivalent

    def system(self, speeds: Array) -> LinearSystem:
        """The linear system for r.m.s. velocities [m/s] across all frictions with a force; those at zero stick."""
        return self.problem.system(close(self.problem.descriptor, self._dampers(speeds)))

    def at_inputs(self, speeds: Array) -> LinearSystem:
        """Equivalent linear model with the inputs of the mechanism instead of the sources."""
        if inputs_of(self.problem.paths) == self.problem.unfiltered.inputs:  # each is a source
            return close(self.problem.descriptor, self._dampers(speeds))
        names = [output.output for output in self.problem.definition.outputs]
        paths = self.problem.definition.input_paths(self.mechanism)
        descriptor = with_output_filters(
            describe(self.mechanism, inputs_of(paths), names), self.problem.definition.filters
        )
        return close(descriptor, self._dampers(speeds))

    def is_road(self, name: str) -> bool:
        """Whether an input is a road."""
        return any(road.name == name for road in self.mechanism.roads)

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism with dampers that is driven."""
        return self.problem.definition.drive.excited_mechanism(self.parts.mechanism)

    def sticks(self, speeds: Array) -> bool:
        """Whether a friction is as good as stuck: over long times its damper creeps, which the friction does not."""
        return bool(np.any(speeds[list(self.parts.numbers)] <= self._slowest))

    @property
    def _slowest(self) -> Array:
        """R.m.s. velocities [m/s] below which frictions count as stuck."""
        return np.asarray(GAUSSIAN.force(np.array(self.parts.forces, dtype=float)) / (_STUCK * self.parts.scale))

    def _dampers(self, speeds: Array) -> dict[str, float]:
        frictions = np.array(self.parts.forces, dtype=float)
        dampings = GAUSSIAN.damping(frictions, np.maximum(speeds[list(self.parts.numbers)], self._slowest))
        return dict(zip(self.parts.dampers, dampings.tolist(), strict=True))

    def unlike(self, speeds: Array, norms: Array) -> float:
        """Relative change of the mean squares if all slip velocities double; `norms` are those at `speeds`."""
        system = self.system(2.0 * speeds)
        other = self.problem.correct_norms(system, h2(system, self.problem.pade_order).outputs)[0]
        return relative_change(other**2, norms**2)


def relative_change(values: Array, references: Array) -> float:
    """Largest |value / reference - 1| of the outputs that move at all, which those on one side of a symmetry do not."""
    moving = references > 0.0
    return float(np.nanmax(np.abs(values[moving] / references[moving] - 1.0), initial=0.0))


def equivalent_linear_model(
    mechanism: Mechanism, definition: IndexDefinition, conventions: Conventions
) -> EquivalentLinearModel | None:
    """Equivalent linear model of a design without free values; None if it is ill-posed."""
    try:
        parts = equivalent(mechanism, slipping_freely(mechanism, definition))
        return EquivalentLinearModel(linear_problem(parts.mechanism, definition, conventions), parts)
    except (MechanismError, LinearSystemError):
        return None


def squares_above(system: LinearSystem, omega: float) -> Array:
    """Part of the squared H2 norms (outputs,) of a stable system that is above `omega` [rad/s]."""
    beyond = omega * np.logspace(0.0, _DECADES, _ABOVE)
    density = np.sum(np.abs(rounded_response(system, beyond)) ** 2, axis=2).T * beyond
    end = density[:, -1]  # beyond the last frequency the squares fall as 1 / omega^2
    return np.asarray((scipy.integrate.trapezoid(density, np.log(beyond), axis=1) + end) / np.pi)


@dataclass(frozen=True, eq=False)
class ModalShares:
    """Share (outputs, modes) of each mode, taken by itself, in the mean squares of outputs, and the poles."""

    shares: Array
    poles: NDArray[np.complex128]
    known: bool = True  # False where poles coincide to the last bit: no mode stands for itself

    def remaining(self, time: float) -> tuple[float, complex]:
        """Largest share of an r.m.s. value due to the motion `time` [s] ago, and the pole that carries most of it.

        Each mode decays at its own rate. The power that lines 1/T Hz apart find in a response is off by twice its
        memory of T at most.
        """
        if not self.poles.size:
            return 0.0, -np.inf
        if not self.known:
            return 1.0, complex(self.poles[np.argmax(self.poles.real)])
        left = self.shares * np.exp(2.0 * np.minimum(self.poles.real, -1e-300) * time)
        left[:, np.abs(self.poles) * time < _DRIFT] = 0.0
        worst = int(np.argmax(left.max(axis=0)))
        return float(np.sqrt(min(left.sum(axis=1).max(), 1.0))), complex(self.poles[worst])

    def lower_peaks(self, period: float, change: float) -> float:
        """Share of a mean square by which it may be off, as lines 1/T Hz apart have lower peaks than a random motion.

        `change` is that of the mean square if all frictions slip twice as fast.
        """
        return lower_peaks(change, self.over_lines(period))

    def over_lines(self, period: float) -> float:
        """Largest sum of the shares in a mean square, each over the number of lines 1/T Hz apart in its resonance.

        A resonance with the decay rate a has a T lines. Lines with the mean squares s_k make a motion whose fourth
        cumulant is -3/2 times the sum of s_k^2: on n equal lines the mean of |v| is larger by 1 / (16 n) than that of a
        Gaussian motion with the same r.m.s. velocity, so that a friction dissipates more.
        """
        lines = np.maximum(-self.poles.real * period, 1.0)
        lines[np.abs(self.poles) * period < _DRIFT] = np.inf
        return float((np.minimum(self.shares, 1.0) / lines).sum(axis=1).max(initial=0.0))


def lower_peaks(change: float, over_lines: float) -> float:
    """Share of a mean square by which it may be off, as lines have lower peaks than a random motion.

    `change` is its relative change when the motion is twice as large, `over_lines` one over the number of lines in a
    resonance.
    """
    return _PEAKED * change * over_lines


def few_lines(share: float) -> ErrorSource:
    """Error source of an r.m.s. value whose mean square may be off by a `share` (see `lower_peaks`)."""
    return ErrorSource("few lines in a resonance", 0.5 * share)


def modal_shares(system: LinearSystem, norms: Array) -> ModalShares:
    """Shares of the modes of a system in the mean squares of its outputs, which have these H2 `norms`."""
    A, scale = balance(system.A)
    if not A.size:
        return ModalShares(np.zeros((norms.size, 0)), np.zeros(0, complex))
    poles, vectors = np.linalg.eig(A)
    try:
        excited = np.linalg.norm(np.linalg.solve(vectors, (system.B / scale[:, None]).astype(complex)), axis=1)
    except np.linalg.LinAlgError:
        return ModalShares(np.ones((norms.size, poles.size)), poles, known=False)
    seen = np.abs(system.C * scale @ vectors) / np.where(norms > 0.0, norms, np.inf)[:, None]
    return ModalShares((seen * excited) ** 2 / (2.0 * np.maximum(-poles.real, 1e-300)), poles)
