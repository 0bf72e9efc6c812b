"""Plots of the page: what is drawn is the data, read back from the pixels; points are taken; files hold the numbers."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import HeldRequests, Served, Visitor, wait_until
from folders import EXAMPLES
from numpy.typing import NDArray

Array = NDArray[np.float64]

# The scales of a plot, from the marks of its axes alone: pixels of each mark, and its text.
MARKS = """plot => {
  const number = text => Number(text.replaceAll("−", "-"));
  const marks = (line, horizontal) => [...plot.querySelectorAll(`.axes ${line}`)].map(path => {
    const text = path.nextElementSibling;
    const [x, y] = path.getAttribute("d").slice(1).split(/[HVv ]/).map(Number);
    return [horizontal ? x : y, number(text.textContent)];
  });
  return { x: marks("path.tick:has(+ text:not(.title))", true), y: marks("path.grid", false) };
}"""
NEAR = 0.15  # [px] that a drawn point may be off


def _scale(marks: list[list[float]], log: bool) -> Callable[[Array], Array]:
    """Values at pixels, by a line through the marks of an axis, which all lie on it."""
    pixels, values = np.array(marks).T
    shown = np.log(values) if log else values
    slope, offset = np.polyfit(pixels, shown, 1)
    assert np.abs((shown - offset) / slope - pixels).max() < NEAR
    return lambda at: np.exp(slope * at + offset) if log else slope * at + offset


def _points(path: str) -> Array:
    return np.array([[float(n) for n in pair.split()] for pair in re.split("[ML]", path) if pair])


def _drawn(visitor: Visitor, name: str, within: str = ".plot") -> tuple[Any, Array]:
    """The marks of a plot, and the points of a curve in pixels."""
    plot = visitor.page.locator(within).first
    path = plot.locator(f"[data-curve='{name}']").get_attribute("d")
    assert path
    return plot.evaluate(MARKS), _points(path)


def _answer(visitor: Visitor, panel: str, act: Callable[[], Any]) -> Any:
    with visitor.page.expect_response(f"**/api/panel/{panel}") as found:
        act()
    return found.value.json()


@pytest.mark.parametrize("log", [False, True])
def test_a_response_that_is_drawn_is_that_of_the_answer(log: bool, served: Served, visitors: Any) -> None:
    visitor = visitors(served)
    answer = _answer(visitor, "response", visitor.visit)
    visitor.drawn()
    if log:
        visitor.page.get_by_role("button", name="log y", exact=True).click()
        visitor.drawn()
    for curve in (each for each in answer["curves"] if each["index"] == "J1"):
        marks, pixels = _drawn(visitor, curve["name"])
        x, y = _scale(marks["x"], True), _scale(marks["y"], log)
        frequency, gain = np.array(answer["frequency"]), np.array(curve["gain"])
        assert len(pixels) == len(frequency)
        across = np.array([np.log(x(pixels[:, 0] + d)) for d in (-NEAR, NEAR)])
        assert ((across[0] <= np.log(frequency)) & (np.log(frequency) <= across[1])).all()
        up = np.array([y(pixels[:, 1] + d) for d in (NEAR, -NEAR)])
        assert ((up[0] <= gain) & (gain <= up[1])).all()


def test_phases_stand_beside_gains_and_outputs_have_names(served: Served, visitors: Any) -> None:
    visitor = visitors(served).visit()
    page = visitor.page
    visitor.settled()
    visitor.open(EXAMPLES / "half-car.toml")
    page.wait_for_selector("[aria-label=Output]")
    visitor.settled()
    visitor.drawn()
    outputs = page.locator("[aria-label=Output] option").all_inner_texts()
    assert outputs == ["sprung acceleration", "pitch acceleration × 1.02 m", "all outputs"]
    titles = []
    for output in outputs:
        page.select_option("[aria-label=Output]", label=output)
        visitor.drawn()
        titles.append(page.locator(".axes .title").first.text_content())
    assert len(set(titles)) == 3
    page.select_option("[aria-label=Output]", label=outputs[0])
    page.get_by_role("button", name="both", exact=True).click()
    visitor.drawn()
    assert page.locator(".plots .plot .drawn").count() == 2
    page.locator(".plots .plot-reader").nth(0).hover(position={"x": 60, "y": 40})
    assert page.locator(".plots .cross").count() == 2  # one place is read in both
    heads = page.locator(".plots .tip .head").all_text_contents()
    assert len(heads) == 2
    assert heads[0] == heads[1]


def test_a_plot_is_read_by_keyboard_and_as_a_table(visitor: Visitor) -> None:
    page = visitor.page
    visitor.drawn()
    reader = page.locator(".plot-reader")
    reader.focus()
    page.keyboard.press("Home")
    first = float(str(reader.get_attribute("aria-valuenow")))
    page.keyboard.press("ArrowRight")
    second = float(str(reader.get_attribute("aria-valuenow")))
    page.keyboard.press("End")
    assert first < second < float(str(reader.get_attribute("aria-valuenow")))
    said = str(reader.get_attribute("aria-valuetext"))
    assert re.fullmatch(r"[\d.]+ Hz: S1 [\d.]+, S3 [\d.]+", said)
    page.keyboard.press("Home")
    page.keyboard.press("+")
    whole = page.get_by_role("button", name="Whole range")
    whole.wait_for()
    page.keyboard.press("0")
    whole.wait_for(state="detached")
    page.get_by_role("button", name="Table", exact=True).click()
    heads = page.locator(".plot-table th[scope=col]").all_inner_texts()
    assert heads[0] == "frequency [Hz]"
    assert [head.split(" of ")[1].split(" ")[0] for head in heads[1:]] == ["S1", "S3"]
    assert page.locator(".plot-table tbody tr").count() > 50


def _saved(visitor: Visitor, kind: str, into: Path) -> Path:
    page = visitor.page
    with page.expect_download() as found:
        page.locator(".plot-tools summary", has_text="Figure").first.click()
        page.locator(".plot-tools").get_by_role("button", name=kind, exact=True).first.click()
    path = into / str(found.value.suggested_filename)
    found.value.save_as(path)
    return path


def test_a_plot_is_saved_as_picture_and_numbers(served: Served, visitors: Any, tmp_path: Path) -> None:
    visitor = visitors(served)
    answer = _answer(visitor, "response", visitor.visit)
    visitor.drawn()
    picture = _saved(visitor, "SVG", tmp_path).read_text()
    assert "var(" not in picture
    assert all(text in picture for text in ("Frequency [Hz]", ">S1<", ">S3<", 'fill="rgb(255, 255, 255)"'))
    assert _saved(visitor, "PNG", tmp_path).read_bytes().startswith(b"\x89PNG")
    with _saved(visitor, "CSV", tmp_path).open(newline="") as stream:
        head, *rows = list(csv.reader(stream))
    curves = [each for each in answer["curves"] if each["index"] == "J1"]
    assert head[0] == "frequency [Hz]"
    assert sorted(head[1:]) == sorted(f"{each['title']} of {each['name']} [(m/s²)/(m/s)]" for each in curves)
    values = np.array(rows, dtype=float)
    assert values[:, 0].tolist() == answer["frequency"]
    for each in curves:
        column = next(i for i, name in enumerate(head) if f" of {each['name']} " in name)
        assert values[:, column].tolist() == each["gain"]


@pytest.mark.marathon
def test_each_plot_is_cut_at_its_own_edges(visitor: Visitor) -> None:
    """Plots that come one after another, of which those of fronts are narrower."""
    page = visitor.page
    page.click("#tab-work")
    for title, points in (("Sweep", "2"), ("Trade-off front", "3")):
        form = page.locator("form.begin", has_text=title)
        form.locator("[name=points]").fill(points)
        form.get_by_role("button", name="Begin").click()
        page.locator(".job[data-state=done]", has_text=title).locator(".drawn").first.wait_for(timeout=120_000)
    ids = page.locator("clipPath").evaluate_all("all => all.map(each => each.id)")
    assert len(set(ids)) == len(ids) >= 2


def test_numbers_that_are_not_current_are_not_saved(visitor: Visitor) -> None:
    page = visitor.page
    visitor.drawn()
    held_back = HeldRequests(visitor, "**/api/panel/response")
    page.get_by_role("button", name="Undo").focus()
    entry = page.locator(".amount > .entry").first
    entry.fill("119 kN/m")
    entry.press("Enter")
    wait_until(lambda: len(held_back.routes) > 0 or bool(page.wait_for_timeout(20)))
    assert page.locator(".plot-tools .menu-body button").first.is_disabled()
    held_back.end()
    for route in held_back.routes:
        route.continue_()
    visitor.drawn()
    assert page.locator(".plot-tools .menu-body button").first.is_enabled()


def test_other_designs_are_drawn_too(visitor: Visitor) -> None:
    page = visitor.page
    visitor.drawn()
    assert page.locator("path.curve").count() == 2
    page.locator(".plot-tools summary", has_text="More curves").click()
    page.locator(".plot-tools").get_by_label("S2", exact=True).check()
    page.wait_for_selector("path.curve[data-curve=S2]")
    assert page.locator(".drawn .name").all_text_contents().count("S2") == 1


def _finished(visitor: Visitor, kind: str, points: int) -> Any:
    """The result of a job that is begun in the page."""
    page = visitor.page
    page.click("#tab-work")
    others = {each["id"] for each in json.loads(visitor.served.get("work"))["work"]}
    form = page.locator("form.begin", has_text=kind)
    form.locator("[name=points]").fill(str(points))
    form.get_by_role("button", name="Begin").click()
    job = page.locator(".job", has_text=kind.split(" ", maxsplit=1)[0]).first
    job.locator(".plot .drawn").wait_for(timeout=120_000)
    (known,) = [each for each in json.loads(visitor.served.get("work"))["work"] if each["id"] not in others]
    return job, json.loads(visitor.served.get(f"work/{known['id']}/result"))


@pytest.mark.marathon
def test_a_front_that_is_drawn_is_that_of_the_job(serve: Callable[..., Served], visitors: Any) -> None:
    visitor = visitors(serve(EXAMPLES / "trade_off.toml")).visit()
    page = visitor.page
    job, result = _finished(visitor, "Trade-off front", 5)
    plot = job.locator(".plot")
    marks = plot.evaluate(MARKS)
    x, y = _scale(marks["x"], False), _scale(marks["y"], False)
    first, second = (each["index"] for each in result["indices"])
    points = [point for front in result["fronts"] for point in front["points"]]
    drawn = plot.locator("circle.point").evaluate_all("all => all.map(c => [c.cx.baseVal.value, c.cy.baseVal.value])")
    assert len(drawn) == len(points)
    spans = [np.ptp([point["values"][index] for point in points]) for index in (first, second)]
    for (across, up), point in zip(drawn, points, strict=True):
        assert abs(x(np.array(across)) - point["values"][first]) < 2e-3 * spans[0]
        assert abs(y(np.array(up)) - point["values"][second]) < 2e-3 * spans[1]
    titles = plot.locator(".axes .title").all_text_contents()
    assert [re.search(r"\[.+\]", title) is not None for title in titles] == [True, True]

    own = [front for front in result["fronts"] if front["knee"] is not None]
    plot.locator("circle.point").nth(0).focus()
    page.keyboard.press("k")
    card = job.locator(".front-card")
    assert "the knee" in card.inner_text()
    page.keyboard.press("ArrowDown")
    assert card.locator("h4").inner_text().startswith(own[1]["layout"])
    page.keyboard.press("ArrowRight")
    shown = card.locator("[data-value]").evaluate_all("all => all.map(td => Number(td.dataset.value))")
    assert shown in [[point["values"][each["index"]] for each in result["indices"]] for point in own[1]["points"]]
    assert "Relative to" in card.inner_text()
    page.keyboard.press("Enter")
    taken = dict(zip((each["index"] for each in result["indices"]), shown, strict=True))
    wait_until(lambda: bool(known := visitor.values().items() & taken.items()) and len(known) > 0)


@pytest.mark.marathon
def test_a_sweep_is_drawn_in_the_unit_of_the_study_and_taken_whole(serve: Callable[..., Served], visitors: Any) -> None:
    visitor = visitors(serve(EXAMPLES / "quarter-car.toml")).visit()  # where there are no other jobs
    page = visitor.page
    job, result = _finished(visitor, "Sweep", 3)
    plot = job.locator(".plot")
    assert job.locator("b").first.inner_text().startswith("Sweep of k from 60 kN/m to 240 kN/m")
    assert plot.locator(".axes .title").last.text_content() == "Spring k [kN/m]"
    assert plot.locator(".mark-at text").text_content() == "study: 120 kN/m"
    marks = plot.evaluate(MARKS)
    x, y = _scale(marks["x"], False), _scale(marks["y"], False)
    rows = [row for row in result["designs"] if row["index"] == "J1" and row["layout"] == "S3"]
    path = _points(str(plot.locator("[data-curve=S3]").get_attribute("d")))
    assert np.allclose(x(path[:, 0]), [row["k"] / 1000 for row in rows], atol=0.3)
    assert np.allclose(y(path[:, 1]), [row["improvement_percent"] for row in rows], atol=0.1)
    before = page.input_value("#network-text"), visitor.values()
    at = plot.locator("circle.point[aria-label^='S3 at k = 240']")
    at.press("Enter")
    wait_until(lambda: visitor.values().get("J1") == rows[-1]["value"])
    page.get_by_role("button", name="Undo").click()
    wait_until(lambda: (page.input_value("#network-text"), visitor.values()) == before)


def test_the_time_of_a_history_is_that_of_the_picture(visitor: Visitor) -> None:
    page = visitor.page
    visitor.open(EXAMPLES / "ball_screw.toml")
    page.wait_for_selector("text=ball_screw.toml is open")
    page.click("#tab-history")
    page.wait_for_selector(".plot .cursor", state="attached")
    visitor.drawn()
    page.locator(".plot-reader").click(position={"x": 200, "y": 30})
    first = float(str(page.locator(".plot .cursor").get_attribute("data-at")))
    page.keyboard.press("ArrowRight")
    assert float(str(page.locator(".plot .cursor").get_attribute("data-at"))) > first > 0
    assert "r.m.s." in str(page.locator(".plot .drawn").text_content())
