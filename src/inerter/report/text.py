"""Tables of results as plain text for a terminal of 80 columns."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from textwrap import wrap

import numpy as np
import xarray as xr

from inerter.figures.labels import (
    bound_of,
    by_which,
    compared_layouts,
    error_of,
    flat_range,
    improvement_text,
    index_title,
    index_unit,
    indices,
    layouts,
    methods,
    one_method,
    swept_places,
    swept_words,
)
from inerter.formatting import format_percent, format_quantity
from inerter.report.index_summary import extremes, over_the_sweep, place_text
from inerter.report.limits import limit_lines
from inerter.report.method_comparison import method_lines

WIDTH = 80
_NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
_MEASURED = re.compile(r"\S+ \+- \S+( [^\s,.;)]+)?|\d %")
_NARROWEST = 20  # of the last column, which goes beyond the width where numbers are enormous
_LONGEST_NAME = 20  # a longer name of a layout has a separate line


@dataclass(frozen=True)
class _TextRow:
    """Row of a layout: cells, items of the last column, and status."""

    name: str
    cells: list[str]
    items: list[str]
    status: str


def wrap_text(text: str, **indents: str) -> list[str]:
    """Lines of a text for a terminal, without breaks between a number, its standard error and its unit."""
    joined = _MEASURED.sub(lambda found: found[0].replace(" ", _NO_BREAK_SPACE), text)
    return [line.replace(_NO_BREAK_SPACE, " ") for line in wrap(joined, WIDTH, **indents)]  # type: ignore[arg-type]


def summary_table(results: xr.Dataset) -> str:
    """The best designs, a block for each index: ASCII, at most 80 columns.

    With a sweep, where each layout improves most and least on the baseline, and where it is equally good. With several
    methods, the first of them, and then all side by side.
    """
    every, results = results, one_method(results)
    block = _extremes if swept_places(results) else _designs
    several = len(methods(every)) > 1
    blocks = [
        [
            *block(results, index),
            *_sweep_lines(every, index),
            *limit_lines(every, index, WIDTH),
            *(["", *method_lines(every, index, WIDTH)] if several else []),
        ]
        for index in indices(results)
    ]
    text = "\n\n".join("\n".join(lines) for lines in blocks)
    return text.encode("ascii", "replace").decode()


def _designs(results: xr.Dataset, index: str) -> Iterator[str]:
    unit, versus = index_unit(results, index), bool(compared_layouts(results))
    yield from wrap(_heading(results, index), WIDTH, subsequent_indent="    ")
    table = []
    for name in layouts(results):
        design = results.sel(layout=name, index=index)
        cells = [
            format_quantity(float(design["value"]), unit, error=error_of(design), bound=bound_of(design)),
            *([_improvement(design)] if versus else []),
        ]
        table.append(_TextRow(name, cells, _parameters(design), str(design["status"].item())))
    yield from _lines(["layout", "value", *(["improvement"] if versus else [])], "parameters", table)


def _improvement(design: xr.Dataset) -> str:
    if design["layout"].item() == design.attrs["baseline"]:
        return "baseline"
    return improvement_text(design)


def _extremes(results: xr.Dataset, index: str) -> Iterator[str]:
    versus, unit = bool(compared_layouts(results)), index_unit(results, index)
    rows = results["improvement" if versus else "value"].sel(index=index)
    heading = f"{_heading(results, index)}, over {' and '.join(swept_words(results))}"
    yield from wrap(heading, WIDTH, subsequent_indent="    ")
    table = []
    for name in compared_layouts(results) or layouts(results):
        ends = extremes(rows.sel(layout=name)) or ((np.nan, {}),) * 2
        texts = [
            f"{format_percent(value) if versus else format_quantity(value, unit)} at {place_text(results, at)}"
            for value, at in ends
        ]
        texts = texts[::-1] if versus else texts
        table.append(_TextRow(name, texts[:1], texts[1:], _first_failure(results, name, index)))
    yield from _lines(["layout", "best"], "worst", table)


def _sweep_lines(results: xr.Dataset, index: str) -> Iterator[str]:
    """Lines on where layouts outperform the baseline over a sweep."""
    if swept_places(results) and compared_layouts(results):
        for _, sentence in over_the_sweep(results.sel(index=[index])):
            yield from wrap_text(sentence, initial_indent="  ", subsequent_indent="    ")


def _heading(results: xr.Dataset, index: str) -> str:
    baseline = f", compared with {results.attrs['baseline']}" if compared_layouts(results) else ""
    return f"{index}: {index_title(results, index)}{by_which(results)}{baseline}"


def _parameters(design: xr.Dataset) -> list[str]:
    """Parameters of one design as texts, each with its unit, and with its active bound or flat range."""
    found = []
    for parameter in design["parameter"].values.tolist():
        entry = design.sel(parameter=parameter)
        value, bound = float(entry["parameter_value"]), str(entry["at_bound"].item())
        if np.isfinite(value):
            text = f"{parameter} = {format_quantity(value, str(entry['parameter_unit'].item()))}"
            flat = flat_range(entry)
            remarks = [*([f"{bound} bound"] if bound else []), *([f"{flat} are as good"] if flat else [])]
            found.append(f"{text} ({', '.join(remarks)})" if remarks else text)
    return found


def _first_failure(results: xr.Dataset, layout: str, index: str) -> str:
    """First status over the sweep that is not ok, with the number of such statuses; "ok" if there is none."""
    every = results["status"].sel(layout=layout, index=index).values.ravel().tolist()
    bad = [text for text in every if text != "ok"]
    return f"{bad[0]} ({len(bad)} of {len(every)} values are not ok)" if bad else "ok"


def _lines(header: list[str], last: str, table: Sequence[_TextRow]) -> Iterator[str]:
    """The rows below their header in columns; the items of the last column wrap."""
    columns = [header, *([row.name if len(row.name) <= _LONGEST_NAME else "", *row.cells] for row in table)]
    widths = [max(map(len, column)) for column in zip(*columns, strict=True)]
    indent = 2 + sum(widths) + 2 * len(widths)
    yield "  " + "".join(f"{text:<{width}}  " for text, width in zip(header, widths, strict=True)) + last
    for row, cells in zip(table, columns[1:], strict=True):
        if not cells[0]:
            yield f"  {row.name}"
        first = "  " + "".join(f"{text:<{width}}  " for text, width in zip(cells, widths, strict=True))
        items = _pack_items(row.items, max(WIDTH - indent, _NARROWEST)) or [""]
        yield (first + items[0]).rstrip()
        yield from (" " * indent + line for line in items[1:])
        if row.status != "ok":
            yield from wrap(row.status, WIDTH, initial_indent="    ! ", subsequent_indent="      ")


def _pack_items(items: Sequence[str], width: int) -> list[str]:
    """The items, separated by commas, on lines of `width`; a line ends between two items where it can."""
    lines: list[str] = []
    for i, item in enumerate(items):
        text = item if i == len(items) - 1 else f"{item},"
        if lines and len(lines[-1]) + 1 + len(text) <= width:
            lines[-1] += f" {text}"
        else:
            lines += wrap(text, width)
    return lines
