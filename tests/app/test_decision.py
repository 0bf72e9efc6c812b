"""The panel `decision`: its numbers are those of the library, and its words follow from them."""

from __future__ import annotations

import re
import tomllib
from itertools import pairwise
from typing import Any

import pytest
from app.conftest import DOCUMENT, ask, changed
from app.test_work import until
from folders import example_tables
from hypothesis import example, given, settings
from hypothesis import strategies as st
from starlette.testclient import TestClient
from study_text import HALF_CAR, study_text

import inerter as it
from inerter.app.answers import answer_panel
from inerter.app.documents import study_from
from inerter.files.study.cases import cases, run_case
from inerter.files.study.results import dataset
from inerter.formatting import printed_text
from inerter.report.conclusions import conclusion_sentences
from inerter.report.verdicts import study_decision

ROW = ("value", "standard_error", "decimals", "status", "message", "improvement_percent", "improvement_error_percent")
BLIND, SEEING = "norm", "statistical-linearisation"


def sentences(answer: dict[str, Any]) -> list[str]:
    """The verdict and its caveats."""
    verdict = answer["verdict"]
    return [verdict["sentence"], *(one["sentence"] for one in verdict["caveats"])]


@example(c1=300.0, c=990.0, b=2.0, method=SEEING)  # errors as large as the values
@example(c1=300.0, c=300.0, b=309.0, method=BLIND)  # a difference that rounds to 0.0 %
@settings(max_examples=4)
@given(
    c1=st.floats(300.0, 9e3),
    c=st.floats(300.0, 9e3),
    b=st.floats(2.0, 900.0),
    method=st.sampled_from([BLIND, SEEING]),
)
def test_rows_have_the_numbers_of_the_indices(client: TestClient, c1: float, c: float, b: float, method: str) -> None:
    """Values, improvements, statuses and limits of the goal and of the others."""
    body = {"study": DOCUMENT, "values": {"S1": {"c": c1}, "S3": {"c": c, "b": b}}, "methods": [method]}
    told = ask(client, "panel/decision", **body, index="J3")
    shown = {
        d["layout"]: {r["index"]: r for r in d["results"]} for d in ask(client, "panel/indices", **body)["designs"]
    }
    assert (told["goal"]["index"], told["method"], len(told["rows"])) == ("J3", method, 2)
    for row in told["rows"]:
        there = shown[row["layout"]]
        assert {key: row[key] for key in ROW} == {key: there["J3"][key] for key in ROW}
        (other,) = row["others"]
        assert {key: other[key] for key in (*ROW, "tie")} == {key: there["J1"][key] for key in (*ROW, "tie")}
    study = study_from(DOCUMENT)
    first, second = (
        study.design(name).with_values(values) for name, values in (("S1", {"c": c1}), ("S3", {"c": c, "b": b}))
    )
    two = it.compare(second, first, study.index("J3"), study.method(method))
    sentence = told["verdict"]["sentence"].removeprefix("Not certain: ")
    low, high = (two.first.value * (1.0 + sign * two.first.error_bound) for sign in (-1.0, 1.0))
    base_low, base_high = (two.second.value * (1.0 + sign * two.second.error_bound) for sign in (-1.0, 1.0))
    if (low <= base_high and base_low <= high) or abs(two.percent) < 0.05:  # nobody can tell which is better
        assert [row["rank"] for row in told["rows"]] == [1, 1]
        assert sentence.startswith("S3 is as good as S1")
        return
    assert [row["rank"] for row in told["rows"]] == [1, 2]
    assert all(one["value"] <= other["value"] for one, other in pairwise(told["rows"]))
    (size,) = re.findall(r"([\d.]+)\xa0%", sentence)
    assert abs(float(size) - abs(two.percent)) <= (0.05 if "." in size else 0.5) * (1.0 + 1e-9)
    best = told["rows"][0]["layout"]
    assert (two.percent < 0.0) == (best == "S3")
    assert sentence.startswith(f"S3 is {size}\xa0% better" if best == "S3" else "No strut is better")


@pytest.mark.parametrize("method", [BLIND, SEEING])
def test_a_study_of_the_designs_has_the_same_verdict(client: TestClient, method: str) -> None:
    """Sentence, severity and caveats of each index, as report, terminal and JSON have them."""
    values = {"S1": {"c": 1500.0}, "S3": {"c": 3000.0, "b": 60.0}}
    designs = [{"layout": name, "values": one} for name, one in values.items()]
    document = ask(client, "study/write", study=DOCUMENT, designs=designs)["study"]
    study = study_from({**document, "study": {**document["study"], "evaluate": [method]}})
    data = dataset(study, {case: run_case(study, case) for case in cases(study)})
    for index in ("J1", "J3"):
        told = ask(client, "panel/decision", study=DOCUMENT, values=values, methods=[method], index=index)
        verdict = study_decision(data, index, study).verdict
        assert sentences(told) == [
            printed_text(verdict.sentence),
            *(printed_text(one.sentence) for one in verdict.caveats),
        ]
        assert told["verdict"]["severity"] == verdict.answer
        assert verdict.sentence in " ".join(conclusion_sentences(data, study))


def test_a_method_that_models_friction_says_so_and_the_other_warns(client: TestClient) -> None:
    values = {"S1": {"c": 1500.0}, "S3": {"c": 3000.0, "b": 60.0}}
    blind, seeing = (
        ask(client, "panel/decision", study=DOCUMENT, values=values, methods=[method]) for method in (BLIND, SEEING)
    )
    assert "Friction f of S3 is neglected by exact norms; expected-value models it." in sentences(blind)
    assert "neglected" not in " ".join(sentences(seeing))
    several = ask(client, "panel/decision", study=DOCUMENT, values=values, methods=[BLIND, SEEING])
    assert {**several, "sequence": 0} == {**seeing, "sequence": 0}


def test_values_that_nobody_has_chosen_are_not_ranked(client: TestClient) -> None:
    """Without a percentage, and without the order of the middles of their bounds."""
    told = ask(client, "panel/decision", study=DOCUMENT)
    assert [(row["layout"], row["rank"], row["improvement_percent"]) for row in told["rows"]] == [
        ("S1", None, None),
        ("S3", None, None),
    ]
    assert told["verdict"]["severity"] == "none"
    assert sentences(told)[0].startswith("No value of S1 and S3 has been chosen yet")
    one = ask(client, "panel/decision", study=DOCUMENT, values={"S1": {"c": 1500.0}})
    assert sentences(one)[0].startswith("No value of c and b of S3 has been chosen yet")
    assert "%" not in " ".join(sentences(one))


@pytest.mark.parametrize("stiffness", [2e4, 9e4])
def test_a_design_that_breaks_a_limit_is_not_the_best(client: TestClient, stiffness: float) -> None:
    document = example_tables("limits")
    values = {"S1": {"k": 70e3, "c": 3e3}, "S3": {"k": stiffness, "c": 3e3, "b": 500.0}}
    told = ask(client, "panel/decision", study=document, values=values, index="comfort")
    rows = {row["layout"]: row for row in told["rows"]}
    kept = all(limit["kept"] for limit in rows["S3"]["limits"])
    assert kept == (stiffness > 60e3)
    assert (rows["S3"]["rank"] is None) == (not kept)
    text = " ".join(sentences(told))
    assert ("S3 breaks" in text and "static stiffness of strut at least 60\xa0kN/m (20\xa0kN/m)" in text) == (not kept)
    assert "r.m.s. suspension travel at most 8\xa0mm" in told["goal"]["sentence"]


def test_a_value_at_its_bound_is_told(client: TestClient) -> None:
    values = {"S1": {"c": 1500.0}, "S3": {"c": 3000.0, "b": "1000 kg"}}
    told = ask(client, "panel/decision", study=DOCUMENT, values=values)
    at_bound = "b of S3 is at its upper bound (1000 kg); beyond it the design may be better."
    assert (at_bound in sentences(told)) == (told["rows"][0]["layout"] == "S3")


@pytest.mark.parametrize(("roughness", "lifts"), [("5e-7 m^3/cycle", False), ("4e-6 m^3/cycle", True)])
def test_a_tyre_that_leaves_the_road_is_told_first(client: TestClient, roughness: str, lifts: bool) -> None:
    document = {**DOCUMENT, "road": {**DOCUMENT["road"], "roughness": roughness}}
    values = {"S1": {"c": 1500.0}, "S3": {"c": 3000.0, "b": 60.0}}
    first = ask(client, "panel/decision", study=document, values=values)["verdict"]["caveats"][:1]
    assert any("a tyre leaves the road at times" in one["sentence"] for one in first) == lifts
    assert not any("leaves the road" in one for one in sentences(ask(client, "panel/decision", study=document)))


def test_a_baseline_that_is_not_among_the_designs_is_ranked_too(client: TestClient) -> None:
    designs = [{"layout": "S3", "values": {"c": 3000.0, "b": 60.0}}]
    baseline = {"layout": "S1", "values": {"c": 1500.0}, "name": "kept"}
    told = ask(client, "panel/decision", study=DOCUMENT, designs=designs, baseline=baseline)
    assert {row["name"]: row["is_baseline"] for row in told["rows"]} == {"S3": False, "kept": True}
    assert "kept" in sentences(told)[0]


def test_a_layout_like_the_baseline_is_another_one(client: TestClient) -> None:
    """Such as one that was just added to be changed: equal to it, and compared with it."""
    values = {"S1": {"c": 1500.0}, "S4": {"c": 1500.0}}
    told = ask(client, "panel/decision", study={**DOCUMENT, "layouts": {"S1": "k | c", "S4": "k | c"}}, values=values)
    assert [(row["layout"], row["is_baseline"]) for row in told["rows"]] == [("S1", True), ("S4", False)]
    assert "S4" in sentences(told)[0]


def test_a_value_that_is_not_certain_is_not_an_answer(client: TestClient) -> None:
    """Linearisation of friction that sticks for much of the time is told to be inaccurate, in the verdict too."""
    document = changed(elements={"f": "100 N"})
    values = {"S1": {"c": 1500.0}, "S3": {"c": 3000.0, "b": 60.0}}
    told = ask(client, "panel/decision", study=document, values=values, methods=[SEEING], index="J1")
    row = next(row for row in told["rows"] if row["layout"] == "S3")
    assert row["status"] == "inaccurate"
    assert told["verdict"]["severity"] == "doubt"
    assert any("Ride comfort (J1) of S3 is unreliable (inaccurate" in text for text in sentences(told))


@pytest.mark.parametrize("name", ["quarter-car", "absorber", "conditions", "half-car", "seat", "tolerances"])
def test_every_example_has_a_verdict(name: str) -> None:
    """At the middles of the bounds taken as chosen: words without missing numbers."""
    document = example_tables(name)
    body = {"study": document, "methods": ["norm"]}
    middle = {d["layout"]: {k: v["text"] for k, v in d["values"].items()} for d in _indices(body)}
    told = answer_panel("decision", {**body, "values": middle})
    assert told["verdict"]["severity"] in ("answer", "doubt")
    for text in [told["goal"]["sentence"], *sentences(told)]:
        assert text.endswith(".")
        assert not {"nan", "None", "n/a", "inf"} & set(text.replace(",", " ").split())


@pytest.mark.parametrize("share", [1.0, 3.0])
def test_a_design_that_is_worse_in_a_condition_is_said_to_be(client: TestClient, share: float) -> None:
    """Better over both of two conditions; improvements in each are those of a document with its numbers alone."""
    laden = {"name": "laden", "vehicle.sprung_mass": "800 kg", "vehicle.pitch_inertia": "520 kg m^2"}
    slowly = {**laden, "road.speed": "15 m/s"}
    parts = 'k = "40 kN/m"\nc = "1 kN s/m"\nc3 = "1.5 kN s/m"\nb = "140 kg"'
    text = study_text('indices = ["J1"]', vehicle=HALF_CAR, elements=parts, layouts='S1 = "k | c"\nS3 = "k | c3 - b"')
    plain = tomllib.loads(text.replace('model = "quarter-car"', "", 1))
    there = {**plain, "vehicle": {**plain["vehicle"], "sprung_mass": "800 kg", "pitch_inertia": "520 kg m^2"}}
    there["road"] = {**plain["road"], "speed": "15 m/s"}
    first, second = (_improvement(client, document) for document in (plain, there))
    assert second < -0.5 < 0.5 < first
    told = ask(client, "panel/decision", study={**plain, "conditions": [{"share": share}, slowly]}, index="J1")
    best, base = told["rows"]
    assert (best["layout"], base["layout"]) == ("S3", "S1")
    assert [(one["name"], one["share"]) for one in best["in_conditions"]] == [
        ("1", share / (share + 1.0)),
        ("laden", 1.0 / (share + 1.0)),
    ]
    assert [one["improvement_percent"] for one in best["in_conditions"]] == pytest.approx([first, second])
    assert [one["improvement_percent"] for one in base["in_conditions"]] == [None, None]
    for row in told["rows"]:
        each = [(one["share"], one["value"]) for one in row["in_conditions"]]
        assert sum(part * value for part, value in each) == pytest.approx(row["value"])
    assert printed_text(f"S3 is {-second:.1f} % worse than S1 in condition laden.") in sentences(told)
    assert not [text for text in sentences(told) if "in condition 1" in text]


@pytest.mark.parametrize(("damping", "is_equal"), [(1500.0, True), (1502.0, True), (1505.0, False)])
def test_what_the_verdict_calls_as_good_is_called_so_everywhere(
    client: TestClient, damping: float, is_equal: bool
) -> None:
    """A difference that rounds to 0.0 % too, in the ranking and side by side."""
    body = {"study": {**DOCUMENT, "layouts": {"S1": "k | c", "S2": "k | c"}}, "layouts": ["S1", "S2"]}
    body["values"] = {"S1": {"c": 1500.0}, "S2": {"c": damping}}
    told = ask(client, "panel/decision", **body)
    row = next(one for one in told["rows"] if one["layout"] == "S2")
    assert abs(row["improvement_percent"]) < 0.1
    assert ("S2 is as good as S1" in sentences(told)[0]) == is_equal
    assert row["tie"] == is_equal
    first, second = (one["results"][0] for one in ask(client, "panel/compare", **body)["designs"])
    assert (first["best"], second["best"], second["tie"]) == (True, is_equal, is_equal)


def _improvement(client: TestClient, document: dict[str, Any]) -> float:
    rows = ask(client, "panel/decision", study=document, index="J1")["rows"]
    return float(next(row["improvement_percent"] for row in rows if row["layout"] == "S3"))


def _indices(body: dict[str, Any]) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = answer_panel("indices", body)["designs"]
    return found


def test_the_digest_of_a_problem_is_that_of_its_optimum_until_the_problem_is_another_one(client: TestClient) -> None:
    """Whether by the panel or a job; the names of elements and layouts, titles and other layouts change nothing."""
    elements = {**DOCUMENT["elements"], "b": "100 kg"}
    light = {**DOCUMENT, "elements": elements}

    def other(**tables: Any) -> Any:
        """The document with other entries of its tables."""
        return {**light, **{name: {**light[name], **table} for name, table in tables.items()}}

    def digests(document: Any, index: str = "J1") -> list[str]:
        rows = ask(client, "panel/decision", study=document, index=index)["rows"]
        return [row["problem_digest"] for row in sorted(rows, key=lambda row: row["layout"])]

    first, third = digests(light)
    assert len({first, third, *digests(light, "J3")}) == 4
    body = {"study": light, "layouts": ["S1"], "indices": ["J1"]}
    (panel,) = ask(client, "panel/optimise", **body)["designs"]
    assert panel["problem_digests"] == [first]
    assert digests({**other(study={"baseline": "S3"}), "title": "Another"}) == [first, third]
    lighter = digests(other(elements={"b": "90 kg"}))
    assert lighter[0] == first
    assert lighter[1] != third
    renamed = ask(client, "study/rename", study=light, names={"c": "damper", "k": "parts"})["study"]
    assert digests(renamed) == [first, third]
    several = (
        other(vehicle={"sprung_mass": "300 kg"}),
        other(road={"speed": "20 m/s"}),
        other(elements={"c": {"from": "1 kN s/m", "to": "100 kN s/m"}}),
        other(layouts={"S1": "c"}),
        other(study={"subject_to": {"J3": {"at_most": "1 kN"}}}),
    )
    assert len({first, *(digests(document)[0] for document in several)}) == 6
    assert digests(other(elements={"c": "2 kN s/m", "b": DOCUMENT["elements"]["b"]}))[0] == ""  # nothing may vary


@pytest.mark.campaign
def test_designs_of_sweeps_and_fronts_solve_the_problems_of_their_studies(client: TestClient) -> None:
    elements = {"k": "20 kN/m", "c": DOCUMENT["elements"]["c"]}
    study = {**DOCUMENT, "elements": elements, "layouts": {"S1": "k | c"}}

    def digest(document: Any, index: str) -> str:
        return str(ask(client, "panel/decision", study=document, index=index)["rows"][0]["problem_digest"])

    def result(**body: Any) -> Any:
        number = ask(client, "work", study=study, **body)["id"]
        until(client, number, "done")
        return client.get(f"/api/work/{number}/result").json()

    swept = result(kind="sweep", sweep={"k": {"from": "10 kN/m", "to": "40 kN/m", "points": 2}}, indices=["J3"])
    there = [{**study, "elements": {**elements, "k": f"{k} kN/m"}} for k in (10, 40)]
    assert [row["problem_digests"] for row in swept["designs"]] == [[digest(one, "J3")] for one in there]
    (front,) = result(kind="front", indices=["J1", "J3"], points=3)["fronts"]
    assert front["problem_digests"] == [digest(study, "J1"), digest(study, "J3")]
