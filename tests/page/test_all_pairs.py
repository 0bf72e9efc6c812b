"""Every example after every other one: nothing on the page is of the study that was open before."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from browser import Visitor
from folders import EXAMPLES

# what the page shows of a study, and the numbers, the verdict and the shapes of the curves among it
SHOWN = """() => {
  const each = (selector, of) => [...document.querySelectorAll(selector)].map(of);
  return {
    texts: each("nav.decision, .answers, .network, .values, #tab-panel", (part) => part.innerText),
    fields: each(".values input, .network textarea", ({ id, value }) => `${id} ${value}`),
    ...window.parts(),
  };
}"""
# from now on in every frame in which the study has this title, until it is asked what was seen
WATCH = """title => {
  window.parts = () => {
    const all = (selector, of) => [...document.querySelectorAll(selector)].flatMap(of);
    return {
      numbers: all("td[data-value]", ({ dataset }) => dataset.value),
      verdict: all("#verdict:not(.wait) b", ({ textContent }) => textContent),
      curves: all("#tab-panel path.curve", (path) => {
        const heights = path.getAttribute("d").split(/[ML]/).slice(1).map((point) => Number(point.split(" ")[1]));
        const [low, high] = [Math.min(...heights), Math.max(...heights)];
        const twelve = Array.from({ length: 12 }, (_, i) => heights[Math.floor(i / 11 * (heights.length - 1))]);
        return [[high - low, ...twelve.map((height) => (high - height) / (high - low || 1))].join(" ")];
      }),
    };
  };
  const seen = window.seen = { numbers: new Set(), verdict: new Set(), curves: new Set() };
  const look = () => {
    if (window.seen !== seen) return;
    if (document.querySelector("input.title").value === title)
      for (const [kind, found] of Object.entries(window.parts()))
        for (const one of found) seen[kind].add(one);
    requestAnimationFrame(look);
  };
  look();
}"""
SEEN = """() => {
  const seen = Object.fromEntries(Object.entries(window.seen).map(([kind, found]) => [kind, [...found]]));
  window.seen = null;
  return seen;
}"""


def pairs(count: int) -> list[int]:
    """The shortest walk over so many places that goes from each to each other one, and ends where it began."""
    return [place for low in range(count) for high in range(low + 1, count) for place in (low, high)] + [0]


def test_the_walk_goes_once_from_each_place_to_each_other_one() -> None:
    for count in (2, 3, 8):
        walk = pairs(count)
        assert sorted(pairwise(walk)) == [(a, b) for a in range(count) for b in range(count) if a != b]


def vehicles() -> list[Path]:
    """Examples with a vehicle, each of which takes the place of the study before; a device of a rig joins it."""
    every = {path: tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(EXAMPLES.glob("*.toml"))}
    return [path for path, tables in every.items() if tables.get("vehicle", {"model": "rig"}).get("model") != "rig"]


def _opened(visitor: Visitor, path: Path, title: str) -> tuple[Any, Any]:
    """What the page shows of an example at rest, and what it showed of it until then."""
    page = visitor.page
    page.evaluate(WATCH, title)
    visitor.open(path)
    page.locator(".notice", has_text=f"{path.name} is open").wait_for()
    page.wait_for_function("() => !document.querySelector('[aria-busy=true]')", timeout=240_000)
    visitor.drawn()
    return page.evaluate(SHOWN), page.evaluate(SEEN)


def _walk(visitor: Visitor, examples: Sequence[Path]) -> None:
    titles = [tomllib.loads(path.read_text(encoding="utf-8")).get("title", "") for path in examples]
    alone: dict[int, Any] = {}
    walk = pairs(len(examples))
    for before, here in zip([None, *walk], walk, strict=False):
        shown, seen = _opened(visitor, examples[here], titles[here])
        step = f"{examples[here].name} after {'the quarter car' if before is None else examples[before].name}"
        expected = alone.setdefault(here, shown)
        assert {**shown, "curves": None} == {**expected, "curves": None}, step
        seen["curves"] += shown["curves"]  # in whatever room messages leave
        for kind in ("numbers", "verdict"):
            assert set(seen[kind]) <= set(expected[kind]), (step, kind)
        others = [one for one in seen["curves"] if not any(_are_alike(one, other) for other in expected["curves"])]
        assert others == [], step


def _are_alike(one: str, other: str) -> bool:
    """Whether two curves have the same shape, whatever room they have: their points are drawn to a tenth of a pixel."""
    (tall, *points), (other_tall, *others) = ([float(number) for number in curve.split()] for curve in (one, other))
    return points == pytest.approx(others, abs=0.01 + 0.2 / max(min(tall, other_tall), 0.2))


@pytest.mark.timeout(3600)
@pytest.mark.marathon
def test_no_example_shows_what_belongs_to_the_one_before(visitor: Visitor) -> None:
    """All pairs: at rest each looks as it did the first time, and no number, verdict or curve came before that."""
    examples = vehicles()
    assert len(examples) > 15
    visitor.page.set_viewport_size(
        {"width": 1280, "height": 1300}
    )  # a drawing has its values whatever room messages take
    _walk(visitor, examples)
