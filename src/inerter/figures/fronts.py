"""The figure of trade-offs: the fronts of all layouts in one picture."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from inerter.figures.labels import axis_label, criteria, criterion_title, criterion_unit, layouts
from inerter.figures.style import LayoutStyle, layout_styles
from inerter.formatting import capital, choose_scale
from inerter.indices.names import title_with_name


def pairs(results: xr.Dataset) -> list[tuple[str, str]]:
    """The indices of a trade-off, two at a time: one picture each."""
    return list(combinations(criteria(results), 2))


def front_curves(results: xr.Dataset, axes: Sequence[Axes]) -> Sequence[Axes]:
    """The front of every layout, a pair of indices on each of `axes`; a large open marker is the knee.

    Between two points where the front leaps from one kind of design to another there is no line; of three indices
    there are points alone.
    """
    styles = layout_styles(layouts(results), results.attrs["baseline"])
    joined = len(criteria(results)) == 2
    for ax, pair in zip(axes, pairs(results), strict=True):
        units = [
            choose_scale(results["front_value"].sel(criterion=name).values.ravel(), criterion_unit(results, name))
            for name in pair
        ]
        for name in layouts(results):
            row = results.sel(layout=name)
            across, up = (
                row["front_value"].sel(criterion=one).values * unit.factor
                for one, unit in zip(pair, units, strict=True)
            )
            if np.any(np.isfinite(across)):
                _draw(ax, styles[name], across, up, row, joined=joined)
        for which, name, unit in zip(("x", "y"), pair, units, strict=True):
            ax.set(
                **{
                    f"{which}label": axis_label(
                        capital(title_with_name(criterion_title(results, name), name, "{} {}")), unit.unit
                    )
                }
            )
    return axes


def _draw(ax: Axes, style: LayoutStyle, across: np.ndarray, up: np.ndarray, row: xr.Dataset, *, joined: bool) -> None:
    curve = style.curve() if joined else {**style.curve(), "linestyle": ""}
    leaps = np.flatnonzero(row["front_jump"].values) + 1
    parts = [np.arange(across.size)] if not joined else np.split(np.arange(across.size), leaps)
    for number, part in enumerate(parts):
        label = curve["label"] if number == 0 else "_"
        marker = style.marker if joined else style.marker or "o"
        ax.plot(across[part], up[part], **{**curve, "label": label}, marker=marker, markersize=2.6)
    knee = np.flatnonzero(row["front_knee"].values)
    look: dict[str, Any] = {"markerfacecolor": "white", "markeredgewidth": 1.2, "zorder": style.zorder + 0.2}
    ax.plot(
        across[knee], up[knee], linestyle="", marker=style.marker or "o", markersize=7.0, color=style.colour, **look
    )
