"""What every analysis takes as a vehicle, and what those vehicles have in common that files know by their key."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol, Self

from inerter.checks import check_positive, is_number
from inerter.errors import DesignError, MechanismError
from inerter.fields import fields_of, mounts_of, needed_mounts_of
from inerter.networks.elements import Free, Network, check_network
from inerter.networks.transform import name_free_values, with_values
from inerter.vehicle.mechanism import Mechanism, check_known, check_quantity


class Vehicle(Protocol):
    """What every analysis takes: something that is a mechanism and may have free values."""

    def mechanism(self) -> Mechanism:
        """The mechanism that it is."""
        ...

    def free_values(self) -> dict[str, Free]:
        """Its free values by name."""
        ...

    def with_values(self, values: Mapping[str, float]) -> Self:
        """The same vehicle with the named free values fixed."""
        ...


def check_vehicle(vehicle: object) -> None:
    """Raises `DesignError` unless `vehicle` is one (its class is not)."""
    if isinstance(vehicle, type) or not hasattr(vehicle, "mechanism"):
        raise DesignError(f"Expected a vehicle, such as QuarterCar(...), got {vehicle!r}.")


@dataclass(frozen=True)
class VehicleModel:
    """A kind of vehicle that files know by its `key`: some quantities, and the networks that are mounted in it.

    A kind is a frozen dataclass whose fields say what they are, by `quantity` and `mount`, and which makes a
    `mechanism` of them.

    Raises `MechanismError` unless all quantities are positive (or zero, if that is their default) or, where they may
    be, free; `NetworkError` if what is mounted is no network.
    """

    key: ClassVar[str]
    moved: ClassVar[str] = "road"  # what a signal moves if nothing else is said: this, a force, a rig's "displacement"
    forces: ClassVar[Mapping[str, str]] = {}  # external forces and moments, with their units

    def __post_init__(self) -> None:
        name_free_quantities(self, f"the {self.key.replace('-', ' ')}")
        for name, network in name_free_values(self.networks()).items():
            object.__setattr__(self, name, network)
        if any(isinstance(getattr(self, field.name), Free) for field in fields_of(type(self))):
            self.mechanism()  # which says what goes by the same name

    def networks(self) -> dict[str, Network]:
        """What is mounted, by the names of the mounts; a mount that may be left out is there if it is not None."""
        given = {name: getattr(self, name) for name in mounts_of(type(self))}
        left_out = {name for name in given.keys() - {*needed_mounts_of(type(self))} if given[name] is None}
        return {name: check_network(network) for name, network in given.items() if name not in left_out}

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


class Stage(ABC):
    """What stands on another vehicle, on a network of its own, and is a vehicle together with it; a dataclass."""

    vehicle: Vehicle
    network: Network

    @abstractmethod
    def mechanism(self) -> Mechanism:
        """Both as a `Mechanism`."""

    def free_values(self) -> dict[str, Free]:
        """The free values by name: those of the vehicle, then its own."""
        return self.mechanism().free_values()

    def with_values(self, values: Mapping[str, float]) -> Self:
        """The same with the named free values fixed; raises `DesignError` for a name that is not free here."""
        check_known(values, self.free_values())
        below = {name: value for name, value in values.items() if name in self.vehicle.free_values()}
        other: Any = self
        own = {"network": with_values(self.network, values), **_fixed_quantities(self, values)}
        fixed: Self = replace(other, vehicle=self.vehicle.with_values(below), **own)
        return fixed


def name_free_quantities(of: Any, what: str) -> None:
    """Check the quantities of a dataclass, and name the free ones without a name after themselves.

    Raises `MechanismError` unless they are positive (or zero, if that is their default) or, where they may be, free.
    """
    for field in fields_of(type(of)):
        value, said = getattr(of, field.name), f"The {field.in_words} of {what}"
        if not isinstance(value, Free):
            if field.default != 0.0 or not is_number(value) or value != 0.0:
                check_positive(MechanismError, said, value, field.unit)
        elif not field.may_be_free:
            raise MechanismError(
                f"{said} cannot be free: the equations of motion are not linear in it. Give a number of "
                f"{field.unit}, and compare several."
            )
        else:
            check_quantity(said, value, field.unit)
            object.__setattr__(of, field.name, replace(value, name=value.name or field.name))


def _fixed_quantities(of: Any, values: Mapping[str, float]) -> dict[str, float]:
    """The free quantities of a dataclass that are named, with their values."""
    free = {field.name: getattr(of, field.name) for field in fields_of(type(of))}
    return {
        name: values[str(value.name)]
        for name, value in free.items()
        if isinstance(value, Free) and value.name in values
    }
