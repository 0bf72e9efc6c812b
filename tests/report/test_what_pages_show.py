"""What an editor asks of pages and terminals: methods by their words, limits told wherever they hold designs back."""

import math
import re
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from folders import EXAMPLES
from study_text import load_text
from synthetic import LONG, a_map, designs, judged, limited, sweep, terminal_text, with_value

import inerter as it
from inerter.figures.study import study_figures
from inerter.figures.style import style_context
from inerter.files.common.layouts import StrutLayout
from inerter.files.common.roads import MeasuredLine
from inerter.files.study.cases import cases
from inerter.files.study.limits import StudyLimit
from inerter.files.study.loading import load_study
from inerter.files.study.responses import responses
from inerter.files.study.tasks import TaskResults
from inerter.methods.registry import METHODS
from inerter.report.conclusions import conclusion_sentences
from inerter.report.index_summary import over_the_sweep, sweep_headlines
from inerter.report.limits import limit_tables
from inerter.report.method_comparison import method_tables
from inerter.report.page import report
from inerter.report.problem_statement import vehicle_rows
from inerter.report.study_contents import StudyContents
from inerter.report.tables import tables_of, trade_off_tables
from inerter.report.text import WIDTH
from inerter.report.verdicts import verdict_sentences
from inerter.roads.spectrum import N0, RoadSpectrum
from inerter.signals.road import ROAD_CLASSES
from inerter.tasks.budgets import BudgetAnswer, Budgets

KEYS = re.compile("|".join(rf"\b{key}\b" for key in METHODS))  # "norms" is another word
LIMITS = (StudyLimit("suspension-travel", "at_most", 9e-3, "m"), StudyLimit("tyre-load", "at_most", 1300.0, "N"))


@pytest.fixture(scope="module")
def study():
    return load_study(EXAMPLES / "quarter-car.toml")


@pytest.fixture(scope="module")
def sweep_study():
    return load_study(EXAMPLES / "stiffness-sweep.toml")


@pytest.mark.parametrize(
    ("make", "count"), sampled(product([designs, sweep, a_map], [2, 4]), [(designs, 2), (sweep, 4), (a_map, 2)])
)
def test_whatever_is_said_names_methods_by_their_words(make, count):
    results = judged(make(), list(METHODS)[:count])
    tables = [*tables_of(results), *method_tables(results)]
    said = [
        *(table.caption for table in tables),
        *(text for table in tables for text in [column.heading for column in table.shown]),
        *(figure.caption for figure in study_figures(results)),
        *(verdict_sentences(results) if make is designs else sweep_headlines(results)),
        *(sentence for _, sentence in over_the_sweep(results) if make is not designs),
        terminal_text(results),
    ]
    assert not [text for text in said if KEYS.search(text)]
    with style_context():
        drawn = study_figures(results)[1 if make is designs else 0].draw()
    assert not [text for legend in drawn.legends for text in legend.get_texts() if KEYS.search(text.get_text())]


@pytest.mark.parametrize("make", [sweep, a_map])
def test_a_figure_of_one_method_of_several_says_where_the_others_are(make):
    (caption, *_) = [figure.caption for figure in study_figures(judged(make()))]
    assert ("The values by simulation are in summary.csv." in caption) == (make is a_map)


@pytest.mark.parametrize("seed", sampled(range(20), [2], kept=1))
@pytest.mark.parametrize("make", [sweep, a_map])
def test_limits_over_a_sweep_are_told_by_table_terminal_and_figure(make, seed):
    random = np.random.default_rng(seed)
    data = make(LONG[: random.integers(1, 5)])
    shape = data["status"].shape
    active = random.random((*shape, 2)) < random.choice([0.0, 0.3, 1.0])
    missed = random.random(shape) < random.choice([0.0, 0.2])
    results = limited(data, active, missed)
    text = terminal_text(results)
    assert all(len(line) <= WIDTH for line in text.split("\n"))
    joined = re.sub(r"\s+", " ", text)
    for j, table in enumerate(limit_tables(results)):
        for i, rows in enumerate(zip(*[iter(table.rows)] * 3, strict=True)):  # two limits, and both
            here = active[i, j].reshape(-1, 2) & ~missed[i, j].reshape(-1, 1)
            counts = [count_of(row.cells[2].text) for row in rows]
            assert counts == [*here.sum(axis=0), missed[i, j].sum()]
            assert {row.cells[0].text for row in rows} == {results["layout"].values[i]}
            for row in rows:
                assert " ".join(cell.text for cell in row.cells[:3]) in joined
    figures = [f for f in study_figures(results) if f.name in ("sweep-J1", "map-J1")]
    mark = "Open markers" if make is sweep else "Black dots"
    assert (f"{mark}: active constraint." in figures[0].caption) == bool((active.any(-1) & ~missed)[:, 0].any())
    assert ("no feasible design." in figures[0].caption) == bool(missed[:, 0].any())
    with style_context():
        panels = figures[0].draw().axes
    marks = sum(len(line.get_xdata()) for ax in panels for line in ax.lines if marked(line, make is sweep))
    times = np.array([1 if i == 0 or make is not sweep else 2 for i in range(shape[0])])  # value and improvement
    shown = (active.any(-1) & ~missed)[:, 0].reshape(shape[0], -1)
    assert marks == (shown.sum(axis=1) * times).sum()


def marked(line, opened):
    colour = line.get_markerfacecolor()
    return line.get_linestyle() == "None" and colour == ("white" if opened else "black")


def count_of(text):
    """How many values or points a cell tells."""
    found = re.search(r"at (?:all )?(\d+)", text)
    return int(found[1]) if found else 0


def test_where_nothing_keeps_the_limits_no_design_is_called_the_best(study):
    data = designs()
    missed = np.ones(data["status"].shape, dtype=bool)
    results = limited(data, np.zeros((*missed.shape, 2), dtype=bool), missed)
    results["limit_value"].loc[{"layout": "S2", "index": "J3"}] = [9.9e-3, 1290.0]
    told = conclusion_sentences(results, replace(study, limits=LIMITS))
    assert told[-1] == (
        "No feasible design with r.m.s. suspension travel at most 9 mm and r.m.s. dynamic tyre load at most 1.3 kN; "
        "closest: S2 with r.m.s. suspension travel 9.9 mm and r.m.s. dynamic tyre load 1.29 kN."
    )
    assert not any("All designs found satisfy" in sentence for sentence in told)
    assert "improvement" not in [figure.name for figure in study_figures(results)]
    for figure in study_figures(results):
        assert figure.caption.endswith("Of a layout without a feasible design, that of the closest design.")
    for table, index in zip(trade_off_tables(results), ["J1", "J3", "J5"], strict=True):
        assert [[cell.remark for cell in row.cells] for row in table.rows] == [
            ["", *("infeasible" if other == index else "" for other in ("J1", "J3", "J5"))]
        ] * 3


@pytest.mark.parametrize(("tolerance", "values"), [({}, ""), ({"c": 0.2}, " with nominal values")])
def test_limits_are_told_to_hold_without_the_tolerances(study, tolerance, values):
    data = designs()
    kept = np.zeros(data["status"].shape, dtype=bool)
    results = limited(data, np.zeros((*kept.shape, 2), dtype=bool), kept)
    told = conclusion_sentences(results, replace(study, limits=LIMITS, tolerance=tolerance))[-1]
    assert told.startswith("All designs found satisfy r.m.s. suspension travel at most 9 mm and")
    assert f"at most 1.3 kN{values}." in told


def test_no_number_on_a_page_is_parted_from_its_unit(study, sweep_study, tmp_path):
    nearest = "infeasible: no design was found that has suspension travel at most 9 mm; the nearest has 7.5 kN s/m"
    for make, asked in ((designs, study), (sweep, sweep_study)):
        missed = np.ones(make()["status"].shape, dtype=bool)
        data = limited(make(), np.zeros((*missed.shape, 2), dtype=bool), missed)
        data["status"][:] = nearest
        data.attrs["notes"] = "S2: a friction of 12 N was left out"
        page = report(StudyContents(data, replace(asked, limits=LIMITS)), tmp_path).split("<summary>")[0]
        text = re.sub(
            r"<style>.*?</style>|<wbr>|<[^>]*>", lambda tag: "" if tag[0] == "<wbr>" else "|", page, flags=re.S
        )
        assert re.findall(r"\d (?:%|[kmµ]?[Nmg]\b)[^|]*", text) == []
        assert text.count("9\xa0mm; the") == text.count("7.5\xa0kN\xa0s/m") > 0


@pytest.mark.parametrize("where", [[], ["S2"], ["S1", "S3"]])
def test_layouts_that_keep_no_limit_are_named(study, sweep_study, where):
    for make, asked in ((designs, study), (sweep, sweep_study)):
        data = make()
        missed = np.zeros(data["status"].shape, dtype=bool)
        for name in where:
            missed[["S1", "S2", "S3"].index(name)] = True
        if make is sweep:
            missed[..., 1:] = False
        told = conclusion_sentences(
            limited(data, np.zeros((*missed.shape, 2), dtype=bool), missed), replace(asked, limits=LIMITS)
        )
        at = " at 1 of 5 values of k" if make is sweep else ""
        sentences = [f"{name} has no feasible design{at}" for name in where]
        assert told[-1].rstrip(".").partition("1.3 kN. ")[2].split(". ") == (sentences or [""])


def test_the_page_tells_limits_tolerances_and_budgets_where_the_question_is(study, tmp_path):
    asked = replace(study, limits=LIMITS, tolerance={"k": 0.05, "c": 0.15}, quantile=0.95, budgets=("b",))
    missed = np.zeros(designs()["status"].shape, dtype=bool)
    page = report(StudyContents(limited(designs(), np.zeros((*missed.shape, 2), dtype=bool), missed), asked), tmp_path)
    question = re.sub(r"<[^>]*>", " ", page.split('<h2 id="part-1">')[1].split("<h2")[0]).replace("\xa0", " ")
    question = re.sub(r"\s+", " ", question)
    for told in (
        "Limits r.m.s. suspension travel at most 9 mm, r.m.s. dynamic tyre load at most 1.3 kN",
        "Tolerances k ± 5 %, c ± 15 %",
        "Best at the 95 % quantile",
        "Break-even values of b",
    ):
        assert told in question


@pytest.mark.parametrize("letter", ROAD_CLASSES)
@pytest.mark.parametrize("factor", [1.0, 0.6, 1.7])
def test_a_road_is_told_with_its_class(study, letter, factor):
    roughness = ROAD_CLASSES[letter].roughness * factor
    told = dict(vehicle_rows(replace(study, road=replace(study.road, roughness=roughness))))["Road roughness"]
    assert told.endswith(f"({'mean of' if factor == 1.0 else 'in'} class {letter} of ISO 8608)")


def test_two_indices_of_one_kind_are_told_apart_in_the_answer():
    results = designs().assign_coords(
        index=["comfort", "whole-body-motion", "force-of-c"],
        other=["comfort", "whole-body-motion", "force-of-c"],
        index_title=("index", ["ride comfort", "ride comfort", "force of an element"]),
    )
    for data in (results, results.expand_dims(k=[1.0]).transpose("layout", "index", "k", ...)):
        if "k" in data.dims:
            data["k"].attrs = {"units": "N/m", "long_name": "k"}
        told = sweep_headlines(data) if "k" in data.dims else verdict_sentences(data)
        names = ("ride comfort", "ride comfort (whole-body-motion)", "force of an element (force-of-c)")
        for sentence, name in zip(told, names, strict=True):
            assert f"{name} compared" in sentence or f"{name}." in sentence or f"{name};" in sentence, sentence


@pytest.mark.parametrize("worst", [-150.0, -99.0, -np.inf])
def test_a_caption_says_that_something_is_cut_where_it_is(worst):
    for make, kind in ((designs, "improvement"), (sweep, "sweep")):
        data = make()
        data["improvement"].loc[{"layout": "S3", "index": "J3"}] = worst
        cut = {figure.name: " cut." in figure.caption for figure in study_figures(data) if kind in figure.name}
        assert cut == {name: worst == -150.0 and name in ("improvement", "sweep-J3") for name in cut}


@pytest.mark.parametrize("signs", [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
def test_a_caption_of_a_map_tells_of_a_heavy_line_where_there_is_one(signs):
    data = a_map()
    row = data["improvement"].transpose("layout", "index", ...)
    for sign, half in zip(signs, (slice(0, 1), slice(1, None)), strict=True):
        row[1:, :, half] = 5.0 * sign
    maps = [figure for figure in study_figures(data) if figure.name.startswith("map-J")]
    assert len(maps) == data.sizes["index"]
    assert {"Heavy line" in figure.caption for figure in maps} == {len(set(signs)) == 2}


@pytest.mark.parametrize("count", [1, 2])
def test_outputs_that_are_not_excited_are_left_out_and_said(count):
    data = designs()
    outputs = data["output_J1"].values.tolist()
    data["gain_J1"].loc[{"output_J1": outputs[-count:]}] = 0.0
    (figure,) = [figure for figure in study_figures(data) if figure.name == "response-J1"]
    with style_context():
        panels = figure.draw().axes
    assert len(panels) == (1 if count == 1 else 2)  # where nothing answers, that is what is shown
    assert ("Not excited, and not shown: pitch acceleration." in figure.caption) == (count == 1)


def test_every_layout_of_a_front_of_three_is_in_its_picture_and_legend():
    criteria, points = ["a", "b", "c"], 5
    random = np.random.default_rng(0)
    data = designs(["S1", "S2"]).assign_coords(
        criterion=criteria, criterion_title=("criterion", criteria), criterion_unit=("criterion", ["m", "N", "m/s^2"])
    )
    shape, dims = (2, points), ("layout", "front_point")
    data = data.assign(
        front_value=((*dims, "criterion"), random.random((*shape, 3)), {"title": "Trade-off between a, b and c"}),
        front_knee=(dims, np.arange(points) == np.full((2, 1), 2)),
        front_jump=(dims, np.zeros(shape, dtype=bool)),
    )
    (figure,) = [figure for figure in study_figures(data) if figure.name == "front"]
    assert figure.caption.startswith("Trade-off between a, b and c: ")
    with style_context():
        drawn = figure.draw()
    assert [text.get_text() for text in drawn.legends[0].get_texts()] == ["S1 (baseline)", "S2"]
    for ax in drawn.axes:
        seen = [line for line in ax.lines if line.get_marker() not in ("", "None") and len(line.get_xdata()) == points]
        assert len(seen) == 2


def test_a_weighted_output_is_called_after_its_lever_or_what_it_is_compared_with(tmp_path):
    text = (EXAMPLES / "half-car.toml").read_text(encoding="utf-8")
    text = re.sub(r"indices = .*", 'indices = ["J1", "dynamic-load-coefficient"]', text)
    text = re.sub(r"(?m)^\s*optimise = .*$", "", re.sub(r"\{ *from = \"([^\"]*)\"[^}]*\}", r'"\1"', text))
    study = load_text(tmp_path, text)
    found = {case: {} for case in cases(study)}
    named = responses(study, found)
    pitch = named["output_J1"].values.tolist()[1]
    assert re.fullmatch(r"pitch_acceleration x [\d.]+ m", pitch)
    loads = it.static_tyre_loads(study.design(next(iter(study.layouts))))
    assert [float(name.split(" over ")[1].split()[0]) for name in named["output_dynamic-load-coefficient"].values] == [
        pytest.approx(load / 1e3, rel=1e-3) for load in loads.values()
    ]


def budget_answer(index, *, value, **others):
    """Of b in S3."""
    error, interval = (None, None) if value is None else (0.0, (value, value))
    return BudgetAnswer(
        layout="S3", index=index, parameter="b", unit="kg", method="norm", value=value, standard_error=error,
        interval=interval, **others,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("status", "crossings", "doubt", "remark"),
    [
        ("ok", [3.0], "", ""),
        ("ok", [3.0, 9.0], "", "equally good at 3 kg and 9 kg"),
        ("unbounded", [], "", "better for every b"),
        ("inaccurate", [3.0], "inaccurate: better for every b", ""),
    ],
)
def test_a_break_even_value_is_marked_only_where_it_is_in_doubt(study, status, crossings, doubt, remark):
    value, message = crossings[0] if crossings else None, "" if status == "ok" else "better for every b"
    found = budget_answer("J1", at_most=False, value=value, crossings=crossings, status=status, message=message)
    (row,) = Budgets().table(TaskResults(replace(study, budgets=("b",)), designs(), [found])).rows
    assert (row.status.partition("; ")[0], row.remark) == (doubt, remark)


@pytest.mark.parametrize("reasons", [["x", "x", "x"], ["x", "y", "x"], ["x", "y", "z"]])
def test_a_reason_for_no_budget_is_told_once_for_all_indices(study, reasons):
    data = designs()
    outcomes = [
        budget_answer(index, at_most=False, value=None, crossings=[], status="unbounded", message=f"{reason} it is.")
        for index, reason in zip(("J1", "J3", "J5"), reasons, strict=True)
    ]
    told = " ".join(conclusion_sentences(data, replace(study, budgets=("b",)), outcomes)[3:])
    assert [told.count(f"{reason} it is") for reason in dict.fromkeys(reasons)] == [1] * len(set(reasons))
    assert [told.count(title) for title in ("ride comfort", "dynamic tyre load", "dynamic load carrying")] == [1, 1, 1]


@pytest.mark.parametrize(
    ("at_most", "crossings", "told"),
    [
        (True, [20.0], "up to 20 kg"),
        (True, [20.0, 70.0], "up to 20 kg"),
        (True, [5.0, 20.0], "from 5 kg to 20 kg"),
        (True, [5.0, 20.0, 70.0], "from 5 kg to 20 kg"),
        (False, [20.0], "above 20 kg"),
        (False, [5.0, 20.0], "above 20 kg"),
        (False, [20.0, 70.0], "from 20 kg to 70 kg"),
    ],
)
def test_a_budget_is_told_with_both_ends_of_the_range_that_it_is_the_end_of(study, at_most, crossings, told):
    found = budget_answer("J1", at_most=at_most, value=20.0, crossings=crossings, status="ok")
    assert (
        f"S3 is better than S1 {told} in ride comfort."
        in conclusion_sentences(designs(), replace(study, budgets=("b",)), [found])[3]
    )


@pytest.mark.parametrize("rows", [1, 12, 13, 40])
def test_long_tables_of_facts_may_go_on_on_the_next_sheet(study, tmp_path, rows):
    elements = {f"k{i}": it.Spring(1e3 + i) for i in range(rows)}
    layouts = {"S1": StrutLayout({"strut": " | ".join(elements)})}
    page = report(StudyContents(designs(), replace(study, elements=elements, layouts=layouts)), tmp_path)
    table = re.search(r'<table class="([^"]*)">\s*<caption><span>Elements', page)
    assert table
    assert table[1].split() == ["facts", *(["short"] if rows <= 12 else [])]
    kept = re.search(r"@media print \{.*?([^}]*)\{ break-inside: avoid; \}\s*figure svg", page, re.S)
    assert kept
    assert {"table.short", "tr"} <= set(re.split(r",\s*", kept[1].strip()))
    assert "facts" not in kept[1]


def test_notes_are_sentences_and_their_numbers_are_printed(study, tmp_path):
    data = designs()
    data.attrs["notes"] = "the road has the roughness 2.25325e-07 m^3/cycle\nS2: a friction of -3 N was left out"
    text = re.sub(r"<[^>]*>", "|", report(StudyContents(data, study), tmp_path)).replace("\xa0", " ")
    assert "|The road has the roughness 2.25325 × 10⁻⁷ m³/cycle|" in text
    assert "|S2: a friction of −3 N was left out|" in text


@pytest.mark.parametrize("roughness", [2.25325150879e-07, 1.2345678e-6])
def test_a_roughness_that_was_measured_has_no_more_digits_than_it_bears(study, roughness):
    none = np.zeros(0)
    spectrum = RoadSpectrum(none, none, 1e-4, 2.0, 2.0 * roughness / N0**2, 1.2, 0.01, 2.8, 60)
    line = MeasuredLine(Path("road.csv"), "0" * 64, "", spectrum)
    measured = dict(vehicle_rows(replace(study, road=replace(study.road, roughness=roughness), line=line)))
    digits = re.match(r"[\d.]+", measured["Road roughness"])
    assert digits
    assert len(digits[0].replace(".", "")) == 4
    assert float(digits[0]) == pytest.approx(roughness / 10 ** math.floor(math.log10(roughness)), rel=1e-3)


def test_a_missing_value_of_another_index_has_its_reason(study, tmp_path):
    """An index that fails says why in the table of the designs that are best for another one too."""
    results = with_value(designs(), np.nan, "failed: no amplitude", layout="S2", index="J5")
    results["other_value"].loc[{"layout": "S2", "other": "J5"}] = np.nan
    for table in trade_off_tables(results):
        assert [row.status for row in table.rows] == ["", "J5: failed: no amplitude", ""]
    page = report(StudyContents(results, study), tmp_path)
    assert page.count("J5: failed: no amplitude") == 3  # of designs that are best for J1, for J3 and for itself
