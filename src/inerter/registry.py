"""Registries of vehicles, indices, methods and other kinds, by key and in order, extensible by other distributions.

A distribution adds entries in modules that its entry points of the group `inerter.rows` name. They are imported at the
first access to a registry, once in each process.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from difflib import get_close_matches
from functools import lru_cache, wraps
from pathlib import Path
from threading import RLock
from types import MappingProxyType
from typing import TYPE_CHECKING, Generic, TypeVar

from inerter.deprecation import warn_renamed
from inerter.errors import RegistryError, UnknownEntryError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "inerter.rows"
Row = TypeVar("Row")
Made = TypeVar("Made")


class Registry(Mapping[str, Row], Generic[Row]):
    """Registry: entries by key, in the order in which they were added, those of this package first.

    `what` is the kind of entry in words, `key` the attribute with its key, and `required` are its other attributes;
    `renamed` gives the new name of attributes that had another one in the previous version.
    """

    def __init__(
        self,
        what: str,
        key: str,
        required: tuple[str, ...] = (),
        own: tuple[Row, ...] = (),
        renamed: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self._what, self._key, self._required, self._renamed = what, key, required, renamed
        self._rows: dict[str, Row] = {}
        for row in own:
            self.add(row)

    def add(self, row: Row) -> Row:
        """Add an entry, and return it, so that it can be used as a decorator.

        Raises `RegistryError` if another entry has its key, or if an attribute is missing.
        """
        for old, new in self._renamed.items():
            nearest = next((one for one in _bases(row) if {old, new} & vars(one).keys()), None)
            if nearest is not None and new not in vars(nearest):
                warn_renamed(f"{getattr(row, '__name__', self._what)}.{old}", new)
                setattr(row, new, getattr(row, old))
        missing = [name for name in (self._key, *self._required) if not hasattr(row, name)]
        name = getattr(row, "__name__", None) or repr(row)
        if missing:
            raise RegistryError(f"{name} is not a valid {self._what}: missing attributes {', '.join(missing)}.")
        key = getattr(row, self._key)
        if not isinstance(key, str) or not key.strip():
            raise RegistryError(f"{name} is not a valid {self._what}: {self._key} must be non-empty text, got {key!r}.")
        if self._rows.get(key, row) is not row:
            raise RegistryError(
                f"{name}: another {self._what} with the {self._key} {key!r} exists. Choose another {self._key}."
            )
        if isinstance(row, type) and "__dataclass_fields__" not in vars(row):
            raise RegistryError(
                f"{name} is not a valid {self._what}: not a dataclass. Write @dataclass(frozen=True) above it."
            )
        self._rows[key] = row
        _register_change(row, _classes.add)
        return row

    def remove(self, row: Row) -> None:
        """Remove an entry."""
        key = getattr(row, self._key)
        if self._rows.get(key) is row:
            del self._rows[key]
            _register_change(row, _classes.discard)

    def __getitem__(self, key: str) -> Row:
        load_plugins()
        try:
            return self._rows[key]
        except KeyError:
            close = get_close_matches(str(key), self._rows, n=1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise UnknownEntryError(f"Unknown {self._what} {key!r}; available: {', '.join(self)}.{hint}") from None

    def __iter__(self) -> Iterator[str]:
        load_plugins()
        return iter(tuple(self._rows))

    def __len__(self) -> int:
        load_plugins()
        return len(self._rows)

    def __repr__(self) -> str:
        return f"<{self._what}: {', '.join(self)}>"


def _bases(row: object) -> tuple[object, ...]:
    """The classes in which attributes of a class are looked up, in that order; an instance stands for itself."""
    return row.__mro__ if isinstance(row, type) else (row,)


def cache_until_registration(make: Callable[[], Made]) -> Callable[[], Made]:
    """Decorator: `make`, whose value is cached until an entry of any registry is added or removed."""
    kept = lru_cache(maxsize=1)(lambda change: make())

    @wraps(make)
    def get() -> Made:
        load_plugins()
        return kept(_changes)

    return get


_lock = RLock()
_changes = 0
_classes: set[type] = set()  # entries that are classes
_loading = False
_failure: RegistryError | None = None


def _register_change(row: object, keep: Callable[[type], None]) -> None:
    global _changes  # noqa: PLW0603 -- registries change while the package runs
    _changes += 1
    if isinstance(row, type):
        keep(row)


def load_plugins() -> None:
    """Import the modules that add entries, unless that has begun.

    Raises `RegistryError`, now and at every later call, if one of them cannot be imported.
    """
    global _loading, _failure  # noqa: PLW0603
    with _lock:
        if not _loading:
            _loading = True  # a module that reads a registry while it is imported gets the entries so far
            try:
                for entry in _entries():
                    _import_plugin(entry)
            except RegistryError as error:
                _failure = error
            except BaseException:
                _loading = False  # so that the next access starts again
                raise
    if _failure is not None:
        raise _failure


def plugin_versions() -> dict[str, str]:
    """Versions of the distributions that add entries, by name."""
    return {entry.dist.name: entry.dist.version for entry in _entries() if entry.dist is not None}


def plugin_paths() -> list[Path]:
    """Paths of the code of other distributions that adds entries: folders of packages, or files of single modules."""
    modules = {entry.module for entry in _entries()} | {row.__module__ for row in _classes}
    names = {name.partition(".")[0] for name in modules} - {__package__}
    return sorted({Path(place) for name in names for place in _module_paths(name)})


def _module_paths(name: str) -> list[str]:
    module = sys.modules.get(name)
    places = list(getattr(module, "__path__", ())) or [getattr(module, "__file__", None)]
    return [str(place) for place in places if place]


def _entries() -> tuple[EntryPoint, ...]:
    from importlib.metadata import entry_points  # noqa: PLC0415 - heavy

    return tuple(entry_points(group=GROUP))


def _import_plugin(entry: EntryPoint) -> None:
    try:
        entry.load()
    except Exception as error:
        dist = f"{entry.dist.name} {entry.dist.version}" if entry.dist is not None else "a distribution"
        raise RegistryError(
            f"{dist}: cannot load its extension {entry.value} of inerter ({type(error).__name__}: "
            f"{' '.join(str(error).split())}). Correct it, or uninstall it."
        ) from error
