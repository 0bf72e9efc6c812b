"""Random roads laid out once, and what designs do on them: the same roads for every design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, Status
from inerter.indices.question import Question
from inerter.methods.linear import Conventions
from inerter.methods.steady_squares import steady_squares
from inerter.signals.harmonics import Harmonics, multisine
from inerter.signals.road import Road
from inerter.signals.signal import Signal
from inerter.simulation.inputs import InputTable, check_holds, parts_of, tabulate
from inerter.simulation.start import initial_state
from inerter.simulation.steady import FEW_PERIODS
from inerter.systems.filters import Filter
from inerter.systems.piecewise import PiecewiseSystem

Array = NDArray[np.float64]
STEP = 2e-4  # [s] of continuous roads: errors of 1e-6
PERIOD = 10  # [s] of a road, if that does
_KEPT = 48  # tables, of 4 MB each
_FEWEST_PERIODS = 4  # of the longest roads, until they must repeat


@dataclass(frozen=True)
class RoadDrive:
    """How a mechanism is driven over a road: the speed, when the road reaches each wheel, and the conventions."""

    road: Road
    delays: tuple[float, ...]  # of each road input [s]
    forces: int  # external forces, which stay zero
    hold: float | None  # [s]
    period: int = PERIOD  # of a realisation [s]

    def signal(self, seed: int) -> Harmonics:
        """The road of one realisation, before it is held."""
        return multisine(self.road, seed, lowest=1.0 / self.period)


@dataclass(frozen=True)
class Ran:
    """One period of the steady state on one road."""

    power: Array  # mean squares of the filtered outputs and of those without a filter, nan where there are none
    status: Status
    periods: int  # until it repeated


def drive(
    system: PiecewiseSystem, question: Question, conventions: Conventions, period: int | None = None
) -> RoadDrive:
    """How `question` drives the mechanism of `system`, over roads of the usual length or of another `period` [s]."""
    assert question.road is not None
    mechanism, road = system.mechanism, question.road
    delays = np.array([r.distance for r in mechanism.roads]) / road.speed
    return RoadDrive(road, tuple(delays.tolist()), len(mechanism.forces), conventions.hold, period or PERIOD)


def table(way: RoadDrive, seed: int) -> InputTable:
    """One period of a realisation along the knots of an integration."""
    return _kept_table(way, seed) if way.period <= PERIOD else _table(way, seed)


def _table(way: RoadDrive, seed: int) -> InputTable:
    signal = way.signal(seed)
    moved = signal if way.hold is None else signal.held(way.hold)
    signals = [*(moved for _ in way.delays), *(None for _ in range(way.forces))]
    delays = [*way.delays, *(0.0 for _ in range(way.forces))]
    parts = 1 if way.hold is None else parts_of(way.hold, way.delays)
    return tabulate(signals, delays, signal.period, (way.hold or STEP) / parts, every=parts)


_kept_table = lru_cache(maxsize=_KEPT)(_table)


def check_drive(system: PiecewiseSystem, way: RoadDrive) -> None:
    """Raises `SimulationError` if the mechanism cannot be driven over roads that are held."""
    if way.hold is not None:
        held = Signal(label=f"a road held for {way.hold:g} s", hold="zero")
        check_holds(system, [held for _ in way.delays])


def run(
    system: PiecewiseSystem, way: RoadDrive, outputs: Sequence[str], filters: Sequence[Filter | None], seed: int
) -> Ran:
    """One period of the steady state on the road of a realisation's seed; the first outputs pass through filters."""
    inputs = table(way, seed)
    state = initial_state(system, inputs.value[0], "rest")
    most = max(_FEWEST_PERIODS, round(FEW_PERIODS * PERIOD / way.period))
    return Ran(*steady_squares(system, inputs, outputs, filters, state, most))


def realisation_seeds(seed: int, first: int, stop: int) -> list[int]:
    """Seeds of the realisations `first`, ..., `stop` - 1 of a method's seed."""
    return [int(np.random.SeedSequence([seed, r]).generate_state(1, np.uint64)[0]) for r in range(first, stop)]


def worst(found: Sequence[Status]) -> Status:
    """The first status that is not ok."""
    return next((status for status in found if not status.ok), OK)
