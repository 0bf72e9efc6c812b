"""Comparison of two integrations that must have gone through the same motion."""

from __future__ import annotations

import numpy as np

from inerter.simulation.event_driven import Integration


def assert_same_motion(run: Integration, expected: Integration, *, instants: float, states: float) -> None:
    """The same events, at instants [s] within `instants`, and states within `states` of the largest expected ones."""
    found, known = (one.record.events[: one.events] for one in (run, expected))
    assert [found[of].tolist() for of in ("element", "before", "after")] == [
        known[of].tolist() for of in ("element", "before", "after")
    ]
    np.testing.assert_allclose(found["time"], known["time"], rtol=0.0, atol=instants)
    scale = np.abs(expected.record.states).max(axis=0)
    np.testing.assert_allclose(run.record.states / scale, expected.record.states / scale, rtol=0.0, atol=states)
