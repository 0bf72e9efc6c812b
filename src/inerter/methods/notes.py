"""Notes of methods: text with separate numbers, so that notes of several designs can be merged."""

from __future__ import annotations

from inerter.formatting import format_number
from inerter.statements import Statement

Parts = tuple[str | float, ...]  # words, and the numbers between them


class Note(str, Statement):
    """A text made of words and numbers, which `parts` keeps apart.

    >>> Note("friction taken as a damper of ", 1234.5678, " N s/m").parts[1]
    1234.5678
    """

    parts: Parts

    def __new__(cls, *parts: str | float) -> Note:
        """The parts, one after the other; numbers to four digits."""
        self = super().__new__(cls, text_of(parts))
        self.parts = parts
        return self

    def __getnewargs__(self) -> Parts:  # type: ignore[override]
        return self.parts


def parts_of(note: str) -> Parts:
    """The parts of a note; a plain text is one."""
    return note.parts if isinstance(note, Note) else (note,)


def with_prefix(prefix: str, note: str) -> Parts:
    """The parts of a note with a word before it.

    >>> with_prefix("norm: ", "friction left out"), with_prefix("c = ", Note(2.0, " N s/m"))
    (('norm: friction left out',), ('c = ', 2.0, ' N s/m'))
    """
    first, *rest = parts_of(note)
    return (f"{prefix}{first}", *rest) if isinstance(first, str) else (prefix, first, *rest)


def text_of(parts: Parts) -> str:
    """The parts as text.

    >>> text_of(("c = ", 1234.5678))
    'c = 1235'
    """
    return "".join(part if isinstance(part, str) else format_number(part, 4) for part in parts)
