"""Results beyond the paper: optimal designs with friction, and break-even friction, backlash and compliance."""

from __future__ import annotations

from inerter.methods.expected_value import ExpectedValue
from inerter.methods.method import Method
from inerter.methods.norm import Norm
from inerter.optimisation.budget import break_even
from inerter.optimisation.optimise import optimise
from inerter.papers.wang_su_2008.rows import RUNS
from inerter.papers.wang_su_2008.source import index_of, linear_rows, study
from inerter.vehicle.vehicle import Vehicle

_ROADS = ExpectedValue(realisations=RUNS, jobs=1)
_STARTS = 6  # of quick searches, whose ends start the search by simulation
_OPTIMA = {
    "J1": ("S2-100N", "S3-100N", "S3-soft-10N"),
    "J3": ("S2-100N", "S3-100N", "S3-soft-10N"),
    "J5": ("S2-100N", "S3-100N"),
}
_BUDGETS: dict[str, tuple[str, str, tuple[float, float], Method, tuple[str, ...]]] = {
    # of which kind of layout, which element, its bounds [SI], by which method, for which indices
    "friction": ("-10N", "f_10", (3.0, 3e3), ExpectedValue(realisations=8, jobs=1), ("J1", "J3")),
    "shaft stiffness": ("-soft", "ks", (1e4, 1e8), Norm(), ("J1", "J3")),
    "backlash": ("-gap", "e", (1e-5, 3e-3), ExpectedValue(realisations=RUNS, jobs=1), ("J1",)),
}


def optimum_names() -> list[str]:
    """Names of the designs to optimise: index and layout."""
    return [f"{index} {layout}" for index, layouts in _OPTIMA.items() for layout in layouts]


def compute_optimum(name: str) -> dict[str, object]:
    """Best design with friction, and its improvement over the best linear design, evaluated with friction [%]."""
    index, layout = name.split()
    source = study("friction1")
    found = optimise(source.design(layout), index_of(index, source), _ROADS, seed=source.seed, starts=_STARTS)
    over = found.gain_over_linear
    assert over is not None
    return {
        "value": found.value,
        "error": found.estimate.standard_error or 0.0,
        "unit": found.unit,
        "parameters": found.parameters,
        "linear_value": over.second.value,
        "percent": over.percent,
        "percent_error": over.percent_error,
        "status": str(found.status),
    }


def budget_names() -> list[str]:
    """Names of the break-even values to compute: index, layout and nonlinearity."""
    return [
        f"{index} {layout} {what}"
        for what, (_, _, _, _, indices) in _BUDGETS.items()
        for index in indices
        for layout in ("S2", "S3")
    ]


def compute_budget(name: str) -> dict[str, object]:
    """The most friction or backlash, or the softest shaft, with which a printed design still beats the printed S1."""
    index, layout, what = name.split(maxsplit=2)
    kind, element, bounds, method, _ = _BUDGETS[what]
    found = break_even(
        _printed_design(index, layout, kind),
        _printed_design(index, "S1", ""),
        index_of(index, study("friction1")),
        parameter=element,
        method=method,
        bounds=bounds,
    )
    return {
        "value": found.value,
        "error": found.standard_error,
        "low": found.interval[0],
        "high": found.interval[1],
        "unit": found.unit,
        "status": str(found.status),
        "kind": found.status.kind.value,
        "message": found.status.message,
    }


def _printed_design(index: str, layout: str, kind: str) -> Vehicle:
    """Printed design of Table 1 for an index, with the elements of `kind`."""
    twin = "-soft" if kind in ("-soft", "-gap") and layout != "S1" else ""
    row = next(r for r in linear_rows() if (r.table, r.index, r.layout) == (1, index, layout + twin))
    source = study("table1" if kind in ("", "-soft") else "friction1")
    vehicle: Vehicle = source.design(layout + kind).with_values(row.parameters)
    return vehicle
