"""Modelica source of a vehicle, made of parts of Modelica.Mechanics, and of an inerter that it adds.

The upper end of an element is its flange_b, so that s_rel is its elongation and f its force, positive in tension. A
port that is a combination of coordinates, such as a body with a lever arm, is a model of its own.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from inerter.errors import ExportError
from inerter.exports.kind import ExportKind
from inerter.exports.kinds.matlab import exact
from inerter.exports.refusals import delay_notes
from inerter.exports.request import ExportSpec
from inerter.networks.elements import Bridge, Element, Network, Parallel, Series
from inerter.networks.elements.roles import LinearRole
from inerter.networks.transform import UpsideDown, linearise, parts_between
from inerter.systems.graph import linear_graph
from inerter.systems.outputs import input_unit, of_mount, velocity_of
from inerter.vehicle.mechanism import Coordinate, Force, Mechanism, Port, Strut

_T, _R = "Modelica.Mechanics.Translational", "Modelica.Mechanics.Rotational"
_LONGEST = 60  # characters of the name of a package
_PARTS = {
    LinearRole.STIFFNESS: (f"{_T}.Components.Spring", "c"),
    LinearRole.DAMPING: (f"{_T}.Components.Damper", "d"),
    LinearRole.MASS: ("Inerter", "b"),
}
_KEYWORDS = frozenset(
    "algorithm and annotation block break class connect connector constant constrainedby der discrete each else "
    "elseif elsewhen encapsulated end enumeration equation expandable extends external false final flow for "
    "function if import impure in initial inner input loop model not operator or outer output package parameter "
    "partial protected public pure record redeclare replaceable return stream then true type when while within "
    "time abs sign sqrt mod rem min max sum product pre edge change sample smooth noEvent terminal terminate "
    "assert reinit delay cardinality homotopy sin cos tan asin acos atan atan2 exp log size zeros ones fill Real "
    "Integer Boolean String StateSelect Modelica Inerter Vehicle ground end_flange".split()
)
_INERTER = f"""\
  model Inerter "Force over the relative acceleration of both flanges"
    extends {_T}.Interfaces.PartialCompliantWithRelativeStates;
    parameter Real b(unit="kg") "Inertance";
  equation
    f = b*der(v_rel);
  end Inerter;
"""


def _make(request: ExportSpec, suffix: str) -> str:
    mechanism = request.linear_mechanism("Modelica")
    notes = (*linear_graph(mechanism).notes, *delay_notes(mechanism, [road.name for road in mechanism.roads]))
    return "".join([*(f"// {note}\n" for note in notes), modelica_source(mechanism, request.title)])


def modelica_source(mechanism: Mechanism, title: str) -> str:
    """A package with the model `Vehicle`, whose inputs are velocities of roads and forces."""
    return _Source(mechanism).text(title or "vehicle")


class _Source:
    """Declarations and equations of the model, as they come."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.coordinates = {c.name: c for c in mechanism.coordinates}
        self.roads = {road.name for road in mechanism.roads}
        self.names: dict[str, None] = dict.fromkeys(_KEYWORDS)
        self.ports: dict[tuple[tuple[str, float], ...], str] = {}
        self.models: list[str] = []
        self.inputs: list[str] = []
        self.parts: list[str] = []
        self.outputs: list[str] = []
        self.equations: list[str] = []
        self.at: dict[str, str] = {}  # part of each coordinate and road

    def text(self, title: str) -> str:
        for road in self.mechanism.roads:
            self._road(road.name)
        for force in self.mechanism.forces:
            self._input(force.name, input_unit(self.mechanism, force.name))
        signals = [f"{c.name}_{what}" for c in self.mechanism.coordinates for what in _motions_of(c)]
        signals += [name for mount in self.mechanism.mounts() for name in of_mount(mount)]
        taken = {name: self._name(name) for name in signals}
        for coordinate in self.mechanism.coordinates:
            self._coordinate(coordinate, taken)
        for force in self.mechanism.forces:
            self._force(force)
        for mount in self.mechanism.mounts():
            upper, lower = (mount.upper, mount.lower) if isinstance(mount, Strut) else (mount.port, {mount.road: 1.0})
            ends = self._port(upper), self._port(lower)
            network = linearise(mount.network).network
            assert network is not None
            carried, moved = (taken[name] for name in of_mount(mount))
            self.outputs.append(f'output Real {carried}(unit="N") = {self._network(network, *ends)};')
            self.outputs.append(f'output Real {moved}(unit="m") = {ends[0]}.s - {ends[1]}.s;')
        return self._connect_parts(" ".join(title.split()))

    def _connect_parts(self, title: str) -> str:
        quoted = title.replace("\\", "\\\\").replace('"', '\\"')
        package = package_name(title)
        lines = [f'package {package} "{quoted}, written by inerter"', _INERTER.rstrip(), *self.models]
        body = [*self.inputs, *self.parts, *self.outputs]
        lines += ["  model Vehicle", *(f"    {line}" for line in body), "  equation"]
        lines += [*(f"    {line}" for line in self.equations), "  end Vehicle;"]
        return "\n".join([*lines, '  annotation (uses(Modelica(version="4.0.0")));', f"end {package};", ""])

    def _name(self, wanted: str) -> str:
        stem = identifier(wanted)
        name, number = stem, 1
        while name in self.names:
            number += 1
            name = f"{stem}_{number}"
        self.names[name] = None
        return name

    def _input(self, name: str, unit: str) -> None:
        self.at[f"input {name}"] = made = self._name(name)
        self.inputs.append(f'input Real {made}(unit="{_si(unit)}");')

    def _road(self, road: str) -> None:
        self._input(velocity_of(road), "m/s")
        self.at[road] = made = self._name(road)
        self.parts.append(f"{_T}.Sources.Speed {made}(exact=true);")
        self.equations.append(f"{made}.v_ref = {self.at[f'input {velocity_of(road)}']};")

    def _coordinate(self, coordinate: Coordinate, outputs: Mapping[str, str]) -> None:
        self.at[coordinate.name] = made = self._name(coordinate.name)
        library, inertia, massless = (_R, "Inertia", "Disc") if coordinate.angle else (_T, "Mass", "Rod")
        value = {True: "J", False: "m"}[coordinate.angle]
        if coordinate.is_massless:
            gap = "deltaPhi" if coordinate.angle else "L"
            self.parts.append(f"{library}.Components.{massless} {made}({gap}=0);")
        else:
            self.parts.append(f"{library}.Components.{inertia} {made}({value}={exact(coordinate.coefficient)});")
        position = "phi" if coordinate.angle else "s"
        variables = {"displacement": position, "velocity": "w" if coordinate.angle else "v", "acceleration": "a"}
        angular = "rad" if coordinate.angle else "m"
        for what, (unit, order) in _motions_of(coordinate).items():
            value = f"{made}.{variables[what]}"
            if coordinate.is_massless and order:
                value = f"der({made}.{position})"
            self.outputs.append(
                f'output Real {outputs[f"{coordinate.name}_{what}"]}(unit="{_si(angular + unit)}") = {value};'
            )

    def _force(self, force: Force) -> None:
        given = self.at[f"input {force.name}"]
        made = self._name(f"{force.name}_source")
        if not force.port:
            return
        (first, lever), alone = next(iter(force.port.items())), len(force.port) == 1
        if alone and lever == 1.0 and self.coordinates[first].angle:
            self.parts.append(f"{_R}.Sources.Torque {made};")
            self.equations += [f"{made}.tau = {given};", f"connect({made}.flange, {self.at[first]}.flange_a);"]
            return
        self.parts.append(f"{_T}.Sources.Force {made};")
        self.equations += [f"{made}.f = {given};", f"connect({made}.flange, {self._port(force.port)});"]

    def _port(self, port: Port) -> str:
        """The flange of a port: of a mass, of the ground, of a road, or of a combination."""
        levers = {name: lever for name, lever in port.items() if lever != 0.0}
        key = tuple(sorted(levers.items()))
        if key not in self.ports:
            self.ports[key] = self._new_port(levers)
        return self.ports[key]

    def _new_port(self, levers: Mapping[str, float]) -> str:
        if not levers:
            self.parts.append(f"{_T}.Components.Fixed ground(s0=0);")
            return "ground.flange"
        (first, lever), alone = next(iter(levers.items())), len(levers) == 1
        if alone and lever == 1.0 and first in self.roads:
            return f"{self.at[first]}.flange"
        if alone and lever == 1.0 and not self.coordinates[first].angle:
            return f"{self.at[first]}.flange_a"
        made = self._name("port")
        kind = self._name(f"Port_{made}")
        self._port_model(kind, levers)
        self.parts.append(f"{kind} {made};")
        for name in levers:
            flange = "flange" if name in self.roads else "flange_a"
            self.equations.append(f"connect({made}.{self.at[name]}, {self.at[name]}.{flange});")
        return f"{made}.end_flange"

    def _port_model(self, kind: str, levers: Mapping[str, float]) -> None:
        """A port whose end moves by the sum of coordinates times levers, and which passes its force on to them."""
        words = _sum([_times(lever, name) for name, lever in levers.items()])
        flanges, moves, forces = [], [], []
        for name, lever in levers.items():
            part, angle = self.at[name], name in self.coordinates and self.coordinates[name].angle
            library, place, effort = (_R, "phi", "tau") if angle else (_T, "s", "f")
            flanges.append(f"    {library}.Interfaces.Flange_a {part};")
            moves.append(_times(lever, f"{part}.{place}"))
            forces.append(f"    {part}.{effort} = {_times(-lever, 'end_flange.f')};")
        lines = [f'  model {kind} "{words}"', *flanges, f"    {_T}.Interfaces.Flange_b end_flange;", "  equation"]
        lines += [f"    end_flange.s = {_sum(moves)};", *forces, f"  end {kind};"]
        self.models += lines

    def _network(self, network: Network, upper: str, lower: str) -> str:
        """Add a network between two flanges; returns its force."""
        forces = [self._network(*part) for part in parts_between(network, upper, lower, self._node)]
        match network:
            case Parallel():
                return " + ".join(forces)
            case Series():
                force = min(forces, key=len)
                return f"({force})" if " " in force else force
            case Bridge():
                return f"({forces[0]} + {forces[2]})"
            case UpsideDown():
                return f"(-({forces[0]}))"
            case Element():
                kind, parameter = _PARTS[network.linear]
                made = self._name(network.label)
                self.parts.append(f"{kind} {made}({parameter}={exact(network.coefficient)});")
                self.equations += [f"connect({made}.flange_b, {upper});", f"connect({made}.flange_a, {lower});"]
                return f"{made}.f"
        raise ExportError(f"Modelica has no part for {network!r}.")

    def _node(self, number: int) -> str:
        made = self._name("node")
        self.parts.append(f"{_T}.Components.Rod {made}(L=0);")
        return f"{made}.flange_a"


def _times(lever: float, what: str) -> str:
    return what if lever == 1.0 else f"-{what}" if lever == -1.0 else f"{exact(lever)}*{what}"


def _sum(terms: Sequence[str]) -> str:
    return " + ".join(terms).replace("+ -", "- ")


def _motions_of(coordinate: Coordinate) -> dict[str, tuple[str, int]]:
    """Motions of a coordinate that are outputs: what follows its unit, and the order of the derivative."""
    found = {"displacement": ("", 0), "velocity": ("/s", 1), "acceleration": ("/s2", 2)}
    if coordinate.is_massless:
        del found["acceleration"]
    return found


def package_name(title: str) -> str:
    """A short name of a package or file after a title."""
    name = identifier(title)[:_LONGEST].rstrip("_")
    return f"{name}_" if name in _KEYWORDS else name


def identifier(text: str) -> str:
    """A name in the syntax of Modelica and C."""
    name = re.sub(r"\W+", "_", text, flags=re.ASCII)
    return name if name[:1].isalpha() else f"v_{name}"


def _si(unit: str) -> str:
    """Unit in the syntax of Modelica."""
    return unit.replace("^", "").replace("N m", "N.m")


MODELICA = ExportKind(
    "modelica",
    "Modelica source, of parts of Modelica.Mechanics",
    (".mo",),
    _make,
    takes=("linear",),
    synonyms=("openmodelica", "dymola"),
)
