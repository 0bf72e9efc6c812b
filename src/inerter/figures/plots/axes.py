"""Axes, looks and legends of the plots of one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes

from inerter.figures.labels import axis_label
from inerter.figures.style import colour, layout_styles, log_axis, new_figure


def single_axes(ax: Axes | None) -> Axes:
    """The axes that are given, or new ones."""
    return ax if ax is not None else new_figure(height=3.0, width=4.6)[1][0]


def axes_pair(axes: Sequence[Axes] | None) -> tuple[Axes, Axes]:
    """The two axes that are given, or new ones above one another."""
    upper, lower = axes if axes is not None else new_figure(2, height=2.0, width=4.6)[1]
    return upper, lower


def label_gain_and_phase(upper: Axes, lower: Axes, gain: str, count: int) -> None:
    """Labels, scales and the legend of a gain above a phase over frequency, of so many curves."""
    upper.set(ylabel=gain)
    lower.set(xlabel=axis_label("Frequency", "Hz"), ylabel=axis_label("Phase", "deg"))
    for ax in (upper, lower):
        log_axis(ax, "x")
        ax.margins(x=0.0)
    log_axis(upper, "y")
    add_curve_legend(upper, count)


def label_complex_plane(ax: Axes, real: str, imaginary: str, count: int) -> None:
    """Labels with these units, lines through zero and the legend of so many curves in the complex plane."""
    ax.axhline(0.0, color="#999999", linewidth=0.6)
    ax.axvline(0.0, color="#999999", linewidth=0.6)
    ax.set(xlabel=axis_label("Real part", real), ylabel=axis_label("Imaginary part", imaginary))
    add_curve_legend(ax, count)


def curve_looks(named: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Keywords of a curve each; the first of several is what the others are compared with."""
    if len(named) == 1:
        return [{"color": colour(0), "label": name} for name in named]
    styles = layout_styles(named, next(iter(named)))
    return [{**styles[name].curve(), "label": name} for name in named]


def add_curve_legend(ax: Axes, count: int) -> None:
    """A legend where there are several curves, each name once."""
    entries = _entries(ax)
    if entries and count > 1:
        ax.legend(list(entries.values()), list(entries))


def add_legend_above(ax: Axes) -> None:
    """A legend in a row above the axes, where it covers no curve."""
    if entries := _entries(ax):
        ax.legend(
            list(entries.values()),
            list(entries),
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=len(entries),
            borderaxespad=0.2,
        )


def _entries(ax: Axes) -> dict[str, Any]:
    """Handle of each label of the curves of axes, each label once."""
    handles, labels = ax.get_legend_handles_labels()
    return {label: handle for handle, label in zip(handles, labels, strict=True) if label}
