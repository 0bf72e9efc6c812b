"""Rest is what it is from wherever one looks: devices turned end for end, mirrored, and measured in other frames."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from campaigns import sampled
from mechanisms import random_network

import inerter as it
from inerter import Damper, Friction, Gap, Inerter, Mechanism, Rig, Spring, Strut
from inerter.errors import MechanismError
from inerter.networks.elements import Element, Network, Parallel, Series
from inerter.simulation.initial_state import initial_state
from inerter.simulation.statics import equilibrium
from inerter.systems.piecewise import piecewise
from inerter.vehicle.vehicle import Vehicle

CLOSE = 1e-12


def turned(network: Network) -> Network:
    """The same device end for end."""
    if isinstance(network, Element):
        return network
    parts = tuple(turned(part) for part in network.parts)  # type: ignore[attr-defined]
    return Series(parts[::-1]) if isinstance(network, Series) else Parallel(parts)


def named(network: Network, first: int = 0) -> Network:
    """The same with a name for every element."""
    if isinstance(network, Element):
        return replace(network, name=f"e{first}")
    parts = []
    for part in network.parts:  # type: ignore[attr-defined]
        parts.append(named(part, first))
        first += sum(1 for _ in part.elements())
    return type(network)(tuple(parts))  # type: ignore[call-arg]


def started(vehicle: Vehicle, heights: list[float], rates: list[float] | None = None) -> dict[str, float]:
    """The elongation of every spring and gap, and the velocity of every inerter, at rest over these roads."""
    system = piecewise(vehicle)
    z, dz = np.array(heights), np.zeros(len(heights)) if rates is None else np.array(rates)
    inputs = np.concatenate([z, np.zeros(len(system.mechanism.forces))])
    a, g = np.split(initial_state(system, inputs, "rest", np.concatenate([dz, 0.0 * inputs[z.size :]])), [
        system.motions[0].shape[1]
    ])  # fmt: skip
    lengths = system.elongations[0] @ g + system.elongations[1] @ z
    velocities = system.rates[0] @ a + system.rates[2] @ dz  # inertia moves with nothing massless between
    found = {}
    for i, branch in enumerate(system.graph.branches):
        if isinstance(branch.element, Spring | Gap):
            found[branch.label] = float(lengths[i])
        elif isinstance(branch.element, Inerter):
            found[branch.label] = float(velocities[i])
    return found


def device(seed: int) -> tuple[Network, np.random.Generator]:
    rng = np.random.default_rng([seed, 3])
    return named(random_network(rng, int(rng.integers(1, 4)))), rng


def between(network: Network) -> Mechanism:
    """A device between two tables that both move."""
    return Mechanism(
        coordinates=(),
        struts=(Strut("device", network, {"top": 1.0}, {"bottom": 1.0}),),
        roads=(it.RoadInput("top"), it.RoadInput("bottom")),
    )


def differ(one: dict[str, float], other: dict[str, float], size: float, sign: float = 1.0) -> float:
    assert one.keys() == other.keys()
    return max((abs(one[name] - sign * other[name]) for name in one), default=0.0) / size


def frames(seed: int) -> float | None:
    """The largest change of the start by turning, mirroring and moving; None for what is refused."""
    network, rng = device(seed)
    height, rate = rng.choice([1e-4, 1e-3, 1e-2, 0.1]) * rng.choice([-1.0, 1.0]), rng.uniform(-0.1, 0.1)
    try:
        rig = started(Rig(network), [height], [rate])
    except MechanismError:
        return None
    size, found = abs(height) + abs(rate), []
    found.append(differ(rig, started(Rig(turned(network)), [height], [rate]), size))
    found.append(differ(rig, started(Rig(network), [-height], [-rate]), size, -1.0))
    for shift, drift in ((0.0, 0.0), (0.3, 0.0), (-20.0, 0.0), (0.01, 2.0)):
        tables = [height + shift, shift], [rate + drift, drift]
        found.append(differ(rig, started(between(network), *tables), size + 1e-3 * abs(shift) + abs(drift)))
    return max(found)


FEW = [(range(1000 * chunk, 1000 * chunk + 40), 8) for chunk in range(4)]
MANY = [(range(10_000 * chunk, 10_000 * chunk + 250), 50) for chunk in range(20)]


@pytest.mark.parametrize(("seeds", "least"), sampled([*FEW, *MANY], FEW, kept=1))
def test_rigs_at_rest_are_the_same_in_every_frame(seeds: range, least: int) -> None:
    found = [f for seed in seeds if (f := frames(seed)) is not None]
    assert max(found) < CLOSE
    assert len(found) > least


REFUSED = (0, 11, 16, 20)  # a gap between inertias, or a node between gaps that nothing holds


@pytest.mark.parametrize("seed", [seed for seed in range(24) if seed not in REFUSED])
def test_a_car_at_rest_is_lifted_by_its_road(seed: int) -> None:
    network, rng = device(seed)
    strut = Spring(5e4, "k") | Damper(1e3, "c") | network if rng.random() < 0.5 else network
    car = it.QuarterCar(200.0, 30.0, 1.5e5, strut)
    low, high = started(car, [0.0]), started(car, [0.4])
    assert differ(low, high, 0.4) < CLOSE
    system = piecewise(car)
    g = initial_state(system, np.array([0.4, 0.0]), "rest")[system.motions[0].shape[1] :]
    assert system.displacements[0] @ g + system.displacements[1] @ [0.4] == pytest.approx([0.4, 0.4], rel=CLOSE)


def stiffness(network: Network) -> Fraction:
    """That of a network at rest, without gaps."""
    if isinstance(network, Element):
        return Fraction(network.value) if isinstance(network, Spring) else Fraction(0)
    parts = [stiffness(part) for part in network.parts]  # type: ignore[attr-defined]
    if isinstance(network, Parallel):
        return sum(parts, Fraction(0))
    return Fraction(0) if 0 in parts else 1 / sum((1 / part for part in parts), Fraction(0))


def elongations(network: Network, elongation: Fraction) -> dict[str, Fraction]:
    """Of all springs, when the network is elongated so far and at rest."""
    if isinstance(network, Element):
        return {network.label: elongation} if isinstance(network, Spring) else {}
    found: dict[str, Fraction] = {}
    whole = stiffness(network)
    for part in network.parts:  # type: ignore[attr-defined]
        own = elongation if isinstance(network, Parallel) else whole * elongation / (stiffness(part) or 1)
        found |= elongations(part, own)
    return found


@pytest.mark.parametrize("decades", [1, 12])
def test_springs_at_rest_are_exact(decades: int) -> None:
    """Against rational arithmetic, over stiffnesses of many decades."""
    rng, worst, strained = np.random.default_rng(5), 0.0, 0
    for _ in range(150):
        leaves: list[Network] = [
            (Spring(10.0 ** rng.uniform(-0.5 * decades, 0.5 * decades) * 1e4) if rng.random() < 0.7 else
             [Damper(1e3), Inerter(10.0), Friction(5.0)][int(rng.integers(3))])
            for _ in range(int(rng.integers(2, 8)))
        ]  # fmt: skip
        while len(leaves) > 1:
            i = int(rng.integers(len(leaves) - 1))
            leaves[i : i + 2] = [leaves[i] | leaves[i + 1] if rng.random() < 0.5 else leaves[i] - leaves[i + 1]]
        network = named(leaves[0])
        try:
            system = piecewise(Rig(network))
        except MechanismError:  # a friction straight between the tables
            continue
        rest = equilibrium(system, np.array([0.01]), np.zeros(0)).elongation
        found = {branch.label: float(e) for branch, e in zip(system.graph.branches, rest, strict=True)}
        exact = elongations(network, Fraction(0.01))
        strained += any(exact.values())
        for name, value in exact.items():
            worst = max(worst, abs(found[name] - float(value)) / (abs(float(value)) or 0.01))
    assert worst < 1e-12
    assert strained > 50


@pytest.mark.parametrize("seed", sampled(range(12), [*range(4), 5]))
def test_a_turned_rig_moves_the_same(seed: int) -> None:
    """Through the whole motion, from a table that sets off with a velocity."""
    network, rng = device(300 + seed)
    shaft = Spring(4e5, "shaft") | Damper(2e3, "loss")
    motion = it.sine(2e-3, rng.uniform(1.0, 8.0), phase=rng.uniform(0.0, 6.0))
    runs = [it.simulate(Rig(d), displacement=motion, duration=0.3) for d in (shaft - network, turned(network) - shaft)]
    one, other = (run["device_force"] for run in runs)
    assert one == pytest.approx(other, rel=1e-9, abs=1e-9 * np.abs(one).max() + 1e-12)
    listed = [sorted((round(e.time, 9), e.element, e.after) for e in run.events) for run in runs]
    assert listed[0] == listed[1]


def test_what_rests_stays_at_rest() -> None:
    for seed in range(15):
        network, _ = device(600 + seed)
        still = it.Signal.sampled([0.0, 1.0], [5e-3, 5e-3])
        try:
            run = it.simulate(Rig(network), displacement=still, duration=0.1)
        except MechanismError:
            continue
        assert run.status.ok
        force = run["device_force"]
        assert np.ptp(force) <= 1e-9 * np.abs(force).max()
