"""Results of a study: a labelled dataset, and the summary table."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import inerter
from inerter.errors import LinearSystemError, MechanismError, StatusKind
from inerter.files.study.cases import Case, Outcome, cases
from inerter.files.study.study import Study
from inerter.methods.compare import difference_of
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.methods.method import Estimate
from inerter.methods.note import Parts, text_of
from inerter.methods.registry import is_blind
from inerter.networks.elements import Free
from inerter.norms.response import frequency_response
from inerter.systems.descriptor import close

Array = NDArray[np.float64]


def dataset(study: Study, outcomes: Mapping[Case, Outcome]) -> xr.Dataset:
    """All outcomes, labelled: dimensions layout, index, method, the swept element if there is one, parameter.

    Improvements are per cent below the baseline's own optimum of the same index, method and swept value. Where a method
    other than the norm is used, there are standard errors and numbers of realisations too.
    """
    parameters = _parameters(study)
    data = _labelled(study, parameters).assign_attrs(
        title=study.title,
        baseline=study.baseline or "",
        conventions=study.conventions,
        model=study.model,
        seed=study.seed,
        inerter_version=inerter.__version__,
        notes="\n".join(_notes(study, outcomes)),
    )
    for case in cases(study):
        if case in outcomes:
            _enter(data, study, outcomes[case])
    data["status"] = data["status"].astype(str)
    data["at_bound"] = data["at_bound"].astype(str)
    if study.baseline is not None:
        base = data["value"].sel(layout=study.baseline, drop=True)
        base = base.where(np.isfinite(base))  # nothing is a share of an infinite value
        data["improvement"][:] = (100.0 * (1.0 - data["value"] / base)).transpose(*data["value"].dims).values
        if is_uncertain(study):
            _enter_errors(data, study, outcomes)
    return data if study.sweep else data.isel(point=0).merge(_responses(study, outcomes))


def _labelled(study: Study, parameters: Mapping[str, str]) -> xr.Dataset:
    """The dataset without numbers: dimensions, labels, units, and what each variable is."""
    sweep = study.sweep
    indices = {name: study.index(name) for name in study.indices}
    design = ("layout", "index", sweep.element if sweep else "point")
    sizes = {
        "layout": len(study.layouts),
        "index": len(indices),
        design[2]: len(sweep.values) if sweep else 1,
        "method": len(study.evaluate),
        "other": len(indices),
        "parameter": len(parameters),
    }
    variables = {}
    for name, (more, empty, long_name) in {**_VARIABLES, **(_UNCERTAIN if is_uncertain(study) else {})}.items():
        dims = (*design, *more)
        array = np.full([sizes[dim] for dim in dims], empty, dtype=object if isinstance(empty, str) else None)
        variables[name] = (dims, array, {"long_name": long_name})
    coords: dict[str, Any] = {
        "layout": list(study.layouts),
        "elements": ("layout", [_count(study, layout) for layout in study.layouts]),
        "index": list(indices),
        "method": list(study.evaluate),
        "other": list(indices),
        "parameter": list(parameters),
        "parameter_unit": ("parameter", list(parameters.values())),
        "index_unit": ("index", [index.unit for index in indices.values()]),
        "index_title": ("index", [index.title for index in indices.values()]),
    }
    if sweep:
        attributes = {"units": sweep.unit, "long_name": sweep.element}
        coords[sweep.element] = (sweep.element, list(sweep.values), attributes)
    data = xr.Dataset(variables, coords)
    for name in _PERCENT & set(variables):
        data[name].attrs["units"] = "percent"
    return data


def _count(study: Study, layout: str) -> int:
    """How many elements the struts of a layout have."""
    return sum(len(list(strut.network.elements())) for strut in study.design(layout).mechanism().struts)


def is_uncertain(study: Study) -> bool:
    """Whether some method is not one of the linear model, which knows its numbers."""
    return not all(map(is_blind, study.methods))


_VARIABLES: dict[str, tuple[tuple[str, ...], float | int | str, str]] = {
    "value": (("method",), np.nan, "index at the optimum of that index"),
    "standard_error": (("method",), np.nan, "standard error of the value"),
    "improvement": (("method",), np.nan, "improvement over the baseline"),
    "other_value": (("method", "other"), np.nan, "other indices of the same design"),
    "parameter_value": (("parameter",), np.nan, "parameter at the optimum"),
    "parameter_low": (("parameter",), np.nan, "least among equally good optima"),
    "parameter_high": (("parameter",), np.nan, "largest among equally good optima"),
    "at_bound": (("parameter",), "", "bound that holds the parameter"),
    "status": ((), "missing", "status"),
    "starts": ((), 0, "local searches"),
    "agreed": ((), 0, "local searches that found this optimum"),
    "evaluations": ((), 0, "evaluations of the index"),
}


_UNCERTAIN: dict[str, tuple[tuple[str, ...], float | int | str, str]] = {
    "improvement_error": (("method",), np.nan, "standard error of the improvement"),
    "realisations": (("method",), 0, "random roads that were averaged"),
    "over_linear": ((), np.nan, "improvement over the best linear design by the method of the search"),
    "over_linear_error": ((), np.nan, "standard error of that improvement"),
}
_PERCENT = {"improvement", "improvement_error", "over_linear", "over_linear_error"}


def _place(study: Study, case: Case) -> tuple[int, int, int]:
    return list(study.layouts).index(case.layout), study.indices.index(case.index), case.point


def _enter_errors(data: xr.Dataset, study: Study, outcomes: Mapping[Case, Outcome]) -> None:
    """Standard errors of improvements: those of the differences on the same roads."""
    for case, outcome in outcomes.items():
        base = outcomes.get(replace(case, layout=str(study.baseline)))
        for m, method in enumerate(study.evaluate) if base and case.layout != study.baseline else ():
            one, other = (_estimate(o, method) for o in (outcome, base))
            if one is not None and other is not None:
                data["improvement_error"].values[(*_place(study, case), m)] = _ratio_error(one, other)


def _estimate(outcome: Outcome | None, method: str) -> Estimate | None:
    """What is kept of the estimate of the case's own index; None if it has no value or no scatter."""
    if outcome is None or not np.isfinite(outcome.values.get(method, {}).get(outcome.index, np.nan)):
        return None
    error = outcome.standard_errors[method][outcome.index]
    samples = tuple(outcome.samples.get(method, ()))
    value = outcome.values[method][outcome.index]
    return None if error is None else Estimate(value, "", standard_error=error, samples=samples)


def _ratio_error(one: Estimate, other: Estimate) -> float:
    """Standard error of the ratio of two values [%], to first order: that of the first less ratio times the second."""
    ratio, count = one.value / other.value, min(len(one.samples), len(other.samples))
    first = replace(one, samples=one.samples[:count])
    second = replace(
        other,
        value=ratio * other.value,
        standard_error=ratio * (other.standard_error or 0.0),
        samples=tuple(ratio * sample for sample in other.samples[:count]),
    )
    return 100.0 * difference_of(first, second).standard_error / abs(other.value)


def _enter(data: xr.Dataset, study: Study, outcome: Outcome) -> None:
    """Put one outcome in its place."""
    at = _place(study, outcome.case)
    for m, method in enumerate(study.evaluate):
        values = outcome.values.get(method, {})
        data["value"].values[(*at, m)] = values.get(outcome.index, np.nan)
        data["other_value"].values[(*at, m)] = [values.get(index, np.nan) for index in study.indices]
        error = outcome.standard_errors.get(method, {}).get(outcome.index)
        data["standard_error"].values[(*at, m)] = np.nan if error is None else error
    parameters = data["parameter"].values.tolist()
    best = np.isfinite(data["value"].values[at]).any()  # of infinite values none is best
    for name, number in outcome.parameters.items() if best else ():
        place = (*at, parameters.index(name))
        low, high = outcome.ranges.get(name, (number, number))
        data["parameter_value"].values[place] = number
        data["parameter_low"].values[place], data["parameter_high"].values[place] = low, high
        data["at_bound"].values[place] = outcome.active_bounds.get(name, "")
    if is_uncertain(study):
        data["realisations"].values[at] = [outcome.realisations.get(method, 0) for method in study.evaluate]
        over = outcome.over_linear or (np.nan, np.nan)
        data["over_linear"].values[at], data["over_linear_error"].values[at] = over
    data["status"].values[at] = _status(outcome)
    for name in ("starts", "agreed", "evaluations"):
        data[name].values[at] = getattr(outcome, name)


def _notes(study: Study, outcomes: Mapping[Case, Outcome]) -> list[str]:
    """What methods left out, each with the layouts that it concerns; notes that differ in numbers alone are one."""
    found: dict[tuple[str | None, ...], list[Parts]] = {}
    layouts: dict[tuple[str | None, ...], set[str]] = {}
    for case in cases(study):
        for note in outcomes[case].notes if case in outcomes else ():
            words = tuple(part if isinstance(part, str) else None for part in note)
            found.setdefault(words, []).append(tuple(note))
            layouts.setdefault(words, set()).add(case.layout)
    return [
        f"{', '.join(name for name in study.layouts if name in layouts[words])}: {_ranged(alike)}"
        for words, alike in found.items()
    ]


def _ranged(notes: list[Parts]) -> str:
    """One note for several that differ in their numbers."""
    texts = []
    for column in zip(*notes, strict=True):
        numbers = [part for part in column if not isinstance(part, str)]
        low, high = (text_of((end,)) for end in ((min(numbers), max(numbers)) if numbers else column[:1] * 2))
        texts.append(low if low == high else f"{low} to {high}")
    return "".join(texts)


def summary_csv(study: Study, data: xr.Dataset) -> str:
    """One row a design and method: what it is, its value, how much better than the baseline, and its parameters."""
    sweep = study.sweep
    parameters = list(zip(data.parameter.values.tolist(), data.parameter_unit.values.tolist(), strict=True))
    units = dict(zip(data["index"].values.tolist(), data.index_unit.values.tolist(), strict=True))
    header = ["layout", "index", "method"]
    header += [f"{sweep.element} [{sweep.unit}]"] if sweep else []
    header += ["value", "unit", "improvement_percent", "standard_error", "status"]
    more = list(_UNCERTAIN) if is_uncertain(study) else []
    header += [f"{name}_percent" if name in _PERCENT else name for name in more]
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
                    *(_number(row[name]) if name in _PERCENT else int(row[name]) for name in more),
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
    kind = outcome.kind
    return kind if kind == StatusKind.OK or not outcome.message else f"{kind}: {outcome.message}"


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
        try:
            problem = linear_problem(mechanism, study.index(index).question(mechanism), conventions)
            systems[layout, index] = problem, problem.system(close(problem.descriptor, {}))
        except (MechanismError, LinearSystemError):  # friction or a gap alone holds a part
            if not is_uncertain(study):
                raise
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
        attributes = {"units": unit, "long_name": study.index(index).response}
        data[f"gain_{index}"] = (("layout", f"output_{index}", "omega"), gains, attributes)
        names = [o.output if o.weight == 1.0 else f"{o.output} x {o.weight:g} m" for o in question.outputs]
        data = data.assign_coords({f"output_{index}": names})
    return data


def _frequencies(matrices: list[Array]) -> Array:
    """Angular frequencies from a decade below the slowest resonance to a decade above the fastest."""
    poles = np.concatenate([np.linalg.eigvals(A) for A in matrices]) if matrices else np.array([1.0])
    resonances = np.abs(poles[np.abs(poles.imag) > 0.3 * np.abs(poles)])
    sizes = resonances if resonances.size else np.abs(poles)[np.abs(poles) > 0.0]
    low, high = (sizes.min(), sizes.max()) if sizes.size else (1.0, 1.0)
    return np.geomspace(low / 10.0, high * 10.0, 601)
