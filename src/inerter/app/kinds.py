"""Job types. A further one is a registry entry, and a function from a request and a folder to a result."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Protocol

RESULTS = "results"  # the folder of results in that of the work


class JobStopped(Exception):  # noqa: N818 -- nothing is wrong
    """Raised in a job after a request to stop it."""


class Tell(Protocol):
    """Report of how much is done, of how much, and what; with a result so far, if there is one."""

    def __call__(self, done: int, total: int, told: str, found: Any = None) -> None:
        """Raises `JobStopped` if the job is to stop."""


def report_nothing(done: int, total: int, told: str, found: Any = None) -> None:
    """No report: that of a panel, whose answer is awaited."""


def tell_compiling(tell: Tell) -> Callable[[str, int, int], None]:
    """Report of the kernel compilation. Other threads give it too, so that it does not stop: the next part will."""

    def compiling(title: str, number: int, total: int) -> None:
        with suppress(JobStopped):
            tell(0, 0, f"preparing compiled code, once on this computer: {title}, {number} of {total}")

    return compiling


@dataclass(frozen=True)
class WorkKind:
    """Job type: title, keys of its request in addition to `study`, and the function that computes it.

    That takes the request, the folder of the work, and how to tell how far it is. A job that `resumes` continues from
    what it left in its folder.
    """

    key: str
    title: str
    keys: tuple[str, ...]
    home: str
    resumes: bool = False


_STUDIED, _DESIGNS = "inerter.app.study_jobs", ("indices", "methods")
KINDS = {
    kind.key: kind
    for kind in (
        WorkKind("optimise", "The best values", ("layouts", "method", *_DESIGNS), f"{_STUDIED}:optimise"),
        WorkKind("run", "The whole study, with its report", (), f"{_STUDIED}:run"),
        WorkKind("report", "The report as one page", ("designs",), f"{_STUDIED}:report"),
        WorkKind(
            "margins",
            "Break-even values, other speeds, tolerances",
            ("design", "layout", "values", "baseline", "index", "methods"),
            f"{_STUDIED}:margins",
        ),
        WorkKind("sweep", "The best designs over swept values", ("sweep", "layouts", "indices"), f"{_STUDIED}:sweep"),
        WorkKind(
            "front",
            "Trade-offs between two or three indices",
            ("layouts", "indices", "method", "points"),
            "inerter.app.fronts:front",
        ),
        WorkKind(
            "search",
            "The best of all networks that a free network may be",
            ("layouts", "indices"),
            "inerter.app.searches:search",
            resumes=True,
        ),
        WorkKind("compare", "Two to four designs side by side", ("designs", *_DESIGNS), f"{_STUDIED}:compare"),
        WorkKind(
            "identify",
            "Parameters of a measured device",
            ("records", "model", "config"),
            "inerter.app.identification_jobs:identify",
        ),
    )
}
