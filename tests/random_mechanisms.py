"""Random mechanisms from a seed, in families, with values that are usual or extreme and in any units."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from strategies import random_half_car, random_network, random_quarter_car

from inerter import (
    GROUND,
    Coordinate,
    Damper,
    Force,
    Inerter,
    Mechanism,
    OutputWeight,
    PerformanceOutputs,
    RoadInput,
    Spring,
    Strut,
    Tyre,
    free,
)
from inerter.networks.elements import Element, Network
from inerter.networks.transform import map_elements

_USUAL = {Spring: (1e3, 1e6), Damper: (1e1, 1e5), Inerter: (1e-1, 1e4)}


def logarithmic(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def drawn(rng: np.random.Generator, network: Network, extremes: float) -> Network:
    """The network with values over a range widened by `extremes`, some of them far out: 1e-12 to 1e13."""

    def value(element: Element) -> Network:
        low, high = _USUAL[type(element)]
        if extremes > 1.0 and rng.random() < 0.15:
            return element.with_value(logarithmic(rng, 1e-12, 1e13))
        return element.with_value(logarithmic(rng, low / extremes, high * extremes))

    return map_elements(network, value)


def at_zero(rng: np.random.Generator) -> Network:
    """Struts that leave the body free at rest, beside or in series with others: poles at zero in clusters."""
    k, c, b = Spring(1.0), Damper(1.0), Inerter(1.0)
    choices = [c - b, k - c - b, k - b, b, c, c - b - c, k - c, (k | b) - c, (c | b) - b, k | b, k, k | c - b - b]
    return choices[int(rng.integers(len(choices)))]


def quarter_car(rng: np.random.Generator, extremes: float) -> Mechanism:
    network = at_zero(rng) if rng.random() < 0.25 else random_network(rng, 3, int(rng.integers(1, 8)))
    return random_quarter_car(rng, drawn(rng, network, extremes)).mechanism()


def half_car(rng: np.random.Generator, extremes: float) -> Mechanism:
    front, rear = (drawn(rng, random_network(rng, 2, int(rng.integers(2, 5))), extremes) for _ in range(2))
    return random_half_car(rng, front, rear).mechanism()


def chain(rng: np.random.Generator, extremes: float) -> Mechanism:
    """Masses above each other on one road, each on a strut."""
    count = int(rng.integers(1, 5))
    names = [f"m{i}" for i in range(count)]
    masses = [logarithmic(rng, 1.0, 1e3) for _ in names]
    struts = tuple(
        Strut(f"s{i}", drawn(rng, random_network(rng, 2, 4), extremes), {names[i]: 1.0}, {names[i - 1]: 1.0})
        for i in range(1, count)
    )
    return _measured(names, masses, struts, (Tyre("tyre", Spring(logarithmic(rng, 1e4, 1e6)), {"m0": 1.0}, "road"),))


def bridge(rng: np.random.Generator, extremes: float) -> Mechanism:
    """Body over wheel with two small masses between them, all joined: no network in series and parallel."""
    names = ["wheel", "left", "right", "body"]
    masses = [logarithmic(rng, 10, 90), *(logarithmic(rng, 1e-3, 10.0) for _ in "ab"), logarithmic(rng, 100, 1000)]
    pairs = [("body", "left"), ("body", "right"), ("left", "right"), ("left", "wheel"), ("right", "wheel")]
    struts = tuple(
        Strut(f"s{i}", drawn(rng, random_network(rng, 2, 2), extremes), {a: 1.0}, {b: 1.0})
        for i, (a, b) in enumerate(pairs)
    )
    return _measured(names, masses, struts, (Tyre("tyre", Spring(logarithmic(rng, 1e4, 1e6)), {"wheel": 1.0}, "road"),))


def levers(rng: np.random.Generator, extremes: float) -> Mechanism:
    """A rigid beam on two or three wheels whose angle is in any unit, with a strut to the ground now and then."""
    count, unit = int(rng.integers(2, 4)), logarithmic(rng, 1e-8, 1e8) if extremes > 1.0 else 1.0
    wheels = [f"w{i}" for i in range(count)]
    ends = [float(x) * unit for x in sorted(rng.uniform(-2.0, 2.0, count), reverse=True)]
    coordinates = ["body", "angle", *wheels]
    masses = [logarithmic(rng, 100, 2000), logarithmic(rng, 100, 3000) * unit**2]
    masses += [logarithmic(rng, 10, 90) for _ in wheels]
    struts = tuple(
        Strut(f"s{i}", drawn(rng, random_network(rng, 2, 3), extremes), {"body": 1.0, "angle": end}, {wheel: 1.0})
        for i, (wheel, end) in enumerate(zip(wheels, ends, strict=True))
    )
    if rng.random() < 0.2:
        struts += (Strut("hook", Damper(logarithmic(rng, 1.0, 1e4)), {"body": 1.0}, GROUND),)
    tyres = tuple(
        Tyre(f"t{i}", Spring(logarithmic(rng, 1e4, 1e6)), {wheel: 1.0}, f"r{i}") for i, wheel in enumerate(wheels)
    )
    made = _measured(coordinates, masses, struts, tyres)
    distances = [(ends[0] - end) / unit for end in ends]
    return replace(made, roads=tuple(RoadInput(f"r{i}", distance=d) for i, d in enumerate(distances)))


def _measured(names: list[str], masses: list[float], struts: tuple[Strut, ...], tyres: tuple[Tyre, ...]) -> Mechanism:
    body = "body" if "body" in names else names[-1]
    return Mechanism(
        coordinates=tuple(Coordinate(name, mass) for name, mass in zip(names, masses, strict=True)),
        struts=struts,
        tyres=tyres,
        roads=tuple(RoadInput(road) for road in dict.fromkeys(tyre.road for tyre in tyres)),
        forces=(Force("load", {body: 1.0}),),
        measures=PerformanceOutputs(
            comfort=(OutputWeight(f"{body}_acceleration"),),
            tyre_load=tuple(OutputWeight(f"{tyre.name}_load") for tyre in tyres),
            load_input="load",
            load_output=f"{body}_displacement",
        ),
    )


def in_other_units(rng: np.random.Generator, mechanism: Mechanism) -> Mechanism:
    """The same mechanism with every mass, and so every force, in another unit."""
    unit = 10.0 ** float(rng.integers(-9, 10))

    def scaled(network: Network) -> Network:
        return map_elements(network, lambda element: element.with_value(element.value * unit))

    return replace(
        mechanism,
        coordinates=tuple(replace(c, inertia=c.inertia * unit) for c in mechanism.coordinates),
        struts=tuple(replace(s, network=scaled(s.network)) for s in mechanism.struts),
        tyres=tuple(replace(t, network=scaled(t.network)) for t in mechanism.tyres),
    )


FAMILIES = {"quarter car": quarter_car, "half car": half_car, "chain": chain, "bridge": bridge, "levers": levers}


def mechanisms(family: str, seed: int, count: int, extremes: float) -> list[Mechanism]:
    """So many of a family; every other one in other units of mass if values are extreme."""
    rng = np.random.default_rng([seed, *family.encode()])
    found = []
    while len(found) < count:
        made = FAMILIES[family](rng, extremes)
        found.append(in_other_units(rng, made) if extremes > 1.0 and len(found) % 2 else made)
    return found


def opened(mechanism: Mechanism) -> tuple[Mechanism, dict[str, float]]:
    """The mechanism with its first elements free, and the values that they had."""
    values: dict[str, float] = {}

    def freed(element: Element) -> Element:
        if len(values) >= 3 or not isinstance(element, Spring | Damper | Inerter):
            return element
        values[f"p{len(values)}"] = element.value
        return element.with_value(free(0.5 * element.value, 2.0 * element.value, name=f"p{len(values) - 1}"))

    struts = tuple(replace(strut, network=map_elements(strut.network, freed)) for strut in mechanism.struts)
    return replace(mechanism, struts=struts), values
