"""Registry of the kinds of exports, by key: those that the modules of `kinds` state, in the order of their names."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

from inerter.exports import kinds
from inerter.exports.kind import ExportKind
from inerter.registry import Registry

_MODULES = [import_module(f"{kinds.__name__}.{found.name}") for found in iter_modules(kinds.__path__)]
EXPORTS: Registry[ExportKind] = Registry(
    "kind of export",
    "key",
    ("description", "suffixes", "make"),
    tuple(kind for module in _MODULES for kind in vars(module).values() if isinstance(kind, ExportKind)),
)
