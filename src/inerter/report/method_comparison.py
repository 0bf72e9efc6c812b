"""Comparison of the methods of a study on the same designs, side by side."""

from __future__ import annotations

import xarray as xr

from inerter.figures.labels import (
    by_method,
    compared_layouts,
    design_quantity,
    improvement_over_baseline,
    improvement_text,
    index_unit,
    index_words,
    indices_with_values,
    layouts,
    method_label,
    methods,
    swept_places,
)
from inerter.formatting import Scale, capital, choose_scale
from inerter.report.index_summary import extremes, place_text
from inerter.table import Cell, Row, Table, columns


def method_tables(results: xr.Dataset) -> list[Table]:
    """Tables of every layout by every method, one per index with values; empty with a single method."""
    return [_table(results, index) for index in indices_with_values(results)] if len(methods(results)) > 1 else []


def _table(results: xr.Dataset, index: str) -> Table:
    unit = choose_scale(results["value"].sel(index=index).values.ravel().tolist(), index_unit(results, index))
    rows = [
        Row([Cell(name), *(_cell(by_method(results, method), index, name, unit) for method in methods(results))])
        for name in (compared_layouts(results) if swept_places(results) else []) or layouts(results)
    ]
    caption = f"{capital(index_words(results, index))} {_caption_clause(results, unit)}"
    return Table(
        caption, columns("Layout", *(capital(method_label(results, method)) for method in methods(results))), rows
    )


def _caption_clause(results: xr.Dataset, unit: Scale) -> str:
    if not swept_places(results):
        return f"by each method{f', in {unit.unit}' if unit.unit else ''}"
    than = f" compared with {results.attrs['baseline']}" if compared_layouts(results) else ""
    return f"by each method, at its best{than}"


def _cell(results: xr.Dataset, index: str, layout: str, unit: Scale) -> Cell:
    """Value and improvement; over a sweep, the largest improvement or the least value with its place."""
    row = results.sel(layout=layout, index=index)
    if not swept_places(results):
        return Cell(design_quantity(row, unit.unit, unit), improvement_over_baseline(row))
    ends = extremes(row["improvement" if compared_layouts(results) else "value"])
    if ends is None:
        return Cell("n/a")
    place = ends[1 if compared_layouts(results) else 0][1]
    best = row.sel(place)
    shown = improvement_text(best) if compared_layouts(results) else design_quantity(best, index_unit(results, index))
    return Cell(shown, f"at {place_text(results, place)}")
