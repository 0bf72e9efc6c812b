"""Studies by methods that see friction: errors of differences, budgets, and what a failing method leaves behind."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from study_text import ON_A_ROUGH_ROAD

from inerter.errors import PerformanceIndexError, StudyError
from inerter.files.common.layouts import StrutLayout
from inerter.files.study.cases import Case, Outcome, run_case
from inerter.files.study.checking import check_study
from inerter.files.study.loading import load_study
from inerter.files.study.results import dataset
from inerter.files.study.running import StudyResult, run_study
from inerter.files.study.study import Study
from inerter.files.study.tasks import TaskResults, answer_of, journal_entry, parts_of
from inerter.methods.compare import compare, compare_estimates
from inerter.methods.expected_value import ExpectedValue
from inerter.methods.method import Estimate, evaluate
from inerter.methods.statistical_linearisation import StatisticalLinearisation
from inerter.networks.elements import Free
from inerter.optimisation.budget import break_even
from inerter.optimisation.optimise import optimise
from inerter.report.tables import trade_off_tables
from inerter.report.verdicts import study_decision
from inerter.table import csv_rows, csv_text
from inerter.tasks.budgets import BudgetAnswer, Budgets

TEXT = (
    f'\ntitle = "Friction on both sides"\n{ON_A_ROUGH_ROAD}'
    + """[elements]
k = "90 kN/m"
c = { from = "100 N s/m", to = "100 kN s/m" }
b = "300 kg"
f = "20 N"
h = "20 N"
[layouts]
usual = "k | c | f"
serial = "k | c - (b | h)"
ideal = "k | c - b"
[study]
indices = ["J1"]
optimise = "norm"
evaluate = ["norm", "expected-value", "statistical-linearisation"]
realisations = 4
"""
)
ROADS = ExpectedValue(realisations=4, jobs=1)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    path = tmp_path_factory.mktemp("study") / "study.toml"
    path.write_text(TEXT, encoding="utf-8")
    return load_study(path)


@pytest.fixture(scope="module")
def result(study: Study, tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run_study(study, tmp_path_factory.mktemp("run") / "out")


@pytest.fixture(scope="module")
def budgeted(study: Study, tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    layouts = {"plain": StrutLayout({"strut": "k | c"}), "serial": study.layouts["serial"]}
    asked = replace(study, layouts=layouts, baseline="plain", evaluate=("norm", "expected-value"), budgets=("h",))
    return run_study(asked, tmp_path_factory.mktemp("run") / "out")


def rows(result: StudyResult, name: str = "summary.csv") -> list[dict[str, str]]:
    with (result.folder / name).open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_every_method_judges_the_same_design(result: StudyResult) -> None:
    study = result.study
    for row in rows(result):
        assert row["status"] == "ok"
        design = study.design(row["layout"]).with_values({"c": float(row["c [N s/m]"])})
        again = evaluate(design, study.index("J1"), study.method(row["method"]))
        assert again.value == float(row["value"])
        assert row["standard_error"] == ("" if again.standard_error is None else repr(again.standard_error))
        assert row["error_bound"] == ("" if np.isnan(again.error_bound) else repr(again.error_bound))
        assert int(row["realisations"]) == again.realisations
    linear, real = (float(r["value"]) for r in rows(result) if r["layout"] == "ideal" and r["method"] != "norm")
    assert linear == real  # without friction every method gives the norm


def test_bounds_of_values_and_of_improvements_are_in_the_dataset(study: Study) -> None:
    values, bounds = {"usual": 2.0, "serial": 1.5, "ideal": 1.4}, {"usual": 0.02, "serial": 0.03, "ideal": 0.0}
    outcomes = [
        Outcome(
            *(layout, "J1", 0),
            *({"c": 1000.0}, {}, {}, 0, 0, 0),
            values={"norm": {"J1": value}},
            standard_errors={},
            status={"norm": "ok"},
            error_bounds={"norm": {"J1": bounds[layout]}},
        )
        for layout, value in values.items()
    ]
    data = dataset(study, {outcome.part: outcome for outcome in outcomes}).sel({"method": "norm", "index": "J1"})
    for layout, value in values.items():
        here = data.sel(layout=layout)
        assert here.error_bound.item() == here.other_error_bound.item() == bounds[layout]
        off = [
            100.0 * (1.0 - value * (1.0 + a * bounds[layout]) / (2.0 * (1.0 + b * 0.02))) - here.improvement.item()
            for a in (-1.0, 1.0)
            for b in (-1.0, 1.0)
        ]
        assert here.improvement_bound.item() == pytest.approx(max(map(abs, off)))


def test_other_indices_of_a_design_have_standard_errors_of_their_own(study: Study, tmp_path: Path) -> None:
    """Those of an evaluation; table and verdict have them, the latter as those of two independent values."""
    asked = replace(study, evaluate=("expected-value",), indices=("J1", "J3"))
    found = run_study(asked, tmp_path / "out").data
    errors = {}
    for name in ("usual", "serial"):
        row = found.sel({"layout": name, "index": "J1", "method": "expected-value"})
        design = study.design(name).with_values({"c": row.sel(parameter="c").parameter_value.item()})
        errors[name] = evaluate(design, study.index("J3"), ROADS).standard_error or 0.0
        assert row.sel(other="J3")["other.standard_error"].item() == pytest.approx(errors[name], rel=1e-9)
    table = trade_off_tables(found)[0]
    assert all("+-" in str(cell.content) for row in table.rows[:2] for cell in row.cells[1:])
    (load,) = next(one for one in study_decision(found, "J1", asked).designs if one.name == "serial").others
    assert load.improvement is not None
    base = found.other_value.sel(layout="usual", index="J1", other="J3").item()
    of_ratio = np.hypot(errors["serial"], errors["usual"] * load.value / base) / base  # to first order
    assert load.improvement.error == pytest.approx(100.0 * of_ratio)


def test_improvements_are_those_of_a_comparison(result: StudyResult) -> None:
    """Of the same designs on the same roads, with the same control variates; a design without friction too."""
    study, data = result.study, result.data.sel({"method": "expected-value"}).sel(index="J1")
    designs = {n: study.design(n).with_values({"c": data.parameter_value.sel(layout=n).item()}) for n in study.layouts}
    for name in ("serial", "ideal"):
        two, found = compare(designs[name], designs["usual"], study.index("J1"), ROADS), data.sel(layout=name)
        assert found.improvement.item() == pytest.approx(-two.percent, rel=1e-9)
        assert found.improvement_error.item() == pytest.approx(two.percent_error, rel=1e-9)
        assert two.percent_error < 0.5 * compare_estimates(two.first, two.second).percent_error


def test_the_error_of_a_part_is_that_of_the_ratio_on_the_same_roads() -> None:
    """By the jackknife: the scatter of the ratio of means when each road is left out in turn."""
    other = np.random.default_rng(0).normal(12.0, 1.0, 40)
    one = 0.8 * other + np.random.default_rng(1).normal(0.0, 0.1, 40)
    without = [(one.sum() - a) / (other.sum() - b) for a, b in zip(one, other, strict=True)]
    expected = 100.0 * np.sqrt((one.size - 1) * np.var(without))
    parts = [Estimate(s.mean(), "N", standard_error=scipy.stats.sem(s), samples=tuple(s)) for s in (one, other)]
    assert compare_estimates(*parts).percent_error == pytest.approx(expected, rel=0.02)


@pytest.mark.campaign
def test_budgets_are_those_of_the_library_with_the_best_designs(budgeted: StudyResult) -> None:
    study = budgeted.study
    (found,) = budgeted.answers
    assert (found.layout, found.index, found.method, found.at_most) == ("serial", "J1", "expected-value", True)
    c = {row["layout"]: float(row["c [N s/m]"]) for row in rows(budgeted)}
    designs = [study.design(name).with_values({"c": c[name]}) for name in ("serial", "plain")]
    expected = break_even(*designs, study.index("J1"), parameter="h", method=ROADS)
    assert (found.value, found.standard_error, found.status) == (expected.value, expected.standard_error, "ok")
    (row,) = rows(budgeted, "budgets.csv")
    assert (row["value"], row["better"], row["status"]) == (repr(expected.value), "below", "ok")


@pytest.mark.parametrize("at_most", [True, False])
def test_a_budget_without_a_value_has_no_better_side(study: Study, at_most: bool) -> None:
    ended = BudgetAnswer(
        layout="serial",
        index="J1",
        parameter="h",
        unit="N",
        method="norm",
        at_most=at_most,
        value=280.5,
        standard_error=6.6,
        interval=(265.3, 296.7),
        crossings=[280.5],
        status="ok",
        message="",
    )
    none = {"value": None, "standard_error": None, "interval": None, "status": "unbounded"}
    endless = replace(ended, **none, crossings=[], message="the design is better for no h from 1 N to 2 N")
    table = Budgets().table(TaskResults(study, xr.Dataset(), [ended, endless]))
    told = list(csv.DictReader(csv_text(csv_rows(table)).splitlines()))
    assert [row["better"] for row in told] == ["below" if at_most else "above", ""]
    assert told[1]["status"] == "unbounded: the design is better for no h from 1 N to 2 N"


@pytest.mark.campaign
def test_budgets_and_outcomes_survive_the_journal_and_are_not_computed_again(budgeted: StudyResult) -> None:
    for found in budgeted.answers:
        again = answer_of(json.loads(json.dumps(journal_entry(found))))
        assert again.part == found.part
        assert again.value == found.value
    journal, before = budgeted.folder / "journal.jsonl", (budgeted.folder / "budgets.csv").read_bytes()
    lines = journal.read_text().splitlines(keepends=True)
    assert len(lines) == 1 + 2 + len(parts_of(budgeted.study))
    again = run_study(budgeted.study, budgeted.folder, resume=True)
    assert (again.computed, again.answers[0].value) == (0, budgeted.answers[0].value)
    assert journal.read_text().splitlines(keepends=True) == lines
    journal.write_text("".join(lines[:-1]) + lines[-1][:40])  # ended while the budget was written down
    assert run_study(budgeted.study, budgeted.folder, resume=True).computed == 0
    assert (budgeted.folder / "budgets.csv").read_bytes() == before


def test_threads_change_no_digit(study: Study) -> None:
    one, two = (run_case(study, Case("serial", "J1"), threads) for threads in (1, 3))
    assert one == two
    assert Outcome(**json.loads(json.dumps(one.to_json()))).samples == one.samples
    assert len(one.samples["expected-value"]) == 4


def test_a_search_by_simulation_says_what_it_gains_over_the_best_linear_design(study: Study) -> None:
    simulated = replace(study, optimise="expected-value", evaluate=("expected-value",), realisations=2)
    outcome = run_case(simulated, Case("serial", "J1"))
    expected = optimise(
        study.design("serial"), study.index("J1"), ExpectedValue(realisations=2, jobs=1)
    ).gain_over_linear
    assert expected is not None
    assert outcome.over_linear == (-expected.percent, expected.percent_error)
    assert outcome.over_linear[0] >= 0.0


def test_a_method_that_fails_leaves_the_others(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PerformanceIndexError("not this one")

    monkeypatch.setattr(StatisticalLinearisation, "estimate", refuse)
    outcome = run_case(study, Case("serial", "J1"))
    assert outcome.status["statistical-linearisation"] == "failed"
    assert outcome.message == "linearisation: not this one"
    assert np.isfinite(outcome.values["norm"]["J1"])
    assert np.isfinite(outcome.values["expected-value"]["J1"])


def test_an_index_that_fails_leaves_the_optimum_for_another(study: Study) -> None:
    """The peak gain of friction needs the amplitude of its force, which J1 does not."""
    fixed = {name: e.with_value(2e3) if isinstance(e.value, Free) else e for name, e in study.elements.items()}
    both = replace(study, elements=fixed, optimise=None, evaluate=("expected-value",), indices=("J1", "J5"))
    comfort, load = (run_case(both, Case("serial", index)) for index in both.indices)
    assert (comfort.status, comfort.message) == ({"expected-value": "ok"}, "")
    assert np.isfinite(comfort.values["expected-value"]["J1"])
    assert np.isnan(comfort.values["expected-value"]["J5"])
    assert load.status["expected-value"] == "failed"
    assert "force amplitude" in load.message


def test_a_layout_that_friction_alone_holds_is_no_question_for_the_norm(study: Study) -> None:
    held = replace(study, layouts={**study.layouts, "held": replace(study.layouts["usual"], struts={"strut": "f"})})
    with pytest.raises(StudyError, match=r"layouts\.held.*unconstrained"):
        check_study(held)
    fixed = {name: e.with_value(2e3) if isinstance(e.value, Free) else e for name, e in study.elements.items()}
    check_study(replace(held, elements=fixed, optimise=None, evaluate=("expected-value",)))
