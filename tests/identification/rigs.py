"""Devices and records that the tests of identification share."""

from __future__ import annotations

import inerter as it

BALL_SCREW = (
    (it.Spring(it.free(1e5, 1e7, name="ks")) | it.Damper(it.free(100, 2e4, name="cs")))
    - it.Gap(it.free(0, 1e-3, name="gap"))
    - (it.Inerter(it.free(10, 500, name="b")) | it.Friction(it.free(0, 100, name="f")))
)
PAPER = {"ks": 1e6, "cs": 3200.0, "gap": 0.0, "b": 113.0, "f": 10.0}  # Wang and Su (2008), section 4


def device(**changes: float) -> it.Network:
    """The paper's ball screw, or one like it."""
    return it.Rig(BALL_SCREW).with_values({**PAPER, **changes}).device


def fit_test(
    seed: int = 0, duration: float = 5.0, sensors: dict[str, object] | None = None, **changes: float
) -> it.Record:
    """The fit test of the paper: a cosine of 1 mm at 3 Hz."""
    rig = it.VirtualRig(device(**changes), seed=seed, **(sensors or {}))
    return rig.run(it.cosine(amplitude=1e-3, frequency=3.0), duration=duration)
