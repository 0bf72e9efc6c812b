"""Half model of a symmetric mechanism, where one source excites both sides in phase or in antiphase."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from inerter.networks.elements.roles import LinearRole
from inerter.systems.filters import Filter
from inerter.systems.input_paths import InputPath
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.symmetry import antisymmetric_half, symmetric_half


def on_one_side(mechanism: Mechanism, paths: Sequence[InputPath]) -> tuple[Mechanism, tuple[InputPath, ...]] | None:
    """Half model with the motion of the whole, and its input paths; None if there is none.

    The two tracks must meet one source at the same times, with levers that are alike, or opposite, on every axle.
    """
    at = {path.input: path for path in paths}
    if len(at) < len(paths) or at.keys() != {road.name for road in mechanism.roads}:
        return None
    merged = mechanism.on_one_track()
    on = {own.road: one.road for own, one in zip(mechanism.tyres, merged.tyres, strict=True)}
    signs = {_sign(at[own], at[one]) for own, one in on.items() if own != one}
    if len(signs) != 1 or signs == {0.0}:
        return None
    alike = signs == {1.0}
    half = symmetric_half(merged) if alike else antisymmetric_half(mechanism)
    if len(half.coordinates) == len(mechanism.coordinates):
        return None
    arriving = tuple(at[road.name] for road in half.roads)
    springs = all(e.linear is LinearRole.STIFFNESS for tyre in half.tyres for e in tyre.network.elements())
    return half, tuple(map(_by_displacement, arriving)) if springs and not alike else arriving


def _sign(one: InputPath, other: InputPath) -> float:
    """Sign of the ratio of two input paths, 1 or -1; 0 if they are not proportional."""
    if replace(one, input=other.input, lever=other.lever) != other or abs(one.lever) != abs(other.lever):
        return 0.0
    return 1.0 if one.lever == other.lever else -1.0


def _by_displacement(path: InputPath) -> InputPath:
    """Input path by the displacement of the road where it stays bounded, so that no drifting state remains."""
    shape = path.filter
    if path.displacement or shape is None or len(shape.numerator) < 2 or shape.numerator[-1] != 0.0:
        return path
    return replace(path, filter=Filter(shape.numerator[:-1], shape.denominator), displacement=True)
