"""Initial state of a simulation: given, at the end of another run, or at rest."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SimulationError
from inerter.simulation.statics import equilibrium
from inerter.simulation.trajectory import FinalState, Trajectory
from inerter.systems.piecewise import PiecewiseSystem
from inerter.validation import real_numbers

Matrix = NDArray[np.float64]
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
        force = inputs[roads:] if initial == "preload" else np.zeros(inputs.size - roads)
        moving = np.zeros(roads) if rates is None else rates[:roads]
        given = np.concatenate([_starting_velocities(system, moving), _positions(system, inputs[:roads], force)])
    else:
        numbers = real_numbers(initial)
        if numbers is None:
            raise SimulationError(f"The initial state is an array of {n} numbers, got {initial!r}.")
        given = np.array(numbers)
    if given.shape != (n,) or np.count_nonzero(np.isfinite(given)) < n:
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
    given = system.kinetic_road.dot(rates)
    if not np.count_nonzero(given):
        return np.zeros(system.kinetic.shape[1])
    momenta = system.kinetic.T * system.inertia
    return np.asarray(-np.linalg.solve(momenta @ system.kinetic, momenta @ given))


def may_lie_unstrained(system: PiecewiseSystem) -> bool:
    """Whether nothing that switches has a force, or an elongation, at any rest."""
    return all(lower <= 0.0 <= upper for lower, upper in system.limits.tolist())


def _positions(system: PiecewiseSystem, road: Matrix, force: Matrix) -> Matrix:
    """Positions at rest; those that are elongations have none of the rounding of heights."""
    if may_lie_unstrained(system) and not np.count_nonzero(force):
        strained = system.elongations[1].dot(road) if system.kinematics.are_elongations else road
        if not np.count_nonzero(strained):
            return np.zeros(system.positions.shape[0])
    own, found = system.kinematics.own_elongations, equilibrium(system, road, force)
    g = system.positions @ found.displacement + system.heights @ road
    g[own[own >= 0]] = found.elongation[own >= 0]
    return np.asarray(g)
