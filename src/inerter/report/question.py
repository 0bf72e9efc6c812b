"""What a study asks, in words and tables: the vehicle, its elements and layouts, and how the answer is computed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np
import xarray as xr

from inerter.fields import fields_of
from inerter.figures.labels import capital, index_title, indices
from inerter.files.common.vehicles import vehicle_words
from inerter.files.study.study import Study
from inerter.indices.registry import INDICES, amplitude_of
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import is_blind, method_settings, words_of
from inerter.networks.elements import Element, Free, Tied
from inerter.units import format_quantity

_ALSO = {  # the same value in the unit in which it is usually told
    "m/s": lambda value: f" ({3.6 * value:.4g} km/h)",
    "rad/s": lambda value: f" ({value / (2.0 * pi):.3g} Hz)",
}


@dataclass(frozen=True)
class LayoutText:
    """A layout: its name, whether it is the baseline, and the expression of each of its struts."""

    name: str
    baseline: bool
    struts: dict[str, str]


def vehicle_rows(study: Study) -> list[tuple[str, str]]:
    """The model, its masses, stiffnesses and lengths, and the road, each with its value."""
    rows = [("Model", study.model.replace("-", " "))]
    told = vehicle_words(study.model, study.vehicle)
    rows += [(capital(name), unit if value is None else _given(value, unit)) for name, value, unit in told]
    if study.road is not None:
        rows += [("Speed", _given(study.road.speed, "m/s"))]
        rows += [("Road roughness", _given(study.road.roughness, "m^3/cycle"))]
    for symbol in study.indices:
        amplitude = amplitude_of(symbol)
        given = [field for field in fields_of(INDICES[symbol]) if field.key in study.settings and field != amplitude]
        rows += [(f"{capital(f.in_words)} of {symbol}", _given(study.settings[f.key], f.unit)) for f in given]
    for name, settings in study.method_settings.items():
        given = [field for field in method_settings(name) if field.key in settings]
        rows += [(f"{capital(f.in_words)} of {name}", _given(settings[f.key], f.unit)) for f in given]
    return rows


def element_rows(study: Study) -> list[tuple[str, str, str]]:
    """The elements: name, kind, and value or bounds."""
    return [(name, element.key, _value(study, name, element)) for name, element in study.elements.items()]


def layout_rows(study: Study) -> list[LayoutText]:
    """The layouts with the expressions of their struts; one without a mount where all struts are alike."""
    rows = []
    for name, layout in study.layouts.items():
        texts = set(layout.struts.values())
        rows.append(LayoutText(name, name == study.baseline, {"": texts.pop()} if len(texts) == 1 else layout.struts))
    return rows


def index_rows(results: xr.Dataset) -> list[tuple[str, str]]:
    """The indices: symbol and name."""
    return [(index, index_title(results, index)) for index in indices(results)]


def computation(study: Study, results: xr.Dataset) -> Iterator[str]:
    """How the numbers were computed, in sentences."""
    several = len(study.evaluate) > 1
    for name in study.evaluate:
        yield f"Values{f' by {name}' if several else ''} are {words_of(name)}."
    yield from _of_roads(study, results)
    if study.optimise is None:
        yield "Every layout was evaluated as it is given; nothing was optimised."
    else:
        again = f", and again for each value of {study.sweep.element}" if study.sweep else ""
        yield (
            f"The free values of each layout were chosen for each index on its own{again}, within their bounds, by "
            f"local searches from many starting points of a sample with seed {study.seed}. Agreement is the number of "
            "searches that ended at the best value found."
        )
        if not is_blind(study.optimise):
            yield f"What was made smallest is the value by {study.optimise}: {words_of(study.optimise)}."
    yield CONVENTIONS[study.conventions].sentence
    yield f"Computed by inerter {results.attrs['inerter_version']}."


def _of_roads(study: Study, results: xr.Dataset) -> Iterator[str]:
    """How many random roads there were, what ± means, and how large the force of J5 was."""
    counts = results["realisations"].values if "realisations" in results else np.zeros(0)
    if counts.any():
        least, most = int(counts[counts > 0].min()), int(counts.max())
        number = f"{most}" if least == most else f"{least} to {most}"
        yield (
            f"Each mean is over {number} random inputs, which seed {study.seed} decides and all designs share; ± is "
            "one standard error, for an improvement that of the difference on the same inputs where they are kept."
        )
    forced = {symbol: field for symbol in INDICES if (field := amplitude_of(symbol)) and field.key in study.settings}
    for symbol in [asked for asked in forced if asked in study.indices] or forced:
        amplitude = _given(study.settings[forced[symbol].key], forced[symbol].unit)
        yield f"The sinusoidal force of {symbol} has an amplitude of {amplitude}."


def _value(study: Study, name: str, element: Element) -> str:
    if study.sweep is not None and study.sweep.element == name:
        ends = _given(min(study.sweep.values), element.unit), _given(max(study.sweep.values), element.unit)
        return f"swept, {len(study.sweep.values)} values from {ends[0]} to {ends[1]}"
    if isinstance(element.value, Free):
        return f"free, {_given(element.value.lower, element.unit)} to {_given(element.value.upper, element.unit)}"
    if isinstance(element.value, Tied):
        return f"tied, {element.value}"
    return _given(element.value, element.unit)


def _given(value: float, unit: str) -> str:
    """A value with all digits that the study file gives it, on the line of its unit."""
    text = format_quantity(value, unit, digits=12).replace(" ", "\N{NO-BREAK SPACE}")
    return text + _ALSO[unit](value) if unit in _ALSO else text
