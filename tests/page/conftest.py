"""The page in a real Chromium, on a server of its own. Where there is no browser, one line says what is skipped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import Served, Visitor, free_port, launched_chromium, note_requests
from folders import EXAMPLES


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """All that takes a browser is a campaign, unless it is a marathon. It comes first: the longest tests are there."""
    here = Path(__file__).parent
    for item in items:
        if item.path.parent == here and item.get_closest_marker("marathon") is None:
            item.add_marker(pytest.mark.campaign)
    items.sort(key=lambda item: item.path.parent != here)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    with launched_chromium() as browser:
        yield browser


@pytest.fixture(scope="session")
def serve(chromium: Any) -> Iterator[Callable[..., Served]]:
    """A function that begins a workbench."""
    begun: list[Served] = []

    def begin(study: Path | None, *more: str) -> Served:
        served = Served(study, free_port(), more=more)
        begun.append(served)
        served.begin()
        served.wait_until_ready()
        return served

    yield begin
    for served in begun:
        served.stop()


@pytest.fixture(scope="session")
def served(serve: Callable[..., Served]) -> Served:
    """The workbench with the quarter car."""
    return serve(EXAMPLES / "quarter-car.toml")


@pytest.fixture(scope="session")
def nothing(serve: Callable[..., Served]) -> Served:
    """A workbench without a study."""
    return serve(None)


@pytest.fixture
def visitors(chromium: Any) -> Iterator[Callable[..., Visitor]]:
    """A function that opens a window, each of which must have asked nothing of any other host and met no fault."""
    all_of_them: list[Visitor] = []
    contexts: list[Any] = []

    def visitor(served: Served, *, context: Any = None, **settings: Any) -> Visitor:
        if context is None:
            # vehicles that move take half of a processor each, and are the subject of few tests
            usual = {"viewport": {"width": 1280, "height": 800}, "reduced_motion": "reduce"}
            context = chromium.new_context(**{**usual, **settings})
            context.set_default_timeout(60_000)  # [ms], for busy machines
            contexts.append(context)
        window = Visitor(context.new_page(), served)
        window.page.on("pageerror", lambda error: window.faults.append(str(error)))
        window.page.on(
            "console", lambda said: window.faults.append(said.text) if "Content Security" in said.text else None
        )
        note_requests(window)
        all_of_them.append(window)
        return window

    yield visitor
    for context in contexts:
        context.close()
    for one in {id(window.served): window.served for window in all_of_them}.values():
        if one.process is not None:
            one.forget_work()
    assert [window.elsewhere for window in all_of_them] == [[] for _ in all_of_them]
    assert [window.faults for window in all_of_them] == [[] for _ in all_of_them]


@pytest.fixture
def visitor(served: Served, visitors: Callable[..., Visitor]) -> Visitor:
    """A window with the quarter car and its optimum; what is computed before that is an answer to another question."""
    window = visitors(served).visit()
    window.chosen()
    return window
