"""The linear model of a vehicle with the name and unit of every state, input and output: all that exports know of it.

Inputs are called what they are: a road acts by its velocity, so that the input at `road` is `road_velocity` [m/s].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import ExportError, LinearSystemError
from inerter.exports.refusals import delay_notes, refuse_nonlinear
from inerter.formatting import format_number
from inerter.norms.response import frequency_response, relative_rounding, resonant_range, rounding_of_response
from inerter.systems.assemble import state_space
from inerter.systems.descriptor import Descriptor, describe, describe_with_parameters
from inerter.systems.exact_matrices import close_exactly, rounded_stacks
from inerter.systems.graph import linear_graph
from inerter.systems.linear import LinearSystem, check_names
from inerter.systems.outputs import input_unit, velocity_of
from inerter.systems.unknowns import state_units, unknowns
from inerter.validation import checked
from inerter.vehicle.vehicle import Vehicle, check_fixed, check_vehicle

if TYPE_CHECKING:
    import scipy.signal

Matrix = NDArray[np.float64]
FORMS = ("state-space", "descriptor")
_GROWTH = 1e-3  # of the oscillations at which rounding is looked at, a radian
_EVERY = 6  # frequencies of `resonant_range`
_TOLD_ROUNDING, _MOST_ROUNDING = 1e-9, 1e-6  # of the largest response: more is told by a note, or refused


@dataclass(frozen=True)
class NamedQuantity:
    """A state, input or output with its unit; an empty one is not known."""

    name: str
    unit: str = ""

    @property
    def label(self) -> str:
        """Name with the unit in brackets, such as `road_velocity [m/s]`."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


Quantities = tuple[NamedQuantity, ...]


@dataclass(frozen=True, eq=False)
class NamedSystem:
    """E x' = A x + B u, y = C x + D u, with names and units; without `E`, x' = A x + B u.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
    >>> model = it.named_system(car, "road", ["tyre_load"])
    >>> model.A.shape, [each.label for each in model.outputs]
    ((4, 4), ['tyre_load [N]'])
    """

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    states: Quantities
    inputs: Quantities
    outputs: Quantities
    E: Matrix | None = None
    notes: tuple[str, ...] = ()  # what the model leaves out, a sentence each
    title: str = "linear model"
    rounding: float = 0.0  # a bound of what rounding its entries changes, of the largest response of each channel

    def response(self, omega: ArrayLike) -> NDArray[np.complex128]:
        """Frequency response (len(omega), outputs, inputs), omega in rad/s."""
        if self.E is None:
            return frequency_response(LinearSystem(self.A, self.B, self.C, self.D), omega)
        E = self.E
        return np.array(
            [
                self.C @ np.linalg.solve(1j * w * E - self.A, self.B.astype(complex)) + self.D
                for w in np.atleast_1d(np.asarray(omega, dtype=float))
            ]
        )

    def to_control(self) -> Any:
        """A `StateSpace` of python-control, whose signals are called `name [unit]`.

        Points in names, which python-control does not allow, are underscores there.

        Raises `ExportError` if python-control is missing, or for a descriptor system, which it does not have.
        """
        self._check_is_state_space("python-control")
        try:
            import control  # noqa: PLC0415 - heavy, and optional
        except ImportError:
            raise ExportError('For python-control install it too: pip install "inerter[control]".') from None
        named = {"states": self.states, "inputs": self.inputs, "outputs": self.outputs}
        labels = {what: _without_points([one.label for one in several]) for what, several in named.items()}
        return control.StateSpace(self.A, self.B, self.C, self.D, remove_useless_states=False, **labels)

    def to_scipy(self) -> scipy.signal.StateSpace:
        """A `StateSpace` of SciPy, with the tuples `state_labels`, `input_labels` and `output_labels`: `name [unit]`.

        Raises `ExportError` for a descriptor system, which SciPy does not have.
        """
        import scipy.signal  # noqa: PLC0415 - heavy

        self._check_is_state_space("SciPy")
        system = scipy.signal.StateSpace(self.A, self.B, self.C, self.D)
        for what, several in (("state", self.states), ("input", self.inputs), ("output", self.outputs)):
            setattr(system, f"{what}_labels", tuple(one.label for one in several))
        return system

    def _check_is_state_space(self, program: str) -> None:
        if self.E is not None:
            raise ExportError(f'{program} has no descriptor systems. Export the form "state-space".')


@checked(ExportError)
def named_system(
    of: Vehicle | LinearSystem,
    inputs: Sequence[str] | str | None = None,
    outputs: Sequence[str] | str | None = None,
    *,
    linear: bool = False,
    form: str = "state-space",
    title: str = "",
) -> NamedSystem:
    """The linear model of a vehicle without free values, or of a `LinearSystem`, with names and units.

    Roads are named without `_velocity` in `inputs`, as in `state_space`. With `linear`, friction and gaps are left out,
    as the notes tell. The form "descriptor" keeps the unknowns that no inertia carries, such as motions of nodes
    without mass; it has the values of elements themselves in its matrices.

    Raises `ExportError` for friction or gaps without `linear`, for a system with delays, or for values so many decades
    apart that matrices of doubles have lost the responses; `DesignError` if a value is free, `MechanismError` or
    `LinearSystemError` as `state_space` does.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
    >>> system = it.named_system(car, "road", ["sprung_acceleration"])
    >>> [each.label for each in (*system.inputs, *system.outputs)]
    ['road_velocity [m/s]', 'sprung_acceleration [m/s^2]']
    """
    if form not in FORMS:
        raise ExportError(f"Unknown form {form!r}; available: {', '.join(FORMS)}.")
    if isinstance(of, LinearSystem):
        return _of_system(of.subsystem(inputs, outputs), form, title)
    check_vehicle(of)
    mechanism = of.mechanism()
    check_fixed(mechanism)
    if not linear:
        refuse_nonlinear(mechanism)
    columns = None if inputs is None else check_names("inputs", inputs)
    rows = None if outputs is None else check_names("outputs", outputs)
    descriptor = describe(mechanism, columns, rows)
    if descriptor.precision_warning:
        raise LinearSystemError(descriptor.precision_warning)
    known = describe_with_parameters(mechanism, descriptor.inputs, descriptor.outputs)
    numbers = known or (descriptor, {})
    whole, order = close_exactly(*numbers), len(descriptor.states)
    doubt: Matrix | float = 0.0
    if form == FORMS[0]:
        system = state_space(mechanism, columns, rows)
        through = whole[order:, order:]
        through[system.D == 0.0] = 0.0  # products of levers are rounded too
        states = tuple(map(NamedQuantity, system.states, state_units(descriptor)))
        made = NamedSystem(*_blocks(whole, order), states, *_signals(descriptor))
        if known is None and system.fine is not None:
            doubt = system.fine.errors
    else:
        made = _descriptor(descriptor, rounded_stacks(*numbers))
    notes = [f"{note}." for note in linear_graph(mechanism).notes] + delay_notes(mechanism, descriptor.inputs)
    made = replace(made, notes=tuple(notes), title=title or "linear model")
    return _with_rounding(made, whole[:order, :order], doubt)


def _blocks(whole: Matrix, order: int) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """A, B, C and D of the block matrix [A B; C D]."""
    return whole[:order, :order], whole[:order, order:], whole[order:, :order], whole[order:, order:]


def _descriptor(d: Descriptor, stacks: Sequence[Matrix]) -> NamedSystem:
    """The equations of the descriptor with its unknowns as further states, which have no rates."""
    S, R, F, Y_eta, Y_x, Y_u = stacks
    n, e = R.shape[1], S.shape[0]
    named = zip(d.states, state_units(d), strict=True)
    states = tuple(NamedQuantity(*one) for one in (*named, *unknowns(d)))
    scale = 2.0 ** -np.rint(np.log2(np.abs(S).max(axis=1, keepdims=True, initial=1.0)))  # exact, for pivots of others
    A = np.block([[d.X_x, d.X_eta], [scale * R, -scale * S]])
    E = np.diag(np.concatenate([np.ones(n), np.zeros(e)]))
    return NamedSystem(A, np.vstack([d.X_u, scale * F]), np.hstack([Y_x, Y_eta]), Y_u, states, *_signals(d), E)


def _with_rounding(model: NamedSystem, dynamics: Matrix, doubt: Matrix | float) -> NamedSystem:
    """The model with the bound of its rounding over the resonances of `dynamics`, its A as a state space.

    Raises `ExportError` where the bound exceeds `_MOST_ROUNDING`.
    """
    with np.errstate(all="ignore"):
        rounding = _bound_rounding(model, resonant_range([dynamics])[::_EVERY], doubt)
    if not rounding <= _MOST_ROUNDING:
        raise ExportError(
            "The values of this design lie so many decades apart that its matrices, rounded to doubles, have lost its "
            f"responses: by up to {format_number(rounding, 2)} of the largest; {format_number(_MOST_ROUNDING)} is "
            "allowed. Try the other form (a descriptor mostly loses less than a state space), or leave out what hardly "
            "matters; indices do not need these matrices."
        )
    note = f"Rounding of these matrices changes responses by up to {format_number(rounding, 2)} of the largest."
    return replace(model, rounding=rounding, notes=(*model.notes, note) if rounding > _TOLD_ROUNDING else model.notes)


def _bound_rounding(model: NamedSystem, omega: Matrix, doubt: Matrix | float) -> float:
    """Largest change of a response by rounding, over the largest response of its channel, to first order.

    `doubt` are errors of the entries of [A B; C D] beside rounding. At s = (j + 0.001) omega: an oscillation that grows
    a little has a finite response at an undamped pole, of which no digit would be left on the axis itself.
    """
    matrices = model.A, model.B, model.C, model.D
    try:
        response, error = rounding_of_response(matrices, (1j + _GROWTH) * omega, doubt, model.E)
    except np.linalg.LinAlgError:
        return np.inf
    return relative_rounding(response, error)


def _signals(d: Descriptor) -> tuple[Quantities, Quantities]:
    """Inputs and outputs; a road is an input by its velocity."""
    roads = [road.name for road in d.mechanism.roads]
    known = d.model.outputs
    inputs = []
    for name in d.inputs:
        own = velocity_of(name) if name in roads else name
        inputs.append(NamedQuantity(own, input_unit(d.mechanism, own) or "N"))  # beside an element it is a force
    return tuple(inputs), tuple(NamedQuantity(name, known[name].unit) for name in d.outputs)


def _of_system(system: LinearSystem, form: str, title: str) -> NamedSystem:
    if form != FORMS[0]:
        raise ExportError(
            'A LinearSystem is a state space, and has no descriptor. Export its vehicle, or its "state-space".'
        )
    if np.any(system.delays) or len(set(system.sources)) < len(system.inputs):
        raise ExportError(
            "Inputs of this system share a source or are delayed, which matrices cannot represent. Export the system "
            "before with_delays(...), whose inputs are independent, and delay them in the other program."
        )
    states, inputs, outputs = (
        tuple(map(NamedQuantity, names)) for names in (system.states, system.inputs, system.outputs)
    )
    made = NamedSystem(
        system.A,
        system.B,
        system.C,
        system.D,
        states,
        inputs,
        outputs,
        notes=tuple(system.notes),
        title=title or "linear model",
    )
    return made if system.fine is None else _with_rounding(made, system.A, system.fine.errors)


def _without_points(labels: Sequence[str]) -> list[str]:
    """Labels without points, each different."""
    found: list[str] = []
    for label in labels:
        name, number = label.replace(".", "_"), 1
        while name in found:
            number += 1
            name = f"{label.replace('.', '_')} ({number})"
        found.append(name)
    return found
