"""Registries of vehicles, indices, methods and other kinds, by key and in order, extensible by other distributions.

A distribution adds entries in modules that its entry points of the group `inerter.rows` name. They are imported at the
first access to a registry, once in each process.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator, Mapping
from difflib import get_close_matches
from functools import lru_cache, wraps
from importlib.util import find_spec
from pathlib import Path
from threading import RLock
from types import MappingProxyType
from typing import TYPE_CHECKING, Generic, TypeVar

from inerter.deprecation import warn_renamed
from inerter.errors import RegistryError, UnknownEntryError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "inerter.rows"
_ADDRESS = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")  # of a class or function: module:name
_VERSIONED = frozenset({"numpy", "scipy"}) | sys.stdlib_module_names  # whose versions are known, so not hashed
Entry = TypeVar("Entry")
Made = TypeVar("Made")


class Registry(Mapping[str, Entry], Generic[Entry]):
    """Registry: entries by key, in the order in which they were added, those of this package first.

    `what` is the kind of entry in words, `key` the attribute with its key, and `required` are its other attributes;
    `renamed` gives the new name of attributes that had another one in the previous version.
    """

    def __init__(
        self,
        what: str,
        key: str,
        required: tuple[str, ...] = (),
        own: tuple[Entry, ...] = (),
        renamed: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self._what, self._key, self._required, self._renamed = what, key, required, renamed
        self._entries: dict[str, Entry] = {}
        for entry in own:
            self.add(entry)

    def add(self, entry: Entry) -> Entry:
        """Add an entry, and return it, so that it can be used as a decorator.

        Raises `RegistryError` if another entry has its key, or if an attribute is missing.
        """
        for old, new in self._renamed.items():
            nearest = next((one for one in _bases(entry) if {old, new} & vars(one).keys()), None)
            if nearest is not None and new not in vars(nearest):
                warn_renamed(f"{getattr(entry, '__name__', self._what)}.{old}", new)
                setattr(entry, new, getattr(entry, old))
        missing = [name for name in (self._key, *self._required) if not hasattr(entry, name)]
        name = getattr(entry, "__name__", None) or repr(entry)
        if missing:
            raise RegistryError(f"{name} is not a valid {self._what}: missing attributes {', '.join(missing)}.")
        key = getattr(entry, self._key)
        if not isinstance(key, str) or not key.strip():
            raise RegistryError(f"{name} is not a valid {self._what}: {self._key} must be non-empty text, got {key!r}.")
        if self._entries.get(key, entry) is not entry:
            raise RegistryError(
                f"{name}: another {self._what} with the {self._key} {key!r} exists. Choose another {self._key}."
            )
        if isinstance(entry, type) and "__dataclass_fields__" not in vars(entry):
            raise RegistryError(
                f"{name} is not a valid {self._what}: not a dataclass. Write @dataclass(frozen=True) above it."
            )
        self._entries[key] = entry
        _sources[id(entry)] = {name.partition(".")[0] for name in _modules_of(entry)}
        _count_change()
        return entry

    def remove(self, entry: Entry) -> None:
        """Remove an entry."""
        key = getattr(entry, self._key)
        if self._entries.get(key) is entry:
            del self._entries[key]
            _sources.pop(id(entry), None)
            _count_change()

    def __getitem__(self, key: str) -> Entry:
        load_plugins()
        try:
            return self._entries[key]
        except (KeyError, TypeError):  # a list has no hash
            meant = self.synonym(str(key))
            close = [meant] if meant else get_close_matches(str(key), self._entries, n=1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise UnknownEntryError(f"Unknown {self._what} {key!r}; available: {', '.join(self)}.{hint}") from None

    def synonym(self, word: str) -> str | None:
        """Key of the entry that has this word among its `synonyms`; None if there is none."""
        return next((key for key, entry in self.items() if word.lower() in getattr(entry, "synonyms", ())), None)

    def __iter__(self) -> Iterator[str]:
        load_plugins()
        return iter(tuple(self._entries))

    def __len__(self) -> int:
        load_plugins()
        return len(self._entries)

    def __repr__(self) -> str:
        return f"<{self._what}: {', '.join(self)}>"


def _bases(entry: object) -> tuple[object, ...]:
    """The classes in which attributes of a class are looked up, in that order; an instance stands for itself."""
    return entry.__mro__ if isinstance(entry, type) else (entry,)


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
_sources: dict[int, set[str]] = {}  # packages with the code of each entry, by the identity of the entry
_loading = False
_failure: RegistryError | None = None


def _count_change() -> None:
    global _changes  # noqa: PLW0603 -- registries change while the package runs
    _changes += 1


def _modules_of(entry: object) -> Iterator[str]:
    """Modules with the code of an entry: that of the class or function, and of those that an instance refers to."""
    yield getattr(entry, "__module__", type(entry).__module__)
    if not isinstance(entry, type):
        for value in getattr(entry, "__dict__", {}).values():
            if isinstance(value, str) and _ADDRESS.fullmatch(value):
                yield value.partition(":")[0]
            elif callable(value) and getattr(value, "__module__", None):
                yield value.__module__


def load_plugins() -> None:
    """Import the modules that add entries, unless that has begun.

    Raises `RegistryError`, now and at every later call, if one of them cannot be imported.
    """
    global _loading, _failure  # noqa: PLW0603
    with _lock:
        if not _loading:
            _loading = True  # a module that reads a registry while it is imported gets the entries so far
            try:
                for entry in _entry_points():
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
    return {entry.dist.name: entry.dist.version for entry in _entry_points() if entry.dist is not None}


def plugin_paths() -> list[Path]:
    """Paths of the code of other distributions that adds entries: folders of packages, or files of single modules."""
    named = {entry.module.partition(".")[0] for entry in _entry_points()}
    names = named.union(*_sources.values()) - {__package__, *_VERSIONED}
    return sorted({Path(place) for name in names for place in _module_paths(name)})


def _module_paths(name: str) -> list[str]:
    if name in sys.modules:
        module = sys.modules[name]
        places = list(getattr(module, "__path__", ())) or [getattr(module, "__file__", None)]
    else:  # an entry that names the address of its code, which is imported at its first use
        spec = find_spec(name)
        places = [] if spec is None else [*(spec.submodule_search_locations or ()), spec.origin]
    return [str(place) for place in places if place and Path(place).exists()]


def _entry_points() -> tuple[EntryPoint, ...]:
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
