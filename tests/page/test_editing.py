"""Drawing, typing and sliding: what the page shows is what the library computes of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from browser import Visitor, step_slider_and

import inerter as it


def _value(study: Path | str, layout: str, index: str) -> float:
    """What the library says of a study without free values."""
    loaded = it.load_study(study)
    return float(it.evaluate(loaded.design(layout), loaded.index(index), it.Norm()).value)


def test_sixty_steps_in_a_second_end_with_the_numbers_of_the_last(visitor: Any, tmp_path: Path) -> None:
    page = visitor.page
    page.get_by_role("group", name="Layouts").get_by_role("button", name="S3", exact=True).click()
    visitor.settled()
    before = page.get_attribute("[id='entry elements.c']", "title")
    text = page.evaluate(
        """async () => {
          const slider = document.getElementById("slider elements.c");
          for (let step = 1; step <= 60; step += 1) {
            slider.value = String(40 + 5 * step);
            slider.dispatchEvent(new Event("input", { bubbles: true }));
            await new Promise((resolve) => setTimeout(resolve, 1000 / 60));
          }
          slider.dispatchEvent(new Event("change", { bubbles: true }));
          await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
          return document.getElementById("entry elements.c").title;
        }"""
    )
    found = visitor.values()
    path = visitor.download("This design, values fixed", tmp_path)
    assert it.load_study(path).elements["c"].value == float(text.removesuffix(" N s/m"))
    assert found["J1"] == _value(path, "S3", "J1")
    page.get_by_role("button", name="Undo").click()
    # sixty steps are one
    page.wait_for_function("text => document.getElementById('entry elements.c').title === text", arg=before)


def test_a_number_of_the_vehicle_is_freed_searched_and_saved(visitor: Any, tmp_path: Path) -> None:
    page = visitor.page
    visitor.pick("S3e")
    before = visitor.values()["J3"]
    page.locator("[data-place='vehicle.tyre_stiffness'] input[type=checkbox]").check()
    assert page.locator("[data-place='road.speed'] input[type=checkbox]").count() == 0  # which no optimiser chooses
    page.get_by_role("button", name="Find best").click()
    page.wait_for_function(
        "() => document.querySelector(\"[id='entry vehicle.tyre_stiffness']\").title.startsWith('12000.0 ')"
    )
    found = visitor.values()
    assert found["J3"] < before
    with page.expect_download() as download:
        page.get_by_text("Save", exact=True).click()
        page.get_by_role("button", name="This design, values fixed").click()
    path = tmp_path / "design.toml"
    download.value.save_as(path)
    saved = it.load_study(path)
    assert (
        saved.vehicle["tyre_stiffness"] == 12000.0
    )  # the lower of the bounds that a slider begins with, a decade below
    layout = next(iter(saved.layouts))
    assert found["J3"] == _value(path, layout, "J3")


def test_what_is_pressed_is_about_the_newest_however_late_the_screen_is(visitor: Any) -> None:
    page = visitor.page
    visitor.settled()
    page.evaluate("() => { window.requestAnimationFrame = () => 0; }")  # a frame that does not come
    page.locator("[data-place='elements.k'] input[type=checkbox]").click()
    with page.expect_request("**/api/panel/optimise") as asked:
        page.get_by_role("button", name="Find best").click()
    assert set(asked.value.post_data_json["study"]["elements"]["k"]) == {"from", "to"}


def test_what_is_wrong_is_told_at_its_place_and_nothing_is_lost(visitor: Any, tmp_path: Path) -> None:
    page = visitor.page
    visitor.pick("S3e")
    before = visitor.text
    page.fill("#network-text", "k | c - (ks |")
    page.wait_for_selector("#network-problem")
    assert "element name or '(' expected here" in page.inner_text("#network-problem")
    assert page.get_attribute("#network-text", "aria-invalid") == "true"
    assert page.locator("[data-path]").count() == 5  # the drawing of before
    page.fill("#network-text", before)
    page.wait_for_selector("#network-problem", state="detached")

    page.fill("[id='entry elements.k']", "120 parrots")
    page.keyboard.press("Enter")
    problem = page.wait_for_selector("[data-place='elements.k'] .problem")
    assert "parrots" in problem.inner_text()
    page.fill("[id='entry elements.k']", "120 N/mm")
    page.keyboard.press("Enter")
    page.wait_for_selector("[data-place='elements.k'] .problem", state="detached")

    other = tmp_path / "settings.toml"
    other.write_text('[tool.other]\nname = "no study"\n')
    visitor.open(other)
    page.wait_for_selector(".notice")
    assert "not a study file; nothing was changed" in page.inner_text(".notice")
    assert visitor.text == before


def test_names_with_markup_are_text(visitor: Any) -> None:
    page = visitor.page
    name = "<img src=x onerror=alert(1)>"
    page.fill("input.title", name)
    page.keyboard.press("Tab")
    page.get_by_text("This layout").click()
    page.get_by_role("button", name="Rename…").click()
    page.fill(".layouts input[name=name]", name)
    page.keyboard.press("Enter")
    visitor.settled()
    page.click("#tab-compare")
    page.get_by_label("Keep this design as").fill(f"{name}<script>alert(2)</script>")
    page.keyboard.press("Enter")
    page.wait_for_selector(".kept")
    assert page.locator("img").count() == 0
    assert page.locator("#page script").count() == 0


def test_a_number_is_dragged_and_home_is_its_best_value(visitor: Any) -> None:
    page = visitor.page
    page.get_by_role("group", name="Layouts").get_by_role("button", name="S3", exact=True).click()
    page.wait_for_selector("[id='slider elements.b'].marked")
    optimum = visitor.values()
    entry, slider = page.locator("[id='entry elements.b']"), page.locator("[id='slider elements.b']")
    best = entry.get_attribute("title")
    box = entry.bounding_box()
    x, y = box["x"] + 0.8 * box["width"], box["y"] + 0.5 * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    for far in (2, 10, 60):
        page.mouse.move(x + far, y)
    page.mouse.up()
    assert page.evaluate("() => document.activeElement.id") != "entry elements.b"
    page.wait_for_function(
        "best => parseFloat(document.getElementById('entry elements.b').title) > 1.2 * best", arg=float(best.split()[0])
    )
    assert visitor.values()["J1"] > optimum["J1"]
    dragged = entry.get_attribute("title")
    slider.press("Home")
    page.wait_for_function("best => document.getElementById('entry elements.b').title === best", arg=best)
    assert visitor.values() == optimum
    page.keyboard.press("Control+Z")
    page.wait_for_function("before => document.getElementById('entry elements.b').title === before", arg=dragged)
    page.keyboard.press("Control+Z")  # a drag is one step
    page.wait_for_function("best => document.getElementById('entry elements.b').title === best", arg=best)
    entry.click()  # a press without a drag
    page.keyboard.type("400 kg")
    page.keyboard.press("Enter")
    page.wait_for_function("() => document.getElementById('entry elements.b').title === '400 kg'")
    page.fill("[id='entry elements.k']", "100 kN/m")
    page.keyboard.press("Enter")
    page.wait_for_selector("[id='slider elements.b'].marked", state="detached")  # it was the best of another study


def test_an_element_is_marked_wherever_it_is(visitor: Any) -> None:
    page = visitor.page
    page.get_by_role("group", name="Layouts").get_by_role("button", name="S3", exact=True).click()
    visitor.settled()
    visitor.drawn()
    picture = "() => document.querySelector('.vehicle canvas').toDataURL()"
    page.mouse.move(2, 400)
    before = page.evaluate(picture)
    for place in (".element[data-name=b]", "[data-place='elements.b'] .bounds"):
        page.locator(place).hover()
        page.wait_for_selector("[data-place='elements.b'].chosen")
        page.wait_for_selector(".element.lit[data-name=b]")
        assert page.locator(".amount.chosen, .element.lit").count() == 2
        page.wait_for_function(f"before => ({picture})() !== before", arg=before)
        page.mouse.move(2, 400)
        page.wait_for_function(f"before => ({picture})() === before", arg=before)
        assert page.locator(".amount.chosen, .element.lit").count() == 0


AT_ONCE = """([layout, text]) => {
  document.querySelector(`.answers .pick[title=${layout}]`).click();
  const field = document.getElementById("entry elements.c");
  field.focus();
  document.execCommand("insertText", false, text);
  return new Promise((done) => setTimeout(() => {
    field.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
    done();
  }));
}"""


def test_what_is_typed_right_after_a_click_belongs_to_the_layout_that_was_clicked(visitor: Any) -> None:
    page = visitor.page
    visitor.settled()

    def shown(layout: str) -> str:
        page.locator(f".answers .pick[title={layout}]").click()
        page.wait_for_selector(f".values h3:text-is('Strut {layout}')")  # not of `S3e` for `S3`
        return str(page.get_attribute("[id='entry elements.c']", "title"))

    layouts = page.locator(".answers .pick").evaluate_all("all => all.map(each => each.title)")
    values = {layout: shown(layout) for layout in layouts}
    for number, layout in enumerate(layouts):
        values[layout] = f"{1000 + number} N s/m"
        page.evaluate(AT_ONCE, [layout, values[layout]])
        page.wait_for_function("text => document.getElementById('entry elements.c').title === text", arg=values[layout])
        assert {each: shown(each) for each in layouts} == values


CHOOSE = """const select = document.querySelector(".answers select[aria-label=Method]");
  select.value = "statistical-linearisation";
  select.dispatchEvent(new Event("change", { bubbles: true }));"""


def test_a_method_that_is_chosen_just_before_the_page_is_drawn_anew_counts(visitor: Visitor) -> None:
    visitor.settled()
    step_slider_and(visitor, CHOOSE)
    visitor.settled()
    assert visitor.page.input_value(".answers select[aria-label=Method]") == "statistical-linearisation"


def test_friction_at_an_inerter_is_offered_to_all_layouts_that_have_it(visitor: Visitor) -> None:
    """Else a strut with friction is ranked among others without it. All of them are one step."""
    page = visitor.page
    page.wait_for_function("() => sessionStorage.getItem('inerter.document') !== null")  # it is kept a little later
    before = json.loads(page.evaluate("() => sessionStorage.getItem('inerter.document')"))["study"]["layouts"]
    visitor.pick("S3")
    page.locator(".drawing [data-name=b]").click()
    page.get_by_role("button", name="in parallel", exact=True).click()
    page.get_by_role("button", name="Add a friction").click()
    visitor.wait_for_text("k | c - (b | f)")
    page.get_by_role("button", name="Join it in all layouts with b").click()
    kept = "() => JSON.parse(sessionStorage.getItem('inerter.document')).study.layouts"
    joined = {"S2": "k | c | b | f", "S3": "k | c - (b | f)"}
    page.wait_for_function(f"s2 => ({kept})().S2 === s2", arg=joined["S2"])
    layouts = page.evaluate(kept)
    assert {name: layouts[name] for name in joined} == joined
    assert {name for name, text in layouts.items() if "f" not in text} == {"S1"}
    assert all(text.count("f") == 1 for name, text in layouts.items() if name != "S1")
    page.get_by_role("button", name="Undo").click()
    page.wait_for_function(f"s2 => ({kept})().S2 === s2", arg=before["S2"])
    assert page.evaluate(kept) == {**before, "S3": joined["S3"]}


def test_a_gap_says_that_its_value_is_half_of_the_backlash(visitor: Visitor) -> None:
    page = visitor.page
    page.get_by_role("button", name="Add a gap").click()
    assert page.locator("[data-place='elements.gap'] > p").inner_text() == it.Gap.unit_note


def test_a_new_part_may_vary_where_another_of_its_kind_may(visitor: Visitor) -> None:
    """Else a layout with it is compared at its first value with layouts at their best. It is one step to undo."""
    page = visitor.page
    visitor.pick("S1")
    page.get_by_role("button", name="in parallel", exact=True).click()
    page.get_by_role("button", name="Add a inerter").click()
    visitor.wait_for_text("k | c | b2")
    new = page.locator("[data-place='elements.b2']")
    assert new.locator("input[type=checkbox]").is_checked()
    assert new.locator("[id='entry elements.b2']").input_value() == "300 kg"
    page.get_by_role("button", name="Add a spring").click()  # k may not vary
    assert not page.locator("[data-place='elements.k2'] input[type=checkbox]").is_checked()
    for text in ("k | c | b2", "k | c"):
        page.get_by_role("button", name="Undo").click()
        visitor.wait_for_text(text)
