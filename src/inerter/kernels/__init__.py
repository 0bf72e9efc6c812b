"""All compiled code, on plain arrays. Importing this package imports Numba; nothing else in the project does.

The compiler caches a function by its own file and would run stale code when a function that it calls, in another
file, has changed. So the cache folder is named after a hash of all sources of this package.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def source_hash(folder: Path) -> str:
    """A short hash of every Python source in `folder` and of the compiler's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(folder.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Where compiled code is kept: the user's cache folder, or one for this process where that cannot be written."""
    base = os.environ.get("XDG_CACHE_HOME") or (
        os.environ.get("LOCALAPPDATA") if sys.platform == "win32" else str(Path.home() / ".cache")
    )
    name = f"kernels-{source_hash(Path(__file__).parent)}"
    if base:
        folder = Path(base) / "inerter" / name
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            pass
        else:
            if os.access(folder, os.W_OK):
                return folder
    return Path(tempfile.mkdtemp(prefix="inerter-"))  # never a shared one: what is in it will be run


_FOLDER = cache_folder()
if not any(_FOLDER.iterdir()):
    print("inerter: compiling the numerical kernels; this happens once.", file=sys.stderr, flush=True)


def compiled(function: F) -> F:
    """Compile on first use, and keep the result between processes."""
    settings: Any = numba.config
    before = settings.CACHE_DIR
    settings.CACHE_DIR = str(_FOLDER)
    try:
        result: Any = numba.njit(cache=True, error_model="numpy")(function)
    finally:
        settings.CACHE_DIR = before
    return cast("F", result)
