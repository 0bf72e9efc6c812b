"""Names of indices in files: symbols, such as J1, or words, such as ride-comfort."""

from __future__ import annotations

import re

from inerter.errors import RegistryError
from inerter.indices.registry import INDICES
from inerter.registry import cache_until_registration

_BEGINNING = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")


@cache_until_registration
def index_names() -> dict[str, str]:
    """The symbol of each index by its symbol and by its words, which are its `key` or those of its class.

    Raises `RegistryError` if two indices have the same.
    """
    found = {symbol: symbol for symbol in INDICES}
    for symbol, words in index_words().items():
        if found.setdefault(words, symbol) != symbol:
            raise RegistryError(
                f"{found[words]} and {symbol} are both called {words!r} in files. Give one another `key`."
            )
    return found


@cache_until_registration
def index_words() -> dict[str, str]:
    """The words of each index by its symbol: its `key`, or else those of its class, unless another has them already."""
    found: dict[str, str] = {}
    for symbol, kind in INDICES.items():
        of_class = _BEGINNING.sub("-", kind.__name__).lower()
        found[symbol] = getattr(kind, "key", symbol if of_class in found.values() else of_class)
    return found


def title_with_name(title: str, name: str, form: str = "{} ({})") -> str:
    """Title of an index with its name in the study, unless the title contains the name.

    >>> title_with_name("ride comfort", "J1"), title_with_name("dynamic tyre load", "tyre-load")
    ('ride comfort (J1)', 'dynamic tyre load')
    """
    return title if name.replace("-", " ") in title else form.format(title, name)
