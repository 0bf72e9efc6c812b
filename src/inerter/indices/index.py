"""Indices as data: what is excited, which outputs with which weights and filters, and how they combine.

A method reads a `Question` and never asks which index it came from.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

from inerter.checks import check_positive
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


@dataclass(frozen=True)
class RideComfort:
    """J1: r.m.s. body acceleration on a road [m/s^2].

    Quarter car: 2 pi sqrt(V kappa) times the H2 norm from road velocity to body acceleration. Half car: bounce plus
    pitch times the mean lever (l_f + l_r)/2, each with its own norm. Source: Wang and Su (2008), eq. (4).
    """

    road: Road
    symbol = "J1"
    title = "ride comfort"
    unit = "m/s^2"
    response = "body acceleration per road velocity"

    def question(self, mechanism: Mechanism) -> Question:
        """Raises `IndicatorError` if the mechanism has no road or says nothing of comfort."""
        return _on_road(self, mechanism, mechanism.measures.comfort, "measures.comfort")


@dataclass(frozen=True)
class TyreLoad:
    """J3: r.m.s. dynamic tyre force on a road [N], added up over the tyres.

    `high_pass` puts a filter s/(s + high_pass), in rad/s, on every tyre force; the paper does so for the half car.
    Source: Wang and Su (2008), eq. (5).
    """

    road: Road
    high_pass: float | None = None
    symbol = "J3"
    title = "dynamic tyre load"
    unit = "N"
    response = "tyre force per road velocity"

    def __post_init__(self) -> None:
        if self.high_pass is not None:
            check_positive(IndicatorError, "The high-pass corner of the tyre load", self.high_pass, "rad/s")

    def question(self, mechanism: Mechanism) -> Question:
        """Raises `IndicatorError` if the mechanism has no road or names no tyre load."""
        return _on_road(
            self, mechanism, mechanism.measures.tyre_load, "measures.tyre_load", high_pass=self.high_pass, over_s=True
        )


@dataclass(frozen=True)
class LoadCarrying:
    """J5: largest gain from a force on the body to its displacement, over all frequencies [m/N].

    Half car: bounce force to bounce displacement. `amplitude` is that of a sinusoidal force [N]: what a design with
    friction or gaps does depends on it, what a linear one does not. Source: Wang and Su (2008), eq. (6).

    Raises `IndicatorError` unless the amplitude is positive.
    """

    amplitude: float | None = None
    symbol = "J5"
    title = "dynamic load carrying"
    unit = "m/N"
    response = "body displacement per force on the body"

    def __post_init__(self) -> None:
        if self.amplitude is not None:
            check_positive(IndicatorError, "The amplitude of the force on the body", self.amplitude, "N")

    def question(self, mechanism: Mechanism) -> Question:
        """Raises `IndicatorError` if the mechanism names no force and displacement for it."""
        measures = mechanism.measures
        if measures.load_input is None or measures.load_output is None:
            raise IndicatorError(
                "The mechanism does not say which force and displacement load carrying is about. "
                "Set measures.load_input and measures.load_output."
            )
        return Question(
            inputs=(measures.load_input,),
            outputs=(Weighted(measures.load_output),),
            combination=Combination.PEAK_GAIN,
            road=None,
            unit=self.unit,
            amplitude=self.amplitude,
        )


def _on_road(
    index: RideComfort | TyreLoad,
    mechanism: Mechanism,
    outputs: tuple[Weighted, ...],
    where: str,
    high_pass: float | None = None,
    over_s: bool = False,
) -> Question:
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
