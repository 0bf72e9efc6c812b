"""What makes the numbers: this package's sources and the libraries that compute, in one place."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

from inerter.rows import made_of_rows, plugins, sources

VERSION = version("inerter")
_COMPUTE = ("numpy", "scipy", "numba", "llvmlite")
_TELL = {"app", "cli", "report", "figures"}  # packages that show numbers and make none, also those of a paper


def versions() -> dict[str, str]:
    """The versions of this package, of Python, of the libraries on which numbers depend, and of what adds rows."""
    libraries = {name: version(name) for name in ("numpy", "scipy", "numba", "xarray")}
    return {"inerter": VERSION, "python": platform.python_version(), **libraries, **plugins()}


@made_of_rows
def origin() -> str:
    """A hash of what makes the numbers: every source and table of the package, and of those that add rows, but those
    that only show numbers, and the versions of the libraries that compute.

    Sources count as they are, with their comments: a change that does no harm costs a computation, one that is missed
    costs a wrong number.
    """
    known = {**{name: version(name) for name in _COMPUTE}, **plugins()}
    digest = hashlib.sha256("".join(f"{name} {number}\n" for name, number in known.items()).encode())
    for root in (Path(__file__).parents[1], *sources()):
        for place, path in _files(root):
            digest.update(f"{place}\n{path.stat().st_size}\n".encode() + path.read_bytes())
    return digest.hexdigest()


def _files(root: Path) -> Iterator[tuple[str, Path]]:
    """The files below a folder, or the file, with their places in it."""
    if root.is_file():
        yield root.name, root
    for path in sorted(root.rglob("*")):
        place = path.relative_to(root)
        if path.is_file() and not {*_TELL, "__pycache__"} & set(place.parts):
            yield place.as_posix(), path
