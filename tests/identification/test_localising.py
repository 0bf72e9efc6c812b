"""Where a misfit is: faults put into the force of a rigid device are located by their kind, and chance is none."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from numpy.typing import NDArray
from rigid_fits import read, rigid_fit, rigid_record
from scipy.stats import binom

from inerter.figures.misfit import misfit_figure
from inerter.identification.fit import Localisation
from inerter.identification.localising import (
    SURE,
    LocalisedSamples,
    _band,
    _level_changes,
    _localised_samples,
    _resonance,
    localisation_of,
)
from inerter.identification.statements.patterns import FRICTION, MisfitPattern
from inerter.records.record import Record
from inerter.report.identification_figures import residual_samples

Matrix = NDArray[np.float64]
Motion = dict[str, Matrix]


def _noise(m: Motion, seed: int) -> Matrix:
    return np.random.default_rng([seed, 5]).standard_normal(m["time"].size)


def _temperature(m: Motion) -> Matrix:
    """Of a run that warms up and cools down again, so that it is no matter of time."""
    return 20.0 + 15.0 * np.sin(np.pi * m["time"] / m["time"][-1]) ** 2


def _spiked(m: Motion, seed: int) -> Matrix:
    at = np.random.default_rng([seed, 6]).choice(m["time"].size - 100, 20, replace=False) + 50
    return m["force"] + np.where(np.isin(np.arange(m["time"].size), at), 120.0, 0.0)


def _bump(x: Matrix, place: float) -> Matrix:
    return np.exp(-(((x - place) / 1.5e-4) ** 2))


PLACES: dict[str, tuple[Callable[[Motion, int], Matrix], MisfitPattern, str]] = {
    "other inertance": (
        lambda m, s: m["force"] - 16.0 * np.where(m["time"] > 1.7, m["a"], 0.0), MisfitPattern.COEFFICIENT_STEP,
        "acceleration",
    ),
    "other friction": (
        lambda m, s: m["force"] + 8.0 * np.where(m["time"] > 1.7, np.sign(m["v"]), 0.0), MisfitPattern.COEFFICIENT_STEP,
        "direction",
    ),
    "gain": (lambda m, s: m["force"] * (1.0 + 0.04 * m["time"]), MisfitPattern.COEFFICIENT_TREND, "force"),
    "drift": (lambda m, s: m["force"] + 2.0 * m["time"], MisfitPattern.COEFFICIENT_TREND, "constant"),
    "loose": (lambda m, s: m["force"] + np.where(m["time"] > 2.3, 2.0 * _noise(m, s), 0.0), MisfitPattern.BEGINS, ""),
    "warm": (
        lambda m, s: m["force"] + 0.25 * (_temperature(m) - 20.0) * _noise(m, s), MisfitPattern.CHANNEL, "temperature",
    ),
    "viscous": (lambda m, s: m["force"] + 300.0 * m["v"], MisfitPattern.MEAN, "velocity"),
    "spring": (lambda m, s: m["force"] + 3e9 * m["x"] ** 3, MisfitPattern.MEAN, "displacement"),
    "bumps": (
        lambda m, s: m["force"] + 8.0 * np.sign(m["v"]) * (_bump(m["x"], 1e-3) + _bump(m["x"], -1.2e-3)),
        MisfitPattern.MEAN, FRICTION,
    ),
    "noise by speed": (lambda m, s: m["force"] + 60.0 * m["v"] * _noise(m, s), MisfitPattern.SPREAD, "velocity"),
    "hum": (lambda m, s: m["force"] + 3.0 * np.sin(860.0 * m["time"]), MisfitPattern.LINE, ""),
    "spikes": (_spiked, MisfitPattern.INSTANTS, ""),
}  # fmt: skip


def located(name: str, seed: int) -> Localisation:
    _, motion = rigid_record(seed)
    return localisation_of(
        rigid_fit(read(motion, PLACES[name][0](motion, seed), seed, temperature=_temperature(motion)))
    )


@pytest.mark.parametrize(
    ("name", "seed"), sampled([(n, s) for n in PLACES for s in range(5)], [(n, 0) for n in PLACES], kept=12)
)
def test_a_fault_is_located_by_its_kind(name: str, seed: int) -> None:
    _, kind, about = PLACES[name]
    found = located(name, seed)
    first = found.patterns[0]
    if name == "loose" and first.kind is MisfitPattern.LEVEL_STEP:  # where the fit misses reversals before it too
        assert first.numbers["time"] == pytest.approx(2.3, abs=0.01)
        assert first.numbers["after"] > 3.0 * first.numbers["before"]
    else:
        assert (first.kind, first.about) == (kind, about), [p.sentence for p in found.patterns]
    assert first.numbers.get("p", 0.0) < SURE
    assert found.sentence == first.sentence
    assert len(found.sentence) < 200


def test_numbers_of_the_patterns() -> None:
    (swapped, *_), (loose, *_), (hum, *_) = (located(n, 1).patterns for n in ("other inertance", "loose", "hum"))
    assert swapped.numbers["time"] == pytest.approx(1.7, abs=0.02)
    assert swapped.numbers["change"] == pytest.approx(-16.0, rel=0.1)
    assert loose.numbers["time"] == pytest.approx(2.3, abs=0.05)
    assert loose.numbers["after"] > 5.0 > loose.numbers["before"]
    assert hum.numbers["frequency"] == pytest.approx(860.0 / 2.0 / np.pi, abs=0.3)
    assert hum.numbers["foreign"]
    bumps = located("bumps", 1).patterns[0]
    centres, means = (np.array(bumps.numbers[key]) for key in ("centres", "means"))
    assert set(np.round(centres[np.argsort(means)[-2:]], 3)) <= {1e-3, -1e-3, -1.1e-3, -1.2e-3, -1.3e-3, 1.1e-3, 9e-4}


def test_spikes_are_told_from_slower_bumps_with_their_length() -> None:
    _, motion = rigid_record(1)
    spiked = motion["force"].copy()
    spiked[[400, 401, 1200, 2000]] += 60.0
    of_force = localisation_of(rigid_fit(read(motion, spiked, 1))).patterns[0]
    assert of_force.kind is MisfitPattern.INSTANTS
    assert of_force.numbers["longest"] == 2
    assert of_force.numbers["at"] in of_force.numbers["times"]
    assert "the force jumps from sample to sample" in of_force.sentence
    slow = motion["force"] + 60.0 * np.exp(-(((motion["time"] - 1.5) / 6e-3) ** 2))
    bump = localisation_of(rigid_fit(read(motion, slow, 1))).patterns[0]
    assert bump.kind is MisfitPattern.INSTANTS
    assert not bump.numbers["leaps"]


@pytest.mark.parametrize(("frequency", "multiple"), [(15.0, 3), (17.3, 0), (35.0, 7), (31.5, 0)])
def test_a_harmonic_of_the_motion_is_no_disturbance(frequency: float, multiple: int) -> None:
    _, motion = rigid_record(0, duration=6.0, tones=((2e-3, 5.0),))
    added = 3.0 * np.sin(2.0 * np.pi * frequency * motion["time"])
    patterns = localisation_of(rigid_fit(read(motion, motion["force"] + added, 0))).patterns
    line = next(p for p in patterns if p.kind is MisfitPattern.LINE)
    assert line.numbers["multiple"] == multiple
    assert line.numbers["foreign"] == (multiple == 0)


def test_what_grows_with_the_motion_says_so() -> None:
    """In a chirp a misfit by damping grows with the record; in a motion that stays as it is only with time."""
    time = np.arange(6000) / 1000.0
    sweeping, staying = (np.cos(2.0 * np.pi * phase) for phase in (0.5 * time + 0.6 * time**2, 4.0 * time))
    said = []
    for shape in (sweeping, staying):
        x = 2e-3 * shape
        v, a = np.gradient(x, 1e-3), np.gradient(np.gradient(x, 1e-3), 1e-3)
        noise = np.random.default_rng(1).normal(size=time.size)
        level = 0.05 * np.abs(a) if shape is sweeping else 0.2 * (1.0 + 2.0 * time)
        samples = LocalisedSamples(
            time, level * noise, np.full(time.size, 0.1), {"acceleration": a, "velocity": v},
            np.asarray(np.arange(6000) // 150),
        )  # fmt: skip
        (found,) = _level_changes(samples, np.random.default_rng(0))
        said.append(found)
    assert [found.kind for found in said] == [MisfitPattern.GROWS] * 2
    assert [found.numbers["motion"] for found in said] == [True, False]
    assert "together with the acceleration of the motion" in said[0].sentence


def test_a_band_in_which_the_device_resonates_is_no_place_of_a_fault() -> None:
    frequency = np.arange(2000) / 10.0
    ringing = np.exp(-(((frequency - 25.0) / 3.0) ** 2)) + 1e-3
    at = _resonance(frequency, ringing, 10.0)
    assert at == pytest.approx((25.0 - 1.036 * 1.5, 25.0 + 1.036 * 1.5), abs=0.1)  # of a Gaussian power of 1.5 Hz
    assert _resonance(frequency, 1.0 / (frequency + 1.0), 10.0)[0] == math.inf  # as friction alone, which rings nowhere
    excess, shares = ringing**2, []
    for resonance in (at, (math.inf, math.inf), (80.0, 120.0)):
        (band,) = _band(frequency, excess, float(excess.sum()), 10.0, resonance)
        shares.append((band.numbers["resonates"], band.numbers["share"]))
    assert [resonates for resonates, _ in shares] == [True, False, False]
    assert shares[0][1] == pytest.approx(0.5 * shares[1][1])


def coloured(seed: int) -> Record:
    """A record whose load cell has noise that is autocorrelated over 10 ms, which belongs to nothing in it."""
    _, motion = rigid_record(seed)
    noise = np.convolve(_noise(motion, seed), np.exp(-np.arange(60) / 10.0), "same")
    return read(motion, motion["force"] + 0.6 * noise, seed)


@pytest.mark.parametrize("count", sampled([12, 60], [12], [60]))
def test_chance_is_no_pattern_of_the_motion_or_of_time(count: int) -> None:
    """Dependences and changes are named no more often than their p-value says."""
    by_chance = 0
    for seed in range(count):
        found = localisation_of(rigid_fit(coloured(seed)))
        by_chance += any(p.numbers.get("p", 1.0) < SURE for p in found.patterns)
    assert by_chance <= binom.ppf(0.999, count, SURE)


@pytest.mark.parametrize("frequency", [0.6, 1.1, 2.3])
def test_blocks_are_no_shorter_than_a_stroke(frequency: float) -> None:
    """Within which residuals are autocorrelated; those of slow motions are few."""
    record, _ = rigid_record(0, duration=8.0, tones=((2e-3, frequency),))
    samples = _localised_samples(rigid_fit(record))
    lengths = [float(np.ptp(samples.time[samples.block == n])) + 1e-3 for n in range(samples.blocks)]
    assert min(lengths) > 0.4 / frequency
    assert max(lengths) < 1.2 / frequency


def test_a_line_is_found_at_its_frequency_across_samples_that_are_left_out() -> None:
    """Such as those of a saturated load cell: joined, the stretches on both sides would be out of phase."""
    _, motion = rigid_record(1, duration=6.0)
    fit = rigid_fit(read(motion, motion["force"] + 3.0 * np.sin(2.0 * np.pi * 83.0 * motion["time"]), 1))
    left_out = np.zeros(fit.fitted.size, dtype=bool)
    for start in range(500, 5500, 450):
        left_out[start : start + 137] = True
    holed = replace(fit, fitted=fit.fitted & ~left_out, checked=fit.checked & ~left_out)
    line = next(p for p in localisation_of(holed).patterns if p.kind is MisfitPattern.LINE)
    assert line.numbers["frequency"] == pytest.approx(83.0, abs=0.2)
    assert 0.84 * 3.0 < line.numbers["amplitude"] < 1.05 * 3.0  # between two lines a Hann window takes up to 15 %


def test_p_values_are_multiplied_by_the_number_of_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which are counted where they are made: every p-value of one record, with two further channels."""
    made = []
    monkeypatch.setattr("inerter.identification.localising._p_value", lambda found, drawn: (made.append(1), 0.5)[1])
    _, motion = rigid_record(0)
    trouble = motion["force"] + 30.0 * np.where(motion["time"] > 2.0, motion["a"], 0.0) + 8.0 * _noise(motion, 0)
    one = rigid_fit(read(motion, trouble, 0, temperature=_temperature(motion), humidity=_temperature(motion)))
    localisation_of(one)
    tests = _localised_samples(one).tests
    assert tests == 31
    assert len(made) <= tests - 1  # but for that of a line; coefficients that hardly change are not tested


def test_the_figure_has_labels_with_units_and_marks_changes() -> None:
    _, motion = rigid_record(0)
    comparison = rigid_fit(read(motion, PLACES["other inertance"][0](motion, 0), 0))
    place = localisation_of(comparison)
    figure = misfit_figure(residual_samples(comparison, place))
    panels = [ax for ax in figure.axes if ax.get_title(loc="left")]
    assert len(panels) == 6
    assert all("[" in ax.get_xlabel() and "[" in ax.get_ylabel() for ax in panels)
    at = [line.get_xdata()[0] for line in panels[0].lines if line.get_label() == "change"]
    assert at[0] == pytest.approx(1.7, abs=0.02)
