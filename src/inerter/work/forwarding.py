"""Forwarding of progress steps and kept rows from worker processes to the main process."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace

from inerter.work.checkpoints import Checkpoint, forward_checkpoint, storing_checkpoints
from inerter.work.progress import ProgressStep, listener_here, receiving_steps

_OFTEN = 0.25  # seconds between two steps of one process
_SEND: list[Callable[[object], object]] = []  # of a process of ours


def forward_to(send: Callable[[object], object]) -> None:
    """Send all messages of this worker process to its parent."""
    _SEND[:] = [send]


class _Sender:
    """Sender of steps at a limited rate."""

    def __init__(self, send: Callable[[object], object]) -> None:
        self.send, self.step, self.evaluations = send, ProgressStep(""), 0
        self.told, self.sent = 0.0, False

    def tell(self, step: ProgressStep) -> None:
        self.step, self.evaluations = step, step.evaluations
        if step.over and not self.sent:  # its beginning was not sent either
            return
        if step.over or time.monotonic() - self.told >= _OFTEN:
            self.told, self.sent = time.monotonic(), not step.over
            self.send(step)

    def count_evaluation(self) -> None:
        self.evaluations += 1
        if time.monotonic() - self.told >= _OFTEN:
            self.tell(replace(self.step, evaluations=self.evaluations))


def _send(message: object) -> None:
    with suppress(OSError, ValueError):  # nobody reads it any more
        _SEND[0](message)


@contextmanager
def forwarding() -> Iterator[None]:
    """Forward messages of the work in this block, if this is a worker process."""
    if not _SEND:
        yield
        return
    with receiving_steps(_Sender(_send)), storing_checkpoints(_send):
        yield


def receive(message: object) -> None:
    """Pass a message of a worker process to the listener, or keep its rows."""
    if isinstance(message, Checkpoint):
        forward_checkpoint(message)
        return
    listener = listener_here()
    if isinstance(message, ProgressStep) and listener is not None:
        listener.tell(message)
