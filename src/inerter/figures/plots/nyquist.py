"""Nyquist plots of designs."""

from __future__ import annotations

from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from inerter.errors import LinearSystemError
from inerter.figures.plots.axes import add_curve_legend, label_complex_plane, single_axes
from inerter.figures.plots.responses import Designs, Response, response_curves
from inerter.figures.style import style_context
from inerter.validation import checked


@checked(LinearSystemError)
def plot_nyquist(
    designs: Designs, response: Response, *, frequency: ArrayLike | None = None, ax: Axes | None = None
) -> Axes:
    """Responses of designs in the complex plane, as in `plot_bode`; a dot marks the lowest frequency.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(2e3))
    >>> it.plot_nyquist(car, ("road", "sprung_velocity")).get_xlabel()
    'Real part [(m/s)/(m/s)]'
    """
    with style_context():
        given, ax = ax, single_axes(ax)
        curves = list(response_curves(designs, response, frequency))
        for curve in curves:
            ax.plot(curve.value.real, curve.value.imag, **curve.look)
            ax.plot(curve.value.real[:1], curve.value.imag[:1], "o", color=curve.look["color"], markersize=3.5)
        ax.set_aspect("equal", adjustable="datalim")
        label_complex_plane(ax, curves[0].unit, curves[0].unit)
        add_curve_legend(ax, len(curves), given)
    return ax
