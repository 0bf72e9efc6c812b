"""Random networks in one place of random vehicles, with random indices: compiled, and in rational arithmetic."""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass, replace

import numpy as np
from bounded import Member, linear_member
from random_mechanisms import logarithmic
from strategies import random_element

from inerter import Bridge, Damper, Inerter, Spring, free
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
class PortMember:
    """A network in a mechanism: the index over its values, if it is compiled, and the mechanism with the network."""

    name: str
    index: NetworkIndex | None
    network: Network
    mechanism: Mechanism
    question: Member

    @property
    def values(self) -> np.ndarray:
        """Element values, a row for each of one design."""
        return np.array([[element.value for element in self.network.elements()]])


def random_values(rng: np.random.Generator, network: Network, extreme: bool) -> Network:
    """The network with values over six decades, or with some between 1e-9 and 1e12."""

    def drawn(element: Network) -> Network:
        bounds = (1e-9, 1e12) if extreme and rng.random() < 0.3 else _RANGES[type(element)]
        return element.with_value(logarithmic(rng, *bounds))

    return map_elements(network, drawn)


def random_network_of_search(rng: np.random.Generator) -> Network:
    """A network of a search: of up to four elements, a bridge, or a bridge in a bridge."""
    kinds = {"k": Spring, "c": Damper, "b": Inerter}
    if rng.random() < 0.7:
        topology = _TOPOLOGIES[int(rng.integers(len(_TOPOLOGIES)))]
        network = topology.network([kinds[symbol](1.0) for symbol in topology.kinds])
    else:
        network = _random_bridge(rng, nested=rng.random() < 0.3)
        network = network | random_element(rng) if rng.random() < 0.3 else network
    return random_values(rng, network, extreme=rng.random() < 0.25)


def _random_bridge(rng: np.random.Generator, nested: bool) -> Network:
    arms = [random_element(rng) for _ in range(5)]
    if nested:
        arms[int(rng.integers(5))] = _random_bridge(rng, nested=False)
    return Bridge(*arms)


def port_member(number: int) -> PortMember:
    """A network beside, in series with or instead of one that is mounted in a vehicle, also instead of its tyre."""
    question = linear_member(number)
    rng = np.random.default_rng([59, number])
    mechanism, network = question.vehicle.mechanism(), random_network_of_search(rng)
    strut = (bool(mechanism.struts) and rng.random() < 0.8) or not mechanism.tyres
    mounts = mechanism.struts if strut else mechanism.tyres
    at = int(rng.integers(len(mounts)))
    way = int(rng.integers(3))

    def mounted(part: Network) -> Mechanism:
        fixed = mounts[at].network
        joined = (fixed | part, fixed - part, part)[way]
        changed = tuple(replace(m, network=joined if i == at else m.network) for i, m in enumerate(mounts))
        return replace(mechanism, **{"struts" if strut else "tyres": changed})

    probe = mounted(Damper(free(1.0, 2.0, PLACE), PLACE))
    found = network_index(probe, question.index.definition(mounted(network)), PLACE)
    name = f"{question.name}, {mounts[at].name} {'|-='[way]} {network!r}"
    return PortMember(name, found, network, mounted(network), question)


def compiled(member: PortMember, gradient: bool = False) -> tuple[float, float, np.ndarray]:
    """The index, its relative error, and its gradient if that is asked for; infinite where compiled code gives none."""
    assert member.index is not None
    program = network_program(member.network)
    port = member.index.port(program)
    gradients, errors = np.zeros((int(gradient), member.values.shape[1])), np.zeros(1)
    if port is None:
        return math.inf, 0.0, np.zeros(0)
    (value,) = indices(member.values, program.program, port, gradients, errors)
    return float(value), float(errors[0]), gradients[:1].ravel()


def exact(member: PortMember) -> float | None:
    """The index in rational arithmetic; None where that gives none."""
    rational = importlib.import_module("rational_norms")  # needs python-flint
    try:
        found = rational.index_value(member.mechanism, member.question.index)
    except ArithmeticError:  # more digits than it is given
        return None
    return math.inf if found is rational.INFINITE else found
