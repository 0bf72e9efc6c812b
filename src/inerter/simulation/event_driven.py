"""The event-driven integrator: compiled kernels on arrays, and the room that they need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, SimulationError, Status, StatusKind
from inerter.kernels import events as kernel
from inerter.kernels.arrays import ENTRY, ETA, GUARD, SEEN, Mechanics, Modes
from inerter.kernels.march import March, lines_of, march_of
from inerter.kernels.modes import build, discretise
from inerter.kernels.prepare import prepare
from inerter.networks.elements.roles import Guard, Linear
from inerter.simulation.inputs import InputTable
from inerter.simulation.threads import check_wanted
from inerter.simulation.trajectory import Ending
from inerter.systems.outputs import Output
from inerter.systems.piecewise import PiecewiseSystem, output_rows

Matrix = NDArray[np.float64]
MOST_ELEMENTS = 12
_SEGMENTS, _PIECES = 200_000, 4000  # at most between two looks at the keyboard: some 10 ms
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)


@dataclass
class Integration:
    """One integration under way: the modes met so far, the state now and what has been recorded."""

    system: PiecewiseSystem
    table: InputTable
    march: March
    mechanics: Mechanics
    modes: Modes
    begun: Matrix  # the state at the start, before anything that jumps there
    used: NDArray[np.int64]
    work: Matrix
    flags: NDArray[np.int64]
    place: NDArray[np.int64]
    record: kernel.Record
    account: bool = False
    count: int = 0
    status: Status = OK
    warning: Status = OK  # of a run that went to its end

    def advance(self, stop: int) -> None:
        """Integrate up to knot `stop`, or until something is wrong, which `status` then tells.

        Raises `CancelledError` in a thread of `threads` whose work is not wanted any more.
        """
        while self.status.ok and self.place[kernel.SEGMENT] < stop:
            check_wanted()
            self.place[kernel.LEFT] = _PIECES
            until = min(stop, int(self.place[kernel.SEGMENT]) + _SEGMENTS)
            m, c = self.modes, self.mechanics
            now = kernel.Work(
                self.work, self.flags, self.place, c.sizes, c.elements, c.limit, c.lengths,
                m.number, m.state, m.maps, m.reaction, m.limits, m.reach,
            )  # fmt: skip
            code = kernel.integrate(self.march.address, m.steps, now, self.record, self.table.step, until)
            if code == kernel.MODE_UNKNOWN:
                if not self.build(self.flags[kernel.TRIAL]):
                    self.status = self._failed(_SINGULAR)
            elif code == kernel.EVENTS_FULL:
                events = self.record.events
                self.record = self.record._replace(events=np.concatenate([events, np.empty_like(events)]))
            elif code not in (kernel.DONE, kernel.PAUSED):
                self.status = self._failed(_FAILURES[code])

    def build(self, states: NDArray[np.int64]) -> bool:
        """Add the mode in which the nonlinear elements are in these states."""
        if self.count == self.modes.reach.shape[0]:
            more = (np.concatenate([array, np.zeros_like(array)]) for array in self.modes[1:])
            self.modes = Modes(self.modes.number, *more)
        modes, m, self.count = self.modes, self.count, self.count + 1
        modes.state[m, : states.size] = states
        modes.number[_code(states)] = m
        if not build(*self.mechanics, modes.state[m], modes.maps[m], modes.reaction[m], modes.limits[m]):
            return False
        modes.reach[m] = discretise(self.mechanics.sizes, self.used, modes.maps[m], modes.steps[m], self.table.step)
        return True

    def go_on_from(self, ending: Ending) -> None:
        """Begin in the mode in which another integration of the same mechanism ended."""
        states, n = np.array(ending.mode, dtype=np.int64), self.system.order
        self.mode(states)
        self.place[kernel.MODE] = self.record.visited[:1] = self.modes.number[_code(states)]
        self.work[kernel.SCALE, :n] = np.maximum(self.work[kernel.SCALE, :n], ending.scale)

    @property
    def now(self) -> float:
        """Time reached [s]."""
        return float(self.record.time[self.place[kernel.SEGMENT]] + self.work[kernel.CLOCK, 0])

    @property
    def state(self) -> Matrix:
        """State now."""
        return self.work[kernel.STATE, : self.system.order].copy()

    @property
    def ending(self) -> Ending:
        """What to go on with."""
        mode = self.modes.state[self.place[kernel.MODE], : len(self.system.nonlinear)]
        scale = np.maximum(self.work[kernel.SCALE, : self.system.order], np.abs(self.state))
        return Ending(self.system.mechanism, tuple(mode.tolist()), scale)

    @property
    def eta(self) -> slice:
        """Rows of the maps that hold a', w and the nonlinear elements' forces."""
        return slice(int(self.mechanics.sizes[ETA]), int(self.mechanics.sizes[ENTRY]))

    @property
    def seen(self) -> slice:
        """Rows of the maps that hold the state as the mode sees it."""
        return slice(int(self.mechanics.sizes[SEEN]), int(self.mechanics.sizes[SEEN]) + self.system.order)

    @property
    def guards(self) -> slice:
        """Rows of the maps that hold what each state of an element is judged by: of a slip, its velocity."""
        first = int(self.mechanics.sizes[GUARD])
        return slice(first, first + len(self.system.nonlinear))

    def mode(self, states: NDArray[np.int64]) -> Matrix:
        """The maps of the mode in which the nonlinear elements are in these states.

        Raises `SimulationError` if their forces are not determined there.
        """
        if self.modes.number[_code(states)] < 0 and not self.build(states):
            raise SimulationError(f"Cannot go on: {_SINGULAR}.")
        return np.asarray(self.modes.maps[self.modes.number[_code(states)]])

    def mismatch(self, before: Matrix) -> float:
        """Change of the state since `before`, relative to the largest velocity, or position, so far."""
        na, n = self.system.motions[0].shape[1], self.system.order
        change = np.abs(self.state - before)
        scale = np.max(np.abs([self.state, before, self.work[kernel.SCALE, :n]]), axis=0)  # the last knows events alone
        parts = (slice(0, na), slice(na, n))
        return max(float(change[p].max(initial=0.0) / max(scale[p].max(initial=0.0), 1e-300)) for p in parts)

    def _failed(self, why: str) -> Status:
        return Status(StatusKind.FAILED, f"at t = {self.now:.6g} s {why}; nothing comes after that")


def _code(states: NDArray[np.int64]) -> int:
    """Number of a combination of states of the elements, among all that there are."""
    return int("".join(str(state + 1) for state in states) or "0", 3)


_FAILURES = {
    kernel.CHATTER: "the elements change their states without end (chattering)",
    kernel.IMPACT: "two inertias meet without compliance between them",
    kernel.NO_MODE: "no combination of slip, stick and contact can go on",
    kernel.NOT_FINITE: "the motion grows beyond all bounds",
    kernel.STIFF: "something answers more than 10 000 times faster than the step (a damper on a small inertance, "
    "most often); take a step of that order, or leave out what is so fast",
}
KERNELS: tuple[Any, ...] = (build, kernel.integrate, discretise, kernel.evaluate)
_SINGULAR = "the forces in a combination of slip, stick and contact are not determined"


def start(
    system: PiecewiseSystem,
    table: InputTable,
    state: Matrix,
    outputs: Sequence[str] = (),
    *,
    keep: bool = True,
    account: bool = False,
    settled: int = 0,
    after: Ending | None = None,
) -> Integration:
    """An integration at its beginning.

    `keep` the states at all samples; `outputs` are to be squared and added up from knot `settled` on; `account` for
    the energy. It goes on in the mode in which another one of the same mechanism ended, if it comes `after` one.

    Raises `SimulationError` if there are more frictions and gaps than combinations of their states can be numbered.
    """
    prepare(KERNELS)
    if len(system.nonlinear) > MOST_ELEMENTS:
        raise SimulationError(
            f"The event-driven integrator takes up to {MOST_ELEMENTS} frictions and gaps, got {len(system.nonlinear)}. "
            f'Take integrator="time-stepping", or join those that always act together.'
        )
    n, nu, k = system.order, system.inputs, len(system.nonlinear)
    na, nw = (motion.shape[1] for motion in system.motions[:2])
    rows = [output_rows(system, system.outputs[name]) for name in outputs] + (energy_rows(system) if account else [])
    over = np.array([np.concatenate(row) for row in rows]).reshape(len(rows), n + nu + na + nw + k)
    roads, channels = len(system.mechanism.roads), table.value.shape[1]
    used = _used(system, table, bool(rows))
    starts = np.cumsum([0, n, k, na + nw + k, nw + k, len(rows), n])
    dampers = sum(b.element.linear is Linear.DAMPING for b in system.graph.branches)
    mechanics = Mechanics(
        sizes=np.array([na, nw, roads, n, k, dampers, len(outputs), *starts[1:6]], dtype=np.int64),
        **vars(system.mechanics),
        over=over,
    )
    branches = system.graph.branches if account else ()
    samples, channels = table.samples if keep else 0, table.value.shape[1]
    jumps = channels if table.jumps else 0
    sharp = any(element.switches_by(Guard.ELONGATION) for element in system.nonlinear_elements)
    columns, followed, swaying = lines_of(n, used.size, k, len(outputs), jumps, sharp)
    work = np.zeros(
        (kernel.ROWS, max(64, columns + followed + swaying + n, nu, 4 * channels, channels + len(branches)))
    )
    work[kernel.STATE, :n], work[kernel.SCALE, :n] = state, np.abs(state)
    record = kernel.Record(
        time=table.time,
        value=table.value,
        slope=table.slope,
        value_before=table.value_before,
        slope_before=table.slope_before,
        special=table.special,
        slot=table.slot,
        states=np.empty((samples, n)),
        visited=np.zeros(samples, np.int64),
        sums=np.zeros((2, len(outputs))),
        events=np.empty((1024, 4)),
        branch_road=np.array([b.roads for b in branches]).reshape(len(branches), roads),
        gauss=np.array([0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS]),
    )
    record.states[:1] = state
    place = np.array([0, -1, 0, 0, 0, 0, 0, settled, account, nu, 0, 0, 0], np.int64)
    march = march_of(n, tuple(used.tolist()), k, len(outputs), jumps, sharp)
    capacity, width = min(3**k, 9), n + nu + 1
    modes = Modes(
        number=np.full(3**k, -1, np.int64),
        state=np.zeros((capacity, k + 3), np.int64),
        maps=np.zeros((capacity, int(starts[6]), width)),
        reaction=np.zeros((capacity, n + k, nw + k)),
        limits=np.zeros((capacity, 2 * k, 2)),
        steps=np.zeros((capacity, columns + jumps, followed + swaying)),
        reach=np.zeros(capacity),
    )
    flags = np.zeros((4, k), np.int64)
    integration = Integration(system, table, march, mechanics, modes, state, used, work, flags, place, record, account)
    if k == 1 and mechanics.limit[0] > 0.0:  # all three will be met: save the ways back to have them built
        for s in (0, 1, -1):
            integration.build(np.array([s]))
    if after is not None and after.mechanism == system.mechanism:
        integration.go_on_from(after)
    return integration


def _used(system: PiecewiseSystem, table: InputTable, outputs: bool) -> NDArray[np.int64]:
    """Which of the knot numbers matter: none of an input at rest, and of a road most often not its height."""
    n, roads = system.order, len(system.mechanism.roads)
    na, nw = (motion.shape[1] for motion in system.motions[:2])
    mechanics = system.mechanics
    heights = (
        outputs
        or np.any(mechanics.balance[:, na + nw + n : na + nw + n + roads])
        or np.any(mechanics.lengths[:, n - na :])
    )
    numbers = range(4 * len(table.moving))
    used = [i for i in numbers if table.moving[i // 4] and (i % 4 or i >= 4 * roads or heights)]
    return np.array(used, dtype=np.int64)


def energy_rows(system: PiecewiseSystem) -> list[tuple[Matrix, Matrix, Matrix]]:
    """Rates, then forces, of all branches, then velocities of the ports of external forces."""
    count, nodes = len(system.graph.branches), len(system.graph.nodes)
    rows = []
    for b in system.graph.branches:
        rows.append(output_rows(system, Output("", "", "", velocity=b.nodes, road_velocity=b.roads)))
    rows += [output_rows(system, Output("", "", "", forces=row)) for row in np.eye(count)]
    for force in system.mechanism.forces:
        port = np.zeros(nodes)
        port[: len(system.mechanism.coordinates)] = [force.port.get(c.name, 0.0) for c in system.mechanism.coordinates]
        rows.append(output_rows(system, Output("", "", "", velocity=port)))
    return rows
