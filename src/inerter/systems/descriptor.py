"""Equations of motion of a mechanism as one linear solve whose coefficients are affine in the element values.

With the states x = (velocities a, elongations g), the inputs u (road velocities, then forces) and the unknowns
eta = (accelerations of R and U, velocities of Y, elongations zeta, velocities of U) of `coordinates`, and the
velocities of Z where an output asks for them:

    S(p) eta = R(p) x + F(p) u
    x'       = X_eta eta + X_x x + X_u u
    y        = Y_eta(p) eta + Y_x(p) x + Y_u(p) u

Each element adds its value times products of its incidence rows, so every array is a constant plus a sum over the
free values p: an array (1 + m, ...) whose first slice is the constant. Road displacement never appears: the
tyre's elongation is a state and the road's velocity the input, which makes J1 and J3 plain H2 norms.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, lru_cache, partial
from itertools import accumulate, pairwise
from math import prod
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import DesignError, InerterError, LinearSystemError
from inerter.networks.elements import Free
from inerter.networks.elements.roles import LinearRole
from inerter.systems.coordinate_split import Frame, Long, split
from inerter.systems.coordinates import combination
from inerter.systems.filters import Filter
from inerter.systems.force_balance import balance
from inerter.systems.graph import Graph, linear_graph
from inerter.systems.incidence import incidence_rows, of_law
from inerter.systems.lever_arms import BranchRows
from inerter.systems.linear import ExtendedMatrices, LinearSystem, Origin
from inerter.systems.observe import StackedOutput, observe, observed_by_default
from inerter.systems.outputs import Output, check_inputs, force_of, input_names, main_outputs
from inerter.systems.polynomials import Polynomial, TransferFunctions
from inerter.systems.structure import Structure, once_per_structure, structure_of
from inerter.systems.transfer import transfer_functions
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]
Names = tuple[str, ...] | None
Sum = Sequence[tuple[str, tuple[Polynomial, Polynomial] | None]]  # inputs of the mechanism, with factors
_ROUNDING = float(np.finfo(np.longdouble).eps)
_MOST_VALUES = 30  # of a structure that is kept, which takes some 2 MB then
_TERMS = 8  # roundings in an entry of A, B, C or D: those of its terms, their sums, their products and quotients


@dataclass(frozen=True, eq=False)
class Model:
    """A mechanism with its linear graph and outputs, whose values may be parameters."""

    mechanism: Mechanism
    graph: Graph
    outputs: Mapping[str, Output]


@dataclass(frozen=True, eq=False)
class JoinedStacks:
    """Stacks of several matrices as one (1 + m, entries), so that one product gives all of them at some values."""

    rows: NDArray[Any]
    shapes: tuple[tuple[int, ...], ...]

    @classmethod
    def of(cls, stacks: Sequence[NDArray[Any]]) -> JoinedStacks:
        """The given stacks, side by side."""
        joined = np.concatenate([stack.reshape(len(stack), -1) for stack in stacks], axis=1)
        return cls(joined, tuple(stack.shape[1:] for stack in stacks))

    @cached_property
    def places(self) -> list[tuple[slice, tuple[int, ...]]]:
        """Columns and shape of each matrix."""
        edges = [0, *accumulate(map(prod, self.shapes))]
        return [(slice(*ends), shape) for ends, shape in zip(pairwise(edges), self.shapes, strict=True)]

    def at(self, p: NDArray[Any]) -> list[NDArray[Any]]:
        """Each matrix at the values `p`, of which the first is 1."""
        row = p.dot(self.rows)
        return [row[columns].reshape(shape) for columns, shape in self.places]

    def combine(self, weights: NDArray[Any]) -> list[NDArray[Any]]:
        """Stacks of sums of the slices with `weights` (slices of the result, 1 + m)."""
        rows = weights @ self.rows
        return [rows[:, columns].reshape(len(rows), *shape) for columns, shape in self.places]


@dataclass(frozen=True, eq=False)
class Descriptor:
    """The arrays of the module's docstring, the names of everything, and the free values with their bounds."""

    S: Matrix
    R: Matrix
    F: Matrix
    X_eta: Matrix
    X_x: Matrix
    X_u: Matrix
    Y_eta: Matrix
    Y_x: Matrix
    Y_u: Matrix
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    free: dict[str, Free]
    notes: tuple[str, ...]
    sizes: tuple[Matrix, ...]  # of S, R, F, Y_eta, Y_x, Y_u: with the sizes of all terms in place of the terms
    mechanism: Mechanism
    model: Model
    parameters: Mapping[str, float | Free] = field(default_factory=dict)  # values of the model by name
    filters: tuple[Filter | None, ...] = ()  # that the outputs pass through, if any do (see `with_filters`)
    sums: Mapping[str, Sum] = field(default_factory=dict)  # of what each input is made, if not itself (see `arrivals`)
    precision_warning: str = ""  # why digits of the matrices are uncertain; empty where they are certain

    @property
    def stacks(self) -> tuple[Matrix, ...]:
        """S, R, F, Y_eta, Y_x and Y_u, which are affine in the free values."""
        return self.S, self.R, self.F, self.Y_eta, self.Y_x, self.Y_u

    @property
    def arrays(self) -> tuple[Matrix, ...]:
        """All arrays in the order in which compiled code takes them."""
        all_arrays = self.S, self.R, self.F, self.X_eta, self.X_x, self.X_u, self.Y_eta, self.Y_x, self.Y_u
        return tuple(np.ascontiguousarray(array, dtype=float) for array in all_arrays)

    @cached_property
    def joined_stacks(self) -> JoinedStacks:
        """S, [R F], G and J at all values: x' and y are G eta + J (x, u)."""
        S, R, F, Y_eta, Y_x, Y_u = self.stacks
        return self._join(S, R, F, (self.X_eta, self.X_x, self.X_u), (Y_eta, Y_x, Y_u))

    @cached_property
    def joined_sizes(self) -> JoinedStacks:
        """Sizes of the terms of `joined_stacks`; of rates, which are exact, over the number of roundings of others."""
        S, R, F, Y_eta, Y_x, Y_u = self.sizes
        rates = tuple(np.abs(matrix) / _TERMS for matrix in (self.X_eta, self.X_x, self.X_u))
        return self._join(S, R, F, rates, (Y_eta, Y_x, Y_u))

    def _join(self, S: Any, R: Any, F: Any, rates: Sequence[Matrix], outputs: Sequence[Any]) -> JoinedStacks:
        above = [np.concatenate((X[None], np.zeros((len(S) - 1, *X.shape)))) for X in rates]
        G, J_x, J_u = (np.concatenate(both, axis=1) for both in zip(above, outputs, strict=True))
        return JoinedStacks.of([S, np.concatenate((R, F), axis=2), G, np.concatenate((J_x, J_u), axis=2)])

    def with_stacks(self, stacks: Iterable[Matrix], sizes: Iterable[Matrix], **others: Any) -> Descriptor:
        """Copy with other stacks, their sizes, and other attributes by name."""
        S, R, F, Y_eta, Y_x, Y_u = stacks
        return replace(self, S=S, R=R, F=F, Y_eta=Y_eta, Y_x=Y_x, Y_u=Y_u, sizes=tuple(sizes), **others)


def close(
    descriptor: Descriptor,
    values: Mapping[str, float],
    sources: tuple[str, ...] = (),
    delays: Sequence[float] = (),
) -> LinearSystem:
    """The linear system at numbers for the free values, with the sources and delays of its inputs.

    Raises `DesignError` if one of them has no value.
    """
    missing = [name for name in descriptor.free if name not in values]
    if missing:
        raise DesignError(
            f"The value of {', '.join(missing)} is still free. Give numbers with with_values(...), or optimise first."
        )
    d, p = descriptor, np.array([1.0, *[values[name] for name in descriptor.free]], dtype=float)
    S, right, G, direct = d.joined_stacks.at(p.astype(np.longdouble))
    S_size, right_size, G_size, direct_size = d.joined_sizes.at(p)
    T, T_error = _solve_extended(S, right, S_size, right_size)
    whole = direct + G.dot(T)
    with np.errstate(invalid="ignore"):  # nothing times infinite: as unsure
        error = np.abs(G).astype(float).dot(T_error)
    error += _TERMS * _ROUNDING * (direct_size + G_size.dot(np.abs(T).astype(float)))
    n = len(d.X_x)
    through = whole[:, n:]
    through[np.abs(through) <= error[:, n:]] = 0.0  # white noise that reaches an output by rounding would be infinite
    fine = ExtendedMatrices(whole, error, n)
    rounded = fine.double_precision
    origin = Origin(partial(exact_functions, d, dict(values)), rounded, fine, d.inputs, d.outputs)
    return _named_system(d, sources, tuple(delays)).with_matrices(rounded, origin)


@lru_cache(maxsize=64)
def _named_system(d: Descriptor, sources: tuple[str, ...], delays: tuple[float, ...]) -> LinearSystem:
    """System of the names of a descriptor, without its numbers."""
    (n, m), p = d.X_u.shape, len(d.outputs)
    return LinearSystem(
        A=np.zeros((n, n)),
        B=np.zeros((n, m)),
        C=np.zeros((p, n)),
        D=np.zeros((p, m)),
        states=d.states,
        inputs=d.inputs,
        outputs=d.outputs,
        delays=np.array(delays),
        sources=sources,
        notes=d.notes,
    )


def _solve_extended(S: Matrix, right: Matrix, S_size: Matrix, right_size: Matrix) -> tuple[Matrix, Matrix]:
    """S^-1 right in extended precision, and its error: infinite where S is singular to rounding."""
    if not S.size:  # which LAPACK refuses
        return right, np.zeros(right.shape)
    size = np.maximum.reduce(np.abs(S), axis=1, keepdims=True)
    scaled, right = S / size, right / size
    _, _, inverse, singular = scipy.linalg.lapack.dgesv(scaled.astype(float), _identity(len(S)))
    if singular:
        return np.zeros_like(right), np.full(right.shape, np.inf)
    solved = step = inverse.dot(right.astype(float)).astype(np.longdouble)
    terms = S_size.dot(np.abs(solved).astype(float)) + right_size
    rounding = _TERMS * _ROUNDING * np.abs(inverse).dot(terms / size.astype(float))  # `@` takes twice as long as `dot`
    for _ in range(3):
        step = inverse.dot((right - scaled.dot(solved)).astype(float))
        solved = solved + step
    return solved, np.abs(step) + rounding


@cache
def _identity(n: int) -> Matrix:
    return np.eye(n)


def exact_functions(
    descriptor: Descriptor,
    values: Mapping[str, float],
    inputs: Sequence[str],
    outputs: Sequence[str],
    *,
    reduced: bool = True,
) -> TransferFunctions:
    """Transfer functions without rounding, filters included; see `transfer_functions`."""
    sums = [descriptor.sums.get(name, [(name, None)]) for name in inputs]
    moved = list(dict.fromkeys(name for terms in sums for name, _ in terms))
    model, numbers = descriptor.model, dict(values)
    for name, value in descriptor.parameters.items():
        numbers[name] = values[str(value.name)] if isinstance(value, Free) else value
    asked = [model.outputs[name] for name in outputs]
    functions = transfer_functions(model.mechanism, model.graph, numbers, moved, asked, reduced=reduced)
    if descriptor.sums:
        functions = functions.with_inputs([[(moved.index(name), factor) for name, factor in terms] for terms in sums])
    filters = dict(zip(descriptor.outputs, descriptor.filters, strict=False))
    chosen = [filters.get(name) for name in outputs]
    return functions.with_filters([None if one is None else one.whole for one in chosen]) if any(chosen) else functions


def describe(
    mechanism: Mechanism, inputs: Sequence[str] | None = None, outputs: Sequence[str] | None = None
) -> Descriptor:
    """The descriptor of `mechanism` with the named roads and forces as inputs, and the named outputs.

    By default all inputs, and every output that needs no state of its own; the displacement of a body over a moving
    road is such a state (it drifts like the road) and comes only when it is named. A road that is not an input lies
    still. By name there is every other output of `systems.outputs` too, and, for every element, `<label>_force` as an
    input: a force beside the element, positive in tension.

    Raises `MechanismError` for what is ill-posed, `LinearSystemError` for a name that is not there.
    """
    chosen = tuple(None if names is None else tuple(names) for names in (inputs, outputs))
    structure = structure_of(mechanism)
    if structure is not None and len(structure.values) <= _MOST_VALUES:
        try:
            return _with_values(_describe_structure(structure, *chosen), structure)
        except InerterError:  # whose sentence is to name what the mechanism itself has
            pass
    return _describe(mechanism, linear_graph(mechanism), *chosen)


def describe_design(
    mechanism: Mechanism, inputs: Sequence[str], outputs: Sequence[str]
) -> tuple[Descriptor, Mapping[str, float]]:
    """Descriptor of a design without free values: that of its structure, which designs share, and its values there.

    Where the structure depends on values it is that of `describe`, without values.

    Raises as `describe`.
    """
    structure = structure_of(mechanism)
    if structure is None or len(structure.values) > _MOST_VALUES or mechanism.free_values():
        return describe(mechanism, inputs, outputs), {}
    try:
        found = _describe_structure(structure, tuple(inputs), tuple(outputs)).descriptor
    except InerterError:  # whose sentence is to name what the mechanism itself has
        return describe(mechanism, inputs, outputs), {}
    return found, structure.parameters  # type: ignore[return-value]


def describe_with_parameters(
    mechanism: Mechanism, inputs: Sequence[str], outputs: Sequence[str]
) -> tuple[Descriptor, dict[str, float]] | None:
    """The descriptor in which the value of every element and inertia is free, and those values by their names there.

    None where the structure depends on values, as for elements of other laws.

    Raises as `describe`.
    """
    structure = structure_of(mechanism)
    if structure is None:
        return None
    found = _describe(*structure.parametrise(), tuple(inputs), tuple(outputs))
    return found, {name: structure.parameters[name] for name in found.free}  # type: ignore[misc]


def _describe(mechanism: Mechanism, graph: Graph, inputs: Names, outputs: Names) -> Descriptor:
    names = input_names(mechanism)
    beside = [force_of(branch.label) for branch in graph.branches]
    chosen = names if inputs is None else list(inputs)
    check_inputs(mechanism, chosen, LinearSystemError, beside)
    ordered = [name for name in dict.fromkeys((*names, *beside)) if name in chosen]
    frame = split(mechanism, graph, ordered, main_outputs(mechanism) if outputs is None else outputs)
    balanced = balance(frame)
    observed = [observe(frame, name) for name in (observed_by_default(frame) if outputs is None else outputs)]
    return _join_arrays(frame, balanced, observed, chosen)


@dataclass(frozen=True, eq=False)
class _ParametricDescriptor:
    """Descriptor in which every value is free, and the names of these in the order of their appearance."""

    descriptor: Descriptor
    names: tuple[str, ...]
    stacks: JoinedStacks  # S, R, F, Y_eta, Y_x, Y_u
    sizes: JoinedStacks


@lru_cache(maxsize=128)
def _describe_structure(structure: Structure, inputs: Names, outputs: Names) -> _ParametricDescriptor:
    mechanism, graph = structure.parametrise()
    d = _describe(mechanism, graph, inputs, outputs)
    masses = {c.inertia.name for c in mechanism.coordinates if isinstance(c.inertia, Free)}
    names = sorted(d.free, key=lambda name: name not in masses)  # in the order in which `balance` adds them up
    order = [0, *(1 + list(d.free).index(name) for name in names)]
    stacks, sizes = ([stack[order] for stack in stacks] for stacks in (d.stacks, d.sizes))
    ordered = d.with_stacks(stacks, sizes, free={name: d.free[name] for name in names})
    return _ParametricDescriptor(ordered, tuple(d.free), JoinedStacks.of(stacks), JoinedStacks.of(sizes))


def _with_values(layout: _ParametricDescriptor, structure: Structure) -> Descriptor:
    """The descriptor of a mechanism from that of its structure: numbers enter the constant slices."""
    d, values = layout.descriptor, structure.parameters
    chosen = [values[name] for name in d.free]
    free = {str(value.name): value for name in layout.names if isinstance(value := values[name], Free)}
    places = {name: 1 + i for i, name in enumerate(free)}
    weights = np.zeros((1 + len(free), 1 + len(chosen)), np.longdouble)
    weights[0, 0] = 1.0
    for i, value in enumerate(chosen, start=1):
        place, factor = (places[str(value.name)], 1.0) if isinstance(value, Free) else (0, value)
        weights[place, i] = factor
    return d.with_stacks(
        layout.stacks.combine(weights),
        layout.sizes.combine(weights.astype(float)),
        free=free,
        mechanism=structure.mechanism,
        parameters=dict(zip(d.free, chosen, strict=True)),
    )


@once_per_structure
def linear_notes(mechanism: Mechanism) -> tuple[str, ...]:
    """Notes on what the linear model neglects."""
    return linear_graph(mechanism).notes


@once_per_structure
def is_held_by_springs(mechanism: Mechanism) -> bool:
    """Whether springs determine the position of every coordinate when all roads lie still."""
    graph = linear_graph(mechanism)
    springs, _ = incidence_rows(of_law(graph, LinearRole.STIFFNESS), graph)
    span = BranchRows.of(graph, [])
    rows = np.eye(len(graph.nodes))[: len(mechanism.coordinates)]
    return all(combination(span, springs, row) is not None for row in rows)


def _join_arrays(
    frame: Frame, balanced: tuple[Long, Long], observed: Sequence[StackedOutput], order: Sequence[str]
) -> Descriptor:
    """Descriptor from all arrays, with additional output states last and inputs in the order of `order`."""
    columns = [frame.inputs.index(name) for name in order]
    extra = [one for one in observed if one.state is not None]
    X_eta, X_x, X_u = _rates(frame, extra)
    S, R, F = _balance_stacks(frame, balanced[0], len(extra), columns)
    Y_eta, Y_x, Y_u = _output_stacks(frame, observed, len(extra), columns)
    sizes = (
        *_balance_stacks(frame, balanced[1], len(extra), columns),
        *_output_stacks(frame, observed, len(extra), columns, sizes=True),
    )
    return Descriptor(
        S=S,
        R=-R,
        F=-F,
        X_eta=X_eta,
        X_x=X_x,
        X_u=X_u[:, columns],
        Y_eta=Y_eta,
        Y_x=Y_x,
        Y_u=Y_u,
        states=_state_names(frame, extra),
        inputs=tuple(order),
        outputs=tuple(one.name for one in observed),
        free=frame.free,
        notes=frame.graph.notes,
        sizes=tuple(size.astype(float) for size in sizes),
        mechanism=frame.mechanism,
        model=Model(frame.mechanism, frame.graph, frame.known),
        precision_warning=frame.precision_warning,
    )


def _rates(frame: Frame, extra: Sequence[StackedOutput]) -> tuple[Matrix, Matrix, Matrix]:
    """Rates of the states over eta, all states and inputs."""
    at, n = frame.slots, frame.states + len(extra)
    X_eta, X_x, X_u = np.zeros((n, frame.unknowns)), np.zeros((n, n)), np.zeros((n, len(frame.inputs)))
    X_eta[at.a, at.a1] = np.eye(at.a.stop)
    X_x[at.g, at.a], X_eta[at.g, at.y], X_u[at.g, : frame.roads] = frame.split.rates
    for i, one in enumerate(extra, start=frame.states):
        assert one.state is not None
        X_eta[i], X_x[i, : frame.states], X_u[i] = one.state
    return X_eta, X_x, X_u


def _balance_stacks(frame: Frame, terms: Long, extra: int, columns: Sequence[int]) -> list[Any]:
    """Stacks of the balance over eta, over all states, and over the inputs `columns`."""
    S, R, F = np.split(terms, [frame.unknowns, frame.unknowns + frame.states], axis=2)
    later = np.zeros((*terms.shape[:2], extra), terms.dtype)
    return [S, np.concatenate([R, later], axis=2), F[:, :, columns]]


def _output_stacks(
    frame: Frame, observed: Sequence[StackedOutput], extra: int, columns: Sequence[int], sizes: bool = False
) -> list[Any]:
    """Stacks of the outputs, or of the sizes of their terms, over eta, over all states and over the inputs."""
    widths = (frame.unknowns, frame.states + extra, len(frame.inputs))
    stacks = [np.zeros((1 + len(frame.free), len(observed), width), np.longdouble) for width in widths]
    state = frame.states
    for i, one in enumerate(observed):
        for stack, row in zip(stacks, one.sizes if sizes else one.rows, strict=True):
            stack[:, i, : row.shape[1]] = row
        if one.state is not None:
            stacks[1][0, i, state] = 1.0
            state += 1
    return [*stacks[:2], stacks[2][:, :, columns]]


def _state_names(frame: Frame, extra: Sequence[StackedOutput]) -> tuple[str, ...]:
    velocities = frame.motion_names("R", "velocity")
    elongations = []
    for row in frame.split.P:
        labels = [frame.springs[i].label for i in np.flatnonzero(row)]
        elongations.append("_".join(labels) + ("_elongation" if len(labels) == 1 else "_mean_elongation"))
    names = [*velocities, *elongations, *(one.name for one in extra)]
    return tuple(n if names.count(n) == 1 else f"{n}{names[: i + 1].count(n)}" for i, n in enumerate(names))
