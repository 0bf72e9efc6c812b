"""Settings of the property tests: the same examples in every run, and no time limit of their own. Compiling, once."""

from __future__ import annotations

import gc
import os
from collections.abc import Generator, Iterator
from importlib import import_module
from pathlib import Path

import pytest
from _pytest.doctest import DoctestItem
from hypothesis import HealthCheck, settings

import inerter
from inerter.kernels.decorators import Kernel
from inerter.kernels.prepare import prepare
from inerter.work.chunks import THREADS

collect_ignore_glob = ["conftest.py", "*/conftest.py"]  # as modules with doctests: two cannot have one name

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the tests have a process for each core already
for name, count in (("short", 25), ("long", 50)):  # --hypothesis-profile=long tries more examples
    settings.register_profile(
        name,
        derandomize=True,
        deadline=None,
        database=None,
        max_examples=count,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )
settings.load_profile("short")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Of a whole run in several processes, compile once what each of them would compile for itself."""
    config = session.config
    whole = config.args_source is pytest.Config.ArgsSource.TESTPATHS and not config.option.collectonly
    if whole and config.getoption("numprocesses", None) and not hasattr(config, "workerinput"):
        prepare(kernel for kernel in _kernels() if kernel.signature is not None)


LONG_EXAMPLES = {"Fit", "identify", "identify_staged", "select_model"}
LONGER_EXAMPLES = {"ModelSelection", "StagedIdentification"}  # of what these functions return: the same fits again


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Those that are allowed more time than others come first, so that none is left to run alone at the end.

    Examples in docstrings that fit records are campaigns, or marathons. What one of its parameters makes a marathon is
    no campaign, whatever the others make of it.
    """
    for item in items:
        if isinstance(item, DoctestItem):
            name = item.name.rpartition(".")[2]
            if name in LONG_EXAMPLES | LONGER_EXAMPLES:
                item.add_marker(pytest.mark.campaign if name in LONG_EXAMPLES else pytest.mark.marathon)
        if item.get_closest_marker("marathon") is not None:
            item.own_markers = [mark for mark in item.own_markers if mark.name != "campaign"]
    items.sort(key=lambda item: item.get_closest_marker("timeout") is None)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """In campaigns a process has one thread, as there is one for each core: two took an eighth more of its time.

    Other tests have as many as the machine has cores.
    """
    THREADS.set(1 if item.get_closest_marker("campaign") else None)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands draw no figures, which takes longer than the work of a small study."""
    for name in ("report.writing.draw_study", "report.writing.draw_layouts", "cli.simulation.draw_simulation"):
        monkeypatch.setattr(f"inerter.{name}", lambda *given, **more: [])


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """What is loaded here stays to the end: to look through it for what can be freed takes long."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(100_000, 20, 100)  # what tests make is small, and looking took a twentieth of their time
        gc.enable()


def _kernels() -> Iterator[Kernel]:
    """All kernels of the package that are not made for one size of system."""
    root = Path(inerter.__file__).parent
    for path in sorted(root.rglob("*.py")):
        if "\n@kernel(" in path.read_text(encoding="utf-8"):
            module = import_module(".".join((root.name, *path.relative_to(root).with_suffix("").parts)))
            yield from (value for value in vars(module).values() if isinstance(value, Kernel))
