"""Fingerprint of the numerical code: sources of this package and versions of numerical libraries."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

from inerter.registry import cache_until_registration, plugin_paths, plugin_versions

VERSION = version("inerter")
_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite")
_PRESENTATION = {"app", "cli", "report", "figures"}  # packages that present numbers only, also those of a paper


def versions() -> dict[str, str]:
    """Versions of this package, of Python, of the numerical libraries, and of plugins."""
    libraries = {name: version(name) for name in ("numpy", "scipy", "numba", "xarray")}
    return {"inerter": VERSION, "python": platform.python_version(), **libraries, **plugin_versions()}


@cache_until_registration
def origin() -> str:
    """Hash of the numerical code: sources and tables of package and plugins, and versions of numerical libraries.

    Packages of presentation are excluded.

    Sources are hashed with their comments: a harmless change costs a computation, a missed one a wrong number.
    """
    known = {**{name: version(name) for name in _LIBRARIES}, **plugin_versions()}
    digest = hashlib.sha256("".join(f"{name} {number}\n" for name, number in known.items()).encode())
    for root in (Path(__file__).parents[1], *plugin_paths()):
        for place, path in _files(root):
            digest.update(f"{place}\n{path.stat().st_size}\n".encode() + path.read_bytes())
    return digest.hexdigest()


def _files(root: Path) -> Iterator[tuple[str, Path]]:
    """Files below a folder, or the file itself, with their relative paths."""
    if root.is_file():
        yield root.name, root
    for path in sorted(root.rglob("*")):
        place = path.relative_to(root)
        if path.is_file() and not {*_PRESENTATION, "__pycache__"} & set(place.parts):
            yield place.as_posix(), path
