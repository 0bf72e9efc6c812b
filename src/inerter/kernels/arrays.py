"""Structures of compiled code: named fields with their types.

Annotations are types to the compiler too: `Annotated` says them in its words, or by a data type of NumPy.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

Array = Any  # of any type: compiled for those that it is called with
Ints = Annotated[Any, "int64[::1]"]
Flags = Annotated[Any, "boolean[::1]"]
IntTable = Annotated[Any, "int64[:,::1]"]
Floats = Annotated[Any, "float64[::1]"]
Matrix = Annotated[Any, "float64[:,::1]"]
Matrices = Annotated[Any, "float64[:,:,::1]"]
ConstantInts = Annotated[Any, "Array(int64, 1, 'C', readonly=True)"]

FRICTION, GAP = 0, 1
KIND, OWN_POSITION = 0, 1  # columns of the table of elements of a piecewise system
NONE: Any = np.int64(-1)  # no mode, or nobody: a plain -1 is a type of its own to the compiler, and compiles twice
SHARP = 4  # terms of a guard's sway over a step that are values, where that is worth it ...
AT_ONCE = 1  # ... and of those the ones that are computed with every step, in a march that is sharp


def record(fields: list[tuple[str, type]]) -> np.dtype[Any]:
    """A type of records whose fields are attributes, in Python as in compiled code."""
    return np.dtype((np.record, fields))


PLACE = record(
    [
        ("segment", np.int64),  # between which knots
        ("mode", np.int64),  # number of the mode, or -1 before the first one is known
        ("events", np.int64),  # so many so far
        ("special", np.int64),  # which segment of another length than the step comes next
        ("jumped", np.int64),  # BEFORE, SMOOTH or BROKEN: what has been done about the inputs at this knot
        ("switches", np.int64),  # within this segment
        ("wanted", np.int64),  # the state that an element in question must have
        ("settled", np.int64),  # the first knot whose squares count
        ("known", np.int64),  # order of the last derivative that is known
        ("left", np.int64),  # pieces before the next look at the keyboard
        ("ended", np.int64),  # 1: a slip may have ended with the segment before
        ("clock", np.float64),  # time within the segment [s]
        ("zero", np.float64),  # what counts as zero in a guard, relative to the largest state so far
    ]
)
BEFORE, SMOOTH, BROKEN = 0, 1, 2  # nothing yet; inputs go on as they were; a value or a slope is another one
WATCH = record(
    [
        ("trial", np.int64),  # the state on trial
        ("touch", np.int64),  # so many leading coefficients of its guard are zero just now ...
        ("side", np.int64),  # ... at this limit, -1 or 1
        ("crossed", np.int64),  # the limit that has been crossed with a slope beyond all rounding, or 0
    ]
)
EVENT = record([("time", np.float64), ("element", np.int64), ("before", np.int64), ("after", np.int64)])


class Sizes(NamedTuple):
    """Numbers of coordinates, inputs, elements and outputs."""

    inertial: int  # velocities that inertia carries
    massless: int  # velocities of massless motions
    roads: int
    states: int
    inputs: int  # roads' z, z', z'', and forces
    elements: int  # frictions and gaps
    dampers: int
    squares: int  # outputs that are squared and added up


class MapRows(NamedTuple):
    """First rows of the parts of `Modes.maps` that come after the rates of the state."""

    guard: int  # of each element
    eta: int  # a', w and the forces of the elements
    entry: int  # conditions on entry
    output: int  # squared outputs, then what the energy account needs
    projected_state: int  # the state after projection onto the mode


class Mechanics(NamedTuple):
    """A mechanism's constants. Columns of maps are the state (a, g), roads' z, z', z'', forces, and 1 (`width`)."""

    sizes: Sizes
    rows: MapRows
    balance: Matrix  # (na + nw, na + nw + width): M, C_aw; 0, C_ww; then right-hand sides without elements' forces
    rates: Matrix  # (ng + k + dampers + springs, na + nw + nr): of positions and elongations, over a, w, z'
    lengths: Matrix  # (k, ng + nr): elongation of the gaps from positions and roads
    kind: Ints  # (k,) FRICTION or GAP
    own_position: Ints  # (k,) number of the position that is the gap's own elongation, or -1
    limits: Matrix  # (k, 2): forces or elongations between which it is in state 0, see `locking.can_be_in`
    over: Matrix  # (outputs, n + nu + na + nw + k): outputs over the state, the inputs, and (a', w, F)


class Mode(NamedTuple):
    """One row of `Modes`, without what `discretise` makes of it."""

    state: Ints
    conditions: Ints
    maps: Matrix
    reaction: Matrix
    limits: Matrix
    entry_limits: Matrix


class Modes(NamedTuple):
    """Modes reached so far, one row each."""

    number: Ints  # (3^k,) index of the mode that a state of the elements has, or -1
    state: IntTable  # (capacity, k): -1, 0, 1 of each element
    conditions: IntTable  # (capacity, 3): numbers of conditions on velocity, of springs, of the loose
    maps: Matrices  # (capacity, rows, width): rates, guards, (a', w, F), entry conditions, outputs, the projected state
    reaction: Matrices  # (capacity, n + k, conditions): jump of the state, and impulse on each element
    limits: Matrices  # (capacity, k, 2): intervals of the guards while the mode lasts
    entry_limits: Matrices  # the same on entry
    steps: Matrices  # (capacity, lines, rows): see `integrate.lines_of`, and then `flow.series`
    reach: Floats  # (capacity,) how far a Taylor series of the flow serves [s]


class IntegrationState(NamedTuple):
    """State of an integration, from which it can resume at any point."""

    place: Annotated[Any, (PLACE,)]  # one
    state: Floats
    scale: Floats  # largest size of each state so far
    energy: Floats  # through roads and forces, then that which branches took
    watch: Annotated[Any, (WATCH,)]  # (k,) what is known of each element


class Room(NamedTuple):
    """Work space of an integration; every entry is overwritten at each use."""

    numbers: Floats  # the cubics of the inputs over this segment, see `flow.knot_numbers`
    line: Floats  # of the march
    guess: Floats  # a state on trial
    residual: Floats  # of conditions on entry
    given: Floats  # inputs at one time
    guard: Floats  # polynomial of a guard ...
    distance: Floats  # ... and of its distance from a limit
    ends: Floats  # of intervals in which a root is looked for
    inputs: Matrix  # (orders, inputs): coefficients of the inputs in powers of t / d; those beyond a cubic stay zero
    input_sizes: Matrix  # sums of the sizes of what these are added up from
    series: Matrix  # coefficients of the state in powers of t / d, and of guards: see `flow.series`
    sizes: Matrix  # as `input_sizes`


class Run(NamedTuple):
    """An integration under way."""

    mechanics: Mechanics
    modes: Modes
    motion: IntegrationState
    room: Room


class Knots(NamedTuple):
    """The inputs, and which knots are samples."""

    time: Floats  # (segments + 1,)
    value: Matrix  # (segments + 1, channels) of roads, then of forces
    slope: Matrix
    value_before: Matrix  # the same from the left
    slope_before: Matrix
    special: Ints  # segments of another length than the step, then one past the end
    slot: Ints  # (segments + 1,) number of the sample at each knot, or -1


class History(NamedTuple):
    """Recorded samples, mean squares and events of a motion."""

    states: Matrix  # (samples or 0, n)
    visited: Ints  # (samples or 0,) mode at each sample
    squares: Floats  # (outputs,) sums of squares
    last: Floats  # the last squares that were added
    events: Annotated[Any, (EVENT,)]


class Account(NamedTuple):
    """Data of the energy account, if it is wanted."""

    wanted: bool
    branch_road: Matrix  # (branches or 0, roads)
    nodes: Floats  # of Gauss's rule on [0, 1]
    weights: Floats


class MarchShape(NamedTuple):
    """Sizes of a march, see `integrate.march_of`."""

    states: int
    inputs: int  # numbers of the inputs over a step that are used
    elements: int
    squares: int
    jumps: int  # inputs that may jump at every knot
    rows: int
    sharp: bool


class March(NamedTuple):
    """Whole steps: compiled code for one shape at an address, or 0, and what it was compiled for."""

    address: int
    shape: MarchShape
    numbers: Ints  # which of `flow.knot_numbers` are used


class MarchLines(NamedTuple):
    """Matrices and state for whole steps in one mode."""

    steps: Matrix  # a line each column, see `integrate.lines_of`
    limits: Matrix  # of the guards
    state: Floats  # changed in place
    work: Floats  # room for `integrate.Path`


class Span(NamedTuple):
    """Range of the steps to make."""

    step: float
    mode: int
    first: int  # segment
    stop: int
    settled: int  # the first segment whose squares count
