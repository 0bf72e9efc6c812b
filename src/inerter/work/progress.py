"""Progress of long computations, as data: computations report steps to listeners.

A listener is called at least once a second. Steps of worker processes are forwarded to it; other executors send nothing
until a chunk is completed.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from contextvars import ContextVar
from dataclasses import dataclass, replace
from threading import Event, RLock, Thread
from typing import Protocol

from inerter.formatting import format_count, format_number

LOGGER = logging.getLogger("inerter")
_EVERY = 1.0  # seconds after which a listener is called, also without a new step
_OFTEN = 0.1  # least seconds between two calls for the same step
_LONG = 2.0  # seconds after which work without a listener is logged


@dataclass(frozen=True)
class ProgressStep:
    """A progress step: `done` of `total` items; `total` is 0 if unknown.

    `within` names the enclosing computations, such as a design, outermost first; `best` is the lowest value of an index
    so far, in its SI unit; `evaluations` are those of the running search. `share` is the completed share of the design,
    if known, and `seconds` is the time since the start of the listener. `what` is empty where a computation begins.

    >>> import inerter as it
    >>> step = it.ProgressStep("search: starts", done=2, total=16)
    >>> step.done / step.total
    0.125
    >>> print(it.ProgressStep("starts", evaluations=1))
    starts, 1 evaluation
    """

    what: str
    done: int = 0
    total: int = 0
    best: float | None = None
    evaluations: int = 0
    within: tuple[str, ...] = ()
    share: float | None = None
    seconds: float = 0.0
    over: bool = False  # whether the enclosing computation has ended

    def __str__(self) -> str:
        """The step in one line, without the time."""
        count = f" {self.done} of {self.total}" if self.total else f" {self.done}" if self.done else ""
        evaluations = f", {format_count(self.evaluations, 'evaluations')}" if self.evaluations else ""
        best = "" if self.best is None else f", lowest {format_number(self.best, 4)}"
        return f"{': '.join(filter(None, (*self.within, self.what)))}{count}{evaluations}{best}"


class Hearer(Protocol):
    """Protocol of a receiver of steps."""

    def tell(self, step: ProgressStep) -> None:
        """Receive a step."""
        ...

    def count_evaluation(self) -> None:
        """Take one more evaluation of the search under way."""
        ...


class Listener:
    """Call a function with steps, from a separate thread if there are none for a second.

    An exception of the function there is raised by the computation at its next step.
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
        """Receive a step, and pass it on at once if it is new."""
        with self._lock:
            if self._error:
                raise self._error.pop()
            is_new = (step.what, step.within, step.over) != (self._last.what, self._last.within, self._last.over)
            self._last, self._evaluations = step, step.evaluations
            if is_new or time.monotonic() - self._told >= _OFTEN:
                self._pass_on()

    def count_evaluation(self) -> None:
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
                except BaseException as error:  # for the computing thread
                    self._error.append(error)

    @contextmanager
    def ticking(self) -> Iterator[None]:
        """Call the function in this block also without steps."""
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
    """Call a function with each `ProgressStep` of the work in this block, and at least once a second.

    It is called by the computing thread, or by a waiting one; its exceptions end the work. Without it, steps are logged
    to the logger `inerter` at level INFO, if enabled.

    >>> import inerter as it
    >>> car = it.QuarterCar(181.75, 25, 120e3, strut=it.Spring(120e3) | it.Damper(it.free(1e3, 1e4)))
    >>> seen = []
    >>> with it.progress(seen.append):
    ...     found = it.optimise(car, it.RideComfort(it.Road(roughness=5e-7, speed=25)), it.Norm())
    >>> str(seen[0])
    'starts 0 of 8'
    """
    with listening(Listener(callback)):
        yield


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Send steps of the work in this block to the listener."""
    before = _LISTENER.set(listener)
    try:
        with listener.ticking():
            yield
    finally:
        _LISTENER.reset(before)


@contextmanager
def receiving_steps(hearer: Hearer | None) -> Iterator[None]:
    """Send steps of the work in this block to a receiver without thread, or to none."""
    before = _LISTENER.set(hearer)
    try:
        yield
    finally:
        _LISTENER.reset(before)


def logging_steps() -> AbstractContextManager[None]:
    """Log steps of the work in a block, if there is no listener and logging is enabled."""
    is_logged = _LISTENER.get() is None and LOGGER.isEnabledFor(logging.INFO)
    return listening(Listener(_Log())) if is_logged else nullcontext()


class _Log:
    """Log of steps, at most one line a second."""

    def __init__(self) -> None:
        self._last = -_EVERY

    def __call__(self, step: ProgressStep) -> None:
        if step.seconds - self._last >= 0.9 * _EVERY and not step.over:
            self._last = step.seconds
            LOGGER.info("%s, %.0f s", step, step.seconds)


def listener_here() -> Hearer | None:
    """Current receiver of steps, if any."""
    return _LISTENER.get()


def report(what: str, done: int = 0, total: int = 0, *, best: float | None = None, share: float | None = None) -> None:
    """Report a step, and the completed share of the enclosing computation, to the listener."""
    listener = _LISTENER.get()
    if listener is not None:
        low, high = _SHARES.get()
        part = None if share is None else low + (high - low) * share
        listener.tell(ProgressStep(what, done, total, best, within=_WITHIN.get(), share=part))


def counter(what: str, total: int, also: Callable[[float], None] | None = None) -> Callable[[float], None]:
    """A function that reports the completed part of `total`, and passes it on; zero is reported at once."""
    report(what, 0, total)

    def take(done: float) -> None:
        report(what, round(done * total), total)
        if also is not None:
            also(done)

    return take


def part(progress: Callable[[float], None] | None, first: float, last: float) -> Callable[[float], None] | None:
    """A callback for work that takes `progress` from `first` to `last`."""
    return None if progress is None else lambda done: progress(first + (last - first) * done)


def count_evaluation() -> None:
    """Report one more evaluation of a search."""
    listener = _LISTENER.get()
    if listener is not None:
        listener.count_evaluation()


@contextmanager
def within(name: str, first: float = 0.0, last: float = 1.0) -> Iterator[None]:
    """Nest steps in this block under a name, between the shares `first` and `last` of the enclosing computation."""
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
def report_if_long(text: str) -> Iterator[None]:
    """Report internal work, such as compilation, if it takes long, unless nested in such work.

    A listener is told once, and repeats the step. Without a listener there is a warning in the log after 2, 4, 8
    seconds and so on, which appears on stderr where logging is not configured.
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
