"""The frame of the page: nothing is scrolled, the verdict is that of the library, and keys lead to every place."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from browser import Served, Visitor, drop, wait_until
from folders import EXAMPLES

import inerter as it
from inerter.files.rig.loading import load_rig

SCROLLED = """() => {
  const page = document.documentElement;
  const parts = [...document.querySelectorAll("header, nav.decision, .panel, footer.keys")];
  const outside = parts.map(each => each.getBoundingClientRect())
    .filter(box => box.bottom > innerHeight + 1 || box.right > innerWidth + 1);
  return [page.scrollHeight - page.clientHeight, page.scrollWidth - page.clientWidth, outside.length];
}"""


@pytest.mark.parametrize("size", [(1280, 800), (1920, 1080)])
def test_the_page_is_not_scrolled(visitor: Visitor, size: tuple[int, int]) -> None:
    page = visitor.page
    page.set_viewport_size({"width": size[0], "height": size[1]})
    visitor.settled()
    for tab in ("response", "history", "compare", "margins", "tolerance", "work", "rig"):
        page.click(f"#tab-{tab}")
        visitor.drawn()
        assert page.evaluate(SCROLLED) == [0, 0, 0], tab
    page.fill("#network-text", " | ".join(["k"] * 120))  # a long text scrolls in its panel
    panel, text = (page.locator(each).bounding_box() for each in (".panel.network", ".panel.network .text"))
    assert text["y"] + text["height"] <= panel["y"] + panel["height"]


def test_the_verdict_is_that_of_the_server_with_all_its_caveats(visitor: Visitor) -> None:
    """Of each index as the goal; what does not fit into the line is counted, and opens with a key."""
    page = visitor.page
    visitor.settled()
    for goal in ("J3", "J5"):
        with page.expect_response(
            lambda answer, goal=goal: (
                "panel/decision" in answer.url and answer.ok and answer.request.post_data_json["index"] == goal
            )
        ) as found:
            page.keyboard.press("2")
            page.locator(f"input[name=goal][value={goal}]").check()
            page.keyboard.press("Escape")
        told = found.value.json()
        page.wait_for_function(
            "text => document.querySelector('#verdict > b').textContent === text",
            arg=f"At values not re-optimised: {told['verdict']['sentence']}",
        )
        sentences = [each["sentence"] for each in told["verdict"]["caveats"]]
        assert page.locator("#verdict .caveat").evaluate_all("all => all.map(each => each.textContent)") == sentences
        hidden = page.locator("#verdict .caveat[hidden]").count()
        if hidden:
            cut = page.locator("#verdict .caveat").first.evaluate("each => each.scrollWidth > each.clientWidth")
            assert page.inner_text("#caveats-all") == ("All" if cut else f"{hidden} more")
            page.keyboard.press("v")
            assert page.locator("#verdict .menu-body li").all_inner_texts() == sentences
            page.keyboard.press("Escape")
        rows = page.locator(".answers tbody tr")
        assert [row.locator(".pick").get_attribute("title") for row in rows.all()] == [
            row["layout"] for row in told["rows"]
        ]
    page.locator("#verdict .stale").click()  # the values are those of J1 until all layouts are optimised for J5
    page.locator("#verdict .stale").wait_for(state="detached")
    visitor.settled()
    page.keyboard.press("2")
    page.locator("input[name=goal][value=J3]").check()
    page.locator("#verdict .stale").wait_for()


def test_values_are_stale_after_a_reload_too_and_those_of_a_job(
    served: Served, visitors: Callable[..., Visitor]
) -> None:
    """What they were optimised for is kept with them."""
    visitor = visitors(served).visit()
    page = visitor.page
    visitor.settled()
    stale = page.locator("#verdict .stale")
    page.fill("[id='entry vehicle.sprung_mass']", "320 kg")
    page.keyboard.press("Enter")
    stale.wait_for()
    page.reload()
    stale.wait_for()
    stale.click()
    stale.wait_for(state="detached")
    page.get_by_role("tab", name="Jobs").click()
    front = page.locator("form.begin", has_text="Trade-off front")
    front.locator("input[name=points]").fill("3")
    front.get_by_role("button", name="Begin").click()
    take = page.get_by_role("button", name="Take this point").first
    take.wait_for()
    panel, plot = (page.locator(each).bounding_box() for each in ("#tab-panel", ".job .plot"))
    assert plot["y"] + plot["height"] < panel["y"] + panel["height"]  # all of the front is seen
    take.click()
    visitor.settled()
    assert stale.count() == 0  # a point of a front of J1 and J3 is one for J1
    ranked = page.inner_text(".answers tbody")
    page.locator(".job circle.point[aria-label^='S1']").last.press("Enter")
    page.locator(".answers .pick[title=S1][aria-pressed=true]").wait_for()
    visitor.settled()
    assert page.inner_text(".answers tbody") != ranked
    page.get_by_role("button", name="Undo").click()  # the layout and its values are one step
    page.wait_for_function("told => document.querySelector('.answers tbody').innerText === told", arg=ranked)
    page.fill("[id='entry vehicle.sprung_mass']", "330 kg")
    page.keyboard.press("Enter")
    stale.wait_for()
    page.locator(".job").get_by_role("button", name="Forget").click()  # for other tests on this server


def test_windows_that_open_at_once_all_begin_at_the_best(served: Served, visitors: Callable[..., Visitor]) -> None:
    """None of them outdates the question of another one, however late it is answered."""
    windows = [visitors(served) for _ in range(3)]
    for window in windows:
        window.page.goto(served.link, wait_until="commit")
    for window in windows:
        window.page.wait_for_selector("[data-connection=ready]", state="attached")
        window.settled()
        assert window.page.locator(".answers .pick").count() > 1
        assert window.page.get_by_text("not chosen yet").count() == 0


def test_break_even_values_of_another_layout_than_the_best_are_not_taken_for_its_own(visitor: Visitor) -> None:
    """Which layout is the best is said beside them, with a button that selects it."""
    page = visitor.page
    for layout in ("S2", "S1"):  # another one, and the baseline
        visitor.pick(layout)
        page.click("#tab-margins")
        page.get_by_text("S3 is the best in J1.").wait_for()
        page.get_by_role("button", name="Select S3", exact=True).click()
        visitor.wait_for_text("k | c - b")
        visitor.settled()
        assert page.get_by_role("button", name="Select S3", exact=True).count() == 0


def test_jobs_that_another_panel_began_show_their_results_too(served: Served, visitors: Callable[..., Visitor]) -> None:
    window = visitors(served)
    job = {"study": "", "state": "done", "begun": 0.0, "done": 1, "total": 1, "told": "", "sentence": ""}
    jobs = [{**job, "id": kind, "kind": kind, "title": kind} for kind in ("margins", "identify")]
    found = {
        "margins": {"break_even": [{"parameter": "f", "sentence": "Up to 9 N.", "status": "ok"}]},
        "identify": {"model": "friction", "status": "failed", "shown": {}},
    }
    window.page.route("**/api/work", lambda route: route.fulfill(json={"work": jobs}))
    window.page.route("**/api/work/*/result", lambda route: route.fulfill(json=found[route.request.url.split("/")[-2]]))
    window.visit()
    window.page.click("#tab-work")
    window.page.locator(".job .margins", has_text="Up to 9 N.").wait_for()
    window.page.locator(".job").get_by_role("button", name="See Rig").click()
    window.page.wait_for_selector("#tab-rig[aria-selected=true]")


def test_a_constraint_on_a_travel_says_that_it_is_on_its_rms_value(visitor: Visitor) -> None:
    """60 mm of travel are no 60 mm r.m.s."""
    page = visitor.page
    page.click("#step-2")
    for of, count in {"suspension-travel": 1, "J3": 0}.items():
        page.locator(".asked [name=of]").select_option(of)
        assert page.locator(".asked").get_by_text("within ±60 mm for 99.7 % of the time").count() == count


def test_keys_lead_to_every_place(visitor: Visitor) -> None:
    page = visitor.page
    visitor.settled()
    focus = "() => document.activeElement.closest('section, nav, header, dialog, footer')?.className"
    for key, place in {"1": "", "3": "panel answers", "4": "panel tabs"}.items():
        page.keyboard.press(key)
        wait_until(lambda place=place: page.evaluate(focus) == place)
    page.wait_for_selector("#tab-margins[aria-selected=true]", state="attached")
    page.keyboard.press("?")
    page.wait_for_selector("dialog[open]")
    page.keyboard.press("Escape")
    page.wait_for_selector("dialog[open]", state="detached")
    page.keyboard.press("Control+o")
    page.wait_for_selector("#open-menu[open]")
    page.keyboard.press("Escape")
    page.wait_for_selector("#open-menu[open]", state="detached")
    page.fill("input.title", "o1?v")  # what is typed is text
    assert page.locator("dialog[open], #verdict details[open]").count() == 0
    page.locator("[data-place='elements.c'] input[type=range]").focus()
    before = page.get_attribute("[id='entry elements.c']", "title")
    page.keyboard.press("ArrowUp")
    number = float(str(before).partition(" ")[0])
    wait_until(lambda: abs(_number(page) / number - 1.01) < 1e-3)
    page.keyboard.press("x")
    wait_until(lambda: not page.locator("[data-place='elements.c'] input[type=checkbox]").is_checked())
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    wait_until(lambda: page.get_attribute("[id='entry elements.c']", "title") == before)
    with page.expect_request("**/api/panel/optimise"):
        page.keyboard.press("o")


def _number(page: Any) -> float:
    return float(str(page.get_attribute("[id='entry elements.c']", "title")).partition(" ")[0])


def test_a_question_opens_by_the_keyboard(nothing: Served, visitors: Callable[..., Visitor]) -> None:
    """The first screen has a card for each example; a study that was left is offered the next time."""
    visitor = visitors(nothing).visit()
    page = visitor.page
    names = [each["name"] for each in json.loads(visitor.served.get("examples"))["examples"]]
    wait_until(lambda: page.locator(".card").count() == len(names))
    assert sorted(page.locator(".card").evaluate_all("all => all.map(each => each.dataset.example)")) == sorted(names)
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowLeft")
    chosen = page.evaluate("() => document.activeElement.dataset.example")
    assert chosen == "quarter-car"
    page.keyboard.press("Enter")
    title = page.locator("input.title")
    title.wait_for()
    opened = title.input_value()
    assert f'title = "{opened}"' in (EXAMPLES / "quarter-car.toml").read_text()
    visitor.settled()
    assert page.inner_text("footer").startswith("Page")  # the card that had the focus is gone
    page.locator("#open-menu summary").click()
    page.get_by_role("button", name="The first screen").click()
    page.locator(".list-row", has_text=opened).wait_for()  # among those that were open before
    wait_until(lambda: page.locator(".card").count() == len(names))
    page.get_by_role("button", name="Undo").click()
    page.wait_for_function("text => document.querySelector('input.title')?.value === text", arg=opened)
    page.reload()
    other = visitors(visitor.served, context=page.context).visit().page
    other.locator(".list-row", has_text=opened).click()
    other.wait_for_function("text => document.querySelector('input.title')?.value === text", arg=opened)


def test_a_record_without_a_study_is_shown_beside_a_quarter_car(
    nothing: Served, visitors: Callable[..., Visitor], tmp_path: Path
) -> None:
    """Otherwise the first screen would show nothing of it."""
    record = tmp_path / "noise.csv"
    rows = (f"{i / 1000},{i % 7},{(i * i) % 11}" for i in range(400))
    record.write_text("time [s],displacement [mm],force [N]\n" + "\n".join(rows) + "\n")
    visitor = visitors(nothing).visit()
    drop(visitor, record)
    visitor.page.wait_for_selector("text=noise.csv was read.")
    assert visitor.page.locator("#tab-rig").get_attribute("aria-selected") == "true"
    visitor.page.locator(".records .plot .drawn").wait_for()
    visitor.wait_for_text("k | c")  # the device is to join the baseline, which has no inerter yet


def test_an_index_has_one_unit_in_all_places(visitor: Visitor) -> None:
    """That of the library, in the ranking, the comparison and the plot."""
    page = visitor.page
    visitor.settled()
    head = page.locator(".answers thead th", has_text="J5").inner_text()
    assert head == "J5 [µm/N]"
    row = page.locator(".answers tr.on td[data-index=J5]")
    value, text = float(row.get_attribute("data-value")), row.locator(".scatter").inner_text()
    assert float(text) == pytest.approx(1e6 * value, rel=1e-3)
    page.get_by_role("tab", name="Compare").click()
    visitor.drawn()
    assert page.locator(".compared th", has_text="J5").inner_text().endswith("[µm/N]")
    cell = page.locator(".compared tr", has_text="J5").locator("td").first
    assert float(cell.inner_text().split()[0]) == pytest.approx(1e6 * float(cell.get_attribute("data-value")), rel=1e-3)
    page.get_by_role("tab", name="Response").click()
    page.get_by_role("tabpanel").get_by_label("Index").select_option("J5")
    page.locator(".drawn .title", has_text="µm/N").wait_for()
    page.get_by_role("button", name="Table", exact=True).click()
    page.locator(".plot-table th", has_text="µm/N").first.wait_for()


def test_the_ranking_draws_the_struts_by_which_layouts_differ(
    tmp_path: Path, served: Served, visitors: Callable[..., Visitor]
) -> None:
    text = (EXAMPLES / "half-car.toml").read_text()
    front = 'S3 = { front = "k_f | c_f - b_f", rear = "k_r | c_r - b_r" }'
    assert front in text
    study = tmp_path / "study.toml"
    study.write_text(text.replace(front, 'S3 = { front = "k_f | c_f - b_f", rear = "k_r | c_r" }'))
    struts = "all => all.map(each => [...each.querySelectorAll('.of')].map(one => one.title))"
    for path, expected in {
        study: {"S1": ["front, rear"], "S2": ["front, rear"], "S3": ["front", "rear"]},
        EXAMPLES / "absorber.toml": {"TMD": [""], "TMDI": ["mount", "ground"]},
    }.items():
        window = visitors(served).visit()
        window.open(path)
        window.page.wait_for_selector(".notice")
        window.settled()
        found = dict(
            zip(
                window.page.locator(".answers .pick").evaluate_all("all => all.map(each => each.title)"),
                window.page.locator(".answers .pick").evaluate_all(struts),
                strict=True,
            )
        )
        assert found == expected


def test_one_button_alone_is_filled(served: Served, visitors: Callable[..., Visitor]) -> None:
    for name in ("quarter-car", "search_quarter_car"):
        visitor = visitors(served).visit()
        visitor.open(EXAMPLES / f"{name}.toml")
        visitor.page.wait_for_selector(".notice")
        visitor.settled()
        for tab in ("response", "work"):
            visitor.page.click(f"#tab-{tab}")
            visitor.drawn()
            assert visitor.page.locator("button.main").all_inner_texts() == [
                "Find best O" if name == "quarter-car" else "Search for the best network"
            ]


HIDDEN = """() => {
  const { scrollHeight, clientHeight } = document.getElementById("tab-panel");
  return scrollHeight - clientHeight;
}"""


def test_values_that_nobody_has_chosen_are_optimised_from_the_verdict_and_taken(visitor: Visitor) -> None:
    """Of a train, whose optimum is a job: it is begun beside the verdict, and its values are there when it is done."""
    page = visitor.page
    visitor.open(EXAMPLES / "train.toml")
    page.wait_for_selector("text=train.toml is open")
    visitor.settled()
    visitor.drawn()
    assert page.evaluate(HIDDEN) == 0  # the warning leaves room for the whole plot
    page.locator("#verdict").get_by_role("button", name="Optimise all layouts").click()
    page.wait_for_selector("text=The values of S1 and S3 are the best found for J1.", timeout=120_000)
    visitor.chosen()
    visitor.settled()
    assert page.locator("#verdict .stale").count() == 0
    assert "better than S1" in page.inner_text("#verdict > b")
    page.locator(".job").first.get_by_role("button", name="Forget").click()  # for other tests on this server


def test_the_optimum_of_a_job_is_not_put_into_another_study(visitor: Visitor) -> None:
    page = visitor.page
    visitor.open(EXAMPLES / "train.toml")
    page.wait_for_selector("text=train.toml is open")
    visitor.settled()
    page.get_by_role("button", name="Find best").click()
    page.wait_for_selector(".job")
    page.wait_for_function(  # it is scrolled into sight: forms are above it
        """() => {
          const [job, panel] = [".job", "#tab-panel"].map((each) =>
            document.querySelector(each).getBoundingClientRect());
          return panel.top - 1 <= job.top && job.top < panel.bottom - 20;
        }"""
    )
    page.fill("[id='entry elements.k']", "390 kN/m")
    page.keyboard.press("Enter")
    page.wait_for_selector(".job[data-state=done] >> text=Take", timeout=120_000)
    visitor.settled()
    assert json.loads(page.evaluate("() => sessionStorage.getItem('inerter.document')"))["values"] == {}
    page.locator(".job").first.get_by_role("button", name="Forget").click()  # for other tests on this server


def selected(visitor: Visitor) -> str:
    return str(visitor.page.get_attribute(".answers .pick[aria-pressed=true]", "title"))


def test_the_layout_opens_of_which_the_verdict_speaks(
    served: Served, visitors: Callable[..., Visitor], tmp_path: Path
) -> None:
    """Whichever is the last of the file, as one step with the opening; another one that is chosen stays."""
    visitor = visitors(served).visit()
    page = visitor.page
    visitor.chosen()

    def is_best() -> bool:
        return page.inner_text("#verdict > b").startswith(selected(visitor) + " ")

    assert is_best()
    page.wait_for_function("() => sessionStorage.getItem('inerter.document') !== null")  # it is kept a little later
    assert selected(visitor) != page.evaluate(
        "() => Object.keys(JSON.parse(sessionStorage.getItem('inerter.document')).study.layouts).at(-1)"
    )
    assert page.get_by_role("button", name="Undo").is_disabled()
    page.locator(".answers .pick[title=S2]").click()
    page.reload()
    visitor.settled()
    assert selected(visitor) == "S2"
    before = page.input_value("input.title")
    other = tmp_path / "other.toml"
    text = (EXAMPLES / "stiffness-sweep.toml").read_text()
    other.write_text(text.replace('S3 = "k | c - b"\n', 'S3 = "k | c - b"\nS4 = "k | c"\n'))

    def opened() -> str:
        visitor.open(other)
        page.wait_for_selector("text=other.toml is open")
        visitor.settled()
        return selected(visitor)

    assert opened() == "S3"
    assert is_best()
    page.get_by_role("button", name="Undo").click()
    assert (page.input_value("input.title"), selected(visitor)) == (before, "S2")

    def late(route: Any) -> None:
        page.locator(".answers .pick[title=S2]").click()
        route.continue_()

    page.route("**/api/panel/optimise", late, times=1)
    assert opened() == "S2"
    assert not is_best()


PALE = """() => [...document.querySelectorAll(".answers tbody td")]
  .filter(each => getComputedStyle(each).opacity !== "1").map(each => each.parentElement.className)"""


def test_a_verdict_at_former_optima_is_doubtful_until_they_are_found_anew(visitor: Visitor) -> None:
    """With a heavy inerter that is no design variable another strut is the best; no current number stays pale then."""
    page = visitor.page
    sentence = page.locator("#verdict > b")
    page.locator("[data-place='elements.b'] input[type=checkbox]").uncheck()
    for mass, inertance in (("90 kg", "20 kg"), ("120 kg", "100 kg"), ("150 kg", "20 kg")):
        for place, text in (("vehicle.sprung_mass", mass), ("elements.b", inertance)):
            page.fill(f"[id='entry {place}']", text)
            page.keyboard.press("Enter")
        page.wait_for_selector("#verdict[data-severity=doubt]")
        visitor.settled()
        assert sentence.inner_text().startswith("At values not re-optimised: ")
        page.locator("#verdict .stale").click()
        page.wait_for_selector("#verdict[data-severity=answer]")
        visitor.settled()
        assert not sentence.inner_text().startswith("At values")
        page.wait_for_timeout(200)
        assert page.evaluate(PALE) == []


def test_a_layout_keeps_the_focus_when_the_order_changes(visitor: Visitor) -> None:
    page = visitor.page
    order = "[...document.querySelectorAll('.answers .pick')].map(pick => pick.title)"
    before = page.evaluate(order)
    page.locator(".answers .pick[title=S2]").focus()
    page.evaluate("""() => {
      const slider = document.getElementById("slider elements.k");
      slider.value = slider.min;
      slider.dispatchEvent(new Event("input", { bubbles: true }));
    }""")
    page.wait_for_function(f"before => {order}.join() !== before.join()", arg=before)
    assert page.evaluate("document.activeElement.title") == "S2"
    page.keyboard.press("ArrowDown")
    after = page.evaluate(order)
    assert page.evaluate("document.activeElement.title") == (after[after.index("S2") + 1 :] or ["S2"])[0]


def test_a_fit_is_in_sight_below_its_button(visitor: Visitor, tmp_path: Path) -> None:
    """The findings about the record come after it."""
    page = visitor.page
    record = tmp_path / "fit.csv"
    it.write_record(replace(load_rig(EXAMPLES / "rig_fit.toml"), duration=1.0).run(), record)
    visitor.open(record)
    page.wait_for_selector(".records .finding")
    page.get_by_role("button", name="Identify", exact=True).click()
    head = page.locator(".fit").first
    head.wait_for()
    panel, fit = page.locator("#tab-panel").bounding_box(), head.bounding_box()
    assert panel is not None
    assert fit is not None
    assert fit["y"] < panel["y"] + panel["height"] - 60.0


def test_a_long_name_of_the_baseline_leaves_every_column_of_the_ranking_in_sight(
    visitor: Visitor, tmp_path: Path
) -> None:
    page = visitor.page
    path = tmp_path / "long.toml"
    name = "strut_of_the_vehicle_in_series_production"[:40]
    path.write_text((EXAMPLES / "conditions.toml").read_text().replace("S1", name), encoding="utf-8")
    visitor.open(path)
    page.wait_for_selector("text=long.toml is open")
    visitor.settled()
    widths = page.eval_on_selector_all(".answers .scroll", "all => all.map(one => [one.scrollWidth, one.clientWidth])")
    assert len(widths) == 2
    assert all(inside <= width for inside, width in widths)


def test_nothing_is_optimised_where_there_is_no_layout(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    path = tmp_path / "bare.toml"
    text = (EXAMPLES / "conditions.toml").read_text()
    path.write_text(text.replace('S1 = "k | c"\nS3 = "k | c - b"\n', ""), encoding="utf-8")
    visitor.open(path)
    page.wait_for_selector("text=bare.toml is open")
    assert page.get_by_role("button", name="Find best").is_disabled()
    assert page.locator(".optimise button").count() == 1


def test_the_keys_that_are_listed_join_each_kind_of_element(visitor: Visitor) -> None:
    """The list names the keys of all kinds that the library declares, and each of them joins one."""
    page = visitor.page
    page.keyboard.press("?")
    rows = page.locator("dialog .all-keys p", has_text="join in series").locator("kbd").all_text_contents()
    assert rows == [kind[0].upper() for kind in it.ELEMENTS]
    page.keyboard.press("Escape")
    for key, symbol in zip(rows, (kind.symbol for kind in it.ELEMENTS.values()), strict=True):
        before = page.input_value("#network-text")
        page.locator(".drawing g.element[tabindex='0']").focus()
        page.keyboard.press(key.lower())
        page.wait_for_function("before => document.getElementById('network-text').value !== before", arg=before)
        (new,) = set(re.findall(r"\w+", page.input_value("#network-text"))) - set(re.findall(r"\w+", before))
        assert new.startswith(symbol)


def test_what_is_told_of_a_file_that_is_open_moves_nothing(visitor: Visitor) -> None:
    page = visitor.page
    panels = "() => [...document.querySelectorAll('.panel')].map(each => each.getBoundingClientRect().top)"
    page.click("#tab-rig")
    before = page.evaluate(panels)[0]
    visitor.open(EXAMPLES / "limits.toml")
    page.wait_for_selector("text=limits.toml is open")
    assert page.evaluate(panels)[0] == before
    page.get_by_role("button", name="Close the message").click()
    page.wait_for_selector("text=limits.toml is open", state="detached")


CUT = """() => [...document.querySelectorAll("#verdict, #verdict > b, #verdict .caveat:not([hidden])")].filter(each =>
  each.scrollWidth > each.clientWidth || each.scrollHeight > each.clientHeight).map(each => each.textContent)"""


def test_a_long_caveat_is_read_whole(visitor: Visitor) -> None:
    """On two lines below a verdict of one; that which has no room either is in the list of all."""
    page = visitor.page
    visitor.open(EXAMPLES / "half-car.toml")
    page.wait_for_selector("text=half-car.toml is open")
    visitor.chosen()
    visitor.settled()
    visitor.drawn()
    (caveat,) = page.locator("#verdict .caveat:not([hidden])").all()
    assert "leaves the road at times" in caveat.inner_text()
    assert page.evaluate(CUT) == []
    page.set_viewport_size({"width": 1920, "height": 1080})  # on one line, and on two again
    visitor.drawn()
    page.set_viewport_size({"width": 1280, "height": 800})
    visitor.drawn()
    assert page.evaluate(CUT) == []


def test_the_ranking_is_as_wide_as_its_panel(visitor: Visitor) -> None:
    """All five rows of the quarter car are in sight, and a fourth index too."""
    page = visitor.page
    left = """() => {
      const box = document.querySelector(".answers > .scroll");
      return [box.scrollWidth - box.clientWidth, box.scrollHeight - box.clientHeight];
    }"""
    assert page.evaluate(left) == [0, 0]
    page.fill("[id='entry vehicle.sprung_mass']", "450 kg")  # which makes long differences
    page.keyboard.press("Enter")
    page.click("#step-2")
    page.get_by_role("group", name="Indices of the study").get_by_text("suspension travel").click()
    page.wait_for_selector("td[data-index=suspension-travel]")
    page.keyboard.press("Escape")
    visitor.settled()
    assert page.evaluate(left)[0] == 0
