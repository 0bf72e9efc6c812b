"""Two to four designs side by side, by the mouse and by the keyboard: what stands there is what Python says."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import pytest
from browser import Visitor, wait_until
from campaigns import sampled
from study_text import PAPER_CAR, study_text

import inerter as it
from inerter.app.designs import design_of
from inerter.app.documents import study_from

STUDY = study_text(
    'indices = ["J1", "J3"]\nevaluate = ["norm", "expected-value"]\nrealisations = 4',
    vehicle=PAPER_CAR,
    elements='k = "120 kN/m"\nc = "5 kN s/m"\nb = "100 kg"\nf = "10 N"',
    layouts='S1 = "k | c"\nS2 = "k | c | b"\nS3 = "k | c - (b | f)"\nS4 = "k | c - (f | b)"\nS5 = "k | c - b"',
    title='title = "Four struts"',
)


def _choose_by_mouse(visitor: Visitor, name: str) -> None:
    group = visitor.page.get_by_role("group", name="Designs to compare")
    group.get_by_role("button", name=name, exact=True).click()


def _choose_by_keyboard(visitor: Visitor, name: str) -> None:
    """From the tab on, by Tab alone, and then with the space bar."""
    page = visitor.page
    page.locator("#tab-compare").focus()
    for _ in range(12):
        page.keyboard.press("Tab")
        if page.evaluate("() => document.activeElement.textContent.trim()") == name:
            page.keyboard.press("Space")
            return
    raise AssertionError(f"{name} is not reached")


def _with_by_mouse(visitor: Visitor, name: str) -> None:
    visitor.page.locator("#tab-panel select").select_option(label=name)


def _with_by_keyboard(visitor: Visitor, name: str) -> None:
    select = visitor.page.locator("#tab-panel select")
    select.focus()
    for _ in range(4):
        if select.evaluate("each => each.selectedOptions[0].textContent") == name:
            return
        visitor.page.keyboard.press("ArrowDown")
    raise AssertionError(f"{name} is not reached")


WAYS = {"mouse": (_choose_by_mouse, _with_by_mouse), "keyboard": (_choose_by_keyboard, _with_by_keyboard)}


def _compared(visitor: Visitor, names: list[str]) -> list[list[dict[str, Any]]]:
    """What stands in the rows of the indices, when the columns are these."""
    page = visitor.page
    page.wait_for_function(
        """names => [...document.querySelectorAll("[aria-label=Comparison] thead th")]
          .map(each => each.textContent).join() === names.join()""",
        arg=names,
    )
    visitor.drawn()
    rows: list[list[dict[str, Any]]] = page.evaluate(
        """() => [...document.querySelectorAll("[aria-label=Comparison] tr:has([data-value])")].map(row =>
          [...row.querySelectorAll("td")].map(each => ({
            value: Number(each.dataset.value),
            best: each.classList.contains("best"),
            said: each.querySelector(".difference")?.textContent ?? "",
          })))"""
    )
    return rows


def _said(two: it.Comparison, scatters: bool) -> tuple[str, ...]:
    """What is to be read of a difference."""
    words = ("as good",) if two.is_tie else ("+",) if two.difference.value < 0.0 else ("−",)
    return (*words, "±") if scatters and two.percent_error >= 0.05 else words  # what changes no digit is not written


@pytest.mark.parametrize(("count", "way"), sampled(product([3, 4], WAYS), kept=0))
def test_designs_stand_side_by_side(way: str, count: int, visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    (tmp_path / "study.toml").write_text(STUDY)
    visitor.open(tmp_path / "study.toml")
    page.wait_for_selector("text=study.toml is open")
    visitor.settled()
    visitor.pick("S5")
    page.click("#tab-compare")
    choose, put_beside = WAYS[way]
    names = ["S1", "S3", "S4", "S2"][:count]
    _compared(visitor, ["S1", "S5"])  # the baseline and the design that is edited, until others are chosen
    for name in ["S5", *names[1:]]:
        choose(visitor, name)
    fifth = page.get_by_role("group", name="Designs to compare").get_by_role("button", name="S5")
    wait_until(lambda: fifth.is_disabled() == (count == 4))
    study = study_from(page.evaluate("() => JSON.parse(sessionStorage.getItem('inerter.document'))")["study"])
    for method, base in (("norm", "S1"), ("expected-value", "S3")):
        page.select_option(".answers select >> nth=0", method)
        put_beside(visitor, base)
        order = [base, *(name for name in names if name != base)]
        rows = _compared(visitor, order)
        assert len(rows) == 2
        for index, row in zip(("J1", "J3"), rows, strict=True):
            ways = study.index(index), study.method(method)
            first = design_of(study, base, {}).vehicle
            for name, cell in zip(order, row, strict=True):
                car = design_of(study, name, {}).vehicle
                assert cell["value"] == it.evaluate(car, *ways).value
                if name != base:
                    two = it.compare(car, first, *ways)
                    assert all(word in cell["said"] for word in _said(two, method != "norm")), (name, cell)
            least = min(cell["value"] for cell in row)
            assert [cell["best"] for cell in row] == [cell["value"] == pytest.approx(least, rel=1e-9) for cell in row]
    choose(visitor, names[-1])
    _compared(visitor, ["S3", *(name for name in names[:-1] if name != "S3")])


def test_designs_that_are_taken_out_stay_out(visitor: Visitor) -> None:
    """The last one too: nothing that nobody chose comes in place of it."""
    page = visitor.page
    visitor.settled()
    page.click("#tab-compare")
    _compared(visitor, ["S1", "S3"])
    pressed = page.get_by_role("group", name="Designs to compare").locator("[aria-pressed=true]")
    for left in (["S1"], []):
        pressed.last.click()
        page.locator("#tab-panel", has_text="Choose two to four of them.").wait_for()
        assert pressed.all_inner_texts() == left
    _choose_by_mouse(visitor, "S2")
    _choose_by_mouse(visitor, "S3")
    _compared(visitor, ["S2", "S3"])


def test_kept_designs_of_other_studies_are_compared_with_what_tells_them_apart(
    visitor: Visitor, tmp_path: Path
) -> None:
    """By the road of the study that is open, and with the numbers in which they differ."""
    page = visitor.page
    (tmp_path / "study.toml").write_text(STUDY)
    visitor.open(tmp_path / "study.toml")
    page.wait_for_selector("text=study.toml is open")
    visitor.pick("S5")
    page.click("#tab-compare")
    for place, text in {"elements.b": "150 kg", "vehicle.unsprung_mass": "40 kg", "road.speed": "50 m/s"}.items():
        page.fill(f"[id='entry {place}']", text)
        page.keyboard.press("Enter")
    page.get_by_label("Keep this design as").fill("heavy")
    page.keyboard.press("Enter")
    for _ in range(4):
        page.keyboard.press("Control+z")
    page.keyboard.press("Control+Shift+z")
    page.wait_for_function("() => document.getElementById('entry elements.b').title === '150 kg'")
    for name in ("S1", "S1"):  # out of what stands there at first, and in again behind S5
        _choose_by_mouse(visitor, name)
    assert page.locator(".kept").count() == 0  # to keep it was undone too
    for _ in range(3):
        page.keyboard.press("Control+Shift+z")
    page.fill("[id='entry road.speed']", "25 m/s")
    page.keyboard.press("Enter")
    page.get_by_role("button", name="heavy kept").click()
    rows = _compared(visitor, ["S5", "S1", "heavy"])
    page.wait_for_function(  # it is kept a moment after the last change
        """() => {
          const { elements, road, vehicle } = JSON.parse(sessionStorage.getItem('inerter.document')).study;
          return elements.b === '150 kg' && vehicle.unsprung_mass === '40 kg' && road.speed === '25 m/s';
        }"""
    )
    study = study_from(page.evaluate("() => JSON.parse(sessionStorage.getItem('inerter.document'))")["study"])
    heavy = it.evaluate(design_of(study, "S5", {}).vehicle, study.index("J3"), it.Norm()).value
    assert rows[1][2]["value"] == heavy == rows[1][0]["value"]
    assert rows[1][2]["said"].split() == ["0", "%as", "good"]
    page.fill("[id='entry vehicle.unsprung_mass']", "25 kg")
    page.keyboard.press("Enter")
    row = page.locator(".compared tr", has_text="unsprung mass")
    wait_until(lambda: row.count() == 1 and row.locator("td").all_inner_texts() == ["25 kg", "25 kg", "40 kg"])
