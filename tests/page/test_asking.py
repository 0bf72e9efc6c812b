"""What a person may ask of the page: every number, other indices and limits, dropped files, the keyboard alone."""

from __future__ import annotations

import csv
import dataclasses
import json
import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import Visitor, drop, wait_until
from campaigns import sampled
from folders import EXAMPLES, example_tables
from study_text import PAPER_CAR, study_text

import inerter as it
from inerter.app.about import examples
from inerter.app.designs import design_of
from inerter.app.documents import study_from
from inerter.files.common.free_networks import is_free_network
from inerter.files.simulation.loading import load_simulation
from inerter.files.simulation.running import run_simulation
from inerter.indices.registry import index_choices

FIXED = {"k": '"120 kN/m"', "c": '"3 kN s/m"', "b": '"100 kg"'}
ONE_INDEX = 'indices = ["J1"]'


def _two_struts(settings: str = ONE_INDEX, title: str = "All fixed", inerter: str = "k | c - b", **values: str) -> str:
    """The text of a study; nothing is free in it unless `values`, which are TOML, say so."""
    return study_text(
        settings,
        vehicle=PAPER_CAR,
        elements="\n".join(f"{name} = {value}" for name, value in {**FIXED, **values}.items()),
        layouts=f'S1 = "k | c"\nS3 = "{inerter}"',
        title=f'title = "{title}"',
    )


def _open(visitor: Visitor, text: str, folder: Path) -> None:
    study = folder / "study.toml"
    study.write_text(text)
    visitor.open(study)
    visitor.page.wait_for_selector(".notice")
    visitor.page.get_by_role("button", name="Close the message").click()
    visitor.settled()


def _numbers(table: Any, *place: str) -> Iterator[str]:
    """The places of all numbers in a table, with units or without."""
    if isinstance(table, dict):
        for key, inside in table.items():
            yield from _numbers(inside, *place, key)
    elif isinstance(table, int | float) or (isinstance(table, str) and table[:1] in "+-.0123456789"):
        yield ".".join(place)


def _quantities(settings: Any) -> dict[str, Any]:
    """What has a unit in the section [study], and limits; not what is swept, nor how much scatters."""
    others = {"sweep", "tolerance"}
    return {
        key: entry
        for key, entry in settings.items()
        if key not in others and (isinstance(entry, dict) or (isinstance(entry, str) and entry[0].isdigit()))
    }


_STEP = """each => {
  each.value = String(Number(each.value) + 1);
  each.dispatchEvent(new Event("input", { bubbles: true }));
}"""


@pytest.mark.parametrize("name", sampled(examples(), often=["full-car"], kept=1))
def test_every_number_of_an_example_can_be_changed(name: str, visitor: Visitor) -> None:
    """Each has a slider, an entry and bounds; a step of the slider, up or down, keeps sign and unit."""
    page = visitor.page
    written = example_tables(name)
    visitor.open(EXAMPLES / f"{name}.toml")
    page.wait_for_selector(f"text={name}.toml is open")
    visitor.settled()
    for table in page.locator(".values details:not(.bounds)").all():
        table.evaluate("each => { each.open = true; }")
    numbers = (name for name, entry in written["elements"].items() if not is_free_network(entry))
    expected = [f"elements.{name}" for name in numbers]
    expected += [place for section in ("vehicle", "road") for place in _numbers(written.get(section, {}), section)]
    asked = {"indices": written.get("indices", {}), "study": _quantities(written["study"])}
    expected += [place for section, table in asked.items() for place in _numbers(table, section)]
    assert sorted(page.eval_on_selector_all("[data-place]", "all => all.map(each => each.dataset.place)")) == sorted(
        expected
    )
    for place in expected:
        slider, entry = page.locator(f"[id='slider {place}']"), page.locator(f"[id='entry {place}']")
        assert page.locator(f"[data-place='{place}'] details.bounds input").count() == 2, place
        before = str(entry.get_attribute("title"))
        if float(before.partition(" ")[0]) == 0.0:
            continue  # has no logarithm, and can be typed
        assert slider.is_enabled(), place
        slider.evaluate(_STEP)
        page.wait_for_function(
            "([id, text]) => document.getElementById(id).title !== text", arg=[f"entry {place}", before]
        )
        number, _, unit = before.partition(" ")
        after, _, same = str(entry.get_attribute("title")).partition(" ")
        assert same == unit, (place, before, after)
        assert 1.0 < float(after) / float(number) < 1.05, (place, before, after)


def test_a_road_is_named_by_its_class_or_its_word_and_what_is_told_of_it_is_seen(visitor: Visitor) -> None:
    """It is the last number: what opens below it, and what is wrong with it, would be under the edge of its panel."""
    page = visitor.page
    place, entry = "[data-place='road.roughness']", "[id='entry road.roughness']"

    def is_seen(selector: str) -> bool:
        inside, box = (page.locator(each).bounding_box() for each in (".values > .inside", selector))
        return bool(inside["y"] <= box["y"] and box["y"] + box["height"] <= inside["y"] + inside["height"] + 1)

    page.set_viewport_size({"width": 1280, "height": 640})
    page.fill(entry, "Poor")
    page.keyboard.press("Enter")
    page.wait_for_function("each => document.querySelector(each).title === '1024e-6 m^3'", arg=entry)
    page.locator("h1").click()
    assert page.input_value(entry) == "class D"
    page.locator(f"{place} summary").click()
    page.wait_for_timeout(100)
    assert is_seen(f"{place} .menu-body")
    page.locator(f"{place} select").select_option(label="A, very good")
    page.wait_for_function("each => document.querySelector(each).title === '16e-6 m^3'", arg=entry)
    page.fill(entry, "bumpy")
    page.keyboard.press("Enter")
    page.locator(f"{place} .problem").wait_for()
    assert is_seen(f"{place} .problem")


def test_a_lever_of_a_mechanism_is_moved(visitor: Visitor, tmp_path: Path) -> None:
    """What has no unit, or is negative: the study that is downloaded has it, and the page has its numbers."""
    page = visitor.page
    visitor.open(EXAMPLES / "train.toml")
    visitor.wait_for_text("k | c - b")
    page.locator("details.table", has_text="struts").locator("summary").first.click()
    for place, text in {"upper.pitch": "-9 m", "lower.bogie_rear": "0.5"}.items():
        page.fill(f"[id='entry vehicle.struts.secondary_rear.{place}']", text)
        page.keyboard.press("Enter")
    body = "[id='entry vehicle.struts.secondary_rear.upper.body']"
    page.fill(body, "a lot")
    page.keyboard.press("Enter")
    page.wait_for_selector(".amount .problem:has-text('Got \"a lot\"')")
    page.fill(body, "1")
    page.keyboard.press("Enter")
    page.wait_for_selector(".amount .problem", state="detached")
    visitor.settled()
    shown = visitor.values()
    path = visitor.download("This design, values fixed", tmp_path)
    strut = tomllib.loads(path.read_text())["vehicle"]["struts"]["secondary_rear"]
    assert strut["upper"] == {"body": 1, "pitch": "-9 m"}
    assert strut["lower"] == {"bogie_rear": 0.5}
    study = it.load_study(path)
    (layout,) = study.layouts
    for index, value in shown.items():
        assert it.evaluate(study.design(layout), study.index(index), it.Norm()).value == value


def test_what_is_made_free_can_be_optimised(visitor: Visitor, tmp_path: Path) -> None:
    """Of a study in which nothing was free, and which names no method."""
    page = visitor.page
    _open(visitor, _two_struts(), tmp_path)
    before = visitor.values()
    page.locator("[data-place='elements.c'] input[type=checkbox]").check()
    visitor.settled()
    assert page.locator(".problem").count() == 0
    assert visitor.values() == before
    page.get_by_role("button", name="Find best").click()
    page.wait_for_function(
        "() => document.querySelector('.optimise [role=status]').textContent.startsWith('The values of')"
    )
    assert visitor.values()["J1"] < before["J1"]
    path = visitor.download("Study file", tmp_path)
    assert tomllib.loads(path.read_text())["study"]["optimise"] == "norm"


def test_the_best_is_found_of_all_layouts_and_of_one_only_on_request(visitor: Visitor) -> None:
    """A layout at its best is not compared with others at their former values, unless a person asks for that.

    Of all of them the best one is selected then.
    """
    page = visitor.page
    page.get_by_role("group", name="Layouts").get_by_role("button", name="S3", exact=True).click()
    page.fill("[id='entry elements.k']", "60 kN/m")
    page.keyboard.press("Enter")
    stale = page.locator(".verdict .stale")
    place = page.locator(".values .inside").bounding_box
    before = place()
    for button, names in (("Only S3", "S3"), ("Find best", "S1, S2, S3, S2e and S3e")):
        told = f"The values of {names} are the best found for J1."
        stale.wait_for()
        page.get_by_role("button", name=button).click()
        page.wait_for_function(
            "told => document.querySelector('.optimise [role=status]').textContent === told", arg=told
        )
        after = place()  # what is told below the values moves none of them
        assert (after["x"], after["y"]) == (before["x"], before["y"])
        if button == "Only S3":
            page.get_by_role("group", name="Layouts").get_by_role("button", name="S2", exact=True).click()
    stale.wait_for(state="detached")
    best = page.inner_text(".answers .on .pick").split()[0]
    assert page.inner_text("#verdict > b").startswith(f"{best} is ")
    assert best != "S2"


def test_indices_and_limits_are_chosen_in_the_page(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    text = _two_struts(f'{ONE_INDEX}\noptimise = "norm"', c='{ from = "100 N s/m", to = "100 kN s/m" }')
    _open(visitor, text, tmp_path)
    page.click("#step-2")
    page.get_by_role("group", name="Indices of the study").get_by_role("button", name="J3", exact=True).click()
    page.wait_for_selector("td[data-index=J3]")
    asked = page.locator(".asked")
    for of, sense, value, told in (
        ("suspension-travel", "at_most", "8 mm", ".limits li"),
        ("static-stiffness.strut", "at_least", "600 kN/m", ".limits .bad"),
    ):
        asked.locator("[name=of]").select_option(of)
        asked.locator("[name=sense]").select_option(sense)
        asked.locator("[name=value]").fill(value)
        asked.get_by_role("button", name="Add").click()
        page.wait_for_selector(told)  # which moves the button: what is pressed meanwhile misses it
    entry = page.get_by_label("static stiffness of strut at least", exact=True)
    entry.fill("60 kN/m")
    entry.press("Enter")
    page.wait_for_function("() => document.querySelectorAll('.limits li').length === 2")
    page.get_by_role("button", name="Find best").click()
    page.wait_for_function(
        "() => document.querySelector('.optimise [role=status]').textContent.startsWith('The values of')"
    )
    page.wait_for_function("() => document.querySelectorAll('.limits .good').length === 2")
    study = tomllib.loads(visitor.download("Study file", tmp_path).read_text())["study"]
    assert study["indices"] == ["J1", "J3"]
    assert study["subject_to"] == {
        "suspension-travel": {"at_most": "8 mm"},
        "static-stiffness": {"strut": {"at_least": "60 kN/m"}},
    }
    page.click("#step-2")
    for name in ("r.m.s. suspension travel at most", "static stiffness of strut at least"):
        page.get_by_role("button", name=f"Delete the limit: {name}").click()
    page.wait_for_selector(".limits", state="detached")
    assert "subject_to" not in tomllib.loads(visitor.download("Study file", tmp_path).read_text())["study"]


def test_what_is_no_quantity_of_a_limit_changes_nothing(visitor: Visitor, tmp_path: Path) -> None:
    """Its sentence is at the field; a number alone has the unit that the field names, and a ratio none."""
    page = visitor.page
    before = visitor.values()
    page.click("#step-2")
    asked = page.locator(".asked")
    assert asked.get_by_role("button", name="force of an element", exact=True).count() == 0  # it needs its element
    for of, text in (("suspension-travel", "5 kg"), ("suspension-travel", "7"), ("dynamic-load-coefficient", "0.3")):
        asked.locator("[name=of]").select_option(of)
        asked.locator("[name=value]").fill(text)
        asked.get_by_role("button", name="Add", exact=True).click()
        if text == "5 kg":
            asked.locator(".problem", has_text="5 kg").wait_for()
            assert visitor.values() == before
    entry = page.locator("[id='limit suspension-travel at_most']")
    page.wait_for_function("() => document.querySelectorAll('.limits .good').length === 2")
    entry.fill("3 N")
    entry.press("Enter")
    asked.locator(".problem", has_text="3 N").wait_for()
    assert visitor.values() == before
    study = tomllib.loads(visitor.download("Study file", tmp_path).read_text())["study"]
    assert study["subject_to"] == {
        "suspension-travel": {"at_most": "7 mm"},
        "dynamic-load-coefficient": {"at_most": 0.3},
    }


@pytest.mark.parametrize("example", ["quarter-car", "limits"])
def test_the_weighting_of_an_index_is_set_in_the_goal(visitor: Visitor, tmp_path: Path, example: str) -> None:
    """From the declarations of the library; where no section of the file defines the index, one does then."""
    page = visitor.page
    if example != "quarter-car":
        visitor.open(EXAMPLES / f"{example}.toml")
        page.wait_for_selector(f"text={example}.toml is open")
    page.click("#step-2")
    weighting = page.locator("select[name=weighting]")
    (declared,) = index_choices("J1")
    assert weighting.locator("option").all_inner_texts() == ["none", *declared.options]
    for chosen in ("Wd", ""):
        weighting.select_option(chosen)
        wait_until(lambda chosen=chosen: ("Wd" in page.inner_text("#step-2")) == bool(chosen))
        visitor.settled()
        tables = tomllib.loads(visitor.download("Study file", tmp_path).read_text())
        study, goal = study_from(tables), "comfort"
        assert study.indices[0] == goal
        assert tables["indices"][goal] == {"kind": "ride-comfort", **({"weighting": chosen} if chosen else {})}
        shown = visitor.values()[goal]
        layout = str(page.get_attribute(".answers .pick[aria-pressed=true]", "title"))
        values = json.loads(page.evaluate("() => sessionStorage.getItem('inerter.document')"))["values"]
        design = design_of(study, layout, values[layout])
        assert shown == it.evaluate(design.vehicle, study.index(goal), it.Norm()).value
        page.click("#step-2")


def test_a_limit_on_several_struts_names_none_of_them(visitor: Visitor) -> None:
    """Which strut is the nearest to it, each layout says of itself."""
    page = visitor.page
    visitor.open(EXAMPLES / "half-car.toml")
    page.wait_for_selector("text=half-car.toml is open")
    visitor.chosen()
    page.get_by_role("group", name="Struts").get_by_role("button", name="rear", exact=True).click()
    page.fill("#network-text", "k_r | c_r")
    visitor.settled()
    page.click("#step-2")
    asked = page.locator(".asked")
    asked.locator("[name=of]").select_option("suspension-travel")
    asked.locator("[name=value]").fill("5 mm")
    asked.get_by_role("button", name="Add").click()
    page.locator(".limits li", has_text="front strut, at most 5 mm").wait_for()
    asked.get_by_label("r.m.s. suspension travel, each strut, at most", exact=True).wait_for()


def test_all_is_wrong_at_its_place_in_a_long_text(visitor: Visitor) -> None:
    """However long the text of a network is, all of it is seen, and the mark is under what is wrong."""
    page = visitor.page
    page.fill("#network-text", " | ".join(["(k - c)"] * 40 + ["c - - k"] + ["k"] * 10))
    page.wait_for_selector(".marks u")
    seen = page.evaluate(
        """() => {
          const text = document.getElementById("network-text");
          const box = text.getBoundingClientRect();
          const mark = document.querySelector(".marks u").getBoundingClientRect();
          const beside = mark.left >= box.left && mark.right <= box.right;
          const within = beside && mark.top >= box.top && mark.bottom <= box.bottom;
          return { within, hidden: text.scrollHeight - text.clientHeight, lines: box.height / mark.height };
        }"""
    )
    assert seen["within"]
    assert seen["hidden"] <= 0
    assert seen["lines"] > 5


def test_tables_and_link_hold_what_is_looked_at(visitor: Visitor, visitors: Any, tmp_path: Path) -> None:
    page = visitor.page
    page.click("#tab-history")
    page.get_by_label("for [s]").fill("3")
    page.keyboard.press("Enter")
    page.select_option(".answers select >> nth=0", "statistical-linearisation")
    visitor.settled()
    shown = visitor.values()
    for name, column in {"Frequency response (CSV)": "frequency", "On the road (CSV)": "time"}.items():
        with visitor.download(name, tmp_path).open() as stream:
            rows = list(csv.reader(stream))
        assert any(column in head for head in rows[0]), name
        assert len(rows) > 100, name
    page.get_by_text("Share", exact=True).click()
    page.wait_for_function("() => document.querySelector('#shared-link')?.value.includes('#state=')")
    other = visitors(visitor.served, context=page.context).visit(page.input_value("#shared-link"))
    other.page.wait_for_selector("#tab-history[aria-selected=true]")
    assert other.page.get_by_label("for [s]").input_value() == "3"
    assert other.page.input_value(".answers select >> nth=0") == "statistical-linearisation"
    assert other.values() == shown


def test_study_folder_and_record_are_dropped(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    visitor.settled()  # nothing is dropped on a page that does not listen yet
    study = tmp_path / "dropped.toml"
    study.write_text(_two_struts())
    drop(visitor, study)
    page.wait_for_selector("text=dropped.toml is open")
    assert page.input_value("input.title") == "All fixed"

    folder = tmp_path / "results"
    (folder / "figures").mkdir(parents=True)
    for number in range(150):  # more than a browser tells at once
        (folder / f"a-{number}.svg").write_text("<svg/>")
    (folder / "study.resolved.toml").write_text(_two_struts(title="From a folder"))
    (folder / "summary.csv").write_text("layout,index\n")
    drop(visitor, folder)
    page.wait_for_selector("text=study.resolved.toml is open")
    assert page.input_value("input.title") == "From a folder"

    record = tmp_path / "noise.csv"
    rows = (f"{i / 1000},{i % 7},{(i * i) % 11}" for i in range(400))
    record.write_text("time [s],displacement [mm],force [N]\n" + "\n".join(rows) + "\n")
    answers: list[Any] = []
    page.on("response", lambda answer: answers.append(answer) if "/api/records" in answer.url else None)
    drop(visitor, record)
    page.wait_for_selector("text=noise.csv was read.")
    found = answers[0].json()
    told = page.locator(".records .finding").all_inner_texts()
    assert told == [each["sentence"] for each in found["findings"]]
    page.wait_for_selector(".records .plot .drawn")
    assert page.locator(".records select option").all_inner_texts() == [each["name"] for each in found["channels"]]
    page.get_by_role("button", name="Remove noise.csv").click()
    page.wait_for_selector(".records .plot", state="detached")


def test_files_are_accepted_by_what_comes_under_them(visitor: Visitor) -> None:
    """Where the page draws anew meanwhile, a file only ever enters what is below it, and is dropped without moving."""
    visitor.settled()
    accepted = visitor.page.evaluate("""() => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File(["x"], "a.toml"));
      return ["dragenter", "dragover"].map((kind) =>
        !document.body.dispatchEvent(new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true })));
    }""")
    assert accepted == [True, True]


def test_what_cannot_be_read_of_a_folder_is_said(visitor: Visitor, tmp_path: Path) -> None:
    """Of a result folder the study alone is read, whatever its other files are."""
    page = visitor.page
    visitor.settled()
    page.evaluate(
        """(text) => {
          const gone = (take, refuse) => refuse(new DOMException("It is gone.", "NotFoundError"));
          const file = (name, read) =>
            ({ isFile: true, name, file: (...given) => (window.gone ? gone : read)(...given) });
          const inside = [file("record.csv", gone),
            file("study.resolved.toml", (take) => take(new File([text], "study.resolved.toml")))];
          DataTransferItem.prototype.webkitGetAsEntry = () => {
            const parts = [inside, []];
            return { isFile: false, createReader: () => ({ readEntries: (take) => take(parts.shift()) }) };
          };
        }""",
        _two_struts(title="From a folder"),
    )
    drop(visitor, tmp_path)
    page.wait_for_selector("text=study.resolved.toml is open")
    page.evaluate("() => { window.gone = true; }")
    drop(visitor, tmp_path)
    page.wait_for_selector("text=What was dropped cannot be read: It is gone.")


def test_results_of_a_simulation_are_dropped(visitor: Visitor, tmp_path: Path) -> None:
    """A vehicle is opened as a study of it, a device of a rig joins the study that is open; nothing is overwritten."""
    page = visitor.page
    for name in ("half_car_friction", "backlash_rattle"):
        request = load_simulation(EXAMPLES / f"{name}.toml")
        run_simulation(dataclasses.replace(request, duration=0.2), tmp_path / name)
    drop(visitor, tmp_path / "half_car_friction")
    page.wait_for_selector("text=simulation.toml is open as a study of its vehicle")
    request = load_simulation(EXAMPLES / "half_car_friction.toml")
    wait_until(lambda: page.input_value("input.title") == request.title)
    found = visitor.values()
    comfort = it.RideComfort(it.Road(roughness=request.roughness, speed=request.speed))
    assert found == {"J1": it.evaluate(request.design(), comfort, it.Norm()).value}
    before = page.get_attribute("[id='entry elements.b']", "title")
    drop(visitor, tmp_path / "backlash_rattle")
    page.wait_for_selector("text=simulation.toml: The device is in the new layout")
    page.wait_for_function("() => document.querySelector('#network-text').value.includes('- g - (b2 | f2)')")
    visitor.settled()
    assert page.get_attribute("[id='entry elements.b2']", "title") == "113.0 kg"
    assert before in page.locator("[id='entry elements.b']").evaluate_all("all => all.map(each => each.title)")
    assert page.locator(".problem").count() == 0


def test_a_simulation_without_a_road_gets_one(visitor: Visitor) -> None:
    """What is missing is added by a button beside the message that says so."""
    page = visitor.page
    visitor.open(EXAMPLES / "stick_slip.toml")
    page.wait_for_selector(".problems:has-text('road')")
    page.get_by_role("button", name="Add a road").click()
    page.wait_for_selector(".problems", state="detached")
    visitor.settled()
    assert visitor.values()["J1"] > 0.0
    page.wait_for_selector("[id='entry road.speed']")


BEGIN = """() => {
  document.activeElement.blur();
  for (const each of document.querySelectorAll("[data-walked]")) delete each.dataset.walked;
}"""
WALK = """() => {
  const active = document.activeElement;
  const drawn = active.matches(".element, .point");
  const style = getComputedStyle(active.querySelector(".touch") ?? active);
  const [kind, width] = drawn ? [style.stroke, style.strokeWidth] : [style.outlineStyle, style.outlineWidth];
  const box = active.getBoundingClientRect();
  active.dataset.walked = "yes";
  return {
    what: active === document.body ? "" : active.outerHTML.slice(0, 90),
    seen: kind !== "none" && parseFloat(width) >= 2,
    inside: box.bottom > 0 && box.top < innerHeight,
  };
}"""
TABBABLE = """() => [
  ...document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex]"),
].filter(each => each.tabIndex >= 0 && !each.disabled && each.checkVisibility() && !each.dataset.walked)
  .map(each => each.outerHTML.slice(0, 90))"""


@pytest.mark.parametrize("backwards", sampled([False, True], seldom=[False]))
def test_the_keyboard_reaches_all_and_is_nowhere_trapped(backwards: bool, visitor: Visitor) -> None:
    page = visitor.page
    for tab in ("response", "history", "compare", "margins", "tolerance", "work", "rig"):
        page.click(f"#tab-{tab}")
        visitor.settled()
        visitor.drawn()
        page.evaluate(BEGIN)
        page.mouse.click(2, 400)
        steps = []
        for _ in range(200):
            page.keyboard.press("Shift+Tab" if backwards else "Tab")
            steps.append(page.evaluate(WALK))
            if not page.evaluate(TABBABLE):
                break
        assert page.evaluate(TABBABLE) == [], tab
        assert [step["what"] for step in steps if step["what"] and not (step["seen"] and step["inside"])] == [], tab


def test_escape_closes_a_menu_and_stays_at_it(visitor: Visitor) -> None:
    page = visitor.page
    for summary in (
        "header details.menu:nth-of-type(1) > summary",
        ".layouts details > summary",
        "[data-place='elements.k'] summary",
    ):
        page.locator(summary).focus()
        page.keyboard.press("Enter")
        page.keyboard.press("Tab")
        assert page.evaluate("() => document.activeElement.closest('.menu-body') !== null")
        page.keyboard.press("Escape")
        assert page.locator("details.menu[open], details.bounds[open]").count() == 0
        assert page.evaluate("() => document.activeElement.tagName") == "SUMMARY"
        page.keyboard.press("Tab")
        page.keyboard.press("Shift+Tab")


def test_a_drawing_of_many_elements_is_laid_across_the_page(visitors: Callable[..., Visitor], served: Any) -> None:
    """All of it is then seen at once, where the window is wide."""
    visitor = visitors(served).visit()
    page = visitor.page
    page.fill("#network-text", " | ".join(["k - (c | b)"] * 13))
    page.get_by_role("button", name="Lay out wide").click()
    wait_until(lambda: page.locator(".network.across").count() == 1)
    for _ in range(2):
        hidden = page.evaluate(
            "() => { const each = document.querySelector('.drawing'); return each.scrollWidth - each.clientWidth; }"
        )
        assert hidden <= 0
        page.set_viewport_size({"width": 1920, "height": 1080})
    assert json.loads(page.evaluate("() => sessionStorage.getItem('inerter.document')"))["study"]["title"]


def test_a_budget_is_that_of_python(visitor: Visitor, tmp_path: Path) -> None:
    """By the method that the page judges by: how much friction takes all of what an inerter brings."""
    page = visitor.page
    values = {"c": "4981 N s/m", "d": "7353 N s/m", "b": "328.72 kg", "f": "10 N"}
    text = _two_struts(inerter="k | d - (b | f)", **{name: f'"{value}"' for name, value in values.items()})
    _open(visitor, text, tmp_path)
    page.select_option(".answers select >> nth=0", "statistical-linearisation")
    page.click("#tab-margins")
    asked: list[Any] = []
    page.on("request", lambda request: asked.append(request.post_data_json) if "panel/budget" in request.url else None)
    page.locator(".budget").get_by_role("button", name="Compute").click()
    page.wait_for_function(
        "() => / is as good as S1/.test(document.querySelector('.budget [role=status]').textContent)"
    )
    (body,) = asked
    study = study_from(body["study"])
    found = it.break_even(
        design_of(study, "S3", {}).vehicle,
        design_of(study, "S1", {}).vehicle,
        study.index("J1"),
        parameter="f",
        method=it.StatisticalLinearisation(),
    )
    said = re.search(r"At f = ([\d.]+)\xa0N, S3", page.inner_text(".budget [role=status]"))
    assert said is not None
    assert float(said[1]) == pytest.approx(found.value, rel=max(found.error_bound, 5e-4))


def test_a_report_is_made_and_downloaded(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    _open(visitor, _two_struts(), tmp_path)
    page.get_by_text("Save", exact=True).click()
    page.get_by_role("button", name="Report: run the study").click()
    job = page.locator(".job").first
    page.wait_for_selector(".job[data-state=done]", timeout=120_000)
    job.get_by_role("button", name="Files…").click()
    with page.expect_download() as found:
        job.get_by_role("button", name="report.html").click()
    found.value.save_as(tmp_path / "report.html")
    assert "All fixed" in (tmp_path / "report.html").read_text()
