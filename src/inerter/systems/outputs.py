"""The outputs of a mechanism by name, as rows over the motions of its nodes, the forces of its branches and its inputs.

Linear analysis and both integrators know nodes, branches and inputs only; this is the one place that knows what people
ask for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from inerter.errors import InerterError
from inerter.systems.graph import Graph
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]
_LISTED = 24  # names in a message
_MOTIONS = ("displacement", "velocity", "acceleration")


def _none() -> Matrix:
    return np.zeros(0)


@dataclass(frozen=True, eq=False)
class Output:
    """One output: the sum of its rows times what they are rows over. An empty row is a row of zeros."""

    name: str
    unit: str
    title: str
    displacement: Matrix = field(default_factory=_none)  # over the nodes
    velocity: Matrix = field(default_factory=_none)
    acceleration: Matrix = field(default_factory=_none)
    forces: Matrix = field(default_factory=_none)  # over the branches
    road: Matrix = field(default_factory=_none)  # over the roads' displacements
    road_velocity: Matrix = field(default_factory=_none)
    external: Matrix = field(default_factory=_none)  # over the external forces


def outputs(mechanism: Mechanism, graph: Graph) -> dict[str, Output]:
    """Every output of `mechanism` by name.

    Inputs; motions of coordinates; force, travel or load and deflection of mounts; velocity and force of elements. If
    only one strut is there, `force` and `travel` are its own.
    """
    found: list[Output] = []
    roads, forces = np.eye(len(mechanism.roads)), np.eye(len(mechanism.forces))
    found += [Output(r.name, "m", f"{_said(r.name)}", road=row) for r, row in zip(mechanism.roads, roads, strict=True)]
    angles = {c.name for c in mechanism.coordinates if c.angle}
    for given, row in zip(mechanism.forces, forces, strict=True):
        unit = "N m" if set(given.port) <= angles else "N"
        found.append(Output(given.name, unit, _said(given.name), external=row))
    for coordinate, row in zip(mechanism.coordinates, np.eye(len(graph.nodes)), strict=False):
        unit, said = "rad" if coordinate.angle else "m", _said(coordinate.name)
        found += [
            Output(f"{coordinate.name}_displacement", unit, f"{said} displacement", displacement=row),
            Output(f"{coordinate.name}_velocity", f"{unit}/s", f"{said} velocity", velocity=row),
            Output(f"{coordinate.name}_acceleration", f"{unit}/s^2", f"{said} acceleration", acceleration=row),
        ]
    struts = {strut.name for strut in mechanism.struts}
    for name, mount in graph.mounts.items():
        total = np.zeros(len(graph.branches))
        total[list(mount.carriers)] = 1.0
        force, travel = ("force", "travel") if name in struts else ("load", "deflection")
        found += [
            Output(f"{name}_{force}", "N", f"{_said(name)} {force}", forces=total),
            Output(f"{name}_{travel}", "m", f"{_said(name)} {travel}", displacement=mount.nodes, road=mount.roads),
        ]
    if len(struts) == 1:
        (only,) = struts
        found += [_renamed(o, o.name.removeprefix(f"{only}_")) for o in found if o.name.startswith(f"{only}_")]
    for i, branch in enumerate(graph.branches):
        row = np.zeros(len(graph.branches))
        row[i] = 1.0
        found += [
            Output(
                f"{branch.label}_velocity",
                "m/s",
                f"velocity across {branch.label}",
                velocity=branch.nodes,
                road_velocity=branch.roads,
            ),
            Output(f"{branch.label}_force", "N", f"force of {branch.label}", forces=row),
        ]
    known = {output.name: output for output in reversed(found)}  # a mount's own name goes before an element's
    return {output.name: known[output.name] for output in found}


def main_outputs(mechanism: Mechanism) -> list[str]:
    """Names of the outputs that every analysis has: motions of coordinates, what mounts carry and how far they move."""
    coordinates = [f"{c.name}_{what}" for c in mechanism.coordinates for what in _MOTIONS]
    struts = [f"{strut.name}_{what}" for strut in mechanism.struts for what in ("force", "travel")]
    return coordinates + struts + [f"{t.name}_{what}" for t in mechanism.tyres for what in ("load", "deflection")]


def find(known: Mapping[str, Output], name: object, error: type[InerterError]) -> Output:
    """The output of this name; raises `error`, with the names that come close, if there is none."""
    if isinstance(name, str) and name in known:
        return known[name]
    close = get_close_matches(str(name), known, n=3)
    more = f" and {len(known) - _LISTED} more" if len(known) > _LISTED else ""
    hint = f"Did you mean {' or '.join(close)}?" if close else f"There are: {', '.join([*known][:_LISTED])}{more}."
    raise error(f"There is no output named {name!r}. {hint}")


def _said(name: str) -> str:
    return name.replace("_", " ")


def _renamed(output: Output, name: str) -> Output:
    rows = {k: v for k, v in vars(output).items() if k != "name"}
    return Output(name=name, **rows)
