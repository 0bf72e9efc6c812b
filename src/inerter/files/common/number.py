"""A number of a study file, wherever it stands."""

from __future__ import annotations

from dataclasses import dataclass

from inerter.networks.elements import Value


@dataclass(frozen=True)
class Number:
    """The number at a place, in its SI unit; None where the file leaves it out."""

    unit: str
    words: str  # what it is, in sentences and on axes
    value: Value | None
    may_vanish: bool = False
    may_be_free: bool = False
    signed: bool = False  # whether it may be negative
