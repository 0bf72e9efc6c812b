"""From an integration to the trajectory that its user sees."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from inerter.kernels.events import EVENTS, SEGMENT, evaluate
from inerter.networks.elements import Friction
from inerter.simulation.energy import energy_of
from inerter.simulation.event_driven import Integration
from inerter.simulation.inputs import InputTable
from inerter.simulation.trajectory import Event, Repetition, Trajectory
from inerter.systems.outputs import Output
from inerter.systems.piecewise import output_rows

Matrix = NDArray[np.float64]
_FRICTION = {-1: "slip down", 0: "stick", 1: "slip up"}
_GAP = {-1: "lower contact", 0: "open", 1: "upper contact"}


def trajectory_of(integration: Integration, steady: Repetition | None, label: str, state: Matrix) -> Trajectory:
    system, table, record = integration.system, integration.table, integration.record
    kinds = [_FRICTION if isinstance(system.graph.branches[i].element, Friction) else _GAP for i in system.nonlinear]
    labels = system.elements
    rows = record.events[: integration.place[EVENTS]]

    def events() -> tuple[Event, ...]:
        listed = ((t, int(e), int(a), int(b)) for t, e, a, b in rows.tolist())
        return tuple(Event(t, labels[e], kinds[e][a], kinds[e][b]) for t, e, a, b in listed)

    reached, roads = table.samples, len(system.mechanism.roads)
    if not integration.status.ok:
        reached = int(np.sum(table.slot[: integration.place[SEGMENT] + 1] >= 0))
    first = integration.modes.state[record.visited[0]]
    states = {name: kind[int(s)] for name, kind, s in zip(labels, kinds, first, strict=False)}
    visited, history = record.visited[:reached], np.ascontiguousarray(record.states[:reached])

    def output(wanted: Output) -> Matrix:
        on_x, on_u, on_eta = output_rows(system, wanted)
        n, nu = on_x.size, on_u.size
        eta = integration.modes.maps[: integration.count, integration.eta]
        over = np.concatenate([on_x, on_u, [0.0]]) + np.einsum("i,mij->mj", on_eta, eta)
        out = np.empty(reached)
        channel = [*range(roads)] * 3 + [*range(roads, nu - 2 * roads)]
        used = [i for i in range(nu) if np.any(over[:, n + i]) and table.moving[channel[i]]]
        over = np.ascontiguousarray(np.concatenate([over[:, :n], over[:, [n + i for i in used]], over[:, -1:]], axis=1))
        inputs = np.empty((reached, len(used)))
        for column, i in enumerate(used):
            inputs[:, column] = sampled_input(table, i // roads if i < 3 * roads else 0, channel[i])[:reached]
        evaluate(over, visited, history, inputs, out)
        return out

    return Trajectory(
        time=table.sampled[:reached],
        status=integration.status if not integration.status.ok else integration.warning,
        outputs=system.outputs,
        states=states,
        energy=energy_of(integration, state if steady is None else record.states[0]) if integration.account else None,
        repetition=steady,
        final_state=integration.state,
        end=integration.now,
        label=label,
        _evaluate=output,
        _list_events=events,
    )


def sampled_input(table: InputTable, derivative: int, channel: int) -> Matrix:
    """An input, or its first or second derivative, at the samples, from the right (at the last one from the left)."""
    at = np.flatnonzero(table.slot >= 0)
    if derivative < 2:
        right, left = ((table.value, table.value_before), (table.slope, table.slope_before))[derivative]
        return np.asarray(np.where(at == table.time.size - 1, left[at, channel], right[at, channel]))
    segment = np.minimum(at, table.time.size - 2)
    length = np.diff(table.time)[segment]
    rise = table.value_before[segment + 1, channel] - table.value[segment, channel]
    s0, s1 = length * table.slope[segment, channel], length * table.slope_before[segment + 1, channel]
    first, last = 6.0 * rise - 4.0 * s0 - 2.0 * s1, -6.0 * rise + 2.0 * s0 + 4.0 * s1
    return np.asarray(np.where(at == segment, first, last) / length**2)
