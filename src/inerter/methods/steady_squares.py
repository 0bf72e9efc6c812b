"""Mean squares of a periodic motion, of outputs with optional filters, and their sampling error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ErrorSource, Status
from inerter.simulation.event_driven import Integration
from inerter.simulation.inputs import InputTable
from inerter.simulation.observe import contact_jumps, outputs_at_rest, trajectory_of
from inerter.simulation.periodic_steady_state import FEW_PERIODS, mean_squares, powers_of, settle
from inerter.simulation.trajectory import PeriodicState
from inerter.systems.filters import Filter
from inerter.systems.piecewise import PiecewiseSystem, output_rows

Array = NDArray[np.float64]
_DEVIATIONS = 4.0  # standard deviations of the error by jumps between samples that a bound of it has


@dataclass(frozen=True, eq=False)
class Squares:
    """Mean squares of outputs over a period, how far to trust them, and how well the motion repeats.

    `jumps` is what samples may miss of each r.m.s. value, relative to it, where friction turns between them. `lines` is
    the number of spectral lines over which each motion spreads: of equal ones their number, nan without a spectrum.
    `ending` is the state at the end of the period.
    """

    power: Array
    status: Status
    steady: PeriodicState
    jumps: Array
    lines: Array
    ending: Array = field(default_factory=lambda: np.zeros(0))


def steady_state_error(found: Sequence[PeriodicState], peaks: float) -> ErrorSource:
    """Error source of a periodic steady state not fully reached; `peaks` scales it from r.m.s. values."""
    return ErrorSource("periodic steady state", 3.0 * peaks * max((one.remaining_change for one in found), default=0.0))


def steady_squares(
    system: PiecewiseSystem,
    table: InputTable,
    outputs: Sequence[str],
    filters: Sequence[Filter | None],
    state: Array,
    most: int = FEW_PERIODS,
    about_mean: bool = False,
    spectra: Sequence[str] = (),
    **repeats: float,
) -> Squares:
    """Mean squares over the period of `table` once the motion repeats, of deviations from the mean if `about_mean`.

    With the number of spectral lines of the outputs that `spectra` names.
    Otherwise they are of deviations from static equilibrium, which a constant force such as a preload moves. The first
    outputs pass through `filters`, in the frequency domain: as they do once the filters have settled too.
    """
    at_rest = None if about_mean else outputs_at_rest(system, outputs)
    if not (about_mean or any(filters) or at_rest is not None):
        if spectra:
            integration, steady = settle(system, table, state, energy=False, most=most, outputs=outputs)
            found = powers_of(integration)
        else:
            found, integration, steady = mean_squares(system, table, outputs, state, most, **repeats)
        if not integration.status.ok:
            return _nan_squares(len(outputs), integration.status, steady)
        jumps, lines = missed_by_samples(integration, outputs, np.sqrt(found)), np.full(len(outputs), np.nan)
        if spectra:
            trajectory = trajectory_of(integration, steady, "")
            spectrum = np.fft.rfft(np.array([trajectory[name][:-1] for name in spectra]))
            lines[[outputs.index(name) for name in spectra]] = number_of_lines(_squares_of(spectrum))
        return Squares(found, integration.warning, steady, jumps, lines, integration.state)
    integration, steady = settle(system, table, state, energy=False, most=most)
    trajectory = trajectory_of(integration, steady, "")
    if not integration.status.ok:
        return _nan_squares(len(outputs), integration.status, steady)
    count, period = trajectory.time.size - 1, float(table.time[-1] - table.time[0])
    omega = 2.0 * np.pi / period * np.arange(count // 2 + 1)
    motions = np.array([trajectory[name][:count] for name in outputs])
    lines = _squares_of(np.fft.rfft(motions if at_rest is None else motions - at_rest[:, None]))
    passed: Array = np.ones_like(lines)
    for gain, one in zip(passed, filters, strict=False):
        if one is not None:
            gain[:] = _squares_of(one.response(omega))
    if about_mean:
        lines[:, 0] = 0.0
    lines *= passed
    lines[:, 1 : (count + 1) // 2] *= 2.0
    power = lines.sum(axis=1) / count**2
    again = np.sqrt((lines * passed).sum(axis=1)) / count
    with np.errstate(divide="ignore", invalid="ignore"):
        jumps = missed_by_samples(integration, outputs, power / again)
    return Squares(power, trajectory.integration_status, steady, jumps, number_of_lines(lines), integration.state)


def _squares_of(numbers: NDArray[np.complex128]) -> Array:
    """Squared sizes, without the roots that `abs` takes of them."""
    return np.asarray(numbers.real**2 + numbers.imag**2)


def number_of_lines(squares: Array) -> Array:
    """Number of lines over which motions spread, from the mean squares of their lines (motions, lines from zero on)."""
    varying = squares[:, 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(varying.sum(axis=1) ** 2 / (varying**2).sum(axis=1))


def _nan_squares(count: int, status: Status, steady: PeriodicState) -> Squares:
    nothing = np.full(count, np.nan)
    return Squares(nothing, status, steady, nothing, nothing)


def jump_sizes(integration: Integration, outputs: Sequence[str]) -> Array:
    """Largest jump of each output (elements, outputs) at an event of each friction; zero of gaps.

    That is what a friction adds to it one way less what it adds the other way, while all others are as they are.
    """
    system, count = integration.system, integration.count
    maps, states = integration.modes.maps[:count], integration.modes.state[:count]
    rows = np.concatenate([maps[:, integration.projected_state, -1], maps[:, integration.eta, -1]], axis=1)
    over = [output_rows(system, system.outputs[name]) for name in outputs]
    pushed = rows @ np.array([np.concatenate([on_x, on_eta]) for on_x, _, on_eta in over]).T
    sizes = np.zeros((states.shape[1], len(outputs)))
    for e, element in enumerate(system.nonlinear_elements):
        if element.is_damped:
            alike = np.delete(states, e, axis=1) @ 3 ** np.arange(states.shape[1] - 1)
            group = np.unique(alike, return_inverse=True)[1]
            low, high = (np.full((count, len(outputs)), one) for one in (np.inf, -np.inf))
            np.minimum.at(low, group, pushed)
            np.maximum.at(high, group, pushed)
            both = np.zeros((count, 2), dtype=bool)  # groups where it was met both ways; else it goes twice as far
            both[group[states[:, e] > 0], 0] = both[group[states[:, e] < 0], 1] = True
            apart = np.where(np.isfinite(low), high - low, 0.0) * np.where(both.all(axis=1), 1.0, 2.0)[:, None]
            sizes[e] = apart.max(axis=0)
    return sizes


def missed_by_samples(integration: Integration, outputs: Sequence[str], sizes: Array) -> Array:
    """Relative sampling error of r.m.s. values of these `sizes` (outputs,), from jumps between samples.

    Of an output that passes through a filter, the size is the mean square over the r.m.s. value after a second one.
    """
    return relative_bound(jump_scatter(integration, outputs), sizes)


def jump_scatter(integration: Integration, outputs: Sequence[str]) -> Array:
    """Standard deviation of r.m.s. values (outputs,), in their units, from jumps between samples.

    A jump of J anywhere between two samples h apart moves the sum of squares by 2 y J h u with u between -1/2 and 1/2,
    independently of all others: N of them in a period T change a r.m.s. value by (h / T) sqrt(N / 12) J, as one
    standard deviation. With a filter y is what has passed through it twice. What begins to slip does not jump. The
    force of a gap that closes jumps by its dampers; these jumps are known where the motion was kept.
    """
    met = "jumps", tuple(outputs), integration.modes.state[: integration.count].tobytes()
    if met not in integration.known:
        integration.known[met] = jump_sizes(integration, outputs)
    events = integration.record.events[: integration.events]
    ends = np.bincount(events["element"][events["before"] != 0], minlength=len(integration.system.nonlinear))
    steps = max(integration.table.samples - 1, 1)
    squares = ends @ integration.known[met] ** 2
    if integration.record.states.shape[0] > 1:
        wanted = [integration.system.outputs[name] for name in outputs]
        squares = squares + np.sum(contact_jumps(integration, wanted) ** 2, axis=1)
    return np.asarray(np.sqrt(squares / 12.0) / steps)


def mean_bound(shares: Sequence[Array]) -> float:
    """The bound for means over realisations, whose jumps are independent, from that of each (outputs,)."""
    several = np.array(shares)
    return float(np.max(np.sqrt(np.sum(several**2, axis=0)) / len(several), initial=0.0)) if several.size else 0.0


def relative_bound(scatter: Array, sizes: Array) -> Array:
    """The bound of the error by jumps that scatter so much, relative to r.m.s. values of these sizes."""
    share: Array = np.zeros_like(sizes)
    np.divide(_DEVIATIONS * scatter, sizes, out=share, where=(scatter > 0.0) & (sizes > 0.0))
    return share
