"""Searching a study over networks: every network is in the table, whatever shares or interrupts the work."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from folders import EXAMPLES
from study_text import assert_refused, load_text, study_text

import inerter as it
from inerter.cli.main import call
from inerter.errors import StudyError
from inerter.files.common.toml import read_tables
from inerter.files.study.checking import check_lines, search_plans
from inerter.files.study.parts import PartResult
from inerter.files.study.search_parts import GroupResult, NetworkGroup, RealPart, RealResult
from inerter.files.study.search_tables import real_networks_table
from inerter.files.study.searching import StudySearch, search_study
from inerter.files.study.study import Study
from inerter.files.study.work import StudyWork
from inerter.networks.enumeration import enumerate_networks
from inerter.report.search import search_sections, search_sentences

KINDS = (
    'springs = { from = "1 kN/m", to = "10 MN/m" }, dampers = { from = "10 N s/m", to = "1 MN s/m" }, '
    'inerters = { from = "10 g", to = "100 t" }'
)
ELEMENTS = f'k = "120 kN/m"\nc = {{ from = "100 N s/m", to = "100 kN s/m" }}\nany = {{ network = 2, {KINDS} }}'
LAYOUTS = 'S1 = "k | c"\nS = "k | any"'
ASK = 'indices = ["J1", "J3"]\noptimise = "norm"'


def text(settings: str = ASK, elements: str = ELEMENTS, layouts: str = LAYOUTS) -> str:
    return study_text(settings, elements=elements, layouts=layouts)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return load_text(tmp_path_factory.mktemp("study"), text())


@pytest.fixture(scope="module")
def found(study: Study, tmp_path_factory: pytest.TempPathFactory) -> StudySearch:
    return search_study(study, tmp_path_factory.mktemp("found") / "out")


def rows_of(folder: Path) -> list[dict[str, str]]:
    with (folder / "search.csv").open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_every_network_is_in_the_table_once(found: StudySearch) -> None:
    networks = sorted(each.format_expression(each.names({"k"})) for n in (1, 2) for each in enumerate_networks(n))
    for index in ("J1", "J3"):
        assert sorted(row["network"] for row in rows_of(found.folder) if row["index"] == index) == networks
    for row in rows_of(found.folder):
        assert bool(row["value"]) != row["status"].startswith("failed: "), row


def test_values_are_those_of_the_design_and_of_the_library(found: StudySearch, study: Study) -> None:
    for one in found.searches:
        index, method = study.index(one.index), it.Norm()
        direct = it.search(study.design("S"), index, method, seed=study.seed)
        assert [(each.layout, each.value) for each in direct.ranking] == [
            (each.layout, each.value) for each in one.result.ranking
        ]
        for each in one.result.ranking[:3]:
            assert it.evaluate(each.design, index, method).value == pytest.approx(each.value, rel=1e-9)


def test_bounds_are_a_sentence_only_where_a_smaller_network_does_as_well(study: Study, tmp_path: Path) -> None:
    """A mark in the table says which values are at a bound."""
    narrow = 'inerters = { from = "1 kg", to = "20 kg" }'
    asked = text(elements=ELEMENTS.replace('inerters = { from = "10 g", to = "100 t" }', narrow))
    found = search_study(load_text(tmp_path, asked), tmp_path / "out")
    sections = list(search_sections(found))
    remarks = [remark for section in sections for remark in section.remarks if " bound" in remark]
    at_bounds = [each for one in found.searches for each in one.result.ranking if each.active_bounds]
    assert any(not each.simpler for each in at_bounds)
    assert any("20 kg*" in str(table.rows) for section in sections for table in section.tables)
    assert remarks
    assert all(re.search(r" at its (upper|lower) bound, so .+ is equally good\.$", remark) for remark in remarks)


def test_one_damper_beside_the_spring_is_the_baseline(found: StudySearch) -> None:
    for one in found.searches:
        (alone,) = [each for each in one.result.ranking if each.layout == "c1"]
        assert one.baseline == pytest.approx(alone.value, rel=1e-9)


@pytest.mark.campaign
@pytest.mark.parametrize("baseline", ["k | c1", "k | c"], ids=["fixed", "free"])
def test_networks_are_not_compared_with_a_baseline_that_breaks_the_limits(tmp_path: Path, baseline: str) -> None:
    """A damper of 900 N s/m, or of 1.2 kN s/m at most, lets the strut travel farther than the limit."""
    elements = (
        'k = "20 kN/m"\nc1 = "900 N s/m"\nc = { from = "100 N s/m", to = "1.2 kN s/m" }\n'
        'any = { network = 1, dampers = { from = "10 N s/m", to = "100 kN s/m" } }'
    )
    asked = 'indices = ["J1"]\noptimise = "norm"\nbaseline = "S1"\n'
    limit = 'subject_to = { suspension-travel = { at_most = "5 mm" } }'
    study = load_text(tmp_path, text(f"{asked}{limit}", elements, f'S1 = "{baseline}"\nS = "k | any"'))
    ((one,), (fixed,)) = (found := search_study(study, tmp_path / "out")).searches, found.fixed
    assert fixed.kind == "infeasible"
    assert math.isnan(one.baseline)
    assert one.result.ranking[0].layout == "c1"
    (row,) = rows_of(found.folder)
    assert (row["improvement_percent"], row["status"]) == ("", "ok")


@pytest.mark.campaign
def test_a_network_that_keeps_no_limit_with_real_inerters_has_no_value_with_them(tmp_path: Path) -> None:
    """The limit on J3 lies just above the best value with an ideal inerter, which a soft shaft spoils."""
    elements = (
        'k = "120 kN/m"\nany = { network = 2, at_least = 2, dampers = { from = "10 N s/m", to = "1 MN s/m" }, '
        'inerters = { from = "10 g", to = "100 t" } }'
    )
    layouts = 'S = "k | any"'
    best = it.search(
        load_text(tmp_path, text(ASK, elements, layouts)).design("S"), it.TyreLoad(it.Road(5e-7, 25.0)), it.Norm()
    )
    limit = f'subject_to = {{ J3 = {{ at_most = "{1.0001 * best.ranking[0].value!r} N" }} }}'
    device = 'real_inerters = { friction = "0 N", stiffness = "100 kN/m", methods = ["norm"], best = 1 }'
    asked = f'indices = ["J1"]\noptimise = "norm"\n{device}\n{limit}'
    found = search_study(load_text(tmp_path, text(asked, elements, layouts)), tmp_path / "out")
    (one,) = found.searches
    (real,) = one.real
    assert one.result.ranking[0].status.ok
    assert (real.status, math.isnan(real.value)) == ("infeasible", True)
    assert real.kept > 0.0
    assert real.kept_doubt.startswith("infeasible: no feasible design for r.m.s. dynamic tyre load")
    (row,) = csv_of(found.folder / "search_real_inerters.csv")
    assert row["same_values_doubt"] == real.kept_doubt


def test_a_search_cut_short_resumes_to_the_same_bytes(study: Study, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    whole = search_study(study, folder)
    assert whole.computed == 20  # nine networks and one layout for each index
    before, journal = (folder / "search.csv").read_bytes(), folder / "journal.jsonl"
    journal.write_bytes(journal.read_bytes()[:-50])
    assert search_study(study, folder, resume=True).computed == 9
    assert (folder / "search.csv").read_bytes() == before
    assert search_study(study, folder, resume=True).computed == 0
    assert (folder / "search.csv").read_bytes() == before
    with pytest.raises(StudyError, match=r"holds results of inerter search .*--resume.*--force"):
        search_study(study, folder)


def test_two_processes_write_the_same_bytes(found: StudySearch, study: Study, tmp_path: Path) -> None:
    search_study(study, tmp_path / "two", jobs=2)
    assert (tmp_path / "two" / "search.csv").read_bytes() == (found.folder / "search.csv").read_bytes()


def test_a_group_that_kills_its_processes_is_not_dropped(study: Study) -> None:
    plan = search_plans(study)["S", "J1"]
    group = NetworkGroup("S", "J1", 0, plan.groups()[0], plan)
    result = group.failed_result(study, "out of memory")
    again = GroupResult(**json.loads(json.dumps(result.to_json())))
    assert not again.ok
    assert again.part == group
    assert [(one.topology, one.reason) for one in again.optima()] == [(t, "out of memory") for t in group.topologies]


def test_results_survive_the_journal(study: Study) -> None:
    plan = search_plans(study)["S", "J3"]
    result = NetworkGroup("S", "J3", 0, plan.groups()[0], plan).compute(study, {}, 1)
    again = GroupResult(**json.loads(json.dumps(result.to_json())))
    assert list(again.optima()) == list(result.optima())


@pytest.mark.campaign
def test_an_index_without_compiled_search(tmp_path: Path) -> None:
    """With a limit each network is searched by itself; none is left out."""
    elements = f'k = "120 kN/m"\nany = {{ network = 2, dampers_at_most = 1, springs_at_most = 0, {KINDS} }}'
    study = load_text(
        tmp_path, text(f'{ASK}\nsubject_to = {{ J3 = {{ at_most = "650 N" }} }}', elements, 'S = "k | any"')
    )
    assert {plan.compiled_index for plan in search_plans(study).values()} == {None}
    one, _ = search_study(study, tmp_path / "out").searches
    assert one.result.n_networks == 4  # c, b, c | b, c - b
    assert [each.layout for each in one.result.frontier][-1] == one.result.ranking[0].layout


TRADE = 'trade_off = ["J1", "J3"]\npoints = 5\noptimise = "norm"'


@pytest.fixture(scope="module")
def traded(tmp_path_factory: pytest.TempPathFactory) -> StudySearch:
    folder = tmp_path_factory.mktemp("traded")
    return search_study(load_text(folder, text(TRADE)), folder / "out")


def csv_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_the_front_is_that_of_the_library(traded: StudySearch) -> None:
    study = traded.study
    indices = [study.index(name) for name in ("J1", "J3")]
    direct = it.search(study.design("S"), indices, it.Norm(), points=5, seed=study.seed)
    (one,) = traded.fronts
    assert [each.values for each in direct.front] == [each.values for each in one.result.front]
    rows = csv_of(traded.folder / "search_front.csv")
    assert {row["up_to_elements"] for row in rows} == {"1", "2"}
    last = [row for row in rows if row["up_to_elements"] == "2"]
    assert [(float(row["J1 [m/s^2]"]), float(row["J3 [N]"])) for row in last] == [one.values for one in direct.front]
    assert all(row["status"] == "ok" for row in rows)


def test_a_front_cut_short_resumes_to_the_same_bytes(traded: StudySearch, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    whole = search_study(traded.study, folder)
    names, journal = ("search.csv", "search_front.csv"), folder / "journal.jsonl"
    before = [(folder / name).read_bytes() for name in names]
    assert before == [(traded.folder / name).read_bytes() for name in names]
    journal.write_bytes(journal.read_bytes()[:-50])
    again = search_study(traded.study, folder, resume=True)
    assert 0 < again.computed < whole.computed
    assert [(folder / name).read_bytes() for name in names] == before
    assert search_study(traded.study, folder, resume=True).computed == 0


@pytest.mark.campaign
def test_the_command_draws_the_front(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    load_text(tmp_path, text(TRADE))
    command = ["search", str(tmp_path / "study.toml"), "-o", str(tmp_path / "out"), "-j", "1"]
    assert call(command) == 0
    told = capsys.readouterr().out
    assert max(map(len, told.splitlines())) <= 80
    assert "networks on the Pareto" in told
    assert "1 of 9 networks is on the Pareto front: c1 - b1." in " ".join(told.split())
    assert (tmp_path / "out" / "figures" / "front-S.svg").exists()
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 4
    assert "the Pareto front over all networks" in page
    assert call([*command, "--resume", "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["search_front"]) == len(
        csv_of(tmp_path / "out" / "search_front.csv")
    )


REAL = 'real_inerters = { friction = "100 N", methods = ["norm", "statistical-linearisation"], best = 1 }'


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> StudySearch:
    folder = tmp_path_factory.mktemp("real")
    elements = ELEMENTS.replace("network = 2", "network = 2, springs_at_most = 0")
    settings = f'indices = ["J1"]\noptimise = "norm"\n{REAL}'
    return search_study(load_text(folder, text(settings, elements)), folder / "out")


@pytest.mark.campaign
def test_real_inerters_in_the_best_networks(real: StudySearch) -> None:
    """The values are at least as good as those of the ideal network in the real one, and those of the design."""
    rows = csv_of(real.folder / "search_real_inerters.csv")
    assert [(row["network"], row["method"]) for row in rows] == [
        ("c1 - b1", "norm"),
        ("c1 - b1", "statistical-linearisation"),
    ]
    shaft = it.Spring(1e6) | it.Damper(3200.0)
    for row, moved in zip(rows, (it.Inerter, lambda b: it.Inerter(b) | it.Friction(100.0)), strict=True):
        assert float(row["ideal"]) < float(row["value"]) < float(row["same_values"])
        assert 0.0 < float(row["improvement_percent"]) < float(row["ideal_improvement_percent"])
        damper, inerter = it.Damper(float(row["c1 [N s/m]"])), moved(float(row["b1 [kg]"]))
        car = replace(real.study.design("S1"), strut=it.Spring(120e3) | damper - shaft - inerter)
        method = it.Norm() if row["method"] == "norm" else it.StatisticalLinearisation()
        value = it.evaluate(car, real.study.index("J1"), method).value
        assert value == pytest.approx(float(row["value"]), rel=1e-9)
    (one,) = real.searches
    (base,) = [each for each in one.real if not each.network and each.method == "norm"]
    assert base.value == pytest.approx(one.baseline, rel=1e-12)


def test_real_inerters_are_in_report_and_journal(real: StudySearch) -> None:
    (section, *_) = list(search_sections(real))
    shaft = "friction of 100 N and a shaft of 1 MN/m with 3.2 kN s/m"
    assert section.tables[-1].caption.endswith(f"with real inerters: the best networks, their inerters with {shaft}")
    told = " ".join(search_sentences(real))
    assert "with real inerters (linearisation): c1 - b1, " in told
    before = (real.folder / "search_real_inerters.csv").read_bytes()
    assert search_study(real.study, real.folder, resume=True).computed == 0
    assert (real.folder / "search_real_inerters.csv").read_bytes() == before


def test_gains_with_real_inerters_have_the_digits_that_their_errors_allow(real: StudySearch) -> None:
    (one,) = real.searches
    own, base = (
        next(each for each in one.real if each.method == "statistical-linearisation" and bool(each.network) is is_own)
        for is_own in (True, False)
    )
    own = replace(own, value=2.01234, kept=2.23456, error_bound=0.02, kept_bound=0.02, kept_doubt="inaccurate: why")
    changed = replace(one, real=(own, replace(base, value=2.51234, error_bound=0.0)))
    (row,) = real_networks_table(real.study, changed).rows
    told = [str(cell.content) for cell in row.cells]
    assert "2.23 m/s^2" in told
    assert "2.01 m/s^2" in told
    assert "+20 %" in told
    assert not told[-2].startswith("+")  # a share of the ideal gain, not a gain
    assert row.status == "same values: inaccurate: why"


def test_a_baseline_with_friction_is_optimised_by_the_method_of_the_gains(tmp_path: Path) -> None:
    """At the best values without friction it would be worse, and each gain larger; its doubts are told."""
    elements = ELEMENTS.replace("network = 2", "network = 2, springs_at_most = 0") + '\nf = "300 N"'
    real_inerters = 'real_inerters = { friction = "10 N", best = 1 }\nbaseline = "S1"'
    asked = text(f'indices = ["J1"]\noptimise = "norm"\n{real_inerters}', elements, 'S1 = "k | c | f"\nS = "k | any"')
    study = load_text(tmp_path, asked)
    found = search_study(study, tmp_path / "out")
    index, method = study.index("J1"), it.StatisticalLinearisation()
    ideal = it.optimise(study.design("S1"), index, it.Norm()).design
    best = it.optimise(study.design("S1"), index, method)
    assert best.value < 0.95 * it.evaluate(ideal, index, method).value
    (row,) = csv_of(found.folder / "search_real_inerters.csv")
    gain = 100.0 * (1.0 - float(row["value"]) / best.value)
    assert float(row["improvement_percent"]) == pytest.approx(gain, abs=1e-3)
    assert row["status"] == "ok"
    assert row["improvement_doubt"].startswith("inaccurate: baseline: friction 'f'")
    said = f"as good as S1 within errors as large as the values ({row['improvement_doubt'].rstrip('.')})"
    assert said in " ".join(search_sentences(found))  # of 300 N of friction that sticks


def test_results_are_in_the_order_of_the_study_whatever_is_ready_first(
    real: StudySearch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_order = StudyWork.compute

    def reversed_parts(self: StudyWork, *asked: Any) -> Iterator[list[PartResult]]:
        yield from reversed([[one] for ready in in_order(self, *asked) for one in ready])

    monkeypatch.setattr(StudyWork, "compute", reversed_parts)
    late = search_study(real.study, tmp_path / "out")
    assert [one.part for one in late.searches[0].real] == [one.part for one in real.searches[0].real]
    assert [one.part for one in late.fixed] == [one.part for one in real.fixed]
    for name in ("search.csv", "search_real_inerters.csv"):
        assert (late.folder / name).read_bytes() == (real.folder / name).read_bytes()


def test_where_no_inerter_is_among_the_best_networks_none_is_made_real(tmp_path: Path) -> None:
    asked = f'indices = ["J1"]\noptimise = "norm"\n{REAL}'
    study = load_text(tmp_path, text(asked, elements=ELEMENTS.replace("network = 2", "network = 1")))
    found = search_study(study, tmp_path / "out")
    assert all("real inerters" not in table.caption for table in next(iter(search_sections(found))).tables)
    assert "Ride comfort (J1) with real inerters: the best networks contain no inerter." in search_sentences(found)


@pytest.mark.parametrize("layout", ["any", "k | any"])
def test_networks_that_carry_no_weight_are_named(tmp_path: Path, layout: str) -> None:
    """The lowest acceleration has a body on a small damper alone, which sinks."""
    asked = 'indices = ["J1"]\noptimise = "norm"'
    study = load_text(
        tmp_path, text(asked, ELEMENTS.replace("network = 2", "network = 1"), f'S1 = "k | c"\nS = "{layout}"')
    )
    told = [line for line in search_sentences(search_study(study, tmp_path / "out")) if "equilibrium" in line]
    sinking = (
        "Ride comfort (J1): no static equilibrium: no spring supports the body with c1. Put a spring in parallel with "
        "the free network, or limit the static stiffness."
    )
    assert told == ([sinking] if layout == "any" else [])


def test_a_network_that_fails_with_real_inerters_says_why(real: StudySearch) -> None:
    part = RealPart("S", "J1", "norm", "c1 - b1", real.searches[0].result.ranking[0])
    result = RealResult(**json.loads(json.dumps(part.failed_result(real.study, "out of memory").to_json())))
    assert not result.ok
    assert result.part == part
    assert result.message == "out of memory"


@pytest.mark.parametrize(
    ("settings", "layouts", "place", "words"),
    [
        (ASK, 'S1 = "k | c"', "layouts", ["no layout has a free network", "network = 4"]),
        (f'{ASK}\nsweep = {{ k = ["100 kN/m", "120 kN/m"] }}', LAYOUTS, "study.sweep", ["does not use it"]),
    ],
)
def test_what_a_search_refuses(tmp_path: Path, settings: str, layouts: str, place: str, words: list[str]) -> None:
    study = load_text(tmp_path, text(settings, layouts=layouts))
    assert_refused(lambda: search_plans(study), place, words)


def test_real_inerters_without_a_free_network_are_refused(tmp_path: Path) -> None:
    settings = f'{ASK}\nreal_inerters = {{ friction = "10 N" }}'
    asked = text(settings, 'k = "120 kN/m"\nc = { from = "1 kN s/m", to = "9 kN s/m" }', 'S1 = "k | c"')
    assert_refused(lambda: load_text(tmp_path, asked), "study.real_inerters", ["no element is a free network"])


def test_two_free_networks_are_refused(tmp_path: Path) -> None:
    elements = f"{ELEMENTS}\nmore = {{ network = 1, {KINDS} }}"
    study = load_text(tmp_path, text(elements=elements, layouts='S = "k | any | more"'))
    assert_refused(lambda: search_plans(study), "layouts.S", ["2 different free networks"])


def test_check_counts_the_networks(study: Study) -> None:
    (line, *_) = check_lines(read_tables(study.path, "a study"), study.path)
    assert "ok." in line
    assert "9 networks of S to search for each index" in line


def test_the_command_writes_tables_drawings_and_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    load_text(tmp_path, text())
    command = ["search", str(tmp_path / "study.toml"), "-o", str(tmp_path / "out"), "-j", "1"]
    assert call(command) == 0
    told = capsys.readouterr().out
    assert max(map(len, told.splitlines())) <= 80
    for words in ("best network for each number of elements", "c1 - b1", "1 more network has no value", "Gain on S1"):
        assert words in told
    names = {path.relative_to(tmp_path / "out").as_posix() for path in (tmp_path / "out").rglob("*.*")}
    assert names >= {"search.csv", "report.html", "figures/frontier.svg", "figures/networks-S-J1.svg"}
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 3
    assert call([*command, "--resume", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert len(data["networks"]) == 18
    assert data["frontiers"][0] == {"layout": "S", "index": "J1", "networks": ["c1", "c1 - b1"]}


@pytest.mark.parametrize(
    ("name", "layout", "network"), [("quarter_car", "S3", "c1 - b1"), ("absorber", "TMD", "k1 | c1")]
)
def test_networks_of_two_elements_in_the_examples(name: str, layout: str, network: str, tmp_path: Path) -> None:
    """The network that a layout spells out has the value that the optimiser finds for the layout."""
    written = (EXAMPLES / f"search_{name}.toml").read_text(encoding="utf-8")
    study = load_text(tmp_path, re.sub(r"\nnetwork = \d", "\nnetwork = 2", written))
    found = search_study(study, tmp_path / "out")
    for one in found.searches:
        (alike,) = [each for each in one.result.ranking if each.layout == network]
        (fixed,) = [each for each in found.fixed if (each.layout, each.index) == (layout, one.index)]
        assert alike.value == pytest.approx(fixed.values["norm"][one.index], rel=1e-6)
