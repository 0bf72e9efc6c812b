"""Figures of a rig: records, comparison of a fit with the measurement, and frequency responses with their bands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator
from numpy.typing import NDArray

from inerter.figures.curves import thin_curve
from inerter.figures.labels import axis_label
from inerter.figures.style import add_legend, colour, log_axis, new_figure, save, style_context
from inerter.formatting import Scale, choose_scale
from inerter.records.record import Record
from inerter.records.result import Response

Matrix = NDArray[np.float64]

_HEIGHT = 1.75  # of a panel over time [inch]
_MEASURED: dict[str, Any] = {"color": colour(0), "linewidth": 1.1}
_BELOW: dict[str, Any] = {"color": "#9CC8E6", "linewidth": 2.6}  # a measurement that a model lies upon
_MODEL: dict[str, Any] = {"color": colour(1), "linewidth": 1.1, "linestyle": (0, (5, 1.5))}
_ABOVE: dict[str, Any] = {"color": colour(1), "linewidth": 0.9}
_LINEAR: dict[str, Any] = {"color": "black", "linewidth": 0.9, "linestyle": (0, (1, 1.5))}
_IDEAL: dict[str, Any] = {"color": "#7A7A7A", "linewidth": 0.9, "linestyle": (0, (5, 1.5, 1, 1.5))}
_RECEIVED: dict[str, Any] = {"color": "#9A9A9A", "linewidth": 1.1}
_FEW = 60  # frequencies that are drawn as points with bars, not as a curve with a band
_HIGHEST_RISE = 2.6  # that is drawn, in thresholds
_DECADES = 30.0  # ratio of values from which on a profile has a log axis
_WIDEST = 3.0  # spacings between two frequencies that a curve joins


@dataclass(frozen=True, eq=False)
class MotionCurve:
    """Curve of a motion: its name in the legend, and channels in SI units."""

    label: str
    time: Matrix  # [s]
    displacement: Matrix  # [m]
    force: Matrix  # [N]


@dataclass(frozen=True, eq=False)
class ProfileCurve:
    """Profile likelihood of one parameter: rise of the loss over the rise allowed in a 95 % interval."""

    label: str
    values: Matrix  # increasing, in the unit
    rises: Matrix  # 0 at the best fit, 1 at the ends of the interval
    interval: tuple[float, float]
    unit: str  # empty for a ratio
    remark: str = ""  # such as that it is not identifiable


def draw(figure: Figure, folder: Path, name: str, *, print_too: bool = True) -> list[Path]:
    """Write a figure into `folder` as SVG and, for print too, as PDF and PNG; returns the files."""
    with style_context():
        return save(figure, folder, name, pdf=print_too, png=print_too)


def response_figure(
    measured: Response,
    model: Response | None = None,
    linear: Response | None = None,
    ideal: Response | None = None,
) -> Figure:
    """Gain, phase and coherence over frequency, measured with 95 % bands, and of models; as in Figure 10 of the paper.

    `model` is the model's response at the same amplitude, `linear` the linear one and `ideal` that of the inertance
    alone as baselines, as far as there are any.
    """
    with style_context():
        figure, (first,) = new_figure(height=4.9)
        first.remove()
        grid = figure.add_gridspec(3, 1, height_ratios=(2.3, 1.7, 0.95))
        axes = [figure.add_subplot(grid[i]) for i in range(3)]
        own = choose_scale([np.exp(np.mean(np.log(measured.gain)))], "N/m")
        curves = [(measured, "measured, with 95 % band", _MEASURED)]
        curves += [] if model is None else [(model, "model at the same amplitude", _MODEL)]
        for response, label, style in curves:
            draw_gain(axes[0], response, own, label, style)
            draw_phase(axes[1], response, style)
            draw_coherence(axes[2], response, style)
        baselines = [(linear, "linear model (no friction, gaps closed)", _LINEAR), (ideal, "ideal inerter", _IDEAL)]
        for response, label, style in ((r, label, style) for r, label, style in baselines if r is not None):
            axes[0].plot(response.frequency, response.gain * own.factor, label=label, zorder=1.5, **style)
            axes[1].plot(response.frequency, np.degrees(response.phase), zorder=1.5, **style)
        log_axis(axes[0], "y")
        axes[0].set_ylabel(axis_label("Gain", own.unit))
        axes[1].set_ylabel(axis_label("Phase", "deg"))
        axes[1].yaxis.set_major_locator(MultipleLocator(_phase_step(*axes[1].get_ylim())))
        axes[2].set(ylabel="Coherence", ylim=(0.0, 1.05), yticks=(0.0, 0.5, 1.0))
        span = [r.frequency for r in (measured, model, linear, ideal) if r is not None and r.omega.size]
        low, high = min(f.min() for f in span), max(f.max() for f in span)
        for ax in axes:
            ax.set_xlim(low / 1.05, high * 1.05)
            log_axis(ax, "x", least_ratio=4.0)
            ax.tick_params(axis="x", which="both", labelbottom=ax is axes[-1])
        axes[-1].set_xlabel(axis_label("Frequency", "Hz"))
        figure.align_ylabels(axes)
        add_legend(figure, axes)
    return figure


def draw_gain(ax: Axes, response: Response, own: Scale, label: str, style: dict[str, Any]) -> Axes:
    """Draw the gain in the unit `own` over frequency, with the band of a measured one."""
    return _with_band(ax, response, response.gain * own.factor, response.band * own.factor, style, label)


def draw_phase(ax: Axes, response: Response, style: dict[str, Any]) -> Axes:
    """Draw the phase in degrees over frequency, with the band of a measured one."""
    return _with_band(ax, response, np.degrees(response.phase), np.degrees(response.phase_band), style)


def draw_coherence(ax: Axes, response: Response, style: dict[str, Any]) -> Axes:
    """Draw the coherence over frequency, where its scatter is known."""
    if np.any(np.isfinite(response.averages)):
        marks = _marks(response, style)
        ax.plot(*_with_gaps(response, response.coherence), **marks)
    return ax


def time_figure(
    measured: MotionCurve, model: MotionCurve | None = None, window: tuple[float, float] | None = None
) -> Figure:
    """Displacement and force over time: Figure 8 of the paper, and with a model Figure 9."""
    with style_context():
        figure, axes = new_figure(2, height=_HEIGHT)
        curves = [(measured, _MEASURED)] if model is None else [(measured, _BELOW), (model, _ABOVE)]
        for ax, name, unit, letter in zip(axes, ("displacement", "force"), ("m", "N"), "ab", strict=True):
            moved = curves if name == "force" else [(measured, _MEASURED)]
            own = _over_time(ax, [(m.time, getattr(m, name), m.label, style) for m, style in moved], unit)
            ax.set_ylabel(axis_label(name.capitalize(), own.unit))
            ax.set_title(f"({letter}) {name.capitalize()}", loc="left")
        _share_time(axes, measured.time, window)
        if model is not None:
            add_legend(figure, axes[1:])
        figure.align_ylabels(axes)
    return figure


def record_figure(received: Record, used: Record) -> Figure:
    """The channels of a record as they came, in grey, and as they were used."""
    with style_context():
        figure, axes = new_figure(2, height=_HEIGHT)
        for ax, name, unit in zip(axes, ("displacement", "force"), ("m", "N"), strict=True):
            curves = [
                (received.time, getattr(received, name), "as received", _RECEIVED),
                (used.time, getattr(used, name), "as used", {**_MEASURED, "linewidth": 0.8}),
            ]
            ax.set_ylabel(axis_label(name.capitalize(), _over_time(ax, curves, unit).unit))
        if received.force_range is not None:
            _range_lines(axes[1], received, choose_scale([np.abs(received.force).max()], "N"))
        _share_time(axes, received.time, None)
        add_legend(figure, axes)
        figure.align_ylabels(axes)
    return figure


def residual_figure(time: Matrix, residual: Matrix, lags: Matrix, correlation: Matrix, bound: float) -> Figure:
    """Residual of the force [N] over time [s], and its autocorrelation over lags [s].

    `bound` is what the autocorrelation of white noise stays within in 95 of 100 cases.
    """
    with style_context():
        figure, (first,) = new_figure(height=1.9)
        first.remove()
        grid = figure.add_gridspec(1, 2, width_ratios=(1.7, 1.0))
        left, right = (figure.add_subplot(grid[i]) for i in range(2))
        own = _over_time(left, [(time, residual, "", {**_MEASURED, "linewidth": 0.7})], "N")
        left.set_ylabel(axis_label("Residual force", own.unit))
        left.set_xlabel(axis_label("Time", "s"))
        left.set_xlim(float(time[0]), float(time[-1]))
        spread = choose_scale([np.abs(lags).max()], "s")
        right.axhspan(-bound, bound, color="#BBBBBB", linewidth=0.0, label="95 % of white noise")
        right.axhline(0.0, color="black", linewidth=0.6)
        right.plot(lags * spread.factor, correlation, **{**_MEASURED, "linewidth": 0.9})
        right.set(xlabel=axis_label("Lag", spread.unit), ylabel="Autocorrelation")
        right.set_xlim(float(lags.min() * spread.factor), float(lags.max() * spread.factor))
        right.set_ylim(min(-0.3, 1.1 * float(correlation.min())), 1.08)
        add_legend(figure, [right])
    return figure


def loops_figure(displacement: Matrix, velocity: Matrix, force: Matrix, model: Matrix) -> Figure:
    """Force [N] over displacement [m] and over velocity [m/s], measured and of a model."""
    with style_context():
        figure, axes = new_figure(2, 2, height=2.6)
        up = choose_scale([np.abs(force).max()], "N")
        for ax, along, name, unit in zip(
            axes, (displacement, velocity), ("Displacement", "Velocity"), ("m", "m/s"), strict=True
        ):
            own = choose_scale([np.abs(along).max()], unit)
            ax.plot(along * own.factor, force * up.factor, **{**_BELOW, "linewidth": 1.9}, label="measured")
            ax.plot(along * own.factor, model * up.factor, **{**_ABOVE, "linewidth": 0.7}, label="model")
            ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
            ax.set(xlabel=axis_label(name, own.unit), ylabel=axis_label("Force", up.unit))
        add_legend(figure, axes)
    return figure


def profile_figure(curves: Sequence[ProfileCurve]) -> Figure:
    """Profile likelihoods, a panel for each parameter: an interval is where the curve lies below the line."""
    columns = min(3, len(curves))
    with style_context():
        figure, axes = new_figure(len(curves), columns, height=1.75)
        for ax, curve in zip(axes, curves, strict=True):
            draw_profile(ax, curve)
        for ax in axes[::columns]:
            ax.set_ylabel("Rise of the misfit")
        add_legend(figure, axes)
    return figure


def draw_profile(ax: Axes, curve: ProfileCurve) -> Axes:
    """Draw one profile likelihood; its square root is interpolated linearly between computed points."""
    at, rises = _between(curve)
    ax.axvspan(*curve.interval, color="#DDE9F3", linewidth=0.0, zorder=0.5, label="95 % interval")
    ax.axhline(1.0, color=colour(1), linewidth=0.9, linestyle="--", label="95 % threshold")
    ax.plot(at, rises, **{**_MEASURED, "linewidth": 1.0})
    inside = curve.rises <= _HIGHEST_RISE
    ax.plot(curve.values[inside], curve.rises[inside], linestyle="", marker="o", markersize=2.5, color=colour(0))
    ax.set_ylim(-0.1, _HIGHEST_RISE)
    low, high = _range_of_view(curve)
    if 0.0 < _DECADES * low < high:
        ax.set_xlim(low / 1.2, high * 1.2)
        log_axis(ax, "x")
    else:
        margin = 0.04 * (high - low or abs(high) or 1.0)
        ax.set_xlim(low - margin, high + margin)
        ax.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]))
        ax.ticklabel_format(axis="x", useOffset=False)
    ax.set_xlabel(axis_label(curve.label, curve.unit) if curve.unit else curve.label)
    if curve.remark:
        ax.set_title(curve.remark, loc="left")
    return ax


def _between(curve: ProfileCurve) -> tuple[Matrix, Matrix]:
    """Fine grid of parameter values and the profile there, by linear interpolation of its signed square root."""
    best = float(curve.values[int(np.argmin(curve.rises))])
    root = np.sqrt(np.maximum(curve.rises, 0.0)) * np.sign(curve.values - best)
    at = np.unique(
        np.concatenate([np.linspace(a, b, 30) for a, b in zip(curve.values, curve.values[1:], strict=False)])
    )
    return at, np.interp(at, curve.values, root) ** 2


def _range_of_view(curve: ProfileCurve) -> tuple[float, float]:
    """Range of the abscissa: the interval with 70 % of its width on either side, within the curve."""
    begin, end = curve.interval
    low, high = min(float(curve.values[0]), begin), max(float(curve.values[-1]), end)
    width = end - begin or high - low
    return max(low, begin - 0.7 * width), min(high, end + 0.7 * width)


def _with_band(
    ax: Axes, response: Response, values: Matrix, band: Matrix, style: dict[str, Any], label: str = ""
) -> Axes:
    marks = _marks(response, style)
    frequency, curve = _with_gaps(response, values)
    named: dict[str, Any] = {"label": label} if label else {}
    (line,) = ax.plot(frequency, curve, **marks, **named)
    if style is not _MEASURED:
        return ax
    if response.omega.size <= _FEW:
        bars: dict[str, Any] = {"fmt": "none", "elinewidth": 0.8, "capsize": 1.5, "zorder": 2.4}
        ax.errorbar(response.frequency, values, np.abs(band - values), ecolor=line.get_color(), **bars)
    else:
        low, high = (_with_gaps(response, end)[1] for end in band)
        ax.fill_between(frequency, low, high, color=line.get_color(), alpha=0.25, linewidth=0.0)
    return ax


def _marks(response: Response, style: dict[str, Any]) -> dict[str, Any]:
    """Line keywords of a curve with many frequencies, marker keywords of one with few."""
    if response.omega.size > _FEW:
        return {**style, "linewidth": 0.8}
    hollow = style is not _MEASURED
    size = {"markersize": 4.0 if hollow else 3.0, "markeredgewidth": 0.9, "zorder": 3.0 if hollow else 2.5}
    face = {"markerfacecolor": "none"} if hollow else {}
    return {"color": style["color"], "linestyle": "", "marker": "s" if hollow else "o", **size, **face}


def _with_gaps(response: Response, values: Matrix) -> tuple[Matrix, Matrix]:
    """Frequencies and values with nan inserted where frequencies are missing, so that lines break there."""
    frequency = response.frequency
    if frequency.size < 3:
        return frequency, values
    apart = np.flatnonzero(np.diff(frequency) > _WIDEST * np.median(np.diff(frequency))) + 1
    return np.insert(frequency, apart, frequency[apart]), np.insert(values, apart, np.nan)


def _over_time(ax: Axes, curves: Sequence[tuple[Matrix, Matrix, str, dict[str, Any]]], unit: str) -> Scale:
    """Draw curves over time in the unit that suits the largest value of the first; returns that unit."""
    own = choose_scale([np.nanmax(np.abs(curves[0][1]))], unit)
    for time, values, label, style in curves:
        named: dict[str, Any] = {"label": label} if label else {}
        ax.plot(*thin_curve(time, values * own.factor), **style, **named)
    return own


def _share_time(axes: Sequence[Axes], time: Matrix, window: tuple[float, float] | None) -> None:
    for ax in axes:
        ax.set_xlim(*(window or (float(time[0]), float(time[-1]))))
        ax.tick_params(labelbottom=ax is axes[-1])
    axes[-1].set_xlabel(axis_label("Time", "s"))


def _range_lines(ax: Axes, received: Record, own: Scale) -> None:
    """The limits of the load cell, where the force comes near them."""
    limit = (received.force_range or np.inf) * own.factor
    if np.abs(received.force).max() * own.factor > 0.8 * limit:
        for sign in (-1.0, 1.0):
            ax.axhline(sign * limit, color=colour(1), linewidth=0.8, linestyle="--", label="limit of the load cell")


def _phase_step(low: float, high: float) -> float:
    return next((step for step in (15.0, 30.0, 45.0, 90.0) if high - low <= 5.0 * step), 90.0)
