"""Static stiffness of a strut or tyre: force over displacement at rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ErrorSource, PerformanceIndexError
from inerter.indices.definition import Index
from inerter.methods.error_bounds import ROUNDING
from inerter.methods.method import Estimate, Method
from inerter.methods.objective import Smooth, rows_of
from inerter.networks.elements import Bridge, CombinedNetwork, Element, Free, Friction, Network, Parallel
from inerter.networks.elements.roles import LinearRole
from inerter.networks.transform import UpsideDown, expand_elements, linearise
from inerter.validation import checked
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
_ROUNDING = 1e-12  # relative error of sums of positive terms


@dataclass(frozen=True)
class StaticStiffness:
    """Static stiffness of what is mounted under the name `mount` [N/m], the same for every method.

    Springs in parallel add up, springs in series add up their compliances; what hangs on a damper, an inerter or a
    friction lets go, and gaps are closed. 0 where nothing is left. Infinite where a gap alone joins the ends.
    """

    mount: str
    symbol = "static-stiffness"
    title = "static stiffness"
    unit = "N/m"
    response = "force per displacement at rest"

    def constituents(self, vehicle: Vehicle) -> Sequence[tuple[Vehicle, Index]]:
        """No constituents; raises `PerformanceIndexError` if nothing is mounted under the name."""
        self._network(vehicle.mechanism())
        return []

    def per_output(self, split: object, vehicle: Vehicle) -> list[StaticStiffness]:
        """List of the index alone, as it has a single output."""
        return [self]

    def estimate(self, vehicle: Vehicle, method: Method) -> Estimate:
        """The value for a vehicle without free values."""
        value = float(_Stiffness(self._network(vehicle.mechanism()), ()).values(np.zeros((1, 0)))[0])
        return Estimate(value, self.unit, error_sources=(ErrorSource(ROUNDING, _ROUNDING),))

    def estimate_many(self, vehicle: Vehicle, method: Method, points: Mapping[str, Array]) -> Array:
        """The values (designs,) at many values of the free values."""
        network = self._network(vehicle.mechanism())
        return _Stiffness(network, tuple(points)).values(rows_of(points, points))

    def as_objective(self, vehicle: Vehicle, method: Method) -> _Stiffness:
        """The stiffness as a function of the free values, with its gradient."""
        return _Stiffness(self._network(vehicle.mechanism()), tuple(vehicle.free_values()))

    def _network(self, mechanism: Mechanism) -> Network:
        mounts = {mount.name: mount.network for mount in mechanism.mounts()}
        if self.mount not in mounts:
            raise PerformanceIndexError(f"Unknown mount {self.mount!r}; available: {', '.join(mounts)}.")
        return mounts[self.mount]


@checked(PerformanceIndexError)
def static_stiffness(mount: str) -> StaticStiffness:
    """The static stiffness of the strut or tyre of this name [N/m], as an index or in a limit.

    >>> import inerter as it
    >>> strut = it.Spring(80e3) | it.Spring(60e3, "ks") - (it.Spring(30e3, "kp") | it.Damper(2000.0))
    >>> car = it.QuarterCar(sprung_mass=250.0, unsprung_mass=35.0, tyre_stiffness=150e3, strut=strut)
    >>> it.evaluate(car, it.static_stiffness("strut"), it.Norm()).value
    100000.0
    """
    return StaticStiffness(mount)


@dataclass(frozen=True, eq=False)
class _Stiffness(Smooth):
    """A `Differentiable` that needs no method."""

    network: Network
    names: tuple[str, ...]

    def values(self, points: Array) -> Array:
        """The stiffness at each row of `points`."""
        return np.broadcast_to(self._value_and_gradients(points)[0], (points.shape[0],)).copy()

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The stiffness and its gradient at one point."""
        value, gradient = self._value_and_gradients(point[None])
        return float(np.broadcast_to(value, (1,))[0]), np.broadcast_to(gradient, (point.size, 1))[:, 0].copy()

    def _value_and_gradients(self, points: Array) -> tuple[Array, Array]:
        left = linearise(expand_elements(self.network, _at_rest))
        if left.network is None:
            return np.array([np.inf if left.rigid else 0.0]), np.zeros((len(self.names), 1))
        columns = dict(zip(self.names, points.T, strict=True))
        return _stiffness(left.network, columns, np.eye(len(self.names))[:, :, None], self.names)


def _at_rest(element: Element) -> Network:
    """The element in linear analysis, but nothing in place of a damper or an inerter."""
    view = element.as_linear()
    return _NOTHING if view is element and element.linear in (LinearRole.DAMPING, LinearRole.MASS) else view


_NOTHING = Friction(0.0)


def _stiffness(network: Network, columns: Mapping[str, Array], eye: Array, names: Sequence[str]) -> tuple[Array, Array]:
    """Stiffness (n,) and gradient (names, n) of a network of springs."""
    match network:
        case Element():
            if isinstance(network.value, Free):
                place = names.index(str(network.value.name))
                return network.gain * columns[names[place]], network.gain * eye[place]
            return np.array([network.coefficient]), np.zeros((len(names), 1))
        case UpsideDown(turned):
            return _stiffness(turned, columns, eye, names)
    assert isinstance(network, CombinedNetwork)
    found = [_stiffness(part, columns, eye, names) for part in network.parts]
    stiffnesses = [k for k, _ in found]
    match network:
        case Parallel():
            total, strokes = sum(stiffnesses, np.zeros(1)), [np.ones(1)] * len(found)
        case Bridge():
            total, strokes = _bridge_stiffness(*stiffnesses)
        case _:
            total = 1.0 / sum((1.0 / k for k in stiffnesses), np.zeros(1))
            strokes = [total / k for k in stiffnesses]
    gradients = (g * x**2 for (_, g), x in zip(found, strokes, strict=True))
    return total, sum(gradients, np.zeros((len(names), 1)))


def _bridge_stiffness(a: Array, b: Array, c: Array, d: Array, e: Array) -> tuple[Array, list[Array]]:
    """Stiffness of a bridge of springs, and the elongation of each arm for an elongation of one of the whole."""
    across = (a + b) * (c + d) + e * (a + b + c + d)
    total = (e * (a + c) * (b + d) + a * b * (c + d) + c * d * (a + b)) / across
    upper, right = (b * (c + d + e) + e * d) / across, (d * (a + b + e) + e * b) / across
    left, lower = (a * (c + d + e) + e * c) / across, (c * (a + b + e) + e * a) / across
    return total, [upper, left, right, lower, (a * d - b * c) / across]
