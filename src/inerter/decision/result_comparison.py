"""Comparison of two folders of results: entries of the studies, and values that differ beyond their errors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from inerter.errors import StudyError
from inerter.figures.labels import layouts, swept_places, swept_text
from inerter.files.common.listing import check_unchanged
from inerter.files.common.suggest import some
from inerter.files.study.chosen_design import load_results
from inerter.files.study.loading import load_study
from inerter.files.study.results import units_by_name
from inerter.files.study.running import RESOLVED
from inerter.methods.averages import NORMAL_QUANTILE
from inerter.statements import Severity, Statement
from inerter.work.journal import leaves

_EQUAL = 2e-9  # relative difference of equally good values
_COMMON = ("layout", "index", "method")
_VARIABLES = ("value", "standard_error", "error_bound", "status", "parameter_value", "parameter_low", "parameter_high")
_WITHOUT_EFFECT = {"title"}  # entries of a study that change no number


@dataclass(frozen=True)
class EntryChange:
    """Entry of a study file that differs, by its key path; None where a study has none."""

    place: str
    first: Any
    second: Any


@dataclass(frozen=True)
class ValueChange:
    """Value of an index of one design [SI] in two results.

    `point` has the swept values as text; `uncertainty` is the difference that the errors of both values explain, and
    `parameters` are the design variables [SI] whose equally good values have no common one.
    """

    layout: str
    index: str
    method: str
    point: tuple[str, ...]
    unit: str
    first: float
    second: float
    uncertainty: float
    statuses: tuple[str, str]
    parameters: dict[str, tuple[float, float]]

    @property
    def is_beyond_errors(self) -> bool:
        """Whether the values differ by more than their errors explain, or only one of them exists."""
        if np.isfinite(self.first) and np.isfinite(self.second):
            return abs(self.second - self.first) > self.uncertainty
        return not np.array_equal(self.first, self.second, equal_nan=True)

    @property
    def percent(self) -> float:
        """Change from the first value to the second [%]; nan where there is none."""
        both = np.isfinite(self.first) and np.isfinite(self.second) and self.first != 0.0
        return 100.0 * (self.second / self.first - 1.0) if both else np.nan


@dataclass(frozen=True)
class ResultComparison(Statement):
    """Comparison of two results: entries of the studies that differ, all common values, and what only one has."""

    entries: tuple[EntryChange, ...]
    values: tuple[ValueChange, ...]
    only_first: tuple[str, ...]
    only_second: tuple[str, ...]
    parameter_units: dict[str, str]

    @property
    def changes(self) -> tuple[ValueChange, ...]:
        """Values that differ beyond their errors."""
        return tuple(one for one in self.values if one.is_beyond_errors)

    @property
    def severity(self) -> Severity:
        """Warning where the results differ, which sets the exit code."""
        return Severity.WARNING if self.changes or self.only_first or self.only_second else Severity.INFO


def compare_results(first: Path, second: Path) -> ResultComparison:
    """Compare two folders of results, by layout, index, method and swept values.

    Two values agree if they differ by no more than the sum of their error bounds and the 95 % confidence interval of
    their difference, as if their random roads were independent; values without an error bound count as exact.

    Raises `StudyError` for a folder without results, and for results that have no value in common.
    """
    one, two = load_results(first), load_results(second)
    swept = swept_places(one)
    if set(swept) != set(swept_places(two)):
        texts = [some(swept_places(each)) or "nothing" for each in (one, two)]
        raise StudyError(f"{first} sweeps {texts[0]}, {second} {texts[1]}; expected results of the same sweep.")
    names = [*_COMMON, *swept]
    labels = [[_labels(each, name) for name in names] for each in (one, two)]
    common = xr.align(one[list(_VARIABLES)], two[list(_VARIABLES)], join="inner")
    if not all(common[0].sizes[name] for name in names):
        lacking = next(name for name in names if not common[0].sizes[name])
        raise StudyError(f"{first} and {second} have no {lacking} in common. Compare results of the same study.")
    return ResultComparison(
        tuple(_entry_changes(first, second)),
        tuple(_value_changes(*common, one, two)),
        tuple(_lacking(names, labels[0], labels[1])),
        tuple(_lacking(names, labels[1], labels[0])),
        units_by_name(one, "parameter"),
    )


def _labels(results: xr.Dataset, name: str) -> list[str]:
    """Labels of a dimension as text."""
    if name in swept_places(results):
        return [swept_text(results, name, value) for value in results[name].values.tolist()]
    found: list[str] = results[name].values.tolist()
    return found


def _lacking(names: list[str], own: list[list[str]], others: list[list[str]]) -> Iterator[str]:
    for name, labels, known in zip(names, own, others, strict=True):
        yield from (f"{name} {label}" for label in labels if label not in known)


def _value_changes(first: xr.Dataset, second: xr.Dataset, *whole: xr.Dataset) -> Iterator[ValueChange]:
    places = swept_places(whole[0])
    units = [units_by_name(results, "index") for results in whole]
    points = [first[place].values.tolist() for place in places]
    shared = set(first["layout"].values.tolist())
    for layout in (name for name in layouts(whole[0]) if name in shared):
        for index, method, point in product(*(first[name].values.tolist() for name in _COMMON[1:]), product(*points)):
            if units[0][index] != units[1][index]:
                raise StudyError(f"Index {index} is in {units[0][index]} and in {units[1][index]}: not the same index.")
            where = {"layout": layout, "index": index, **dict(zip(places, point, strict=True))}
            both = [results.sel(where) for results in (first, second)]
            values = tuple(float(one["value"].sel({"method": method})) for one in both)
            errors = [_zero_if_unknown(one["standard_error"].sel({"method": method})) for one in both]
            bounds = [max(_zero_if_unknown(one["error_bound"].sel({"method": method})), _EQUAL) for one in both]
            yield ValueChange(
                layout,
                index,
                method,
                tuple(swept_text(whole[0], place, value) for place, value in zip(places, point, strict=True)),
                units[0][index],
                values[0],
                values[1],
                bounds[0] * abs(values[0]) + bounds[1] * abs(values[1]) + NORMAL_QUANTILE * hypot(*errors),
                (str(both[0]["status"].item()), str(both[1]["status"].item())),
                dict(_parameter_changes(*both)),
            )


def _zero_if_unknown(value: xr.DataArray) -> float:
    return 0.0 if np.isnan(value) else float(value)


def _parameter_changes(first: xr.Dataset, second: xr.Dataset) -> Iterator[tuple[str, tuple[float, float]]]:
    for name in first["parameter"].values.tolist():
        one, two = first.sel(parameter=name), second.sel(parameter=name)
        apart = max(float(one["parameter_low"]), float(two["parameter_low"])) - min(
            float(one["parameter_high"]), float(two["parameter_high"])
        )
        values = float(one["parameter_value"]), float(two["parameter_value"])
        if apart > 1e-3 * abs(values[0]):
            yield name, values


def _entry_changes(first: Path, second: Path) -> Iterator[EntryChange]:
    """Entries of the two studies that differ, with every default filled in and in SI units."""
    entries = []
    for folder in (first, second):
        check_unchanged(folder, RESOLVED)
        entries.append(dict(leaves(load_study(folder / RESOLVED).to_tables())))
    for place in dict.fromkeys([*entries[0], *entries[1]]):
        one, two = (of.get(place) for of in entries)
        if one != two and place not in _WITHOUT_EFFECT:
            yield EntryChange(place, one, two)
