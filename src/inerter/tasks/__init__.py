"""Tasks on the best designs of a study, one module each: break-even values, Pareto fronts, tolerances.

The names of this package are those that the task of another distribution needs; each is loaded when it is first used.
"""

from typing import Any

from inerter.lazy_names import homes, load_name

_HOME = homes(__file__)
__all__ = sorted(_HOME)  # noqa: PLE0605 -- made of the stub


def __getattr__(name: str) -> Any:
    return load_name(__name__, _HOME, name)


def __dir__() -> list[str]:
    return __all__
