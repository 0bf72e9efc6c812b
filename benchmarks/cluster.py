"""Speed-up by several workers, overhead of submission, and effect of network latency. Needs the extra "cluster".

    python benchmarks/cluster.py                    # everything, the best of 3 rounds: about ten minutes
    python benchmarks/cluster.py --rounds 1 study   # one part of: study, waiting, pieces

Workers are processes of one thread each, of this machine: own ones, and those of a dask cluster whose scheduler is a
process too. For a slow network every message goes through a proxy that keeps it for 50 ms, in each direction: between
client, scheduler and workers alike. Rounds are interleaved and the best of them counts, since others may use the
machine; what they use does not matter to items that wait in place of computing, which show what handing out leaves.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import multiprocessing
import operator
import os
import resource
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import psutil
from distributed import Client

import inerter as it
from inerter.work import pieces
from inerter.work.pool import Pool

LATENCY = 0.05  # seconds, each way
POINTS = 48  # designs that the study optimises, about 0.8 s each
PIECES = 10_000
ALONE = 30.0  # seconds that the items which wait take one process
STUDY = """
[vehicle]
model = "quarter-car"
sprung_mass = "181.75 kg"
unsprung_mass = "25 kg"
tyre_stiffness = "120 kN/m"

[road]
speed = "25 m/s"
roughness = "5e-7 m^3/cycle"

[elements]
k = "120 kN/m"
c = {{ from = "100 N s/m", to = "100 kN s/m" }}
b = {{ from = "1 kg", to = "2000 kg" }}
f = "10 N"

[layouts]
S2 = "k | c | b | f"

[study]
indices = ["J1"]
optimise = "expected-value"
realisations = 2
sweep = {{ k = {{ from = "10 kN/m", to = "300 kN/m", points = {points} }} }}
"""


def study_of(points: int) -> it.Study:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "study.toml"
        path.write_text(STUDY.format(points=points), encoding="utf-8")
        return it.load_study(path)


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


async def forward(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, latency: float) -> None:
    """Pass on what comes, each chunk when its time has come, and many of them on their way at once."""
    loop, waiting = asyncio.get_running_loop(), asyncio.Queue[tuple[float, bytes]]()

    async def deliver() -> None:
        while True:
            due, chunk = await waiting.get()
            await asyncio.sleep(due - loop.time())
            if not chunk:
                writer.close()
                return
            writer.write(chunk)

    delivering = asyncio.create_task(deliver())
    try:
        chunk = b"first"
        while chunk:
            chunk = await reader.read(2**20)
            waiting.put_nowait((loop.time() + latency, chunk))
    except ConnectionError:
        waiting.put_nowait((loop.time() + latency, b""))
    await delivering


async def proxies(latency: float, pairs: list[tuple[int, int]]) -> None:
    """Forward the messages of the first port of each pair to the second, and the responses back."""

    async def connect(port: int, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while True:
            try:
                there, to = await asyncio.open_connection("127.0.0.1", port)
                break
            except OSError:  # it is about to listen
                await asyncio.sleep(0.1)
        await asyncio.gather(forward(reader, to, latency), forward(there, writer, latency))

    for listening, port in pairs:
        await asyncio.start_server(partial(connect, port), "127.0.0.1", listening)
    await asyncio.Event().wait()


@contextmanager
def process(*words: object) -> Iterator[subprocess.Popen[bytes]]:
    command = [sys.executable, *map(str, words)]
    started = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield started
    finally:
        started.terminate()
        started.wait()


class Cluster:
    """A scheduler and workers of dask, each a process, and a client; with latency, all reach each other by a proxy."""

    def __init__(self, stack: ExitStack, workers: int, latency: float = 0.0) -> None:
        home = stack.enter_context(TemporaryDirectory())
        ports = [free_port() for _ in range(workers + 1)]
        public = [free_port() for _ in ports] if latency else ports
        if latency:
            pairs = json.dumps(list(zip(public, ports, strict=True)))
            stack.enter_context(process(__file__, "--proxies", pairs, "--latency", latency))
        address = f"tcp://127.0.0.1:{public[0]}"
        scheduler = process("-m", "dask", "scheduler", "--host", "127.0.0.1", "--port", ports[0], "--no-dashboard")
        self.processes = [stack.enter_context(scheduler).pid]
        for port, seen in zip(ports[1:], public[1:], strict=True):
            where = ("--listen-address", f"tcp://127.0.0.1:{port}", "--contact-address", f"tcp://127.0.0.1:{seen}")
            alone = ("--nthreads", 1, "--no-nanny", "--no-dashboard", "--local-directory", home)
            worker = process("-m", "dask", "worker", address, *where, *alone)
            self.processes.append(stack.enter_context(worker).pid)
        self.client = stack.enter_context(Client(address, set_as_default=False, timeout="60s"))
        self.client.wait_for_workers(workers, timeout=60)
        self.executor = self.client.get_executor(pure=False)

    def cpu(self) -> list[float]:
        """Seconds of CPU that this process, the scheduler and each worker have used."""
        return [cpu_of(number) for number in (os.getpid(), *self.processes)]


def cpu_of(number: int) -> float:
    times = psutil.Process(number).cpu_times()
    return times.user + times.system


def children() -> list[int]:
    return [child.pid for child in multiprocessing.active_children() if child.pid is not None]


def time_of(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def cpu_used() -> float:
    """Seconds of CPU of this process and of those that it has started and that have ended."""
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


@dataclass(frozen=True)
class Run:
    seconds: float
    worked: float  # seconds that workers were at work on pieces, all together
    cpu: float  # seconds of CPU of this process and its own, their start included


def run_of(study: it.Study, **where: Any) -> Run:
    worked = list[float]()
    learn = pieces.Cutter.learn

    def learn_and_count(self: Any, piece: Any, seconds: float) -> None:
        worked.append(seconds)
        learn(self, piece, seconds)

    pieces.Cutter.learn = learn_and_count  # type: ignore[method-assign]
    try:
        with TemporaryDirectory() as folder:
            before = cpu_used()
            seconds = time_of(lambda: it.run_study(study, Path(folder) / "out", **where))
            return Run(seconds, sum(worked), cpu_used() - before)
    finally:
        pieces.Cutter.learn = learn  # type: ignore[method-assign]


def study_part(rounds: int) -> None:
    study, few = study_of(POINTS), study_of(2)
    with ExitStack() as stack:
        one, two, slow = Cluster(stack, 1), Cluster(stack, 2), Cluster(stack, 2, LATENCY)
        for cluster in (one, two, slow):  # workers have nothing loaded yet
            print(f"two designs on workers that are cold: {run_of(few, executor=cluster.executor).seconds:.1f} s")
        places: dict[str, dict[str, Any]] = {
            "own processes, 1": {"jobs": 1},
            "own processes, 2": {"jobs": 2},
            "dask, 1 worker": {"executor": one.executor},
            "dask, 2 workers": {"executor": two.executor},
            "dask, 2 workers, 50 ms a message": {"executor": slow.executor},
        }
        runs: dict[str, list[Run]] = {name: [] for name in places}
        for _ in range(rounds):
            for name, where in places.items():
                run = run_of(study, **where)
                runs[name].append(run)
                print(
                    f"   {name}: {run.seconds:.1f} s; pieces {run.worked:.1f} s; CPU here {run.cpu:.1f} s",
                    flush=True,
                )
    best = {name: min(found, key=lambda run: run.seconds) for name, found in runs.items()}
    for name, alone in (
        ("own processes, 2", "own processes, 1"),
        ("dask, 2 workers", "dask, 1 worker"),
        ("dask, 2 workers, 50 ms a message", "dask, 1 worker"),
    ):
        busy = max(run.worked / (2.0 * run.seconds) for run in runs[name])
        print(
            f"{name}: {best[name].seconds:.1f} s, one {best[alone].seconds:.1f} s: "
            f"{best[alone].seconds / best[name].seconds:.2f} times as fast; workers at work for {100.0 * busy:.0f} %"
        )


def waiting_part(rounds: int) -> None:
    with ExitStack() as stack:
        near, slow = Cluster(stack, 2), Cluster(stack, 2, LATENCY)
        pools = {
            "own processes": stack.enter_context(Pool(2)),
            "dask": stack.enter_context(Pool(executor=near.executor)),
            "dask, 50 ms a message": stack.enter_context(Pool(executor=slow.executor)),
        }
        for pool in pools.values():
            pool.begin(os.getpid)
            list(pool.spread(time.sleep, [0.01] * 20))
        for seconds in (0.01, 0.1, 1.0):
            items = [seconds] * round(ALONE / seconds)
            for name, pool in pools.items():
                least = min(
                    time_of(lambda pool=pool, items=items: list(pool.spread(time.sleep, items))) for _ in range(rounds)
                )
                print(
                    f"{len(items)} items of {seconds:g} s on 2, {name}: {ALONE / least:.2f} times as fast", flush=True
                )


def pieces_part(rounds: int) -> None:
    """Pieces of one item that takes no time, beside a study of as many designs: what is left is handing out."""
    work, worth = partial(operator.is_, study_of(PIECES)), pieces.WORTH
    pieces.WORTH = 0.0  # seconds that a piece is to take
    for _ in range(rounds):
        with Pool(2) as pool:
            pool.begin(os.getpid)
            measure_overhead(
                "own processes, 2", pool, work, worth, lambda: [cpu_of(os.getpid()), *map(cpu_of, children())]
            )
        with ExitStack() as stack:
            cluster = Cluster(stack, 2)
            pool = stack.enter_context(Pool(executor=cluster.executor))
            measure_overhead("dask, 2 workers", pool, work, worth, cluster.cpu)
    pieces.WORTH = worth


def measure_overhead(
    name: str, pool: Pool, work: Callable[[int], bool], worth: float, cpu: Callable[[], list[float]]
) -> None:
    for _ in pool.spread(work, range(200)):  # starts and loads everything
        pass
    before, begin = cpu(), time.perf_counter()
    assert sum(1 for _ in pool.spread(work, range(PIECES))) == PIECES
    passed, used = time.perf_counter() - begin, [after - was for was, after in zip(before, cpu(), strict=True)]
    each = [f"{1e3 * seconds / PIECES:.2f}" for seconds in used]
    share = sum(used) / (PIECES * worth)
    print(
        f"{name}: {PIECES} pieces in {passed:.1f} s; CPU a piece {' + '.join(each)} ms (coordinator, then the others): "
        f"{100.0 * share:.2f} % of the {worth:g} s that a piece is made for",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("parts", nargs="*", default=[])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--proxies", type=json.loads, help=argparse.SUPPRESS)
    parser.add_argument("--latency", type=float, default=LATENCY, help="seconds that a message takes, each way")
    asked = parser.parse_args()
    if asked.proxies:
        asyncio.run(proxies(asked.latency, asked.proxies))
        return
    for name, part in (("study", study_part), ("waiting", waiting_part), ("pieces", pieces_part)):
        if not asked.parts or name in asked.parts:
            part(asked.rounds)


if __name__ == "__main__":
    main()
