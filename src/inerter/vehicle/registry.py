"""Registry of the vehicle models of files, by key."""

from __future__ import annotations

from inerter.registry import Registry
from inerter.vehicle.absorber import Absorber
from inerter.vehicle.full_car import FullCar
from inerter.vehicle.half_car import HalfCar
from inerter.vehicle.quarter_car import QuarterCar
from inerter.vehicle.rig import Rig
from inerter.vehicle.vehicle import VehicleModel

VEHICLES: Registry[type[VehicleModel]] = Registry(
    "vehicle", "key", ("mechanism", "moved", "forces"), (QuarterCar, HalfCar, FullCar, Absorber, Rig)
)
