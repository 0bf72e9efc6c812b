"""Validation of numbers and arguments, used by all layers where input enters."""

from __future__ import annotations

import functools
import inspect
import math
import os
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import partial
from itertools import chain
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, ParamSpec, TypeGuard, TypeVar

from inerter.errors import InerterError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

P = ParamSpec("P")
R = TypeVar("R")


def is_number(value: object) -> TypeGuard[float]:
    """Whether `value` is a finite real number (neither a bool nor an integer beyond floating point)."""
    if type(value) is float:  # as nearly always; an abstract class takes ten times as long
        return math.isfinite(value)
    if type(value) is not int and (not isinstance(value, Real) or isinstance(value, bool)):
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


def is_flag(value: object) -> bool:
    """Whether `value` is True or False, of Python or NumPy."""
    return isinstance(value, bool) or type(value).__name__ == "bool"


def is_listed(value: object) -> TypeGuard[Iterable[Any]]:
    """Whether `value` lists its parts: no text, and no array without dimensions.

    >>> is_listed([1.0]), is_listed("k"), is_listed(None)
    (True, False, False)
    """
    if type(value) is tuple:  # as nearly always; an abstract class takes ten times as long
        return True
    return isinstance(value, Iterable) and not isinstance(value, str | bytes) and getattr(value, "shape", None) != ()


def real_numbers(value: object) -> NDArray[np.float64] | None:
    """The array of `value`, or None unless it holds real numbers alone (neither texts nor bools) that doubles can hold.

    >>> real_numbers([1, 2.5]), real_numbers(["1"]), real_numbers([[1, 2], [3]])
    (array([1. , 2.5]), None, None)
    """
    import numpy as np  # noqa: PLC0415 - heavy

    try:
        given = np.asarray(value)
        return given.astype(float, copy=False) if given.dtype.kind in "iufO" else None
    except (TypeError, ValueError, OverflowError):
        return None


def check_positive(error: type[InerterError], what: str, value: object, unit: str = "") -> None:
    """Raise `error` unless `value` is a positive, finite number of `unit`."""
    if not is_number(value) or value <= 0.0:
        raise error(f"{what} must be a positive number{f' of {unit}' if unit else ''}, got {in_message(value)}.")


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
        raise error(f"{what} must be {expected}, got {in_message(value)}.")
    return int(value)


def check_share(error: type[InerterError], what: str, value: object) -> None:
    """Raise `error` unless `value` is a number between 0 and 1, neither of them."""
    if not is_number(value) or not 0.0 < value < 1.0:
        raise error(f"{what} must be between 0 and 1, got {in_message(value)}.")


def checked(error: type[InerterError]) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorator of a public function that raises `error` for an argument that is not what its annotation says.

    It checks flags, strings, paths, objects of the classes in `_OBJECTS`, lists and mappings of these, pairs and
    functions; other annotations are for the function.

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
                    words = dict.fromkeys(map(_in_words, wanted[name]))
                    raise error(f"`{name}` must be {' or '.join(words)}, got {in_message(value)}.")
            return function(*args, **kwargs)

        return call

    return decorate


_WORDS = {
    "bool": "True or False",
    "str": "a string",
    "Path": "a path",
    "os.PathLike[str]": "a path",
    "None": "None",
    "Callable[[float], None]": "a function",
    "Sequence[str]": "a list of strings",
    "tuple[float, float]": "two numbers in SI units",
    "tuple[str, str]": "two strings",
}
_OBJECTS = frozenset(
    {"Axes", "Dataset", "FitOptions", "LinearSystem", "Network", "ParetoFront", "Record", "Rig", "Trajectory"}
)
_LIST, _MAPPING = "Sequence[", "Mapping[str, "


def _alternatives(annotation: object) -> list[str]:
    """Alternatives of an annotation; none unless all of them can be checked."""
    kinds = [kind.strip().removeprefix("xr.") for kind in str(annotation).split("|")]
    parts = [kind.removeprefix(_LIST).removeprefix(_MAPPING).removesuffix("]") for kind in kinds]
    checkable = (kind in _WORDS or part in _OBJECTS for kind, part in zip(kinds, parts, strict=True))
    return kinds if all(checkable) else []


def _in_words(kind: str) -> str:
    if kind in _WORDS:
        return _WORDS[kind]
    for begin, words in ((_LIST, "a list of"), (_MAPPING, "a mapping of names to")):
        if kind.startswith(begin):
            return f"{words} {kind[len(begin) : -1]} objects"
    return f"{'an' if kind[0] in 'AEIOU' else 'a'} {kind}"


def _is_a(value: object, kind: str) -> bool:
    match kind:
        case "None":
            return value is None
        case "bool":
            return is_flag(value)
        case "str":
            return isinstance(value, str)
        case "Path" | "os.PathLike[str]":
            return isinstance(value, os.PathLike)
        case "Callable[[float], None]":
            return callable(value)
        case "tuple[float, float]" | "tuple[str, str]":
            fits = is_number if "float" in kind else partial(_is_a, kind="str")
            return (
                isinstance(value, Collection)
                and is_listed(value)
                and len(pair := list(value)) == 2
                and all(map(fits, pair))
            )
    if kind.startswith(_LIST):
        return (
            isinstance(value, Collection)
            and is_listed(value)
            and all(_is_a(part, kind[len(_LIST) : -1]) for part in value)
        )
    if kind.startswith(_MAPPING):
        parts = value.items() if isinstance(value, Mapping) else ((None, None),)
        return all(isinstance(name, str) and _is_a(part, kind[len(_MAPPING) : -1]) for name, part in parts)
    return any(one.__name__ == kind for one in type(value).__mro__)


_LONG = 80  # characters of a value in a message, at most


def in_message(value: object) -> str:
    """Text of a value for a message; its type or size where that is long.

    >>> in_message(2.5), in_message(10**5000), in_message([0] * 100)
    ('2.5', 'an integer of 16610 bits', 'an object of type list')
    """
    if isinstance(value, int) and abs(value) >= 10**_LONG:  # Python itself gives no text of more than 4300 digits
        return f"an integer of {value.bit_length()} bits"
    text = repr(value)
    return text if len(text) <= _LONG and "\n" not in text else f"an object of type {type(value).__name__}"
