"""Two-terminal elements, one file each with all its roles, and the algebra that combines them.

Signs: the elongation of an element is the displacement of its upper end minus that of its lower end; its force is
positive in tension, when it pulls its ends together.
"""

from inerter.networks.elements.algebra import Bridge, CombinedNetwork, Network, Parallel, Series, check_network
from inerter.networks.elements.damper import Damper
from inerter.networks.elements.element import Element
from inerter.networks.elements.friction import Friction
from inerter.networks.elements.gap import Gap
from inerter.networks.elements.inerter import Inerter
from inerter.networks.elements.registry import ELEMENT_TYPES
from inerter.networks.elements.spring import Spring
from inerter.networks.elements.values import NAME, Free, Tied, Value, free, middle, tied

__all__ = [
    "ELEMENT_TYPES",
    "NAME",
    "Bridge",
    "CombinedNetwork",
    "Damper",
    "Element",
    "Free",
    "Friction",
    "Gap",
    "Inerter",
    "Network",
    "Parallel",
    "Series",
    "Spring",
    "Tied",
    "Value",
    "check_network",
    "free",
    "middle",
    "tied",
]
