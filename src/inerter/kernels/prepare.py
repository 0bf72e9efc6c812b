"""Compilation of missing kernels before they are called, over several processes, with progress."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from itertools import count
from threading import Lock, Thread
from typing import TYPE_CHECKING

from inerter.kernels.cache import announce_compilation, is_kept
from inerter.kernels.decorators import TUNED, Kernel, compiler_mode
from inerter.work.progress import ProgressStep, listener_here, report_if_long

if TYPE_CHECKING:
    from inerter.work.pool import Pool

ProgressCallback = Callable[[str, int, int], None]  # title of the kernel, its number, their total
_ALONE = Lock()
_SEEN: set[Kernel] = set()  # which this process need not look for again
_MOST = 4  # processes: there are few kernels, and the longest takes as long as all others
_HELPER = "from inerter.kernels.prepare import compile_requested; compile_requested()"


def prepare(kernels: Iterable[Kernel], progress: ProgressCallback | None = None) -> None:
    """Compile those of `kernels` that are not kept on disk, from both ends: those that take long come first.

    Other processes help with it, and what they do this one reads from the cache later. Should one fail, a kernel is
    compiled where it is called. Every other process begins at the end, so that neighbours are often compiled by one:
    parts that they share are typed once in each process. `progress` is called when a kernel is begun; without it one
    line announces the compilation.
    """
    wanted = [kernel for kernel in dict.fromkeys(kernels) if kernel not in _SEEN]
    if wanted and compiler_mode() == TUNED:
        with _ALONE:
            missing = [kernel for kernel in wanted if not is_kept(kernel)]
            if missing:
                _compile(missing, progress)
            _SEEN.update(wanted)


def prepare_on(pool: Pool | None, kernels: Sequence[Kernel], progress: ProgressCallback | None = None) -> None:
    """Prepare kernels where work runs: once on each machine of a cluster, else here for all local processes."""
    if pool is None or not pool.on_each_node(prepare, kernels):
        prepare(kernels, progress)


def _compile(missing: list[Kernel], progress: ProgressCallback | None) -> None:
    waiting, begun, helpers = deque(missing), count(1), min(os.cpu_count() or 1, _MOST, len(missing)) - 1
    listener = listener_here()

    def next_kernels(take: Callable[[], Kernel] = waiting.popleft) -> Iterator[Kernel]:
        while waiting:
            with suppress(IndexError):  # another thread has taken the last
                kernel, number = take(), next(begun)
                if progress is not None:
                    progress(kernel.title, number, len(missing))
                if listener is not None:
                    listener.tell(ProgressStep(f"compiling kernels ({kernel.title})", number, len(missing)))
                yield kernel

    with (
        announce_compilation(progress is None),
        report_if_long("compiling the numerical kernels"),
        ExitStack() as stack,
    ):
        for helper in range(helpers):
            stack.enter_context(_helper(next_kernels(waiting.popleft if helper % 2 else waiting.pop)))
        for kernel in next_kernels():
            kernel.ready()


@contextmanager
def _helper(kernels: Iterator[Kernel]) -> Iterator[None]:
    """Another process that compiles one kernel after another; the block waits for it at its end."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    pipe, nowhere = subprocess.PIPE, subprocess.DEVNULL
    try:
        process = subprocess.Popen(
            [sys.executable, "-c", _HELPER], env=environment, stdin=pipe, stdout=pipe, stderr=nowhere, text=True
        )
    except OSError:
        yield
        return

    def send_names() -> None:
        with suppress(OSError):  # it has ended
            while process.stdout.readline() and (kernel := next(kernels, None)):  # type: ignore[union-attr]
                print(kernel.function.__module__, kernel.function.__qualname__, file=process.stdin, flush=True)
        with suppress(OSError):
            process.stdin.close()  # type: ignore[union-attr]

    thread = Thread(target=send_names, daemon=True)
    thread.start()
    try:
        yield
        thread.join()
        process.wait()
    finally:
        process.kill()
        process.wait()
        process.stdout.close()  # type: ignore[union-attr]


def compile_requested() -> None:
    """Compile the kernels named on standard input (module and name in each line), with an empty line when ready."""
    print(flush=True)
    for line in sys.stdin:
        module, name = line.split()
        getattr(import_module(module), name).ready()
        print(flush=True)
