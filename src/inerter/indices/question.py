"""What an index is, and the question that it puts to a mechanism: excitation, outputs, filters, how they combine.

A method reads a `Question` and never asks which index it came from.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

from inerter.errors import IndicatorError
from inerter.signals.road import Road
from inerter.vehicle.mechanism import Mechanism, Weighted


class Combination(Enum):
    """How the outputs make one number."""

    SUM_OF_RMS = auto()  # r.m.s. values of the weighted outputs, added up
    PEAK_GAIN = auto()  # largest gain over all frequencies


@dataclass(frozen=True)
class Question:
    """An index put to one mechanism."""

    inputs: tuple[str, ...]
    outputs: tuple[Weighted, ...]
    combination: Combination
    road: Road | None  # whose velocity drives all inputs, each with its delay; None: a unit force
    unit: str
    high_pass: float | None = None  # corner [rad/s] of a filter s/(s + a) on every output
    over_s: bool = False  # whether its definition divides by s, where paper2008 divides by s + a
    amplitude: float | None = None  # of the force [N], for methods that see nonlinear elements


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
        """What it asks of `mechanism`; raises `IndicatorError` if the mechanism has no answer."""
        ...


class OnRoad(Index, Protocol):
    """An index that is asked on a road."""

    @property
    def road(self) -> Road:
        """The road that all wheels pass."""
        ...


def on_road(
    index: OnRoad,
    mechanism: Mechanism,
    outputs: tuple[Weighted, ...],
    where: str,
    high_pass: float | None = None,
    over_s: bool = False,
) -> Question:
    """The question of an index that is a sum of r.m.s. values on a road.

    Raises `IndicatorError` if there is no road, or if `outputs`, which the mechanism gives at `where`, are none.
    """
    if not isinstance(index.road, Road):
        raise IndicatorError(f"{index.symbol} needs a Road(roughness=..., speed=...), got {index.road!r}.")
    if not mechanism.roads:
        raise IndicatorError(f"{index.symbol} is driven by a road, and this mechanism stands on none. Add a tyre.")
    if not outputs:
        raise IndicatorError(f"The mechanism does not say which outputs {index.symbol} is about. Set {where}.")
    return Question(
        inputs=tuple(road.name for road in mechanism.roads),
        outputs=outputs,
        combination=Combination.SUM_OF_RMS,
        road=index.road,
        unit=index.unit,
        high_pass=high_pass,
        over_s=over_s,
    )
