"""Outputs of simulated motions over time, and over one another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from inerter.errors import SimulationError
from inerter.figures.labels import axis_label
from inerter.figures.plots.axes import add_legend_above, single_axes
from inerter.figures.style import colour, new_figure, style_context
from inerter.formatting import capital, choose_scale, format_range
from inerter.networks.elements.registry import middle_phrases
from inerter.simulation.trajectory import Trajectory
from inerter.validation import checked

Array = NDArray[np.float64]

_SHADES = {"stick": "#F6DDA8", "open": "#D5E4F2"}


@checked(SimulationError)
def plot_trajectory(
    run: Trajectory,
    outputs: Sequence[str] | str,
    *,
    window: tuple[float, float] | None = None,
    axes: Sequence[Axes] | None = None,
) -> list[Axes]:
    """Outputs of a simulated motion over time, an axis each, shaded where friction sticks and where gaps are open.

    `window` is the time [s] from and to which is drawn; all by default.

    Raises `SimulationError` for an output that is not there, or a window without samples.

    >>> import inerter as it
    >>> screw = it.Inerter(100.0) | it.Friction(20.0, name="f")
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(2e3) | screw)
    >>> run = it.simulate(car, road=it.cosine(1e-3, 1.0), duration=2.0)
    >>> [ax.get_ylabel() for ax in it.plot_trajectory(run, ["sprung_acceleration", "tyre_load"])]
    ['Sprung acceleration [m/s²]', 'Tyre load [N]']
    """
    names = [outputs] if isinstance(outputs, str) else list(outputs)
    inside, (low, high) = _samples_within(run, window, names)
    with style_context():
        several = list(axes) if axes is not None else new_figure(len(names), height=1.9)[1]
        if len(several) != len(names):
            raise SimulationError(f"Each of {len(names)} outputs needs axes, got {len(several)}.")
        for name, ax in zip(names, several, strict=True):
            values, label = scale_output(run, name, inside)
            ax.plot(run.time[inside], values, linewidth=0.9, color=colour(0))
            ax.set(ylabel=label, xlim=(low, high))
            _shade(run, (low, high), ax)
        several[-1].set(xlabel=axis_label("Time", "s"))
        add_legend_above(several[0])
    return several


@checked(SimulationError)
def plot_loop(
    run: Trajectory,
    across: str,
    up: str,
    *,
    window: tuple[float, float] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """An output of a simulated motion over another one, such as a force over a displacement.

    Raises `SimulationError` for an output that is not there, or a window without samples.

    >>> import inerter as it
    >>> rig = it.Rig((it.Spring(1e6) | it.Damper(3200.0)) - (it.Inerter(113.0) | it.Friction(10.0)))
    >>> run = it.simulate(rig, displacement=it.sine(1e-3, 3.0), duration=2.0)
    >>> it.plot_loop(run, "displacement", "device_force").get_ylabel()
    'Device force [N]'
    """
    inside, _ = _samples_within(run, window, [across, up])
    with style_context():
        ax = single_axes(ax)
        (along, x_label), (height, y_label) = (scale_output(run, name, inside) for name in (across, up))
        ax.plot(along, height, linewidth=0.9, color=colour(0))
        ax.set(xlabel=x_label, ylabel=y_label)
    return ax


def _samples_within(
    run: Trajectory, window: tuple[float, float] | None, names: Sequence[str]
) -> tuple[NDArray[np.bool_], tuple[float, float]]:
    """Which samples are in the window, and its ends; raises `SimulationError` if there is no sample, or no output."""
    low, high = window if window is not None else (float(run.time[0]), float(run.time[-1]))
    inside = (run.time >= low) & (run.time <= high)
    if not names or not inside.any():
        known = format_range(run.time[0], run.time[-1], "s")
        raise SimulationError(
            f"A plot of a motion needs outputs, and samples in its window: got {names!r} from "
            f"{format_range(low, high, 's')}, where the motion is known from {known}."
        )
    return inside, (low, high)


def scale_output(run: Trajectory, name: str, inside: NDArray[np.bool_]) -> tuple[Array, str]:
    """Samples of an output in a unit that suits their size, and the label of their axis."""
    values, output = run[name][inside], run.outputs[name]
    scale = choose_scale([float(np.abs(values).max())], output.unit)
    return values * scale.factor, axis_label(capital(output.title), scale.unit)


def _shade(run: Trajectory, window: tuple[float, float], ax: Axes) -> None:
    """Filled where an element sticks or is open."""
    for element in run.states:
        for state, fill in _SHADES.items():
            for begin, end in run.intervals(element, state):
                if begin < window[1] and end > window[0]:
                    label = f"{element} {middle_phrases()[state]}"
                    ax.axvspan(begin, end, color=fill, linewidth=0.0, zorder=0.5, label=label)
