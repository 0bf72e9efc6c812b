"""Tables of results: rows of texts under a caption, and the protocol of number formatting."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Cell:
    """Cell with a value and a remark below it; `prose` is text that may wrap over several lines."""

    text: str
    remark: str = ""
    strong: bool = False
    prose: bool = False


@dataclass(frozen=True)
class Row:
    """Row of a table; `status` is the problem of its numbers, empty if there is none."""

    label: str
    cells: list[Cell]
    strong: bool = False
    status: str = ""


@dataclass(frozen=True)
class Table:
    """Table with its caption; the first column contains the labels of the rows."""

    caption: str
    header: list[str]
    rows: list[Row]
    swept: bool = False
    failures: tuple[str, ...] = ()

    @property
    def has_verdict(self) -> bool:
        """Whether the last column is a verdict in words, which remains visible while the others scroll."""
        return any(row.cells[-1].prose for row in self.rows if row.cells)


class Writer(Protocol):
    """Function that formats a number with its unit, standard error and relative error bound."""

    def __call__(self, value: float, unit: str, *, error: float = ..., bound: float = ...) -> str:
        """Formatted number with its unit."""
        ...
