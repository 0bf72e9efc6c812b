"""Values of a study in each of its conditions: those of a study of that condition alone, and what is said of them."""

from __future__ import annotations

import csv
import io
import json
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns import sampled
from combinations import Tables, opened, study_tables, with_place
from study_text import HALF_CAR, assert_refused, load_text, study_text

import inerter as it
from inerter.files.study.cases import Outcome, cases, run_case
from inerter.files.study.conditions import CONDITION, IN_CONDITIONS
from inerter.files.study.results import dataset
from inerter.files.study.running import StudyResult, run_study
from inerter.files.study.searching import search_study
from inerter.files.study.study import Study
from inerter.files.study.summary import write_summary
from inerter.report.conditions import condition_tables
from inerter.report.page import report
from inerter.report.sections import design_sections
from inerter.report.study_contents import StudyContents
from inerter.report.study_data import as_text
from inerter.report.text import WIDTH, section_text
from inerter.report.verdicts import study_decision, verdict_sentences

BUS = HALF_CAR.replace('model = "half-car"', "")
LOADS = """[[conditions]]
name = "empty"
share = 0.7
[[conditions]]
name = "laden"
vehicle.sprung_mass = "800 kg"
vehicle.pitch_inertia = "520 kg m^2"
road.speed = "15 m/s"
share = 0.3
"""
STRUTS = 'S1 = "k | c"\nS3 = "k | c3 - b"'
PARTS = 'k = "40 kN/m"\nc = "1 kN s/m"\nc3 = "1.5 kN s/m"\nb = "140 kg"'


def bus(folder: Path, settings: str = 'indices = ["J1"]', loads: str = LOADS, parts: str = PARTS) -> Study:
    """A car of two axles, which follow each other, empty and laden."""
    text = study_text(settings, vehicle=BUS, elements=parts, layouts=STRUTS)
    text = text.replace('model = "quarter-car"', 'model = "half-car"').replace("[study]", f"{loads}[study]")
    return load_text(folder, text)


def computed(study: Study) -> Any:
    """Results of all cases of a study."""
    return dataset(study, {case: run_case(study, case) for case in cases(study)})


def alone(tables: Tables, condition: dict[str, Any], folder: Path) -> Any:
    """Results of the study with the numbers of one condition in place of its own, and without conditions."""
    own = deepcopy({key: entry for key, entry in tables.items() if key != "conditions"})
    own["study"].pop("conditions", None)
    for place, quantity in condition.items():
        if place not in ("share", "name"):
            own = with_place(own, place, quantity)
    return computed(opened(own, folder))


def fixed(tables: Tables, rng: np.random.Generator) -> Tables:
    """The study without design variables, each at a value between its bounds, and a second strut to compare with."""
    found = deepcopy(tables)
    for name, entry in found["elements"].items():
        if isinstance(entry, dict) and "from" in entry:
            low, high = (float(entry[end].split()[0]) for end in ("from", "to"))
            value = float(np.exp(rng.uniform(np.log(low), np.log(high))))
            found["elements"][name] = f"{value!r} {entry['from'].split(maxsplit=1)[1]}"
    found["elements"] |= {"k0": "55000.0 N/m", "c0": "2500.0 N s/m"}
    found["layouts"]["base"] = "k0 | c0"
    found["study"] = {"indices": ["J1", "J3"], "baseline": "base", "conditions": tables["study"]["conditions"]}
    return found


SEEDS = [seed for seed in range(60) if "conditions" in study_tables(seed)]


@pytest.mark.parametrize("seed", sampled(SEEDS, [1, 16], often=[2, 18], kept=0))
def test_the_value_in_a_condition_is_that_of_a_study_of_it_alone(seed: int, tmp_path: Path) -> None:
    """Of random vehicles with one axle or more, dependent values, seats, mechanisms, and conditions of any number."""
    tables = fixed(study_tables(seed), np.random.default_rng([seed, 81]))
    found = computed(opened(tables, tmp_path)).squeeze("method")
    each = [alone(tables, condition, tmp_path).squeeze("method") for condition in tables["conditions"]]
    for name in ("value", "improvement"):
        expected = np.stack([one[name].values for one in each], axis=-1)
        np.testing.assert_allclose(found[f"{IN_CONDITIONS}{name}"].values, expected, rtol=1e-9, atol=1e-7)
    values = found[f"{IN_CONDITIONS}value"].values
    shares = np.array([condition["share"] for condition in tables["conditions"]])
    over = values.max(axis=-1) if tables["study"]["conditions"] == "worst" else values @ shares / shares.sum()
    np.testing.assert_allclose(found["value"].values, over, rtol=1e-9)


@pytest.mark.parametrize("over", ["mean", "worst"])
def test_a_quantile_in_a_condition_is_that_of_a_study_of_it_alone(over: str, tmp_path: Path) -> None:
    """By an independent sample of the values, sixteen times as large."""
    settings = f'indices = ["J1"]\noptimise = "norm"\nconditions = "{over}"\nquantile = 0.9\ntolerance = {{ c = 0.3 }}'
    loads = '[[conditions]]\n[[conditions]]\nvehicle.sprung_mass = "400 kg"\nroad.speed = "15 m/s"\n'
    free = 'k = "20 kN/m"\nc = { from = "0.5 kN s/m", to = "5 kN s/m" }'
    text = study_text(settings, elements=free, layouts='S1 = "k | c"').replace("[study]", f"{loads}[study]")
    study, c = load_text(tmp_path, text), 900.0
    found = it.evaluate(study.design("S1").with_values({"c": c}), study.resolve_index("J1", "S1"), it.Norm())
    for place, (mass, speed) in enumerate([(250.0, 25.0), (400.0, 15.0)]):
        car = it.QuarterCar(mass, 35.0, 150e3, it.Spring(20e3) | it.Damper(c))
        comfort = it.RideComfort(it.Road(5e-7, speed))
        drawn = it.tolerance_analysis(car, comfort, it.Norm(), spread={"c": 0.3}, samples=4096, seed=5)
        expected, nominal = drawn.quantile(0.9), drawn.nominal.value
        there = found.in_conditions[place]
        assert there.standard_error is not None
        assert abs(there.value - expected) < 4.0 * there.standard_error < 0.5 * abs(expected - nominal)


@pytest.mark.campaign
def test_the_best_design_has_the_values_of_studies_of_single_conditions(tmp_path: Path) -> None:
    """Those are studies of its values alone: of the bus, and of a second strut to compare with."""
    free = PARTS.replace('"1 kN s/m"', '{ from = "0.5 kN s/m", to = "5 kN s/m" }')
    free = free.replace('"1.5 kN s/m"', '{ from = "0.5 kN s/m", to = "5 kN s/m" }')
    found = computed(bus(tmp_path, 'indices = ["J1"]\noptimise = "norm"', parts=free)).squeeze()
    c, c3 = (float(found["parameter_value"].sel(layout=x, parameter=y)) for x, y in (("S1", "c"), ("S3", "c3")))
    parts = PARTS.replace('"1 kN s/m"', f'"{c!r} N s/m"').replace('"1.5 kN s/m"', f'"{c3!r} N s/m"')
    laden = f"[[conditions]]\n{LOADS.partition('laden')[2].removeprefix(chr(34))}"
    for place, loads in enumerate(["", laden]):
        values = computed(bus(tmp_path, loads=loads, parts=parts))["value"].squeeze()
        np.testing.assert_allclose(found[f"{IN_CONDITIONS}value"][:, place], values, rtol=1e-9)


def test_a_design_that_is_worse_in_a_condition_is_said_to_be(tmp_path: Path) -> None:
    """In the verdict, in the table of each form of results, and by how much: better in the mean says nothing of it."""
    study = bus(tmp_path)
    results = computed(study)
    (empty, laden) = results[f"{IN_CONDITIONS}improvement"].values[1, 0, 0]
    assert laden < -0.5 < 0.5 < results["improvement"].values[1, 0, 0] < empty
    (paragraph,) = verdict_sentences(results, study)
    told = f"S3 is {-laden:.1f} % worse than S1 in condition laden."
    assert paragraph.endswith(told)
    assert study_decision(results, "J1", study).verdict.answer.value == "answer"
    text = section_text(design_sections(results))
    lines = [line.split() for line in text.splitlines()]
    values = results[f"{IN_CONDITIONS}value"].values[:, 0, 0]
    for name, share, column in (("empty", "70", 0), ("laden", "30", 1)):
        at = next(i for i, line in enumerate(lines) if line[:3] == [name, share, "%"])
        assert [float(cell) for cell in lines[at][3:]] == pytest.approx(values[:, column], rel=1e-3)
        assert lines[at + 1][0] == f"{results[f'{IN_CONDITIONS}improvement'].values[1, 0, 0, column]:+.1f}"
    assert max(map(len, text.splitlines())) <= WIDTH
    page = report(StudyContents(results, study), tmp_path)
    assert "Operating conditions" in page
    assert f"{-laden:.1f}" in page


def test_all_forms_of_results_have_the_values_in_each_condition(tmp_path: Path) -> None:
    study = bus(tmp_path)
    results = computed(study)
    values = results[f"{IN_CONDITIONS}value"].values[:, 0, 0]
    assert results[CONDITION].values.tolist() == ["empty", "laden"]
    assert results[f"{IN_CONDITIONS}share"].values.tolist() == [0.7, 0.3]
    data = json.loads("".join(as_text(StudyResult(tmp_path, study, results, 2))))
    told = [[(one["condition"], one["value"]) for one in design["in_conditions"]] for design in data["designs"]]
    assert told == [[("empty", one[0]), ("laden", one[1])] for one in values.tolist()]
    caveat = data["verdicts"][0]["caveats"][-1]
    assert (caveat["kind"], caveat["severity"]) == ("condition", "warning")
    assert caveat["sentence"].endswith("in condition laden.")
    write_summary(tmp_path / "summary.csv", study, results)
    rows = list(csv.DictReader(io.StringIO((tmp_path / "summary.csv").read_text(encoding="utf-8"))))
    assert [[float(row[f"value in {name}"]) for name in ("empty", "laden")] for row in rows] == values.tolist()
    better = results[f"{IN_CONDITIONS}improvement"].values[1, 0, 0, 1]
    assert float(rows[1]["improvement in laden_percent"]) == better


def test_of_many_conditions_a_terminal_has_the_best_and_the_worst(tmp_path: Path) -> None:
    """And a verdict the number of those in which a design is worse, with the largest difference."""
    laden = 'vehicle.pitch_inertia = "520 kg m^2"\nroad.speed = "15 m/s"'
    masses = range(650, 1000, 50)
    loads = [f'[[conditions]]\nvehicle.sprung_mass = "{mass} kg"\n{laden}\n' for mass in masses]
    study = bus(tmp_path, loads="".join(["[[conditions]]\nshare = 20\n", *loads]))
    results = computed(study)
    (better,) = results[f"{IN_CONDITIONS}improvement"].values[1, :, 0]
    text = " ".join(section_text(design_sections(results)).split())
    best, worst = int(np.argmax(better)), int(np.argmin(better))
    assert f"S3 {better[best]:+.1f} % in condition {best + 1} {better[worst]:+.1f} % in condition {worst + 1}" in text
    assert max(map(len, section_text(design_sections(results)).splitlines())) <= WIDTH
    (table,) = condition_tables(results)
    assert [row.cells[0].text for row in table.rows] == [*map(str, range(1, 9)), "mean"]
    lost = int((better < -0.05).sum())
    assert lost > 3
    (paragraph,) = verdict_sentences(results, study)
    told = f"S3 is worse than S1 in {lost} of 8 conditions, by {-better[worst]:.1f} % in condition {worst + 1}."
    assert paragraph.endswith(told)


def test_over_a_sweep_it_is_said_where_a_design_is_worse_in_a_condition(tmp_path: Path) -> None:
    sweep = 'indices = ["J1"]\nsweep = { k = ["30 kN/m", "40 kN/m", "60 kN/m"] }'
    results = computed(bus(tmp_path, sweep))
    better = results["improvement"].values[1, 0, :, 0]
    each = results[f"{IN_CONDITIONS}improvement"].values[1, 0, :, 0]
    count = int(((better > 0.0) & (each[:, 1] < -0.05)).sum())
    assert count > 0
    text = " ".join(section_text(design_sections(results)).split())
    assert f"J1: S3, better over all conditions, is worse than S1 in condition laden at {count} of 3 points." in text
    assert "Values in each condition are in summary.csv and results.nc." in text


def test_results_without_values_in_conditions_are_shown_as_before(tmp_path: Path) -> None:
    """As are those of folders that an earlier version wrote, and those of one condition."""
    study = bus(tmp_path)
    results = computed(study)
    former = results.drop_vars([name for name in results.variables if str(name).startswith(IN_CONDITIONS)])
    assert condition_tables(former) == []
    assert "Operating conditions" not in [section.title for section in design_sections(former)]
    assert verdict_sentences(former, study)[0] == verdict_sentences(results, study)[0].partition(" S3 is ")[0]
    one = computed(bus(tmp_path, loads=LOADS.partition('[[conditions]]\nname = "laden"')[0]))
    assert condition_tables(one) == []


def test_outcomes_of_conditions_survive_a_journal(tmp_path: Path) -> None:
    study = bus(tmp_path)
    (case, *_) = cases(study)
    outcome = run_case(study, case)
    again = Outcome(**json.loads(json.dumps(outcome.to_json())))
    assert again.in_conditions == outcome.in_conditions
    np.testing.assert_equal(dataset(study, {case: again}).to_dict(), dataset(study, {case: outcome}).to_dict())


@pytest.mark.campaign
def test_improvements_in_conditions_are_differences_on_the_same_roads(tmp_path: Path) -> None:
    """Of a device with friction by random simulation: as Python compares the two designs in that condition alone."""
    settings = 'indices = ["J1"]\nevaluate = ["expected-value"]\nrealisations = 4'
    parts, struts = f'{PARTS}\nf = "40 N"', 'S1 = "k | c"\nS3 = "k | c3 - (b | f)"'
    loads = '[[conditions]]\n[[conditions]]\nvehicle.sprung_mass = "400 kg"\nroad.speed = "15 m/s"\n'
    text = study_text(settings, elements=parts, layouts=struts).replace("[study]", f"{loads}[study]")
    results = computed(load_text(tmp_path, text))
    for place, (mass, speed) in enumerate([(250.0, 25.0), (400.0, 15.0)]):
        k = it.Spring(40e3)
        struts_there = k | it.Damper(1.5e3) - (it.Inerter(140.0) | it.Friction(40.0)), k | it.Damper(1e3)
        cars = [it.QuarterCar(mass, 35.0, 150e3, strut) for strut in struts_there]
        comfort = it.RideComfort(it.Road(5e-7, speed))
        method = it.ExpectedValue(realisations=4)
        value = it.evaluate(cars[0], comfort, method)
        two = it.compare(*cars, comfort, method)
        there = results.isel({CONDITION: place}).sel(layout="S3").squeeze()
        assert float(there[f"{IN_CONDITIONS}value"]) == pytest.approx(value.value, rel=1e-12)
        assert float(there[f"{IN_CONDITIONS}standard_error"]) == pytest.approx(value.standard_error, rel=1e-9)
        error = float(there[f"{IN_CONDITIONS}improvement_error"])
        assert abs(-float(there[f"{IN_CONDITIONS}improvement"]) - two.percent) < 3.0 * (error + two.percent_error)


def test_a_name_that_is_the_number_of_another_condition_is_refused(tmp_path: Path) -> None:
    loads = '[[conditions]]\nname = "2"\n[[conditions]]\nroad.speed = "9 m/s"\n'
    assert_refused(lambda: bus(tmp_path, loads=loads), "conditions[1].name", ["'2', the name of another condition"])
    study = bus(tmp_path, loads=loads.replace('"2"', '"1"'))
    assert replace(study).conditions[0].name == "1"


def test_fronts_and_break_even_values_are_those_of_each_condition(tmp_path: Path) -> None:
    """Of a car whose mass and speed a condition changes, as Python finds them for the car in that condition alone."""
    loads = '[[conditions]]\nname = "empty"\n[[conditions]]\nvehicle.sprung_mass = "400 kg"\nroad.speed = "15 m/s"\n'
    free = 'k = "40 kN/m"\nc = "1.2 kN s/m"\nc3 = { from = "1 kN s/m", to = "2 kN s/m" }\nb = "140 kg"'
    settings = 'indices = ["J1"]\noptimise = "norm"\nbreak_even = ["b"]\ntrade_off = ["J1", "J3"]\npoints = 3'
    text = study_text(settings, elements=free, layouts=STRUTS).replace("[study]", f"{loads}[study]")
    study = load_text(tmp_path, text)
    found = run_study(study, tmp_path / "out")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "out" / "budgets.csv").read_text(encoding="utf-8"))))
    assert [row["condition"] for row in rows] == ["", "empty", "2"]
    points = list(csv.DictReader(io.StringIO((tmp_path / "out" / "fronts.csv").read_text(encoding="utf-8"))))
    c3 = float(found.data["parameter_value"].sel(layout="S3", parameter="c3").item())
    k = it.Spring(40e3)
    for place, (mass, speed, row) in enumerate([(250.0, 25.0, rows[1]), (400.0, 15.0, rows[2])]):
        road = it.Road(5e-7, speed)
        best = it.QuarterCar(mass, 35.0, 150e3, k | it.Damper(c3) - it.Inerter(140.0, name="b"))
        base = it.QuarterCar(mass, 35.0, 150e3, k | it.Damper(1.2e3))
        expected = it.break_even(best, base, it.RideComfort(road), parameter="b", method=it.Norm(), bounds=(0.14, 14e3))
        assert float(row["value"]) == pytest.approx(expected.value, rel=1e-8)
        for point in points:
            car = replace(best, strut=k | it.Damper(float(point["c3 [N s/m]"])) - it.Inerter(140.0))
            for name, index in (("J1", it.RideComfort(road)), ("J3", it.TyreLoad(road))):
                value = it.evaluate(car, index, it.Norm()).value
                there = found.data["front_in_conditions"].sel(layout="S3", criterion=name)
                assert float(there[int(point["point"]) - 1, place]) == pytest.approx(value, rel=1e-9)
                assert float(point[f"{name} in {('empty', '2')[place]}"]) == pytest.approx(value, rel=1e-9)


def test_networks_of_a_search_have_values_in_each_condition(tmp_path: Path) -> None:
    loads = '[[conditions]]\nshare = 3\n[[conditions]]\nvehicle.sprung_mass = "400 kg"\nroad.speed = "15 m/s"\n'
    parts = 'k = "40 kN/m"\nc = { network = 1, dampers = { from = "1 kN s/m", to = "2 kN s/m" } }'
    settings = 'indices = ["J1"]\noptimise = "norm"\ntrade_off = ["J1", "J3"]\npoints = 3'
    text = study_text(settings, elements=parts, layouts='S = "k | c"').replace("[study]", f"{loads}[study]")
    search_study(load_text(tmp_path, text), tmp_path / "out")
    tables = {
        name: list(csv.DictReader(io.StringIO((tmp_path / "out" / name).read_text(encoding="utf-8"))))
        for name in ("search.csv", "search_front.csv")
    }
    for number, (mass, speed) in enumerate([(250.0, 25.0), (400.0, 15.0)], 1):
        for row, index, key in [
            *((row, row["index"], f"value in {number}") for row in tables["search.csv"]),
            *((row, index, f"{index} in {number}") for row in tables["search_front.csv"] for index in ("J1", "J3")),
        ]:
            car = it.QuarterCar(mass, 35.0, 150e3, it.Spring(40e3) | it.Damper(float(row["c1 [N s/m]"])))
            road = it.Road(5e-7, speed)
            wanted = it.RideComfort(road) if index == "J1" else it.TyreLoad(road)
            assert float(row[key]) == pytest.approx(it.evaluate(car, wanted, it.Norm()).value, rel=1e-9)
    assert len(tables["search_front.csv"]) >= 2
