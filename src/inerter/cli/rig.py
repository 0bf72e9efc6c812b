"""Implementation of `inerter rig`."""

from __future__ import annotations

from pathlib import Path

from inerter.cli.interrupts import interruptible
from inerter.cli.streams import say
from inerter.errors import StudyError
from inerter.files.common.folder import check_single, single
from inerter.files.rig import KIND
from inerter.files.rig.loading import load_rig
from inerter.files.rig.running import record_of
from inerter.records.writers import WRITERS, write_record
from inerter.report.rig import rig_text


def rig(config: Path, output: Path, *, force: bool) -> None:
    """Run the virtual rig of a file, and write what its sensors read."""
    request = load_rig(config)
    inputs = (config, *request.signal.inputs)
    check_single(output, by=KIND.command, inputs=inputs, force=force)
    if output.suffix.lower() not in WRITERS:
        raise StudyError(f"{output}: records are written to {', '.join(WRITERS)}. Name a file with such a suffix.")
    with interruptible():
        record = record_of(config, request)
        with single(output, by=KIND.command, inputs=inputs, force=force) as draft:
            write_record(record, draft)
    print(rig_text(request, record))
    say(f"record: {output}")
