"""A record that looks as if it began at rest, of a device that moved before."""

from __future__ import annotations

import numpy as np
import pytest
from quick_fits import explained, quick_fit

import inerter as it
from inerter.identification.experiment import experiment_of
from inerter.identification.models import MODELS
from inerter.identification.statements.causes import Suspect

VALUES = {"ks": 2e5, "cs": 60.0, "b": 90.0}  # 7.5 Hz, with 0.7 % of the critical damping
TONES = ((1e-3, 1.1), (4e-4, 3.7), (2e-4, 6.2))  # [m], [Hz]


def record() -> it.Record:
    """The steady state from an instant at which the table hardly moves, nor turns back."""
    omega = 2.0 * np.pi * np.array([f for _, f in TONES])
    size = np.array([a for a, _ in TONES])
    random = np.random.default_rng(4)
    while True:
        phases = size * np.exp(1j * random.uniform(0.0, 2.0 * np.pi, 3))
        speed, acceleration = (abs(float(np.sum(((1j * omega) ** n * phases).real))) for n in (1, 2))
        if speed < 0.01 * np.sum(omega * size) and acceleration < 0.1 * np.sum(omega**2 * size):
            break
    time = np.arange(1500) / 250.0
    shaft, turning = VALUES["ks"] + 1j * omega * VALUES["cs"], -(omega**2) * VALUES["b"]
    waves = np.exp(1j * np.outer(time, omega))
    x = (waves @ phases).real + 1e-7 * random.standard_normal(time.size)
    force = (waves @ (shaft * turning / (shaft + turning) * phases)).real
    return it.Record(time, x, force + 2e-3 * np.std(force) * random.standard_normal(time.size))


@pytest.mark.campaign
def test_the_motion_before_is_named_and_its_values_are_those_of_the_device() -> None:
    """The steady state of the device, by its dynamic stiffness."""
    read = record()
    assert experiment_of(read).kept[0]
    solution = quick_fit(read, MODELS["elastic"], VALUES)
    assert not solution.misfit.is_noise_limited
    (first, *_), _ = explained(solution)
    assert first.name is Suspect.IN_MOTION, first.sentence
    for name, true in VALUES.items():
        value, error = first.estimates[name]
        assert abs(value - true) < 4.0 * error, name
