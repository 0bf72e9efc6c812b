"""Job types. A further one is a registry entry, and a function from a request and a folder to a result."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from inerter.formatting import format_list

RESULTS = "results"  # the folder of results in that of the work


class JobStopped(Exception):  # noqa: N818 -- nothing is wrong
    """Raised in a job after a request to stop it."""


class Tell(Protocol):
    """Report of how much is done, of how much, and what; with a result so far, if there is one."""

    def __call__(self, done: int, total: int, told: str, found: Any = None) -> None:
        """An empty `told` stands for the running step. Raises `JobStopped` if the job is to stop."""


def report_nothing(done: int, total: int, told: str, found: Any = None) -> None:
    """No report: that of a panel, whose answer is awaited."""


def tell_compiling(tell: Tell) -> Callable[[str, int, int], None]:
    """Report of the kernel compilation. Other threads give it too, so that it does not stop: the next part will."""

    def compiling(title: str, number: int, total: int) -> None:
        with suppress(JobStopped):
            tell(0, 0, f"preparing compiled code, once on this computer: {title}, {number} of {total}")

    return compiling


def job_arguments(
    tell: Tell, write: Callable[[Any, Path], object], words: Callable[[Any], tuple[Any, ...]]
) -> dict[str, Any]:
    """Arguments of `run_study` or `search_study` in a job: processes, reports of progress, and `write` at the end.

    `words` gives what is told after a part with this result, and perhaps a result so far.
    """
    done = [0]

    def on_part_done(count: int, total: int, last: Any, n_failures: int) -> None:
        done[0] = count
        tell(count, total, *words(last))

    def finish(result: Any, into: Path) -> None:
        tell(done[0], done[0], "figures and report")
        write(result, into)

    return {
        "jobs": max((os.cpu_count() or 2) - 1, 1),
        "progress": on_part_done,
        "compiling": tell_compiling(tell),
        "finish": finish,
    }


Request = Mapping[str, Any]


@dataclass(frozen=True)
class WorkKind:
    """Job type: title, keys of its request in addition to `study`, and the function that computes it.

    That takes the request, the folder of the work, and how to tell how far it is. A job that `resumes` continues from
    what it left in its folder. One that a person may begin has a `description`, and where a study can lack what it is
    about, the sentence on that. `subject` says what a request is about.
    """

    key: str
    title: str
    keys: tuple[str, ...]
    home: str
    resumes: bool = False
    description: str = ""
    lacking: str = ""
    subject: Callable[[Request], str] | None = None

    def title_of(self, request: Request) -> str:
        """Title of a job: what its request is about."""
        return (self.subject(request) if self.subject else "") or self.title


def _best_values(request: Request) -> str:
    layouts, indices = request.get("layouts"), request.get("indices")
    return f"Best {format_list(indices)} of {format_list(layouts)}" if layouts and indices else ""


def _sweep(request: Request) -> str:
    swept = [
        f"{of} from {how['from']} to {how['to']}" if isinstance(how, Mapping) and {"from", "to"} <= set(how) else of
        for of, how in (request.get("sweep") or {}).items()
    ]
    return f"Sweep of {format_list(swept)}" if swept else ""


def _front(request: Request) -> str:
    indices = request.get("indices")
    return f"Trade-off front of {format_list(indices)}" if indices else ""


def _margins(request: Request) -> str:
    layout = (request.get("design") or request).get("layout")
    return f"Break-even values of {layout}" if layout else ""


def _report(request: Request) -> str:
    designs = request.get("designs")
    return f"Report of {designs[0]['layout']}" if designs else ""


_STUDIED, _DESIGNS = "inerter.app.study_jobs", ("indices", "methods")
KINDS = {
    kind.key: kind
    for kind in (
        WorkKind(
            "optimise",
            "The best values",
            ("layouts", "method", *_DESIGNS),
            f"{_STUDIED}:optimise",
            subject=_best_values,
        ),
        WorkKind(
            "run",
            "Run the whole study",
            (),
            f"{_STUDIED}:run",
            description="As inerter run does: all layouts and indices, with report, tables and figures.",
        ),
        WorkKind("report", "The report as one page", ("designs",), f"{_STUDIED}:report", subject=_report),
        WorkKind(
            "margins",
            "Break-even values, other speeds, tolerances",
            ("design", "layout", "values", "baseline", "index", "methods"),
            f"{_STUDIED}:margins",
            subject=_margins,
        ),
        WorkKind(
            "sweep",
            "Sweep",
            ("sweep", "layouts", "indices"),
            f"{_STUDIED}:sweep",
            description="The best designs for each value of one number of the study.",
            lacking="There is no fixed value to sweep.",
            subject=_sweep,
        ),
        WorkKind(
            "front",
            "Trade-off front",
            ("layouts", "indices", "method", "points"),
            "inerter.app.fronts:front",
            description="Designs that no other one beats in all of two or three indices: each point can be taken into "
            "the editor.",
            lacking="No two indices are known.",
            subject=_front,
        ),
        WorkKind(
            "search",
            "Search for the best network",
            ("layouts", "indices"),
            "inerter.app.searches:search",
            resumes=True,
            description="Every network that a free network may be, ranked; of two or three indices the front over all "
            "networks. The ranking fills during the search; a search that is stopped keeps it, and can be resumed.",
            lacking="No layout has a free network.",
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
