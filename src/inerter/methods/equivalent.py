"""A mechanism whose frictions are dampers: what statistical linearisation and harmonic balance share.

Either closure asks for dampers c whose force has a given size, c |v(c)| = limit, where |v| is the r.m.s. or the
amplitude of the velocity across the friction. That force is limit v / |v|, of fixed size and against the motion; on the
space of stationary (or sinusoidal) motions it is a monotone law, and a passive mechanism is one too, so there is one
solution for any number of frictions. Where the force through a rigid link would be smaller than the limit, the
friction sticks and c is infinite.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, PerformanceIndexError, Status, StatusKind, with_article
from inerter.formatting import format_share
from inerter.indices.definition import IndexDefinition
from inerter.networks.elements import (
    CombinedNetwork,
    Damper,
    Element,
    Free,
    Friction,
    Gap,
    Network,
    Series,
    Tied,
    Value,
    middle,
)
from inerter.networks.elements.roles import LinearRole, StatisticalRole
from inerter.networks.transform import map_elements
from inerter.systems.descriptor import Descriptor, close, describe
from inerter.systems.graph import full_graph, linear_graph, switching
from inerter.systems.input_paths import InputPath, apply_excitation, inputs_of
from inerter.systems.outputs import force_of, stroke_of, velocity_of
from inerter.systems.structure import once_per_structure
from inerter.vehicle.mechanism import Mechanism, Strut, Tyre

Array = NDArray[np.float64]
Roles = Collection[LinearRole]
PROMISE = 0.03  # relative error of a value that is ok, what stands in for its excitation apart
POORLY = "is poorly represented by one damper: the error may exceed 3 %"
STIFFEST = 1e6  # dampers beyond so many times a typical one stand for rigid links too


@dataclass(frozen=True, eq=False)
class Equivalent:
    """Mechanism with a free damper in place of each friction that can move, and the frictions replaced."""

    mechanism: Mechanism
    dampers: tuple[str, ...]  # names of the dampers, as free values and as elements
    numbers: tuple[int, ...]  # which of all frictions with a force each of them stands for
    frictions: tuple[str, ...]  # in words, for each damper
    locked: tuple[str, ...]  # in words, those replaced by a rigid link instead
    forces: tuple[Value, ...]  # of each friction [N], or the free value that has this one, ...
    gains: tuple[float, ...]  # ... times its gain
    springy: tuple[bool, ...]  # which are in series with a spring: see `_is_behind_spring`
    undamped: tuple[bool, ...]  # which are in series with springs alone, and with no damper
    design: tuple[str, ...]  # free values of the mechanism that it stands for
    scale: float  # a damping typical of the mechanism [N s/m]

    def limits(self, points: Array) -> Array:
        """Friction forces (designs, frictions) [N] at each row of `points`, the values of the design."""
        result = np.empty((points.shape[0], len(self.forces)))
        for i, (force, gain, place) in enumerate(zip(self.forces, self.gains, self.places, strict=True)):
            assert not isinstance(force, Tied)
            result[:, i] = gain * (points[:, place] if isinstance(force, Free) else force)
        return result

    @cached_property
    def places(self) -> tuple[int, ...]:
        """Position of each friction force among the values of the design; -1 for a fixed force."""
        names = [force.name if isinstance(force, Free) else None for force in self.forces]
        return tuple(-1 if name is None else self.design.index(name) for name in names)

    def order(self, descriptor: Descriptor) -> list[int]:
        """Position of each free value of `descriptor` in (values of the design, dampers)."""
        known = (*self.design, *self.dampers)
        return [known.index(name) for name in descriptor.free]

    def check_idle(self, descriptor: Descriptor) -> None:
        """Raises `DesignError` if a free value is neither in `descriptor` nor the force of a friction."""
        seen = {*descriptor.free, *(self.design[i] for i in self.places if i >= 0)}
        idle = ", ".join(name for name in self.design if name not in seen)
        if idle:
            raise DesignError(
                f"The free value of {idle} has no effect: its element cannot move in parallel with a closed gap, or "
                "carries "
                f"no force. Fix it, or leave the element out."
            )


def poorly_represented(what: str, bound: float) -> Status:
    """Status inaccurate because of `what`, with the error bound if below 1."""
    most, promised = (format_share(share, 2) for share in (bound, PROMISE))
    most = f", but not {most}" if bound < 1.0 and most != promised else ""
    return Status(StatusKind.INACCURATE, f"{what} {POORLY}{most}. Simulate it, as expected-value does")


def check_damped(mechanism: Mechanism) -> None:
    """Raises `PerformanceIndexError` for what switches and is no dry friction, such as a gap with backlash."""
    for mount in switching(mechanism).mounts():
        for element in mount.network.elements():
            if element.acts and not element.is_damped:
                vanishes = element.may_vanish and not element.with_value(0.0).acts
                zero = f", or give it a {element.quantity.replace('_', ' ')} of 0" if vanishes else ""
                raise PerformanceIndexError(
                    f"Statistical linearisation treats dry friction, but {element.label!r} in {mount.name!r} is "
                    f"{with_article(element.key)}. Use expected-value or approximate-linear, which simulate it{zero}."
                )


def check_outputs(mechanism: Mechanism, names: Collection[str]) -> None:
    """Raises `PerformanceIndexError` for the stroke, velocity or force of a friction: a damper has its place."""
    branches = full_graph(mechanism).branches
    frictions = [branch.label for branch in branches if branch.element.statistical is StatisticalRole.DAMPER]
    told = {called(label) for label in frictions for called in (force_of, velocity_of, stroke_of)}
    for name in names:
        if name in told:
            raise PerformanceIndexError(
                f"Statistical linearisation does not give {name!r}: it replaces the friction by a damper. "
                f"Use expected-value or approximate-linear, which simulate it."
            )


def has_friction(mechanism: Mechanism) -> bool:
    """Whether any friction has a force."""
    return any(element.is_damped for element in switching(mechanism).elements())


def equivalent(mechanism: Mechanism, without: Collection[str] = (), locked: Collection[str] = ()) -> Equivalent:
    """Mechanism with a free damper in place of each friction.

    Those in `without` are left out, those in `locked` become rigid links (both named by their damper). A friction
    beside a rigid link cannot move and is left out too.

    Raises `MechanismError` for what is ill-posed.
    """
    mechanism = switching(mechanism)
    scale = _typical_damping(mechanism)
    taken = {element.label for element in mechanism.elements()}
    found: dict[str, tuple[str, Element]] = {}

    def replace_frictions(mount: Strut | Tyre) -> Network:
        def to_damper(element: Element) -> Network:
            if not element.is_damped:
                return element
            name = f"equivalent_damper_{len(found) + 1}"
            while name in taken:
                name += "_"
            found[name] = (f"{element.key} {element.label!r} in {mount.name!r}", element)
            if name in without:
                return Friction(0.0, element.label)
            if name in locked:
                return Gap(0.0, name)
            return Damper(Free(1e-3 * scale, 1e3 * scale, name), name)

        return map_elements(mount.network, to_damper)

    other = mechanism.with_networks(replace_frictions)
    moving = _linear_labels(other)
    names = tuple(name for name in found if name in moving)
    frictions = [found[name][1] for name in names]
    springy, undamped = (
        {id(element) for mount in mechanism.mounts() for element in _in_series(mount.network, is_wanted)}
        for is_wanted in (_is_behind_spring, _is_on_springs_alone)
    )
    return Equivalent(
        mechanism=other,
        dampers=names,
        numbers=tuple(list(found).index(name) for name in names),
        frictions=tuple(found[name][0] for name in names),
        locked=tuple(words for name, (words, _) in found.items() if name in locked),
        forces=tuple(e.value if isinstance(e.value, Free) else e.coefficient for e in frictions),
        gains=tuple(e.gain if isinstance(e.value, Free) else 1.0 for e in frictions),
        springy=tuple(id(element) in springy for element in frictions),
        undamped=tuple(id(element) in undamped for element in frictions),
        design=tuple(mechanism.free_values()),
        scale=scale,
    )


@once_per_structure
def _linear_labels(mechanism: Mechanism) -> frozenset[str]:
    """Labels of the elements that the linear model has."""
    return frozenset(branch.label for branch in linear_graph(mechanism).branches)


def _is_behind_spring(roles: Roles, others: Roles) -> bool:
    """Whether a part is without inerters and in series with a spring.

    A friction there sticks while the spring moves (a Jenkins element), for as long as a slow force takes to reach it;
    the force through an inerter changes at once.
    """
    return LinearRole.STIFFNESS in others and LinearRole.MASS not in roles


def _is_on_springs_alone(roles: Roles, others: Roles) -> bool:
    """Whether nothing but springs is in series with a part: such a spring rings after each reversal."""
    return others == {LinearRole.STIFFNESS}


def _in_series(network: Network, is_wanted: Callable[[Roles, Roles], bool]) -> Iterator[Element]:
    """Elements of parts that are in series with others, wanted by the roles in the part and in the others."""
    if not isinstance(network, CombinedNetwork):
        return
    roles = [{element.linear for element in part.elements()} for part in network.parts]
    for i, part in enumerate(network.parts):
        others = set().union(*(own for j, own in enumerate(roles) if j != i))
        if isinstance(network, Series) and is_wanted(roles[i], others):
            yield from part.elements()
        else:
            yield from _in_series(part, is_wanted)


def slipping_freely(mechanism: Mechanism, definition: IndexDefinition) -> frozenset[str]:
    """Names of dampers of frictions with direct feedthrough from white noise, as of one in a tyre on a road.

    With a velocity of infinite variance across them, they are zero. What has a mass on both sides cannot be reached so.
    """
    driven = switching(definition.drive.excited_mechanism(mechanism))
    paths = definition.input_paths(driven)
    if not any(element.is_damped for mount in _reachable(driven, paths) for element in mount.network.elements()):
        return frozenset()
    found: frozenset[str] = frozenset()
    while True:
        parts = equivalent(driven, found)
        velocities = [velocity_of(name) for name in parts.dampers]
        reached = _reached_directly(apply_excitation(describe(parts.mechanism, inputs_of(paths), velocities), paths))
        if not reached:
            return found
        found |= {parts.dampers[i] for i in reached}


def _reachable(mechanism: Mechanism, paths: Sequence[InputPath]) -> list[Strut | Tyre]:
    """Mounts connected to excited roads; forces act on masses, whose velocity has no jumps."""
    roads = {road.name for road in mechanism.roads} & {path.input for path in paths}
    return [m for m in mechanism.mounts() if roads & ({m.road} if isinstance(m, Tyre) else {*m.upper, *m.lower})]


def _reached_directly(descriptor: Descriptor) -> list[int]:
    """Numbers of the outputs with direct feedthrough from white noise."""
    halfway = {name: middle(free) for name, free in descriptor.free.items()}
    return [int(i) for i in np.flatnonzero(np.any(close(descriptor, halfway).D != 0.0, axis=1))]


def _typical_damping(mechanism: Mechanism) -> float:
    """Root of the largest stiffness times the largest inertia: the impedance at a natural frequency."""
    elements = list(mechanism.elements())
    springs = [e.gain * _size(e.value) for e in elements if e.linear is LinearRole.STIFFNESS]
    inertias = [_size(coordinate.inertia) for coordinate in mechanism.coordinates]
    dampers = [e.gain * _size(e.value) for e in elements if e.linear is LinearRole.DAMPING]
    if springs and inertias:
        return math.sqrt(max(springs) * max(inertias))
    return max(dampers, default=1e3)


def _size(value: Value) -> float:
    assert not isinstance(value, Tied)
    return math.sqrt(value.lower * value.upper) if isinstance(value, Free) else value
