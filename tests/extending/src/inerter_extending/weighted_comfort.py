"""An index with a filter and a setting of its own: ride comfort without the frequencies of motion sickness."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import sqrt

import inerter as it


@it.INDICES.add
@dataclass(frozen=True)
class WeightedComfort:
    """W1: r.m.s. body acceleration on a road [m/s^2] above a corner frequency, by a filter of second order."""

    road: it.Road
    corner: float = field(
        default=3.0,
        metadata=it.quantity(
            "rad/s", "Corner of the filter on W1; 3 rad/s.", "0.5 Hz", key="weighting_corner", words="weighting filter"
        ),
    )
    symbol = "W1"
    title = "weighted ride comfort"
    unit = "m/s^2"
    response = "body acceleration per road velocity"

    def definition(self, mechanism: it.Mechanism) -> it.IndexDefinition:
        weighting = it.Filter((1.0, 0.0, 0.0), (1.0, sqrt(2.0) * self.corner, self.corner**2))  # Butterworth
        return it.on_road(self, mechanism, mechanism.measures.comfort, "measures.comfort", weighting)
