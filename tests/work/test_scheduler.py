"""A scheduler unpacks what it passes on, and so it needs the package as workers do."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from distributed import Client

from inerter.errors import WorkError
from inerter.work.pool import Pool

WITHOUT = "import sys\nsys.modules['inerter'] = None\n"


@contextmanager
def dask(*words: object) -> Iterator[None]:
    command = [sys.executable, "-m", "dask", *map(str, words), "--no-dashboard"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.terminate()
        process.wait()


def test_a_scheduler_without_the_package_is_refused(tmp_path: Path) -> None:
    (tmp_path / "without.py").write_text(WITHOUT, encoding="utf-8")
    file, here = ("--scheduler-file", tmp_path / "there.json"), ("--host", "127.0.0.1")
    scheduler = dask("scheduler", *file, *here, "--port", 0, "--preload", tmp_path / "without.py")
    worker = dask("worker", *file, *here, "--nthreads", 1, "--no-nanny", "--local-directory", tmp_path)
    with (
        scheduler,
        worker,
        Client(scheduler_file=str(tmp_path / "there.json"), timeout="60s", set_as_default=False) as client,
        pytest.raises(WorkError, match="the scheduler cannot load this package"),
    ):
        Pool(executor=client.get_executor(pure=False))
