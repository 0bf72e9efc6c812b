"""Linear model of a mechanism for an index: matrices, delays, filters, and weights."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ErrorSource, PerformanceIndexError, Status, worst_of
from inerter.indices.definition import ExcitedIndex, IndexDefinition
from inerter.indices.excitation import error_sources_of
from inerter.methods.error_bounds import ROUNDING, judge_errors
from inerter.methods.measured_road_errors import road_errors
from inerter.methods.method import Estimate
from inerter.methods.symmetric_half import on_one_side
from inerter.norms.excess import excess_squares
from inerter.norms.h2 import H2, h2
from inerter.norms.hinf import GainPeak, hinf_norm
from inerter.signals.coherence import Excess
from inerter.systems.descriptor import Descriptor, close, describe, describe_design
from inerter.systems.filters import Filter, high_pass
from inerter.systems.input_paths import Column, InputPath, apply_excitation, columns_of, inputs_of
from inerter.systems.linear import LinearSystem
from inerter.systems.output_filters import with_output_filters
from inerter.vehicle.mechanism import Mechanism

Array = NDArray[np.float64]
_FEW = 1e-14  # relative error by the roundings of weights, sizes and delays
DENSITY = "density of the tracks"
CORRECTED = 1e-6  # relative error of a norm that is ok where it is corrected for densities that no filter has
PROMISE = 1e-9  # relative error of a norm that is ok, beside those of what stands in for its excitation


@dataclass(frozen=True)
class Conventions:
    """Conventions on the wheelbase delay, the filter in place of 1/s for tyre loads, and the hold of road inputs."""

    name: str
    sentence: str  # which tells them in a report
    pade_order: int | None
    load_filter: Filter | None
    hold: float | None  # [s]


CONVENTIONS = {
    row.name: row
    for row in (
        Conventions(
            "exact",
            "Any delay between axles is exact, and no filter is added to what the indices define.",
            pade_order=None,
            load_filter=None,
            hold=None,
        ),
        Conventions(
            "paper2008",
            "As for the printed numbers of Wang and Su (2008), a fifth-order Padé approximant stands for any "
            "delay between axles, and where the road arrives at two axles tyre loads are taken over "
            "s + 2 pi rad/s.",
            pade_order=5,
            load_filter=high_pass(2.0 * math.pi),
            hold=1e-3,
        ),
    )
}


def check_conventions(name: object) -> None:
    """Raises `PerformanceIndexError` unless there are conventions of this name."""
    if not isinstance(name, str) or name not in CONVENTIONS:
        raise PerformanceIndexError(f"Unknown conventions {name!r}; available: {', '.join(CONVENTIONS)}.")


@dataclass(frozen=True, eq=False)
class LinearProblem:
    """Linear problem of an index: the descriptor of the mechanism, and the evaluation of its system."""

    definition: IndexDefinition
    unfiltered: Descriptor
    arrivals: tuple[Column, ...]  # the inputs of the descriptor, with their sources and delays in rising order
    pade_order: int | None
    paths: tuple[InputPath, ...]  # from the sources to the inputs of the mechanism
    mechanism: Mechanism  # as excited
    excesses: Mapping[str, Excess] = field(default_factory=dict)  # of sources whose filters only stand in for a density

    @cached_property
    def descriptor(self) -> Descriptor:
        """Descriptor with the filters on its outputs."""
        return with_output_filters(self.unfiltered, self.definition.filters)

    @cached_property
    def weights(self) -> Array:
        """Factor of each output's norm in the index."""
        return self.definition.drive.amplitude_density * np.array(
            [abs(output.weight) for output in self.definition.outputs]
        )

    @property
    def delays(self) -> Array:
        """Delay of each input of the descriptor [s]."""
        return np.array([delay for *_, delay in self.arrivals])

    @property
    def sources(self) -> tuple[str, ...]:
        """Source of each input of the descriptor."""
        return tuple(source for _, source, _ in self.arrivals)

    @cached_property
    def highest_filter(self) -> int:
        """The order of the highest filter before an input or behind an output."""
        before = [c.filter for c in self.definition.input_paths(self.mechanism)]
        return max((one.order for one in (*self.definition.filters, *before) if one is not None), default=0)

    def part(self, which: NDArray[np.bool_] | slice) -> LinearProblem:
        """The problem with some of its outputs."""
        d, chosen = self.unfiltered, np.arange(len(self.unfiltered.outputs))[which]
        outputs = tuple(d.outputs[i] for i in chosen)
        sizes = (*d.sizes[:3], *(stack[:, chosen] for stack in d.sizes[3:]))
        Y_eta, Y_x, Y_u = d.Y_eta[:, chosen], d.Y_x[:, chosen], d.Y_u[:, chosen]
        descriptor = replace(d, Y_eta=Y_eta, Y_x=Y_x, Y_u=Y_u, outputs=outputs, sizes=sizes)
        filters = tuple(self.definition.filters[i] for i in chosen)
        definition = replace(self.definition, outputs=tuple(self.definition.outputs[i] for i in chosen), filter=filters)
        return replace(self, definition=definition, unfiltered=descriptor)

    def of_source(self, source: str) -> LinearProblem:
        """The problem with one of its sources alone, of half the mechanism where that moves as the whole does.

        Free values of mounts that lie still there are none of it.
        """
        names = [output.output for output in self.definition.outputs]
        mechanism = self.mechanism
        half = on_one_side(mechanism, [a for a in self.definition.input_paths(mechanism) if a.source == source])
        if half is not None:
            described = describe(half[0], inputs_of(half[1]), names)
            driven = apply_excitation(described, half[1])
            columns = tuple(columns_of(half[1]))
            return replace(self, unfiltered=driven, arrivals=columns, paths=half[1], mechanism=half[0])
        d, chosen = self.unfiltered, [i for i, of in enumerate(self.sources) if of == source]
        S, R, F, Y_eta, Y_x, Y_u = d.sizes
        descriptor = replace(
            d,
            F=d.F[:, :, chosen],
            X_u=d.X_u[:, chosen],
            Y_u=d.Y_u[:, :, chosen],
            inputs=tuple(d.inputs[i] for i in chosen),
            sizes=(S, R, F[:, :, chosen], Y_eta, Y_x, Y_u[:, :, chosen]),
        )
        paths = tuple(path for path in self.paths if path.source == source)
        return replace(self, unfiltered=descriptor, arrivals=tuple(self.arrivals[i] for i in chosen), paths=paths)

    def with_true_densities(self, response: NDArray[np.complex128], omega: Array) -> NDArray[np.complex128]:
        """A response (omega, outputs, sources) to sources with their own densities, not those of their filters."""
        corrected = response.copy()
        for i, source in enumerate(dict.fromkeys(self.sources)):
            if source in self.excesses:
                corrected[:, :, i] *= self.excesses[source].factor(omega)[:, None]
        return corrected

    def system(self, closed: LinearSystem) -> LinearSystem:
        """The closed descriptor with sources and delays."""
        return replace(closed, sources=self.sources, delays=self.delays)

    def system_at(self, values: Mapping[str, float]) -> LinearSystem:
        """The system for these free values; others that have no effect here may be among them."""
        d = self.descriptor
        known = {name: value for name, value in values.items() if name in d.free}
        return close(d, known, self.sources, [delay for *_, delay in self.arrivals])

    def estimate(self, values: Mapping[str, float]) -> Estimate:
        """The value of the index for these free values."""
        system = self.system_at(values)
        if self.definition.is_peak:
            return self._peak_gain(system)
        norms, unsure = self.norms(system, values)
        outputs = norms.outputs
        value = float(self.definition.combine(outputs, self.weights))
        more = road_errors(self.definition, system, self.pade_order, outputs)
        return self._estimate(value, norms.status, system.notes, (norms.error, unsure), more)

    def norms(self, system: LinearSystem, values: Mapping[str, float]) -> tuple[H2, float]:
        """Norms of the outputs for the true densities of the sources, and the largest relative error from these.

        `system` is the one for these free values. Where norms are corrected, each source is asked of the half of the
        mechanism that it moves, which needs no states that only drift.
        """
        if not self.excesses:
            return h2(system, self.pade_order), 0.0
        several = [self.of_source(source) for source in dict.fromkeys(self.sources)]
        systems = [one.system_at(values) for one in several]
        found = [h2(part, self.pade_order) for part in systems]
        pairs = zip(several, systems, found, strict=True)
        corrected = [one.correct_norms(part, norms.outputs) for one, part, norms in pairs]
        outputs = np.linalg.norm([norms for norms, _ in corrected], axis=0)
        status, error = worst_of([one.status for one in found]), max(one.error for one in found)
        unsure = sum(squares for _, squares in corrected) / np.maximum(outputs**2, 1e-300)
        return H2(np.asarray(outputs), status, error), float(
            np.max(0.5 * unsure, where=np.isfinite(outputs), initial=0.0)
        )

    def correct_norms(self, system: LinearSystem, norms: Array) -> tuple[Array, Array]:
        """The norms of the outputs of `system` for the densities that are meant, and what their squares may be off by.

        As they are where the filters before the inputs are exact, where they are zero and where they are infinite.
        """
        some = np.isfinite(norms) & (norms > 0.0)
        if not self.excesses or not np.any(some):
            return norms, np.zeros(norms.size)
        added, unsure = excess_squares(system, self.excesses, self.pade_order)
        squares = np.where(some, norms, 0.0) ** 2 + added
        return np.where(some, np.sqrt(np.maximum(squares, 0.0)), norms), np.where(some, unsure, 0.0)

    def _peak_gain(self, system: LinearSystem) -> Estimate:
        gain = hinf_norm(system)
        weight = float(self.weights[0])
        peaks = tuple(GainPeak(peak.omega, weight * peak.gain) for peak in gain.peaks)
        return self._estimate(weight * gain.value, gain.status, system.notes, (gain.error, 0.0), peaks=peaks)

    def _estimate(
        self,
        value: float,
        status: Status,
        notes: tuple[str, ...],
        errors: tuple[float, float],
        more: tuple[ErrorSource, ...] = (),
        peaks: tuple[GainPeak, ...] = (),
    ) -> Estimate:
        """Estimate with the errors from rounding and from densities, `errors`, and from approximated excitations."""
        own: tuple[ErrorSource, ...] = (ErrorSource(ROUNDING, errors[0] + _FEW),)
        if self.excesses:
            own = (*own, ErrorSource(DENSITY, errors[1]))
        stand_ins = (*error_sources_of(self.definition.drive, self.mechanism), *more)
        promise = CORRECTED if self.excesses else PROMISE
        status, sources = judge_errors(value, status, own, stand_ins, promise)
        return Estimate(value, self.definition.unit, status, peaks=peaks, notes=notes, error_sources=sources)


def linear_problem(mechanism: Mechanism, definition: IndexDefinition, conventions: Conventions) -> LinearProblem:
    """Linear problem of an index, with its sources and the filters of the conventions.

    Raises `PerformanceIndexError` for a peak gain of anything but one output of one input.
    """
    excited = definition.excite(mechanism)
    return linear_problem_of_design(excited, conventions, lambda *asked: (describe(*asked), {}))[0]


def linear_problem_of_design(
    index: ExcitedIndex,
    conventions: Conventions,
    describe_mechanism: Callable[..., tuple[Descriptor, Mapping[str, float]]] = describe_design,
) -> tuple[LinearProblem, Mapping[str, float]]:
    """Linear problem of all designs of the structure of a design without free values, and its values there.

    Where it depends on more than the structure it is that of the design alone, without values.

    Raises `PerformanceIndexError` as `linear_problem`.
    """
    check_peak_gain(index.definition)
    asked, paths = with_convention_filters(conventions, index.mechanism, index.definition), index.paths
    outputs = [output.output for output in asked.outputs]
    descriptor, values = describe_mechanism(index.excited, inputs_of(paths), outputs)
    columns, driven = tuple(columns_of(paths)), apply_excitation(descriptor, paths)
    excesses = {path.source: path.excess for path in paths if path.excess is not None}
    return LinearProblem(asked, driven, columns, conventions.pade_order, paths, index.excited, excesses), values


def check_peak_gain(definition: IndexDefinition) -> None:
    """Raises `PerformanceIndexError` for a peak gain of anything but one output of one input."""
    if definition.is_peak and (definition.drive.is_random or len(definition.outputs) != 1):
        raise PerformanceIndexError(
            "A peak gain requires one force or motion as input and one output, without a random input."
        )


def with_convention_filters(
    conventions: Conventions, mechanism: Mechanism, definition: IndexDefinition
) -> IndexDefinition:
    """Index definition with the filters of the conventions added to its filters."""
    if conventions.load_filter is None:
        return definition
    delays = [path.delay for path in definition.input_paths(definition.drive.excited_mechanism(mechanism))]
    if np.ptp(delays) == 0.0:
        return definition
    loads = {weighted.output for weighted in mechanism.tyre_loads}
    filters = tuple(
        conventions.load_filter if own is None and weighted.output in loads else own
        for weighted, own in zip(definition.outputs, definition.filters, strict=True)
    )
    return replace(definition, filter=filters)
