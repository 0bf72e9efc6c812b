"""The reproduction of a paper as plain rows, one list for each file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from inerter.papers.wang_su_2008.origins import origins
from inerter.papers.wang_su_2008.report.tables import (
    budgets_table,
    design_tables,
    linear_tables,
    optima_table,
    rig_table,
    rows_of,
    simulated_tables,
)
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.records.result import Response
from inerter.table import csv_text, records


def tables(found: Reproduction) -> dict[str, list[dict[str, Any]]]:
    """The reproduction as plain rows, by the name of the file that holds them."""
    return {
        **_rig_tables(found),
        "linear-rows": list(rows_of(linear_tables(found))),
        "designs": list(rows_of(design_tables(found))),
        "simulated-rows": list(rows_of(simulated_tables(found))),
        "curves": list(_curve_rows(found)),
        "claims": [
            {
                "claim": c.number,
                "statement": c.statement,
                "verdict": str(c.verdict),
                "printed_numbers": str(c.printed_numbers or ""),
                "evidence": c.evidence,
            }
            for c in found.claims
        ],
        "methods": method_points(found),
        "optima": list(rows_of(filter(None, [optima_table(found)]))),
        "budgets": list(rows_of(filter(None, [budgets_table(found)]))),
        "origins": [{"title": o.title, "text": o.text} for o in origins(found)],
    }


def data_csv(rows: list[dict[str, Any]]) -> str:
    """Rows as CSV, with a column for each of their keys."""
    keys = list(dict.fromkeys(key for row in rows for key in row))
    return csv_text([keys, *(list(map(row.get, keys)) for row in rows)])


def _rig_tables(found: Reproduction) -> dict[str, list[dict[str, Any]]]:
    """The virtual rig: parameters, and the curves of Figures 8 to 10."""
    table, rig = rig_table(found), found.rig
    if table is None or rig is None:
        return {}
    units = {"time": "s", "displacement": "m", "force": "N", "model": "N"}
    motions = {}
    for name, part in (("figure8", rig.friction), ("figure9", rig.fit)):
        columns = {f"{key} [{units[key]}]": part[key].tolist() for key in part}
        motions[name] = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
    return {"rig": records(table), **motions, "figure10": list(_response_rows(rig.responses))}


def _response_rows(responses: dict[str, Response]) -> Iterator[dict[str, Any]]:
    for name, response in responses.items():
        columns = {"frequency [Hz]": response.frequency, **response.columns()}
        del columns["averages"]
        for values in zip(*(column.tolist() for column in columns.values()), strict=True):
            yield {"response": name, **dict(zip(columns, values, strict=True))}


def _curve_rows(found: Reproduction) -> Iterator[dict[str, Any]]:
    if found.curves is None:
        return
    data = found.curves
    for layout in data["layout"].values.tolist():
        for index in data["index"].values.tolist():
            here = data.sel(layout=layout, index=index)
            for i, k in enumerate(data["k"].values.tolist()):
                yield {
                    "layout": layout,
                    "index": index,
                    "k [N/m]": k,
                    "value": float(here["value"][i]),
                    "standard_error": float(here["standard_error"][i]),
                    "improvement_percent": float(here["improvement"][i]),
                    "status": str(here["status"][i].item()),
                }


def method_points(found: Reproduction) -> list[dict[str, Any]]:
    points = []
    for name, numbers in found.methods.items():
        index, layout, force = name.split()
        kept = {key: value for key, value in numbers.items() if key != "seconds"}
        points.append({"index": index, "layout": layout, "friction": float(force), **kept})
    return points
