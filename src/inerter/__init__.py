"""Vehicle suspensions with inerters: performance indices, optimal designs, simulation and identification.

Networks of springs, dampers, inerters, dry friction and gaps; quarter cars, half cars and any other mechanism; exact
norms and optimisation. Everything public is a name in this module; each is loaded when it is first used.
"""

from importlib import import_module
from typing import Any

from inerter.deprecation import warn_renamed
from inerter.lazy_names import homes, load_name

_HOME = homes(__file__)
_OLD = {  # former names
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
    "TaskRow": "TaskEntry",
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
    return load_name(__name__, _HOME, name)


def __dir__() -> list[str]:
    return __all__
