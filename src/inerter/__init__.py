"""Vehicle suspensions with inerters: performance indices, optimal designs, simulation and identification.

Networks of springs, dampers, inerters, dry friction and gaps; quarter cars, half cars and any other mechanism; exact
norms and optimisation. Everything public is a name in this module; each is loaded when it is first used.
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import Any

from inerter.deprecation import warn_renamed


def _homes() -> dict[str, str]:
    """The module of every public name: from the imports of the stub of this file."""
    tree = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    found = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: str(node.module) for node in found for alias in node.names}


_HOME = _homes()
_OLD = {  # names of 0.1
    "Arrival": "InputPath",
    "Budget": "BreakEven",
    "Choice": "ModelSelection",
    "Front": "ParetoFront",
    "Guard": "GuardRole",
    "Intent": "WriteMode",
    "Line": "SymbolLine",
    "Linear": "LinearRole",
    "Measures": "PerformanceOutputs",
    "OneInput": "SingleInput",
    "Point": "TrackedPoint",
    "Question": "IndexDefinition",
    "Sees": "NonlinearitySupport",
    "Shaped": "FilteredExcitation",
    "Staged": "StagedIdentification",
    "Statistical": "StatisticalRole",
    "Switch": "SwitchRole",
    "Weighted": "OutputWeight",
    "WeightedMotion": "WeightedAcceleration",
    "assemble": "state_space",
    "budget": "break_even",
    "choice": "choice_field",
    "choose": "select_model",
    "claimed": "open_results",
    "formed": "typed_field",
    "iso2631": "iso2631_weighting",
    "pareto": "pareto_front",
    "pooled": "worker_pool",
    "robust": "optimise_robust",
    "staged": "identify_staged",
    "tolerance": "tolerance_analysis",
    "weighted": "frequency_weight",
}
__all__ = sorted([*_HOME, "__version__"])  # noqa: PLE0605 -- made of the stub


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("importlib.metadata").version("inerter")  # which takes as long as all else here
    if name in _OLD:
        warn_renamed(name, _OLD[name])
        return __getattr__(_OLD[name])
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
