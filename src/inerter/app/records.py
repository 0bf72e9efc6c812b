"""Measured records that were sent, on disk."""

from __future__ import annotations

import re
import shutil
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path
from secrets import token_hex

from inerter.app.wire import Refusal

_MOST = 100  # that are kept


@dataclass
class Records:
    """Uploaded records, by their ids."""

    root: Path
    known: dict[str, Path] = field(default_factory=dict)

    async def take(self, name: str, body: AsyncIterator[bytes]) -> str:
        """Write an uploaded record to a file in chunks, and return its id; raises `Refusal` if there are too many."""
        if len(self.known) >= _MOST:
            raise Refusal(400, f"There are {_MOST} records already. Delete some of them first.")
        number = token_hex(8)
        folder = self.root / number
        folder.mkdir(parents=True)
        path = folder / _harmless(name)
        try:
            with path.open("wb") as stream:
                async for chunk in body:
                    stream.write(chunk)
                    stream.flush()
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        self.known[number] = path
        return number

    def get(self, number: str) -> Path:
        """File of a record; raises `Refusal` if there is none of that id."""
        if number not in self.known:
            raise Refusal(404, "Unknown record: it was deleted, or the server was restarted.")
        return self.known[number]

    def forget(self, number: str) -> None:
        """Delete a record."""
        shutil.rmtree(self.get(number).parent, ignore_errors=True)
        del self.known[number]


def _harmless(name: str) -> str:
    """A name of a file that leads nowhere else, with the same ending."""
    last = re.split(r"[/\\]", name)[-1]
    stem, dot, ending = last.rpartition(".")
    plain = re.sub(r"[^\w+-]", "_", stem if dot else ending)[:80] or "record"
    return plain + (f".{re.sub(r'[^A-Za-z0-9]', '', ending)[:8]}" if dot else "")
