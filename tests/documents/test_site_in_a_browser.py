"""The site in a real Chromium: search, accessibility, width, and nothing asked of other hosts.

The folder of the built site is the environment variable INERTER_SITE; pictures of the pages go to INERTER_PICTURES.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from browser import launched_chromium

SITE = os.environ.get("INERTER_SITE", "")
pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(not SITE, reason="INERTER_SITE does not name the folder of a built site: see .ci/run"),
]
KINDS = {
    "start": "index.html",
    "tutorial": "tutorial-vehicle.html",
    "formulas": "theory.html",
    "table": "comparison.html",
    "notebook": "notebooks/tuned_mass_damper.html",
    "gallery": "examples/index.html",
    "program": "examples/plot_absorber.html",
    "function": "reference/python/optimise.html",
    "class": "reference/python/QuarterCar.html",
    "names": "reference/python.html",
    "commands": "reference/commands.html",
    "keys": "reference/keys.html",
    "decision": "decisions/0008-no-event-is-missed.html",
    "sources": "_modules/inerter/vehicle/quarter_car.html",
    "search": "search.html",
    "results": "search.html?q=optimise",
}
DRAWN = "() => new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn)))"
"""Once the window is laid out at its new size, of which it tells its observers in its next frame."""
SIZES = {"wide": (1280, 800), "narrow": (420, 800)}


class Quiet(SimpleHTTPRequestHandler):
    """Serves files and says nothing."""

    def log_message(self, format: str, *values: Any) -> None:
        pass


@pytest.fixture(scope="module")
def origin() -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=SITE)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture(scope="module")
def page(origin: str) -> Iterator[Any]:
    """A window, which must have asked nothing of any other host, missed no file, and met no fault."""
    asked, missing, faults = [], [], []
    with launched_chromium() as browser:
        window = browser.new_context(reduced_motion="reduce").new_page()
        window.on("request", lambda request: asked.append(request.url))
        window.on("response", lambda answer: missing.append(answer.url) if answer.status >= 400 else None)
        window.on("pageerror", lambda error: faults.append(str(error)))
        yield window
    assert len(asked) > len(KINDS)
    assert [url for url in asked if not url.startswith((f"{origin}/", "data:", "blob:"))] == []
    assert [url for url in missing if not url.endswith("/favicon.ico")] == []
    assert faults == []


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_accessible_and_fits(kind: str, page: Any, origin: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    page.goto(f"{origin}/{KINDS[kind]}", wait_until="networkidle")
    page.evaluate(axe.Axe().axe_script)
    for size, (width, height) in SIZES.items():
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate(DRAWN)
        if wanted := os.environ.get("INERTER_PICTURES"):
            page.screenshot(path=Path(wanted) / f"site-{kind}-{size}.png")
        too_wide = "() => document.documentElement.scrollWidth - document.documentElement.clientWidth"
        assert page.evaluate(too_wide) == 0, size
        found = page.evaluate("() => axe.run(document, { resultTypes: ['violations'] }).then(all => all.violations)")
        assert [f"{each['id']}: {each['nodes'][0]['html'][:200]}" for each in found] == [], size


def test_what_comes_to_scroll_is_reached_by_keys(page: Any, origin: str) -> None:
    """Not only when the window changes its size: a drawer that opens makes lines too long as well."""
    page.set_viewport_size({"width": 1280, "height": 800})
    page.goto(f"{origin}/{KINDS['notebook']}", wait_until="networkidle")
    block = page.locator("#codecell0")
    block.evaluate("block => { block.parentElement.style.width = '150px'; }")
    page.evaluate(DRAWN)
    assert block.get_attribute("tabindex") == "0"
    block.evaluate("block => { block.parentElement.style.width = '4000px'; }")
    page.evaluate(DRAWN)
    assert block.get_attribute("tabindex") is None


@pytest.mark.parametrize(
    ("words", "target"),
    [
        ("optimise_robust", "reference/python/optimise_robust.html"),
        ("WeightedAcceleration", "reference/python/WeightedAcceleration.html"),
        ("reproduce", "reference/commands.html"),
        ("backlash", "simulation.html"),
    ],
)
def test_search_finds(words: str, target: str, page: Any, origin: str) -> None:
    """Names, commands and words of the field, from the field for it on any page."""
    page.set_viewport_size({"width": 1280, "height": 800})
    page.goto(f"{origin}/index.html")
    page.get_by_role("textbox", name="Search").fill(words)
    page.keyboard.press("Enter")
    page.locator(f"#search-results a[href*='{target}']").first.wait_for(timeout=30_000)
