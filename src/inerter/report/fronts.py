"""Trade-offs in words: what the ends and the knee of each layout's front are, for a terminal and for a page."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import TextWrapper, wrap

import numpy as np
import xarray as xr

from inerter.errors import StatusKind
from inerter.figures.labels import (
    criteria,
    criterion_unit,
    layouts,
    listed,
    printed,
    trade_off_title,
    which_front,
    with_unit,
)
from inerter.report.findings import Writer
from inerter.report.tables import Cell, Row, Table

_NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
_SAME = 1e-9  # relative; a point that is as good as another in all indices does not better it


def front_sentences(results: xr.Dataset, write: Writer = with_unit) -> list[str]:
    """What the trade-off of each layout is at its knee, and how much of the baseline's it betters."""
    names, baseline = criteria(results), results.attrs["baseline"]
    if not names:
        return []
    found, doubts = [], []
    for layout in layouts(results):
        knee = np.flatnonzero(results["front_knee"].sel(layout=layout).values)
        if not knee.size:
            continue
        values = results["front_value"].sel(layout=layout).values[knee[0]]
        told = listed(
            [
                write(float(value), criterion_unit(results, name), np.nan)
                for name, value in zip(names, values, strict=True)
            ]
        )
        better = _bettered(results, layout, baseline) if baseline and layout != baseline else ""
        status = str(results["front_status"].sel(layout=layout).item())
        if status != StatusKind.OK:
            doubts.append(f"{layout}, {status}")
        found.append(f"{layout} {told}{better}")
    doubt = f"Not certain ({'; '.join(doubts)}). " if doubts else ""
    return [f"{doubt}{trade_off_title(results)}, at the knee: {'; '.join(found)}."] if found else []


def front_lines(results: xr.Dataset, width: int) -> Iterator[str]:
    """A block for a terminal: the designs at the ends and the knee of each front."""
    names = criteria(results)
    if not names:
        return
    yield ""
    by = which_front(results)
    yield from wrap(f"trade-off of {', '.join(names)}{by}: designs at the ends and the knee", width)
    for layout in layouts(results):
        status = str(results["front_status"].sel(layout=layout).item())
        yield f"  {layout}" if status == "ok" else f"  {layout}: {status}"
        for what, point in _told_points(results, layout):
            items = [*_values(results, layout, point, with_unit), *_parameters(results, layout, point, with_unit)]
            text = ", ".join(item.replace(" ", _NO_BREAK_SPACE) for item in items)
            hanging = TextWrapper(width, "    ", "      ", break_on_hyphens=False)
            lines = hanging.wrap(f"{what}: {text}")
            yield from (line.replace(_NO_BREAK_SPACE, " ") for line in lines)


def front_tables(results: xr.Dataset) -> list[Table]:
    """The designs at the ends and the knee of each layout's front; none if no trade-off is asked for."""
    names = criteria(results)
    if not names:
        return []
    parameters = [p for p in results["parameter"].values.tolist() if _has(results, p)]
    rows = []
    for layout in layouts(results):
        for what, point in _told_points(results, layout):
            cells = [Cell(text) for text in _values(results, layout, point, printed, bare=True)]
            told = dict(
                zip(_own(results, layout, point), _parameters(results, layout, point, printed, bare=True), strict=True)
            )
            rows.append(Row(f"{layout}, {what}", [*cells, *(Cell(told.get(name, "–")) for name in parameters)]))
    return [Table(trade_off_title(results), ["Design", *names, *parameters], rows)]


def _told_points(results: xr.Dataset, layout: str) -> list[tuple[str, int]]:
    """The best points for each index, and the knee."""
    values = results["front_value"].sel(layout=layout).values
    if not np.isfinite(values).any():
        return []
    ends = [(f"least {name}", int(np.nanargmin(values[:, i]))) for i, name in enumerate(criteria(results))]
    knee = np.flatnonzero(results["front_knee"].sel(layout=layout).values)
    return [*ends[:1], *(("knee", int(point)) for point in knee), *ends[1:]]


def _values(results: xr.Dataset, layout: str, point: int, write: Writer, *, bare: bool = False) -> list[str]:
    row = results["front_value"].sel(layout=layout).values[point]
    texts = [write(float(v), criterion_unit(results, n), np.nan) for n, v in zip(criteria(results), row, strict=True)]
    return texts if bare else [f"{name} = {text}" for name, text in zip(criteria(results), texts, strict=True)]


def _own(results: xr.Dataset, layout: str, point: int) -> list[str]:
    row = results["front_parameter"].sel(layout=layout).values[point]
    return [name for name, value in zip(results["parameter"].values.tolist(), row, strict=True) if np.isfinite(value)]


def _parameters(results: xr.Dataset, layout: str, point: int, write: Writer, *, bare: bool = False) -> list[str]:
    row = results["front_parameter"].sel(layout=layout).isel(front_point=point)
    found = []
    for name in _own(results, layout, point):
        entry = row.sel(parameter=name)
        text = write(float(entry), str(entry["parameter_unit"].item()), np.nan)
        found.append(text if bare else f"{name} = {text}")
    return found


def _has(results: xr.Dataset, parameter: str) -> bool:
    return bool(np.isfinite(results["front_parameter"].sel(parameter=parameter)).any())


def _bettered(results: xr.Dataset, layout: str, baseline: str) -> str:
    """Of how many designs of the baseline's front the layout has one that is better in all indices."""
    ours, theirs = (results["front_value"].sel(layout=name).values for name in (layout, baseline))
    ours, theirs = (values[np.isfinite(values).all(axis=1)] for values in (ours, theirs))
    if not len(ours) or not len(theirs):
        return ""
    beaten = sum(bool(np.any(np.all(ours < point * (1.0 - _SAME), axis=1))) for point in theirs)
    return f", better in all than {beaten or 'none'} of the {len(theirs)} designs of {baseline}"
