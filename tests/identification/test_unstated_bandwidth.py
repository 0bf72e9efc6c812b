"""Values of devices behind a load cell whose bandwidth the record does not state, by a rig that shares no code."""

from __future__ import annotations

import pytest
from troubled_rig import Device, Sensors, Tones, measured

import inerter as it


@pytest.mark.campaign
def test_intervals_contain_the_values_with_the_filter_for_which_a_delay_stands() -> None:
    """A filter of 60 Hz attenuates 13 Hz by 0.1 %, which a delay does not."""
    sensors = Sensors(
        rate=500.0, cell=60.0, force_noise=0.1, force_step=1e-6, encoder_step=1e-9, encoder_noise=2e-8
    )  # fmt: skip
    motion = Tones((1e-3, 2e-4, 1e-4), (2.0, 7.0, 13.0))
    record = it.Record(*measured(Device(b=100.0, f=0.0, ks=1e6, cs=2000.0), motion, sensors, 3.0, 1))
    fit = it.identify(record, "elastic", starts=8)
    assert fit.status.ok
    for name, truth in {"ks": 1e6, "cs": 2000.0, "b": 100.0}.items():
        p = fit.parameters[name]
        assert p.interval[0] <= truth <= p.interval[1], name
        assert abs(p.best - truth) < 3.0 * p.standard_error, name
