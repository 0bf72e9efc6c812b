"""Validation of numbers and arguments, used by all layers where input enters."""

from __future__ import annotations

import functools
import inspect
import math
import os
from collections.abc import Callable
from itertools import chain
from numbers import Integral, Real
from typing import ParamSpec, TypeGuard, TypeVar

from inerter.errors import InerterError

P = ParamSpec("P")
R = TypeVar("R")


def is_number(value: object) -> TypeGuard[float]:
    """Whether `value` is a finite real number (neither a bool nor an integer beyond floating point)."""
    if type(value) is float:  # as nearly always; an abstract class takes ten times as long
        return math.isfinite(value)
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


def number_or_none(value: object) -> float | None:
    """The value, or None unless it is a finite number: what JSON holds of an error that is not known.

    >>> number_or_none(2.0), number_or_none(math.nan), number_or_none(None)
    (2.0, None, None)
    """
    return value if is_number(value) else None


def use_python_numbers(of: object) -> None:
    """Replace the numbers of NumPy and the fractions among the fields of a frozen dataclass by numbers of Python.

    Arithmetic with them would keep the seven digits of a float32 and the overflow of an int32. Mappings of names to
    numbers are replaced likewise; whatever is not a finite number stays, to be refused.
    """
    for name, value in vars(of).items():
        if type(value) in _OF_PYTHON:  # as nearly always
            continue
        if isinstance(value, dict):
            if not _OF_PYTHON.issuperset(map(type, value.values())):
                object.__setattr__(of, name, {key: _python_number(number) for key, number in value.items()})
        elif (number := _python_number(value)) is not value:
            object.__setattr__(of, name, number)


_OF_PYTHON = frozenset({float, int, bool, str, tuple, type(None)})


def _python_number(value: object) -> object:
    if type(value) in _OF_PYTHON or not is_number(value):
        return value
    return int(value) if isinstance(value, Integral) else float(value)


def check_positive(error: type[InerterError], what: str, value: object, unit: str = "") -> None:
    """Raise `error` unless `value` is a positive, finite number of `unit`."""
    if not is_number(value) or value <= 0.0:
        raise error(f"{what} must be a positive number{f' of {unit}' if unit else ''}, got {value!r}.")


def is_whole(value: object, least: int = 0, most: float = math.inf) -> TypeGuard[int]:
    """Whether `value` is an integer (no bool) within these limits.

    >>> is_whole(3, 1), is_whole(0, 1), is_whole(3.0), is_whole(True)
    (True, False, False, False)
    """
    return isinstance(value, Integral) and not isinstance(value, bool) and least <= int(value) <= most


def check_whole(error: type[InerterError], what: str, value: object, least: int = 0, most: float = math.inf) -> int:
    """The integer `value`; raises `error` unless it is one within these limits."""
    if not is_whole(value, least, most):
        expected = {0: "a non-negative integer", 1: "a positive integer"}.get(least, f"an integer of at least {least}")
        expected = expected if most == math.inf else f"an integer from {least} to {most}"
        raise error(f"{what} must be {expected}, got {value!r}.")
    return int(value)


def check_share(error: type[InerterError], what: str, value: object) -> None:
    """Raise `error` unless `value` is a number between 0 and 1, neither of them."""
    if not is_number(value) or not 0.0 < value < 1.0:
        raise error(f"{what} must be between 0 and 1, got {value!r}.")


def checked(error: type[InerterError]) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorator of a public function that raises `error` for an argument that is not what its annotation says.

    It checks flags, strings, paths and objects of the classes in `_OBJECTS`; other annotations are for the function.

    >>> @checked(InerterError)
    ... def shown(name: str, bold: bool = False) -> None: ...
    >>> shown(["a"])
    Traceback (most recent call last):
    inerter.errors.InerterError: `name` must be a string, got ['a'].
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        given = inspect.signature(function).parameters
        wanted = {name: found for name, one in given.items() if (found := _alternatives(one.annotation))}
        names = list(given)

        @functools.wraps(function)
        def call(*args: P.args, **kwargs: P.kwargs) -> R:
            for name, value in chain(zip(names, args, strict=False), kwargs.items()):
                if name in wanted and not any(_is_a(value, kind) for kind in wanted[name]):
                    words = dict.fromkeys(_WORDS.get(kind, f"a {kind}") for kind in wanted[name])
                    raise error(f"`{name}` must be {' or '.join(words)}, got {_short(value)}.")
            return function(*args, **kwargs)

        return call

    return decorate


_WORDS = {"bool": "True or False", "str": "a string", "Path": "a path", "os.PathLike[str]": "a path", "None": "None"}
_OBJECTS = frozenset({"Axes", "Dataset", "LinearSystem", "Record", "Trajectory"})


def _alternatives(annotation: object) -> list[str]:
    """Alternatives of an annotation; none unless all of them can be checked."""
    kinds = [kind.strip().removeprefix("xr.") for kind in str(annotation).split("|")]
    return kinds if all(kind in _WORDS or kind in _OBJECTS for kind in kinds) else []


def _is_a(value: object, kind: str) -> bool:
    match kind:
        case "None":
            return value is None
        case "bool":
            return isinstance(value, bool) or type(value).__name__ == "bool"  # of NumPy
        case "str":
            return isinstance(value, str)
        case "Path" | "os.PathLike[str]":
            return isinstance(value, os.PathLike)
    return any(one.__name__ == kind for one in type(value).__mro__)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 and "\n" not in text else f"an object of type {type(value).__name__}"
