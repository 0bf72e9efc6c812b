"""The vehicles, the road and the indices of Wang and Su (2008)."""

from __future__ import annotations

from inerter import HalfCar, LoadCarrying, QuarterCar, RideComfort, Road, TyreLoad
from inerter.networks.elements import Network

ROAD = Road(roughness=5e-7, speed=25.0)
J1, J3, J5 = RideComfort(ROAD), TyreLoad(ROAD), LoadCarrying()


def paper_quarter_car(strut: Network) -> QuarterCar:
    return QuarterCar(sprung_mass=181.75, unsprung_mass=25.0, tyre_stiffness=120e3, strut=strut)


def paper_half_car(front: Network, rear: Network) -> HalfCar:
    return HalfCar(363.5, 200.0, 25.0, 20.0, 120e3, 100e3, 0.775, 1.265, front, rear)
