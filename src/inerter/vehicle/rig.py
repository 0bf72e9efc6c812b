"""The test rig of Wang and Su (2008)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

from inerter.errors import MechanismError
from inerter.field_metadata import mount
from inerter.networks.elements import Damper, Network, Spring
from inerter.validation import check_positive
from inerter.vehicle.mechanism import GROUND, Coordinate, Mechanism, RoadInput, Strut
from inerter.vehicle.vehicle import VehicleModel

_CELL = 1e13  # [N/m] stiffness of a load cell: a millionth of the compliance of any device
_ON_CELL = {"load_cell": 1.0}


@dataclass(frozen=True)
class Rig(VehicleModel):
    """A device between a motion table, whose displacement is prescribed, and a load cell on the ground.

    Source: Wang and Su (2008), the test platform. Input `displacement` [m] of the upper end of the device; the load
    cell reads the output `device_force`, positive in tension. A load cell of bandwidth `cell_bandwidth` [Hz] (second
    order, Butterworth) is a mass on a very stiff spring; its reading is `reading_force`.

    Raises `NetworkError` if `device` is not a network, `MechanismError` if the bandwidth is not positive.

    >>> import inerter as it
    >>> run = it.simulate(it.Rig(it.Spring(1e5)), displacement=it.step(0.01), duration=0.1)
    >>> float(run["device_force"][-1])  # N, positive in tension
    1000.0
    """

    device: Network = field(metadata=mount("Between table and load cell."))
    cell_bandwidth: float | None = None  # [Hz]
    key: ClassVar[str] = "rig"
    moved: ClassVar[str] = "displacement"

    def __post_init__(self) -> None:
        if self.cell_bandwidth is not None:
            check_positive(MechanismError, "The bandwidth of a load cell", self.cell_bandwidth, "Hz")
        super().__post_init__()

    def mechanism(self) -> Mechanism:
        """The same rig as a `Mechanism`."""
        coordinates: tuple[Coordinate, ...] = ()
        cell: tuple[Strut, ...] = ()
        lower = GROUND
        if self.cell_bandwidth is not None:
            omega = 2.0 * math.pi * self.cell_bandwidth
            coordinates, lower = (Coordinate("load_cell", _CELL / omega**2),), _ON_CELL
            damping = math.sqrt(2.0) * _CELL / omega
            holder = Spring(_CELL, name="reading") | Damper(damping, name="load_cell_damping")
            cell = (Strut("load_cell_mount", holder, upper=_ON_CELL, lower=GROUND),)
        return Mechanism(
            coordinates=coordinates,
            struts=(Strut("device", self.device, upper={"displacement": 1.0}, lower=lower), *cell),
            roads=(RoadInput("displacement"),),
        )

    @property
    def reading(self) -> str:
        """The output that the load cell reads."""
        return "device_force" if self.cell_bandwidth is None else "reading_force"
