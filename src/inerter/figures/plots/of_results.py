"""Sweeps and maps of the results of a study."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.axes import Axes

from inerter.errors import StudyError
from inerter.figures.labels import compared_layouts, indices, layouts, one_method, swept_places
from inerter.figures.maps import index_maps
from inerter.figures.style import new_figure, style_context
from inerter.figures.sweeps import sweep_curves
from inerter.formatting import format_list
from inerter.validation import checked


@checked(StudyError)
def plot_sweep(results: xr.Dataset, index: str, *, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Best values of an index over the swept number, and the improvements over the baseline if there is one.

    `results` is the dataset of a study, as `results.nc` has it; the two plots are on an axis each.

    Raises `StudyError` if not one number is swept, the index is not there, or the number of axes is another.

    >>> import inerter as it
    >>> study = '''
    ... [vehicle]
    ... model = "quarter-car"
    ... sprung_mass = "250 kg"
    ... unsprung_mass = "35 kg"
    ... tyre_stiffness = "150 kN/m"
    ... [road]
    ... class = "B"
    ... speed = "80 km/h"
    ... [elements]
    ... k = "60 kN/m"
    ... c = "2 kN s/m"
    ... [layouts]
    ... S1 = "k | c"
    ... [study]
    ... indices = ["J1"]
    ... evaluate = ["norm"]
    ... sweep = { c = ["1 kN s/m", "2 kN s/m", "4 kN s/m"] }
    ... '''
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as name:
    ...     _ = Path(name, "damping.toml").write_text(study)
    ...     results = it.run_study(it.load_study(Path(name, "damping.toml")), Path(name, "results")).data
    >>> [ax] = it.plot_sweep(results, "J1")
    >>> [float(c) for c in ax.lines[0].get_xdata()]
    [1.0, 2.0, 4.0]
    """
    _check(results, index, 1, "a sweep", "one swept number")
    count = 2 if compared_layouts(results) else 1
    with style_context():
        return list(sweep_curves(results, index, _axes(axes, count, columns=count)))


@checked(StudyError)
def plot_map(results: xr.Dataset, index: str, *, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Values of an index over two swept numbers: of the baseline itself, of other layouts as improvements over it.

    `results` is the dataset of a study, as `results.nc` has it; each layout is on axes of its own.

    Raises `StudyError` if not two numbers are swept, the index is not there, or the number of axes is another.

    >>> import inerter as it
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> study = '''
    ... vehicle = {model = "quarter-car", sprung_mass = "250 kg", unsprung_mass = "35 kg", tyre_stiffness = "180 kN/m"}
    ... road = {speed = "25 m/s", class = "B"}
    ... elements = {k = "60 kN/m", c = "2 kN s/m"}
    ... layouts = {S1 = "k | c"}
    ... [study]
    ... indices = ["J1"]
    ... evaluate = ["norm"]
    ... sweep = {k = ["40 kN/m", "60 kN/m"], c = ["1 kN s/m", "2 kN s/m"]}
    ... '''
    >>> with TemporaryDirectory() as name:
    ...     _ = Path(name, "values.toml").write_text(study)
    ...     results = it.run_study(it.load_study(Path(name, "values.toml")), Path(name, "results")).data
    >>> len(it.plot_map(results, "J1"))  # axes, one for each layout
    1
    """
    _check(results, index, 2, "a map", "two swept numbers")
    count = len(layouts(results))
    with style_context():
        return list(index_maps(one_method(results), index, _axes(axes, count, columns=min(count, 3))))


def _check(results: xr.Dataset, index: str, swept: int, what: str, expected: str) -> None:
    if (count := len(swept_places(results))) != swept:
        raise StudyError(f"A plot of {what} needs results with {expected}, got {count}.")
    if index not in (known := indices(results)):
        raise StudyError(f"These results have no index {index!r}, but {format_list(known)}.")


def _axes(axes: Sequence[Axes] | None, count: int, columns: int) -> Sequence[Axes]:
    found = list(axes) if axes is not None else new_figure(count, columns, height=2.9)[1]
    if len(found) != count:
        raise StudyError(f"These results need {count} axes, got {len(found)}.")
    return found
