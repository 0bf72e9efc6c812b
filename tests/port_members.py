"""Random networks in one place of random vehicles, with random indices: in compiled code and in rational arithmetic."""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass, replace

import numpy as np
from bounded import linear_member
from random_mechanisms import logarithmic
from strategies import random_element

from inerter import Bridge, Damper, Inerter, InerterError, Spring, free
from inerter.indices.definition import Index
from inerter.kernels.network_norms import indices
from inerter.methods.network_norm import NetworkIndex, network_index, network_program
from inerter.networks.elements import Network
from inerter.networks.enumeration import enumerate_networks
from inerter.networks.transform import map_elements
from inerter.vehicle.mechanism import Mechanism

PLACE = "place"
_RANGES = {Spring: (1e2, 1e8), Damper: (1e0, 1e6), Inerter: (1e-2, 1e4)}
_TOPOLOGIES = [topology for size in range(1, 5) for topology in enumerate_networks(size)]


@dataclass(frozen=True, eq=False)
class CompiledMember:
    """A network in a mechanism, an index, and the compiled index over the network's values."""

    name: str
    network: Network
    mechanism: Mechanism
    index: Index
    over_network: NetworkIndex

    @property
    def values(self) -> np.ndarray:
        """Values of the elements."""
        return np.array([element.value for element in self.network.elements()])

    def compiled(self, values: np.ndarray | None = None, gradient: bool = False) -> tuple[float, float, np.ndarray]:
        """The index, its relative error, and its gradient if that is asked for."""
        program = network_program(self.network)
        port = self.over_network.port(program)
        points = (self.values if values is None else values)[None]
        gradients, errors = np.zeros((int(gradient), points.size)), np.zeros(1)
        if port is None:
            return math.inf, 0.0, np.zeros(0)
        (value,) = indices(points, program.program, port, gradients, errors)
        return float(value), float(errors[0]), gradients.ravel()

    def designs(self, count: int, number: int) -> np.ndarray:
        """Values of many designs in columns, the member's own first, the others up to twenty decades from it."""
        rng = np.random.default_rng([61, number])
        spread = rng.choice([0.3, 3.0, 10.0], count)
        spread[0] = 0.0
        return np.ascontiguousarray(
            (self.values * np.exp(rng.normal(0.0, spread[:, None], (count, self.values.size)))).T
        )

    def exact(self) -> float | None:
        """The index in rational arithmetic; None where that gives none."""
        rational = importlib.import_module("rational_norms")  # needs python-flint
        try:
            found = rational.index_value(self.mechanism, self.index)
        except ArithmeticError:  # more digits than it is given
            return None
        return math.inf if found is rational.INFINITE else found


def random_member(number: int, extreme: float = 0.25, peaks: bool = False) -> CompiledMember | None:
    """A network beside, in series with or instead of one that is mounted in a vehicle, also instead of its tyre.

    Some networks, a share `extreme`, have values between 1e-9 and 1e12. The index is one of r.m.s. values, or a peak
    gain if `peaks`. None where it is not compiled.
    """
    question, rng = linear_member(number), np.random.default_rng([59, number])
    vehicle, network = question.vehicle.mechanism(), _random_network(rng, extreme)
    kind = "struts" if not vehicle.tyres or (vehicle.struts and rng.random() < 0.8) else "tyres"
    mounts = getattr(vehicle, kind)
    at, way = int(rng.integers(len(mounts))), int(rng.integers(3))

    def mounted(part: Network) -> Mechanism:
        fixed = mounts[at].network
        joined = (fixed | part, fixed - part, part)[way]
        return replace(vehicle, **{kind: tuple(replace(m, network=joined) if m is mounts[at] else m for m in mounts)})

    probe, mechanism = mounted(Damper(free(1.0, 2.0, PLACE), PLACE)), mounted(network)
    try:
        found = network_index(probe, question.index.definition(mechanism), PLACE)
    except InerterError:  # a question that this vehicle does not answer
        return None
    if found is None or found.is_peak is not peaks:
        return None
    name = f"{question.name}, {mounts[at].name} {'|-='[way]} {network!r}"
    return CompiledMember(name, network, mechanism, question.index, found)


def _random_network(rng: np.random.Generator, extreme: float) -> Network:
    """A network of up to four elements, a bridge, or a bridge in a bridge."""
    kinds = {"k": Spring, "c": Damper, "b": Inerter}
    if rng.random() < 0.7:
        topology = _TOPOLOGIES[int(rng.integers(len(_TOPOLOGIES)))]
        network = topology.network([kinds[symbol](1.0) for symbol in topology.kinds])
    else:
        network = _random_bridge(rng, nested=rng.random() < 0.3)
        network = network | random_element(rng) if rng.random() < 0.3 else network
    far_out = rng.random() < extreme

    def drawn(element: Network) -> Network:
        bounds = (1e-9, 1e12) if far_out and rng.random() < 0.3 else _RANGES[type(element)]
        return element.with_value(logarithmic(rng, *bounds))

    return map_elements(network, drawn)


def _random_bridge(rng: np.random.Generator, nested: bool) -> Network:
    arms = [random_element(rng) for _ in range(5)]
    if nested:
        arms[int(rng.integers(5))] = _random_bridge(rng, nested=False)
    return Bridge(*arms)
