"""Implementation of `inerter plot`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from inerter.cli.interrupts import interruptible
from inerter.cli.progress import fraction
from inerter.cli.reading import time_interval
from inerter.cli.streams import say
from inerter.errors import StudyError
from inerter.figures.plots.kinds import PLOTS, DesignsToPlot, MotionToPlot, PlotKind, PlotSource, ResultsToPlot
from inerter.figures.style import style_context
from inerter.files.common.folder import check_single, single
from inerter.files.common.suggest import missing_kind, some
from inerter.files.simulation import running as simulations
from inerter.files.simulation.loading import load_simulation
from inerter.files.study.chosen_design import CHOOSE_ONE, WITHOUT_CONDITIONS, chosen_designs, load_results
from inerter.files.study.running import DATASET

_BY = "plot"
_SUFFIXES = (".svg", ".pdf", ".png")


@dataclass(frozen=True)
class PlotOptions:
    """Options of the command; those that a kind does not use are refused."""

    layout: tuple[str, ...] = ()
    index: str | None = None
    point: int | None = None
    condition: str | None = None
    input: str | None = None
    only: tuple[str, ...] = ()
    window: str | None = None

    def check(self, kind: PlotKind) -> None:
        """Raises `StudyError` for an option that a kind of plot does not use."""
        given = [name for name, value in vars(self).items() if value not in (None, ())]
        if unused := [f"--{name}" for name in given if name not in _USED[kind.of]]:
            used = some([f"--{name}" for name in _USED[kind.of]])
            raise StudyError(f"A plot of the kind {kind.key} does not use {some(unused)}; it uses {used}.")


_USED: Mapping[PlotSource, tuple[str, ...]] = {
    PlotSource.DESIGNS: ("layout", "index", "point", "condition", "input", "only"),
    PlotSource.MOTION: ("only", "window"),
    PlotSource.RESULTS: ("index",),
}


def plot(source: Path, kind: str | None, options: PlotOptions, output: Path | None, *, force: bool) -> None:
    """Plot designs, a motion or results into a file.

    Raises `StudyError` for a missing or unknown kind, for an unknown suffix, for an option that the kind does not use,
    and for a source that has nothing of the kind; what the plot raises.
    """
    if kind is None:
        raise StudyError(missing_kind("--kind", "plots", {key: row.description for key, row in PLOTS.items()}))
    row = PLOTS[kind]
    options.check(row)
    stem = source.stem if source.is_file() else source.resolve().name
    path = output or Path(f"{stem}-{kind}.svg")
    if path.suffix.lower() not in _SUFFIXES:
        raise StudyError(f"{path}: a plot is a file with the suffix {some(list(_SUFFIXES))}.")
    check_single(path, by=_BY, inputs=(), force=force)
    load = {PlotSource.DESIGNS: _designs, PlotSource.MOTION: _motion, PlotSource.RESULTS: _results}[row.of]
    with interruptible():
        content, inputs = load(source, options)
        with style_context():
            figure = row.draw(content)
            with single(path, by=_BY, inputs=inputs, force=force) as draft:
                figure.savefig(draft, dpi=200)
    say(f"{row.description}: {path}")


def _designs(source: Path, options: PlotOptions) -> tuple[DesignsToPlot, tuple[Path, ...]]:
    """The layouts that were named, or all, with their best values for an index."""
    chosen = chosen_designs(source, options.layout, options.index, options.point, options.condition)
    first = next(iter(chosen.values()))
    vehicles = {name: design.vehicle() for name, design in chosen.items()}
    if first.study.conditions and options.condition is None:
        say(f"{WITHOUT_CONDITIONS}; {CHOOSE_ONE}")
    return DesignsToPlot(vehicles, first.index, options.input, options.only), first.inputs


def _motion(source: Path, options: PlotOptions) -> tuple[MotionToPlot, tuple[Path, ...]]:
    """The motion of a simulation file, simulated again where it is that of a folder of results."""
    request = load_simulation(source / simulations.RESOLVED if source.is_dir() else source)
    begin, end = time_interval("--window", options.window or ":")
    with fraction("simulation") as callback:
        result = simulations.SimulationResult(request, request.run(callback))
    time = result.run.time
    window = (time[0] if begin is None else begin, time[-1] if end is None else end)
    return MotionToPlot(result.run, options.only or result.main_outputs, window), request.inputs


def _results(source: Path, options: PlotOptions) -> tuple[ResultsToPlot, tuple[Path, ...]]:
    if not source.is_dir():
        raise StudyError(f"{source}: expected {PlotSource.RESULTS.value}. Run the study: inerter run {source}")
    return ResultsToPlot(load_results(source), options.index), (source / DATASET,)
