"""Queue of jobs: computed one at a time in a separate process, each in a folder that outlives the page."""

from __future__ import annotations

import asyncio
import json
import shutil
import time
from collections.abc import AsyncIterator, Mapping
from concurrent.futures import BrokenExecutor, Executor
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from secrets import token_hex
from typing import Any

from inerter.app.kinds import KINDS, RESULTS
from inerter.app.wire import Refusal, encode_json
from inerter.app.working import REQUEST, RESULT, STOP, events_of, work, write_last
from inerter.work.processes import Processes

_GRACE = 5.0  # seconds that work has to stop at its next check, before its process is ended
_LOOK = 0.05  # seconds between two looks at what happened
_MOST = 200  # pieces of work that are kept
ENDED = ("done", "failed", "stopped")
_TOLD = ("id", "kind", "title", "study", "state", "begun", "ended", "sentence")
_OURS = {"made_by": "inerter serve"}  # in requests: a folder without it is somebody's own, and stays


@dataclass
class Job:
    """Job: a long computation with its folder and state; `study` is the title of its study."""

    id: str
    kind: str
    title: str
    study: str
    folder: Path
    state: str = "waiting"
    begun: float | None = None
    ended: float | None = None
    sentence: str = ""
    over: asyncio.Event = field(default_factory=asyncio.Event)

    def to_dict(self) -> dict[str, Any]:
        """State and progress of the job, for an answer."""
        events, _ = events_of(self.folder)
        progress = next((e for e in reversed(events) if e["event"] == "progress"), {"done": 0, "total": 0, "told": ""})
        found = next((e["found"] for e in reversed(events) if "found" in e), None)
        return {
            **{key: getattr(self, key) for key in _TOLD},
            **{key: progress[key] for key in ("done", "total")},
            "told": "" if self.state in ENDED else progress["told"],  # the present step: none once it has ended
            **({"found": found} if found is not None and self.state != "done" else {}),
        }

    def files(self) -> dict[str, Path]:
        """Files of the results, by the names under which they are served."""
        root = self.folder / RESULTS
        found = {path.relative_to(root): path for path in sorted(root.rglob("*")) if path.is_file()}
        return {
            name.as_posix(): path
            for name, path in found.items()
            if not path.is_symlink() and not any(part.startswith(".") for part in name.parts)
        }


@dataclass
class Jobs:
    """Queue of all jobs, and the process that computes them."""

    root: Path
    worker: Executor = field(default_factory=lambda: Processes(1))
    known: dict[str, Job] = field(default_factory=dict)
    _queue: asyncio.Queue[Job] = field(default_factory=asyncio.Queue)

    def __post_init__(self) -> None:
        """Register the jobs that an earlier server left in the folder."""
        for path in sorted(self.root.glob(f"*/{REQUEST}"), key=lambda path: path.stat().st_mtime):
            with suppress(OSError, ValueError, KeyError, AttributeError):
                request = json.loads(path.read_bytes())
                if _OURS.items() <= request.items():
                    self.known[path.parent.name] = _job_of_earlier_server(path.parent, request)

    def add(self, kind: str, request: Mapping[str, Any], title: str = "") -> Job:
        """Append a job to the queue; raises `Refusal` where too much is kept already."""
        for old in [job for job in self.known.values() if job.state in ENDED][: max(len(self.known) - _MOST + 1, 0)]:
            self.forget(old)
        if len(self.known) >= _MOST:
            raise Refusal(400, f"{_MOST} jobs are waiting. Stop some of them first.")
        name = token_hex(8)
        job = Job(name, kind, title or KINDS[kind].title_of(request), _study_title(request), self.root / name)
        job.folder.mkdir(parents=True)
        (job.folder / REQUEST).write_bytes(encode_json({**request, "kind": kind, "title": job.title, **_OURS}))
        self.known[name] = job
        self._queue.put_nowait(job)
        return job

    def get(self, name: str) -> Job:
        """Job of that id; raises `Refusal` if there is none."""
        if name not in self.known:
            raise Refusal(404, "Unknown job: it was deleted, or the server was restarted.")
        return self.known[name]

    def stop(self, job: Job) -> None:
        """Request a job to stop at its next check; a waiting job is stopped at once."""
        if job.state == "waiting":
            self._end(job, {"event": "stopped"})
        elif job.state == "running":
            (job.folder / STOP).touch()

    def resume(self, job: Job) -> None:
        """Append a job that was stopped or failed to the queue again; raises `Refusal` for any other."""
        if job.state not in ("stopped", "failed") or not KINDS[job.kind].resumes:
            resuming = ", ".join(kind.key for kind in KINDS.values() if kind.resumes)
            raise Refusal(400, f"This job ({job.kind}) is {job.state}; only stopped jobs ({resuming}) resume.")
        (job.folder / STOP).unlink(missing_ok=True)
        job.state, job.begun, job.ended, job.sentence, job.over = "waiting", None, None, "", asyncio.Event()
        self._queue.put_nowait(job)

    def forget(self, job: Job) -> None:
        """Remove a job that has ended, and its files."""
        self.known.pop(job.id, None)
        shutil.rmtree(job.folder, ignore_errors=True)

    async def run(self) -> None:
        """Compute the jobs of the queue, without end."""
        while True:
            job = await self._queue.get()
            if job.state == "waiting":
                await self._do(job)

    async def events(self, job: Job, start: int = 0) -> AsyncIterator[tuple[int, dict[str, Any]]]:
        """All events of work behind so many bytes, each with where it ends, until the work has ended."""
        while True:
            over = job.state in ENDED
            found, end = events_of(job.folder, start)
            for event in found:
                yield end, event
            start = end
            if over:
                return
            with suppress(TimeoutError):
                await asyncio.wait_for(job.over.wait(), _LOOK)

    async def _do(self, job: Job) -> None:
        job.state, job.begun = "running", time.time()
        try:
            future = asyncio.wrap_future(self.worker.submit(work, str(job.folder)))
            asked: float | None = None
            while not future.done():
                await asyncio.wait((future,), timeout=_LOOK)
                if asked is None and (job.folder / STOP).exists():
                    asked = time.monotonic()
                if asked is not None and time.monotonic() - asked > _GRACE:
                    future.cancel()
                    await asyncio.to_thread(self.worker.shutdown, wait=False, cancel_futures=True)
                    self._end(job, {"event": "stopped"})
                    return
            self._end(job, future.result())
        except BrokenExecutor:
            sentence = "The process of this work ended unexpectedly; memory may have run out."
            self._end(job, {"event": "failed", "sentence": sentence})
        except Exception as error:  # whatever it is, the queue goes on
            self._end(job, {"event": "failed", "sentence": str(error)})

    def _end(self, job: Job, how: dict[str, Any]) -> None:
        with suppress(OSError):
            write_last(job.folder, how)
        job.state, job.ended, job.sentence = how["event"], time.time(), how.get("sentence", "")
        job.over.set()


def _job_of_earlier_server(folder: Path, request: Mapping[str, Any]) -> Job:
    """Work that an earlier server has left: as it ended, or stopped where it was."""
    events, _ = events_of(folder)
    last = events[-1] if events else {}
    if last.get("event") not in ENDED:
        last = {"event": "stopped", "sentence": "The server ended before this was done.", "time": last.get("time")}
        write_last(folder, last)
    job = Job(folder.name, request["kind"], request["title"], _study_title(request), folder, last["event"])
    job.sentence = last.get("sentence", "")
    job.begun, job.ended = (events[0]["time"] if events else None), last.get("time")
    job.over.set()
    return job


def _study_title(request: Mapping[str, Any]) -> str:
    title = request.get("study", {}).get("title")
    return title if isinstance(title, str) else ""


def result_of(job: Job) -> bytes:
    """Result of a job as JSON text; raises `Refusal` where there is none."""
    if job.state != "done":
        raise Refusal(404, f"This work is {job.state}; it has no result. {job.sentence}".strip())
    return (job.folder / RESULT).read_bytes()


def with_result(job: Job) -> bytes:
    """State of a job as JSON, with its result if it is done."""
    told = encode_json(job.to_dict())
    return told if job.state != "done" else told[:-1] + b', "result": ' + result_of(job) + b"}"


def as_event(number: int, event: Mapping[str, Any]) -> bytes:
    """A server-sent event."""
    data = {key: value for key, value in event.items() if key != "event"}
    return f"id: {number}\nevent: {event['event']}\ndata: {json.dumps(data)}\n\n".encode()
