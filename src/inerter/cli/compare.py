"""Implementation of `inerter compare`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from math import inf, isfinite
from pathlib import Path
from typing import Any

from inerter.decision.result_comparison import ResultComparison, ValueChange, compare_results
from inerter.files.common.suggest import some
from inerter.formatting import format_quantity, format_share
from inerter.report.json_data import json_data
from inerter.report.text import table_lines, wrap_text
from inerter.statements import Statement
from inerter.table import Column, Quantity, Row, Table, cells, columns
from inerter.units import quote_value

_MOST = 30  # rows of a table


def compare(first: Path, second: Path, *, as_json: bool) -> tuple[Statement, ...]:
    """Compare two folders of results; returns the comparison."""
    found = compare_results(first, second)
    if as_json:
        print(json.dumps(_data(found), indent=2))
    else:
        print("\n".join(_lines(found, first, second)))
    return (found,)


def _data(found: ResultComparison) -> dict[str, Any]:
    values = [{**asdict(one), "percent": one.percent, "is_beyond_errors": one.is_beyond_errors} for one in found.values]
    data: dict[str, Any] = json_data({**asdict(found), "values": values})
    return data


def _lines(found: ResultComparison, first: Path, second: Path) -> Iterator[str]:
    yield from wrap_text(f"First: {first}. Second: {second}.")
    if found.entries:
        heads = [Column("Key", words=True), *columns("First", "Second")]
        rows = [Row(cells(one.place, _entry(one.first), _entry(one.second))) for one in found.entries[:_MOST]]
        yield ""
        yield from table_lines(Table("Entries of the studies that differ, in SI units", heads, rows))
        yield from _more(len(found.entries))
    else:
        yield from wrap_text("Both are of the same study.")
    for folder, only in ((first, found.only_first), (second, found.only_second)):
        if only:
            yield from wrap_text(f"Only in {folder}: {some(only)}.")
    if shown := sorted(found.values if found.entries else found.changes, key=_size, reverse=True):
        yield ""
        yield from table_lines(_table(found, shown[:_MOST]))
        yield from _more(len(shown))
    yield ""
    yield f"Common values: {len(found.values)}. Different beyond their errors: {len(found.changes)}."


def _more(count: int) -> Iterator[str]:
    if count > _MOST:
        yield f"  and {count - _MOST} more"


def _entry(value: object) -> str:
    if value is None:
        return "not set"
    return ", ".join(map(_entry, value)) if isinstance(value, list | tuple) else quote_value(value)


def _size(one: ValueChange) -> float:
    return abs(one.percent) if isfinite(one.percent) else inf


def _table(found: ResultComparison, shown: list[ValueChange]) -> Table:
    """Values, the largest change first, with the design variables that differ."""
    has_points, has_methods = bool(found.values[0].point), len({one.method for one in found.values}) > 1
    heads = [
        *columns("Layout", "Index", *(["At"] if has_points else []), *(["Method"] if has_methods else [])),
        *columns("First", "Second", "Change", "Beyond errors"),
        Column("Design variables", prose=True),
    ]
    rows = []
    for one in shown:
        named = [*([", ".join(one.point)] if has_points else []), *([one.method] if has_methods else [])]
        values = Quantity(one.first, one.unit), Quantity(one.second, one.unit)
        changed = format_share(one.percent / 100.0, 2, "+"), "yes" if one.is_beyond_errors else "no"
        variables = [
            f"{name} {' -> '.join(format_quantity(value, found.parameter_units[name]) for value in both)}"
            for name, both in one.parameters.items()
        ]
        rows.append(Row(cells(one.layout, one.index, *named, *values, *changed, ", ".join(variables))))
    return Table("Values, the largest change first", heads, rows, labels=2 + has_points + has_methods)
