"""Margins of a design: the library's numbers, by methods that model what they are asked about."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from app.conftest import DOCUMENT, ask, changed
from folders import example_tables
from starlette.testclient import TestClient
from study_text import load_text

import inerter as it
from inerter.app.documents import study_from
from inerter.cli.commands import run as run_command
from inerter.cli.options import WorkOptions
from inerter.files.common.toml import as_toml
from inerter.methods.registry import is_blind, refuses_gaps
from inerter.tasks.margins import (
    MarginRequest,
    _break_even,
    _break_even_by,
    _closes_on_inertia,
    _speeds,
    _trials,
    compliant_springs,
    margins,
    usual_tolerances,
)

VALUES = {"S1": {"c": 1500.0}, "S3": {"c": 3000.0, "b": 60.0}}
FEW = changed(study={"realisations": 2})
FEW["study"]["evaluate"] = ["expected-value"]


@pytest.fixture(scope="module")
def told(client: TestClient) -> dict[str, Any]:
    """Margins of S3, whose decision is that of the norm."""
    found: dict[str, Any] = ask(
        client, "panel/margins", study=FEW, values=VALUES, layout="S3", index="J1", methods=["norm"]
    )
    return found


def car(name: str) -> Any:
    return study_from(FEW).design(name).with_values(VALUES[name])


@pytest.mark.marathon
def test_break_even_values_are_by_methods_that_model_the_element(told: dict[str, Any]) -> None:
    """Friction of the design, and the shaft and backlash of a real inerter; none of them by a method blind to it."""
    by = {one["parameter"]: one for one in told["break_even"]}
    assert {name: one["is_present"] for name, one in by.items()} == {
        "f": True,
        "shaft_stiffness": False,
        "inerter_backlash": False,
    }
    assert not is_blind(by["f"]["method"])
    assert not is_blind(by["inerter_backlash"]["method"])
    assert not refuses_gaps(by["inerter_backlash"]["method"])
    for one in by.values():
        assert one["sentence"].endswith(".")
        words = one["parameter"] if one["is_present"] else one["sentence"].partition(" of ")[0]
        assert one["short"] == "" or one["short"].casefold().startswith(words.casefold())
        assert (one["value"] is None) <= (one["status"] != "ok")


@pytest.mark.marathon
def test_break_even_values_are_those_of_the_library(told: dict[str, Any]) -> None:
    by, study = {one["parameter"]: one for one in told["break_even"]}, study_from(FEW)
    method = study.method(by["f"]["method"])
    found = it.break_even(car("S3"), car("S1"), study.index("J1"), parameter="f", method=method)
    assert (by["f"]["value"], by["f"]["status"]) == (
        None if np.isnan(found.value) else found.value,
        found.status.kind.value,
    )
    b, k, c = it.Inerter(60.0, "b"), it.Spring(1e6, "k_shaft"), it.Damper(3200.0)
    real = it.QuarterCar(
        sprung_mass=250.0,
        unsprung_mass=35.0,
        tyre_stiffness=150e3,
        strut=it.Spring(20e3) | it.Damper(3000.0) - ((k | c) - b | it.Friction(20.0)),
    )
    shaft = it.break_even(real, car("S1"), study.index("J1"), parameter="k_shaft", method=it.Norm(), bounds=(1e3, 1e8))
    assert by["shaft_stiffness"]["method"] == "norm"
    value = by["shaft_stiffness"]["value"]
    assert (np.nan if value is None else value) == pytest.approx(shaft.value, rel=1e-9, nan_ok=True)


def test_elements_of_a_real_inerter_have_words_as_names() -> None:
    """A message on an element that the study lacks has the word for what it adds."""
    layouts = {"S1": "k | c", "S2": "k | c | b"}
    study = study_from({**DOCUMENT, "layouts": layouts})
    values = {"S1": {"c": 1500.0}, "S2": {"c": 1500.0, "b": 20.0}}
    design, baseline = (study.design(name).with_values(values[name]) for name in ("S2", "S1"))
    asked = MarginRequest(study, "S2", design, "S1", baseline, "J1", "norm")
    friction, stiffness, backlash = _trials(asked)
    told = _break_even(asked, stiffness)
    assert told.sentence == f"Stiffness of the shaft of inerter b: S2 is better than S1 {told.message[21:]}."
    assert told.message == "the design is better for no stiffness from 1 kN/m to 100 MN/m"
    labels = [one.parameter for one in (friction, stiffness, backlash)]
    assert labels == ["inerter_friction", "shaft_stiffness", "inerter_backlash"]
    gap = _break_even_by(asked, backlash, "norm")  # of which the value is half of the backlash
    assert gap.sentence == f"Backlash of inerter b: S2 is better than S1 {gap.message[21:]} to each side."


def test_an_element_with_the_name_of_its_kind_is_named_once() -> None:
    elements = {**DOCUMENT["elements"], "gap": "0.1 mm", "f": "30 N"}
    study = study_from({**DOCUMENT, "elements": elements, "layouts": {"S1": "k | c", "S2": "k | c - (b | f) - gap"}})
    values = {"S1": {"c": 1500.0}, "S2": {"c": 1500.0, "b": 20.0}}
    design, baseline = (study.design(name).with_values(values[name]) for name in ("S2", "S1"))
    found = {
        one.parameter: one.words for one in _trials(MarginRequest(study, "S2", design, "S1", baseline, "J1", "norm"))
    }
    assert (found["gap"], found["f"]) == ("gap", "friction f")


def test_backlash_between_two_masses_has_no_break_even_value_which_is_no_failure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An inerter between body and wheel, without a shaft: simulation refuses a gap there, which closes by impacts."""
    study = study_from({**DOCUMENT, "layouts": {"S1": "k | c", "S2": "k | c | b"}})
    values = {"S1": {"c": 1500.0}, "S2": {"c": 1500.0, "b": 20.0}}
    design, baseline = (study.design(name).with_values(values[name]) for name in ("S2", "S1"))
    real = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(20e3) | it.Damper(1500.0) | it.Gap(1e-4) - it.Inerter(20.0))
    with pytest.raises(it.errors.MechanismError, match=r"inertia .* on both sides"):
        it.simulate(real, road=it.cosine(1e-3, 1.0), duration=0.1)
    asked = MarginRequest(study, "S2", design, "S1", baseline, "J1", "norm")
    friction, stiffness, backlash = _trials(asked)
    assert [_closes_on_inertia(trial) for trial in (friction, stiffness, backlash)] == [False, False, True]
    monkeypatch.setattr("inerter.tasks.margins._trials", lambda asked: [stiffness, backlash])
    told = margins(asked)
    assert [one.parameter for one in told.break_even] == ["shaft_stiffness"]
    (why,) = [one for one in told.caveats if one.sentence.startswith("Backlash of inerter b has no break-even value")]
    assert why.severity == "info"
    assert "Put the spring of the shaft in series" in why.sentence


def test_break_even_values_in_each_condition_are_those_of_its_car_alone() -> None:
    """The stiffness of the shaft, of cars that are built with the mass and the speed of each condition."""
    study = study_from(example_tables("conditions"))
    values = {"S1": {"c": 1346.3}, "S3": {"c": 1497.8, "b": 314.93}}
    design, baseline = (study.design(name).with_values(values[name]) for name in ("S3", "S1"))
    asked = MarginRequest(study, "S3", design, "S1", baseline, "J3", "norm")
    stiffness = next(trial for trial in _trials(asked) if trial.parameter == "shaft_stiffness")
    told = _break_even(asked, stiffness)
    k, b, shaft = it.Spring(30e3), it.Inerter(314.93), it.Spring(1e6, "own") | it.Damper(3200.0)
    alone = {}
    for name, mass, speed in (("empty", 180.0, 15.0), ("loaded", 320.0, 30.0)):
        real, plain = (
            it.QuarterCar(mass, 35.0, 150e3, strut)
            for strut in (k | it.Damper(1497.8) - (shaft - b), k | it.Damper(1346.3))
        )
        load = it.TyreLoad(it.Road(5e-7, speed))
        found = it.break_even(real, plain, load, parameter="own", method=it.Norm(), bounds=(1e3, 1e8))
        alone[name] = found.value
    assert {one.name: one.value for one in told.in_conditions} == pytest.approx(alone, rel=1e-9)
    assert len({f"{value:.3g}" for value in alone.values()}) == 2  # the conditions differ
    for one in told.in_conditions:
        assert f"; in condition {one.name} above" in told.sentence


def test_the_friction_of_an_inerter_is_not_that_of_the_baseline() -> None:
    """The baseline keeps its friction while that of the inerter varies, which has a name of its own in the library."""
    elements = {**DOCUMENT["elements"], "f": "300 N"}
    study = study_from({**DOCUMENT, "elements": elements, "layouts": {"S1": "k | c | f", "S2": "k | c | b"}})
    design = study.design("S2").with_values({"c": 1500.0, "b": 10.0})
    baseline = study.design("S1").with_values({"c": 1500.0})
    asked = MarginRequest(study, "S2", design, "S1", baseline, "J3", "statistical-linearisation")
    found = _break_even(asked, next(iter(_trials(asked))))
    c, b, f = it.Damper(1500.0), it.Inerter(10.0), it.Friction(0.0, name="own")
    real = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(20e3) | c | (b | f))
    method, index = study.method(found.method), study.index("J3")
    alone = it.break_even(real, baseline, index, parameter="own", method=method)
    assert 200.0 < alone.value < 400.0
    assert (found.value, found.status) == (alone.value, alone.status.kind.value)


@pytest.mark.marathon
def test_other_speeds_are_those_of_the_same_designs(told: dict[str, Any]) -> None:
    study = study_from(FEW)
    assert [one["factor"] for one in told["speeds"]] == [0.8, 1.2]
    for one in told["speeds"]:
        index = it.RideComfort(it.Road(study.road.roughness, one["factor"] * 25.0))  # type: ignore[union-attr]
        own, base = (it.evaluate(car(name), index, study.method(one["method"])).value for name in ("S3", "S1"))
        assert one["improvement_percent"] == pytest.approx(100.0 * (1.0 - own / base), rel=1e-9)


def test_other_speeds_are_simulated_where_linearisation_is_not_sure() -> None:
    """By the method of the decision, which the message of the linearisation would otherwise advise."""
    document = changed(elements={"f": "200 N"}, study={"realisations": 2, "evaluate": ["expected-value"]})
    study = study_from(document)
    design, baseline = (study.design(name).with_values(VALUES[name]) for name in ("S3", "S1"))
    found = list(_speeds(MarginRequest(study, "S3", design, "S1", baseline, "J1", "expected-value")))
    assert [(one.factor, one.short) for one in found] == [(0.8, "72 km/h (-20 %)"), (1.2, "108 km/h (+20 %)")]
    for one in found:
        index = it.RideComfort(it.Road(study.road.roughness, one.factor * 25.0))  # type: ignore[union-attr]
        two = it.compare(design, baseline, index, it.ExpectedValue(realisations=2, seed=study.seed))
        assert (one.method, one.status, one.message) == ("expected-value", "ok", "")
        assert one.improvement_percent == pytest.approx(-two.percent, abs=3.0 * two.percent_error)
        assert one.improvement_error_percent is not None


@pytest.mark.marathon
def test_tolerances_are_assumed_where_the_study_has_none(client: TestClient, told: dict[str, Any]) -> None:
    scatter = told["scatter"]
    assert scatter["is_assumed"]
    assert scatter["spread"] == usual_tolerances(car("S3")) == {"k": 0.1, "c": 0.2, "b": 0.1, "f": 0.1}
    assert not is_blind(scatter["method"])
    body = {"study": FEW, "layout": "S3", "values": VALUES, "index": "J1", "spread": scatter["spread"]}
    there = ask(client, "panel/tolerance", **body, method=scatter["method"], samples=256)
    assert (scatter["worst"], scatter["quantiles"]) == (there["worst"], there["quantiles"])
    assert scatter["worst_percent"] == pytest.approx(100.0 * (there["worst"] / there["nominal"] - 1.0))


@pytest.mark.parametrize(
    ("given", "is_assumed", "spread"), [({}, True, {"k": 0.1, "c": 0.2}), ({"c": "5 %"}, False, {"c": 0.05})]
)
def test_tolerances_of_a_study_without_an_inerter(
    client: TestClient, given: dict[str, str], is_assumed: bool, spread: dict[str, float]
) -> None:
    study = {**changed(study={"tolerance": given} if given else {}), "layouts": {"S1": "k | c", "S2": "k | c"}}
    scatter = ask(client, "panel/margins", study=study, **_no_inerter())["scatter"]
    assert (scatter["is_assumed"], scatter["spread"]) == (is_assumed, spread)


def _no_inerter() -> dict[str, Any]:
    return {"layout": "S2", "values": {"S1": {"c": 1500.0}, "S2": {"c": 2000.0}}, "index": "J1"}


def test_a_job_gives_the_same_margins(client: TestClient) -> None:
    study = {**DOCUMENT, "layouts": {"S1": "k | c", "S2": "k | c"}}
    panel = ask(client, "panel/margins", study=study, **_no_inerter())
    job = ask(client, "work", kind="margins", study=study, wait=30, **_no_inerter())["result"]
    assert {**panel, "sequence": 0} == {**job, "sequence": 0}
    assert any("no inerter, friction or gap" in one["sentence"] for one in job["caveats"])


@pytest.mark.parametrize(
    ("layout", "values", "text"),
    [
        ("S1", VALUES, "it is the baseline"),
        ("S3", {"S1": {"c": 1.0}}, "No value of c and b of S3 has been chosen yet."),
    ],
)
def test_without_two_chosen_designs_there_are_no_margins(
    client: TestClient, layout: str, values: dict[str, Any], text: str
) -> None:
    told = ask(client, "panel/margins", study=DOCUMENT, layout=layout, values=values)
    assert (told["break_even"], told["speeds"], told["scatter"]) == ([], [], None)
    assert text in told["caveats"][0]["sentence"]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("k | c - (ks | cs) - (b | f)", {"ks"}),
        ("k | c - b", set()),
        ("k | c | (ks - b)", {"ks"}),
        ("k | c", set()),
        ("(k | c) - ks", set()),
        ("bridge(k, c, ks - b, cs, f)", {"ks"}),
    ],
)
def test_springs_in_series_with_an_inerter_are_its_compliance(text: str, found: set[str]) -> None:
    kinds = {"k": it.Spring(1e4), "ks": it.Spring(1e6), "c": it.Damper(1e3), "cs": it.Damper(1e3)}
    elements = {**kinds, "b": it.Inerter(50.0), "f": it.Friction(10.0)}
    named = {name: element.of(element.value, name) for name, element in elements.items()}
    assert compliant_springs(it.network(text, **named)) == found


def test_a_tolerance_of_friction_by_a_norm_is_not_nought(client: TestClient) -> None:
    """It is not known, and says so: alone nothing is computed, beside others its part is missing."""
    body = {"study": DOCUMENT, "layout": "S3", "values": VALUES, "index": "J1", "method": "norm"}
    alone = ask(client, "panel/tolerance", **body, spread={"f": 0.2})
    assert (alone["status"], alone["total"], alone["standard_deviation"], alone["worst"]) == (
        "failed",
        {"f": None},
        None,
        None,
    )
    both = ask(client, "panel/tolerance", **body, spread={"f": 0.2, "c": 0.1})
    assert (both["status"], both["total"]["f"], both["main"]["f"]) == ("inaccurate", None, None)
    assert both["total"]["c"] == pytest.approx(1.0, abs=0.1)
    for one in (alone, both):
        assert "ignores the tolerance of f" in one["message"]
        assert "expected-value" in one["message"]


@pytest.mark.campaign
def test_a_report_of_fixed_designs_is_that_of_the_command_line(client: TestClient, tmp_path: Path) -> None:
    """Byte for byte: the study of these designs is written and run."""
    designs = [{"layout": name, "values": values} for name, values in VALUES.items()]
    study = changed(study={"indices": ["J1"]})
    text = ask(client, "study/write", study=study, designs=designs)["text"]
    page, result = _page_of_job(client, study=study, designs=designs)
    assert page == _report_of(text, tmp_path / "fixed")
    assert (len(page), result["file"], result["status"]) == (result["size"], "report.html", "ok")
    assert page.startswith(b"<!DOCTYPE html>")


@pytest.mark.marathon
def test_a_report_of_a_study_is_that_of_the_command_line(client: TestClient, tmp_path: Path) -> None:
    limits = example_tables("limits")
    page, _ = _page_of_job(client, study=limits)
    assert page == _report_of(as_toml(limits), tmp_path / "whole")


def _page_of_job(client: TestClient, **body: Any) -> tuple[bytes, dict[str, Any]]:
    """Report that a job has written, and its result."""
    job = ask(client, "work", kind="report", **body)
    assert client.get(f"/api/work/{job['id']}/events").text.count("event: done") == 1  # which ends with the job
    result = client.get(f"/api/work/{job['id']}/result").json()
    return client.get(f"/api/work/{job['id']}/files/{result['file']}").content, result


def _report_of(text: str, folder: Path) -> bytes:
    """Report of `inerter run` of the study file with this text."""
    folder.mkdir()
    load_text(folder, text)
    (path,) = folder.glob("*.toml")
    run_command(path, WorkOptions(folder / "results", jobs=1, json=True))
    return (folder / "results" / "report.html").read_bytes()
