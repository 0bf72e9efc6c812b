"""Drawings of networks."""

from __future__ import annotations

from collections.abc import Mapping
from io import StringIO

from matplotlib.figure import Figure

from inerter.errors import NetworkError
from inerter.figures.networks import network_figure, networks_by_title
from inerter.figures.style import style_context
from inerter.networks.elements.algebra import Network
from inerter.validation import checked
from inerter.vehicle.vehicle import Vehicle


@checked(NetworkError)
def plot_network(networks: Network | Mapping[str, Network], *, values: bool = False) -> Figure:
    """Drawing of a network, or of several below their names; `values` are written below the names of elements.

    Raises `NetworkError` if there is none.

    >>> import inerter as it
    >>> figure = it.plot_network({"S3": it.Spring(120e3) | it.Damper(7e3) - it.Inerter(300.0)}, values=True)
    >>> [round(float(size), 1) for size in figure.get_size_inches()] > [0.5, 0.5]
    True
    """
    named = {"": networks} if isinstance(networks, Network) else dict(networks)
    with style_context():
        return network_figure(named, values=values)


def network_svg(networks: Network | Mapping[str, Network]) -> str:
    """Drawing of a network, or of several below their names, as SVG, as notebooks show it."""
    drawn = StringIO()
    with style_context():
        plot_network(networks, values=True).savefig(drawn, format="svg", metadata={"Date": None})
    return drawn.getvalue()


def design_svg(design: Vehicle) -> str | None:
    """Drawing of the struts of a design as SVG, as notebooks show it; None if it has none."""
    struts = {strut.name: strut.network for strut in design.mechanism().struts}
    return network_svg(networks_by_title(struts)) if struts else None
