"""`simulate`, `simulate_many` and trajectories as a user meets them."""

from __future__ import annotations

import shutil
import subprocess
import sys
import textwrap
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from pathlib import Path

import numba
import numpy as np
import pytest
from scipy.io import loadmat
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter.errors import SimulationError
from inerter.kernels import compiler
from inerter.kernels.flow import first_root, over_columns


def screw(friction: float = 10.0, gap: float | None = None) -> it.networks.elements.Network:
    shaft = it.Spring(1e6, name="ks") | it.Damper(3200, name="cs")
    inerter = it.Inerter(328.72) | it.Friction(friction, name="friction")
    return shaft - inerter if gap is None else shaft - it.Gap(gap, name="gap") - inerter


def quarter_car(friction: float = 10.0, gap: float | None = None) -> it.QuarterCar:
    return it.QuarterCar(
        181.75, 25, 120e3, it.Spring(120e3, name="k") | it.Damper(7353, name="c") - screw(friction, gap)
    )


def half_car(front, rear) -> it.HalfCar:
    return paper_half_car(front, rear)


def test_the_lines_of_the_readme_of_issue_and_docs():
    signal = it.multisine(ROAD, seed=0)
    run = it.simulate(quarter_car(), road=signal, duration=1.0, step=2e-4)
    assert run.time[-1] == pytest.approx(1.0)
    assert run.status.ok
    assert run.energy is None
    given = it.Signal.sampled([0.0, 0.5, 1.0], [0.0, 1e-3, 0.0], hold="linear")
    rig = it.Rig(device=(it.Spring(1e6) | it.Damper(3200)) - it.Gap(1e-4) - (it.Inerter(113) | it.Friction(10)))
    for moved in (given, it.cosine(amplitude=1e-3, frequency=3.0)):
        force = it.simulate(rig, displacement=moved, duration=1.0, step=1e-4)["force"]
        assert force.shape == (10001,)
        assert np.all(np.isfinite(force))


def test_forces_and_motions_of_one_run_obey_newton():
    """What is asked for by name hangs together, whatever mode an element is in."""
    run = it.simulate(quarter_car(80.0, 1e-4), road=it.multisine(ROAD, seed=3), duration=2.0)
    assert {e.element for e in run.events} == {"friction", "gap"}
    np.testing.assert_allclose(181.75 * run["sprung_acceleration"], -run["strut_force"], atol=1e-9)
    np.testing.assert_allclose(25 * run["unsprung_acceleration"], run["strut_force"] - run["tyre_load"], atol=1e-7)
    np.testing.assert_allclose(run["k_force"] + run["c_force"], run["strut_force"], atol=1e-8)
    np.testing.assert_allclose(run["gap_force"], run["c_force"], atol=1e-8)
    np.testing.assert_allclose(run["b_force"] + run["friction_force"], run["gap_force"], atol=1e-8)
    np.testing.assert_allclose(
        run["sprung_displacement"] - run["unsprung_displacement"], run["strut_travel"], atol=1e-15
    )
    np.testing.assert_allclose(run["tyre_load"], 120e3 * (run["unsprung_displacement"] - run["road"]), atol=1e-8)
    assert np.abs(run["friction_force"]).max() <= 80.0 * (1 + 1e-12)


def test_velocities_are_the_slopes_of_displacements():
    run = it.simulate(quarter_car(), road=it.multisine(ROAD, seed=1, highest=100.0), duration=1.0, step=1e-4)
    slope = (run["sprung_displacement"][2:] - run["sprung_displacement"][:-2]) / 2e-4
    np.testing.assert_allclose(slope, run["sprung_velocity"][1:-1], atol=1e-5 * np.abs(slope).max())


def test_the_rear_wheel_meets_the_road_later():
    strut = it.Spring(60e3) | it.Damper(2000) | it.Friction(50)
    run = it.simulate(half_car(strut, strut), road=it.multisine(ROAD, seed=2), duration=1.0)
    late = round(2.04 / 25 / 2e-4)
    np.testing.assert_allclose(run["road_rear"][late:], run["road_front"][:-late], atol=1e-12)


def test_a_run_in_two_parts_is_the_run():
    """Going on from a trajectory, with nothing lost between."""
    signal = it.multisine(ROAD, seed=5)
    whole = it.simulate(quarter_car(100.0, 5e-5), road=signal, duration=2.0)
    first = it.simulate(quarter_car(100.0, 5e-5), road=signal, duration=1.0)
    second = it.simulate(quarter_car(100.0, 5e-5), road=signal, duration=1.0, initial=first)
    assert second.time[0] == pytest.approx(1.0)
    np.testing.assert_allclose(
        second["sprung_velocity"], whole["sprung_velocity"][5000:], atol=1e-12 * whole.rms("sprung_velocity")
    )
    assert [e.element for e in first.events + second.events] == [e.element for e in whole.events]


def test_time_stepping_goes_on_from_its_last_sample():
    """Also where the samples do not reach the end of the run: 1000 steps, every seventh kept."""
    signal, car = it.multisine(ROAD, seed=5, highest=100.0), quarter_car(100.0)
    kept = it.simulate(car, road=signal, duration=0.1, step=1e-4, every=7, integrator="time-stepping")
    whole = it.simulate(car, road=signal, duration=0.0994, step=1e-4, integrator="time-stepping")
    assert kept.end == pytest.approx(0.0994)
    np.testing.assert_allclose(kept.final_state, whole.final_state, rtol=1e-9, atol=1e-12)


def test_a_periodic_steady_state_repeats():
    car, signal = quarter_car(100.0), it.sine(amplitude=5e-3, frequency=2.0)
    steady = it.simulate(car, road=signal, initial="periodic", energy=True)
    assert steady.repetition.mismatch < 1e-9
    assert steady.repetition.period == pytest.approx(0.5)
    assert abs(steady.energy.stored) < 1e-8 * steady.energy.input_work
    again = it.simulate(car, road=signal, duration=0.5, initial=steady)
    np.testing.assert_allclose(again["tyre_load"], steady["tyre_load"], atol=1e-7 * steady.rms("tyre_load"))
    settled = it.simulate(car, road=signal, duration=10.0)
    np.testing.assert_allclose(settled["tyre_load"][-2501:], steady["tyre_load"], atol=1e-7 * steady.rms("tyre_load"))


def test_a_periodic_steady_state_of_a_held_signal_repeats():
    noise = it.held_noise(seed=1, power=1e-8, interval=1e-3, duration=1.0)
    steady = it.simulate(quarter_car(50.0), road=noise, initial="periodic")
    long = it.simulate(quarter_car(50.0), road=noise, duration=8.0)
    # the last sample of a period is taken before the jump that begins the next
    np.testing.assert_allclose(
        steady["sprung_velocity"][:-1], long["sprung_velocity"][-5001:-1], atol=1e-8 * long.rms("sprung_velocity")
    )
    np.testing.assert_allclose(steady["tyre_load"][:-1], long["tyre_load"][-5001:-1], atol=1e-6 * long.rms("tyre_load"))


@pytest.mark.parametrize("initial", ["periodic", "rest"])
def test_both_ends_of_a_period_count_once_in_its_rms(initial):
    """A damper has its largest force at both ends of a period where a sine moves it, and none there with a cosine."""
    for motion in (it.sine(0.01, 1.0), it.cosine(0.01, 1.0)):
        run = it.simulate(it.Rig(it.Damper(100.0)), displacement=motion, initial=initial, duration=1.0, step=2e-3)
        assert run.rms("device_force") == pytest.approx(100.0 * 0.01 * 2.0 * np.pi / np.sqrt(2.0), rel=1e-9)


def test_the_rms_of_a_ramp_is_that_over_its_time():
    ramp = it.Signal.sampled([0.0, 1.0], [0.0, 0.03], "linear")
    run = it.simulate(it.Rig(it.Spring(1e4)), displacement=ramp, duration=1.0, step=2e-3)
    assert run.rms("device_force") == pytest.approx(300.0 / np.sqrt(3.0), rel=1e-6)


def test_preload_is_where_a_constant_force_leaves_everything_at_rest():
    """A spring behind a gap: the load closes the gap, and the deflection is that of both springs."""
    car = it.QuarterCar(200.0, 30.0, 150e3, it.Damper(1500.0) | (it.Spring(40e3, name="k") - it.Gap(2e-3, name="gap")))
    weight = it.step(height=-2000.0)
    run = it.simulate(car, forces={"sprung_force": weight}, initial="preload", duration=0.5)
    assert run.states == {"gap": "lower contact"}
    assert run.events == ()
    np.testing.assert_allclose(run["sprung_displacement"], -2000.0 / 40e3 - 2e-3 - 2000.0 / 150e3, rtol=1e-9)
    np.testing.assert_allclose(run["sprung_velocity"], 0.0, atol=1e-12)
    np.testing.assert_allclose(run["gap_force"], -2000.0, rtol=1e-9)
    loose = it.QuarterCar(200.0, 30.0, 150e3, it.Damper(1500.0))
    with pytest.raises(SimulationError, match="not carried by springs"):
        it.simulate(loose, forces={"sprung_force": weight}, initial="preload", duration=0.5)


def test_rest_is_unstrained_over_a_road_that_is_not_level():
    strut = it.Spring(60e3) | it.Damper(2000)
    roads = {"road_front": it.step(height=0.02), "road_rear": it.step(height=-0.01)}
    run = it.simulate(half_car(strut, strut), road=roads, duration=0.1)
    for name in ("tyre_front_load", "tyre_rear_load", "front_force", "rear_force"):
        np.testing.assert_allclose(run[name], 0.0, atol=1e-8)
    np.testing.assert_allclose(run["pitch_displacement"], 0.03 / 2.04, rtol=1e-9)


@pytest.mark.campaign
def test_mean_squares_of_a_batch_are_those_of_single_runs():
    cars = [quarter_car(f, gap) for f, gap in ((0.0, None), (50.0, None), (20.0, 1e-4))]
    noise = it.held_noise(seed=4, power=1e-8, duration=1.0)
    signals = [it.multisine(ROAD, seed=0), it.multisine(ROAD, seed=1), noise]
    outputs = ["sprung_acceleration", "tyre_load", "friction_force"]
    batch = it.simulate_many(cars, road=signals, outputs=outputs, duration=1.0, discard=0.4, jobs=2)
    assert batch.rms.shape == (3, 3, 3)
    for i, car in enumerate(cars):
        for j, signal in enumerate(signals):
            run = it.simulate(car, road=signal, duration=1.0)
            for o, name in enumerate(outputs):
                expected = np.sqrt(np.mean(run[name][2001:] ** 2))
                assert batch.rms[i, j, o] == pytest.approx(expected, rel=1e-11, abs=1e-300)
            assert batch.events[i, j] == len(run.events)
            assert batch.status[i][j].ok
    alone = it.simulate_many(cars, road=signals, outputs=outputs, duration=1.0, discard=0.4, jobs=1)
    np.testing.assert_array_equal(alone.mean_square, batch.mean_square)
    data = batch.to_xarray()
    assert data["tyre_load"].attrs["units"] == "N"
    assert data.sizes == {"design": 3, "signal": 3}


def test_a_trajectory_goes_to_files_and_back(tmp_path):
    run = it.simulate(quarter_car(50.0, 1e-4), road=it.multisine(ROAD, seed=0), duration=0.2, energy=True)
    names = ["sprung_acceleration", "gap_force"]
    run.to_csv(tmp_path / "run.csv", names)
    header, *_ = (tmp_path / "run.csv").read_text().splitlines()
    assert header == "time [s],sprung_acceleration [m/s^2],gap_force [N]"
    read = np.loadtxt(tmp_path / "run.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(read[:, 1], run["sprung_acceleration"])
    run.events_to_csv(tmp_path / "events.csv")
    assert len((tmp_path / "events.csv").read_text().splitlines()) == 1 + len(run.events)
    run.to_mat(tmp_path / "run.mat", names)
    mat = loadmat(tmp_path / "run.mat", squeeze_me=True)
    np.testing.assert_array_equal(mat["gap_force"], run["gap_force"])
    assert mat["units"]["gap_force"].item() == "N"
    assert list(mat["events"]["element"].item()) == [e.element for e in run.events]
    data = run.to_xarray()
    assert set(run.outputs) == set(data.data_vars)
    assert data["strut_travel"].attrs == {"units": "m", "long_name": "strut travel"}
    with pytest.raises(SimulationError, match="Cannot write"):
        run.to_csv(tmp_path / "not" / "there.csv")


def test_intervals_tile_the_run():
    run = it.simulate(quarter_car(100.0, 1e-4), road=it.multisine(ROAD, seed=0), duration=2.0)
    for element, states in (
        ("friction", ("slip up", "stick", "slip down")),
        ("gap", ("upper contact", "open", "lower contact")),
    ):
        parts = sorted(part for state in states for part in run.intervals(element, state))
        assert parts[0][0] == 0.0
        assert parts[-1][1] == pytest.approx(2.0)
        assert all(a[1] == pytest.approx(b[0], abs=1e-12) for a, b in pairwise(parts))
    with pytest.raises(SimulationError, match="Unknown friction or gap 'b'"):
        run.intervals("b", "stick")


def test_an_output_that_is_not_there_is_named_with_what_is_close():
    run = it.simulate(quarter_car(), road=it.sine(1e-3, 1.0), duration=0.01)
    with pytest.raises(SimulationError, match="Did you mean sprung_acceleration"):
        run["sprung_aceleration"]


def test_a_road_too_large_to_compute_with_is_refused():
    car = paper_quarter_car(it.Spring(120e3) | it.Friction(1.0))
    for size in (1e101, 1e160, 1e300):
        with pytest.raises(SimulationError, match="too large to compute with"):
            it.simulate(car, road=it.sine(amplitude=size, frequency=1.0), duration=0.1)
    assert it.simulate(car, road=it.sine(amplitude=1e90, frequency=1.0), duration=0.1).status.ok


def test_what_is_far_faster_than_the_step_is_told_and_not_waited_for():
    device = it.Damper(2e5) - it.Gap(1e-5) - it.Inerter(0.011)
    run = it.simulate(it.Rig(device), displacement=it.cosine(1e-3, 3.0), duration=1.0, step=5e-3)
    assert not run.status.ok
    assert "10 000 times faster than the step" in run.status.message
    assert "s c relax in 0.055 us" in run.status.message  # 0.011 kg over 2e5 N s/m
    assert run.time[-1] < 1.0
    assert run["device_force"].shape == run.time.shape


@pytest.mark.campaign
def test_a_changed_kernel_is_compiled_again(tmp_path):
    """A copy of the package whose flow kernel is changed must not run what the cache holds of the original."""
    probe = textwrap.dedent(
        """
        from inerter.kernels.decorators import kernel
        from inerter.kernels.flow import first_root, value_at

        @kernel("probe", "UniTuple(float64, 2)(float64[::1], float64[::1], float64[::1])")
        def probe(line, falling, ends):
            return value_at(line, 2, 2.0), first_root(falling, 2, ends)
        """
    )
    program = textwrap.dedent(
        """
        import numpy as np
        from inerter.kernels.probe import probe
        print(*probe(np.array([2.0, 3.0]), np.array([1.0, -2.0]), np.zeros(64)))
        """
    )
    shutil.copytree(Path(it.__file__).parent, tmp_path / "inerter", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "inerter" / "kernels" / "probe.py").write_text(probe)
    environment = {"PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache"), "HOME": str(tmp_path)}

    def said() -> tuple[float, float]:
        command = [sys.executable, "-c", program]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        value, root = map(float, done.stdout.split())
        return value, root

    assert said() == pytest.approx((8.0, 0.5))
    flow = tmp_path / "inerter" / "kernels" / "flow.py"
    text = flow.read_text()
    changed = text.replace("total = c[count - 1]", "total = c[count - 1] - 1.0", 1)
    assert changed != text
    flow.write_text(changed)
    assert said()[0] == 6.0


def test_a_part_of_compiled_code_is_plain_python_elsewhere():
    assert first_root(np.array([1.0, -2.0]), 2, np.zeros(64)) == pytest.approx(0.5)


def test_threads_that_compile_at_once_do_not_see_each_others_settings(monkeypatch):
    """The compiler's settings, such as where it keeps its files, belong to the whole process."""
    kept = []

    def slow(**options):
        def compiler(function):
            folder = numba.config.CACHE_DIR
            time.sleep(0.02)
            kept.append(folder != "" and folder == numba.config.CACHE_DIR)
            return function

        return compiler

    before = numba.config.CACHE_DIR
    monkeypatch.setattr(numba, "njit", slow)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(compiler.compile_function, [first_root.function, over_columns.function] * 4))
    assert kept == [True] * 8
    assert before == numba.config.CACHE_DIR
