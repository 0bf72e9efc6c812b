"""Public names of a package that are imported when they are first used, as the stub of the package lists them."""

from __future__ import annotations

import ast
import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any


def homes(package_file: str) -> dict[str, str]:
    """Module of every name that the stub `__init__.pyi` of a package imports, by name."""
    tree = ast.parse(Path(package_file).with_suffix(".pyi").read_text(encoding="utf-8"))
    found = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: str(node.module) for node in found for alias in node.names}


def load_name(package: str, home: Mapping[str, str], name: str) -> Any:
    """Value of a public name of a package, imported from its module in `home`; the package keeps it.

    Raises `AttributeError` for a name that is none.
    """
    if name not in home:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    value = getattr(import_module(home[name]), name)
    setattr(sys.modules[package], name, value)
    return value
