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

    Raises `InerterError` for an index that is not a sum of r.m.s. values.
    """

    points: int = 600
    middle: float = field(default=20.0, metadata=it.quantity("rad/s", "Half of the frequencies lie below it.", "3 Hz"))
    name = "quadrature"
    description = "integrals of the squared gains of the linear model over all frequencies"
    nonlinearity_support = it.NonlinearitySupport.NEITHER
    needs_amplitude = False
    supports_optimisation = False  # it gives no gradients

    def estimate(self, vehicle: Any, index: Any) -> it.Estimate:
        mechanism = vehicle.mechanism()
        definition = index.definition(mechanism)
        if definition.combination is not it.Combination.SUM_OF_RMS:
            raise it.InerterError(f"Quadrature is for r.m.s. values, and {index.symbol} is none.")
        names = [weighted.output for weighted in definition.outputs]
        mechanism = definition.drive.excited_mechanism(mechanism)
        paths = definition.input_paths(mechanism)
        system = it.state_space(mechanism, list(dict.fromkeys(path.input for path in paths)), names)
        omega, weights = _nodes(self.points, self.middle)
        s = 1j * omega
        resolvent = np.linalg.solve(s[:, None, None] * np.eye(system.order) - system.A, system.B + 0j)
        gains = system.C @ resolvent + system.D
        squares = np.zeros((omega.size, len(names)))
        for source in {path.source for path in paths}:
            response = np.zeros((omega.size, len(names)), dtype=complex)
            for path in paths:
                if path.source == source:
                    passed = 1.0 if path.filter is None else path.filter.response(omega)
                    factor = path.lever * passed * np.exp(-s * path.delay)
                    response += gains[:, :, system.inputs.index(path.input)] * factor[:, None]
            squares += np.abs(response) ** 2
        for column, filter in enumerate(definition.filters):
            if filter is not None:
                squares[:, column] *= np.abs(filter.response(omega)) ** 2
        rms = definition.drive.amplitude_density * np.sqrt(weights @ squares / pi)
        value = sum(abs(w.weight) * r for w, r in zip(definition.outputs, rms.tolist(), strict=True))
        return it.Estimate(value, definition.unit, notes=system.notes)

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
