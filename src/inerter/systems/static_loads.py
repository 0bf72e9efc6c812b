"""The weight that every tyre carries at rest, from masses, levers and gravity alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import MechanismError
from inerter.formatting import format_number
from inerter.networks.elements import Free
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.systems.graph import full_graph
from inerter.systems.lever_arms import orthonormal_null_space
from inerter.units import STANDARD_GRAVITY
from inerter.vehicle.mechanism import Mechanism, RoadInput
from inerter.vehicle.vehicle import Vehicle, check_vehicle

Matrix = NDArray[np.float64]
_BALANCED = 1e-9  # of the sizes that are added up


def static_tyre_loads(vehicle: Vehicle) -> dict[str, float]:
    """The static load of each tyre [N], pressing on the road, by the tyre's name; values but masses may be free.

    Virtual work over the motions that strain no spring: no stiffness enters. Where more tyres carry the vehicle than
    balance decides, as four wheels do, its springs are taken to be trimmed so that the loads are as even as balance
    allows. Every coordinate that is no angle is taken as vertical.

    Raises `MechanismError` if a mass is free, if a weight rests on nothing or on the ground beside the tyres, if levers
    do not follow the vehicle when it is lifted, or if a tyre would hang.

    >>> from inerter import Damper, QuarterCar, Spring
    >>> static_tyre_loads(QuarterCar(300.0, 40.0, 2e5, Spring(2e4) | Damper(1.5e3)))
    {'tyre': 3334.261}
    """
    check_vehicle(vehicle)
    mechanism = vehicle.mechanism()
    if not mechanism.tyres:
        return {}
    for coordinate in mechanism.coordinates:
        if isinstance(coordinate.inertia, Free) and not coordinate.angle:
            raise MechanismError(f"The static tyre loads are not known: the mass of {coordinate.name!r} is free.")
    moved, touched, weight = _free_ways(mechanism)
    upright = np.concatenate([weight > 0.0, np.ones(touched.shape[0])])
    if not _is_spanned(np.concatenate([moved, touched]), upright):
        raise MechanismError(
            "The static tyre loads are not known: lifting the vehicle together with its roads strains a spring. Either "
            "one to the ground, or to a road without a tyre, carries a part of the weight, or the levers of a strut or "
            "tyre do not follow that motion, as one of 1.1 on a mass does not."
        )
    work = moved.T @ weight
    load, *_ = np.linalg.lstsq(touched.T, work, rcond=_BALANCED)
    if np.abs(touched.T @ load - work).max(initial=0.0) > _BALANCED * weight.sum():
        raise MechanismError("The static tyre loads are not known: a part of the weight rests on no spring.")
    if load.min() <= 0.0:
        name = mechanism.tyres[int(np.argmin(load))].name
        raise MechanismError(f"The static tyre loads are not known: {name!r} would carry a negative load.")
    return {tyre.name: float(format_number(value, 15)) for tyre, value in zip(mechanism.tyres, load, strict=True)}


def _free_ways(mechanism: Mechanism) -> tuple[Matrix, Matrix, Matrix]:
    """Motions that strain no spring and no closed gap, as displacements of masses and of contacts, and the weights."""
    contacts = tuple(RoadInput(f"{tyre.name}_contact") for tyre in mechanism.tyres)
    tyres = tuple(replace(t, road=c.name) for t, c in zip(mechanism.tyres, contacts, strict=True))
    graph = full_graph(replace(mechanism, tyres=tyres, roads=(*mechanism.roads, *contacts)))
    carrying = [
        b
        for b in graph.branches
        if b.element.linear is LinearRole.STIFFNESS or b.element.switches_by(GuardRole.ELONGATION)
    ]
    rows = np.zeros((len(carrying), len(graph.nodes) + len(contacts)))
    for row, b in zip(rows, carrying, strict=True):
        row[:] = [*b.nodes, *b.roads[len(mechanism.roads) :]]
    ways = orthonormal_null_space(rows, _BALANCED) if carrying else np.eye(rows.shape[1])
    weight = np.array([0.0 if c.angle else STANDARD_GRAVITY * c.coefficient for c in mechanism.masses.values()])
    return ways[list(mechanism.masses)], ways[len(graph.nodes) :], weight


def _is_spanned(ways: Matrix, wanted: Matrix) -> bool:
    found, *_ = np.linalg.lstsq(ways, wanted, rcond=_BALANCED)
    return bool(np.abs(ways @ found - wanted).max() <= 1e-6)
