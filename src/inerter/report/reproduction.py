"""The reproduction of a paper as tables, files and a page."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator
from pathlib import Path
from textwrap import wrap
from typing import Any

from inerter.figures import reproduction as drawn
from inerter.figures.labels import printed, typeset
from inerter.figures.networks import draw_networks
from inerter.networks.elements import Damper, Element, Friction, Gap, Inerter, Network, Spring
from inerter.networks.parser import network
from inerter.papers.wang_su_2008.claims import Claim
from inerter.papers.wang_su_2008.linear import ComparedRow, FoundDesign
from inerter.papers.wang_su_2008.origins import origins
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rows import SimulatedRow
from inerter.papers.wang_su_2008.source import TITLE, study
from inerter.report.page import PageFigure, environment, inline
from inerter.report.tables import Cell, Row, Table
from inerter.report.text import WIDTH
from inerter.study.run import FIGURES, REPORT, write_text

_NETWORKS = "networks"
_DRAWN = {
    "S1": "k | c",
    "S2": "k | c | b",
    "S3": "k | c - b",
    "Ball screw": "(k_s | c_s) - eps - (b | f)",
    "S3 with a ball screw": "k | c - (k_s | c_s) - eps - (b | f)",
}
_KINDS: dict[str, Callable[[float, str], Element]] = {
    "k": Spring,
    "c": Damper,
    "b": Inerter,
    "k_s": Spring,
    "c_s": Damper,
    "f": Friction,
    "eps": Gap,
}
_METHOD_TITLES = {
    "statistical-linearisation": "Statistical linearisation",
    "expected-value": "Expected value (Method 2)",
    "approximate-linear": "Approximated linear model (Method 1)",
}
_SIGNS = {"agrees to the printed digits": "=", "within the tolerance": "~", "differs": "!"}
_CAPTIONS = {
    drawn.FIGURE_11: (
        "Figure 11 anew: optimal indices of the quarter car over the static stiffness, and their improvement over S1, "
        "with an ideal inerter and with an elastic one in its hard (2000 kN/m, 6400 N s/m) and soft setting "
        "(1000 kN/m, 3200 N s/m)."
    ),
    drawn.FIGURE_12: "Figure 12 anew: one period of a road of eq. (17), seed 0.",
    drawn.FIGURE_13: (
        "Figure 13 anew: the optimal linear designs with friction in the inerter, by the approximated linear model "
        "(Method 1). Bands: two standard errors."
    ),
    drawn.FIGURE_14: (
        "Figure 14 anew: ideal inerter, the soft elastic one, friction of 10 N, and both, by the approximated linear "
        "model (Method 1). Bands: two standard errors."
    ),
    drawn.METHODS: (
        "Increase of J1 and J3 by friction, printed designs of Table 1, by three methods; bars: two standard errors. "
        "Method 1 drives the car with white noise of height, which moves the inerter far less than the road does: "
        "friction then weighs about ten times more."
    ),
    _NETWORKS: (
        "The layouts, and the device: spring k, damper c, inerter b; shaft k_s and c_s, backlash eps, friction f."
    ),
}


def write_reproduction(found: Reproduction, folder: Path) -> None:
    """Write the tables as CSV, the figures, and a page that shows all of it, into `folder`."""
    for name, rows in tables(found).items():
        if rows:
            write_text(folder / f"{name}.csv", _csv(rows))
    _draw(found, folder / FIGURES)
    write_text(folder / REPORT, _page(found, folder))


def tables(found: Reproduction) -> dict[str, list[dict[str, Any]]]:
    """The reproduction as plain rows, by the name of the file that holds them."""
    linear = found.linear
    return {
        "linear-rows": [_linear_row(c) for c in linear.compared] if linear else [],
        "designs": [_design_row(f) for f in linear.found] if linear else [],
        "simulated-rows": [_simulated_row(row) for row in found.rows.values()],
        "curves": list(_curve_rows(found)),
        "claims": [
            {"claim": c.number, "statement": c.statement, "verdict": c.verdict, "evidence": c.evidence}
            for c in found.claims
        ],
        "methods": _method_points(found),
        "optima": [_optimum_row(name, numbers) for name, numbers in found.optima.items()],
        "budgets": [_budget_row(name, numbers) for name, numbers in found.budgets.items()],
        "origins": [{"title": o.title, "text": o.text} for o in origins(found)],
    }


def reproduction_text(found: Reproduction) -> str:
    """Everything as plain text of at most 80 columns."""
    lines = [*wrap(TITLE, WIDTH), ""]
    if found.linear is not None:
        lines += [*_linear_text(found.linear.compared), *_designs_text(found.linear.found)]
    for table in (1, 2, 3):
        rows = [row for row in found.rows.values() if row.row.table == table]
        lines += _simulated_text(table, rows) if rows else []
    if found.optima:
        lines += ["Designs that are best with friction; lower: than the best linear design with it.", ""]
        lines += [_optimum_line(name, numbers) for name, numbers in found.optima.items()] + [""]
    if found.budgets:
        lines += ["What a printed design of Table 1 can bear before it is no better than S1.", ""]
        for name, numbers in found.budgets.items():
            lines += wrap(f"{name}: {_budget_value(numbers)}", WIDTH, subsequent_indent="    ")
        lines.append("")
    if found.claims:
        lines += ["Claims", ""]
        lines += [line for claim in found.claims for line in _claim_lines(claim)]
    return "\n".join(lines).rstrip()


# --- Rows of files.


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
        "tolerance_percent": 100.0 * r.tolerance,
        "verdict": r.verdict,
        "reason": reason(r),
        "improvement_printed_percent": r.row.improvement,
        "improvement_percent": r.improvement,
        "omega_followed": r.omega,
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


def _method_points(found: Reproduction) -> list[dict[str, Any]]:
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


def _budget_row(name: str, numbers: dict[str, Any]) -> dict[str, Any]:
    index, layout, what = name.split(maxsplit=2)
    return {"index": index, "layout": layout, "of": what, **{k: v for k, v in numbers.items() if k != "seconds"}}


def _csv(rows: list[dict[str, Any]]) -> str:
    columns = dict.fromkeys(column for row in rows for column in row)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(columns), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def reason(r: SimulatedRow) -> str:
    """Why a row differs from the printed one, as far as can be told; empty if it does not."""
    if r.verdict != "differs":
        return ""
    if r.row.index == "J5" and r.row.table == 2:
        return (
            "a maximum of raw gains has no expectation where friction adds output of its own; how it was averaged "
            "there is not printed. Here: smoothed over 0.2 Hz to both sides"
        )
    if not r.row.has_friction:
        return "the printed value differs from the linear norm beside it, which a linear design cannot do"
    return "no convention that was tried explains the difference"


# --- Plain text.


def _linear_text(compared: list[ComparedRow]) -> list[str]:
    return [
        "Linear designs as printed, computed anew under both conventions; off:",
        "paper2008 less printed, in units of the last printed digit; differs: exact",
        "against printed.",
        "",
        f"{'table':6}{'index':6}{'case':>4}  {'layout':9}{'printed':>12}{'paper2008':>13}{'off':>6}{'exact':>13}"
        f"{'differs':>9}",
        *(_compared_line(c) for c in compared),
        "",
        *wrap(_agreement(compared), WIDTH),
        "",
    ]


def _designs_text(found: list[FoundDesign]) -> list[str]:
    return [
        "Designs found from scratch under paper2008, with the printed ones in brackets;",
        "lower: how far the value lies below the printed one; starts: how many agreed.",
        "",
        f"{'table':6}{'index':6}{'layout':9}{'printed':>12}{'found':>13}{'lower':>9}{'starts':>9}",
        *(line for f in found for line in _found_lines(f)),
        "",
    ]


def _simulated_text(table: int, rows: list[SimulatedRow]) -> list[str]:
    how = "the approximated linear model (Method 1)" if table == 2 else "expected values (Method 2)"
    return [
        *wrap(
            f"Table {table} by {how}; = equal to the printed digits, ~ within the tolerance, ! differs (the report "
            "says why). Standard errors are in simulated-rows.csv.",
            WIDTH,
        ),
        "",
        f"{'index':6}{'design':34}{'printed':>11}{'paper2008':>10}{'':>9}{'exact':>10}",
        *(
            f"{r.row.index:4}{_SIGNS[r.verdict]:2}{r.row.title:34}{r.row.printed:>11}{r.paper2008:>10.5g}"
            f"{100.0 * r.difference:>+7.2f} %{r.exact:>10.4g}"
            for r in rows
        ),
        "",
    ]


def _compared_line(c: ComparedRow) -> str:
    row = c.row
    return (
        f"{row.table:<6}{row.index:6}{row.case:>4}  {row.layout:9}{row.printed:>12}{_digits(c.paper2008):>13}"
        f"{_signed(c.off_by, 1):>6}{_digits(c.exact):>13}{_signed(_share(c)):>7} %"
    )


def _share(c: ComparedRow) -> float:
    return 100.0 * (c.exact / c.row.value - 1.0)


def _signed(value: float, decimals: int = 2) -> str:
    text = f"{value:+.{decimals}f}"
    return text[1:] if float(text) == 0.0 else text


def _digits(value: float) -> str:
    return f"{value:.6g}"


def _with_error(value: float, error: float, digits: int = 6) -> str:
    """A value with its standard error, both to the second digit of the error."""
    if not error > 0.0:
        return f"{value:.{digits}g}"
    power = 0
    while error * 10.0**power < 9.95 and power < 12:
        power += 1
    if abs(value) < 1e-3:
        exponent = int(f"{value:e}".partition("e")[2])
        return f"({_with_error(value * 10.0**-exponent, error * 10.0**-exponent)}) 1e{exponent}"
    return f"{value:.{power}f} ± {error:.{power}f}"


def _agreement(compared: list[ComparedRow]) -> str:
    parts = []
    for table in (1, 2, 3):
        rows = [c for c in compared if c.row.table == table]
        parts.append(f"Table {table}: {sum(c.agrees for c in rows)} of {len(rows)}")
    note = "Table 3 repeats values of Table 2, some with a zero for a digit that was not known."
    return f"Equal to the printed value within one unit of its last digit: {', '.join(parts)}. {note}"


def _found_lines(f: FoundDesign) -> Iterator[str]:
    yield (
        f"{f.row.table:<6}{f.row.index:6}{f.row.layout:9}{f.row.printed:>12}{_digits(f.value):>13}"
        f"{_signed(f.gain_percent):>7} %{f.agreed:>5}/{f.starts}"
    )
    pairs = [f"{name} {value:.6g} ({f.row.parameters[name]:g})" for name, value in f.parameters.items()]
    for i in range(0, len(pairs), 2):
        yield " " * 12 + ", ".join(pairs[i : i + 2])


def _optimum_line(name: str, numbers: dict[str, Any]) -> str:
    parameters = ", ".join(f"{key} {value:.5g}" for key, value in numbers["parameters"].items())
    gain = f"{-numbers['percent']:.2f} % ± {numbers['percent_error']:.2f} %"
    return f"{name:16}{numbers['value']:>11.5g}  lower by {gain:17}  {parameters}"


def _budget_value(numbers: dict[str, Any]) -> str:
    if numbers["value"] != numbers["value"]:
        return str(numbers["status"]).removeprefix("unbounded: ")
    error = numbers["error"]
    about = f" ± {printed(error, numbers['unit'])}" if error else ""
    return f"{printed(numbers['value'], numbers['unit'])}{about}".replace("\N{NO-BREAK SPACE}", " ")


def _claim_lines(claim: Claim) -> Iterator[str]:
    yield from wrap(f"{claim.number}. {claim.statement}", WIDTH, subsequent_indent="   ")
    yield from wrap(f"{claim.verdict.upper()}. {claim.evidence}", WIDTH, initial_indent="   ", subsequent_indent="   ")


# --- Figures and the page.


def _draw(found: Reproduction, folder: Path) -> None:
    draw_networks(_networks(), folder, _NETWORKS)
    if found.figure11 is not None:
        drawn.draw_figure_11(found.figure11, folder)
    if "figure12" in found.parts:
        drawn.draw_figure_12(study("table1").road, folder)
    if found.curves is not None and "figure13" in found.parts:
        drawn.draw_figure_13(found.curves, folder)
    if found.curves is not None and "figure14" in found.parts:
        drawn.draw_figure_14(found.curves, folder)
    if found.methods:
        drawn.draw_methods(_method_points(found), _METHOD_TITLES, folder)


def _page(found: Reproduction, folder: Path) -> str:
    figures = {}
    for name, caption in _CAPTIONS.items():
        path = folder / FIGURES / f"{name}.svg"
        if path.exists():
            figures[name] = PageFigure(inline(path.read_text(encoding="utf-8"), name, caption), caption)
    linear = found.linear
    return (
        environment()
        .get_template("reproduction.html")
        .render(
            title=TITLE,
            agreement=_agreement(linear.compared) if linear else "",
            summary=_summary(found),
            linear=[_compared_table(linear.compared, number) for number in (1, 2, 3)] if linear else [],
            simulated=[_simulated_table(found, number) for number in (1, 2, 3)],
            designs=[_designs_table(linear.found, number) for number in (1, 2)] if linear else [],
            origins=origins(found),
            claims=found.claims,
            optima=_optima_table(found),
            budgets=_budgets_table(found),
            figures=figures,
        )
    )


def _summary(found: Reproduction) -> list[str]:
    """What was found, in a few sentences."""
    lines = []
    rows = list(found.rows.values())
    if rows:
        counts = {verdict: sum(row.verdict == verdict for row in rows) for verdict in _SIGNS}
        said = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
        lines.append(f"Of {len(rows)} simulated rows of the tables: {said}.")
    if found.claims:
        verdicts = dict.fromkeys(claim.verdict for claim in found.claims)
        said = "; ".join(
            f"{verdict}: {', '.join(str(c.number) for c in found.claims if c.verdict == verdict)}"
            for verdict in verdicts
        )
        lines.append(f"Claims by number, {said}.")
    if found.optima:
        name, numbers = min(found.optima.items(), key=lambda item: float(item[1]["percent"]))
        lines.append(
            f"A design that knows its friction gains up to {-numbers['percent']:.1f} % on the best linear one ({name})."
        )
    return lines


def _compared_table(compared: list[ComparedRow], number: int) -> Table:
    rows = [
        Row(
            f"{c.row.index} {c.row.title}",
            [
                Cell(typeset(c.row.printed)),
                Cell(typeset(_digits(c.paper2008))),
                Cell(typeset(_signed(c.off_by, 1)), strong=not c.agrees),
                Cell(typeset(_digits(c.exact))),
                Cell(typeset(f"{_signed(_share(c))} %")),
            ],
        )
        for c in compared
        if c.row.table == number
    ]
    header = ["Design", "Printed", "paper2008", "Off, last digits", "Exact", "Exact to printed"]
    return Table(f"Linear designs of Table {number}: J1 in m/s², J3 in N, J5 in m/N", header, rows)


def _simulated_table(found: Reproduction, number: int) -> Table | None:
    rows = [
        Row(
            f"{r.row.index} {r.row.title}",
            [
                Cell(typeset(r.row.printed)),
                Cell(typeset(_with_error(r.paper2008, r.paper2008_error))),
                Cell(typeset(f"{_signed(100.0 * r.difference)} %")),
                Cell(typeset(_with_error(r.exact, r.exact_error))),
                *([] if r.improvement is None else [Cell(f"{r.improvement:.2f} %", f"printed {r.row.improvement}")]),
                Cell(_printed_verdict(r), strong=r.verdict == "differs"),
            ],
            status=reason(r),
        )
        for r in found.rows.values()
        if r.row.table == number
    ]
    over = ["Improvement"] if number == 2 else []
    header = ["Design", "Printed", "paper2008", "Difference", "Exact", *over, "Verdict"]
    method = "approximated linear model (Method 1)" if number == 2 else "expected value (Method 2)"
    return Table(f"Table {number} anew, {method}: J1 in m/s², J3 in N, J5 in m/N", header, rows) if rows else None


def _printed_verdict(r: SimulatedRow) -> str:
    return f"within {100.0 * r.tolerance:g} %" if r.verdict == "within the tolerance" else r.verdict


def _designs_table(found: list[FoundDesign], number: int) -> Table:
    chosen = [f for f in found if f.row.table == number]
    names = list(dict.fromkeys(name for f in chosen for name in f.parameters))
    rows = [
        Row(
            f"{f.row.index} {f.row.layout}",
            [
                Cell(typeset(_digits(f.value)), f"printed {typeset(f.row.printed)}"),
                Cell(typeset(f"{_signed(f.gain_percent)} %")),
                *(
                    Cell(f"{f.parameters[name]:.6g}", f"printed {f.row.parameters[name]:g}")
                    if name in f.parameters
                    else Cell("–")
                    for name in names
                ),
                Cell(f"{f.agreed} of {f.starts}"),
            ],
        )
        for f in chosen
    ]
    return Table(
        f"Designs of Table {number} found from scratch", ["Design", "Value", "Lower by", *names, "Agreement"], rows
    )


def _optima_table(found: Reproduction) -> Table | None:
    rows = [
        Row(
            name,
            [
                Cell(typeset(_with_error(numbers["value"], numbers["error"]))),
                Cell(typeset(_digits(numbers["linear_value"]))),
                Cell(typeset(f"{-numbers['percent']:.3f} % ± {numbers['percent_error']:.3f} %")),
                *(Cell(f"{numbers['parameters'][key]:.5g}") for key in ("c", "b")),
            ],
            status="" if numbers["status"] == "ok" else numbers["status"],
        )
        for name, numbers in found.optima.items()
    ]
    header = ["Design", "Best with friction", "Best linear, with friction", "Lower by", "c", "b"]
    return Table("Designs that are best with friction: c in N s/m, b in kg", header, rows) if rows else None


def _budgets_table(found: Reproduction) -> Table | None:
    rows = []
    for name, numbers in found.budgets.items():
        index, layout, what = name.split(maxsplit=2)
        rows.append(Row(f"{index} {layout}", [Cell(what), Cell(typeset(_budget_value(numbers)))]))
    header = ["Design", "Of", "Limit"]
    caption = "The most friction or backlash, and the softest shaft, with which a design still beats S1"
    return Table(caption, header, rows) if rows else None


def _networks() -> dict[str, Network]:
    elements = {name: kind(1.0, name) for name, kind in _KINDS.items()}
    return {title: network(text, **elements) for title, text in _DRAWN.items()}
