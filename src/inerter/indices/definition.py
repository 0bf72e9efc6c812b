"""Indices and their definition for a mechanism: outputs, filters, combination, excitation.

A method reads an `IndexDefinition` and never asks which index it came from.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from inerter.deprecation import RenamedAttribute
from inerter.errors import PerformanceIndexError
from inerter.formatting import format_list, format_quantity, in_words
from inerter.indices.excitation import Excitation, as_excitation
from inerter.signals.road import Road
from inerter.systems.filters import Filter, as_filter
from inerter.systems.input_paths import InputPath, inputs_of
from inerter.systems.linear import LinearSystem
from inerter.systems.outputs import of_mount, unit_of
from inerter.units import PURE, combine_units
from inerter.validation import checked
from inerter.vehicle.mechanism import Mechanism, OutputWeight

Array = NDArray[np.float64]
Given = Filter | LinearSystem | None


class Combination(Enum):
    """Combination of the outputs into one number.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(2600.0))
    >>> it.LoadCarrying().definition(car.mechanism()).combination is it.Combination.PEAK_GAIN
    True
    """

    SUM_OF_RMS = auto()  # r.m.s. values of the weighted outputs, added up
    ROOT_OF_SQUARES = auto()  # the root of the sum of their squares
    PEAK_GAIN = auto()  # largest gain over all frequencies


@dataclass(frozen=True)
class IndexDefinition:
    """Index definition for one mechanism.

    A filter is a `Filter` or a `LinearSystem` with one input and one output.

    Raises `PerformanceIndexError` if filters are not as many as outputs, if an output is named twice, or for what is no
    excitation; `LinearSystemError` for what is no filter.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
    >>> definition = it.TyreLoad(it.Road(5e-7, 25.0)).definition(car.mechanism())
    >>> definition.unit, [each.output for each in definition.outputs]
    ('N', ['tyre_load'])
    """

    outputs: tuple[OutputWeight, ...]
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
        """Filter of each output, None without one."""
        return cast(tuple[Filter | None, ...], self.filter)

    @property
    def drive(self) -> Excitation:
        """Excitation of the mechanism."""
        return cast(Excitation, self.excitation)

    arrivals = RenamedAttribute("input_paths")

    @property
    def is_peak(self) -> bool:
        """Whether the index is a peak gain; else it is made of r.m.s. values."""
        return self.combination is Combination.PEAK_GAIN

    def describe(self, mechanism: Mechanism) -> str:
        """Description: how outputs are combined, or from which input a gain is; `mechanism` as for `definition`.

        >>> import inerter as it
        >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0)).mechanism()
        >>> it.TyreLoad(it.Road(5e-7, 25.0)).definition(car).describe(car)
        'r.m.s. value of tyre load'
        >>> it.LoadCarrying().definition(car).describe(car)
        'largest gain over frequency from sprung force to sprung displacement'
        """
        excited = self.drive.excited_mechanism(mechanism)
        outputs = [
            f"{_factor(one.weight, self.unit, unit_of(excited, [one.output]))}{'filtered ' * (passed is not None)}"
            f"{in_words(one.output)}"
            for one, passed in zip(self.outputs, self.filters, strict=True)
        ]
        listed = format_list(outputs)
        if self.is_peak:
            inputs = format_list([*map(in_words, inputs_of(self.input_paths(mechanism)))])
            return f"largest gain over frequency from {inputs} to {listed}"
        if len(outputs) == 1:
            return f"r.m.s. value of {listed}"
        of = "sum" if self.combination is Combination.SUM_OF_RMS else "root of the sum of the squares"
        return f"{of} of the r.m.s. values of {listed}"

    def combine(self, rms: Array, weights: Array) -> Array:
        """Index from r.m.s. values (..., outputs) and weights (outputs,)."""
        if self.combination is Combination.ROOT_OF_SQUARES:
            return np.asarray(np.sqrt(rms**2 @ weights**2))
        return np.asarray(rms.dot(weights))  # `@` takes thrice as long for few outputs

    def slopes(self, rms: Array, weights: Array) -> Array:
        """Derivatives of the combined index with respect to the r.m.s. values (outputs,)."""
        if self.combination is Combination.ROOT_OF_SQUARES:
            return np.asarray(weights**2 * rms / max(float(self.combine(rms, weights)), 1e-300))
        return weights

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        """Input paths of the excitation in the order of their delays; `mechanism` is the excited one."""
        return tuple(sorted(self.drive.input_paths(mechanism), key=lambda path: path.delay))

    def excite(self, mechanism: Mechanism) -> ExcitedIndex:
        """The definition with `mechanism` as excited, and the input paths there."""
        excited = self.drive.excited_mechanism(mechanism)
        return ExcitedIndex(self, mechanism, excited, self.input_paths(excited))


@dataclass(frozen=True, eq=False)
class ExcitedIndex:
    """An index definition for a mechanism, that mechanism as excited, and the input paths of the excitation."""

    definition: IndexDefinition
    mechanism: Mechanism
    excited: Mechanism
    paths: tuple[InputPath, ...]


def _factor(weight: float, unit: str, of: str) -> str:
    """The weight of an output in the unit `of`, in an index in `unit`; empty for one."""
    if weight == 1.0:
        return ""
    return f"{format_quantity(weight, combine_units(unit or PURE, '/', of or PURE))} times "


class DescribedIndex(Protocol):
    """Description of an index for reports: its symbol, title, unit and frequency response."""

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
        """Frequency response of the index, in words."""
        ...


class Index(DescribedIndex, Protocol):
    """Index: symbol, title, unit, and its definition for a given mechanism."""

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """Definition for `mechanism`; raises `PerformanceIndexError` if the mechanism has no answer."""
        ...


def quantity_words(index: DescribedIndex) -> str:
    """Quantity of which an index is a value: its `quantity`, such as "r.m.s. suspension travel", else its title.

    >>> import inerter as it
    >>> quantity_words(it.TyreLoad(it.Road(5e-7, 25.0)))
    'r.m.s. dynamic tyre load'
    """
    return str(getattr(index, "quantity", index.title))


@dataclass(frozen=True)
class OfIndex:
    """Base of composed indices with the symbol, unit and frequency response of one index."""

    index: Any

    @property
    def symbol(self) -> str:
        """Symbol of the index."""
        return str(self.index.symbol)

    @property
    def quantity(self) -> str:
        """Quantity of the index in words, with the rest of the own title."""
        return str(self.title).replace(self.index.title, quantity_words(self.index), 1)  # type: ignore[attr-defined]

    @property
    def unit(self) -> str:
        """Unit of the index."""
        return str(self.index.unit)

    @property
    def response(self) -> str:
        """Frequency response of the index, in words."""
        return str(self.index.response)


class OnRoad(Index, Protocol):
    """Index with a road or random excitation as an argument."""

    @property
    def road(self) -> Road | Excitation:
        """Road at all wheels, or a random excitation in its place."""
        ...


@checked(PerformanceIndexError)
def on_road(
    index: OnRoad,
    mechanism: Mechanism,
    outputs: tuple[OutputWeight, ...],
    where: str,
    filter: Given | tuple[Given, ...] = None,
    combination: Combination = Combination.SUM_OF_RMS,
) -> IndexDefinition:
    """Definition of an index of r.m.s. values on a road; the values are summed by default.

    Raises `PerformanceIndexError` if there is no road, or if `outputs`, which the mechanism gives at `where`, are none.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0)).mechanism()
    >>> index = it.SuspensionTravel(it.Road(5e-7, 25.0))
    >>> it.on_road(index, car, (it.OutputWeight("strut_travel"),), "struts").unit
    'm'
    """
    road = getattr(index, "road", None)
    if isinstance(road, type) or not (isinstance(road, Road) or getattr(road, "is_random", False)):
        what = getattr(index, "symbol", f"The index {index!r}")
        raise PerformanceIndexError(f"{what} needs a Road(roughness=..., speed=...), got {road!r}.")
    if isinstance(index.road, Road) and not mechanism.roads:
        raise PerformanceIndexError(f"{index.symbol} requires a road, and this mechanism has no tyre. Add a tyre.")
    if not outputs:
        loads = [of_mount(tyre)[0] for tyre in mechanism.tyres]
        moving = [f"{one.name}_acceleration" for one in mechanism.coordinates]
        example = {"measures.tyre_load": loads, "measures.comfort": moving[:1]}.get(where)
        such = f", such as {format_list(example)}" if example else ""
        raise PerformanceIndexError(f"The mechanism does not define the outputs of {index.symbol}. Set {where}{such}.")
    return IndexDefinition(outputs, combination, index.road, index.unit, filter)
