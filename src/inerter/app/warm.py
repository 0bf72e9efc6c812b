"""Getting ready: compiling what panels call, and telling how far that is."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.indices.registry import INDICES, make_index
from inerter.kernels.prepare import prepare
from inerter.methods.method import Compiled
from inerter.methods.registry import METHODS, is_blind, searches
from inerter.networks.elements import Damper, Friction, Inerter, Spring, free
from inerter.networks.parser import network
from inerter.signals.road import Road
from inerter.vehicle.quarter_car import QuarterCar
from inerter.work.processes import Processes

_LOOK = 0.1  # seconds between two looks at what happened


@dataclass
class Warming:
    """How far the kernels are, which another process compiles and tells in a file."""

    path: Path
    done: asyncio.Event = field(default_factory=asyncio.Event)

    async def run(self, worker: Processes) -> None:
        """Have them compiled; should that fail, each is compiled where it is called."""
        try:
            future = await asyncio.to_thread(worker.submit, warm, str(self.path))
            await asyncio.wrap_future(future)
        except Exception:
            with suppress(OSError):
                self.path.unlink(missing_ok=True)
        finally:
            self.done.set()

    async def wait(self) -> None:
        """Wait until they are compiled."""
        await self.done.wait()

    def told(self) -> dict[str, Any]:
        """Whether they are ready, and which one is under way."""
        last = (_lines(self.path) or [{"title": "", "number": 0, "total": 0}])[-1]
        return {"ready": self.done.is_set(), **last}

    async def events(self) -> AsyncIterator[tuple[int, dict[str, Any]]]:
        """Each kernel as it is begun, then that all are ready."""
        seen = 0
        while True:
            over = self.done.is_set()
            for line in _lines(self.path)[seen:]:
                seen += 1
                yield seen, {"event": "kernels", **line}
            if over:
                yield seen + 1, {"event": "ready"}
                return
            with suppress(TimeoutError):
                await asyncio.wait_for(self.done.wait(), _LOOK)


def warm(told: str) -> None:
    """Compile what panels call, the linear first, and write to the file `told`, a line each, which kernel is begun."""
    with Path(told).open("a", encoding="utf-8") as stream:

        def tell(title: str, number: int, total: int) -> None:
            stream.write(json.dumps({"title": title, "number": number, "total": total}) + "\n")
            stream.flush()

        prepare(dict.fromkeys(_kernels()), tell)


def _lines(path: Path) -> list[dict[str, Any]]:
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return [json.loads(line) for line in text.splitlines(keepends=True) if line.endswith("\n")]


def _kernels() -> Iterator[Any]:
    parts = {"k": Spring(1e5), "c": Damper(free(1e2, 1e5)), "b": Inerter(1e2), "f": Friction(10.0)}
    car = QuarterCar(250.0, 35.0, 150e3, strut=network("k | c - (b | f)", **parts)).mechanism()
    for name in sorted(METHODS, key=is_blind, reverse=True):
        yield from _of_method(name, car)


def _of_method(name: str, car: Any) -> Iterator[Any]:
    kind: Callable[..., Any] = METHODS[name]
    for symbol in INDICES:
        try:
            method = kind()
            question = make_index(symbol, Road(roughness=5e-7, speed=25.0), {}).question(car)
            if isinstance(method, Compiled):
                yield from method.kernels(question, search=searches(name))
        except (InerterError, TypeError):  # what needs settings is compiled when it is called
            continue
