"""The vehicle in motion on the page: it moves, is held, has one clock with the plot, and says why it stands still."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from browser import Served, Visitor, wait_until
from folders import EXAMPLES

_INK = """() => {
  const canvas = document.querySelector(".vehicle canvas");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let sum = 0;
  for (let i = 0; i < data.length; i += 4) sum = (sum * 31 + data[i] + 3 * data[i + 1] + 7 * data[i + 3]) % 1e9;
  return sum;
}"""
_COUNT = """([red, green, blue]) => {
  const canvas = document.querySelector(".vehicle canvas");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let found = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (data[i] === red && data[i + 1] === green && data[i + 2] === blue && data[i + 3] === 255) found += 1;
  }
  return found;
}"""
_RESIZED = """() => {
  const canvas = document.querySelector(".vehicle canvas");
  window.seen = [];
  const colour = () => [...canvas.getContext("2d").getImageData(5, 5, 1, 1).data];
  new ResizeObserver(() => window.seen.push(colour())).observe(canvas);
}"""
STICK = [0xC7, 0x77, 0x00]  # as the page's colours say


@pytest.fixture
def visitor(served: Served, visitors: Callable[..., Visitor]) -> Visitor:
    """A window in which vehicles move."""
    return visitors(served, reduced_motion="no-preference").visit()


def _moving(visitor: Visitor) -> None:
    """Wait until the motion is drawn."""
    visitor.settled()
    visitor.page.wait_for_selector(".vehicle[data-being=current] canvas[data-frames]")


def _time(visitor: Visitor) -> float:
    """The time that is drawn while it is held."""
    visitor.page.wait_for_timeout(100)
    return float(visitor.page.get_attribute(".vehicle canvas", "aria-valuenow"))


def _drag(visitor: Visitor, seconds: float) -> None:
    """Drag the picture, which is held, by so much."""
    page = visitor.page
    box = page.locator(".vehicle canvas").bounding_box()
    x, y = box["x"] + 20, box["y"] + box["height"] - 30
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 200 * seconds, y, steps=3)
    page.mouse.up()


def _hold(visitor: Visitor) -> None:
    visitor.page.get_by_role("button", name="Hold").click()


def test_a_picture_of_another_size_is_drawn_before_it_is_seen(visitor: Visitor) -> None:
    page = visitor.page
    _moving(visitor)
    page.evaluate(_RESIZED)
    page.wait_for_function("() => window.seen.length === 1")
    page.set_viewport_size({"width": 1320, "height": 800})
    page.wait_for_function("() => window.seen.length > 1")
    assert {tuple(colour) for colour in page.evaluate("window.seen")} == {(255, 255, 255, 255)}  # as the surface is


def test_the_vehicle_moves_until_it_is_held(visitor: Visitor) -> None:
    page = visitor.page
    _moving(visitor)
    before = page.evaluate(_INK)
    wait_until(lambda: page.evaluate(_INK) != before)
    _hold(visitor)
    held = _time(visitor)
    still = page.evaluate(_INK)
    page.wait_for_timeout(200)
    assert (_time(visitor), page.evaluate(_INK)) == (held, still)
    page.keyboard.press("Escape")
    page.evaluate("() => document.activeElement.blur()")
    page.keyboard.press(" ")
    wait_until(lambda: page.evaluate(_INK) != still)


def test_the_picture_and_the_plot_have_one_time(visitor: Visitor) -> None:
    page = visitor.page
    _moving(visitor)
    _hold(visitor)
    page.click("#tab-history")
    visitor.drawn()
    before = _time(visitor)
    _drag(visitor, 0.5)
    after = _time(visitor)
    assert after - before == pytest.approx(0.5, abs=0.02)
    page.focus(".vehicle canvas")
    page.keyboard.press("ArrowRight")
    assert _time(visitor) - after == pytest.approx(1.0 / 60.0, abs=2e-3)
    page.keyboard.press("Shift+ArrowLeft")
    assert _time(visitor) - after == pytest.approx(-9.0 / 60.0, abs=2e-3)


def test_a_slider_asks_for_a_motion_when_it_rests(visitor: Visitor) -> None:
    """Thirty steps are no thirty simulations, and the last one is the one that is drawn."""
    page = visitor.page
    _moving(visitor)
    asked: list[dict[str, Any]] = []
    page.on("request", lambda request: asked.append(request.post_data_json) if "panel/history" in request.url else None)
    with page.expect_request("**/api/panel/history"):
        page.evaluate(
            """async () => {
              const slider = document.getElementById("slider elements.k");
              for (let i = 0; i < 30; i += 1) {
                slider.value = String(200 + i);
                slider.dispatchEvent(new Event("input", { bubbles: true }));
                await new Promise((done) => setTimeout(done, 20));
              }
            }"""
        )
    _moving(visitor)
    page.wait_for_timeout(600)
    _moving(visitor)
    assert len(asked) <= 5
    assert asked[-1]["study"]["elements"]["k"] == page.input_value("[id='entry elements.k']")


def test_friction_that_sticks_is_amber(visitors: Any, served: Served, tmp_path: Path) -> None:
    study = tmp_path / "sticks.toml"
    study.write_text((EXAMPLES / "ball_screw.toml").read_text().replace('f = "10 N"', 'f = "100 kN"'))
    visitor = visitors(served, reduced_motion="no-preference").visit()
    visitor.open(study)
    page = visitor.page
    page.wait_for_selector("text=sticks.toml is open")
    for layout, amber in (("S1", False), ("S3", True)):
        page.locator(".answers .pick", has_text=layout).first.click()
        page.wait_for_timeout(500)
        _moving(visitor)
        wait_until(lambda amber=amber: (page.evaluate(_COUNT, STICK) > 40) == amber)


@pytest.mark.parametrize(("name", "reason"), [("absorber", "At rest."), ("train", ""), ("full-car", ""), ("seat", "")])
def test_each_vehicle_is_drawn(name: str, reason: str, visitors: Any, served: Served) -> None:
    visitor = visitors(served, reduced_motion="no-preference").visit()
    page = visitor.page
    visitor.open(EXAMPLES / f"{name}.toml")
    page.wait_for_selector(f"text={name}.toml is open")
    visitor.settled()
    if reason:
        page.wait_for_selector(".vehicle .why", timeout=30_000)
        assert page.inner_text(".vehicle .why").startswith(reason)
        assert "Traceback" not in page.inner_text(".vehicle")
    else:
        _moving(visitor)
        assert page.locator(".vehicle .why").count() == 0
    page.wait_for_selector(".vehicle canvas[data-frames]")
    box = page.locator(".vehicle canvas").bounding_box()
    assert box["width"] > 300
    assert box["height"] > 200


def test_reduced_motion_holds_the_vehicle(visitors: Any, served: Served) -> None:
    visitor = visitors(served, reduced_motion="reduce").visit()
    page = visitor.page
    _moving(visitor)
    page.wait_for_selector(".vehicle button:has-text('Run')")
    still = page.evaluate(_INK)
    page.wait_for_timeout(300)
    assert page.evaluate(_INK) == still
    page.get_by_role("button", name="Run").click()
    wait_until(lambda: page.evaluate(_INK) != still)


def test_frames_are_short(visitor: Visitor, serve: Callable[..., Served]) -> None:
    """A frame's own work is a small part of a sixtieth of a second."""
    _moving(visitor)
    worst = visitor.page.evaluate(
        """async () => {
          const long = [];
          new PerformanceObserver((list) => long.push(...list.getEntries().map(({ duration }) => duration)))
            .observe({ entryTypes: ["longtask"] });
          await new Promise((done) => setTimeout(done, 3000));
          return Math.max(0, ...long);
        }"""
    )
    assert worst < 200.0  # [ms]


def test_a_vehicle_has_the_colours_of_the_page_at_once(visitor: Visitor) -> None:
    """Two frames after another theme is chosen, its ground is that of the panel around it."""
    page = visitor.page
    _moving(visitor)
    grounds = page.evaluate(
        """async () => {
          const canvas = document.querySelector(".vehicle canvas");
          const choice = document.querySelector("[aria-label=Colours]");
          const frame = () => new Promise(done => requestAnimationFrame(done));
          const found = [];
          for (const theme of ["dark", "light"]) {
            choice.value = theme;
            choice.dispatchEvent(new Event("change", { bubbles: true }));
            while (document.documentElement.dataset.theme !== theme) await frame();
            for (let i = 0; i < 3; i += 1) await frame();
            const [red, green, blue] = canvas.getContext("2d").getImageData(5, 5, 1, 1).data;
            const { backgroundColor } = getComputedStyle(document.querySelector("section.vehicle"));
            found.push([`rgb(${red}, ${green}, ${blue})`, backgroundColor]);
          }
          return found;
        }"""
    )
    assert [drawn for drawn, _ in grounds] == [around for _, around in grounds]
    assert grounds[0] != grounds[1]


@pytest.mark.parametrize("study", ["train", "half-car", "seat"])
def test_what_is_written_over_a_small_picture_covers_no_body(
    study: str, served: Served, visitors: Callable[..., Visitor]
) -> None:
    """On a telephone: above the vehicle, below the controls, is nothing but words and the scale."""
    visitor = visitors(served, viewport={"width": 420, "height": 900}).visit()
    page = visitor.page
    visitor.open(EXAMPLES / f"{study}.toml")
    page.wait_for_selector(f"text={study}.toml is open")
    _moving(visitor)
    bodies = """() => {
      const canvas = document.querySelector(".vehicle canvas");
      const probe = document.createElement("i");
      probe.style.color = "var(--body)";
      document.body.append(probe);
      const body = getComputedStyle(probe).color.match(/\\d+/g).map(Number);
      const { data, width, height } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const is = (i) => body.every((value, channel) => data[4 * i + channel] === value);
      for (let i = 0; i < width * height; i += 1) if (is(i)) return Math.floor(i / width);
      return null;
    }"""
    top = page.evaluate(bodies)
    assert top is not None
    assert top > 84 if study == "seat" else top > 96, top  # [px], where the last line of words ends
