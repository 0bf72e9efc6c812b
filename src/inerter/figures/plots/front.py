"""Pareto fronts of designs."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.axes import Axes

from inerter.errors import DesignError
from inerter.figures.labels import axis_label
from inerter.figures.plots.axes import add_curve_legend, single_axes
from inerter.figures.style import colour, style_context
from inerter.formatting import capital
from inerter.pareto_fronts.front import ParetoFront
from inerter.validation import checked


@checked(DesignError)
def plot_front(fronts: ParetoFront | Mapping[str, ParetoFront], *, ax: Axes | None = None) -> Axes:
    """Pareto fronts of two indices, with their knees.

    Raises `DesignError` for a front of three indices, or of other indices than the first one's.

    >>> import inerter as it
    >>> road = it.Road(roughness=5e-7, speed=25.0)
    >>> c = it.Damper(it.free(1e3, 1e4, name="c"))
    >>> car = it.QuarterCar(181.75, 25.0, 120e3, it.Spring(120e3) | c)
    >>> front = it.pareto_front(car, [it.RideComfort(road), it.LoadCarrying()], it.Norm(), points=3, seed=0)
    >>> it.plot_front({"S1": front}).get_xlabel()
    'Ride comfort J1 [m/s²]'
    """
    named = {"": fronts} if isinstance(fronts, ParetoFront) else dict(fronts)
    kinds = {tuple(index.symbol for index in front.indices) for front in named.values()}
    if len(kinds) != 1 or any(len(kind) != 2 for kind in kinds):
        raise DesignError(f"A plot of fronts needs fronts of the same two indices, got {sorted(kinds)}.")
    with style_context():
        given, ax = ax, single_axes(ax)
        for number, (name, front) in enumerate(named.items()):
            ax.plot(*front.values.T, "o-", color=colour(number), label=name, markersize=3.0)
            if len(front.values):
                ax.plot(*front.values[front.knee], "o", color=colour(number), markersize=7, fillstyle="none")
        first, second = (
            axis_label(f"{capital(index.title)} {index.symbol}", index.unit)
            for index in next(iter(named.values())).indices
        )
        ax.set(xlabel=first, ylabel=second)
        add_curve_legend(ax, len(named), given)
    return ax
