"""The index of ride comfort."""

from __future__ import annotations

from dataclasses import dataclass

from inerter.indices.question import Question, on_road
from inerter.signals.road import Road
from inerter.vehicle.mechanism import Mechanism


@dataclass(frozen=True)
class RideComfort:
    """J1: r.m.s. body acceleration on a road [m/s^2].

    Quarter car: 2 pi sqrt(V kappa) times the H2 norm from road velocity to body acceleration. Half car: bounce plus
    pitch times the mean lever (l_f + l_r)/2, each with its own norm. Source: Wang and Su (2008), eq. (4).
    """

    road: Road
    symbol = "J1"
    title = "ride comfort"
    unit = "m/s^2"
    response = "body acceleration per road velocity"

    def question(self, mechanism: Mechanism) -> Question:
        """Raises `PerformanceIndexError` if the mechanism has no road or says nothing of comfort."""
        return on_road(self, mechanism, mechanism.measures.comfort, "measures.comfort")
