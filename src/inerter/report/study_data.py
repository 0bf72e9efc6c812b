"""The results of a study as data: what `inerter run --json` prints."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from textwrap import indent
from typing import Any

import numpy as np
import xarray as xr

from inerter.figures.labels import swept_places
from inerter.files.study.running import StudyResult
from inerter.files.study.tasks import by_task
from inerter.formatting import shown_decimals
from inerter.report.json_data import json_data
from inerter.report.speeds import at_speeds
from inerter.report.verdicts import study_decision

_DIGITS = 5  # of a value, at most, without a standard error
_JSON = {"improvement_error": "improvement_error_percent"}


def as_text(result: StudyResult) -> Iterator[str]:
    """All results as JSON, in pieces, so that a list of a million designs is never in memory."""
    further = {task.key: [one.to_json() for one in own] for task, own in by_task(result.answers).items()}
    swept = [
        {"name": place, "words": result.data[place].attrs["long_name"], "unit": result.data[place].attrs["units"]}
        for place in swept_places(result.data)
    ]
    verdicts = {} if swept else {"verdicts": list(_verdicts(result))}
    whole = json.dumps({**result.data.attrs, "swept": swept, **verdicts, "designs": [None], **further}, indent=2)
    before, _, after = whole.partition("\n    null")  # no text of JSON has the end of a line in it
    separator = "\n"
    yield before
    for design in _designs(result):
        yield separator + indent(json.dumps(design, indent=2), "    ")
        separator = ",\n"
    yield f"{after}\n"


def _verdicts(result: StudyResult) -> Iterator[dict[str, Any]]:
    """Verdict on each index with its caveats, for JSON."""
    for index in result.data["index"].values.tolist():
        verdict = study_decision(result.data, index, result.study).verdict
        caveats = [{"sentence": one.sentence, "severity": one.severity.value} for one in verdict.caveats]
        yield {"index": index, "sentence": verdict.sentence, "severity": verdict.answer.value, "caveats": caveats}


def _designs(result: StudyResult) -> Iterator[dict[str, Any]]:
    """Data of each design and method, for JSON."""
    data = result.data
    errors = [name for name in ("standard_error", "improvement_error", "realisations") if _is_known(data, name)]
    errors = ["error_bound", *errors] if "error_bound" in data else errors
    arrays = {name: data[name].values for name in ("value", "improvement", "status", "parameter_value", *errors)}
    labels = {str(dim): data[dim].values.tolist() for dim in data.value.dims}
    units = dict(zip(labels["index"], data.index_unit.values.tolist(), strict=True))
    parameters = data.parameter.values.tolist()
    where = data.value.dims.index("method")
    for place in np.ndindex(data.value.shape):
        design = place[:where] + place[where + 1 :]
        names = {dim: column[i] for (dim, column), i in zip(labels.items(), place, strict=True)}
        values = zip(parameters, arrays["parameter_value"][design].tolist(), strict=True)
        yield {
            **names,
            "value": json_data(arrays["value"][place].item()),
            "decimals": _decimals(arrays, place),
            "unit": units[names["index"]],
            "improvement_percent": json_data(arrays["improvement"][place].item()),
            **{_JSON.get(name, name): json_data(arrays[name][place].item()) for name in errors},
            **({"at_speeds": at_speeds(data, names)} if "at_speeds.value" in data else {}),
            **({"limits": _limits(data, names)} if "limit" in data.dims else {}),
            "status": arrays["status"][design],
            "parameters": {name: value for name, value in values if np.isfinite(value)},
        }


def _is_known(data: xr.Dataset, name: str) -> bool:
    """Whether a variable says something: where designs were simulated, and errors also of a quantile."""
    return name in data and ("realisations" in data or bool(np.isfinite(data[name]).any()))


def _limits(data: xr.Dataset, names: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Value, activity and sensitivity of each limit of one design, with the tyre or strut concerned."""
    entry = data[["limit_value", "limit_active", "limit_cost", "limit.part"]].sel(
        {name: value for name, value in names.items() if name in data["limit_value"].dims}
    )
    return [
        {
            "limit": limit,
            "words": str(data["limit.words"].values[i]),
            "each": str(data["limit.each"].values[i]),
            "part": str(entry["limit.part"].values[i]),
            "value": json_data(float(entry["limit_value"].values[i])),
            "active": bool(entry["limit_active"].values[i]),
            "cost_percent": json_data(float(entry["limit_cost"].values[i])),
        }
        for i, limit in enumerate(data["limit"].values.tolist())
    ]


def _decimals(arrays: Mapping[str, Any], place: tuple[int, ...]) -> int | None:
    """Decimal places that the uncertainty of the value of one design and method justifies; None if it is not finite."""
    error, bound = (
        arrays[name][place].item() if name in arrays else np.nan for name in ("standard_error", "error_bound")
    )
    return shown_decimals(arrays["value"][place].item(), error, bound, _DIGITS)
