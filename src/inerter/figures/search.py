"""Figures of a search over networks: the frontier of each layout and index, and the best networks as schematics."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from inerter.figures.labels import axis_label
from inerter.figures.networks import draw_networks
from inerter.figures.style import add_legend, colour, file_stems, marker, new_figure, save, style_context
from inerter.files.study.searching import LayoutFront, LayoutSearch, StudySearch, searched_mounts
from inerter.formatting import capital, choose_scale, format_count, in_words, typeset_quantity
from inerter.indices.names import title_with_name
from inerter.network_search.front_results import FrontNetwork
from inerter.networks.elements import Network

FRONTIER = "frontier"
_HEIGHT, _FRONT_HEIGHT = 2.4, 3.4  # of a row of panels [inch]
_FAR = 3.0


def figure_names(found: StudySearch) -> tuple[dict[str, LayoutSearch], dict[str, LayoutFront]]:
    """File names, without suffix, of the schematics of the best networks, and of the fronts, with what each shows."""
    networks = {f"networks-{one.layout}-{one.index}": one for one in found.searches}
    fronts = {f"front-{one.layout}": one for one in found.fronts}
    stems = file_stems([FRONTIER, *networks, *fronts])
    return {stems[name]: one for name, one in networks.items()}, {stems[name]: one for name, one in fronts.items()}


def draw_search(found: StudySearch, folder: Path) -> list[Path]:
    """Write the frontier, and as SVG the best networks, into `folder`; returns the files."""
    networks, fronts = figure_names(found)
    searches = [one for one in found.searches if one.result.frontier]
    if not searches:
        return []
    with style_context():
        files = save(_frontier_figure(found, searches), folder, FRONTIER)
    for name, one in networks.items():
        if one.result.frontier:
            files += draw_networks(dict(_best_networks(found, one)), folder, name, values=True, alone=True)
    for name, front in fronts.items():
        if len(front.result.front) > 1:
            with style_context():
                pairs = list(combinations(range(len(front.result.symbols)), 2))
                figure, axes = new_figure(len(pairs), min(len(pairs), 2), height=_FRONT_HEIGHT)
                for pair, ax in zip(pairs, axes, strict=True):
                    front_curves(found, front, pair, ax)
                add_legend(figure, axes)
                files += save(figure, folder, name)
    return files


def front_curves(found: StudySearch, one: LayoutFront, pair: tuple[int, int], ax: Axes) -> Axes:
    """Fronts in two indices of the networks of up to each number of elements, and designs without a free network.

    A front of three indices is that over all networks, by network.

    Designs that are farther than `_FAR` ranges of the front over all networks from its ends are not in the picture.
    """
    study, result = found.study, one.result
    names = [study.trade_off[i] for i in pair]
    scales = [choose_scale(result.values[:, i].tolist(), result.units[i]) for i in pair]
    factors = np.array([scale.factor for scale in scales])
    own = result.values[:, list(pair)] * factors
    least, size = own.min(axis=0), np.ptp(own, axis=0)
    size = np.where(size > 0.0, size, np.abs(least))
    inside = [own]
    two = len(result.symbols) == 2
    for number, (label, front) in enumerate(_series(one)):
        table = np.array([[point.values[i] for i in pair] for point in front]) * factors
        if np.all(table.min(axis=0) <= least + _FAR * size):
            look: dict[str, Any] = {"marker": marker(number), "color": colour(number), "linestyle": "-" if two else ""}
            changes = [i for i in range(1, len(front)) if front[i].layout != front[i - 1].layout]
            for part in np.split(table, changes):  # no line from one network to another
                ax.plot(*part.T, markersize=3.0, **look)
            ax.plot([], [], label=label, markersize=3.0, **look)
            inside.append(table)
    for layout in dict.fromkeys(each.layout for each in found.fixed):
        at = np.array(_fixed_values(found, layout, names)) * factors
        if np.all(np.isfinite(at)) and np.all(at <= least + _FAR * size):
            ax.plot(*at[:, None], linestyle="", marker="x", markersize=6.0, color="black", zorder=3)
            ax.annotate(layout, (at[0], at[1]), xytext=(5.0, 5.0), textcoords="offset points")
            inside.append(at[None])
    if two:
        _name_networks(one, pair, factors, ax)
    highest = np.minimum(np.concatenate(inside).max(axis=0), least + _FAR * size)
    margin = 0.05 * (highest - least)
    ax.set(
        **{
            f"{which}label": axis_label(capital(title_with_name(study.index(name).title, name)), scale.unit)
            for which, name, scale in zip("xy", names, scales, strict=True)
        },
        xlim=(least[0] - 5.0 * margin[0], highest[0] + margin[0]),  # room for the names of networks
        ylim=(least[1] - 2.0 * margin[1], highest[1] + margin[1]),
    )
    return ax


def _series(one: LayoutFront) -> Iterator[tuple[str, Sequence[FrontNetwork]]]:
    """Fronts by number of elements, without those that are equal to the one before; of three indices networks."""
    if len(one.result.symbols) > 2:
        for layout in one.result.networks:
            yield layout, [point for point in one.result.front if point.layout == layout]
        return
    before: tuple[FrontNetwork, ...] = ()
    for count, front in one.result.by_elements.items():
        if front != before:
            yield f"up to {format_count(count, 'elements')}", front
        before = front


def _name_networks(one: LayoutFront, pair: tuple[int, int], factors: NDArray[np.float64], ax: Axes) -> None:
    """Write the layout of each network of the front below and left of the middle of its points, where no design is."""
    for layout in one.result.networks:
        own = [point for point in one.result.front if point.layout == layout]
        x, y = factors * [own[len(own) // 2].values[i] for i in pair]
        ax.annotate(layout, (x, y), (-5.0, -4.0), textcoords="offset points", ha="right", va="top", fontsize="small")


def _fixed_values(found: StudySearch, layout: str, names: list[str]) -> list[float]:
    """Indices of a layout without a free network at its best design in the first of them."""
    own = next(each for each in found.fixed if each.layout == layout and each.index == names[0])
    values = own.feasible_values(found.study.evaluate[0])
    return [values.get(name, nan) for name in names]


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
        title = f"{format_count(network.n_elements, 'elements')}: {typeset_quantity(network.value, network.unit)}"
        struts = [strut for strut in network.design.mechanism().struts if strut.name in mounts]
        for strut in struts:
            yield (title if len(struts) == 1 else f"{title}\n{in_words(strut.name)}"), strut.network
