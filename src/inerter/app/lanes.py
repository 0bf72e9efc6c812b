"""Processes that answer requests one after another, and which requests: of the same page and panel the newest."""

from __future__ import annotations

import asyncio
from concurrent.futures import BrokenExecutor, Executor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from inerter.app.calls import load
from inerter.app.wire import Refused, refusal_of

_PATIENCE = 2.0  # seconds that a call nobody waits for may go on before its process is ended
_MOST = 1000  # pages and panels whose newest request is known
Who = tuple[str, str]  # a page and a panel
Call = tuple[Any, ...]  # a function that gives a status and a body, and its arguments


@dataclass(eq=False)
class Waiting:
    """A request, and what it is answered by."""

    call: Call
    sequence: float = 0.0
    answer: asyncio.Future[bytes] = field(default_factory=lambda: asyncio.get_running_loop().create_future())
    outdated: asyncio.Event = field(default_factory=asyncio.Event)

    def refuse(self, why: Refused) -> None:
        """Answer with a refusal, unless there is an answer already."""
        if not self.answer.done():
            self.answer.set_exception(why)

    def overtake(self) -> None:
        """A newer request has come: nobody waits for this one any more."""
        self.refuse(out_of_date(self.sequence))
        self.outdated.set()


@dataclass
class Lane:
    """One process, and the requests that wait for it."""

    homes: tuple[str, ...]  # modules that the process loads when it begins
    worker: Executor
    waiting: asyncio.Queue[Waiting] = field(default_factory=asyncio.Queue)

    async def answer(self, mine: Waiting) -> bytes:
        """The answer of a request, when its turn has come."""
        self.waiting.put_nowait(mine)
        return await mine.answer

    async def work(self) -> None:
        """Answer what waits, the first first, for ever."""
        while True:
            mine = await self.waiting.get()
            if not mine.outdated.is_set():
                await self._do(mine)

    async def begin(self) -> None:
        """Have the process begin, and load what it answers with."""
        with suppress(Exception):  # should it fail, so does the first request, which says why
            await (await self._submitted((load, *self.homes)))

    async def _do(self, mine: Waiting) -> None:
        try:
            status, body = await self._called(mine)
        except BrokenExecutor:
            mine.refuse(Refused(500, "The process of this answer ended unexpectedly; memory may have run out."))
        except TimeoutError:  # nobody waits for it
            await asyncio.to_thread(
                self.worker.shutdown, wait=False, cancel_futures=True
            )  # another begins in its place
        except Exception as error:
            mine.refuse(refusal_of(error))
        else:
            if status != 200:
                mine.refuse(Refused(status, **body))
            elif not mine.answer.done():
                mine.answer.set_result(body)

    async def _submitted(self, call: Call) -> asyncio.Future[Any]:
        """The call, handed to the process, which may have to begin first."""
        function, *args = call
        return asyncio.wrap_future(await asyncio.to_thread(partial(self.worker.submit, function, *args)))

    async def _called(self, mine: Waiting) -> tuple[int, Any]:
        """What the call gives; raises `TimeoutError` if that takes long, and nobody waits for it any more."""
        future = await self._submitted(mine.call)
        overtaken = asyncio.create_task(mine.outdated.wait())
        try:
            await asyncio.wait((future, overtaken), return_when=asyncio.FIRST_COMPLETED)
            return await asyncio.wait_for(future, None if future.done() else _PATIENCE)
        finally:
            overtaken.cancel()


@dataclass
class Newest:
    """The newest request of each page and panel, on whichever lane it is."""

    known: dict[Who, Waiting] = field(default_factory=dict)

    async def ask(self, lane: Lane, who: Who, sequence: float, call: Call) -> bytes:
        """The answer of a call; raises `Refused` if a newer one has come, or comes meanwhile."""
        mine, before = Waiting(call, sequence), self.known.pop(who, None)
        if before is not None and before.sequence > sequence:
            self.known[who] = before
            raise out_of_date(sequence)
        if before is not None:
            before.overtake()
        if len(self.known) >= _MOST:
            del self.known[next(iter(self.known))]
        self.known[who] = mine
        return await lane.answer(mine)


def out_of_date(sequence: float) -> Refused:
    """What answers a request that a newer one has overtaken."""
    return Refused(409, "A newer request of this page has come.", outdated=True, sequence=sequence)
