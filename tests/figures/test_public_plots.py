"""What the plots draw are the numbers: read from their lines, against closed forms and SciPy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.signal
import xarray as xr
from matplotlib.lines import Line2D
from study_text import study_text
from wang_su import J1, ROAD

import inerter as it

MASS, WHEEL, TYRE, K, C = 250.0, 35.0, 150e3, 60e3, 2e3
STRUT = it.Spring(K) | it.Damper(C)
CAR = it.QuarterCar(MASS, WHEEL, TYRE, STRUT)


def body_over_road(s: np.ndarray) -> np.ndarray:
    """Displacement of the body over that of the road, by hand."""
    strut = K + C * s
    return strut * TYRE / ((MASS * s**2 + strut) * (WHEEL * s**2 + strut + TYRE) - strut**2)


def test_bode_is_the_closed_form() -> None:
    gain, phase = it.plot_bode(CAR, ("road", "sprung_acceleration"))
    frequency, drawn = gain.lines[0].get_data()
    s = 2j * np.pi * np.asarray(frequency)
    expected = s * body_over_road(s)  # acceleration over velocity
    np.testing.assert_allclose(drawn, np.abs(expected), rtol=1e-9)
    angle = np.deg2rad(phase.lines[0].get_ydata())
    np.testing.assert_allclose(np.exp(1j * angle), expected / np.abs(expected), rtol=0, atol=1e-8)


def _unbroken(line: Line2D) -> np.ndarray:
    """Phases of a line without the points where it leaves at one edge and continues at the other."""
    angle = np.asarray(line.get_ydata())
    breaks = np.flatnonzero(np.isnan(angle))
    return np.delete(angle, np.concatenate([breaks - 1, breaks, breaks + 1]))


def test_the_phase_of_delays_is_within_half_a_turn() -> None:
    """The wheelbase delay of a half car turns it many times: by -4700 degrees if it were unwrapped."""
    strut = it.Spring(K) | it.Damper(C)
    car = it.HalfCar(
        sprung_mass=500.0,
        pitch_inertia=1200.0,
        unsprung_mass_front=40.0,
        unsprung_mass_rear=35.0,
        tyre_stiffness_front=TYRE,
        tyre_stiffness_rear=TYRE,
        distance_front=1.2,
        distance_rear=1.4,
        front=strut,
        rear=strut,
    )
    gain, phase = it.plot_bode(car, it.RideComfort(ROAD))
    labels = [text.get_text() for text in gain.figure.legends[0].get_texts()]
    assert labels == ["sprung acceleration", "pitch acceleration x 1.3 m"]  # the unit of the axis is that of both
    for output, weight, line in zip(("sprung_acceleration", "pitch_acceleration"), (1.0, 1.3), gain.lines, strict=True):
        hertz = np.asarray(line.get_xdata())
        delayed = [it.plot_bode(car, (road, output), frequency=hertz) for road in ("road_front", "road_rear")]
        front, rear = (
            np.asarray(one[0].lines[0].get_ydata()) * np.exp(1j * np.deg2rad(_unbroken(one[1].lines[0])))
            for one in delayed
        )
        expected = weight * np.abs(front + rear * np.exp(-2j * np.pi * hertz * 2.6 / ROAD.speed))
        np.testing.assert_allclose(line.get_ydata(), expected, rtol=1e-6, atol=1e-9 * expected.max())
    for line in phase.lines:
        frequency, angle = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        breaks = np.flatnonzero(np.isnan(angle))
        assert breaks.size > 2
        assert np.nanmax(np.abs(angle)) <= 180.0
        np.testing.assert_allclose(angle[breaks - 1], -angle[breaks + 1])
        np.testing.assert_allclose(np.abs(angle[breaks - 1]), 180.0)
        assert np.nanmax(np.abs(np.diff(angle))) <= 180.0  # no line across the plot
        assert np.all(np.diff(frequency) >= 0.0)


def test_bode_of_an_index_is_that_of_its_response() -> None:
    road = ROAD
    by_index = it.plot_bode(CAR, it.RideComfort(road))[0].lines[0].get_data()
    by_names = it.plot_bode(CAR, ("road", "sprung_acceleration"))[0].lines[0].get_data()
    np.testing.assert_allclose(by_index, by_names, rtol=1e-12)


def test_a_response_to_a_force_has_the_unit_of_its_index() -> None:
    gain, _ = it.plot_bode(CAR, it.LoadCarrying())
    assert gain.get_ylabel().endswith("[m/N]")


def test_several_designs_have_a_legend_and_the_axes_given() -> None:
    from matplotlib.figure import Figure  # noqa: PLC0415

    axes = Figure().subplots(2)
    found = it.plot_bode({"S1": CAR, "stiff": it.QuarterCar(MASS, WHEEL, TYRE, it.Spring(2 * K) | it.Damper(C))},
                         ("road", "tyre_load"), frequency=[1.0, 2.0, 5.0], axes=axes)  # fmt: skip
    assert found == tuple(axes)
    assert [text.get_text() for text in axes[0].get_legend().get_texts()] == ["S1", "stiff"]
    assert [line.get_xdata().tolist() for line in axes[0].lines] == [[1.0, 2.0, 5.0]] * 2


def test_nyquist_is_the_closed_form() -> None:
    ax = it.plot_nyquist(CAR, ("road", "sprung_velocity"), frequency=[1.0, 3.0])
    s = 2j * np.pi * np.array([1.0, 3.0])
    real, imaginary = ax.lines[0].get_data()
    np.testing.assert_allclose(real + 1j * np.asarray(imaginary), body_over_road(s), rtol=1e-9)


def test_poles_are_the_roots_of_the_closed_form() -> None:
    ax = it.plot_poles(CAR)
    real, imaginary = ax.lines[0].get_data()
    strut = np.poly1d([C, K])
    roots = ((np.poly1d([MASS, 0, 0]) + strut) * (np.poly1d([WHEEL, 0, 0]) + strut + TYRE) - strut * strut).roots
    np.testing.assert_allclose(np.sort_complex(real + 1j * imaginary), np.sort_complex(roots), rtol=1e-8)


def test_step_response_is_that_of_scipy() -> None:
    time, drawn = it.plot_step_response(CAR, ("road", "sprung_displacement")).lines[0].get_data()
    strut = np.poly1d([C, K])
    below = (np.poly1d([MASS, 0, 0]) + strut) * (np.poly1d([WHEEL, 0, 0]) + strut + TYRE) - strut * strut
    _, expected = scipy.signal.step(((TYRE * strut).coeffs, below.coeffs), T=time)
    np.testing.assert_allclose(drawn, expected, atol=1e-6)
    force = it.plot_step_response(CAR, ("sprung_force", "sprung_displacement"), duration=10.0).lines[0].get_ydata()
    assert force[-1] == pytest.approx(1.0 / K + 1.0 / TYRE, rel=1e-6)


def test_the_label_of_a_step_response_fits_and_has_no_raw_power() -> None:
    ax = it.plot_step_response(CAR, ("road", "sprung_acceleration"))
    ax.figure.draw_without_rendering()
    assert ax.get_ylabel().endswith("[(m/s²)/m]")
    box = ax.yaxis.label.get_window_extent()
    assert 0.0 <= box.y0 < box.y1 <= ax.figure.bbox.height


def test_an_impulse_is_refused() -> None:
    """A damper in a tyre gives its load an impulse where the road steps."""
    mass = it.Mechanism(
        coordinates=(it.Coordinate("mass", 10.0),),
        struts=(),
        tyres=(it.Tyre("tyre", it.Spring(1e3) | it.Damper(5.0), {"mass": 1.0}, "road"),),
        roads=(it.RoadInput("road"),),
    )
    with pytest.raises(it.InerterError, match="impulse"):
        it.plot_step_response(mass, ("road", "tyre_load"))


def test_admittance_is_the_formula() -> None:
    gain, phase = it.plot_admittance(it.Spring(K) | it.Damper(C) - it.Inerter(100.0))
    frequency, drawn = gain.lines[0].get_data()
    s = 2j * np.pi * np.asarray(frequency)
    expected = K / s + 1.0 / (1.0 / C + 1.0 / (100.0 * s))
    np.testing.assert_allclose(drawn, np.abs(expected), rtol=1e-12)
    np.testing.assert_allclose(phase.lines[0].get_ydata(), np.angle(expected, deg=True), atol=1e-9)


def test_motions_are_drawn_with_what_sticks() -> None:
    device = it.Spring(K) | it.Damper(C) | (it.Inerter(50.0) | it.Friction(40.0, name="f"))
    run = it.simulate(it.QuarterCar(MASS, WHEEL, TYRE, device), road=it.cosine(2e-3, 2.0), duration=3.0)
    (ax,) = it.plot_trajectory(run, "sprung_displacement", window=(1.0, 2.0))
    time, drawn = ax.lines[0].get_data()
    inside = (run.time >= 1.0) & (run.time <= 2.0)
    np.testing.assert_array_equal(time, run.time[inside])
    np.testing.assert_allclose(drawn, 1000.0 * run["sprung_displacement"][inside], rtol=1e-12)
    assert "[mm]" in ax.get_ylabel()
    sticks = [one for one in run.intervals("f", "stick") if one[0] < 2.0 and one[1] > 1.0]
    assert len(ax.patches) == len(sticks) > 0
    for patch, (begin, end) in zip(ax.patches, sticks, strict=True):
        assert (patch.get_x(), patch.get_x() + patch.get_width()) == pytest.approx((begin, end))
    loop = it.plot_loop(run, "strut_travel", "strut_force")
    np.testing.assert_allclose(loop.lines[0].get_ydata(), run["strut_force"], rtol=1e-12)


def test_what_cannot_be_drawn_is_said() -> None:
    run = it.simulate(CAR, road=it.cosine(2e-3, 2.0), duration=0.5)
    free = it.QuarterCar(MASS, WHEEL, TYRE, it.Spring(K) | it.Damper(it.free(1e2, 1e4, name="c")))
    for call, words in (
        (lambda: it.plot_trajectory(run, "nothing"), "nothing"),
        (lambda: it.plot_trajectory(run, "tyre_load", window=(5.0, 6.0)), "from 5 to 6 s"),
        (lambda: it.plot_trajectory(run, []), "needs outputs"),
        (lambda: it.plot_bode({}, ("road", "tyre_load")), "at least one"),
        (lambda: it.plot_bode(STRUT, ("road", "tyre_load")), "Expected a vehicle"),
        (lambda: it.plot_bode(free, it.LoadCarrying()), "still has free values: c"),
        (lambda: it.plot_bode(CAR, ("road", "nothing")), "nothing"),
        (lambda: it.plot_bode(CAR, ("road", "tyre_load"), frequency=[-1.0]), "positive numbers of Hz"),
        (lambda: it.plot_admittance({}), "Expected an element"),
    ):
        with pytest.raises(it.InerterError, match=words):
            call()


def test_a_response_to_several_sources_has_no_phase() -> None:
    """Two tracks with a coherence are two sources: the gain from one of them alone would be wrong."""
    road = it.Road(roughness=5e-7, speed=25.0, coherence=it.Coherence.first_order(wavenumber=0.2))
    car = it.FullCar(1400, 2400, 520, 45, 40, 220e3, 220e3, 1.2, 1.5, 1.5, 1.5, STRUT, STRUT)
    with pytest.raises(it.InerterError, match="Several independent sources"):
        it.plot_bode(car, it.RideComfort(road))
    inputs = it.state_space(car).inputs
    gain, _ = it.plot_bode(car, (inputs[0], "roll_acceleration"))
    assert len(gain.lines) == 1


STUDY = study_text(
    'indices = ["J1"]\nevaluate = ["norm"]\nbaseline = "S1"', elements='k = "60 kN/m"\nc = "2 kN s/m"\nb = "50 kg"'
)


def swept(folder: Path, line: str) -> xr.Dataset:
    (folder / "study.toml").write_text(f"{STUDY}{line}\n", encoding="utf-8")
    return it.run_study(it.load_study(folder / "study.toml"), folder / "results").data


def test_a_sweep_draws_what_is_evaluated(tmp_path: Path) -> None:
    results = swept(tmp_path, 'sweep = { c = ["1 kN s/m", "2 kN s/m", "4 kN s/m"] }')
    left, right = it.plot_sweep(results, "J1")
    comfort = J1

    def value(c: float, *more: it.Network) -> float:
        strut = it.Spring(K) | it.Damper(c)
        for part in more:
            strut = strut | part
        return it.evaluate(it.QuarterCar(MASS, WHEEL, TYRE, strut), comfort, it.Norm()).value

    plain = np.array([value(c) for c in (1e3, 2e3, 4e3)])
    with_inerter = np.array([value(c, it.Inerter(50.0)) for c in (1e3, 2e3, 4e3)])
    labels = [line.get_label() for line in left.lines]
    assert labels == ["S1 (baseline)", "S2"], labels
    drawn = {line.get_label().split()[0]: line.get_ydata() for line in left.lines}
    np.testing.assert_allclose(drawn["S1"], plain, rtol=1e-9)
    np.testing.assert_allclose(drawn["S2"], with_inerter, rtol=1e-9)
    better = next(line.get_ydata() for line in right.lines if line.get_label() == "S2")
    np.testing.assert_allclose(better, 100.0 * (1.0 - with_inerter / plain), rtol=1e-6)
    for wrong in (lambda: it.plot_map(results, "J1"), lambda: it.plot_sweep(results, "J3"),
                  lambda: it.plot_sweep(results, "J1", axes=[left])):  # fmt: skip
        with pytest.raises(it.InerterError, match=r"two swept numbers, got 1|no index 'J3', but J1|need 2 axes, got 1"):
            wrong()


def test_a_map_has_axes_for_each_layout(tmp_path: Path) -> None:
    line = 'sweep = { c = ["1 kN s/m", "2 kN s/m", "4 kN s/m"], k = ["40 kN/m", "80 kN/m"] }'
    results = swept(tmp_path, line)
    first, second = it.plot_map(results, "J1")
    assert (first.get_title(), second.get_title()) == ("S1 (baseline)", "S2")
    assert first.get_xlabel().replace("\u00a0", " ") == "c [kN s/m]"
    assert first.get_ylabel() == "k [kN/m]"
    dots = {(x, y) for line in second.lines for x, y in zip(*line.get_data(), strict=True)}
    assert dots == {(c, k) for c in (1.0, 2.0, 4.0) for k in (40.0, 80.0)}
    with pytest.raises(it.InerterError, match="one swept number, got 2"):
        it.plot_sweep(results, "J1")


@pytest.mark.parametrize("plot", ["bode", "nyquist", "poles", "step_response", "admittance"])
def test_a_legend_covers_no_curve(plot: str) -> None:
    struts = {f"damping of {c} N s/m": it.Spring(K) | it.Damper(c) for c in range(100, 900, 100)}
    designs = {name: it.QuarterCar(MASS, WHEEL, TYRE, strut) for name, strut in struts.items()}
    drawn = {
        "bode": lambda: it.plot_bode(designs, ("road", "tyre_load"))[0],
        "nyquist": lambda: it.plot_nyquist(designs, ("road", "tyre_load")),
        "poles": lambda: it.plot_poles(designs),
        "step_response": lambda: it.plot_step_response(designs, ("road", "tyre_load")),
        "admittance": lambda: it.plot_admittance(struts)[0],
    }[plot]()
    figure = drawn.figure
    figure.draw_without_rendering()
    (legend,) = figure.legends
    for ax in figure.axes:
        assert ax.get_legend() is None
        assert not ax.get_tightbbox().padded(-1.0).overlaps(legend.get_window_extent())
