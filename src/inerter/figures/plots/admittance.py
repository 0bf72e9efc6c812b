"""Admittances of networks over frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from inerter.errors import NetworkError
from inerter.figures.labels import axis_label
from inerter.figures.plots.axes import add_curve_legend, axes_pair, curve_looks, label_gain_and_phase
from inerter.figures.plots.responses import check_frequencies
from inerter.figures.style import style_context
from inerter.networks.elements.algebra import Network, check_network
from inerter.validation import checked

_POINTS = 800  # frequencies


@checked(NetworkError)
def plot_admittance(
    networks: Network | Mapping[str, Network], *, frequency: ArrayLike | None = None, axes: Sequence[Axes] | None = None
) -> tuple[Axes, Axes]:
    """Size [N s/m] and phase of the admittance (force over velocity) of networks over frequency [Hz], on two axes.

    -90 degrees is a spring, 0 a damper, 90 an inerter. Friction is neglected and gaps are closed.

    Raises `NetworkError` if there is no network, `DesignError` if a value is free.

    >>> import inerter as it
    >>> gain, phase = it.plot_admittance({"S3": it.Spring(120e3) | it.Damper(7e3) - it.Inerter(300.0)})
    >>> phase.get_yticks().tolist()
    [-90.0, -45.0, 0.0, 45.0, 90.0]
    """
    named = {"": networks} if isinstance(networks, Network) else dict(networks)
    if not named:
        check_network(None)
    hertz = check_frequencies(np.geomspace(0.1, 100.0, _POINTS) if frequency is None else frequency)
    with style_context():
        upper, lower = axes_pair(axes)
        for look, network in zip(curve_looks(named), named.values(), strict=True):
            value = check_network(network).admittance(2j * np.pi * hertz)
            upper.plot(hertz, np.abs(value), **look)
            lower.plot(hertz, np.angle(value, deg=True), **look)
        label_gain_and_phase(upper, lower, axis_label("Admittance", "N s/m"))
        add_curve_legend(upper, len(named), axes)
        lower.set_yticks([-90.0, -45.0, 0.0, 45.0, 90.0])
    return upper, lower
