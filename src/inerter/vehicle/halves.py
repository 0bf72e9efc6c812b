"""One half of a mechanism whose two sides are alike, where both sides are driven alike."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from inerter.networks.elements import Free
from inerter.vehicle.mechanism import Coordinate, Mechanism, Point, Port, Strut, Tyre


def half_of(mechanism: Mechanism) -> Mechanism:
    """`alike_half`, unless a mount that nothing moves then has a free value, which is to be told of."""
    half = alike_half(mechanism)
    still = half.still[len(mechanism.still) :]
    if any(isinstance(element.value, Free) for strut in still for element in strut.network.elements()):
        return mechanism
    return half


def alike_half(mechanism: Mechanism) -> Mechanism:
    """What moves where both sides move alike, if both are alike: an equal mechanism of fewer coordinates; else itself.

    Of two coordinates that are each other's mirror image the first has the mass of both, and those that turn round lie
    still. All mounts stay, two of them beside each other, but for those that nothing moves then; a coordinate that goes
    is a `Point` of its name. What the mirror says is not believed but tried: masses and mounts must be the same in it.
    """
    if not mechanism.mirror or not _is_its_image(mechanism):
        return mechanism
    return _folded(mechanism, {b: {a: 1.0} if a != b else {} for a, b in mechanism.mirror})


def opposed_half(mechanism: Mechanism) -> Mechanism:
    """What moves where the right side moves against the left, on roads that do so too, if both sides are alike; else
    the mechanism itself.

    What is its own image lies still, and what turns round moves. Tyres of the right are turned over, onto the roads of
    the left.
    """
    merged = mechanism.on_one_track()
    if not mechanism.mirror or any(road.track != "left" for road in merged.roads) or not _is_its_image(merged):
        return mechanism
    follows: dict[str, Port] = {b: {a: -1.0} for a, b in mechanism.mirror if a != b}
    moved = {a for a, _ in mechanism.mirror}
    follows |= {c.name: {} for c in mechanism.coordinates if c.name not in {*moved, *follows}}
    half = _folded(replace(mechanism, tyres=merged.tyres, roads=merged.roads), follows)
    turned = (
        one if one.road == own.road else replace(one, port={name: -lever for name, lever in one.port.items()})
        for one, own in zip(half.tyres, mechanism.tyres, strict=True)
    )
    return replace(half, tyres=tuple(turned))


def _folded(mechanism: Mechanism, follows: Mapping[str, Port]) -> Mechanism:
    """The mechanism whose coordinates follow others so."""
    doubled = {a for a, b in mechanism.mirror if a != b}

    def folded(port: Port) -> Port:
        found: dict[str, float] = {}
        for name, lever in port.items():
            for other, share in follows.get(name, {name: 1.0}).items():
                found[other] = found.get(other, 0.0) + share * lever
        return {name: lever for name, lever in found.items() if lever != 0.0}

    struts = [replace(s, upper=folded(s.upper), lower=folded(s.lower)) for s in mechanism.struts]
    still = tuple(strut for strut in struts if strut.upper == strut.lower)
    coordinates = (
        replace(c, inertia=2.0 * c.element.coefficient) if c.name in doubled else c for c in mechanism.coordinates
    )
    gone = (Point(c.name, follows[c.name], c.angle) for c in mechanism.coordinates if c.name in follows)
    return replace(
        mechanism,
        coordinates=tuple(c for c in coordinates if c.name not in follows),
        struts=tuple(strut for strut in struts if strut not in still),
        tyres=tuple(replace(tyre, port=folded(tyre.port)) for tyre in mechanism.tyres),
        forces=tuple(replace(force, port=folded(force.port)) for force in mechanism.forces),
        points=(*(replace(point, port=folded(point.port)) for point in mechanism.points), *gone),
        mirror=(),
        still=(*mechanism.still, *still),
    )


def _is_its_image(mechanism: Mechanism) -> bool:
    """Whether masses and mounts are the same in the mirror, and no mass is free: that of two would be another."""
    if any(isinstance(c.inertia, Free) for c in mechanism.coordinates):
        return False
    images: dict[str, tuple[str, float]] = {}
    for a, b in mechanism.mirror:
        images |= {a: (b, 1.0), b: (a, 1.0)} if a != b else {a: (a, -1.0)}
    known = {c.name: c for c in mechanism.coordinates}
    if any(_law(known[a]) != _law(known[b]) for a, b in mechanism.mirror):
        return False
    return Counter(_mounted(mechanism, {})) == Counter(_mounted(mechanism, images))


def _law(coordinate: Coordinate) -> tuple[float | Free, bool]:
    return coordinate.inertia, coordinate.angle


def _mounted(mechanism: Mechanism, images: Mapping[str, tuple[str, float]]) -> list[object]:
    """Every mount as its network and how far it is stretched, in the mirror; turned end for end it is the same."""
    found: list[object] = []
    for mount in mechanism.mounts():
        stretched: dict[str, float] = {}
        for port, sign in _ends(mount):
            for name, lever in port.items():
                image, turned = images.get(name, (name, 1.0))
                stretched[image] = stretched.get(image, 0.0) + sign * turned * lever
        row = tuple(sorted((name, lever) for name, lever in stretched.items() if lever != 0.0))
        back = tuple((name, -lever) for name, lever in row)
        found.append((type(mount).__name__, repr(mount.network), max(row, back)))
    return found


def _ends(mount: Strut | Tyre) -> tuple[tuple[Port, float], ...]:
    if isinstance(mount, Strut):
        return (mount.upper, 1.0), (mount.lower, -1.0)
    return (mount.port, 1.0), ({mount.road: 1.0}, -1.0)
