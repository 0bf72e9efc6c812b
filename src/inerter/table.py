"""A table of results: rows of texts under a caption, and how numbers get their texts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Cell:
    """A value, and a remark below it; `prose` is words, which may go over several lines."""

    text: str
    remark: str = ""
    strong: bool = False
    prose: bool = False


@dataclass(frozen=True)
class Row:
    """A row of a table; `status` is empty or what is wrong with its numbers."""

    label: str
    cells: list[Cell]
    strong: bool = False
    status: str = ""


@dataclass(frozen=True)
class Table:
    """A table with its caption; the first column holds the labels of the rows."""

    caption: str
    header: list[str]
    rows: list[Row]
    swept: bool = False
    failures: tuple[str, ...] = ()

    @property
    def judged(self) -> bool:
        """Whether the last column is a verdict on the others: it stays in sight."""
        return any(row.cells[-1].prose for row in self.rows if row.cells)


class Writer(Protocol):
    """A function that turns a number, its unit, its standard error and its relative error bound into text."""

    def __call__(self, value: float, unit: str, error: float = ..., bound: float = ...) -> str:
        """The number for people."""
        ...
