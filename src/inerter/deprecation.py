"""Old public names, kept for one version: reading one gives the new one, with a `DeprecationWarning`.

Keywords of constructors are not kept: results are constructed by the package alone.
"""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
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
