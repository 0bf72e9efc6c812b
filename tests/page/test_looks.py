"""How the page looks and reads: no serious fault of accessibility, nothing wider than the screen, and pictures of it.

With a folder in the environment variable INERTER_PICTURES, pictures are taken: those that docs/ shows are written
there by `INERTER_PICTURES=docs .venv/bin/pytest -m campaign tests/page/test_looks.py`, all to the folders of the tests.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import Visitor
from campaigns import sampled
from folders import EXAMPLES
from study_text import PAPER_CAR, study_text

AXE = pytest.importorskip("axe_playwright_python.sync_playwright")
SIZES = {"wide": (1280, 800), "narrow": (420, 800), "projector": (1920, 1080)}
THEMES = {"light": SIZES, "dark": {"wide": SIZES["wide"]}}  # whose layout is the same
TABS = ("response", "history", "compare", "margins", "tolerance", "work", "rig")
DOCUMENTED = {("quarter-car", "wide", "light", "response"), ("ball_screw", "wide", "dark", "history")}
INDICES = 'indices = ["J1", "J3", "J5"]'


def _forty_elements() -> str:
    branches = [(f"k{i}", f"c{i}", f"b{i}", f"d{i}") for i in range(10)]
    values = {"k": "12 kN/m", "c": "300 N s/m", "b": "30 kg", "d": "200 N s/m"}
    elements = "\n".join(f'{name} = "{values[name[0]]}"' for branch in branches for name in branch)
    network = " | ".join(f"{k} | {c} - ({b} | {d})" for k, c, b, d in branches)
    layouts = f'S1 = "k0 | c0"\nS2 = "{network}"'
    return study_text(INDICES, vehicle=PAPER_CAR, elements=elements, layouts=layouts, title='title = "Forty elements"')


def _long_names() -> str:
    """The longest names that a study may have."""
    long = "the_damper_that_the_supplier_calls_by_its_whole_catalogue_number_0123456789"
    title = ("A title of many words, as a committee on suspension would have it, " * 4)[:200]
    layout, other = (f"{start}-layout-with-everything-anybody-ever-wished-for"[:40] for start in ("the", "another"))
    return study_text(
        f'{INDICES}\noptimise = "norm"',
        vehicle=PAPER_CAR,
        elements=f'k = "120 kN/m"\n{long} = {{ from = "100 N s/m", to = "100 kN s/m" }}\nb = "300 kg"',
        layouts=f'{layout} = "k | {long}"\n{other} = "k | {long} - b"',
        title=f'title = "{title}"',
    )


STUDIES: dict[str, Callable[[], str] | None] = {
    "quarter-car": (EXAMPLES / "quarter-car.toml").read_text,
    "half-car": (EXAMPLES / "half-car.toml").read_text,
    "ball_screw": lambda: (EXAMPLES / "ball_screw.toml").read_text().replace('f = "10 N"', 'f = "300 N"'),
    "forty-elements": _forty_elements,
    "long-names": _long_names,
    "faulty": lambda: _long_names().replace("120 kN/m", "120").replace("layouts]\n", 'layouts]\n"no name" = "k - "\n'),
    "empty": None,
}


def _faults(visitor: Visitor, within: tuple[str, ...] = ()) -> list[str]:
    """Faults that axe finds in the page or in parts of it, each with the first element that has it."""
    page = visitor.page
    if not page.evaluate("() => 'axe' in window"):
        page.evaluate(AXE.Axe().axe_script)
    run = (
        "parts => axe.run(parts.length ? parts : document, { resultTypes: ['violations'] }).then(all => all.violations)"
    )
    found = page.evaluate(run, list(within))
    return [f"{each['id']}: {each['nodes'][0]['html'][:200]}" for each in found]


def _too_wide(visitor: Visitor) -> int:
    """By how much the page is wider than its window."""
    return int(
        visitor.page.evaluate("() => document.documentElement.scrollWidth - document.documentElement.clientWidth")
    )


def _picture(visitor: Visitor, folder: Path, what: tuple[str, ...]) -> None:
    if wanted := os.environ.get("INERTER_PICTURES"):
        visitor.page.screenshot(path=folder / f"{'-'.join(what)}.png", full_page=True)
        if what in DOCUMENTED:
            visitor.page.screenshot(path=Path(wanted) / f"workbench-{what[-1]}.png", full_page=True)


def _looked_at(
    visitor: Visitor, sizes: dict[str, tuple[int, int]], tabs: tuple[str, ...]
) -> Iterator[tuple[str, str, tuple[list[str], int]]]:
    """Each size and tab with what is wrong; of the tabs after the first, in what turning to them changes."""
    for size, (width, height) in sizes.items():
        visitor.page.set_viewport_size({"width": width, "height": height})
        for tab in tabs:
            if tab != "none":
                visitor.page.click(f"#tab-{tab}")
                visitor.drawn()
            within = () if tab == tabs[0] else ("[role=tablist]", "#tab-panel")
            yield size, tab, (_faults(visitor, within), _too_wide(visitor))


@pytest.mark.parametrize("name", sampled(STUDIES, often=["quarter-car"], kept=0))
def test_looks(name: str, visitors: Any, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    make = STUDIES[name]
    here = request.getfixturevalue("served" if make else "nothing")
    faults: dict[tuple[str, ...], Any] = {}
    for theme, sizes in THEMES.items():
        visitor = visitors(here, color_scheme=theme).visit()
        page = visitor.page
        if make:
            study = tmp_path / f"{name}.toml"
            study.write_text(make())
            visitor.open(study)
            page.wait_for_selector(".notice")
            page.get_by_role("button", name="Close the message").click()
            visitor.settled()
        for size, tab, found in _looked_at(visitor, sizes, TABS if make else ("none",)):
            what = (name, size, theme, tab)
            _picture(visitor, tmp_path, what)
            if found != ([], 0):
                faults[what] = found
        page.context.close()
    assert faults == {}


CUT = """() => [...document.querySelectorAll(".amount > .entry")]
  .filter(each => each.clientWidth > 0 && each.scrollWidth > each.clientWidth).map(each => each.value)"""
OUTSIDE = """() => {
  const { left, right } = document.querySelector(".drawing rect.chosen").getBoundingClientRect();
  return [...document.querySelectorAll(".drawing text.value")].filter(each => each.getBoundingClientRect().width > 0)
    .filter(each => each.getBoundingClientRect().right > right || each.getBoundingClientRect().left < left)
    .map(each => each.textContent);
}"""


@pytest.mark.parametrize("size", SIZES)
def test_values_are_whole_and_inside_their_frames(size: str, visitor: Visitor) -> None:
    """Of a half car, whose damping has five digits and a long unit: in its row, and in the drawing of the strut."""
    page = visitor.page
    width, height = SIZES[size]
    page.set_viewport_size({"width": width, "height": height})
    visitor.open(EXAMPLES / "half-car.toml")
    page.wait_for_selector("text=half-car.toml is open")
    visitor.chosen()
    page.wait_for_function("() => document.querySelector('.drawing text.value')")
    assert page.locator(".amount .entry").evaluate_all("all => all.some(each => /^\\d\\.\\d{4} kN s/.test(each.value))")
    assert page.evaluate(CUT) == []
    assert page.evaluate(OUTSIDE) == []


def test_the_page_does_not_scroll_however_much_there_is_to_tell(visitor: Visitor, tmp_path: Path) -> None:
    """Messages above, reasons below a long ranking, of which the selected layout, the last one, is seen."""
    page = visitor.page
    study = tmp_path / "many.toml"
    elements = 'k = "120 kN/m"\nc = "4 kN s/m"\nb = "300 kg"\nf = "300 N"\nks = "1 MN/m"'
    layouts = [f'S{i} = "k | c - b"' for i in range(1, 8)] + ['S8 = "k | c | ks - (b | f)"']
    study.write_text(study_text(INDICES, vehicle=PAPER_CAR, elements=elements, layouts="\n".join(layouts)))
    visitor.open(study)
    page.wait_for_selector("text=many.toml is open")
    for i in range(2):
        broken = tmp_path / f"broken{i}.toml"
        broken.write_text("[[[")
        visitor.open(broken)
        page.get_by_text(f"broken{i}.toml").first.wait_for()
    page.select_option(".answers select >> nth=0", "expected-value")
    visitor.pick("S8")
    page.wait_for_selector("[aria-label=Reasons] li")
    page.locator(".answers > .scroll").first.evaluate("each => { each.scrollTop = 0; }")
    visitor.pick("S1")
    visitor.pick("S8")
    assert page.evaluate("() => document.documentElement.scrollHeight - innerHeight") == 0
    boxes = [
        page.locator(each).first.bounding_box() for each in ("tr.on", ".answers > .scroll", "#network-text", "footer")
    ]
    tops, ends = [box["y"] for box in boxes], [box["y"] + box["height"] for box in boxes]
    assert tops[1] <= tops[0]
    assert ends[0] <= ends[1] + 1
    assert ends[2] <= tops[3]


def test_the_tab_that_is_shown_is_seen_in_its_row(visitor: Visitor) -> None:
    """On a narrow screen the row of tabs is longer than the screen."""
    page = visitor.page
    page.set_viewport_size({"width": 420, "height": 800})
    for tab in reversed(TABS):
        page.evaluate("tab => document.getElementById(`tab-${tab}`).click()", tab)
        visitor.drawn()
        row, box = (page.locator(each).bounding_box() for each in ("[role=tablist]", f"#tab-{tab}"))
        assert row["x"] - 1 <= box["x"], tab
        assert box["x"] + box["width"] <= row["x"] + row["width"] + 1, tab
