"""A search for the best network: ranked while it goes on, resumed where it stopped, and taken into the document."""

from __future__ import annotations

import os
import re
import threading
import time
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, cast

import pytest
from app.conftest import DOCUMENT, ask, changed
from app.test_work import begin, until
from campaigns import sampled
from starlette.testclient import TestClient
from wang_su import ROAD

import inerter as it
from inerter.app import searches
from inerter.app.documents import study_from
from inerter.app.jobs import ENDED
from inerter.files.study import search_parts
from inerter.files.study.search_parts import NetworkFrontPart, RealPart
from inerter.network_search import plan as network_search

FREE = {
    "network": 3,
    "springs": {"from": "1 kN/m", "to": "10 MN/m"},
    "dampers": {"from": "10 N s/m", "to": "1 MN s/m"},
    "inerters": {"from": "10 g", "to": "10 t"},
}
SEARCHED = changed(elements={"any": FREE, "c1": "900 N s/m"}, layouts={"S9": "k | any"})


def _searched_by_library(*indices: str) -> Any:
    """The same search without files and server."""
    place = it.any_network(3, (1e3, 1e7), (10.0, 1e6), (0.01, 1e4))
    car = it.QuarterCar(sprung_mass=250.0, unsprung_mass=35.0, tyre_stiffness=150e3, strut=it.Spring(20e3, "k") | place)
    asked = [it.INDICES[index](ROAD) for index in indices]
    return it.search(car, asked if len(asked) > 1 else asked[0], it.Norm())


def _result(client: TestClient, study: Any, **more: Any) -> Any:
    number = begin(client, kind="search", study=study, layouts=["S9"], **more)
    until(client, number, *ENDED)
    return client.get(f"/api/work/{number}/result").json()


def _taken(study: Any, row: Any) -> it.Study:
    """The study with a network of a search in place of the free one."""
    assert not set(row["elements"]) & set(study["elements"])
    elements, layouts = {**study["elements"], **row["elements"]}, {**study["layouts"], "S9": row["entry"]}
    return study_from({**study, "elements": elements, "layouts": layouts})


def _searched(job: Any) -> int:
    """Number of networks that a search has ranked; the baseline is done before."""
    return int(job["done"]) - 1


def _ranking(job: Any) -> Any:
    """The ranking so far."""
    return job["found"]["searches"][0]["ranking"] if "found" in job else []


@pytest.mark.parametrize("index", sampled(["J1", "J3"], ["J1"]))
def test_the_ranking_is_that_of_the_library_and_each_network_is_a_layout(client: TestClient, index: str) -> None:
    found = _result(client, SEARCHED, indices=[index])
    (searched,), library = found["searches"], _searched_by_library(index)
    assert [row["value"] for row in searched["ranking"]] == [one.value for one in library.ranking[:10]]
    shown = [(row["n_elements"], row["value"]) for row in searched["frontier"]]
    assert shown == [(one.n_elements, one.value) for one in library.frontier]
    values = [value for _, value in shown]
    gains = [100.0 * (1.0 - value / before) for before, value in pairwise(values)]
    assert [row["gain_on_previous_percent"] for row in searched["frontier"]] == [None, *map(pytest.approx, gains)]
    assert (found["networks"], found["complete"], found["front"]) == (library.n_networks, True, None)
    for row in searched["ranking"]:
        study = _taken(SEARCHED, row)
        estimate = it.evaluate(study.design("S9"), study.index(index), it.Norm())
        assert row["value"] == pytest.approx(estimate.value, rel=1e-6), row["network"]


@pytest.mark.campaign
def test_the_front_of_two_indices_is_that_of_the_library_and_each_point_is_a_layout(client: TestClient) -> None:
    found, library = _result(client, SEARCHED, indices=["J1", "J3"]), _searched_by_library("J1", "J3")
    assert [one["index"] for one in found["searches"]] == ["J1", "J3"]
    several = {front["elements"]: front["points"] for front in found["front"]["fronts"]}
    for count, points in several.items():
        own = library.by_elements[count]
        assert [tuple(point["indices"].values()) for point in points] == [point.values for point in own]
    assert several[max(several)]
    assert len(several) > 1
    baselines = {one["index"]: one["baseline_value"] for one in found["searches"]}
    for point in several[max(several)]:
        study = _taken(SEARCHED, point)
        for index, value in point["indices"].items():
            estimate = it.evaluate(study.design("S9"), study.index(index), it.Norm())
            assert value == pytest.approx(estimate.value, rel=1e-6), point["network"]
            gain = 100.0 * (1.0 - value / baselines[index])
            assert point["improvements_percent"][index] == pytest.approx(gain, rel=1e-9)


@pytest.mark.campaign
def test_real_inerters_of_a_study_are_in_its_search_and_each_is_a_layout(client: TestClient) -> None:
    """Also where the study has names that those of shaft and friction would be."""
    asked = {"friction": "20 N", "stiffness": "2 MN/m", "best": 1, "methods": ["statistical-linearisation"]}
    study = changed(
        elements={"any": {**FREE, "network": 2}, "b1_f": "3 N"},
        layouts={"S9": "k | any"},
        study={"real_inerters": asked},
    )
    (searched,) = _result(client, study, indices=["J1"])["searches"]
    assert searched["real_inerters"]
    for row in searched["real_inerters"]:
        taken = _taken(study, row)
        assert sorted(text for text in row["elements"].values() if text.endswith(" N")) == ["20.0 N"]
        assert "2000000.0 N/m" in row["elements"].values()
        estimate = it.evaluate(taken.design("S9"), taken.index("J1"), it.StatisticalLinearisation())
        assert row["value"] == pytest.approx(estimate.value, rel=1e-9)
        assert row["value"] <= row["same_values"] * (1.0 + 1e-9)


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

    def note(ranking: Any, groups: Any) -> None:
        ranked.extend(network for group in groups for network in group.networks)
        rank(ranking, groups)

    monkeypatch.setattr(search_parts, "search_group", search_group)
    monkeypatch.setattr(searches._Ranking, "add", note)
    number = begin(client, kind="search", study=SEARCHED, layouts=["S9"], indices=["J1"])
    while not _ranking(before := client.get(f"/api/work/{number}").json()):
        assert before["state"] not in ENDED, before
    assert _searched(before) == len(ranked) == len(tried) < before["found"]["networks"]
    assert re.fullmatch(r"\d+ of \d+ networks optimised for J1", before["told"])
    refused = client.post(f"/api/work/{number}/resume")
    assert refused.status_code == 400
    assert "running" in refused.json()["sentence"]
    client.delete(f"/api/work/{number}")
    goes_on.set()
    stopped = until(client, number, "stopped")
    assert _searched(before) <= (kept := _searched(stopped)) < stopped["found"]["networks"]
    assert _ranking(stopped)
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
        ({"study": SEARCHED, "layouts": ["S9"], "indices": ["J1", "J3", "J5", "J1 "]}, "two or three indices"),
        ({"study": SEARCHED, "layouts": ["S0"]}, "S0"),
    ],
)
def test_what_cannot_be_searched_has_a_sentence(client: TestClient, body: dict[str, Any], words: str) -> None:
    told = until(client, begin(client, kind="search", **body), *ENDED)
    assert told["state"] == "failed"
    assert words in told["sentence"]


def test_a_free_network_is_no_problem_of_a_study_and_named_where_designs_are_asked_for(client: TestClient) -> None:
    told = ask(client, "study/check", study=SEARCHED)
    assert told["problems"] == []
    assert set(told["layouts"]) == {"S1", "S3"}
    alone = {**SEARCHED, "layouts": {"S9": "k | any"}, "study": {"indices": ["J1"], "optimise": "norm"}}
    checked = ask(client, "study/check", study=alone)
    assert "J3" in [row["of"] for row in checked.pop("limitable")]
    assert checked == {"problems": [], "notes": [], "layouts": {}, "places": []}
    faulty = {**SEARCHED, "layouts": {**SEARCHED["layouts"], "S4": "k | nope"}}
    (problem,) = ask(client, "study/check", study=faulty)["problems"]
    assert problem["place"] == ["layouts", "S4"]
    refused = ask(client, "panel/decision", study=SEARCHED, layouts=["S9"])
    assert "Search" in refused["problems"][0]["hint"]
    layouts = ask(client, "study/parts", study=SEARCHED)["layouts"]
    assert {name: row["free_networks"] for name, row in layouts.items()} == {"S1": [], "S3": [], "S9": ["any"]}


@pytest.mark.parametrize(
    ("part", "told"),
    [
        (None, "0 of 1 networks optimised for J1 and J3 each"),
        (NetworkFrontPart("S9", 1, "b - c"), "networks between the best for J1 and J3: b - c is done"),
        (RealPart("S9", "J3", "expected-value", ""), "with real inerters, J3 by simulation: the baseline is done"),
    ],
)
def test_the_progress_of_a_search_is_told_in_plain_words(part: Any, told: str) -> None:
    plan: Any = SimpleNamespace(topologies=[None])
    ranking = searches._Ranking(
        {}, cast("Any", None), {("S9", "J1"): plan, ("S9", "J3"): plan}, n_searched=2 if part else 0
    )
    assert ranking.progress(None if part is None else cast("Any", SimpleNamespace(part=part))) == told
