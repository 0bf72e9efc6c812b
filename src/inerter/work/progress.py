"""Progress of long work, as data: whoever computes reports steps, and whoever waits listens to them.

A listener is called at least once a second while it listens, whatever the work does meanwhile. Steps of our own
processes are passed on to it; other executors send nothing until a piece is done.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, replace
from threading import Event, RLock, Thread
from typing import Protocol

LOGGER = logging.getLogger("inerter")
_EVERY = 1.0  # seconds after which a listener is called, also where nothing new is known
_OFTEN = 0.1  # seconds between two calls about the same thing
_LONG = 2.0  # seconds after which work that nobody listens to is told of


@dataclass(frozen=True)
class ProgressStep:
    """How far long work is: `done` of `total` of what it counts, where `total` is 0 if that is not known.

    `within` names what it is part of, such as a design, the widest first; `best` is the lowest value of an index so
    far, in its SI unit; `evaluations` are those of the search that is under way. `share` is the part of that design
    that is done, as far as it can be known, and `seconds` is the time since the listener began to listen.
    """

    what: str
    done: int = 0
    total: int = 0
    best: float | None = None
    evaluations: int = 0
    within: tuple[str, ...] = ()
    share: float | None = None
    seconds: float = 0.0
    over: bool = False  # whether what it is part of has ended

    def __str__(self) -> str:
        """The step in one line, without the time."""
        count = f" {self.done} of {self.total}" if self.total else f" {self.done}" if self.done else ""
        evaluations = f", {self.evaluations} evaluations" if self.evaluations else ""
        best = "" if self.best is None else f", lowest {self.best:.4g}"
        return f"{': '.join((*self.within, self.what))}{count}{evaluations}{best}"


class Hearer(Protocol):
    """What steps are told to."""

    def tell(self, step: ProgressStep) -> None:
        """Take a step."""
        ...

    def evaluated(self) -> None:
        """Take one more evaluation of the search under way."""
        ...


class Listener:
    """Calls a function with steps, from a thread of its own if there are none for a second.

    What the function raises there is raised by the work at its next step.
    """

    def __init__(self, call: Callable[[ProgressStep], object], every: float = _EVERY) -> None:
        self._call, self._every = call, every
        self._lock, self._end = RLock(), Event()
        self._last, self._told = ProgressStep("preparing"), time.monotonic()
        self._begun, self._error = self._told, list[BaseException]()
        self._evaluations = 0

    @property
    def last(self) -> ProgressStep:
        """The last step."""
        return self._last

    def tell(self, step: ProgressStep) -> None:
        """Take a step, of which the function is told at once if it is about something new."""
        with self._lock:
            if self._error:
                raise self._error.pop()
            is_new = (step.what, step.within, step.over) != (self._last.what, self._last.within, self._last.over)
            self._last, self._evaluations = step, step.evaluations
            if is_new or time.monotonic() - self._told >= _OFTEN:
                self._pass_on()

    def evaluated(self) -> None:
        """Take one more evaluation of the search under way."""
        self._evaluations += 1
        if time.monotonic() - self._told >= _OFTEN:
            self.tell(replace(self._last, evaluations=self._evaluations))

    def _pass_on(self) -> None:
        self._told = time.monotonic()
        self._call(replace(self._last, seconds=self._told - self._begun))

    def _tick(self) -> None:
        while not self._end.wait(0.25 * self._every):
            with self._lock:
                if time.monotonic() - self._told < self._every or self._end.is_set():
                    continue
                try:
                    self._pass_on()
                except BaseException as error:  # for the thread that works
                    self._error.append(error)

    @contextmanager
    def ticking(self) -> Iterator[None]:
        """The function is called in this block also where no steps come."""
        thread = Thread(target=self._tick, daemon=True)
        thread.start()
        try:
            yield
        finally:
            self._end.set()


_LISTENER: ContextVar[Hearer | None] = ContextVar("listener", default=None)
_WITHIN: ContextVar[tuple[str, ...]] = ContextVar("within", default=())
_TOLD: ContextVar[bool] = ContextVar("told", default=False)
_SHARES: ContextVar[tuple[float, float]] = ContextVar("shares", default=(0.0, 1.0))


@contextmanager
def progress(callback: Callable[[ProgressStep], object]) -> Iterator[None]:
    """Have a function called with each `ProgressStep` of the work in this block, and at least once a second.

    It is called by the thread that works, or by one that waits meanwhile; what it raises ends the work. Without it,
    steps go to the logger `inerter` with the level INFO, if that is switched on.

    >>> import inerter as it
    >>> car = it.QuarterCar(181.75, 25, 120e3, strut=it.Spring(120e3) | it.Damper(it.free(1e3, 1e4)))
    >>> seen = []
    >>> with it.progress(seen.append):
    ...     found = it.optimise(car, it.RideComfort(it.Road(roughness=5e-7, speed=25)), it.Norm())
    >>> str(seen[0])
    'samples 0 of 128'
    """
    with listening(Listener(callback)):
        yield


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Steps of the work in this block are told to the listener."""
    before = _LISTENER.set(listener)
    try:
        with listener.ticking():
            yield
    finally:
        _LISTENER.reset(before)


@contextmanager
def heard(hearer: Hearer | None) -> Iterator[None]:
    """The same for what needs no thread, or for none."""
    before = _LISTENER.set(hearer)
    try:
        yield
    finally:
        _LISTENER.reset(before)


@contextmanager
def logged() -> Iterator[None]:
    """Steps of the work in this block are logged, if nobody listens to them and the logger takes them."""
    if _LISTENER.get() is not None or not LOGGER.isEnabledFor(logging.INFO):
        yield
        return
    with listening(Listener(_Log())):
        yield


class _Log:
    """A line of the log, once a second at most."""

    def __init__(self) -> None:
        self._last = -_EVERY

    def __call__(self, step: ProgressStep) -> None:
        if step.seconds - self._last >= 0.9 * _EVERY and not step.over:
            self._last = step.seconds
            LOGGER.info("%s, %.0f s", step, step.seconds)


def listener_here() -> Hearer | None:
    """What steps are told to, if anybody listens."""
    return _LISTENER.get()


def report(what: str, done: int = 0, total: int = 0, *, best: float | None = None, share: float | None = None) -> None:
    """Tell how far the work is, and which share of what it is part of is done, to whoever listens."""
    listener = _LISTENER.get()
    if listener is not None:
        low, high = _SHARES.get()
        part = None if share is None else low + (high - low) * share
        listener.tell(ProgressStep(what, done, total, best, within=_WITHIN.get(), share=part))


def counter(what: str, total: int) -> Callable[[float], None]:
    """A function that reports which part of so many is done; that none is, at once."""
    report(what, 0, total)
    return lambda part: report(what, round(part * total), total)


def evaluated() -> None:
    """Tell that a search has valued one more design."""
    listener = _LISTENER.get()
    if listener is not None:
        listener.evaluated()


@contextmanager
def within(name: str, first: float = 0.0, last: float = 1.0) -> Iterator[None]:
    """Steps in this block are part of what has that name, from the share `first` of all of it to the share `last`."""
    outer, (low, high) = _WITHIN.get(), _SHARES.get()
    names = _WITHIN.set((*outer, name))
    shares = _SHARES.set((low + (high - low) * first, low + (high - low) * last))
    try:
        yield
    finally:
        _WITHIN.reset(names)
        _SHARES.reset(shares)
        listener = _LISTENER.get()
        if listener is not None and not outer:
            listener.tell(ProgressStep("done", within=(name,), share=1.0, over=True))


@contextmanager
def told_if_long(text: str) -> Iterator[None]:
    """Work of the library's own, such as compiling, is told of if it takes long; inside such work it is told already.

    A listener is told once, and goes on by itself. Where nobody listens there is a warning in the log after 2, 4, 8
    seconds and so on, which appears on stderr where logging is not set up.
    """
    if _TOLD.get():
        yield
        return
    listener, done, told = _LISTENER.get(), Event(), Event()
    before = getattr(listener, "last", None)

    def tell() -> None:
        if listener is not None and not done.wait(0.5 * _LONG):
            told.set()
            with suppress(BaseException):  # which the listener raises to the work
                listener.tell(ProgressStep(text))
        wait = _LONG
        while listener is None and not done.wait(wait if wait == _LONG else 0.5 * wait):
            LOGGER.warning("inerter: %s, %.0f s so far; this happens once.", text, wait)
            wait *= 2.0

    inside = _TOLD.set(True)
    Thread(target=tell, daemon=True).start()
    try:
        yield
    finally:
        _TOLD.reset(inside)
        done.set()
        if told.is_set() and listener is not None and before is not None:
            listener.tell(before)
