"""Trajectory of an integration: outputs and events from its recorded samples."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.kernels.events import evaluate
from inerter.simulation import event_driven
from inerter.simulation.energy import energy_of
from inerter.simulation.event_driven import Integration
from inerter.simulation.initial_state import initial_state, may_lie_unstrained
from inerter.simulation.inputs import InputTable, tabulate
from inerter.simulation.trajectory import Event, PeriodicState, Trajectory
from inerter.systems.outputs import Output
from inerter.systems.piecewise import PiecewiseSystem, output_rows

Matrix = NDArray[np.float64]
_ROUNDING = 1e-14  # of a sum, relative to its terms
_GLANCE = 1e-4  # s, in which nothing moves that is at rest


def trajectory_of(integration: Integration, steady: PeriodicState | None, label: str) -> Trajectory:
    system, table, reached = integration.system, integration.table, integration.table.samples
    if not integration.status.ok:
        reached = int(np.sum(table.slot[: integration.segment + 1] >= 0))
    rows = integration.record.events[: integration.events]
    return Trajectory(
        time=table.sampled[:reached].copy(),  # the table may be that of other runs too
        integration_status=integration.status if not integration.status.ok else integration.warning,
        outputs=system.outputs,
        states=_states(integration, rows),
        energy=energy_of(integration) if integration.account.wanted else None,
        repetition=steady,
        final_state=integration.state,
        end=integration.now,
        label=label,
        _mechanism=system.mechanism,
        _ending=integration.ending if integration.status.ok else None,
        _evaluate=partial(_evaluate, integration, reached),
        _list_events=partial(_event_list, system, rows),
    )


def outputs_at_rest(system: PiecewiseSystem, outputs: Sequence[str]) -> Matrix | None:
    """Outputs in the static equilibrium (outputs,); None where nothing has a force at rest, so that all are zero.

    Raises `SimulationError` if springs do not hold it.
    """
    if may_lie_unstrained(system):
        return None
    inputs = len(system.mechanism.roads) + len(system.mechanism.forces)
    table = tabulate([None] * inputs, [0.0] * inputs, _GLANCE, _GLANCE)
    run = event_driven.start(system, table, initial_state(system, table.value[0], "rest"))
    run.advance(1)
    found = trajectory_of(run, None, "at rest")
    return np.array([found[name][0] for name in outputs])


def _element_labels(system: PiecewiseSystem) -> list[list[tuple[str, dict[int, str]]]]:
    """Labels and state names of the elements of each friction and gap of the kernels.

    A friction whose ends are turned slips down when the others slip up.
    """
    named = []
    for element, group in zip(system.nonlinear_elements, system.nonlinear, strict=True):
        assert element.switch is not None
        names = element.switch.states
        turned = {state: names[-state] for state in names}
        named.append([(system.graph.branches[i].label, names if s > 0.0 else turned) for i, s in group.items()])
    return named


def _states(integration: Integration, events: NDArray[Any]) -> dict[str, str]:
    """The state of every element at the start; what changes at once is an event, too."""
    found: dict[str, str] = {}
    first = integration.modes.state[integration.record.visited[0]]
    for e, elements in enumerate(_element_labels(integration.system)):
        own = (events["element"] == e).nonzero()[0][:1]
        state = int(events["before"][own[0]] if own.size else first[e])
        found |= {label: names[state] for label, names in elements}
    return found


def _event_list(system: PiecewiseSystem, events: NDArray[Any]) -> tuple[Event, ...]:
    named = _element_labels(system)
    return tuple(
        Event(time, label, names[before], names[after])
        for time, e, before, after in events.tolist()
        for label, names in named[e]
    )


def _evaluate(integration: Integration, reached: int, wanted: Output) -> Matrix:
    """An output at the samples that were reached."""
    at = slice(reached)
    over, inputs = _rows_of(integration, wanted, at)
    return _at_samples(integration, over, inputs, integration.record.visited[at], at)


def contact_jumps(integration: Integration, wanted: Sequence[Output]) -> Matrix:
    """Jumps (outputs, jumps) between samples at which different gaps are in contact.

    Both contact states are applied to the second of the two samples, which must have been kept.
    """
    system, record = integration.system, integration.record
    loose = [e for e, element in enumerate(system.nonlinear_elements) if not element.is_damped]
    if not loose:
        return np.zeros((len(wanted), 0))
    after = 1 + np.flatnonzero(record.visited[1:] != record.visited[:-1])
    there, here = (integration.modes.state[record.visited[at]][:, loose] for at in (after, after - 1))
    after = after[np.any(there != here, axis=1)]
    found = np.zeros((len(wanted), after.size))
    for jumps, output in zip(found, wanted, strict=True):
        if after.size:
            over, inputs = _rows_of(integration, output, after)
            there, here = (
                _at_samples(integration, over, inputs, record.visited[at], after) for at in (after, after - 1)
            )
            jumps[:] = there - here
    return found


def _at_samples(
    integration: Integration, over: Matrix, inputs: Matrix, modes: NDArray[np.int64], at: slice | NDArray[np.intp]
) -> Matrix:
    """Rows `over` of these modes applied to the states kept `at` some samples, and to the inputs there."""
    out = np.empty(inputs.shape[0])
    evaluate(over, np.ascontiguousarray(modes), np.ascontiguousarray(integration.record.states[at]), inputs, out)
    return out


def _rows_of(integration: Integration, wanted: Output, at: slice | NDArray[np.intp]) -> tuple[Matrix, Matrix]:
    """Rows of an output in each mode, on the state, on inputs that move and on one; and these inputs at samples."""
    system, table = integration.system, integration.table
    on_x, on_u, on_eta = output_rows(system, wanted)
    n, nu, roads = on_x.size, on_u.size, len(system.mechanism.roads)
    maps = integration.modes.maps[: integration.count]
    weights = np.concatenate([on_x, on_eta])
    rows = np.concatenate([maps[:, integration.projected_state], maps[:, integration.eta]], axis=1)
    direct = np.zeros(n + nu + 1)
    direct[n:-1] = on_u
    over = np.einsum("i,mij->mj", weights, rows) + direct
    terms = np.einsum("i,mij->mj", np.abs(weights), np.abs(rows)) + np.abs(direct)
    over[np.abs(over) < _ROUNDING * terms] = 0.0  # what sticks does not move
    channel = [*range(roads)] * 3 + [*range(roads, nu - 2 * roads)]
    used = [i for i in np.logical_or.reduce(over[:, n:-1]).nonzero()[0].tolist() if table.moving[channel[i]]]
    over = np.ascontiguousarray(over[:, [*range(n), *(n + i for i in used), -1]])
    inputs = np.empty((table.sampled[at].size, len(used)))
    for column, i in enumerate(used):
        inputs[:, column] = sampled_input(table, i // roads if i < 3 * roads else 0, channel[i], at)
    return over, inputs


def sampled_input(
    table: InputTable, derivative: int, channel: int, samples: slice | NDArray[np.intp] = slice(None)
) -> Matrix:
    """An input, or its first or second derivative, at samples, from the right (at the last knot from the left)."""
    at = table.sample_knots[samples]
    if derivative < 2:
        right, left = ((table.value, table.value_before), (table.slope, table.slope_before))[derivative]
        found = right[:, channel][at]  # with two indices it takes several times as long
        if at[-1] == table.time.size - 1:
            found[-1] = left[-1, channel]
        return np.asarray(found)
    segment = np.minimum(at, table.time.size - 2)
    length = np.diff(table.time)[segment]
    rise = table.value_before[segment + 1, channel] - table.value[segment, channel]
    s0, s1 = length * table.slope[segment, channel], length * table.slope_before[segment + 1, channel]
    first, last = 6.0 * rise - 4.0 * s0 - 2.0 * s1, -6.0 * rise + 2.0 * s0 + 4.0 * s1
    return np.asarray(np.where(at == segment, first, last) / length**2)
