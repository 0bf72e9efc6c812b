"""An index with a filter and a setting of its own: ride comfort without what passengers call motion sickness."""

from __future__ import annotations

from dataclasses import dataclass, field

import inerter as it


@it.INDICES.add
@dataclass(frozen=True)
class WeightedComfort:
    """W1: r.m.s. body acceleration on a road [m/s^2] above a corner frequency, by a filter of first order."""

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

    def question(self, mechanism: it.Mechanism) -> it.Question:
        return it.on_road(self, mechanism, mechanism.measures.comfort, "measures.comfort", high_pass=self.corner)
