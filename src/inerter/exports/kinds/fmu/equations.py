"""Equations of a model over its parameters, from which an FMU makes its matrices anew when a value is set.

A descriptor is affine in the values of elements and in masses: it is a constant and a slice for each of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.networks.elements import Free
from inerter.networks.elements.roles import LinearRole
from inerter.systems.descriptor import Descriptor, describe_with_parameters
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class FmuParameter:
    """A number that a host may set before a run begins, and during it if it is tunable."""

    name: str
    unit: str
    value: float
    is_tunable: bool = False
    may_vanish: bool = False
    description: str = ""


@dataclass(frozen=True, eq=False)
class Equations:
    """Rows over (unknowns, states, inputs) as stacks (1 + parameters, rows, columns): a constant, and a slice for each.

    The `balance` is zero and has as many rows as there are unknowns, which it determines.
    """

    balance: Matrix
    rates: Matrix
    outputs: Matrix
    motions: Matrix  # of friction and gaps
    parameters: tuple[FmuParameter, ...]

    @property
    def unknowns(self) -> int:
        """Number of the unknowns."""
        return int(self.balance.shape[1])

    @property
    def rows(self) -> Matrix:
        """All rows, in the order in which a library has them."""
        return np.concatenate([self.balance, self.rates, self.outputs, self.motions], axis=1)


def equations_of(mechanism: Mechanism, inputs: tuple[str, ...], outputs: tuple[str, ...]) -> Equations | None:
    """The equations of the linear model of a mechanism; None where its structure depends on values.

    On moving ground masses are part of the structure, and no parameters.
    """
    found = describe_with_parameters(mechanism, inputs, outputs)
    if found is None:
        return None
    d, values = found
    graph = d.model.graph
    of = {str(b.element.value.name): b for b in graph.branches}  # type: ignore[union-attr]
    masses = {str(c.inertia.name): c for c in d.mechanism.masses.values() if isinstance(c.inertia, Free)}
    parameters = []
    for name in d.free:
        if name in of:
            element = of[name].element
            is_damper = element.linear is LinearRole.DAMPING
            parameters.append(FmuParameter(of[name].label, element.unit, values[name], is_tunable=is_damper))
        else:
            parameters.append(
                FmuParameter(mass_name(masses[name].name, masses[name].angle), masses[name].unit, values[name])
            )
    return _join(d, tuple(parameters))


def mass_name(coordinate: str, angle: bool) -> str:
    """The name of the inertia of a coordinate as a parameter."""
    return f"{coordinate}_{'moment_of_inertia' if angle else 'mass'}"


def _join(d: Descriptor, parameters: tuple[FmuParameter, ...]) -> Equations:
    S, R, F, Y_eta, Y_x, Y_u = (stack.astype(float) for stack in d.stacks)
    rates = np.zeros((len(S), d.X_x.shape[0], S.shape[2] + R.shape[2] + F.shape[2]))
    rates[0] = np.hstack([d.X_eta, d.X_x, d.X_u])
    balance = np.concatenate([S, -R, -F], axis=2)
    return Equations(balance, rates, np.concatenate([Y_eta, Y_x, Y_u], axis=2), rates[:, :0], parameters)
