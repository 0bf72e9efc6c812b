"""`optimise`: multi-start gradient search, because these problems have many local optima."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.deprecation import RenamedAttribute
from inerter.errors import OK, DesignError, InerterError, Status, StatusKind, worst_of
from inerter.formatting import format_alike, format_quantity, typeset
from inerter.methods.compare import Comparison, Known, compare
from inerter.methods.compiled_norm import CompiledNorm
from inerter.methods.composite_index import IndexLike, estimate_of, is_composite, objective_of
from inerter.methods.error_bounds import with_verified_value
from inerter.methods.method import Estimate, Method, NonlinearitySupport, check_request
from inerter.methods.multisine_lines import SampledObjective
from inerter.methods.network_norm import TRIED, index_over_strut
from inerter.methods.norm import Norm, is_exact_norm
from inerter.methods.objective import Differentiable, snap_to_bounds
from inerter.methods.registry import with_gradients
from inerter.networks.elements import Free
from inerter.networks.free_network import check_chosen
from inerter.notebook import shown_by
from inerter.optimisation.active_constraints import ConstraintResult, constraint_results, infeasible, with_limits
from inerter.optimisation.constrained_search import (
    KEPT,
    KEPT_COSTLY,
    ConstrainedProblem,
    most_evaluations,
    searches,
    trust_region,
)
from inerter.optimisation.limits import Limit, bounds_of, check_limits, is_smooth
from inerter.optimisation.local import LocalOptimum, descend
from inerter.optimisation.starts import resumable_search, searches_from
from inerter.validation import check_whole
from inerter.vehicle.replace_values import with_networks
from inerter.vehicle.vehicle import Vehicle, value_units
from inerter.work.blas_threads import one_blas_thread
from inerter.work.checkpoints import resume_or_compute
from inerter.work.progress import report, within
from inerter.work.running import running_on

Array = NDArray[np.float64]
MOST_STARTS = 100_000
AGREEMENT = 1e-6  # relative difference up to which two starts have found the same value
COSTLY_AGREEMENT = 1e-4  # the same for values that are simulated
_MOST_TRIED, _MOST_SEARCHES = 6, 2  # starts that are evaluated, and searches from the best of them, of a costly index
_APART = 0.05  # logarithmic distance above which two starts of such searches are distinct
_QUICK = 0.1  # share of a search by simulation that its quick beginnings take
_CONFIRMED = 1e-8  # relative difference up to which two codes have found the same value
_LONELY = 1.0 / 6.0  # share of optima at which one start alone ends, from which on there may be many more of these
_RIVAL = 1.2  # times the lowest value, above which ends tell nothing of optima near it
_ALIKE, _ALIKE_PEAKS = 1e-5, 1e-3  # relative difference of ends at one optimum; of peaks only the best ones converge
_DENSER, _MORE = 4, 4  # logarithm to base two of how much denser a sample then is, and how many more starts it has
_AT_BOUND = 1e-6  # share of the logarithmic range within which a value lies on its bound


@dataclass(frozen=True)
class Optimum:
    """The best design found, with its convergence, active bounds and constraints.

    `n_converged` of `n_starts` local searches ended within 1e-6 of the best value, 1e-4 for a method that simulates
    (for a peak gain: or approached the very place where one did); `ranges` gives for each parameter the least and the
    largest value among them, which differ where the optimum is flat. `active_bounds` maps a parameter to "lower" or
    "upper" where its bound is active.

    `limits` has each constrained quantity with its value, activity and sensitivity; `active_limits` and `sensitivities`
    summarise them. Where no design is feasible, the status is "infeasible" and the design that with the smallest
    violation.

    `gain_over_linear`, for methods other than `Norm`: comparison of the optimum with the best linear design, by the
    same method on the same roads (a negative difference is an improvement); its status is not ok where the search for
    that linear design is doubtful or found none within the limits. None where linear analysis does not determine all
    values.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(it.free(100, 1e5, name="c")))
    >>> best = it.optimise(car, it.RideComfort(it.Road(5e-7, 25.0)), it.Norm())
    >>> list(best.parameters), best.unit, best.n_converged <= best.n_starts
    (['c'], 'm/s^2', True)
    >>> best.design.free_values()
    {}
    >>> print(best)
    1.842 m/s² with c = 2.387 kN s/m; 8 of 8 starts converged
    """

    _repr_html_ = shown_by("inerter.report.notebook:optimum_html")

    estimate: Estimate
    parameters: dict[str, float]
    design: Vehicle
    active_bounds: dict[str, str]
    ranges: dict[str, tuple[float, float]]
    n_starts: int
    n_converged: int
    evaluations: int
    seed: int
    gain_over_linear: Comparison | None = None
    limits: tuple[ConstraintResult, ...] = ()
    over_linear, agreed = RenamedAttribute("gain_over_linear"), RenamedAttribute("n_converged")
    starts = RenamedAttribute("n_starts")

    def __str__(self) -> str:
        units = value_units(self.design)
        values = [
            f"{name} = {typeset(format_quantity(value, units.get(name, '')))}"
            + (f" (at its {self.active_bounds[name]} bound)" if name in self.active_bounds else "")
            for name, value in self.parameters.items()
        ]
        where = f" with {', '.join(values)}" if values else ""
        doubt = "" if self.status.ok else f" ({self.status})"
        value = replace(self.estimate, status=OK)
        return f"{value}{where}; {self.n_converged} of {self.n_starts} starts converged{doubt}"

    @property
    def active_limits(self) -> tuple[str, ...]:
        """Active constraints, in words."""
        return tuple(held.label for held in self.limits if held.active)

    @property
    def sensitivities(self) -> dict[str, float]:
        """Sensitivity of the optimum to each limit [% per %], by the constraint in words.

        0 for an inactive constraint, nan where unknown.
        """
        return {held.label: held.sensitivity for held in self.limits}

    @property
    def value(self) -> float:
        """The index at the optimum."""
        return self.estimate.value

    @property
    def unit(self) -> str:
        """Unit of the index."""
        return self.estimate.unit

    @property
    def status(self) -> Status:
        """Status of the estimate."""
        return self.estimate.status


def optimise(
    vehicle: Vehicle,
    index: IndexLike,
    method: Method,
    *,
    subject_to: Sequence[Limit] = (),
    seed: int = 0,
    starts: int | None = None,
    executor: Executor | None = None,
) -> Optimum:
    """Minimise `index` over the free values of `vehicle`, within their bounds.

    A quasi-random sample in the logarithms of the values is searched for local minima; the best `starts` of them
    (default: 8 for each free value) start a gradient method each: L-BFGS-B, for a peak gain a minimax search with
    SLSQP. The same seed gives the same result. Where `Norm` needs no delay and all free values are in one strut, the
    whole search is compiled (`methods.network_norm`): each start is the best of 32 points of the sample, and the best
    value is kept if the norms of other code agree with it.

    A method that simulates is searched without derivatives (COBYQA), from the best two among the best linear design and
    the local optima of a quick approximation that many starts find; `n_converged` then counts searches within 1e-4 of
    the best.

    `subject_to` are constraints: `at_most`, `at_least` or `equal` of other indices by the same method, or of
    `static_stiffness`. Then all searches are SLSQP, or COBYQA, with constraints in logarithms. An optimum satisfies
    them within 1e-7, or 1e-4 for simulated quantities.

    An `executor` (of `concurrent.futures`, of a dask client, of mpi4py) shares the random roads of such a method.

    Raises `PerformanceIndexError` for an invalid constraint, `DesignError` without free values, for a free value
    without effect in the method, or if `starts` is not a positive integer; and the errors of `evaluate`.

    >>> import inerter as it
    >>> car = it.QuarterCar(181.75, 25.0, 120e3, it.Spring(120e3) | it.Damper(it.free(100, 1e5, name="c")))
    >>> best = it.optimise(car, it.RideComfort(it.Road(roughness=5e-7, speed=25.0)), it.Norm())
    >>> round(best.value, 3), round(best.parameters["c"])  # m/s^2, N s/m: Wang and Su (2008), Table 1
    (2.988, 4981)
    """
    check_request(vehicle, index, method)
    free = check_free(vehicle)
    starts = default_starts(free) if starts is None else starts
    check_whole(DesignError, "`starts`", starts, 1, MOST_STARTS)
    check_whole(DesignError, "`seed`", seed)
    limits = check_limits(subject_to)
    with one_blas_thread(), running_on(executor):
        return _best(vehicle, index, method, free, limits, int(seed), starts)


def _best(
    vehicle: Vehicle,
    index: IndexLike,
    method: Method,
    free: dict[str, Free],
    limits: tuple[Limit, ...],
    seed: int,
    starts: int,
) -> Optimum:
    lower = np.array([value.lower for value in free.values()])
    upper = np.array([value.upper for value in free.values()])
    objective = objective_of(vehicle, index, method)
    problem = ConstrainedProblem(objective, bounds_of(vehicle, limits, method), lower, upper)
    quick = isinstance(objective, Differentiable) and is_smooth(problem.bounds)
    agreement = AGREEMENT if quick else COSTLY_AGREEMENT
    linear = None
    if method.nonlinearity_support is not NonlinearitySupport.NEITHER:
        with within("best linear design", 0.0, 0.5 * _QUICK):
            linear = _linear_optimum(vehicle, index, method, limits, seed, starts)
    first: list[Array] = []
    if quick:
        search = partial(_quick_search, vehicle, index, method, problem)
        found, first, evaluations, lowest = _search_widely(problem, search, starts, seed)
        lowest_known = min((local.value for local in found if local.excess <= KEPT), default=np.inf)
    else:
        first = [] if linear is None else [_point_of(linear)]
        with within("quick approximation", 0.5 * _QUICK, _QUICK):
            near, lowest = _quick_optima(vehicle, index, method, limits, (lower, upper), starts, seed)
            first += [local.point for local in near]
            lowest_known = near[0].value if near else np.inf
        found, evaluations = _costly_searches(problem, _distinct_points(first))
    evaluations += sum(local.evaluations for local in found)
    kept = KEPT if quick else KEPT_COSTLY
    best = min(found, key=lambda local: (max(local.excess, kept), local.value), default=None)
    if best is None or not np.isfinite(best.value):
        best = LocalOptimum(np.sqrt(lower * upper), np.inf, 0)
    if best.excess > kept and quick:
        nearest = _closest_design(problem, first)
        again = _searches(problem, [nearest.point]) if nearest.excess <= kept else [nearest]
        found, best = again, again[0]
    same = [
        local.point for local in found if local.value <= best.value * (1.0 + agreement) and local.excess <= kept
    ] or [best.point]
    point = snap_to_bounds(best.point, lower, upper)
    parameters = dict(zip(free, point.tolist(), strict=True))
    design = vehicle.with_values(parameters)
    over_linear = None
    if linear is not None:
        known: Known = (None, None)
        if isinstance(objective, SampledObjective):
            at_linear = _point_of(linear)
            known = objective.estimate_at(point, method.estimate), objective.estimate_at(at_linear, method.estimate)
        over_linear = _with_doubt(compare(design, linear.design, index, method, known=known), linear.status)
    held = constraint_results(
        problem, design, method, point, known=quick and best.excess <= kept and np.isfinite(best.value)
    )
    estimate = over_linear.first if over_linear else with_verified_value(estimate_of(design, index, method), best.value)
    estimate = with_limits(estimate, held)
    if estimate.status.ok and max(lowest, default=0.0) > lowest_known * (1.0 + AGREEMENT):
        estimate = replace(estimate, status=_many_optima_status(lowest, estimate.unit, quick))
    if not best.excess <= kept:
        estimate = replace(estimate, status=infeasible(held, parameters, vehicle.mechanism().units()))
    return Optimum(
        estimate=estimate,
        parameters=parameters,
        design=design,
        active_bounds=active_bounds(free, parameters),
        ranges={name: (min(c), max(c)) for name, c in zip(free, np.array(same).T.tolist(), strict=True)},
        n_starts=len(found),
        n_converged=len(same) if found else 0,
        evaluations=evaluations,
        seed=seed,
        gain_over_linear=over_linear,
        limits=held,
    )


def _search_widely(
    problem: ConstrainedProblem,
    search: Callable[..., tuple[list[LocalOptimum], list[Array], int]],
    starts: int,
    seed: int,
) -> tuple[list[LocalOptimum], list[Array], int, list[float]]:
    """Ends of a `search`, its starting points and its evaluations; with two further ones where there are many optima.

    Also the lowest values of these two, which must agree.
    """
    found, first, evaluations = search(starts, seed)
    lowest: list[float] = []
    if has_many_optima(found, _is_peak(problem)):
        for number in (1, 2):
            further, _, tried = search(_MORE * starts, seed + number, _DENSER)
            lowest.append(min((local.value for local in further if local.excess <= KEPT), default=np.inf))
            found, evaluations = found + further, evaluations + tried
    return found, first, evaluations, lowest


def _is_peak(problem: ConstrainedProblem) -> bool:
    """Whether an index without limits is a peak gain, of which a search converges only the best optima."""
    assert isinstance(problem.objective, Differentiable)
    return not problem.bounds and problem.objective.active(problem.lower) is not None


def _quick_search(
    vehicle: Vehicle,
    index: IndexLike,
    method: Method,
    problem: ConstrainedProblem,
    starts: int,
    seed: int,
    denser: int = 0,
) -> tuple[list[LocalOptimum], list[Array], int]:
    """Local optima by gradients, starting points where they are known, and the number of evaluations of their sample.

    The sample is denser by that power of two.
    """
    compiled = _compiled_searches(vehicle, index, method, problem, starts, seed)
    if compiled is not None:
        return compiled, [], 0
    points, evaluations = _starting_points(problem, starts, seed, denser)
    return _searches(problem, points), points, evaluations


def _compiled_searches(
    vehicle: Vehicle, index: IndexLike, method: Method, problem: ConstrainedProblem, starts: int, seed: int
) -> list[LocalOptimum] | None:
    """Local optima in compiled code, where all free values are in one strut and norms need no delay.

    None elsewhere, and where by other code no start reaches the best value: a sharp peak or a rounding may be missed.
    Limits are left out of these searches: if the best design of all keeps them, it is the best within them too.
    """
    objective = problem.objective
    if not isinstance(objective, CompiledNorm) or not is_exact_norm(method) or is_composite(index):
        return None
    over = index_over_strut(vehicle, index)
    if over is None:
        return None
    order = [list(objective.problem.descriptor.free).index(name) for name in over.names]
    samples = quasi_random_points(starts * TRIED, len(order), seed)
    if not problem.bounds:  # else other searches may follow, which report their own shares
        report("starts", 0, starts, share=0.0)
    found = over.search(samples)
    if not np.isfinite(found.values.min()):
        return None
    points = np.empty_like(found.points)
    points[:, order] = found.points
    values = replace(objective, is_regular=found.is_regular).evaluate_points(points)
    lowest = found.values.min()
    if not abs(np.fmin.reduce(values) - lowest) <= _CONFIRMED * lowest:
        return None
    excess = problem.excess(points) if problem.bounds else np.zeros(len(points))
    if excess[np.nanargmin(values)] > 0.0:
        return None
    if not problem.bounds:
        report("starts", starts, starts, best=float(np.nanmin(values)), share=1.0)
    return [
        LocalOptimum(point, value if np.isfinite(value) else np.inf, evaluations, over)
        for point, value, evaluations, over in zip(
            points, values.tolist(), found.evaluations.tolist(), excess.tolist(), strict=True
        )
    ]


def _closest_design(problem: ConstrainedProblem, first: list[Array]) -> LocalOptimum:
    """The design with the smallest constraint violation."""
    missed = replace(problem, objective=None)
    order = np.argsort(missed.values(np.array(first)), kind="stable")[:_MOST_TRIED]
    found = searches(missed, [first[i] for i in order])
    return min(found, key=lambda local: local.excess)


def _linear_optimum(
    vehicle: Vehicle, index: IndexLike, method: Method, limits: tuple[Limit, ...], seed: int, starts: int
) -> Optimum | None:
    """The best linear design under the conventions of `method`; None if not determined by linear analysis."""
    norm = Norm(getattr(method, "conventions", "exact"))
    try:
        found = optimise(vehicle, index, norm, subject_to=limits, seed=seed, starts=starts)
    except InerterError:
        return None
    return found if np.isfinite(found.value) else None


def _point_of(found: Optimum) -> Array:
    return np.array(list(found.parameters.values()))


def _with_doubt(over_linear: Comparison, searched: Status) -> Comparison:
    """The comparison with a linear design that is the best one only if the status of its search is ok."""
    doubt = replace(searched, message=f"best linear design: {searched.message}") if not searched.ok else searched
    second = over_linear.second
    return replace(over_linear, second=replace(second, status=worst_of((second.status, doubt))))


def _quick_optima(
    vehicle: Vehicle,
    index: IndexLike,
    method: Method,
    limits: tuple[Limit, ...],
    bounds: tuple[Array, Array],
    starts: int,
    seed: int,
) -> tuple[list[LocalOptimum], list[float]]:
    """Local optima, the best first, of the first quick method that supports the design; else points of a sample.

    Also the lowest values of two searches that must agree, where there are many local optima.
    """
    for quick in with_gradients(getattr(method, "conventions", "exact")):
        try:
            problem = ConstrainedProblem(
                objective_of(vehicle, index, quick), bounds_of(vehicle, limits, quick), *bounds
            )
            if not (isinstance(problem.objective, Differentiable) and is_smooth(problem.bounds)):
                continue
            found, _, _, lowest = _search_widely(problem, partial(_approximate_search, problem), starts, seed)
        except InerterError:
            continue
        found = [local for local in found if np.isfinite(local.value)]
        return sorted(found, key=lambda local: (max(local.excess, KEPT), local.value)), lowest
    problem = ConstrainedProblem(objective_of(vehicle, index, method), (), *bounds)
    points, _ = _starting_points(problem, _MOST_TRIED, seed)
    return [LocalOptimum(point, np.inf, 0) for point in points], []


def _approximate_search(
    problem: ConstrainedProblem, starts: int, seed: int, denser: int = 0
) -> tuple[list[LocalOptimum], list[Array], int]:
    """As `_quick_search`, of an approximation."""
    points, evaluations = _starting_points(problem, starts, seed, denser)
    return _searches(problem, points, quick=True), points, evaluations


def _distinct_points(points: list[Array]) -> list[Array]:
    """The first few distinct points."""
    chosen: list[Array] = []
    for point in points:
        if all(np.abs(np.log(point / other)).max() > _APART for other in chosen):
            chosen.append(point)
    return chosen[:_MOST_TRIED]


def most_simulated(free: int, limited: bool) -> int:
    """Largest number of designs that a search of this many free values by simulation evaluates; 0 without free values.

    >>> most_simulated(2, limited=False)
    246
    """
    return _MOST_TRIED + _MOST_SEARCHES * most_evaluations(free, limited) if free else 0


def _costly_searches(problem: ConstrainedProblem, tried: list[Array]) -> tuple[list[LocalOptimum], int]:
    """Searches from the best two starts, and the number of starts evaluated to select them."""
    values = problem.values(np.array(tried)) if tried else np.zeros(0)
    best_first = np.argsort(values, kind="stable")[:_MOST_SEARCHES]
    found = []
    for number, i in enumerate(best_first):
        shares = _QUICK + (1.0 - _QUICK) * np.array([number, number + 1]) / len(best_first)
        with within(f"search {number + 1} of {len(best_first)}", *shares.tolist()):
            found.append(resumable_search(tried[i], partial(trust_region, problem, tried[i])))
    return found, len(tried)


def _searches(problem: ConstrainedProblem, first: list[Array], quick: bool = False) -> list[LocalOptimum]:
    """A local search from each start; within limits and for a peak gain only those close to the best are converged.

    A `quick` one ends close to where another one has ended.
    """
    objective, lower, upper = problem.objective, problem.lower, problem.upper
    assert isinstance(objective, Differentiable)
    if problem.bounds or (first and objective.active(first[0]) is not None):
        return searches(problem, first)
    return searches_from(
        first, lambda start, found: descend(objective, start, lower, upper, found if quick else ()), 1.0
    )


def default_starts(free: Mapping[str, Free]) -> int:
    """Starts of a search for the best of these free values, unless there are many local optima."""
    return 8 * len(free)


def check_free(vehicle: Vehicle) -> dict[str, Free]:
    """The free values of `vehicle`; raises `DesignError` without any, or if one may be zero."""
    free = vehicle.free_values()
    if not free:
        with_networks(vehicle, check_chosen)
        raise DesignError("The design has no free value to optimise. Define one with free(lower, upper).")
    for name, value in free.items():
        if value.lower == 0.0:
            raise DesignError(f"The lower bound of {name!r} is 0; the search in logarithms requires a positive bound.")
    return free


def has_many_optima(found: Sequence[LocalOptimum], is_peak: bool) -> bool:
    """Whether many searches ended at optima where no other did, as on the ripples that a delay makes at low speed.

    Their share estimates the probability that a further search ends at an optimum that is not known yet (Good, 1953).
    Where the optimum is flat, they end in several places with one value. Ends far above the lowest, or outside the
    limits, do not count; where there are some outside, a single one within is alone too.
    """
    kept = np.log([local.value for local in found if np.isfinite(local.value) and local.excess <= KEPT])
    if not kept.size:
        return False
    rivals = kept[kept < np.log(_RIVAL) + kept.min()]
    others = (np.abs(rivals[:, None] - rivals) < (_ALIKE_PEAKS if is_peak else _ALIKE)).sum(axis=1) - 1
    alone = int(np.sum(others == 0))
    return bool(alone >= max(_LONELY * rivals.size, 2 if kept.size == len(found) else 1))


def _many_optima_status(lowest: Sequence[float], unit: str, is_own: bool) -> Status:
    """Status where two searches differ, of the index itself or of its quick approximation."""
    by = "" if is_own else " of a quick approximation"
    found = f"one of two searches{by} from independent starts found no design within the limits"
    if np.all(np.isfinite(lowest)):
        first, second = format_alike(lowest, unit)
        found = f"two searches{by} from independent starts found {first} and {second} among many local optima"
    return Status(StatusKind.INACCURATE, f"{found}, so that a better one may exist")


def _starting_points(problem: ConstrainedProblem, starts: int, seed: int, denser: int = 0) -> tuple[list[Array], int]:
    """The lowest local minima of a sample: points that are lower than all their neighbours."""
    lower, upper = problem.lower, problem.upper
    count = max(2 ** min(6 + denser + lower.size, 12 + denser // 2), 2 ** math.ceil(math.log2(starts)))
    unit = quasi_random_points(count, lower.size, seed)
    points = np.exp(np.log(lower) + unit * (np.log(upper) - np.log(lower)))
    report("samples", 0, len(points), share=0.0)

    def best_first() -> list[int]:
        values = problem.values(points)
        neighbours = np.asarray(scipy.spatial.KDTree(unit).query(unit, k=4 * lower.size + 1)[1])
        order = np.argsort(values, kind="stable").tolist()
        minima = [i for i in order if np.isfinite(values[i]) and values[i] <= values[neighbours[i]].min()]
        known = set(minima)
        others = [i for i in order if np.isfinite(values[i]) and i not in known]
        return (minima + others)[:starts]

    return [points[int(i)] for i in resume_or_compute(points[:starts].tobytes(), best_first)], len(points)


@lru_cache(maxsize=16)
def quasi_random_points(count: int, size: int, seed: int) -> Array:
    """Quasi-random points of a unit cube (a row each), to be read only: an additive recurrence from a random start.

    Its steps are the powers of the inverse root of x**(size + 1) = x + 1 (M. Roberts, The unreasonable effectiveness of
    quasirandom sequences, 2018). SciPy's sequences are as good, but `scipy.stats` takes half a second to load.
    """
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (size + 1))
    steps = root ** -np.arange(1.0, size + 1.0)
    points = np.asarray((np.random.default_rng(seed).random(size) + np.outer(np.arange(count), steps)) % 1.0)
    points.flags.writeable = False  # they are kept
    return points


def active_bounds(free: Mapping[str, Free], parameters: Mapping[str, float]) -> dict[str, str]:
    """Free values that lie at a bound, with "lower" or "upper"."""
    active = {}
    for name, value in free.items():
        place = np.log(parameters[name] / value.lower) / np.log(value.upper / value.lower)
        if place < _AT_BOUND:
            active[name] = "lower"
        elif place > 1.0 - _AT_BOUND:
            active[name] = "upper"
    return active
