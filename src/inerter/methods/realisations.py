"""Random roads that all designs share, and the response of a design to them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.formatting import format_quantity
from inerter.indices.definition import IndexDefinition
from inerter.methods.linear import Conventions
from inerter.methods.steady_squares import Squares, steady_squares
from inerter.signals.harmonics import Harmonics, multisine
from inerter.signals.road import Road
from inerter.signals.signal import Signal
from inerter.simulation.initial_state import initial_state
from inerter.simulation.inputs import InputTable, check_holds, parts_of, tabulate
from inerter.simulation.periodic_steady_state import FEW_PERIODS
from inerter.systems.filters import Filter
from inerter.systems.input_paths import InputPath
from inerter.systems.outputs import input_names
from inerter.systems.piecewise import PiecewiseSystem

Array = NDArray[np.float64]
STEP = 2e-4  # [s] of continuous roads: errors of 1e-6
PERIOD = 10  # [s] of a road, if that does
_KEPT = 48  # tables, of 4 MB each
_FEWEST_PERIODS = 4  # of the longest roads, until they must repeat


@dataclass(frozen=True)
class RandomExcitation:
    """Random excitation of a mechanism: input paths of each input, and duration.

    Each is the velocity of a road: a white force or acceleration is as much, in its own unit.
    """

    road: Road  # of each source
    reached: tuple[tuple[InputPath, ...], ...]  # of each input, roads before forces; none where it is at rest
    roads: int  # inputs that are roads
    hold: float | None  # [s] of roads, where they are held
    period: int = PERIOD  # of a realisation [s]

    @property
    def delays(self) -> tuple[float, ...] | None:
        """Delay of the road at each road input [s]; None if the excitation is more than one road."""
        if not _one_road(self.reached, self.roads):
            return None
        return tuple(one[0].delay for one in self.reached[: self.roads])

    @property
    def sources(self) -> tuple[str, ...]:
        """Names of the sources."""
        return tuple(dict.fromkeys(path.source for one in self.reached for path in one))

    def signal(self, seed: int, source: int = 0) -> Harmonics:
        """Realisation of a source as a road, before the hold."""
        own = seed if source == 0 else int(np.random.SeedSequence([seed, source]).generate_state(1, np.uint64)[0])
        return multisine(self.road, own, lowest=1.0 / self.period)

    def input_signals(self, seed: int) -> list[Harmonics | None]:
        """Inputs in one realisation: displacements of roads, and forces; None for an input at rest."""
        signals = {name: self.signal(seed, i) for i, name in enumerate(self.sources)}
        return [
            self._sum(paths, signals, velocity=i >= self.roads) if paths else None
            for i, paths in enumerate(self.reached)
        ]

    def _sum(self, paths: Sequence[InputPath], signals: Mapping[str, Harmonics], velocity: bool) -> Harmonics:
        """The sum of what arrives; a force is what the velocity of a road is."""
        first = next(iter(signals.values()))
        omega = 2.0 * np.pi * first.frequencies
        total = sum(factor_of(a, omega) * signals[a.source].coefficient for a in paths)
        return replace(first, coefficient=np.asarray(total * (1j * omega if velocity else 1.0)), speed=None)


def factor_of(path: InputPath, omega: Array) -> NDArray[np.complex128]:
    """Complex gain of an input path at `omega` [rad/s]."""
    passed: Any = 1.0 if path.filter is None else path.filter.response(omega)
    if path.excess is not None:
        passed = passed * path.excess.factor(omega)
    return np.asarray(path.lever * passed * np.exp(-1j * omega * path.delay))


def _one_road(reached: Sequence[Sequence[InputPath]], roads: int) -> bool:
    """Whether one source is the road of all road inputs, and no force acts."""
    on_roads = [path for one in reached[:roads] for path in one]
    alone = all(len(one) == 1 for one in reached[:roads]) and not any(reached[roads:])
    return alone and all(a.plain for a in on_roads) and len({a.source for a in on_roads}) == 1


def random_excitation(
    system: PiecewiseSystem, definition: IndexDefinition, conventions: Conventions, period: int | None = None
) -> RandomExcitation:
    """Random excitation of `system` by an index, with realisations of the default length or of `period` [s].

    What is held under some conventions is a road that is the same for all wheels.
    """
    mechanism, size = system.mechanism, definition.drive.amplitude_density
    paths = definition.input_paths(mechanism)
    reached = tuple(tuple(a for a in paths if a.input == name) for name in input_names(mechanism))
    road = getattr(definition.drive, "road", None) or Road((size / (2.0 * math.pi)) ** 2, 1.0)
    roads = len(mechanism.roads)
    return RandomExcitation(
        road, reached, roads, conventions.hold if _one_road(reached, roads) else None, period or PERIOD
    )


def table(excitation: RandomExcitation, seed: int) -> InputTable:
    """Input table over one period of a realisation."""
    return _kept_table(excitation, seed) if excitation.period <= PERIOD else _table(excitation, seed)


def _table(excitation: RandomExcitation, seed: int) -> InputTable:
    if excitation.delays is None:
        moved = excitation.input_signals(seed)
        return tabulate(moved, [0.0] * len(moved), excitation.signal(seed).period, STEP)
    signal, rest = excitation.signal(seed), len(excitation.reached) - excitation.roads
    road = signal if excitation.hold is None else signal.held(excitation.hold)
    signals = [*(road for _ in excitation.delays), *(None for _ in range(rest))]
    delays = [*excitation.delays, *(0.0 for _ in range(rest))]
    parts = 1 if excitation.hold is None else parts_of(excitation.hold, excitation.delays)
    return tabulate(signals, delays, signal.period, (excitation.hold or STEP) / parts, every=parts)


_kept_table = lru_cache(maxsize=_KEPT)(_table)


def check_held_roads(system: PiecewiseSystem, excitation: RandomExcitation) -> None:
    """Raises `SimulationError` if the mechanism cannot be driven over roads that are held."""
    if excitation.hold is not None:
        held = Signal(label=f"a road held for {format_quantity(excitation.hold, 's', 6)}", hold="zero")
        check_holds(system, [held for _ in range(excitation.roads)])


def run(
    system: PiecewiseSystem,
    excitation: RandomExcitation,
    outputs: Sequence[str],
    filters: Sequence[Filter | None],
    on_road: tuple[int, Array | None],
    *,
    spectra: Sequence[str] = (),
) -> Squares:
    """Mean squares of the steady state on the road of a seed, from a state or from rest.

    The first outputs pass through `filters`.
    """
    seed, begin = on_road
    inputs = table(excitation, seed)
    state = initial_state(system, inputs.value[0], "rest") if begin is None else begin
    most = max(_FEWEST_PERIODS, round(FEW_PERIODS * PERIOD / excitation.period))
    return steady_squares(system, inputs, outputs, filters, state, most, spectra=spectra)


def realisation_seeds(seed: int, first: int, stop: int) -> list[int]:
    """Seeds of the realisations `first`, ..., `stop` - 1 of a method's seed."""
    return [int(np.random.SeedSequence([seed, r]).generate_state(1, np.uint64)[0]) for r in range(first, stop)]
