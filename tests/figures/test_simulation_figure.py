"""The figure of a simulation: it shows the numbers and the intervals, and nothing runs over anything else."""

from dataclasses import replace
from functools import cache, partial
from itertools import combinations

import numpy as np
import pytest
from campaigns import sampled
from folders import EXAMPLES, example_tables
from matplotlib.colors import to_hex

from inerter.errors import StudyError
from inerter.figures.simulation import draw_simulation, panels, readable_window, simulation_figure
from inerter.figures.style import style_context
from inerter.files.common.layouts import StrutLayout
from inerter.files.common.toml import as_toml
from inerter.files.simulation.loading import load_simulation
from inerter.files.simulation.running import SimulationResult


def result(name, duration=1.0, layout=None, roughness=None, **changes):
    request = replace(load_simulation(EXAMPLES / f"{name}.toml"), duration=duration, **changes)
    if roughness is not None:
        request = replace(request, road={**request.road, "roughness": roughness})
    if layout is not None:
        request = replace(
            request,
            layouts={request.layout: StrutLayout(dict.fromkeys(request.layouts[request.layout].struts, layout))},
        )
    return SimulationResult(request, request.run())


CASES = {
    "quarter car": partial(result, "stick_slip"),
    "half car": partial(result, "half_car_friction"),
    "rig": partial(result, "backlash_rattle"),
    "nothing nonlinear": partial(result, "half_car_friction", 0.2, "k | c - b"),
    "two frictions": partial(result, "stick_slip", 1.0, "k | (c | f) - (k | f)"),
    "no inerter on the rig": partial(result, "backlash_rattle", 0.5, "(ks | cs) - g - (ks | f)"),
    "two inerters": partial(result, "half_car_friction", 0.5, "k | b | c - (b | f)"),
    "time-stepping": partial(result, "backlash_rattle", 0.1, energy=False, integrator="time-stepping"),
    "short": partial(result, "stick_slip", 4e-4),
}


@cache
def case_of(name):
    return CASES[name]()


def drawn(case, window=None):
    with style_context():
        figure = simulation_figure(case, window or readable_window(case))
        figure.draw_without_rendering()
    return figure


@cache
def figure_of(name):
    return drawn(case_of(name))


FULLEST = ["half car", "rig", "two frictions", "short"]


@pytest.mark.parametrize("name", sampled(CASES, FULLEST))
def test_nothing_runs_over_the_edge_or_over_anything_else(name):
    figure = figure_of(name)
    boxes = [ax.get_tightbbox() for ax in figure.axes] + [legend.get_window_extent() for legend in figure.legends]
    for box in boxes:
        assert figure.bbox.padded(2.0).count_contains([box.min, box.max]) == 2
    for one, other in combinations(boxes, 2):
        assert not one.padded(-1.0).overlaps(other)
    for ax in figure.axes:
        assert ax.yaxis.label.get_window_extent().height <= 1.05 * ax.get_window_extent().height


@pytest.mark.parametrize("name", sampled(CASES, FULLEST))
def test_every_curve_is_in_si_units_times_the_unit_on_the_axis(name):
    case = case_of(name)
    figure = figure_of(name)
    factors = {"[m": 1.0, "[mm]": 1e3, "[N]": 1.0, "[kN]": 1e-3}
    for ax, panel in zip(figure.axes, panels(case), strict=False):
        unit = next(f for name, f in sorted(factors.items(), reverse=True) if name in ax.get_ylabel().split()[-1])
        for line, curve in zip(ax.lines, panel.curves, strict=True):
            low, high = readable_window(case)
            inside = (case.run.time >= low) & (case.run.time <= high)
            values = case.run[curve.output][inside] * curve.weight * unit
            assert line.get_ydata().min() == pytest.approx(values.min(), rel=1e-12)
            assert line.get_ydata().max() == pytest.approx(values.max(), rel=1e-12)


def test_every_interval_is_shaded_and_the_legend_says_what_it_is():
    case = case_of("quarter car")
    figure = figure_of("quarter car")
    ax = figure.axes[3]
    shaded = sorted((p.get_x(), p.get_x() + p.get_width()) for p in ax.patches)
    assert shaded == [pytest.approx(i) for i in case.run.intervals("f", "stick")]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["f sticks"]
    assert [text.get_text() for text in figure_of("rig").legends[0].get_texts()] == ["g is open", "f sticks"]


def test_an_axle_has_one_colour_everywhere():
    figure = figure_of("half car")
    road, _, tyre, front, rear = figure.axes
    for pair in ([road.lines[0], tyre.lines[0], front.lines[0]], [road.lines[1], tyre.lines[1], rear.lines[0]]):
        assert len({to_hex(line.get_color()) for line in pair}) == 1


def test_a_long_run_is_cut_to_what_can_be_read():
    low, high = readable_window(result("half_car_friction", 5.0))
    assert high == 5.0
    assert 0.0 < low < 4.9
    assert readable_window(case_of("quarter car")) == (0.0, 1.0)


def test_a_window_is_what_is_drawn():
    figure = drawn(case_of("quarter car"), (0.25, 0.5))
    for ax in figure.axes:
        assert ax.get_xlim() == (0.25, 0.5)
        assert ax.lines[0].get_xdata().min() >= 0.25
    with pytest.raises(StudyError, match="fewer than two of the samples"):
        simulation_figure(case_of("quarter car"), (7.0, 8.0))


def test_many_samples_are_drawn_as_few_points():
    long = result("backlash_rattle", 3.0, step=5e-5)
    (line,) = drawn(long, (0.0, 3.0)).axes[1].lines
    assert line.get_xdata().size <= 4000
    assert line.get_ydata().max() == long.run["device_force"].max()


@pytest.mark.campaign
def test_the_same_run_gives_the_same_bytes(tmp_path):
    first, second = (draw_simulation(case_of("rig"), tmp_path / name) for name in "12")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
    assert np.array([path.suffix in (".svg", ".png") for path in first]).all()


def test_each_tyre_that_would_lift_off_is_shaded_in_its_own_row():
    case = result("half_car_friction", 0.5, roughness=1e-4)
    offs, tyres = case.run.lift_offs, list(case.run.static_loads)
    assert {one.tyre for one in offs} == set(tyres)
    figure = drawn(case, (0.0, 0.5))
    (ax,) = [ax for ax in figure.axes if ax.get_ylabel().startswith("Tyre load")]
    spans = [patch for patch in ax.patches if "would lift off" in patch.get_label()]
    assert len(spans) == len(offs)
    for one, span in zip(offs, spans, strict=True):
        (begin, low), (end, high) = span.get_path().get_extents(span.get_patch_transform()).get_points()
        assert (begin, end) == pytest.approx((one.begin, one.end), abs=2e-9)
        assert (low, high) == ((0.5, 1.0) if one.tyre == tyres[0] else (0.0, 0.5))
        assert span.get_label().startswith(one.tyre.replace("_", " "))


@pytest.mark.parametrize("name", ["full-car", "train"])
def test_each_curve_is_called_by_what_tells_it_from_the_others(name, tmp_path):
    study = example_tables(name)
    fixed = {key: value["from"] if isinstance(value, dict) else value for key, value in study["elements"].items()}
    file = tmp_path / "simulation.toml"
    tables = {
        **{key: study[key] for key in ("vehicle", "road", "layouts")},
        "elements": fixed,
        "signal": {"kind": "sine", "amplitude": "1 mm", "frequency": "1 Hz"},
        "simulation": {"layout": "S1", "duration": "0.02 s"},
    }
    file.write_text(as_toml(tables), encoding="utf-8")
    request = load_simulation(file)
    found = panels(SimulationResult(request, request.run()))
    several = [[curve.label for curve in panel.curves] for panel in found if len(panel.curves) > 1]
    assert len(several) >= 2
    for labels in several:
        assert len({*labels}) == len(labels)
    kind = {"full-car": "road", "train": "rail"}[name]
    assert found[0].title == kind
    roads = request.design().mechanism().roads
    assert [f"{kind}_{label.replace(' ', '_')}" for label in several[0]] == [road.name for road in roads]
