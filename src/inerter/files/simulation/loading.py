"""Reading a simulation file: TOML to a checked `SimulationRequest`, or one error with a line for every problem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from inerter.errors import InerterError, SimulationError
from inerter.files.common.layouts import layout_choice_problems, layout_problems
from inerter.files.common.problem import Problem, at
from inerter.files.common.problems import refusal
from inerter.files.common.roads import ROAD_QUANTITIES, MeasuredLine, line_through, track_problems, without_source
from inerter.files.common.signal_kinds import SIGNALS
from inerter.files.common.signals import signal_of
from inerter.files.common.suggest import nearest, some
from inerter.files.common.titles import title_of
from inerter.files.common.toml import read_tables, value_of
from inerter.files.common.vehicles import inputs, tracks, vehicle_problems
from inerter.files.simulation.request import SimulationRequest
from inerter.files.simulation.sections import simulation_codec
from inerter.simulation.inputs import whole_steps
from inerter.systems.piecewise import piecewise
from inerter.units import quote_value


def load_simulation(path: str | Path) -> SimulationRequest:
    """Simulation request of the TOML file at `path`.

    Raises `StudyError` with one line for every problem: file, place, what arrived, what was expected, what to try.
    """
    path = Path(path)
    return simulation_of(read_tables(path, "a simulation file"), path)


def simulation_of(tables: Mapping[str, Any], path: Path) -> SimulationRequest:
    """Simulation request from the tables of a file at `path`; raises `StudyError` as `load_simulation` does."""
    found = value_of(simulation_codec(), tables, path)
    line, line_problems = line_through(found["road"], path)
    request = _resolve(path, found, line)
    for check in (_names, _needs, _parts):
        problems = [*line_problems, *check(request)]
        if problems:
            raise refusal(path, problems)
    return request


def _resolve(path: Path, found: Mapping[str, Any], line: MeasuredLine | None) -> SimulationRequest:
    settings, road = dict(found["simulation"]), found["road"]
    if settings["layout"] is None:
        settings["layout"] = next(iter(found["layouts"])) if len(found["layouts"]) == 1 else ""
    return SimulationRequest(
        title=title_of(found, path),
        path=path,
        vehicle=found["vehicle"],
        road=without_source(road, line) if road else {},
        line=line,
        elements=found["elements"],
        layouts=found["layouts"],
        signal=signal_of(path, inputs(found["vehicle"]), found["signal"]),
        **settings,
    )


def _names(request: SimulationRequest) -> Iterator[Problem]:
    """Problems of the vehicle and its layouts, and of unknown names."""
    yield from vehicle_problems(request.vehicle)
    yield from layout_problems(request.elements, request.layouts)
    yield from layout_choice_problems("simulation", request.layout, tuple(request.layouts))
    moved, known = request.signal.input, inputs(request.vehicle)
    if moved not in known:
        hint = nearest(moved, known)
        yield at(("signal", "input"), got=quote_value(moved), expected=f"one of {some(known)}", hint=hint)


def _needs(request: SimulationRequest) -> Iterator[Problem]:
    """Problems of missing values for the signal, the vehicle or the integration."""
    signal, kind = request.signal, SIGNALS[request.signal.kind]
    if kind.of_roads and signal.unit != "m":
        yield at(
            ("signal", "kind"),
            got=f"{quote_value(signal.kind)} for {signal.input}",
            fault="it is the shape of a road",
            expected="another kind, or no input",
        )
    known = {"speed": request.speed, "roughness": request.roughness}
    examples = {field.key: field.example for field in ROAD_QUANTITIES}
    for key in kind.needs:
        if known[key] is None:
            needed = f"missing, but a {signal.kind} needs it"
            yield at(("road", key), fault=needed, expected=f'{key} = "{examples[key]}"')
    if signal.unit == "m" and request.speed is None and not kind.needs and _has_delays(request):
        yield at(
            ("road", "speed"),
            fault="missing, but the rear axle needs it: the road arrives there with a delay",
            expected='speed = "25 m/s"',
        )
    yield from _of_tracks(request)
    if request.duration is None and request.initial != "periodic":
        yield at(("simulation", "duration"), fault="missing", expected='duration = "10 s"')
    if request.duration is not None:
        try:
            whole_steps(request.duration, request.step)
        except SimulationError as error:
            yield at(("simulation", "step"), str(error))


def _of_tracks(request: SimulationRequest) -> Iterator[Problem]:
    """Problems of different left and right tracks that the vehicle or the signal does not support."""
    asked = {("road", "coherence"): bool(request.coherence), ("signal", "track"): request.signal.on_tracks}
    for place in (place for place, wanted in asked.items() if wanted):
        yield from track_problems(place, tracks(request.vehicle))
    if request.coherence and not SIGNALS[request.signal.kind].random:
        random = some(quote_value(kind.key) for kind in SIGNALS.values() if kind.random)
        fault = f"a {request.signal.kind} has none"
        yield at(("road", "coherence"), fault=fault, expected=f"a signal of kind {random}, or no coherence")


def _has_delays(request: SimulationRequest) -> bool:
    """Whether road inputs act with different delays; False if the vehicle cannot be built, which is reported later."""
    try:
        return any(road.distance > 0.0 for road in request.design().mechanism().roads)
    except InerterError:
        return False


def _parts(request: SimulationRequest) -> Iterator[Problem]:
    """Problems of a signal or a vehicle that cannot be built."""
    try:
        request.signals()
    except InerterError as error:
        yield at(("signal",), str(error))
    try:
        piecewise(request.design())
    except InerterError as error:
        yield at(("layouts", request.layout), str(error))
