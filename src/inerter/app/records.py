"""Measured records that were sent: on disk, and what was found in them."""

from __future__ import annotations

import re
import shutil
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path
from secrets import token_hex
from typing import Any

from inerter.app.wire import Refused
from inerter.figures.curves import thinned
from inerter.files.identification.loading import RecordRequest
from inerter.files.identification.running import read
from inerter.records.readers import FORMATS
from inerter.units import shown

_MOST = 100  # that are kept
_SHOWN = 2000  # samples of a channel


@dataclass
class Records:
    """The records that there are, by their ids."""

    root: Path
    known: dict[str, Path] = field(default_factory=dict)

    async def take(self, name: str, body: AsyncIterator[bytes]) -> str:
        """Write what comes to a file, piece by piece; raises `Refused` for a name of no kind of record."""
        ending = Path(name).suffix.lower()
        if ending not in FORMATS:
            known = ", ".join(FORMATS)
            raise Refused(400, f"Got a file named {shown(name)}; a record is a file that ends in one of {known}.")
        if len(self.known) >= _MOST:
            raise Refused(400, f"There are {_MOST} records already. Delete some of them first.")
        number = token_hex(8)
        folder = self.root / number
        folder.mkdir(parents=True)
        path = folder / f"{_harmless(Path(name).stem)}{ending}"
        try:
            with path.open("wb") as stream:
                async for chunk in body:
                    stream.write(chunk)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        self.known[number] = path
        return number

    def get(self, number: str) -> Path:
        """The file of a record; raises `Refused` if there is none of that id."""
        if number not in self.known:
            raise Refused(404, "There is no such record; perhaps it was deleted, or the server has begun afresh.")
        return self.known[number]

    def forget(self, number: str) -> None:
        """Delete a record."""
        shutil.rmtree(self.get(number).parent, ignore_errors=True)
        del self.known[number]


def found_in(path: str) -> dict[str, Any]:
    """What is in a record, and what is worth knowing about it.

    Raises `RecordError` for a file that cannot be used.
    """
    reading = read(Path(path), RecordRequest())
    record = reading.received
    return {
        "name": record.source,
        "samples": int(record.time.size),
        "duration": float(record.time[-1] - record.time[0]),
        "channels": [
            dict(zip(("name", "time", "values"), (name, *thinned(record.time, values, _SHOWN)), strict=True))
            for name, values in record.channels().items()
            if name != "time"
        ],
        "notes": list(record.notes),
        "findings": [{"severity": f.severity, "about": f.about, "sentence": f.sentence} for f in reading.findings],
    }


def _harmless(name: str) -> str:
    return re.sub(r"[^\w.+-]", "_", name).strip(".")[:80] or "record"
