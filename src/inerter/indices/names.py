"""What files call indices: by their symbols, such as J1, or by words, such as ride-comfort."""

from __future__ import annotations

import re

from inerter.errors import RowError
from inerter.indices.registry import INDICES
from inerter.rows import made_of_rows

_BEGINNING = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")


@made_of_rows
def index_names() -> dict[str, str]:
    """The symbol of each index by its symbol and by its words, which are its `key` or those of its class.

    Raises `RowError` if two indices have the same.
    """
    found = {symbol: symbol for symbol in INDICES}
    for symbol, words in index_words().items():
        if found.setdefault(words, symbol) != symbol:
            raise RowError(
                f"{found[words]} and {symbol} are both called {words!r} in files. Rename one of the classes."
            )
    return found


@made_of_rows
def index_words() -> dict[str, str]:
    """The words of each index by its symbol: its `key`, or else those of its class."""
    return {
        symbol: getattr(kind, "key", _BEGINNING.sub("-", kind.__name__).lower()) for symbol, kind in INDICES.items()
    }
