"""Ten and more vehicles that the page draws, and what the server says of each: `web/tests/vehicles.json`.

Written anew by `PYTHONPATH=src:tests python tests/page_vehicles.py`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from folders import ROOT, example_tables

import inerter as it
from inerter.app.answers import answer_panel, describe_mechanism
from inerter.app.histories import motion_of, state_intervals
from inerter.app.wire import encode_json

FIXTURE = ROOT / "web/tests/vehicles.json"
DURATION, STEP, KEPT = 1.0, 5e-4, 4  # [s], [s], every n-th frame
ROAD = {"speed": "22 m/s", "roughness": "2e-6 m^3/cycle"}
COMFORT = {"comfort": {"body_acceleration": 1}}
ASKED = {"indices": ["J1"]}


def example(name: str, **vehicle: Any) -> dict[str, Any]:
    """Document of an example, with some keys of its vehicle changed."""
    document = example_tables(name)
    return {**document, "vehicle": {**document["vehicle"], **vehicle}}


def _with_elements(document: dict[str, Any], **elements: str) -> dict[str, Any]:
    return {**document, "elements": {**document["elements"], **elements}}


def _truck() -> dict[str, Any]:
    levers = {"front": 2.1, "middle": -1.2, "rear": -2.4}
    vehicle = {
        "model": "mechanism",
        "coordinates": {"body": "9 t", "pitch": "18e3 kg m^2", **{f"{axle}_wheel": "350 kg" for axle in levers}},
        "struts": {
            axle: {"upper": {"body": 1, "pitch": f"{lever} m"}, "lower": {f"{axle}_wheel": 1}}
            for axle, lever in levers.items()
        },
        "tyres": {
            f"{axle}_tyre": {"port": {f"{axle}_wheel": 1}, "road": f"{axle}_road", "network": "kt"} for axle in levers
        },
        "roads": {f"{axle}_road": {"distance": f"{2.1 - lever} m"} for axle, lever in levers.items()},
        "measures": COMFORT,
    }
    elements = {"k": "250 kN/m", "c": "20 kN s/m", "b": "800 kg", "kt": "900 kN/m"}
    return {"vehicle": vehicle, "road": ROAD, "elements": elements, "layouts": {"S3": "k | c - b"}, "study": ASKED}


def _rockers() -> dict[str, Any]:
    """A body on a rocker in front and a trailing arm behind, with a load on it."""
    vehicle = {
        "model": "mechanism",
        "coordinates": {
            **{"body": "900 kg", "pitch": "1500 kg m^2", "rocker": "4 kg m^2"},
            **{"front_wheel": "40 kg", "rear_wheel": "40 kg", "load": "120 kg"},
        },
        "struts": {
            "front": {"upper": {"body": 1, "pitch": "1.3 m"}, "lower": {"rocker": "0.3 m"}},
            "push": {"upper": {"rocker": "-0.2 m"}, "lower": {"front_wheel": 1}, "network": "kp"},
            "rear": {"upper": {"body": 0.8, "pitch": "-1.1 m"}, "lower": {"rear_wheel": 0.8}},
            "lashing": {"upper": {"load": 1}, "lower": {"body": 1, "pitch": "-0.5 m"}, "network": "kl | cl"},
        },
        "tyres": {
            "front_tyre": {"port": {"front_wheel": 1}, "road": "front_road", "network": "kt"},
            "rear_tyre": {"port": {"rear_wheel": 1}, "road": "rear_road", "network": "kt | ct"},
        },
        "roads": {"front_road": {}, "rear_road": {"distance": "2.4 m"}},
        "measures": COMFORT,
    }
    elements = {"k": "40 kN/m", "c": "3 kN s/m", "b": "80 kg", "kt": "200 kN/m", "ct": "200 N s/m", "kp": "5 MN/m"}
    elements |= {"kl": "30 kN/m", "cl": "500 N s/m"}
    return {"vehicle": vehicle, "road": ROAD, "elements": elements, "layouts": {"S3": "k | c - b"}, "study": ASKED}


def _building() -> dict[str, Any]:
    document = example("building_wind")
    index = {"kind": "peak-response", "input": "wind", "output": "floor_3_displacement"}
    kept = {name: document[name] for name in ("vehicle", "elements", "layouts")}
    return {**kept, "indices": {"r": index}, "study": {"indices": ["r"]}}


def _gap() -> dict[str, Any]:
    document = _with_elements(example("ball_screw"), g="2 mm", f="200 N", c="7 kN s/m", b="300 kg")
    return {**document, "study": ASKED, "layouts": {"S1": "k | c", "G": "k | c - (ks - g | cs) - (b | f)"}}


def _bridge() -> dict[str, Any]:
    document = _with_elements(example("ball_screw"), d="2 kN s/m", c="5 kN s/m", b="200 kg")
    return {**document, "study": ASKED, "layouts": {"S1": "k | c", "B": "k | bridge(c, b, ks, d, cs)"}}


def _beam() -> dict[str, Any]:
    """A body on one strut, which stands on a beam between two wheels."""
    vehicle = {
        "model": "mechanism",
        "coordinates": {"body": "400 kg", "first": "40 kg", "second": "40 kg"},
        "struts": {"strut": {"upper": {"body": 1}, "lower": {"first": 0.5, "second": 0.5}}},
        "tyres": {f"tyre_{n}": {"port": {n: 1}, "road": f"road_{n}", "network": "kt"} for n in ("first", "second")},
        "roads": {"road_first": {}, "road_second": {"distance": "1.4 m"}},
        "measures": COMFORT,
    }
    elements = {"k": "40 kN/m", "c": "3 kN s/m", "kt": "200 kN/m"}
    return {"vehicle": vehicle, "road": ROAD, "elements": elements, "layouts": {"S1": "k | c"}, "study": ASKED}


_SEAT = {"mass": "70 kg", "network": "kd | cd", "place": {"sprung": 1, "pitch": "0.2 m", "roll": "0.4 m"}}
STUDIES: Mapping[str, tuple[dict[str, Any], str]] = {
    "quarter car": (example("ball_screw"), "S3"),
    "half car": (example("half-car"), "S3"),
    "full car": (example("full-car"), "S4"),
    "full car on two tracks": (example("full-car-two-tracks"), "S1"),
    "seat": (example("seat"), "S3"),
    "seat in a full car": (_with_elements(example("full-car", seat=_SEAT), kd="12 kN/m", cd="300 N s/m"), "S2"),
    "absorber": (example("absorber"), "TMDI"),
    "train": (example("train"), "S3"),
    "three axles": (_truck(), "S3"),
    "rockers": (_rockers(), "S3"),
    "beam": (_beam(), "S1"),
    "building": (_building(), "TMDI"),
    "gap": (_gap(), "G"),
    "bridge": (_bridge(), "B"),
}
RIG = it.Rig(
    it.Spring(1e6, name="k") - (it.Inerter(300.0, name="b") | it.Friction(10.0, name="f") | it.Damper(2e3, name="c"))
)


def described() -> dict[str, Any]:
    """Mechanism of each vehicle, as the server describes it."""
    found = {
        name: answer_panel("mechanism", {"study": document, "layout": layout})
        for name, (document, layout) in STUDIES.items()
    }
    whole: dict[str, Any] = _as_json({**found, "rig": describe_mechanism(RIG.mechanism())})
    return whole


def _moved(document: dict[str, Any], layout: str) -> dict[str, Any] | None:
    if "road" not in document:
        return None
    body = {"study": document, "layout": layout, "duration": DURATION, "step": STEP}
    answer = answer_panel("history", body)
    return {"motion": answer["motion"], "shaded": answer["shaded"]}


def fixture() -> dict[str, Any]:
    """Model, speed, mechanism and motion of each vehicle."""
    road = it.multisine(it.Road(roughness=5e-7, speed=25.0), seed=1)
    run, mechanism = it.simulate(RIG, displacement=road, duration=DURATION, step=STEP), RIG.mechanism()
    moved = {name: _moved(*study) for name, study in STUDIES.items()}
    moved["rig"] = {"motion": motion_of(run, mechanism), "shaded": state_intervals(run)}
    told = {}
    for name, mechanism in described().items():
        document = STUDIES[name][0] if name in STUDIES else {"vehicle": {"model": "rig"}}
        kept = {key: mechanism[key] for key in ("coordinates", "struts", "tyres", "roads")}
        speed = float(document.get("road", {}).get("speed", "0 m/s").split()[0])
        model = document["vehicle"]["model"]
        outline = it.VEHICLES[model].outline if model in it.VEHICLES else ""
        told[name] = {"model": model, "outline": outline, "speed": speed, "mechanism": kept, **_thin(moved[name])}
    return told


def _thin(moved: dict[str, Any] | None) -> dict[str, Any]:
    """Every n-th frame, with few digits."""
    if moved is None:
        return {"motion": None, "shaded": []}

    def few(values: Any) -> Any:
        if isinstance(values, dict):
            return {name: few(each) for name, each in values.items()}
        return [float(f"{value:.7g}") for value in values[::KEPT]]

    return {"motion": few(_as_json(moved["motion"])), "shaded": _as_json(moved["shaded"])}


def _as_json(value: Any) -> Any:
    return json.loads(encode_json(value))


if __name__ == "__main__":
    text = json.dumps(fixture(), separators=(",", ":"))
    FIXTURE.write_text(text.replace('},"', '},\n"') + "\n", encoding="utf-8")
