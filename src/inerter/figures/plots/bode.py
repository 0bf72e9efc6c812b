"""Bode plots of designs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from inerter.figures.labels import axis_label
from inerter.figures.plots.axes import add_curve_legend, axes_pair
from inerter.figures.plots.responses import Designs, Response, response_curves
from inerter.figures.style import log_axis, style_context


def plot_bode(
    designs: Designs, response: Response, *, frequency: ArrayLike | None = None, axes: Sequence[Axes] | None = None
) -> tuple[Axes, Axes]:
    """Gain and phase of designs over frequency [Hz], on two axes.

    `designs` is one vehicle or several by their names; `response` an index, whose outputs are drawn without weights
    over its excitation, or the names of an input and an output of `state_space`. A road is an input by its velocity.

    Raises `DesignError` for a design with free values, or a response to several independent sources, as of two tracks
    with a coherence; and what `state_space` raises for unknown names.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(2e3)
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, strut)
    >>> gain, phase = it.plot_bode({"S1": car}, ("road", "sprung_acceleration"))
    >>> phase.get_ylabel(), phase.get_xlabel()
    ('Phase [deg]', 'Frequency [Hz]')
    """
    with style_context():
        upper, lower = axes_pair(axes)
        curves = list(response_curves(designs, response, frequency))
        for curve in curves:
            upper.plot(curve.frequency, np.abs(curve.value), **curve.look)
            lower.plot(curve.frequency, np.unwrap(np.angle(curve.value)) * 180.0 / np.pi, **curve.look)
        upper.set(ylabel=curves[0].gain_label)
        lower.set(xlabel=axis_label("Frequency", "Hz"), ylabel=axis_label("Phase", "deg"))
        for ax in (upper, lower):
            log_axis(ax, "x")
            ax.margins(x=0.0)
        log_axis(upper, "y")
        lower.yaxis.set_major_locator(_degrees(lower))
        add_curve_legend(upper, len(curves))
    return upper, lower


def _degrees(ax: Axes) -> Any:
    """Ticks at multiples of 45, 90 or 180 degrees."""
    from matplotlib.ticker import MultipleLocator  # noqa: PLC0415

    low, high = ax.get_ylim()
    return MultipleLocator(next((step for step in (45.0, 90.0, 180.0) if high - low <= 6.0 * step), 360.0))
