"""`optimise_admittance`: the best positive-real admittance of a degree in the place of a free network.

No network of that degree is better, whatever its layout, so it says what a search of networks can still gain. It is
searched in compiled code, over the coefficients of the admittance with their gradients.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, Status, StatusKind, SynthesisError
from inerter.kernels.network_norms import Port, admittance_indices
from inerter.kernels.network_polynomials import Program
from inerter.methods.composite_index import IndexLike, is_composite
from inerter.methods.error_bounds import with_verified_value
from inerter.methods.method import Estimate, evaluate
from inerter.methods.network_norm import NetworkIndex, admittance_program
from inerter.methods.norm import EXACT_NORM
from inerter.network_search.plan import SearchPlan, places_of, plan_search, with_chosen_network
from inerter.networks.elements import Damper, Network
from inerter.networks.free_network import FreeNetwork
from inerter.synthesis.best_admittance import best_admittance
from inerter.synthesis.realise import realise
from inerter.validation import check_whole
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
_DAMPERS = np.geomspace(1e-3, 1e9, 241)  # of which the best one is typical [N s/m]
_MOST = 10  # degree
_STARTS = 25  # of degree 0
_LIMITS = {1e-12: "no network", 1e12: "a rigid link"}  # by the factor of an admittance that comes close to it
_SAME = 1e-9  # relative difference of values


@dataclass(frozen=True, eq=False)
class AdmittanceResult:
    """The best admittance numerator / denominator [N s/m], highest power of s first, and the index with it.

    `n_converged` of `n_starts` searches at the highest degree ended at this value; it is the best one found, which is
    not proved to be the lowest.

    >>> import inerter as it
    >>> place = it.Spring(60e3) | it.any_network(1, dampers=(10, 1e6))
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, strut=place)
    >>> best = it.optimise_admittance(car, it.RideComfort(it.Road(5e-7, 25.0)), degree=0)  # a damper [N s/m]
    >>> round(best.numerator[0] / best.denominator[0], 6) == round(best.network().damping, 6)
    True
    """

    value: float
    unit: str
    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    n_starts: int
    n_converged: int
    vehicle: Vehicle
    index: Any
    place: FreeNetwork

    @property
    def degree(self) -> int:
        """McMillan degree of the admittance, at most the one that was asked for."""
        return max(len(self.numerator), len(self.denominator)) - 1

    def network(self) -> Network:
        """A network with this admittance; raises `SynthesisError` if none was found."""
        return self._network

    @cached_property
    def _network(self) -> Network:
        return realise(self.numerator, self.denominator)

    @cached_property
    def design(self) -> Vehicle:
        """The vehicle with that network; raises `SynthesisError` if none was found."""
        return with_chosen_network(self.vehicle, self.place, self.network())

    @cached_property
    def estimate(self) -> Estimate:
        """The index of that design by `Norm`; raises `SynthesisError` if no network was found."""
        return evaluate(self.design, self.index, EXACT_NORM)

    @cached_property
    def status(self) -> Status:
        """Whether the design of the realised network has this value."""
        try:
            return with_verified_value(self.estimate, self.value).status
        except SynthesisError as error:
            return Status(StatusKind.INACCURATE, f"the admittance has no network: {error}")


def optimise_admittance(
    vehicle: Vehicle, index: IndexLike, degree: int = 2, *, seed: int = 0, starts: int | None = None
) -> AdmittanceResult:
    """The best positive-real admittance up to a degree in the place of the free network in `vehicle`.

    The degree is the McMillan degree, the least number of springs and inerters of a network with this admittance, if
    transformers (levers) are allowed; so networks with that many springs and inerters, and any number of dampers, are
    not better. The bounds of `any_network(...)` do not matter. The search starts from `starts` admittances of this
    degree (default: 25 for degree 0, twice as many for each degree more), and from half as many of each degree below.
    The same seed gives the same result.

    The index is one of r.m.s. values that `Norm` computes, and the network is in one place.

    Raises `DesignError` without exactly one free network in one place, for other free values, for an index of another
    kind, for one that is infinite for all starts or lowest without a network or with a rigid link, or if `degree`,
    `seed` or `starts` are not valid.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.any_network(1, dampers=(10, 1e6))
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> best = it.optimise_admittance(car, it.RideComfort(it.Road(roughness=5e-7, speed=25)), 1)
    >>> round(best.value, 4), sorted(type(element).__name__ for element in best.network().elements())
    (2.4281, ['Damper', 'Inerter'])
    """
    plan = plan_search(vehicle, index, EXACT_NORM, (), seed, starts)
    check_whole(DesignError, "`degree`", degree, 0, _MOST)
    objective = _AdmittanceIndex(_compile_index(plan))
    damping, omega = objective.scales()
    try:
        found = best_admittance(
            objective.value,
            int(degree),
            damping=damping,
            omega=omega,
            seed=plan.seed,
            starts=plan.starts or _STARTS * 2 ** int(degree),
            gradient=objective.value_and_gradients,
        )
    except SynthesisError:  # the one that a valid request can have
        raise DesignError(
            f"{plan.index.symbol} is infinite for all admittances up to degree {degree} that were tried. Evaluate the "
            f"design with a damper instead of the free network to see the reason, or give another index."
        ) from None
    numerator, denominator = np.array(found.numerator), np.array(found.denominator)
    for factor, limit in _LIMITS.items():
        if objective.value(factor * numerator, denominator) <= found.value * (1.0 + _SAME):
            raise DesignError(
                f"No admittance is the best one: {plan.index.symbol} is at least as low with {limit} instead of "
                f"the free network. Give another index, or use search(...), whose bounds exclude that."
            )
    return AdmittanceResult(
        found.value,
        str(plan.index.unit),
        found.numerator,
        found.denominator,
        found.n_starts,
        found.n_converged,
        vehicle,
        index,
        plan.place,
    )


def _compile_index(plan: SearchPlan) -> NetworkIndex:
    """The index over the admittance of the free network, or the reason why there is none."""
    places, others = places_of(plan.vehicle), with_chosen_network(plan.vehicle, plan.place, Damper(1.0)).free_values()
    if len(places) > 1:
        reason = f"the free network is in {len(places)} places; put any_network(...) in one of them"
    elif others:
        reason = f"the design has other free values ({', '.join(sorted(others))}); give them as numbers"
    elif is_composite(plan.index):
        reason = f"{plan.index.symbol} is computed from several indices; give one of them"
    elif plan.compiled_index is None:
        reason = (
            f"{plan.index.symbol} has a road spectrum that is no fraction in s, or a road that reaches several axles "
            f"one after the other; give a standard road and a vehicle with one axle"
        )
    elif plan.compiled_index.definition.is_peak:
        reason = f"{plan.index.symbol} is a peak gain; give an index of r.m.s. values"
    else:
        return plan.compiled_index
    raise DesignError(f"The best admittance cannot be searched: {reason}, or use search(...).")


class _AdmittanceIndex:
    """An index over numerator and denominator of an admittance, highest power of s first."""

    def __init__(self, compiled: NetworkIndex) -> None:
        self.compiled_index = compiled
        self._prepared: dict[tuple[int, int, int], tuple[Program, Port | None]] = {}

    def value(self, numerator: Array, denominator: Array) -> float:
        """The index, infinite where it does not exist."""
        return self._evaluate(numerator, denominator, 0)[0]

    def value_and_gradients(self, numerator: Array, denominator: Array) -> tuple[float, Array, Array]:
        """The index and its gradients over both; those over zeros that are powers of s or missing ones are zero."""
        return self._evaluate(numerator, denominator, 1)

    def _evaluate(self, numerator: Array, denominator: Array, rows: int) -> tuple[float, Array, Array]:
        if not (np.isfinite(numerator).all() and np.isfinite(denominator).all() and denominator.any()):
            return np.inf, np.zeros(len(numerator)), np.zeros(len(denominator))
        (of_top, N), (of_bottom, D) = _powers(numerator), _powers(denominator)
        power = len(numerator) - of_top.stop - (len(denominator) - of_bottom.stop)
        program, port = self._prepare(power, N.size - 1, D.size - 1)
        slopes = np.zeros(len(numerator)), np.zeros(len(denominator))
        if port is None:
            return np.inf, *slopes
        top, bottom = np.zeros((rows, N.size)), np.zeros((rows, D.size))
        value = float(admittance_indices(N[None], D[None], program, port, top, bottom)[0])
        if rows:
            slopes[0][of_top], slopes[1][of_bottom] = top[0, ::-1], bottom[0, ::-1]
        return value, *slopes

    def _prepare(self, *sizes: int) -> tuple[Program, Port | None]:
        if sizes not in self._prepared:
            program = admittance_program(*sizes)
            self._prepared[sizes] = program.program, self.compiled_index.port(program)  # type: ignore[index]
        return self._prepared[sizes]  # type: ignore[index]

    def scales(self) -> tuple[float, float]:
        """The best damper [N s/m], and the geometric mean of the natural frequencies with it [rad/s]."""
        values = [self.value(np.array([c]), np.ones(1)) for c in _DAMPERS]
        best = int(np.argmin(values)) if np.isfinite(values).any() else _DAMPERS.size // 2
        damping = float(_DAMPERS[best])
        sizes = []
        for function in self.compiled_index.functions:
            high, _ = function.rounded_coefficients
            sizes += [abs(root) for root in np.roots((high[0] + damping * high[1])[::-1]) if root != 0.0]
        return damping, float(np.exp(np.mean(np.log(sizes)))) if sizes else 1.0


def _powers(p: Array) -> tuple[slice, Array]:
    """Slice of the coefficients without zeros at both ends, and these from the constant upwards; one zero for zero."""
    kept = np.flatnonzero(p)
    if kept.size == 0:
        return slice(len(p) - 1, len(p)), np.zeros(1)
    where = slice(int(kept[0]), int(kept[-1]) + 1)
    return where, np.ascontiguousarray(p[where][::-1])
