"""The arrays that the modes of a piecewise-linear mechanism live in, and where what is in them."""

from __future__ import annotations

from typing import Any, NamedTuple

Array = Any
FRICTION, GAP = 0, 1
KIND, OWN_POSITION = 0, 1  # columns of `Mechanics.elements`
NA, NW, NR, N, K, DAMPERS, OUTPUTS, GUARD, ETA, ENTRY, OUTPUT, SEEN = range(12)  # in `Mechanics.sizes`
SHARP = 4  # terms of a guard's sway over a step that are values, where that is worth it


class Mechanics(NamedTuple):
    """A mechanism's constants. Columns of maps are the state (a, g), roads' z, z', z'', forces, and 1 (`width`)."""

    sizes: Array  # na, nw, nr, n, k, numbers of dampers and squared outputs, then first rows of parts of `Modes.maps`
    balance: Array  # (na + nw, na + nw + width): M, C_aw; 0, C_ww; then right-hand sides without elements' forces
    rates: Array  # (ng + k + dampers + springs, na + nw + nr): of positions and elongations, over a, w, z'
    lengths: Array  # (k, ng + nr): elongation of the gaps from positions and roads
    elements: Array  # (k, 2) FRICTION or GAP; number of the position that is the gap's own elongation, or -1
    limit: Array  # (k,) force or half-width; an element whose limit is zero never changes its state
    over: Array  # (outputs, n + nu + na + nw + k): outputs over the state, the inputs, and (a', w, F)


class Modes(NamedTuple):
    """Modes met so far, one row each."""

    number: Array  # (3^k,) index of the mode that a state of the elements has, or -1
    state: Array  # (capacity, k + 3): -1, 0, 1 of each element; numbers of conditions on velocity, springs, the loose
    maps: Array  # (capacity, rows, width): rates, guards, (a', w, F), entry conditions, outputs, the state as seen
    reaction: Array  # (capacity, n + k, conditions): jump of the state, and what it asks of the elements
    limits: Array  # (capacity, 2 k, 2): intervals of the guards while the mode lasts, and on entry
    steps: Array  # (capacity, columns, rows): see `march.lines_of`, then jumps of the state with inputs
    reach: Array  # (capacity,) how far a Taylor series of the flow serves [s]
