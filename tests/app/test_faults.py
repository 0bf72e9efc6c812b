"""Faults that were found in the workbench, and do not come back: what is invalid, and what goes on beside it."""

from __future__ import annotations

from typing import Any

import pytest
from app.conftest import DOCUMENT, ask, changed
from starlette.testclient import TestClient

WRONG = ["k | nope", "k | (", "k | c - nope", ""]
VALUES = {"S1": {"c": 2000.0}, "S3": {"c": 2000.0, "b": 100.0}, "S4": {"c": 2000.0}}


def _with(**layouts: Any) -> dict[str, Any]:
    return changed(layouts={"S4": "k | c | f", **layouts})


def _answer(client: TestClient, study: dict[str, Any], names: list[str], panel: str = "indices", **more: Any) -> Any:
    designs = [{"layout": name, "values": VALUES[name]} for name in names]
    return client.post(f"/api/panel/{panel}", json={"study": study, "designs": designs, **more})


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("spoilt", ["S1", "S3", "S4"])
def test_a_wrong_layout_leaves_the_others_their_answers(client: TestClient, wrong: str, spoilt: str) -> None:
    """One wrong name: the other layouts have the numbers that they had, and the wrong one a sentence."""
    study, right = _with(**{spoilt: wrong}), _with()
    names = list(VALUES)
    others = [name for name in names if name != spoilt]
    told = _answer(client, study, names).json()
    base = {"baseline": {"layout": "S1", "values": VALUES["S1"]}}
    before = _answer(client, right, names, **base).json()
    assert [design["layout"] for design in told["designs"]] == others
    assert [one["layout"] for one in told["left_out"]] == [spoilt]
    assert spoilt in told["left_out"][0]["sentence"]
    for design in told["designs"]:
        (same,) = [one for one in before["designs"] if one["layout"] == design["layout"]]
        assert [each["value"] for each in design["results"]] == [each["value"] for each in same["results"]]
        compared = [each["improvement_percent"] for each in design["results"]]
        if spoilt == "S1":
            assert compared == [None] * len(compared)  # nothing else takes the place of the baseline
        else:
            assert compared == [each["improvement_percent"] for each in same["results"]]
    assert (told["baseline"] is None) == (spoilt == "S1")
    curves = _answer(client, study, names, "response").json()["curves"]
    assert {curve["layout"] for curve in curves} == set(others)


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_asked_of_a_wrong_layout_is_refused(client: TestClient, wrong: str) -> None:
    told = _answer(client, _with(S4=wrong), ["S4"])
    assert told.status_code == 400
    assert told.json()["problems"][0]["place"] == ["layouts", "S4"]
    alone = client.post("/api/panel/mechanism", json={"study": _with(S4=wrong), "layout": "S1"})
    assert alone.status_code == 200


def test_a_check_of_a_wrong_layout_tells_of_the_others(client: TestClient) -> None:
    told, right = ask(client, "study/check", study=_with(S4="k | nope")), ask(client, "study/check", study=_with())
    assert [problem["place"] for problem in told["problems"]] == [["layouts", "S4"]]
    assert told["layouts"] == {name: one for name, one in right["layouts"].items() if name != "S4"}
    assert [one["place"] for one in told["places"]] == [one["place"] for one in right["places"]]


def test_what_is_wrong_elsewhere_is_refused(client: TestClient) -> None:
    study = {**_with(S4="k | nope"), "road": {"speed": "25 kg"}}
    assert _answer(client, study, ["S1"]).status_code == 400
    assert ask(client, "study/check", study=study)["layouts"] == {}


def test_a_study_of_wrong_layouts_only_is_refused(client: TestClient) -> None:
    study = {**DOCUMENT, "layouts": {"S1": "nope", "S3": "nope"}}
    assert _answer(client, study, ["S1"]).status_code == 400
    assert len(ask(client, "study/check", study=study)["problems"]) == 2
