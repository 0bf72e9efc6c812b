"""Axes, looks and legends of the plots of one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from inerter.errors import LinearSystemError
from inerter.figures.labels import axis_label
from inerter.figures.style import add_legend, colour, layout_styles, log_axis, new_figure


def single_axes(ax: Axes | None) -> Axes:
    """The axes that are given, or new ones."""
    return ax if ax is not None else new_figure(height=3.0, width=4.6)[1][0]


def axes_pair(axes: Sequence[Axes] | None) -> tuple[Axes, Axes]:
    """The two axes that are given, or new ones above one another."""
    several = list(axes) if axes is not None else new_figure(2, height=2.4, width=4.6)[1]
    if len(several) != 2:
        raise LinearSystemError(f"A gain and a phase need two axes, got {len(several)}.")
    return several[0], several[1]


def label_gain_and_phase(upper: Axes, lower: Axes, gain: str) -> None:
    """Labels and scales of a gain above a phase over frequency."""
    upper.set(ylabel=gain)
    lower.set(xlabel=axis_label("Frequency", "Hz"), ylabel=axis_label("Phase", "deg"))
    for ax in (upper, lower):
        log_axis(ax, "x")
        ax.margins(x=0.0)
    log_axis(upper, "y")


def label_complex_plane(ax: Axes, real: str, imaginary: str) -> None:
    """Labels with these units, and lines through zero, of the complex plane."""
    ax.axhline(0.0, color="#999999", linewidth=0.6)
    ax.axvline(0.0, color="#999999", linewidth=0.6)
    ax.set(xlabel=axis_label("Real part", real), ylabel=axis_label("Imaginary part", imaginary))


def curve_looks(named: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Keywords of a curve each; the first of several is what the others are compared with."""
    if len(named) == 1:
        return [{"color": colour(0), "label": name} for name in named]
    styles = layout_styles(named, next(iter(named)))
    return [{**styles[name].curve(), "label": name} for name in named]


def add_curve_legend(ax: Axes, count: int, given: object) -> None:
    """A legend where there are several curves, each name once: in axes that are `given`, below a figure of our own."""
    entries = _entries(ax)
    if not entries or count < 2:
        return
    if given is None:
        assert isinstance(ax.figure, Figure)
        add_legend(ax.figure, [ax])
    else:
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
