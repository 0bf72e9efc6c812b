"""What is made of estimates is no better than the worst of them, says so first, and names the method that can decide.

Each of these is made twice: with the exact norms as they are, and with norms that say of themselves, of one of several
designs or of all, that they are inaccurate.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest
from study_text import load_text, study_text
from synthetic import terminal_text
from wang_su import J1, J3, ROAD

import inerter as it
from inerter.app.index_values import estimate_index
from inerter.errors import PerformanceIndexError, Status, StatusKind
from inerter.files.study.cases import cases, run_case
from inerter.files.study.parts import run_part
from inerter.files.study.results import dataset
from inerter.files.study.running import StudyResult
from inerter.files.study.tasks import TaskResults, by_task, parts_of
from inerter.methods.compare import compare
from inerter.methods.registry import decisive_method_clause
from inerter.papers.wang_su_2008.judging import ClaimVerdict, EstimatedQuantity, statement, within
from inerter.report.conclusions import conclusion_sentences
from inerter.report.page import report
from inerter.report.study_contents import StudyContents
from inerter.report.study_data import as_text
from inerter.report.text import table_lines
from inerter.uncertainty.distributions import scatter_of

K, C, B = it.Spring(60e3, "k"), it.Damper(3e3, "c"), it.Inerter(50.0, "b")
ELEMENTS = 'k = "60 kN/m"\nc = { from = "500 N s/m", to = "9 kN s/m" }\nb = "50 kg"'
TEXT = study_text(
    'indices = ["J1"]\noptimise = "norm"\nbaseline = "S1"\nbreak_even = ["b"]\ntrade_off = ["J1", "J3"]\npoints = 3\n'
    'tolerance = { k = "5 %" }',
    elements=ELEMENTS,
)
LIMITED = study_text(
    'indices = ["J1"]\noptimise = "norm"\nbaseline = "S1"\nsubject_to = { tyre-load = { at_most = "900 N" } }',
    elements=ELEMENTS,
)


def car(strut):
    return it.QuarterCar(sprung_mass=250.0, unsprung_mass=35.0, tyre_stiffness=150e3, strut=strut)


def worsen(monkeypatch, which=lambda definition, mechanism: True):
    """Norms of `which` questions say that they are inaccurate, one by one and in bulk."""
    one, many = it.Norm.estimate, it.Norm.estimate_many

    def estimate(self, vehicle, index):
        found = one(self, vehicle, index)
        mechanism = vehicle.mechanism()
        bad = which(index.definition(mechanism), mechanism)
        return replace(found, status=Status(StatusKind.INACCURATE, "it is so so")) if bad else found

    def estimate_many(self, vehicle, indices, points):
        found, mechanism = many(self, vehicle, indices, points), vehicle.mechanism()
        for i, index in enumerate(indices):
            if which(index.definition(mechanism), mechanism):
                found[:, i] = float("nan")
        return found

    monkeypatch.setattr(it.Norm, "estimate", estimate)
    monkeypatch.setattr(it.Norm, "estimate_many", estimate_many)


def has_inerter(definition, mechanism):
    return any(isinstance(e, it.Inerter) for mount in mechanism.mounts() for e in mount.network.elements())


def is_about_tyres(definition, mechanism):
    return any("tyre" in output.output for output in definition.outputs)


def is_slow(definition, mechanism):
    return definition.drive.amplitude_density < ROAD.velocity_intensity


USE = it.Conditions([it.Condition(0.5, road={"speed": 10.0}), it.Condition(0.5, road={"speed": 25.0})])
MADE = {  # of what, and which of its estimates is worse
    "comparison": (lambda: compare(car(K | C | B), car(K | C), J1, it.Norm()), has_inerter),
    "tie": (lambda: compare(car(K | C | B), car(K | C | B), J1, it.Norm()), has_inerter),
    "budget": (lambda: it.break_even(car(K | C | B), car(K | C), J1, parameter="b", method=it.Norm()), has_inerter),
    "mean over conditions": (lambda: it.evaluate(car(K | C), USE.mean(J1), it.Norm()), is_slow),
    "worst of conditions": (lambda: it.evaluate(car(K | C), USE.worst(J1), it.Norm()), is_slow),
    "quantile": (
        lambda: it.evaluate(car(K | C), it.Quantile(J1, scatter_of({"k": 0.1}, "uniform"), 0.9, 16), it.Norm()),
        lambda *_: True,
    ),
    "tolerance": (
        lambda: it.tolerance_analysis(car(K | C), J1, it.Norm(), spread={"k": 0.1}, samples=16),
        lambda *_: True,
    ),
    "limit": (
        lambda: it.optimise(
            car(K | it.Damper(it.free(500, 9e3, name="c"))), J1, it.Norm(), subject_to=[it.at_most(J3, 900.0)]
        ),
        is_about_tyres,
    ),
    "front": (
        lambda: it.pareto_front(car(K | it.Damper(it.free(500, 9e3, name="c"))), [J1, J3], it.Norm(), points=3),
        is_about_tyres,
    ),
}


@pytest.mark.parametrize("name", MADE)
def test_what_is_made_of_estimates_is_no_better_than_the_worst(name, monkeypatch):
    make, which = MADE[name]
    sound = make().status
    assert sound.kind in ("ok", "unbounded")
    worsen(monkeypatch, which)
    found = make()
    assert found.status.kind in ("inaccurate", "failed")
    assert "so so" in found.status.message or "reliable" in found.status.message
    if name in ("comparison", "tie"):
        assert str(found).startswith("not certain (inaccurate")


def judged_study(tmp_path, text=TEXT):
    """All that a study comes to: as text, as data, and as a page."""
    study = load_text(tmp_path, text)
    outcomes = {case: run_case(study, case) for case in cases(study)}
    found = tuple(run_part(study, outcomes, part) for part in parts_of(study))
    data = dataset(study, outcomes)
    for task, own in by_task(found).items():
        data = task.add_to_dataset(study, data, own)
    result = StudyResult(tmp_path, study, data, len(outcomes), found, False)
    answer = re.search(r'<ul class="answer">(.*?)</ul>', report(StudyContents(data, study, found), tmp_path), re.DOTALL)
    told = {task.key: (task, TaskResults(study, data, own)) for task, own in by_task(found).items()}
    tables = {key: task.table(results) for key, (task, results) in told.items()}
    sentences = {key: next(task.sentences(results), "") for key, (task, results) in told.items()}
    return {
        "headline": conclusion_sentences(data, study, found)[0],
        "answer box": answer[1].replace("<li>", "").strip(),
        "front": sentences.get("fronts", ""),
        "budget": sentences.get("budgets", ""),
        "tolerance": tables["tolerances"].rows[-1].status if "tolerances" in tables else "",
        "terminal": {key: "\n".join(table_lines(table)) for key, table in tables.items()},
        "table": terminal_text(data),
        "json": json.loads("".join(as_text(result))),
    }


def test_everything_that_a_study_says_begins_with_its_doubt_and_names_who_decides(tmp_path, monkeypatch):
    sound = judged_study(tmp_path)
    worsen(monkeypatch)
    doubtful = judged_study(tmp_path)
    for name in ("headline", "answer box", "front", "budget"):
        assert not re.match("not certain", sound[name].strip(), re.IGNORECASE), name
        assert re.match("not certain", doubtful[name].strip(), re.IGNORECASE), (name, doubtful[name])
        assert "expected-value" in doubtful[name].replace("<wbr>", ""), (name, doubtful[name])
    for key in ("budgets", "tolerances"):
        shown = {kind: " ".join(made["terminal"][key].split()) for kind, made in (("ok", sound), ("no", doubtful))}
        assert "inaccurate" not in shown["ok"]
        assert re.search(r"! (inaccurate|failed): .*expected-value", shown["no"]), shown["no"]
    assert doubtful["tolerance"].startswith(("failed", "not certain"))
    assert "expected-value" in doubtful["tolerance"]
    assert "so so" in doubtful["table"]
    for kind in ("designs", "budgets", "fronts", "tolerances"):
        assert all(one["status"].split(":")[0] in ("ok", "unbounded") for one in sound["json"][kind]), kind
        assert all(one["status"].split(":")[0] in ("inaccurate", "failed") for one in doubtful["json"][kind]), kind


def test_one_design_that_is_not_sure_makes_the_headline_doubtful_though_it_is_not_the_best(tmp_path, monkeypatch):
    worsen(monkeypatch, has_inerter)
    text = study_text('indices = ["J1"]\nbaseline = "S1"', elements='k = "20 kN/m"\nc = "1 kN s/m"\nb = "30 kg"')
    first = judged_study(tmp_path, text)["headline"]
    assert first.startswith("Not certain: No strut is better than S1 in ride comfort (J1)")
    assert "Ride comfort (J1) of S2 is unreliable (inaccurate: it is so so; expected-value simulates it" in first


def test_a_design_that_keeps_a_limit_by_an_inaccurate_value_is_not_sure(tmp_path, monkeypatch):
    assert judged_study(tmp_path, LIMITED)["headline"].startswith("S2 is ")
    worsen(monkeypatch, is_about_tyres)
    doubtful = judged_study(tmp_path, LIMITED)
    assert doubtful["headline"].startswith("Not certain: S2 is ")
    for name in ("S1", "S2"):
        said = f"of {name} is unreliable (inaccurate: the constraint r.m.s. dynamic tyre load at most 900 N"
        assert said in doubtful["headline"]
    assert all(one["status"].startswith("inaccurate") for one in doubtful["json"]["designs"])


def test_a_claim_that_rests_on_a_doubtful_estimate_is_undetermined_and_says_why_first():
    sure, doubtful = EstimatedQuantity(5.0, 0.1), EstimatedQuantity(5.0, 0.1, doubt="inaccurate: it is so so")
    for measured, verdict in ((sure, ClaimVerdict.SHOWN), (doubtful, ClaimVerdict.UNDETERMINED)):
        for one in (
            measured,
            measured.minus(EstimatedQuantity(0.5)),
            EstimatedQuantity(9.0).minus(measured),
            measured.times(1.0),
        ):
            assert within(one, 1.0, 9.0) is verdict
    said = statement("5 %", within(doubtful, 1.0, 9.0), by=[doubtful])
    assert said.found == "unreliable (inaccurate: it is so so): 5 %"


def with_a_damper_in_the_tyre(strut):
    mechanism = car(strut).mechanism()
    (tyre,) = mechanism.tyres
    return replace(mechanism, tyres=(replace(tyre, network=tyre.network | it.Damper(100.0)),))


def test_a_budget_without_values_claims_nothing():
    designs = (with_a_damper_in_the_tyre(strut) for strut in (K | C | B, K | C))
    found = it.break_even(*designs, J3, parameter="b", method=it.Norm())
    assert found.status.kind == "direct-term"
    assert "better" not in found.status.message


def test_the_tolerance_of_an_infinite_value_says_why_it_is_infinite():
    found = it.tolerance_analysis(with_a_damper_in_the_tyre(K | C), J3, it.Norm(), spread={"k": 0.1}, samples=16)
    assert found.status == found.nominal.status
    assert found.status.kind == "direct-term"


def test_simulation_confirms_an_infinite_variance():
    simulated = it.ExpectedValue(realisations=2)
    found = it.evaluate(with_a_damper_in_the_tyre(K | C | it.Friction(5.0)), J3, simulated)
    assert found.status.kind == "direct-term"
    assert not decisive_method_clause("norm", found.status)


def test_simulation_that_lacks_the_force_too_is_not_said_to_decide():
    design, gain = car(K | C | it.Friction(5.0)), it.LoadCarrying()
    with pytest.raises(PerformanceIndexError, match="amplitude"):
        it.evaluate(design, gain, it.ExpectedValue(realisations=2))
    found = estimate_index(design, gain, it.StatisticalLinearisation())
    assert found.status.kind == "failed"
    assert not decisive_method_clause("statistical-linearisation", found.status)


@pytest.mark.parametrize("kind", StatusKind)
def test_simulation_is_named_only_where_it_may_find_a_value(kind):
    clause = decisive_method_clause("norm", Status(kind, "a reason" if kind != "ok" else ""))
    assert ("expected-value" in clause) is (kind in ("inaccurate", "failed"))
