"""What plots of the page are drawn from: gains and phases by hand, names of outputs, written units of sweeps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from app.conftest import DOCUMENT, ask
from folders import EXAMPLES
from starlette.testclient import TestClient

from inerter.app.answers import answer_panel
from inerter.app.documents import read


def _response(document: dict[str, Any], **more: Any) -> Any:
    return answer_panel("response", {"study": document, **more})


def test_gain_and_phase_of_a_quarter_car_are_those_of_its_equations() -> None:
    """Against a two by two system, solved by hand at each frequency: the acceleration of the body per road velocity."""
    document = {**DOCUMENT, "elements": {**DOCUMENT["elements"], "c": "1500 N s/m"}}
    answer = _response(document, layouts=["S1"], indices=["J1", "J3"])
    s = 2j * np.pi * np.asarray(answer["frequency"])
    sprung, unsprung, tyre, strut = 250.0, 35.0, 150e3, 20e3 + 1500.0 * s
    wheel = (tyre / s) / (unsprung * s**2 + strut + tyre - strut**2 / (sprung * s**2 + strut))  # over road velocity
    body = wheel * strut / (sprung * s**2 + strut)
    expected = {"J1": body * s**2, "J3": tyre * (wheel - 1.0 / s)}
    for curve in answer["curves"]:
        value = expected[curve["index"]]
        assert curve["gain"] == pytest.approx(np.abs(value), rel=1e-9)
        off = np.angle(np.exp(1j * (np.asarray(curve["phase"]) - np.angle(value))))
        if curve["index"] == "J3":  # load or its opposite: a convention of the sign
            off = np.angle(np.exp(2j * off)) / 2.0
        assert np.abs(off).max() < 1e-8


def test_the_response_of_a_seat_is_that_of_its_occupant() -> None:
    """Not of the body, whose acceleration is drawn of a car without a seat."""
    for name, part in (("seat", "occupant"), ("quarter-car", "body")):
        document = read((EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"), f"{name}.toml")["study"]
        [title] = {curve["title"] for curve in _response(document, indices=["J1"])["curves"]}
        assert title == f"{part} acceleration per road velocity"


@pytest.mark.parametrize("name", ["half-car", "full-car", "train"])
def test_each_output_of_an_index_has_a_title_of_its_own(name: str) -> None:
    document = read((EXAMPLES / f"{name}.toml").read_text())["study"]
    answer = _response(document, layouts=[next(iter(document["layouts"]))])
    for index in document["study"]["indices"]:
        titles = [curve["title"] for curve in answer["curves"] if curve["index"] == index]
        assert len(set(titles)) == len(titles)
        assert all(" per " in title for title in titles)


def test_independent_sources_have_gains_and_no_phase() -> None:
    document = read((EXAMPLES / "full-car-two-tracks.toml").read_text())["study"]
    answer = _response(document, layouts=[next(iter(document["layouts"]))], indices=["J1"])
    for curve in answer["curves"]:
        assert np.isfinite(curve["gain"]).all()
        assert np.isnan(curve["phase"]).all()


@pytest.mark.campaign
def test_a_sweep_tells_in_which_unit_it_is_written(client: TestClient) -> None:
    alone = {**DOCUMENT, "layouts": {"S1": "k | c"}}
    for asked in ({"indices": ["J1", "J3"]}, {"trade_off": ["J1", "J3"]}):  # a sweep leaves the trade-off out
        study = {**alone, "study": {"optimise": "norm", **asked}}
        told = ask(client, "work", kind="sweep", study=study, sweep={"k": ["15 kN/m", "25 kN/m"]}, wait=30)
        (swept,) = told["result"]["swept"]
        assert swept["words"] == "spring k"
        assert swept["own"] == 20_000.0
        assert swept["written"] == {"unit": "kN/m", "factor": 1000.0}
        assert {row["index"] for row in told["result"]["designs"]} == {"J1", "J3"}
        assert told["result"]["units"]["c"] == "N s/m"
