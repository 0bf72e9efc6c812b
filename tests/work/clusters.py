"""A dask cluster for tests: a scheduler and workers, each a process of its own that can be killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

PATIENCE = 60.0  # seconds
_QUIET = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}  # each death is told at once


@dataclass
class Cluster:
    """A scheduler by its file, and the processes of workers."""

    folder: Path
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    @property
    def file(self) -> Path:
        """What says where the scheduler is."""
        return self.folder / "scheduler.json"

    @property
    def address(self) -> str:
        """The scheduler's."""
        return str(json.loads(self.file.read_text())["address"])

    def start_scheduler(self, **environment: str) -> subprocess.Popen[bytes]:
        """Start a scheduler, and wait until it is there."""
        self.file.unlink(missing_ok=True)
        words = ("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show")
        process = self._start(*words, "--scheduler-file", str(self.file), **environment)
        deadline = time.monotonic() + PATIENCE
        while not self.file.exists() or not self.file.read_text():
            assert time.monotonic() < deadline, "no scheduler"
            time.sleep(0.05)
        return process

    def start_worker(self, *words: str, **environment: str) -> subprocess.Popen[bytes]:
        """Start a worker of one thread; without a nanny, unless `words` say so, its end is its end."""
        nanny = () if "--nanny" in words else ("--no-nanny",)
        own = ("--nthreads", "1", "--no-dashboard", "--local-directory", str(self.folder))
        return self._start("dask_worker", "--scheduler-file", str(self.file), *own, *nanny, *words, **environment)

    def _start(self, program: str, *words: str, **environment: str) -> subprocess.Popen[bytes]:
        log = self.folder / f"{len(self.processes)}.log"
        with log.open("wb") as output:
            process = subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{program}", *words],
                stdout=output,
                stderr=subprocess.STDOUT,
                env={**os.environ, **_QUIET, **environment},
                start_new_session=True,
            )
        self.processes.append(process)
        return process


def kill(process: subprocess.Popen[bytes]) -> None:
    """End it, and what it has started, as a machine ends that is switched off."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def cluster(folder: Path, workers: int = 2, **environment: str) -> Iterator[Cluster]:
    """A scheduler with so many workers, gone afterwards."""
    made = Cluster(folder)
    try:
        made.start_scheduler(**environment)
        for _ in range(workers):
            made.start_worker(**environment)
        yield made
    finally:
        for process in made.processes:
            if process.poll() is None:
                kill(process)


def results(folder: Path) -> Mapping[str, bytes]:
    """What must not depend on where it was computed."""
    return {name: (folder / name).read_bytes() for name in ("results.nc", "summary.csv", "study.resolved.toml")}
