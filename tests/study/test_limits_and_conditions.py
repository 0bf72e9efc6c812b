"""Limits and operating conditions of study files: what they ask is what Python asks, and what is said of them."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from combinations import CARS
from study_text import assert_refused, assert_survives, load_text, study_text
from synthetic import terminal_text
from wang_su import ROAD

import inerter as it
from inerter.app.designs import design_of
from inerter.app.index_values import limits_at
from inerter.errors import StudyError
from inerter.files.common.entries import element_name
from inerter.files.common.problem import EntryError
from inerter.files.study.cases import Outcome, cases, run_case
from inerter.files.study.method_labels import neglect_clause
from inerter.files.study.parts import run_part
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.results import dataset
from inerter.files.study.running import StudyResult, run_study
from inerter.files.study.study import Study
from inerter.indices.registry import INDICES
from inerter.networks.elements.values import NAME
from inerter.report.conclusions import conclusion_sentences
from inerter.report.limits import limit_tables
from inerter.report.page import report
from inerter.report.problem_statement import condition_rows
from inerter.report.study_contents import StudyContents
from inerter.report.study_data import as_text
from inerter.report.text import WIDTH
from inerter.report.verdicts import verdict_sentences
from inerter.statements import exit_code
from inerter.tasks.budgets import BudgetPart
from inerter.tasks.tolerances import TolerancePart

FREE = """k = { from = "10 kN/m", to = "200 kN/m" }
c = { from = "100 N s/m", to = "100 kN s/m" }
b = { from = "1 kg", to = "2000 kg" }"""
TWO = """[[conditions]]
name = "empty"
share = 0.3
[[conditions]]
"road.speed" = "30 m/s"
vehicle.sprung_mass = "320 kg"
share = 0.7
"""


@pytest.fixture
def load(tmp_path: Path) -> Callable[..., Study]:
    def load(settings: str, sections: str = "", elements: str = FREE, **parts: str) -> Study:
        layouts = parts.pop("layouts", 'S1 = "k | c"\nS3 = "k | c - b"')
        text = study_text(settings, elements=elements, layouts=layouts, **parts)
        return load_text(tmp_path, text.replace("[study]", f"{sections}[study]"))

    return load


def test_limits_are_those_of_python(load: Callable[..., Study], tmp_path: Path) -> None:
    limits = 'subject_to = { tyre-load = { at_most = "650 N" }, static-stiffness.strut = { at_least = "25 kN/m" } }'
    study = load(f'indices = ["J1"]\noptimise = "norm"\n{limits}')
    result = run_study(study, tmp_path / "out")
    car, road = study.design("S3"), study.road
    by_hand = it.optimise(
        car,
        it.RideComfort(road),
        it.Norm(),
        subject_to=[it.at_most(it.TyreLoad(road), 650.0), it.at_least(it.static_stiffness("strut"), 25e3)],
        seed=0,
    )
    best = result.data.sel(layout="S3", index="J1").squeeze("method")
    assert float(best["value"]) == by_hand.value
    assert best["limit"].values.tolist() == ["tyre-load at most 650 N", "static-stiffness.strut at least 25 kN/m"]
    np.testing.assert_array_equal(best["limit_value"], [held.value for held in by_hand.limits])
    np.testing.assert_array_equal(best["limit_cost"], [held.sensitivity for held in by_hand.limits])
    assert best["limit_active"].values.tolist() == [held.active for held in by_hand.limits]
    assert any(held.active for held in by_hand.limits)
    with (tmp_path / "out" / "summary.csv").open(encoding="utf-8", newline="") as stream:
        row = list(csv.DictReader(stream))[1]
    assert float(row["static-stiffness.strut at least [N/m]"]) == by_hand.limits[1].value
    assert float(row["cost of static-stiffness.strut at least_percent"]) == by_hand.limits[1].sensitivity
    for name in result.data.variables:  # an element that is swept would stand beside them
        if NAME.fullmatch(str(name)) and not str(name).startswith(("gain_", "output_")):
            with pytest.raises(EntryError, match="results use"):
                element_name(name)
    text = terminal_text(result.data)
    assert max(map(len, text.splitlines())) <= WIDTH
    assert "raising it by 1 % changes" in " ".join(text.split())
    assert "Every design satisfies these constraints" in report(StudyContents(result.data, study), tmp_path)


@pytest.mark.parametrize("of", ["dynamic-load-coefficient", "transmissibility"])
@pytest.mark.parametrize("sense", ["at_most", "at_least", "equal"])
def test_a_limit_on_a_ratio_is_a_number(load: Callable[..., Study], of: str, sense: str) -> None:
    gain = '[indices.transmissibility]\nkind = "peak-response"\ninput = "road"\noutput = "sprung_displacement"'
    own = "" if of in it.INDICES else gain
    with_unit, alone = (
        load(f'indices = ["J1"]\noptimise = "norm"\nsubject_to = {{ {of} = {{ {sense} = {value} }} }}\n{own}').limits
        for value in ('"0.3 N/N"', "0.3")
    )
    assert with_unit == alone
    assert alone[0].value == 0.3


@pytest.mark.marathon
def test_a_limit_that_nothing_keeps_is_said_and_is_no_best(load: Callable[..., Study], tmp_path: Path) -> None:
    study = load('indices = ["J1"]\noptimise = "norm"\nsubject_to = { J3 = { at_most = "10 N" } }')
    result = run_study(study, tmp_path / "out")
    assert np.isnan(result.data["value"]).all()
    assert np.isfinite(result.data["parameter_value"].sel(layout="S3")).all()  # of the nearest design
    assert (result.failed, result.status.kind.value, exit_code([result.status])) == (False, "infeasible", 1)
    assert [str(text).partition(":")[0] for text in result.data["status"].values.ravel()] == ["infeasible"] * 2
    assert verdict_sentences(result.data) == [
        "No strut satisfies the constraints, so none is best in ride comfort (J1)."
    ]
    assert "value of the closest design" in report(StudyContents(result.data, study), tmp_path)


@pytest.mark.parametrize(
    ("settings", "code"),
    [
        ('subject_to = { J3 = { at_most = "10 N" } }', 1),
        ('subject_to = { J3 = { at_most = "900 N" } }', 0),
        (
            'subject_to = { J3 = { at_most = "10 N" } }\nsweep = { "study.subject_to.J3.at_most" = ["10 N", "900 N"] }',
            0,
        ),
        ('subject_to = { J3 = { at_most = "10 N" } }\nsweep = { "study.subject_to.J3.at_most" = ["10 N", "20 N"] }', 1),
    ],
)
def test_a_study_without_any_feasible_design_has_no_answer(
    load: Callable[..., Study], settings: str, code: int
) -> None:
    """So that its exit code is 1, unless some layout, at some point of a sweep, keeps the limits."""
    elements = 'k = "30 kN/m"\nc = { from = "1 kN s/m", to = "3 kN s/m" }\nb = "20 kg"'
    study = load(f'indices = ["J1"]\noptimise = "norm"\n{settings}', elements=elements)
    outcomes = {case: run_case(study, case) for case in cases(study)}
    found = StudyResult(study.path, study, dataset(study, outcomes), len(outcomes))
    assert {one.kind for one in outcomes.values()} <= {"ok", "infeasible"}
    assert exit_code([found.status]) == code


@pytest.mark.parametrize("sections", ["", TWO], ids=["plain", "conditions"])
def test_a_layout_without_design_variables_has_to_keep_the_limits_too(
    load: Callable[..., Study], sections: str
) -> None:
    """Of two such layouts the softer one, which is better in the index, travels farther than the limit."""
    elements = f'{FREE}\nk1 = "20 kN/m"\nc1 = "900 N s/m"\nc2 = "6 kN s/m"'
    layouts = 'S1 = "k | c"\nsoft = "k1 | c1"\nfirm = "k1 | c2"'
    limits = 'subject_to = { suspension-travel = { at_most = "5 mm" } }'
    study = load(f'indices = ["J1"]\noptimise = "norm"\n{limits}', sections, elements, layouts=layouts)
    results = dataset(study, {case: run_case(study, case) for case in cases(study) if case.layout != "S1"})
    loads = [(250.0, 25.0), (320.0, 30.0)] if sections else [(250.0, 25.0)]
    travels = [
        max(
            it.evaluate(
                it.QuarterCar(mass, 35.0, 150e3, it.Spring(20e3) | it.Damper(c)),
                it.SuspensionTravel(it.Road(5e-7, speed)),
                it.Norm(),
            ).value
            for mass, speed in loads
        )
        for c in (900.0, 6e3)
    ]
    assert travels[1] < 5e-3 < travels[0]
    soft, firm = (results.sel(layout=name, index="J1").squeeze("method") for name in ("soft", "firm"))
    assert [float(one["limit_value"].item()) for one in (soft, firm)] == pytest.approx(travels, rel=1e-9)
    assert str(soft["status"].item()).startswith("infeasible: ")
    assert (np.isnan(soft["value"]), str(firm["status"].item())) == (True, "ok")
    assert "soft has no feasible design." in conclusion_sentences(results, study)[-1]
    assert "firm" not in conclusion_sentences(results, study)[-1]


@pytest.mark.campaign
def test_a_limit_that_nothing_keeps_is_said_of_an_inaccurate_value_too(load: Callable[..., Study]) -> None:
    """Friction that sticks for a part of the time makes the value doubtful, and the limit is broken all the same."""
    study = load(
        'indices = ["J1"]\noptimise = "norm"\nevaluate = ["statistical-linearisation"]\n'
        'subject_to = { suspension-travel = { at_most = "0.1 mm" } }',
        elements='k = "20 kN/m"\nc = { from = "100 N s/m", to = "600 N s/m" }\nf = "300 N"',
        layouts='S3 = "k | c | f"',
    )
    vehicle = study.design("S3").with_values({"c": 600.0})
    assert it.evaluate(vehicle, study.index("J1"), it.StatisticalLinearisation()).status.kind.value == "inaccurate"
    results = dataset(study, {case: run_case(study, case) for case in cases(study)})
    assert str(results["status"].item()).startswith("infeasible: ")
    assert np.isnan(results["value"]).all()


def test_a_limit_that_nothing_keeps_is_named_once_over_conditions() -> None:
    car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(it.free(100.0, 1e5, "c")))
    grip = it.TyreLoad(ROAD)
    limits = [it.at_most(it.Conditions([it.Condition(1.0, road={"speed": v})]).mean(grip), 10.0) for v in (15.0, 30.0)]
    message = it.optimise(car, grip, it.Norm(), subject_to=limits, seed=0).status.message
    assert message.startswith(
        "no feasible design within the bounds for r.m.s. dynamic tyre load at most 10 N; closest: "
    )
    assert "over conditions" not in message


@pytest.mark.parametrize("symbol", list(INDICES))
def test_the_words_of_a_limit_say_whether_its_value_is_a_peak(symbol: str) -> None:
    road = ROAD
    given = {"road": road, "excitation": road, "element": "k", "outputs": {"tyre_load": 1.0}}
    given |= {"input": "sprung_force", "output": "sprung_displacement"}
    index = INDICES[symbol](**{key: given[key] for key in INDICES[symbol].__dataclass_fields__ if key in given})
    car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3, "k") | it.Damper(2e3)).mechanism()
    definition = index.definition(car)
    is_ratio = definition.unit == "" and not definition.is_peak  # whose name says it all
    words = "peak " if definition.is_peak else "" if is_ratio else "r.m.s. "
    assert str(it.at_most(index, 1.0)).startswith(words or index.title)


@pytest.mark.parametrize(
    ("methods", "sections", "words"),
    [
        ('["norm"]', "", ""),
        ('["norm", "expected-value"]', "", "; values without friction"),
        ('["expected-value"]', "", "; values without friction"),
        ('["norm"]', TWO, "; values in the worst condition"),
        ('["norm", "expected-value"]', TWO, "; values without friction, in the worst condition"),
    ],
)
def test_a_table_of_limits_says_how_its_values_are_computed(
    load: Callable[..., Study], methods: str, sections: str, words: str
) -> None:
    settings = (
        f'indices = ["J1"]\noptimise = "norm"\nevaluate = {methods}\nsubject_to = {{ J3 = {{ at_most = "1 kN" }} }}'
    )
    study = load(settings, sections, f'{FREE}\nf = "10 N"', layouts='S1 = "k | c"\nS3 = "k | c - (b | f)"')
    (table,) = limit_tables(dataset(study, {}))
    mean = ", mean over conditions" if sections else ""
    limit = "r.m.s. dynamic tyre load (J3) at most 1 kN"
    assert table.caption == f"Limit of the designs that are best for ride comfort{mean} (J1): {limit}{words}"


@pytest.mark.parametrize(
    ("active", "value", "text"),
    [(True, 1e3 * (1.0 - 3e-7), "1 kN"), (True, 1000.2, "1 kN"), (False, 999.7, "999.7 N"), (False, 902.0, "902.0 N")],
)
def test_an_active_limit_has_the_text_of_its_bound(
    load: Callable[..., Study], active: bool, value: float, text: str
) -> None:
    study = load('indices = ["J1"]\noptimise = "norm"\nsubject_to = { J3 = { at_most = "1 kN" } }', elements=FREE)
    results = dataset(study, {})
    results["limit_value"][:], results["limit_active"][:], results["limit_unit"][:] = value + 3e-5, active, "N"
    (table,) = limit_tables(results)
    assert {row.cells[1].text for row in table.rows} == {text}


@pytest.mark.parametrize("part", [BudgetPart("S3", "J1", "f"), TolerancePart("S3", "J1")])
def test_a_design_that_breaks_a_limit_is_not_analysed(
    load: Callable[..., Study], part: BudgetPart | TolerancePart
) -> None:
    methods = 'optimise = "norm"\nevaluate = ["norm", "expected-value"]'
    settings = f'indices = ["J1"]\n{methods}\nbreak_even = ["f"]\nsubject_to = {{ J3 = {{ at_most = "10 N" }} }}'
    study = load(settings, elements=f'{FREE}\nf = "10 N"', layouts='S1 = "k | c"\nS3 = "k | c - (b | f)"')
    outcome = Outcome("", "J1", 0, {"k": 5e4, "c": 3e3, "b": 100.0}, {}, {}, 1, 1, 1, {}, {}, {"norm": "infeasible"})
    designs = {case: replace(outcome, layout=case.layout) for case in cases(study)}
    steps: list[it.ProgressStep] = []
    with it.progress(steps.append):
        answer = run_part(study, designs, part)
    assert (answer.status, answer.message) == ("failed", "S3 has no feasible design for J1.")
    assert [str(step) for step in steps] == [part.name, f"{part.name}: done"]


def test_what_a_method_neglects_is_a_clause(load: Callable[..., Study]) -> None:
    study = load(
        'indices = ["J1"]\noptimise = "norm"', elements=f'{FREE}\nf = "10 N"', layouts='S3 = "k | c - (b | f)"'
    )
    clauses = {name: neglect_clause(study, name) for name in ("norm", "statistical-linearisation", "expected-value")}
    assert clauses == {"norm": "without friction", "statistical-linearisation": "", "expected-value": ""}


@pytest.mark.campaign
def test_a_limit_is_swept_by_its_place(load: Callable[..., Study], tmp_path: Path) -> None:
    """Tighter limits never give a better index, and each point is the study with that limit."""
    limit = 'subject_to = { J3 = { at_most = "650 N" } }'
    sweep = 'sweep = { "study.subject_to.J3.at_most" = ["800 N", "700 N", "650 N", "620 N"] }'
    study = load(f'indices = ["J1"]\noptimise = "norm"\n{limit}\n{sweep}', layouts='S3 = "k | c - b"')
    values = run_study(study, tmp_path / "out").data["value"].values.ravel()
    assert np.all(np.diff(values) >= -1e-9)  # limits are kept to 1e-7
    alone = run_study(
        load(f'indices = ["J1"]\noptimise = "norm"\n{limit}', layouts='S3 = "k | c - b"'), tmp_path / "one"
    )
    assert float(alone.data["value"].item()) == values[2]


@pytest.mark.campaign
@pytest.mark.parametrize("over", ["mean", "worst"])
def test_conditions_are_those_of_python(load: Callable[..., Study], tmp_path: Path, over: str) -> None:
    study = load(f'indices = ["J1", "J3"]\noptimise = "norm"\nconditions = "{over}"', TWO)
    use = it.Conditions([it.Condition(0.3), it.Condition(0.7, vehicle={"sprung_mass": 320.0}, road={"speed": 30.0})])
    found = run_study(study, tmp_path / "out").data
    for index, plain in (("J1", it.RideComfort(study.road)), ("J3", it.TyreLoad(study.road))):
        taken = use.mean(plain) if over == "mean" else use.worst(plain)
        by_hand = it.optimise(study.design("S3"), taken, it.Norm(), seed=0)
        value = float(found["value"].sel(layout="S3", index=index).item())
        assert value == by_hand.value
        each = [
            it.evaluate(car.with_values(by_hand.parameters), type(plain)(road), it.Norm()).value
            for car, road in (
                (study.design("S3"), study.road),
                (
                    study.at(()).design("S3").__class__(320.0, 35.0, 150e3, study.design("S3").strut),
                    it.Road(5e-7, 30.0),
                ),
            )
        ]
        assert value == pytest.approx(0.3 * each[0] + 0.7 * each[1] if over == "mean" else max(each), rel=1e-9)
    page = report(StudyContents(found, study), tmp_path)
    assert "Operating conditions" in page
    assert "over conditions" in verdict_sentences(found)[0]


def test_conditions_of_a_car_with_a_seat(load: Callable[..., Study], tmp_path: Path) -> None:
    fixed = 'k = "20 kN/m"\nc = "1 kN s/m"\nks = "10 kN/m"\ncs = "300 N s/m"'
    seat = '[vehicle.seat]\nmass = "70 kg"\nnetwork = "ks | cs"\n'
    loads = '[[conditions]]\nvehicle.sprung_mass = "320 kg"\n[[conditions]]\nvehicle.seat.mass = "95 kg"\n'
    study = load('indices = ["J1"]', seat + loads, fixed, layouts='S1 = "k | c"')
    values = []
    for body, mass in ((320.0, 70.0), (250.0, 95.0)):
        car = it.QuarterCar(body, 35.0, 150e3, it.Spring(20e3) | it.Damper(1e3))
        seated = it.Seat(car, mass, it.Spring(10e3) | it.Damper(300.0))
        values.append(it.evaluate(seated, it.RideComfort(study.road), it.Norm()).value)
    found = run_study(study, tmp_path / "out").data["value"]
    assert float(found.squeeze()) == pytest.approx(np.mean(values), rel=1e-9)


def test_conditions_are_told_and_written_as_they_were(load: Callable[..., Study]) -> None:
    """Of quantities in a unit that is not the SI one, in tables of a list as in any other."""
    sections = '[[conditions]]\nroad.speed = "50 km/h"\n[[conditions]]\nvehicle.sprung_mass = "0.32 t"\nshare = 3\n'
    study = load('indices = ["J1"]\noptimise = "norm"', sections)
    assert [row[1:] for row in condition_rows(study)] == [
        ("25 %", "speed = 50\xa0km/h"),
        ("75 %", "sprung mass = 0.32\xa0t"),
    ]
    assert all(f'"{text}"' in write_resolved(study) for text in ("50 km/h", "0.32 t"))


def test_names_that_look_like_quantities_are_written_as_they_were(load: Callable[..., Study], tmp_path: Path) -> None:
    sections = (
        '[[conditions]]\nroad.speed = "50 km/h"\n[[conditions]]\nvehicle.sprung_mass = "0.32 t"\nname = "320 kg"\n'
    )
    study = load('indices = ["J1"]\noptimise = "norm"', sections)
    again = assert_survives(study, tmp_path)
    assert [one.name for one in again.conditions] == ["", "320 kg"]


@pytest.mark.parametrize(
    ("error", "bound", "text"), [(2.0, 0.01, "900 N"), (np.nan, 1e-3, "902 N"), (2.0, 0.0, "902.3 +- 2.0 N")]
)
def test_the_value_of_a_limit_has_the_digits_that_its_errors_allow(
    load: Callable[..., Study], error: float, bound: float, text: str
) -> None:
    study = load('indices = ["J1"]\noptimise = "norm"\nsubject_to = { J3 = { at_most = "1 kN" } }', elements=FREE)
    results = dataset(study, {})
    results["limit_value"][:], results["limit.standard_error"][:], results["limit.error_bound"][:] = 902.3, error, bound
    results["limit_unit"][:], results["limit.part"][:] = "N", "condition loaded"
    (table,) = limit_tables(results)
    assert {row.cells[1].text for row in table.rows} == {f"{text} (condition loaded)"}


def test_a_limit_holds_in_each_condition(load: Callable[..., Study]) -> None:
    limits = 'subject_to = { J3 = { at_most = "900 N", at_least = "400 N" } }'
    study = load(f'indices = ["J1"]\noptimise = "norm"\n{limits}', TWO)
    (case, *_) = cases(study)
    outcome = run_case(study, case)
    car = study.design(case.layout).with_values(outcome.parameters)
    loads = [
        it.evaluate(one, it.TyreLoad(road), it.Norm()).value
        for one, road in (
            (car, study.road),
            (type(car)(320.0, 35.0, 150e3, car.strut), it.Road(5e-7, 30.0)),
        )
    ]
    (most, *_, upper, _, rounding), (least, *_, lower, _, _) = outcome.limits
    assert {upper, lower} == {"condition empty", "condition 2"}
    assert 0.0 < rounding < 1e-9
    assert (most, least) == pytest.approx((max(loads), min(loads)), rel=1e-9)
    again = Outcome(**json.loads(json.dumps(outcome.to_json())))
    assert json.dumps(again.to_json()) == json.dumps(outcome.to_json())


def test_limits_and_conditions_survive_being_written(load: Callable[..., Study]) -> None:
    limits = 'subject_to = { J3 = { at_most = "0.9 kN", at_least = "400 N" }, static-stiffness.strut.equal = "3 kN/m" }'
    study = load(f'indices = ["J1"]\noptimise = "norm"\nconditions = "worst"\n{limits}', TWO)
    assert_survives(study, study.path.parent)


ASK = 'indices = ["J1"]\noptimise = "norm"\n'
LIMIT = ASK + "subject_to = "
BAD = {
    "limit of nothing": (
        LIMIT + '{ J9 = { at_most = "1 N" } }',
        "",
        "study.subject_to.J9",
        ["cannot be limited", "J1"],
    ),
    "limit misspelt": (
        LIMIT + '{ tire-load = { at_most = "1 N" } }',
        "",
        "study.subject_to.tire-load",
        ['Did you mean "tyre-load"?'],
    ),
    "limit by a part of its name": (
        LIMIT + '{ travel = { at_most = "8 mm" } }',
        "",
        "study.subject_to.travel",
        ['Did you mean "suspension-travel"?'],
    ),
    "limit by another word": (
        LIMIT + '{ J3 = { max = "1 N" } }',
        "",
        "study.subject_to.J3.max",
        ['Did you mean "at_most"?'],
    ),
    "limit that is no table": (
        LIMIT + '{ J3 = "500 N" }',
        "",
        "study.subject_to.J3",
        ["expected a table such as { at_most"],
    ),
    "limit of no strut": (
        LIMIT + '{ static-stiffness.front = { equal = "1 N/m" } }',
        "",
        'study.subject_to."static-stiffness.front"',
        ["no strut", "static-stiffness.strut"],
    ),
    "limit without sides": (LIMIT + "{ J3 = {} }", "", "study.subject_to.J3", ["no limit", "at_most"]),
    "limit on a wrong side": (
        LIMIT + '{ J3 = { below = "1 N" } }',
        "",
        "study.subject_to.J3.below",
        ["unknown key", "at_most, at_least, equal"],
    ),
    "limit equal and more": (
        LIMIT + '{ J3 = { equal = "1 N", at_most = "2 N" } }',
        "",
        "study.subject_to.J3",
        ["at_most, at_least or equal"],
    ),
    "limits crossed": (
        LIMIT + '{ J3 = { at_least = "3 N", at_most = "2 N" } }',
        "",
        "study.subject_to.J3",
        ["at_most below at_least"],
    ),
    "limit in another unit": (
        LIMIT + '{ J3 = { at_most = "3 mm" } }',
        "",
        "study.subject_to.J3",
        ["incompatible unit"],
    ),
    "limit without unit": (LIMIT + "{ J3 = { at_most = 3 } }", "", "study.subject_to.J3", ["unit missing"]),
    "limit of zero": (LIMIT + '{ J3 = { at_most = "0 N" } }', "", "study.subject_to.J3", ["not positive"]),
    "limit is a text": (LIMIT + '{ J3 = "3 N" }', "", "study.subject_to.J3", ["not a table"]),
    "limits are a text": (LIMIT + '"J3"', "", "study.subject_to", ["not a table"]),
    "conditions but none": (ASK + 'conditions = "mean"', "", "study.conditions", ["there are none", "[[conditions]]"]),
    "conditions otherwise": (ASK + 'conditions = "median"', TWO, "study.conditions", ['"mean", "worst"']),
    "conditions of one name": (
        ASK,
        '[[conditions]]\nname = "wet"\nroad.speed = "9 m/s"\n[[conditions]]\nname = "wet"\nroad.speed = "8 m/s"\n',
        "conditions[2].name",
        ["'wet', the name of another condition"],
    ),
    "condition of no place": (
        ASK,
        '[[conditions]]\nroad.sped = "1 m/s"\n',
        'conditions[1]."road.sped"',
        ["no number", '"road.speed"'],
    ),
    "condition of a free element": (ASK, '[[conditions]]\nc = "1 N s/m"\n', "conditions[1].c", ["c is free"]),
    "condition in another unit": (
        ASK,
        TWO + '[[conditions]]\nroad.speed = "1 m"\n',
        'conditions[3]."road.speed"',
        ["incompatible unit"],
    ),
    "condition of zero": (
        ASK,
        '[[conditions]]\nroad.speed = "0 m/s"\n',
        'conditions[1]."road.speed"',
        ["not positive"],
    ),
    "condition of a bound": (
        ASK,
        '[[conditions]]\nelements.c.to = "5 kN s/m"\n',
        'conditions[1]."elements.c.to"',
        ["not what a condition can change"],
    ),
    "share of nothing": (ASK, "[[conditions]]\nshare = 0\n", "conditions[1].share", ["positive number"]),
    "share in text": (ASK, '[[conditions]]\nshare = "30 %"\n', "conditions[1].share", ["without quotes"]),
    "swept and in a condition": (
        ASK + 'sweep = { road.speed = ["1 m/s", "2 m/s"] }',
        TWO,
        'conditions[2]."road.speed"',
        ["swept, and in a condition"],
    ),
}


@pytest.mark.parametrize(("settings", "sections", "place", "words"), BAD.values(), ids=BAD)
def test_what_cannot_be_is_refused_with_its_place(
    load: Callable[..., Study], settings: str, sections: str, place: str, words: list[str]
) -> None:
    assert_refused(lambda: load(settings, sections), place, words)


def test_limits_need_a_search(load: Callable[..., Study]) -> None:
    fixed = 'k = "20 kN/m"\nc = "1 kN s/m"\nb = "30 kg"'
    with pytest.raises(StudyError, match="nothing is optimised"):
        load('indices = ["J1"]\nsubject_to = { J3 = { at_most = "1 N" } }', elements=fixed)


@pytest.mark.campaign
def test_a_budget_holds_over_conditions_of_the_vehicle(load: Callable[..., Study], tmp_path: Path) -> None:
    """One condition of all the time is the study of the numbers in it."""
    elements = 'k = "60 kN/m"\nc = "3 kN s/m"\nc2 = "6 kN s/m"\nb = "300 kg"\nf = "5 N"'
    layouts = 'S1 = "k | c"\nS3 = "k | c2 - (b | f)"'
    settings = 'indices = ["J1"]\nevaluate = ["statistical-linearisation"]\nbreak_even = ["f"]'
    one = '[[conditions]]\nvehicle.sprung_mass = "320 kg"\n'
    over = run_study(load(settings, one, elements, layouts=layouts), tmp_path / "over")
    study = load(settings, "", elements, layouts=layouts)
    alone = run_study(replace(study, vehicle={**study.vehicle, "sprung_mass": 320.0}), tmp_path / "alone")
    (found,), (expected,) = over.answers, alone.answers
    assert found.status == expected.status
    assert found.value == pytest.approx(expected.value, rel=1e-9)
    assert found.value > 5.0


@pytest.mark.parametrize(
    ("model", "limit", "value", "outputs"),
    [
        ("half-car", "J3", "600 N", {"front tyre": "tyre_front_load", "rear tyre": "tyre_rear_load"}),
        ("half-car", "suspension-travel", "3.5 mm", {"front strut": "front_travel", "rear strut": "rear_travel"}),
        pytest.param(
            *("full-car", "tyre-load", "1500 N"),
            {
                f"{end} {side} tyre": f"tyre_{end}_{side}_load"
                for end in ("front", "rear")
                for side in ("left", "right")
            },
            marks=pytest.mark.campaign,
        ),
        ("quarter-car", "J3", "700 N", {}),
    ],
)
def test_a_limit_on_each_tyre_or_strut_is_named_apart_from_the_index_of_all(
    tmp_path: Path, model: str, limit: str, value: str, outputs: dict[str, str]
) -> None:
    """The value that is shown is of the part that is named, by an index of that output alone; a total is larger."""
    car = "\n".join(f'{key} = "{number!r} {unit}"' for key, (number, unit) in CARS[model].items())
    settings = f'indices = ["J1"]\noptimise = "norm"\nsubject_to = {{ {limit} = {{ at_most = "{value}" }} }}'
    parts = {
        "elements": FREE.replace("10 kN/m", "5 kN/m"),
        "vehicle": car,
        "layouts": 'S1 = "k | c"',
    }
    text = study_text(settings, **parts).replace("quarter-car", model)
    study = load_text(tmp_path, text)
    result = run_study(study, tmp_path / "out")
    best = result.data.sel(layout="S1", index="J1").squeeze("method")
    assert str(best["status"].item()) == "ok"
    kind = next(iter(outputs), "").rpartition(" ")[2]
    assert result.data["limit.each"].values.tolist() == [f"each {kind}" if kind else ""]
    design = study.design("S1").with_values(
        {name: float(best["parameter_value"].sel(parameter=name)) for name in study.design("S1").free_values()}
    )
    alone = {
        part: it.evaluate(design, it.RandomResponse({output: 1.0}, study.road), it.Norm()).value
        for part, output in outputs.items()
    }
    found, part = float(best["limit_value"].item()), str(best["limit.part"].item())
    if alone:
        assert found == pytest.approx(alone[part], rel=1e-6)
        assert found == pytest.approx(max(alone.values()), rel=1e-6)
        assert it.evaluate(design, study.index(limit), it.Norm()).value > 1.1 * found
    said = {"J3": "r.m.s. dynamic tyre load (J3)", "tyre-load": "r.m.s. dynamic tyre load"}.get(
        limit, "r.m.s. suspension travel"
    )
    told = terminal_text(result.data)
    assert max(map(len, told.splitlines())) <= WIDTH
    named = f"{said}, each {kind}, at most" if kind else f"{said} at most"
    page = report(StudyContents(result.data, study), tmp_path)
    for shown in (" ".join(told.split()), " ".join(conclusion_sentences(result.data, study)), page):
        assert named in shown
        assert not kind or f"{said} at most" not in shown
    for shown in (told, page):
        assert not kind or f"({part})" in shown
    with (tmp_path / "out" / "summary.csv").open(encoding="utf-8", newline="") as stream:
        (row,) = csv.DictReader(stream)
    assert float(row[f"{limit} at most [{study.limits[0].unit}]"]) == found
    assert row.get(f"part of {limit} at most") == (part or None)
    (data,) = json.loads("".join(as_text(result)))["designs"]
    (entry,) = data["limits"]
    assert (entry["each"], entry["part"], entry["value"]) == (f"each {kind}" if kind else "", part, found)
    (shown,) = limits_at(study, design_of(study, "S1", data["parameters"]), "norm")
    assert shown.part in (outputs or {"": ""})
    named = f"{said}, {shown.part}, at most " if kind else f"{said} at most "
    assert shown.to_json()["title"].startswith(named)
