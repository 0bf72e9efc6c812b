"""Break-even values of friction, backlash or compliance of a design against a baseline."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import scipy

from inerter.errors import OK, DesignError, Status, StatusKind, worst_of
from inerter.formatting import format_alike, format_range, format_share
from inerter.methods.compare import Comparison, compare, compare_samples
from inerter.methods.composite_index import IndexLike
from inerter.methods.conditions import values_changed
from inerter.methods.method import AveragingMethod, Method, NonlinearitySupport, check_request, evaluate
from inerter.networks.elements import Element
from inerter.networks.elements.registry import ELEMENTS
from inerter.notebook import shown_by
from inerter.validation import checked, is_number
from inerter.vehicle.replace_values import mounted_elements, to_editable, with_elements
from inerter.vehicle.vehicle import Vehicle
from inerter.work.running import running_on

_POINTS = 16  # of the grid between which crossings are sought
_REACH = 1e3  # ratio of the default bounds to the present value
_SLOPE = 0.02  # relative step of the slope's difference
_CERTAIN = 20.0  # standard errors of a difference by samples beyond which no control variate changes its sign
_WITHIN, _EXACTLY = 1e-5, 1e-11  # relative error of a crossing, of values with and without errors of the method
_PROMISE = 0.1  # relative error of a break-even value that is ok, sampling apart
_UNKNOWN = 9.0  # relative error, a factor of 10, beyond which its size says nothing


@dataclass(frozen=True)
class Crossing:
    """A break-even value of the parameter, at which design and baseline are equal."""

    value: float  # SI
    standard_error: float
    interval: tuple[float, float]  # 95 % confidence interval
    better: str  # side on which the index of the design is lower: "below" or "above"
    status: Status = OK
    error_bound: float = np.nan  # relative, sampling apart

    def may_be_at(self, logarithm: float) -> bool:
        """Whether its errors allow the crossing to be at that logarithm of the parameter."""
        reach = math.log(self.interval[1] / self.value)
        sampling = 0.0 if math.isnan(reach) else reach  # nan: the method has no standard error
        return abs(logarithm - math.log(self.value)) <= math.log1p(self.error_bound) + sampling


@dataclass(frozen=True)
class BudgetRange:
    """A range of the parameter (SI) between crossings or bounds, and whether the design is better there."""

    lower: float
    upper: float
    better: bool | None  # None: an index has no value there


@dataclass(frozen=True)
class BreakEven:
    """The values of a parameter for which a design has a lower index than a baseline.

    `value` is the end of that range: the largest friction or gap, the smallest stiffness, damping or inertance. It is
    nan, with the reason in `status`, where the design is better (or worse) at every value between `bounds`: "unbounded"
    where no error of the values compared can change that, "inaccurate" otherwise. All are in SI units; `interval` is
    the 95 % confidence interval, symmetric in the logarithm. Standard errors and intervals are nan for a method that
    models friction and has none. `error_bound` is the largest relative error, sampling apart, that the error bounds of
    the two index values allow. `status` with a value is no better than the worst of the compared estimates, and ok
    means that `error_bound` is no larger than 10 %: it is "inaccurate" by a method that names no error sources.

    >>> import inerter as it
    >>> good = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(2600.0, name="valve"))
    >>> poor = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(800.0))
    >>> load = it.TyreLoad(it.Road(5e-7, 25.0))
    >>> found = it.break_even(good, poor, load, parameter="valve", method=it.Norm(), bounds=(200.0, 2600.0))
    >>> round(found.value, 3), found.unit  # there both are the same
    (800.0, 'N s/m')
    """

    _repr_html_ = shown_by("inerter.report.notebook:break_even_html")

    parameter: str
    unit: str
    value: float
    standard_error: float
    interval: tuple[float, float]
    crossings: tuple[Crossing, ...]  # in ascending order
    ranges: tuple[BudgetRange, ...]  # between them, in ascending order, covering `bounds`
    bounds: tuple[float, float]
    status: Status
    evaluations: int
    error_bound: float = np.nan


@checked(DesignError)
def break_even(
    design: Vehicle,
    baseline: Vehicle,
    index: IndexLike,
    *,
    parameter: str,
    method: Method,
    bounds: tuple[float, float] | None = None,
    executor: Executor | None = None,
) -> BreakEven:
    """The values of `parameter` for which `design` has a lower `index` than `baseline`.

    `parameter` names elements of the struts, or of tyres, by their label, or is "friction" or "gap" for all of them.
    Where the baseline has it too, by label or by kind as in the design, it changes there in the same way, which gives
    the crossing of two curves over a stiffness. Values between `bounds` (SI; by default a thousandth to a thousand
    times the present value) are evaluated on a logarithmic grid, and each change of sign is located by Brent's method,
    on the same roads throughout. The standard error of a crossing is that of the difference, over the slope, as is its
    error bound. An `executor` shares the roads, as that of `evaluate` does.

    Where the difference of one sign is nearest to zero is sought between the points as well, so that a narrow range is
    found, but not by a method with random inputs, whose values take long: there two crossings between neighbouring
    points are not detected, and narrower bounds help.

    Raises `DesignError` for an unknown element, for elements of several kinds, for a free value without bounds, or for
    bounds that are not positive and in order; for an element whose value a condition of the index changes; and the
    errors of `evaluate`.

    >>> import inerter as it
    >>> k, c, b = it.Spring(120e3), it.Damper(7544.2), it.Inerter(366.52)
    >>> design, baseline = (
    ...     it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    ...     for strut in (k | c - (b | it.Friction(10.0)), k | it.Damper(4981))
    ... )
    >>> comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25))
    >>> found = it.break_even(design, baseline, comfort, parameter="friction", method=it.StatisticalLinearisation())
    >>> f"{round(found.value)} {found.unit}"
    '506 N'
    """
    check_request(design, index, method)
    check_request(baseline, index, method)
    chosen = _elements(design, parameter)
    if values_changed(index).intersection(element.label for element in chosen):
        raise DesignError(
            f"A condition changes {parameter!r}, which has no break-even value then; expected an element that no "
            f"condition changes."
        )
    between = _bounds(chosen, parameter, bounds)
    with running_on(executor):
        return _budget(design, baseline, index, parameter, method, chosen, between)


def _budget(
    design: Vehicle,
    baseline: Vehicle,
    index: IndexLike,
    parameter: str,
    method: Method,
    chosen: list[Element],
    between: tuple[float, float],
) -> BreakEven:
    lower, upper = between
    sampled: dict[float, Comparison] = {}
    known: dict[float, Comparison] = {}
    exact = method.nonlinearity_support is NonlinearitySupport.NEITHER
    fixed = _with_fixed_roads(design, index, method)
    by_label = chosen[0].label == parameter
    same = None if _matching(baseline, parameter, by_label) else evaluate(baseline, index, fixed)

    def designs_at(logarithm: float) -> tuple[Vehicle, Vehicle]:
        value = float(np.exp(logarithm))
        changed = with_element(design, parameter, value)
        return changed, baseline if same else with_element(baseline, parameter, value, by_label)

    def by_samples(logarithm: float) -> Comparison:
        if logarithm not in sampled:
            sampled[logarithm] = compare_samples(*designs_at(logarithm), index, fixed, (None, same))
        return sampled[logarithm]

    def difference(logarithm: float) -> float:
        if logarithm not in known:
            found = by_samples(logarithm)
            known[logarithm] = compare(*designs_at(logarithm), index, fixed, known=(found.first, found.second))
        return known[logarithm].difference.value

    def certain_difference(logarithm: float) -> float:
        found = by_samples(logarithm).difference
        return found.value if abs(found.value) > _CERTAIN * found.standard_error else difference(logarithm)

    grid = np.linspace(np.log(lower), np.log(upper), _POINTS).tolist()
    step, gaps = grid[1] - grid[0], [certain_difference(at) for at in grid]
    if not isinstance(method, AveragingMethod):
        grid, gaps = _with_turning_points(certain_difference, grid, gaps)
    crossings = tuple(
        _crossing(difference, known, a, b, parameter, exact=exact)
        for (a, left), (b, right) in pairwise(zip(grid, gaps, strict=True))
        if np.isfinite(left + right)
        and (left < 0.0) != (right < 0.0)
        and (difference(a) < 0.0) != (difference(b) < 0.0)
    )
    wanted = "below" if chosen[0].may_vanish else "above"
    ends = [c for c in crossings if c.better == wanted]
    end = None if not ends else ends[0] if wanted == "below" else ends[-1]
    ranges = _ranges(grid, gaps, crossings, between)
    asked = [sampled[at].status for at in grid if end is None or is_within_range(at, end, step)]
    clause = better_clause(ranges, parameter, chosen[0].unit)
    if end is None:
        apart = [known.get(at, sampled[at]) for at in grid if not any(c.may_be_at(at) for c in crossings)]
        located = worst_of([c.status for c in crossings])
        status = _status_without_end(apart, located, worst_of([*asked, located]), parameter, clause)
    else:
        status = worst_of((*asked, end.status))
    return BreakEven(
        parameter=parameter,
        unit=chosen[0].unit,
        value=np.nan if end is None else end.value,
        standard_error=np.nan if end is None else end.standard_error,
        interval=(np.nan, np.nan) if end is None else end.interval,
        crossings=crossings,
        ranges=ranges,
        bounds=between,
        status=status,
        evaluations=len(sampled),
        error_bound=np.nan if end is None else end.error_bound,
    )


def _with_turning_points(
    difference: Callable[[float], float], grid: Sequence[float], gaps: Sequence[float]
) -> tuple[list[float], list[float]]:
    """The grid and its differences, with the points between at which a difference of one sign is nearest to zero."""
    points = list(zip(grid, gaps, strict=True))
    for (a, left), (_, middle), (b, right) in zip(points, points[1:], points[2:], strict=False):
        side = math.copysign(1.0, middle)

        def distance(at: float, side: float = side) -> float:
            return side * difference(at)

        if math.isfinite(middle) and 0.0 < side * middle <= min(side * left, side * right):
            turn = scipy.optimize.minimize_scalar(distance, bounds=(a, b), method="bounded")
            points.append((float(turn.x), side * float(turn.fun)))
    points.sort()
    return [at for at, _ in points], [gap for _, gap in points]


def with_element(vehicle: Vehicle, parameter: str, value: float, by_label: bool | None = None) -> Vehicle:
    """The vehicle with another value (SI) of the elements that `parameter` names.

    It is a label if `by_label`, a kind if not, and for None a label where an element has it.

    Raises `DesignError` for an unknown element, or for elements of several kinds.
    """
    vehicle = to_editable(vehicle)
    chosen = {id(element) for element in _elements(vehicle, parameter, by_label)}
    return with_elements(vehicle, lambda element: element.with_value(value) if id(element) in chosen else element)


def _elements(vehicle: Vehicle, parameter: str, by_label: bool | None = None) -> list[Element]:
    """The elements of a name; raises `DesignError` for an unknown name, or elements of several kinds."""
    chosen = _matching(vehicle, parameter, by_label)
    if not chosen:
        labels = ", ".join(dict.fromkeys(e.label for several in mounted_elements(vehicle) for e in several))
        raise DesignError(
            f"unknown element {parameter!r}; available: {labels}, or {_kinds()} for all of a kind. For the break-even "
            f"friction or backlash of a design without it, add a Friction(0.0) or Gap(0.0)."
        )
    if len({(e.unit, e.value) for e in chosen if e.name is None}) > 1:
        values = " and ".join(dict.fromkeys(str(e) for e in chosen))
        raise DesignError(f"{parameter!r} is ambiguous: {values}. Name the element, as in Spring(..., name=...).")
    if len({e.unit for e in chosen}) > 1:
        raise DesignError(f"{parameter!r} names elements of different kinds. Give them different names.")
    return chosen


def _matching(vehicle: Vehicle, parameter: str, by_label: bool | None) -> list[Element]:
    """The elements of a label, in struts before tyres, or of a kind; for None those of a kind if none has the label."""
    in_struts, in_tyres = mounted_elements(vehicle)
    named = [e for e in in_struts if e.label == parameter] or [e for e in in_tyres if e.label == parameter]
    kind: list[Element] = [e for e in (*in_struts, *in_tyres) if e.may_vanish and e.key == parameter]
    return (named or kind) if by_label is None else named if by_label else kind


def _kinds() -> str:
    """Names of the kinds that select all of their elements."""
    return " or ".join(f'"{kind.key}"' for kind in ELEMENTS.values() if kind.may_vanish)


def _bounds(chosen: Sequence[Element], parameter: str, given: object) -> tuple[float, float]:
    if given is not None:
        if not isinstance(given, Sequence) or len(given) != 2 or not all(map(is_number, given)):
            raise DesignError(f"The bounds of {parameter!r} must be two numbers in SI units, got {given!r}.")
        lower, upper = float(given[0]), float(given[1])
        if not 0.0 < lower < upper:
            ends = ", ".join(format_alike([lower, upper], ""))
            raise DesignError(f"The bounds of {parameter!r} must be positive and in order, got {ends}.")
        return lower, upper
    present: Any = chosen[0].value
    if not is_number(present):
        raise DesignError(f"The value of {parameter!r} is free. Fix it, or give bounds=(lower, upper).")
    if present == 0.0:
        if chosen[0].tried is None:
            raise DesignError(f"The value of {parameter!r} is 0. Give bounds=(lower, upper) of the search.")
        return chosen[0].tried
    return present / _REACH, present * _REACH


def _with_fixed_roads(design: Vehicle, index: IndexLike, method: Method) -> Method:
    """The method with a fixed number of roads, so that differences are continuous in the parameter."""
    if not isinstance(method, AveragingMethod):
        return method
    found = evaluate(design, index, method)
    return method.with_realisations(found.realisations) if found.realisations else method


def _crossing(
    difference: Callable[[float], float],
    known: dict[float, Comparison],
    a: float,
    b: float,
    parameter: str,
    *,
    exact: bool,
) -> Crossing:
    within = _EXACTLY if exact else _WITHIN
    root = float(scipy.optimize.brentq(difference, a, b, xtol=within))
    rising = difference(b) > difference(a)
    slope = abs((difference(root + _SLOPE) - difference(root - _SLOPE)) / (2.0 * _SLOPE))
    difference(root)
    here = known[root]
    found = here.difference
    parts = (found.standard_error, found.reach, _off(here))
    error, reach, most = (part / slope if slope else np.inf for part in parts)
    if not exact and here.first.standard_error is None and here.second.standard_error is None:
        error = reach = np.nan  # there is none
    value = float(np.exp(root))
    with np.errstate(over="ignore"):
        interval = (value * float(np.exp(-reach)), value * float(np.exp(reach)))
        bound = float(np.expm1(most + within))
    status = worst_of((here.status, _within_promise(bound, here, parameter)))
    return Crossing(value, value * error, interval, "below" if rising else "above", status, bound)


def _within_promise(bound: float, here: Comparison, parameter: str) -> Status:
    """Inaccurate where the errors of the two compared values may move their crossing by more than is promised."""
    if bound <= _PROMISE:
        return OK
    if np.isnan(bound):
        return Status(
            StatusKind.INACCURATE,
            "break-even value with an unknown error: the values compared have no error bound, as the method names no "
            "error sources",
        )
    size = f"with a relative error of up to {format_share(bound, 2)}, more than {format_share(_PROMISE, 2)}"
    return Status(
        StatusKind.INACCURATE,
        f"break-even value {size if bound < _UNKNOWN else 'uncertain by more than a factor of 10'}: "
        f"{_within_errors(here)}, and change little with {parameter}",
    )


def _within_errors(one: Comparison) -> str:
    first, second = (format_share(each.error_bound, 2) for each in (one.first, one.second))
    return f"the values compared may be off by {first} and {second}"


def _ranges(
    grid: Sequence[float], gaps: Sequence[float], crossings: Sequence[Crossing], bounds: tuple[float, float]
) -> tuple[BudgetRange, ...]:
    """The ranges between crossings; one without values ends half-way to its neighbours."""
    found: list[BudgetRange] = []
    ends = [c.value for c in crossings]
    for i, (at, gap) in enumerate(zip(grid, gaps, strict=True)):
        better = bool(gap < 0.0) if np.isfinite(gap) else None
        if found and better is found[-1].better:
            continue
        begin = bounds[0]
        if found:
            half_way = float(np.exp(0.5 * (grid[i - 1] + at)))
            begin = next((end for end in ends if grid[i - 1] <= np.log(end) <= at), half_way)
            found[-1] = replace(found[-1], upper=begin)
        found.append(BudgetRange(begin, bounds[1], better))
    return tuple(found)


def is_within_range(at: float, end: Crossing, step: float) -> bool:
    """Whether a point of the grid (a logarithm) belongs to the range on the better side of its end."""
    beyond = at - float(np.log(end.value))
    return beyond <= step if end.better == "below" else beyond >= -step


def _status_without_end(
    each: Sequence[Comparison], located: Status, worst: Status, parameter: str, clause: str
) -> Status:
    """Status without a break-even value: "unbounded" where no error of the values compared can change which is lower.

    Otherwise the worst status of those values, "inaccurate" at least. `each` are the values apart from other crossings,
    of which `located` is the status.
    """
    margins = [abs(one.difference.value) - one.difference.reach - _off(one) for one in each]
    if np.min(margins, initial=np.inf) > 0.0 and located.ok:  # not of nan
        return Status(StatusKind.UNBOUNDED, clause)
    if worst.ok:
        doubt = _within_errors(each[int(np.argmin(margins))])
        worst = Status(StatusKind.INACCURATE, f"{doubt}, more than they differ at some values of {parameter}")
    has_values = any(math.isfinite(one.difference.value) for one in each)
    return Status(worst.kind, f"{worst.message.rstrip('.')}{f'. By these values {clause}' if has_values else ''}")


def _off(one: Comparison) -> float:
    """What the error bounds of two values allow their difference to be off."""
    return sum(abs(each.value) * each.error_bound for each in (one.first, one.second))


def better_clause(
    ranges: Sequence[BudgetRange], parameter: str, unit: str, better: str = "the design is better"
) -> str:
    """Clause on the values of `parameter`, in words, for which a design is `better`."""
    whole = f"{parameter} {_format_range(ranges[0].lower, ranges[-1].upper, unit)}"
    where = [_format_range(one.lower, one.upper, unit) for one in ranges if one.better]
    if all(one.better for one in ranges):
        return f"{better} for every {whole}"
    if not where:
        return f"{better} for no {whole}"
    return f"{better} {' and '.join(where)} only, of all {whole}"


def _format_range(lower: float, upper: float, unit: str) -> str:
    return f"from {format_range(lower, upper, unit)}"
