"""Worker queues that answer requests one at a time; a newer request of a page and panel supersedes older ones."""

from __future__ import annotations

import asyncio
from concurrent.futures import BrokenExecutor, Executor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from inerter.app.calls import load
from inerter.app.wire import Refusal, refusal_of

_PATIENCE = 2.0  # seconds that a call nobody waits for may go on before its process is ended
_MOST = 1000  # pages and panels whose newest request is known
Who = tuple[str, str]  # a page and a panel
Call = tuple[Any, ...]  # a function that gives a status and a body, and its arguments


@dataclass(eq=False)
class Waiting:
    """Waiting request, and the future of its answer."""

    call: Call
    sequence: float = 0.0
    answer: asyncio.Future[bytes] = field(default_factory=lambda: asyncio.get_running_loop().create_future())
    outdated: asyncio.Event = field(default_factory=asyncio.Event)

    def refuse(self, why: Refusal) -> None:
        """Answer with a refusal, unless already answered."""
        if not self.answer.done():
            self.answer.set_exception(why)

    def overtake(self) -> None:
        """Mark the request as superseded by a newer one."""
        self.refuse(out_of_date(self.sequence))
        self.outdated.set()


@dataclass
class Lane:
    """Worker process, and the queue of requests that wait for it."""

    homes: tuple[str, ...]  # modules that the process loads when it begins
    worker: Executor
    waiting: asyncio.Queue[Waiting] = field(default_factory=asyncio.Queue)

    async def answer(self, mine: Waiting) -> bytes:
        """Answer of a request, in the order of the queue."""
        self.waiting.put_nowait(mine)
        return await mine.answer

    async def work(self) -> None:
        """Answer the requests of the queue in order, without end."""
        while True:
            mine = await self.waiting.get()
            if not mine.outdated.is_set():
                await self._do(mine)

    async def begin(self) -> None:
        """Start the process, and import the modules of its answers."""
        with suppress(Exception):  # should it fail, so does the first request, which says why
            await (await self._submit((load, *self.homes)))

    async def _do(self, mine: Waiting) -> None:
        try:
            status, body = await self._await_call(mine)
        except BrokenExecutor:
            mine.refuse(Refusal(500, "The process of this answer ended unexpectedly; memory may have run out."))
        except TimeoutError:  # nobody waits for it
            await asyncio.to_thread(
                self.worker.shutdown, wait=False, cancel_futures=True
            )  # another begins in its place
        except Exception as error:
            mine.refuse(refusal_of(error))
        else:
            if status != 200:
                mine.refuse(Refusal(status, **body))
            elif not mine.answer.done():
                mine.answer.set_result(body)

    async def _submit(self, call: Call) -> asyncio.Future[Any]:
        """Future of the call in the process, which is started if necessary."""
        function, *args = call
        return asyncio.wrap_future(await asyncio.to_thread(partial(self.worker.submit, function, *args)))

    async def _await_call(self, mine: Waiting) -> tuple[int, Any]:
        """Status and body of the call; raises `TimeoutError` if that takes long, and nobody waits for it any more."""
        future = await self._submit(mine.call)
        overtaken = asyncio.create_task(mine.outdated.wait())
        try:
            await asyncio.wait((future, overtaken), return_when=asyncio.FIRST_COMPLETED)
            return await asyncio.wait_for(future, None if future.done() else _PATIENCE)
        finally:
            overtaken.cancel()


@dataclass
class Newest:
    """Latest request of each page and panel, across all worker queues."""

    known: dict[Who, Waiting] = field(default_factory=dict)

    async def ask(self, lane: Lane, who: Who, sequence: float, call: Call) -> bytes:
        """The answer of a call; raises `Refusal` if a newer one has come, or comes meanwhile."""
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


def out_of_date(sequence: float) -> Refusal:
    """Refusal of a request that a newer one has superseded."""
    return Refusal(409, "A newer request of this page has come.", outdated=True, sequence=sequence)
