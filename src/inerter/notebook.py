"""How results show themselves in notebooks: each class names the function that draws or writes it.

The function is imported when a notebook asks for it, so that a result knows nothing of figures and reports.
"""

from __future__ import annotations

from collections.abc import Callable
from pkgutil import resolve_name
from typing import Any


def shown_by(home: str) -> Callable[[Any], str | None]:
    """Method of a class that shows its instances by a function, "module:name"; None for what cannot be shown.

    >>> class Named:
    ...     _repr_html_ = shown_by("html:escape")
    ...
    ...     def replace(self, *texts: str) -> str:
    ...         return "shown"
    >>> Named()._repr_html_()
    'shown'
    """

    def show(result: Any) -> str | None:
        shown: str | None = resolve_name(home)(result)
        return shown

    return show
