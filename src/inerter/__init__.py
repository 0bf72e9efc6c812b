"""What an inerter does for a vehicle, and which design is best.

Networks of springs, dampers, inerters, dry friction and gaps; quarter cars, half cars and any other mechanism; exact
norms and optimisation. Everything public is a name in this module; each is loaded when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inerter.networks.catalogue import LAYOUTS as LAYOUTS
    from inerter.networks.elements import Damper as Damper
    from inerter.networks.elements import Friction as Friction
    from inerter.networks.elements import Gap as Gap
    from inerter.networks.elements import Inerter as Inerter
    from inerter.networks.elements import Spring as Spring
    from inerter.networks.elements import free as free
    from inerter.networks.parser import network as network
    from inerter.signals.road import Road as Road
    from inerter.vehicle.cars import HalfCar as HalfCar
    from inerter.vehicle.cars import QuarterCar as QuarterCar
    from inerter.vehicle.mechanism import Mechanism as Mechanism

__version__ = version("inerter")

_HOME = {
    "LAYOUTS": "networks.catalogue",
    "Damper": "networks.elements",
    "Friction": "networks.elements",
    "Gap": "networks.elements",
    "HalfCar": "vehicle.cars",
    "Inerter": "networks.elements",
    "Mechanism": "vehicle.mechanism",
    "QuarterCar": "vehicle.cars",
    "Road": "signals.road",
    "Spring": "networks.elements",
    "free": "networks.elements",
    "network": "networks.parser",
}
__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"inerter.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
