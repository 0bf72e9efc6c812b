"""Comparison of the methods of a study on the same designs, side by side."""

from __future__ import annotations

import re
from collections.abc import Iterator
from textwrap import wrap
from typing import NamedTuple

import numpy as np
import xarray as xr

from inerter.figures.labels import (
    bound_of,
    by_method,
    capital,
    compared_layouts,
    error_of,
    improvement_text,
    index_title,
    index_unit,
    indices,
    layouts,
    methods,
    swept_places,
    title_with_name,
    way,
)
from inerter.formatting import (
    Scale,
    choose_scale,
    format_quantity,
    format_uncertain,
    shows_error,
    significant_digits,
    typeset,
)
from inerter.report.index_summary import extremes, place_text
from inerter.table import Cell, Row, Table

_LONGEST_NAME = 20
_LONGEST_METHOD = 18  # longer words are cut in two


class _Entry(NamedTuple):
    """Cell of a layout and a method: two short texts, the second below the first."""

    first: str
    second: str = ""


def method_lines(results: xr.Dataset, index: str, width: int) -> Iterator[str]:
    """A table for a terminal: layouts in rows, methods in columns, in several parts if they need more than `width`."""
    names, unit = _row_layouts(results), _common_scale(results, index)
    yield from wrap(_caption_clause(results, unit), width, initial_indent="  ", subsequent_indent="    ")
    labels = [_Entry("layout"), *(_Entry(name[:_LONGEST_NAME]) for name in names)]
    columns = [
        [
            _Entry(*_two_lines(way(results, method))),
            *(_table_entry(by_method(results, method), index, name, unit) for name in names),
        ]
        for method in methods(results)
    ]
    while columns:
        count = _count_fitting([labels, *columns], width)
        yield from _format_lines([labels, *columns[:count]])
        columns = columns[count:]


def method_tables(results: xr.Dataset) -> list[Table]:
    """Tables of every layout by every method, one per index; empty with a single method."""
    if len(methods(results)) < 2:
        return []
    return [_table(results, index) for index in indices(results)]


def _table(results: xr.Dataset, index: str) -> Table:
    unit = _common_scale(results, index)
    rows = []
    for name in _row_layouts(results):
        entries = [_table_entry(by_method(results, method), index, name, unit) for method in methods(results)]
        rows.append(
            Row(name, [Cell(_typeset_unbroken(entry.first), _typeset_unbroken(entry.second)) for entry in entries])
        )
    caption = f"{title_with_name(index_title(results, index), index)} {_caption_clause(results, unit)}"
    return Table(
        typeset(capital(caption)), ["Layout", *(capital(way(results, method)) for method in methods(results))], rows
    )


def _caption_clause(results: xr.Dataset, unit: Scale) -> str:
    if not swept_places(results):
        return f"by each method{f', in {unit.unit}' if unit.unit else ''}"
    return "by each method, at its best" + (
        f" compared with {results.attrs['baseline']}" if compared_layouts(results) else ""
    )


def _row_layouts(results: xr.Dataset) -> list[str]:
    return (compared_layouts(results) if swept_places(results) else []) or layouts(results)


def _common_scale(results: xr.Dataset, index: str) -> Scale:
    return choose_scale(results["value"].sel(index=index).values.ravel(), index_unit(results, index))


def _table_entry(results: xr.Dataset, index: str, layout: str, unit: Scale) -> _Entry:
    """Cell with value and improvement; over a sweep, the largest improvement or the least value with its place."""
    row, baseline = results.sel(layout=layout, index=index), results.attrs["baseline"]
    if not swept_places(results):
        value, error, bound = float(row["value"]) * unit.factor, error_of(row) * unit.factor, bound_of(row)
        better = "" if layout == baseline or not baseline else improvement_text(row)
        return _Entry(
            format_uncertain(value, error, bound) if shows_error(value, error, bound) else _format_value(value, bound),
            better,
        )
    ends = extremes(row["improvement" if compared_layouts(results) else "value"])
    if ends is None:
        return _Entry("n/a")
    place = ends[1] if compared_layouts(results) else ends[0]
    here = row.sel(place[1])
    if compared_layouts(results):
        text = improvement_text(here)
    else:
        text = format_quantity(place[0], index_unit(results, index), error=error_of(here), bound=bound_of(here))
    return _Entry(text, f"at {place_text(results, place[1])}")


def _format_value(value: float, bound: float) -> str:
    return f"{value:.{significant_digits(value, bound)}g}" if np.isfinite(value) else format_quantity(value, "")


def _typeset_unbroken(text: str) -> str:
    return typeset(text).replace(" ", "\N{NO-BREAK SPACE}")


def _two_lines(words: str) -> tuple[str, str]:
    """Text split into two lines of similar length, at a space or after a hyphen."""
    cuts = [found.end() for found in re.finditer(r"[ -](?=.)", words)] if len(words) > _LONGEST_METHOD else []
    cut = min(cuts, key=lambda place: abs(2 * place - len(words)), default=len(words))
    return words[:cut].rstrip(), words[cut:]


def _count_fitting(columns: list[list[_Entry]], width: int) -> int:
    """Number of columns that fit next to that of the labels, at least one."""
    count = len(columns) - 1
    while count > 1 and max(map(len, _format_lines(columns[: count + 1]))) > width:
        count -= 1
    return count


def _format_lines(columns: list[list[_Entry]]) -> list[str]:
    widths = [max(len(text) for entry in column for text in entry) for column in columns]
    lines = [
        "  " + "  ".join(f"{entry[part]:<{width}}" for entry, width in zip(entries, widths, strict=True))
        for entries in zip(*columns, strict=True)
        for part in (0, 1)
    ]
    return [line.rstrip() for line in lines if line.strip()]
