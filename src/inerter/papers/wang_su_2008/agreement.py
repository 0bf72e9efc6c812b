"""Comparison of the methods, which must agree to first order for small friction and differ for large friction."""

from __future__ import annotations

from inerter.methods.approximate_linear import ApproximateLinear
from inerter.methods.expected_value import ExpectedValue
from inerter.methods.method import Method, evaluate
from inerter.methods.norm import Norm
from inerter.methods.statistical_linearisation import StatisticalLinearisation
from inerter.optimisation.budget import with_element
from inerter.papers.wang_su_2008.source import index_of, linear_rows, study

FORCES = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0)  # of friction [N]
_MOST_NOISE = 100.0  # [N] beyond, friction sticks for so long that a motion on noise does not repeat
METHODS: dict[str, Method] = {
    "statistical-linearisation": StatisticalLinearisation(),
    "expected-value": ExpectedValue(relative_error=2e-3, jobs=1),
    "approximate-linear": ApproximateLinear(),
}


def names() -> list[str]:
    """Index, layout and friction of every point."""
    return [f"{index} {layout} {force:g}" for index in ("J1", "J3") for layout in ("S2", "S3") for force in FORCES]


def compute(name: str) -> dict[str, object]:
    """The index of a printed design of Table 1 with this friction, by each method, as a part of its norm."""
    index, layout, force = name.split()
    source = study("friction1")
    row = next(r for r in linear_rows() if (r.table, r.index, r.layout) == (1, index, layout))
    design = source.design(f"{layout}-10N").with_values(row.parameters)
    car, asked = with_element(design, "f_10", float(force)), index_of(index, source)
    linear = evaluate(car, asked, Norm()).value
    methods = {k: m for k, m in METHODS.items() if k != "approximate-linear" or float(force) <= _MOST_NOISE}
    found = {method: evaluate(car, asked, value) for method, value in methods.items()}
    return {
        "linear": linear,
        **{method: estimate.value for method, estimate in found.items()},
        **{f"{method} error": estimate.standard_error or 0.0 for method, estimate in found.items()},
    }
