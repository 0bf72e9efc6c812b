"""Frequency responses of the designs that a study finds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from inerter.errors import LinearSystemError, MechanismError
from inerter.files.study.cases import Case
from inerter.files.study.study import Study
from inerter.formatting import format_number, format_quantity, in_words
from inerter.indices.definition import IndexDefinition
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.methods.registry import is_blind
from inerter.norms.response import frequency_response, resonant_range
from inerter.systems.descriptor import close
from inerter.systems.outputs import input_unit, unit_of
from inerter.vehicle.mechanism import Mechanism, OutputWeight

Array = NDArray[np.float64]


@dataclass(frozen=True)
class IndexResponse:
    """Responses of the outputs of an index, for each layout, over the frequencies that all indices share."""

    index: str
    outputs: list[str]
    gains: Array  # layout, output, frequency
    phases: Array  # [rad], from -pi to pi; nan where several sources excite, whose gain is a root of a sum of squares
    unit: str
    words: str


def responses(study: Study, found: Mapping[Case, Mapping[str, float]]) -> xr.Dataset:
    """Gain of every weighted output of every index over frequency, for the parameters that were found for each case."""
    omega, every = index_responses(study, found)
    data = xr.Dataset(coords={"omega": ("omega", omega, {"units": "rad/s", "long_name": "angular frequency"})})
    for one in every:
        attributes = {"units": one.unit, "long_name": one.words}
        data[f"gain_{one.index}"] = (("layout", f"output_{one.index}", "omega"), one.gains, attributes)
        data = data.assign_coords({f"output_{one.index}": one.outputs})
    return data


def index_responses(study: Study, found: Mapping[Case, Mapping[str, float]]) -> tuple[Array, list[IndexResponse]]:
    """Angular frequencies [rad/s], and the responses of each index that some layout has, for the parameters found."""
    designs = {
        (case.layout, case.index): study.design(case.layout).with_values(values) for case, values in found.items()
    }
    conventions = CONVENTIONS[study.conventions]
    systems: dict[tuple[str, str], Any] = {}
    for (layout, index), vehicle in designs.items():
        mechanism = vehicle.mechanism()
        try:
            problem = linear_problem(mechanism, study.index(index).definition(mechanism), conventions)
            systems[layout, index] = problem, problem.system(close(problem.descriptor, {}))
        except (MechanismError, LinearSystemError):  # friction or a gap alone holds a part
            if all(map(is_blind, study.methods)):
                raise
    omega = resonant_range([system.A for _, system in systems.values()])
    every = []
    for index in study.indices:
        mine = {layout: entry for (layout, i), entry in systems.items() if i == index}
        if not mine:
            continue
        definition = next(iter(mine.values()))[0].definition
        weights = np.array([output.weight for output in definition.outputs])
        gains = np.full((len(study.layouts), weights.size, omega.size), np.nan)
        angles = np.full_like(gains, np.nan)
        for layout, (problem, system) in mine.items():
            with np.errstate(over="ignore", invalid="ignore"):
                response = problem.with_true_densities(frequency_response(system, omega, problem.pade_order), omega)
                sizes = np.abs(response)
            together = sizes[:, :, 0] if sizes.shape[2] == 1 else np.linalg.norm(sizes, axis=2)  # over all sources
            number = list(study.layouts).index(layout)
            gains[number] = np.abs(weights)[:, None] * together.T
            if sizes.shape[2] == 1:
                angles[number] = np.angle(response[:, :, 0] * np.sign(weights)).T
        mechanism = designs[next(iter(mine)), index].mechanism()
        unit = gain_unit(definition.unit, source_unit(mechanism, definition))
        names = list(output_weights(mechanism, definition))
        every.append(IndexResponse(index, names, gains, angles, unit, _words(study, index, definition)))
    return omega, every


def output_weights(mechanism: Mechanism, definition: IndexDefinition) -> dict[str, float]:
    """Weights of the outputs of an index by their labels, which state any weight other than one."""
    labels = (_output_label(one, unit_of(mechanism, [one.output]), definition.unit) for one in definition.outputs)
    return dict(zip(labels, (one.weight for one in definition.outputs), strict=True))


def gain_unit(unit: str, per: str) -> str:
    """Unit of a gain: `unit` over `per`; `unit` alone if `per` is empty."""
    top, bottom = (f"({one})" if brackets & {*one} else one for one, brackets in ((unit, {"/"}), (per, {"/", " "})))
    return f"{top or 1}/{bottom}" if per else unit


def source_unit(mechanism: Mechanism, definition: IndexDefinition) -> str:
    """The unit of a source; empty for one input, whose unit that of its gain has in it already."""
    if definition.drive.unit or not definition.drive.is_random:
        return definition.drive.unit
    return input_unit(mechanism, definition.input_paths(mechanism)[0].input)


def _words(study: Study, index: str, definition: IndexDefinition) -> str:
    """Frequency response of an index in words, with the excitation if the file states it."""
    own = study.own_indices.get(index)
    source = own.excited_by if own else ""
    return f"gain from {source}" if source else response_in_words(study.index(index).response, definition)


def response_in_words(response: str, definition: IndexDefinition) -> str:
    """Response of an index, with the only part whose acceleration it is, such as an occupant, in place of the body."""
    part = definition.outputs[0].output.removesuffix("_acceleration")
    is_body = len(definition.outputs) > 1 or part == "sprung"
    return response if is_body else response.replace("body acceleration", f"{in_words(part)} acceleration")


def _output_label(output: OutputWeight, own: str, unit: str) -> str:
    """Label of an output of unit `own` in an index of that `unit`: times a weight, or over a reference quantity."""
    if output.weight == 1.0:
        return output.output
    if own and not unit:
        return f"{output.output} over {format_quantity(1.0 / output.weight, own)}"
    return f"{output.output} x {format_number(output.weight)}{' m' if own.startswith('rad') else ''}"
