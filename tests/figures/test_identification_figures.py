"""Figures of a rig: they show the numbers, break where nothing is known, and nothing runs over anything else."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import inerter as it
from inerter.figures import identification as figures
from inerter.figures.curves import thin_curve
from inerter.figures.identification import MotionCurve
from inerter.figures.style import style_context

RATE = 500.0
TIME = np.arange(4000) / RATE
DEVICE = it.Spring(2e4) | it.Damper(300.0) - it.Inerter(40.0)
RNG = np.random.default_rng(0)
SINE = 1e-3 * np.sin(2.0 * np.pi * 3.0 * TIME)
FORCE = -40.0 * np.sin(2.0 * np.pi * 3.0 * TIME) + 10.0 * np.sign(np.cos(2.0 * np.pi * 3.0 * TIME))
RECORD = it.Record(TIME, SINE, FORCE + RNG.normal(size=TIME.size), force_range=50.0)


def answered(gaps, count):
    """A response at `count` frequencies, with or without some left out in the middle."""
    x = np.fft.irfft(np.where(np.arange(count * 20 + 1) > 0, np.exp(2j * np.pi * RNG.uniform(size=count * 20 + 1)), 0))
    force = 2e4 * x + np.gradient(x) * 1e5 + 1e3 * x.std() * RNG.normal(size=x.size)
    found = it.frequency_response(it.Record(np.arange(x.size) / RATE, x, force))
    keep = np.ones(found.omega.size, dtype=bool)
    keep[found.omega.size // 3 : found.omega.size // 2] = not gaps
    return found.lines(keep)


MANY, BROKEN = answered(False, 100), answered(True, 100)
FEW = it.frequency_response(RECORD)
LINEAR = it.linear_response(DEVICE, np.geomspace(1.0, 300.0, 50))
MOTION = MotionCurve("measured", TIME, SINE, FORCE)
PROFILES = [
    figures.ProfileCurve("ks", np.array([99.0, 100.0, 101.5]), np.array([1.0, 0.0, 1.0]), (99.0, 101.5), "kN/m"),
    figures.ProfileCurve(
        "gap", np.array([0.0, 2.0, 4.0]), np.array([0.0, 0.3, 1.1]), (0.0, 3.8), "um", "cannot be told"
    ),
    figures.ProfileCurve("c", np.array([1.0, 9.0, 3e4]), np.array([1.0, 0.0, 0.2]), (1.0, 3e4), "N s/m"),
    figures.ProfileCurve("sensor gain", np.array([0.998, 1.0, 1.01]), np.array([3.0, 0.0, 4.0]), (0.999, 1.005), ""),
]
LAGS = np.arange(200) / RATE
FIGURES = {
    "response": lambda: figures.response_figure(MANY, MANY, LINEAR),
    "response with gaps": lambda: figures.response_figure(BROKEN),
    "one line": lambda: figures.response_figure(FEW, FEW, LINEAR),
    "friction test": lambda: figures.time_figure(MOTION),
    "fit": lambda: figures.time_figure(MOTION, MotionCurve("fitted", TIME, SINE, 1.01 * FORCE), (0.0, 2.0)),
    "record": lambda: figures.record_figure(RECORD, RECORD.trim(1.0, 5.0)),
    "residual": lambda: figures.residual_figure(TIME, 0.1 * FORCE, LAGS, np.exp(-9.0 * LAGS), 0.03),
    "profiles": lambda: figures.profile_figure(PROFILES),
    "loops": lambda: figures.loops_figure(SINE[:500], np.gradient(SINE, TIME)[:500], FORCE[:500], FORCE[:500]),
}


def drawn(make):
    with style_context():
        figure = make()
        figure.draw_without_rendering()
    return figure


@pytest.mark.parametrize("make", FIGURES.values(), ids=FIGURES)
def test_nothing_runs_over_the_edge_or_over_anything_else(make):
    figure = drawn(make)
    boxes = [ax.get_tightbbox() for ax in figure.axes] + [legend.get_window_extent() for legend in figure.legends]
    for box in boxes:
        assert figure.bbox.padded(2.0).count_contains([box.min, box.max]) == 2
    for one, other in combinations(boxes, 2):
        assert not one.padded(-1.0).overlaps(other)
    for ax in figure.axes:
        assert ax.yaxis.label.get_window_extent().height <= 1.05 * ax.get_window_extent().height
        assert ax.get_ylabel().endswith("]") or ax.get_ylabel() in (
            "Coherence",
            "Autocorrelation",
            "",
            "Rise of the misfit",
        )
        labels = [label.get_window_extent() for label in ax.get_xticklabels() if label.get_text()]
        inside = [box for box in labels if ax.bbox.x0 <= 0.5 * (box.x0 + box.x1) <= ax.bbox.x1]
        assert not any(one.overlaps(other) for one, other in combinations(inside, 2))


def test_a_curve_breaks_where_frequencies_are_left_out():
    (line,) = drawn(FIGURES["response with gaps"]).axes[0].lines
    assert np.isnan(line.get_ydata()).sum() == 1
    assert np.isfinite(BROKEN.gain).all()
    (whole,) = drawn(lambda: figures.response_figure(MANY)).axes[0].lines
    assert not np.isnan(whole.get_ydata()).any()


def test_gain_and_phase_are_those_of_the_result():
    gain, phase, coherence = drawn(FIGURES["response"]).axes
    assert "N/m]" in gain.get_ylabel()
    ratio = gain.lines[0].get_ydata() / MANY.gain
    assert ratio == pytest.approx(ratio[0])
    assert phase.lines[0].get_ydata() == pytest.approx(np.degrees(MANY.phase))
    assert coherence.lines[0].get_ydata() == pytest.approx(MANY.coherence)
    assert gain.lines[0].get_xdata() == pytest.approx(MANY.omega / (2.0 * np.pi))


def test_a_profile_is_a_parabola_between_its_points_and_the_interval_is_shaded():
    first, *_ = drawn(FIGURES["profiles"]).axes
    curve = first.lines[1]
    at, rise = curve.get_xdata(), curve.get_ydata()
    assert np.interp(99.5, at, rise) == pytest.approx(0.25, abs=1e-3)
    assert (first.patches[0].get_x(), first.patches[0].get_width()) == (99.0, 2.5)


def test_breaks_stay_breaks_in_long_curves():
    values = np.where(np.arange(100_000) % 50_000 < 20_000, np.nan, 1.0)
    _, shown = thin_curve(np.arange(100_000.0), values)
    assert 0.3 < np.isnan(shown).mean() < 0.5
    assert shown.size < 5000


def test_the_legend_names_the_measurement_first():
    words = [text.get_text() for text in drawn(FIGURES["one line"]).legends[0].get_texts()]
    assert words[0] == "measured, with 95 % band"
    assert len(words) == 3


@pytest.mark.campaign
def test_the_same_figure_gives_the_same_bytes(tmp_path):
    first, second = (figures.draw(FIGURES["fit"](), tmp_path / name, "figure-9") for name in "12")
    assert [path.suffix for path in first] == [".svg", ".pdf", ".png"]
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
