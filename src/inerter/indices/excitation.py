"""Excitations of a mechanism in an index: road, force, ground, each with an optional filter, or a single input.

An excitation says which mechanism it drives, and how its sources, independent white noises of one intensity, arrive at
the inputs of that mechanism. Methods know no more of it than that, so that a new one is a class with a few lines.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Protocol

from inerter.deprecation import RenamedAttribute, adopt_renamed
from inerter.errors import ErrorSource, PerformanceIndexError
from inerter.signals.coherence import Coherence
from inerter.signals.road import Road, RoadShape
from inerter.systems.filters import Filter, as_filter
from inerter.systems.input_paths import InputPath
from inerter.systems.linear import LinearSystem
from inerter.systems.outputs import check_inputs
from inerter.validation import check_positive, use_python_numbers
from inerter.vehicle.mechanism import GROUND_ACCELERATION, Mechanism
from inerter.vehicle.symmetry import half_of

_VELOCITY, _ACCELERATION = "m/s", "m/s^2"


class FormerNames:
    """Names that the attributes of excitations had in the previous version."""

    size = RenamedAttribute("amplitude_density")
    arrivals = RenamedAttribute("input_paths")
    stand_ins = RenamedAttribute("error_sources")


class Excitation(Protocol):
    """Excitation of a mechanism by one or more sources.

    >>> import inerter as it
    >>> push = it.WhiteForce("push", intensity=4.0)  # N^2/Hz
    >>> push.amplitude_density, push.is_random  # N/sqrt(Hz); what every excitation has
    (2.0, True)
    """

    @property
    def amplitude_density(self) -> float:
        """Root of the two-sided spectral density of each source, in its unit per root of Hz."""
        ...

    @property
    def unit(self) -> str:
        """Unit of a source; empty if that depends on the mechanism."""
        ...

    @property
    def is_random(self) -> bool:
        """Whether the sources are white noises; else the excitation is one input, for gains."""
        ...

    def excited_mechanism(self, mechanism: Mechanism) -> Mechanism:
        """Mechanism as excited: unchanged, reduced by symmetry, or in coordinates relative to moving ground."""
        ...

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        """Input paths of the sources; raises `PerformanceIndexError` if the mechanism has none for it."""
        ...


@dataclass(frozen=True)
class RoadVelocity(FormerNames):
    """White-noise velocity of a road, at each wheel with its wheelbase delay."""

    road: Road
    unit = _VELOCITY
    is_random = True

    @property
    def amplitude_density(self) -> float:
        """2 pi sqrt(V kappa) [m/s per root of Hz]."""
        return self.road.velocity_intensity

    def excited_mechanism(self, mechanism: Mechanism) -> Mechanism:
        """Mechanism on one track, halved if symmetric, without a coherence; unchanged with one."""
        return half_of(mechanism.on_one_track()) if self.road.coherence is None else mechanism

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        """Input path at each road input; with a coherence two, from mean and half difference of the tracks."""
        if not mechanism.roads:
            raise PerformanceIndexError("A road excites a mechanism at its tyres, and this one has none.")
        if self.road.coherence is not None and any(r.side for r in mechanism.roads):
            return tuple(self._on_tracks(mechanism, self.road.coherence))
        return tuple(InputPath(r.name, "road", r.distance / self.road.speed) for r in mechanism.roads)

    def _on_tracks(self, mechanism: Mechanism, coherence: Coherence) -> Iterator[InputPath]:
        speed = self.road.speed
        ratios = {"tracks in phase": coherence.in_phase(speed), "tracks in anti-phase": coherence.in_anti_phase(speed)}
        parts = {source: None if ratio is None else Filter(*ratio) for source, ratio in ratios.items()}
        for road in mechanism.roads:
            if not road.side:
                raise PerformanceIndexError(
                    f"The road has two tracks with a coherence, and {road.name!r} is on neither of them. Set "
                    f'side = "left" or "right" (in files track), or leave the coherence out.'
                )
            for (source, shape), right in zip(parts.items(), (1.0, -1.0), strict=True):
                if shape is not None:
                    lever = right if road.side == "right" else 1.0
                    excess = coherence.excess(right, speed)
                    yield InputPath(road.name, source, road.distance / speed, lever, shape, excess=excess)


@dataclass(frozen=True)
class WhiteForce(FormerNames):
    """A white force on a port: an external force of the mechanism by name, of two-sided `intensity` [N^2/Hz].

    For a moment it is in (N m)^2/Hz.

    Raises `PerformanceIndexError` unless the intensity is positive and finite.

    >>> import inerter as it
    >>> it.WhiteForce("push", intensity=4.0).amplitude_density  # root of 4 N^2/Hz, a two-sided density
    2.0
    """

    name: str
    intensity: float
    unit = ""  # N, or of a moment N m
    is_random = True

    def __post_init__(self) -> None:
        use_python_numbers(self)
        if not isinstance(self.name, str):
            raise PerformanceIndexError(
                f"A white force requires the name of a force of the mechanism, got {self.name!r}."
            )
        check_positive(PerformanceIndexError, "The intensity of a white force", self.intensity, "N^2/Hz")

    @property
    def amplitude_density(self) -> float:
        """Root of the intensity."""
        return math.sqrt(self.intensity)

    def excited_mechanism(self, mechanism: Mechanism) -> Mechanism:
        """Mechanism as given."""
        return mechanism

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        """Input path at the force."""
        return (InputPath(_force(mechanism, self.name), self.name),)


@dataclass(frozen=True)
class GroundAcceleration(FormerNames):
    """White acceleration of the ground, vertically, of two-sided `intensity` [(m/s^2)^2/Hz], which acts on every mass.

    Roads lie still on the ground. Motions that stay bounded are those over the ground, `<coordinate>_relative_...`,
    and what follows from them; a `<coordinate>_acceleration` is the absolute one.

    Raises `PerformanceIndexError` unless the intensity is positive and finite.

    >>> import inerter as it
    >>> strut = it.Strut("columns", it.Spring(100.0) | it.Damper(7.0), upper={"floor": 1.0}, lower=it.GROUND)
    >>> floor = it.Mechanism(coordinates=(it.Coordinate("floor", 3.0),), struts=(strut,))
    >>> sway = it.RandomResponse({"floor_relative_displacement": 1.0}, it.GroundAcceleration(2.0))  # (m/s^2)^2/Hz
    >>> round(it.evaluate(floor, sway, it.Norm()).value ** 2, 9) == round(2.0 * 3.0**2 / (2 * 7.0 * 100.0), 9)
    True
    """

    intensity: float
    unit = _ACCELERATION
    is_random = True

    def __post_init__(self) -> None:
        use_python_numbers(self)
        check_positive(PerformanceIndexError, "The intensity of a ground acceleration", self.intensity, "(m/s^2)^2/Hz")

    @property
    def amplitude_density(self) -> float:
        """Root of the intensity."""
        return math.sqrt(self.intensity)

    def excited_mechanism(self, mechanism: Mechanism) -> Mechanism:
        """Mechanism in coordinates relative to the ground."""
        return mechanism.on_moving_ground()

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        """Input path at the ground acceleration, which acts on all masses."""
        if all(coordinate.angle for coordinate in mechanism.coordinates):
            raise PerformanceIndexError("Ground acceleration acts on masses, and this mechanism has none.")
        return (InputPath(GROUND_ACCELERATION, "ground"),)


@dataclass(frozen=True)
class FilteredExcitation(FormerNames):
    """An excitation whose sources pass through a filter before they arrive; its intensity is that before the filter.

    `filter` is a `Filter`, or a `LinearSystem` with one input and one output.

    Raises `PerformanceIndexError` for what is no random excitation, `LinearSystemError` for what is no filter.

    >>> import inerter as it
    >>> low_pass = it.Filter((1.0,), (0.5, 1.0))  # 1 / (0.5 s + 1)
    >>> soft = it.FilteredExcitation(it.WhiteForce("push", intensity=4.0), low_pass)
    >>> soft.is_random
    True
    """

    excitation: Road | Excitation
    filter: Filter | LinearSystem

    def __post_init__(self) -> None:
        of = as_excitation(self.excitation, "A shaping filter")
        if not of.is_random:
            raise PerformanceIndexError(f"A shaping filter requires a random excitation, got {of!r}.")
        shape = as_filter(self.filter)
        if shape is None:
            raise PerformanceIndexError("A shaped excitation needs a filter, such as Filter([1.0], [1.0, 2.0]).")
        object.__setattr__(self, "excitation", of)
        object.__setattr__(self, "filter", shape)

    @property
    def amplitude_density(self) -> float:
        """Root of the two-sided spectral density of each source, before the filter."""
        return self._of.amplitude_density

    @property
    def unit(self) -> str:
        """Unit of a source, before the filter."""
        return self._of.unit

    @property
    def is_random(self) -> bool:
        """True: only random excitations can be filtered."""
        return True

    @property
    def _of(self) -> Excitation:
        return as_excitation(self.excitation, "A shaping filter")

    def excited_mechanism(self, mechanism: Mechanism) -> Mechanism:
        """Mechanism as excited by the unfiltered excitation."""
        return self._of.excited_mechanism(mechanism)

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        """Input paths of the unfiltered excitation, each with the filter in series after its own."""
        shape = as_filter(self.filter)
        assert shape is not None
        return tuple(
            replace(a, filter=shape if a.filter is None else a.filter.then(shape))
            for a in self._of.input_paths(mechanism)
        )

    def error_sources(self, mechanism: Mechanism) -> tuple[ErrorSource, ...]:
        """Error sources of approximations in the unfiltered excitation."""
        return error_sources_of(self._of, mechanism)


@dataclass(frozen=True)
class SingleInput(FormerNames):
    """Single input, for gains: a force, a road's displacement, or `<road>_velocity`.

    >>> import inerter as it
    >>> push = it.SingleInput("sprung_force")  # of size one, at each frequency
    >>> push.amplitude_density, push.is_random
    (1.0, False)
    """

    name: str
    amplitude_density = 1.0
    unit = ""
    is_random = False

    def excited_mechanism(self, mechanism: Mechanism) -> Mechanism:
        """Mechanism as given."""
        return mechanism

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        """Input path at the input."""
        for road in mechanism.roads:
            if self.name == f"{road.name}_velocity":
                return (InputPath(road.name, self.name),)
            if self.name == road.name:
                return (InputPath(road.name, self.name, displacement=True),)
        check_inputs(mechanism, [self.name], PerformanceIndexError)
        return (InputPath(self.name, self.name),)


def as_excitation(given: object, what: str) -> Excitation:
    """`given`, a road or an excitation, as an excitation; raises `PerformanceIndexError` for anything else.

    `what` requires it, at the beginning of the sentence.
    """
    if isinstance(given, Road):
        return RoadVelocity(given)
    if not isinstance(given, type):
        adopt_renamed(given, arrivals="input_paths", size="amplitude_density", stand_ins="error_sources")
    if isinstance(given, type) or not hasattr(given, "input_paths"):
        raise PerformanceIndexError(
            f"{what} needs an excitation, such as Road(roughness=..., speed=...) or WhiteForce(name, intensity=...), "
            f"got {given!r}."
        )
    found: Excitation = given  # type: ignore[assignment]
    return found


def shape_of(excitation: Excitation) -> tuple[RoadShape, float] | None:
    """Measured shape of the road, and the speed on it [m/s]; None for a road without measurement."""
    of = road_of(excitation)
    shape = getattr(of, "shape", None)
    return (shape, of.speed) if isinstance(shape, RoadShape) else None


def road_of(excitation: Excitation) -> Any:
    """Road behind an excitation, perhaps through filters; the excitation itself if it is not a road."""
    of: Any = excitation
    while isinstance(of, FilteredExcitation | RoadVelocity):
        of = of.excitation if isinstance(of, FilteredExcitation) else of.road
    return of


def error_sources_of(excitation: Excitation, mechanism: Mechanism) -> tuple[ErrorSource, ...]:
    """Error sources of r.m.s. values from approximations of the excitation, such as a filter for a coherence.

    An excitation with such errors has a method `error_sources(mechanism)`.
    """
    error_sources = getattr(excitation, "error_sources", None)
    return () if error_sources is None else tuple(error_sources(mechanism))


def _force(mechanism: Mechanism, name: str) -> str:
    forces = [force.name for force in mechanism.forces if force.name != GROUND_ACCELERATION]
    if name not in forces:
        known = ", ".join(forces) or "none"
        raise PerformanceIndexError(f"Unknown force {name!r} of the mechanism; available: {known}.")
    return name
