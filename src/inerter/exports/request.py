"""Requests for an export: an object, a kind and options; each kind reads the options that its format has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ExportError
from inerter.exports.named_system import FORMS, NamedSystem, named_system
from inerter.exports.refusals import refuse_moving_ground, refuse_nonlinear, refuse_notes
from inerter.indices.definition import Index
from inerter.networks.elements import Network
from inerter.networks.transform import linearise, notes_of
from inerter.records.record import Record
from inerter.simulation.trajectory import Trajectory
from inerter.systems.linear import LinearSystem
from inerter.validation import is_number
from inerter.vehicle.mechanism import Mechanism, Strut
from inerter.vehicle.vehicle import Vehicle, check_fixed

Exportable = Vehicle | Network | LinearSystem | Trajectory | Record


@dataclass(frozen=True, eq=False)
class ExportSpec:
    """A vehicle without free values, a network, a linear system, a trajectory or a record, and what of it is wanted.

    `inputs` and `outputs` choose among those of the linear model, `form` is "state-space" or "descriptor", and `linear`
    leaves out friction and gaps; `frequencies` [Hz], and `indices` by name with their `conventions`, are for tables.
    `part` is the name of a strut that is exported alone (FMUs, `spice`, drawings). With `speed` [m/s] an FMU has one
    road, which reaches each axle distance / speed later, and it has libraries for other `platforms` than this machine
    too ("windows", "macos", "macos-arm", "linux-arm").

    >>> import inerter as it
    >>> spec = it.ExportSpec(it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0)), to="spice")
    >>> list(spec.networks)
    ['strut']
    """

    of: Exportable
    to: str
    inputs: Sequence[str] | str | None = None
    outputs: Sequence[str] | str | None = None
    linear: bool = False
    form: str = ""  # by default that of the kind
    frequencies: Sequence[float] | None = None
    indices: Mapping[str, Index] | None = None
    conventions: str = "exact"
    title: str = ""
    part: str = ""
    speed: float | None = None
    platforms: Sequence[str] = ()

    def has(self, option: str) -> bool:
        """Whether an option was given, to a value other than its default."""
        value, default = getattr(self, option), getattr(ExportSpec, option)
        return type(value) is not type(default) or bool(value != default)

    def system(self, form: str = FORMS[0]) -> NamedSystem:
        """The linear model, in the form that was asked for, or else in `form`; a `LinearSystem` is a state space."""
        of = self.of if isinstance(self.of, LinearSystem) else self._vehicle("a vehicle or a LinearSystem")
        chosen = self.form or (FORMS[0] if isinstance(of, LinearSystem) else form)
        return named_system(of, self.inputs, self.outputs, linear=self.linear, form=chosen, title=self.title)

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism of the vehicle, without free values; raises `ExportError` if it is none."""
        mechanism = self._vehicle("a vehicle").mechanism()
        check_fixed(mechanism)
        return mechanism

    def linear_mechanism(self, program: str) -> Mechanism:
        """The mechanism on ground at rest; raises `ExportError` for friction or gaps unless they are left out."""
        refuse_moving_ground(self.mechanism, program)
        if not self.linear:
            refuse_nonlinear(self.mechanism)
        return self.mechanism

    @property
    def networks(self) -> dict[str, Network]:
        """The network of every mount, or the network itself, by name; raises `ExportError` if there is none."""
        if isinstance(self.of, Network):
            return {"strut": self.of}
        struts = self._vehicle("a network or a vehicle").mechanism().struts
        return {strut.name: strut.network for strut in ((self.strut,) if self.part else struts)}

    @cached_property
    def strut(self) -> Strut:
        """The strut that is exported alone; raises `ExportError` for a name that none has."""
        struts = self._vehicle("a vehicle").mechanism().struts
        for strut in struts:
            if strut.name == self.part:
                return strut
        raise ExportError(f"Unknown part {self.part!r}; available: {', '.join(one.name for one in struts)}.")

    def linear_networks(self) -> tuple[dict[str, Network], list[str]]:
        """The networks without friction and gaps, and what was left out, in words.

        Raises `ExportError` if there is something to leave out and that was not said to be on purpose.
        """
        made = {name: linearise(network) for name, network in self.networks.items()}
        notes = notes_of(made)
        if not self.linear:
            refuse_notes(notes)
        found = {}
        for name, linear in made.items():
            if linear.network is None:
                what = "is rigid" if linear.rigid else "carries no force"
                raise ExportError(
                    f"{name!r} {what} without friction and with closed gaps, so there is nothing to export."
                )
            found[name] = linear.network
        return found, notes

    @property
    def record(self) -> Record | None:
        """The record, if it is one."""
        return self.of if isinstance(self.of, Record) else None

    @property
    def hertz(self) -> NDArray[np.float64] | None:
        """Frequencies [Hz] that were asked for; raises `ExportError` unless they are positive numbers."""
        if self.frequencies is None:
            return None
        given = list(self.frequencies) if isinstance(self.frequencies, Sequence | np.ndarray) else [self.frequencies]
        if not given or not all(is_number(one) and one > 0.0 for one in given):
            raise ExportError(f"Frequencies must be positive numbers of Hz, got {self.frequencies!r}.")
        return np.asarray(given, dtype=float)

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle; raises `ExportError` if it is none."""
        return self._vehicle("a vehicle")

    def _vehicle(self, wanted: str) -> Vehicle:
        """The exported object as a vehicle; raises `ExportError` if it is none."""
        if isinstance(self.of, type) or not callable(getattr(self.of, "mechanism", None)):
            raise ExportError(f"An export to {self.to} requires {wanted}, got {type(self.of).__name__}.")
        found: Any = self.of
        vehicle: Vehicle = found
        return vehicle
