"""Any excitation of any mechanism: norms and gradients against rational arithmetic, and closed forms."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
import pytest
from campaigns import sampled
from excited import ROAD, TwoSources, random_excitation, random_outputs
from random_mechanisms import FAMILIES, mechanisms, opened
from wang_su import J1, paper_half_car

import inerter as it
from inerter import Damper, Filter, Inerter, Spring, free
from inerter.errors import LinearSystemError, MechanismError, PerformanceIndexError, StatusKind
from inerter.methods.harmonic_response import ForcedResponse
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.methods.out_of_band import mean_on_roads, on_roads
from inerter.systems.piecewise import piecewise

rational = pytest.importorskip("rational_norms", reason="python-flint is not installed")


def members(seed, count):
    """Random mechanisms of all families, each with a random excitation and random outputs."""
    for family in FAMILIES:
        rng = np.random.default_rng([seed, *family.encode()])
        for mechanism in mechanisms(family, seed, count, 1.0):
            excitation = random_excitation(rng, mechanism)
            index = it.RandomResponse(random_outputs(rng, mechanism, excitation), excitation)
            try:
                linear_problem(mechanism, index.definition(mechanism), CONVENTIONS["exact"])
            except MechanismError:
                continue
            yield mechanism, index


@pytest.mark.parametrize("seed", sampled(range(11), [0], kept=1))
def test_random_responses_of_random_mechanisms(seed):
    """A value is right to 1e-9, or nan with its reason."""
    assert sum(rational.is_right(*member) for member in members(seed, 4)) >= 10


@pytest.mark.parametrize("seed", sampled(range(100, 111), [100], kept=1))
def test_compiled_values_and_gradients_under_random_excitations(seed):
    checked = 0
    for mechanism, index in members(seed, 2):
        made, values = opened(mechanism)
        expected = rational.index_value(mechanism, index)
        poles = np.linalg.eigvals(it.state_space(mechanism).A)
        if not values or expected in (None, rational.INFINITE) or np.any(-poles.real < 1e-5 * np.abs(poles)):
            continue
        rational.assert_compiled_value(made, index, values)
        rational.assert_gradient(made, index, values)
        checked += 1
    assert checked >= 2


@pytest.mark.parametrize("seed", sampled(range(200, 207), [200], kept=2))
def test_peak_responses_of_random_mechanisms(seed):
    """From forces and from displacements and velocities of roads."""
    right = 0
    for family in FAMILIES:
        rng = np.random.default_rng([seed, *family.encode()])
        for mechanism in mechanisms(family, seed, 3, 1.0):
            road, force = mechanism.roads[0].name, mechanism.forces[0].name
            source = str(rng.choice([road, f"{road}_velocity", force]))
            output = str(rng.choice([c.name for c in mechanism.coordinates])) + "_acceleration"
            index = it.PeakResponse(source, output, Filter([1.0], [1e-4, 0.014, 1.0]))
            with suppress(LinearSystemError, MechanismError):
                right += rational.is_right(mechanism, index)
    assert right >= 8


def single(mass, damping, stiffness=0.0):
    network = Damper(damping) if stiffness == 0.0 else Spring(stiffness) | Damper(damping)
    strut = it.Strut("support", network, upper={"mass": 1.0}, lower=it.GROUND)
    return it.Mechanism((it.Coordinate("mass", mass),), (strut,), forces=(it.Force("push", {"mass": 1.0}),))


def test_a_single_mass_in_closed_form():
    """Variances of displacement and velocity are S/(2 c k) and S/(2 c m) under force, times m^2 under the ground."""
    m, c, k, S = 3.0, 0.7, 50.0, 4.0
    one, push, quake = single(m, c, k), it.WhiteForce("push", S), it.GroundAcceleration(S)
    expected = {
        ("mass_displacement", push): S / (2.0 * c * k),
        ("mass_velocity", push): S / (2.0 * c * m),
        ("support_force", push): S / (2.0 * c * k) * k**2 + c**2 * S / (2.0 * c * m),
        ("mass_relative_displacement", quake): S * m**2 / (2.0 * c * k),
        ("mass_relative_velocity", quake): S * m / (2.0 * c),
        ("mass_acceleration", quake): S / m**2 * (m**2 * k / (2.0 * c) + m * c / 2.0),
    }
    for (name, excitation), variance in expected.items():
        found = it.evaluate(one, it.RandomResponse({name: 1.0}, excitation), it.Norm())
        assert found.value == pytest.approx(math.sqrt(variance), rel=1e-12)
    assert it.evaluate(single(m, c), it.RandomResponse({"mass_velocity": 1.0}, push), it.Norm()).value == pytest.approx(
        math.sqrt(S / (2.0 * c * m)), rel=1e-12
    )
    below = it.evaluate(one, it.RandomResponse({"mass_acceleration": 1.0}, push), it.Norm())
    assert math.isinf(below.value)
    assert "direct feedthrough from white noise" in below.status.message


def test_a_push_on_moving_ground_is_that_on_ground_at_rest():
    """Motions relative to the ground answer a force in the same way, whether the ground may move or not."""
    one = single(3.0, 0.7, 50.0)
    moving = it.GroundAcceleration(4.0).excited_mechanism(one)
    found = it.h2_norm(it.state_space(moving, "push", "mass_relative_displacement"))
    assert found == pytest.approx(it.h2_norm(it.state_space(one, "push", "mass_displacement")), rel=1e-12)


def test_motions_that_the_ground_carries_are_refused_with_the_ones_to_ask_for():
    quake = it.RandomResponse({"mass_displacement": 1.0}, it.GroundAcceleration(1.0))
    with pytest.raises(PerformanceIndexError, match=r"unbounded.*mass_relative_displacement"):
        it.evaluate(single(1.0, 0.1, 1.0), quake, it.Norm())


def simulated(mechanism, index, roads=4):
    """By simulation of the design as it is, though it is linear: what `ExpectedValue` does with friction."""
    definition = index.definition(mechanism)
    system = piecewise(definition.drive.excited_mechanism(mechanism))
    design = on_roads(system, definition, CONVENTIONS["exact"], seed=0)
    with ThreadPoolExecutor(1) as pool:
        return mean_on_roads(design, roads, None, pool)


def is_quick(mechanism):
    """Whether ten seconds of it, in steps of 0.2 ms, tell what it does."""
    poles = np.linalg.eigvals(it.state_space(mechanism).A)
    moving = poles[np.abs(poles) > 1e-9 * np.abs(poles).max()]
    return bool(np.all(-moving.real > 0.3) and np.abs(moving).max() < 2500.0)


def quick_member(seed):
    """A random mechanism, a random excitation, and outputs whose norm is known."""
    family = list(FAMILIES)[seed % len(FAMILIES)]
    rng = np.random.default_rng([seed, *family.encode()])
    for mechanism in (made for more in range(20) for made in mechanisms(family, seed + 1000 * more, 20, 1.0)):
        try:
            if not is_quick(mechanism):
                continue
        except MechanismError:
            continue
        excitation = random_excitation(rng, mechanism)
        index = it.RandomResponse(random_outputs(rng, mechanism, excitation), excitation)
        norm = it.evaluate(mechanism, index, it.Norm())
        if norm.status.ok:
            return mechanism, index, norm.value
    raise AssertionError("none of so many is quick")


@pytest.mark.parametrize("seed", sampled(range(300, 400), [302, 307], kept=0))
def test_simulated_responses_are_the_norms(seed):
    """On the lines of a multisine, with what lies beyond them added; that may be a large part, and is said then."""
    mechanism, index, norm = quick_member(seed)
    by_time = simulated(mechanism, index)
    assert by_time.status.kind in (StatusKind.OK, StatusKind.INACCURATE), by_time.status
    assert by_time.standard_error < 0.1 * norm
    assert by_time.value == pytest.approx(norm, rel=1e-6, abs=4.0 * by_time.standard_error)


@pytest.mark.campaign
def test_friction_under_all_excitations_by_three_methods():
    """Simulation against statistical linearisation, which is within 3 % where it says ok."""
    mount = Spring(3e3) | Damper(20.0) | it.Friction(1.0)
    struts = (
        it.Strut("support", Spring(4e4) | Damper(100.0), {"primary": 1.0}, it.GROUND),
        it.Strut("mount", mount, {"absorber": 1.0}, {"primary": 1.0}),
    )
    masses = (it.Coordinate("primary", 100.0), it.Coordinate("absorber", 10.0))
    made = it.Mechanism(masses, struts, forces=(it.Force("push", {"primary": 1.0}),))
    push, quake = it.WhiteForce("push", 100.0), it.GroundAcceleration(0.1)
    shaped = it.FilteredExcitation(quake, Filter([100.0], [1.0, 10.0, 100.0]))
    for name, excitation in (
        ("primary_displacement", push),
        ("primary_relative_displacement", quake),
        ("primary_acceleration", shaped),
    ):
        index = it.RandomResponse({name: 1.0}, excitation)
        real = it.evaluate(made, index, it.ExpectedValue(seed=1))
        near = it.evaluate(made, index, it.StatisticalLinearisation())
        assert real.status.ok
        assert near.status.ok
        assert near.value == pytest.approx(real.value, rel=0.03, abs=4.0 * real.standard_error)
        gains = it.evaluate(
            made, index, it.ApproximateLinear(force=it.MultisineExcitation(rms=excited_rms(excitation)))
        )
        assert gains.value == pytest.approx(real.value, rel=0.1)


def excited_rms(excitation):
    """Of the multisine of 0.1 to 500 Hz that has the density of the excitation."""
    return excitation.amplitude_density * math.sqrt(2.0 * 500.0)


def test_gains_of_several_sources_are_refused():
    one = single(1.0, 0.1, 1.0)
    both = it.Mechanism(
        one.coordinates, (replace(one.struts[0], network=one.struts[0].network | it.Friction(0.1)),),
        roads=(it.RoadInput("a"),), forces=one.forces,
        tyres=(it.Tyre("t", Spring(1.0), {"mass": 1.0}, "a"),),
    )  # fmt: skip
    two = TwoSources(ROAD, (Filter([1.0], [1.0, 1.0]), Filter([1.0], [1.0, 2.0])))
    with pytest.raises(PerformanceIndexError, match="gains from one signal"):
        it.evaluate(both, it.RandomResponse({"t_load": 1.0}, two), it.ApproximateLinear())


@pytest.mark.parametrize("source", ["road", "road_velocity", "sprung_force"])
def test_a_peak_is_where_a_simulated_sine_is_largest(source):
    """The highest of all peaks, against the steady state under a sine of that frequency."""
    car = it.QuarterCar(250.0, 35.0, 180e3, Spring(25e3) | Damper(1500.0)).mechanism()
    found = it.evaluate(car, it.PeakResponse(source, "tyre_load", amplitude=0.3), it.Norm())
    (path,) = it.SingleInput(source).input_paths(car)
    by_time, squares = ForcedResponse(piecewise(car), path, "tyre_load", 0.3)(found.peaks[0].omega)
    assert squares.status.ok
    assert by_time == pytest.approx(found.value, rel=1e-5)
    assert found.value == found.peaks[0].gain


def ask(outputs, excitation):
    return it.evaluate(single(1.0, 0.1, 1.0), it.RandomResponse(outputs, excitation), it.Norm())


def peak(source, output):
    return it.evaluate(single(1.0, 0.1, 1.0), it.PeakResponse(source, output), it.Norm())


def peak_on_damped_tyre():
    car = it.QuarterCar(250.0, 35.0, 180e3, Spring(25e3) | Damper(1500.0)).mechanism()
    return it.evaluate(with_damped_tyres(car, 50.0), it.PeakResponse("road", "tyre_load"), it.Norm())


def with_damped_tyres(car, damping):
    tyres = (replace(tyre, network=tyre.network | Damper(damping, f"{tyre.name}_damper")) for tyre in car.tyres)
    return replace(car, tyres=tuple(tyres))


@pytest.mark.parametrize("seed", sampled(range(12), [0, 2], kept=4))
@pytest.mark.parametrize("output", ["sprung_displacement", "sprung_velocity", "sprung_acceleration", "travel"])
def test_the_displacement_of_a_road_drives_a_damped_tyre(seed, output):
    """Against a dense sweep of the gain from its velocity, times omega; the supremum may lie at infinity."""
    random = np.random.default_rng(seed)
    k, c, b, damping = np.exp(random.normal(0.0, 0.7, 4)) * [60e3, 3e3, 200.0, 400.0]
    strut = [Spring(k) | Damper(c), Spring(k) | Damper(c) - it.Inerter(b)][seed % 2]
    half = seed % 3 == 2
    car = paper_half_car(front=strut, rear=strut) if half else it.QuarterCar(250.0, 35.0, 180e3, strut)
    damped, road = with_damped_tyres(car.mechanism(), damping), "road_front" if half else "road"
    name = output if output != "travel" else "front_travel" if half else "strut_travel"
    found = it.evaluate(damped, it.PeakResponse(road, name), it.Norm())
    system = it.state_space(damped, inputs=[road], outputs=[name])
    omega = np.concatenate((np.geomspace(1e-2, 1e6, 40_001), [p.omega for p in found.peaks if np.isfinite(p.omega)]))
    gains = np.abs(it.frequency_response(system, omega)[:, 0, 0]) * omega
    assert found.value == pytest.approx(gains.max(), rel=1e-6)
    assert found.value >= gains.max() * (1.0 - 1e-9)


def test_a_car_on_a_damped_tyre_is_optimised_for_the_displacement_of_its_road():
    car = it.QuarterCar(250.0, 35.0, 180e3, Spring(60e3) | Damper(it.free(100.0, 1e5, "c")) - it.Inerter(200.0))
    index = it.PeakResponse("road", "sprung_displacement")
    damped = with_damped_tyres(car.mechanism(), 300.0)
    best = it.optimise(damped, index, it.Norm(), seed=0)
    for factor in (0.99, 1.01):
        near = damped.with_values({"c": factor * best.parameters["c"]})
        assert it.evaluate(near, index, it.Norm()).value > best.value


def test_transmissibility_over_a_damped_tyre_is_that_of_velocities():
    """A rigid strut on a damped tyre: T^2 = (1 + (2 D r)^2) / ((1 - r^2)^2 + (2 D r)^2) (Den Hartog, sec. 2.12)."""
    k, c, mass = 180e3, 2e3, 285.0
    damped = it.Mechanism(
        coordinates=(it.Coordinate("mass", mass),),
        struts=(),
        tyres=(it.Tyre("tyre", Spring(k) | Damper(c), {"mass": 1.0}, "road"),),
        roads=(it.RoadInput("road"),),
    )
    twice = c / math.sqrt(k * mass)  # 2 D
    square = (math.sqrt(1.0 + 2.0 * twice**2) - 1.0) / twice**2  # of the ratio r at the peak
    expected = math.sqrt((1.0 + twice**2 * square) / ((1.0 - square) ** 2 + twice**2 * square))
    found = it.evaluate(damped, it.PeakResponse("road_velocity", "mass_velocity"), it.Norm())
    assert found.value == pytest.approx(expected, rel=1e-10)
    assert found.peaks[0].omega == pytest.approx(math.sqrt(square * k / mass), rel=1e-6)


BAD = {
    "no mapping": (lambda: it.RandomResponse("a", ROAD), "map names to weights"),
    "empty": (lambda: it.RandomResponse({}, ROAD), "map names to weights"),
    "weight": (lambda: it.RandomResponse({"a": "1"}, ROAD), "weight of output 'a' is a number"),
    "nothing": (lambda: it.RandomResponse({"a": 0.0}, ROAD), "other than 0"),
    "no excitation": (lambda: it.RandomResponse({"a": 1.0}, 5.0), "needs an excitation"),
    "a class": (lambda: it.RandomResponse({"a": 1.0}, it.WhiteForce), "needs an excitation"),
    "one input": (lambda: ask({"a": 1.0}, it.SingleInput("push")), "needs a random excitation"),
    "filter": (lambda: it.RandomResponse({"a": 1.0}, ROAD, "Wk"), r"Filter\(numerator"),
    "no name": (lambda: it.WhiteForce(3, 1.0), "name of a force"),
    "intensity": (lambda: it.WhiteForce("push", -1.0), "positive number"),
    "text": (lambda: it.GroundAcceleration("1"), "positive number"),
    "infinite": (lambda: it.GroundAcceleration(math.inf), "positive number"),
    "no shape": (lambda: it.FilteredExcitation(ROAD, None), "needs a filter"),
    "shape of one input": (
        lambda: it.FilteredExcitation(it.SingleInput("push"), Filter([1.0], [1.0, 1.0])),
        "requires a random excitation",
    ),
    "no force": (lambda: ask({"mass_velocity": 1.0}, it.WhiteForce("shove", 1.0)), r"Unknown force 'shove'.*push"),
    "no road": (lambda: ask({"mass_velocity": 1.0}, ROAD), "has none"),
    "output": (lambda: ask({"mass_velocitee": 1.0}, it.WhiteForce("push", 1.0)), "Did you mean mass_velocity"),
    "absolute": (lambda: ask({"mass_velocity": 1.0}, it.GroundAcceleration(1.0)), "mass_relative_velocity"),
    "peak input": (lambda: it.PeakResponse(1, "a"), "by its name"),
    "peak output": (lambda: it.PeakResponse("a", None), "by its name"),
    "amplitude": (lambda: it.PeakResponse("a", "b", amplitude=0.0), "positive number"),
    "no input": (lambda: peak("pull", "mass_velocity"), "Unknown input 'pull'"),
    "no output": (lambda: peak("push", "mass_speed"), "Unknown output 'mass_speed'"),
    "damped tyre": (peak_on_damped_tyre, "transmits the velocity of road directly to tyre_load.*Use road_velocity"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_is_refused_in_a_sentence(case):
    make, words = BAD[case]
    with pytest.raises(it.InerterError, match=words) as caught:
        make()
    assert str(caught.value).endswith((".", "?"))
    assert "\n" not in str(caught.value)


def absorber(mu, beta, k, c):
    return it.Absorber(1.0, 1.0, mu, Spring(k) | Damper(c), Inerter(beta) if beta else None)


def variance(mu, beta, k, c, on_absorber):
    """Of the primary displacement, with forces of 1 and `on_absorber` on the two masses: Crandall and Mark (1963)."""
    m, f = mu + beta, on_absorber
    a4, a3, a2, a1, a0 = m, c * (1.0 + m), k + m * (1.0 + k), c, k
    b2, b1, b0 = m, c * (1.0 + f), k * (1.0 + f)
    top = b0**2 / a0 * (a2 * a3 - a1 * a4) + a3 * (b1**2 - 2.0 * b0 * b2) + a1 * b2**2
    return top / (2.0 * (a1 * (a2 * a3 - a1 * a4) - a0 * a3**2))


@pytest.mark.parametrize(("mu", "beta"), [(0.02, 0.0), (0.1, 0.05), (0.03, 0.4)])
def test_tuned_mass_dampers_in_closed_form(mu, beta):
    """Under a force, where the masses of absorber and inerter add up; over the ground, which inerters do not feel."""
    m = mu + beta
    nu = math.sqrt(1.0 + 0.5 * m) / (1.0 + m)  # the optimum under a white force: Asami (2002)
    zeta = math.sqrt(m * (4.0 + 3.0 * m) / (8.0 * (1.0 + m) * (2.0 + m)))
    k, c, S = m * nu**2, 2.0 * zeta * m * nu, 3.0
    made = absorber(mu, beta, k, c)
    push = it.RandomResponse({"primary_displacement": 1.0}, it.WhiteForce("primary_force", S))
    quake = it.RandomResponse({"primary_relative_displacement": 1.0}, it.GroundAcceleration(S))
    least = 0.5 * math.sqrt((4.0 + 3.0 * m) / (m * (1.0 + m)))
    assert it.evaluate(made, push, it.Norm()).value ** 2 == pytest.approx(S * least, rel=1e-8)
    assert it.evaluate(made, quake, it.Norm()).value ** 2 == pytest.approx(S * variance(mu, beta, k, c, mu), rel=1e-8)
    opened = it.Absorber(
        1.0, 1.0, mu, Spring(free(0.2 * k, 5.0 * k, "k")) | Damper(free(0.2 * c, 5.0 * c, "c")),
        Inerter(beta) if beta else None,
    )  # fmt: skip
    found = it.optimise(opened, push, it.Norm(), seed=0)
    assert found.value == pytest.approx(math.sqrt(S * least), rel=1e-8)
    assert found.parameters == pytest.approx({"k": k, "c": c}, rel=1e-4)


def test_the_least_peak_of_a_tuned_mass_damper():
    """The exact optimum of Nishihara and Asami (2002), with an inerter to the ground as a part of its mass."""
    m = 0.15
    root = math.sqrt(4.0 + 3.0 * m)
    inside = (8.0 + 9.0 * m) ** 2 * (16.0 + 9.0 * m) - 128.0 * root**3
    least = math.sqrt(inside / (3.0 * (32.0 + 27.0 * m))) / (3.0 * m)
    mount = Spring(free(1e-3, 1.0, name="k")) | Damper(free(1e-4, 1.0, name="c"))
    made = it.Absorber(primary_mass=1.0, primary_stiffness=1.0, mass=0.1, mount=mount, ground=Inerter(0.05))
    found = it.optimise(made, it.PeakResponse("primary_force", "primary_displacement"), it.Norm(), seed=0)
    assert found.value == pytest.approx(least, rel=1e-8)


def test_excitations_and_indices_of_the_previous_version_are_read():
    """Classes with the former names of their attributes give the same values, with a warning for each name."""

    @dataclass(frozen=True)
    class Push:
        size: float
        unit = "N"
        is_random = True

        def excited_mechanism(self, mechanism):
            return mechanism

        def arrivals(self, mechanism):
            return (it.InputPath("sprung_force", "push"),)

        def stand_ins(self, mechanism):
            return (it.ErrorSource("push", 0.01),)

    @dataclass(frozen=True)
    class Motion:
        symbol, title, unit, response = "M1", "motion", "m/s", "motion per force"

        def question(self, mechanism):
            outputs = (it.OutputWeight("sprung_velocity"),)
            return it.IndexDefinition(outputs, it.Combination.SUM_OF_RMS, Push(3.0), "m/s")

    strut = it.Spring(20e3) | it.Damper(1e3)
    car = it.QuarterCar(250.0, 35.0, 150e3, strut)
    with pytest.warns(DeprecationWarning, match="is now") as warned:
        found = it.evaluate(car, Motion(), it.Norm())
    names = {str(one.message).split(";")[0] for one in warned}
    assert names == {
        "`Motion.question` is now `definition`",
        "`Push.arrivals` is now `input_paths`",
        "`Push.size` is now `amplitude_density`",
        "`Push.stand_ins` is now `error_sources`",
    }
    force = it.RandomResponse({"sprung_velocity": 1.0}, it.WhiteForce("sprung_force", 9.0))
    assert found.value == it.evaluate(car, force, it.Norm()).value
    assert found.error_bound == pytest.approx(0.01, rel=1e-3)
    with pytest.warns(DeprecationWarning, match="`question` is now `definition`"):
        definition = J1.question(car.mechanism())
    with pytest.warns(DeprecationWarning, match="`size` is now `amplitude_density`"):
        assert definition.drive.size == definition.drive.amplitude_density
    with pytest.warns(DeprecationWarning, match="`arrivals` is now `input_paths`"):
        assert definition.arrivals(car.mechanism()) == definition.input_paths(car.mechanism())


class CountedPush:
    """A white force that counts how often a mechanism is excited by it."""

    amplitude_density, unit, is_random = 2.0, "N", True

    def __init__(self):
        self.count = 0

    def excited_mechanism(self, mechanism):
        self.count += 1
        return mechanism

    def input_paths(self, mechanism):
        return (it.InputPath("sprung_force", "push"),)


def test_an_excitation_is_read_once_for_an_evaluation_and_anew_for_the_next():
    push = CountedPush()
    car = it.QuarterCar(250.0, 30.0, 2e5, Spring(2e4) | Damper(2e3))
    index = it.RideComfort(push)
    first = it.evaluate(car, index, it.Norm())
    assert push.count == 1
    push.amplitude_density = 4.0
    assert it.evaluate(car, index, it.Norm()).value == 2.0 * first.value
    assert push.count == 2


def test_a_method_that_inherits_from_another_is_asked_itself():
    class Doubled(it.Norm):
        def estimate(self, vehicle, index):
            found = super().estimate(vehicle, index)
            return replace(found, value=2.0 * found.value)

    car = it.QuarterCar(250.0, 30.0, 2e5, Spring(2e4) | Damper(2e3))
    assert it.evaluate(car, J1, Doubled()).value == 2.0 * it.evaluate(car, J1, it.Norm()).value
