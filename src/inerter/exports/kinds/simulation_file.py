"""A simulation file of a design: its vehicle, elements and networks, with a first signal and duration."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from typing import Any

from inerter.errors import ExportError
from inerter.exports.kind import ExportKind
from inerter.exports.request import ExportSpec
from inerter.field_metadata import fields_of
from inerter.files.common.codec import load_tables
from inerter.files.common.entries import Amount
from inerter.files.common.layouts import StrutLayout
from inerter.files.common.signal_kinds import unit_of
from inerter.files.common.signals import SignalRequest
from inerter.files.common.toml import as_toml
from inerter.files.common.vehicle_tables import MECHANISM, SEAT, Length
from inerter.files.common.vehicles import inputs
from inerter.files.simulation.sections import SimulationSettings, simulation_codec
from inerter.networks.elements import Element, Network
from inerter.networks.parser import format_expression
from inerter.signals.road import Road
from inerter.vehicle.mechanism import GROUND_ACCELERATION, Mechanism, Port
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.seat import Seat
from inerter.vehicle.vehicle import Vehicle, VehicleModel

Tables = dict[str, Any]
_LAYOUT, _DURATION, _SPEED = "design", 5.0, 10.0  # [s], [m/s]
_BUMP = {"height": 0.01, "length": 1.0, "start": 0.5}  # [m], [m], [s]
_AMPLITUDES = {"m": 1e-3, "N": 100.0, "N m": 100.0, "m/s^2": 1.0}  # of a sine of 1 Hz, by the unit of its input


def _make(request: ExportSpec, suffix: str) -> str:
    names = _ElementNames()
    table, networks = _vehicle(request.vehicle, names)
    layout = StrutLayout({mount: names.expression(network) for mount, network in networks.items()})
    tables = simulation_codec().dump(
        {
            "title": request.title or None,
            "vehicle": table,
            "road": _road(request, table),
            "elements": names.elements,
            "layouts": {_LAYOUT: layout},
            "signal": _signal(table, shaken=request.mechanism.ground_moves),
            "simulation": SimulationSettings(layout=_LAYOUT, duration=_DURATION),
        }
    )
    _, problems = load_tables(simulation_codec(), tables)
    if problems:
        raise ExportError(f"A simulation file cannot state this vehicle: {problems[0]}")
    remark = (
        f"The signal is a first one, its input one of {', '.join(inputs(table))}: edit both, and the speed on a road."
    )
    return f"# Run it: inerter simulate FILE\n# {remark}\n\n{as_toml(tables)}"


class _ElementNames:
    """Names of elements in a file: their own, numbered where different elements have the same."""

    def __init__(self) -> None:
        self.elements: dict[str, Element] = {}

    def expression(self, network: Network) -> str:
        """The expression of a network."""
        return format_expression(network, [self._name(element) for element in network.elements()])

    def _name(self, element: Element) -> str:
        own = element.name or element.symbol
        others = (f"{own}_{number}" for number in count(2))
        name = own
        while self.elements.setdefault(name, element) != element:
            name = next(others)
        return name


def _vehicle(vehicle: Vehicle, names: _ElementNames) -> tuple[Tables, Mapping[str, Network]]:
    """The table of a vehicle, and the networks of its mounts: as its model if files know it, else part by part."""
    if isinstance(vehicle, Seat):
        table, networks = _vehicle(vehicle.vehicle, names)
        if SEAT not in table and (table["model"] == MECHANISM or VEHICLES[table["model"]].moved == "road"):
            place = _port(vehicle.place, vehicle.vehicle.mechanism())
            return {
                **table,
                SEAT: {"mass": vehicle.mass, "network": names.expression(vehicle.network), "place": place},
            }, networks
    if isinstance(vehicle, VehicleModel) and VEHICLES.get(vehicle.key) is type(vehicle):
        values = {field.key: getattr(vehicle, field.name) for field in fields_of(type(vehicle))}
        if type(vehicle)(**values, **vehicle.networks()) == vehicle:
            return {"model": vehicle.key, **values}, vehicle.networks()
    mechanism = vehicle.mechanism()
    return _parts(mechanism), {mount.name: mount.network for mount in mechanism.mounts()}


def _parts(mechanism: Mechanism) -> Tables:
    ends = {strut.name: (strut.upper, strut.lower) for strut in mechanism.struts}
    measures = mechanism.measures
    return {
        "model": MECHANISM,
        "coordinates": {one.name: Amount(one.unit, one.coefficient) for one in mechanism.coordinates},
        "struts": {
            name: {"upper": _port(upper, mechanism), "lower": _port(lower, mechanism), "network": None}
            for name, (upper, lower) in ends.items()
        },
        "tyres": {
            tyre.name: {"port": _port(tyre.port, mechanism), "road": tyre.road, "network": None}
            for tyre in mechanism.tyres
        },
        "roads": {road.name: {"distance": road.distance, "track": road.side} for road in mechanism.roads},
        "forces": {
            force.name: _port(force.port, mechanism)
            for force in mechanism.forces
            if not (mechanism.ground_moves and force.name == GROUND_ACCELERATION)
        },
        "measures": {
            "comfort": {one.output: one.weight for one in measures.comfort},
            "tyre_load": {one.output: one.weight for one in mechanism.tyre_loads},
            "load_input": measures.load_input,
            "load_output": measures.load_output,
        },
    }


def _port(port: Port, mechanism: Mechanism) -> dict[str, float]:
    angles = {coordinate.name for coordinate in mechanism.coordinates if coordinate.angle}
    return {name: Length(lever) if name in angles else float(lever) for name, lever in port.items()}


def _road(request: ExportSpec, table: Tables) -> Tables | None:
    """The road of the index, at its speed, that of the request, or a first one; none for a vehicle without roads."""
    if "road" not in inputs(table):
        return None
    found = (getattr(index, "road", None) for index in (request.indices or {}).values())
    known = next((getattr(road, "road", road) for road in found if road is not None), None)
    road = known if isinstance(known, Road) else None
    speed = request.speed or (_SPEED if road is None else road.speed)
    return {"speed": float(speed), "roughness": None if road is None else road.roughness, "coherence": None}


def _signal(table: Tables, *, shaken: bool) -> SignalRequest:
    """A bump for a vehicle on a road, else a sine at its first input, or at its ground."""
    known = inputs(table)
    moved = GROUND_ACCELERATION if shaken else next(iter(known))
    if moved == "road":
        return SignalRequest("bump", moved, _BUMP)
    unit = known[moved]
    values = {"amplitude": _AMPLITUDES[unit], "frequency": 1.0, "phase": 0.0}
    return SignalRequest("sine", moved, values, None if unit == unit_of(moved) else unit)


SIMULATION = ExportKind(
    "simulation",
    "simulation file for inerter simulate, with friction and gaps",
    (".toml",),
    _make,
    takes=("indices", "speed"),
)
