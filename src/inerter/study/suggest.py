"""The nearest known word, for messages about an unknown one."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from inerter.units import shown


def nearest(word: object, known: Iterable[str]) -> str:
    """A question to put after a sentence, with a space in front; empty if no known word is near.

    >>> nearest("half_car", ("quarter-car", "half-car"))
    ' Did you mean "half-car"?'
    """
    candidates = {name.lower(): name for name in known}
    close = get_close_matches(word.lower(), candidates, n=1) if isinstance(word, str) else []
    return f" Did you mean {shown(candidates[close[0]])}?" if close else ""
