"""Figures of studies: they show the numbers, nothing runs over anything else, and results decide on every byte."""

import math
import xml.etree.ElementTree as ET
from itertools import combinations

import matplotlib
import numpy as np
import pytest
import xarray as xr
from campaigns import sampled
from matplotlib.colors import to_hex
from synthetic import LONG, a_map, designs, improved, judged, sweep, with_value

from inerter.errors import StudyError
from inerter.figures.designs import frequency_responses, improvement_bars
from inerter.figures.study import draw_study, study_figures
from inerter.figures.style import log_axis, new_figure, style_context
from inerter.figures.sweeps import parameter_curves, sweep_curves
from inerter.methods.registry import brief_words_of

METHODS = ["norm", "statistical-linearisation", "expected-value", "approximate-linear"]
UNSTABLE = "unstable: the design has no finite norm"
CASES = {
    "designs": designs(),
    "many designs": designs(LONG),
    "one design": designs(["S1"], baseline=""),
    "an infinite value": with_value(designs(), math.inf, UNSTABLE, layout="S2", index="J1"),
    "a much worse layout": with_value(designs(LONG), 40.0, layout="S3", index="J1"),
    "sweep": sweep(),
    "many swept": sweep(LONG),
    "one swept": sweep(["S1"], baseline=""),
    "two values over decades": sweep(stiffness=[1e3, 1e6]),
    "two methods": judged(designs()),
    "two methods and a much worse layout": judged(with_value(designs(LONG), 40.0, layout="S3", index="J1")),
    "four methods": judged(designs(LONG), METHODS),
    "one method with errors": judged(designs(), ["expected-value"]),
    "two methods over a sweep": judged(sweep()),
    "four methods over a sweep": judged(sweep(LONG), METHODS),
    "map": a_map(),
    "map with values at bounds in one layout": a_map(LONG[:5]),
    "map of two methods": judged(a_map()),
    "nothing finite": improved(sweep().assign(value=sweep()["value"] * np.nan)),
}


LESS = ["designs", "sweep", "two methods", "two methods over a sweep", "map"]  # of which others here have more


def lines(ax):
    return {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}


@pytest.mark.parametrize("name", sampled(CASES, ["one swept"], kept=1))
def test_every_figure_is_written_as_svg_and_png(name, tmp_path):
    results = CASES[name]
    written = draw_study(results, tmp_path / "figures")
    assert {path.name for path in written} == {f"{f.name}.{e}" for f in study_figures(results) for e in ("svg", "png")}
    for path in written:
        if path.suffix == ".svg":
            assert ET.parse(path).getroot().tag.endswith("svg")
        else:
            assert path.read_bytes().startswith(b"\x89PNG")


def test_names_of_figures():
    names = ["improvement", "response-J1", "response-J3", "response-J5"]
    assert [figure.name for figure in study_figures(designs())] == names
    assert [figure.name for figure in study_figures(designs(["S1"], baseline=""))] == names[1:]
    assert [figure.name for figure in study_figures(sweep())] == [
        f"{kind}-{index}" for index in ("J1", "J3", "J5") for kind in ("sweep", "parameters")
    ]


def test_methods_differ_by_line_and_layouts_by_colour():
    with style_context():
        (figure,) = [f for f in study_figures(judged(sweep(), METHODS)) if f.name == "sweep-J1"]
        drawn = figure.draw()
        assert figure.caption.endswith("Bands: one standard error to both sides.")
    left, right = drawn.axes
    words = [f"by {brief_words_of(method)}" for method in METHODS]
    assert [text.get_text() for text in drawn.legends[0].get_texts()] == ["S1 (baseline)", "S2", "S3", *words]
    curves = [line for line in left.lines if len(line.get_xdata())]
    assert len(curves) == 3 * len(METHODS)
    assert {line.get_linestyle() for line in curves} == {"-", "--", "-."}  # of dotted lines matplotlib says "--" too
    assert len({to_hex(line.get_color()) for line in curves}) == 3
    assert len(right.collections) == 2 * 3  # a band for every layout and every method that scatters


def test_error_bars_stand_where_there_is_an_error():
    with style_context():
        bars = improvement_bars(judged(designs(), ["expected-value"]), new_figure(height=3.0)[1][0])
        plain = improvement_bars(designs(), new_figure(height=3.0)[1][0])
    assert (len(bars.collections), len(plain.collections)) == (2, 0)
    names = [figure.name for figure in study_figures(judged(designs()))]
    assert names[:2] == ["improvement", "methods"]


@pytest.mark.parametrize("name", sampled(["designs", "sweep"], seldom=["sweep"]))
def test_the_same_results_give_the_same_bytes(name, tmp_path):
    results = CASES[name]
    first, second = draw_study(results, tmp_path / "1"), draw_study(results.copy(deep=True), tmp_path / "2")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


@pytest.mark.parametrize("name", sampled(CASES, ["a much worse layout"], LESS, kept=1))
def test_nothing_runs_over_the_edge_or_over_the_legend(name):
    for drawn in study_figures(CASES[name]):
        with style_context():
            figure = drawn.draw()
            figure.draw_without_rendering()
        assert len(figure.legends) == any(ax.get_legend_handles_labels()[1] for ax in figure.axes)
        boxes = [*(ax.get_tightbbox() for ax in figure.axes), *(one.get_window_extent() for one in figure.legends)]
        for box in boxes:
            assert figure.bbox.padded(2.0).count_contains([box.min, box.max]) == 2, drawn.name
        for one, other in combinations(boxes, 2):
            assert not one.padded(-1.0).overlaps(other), drawn.name


@pytest.mark.parametrize("results", [designs(), designs(LONG), CASES["a much worse layout"]])
def test_numbers_at_bars_do_not_overlap(results):
    with style_context():
        figure = study_figures(results)[0].draw()
        figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts]
    assert not any(one.padded(-0.5).overlaps(other) for one, other in combinations(boxes, 2))


def test_settings_of_the_caller_stay(tmp_path):
    before = dict(matplotlib.rcParams)
    draw_study(designs(), tmp_path)
    assert dict(matplotlib.rcParams) == before


def test_bars_are_the_improvements():
    results = designs(["S2", "S1", "S3"])
    ax = improvement_bars(results, new_figure(height=3.0)[1][0])
    heights = {bars.get_label(): [bar.get_height() for bar in bars] for bars in ax.containers}
    assert set(heights) == {"S2", "S3"}
    for layout, drawn in heights.items():
        np.testing.assert_allclose(drawn, results["improvement"].sel(layout=layout))
    assert ax.get_xticklabels()[0].get_text() == "J1\nride comfort"
    assert lines(ax)["S1 (baseline)"].get_ydata()[0] == 0.0


def test_bars_say_what_is_not_a_number_and_what_is_cut():
    results = with_value(designs(), math.inf, UNSTABLE, layout="S2", index="J1")
    results = with_value(results, math.nan, UNSTABLE, layout="S2", index="J3")
    results = with_value(results, 4 * float(results["value"].sel(layout="S1", index="J5")), layout="S2", index="J5")
    ax = improvement_bars(results, new_figure(height=3.0)[1][0])
    assert [text.get_text() for text in ax.texts][:3] == ["inf", "n/a", "−300.0"]
    assert min(bar.get_height() for bar in ax.containers[0]) == -100.0


def test_numbers_of_bars_have_the_digits_of_the_table():
    results = designs()
    results["improvement_bound"] = xr.full_like(results["improvement"], 1.5)
    results["improvement"].loc[{"layout": "S2"}] = [-2.46, 4.94, 13.7]
    ax = improvement_bars(results, new_figure(height=3.0)[1][0])
    assert [text.get_text() for text in ax.texts][:3] == ["−2", "5", "14"]


def test_points_of_several_methods_that_are_cut_are_marked():
    """An ordinary point at -100 % for a layout that is 300 % worse would be read as -100 %."""
    results, where = judged(designs()), {"index": "J5", "method": "norm"}
    results["value"].loc[{"layout": "S2", **where}] = 4.0 * results["value"].loc[{"layout": "S1", **where}]
    results = improved(results)
    shown = {figure.name: figure for figure in study_figures(results)}["methods"]
    points = [line for line in shown.draw().axes[2].lines if -100.0 in line.get_ydata()]
    assert [line.get_marker() for line in points] == ["v"]
    assert np.count_nonzero(np.isfinite(points[0].get_ydata())) == 1
    assert shown.caption.endswith("Triangles: below -100 %.")
    assert "Triangles" not in {figure.name: figure for figure in study_figures(judged(designs()))}["methods"].caption


def test_frequency_responses_are_gains_over_hertz_with_the_baseline_black_and_dashed():
    results = designs()
    axes = frequency_responses(results, "J1", new_figure(2, 2, height=3.0)[1])
    for ax, output in zip(axes, results["output_J1"].values, strict=True):
        baseline = lines(ax)["S1 (baseline)"]
        np.testing.assert_allclose(baseline.get_xdata(), results["omega"] / (2 * np.pi))
        np.testing.assert_allclose(baseline.get_ydata(), results["gain_J1"].sel(layout="S1", output_J1=output))
        assert (to_hex(baseline.get_color()), baseline.get_linestyle()) == ("#000000", "--")
        assert ax.get_xlabel() == "Frequency [Hz]"
        assert "(m/s²)/(m/s)" in ax.get_ylabel()
        peaks = [line.get_ydata().max() for line in lines(ax).values()]
        assert ax.get_ylim()[0] < min(peaks) < max(peaks) < ax.get_ylim()[1]


def test_sweep_curves_run_in_the_order_of_the_swept_values_and_in_a_handy_unit():
    results = sweep(stiffness=[200e3, 10e3, 120e3])
    left, right = sweep_curves(results, "J1", new_figure(2, 2, height=3.0)[1])
    curve = lines(left)["S2"]
    np.testing.assert_allclose(curve.get_xdata(), [10.0, 120.0, 200.0])
    np.testing.assert_allclose(curve.get_ydata(), results["value"].sel(layout="S2", index="J1").sortby("k"))
    assert left.get_xlabel() == right.get_xlabel() == "k [kN/m]"
    assert left.get_ylabel() == "Ride comfort J1 [m/s²]"
    assert set(lines(right)) == {"S1 (baseline)", "S2", "S3"}


@pytest.mark.parametrize(("low", "high"), [(1.8, 900.0), (0.02, 9.9), (2.0, 1.9e3), (3.0, 300.0), (0.5, 2e4)])
def test_a_logarithmic_axis_has_three_labels_or_more(low, high):
    _, (ax,) = new_figure(1, 1, height=3.0)
    ax.plot([low, high], [low, high])
    ax.set_ylim(low, high)
    log_axis(ax, "y")
    shown = [tick for minor in (False, True) for tick in ax.yaxis.get_ticklabels(minor=minor) if tick.get_text()]
    assert len([tick for tick in shown if low <= tick.get_position()[1] <= high]) >= 3


def test_parameters_at_a_bound_have_open_markers():
    damping, inertance = parameter_curves(sweep(), "J1", new_figure(2, 2, height=3.0)[1])
    open_markers = [line for line in inertance.lines if line.get_markerfacecolor() == "white" and len(line.get_xdata())]
    assert [line.get_xdata().tolist() for line in open_markers] == [[300.0]]
    assert "S1 (baseline)" in lines(damping)
    assert "S1 (baseline)" not in lines(inertance)
    assert inertance.get_yscale() == "log"


def test_ten_layouts_look_different():
    left, _ = sweep_curves(sweep(LONG), "J1", new_figure(2, 2, height=3.0)[1])
    looks = {(to_hex(line.get_color()), line.get_linestyle(), line.get_marker()) for line in left.lines}
    assert len(looks) == len(LONG)


def test_curves_over_a_sweep_need_one():
    with pytest.raises(StudyError, match="without a sweep"):
        sweep_curves(designs(), "J1", new_figure(2, 2, height=3.0)[1])
