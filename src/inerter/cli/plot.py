"""Implementation of `inerter plot`."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from matplotlib.figure import Figure

from inerter.cli.interrupts import interruptible
from inerter.errors import StudyError
from inerter.figures.plots import plot_admittance, plot_bode, plot_network, plot_nyquist, plot_poles
from inerter.figures.style import style_context
from inerter.files.common.folder import check_single, single
from inerter.files.common.suggest import some
from inerter.files.study.chosen_design import ChosenDesign, chosen_design
from inerter.files.study.loading import load_study
from inerter.files.study.running import RESOLVED
from inerter.indices.definition import Index
from inerter.networks.elements.algebra import Network
from inerter.vehicle.vehicle import Vehicle

_BY = "plot"
_SUFFIXES = (".svg", ".pdf", ".png")

Designs = Mapping[str, Vehicle]

PLOTS: Mapping[str, Callable[[Designs, Index], Figure]] = {
    "bode": lambda designs, index: _of(plot_bode(designs, index)[0].figure),
    "nyquist": lambda designs, index: _of(plot_nyquist(designs, index).figure),
    "poles": lambda designs, index: _of(plot_poles(designs).figure),
    "admittance": lambda designs, index: _of(plot_admittance(_networks(designs))[0].figure),
    "network": lambda designs, index: plot_network(_networks(designs), values=True),
}


def plot(
    source: Path,
    kind: str,
    layouts: tuple[str, ...],
    index: str | None,
    point: int | None,
    output: Path | None,
    *,
    force: bool,
) -> None:
    """Plot designs of a study file or of a folder of results into a file.

    Raises `StudyError` for an unknown kind or suffix, and as `chosen_design`; what the plot raises.
    """
    if kind not in PLOTS:
        raise StudyError(f"Unknown kind of plot {kind!r}; expected {some(list(PLOTS))}.")
    stem = source.stem if source.is_file() else source.resolve().name
    path = output or Path(f"{stem}-{kind}.svg")
    if path.suffix.lower() not in _SUFFIXES:
        raise StudyError(f"{path}: a plot is a file with the suffix {some(list(_SUFFIXES))}.")
    if not path.parent.is_dir():
        raise StudyError(f"{path.parent}: folder not found. Create it, or choose another with -o.")
    check_single(path, by=_BY, inputs=(), force=force)
    with interruptible():
        chosen = _designs(source, layouts, index, point)
        inputs = next(iter(chosen.values())).inputs
        one = next(iter(chosen.values()))
        vehicles = {name: design.vehicle() for name, design in chosen.items()}
        figure = PLOTS[kind](vehicles, one.study.index(one.case.index))
        with single(path, by=_BY, inputs=inputs, force=force) as draft, style_context():
            figure.savefig(draft, dpi=200)
    print(f"inerter: plot of {', '.join(chosen)}: {path}", file=sys.stderr)


def _designs(source: Path, layouts: tuple[str, ...], index: str | None, point: int | None) -> dict[str, ChosenDesign]:
    """The layouts that were named, or all, with their best values for an index."""
    known = list(load_study(source / RESOLVED if source.is_dir() else source).layouts)
    return {layout: chosen_design(source, layout, index, point) for layout in layouts or known}


def _networks(designs: Designs) -> dict[str, Network]:
    """The network of each strut, by the names of layout and strut."""
    found = {name: vehicle.mechanism().struts for name, vehicle in designs.items()}
    return {
        name if len(struts) == 1 else f"{name} {strut.name}": strut.network
        for name, struts in found.items()
        for strut in struts
    }


def _of(figure: object) -> Figure:
    assert isinstance(figure, Figure)
    return figure
