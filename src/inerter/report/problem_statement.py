"""Problem statement of a study: vehicle, elements, layouts, and the computation, in words and tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isclose, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from inerter.field_metadata import Field, fields_of
from inerter.figures.labels import infeasible
from inerter.files.common.vehicles import vehicle_words
from inerter.files.study.limits import limit_text
from inerter.files.study.method_labels import method_labels
from inerter.files.study.quantity_texts import as_written
from inerter.files.study.sections import OVER
from inerter.files.study.study import Study
from inerter.files.study.tasks import tasks
from inerter.formatting import capital, format_list, format_number, format_quantity, format_share, in_words
from inerter.indices.names import title_with_name
from inerter.indices.registry import INDICES, amplitude_of, index_choices
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import brief_words_of, is_blind, method_settings, words_of
from inerter.networks.elements import Free, Spring, Tied
from inerter.networks.free_network import FreeNetwork
from inerter.signals.road import Road

if TYPE_CHECKING:
    import xarray as xr

_ROUGHNESS = "m^3/cycle"
_ALSO = {  # the same value in its customary unit
    "m/s": lambda value: f" ({format_quantity(3.6 * value, 'km/h')})",
    "rad/s": lambda value: f" ({format_quantity(value / (2.0 * pi), 'Hz', 3)})",
    _ROUGHNESS: lambda value: f" ({_road_class(value)})",
}


def _road_class(roughness: float) -> str:
    """Class of a road in ISO 8608, as text."""
    found = Road(roughness, speed=1.0).iso8608_class
    mean = isclose(roughness, found.roughness, rel_tol=1e-9)
    return f"{'mean of' if mean else 'in'} class {found.letter} of ISO 8608"


@dataclass(frozen=True)
class LayoutText:
    """Layout in words: name, whether it is the baseline, and the expression of each strut."""

    name: str
    baseline: bool
    struts: dict[str, str]


def vehicle_rows(study: Study) -> list[tuple[str, str]]:
    """The model, its masses, stiffnesses and lengths, and the road, each with its value."""
    rows = [("Model", study.model.replace("-", " "))]
    swept = {sweep.words for sweep in study.sweeps}
    told = [row for row in vehicle_words(study.vehicle) if row[0] not in swept]
    rows += [(capital(name), unit if value is None else _value_text(study, value, unit)) for name, value, unit in told]
    rows += [(capital(s.words), _number_text(study, s.label)) for s in study.sweeps if s.place.section == "vehicle"]
    if study.road is not None:
        rows += [("Speed", _number_text(study, "road.speed")), ("Road roughness", _roughness(study))]
        rows += [] if study.line is None else [("Road measured in", study.line.source)]
        rows += list(_coherence_rows(study))
    limited = [limit.of for limit in study.limits if study.knows(limit.of)]
    for name in dict.fromkeys([*study.indices, *study.trade_off, *limited]):
        symbol, settings = study.symbol(name), study.settings_of(name)
        amplitude = amplitude_of(symbol)
        given = [field for field in fields_of(INDICES[symbol]) if field.key in settings and field != amplitude]
        rows += [(f"{capital(f.in_words)} of {name}", _value_text(study, settings[f.key], f.unit)) for f in given]
        texts = [one for one in index_choices(symbol) if one.key in settings]
        rows += [(f"{capital(in_words(one.key))} of {name}", settings[one.key]) for one in texts]
        rows += list(_formed_rows(study, name))
    for name, settings in study.method_settings.items():
        given = [field for field in method_settings(name) if field.key in settings]
        rows += [(f"{capital(f.in_words)} of {name}", _value_text(study, settings[f.key], f.unit)) for f in given]
    return rows


def _formed_rows(study: Study, name: str) -> Iterator[tuple[str, str]]:
    """Rows on the settings of a user-defined index that have value types other than quantities."""
    known = study.numbers
    for key, form, value in study.own_indices[name].typed_settings if name in study.own_indices else ():
        for words, text in form.told(value):
            yield f"{words} of {name}", text
        for part, _ in form.codec.numbers(value, ""):
            place = ".".join(("indices", name, key, *part))
            yield capital(known[place].words), _number_text(study, place)


def _roughness(study: Study) -> str:
    """Roughness as the file has it, or as fitted to a profile, with the digits that the fit justifies."""
    swept = any(sweep.label == "road.roughness" for sweep in study.sweeps)
    if study.line is None or study.road is None or swept:
        return _number_text(study, "road.roughness")
    return _with_also(format_quantity(study.road.roughness, _ROUGHNESS), study.road.roughness, _ROUGHNESS)


def _coherence_rows(study: Study) -> Iterator[tuple[str, str]]:
    known = study.numbers
    for key, value in study.coherence.items():
        label = f"road.coherence.{key}"
        words = known[label].words if label in known else f"{key} of the coherence"
        yield capital(words), _number_text(study, label) if label in known else format_number(value)


def element_rows(study: Study) -> list[tuple[str, str, str]]:
    """The elements: name, kind, and value or bounds."""
    networks = [(name, "free network", free_network_text(study, one)) for name, one in study.free_networks.items()]
    return [*((name, element.key, _number_text(study, name)) for name, element in study.elements.items()), *networks]


def free_network_text(study: Study, network: FreeNetwork) -> str:
    """Numbers of elements of a free network, and the bounds of each kind."""
    least = f"{network.min_elements} to " if network.min_elements > 1 else "up to "
    kinds = [
        f"{kind.key}s of {' to '.join(_value_text(study, end, kind.unit) for end in ends)}"
        for kind, ends in network.bounds.items()
    ]
    return f"{least}{network.max_elements} elements: {', '.join([*kinds, *['bridges'] * network.bridges])}"


def further_rows(study: Study) -> list[tuple[str, str]]:
    """Rows on constraints and tasks."""
    given = {"Limits": _limit_texts(study)}
    for task in tasks():
        given |= task.description(study)
    return [(what, ", ".join(told)) for what, told in given.items() if told]


def condition_rows(study: Study) -> list[tuple[str, str, str]]:
    """The operating conditions: name or number, share of all, and the numbers that are others."""
    total, known = sum(condition.share for condition in study.conditions), study.numbers
    rows = []
    for i, condition in enumerate(study.conditions, start=1):
        numbers = [
            f"{known[label].words} = {_value_text(study, value, known[label].unit)}"
            for label, value in condition.numbers.items()
        ]
        told = ", ".join(numbers) or "as above"
        rows.append((condition.name or f"{i}", format_share(condition.share / total), told))
    return rows


def layout_rows(study: Study) -> list[LayoutText]:
    """Layouts with the expressions of their struts; without mounts if all struts are equal."""
    rows = []
    for name, layout in study.layouts.items():
        texts = set(layout.struts.values())
        rows.append(LayoutText(name, name == study.baseline, {"": texts.pop()} if len(texts) == 1 else layout.struts))
    return rows


def index_rows(study: Study, *, combined: bool = False) -> list[tuple[str, str]]:
    """The indices by title, each with what it is; with `combined` only those of several outputs."""
    layout, known = next(iter(study.layouts.values())), dict.fromkeys(study.free_networks, Spring(1.0))
    mechanism = layout.design(study.vehicle, study.elements, known).mechanism()  # of any network
    rows = []
    for name in dict.fromkeys([*study.indices, *study.trade_off]):
        index = study.index(name)
        definition = index.definition(mechanism)
        if len(definition.outputs) > 1 or not combined:
            title = capital(title_with_name(index.title, name))
            rows.append((title, definition.describe(mechanism)))
    return rows


def problem_statement(study: Study, words: Sequence[str]) -> dict[str, Any]:
    """The problem that a page states, by the names of its template; `words` are the titles of the indices."""
    return {
        "vehicle": vehicle_rows(study),
        "on_road": study.road is not None,
        "definitions": index_rows(study),
        "elements": element_rows(study),
        "further": further_rows(study),
        "layouts": layout_rows(study),
        "indices": f"The {'index is' if len(words) == 1 else 'indices are'} {format_list(words)}.",
        "conditions": condition_rows(study),
    }


def computation(study: Study, results: xr.Dataset) -> Iterator[str]:
    """Sentences on the computation of the numbers."""
    told = method_labels(study) if len(study.evaluate) > 1 else {}
    for name in study.evaluate:
        yield f"Values{f' {told[name]} (in files: {name})' if told else ''} are {words_of(name)}."
    yield from _of_roads(study, results)
    if study.optimise is None:
        yield "Every layout was evaluated with its given values; nothing was optimised."
    else:
        swept = " and of ".join(sweep.words for sweep in study.sweeps)
        again = f", and again for each value of {swept}" if swept else ""
        yield (
            f"The design variables of each layout were optimised separately for each index{again}, within bounds, "
            f"by multi-start local searches (starting points sampled with seed {study.seed}). Agreement is the number "
            "of searches that converged to the best value."
        )
        if not is_blind(study.optimise):
            what = brief_words_of(study.optimise)
            yield f"The minimised value is that by {what}: {words_of(study.optimise)}."
    if study.limits:
        satisfy = "must satisfy" if bool(infeasible(results).any()) else "satisfies"
        yield f"Every design {satisfy} these constraints: {'; '.join(_limit_texts(study))}."
    if study.conditions:
        how = (
            "mean over the operating conditions by shares" if study.over == OVER[0] else "worst value in any condition"
        )
        yield f"An index is its {how}{'; limits hold in each' if study.limits else ''}."
        yield "Frequency responses are computed with the numbers outside the conditions."
    if study.road is not None:
        yield CONVENTIONS[study.conventions].sentence
    yield f"Computed by inerter {results.attrs['inerter_version']}."


def _of_roads(study: Study, results: xr.Dataset) -> Iterator[str]:
    """Sentences on the number of random roads, the meaning of ±, and amplitudes of sinusoidal forces."""
    counts = results["realisations"].values if "realisations" in results else np.zeros(0)
    if counts.any():
        least, most = int(counts[counts > 0].min()), int(counts.max())
        number = f"{most}" if least == most else f"{least} to {most}"
        yield (
            f"Each mean is over {number} random inputs, which seed {study.seed} decides and all designs share; ± is "
            "one standard error, of an improvement that of the difference on the same inputs."
        )
    amplitudes = [symbol for symbol in INDICES if isinstance(amplitude_of(symbol), Field)]
    asked = [name for name in study.indices if study.symbol(name) in amplitudes]
    for name in asked or amplitudes:
        field, settings = amplitude_of(study.symbol(name)), study.settings_of(name)
        if isinstance(field, Field) and field.key in settings:
            amplitude = _value_text(study, settings[field.key], field.unit)
            yield f"The sinusoidal force of {name} has an amplitude of {amplitude}."


def _limit_texts(study: Study) -> list[str]:
    """The limits in words, with the values as the study file has them."""
    return [limit_text(study, one, _value_text(study, one.value, one.unit)) for one in study.limits]


def _number_text(study: Study, place: str) -> str:
    """Number at a place as text: its value, its bounds if free, or the ends of its sweep."""
    number = study.numbers[place]
    for sweep in study.sweeps:
        if sweep.label == place:
            ends = _value_text(study, min(sweep.values), sweep.unit), _value_text(study, max(sweep.values), sweep.unit)
            return f"swept, {len(sweep.values)} values from {ends[0]} to {ends[1]}"
    value = number.value
    if isinstance(value, Free):
        return f"free, {_value_text(study, value.lower, number.unit)} to {_value_text(study, value.upper, number.unit)}"
    if isinstance(value, Tied):
        return f"tied, {value}"
    return "" if value is None else _value_text(study, value, number.unit)


def _value_text(study: Study, value: float, unit: str) -> str:
    """Value as the study file has it, else with 12 digits, without a line break before its unit."""
    return _with_also(as_written(study, value, unit) or format_quantity(value, unit, digits=12), value, unit)


def _with_also(text: str, value: float, unit: str) -> str:
    also = _ALSO[unit](value) if unit in _ALSO and text.endswith(f" {unit}") else ""
    return text.replace(" ", "\N{NO-BREAK SPACE}") + also
