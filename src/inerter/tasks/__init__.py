"""Tasks on the best designs of a study, one module each: break-even values, Pareto fronts, tolerances.

The names of this package are those that the task of another distribution needs; each is loaded when it is first used.
"""

from importlib import import_module
from typing import Any

from inerter.lazy_names import homes

_HOME = homes(__file__)
__all__ = sorted(_HOME)  # noqa: PLE0605 -- made of the stub


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
