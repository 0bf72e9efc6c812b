"""Values of the networks of a search with real inerters in them: elastic, and with friction."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

from inerter.errors import DesignError, worst_of
from inerter.methods.composite_index import estimate_of
from inerter.methods.method import Estimate, Method
from inerter.network_search.results import FoundNetwork
from inerter.networks.elements import Damper, Element, Friction, Inerter, Network, Spring
from inerter.optimisation.active_constraints import broken, constraints_at, with_limits
from inerter.optimisation.optimise import Optimum, optimise
from inerter.validation import is_number
from inerter.vehicle.replace_values import with_elements
from inerter.vehicle.vehicle import Vehicle


@dataclass(frozen=True)
class RealInerter:
    """Shaft of a ball-screw inerter: stiffness [N/m] and damping [N s/m] in series with inertance and friction.

    Source: Wang and Su (2008), Figure 6b, without backlash. The default values are those of the soft shaft of their
    Table 2, which their rig has too.

    >>> import inerter as it
    >>> device = it.RealInerter(stiffness=1e6, damping=3200.0)  # N/m and N s/m of the shaft
    >>> device.stiffness / device.damping  # 1/s
    312.5
    """

    stiffness: float = 1e6
    damping: float = 3200.0

    def network(self, inerter: Inerter, friction: float) -> Network:
        """The network of a real inerter of the same inertance; without friction [N] if that is zero.

        Raises `DesignError` for a friction that is no number, or negative.
        """
        if not is_number(friction) or friction < 0.0:
            raise DesignError(f"The friction of a real inerter must be a non-negative number of N, got {friction!r}.")
        name = inerter.label
        moved = inerter | Friction(friction, f"{name}_f") if friction > 0.0 else inerter
        return (Spring(self.stiffness, f"{name}_k") | Damper(self.damping, f"{name}_c")) - moved


@dataclass(frozen=True, eq=False)
class RealNetwork:
    """Values of a network with its best values: ideal, elastic, and with friction [N] in every inerter.

    >>> import inerter as it
    >>> place = it.Spring(60e3) | it.any_network(1, inerters=(1, 1e3)) | it.Damper(2000.0)
    >>> found = it.search(it.QuarterCar(250.0, 35.0, 180e3, place), it.RideComfort(it.Road(5e-7, 25.0)), it.Norm())
    >>> real = it.with_friction_and_elasticity(found.ranking[:1], it.StatisticalLinearisation(), frictions=[10.0])
    >>> list(real[0].with_friction), real[0].ideal == found.ranking[0].value  # N; m/s^2
    ([10.0], True)
    """

    found: FoundNetwork
    elastic: Estimate
    with_friction: dict[float, Estimate]

    @property
    def ideal(self) -> float:
        """Value with ideal inerters."""
        return self.found.value


def check_found(found: object) -> None:
    """Raise `DesignError` unless this is a network of a search."""
    if not isinstance(found, FoundNetwork):
        raise DesignError(f"Expected a network of a search, such as search(...).ranking[0], got {found!r}.")


def _with_real_inerters(vehicle: Vehicle, found: FoundNetwork, real: RealInerter, friction: float) -> Vehicle:
    """A design of a network with real inerters in it; inerters elsewhere in the vehicle stay as they are."""
    names = found.topology.names(found.plan.taken_names)

    def change(element: Element) -> Network:
        own = isinstance(element, Inerter) and element.label in names
        return real.network(element, friction) if own else element  # type: ignore[arg-type]

    return with_elements(vehicle, change)


def estimate_with_real_inerters(
    found: FoundNetwork, method: Method, real: RealInerter, friction: float = 0.0
) -> Estimate:
    """The index of a network with real inerters, its values as they are; "infeasible" where they break a constraint."""
    design, plan = _with_real_inerters(found.design, found, real, friction), found.plan
    held = constraints_at(design, plan.limits, method)
    estimate = with_limits(estimate_of(design, plan.index, method), held)
    return replace(estimate, status=worst_of((broken(held), estimate.status)))


def optimise_with_real_inerters(
    found: FoundNetwork,
    method: Method,
    *,
    friction: float = 10.0,
    real: RealInerter | None = None,
    starts: int = 8,
    executor: Executor | None = None,
) -> Optimum:
    """The best values of a network of a search with a real inerter, of friction [N], in place of each inerter.

    The index, the constraints and the seed are those of the search. A method that models friction, such as
    `StatisticalLinearisation`, finds the values; their bounds are those of the search.

    Raises what `optimise` raises, such as `DesignError` for a negative friction.

    >>> import inerter as it
    >>> place = it.Spring(60e3) | it.any_network(1, inerters=(1, 1e3)) | it.Damper(2000.0)
    >>> found = it.search(it.QuarterCar(250.0, 35.0, 180e3, place), it.RideComfort(it.Road(5e-7, 25.0)), it.Norm())
    >>> real = it.optimise_with_real_inerters(found.ranking[0], it.StatisticalLinearisation(), friction=10.0, starts=1)
    >>> sorted(real.parameters), real.unit
    (['b1'], 'm/s^2')
    """
    check_found(found)
    plan = found.plan
    design = _with_real_inerters(plan.design(found.topology), found, real or RealInerter(), friction)
    return optimise(
        design, plan.index, method, subject_to=plan.limits, seed=plan.seed, starts=starts, executor=executor
    )


def with_friction_and_elasticity(
    networks: Iterable[FoundNetwork],
    method: Method,
    *,
    frictions: Sequence[float] = (10.0, 100.0),
    real: RealInerter | None = None,
) -> list[RealNetwork]:
    """The index of some networks of a search with real inerters, their values as they are.

    `method` evaluates the designs with friction [N], the method of the search those without. Where a design breaks a
    constraint of the search, its status is "infeasible".

    Raises what `evaluate` raises, such as `DesignError` for a negative friction.

    >>> import inerter as it
    >>> place = it.Spring(60e3) | it.any_network(1, inerters=(1, 1e3)) | it.Damper(2000.0)
    >>> found = it.search(it.QuarterCar(250.0, 35.0, 180e3, place), it.RideComfort(it.Road(5e-7, 25.0)), it.Norm())
    >>> method = it.StatisticalLinearisation()
    >>> real = it.with_friction_and_elasticity(found.ranking[:1], method, frictions=[10.0, 100.0])
    >>> [sorted(each.with_friction) for each in real]  # N
    [[10.0, 100.0]]
    """
    shaft, several = real or RealInerter(), [networks] if not isinstance(networks, Iterable) else list(networks)
    for one in several:
        check_found(one)
    if isinstance(frictions, str) or not isinstance(frictions, Iterable):
        raise DesignError(f"`frictions` must be a list of forces in N, such as [10.0, 100.0], got {frictions!r}.")
    return [
        RealNetwork(
            found,
            estimate_with_real_inerters(found, found.plan.method, shaft),
            {friction: estimate_with_real_inerters(found, method, shaft, friction) for friction in frictions},
        )
        for found in several
    ]
