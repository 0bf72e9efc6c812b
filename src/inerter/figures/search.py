"""Figures of a search over networks: the frontier of each layout and index, and the best networks as schematics."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from inerter.figures.labels import axis_label, capital
from inerter.figures.networks import draw_networks
from inerter.figures.style import add_legend, colour, marker, new_figure, save, style_context
from inerter.files.study.searching import LayoutSearch, StudySearch, searched_mounts
from inerter.formatting import choose_scale, typeset_quantity
from inerter.networks.elements import Network

FRONTIER = "frontier"
_HEIGHT = 2.4  # of a row of panels [inch]


def best_networks_figure(one: LayoutSearch) -> str:
    """File name, without suffix, of the schematics of the best networks of a layout for an index."""
    return f"networks-{one.layout}-{one.index}"


def draw_search(found: StudySearch, folder: Path) -> list[Path]:
    """Write the frontier, and as SVG the best networks, into `folder`; returns the files."""
    searches = [one for one in found.searches if one.result.frontier]
    if not searches:
        return []
    with style_context():
        files = save(_frontier_figure(found, searches), folder, FRONTIER)
    for one in searches:
        files += draw_networks(
            dict(_best_networks(found, one)), folder, best_networks_figure(one), values=True, alone=True
        )
    return files


def _frontier_figure(found: StudySearch, searches: list[LayoutSearch]) -> Figure:
    figure, axes = new_figure(len(searches), min(len(searches), 2), height=_HEIGHT)
    for one, ax in zip(searches, axes, strict=True):
        frontier_steps(one, found.study.baseline or "", ax)
    add_legend(figure, axes)
    return figure


def frontier_steps(one: LayoutSearch, baseline: str, ax: Axes) -> Axes:
    """The best value for each number of elements, with the baseline as a horizontal line where there is one."""
    values = [network.value for network in one.result.frontier]
    scale = choose_scale(values, one.result.unit)
    counts = [network.n_elements for network in one.result.frontier]
    heights = [scale.factor * value for value in values]
    ax.plot(counts, heights, color=colour(0), marker=marker(0), markersize=4.5, label="best network")
    if isfinite(one.baseline):
        ax.axhline(scale.factor * one.baseline, color="black", linestyle="--", linewidth=1.0, label=baseline)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set(xlabel="Number of elements", ylabel=axis_label(capital(one.heading), scale.unit))
    return ax


def _best_networks(found: StudySearch, one: LayoutSearch) -> Iterator[tuple[str, Network]]:
    """Struts of the best network for each number of elements, by their titles."""
    mounts = searched_mounts(found.study, one.layout)
    for network in one.result.frontier:
        count = f"{network.n_elements} element{'' if network.n_elements == 1 else 's'}"
        title = f"{count}: {typeset_quantity(network.value, network.unit)}"
        struts = [strut for strut in network.design.mechanism().struts if strut.name in mounts]
        for strut in struts:
            yield (title if len(struts) == 1 else f"{title}\n{strut.name.replace('_', ' ')}"), strut.network
