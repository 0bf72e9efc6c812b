"""Old public names, kept for one version: reading one gives the new one, with a `DeprecationWarning`.

Keywords of constructors are not kept: results are constructed by the package alone.
"""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from itertools import chain
from operator import attrgetter
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def warn_renamed(old: str, new: str, stacklevel: int = 3) -> None:
    """Warn that a name has been renamed, at the caller of the function that warns."""
    warnings.warn(f"`{old}` is now `{new}`; the old name goes with the next version.", DeprecationWarning, stacklevel)


class RenamedAttribute:
    """The old name, in a class, of the attribute or method `new`."""

    def __init__(self, new: str) -> None:
        self.new = new

    def __set_name__(self, owner: type, name: str) -> None:
        self.old = name

    def __get__(self, instance: object, owner: type) -> Any:
        if instance is None:  # as other descriptors
            return self
        warn_renamed(self.old, self.new)
        return getattr(instance, self.new)


def adopt_renamed(given: object, **new_names: str) -> None:
    """Give the class of an object that has an attribute `old` but none called `new` the new one, for each `old="new"`.

    For classes of other distributions, which may have been written for the previous version.
    """
    kind, own = type(given), getattr(given, "__dict__", {})
    for old, new in new_names.items():
        if new in vars(kind) and old not in own:
            continue
        places = chain((own,), map(vars, kind.__mro__))
        nearest = next((one for one in places if new in one or old in one), {new: None})
        if new not in nearest and not isinstance(nearest[old], RenamedAttribute):
            try:
                setattr(kind, new, property(attrgetter(old)))
            except TypeError:  # a built-in class, whose `old` is something else
                continue
            warn_renamed(f"{kind.__name__}.{old}", new, 4)


def renamed_keywords(**new_names: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorator of a function whose keyword `old` is now `new`, for each `old="new"`.

    The decorated function raises `TypeError` if it is given both.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        @functools.wraps(function)
        def call(*args: P.args, **kwargs: P.kwargs) -> R:
            for old in [name for name in kwargs if name in new_names]:
                new = new_names[old]
                if new in kwargs:
                    raise TypeError(f"{function.__name__}() got both {new!r} and its old name {old!r}")
                warn_renamed(old, new)
                kwargs[new] = kwargs.pop(old)
            return function(*args, **kwargs)

        return call

    return decorate
