"""Channel headings as programs write them: a name, its unit, and remarks in brackets."""

from __future__ import annotations

import re

from inerter.records.channel_units import is_unit_of_any_role
from inerter.units import is_unit

_BRACKET = re.compile(r"\[([^\[\]]*)\]|\(([^()]*(?:\([^()]*\)[^()]*)*)\)")
_BESIDE = re.compile(r"(\S.*?)(?:\s*/\s*|\s+in\s+)(\S+)")  # "F / N" as in DIN 461, "Kraft in kN"
_POWER = re.compile(r"(?<=[A-Za-z])([23])(?!\w)")
_OTHERS = frozenset({"", "-", "--", "1", "%", "°", "°c", "bit", "counts", "kg", "lb"})  # units of other columns


def is_unit_cell(cell: str) -> bool:
    """Whether a cell is a unit, with or without brackets, or stands for none.

    >>> is_unit_cell("[kN]"), is_unit_cell("m/s2"), is_unit_cell(""), is_unit_cell("Kraft")
    (True, True, True, False)
    """
    text = cell.strip(" []()")
    return text.casefold() in _OTHERS or is_unit_of_any_role(text) or is_unit(_POWER.sub(r"^\1", text))


def split_heading(cell: str) -> tuple[str, str, str]:
    """Name in a heading, unit, and name without remarks in brackets.

    >>> split_heading("Kraft (vorn) [kN]"), split_heading("Kraft [kN] (vorn)"), split_heading("Weg in mm")
    (('Kraft (vorn)', 'kN', 'Kraft'), ('Kraft (vorn)', 'kN', 'Kraft'), ('Weg', 'mm', 'Weg'))
    >>> split_heading("Kraft (vorn)"), split_heading("F / N")
    (('Kraft (vorn)', '', 'Kraft'), ('F', 'N', 'F'))
    """
    cell = " ".join(cell.split())
    brackets = list(_BRACKET.finditer(cell))
    found = [b for b in brackets if (b[1] or b[2]) and is_unit_cell(b[1] or b[2])]
    found = found or [b for b in brackets[-1:] if b[1] is not None and b.end() == len(cell)]  # one that is not known
    if found and (name := f"{cell[: found[-1].start()].rstrip()}{cell[found[-1].end() :]}".strip()):
        return name, (found[-1][1] or found[-1][2] or "").strip(), without_brackets(name)
    if (match := _BESIDE.fullmatch(cell)) and is_unit_of_any_role(match[2]):
        return match[1], match[2], without_brackets(match[1])
    return cell, "", without_brackets(cell)


def without_brackets(name: str) -> str:
    """The name without remarks in brackets, unless the remark is all of it."""
    return " ".join(_BRACKET.sub(" ", name).split()) or name
