"""Poles of designs in the complex plane."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from inerter.errors import LinearSystemError
from inerter.figures.plots.axes import add_curve_legend, label_complex_plane, single_axes
from inerter.figures.plots.responses import Designs, designs_by_name
from inerter.figures.style import colour, style_context
from inerter.formatting import format_number
from inerter.norms.exact import poles_exactly
from inerter.systems.assemble import state_space
from inerter.validation import checked


@checked(LinearSystemError)
def plot_poles(designs: Designs, *, ax: Axes | None = None) -> Axes:
    """Poles of designs [1/s], with the rays of equal damping ratio.

    Raises `DesignError` for a design with free values.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(2e3))
    >>> it.plot_poles(car).get_xlabel()
    'Real part [1/s]'
    """
    with style_context():
        given, ax = ax, single_axes(ax)
        named = designs_by_name(designs)
        reach = 0.0
        for number, (name, vehicle) in enumerate(named.items()):
            poles = poles_exactly(state_space(vehicle))
            reach = max(reach, float(np.abs(poles.imag).max(initial=0.0)))
            ax.plot(poles.real, poles.imag, "x", color=colour(number), label=name, markersize=5)
        for ratio in (0.1, 0.3, 0.7) if reach else ():
            ray = np.array([0.0, reach])
            ax.plot(-ratio / np.sqrt(1.0 - ratio**2) * ray, ray, ":", color="#AAAAAA", linewidth=0.7)
            ax.annotate(
                f"ζ = {format_number(ratio)}",
                (-ratio / np.sqrt(1.0 - ratio**2) * reach, reach),
                color="#777777",
                fontsize=6.5,
            )
        label_complex_plane(ax, "1/s", "rad/s")
        add_curve_legend(ax, len(named), given)
    return ax
