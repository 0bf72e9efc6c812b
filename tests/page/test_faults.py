"""Faults that were found in the page, and do not come back."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from browser import Served, Visitor, wait_until
from campaigns import sampled
from folders import EXAMPLES
from study_text import PAPER_CAR, study_text

import inerter as it
from inerter.app.about import examples
from inerter.files.rig.loading import load_rig
from inerter.files.study.loading import load_study


def _open(visitor: Visitor, folder: Path, name: str, text: str) -> None:
    path = folder / f"{name}.toml"
    path.write_text(text)
    visitor.open(path)
    visitor.page.wait_for_selector(f"text={name}.toml is open")
    visitor.settled()


def _fill(visitor: Visitor, place: str, text: str) -> None:
    entry = visitor.page.locator(f"[id='entry {place}']")
    entry.fill(text)
    entry.press("Enter")


def _layout(visitor: Visitor, name: str) -> None:
    visitor.page.locator(f"[aria-label=Layouts] .pick[title='{name}']").click()


WRONGLY_TYPED: list[tuple[str, str, list[str]]] = [
    ("elements.k", "5 kg", ["5 kg", "N/m"]),
    ("elements.k", "12 furlong", ["furlong", "N/m"]),
    ("elements.c", "9 N", ["9 N", "N s/m"]),
    ("vehicle.sprung_mass", "3 m", ["3 m", "kg"]),
    ("elements.k", "x" * 250, []),
]


@pytest.mark.parametrize(("place", "text", "words"), sampled(WRONGLY_TYPED, often=WRONGLY_TYPED[:1], kept=1))
def test_a_text_of_another_dimension_is_an_error_at_its_field(
    visitor: Visitor, place: str, text: str, words: list[str]
) -> None:
    """A spring does not become an inerter by what is typed: nothing changes, and the field says why."""
    page = visitor.page
    visitor.settled()
    before, entry = visitor.values(), page.locator(f"[id='entry {place}']")
    old = entry.get_attribute("title")
    _fill(visitor, place, text)
    told = page.locator(f"[data-place='{place}'] .problem")
    told.wait_for()
    assert all(word in told.inner_text() for word in words), told.inner_text()
    assert entry.get_attribute("title") == old
    assert entry.get_attribute("aria-invalid") == "true"
    assert visitor.values() == before
    _fill(visitor, "road.speed", "26 m/s")  # any other change takes the sentence away
    told.wait_for(state="detached")


def test_a_quantity_in_another_unit_is_taken_over(visitor: Visitor) -> None:
    page = visitor.page
    visitor.settled()
    _fill(visitor, "elements.k", "120 N/mm")
    page.wait_for_selector("[id='entry elements.k'][title='120 N/mm']")
    assert page.locator("[data-place='elements.k'] .problem").count() == 0
    _fill(visitor, "elements.k", "685.22 lbf/inch")
    page.wait_for_selector("[id='entry elements.k'][title='685.22 lbf/inch']")


def test_sizes_that_nothing_has_are_answered_at_once(visitor: Visitor) -> None:
    """Whatever number is typed, no answer takes long, and nothing of the page stands still or fails."""
    page = visitor.page
    visitor.settled()
    for text in ("1e60 N/m", "1e300 N/m", "1e-60 N/m", "1e50 N/m", "1e-50 N/m", "1e40 N/m", "1e-40 N/m", "1e20 N/m"):
        for tab in ("response", "history"):
            page.click(f"#tab-{tab}")
            _fill(visitor, "elements.k", text)
            page.wait_for_function("() => !document.querySelector('[aria-busy=true]')", timeout=15_000)
            shown = page.inner_text("main")
            assert "Invalid array" not in shown
            assert "fault of the program" not in shown, shown
    assert visitor.faults == []


ODD = study_text(
    'indices = ["J1"]\noptimise = "norm"',
    vehicle=PAPER_CAR,
    elements='constructor = "120 kN/m"\ntoString = { from = "100 N s/m", to = "100 kN s/m" }\nvalueOf = "300 kg"',
    layouts='S1 = "constructor | toString"\n__proto__ = "constructor | toString - valueOf"',
    title='title = "Odd names"',
)


def test_names_of_the_language_are_ordinary_names(visitor: Visitor, tmp_path: Path) -> None:
    _open(visitor, tmp_path, "odd", ODD)
    page = visitor.page
    assert visitor.text == "constructor | toString - valueOf"
    assert visitor.values()["J1"] > 0.0
    assert "%" in page.inner_text(".answers tr.on")
    _fill(visitor, "elements.toString", "3 kN s/m")
    visitor.settled()
    _layout(visitor, "S1")
    visitor.wait_for_text("constructor | toString")
    visitor.settled()


def _rename(visitor: Visitor, old: str, new: str) -> None:
    page = visitor.page
    page.evaluate("() => document.querySelectorAll('details[open].menu').forEach(menu => { menu.open = false; })")
    page.locator(f".drawing [aria-label^='{old},']").first.click()
    page.wait_for_function("old => document.getElementById('element-name').value === old", arg=old)
    if not page.is_visible("#element-name"):
        page.get_by_text("Part", exact=True).click()
    page.fill("#element-name", new)
    page.keyboard.press("Enter")


REFERENCES = study_text(
    'indices = ["J1", "stroke"]\noptimise = "norm"\ntolerance = { k = "10 %" }\n'
    'subject_to = { stroke = { at_most = "90 mm" } }',
    vehicle=PAPER_CAR,
    elements='k = "120 kN/m"\nc = { from = "100 N s/m", to = "100 kN s/m" }\nb = "300 kg"',
    layouts='S1 = "k | c"\nS3 = "k | c - b"',
    title='title = "References"',
)
REFERENCES += '[indices.stroke]\nkind = "element-stroke"\nelement = "k"\n'


def test_an_element_is_renamed_wherever_the_study_names_it(visitor: Visitor, tmp_path: Path) -> None:
    _open(visitor, tmp_path, "references", REFERENCES)
    page, before = visitor.page, visitor.values()
    for old, new in (("k", "constructor"), ("constructor", "main_spring"), ("c", "toString")):
        _rename(visitor, old, new)
        page.wait_for_function("new_ => document.getElementById('network-text').value.includes(new_)", arg=new)
        assert visitor.values() == before
        assert page.locator(".problem").count() == 0
    saved = visitor.download("Study file", tmp_path).read_text()
    assert 'element = "main_spring"' in saved
    assert 'main_spring = "10 %"' in saved or "main_spring = 0.1" in saved


def test_a_name_that_is_taken_is_refused_in_a_sentence(visitor: Visitor) -> None:
    page = visitor.page
    visitor.settled()
    text = visitor.text
    _rename(visitor, "k", "c")
    page.wait_for_selector("form:has(#element-name) .problem")
    assert "name of another element" in page.inner_text("form:has(#element-name) .problem")
    assert visitor.text == text
    page.get_by_text("This layout", exact=True).click()
    page.get_by_role("button", name="Rename…").click()
    page.locator("form:has-text('New name') input").fill("S1")
    page.keyboard.press("Enter")
    page.wait_for_selector(".notice:has-text('another layout')")
    assert page.locator("[aria-label=Layouts] .pick[title='S1']").count() == 1


def test_a_wrong_name_of_one_layout_leaves_the_others_their_answers(visitor: Visitor) -> None:
    page = visitor.page
    _layout(visitor, "S2")
    visitor.settled()
    before = visitor.values()
    _layout(visitor, "S3e")
    page.fill("#network-text", "k | c - nope")
    page.wait_for_selector(".problem:has-text('nope')")
    _layout(visitor, "S2")
    visitor.settled()
    wait_until(lambda: page.locator("td[data-index]").first.get_attribute("data-value") not in (None, ""))
    assert visitor.values() == before
    assert "%" in page.inner_text(".answers tr.on")
    assert page.locator(".plot .drawn").count() > 0
    assert page.inner_text(".problems").count("layouts.S3e") == 1


def test_a_file_that_another_program_changes_is_told_and_read_again(
    serve: Callable[..., Served], visitors: Callable[..., Visitor], tmp_path: Path
) -> None:
    file = tmp_path / "mine.toml"
    text = study_text('indices = ["J1"]', title='title = "Mine"')
    file.write_text(text)
    visitor = visitors(serve(file)).visit()
    page = visitor.page
    before = visitor.values()
    assert page.locator(".notice").count() == 0
    file.write_text(text.replace('"20 kN/m"', '"30 kN/m"'))
    notice = page.locator(".notice:has-text('mine.toml has changed')")
    notice.wait_for()
    assert visitor.values() == before  # nothing changes by itself
    page.reload()
    page.wait_for_selector("[data-connection=ready]", state="attached")
    notice.wait_for()  # a page that keeps its work says so too
    assert page.locator("[id='entry elements.k']").get_attribute("title") == "20 kN/m"
    notice.get_by_role("button", name="Reload").click()
    page.wait_for_selector("[id='entry elements.k'][title='30 kN/m']")
    assert visitor.values() != before
    assert notice.count() == 0
    visitors(visitor.served).visit().page.wait_for_selector("[id='entry elements.k'][title='30 kN/m']")
    file.write_text("[vehicle\n")
    page.wait_for_selector(".notice:has-text('cannot be read')")
    file.unlink()
    page.wait_for_selector(".notice:has-text('removed or renamed')")


def test_work_that_is_done_says_nothing_of_a_step(visitor: Visitor) -> None:
    page = visitor.page
    visitor.settled()
    page.click("#tab-work")
    jobs, count = page.locator(".job"), "count => document.querySelectorAll('.job').length === count"
    before = jobs.count()  # of other tests, on the same server
    page.locator("form.begin:has-text('Run the whole study')").get_by_role("button", name="Begin").click()
    page.wait_for_function(count, arg=before + 1)
    page.wait_for_selector(".job:first-child[data-state=done] table", timeout=120_000)
    assert "figures and report" not in jobs.first.inner_text()
    assert jobs.first.locator("> p.quiet").count() == 0
    jobs.first.get_by_role("button", name="Forget").click()
    page.wait_for_function(count, arg=before)


def _fits(visitor: Visitor, count: int) -> Any:
    """The newest fit, once so many are done."""
    visitor.page.wait_for_function(
        "count => document.querySelectorAll('.fit[data-state=done] table').length === count", arg=count, timeout=240_000
    )
    return visitor.page.locator(".fit").first


@pytest.mark.marathon
def test_a_fit_that_is_withheld_offers_what_it_advises(visitor: Visitor, tmp_path: Path) -> None:
    """First the reason and the likeliest cause, with a button each for what to do; then the device that it led to."""
    page = visitor.page
    visitor.settled()
    record = tmp_path / "screw.csv"
    it.write_record(replace(load_rig(EXAMPLES / "rig_fit.toml"), duration=1.0).run(), record)
    visitor.open(record)
    page.wait_for_selector(".records li")
    page.select_option("select[name=model]", "friction")
    page.get_by_role("button", name="Identify").click()
    fit = _fits(visitor, 1)
    told = fit.inner_text()
    assert "null" not in told
    assert "undefined" not in told
    assert told.index("times the sensor noise") < told.index("Possible causes") < told.index("95 % interval")
    assert "the device is compliant" in told
    assert fit.locator("td:text-is('withheld')").count() == 3
    assert fit.get_by_role("button", name="Take the device").count() == 0
    assert fit.locator("form:has-text('Fixture mass') input").count() == 1
    assert fit.locator("button.main").count() == 1
    fit.get_by_role("button", name="Fit the model elastic-friction").click()
    fit = _fits(visitor, 2)
    assert "elastic-friction" in fit.locator("b").first.inner_text()
    fit.locator("form:has-text('Fixture mass') input").fill("heavy")
    fit.locator("form:has-text('Fixture mass')").get_by_role("button").click()
    page.wait_for_selector(".fit[data-state=failed] .problem")
    assert "heavy" in page.inner_text(".fit[data-state=failed] .problem")
    page.locator(".fit[data-state=failed]").get_by_role("button", name="Forget").click()
    page.wait_for_selector(".fit[data-state=failed]", state="detached")
    fit = _fits(visitor, 2)
    fit.get_by_role("button", name="Take the device").click()
    page.wait_for_selector(".notice:has-text('The device is in the new layout')")
    assert visitor.text == "k | c - (ks2 | cs2) - (b2 | f)"
    assert "in place of b" in page.inner_text(".notice:has-text('The device is in the new layout')")
    for left in (1, 0):
        page.locator(".fit").first.get_by_role("button", name="Forget").click()
        page.wait_for_function("left => document.querySelectorAll('.fit').length === left", arg=left)


MARKUP = "<img src=//evil.example/x onerror=window.struck=1>"
NAMES = [MARKUP, "\"'><svg onload=window.struck=1>", "\u202etxt.exe", "${window.struck=1}", "javascript:struck=1"]


@pytest.mark.parametrize("name", sampled(NAMES, kept=1))
def test_markup_in_names_and_units_is_text(visitor: Visitor, tmp_path: Path, name: str) -> None:
    """Titles, layouts, elements, units, designs, files: what is written in them is shown, never run or asked for."""
    page = visitor.page
    quoted = json.dumps(name, ensure_ascii=False)
    text = study_text('indices = ["J1"]', title=f"title = {quoted}")
    _open(visitor, tmp_path, "marked", text)
    assert page.input_value("input.title") == name
    _fill(visitor, "elements.k", f"5 {name}")
    page.wait_for_selector("[data-place='elements.k'] .problem")
    _rename(visitor, "k", name)
    page.wait_for_selector("form:has(#element-name) .problem")
    page.fill("#network-text", f"k | {name}")
    page.wait_for_selector("#network-problem")
    page.keyboard.press("Control+z")
    spoilt = (
        text.replace("[layouts]", f'[layouts]\n{quoted} = "k | c"'),
        text.replace("[elements]", f"[elements]\n{quoted} = {quoted}"),
        text.replace('speed = "25 m/s"', f"speed = {quoted}"),
        f"[{quoted}]\n{quoted} = {quoted}\n" + text,
        f"= {quoted}",
    )
    for number, of in enumerate(spoilt):
        path = tmp_path / f"spoilt {number} {name.replace('/', '_')[:40]}.toml"
        path.write_text(of)
        visitor.open(path)
        page.locator(".notice", has_text=f"spoilt {number} ").first.wait_for()
        visitor.drawn()
    (tmp_path / "record.csv").write_text(
        f"time [s],{quoted},force [{name}]\n" + "".join(f"{0.001 * i},{i % 7},{i % 5}\n" for i in range(300))
    )
    visitor.open(tmp_path / "record.csv")
    page.locator(".notice", has_text="record.csv", has_not_text="Reading").wait_for()
    visitor.drawn()
    assert page.evaluate("() => [window.struck, document.querySelectorAll('body img, body svg[onload]').length]") == [
        None,
        0,
    ]
    assert visitor.elsewhere == []


def _shown(visitor: Visitor) -> Any:
    """Numbers, curves and messages on the page."""
    visitor.settled()
    visitor.drawn()
    return visitor.page.evaluate(
        """() => {
          const texts = (selector) => [...document.querySelectorAll(selector)].map(each => each.textContent.trim());
          return {
            numbers: [...document.querySelectorAll(".answers [data-value], .answers [data-better]")]
              .map(each => [each.dataset.index, each.dataset.value, each.dataset.better]),
            names: texts(".answers th"),
            verdict: texts("#verdict"),
            doubts: texts(".problem, .doubts, .unchosen"),
          };
        }"""
    )


DESIGNS = [name for name, path in examples().items() if not load_study(path).free_networks]
PAIRS = [(first, other) for first in DESIGNS for other in DESIGNS if first != other]


Windows = Callable[..., Visitor]
ALONE: dict[str, Any] = {}  # what the page shows of an example that is the first to be opened in a window


def _alone(visitors: Windows, served: Served, name: str) -> Any:
    if name not in ALONE:
        visitor = visitors(served).visit()
        _example(visitor, name)
        ALONE[name] = _shown(visitor)
        visitor.page.close()
    return ALONE[name]


def _example(visitor: Visitor, name: str) -> None:
    visitor.open(EXAMPLES / f"{name}.toml")
    visitor.page.wait_for_selector(f".notice:has-text('{name}.toml is open')")
    visitor.page.wait_for_selector(".answers[data-being=current], .answers[data-being=none]", timeout=120_000)


@pytest.mark.parametrize(
    ("first", "other"), sampled(PAIRS, often=[("train", "half-car"), ("seat", "absorber")], kept=0)
)
def test_an_example_shows_the_same_after_any_other(
    visitor: Visitor, visitors: Windows, served: Served, first: str, other: str
) -> None:
    """What is asked of a study is answered of it: opened alone, and after another one, the page shows the same."""
    expected = _alone(visitors, served, other)
    _example(visitor, first)
    _shown(visitor)
    _example(visitor, other)
    assert _shown(visitor) == expected
    notices = visitor.page.locator(".notice").all_inner_texts()
    assert not [text for text in notices if f"{first}.toml" in text]


def test_a_train_keeps_its_warning_and_a_half_car_its_per_cent_until_chosen(visitor: Visitor) -> None:
    """Values in the middle of their bounds: the warning stands until they are chosen, and no per cent before."""
    page = visitor.page
    _example(visitor, "train")
    visitor.settled()
    for tab in ("history", "response"):
        page.click(f"#tab-{tab}")
        visitor.drawn()
        assert "in the middle of their" in page.inner_text("#tab-panel .unchosen")
        assert "chosen yet" in page.inner_text("#verdict")
        assert page.get_attribute("#verdict", "data-severity") == "open"  # nothing is wrong
    assert "%" not in page.inner_text(".answers table")
    with page.expect_request("**/api/panel/optimise"):
        visitor.open(EXAMPLES / "half-car.toml")
    page.wait_for_selector(".notice:has-text('half-car.toml is open')")
    visitor.settled()
    assert page.locator(".unchosen").count() == 0
    assert "%" in page.inner_text(".answers table")


def test_a_tolerance_that_the_method_neglects_has_no_number(visitor: Visitor) -> None:
    page = visitor.page
    _example(visitor, "ball_screw")
    visitor.settled()
    page.click("#tab-tolerance")
    page.locator("#tab-panel").get_by_role("button", name="Compute").click()
    row = page.locator("[aria-label='Which value matters'] tr:has(th:text-is('f'))")
    row.wait_for()
    assert "%" not in row.inner_text()
    told = page.inner_text("#tab-panel")
    assert told.index("ignores the tolerance of f") < told.index("nominal")


CONDITIONS = study_text(
    'indices = ["J1", "J5"]',
    vehicle=PAPER_CAR,
    elements='k = "120 kN/m"\nc = "5 kN s/m"\nd = "7 kN s/m"\nb = "300 kg"\nf = "20 N"',
    layouts='S1 = "k | c"\nS3 = "k | d - (b | f)"',
    title='title = "Conditions"',
)
CONDITIONS += (
    '[[conditions]]\nname = "empty"\nshare = 1\n[[conditions]]\nname = "loaded"\nroad.speed = "30 m/s"\nshare = 3\n'
)


def test_reasons_and_values_in_conditions_are_read_without_a_pointer(visitor: Visitor, tmp_path: Path) -> None:
    """Why J5 of a strut with friction is not computed, and J1 of both struts in each condition."""
    _open(visitor, tmp_path, "conditions", CONDITIONS)
    page, rows = visitor.page, visitor.page.locator("[aria-label=Conditions] tbody tr")
    _layout(visitor, "S3")
    page.locator("[aria-label=Conditions] th:has-text('J1 [m/s²] in condition')").wait_for()
    assert rows.locator("th").all_inner_texts() == ["empty (25 %)", "loaded (75 %)"]
    k, b = it.Spring(120e3), it.Inerter(300.0)
    cars = (it.QuarterCar(181.75, 25.0, 120e3, strut=strut) for strut in (k | it.Damper(7e3) - b, k | it.Damper(5e3)))
    comfort = [
        [it.evaluate(car, it.RideComfort(it.Road(5e-7, v)), it.Norm()).value for v in (25.0, 30.0)] for car in cars
    ]
    values = rows.locator("[data-value]").evaluate_all("all => all.map(cell => Number(cell.dataset.value))")
    assert values == pytest.approx([value for both in zip(*comfort, strict=True) for value in both])
    page.locator(".answers select").first.select_option("statistical-linearisation")
    reasons = page.locator("[aria-label=Reasons]")
    reasons.wait_for()
    assert reasons.inner_text().startswith("J5 of S3: failed: ")
    assert "amplitude of the force" in reasons.inner_text()
    page.click("#step-2")
    force = page.get_by_label("force of J5")
    for text in ("5 kg", "1"):  # a number alone is in the unit of the example
        force.fill(text)
        force.press("Enter")
        if text == "5 kg":
            page.locator("#step-2 ~ .menu-body .problem", has_text="5 kg").wait_for()
            assert reasons.is_visible()
    reasons.wait_for(state="detached")
