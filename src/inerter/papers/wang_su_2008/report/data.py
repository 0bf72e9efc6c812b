"""The reproduction of a paper as plain rows, one list for each file."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from typing import Any

from inerter.papers.wang_su_2008.linear import ComparedRow, FoundDesign
from inerter.papers.wang_su_2008.origins import origins
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rows import DIFFERS, EITHER, OTHER_PEAK, SimulatedRow
from inerter.records.result import Response


def tables(found: Reproduction) -> dict[str, list[dict[str, Any]]]:
    """The reproduction as plain rows, by the name of the file that holds them."""
    linear = found.linear
    return {
        **_rig_tables(found),
        "linear-rows": [_linear_row(c) for c in linear.compared] if linear else [],
        "designs": [_design_row(f) for f in linear.found] if linear else [],
        "simulated-rows": [_simulated_row(row) for row in found.rows.values()],
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
        "optima": [_optimum_row(name, numbers) for name, numbers in found.optima.items()],
        "budgets": [_budget_row(name, numbers) for name, numbers in found.budgets.items()],
        "origins": [{"title": o.title, "text": o.text} for o in origins(found)],
    }


def _rig_tables(found: Reproduction) -> dict[str, list[dict[str, Any]]]:
    """The virtual rig: parameters, and the curves of Figures 8 to 10."""
    if found.rig is None:
        return {}
    rig, units = found.rig, {"time": "s", "displacement": "m", "force": "N", "model": "N"}
    parameters = [
        {
            "parameter": p.name,
            "unit": p.unit,
            "printed": p.printed,
            "identified": p.value if p.value == p.value else None,
            "lower": p.interval[0],
            "upper": p.interval[1],
            "difference_percent": 100.0 * p.difference if p.difference == p.difference else None,
            "identifiability": p.sentence,
        }
        for p in rig.parameters
    ]
    motions = {}
    for name, part in (("figure8", rig.friction), ("figure9", rig.fit)):
        columns = {f"{key} [{units[key]}]": part[key].tolist() for key in part}
        motions[name] = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
    return {"rig": parameters, **motions, "figure10": list(_response_rows(rig.responses))}


def _response_rows(responses: dict[str, Response]) -> Iterator[dict[str, Any]]:
    for name, response in responses.items():
        columns = {"frequency [Hz]": response.frequency, **response.columns()}
        del columns["averages"]
        for values in zip(*(column.tolist() for column in columns.values()), strict=True):
            yield {"response": name, **dict(zip(columns, values, strict=True))}


def csv_text(rows: list[dict[str, Any]]) -> str:
    columns = dict.fromkeys(column for row in rows for column in row)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(columns), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def reason(r: SimulatedRow) -> str:
    """Reason for the difference of a row from the printed value; empty if scatter or rounding explains it."""
    if r.verdict == OTHER_PEAK:
        peak = r.compatible[0]
        return (
            f"the printed value follows the peak at {peak.omega:.1f} rad/s, {peak.gain:.5g} m/N, which is not the "
            "highest; the rule of selection is not printed"
        )
    if r.verdict == EITHER:
        peaks = " or ".join(f"{peak.omega:.1f} rad/s, {peak.gain:.5g} m/N" for peak in r.candidates)
        return f"as from a start at rest at the peak at {peaks}; the printed value is consistent with each of them"
    if r.verdict != DIFFERS:
        return ""
    if r.row.index == "J5" and r.row.table == 2:
        return (
            "the maximum of raw gains has no expected value where friction adds output that is uncorrelated with the "
            "input; the averaging is not printed. Here: smoothed over 0.2 Hz to both sides"
        )
    if not r.row.has_friction and r.score is None:
        return "the printed value differs from the printed linear norm, which is impossible for a linear design"
    return f"{abs(r.score or 0.0):.1f} standard errors off; no convention that was tried explains it"


def _linear_row(c: ComparedRow) -> dict[str, Any]:
    return {
        "table": c.row.table,
        "index": c.row.index,
        "case": c.row.case,
        "layout": c.row.layout,
        "unit": c.unit,
        "printed": c.row.value,
        "paper2008": c.paper2008,
        "exact": c.exact,
        "off_by_last_digits": c.off_by,
        "exact_over_printed_percent": 100.0 * (c.exact / c.row.value - 1.0),
        "agrees": c.agrees,
        **{f"{name} printed": value for name, value in c.row.parameters.items()},
    }


def _design_row(f: FoundDesign) -> dict[str, Any]:
    return {
        "table": f.row.table,
        "index": f.row.index,
        "case": f.row.case,
        "layout": f.row.layout,
        "unit": f.unit,
        "printed": f.row.value,
        "found": f.value,
        "gain_percent": f.gain_percent,
        "agreed": f.agreed,
        "starts": f.starts,
        **{f"{name} printed": value for name, value in f.row.parameters.items()},
        **{f"{name} found": value for name, value in f.parameters.items()},
    }


def _simulated_row(r: SimulatedRow) -> dict[str, Any]:
    return {
        "table": r.row.table,
        "index": r.row.index,
        "case": r.row.case,
        "design": r.row.title,
        "unit": r.unit,
        "printed": r.row.value,
        "paper2008": r.paper2008,
        "paper2008_standard_error": r.paper2008_error,
        "exact": r.exact,
        "exact_standard_error": r.exact_error,
        "difference_percent": 100.0 * r.difference,
        "difference_in_standard_errors": r.score,
        "verdict": r.verdict,
        "reason": reason(r),
        "improvement_printed_percent": r.row.improvement,
        "improvement_percent": r.improvement,
        "nearest_peak_omega": None if r.nearest is None else r.nearest.omega,
        "peaks_from_rest": "; ".join(f"{gain:.6g}" for gain in r.gains_from_rest),
        "peaks": "; ".join(f"{peak.omega:.6g} rad/s: {peak.gain:.6g}" for peak in r.peaks),
    }


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


def _optimum_row(name: str, numbers: dict[str, Any]) -> dict[str, Any]:
    index, layout = name.split()
    parameters = {f"{key} found": value for key, value in numbers["parameters"].items()}
    plain = {key: value for key, value in numbers.items() if key not in ("parameters", "seconds")}
    return {"index": index, "layout": layout, **plain, **parameters}


_OF_BUDGET = ("value", "error", "low", "high", "unit", "status")


def _budget_row(name: str, numbers: dict[str, Any]) -> dict[str, Any]:
    index, layout, what = name.split(maxsplit=2)
    return {"index": index, "layout": layout, "of": what, **{k: numbers[k] for k in _OF_BUDGET}}
