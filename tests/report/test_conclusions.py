"""What a study answers: in words of the trade, with ties told as ties, and a static limit as such."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from folders import EXAMPLES
from study_text import study_text
from synthetic import designs, judged, with_value

import inerter as it
from inerter.files.study.loading import load_study
from inerter.files.study.method_labels import method_labels
from inerter.files.study.running import run_study
from inerter.report.conclusions import conclusion_sentences
from inerter.report.verdicts import best_layouts

BY_BOTH = ("norm", "expected-value")


@pytest.fixture(scope="module")
def study():
    return load_study(EXAMPLES / "quarter-car.toml")


def with_losses(study, *losses):
    """The study with these elements in its third layout."""
    parts = {f"part{i}": loss for i, loss in enumerate(losses)}
    layouts = {**study.layouts, "S3": replace(study.layouts["S3"], struts={"strut": " | ".join(["k", *parts])})}
    return replace(study, elements={**study.elements, **parts}, layouts=layouts)


def told_apart(results, study):
    """The results with the words for methods that a run of the study gives them."""
    return results.assign_coords(method_words=("method", list(method_labels(study).values())))


@pytest.mark.parametrize(
    ("losses", "methods", "told"),
    [
        ((), ("norm",), [""]),
        ((), BY_BOTH, ["by exact norms", "by simulation"]),
        ((it.Friction(10.0),), ("norm",), ["without friction"]),
        ((it.Friction(10.0),), BY_BOTH, ["without friction", "with friction"]),
        ((it.Gap(1e-4),), BY_BOTH, ["without backlash", "with backlash"]),
        ((it.Friction(1.0), it.Gap(1e-4)), BY_BOTH, ["without friction or backlash", "with friction and backlash"]),
        (
            (it.Friction(1.0),),
            ("expected-value", "statistical-linearisation"),
            ["with friction by simulation", "with friction by linearisation"],
        ),
        (
            (it.Friction(1.0), it.Gap(1e-4)),
            ("statistical-linearisation", "expected-value"),
            ["with friction, without backlash", "with friction and backlash"],
        ),
    ],
)
def test_methods_are_told_by_what_they_see(study, losses, methods, told):
    assert list(method_labels(replace(with_losses(study, *losses), evaluate=methods)).values()) == told


def test_no_name_of_a_method_is_in_an_answer(study):
    asked = replace(with_losses(study, it.Friction(10.0)), evaluate=BY_BOTH)
    told = conclusion_sentences(told_apart(judged(designs()), asked), asked)
    assert len(told) == 3
    for sentence in told:
        said = r"S3 is .* better than S1 in [a-z ]+ \(J\d\), with its friction; without friction still S3, .* better\."
        assert re.match(said, sentence)
        assert not any(method in sentence for method in BY_BOTH)


def test_another_layout_may_be_the_best_with_friction(study):
    asked = replace(with_losses(study, it.Friction(10.0)), evaluate=BY_BOTH)
    results = told_apart(judged(designs()), asked)
    results["value"].loc[{"layout": "S2", "index": "J1", "method": "expected-value"}] = 1.0
    results["improvement"].loc[{"layout": "S2", "index": "J1", "method": "expected-value"}] = 60.0
    assert (
        "S2 is 60.00 +- 0.31 % better than S1 in ride comfort (J1); without friction S3, 2.266 m/s^2"
        in conclusion_sentences(results, asked)[0]
    )


@pytest.mark.parametrize("seed", range(5))
def test_means_that_their_scatter_does_not_tell_apart_are_ties(seed):
    """Differences of less than t sqrt(e1^2 + e2^2), with the quantile of Student's distribution, from its tables."""
    random = np.random.default_rng(seed)
    results = judged(designs(), ["expected-value"]).assign_coords(elements=("layout", [2, 3, 3]))
    errors = random.uniform(0.05, 0.4, 3)
    results["improvement_error"].loc[{"index": "J1"}] = errors[:, None]
    base = float(results["value"].sel(layout="S1", index="J1").squeeze())
    student = 2.364624  # of seven degrees of freedom, 97.5 %
    margin = student * math.hypot(errors[1], errors[2]) / 100.0 * base
    best = 0.9 * base
    for off, tied in ((0.99, True), (1.01, False)):
        for layout, value in (("S3", best), ("S2", best + off * margin)):
            results["value"].loc[{"layout": layout, "index": "J1"}] = value
        assert best_layouts(results, "J1") == (["S2", "S3"] if tied else ["S3"])


def test_a_layout_that_is_no_better_than_the_baseline_by_chance_is_a_tie():
    results = judged(designs(), ["expected-value"]).assign_coords(elements=("layout", [2, 3, 3]))
    base = float(results["value"].sel(layout="S1", index="J1").squeeze())
    for layout, value in (("S3", base * (1.0 - 0.005)), ("S2", 2.0 * base)):
        results["value"].loc[{"layout": layout, "index": "J1"}] = value
    results["improvement"].loc[{"layout": "S3", "index": "J1"}] = 0.5
    assert best_layouts(results, "J1") == ["S1", "S3"]


SOFT = 'k = "15 kN/m"\nc = { from = "0.1 kN s/m", to = "1000 kN s/m" }\nb = { from = "1 kg", to = "5000 kg" }'


def test_a_static_limit_is_called_that(tmp_path):
    """The body on a soft spring and the tyre gives way by F (1/k + 1/k_t) under a steady force, and by no more if the
    damping is right."""
    text = study_text('indices = ["J5", "J1"]\noptimise = "norm"', elements=SOFT)
    (tmp_path / "soft.toml").write_text(text, encoding="utf-8")
    soft = load_study(tmp_path / "soft.toml")
    result = run_study(soft, tmp_path / "out")
    limit = 1.0 / 15e3 + 1.0 / 150e3
    assert result.data.value.sel(index="J5").values.ravel() == pytest.approx([limit, limit], rel=1e-9)
    told = conclusion_sentences(result.data, soft)
    assert told[0].startswith("S2 is as good as S1 in dynamic load carrying (J5), and no better (difference 0.0 %).")
    assert "73.33 um/N of S1 and S2 is the static limit, which no damper or inerter lowers." in told[0]
    assert "static" not in told[1]
    stiff = replace(soft, elements={**soft.elements, "k": it.Spring(300e3, name="k")})
    assert "static" not in conclusion_sentences(run_study(stiff, tmp_path / "stiff").data, stiff)[0]


def test_values_that_are_not_numbers_are_no_ties(study):
    results = judged(designs(), ["expected-value"])
    results["standard_error"][:] = math.nan
    assert best_layouts(results, "J1") == ["S3"]
    nothing = with_value(designs(), math.nan, layout=["S1", "S2", "S3"], index="J1")
    assert best_layouts(nothing, "J1") == []
    assert conclusion_sentences(nothing, study)[0].startswith("No strut has a finite value of ride comfort (J1).")


@pytest.mark.parametrize("methods", ['["statistical-linearisation"]', '["norm", "statistical-linearisation"]'])
def test_a_single_layout_that_is_its_own_baseline_is_the_best(tmp_path, methods):
    text = study_text(
        f'indices = ["J1"]\nevaluate = {methods}\nbaseline = "S1"',
        elements='k = "20 kN/m"\nc = "1 kN s/m"\nf = "20 N"',
        layouts='S1 = "k | c | f"',
    )
    (tmp_path / "one.toml").write_text(text, encoding="utf-8")
    found = run_study(load_study(tmp_path / "one.toml"), tmp_path / "results", jobs=1)
    assert best_layouts(found.data, "J1") == ["S1"]
    assert any("S1" in sentence for sentence in conclusion_sentences(found.data, found.study, found.answers))


def test_a_difference_within_the_errors_of_the_values_is_no_improvement(tmp_path):
    """Of statistical linearisation, by which S2 is 0.3 % better; simulated it is 1.04 ± 0.16 % worse."""
    text = study_text(
        'indices = ["J1"]\nevaluate = ["statistical-linearisation"]\nbaseline = "S1"',
        vehicle='sprung_mass = "306.3 kg"\nunsprung_mass = "25.38 kg"\ntyre_stiffness = "251.6 kN/m"',
        elements='k = "32.32 kN/m"\nc = "3.385 kN s/m"\nc2 = "2.239 kN s/m"\nf = "190.9 N"',
        layouts='S1 = "k | c"\nS2 = "k | c2 | f"',
    )
    (tmp_path / "close.toml").write_text(text, encoding="utf-8")
    found = run_study(load_study(tmp_path / "close.toml"), tmp_path / "results", jobs=1)
    design = found.data.sel(layout="S2", index="J1").sel({"method": "statistical-linearisation"})
    assert design.status == "ok"
    assert 0.05 < design.improvement < design.improvement_bound
    told = conclusion_sentences(found.data, found.study, found.answers)[0]
    assert told.startswith(
        "S2 is as good as S1 in ride comfort (J1), and no better (difference 0.3 % within errors of up to"
    )


def test_a_limit_that_a_design_breaks_with_friction_is_told_unless_errors_may_have_broken_it(tmp_path):
    """The search has no friction in it; the second method has, and with it a comfort beyond the limit."""
    (tmp_path / "study.toml").write_text(
        study_text(
            'indices = ["J3", "J1"]\noptimise = "norm"\nevaluate = ["norm", "statistical-linearisation"]\n'
            'subject_to = { J1 = { at_most = "2.86 m/s^2" } }',
            vehicle='sprung_mass = "62 kg"\nunsprung_mass = "11.5 kg"\ntyre_stiffness = "105 kN/m"',
            elements='k = "25 kN/m"\nc = { from = "200 N s/m", to = "6 kN s/m" }\n'
            'b = { from = "1 kg", to = "200 kg" }\nf = "80 N"',
            layouts='S = "k | c - (b | f)"',
        )
    )
    study = load_study(tmp_path / "study.toml")
    found = run_study(study, tmp_path / "out").data
    told = " ".join(conclusion_sentences(found, study))
    assert (
        "All designs found satisfy r.m.s. body acceleration (J1) at most 2.86 m/s^2, computed without friction." in told
    )
    broken = re.search(r"By linearisation the limit (.+) is broken: S \(best for J3\) has ([0-9.]+) m/s\^2", told)
    assert broken, told
    assert broken[1] == "r.m.s. body acceleration (J1) at most 2.86 m/s^2"
    c, b = (found["parameter_value"].sel(layout="S", index="J3", parameter=name).item() for name in "cb")
    strut = it.Spring(25e3) | it.Damper(c) - (it.Inerter(b) | it.Friction(80.0))
    car = it.QuarterCar(62.0, 11.5, 105e3, strut)
    direct = it.evaluate(car, study.index("J1"), it.StatisticalLinearisation())
    assert direct.value > 2.86
    assert float(broken[2]) == pytest.approx(direct.value, abs=0.005)  # as printed
    doubted = found.assign(other_error_bound=found["other_error_bound"] * 0.0 + 0.5)
    assert "is broken" not in " ".join(conclusion_sentences(doubted, study))


LIMITED = """baseline = "plain"
subject_to = { J3 = { at_most = "290 N" }, static-stiffness.strut = { at_most = "30 kN/m" } }
"""


def limited_study(tmp_path, keys, method="statistical-linearisation"):
    path = tmp_path / "study.toml"
    path.write_text(
        study_text(
            f'indices = ["J1"]\noptimise = "{method}"\nevaluate = ["{method}"]\n{LIMITED}{keys}',
            vehicle='sprung_mass = "62 kg"\nunsprung_mass = "11.5 kg"\ntyre_stiffness = "105 kN/m"',
            elements='k = "25 kN/m"\nc = { from = "200 N s/m", to = "6 kN s/m" }\nb = "30 kg"\nf = "20 N"',
            layouts='plain = "k | c"\nS = "k | c - (b | f)"',
        )
    )
    return load_study(path)


def test_where_limits_are_not_checked_is_said_beside_numbers_that_are_shown_there(tmp_path):
    """A design that keeps its limit of J3 breaks it at a higher speed, whose comfort the report shows."""
    study = limited_study(tmp_path, 'break_even = ["f"]')
    found = run_study(study, tmp_path / "out").data
    c = found["parameter_value"].sel(layout="S", index="J1", parameter="c").item()
    car = it.QuarterCar(62.0, 11.5, 105e3, it.Spring(25e3) | it.Damper(c) - (it.Inerter(30.0) | it.Friction(20.0)))
    here, faster = (
        it.evaluate(car, it.TyreLoad(it.Road(study.road.roughness, float(speed))), it.StatisticalLinearisation()).value
        for speed in found["at_speeds.speed"].values[1:]
    )
    limit = study.limits[0].value
    assert here <= limit * (1.0 + 1e-6) < 1.02 * limit < faster
    told = conclusion_sentences(found, study)
    assert told[-2].startswith("All designs found satisfy")
    assert told[-1] == (
        "Not checked are the limits at the other speeds and at the break-even values: designs may break them there."
    )


def test_limits_without_numbers_at_other_speeds_or_values_are_checked_wherever_numbers_are_shown(tmp_path):
    study = limited_study(tmp_path, "", "norm")
    told = conclusion_sentences(run_study(study, tmp_path / "out").data, study)
    assert told[-1].startswith("All designs found satisfy")
