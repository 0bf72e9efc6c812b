"""Journeys from the first screen to the end, by mouse and by keyboard alone."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from browser import Served, Visitor, wait_until
from campaigns import sampled
from folders import EXAMPLES
from wang_su import J1

import inerter as it
from inerter.files.rig.loading import load_rig
from inerter.identification.models import model_words

IN_SIGHT = """() => {
  const [fit, panel] = [".fit", "#tab-panel"].map((each) => document.querySelector(each).getBoundingClientRect());
  return document.querySelectorAll(".fit").length === 2 && fit.top >= panel.top - 1 && fit.top < panel.bottom;
}"""


@dataclass
class Mouse:
    """A person with a mouse, who types text only."""

    page: Any

    def press(self, place: Any) -> None:
        """Press what can be pressed."""
        place.click()

    def write(self, place: Any, text: str) -> None:
        """Replace the text of a field."""
        place.click()
        place.press("Control+A")
        self.page.keyboard.type(text)
        self.page.keyboard.press("Enter")

    def choose(self, place: Any, value: str) -> None:
        """Choose from a list."""
        place.select_option(value)


@dataclass
class Keyboard(Mouse):
    """A person without a mouse; that Tab reaches every place is tested elsewhere."""

    def press(self, place: Any) -> None:
        wait_until(place.is_enabled)
        place.focus()
        is_box = place.evaluate("each => each.matches('input[type=checkbox], input[type=radio]')")
        self.page.keyboard.press("Space" if is_box else "Enter")

    def write(self, place: Any, text: str) -> None:
        place.focus()
        self.page.keyboard.press("Control+A")
        self.page.keyboard.type(text)
        self.page.keyboard.press("Enter")

    def choose(self, place: Any, value: str) -> None:
        place.focus()
        for _ in range(place.locator("option").count()):
            if place.input_value() == value:
                return
            self.page.keyboard.press("ArrowDown")
        assert place.input_value() == value


PEOPLE = [Mouse, Keyboard]
BY_KEYBOARD = sampled(PEOPLE, seldom=[Mouse])  # of what is tested by mouse elsewhere, or as much by one as by the other
BY_MOUSE = sampled(PEOPLE, seldom=[Keyboard])


def _entry(visitor: Visitor, place: str) -> Any:
    return visitor.page.locator(f"[id='entry {place}']")


def _began(visitor: Visitor, person: Mouse) -> None:
    """Begin with the quarter car on the first screen."""
    person.press(visitor.page.get_by_role("button", name="Quarter car", exact=True))
    visitor.wait_for_text("k | c - b")
    visitor.settled()


@pytest.mark.parametrize("kind", BY_KEYBOARD)
def test_an_own_car_from_the_first_screen_to_the_report(
    kind: type[Mouse], nothing: Served, visitors: Callable[..., Visitor], tmp_path: Path
) -> None:
    """Own masses, two struts compared, a limit, the optimum, a tolerance, the report: numbers are the library's."""
    visitor = visitors(nothing).visit()
    page = visitor.page
    person = kind(page)
    _began(visitor, person)
    for place, text in {"vehicle.sprung_mass": "300 kg", "road.speed": "80 km/h"}.items():
        person.write(_entry(visitor, place), text)
    person.press(page.locator("[aria-label=Layouts] .pick[title=S3]"))
    visitor.wait_for_text("k | c - b")

    person.press(page.locator("#step-2"))
    limits = page.locator(".asked")
    person.choose(limits.locator("[name=of]"), "suspension-travel")
    person.choose(limits.locator("[name=sense]"), "at_most")
    person.write(limits.locator("[name=value]"), "9 mm")  # Enter adds it
    page.wait_for_selector(".limits li", state="attached")
    page.keyboard.press("Escape")

    person.press(page.get_by_role("button", name="Find best"))
    page.wait_for_function(
        "() => document.querySelector('.optimise [role=status]').textContent.startsWith('The values of')"
    )
    page.wait_for_function("() => document.querySelectorAll('.limits .good').length === 1")
    best = visitor.values()

    person.press(page.locator("#tab-compare"))
    for layout in ("S3", "S3"):  # which stands there at first, beside the baseline
        designs = page.get_by_role("group", name="Designs to compare")
        person.press(designs.get_by_role("button", name=layout, exact=True))
    page.wait_for_selector("td.best")
    assert page.locator("[aria-label=Comparison] thead th").all_inner_texts() == ["S1", "S3"]

    person.press(page.locator("#tab-tolerance"))
    with page.expect_request("**/api/panel/tolerance") as request:
        person.press(page.locator("#tab-panel").get_by_role("button", name="Compute"))
    page.wait_for_selector("[data-scatter=J1] td[data-value]")
    shown = page.locator("[data-scatter=J1] td[data-value]").evaluate_all("all => all.map(td => +td.dataset.value)")

    folder = tmp_path / kind.__name__
    folder.mkdir()
    saved = {}
    for name, ending in (("This design, values fixed", "toml"), ("Report of these designs", "html")):
        person.press(page.get_by_text("Save", exact=True))
        with page.expect_download(timeout=120_000) as found:
            person.press(page.get_by_role("button", name=name))
        page.keyboard.press("Escape")
        saved[ending] = folder / f"saved.{ending}"
        found.value.save_as(saved[ending])
    report = saved["html"].read_text()
    assert "300 kg" in report
    assert f"{best['J1']:.3f}" in report

    study = it.load_study(saved["toml"])
    (layout,) = study.layouts
    car = study.design(layout)
    assert {index: it.evaluate(car, study.index(index), it.Norm()).value for index in best} == best
    asked = request.value.post_data_json["spread"]
    spread = it.tolerance_analysis(car, study.index("J1"), it.Norm(), spread=asked, samples=1024)
    assert shown == [best["J1"], spread.mean, spread.standard_deviation, spread.quantile(0.95), spread.worst]


@pytest.mark.parametrize("kind", BY_KEYBOARD)
def test_a_record_is_withheld_then_fitted_right_and_its_device_is_in_a_study(
    kind: type[Mouse], nothing: Served, visitors: Callable[..., Visitor], tmp_path: Path
) -> None:
    visitor = visitors(nothing).visit()
    page = visitor.page
    person = kind(page)
    _began(visitor, person)
    record = tmp_path / "screw.csv"
    it.write_record(replace(load_rig(EXAMPLES / "rig_fit.toml"), duration=1.0).run(), record)
    page.set_input_files(".menu input[type=file]", str(record))
    page.wait_for_selector(".records li")
    models = page.locator("select[name=model]")
    assert models.input_value() == "choose"  # what the library advises
    person.choose(models, "friction")
    page.get_by_text(model_words("friction"), exact=True).wait_for()
    person.press(page.get_by_role("button", name="Identify"))
    page.wait_for_selector(".fit td:text-is('withheld')", timeout=120_000)
    assert page.get_by_role("button", name="Take the device").count() == 0
    person.press(page.get_by_role("button", name="Fit the model elastic-friction"))
    page.wait_for_function(IN_SIGHT)
    take = page.get_by_role("button", name="Take the device")
    take.wait_for(timeout=120_000)
    fit = page.locator(".fit").first
    fit.get_by_text(model_words("elastic-friction")).wait_for()
    fit.get_by_text("Reliable estimates.").wait_for()
    shown = {
        row.locator("th").inner_text(): row.locator("td").first.inner_text()
        for row in fit.locator("[aria-label='Identified values'] tbody tr").all()
    }
    visitor.open(EXAMPLES / "seat.toml")
    page.wait_for_selector("text=seat.toml is open")
    visitor.pick("S1")
    person.press(fit.get_by_role("button", name="seat", exact=True))
    page.wait_for_selector(".notice:has-text('in parallel'):has-text('It joins the seat of S1')")
    visitor.settled()
    assert page.locator("#network-problem").count() == 0
    assert visitor.values()["J1"] > 0.0
    assert visitor.text == "ks | cs | (ks2 | cs2) - (b2 | f)"
    person.press(page.get_by_role("group", name="Struts").get_by_role("button", name="strut", exact=True))
    visitor.wait_for_text("k | c")
    study = it.load_study(visitor.download("Study file", tmp_path))
    inertance = study.elements["b2"].value
    assert inertance == pytest.approx(float(shown["b"].split()[0]), rel=0.01)
    for left in (1, 0):
        person.press(page.locator(".fit").first.get_by_role("button", name="Forget"))
        page.wait_for_function("left => document.querySelectorAll('.fit').length === left", arg=left)


def _layout(visitor: Visitor) -> str:
    """The layout that is edited."""
    return str(visitor.page.locator("[aria-label=Layouts] tr.on .pick").get_attribute("title"))


@pytest.mark.parametrize("kind", BY_MOUSE)
def test_a_search_is_stopped_and_resumed(
    kind: type[Mouse], nothing: Served, visitors: Callable[..., Visitor], tmp_path: Path
) -> None:
    """What was found before is kept, and the end is that of a search without a stop."""
    path = tmp_path / "searched.toml"
    path.write_text((EXAMPLES / "search_quarter_car.toml").read_text())  # long enough to be stopped half way
    visitor = visitors(nothing).visit()
    page = visitor.page
    person = kind(page)
    visitor.open(path)
    visitor.wait_for_text("k | any")
    person.press(page.locator("#tab-work"))
    form = page.locator("form.begin", has_text="Search for the best network")
    person.press(form.locator("[name=index][value=J3]"))  # which leaves J1
    person.press(form.get_by_role("button", name="Begin"))
    job = page.locator(".job").first
    page.wait_for_selector(".job[data-state=running] [data-network]", timeout=120_000)
    person.press(job.get_by_role("button", name="Stop"))
    page.wait_for_selector(".job[data-state=stopped] [data-network]")
    assert re.fullmatch(r"stopped at \d+ %", page.inner_text(".job .state"))
    assert "so far" in job.inner_text()
    person.press(job.get_by_role("button", name="Resume"))
    page.wait_for_selector(".job[data-state=done] [data-network]", timeout=240_000)
    library = it.search(it.load_study(path).design("any"), J1, it.Norm())
    assert f"of {library.n_networks} networks" in job.inner_text()
    (first,) = [one for one in json.loads(nothing.get("work"))["work"] if one["kind"] == "search"]
    (searched,) = json.loads(nothing.get(f"work/{first['id']}/result"))["searches"]
    assert [row["value"] for row in searched["ranking"]] == [one.value for one in library.ranking[:10]]
    assert job.get_by_label("Ranking").locator("[data-network]").count() == 10
    person.press(job.get_by_role("button", name="Forget"))
    page.wait_for_selector(".job:has-text('Search for the best network')", state="detached")


DOCUMENT = "() => sessionStorage.getItem('inerter.document')"


@pytest.mark.parametrize("kind", sampled(PEOPLE, seldom=PEOPLE))
def test_thirty_steps_are_undone_and_done_again(
    kind: type[Mouse], nothing: Served, visitors: Callable[..., Visitor]
) -> None:
    """Each state comes back in order, on both ways, and the numbers with it."""
    visitor = visitors(nothing).visit()
    page = visitor.page
    person = kind(page)
    _began(visitor, person)
    page.wait_for_function(f"() => ({DOCUMENT})() !== null")
    states = [json.loads(page.evaluate(DOCUMENT))]
    numbers = [visitor.values()]

    def step(act: Callable[[], None]) -> None:
        act()
        wait_until(lambda: json.loads(page.evaluate(DOCUMENT)) != states[-1])
        states.append(json.loads(page.evaluate(DOCUMENT)))

    def write(place: str, text: str) -> None:
        step(lambda: person.write(_entry(visitor, place), text))

    for number in range(1, 6):
        write("elements.k", f"{100 + number} kN/m")
        write("elements.c", f"{4000 + 100 * number} N s/m")
        write("vehicle.unsprung_mass", f"{25 + number} kg")
        step(lambda: person.press(page.locator("[data-place='elements.k'] input[type=checkbox]")))
        step(lambda: person.press(page.get_by_role("button", name="Add a layout")))
        step(lambda: person.press(page.locator("[data-place='elements.k'] input[type=checkbox]")))
    assert len(states) == 31
    numbers.append(visitor.values())
    turns = [("Undo", "Control+Z", states[-2::-1]), ("Redo", "Control+Shift+Z", states[1:])]
    for (name, keys, expected), values in zip(turns, numbers, strict=True):
        for state in expected:
            if kind is Mouse:
                page.get_by_role("button", name=name).click()
            else:
                page.keyboard.press(keys)
            wait_until(lambda state=state: json.loads(page.evaluate(DOCUMENT)) == state)
        assert visitor.values() == values
