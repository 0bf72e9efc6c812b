"""The results of a study as data: what `inerter run --json` prints."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from textwrap import indent
from typing import Any

import numpy as np
import xarray as xr

from inerter.figures.labels import swept_places
from inerter.files.study.conditions import CONDITION, IN_CONDITIONS
from inerter.files.study.design_numbers import number_entry, numbers_in
from inerter.files.study.results import units_by_name
from inerter.files.study.running import StudyResult
from inerter.files.study.summary import design_rows
from inerter.files.study.tasks import by_task
from inerter.formatting import shown_decimals
from inerter.report.json_data import json_data
from inerter.report.speeds import at_speeds
from inerter.report.verdicts import study_decision

_DIGITS = 5  # of a value, at most, without a standard error
_JSON = {"improvement_error": "improvement_error_percent"}


def as_data(result: StudyResult) -> dict[str, Any]:
    """All results as data for JSON."""
    return _with_designs(result, list(_designs(result)))


def as_text(result: StudyResult) -> Iterator[str]:
    """All results as JSON, in pieces, so that a list of a million designs is never in memory."""
    whole = json.dumps(_with_designs(result, [None]), indent=2)
    before, _, after = whole.partition("\n    null")  # no text of JSON has the end of a line in it
    separator = "\n"
    yield before
    for design in _designs(result):
        yield separator + indent(json.dumps(design, indent=2), "    ")
        separator = ",\n"
    yield f"{after}\n"


def _with_designs(result: StudyResult, designs: Sequence[Any]) -> dict[str, Any]:
    further = {task.key: [one.to_json() for one in own] for task, own in by_task(result.answers).items()}
    swept = [
        {"name": place, "words": result.data[place].attrs["long_name"], "unit": result.data[place].attrs["units"]}
        for place in swept_places(result.data)
    ]
    verdicts = {} if swept else {"verdicts": list(_verdicts(result))}
    return {**result.data.attrs, "swept": swept, **verdicts, "designs": designs, **further}


def _verdicts(result: StudyResult) -> Iterator[dict[str, Any]]:
    """Verdict on each index with its caveats, for JSON."""
    for index in result.data["index"].values.tolist():
        yield {"index": index, **study_decision(result.data, index, result.study).verdict.to_json()}


def _designs(result: StudyResult) -> Iterator[dict[str, Any]]:
    """Data of each design and method, for JSON."""
    data, study = result.data, result.study
    errors = [name for name in ("standard_error", "improvement_error", "realisations") if _is_known(data, name)]
    units = units_by_name(data, "index")
    parameters, numbers = data.parameter.values.tolist(), numbers_in(data)
    for case, method, row in design_rows(data, study):
        swept = {sweep.label: value for sweep, value in zip(study.sweeps, case.swept, strict=True)}
        names = {"layout": case.layout, "index": case.index, **swept, "method": method}
        values = zip(parameters, row["parameter_value"], strict=True)
        yield {
            **names,
            "value": json_data(row["value"]),
            "decimals": shown_decimals(row["value"], row["standard_error"], row["error_bound"], _DIGITS),
            "unit": units[case.index],
            "improvement_percent": json_data(row["improvement"]),
            **{_JSON.get(name, name): json_data(row[name]) for name in ("error_bound", *errors)},
            **({"at_speeds": at_speeds(data, names)} if "at_speeds.value" in data else {}),
            **({"in_conditions": _in_conditions(data, row, errors)} if CONDITION in data.dims else {}),
            **({"limits": _limits(data, row)} if "limit" in data.dims else {}),
            **{name: json_data(number_entry(name, row)) for name in numbers},
            "status": row["status"],
            "parameters": {name: value for name, value in values if np.isfinite(value)},
        }


def _in_conditions(data: xr.Dataset, row: Mapping[str, Any], errors: Sequence[str]) -> list[dict[str, Any]]:
    """Value of one design in each operating condition, with its errors and its improvement over the baseline there."""
    own = {name.removeprefix(IN_CONDITIONS): row[name] for name in row if name.startswith(IN_CONDITIONS)}
    known = [name for name in ("error_bound", *errors) if name in own]
    return [
        {
            "condition": label,
            "share": share,
            "value": json_data(own["value"][i]),
            "decimals": shown_decimals(own["value"][i], own["standard_error"][i], own["error_bound"][i], _DIGITS),
            "improvement_percent": json_data(own["improvement"][i]),
            **{_JSON.get(name, name): json_data(own[name][i]) for name in known},
        }
        for i, (label, share) in enumerate(
            zip(*(data[name].values.tolist() for name in (CONDITION, f"{IN_CONDITIONS}share")), strict=True)
        )
    ]


def _is_known(data: xr.Dataset, name: str) -> bool:
    """Whether a variable says something: where designs were simulated, and errors also of a quantile."""
    return name in data and ("realisations" in data or bool(np.isfinite(data[name]).any()))


def _limits(data: xr.Dataset, row: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Value, activity and sensitivity of each limit of one design, with the tyre or strut concerned."""
    names = ("limit", "limit.words", "limit.each")
    found = [row[name] for name in ("limit.part", "limit_value", "limit_active", "limit_cost")]
    return [
        {
            "limit": limit,
            "words": words,
            "each": each,
            "part": part,
            "value": json_data(value),
            "active": active,
            "cost_percent": json_data(cost),
        }
        for limit, words, each, part, value, active, cost in zip(
            *(data[name].values.tolist() for name in names), *found, strict=True
        )
    ]
