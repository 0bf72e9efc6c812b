"""The energy account of an integration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.simulation.event_driven import Integration
from inerter.simulation.inputs import InputTable
from inerter.simulation.trajectory import Energy
from inerter.systems.piecewise import PiecewiseSystem

Matrix = NDArray[np.float64]


def energy_of(integration: Integration) -> Energy:
    """Energy balance since the start of the integration [J]."""
    system, table = integration.system, integration.table
    names = [*(r.name for r in system.mechanism.roads), *(f.name for f in system.mechanism.forces)]
    sums = integration.motion.energy
    branches = list(zip(system.graph.branches, sums[len(names) :], strict=False))
    knot = integration.segment
    return Energy(
        inputs={name: float(w) for name, w in zip(names, sums, strict=False)},
        stored=_stored_energy(system, table, integration.state, knot)
        - _stored_energy(system, table, integration.begun, 0),
        dampers={b.label: float(w) for b, w in branches if b.element.linear is LinearRole.DAMPING},
        friction={b.label: float(w) for b, w in branches if b.element.switches_by(GuardRole.FORCE)},
    )


def _stored_energy(system: PiecewiseSystem, table: InputTable, state: Matrix, knot: int) -> float:
    """Kinetic and elastic energy [J] just before a knot."""
    roads, na = len(system.mechanism.roads), system.motions[0].shape[1]
    z, rate = table.value_before[knot, :roads], table.slope_before[knot, :roads]
    speeds = system.kinetic @ state[:na] + system.kinetic_road @ rate
    lengths = system.elongations[0] @ state[na:] + system.elongations[1] @ z
    elements = [b.element for b in system.graph.branches]
    k = np.array([e.coefficient if e.linear is LinearRole.STIFFNESS else 0.0 for e in elements])
    return float(0.5 * system.inertia @ speeds**2 + 0.5 * k @ lengths**2)
