"""Tolerances of study files: what becomes of the best designs is what Python says of them."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from study_text import assert_refused, assert_survives, load_text, study_text

import inerter as it
from inerter.errors import StudyError
from inerter.files.common.toml import read_tables
from inerter.files.study.checking import check_lines
from inerter.files.study.loading import load_study
from inerter.files.study.running import StudyResult, run_study
from inerter.files.study.study import Study
from inerter.files.study.tasks import TaskResults
from inerter.report.page import report
from inerter.report.study_contents import StudyContents
from inerter.report.study_data import as_text
from inerter.report.text import table_lines
from inerter.tasks.tolerances import ToleranceAnswer, Tolerances

FREE = """k = "30 kN/m"
c = { from = "100 N s/m", to = "100 kN s/m" }
b = { from = "1 kg", to = "2000 kg" }"""
ASK = 'indices = ["J1"]\noptimise = "norm"\n'
SPREAD = 'tolerance = { c = "10 %", elements.b = 0.05, vehicle.sprung_mass = "20 %" }\n'


def study_of(folder: Path, settings: str, elements: str = FREE) -> Study:
    return load_text(folder, study_text(settings, elements=elements))


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    folder = tmp_path_factory.mktemp("tolerance")
    return run_study(study_of(folder, ASK + 'tolerance = { c = "10 %", elements.b = 0.05 }\n'), folder / "out")


SAMPLING = {"standard_deviation": 0.0021, "quantile": 0.017}  # standard errors


@pytest.mark.parametrize(
    ("error", "bound", "sampling", "told"),
    [
        (None, 1e-12, {}, ["2.509 m/s^2", "0.04567 m/s^2", "2.588 m/s^2"]),
        (None, 0.02, {}, ["2.5 m/s^2", "0.046 m/s^2", "2.6 m/s^2"]),
        (0.0123, 1e-6, {}, ["2.509 +- 0.012 m/s^2", "0.04567 +- 0.00022 m/s^2", "2.588 +- 0.013 m/s^2"]),
        (0.0, None, {}, ["2.509 m/s^2", "0.04567 m/s^2", "2.588 m/s^2"]),
        (None, 1e-12, SAMPLING, ["2.509 m/s^2", "0.046 m/s^2", "2.59 m/s^2"]),
        (None, None, SAMPLING, ["2.509 m/s^2", "0.046 m/s^2", "2.59 m/s^2"]),
        (0.0123, 1e-6, SAMPLING, ["2.509 +- 0.012 m/s^2", "0.0457 +- 0.0021 m/s^2", "2.588 +- 0.017 m/s^2"]),
    ],
)
def test_values_have_the_digits_that_their_errors_allow(
    error: float, bound: float, sampling: dict[str, float], told: list[str]
) -> None:
    numbers = {"nominal": 2.5094, "standard_deviation": 0.04567, "quantile": 2.5876}
    answer = ToleranceAnswer(
        layout="S1", index="J1", method="m", unit="m/s^2", numbers=numbers, effects={}, standard_error=error,
        error_bound=bound, errors=sampling, status="ok", message="",
    )  # fmt: skip
    assert [str(answer.quantity(name)) for name in numbers] == told


def test_a_tolerance_is_that_of_python(found: StudyResult) -> None:
    (first, second) = found.answers
    assert (first.layout, second.layout) == ("S1", "S2")
    best = found.data.sel(layout="S2", index="J1").squeeze("method")
    values = dict(zip(("c", "b"), best["parameter_value"].values.tolist(), strict=True))
    by_hand = it.tolerance_analysis(
        found.study.design("S2").with_values(values),
        it.RideComfort(found.study.road),
        it.Norm(),
        spread={"c": 0.1, "b": 0.05},
        seed=0,
    )
    assert second.numbers["mean"] == by_hand.mean
    assert second.numbers["quantile"] == by_hand.quantile(0.95)
    assert second.errors["mean"] == by_hand.standard_errors["mean"]
    assert second.errors["quantile"] == by_hand.quantile_estimate(0.95).standard_error
    assert second.effects == {name: [by_hand.first_order[name], by_hand.total_order[name]] for name in ("c", "b")}
    assert list(first.effects) == ["c"]
    with (found.folder / "tolerances.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["layout"] for row in rows] == ["S1", "S2"]
    assert float(rows[1]["quantile_0.95"]) == by_hand.quantile(0.95)
    assert rows[0]["main effect of b"] == ""


def test_a_tolerance_is_told(found: StudyResult, tmp_path: Path) -> None:
    table = Tolerances().table(TaskResults(found.study, found.data, found.answers))
    assert max(map(len, table_lines(table))) <= 80
    assert all(row.cells[-2].text.startswith("c ") for row in table.rows)  # the last column for people: due to
    page = report(StudyContents(found.data, found.study, found.answers), tmp_path)
    assert ">Tolerances</h2>" in page


def test_a_tolerance_survives_being_written_and_resumed(found: StudyResult, tmp_path: Path) -> None:
    study = study_of(tmp_path, ASK + SPREAD)
    assert study.tolerance == {"c": 0.1, "b": 0.05, "vehicle.sprung_mass": 0.2}
    assert study.spread("S1") == {"c": 0.1, "sprung_mass": 0.2}
    assert_survives(study, tmp_path)
    again = run_study(found.study, tmp_path / "again").folder
    journal = again / "journal.jsonl"
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:-1]))
    run_study(found.study, again, resume=True)
    assert (again / "tolerances.csv").read_bytes() == (found.folder / "tolerances.csv").read_bytes()


@pytest.mark.marathon
def test_the_design_that_is_best_at_a_quantile(tmp_path: Path) -> None:
    fixed = FREE.replace('b = { from = "1 kg", to = "2000 kg" }', 'b = "30 kg"')
    study = study_of(tmp_path, ASK + 'tolerance = { c = "10 %" }\nquantile = 0.9\nbaseline = "S2"', fixed)
    best = it.optimise_robust(
        study.design("S1"), it.RideComfort(study.road), it.Norm(), spread={"c": 0.1}, quantile=0.9, seed=0
    )
    asked = study.resolve_index("J1", "S1")
    assert isinstance(asked, it.Quantile)
    assert it.evaluate(best.design, asked.apart, it.Norm()).value == best.value
    again = it.optimise(study.design("S1"), asked, it.Norm()).value  # from other starts
    assert it.evaluate(best.design, asked, it.Norm()).value == pytest.approx(again, rel=1e-12)
    assert "quantile" in asked.title


TIED = (
    FREE
    + """
k1 = { from = "40 kN/m", to = "1 MN/m" }
k2 = { tied = "1 / (1 / k - 1 / k1)" }"""
)


@pytest.mark.campaign
def test_a_tied_value_scatters_by_its_own_name(tmp_path: Path) -> None:
    """The best design and the one that is best at a quantile, each with what Python says of it."""
    path = tmp_path / "study.toml"
    for line in ("", "quantile = 0.9\n"):
        settings = ASK + 'tolerance = { k2 = "20 %" }\n' + line
        path.write_text(study_text(settings, elements=TIED, layouts='S1 = "k1 - k2 | c"'), encoding="utf-8")
        study = load_study(path)
        found = run_study(study, tmp_path / f"out{len(line)}")
        values = dict(zip(("c", "k1"), found.data["parameter_value"].squeeze().values.tolist(), strict=True))
        k2 = 1.0 / (1.0 / 30e3 - 1.0 / values["k1"])
        strut = it.Spring(values["k1"]) - it.Spring(k2, "k2") | it.Damper(values["c"])
        car = it.QuarterCar(sprung_mass=250.0, unsprung_mass=35.0, tyre_stiffness=150e3, strut=strut)
        by_hand = it.tolerance_analysis(car, it.RideComfort(study.road), it.Norm(), spread={"k2": 0.2}, seed=0)
        (one,) = found.answers
        assert one.numbers["mean"] == pytest.approx(by_hand.mean, rel=1e-9)
        if line:
            assert float(found.data["value"].squeeze()) == pytest.approx(by_hand.quantile(0.9), rel=1e-3)
            (design,) = json.loads("".join(as_text(found)))["designs"]
            assert design["standard_error"] == float(found.data["standard_error"].squeeze()) > 0.0


def test_what_no_layout_is_made_of_does_not_scatter(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    text = study_text(ASK + "tolerance = { k = 0.1 }", elements=TIED, layouts='S1 = "k1 - k2 | c"')
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StudyError, match="no layout has it as a part; k2 follows from it, and scatters by its own"):
        load_study(path)


BAD: dict[str, tuple[str, str, list[str]]] = {
    "of nothing": (ASK + "tolerance = { q = 0.1 }", "study.tolerance.q", ["not in [elements]"]),
    "of the road": (ASK + "tolerance = { road.speed = 0.1 }", 'study.tolerance."road.speed"', ["no number"]),
    "of a bound": (ASK + "tolerance = { elements.c.to = 0.1 }", 'study.tolerance."elements.c.to"', ["expected"]),
    "of all": (ASK + "tolerance = { c = 1.0 }", "study.tolerance.c", ["between 0 and 1"]),
    "in a unit": (ASK + 'tolerance = { c = "10 N s/m" }', "study.tolerance.c", ['"10 %"']),
    "no number": (ASK + 'tolerance = { c = "ten %" }', "study.tolerance.c", ['"ten %"', '"10 %"']),
    "a truth": (ASK + "tolerance = { c = true }", "study.tolerance.c", ["got true"]),
    "beside a sweep": (
        ASK + 'tolerance = { c = 0.1 }\nsweep = { k = ["1 N/m", "2 N/m"] }',
        "study.tolerance",
        ["together with a sweep"],
    ),
    "quantile alone": (ASK + "quantile = 0.9", "study.quantile", ["nothing scatters"]),
    "quantile of all": (ASK + "tolerance = { c = 0.1 }\nquantile = 1.5", "study.quantile", ["got 1.5"]),
}


@pytest.mark.parametrize(("settings", "place", "words"), BAD.values(), ids=BAD)
def test_a_bad_tolerance_is_refused_with_its_place(tmp_path: Path, settings: str, place: str, words: list[str]) -> None:
    assert_refused(lambda: study_of(tmp_path, settings), place, words)


@pytest.mark.parametrize(
    ("evaluate", "is_told"),
    [('["expected-value"]', True), ('["statistical-linearisation", "expected-value"]', False), ('["norm"]', False)],
)
def test_a_check_warns_of_tolerances_that_are_simulated(tmp_path: Path, evaluate: str, is_told: bool) -> None:
    """Of the layout with friction, whose designs are simulated one by one, not of the linear one."""
    settings = f'indices = ["J1"]\nevaluate = {evaluate}\ntolerance = {{ c = "10 %", k = "5 %" }}'
    parts = 'k = "20 kN/m"\nc = "1.5 kN s/m"\nf = "20 N"'
    study = load_text(tmp_path, study_text(settings, elements=parts, layouts='S1 = "k | c"\nS2 = "k | (c | f)"'))
    lines = list(check_lines(read_tables(study.path, "a study"), study.path))
    told = [line for line in lines if "tolerances of" in line]
    assert bool(told) is is_told, lines
    if is_told:
        assert told[0].startswith("Warning: the tolerances of S2 are found by expected-value")
        assert "more than 16384 designs for each index" in told[0]


@pytest.mark.parametrize(("optimise", "is_told"), [("expected-value", True), ("statistical-linearisation", False)])
def test_a_check_warns_of_searches_that_simulate(tmp_path: Path, optimise: str, is_told: bool) -> None:
    """Of the layout with friction and free values; a search simulates no more designs than it is said to."""
    parts = 'k = "20 kN/m"\nc = { from = "100 N s/m", to = "10 kN s/m" }\nf = "20 N"'
    settings = f'indices = ["J1"]\noptimise = "{optimise}"'
    layouts = 'S1 = "k | c"\nS2 = "k | (c | f)"\nS3 = "k | f"'
    study = load_text(tmp_path, study_text(settings, elements=parts, layouts=layouts))
    lines = list(check_lines(read_tables(study.path, "a study"), study.path))
    told = [line for line in lines if "to optimise" in line]
    assert bool(told) is is_told, lines
    if is_told:
        most = int(told[0].removeprefix(f"Warning: to optimise S2, {optimise} simulates up to ").split()[0])
        found = it.optimise(study.design("S2"), study.index("J1"), study.method(optimise))
        assert most / 10 < found.evaluations <= most
