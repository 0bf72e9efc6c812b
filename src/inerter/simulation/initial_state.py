"""Initial state of a simulation: given, at the end of another run, or at rest."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SimulationError
from inerter.simulation.statics import equilibrium
from inerter.simulation.trajectory import FinalState, Trajectory
from inerter.systems.piecewise import PiecewiseSystem
from inerter.validation import real_numbers

Matrix = NDArray[np.float64]
_KEPT = 16  # systems
Initial = Literal["rest", "preload", "periodic"] | Trajectory | Matrix


def initial_state(system: PiecewiseSystem, inputs: Matrix, initial: Initial, rates: Matrix | None = None) -> Matrix:
    """The state to start from, over these heights of the roads [m] and forces [N].

    `rates` [m/s, N/s] are those with which they set out from rest; none if they are left out.

    Raises `SimulationError` for a request that is not known, or a state that does not fit.
    """
    roads, n = len(system.mechanism.roads), system.order
    if isinstance(initial, Trajectory):
        given = initial.final_state
    elif isinstance(initial, str):
        if initial not in ("rest", "preload", "periodic"):
            raise SimulationError(
                f'The initial state is "rest", "preload", "periodic", a trajectory or an array, got {initial!r}.'
            )
        force = inputs[roads:] if initial == "preload" else np.zeros_like(inputs[roads:])
        moving = np.zeros(roads) if rates is None else rates[:roads]
        given = np.concatenate([_starting_velocities(system, moving), _positions(system, inputs[:roads], force)])
    else:
        numbers = real_numbers(initial)
        if numbers is None:
            raise SimulationError(f"The initial state is an array of {n} numbers, got {initial!r}.")
        given = np.array(numbers)
    if given.shape != (n,) or not np.all(np.isfinite(given)):
        raise SimulationError(
            f"The initial state needs {n} finite numbers ({', '.join(system.states)}), got {given.tolist()}."
        )
    return np.asarray(given)


def ending_of(initial: Initial) -> FinalState | None:
    """Final contact state of the event-driven run from which this one continues; None if there is none."""
    ending = initial._ending if isinstance(initial, Trajectory) else None
    return ending if isinstance(ending, FinalState) else None


def _starting_velocities(system: PiecewiseSystem, rates: Matrix) -> Matrix:
    """Velocities when roads have just set off at these rates, with everything at rest before.

    What inertia alone ties to a road goes with it at once: of all motions a blow leaves that of least kinetic energy.
    """
    given = system.kinetic_road @ rates if rates.any() else rates
    if not given.any():
        return np.zeros(system.kinetic.shape[1])
    momenta = system.kinetic.T * system.inertia
    return np.asarray(-np.linalg.solve(momenta @ system.kinetic, momenta @ given))


@lru_cache(maxsize=_KEPT)
def may_lie_unstrained(system: PiecewiseSystem) -> bool:
    """Whether nothing that switches has a force, or an elongation, at any rest."""
    limits = system.mechanics.limits
    return bool(np.all((limits[:, 0] <= 0.0) & (limits[:, 1] >= 0.0)))


@lru_cache(maxsize=_KEPT)
def _are_elongations(system: PiecewiseSystem) -> bool:
    """Whether every position is the elongation of an element."""
    own = np.array(system.kinematics.places.own)
    return bool(np.count_nonzero(own >= 0) == system.positions.shape[0])


def _positions(system: PiecewiseSystem, road: Matrix, force: Matrix) -> Matrix:
    """Positions at rest; those that are elongations have none of the rounding of heights."""
    if may_lie_unstrained(system) and not force.any():
        is_flat = not road.any() or (_are_elongations(system) and not (system.elongations[1] @ road).any())
        if is_flat:
            return np.zeros(system.positions.shape[0])
    own, found = np.array(system.kinematics.places.own), equilibrium(system, road, force)
    g = system.positions @ found.displacement + system.heights @ road
    g[own[own >= 0]] = found.elongation[own >= 0]
    return np.asarray(g)
