"""The table of a study's results: one row a design and method."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from inerter.atomic_io import open_text
from inerter.files.study.cases import Case, cases
from inerter.files.study.conditions import IN_CONDITIONS
from inerter.files.study.design_numbers import DESIGN_NUMBERS, ENDS, NUMBER, numbers_in
from inerter.files.study.results import PERCENT, UNCERTAIN, by_case, is_uncertain, units_by_name
from inerter.files.study.study import Study
from inerter.formatting import label_with_unit
from inerter.table import csv_cells

_AT_ONCE = 10_000  # designs that are made plain numbers together


def write_summary(path: Path, study: Study, data: xr.Dataset) -> None:
    """Write each design and method: labels, value, improvement over the baseline, and parameters."""
    columns, units = _columns(study, data), units_by_name(data, "index")
    parameters = data.parameter.values.tolist()
    with open_text(path) as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([heading for heading, _, _ in columns])
        for case, method, design in design_rows(data, study):
            at_bound = bounds_text(dict(zip(parameters, design["at_bound"], strict=True)))
            row = {**vars(case), **design, "method": method, "unit": units[case.index], "at_bound": at_bound}
            writer.writerow(csv_cells([row[name] if i is None else row[name][i] for _, name, i in columns]))


def bounds_text(active: Mapping[str, str]) -> str:
    """Active bounds by parameter, such as "b:upper"; empty where there are none."""
    return ";".join(f"{name}:{end}" for name, end in active.items() if end)


def _columns(study: Study, data: xr.Dataset) -> list[tuple[str, str, int | None]]:
    """Heading of each column, name of its contents in a row, and for one of several contents its number."""
    parameters, indices = units_by_name(data, "parameter"), units_by_name(data, "index")
    on_parts = data["limit.each"].values.tolist() if "limit.each" in data else []
    alone = [
        *("value", "unit", "improvement", "standard_error", "error_bound", "status"),
        *(UNCERTAIN if is_uncertain(study) else ()),
    ]
    numbers = [
        (label_with_unit(name, DESIGN_NUMBERS[name].unit) if end == ENDS[0] else f"{name}.{end}", name, end)
        for name in numbers_in(data)
        for end in ENDS
    ]
    return [
        *((name, name, None) for name in ("layout", "index", "method")),
        *((label_with_unit(sweep.label, sweep.unit), "swept", i) for i, sweep in enumerate(study.sweeps)),
        *((f"{name}_percent" if name in PERCENT else name, name, None) for name in alone),
        *((label_with_unit(*one), "parameter_value", i) for i, one in enumerate(parameters.items())),
        *((name, name, None) for name in ("at_bound", "starts", "agreed")),
        *(
            (label_with_unit(f"{name} of this design", unit), "other_value", i)
            for i, (name, unit) in enumerate(indices.items())
        ),
        *(
            column
            for i, limit in enumerate(study.limits)
            for column in (
                (label_with_unit(limit.words, limit.unit), "limit_value", i),
                (f"cost of {limit.words}_percent", "limit_cost", i),
            )
        ),
        *((f"part of {study.limits[i].words}", "limit.part", i) for i, each in enumerate(on_parts) if each),
        *((heading, f"{NUMBER}{name}.{end}", None) for heading, name, end in numbers),
        *(
            column
            for i, label in enumerate(study.condition_labels)
            for column in (
                (f"value in {label}", f"{IN_CONDITIONS}value", i),
                (f"improvement in {label}_percent", f"{IN_CONDITIONS}improvement", i),
            )
        ),
    ]


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
