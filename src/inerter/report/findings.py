"""The answer of a study in a sentence for each index."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from inerter.figures.labels import (
    compared,
    index_title,
    index_unit,
    indices,
    one_method,
    percent,
    quantity,
    swept_element,
)

Writer = Callable[[float, str], str]

_NOTICEABLE = 0.05  # per cent; what rounds to 0.0 % is no improvement


def headlines(results: xr.Dataset, write: Writer = quantity) -> list[str]:
    """One sentence for each index: which layout is best, how good it is, and how much better than the baseline.

    `write` turns a number and its unit into text.
    """
    results = one_method(results)
    sentence = _of_designs if swept_element(results) is None else _of_sweep
    return [sentence(results, index, write) for index in indices(results)]


def best_layout(results: xr.Dataset, index: str) -> str | None:
    """The layout with the least value of `index`; None if no value is finite. For a study without a sweep."""
    values = one_method(results)["value"].sel(index=index)
    finite = values.where(np.isfinite(values))
    return None if bool(finite.isnull().all()) else str(finite.idxmin("layout").item())


def extremes(row: xr.DataArray, element: str) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """The least and the largest finite number over the swept element, each with the swept value; None if none is."""
    finite = np.isfinite(row.values)
    if not finite.any():
        return None
    numbers, swept = row.values[finite], row[element].values[finite]
    least, largest = np.argmin(numbers), np.argmax(numbers)
    return (float(numbers[least]), float(swept[least])), (float(numbers[largest]), float(swept[largest]))


def _of_designs(results: xr.Dataset, index: str, write: Writer) -> str:
    title, baseline = index_title(results, index), results.attrs["baseline"]
    best = best_layout(results, index)
    if best is None:
        return f"Best {title}: no layout has a finite value."
    design = results.sel(layout=best, index=index)
    answer = f"Best {title}: {best}, {write(float(design['value']), index_unit(results, index))}"
    if best == baseline:
        return f"{answer}; no other layout is better than this baseline."
    improvement = float(design["improvement"])
    if not np.isfinite(improvement):
        return f"{answer}; {baseline} has no finite value." if baseline else f"{answer}."
    if improvement < _NOTICEABLE:
        return f"{answer}, no better than {baseline}."
    return f"{answer}, {improvement:.1f} % better than {baseline}."


def _of_sweep(results: xr.Dataset, index: str, write: Writer) -> str:
    element, title, baseline = str(swept_element(results)), index_title(results, index), results.attrs["baseline"]
    unit = results[element].attrs["units"]
    names = compared(results) or results["layout"].values.tolist()
    rows = results["improvement" if compared(results) else "value"].sel(index=index)
    found = {name: ends for name in names if (ends := extremes(rows.sel(layout=name), element)) is not None}
    if not found:
        return f"Best {title}: no layout has a finite value."
    if not compared(results):
        name = min(found, key=lambda name: found[name][0][0])
        value, at = found[name][0]
        return f"Best {title}: {name}, {write(value, index_unit(results, index))} at {element} = {write(at, unit)}."
    name = max(found, key=lambda name: found[name][1][0])
    (least, _), (largest, at) = found[name]
    if largest < _NOTICEABLE:
        return f"Best {title}: no layout is better than {baseline} at any {element}."
    return (
        f"Best {title} compared with {baseline} of the same {element}: {name}, {largest:.1f} % better at "
        f"{element} = {write(at, unit)}; its improvement over the sweep lies {_range(least, largest)}."
    )


def _range(least: float, largest: float) -> str:
    return "between " + " and ".join(percent(value).removeprefix("+") for value in (least, largest))
