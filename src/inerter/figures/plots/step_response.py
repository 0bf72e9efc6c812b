"""Step responses of designs."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from inerter.errors import LinearSystemError
from inerter.figures.labels import axis_label
from inerter.figures.plots.axes import add_curve_legend, curve_looks, single_axes
from inerter.figures.plots.responses import Designs, designs_by_name
from inerter.figures.style import style_context
from inerter.files.study.responses import gain_unit
from inerter.formatting import capital, in_words
from inerter.systems.assemble import state_space
from inerter.systems.linear import LinearSystem
from inerter.systems.outputs import input_unit, unit_of
from inerter.validation import check_positive, checked

Array = NDArray[np.float64]

_STEPS = 2000  # samples


@checked(LinearSystemError)
def plot_step_response(
    designs: Designs, response: tuple[str, str], *, duration: float = 2.0, ax: Axes | None = None
) -> Axes:
    """Response of an output of designs to a unit step of an input over time [s].

    A road steps by its height of 1 m, a force by 1 N; `response` are names of an input and an output of `state_space`.

    Raises `DesignError` for a design with free values, and what `state_space` raises for unknown names.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(2e3))
    >>> it.plot_step_response(car, ("road", "sprung_displacement")).get_xlabel()
    'Time [s]'
    """
    check_positive(LinearSystemError, "The duration", duration, "s")
    time = np.linspace(0.0, duration, _STEPS)
    with style_context():
        given, ax = ax, single_axes(ax)
        named = designs_by_name(designs)
        label = ""
        for look, vehicle in zip(curve_looks(named), named.values(), strict=True):
            mechanism = vehicle.mechanism()
            system = state_space(vehicle, *response)
            roads = response[0] in {road.name for road in mechanism.roads}
            ax.plot(time, _impulse(system, time) if roads else _step(system, time), **look)
            what, per = unit_of(mechanism, [response[1]]), "m" if roads else input_unit(mechanism, response[0])
            words = f"{capital(in_words(response[1]))} over step of {in_words(response[0])}"
            label = axis_label(words, gain_unit(what, per))
        ax.set(xlabel=axis_label("Time", "s"), ylabel=label)
        ax.margins(x=0.0)
        add_curve_legend(ax, len(named), given)
    return ax


def _step(system: LinearSystem, time: Array) -> Array:
    """Response to a unit step of the one input, at even times."""
    n = system.order
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n] = system.A, system.B[:, 0]
    return _free_motion(block, np.eye(n + 1)[n], np.append(system.C[0], system.D[0, 0]), time)


def _impulse(system: LinearSystem, time: Array) -> Array:
    """Response to a unit impulse of the one input, at even times: a step of what it is the velocity of."""
    if system.D[0, 0] != 0.0:
        raise LinearSystemError("This output has an impulse at a step of the road. Choose another, or another signal.")
    return _free_motion(system.A, system.B[:, 0], system.C[0], time)


def _free_motion(A: Array, begin: Array, row: Array, time: Array) -> Array:
    """Row exp(A t) begin at even times."""
    from scipy.linalg import expm  # noqa: PLC0415 - heavy

    flow, state, found = expm(A * (time[1] - time[0])), begin, np.empty(time.size)
    for i in range(time.size):
        found[i] = row @ state
        state = flow @ state
    return found
