"""Symmetric and antisymmetric halves of a mechanism with mirror symmetry."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from inerter.networks.elements import Free
from inerter.vehicle.mechanism import Coordinate, Mechanism, Port, Strut, TrackedPoint, Tyre


def half_of(mechanism: Mechanism) -> Mechanism:
    """`symmetric_half`, unless a mount at rest in it has a free value, which must be reported."""
    half = symmetric_half(mechanism)
    still = half.still[len(mechanism.still) :]
    if any(isinstance(element.value, Free) for strut in still for element in strut.network.elements()):
        return mechanism
    return half


def symmetric_half(mechanism: Mechanism) -> Mechanism:
    """The symmetric half of a symmetric mechanism: an equivalent mechanism of fewer coordinates; else the mechanism.

    Of two mirrored coordinates the first has the mass of both, and antisymmetric ones are at rest. All mounts are kept,
    mirrored ones in parallel as `twins`, except those at rest; a removed coordinate becomes a `TrackedPoint` of its
    name. The symmetry is verified: masses and mounts must be equal in the mirror image.
    """
    if not mechanism.mirror or not _is_its_image(mechanism):
        return mechanism
    return _with_twins(_fold(mechanism, {b: {a: 1.0} if a != b else {} for a, b in mechanism.mirror}))


def antisymmetric_half(mechanism: Mechanism) -> Mechanism:
    """The antisymmetric half of a symmetric mechanism, on antisymmetric roads; else the mechanism.

    Symmetric coordinates are at rest, and antisymmetric ones move. Right tyres are mirrored onto the left roads.
    """
    merged = mechanism.on_one_track()
    if not mechanism.mirror or any(road.side != "left" for road in merged.roads) or not _is_its_image(merged):
        return mechanism
    follows: dict[str, Port] = {b: {a: -1.0} for a, b in mechanism.mirror if a != b}
    moved = {a for a, _ in mechanism.mirror}
    follows |= {c.name: {} for c in mechanism.coordinates if c.name not in {*moved, *follows}}
    half = _fold(replace(mechanism, tyres=merged.tyres, roads=merged.roads), follows)
    turned = (
        one if one.road == own.road else replace(one, port={name: -lever for name, lever in one.port.items()})
        for one, own in zip(half.tyres, mechanism.tyres, strict=True)
    )
    return _with_twins(replace(half, tyres=tuple(turned)))


def _fold(mechanism: Mechanism, follows: Mapping[str, Port]) -> Mechanism:
    """The mechanism with coordinates replaced by multiples of others."""
    doubled = {a for a, b in mechanism.mirror if a != b}

    def fold_port(port: Port) -> Port:
        found: dict[str, float] = {}
        for name, lever in port.items():
            for other, share in follows.get(name, {name: 1.0}).items():
                found[other] = found.get(other, 0.0) + share * lever
        return {name: lever for name, lever in found.items() if lever != 0.0}

    struts = [replace(s, upper=fold_port(s.upper), lower=fold_port(s.lower)) for s in mechanism.struts]
    still = tuple(strut for strut in struts if strut.upper == strut.lower)
    coordinates = (replace(c, inertia=2.0 * c.coefficient) if c.name in doubled else c for c in mechanism.coordinates)
    gone = (TrackedPoint(c.name, follows[c.name], c.angle) for c in mechanism.coordinates if c.name in follows)
    return replace(
        mechanism,
        coordinates=tuple(c for c in coordinates if c.name not in follows),
        struts=tuple(strut for strut in struts if strut not in still),
        tyres=tuple(replace(tyre, port=fold_port(tyre.port)) for tyre in mechanism.tyres),
        forces=tuple(replace(force, port=fold_port(force.port)) for force in mechanism.forces),
        points=(*(replace(point, port=fold_port(point.port)) for point in mechanism.points), *gone),
        mirror=(),
        still=(*mechanism.still, *still),
    )


def _with_twins(half: Mechanism) -> Mechanism:
    """The half with each mount that moves as an equal one before it, or opposite to that, named as its twin."""
    first: dict[object, str] = {}
    twins = []
    for mount, signature in zip(half.mounts(), _mount_signatures(half, {}), strict=True):
        of = first.setdefault(signature, mount.name)
        if of != mount.name:
            twins.append((mount.name, of))
    return replace(half, twins=tuple(twins))


def _is_its_image(mechanism: Mechanism) -> bool:
    """Whether masses and mounts are equal in the mirror image, and no mass is free, as pairs of masses are added."""
    if any(isinstance(c.inertia, Free) for c in mechanism.coordinates):
        return False
    images: dict[str, tuple[str, float]] = {}
    for a, b in mechanism.mirror:
        images |= {a: (b, 1.0), b: (a, 1.0)} if a != b else {a: (a, -1.0)}
    known = {c.name: c for c in mechanism.coordinates}
    if any(_inertia_and_kind(known[a]) != _inertia_and_kind(known[b]) for a, b in mechanism.mirror):
        return False
    return Counter(_mount_signatures(mechanism, {})) == Counter(_mount_signatures(mechanism, images))


def _inertia_and_kind(coordinate: Coordinate) -> tuple[float | Free, bool]:
    return coordinate.inertia, coordinate.angle


def _mount_signatures(mechanism: Mechanism, images: Mapping[str, tuple[str, float]]) -> list[object]:
    """Network and elongation of every mount in the mirror image, independent of the order of its ends."""
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
