"""A search for the best network in the browser: its ranking, and a network of it in the editor."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import pytest
from browser import HeldRequests, Served, Visitor, step_slider_and
from folders import EXAMPLES
from study_text import PAPER_CAR, study_text

ELEMENTS = (
    'k = "120 kN/m"\nc = { from = "100 N s/m", to = "100 kN s/m" }\n'
    'any = { network = 3, springs = { from = "1 kN/m", to = "10 MN/m" }, '
    'dampers = { from = "10 N s/m", to = "1 MN s/m" }, inerters = { from = "10 g", to = "100 t" } }'
)
LAYOUTS = 'S1 = "k | c"\nany = "k | any"'
ASK = """indices = ["J1", "J3", "J5"]
trade_off = ["J1", "J3"]
optimise = "norm"
baseline = "S1"
real_inerters = { friction = "10 N", best = 1 }"""


SHOWS = """values => Object.entries(values).every(([index, value]) =>
  Math.abs(document.querySelector(`td[data-index=${index}]`)?.dataset.value / value - 1) < 1e-6)"""

WHOLE = """label => [...document.querySelectorAll(`.job [aria-label^='${label}']`)].every(each =>
  each.clientWidth > 0 && each.scrollWidth <= each.clientWidth)"""

KEPT = """([place, entry]) => JSON.stringify(place.reduce((table, key) => table?.[key],
  JSON.parse(sessionStorage.getItem('inerter.document'))?.study)) === JSON.stringify(entry)"""


def searches(served: Served) -> list[dict[str, Any]]:
    """The searches that the server has done, does or will do."""
    return [job for job in json.loads(served.get("work"))["work"] if job["kind"] == "search"]


@pytest.fixture
def searchable(tmp_path: Path) -> Path:
    """A study that has a free network."""
    path = tmp_path / "searched.toml"
    path.write_text(study_text(ASK, vehicle=PAPER_CAR, elements=ELEMENTS, layouts=LAYOUTS), encoding="utf-8")
    return path


@pytest.fixture
def searching(visitor: Visitor, searchable: Path) -> Visitor:
    """A window with that study."""
    visitor.open(searchable)
    visitor.wait_for_text("k | any")
    visitor.settled()
    return visitor


def test_networks_of_a_search_are_taken_into_the_editor(served: Served, searching: Visitor) -> None:
    """Of the front over networks, of a ranking, of its frontier and with real inerters.

    The layout of each replaces the one that was searched, and the page then shows its indices.
    """
    page = searching.page
    page.wait_for_selector(".answers[data-being=current]")
    assert page.locator(".problems, .element.unknown").count() == 0
    for tab in ("history", "margins", "tolerance"):
        page.click(f"#tab-{tab}")
        page.locator("#tab-panel", has_text="The network of any is free: search for the best one first.").wait_for()
    page.click("#tab-work")
    page.locator("form.begin [name=layout]").wait_for()
    assert page.evaluate("() => document.documentElement.scrollHeight === innerHeight")  # long panels scroll, not it
    page.get_by_text("Export", exact=True).click()
    page.locator("#export-menu", has_text="The network of any is free: search for the best one first.").wait_for()
    page.keyboard.press("Escape")
    assert page.get_attribute("#verdict", "data-severity") == "open"  # nothing is wrong with S1
    assert "any" in page.inner_text("#verdict")
    page.get_by_role("button", name="Search for the best network").click()
    form = page.locator("form.begin", has_text="Search for the best network")
    assert form.locator("[name=layout]").evaluate("each => each === document.activeElement")
    form.get_by_label("inerters at most").fill("1")
    form.get_by_label("inerters at most").press("Tab")
    boxes = form.locator("[name=index]")
    assert [box.is_checked() for box in boxes.all()] == [True, True, False]  # those of the trade-off
    before = {job["id"] for job in searches(served)}  # the server has the jobs of other tests too
    form.get_by_role("button", name="Begin").click()
    deadline = time.monotonic() + 120.0
    while not (done := [job for job in searches(served) if job["id"] not in before and job["state"] == "done"]):
        assert time.monotonic() < deadline, searches(served)
        time.sleep(0.2)
    found = json.loads(served.get(f"work/{done[0]['id']}/result"))
    networks = [row for one in found["searches"] for row in one["ranking"]]
    assert max(sum(text.endswith("kg") for text in row["elements"].values()) for row in networks) == 1
    job_row = page.locator(".job[data-state=done]", has_text="Search").first
    job_row.locator("circle.point").first.wait_for(state="attached")
    assert any(
        "the smallest network within 1\xa0%" in sentence and "\xa0% worse" in sentence
        for sentence in found["sentences"]
    )
    for sentence in found["sentences"]:
        job_row.locator("p", has_text=sentence).wait_for()
    front = max(found["front"]["fronts"], key=lambda one: one["elements"])["points"]

    def shows(row: Any, values: dict[str, float]) -> None:
        searching.wait_for_text(row["entry"])
        page.wait_for_function(SHOWS, arg=values)

    assert job_row.locator("circle.point").count() == len(front)
    for number in (0, len(front) // 2):
        job_row.locator("circle.point").nth(number).press("Enter")
        shows(front[number], front[number]["indices"])

    job_row.get_by_role("button", name="J3", exact=True).click()
    searched = found["searches"][1]
    rows = job_row.get_by_label("Ranking").locator("[data-network]")
    assert [row.get_attribute("data-network") for row in rows.all()] == [one["network"] for one in searched["ranking"]]
    for number in (3, 0):  # another network of the ranking comes in place of the first
        chosen = searched["ranking"][number]
        rows.nth(number).get_by_role("button", name="Take", exact=True).click()
        shows(chosen, {"J3": chosen["value"]})
    simplest = searched["frontier"][0]
    job_row.locator("circle.point").first.press("Enter")
    shows(simplest, {"J3": simplest["value"]})
    real = searched["real_inerters"][0]
    assert page.viewport_size is not None
    wide = page.viewport_size
    page.set_viewport_size({"width": 420, "height": 800})
    for label in ("Ranking", "Real inerters"):  # rows are whole on a narrow screen
        page.wait_for_function(WHOLE, arg=label)
    page.set_viewport_size(wide)
    page.select_option(".answers select >> nth=0", "statistical-linearisation")
    job_row.get_by_label("Real inerters").get_by_role("button", name="Take", exact=True).first.click()
    shows(real, {"J3": real["value"]})


def test_how_many_elements_and_whether_bridges_stay_while_the_page_is_drawn_anew(searching: Visitor) -> None:
    page = searching.page
    page.get_by_role("button", name="Search for the best network").click()
    form = page.locator("form.begin")
    most, bridges = form.get_by_label("elements at most"), form.get_by_label("bridges")
    assert (most.input_value(), bridges.is_checked()) == ("3", False)
    most.focus()
    page.keyboard.press("Control+A")
    page.keyboard.type("2")
    step_slider_and(searching)
    page.wait_for_function("() => document.getElementById('entry elements.k').title !== '120 kN/m'")
    assert most.input_value() == "2"
    page.keyboard.press("Enter")
    step_slider_and(searching, "document.querySelector('form.begin input[type=checkbox]:not([name])').click();")
    searching.settled()
    assert (most.input_value(), bridges.is_checked()) == ("2", True)


def test_a_study_without_a_free_network_gets_one(visitor: Visitor) -> None:
    """From the layouts to the form of a search: in parallel with the spring that carries the vehicle, in one step."""
    page = visitor.page
    visitor.settled()
    page.get_by_role("button", name="More networks").click()
    page.get_by_role("button", name="Add a layout with a free network").click()
    visitor.wait_for_text("k | any")
    form = page.locator("form.begin", has_text="Search for the best network")
    form.locator("select[name=layout]").wait_for()
    assert form.locator("select[name=layout]").input_value() == "any"
    assert form.get_by_role("button", name="Begin").is_enabled()
    visitor.settled()
    assert page.locator(".problems, .element.unknown").count() == 0
    page.get_by_role("button", name="Undo").click()
    assert page.locator(".answers .pick", has_text="any").count() == 0


def test_a_car_of_two_struts_says_at_which_the_network_is_free_and_has_limits_in_the_form(visitor: Visitor) -> None:
    """Each choice is one step; a limit of the form is one of the study, on each tyre."""
    page = visitor.page
    visitor.open(EXAMPLES / "half-car.toml")
    page.wait_for_selector("text=half-car.toml is open")
    visitor.pick("S3")
    page.get_by_role("button", name="More networks").click()
    form = page.locator("form.begin", has_text="Search for the best network")
    for name, front, rear, told in (
        ("at rear", "k_f | c_f - b_f", "k_r | any", "Free at rear. At front: k_f | c_f - b_f."),
        ("the same at front and rear", "k_f | any", "k_r | any", "Free at front and rear, the same network"),
    ):
        form.get_by_role("button", name=name, exact=True).click()
        form.locator("p.quiet", has_text=told).wait_for()
        page.wait_for_function(KEPT, arg=[["layouts", "any"], {"front": front, "rear": rear}])
        if name == "at rear":
            page.get_by_role("button", name="Undo").click()
    form.get_by_label("Add one on").select_option("J3")
    assert form.get_by_label("How much, with its unit").get_attribute("placeholder") == "in N"
    form.get_by_label("How much, with its unit").fill("850 N")
    form.get_by_label("How much, with its unit").press("Enter")
    form.get_by_text("each tyre, at most").wait_for()
    page.wait_for_function(KEPT, arg=[["study", "subject_to"], {"J3": {"at_most": "850 N"}}])


def test_a_button_that_is_pressed_while_a_study_is_being_opened_does_what_it_says(
    visitor: Visitor, searchable: Path
) -> None:
    """The message that the study is open comes while it is pressed, and would move it away from the pointer."""
    page = visitor.page
    held = HeldRequests(visitor, "**/api/panel/optimise")
    visitor.open(searchable)
    button = page.get_by_role("button", name="Search for the best network")
    place = button.bounding_box()
    page.mouse.move(place["x"] + 9, place["y"] + 3)
    page.mouse.down()
    held.end()
    with page.expect_response("**/api/panel/optimise"):
        for route in held.routes:
            route.continue_()
    page.wait_for_timeout(1000)  # in which the message comes
    page.mouse.up()
    page.locator("form.begin [name=layout]").wait_for()
    page.wait_for_selector(f"text={searchable.name} is open")


def test_another_button_of_the_mouse_holds_nothing_back(visitor: Visitor, searchable: Path) -> None:
    """Its release may go to a menu of the browser, and never come."""
    page = visitor.page
    held = HeldRequests(visitor, "**/api/panel/optimise")
    visitor.open(searchable)
    page.get_by_role("button", name="Search for the best network").hover()
    page.mouse.down(button="right")
    held.end()
    for route in held.routes:
        route.continue_()
    page.wait_for_selector(f"text={searchable.name} is open")
    page.mouse.up(button="right")


def test_the_form_of_a_search_goes_with_its_study(visitor: Visitor) -> None:
    """What the library has said of the study before is not drawn of one that has no such layout."""
    page = visitor.page
    visitor.open(EXAMPLES / "half-car.toml")
    page.wait_for_selector("text=half-car.toml is open")
    page.get_by_role("button", name="More networks").click()
    form = page.locator("form.begin", has_text="Search for the best network")
    form.get_by_role("button", name="at rear", exact=True).click()
    form.locator("p.quiet", has_text="Free at rear.").wait_for()
    held = HeldRequests(visitor, "**/api/study/parts")
    visitor.open(EXAMPLES / "absorber.toml")
    form.get_by_text("No layout has a free network.").wait_for()
    held.end()
    for route in held.routes:
        route.continue_()
    page.wait_for_selector("text=absorber.toml is open")


def test_a_value_in_the_si_unit_is_shown_in_one_that_suits_it(visitor: Visitor) -> None:
    """As a search gives them: no zeros that are cut off in the field."""
    page = visitor.page
    entry = page.locator("[id='entry elements.k']")
    entry.fill("10000000.0 N/m")
    page.keyboard.press("Enter")
    page.get_by_label("Title of the study").focus()
    page.wait_for_function("() => document.getElementById('entry elements.k').value === '10 MN/m'")
    assert entry.get_attribute("title") == "10000000.0 N/m"


def test_enter_in_a_field_begins_no_long_work(served: Served, searching: Visitor) -> None:
    """It takes over the number, as in every other field of the page."""
    page = searching.page
    page.get_by_role("button", name="Search for the best network").click()
    form = page.locator("form.begin", has_text="Search for the best network")
    inerters = form.get_by_label("inerters at most")
    before = json.loads(served.get("work"))["work"]
    inerters.fill("1")
    inerters.press("Enter")
    page.wait_for_function(
        "() => JSON.parse(sessionStorage.getItem('inerter.document'))?.study.elements.any?.inerters_at_most === 1"
    )
    sweep = page.locator("form.begin", has_text="Sweep")
    sweep.locator("[name=from]").press("Enter")
    searching.settled()
    assert json.loads(served.get("work"))["work"] == before
