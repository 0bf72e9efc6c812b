"""The answer of a study in a sentence for each index."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import scipy

from inerter.errors import Status, StatusKind
from inerter.figures.labels import (
    NOTICEABLE,
    by_method,
    by_which,
    compared_layouts,
    index_title,
    index_unit,
    indices,
    infeasible,
    layouts,
    method_label,
    methods,
    one_method,
    swept_element,
    swept_places,
    swept_text,
    swept_words,
)
from inerter.formatting import format_list, format_percent_size, format_quantity
from inerter.indices.names import title_with_name
from inerter.indices.registry import INDICES
from inerter.methods.registry import with_decisive_method
from inerter.methods.ties import equally_least

if TYPE_CHECKING:
    import xarray as xr


_UNSURE = StatusKind.INACCURATE.value
_MOST_PLACES = 20  # at which a layout crosses the baseline, in a sentence


def sweep_headlines(results: xr.Dataset) -> list[str]:
    """Sentences on a sweep, one per index: best layout, its value, and its improvement over the baseline."""
    return [f"{_doubt(results, index)}{_sweep_headline(results, index)}" for index in indices(results)]


def _doubt(results: xr.Dataset, index: str) -> str:
    """Sentence on uncertain values that the answer compares, with cause and deciding method; empty if all are certain.

    A value that is not there is compared with nothing.
    """
    statuses = results["status"].sel(index=index)
    texts = {name: np.atleast_1d(statuses.sel(layout=name).values).ravel().tolist() for name in layouts(results)}
    unsure = {
        name: own for name, several in texts.items() if (own := [t for t in several if Status.parts(t)[0] == _UNSURE])
    }
    if not unsure:
        return ""
    _, message = Status.parts(next(iter(unsure.values()))[0])
    many = len(next(iter(texts.values())))
    of = [f"{name} at {len(own)} of {many} points" if many > 1 else name for name, own in unsure.items()]
    if len(methods(results)) == 1:
        message = with_decisive_method(Status(StatusKind.INACCURATE, message), methods(results)[0]).message
    return f"Not certain ({_UNSURE}: {format_list(of)}, {message.rstrip('.')}). "


def _simplest_first(results: xr.Dataset, names: list[str]) -> list[str]:
    """Layouts sorted by number of elements, otherwise in the given order."""
    if "elements" not in results.coords:
        return names
    return sorted(names, key=lambda name: int(results["elements"].sel(layout=name)))


def _format_equal_layouts(names: list[str]) -> str:
    return f"{format_list(names)}, equally good" if len(names) > 1 else names[0]


Extreme = tuple[float, dict[str, float]]  # a number, and the swept values where it is


def extremes(row: xr.DataArray) -> tuple[Extreme, Extreme] | None:
    """The least and the largest finite number over the swept places; None if none is finite."""
    numbers = row.values.ravel()
    finite = np.flatnonzero(np.isfinite(numbers))
    if not finite.size:
        return None

    def extreme(number: int) -> Extreme:
        place = np.unravel_index(number, row.shape)
        return float(numbers[number]), {str(d): float(row[d].values[i]) for d, i in zip(row.dims, place, strict=True)}

    return extreme(finite[np.argmin(numbers[finite])]), extreme(finite[np.argmax(numbers[finite])])


def is_compared(results: xr.Dataset, index: str) -> bool:
    """Whether some layout has an improvement over the baseline: at some place, both have a value."""
    others = compared_layouts(results)
    return bool(np.isfinite(results["improvement"].sel(layout=others, index=index)).any())


def place_text(results: xr.Dataset, place: dict[str, float], *, named: bool = False) -> str:
    """Swept values with their units, and with their names if `named`, as text."""
    texts = []
    for name, value in place.items():
        text = swept_text(results, name, value)
        texts.append(f"{results[name].attrs['long_name']} = {text}" if named else text)
    return ", ".join(texts) or "n/a"


def crossings(results: xr.Dataset, index: str, layout: str) -> list[tuple[float, float]]:
    """Swept values at which a layout is as good as the baseline, each with its standard error.

    Between swept values the improvement follows a monotone cubic; how far a straight line would put the crossing from
    there is added to the error. Where both are equal over more than one value, there is no crossing.
    """
    element = str(swept_element(results))
    row = results.sel(layout=layout, index=index).sortby(element)
    swept, better = row[element].values, row["improvement"].values
    errors = row["improvement_error"].values if "improvement_error" in row else np.zeros(better.size)
    told = np.flatnonzero(np.isfinite(better) & (np.abs(better) >= NOTICEABLE))
    if told.size < 2:
        return []
    curve, found = scipy.interpolate.PchipInterpolator(swept[told], better[told]), []
    for i, j in pairwise(told.tolist()):
        if j - i <= 2 and better[i] * better[j] < 0.0:
            at = float(scipy.optimize.brentq(lambda place: float(curve(place)), swept[i], swept[j]))
            part = (at - swept[i]) / (swept[j] - swept[i])
            error = np.nan_to_num((1.0 - part) * errors[i] + part * errors[j]) / abs(float(curve(at, 1)))
            straight = swept[i] + better[i] / (better[i] - better[j]) * (swept[j] - swept[i])
            found.append((at, float(np.hypot(error, at - straight))))
    return found


def over_the_sweep(results: xr.Dataset) -> list[tuple[str, str]]:
    """Pairs of index and sentence on where each layout outperforms the baseline: crossings, or shares of a map."""
    return crossing_sentences(results) if len(swept_places(results)) == 1 else _map_share_sentences(results)


def _map_share_sentences(results: xr.Dataset) -> list[tuple[str, str]]:
    """Pairs of index and sentence on the number of points of a map at which each layout outperforms the baseline."""
    sentences = []
    for index in indices(results):
        for name in compared_layouts(results):
            better = one_method(results)["improvement"].sel(layout=name, index=index).values
            counts = {
                "better than": int((better >= NOTICEABLE).sum()),
                "as good as": int((np.abs(better) < NOTICEABLE).sum()),
                "worse than": int((better <= -NOTICEABLE).sum()),
            }
            told = [f"{words} {results.attrs['baseline']} at {count}" for words, count in counts.items() if count]
            if told:
                sentences.append((index, f"{name} is {format_list(told)} of {better.size} points{by_which(results)}"))
    return sentences


def crossing_sentences(results: xr.Dataset) -> list[tuple[str, str]]:
    """Pairs of index and sentence on where each layout crosses the baseline, for a study with one sweep."""
    element, baseline = str(swept_element(results)), results.attrs["baseline"]
    words = results[element].attrs["long_name"]
    several = len(methods(results)) > 1
    method_labels = (
        {f" {method_label(results, m)}": by_method(results, m) for m in methods(results)}
        if several
        else {"": one_method(results)}
    )
    sentences = []
    for index in indices(results):
        for name in compared_layouts(results):
            found = {by: crossings(one, index, name) for by, one in method_labels.items()}
            texts = [_format_places(results, places) + by for by, places in found.items() if places]
            if texts:
                said = f"{name} and {baseline} are equally good at {words} = {', '.join(texts)}"
                sentences.append((index, said))
    return sentences


def _format_places(results: xr.Dataset, found: list[tuple[float, float]]) -> str:
    """Swept values with their errors as text; of many, the first and the number of others."""
    more, element = len(found) - _MOST_PLACES, str(swept_element(results))
    texts = [swept_text(results, element, at, error) for at, error in found[:_MOST_PLACES]]
    return format_list([*texts, *([f"{more} other values"] if more > 0 else [])])


def _index_label(results: xr.Dataset, index: str) -> str:
    """Title of an index, with its name if it is user-defined."""
    title = index_title(results, index)
    return title if index in INDICES else title_with_name(title, index)


def _sweep_headline(every: xr.Dataset, index: str) -> str:
    results = one_method(every)
    words = next((method_label(every, method) for method in methods(every)), "")
    by = f", {words}" if words else ""
    swept, title, baseline = swept_words(results), _index_label(results, index), results.attrs["baseline"]
    versus = is_compared(results, index)
    names_there = compared_layouts(results) if versus else layouts(results)
    rows = results["improvement" if versus else "value"].sel(index=index)
    found = {name: ends for name in names_there if (ends := extremes(rows.sel(layout=name))) is not None}
    if not found:
        return f"Best {title}: {_no_best_clause(results, index)}."
    if not versus:
        least_of_all = [ends[0][0] for ends in found.values()]
        names = _simplest_first(results, [list(found)[i] for i in equally_least(least_of_all)])
        value, at = found[names[0]][0]
        text = format_quantity(value, index_unit(results, index))
        where = place_text(results, at, named=True)
        without = [name for name in names_there if name not in found] if compared_layouts(results) else []
        missing = [_missing_value_clause(results, index, name) for name in without]
        return f"{'; '.join([f'Best {title}: {_format_equal_layouts(names)}, {text} at {where}', *missing])}."
    remaining = [1.0 - ends[1][0] / 100.0 for ends in found.values()]  # of the baseline
    names = _simplest_first(results, [list(found)[i] for i in equally_least(remaining)])
    (least, _), (largest, at) = found[names[0]]
    over = " and ".join(swept)
    if largest < NOTICEABLE:
        return f"Best {title}: no layout is better than {baseline} at any {over}."
    lowest, highest = format_percent_size(least), format_percent_size(largest)
    best = f"Best {title} compared with {baseline} of the same {over}{by}: {_format_equal_layouts(names)}, {highest}"
    if lowest == highest:
        return f"{best} better at every {over}."
    where = place_text(results, at, named=True)
    return f"{best} better at {where}; its improvement over the sweep lies between {lowest} and {highest}."


def _missing_value_clause(results: xr.Dataset, index: str, layout: str) -> str:
    """Clause on a layout without a value: infeasible, or not finite."""
    missed = bool(infeasible(results.sel(layout=layout, index=index)).all())
    return f"no feasible {layout}" if missed else f"{layout} has no finite value"


def _no_best_clause(results: xr.Dataset, index: str) -> str:
    """Clause on the reason why no layout is best."""
    missed = bool(infeasible(results.sel(index=index)).all())
    return "no layout satisfies the constraints" if missed else "no layout has a finite value"
