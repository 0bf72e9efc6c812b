"""A method: r.m.s. values as integrals of squared gains over all frequencies, by Gauss and Legendre."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from math import pi
from typing import Any

import numpy as np

import inerter as it


@it.METHODS.add
@dataclass(frozen=True)
class Quadrature:
    """The linear model, frequency by frequency: friction is left out, gaps are closed.

    Raises `InerterError` for an index that is not a sum of r.m.s. values on a road.
    """

    points: int = 600
    middle: float = field(default=20.0, metadata=it.quantity("rad/s", "Half of the frequencies lie below it.", "3 Hz"))
    name = "quadrature"
    words = "integrals of the squared gains of the linear model over all frequencies"
    sees = it.Sees.NEITHER
    needs_amplitude = False
    searches = False  # it gives no gradients

    def estimate(self, vehicle: Any, index: Any) -> it.Estimate:
        mechanism = vehicle.mechanism()
        question = index.question(mechanism)
        if question.combination is not it.Combination.SUM_OF_RMS or question.road is None:
            raise it.InerterError(f"Quadrature is for r.m.s. values on a road, and {index.symbol} is none.")
        names = [weighted.output for weighted in question.outputs]
        system = it.assemble(vehicle, question.inputs, names)
        omega, weights = _nodes(self.points, self.middle)
        delays = {road.name: road.distance / question.road.speed for road in mechanism.roads}
        s = 1j * omega
        resolvent = np.linalg.solve(s[:, None, None] * np.eye(system.order) - system.A, system.B + 0j)
        gains = system.C @ resolvent + system.D
        arrival = np.exp(-s[:, None] * np.array([delays[name] for name in question.inputs]))
        response = np.einsum("foi,fi->fo", gains, arrival)
        for column, filter in enumerate(question.filters):
            if filter is not None:
                response[:, column] *= filter.response(omega)
        rms = question.road.velocity_intensity * np.sqrt(weights @ np.abs(response) ** 2 / pi)
        value = sum(abs(w.weight) * r for w, r in zip(question.outputs, rms.tolist(), strict=True))
        return it.Estimate(value, question.unit, notes=system.notes)

    def estimate_many(self, vehicle: Any, indices: Sequence[Any], points: Mapping[str, Any]) -> Any:
        designs = [
            vehicle.with_values(dict(zip(points, row, strict=True))) for row in zip(*points.values(), strict=True)
        ]
        return np.array([[self.estimate(design, index).value for index in indices] for design in designs])

    def objective(self, vehicle: Any, index: Any) -> Any:
        raise it.InerterError("Quadrature gives no gradients. Optimise by another method, such as Norm().")


@cache
def _nodes(count: int, middle: float) -> tuple[Any, Any]:
    """Frequencies from zero to infinity [rad/s] with the weights of an integral: omega = middle x / (1 - x)."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    x = 0.5 * (nodes + 1.0)
    return middle * x / (1.0 - x), 0.5 * weights * middle / (1.0 - x) ** 2
