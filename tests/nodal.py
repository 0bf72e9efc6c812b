"""A second way to the frequency response of a mechanism: dynamic stiffness between nodes, solved at each frequency.

Written from the definition of a mechanism alone. Every element has a dynamic stiffness (force over elongation) at
s = j omega: k, c s or b s^2. It stands between two ends, each a combination of node displacements and road
displacements. The sum over all elements, with the masses, is solved by elimination in extended precision, one
frequency at a time; there are no states, so nothing can be eliminated wrongly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inerter import GROUND, Damper, Friction, Gap, Inerter, Mechanism, Spring
from inerter.networks.elements import Bridge, Network, Parallel, Series

_LAW = {Spring: 0, Damper: 1, Inerter: 2}  # power of s in the dynamic stiffness


@dataclass
class Nodal:
    """Displacements of all nodes of `mechanism` for unit road displacements and unit forces, at each `omega`."""

    mechanism: Mechanism
    omega: np.ndarray

    def __post_init__(self) -> None:
        self.s = 1j * np.asarray(self.omega, dtype=np.clongdouble)
        self.coordinates = [c.name for c in self.mechanism.coordinates]
        self.roads = [r.name for r in self.mechanism.roads]
        self.inputs = [*self.roads, *(f.name for f in self.mechanism.forces)]
        self.size = len(self.coordinates)
        self.elements: list[tuple[object, dict, dict]] = []
        self.carriers: dict[str, list[int]] = {}
        for strut in self.mechanism.struts:
            self.carriers[strut.name] = self._mount(strut.network, self._port(strut.upper), self._port(strut.lower))
        for tyre in self.mechanism.tyres:
            self.carriers[tyre.name] = self._mount(tyre.network, self._port(tyre.port), {("road", tyre.road): 1.0})
        self._solve()

    def _port(self, port: dict) -> dict:
        return {("node", self.coordinates.index(name)): lever for name, lever in port.items()}

    def _mount(self, network: Network, upper: dict, lower: dict) -> list[int]:
        """Place the elements between two ends; the numbers of the elements that meet at the upper end."""
        if isinstance(network, Parallel):
            return [i for part in network.parts for i in self._mount(part, upper, lower)]
        if isinstance(network, Series):
            ends = [upper]
            for _ in network.parts[1:]:
                ends.append({("node", self.size): 1.0})
                self.size += 1
            ends.append(lower)
            placed = [self._mount(p, a, b) for p, a, b in zip(network.parts, ends[:-1], ends[1:], strict=True)]
            return placed[0]
        if isinstance(network, Bridge):
            left, right = ({("node", self.size + i): 1.0} for i in range(2))
            self.size += 2
            carried = self._mount(network.a, upper, left) + self._mount(network.c, upper, right)
            self._mount(network.b, left, lower)
            self._mount(network.d, right, lower)
            self._mount(network.e, left, right)
            return carried
        assert not isinstance(network, Friction | Gap)
        self.elements.append((network, upper, lower))
        return [len(self.elements) - 1]

    def _rows(self, upper: dict, lower: dict) -> tuple[np.ndarray, np.ndarray]:
        nodes, roads = np.zeros(self.size, np.longdouble), np.zeros(len(self.roads), np.longdouble)
        for end, sign in ((upper, 1.0), (lower, -1.0)):
            for (kind, which), lever in end.items():
                if kind == "node":
                    nodes[which] += sign * lever
                else:
                    roads[self.roads.index(which)] += sign * lever
        return nodes, roads

    def _solve(self) -> None:
        count, inputs = self.s.size, len(self.inputs)
        K = np.zeros((count, self.size, self.size), np.clongdouble)
        F = np.zeros((count, self.size, inputs), np.clongdouble)
        for i, coordinate in enumerate(self.mechanism.coordinates):
            K[:, i, i] += coordinate.inertia * self.s**2
        self.placed = []
        for element, upper, lower in self.elements:
            nodes, roads = self._rows(upper, lower)
            stiffness = np.longdouble(element.value) * self.s ** _LAW[type(element)]
            self.placed.append((stiffness, nodes, roads))
            K += stiffness[:, None, None] * np.outer(nodes, nodes)
            F[:, :, : len(self.roads)] -= stiffness[:, None, None] * np.outer(nodes, roads)
        for j, force in enumerate(self.mechanism.forces):
            for name, lever in force.port.items():
                F[:, self.coordinates.index(name), len(self.roads) + j] += lever
        self.displacements = eliminate(K, F)

    def response(self, output: str, source: str) -> np.ndarray:
        """Frequency response of an output, named as in `state_space`, to a road's velocity or to a force."""
        stem, _, what = output.rpartition("_")
        j = self.inputs.index(source)
        if what in ("displacement", "velocity", "acceleration"):
            row = self.displacements[:, self.coordinates.index(stem), j]
            result = row * self.s ** {"displacement": 0, "velocity": 1, "acceleration": 2}[what]
        elif what in ("force", "load"):
            result = sum(self.placed[i][0] * self._elongation(i, j) for i in self.carriers[stem])
        else:
            i = self.carriers[stem][0]
            assert what in ("travel", "deflection")
            result = self._across(stem, i, j)
        return result / self.s if source in self.roads else result

    def _elongation(self, element: int, j: int) -> np.ndarray:
        _, nodes, roads = self.placed[element]
        road = roads[j] if j < len(self.roads) else 0.0
        return self.displacements[:, :, j] @ nodes + road

    def _across(self, mount: str, element: int, j: int) -> np.ndarray:
        strut = next((s for s in self.mechanism.struts if s.name == mount), None)
        tyre = next((t for t in self.mechanism.tyres if t.name == mount), None)
        upper = self._port(strut.upper if strut else tyre.port)
        lower = self._port(strut.lower or GROUND) if strut else {("road", tyre.road): 1.0}
        nodes, roads = self._rows(upper, lower)
        road = roads[j] if j < len(self.roads) else 0.0
        return self.displacements[:, :, j] @ nodes + road


def eliminate(K: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Solve K x = F for a stack of matrices by elimination with pivoting, in extended precision."""
    size = np.abs(K).max(axis=2, keepdims=True)
    K, F = K / size, F / size
    frequencies, n = np.arange(K.shape[0]), K.shape[1]
    for k in range(n):
        pivot = k + np.argmax(np.abs(K[:, k:, k]), axis=1)
        for M in (K, F):
            M[frequencies, k], M[frequencies, pivot] = M[frequencies, pivot], M[frequencies, k].copy()
        ratio = K[:, k + 1 :, k] / K[:, k, k][:, None]
        K[:, k + 1 :] -= ratio[:, :, None] * K[:, None, k]
        F[:, k + 1 :] -= ratio[:, :, None] * F[:, None, k]
    x = np.zeros_like(F)
    for k in reversed(range(n)):
        x[:, k] = (F[:, k] - np.einsum("fi,fij->fj", K[:, k, k + 1 :], x[:, k + 1 :])) / K[:, k, k][:, None]
    return x
