"""A search for the best network: ranked while it goes on, resumed where it stopped, and taken into the document."""

from __future__ import annotations

import os
import threading
import time
from typing import Any

import pytest
from app.conftest import DOCUMENT, ask, changed
from app.test_work import begin, until
from starlette.testclient import TestClient

import inerter as it
from inerter.app import searches
from inerter.app.documents import study_from
from inerter.app.jobs import ENDED
from inerter.files.study import search_parts
from inerter.network_search import plan as network_search

FREE = {
    "network": 3,
    "springs": {"from": "1 kN/m", "to": "10 MN/m"},
    "dampers": {"from": "10 N s/m", "to": "1 MN s/m"},
    "inerters": {"from": "10 g", "to": "10 t"},
}
SEARCHED = changed(elements={"any": FREE, "c1": "900 N s/m"}, layouts={"S9": "k | any"})


def _searched_by_library(index: str) -> Any:
    """The same search without files and server."""
    place = it.any_network(3, (1e3, 1e7), (10.0, 1e6), (0.01, 1e4))
    car = it.QuarterCar(sprung_mass=250.0, unsprung_mass=35.0, tyre_stiffness=150e3, strut=it.Spring(20e3, "k") | place)
    return it.search(car, it.INDICES[index](it.Road(roughness=5e-7, speed=25.0)), it.Norm())


def _searched(job: Any) -> int:
    """Number of networks that a search has ranked; the baseline is done before."""
    return int(job["done"]) - 1


@pytest.mark.parametrize("index", ["J1", "J3"])
def test_the_ranking_is_that_of_the_library_and_each_network_is_a_layout(client: TestClient, index: str) -> None:
    number = begin(client, kind="search", study=SEARCHED, layouts=["S9"], indices=[index])
    until(client, number, *ENDED)
    found = client.get(f"/api/work/{number}/result").json()
    ranking = _searched_by_library(index).ranking[:10]
    assert [row["value"] for row in found["ranking"]] == [one.value for one in ranking]
    assert (found["networks"], found["complete"]) == (_searched_by_library(index).n_networks, True)
    for row in found["ranking"]:
        assert not set(row["elements"]) & set(SEARCHED["elements"])
        taken = {
            **SEARCHED,
            "elements": {**SEARCHED["elements"], **row["elements"]},
            "layouts": {**SEARCHED["layouts"], "S9": row["entry"]},
        }
        study = study_from(taken)
        estimate = it.evaluate(study.design("S9"), study.index(index), it.Norm())
        assert row["value"] == pytest.approx(estimate.value, rel=1e-6), row["network"]


def test_a_search_that_was_stopped_keeps_its_ranking_and_continues(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 1)  # no further process, which would not know what is put in here
    monkeypatch.setattr(network_search, "_GROUP", 5)
    tried, ranked, rank = list[Any](), list[Any](), searches._Ranking.add
    goes_on = threading.Event()

    def search_group(plan: Any, topologies: Any) -> Any:
        assert not ranked or goes_on.wait(60.0)
        time.sleep(0.0 if goes_on.is_set() else 0.3)
        tried.extend(topologies)
        return network_search.search_group(plan, topologies)

    monkeypatch.setattr(search_parts, "search_group", search_group)
    monkeypatch.setattr(searches._Ranking, "add", lambda self, found: (ranked.extend(found), rank(self, found)))
    number = begin(client, kind="search", study=SEARCHED, layouts=["S9"], indices=["J1"])
    while not (before := client.get(f"/api/work/{number}").json()).get("found", {}).get("ranking"):
        assert before["state"] not in ENDED, before
    assert _searched(before) == len(ranked) == len(tried) < before["found"]["networks"]
    refused = client.post(f"/api/work/{number}/resume")
    assert refused.status_code == 400
    assert "running" in refused.json()["sentence"]
    client.delete(f"/api/work/{number}")
    goes_on.set()
    stopped = until(client, number, "stopped")
    assert _searched(before) <= (kept := _searched(stopped)) < stopped["found"]["networks"]
    assert stopped["found"]["ranking"]
    assert client.get(f"/api/work/{number}/result").status_code == 404
    assert client.post(f"/api/work/{number}/resume").json()["state"] in ("waiting", "running")
    until(client, number, "done")
    found = client.get(f"/api/work/{number}/result").json()
    assert not set(tried[:kept]) & set(tried[kept:])
    assert len(set(tried)) == found["networks"]
    whole = begin(client, kind="search", study=SEARCHED, layouts=["S9"], indices=["J1"])
    until(client, whole, "done")
    assert found == client.get(f"/api/work/{whole}/result").json()


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"study": DOCUMENT}, "no layout has a free network"),
        ({"study": SEARCHED, "layouts": ["S9"], "indices": ["J1", "J3"]}, "one layout for one index"),
        ({"study": SEARCHED, "layouts": ["S0"]}, "S0"),
    ],
)
def test_what_cannot_be_searched_has_a_sentence(client: TestClient, body: dict[str, Any], words: str) -> None:
    told = until(client, begin(client, kind="search", **body), *ENDED)
    assert told["state"] == "failed"
    assert words in told["sentence"]


def test_a_free_network_is_named_where_designs_are_asked_for(client: TestClient) -> None:
    told = ask(client, "study/check", study=SEARCHED)
    assert [problem["place"] for problem in told["problems"]] == [["layouts", "S9"]]
    assert "Search" in told["problems"][0]["hint"]
    layouts = ask(client, "study/parts", study=SEARCHED)["layouts"]
    assert {name: row["free_networks"] for name, row in layouts.items()} == {"S1": [], "S3": [], "S9": ["any"]}
