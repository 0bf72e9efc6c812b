"""Equivalent dampers against a fixed point by hand, against simulation, and against networks that are locked."""

import math

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
from campaigns import sampled
from hypothesis import given, settings
from hypothesis import strategies as st
from nodal import Nodal
from strategies import elements, logarithmic, networks
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, Friction, Gap, Inerter, LoadCarrying, Norm, RideComfort, Spring, TyreLoad
from inerter import StatisticalLinearisation as Linearisation
from inerter.errors import DesignError, PerformanceIndexError
from inerter.methods.equivalent import POORLY
from inerter.methods.notes import parts_of
from inerter.networks.transform import map_elements
from inerter.norms.h2 import h2

J1, J3, J5 = RideComfort(ROAD), TyreLoad(ROAD), LoadCarrying(amplitude=1000.0)
k, c, b = Spring(120e3), Damper(4e3), Inerter(300.0)
screw = Spring(1e6) | Damper(3200.0)
METHOD = Linearisation()


def is_solved(estimate):
    """Whether the equations of the closure are solved, be they right for this design or not."""
    return estimate.status.ok or POORLY in estimate.status.message


def value(car, index, method=METHOD):
    estimate = it.evaluate(car, index, method)
    assert is_solved(estimate), estimate
    return estimate.value


def covariance(system):
    """Of the outputs, with the road's intensity, by scipy."""
    P = scipy.linalg.solve_continuous_lyapunov(system.A, -system.B @ system.B.T)
    return np.sqrt(np.diag(system.C @ P @ system.C.T)) * ROAD.velocity_intensity


def across(damper):
    """Velocity over a friction between body and wheel, and the indices, with a damper in its place."""
    car = paper_quarter_car(k | c - b | Damper(damper))
    system = it.state_space(car, "road", ["sprung_velocity", "unsprung_velocity", "sprung_acceleration", "tyre_load"])
    rows = np.vstack([system.C[0] - system.C[1], system.C[2], system.C[3]])
    return covariance(it.LinearSystem(system.A, system.B, rows, np.zeros((3, 1))))


@pytest.mark.parametrize("force", [0.1, 10.0, 100.0, 1000.0, 3000.0])
def test_friction_across_the_strut_is_the_damper_that_its_own_velocity_asks_for(force):
    def miss(logarithm):
        return logarithm - math.log(math.sqrt(2.0 / math.pi) * force / across(math.exp(logarithm))[0])

    damper = math.exp(scipy.optimize.brentq(miss, math.log(1e-3), math.log(1e8), xtol=1e-13))
    car = paper_quarter_car(k | c - b | Friction(force))
    assert [value(car, J1), value(car, J3)] == pytest.approx(across(damper)[1:], rel=1e-7)
    assert f"{damper:.4g}" in f"{float(it.evaluate(car, J1, METHOD).notes[0].split()[-3]):.4g}"


def half_car(front, rear):
    return paper_half_car(k | c - b | front, Spring(100e3) | c | rear)


@pytest.mark.parametrize("conventions", sampled(["exact", "paper2008"], ["exact"]))
def test_both_struts_of_a_half_car(conventions):
    """A plain fixed-point iteration with `h2`, on outputs of the struts' travel, whose rate is the velocity."""
    forces, dampers = np.array([50.0, 200.0]), np.array([1e3, 1e3])
    order = 5 if conventions == "paper2008" else None
    delay = 2.04 / ROAD.speed
    for _ in range(200):
        car = half_car(*map(Damper, dampers))
        names = ["sprung_velocity", "pitch_velocity", "unsprung_front_velocity", "unsprung_rear_velocity"]
        system = it.state_space(car, ["road_front", "road_rear"], names)
        rows = np.array([[1.0, 0.775, -1.0, 0.0], [1.0, -1.265, 0.0, -1.0]])
        speeds = it.LinearSystem(
            system.A, system.B, rows @ system.C, rows @ system.D, delays=[0.0, delay], sources=("road", "road")
        )
        sigma = h2(speeds, order).outputs * ROAD.velocity_intensity
        before, dampers = dampers, math.sqrt(2.0 / math.pi) * forces / sigma
        if np.allclose(dampers, before, rtol=1e-12, atol=0.0):
            break
    friction = half_car(*map(Friction, forces))
    for index in (J1, J3):
        expected = value(half_car(*map(Damper, dampers)), index, Norm(conventions))
        assert value(friction, index, Linearisation(conventions)) == pytest.approx(expected, rel=1e-8)


S3 = k | Damper(6666.4) - screw - (Inerter(363.55) | Friction(10.0, "f"))
LAYOUTS = {
    "S2": lambda f: k | c | screw - (b | Friction(f)),
    "S3": lambda f: k | c - screw - (b | Friction(f)),
    "in series": lambda f: k | c | Spring(1e6) - Friction(f),
    "two": lambda f: k | c - (b | Friction(f)) | Spring(2e5) - Friction(2.0 * f),
    "a chain": lambda f: k | c | Spring(1e6) - Friction(f) - Friction(1.5 * f),
}
LOCKED = {
    "S2": k | c | screw,
    "S3": k | c - screw,
    "in series": k | c | Spring(1e6),
    "two": k | c | Spring(2e5),
    "a chain": k | c | Spring(1e6),
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_none_is_the_norm_and_a_huge_one_is_a_rigid_link(name):
    for index in (J1, J3, J5):
        free, method = paper_quarter_car(LAYOUTS[name](0.0)), Norm()
        assert value(free, index) == value(free, index, method)
        locked = value(paper_quarter_car(LOCKED[name]), index, method)
        assert value(paper_quarter_car(LAYOUTS[name](1e6)), index) == pytest.approx(locked, rel=1e-6)
        small = [value(paper_quarter_car(LAYOUTS[name](f)), index) for f in (1e-6, 1e-3)]
        assert small == pytest.approx([value(free, index)] * 2, rel=1e-5)


@pytest.mark.parametrize("name", sampled(LAYOUTS, ["S3"], kept=1))
def test_no_jump_from_none_to_stuck(name):
    forces = np.geomspace(1.0, 1e5, 40)
    for index in (J1, J3, J5):
        logs = np.log([value(paper_quarter_car(LAYOUTS[name](f)), index) for f in forces])
        assert np.abs(np.diff(logs)).max() < 0.3


def test_more_friction_in_the_ball_screw_rides_worse():
    for index in (J1, J3):
        values = [value(paper_quarter_car(LAYOUTS["S3"](f)), index) for f in np.geomspace(0.1, 200.0, 15)]
        assert np.all(np.diff(values) > -1e-9 * values[0])


@pytest.mark.parametrize("index", [J1, J3], ids=["J1", "J3"])
def test_small_friction_changes_the_index_as_in_simulation(index):
    """10 N in the paper's quarter car, over 8 random roads of 10 s: the mean change, with its own scatter."""
    output = {"J1": "sprung_acceleration", "J3": "tyre_load"}[index.symbol]
    changes = []
    for seed in range(8):
        road = it.multisine(ROAD, seed=seed, highest=200.0)
        rms = [
            float(np.sqrt(np.mean(it.simulate(car, road=road, initial="periodic", step=5e-4)[output] ** 2)))
            for car in (paper_quarter_car(S3), paper_quarter_car(LAYOUTS_OF_PAPER))
        ]
        changes.append(rms[0] - rms[1])
    expected = value(paper_quarter_car(S3), index) - value(paper_quarter_car(LAYOUTS_OF_PAPER), index)
    scatter = float(np.std(changes, ddof=1) / math.sqrt(len(changes)))
    assert expected == pytest.approx(float(np.mean(changes)), abs=3.0 * scatter + 0.05 * abs(expected))
    assert scatter < 0.1 * abs(expected)


LAYOUTS_OF_PAPER = k | Damper(6666.4) - screw - Inerter(363.55)


@pytest.mark.parametrize(("name", "force"), [("S2", 20.0), ("S2", 200.0), ("S3", 20.0), ("S3", 100.0), ("two", 20.0)])
def test_peaks_of_a_sinusoidal_force_are_those_of_the_simulated_motion(name, force):
    car = paper_quarter_car(LAYOUTS[name](force))
    estimate = it.evaluate(car, J5, METHOD)
    assert estimate.value == estimate.peaks[0].gain
    assert estimate.peaks[0].omega > 1.0
    for peak in (peak for peak in estimate.peaks if peak.omega > 1.0):
        drive = it.sine(amplitude=1000.0, frequency=peak.omega / (2.0 * math.pi))
        run = it.simulate(car, forces={"sprung_force": drive}, initial="periodic", step=drive.period / 2000)
        moved = np.asarray(run["sprung_displacement"])[:-1]
        first = 2.0 * np.abs(np.fft.rfft(moved)[1]) / moved.size
        assert first / 1000.0 == pytest.approx(peak.gain, rel=0.005)


def test_one_friction_under_a_sine_by_hand():
    """Car of one mass on a spring with friction beside it: Den Hartog's problem in one harmonic."""
    F, f, m, stiffness = 1000.0, 300.0, 200.0, 5e4
    mechanism = it.Mechanism(
        coordinates=(it.Coordinate("body", m),),
        struts=(
            it.Strut("leg", Spring(stiffness) | Damper(500.0) | Friction(f), upper={"body": 1.0}, lower=it.GROUND),
        ),
        forces=(it.Force("push", {"body": 1.0}),),
        measures=it.PerformanceOutputs(load_input="push", load_output="body_displacement"),
    )
    omega = np.linspace(0.001, 60.0, 400001)
    limit, Y = 4.0 * f / math.pi, 500.0 + 1j * (m * omega - stiffness / omega)
    along = limit * Y.real
    V = (-along + np.sqrt(along**2 + np.abs(Y) ** 2 * (F**2 - limit**2))) / np.abs(Y) ** 2
    assert value(mechanism, LoadCarrying(F)) == pytest.approx((V / omega).max() / F, rel=1e-8)


def test_friction_alone_bounds_a_resonance_only_if_it_is_strong_enough():
    weak, strong = (paper_quarter_car(k | Friction(f)) for f in (100.0, 1e4))
    assert it.evaluate(weak, J5, METHOD).value == math.inf
    assert it.evaluate(weak, J5, METHOD).status.kind == "marginal"
    assert it.evaluate(strong, J5, METHOD).value < 1e-3
    assert value(weak, J1) < 20.0  # the norm of the undamped car is infinite


def by_hand(car, omega, force, amplitude):
    """Gain at one frequency from dynamic stiffnesses of nodes, with the damper sought by bisection."""

    def at(damper):
        strut = map_elements(car.strut, lambda e: Damper(damper, "sought") if isinstance(e, Friction) else e)
        nodal = Nodal(paper_quarter_car(strut).mechanism(), [omega])
        which = next(i for i, (e, _, _) in enumerate(nodal.elements) if e.name == "sought")
        column = nodal.inputs.index("sprung_force")
        speed = omega * abs(nodal._elongation(which, column)[0]) * amplitude
        return float(damper * speed), float(abs(nodal.response("sprung_displacement", "sprung_force")[0]))

    low, high = -6.0, 12.0
    if at(10.0**high)[0] > 4.0 * force / math.pi:
        low = scipy.optimize.brentq(lambda x: at(10.0**x)[0] - 4.0 * force / math.pi, low, high, xtol=1e-13)
        high = low
    return at(10.0**high)[1]


@pytest.mark.campaign
@settings(max_examples=20)
@given(networks(depth=2, most=4), elements(), logarithmic(1.0, 1e4), st.booleans())
def test_peaks_of_random_networks_by_bisection_between_nodes(inner, other, force, series):
    rubbing = inner - (other | Friction(force)) if series else inner | Friction(force)
    car = paper_quarter_car(Spring(3e4) | Damper(500.0) | rubbing)
    estimate = it.evaluate(car, J5, METHOD)
    assert is_solved(estimate)
    for peak in estimate.peaks:
        omega = peak.omega or 1e-4
        assert peak.gain == pytest.approx(by_hand(car, omega, force, 1000.0), rel=1e-3 if peak.omega == 0.0 else 1e-6)
    for omega in np.geomspace(0.1, 1e3, 12):
        assert by_hand(car, omega, force, 1000.0) <= estimate.value * (1.0 + 1e-6)


@pytest.mark.parametrize("index", [J1, J3, J5], ids=["J1", "J3", "J5"])
@pytest.mark.parametrize("force", [0.1, 20.0, 200.0, 2000.0])
def test_two_side_by_side_add_up_and_of_two_end_to_end_the_weaker_counts(index, force):
    rest, spring = k | c - b, Spring(3e5)
    beside = paper_quarter_car(rest | Friction(force) | Friction(0.7 * force))
    assert value(beside, index) == pytest.approx(
        value(paper_quarter_car(rest | Friction(1.7 * force)), index), rel=1e-8
    )
    behind = paper_quarter_car(rest | spring - Friction(force) - Friction(0.7 * force))
    weaker = paper_quarter_car(rest | spring - Friction(0.7 * force))
    assert value(behind, index) == pytest.approx(value(weaker, index), rel=1e-6)


@pytest.mark.campaign
@settings(max_examples=30)
@given(networks(depth=2, most=4), elements(), logarithmic(1.0, 1e4), logarithmic(1.0, 1e4), st.booleans())
def test_random_networks_meet_their_own_equation(inner, other, force, second, series):
    """Every damper of the notes, put in explicitly, gives the index."""
    strut = Spring(3e4) | Damper(500.0) | inner - (other | Friction(force, "f1"))
    strut = strut | (Spring(1e5) - Friction(second, "f2") if series else Friction(second, "f2"))
    car = paper_quarter_car(strut)
    for index in (J1, J3):
        estimate = it.evaluate(car, index, METHOD)
        if not is_solved(estimate):  # too stiff for double precision, and said so
            assert estimate.status.message
            continue
        found = {note.split("'")[1]: note for note in estimate.notes}

        def put(element, found=found):
            if not isinstance(element, Friction):
                return element
            note = found[element.name]
            return Gap(0.0) if "sticks" in note else Damper(next(x for x in parts_of(note) if isinstance(x, float)))

        explicit = it.evaluate(paper_quarter_car(map_elements(strut, put)), index, Norm())
        assert estimate.value == pytest.approx(explicit.value, rel=1e-4)
    assert it.evaluate(car, J5, METHOD).value > 0.0


@pytest.mark.campaign
def test_values_gradients_and_optima():
    free = it.free
    inner = screw - (Inerter(free(1.0, 2e3, "b")) | Friction(free(1.0, 100.0, "f")))
    car = paper_quarter_car(k | Damper(free(100.0, 1e5, "c")) - inner)
    for index in (J1, J3, J5):
        objective = METHOD.objective(car, index)
        points = np.array([[5e3, 300.0, 10.0], [2e3, 100.0, 99.0], [9e4, 1500.0, 1.0], [300.0, 20.0, 80.0]])
        for point, found in zip(points, objective.values(points), strict=True):
            values = dict(zip(car.free_values(), point, strict=True))
            assert found == pytest.approx(value(car.with_values(values), index), rel=1e-8)
            _, gradient = objective.value_and_gradient(point)
            steps = 1e-5 * np.diag(point)
            ends = objective.values(np.vstack([point + steps, point - steps]))
            assert gradient == pytest.approx((ends[:3] - ends[3:]) / (2e-5 * point), rel=1e-3, abs=1e-6 * found)
        best = it.optimise(car, index, METHOD)
        assert is_solved(best.estimate)
        assert best.value <= objective.values(points).min()
        assert best.n_converged > 1
    columns = dict(zip(car.free_values(), points.T, strict=True))
    many, trusted = it.evaluate_many(car, [J1, J5], columns, METHOD), set()
    for index, found in zip((J1, J5), many.T, strict=True):
        designs = [car.with_values(dict(zip(columns, point, strict=True))) for point in points]
        each = [it.evaluate(design, index, METHOD) for design in designs]
        trusted |= {e.status.ok for e in each}
        expected = [e.value if e.status.ok else math.nan for e in each]
        assert found == pytest.approx(expected, rel=1e-12, nan_ok=True)
    assert trusted == {True, False}


def test_the_filter_of_the_index_leaves_the_velocity_alone():
    car = half_car(Friction(50.0), Friction(100.0))
    notes = [it.evaluate(car, index, METHOD).notes for index in (J3, TyreLoad(ROAD, high_pass=6.0))]
    assert notes[0] == notes[1]


def test_friction_in_a_tyre_sees_white_noise_and_does_nothing():
    mechanism = paper_quarter_car(k | c).mechanism()
    tyre = it.Tyre("tyre", Spring(120e3) | Friction(50.0), {"unsprung": 1.0}, "road")
    rough = it.Mechanism(
        mechanism.coordinates, mechanism.struts, (tyre,), mechanism.roads, mechanism.forces, mechanism.measures
    )
    assert value(rough, J1) == pytest.approx(value(mechanism, J1, Norm()), rel=1e-12)


def test_what_is_refused():
    backlash = paper_quarter_car(k | c - Gap(1e-3, "play") - (b | Friction(10.0)))
    with pytest.raises(PerformanceIndexError, match=r"'play' in 'strut' is a gap\..* half width of 0"):
        it.evaluate(backlash, J1, METHOD)
    closed = paper_quarter_car(k | c - Gap(0.0) - (b | Friction(10.0)))
    assert value(closed, J1) == pytest.approx(value(paper_quarter_car(k | c - (b | Friction(10.0))), J1), rel=1e-12)
    with pytest.raises(PerformanceIndexError, match="amplitude"):
        it.evaluate(paper_quarter_car(S3), LoadCarrying(), METHOD)
    with pytest.raises(PerformanceIndexError, match="conventions"):
        Linearisation("1999")
    idle = paper_quarter_car(k | c | (Gap(0.0) - Spring(1e5) | Friction(it.free(1.0, 5.0, "f"))) - Damper(1e3))
    assert METHOD.objective(idle, J1) is not None
    stuck = paper_quarter_car(k | c | (Gap(0.0) | Friction(it.free(1.0, 5.0, "f"))) - Damper(1e3) - Friction(1.0))
    with pytest.raises(DesignError, match="no effect"):
        it.optimise(stuck, J1, METHOD)


def test_the_bound_of_one_harmonic_falls_with_the_power_3_2_of_a_force_that_friction_stops():
    """The third harmonic falls with the square of the ratio of friction to force, and the error with its power 3/4."""
    car = paper_quarter_car(k | Damper(7544.2) - (Inerter(366.52) | Friction(1.0)))
    forces = np.array([20.0, 40.0, 80.0])
    bounds = [it.evaluate(car, it.LoadCarrying(force), it.StatisticalLinearisation()).error_bound for force in forces]
    slopes = np.diff(np.log(bounds)) / np.diff(np.log(forces))
    np.testing.assert_allclose(slopes, -1.5, atol=0.02)
