"""The figures of the paper, recomputed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from inerter.figures.identification import MotionCurve, response_figure, time_figure
from inerter.figures.labels import axis_label, index_title, index_unit, indices
from inerter.figures.style import LayoutStyle, add_legend, colour, log_axis, new_figure, save, style_context
from inerter.formatting import capital, choose_scale
from inerter.papers.wang_su_2008.paper import (
    FIGURE_8,
    FIGURE_9,
    FIGURE_10,
    FIGURE_11,
    FIGURE_12,
    FIGURE_13,
    FIGURE_14,
    METHODS,
)
from inerter.papers.wang_su_2008.rig import RigTest
from inerter.signals.harmonics import multisine
from inerter.signals.road import Road

_CURVES = (("measured (virtual rig)", "force"), ("identified model", "model"))
_WINDOW = (2.0, 3.0)  # [s] of Figure 9
_COLOUR = {"S2": "#0072B2", "S3": "#D55E00"}
_LINES: tuple[Any, ...] = ("-", (0, (7, 1.5)), (0, (1, 1.2)), (0, (5, 1.2, 1, 1.2)))
_BASELINE = LayoutStyle("black", "--", "", label="S1 (baseline)", zorder=3.0)
_EFFECTS = {"": "ideal", "-soft": "elastic", "-10N": "friction", "-soft-10N": "both"}


def draw_rig(found: RigTest, folder: Path) -> list[Path]:
    """Figures 8 to 10: the friction test, the test at 3 Hz with its fit, and the frequency responses."""
    (slow, _), (fast, model) = (
        [MotionCurve(label, part["time"], part["displacement"], part[name]) for label, name in _CURVES]
        for part in (found.friction, found.fit)
    )
    figures = {
        FIGURE_8: time_figure(slow),
        FIGURE_9: time_figure(fast, model, _WINDOW),
        FIGURE_10: response_figure(*(found.responses[name] for name in ("measured", "model", "linear", "ideal"))),
    }
    return [path for name, figure in figures.items() for path in _draw(figure, folder, name)]


def draw_figure_11(results: xr.Dataset, folder: Path) -> list[Path]:
    """Optimal indices and improvements over the static stiffness, with elastic inerters."""
    return _draw(_values_and_improvements(results, {"": "ideal", "-hard": "hard", "-soft": "soft"}), folder, FIGURE_11)


def draw_figure_12(road: Road, folder: Path) -> list[Path]:
    """A road of eq. (17)."""
    with style_context():
        figure, (ax,) = new_figure(height=2.0)
        signal = multisine(road, seed=0)
        ax.plot(np.arange(10001) * 1e-3, 1e3 * signal.grid(0.0, 1e-3, 10001)[0], color=colour(0), linewidth=0.8)
        ax.set_xlabel(axis_label("Time", "s"))
        ax.set_ylabel(axis_label("Road height", "mm"))
        ax.set_xlim(0.0, 10.0)
        return save(figure, folder, FIGURE_12, pdf=True)


def draw_figure_13(results: xr.Dataset, folder: Path) -> list[Path]:
    """Optimal indices and improvements over the static stiffness, with friction, by Method 1."""
    return _draw(_values_and_improvements(results, {"": "ideal", "-10N": "10 N", "-20N": "20 N"}), folder, FIGURE_13)


def draw_figure_14(results: xr.Dataset, folder: Path) -> list[Path]:
    """Effects of friction and elasticity together, S2 on the left, S3 on the right."""
    with style_context():
        figure, axes = new_figure(2 * results.sizes["index"], 2, height=2.15)
        for row, index in enumerate(indices(results)):
            for column, layout in enumerate(("S2", "S3")):
                styles = {"S1": _BASELINE}
                for number, (kind, word) in enumerate(_EFFECTS.items()):
                    styles[layout + kind] = LayoutStyle(colour(number), _LINES[number], "", label=word)
                ax = axes[2 * row + column]
                unit = _curves(ax, results, index, styles, "value")
                ax.set_title(
                    f"({'abcdef'[2 * row + column]}) {capital(index_title(results, index))}, {layout}", loc="left"
                )
                ax.set_ylabel(axis_label(f"Optimal {index}", unit))
        _finish(axes, results)
        add_legend(figure, axes)
        return save(figure, folder, FIGURE_14, pdf=True)


def draw_methods(points: Sequence[Mapping[str, Any]], methods: Mapping[str, str], folder: Path) -> list[Path]:
    """Change of J1 and J3 by friction over its size, by each of the `methods` (name and title)."""
    panels = list(dict.fromkeys((p["index"], p["layout"]) for p in points))
    with style_context():
        figure, axes = new_figure(len(panels), 2, height=2.3)
        for ax, (index, layout) in zip(axes, panels, strict=True):
            mine = [p for p in points if (p["index"], p["layout"]) == (index, layout)]
            for number, (name, title) in enumerate(methods.items()):
                here = [p for p in mine if name in p]
                force = np.array([p["friction"] for p in here])
                change = 100.0 * np.array([p[name] / p["linear"] - 1.0 for p in here])
                error = 200.0 * np.array([p[f"{name} error"] / p["linear"] for p in here])
                seen = change > np.maximum(error, 1e-4)
                ax.errorbar(
                    force[seen],
                    change[seen],
                    yerr=error[seen],
                    color=colour(number),
                    linestyle=_LINES[number],
                    marker="osD"[number],
                    markersize=3.0,
                    capsize=1.5,
                    elinewidth=0.8,
                    label=title,
                )
            ax.set_title(f"{index}, {layout}", loc="left")
            ax.set_xlabel(axis_label("Friction", "N"))
            ax.set_ylabel(axis_label(f"Increase of {index}", "%"))
            log_axis(ax, "x")
            log_axis(ax, "y")
        add_legend(figure, axes)
        return save(figure, folder, METHODS, pdf=True)


def _draw(figure: Figure, folder: Path, name: str) -> list[Path]:
    with style_context():
        return save(figure, folder, name, pdf=True)


def _values_and_improvements(results: xr.Dataset, kinds: Mapping[str, str]) -> Figure:
    """A row for each index: optimal values on the left, improvements over S1 on the right."""
    with style_context():
        figure, axes = new_figure(2 * results.sizes["index"], 2, height=2.15)
        styles = {"S1": _BASELINE}
        for layout in ("S2", "S3"):
            for number, (kind, word) in enumerate(kinds.items()):
                styles[layout + kind] = LayoutStyle(_COLOUR[layout], _LINES[number], "", label=f"{layout} {word}")
        for row, index in enumerate(indices(results)):
            values, improvement = axes[2 * row : 2 * row + 2]
            unit = _curves(values, results, index, styles, "value")
            others = {layout: style for layout, style in styles.items() if layout != "S1"}
            _curves(improvement, results, index, others, "improvement")
            improvement.axhline(0.0, **_BASELINE.curve())
            values.set_ylabel(axis_label(f"Optimal {index}", unit))
            improvement.set_ylabel(axis_label(f"{index} improvement", "%"))
            for ax, letter in ((values, "ace"[row]), (improvement, "bdf"[row])):
                ax.set_title(f"({letter}) {capital(index_title(results, index))}", loc="left")
        _finish(axes, results)
        add_legend(figure, axes, most=4)
    return figure


def _curves(ax: Axes, results: xr.Dataset, index: str, styles: Mapping[str, LayoutStyle], what: str) -> str:
    """Curves over the static stiffness with a band of two standard errors; returns the unit of the values."""
    data = results.sel(index=index)
    unit = choose_scale(data["value"].values.ravel(), index_unit(results, index))
    stiffness = results["k"].values * choose_scale(results["k"].values, results["k"].attrs["units"]).factor
    factor = unit.factor if what == "value" else 1.0
    for layout, style in styles.items():
        curve = data[what].sel(layout=layout).values * factor
        ax.plot(stiffness, curve, **style.curve())
        if "standard_error" in data:
            error = 2.0 * data["standard_error"].sel(layout=layout).values
            if what == "improvement":
                error = 100.0 * error / data["value"].sel(layout="S1").values
            ax.fill_between(
                stiffness, curve - error * factor, curve + error * factor, color=style.colour, alpha=0.15, linewidth=0.0
            )
    return unit.unit


def _finish(axes: Sequence[Axes], results: xr.Dataset) -> None:
    """Abscissa of axes in two columns, with a label below the last row."""
    stiffness = choose_scale(results["k"].values, results["k"].attrs["units"])
    for ax in axes:
        ax.set_xlim(0.0, float(np.max(results["k"]) * stiffness.factor))
    for ax in axes[-2:]:
        ax.set_xlabel(axis_label("Static stiffness k", stiffness.unit))
