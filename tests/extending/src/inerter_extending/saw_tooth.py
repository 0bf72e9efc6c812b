"""A signal: a saw-tooth, as of a road of worn concrete slabs."""

from __future__ import annotations

import inerter as it


def saw_tooth(height: float, length: float, speed: float) -> it.Signal:
    """Slabs of this length [m], each of which rises by `height` [m] and ends in a steep ramp."""
    period = length / speed
    time, value = [0.0, 0.95 * period, period], [0.0, height, 0.0]
    return it.Signal.sampled(time, value, "linear", periodic=True, speed=speed, label="saw-tooth")


it.SIGNALS.add(
    it.SignalKind(
        "saw-tooth",
        saw_tooth,
        {
            "height": it.SignalKey("m", 'height = "4 mm"'),
            "length": it.SignalKey("m", 'length = "5 m"', 5.0),
        },
        given=("speed",),
        needs=("speed",),
        of_roads=True,
    )
)
