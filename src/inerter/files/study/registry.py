"""What the words of a study file stand for: indices and methods by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from inerter.files.study.study import Study
from inerter.indices.index import Index, LoadCarrying, RideComfort, TyreLoad
from inerter.methods.method import Method
from inerter.methods.norm import Norm
from inerter.methods.statistical_linearisation import StatisticalLinearisation

INDEX: dict[str, Callable[[Study], Index]] = {
    "J1": lambda study: RideComfort(study.road),
    "J3": lambda study: TyreLoad(study.road, high_pass=study.high_pass),
    "J5": lambda study: LoadCarrying(amplitude=study.force),
}


def _expected_value(study: Study) -> Method:
    from inerter.methods.expected_value import ExpectedValue  # noqa: PLC0415 - heavy

    return ExpectedValue(**_roads(study), jobs=1)


def _approximate_linear(study: Study) -> Method:
    from inerter.methods.approximate_linear import ApproximateLinear  # noqa: PLC0415 - heavy

    return ApproximateLinear(**_roads(study))


METHOD: dict[str, Callable[[Study], Method]] = {
    "norm": lambda study: Norm(conventions=study.conventions),
    "statistical-linearisation": lambda study: StatisticalLinearisation(conventions=study.conventions),
    "expected-value": _expected_value,
    "approximate-linear": _approximate_linear,
}


def method_of(study: Study, name: str, threads: int = 1) -> Method:
    """The method of that name; one that simulates shares its roads over `threads`, which changes no digit."""
    method: Any = METHOD[name](study)
    found: Method = replace(method, jobs=threads) if hasattr(method, "jobs") else method
    return found


def _roads(study: Study) -> Mapping[str, Any]:
    """How many random roads, from which seed; what the study leaves open is the method's own choice."""
    given = {"realisations": study.realisations, "relative_error": study.relative_error}
    known = {name: value for name, value in given.items() if value is not None}
    return {**known, "seed": study.seed, "conventions": study.conventions}
