"""Whole journeys in the browser, as people make them."""

from __future__ import annotations

import csv
import json
import re
import shutil
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from browser import Served, Visitor, drop, free_port, wait_until
from folders import EXAMPLES
from study_text import PAPER_CAR, study_text

import inerter as it
from inerter.app.designs import design_of
from inerter.app.documents import study_from
from inerter.cli.main import call
from inerter.files.rig.loading import load_rig
from inerter.files.study.chosen_design import WITHOUT_CONDITIONS
from inerter.files.study.loading import load_study
from inerter.formatting import format_quantity
from inerter.kernels import h2
from inerter.kernels.cache import cache_folder

ELEMENTS = 'k = "120 kN/m"\nc = { from = "100 N s/m", to = "100 kN s/m" }'


def _newcomer(*indices: str) -> str:
    settings = f'indices = {json.dumps(indices)}\noptimise = "norm"\nbaseline = "S1"'
    title = 'title = "A newcomer\'s car"'
    return study_text(settings, vehicle=PAPER_CAR, elements=ELEMENTS, layouts='S1 = "k | c"', title=title)


def _run(study: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    """The designs that the command line prints."""
    capsys.readouterr()
    assert call(["run", str(study), "-o", str(out), "--json"]) == 0
    return list(json.loads(capsys.readouterr().out)["designs"])


def _study(visitor: Visitor) -> Any:
    """The study as the page keeps it."""
    return json.loads(visitor.page.evaluate("() => sessionStorage.getItem('inerter.document')"))["study"]


def _by_mouse(visitor: Visitor) -> None:
    page = visitor.page
    page.get_by_role("button", name="Add a layout").click()
    page.locator(".element[data-name=c]").click()
    page.get_by_role("button", name="in series").click()
    page.get_by_role("button", name="Add a inerter").click()
    page.locator("[data-place='elements.b'] input[type=checkbox]").check()
    page.get_by_role("button", name="Find best").click()


def _by_keyboard(visitor: Visitor) -> None:
    page = visitor.page
    keys = page.keyboard
    page.get_by_role("button", name="Add a layout").focus()
    keys.press("Enter")
    page.locator(".element[data-name=k]").focus()
    page.wait_for_selector(".element.chosen[data-name=k]")
    keys.press("ArrowRight")
    page.wait_for_selector(".element.chosen[data-name=c]")
    keys.press("i")
    page.locator("[data-place='elements.b'] input[type=checkbox]").focus()
    keys.press("Space")
    page.get_by_role("button", name="Find best").focus()
    keys.press("Enter")


def _press(visitor: Visitor, name: str) -> None:
    visitor.page.get_by_role("button", name=name).click()


def _type(visitor: Visitor, name: str) -> None:
    visitor.page.keyboard.press({"Undo": "Control+Z", "Redo": "Control+Shift+Z"}[name])


def _built_compared_and_undone(
    visitor: Visitor, folder: Path, build: Callable[[Visitor], None], turn: Callable[[Visitor, str], None]
) -> dict[str, float]:
    """The indices of a newcomer's second strut, drawn and optimised, undone and done again."""
    page = visitor.page
    title = page.input_value("input.title")
    study = folder / "newcomer.toml"
    study.write_text(_newcomer("J1", "J3", "J5"))
    visitor.open(study)
    visitor.wait_for_text("k | c")
    visitor.settled()
    build(visitor)
    page.wait_for_function(
        "() => document.querySelector('.optimise [role=status]').textContent.startsWith('The values of')"
    )
    assert visitor.text == "k | c - b"
    optimum = visitor.values()

    page.click("#tab-compare")
    page.wait_for_selector("td.best")
    assert page.locator("[aria-label=Comparison] thead th").all_inner_texts() == ["S1", "S2"]

    steps = 0
    while page.get_by_role("button", name="Undo").is_enabled():
        turn(visitor, "Undo")
        page.wait_for_timeout(100)
        steps += 1
    wait_until(lambda: page.input_value("input.title") == title)
    assert steps >= 4
    while page.get_by_role("button", name="Redo").is_enabled():
        turn(visitor, "Redo")
        page.wait_for_timeout(100)
    visitor.wait_for_text("k | c - b")
    assert visitor.values() == optimum
    return optimum


def test_a_newcomer_builds_optimises_and_undoes_by_keyboard(visitor: Visitor, tmp_path: Path) -> None:
    assert _built_compared_and_undone(visitor, tmp_path, _by_keyboard, _type)


@pytest.mark.usefixtures("undrawn")
def test_a_newcomer_builds_optimises_undoes_shares_and_runs(
    visitor: Visitor, visitors: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page, served = visitor.page, visitor.served
    optimum = _built_compared_and_undone(visitor, tmp_path, _by_mouse, _press)

    page.get_by_text("Share", exact=True).click()
    page.wait_for_function("() => document.querySelector('#shared-link')?.value.includes('#state=')")
    link = page.input_value("#shared-link")
    assert served.token not in link
    other = visitors(served, context=page.context).visit(link)
    other.page.wait_for_selector("#network-text")
    assert other.text == "k | c - b"
    assert other.values() == optimum
    assert served.token not in other.page.url

    free = other.download("Study file", tmp_path)
    found = {row["layout"]: row["value"] for row in _run(free, tmp_path / "free", capsys) if row["index"] == "J1"}
    assert found["S2"] == optimum["J1"]
    fixed = other.download("This design, values fixed", tmp_path)
    assert {row["index"]: row["value"] for row in _run(fixed, tmp_path / "fixed", capsys)} == optimum


def test_every_example_opens(visitor: Visitor) -> None:
    """One after another in one window, each in place of the one before; of a simulation its vehicle or its device."""
    page = visitor.page
    opened = 0
    for path in sorted(EXAMPLES.glob("*.toml")):
        before = visitor.text
        visitor.open(path)
        page.wait_for_selector(".notice")
        told = page.inner_text(".notice")
        page.get_by_role("button", name="Close the message").click()
        page.wait_for_selector(".notice", state="detached")
        try:
            study = load_study(path)
        except it.InerterError:
            tables = tomllib.loads(path.read_text())
            said = "not a study file"
            if "simulation" in tables:
                rig = tables["vehicle"]["model"] == "rig"
                said = "The device is in the new layout" if rig else f"{path.name} is open as a study of its vehicle"
            assert said in told, (path.name, told)
            assert "simulation" in tables or visitor.text == before, path.name
            continue
        opened += 1
        assert told.startswith(f"{path.name} is open."), (path.name, told)
        visitor.settled()
        assert page.locator(".problems, .element.unknown").count() == 0, path.name
        shown = page.get_by_role("group", name="Layouts").locator(".pick").all_inner_texts()
        assert sorted(text.split()[0] for text in shown) == sorted(study.layouts)
    assert opened >= 4


@pytest.mark.marathon
def test_one_car_in_motion_after_another(visitor: Visitor) -> None:
    """What is drawn is never the motion of one with the parts of another, whichever answer comes first."""
    page = visitor.page
    page.click("#tab-history")
    for name in ("full-car-two-tracks", "train", "quarter-car"):
        visitor.open(EXAMPLES / f"{name}.toml")
        page.wait_for_selector(f"text={name}.toml is open")
        visitor.settled()
        visitor.drawn()
        page.wait_for_selector(".vehicle canvas[data-frames]")
    assert visitor.faults == []


def test_a_long_sweep_is_stopped_and_survives_a_reload(visitor: Visitor) -> None:
    page = visitor.page
    page.click("#tab-work")
    page.fill("input[name=points]", "100000")
    page.locator("form.begin", has_text="Sweep").get_by_role("button", name="Begin").click()
    page.wait_for_selector(".job[data-state=running] progress[value]")
    page.reload()
    page.click("#tab-work")
    page.wait_for_selector(".job[data-state=running]")
    page.locator(".job").get_by_role("button", name="Stop").click()
    stopped = page.locator(".job[data-state=stopped]")
    stopped.get_by_role("button", name="Forget").click()
    stopped.wait_for(state="detached")


def test_a_server_that_goes_while_the_page_begins_is_lost(served: Served, visitors: Any) -> None:
    """Not one that the page has yet to find: what was asked before is on the page."""
    visitor = visitors(served)
    visitor.page.route("**/api/work*", lambda route: route.abort())
    visitor.visit()
    visitor.page.wait_for_selector("[data-connection=lost]", timeout=20_000)


def test_a_server_that_goes_while_nothing_is_asked_is_missed(serve: Callable[..., Served], visitors: Any) -> None:
    """Also of a study that came with a link, which is not that of the file of the command line."""
    served = serve(EXAMPLES / "quarter-car.toml")
    first = visitors(served).visit()
    first.chosen()
    first.page.get_by_text("Share", exact=True).click()
    first.page.wait_for_function("() => document.querySelector('#shared-link')?.value.includes('#state=')")
    link = first.page.input_value("#shared-link")
    windows = [first, visitors(served, context=first.page.context).visit(link)]
    for window in windows:
        window.settled()
    served.stop()
    for window in windows:
        window.page.wait_for_selector("[data-connection=lost]", timeout=20_000)
    served.begin()
    served.wait_until_ready()
    for window in windows:
        window.page.wait_for_selector("[data-connection=ready]", state="attached")


def test_the_server_goes_and_comes_back(serve: Callable[..., Served], visitors: Any) -> None:
    served = serve(EXAMPLES / "quarter-car.toml")
    visitor = visitors(served).visit()
    page = visitor.page
    served.stop()
    page.fill("#network-text", "k | c | b")
    page.wait_for_selector("[data-connection=lost]")
    assert page.locator("[data-path]").count() == 3  # drawn without any server
    page.wait_for_selector("#verdict:has-text('Not computed')")
    assert page.locator(".being progress").count() == 0
    page.fill("[id='entry elements.k']", "100 kN/m")
    page.keyboard.press("Enter")
    served.begin()
    served.wait_until_ready()
    page.wait_for_selector("[data-connection=ready]", state="attached")
    assert visitor.text == "k | c | b"
    wait_until(lambda: page.input_value("[id='entry elements.k']") == "100 kN/m")
    visitor.settled()
    assert page.locator(".problem").count() == 0


@pytest.mark.marathon
def test_the_page_is_there_while_kernels_are_compiled(
    visitors: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = cache_folder(Path(h2.__file__))
    assert there is not None
    shutil.copytree(there.parent, tmp_path / "inerter", ignore=shutil.ignore_patterns(there.name))  # all but norms
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    fresh = Served(EXAMPLES / "quarter-car.toml", free_port())
    fresh.begin()
    try:
        window = visitors(fresh)
        window.page.goto(fresh.link)
        window.page.wait_for_selector("[data-connection=compiling]")
        assert "The numerical kernels are being compiled" in window.page.inner_text("[data-connection=compiling]")
        window.page.wait_for_function("() => /\\d of \\d/.test(document.querySelector('[data-connection]').innerText)")
        window.page.fill("#network-text", "k | c | b")
        window.page.wait_for_selector("[data-connection=ready]", state="attached", timeout=240_000)
        assert window.text == "k | c | b"
        assert window.values()["J1"] > 0.0
    finally:
        fresh.stop()


def test_what_is_typed_stays_while_answers_arrive(visitor: Visitor) -> None:
    page = visitor.page
    page.fill("#network-text", "k | c | b")
    page.locator(".element[data-name=b]").click()
    page.get_by_role("tab", name="Road").click()
    page.evaluate("() => { document.getElementById('part-menu').open = true; }")
    for field in ("#element-name", "input.title", "label:has-text('for [s]') input"):
        page.locator(field).fill("12")
        page.evaluate(
            """() => {
                const colours = document.querySelector(".theme select");
                colours.value = colours.value === "dark" ? "light" : "dark";
                colours.dispatchEvent(new Event("change", { bubbles: true }));
            }"""
        )
        page.wait_for_timeout(50)  # drawn anew
        assert page.input_value(field) == "12"


def test_dragging_and_naming_by_mouse(visitor: Visitor) -> None:
    page = visitor.page
    page.fill("#network-text", "k | c | b")
    page.wait_for_function("() => document.querySelectorAll('[data-path]').length === 3")
    source, target = (page.locator(f".element[data-name={name}] .symbol").bounding_box() for name in ("b", "c"))
    page.mouse.move(source["x"] + source["width"] / 2, source["y"] + source["height"] / 2)
    page.mouse.down()
    page.mouse.move(target["x"] + target["width"] / 2, target["y"] + target["height"] * 0.9, steps=8)
    page.mouse.up()
    visitor.wait_for_text("k | c - b")
    page.get_by_text("Part", exact=True).click()
    page.fill("#element-name", "flywheel")
    page.keyboard.press("Enter")
    visitor.wait_for_text("k | c - flywheel")
    page.get_by_role("group", name="Layouts").get_by_role("button", name="S2", exact=True).click()
    visitor.wait_for_text("k | c | flywheel")
    page.locator(".element[data-name=flywheel]").click()
    page.keyboard.press("Delete")
    visitor.wait_for_text("k | c")


@pytest.mark.marathon
def test_a_record_is_dropped_identified_and_taken(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    record = tmp_path / "fit.csv"
    it.write_record(replace(load_rig(EXAMPLES / "rig_fit.toml"), duration=1.0).run(), record)
    visitor.open(record)
    page.wait_for_selector(".records li")
    assert "fit.csv" in page.inner_text(".records")
    page.select_option("select[name=model]", "ball-screw")
    page.get_by_role("button", name="Identify").click()
    page.wait_for_selector(".fit[data-state=done] table", timeout=120_000)
    before = _study(visitor)
    page.get_by_role("button", name="Take the device into the editor").click()
    page.wait_for_function("() => document.querySelector('#network-text').value.includes('c - (')")
    visitor.settled()
    assert page.locator("#network-problem").count() == 0
    wait_until(lambda: _study(visitor) != before)
    taken = _study(visitor)
    assert {name: taken["elements"][name] for name in before["elements"]} == before["elements"]  # none is another one
    names = set(taken["elements"]) - set(before["elements"])
    page.get_by_role("button", name="Undo").click()
    wait_until(lambda: _study(visitor) == before)  # all of it in one step

    (job,) = [job for job in json.loads(visitor.served.get("work"))["work"] if job["kind"] == "identify"]
    page.locator(".fit").get_by_role("button", name="Files…").click()
    page.wait_for_selector(".fit .files >> text=report.html")
    folder = tmp_path / "identified"
    folder.mkdir()
    for name in ("fit.json", "residuals.csv"):
        (folder / name).write_bytes(visitor.served.get(f"work/{job['id']}/files/{name}"))
    drop(visitor, folder)
    page.wait_for_selector(".notice:has-text('fit.json: '):has-text('The device is in the new layout')")
    wait_until(lambda: _study(visitor) == taken)
    assert names
    page.locator(".fit").get_by_role("button", name="Forget").click()
    page.wait_for_selector(".fit", state="detached")


def test_downloads_hold_what_is_shown(visitor: Visitor, tmp_path: Path) -> None:
    shown = visitor.values()
    table = visitor.download("Indices (CSV)", tmp_path)
    with table.open() as stream:
        rows = list(csv.DictReader(stream))
    assert {row["index"]: float(row["value"]) for row in rows if row["layout"] == "S3"} == shown
    assert visitor.download("Network (SVG)", tmp_path).read_text().lstrip().startswith("<?xml")
    assert visitor.download("Network (PNG)", tmp_path).read_bytes().startswith(b"\x89PNG")


def test_a_design_is_exported(visitor: Visitor, tmp_path: Path) -> None:
    """Every kind of file that the library has; what has friction only on purpose, else a message says why."""
    page = visitor.page
    page.fill("#network-text", "k | c - b")
    visitor.settled()
    study = it.load_study(visitor.download("This design, values fixed", tmp_path))
    (layout,) = study.layouts
    kinds = [kind for kind in it.EXPORTS.values() if kind.is_file]
    page.get_by_text("Export", exact=True).click()
    offered = page.locator("#export-menu li > span").all_text_contents()
    assert offered == [f"{kind.description}{f' requires {kind.requires}' if kind.requires else ''}" for kind in kinds]
    page.keyboard.press("Escape")
    path = visitor.download("(.m)", tmp_path, menu="Export")
    assert path.name.endswith(f"-{layout.lower()}.m")
    own = it.export(study.design(layout), "matlab", tmp_path / "own.m", title=f"{study.title}, {layout}")
    assert path.read_text() == own.read_text()

    page.get_by_role("button", name="in parallel").click()
    page.get_by_role("button", name="Add a friction").click()
    visitor.wait_for_text("k | c - b | f")
    page.get_by_text("Export", exact=True).click()
    page.get_by_role("button", name="(.m)").click()
    page.wait_for_selector(".notice >> text=A linear model has neither friction nor gaps")
    page.get_by_text("Export", exact=True).click()
    page.locator("#export-menu [type=checkbox]").check()
    assert page.locator("#export-menu li").count() == sum("linear" in kind.takes for kind in kinds) < len(kinds)
    with page.expect_download():
        page.get_by_role("button", name="(.m)").click()
    page.wait_for_selector(".notice", state="detached")


def test_that_conditions_are_not_exported_is_said(visitor: Visitor) -> None:
    """As the command line says it; and of no study without them."""
    page = visitor.page
    menu = page.locator("#export-menu")
    page.get_by_text("Export", exact=True).click()
    menu.locator("li").first.wait_for()
    assert "conditions" not in menu.inner_text()
    page.keyboard.press("Escape")
    visitor.open(EXAMPLES / "conditions.toml")
    page.wait_for_selector("text=conditions.toml is open")
    page.get_by_text("Export", exact=True).click()
    assert WITHOUT_CONDITIONS in menu.inner_text().replace("The vehicle", "the vehicle")


def test_each_response_is_a_picture(visitor: Visitor, tmp_path: Path) -> None:
    """Of every index of the study, whatever it is called: what the menu asks for, the server has."""
    study = tmp_path / "study.toml"
    study.write_text(_newcomer("J1", "tyre-load"))
    visitor.open(study)
    visitor.wait_for_text("k | c")
    visitor.settled()
    for index in ("J1", "tyre-load"):
        visitor.page.get_by_text("Save", exact=True).click()
        visitor.page.locator("#save-menu select").select_option(index)
        visitor.page.keyboard.press("Escape")
        picture = visitor.download("Response (SVG)", tmp_path)
        assert picture.name.endswith(f"response-{index}.svg")
        assert picture.read_text().lstrip().startswith("<?xml")
    assert visitor.download("Response (PNG)", tmp_path).read_bytes().startswith(b"\x89PNG")


def test_tolerances_are_those_of_python(visitor: Visitor) -> None:
    page = visitor.page
    asked: list[dict[str, Any]] = []
    page.on("request", lambda request: "tolerance" in request.url and asked.append(request.post_data_json))
    visitor.pick("S3e")
    page.click("#tab-tolerance")
    for name, part in {"k": "", "ks": "0", "c": "20"}.items():
        page.locator(f"[name='spread {name}']").fill(part)
    page.locator("#tab-panel").get_by_role("button", name="Compute").click()
    page.wait_for_selector("table[data-scatter]")
    (body,) = asked
    assert body["spread"] == {"c": 0.2, "cs": 0.1, "b": 0.1}
    study = study_from(body["study"])
    design = design_of(study, **{key: body["design"][key] for key in ("layout", "values")})
    found = it.tolerance_analysis(
        design.vehicle, study.index(body["index"]), it.Norm(), spread=body["spread"], samples=1024
    )
    values = page.eval_on_selector_all("[data-scatter] td", "all => all.map(td => Number(td.dataset.value))")
    assert values == [
        found.nominal.value,
        found.mean,
        found.standard_deviation,
        found.quantile(0.95),
        found.worst,
    ]
    shown = dict(
        page.eval_on_selector_all("[data-scatter] tr:has(td)", "all => all.map(tr => tr.innerText.split('\\t'))")
    )
    for name, error in {"mean": "mean", "standard deviation": "standard_deviation"}.items():  # as many digits as known
        number, scatter = shown[name].split(" ± ")
        assert len(number.partition(".")[2]) == len(scatter.partition(".")[2])
        assert float(scatter) == pytest.approx(found.standard_errors[error], rel=0.5)
    layouts = visitor.page.get_by_role("group", name="Layouts")
    layouts.get_by_role("button", name="S2", exact=True).click()
    page.wait_for_selector("table[data-scatter]", state="detached")  # it is that of another strut
    page.get_by_role("button", name="Undo").click()
    page.wait_for_selector("table[data-scatter]")


def test_a_number_beyond_elements_is_swept(visitor: Visitor) -> None:
    page = visitor.page
    page.click("#tab-work")
    form = page.locator("form.begin", has_text="Sweep")
    form.locator("select").select_option("road.speed")
    assert form.locator("[name=from]").input_value() == "12.5 m/s"
    form.locator("[name=points]").fill("2")
    form.get_by_role("button", name="Begin").click()
    page.wait_for_selector(".job[data-state=done] .plot .drawn", timeout=120_000)


def test_a_point_of_a_front_is_taken_into_the_editor(visitor: Visitor) -> None:
    """Its values become those of the layout, and the page then shows the indices of the point in all digits."""
    page = visitor.page
    page.click("#tab-work")
    form = page.locator("form.begin", has_text="Trade-off front")
    form.locator("[name=points]").fill("3")
    form.get_by_role("button", name="Begin").click()
    job = page.locator(".job[data-state=done]", has_text="Trade-off front")
    job.locator("circle.point").first.wait_for(timeout=120_000)
    (front,) = [job for job in json.loads(visitor.served.get("work"))["work"] if job["kind"] == "front"]
    fronts = json.loads(visitor.served.get(f"work/{front['id']}/result"))["fronts"]
    points = [(found["layout"], point) for found in fronts for point in found["points"]]
    assert job.locator("circle.point").count() == len(points) == 3 * len(fronts)
    layout, point = points[-2]
    job.locator("circle.point").nth(len(points) - 2).press("Enter")
    page.wait_for_selector(f"[aria-label=Layouts] .pick[title='{layout}'][aria-pressed=true]")
    wait_until(lambda: {index: visitor.values()[index] for index in point["values"]} == point["values"])


def test_limits_stand_in_the_answers(visitor: Visitor) -> None:
    visitor.open(EXAMPLES / "limits.toml")
    visitor.wait_for_text("k | c - b")
    visitor.page.wait_for_function("() => document.querySelectorAll('.limits .good').length === 2")
    told = visitor.page.locator(".limits li").first.inner_text()
    assert told == "kept: r.m.s. suspension travel at most 8 mm; it is 8 mm"
    visitor.page.fill("[id='entry elements.k']", "20 kN/m")
    visitor.page.keyboard.press("Enter")
    visitor.page.wait_for_selector(".limits .bad")
    assert visitor.page.locator(".limits .bad").last.inner_text().startswith("broken: static stiffness")


def test_what_the_keyboard_enters_is_typed_over(visitor: Visitor) -> None:
    """A value of more digits than are shown: whoever comes by Tab has all of it chosen, with all its digits."""
    page = visitor.page
    visitor.settled()
    entry = page.locator("[id='entry elements.c']")
    assert len(entry.get_attribute("title")) > len(entry.input_value())
    page.locator("[data-place='elements.c'] input[type=range]").focus()
    page.keyboard.press("Tab")
    assert entry.input_value() == entry.get_attribute("title")
    page.keyboard.type("3 kN s/m")
    page.keyboard.press("Enter")
    wait_until(lambda: entry.get_attribute("title") == "3 kN s/m")


def test_points_of_a_front_have_the_digits_that_their_errors_allow(
    visitor: Visitor, visitors: Any, tmp_path: Path
) -> None:
    """Statistical linearisation is right to a few per cent: no four digits."""
    page = visitor.page
    study = tmp_path / "rough.toml"
    study.write_text(
        study_text(
            'indices = ["J1", "J3"]\noptimise = "statistical-linearisation"',
            vehicle=PAPER_CAR,
            elements='k = "120 kN/m"\nc = { from = "100 N s/m", to = "100 kN s/m" }\nf = "100 N"',
            layouts='S1 = "k | (c | f)"',
            title='title = "Rough"',
        )
    )
    visitor.open(study)
    page.wait_for_selector("text=rough.toml is open")
    page.click("#tab-work")
    before = {job["id"] for job in json.loads(visitor.served.get("work"))["work"]}
    form = page.locator("form.begin", has_text="Trade-off front")
    form.locator("[name=points]").fill("3")
    form.get_by_role("button", name="Begin").click()
    labels = page.locator(".job[data-state=done]").locator("circle.point")
    labels.first.wait_for(timeout=120_000)
    (job,) = [job for job in json.loads(visitor.served.get("work"))["work"] if job["id"] not in before]
    (front,) = json.loads(visitor.served.get(f"work/{job['id']}/result"))["fronts"]
    assert labels.count() == len(front["points"])
    study_read = load_study(study)
    for label, point in zip(labels.all(), front["points"], strict=True):
        design = design_of(study_read, "S1", point["texts"])
        bound = it.evaluate(design.vehicle, study_read.index("J1"), it.StatisticalLinearisation()).error_bound
        assert bound > 1e-3
        told = format_quantity(point["values"]["J1"], "m/s^2", bound=bound).split(" ", maxsplit=1)[0]
        (shown,) = re.findall(r"J1 ([\d.]+) m/s²", str(label.get_attribute("aria-label")))
        assert float(shown) == float(told)
        assert len(shown.replace(".", "")) <= max(2, len(told.replace(".", "")))  # zeros at the end too
