"""Public names of a package that are imported when they are first used, as the stub of the package lists them."""

from __future__ import annotations

import ast
from pathlib import Path


def homes(package_file: str) -> dict[str, str]:
    """Module of every name that the stub `__init__.pyi` of a package imports, by name."""
    tree = ast.parse(Path(package_file).with_suffix(".pyi").read_text(encoding="utf-8"))
    found = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: str(node.module) for node in found for alias in node.names}
