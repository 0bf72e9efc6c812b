"""The switching system of a vehicle: its linear part, with the forces of friction and gaps as inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ExportError
from inerter.exports.kinds.fmu.cut_mechanism import CutMechanism, Rows, cut_mechanism
from inerter.exports.kinds.fmu.equations import Equations, FmuParameter
from inerter.exports.named_system import NamedQuantity, NamedSystem, Quantities
from inerter.exports.refusals import delay_notes, refuse_moving_ground
from inerter.systems.outputs import input_unit, main_outputs, outputs, velocity_of
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class PrescribedMotion:
    """A state that a host prescribes: a displacement or velocity whose acceleration is an input."""

    quantity: NamedQuantity
    state: int
    input: int
    is_rate: bool  # whether it is the velocity


@dataclass(frozen=True, eq=False)
class SwitchingSystem:
    """x' = A x + B (u, r), y = C x + D (u, r), q = Q (x, u, r), with reactions r of friction and gaps in tension.

    `system` has the reactions among its inputs, last. q is the velocity across a friction, whose reaction is `upper`
    where it slips down, or the elongation of a gap, which stays between both. The q of a friction that `creeps` is its
    elongation, which slip alone changes. `limits`
    are those that a parameter gives. `equations`, where they are known, give the matrices for other parameters.
    """

    system: NamedSystem
    Q: Matrix
    lower: Matrix
    upper: Matrix
    is_gap: tuple[bool, ...]
    creeps: tuple[bool, ...] = ()
    limits: tuple[FmuParameter | None, ...] = ()
    equations: Equations | None = None
    motions: tuple[PrescribedMotion, ...] = ()
    host_masses: tuple[FmuParameter, ...] = ()  # at the ends of a strut alone
    sources: tuple[int, ...] = ()  # the number of the input from which each comes; by default itself
    distances: tuple[float, ...] = ()  # after which it arrives [m]
    speed: FmuParameter | None = None

    @property
    def inputs(self) -> Quantities:
        """The inputs that are no reactions."""
        return self.system.inputs[: len(self.system.inputs) - len(self.is_gap)]

    @property
    def sources_of_inputs(self) -> tuple[int, ...]:
        """The place, among `host_inputs`, of the source of each input."""
        sources = self.sources or tuple(range(len(self.inputs)))
        return tuple(sorted(set(sources)).index(source) for source in sources)

    @property
    def host_inputs(self) -> Quantities:
        """The inputs that a host gives."""
        return tuple(self.inputs[i] for i in sorted(set(self.sources or range(len(self.inputs)))))

    @property
    def parameters(self) -> tuple[FmuParameter, ...]:
        """Numbers that a host may set: values of elements and masses, limits of friction and gaps, masses of a host."""
        values = () if self.equations is None else self.equations.parameters
        speed = () if self.speed is None else (self.speed,)
        return (*values, *(one for one in self.limits if one is not None), *self.host_masses, *speed)


def without_reactions(system: NamedSystem, equations: Equations | None = None) -> SwitchingSystem:
    """A linear system."""
    none = np.zeros(0)
    Q = np.zeros((0, len(system.states) + len(system.inputs)))
    return SwitchingSystem(system, Q, none, none, (), (), equations=equations)


def switching_system(mechanism: Mechanism, wanted: Sequence[str] | None, title: str) -> SwitchingSystem:
    """The switching system of a mechanism whose values are numbers, with its main outputs or those `wanted`.

    Raises `ExportError` for friction or a gap on a road.
    """
    refuse_moving_ground(mechanism, "an FMU")
    cut = cut_mechanism(mechanism)
    known = outputs(cut.whole, cut.graph)
    roads = [road.name for road in cut.whole.roads]
    base = cut.linear_part()
    n, m = len(base.states), len(base.inputs)
    A, B = np.zeros((n + len(roads),) * 2), np.zeros((n + len(roads), m))  # heights of the roads as states
    A[:n, :n], B[:n], B[n:, : len(roads)] = base.A, base.B, np.eye(len(roads))
    constants = rows_by_name(cut, with_heights(np.hstack([base.C, base.D]), n, len(roads)), n)
    found = cut.complete(constants)
    chosen = list(wanted) if wanted is not None else [name for name in main_outputs(cut.whole) if name in found]
    for name in chosen:
        if name not in found:
            raise ExportError(f"An FMU with friction or gaps has no output {name!r}; available: {', '.join(found)}.")
    whole = np.array([found[name] for name in chosen]).reshape(len(chosen), n + len(roads) + m)
    named = [NamedQuantity(velocity_of(r), "m/s") for r in roads]
    named += [NamedQuantity(f.name, input_unit(cut.whole, f.name)) for f in cut.whole.forces]
    system = NamedSystem(
        A,
        B,
        whole[:, : n + len(roads)],
        whole[:, n + len(roads) :],
        tuple(NamedQuantity(name) for name in (*base.states, *roads)),
        (*named, *reaction_quantities(cut)),
        tuple(NamedQuantity(name, known[name].unit) for name in chosen),
        notes=tuple(delay_notes(cut.whole, roads)),
        title=title or "vehicle",
    )
    return with_laws(cut, system, constants, _equations(cut, n, chosen))


def with_laws(cut: CutMechanism, system: NamedSystem, rows: Rows, equations: Equations | None) -> SwitchingSystem:
    """The switching system of a linear part, by the rows of its motions."""
    width = system.A.shape[1] + system.B.shape[1]
    Q = np.array(cut.motions(rows)).reshape(len(cut.cuts), width)
    limits = np.array([one.branch.element.checked_limits() for one in cut.cuts]).reshape(len(cut.cuts), 2)
    is_gap = tuple(one.is_gap for one in cut.cuts)
    given = () if equations is None else cut.limits()
    creeps = tuple(one.creeps for one in cut.cuts)
    return SwitchingSystem(
        system, Q, limits[:, 0], limits[:, 1], is_gap, creeps, given or (None,) * len(is_gap), equations
    )


def reaction_quantities(cut: CutMechanism) -> Quantities:
    """The reactions as inputs."""
    return tuple(NamedQuantity(f"force of {one.branch.label}", "N") for one in cut.cuts)


def with_heights(rows: Matrix, place: int, count: int) -> Matrix:
    """Rows, or stacks of rows, with so many columns of zeros at a place."""
    return np.insert(rows, [place] * count, 0.0, axis=-1)


def rows_by_name(cut: CutMechanism, rows: Matrix, place: int) -> Rows:
    """The rows of the outputs by name, those of roads and of reactions too; columns of heights begin at `place`."""
    found: Rows = {name: rows[..., i, :] for i, name in enumerate(cut.outputs())}
    roads, width = len(cut.whole.roads), rows.shape[-1]
    places = {road.name: place + i for i, road in enumerate(cut.whole.roads)}
    places |= {one.reaction.name: width - len(cut.cuts) + i for i, one in enumerate(cut.cuts)}
    assert len(places) == roads + len(cut.cuts)
    for name, column in places.items():
        row = np.zeros((*rows.shape[:-2], width))
        row[(0,) * (row.ndim - 1) + (column,)] = 1.0
        found[name] = row
    return found


def _equations(cut: CutMechanism, states: int, chosen: Sequence[str]) -> Equations | None:
    base = cut.equations()
    if base is None:
        return None
    place, roads = base.unknowns + states, len(cut.whole.roads)
    heights = np.zeros((len(base.rates), roads, base.rates.shape[2] + roads))
    heights[0, :, place + roads : place + 2 * roads] = np.eye(roads)
    rows = rows_by_name(cut, with_heights(base.outputs, place, roads), place)
    found = cut.complete(rows)
    return replace(
        base,
        balance=with_heights(base.balance, place, roads),
        rates=np.concatenate([with_heights(base.rates, place, roads), heights], axis=1),
        outputs=stack_rows([found[name] for name in chosen], heights),
        motions=stack_rows(cut.motions(rows, base), heights),
    )


def stack_rows(rows: Sequence[Matrix], like: Matrix) -> Matrix:
    """Stacks of rows as one, of the shape of another in all but the number of rows."""
    return np.stack(rows, axis=1) if rows else like[:, :0]
