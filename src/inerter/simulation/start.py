"""Where a simulation starts: given, or in static equilibrium over roads at rest."""

from __future__ import annotations

from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SimulationError
from inerter.networks.elements import Gap, Spring
from inerter.simulation.trajectory import Trajectory
from inerter.systems.piecewise import PiecewiseSystem

Matrix = NDArray[np.float64]
Initial = Literal["rest", "preload", "periodic"] | Trajectory | Matrix
_BALANCED = 1e-8  # of the largest force


def initial_state(system: PiecewiseSystem, inputs: Matrix, initial: Initial) -> Matrix:
    """The state to start from, over these heights of the roads [m] and forces [N].

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
        z, force = inputs[:roads], inputs[roads:]
        d = equilibrium(system, z, force if initial == "preload" else np.zeros_like(force))
        given = np.concatenate([np.zeros(n - system.positions.shape[0]), system.positions @ d + system.heights @ z])
    else:
        try:
            given = np.array(initial, dtype=float)
        except (TypeError, ValueError):
            raise SimulationError(f"The initial state is an array of {n} numbers, got {initial!r}.") from None
    if given.shape != (n,) or not np.all(np.isfinite(given)):
        raise SimulationError(
            f"The initial state needs {n} finite numbers ({', '.join(system.states)}), got {given.tolist()}."
        )
    return np.asarray(given)


def equilibrium(system: PiecewiseSystem, road: Matrix, force: Matrix) -> Matrix:
    """Displacements of all nodes [m] at rest over `road` heights [m] under external `force` [N], friction unloaded.

    Springs carry the load; a gap that carries some of it is closed. Where nothing holds a node in place it stays as
    close to zero as the rest allows, and a gap as close to its middle.

    Raises `SimulationError` if the springs cannot carry the load.
    """
    branches, coordinates = system.graph.branches, system.mechanism.coordinates
    nodes = len(system.graph.nodes)
    if nodes == 0 or not (np.any(road) or np.any(force)):
        return np.zeros(nodes)
    E = np.array([b.nodes for b in branches]).reshape(-1, nodes)
    offset = np.array([b.roads for b in branches]).reshape(len(branches), -1) @ road
    k = np.array([_size(b.element) if isinstance(b.element, Spring) else 0.0 for b in branches])
    gaps = [i for i, b in enumerate(branches) if isinstance(b.element, Gap)]
    width = np.array([_size(branches[i].element) for i in gaps])
    load = np.zeros(nodes)
    for f, value in zip(system.mechanism.forces, force, strict=True):
        load[: len(coordinates)] += value * np.array([f.port.get(c.name, 0.0) for c in coordinates])
    K = E.T @ (k[:, None] * E)
    free = load - E.T @ (k * offset)
    stiff = float(k.max(initial=1.0))
    size = max(float(np.abs(free).max(initial=0.0)), float(np.abs(load).max(initial=0.0)), 1e-12)
    for closed in sorted(product((0, 1, -1), repeat=len(gaps)), key=lambda c: sum(map(abs, c))):
        touching = [i for i, side in enumerate(closed) if side or width[i] == 0.0]
        if any(side and width[i] == 0.0 for i, side in enumerate(closed)):
            continue
        H = E[[gaps[i] for i in touching]].reshape(-1, nodes)
        at = np.array([closed[i] * width[i] - offset[gaps[i]] for i in touching])
        m = len(touching)
        system_rows = np.block([[K / stiff, H.T], [H, np.zeros((m, m))]]) if m else K / stiff
        right = np.concatenate([free / stiff, at])
        solved = np.linalg.lstsq(system_rows, right, rcond=1e-12)[0]
        solved = _centred(system_rows, solved, E[gaps], offset[gaps], nodes)
        residual = system_rows @ solved - right
        d, reactions = solved[:nodes], solved[nodes:] * stiff
        elongation = E[gaps] @ d + offset[gaps]
        balanced = np.abs(residual[:nodes]).max(initial=0.0) * stiff <= _BALANCED * size
        inside = np.all(np.abs(elongation) <= width + 1e-12 + 1e-9 * width)
        pushing = all(closed[i] * f >= -_BALANCED * size for i, f in zip(touching, reactions, strict=True))
        if balanced and inside and pushing and np.abs(residual[nodes:]).max(initial=0.0) < 1e-12:
            return np.asarray(d)
    raise SimulationError(
        "The static load is not carried by springs: some part of it rests on dampers, inerters or friction alone, "
        "which give way. Start at rest, or add a spring where the load passes."
    )


def _centred(rows: Matrix, solved: Matrix, E: Matrix, offset: Matrix, nodes: int) -> Matrix:
    """The same solution moved, within what leaves all forces alone, to where gaps are closest to their middle."""
    if not E.size:
        return solved
    _, values, right = np.linalg.svd(rows)
    null = right[np.sum(values > 1e-10 * values.max(initial=1.0)) :].T[:nodes]
    if not null.size:
        return solved
    moved = np.linalg.lstsq(E @ null, -(E @ solved[:nodes] + offset), rcond=1e-10)[0]
    return np.concatenate([solved[:nodes] + null @ moved, solved[nodes:]])


def _size(element: object) -> float:
    return float(element.value)  # type: ignore[attr-defined]
