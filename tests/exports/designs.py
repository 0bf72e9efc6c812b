"""Random designs of every kind of vehicle, from a number."""

from __future__ import annotations

import numpy as np
from random_mechanisms import FAMILIES, drawn, logarithmic
from strategies import random_network

import inerter as it
from inerter.networks.elements import Network
from inerter.vehicle.vehicle import Vehicle

KINDS = ("quarter car", "half car", "full car", "absorber", "mechanism")
COUNT = 50
ALWAYS = (0, 1, 2, 3, 4, 5, 7)


def network(rng: np.random.Generator, most: int = 4) -> Network:
    """A network that holds what is on it at rest."""
    inner = drawn(rng, random_network(rng, 3, int(rng.integers(1, most + 1))), 1.0)
    return it.Spring(logarithmic(rng, 1e4, 2e5)) | inner


def design(number: int) -> Vehicle:
    """A design of the kind `number` mod 5."""
    rng = np.random.default_rng([69, number])
    kind = KINDS[number % len(KINDS)]
    match kind:
        case "full car":
            return it.FullCar(
                sprung_mass=logarithmic(rng, 800, 2500),
                pitch_inertia=logarithmic(rng, 1000, 4000),
                roll_inertia=logarithmic(rng, 300, 900),
                unsprung_mass_front=logarithmic(rng, 25, 70),
                unsprung_mass_rear=logarithmic(rng, 25, 70),
                tyre_stiffness_front=logarithmic(rng, 1e5, 4e5),
                tyre_stiffness_rear=logarithmic(rng, 1e5, 4e5),
                distance_front=float(rng.uniform(0.9, 1.6)),
                distance_rear=float(rng.uniform(0.9, 1.6)),
                track_front=float(rng.uniform(1.3, 1.7)),
                track_rear=float(rng.uniform(1.3, 1.7)),
                front=network(rng, 3),
                rear=network(rng, 3),
                anti_roll_front=it.Spring(logarithmic(rng, 1e3, 1e5)) if rng.random() < 0.5 else None,
            )
        case "absorber":
            return it.Absorber(
                primary_mass=logarithmic(rng, 500, 5000),
                primary_stiffness=logarithmic(rng, 1e4, 1e6),
                mass=logarithmic(rng, 10, 200),
                mount=network(rng),
                ground=it.Inerter(logarithmic(rng, 1.0, 500.0)) if rng.random() < 0.5 else None,
                primary_damping=logarithmic(rng, 10, 1000),
            )
        case "mechanism":
            family = ("chain", "bridge", "levers")[number // len(KINDS) % 3]
            return FAMILIES[family](rng, 1.0)
    return FAMILIES[kind](rng, 1.0)


def frequencies() -> np.ndarray:
    """Angular frequencies from far below to far above what vehicles do [rad/s]."""
    return np.geomspace(0.1, 1e4, 40)


def deviation(found: np.ndarray, expected: np.ndarray, *, of_output: bool = False) -> float:
    """Largest difference over the largest value of each channel over the frequencies; of (frequency, output, input).

    A channel that symmetry makes zero, such as the heave of a full car under a roll moment, is measured by the largest
    value of its output, and so is every channel with `of_output`.
    """
    size = np.abs(expected).max(axis=0)
    whole = size.max(axis=1, keepdims=True)
    size = np.where(of_output | (size < 1e-12 * whole), whole, size)
    return float(np.max(np.abs(found - expected) / np.where(size > 0.0, size, 1.0), initial=0.0))
