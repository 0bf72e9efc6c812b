"""Tables of rows: all there is of a kind of thing, by key and in order, with what other distributions add.

A distribution adds rows in modules that its entry points of the group `inerter.rows` name. They are imported when a
table is asked for the first time, once in each process.
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

from inerter.errors import RowError, UnknownRowError
from inerter.renamed import warn_renamed

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "inerter.rows"
Row = TypeVar("Row")
Made = TypeVar("Made")


class Rows(Mapping[str, Row], Generic[Row]):
    """A table: rows by their keys, in the order in which they were added; our own come first.

    `what` is what a row is, in words, `key` the attribute that holds its key, and `says` are the others that it has;
    `renamed` gives the present names of those that had another in the previous version.
    """

    def __init__(
        self,
        what: str,
        key: str,
        says: tuple[str, ...] = (),
        own: tuple[Row, ...] = (),
        renamed: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self._what, self._key, self._says, self._renamed = what, key, says, renamed
        self._rows: dict[str, Row] = {}
        for row in own:
            self.add(row)

    def add(self, row: Row) -> Row:
        """Add a row, and return it: serves as a decorator.

        Raises `RowError` if another row has its key, or if it does not say all that a row says.
        """
        for old, new in self._renamed.items():
            if old in vars(row) and new not in vars(row):
                warn_renamed(f"{getattr(row, '__name__', self._what)}.{old}", new)
                setattr(row, new, getattr(row, old))
        silent = [name for name in (self._key, *self._says) if not hasattr(row, name)]
        name = getattr(row, "__name__", None) or repr(row)
        if silent:
            raise RowError(f"{name} is no {self._what}: it lacks {', '.join(silent)}.")
        key = getattr(row, self._key)
        if not isinstance(key, str) or not key.strip():
            raise RowError(f"{name} is no {self._what}: its {self._key} is {key!r}, and must be text.")
        if self._rows.get(key, row) is not row:
            raise RowError(f"There is another {self._what} with the {self._key} {key!r}. Choose another {self._key}.")
        if isinstance(row, type) and "__dataclass_fields__" not in vars(row):
            raise RowError(f"{name} is no {self._what}: it is no dataclass. Write @dataclass(frozen=True) above it.")
        self._rows[key] = row
        _changed(row, _classes.add)
        return row

    def remove(self, row: Row) -> None:
        """Forget a row."""
        key = getattr(row, self._key)
        if self._rows.get(key) is row:
            del self._rows[key]
            _changed(row, _classes.discard)

    def __getitem__(self, key: str) -> Row:
        load()
        try:
            return self._rows[key]
        except KeyError:
            close = get_close_matches(str(key), self._rows, n=1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise UnknownRowError(f"There is no {self._what} {key!r} (there are: {', '.join(self)}).{hint}") from None

    def __iter__(self) -> Iterator[str]:
        load()
        return iter(tuple(self._rows))

    def __len__(self) -> int:
        load()
        return len(self._rows)

    def __repr__(self) -> str:
        return f"<{self._what}: {', '.join(self)}>"


def made_of_rows(make: Callable[[], Made]) -> Callable[[], Made]:
    """`make`, whose value is kept until a row is added or forgotten."""
    kept = lru_cache(maxsize=1)(lambda change: make())

    @wraps(make)
    def get() -> Made:
        load()
        return kept(_changes)

    return get


_lock = RLock()
_changes = 0
_classes: set[type] = set()  # the rows that are classes
_loading = False
_failure: RowError | None = None


def _changed(row: object, keep: Callable[[type], None]) -> None:
    global _changes  # noqa: PLW0603 -- tables are what changes while the package runs
    _changes += 1
    if isinstance(row, type):
        keep(row)


def load() -> None:
    """Import the modules that add rows, unless that has begun.

    Raises `RowError`, this and every next time, if one of them cannot be imported.
    """
    global _loading, _failure  # noqa: PLW0603
    with _lock:
        if not _loading:
            _loading = True  # a module that asks a table while it is imported sees what there is by then
            try:
                for entry in _entries():
                    _import(entry)
            except RowError as error:
                _failure = error
            except BaseException:
                _loading = False  # so that the next question begins anew
                raise
    if _failure is not None:
        raise _failure


def plugins() -> dict[str, str]:
    """The distributions that add rows, with their versions."""
    return {entry.dist.name: entry.dist.version for entry in _entries() if entry.dist is not None}


def sources() -> list[Path]:
    """Where the code is that adds rows, but our own: folders of packages, or files of modules that stand alone."""
    modules = {entry.module for entry in _entries()} | {row.__module__ for row in _classes}
    names = {name.partition(".")[0] for name in modules} - {__package__}
    return sorted({Path(place) for name in names for place in _places(name)})


def _places(name: str) -> list[str]:
    module = sys.modules.get(name)
    places = list(getattr(module, "__path__", ())) or [getattr(module, "__file__", None)]
    return [str(place) for place in places if place]


def _entries() -> tuple[EntryPoint, ...]:
    from importlib.metadata import entry_points  # noqa: PLC0415 - heavy

    return tuple(entry_points(group=GROUP))


def _import(entry: EntryPoint) -> None:
    try:
        entry.load()
    except Exception as error:
        dist = f"{entry.dist.name} {entry.dist.version}" if entry.dist is not None else "a distribution"
        raise RowError(
            f"{dist} adds rows to inerter, but its {entry.value} cannot be loaded ({type(error).__name__}: "
            f"{' '.join(str(error).split())}). Mend it, or uninstall it."
        ) from error
