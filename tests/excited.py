"""Random excitations for the tests, one of two sources among them, and random questions that have an answer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from filtered import random_filter
from wang_su import ROAD

import inerter as it
from inerter.indices.excitation import as_excitation
from inerter.signals.road import Road
from inerter.systems.input_paths import InputPath
from inerter.vehicle.mechanism import Mechanism


@dataclass(frozen=True)
class TwoSources:
    """Two white noises on all roads: one is the same for all, the other comes with turns and filters of its own."""

    road: Road
    shapes: tuple[it.Filter, it.Filter]
    unit = "m/s"
    is_random = True

    @property
    def amplitude_density(self) -> float:
        return self.road.velocity_intensity

    def excited_mechanism(self, mechanism: Mechanism) -> Mechanism:
        return mechanism

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        shared = [InputPath(r.name, "both", r.distance / self.road.speed, 1.0, self.shapes[0]) for r in mechanism.roads]
        turned = [
            InputPath(r.name, "apart", r.distance / self.road.speed, (-0.5) ** i, self.shapes[1])
            for i, r in enumerate(mechanism.roads)
        ]
        return (*shared, *turned)


def low_pass(rng: np.random.Generator) -> it.Filter:
    """Of first or second order, so that every output of a mechanism has a finite variance."""
    rate = float(np.exp(rng.uniform(0.0, 5.0)))
    return it.Filter([rate], [1.0, rate]) if rng.random() < 0.5 else it.Filter([1.0], [1.0 / rate**2, 0.7 / rate, 1.0])


def random_excitation(rng: np.random.Generator, mechanism: Mechanism) -> it.Excitation | Road:
    force = it.WhiteForce(mechanism.forces[0].name, float(rng.uniform(0.1, 10.0)))
    plain = [ROAD, force, it.GroundAcceleration(float(rng.uniform(0.1, 10.0)))]
    choice = int(rng.integers(0, 7))
    if choice == 6:
        return TwoSources(ROAD, (low_pass(rng), low_pass(rng)))
    shape = low_pass(rng) if rng.random() < 0.6 else random_filter(rng)
    return plain[choice] if choice < 3 else it.FilteredExcitation(plain[choice - 3], shape)


def random_outputs(rng: np.random.Generator, mechanism: Mechanism, excitation: object) -> dict[str, float]:
    """Forces, loads and accelerations, and motions over the ground if that moves."""
    names = [f"{mount.name}_force" for mount in mechanism.struts] + [f"{tyre.name}_load" for tyre in mechanism.tyres]
    names += [f"{c.name}_acceleration" for c in mechanism.coordinates]
    masses = [c.name for c in mechanism.coordinates if not c.angle]
    if as_excitation(excitation, "A test").excited_mechanism(mechanism).ground_moves:
        names += [f"{name}_relative_{what}" for name in masses for what in ("displacement", "velocity")]
    elif isinstance(excitation, it.WhiteForce):
        names += [f"{name}_velocity" for name in masses]
    chosen = rng.choice(names, size=min(2, len(names)), replace=False)
    return {str(name): float(rng.uniform(0.5, 2.0)) for name in chosen}
