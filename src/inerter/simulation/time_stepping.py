"""Time stepping: an integrator without modes and events, to check the one that has them.

Inputs are a table with a constant step. `parts` is what there is to move, `scheme` one step of Moreau and Jean's
method, `kernels.stepping` the loop over the steps. Of `systems` only the graph is used, on purpose: what this
integrator shares with the other one it cannot check.

Not covered: impacts without compliance are refused; where inertia meets the end of a gap that only a friction holds,
what follows is right only for steps in which the friction cannot stop it; a node that nothing holds stays where it is.
The force of a damper on a road that jumps contains the jump, spread over a step.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, SimulationError, Status, StatusKind
from inerter.formatting import format_alike, format_quantity
from inerter.kernels.stepping import DONE, INFINITE, SIDE, SPEED, STUCK, Scratch, Step, Stretch, march
from inerter.simulation.parts import SAME, Parts, check_gaps, parts_of, range_and_null, unit_rows
from inerter.simulation.scheme import Scheme, scheme_of
from inerter.systems.graph import Graph
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]

CHUNK = 1 << 15  # steps whose inputs are laid out at once, if they take no longer than ...
_PAUSE = 0.1  # [s] between two looks at the keyboard
_ENDED = {
    STUCK: "the contact solver did not converge",
    INFINITE: "the velocities overflow",
}


@dataclass(frozen=True, eq=False)
class StepTable:
    """Roads and external forces at the instants `time` [s], a constant step apart.

    `road` and `road_rate` [m, m/s] are of shape (roads, instants), `force` and `force_rate` [N, N/s] of (forces,
    instants). Between instants each channel is "cubic" (Hermite), "linear", or "zero" (held until the next instant, at
    which it jumps).
    """

    time: Matrix
    road: Matrix
    road_rate: Matrix
    force: Matrix
    force_rate: Matrix
    road_hold: tuple[str, ...]
    force_hold: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Start:
    """Displacements [m] and velocities [m/s] of all nodes at the first instant.

    Elongations [m] of the branches follow from them as if all were zero where every displacement and road is zero,
    unless they are given. What massless nodes are given only matters where something else than inertia holds them.
    """

    displacement: Matrix
    velocity: Matrix
    elongations: Matrix | None = None


@dataclass(frozen=True, eq=False)
class Stop:
    """Final state of a run by time stepping, from which the next one continues.

    Displacements of massless nodes, momenta, elongations where all displacements are zero, and what reactions did.
    """

    displacement: Matrix
    momentum: Matrix
    offsets: Matrix
    law: Matrix


@dataclass(frozen=True, eq=False)
class Histories:
    """Motions of the nodes, (samples, nodes), and forces of the branches [N], (samples, branches).

    The acceleration of a massless node is zero at the first and the last sample. What was not reached is nan.
    """

    time: Matrix
    displacement: Matrix
    velocity: Matrix
    acceleration: Matrix
    forces: Matrix
    status: Status
    stop: Stop


def step_through(mechanism: Mechanism, graph: Graph, table: StepTable, start: Start | Stop, every: int) -> Histories:
    """Integrate with one step for each interval of `table`, and keep every `every`-th instant, the first one included.

    It goes on where another march over the same mechanism ended, if that is the start. `graph` is
    `full_graph(mechanism)`. Second order in the step while nothing slides or touches, first order else.

    Raises `SimulationError` if the table is not usable, if a road that jumps moves an inerter, if a gap starts beyond
    its ends or can stop inertia with nothing in between that gives way.
    """
    h = _check_table(table, every)
    parts = parts_of(mechanism, graph)
    check_gaps(parts)
    offsets = start.offsets if isinstance(start, Stop) else _offsets(parts, table, start)
    scheme = scheme_of(parts, table.road_hold, offsets, h)
    known, law = _initial(parts, scheme, table, start, offsets), scheme.law.copy()
    if isinstance(start, Stop):
        law[[SIDE, SPEED]] = start.law[[SIDE, SPEED]]
    samples, ended, reached = _march(scheme, table, known, law, every)
    stop = Stop(known[scheme.at.d].copy(), known[scheme.at.p].copy(), offsets, law)
    return _histories(parts, table, samples, ended, reached, every, stop)


def _check_table(table: StepTable, every: int) -> float:
    """The step [s]; raises `SimulationError` unless the table has one, is finite and has a known hold everywhere."""
    time = table.time
    if time.ndim != 1 or time.size < 2 or every < 1:
        raise SimulationError(f"Time stepping needs two instants or more and every >= 1, got {time.shape}, {every}.")
    h = float(time[-1] - time[0]) / (time.size - 1)
    if not h > 0.0 or np.abs(np.diff(time) - h).max() > 1e-6 * h:
        raise SimulationError("Time stepping needs instants a constant positive step apart. Resample the input.")
    for what, values, rates, holds in (
        ("road", table.road, table.road_rate, table.road_hold),
        ("force", table.force, table.force_rate, table.force_hold),
    ):
        if not values.shape == rates.shape == (len(holds), time.size):
            raise SimulationError(f"Each {what} needs one value and one rate an instant, got shape {values.shape}.")
        if not (np.isfinite(values).all() and np.isfinite(rates).all()):
            raise SimulationError(f"A {what} of the input table is not finite.")
        if not set(holds) <= {"cubic", "linear", "zero"}:
            raise SimulationError(f'A {what} is held "cubic", "linear" or "zero", got {holds}.')
    return h


def _offsets(parts: Parts, table: StepTable, start: Start) -> Matrix:
    """Elongations where all displacements and roads are zero."""
    for what, values in (("displacement", start.displacement), ("velocity", start.velocity)):
        if values.shape != (parts.nodes,) or not np.isfinite(values).all():
            raise SimulationError(f"The start needs a finite {what} for each of the {parts.nodes} nodes.")
    if start.elongations is None:
        return np.zeros(len(parts.branches))
    if start.elongations.shape != (len(parts.branches),) or not np.isfinite(start.elongations).all():
        raise SimulationError(f"The start needs a finite elongation for each of the {len(parts.branches)} branches.")
    return np.asarray(start.elongations - parts.E @ start.displacement - parts.R @ table.road[:, 0])


def _initial(parts: Parts, scheme: Scheme, table: StepTable, start: Start | Stop, offsets: Matrix) -> Matrix:
    """Vector of the first step's known quantities: displacements, momenta, inputs, and a one."""
    at, inertia = scheme.at, parts.inertia
    known = np.zeros(at.total)
    known[at.inputs] = _inputs(table, 0, 1)[0]
    known[at.one] = 1.0
    if isinstance(start, Stop):
        known[at.d], known[at.p] = start.displacement, start.momentum
    else:
        known[at.d] = _balanced_displacements(parts, table, start, offsets)
        known[at.p] = inertia.M @ start.velocity + inertia.B @ known[at.rate0]
    return known


def _balanced_displacements(parts: Parts, table: StepTable, start: Start, offsets: Matrix) -> Matrix:
    """Displacements at the start, in which nodes that only springs hold are in balance.

    Massless and undamped, they are there at once; the step's mean force would let them swing about that place.
    """
    elongation = offsets + parts.E @ start.displacement + parts.R @ table.road[:, 0]
    masses = np.diag(parts.masses)[parts.masses != 0.0]
    held = np.vstack([masses, parts.E[parts.c + parts.b > 0.0], _touching(parts, elongation)])
    free = range_and_null(unit_rows(held))[1]
    stiffness = free.T @ parts.nodal(parts.k, parts.E) @ free
    constant = [r.upper * r.nodes for r in parts.reactions if not r.gap and not r.acts]
    unbalanced = free.T @ (parts.E.T @ (parts.k * elongation) + sum(constant, np.zeros(parts.nodes)))
    return start.displacement - free @ (np.linalg.pinv(stiffness, rcond=1e-12, hermitian=True) @ unbalanced)


def _touching(parts: Parts, elongation: Matrix) -> Matrix:
    """Rows of the frictions, and of the gaps that start at one of their ends.

    Raises `SimulationError` if a gap starts beyond them.
    """
    rows = [np.zeros((0, parts.nodes))]
    for reaction in parts.reactions:
        at = elongation[reaction.branch]
        least, inside = (SAME * np.abs([reaction.lower, reaction.upper])).tolist()
        if reaction.gap and not reaction.lower - least - 1e-12 <= at <= reaction.upper + inside + 1e-12:
            branch = parts.branches[reaction.branch]
            start, *ends = format_alike([at, *filter(isfinite, (reaction.lower, reaction.upper))], "m")
            raise SimulationError(
                f"{branch.element.key.capitalize()} {branch.label!r} starts at {start}, beyond where it is met, at "
                f"{' and '.join(ends)}."
            )
        if reaction.acts if not reaction.gap else not reaction.lower + least < at < reaction.upper - inside:
            rows.append(reaction.nodes[None])
    return np.vstack(rows)


def _inputs(table: StepTable, first: int, last: int) -> Matrix:
    """Inputs of the steps `first` to `last` - 1 (steps, inputs): roads, increments, mean forces, rates at both ends."""
    h = float(table.time[-1] - table.time[0]) / (table.time.size - 1)
    z0, z1 = table.road[:, first:last], table.road[:, first + 1 : last + 1]
    rates = {
        "cubic": (table.road_rate[:, first:last], table.road_rate[:, first + 1 : last + 1]),
        "linear": ((z1 - z0) / h, (z1 - z0) / h),
        "zero": (0.0 * z0, 0.0 * z0),
    }
    F0, F1 = table.force[:, first:last], table.force[:, first + 1 : last + 1]
    bend = h / 12.0 * (table.force_rate[:, first:last] - table.force_rate[:, first + 1 : last + 1])
    means = {"cubic": 0.5 * (F0 + F1) + bend, "linear": 0.5 * (F0 + F1), "zero": F0}
    columns = [
        z0,
        z1 - z0,
        *(means[hold][j : j + 1] for j, hold in enumerate(table.force_hold)),
        *(rates[hold][end][j : j + 1] for end in (0, 1) for j, hold in enumerate(table.road_hold)),
    ]
    return np.ascontiguousarray(np.vstack(columns).T)


def _march(scheme: Scheme, table: StepTable, known: Matrix, law: Matrix, every: int) -> tuple[Matrix, int, int]:
    """Samples, the code of the end of the march, and the step reached; updates `known` and `law` in place."""
    steps, count, shared = table.time.size - 1, scheme.G.shape[0], sum(scheme.Z.shape)
    samples = np.zeros((steps // every + 1, scheme.starts.shape[0]))
    scratch = Scratch(
        *(np.zeros(scheme.predict.shape[0]), np.zeros(count), np.zeros((count, count)), np.zeros(count, np.int64)),
        *(np.zeros(scheme.Z.shape[1]), np.zeros(shared), np.zeros((shared, shared)), np.zeros(shared, np.int64)),
    )
    step = Step(*(getattr(scheme, name) for name in Step._fields))
    ended, reached = DONE, 0
    chunk = min(CHUNK, 1 << 10)
    while reached < steps and ended == DONE:
        begun, inputs = perf_counter(), _inputs(table, reached, min(reached + chunk, steps))
        ended, reached = march(step, inputs, Stretch(reached, steps, every), known, law, scratch, samples)
        spent = perf_counter() - begun
        chunk = max(1, chunk // 2) if spent > _PAUSE else min(CHUNK, 2 * chunk) if spent < 0.5 * _PAUSE else chunk
    return samples, ended, reached


def _histories(
    parts: Parts, table: StepTable, samples: Matrix, ended: int, reached: int, every: int, stop: Stop
) -> Histories:
    """Histories from the columns of `samples`; nan after the step `reached` if the march ended early."""
    n, status = parts.nodes, OK
    if ended != DONE:
        samples[-(-reached // every) :] = np.nan
        status = Status(
            StatusKind.FAILED,
            f"At t = {format_quantity(table.time[reached], 's', 6)} {_ENDED[ended]}; what follows is nan.",
        )
    acceleration = samples[:, 2 * n : 3 * n]
    acceleration[0, parts.massless] = 0.0
    if (table.time.size - 1) % every == 0:
        acceleration[-1, parts.massless] = 0.0
    return Histories(
        np.ascontiguousarray(table.time[::every]),
        np.ascontiguousarray(samples[:, :n]),
        np.ascontiguousarray(samples[:, n : 2 * n]),
        np.ascontiguousarray(acceleration),
        np.ascontiguousarray(samples[:, 3 * n :]),
        status,
        stop,
    )
