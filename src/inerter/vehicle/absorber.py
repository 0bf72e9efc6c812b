"""A vibration absorber: a tuned mass damper, optionally with an inerter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from inerter.field_metadata import mount as mounted
from inerter.field_metadata import quantity
from inerter.networks.elements import Damper, Free, Network, Spring
from inerter.vehicle.mechanism import GROUND, Coordinate, Force, Mechanism, PerformanceOutputs, Strut
from inerter.vehicle.vehicle import VehicleModel


@dataclass(frozen=True)
class Absorber(VehicleModel):
    """A primary mass on its support, an absorber mass on it, and optionally a network from that to the ground.

    The support is a spring, with a damper in parallel if `primary_damping` is not zero. With a spring and a damper as
    its `mount` this is a tuned mass damper, and with an inerter as its `ground` a tuned mass damper inerter.
    Coordinates `primary` and `absorber`, force `primary_force` on the primary mass; no road.

    Raises `MechanismError` unless masses and stiffness are positive and the damping is not negative, `NetworkError` if
    `mount` or `ground` is not a network.

    >>> import inerter as it
    >>> import numpy as np
    >>> damper = it.Absorber(1000.0, 40e3, mass=50.0, mount=it.Spring(2e3))  # kg, N/m; tuned: 2e3 / 50 = 40e3 / 1000
    >>> system = it.state_space(damper, "primary_force", "primary_acceleration")
    >>> still = it.frequency_response(system, [np.sqrt(40.0)])  # [rad/s]; the primary mass stands still
    >>> bool(abs(still[0, 0, 0]) < 1e-9)
    True
    """

    primary_mass: float | Free = field(
        metadata=quantity("kg", "Primary mass, whose vibration is to be reduced.", "1000 kg", may_be_free=True)
    )
    primary_stiffness: float | Free = field(metadata=quantity("N/m", "Support stiffness.", "40 kN/m", may_be_free=True))
    mass: float | Free = field(metadata=quantity("kg", "Absorber mass.", "50 kg", may_be_free=True))
    mount: Network = field(metadata=mounted("Between primary mass and absorber."))
    ground: Network | None = field(default=None, metadata=mounted("Between absorber and ground."))
    primary_damping: float | Free = field(
        default=0.0, metadata=quantity("N s/m", "Support damping.", "100 N s/m", may_be_free=True)
    )
    key: ClassVar[str] = "absorber"
    question: ClassVar[str] = "A vibration absorber"
    outline: ClassVar[str] = "absorber"
    moved: ClassVar[str] = "primary_force"
    forces: ClassVar[Mapping[str, str]] = {"primary_force": "N"}

    def mechanism(self) -> Mechanism:
        """The same absorber as a `Mechanism`."""
        # named, or an element of the study that is called k would be taken for this one
        support: Network = Spring(self.primary_stiffness, name="primary_stiffness")
        if self.primary_damping != 0.0:
            support = support | Damper(self.primary_damping, name="primary_damping")
        primary, absorber = {"primary": 1.0}, {"absorber": 1.0}
        struts = [Strut("support", support, upper=primary, lower=GROUND)]
        struts += [Strut("mount", self.mount, upper=absorber, lower=primary)]
        if self.ground is not None:
            struts += [Strut("ground", self.ground, upper=absorber, lower=GROUND)]
        return Mechanism(
            coordinates=(Coordinate("primary", self.primary_mass), Coordinate("absorber", self.mass)),
            struts=tuple(struts),
            forces=(Force("primary_force", primary),),
            measures=PerformanceOutputs(load_input="primary_force", load_output="primary_displacement"),
        )
