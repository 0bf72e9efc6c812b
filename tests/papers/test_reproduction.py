"""The simulated part of Wang and Su (2008): rows, claims and the report."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from inerter import LoadCarrying
from inerter.cli.main import call
from inerter.methods.expected_value import ExpectedValue
from inerter.methods.method import evaluate
from inerter.methods.norm import Norm
from inerter.norms.hinf import Peak
from inerter.optimisation.optimise import optimise
from inerter.papers.wang_su_2008 import between, beyond, claims, curves, rows
from inerter.papers.wang_su_2008.claims import Claim, Curves, Evidence, judge
from inerter.papers.wang_su_2008.reproduce import JOURNAL, Reproduction, Task, work
from inerter.papers.wang_su_2008.rig import Found, RigTest
from inerter.papers.wang_su_2008.rows import SimulatedRow
from inerter.papers.wang_su_2008.source import simulated_rows, study
from inerter.report.reproduction_rows import reason
from inerter.report.reproduction_text import reproduction_text


def judged(table: int, name: str) -> SimulatedRow:
    return rows.judged(table, name, rows.compute(table, name))


@pytest.mark.parametrize(
    ("table", "name"),
    [
        (1, "J1 1"),
        (1, "J1 4"),
        (1, "J3 9"),
        (1, "J3 10"),
        (1, "J5 6"),
        (1, "J5 10"),
        (3, "J1 9"),
        (3, "J3 7"),
        (3, "J5 3"),
    ],
)
def test_rows_of_the_expected_value(table: int, name: str) -> None:
    """Within what four runs, the printed digits and the conventions explain, from the printed designs alone."""
    row = judged(table, name)
    assert row.verdict != "differs"
    assert row.tolerance <= 8e-3
    if row.row.index == "J5":
        assert row.exact >= row.paper2008
        assert any(peak.omega == row.omega for peak in row.peaks)


def test_a_row_of_the_approximated_linear_model() -> None:
    row = judged(2, "J3 9")
    assert abs(row.difference) < 15e-3
    assert row.paper2008_error > 0.0
    assert row.improvement is not None
    assert abs(row.improvement - float(row.row.improvement)) < 1.5


def test_every_simulated_row_is_there() -> None:
    assert [len(simulated_rows(table)) for table in (1, 2, 3)] == [33, 18, 39]
    for table in (1, 2, 3):
        for row in simulated_rows(table):
            assert row.design().free_values() == {}
            assert row.value > 0.0
            assert ("friction" in row.nonlinearity) == row.has_friction


def test_linear_twins_have_the_parameters_of_the_curves() -> None:
    """Every curve with friction has a linear layout in Figure 11 with the same free values."""
    elastic = study("figure11")
    for figure in ("figure13", "figure14"):
        for layout in curves.LAYOUTS[figure]:
            with_friction = study("friction1").design(layout, 120e3).free_values()
            assert set(with_friction) == set(elastic.design(curves.linear_twin(layout), 120e3).free_values())


def test_a_verdict_says_which_digits() -> None:
    row = next(r for r in simulated_rows(1) if r.index == "J1" and r.case == 4)
    near = SimulatedRow(row, "m/s^2", row.value + row.last_digit, 0.0, row.value, 0.0, (), None)
    far = SimulatedRow(row, "m/s^2", 1.001 * row.value, 0.0, row.value, 0.0, (), None)
    off = SimulatedRow(row, "m/s^2", 1.01 * row.value, 0.0, row.value, 0.0, (), None)
    assert [r.verdict for r in (near, far, off)] == [
        "agrees to the printed digits",
        "within the tolerance",
        "differs",
    ]
    assert [bool(reason(r)) for r in (near, far, off)] == [False, False, True]


K = np.linspace(10e3, 300e3, 30)


def made_up(**values: np.ndarray) -> xr.Dataset:
    """Curves over k, the same for every index."""
    names = {"S1": np.full(30, 1.0), **values}
    array = np.repeat(np.array(list(names.values()))[:, None], 3, axis=1)
    dims = ("layout", "index", "k")
    coords = {"layout": list(names), "index": ["J1", "J3", "J5"], "k": K}
    return xr.Dataset({"value": (dims, array)}, coords)


def test_crossings_lie_where_lines_cross() -> None:
    data = made_up(a=1.0 + (K - 123456.0) * 1e-6)
    assert Curves(data).crossings("a", "S1", "J1") == [pytest.approx(123456.0)]
    assert Curves(data).crossings("S1", "S1", "J1") == []


def test_a_crossing_of_optima_has_a_better_and_a_worse_side() -> None:
    """Seen by searches with another seed."""
    k = between.compute("J5 S3-soft S1 3")["k"]
    source = study("figure11")

    def excess(stiffness: float) -> float:
        soft, usual = (
            optimise(source.design(layout, stiffness), LoadCarrying(), Norm(), seed=7).value
            for layout in ("S3-soft", "S1")
        )
        return soft / usual - 1.0

    assert 40e3 < k < 50e3
    assert excess(0.998 * k) < between.WORSE < excess(1.002 * k)
    found = {"J5 S3-soft S1 3": {"k": k}, "J5 S3-soft S1 there": {"excess": 0.07}, "J3 S3-soft S3 9": {"k": 1.0}}
    assert between.crossings(found, "J5", "S3-soft", "S1") == [k]
    assert between.excess_there(found, "J5", "S3-soft", "S1") == 0.07


def test_crossings_in_the_noise_do_not_count() -> None:
    gap = np.where(np.arange(30) < 10, -0.1, 0.1)
    gap[[4, 20, 21]] = 0.01, -0.01, -0.02  # twice a turn and back
    data = made_up(a=1.0 + gap)
    assert len(Curves(data).crossings("a", "S1", "J1")) == 5
    error = np.where(np.isin(data["layout"], ["a"])[:, None, None], 0.015, 0.0) * np.ones((2, 3, 30))
    noisy = Curves(data.assign(standard_error=(data["value"].dims, error)))
    assert noisy.crossings("a", "S1", "J1") == [pytest.approx((K[9] + K[10]) / 2.0)]
    assert not noisy.worse("a", "S1", "J1")[4]
    assert noisy.worse("a", "S1", "J1")[10]


def test_claim_10_is_not_judged_where_nothing_costs_anything() -> None:
    """Rounding there would tell whether elasticity or friction costs more."""
    costs = {"": 0.0, "-10N": 0.01, "-20N": 0.02, "-soft": 0.05, "-soft-10N": 0.07}
    rounding = np.random.default_rng(0).normal(0.0, 1e-9, 30)
    found = {
        f"{layout}{kind}": np.where(K < 150e3, 0.8 * (1.0 + rounding * len(kind)), 0.8 + cost)
        for layout in ("S2", "S3")
        for kind, cost in costs.items()
    }
    assert verdict(10, judge(Evidence(curves=made_up(**found)))) == claims.OTHER_NUMBER
    found["S3-10N"][-1] = 0.86
    assert verdict(10, judge(Evidence(curves=made_up(**found)))) == claims.FAILS


def with_friction(factor: float, twist: float = 0.0) -> xr.Dataset:
    """Layouts of Figures 13 and 14 with effects that grow with k or shrink with it."""
    slope = (K - 150e3) / 1e6
    kinds = {"": 0.8, "-10N": 0.81 - twist * slope, "-20N": 0.82 - twist * slope, "-soft": 0.81 + slope * factor}
    found = {f"{layout}{kind}": np.full(30, 1.0) * value for layout in ("S2", "S3") for kind, value in kinds.items()}
    for layout in ("S2", "S3"):
        found[f"{layout}-soft-10N"] = np.maximum(found[f"{layout}-10N"], found[f"{layout}-soft"]) + 0.01
    return made_up(**found)


def verdict(number: int, found: list[Claim]) -> str:
    return next(claim.verdict for claim in found if claim.number == number)


def test_claims_follow_the_curves() -> None:
    """Claim 8: friction is the lesser evil at large k, elasticity at small k; at which k is another matter."""
    as_claimed = judge(Evidence(curves=with_friction(0.1)))
    turned = judge(Evidence(curves=with_friction(-0.1)))
    assert verdict(8, as_claimed) == claims.OTHER_NUMBER  # S2 crosses at 150 kN/m, not at 50
    assert verdict(8, turned) == claims.FAILS
    assert verdict(5, as_claimed) == claims.FAILS  # nothing is worse than S1 here


def made_row(table: int, name: str, paper2008: float, exact: float) -> SimulatedRow:
    row = next(r for r in simulated_rows(table) if f"{r.index} {r.case}" == name)
    return SimulatedRow(row, "", paper2008, 0.0, exact, 0.0, (Peak(10.0, exact),), 10.0)


def test_claim_7_needs_every_frequency() -> None:
    """J5 of S3 with friction is better only if it is so over all frequencies."""
    names = [f"J5 {case}" for case in range(1, 12)]
    table = {
        (1, name): made_row(1, name, 1.0, 1.0)
        for name in [*names, *(f"J{i} {c}" for i in (1, 3) for c in range(1, 12))]
    }
    for case in (4, 5):
        table[1, f"J5 {case}"] = made_row(1, f"J5 {case}", 1.1, 1.1)
    for case in (9, 10):
        table[1, f"J5 {case}"] = made_row(1, f"J5 {case}", 0.9, 1.05)
    assert verdict(7, judge(Evidence(rows=table))) == claims.FAILS
    for case in (9, 10):
        table[1, f"J5 {case}"] = made_row(1, f"J5 {case}", 0.9, 0.95)
    assert verdict(7, judge(Evidence(rows=table))) == claims.HOLDS


def test_claims_are_judged_only_with_their_evidence() -> None:
    assert judge(Evidence()) == []


def test_an_optimum_with_friction_is_no_worse_than_the_linear_one() -> None:
    found = beyond.compute_optimum("J1 S3-100N")
    assert found["percent"] < 0.0  # type: ignore[operator]
    assert found["value"] < found["linear_value"]  # type: ignore[operator]


def test_a_budget_is_where_the_difference_vanishes() -> None:
    found = beyond.compute_budget("J1 S3 shaft stiffness")
    assert found["status"] == "ok"
    assert 1e4 < found["value"] < 1e6  # type: ignore[operator]


def test_tasks_give_numbers_that_json_has() -> None:
    key, numbers = work(Task("table1", "J1 4"))
    assert key == ("table1", "J1 4")
    assert json.loads(json.dumps(numbers)) == numbers
    assert numbers["seconds"] > 0.0


def test_one_table_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its rows in text, CSV and page; a second run with --resume computes nothing anew."""
    folder = tmp_path / "paper"
    arguments = ["reproduce", "wang-su-2008", "--only", "table1", "--only", "figure12", "-o", str(folder), "-j", "1"]
    assert call(arguments) == 0
    text = capsys.readouterr().out
    assert max(map(len, text.splitlines())) <= 80
    with (folder / "simulated-rows.csv").open(encoding="utf-8") as stream:
        found = list(csv.DictReader(stream))
    assert len(found) == 33
    assert {row["verdict"] for row in found} <= {"agrees to the printed digits", "within the tolerance"}
    assert all(float(row["exact_standard_error"]) >= 0.0 for row in found)
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("<figure>") == 2  # the networks, and Figure 12
    assert not re.search(r'(?:src|href)="https?:', page)
    for kind in ("svg", "png", "pdf"):
        assert (folder / "figures" / f"figure-12.{kind}").stat().st_size > 1000
    journal = (folder / JOURNAL).read_bytes()
    assert call(["reproduce", "wang-su-2008", "--only", "table1", "-o", str(folder), "--resume", "-j", "1"]) == 0
    assert (folder / JOURNAL).read_bytes() == journal
    assert capsys.readouterr().out == text


def test_the_same_seed_gives_the_same_number_whatever_ran_before() -> None:
    row = next(r for r in simulated_rows(1) if r.case == 4 and r.index == "J1")
    values = {evaluate(row.design(), row.asks(), ExpectedValue(realisations=2, seed=3, jobs=j)).value for j in (1, 2)}
    assert len(values) == 1


def test_the_rig_fits_a_terminal() -> None:
    widest = Found("cs", "N s/m", 3200.0, 3204.7, (3190.6, 3218.9), "")
    tested = RigTest((widest,), {}, {}, {}, (), (), "ok")
    lines = reproduction_text(Reproduction(("rig",), rig=tested)).splitlines()
    assert any("3.1906 kN s/m to 3.2189 kN s/m" in line for line in lines)
    assert max(map(len, lines)) <= 80
