"""Figures over a swept value: how good the best designs are, and what they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from inerter.errors import StudyError
from inerter.figures.curves import thin_curve, thinned_band
from inerter.figures.designs import IMPROVEMENT, WORST
from inerter.figures.labels import (
    axis_label,
    by_method,
    compared_layouts,
    held_back,
    index_unit,
    index_words,
    layouts,
    method_label,
    methods,
    one_method,
    swept_element,
    swept_label,
    swept_scale,
)
from inerter.figures.style import LayoutStyle, layout_styles, log_axis, method_line, suits_log_axis
from inerter.formatting import capital, choose_scale

Array = NDArray[np.float64]

_MOST_MARKERS = 40


def markers_shown(results: xr.Dataset) -> bool:
    """Whether the swept values are few enough for markers."""
    return results.sizes[str(swept_element(results))] <= _MOST_MARKERS


@dataclass(frozen=True, eq=False)
class _Sweep:
    """The results for one index in the order of the swept values."""

    data: xr.Dataset  # (layout, swept element, ...)
    values: Array  # swept, in the unit of the label
    label: str
    styles: dict[str, LayoutStyle]

    def draw(
        self,
        ax: Axes,
        layout: str,
        numbers: Array,
        open_where: NDArray[np.bool_] | None = None,
        line: dict[str, Any] | None = None,
    ) -> None:
        """The curve of one layout, broken where a number is not finite; `line` replaces some of its keywords."""
        style, few = self.styles[layout], self.values.size <= _MOST_MARKERS
        marker: dict[str, Any] = {"marker": style.marker if few else "", "markersize": 3.2, "markeredgewidth": 0.8}
        finite = np.where(np.isfinite(numbers), numbers, np.nan)
        ax.plot(*thin_curve(self.values, finite), **style.curve() | (line or {}), **marker)
        if few and open_where is not None and np.any(open_where):
            look: dict[str, Any] = {
                **marker,
                "marker": style.marker or "o",
                "color": style.colour,
                "linestyle": "",
                "markerfacecolor": "white",
                "zorder": style.zorder + 0.1,
            }
            ax.plot(self.values[open_where], finite[open_where], **look)

    def band(self, ax: Axes, layout: str, low: Array, high: Array, alpha: float) -> None:
        """Fill the area between two curves."""
        area, colour = thinned_band(self.values, low, high), self.styles[layout].colour
        ax.fill_between(*area, color=colour, alpha=alpha, linewidth=0.0)

    def finish(self, axes: Sequence[Axes]) -> None:
        """The axes of the swept values: logarithmic if that spreads them more evenly."""
        for ax in axes:
            ax.set_xlabel(self.label)
            if suits_log_axis(self.values):
                log_axis(ax, "x")


def sweep_curves(results: xr.Dataset, index: str, axes: Sequence[Axes]) -> Sequence[Axes]:
    """Over the swept value: the best value of `index` on the first of `axes`, the improvement on the second if any.

    Raises `StudyError` if nothing is swept.
    """
    names = methods(results)
    sweeps = [_sweep(by_method(results, name), index) for name in names] or [_sweep(results, index)]
    lines = [_method_line(number) for number in range(len(names))] if len(names) > 1 else [{}]
    sweep, (left, *right) = sweeps[0], axes
    unit = choose_scale(sweep.data["value"].values.ravel(), index_unit(results, index))
    for one, line in zip(sweeps, lines, strict=True):
        for name in layouts(results):
            _curve(one, left, name, "value", unit.factor, line)
    left.set_ylabel(axis_label(capital(index_words(results, index, "{} {}")), unit.unit))
    for ax in right:
        for one, line in zip(sweeps, lines, strict=True):
            for name in compared_layouts(results):
                _curve(one, ax, name, "improvement", 1.0, line)
        if results.attrs["baseline"]:
            ax.axhline(0.0, **sweep.styles[results.attrs["baseline"]].curve() | lines[0])
        ax.set_ylim(bottom=max(ax.get_ylim()[0], WORST))
        ax.set_ylabel(IMPROVEMENT)
    for name, line in zip(names, lines, strict=True) if len(names) > 1 else ():
        left.plot([], [], color="0.4", **line | {"label": method_label(results, name)})
    sweep.finish(axes)
    return axes


def _method_line(number: int) -> dict[str, Any]:
    """Keywords of the curves of a method: its line style; no label except for the first method."""
    return {"linestyle": method_line(number), **({} if number == 0 else {"label": "_"})}


def _curve(sweep: _Sweep, ax: Axes, layout: str, what: str, factor: float, line: dict[str, Any]) -> None:
    row = sweep.data.sel(layout=layout)
    numbers, error = row[what].values * factor, {"value": "standard_error", "improvement": "improvement_error"}[what]
    errors = row[error].values * factor if error in row else np.zeros(0)
    if np.any(errors > 0.0):  # one standard error to both sides
        sweep.band(ax, layout, numbers - errors, numbers + errors, alpha=0.2)
    sweep.draw(ax, layout, numbers, held_back(row).values, line)


def parameter_curves(results: xr.Dataset, index: str, axes: Sequence[Axes]) -> Sequence[Axes]:
    """The parameters that are best for `index` over the swept value, one of `axes` each; open markers: at a bound.

    Bands span designs that are equally good, where the optimum is flat.

    Raises `StudyError` if nothing is swept.
    """
    sweep = _sweep(results, index)
    for ax, parameter in zip(axes, results["parameter"].values.tolist(), strict=True):
        column = sweep.data.sel(parameter=parameter)
        unit = choose_scale(column["parameter_value"].values.ravel(), str(column["parameter_unit"].item()))
        for name in layouts(results):
            row = column.sel(layout=name)
            numbers = row["parameter_value"].values * unit.factor
            if np.any(np.isfinite(numbers)):
                low, high = row["parameter_low"].values * unit.factor, row["parameter_high"].values * unit.factor
                sweep.band(ax, name, low, high, alpha=0.15)
                sweep.draw(ax, name, numbers, open_where=row["at_bound"].values != "")
        ax.set_ylabel(axis_label(f"Best {parameter}", unit.unit))
        log_axis(ax, "y")
    sweep.finish(axes)
    return axes


def _sweep(results: xr.Dataset, index: str) -> _Sweep:
    element = swept_element(results)
    if element is None:
        raise StudyError("Got results of a study without a sweep; these figures are drawn over a swept value.")
    data = one_method(results).sel(index=index).sortby(element).transpose("layout", element, ...)
    unit = swept_scale(data, element)
    styles = layout_styles(layouts(results), results.attrs["baseline"])
    return _Sweep(data, data[element].values * unit.factor, swept_label(results, element, unit.unit), styles)
