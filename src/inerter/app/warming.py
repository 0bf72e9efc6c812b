"""Progress of the kernel compilation in a worker process."""

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
    """Progress of the kernel compilation, which a worker process writes to a file."""

    path: Path
    done: asyncio.Event = field(default_factory=asyncio.Event)

    async def run(self, worker: Executor) -> None:
        """Have the kernels compiled; if the compilation fails, each is compiled at its first call."""
        try:
            future = await asyncio.to_thread(worker.submit, call, "inerter.app.warm:warm", str(self.path))
            await asyncio.wrap_future(future)
        except Exception:
            with suppress(OSError):
                self.path.unlink(missing_ok=True)
        finally:
            self.done.set()

    async def wait(self) -> None:
        """Wait until the kernels are compiled."""
        await self.done.wait()

    def to_dict(self) -> dict[str, Any]:
        """Whether the kernels are compiled, and the one being compiled."""
        last = (_lines(self.path) or [{"title": "", "number": 0, "total": 0}])[-1]
        return {"ready": self.done.is_set(), **last}

    async def events(self) -> AsyncIterator[tuple[int, dict[str, Any]]]:
        """Events of the compilation: each kernel as it begins, then the end."""
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
