"""Frequency responses of designs, as Bode and Nyquist plots show them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import DesignError, LinearSystemError, PerformanceIndexError
from inerter.figures.labels import axis_label
from inerter.figures.plots.axes import curve_looks
from inerter.files.study.responses import gain_unit, output_weights, response_in_words, source_unit
from inerter.formatting import capital, in_words
from inerter.indices.definition import Index
from inerter.methods.composite_index import is_index
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.norms.response import frequency_response, resonant_range
from inerter.systems.assemble import state_space
from inerter.systems.descriptor import close
from inerter.systems.linear import LinearSystem
from inerter.systems.outputs import input_unit, unit_of
from inerter.validation import real_numbers
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Vehicle, check_fixed, check_vehicle

Array = NDArray[np.float64]
Designs = Vehicle | Mapping[str, Vehicle]
Response = Index | tuple[str, str]


class ResponseCurve:
    """The response of an output of one design."""

    def __init__(self, frequency: Array, value: NDArray[np.complex128], look: dict[str, Any], what: str, unit: str):
        self.frequency, self.value, self.look, self.unit = frequency, value, look, unit
        self.gain_label = axis_label(what, unit)


def response_curves(designs: Designs, response: Response, frequency: ArrayLike | None) -> Iterator[ResponseCurve]:
    """A curve for each design and each output of the response."""
    named = designs_by_name(designs)
    found = [_system(vehicle.mechanism(), vehicle, response) for vehicle in named.values()]
    omega = resonant_range([system.A for system, *_ in found])
    hertz = omega / (2.0 * np.pi) if frequency is None else check_frequencies(frequency)
    for look, (system, pade_order, outputs, what, unit) in zip(curve_looks(named), found, strict=True):
        values = frequency_response(system, 2.0 * np.pi * hertz, pade_order)
        if values.shape[2] > 1:
            raise DesignError(
                "Several independent sources excite this response, so that it has no phase. Plot it from one input to "
                'one output, such as ("road_front_left", "roll_acceleration").'
            )
        for row, (output, weight) in enumerate(outputs.items()):
            several = {"label": f"{look['label']} {in_words(output)}".strip()} if len(outputs) > 1 else {}
            fainter = {"alpha": 1.0 / (1 + row)} if row else {}
            yield ResponseCurve(hertz, weight * values[:, row, 0], {**look, **several, **fainter}, what, unit)


def _system(
    mechanism: Mechanism, vehicle: Vehicle, response: Response
) -> tuple[LinearSystem, int | None, dict[str, float], str, str]:
    """System of a response, order of its Pade approximants, weight of each output, and the gain in words and unit."""
    if not isinstance(response, tuple):
        if not is_index(response):
            raise PerformanceIndexError(
                "Expected a response: an index such as RideComfort(road), or the names of an input and an output such "
                f'as ("road", "sprung_acceleration"), got {response!r}.'
            )
        check_fixed(mechanism)
        problem = linear_problem(mechanism, response.definition(mechanism), CONVENTIONS["exact"])
        system = problem.system(close(problem.descriptor, {}))
        definition = problem.definition
        unit = gain_unit(definition.unit, source_unit(mechanism, definition))
        what = capital(response_in_words(response.response, definition))
        return system, problem.pade_order, output_weights(mechanism, definition), what, unit
    source, output = response
    system = state_space(vehicle, source, output)
    moved = source in {road.name for road in mechanism.roads}
    what = f"{capital(in_words(output))} over {in_words(source)}{' velocity' if moved else ''}"
    per = "m/s" if moved else input_unit(mechanism, source)
    return system, None, {output: 1.0}, what, gain_unit(unit_of(mechanism, [output]), per)


def designs_by_name(designs: Designs) -> dict[str, Vehicle]:
    named = dict(designs) if isinstance(designs, Mapping) else {"": designs}
    if not named:
        raise DesignError("A plot of designs needs at least one, got none.")
    for vehicle in named.values():
        check_vehicle(vehicle)
    return named


def check_frequencies(frequency: ArrayLike) -> Array:
    found = real_numbers(frequency)
    if found is None or found.ndim > 1 or not found.size or not np.all(np.isfinite(found) & (found > 0.0)):
        raise LinearSystemError(f"Frequencies of a plot are a list of positive numbers of Hz, got {frequency!r}.")
    return np.atleast_1d(found)
