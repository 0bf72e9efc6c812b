"""What an index is, and the question that it puts to a mechanism: outputs, filters, how they combine, excitation.

A method reads a `Question` and never asks which index it came from.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from inerter.errors import PerformanceIndexError
from inerter.indices.excitation import Excitation, as_excitation
from inerter.signals.road import Road
from inerter.systems.arrivals import Arrival
from inerter.systems.filters import Filter, as_filter
from inerter.systems.linear import LinearSystem
from inerter.vehicle.mechanism import Mechanism, Weighted

Array = NDArray[np.float64]
Given = Filter | LinearSystem | None


class Combination(Enum):
    """How the outputs make one number."""

    SUM_OF_RMS = auto()  # r.m.s. values of the weighted outputs, added up
    ROOT_OF_SQUARES = auto()  # the root of the sum of their squares
    PEAK_GAIN = auto()  # largest gain over all frequencies


@dataclass(frozen=True)
class Question:
    """An index put to one mechanism.

    A filter is a `Filter` or a `LinearSystem` with one input and one output.

    Raises `PerformanceIndexError` if filters are not as many as outputs, if an output is named twice, or for what is no
    excitation; `LinearSystemError` for what is no filter.
    """

    outputs: tuple[Weighted, ...]
    combination: Combination
    excitation: Road | Excitation  # kept as an excitation
    unit: str
    filter: Given | tuple[Given, ...] = None  # of each output, or one of all
    amplitude: float | None = None  # of a sinusoidal input, for methods that see nonlinear elements

    def __post_init__(self) -> None:
        object.__setattr__(self, "excitation", as_excitation(self.excitation, "An index"))
        several = self.filter if isinstance(self.filter, tuple) else (self.filter,) * len(self.outputs)
        if len(several) != len(self.outputs):
            raise PerformanceIndexError(
                f"An index has one filter for all outputs, or one (or None) for each: got {len(several)} filters for "
                f"{len(self.outputs)} outputs."
            )
        names = [weighted.output for weighted in self.outputs]
        if len(set(names)) < len(names):
            raise PerformanceIndexError(f"An index names each output once, got {', '.join(names)}.")
        object.__setattr__(self, "filter", tuple(map(as_filter, several)))

    @property
    def filters(self) -> tuple[Filter | None, ...]:
        """Of each output."""
        return cast(tuple[Filter | None, ...], self.filter)

    @property
    def drive(self) -> Excitation:
        """The excitation."""
        return cast(Excitation, self.excitation)

    @property
    def is_peak(self) -> bool:
        """Whether it asks for a peak gain; else for r.m.s. values."""
        return self.combination is Combination.PEAK_GAIN

    def combined(self, rms: Array, weights: Array) -> Array:
        """What r.m.s. values (..., outputs) make together, with these weights."""
        if self.combination is Combination.ROOT_OF_SQUARES:
            return np.asarray(np.sqrt(rms**2 @ weights**2))
        return np.asarray(rms @ weights)

    def slopes(self, rms: Array, weights: Array) -> Array:
        """The derivative of that over each of the r.m.s. values (outputs,)."""
        if self.combination is Combination.ROOT_OF_SQUARES:
            return np.asarray(weights**2 * rms / max(float(self.combined(rms, weights)), 1e-300))
        return weights

    def arrivals(self, mechanism: Mechanism) -> tuple[Arrival, ...]:
        """How the sources reach the inputs of the mechanism that is driven, in the order in which they do."""
        return tuple(sorted(self.drive.arrivals(mechanism), key=lambda arrival: arrival.delay))


class Index(Protocol):
    """An index: a symbol, a title, a unit, and the question that it is for a given mechanism."""

    @property
    def symbol(self) -> str:
        """Short name, such as J1."""
        ...

    @property
    def title(self) -> str:
        """Name in words."""
        ...

    @property
    def unit(self) -> str:
        """Unit of its value."""
        ...

    @property
    def response(self) -> str:
        """What its frequency response is, in words."""
        ...

    def question(self, mechanism: Mechanism) -> Question:
        """What it asks of `mechanism`; raises `PerformanceIndexError` if the mechanism has no answer."""
        ...


@dataclass(frozen=True)
class OfIndex:
    """What is made of an index: it has that one's names and unit, but what it says otherwise."""

    index: Any

    @property
    def symbol(self) -> str:
        """That of the index."""
        return str(self.index.symbol)

    @property
    def unit(self) -> str:
        """That of the index."""
        return str(self.index.unit)

    @property
    def response(self) -> str:
        """That of the index."""
        return str(self.index.response)


class OnRoad(Index, Protocol):
    """An index that is asked on a road."""

    @property
    def road(self) -> Road | Excitation:
        """The road that all wheels pass, or what is random in its place."""
        ...


def on_road(
    index: OnRoad,
    mechanism: Mechanism,
    outputs: tuple[Weighted, ...],
    where: str,
    filter: Given | tuple[Given, ...] = None,
    combination: Combination = Combination.SUM_OF_RMS,
) -> Question:
    """The question of an index of r.m.s. values on a road, which are added up if nothing else is said.

    Raises `PerformanceIndexError` if there is no road, or if `outputs`, which the mechanism gives at `where`, are none.
    """
    if isinstance(index.road, type) or not (isinstance(index.road, Road) or getattr(index.road, "is_random", False)):
        raise PerformanceIndexError(f"{index.symbol} needs a Road(roughness=..., speed=...), got {index.road!r}.")
    if isinstance(index.road, Road) and not mechanism.roads:
        raise PerformanceIndexError(
            f"{index.symbol} is driven by a road, and this mechanism stands on none. Add a tyre."
        )
    if not outputs:
        raise PerformanceIndexError(f"The mechanism does not say which outputs {index.symbol} is about. Set {where}.")
    return Question(outputs, combination, index.road, index.unit, filter)
