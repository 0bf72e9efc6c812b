"""What the words of a study file stand for: indices and methods by name."""

from __future__ import annotations

from collections.abc import Callable

from inerter.indices.index import Index, LoadCarrying, RideComfort, TyreLoad
from inerter.methods.method import Method
from inerter.methods.norm import Norm
from inerter.study.values import Study

INDEX: dict[str, Callable[[Study], Index]] = {
    "J1": lambda study: RideComfort(study.road),
    "J3": lambda study: TyreLoad(study.road, high_pass=study.high_pass),
    "J5": lambda study: LoadCarrying(),
}

METHOD: dict[str, Callable[[Study], Method]] = {
    "norm": lambda study: Norm(conventions=study.conventions),
}
