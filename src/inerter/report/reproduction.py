"""The reproduction of a paper as tables, files and a page."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap

from inerter.figures.labels import typeset
from inerter.figures.reproduction import FIGURE_11, draw_figure_11
from inerter.papers.wang_su_2008 import Claim, ComparedRow, FoundDesign, LinearReproduction, tables
from inerter.report.page import PageFigure, environment, inline
from inerter.report.tables import Cell, Row, Table
from inerter.report.text import WIDTH
from inerter.study.run import FIGURES, REPORT

_CAPTION = (
    "Figure 11 anew: optimal indices of the quarter car over the static stiffness k, and their improvement over S1, "
    "with an ideal inerter and with an elastic one in its hard (2000 kN/m, 6400 N s/m) and soft setting "
    "(1000 kN/m, 3200 N s/m)."
)


def write_reproduction(found: LinearReproduction, folder: Path) -> None:
    """Write the tables as CSV, Figure 11, and a page that shows all of it, into `folder`."""
    for name, rows in tables(found).items():
        columns = dict.fromkeys(column for row in rows for column in row)
        text = io.StringIO()
        writer = csv.DictWriter(text, list(columns), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        (folder / f"{name}.csv").write_text(text.getvalue(), encoding="utf-8", newline="\n")
    draw_figure_11(found.figure11, folder / FIGURES)
    (folder / REPORT).write_text(_page(found, folder), encoding="utf-8", newline="\n")


def reproduction_text(found: LinearReproduction) -> str:
    """Everything as plain text of at most 80 columns."""
    return "\n".join(
        [
            "Wang and Su (2008), linear part",
            "",
            "Printed designs, computed anew under both conventions; off: paper2008 less",
            "printed, in units of the last printed digit; differs: exact against printed.",
            "",
            f"{'table':6}{'index':6}{'case':>4}  {'layout':9}{'printed':>12}{'paper2008':>13}{'off':>6}{'exact':>13}"
            f"{'differs':>9}",
            *(_compared_line(c) for c in found.compared),
            "",
            *wrap(_agreement(found.compared), WIDTH),
            "",
            "Designs found from scratch under paper2008, with the printed ones in brackets;",
            "lower: how far the value lies below the printed one; starts: how many agreed.",
            "",
            f"{'table':6}{'index':6}{'layout':9}{'printed':>12}{'found':>13}{'lower':>9}{'starts':>9}",
            *(line for f in found.found for line in _found_lines(f)),
            "",
            "Claims",
            "",
            *(line for claim in found.claims for line in _claim_lines(claim)),
        ]
    )


def _compared_line(c: ComparedRow) -> str:
    row = c.row
    return (
        f"{row.table:<6}{row.index:6}{row.case:>4}  {row.layout:9}{row.printed:>12}{_digits(c.paper2008):>13}"
        f"{_signed(c.off_by, 1):>6}{_digits(c.exact):>13}{_signed(_share(c)):>7} %"
    )


def _share(c: ComparedRow) -> float:
    return 100.0 * (c.exact / float(c.row.printed) - 1.0)


def _signed(value: float, decimals: int = 2) -> str:
    text = f"{value:+.{decimals}f}"
    return text[1:] if float(text) == 0.0 else text


def _digits(value: float) -> str:
    return f"{value:.6g}"


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


def _claim_lines(claim: Claim) -> Iterator[str]:
    yield from wrap(f"{claim.number}. {claim.statement}", WIDTH, subsequent_indent="   ")
    yield from wrap(f"{claim.verdict.upper()}. {claim.evidence}", WIDTH, initial_indent="   ", subsequent_indent="   ")


def _page(found: LinearReproduction, folder: Path) -> str:
    svg = (folder / FIGURES / f"{FIGURE_11}.svg").read_text(encoding="utf-8")
    return (
        environment()
        .get_template("reproduction.html")
        .render(
            title="Wang and Su (2008), linear part",
            agreement=_agreement(found.compared),
            tables=[_compared_table(found.compared, number) for number in (1, 2, 3)],
            designs=[_designs_table(found.found, number) for number in (1, 2)],
            claims=found.claims,
            figure=PageFigure(inline(svg, FIGURE_11, _CAPTION), _CAPTION),
        )
    )


def _compared_table(compared: list[ComparedRow], number: int) -> Table:
    rows = [
        Row(
            f"{c.row.index} {c.row.layout}",
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
    return Table(f"Table {number} anew: J1 in m/s², J3 in N, J5 in m/N", header, rows)


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
