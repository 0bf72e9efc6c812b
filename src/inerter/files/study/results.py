"""Results of a study: outcomes as they come, in the arrays of a labelled dataset."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import inerter
from inerter.errors import StatusKind
from inerter.files.common.roads import EFFECT, OTHER_EFFECT, ROAD_ERROR
from inerter.files.study.cases import Case, Outcome, cases
from inerter.files.study.conditions import CONDITION, IN_CONDITIONS
from inerter.files.study.design_numbers import DESIGN_NUMBERS, NUMBER
from inerter.files.study.limits import each_of, is_swept, limit_text
from inerter.files.study.method_labels import limit_basis, method_labels
from inerter.files.study.notes import Notes, road_notes
from inerter.files.study.responses import responses
from inerter.files.study.speeds import AT_SPEEDS, BESIDE, is_at_one_speed
from inerter.files.study.study import Study
from inerter.methods.compare import Comparison, compare_estimates
from inerter.methods.measured_road_errors import ROAD_ERRORS
from inerter.methods.method import Estimate
from inerter.methods.registry import is_blind

Array = NDArray[np.float64]
_OK = StatusKind.OK.value
_Variable = tuple[tuple[str, ...], float | int | str, str]  # further dimensions, what is there before, long name
_Scattered = tuple[str, tuple[int, ...]]  # beginning of the variables' names; case, method, perhaps condition


class DatasetBuilder:
    """The outcomes of a study, put into the arrays of its dataset as they come, in any order.

    Of each no more is kept than those ask for: samples where improvements have standard errors, and the outcome itself
    where nothing is swept.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.cases = cases(study)
        self.done = np.zeros(len(self.cases), dtype=bool)  # by the number of the case
        self.count = self.n_failures = 0
        self.kinds: set[str] = set()  # of statuses
        self.designs: dict[Case, Outcome] = {}  # where nothing is swept
        self._notes = Notes()
        self._texts: dict[str, str] = {}  # each once
        self._samples: dict[_Scattered, Array] = {}  # where there is a standard error
        self._controls: dict[tuple[int, ...], Array] = {}  # of those samples and of many more, where nothing is swept
        self._by: dict[str, None] = {}  # methods of the values at other speeds
        self._uncertain = is_uncertain(study)
        self._no_effects = {name: [0.0] * count for name, count in Counter(_road_errors(study)).items()}
        self._parameters = study.free_units
        self._data = _empty_dataset(study, self._parameters)
        self._columns = {name: i for i, name in enumerate(self._parameters)}
        self._arrays = {str(name): by_case(self._data, str(name)) for name in self._data.data_vars}

    def pending(self) -> Pending:
        """Cases without an outcome so far."""
        return Pending(self)

    def enter(self, outcome: Outcome) -> None:
        """Store an outcome in the arrays of the dataset."""
        case = outcome.part
        number, arrays, kind = self.cases.number(case), self._arrays, outcome.kind
        if not self.done[number]:
            self.done[number] = True
            self.count += 1
            self.n_failures += kind != _OK
        self.kinds.add(kind)
        self._notes.add(number, case, outcome)
        self._enter_values(number, outcome)
        arrays["status"][number] = self._once(_status(outcome, kind))
        for name in ("starts", "agreed", "evaluations"):
            arrays[name][number] = getattr(outcome, name)
        if self._uncertain:
            self._enter_scatter(number, outcome)
        self._enter_conditions(number, outcome)
        for method, found_at in outcome.speeds.items():
            for i, at_speed in enumerate(found_at):
                for name in ("value", "error_bound"):
                    arrays[f"{AT_SPEEDS}{name}"][number, i] = at_speed[name]
                if EFFECT in arrays:
                    arrays[f"{AT_SPEEDS}{EFFECT}"][number, :, i] = self._of_road(at_speed["shared_errors"])
            arrays[f"{AT_SPEEDS}message"][number] = self._once(outcome.speed_message)
            self._by[method] = None
        for i, found in enumerate(outcome.limits):
            for name, number_told in zip(LIMITED, found, strict=True):
                arrays[name][number, i] = number_told
        for name in DESIGN_NUMBERS:
            for end, content in outcome.numbers.get(name, {}).items():
                arrays[f"{NUMBER}{name}.{end}"][number] = content
        if not self.study.sweeps:
            self.designs[case] = outcome

    def dataset(self) -> xr.Dataset:
        """All outcomes so far, labelled: see `dataset`. No outcome can be put in after that."""
        study = self.study
        data = self._data.assign_attrs(
            title=study.title,
            baseline=study.baseline or "",
            conventions=study.conventions,
            model=study.model,
            seed=study.seed,
            inerter_version=inerter.__version__,
            notes="\n".join([*road_notes(study), *self._notes.texts(tuple(study.layouts))]),
        )
        if study.baseline is not None:
            _enter_improvements(data, study.baseline)
            if study.conditions:
                _enter_improvements(data, study.baseline, IN_CONDITIONS)
            if f"{AT_SPEEDS}value" in data:
                _enter_improvements(data, study.baseline, AT_SPEEDS)
            self._enter_comparisons()
        if f"{AT_SPEEDS}value" in data:
            data[f"{AT_SPEEDS}value"].attrs["methods"] = " ".join(self._by)
        if study.sweeps:
            return data
        found = {case: outcome.parameters for case, outcome in self.designs.items() if outcome.values}
        return data.isel(point=0).merge(responses(study, found))

    def _once(self, text: str) -> str:
        return self._texts.setdefault(text, text)

    def _enter_values(self, number: int, outcome: Outcome) -> None:
        arrays, index = self._arrays, outcome.index
        best = False  # of infinite values none is; the design that misses the limits by least has its parameters
        for m, method in enumerate(self.study.evaluate):
            values = outcome.values.get(method, {})
            arrays["value"][number, m] = outcome.feasible_values(method).get(index, np.nan)
            arrays["other_value"][number, m] = [values.get(other, np.nan) for other in self.study.indices]
            bounds = outcome.error_bounds.get(method, {})
            arrays["error_bound"][number, m] = bounds.get(index, np.nan)
            arrays["other_error_bound"][number, m] = [bounds.get(other, np.nan) for other in self.study.indices]
            if EFFECT in arrays:
                effects = outcome.shared_errors.get(method, {})
                arrays[EFFECT][number, m] = self._of_road(effects.get(index, {}))
                arrays[OTHER_EFFECT][number, m] = [
                    self._of_road(effects.get(other, {})) for other in self.study.indices
                ]
            errors = {of: error for of, error in outcome.standard_errors.get(method, {}).items() if error is not None}
            arrays["standard_error"][number, m] = errors.get(index, np.nan)
            arrays["other.standard_error"][number, m] = [errors.get(other, np.nan) for other in self.study.indices]
            best = best or isfinite(values.get(index, np.nan))
        for name, parameter in outcome.parameters.items() if best else ():
            place = number, self._columns[name]
            low, high = outcome.ranges.get(name, (parameter, parameter))
            arrays["parameter_value"][place] = parameter
            arrays["parameter_low"][place], arrays["parameter_high"][place] = low, high
            arrays["at_bound"][place] = self._once(outcome.active_bounds.get(name, ""))

    def _enter_scatter(self, number: int, outcome: Outcome) -> None:
        arrays, study = self._arrays, self.study
        arrays["realisations"][number] = [outcome.realisations.get(method, 0) for method in study.evaluate]
        over = outcome.over_linear or (np.nan, np.nan)
        arrays["over_linear"][number], arrays["over_linear_error"][number] = over
        for m, method in enumerate(study.evaluate) if study.baseline is not None else ():
            if outcome.standard_errors.get(method, {}).get(outcome.index) is not None:
                self._samples["", (number, m)] = np.array(outcome.samples.get(method, ()))
                if controls := outcome.controls.get(method):
                    self._controls[number, m] = np.array(controls)

    def _enter_conditions(self, number: int, outcome: Outcome) -> None:
        arrays, baseline = self._arrays, self.study.baseline
        for m, method in enumerate(self.study.evaluate):
            known = outcome.in_conditions.get(method, ()) if outcome.feasible_values(method) else ()
            for c, found in enumerate(known):
                for name in ("value", "error_bound", "standard_error"):
                    arrays[f"{IN_CONDITIONS}{name}"][number, m, c] = np.nan if found[name] is None else found[name]
                if EFFECT in arrays:
                    arrays[f"{IN_CONDITIONS}{EFFECT}"][number, m, :, c] = self._of_road(found["shared_errors"])
                if self._uncertain and baseline is not None and found["standard_error"] is not None:
                    self._samples[IN_CONDITIONS, (number, m, c)] = np.array(found["samples"])

    def _of_road(self, effects: Mapping[str, Sequence[float]]) -> list[float]:
        """Effects of the errors of the road, zero where there is none."""
        return [effect for name, none in self._no_effects.items() for effect in effects.get(name, none)]

    def _enter_comparisons(self) -> None:
        """Improvements of values that scatter: by the differences on the same roads, with their standard errors."""
        for of, place in self._samples:
            number, *labels = place
            base = self.cases.number(replace(self.cases[number], layout=str(self.study.baseline)))
            both = [(of, place), (of, (base, *labels))]
            values = [float(self._arrays[f"{of}value"][at]) for _, at in both]
            if number != base and both[1] in self._samples and np.isfinite(values).all():
                two = self._compare(*both)
                self._arrays[f"{of}improvement"][place] = -two.percent
                self._arrays[f"{of}improvement_error"][place] = two.percent_error

    def _compare(self, *both: _Scattered) -> Comparison:
        """Comparison of a value with another one, on the roads that both have."""
        count = min((size for key in both if (size := self._samples[key].size)), default=0)
        known = [self._controls.get(place, np.zeros(0)) for _, place in both]
        size = max(one.size for one in known)
        one, other = (self._estimate(key, count) for key in both)
        controls = [
            np.zeros(size) if estimate.standard_error == 0.0 else own
            for own, estimate in zip(known, (one, other), strict=True)
        ]
        if not size or any(own.size != size for own in controls):
            return compare_estimates(one, other)
        return compare_estimates(one, other, [(own[:count], own[count:]) for own in controls])

    def _estimate(self, key: _Scattered, count: int) -> Estimate:
        """Estimate of a case's own index with its first samples."""
        of, place = key
        value, error = (float(self._arrays[f"{of}{name}"][place]) for name in ("value", "standard_error"))
        return Estimate(value, "", standard_error=error, samples=tuple(self._samples[key][:count].tolist()))


def _enter_improvements(data: xr.Dataset, baseline: str, of: str = "") -> None:
    """Improvements over the baseline and their bounds; `of` begins the names of the variables."""
    values, bounds = data[f"{of}value"], data[f"{of}error_bound"]
    base = values.sel(layout=baseline, drop=True)
    base = base.where(np.isfinite(base))  # nothing is a share of an infinite value
    data[f"{of}improvement"][:] = (100.0 * (1.0 - values / base)).transpose(*values.dims).values
    of_base = bounds.sel(layout=baseline, drop=True)
    errors = bounds + of_base
    if EFFECT in data:  # of what both share, the difference counts
        effects = data[f"{of}{EFFECT}"]
        other = effects.sel(layout=baseline, drop=True)
        errors = errors + _size(effects - other) - _size(effects) - _size(other)
    widest = (100.0 * abs(values / base) * errors / (1.0 - of_base)).where(of_base < 1.0, np.inf)
    data[f"{of}improvement_bound"][:] = widest.where(np.isfinite(errors * values / base)).transpose(*values.dims).values


def _size(effects: xr.DataArray) -> xr.DataArray:
    """Bounds of errors of the road, from their effects in the last dimension, as `size_of_effects` has them."""
    of = effects[ROAD_ERROR].values
    sizes = [(effects.isel({ROAD_ERROR: of == name}) ** 2).sum(ROAD_ERROR) ** 0.5 for name in ROAD_ERRORS]
    return sum(sizes[1:], sizes[0])


class Pending:
    """The cases that had no outcome when this was made, each made when its turn comes."""

    def __init__(self, found: DatasetBuilder) -> None:
        self._cases = found.cases
        self._numbers = np.flatnonzero(~found.done)

    def __len__(self) -> int:
        return int(self._numbers.size)

    def __iter__(self) -> Iterator[Case]:
        return (self._cases[int(number)] for number in self._numbers)


def dataset(study: Study, outcomes: Mapping[Case, Outcome]) -> xr.Dataset:
    """Dataset of all outcomes: dimensions layout, index, swept places, method, parameter.

    Improvements are per cent below the baseline's own optimum of the same index, method and swept value. Where a method
    other than the norm is used, there are standard errors and numbers of realisations too.
    """
    found = DatasetBuilder(study)
    for outcome in outcomes.values():
        found.enter(outcome)
    return found.dataset()


def by_case(data: xr.Dataset, name: str) -> NDArray[Any]:
    """A variable with all designs in one dimension, in the order of the cases; its own memory."""
    array = data[name].values
    return array.reshape(data["status"].size, *array.shape[data["status"].ndim :])


def _empty_dataset(study: Study, parameters: Mapping[str, str]) -> xr.Dataset:
    """The dataset without numbers: dimensions, labels, units, and what each variable is."""
    swept = {sweep.label: len(sweep.values) for sweep in study.sweeps} or {"point": 1}
    sizes = {
        "layout": len(study.layouts),
        "index": len(study.indices),
        **swept,
        "method": len(study.evaluate),
        "other": len(study.indices),
        "parameter": len(parameters),
        "limit": len(study.limits),
        _SPEED: len(BESIDE),
        ROAD_ERROR: len(_road_errors(study)),
        CONDITION: len(study.conditions),
    }
    variables = {}
    for name, (more, empty, long_name) in _variables_of(study).items():
        dims = ("layout", "index", *swept, *more)
        array = np.full([sizes[dim] for dim in dims], empty, dtype=object if isinstance(empty, str) else None)
        variables[name] = (dims, array, {"long_name": long_name})
    data = xr.Dataset(variables, _labels_of(study, parameters))
    for name, number in DESIGN_NUMBERS.items():
        data[f"{NUMBER}{name}.value"].attrs.update(units=number.unit, heading=number.heading)
    if study.limits:
        data["limit_value"].attrs["basis"] = limit_basis(study)
    for name in PERCENT & set(variables):
        data[name].attrs["units"] = "percent"
    return data


def _variables_of(study: Study) -> dict[str, _Variable]:
    """Variables of the results: those of every study, then those of what it declares."""
    values = {**_VARIABLES, **(UNCERTAIN if is_uncertain(study) else {}), **(MEASURED if is_measured(study) else {})}
    return {
        **values,
        **(LIMITED if study.limits else {}),
        **(_at_speeds_of(values) if is_at_one_speed(study) else {}),
        **(_conditions_of(values) if study.conditions else {}),
        **{
            f"{NUMBER}{name}.{end}": one
            for name, number in DESIGN_NUMBERS.items()
            for end, one in number.variables().items()
        },
    }


def _labels_of(study: Study, parameters: Mapping[str, str]) -> dict[str, Any]:
    """Labels of the dimensions: of every study, then of what it declares; `parameters` has their units by name."""
    labels: dict[str, Any] = {
        "layout": list(study.layouts),
        "elements": ("layout", [len(study.design(layout).mechanism().strut_elements()) for layout in study.layouts]),
        "index": list(study.indices),
        "method": list(study.evaluate),
        "method_words": ("method", list(method_labels(study).values())),
        "other": list(study.indices),
        "parameter": list(parameters),
        "parameter_unit": ("parameter", list(parameters.values())),
        "index_unit": ("index", [study.unit(name) for name in study.indices]),
        "index_title": ("index", [study.objective_title(name) for name in study.indices]),
    }
    if study.limits:
        stated = [(one, "(swept)" if is_swept(study, one) else one.value_text) for one in study.limits]
        labels["limit"] = [f"{one.words} {text}" for one, text in stated]
        labels["limit_unit"] = ("limit", [limit.unit for limit in study.limits])
        labels["limit.words"] = ("limit", [limit_text(study, *one) for one in stated])
        labels["limit.each"] = ("limit", [each_of(study, limit) for limit in study.limits])
    if study.road is not None and is_at_one_speed(study):
        labels[_SPEED] = (_SPEED, [part * study.road.speed for part in BESIDE], {"units": "m/s"})
    if is_measured(study):
        labels[ROAD_ERROR] = list(_road_errors(study))
    if study.conditions:
        shares = np.array([condition.share for condition in study.conditions])
        labels[CONDITION] = (CONDITION, study.condition_labels, {"over": study.over})
        labels[f"{IN_CONDITIONS}share"] = (CONDITION, shares / shares.sum())
    for sweep in study.sweeps:
        written = {"written": sweep.written} if sweep.written else {}
        attributes = {"units": sweep.unit, "long_name": sweep.words, **written}
        labels[sweep.label] = (sweep.label, list(sweep.values), attributes)
    return labels


def units_by_name(data: xr.Dataset, of: str) -> dict[str, str]:
    """Units of the indices or design variables of a dataset, by name; `of` is "index" or "parameter"."""
    return dict(zip(data[of].values.tolist(), data[f"{of}_unit"].values.tolist(), strict=True))


def is_measured(study: Study) -> bool:
    """Whether the road of a study is the line of a measured profile, of which values have common errors."""
    return study.road is not None and study.road.shape is not None


def _road_errors(study: Study) -> tuple[str, ...]:
    """Source of each effect of an error of the measured road: the last has one in each band of its spectrum."""
    bands = len(study.road.shape.ratio) if study.road is not None and study.road.shape is not None else 0
    return (*ROAD_ERRORS[:-1], *(ROAD_ERRORS[-1:] * bands))


def is_uncertain(study: Study) -> bool:
    """Whether some method is not one of the linear model, which knows its numbers."""
    return not all(map(is_blind, study.methods))


_VARIABLES: dict[str, _Variable] = {
    "value": (("method",), np.nan, "index at the optimum of that index"),
    "standard_error": (("method",), np.nan, "standard error of the value"),
    "error_bound": (("method",), np.nan, "largest relative error of the value, sampling apart"),
    "improvement": (("method",), np.nan, "improvement over the baseline"),
    "improvement_bound": (("method",), np.nan, "largest error of the improvement, sampling apart"),
    "other_value": (("method", "other"), np.nan, "other indices of the same design"),
    "other_error_bound": (("method", "other"), np.nan, "their largest relative errors, sampling apart"),
    "other.standard_error": (("method", "other"), np.nan, "their standard errors"),
    "parameter_value": (("parameter",), np.nan, "parameter at the optimum"),
    "parameter_low": (("parameter",), np.nan, "least among equally good optima"),
    "parameter_high": (("parameter",), np.nan, "largest among equally good optima"),
    "at_bound": (("parameter",), "", "bound that holds the parameter"),
    "status": ((), "missing", "status"),
    "starts": ((), 0, "local searches"),
    "agreed": ((), 0, "local searches that found this optimum"),
    "evaluations": ((), 0, "evaluations of the index"),
}


LIMITED: dict[str, _Variable] = {
    "limit_value": (("limit",), np.nan, "what is limited, where it comes closest to its limit"),
    "limit_active": (("limit",), False, "whether the limit holds the optimum back"),
    "limit_cost": (("limit",), np.nan, "change of the index for one per cent more of the limit"),
    "limit.part": (("limit",), "", "tyre or strut, and condition, that come closest"),
    "limit.standard_error": (("limit",), np.nan, "standard error of what is limited"),
    "limit.error_bound": (("limit",), np.nan, "its largest relative error, sampling apart"),
}
UNCERTAIN: dict[str, _Variable] = {
    "improvement_error": (("method",), np.nan, "standard error of the improvement"),
    "realisations": (("method",), 0, "random roads that were averaged"),
    "over_linear": ((), np.nan, "improvement over the best linear design by the method of the search"),
    "over_linear_error": ((), np.nan, "standard error of that improvement"),
}
# names with a point, which no element can have, so that a sweep of any element has its own dimension
MEASURED: dict[str, _Variable] = {
    EFFECT: (("method", ROAD_ERROR), 0.0, "relative effect of an error of the road on the value"),
    OTHER_EFFECT: (("method", "other", ROAD_ERROR), 0.0, "its effects on other indices of the same design"),
}

_VARIED = (EFFECT, "value", "standard_error", "error_bound", "improvement", "improvement_bound", "improvement_error")
_AT_SPEEDS = (EFFECT, "value", "error_bound", "improvement", "improvement_bound")
_SPEED = f"{AT_SPEEDS}speed"
PERCENT = {"limit_cost", "over_linear", "over_linear_error"} | {
    f"{of}improvement{end}" for of in ("", IN_CONDITIONS, AT_SPEEDS) for end in ("", "_bound", "_error")
}


def _conditions_of(variables: Mapping[str, _Variable]) -> dict[str, _Variable]:
    """Variables in each condition, of those that are the index over all of them."""
    return {
        f"{IN_CONDITIONS}{name}": ((*more, CONDITION), empty, f"{words}, in each condition")
        for name, (more, empty, words) in variables.items()
        if name in _VARIED
    }


def _at_speeds_of(variables: Mapping[str, _Variable]) -> dict[str, _Variable]:
    """Variables of the same design at other speeds, by the one method of them."""
    each = {
        f"{AT_SPEEDS}{name}": ((*(dim for dim in more if dim != "method"), _SPEED), empty, f"{words}, at other speeds")
        for name, (more, empty, words) in variables.items()
        if name in _AT_SPEEDS
    }
    return {**each, f"{AT_SPEEDS}message": ((), "", "what makes those values doubtful")}


def _status(outcome: Outcome, kind: str) -> str:
    return kind if kind == _OK or not outcome.message else f"{kind}: {outcome.message}"
