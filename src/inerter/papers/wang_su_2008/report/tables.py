"""The tables of a reproduction's page."""

from __future__ import annotations

import re

from inerter.formatting import typeset, typeset_quantity
from inerter.papers.wang_su_2008.linear import ComparedRow, FoundDesign
from inerter.papers.wang_su_2008.report.data import reason
from inerter.papers.wang_su_2008.report.text import budget_value, digits, format_signed, rig_value, share, with_error
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rows import DIFFERS, OTHER_PEAK
from inerter.table import Cell, Row, Table

_NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"


def _unbroken(title: str) -> str:
    """Title with no-break spaces between numbers and their unit."""
    return re.sub(r"(?<=\d) (?=N\b)", _NO_BREAK_SPACE, title)


def compared_table(compared: list[ComparedRow], number: int) -> Table:
    rows = [
        Row(
            f"{c.row.index} {_unbroken(c.row.title)}",
            [
                Cell(typeset(c.row.printed)),
                Cell(typeset(digits(c.paper2008))),
                Cell(typeset(format_signed(c.off_by, 1)), strong=not c.agrees),
                Cell(typeset(digits(c.exact))),
                Cell(typeset(f"{format_signed(share(c))} %")),
            ],
        )
        for c in compared
        if c.row.table == number
    ]
    header = ["Design", "Printed", "paper2008", "Off, last digits", "Exact", "Exact to printed"]
    return Table(f"Linear designs of Table {number}: J1 in m/s², J3 in N, J5 in m/N", header, rows)


def simulated_table(found: Reproduction, number: int) -> Table | None:
    rows = [
        Row(
            f"{r.row.index} {_unbroken(r.row.title)}",
            [
                Cell(typeset(r.row.printed)),
                Cell(
                    typeset(with_error(r.paper2008, r.paper2008_error)),
                    typeset(f"{format_signed(100.0 * r.difference)} %"),
                ),
                Cell(typeset(with_error(r.exact, r.exact_error))),
                *([] if r.improvement is None else [Cell(f"{r.improvement:.2f} %", f"printed {r.row.improvement} %")]),
                Cell(r.verdict, strong=r.verdict in (DIFFERS, OTHER_PEAK), prose=True),
            ],
            status=reason(r),
        )
        for r in found.rows.values()
        if r.row.table == number
    ]
    over = ["Improvement"] if number == 2 else []
    header = ["Design", "Printed", "paper2008, difference", "Exact", *over, "ClaimVerdict"]
    method = "approximated linear model (Method 1)" if number == 2 else "expected value (Method 2)"
    return Table(f"Table {number} recomputed, {method}: J1 in m/s², J3 in N, J5 in m/N", header, rows) if rows else None


def designs_table(found: list[FoundDesign], number: int) -> Table:
    chosen = [f for f in found if f.row.table == number]
    names = list(dict.fromkeys(name for f in chosen for name in f.parameters))
    rows = [
        Row(
            f"{f.row.index} {f.row.layout}",
            [
                Cell(typeset(digits(f.value)), f"printed {typeset(f.row.printed)}"),
                Cell(typeset(f"{format_signed(f.gain_percent)} %")),
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


def optima_table(found: Reproduction) -> Table | None:
    rows = [
        Row(
            name,
            [
                Cell(typeset(with_error(numbers["value"], numbers["error"]))),
                Cell(typeset(digits(numbers["linear_value"]))),
                Cell(typeset(f"{-numbers['percent']:.3f} % ± {numbers['percent_error']:.3f} %")),
                *(Cell(f"{numbers['parameters'][key]:.5g}") for key in ("c", "b")),
            ],
            status="" if numbers["status"] == "ok" else numbers["status"],
        )
        for name, numbers in found.optima.items()
    ]
    header = ["Design", "Best with friction", "Best linear, with friction", "Lower by", "c", "b"]
    return Table("Designs that are best with friction: c in N s/m, b in kg", header, rows) if rows else None


def budgets_table(found: Reproduction) -> Table | None:
    rows = []
    for name, numbers in found.budgets.items():
        index, layout, what = name.split(maxsplit=2)
        rows.append(Row(f"{index} {layout}", [Cell(what), Cell(typeset(budget_value(numbers)))]))
    header = ["Design", "Of", "Limit"]
    caption = "Break-even values: largest friction or backlash, or smallest shaft stiffness, for an advantage over S1"
    return Table(caption, header, rows) if rows else None


def rig_table(found: Reproduction) -> Table | None:
    if found.rig is None:
        return None
    rows = [
        Row(
            p.name,
            [
                Cell(typeset_quantity(p.printed, p.unit)),
                *(Cell(typeset(text)) for text in rig_value(p)),
                Cell(typeset(f"{format_signed(100.0 * p.difference)} %") if p.value == p.value else ""),
            ],
        )
        for p in found.rig.parameters
    ]
    header = ["Parameter", "Printed", "Identified", "95 % confidence interval", "Difference"]
    return Table(
        "Parameters identified by the staged protocol from simulated records, and printed values", header, rows
    )
