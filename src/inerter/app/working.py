"""Execution of a job in a worker process: events are appended to a file, and a stop file ends the job."""

from __future__ import annotations

import json
import os
import time
from dataclasses import dataclass
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from inerter.app.calls import run_call
from inerter.app.kinds import KINDS, JobStopped
from inerter.app.wire import decode_json, encode_json
from inerter.atomic_io import atomic_write
from inerter.formatting import format_duration
from inerter.work.progress import ProgressStep, progress

REQUEST, EVENTS, RESULT, STOP = "request.json", "events.jsonl", "result.json", "stop"
_OFTEN = 0.05  # seconds between two lines about progress
_SELDOM = 0.9  # the same about what is under way, where nothing else is told
_FINE = 100  # parts from where the remaining time is told, ...
_EARLY = 0.2  # ... once this share is done


@dataclass
class _Telling:
    folder: Path
    last: float = 0.0
    count: tuple[int, int] = (0, 0)
    begun: tuple[float, int] | None = None  # when the first part was done, and how many were then
    found: Any = None  # result so far that was told last
    running: str = ""  # what is under way
    heard: str = ""  # the last step

    def __call__(self, done: int, total: int, told: str, found: Any = None) -> None:
        stop = (self.folder / STOP).exists()
        now = time.monotonic()
        self.count, self.running = (done, total), told or self.running
        if self.begun is None and done > 0:
            self.begun = now, done
        is_new = found is not None and found != self.found
        if now - self.last > _OFTEN or done == total or (stop and is_new):
            self.last = now
            event = {"event": "progress", "done": done, "total": total, "told": f"{self.running}{self._left(now)}"}
            if is_new:
                event["found"] = self.found = found
            write_event(self.folder, event)
        if stop:
            raise JobStopped

    def step(self, step: ProgressStep) -> None:
        """Write the progress of the running step, at most every `_SELDOM` seconds; raises `JobStopped` on request."""
        if (self.folder / STOP).exists():
            raise JobStopped
        if step.over:
            return
        if str(step) != self.heard:  # a step is repeated while the job is at something else, such as figures
            self.heard = self.running = str(step)
        if time.monotonic() - self.last > _SELDOM:
            self(*self.count, "")

    def _left(self, now: float) -> str:
        """Remaining time in words, where many small parts tell it; compilation before the first one does not count."""
        done, total = self.count
        if self.begun is None or total < _FINE or done == total or done - self.begun[1] < _EARLY * total:
            return ""
        since, first = self.begun
        seconds = (now - since) * (total - done) / (done - first)
        return f", about {format_duration(seconds)} left" if seconds >= 1.0 else ""


def work(folder: str) -> dict[str, Any]:
    """Do the work whose request is in a folder, and write its result there; returns how it ended."""
    place = Path(folder)
    request = decode_json((place / REQUEST).read_bytes())
    stopped = False

    def run() -> Any:
        nonlocal stopped
        try:
            telling = _Telling(place)
            with progress(telling.step):
                return resolve_name(KINDS[request["kind"]].home)(request, place, telling)
        except JobStopped:
            stopped = True
            return None

    status, found = run_call(run)
    if stopped:
        return {"event": "stopped"}
    if status != 200:
        return {"event": "failed", **found}
    with atomic_write(place / RESULT) as draft:
        draft.write_bytes(found)
    return {"event": "done"}


def write_event(folder: Path, event: dict[str, Any]) -> None:
    """Append an event to those of a piece of work."""
    with (folder / EVENTS).open("ab") as stream:
        stream.write(encode_json({**event, "time": time.time()}) + b"\n")


def write_last(folder: Path, event: dict[str, Any]) -> None:
    """Append the event with which work ends; a line that a process began, and did not end, is taken away."""
    path = folder / EVENTS
    if path.exists():
        os.truncate(path, events_of(folder)[1])
    write_event(folder, event)


def events_of(folder: Path, start: int = 0) -> tuple[list[dict[str, Any]], int]:
    """Events after the byte offset `start`, and the next offset; an incomplete last line is left for the next call."""
    path = folder / EVENTS
    if not path.exists():
        return [], start
    with path.open("rb") as stream:
        stream.seek(start)
        text = stream.read()
    whole_text = text[: text.rfind(b"\n") + 1]
    return [json.loads(line) for line in whole_text.splitlines()], start + len(whole_text)
