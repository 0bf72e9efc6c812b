"""All figures of a study, with their captions and files."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from inerter.figures.designs import WORST, frequency_responses, improvement_bars, improvement_by_method, upright_names
from inerter.figures.fronts import front_curves, pairs
from inerter.figures.labels import (
    NOTICEABLE,
    WIDE_RANGE,
    by_which,
    compared_layouts,
    criteria,
    held_back,
    index_words,
    indices,
    infeasible,
    layouts,
    method_label,
    methods,
    one_method,
    swept_places,
    swept_words,
)
from inerter.figures.maps import index_maps, parameter_maps, parameter_panels
from inerter.figures.style import add_legend, file_stems, new_figure, save, style_context
from inerter.figures.sweeps import markers_shown, parameter_curves, sweep_curves
from inerter.formatting import format_list, format_number, in_words

_STILL = 1e-12  # of the largest gain of an index; less is rounding
_MOST_MAPS = 3  # side by side
_MOST_ENTRIES = 9  # of a legend below a figure of the usual height


@dataclass(frozen=True)
class StudyFigure:
    """Figure of a study: file name, caption, number of panels with what draws on them, and height of a row [inch]."""

    name: str
    caption: str
    panels: int
    curves: Callable[[Sequence[Axes]], object]
    height: float = 2.9
    columns: int | None = None  # all panels side by side if left out
    has_legend: bool = True

    def draw(self) -> Figure:
        """The figure, drawn."""
        figure, axes = new_figure(self.panels, self.columns or self.panels, height=self.height)
        self.curves(axes)
        if self.has_legend:
            add_legend(figure, axes)
        return figure


def study_figures(results: xr.Dataset) -> list[StudyFigure]:
    """All figures of a study, in the order of a report. Nothing is drawn yet."""
    found = list((_of_designs, _of_sweep, _of_map)[len(swept_places(results))](results))
    stems = file_stems(one.name for one in found)
    return [replace(one, name=stems[one.name]) for one in found]


def draw_study(results: xr.Dataset, folder: Path) -> list[Path]:
    """Write all figures of a study into `folder`, each as SVG and as PNG; returns the files."""
    with style_context():
        return [path for figure in study_figures(results) for path in save(figure.draw(), folder, figure.name)]


def _of_designs(results: xr.Dataset) -> Iterator[StudyFigure]:
    baseline, every, results = results.attrs["baseline"], results, one_method(results)
    several = len(methods(every)) > 1
    if compared_layouts(results) and bool(np.isfinite(results["value"].sel(layout=compared_layouts(results))).any()):
        yield StudyFigure(
            "improvement",
            f"Improvement over {baseline}, each layout with its own best design for each index"
            + f"{by_which(results)}."
            + _uncertain(results, " Bars with caps: one standard error.")
            + (" Bars with a triangle are cut." if _any(_cut(results)) else ""),
            1,
            lambda axes: improvement_bars(results, axes[0]),
            2.9 if len(compared_layouts(results)) <= 5 else 3.6,
        )
    names = compared_layouts(results)
    if names and several:
        yield StudyFigure(
            "methods",
            f"Improvement over {baseline} by each method."
            + _uncertain(every, " Bars with caps: one standard error.")
            + (f" Triangles: below {format_number(WORST)} %." if _any(_cut(every)) else ""),
            results.sizes["index"],
            partial(improvement_by_method, every),
            2.9 + (0.06 * max(map(len, names)) if upright_names(names) else 0.0),
        )
    if criteria(every) and bool(np.isfinite(every["front_value"]).any()):
        yield StudyFigure(
            "front",
            f"{every['front_value'].attrs.get('title', 'Trade-off')}: along a front an index improves only as "
            f"{'the other' if len(criteria(every)) == 2 else 'another'} gets worse. Large open markers: the knee, "
            "beyond which a small gain costs much."
            + (" Gaps: the front continues with another kind of design." if bool(every["front_jump"].any()) else ""),
            len(pairs(every)),
            partial(front_curves, every),
            3.6 if len(pairs(every)) == 1 else 2.9,
        )
    linear = "Linear frequency response" if "realisations" in results else "Frequency response"
    for index in indices(results):
        if f"gain_{index}" in results:
            excited = results.isel({f"output_{index}": _has_response(results, index)})
            outputs = excited.sizes[f"output_{index}"]
            yield StudyFigure(
                f"response-{index}",
                f"{linear} of the designs that are best for {index_words(results, index)}."
                + _still(results, index)
                + _nearest(results.sel(index=index), "Of a layout without a feasible design, that"),
                outputs,
                partial(frequency_responses, excited, index),
                3.0,
                min(outputs, 2),
            )


def _of_sweep(results: xr.Dataset) -> Iterator[StudyFigure]:
    (element,), baseline = swept_words(results), results.attrs["baseline"]
    names, parameters = methods(results), results.sizes["parameter"]
    is_crowded = len(names) > 1 and len(names) + len(layouts(results)) > _MOST_ENTRIES
    for index in indices(results):
        here = results.sel(index=index)
        title = index_words(results, index)
        versus = (
            f", and improvement over the best {baseline} of the same {element}" if compared_layouts(results) else ""
        )
        yield StudyFigure(
            f"sweep-{index}",
            f"Best {title} for each value of {element}{versus}."
            + _uncertain(results, " Bands: one standard error to both sides.")
            + (f" Below {format_number(WORST)} % the curves are cut." if _any(_cut(here)) else "")
            + _limits(here, "Open markers" if markers_shown(results) else "", "No curve"),
            2 if compared_layouts(results) else 1,
            partial(sweep_curves, results, index),
            3.4 if is_crowded else 2.9,
        )
        if parameters:
            at_bound, flat = here["at_bound"], here["parameter_high"] > WIDE_RANGE * here["parameter_low"]
            yield StudyFigure(
                f"parameters-{index}",
                f"Parameters that are best for {title} for each value of {element}."
                + (" Open markers: at a bound." if markers_shown(results) and _any(at_bound != "") else "")
                + (" Bands: equally good designs." if _any(flat) else "")
                + _nearest(here, "Without a feasible design, those"),
                parameters,
                partial(parameter_curves, results, index),
                2.6,
                parameters if parameters <= 3 else 2,
            )


def _of_map(results: xr.Dataset) -> Iterator[StudyFigure]:
    words, every, results = " and ".join(swept_words(results)), results, one_method(results)
    baseline, others = results.attrs["baseline"], " and ".join(method_label(every, name) for name in methods(every)[1:])
    for index in indices(results):
        here = results.sel(index=index)
        title = index_words(results, index)
        versus = f" of {baseline}, and improvement over it of every other layout" if compared_layouts(results) else ""
        yield StudyFigure(
            f"map-{index}",
            f"Best {title}{versus}, over {words}{by_which(results)}."
            + (f" Heavy line: as good as {baseline}." if _crosses(here) else "")
            + " Dots: the designs that were found; between them the map is interpolated."
            + _limits(here, "Black dots", "Grey")
            + (" Grey: no finite value." if _any(~np.isfinite(here["value"]) & ~infeasible(here)) else "")
            + (f" The values {others} are in summary.csv." if others else ""),
            results.sizes["layout"],
            partial(index_maps, results, index),
            2.7,
            min(results.sizes["layout"], _MOST_MAPS),
            has_legend=False,
        )
        for parameter in results["parameter"].values.tolist():
            if shown := len(parameter_panels(results, index, parameter)):
                yield StudyFigure(
                    f"map-{parameter}-{index}",
                    f"Best {parameter} for {title}, over {words}."
                    + (" Open circles: at a bound." if _any(here["at_bound"].sel(parameter=parameter) != "") else "")
                    + _limits(here, "Black dots", "")
                    + _nearest(here, "Without a feasible design, that"),
                    shown,
                    partial(parameter_maps, results, index, parameter),
                    2.7,
                    min(shown, _MOST_MAPS),
                    has_legend=False,
                )


def _limits(here: xr.Dataset, held: str, missed: str) -> str:
    """Sentences on the markers of designs with active constraints and of infeasible ones, if any."""
    told = [
        (held, "active constraint", held_back(here)),
        (missed, "no feasible design", infeasible(here)),
    ]
    return "".join(f" {mark}: {meaning}." for mark, meaning, where in told if mark and _any(where))


def _nearest(here: xr.Dataset, what: str) -> str:
    return f" {what} of the closest design." if _any(infeasible(here)) else ""


def _cut(results: xr.Dataset) -> xr.DataArray:
    """Improvements that are too bad for a figure, but numbers."""
    return (results["improvement"] < WORST) & np.isfinite(results["improvement"])


def _crosses(here: xr.Dataset) -> bool:
    """Whether a layout of a map is better than the baseline at some points and worse at others."""
    rows = (here["improvement"].sel(layout=name).values for name in compared_layouts(here))
    return any(_any(row < -NOTICEABLE) and _any(row > NOTICEABLE) for row in rows)


def _any(where: ArrayLike) -> bool:
    return bool(np.any(where))


def _uncertain(results: xr.Dataset, sentence: str) -> str:
    """Sentence on standard errors if any is visible; else empty."""
    return sentence if "improvement_error" in results and bool((results["improvement_error"] > 0.0).any()) else ""


def _has_response(results: xr.Dataset, index: str) -> NDArray[np.bool_]:
    """True for each output of an index with a nonzero response; roll has none where both tracks are equal."""
    gain = results[f"gain_{index}"]
    most = np.asarray(gain.max([name for name in gain.dims if name != f"output_{index}"]).fillna(0.0).values)
    return np.asarray(most > _STILL * most.max(initial=0.0)) | (not most.any())


def _still(results: xr.Dataset, index: str) -> str:
    """A sentence on the outputs that a figure leaves out."""
    names = results[f"output_{index}"].values[~_has_response(results, index)].tolist()
    return f" Not excited, and not shown: {format_list([in_words(name) for name in names])}." if names else ""
