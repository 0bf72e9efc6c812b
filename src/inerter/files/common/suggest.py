"""Known words for messages about an unknown one: the nearest, and some of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches

from inerter.formatting import format_some
from inerter.units import quote_value

_MOST = 12  # names in a message
_SYNONYMS = {  # of keys, in other programs
    **dict.fromkeys(("min", "minimum", "lower", "low"), ("from", "at_least", "lowest")),
    **dict.fromkeys(("max", "maximum", "upper", "high"), ("to", "at_most", "highest")),
}


def nearest(word: object, known: Iterable[str]) -> str:
    """A question to put after a sentence, with a space in front; empty if no known word is near.

    >>> nearest("half_car", ("quarter-car", "half-car"))
    ' Did you mean "half-car"?'
    """
    found = closest(word, known)
    return "" if found is None else f" Did you mean {quote_value(found)}?"


def closest(word: object, known: Iterable[str]) -> str | None:
    """The known word that an unknown one is a misspelling, a synonym or a part of; None if no known word is near.

    >>> closest("half_car", ("quarter-car", "half-car"))
    'half-car'
    >>> closest("max", ("at_most", "at_least")), closest("travel", ("tyre-load", "suspension-travel"))
    ('at_most', 'suspension-travel')
    """
    if not isinstance(word, str):
        return None
    candidates, given = {name.lower(): name for name in known}, word.lower()
    close = get_close_matches(given, candidates, n=1) or [one for one in _SYNONYMS.get(given, ()) if one in candidates]
    whole = [one for one in candidates if given in one.split("-")]
    return candidates[close[0]] if close else candidates[whole[0]] if len(whole) == 1 else None


def some(names: Iterable[str]) -> str:
    """Names in a row, so many as a reader may want to see.

    >>> some(f"k{i}" for i in range(100))
    'k0, k1, k2, k3, k4, k5, k6, k7, k8, k9, k10, k11 and 88 more'
    """
    return format_some(names, _MOST)


def missing_kind(option: str, plural: str, known: Mapping[str, str]) -> str:
    """Lines on an option that is missing: the kinds that it may have, each with its description.

    >>> print(missing_kind("--to", "exports", {"fmu": "functional mock-up unit", "csv": "table"}))
    --to is missing; kinds of exports:
      fmu  functional mock-up unit
      csv  table
    """
    width = max(map(len, known))
    return "\n".join([f"{option} is missing; kinds of {plural}:", *(f"  {k:<{width}}  {t}" for k, t in known.items())])
