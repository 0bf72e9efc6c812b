"""Results of a study: a labelled dataset, and the summary table."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import inerter
from inerter.methods.norm import CONVENTIONS, linear_problem
from inerter.networks.elements import Free
from inerter.norms.response import frequency_response
from inerter.study.cases import Case, Outcome, cases
from inerter.study.registry import INDEX
from inerter.study.values import Study
from inerter.systems.descriptor import close

Array = NDArray[np.float64]


def dataset(study: Study, outcomes: Mapping[Case, Outcome]) -> xr.Dataset:
    """All outcomes, labelled: dimensions layout, index, method, the swept element if there is one, parameter.

    Improvements are per cent below the baseline's own optimum of the same index, method and swept value.
    """
    sweep = study.sweep
    layouts, indices, methods = list(study.layouts), list(study.indices), list(study.evaluate)
    parameters = _parameters(study)
    points = len(sweep.values) if sweep else 1
    shape = (len(layouts), len(indices), points)
    value = np.full((*shape, len(methods)), np.nan)
    other = np.full((*shape, len(methods), len(indices)), np.nan)
    error = np.full((*shape, len(methods)), np.nan)
    found = np.full((*shape, len(parameters), 3), np.nan)  # value, least and largest of the same height
    bound = np.full((*shape, len(parameters)), "", dtype=object)
    status = np.full(shape, "missing", dtype=object)
    counts = np.zeros((*shape, 3), dtype=int)
    notes: dict[str, dict[str, None]] = {}  # note -> layouts
    for case in cases(study):
        outcome = outcomes.get(case)
        if outcome is None:
            continue
        at = (layouts.index(case.layout), indices.index(case.index), case.point)
        for m, method in enumerate(methods):
            values = outcome.values.get(method, {})
            value[(*at, m)] = values.get(case.index, np.nan)
            other[(*at, m)] = [values.get(index, np.nan) for index in indices]
            error[(*at, m)] = outcome.standard_errors.get(method, {}).get(case.index) or np.nan
        for name, number in outcome.parameters.items():
            found[(*at, list(parameters).index(name))] = number, *outcome.ranges.get(name, (number, number))
            bound[(*at, list(parameters).index(name))] = outcome.active_bounds.get(name, "")
        status[at] = _status(outcome)
        counts[at] = outcome.starts, outcome.agreed, outcome.evaluations
        for note in outcome.notes:
            notes.setdefault(note, {})[case.layout] = None
    improvement = np.full(value.shape, np.nan)
    if study.baseline is not None:
        base = value[layouts.index(study.baseline)]
        base = np.where(np.isfinite(base), base, np.nan)  # nothing is a share of an infinite value
        improvement = 100.0 * (1.0 - value / base)
    dims = ("layout", "index", sweep.element if sweep else "point")
    data = xr.Dataset(
        {
            "value": ((*dims, "method"), value, {"long_name": "index at the optimum of that index"}),
            "standard_error": ((*dims, "method"), error, {"long_name": "standard error of the value"}),
            "improvement": ((*dims, "method"), improvement, {"units": "percent", "long_name": "improvement"}),
            "other_value": ((*dims, "method", "other"), other, {"long_name": "other indices of the same design"}),
            "parameter_value": ((*dims, "parameter"), found[..., 0], {"long_name": "parameter at the optimum"}),
            "parameter_low": ((*dims, "parameter"), found[..., 1], {"long_name": "least among equally good optima"}),
            "parameter_high": ((*dims, "parameter"), found[..., 2], {"long_name": "largest among equally good optima"}),
            "at_bound": ((*dims, "parameter"), bound.astype(str), {"long_name": "bound that holds the parameter"}),
            "status": (dims, status.astype(str), {"long_name": "status"}),
            "starts": (dims, counts[..., 0], {"long_name": "local searches"}),
            "agreed": (dims, counts[..., 1], {"long_name": "local searches that found this optimum"}),
            "evaluations": (dims, counts[..., 2], {"long_name": "evaluations of the index"}),
        },
        coords={
            "layout": layouts,
            "index": indices,
            "method": methods,
            "other": indices,
            "parameter": list(parameters),
            "parameter_unit": ("parameter", list(parameters.values())),
            "index_unit": ("index", [INDEX[name](study).unit for name in indices]),
            "index_title": ("index", [INDEX[name](study).title for name in indices]),
        },
        attrs={
            "title": study.title,
            "baseline": study.baseline or "",
            "conventions": study.conventions,
            "model": study.model,
            "seed": study.seed,
            "inerter_version": inerter.__version__,
            "notes": "\n".join(f"{', '.join(where)}: {note}" for note, where in notes.items()),
        },
    )
    if sweep:
        return data.assign_coords(
            {sweep.element: (sweep.element, list(sweep.values), {"units": sweep.unit, "long_name": sweep.element})}
        )
    return data.isel(point=0).merge(_responses(study, outcomes))


def summary_csv(study: Study, data: xr.Dataset) -> str:
    """One row a design and method: what it is, its value, how much better than the baseline, and its parameters."""
    sweep = study.sweep
    parameters = list(zip(data.parameter.values.tolist(), data.parameter_unit.values.tolist(), strict=True))
    units = dict(zip(data["index"].values.tolist(), data.index_unit.values.tolist(), strict=True))
    header = ["layout", "index", "method"]
    header += [f"{sweep.element} [{sweep.unit}]"] if sweep else []
    header += ["value", "unit", "improvement_percent", "standard_error", "status"]
    header += [f"{name} [{unit}]" for name, unit in parameters] + ["at_bound", "starts", "agreed"]
    header += [f"{name} of this design [{unit}]" for name, unit in units.items()]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    for case in cases(study):
        point = {sweep.element: case.point} if sweep else {}
        design = data.sel(layout=case.layout, index=case.index).isel(point)
        at_bound = ";".join(
            f"{name}:{end}" for (name, _), end in zip(parameters, design.at_bound.values.tolist(), strict=True) if end
        )
        for method in study.evaluate:
            row = design.sel({"method": method})  # as a keyword, `method` means another thing to xarray
            writer.writerow(
                [
                    case.layout,
                    case.index,
                    method,
                    *([_number(sweep.values[case.point])] if sweep else []),
                    *(_number(row.value), units[case.index], _number(row.improvement), _number(row.standard_error)),
                    str(row.status.item()),
                    *(_number(value) for value in row.parameter_value.values),
                    *(at_bound, int(row.starts), int(row.agreed)),
                    *(_number(value) for value in row.other_value.values),
                ]
            )
    return text.getvalue()


def _number(value: Any) -> str:
    """The shortest text that reads back as the same number; empty for a number that there is not."""
    number = float(value)
    return "" if np.isnan(number) else repr(number)


def _status(outcome: Outcome) -> str:
    kind = next((kind for kind in outcome.status.values() if kind != "ok"), "ok")
    return kind if kind == "ok" or not outcome.message else f"{kind}: {outcome.message}"


def _parameters(study: Study) -> dict[str, str]:
    """The free elements that some layout uses, with their units."""
    used = {name for layout in study.layouts for name in study.design(layout).free_values()}
    return {e.label: e.unit for e in study.elements.values() if isinstance(e.value, Free) and e.label in used}


def _responses(study: Study, outcomes: Mapping[Case, Outcome]) -> xr.Dataset:
    """Gain of every weighted output of every index over frequency, for the optimum of each layout."""
    designs = {
        (case.layout, case.index): study.design(case.layout).with_values(outcome.parameters)
        for case, outcome in outcomes.items()
        if outcome.values
    }
    conventions = CONVENTIONS[study.conventions]
    systems: dict[tuple[str, str], Any] = {}
    for (layout, index), vehicle in designs.items():
        mechanism = vehicle.mechanism()
        problem = linear_problem(mechanism, INDEX[index](study).question(mechanism), conventions)
        systems[layout, index] = problem, problem.system(close(problem.descriptor, {}))
    omega = _frequencies([system.A for _, system in systems.values()])
    data = xr.Dataset(coords={"omega": ("omega", omega, {"units": "rad/s", "long_name": "angular frequency"})})
    for index in study.indices:
        mine = {layout: entry for (layout, i), entry in systems.items() if i == index}
        if not mine:
            continue
        question = next(iter(mine.values()))[0].question
        weights = np.array([abs(output.weight) for output in question.outputs])
        gains = np.full((len(study.layouts), weights.size, omega.size), np.nan)
        for layout, (problem, system) in mine.items():
            response = frequency_response(system, omega, problem.pade_order)[:, :, 0]
            gains[list(study.layouts).index(layout)] = weights[:, None] * np.abs(response).T
        own = f"({question.unit})" if "/" in question.unit else question.unit
        unit = question.unit if question.road is None else f"{own}/(m/s)"
        of = "road velocity" if question.road is not None else "force on the body"
        what = {"J1": "body acceleration", "J3": "tyre force", "J5": "body displacement"}[index]
        attributes = {"units": unit, "long_name": f"{what} per {of}"}
        data[f"gain_{index}"] = (("layout", f"output_{index}", "omega"), gains, attributes)
        data = data.assign_coords({f"output_{index}": [output.output for output in question.outputs]})
    return data


def _frequencies(matrices: list[Array]) -> Array:
    """Angular frequencies from a decade below the slowest resonance to a decade above the fastest."""
    poles = np.concatenate([np.linalg.eigvals(A) for A in matrices]) if matrices else np.array([1.0])
    resonances = np.abs(poles[np.abs(poles.imag) > 0.3 * np.abs(poles)])
    sizes = resonances if resonances.size else np.abs(poles)[np.abs(poles) > 0.0]
    low, high = (sizes.min(), sizes.max()) if sizes.size else (1.0, 1.0)
    return np.geomspace(low / 10.0, high * 10.0, 601)
