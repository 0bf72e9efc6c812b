"""Values of elements: a number, or one that an optimiser may choose; and names."""

from __future__ import annotations

import re
from dataclasses import dataclass

from inerter.checks import is_number
from inerter.errors import NetworkError

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(frozen=True)
class Free:
    """A value that an optimiser may choose between two bounds. Two of the same name are one variable."""

    lower: float
    upper: float
    name: str | None = None

    def __post_init__(self) -> None:
        for bound in (self.lower, self.upper):
            if not is_number(bound):
                raise NetworkError(f"A bound of a free value must be a finite number, got {bound!r}.")
        if not 0.0 <= self.lower < self.upper:
            raise NetworkError(
                f"The bounds of a free value must satisfy 0 <= lower < upper, got lower = {self.lower:g} and "
                f"upper = {self.upper:g}. Swap them if they are reversed; to fix the value, give the number itself."
            )
        check_name(self.name)


def free(lower: float, upper: float, name: str | None = None) -> Free:
    """A design variable between `lower` and `upper`, in the unit of the element that it is given to.

    Raises `NetworkError` unless 0 <= lower < upper, both finite.
    """
    return Free(lower, upper, name)


Value = float | Free


def check_name(name: object) -> None:
    """Raises `NetworkError` unless `name` can stand in an expression; there need not be one."""
    if name is not None and (not isinstance(name, str) or not NAME.fullmatch(name)):
        raise NetworkError(f"A name is a letter followed by letters, digits and underscores, got {name!r}.")
