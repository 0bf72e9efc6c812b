"""Faults put into a record are found, and none where there are none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bench import KGF, bench
from hypothesis import given, settings
from hypothesis import strategies as st

from inerter.records.inspection import findings, questionable_units
from inerter.records.record import Record

GOOD = bench(5000, 1000.0)
T = GOOD.time


def kinds(record, *severities):
    return {f.kind for f in findings(record) if f.severity in (severities or ("warning", "error"))}


def only(record, kind):
    (found,) = [finding for finding in findings(record) if finding.kind == kind]
    assert found.sentence.endswith((".", "?"))
    return found


TIME = np.arange(20000) * 1e-3
OMEGA = 2 * np.pi * 0.7 * np.arange(1, 31)
TONES = np.exp(1j * np.outer(OMEGA, TIME))


def multisine(delay=0.0, late_acceleration=None, damping=200.0, friction=0.0, seed=1):
    """An inerter of 100 kg behind 1e7 N/m and 3000 N s/m, beside a damper and friction, from 0.7 to 21 Hz."""
    rng = np.random.default_rng(seed)
    time, omega = TIME, OMEGA
    start = np.exp(2j * np.pi * rng.random(30)) * 2e-4 / np.arange(1, 31) / 0.7

    def signal(size, late=0.0):
        return np.real((size * start * np.exp(-1j * omega * late)) @ TONES)

    elastic = 1e7 + 3000j * omega
    mass = 100.0 * elastic / (elastic - 100.0 * omega**2)
    force = signal(-(omega**2) * mass + 1j * omega * damping, delay)
    force += friction * np.sign(signal(1j * omega, delay)) + rng.normal(0.0, 0.3, time.size)
    acceleration = None
    if late_acceleration is not None:
        acceleration = signal(-(omega**2), late_acceleration) + rng.normal(0.0, 0.05, time.size)
    force = np.round(force / 0.196133) * 0.196133
    return Record(time, np.round(signal(np.ones(30)) * 1e6) * 1e-6, force, acceleration=acceleration)


def test_a_good_record_has_no_faults():
    assert kinds(GOOD) == set()
    assert kinds(multisine()) == set()


def test_steps_of_the_sensors():
    assert only(GOOD, "displacement-steps").numbers["step"] == pytest.approx(1e-6)
    assert only(GOOD, "force-steps").numbers["step"] == pytest.approx(0.02 * KGF)


JITTER = np.random.default_rng(0).normal(0.0, 2e-5, T.size)
X, F = GOOD.displacement, GOOD.force
FAULTS = {
    "few-samples": GOOD.samples(slice(0, 60)),
    "gaps": Record(*(np.delete(c, slice(1000, 1020)) for c in (T, X, F))),
    "jitter": replace(GOOD, time=T + JITTER),
    "saturation": replace(GOOD, force=np.clip(F, -30.0, 30.0)),
    "constant": replace(GOOD, displacement=np.full(T.size, 1e-3)),
    "implausible": replace(GOOD, displacement=X * 1e6),
    "time-scale": replace(GOOD, time=T * 1e3),
    "force-reversed": replace(GOOD, force=-F),
    "force-offset": replace(GOOD, force=F + 500.0),
    "displacement-offset": replace(GOOD, displacement=X + 0.1),
    "force-drift": replace(GOOD, force=F + 20.0 * T / T[-1]),
    "swapped": Record(T, F * 1e-3, X * 1e5),
    "hum": replace(GOOD, force=F + 2.0 * np.sin(2 * np.pi * 50.0 * T)),
    "filled": replace(GOOD, meta={"filled": {"force": (12, 4)}}),
    "cut": replace(GOOD, meta={"cut": True}),
}


@pytest.mark.parametrize("kind", FAULTS)
def test_each_fault_is_found(kind):
    found = only(FAULTS[kind], kind)
    assert found.severity == ("error" if kind == "constant" else "warning")
    assert len(found.sentence) < 400


def test_times_in_a_wrong_unit():
    assert "'ms'" in only(replace(GOOD, time=T * 1e3), "time-scale").sentence  # ms that were read as s
    assert "'s'" in only(replace(GOOD, time=T * 1e-3), "time-scale").sentence  # s that were read as ms


def test_a_slow_test_of_the_friction_is_not_too_slow():
    """1 mm at 0.1 Hz, as recommended for friction: 1 t would add a few percent of 10 N."""
    time = np.arange(6000) * 5e-3
    phase = 2 * np.pi * 0.1 * time
    force = -10.0 * np.sign(np.sin(phase)) + np.random.default_rng(0).normal(0.0, 0.1, time.size)
    assert "time-scale" not in kinds(Record(time, 1e-3 * np.cos(phase), force))


def test_a_load_cell_at_its_known_range():
    record = replace(GOOD, force=np.clip(F, -40.0, 40.0), force_range=40.0)
    assert only(record, "saturation").numbers["share"] == pytest.approx(np.mean(np.abs(F) >= 40.0), abs=1e-3)
    assert "saturation" not in kinds(replace(GOOD, force_range=100.0))


def test_a_constant_force():
    assert only(replace(GOOD, force=np.zeros(T.size)), "constant").sentence.startswith("The force is constant, 0 N")


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("law", ["inertia", "friction", "damper"])
def test_the_sign_of_the_force(law, sign):
    omega = 2 * np.pi * 3.0
    x, v, a = (1e-3 * f for f in (np.cos(omega * T), -omega * np.sin(omega * T), -(omega**2) * np.cos(omega * T)))
    force = {"inertia": 50.0 * a, "friction": 10.0 * np.sign(v), "damper": 300.0 * v}[law]
    force = sign * (force + np.random.default_rng(0).normal(0.0, 0.5, T.size))
    assert ("force-reversed" in kinds(Record(T, x, force))) == (sign < 0)


def test_a_spring_is_not_a_reversed_inerter():
    noise = np.random.default_rng(0).normal(0.0, 0.5, T.size)
    omega = 2 * np.pi * 3.0
    force = 1e5 * np.cos(omega * T) * 1e-3 - 20.0 * np.sin(omega * T) + noise
    assert "force-reversed" not in kinds(Record(T, 1e-3 * np.cos(omega * T), force))


def estimated_delay(record):
    """The delay [s] that is found and its standard error; nan if it is not identifiable."""
    numbers = only(record, "delay").numbers
    return numbers.get("delay", np.nan), numbers.get("standard_error", np.nan)


@settings(max_examples=8)
@given(st.floats(-3e-3, 3e-3), st.integers(0, 100))
def test_a_delay_against_a_measured_acceleration(late, seed):
    delay, error = estimated_delay(multisine(late_acceleration=late, seed=seed))
    assert error < 5e-5
    assert abs(delay - late) < 5.0 * error + 1e-5


@pytest.mark.campaign
@settings(max_examples=8)
@given(st.floats(-3e-3, 3e-3), st.sampled_from([0.0, 200.0, 1000.0]), st.sampled_from([0.0, 10.0]), st.integers(0, 100))
def test_a_delay_beside_the_phase_of_the_device(late, damping, friction, seed):
    delay, error = estimated_delay(multisine(late, damping=damping, friction=friction, seed=seed))
    assert np.isnan(delay) or abs(delay - late) < 5.0 * error


def test_a_delay_is_not_made_up_from_one_frequency():
    assert np.isnan(estimated_delay(GOOD)[0])
    assert "Record a sweep or multisine" in only(GOOD, "delay").sentence


def test_short_and_strange_records_are_judged_without_trouble():
    rng = np.random.default_rng(0)
    for size in (4, 5, 8, 9, 17, 64, 100):
        for values in (np.arange(size), rng.normal(size=size), np.eye(size)[0], np.zeros(size)):
            for time in (np.arange(size) * 1e-3, np.cumsum(rng.random(size) + 0.1)):
                assert findings(Record(time, values, values[::-1]))


@pytest.mark.parametrize(
    ("role", "factor", "units"),
    [
        ("acceleration", 1.0 / 9.80665, "the ratio of g and m/s^2"),
        ("acceleration", 1e-3, "the ratio of mm and m"),
        ("velocity", 1e3, "the ratio of mm and m"),
        ("acceleration", 1.2, ""),
        ("velocity", -1.0, ""),
    ],
)
def test_a_channel_whose_scale_contradicts_the_displacement_is_found_with_the_factor(role, factor, units):
    """The derivatives of the motion are known, so that no scale is one of the package."""
    omega, random = 2 * np.pi * np.array([0.9, 2.3, 4.1]), np.random.default_rng(3)
    tones = np.exp(1j * np.outer(T, omega)) * np.array([2e-3, 8e-4, 3e-4])
    moved = [np.real(tones @ (1j * omega) ** order) for order in range(3)]
    measured = moved[2 if role == "acceleration" else 1]
    noisy = measured * (1.0 + 0.01 * random.standard_normal(T.size))
    record = Record(T, moved[0] + 2e-7 * random.standard_normal(T.size), 80.0 * moved[2])
    assert "inconsistent-scales" not in kinds(replace(record, **{role: 1.02 * noisy}))
    found = only(replace(record, **{role: factor * noisy}), "inconsistent-scales")
    assert found.about == role
    assert found.numbers["factor"] == pytest.approx(factor, rel=0.01)
    assert units in found.sentence
    said = [f.kind for f in questionable_units(replace(record, **{role: factor * noisy}))]
    assert said == ["inconsistent-scales"]
