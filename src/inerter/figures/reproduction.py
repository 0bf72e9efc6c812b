"""Figures of reproduced papers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from inerter.figures.labels import axis_label, capital, index_title, index_unit, indices, scale
from inerter.figures.style import LayoutStyle, add_legend, new_figure, save, styled

FIGURE_11 = "figure-11"
_COLOUR = {"S2": "#0072B2", "S3": "#D55E00"}
_LINE = {"": "-", "-hard": (0, (7, 1.5)), "-soft": (0, (1, 1.2))}
_WORD = {"": "ideal", "-hard": "hard", "-soft": "soft"}


def draw_figure_11(results: xr.Dataset, folder: Path) -> list[Path]:
    """Optimal indices and improvements over the static stiffness, as in Figure 11 of Wang and Su (2008)."""
    with styled():
        return save(_figure_11(results), folder, FIGURE_11)


def _figure_11(results: xr.Dataset) -> Figure:
    figure, axes = new_figure(2 * results.sizes["index"], 2, height=2.15)
    stiffness = scale(results["k"].values, results["k"].attrs["units"])
    styles = {"S1": LayoutStyle("black", "--", "", label="S1 (baseline)", zorder=3.0)}
    for layout in ("S2", "S3"):
        for kind, line in _LINE.items():
            styles[layout + kind] = LayoutStyle(_COLOUR[layout], line, "", label=f"{layout} {_WORD[kind]}")
    for row, index in enumerate(indices(results)):
        data = results.sel(index=index)
        unit = scale(data["value"].values, index_unit(results, index))
        values, improvement = axes[2 * row : 2 * row + 2]
        for layout, style in styles.items():
            curve = data.sel(layout=layout)
            values.plot(results["k"] * stiffness.factor, curve["value"] * unit.factor, **style.curve())
            if layout != "S1":
                improvement.plot(results["k"] * stiffness.factor, curve["improvement"], **style.curve())
        improvement.axhline(0.0, **styles["S1"].curve())
        values.set_ylabel(axis_label(f"Optimal {index}", unit.unit))
        improvement.set_ylabel(axis_label(f"{index} improvement", "%"))
        for ax, letter in ((values, "ace"[row]), (improvement, "bdf"[row])):
            ax.set_title(f"({letter}) {capital(index_title(results, index))}", loc="left")
            ax.set_xlim(0.0, float(np.max(results["k"]) * stiffness.factor))
            if row == results.sizes["index"] - 1:
                ax.set_xlabel(axis_label("Static stiffness k", stiffness.unit))
    add_legend(figure, axes)
    return figure
