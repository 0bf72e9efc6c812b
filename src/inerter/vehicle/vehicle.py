"""Protocol of vehicles for all analyses, and base classes of vehicle models and stages."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import wraps
from itertools import chain
from typing import Any, ClassVar, Protocol, Self, TypeVar

from inerter.errors import DesignError, MechanismError
from inerter.field_metadata import fields_of, mounts_of, needed_mounts_of
from inerter.networks.elements import Free, Network, check_network
from inerter.networks.transform import check_named_apart, name_free_values, with_values
from inerter.notebook import shown_by
from inerter.validation import check_positive, is_number, use_python_numbers
from inerter.vehicle.mechanism import Mechanism, check_known, check_quantity

_Asked = TypeVar("_Asked")
_Answer = TypeVar("_Answer")


class Vehicle(Protocol):
    """Protocol of a vehicle: a mechanism that may have free values."""

    def mechanism(self) -> Mechanism:
        """The mechanism of the vehicle."""
        ...

    def free_values(self) -> dict[str, Free]:
        """Free values by name."""
        ...

    def with_values(self, values: Mapping[str, float]) -> Self:
        """The same vehicle with the named free values fixed."""
        ...


def check_vehicle(vehicle: object) -> None:
    """Raise `DesignError` unless `vehicle` is a vehicle, not a class; a result is pointed to its design."""
    if isinstance(vehicle, type) or not callable(getattr(vehicle, "mechanism", None)):
        what = type(vehicle).__name__
        got = f"{what}. Its vehicle is its attribute design" if hasattr(vehicle, "design") else repr(vehicle)
        raise DesignError(f"Expected a vehicle, such as QuarterCar(...), got {got}.")


def check_fixed(design: Vehicle | Mechanism) -> None:
    """Raise `DesignError` if a value is free."""
    if free := ", ".join(design.free_values()):
        raise DesignError(
            f"The design still has free values: {free}. Fix them with with_values(...), or use optimise(...)."
        )


def value_units(design: Vehicle) -> dict[str, str]:
    """SI units of the numbers of a design by name: masses, fields of the vehicle and its stages, elements."""
    mechanism = design.mechanism()
    units = {mass.name: "kg m^2" if mass.angle else "kg" for mass in mechanism.masses.values()}
    below: Any = design
    while below is not None:
        units |= {field.name: field.unit for field in fields_of(type(below))}
        below = getattr(below, "vehicle", None)
    return units | {element.label: element.unit for element in mechanism.elements()}


@dataclass(frozen=True)
class VehicleModel:
    """Base of a vehicle model of files with a `key`: quantities and mounted networks.

    A model is a frozen dataclass whose fields are declared by `quantity` and `mount`, with a method `mechanism`.

    Raises `MechanismError` unless all quantities are positive (or zero, if that is their default) or, where allowed,
    free; `NetworkError` if a mount is not a network.

    >>> import inerter as it
    >>> issubclass(it.QuarterCar, it.VehicleModel), it.QuarterCar.key
    (True, 'quarter-car')
    """

    key: ClassVar[str]
    moved: ClassVar[str] = "road"  # default input of a signal: this, a force, or "displacement" of a rig
    forces: ClassVar[Mapping[str, str]] = {}  # external forces and moments, with their units
    question: ClassVar[str] = ""  # answered by its example on a first screen
    outline: ClassVar[str] = (
        ""  # as which it is drawn: "car", "corner" of a car, or "absorber"; "" from its ports alone
    )

    _repr_svg_ = shown_by("inerter.figures.plots.network:design_svg")

    def __init_subclass__(cls, **arguments: Any) -> None:
        super().__init_subclass__(**arguments)
        if "mechanism" in vars(cls):
            cls.mechanism = remember_last(cls.mechanism)  # type: ignore[assignment,method-assign]

    def __post_init__(self) -> None:
        name_free_quantities(self, f"the {self.key.replace('-', ' ')}")
        for name, network in name_free_values(self.networks()).items():
            object.__setattr__(self, name, network)
        check_free_quantities(self)

    def networks(self) -> dict[str, Network]:
        """Networks by mount name; optional mounts only where present."""
        given, needed = [(name, getattr(self, name)) for name in mounts_of(type(self))], needed_mounts_of(type(self))
        return {name: check_network(network) for name, network in given if network is not None or name in needed}

    def mechanism(self) -> Mechanism:
        """The same vehicle as a `Mechanism`."""
        raise NotImplementedError

    def free_values(self) -> dict[str, Free]:
        """The free values by name, in the order in which they appear."""
        return self.mechanism().free_values()

    def with_values(self, values: Mapping[str, float]) -> Self:
        """The same vehicle with the named free values fixed; raises `DesignError` for a name that is not free here."""
        check_known(values, self.free_values())
        networks = {name: with_values(network, values) for name, network in self.networks().items()}
        fixed: dict[str, Any] = {**networks, **_fixed_quantities(self, values)}
        return replace(self, **fixed)


def remember_last(answer: Callable[[_Asked], _Answer]) -> Callable[[_Asked], _Answer]:
    """A function that keeps its last answer, since analyses of a vehicle need it several times in a row."""
    last: tuple[_Asked, _Answer] | None = None

    @wraps(answer)
    def remember(asked: _Asked) -> _Answer:
        nonlocal last  # both together, so that threads see one or the other
        known = last
        if known is None or known[0] is not asked:
            known = last = asked, answer(asked)
        return known[1]

    return remember


class Stage(ABC):
    """Base of a stage on another vehicle, mounted by a network; a dataclass that is a vehicle together with it."""

    vehicle: Vehicle
    network: Network

    _repr_svg_ = shown_by("inerter.figures.plots.network:design_svg")

    @abstractmethod
    def mechanism(self) -> Mechanism:
        """Vehicle and stage as one `Mechanism`."""

    def free_values(self) -> dict[str, Free]:
        """Free values by name: those of the vehicle, then those of the stage."""
        return self.mechanism().free_values()

    def with_values(self, values: Mapping[str, float]) -> Self:
        """The stage and its vehicle with the named free values fixed; raises `DesignError` for other names."""
        check_known(values, self.free_values())
        below = {name: value for name, value in values.items() if name in self.vehicle.free_values()}
        other: Any = self
        own = {"network": with_values(self.network, values), **_fixed_quantities(self, values)}
        fixed: Self = replace(other, vehicle=self.vehicle.with_values(below), **own)
        return fixed


def name_free_quantities(of: Any, what: str) -> None:
    """Check the quantities of a dataclass, and name unnamed free ones after their field.

    Raises `MechanismError` unless they are positive (or zero, if that is their default) or, where allowed, free.
    """
    use_python_numbers(of)
    for field in fields_of(type(of)):
        value, said = getattr(of, field.name), f"The {field.in_words} of {what}"
        if not isinstance(value, Free):
            if field.default != 0.0 or not is_number(value) or value != 0.0:
                check_positive(MechanismError, said, value, field.unit)
        elif not field.may_be_free:
            raise MechanismError(
                f"{said} cannot be free: the equations of motion are not linear in it. Give a number of "
                f"{field.unit}, and compare several designs."
            )
        else:
            check_quantity(said, value, field.unit)
            object.__setattr__(of, field.name, replace(value, name=value.name or field.name))


def check_free_quantities(of: VehicleModel | Stage) -> None:
    """Raises `DesignError` if a free quantity has the name of another one or of an element, also below a stage.

    To make both one value, give both free values the same name of your own.
    """
    parts: list[Vehicle] = [of]
    while isinstance(part := parts[-1], Stage):
        parts.append(part.vehicle)
    models = [part for part in parts if isinstance(part, VehicleModel | Stage)]
    values = [(field.name, getattr(model, field.name)) for model in models for field in fields_of(type(model))]
    free = [(name, value) for name, value in values if isinstance(value, Free)]
    if free:
        of.mechanism()  # which checks for duplicate names
        names = [name for name, value in free if value.name == name]
        for name in names:
            if names.count(name) > 1:
                raise DesignError(
                    f"{name!r} is free in two parts of the vehicle: they would be one value. Fix one of them, or give "
                    "it another name."
                )
        check_named_apart({*names}, chain.from_iterable(map(_given_networks, parts)), "a quantity of the vehicle")


def _given_networks(part: Vehicle) -> Iterable[Network]:
    """Networks of the mounts of a vehicle or stage, without the elements of its own quantities."""
    if isinstance(part, VehicleModel):
        return part.networks().values()
    return [part.network] if isinstance(part, Stage) else (mount.network for mount in part.mechanism().mounts())


def _fixed_quantities(of: Any, values: Mapping[str, float]) -> dict[str, float]:
    """Values of the named free quantities of a dataclass."""
    free = {field.name: getattr(of, field.name) for field in fields_of(type(of))}
    return {
        name: values[str(value.name)]
        for name, value in free.items()
        if isinstance(value, Free) and value.name in values
    }
