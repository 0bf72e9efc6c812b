"""Many designs and many steps: every number on the page is the library's, and nothing is left behind in the browser."""

from __future__ import annotations

import random
import re
from typing import Any

import pytest
from browser import Visitor
from campaigns import sampled
from folders import EXAMPLES

import inerter as it

POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")
CELLS = """() => [...document.querySelectorAll(".answers tbody tr")].map(row => [
  row.querySelector(".pick").title,
  [...row.querySelectorAll("td[data-value]")].map(td => [+td.dataset.value, td.innerText,
    document.querySelectorAll(".answers thead th")[td.cellIndex].innerText]),
  +(row.querySelector("td[data-better]")?.dataset.better ?? NaN),
])"""
CURRENT = """k => document.querySelector(".answers[data-being=current]")
  && document.querySelector("[id='entry elements.k']").title === k"""


SIZES = {"m/s²": 0, "N": 0, "kN": 3, "mm/N": -3, "µm/N": -6}  # powers of ten of the units of heads


def _read(text: str, head: str) -> float:
    """The last number of a cell, as it is written, in SI."""
    mantissa, power = re.findall(r"(-?[0-9.]+)(?: × 10(-?[0-9]+))?", text.translate(POWERS).replace(" %", ""))[-1]
    unit = head.partition("[")[2].rstrip("]")
    return float(f"{mantissa}e{int(power or 0) + SIZES[unit]}")


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("count", sampled([10, 200], seldom=[200]))
def test_every_number_of_random_designs_is_that_of_the_library(visitor: Visitor, count: int) -> None:
    """In full to the last digit, and as it is written rounded to four or five digits."""
    page = visitor.page
    study = it.load_study(EXAMPLES / "quarter-car.toml")
    chance = random.Random(29)
    layouts = list(study.layouts)
    visitor.settled()
    values: dict[str, dict[str, float]] = {}
    for layout in layouts:
        page.locator(f"[aria-label=Layouts] .pick[title={layout}]").click()
        visitor.settled()
        free = study.design(layout).free_values()
        titles = {name: page.get_attribute(f"[id='entry elements.{name}']", "title") for name in free}
        values[layout] = {name: float(text.split()[0]) for name, text in titles.items()}
    for number in range(count):
        layout = layouts[number % len(layouts)]
        page.locator(f"[aria-label=Layouts] .pick[title={layout}]").click()
        k = f"{chance.uniform(60.0, 200.0):.4f} kN/m"
        texts = {"k": k}
        for name, free in study.design(layout).free_values().items():
            values[layout][name] = round(free.lower * (free.upper / free.lower) ** chance.random(), 4)
            texts[name] = f"{values[layout][name]!r} {study.elements[name].unit}"
        for name, text in reversed(texts.items()):
            page.fill(f"[id='entry elements.{name}']", text)
            page.keyboard.press("Enter")
            page.wait_for_function("([name, text]) => document.getElementById(`entry elements.${name}`).title === text",
                                   arg=[name, text])  # fmt: skip
        page.wait_for_function(CURRENT, arg=k)
        own = study.with_values({"k": float(k.split(maxsplit=1)[0]) * 1e3})
        expected = {
            name: [it.evaluate(own.design(name).with_values(values[name]), own.index(i), it.Norm()).value
                   for i in study.indices]
            for name in layouts
        }  # fmt: skip
        base = expected[str(study.baseline)][0]
        shown = page.evaluate(CELLS)
        assert sorted(row[0] for row in shown) == sorted(layouts)
        for name, cells, better in shown:
            assert [value for value, *_ in cells] == expected[name], (number, name)
            for value, text, head in cells:
                assert _read(text, head) in (float(f"{value:.4g}"), float(f"{value:.5g}")), (number, name, text)
            if name != study.baseline:
                gain = 100.0 * (1.0 - expected[name][0] / base)
                assert better == pytest.approx(gain, rel=1e-9, abs=1e-9), (number, name, shown, expected)


STEPS = """async (count) => {
  const slider = document.getElementById("slider elements.c");
  for (let step = 0; step < count; step += 1) {
    slider.value = String(50 + (7 * step) % 300);
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    await new Promise((done) => setTimeout(done, 5));
    if (step % 50 === 49) slider.dispatchEvent(new Event("change", { bubbles: true }));
  }
}"""


def _left(visitor: Visitor, session: Any) -> tuple[float, float]:
    """Heap [byte] and nodes after what is not needed was taken away."""
    visitor.settled()
    visitor.drawn()
    nodes, found = -1.0, {"Nodes": 0.0}
    while found["Nodes"] != nodes:  # on a busy machine the last answers are drawn late
        nodes = found["Nodes"]
        visitor.page.wait_for_timeout(300)
        session.send("HeapProfiler.collectGarbage")
        found = {one["name"]: one["value"] for one in session.send("Performance.getMetrics")["metrics"]}
    return found["JSHeapUsedSize"], found["Nodes"]


@pytest.mark.parametrize("steps", [100, pytest.param(1000, marks=pytest.mark.marathon)])
def test_heap_and_nodes_are_constant_over_steps_of_a_slider(visitor: Visitor, steps: int) -> None:
    """Once the answers that are kept, and the steps to undo, are as many as they become."""
    page = visitor.page
    visitor.settled()
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")
    for count in range(1, 9):  # motions are asked for where the slider rests, and are the largest answers
        page.evaluate(STEPS, count)
        page.wait_for_timeout(400)
        page.wait_for_selector(".vehicle[data-being=current]")
    page.evaluate(STEPS, steps)
    heap, nodes = _left(visitor, session)
    page.evaluate(STEPS, steps)
    later, more = _left(visitor, session)
    print(f"heap {heap / 1e6:.2f} to {later / 1e6:.2f} MB, nodes {nodes:.0f} to {more:.0f}")
    assert later - heap < 0.5e6
    assert more - nodes < 50
