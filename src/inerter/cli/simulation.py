"""Implementation of `inerter simulate`."""

from __future__ import annotations

import json
import math
from pathlib import Path

from inerter.cli.interrupts import interruptible
from inerter.cli.progress import fraction
from inerter.cli.streams import say
from inerter.errors import StudyError
from inerter.figures.simulation import Window, draw_simulation, readable_window
from inerter.files.common.folder import FIGURES
from inerter.files.simulation.loading import load_simulation
from inerter.files.simulation.request import SimulationRequest
from inerter.files.simulation.running import SimulationResult, run_simulation
from inerter.formatting import format_number, format_quantity
from inerter.report.simulation import simulation_data, simulation_text
from inerter.statements import Statement


def simulate(
    file: Path, output: Path | None, window: str | None, *, force: bool, as_json: bool
) -> tuple[Statement, ...]:
    """Run a simulation file into a folder; returns its status."""
    request = load_simulation(file)
    wanted = None if window is None else _window(window, request)
    folder = output or Path(f"{file.stem}-results")

    def draw(result: SimulationResult, into: Path) -> None:
        if (shown := _figure_window(result, wanted)) is not None:
            draw_simulation(result, into / FIGURES, shown)

    with interruptible(), fraction("simulation") as callback:
        result = run_simulation(request, folder, force=force, progress=callback, finish=draw)
    shown = _figure_window(result, wanted)
    print(json.dumps(simulation_data(result), indent=2) if as_json else simulation_text(result, shown))
    say(f"results: {folder}")
    if not result.run.status.ok:
        say(f"{file.name}: {result.run.status}")
    return (result.run.status,)


def _figure_window(result: SimulationResult, wanted: Window | None) -> Window | None:
    """Time window of the figure; None for a motion of fewer than two samples."""
    if result.run.time.size < 2:
        return None
    return wanted if wanted and wanted[0] < result.run.time[-2] else readable_window(result)


def _window(text: str, request: SimulationRequest) -> Window:
    begin, _, end = text.partition(":")
    length, sample = request.length or math.inf, request.step * request.every
    try:
        window = max(float(begin), 0.0), min(float(end), length)
    except ValueError:
        window = (math.nan, math.nan)
    if not window[1] - window[0] >= 2.0 * sample:
        raise StudyError(
            f"--window is FROM:TO in seconds, at least two samples within the {format_quantity(length, 's', 6)} of the "
            f"simulation, such as --window 0:{format_number(length)}; got {text!r}."
        )
    return window
