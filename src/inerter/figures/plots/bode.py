"""Bode plots of designs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from inerter.errors import LinearSystemError
from inerter.figures.plots.axes import add_curve_legend, axes_pair, label_gain_and_phase
from inerter.figures.plots.responses import Designs, Response, response_curves
from inerter.figures.style import style_context
from inerter.validation import checked

Array = NDArray[np.float64]
_HALF_TURN = 180.0  # [deg]


@checked(LinearSystemError)
def plot_bode(
    designs: Designs, response: Response, *, frequency: ArrayLike | None = None, axes: Sequence[Axes] | None = None
) -> tuple[Axes, Axes]:
    """Gain and phase of designs over frequency [Hz], on two axes.

    `designs` is one vehicle or several by their names; `response` an index, whose outputs are drawn with their
    weights over its excitation, or the names of an input and an output of `state_space`. A road is an input by its
    velocity. The phase is within 180 degrees of zero, also where delays between axles turn it many times: a line that
    leaves at one edge continues at the other.

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
            lower.plot(*_wrapped_phase(curve.frequency, curve.value), **curve.look)
        label_gain_and_phase(upper, lower, curves[0].gain_label)
        add_curve_legend(upper, len(curves), axes)
        lower.yaxis.set_major_locator(_degrees(lower))
    return upper, lower


def _wrapped_phase(frequency: Array, value: NDArray[np.complex128]) -> tuple[Array, Array]:
    """Frequencies and phases [deg] from -180 to 180, with the points where a line leaves, breaks, and continues."""
    phase = np.angle(value, deg=True)
    turns = np.flatnonzero(np.abs(np.diff(phase)) > _HALF_TURN)
    before, after = phase[turns], phase[turns + 1]
    edge = np.where(before > after, _HALF_TURN, -_HALF_TURN)
    share = (edge - before) / (after + 2.0 * edge - before)
    at = frequency[turns] + share * (frequency[turns + 1] - frequency[turns])
    places = np.repeat(turns + 1, 3)
    edges = np.column_stack([edge, np.full_like(edge, np.nan), -edge]).ravel()
    return np.insert(frequency, places, np.repeat(at, 3)), np.insert(phase, places, edges)


def _degrees(ax: Axes) -> Any:
    """Ticks at multiples of 45, 90 or 180 degrees."""
    from matplotlib.ticker import MultipleLocator  # noqa: PLC0415

    low, high = ax.get_ylim()
    return MultipleLocator(next((step for step in (45.0, 90.0, 180.0) if high - low <= 6.0 * step), 360.0))
