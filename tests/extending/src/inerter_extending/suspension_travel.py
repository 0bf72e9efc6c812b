"""An index: how much room a suspension needs."""

from __future__ import annotations

from dataclasses import dataclass

import inerter as it


@it.INDICES.add
@dataclass(frozen=True)
class SuspensionTravel:
    """T1: r.m.s. travel of the suspension on a road [m], added up over the struts."""

    road: it.Road
    symbol = "T1"
    title = "suspension travel"
    unit = "m"
    response = "travel per road velocity"

    def definition(self, mechanism: it.Mechanism) -> it.IndexDefinition:
        travels = tuple(it.OutputWeight(f"{strut.name}_travel") for strut in mechanism.struts)
        return it.on_road(self, mechanism, travels, "struts")
