"""State of a server: its processes, jobs and uploaded records."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from concurrent.futures import Executor
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inerter.app.calls import call
from inerter.app.jobs import Jobs
from inerter.app.lanes import Lane, Newest, Waiting
from inerter.app.records import Records
from inerter.app.start import InitialStudy
from inerter.app.warming import Warming
from inerter.app.wire import Refusal
from inerter.work.processes import Processes

_LANES = {  # norms; what simulates; records, figures and tables
    "quick": ("inerter.app.answers",),
    "slow": ("inerter.app.answers",),
    "aside": ("inerter.app.record_findings", "inerter.app.pictures", "inerter.app.tables"),
}


@dataclass
class Server:
    """State of a server: the initial study, its processes, jobs and uploaded records."""

    root: Path  # the folder of long work and records
    start: InitialStudy  # the study of the command line
    process: Callable[[], Executor] = lambda: Processes(1)  # what lanes and long work are done by
    quick: Executor | None = None  # one that has begun already, for the first lane
    newest: Newest = field(default_factory=Newest)
    lanes: dict[str, Lane] = field(init=False)
    jobs: Jobs = field(init=False)
    records: Records = field(init=False)
    warming: Warming = field(init=False)

    def __post_init__(self) -> None:
        self.lanes = {name: Lane(homes, self.process()) for name, homes in _LANES.items()}
        self.lanes["quick"].worker = self.quick or self.lanes["quick"].worker
        self.jobs, self.records = Jobs(self.root / "work", self.process()), Records(self.root / "records")
        self.warming = Warming(self.root / "kernels.jsonl")

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Context in which the processes of the server run."""
        tasks = [asyncio.create_task(lane.work()) for lane in self.lanes.values()]
        tasks += [asyncio.create_task(self.jobs.run()), asyncio.create_task(self._get_ready())]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            workers = [*(lane.worker for lane in self.lanes.values()), self.jobs.worker]
            for worker in workers:
                await asyncio.to_thread(worker.shutdown, wait=False, cancel_futures=True)

    async def _get_ready(self) -> None:
        await asyncio.gather(self._begin_quick(), self.warming.run(self.jobs.worker))
        await self.lanes["slow"].begin()

    async def _begin_quick(self) -> None:
        await self.lanes["quick"].begin()
        if study := self.start.document["study"]:  # none of a file that cannot be read
            with suppress(Refusal):  # the structures of its designs are found before a page asks
                await self.check(study)

    async def check(self, study: dict[str, Any]) -> bytes:
        """Problems, places and struts of a study document, found without computing an index."""
        settings = study.get("study")
        swept = isinstance(settings, dict) and bool(settings.get("sweep"))  # then layouts are tried at many values
        checking = Waiting((call, "inerter.app.study_check:check_document", study))
        return await self.lanes["slow" if swept else "quick"].answer(checking)

    async def aside(self, home: str, *args: Any) -> bytes:
        """Answer of the function named `home`, computed in the process for occasional requests."""
        return await self.lanes["aside"].answer(Waiting((call, home, *args)))
