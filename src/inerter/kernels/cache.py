"""Cache of compiled code between processes, and messages about it.

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

from inerter.kernels.decorators import Kernel, compiler_mode

_TOLD, _DAMAGED = Event(), Event()
_SHOWN: list[bool] = []  # not empty if the compilation has been announced
_IMPORTED = re.compile(r"^from inerter\.kernels\.(\w+) import", re.MULTILINE)


def source_hash(module: Path) -> str:
    """A short hash of a kernel module, of all that it rests on, of the compiler's version and of how it is used."""
    found: set[Path] = set()
    waiting = [module, *(module.with_name(f"{name}.py") for name in ("compiler", "numba_compiler", "numba_lanes"))]
    while waiting:
        path = waiting.pop()
        if path not in found and path.exists():
            found.add(path)
            waiting += [path.with_name(f"{name}.py") for name in _IMPORTED.findall(path.read_text(encoding="utf-8"))]
    digest = hashlib.sha256(f"{version('numba')} {compiler_mode()}".encode())
    for path in sorted(found):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder(module: Path) -> Path | None:
    """Folder of a module's compiled code, below the user's cache folder; None if it cannot be created."""
    base = os.environ.get("XDG_CACHE_HOME") or (os.environ.get("LOCALAPPDATA") if sys.platform == "win32" else None)
    try:
        base = base or str(Path.home() / ".cache")
        folder = Path(base) / "inerter" / f"{module.stem}-{source_hash(module)}"
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError) as error:  # the latter: nobody is at home
        warn_of_no_cache(base or "no home folder", error)
        return None
    return folder


def is_kept(kernel: Kernel) -> bool:
    """Whether the cache has compiled code of a kernel, or cannot hold any; the compiler may still reject the code."""
    code = kernel.function.__code__
    folder = cache_folder(Path(code.co_filename))
    return folder is None or any(folder.glob(f"*.{code.co_qualname}-{code.co_firstlineno}.*.nbi"))


def announce() -> None:
    """Print once that kernels are being compiled, unless progress is shown."""
    if not _SHOWN:
        _SHOWN.append(True)
        print("inerter: compiling the numerical kernels; this happens once.", file=sys.stderr, flush=True)


@contextmanager
def announce_compilation(here: bool) -> Iterator[None]:
    """Announce the compilation in this block: by a message now if `here`, else by the progress that is shown."""
    if here:
        announce()
    _SHOWN.append(True)
    try:
        yield
    finally:
        _SHOWN.pop()


def warn_of_damage(folder: Path) -> None:
    """Warn once that compiled code in the cache is damaged, and is compiled again."""
    if not _DAMAGED.is_set():
        what = f"compiled kernels in {folder} are damaged"
        print(f"inerter: {what}; they are compiled again.", file=sys.stderr, flush=True)
    _DAMAGED.set()


def warn_of_no_cache(folder: object, error: Exception) -> None:
    """Warn once, and in one of several processes, that the next run must compile again."""
    if not _TOLD.is_set() and parent_process() is None:
        why = error.strerror if isinstance(error, OSError) else error
        what = f"the cache of compiled kernels cannot be written ({folder}: {why})"
        print(f"inerter: {what}; every run compiles them again.", file=sys.stderr, flush=True)
    _TOLD.set()
