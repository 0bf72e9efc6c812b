"""Kinds of plots by their keys, as `inerter plot` draws them: of designs, of a simulated motion, of results."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from inerter.errors import DesignError, StudyError
from inerter.figures.plots.admittance import plot_admittance
from inerter.figures.plots.bode import plot_bode
from inerter.figures.plots.network import plot_network
from inerter.figures.plots.nyquist import plot_nyquist
from inerter.figures.plots.poles import plot_poles
from inerter.figures.plots.responses import Response
from inerter.figures.plots.step_response import plot_step_response
from inerter.figures.plots.trajectory import plot_loop, plot_trajectory
from inerter.figures.study import study_figures
from inerter.formatting import format_list
from inerter.indices.definition import Index
from inerter.networks.elements.algebra import Network
from inerter.registry import Registry
from inerter.simulation.trajectory import Trajectory
from inerter.vehicle.vehicle import Vehicle


class PlotSource(Enum):
    """Subject of a plot, with the file that has it."""

    DESIGNS = "a study file, or a folder with its results"
    MOTION = "a simulation file, or a folder with its results"
    RESULTS = "a folder with the results of a study"


@dataclass(frozen=True)
class DesignsToPlot:
    """Designs by their names, and the response that is drawn: that of an index, or from an input to an output."""

    vehicles: Mapping[str, Vehicle]
    index: Index
    input: str | None = None
    outputs: tuple[str, ...] = ()

    @property
    def response(self) -> Response:
        """Response of the index, or between the names that are given."""
        return self.names if self.input or self.outputs else self.index

    @property
    def names(self) -> tuple[str, str]:
        """Input and output, those of the index where none is given; raises `DesignError` where it has several."""
        mechanism = next(iter(self.vehicles.values())).mechanism()
        definition = self.index.definition(mechanism)
        inputs = list(dict.fromkeys(path.input for path in definition.drive.input_paths(mechanism)))
        outputs = [weighted.output for weighted in definition.outputs]
        return (
            self.input or _only(inputs, "inputs", "--input", self.index),
            _only(list(self.outputs) or outputs, "outputs", "--only", self.index),
        )

    @property
    def networks(self) -> dict[str, Network]:
        """Network of each strut, by the names of design and strut."""
        found = {name: vehicle.mechanism().struts for name, vehicle in self.vehicles.items()}
        return {
            name if len(struts) == 1 else f"{name} {strut.name}": strut.network
            for name, struts in found.items()
            for strut in struts
        }


@dataclass(frozen=True)
class MotionToPlot:
    """A simulated motion, the outputs that are drawn, and the time [s] from and to which."""

    run: Trajectory
    outputs: tuple[str, ...]
    window: tuple[float, float] | None = None


@dataclass(frozen=True)
class ResultsToPlot:
    """Results of a study, and the index that is drawn."""

    data: xr.Dataset
    index: str | None = None


@dataclass(frozen=True)
class PlotKind:
    """A kind of plot: `draw` makes the figure of what `of` says."""

    key: str
    description: str
    of: PlotSource
    draw: Callable[[Any], Figure]


def _only(names: list[str], what: str, option: str, index: Index) -> str:
    if len(names) != 1:
        raise DesignError(f"{index.symbol} has several {what}: {format_list(names)}. Choose one with {option}.")
    return names[0]


def _loop(motion: MotionToPlot) -> Figure:
    if len(motion.outputs) != 2:
        raise StudyError(
            "A loop is one output over another. Name both, with --only ACROSS --only UP, such as "
            "--only strut_travel --only strut_force."
        )
    return _figure(plot_loop(motion.run, *motion.outputs, window=motion.window))


def _figure_of_results(key: str) -> Callable[[ResultsToPlot], Figure]:
    """Draws the figure of that name, of one index where there is one for each."""

    def draw(results: ResultsToPlot) -> Figure:
        every = {figure.name: figure for figure in study_figures(results.data)}
        names = [name for name in every if name == key or name.startswith(f"{key}-")]
        wanted = [name for name in names if results.index is None or name in (key, f"{key}-{results.index}")]
        if len(wanted) == 1:
            return every[wanted[0]].draw()
        if wanted:
            has = format_list([name.removeprefix(f"{key}-") for name in names])
            raise StudyError(f"These results have a plot of the kind {key} for each of {has}. Choose one with --index.")
        drawn = format_list([name for name in PLOTS if any(each.partition("-")[0] == name for each in every)])
        of = f" of {results.index}" if names else ""
        raise StudyError(f"These results have no plot of the kind {key}{of}; they have {drawn or 'none'}.")

    return draw


def _figure(axes: Any) -> Figure:
    figure = axes.figure
    assert isinstance(figure, Figure)
    return figure


PLOTS: Registry[PlotKind] = Registry(
    "kind of plot",
    "key",
    ("description", "of", "draw"),
    (
        PlotKind(
            "bode",
            "gain and phase over frequency",
            PlotSource.DESIGNS,
            lambda designs: _figure(plot_bode(designs.vehicles, designs.response)[0]),
        ),
        PlotKind(
            "nyquist",
            "response in the complex plane",
            PlotSource.DESIGNS,
            lambda designs: _figure(plot_nyquist(designs.vehicles, designs.response)),
        ),
        PlotKind(
            "poles",
            "poles in the complex plane",
            PlotSource.DESIGNS,
            lambda designs: _figure(plot_poles(designs.vehicles)),
        ),
        PlotKind(
            "step",
            "response to a unit step over time",
            PlotSource.DESIGNS,
            lambda designs: _figure(plot_step_response(designs.vehicles, designs.names)),
        ),
        PlotKind(
            "admittance",
            "admittance of the struts over frequency",
            PlotSource.DESIGNS,
            lambda designs: _figure(plot_admittance(designs.networks)[0]),
        ),
        PlotKind(
            "network",
            "drawing of the struts with their values",
            PlotSource.DESIGNS,
            lambda designs: plot_network(designs.networks, values=True),
        ),
        PlotKind(
            "trajectory",
            "outputs over time, shaded where friction sticks and gaps are open",
            PlotSource.MOTION,
            lambda motion: _figure(plot_trajectory(motion.run, motion.outputs, window=motion.window)[0]),
        ),
        PlotKind("loop", "one output over another, such as force over travel", PlotSource.MOTION, _loop),
        PlotKind(
            "improvement", "improvements over the baseline", PlotSource.RESULTS, _figure_of_results("improvement")
        ),
        PlotKind("front", "Pareto fronts", PlotSource.RESULTS, _figure_of_results("front")),
        PlotKind("sweep", "best values over a swept number", PlotSource.RESULTS, _figure_of_results("sweep")),
        PlotKind("map", "best values over two swept numbers", PlotSource.RESULTS, _figure_of_results("map")),
    ),
)
