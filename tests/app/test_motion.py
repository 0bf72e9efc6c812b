"""The motion that a page draws: elements inside struts, the baseline on the same road, mechanisms of many vehicles."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import page_vehicles
import pytest
from app.conftest import DOCUMENT, ask, changed
from starlette.testclient import TestClient

import inerter as it
from inerter.app.answers import answer_panel
from inerter.app.designs import one_design
from inerter.app.documents import study_from
from inerter.app.histories import history
from inerter.simulation.elongations import elongations
from inerter.units import parse_quantity

VALUES = {"S1": {"c": 1500.0}, "S3": {"c": 3000.0, "b": 50.0}}
DESIGN = {"layout": "S3", "values": VALUES["S3"]}
BASELINE = {"layout": "S1", "values": VALUES["S1"]}


def test_elements_move_as_in_python(client: TestClient) -> None:
    told = ask(client, "panel/history", study=DOCUMENT, design=DESIGN, seed=3, duration=0.5)
    study = study_from(DOCUMENT)
    assert study.road is not None
    car = study.design("S3").with_values(VALUES["S3"])
    run = it.simulate(car, road=it.multisine(study.road, seed=3), duration=0.5, step=told["step"])
    inside = elongations(run, car.mechanism())
    motion = told["motion"]
    assert set(motion["elements"]) == {"strut", "tyre"}
    assert list(motion["elements"]["strut"]) == ["k", "c", "b", "f"]
    for mount, elements in motion["elements"].items():
        for name, values in elements.items():
            at_even_times = np.interp(np.arange(len(values)) / 60.0, run.time, inside[mount][name])
            assert values == np.round(at_even_times, 7).tolist()
    travel = np.subtract(motion["coordinates"]["sprung"], motion["coordinates"]["unsprung"])
    np.testing.assert_allclose(motion["elements"]["strut"]["k"], travel, rtol=0.0, atol=1.51e-7)  # of rounding


def test_one_output_is_that_of_all_and_another_one_takes_no_other_run(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = {"study": DOCUMENT, "design": DESIGN, "baseline": BASELINE, "seed": 4, "duration": 0.5}
    whole = ask(client, "panel/history", **asked)
    monkeypatch.setattr("inerter.files.simulation.request.simulate", None)  # so that nothing is simulated anew
    for signal in whole["signals"]:
        one = ask(client, "panel/history", output=signal["name"], **asked)
        assert one["signals"] == [signal]
        assert one["outputs"] == [{key: each[key] for key in ("name", "label", "unit")} for each in whole["signals"]]
        assert [each["name"] for each in one["baseline"]["signals"]] == [signal["name"]]
        assert one["motion"] == whole["motion"]
        assert one["peaks"] == {signal["name"]: whole["peaks"][signal["name"]]}
    first = ask(client, "panel/history", output="nothing", **asked)
    assert [each["name"] for each in first["signals"]] == [whole["signals"][0]["name"]]


def test_a_road_that_has_changed_is_driven_anew() -> None:
    """The document of a measured road stays the same when its file changes; its roughness does not."""
    body = {"study": DOCUMENT, "design": DESIGN, "seed": 3, "duration": 0.5}
    study = study_from(DOCUMENT)
    assert study.road is not None
    for road in (study.road, it.Road(4.0 * study.road.roughness, study.road.speed)):
        each = replace(study, road=road)
        told = history(each, one_design(each, body), body)
        car = study.design("S3").with_values(VALUES["S3"])
        run = it.simulate(car, road=it.multisine(road, seed=3), duration=0.5, step=told["step"])
        assert told["rms"]["tyre_load"] == run.rms("tyre_load")


def test_the_baseline_is_on_the_same_road_and_changes_nothing_else(client: TestClient) -> None:
    alone = ask(client, "panel/history", study=DOCUMENT, design=DESIGN, seed=3, duration=0.5)
    other = ask(client, "panel/history", study=DOCUMENT, design=BASELINE, seed=3, duration=0.5)
    both = ask(client, "panel/history", study=DOCUMENT, design=DESIGN, baseline=BASELINE, seed=3, duration=0.5)
    del alone["sequence"], other["sequence"], both["sequence"]
    assert "baseline" not in alone
    baseline = both.pop("baseline")
    assert both == alone
    assert baseline == other
    assert baseline["motion"]["roads"] == both["motion"]["roads"]


def test_a_baseline_that_cannot_move_leaves_the_design_its_motion(client: TestClient) -> None:
    document = changed(layouts={"S9": "g"}, elements={"g": "1 mm"})
    both = ask(client, "panel/history", study=document, design=DESIGN, baseline={"layout": "S9"}, duration=0.1)
    assert both["status"] == "ok"
    assert both["baseline"]["status"] == "failed"
    assert both["baseline"]["message"]
    assert "motion" not in both["baseline"]


def test_both_sides_of_a_car_are_told_apart(client: TestClient) -> None:
    document, layout = page_vehicles.STUDIES["full car"]
    told = ask(client, "panel/mechanism", study=document, layout=layout)
    assert [c["name"] for c in told["coordinates"] if c["roll"]] == ["roll"]
    ends = {strut["name"]: strut["upper"] for strut in told["struts"]}
    assert ends["front_left"]["x"] == pytest.approx(1.2)
    assert ends["rear_right"]["x"] == pytest.approx(-1.5)
    assert {road["side"] for road in told["roads"]} == {"left", "right"}


def test_the_vehicles_of_the_page_are_those_of_the_server() -> None:
    """Tests of the page that have no server draw what `page_vehicles` has written."""
    kept = json.loads(page_vehicles.FIXTURE.read_text(encoding="utf-8"))
    for name, told in page_vehicles.described().items():
        assert kept[name]["mechanism"] == {key: told[key] for key in kept[name]["mechanism"]}, name


def test_masses_and_tyres_are_written_by_the_library() -> None:
    heavy = changed(vehicle={"sprung_mass": "12.5 t", "tyre_stiffness": "1.8 MN/m"})
    found = answer_panel("mechanism", {"study": heavy, "layout": "S1"})
    texts = {one["name"]: one["text"] for one in found["coordinates"]}
    assert {name: parse_quantity(text, "kg") for name, text in texts.items()} == {"sprung": 12500.0, "unsprung": 35.0}
    (tyre,) = found["tyres"]
    assert tyre["network"]["text"] == "1.8 MN/m"
