"""The tables of a reproduction, for its page, its text, and its files of data."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from inerter.errors import StatusKind
from inerter.formatting import (
    format_decimals,
    format_number,
    format_quantity,
    format_range,
    format_uncertain,
    format_with_interval,
)
from inerter.papers.wang_su_2008.linear import ComparedRow, FoundDesign
from inerter.papers.wang_su_2008.report.reasons import reason
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rig import IdentifiedParameter
from inerter.papers.wang_su_2008.rows import DIFFERS, OTHER_PEAK, SimulatedRow
from inerter.papers.wang_su_2008.source import PrintedRow
from inerter.table import Cell, Column, Row, Shown, Table, cells, records

_UNITS = "J1 in m/s^2, J3 in N, J5 in m/N"
_TABLES = (1, 2, 3)
_METHODS = {
    1: "expected value (Method 2)",
    2: "approximated linear model (Method 1)",
    3: "expected value (Method 2)",
}
_OF_DESIGN = (Column("Design"), Column(key="table"), Column(key="index"), Column(key="case"))


def linear_tables(found: Reproduction) -> list[Table]:
    """Linear designs as printed, recomputed under both conventions: Tables 1 to 3."""
    compared = found.linear.compared if found.linear else []
    names = _names(c.row for c in compared)
    heads = [
        *_OF_DESIGN,
        *(Column(key="layout"), Column(key="unit"), Column("Printed", "printed"), Column("paper2008", "paper2008")),
        *(Column("Exact", "exact"), Column("Off, last digits", "off_by_last_digits")),
        *(Column("Exact to printed", "exact_over_printed_percent"), Column(key="agrees")),
        *(Column(key=f"{name} printed") for name in names),
    ]
    return [
        Table(f"Linear designs of Table {number}: {_UNITS}", heads, rows)
        for number in _TABLES
        if (rows := [_linear_row(c, names) for c in compared if c.row.table == number])
    ]


def _linear_row(c: ComparedRow, names: Iterable[str]) -> Row:
    relative = c.exact / c.row.value - 1.0
    contents = [
        *(_design(c.row), c.row.table, c.row.index, c.row.case, c.row.layout, c.unit),
        *(Shown(c.row.value, c.row.printed), _number(c.paper2008), _number(c.exact)),
        Shown(c.off_by, format_decimals(c.off_by, 1, "+")),
        Shown(100.0 * relative, _percent_text(100.0 * relative)),
        c.agrees,
        *map(c.row.parameters.get, names),
    ]
    return Row(cells(*contents), strong=not c.agrees)


def design_tables(found: Reproduction) -> list[Table]:
    """Designs found from scratch, with the printed ones: Tables 1 and 2."""
    designs = found.linear.found if found.linear else []
    names = _names(f.row for f in designs)
    heads = [
        *_OF_DESIGN,
        *(Column(key="layout"), Column(key="unit"), Column(key="printed"), Column("Value", "found")),
        *(
            Column("Lower by", "gain_percent"),
            Column("Agreement", only_on_pages=True),
            Column(key="agreed"),
            Column(key="starts"),
        ),
        *(Column(key=f"{name} printed") for name in names),
        *(Column(name, f"{name} found", listed="Values") for name in names),
    ]
    return [
        Table(f"Designs of Table {number} found from scratch, with the printed numbers", heads, rows)
        for number in _TABLES
        if (rows := [_design_row(f, names) for f in designs if f.row.table == number])
    ]


def _design_row(f: FoundDesign, names: list[str]) -> Row:
    found = [
        *cells(_design(f.row), f.row.table, f.row.index, f.row.case, f.row.layout, f.unit, f.row.value),
        Cell(_number(f.value), f"printed {f.row.printed}"),
        Cell(Shown(f.gain_percent, _percent_text(f.gain_percent))),
        *cells(f"{f.agreed} of {f.starts}", f.agreed, f.starts),
        *(Cell(f.row.parameters.get(name)) for name in names),
        *(
            Cell(_number(f.parameters[name]), f"printed {format_number(f.row.parameters[name])}")
            if name in f.parameters
            else Cell()
            for name in names
        ),
    ]
    return Row(found)


def simulated_tables(found: Reproduction) -> list[Table]:
    """Simulated rows of Tables 1 to 3, with verdicts."""
    return [
        _simulated_table(number, rows)
        for number in _TABLES
        if (rows := [row for row in found.rows.values() if row.row.table == number])
    ]


def _simulated_table(number: int, rows: list[SimulatedRow]) -> Table:
    improved = any(row.improvement is not None for row in rows)
    heads = [
        *_OF_DESIGN,
        *(Column(key="design"), Column(key="unit"), Column("Printed", "printed")),
        *(Column("paper2008, difference", "paper2008"), Column(key="paper2008_standard_error")),
        *(Column("Exact", "exact"), Column(key="exact_standard_error"), Column("Improvement" if improved else "")),
        *(Column(key="difference_percent"), Column(key="difference_in_standard_errors")),
        *(Column("Verdict", "verdict", prose=True), Column(key="reason")),
        *(Column(key="improvement_printed_percent"), Column(key="improvement_percent")),
        *(Column(key="nearest_peak_omega"), Column(key="peaks_from_rest"), Column(key="peaks")),
    ]
    return Table(f"Table {number} recomputed, {_METHODS[number]}: {_UNITS}", heads, list(map(_simulated_row, rows)))


def _simulated_row(r: SimulatedRow) -> Row:
    improvement = (
        Cell()
        if r.improvement is None
        else Cell(f"{format_number(r.improvement, 4)} %", f"printed {r.row.improvement} %")
    )
    found = [
        *cells(_design(r.row), r.row.table, r.row.index, r.row.case, r.row.title, r.unit),
        Cell(Shown(r.row.value, r.row.printed)),
        Cell(_value_with_error(r.paper2008, r.paper2008_error), _percent_text(100.0 * r.difference)),
        Cell(r.paper2008_error),
        *cells(_value_with_error(r.exact, r.exact_error), r.exact_error),
        improvement,
        *cells(100.0 * r.difference, r.score),
        Cell(r.verdict, strong=r.verdict in (DIFFERS, OTHER_PEAK)),
        *cells(reason(r), r.row.improvement, r.improvement),
        Cell(None if r.nearest is None else r.nearest.omega),
        Cell("; ".join(map(format_number, r.gains_from_rest))),
        Cell("; ".join(f"{format_number(p.omega)} rad/s: {format_number(p.gain)}" for p in r.peaks)),
    ]
    return Row(found, status=reason(r))


def optima_table(found: Reproduction) -> Table | None:
    """Designs that are best with friction, compared with the best linear ones."""
    rows = []
    for name, numbers in found.optima.items():
        index, layout = name.split()
        percent, error = numbers["percent"], numbers["percent_error"]
        contents = [
            *(
                name,
                index,
                layout,
                _value_with_error(numbers["value"], numbers["error"]),
                numbers["error"],
                numbers["unit"],
            ),
            *(_number(numbers["linear_value"]), Shown(percent, f"{format_uncertain(-percent, error)} %"), error),
            *(numbers["status"], *(_number(numbers["parameters"][key], 5) for key in ("c", "b"))),
        ]
        rows.append(Row(cells(*contents), status="" if numbers["status"] == "ok" else numbers["status"]))
    heads = [
        *(Column("Design"), Column(key="index"), Column(key="layout"), Column("Best with friction", "value")),
        *(Column(key="error"), Column(key="unit"), Column("Best linear, with friction", "linear_value")),
        *(Column("Lower by", "percent"), Column(key="percent_error"), Column(key="status")),
        *(Column("c", "c found"), Column("b", "b found")),
    ]
    return Table("Designs that are best with friction: c in N s/m, b in kg", heads, rows) if rows else None


def budgets_table(found: Reproduction) -> Table | None:
    """Break-even friction, backlash and shaft stiffness."""
    rows = []
    for name, numbers in found.budgets.items():
        index, layout, what = name.split(maxsplit=2)
        given = (numbers[key] for key in ("error", "low", "high", "unit", "status"))
        contents = [f"{index} {layout}", index, layout, what, Shown(numbers["value"], budget_value(numbers)), *given]
        rows.append(Row(cells(*contents)))
    heads = [
        *(
            Column("Design"),
            Column(key="index"),
            Column(key="layout"),
            Column("Of", "of"),
            Column("Limit", "value", prose=True),
        ),
        *(Column(key=key) for key in ("error", "low", "high", "unit", "status")),
    ]
    caption = "Break-even values: largest friction or backlash, or smallest shaft stiffness, for an advantage over S1"
    return Table(caption, heads, rows) if rows else None


def budget_value(numbers: Mapping[str, Any]) -> str:
    """Break-even value with its standard error, or the reason why there is none."""
    if numbers["value"] != numbers["value"]:
        return str(numbers["message"] if numbers["kind"] == StatusKind.UNBOUNDED else numbers["status"])
    return format_quantity(numbers["value"], numbers["unit"], error=numbers["error"])


def rig_table(found: Reproduction) -> Table | None:
    """Parameters identified from the records of the virtual rig."""
    heads = [
        *(Column("Parameter", "parameter"), Column(key="unit"), Column("Printed", "printed")),
        *(Column("Identified", "identified"), Column("95 % interval"), Column(key="lower"), Column(key="upper")),
        *(Column("Difference", "difference_percent"), Column(key="identifiability")),
    ]
    caption = "Parameters identified by the staged protocol from simulated records, and printed values"
    return None if found.rig is None else Table(caption, heads, list(map(_rig_row, found.rig.parameters)))


def _rig_row(p: IdentifiedParameter) -> Row:
    value, interval = rig_value(p)
    known = p.value == p.value
    found = cells(
        *(p.name, p.unit, Shown(p.printed, format_quantity(p.printed, p.unit))),
        *(Shown(p.value if known else None, value), interval, *p.interval),
        *(Shown(100.0 * p.difference, _percent_text(100.0 * p.difference) if known else ""), p.sentence),
    )
    return Row(found)


def rig_value(p: IdentifiedParameter) -> tuple[str, str]:
    """Identified value of a parameter and its confidence interval, as texts."""
    low, high = p.interval
    if p.value == p.value:
        return format_with_interval(p.value, low, high, p.unit)
    return "not identifiable", format_range(
        low, high, p.unit, 3
    ) if low > 0.0 else f"below {format_quantity(high, p.unit, 3)}"


def rows_of(tables: Iterable[Table]) -> Iterator[dict[str, Any]]:
    """Rows of several tables for a file of data."""
    for table in tables:
        yield from records(table)


def _design(row: PrintedRow) -> str:
    return f"{row.index} {row.title}"


def _names(rows: Iterable[PrintedRow]) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row.parameters))


def _number(value: float, digits: int = 6) -> Shown:
    return Shown(value, format_number(value, digits))


def _value_with_error(value: float, error: float) -> Shown:
    """A value with its standard error; with six digits if it has none."""
    return Shown(value, format_uncertain(value, error) if error > 0.0 else format_number(value))


def _percent_text(value: float) -> str:
    return f"{format_decimals(value, 2, '+')} %"
