"""Figure of a simulation: inputs, body acceleration, tyre forces, and the force of every strut, over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from inerter.errors import StudyError
from inerter.figures.curves import thin_curve
from inerter.figures.labels import axis_label
from inerter.figures.style import WIDE, add_legend, colour, new_figure, save, style_context
from inerter.files.simulation.running import Nonlinear, SimulationResult
from inerter.formatting import capital, choose_scale, format_number, format_range, in_words
from inerter.networks.elements.roles import GuardRole
from inerter.systems.outputs import force_of

Matrix = NDArray[np.float64]
Window = tuple[float, float]

NAME = "simulation"
_HEIGHT = 1.35  # of a panel [inch], which its title must fit
_LONGEST_TITLE = 20
_MOST_SWINGS, _MOST_BANDS = 160, 60  # in a window that can be read
_SHADES: dict[GuardRole, Any] = {
    GuardRole.FORCE: {"facecolor": "#DCDCDC", "edgecolor": "none"},
    GuardRole.ELONGATION: {"facecolor": "#F8DCB8", "edgecolor": "none"},
}
_TYRES = "tyre load"
_LIFTED: Any = {"facecolor": "#E9A3A3", "edgecolor": "#B03030", "linewidth": 0.6}
_OVER_GAPS: Any = {"facecolor": "none", "edgecolor": "#8C8C8C", "hatch": "//////"}


@dataclass(frozen=True)
class Curve:
    """Curve of an output: label in its panel, colour number, and factor."""

    output: str
    label: str = ""
    number: int = 0
    weight: float = 1.0


@dataclass(frozen=True)
class TimePanel:
    """Curves over time on one axis; the states of a strut's friction and gaps are shaded."""

    title: str
    unit: str
    curves: tuple[Curve, ...]
    shaded: tuple[Nonlinear, ...] = ()


def draw_simulation(result: SimulationResult, folder: Path, window: Window | None = None) -> list[Path]:
    """Write the figure into `folder` as SVG and as PNG; returns the files.

    Raises `StudyError` for a `window` [s] with less than two samples.
    """
    with style_context():
        return save(simulation_figure(result, window or readable_window(result)), folder, NAME)


def panels(result: SimulationResult) -> list[TimePanel]:
    """Panels of the figure, from top to bottom."""
    outputs, struts = result.run.outputs, result.struts
    inputs = result.inputs
    found = [TimePanel(_common(inputs), outputs[inputs[0]].unit, _curves(inputs))]
    if result.accelerations:
        weights = {w.output: w.weight for w in result.mechanism.measures.comfort}
        body = tuple(
            Curve(name, name.removesuffix("_acceleration") + ("" if w == 1.0 else f" × {format_number(w, 3)} m"), i, w)
            for i, (name, w) in enumerate(weights.items(), len(struts))
        )
        found.append(TimePanel("body acceleration", "m/s^2", body if len(body) > 1 else (Curve(body[0].output),)))
    found += [TimePanel(in_words(name), outputs[name].unit, (Curve(name),)) for name in result.displacements]
    if result.tyre_loads:
        found.append(TimePanel(_TYRES, "N", _curves(result.tyre_loads)))
    for strut in struts:
        shaded = tuple(n for n in result.nonlinear if n.strut == strut)
        inerters = result.inerters(strut)
        if result.on_rig and inerters:
            found.append(TimePanel(f"{strut} force", "N", (Curve(force_of(strut)),)))
        title = f"{f'{strut} ' if len(struts) > 1 else ''}{'inerter' if inerters else strut} force"
        title = title.replace(f"{strut} {strut}", strut).replace("_", " ")
        carried = tuple(map(force_of, inerters)) or (force_of(strut),)
        numbers = range(struts.index(strut), len(carried) + struts.index(strut))
        labels = inerters if len(inerters) > 1 else ("",)
        found.append(TimePanel(title, "N", tuple(map(Curve, carried, labels, numbers)), shaded))
    return found


def readable_window(result: SimulationResult) -> Window:
    """Time window [s] legible in print: the whole run, or its last 1/2, 1/5, 1/10, ..."""
    run = result.run
    end = float(run.time[-1])
    length = whole = end - float(run.time[0])
    swings = [_swings(run[curve.output], run.time) for panel in panels(result) for curve in panel.curves]
    bands = [np.array(run.intervals(n.name, n.switch.middle)).reshape(-1, 2)[:, 1] for n in result.nonlinear]
    limits = [(times, _MOST_SWINGS) for times in swings] + [(times, _MOST_BANDS) for times in bands]
    for part in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000):
        length = whole / part
        if all(np.sum(times >= end - length) <= most for times, most in limits):
            break
    return end - length, end


def simulation_figure(result: SimulationResult, window: Window) -> Figure:
    """Figure of all panels over the times in `window` [s]; for a rig, with the force-displacement loop."""
    wanted, run = panels(result), result.run
    inside = (run.time >= window[0]) & (run.time <= window[1])
    if np.sum(inside) < 2:
        raise StudyError(
            f"The window from {format_range(*window, 's', 6)} contains fewer than two of the samples from "
            f"{format_range(run.time[0], run.time[-1], 's', 6)}."
        )
    rig = result.on_rig
    figure, axes = new_figure(len(wanted), height=_HEIGHT) if not rig else _with_loop(len(wanted))
    for ax, panel in zip(axes, wanted, strict=False):
        draw_panel(result, panel, inside, ax)
        ax.set_xlim(*window)
        ax.sharex(axes[0])
        ax.tick_params(labelbottom=False)
    last = axes[len(wanted) - 1]
    last.tick_params(labelbottom=True)
    last.set_xlabel(axis_label("Time", "s"))
    if rig:
        draw_loop(result, inside, axes[-1])
    figure.align_ylabels(axes[: len(wanted)])
    if any(ax.get_legend_handles_labels()[0] for ax in axes):
        add_legend(figure, axes)
    return figure


def draw_panel(result: SimulationResult, panel: TimePanel, inside: NDArray[np.bool_], ax: Axes) -> Axes:
    """The curves of one panel, and behind them the intervals in which its friction sticks and its gaps are open."""
    run = result.run
    time = run.time[inside]
    values = [run[curve.output][inside] * curve.weight for curve in panel.curves]
    unit = choose_scale([max(float(np.abs(v).max(initial=0.0)) for v in values)], panel.unit)
    for curve, value in zip(panel.curves, values, strict=True):
        ax.plot(*thin_curve(time, value * unit.factor), **_style(curve))
    _shade(result, panel.shaded, (float(time[0]), float(time[-1])), ax)
    if panel.title == _TYRES:
        _shade_lift_offs(result, (float(time[0]), float(time[-1])), ax)
    ax.set_ylabel(fill(axis_label(capital(panel.title), unit.unit), _LONGEST_TITLE, break_long_words=False))
    return ax


def draw_loop(result: SimulationResult, inside: NDArray[np.bool_], ax: Axes) -> Axes:
    """The force of the device over the displacement of the table; what comes before the last period is grey."""
    (road,), (device,) = result.inputs, result.struts
    time, x, y = (
        result.run[name][inside] if name else result.run.time[inside] for name in ("", road, f"{device}_force")
    )
    along, up = (choose_scale([np.abs(v).max()], unit) for v, unit in ((x, "m"), (y, "N")))
    period = result.request.period
    last = time >= time[-1] - (period or np.inf) * (1.0 + 1e-9)
    if not last.all():
        ax.plot(x * along.factor, y * up.factor, color="#BBBBBB", linewidth=0.6)
    ax.plot(x[last] * along.factor, y[last] * up.factor, color=colour(0), linewidth=0.9)
    ax.set(xlabel=axis_label(capital(road), along.unit), ylabel=axis_label(f"{capital(device)} force", up.unit))
    return ax


def _with_loop(rows: int) -> tuple[Figure, list[Axes]]:
    figure, (first,) = new_figure(height=rows * _HEIGHT + 0.5, width=WIDE)
    first.remove()
    grid = figure.add_gridspec(rows, 2, width_ratios=(1.7, 1.0))
    axes = [figure.add_subplot(grid[i, 0]) for i in range(rows)]
    return figure, [*axes, figure.add_subplot(grid[:, 1])]


def _curves(names: Sequence[str]) -> tuple[Curve, ...]:
    labels = _own(names) if len(names) > 1 else [""]
    return tuple(Curve(name, label, i) for i, (name, label) in enumerate(zip(names, labels, strict=True)))


def _shared_words(names: Sequence[str]) -> list[str]:
    """The words that all names have: "tyre" and "load" of `tyre_front_load` and `tyre_rear_load`."""
    words = [name.split("_") for name in names]
    return [word for word in words[0] if all(word in others for others in words)]


def _common(names: Sequence[str]) -> str:
    """Words common to the names of several outputs; else the first name."""
    return " ".join(_shared_words(names)) or in_words(names[0])


def _own(names: Sequence[str]) -> list[str]:
    """Words that distinguish each of several outputs: "front" of `road_front`, or its whole name."""
    shared = _shared_words(names)
    own = [" ".join(word for word in name.split("_") if word not in shared) for name in names]
    return own if all(own) and len({*own}) == len(own) else [in_words(name) for name in names]


def _style(curve: Curve) -> dict[str, Any]:
    return {"color": colour(curve.number), "linewidth": 0.9, **({"label": curve.label} if curve.label else {})}


def _shade(result: SimulationResult, elements: Sequence[Nonlinear], window: Window, ax: Axes) -> None:
    """Filled where a friction sticks or a gap is open; several of one kind share the height.

    Where there are both, the friction is hatched, so that one shows through the other.
    """
    over_gaps = any(n.switch.guard is GuardRole.ELONGATION for n in result.nonlinear)
    shades = {**_SHADES, GuardRole.FORCE: _OVER_GAPS} if over_gaps else _SHADES
    for element in elements:
        guard = element.switch.guard
        alike = [other.name for other in elements if other.switch.guard is guard]
        row = alike.index(element.name)
        low, high = 1.0 - (row + 1) / len(alike), 1.0 - row / len(alike)
        name = element.name.removeprefix(f"{element.strut}.")
        label = element.switch.middle_state_text(name) + (f" (row {row + 1})" if len(alike) > 1 else "")
        for begin, end in result.run.intervals(element.name, element.switch.middle):
            if begin < window[1] and end > window[0]:
                ax.axvspan(begin, end, low, high, linewidth=0.0, zorder=0.5, label=label, **shades[guard])


def _shade_lift_offs(result: SimulationResult, window: Window, ax: Axes) -> None:
    """Filled where a tyre pulls by more than its static load; several tyres share the height."""
    tyres = list(result.run.static_loads)
    for one in result.run.lift_offs:
        if one.begin < window[1] and one.end > window[0]:
            row, several = tyres.index(one.tyre), len(tyres) > 1
            label = f"{in_words(one.tyre)} would lift off{f' (row {row + 1})' if several else ''}"
            low, high = 1.0 - (row + 1) / len(tyres), 1.0 - row / len(tyres)
            ax.axvspan(one.begin, max(one.end, one.begin + 1e-9), low, high, label=label, zorder=0.5, **_LIFTED)


def _swings(values: Matrix, time: Matrix) -> Matrix:
    """Times at which a curve crosses its mean."""
    above = values > np.mean(values)
    return np.asarray(time[1:][above[1:] != above[:-1]])
