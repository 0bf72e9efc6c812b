"""Request of a virtual-rig run, and its execution."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from inerter.errors import InerterError
from inerter.files.common.problem import at
from inerter.files.common.problems import refusal
from inerter.files.common.signals import SignalRequest
from inerter.identification.virtual_rig import VirtualRig
from inerter.records.record import Record


@dataclass(frozen=True)
class RigRequest:
    """Virtual rig, with the motion of its table and the duration of the measurement."""

    title: str
    rig: VirtualRig
    signal: SignalRequest
    duration: float  # [s]
    start: float  # [s]

    def check(self) -> int:
        """The number of samples; raises what `VirtualRig.run` would raise before it simulates."""
        return self.rig.check(self.signal.make(), self.duration, self.start)

    def run(self) -> Record:
        """Record of the sensors; raises what `VirtualRig.run` raises."""
        return self.rig.run(self.signal.make(), self.duration, self.start)


def record_of(path: Path, request: RigRequest) -> Record:
    """Record of the sensors; raises `StudyError` naming the file for a run that cannot be."""
    try:
        return request.run()
    except InerterError as error:
        raise refusal(path, [at(("rig",), str(error))]) from None
