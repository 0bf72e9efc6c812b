"""Candidate devices by name, with every value free within wide bounds: what a record may turn out to be of."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from inerter.networks.elements import Damper, Friction, Gap, Inerter, Network, Spring, free
from inerter.networks.parser import network

MODELS: Mapping[str, Network] = MappingProxyType(
    {
        "ball-screw": network(
            "(ks | cs) - gap - (b | f)",
            ks=Spring(free(1e4, 1e8, name="ks")),
            cs=Damper(free(10.0, 2e5, name="cs")),
            gap=Gap(free(0.0, 2e-3, name="gap")),
            b=Inerter(free(0.5, 5000.0, name="b")),
            f=Friction(free(0.0, 500.0, name="f")),
        ),
    }
)
