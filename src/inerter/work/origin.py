"""What makes the numbers: this package's sources and the libraries that compute, in one place."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path

VERSION = version("inerter")
_COMPUTE = ("numpy", "scipy", "numba", "llvmlite")
_TELL = {"cli", "report", "figures"}  # packages that show numbers and make none, also those of a paper


def versions() -> dict[str, str]:
    """The versions of this package, of Python and of the libraries on which numbers depend."""
    libraries = {name: version(name) for name in ("numpy", "scipy", "numba", "xarray")}
    return {"inerter": VERSION, "python": platform.python_version(), **libraries}


@cache
def origin() -> str:
    """A hash of what makes the numbers: every source and table of the package but those that only show numbers, and the
    versions of the libraries that compute.

    Sources count as they are, with their comments: a change that does no harm costs a computation, one that is missed
    costs a wrong number.
    """
    digest = hashlib.sha256("".join(f"{name} {version(name)}\n" for name in _COMPUTE).encode())
    root = Path(__file__).parents[1]
    for path in sorted(root.rglob("*")):
        place = path.relative_to(root)
        if path.is_file() and not {*_TELL, "__pycache__"} & set(place.parts):
            digest.update(f"{place.as_posix()}\n{path.stat().st_size}\n".encode() + path.read_bytes())
    return digest.hexdigest()
