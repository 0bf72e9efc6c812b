"""No answer, curve or message of one study stands under the name of another, and each says whether it is current."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from browser import HeldRequests, Served, Visitor, drop, wait_until
from campaigns import sampled
from folders import EXAMPLES
from study_text import PAPER_CAR, study_text

import inerter as it
from inerter.app.about import examples
from inerter.files.rig.loading import load_rig
from inerter.files.study.loading import load_study

SIMULATED = "half_car_friction"  # of a simulation file its vehicle is opened
DESIGNS = [name for name, path in examples().items() if not load_study(path).free_networks]  # others have no answers
STUDIES = [*DESIGNS, SIMULATED]
TABS = ("history", "response")  # whose answers come by themselves
SHOWN = """() => {
  const texts = (selector) => [...document.querySelectorAll(selector)].map(each => each.textContent.trim());
  return {
    numbers: [...document.querySelectorAll("[data-value], [data-better]")]
      .flatMap(each => [each.dataset.value, each.dataset.better]).filter(each => each && !isNaN(each)),
    curves: document.querySelectorAll(".plot .drawn, .vehicle canvas").length,
    texts: [...texts(".limits li"), ...texts(".budget [role=status]"), ...texts(".optimise [role=status]"),
      ...texts(".notice"), ...texts(".problem"), ...texts(".doubts"),
      ...texts(".verdict:not(.wait) > b"), ...texts(".verdict:not(.wait) .caveat")].filter(each => each),
  };
}"""
LOOKS = """() => [...document.querySelectorAll(".vehicle canvas, .answers tbody tr, .answers td")].map(each => {
  const { x, y, width, height } = each.getBoundingClientRect();
  const { fontSize, backgroundColor } = getComputedStyle(each);
  return [x, y, width, height, fontSize, backgroundColor];
})"""
FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
NOTHING = {"numbers": [], "curves": 0, "texts": []}


@contextmanager
def held(visitor: Visitor, paths: str = "panel/") -> Iterator[list[Any]]:
    """Requests of these paths get no answer; in the end they are told that newer ones have come."""
    requests = HeldRequests(visitor, re.compile(f".*/api/{paths}.*"))
    yield requests.routes
    requests.end()
    for route in requests.routes:
        route.fulfill(status=409, body=json.dumps({"sentence": "Out of date.", "outdated": True}))


def _opened(visitor: Visitor, name: str) -> None:
    visitor.open(EXAMPLES / f"{name}.toml")
    visitor.page.wait_for_selector(f"text={name}.toml is open")
    visitor.settled()
    visitor.drawn()


def _follows(visitor: Visitor, first: str, other: str) -> list[Any]:
    """What of the first study is to be seen when another one is opened whose answers do not come."""
    page = visitor.page
    before, title = page.evaluate(SHOWN), page.input_value("input.title")
    assert before["numbers"] or before["texts"], first  # what a method cannot answer has a sentence
    with held(visitor):
        visitor.open(EXAMPLES / f"{other}.toml")
        page.wait_for_function("title => document.querySelector('.title').value !== title", arg=title)
        found = []
        for tab in TABS:
            page.click(f"#tab-{tab}")
            page.evaluate(FRAMES)
            shown = page.evaluate(SHOWN)
            shown["texts"] = [text for text in shown["texts"] if not text.startswith(f"{other}.toml is open")]
            if shown != NOTHING:
                found.append((first, other, tab, shown))
        assert page.locator(".answers[data-being=coming]").count() == 1, (first, other)
        for _ in range(3 if other == SIMULATED else 1):  # which chooses a layout besides
            if page.input_value("input.title") != title:
                page.get_by_role("button", name="Undo").click()
                page.evaluate(FRAMES)
        page.wait_for_function("() => document.querySelector('.answers[data-being=current]')")
        assert page.evaluate(SHOWN)["numbers"] == before["numbers"]  # at once: they are those of this very question
    return found


@pytest.mark.parametrize("first", sampled(STUDIES, often=["full-car"], kept=0))
def test_nothing_of_one_study_stands_under_another(first: str, visitor: Visitor) -> None:
    """Of all pairs of examples, opened one after the other: no number, curve or message of the first."""
    page = visitor.page
    page.click("#tab-history")
    page.get_by_label("for [s]").fill("1")
    page.keyboard.press("Enter")
    _opened(visitor, first)
    page.click("#tab-response")
    visitor.drawn()
    found = [_follows(visitor, first, other) for other in STUDIES if other != first]
    assert [each for each in found if each] == []


def test_what_buttons_asked_goes_with_its_study(visitor: Visitor) -> None:
    """The optimum, a budget and a tolerance that were told of the seat: nothing of them under the train."""
    page = visitor.page
    _opened(visitor, "seat")
    page.get_by_role("group", name="Layouts").get_by_role("button", name="S3", exact=True).click()
    visitor.settled()
    page.click("#tab-tolerance")
    page.locator("#tab-panel").get_by_role("button", name="Compute").click()
    page.wait_for_selector("table[data-scatter]")
    page.click("#tab-margins")
    page.locator(".budget").get_by_role("button", name="Compute").click()
    page.wait_for_function("() => document.querySelector('.budget form[aria-busy=false] [role=status]')?.textContent")
    assert len(page.evaluate(SHOWN)["texts"]) > 0
    with held(visitor):
        visitor.open(EXAMPLES / "train.toml")
        page.wait_for_function("() => document.querySelector('.title').value.includes('coach')")
        page.evaluate(FRAMES)
        assert page.evaluate(SHOWN) == NOTHING
        page.get_by_role("button", name="Undo").click()
        page.click("#tab-tolerance")
        page.wait_for_selector("table[data-scatter]")  # and again under the seat, since it is that of it


def test_an_optimum_that_comes_late_is_not_put_into_another_study(visitor: Visitor) -> None:
    page = visitor.page
    _opened(visitor, "seat")
    held_back = HeldRequests(visitor, "**/api/panel/optimise")
    with page.expect_request("**/api/panel/optimise"):
        page.get_by_role("button", name="Find best").click()
    page.wait_for_timeout(200)
    (late,) = held_back.routes
    held_back.end()
    _opened(visitor, "train")
    with page.expect_response("**/api/panel/optimise"):
        late.continue_()
    page.evaluate(FRAMES)
    page.wait_for_timeout(500)
    page.wait_for_selector("#verdict[data-severity=open]")
    assert "chosen yet" in page.inner_text("#verdict > b")
    assert page.inner_text(".optimise [role=status]") == ""
    assert json.loads(page.evaluate("() => sessionStorage.getItem('inerter.document')"))["values"] == {}


def test_an_optimum_that_comes_after_an_undo_is_taken_and_what_was_undone_can_be_redone(
    served: Served, visitors: Callable[..., Visitor]
) -> None:
    window = visitors(served)
    held_back = HeldRequests(window, "**/api/panel/optimise")
    page = window.visit().page
    wait_until(lambda: (page.wait_for_timeout(20), bool(held_back.routes))[1])
    entry = page.locator("[id='entry vehicle.sprung_mass']")
    entry.fill("200 kg")
    page.keyboard.press("Enter")
    page.wait_for_function("() => document.getElementById('entry vehicle.sprung_mass').title === '200 kg'")
    page.get_by_role("button", name="Undo").click()
    page.wait_for_function("() => document.getElementById('entry vehicle.sprung_mass').title !== '200 kg'")
    held_back.end()
    for late in held_back.routes:
        late.continue_()
    window.chosen()
    page.get_by_role("button", name="Redo").click()
    page.wait_for_function("() => document.getElementById('entry vehicle.sprung_mass').title === '200 kg'")


def _moves(page: Any) -> None:
    """Wait for less than two seconds until something tells how long an answer is coming, and see that it goes on."""
    page.wait_for_selector(".clock", timeout=2000)
    before = page.inner_text(".clock >> nth=0")
    page.wait_for_function(
        "text => (document.querySelector('.clock')?.innerText ?? text) !== text", arg=before, timeout=2000
    )


def _slide(page: Any, name: str = "k") -> None:
    page.fill(f"[id='entry elements.{name}']", "100 kN/m")
    page.keyboard.press("Enter")


def _save(name: str) -> Callable[[Any], None]:
    def save(page: Any) -> None:
        page.get_by_text("Save", exact=True).click()
        page.get_by_role("button", name=name).click()

    return save


def _find_out(tab: str) -> Callable[[Any], None]:
    def ask(page: Any) -> None:
        page.click(f"#tab-{'margins' if tab == 'budget' else tab}")
        page.locator(".budget" if tab == "budget" else "#tab-panel").get_by_role("button", name="Compute").click()

    return ask


ASKING: dict[str, Callable[[Any], None]] = {
    "a slider": _slide,
    "a road": lambda page: (
        page.click("#tab-history"),
        page.fill("label:has-text('for [s]') input", "12"),
        page.keyboard.press("Enter"),
    ),
    "an optimum": lambda page: page.get_by_role("button", name="Find best").click(),
    "a budget": _find_out("budget"),
    "a tolerance": _find_out("tolerance"),
    "a picture": _save("On the road (PNG)"),
    "a table": _save("Frequency response (CSV)"),
    "a study": lambda page: (
        page.get_by_text("Open", exact=True).click(),
        page.set_input_files(".menu input[type=file]", str(EXAMPLES / "seat.toml")),
    ),
    "work": lambda page: (page.click("#tab-work"), page.locator("form.begin button").first.click()),
}


EARLY: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "a tolerance": ("panel/tolerance", _find_out("tolerance")),
    "a budget": ("panel/budget", _find_out("budget")),
    "break-even values": (
        "work",
        lambda page: (page.click("#tab-margins"), page.get_by_role("button", name="Compute break-even values").click()),
    ),
    "a report": ("work", _save("Report of these designs (HTML)")),
    "a study file": ("study/write", _save("This design, values fixed (TOML)")),
    "an export": (
        "export/design",
        lambda page: (page.click("#export-menu > summary"), page.locator("#export-menu .edged").first.click()),
    ),
}


@pytest.mark.parametrize("what", sampled(EARLY, often=["a tolerance"], kept=2))
def test_what_is_asked_before_the_first_optimum_is_asked_of_it(
    what: str, served: Served, visitors: Callable[..., Visitor]
) -> None:
    """A page begins at the optimum of its designs: what a button asks before that waits for it, and says so."""
    visitor = visitors(served)
    page = visitor.page
    path, ask = EARLY[what]
    asked: list[Any] = []

    def refuse(route: Any) -> None:
        if route.request.method != "POST":
            return route.fallback()
        asked.append(route.request.post_data_json)
        return route.fulfill(status=400, body=json.dumps({"sentence": "Not today."}))

    page.route(f"**/api/{path}", refuse)
    with held(visitor, "panel/optimise") as waiting:
        with page.expect_request("**/api/panel/optimise"):
            visitor.visit()
        page.get_by_role("group", name="Layouts").get_by_role("button", name="S3", exact=True).click()
        ask(page)
        page.evaluate(FRAMES)
        assert asked == []
        if path.startswith("panel/"):
            assert page.locator("#tab-panel form[aria-busy=true] .moving").count() == 1
        with page.expect_request(f"**/api/{path}"):
            waiting.pop().continue_()
    page.evaluate(FRAMES)
    body = asked[0]
    assert set((body.get("design") or body["designs"][0])["values"]) == {"b", "c"}
    if path != "study/write":
        page.get_by_text("Not today.").first.wait_for()  # the answer to what is asked now, and shown


def test_a_study_that_is_changed_before_its_first_optimum_begins_at_that_of_what_it_has_become(
    served: Served, visitors: Callable[..., Visitor]
) -> None:
    visitor = visitors(served)
    page = visitor.page
    with held(visitor, "panel/optimise") as waiting:
        with page.expect_request("**/api/panel/optimise"):
            visitor.visit()
        page.fill("[id='entry vehicle.sprung_mass']", "320 kg")
        page.keyboard.press("Enter")
        page.evaluate(FRAMES)
        with page.expect_request("**/api/panel/optimise") as asked:
            waiting.pop().continue_()
        page.evaluate(FRAMES)
        assert asked.value.post_data_json["study"]["vehicle"]["sprung_mass"] == "320 kg"
        waiting.pop().continue_()
        visitor.chosen()
    visitor.settled()
    assert page.locator("#verdict .stale").count() == 0


def test_the_first_optimum_is_asked_before_anything_is_drawn(served: Served, visitors: Callable[..., Visitor]) -> None:
    """Nothing that is asked of the study comes before it: the server optimises while the page is drawn."""
    visitor, asked = visitors(served), list[str]()
    visitor.page.on("request", lambda request: asked.append(request.url.rpartition("/api/")[2]))
    visitor.visit()
    visitor.chosen()
    of_study = [path for path in asked if path.startswith(("panel/", "study/"))]
    assert of_study[0] == "panel/optimise"
    assert of_study.count("study/parts") == 1


def test_a_page_that_is_reloaded_before_its_first_optimum_begins_at_it_too(
    served: Served, visitors: Callable[..., Visitor]
) -> None:
    visitor = visitors(served)
    with held(visitor, "panel/optimise"), visitor.page.expect_request("**/api/panel/optimise"):
        visitor.visit()
    visitor.page.reload()
    visitor.chosen()


@pytest.mark.parametrize("what", sampled(ASKING, kept=3))
def test_nothing_is_silent_for_two_seconds(what: str, visitor: Visitor) -> None:
    page = visitor.page
    visitor.settled()
    page.get_by_role("group", name="Layouts").get_by_role("button", name="S3", exact=True).click()
    visitor.settled()
    with held(visitor, "") as waiting:
        ASKING[what](page)
        _moves(page)
        assert waiting


def test_an_answer_says_that_it_is_coming_and_a_cleared_network_has_none(visitor: Visitor) -> None:
    page = visitor.page
    visitor.pick("S3e")
    page.wait_for_selector(".answers[data-being=current]")
    before, looks = page.evaluate(SHOWN)["numbers"], page.evaluate(LOOKS)
    with held(visitor):
        _slide(page, "ks")
        page.wait_for_selector(".answers[data-being=coming]")
        assert page.evaluate(SHOWN)["numbers"] == before  # those of the step before, and said to be
        page.wait_for_selector(".answers tr.stale")
        faded = page.locator(".answers tr.stale .pick").evaluate_all("all => all.map(each => each.title)")
        assert sorted(faded) == ["S2e", "S3e"]  # which alone have this spring
        assert page.evaluate(LOOKS) == looks  # pale, and otherwise as before: nothing moves with a step of a slider
        page.fill("#network-text", "")
        page.wait_for_selector(".answers tr.stale", state="detached")
        assert page.evaluate(SHOWN)["numbers"] == []
    page.wait_for_selector(".answers[data-being=current]")  # those of the other layouts
    visitor.drawn()
    assert page.locator(".answers tr.on [data-value]").count() == 0
    assert page.locator(".answers tr:not(.on) [data-value]").count() > 0
    assert "S3e" not in page.locator(".drawn .name").all_inner_texts()
    assert page.locator(".vehicle canvas").count() == 0


TOOLS = """() => [...document.querySelectorAll(".plot-tools > *, .plot-ends > *, .plot-area")].map(each => {
  const { x, y, width, height } = each.getBoundingClientRect();
  return each.matches(".being") ? [x, y] : [x, y, width, height];
})"""


@pytest.mark.parametrize("tab", TABS)
def test_the_tools_of_a_plot_stay_where_they_are_while_its_answer_comes(tab: str, visitor: Visitor) -> None:
    """However long that takes, and on screens on which there is little room beside them."""
    page = visitor.page
    _opened(visitor, "half-car")
    visitor.chosen()
    page.get_by_role("button", name="Close the message").click()
    page.click(f"#tab-{tab}")
    visitor.settled()
    for width in (1280, 1360, 1920):
        page.set_viewport_size({"width": width, "height": 900})
        visitor.drawn()
        before = page.evaluate(TOOLS)
        with held(visitor):
            page.fill("[id='entry elements.k_f']", f"{width} N/cm")
            page.keyboard.press("Enter")
            page.wait_for_selector("#tab-panel .being .clock", state="attached")
            assert page.evaluate(TOOLS) == before, width
        visitor.settled()


def test_a_design_that_nobody_has_chosen_has_no_per_cent(visitor: Visitor) -> None:
    """The best values of a train are not found while one waits: it says so beside that it is open, until they are."""
    page = visitor.page
    _opened(visitor, "train")
    page.get_by_role("group", name="Layouts").get_by_role("button", name="S3", exact=True).click()
    visitor.settled()
    page.wait_for_selector("#verdict[data-severity=open]")
    said = page.inner_text("#verdict > b")
    assert "chosen yet" in said
    assert "find the best" in said
    better = page.locator(".answers [data-better], .answers td:has-text('not chosen yet')")
    assert all("not chosen yet" in text for text in better.all_inner_texts())
    assert "%" not in page.inner_text(".answers table")
    page.click("#tab-compare")
    page.wait_for_selector("[aria-label=Comparison] td[data-value]")
    assert "%" not in page.inner_text("[aria-label=Comparison]")
    assert page.locator("td.best").count() == 0
    for layout in ("S1", "S3"):
        page.locator("[aria-label=Layouts] .pick", has_text=layout).click()
        for name in re.findall(r"(\w+)(?:,| of)", page.inner_text("#tab-panel .unchosen").split("Not chosen yet: ")[1]):
            entry = page.locator(f"[id='entry elements.{name}']")
            if entry.count() and entry.is_visible():
                text = entry.get_attribute("title")
                number, _, unit = str(text).partition(" ")
                entry.fill(f"{1.1 * float(number):.4g} {unit}")
                page.keyboard.press("Enter")
    page.wait_for_selector(".unchosen", state="detached")
    visitor.settled()
    wait_until(lambda: "%" in page.inner_text(".answers table"))
    page.wait_for_selector("td.best")


@pytest.mark.marathon
def test_a_fit_that_is_withheld_says_so_first_and_hands_nothing_on(visitor: Visitor, tmp_path: Path) -> None:
    """The force of a ball screw, by a model without friction: as the command line begins, so does the page."""
    page = visitor.page
    record = tmp_path / "fit.csv"
    it.write_record(replace(load_rig(EXAMPLES / "rig_fit.toml"), duration=1.0).run(), record)
    visitor.open(record)
    page.wait_for_selector(".records li")
    page.select_option("select[name=model]", "ideal")
    page.get_by_role("button", name="Identify").click()
    page.wait_for_selector(".fit[data-state=running] .clock", timeout=30_000)
    page.wait_for_selector(".fit[data-state=done] table", timeout=120_000)
    (job,) = [job for job in json.loads(visitor.served.get("work"))["work"] if job["kind"] == "identify"]
    result = json.loads(visitor.served.get(f"work/{job['id']}/result"))
    assert result["parameters"]["b"]["value"] is None
    assert result["device"] is None
    told = page.inner_text(".fit")
    first = told.index("Unreliable")
    assert result["status"].partition(": ")[2] in told
    assert first < told.index("95 % interval")
    assert page.locator(".fit tr:has(th:text-is('b')) td").first.inner_text() == "withheld"
    assert "null" not in told
    assert page.get_by_role("button", name="Take the device").count() == 0
    before = visitor.text
    folder = tmp_path / "identified"
    folder.mkdir()
    (folder / "fit.json").write_bytes(visitor.served.get(f"work/{job['id']}/files/fit.json"))
    drop(visitor, folder)
    page.wait_for_selector(".notice:has-text('fit.json: Unreliable')")
    assert "There is no device to take" in page.inner_text(".notice:has-text('fit.json')")
    assert visitor.text == before
    page.locator(".fit").get_by_role("button", name="Forget").click()
    page.wait_for_selector(".fit", state="detached")


STICKING = study_text(
    'indices = ["J1", "J3"]\nevaluate = ["norm", "statistical-linearisation"]',
    vehicle=PAPER_CAR,
    elements='k = "120 kN/m"\nc = "7 kN s/m"\nb = "360 kg"\nf = "300 N"',
    layouts='S1 = "k | c"\nS3 = "k | c - (b | f)"',
    title='title = "Friction that sticks"',
)


def test_what_is_made_of_doubtful_numbers_says_so_first(visitor: Visitor, tmp_path: Path) -> None:
    """Answers, a comparison, a budget and the scatter of a friction: each begins with what it is worth."""
    page = visitor.page
    (tmp_path / "sticking.toml").write_text(STICKING)
    visitor.open(tmp_path / "sticking.toml")
    page.wait_for_selector("text=sticking.toml is open")
    page.select_option(".answers select >> nth=0", "statistical-linearisation")
    visitor.settled()
    page.wait_for_selector("#verdict[data-severity=doubt]")
    page.keyboard.press("v")
    assert "inaccurate" in page.inner_text("#verdict")
    cell = page.locator(".answers td:has(.doubt)").last.inner_text()
    assert cell.startswith("inaccurate")
    assert page.locator(".answers td.good, .answers td.bad").count() == 0

    page.click("#tab-compare")
    page.wait_for_selector("[aria-label=Comparison] td[data-value]")
    told = page.inner_text("#tab-panel")
    assert told.index("Unreliable") < told.index("network")
    assert page.locator("td.best, .difference.good, .difference.bad").count() == 0

    page.click("#tab-margins")
    page.locator(".budget [name=parameter]").select_option("f")
    page.locator(".budget").get_by_role("button", name="Compute").click()
    page.wait_for_function("() => document.querySelector('.budget form[aria-busy=false] [role=status]')?.textContent")
    assert page.inner_text(".budget [role=status]").startswith("Unreliable: inaccurate: friction 'f'")

    page.select_option(".answers select >> nth=0", "norm")
    page.click("#tab-tolerance")
    page.locator("#tab-panel").get_by_role("button", name="Compute").click()
    page.wait_for_selector("table[data-scatter]")
    told = page.inner_text("#tab-panel")
    assert told.index("ignores the tolerance of f") < told.index("standard deviation")
