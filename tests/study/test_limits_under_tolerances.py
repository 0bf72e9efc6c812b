"""Limits that a share of the designs within their tolerances keeps, against plain random numbers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from study_text import assert_refused, assert_survives, load_text, study_text

import inerter as it
from inerter.app.designs import design_of
from inerter.app.index_values import limits_at
from inerter.cli.describing import explain
from inerter.files.study.cases import Case, Outcome, cases, run_case
from inerter.files.study.results import dataset
from inerter.files.study.study import Study
from inerter.report.conclusions import conclusion_sentences
from inerter.report.problem_statement import further_rows

Kept = Callable[[Any], Any]
ROAD = it.Road(5e-7, 25.0)
PARTS = 'k = "20 kN/m"\nc = { from = "0.3 kN s/m", to = "8 kN s/m" }\nc0 = "2 kN s/m"'
LAYOUTS = 'S1 = "k | c"\nS0 = "k | c0"'
ASK = 'indices = ["J1"]\noptimise = "norm"\ntolerance = { k = "20 %", c = "30 %" }\n'
LOAD = 'subject_to = { J3 = { at_most = "450 N" } }\n'
KEPT = "limit_quantile = 0.9\n"


def loaded(folder: Path, settings: str, sections: str = "") -> Study:
    text = study_text(f"{ASK}{settings}", elements=PARTS, layouts=LAYOUTS)
    return load_text(folder, text.replace("[study]", f"{sections}[study]"))


def drawn(c: float, index: it.Index, mass: float = 250.0, count: int = 20_000) -> NDArray[np.float64]:
    """Values of the index of cars whose spring and damper are anywhere within their tolerances (count,)."""
    rng = np.random.default_rng(7)
    k, d = (mean * (1.0 + part * rng.uniform(-1.0, 1.0, count)) for mean, part in ((20e3, 0.2), (c, 0.3)))
    strut = it.Spring(it.free(1.0, 1e6, "k")) | it.Damper(it.free(1.0, 1e6, "c"))
    car = it.QuarterCar(mass, 35.0, 150e3, strut)
    return it.evaluate_many(car, index, {"k": k, "c": d}, it.Norm())[:, 0]


def best(study: Study) -> Outcome:
    return run_case(study, Case("S1", "J1"))


@pytest.mark.parametrize(
    ("limit", "index", "kept"),
    [
        (LOAD, it.TyreLoad(ROAD), lambda values: values <= 450.0),
        (
            'subject_to = { suspension-travel = { at_least = "9.5 mm" } }\n',
            it.SuspensionTravel(ROAD),
            lambda v: v >= 9.5e-3,
        ),
    ],
    ids=["at most", "at least"],
)
def test_that_share_of_the_designs_keeps_an_active_limit(
    limit: str, index: it.Index, kept: Kept, tmp_path: Path
) -> None:
    """Of an independent sample nine in ten, within the error of that of the search; of nominal limits about half."""
    robust, nominal = (best(loaded(tmp_path, f"{limit}{settings}")) for settings in (KEPT, ""))
    for outcome in (robust, nominal):
        assert (outcome.kind, outcome.limits[0][1]) == ("ok", True), outcome.message
    shares = [float(np.mean(kept(drawn(outcome.parameters["c"], index)))) for outcome in (robust, nominal)]
    assert shares[0] == pytest.approx(0.9, abs=0.01)
    assert shares[1] < 0.65
    share = 0.9 if kept(0.0) else 0.1
    values = drawn(robust.parameters["c"], index)
    assert robust.limits[0][0] == pytest.approx(np.quantile(values, share), abs=0.05 * float(values.std()))
    assert robust.values["norm"]["J1"] > nominal.values["norm"]["J1"]


def test_a_limit_is_kept_in_each_condition_by_that_share(tmp_path: Path) -> None:
    loads = '[[conditions]]\n[[conditions]]\nvehicle.sprung_mass = "300 kg"\n'
    found = best(loaded(tmp_path, f"{LOAD}{KEPT}", loads))
    assert (found.kind, found.limits[0][1]) == ("ok", True)
    shares = [np.mean(drawn(found.parameters["c"], it.TyreLoad(ROAD), mass) <= 450.0) for mass in (250.0, 300.0)]
    assert min(shares) == pytest.approx(0.9, abs=0.01)


def test_a_layout_without_design_variables_has_to_keep_it_too(tmp_path: Path) -> None:
    """By the value that one in ten of its designs exceeds, though its nominal value is below the limit."""
    robust, nominal = (loaded(tmp_path, f"{LOAD}{share}".replace("450", "428")) for share in (KEPT, ""))
    found = run_case(robust, Case("S0", "J1"))
    assert run_case(nominal, Case("S0", "J1")).kind == "ok"
    rng = np.random.default_rng(8)
    k = 20e3 * (1.0 + 0.2 * rng.uniform(-1.0, 1.0, 20_000))
    car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(it.free(1.0, 1e6, "k")) | it.Damper(2e3))
    values = it.evaluate_many(car, it.TyreLoad(ROAD), {"k": k}, it.Norm())[:, 0]
    assert found.limits[0][0] == pytest.approx(np.quantile(values, 0.9), abs=0.05 * float(values.std()))
    assert np.quantile(values, 0.9) > 428.0
    assert found.kind == "infeasible"


def test_an_equality_holds_with_nominal_values(tmp_path: Path) -> None:
    stiff = 'subject_to = { static-stiffness.strut = { equal = "20 kN/m" }, J3 = { at_most = "450 N" } }\n'
    study = loaded(tmp_path, f"{stiff}{KEPT}")
    found = best(study)
    assert (found.kind, found.limits[0][0]) == ("ok", pytest.approx(20e3))
    told = further_rows(study)[0][1]
    assert "static stiffness of strut equal 20\xa0kN/m with nominal values" in told
    assert "r.m.s. dynamic tyre load (J3) at most 450\xa0N in 90 % of cases" in told


def test_it_is_said_written_and_explained(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study = loaded(tmp_path, f"{LOAD}{KEPT}")
    assert assert_survives(study, tmp_path).limit_quantile == 0.9
    results = dataset(study, {case: run_case(study, case) for case in cases(study)})
    assert results["limit.words"].values.tolist() == ["r.m.s. dynamic tyre load (J3) at most 450 N in 90 % of cases"]
    sentence = conclusion_sentences(results, study)[-1]
    assert "satisfy r.m.s. dynamic tyre load (J3) at most 450 N in 90 % of cases." in sentence
    without = conclusion_sentences(results, loaded(tmp_path, LOAD))[-1]
    assert "at most 450 N with nominal values" in without
    explain("study.limit_quantile")
    assert "Share of the designs within the tolerances" in capsys.readouterr().out


def test_the_workbench_judges_designs_by_it(tmp_path: Path) -> None:
    """A damper with which the nominal car keeps the limit, and with one of the two one in ten of the others."""
    study = loaded(tmp_path, f"{LOAD}{KEPT}")
    for c, keeps in ((1300.0, False), (1900.0, True)):
        design = design_of(study, "S1", {"c": c})
        (limit,) = limits_at(study, design, "norm")
        values = drawn(c, it.TyreLoad(ROAD))
        assert it.evaluate(design.vehicle, it.TyreLoad(ROAD), it.Norm()).value < 450.0
        assert limit.kept == (np.mean(values <= 450.0) >= 0.9) == keeps
        assert limit.result().words == "r.m.s. dynamic tyre load (J3) at most 450 N in 90 % of cases"


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (f"{ASK}{KEPT}", ["there are no constraints"]),
        (f"{ASK}{LOAD}{KEPT}".replace('tolerance = { k = "20 %", c = "30 %" }\n', ""), ["nothing scatters"]),
        (f"{ASK}{LOAD}limit_quantile = 1.5", ["between 0 and 1"]),
    ],
)
def test_a_share_of_nothing_is_refused(settings: str, words: list[str], tmp_path: Path) -> None:
    text = study_text(settings, elements=PARTS, layouts=LAYOUTS)
    assert_refused(lambda: load_text(tmp_path, text), "study.limit_quantile", words)
