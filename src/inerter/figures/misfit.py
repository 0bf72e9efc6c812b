"""A figure of where a fit leaves more than the sensors would: over time, position, speed, force and frequency."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from inerter.figures.labels import axis_label
from inerter.figures.style import add_legend, colour, log_axis, new_figure, style_context
from inerter.formatting import choose_scale

Matrix = NDArray[np.float64]
_BINS, _CELLS = 24, 18  # of a curve, and of the map to either side
_FEWEST = 3  # samples in a bin
_MOST_POINTS = 4000
_BESIDE = 12  # samples to either side of an instant that is shown larger
_POINTS: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": 1.2, "color": "#9CC8E6", "rasterized": True}
_MARK: dict[str, Any] = {"color": colour(1), "linewidth": 0.9, "linestyle": "--"}
_SOUND: dict[str, Any] = {"color": "#7A7A7A", "linewidth": 0.9}


@dataclass(frozen=True, eq=False)
class ResidualSamples:
    """Residual force at each sample, the motion there, and residuals expected from sensor noise."""

    time: Matrix  # [s]
    residual: Matrix  # [N]
    displacement: Matrix  # [m]
    velocity: Matrix  # [m/s]
    force: Matrix  # [N] of the model
    draws: Matrix  # (draws, samples) [N] that errors of the sensors would leave
    interval: float  # [s]
    changes: Sequence[float] = ()  # [s] at which the residual changes
    lines: Sequence[float] = ()  # [Hz] that stand alone in it
    instant: float | None = None  # [s] of the largest residual, where it sits at single samples


def misfit_figure(s: ResidualSamples) -> Figure:
    """Residual over time, position, speed and model force, its spectrum, and its mean over position and speed."""
    with style_context():
        figure, axes = new_figure(6, 2, height=2.0)
        _over_time(axes[0], s)
        _spectrum(axes[1], s)
        _over(axes[2], s, s.displacement, "Displacement", "m")
        _over(axes[3], s, s.velocity, "Velocity", "m/s")
        _over(axes[4], s, s.force, "Model force", "N")
        _surface(figure, axes[5], s)
        titles = ("Time", "Frequency", "Position", "Speed", "Force", "Position and speed")
        for ax, letter, title in zip(axes, "abcdef", titles, strict=True):
            ax.set_title(f"({letter}) {title}", loc="left")
        add_legend(figure, axes)
    return figure


def _sound(s: ResidualSamples) -> float:
    return float(np.sqrt(np.mean(s.draws**2)))


def _limits(s: ResidualSamples) -> tuple[float, float]:
    """A range of the residual without its rarest samples."""
    low, high = np.quantile(s.residual, (0.003, 0.997))
    margin = 0.15 * max(float(high - low), 4.0 * _sound(s))
    return float(low) - margin, float(high) + margin


def _over_time(ax: Axes, s: ResidualSamples) -> None:
    own = choose_scale([np.abs(s.residual).max()], "N")
    ax.plot(s.time, s.residual * own.factor, color=colour(0), linewidth=0.6)
    level = 2.0 * _sound(s) * own.factor
    ax.axhspan(-level, level, color="#BBBBBB", linewidth=0.0, zorder=2.5, alpha=0.6, label="95 % of sensor noise")
    for change in s.changes:
        ax.axvline(change, **_MARK, label="change")
    ax.set_xlim(float(s.time[0]), float(s.time[-1]))
    ax.set(xlabel=axis_label("Time", "s"), ylabel=axis_label("Residual force", own.unit))
    if s.instant is not None:
        _around(ax, s, int(np.searchsorted(s.time, s.instant)), own.factor)


def _around(ax: Axes, s: ResidualSamples, at: int, factor: float) -> None:
    """The samples about an instant, in a window above the others."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 1.1 * (high - low))
    ax.plot(s.time[at], high, marker="v", markersize=4.0, color=colour(1), clip_on=False)
    inset = ax.inset_axes((0.56, 0.68, 0.4, 0.3))
    near = slice(max(at - _BESIDE, 0), at + _BESIDE + 1)
    inset.plot(s.time[near], s.residual[near] * factor, color=colour(0), linewidth=0.7, marker=".", markersize=3.0)
    inset.xaxis.set_major_locator(MaxNLocator(2))
    inset.yaxis.set_major_locator(MaxNLocator(2))
    inset.tick_params(labelsize="x-small")
    for side in ("top", "right"):
        inset.spines[side].set_visible(True)


def _spectrum(ax: Axes, s: ResidualSamples) -> None:
    window = np.hanning(s.residual.size)
    size = 2.0 / float(window.sum())
    frequency = np.fft.rfftfreq(s.residual.size, s.interval)
    ours = size * np.abs(np.fft.rfft(window * (s.residual - s.residual.mean())))
    sound = size * np.sqrt(np.mean(np.abs(np.fft.rfft(window * s.draws)) ** 2, axis=0))
    force = size * np.abs(np.fft.rfft(window * (s.force - s.force.mean())))
    own = choose_scale([ours.max()], "N")
    first = 2
    curves: tuple[tuple[Matrix, dict[str, Any], str], ...] = (
        (force, {"color": "#BBBBBB", "linewidth": 0.7}, "model force"),
        (ours, {"color": colour(0)}, "residual"),
    )
    for values, style, label in curves:
        ax.plot(frequency[first:], values[first:] * own.factor, **{"linewidth": 0.7, **style}, label=label)
    ax.plot(frequency[first:], _smooth(sound)[first:] * own.factor, **_SOUND, linestyle=":", label="sensor noise")
    for line in s.lines:
        ax.axvline(line, **{**_MARK, "linestyle": "-."}, label="line of the residual")
    log_axis(ax, "x")
    log_axis(ax, "y")
    least = 0.3 * float(np.median(sound[first:])) * own.factor
    ax.set_ylim(max(least, 1e-9), 2.0 * float(max(ours[first:].max(), force[first:].max())) * own.factor)
    ax.set_xlim(float(frequency[first]), float(frequency[-1]))
    ax.set(xlabel=axis_label("Frequency", "Hz"), ylabel=axis_label("Amplitude", own.unit))


def _smooth(values: Matrix) -> Matrix:
    width = max(values.size // 100, 1)
    return np.sqrt(np.convolve(values**2, np.ones(width) / width, "same"))


def _over(ax: Axes, s: ResidualSamples, along: Matrix, name: str, unit: str) -> None:
    """Samples, and the mean of each bin for either direction of the motion."""
    own, up = choose_scale([np.abs(along).max()], unit), choose_scale([np.abs(s.residual).max()], "N")
    every = max(s.residual.size // _MOST_POINTS, 1)
    ax.plot(along[::every] * own.factor, s.residual[::every] * up.factor, **_POINTS)
    edges = _edges(along, _BINS)
    parts = [(s.velocity > 0.0, "mean, moving +", colour(2), "-"), (s.velocity < 0.0, "mean, moving -", colour(1), "-")]
    if name == "Velocity":
        parts = [(np.ones(along.size, dtype=bool), "mean", "black", "-")]
    for chosen, label, shade, line in parts:
        at, means = _bin_means(along[chosen], s.residual[chosen], edges)
        ax.plot(at * own.factor, means * up.factor, color=shade, linestyle=line, linewidth=1.3, label=label)
    ax.set_ylim(*(limit * up.factor for limit in _limits(s)))
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    ax.set(xlabel=axis_label(name, own.unit), ylabel=axis_label("Residual force", up.unit))


def _edges(values: Matrix, count: int) -> Matrix:
    """Edges of bins as wide as each other, over all but the rarest values."""
    low, high = np.quantile(values, (0.002, 0.998))
    return np.linspace(float(low), float(high), count + 1)


def _bin_means(along: Matrix, values: Matrix, edges: Matrix) -> tuple[Matrix, Matrix]:
    bins = np.clip(np.searchsorted(edges, along) - 1, 0, edges.size - 2)
    count = np.bincount(bins, minlength=edges.size - 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        means = np.where(count >= _FEWEST, np.bincount(bins, values, edges.size - 1) / count, np.nan)
    return 0.5 * (edges[1:] + edges[:-1]), means


def _surface(figure: Figure, ax: Axes, s: ResidualSamples) -> None:
    """The mean residual over position and speed: what the restoring force lacks."""
    x, v = choose_scale([np.abs(s.displacement).max()], "m"), choose_scale([np.abs(s.velocity).max()], "m/s")
    edges = [_edges(q, _CELLS) for q in (s.displacement, s.velocity)]
    count, *_ = np.histogram2d(s.displacement, s.velocity, edges)
    total, *_ = np.histogram2d(s.displacement, s.velocity, edges, weights=s.residual)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(count >= _FEWEST, total / count, np.nan)
    known = np.abs(mean[np.isfinite(mean)])
    most = float(np.quantile(known, 0.97)) if known.size else 1.0
    most = max(most, _sound(s))
    up = choose_scale([most], "N")
    cells = ax.pcolormesh(
        edges[0] * x.factor, edges[1] * v.factor, mean.T * up.factor, cmap="RdBu_r",
        vmin=-most * up.factor, vmax=most * up.factor, rasterized=True,
    )  # fmt: skip
    ax.grid(visible=False)
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    figure.colorbar(cells, ax=ax, label=axis_label("Mean residual", up.unit))
    ax.set(xlabel=axis_label("Displacement", x.unit), ylabel=axis_label("Velocity", v.unit))
