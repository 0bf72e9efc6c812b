"""Compiling what is missing before it is called: over several processes, and telling how far it is."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from threading import Lock, Thread
from typing import TYPE_CHECKING

from inerter.kernels.cache import is_kept, told
from inerter.kernels.decorators import TUNED, Kernel, way
from inerter.work.progress import ProgressStep, listener_here, told_if_long

if TYPE_CHECKING:
    from inerter.work.pool import Pool

Told = Callable[[str, int, int], None]  # title of the kernel that is begun, its number from 1, how many there are
_ALONE = Lock()
_SEEN: set[Kernel] = set()  # which this process need not look for again
_MOST = 4  # processes: there are few kernels, and the longest takes as long as all others
_HELPER = "from inerter.kernels.prepare import help_out; help_out()"


def prepare(kernels: Iterable[Kernel], progress: Told | None = None) -> None:
    """Compile those of `kernels` that are not kept on disk, those that take long first, if they come first.

    Other processes help with it, and what they do this one reads from the cache later. Should one fail, a kernel is
    compiled where it is called. `progress` is called when a kernel is begun; without it one line says what goes on.
    """
    wanted = [kernel for kernel in dict.fromkeys(kernels) if kernel not in _SEEN]
    if wanted and way() == TUNED:
        with _ALONE:
            missing = [kernel for kernel in wanted if not is_kept(kernel)]
            if missing:
                _compile(missing, progress)
            _SEEN.update(wanted)


def prepare_on(pool: Pool | None, kernels: Sequence[Kernel], progress: Told | None = None) -> None:
    """The same where work is done: once on each machine of a cluster, else here, for all processes of this machine."""
    if pool is None or not pool.on_each_node(prepare, kernels):
        prepare(kernels, progress)


def _compile(missing: list[Kernel], progress: Told | None) -> None:
    waiting, helpers = deque(enumerate(missing, 1)), min(os.cpu_count() or 1, _MOST, len(missing)) - 1
    listener = listener_here()

    def upcoming() -> Iterator[Kernel]:
        while waiting:
            with suppress(IndexError):  # another thread has taken the last
                number, kernel = waiting.popleft()
                if progress is not None:
                    progress(kernel.title, number, len(missing))
                if listener is not None:
                    listener.tell(ProgressStep(f"compiling kernels ({kernel.title})", number, len(missing)))
                yield kernel

    with told(progress is None), told_if_long("compiling the numerical kernels"), ExitStack() as stack:
        for _ in range(helpers):
            stack.enter_context(_helper(upcoming()))
        for kernel in upcoming():
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

    def feed() -> None:
        with suppress(OSError):  # it has ended
            while process.stdout.readline() and (kernel := next(kernels, None)):  # type: ignore[union-attr]
                print(kernel.function.__module__, kernel.function.__qualname__, file=process.stdin, flush=True)
        with suppress(OSError):
            process.stdin.close()  # type: ignore[union-attr]

    thread = Thread(target=feed, daemon=True)
    thread.start()
    try:
        yield
        thread.join()
        process.wait()
    finally:
        process.kill()
        process.wait()
        process.stdout.close()  # type: ignore[union-attr]


def help_out() -> None:
    """Compile what is asked for on standard input, a module and a name a line, and say each time that one is free."""
    print(flush=True)
    for line in sys.stdin:
        module, name = line.split()
        getattr(import_module(module), name).ready()
        print(flush=True)
