"""The event-driven integrator: compiled kernels on arrays, and the room that they need."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import product
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, SimulationError, Status, StatusKind
from inerter.formatting import format_quantity
from inerter.kernels import switching
from inerter.kernels.arrays import (
    EVENT,
    KIND,
    OWN_POSITION,
    PLACE,
    WATCH,
    Account,
    History,
    IntegrationState,
    Knots,
    MapRows,
    March,
    Mechanics,
    Mode,
    Modes,
    Room,
    Run,
    Sizes,
)
from inerter.kernels.crossing import ORDERS
from inerter.kernels.discretise import discretise
from inerter.kernels.events import evaluate, integrate
from inerter.kernels.flow import series_lines
from inerter.kernels.integrate import lines_of, march_for, march_of, room_of, round_up
from inerter.kernels.modes import build
from inerter.kernels.prepare import prepare
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.simulation.inputs import InputTable
from inerter.simulation.threads import check_wanted
from inerter.simulation.trajectory import FinalState
from inerter.systems.outputs import Output
from inerter.systems.piecewise import PiecewiseSystem, output_rows

Matrix = NDArray[np.float64]
MOST_ELEMENTS = 12
_SEGMENTS, _PIECES = 200_000, 4000  # at most between two looks at the keyboard: some 10 ms
_TERMS = 31  # of a series, at most
_FAST = 1.5  # radians, or times, by which the fastest motion goes on in a step that is divided
_MOST_PARTS, _MOST_ENTRIES = 32, 4_000_000  # of a step, and of the table of inputs with these: 130 MB
_KEPT = 16  # machines, such as of one design on many roads
_MET_BY_ROADS = 2  # elements whose combinations of states random roads visit nearly all


@dataclass
class Integration:
    """State of an event-driven integration: contact states reached so far, motion, and recorded samples."""

    system: PiecewiseSystem
    table: InputTable
    march: March
    mechanics: Mechanics
    modes: Modes
    begun: Matrix  # the state at the start, before anything that jumps there
    used: NDArray[np.int64]
    motion: IntegrationState
    room: Room
    knots: Knots
    record: History
    account: Account
    known: dict[Any, Matrix]  # what follows from the modes of a system, for all integrations of it
    count: int = 0
    status: Status = OK
    warning: Status = OK  # of a run that went to its end

    def advance(self, stop: int) -> None:
        """Integrate up to knot `stop`, or until an error occurs, which `status` then states.

        Raises `CancelledError` in a thread of `threads` whose work is not wanted any more.
        """
        place = self.motion.place
        while self.status.ok and self.segment < stop:
            check_wanted()
            place["left"] = _PIECES
            until = min(stop, self.segment + _SEGMENTS)
            run = Run(self.mechanics, self.modes, self.motion, self.room)
            code = integrate(run, self.knots, self.record, self.account, self.march, self.table.step, until)
            if code == switching.MODE_UNKNOWN:
                if not self.build(self.motion.watch["trial"]):
                    self.status = self._failure_status(_SINGULAR)
            elif code == switching.EVENTS_FULL:
                events = self.record.events
                self.record = self.record._replace(events=np.concatenate([events, events]))
            elif code not in (switching.DONE, switching.PAUSED):
                self.status = self._failure_status(self._too_stiff() if code == switching.STIFF else _FAILURES[code])

    def build(self, states: NDArray[np.int64]) -> bool:
        """Add the mode in which the nonlinear elements are in these states."""
        if self.count == self.modes.reach.shape[0]:
            more = (np.concatenate([array, np.zeros_like(array)]) for array in self.modes[1:])
            self.modes = Modes(self.modes.number, *more)
        self.count += 1
        return _add_mode(self, self.modes, self.count - 1, states, self.table.step)

    def ended_on(self, table: InputTable) -> None:
        """Refer to `table`, of which its own is a refined one, at the end of both: less to keep with a trajectory."""
        self.table, self.knots = table, table.knots
        self.motion.place["segment"] = table.time.size - 1

    def go_on_from(self, ending: FinalState) -> None:
        """Begin in the mode in which another integration of the same mechanism ended."""
        states = np.array(ending.mode, dtype=np.int64)
        self.mode(states)
        self.motion.place["mode"] = self.record.visited[:1] = self.modes.number[_code(states)]
        self.motion.scale[:] = np.maximum(self.motion.scale, ending.scale)

    @property
    def segment(self) -> int:
        """Number of the segment between knots that was reached."""
        return int(self.motion.place["segment"][0])  # by its array: attributes of a record take Python a microsecond

    @property
    def events(self) -> int:
        """Number of events."""
        return int(self.motion.place["events"][0])

    @property
    def now(self) -> float:
        """Time reached [s]."""
        return float(self.table.time[self.segment] + self.motion.place["clock"][0])

    @property
    def state(self) -> Matrix:
        """State now."""
        return np.array(self.motion.state)

    @property
    def ending(self) -> FinalState:
        """Final contact state and scales, from which a further simulation continues."""
        mode = self.modes.state[self.motion.place["mode"][0]]
        scale = np.maximum(self.motion.scale, np.abs(self.state))
        return FinalState(self.system.mechanism, tuple(mode.tolist()), scale)

    @property
    def eta(self) -> slice:
        """Rows of the maps that hold a', w and the nonlinear elements' forces."""
        return slice(self.mechanics.rows.eta, self.mechanics.rows.entry)

    @property
    def projected_state(self) -> slice:
        """Rows of the maps with the state after its projection onto the mode."""
        return slice(self.mechanics.rows.projected_state, self.mechanics.rows.projected_state + self.system.order)

    @property
    def guards(self) -> slice:
        """Rows of the maps that hold what each state of an element is judged by: of a slip, its velocity."""
        first = self.mechanics.rows.guard
        return slice(first, first + len(self.system.nonlinear))

    def mode(self, states: NDArray[np.int64]) -> Matrix:
        """The maps of the mode in which the nonlinear elements are in these states.

        Raises `SimulationError` if their forces are not determined there.
        """
        if self.modes.number[_code(states)] < 0 and not self.build(states):
            raise SimulationError(f"Cannot continue: {_SINGULAR}.")
        return np.asarray(self.modes.maps[self.modes.number[_code(states)]])

    def mismatch(self, before: Matrix) -> float:
        """Change of the state since `before`, relative to the largest velocity, or position, so far."""
        na, n = self.system.motions[0].shape[1], self.system.order
        change = np.abs(self.state - before)
        scale = np.maximum(np.maximum(np.abs(self.state), np.abs(before)), self.motion.scale)  # that of events
        parts = (slice(0, na), slice(na, n))
        return max(float(change[p].max(initial=0.0) / max(scale[p].max(initial=0.0), 1e-300)) for p in parts)

    def _too_stiff(self) -> str:
        """Message on the elements that relax too fast for the step, by their power in the fastest motion."""
        n, na, branches = self.system.order, self.system.motions[0].shape[1], self.system.graph.branches
        maps = self.modes.maps[self.motion.place["mode"][0]]
        poles, motions = np.linalg.eig(maps[:n, :n])
        fastest = int(np.argmax(np.abs(poles)))
        rate, motion = float(np.abs(poles[fastest])), motions[:, fastest]
        massless = maps[self.eta, :n][na : na + self.system.motions[1].shape[1]] @ motion
        speeds = np.abs(self.system.rates[0] @ motion[:na] + self.system.rates[1] @ massless)
        taken = {
            LinearRole.DAMPING: 1.0,
            LinearRole.STIFFNESS: 1.0 / rate,
        }  # by a damper c v^2, by a spring k (v / rate) v
        powers = np.array(
            [
                taken.get(b.element.linear, 0.0) * b.element.coefficient * v**2
                for b, v in zip(branches, speeds, strict=True)
            ]
        )
        named = [b.label for b, power in zip(branches, powers, strict=True) if power >= 0.5 * powers.max() > 0.0]
        return (
            f"{' and '.join(named) or 'a motion'} relax in {format_quantity(1.0 / rate, 's', 2)}, more than 10 000 "
            f"times faster than the step of {format_quantity(self.table.step, 's', 6)}. Leave out what is so fast, "
            f"such as a damper on a small inertance or a contact, change its value, or take a step of that order"
        )

    def _failure_status(self, why: str) -> Status:
        return Status(StatusKind.FAILED, f"at t = {format_quantity(self.now, 's', 6)} {why}; the simulation ends there")


def _code(states: NDArray[np.int64]) -> int:
    """Number of a combination of states of the elements, in base 3."""
    code = 0
    for state in states.tolist():
        code = 3 * code + state + 1
    return code


_FAILURES = {
    switching.CHATTER: "chattering: the elements change their states without end",
    switching.IMPACT: "impact of two inertias without compliance between them",
    switching.NO_MODE: "no consistent combination of slip, stick and contact",
    switching.NOT_FINITE: "the motion grows beyond all bounds",
}
KERNELS: tuple[Any, ...] = (build, integrate, discretise, evaluate)
_SINGULAR = "the forces in a combination of slip, stick and contact are not determined"


def check_elements(system: PiecewiseSystem) -> None:
    """Raises `SimulationError` if there are more frictions and gaps than combinations of states can be numbered."""
    if len(system.nonlinear) > MOST_ELEMENTS:
        raise SimulationError(
            f"The event-driven integrator supports up to {MOST_ELEMENTS} frictions and gaps, got "
            f'{len(system.nonlinear)}. Use integrator="time-stepping", or join those that always act together.'
        )


def start(
    system: PiecewiseSystem,
    table: InputTable,
    state: Matrix,
    outputs: Sequence[str] = (),
    *,
    keep: bool = True,
    account: bool = False,
    discard: int = 0,
    after: FinalState | None = None,
) -> Integration:
    """An integration at its beginning.

    `keep` the states at all samples; `outputs` are to be squared and added up after sample number `discard`; `account`
    for the energy. It goes on in the mode in which another one of the same mechanism ended, if it comes `after` one.

    Raises `SimulationError` as `check_elements` does.
    """
    prepare(KERNELS)
    check_elements(system)
    jumps = table.value.shape[1] if table.jumps else 0
    machine = _machine(system, tuple(outputs), account, table.moving, jumps, table.step)
    sizes = machine.mechanics.sizes
    integration = Integration(
        system=system,
        table=table,
        march=march_for(table.time.size, machine.march),
        mechanics=machine.mechanics,
        modes=own_modes(machine.modes),
        begun=state,
        used=machine.used,
        motion=_motion(system, state, table.knot_of(discard)),
        room=_room(sizes, table.value.shape[1], room_of(machine.march.shape)),
        knots=table.knots,
        record=_record(sizes, state, table.samples if keep else 0),
        account=_account(system, account),
        known=machine.known,
        count=int(np.count_nonzero(machine.modes.number >= 0)),
    )
    if after is not None and after.mechanism == system.mechanism:
        integration.go_on_from(after)
    return integration


def start_finely(
    system: PiecewiseSystem, table: InputTable, state: Matrix, outputs: Sequence[str] = (), **others: Any
) -> Integration:
    """An integration at its beginning, as `start`, whose whole steps resolve the fastest motion.

    Where the steps of `table` are too long for that, they are divided: a step in which a fast motion might bring a
    guard to its limit takes a hundred times as long. `table` of the integration is the one with these knots.
    """
    begun = start(system, table, state, outputs, **others)
    parts = 1 if begun.account.wanted else _parts_of_a_step(begun)
    return begun if parts == 1 else start(system, table.refine(parts), state, outputs, **others)


def _parts_of_a_step(begun: Integration) -> int:
    """Number of parts of a step in each of which the fastest motion known can be resolved; 1 if they were too many."""
    if begun.count == 0 and begun.system.nonlinear:
        reached = np.isfinite(begun.mechanics.limits)
        begun.build(np.where(reached[:, 1], 1, np.where(reached[:, 0], -1, 0)))  # all slip, or touch
    fastest = begun.table.step / min(begun.modes.reach[: begun.count].tolist(), default=math.inf)
    parts = math.ceil(fastest) if fastest > _FAST else 1
    return parts if parts <= _MOST_PARTS and parts * begun.table.value.size <= _MOST_ENTRIES else 1


@dataclass(frozen=True, eq=False)
class _Machine:
    """Parts that integrations of a system share, if their tables have one step and move the same inputs."""

    mechanics: Mechanics
    march: March
    used: NDArray[np.int64]
    modes: Modes  # for integrations to copy, unless they are all: each adds its own
    known: dict[Any, Matrix]


@lru_cache(maxsize=_KEPT)
def _machine(
    system: PiecewiseSystem, outputs: tuple[str, ...], account: bool, moving: tuple[bool, ...], jumps: int, step: float
) -> _Machine:
    """The machine of a system, kept for further runs; with all modes if these are few and will be met."""
    rows = [output_rows(system, system.outputs[name]) for name in outputs] + (energy_rows(system) if account else [])
    mechanics, used = _mechanics(system, rows, len(outputs)), _used_knot_numbers(system, moving, rows)
    sizes, limits = mechanics.sizes, mechanics.limits
    sharp = any(element.switches_by(GuardRole.ELONGATION) for element in system.nonlinear_elements)
    shape = (sizes.states, used.size, sizes.elements, sizes.squares, jumps, sharp)
    lines, followed, swaying = lines_of(*shape)
    march, modes = (
        march_of(sizes.states, tuple(used.tolist()), *shape[2:]),
        _modes(mechanics, lines + series_lines(sizes.states, sizes.inputs), followed + swaying),
    )
    machine, count = _Machine(mechanics, march, used, modes, {}), 0
    switch = all(-math.inf < lower < upper < math.inf for lower, upper in limits.tolist())
    if switch and 1 <= sizes.elements <= (_MET_BY_ROADS if outputs else 1):
        for states in product((0, 1, -1), repeat=sizes.elements):
            count += _add_mode(machine, modes, count, np.array(states, dtype=np.int64), step)
    return machine


def _add_mode(machine: _Machine | Integration, modes: Modes, m: int, states: NDArray[np.int64], step: float) -> bool:
    """Fill mode m, in which the nonlinear elements are in these states; False if it is singular."""
    modes.state[m] = states
    rows = (modes.state[m], modes.conditions[m], modes.maps[m], modes.reaction[m], modes.limits[m])
    if not build(machine.mechanics, Mode(*rows, modes.entry_limits[m])):
        return False
    modes.number[_code(states)] = m
    sizes, first, shape = machine.mechanics.sizes, machine.mechanics.rows, machine.march.shape
    modes.reach[m] = discretise(sizes, first, machine.used, shape, modes.maps[m], modes.steps[m], step)
    return True


def own_modes(modes: Modes) -> Modes:
    """Modes that can be added to; the same if there are no others."""
    if not np.count_nonzero(modes.number < 0):
        return modes
    steps = aligned_zeros(*modes.steps.shape)
    steps[:] = modes.steps
    return Modes(*(steps if array is modes.steps else array.copy() for array in modes))


def _mechanics(system: PiecewiseSystem, rows: list[tuple[Matrix, Matrix, Matrix]], squares: int) -> Mechanics:
    """The constants, with rows of outputs, of which the first are squared."""
    n, k = system.order, len(system.nonlinear)
    na, nw = (motion.shape[1] for motion in system.motions[:2])
    dampers = sum(b.element.linear is LinearRole.DAMPING for b in system.graph.branches)
    known, width, eta = system.kinematics, n + system.inputs + na + nw + k, n + k
    entry, output = eta + na + nw + k, eta + na + nw + k + nw + k
    return Mechanics(
        sizes=Sizes(na, nw, len(system.mechanism.roads), n, system.inputs, k, dampers, squares),
        rows=MapRows(n, eta, entry, output, output + len(rows)),
        balance=system.balance,
        rates=known.moving,
        lengths=known.lengths,
        kind=np.ascontiguousarray(known.elements[:, KIND]),
        own_position=np.ascontiguousarray(known.elements[:, OWN_POSITION]),
        limits=system.limits,
        over=np.array([np.concatenate(row) for row in rows]) if rows else np.zeros((0, width)),
    )


def _modes(mechanics: Mechanics, lines: int, rows: int) -> Modes:
    """Room for modes, and for steps of so many lines and rows of each."""
    sizes, k = mechanics.sizes, mechanics.sizes.elements
    capacity = min(3**k, 9)
    return Modes(
        number=np.full(3**k, -1, np.int64),
        state=np.zeros((capacity, k), np.int64),
        conditions=np.zeros((capacity, 3), np.int64),
        maps=np.zeros((capacity, mechanics.rows.projected_state + sizes.states, sizes.states + sizes.inputs + 1)),
        reaction=np.zeros((capacity, sizes.states + k, sizes.massless + k)),
        limits=np.zeros((capacity, k, 2)),
        entry_limits=np.zeros((capacity, k, 2)),
        steps=aligned_zeros(capacity, lines, rows),
        reach=np.zeros(capacity),
    )


def aligned_zeros(*shape: int) -> Matrix:
    """Zeros that begin where a cache line does: vectors of four then never lie across two."""
    size, line = prod(shape), 64
    room = np.zeros(size + line // 8)
    first = -room.__array_interface__["data"][0] % line // 8  # an attribute ctypes takes several times as long
    return room[first : first + size].reshape(shape)


def _motion(system: PiecewiseSystem, state: Matrix, settled: int) -> IntegrationState:
    place = np.zeros(1, PLACE)
    place["mode"], place["settled"] = -1, settled
    ports = len(system.mechanism.roads) + len(system.mechanism.forces)
    return IntegrationState(
        place=place,
        state=np.array(state, dtype=float),
        scale=np.abs(state),
        energy=np.zeros(ports + len(system.graph.branches)),
        watch=np.zeros(len(system.nonlinear), WATCH),
    )


def _room(sizes: Sizes, channels: int, line: int) -> Room:
    n, nu, most = sizes.states, sizes.inputs, sizes.massless + sizes.elements
    return Room(
        numbers=np.zeros(4 * channels),
        line=aligned_zeros(line),
        guess=np.zeros(n),
        residual=np.zeros(most),
        given=np.zeros(nu),
        guard=np.zeros(_TERMS),
        distance=np.zeros(_TERMS),
        ends=np.zeros(64),
        inputs=np.zeros((ORDERS, nu)),
        input_sizes=np.zeros((ORDERS, nu)),
        series=aligned_zeros(2 * _TERMS + 1, round_up(n + sizes.elements)),
        sizes=np.zeros((ORDERS, n)),
    )


def _record(sizes: Sizes, state: Matrix, samples: int) -> History:
    states = np.empty((samples, sizes.states))
    states[:1] = state
    squares, last = np.zeros((2, sizes.squares))
    events = np.zeros(1024, EVENT)
    return History(states, np.zeros(samples, np.int64), squares, last, events)


def _account(system: PiecewiseSystem, wanted: bool) -> Account:
    through = np.zeros((0, len(system.mechanism.roads)))
    if wanted and system.graph.branches:
        through = np.array([b.roads for b in system.graph.branches])
    return Account(wanted, through, *_gauss_rule())


@cache
def _gauss_rule() -> tuple[Matrix, Matrix]:
    """Nodes and weights of a quadrature over [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(10)
    return 0.5 * (nodes + 1.0), 0.5 * weights


def _used_knot_numbers(
    system: PiecewiseSystem, moving: tuple[bool, ...], rows: Sequence[tuple[Matrix, Matrix, Matrix]]
) -> NDArray[np.int64]:
    """Numbers of the knot values in use: none of an input at rest, and heights of a road only where needed."""
    n, roads = system.order, len(system.mechanism.roads)
    na, nw = (motion.shape[1] for motion in system.motions[:2])
    heights = (
        any(np.count_nonzero(on_u[:roads]) for _, on_u, _ in rows)
        or np.count_nonzero(system.balance[:, na + nw + n : na + nw + n + roads])
        or np.count_nonzero(system.kinematics.lengths[:, n - na :])
    )
    numbers = range(4 * len(moving))
    used = [i for i in numbers if moving[i // 4] and (i % 4 or i >= 4 * roads or heights)]
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
