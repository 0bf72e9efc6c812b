"""Faults that were found in the page, and do not come back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from browser import EXAMPLES, Served, Visitor, wait_until
from study_text import PAPER_CAR, study_text


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
    visitor.page.locator(f"[aria-label=Layouts] button[title^='{name}']").first.click()


@pytest.mark.parametrize(
    ("place", "text", "words"),
    [
        ("elements.k", "5 kg", ["5 kg", "N/m"]),
        ("elements.k", "12 furlong", ["furlong", "N/m"]),
        ("elements.k", "7", ["unit missing"]),
        ("elements.c", "9 N", ["9 N", "N s/m"]),
        ("vehicle.sprung_mass", "3 m", ["3 m", "kg"]),
        ("elements.k", "x" * 250, []),
    ],
)
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
    _fill(visitor, "elements.ks", "900 kN/m")  # any other change takes the sentence away
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
    assert page.locator(".answers [data-better]").inner_text().endswith("%")
    _fill(visitor, "elements.toString", "3 kN s/m")
    visitor.settled()
    _layout(visitor, "S1")
    visitor.wait_for_text("constructor | toString")
    visitor.settled()


def _rename(visitor: Visitor, old: str, new: str) -> None:
    page = visitor.page
    page.locator(f".drawing [aria-label^='{old},']").first.click()
    page.wait_for_function("old => document.getElementById('element-name').value === old", arg=old)
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
    assert page.locator("[aria-label=Layouts] button[title^='S1']").count() == 1


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
    assert "%" in page.locator(".answers [data-better]").first.inner_text()
    assert page.locator(".plot canvas").count() > 0
    told = page.locator(".answers .problems").inner_text()
    assert told.count("layouts.S3e") == 1
