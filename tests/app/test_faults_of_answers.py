"""Faults that were found in the workbench, and do not come back: what is invalid, and what goes on beside it."""

from __future__ import annotations

import asyncio
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from app.conftest import DOCUMENT, ask, changed, threads
from campaigns import sampled
from folders import EXAMPLES
from starlette.testclient import TestClient

import inerter as it
from inerter.app import documents, fit_advice
from inerter.app.lanes import Lane
from inerter.app.server import Server
from inerter.app.start import InitialStudy
from inerter.app.warming import Warming
from inerter.files.common.toml import as_toml
from inerter.files.identification.loading import identification_of
from inerter.files.rig.loading import load_rig
from inerter.records.remedy import Action

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
    caveats = [one["sentence"] for one in _answer(client, study, names, "decision").json()["verdict"]["caveats"]]
    said = f"The baseline {spoilt} is not valid" if spoilt == "S1" else f"{spoilt} is not valid; it is not ranked"
    assert sum(said in sentence for sentence in caveats) == 1
    assert not [
        one for one in _answer(client, right, names, "decision").json()["verdict"]["caveats"] if "valid" in str(one)
    ]
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


def test_the_study_of_the_command_line_is_that_of_its_file(tmp_path: Path) -> None:
    """What another program writes is what the next page opens; what cannot be read says why."""
    file = tmp_path / "mine.toml"
    file.write_text(as_toml(DOCUMENT))
    start = InitialStudy.of(file.name, file.read_text(), file)
    first, stamp = start.to_dict(), start.stamp()
    assert first["study"] == DOCUMENT
    assert first["stamp"] == stamp["stamp"] == start.stamp()["stamp"]
    file.write_text(as_toml(changed(elements={"k": "31 kN/m"})))
    assert start.stamp()["stamp"] != stamp["stamp"]
    assert start.to_dict()["study"]["elements"]["k"] == "31 kN/m"
    assert start.to_dict()["stamp"] == start.stamp()["stamp"]
    file.write_bytes(b"\xff\xfe\x00")
    assert "UTF-8" in start.to_dict()["problems"][0]["sentence"]
    file.unlink()
    assert start.stamp() == {"name": "mine.toml", "stamp": ""}
    assert start.to_dict()["problems"]
    assert InitialStudy().to_dict() == {"name": "", "text": "", "study": {}, "problems": [], "stamp": ""}


@pytest.mark.parametrize("text", ["broken = [", "[study]\nx = 1", ""])
def test_all_processes_begin_whatever_the_file_of_the_command_line(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    server = Server(tmp_path, InitialStudy.of("mine.toml", text, None), process=threads)
    begun = {name: asyncio.Event() for name in server.lanes}

    async def begin(lane: Lane) -> None:
        next(begun[name] for name, one in server.lanes.items() if one is lane).set()

    async def warm(warming: Warming, worker: Any) -> None:
        warming.done.set()

    monkeypatch.setattr(Lane, "begin", begin)
    monkeypatch.setattr(Warming, "run", warm)

    async def run() -> None:
        async with server.running():
            await asyncio.wait_for(asyncio.gather(begun["quick"].wait(), begun["slow"].wait()), 60.0)

    asyncio.run(run())


def test_work_has_a_title_of_its_own_and_no_step_once_it_is_done(client: TestClient) -> None:
    jobs = []
    for place in ("b", "f"):
        study = changed(elements={"b": "30 kg"}, study={"indices": ["J1"]})
        values = ["20 kg", "30 kg"] if place == "b" else ["10 N", "20 N"]
        body = {"kind": "sweep", "study": study, "sweep": {place: values}, "wait": 30}
        jobs.append(client.post("/api/work", json=body).json())
    assert [(job["title"], job["study"]) for job in jobs] == [("Sweep of b", "A car"), ("Sweep of f", "A car")]
    assert jobs[0]["state"] == "done", jobs[0]["sentence"]
    assert jobs[0]["told"] == ""


WITHHELD = [("friction", "elastic-friction"), ("ideal", "choose")]


@pytest.mark.parametrize(("model", "model_offered"), sampled(WITHHELD, kept=0))
def test_a_fit_that_is_withheld_offers_what_can_be_done(
    client: TestClient, tmp_path: Path, model: str, model_offered: str
) -> None:
    record = tmp_path / "screw.csv"
    it.write_record(replace(load_rig(EXAMPLES / "rig_fit.toml"), duration=1.0).run(), record)
    sent = client.post("/api/records?name=screw.csv", content=record.read_bytes()).json()
    body = {"kind": "identify", "records": [sent["id"]], "model": model, "wait": 30}
    job = client.post("/api/work", json=body).json()
    while job["state"] in ("waiting", "running"):
        time.sleep(0.2)
        job = client.get(f"/api/work/{job['id']}").json()
    result = client.get(f"/api/work/{job['id']}/result").json()
    assert result["reason"]
    assert result["reason"] in result["status"]
    assert result["device"] is None
    assert all(value == "withheld" and "None" not in interval for value, interval in result["shown"].values())
    offers = [*result["offers"], *(offer for cause in result["causes"] for offer in cause["offers"])]
    assert model_offered in [offer.get("model") for offer in offers]
    assert {"section": "record", "key": "fixture_mass", "example": "0.3 kg"} in [offer.get("ask") for offer in offers]
    assert all(cause["sentence"] and 0.0 < cause["explained"] <= 1.0 for cause in result["causes"])
    assert any("“Fixture mass”" in said for said in result["findings"])  # the name of its button
    assert not any("fixture_mass" in said or "--" in said for said in result["findings"])
    assert result["asked"] == {"model": model, "config": {}}
    for offer in offers:  # each is a request that the library takes
        stated = {offer["ask"]["section"]: {offer["ask"]["key"]: offer["ask"]["example"]}} if "ask" in offer else {}
        named = {"name": offer["model"]} if "model" in offer else {}
        identification_of({"model": named, **stated, **offer.get("config", {})}, tmp_path)


def test_every_remedy_with_an_option_is_an_offer_or_a_sentence() -> None:
    for action, offer in fit_advice._OFFERS.items():
        one = offer("fill" if action is Action.GAPS else None)
        assert one["label"]
        config = one.get("config") or {one["ask"]["section"]: {one["ask"]["key"]: one["ask"]["example"]}}
        identification_of({"model": {}, **config}, Path("x.toml"))


@pytest.mark.parametrize("panel", ["indices", "response", "compare", "optimise"])
def test_an_index_that_is_none_is_a_sentence(client: TestClient, panel: str) -> None:
    told = _answer(client, _with(), ["S1", "S3"], panel, indices=["J9"])
    assert told.status_code == 400
    assert "J9" in told.json()["sentence"]
    assert "J1" in told.json()["sentence"]


def test_the_first_layout_stays_the_baseline_where_layouts_are_called_like_numbers() -> None:
    """Objects of JavaScript have such keys first, and the page sends the document in that order."""
    lines = (EXAMPLES / "quarter-car.toml").read_text(encoding="utf-8").splitlines(keepends=True)
    unnamed = "".join(line for line in lines if not line.startswith("baseline"))
    assert "baseline" not in documents.read(unnamed)["study"]["study"]
    document = documents.read(unnamed.replace("S3 = ", '"1" = '))["study"]
    assert {"S1", "1"} < set(document["layouts"])
    assert document["study"]["baseline"] == next(iter(document["layouts"])) == "S1"
