"""A best design at one speed says what it becomes at 0.8 and 1.2 of it, and doubts itself first where it loses much."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
import xarray as xr
from campaigns import sampled
from combinations import CARS
from study_text import load_text, study_text

import inerter as it
from inerter.errors import DesignError, Status, StatusKind
from inerter.files.common.entries import element_name
from inerter.files.common.problem import EntryError
from inerter.files.study.cases import Case, cases, run_case
from inerter.files.study.results import dataset
from inerter.files.study.running import StudyResult
from inerter.formatting import format_percent_size, format_quantity
from inerter.methods.error_bounds import improvement_bound
from inerter.methods.method import Estimate
from inerter.networks.elements.values import NAME
from inerter.report.conclusions import conclusion_sentences
from inerter.report.study_data import as_text

QUARTER = {"vehicle": 'sprung_mass = "250 kg"\nunsprung_mass = "35 kg"\ntyre_stiffness = "150 kN/m"'}


def half_car(number, study='indices = ["J1"]\nbaseline = "S1"', road=""):
    """A random half car with a usual strut and one with an inerter in series with its damper, all with given values."""
    rng = np.random.default_rng([808, number])
    vehicle = {key: (value * float(rng.uniform(0.8, 1.25)), unit) for key, (value, unit) in CARS["half-car"].items()}
    c, b = (float(np.exp(rng.uniform(np.log(low), np.log(high)))) for low, high in ((800, 5e3), (20, 300)))
    text = "\n".join(f'{key} = "{value!r} {unit}"' for key, (value, unit) in vehicle.items())
    return f"""
[vehicle]
model = "half-car"
{text}
[road]
speed = "{float(rng.uniform(8.0, 35.0))!r} m/s"
roughness = "5e-7 m^3/cycle"
{road}
[elements]
k = "{float(rng.uniform(15e3, 60e3))!r} N/m"
c = "{c!r} N s/m"
b = "{b!r} kg"
f = "20 N"
[layouts]
S1 = "k | c"
S3 = "k | c - b | c"
S4 = "k | c | f"
[study]
{study}
"""


def found(tmp_path, text):
    study = load_text(tmp_path, text)
    results = dataset(study, {case: run_case(study, case) for case in cases(study)})
    return study, results


def at(study, factor):
    return replace(study, road=replace(study.road, speed=factor * study.road.speed))


@pytest.mark.parametrize("number", range(6))
def test_the_answer_tells_what_designs_of_half_cars_become_at_other_speeds(number, tmp_path):
    study, results = found(tmp_path, half_car(number))
    told = json.loads("".join(as_text(StudyResult(tmp_path, study, results, 3))))["designs"]
    values = {}
    for i, factor in enumerate((0.8, 1.0, 1.2)):
        there = at(study, factor)
        for layout in study.layouts:
            car, asked = there.design(layout), it.RideComfort(there.road)
            values[layout, i] = it.evaluate(car, asked, it.Norm()).value
            own = results["at_speeds.value"].sel(layout=layout, index="J1").values[i]
            assert own == pytest.approx(values[layout, i], rel=1e-12)
    for design in told:
        (slow, fast), layout = design["at_speeds"], design["layout"]
        for one, i in ((slow, 0), (fast, 2)):
            better = 100.0 * (1.0 - values[layout, i] / values["S1", i])
            assert one["speed"] == pytest.approx((0.8, 1.0, 1.2)[i] * study.road.speed)
            assert one["improvement_percent"] == pytest.approx(better, abs=1e-9)
    best = min(study.layouts, key=lambda layout: values[layout, 1])
    gains = [100.0 * (1.0 - values[best, i] / values["S1", i]) for i in range(3)]
    scaled = [values[best, i] / values[best, 1] / math.sqrt((0.8, 1.0, 1.2)[i]) for i in (0, 2)]
    lost = (best != "S1" and gains[1] >= 0.05 and min(gains[0], gains[2]) < 0.5 * gains[1]) or max(scaled) > 1.1
    sentences = conclusion_sentences(results, study)
    assert sentences[0].startswith("Not certain away from") == lost
    (sentence,) = [one for one in sentences if "km/h" in one and one.count("km/h") >= 3]
    for speed in (0.8, 1.2):
        assert f"{3.6 * speed * study.road.speed:.4g} km/h" in sentence


def test_what_is_tuned_to_one_speed_is_doubted_first(tmp_path):
    """Some of the family lose half of what they gain, or gain more than the speed explains; others do not."""
    doubts = set()
    for number in range(12):
        study, results = found(tmp_path, half_car(number, 'indices = ["J1", "J3"]\nbaseline = "S1"'))
        doubts.add(conclusion_sentences(results, study)[0].startswith("Not certain away from"))
        if len(doubts) == 2:
            break
    assert doubts == {True, False}


@pytest.mark.campaign
def test_with_friction_the_same_method_values_other_speeds_and_one_that_simulates_is_replaced(tmp_path):
    asked = 'indices = ["J1"]\nbaseline = "S1"\nevaluate = ["{}"]'
    for method in ("statistical-linearisation", "expected-value"):
        text = half_car(1, asked.format(method) + ("\nrealisations = 2" if method == "expected-value" else ""))
        study, results = found(tmp_path, text)
        assert results["at_speeds.value"].attrs["methods"] == "statistical-linearisation"
        there = at(study, 1.2)
        value = it.evaluate(there.design("S4"), it.RideComfort(there.road), it.StatisticalLinearisation()).value
        assert results["at_speeds.value"].sel(layout="S4", index="J1").values[2] == pytest.approx(value, rel=1e-12)
        assert any("by linearisation" in sentence for sentence in conclusion_sentences(results, study))


def test_values_at_other_speeds_have_the_digits_that_their_errors_bear(tmp_path):
    """Friction by linearisation: a value is known to some per cent, and as are its improvements."""
    asked = 'indices = ["J1"]\nbaseline = "S1"\nevaluate = ["statistical-linearisation"]'
    study, results = found(
        tmp_path, half_car(4, asked).replace('f = "20 N"', 'f = "60 N"').replace('S3 = "k | c - b | c"', "")
    )
    told = json.loads("".join(as_text(StudyResult(tmp_path, study, results, 3))))["designs"]
    for i, factor in ((0, 0.8), (2, 1.2)):
        there = at(study, factor)
        with_friction, without = (
            it.evaluate(there.design(name), it.RideComfort(there.road), it.StatisticalLinearisation())
            for name in ("S4", "S1")
        )
        assert with_friction.error_bound > 0.01
        here = results.sel({"layout": "S4", "index": "J1"}).isel({"at_speeds.speed": i})
        assert float(here["at_speeds.error_bound"]) == pytest.approx(with_friction.error_bound, rel=1e-9)
        bound = improvement_bound(with_friction.value, without.value, with_friction.error_bound, without.error_bound)
        assert float(here["at_speeds.improvement_bound"]) == pytest.approx(bound, rel=1e-6)
        (design,) = [one for one in told if one["layout"] == "S4"]
        assert design["at_speeds"][i // 2]["error_bound"] == pytest.approx(with_friction.error_bound, rel=1e-9)
    (sentence,) = [one for one in conclusion_sentences(results, study) if one.count("km/h") >= 3]
    (value, known), (better, bound) = (
        [float(results[f"at_speeds.{name}"].sel(layout="S4", index="J1")[0]) for name in names]
        for names in (("value", "error_bound"), ("improvement", "improvement_bound"))
    )
    speed = format_quantity(0.8 * 3.6 * study.road.speed, "km/h")
    much = f"{format_percent_size(better, bound=bound)} better than S1"
    assert f"{format_quantity(value, 'm/s^2', bound=known)} at {speed} ({much})" in sentence


@pytest.mark.parametrize(
    "text",
    [
        study_text('indices = ["J1", "J3"]', **QUARTER),
        half_car(0, 'indices = ["J5"]'),
        half_car(0, 'indices = ["J1"]\nsweep = { "road.speed" = ["20 m/s", "30 m/s"] }'),
        half_car(0).replace("[study]", '[[conditions]]\n"road.speed" = "20 m/s"\n[[conditions]]\n[study]'),
    ],
    ids=["quarter car", "peak gain", "sweep", "conditions"],
)
def test_where_speed_only_scales_or_is_varied_nothing_is_said(text, tmp_path):
    study, results = found(tmp_path, text)
    assert "at_speeds.value" not in results or not np.isfinite(results["at_speeds.value"]).any()
    assert not any("by exact norms" in one and "km/h" in one for one in conclusion_sentences(results, study))


def test_over_a_sweep_the_answer_is_about_the_place_that_it_names(tmp_path):
    text = half_car(2, 'indices = ["J1"]\nbaseline = "S1"\nsweep = { k = ["20 kN/m", "40 kN/m"] }')
    study, results = found(tmp_path, text)
    assert results["at_speeds.value"].dims == ("layout", "index", "k", "at_speeds.speed")
    there = at(study, 0.8).design("S3", 20e3)
    value = it.evaluate(there, it.RideComfort(at(study, 0.8).road), it.Norm()).value
    assert results["at_speeds.value"].sel(layout="S3", index="J1", k=20e3).values[0] == pytest.approx(value, rel=1e-12)
    assert any("k = " in one and one.count("km/h") >= 3 for one in conclusion_sentences(results, study))
    assert Case("S3", "J1") in list(cases(study))


def test_values_that_their_method_doubts_are_told_so_first(tmp_path):
    """Friction that sticks for a part of the time: linearisation says of itself that it may be off."""
    text = half_car(1, 'indices = ["J1"]\nbaseline = "S4"\nevaluate = ["statistical-linearisation"]')
    text = text.replace('f = "20 N"', 'f = "400 N"')
    study, results = found(tmp_path, text)
    there = at(study, 0.8)
    doubted = [
        not it.evaluate(there.design(layout), it.RideComfort(there.road), it.StatisticalLinearisation()).status.ok
        for layout in study.layouts
    ]
    assert any(doubted)
    for layout, is_doubted in zip(study.layouts, doubted, strict=True):
        message = results["at_speeds.message"].sel(layout=layout, index="J1").item()
        assert message.startswith("inaccurate") or not is_doubted
    assert any("friction" in message for message in results["at_speeds.message"].sel(index="J1").values)
    assert conclusion_sentences(results, study)[0].startswith("Not certain at other speeds: inaccurate")


REASONS = {
    "a refusal": (DesignError("No equilibrium is known."), "No equilibrium is known"),
    "a singular matrix": (np.linalg.LinAlgError("Singular matrix"), "Singular matrix"),
    "a failed status": (
        Estimate(math.nan, "m/s^2", Status(StatusKind.FAILED, "no convergence after 50 steps")),
        "no convergence after 50 steps",
    ),
    "an infinite value": (Estimate(math.inf, "m/s^2"), "without bounds"),
}


@pytest.mark.parametrize(
    ("why", "factor"),
    sampled(product(REASONS, [0.8, 1.2]), [(why, (0.8, 1.2)[i % 2]) for i, why in enumerate(REASONS)]),
)
def test_what_cannot_be_computed_at_another_speed_is_said(why, factor, tmp_path, monkeypatch):
    """Before, the sentence about other speeds was left out without a word."""
    result, words = REASONS[why]

    def fails(vehicle, index, method):
        if not math.isclose(index.road.speed, factor * own.road.speed):
            return it.evaluate(vehicle, index, method)
        if isinstance(result, Exception):
            raise result
        return result

    text = half_car(1)
    own = load_text(tmp_path, text)
    monkeypatch.setattr("inerter.files.study.speeds.evaluate", fails)
    study, results = found(tmp_path, text)
    sentence = conclusion_sentences(results, study)[0]
    assert sentence.startswith("Not certain away from ")
    assert f"could not be computed: at {3.6 * factor * own.road.speed:.4g} km/h" in sentence
    assert words in sentence
    told = json.loads("".join(as_text(StudyResult(tmp_path, study, results, 3))))["designs"]
    for design in told:
        values = [one["value"] for one in design["at_speeds"]]
        assert [value is None for value in values] == [factor == 0.8, factor == 1.2]
        assert all(words in one["message"] for one in design["at_speeds"])


def test_what_takes_more_digits_than_double_precision_is_not_asked_at_other_speeds(tmp_path):
    """A norm without rounding takes up to seconds: one is worth it, and six more of each design are not."""
    text = re.sub(r'\nunsprung_mass_front = "[^"]*"', '\nunsprung_mass_front = "1e30 kg"', half_car(3))
    _, results = found(tmp_path, text)
    assert np.isnan(results["at_speeds.value"].sel(layout="S1")).all()
    assert "more digits than double precision" in str(results["at_speeds.message"].sel(layout="S1").item())
    assert np.isfinite(results["value"].sel(layout="S1")).all()


@pytest.mark.parametrize(
    "name", sampled(["speed", "speed_value", "speed_message", "at_speeds", "v"], ["speed"], kept=1)
)
def test_an_element_of_any_name_that_results_do_not_use_can_be_swept(name, tmp_path):
    """Also one that is called as what results say of other speeds is."""
    text = half_car(2, f'indices = ["J1"]\nsweep = {{ {name} = ["20 kN/m", "40 kN/m"] }}')
    text = re.sub(r"(?<![\w])k(?![\w/])", name, text)
    _, results = found(tmp_path, text)
    assert results["value"].dims[:3] == ("layout", "index", name)
    assert np.isfinite(results["at_speeds.value"]).all()
    results.to_netcdf(tmp_path / "results.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "results.nc") as again:
        assert again[name].values.tolist() == [20e3, 40e3]


def test_names_of_results_are_refused_for_elements_or_cannot_be_names(tmp_path):
    """So no dimension of a sweep stands for two things."""
    _, results = found(tmp_path, half_car(2, 'indices = ["J1"]\nsweep = { k = ["20 kN/m", "40 kN/m"] }'))
    assert "at_speeds.value" in results
    for name in {*map(str, results.variables), *map(str, results.dims)} - {"k"}:
        if NAME.fullmatch(name):
            with pytest.raises(EntryError):
                element_name(name)
