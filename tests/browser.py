"""A workbench that runs, and windows of a real browser on it."""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

_SHELL = (
    "chromium-headless-shell"  # the same engine without the windows around a page, which take a quarter of the time
)
_CHROMIUM = next((path for name in (_SHELL, "chromium", "chromium-browser") if (path := shutil.which(name))), None)
_NONE = f"Pages are not tested: there is no Chromium (as root: apt-get install {_SHELL})."
_NOWHERE_ELSE = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"  # no other host is found
_TOKEN = "a-token-of-the-tests-of-the-page-00"
_READY = 240.0  # seconds, with kernels to compile


@contextmanager
def launched_chromium() -> Iterator[Any]:
    """A real browser; where there is none, the test is skipped and says so."""
    if _CHROMIUM is None:
        pytest.skip(_NONE)
    with pytest.importorskip("playwright.sync_api").sync_playwright() as play:
        browser = play.chromium.launch(executable_path=_CHROMIUM, args=["--no-sandbox", _NOWHERE_ELSE])
        yield browser
        browser.close()


@dataclass
class Served:
    """A workbench that runs, and can be stopped and begun again on its port."""

    study: Path | None
    port: int
    token: str = _TOKEN
    more: tuple[str, ...] = ()
    process: subprocess.Popen[str] | None = None

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def link(self) -> str:
        return f"{self.origin}/#token={self.token}"

    def begin(self) -> None:
        command = [sys.executable, "-c", "from inerter.cli.start import main; main()", "serve"]
        command += [] if self.study is None else [str(self.study)]
        command += ["--port", str(self.port), "--no-browser", *self.more]
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env={**os.environ, "INERTER_TOKEN": self.token}
        )
        assert self.process.stdout is not None
        assert self.process.stdout.readline().strip() == self.link

    def stop(self) -> None:
        if self.process is not None:
            self.process.terminate()
            self.process.wait(30)
            assert self.process.stdout is not None
            self.process.stdout.close()
            self.process = None

    def wait_until_ready(self) -> None:
        self.get("ready")

    def get(self, what: str, method: str = "GET") -> bytes:
        """What the server answers to a script."""
        authorised = {"Authorization": f"Bearer {self.token}"}
        request = urllib.request.Request(f"{self.origin}/api/{what}", headers=authorised, method=method)
        with urllib.request.urlopen(request, timeout=_READY) as answer:
            return bytes(answer.read())

    def forget_work(self) -> None:
        """Stop and forget all jobs: the next window is of another test, which counts its own."""
        while jobs := json.loads(self.get("work"))["work"]:
            for job in jobs:
                self.get(f"work/{job['id']}", "DELETE")
            time.sleep(0.02)


@dataclass
class Visitor:
    """A window of the browser; counts what the page asks of other hosts, and keeps what goes wrong in it."""

    page: Any
    served: Served
    elsewhere: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def visit(self, link: str = "") -> Visitor:
        self.page.goto(link or self.served.link)
        self.page.wait_for_selector("[data-connection=ready]", state="attached")
        return self

    def open(self, *files: Path) -> None:
        """Open files by the menu, as a person does."""
        self.page.get_by_text("Open", exact=True).click()
        self.page.set_input_files(".menu input[type=file]", [str(path) for path in files])

    def download(self, name: str, into: Path, menu: str = "Save") -> Path:
        """Save by a menu what it calls so, in a folder."""
        with self.page.expect_download() as found:
            self.page.get_by_text(menu, exact=True).click()
            self.page.get_by_role("button", name=name).click()
        self.page.keyboard.press("Escape")  # closes the menu
        path = into / str(found.value.suggested_filename)
        found.value.save_as(path)
        return path

    def wait_for_text(self, text: str) -> None:
        """Wait until the network that is edited is this one."""
        self.page.wait_for_function("text => document.getElementById('network-text')?.value === text", arg=text)

    @property
    def text(self) -> str:
        return str(self.page.input_value("#network-text"))

    def settled(self) -> None:
        """Wait until every question that the page asked is answered.

        By a boolean: an element that a script returns is kept by the browser, with the table that it was in.
        """
        self.page.wait_for_function(
            "() => !document.querySelector('[aria-busy=true]') && document.querySelector('td[data-index]') !== null"
        )

    def chosen(self) -> None:
        """Wait until the layout has values: those of its optimum, which the page seeks when it opens a study."""
        self.page.wait_for_function(
            "() => document.querySelector('nav.decision')?.innerText.includes('not chosen') === false"
            " && document.querySelector('.answers[data-being=coming]') === null"
        )

    def pick(self, layout: str) -> None:
        """Select a layout in the ranking, and wait for its answers."""
        self.page.locator(f".answers .pick[title='{layout}']").click()
        self.settled()

    def drawn(self) -> None:
        """Wait until the tab that is shown has its answers, and they are drawn."""
        self.page.evaluate(
            """async () => {
              const drawn = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
              do await drawn(); while (document.querySelector("#tab-panel [aria-busy=true]"));
              await drawn();
            }"""
        )

    def values(self) -> dict[str, float]:
        """The indices that the page shows, in full."""
        self.settled()
        cells = self.page.eval_on_selector_all(
            "td[data-index]", "all => all.map(td => [td.dataset.index, td.dataset.value])"
        )
        return {index: float(value) for index, value in cells}


_STEP = """() => {
  const slider = document.getElementById("slider elements.k");
  slider.value = Number(slider.value) + 1;
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  %s
}"""


def step_slider_and(visitor: Visitor, act: str = "") -> None:
    """Move the slider of k by a step and, before the page is drawn anew, act as a line of JavaScript says."""
    visitor.page.evaluate(_STEP % act)


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


class HeldRequests:
    """Requests of a window that match a pattern: held back as `routes` until `end`, after which others pass.

    The pattern stays: once a window has none, it lets go what is held.
    """

    def __init__(self, window: Visitor, pattern: str | re.Pattern[str]) -> None:
        self.routes: list[Any] = []
        self._ended = False
        window.page.route(pattern, lambda route: self._hold(route))  # noqa: PLW0108 -- a method cannot be marked

    def end(self) -> None:
        """Hold no more requests back."""
        self._ended = True

    def _hold(self, route: Any) -> None:
        if self._ended:
            route.continue_()
        else:
            self.routes.append(route)


def note_requests(window: Visitor) -> None:
    """Keep what a window asks of others than its server; to hold every request back for that took long."""
    ours = (window.served.origin, f"blob:{window.served.origin}")
    window.page.on("request", lambda asked: asked.url.startswith(ours) or window.elsewhere.append(asked.url))


def wait_until(true: Callable[[], bool], seconds: float = 30.0) -> None:
    """Wait for something outside the page."""
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "it did not come true"
        time.sleep(0.05)


def drop(visitor: Visitor, path: Path) -> None:
    """Drop a file or folder on the page, as the desktop does."""
    session = visitor.page.context.new_cdp_session(visitor.page)
    data = {"items": [], "files": [str(path)], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        session.send("Input.dispatchDragEvent", {"type": kind, "x": 640, "y": 300, "data": data})
