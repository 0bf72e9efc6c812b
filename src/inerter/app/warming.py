"""How far the server is with getting ready: which kernels are compiled still."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inerter.app.calls import call

_LOOK = 0.1  # seconds between two looks at what happened


@dataclass
class Warming:
    """How far the kernels are, which another process compiles and tells in a file."""

    path: Path
    done: asyncio.Event = field(default_factory=asyncio.Event)

    async def run(self, worker: Executor) -> None:
        """Have them compiled; should that fail, each is compiled where it is called."""
        try:
            future = await asyncio.to_thread(worker.submit, call, "inerter.app.warm:warm", str(self.path))
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


def _lines(path: Path) -> list[dict[str, Any]]:
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return [json.loads(line) for line in text.splitlines(keepends=True) if line.endswith("\n")]
