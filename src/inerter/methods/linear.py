"""A question put to the linear model of a mechanism: which matrices, which delays, which filter, which weights."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inerter.errors import PerformanceIndexError
from inerter.indices.question import Combination, Question
from inerter.methods.method import Estimate
from inerter.norms.h2 import h2
from inerter.norms.hinf import Peak, hinf_norm
from inerter.systems.descriptor import Descriptor, describe
from inerter.systems.filtered import filtered
from inerter.systems.filters import Filter, high_pass
from inerter.systems.linear import LinearSystem
from inerter.vehicle.mechanism import Mechanism

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Conventions:
    """How the wheelbase delay is taken, which filter stands in for 1/s in the definition of tyre loads where the road
    arrives at several axles, and for how long simulated roads are held.
    """

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
            "The delay from one axle to the next is exact, and no filter is added to what the indices define.",
            pade_order=None,
            load_filter=None,
            hold=None,
        ),
        Conventions(
            "paper2008",
            "As for the printed numbers of Wang and Su (2008), a fifth-order Padé approximant stands for the delay "
            "from one axle to the next, and where the road arrives at two axles tyre loads are taken over "
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
        raise PerformanceIndexError(f"There are no conventions named {name!r} (known: {', '.join(CONVENTIONS)}).")


@dataclass(frozen=True, eq=False)
class LinearProblem:
    """A question put to the linear model of a mechanism: a descriptor, and what to do with its system."""

    question: Question
    unfiltered: Descriptor
    delays: Array  # [s], one an input of the descriptor, in rising order
    pade_order: int | None

    @cached_property
    def descriptor(self) -> Descriptor:
        """With the filters on its outputs."""
        return filtered(self.unfiltered, self.question.filters)

    @cached_property
    def weights(self) -> Array:
        """What each output's norm is multiplied by in the index."""
        road = self.question.road
        scale = 1.0 if road is None else road.velocity_intensity
        return scale * np.array([abs(output.weight) for output in self.question.outputs])

    def part(self, which: NDArray[np.bool_] | slice) -> LinearProblem:
        """The problem with some of its outputs."""
        d, chosen = self.unfiltered, np.arange(len(self.unfiltered.outputs))[which]
        outputs = tuple(d.outputs[i] for i in chosen)
        sizes = (*d.sizes[:3], *(stack[:, chosen] for stack in d.sizes[3:]))
        Y_eta, Y_x, Y_u = d.Y_eta[:, chosen], d.Y_x[:, chosen], d.Y_u[:, chosen]
        descriptor = replace(d, Y_eta=Y_eta, Y_x=Y_x, Y_u=Y_u, outputs=outputs, sizes=sizes)
        filters = tuple(self.question.filters[i] for i in chosen)
        question = replace(self.question, outputs=tuple(self.question.outputs[i] for i in chosen), filter=filters)
        return replace(self, question=question, unfiltered=descriptor)

    def system(self, closed: LinearSystem) -> LinearSystem:
        """The closed descriptor with delays."""
        return closed if self.question.road is None else closed.delayed("road", self.delays.tolist())

    def estimate(self, closed: LinearSystem) -> Estimate:
        """The value of the index."""
        system = self.system(closed)
        if self.question.combination is Combination.PEAK_GAIN:
            return self._peak_gain(system)
        norms = h2(system, self.pade_order)
        value = float(np.sum(self.weights * norms.outputs))
        return Estimate(value, self.question.unit, norms.status, notes=system.notes)

    def _peak_gain(self, system: LinearSystem) -> Estimate:
        gain = hinf_norm(system)
        weight = float(self.weights[0])
        peaks = tuple(Peak(peak.omega, weight * peak.gain) for peak in gain.peaks)
        return Estimate(weight * gain.value, self.question.unit, gain.status, peaks=peaks, notes=system.notes)


def linear_problem(mechanism: Mechanism, question: Question, conventions: Conventions) -> LinearProblem:
    """The descriptor for `question`, with delays from the road's speed and the filters that the conventions ask for.

    Raises `PerformanceIndexError` for a peak gain of anything but one output of one force.
    """
    check_peak_gain(question)
    inputs, delays = arrivals(mechanism, question)
    asked = under(conventions, mechanism, question)
    descriptor = describe(mechanism, inputs, [output.output for output in question.outputs])
    return LinearProblem(asked, descriptor, delays, conventions.pade_order)


def check_peak_gain(question: Question) -> None:
    """Raises `PerformanceIndexError` for a peak gain of anything but one output of one force."""
    alone = len(question.outputs) == 1 and len(question.inputs) == 1 and not question.road
    if question.combination is Combination.PEAK_GAIN and not alone:
        raise PerformanceIndexError("A peak gain goes from one force to one output, without a road.")


def arrivals(mechanism: Mechanism, question: Question) -> tuple[tuple[str, ...], Array]:
    """The inputs of a question in the order in which its source reaches them, and when it does [s]."""
    if question.road is None:
        return question.inputs, np.zeros(len(question.inputs))
    distance = {road.name: road.distance for road in mechanism.roads}
    inputs = tuple(sorted(question.inputs, key=distance.__getitem__))
    return inputs, np.array([distance[name] for name in inputs]) / question.road.speed


def under(conventions: Conventions, mechanism: Mechanism, question: Question) -> Question:
    """The question with the filters that the conventions add to its own."""
    if conventions.load_filter is None or np.ptp(arrivals(mechanism, question)[1]) == 0.0:
        return question
    loads = {weighted.output for weighted in mechanism.measures.tyre_load}
    filters = tuple(
        conventions.load_filter if own is None and weighted.output in loads else own
        for weighted, own in zip(question.outputs, question.filters, strict=True)
    )
    return replace(question, filter=filters)
