"""A sign of life on stderr: whatever a command does, a line comes before two seconds of silence have gone by."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from inerter.formatting import format_duration
from inerter.work.progress import Listener, ProgressStep, listening

_SILENCE = 1.8  # seconds after which something is said, so that two have not gone by when it can be read
_LOOK = 0.4  # seconds between two looks at the clock
_SHORT, _LONG = 600.0, 3600.0  # seconds of work up to which a log has a line every two seconds, or every ten
_THEN = {_SHORT: 1.0, _LONG: 5.0}  # silences, as multiples, up to these
_SELDOM = 30.0
_open = 0  # displays of progress, of which the innermost alone is seen: it knows more than those around it


class Pulse:
    """Printer of the work under way after each period of silence.

    In a log that is two seconds in the first ten minutes, ten in the first hour and a minute afterwards.
    """

    def __init__(
        self,
        words: Callable[[ProgressStep], str],
        take: Callable[[ProgressStep], object] | None = None,
    ) -> None:
        self.words, self.take = words, take
        self.begun = self.printed = time.monotonic()
        self.level = _open

    def __call__(self, step: ProgressStep) -> None:
        if self.take is not None:
            self.take(step)
        if self.level != _open:
            self.printed = time.monotonic()  # by what is within
            return
        now = time.monotonic()
        factor = next((f for end, f in _THEN.items() if now - self.begun < end), _SELDOM)
        if now - self.printed >= _SILENCE * factor:
            self.say(f"{self.words(step)}, {format_duration(now - self.begun)} so far")

    def say(self, text: str) -> None:
        """Print a line."""
        self.printed = time.monotonic()
        print(text, file=sys.stderr, flush=True)


@contextmanager
def display() -> Iterator[None]:
    """Silence every pulse around this block, in which something else shows the progress."""
    global _open  # noqa: PLW0603
    _open += 1
    try:
        yield
    finally:
        _open -= 1


@contextmanager
def pulse(
    words: Callable[[ProgressStep], str], take: Callable[[ProgressStep], object] | None = None
) -> Iterator[Pulse]:
    """A printer of steps of the work in this block, in the given words and with the time, that can print more.

    `take` is called with every step, also where nothing is printed.
    """
    with display():
        printer = Pulse(words, take)
        with listening(Listener(printer, every=_LOOK)):
            yield printer


@contextmanager
def alive() -> Iterator[None]:
    """Pulse of a command that prints nothing else about its progress."""
    with pulse(lambda step: f"inerter: {step}"):
        yield
