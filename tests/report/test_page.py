"""The report page: it holds the answer, needs no other file, and what is filled in cannot break it."""

import math
import re
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from folders import EXAMPLES
from report_pages import Page
from study_text import load_text, study_text
from synthetic import LONG, designs, judged, sweep, with_value
from wang_su import paper_half_car

import inerter as it
from inerter.figures.layouts import draw_layouts
from inerter.figures.study import draw_study
from inerter.files.study.loading import load_study
from inerter.report.page import environment, report, write_report
from inerter.report.problem_statement import index_rows
from inerter.report.study_contents import StudyContents
from inerter.table import Cell, Column, Row, Table, cells, columns
from inerter.tasks.budgets import BudgetAnswer

SPACE = "\N{NO-BREAK SPACE}"


@pytest.fixture(scope="session")
def study():
    return load_study(EXAMPLES / "quarter-car.toml")


@pytest.fixture(scope="session")
def sweep_study():
    return load_study(EXAMPLES / "stiffness-sweep.toml")


def test_the_answer_is_on_the_page(study, tmp_path):
    results = designs()
    page = Page(report(StudyContents(results, study), tmp_path))
    best = results["value"].sel(index="J1").min().item()
    assert "S3 is 12.0 % better than S1 in ride comfort (J1)." in page.text
    assert f"{best:.4g} m/s²+12.0 %" in page.text
    assert "14 of 16" in page.text
    assert "at its upper bound" in page.text
    assert page.text.count("at its upper bound") == 2  # in the verdict, and in the table


def test_methods_and_budgets_are_on_the_page(study, sweep_study, tmp_path):
    found = BudgetAnswer(
        layout="S2",
        index="J1",
        parameter="f",
        unit="N",
        method="expected-value",
        at_most=True,
        value=280.5,
        standard_error=6.6,
        interval=(265.3, 296.7),
        crossings=[280.5, 900.0],
        status="ok",
        message="",
    )
    endless = replace(found, layout="S3", value=None, crossings=[], status="unbounded", message="better for every f")
    results = judged(designs())
    asked = replace(study, evaluate=("norm", "expected-value"), indices=("J1",), settings={"force": 1e3})
    asked = replace(asked, elements={**study.elements, "f": it.Friction(10.0)})
    text = Page(report(StudyContents(results, asked, [found, endless]), tmp_path)).text.replace(SPACE, " ")
    assert "2.4447 ± 0.0098+6.00 ± 0.31 %" in text
    assert "up to 280.5 ± 6.6 N" in text
    assert "Friction f, S3, ride comfort: better for every f." in text
    assert "S2, J1 – equally good at 280.5 N and 900 N" in text
    assert "S3, J1 – better for every f" in text
    poor = replace(found, layout="S3", status="inaccurate", message="it sticks. Take expected-value")
    doubtful = Page(report(StudyContents(results, asked, [found, poor]), tmp_path)).text.replace(SPACE, " ")
    not_certain = (
        "Not certain (their table says why): the break-even values of friction f for S3, up to 280.5 ± 6.6 N in"
    )
    assert f"{not_certain} ride comfort" in doubtful
    assert doubtful.count("it sticks. Take expected-value") == 1  # in the table
    assert "S3 is better than" not in doubtful
    assert "not certain: up to 280.5 ± 6.6 N" in doubtful
    assert "Values by simulation (in files: expected-value) are means over simulations" in text
    assert "Each mean is over 8 random inputs, which seed 0 decides" in text
    assert "The sinusoidal force of J5 has an amplitude of 1 kN." in text
    swept = judged(sweep())
    swept["improvement"].loc[{"layout": "S2", "index": "J1", "method": "expected-value"}] = [-4.0, -1.0, 1.0, 3.0, 6.0]
    text = Page(report(StudyContents(swept, sweep_study), tmp_path)).text.replace(SPACE, " ")
    assert re.search(r"J1: S2 and S1 are equally good at k = \d+ ± \d+ kN/m by simulation\.", text)
    assert "over k in kN/m, by simulation" in text


def test_the_question_is_on_the_page_in_the_digits_of_the_study_file(study, tmp_path):
    text = Page(report(StudyContents(designs(), study), tmp_path)).text
    for words in ("181.75 kg", "25 m/s (90 km/h)", "5 × 10⁻⁷ m³/cycle", "free, 100 N s/m to 100 kN s/m"):
        assert words in text
    for layout in study.layouts.values():
        assert layout.struts["strut"] in text


@pytest.mark.parametrize("hostile", ["<script>alert(1)</script>", '"><img src=x onerror=y>', "{{ 7 * 7 }} & <co>"])
def test_what_is_filled_in_is_only_text(study, tmp_path, hostile):
    results = with_value(designs(), math.inf, f"failed: {hostile}", layout="S2", index="J1")
    results.attrs |= {"title": hostile, "notes": hostile}
    source = report(StudyContents(results, study), tmp_path)
    page = Page(source)
    assert hostile not in source
    assert page.text.count(hostile) == 5  # in the title of the page, its heading, the verdict, the status and the notes
    assert not {"script", "img"} & set(page.tags)


@pytest.fixture(scope="module", params=sampled([designs, sweep], [designs], kept=0), ids=["designs", "sweep"])
def long_names(request, study, sweep_study, tmp_path_factory):
    """The source of a page with its figures, and their folder."""
    folder, results = tmp_path_factory.mktemp("figures"), request.param(LONG)
    draw_study(results, folder)
    return report(StudyContents(results, study if "omega" in results else sweep_study), folder), folder


def test_the_page_needs_no_other_file_and_names_each_thing_once(long_names):
    source, folder = long_names
    page = Page(source)
    assert page.tags.count("svg") == len(list(folder.glob("*.svg")))
    assert "<?xml" not in source
    assert not {"script", "link", "img", "iframe", "object"} & set(page.tags)
    names = Counter(value for key, value in page.attributes if key == "id")
    assert set(names.values()) == {1}
    references = [value for key, value in page.attributes if key in ("href", "src", "xlink:href")]
    references += re.findall(r"url\(([^)]*)\)", source)
    assert references
    assert {reference.removeprefix("#") for reference in references} <= set(names)


def test_what_may_be_wider_than_the_screen_says_so(long_names):
    source, _ = long_names
    wide = sum(source.count(tag) for tag in ("<table", "<svg", "<pre>"))
    assert wide == source.count(" is wider than the screen: scroll it sideways.")


def test_words_in_a_table_may_go_over_several_lines_and_a_last_column_of_words_is_a_verdict():
    verdicts = [Cell("as far as known", strong=strong) for strong in (True, False)]
    rows = [Row([*cells("a", "1 m"), verdict], status="it is long") for verdict in verdicts]
    table = Table("Verdicts", [*columns("Case", "Value"), Column("Verdict", prose=True)], rows)
    source = environment().get_template("tables.html").module.grid(table)
    assert '<table class="short judged">' in source
    assert [source.count(f"<td{attributes}>") for attributes in (' class="own prose"', ' class="prose"', "")] == [
        1,
        1,
        2,
    ]
    assert source.count("<span>a – it is long</span>") == 2
    assert not replace(table, columns=columns("Case", "Value", "Verdict")).has_verdict


@pytest.mark.campaign
def test_figures_that_were_not_drawn_are_left_out(study, tmp_path):
    assert "<figure>" not in report(StudyContents(designs(), study), tmp_path)
    draw_study(designs(), tmp_path)
    (tmp_path / "improvement.svg").unlink()
    assert report(StudyContents(designs(), study), tmp_path).count("<figure>") == 3


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    """The folder of the figures of the designs."""
    folder = tmp_path_factory.mktemp("drawn")
    draw_study(designs(), folder)
    return folder


@pytest.mark.campaign
def test_the_same_results_give_the_same_page(study, figures, tmp_path):
    first = write_report(StudyContents(designs(), study), figures, tmp_path / "1.html")
    second = write_report(StudyContents(designs(), study), figures, tmp_path / "2.html")
    assert first.read_bytes() == second.read_bytes()
    for folder in (tmp_path, figures, EXAMPLES):
        assert str(folder) not in first.read_text(encoding="utf-8")


def test_values_that_are_not_ok_stand_with_their_sentence(study, sweep_study, tmp_path):
    status = "unstable: the design has no finite norm"
    results = with_value(designs(), math.inf, status, layout="S2", index="J3")
    text = Page(report(StudyContents(results, study), tmp_path)).text
    assert "S2inf−inf %" in text
    assert f"S2 – {status}" in text
    results = with_value(sweep(), math.inf, status, layout="S2", index="J3", k=60e3)
    text = Page(report(StudyContents(results, sweep_study), tmp_path)).text
    assert f"S2 at k = 60 kN/m: {status}" in text


def test_a_design_for_one_index_is_shown_with_its_other_indices(study, tmp_path):
    results = designs()
    text = Page(report(StudyContents(results, study), tmp_path)).text
    for other in ("J1", "J3"):
        value = results["other_value"].sel(layout="S2", index="J1", other=other).item()
        assert f"{value:.4g}" in text


def test_a_long_sweep_is_shown_at_some_values_and_at_both_ends(sweep_study, tmp_path):
    stiffness = np.linspace(10e3, 309e3, 300)
    text = Page(report(StudyContents(sweep(stiffness=stiffness), sweep_study), tmp_path)).text
    shown = re.search(r"over k in kN/m, (\d+) of 300 values", text)
    assert shown
    assert 8 <= int(shown[1]) <= 17
    assert "12.0 % better at every k" in text
    page = report(StudyContents(sweep(stiffness=stiffness), sweep_study), tmp_path)
    assert '<th scope="row">10</th>' in page
    assert '<th scope="row">309</th>' in page


def test_a_study_of_one_layout_compares_nothing(study, tmp_path):
    text = Page(report(StudyContents(designs(["S1"], baseline=""), study), tmp_path)).text
    assert "Improvement" not in text
    assert "Ride comfort (J1) of S1 is 2.525 m/s²; there is no other strut to compare it with." in text.replace(
        SPACE, " "
    )


def test_a_page_has_contents_that_lead_to_its_parts(study, figures):
    source = report(StudyContents(designs(), study), figures)
    contents = re.search(r'<nav class="contents".*?</nav>', source)
    assert contents
    links = re.findall(r'<a href="#(part-\d+)">(.*?)</a>', contents[0])
    assert links == re.findall(r'<h2 id="(part-\d+)">(.*?)</h2>', source)
    assert len(links) == source.count("<h2") >= 5


def test_networks_are_drawn_where_the_question_is(study, tmp_path):
    files = draw_layouts(study, tmp_path)
    assert sum(file.suffix == ".svg" for file in files) == len(study.layouts)
    source = report(StudyContents(designs(), study), tmp_path)
    page = Page(source)
    asked = source.partition("Problem definition</h2>")[2].partition("<h2")[0]
    assert page.tags.count("svg") == asked.count("<svg") == len(study.layouts)
    names = Counter(value for key, value in page.attributes if key == "id")
    assert set(names.values()) == {1}
    assert asked.count("This drawing is wider than the screen") == len(study.layouts)


def test_layouts_that_differ_by_case_alone_have_files_of_their_own(tmp_path):
    """Some systems of files take `S1.svg` and `s1.svg` for one."""
    text = study_text('indices = ["J1"]', layouts='S1 = "k | c"\ns1 = "k | c | b"')
    study = load_text(tmp_path, text)
    files = draw_layouts(study, tmp_path / "figures")
    assert len({file.name.lower() for file in files}) == len(files) == 2
    drawn = [file.read_text(encoding="utf-8") for file in files]
    assert drawn[0] != drawn[1]
    asked = (
        report(StudyContents(designs(), study), tmp_path / "figures")
        .partition("Problem definition</h2>")[2]
        .partition("<h2")[0]
    )
    assert asked.count("<svg") == 2


def test_an_index_of_several_outputs_says_how_they_are_combined():
    """The sentences on a half car, each held to the sum of norms of single outputs that it states."""
    half = load_study(EXAMPLES / "half-car.toml")
    told = dict(index_rows(half))
    assert told["Dynamic tyre load (J3)"] == "sum of the r.m.s. values of tyre front load and tyre rear load"
    assert told["Ride comfort (J1)"].startswith("sum of the r.m.s. values of sprung acceleration and ")
    lever = float(told["Ride comfort (J1)"].split(" and ")[1].removesuffix(" m/rad times pitch acceleration"))
    parts = {
        "J3": {"tyre_front_load": 1.0, "tyre_rear_load": 1.0},
        "J1": {"sprung_acceleration": 1.0, "pitch_acceleration": lever},
    }
    car = paper_half_car(*[it.Spring(60e3) | it.Damper(3e3)] * 2)
    for name, outputs in parts.items():
        index = half.index(name)
        single = [it.RandomResponse({output: 1.0}, index.road) for output in outputs]
        rms = [it.evaluate(car, one, it.Norm()).value for one in single]
        total = sum(weight * each for weight, each in zip(outputs.values(), rms, strict=True))
        assert it.evaluate(car, index, it.Norm()).value == pytest.approx(total, rel=1e-10)


def test_a_peak_gain_says_from_what_to_what(study):
    assert dict(index_rows(study))["Dynamic load carrying (J5)"] == (
        "largest gain over frequency from sprung force to sprung displacement"
    )


def test_an_index_is_described_where_every_layout_has_a_free_network():
    searched = load_study(EXAMPLES / "search_absorber.toml")
    only = replace(searched, layouts={"any": searched.layouts["any"]})
    assert index_rows(only) == index_rows(searched)
