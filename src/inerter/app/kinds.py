"""Job types. A further one is a registry entry, and a function from a request and a folder to a result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Tell = Callable[[int, int, str], None]  # how much is done, of how much, and what; raises `JobStopped` if it is to stop
RESULTS = "results"  # the folder of results in that of the work


class JobStopped(Exception):  # noqa: N818 -- nothing is wrong
    """Raised in a job after a request to stop it."""


@dataclass(frozen=True)
class WorkKind:
    """Job type: title, keys of its request in addition to `study`, and the function that computes it.

    That takes the request, the folder of the work, and how to tell how far it is.
    """

    key: str
    title: str
    keys: tuple[str, ...]
    home: str


_STUDIED, _DESIGNS = "inerter.app.study_jobs", ("indices", "methods")
KINDS = {
    kind.key: kind
    for kind in (
        WorkKind("optimise", "The best values", ("layouts", "method", *_DESIGNS), f"{_STUDIED}:optimise"),
        WorkKind("run", "The whole study, with its report", (), f"{_STUDIED}:run"),
        WorkKind("sweep", "The best designs over swept values", ("sweep", "layouts", "indices"), f"{_STUDIED}:sweep"),
        WorkKind(
            "front",
            "Trade-offs between two or three indices",
            ("layouts", "indices", "method", "points"),
            "inerter.app.fronts:front",
        ),
        WorkKind("compare", "Two to four designs side by side", ("designs", *_DESIGNS), f"{_STUDIED}:compare"),
        WorkKind(
            "identify",
            "What a measured device is made of",
            ("records", "model", "config"),
            "inerter.app.identification_jobs:identify",
        ),
    )
}
