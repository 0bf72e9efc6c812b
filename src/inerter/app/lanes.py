"""Processes that answer panels, and which of the waiting requests: of the same page and panel the newest."""

from __future__ import annotations

import asyncio
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from inerter.app.calls import load
from inerter.app.wire import Refused, refusal_of
from inerter.work.processes import Processes

_PATIENCE = 2.0  # seconds that a call nobody waits for may go on before its process is ended


@dataclass
class Waiting:
    """A request, what it is answered by, and whether anybody still waits for it."""

    sequence: float
    call: tuple[Any, ...]
    answer: asyncio.Future[bytes]


@dataclass
class Lane:
    """One process, and the requests that wait for it, one for each page and panel."""

    homes: tuple[str, ...]  # modules that the process loads when it begins
    worker: Processes = field(default_factory=lambda: Processes(1))
    waiting: dict[tuple[str, str], Waiting] = field(default_factory=dict)
    running: tuple[tuple[str, str], Waiting] | None = None
    outdated: asyncio.Event = field(default_factory=asyncio.Event)
    _something: asyncio.Event = field(default_factory=asyncio.Event)

    async def ask(self, who: tuple[str, str], sequence: float, call: tuple[Any, ...]) -> bytes:
        """The answer of a call; raises `Refused` if a newer one of the same page and panel has come."""
        mine = Waiting(sequence, call, asyncio.get_running_loop().create_future())
        others = [self.waiting.get(who), self.running[1] if self.running and self.running[0] == who else None]
        if any(other is not None and other.sequence > sequence for other in others):
            raise out_of_date(sequence)
        for other in others:
            if other is not None:
                _refuse(other, out_of_date(other.sequence))
        self.waiting.pop(who, None)
        self.waiting[who] = mine
        if others[1] is not None:
            self.outdated.set()
        self._something.set()
        return await mine.answer

    async def work(self) -> None:
        """Answer what waits, the first first, for ever."""
        while True:
            while not self.waiting:
                self._something.clear()
                await self._something.wait()
            who = next(iter(self.waiting))
            self.running = who, self.waiting.pop(who)
            self.outdated.clear()
            await self._answer(self.running[1])
            self.running = None

    async def _answer(self, mine: Waiting) -> None:
        try:
            future = asyncio.wrap_future(self.worker.submit(*mine.call))
            stale = asyncio.ensure_future(self.outdated.wait())
            await asyncio.wait((future, stale), return_when=asyncio.FIRST_COMPLETED)
            if not future.done():
                await asyncio.wait((future,), timeout=_PATIENCE)
            stale.cancel()
            if not future.done():
                future.cancel()
                await asyncio.to_thread(self.renew)
                return
            status, body = future.result()
        except BrokenExecutor:
            _refuse(mine, Refused(500, "The process that worked on this has ended, perhaps for want of memory."))
        except Exception as error:
            _refuse(mine, refusal_of(error))
        else:
            if not mine.answer.done():
                if status == 200:
                    mine.answer.set_result(body)
                else:
                    mine.answer.set_exception(Refused(status, **body))

    async def begin(self) -> None:
        """Have the process begin, and load what it answers with."""
        with suppress(Exception):  # should it fail, so does the first request, which says why
            await asyncio.wrap_future(await asyncio.to_thread(self.worker.submit, load, *self.homes))

    def renew(self) -> None:
        """End the process, whatever it does; another begins when it is needed."""
        self.worker.shutdown(wait=False, cancel_futures=True)


def out_of_date(sequence: float) -> Refused:
    """What answers a request that a newer one has overtaken."""
    return Refused(409, "A newer request of this page has come.", outdated=True, sequence=sequence)


def _refuse(waiting: Waiting, why: Refused) -> None:
    if not waiting.answer.done():
        waiting.answer.set_exception(why)
