"""Figures of the best designs of a study without a sweep: improvements, and frequency responses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import fill
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from inerter.figures.labels import (
    axis_label,
    bound_of,
    by_method,
    compared_layouts,
    index_words,
    indices,
    layouts,
    method_label,
    methods,
    one_method,
)
from inerter.figures.style import LayoutStyle, colour, layout_styles, log_axis, marker
from inerter.formatting import capital, choose_scale, format_percent_size, typeset

Array = NDArray[np.float64]

IMPROVEMENT = "Improvement over baseline [%]"
WORST = -100.0  # per cent; what is worse still is cut here, so that the others can be read
_WINDOW = 20.0  # how far below the least of the highest gains a frequency response is shown
_MOST_LEVEL_NUMBERS = 15  # above more bars than these the numbers stand upright
_WIDEST_TITLE, _MOST_CHARACTERS = 22, 20  # in one of three panels
_WIDEST_BAR = 0.28  # of the distance between two groups


def improvement_bars(results: xr.Dataset, ax: Axes) -> Axes:
    """The improvement of every layout over the baseline, in groups by index. For a study without a sweep."""
    results = one_method(results)
    names, styles = compared_layouts(results), layout_styles(layouts(results), results.attrs["baseline"])
    groups = np.arange(results.sizes["index"], dtype=float)
    width = min(0.84 / max(len(names), 1), _WIDEST_BAR)
    upright = len(names) * groups.size > _MOST_LEVEL_NUMBERS
    for i, name in enumerate(names):
        places: Array = groups + (i - (len(names) - 1) / 2) * width
        _bars(ax, results.sel(layout=name), places, width, styles[name], upright)
    if names:
        ax.axhline(0.0, **styles[results.attrs["baseline"]].curve() | {"linewidth": 1.0})
    _leave_room(ax, 0.18 if upright else 0.1)
    ax.set_xlim(-0.5, groups.size - 0.5)
    ax.set_xticks(groups, [index_words(results, index, "{1}\n{0}") for index in indices(results)])
    ax.tick_params(axis="x", length=0)
    ax.grid(visible=False, axis="x")
    ax.set_ylabel(IMPROVEMENT)
    return ax


def improvement_by_method(results: xr.Dataset, axes: Sequence[Axes]) -> Sequence[Axes]:
    """The improvement of every layout over the baseline by every method, one of `axes` for each index."""
    names = compared_layouts(results)
    places, width = np.arange(len(names), dtype=float), 0.7 / len(methods(results))
    for ax, index in zip(axes, indices(results), strict=True):
        for number, method in enumerate(methods(results)):
            row = by_method(results, method).sel(index=index, layout=names)
            values = np.where(np.isfinite(row["improvement"].values), row["improvement"].values, np.nan)
            at, shown = (
                places + (number - (len(methods(results)) - 1) / 2) * width,
                np.where(values < WORST, np.nan, values),
            )
            look: dict[str, Any] = {"linestyle": "", "color": colour(number)}
            ax.plot(at, shown, marker=marker(number), markersize=4.5, label=method_label(results, method), **look)
            _error_bars(ax, row, at, shown, **look)
            ax.plot(at, np.where(values < WORST, WORST, np.nan), marker="v", markersize=6.0, fillstyle="none", **look)
        ax.axhline(0.0, color="black", linestyle="--", linewidth=0.8)
        ax.set_xlim(-0.5, len(names) - 0.5)
        ax.set_xticks(places, names, rotation=90 if upright_names(names) else 0)
        ax.tick_params(axis="x", length=0)
        ax.grid(visible=False, axis="x")
        ax.margins(y=0.12)
        ax.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        ax.set_title(fill(index_words(results, index, "{1}: {0}"), _WIDEST_TITLE))
    axes[0].set_ylabel(IMPROVEMENT)
    return axes


def upright_names(names: Sequence[str]) -> bool:
    """Whether the names of layouts have no room side by side below one of a few panels."""
    return sum(map(len, names)) > _MOST_CHARACTERS


def frequency_responses(results: xr.Dataset, index: str, axes: Sequence[Axes]) -> Sequence[Axes]:
    """The gain over frequency of each layout's best design for `index`, one of `axes` for each output."""
    dimension, styles = f"output_{index}", layout_styles(layouts(results), results.attrs["baseline"])
    gain = results[f"gain_{index}"].transpose(dimension, "layout", "omega").sel(layout=layouts(results))
    frequency = gain["omega"].values / (2.0 * np.pi)
    unit = choose_scale(gain.max("omega").values.ravel(), gain.attrs["units"])
    for ax, panel in zip(axes, gain, strict=True):
        curves = np.where(np.isfinite(panel.values) & (panel.values > 0.0), panel.values * unit.factor, np.nan)
        for name, curve in zip(layouts(results), curves, strict=True):
            ax.plot(frequency, curve, **styles[name].curve())
        _show_peaks(ax, frequency, curves)
        ax.set_xlabel("Frequency [Hz]")
        ax.set_ylabel(axis_label(capital(gain.attrs["long_name"]), unit.unit))
        if len(axes) > 1:
            ax.set_title(capital(str(panel[dimension].item()).replace("_", " ")))
    return axes


def _bars(ax: Axes, row: xr.Dataset, places: Array, width: float, style: LayoutStyle, upright: bool) -> None:
    """The bars of one layout, each with its number."""
    values = row["improvement"].values
    heights = np.clip(np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0), WORST, None)
    look: dict[str, Any] = {"color": style.colour, "hatch": style.hatch, "edgecolor": "white", "linewidth": 0.4}
    ax.bar(places, heights, 0.92 * width, label=style.label, **look)
    errors = _error_bars(ax, row, places, heights, linestyle="", color="black")
    ends = heights + np.where(heights >= 0.0, errors, -errors)
    for place, height, text in zip(places, ends, _numbers(row), strict=True):
        ax.annotate(
            text,
            (place, height),
            xytext=(0, 2 if height >= 0.0 else -2),
            textcoords="offset points",
            ha="center",
            va="bottom" if height >= 0.0 else "top",
            rotation=90 if upright else 0,
            fontsize=6.5,
        )
    cut = np.isfinite(values) & (values < WORST)
    ax.plot(places[cut], heights[cut] * 0.95, linestyle="", marker="v", color="white", markersize=4.0)


def _error_bars(ax: Axes, row: xr.Dataset, places: Array, heights: Array, **look: Any) -> Array:
    """Caps one standard error above and below improvements that have one; returns the errors, zero where none is."""
    errors = np.nan_to_num(row["improvement_error"].values) if "improvement_error" in row else np.zeros(places.size)
    seen = errors > 0.0
    if seen.any():
        ax.errorbar(places[seen], heights[seen], errors[seen], capsize=2.5, elinewidth=0.9, zorder=4.0, **look)
    return errors


def _leave_room(ax: Axes, share: float) -> None:
    """Limits that leave a share of the height for the numbers above the bars, and below if some point down."""
    low, high = min(ax.dataLim.y0, 0.0), max(ax.dataLim.y1, 0.0)
    below = share if low < 0.0 else 0.02
    height = max(high - low, 1.0) / (1.0 - share - below)
    ax.set_ylim(low - below * height, max(high, low + 1.0) + share * height)


def _numbers(row: xr.Dataset) -> Iterator[str]:
    """Improvement of each bar as text, with the digits that its largest error allows."""
    for i, improvement in enumerate(row["improvement"].values.tolist()):
        if np.isinf(float(row["value"][i])):
            yield "inf"
        elif not np.isfinite(improvement):
            yield "n/a"
        else:
            bound = bound_of(row.isel(index=i), "improvement")
            yield typeset(format_percent_size(improvement, bound=bound).removesuffix(" %"))


def _show_peaks(ax: Axes, frequency: Array, curves: Array) -> None:
    """Logarithmic axes around the peaks of all curves; the long tails are left out."""
    highest = [np.nanmax(curve) for curve in curves if np.any(np.isfinite(curve))]
    if not highest:
        return
    floor = min(highest) / _WINDOW
    inside = frequency[np.any(curves > floor, axis=0)]
    shown = inside if inside.size > 1 else frequency
    ax.set_xlim(shown.min(), shown.max())
    ax.set_ylim(floor, 1.5 * max(highest))
    log_axis(ax, "x")
    log_axis(ax, "y")
