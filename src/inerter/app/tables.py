"""The numbers of a panel as CSV, each so that it reads back as the same."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import chain
from typing import Any

from inerter.app.answers import answer_panel
from inerter.errors import StudyError
from inerter.formatting import label_with_unit
from inerter.table import csv_text

Rows = Iterable[list[Any]]


def as_csv(panel: str, request: Mapping[str, Any]) -> str:
    """The answer of a panel as a table; raises `StudyError` for a panel that is none, and what it raises."""
    if panel not in _TABLES:
        raise StudyError(f"The panel {panel!r} has no table; available: {', '.join(_TABLES)}.")
    return csv_text(_TABLES[panel](answer_panel(panel, request)))


def _indices(answer: Mapping[str, Any]) -> Rows:
    said = (
        "index",
        "method",
        "value",
        "unit",
        "standard_error",
        "error_bound",
        "improvement_percent",
        "improvement_error_percent",
        "improvement_status",
        "tie",
        "status",
    )
    names = list(dict.fromkeys(chain.from_iterable(design["values"] for design in answer["designs"])))
    units = {name: told["unit"] for design in answer["designs"] for name, told in design["values"].items()}
    yield ["design", "layout", *said, *(label_with_unit(name, units[name]) for name in names)]
    for design in answer["designs"]:
        values = [design["values"].get(name, {}).get("value") for name in names]
        for result in design["results"]:
            yield [design["name"], design["layout"], *(result[key] for key in said), *values]


def _response(answer: Mapping[str, Any]) -> Rows:
    curves = answer["curves"]
    names = [f"{c['name']} {c['index']} {c['label']}" for c in curves]
    gains = [label_with_unit(name, curve["unit"]) for name, curve in zip(names, curves, strict=True)]
    yield ["frequency [Hz]", *gains, *(label_with_unit(f"phase of {name}", "rad") for name in names)]
    columns = [answer["frequency"], *(curve[what] for what in ("gain", "phase") for curve in curves)]
    yield from (list(row) for row in zip(*(column.tolist() for column in columns), strict=True))


def _history(answer: Mapping[str, Any]) -> Rows:
    """Rows of each output at its own times, those of local extremes."""
    yield ["output", "time [s]", "value", "unit"]
    for signal in answer["signals"]:
        for time, value in zip(signal["time"].tolist(), signal["values"].tolist(), strict=True):
            yield [signal["name"], time, value, signal["unit"]]


def _tolerance(answer: Mapping[str, Any]) -> Rows:
    """Rows on the distribution of the index, then first- and total-order Sobol' indices of each value."""
    yield [label_with_unit(answer["index"], answer["unit"]), "value"]
    yield ["status", ": ".join(filter(None, (answer["status"], answer["message"])))]
    for name in ("nominal", "mean", "standard_deviation"):
        yield [name, answer[name]]
    yield from ([f"quantile {share}", value] for share, value in answer["quantiles"].items())
    yield ["worst", answer["worst"]]
    yield from ([f"variance from {name}, main effect", share] for name, share in answer["main"].items())
    yield from ([f"variance from {name}, total effect", share] for name, share in answer["total"].items())


_TABLES: dict[str, Callable[[Mapping[str, Any]], Rows]] = {
    "indices": _indices,
    "compare": _indices,
    "response": _response,
    "history": _history,
    "tolerance": _tolerance,
}
