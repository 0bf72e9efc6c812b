"""High-pass filtered channels, and end stops within the motion, are named as causes of a misfit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from campaigns import sampled
from numpy.typing import NDArray
from quick_fits import explained, quick_fit
from scipy.signal import lfilter
from troubled_rig import Tones

import inerter as it
from inerter.identification.models import MODELS
from inerter.identification.statements.causes import Suspect

Matrix = NDArray[np.float64]
INERTANCE, DAMPING = 80.0, 300.0  # [kg], [N s/m]
STEP, EVERY = 5e-5, 100  # [s]; steps of a sample
CORNER = 0.12  # [Hz]
STOP, STIFFNESS = 2e-4, 2e4  # [m] before the end of the motion, [N/m]
MOTION = Tones((2e-3, 7e-4, 3e-4), (1.3, 3.7, 6.1), (0.4, 2.0, 4.0))


def high_passed(values: Matrix) -> Matrix:
    """After RC coupling, by the backward difference in steps that are short beside its time constant."""
    share = 1.0 / (1.0 + 2.0 * math.pi * CORNER * STEP)
    return np.asarray(lfilter([share, -share], [1.0, -share], values - values[0]))


def record(fault: str) -> it.Record:
    """Six seconds of a rigid device from rest."""
    x, v, a = MOTION.at(STEP * np.arange(round(6.0 / STEP)))
    force = INERTANCE * a + DAMPING * v
    if fault == "stop":
        force = force + STIFFNESS * np.maximum(x - x.max() + STOP, 0.0)
    force = high_passed(force) if fault == "force" else force
    x = high_passed(x) if fault == "displacement" else x
    random = np.random.default_rng(3)
    x, force = x[::EVERY], force[::EVERY]
    x = x + 1e-7 * random.standard_normal(x.size)
    return it.Record(STEP * EVERY * np.arange(x.size), x, force + 0.02 * random.standard_normal(x.size))


FAULTS = [
    ("force", Suspect.HIGH_PASSED_FORCE, 2.0 * math.pi * CORNER),
    ("displacement", Suspect.HIGH_PASSED_DISPLACEMENT, 2.0 * math.pi * CORNER),
    ("stop", Suspect.END_STOP, STOP),
]


@pytest.mark.parametrize(("fault", "cause", "number"), sampled(FAULTS, seldom=FAULTS[:1]))
def test_the_cause_is_among_the_first_two_with_its_number(fault: str, cause: Suspect, number: float) -> None:
    """And with the values of the device; cross-talk of the displacement does nearly the same as a high-pass filter."""
    solution = quick_fit(record(fault), MODELS["ideal-viscous"], {"b": INERTANCE, "c": DAMPING})
    assert not solution.misfit.is_noise_limited
    found, _ = explained(solution)
    first = next(e for e in found if e.name is cause)
    assert first in found[:2], [e.sentence for e in found[:3]]
    assert first.explained > 0.9
    assert any(v == pytest.approx(number, rel=0.1) for v in first.values.values())
    assert first.estimates["b"][0] == pytest.approx(INERTANCE, rel=2e-3)
    assert first.estimates["c"][0] == pytest.approx(DAMPING, rel=0.03)
