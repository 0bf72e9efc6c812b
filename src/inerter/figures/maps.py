"""Maps over two swept places: how good the best designs are, and what they are."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import NDArray

from inerter.figures.designs import IMPROVEMENT, WORST
from inerter.figures.labels import (
    NOTICEABLE,
    axis_label,
    compared_layouts,
    held_back,
    index_unit,
    index_words,
    layouts,
    swept_label,
    swept_places,
    swept_scale,
)
from inerter.figures.style import log_axis, suits_log_axis
from inerter.formatting import capital, choose_scale, format_number, typeset

Array = NDArray[np.float64]

_LEVELS = 8  # about so many bands of colour
_TITLE = 30  # characters above a panel
_MOST_DOTS = 400  # of designs that were found
_NO_VALUE = "#D9D9D9"
_OPEN: dict[str, Any] = {
    "markerfacecolor": "white",
    "markeredgecolor": "0.15",
    "markeredgewidth": 0.5,
    "clip_on": False,
}


def index_maps(results: xr.Dataset, index: str, axes: Sequence[Axes]) -> Sequence[Axes]:
    """The value of `index` for the baseline, and the improvement of each other layout over it, one of `axes` each.

    Without a baseline, the value of every layout. The first swept place goes to the right, the second upwards.
    """
    data = _sort_by_sweep(results.sel(index=index))
    others = compared_layouts(results)
    valued = [name for name in layouts(results) if name not in others]
    unit = choose_scale(data["value"].sel(layout=valued).values.ravel(), index_unit(results, index))
    values = data["value"].sel(layout=valued) * unit.factor
    label = axis_label(capital(index_words(results, index, "{} {}")), unit.unit)
    for ax, name in zip(axes, valued, strict=False):
        _draw(data.sel(layout=name), values.sel(layout=name).values, ax, _sequential(values.values), label)
        ax.set_title(_in_lines(f"{name} (baseline)" if others else name))
    better = data["improvement"].sel(layout=others).clip(min=WORST)
    look = _diverging(better.values) if others else {}
    for ax, name in zip(axes[len(valued) :], others, strict=True):
        numbers = better.sel(layout=name).values
        _draw(data.sel(layout=name), numbers, ax, look, IMPROVEMENT)
        _draw_zero(data, numbers, ax)
        ax.set_title(_in_lines(name))
    return axes


def parameter_panels(results: xr.Dataset, index: str, parameter: str) -> list[str]:
    """The layouts that have the parameter."""
    values = results["parameter_value"].sel(index=index, parameter=parameter)
    return [name for name in layouts(results) if bool(np.isfinite(values.sel(layout=name)).any())]


def parameter_maps(results: xr.Dataset, index: str, parameter: str, axes: Sequence[Axes]) -> Sequence[Axes]:
    """The value of a parameter that is best for `index`, a layout on one of `axes` each; circles: at a bound."""
    data = _sort_by_sweep(results.sel(index=index, parameter=parameter))
    unit = choose_scale(data["parameter_value"].values.ravel(), str(data["parameter_unit"].item()))
    label = axis_label(f"Best {parameter}", unit.unit)
    for ax, name in zip(axes, parameter_panels(results, index, parameter), strict=True):
        row = data.sel(layout=name)
        numbers = row["parameter_value"].values * unit.factor
        _draw(row, numbers, ax, _sequential(numbers), label)
        x, y = _places(data)
        held = np.argwhere(row["at_bound"].values != "")
        _mark(ax, x[held[:, 0]], y[held[:, 1]], markersize=4.5, **_OPEN)
        ax.set_title(_in_lines(name))
    return axes


def _in_lines(title: str) -> str:
    """Title broken into lines that fit the panel."""
    return fill(title, _TITLE)


def _sort_by_sweep(data: xr.Dataset) -> xr.Dataset:
    places = swept_places(data)
    return data.sortby(places).transpose(..., *places)


def _places(data: xr.Dataset) -> tuple[Array, Array]:
    """The swept values in the units of the axes."""
    first, second = (data[place].values * swept_scale(data, place).factor for place in swept_places(data))
    return first, second


def _sequential(numbers: Array) -> dict[str, Any]:
    """Contour keywords for values: evenly spaced colours from the least to the largest."""
    return {"levels": _levels(numbers), "cmap": "viridis"}


def _diverging(numbers: Array) -> dict[str, Any]:
    """Contour keywords for improvements: zero white, positive blue, negative red."""
    levels = _levels(np.append(numbers, 0.0))
    most = max(abs(levels[0]), abs(levels[-1]))
    return {"levels": levels, "cmap": "RdBu", "vmin": -most, "vmax": most}


def _levels(numbers: Array) -> Array:
    """Round numbers that divide the range of some values."""
    known = numbers[np.isfinite(numbers)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        low, high = low - max(1e-3 * abs(low), 1e-9), high + max(1e-3 * abs(high), 1e-9)
    return np.asarray(MaxNLocator(_LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high), dtype=float)


def _draw(data: xr.Dataset, numbers: Array, ax: Axes, look: dict[str, Any], label: str) -> None:
    """Draw the map of a layout with its colour bar; dots mark computed designs, black ones those at a limit."""
    x, y = _places(data)
    shown = np.ma.masked_invalid(numbers.T)
    ax.set_facecolor(_NO_VALUE)
    ax.grid(visible=False)
    bands = ax.contourf(x, y, shown, **look)
    bands.set_edgecolor("face")  # no hairlines between bands where the page is printed
    if numbers.size <= _MOST_DOTS:
        _mark(ax, *(grid.ravel() for grid in np.meshgrid(x, y)), markersize=2.0, **_OPEN)
        held = np.argwhere(held_back(data).values)
        _mark(ax, x[held[:, 0]], y[held[:, 1]], markersize=2.4, color="black", clip_on=False)
    plain = FuncFormatter(lambda value, _: typeset(format_number(value)))
    bar = ax.figure.colorbar(bands, ax=ax, location="bottom", fraction=0.06, pad=0.02, format=plain)
    bar.set_label(label.replace("\n", " "))
    bar.ax.locator_params(nbins=5)
    _label(data, ax, x, y)


def _mark(ax: Axes, x: Array, y: Array, **look: Any) -> None:
    """Draw markers if there are any."""
    if x.size:
        ax.plot(x, y, linestyle="", marker="o", **look)


def _draw_zero(data: xr.Dataset, numbers: Array, ax: Axes) -> None:
    """Draw the line of equal performance with the baseline, if improvements of both signs occur."""
    known = numbers[np.isfinite(numbers)]
    if known.size and known.min() < -NOTICEABLE < NOTICEABLE < known.max():
        ax.contour(*_places(data), np.ma.masked_invalid(numbers.T), levels=[0.0], colors="black", linewidths=1.6)


def _label(data: xr.Dataset, ax: Axes, x: Array, y: Array) -> None:
    for place, which, values in zip(swept_places(data), ("x", "y"), (x, y), strict=True):
        unit = swept_scale(data, place).unit
        ax.set(**{f"{which}label": swept_label(data, place, unit)})
        if suits_log_axis(values):
            log_axis(ax, which)
