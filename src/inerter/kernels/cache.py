"""Where compiled code is kept between processes, and what people are told of it.

The compiler caches a function by its own file and would run stale code when a function that it calls, in another
file, has changed. So each module's cache folder is named after a hash of its source and of all that it imports here.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from multiprocessing import parent_process
from pathlib import Path
from threading import Event

from inerter.kernels.declare import Kernel, way

_TOLD, _DAMAGED = Event(), Event()
_SHOWN: list[bool] = []  # not empty if people know that the compiler is at work
_IMPORTED = re.compile(r"^from inerter\.kernels\.(\w+) import", re.MULTILINE)


def source_hash(module: Path) -> str:
    """A short hash of a kernel module, of all that it rests on, of the compiler's version and of how it is used."""
    found: set[Path] = set()
    waiting = [module, module.with_name("compiler.py"), module.with_name("tuned.py")]
    while waiting:
        path = waiting.pop()
        if path not in found and path.exists():
            found.add(path)
            waiting += [path.with_name(f"{name}.py") for name in _IMPORTED.findall(path.read_text(encoding="utf-8"))]
    digest = hashlib.sha256(f"{version('numba')} {way()}".encode())
    for path in sorted(found):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder(module: Path) -> Path | None:
    """Where a module's compiled code is kept, below the user's cache folder; None if it cannot be made."""
    base = os.environ.get("XDG_CACHE_HOME") or (os.environ.get("LOCALAPPDATA") if sys.platform == "win32" else None)
    try:
        base = base or str(Path.home() / ".cache")
        folder = Path(base) / "inerter" / f"{module.stem}-{source_hash(module)}"
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError) as error:  # the latter: nobody is at home
        tell_of_no_cache(base or "no home folder", error)
        return None
    return folder


def is_kept(kernel: Kernel) -> bool:
    """Whether there is compiled code of a kernel, or no place for it; the compiler may still refuse what there is."""
    code = kernel.function.__code__
    folder = cache_folder(Path(code.co_filename))
    return folder is None or any(folder.glob(f"*.{code.co_qualname}-{code.co_firstlineno}.*.nbi"))


def tell() -> None:
    """Say once that the compiler is at work, unless progress is shown."""
    if not _SHOWN:
        _SHOWN.append(True)
        print("inerter: compiling the numerical kernels; this happens once.", file=sys.stderr, flush=True)


@contextmanager
def told(here: bool) -> Iterator[None]:
    """The compiler is at work in this block: it is told now if `here`, or else the progress shows it."""
    if here:
        tell()
    _SHOWN.append(True)
    try:
        yield
    finally:
        _SHOWN.pop()


def tell_of_damage(folder: Path) -> None:
    """Say once that compiled code in the cache is not as it was written, and is compiled again."""
    if not _DAMAGED.is_set():
        what = f"compiled kernels in {folder} are not as they were written"
        print(f"inerter: {what}; they are compiled anew.", file=sys.stderr, flush=True)
    _DAMAGED.set()


def tell_of_no_cache(folder: object, error: Exception) -> None:
    """Say once, and in one of several processes, that the next run will have to compile again."""
    if not _TOLD.is_set() and parent_process() is None:
        why = error.strerror if isinstance(error, OSError) else error
        what = f"the cache of compiled kernels cannot be written ({folder}: {why})"
        print(f"inerter: {what}; every run compiles them anew.", file=sys.stderr, flush=True)
    _TOLD.set()
