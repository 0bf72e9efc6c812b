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
from functools import cached_property, lru_cache, partial
from itertools import accumulate, pairwise
from math import prod
from typing import Any

import numpy as np
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

    def with_stacks(self, stacks: Iterable[Matrix], sizes: Iterable[Matrix], **others: Any) -> Descriptor:
        """Copy with other stacks, their sizes, and other attributes by name."""
        S, R, F, Y_eta, Y_x, Y_u = stacks
        return replace(self, S=S, R=R, F=F, Y_eta=Y_eta, Y_x=Y_x, Y_u=Y_u, sizes=tuple(sizes), **others)


def close(
    descriptor: Descriptor,
    values: Mapping[str, float],
    sources: tuple[str, ...] = (),
    delays: Matrix | None = None,
) -> LinearSystem:
    """The linear system at numbers for the free values, with the sources and delays of its inputs.

    Raises `DesignError` if one of them has no value.
    """
    missing = [name for name in descriptor.free if name not in values]
    if missing:
        raise DesignError(
            f"The value of {', '.join(missing)} is still free. Give numbers with with_values(...), or optimise first."
        )
    p = np.array([1.0, *(values[name] for name in descriptor.free)], dtype=np.longdouble)
    d, rounded = descriptor, p.astype(float)
    S, R, F, Y_eta, Y_x, Y_u = [_sum_stack(p, stack) for stack in d.stacks]
    S_size, R_size, F_size, Y_eta_size, Y_x_size, Y_u_size = [_sum_stack(rounded, stack) for stack in d.sizes]
    T, T_error = _solve_extended(S, _beside(R, F), S_size, _beside(R_size, F_size))
    X, Y = _beside(d.X_x, d.X_u), _beside(Y_x, Y_u)
    top, bottom = X + d.X_eta @ T, Y + Y_eta @ T
    size = np.abs(T).astype(float)
    with np.errstate(invalid="ignore"):  # nothing times infinite: as unsure
        top_error = np.abs(d.X_eta) @ (T_error + _ROUNDING * size) + _ROUNDING * np.abs(X)
        bottom_error = np.abs(Y_eta).astype(float) @ T_error
    bottom_error += _TERMS * _ROUNDING * (_beside(Y_x_size, Y_u_size) + Y_eta_size @ size)
    n = R.shape[1]
    for matrix, error in ((top[:, n:], top_error[:, n:]), (bottom[:, n:], bottom_error[:, n:])):
        matrix[np.abs(matrix) <= error] = 0.0  # white noise that reaches an output by rounding only would be infinite
    errors = top_error[:, :n], top_error[:, n:], bottom_error[:, :n], bottom_error[:, n:]
    fine = ExtendedMatrices((top[:, :n], top[:, n:], bottom[:, :n], bottom[:, n:]), errors)
    A, B, C, D = (matrix.astype(float) for matrix in fine.matrices)
    return LinearSystem(
        A=A,
        B=B,
        C=C,
        D=D,
        states=d.states,
        inputs=d.inputs,
        outputs=d.outputs,
        delays=np.zeros(0) if delays is None else delays,
        sources=sources,
        notes=d.notes,
        origin=Origin(partial(exact_functions, d, dict(values)), (A, B, C, D), fine, d.inputs, d.outputs),
    )


def _beside(left: Matrix, right: Matrix) -> Matrix:
    return np.concatenate((left, right), axis=1)  # `hstack` takes three times as long for small matrices


def _sum_stack(p: NDArray[Any], stack: Matrix) -> Matrix:
    if p.size == 1:
        return np.asarray(stack[0])
    rows = stack.reshape(p.size, -1)
    return np.asarray(np.dot(p[None], rows).reshape(stack.shape[1:]))  # `tensordot` takes three times as long


def _solve_extended(S: Matrix, right: Matrix, S_size: Matrix, right_size: Matrix) -> tuple[Matrix, Matrix]:
    """S^-1 right in extended precision, and its error: infinite where S is singular to rounding."""
    size = np.abs(S).max(axis=1, keepdims=True, initial=0.0)
    scaled, right = S / size, right / size
    try:
        inverse = np.linalg.inv(scaled.astype(float))
    except np.linalg.LinAlgError:
        return np.zeros_like(right), np.full(right.shape, np.inf)
    solved = step = (inverse @ right.astype(float)).astype(np.longdouble)
    for _ in range(3):
        step = inverse @ (right - scaled @ solved).astype(float)
        solved = solved + step
    terms = (S_size @ np.abs(solved).astype(float) + right_size) / size.astype(float)
    return solved, np.abs(step) + _TERMS * _ROUNDING * (np.abs(inverse) @ terms)


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
    """Descriptor in which every value is a parameter, with its stacks side by side."""

    descriptor: Descriptor
    parameters: list[str]
    stacks: NDArray[np.longdouble]  # S, R, F, Y_eta, Y_x, Y_u (1 + parameters, entries)
    sizes: Matrix

    @cached_property
    def places(self) -> list[tuple[slice, tuple[int, ...]]]:
        """Columns and shape of each stack."""
        shapes = [size.shape[1:] for size in self.descriptor.sizes]
        edges = [0, *accumulate(map(prod, shapes))]
        return [(slice(*ends), shape) for ends, shape in zip(pairwise(edges), shapes, strict=True)]

    def split_stacks(self, joined: Any) -> tuple[Any, ...]:
        """Stacks from rows in which they are side by side."""
        return tuple([joined[:, columns].reshape(len(joined), *shape) for columns, shape in self.places])


@lru_cache(maxsize=128)
def _describe_structure(structure: Structure, inputs: Names, outputs: Names) -> _ParametricDescriptor:
    mechanism, graph = structure.parametrise()
    d = _describe(mechanism, graph, inputs, outputs)
    masses = {c.inertia.name for c in mechanism.coordinates if isinstance(c.inertia, Free)}
    names = sorted(d.free, key=lambda name: name not in masses)  # in the order in which `balance` adds them up
    order = [0, *(1 + list(d.free).index(name) for name in names)]
    joined = (
        np.concatenate([stack[order].reshape(len(order), -1) for stack in stacks], axis=1)
        for stacks in (d.stacks, d.sizes)
    )
    return _ParametricDescriptor(d, names, *joined)


def _with_values(layout: _ParametricDescriptor, structure: Structure) -> Descriptor:
    """The descriptor of a mechanism from that of its structure: numbers enter the constant slices."""
    d, values = layout.descriptor, structure.parameters
    chosen = [values[name] for name in layout.parameters]
    free = {str(value.name): value for name in d.free if isinstance(value := values[name], Free)}
    places = {name: 1 + i for i, name in enumerate(free)}
    weights = np.zeros((1 + len(free), 1 + len(chosen)), np.longdouble)
    weights[0, 0] = 1.0
    for i, value in enumerate(chosen, start=1):
        place, factor = (places[str(value.name)], 1.0) if isinstance(value, Free) else (0, value)
        weights[place, i] = factor
    return d.with_stacks(
        layout.split_stacks(weights @ layout.stacks),
        layout.split_stacks(weights.astype(float) @ layout.sizes),
        free=free,
        mechanism=structure.mechanism,
        parameters=dict(zip(layout.parameters, chosen, strict=True)),
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
