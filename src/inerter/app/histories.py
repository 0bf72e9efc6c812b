"""Motions as a page draws them: few samples of each output, the states of friction and gaps, the car in motion."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.app.designs import Design, baseline_of
from inerter.errors import InerterError, StatusKind, StudyError
from inerter.figures.curves import thin_curve
from inerter.files.common.roads import road_values
from inerter.files.common.signals import SignalRequest
from inerter.files.simulation.request import SimulationRequest
from inerter.files.study.study import Study
from inerter.formatting import format_alike
from inerter.networks.elements.registry import middle_phrases
from inerter.simulation.elongations import elongations
from inerter.simulation.trajectory import Trajectory
from inerter.systems.outputs import main_outputs
from inerter.vehicle.mechanism import Mechanism

_MOST = 2000  # samples of an output
_FRAMES = 60.0  # a second, of the car in motion
_PLACES = 7  # decimal places of its heights [m] and angles [rad]
_KEPT = 4  # runs
_MOST_EVENTS, _LONGEST = 5000, 120.0
_DURATION, _STEP = 10.0, 5e-4  # [s]


def history(study: Study, design: Design, body: Mapping[str, Any]) -> dict[str, Any]:
    """The motion of a design over a random road of the study, and of the `baseline` of the request on the same road.

    A baseline whose motion cannot be computed has a status only. Raises what `simulation_request` raises, and
    `simulate`.
    """
    if "output" in body:
        body = {**body, "output": _names(design.mechanism, body)[0]}
    found = _one_history(study, design, body)
    if body.get("baseline"):
        found["baseline"] = _history_or_status(study, baseline_of(study, body, []), body)
    return found


def _history_or_status(study: Study, design: Design | None, body: Mapping[str, Any]) -> dict[str, Any]:
    assert design is not None
    try:
        return _one_history(study, design, body)
    except InerterError as problem:
        return {**design.describe_values(), "status": StatusKind.FAILED.value, "message": str(problem)}


def _one_history(study: Study, design: Design, body: Mapping[str, Any]) -> dict[str, Any]:
    asked = simulation_request(study, design, body)
    run, mechanism = _run_once(asked), design.mechanism
    names = _names(mechanism, body)
    shaded = state_intervals(run)
    return {
        **design.describe_values(),
        "outputs": [_describe_output(run, name) for name in main_outputs(mechanism)],
        "signals": [_signal_curve(run, name) for name in names],
        "motion": motion_of(run, mechanism),
        "shaded": shaded,
        "events": len(run.events),
        "rms": {name: run.rms(name) for name in names},
        "peaks": {name: float(np.abs(run[name]).max()) for name in names},
        "duration": asked.duration,
        "step": asked.step,
        **run.status.to_json(),
    }


def _names(mechanism: Mechanism, body: Mapping[str, Any]) -> list[str]:
    """Names of the signals of a request; of one for an `output` that the vehicle does not have, its first."""
    known = main_outputs(mechanism)
    if "output" not in body:
        return body.get("outputs") or known
    return [body["output"]] if body["output"] in known else known[:1]


_runs: deque[tuple[SimulationRequest, Trajectory]] = deque(maxlen=_KEPT)  # of which another output may be asked for


def _run_once(asked: SimulationRequest) -> Trajectory:
    """Run of a request, or that of an equal one before."""
    known = next((run for before, run in _runs if before == asked), None)
    if known is None:
        known = asked.run()
        _runs.append((asked, known))
    return known


def simulation_request(study: Study, design: Design, body: Mapping[str, Any]) -> SimulationRequest:
    """Simulation request of a design over a random road of the study.

    Raises `StudyError` for a time that is too long to be looked at, and where there is no road.
    """
    duration, step = float(body.get("duration") or _DURATION), float(body.get("step") or _STEP)
    if duration > _LONGEST:
        given, most = format_alike([duration, _LONGEST], "s")
        raise StudyError(f"The page simulates at most {most}, got {given}. For longer motions use inerter simulate.")
    if study.road is None:
        raise StudyError("The motion requires a road, and this study has none. Add [road].")
    return SimulationRequest(
        title=study.title,
        path=study.path,
        vehicle=study.vehicle,
        road=road_values(study.road, study.coherence),
        elements=design.fixed_study.elements,
        layouts=study.layouts,
        signal=SignalRequest("multisine", "road", {"seed": int(body.get("seed") or 0)}),
        layout=design.layout,
        duration=duration,
        step=step,
    )


def _signal_curve(run: Trajectory, name: str) -> dict[str, Any]:
    """An output by the lowest and the highest sample of each piece, at their times."""
    time, values = thin_curve(run.time, run[name], _MOST)
    return {**_describe_output(run, name), "time": time, "values": values}


def _describe_output(run: Trajectory, name: str) -> dict[str, str]:
    return {"name": name, "label": run.outputs[name].title, "unit": run.outputs[name].unit}


def motion_of(run: Trajectory, mechanism: Mechanism) -> dict[str, Any]:
    """Coordinates, roads and elongations of elements at even times, as many a second as a screen shows.

    They are rounded to less than a pixel of any picture, which halves what is sent.
    """
    time = np.arange(run.time[0], run.time[-1] + 0.5 / _FRAMES, 1.0 / _FRAMES)
    inside = elongations(run, mechanism)

    def sample(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.round(np.interp(time, run.time, values), _PLACES)

    at = {name: sample(run[output]) for name, output in _coordinate_outputs(mechanism).items()}
    return {
        "time": np.round(time, _PLACES),
        "coordinates": {c.name: at[c.name] for c in mechanism.coordinates},
        "roads": {r.name: at[r.name] for r in mechanism.roads},
        "elements": {
            mount: {label: sample(values) for label, values in elements.items()} for mount, elements in inside.items()
        },
    }


def _coordinate_outputs(mechanism: Mechanism) -> dict[str, str]:
    """The outputs that say where coordinates and roads are."""
    coordinates = {c.name: f"{c.name}_displacement" for c in mechanism.coordinates}
    return {**coordinates, **{r.name: r.name for r in mechanism.roads}}


def state_intervals(run: Trajectory) -> list[dict[str, Any]]:
    """Time intervals of each switching element in each of its states; those between two limits have words."""
    words = middle_phrases()
    states: dict[str, set[str]] = {element: {state} for element, state in run.states.items()}
    for event in run.events[:_MOST_EVENTS]:
        states[event.element] |= {event.after}
    return [
        {
            "element": element,
            "state": state,
            "words": words.get(state, ""),
            "intervals": run.intervals(element, state)[:_MOST_EVENTS],
        }
        for element, several in states.items()
        for state in sorted(several)
    ]
