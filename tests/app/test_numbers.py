"""The numbers of the page are those of the command line and of Python, to the last digit."""

from __future__ import annotations

import csv
import io
import json
import re
import tomllib
from dataclasses import asdict, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from app.conftest import DOCUMENT, ask, changed
from campaigns import sampled
from combinations import CARS
from folders import EXAMPLES, example_tables
from hypothesis import given, settings
from hypothesis import strategies as st
from starlette.testclient import TestClient
from study_text import load_text, study_text

import inerter as it
from inerter.app import answers
from inerter.app.answers import answer_panel
from inerter.app.designs import designs_of
from inerter.app.documents import study_from
from inerter.app.fixed_designs import with_fixed_values
from inerter.app.fronts import _change
from inerter.figures.simulation import draw_simulation
from inerter.files.common.toml import as_toml
from inerter.files.simulation.loading import load_simulation
from inerter.files.simulation.running import run_simulation
from inerter.files.study.cases import cases, run_case
from inerter.files.study.parts import run_part
from inerter.files.study.results import dataset
from inerter.formatting import printed_text
from inerter.report.conclusions import conclusion_sentences
from inerter.report.speeds import speed_sentences
from inerter.report.study_data import as_text
from inerter.tasks.budgets import Budgets


def run(document: dict[str, Any], folder: Path) -> Any:
    """What `inerter run --json` prints of the file that the document is."""
    path = folder / "study.toml"
    path.write_text(as_toml(document), encoding="utf-8")
    result = it.run_study(it.load_study(path), folder / "results")
    return json.loads("".join(as_text(result))), result


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """What the command line makes of the document."""
    return run(DOCUMENT, tmp_path_factory.mktemp("ran"))


def without_digests(result: dict[str, Any]) -> dict[str, Any]:
    """Results without title and without what a page keeps of the problem that each design solves."""
    own = ("problem_digests", "texts")
    designs = [{key: value for key, value in one.items() if key not in own} for one in result["designs"]]
    assert all(one["problem_digests"] for one in result["designs"])
    for one in result["designs"]:
        assert {name: float(text.partition(" ")[0]) for name, text in one["texts"].items()} == one["parameters"]
    return {**result, "title": "", "designs": designs}


@pytest.mark.campaign
def test_a_run_is_that_of_the_command_line(client: TestClient, ran: Any) -> None:
    told = ask(client, "work", kind="run", study=DOCUMENT, wait=30)
    expected, result = ran
    assert told["state"] == "done"
    assert without_digests(told["result"]) == {**expected, "title": ""}
    files = {row["name"]: row["size"] for row in client.get(f"/api/work/{told['id']}/files").json()["files"]}
    assert {"report.html", "summary.csv", "results.nc", "study.resolved.toml"} <= set(files)
    for name in ("summary.csv", "study.resolved.toml"):
        assert client.get(f"/api/work/{told['id']}/files/{name}").content == (result.folder / name).read_bytes()


@pytest.mark.marathon
def test_a_sweep_is_that_of_the_command_line(client: TestClient, tmp_path: Path) -> None:
    sweep = {"k": {"from": "10 kN/m", "to": "30 kN/m", "points": 3}}
    told = ask(client, "work", kind="sweep", study=DOCUMENT, sweep=sweep, indices=["J1"], wait=30)
    expected, _ = run(changed(study={"sweep": sweep, "indices": ["J1"]}), tmp_path)
    result = without_digests(told["result"])
    (swept,), (known,) = result.pop("swept"), expected.pop("swept")
    assert (swept["name"], swept["unit"]) == (known["name"], known["unit"]) == ("k", "N/m")
    assert swept["own"] == 20e3  # as the study has it
    assert result.pop("units") == {"b": "kg", "c": "N s/m"}
    assert result == {**expected, "title": ""}


def test_optima_are_those_of_a_run(client: TestClient, ran: Any) -> None:
    """The panel, the work, and the texts of their values: all are the design that a run finds."""
    expected, _ = ran
    wanted = {(d["layout"], d["index"]): d for d in expected["designs"]}
    panel = ask(client, "panel/optimise", study=DOCUMENT)["designs"]
    work = ask(client, "work", kind="optimise", study=DOCUMENT, wait=30)["result"]["designs"]
    assert panel == work
    for found in panel:
        case = wanted[found["layout"], found["index"]]
        assert found["values"]["norm"][found["index"]] == case["value"]
        assert found["parameters"] == case["parameters"]
        assert {n: float(t.split()[0]) for n, t in found["texts"].items()} == case["parameters"]
    values = {d["layout"]: d["texts"] for d in panel if d["index"] == "J1"}
    answer = ask(client, "panel/indices", study=DOCUMENT, values=values, indices=["J1"])
    for design in answer["designs"]:
        (result,), case = design["results"], wanted[design["layout"], "J1"]
        assert (result["value"], result["improvement_percent"]) == (case["value"], case["improvement_percent"])


def test_what_takes_longer_than_a_person_waits_is_not_optimised(client: TestClient) -> None:
    """Of a small vehicle the optima are those without the wish; a free network is left out."""
    small = ask(client, "panel/optimise", study=DOCUMENT, indices=["J1"])
    assert ask(client, "panel/optimise", study=DOCUMENT, indices=["J1"], while_waiting=True) == small
    large = tomllib.loads((EXAMPLES / "full-car.toml").read_text())
    assert ask(client, "panel/optimise", study=large, while_waiting=True)["designs"] is None
    settings = {key: value for key, value in DOCUMENT["study"].items() if key != "optimise"}
    fixed = {**changed(elements={"c": "1 kN s/m", "b": "30 kg"}), "study": settings}
    assert ask(client, "panel/optimise", study=fixed, while_waiting=True)["designs"] == []
    searched = tomllib.loads((EXAMPLES / "search_quarter_car.toml").read_text())
    asked = {"study": searched, "layouts": list(searched["layouts"]), "indices": ["J1"], "while_waiting": True}
    told = ask(client, "panel/optimise", **asked)
    assert {design["layout"] for design in told["designs"]} == {"S1", "S3"}
    assert [one["layout"] for one in told["left_out"]] == ["any"]


@pytest.mark.parametrize("layouts", [["S1", "S3"], ["S3"]], ids=["both", "one"])
def test_an_optimum_tells_what_it_becomes_at_other_speeds_as_a_run_does(
    client: TestClient, tmp_path: Path, layouts: list[str]
) -> None:
    """In the panel and in work, by the sentences of the report of the command line."""
    text = study_text(
        f'indices = ["J1"]\noptimise = "norm"\nbaseline = "{layouts[0]}"',
        vehicle="\n".join(f'{key} = "{value!r} {unit}"' for key, (value, unit) in CARS["half-car"].items()),
        elements='k = "25 kN/m"\nc = { from = "300 N s/m", to = "10 kN s/m" }\nb = "60 kg"',
        layouts="\n".join(f'{name} = "k | c{" - b | c" if name == "S3" else ""}"' for name in layouts),
    ).replace("quarter-car", "half-car")
    study = load_text(tmp_path, text)
    results = dataset(study, {case: run_case(study, case) for case in cases(study)})
    expected = {key: [*map(printed_text, told)] for key, told in asdict(speed_sentences(results)).items()}
    (sentence,) = expected["doubts"] + expected["others"]
    assert sentence.count("km/h") >= 3
    assert sentence in map(printed_text, conclusion_sentences(results, study))
    document = tomllib.loads(text)
    panel = ask(client, "panel/optimise", study=document)
    work = ask(client, "work", kind="optimise", study=document, wait=30)["result"]
    assert panel["at_speeds"] == work["at_speeds"] == expected


@settings(max_examples=2)
@given(c=st.floats(200.0, 9e4), b=st.floats(2.0, 900.0), c1=st.floats(200.0, 9e4))
def test_a_study_of_designs_gives_the_numbers_of_the_panel(
    client: TestClient, tmp_path_factory: pytest.TempPathFactory, c: float, b: float, c1: float
) -> None:
    """What is downloaded and run has the page's values, improvements and curves, whatever the sliders are at."""
    designs = [{"layout": "S1", "values": {"c": c1}}, {"layout": "S3", "values": {"c": c, "b": f"{b!r} kg"}}]
    panel = ask(client, "panel/indices", study=DOCUMENT, designs=designs)
    text = ask(client, "study/write", study=DOCUMENT, designs=designs)["text"]
    folder = tmp_path_factory.mktemp("run")
    (folder / "study.toml").write_text(text, encoding="utf-8")
    data = it.run_study(it.load_study(folder / "study.toml"), folder / "results").data
    for design in panel["designs"]:
        for row in design["results"]:
            there = data.sel({"layout": design["layout"], "index": row["index"], "method": "norm"})
            assert there.value.item() == row["value"]
            assert there.improvement.item() == row["improvement_percent"]
    curves = ask(client, "panel/response", study=DOCUMENT, designs=designs)
    assert curves["frequency"] == (data.omega.values / (2.0 * np.pi)).tolist()
    for curve in curves["curves"]:
        gains = data[f"gain_{curve['index']}"].sel(layout=curve["layout"])
        assert curve["gain"] in gains.values.tolist()


ASKED = ("conditions", "limits", "trade_off", "seat", "full-car", "quarter-car")


@pytest.mark.parametrize("name", sampled(ASKED, ["conditions"]))
def test_panels_ask_what_the_study_asks(name: str) -> None:
    """Over conditions, at quantiles, of any vehicle: a study of the very designs has the panel's numbers."""
    document = example_tables(name)
    study = study_from(document)
    designs = designs_of(study, {})
    values = {design.layout: design.values for design in designs}
    panel = answer_panel("indices", {"study": document, "methods": ["norm"], "values": values})
    made = with_fixed_values(document, study, designs)
    asked = study_from({**made, "study": {**made["study"], "evaluate": ["norm"]}})
    data = dataset(asked, {case: run_case(asked, case) for case in cases(asked)})
    for design in panel["designs"]:
        for row in design["results"]:
            there = data.sel({"layout": design["layout"], "index": row["index"], "method": "norm"})
            assert there.value.item() == row["value"]
            assert there.improvement.item() == row["improvement_percent"]


@pytest.mark.parametrize("method", sampled(["norm", "statistical-linearisation"], ["norm"]))
def test_limits_are_kept_or_broken(client: TestClient, method: str) -> None:
    """Of designs on either side of each limit, and of the best one, which lies on both."""
    document = example_tables("limits")
    study = study_from(document)
    best = client.post("/api/panel/optimise", json={"study": document, "layouts": ["S3"], "indices": ["comfort"]})
    optimum = best.json()["designs"][0]["parameters"]
    values = [optimum, *({**optimum, "k": k, "c": c} for k in (2e4, 9e4) for c in (300.0, 3e3, 3e4))]
    designs = [{"layout": "S3", "values": each} for each in values]
    body = {"study": document, "designs": designs, "methods": [method], "indices": ["tyre-load"]}
    told = [d["limits"] for d in ask(client, "panel/indices", **body)["designs"]]
    travel = [
        it.evaluate(study.design("S3").with_values(v), it.SuspensionTravel(study.road), it.Norm()) for v in values
    ]
    assert [one["value"] for one, _ in told] == pytest.approx([found.value for found in travel], rel=1e-9)
    assert [one["value"] for _, one in told] == pytest.approx([each["k"] for each in values], rel=1e-9)
    assert [one["kept"] for one, _ in told[1:]] == [found.value < 8e-3 for found in travel[1:]]
    assert [one["kept"] for _, one in told[1:]] == [each["k"] > 60e3 for each in values[1:]]
    assert {one["kept"] for one, _ in told[1:]} == {True, False}
    assert [one["kept"] for one in told[0]] == [True, True]
    for one in (limit for limits in told for limit in limits):
        kept = "kept" if one["kept"] else "broken"
        assert one["sentence"] == f"{kept}: {one['title']}; it is {one['text']}"


def test_a_limit_without_a_value_is_not_known(client: TestClient) -> None:
    """Of a strut that friction alone holds linear analysis cannot tell: its limits are neither kept nor broken."""
    document = example_tables("limits")
    document["elements"]["f"] = "20 N"
    document["layouts"] = {"S1": "k - f"}
    body = {"study": document, "methods": ["norm"], "indices": ["tyre-load"]}
    travel, stiffness = ask(client, "panel/indices", **body)["designs"][0]["limits"]
    assert (travel["value"], travel["kept"]) == (None, None)
    assert travel["sentence"].startswith(f"{travel['status']}: not known: {travel['title']} (")
    assert "friction" in travel["message"]
    assert (stiffness["value"], stiffness["kept"]) == (0.0, False)


def test_a_history_is_that_of_python(client: TestClient) -> None:
    body = {"study": DOCUMENT, "layout": "S3", "values": {"S3": {"c": 3000.0, "b": 50.0}}, "seed": 3, "duration": 0.5}
    told = ask(client, "panel/history", **body)
    study = study_from(DOCUMENT)
    car = study.design("S3").with_values({"c": 3000.0, "b": 50.0})
    motion = it.simulate(car, road=it.multisine(study.road, seed=3), duration=0.5, step=told["step"])
    for name, rms in told["rms"].items():
        assert rms == motion.rms(name)
    for signal in told["signals"]:
        at = dict(zip(motion.time.tolist(), motion[signal["name"]].tolist(), strict=True))
        assert [at[time] for time in signal["time"]] == signal["values"]
        assert max(map(abs, signal["values"])) == told["peaks"][signal["name"]]
    shaded = {(row["element"], row["state"]): row["intervals"] for row in told["shaded"]}
    assert shaded["f", "stick"] == [list(pair) for pair in motion.intervals("f", "stick")]
    covered = sum(end - begin for several in shaded.values() for begin, end in several)
    assert covered == pytest.approx(0.5, rel=1e-9)


def test_budgets_are_those_of_python(client: TestClient) -> None:
    designs = [
        {"layout": "S1", "values": {"c": 1500.0}},
        {"layout": "S3", "values": {"c": 3000.0, "b": 60.0}, "name": "mine"},
    ]
    method = "statistical-linearisation"
    body = {
        "study": DOCUMENT,
        "design": designs[1],
        "baseline": designs[0],
        "index": "J1",
        "parameter": "f",
        "method": method,
    }
    told = ask(client, "panel/budget", **body)
    study = study_from(DOCUMENT)
    first, second = (
        study.design(d["layout"]).with_values({k: float(v) for k, v in d["values"].items()}) for d in designs
    )  # type: ignore[attr-defined]
    found = it.break_even(second, first, study.index("J1"), parameter="f", method=it.StatisticalLinearisation())
    assert (told["value"], told["status"]) == (None if np.isnan(found.value) else found.value, found.status.kind.value)
    assert told["sentence"].startswith("friction 'f' in 'strut' sticks for a part of the time")  # and so has none
    doubtful = replace(found, value=12.0, status=it.Status(it.StatusKind.INACCURATE, "friction is large."))
    known = replace(doubtful, status=it.Status())
    sentences = [answers._break_even_sentence(one, "S3", "S1") for one in (doubtful, known)]
    assert re.fullmatch(r"Unreliable: inaccurate: friction is large\. At f = 12 N, .*", sentences[0])
    assert sentences[1] == "At f = 12 N, S3 is as good as S1."
    simulated = answers._break_even_sentence(replace(known, standard_error=0.5), "S3", "S1")
    assert simulated == "At f = 12.00 +- 0.50 N, S3 is as good as S1."
    none = replace(doubtful, value=np.nan)
    assert answers._break_even_sentence(none, "S3", "S1") == "friction is large."


@pytest.mark.parametrize("parameter", sampled(["f", "k"], ["f"]))
def test_break_even_values_of_the_page_are_those_of_a_study(client: TestClient, parameter: str) -> None:
    """Over the same bounds, and of the index itself where the study minimises a quantile."""
    asked = {"indices": ["J1"], "budgets": [parameter], "baseline": "S1", "evaluate": ["statistical-linearisation"]}
    document = changed(elements={"c": "3 kN s/m", "b": "60 kg"})
    document["study"] = {**asked, "tolerance": {"k": "10 %"}, "quantile": 0.95}
    study = study_from(document)
    outcomes = {case: run_case(study, case) for case in cases(study)}
    (part,) = [part for part in Budgets().parts(study) if part.layout == "S3"]
    found = run_part(study, outcomes, part)
    body = {"study": document, "layout": "S3", "index": "J1", "parameter": parameter, "method": found.method}
    told = client.post("/api/panel/budget", json=body).json()
    assert (told["value"], told["status"]) == (found.value, found.status)
    assert found.status != "failed"


def _car(document: dict[str, Any], design: dict[str, Any]) -> Any:
    """The vehicle of a design that has a value for all that is free."""
    values = {name: float(value) for name, value in design["values"].items()}
    return study_from(design.get("study", document)).design(design["layout"]).with_values(values)


COMPARED: list[dict[str, Any]] = [
    {"layout": "S3", "values": {"c": 3000.0, "b": 60.0}, "name": "mine"},
    {"layout": "S1", "values": {"c": 1500.0}},
    {"layout": "S3", "values": {"c": 3000.0, "b": 60.0}, "name": "the same"},
    {"layout": "S1", "values": {"c": 1500.0}, "name": "softer", "study": changed(elements={"k": "15 kN/m"})},
]


@pytest.mark.parametrize(
    ("count", "method"), sampled(product([2, 3, 4], ["norm", "expected-value"]), [(2, "norm")], kept=3)
)
def test_comparisons_are_those_of_python(client: TestClient, count: int, method: str) -> None:
    """Each beside the first on the same roads, also one of another study; a tie is told as one."""
    document = changed(study={"evaluate": ["norm", "expected-value"], "realisations": 4}, elements={"f": "100 N"})
    body = {"study": document, "designs": COMPARED[:count], "indices": ["J1"], "methods": [method]}
    answer = client.post("/api/panel/compare", json=body)
    assert answer.status_code == 200, answer.text
    told = answer.json()["designs"]
    assert [design["name"] for design in told] == ["mine", "S1", "the same", "softer"][:count]
    cars = [_car(document, design) for design in COMPARED[:count]]
    asked = study_from(document)
    ways = asked.index("J1"), asked.method(method)
    for car, design in zip(cars, told, strict=True):
        two, (result,) = it.compare(car, cars[0], *ways), design["results"]
        assert result["value"] == it.evaluate(car, *ways).value
        assert result["improvement_percent"] == pytest.approx(-two.percent, rel=1e-12, abs=1e-12)
        assert result["improvement_error_percent"] == (None if method == "norm" else two.percent_error)
        assert result["tie"] == (design["name"] in ("mine", "the same"))
    values = [design["results"][0]["value"] for design in told]
    assert [design["results"][0]["best"] for design in told] == [value == min(values) for value in values]
    work = ask(client, "work", kind="compare", **body, wait=30)
    assert (work["state"], work["result"]["designs"]) == ("done", told)


def test_a_design_of_another_study_is_judged_on_the_road_of_this_one(client: TestClient) -> None:
    other = {**COMPARED[3], "study": changed(road={"speed": "50 m/s"}, vehicle={"unsprung_mass": "70 kg"})}
    body = {"study": DOCUMENT, "designs": [COMPARED[1], other], "indices": ["J3"]}
    told = ask(client, "panel/compare", **body)["designs"][1]["results"][0]
    heavy = it.evaluate(_car(DOCUMENT, other), study_from(DOCUMENT).index("J3"), it.Norm())
    assert told["value"] == heavy.value
    refused = client.post("/api/panel/response", json=body)
    assert refused.status_code == 400
    assert "a design of another study" in refused.json()["sentence"]


def test_a_point_of_a_front_is_compared_with_the_knee_that_it_could_be(client: TestClient) -> None:
    """With that of its own front; the knee itself with that of the baseline, which has no other."""
    body = {"kind": "front", "study": DOCUMENT, "points": 4, "wait": 30}
    fronts = {front["layout"]: front for front in ask(client, "work", **body)["result"]["fronts"]}
    for layout, front in fronts.items():
        for i, point in enumerate(front["points"]):
            told = point["reference"]
            of = fronts["S1" if i == front["knee"] else layout]
            if (layout, i) == ("S1", of["knee"]):
                assert told is None
                continue
            assert (told["layout"], told["point"]) == (of["layout"], of["knee"])
            assert told["sentence"].startswith(f"Relative to {of['layout']} at its knee: ")
            knee = of["points"][of["knee"]]["values"]
            for index, value in point["values"].items():
                change = 100.0 * (value / knee[index] - 1.0)
                (share, way) = re.search(rf"([0-9.]+)\xa0% (lower|higher) {index}", told["sentence"]).groups()
                assert float(share) == pytest.approx(abs(change), rel=0.06)
                assert way == ("lower" if change < 0.0 else "higher")


@pytest.mark.parametrize(
    ("value", "other", "told"),
    [
        (1.2, 1.0, "20 % higher J1"),
        (0.9991, 1.0, "0.09 % lower J1"),
        (1.00001, 1.0, "equal J1"),
        (float("nan"), 1.0, "J1 is not comparable"),
        (float("inf"), 1.0, "J1 is not comparable"),
        (1.0, 0.0, "J1 is not comparable"),
    ],
)
def test_a_difference_of_an_index_is_told_in_words(value: float, other: float, told: str) -> None:
    assert _change("J1", value, other) == told


def test_fronts_are_those_of_python_and_their_points_designs(client: TestClient) -> None:
    body = {"kind": "front", "study": DOCUMENT, "layouts": ["S3"], "points": 4, "wait": 30}
    work = ask(client, "work", **body)
    told, study = work["result"], study_from(DOCUMENT)
    found = it.pareto_front(study.design("S3"), [study.index("J1"), study.index("J3")], it.Norm(), points=4, seed=0)
    (front,) = told["fronts"]
    assert [list(point["values"].values()) for point in front["points"]] == found.values.tolist()
    assert front["knee"] == found.knee
    assert [point["reference"] and point["reference"]["point"] for point in front["points"]] == [
        None if i == found.knee else found.knee for i in range(4)
    ]
    table = client.get(f"/api/work/{work['id']}/files/fronts.csv").text
    rows = [[row["J1 [m/s^2]"], row["J3 [N]"]] for row in csv.DictReader(io.StringIO(table))]
    assert [[float(value) for value in row] for row in rows] == found.values.tolist()
    point = front["points"][front["knee"]]
    answer = client.post(
        "/api/panel/indices", json={"study": DOCUMENT, "layouts": ["S3"], "values": {"S3": point["texts"]}}
    )
    values = {row["index"]: row["value"] for row in answer.json()["designs"][0]["results"]}
    assert values == pytest.approx(point["values"], rel=1e-9)  # the search values by kernels, a design by itself


@pytest.mark.parametrize("panel", ["indices", "compare"])
@pytest.mark.parametrize("left_out", [("S1", "c"), ("S3", "b")])
def test_a_design_that_nobody_has_chosen_is_no_answer(
    client: TestClient, panel: str, left_out: tuple[str, str]
) -> None:
    """Values in the middle of their bounds: no per cent and no best, neither of it nor beside it."""
    values = {"S1": {"c": 1500.0}, "S3": {"c": 3000.0, "b": 60.0}}
    for layout, missing in ((None, None), left_out):
        designs = [
            {"layout": name, "values": {k: v for k, v in own.items() if (name, k) != (layout, missing)}}
            for name, own in values.items()
        ]
        told = ask(client, f"panel/{panel}", study=DOCUMENT, designs=designs)["designs"]
        assert [design["unchosen"] for design in told] == [[missing] if d["layout"] == layout else [] for d in told]
        base = {"indices": "S1", "compare": told[0]["layout"]}[panel]
        touched = {layout, *(values if layout == base else ())} if layout else set()
        for design in told:
            assert all((r["improvement_percent"] is None) == (design["layout"] in touched) for r in design["results"])
            assert all(r["value"] > 0.0 for r in design["results"])
        if panel == "compare":
            assert any(r["best"] for d in told for r in d["results"]) == (layout is None)


def test_a_comparison_is_no_better_than_the_worst_of_it(client: TestClient) -> None:
    """Of friction that sticks for a part of the time, by statistical linearisation: no best, and doubtful per cents."""
    document = changed(elements={"f": "300 N"}, study={"evaluate": ["norm", "statistical-linearisation"]})
    body = {"study": document, "designs": COMPARED[:2], "methods": ["statistical-linearisation"]}
    told = ask(client, "panel/compare", **body)["designs"]
    statuses = [[result["status"] for result in design["results"]] for design in told]
    assert "inaccurate" in statuses[0]
    for row, result in enumerate(told[1]["results"]):
        worst = "ok" if statuses[0][row] == statuses[1][row] == "ok" else "inaccurate"
        assert result["improvement_status"] == worst
        assert any(design["results"][row]["best"] for design in told) == (worst == "ok")


@pytest.mark.parametrize(
    ("asked", "method"),
    [
        ({}, "norm"),
        ({"methods": ["expected-value"]}, "norm"),
        ({"methods": ["expected-value", "statistical-linearisation"]}, "statistical-linearisation"),
        ({"methods": ["statistical-linearisation"], "method": "norm"}, "norm"),
    ],
    ids=str,
)
def test_a_tolerance_is_by_the_method_that_judges_unless_it_averages(
    client: TestClient, asked: dict[str, Any], method: str
) -> None:
    design = {"layout": "S3", "values": {"c": 3000.0, "b": 60.0}}
    body = {"study": DOCUMENT, "design": design, "index": "J1", "spread": {"c": 0.1}, "samples": 16}
    assert ask(client, "panel/tolerance", **body, **asked)["method"] == method


@pytest.mark.parametrize("method", it.METHODS)
def test_a_tolerance_judges_as_many_designs_as_a_wait_allows(method: str) -> None:
    most = 10_000 if method == "norm" else 2500
    for n_scattering in range(1, 200):
        samples = answers._affordable_samples(method, n_scattering)
        designs = samples * (2 + n_scattering)
        assert samples in (64, 128, 256, 512, 1024)
        assert designs <= most or samples == 64
        assert 2 * designs > most or samples == 1024


@pytest.mark.parametrize(
    ("methods", "method"),
    [(["norm"], "norm"), (["statistical-linearisation"], "statistical-linearisation")],
)
def test_a_break_even_value_is_by_the_method_that_judges_if_it_sees_friction(
    client: TestClient, methods: list[str], method: str
) -> None:
    values = {"S1": {"c": 3000.0}, "S3": {"c": 3000.0, "b": 60.0}}
    body = {"layout": "S3", "values": values, "index": "J1", "parameter": "k", "methods": methods}
    assert ask(client, "panel/budget", study=DOCUMENT, **body)["method"] == method
    document = changed(study={"evaluate": ["norm", "statistical-linearisation"]})
    assert ask(client, "panel/budget", study=document, **body)["method"] == "statistical-linearisation"


@pytest.mark.parametrize(("method", "spread", "doubt"), [("norm", "f", True), ("norm", "c", False)])
def test_scatter_that_a_method_does_not_see_is_told(client: TestClient, method: str, spread: str, doubt: bool) -> None:
    design = {"layout": "S3", "values": {"c": 3000.0, "b": 60.0}}
    body = {"study": DOCUMENT, "design": design, "index": "J1", "spread": {spread: 0.1}, "samples": 16}
    told = ask(client, "panel/tolerance", **body, method=method)
    assert (told["status"], spread in told["message"]) == (("failed", True) if doubt else ("ok", False))
    table = client.post("/api/export/csv", json={"panel": "tolerance", "request": {**body, "method": method}}).text
    assert list(csv.reader(io.StringIO(table)))[1][1].split(": ")[0] == told["status"]


def test_a_tolerance_is_that_of_python(client: TestClient) -> None:
    design, spread = {"layout": "S3", "values": {"c": 3000.0, "b": 60.0}}, {"c": 0.1, "b": 0.05}
    body = {"study": DOCUMENT, "design": design, "index": "J1", "spread": spread, "samples": 64}
    told = ask(client, "panel/tolerance", **body)
    study = study_from(DOCUMENT)
    car = study.design("S3").with_values({"c": 3000.0, "b": 60.0})
    found = it.tolerance_analysis(car, study.index("J1"), it.Norm(), spread=spread, samples=64, seed=0)
    assert (told["mean"], told["worst"], told["total"]) == (found.mean, found.worst, found.total_order)
    assert told["quantiles"]["0.95"] == found.quantile(0.95)
    assert told["standard_errors"]["0.95"] == found.quantile_estimate(0.95).standard_error
    assert told["standard_errors"]["mean"] == found.standard_errors["mean"]
    assert sum(told["histogram"]["counts"]) == found.values.size
    table = client.post("/api/export/csv", json={"panel": "tolerance", "request": body}).text
    rows = dict(list(csv.reader(io.StringIO(table)))[1:])
    assert (float(rows["mean"]), float(rows["quantile 0.95"])) == (found.mean, found.quantile(0.95))
    assert float(rows["variance from c, total effect"]) == found.total_order["c"]


def test_tables_read_back_as_the_same(client: TestClient) -> None:
    request = {"study": DOCUMENT, "layouts": ["S3"]}
    panel = ask(client, "panel/indices", **request)["designs"][0]
    rows = list(
        csv.DictReader(io.StringIO(client.post("/api/export/csv", json={"panel": "indices", "request": request}).text))
    )
    assert [float(row["value"]) for row in rows] == [result["value"] for result in panel["results"]]
    assert float(rows[0]["b [kg]"]) == panel["values"]["b"]["value"]
    curves = ask(client, "panel/response", **request)
    lines = client.post("/api/export/csv", json={"panel": "response", "request": request}).text.splitlines()
    numbers = [list(map(float, line.split(","))) for line in lines[1:]]
    assert [row[0] for row in numbers] == curves["frequency"]
    assert [row[1] for row in numbers] == curves["curves"][0]["gain"]


@pytest.mark.campaign
def test_a_device_is_identified_and_fits_into_a_study(client: TestClient, tmp_path: Path) -> None:
    record = it.VirtualRig(it.Inerter(113.0)).run(it.cosine(1e-3, 3.0), duration=2.0)
    it.write_record(record, tmp_path / "device.csv")
    sent = client.post(
        "/api/records", params={"name": "device.csv"}, content=(tmp_path / "device.csv").read_bytes()
    ).json()
    body = {"kind": "identify", "records": [sent["id"]], "model": "ideal", "wait": 30}
    told = ask(client, "work", **body)
    assert told["state"] == "done", told
    device = told["result"]["device"]
    document = {
        **DOCUMENT,
        "elements": {**DOCUMENT["elements"], **device["elements"]},
        "layouts": {**DOCUMENT["layouts"], "mine": f"k | c - ({device['layouts']['device']})"},
    }
    assert ask(client, "study/check", study=document)["problems"] == []
    client.delete(f"/api/records/{sent['id']}")


@pytest.mark.parametrize("kind", sampled(["networks", "improvement", "response-J1"], ["networks"]))
def test_pictures(client: TestClient, kind: str) -> None:
    body = {"kind": kind, "study": DOCUMENT, "designs": [{"layout": "S1"}, {"layout": "S3"}]}
    assert client.post("/api/figure", json=body).content.startswith(b"<?xml")


@pytest.mark.parametrize("seed", sampled([0, 5], seldom=[5]))
def test_a_picture_of_the_motion_is_that_of_a_simulation_file(client: TestClient, tmp_path: Path, seed: int) -> None:
    """The file that says the same, drawn by the command line's functions; friction sticks in it."""
    document = {**changed(elements={"c": "3 kN s/m", "b": "60 kg", "f": "200 N"}), "study": {"indices": ["J1"]}}
    asked = {"signal": {"kind": "multisine", "seed": seed}, "simulation": {"layout": "S3", "duration": "2 s"}}
    asked["simulation"]["step"] = "0.5 ms"
    file = tmp_path / "motion.toml"
    file.write_text(as_toml({**{key: each for key, each in document.items() if key != "study"}, **asked}))
    found = run_simulation(load_simulation(file), tmp_path / "results")
    draw_simulation(found, tmp_path / "drawn")
    assert found.run.intervals("f", "stick")
    body = {"study": document, "kind": "history", "designs": [{"layout": "S3"}], "duration": 2.0, "seed": seed}
    for form in ("svg", "png"):
        answer = client.post("/api/figure", json={**body, "format": form})
        assert answer.content == (tmp_path / "drawn" / f"simulation.{form}").read_bytes()
    several = client.post("/api/figure", json={**body, "designs": [{"layout": "S1"}, {"layout": "S3"}]})
    assert (several.status_code, "single design" in several.json()["sentence"]) == (400, True)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_examples_answer(client: TestClient, path: Path) -> None:
    """Each example that is a study has indices, curves and a drawing of its car; others say what they are for.

    One with free networks is valid, and its search comes first.
    """
    told = ask(client, "study/read", text=path.read_text(encoding="utf-8"))
    body = {"study": told["study"], "methods": ["norm"]}
    to_search = any("network" in element for element in told["study"].get("elements", {}).values())
    assert to_search == path.stem.startswith("search_")
    for panel in ("indices", "response", "mechanism"):
        answer = client.post(f"/api/panel/{panel}", json=body)
        assert answer.status_code == (400 if told["problems"] or to_search else 200)
        assert not to_search or "search" in answer.json()["sentence"]
    if told["problems"]:
        assert any("inerter" in problem["sentence"] for problem in told["problems"])


@pytest.mark.parametrize("compiled", [True, False])
def test_a_process_is_asked_first_what_a_page_asks_first(monkeypatch: pytest.MonkeyPatch, compiled: bool) -> None:
    """It searches too where that needs no compiler; where it fails, nobody is told, and the first page waits."""
    asked: list[str] = []

    def recorded(key: str, body: Any) -> Any:
        answer = answer_panel(key, body)
        assert answer[{"decision": "rows", "response": "curves"}.get(key, "designs")]
        asked.append(key)
        return answer

    monkeypatch.setattr(answers, "answer_panel", recorded)
    monkeypatch.setattr(answers, "is_compiled", lambda method: compiled)
    answers.first()
    assert asked == ["decision", "response", *(["optimise"] if compiled else [])]
