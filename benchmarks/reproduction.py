"""Seconds of every part of the reproduction of Wang and Su (2008), from nothing.

    python benchmarks/reproduction.py [part ...]
    XDG_CACHE_HOME=$(mktemp -d) python benchmarks/reproduction.py    # nothing compiled yet

Parts of tasks are sums over the processes; the others are times on the clock. Memory is that of the largest process.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory


def main(only: tuple[str, ...]) -> None:
    from inerter.papers.wang_su_2008 import reproduce as paper  # noqa: PLC0415 - worker processes import this file
    from inerter.papers.wang_su_2008.report.page import write_reproduction  # noqa: PLC0415
    from inerter.work.pool import Pool  # noqa: PLC0415

    begun: dict[str, float] = {}
    ended: dict[str, float] = {}

    def progress(what: str, done: int, total: int) -> None:
        begun.setdefault(what, time.perf_counter())
        ended[what] = time.perf_counter()

    jobs = os.cpu_count() or 1
    start = time.perf_counter()
    with TemporaryDirectory() as name:
        folder = Path(name)
        with Pool(jobs) as pool:
            found = paper.reproduce(folder, only=only, executor=pool, progress=progress)
            computed = time.perf_counter()
            write_reproduction(found, folder, pool)
        written = time.perf_counter()
        tasks: Counter[str] = Counter()
        for line in (folder / paper.JOURNAL).read_text(encoding="utf-8").splitlines()[1:]:
            entry = json.loads(line)
            tasks[entry["part"]] += entry["numbers"]["seconds"]
    for what, seconds in ((what, ended[what] - begun[what]) for what in begun):
        print(f"{what:14}{seconds:8.1f} s on the clock")
    for part, seconds in tasks.most_common():
        print(f"  {part:12}{seconds:8.1f} s of processes")
    print(f"{'claims, etc.':14}{computed - max(ended.values(), default=start):8.1f} s on the clock")
    print(f"{'figures, page':14}{written - computed:8.1f} s on the clock")
    print(f"{'in all':14}{written - start:8.1f} s on the clock, {jobs} processes")
    most = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    print(f"{'memory':14}{most / 2**20:8.2f} GiB, the largest process")


if __name__ == "__main__":
    main(tuple(sys.argv[1:]))
