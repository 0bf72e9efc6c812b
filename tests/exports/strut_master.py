"""A host of struts that are FMUs: masses, tyres and roads of a vehicle, coupled at communication points."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from fmu_master import Master

from inerter.vehicle.vehicle import Vehicle

ENDS = ("upper", "lower")
SOLUTIONS = 4  # of the accelerations, which are linear in one another between the events of a strut


class Host:
    """Masses on springs as tyres, without its struts, at rest."""

    def __init__(self, vehicle: Vehicle, struts: Mapping[str, Master]) -> None:
        mechanism = vehicle.mechanism()
        names = [c.name for c in mechanism.coordinates]
        self.masses = np.diag([c.coefficient for c in mechanism.coordinates])

        def row(port: Mapping[str, float]) -> np.ndarray:
            return np.array([port.get(name, 0.0) for name in names])

        self.tyres = [(row(t.port), t.network.coefficient, t.road) for t in mechanism.tyres]  # type: ignore[attr-defined]
        self.struts = [(struts[s.name], np.array([row(s.upper), row(s.lower)])) for s in mechanism.struts]
        self.q, self.v = np.zeros(len(names)), np.zeros(len(names))
        self.a = self.last = np.zeros(len(names))
        self.time = 0.0

    def tyre_forces(self, roads: Mapping[str, float], *, rates: bool = False) -> np.ndarray:
        """Of the tyres on the coordinates, or their rates by those of the roads."""
        moved = self.v if rates else self.q
        return sum((k * row * (roads[road] - row @ moved) for row, k, road in self.tyres), np.zeros(self.q.size))

    def mean(self, force: np.ndarray, expected: np.ndarray) -> np.ndarray:
        """Mean accelerations over the last step by the mean forces; they were `expected`, which an inertance feels."""
        masses = self.masses.copy()
        for strut, ends in self.struts:
            slope = strut.slopes("strut_force", [f"{end}_acceleration" for end in ENDS])
            pull = ends[0] - ends[1]
            force = force - pull * (strut.get("mean_force")[0] - slope @ (ends @ expected))
            masses = masses + np.outer(pull, slope @ ends)
        return np.linalg.solve(masses, force)

    def accelerations(self, roads: Mapping[str, float], *, solved: bool) -> np.ndarray:
        """Of the coordinates: solved for with directional derivatives, or with those of the step before."""
        outer = self.tyre_forces(roads)
        found = self.a
        for strut, ends in self.struts:
            for end, row in zip(ENDS, ends, strict=True):
                strut.set(f"{end}_displacement", row @ self.q)
                strut.set(f"{end}_velocity", row @ self.v)
        for _ in range(SOLUTIONS if solved else 1):
            masses, force = self.masses.copy(), np.asarray(outer, dtype=float)
            for strut, ends in self.struts:
                for end, row in zip(ENDS, ends, strict=True):
                    strut.set(f"{end}_acceleration", row @ found, 0.0, 0.0)
                slope = strut.slopes("strut_force", [f"{end}_acceleration" for end in ENDS]) if solved else np.zeros(2)
                pull = ends[0] - ends[1]
                force = force - pull * (strut.get("strut_force")[0] - slope @ (ends @ found))
                masses = masses + np.outer(pull, slope @ ends)
            found = np.linalg.solve(masses, force)
        return found

    def move(self, rate: np.ndarray, second: np.ndarray, step: float) -> None:
        """All of it, with accelerations of which the first two derivatives are given."""
        for strut, ends in self.struts:
            for end, row in zip(ENDS, ends, strict=True):
                strut.set(f"{end}_acceleration", row @ self.a, row @ rate, row @ second)
            strut.step(step)
        self.q = self.q + step * (self.v + step * (self.a / 2.0 + step * (rate / 6.0 + step * second / 24.0)))
        self.v = self.v + step * (self.a + step * (rate / 2.0 + step * second / 6.0))
        self.time += step


Road = Callable[[float], Mapping[str, float]]


def driven(host: Host, roads: Road, slopes: Road, step: float, count: int, way: str) -> np.ndarray:
    """Accelerations after each of so many steps on roads of which heights and slopes are given.

    `way` is "explicit", with the accelerations of the step before held; "derivatives", with accelerations that are
    solved for and go on as from the step before; or "rollback", which repeats such a step with a parabola through both
    of its ends and the mean.
    """
    solved = way != "explicit"
    host.a = host.last = host.accelerations(roads(0.0), solved=solved)
    none = np.zeros_like(host.a)
    found = []
    for number in range(1, count + 1):
        begin, end = (number - 1) * step, number * step
        rate = (host.a - host.last) / step if solved else none
        if way == "rollback":
            states = [(strut, strut.save()) for strut, _ in host.struts]
            q, v = host.q, host.v
            forces, changes = host.tyre_forces(roads(begin)), host.tyre_forces(slopes(begin), rates=True)
            host.move(rate, none, step)
            forces, changes = forces + host.tyre_forces(roads(end)), changes - host.tyre_forces(slopes(end), rates=True)
            mean = host.mean(forces / 2.0 + step * changes / 12.0, host.a + step * rate / 2.0)
            later = host.accelerations(roads(end), solved=True)
            host.q, host.v, host.time = q, v, host.time - step
            for strut, state in states:
                strut.restore(state, host.time)
            second = 6.0 * (later - 2.0 * mean + host.a) / step**2
            host.move((later - host.a) / step - step * second / 2.0, second, step)
        else:
            host.move(rate, none, step)
        host.last, host.a = host.a, host.accelerations(roads(end), solved=solved)
        if not np.all(np.abs(host.a) < 1e6):
            return np.full((1, host.a.size), np.inf)
        found.append(host.a)
    return np.array(found)
