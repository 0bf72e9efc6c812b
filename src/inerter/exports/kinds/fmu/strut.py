"""A strut alone: the accelerations of its ends in, its force out.

Its ends are given masses, and forces that move them; those forces are then solved for the accelerations that a host
gives. So all of the network is an ordinary mechanism, and an inerter between the ends needs no other way.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from inerter.exports.kinds.fmu.cut_mechanism import CutMechanism, cut_mechanism
from inerter.exports.kinds.fmu.equations import Equations, FmuParameter, mass_name
from inerter.exports.kinds.fmu.switching import (
    PrescribedMotion,
    SwitchingSystem,
    reaction_quantities,
    rows_by_name,
    stack_rows,
    with_laws,
)
from inerter.exports.named_system import NamedQuantity, NamedSystem
from inerter.networks.elements import Element, Network
from inerter.networks.elements.roles import LinearRole
from inerter.vehicle.mechanism import Coordinate, Force, Mechanism, Port, Strut

Matrix = NDArray[np.float64]
ENDS = ("upper", "lower")
_FORCES = tuple(f"{end}_force" for end in ENDS)
_OUTPUT = "strut_force"
HOW_TO_COUPLE = (
    "strut_force is positive in tension: it pulls the upper end down and the lower end up. Give displacement, "
    "velocity and acceleration of both ends at each communication point. With an inertance the force depends on "
    "the accelerations at once: solve for them with the directional derivatives or the output inertance. Where "
    "coupling_ratio = inertance (1/upper_mass + 1/lower_mass) is one or more, accelerations of the step before "
    "make the host diverge. The rate of an acceleration over a step, from the step before or from a repetition "
    "after a rollback, makes the coupling of second order; where the force jumps within a step, mean_force gives its "
    "impulse."
)


def strut_system(network: Network, masses: tuple[float, float], title: str) -> SwitchingSystem:
    """The switching system of a network without free values between two ends, and the masses of the host there.

    A mass of zero is not known.

    Raises `ExportError` for friction or a gap between the ends themselves, and as `cut_mechanism`.
    """
    inertances = [e.coefficient for e in network.elements() if isinstance(e, Element) and e.linear is LinearRole.MASS]
    mass = 1.0 + sum(inertances)  # of each end, while it is solved for
    mechanism = Mechanism(
        coordinates=tuple(Coordinate(end, mass) for end in ENDS),
        struts=(Strut("strut", network, *({end: 1.0} for end in ENDS)),),
        forces=tuple(Force(name, {end: 1.0}) for name, end in zip(_FORCES, ENDS, strict=True)),
    )
    cut = cut_mechanism(mechanism, prescribed=len(ENDS))
    base = cut.linear_part()
    n = len(base.states)
    constants = _constants(np.vstack([np.hstack([base.A, base.B]), np.hstack([base.C, base.D])]), cut, n)
    states = {name: i for i, name in enumerate(base.states)}
    motions = []
    for j, end in enumerate(ENDS):
        displacement, velocity = states[f"{end}_displacement"], states[f"{end}_velocity"]
        constants[[displacement, velocity]] = 0.0
        constants[displacement, velocity] = constants[velocity, n + j] = 1.0
        motions.append(PrescribedMotion(NamedQuantity(f"{end}_displacement", "m"), displacement, j, is_rate=False))
        motions.append(PrescribedMotion(NamedQuantity(f"{end}_velocity", "m/s"), velocity, j, is_rate=True))
    rows = rows_by_name(cut, constants[n:], n)
    whole = cut.complete(rows)[_OUTPUT][None]
    system = NamedSystem(
        with_impulse(np.vstack([constants[:n, :n], whole[:, :n]]), n),
        np.vstack([constants[:n, n:], whole[:, n:]]),
        with_impulse(whole[:, :n], n),
        whole[:, n:],
        (*(NamedQuantity(name) for name in base.states), NamedQuantity("impulse", "N s")),
        (*(NamedQuantity(f"{end}_acceleration", "m/s^2") for end in ENDS), *reaction_quantities(cut)),
        (NamedQuantity(_OUTPUT, "N"),),
        notes=(HOW_TO_COUPLE,),
        title=title or "strut",
    )
    laws = {name: with_impulse(row, n) for name, row in rows.items()}
    found = with_laws(cut, system, laws, _equations(cut, n))
    told = "Mass of the host at this end, for coupling_ratio alone; zero if not known."
    host = tuple(
        FmuParameter(mass_name(end, False), "kg", value, is_tunable=True, may_vanish=True, description=told)
        for end, value in zip(ENDS, masses, strict=True)
    )
    return replace(found, motions=tuple(motions), host_masses=host)


def port_masses(mechanism: Mechanism, strut: Strut) -> tuple[float, float]:
    """Masses of the upper and the lower port of a strut, each alone; zero for a port on a road or on the ground."""
    masses = {c.name: c.coefficient for c in mechanism.masses.values()}

    def mass(port: Port) -> float:
        mobility = sum(lever**2 / masses[name] for name, lever in port.items() if name in masses)
        return 1.0 / mobility if mobility else 0.0

    return mass(strut.upper), mass(strut.lower)


def with_impulse(rows: Matrix, place: int) -> Matrix:
    """Rows with a column for the impulse, a state on which nothing depends: it is last, at a place."""
    return np.insert(rows, place, 0.0, axis=-1)


def _constants(rows: Matrix, cut: CutMechanism, states: int) -> Matrix:
    """Rows over states and inputs in which the accelerations of the ends stand for the forces on them."""
    at = [states + cut.outputs().index(f"{end}_acceleration") for end in ENDS]
    forces = slice(states, states + len(ENDS))
    solved = np.linalg.solve(rows[at, forces], -rows[at])  # forces = solved, and the accelerations themselves
    solved[:, forces] = np.linalg.inv(rows[at, forces])
    kept = rows.copy()
    kept[:, forces] = 0.0
    return kept + rows[:, forces] @ solved


def _equations(cut: CutMechanism, states: int) -> Equations | None:
    """The equations with the forces on the ends among the unknowns, and the accelerations in their place."""
    base = cut.equations()
    if base is None:
        return None
    count, first = len(ENDS), base.unknowns + states
    forces = slice(first, first + count)
    at = [cut.outputs().index(f"{end}_acceleration") for end in ENDS]

    def exchange(rows: Matrix) -> Matrix:
        parts = np.split(rows, [base.unknowns, first, first + count], axis=2)
        return np.concatenate([parts[0], parts[2], parts[1], np.zeros_like(parts[2]), parts[3]], axis=2)

    given = exchange(base.outputs[:, at])
    given[0, :, forces.start + count : forces.stop + count] -= np.eye(count)
    outputs = exchange(base.outputs)
    rows = rows_by_name(cut, outputs, first + count)
    own = [i for i, one in enumerate(base.parameters) if one.name not in {mass_name(end, False) for end in ENDS}]
    masses = [1 + i for i in range(len(base.parameters)) if i not in own]
    weights = np.array([base.parameters[i - 1].value for i in masses])

    def fix_masses(stack: Matrix) -> Matrix:
        """Without slices of the masses of the ends, which are numbers, and with the impulse as a state."""
        constant = stack[:1] + np.tensordot(weights, stack[masses], 1)[None]
        return with_impulse(np.concatenate([constant, stack[[1 + i for i in own]]]), first + count)

    force = cut.complete(rows)[_OUTPUT][:, None]
    return Equations(
        fix_masses(np.concatenate([exchange(base.balance), given], axis=1)),
        fix_masses(np.concatenate([exchange(base.rates), force], axis=1)),
        fix_masses(force),
        fix_masses(stack_rows(cut.motions(rows, base), outputs)),
        tuple(base.parameters[i] for i in own),
    )
