"""What is worth saying about a record."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

Severity = Literal["info", "warning", "error"]


@dataclass(frozen=True)
class Finding:
    """One thing found in a record.

    `error`: no model can be fitted to it as it is; `warning`: the work can go on, but look; `info`: good to know.
    """

    kind: str
    severity: Severity
    sentence: str
    numbers: dict[str, float] = field(default_factory=dict)
