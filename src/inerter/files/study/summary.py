"""The table of a study's results: one row a design and method."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from inerter.atomic_io import open_text
from inerter.files.study.cases import Case, cases
from inerter.files.study.conditions import IN_CONDITIONS, condition_labels
from inerter.files.study.design_numbers import DESIGN_NUMBERS, number_entry, numbers_in
from inerter.files.study.results import PERCENT, UNCERTAIN, by_case, is_uncertain, units_by_name
from inerter.files.study.study import Study
from inerter.formatting import label_with_unit
from inerter.table import csv_cells

_AT_ONCE = 10_000  # designs that are made plain numbers together


def write_summary(path: Path, study: Study, data: xr.Dataset) -> None:
    """Write each design and method: labels, value, improvement over the baseline, and parameters."""
    with open_text(path) as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(_header(study, data))
        writer.writerows(map(csv_cells, _rows(study, data)))


def bounds_text(active: Mapping[str, str]) -> str:
    """Active bounds by parameter, such as "b:upper"; empty where there are none."""
    return ";".join(f"{name}:{end}" for name, end in active.items() if end)


def _header(study: Study, data: xr.Dataset) -> list[str]:
    return [
        *("layout", "index", "method"),
        *(label_with_unit(sweep.label, sweep.unit) for sweep in study.sweeps),
        *("value", "unit", "improvement_percent", "standard_error", "error_bound", "status"),
        *(f"{name}_percent" if name in PERCENT else name for name in _more(study)),
        *(label_with_unit(name, unit) for name, unit in units_by_name(data, "parameter").items()),
        *("at_bound", "starts", "agreed"),
        *(label_with_unit(f"{name} of this design", unit) for name, unit in units_by_name(data, "index").items()),
        *(
            text
            for limit in study.limits
            for text in (label_with_unit(limit.words, limit.unit), f"cost of {limit.words}_percent")
        ),
        *(f"part of {study.limits[i].words}" for i in _on_parts(data)),
        *(
            text
            for name in numbers_in(data)
            for text in (label_with_unit(name, DESIGN_NUMBERS[name].unit), f"{name}.error_bound", f"{name}.status")
        ),
        *(
            text
            for label in condition_labels(study.conditions)
            for text in (f"value in {label}", f"improvement in {label}_percent")
        ),
    ]


def _on_parts(data: xr.Dataset) -> list[int]:
    """Numbers of the limits that apply to each tyre or strut separately."""
    return [i for i, each in enumerate(data["limit.each"].values.tolist()) if each] if "limit.each" in data else []


def _more(study: Study) -> list[str]:
    return list(UNCERTAIN) if is_uncertain(study) else []


def design_rows(data: xr.Dataset, study: Study) -> Iterator[tuple[Case, str, dict[str, Any]]]:
    """Each design and method, with all that the dataset has of it, by variable: numbers, texts, and lists of them."""
    everything = cases(study)
    by_method = {name for name in data.data_vars if "method" in data[name].dims}
    arrays = {
        str(name): by_case(data, str(name)) for name in data.data_vars if {"layout", "index"} <= {*data[name].dims}
    }
    for start in range(0, len(everything), _AT_ONCE):
        part = {name: array[start : start + _AT_ONCE].tolist() for name, array in arrays.items()}
        for i in range(len(part["status"])):
            design = {name: column[i] for name, column in part.items()}
            for m, method in enumerate(study.evaluate):
                row = {name: value[m] if name in by_method else value for name, value in design.items()}
                yield everything[start + i], method, row


def _rows(study: Study, data: xr.Dataset) -> Iterator[list[Any]]:
    more, parts, numbers = _more(study), _on_parts(data), numbers_in(data)
    parameters = data.parameter.values.tolist()
    units = units_by_name(data, "index")
    for case, method, row in design_rows(data, study):
        yield [
            case.layout,
            case.index,
            method,
            *case.swept,
            *(row["value"], units[case.index], row["improvement"]),
            *(row["standard_error"], row["error_bound"], row["status"]),
            *(row[name] for name in more),
            *row["parameter_value"],
            *(bounds_text(dict(zip(parameters, row["at_bound"], strict=True))), row["starts"], row["agreed"]),
            *row["other_value"],
            *(row[name][i] for i in range(len(study.limits)) for name in ("limit_value", "limit_cost")),
            *(row["limit.part"][i] for i in parts),
            *(content for name in numbers for content in number_entry(name, row).values()),
            *(
                row[f"{IN_CONDITIONS}{name}"][i]
                for i in range(len(study.conditions))
                for name in ("value", "improvement")
            ),
        ]
