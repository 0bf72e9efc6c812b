"""A vibration absorber: a tuned mass damper, with an inerter if wished."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from inerter.fields import mount as mounted
from inerter.fields import quantity
from inerter.networks.elements import Damper, Free, Network, Spring
from inerter.vehicle.mechanism import GROUND, Coordinate, Force, Measures, Mechanism, Strut
from inerter.vehicle.vehicle import VehicleModel


@dataclass(frozen=True)
class Absorber(VehicleModel):
    """A primary mass on its support, a second mass on it, and perhaps a network from that to the ground.

    The support is a spring, with a damper beside it if `primary_damping` is not zero. With a spring and a damper as its
    `mount` this is a tuned mass damper, and with an inerter as its `ground` one with an inerter. Coordinates `primary`
    and `absorber`, force `primary_force` on the primary mass; there is no road.

    Raises `MechanismError` unless masses and stiffness are positive and the damping is not negative, `NetworkError` if
    `mount` or `ground` is no network.
    """

    primary_mass: float | Free = field(
        metadata=quantity("kg", "What is to be kept quiet.", "1000 kg", may_be_free=True)
    )
    primary_stiffness: float | Free = field(metadata=quantity("N/m", "Of its support.", "40 kN/m", may_be_free=True))
    mass: float | Free = field(metadata=quantity("kg", "Of the absorber.", "50 kg", may_be_free=True))
    mount: Network = field(metadata=mounted("Between primary mass and absorber."))
    ground: Network | None = field(default=None, metadata=mounted("Between absorber and ground."))
    primary_damping: float | Free = field(
        default=0.0, metadata=quantity("N s/m", "Of its support.", "100 N s/m", may_be_free=True)
    )
    key: ClassVar[str] = "absorber"
    moved: ClassVar[str] = "primary_force"
    forces: ClassVar[Mapping[str, str]] = {"primary_force": "N"}

    def mechanism(self) -> Mechanism:
        """The same absorber as a `Mechanism`."""
        support: Network = Spring(self.primary_stiffness)
        if self.primary_damping != 0.0:
            support = support | Damper(self.primary_damping)
        primary, absorber = {"primary": 1.0}, {"absorber": 1.0}
        struts = [Strut("support", support, upper=primary, lower=GROUND)]
        struts += [Strut("mount", self.mount, upper=absorber, lower=primary)]
        if self.ground is not None:
            struts += [Strut("ground", self.ground, upper=absorber, lower=GROUND)]
        return Mechanism(
            coordinates=(Coordinate("primary", self.primary_mass), Coordinate("absorber", self.mass)),
            struts=tuple(struts),
            forces=(Force("primary_force", primary),),
            measures=Measures(load_input="primary_force", load_output="primary_displacement"),
        )
