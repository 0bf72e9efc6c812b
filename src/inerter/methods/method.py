"""Interface of the methods, their estimates, and the functions that evaluate an index of a design by a method."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from enum import Enum, auto
from functools import lru_cache, partial
from math import nan
from typing import Any, Protocol, cast, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.deprecation import RenamedAttribute, adopt_renamed
from inerter.errors import OK, DesignError, ErrorSource, PerformanceIndexError, Status
from inerter.formatting import typeset
from inerter.indices.definition import ExcitedIndex, Index, IndexDefinition
from inerter.kernels.prepare import prepare_on
from inerter.methods.composite_index import (
    IndexLike,
    estimate_of,
    estimates_of,
    is_composite,
    is_index,
    without_tied_values,
)
from inerter.methods.objective import Objective, rows_of
from inerter.norms.hinf import GainPeak
from inerter.notebook import shown_by
from inerter.systems.graph import full_graph
from inerter.systems.input_paths import inputs_of
from inerter.systems.outputs import check_bounded, check_inputs, find, main_outputs, outputs
from inerter.table import Quantity
from inerter.validation import real_numbers
from inerter.vehicle.mechanism import check_known
from inerter.vehicle.vehicle import Vehicle, check_fixed, check_vehicle
from inerter.work.pool import Pool
from inerter.work.progress import logging_steps
from inerter.work.running import map_items, running_on

Array = NDArray[np.float64]
_TOGETHER = 64  # designs that are valued in one call where others take some too


@dataclass(frozen=True)
class Estimate:
    """Value of an index, with its uncertainty and status.

    What random inputs make of it is its `standard_error`; all other errors are among `error_sources`.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
    >>> found = it.evaluate(car, it.LoadCarrying(), it.Norm())
    >>> found.unit, found.status.ok, found.standard_error, found.value == found.peaks[0].gain
    ('m/N', True, None, True)
    >>> print(found)
    100.1 µm/N
    """

    _repr_html_ = shown_by("inerter.report.notebook:estimate_html")

    value: float
    unit: str
    status: Status = OK
    standard_error: float | None = None  # None: the method has no scatter
    interval: tuple[float, float] | None = None  # of 95 % confidence, where there is a standard error
    realisations: int = 0  # random inputs that were averaged
    peaks: tuple[GainPeak, ...] = ()  # local maxima of the gain, for an index that is a peak gain
    notes: tuple[str, ...] = ()  # what the method left out
    samples: tuple[float, ...] = field(default=(), repr=False)  # the value on each random input
    period: int | None = None  # of each random input [s]
    error_sources: tuple[ErrorSource, ...] = ()  # rounding, what stands in for something else, ...: not sampling
    in_conditions: tuple[Estimate, ...] = field(default=(), repr=False)  # of an index over conditions: in each

    @property
    def error_bound(self) -> float:
        """Largest relative error of the value, sampling apart: the sum of its sources; nan where the method names none.

        `ok` means that it is no larger than what the method promises.
        """
        return float(sum(source.bound for source in self.error_sources)) if self.error_sources else nan

    @property
    def shared_errors(self) -> dict[str, tuple[float, ...]]:
        """Relative effects, with their signs, of the errors of the road that all values on it share, by source."""
        return {source.name: source.shared for source in self.error_sources if any(source.shared)}

    @property
    def quantity(self) -> Quantity:
        """The value with its unit and its errors, nan for those that the method does not state."""
        error = nan if self.standard_error is None else self.standard_error
        return Quantity(self.value, self.unit, error, self.error_bound)

    def __str__(self) -> str:
        value = typeset(str(self.quantity))
        return value if self.status.ok else f"{value} ({self.status})"


class FormerMethodNames:
    """Names that attributes of methods had in 0.1.0."""

    sees = RenamedAttribute("nonlinearity_support")
    words = RenamedAttribute("description")
    searches = RenamedAttribute("supports_optimisation")


@runtime_checkable
class AveragingMethod(Protocol):
    """A method whose value is a mean over random inputs."""

    def with_realisations(self, realisations: int, period: int | None = None) -> Method:
        """Copy of the method with a fixed number of random inputs, and with `period` [s] as their length if given."""
        ...


@runtime_checkable
class MethodWithControls(Protocol):
    """Method with control variates for its samples."""

    def controls(self, vehicle: Vehicle, index: Index, count: int) -> tuple[Array, Array] | None:
        """Control variates of the first `count` samples, and of many more; None if there are none."""
        ...


@runtime_checkable
class MethodWithExactFallback(Protocol):
    """Method that is much slower where double precision does not suffice."""

    def share_unsure(self, vehicle: Vehicle, index: Index, points: Mapping[str, NDArray[np.float64]]) -> float:
        """Share of many designs for which double precision does not suffice."""
        ...


@runtime_checkable
class MethodWithChecks(Protocol):
    """Method that does not support some indices or elements, whatever the values."""

    def check(self, vehicle: Vehicle, index: Index) -> None:
        """Raises what `estimate` would raise before it computes anything."""
        ...


@runtime_checkable
class MethodWithKernels(Protocol):
    """A method that calls compiled code."""

    def kernels(self, definition: IndexDefinition, *, search: Vehicle | None, limited: bool = False) -> tuple[Any, ...]:
        """Compiled functions called by an estimate, or by a search over a vehicle; the slowest to compile first.

        A `limited` search is one within limits, as that for a front.
        """
        ...


class NonlinearitySupport(Enum):
    """Nonlinearities that a method models, in ascending order.

    >>> import inerter as it
    >>> it.Norm().nonlinearity_support is it.NonlinearitySupport.NEITHER
    True
    >>> it.ExpectedValue().nonlinearity_support is it.NonlinearitySupport.BOTH
    True
    """

    NEITHER = auto()  # friction is left out, gaps are closed
    FRICTION = auto()  # gaps are refused
    BOTH = auto()

    @property
    def words(self) -> str:
        """Modelled nonlinearities of a design in words."""
        return {"NEITHER": "no friction or gaps", "FRICTION": "with friction", "BOTH": "with friction and gaps"}[
            self.name
        ]


@runtime_checkable
class Method(Protocol):
    """Method to evaluate an index of a design.

    A method that files know is a frozen dataclass. Of `conventions`, `seed`, `realisations`, `relative_error` and
    `jobs`, it gets from a study those that it has as fields. Fields that are quantities (`quantity`) are keys of a
    section of its own there, [methods.NAME].
    """

    @property
    def name(self) -> str:
        """Name of the method in study files and results."""
        ...

    @property
    def description(self) -> str:
        """Description of the values, to follow "Values are" in a report."""
        ...

    @property
    def nonlinearity_support(self) -> NonlinearitySupport:
        """Nonlinearities that the method models."""
        ...

    @property
    def needs_amplitude(self) -> bool:
        """Whether a peak gain of a design with friction or gaps needs the amplitude of its force."""
        ...

    @property
    def supports_optimisation(self) -> bool:
        """Whether optimisers can use its `objective`."""
        ...

    def estimate(self, vehicle: Vehicle, index: Index) -> Estimate:
        """The index of a vehicle without free values."""
        ...

    def estimate_many(self, vehicle: Vehicle, indices: Sequence[Index], points: Mapping[str, Array]) -> Array:
        """The indices (designs, indices) of a vehicle at many values of its free values."""
        ...

    def objective(self, vehicle: Vehicle, index: Index) -> Objective:
        """The index as a function of the free values."""
        ...


_METHOD_NAMES = [name for name in vars(Method) if not name.startswith("_")]


def evaluate(vehicle: Vehicle, index: IndexLike, method: Method, *, executor: Executor | None = None) -> Estimate:
    """Estimate of one index of one design by one method.

    An `executor` (of `concurrent.futures`, of a dask client, of mpi4py) does what comes apart, such as random roads.

    Raises `DesignError` if the design still has free values, `MechanismError` if it is ill-posed,
    `PerformanceIndexError` if the vehicle cannot answer the index.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(4981)
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> round(it.evaluate(car, it.RideComfort(it.Road(roughness=5e-7, speed=25)), it.Norm()).value, 4)
    2.9882
    """
    several = check_request(vehicle, index, method)
    check_fixed(vehicle)
    with logging_steps() if executor is None else running_on(executor) as pool:
        if pool is not None:
            _prepare(pool, vehicle, [index], method)
        of_excited = getattr(getattr(type(method), "estimate", None), "of_excited", None)
        if of_excited is None or is_composite(index):
            return estimate_of(vehicle, index, method)
        return cast(Estimate, of_excited(method, several[0]))  # whose definition is not read again


def evaluate_many(
    vehicle: Vehicle,
    indices: Sequence[IndexLike] | IndexLike,
    values: Mapping[str, ArrayLike],
    method: Method,
    *,
    executor: Executor | None = None,
) -> Array:
    """Indices of many designs of one layout: an array (designs, indices).

    `values` gives for each free value of `vehicle` an array of one length (or one number for all designs); they
    need not lie between its bounds. Where `evaluate` would not say `ok`, the value is nan here. An `executor` (of
    `concurrent.futures`, of a dask client, of mpi4py) takes some of the designs at a time.

    Raises `DesignError` if a free value is missing, unknown, not positive or not finite, or if lengths differ; and
    what `evaluate` raises.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(it.free(100, 1e5, name="c")))
    >>> road = it.Road(5e-7, 25.0)
    >>> values = it.evaluate_many(car, [it.RideComfort(road), it.TyreLoad(road)], {"c": [1e3, 2e3, 4e3]}, it.Norm())
    >>> values.shape  # designs x indices
    (3, 2)
    """
    several = [indices] if not isinstance(indices, Sequence) else list(indices)
    if not several:
        raise PerformanceIndexError("Expected at least one index, such as RideComfort(road), got an empty list.")
    for index in several:
        check_request(vehicle, index, method)
    points = check_points(vehicle, values)
    if executor is None:
        return estimates_of(vehicle, several, method, points)
    with running_on(executor) as pool:
        _prepare(pool, vehicle, several, method)
        rows = rows_of(points, points)
        parts = np.array_split(rows, -(-len(rows) // _TOGETHER)) if len(rows) else [rows]
        return np.concatenate(map_items(partial(_estimate_rows, vehicle, several, tuple(points), method), parts))


def _prepare(pool: Pool | None, vehicle: Vehicle, indices: Sequence[IndexLike], method: Method) -> None:
    """Compile what an estimate calls where it will be called, before several processes would do so at once."""
    if isinstance(method, MethodWithKernels):
        definitions = [i.definition(v.mechanism()) for index in indices for v, i in constituents_of(vehicle, index)]
        prepare_on(pool, [k for definition in definitions for k in method.kernels(definition, search=None)])


def _estimate_rows(
    vehicle: Vehicle, indices: Sequence[IndexLike], names: Sequence[str], method: Method, rows: Array
) -> Array:
    return estimates_of(vehicle, indices, method, dict(zip(names, rows.T, strict=True)))


def constituents_of(vehicle: Vehicle, index: IndexLike) -> Sequence[tuple[Vehicle, Index]]:
    """Constituent indices of an index, each with its vehicle."""
    return index.constituents(vehicle) if is_composite(index) else [(vehicle, index)]


def check_request(vehicle: Vehicle, index: IndexLike, method: object) -> list[ExcitedIndex]:
    """Constituent indices, each for the mechanism of its vehicle.

    Raises `DesignError` or `PerformanceIndexError` for an argument of the wrong kind, and for an index that names an
    input or output which the vehicle does not have.
    """
    check_vehicle(vehicle)
    if not is_index(index):
        raise PerformanceIndexError(f"Expected an index such as RideComfort(road) or LoadCarrying(), got {index!r}.")
    if not _is_method(method):
        raise PerformanceIndexError(f"Expected a method such as Norm(), got {method!r}.")
    loose = without_tied_values(vehicle)
    found: list[ExcitedIndex] = []
    for asked, one in constituents_of(vehicle if loose is None else loose.vehicle, index):
        mechanism = asked.mechanism()
        found.append(one.definition(mechanism).excite(mechanism))
        _check_names(found[-1])
    return found


def _is_method(given: object) -> bool:
    if isinstance(given, type):
        return False
    kind: type = type(given)
    if _has_method_names(kind):  # which is found sooner than by the protocol
        return True
    if not isinstance(given, Method):  # perhaps written for the previous version
        adopt_renamed(given, sees="nonlinearity_support", words="description", searches="supports_optimisation")
    return isinstance(given, Method)


@lru_cache(maxsize=64)
def _has_method_names(kind: type) -> bool:
    return all(hasattr(kind, name) for name in _METHOD_NAMES)


def _check_names(index: ExcitedIndex) -> None:
    driven = index.excited
    check_inputs(driven, inputs_of(index.paths), PerformanceIndexError)
    usual = main_outputs(driven)
    unusual = [weighted.output for weighted in index.definition.outputs if weighted.output not in usual]
    if unusual:  # finding all names takes longer than most norms
        known = outputs(driven, full_graph(driven))
        for name in unusual:
            check_bounded(index.mechanism, driven, name)
            find(known, name, PerformanceIndexError)


def check_points(vehicle: Vehicle, values: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """`values` as float arrays of one length, one for each free value of `vehicle`; raises `DesignError`."""
    free = vehicle.free_values()
    check_known(values, free)
    missing = [name for name in free if name not in values]
    if missing:
        raise DesignError(f"Values for {', '.join(missing)} missing; every free value of the design requires some.")
    arrays: dict[str, Array] = {}
    for name, given in values.items():
        array = real_numbers(given)
        if array is None:
            raise DesignError(f"The values of {name!r} must be numbers, got {given!r}.")
        if array.ndim > 1 or not np.all(np.isfinite(array)) or not np.all(array > 0.0):
            raise DesignError(f"The values of {name!r} must be a list of positive, finite numbers.")
        arrays[name] = array
    lengths = {array.size for array in arrays.values() if array.ndim == 1}
    if len(lengths) > 1:
        sizes = ", ".join(f"{name}: {array.size}" for name, array in arrays.items())
        raise DesignError(f"Every free value must have the same number of values, got {sizes}.")
    length = lengths.pop() if lengths else 1
    return {name: np.broadcast_to(arrays[name], (length,)).copy() for name in free}
