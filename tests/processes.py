"""What processes that tests have started take of the processor: a busy machine makes them late, but not that larger."""

from __future__ import annotations

import os
from pathlib import Path


def processor_time(pid: int) -> float:
    """Seconds that a process and those that it has waited for have taken so far; none if there is no such process."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")
