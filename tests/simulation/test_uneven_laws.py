"""Laws that differ by direction: against closed forms, against time stepping, and where nothing but words may come."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import count
from typing import ClassVar

import numpy as np
import pytest
from campaigns import sampled
from mechanisms import element, log_uniform, motion, network, road
from test_two_integrators import differences
from uneven import OneSidedStop, OneWay, Push, UnevenFriction, valved_damper
from wang_su import J1, ROAD, paper_quarter_car

import inerter as it
from inerter import Damper, Friction, Gap, Inerter, Spring, simulate
from inerter.errors import DesignError, MechanismError, PerformanceIndexError, SimulationError
from inerter.networks.elements import Element, Network
from inerter.networks.elements.roles import GuardRole, StatisticalRole, SwitchRole
from inerter.simulation.event_driven import start_finely
from inerter.simulation.inputs import tabulate
from inerter.systems.piecewise import piecewise, with_element_values

MASS, STIFFNESS = 10.0, 4000.0  # 20 rad/s


def oscillator(strut: Network) -> it.Mechanism:
    """A mass over the ground, with a force on it."""
    return it.Mechanism(
        coordinates=(it.Coordinate("mass", MASS),),
        struts=(it.Strut("strut", strut, {"mass": 1.0}, {}),),
        forces=(it.Force("force", {"mass": 1.0}),),
    )


def pushed(value: float) -> it.Signal:
    return it.Signal.sampled([0.0, 100.0], [value, value], "linear", label="constant")


@pytest.mark.parametrize("integrator", ["event-driven", "time-stepping"])
def test_a_push_is_a_constant_force(integrator):
    strut = Spring(STIFFNESS) | Damper(40.0)
    bump = it.Signal.sampled([0.0, 0.1, 0.2, 3.0], [0.0, 50.0, 0.0, 0.0], "linear", label="blow")
    along = simulate(
        oscillator(strut | Push(80.0)), forces={"force": bump}, duration=1.0, step=1e-3, integrator=integrator
    )
    alone = simulate(oscillator(strut), forces={"force": bump}, duration=1.0, step=1e-3, integrator=integrator)
    assert along.status.ok
    np.testing.assert_allclose(along["mass_displacement"], alone["mass_displacement"] - 80.0 / STIFFNESS, atol=1e-12)
    np.testing.assert_allclose(along["p_force"], 80.0)


def test_a_push_through_a_massless_node_strains_the_springs_in_series():
    run = simulate(
        oscillator(Spring(STIFFNESS) - (Spring(1000.0, "inner") | Push(80.0))),
        forces={"force": pushed(0.0)},
        duration=0.1,
    )
    np.testing.assert_allclose(run["mass_displacement"], -80.0 / 1000.0, atol=1e-12)
    np.testing.assert_allclose(run["inner_force"], -80.0, atol=1e-9)


def test_a_stop_that_is_met_at_rest_carries_the_load():
    car = oscillator(Spring(STIFFNESS) | OneSidedStop(0.01) - Spring(1e5, "buffer"))
    run = simulate(car, forces={"force": pushed(-1000.0)}, duration=0.2, initial="preload")
    compression = (1000.0 + 1e5 * 0.01) / (STIFFNESS + 1e5)
    np.testing.assert_allclose(run["mass_displacement"], -compression, atol=1e-12)
    away = simulate(car, forces={"force": pushed(1000.0)}, duration=0.2, initial="preload")
    np.testing.assert_allclose(away["mass_displacement"], 1000.0 / STIFFNESS, atol=1e-12)


@pytest.mark.parametrize(("integrator", "close"), [("event-driven", 1e-9), ("time-stepping", 2e-4)])
def test_a_swing_against_a_one_sided_buffer_has_the_period_of_two_half_swings(integrator, close):
    """From rest at an extension a: half a swing on one spring, half on two, then back at a: energy is kept."""
    strut = Spring(STIFFNESS) | OneSidedStop(1e-12) - Spring(3.0 * STIFFNESS)
    car, a = oscillator(strut), 0.01
    slow, fast = math.sqrt(STIFFNESS / MASS), math.sqrt(4.0 * STIFFNESS / MASS)
    period = math.pi / slow + math.pi / fast
    start = simulate(
        car, forces={"force": pushed(STIFFNESS * a)}, duration=0.01, initial="preload", integrator=integrator
    )
    run = simulate(
        car, forces={"force": pushed(0.0)}, duration=period, step=period / 4000, initial=start, integrator=integrator
    )
    x = run["mass_displacement"]
    assert x[0] == pytest.approx(a, rel=1e-9)
    assert x[-1] == pytest.approx(a, rel=close)
    assert x.min() == pytest.approx(-a * slow / fast, rel=max(close, 1e-6))


@pytest.mark.parametrize(("integrator", "close"), [("event-driven", 1e-9), ("time-stepping", 2e-3)])
def test_a_valved_damper_loses_by_each_stroke_what_its_damping_there_takes(integrator, close):
    """Free swings: each half has its own decrement exp(-pi z / sqrt(1 - z^2)) and duration pi / (w sqrt(1 - z^2))."""
    compression, extension, a = 40.0, 160.0, 0.02
    car = oscillator(Spring(STIFFNESS) | valved_damper(compression, extension))
    w = math.sqrt(STIFFNESS / MASS)
    ratios = [c / (2.0 * math.sqrt(STIFFNESS * MASS)) for c in (compression, extension)]
    roots = [math.sqrt(1.0 - z * z) for z in ratios]
    period = sum(math.pi / (w * root) for root in roots)
    left = math.prod(math.exp(-math.pi * z / root) for z, root in zip(ratios, roots, strict=True))
    start = simulate(
        car, forces={"force": pushed(STIFFNESS * a)}, duration=0.01, initial="preload", integrator=integrator
    )
    run = simulate(
        car, forces={"force": pushed(0.0)}, duration=period, step=period / 4000, initial=start, integrator=integrator
    )
    assert run["mass_displacement"][-1] == pytest.approx(a * left, rel=close)
    first = round(4000 * math.pi / (w * roots[0]) / period)
    turned = -a * math.exp(-math.pi * ratios[0] / roots[0])
    assert run["mass_displacement"][first] == pytest.approx(turned, rel=max(close, 1e-5))


def test_uneven_friction_stops_within_its_two_forces():
    """Drawn out slowly, a mass on a spring slips at one force, pushed back at the other: a loop of known height."""
    strut = UnevenFriction(30.0, 10.0, "f") | Spring(STIFFNESS)
    cycle = it.sine(amplitude=200.0, frequency=0.2)
    run = simulate(oscillator(strut), forces={"force": cycle}, duration=10.0, step=1e-3)
    forces = run["f_force"]
    assert forces.max() == pytest.approx(30.0, abs=1e-9)
    assert forces.min() == pytest.approx(-10.0, abs=1e-9)
    assert all(run.intervals("f", state) for state in ("slip down", "stick", "slip up"))


def test_a_clutch_through_which_a_blow_would_pass_holds_it():
    """Two inertias that a clutch ties at once: it bears any tension, so they go on together."""
    car = oscillator(Spring(STIFFNESS) | Damper(10.0) | (Inerter(5.0) | Spring(10.0)) - OneWay(1.0))
    run = simulate(car, forces={"force": it.sine(amplitude=100.0, frequency=3.0)}, duration=2.0, step=1e-3, energy=True)
    assert run.status.ok
    assert run.energy.relative_residual < 1e-8
    assert run["w_force"].min() >= -1.0 - 1e-9
    assert run["w_velocity"].max() <= 1e-9


KINDS: tuple[type[Element], ...] = (Friction, Gap, Push, OneSidedStop, OneWay, UnevenFriction)
UNEVEN = {Push: (5.0, 200.0), OneSidedStop: (1e-5, 1e-3), OneWay: (1.0, 200.0), UnevenFriction: (2.0, 300.0)}


def any_element(rng: np.random.Generator, kind: type[Element]) -> Element:
    if kind not in UNEVEN:
        return element(rng, kind)
    more = (log_uniform(rng, 2.0, 300.0),) if kind is UnevenFriction else ()
    return kind(log_uniform(rng, *UNEVEN[kind]), *more)  # type: ignore[call-arg]


def uneven_network(rng: np.random.Generator, nonlinear: int) -> Network:
    kinds = [KINDS[2 + int(rng.integers(4))], *(KINDS[int(rng.integers(6))] for _ in range(nonlinear - 1))]
    kinds += [(Spring, Damper, Inerter)[int(rng.integers(3))] for _ in range(int(rng.integers(1, 5)))]
    leaves = [any_element(rng, kinds[int(i)]) for i in rng.permutation(len(kinds))]
    return network(rng, leaves)


def uneven_case(seed: int):
    rng = np.random.default_rng([7, seed])
    base = Spring(log_uniform(rng, 2e4, 2e5)) | Damper(log_uniform(rng, 500.0, 5e3))
    part = uneven_network(rng, int(rng.integers(1, 4)))
    if seed % 2:
        shaft = Spring(log_uniform(rng, 1e5, 1e6)) | Damper(log_uniform(rng, 1e3, 1e4))
        return it.Rig(shaft - part), {"displacement": motion(rng)}
    return paper_quarter_car(base | part), {"road": road(rng)}


@pytest.mark.parametrize("chunk", sampled(range(40), [0], often=[1, 2, 3, 4], kept=0))
def test_two_integrators_agree_on_random_networks_of_uneven_laws(chunk):
    done = 0
    for seed in count(1000 * chunk):
        vehicle, inputs = uneven_case(seed)
        try:
            errors = differences(vehicle, inputs)
        except MechanismError:  # ill-posed, and refused
            continue
        except SimulationError as error:  # a push that no spring carries
            if "not carried by springs" not in str(error):
                raise
            continue
        assert errors[-1] < 2e-3, (seed, errors)
        done += 1
        if done == 4:
            break


def test_what_does_not_treat_such_laws_says_so():
    road = ROAD
    car = it.QuarterCar(180.0, 25.0, 120e3, Spring(20e3) | valved_damper(800.0, 2400.0))
    with pytest.raises(PerformanceIndexError, match=r"'w' in 'strut' is a one-way clutch\. Use expected-value"):
        it.evaluate(car, it.RideComfort(road), it.StatisticalLinearisation())
    linear = it.evaluate(car, it.RideComfort(road), it.Norm())
    assert any("one-way clutch 'w' in 'strut' left out" in note for note in linear.notes)
    simulated = it.evaluate(car, it.RideComfort(road), it.ExpectedValue(realisations=4, seed=0))
    bounds = [
        it.evaluate(it.QuarterCar(180.0, 25.0, 120e3, Spring(20e3) | Damper(c)), it.RideComfort(road), it.Norm()).value
        for c in (800.0, 1600.0, 2400.0)
    ]
    assert min(bounds) * 0.98 < simulated.value < max(bounds) * 1.02


def test_a_start_beyond_a_stop_is_refused():
    car = oscillator(Spring(STIFFNESS) | OneSidedStop(0.01) - Spring(1e5))
    still = {"forces": {"force": pushed(0.0)}, "duration": 0.1}
    start = np.zeros(simulate(car, **still).final_state.size)
    start[1:] = -0.05
    with pytest.raises(SimulationError, match=r"Stop 's' starts at -50 mm, beyond where it is met, at -10 mm\."):
        simulate(car, **still, initial=start, integrator="time-stepping")


def beside_a_friction(uneven: Element) -> it.Mechanism:
    return oscillator(Spring(STIFFNESS) | Damper(20.0) | uneven | Friction(5.0, "f"))


def test_what_another_member_of_the_kind_was_does_not_matter():
    """Frictions that are alike in both directions may share a force; the next of the kind is not alike."""
    wave = {"force": it.sine(amplitude=200.0, frequency=2.0)}
    simulate(beside_a_friction(UnevenFriction(10.0, 10.0, "u")), forces=wave, duration=0.1)
    run = simulate(beside_a_friction(UnevenFriction(30.0, 10.0, "u")), forces=wave, duration=1.0, step=1e-3)
    assert [(run[name].min(), run[name].max()) for name in ("u_force", "f_force")] == [(-10.0, 30.0), (-5.0, 5.0)]


@dataclass(frozen=True)
class Between(Push):
    """A kind whose limits are given."""

    ends: ClassVar[tuple[float, float]]
    key = "law"
    switch = SwitchRole(GuardRole.FORCE, "down", "stick", "up")

    @property
    def limits(self) -> tuple[float, float]:
        return self.ends


def between(lower: float, upper: float, guard: GuardRole = GuardRole.FORCE) -> Element:
    kind = type("Law", (Between,), {"ends": (lower, upper), "switch": SwitchRole(guard, "down", "middle", "up")})
    return kind(1.0, "x")


@pytest.mark.parametrize("integrator", ["event-driven", "time-stepping"])
@pytest.mark.parametrize(
    ("lower", "upper"),
    [
        (5.0, -5.0),
        (math.nan, 5.0),
        (5.0, math.nan),
        (-math.inf, math.inf),
        (math.inf, math.inf),
        (-math.inf, -math.inf),
    ],
)
def test_limits_that_cannot_be_are_one_sentence(lower, upper, integrator):
    for guard in GuardRole:
        strut = Spring(STIFFNESS) | Damper(40.0) | between(lower, upper, guard) - Spring(1e3)
        with pytest.raises(it.InerterError, match=f"Law 'x' switches at {lower} and {upper}; expected two numbers in"):
            simulate(oscillator(strut), forces={"force": pushed(1.0)}, duration=0.1, integrator=integrator)


@pytest.mark.parametrize(("lower", "upper", "rest"), [(0.005, 0.02, 0.005), (-0.02, -0.005, -0.005)])
def test_a_gap_on_one_side_of_zero_rests_at_its_nearer_end(lower, upper, rest):
    strut = Spring(STIFFNESS) | Damper(40.0) | between(lower, upper, GuardRole.ELONGATION) - Damper(300.0)
    run = simulate(oscillator(strut), forces={"force": pushed(0.0)}, duration=0.1, step=1e-3)
    np.testing.assert_allclose(run["x_stroke"], rest, rtol=1e-12)


def test_a_rest_between_a_slot_and_a_gap_is_one_that_both_can_have():
    parts = between(0.005, 0.02, GuardRole.ELONGATION) | Gap(0.01, "g")
    strut = Spring(STIFFNESS) | Damper(40.0) | Friction(50.0) - parts - Damper(300.0)
    for integrator in ("event-driven", "time-stepping"):
        run = simulate(
            oscillator(strut), forces={"force": pushed(0.0)}, duration=0.01, step=1e-4, integrator=integrator
        )
        assert run.status.ok


@pytest.mark.parametrize("drag", [54.276188008708544, 68.64540369432245, 79.05444163941203, 98.09298278032263])
def test_what_rests_at_a_limit_with_none_beyond_is_not_struck_by_rounding(drag):
    noise = 1e-3 * np.random.default_rng(1).standard_normal(150)
    rough = it.Signal.sampled(np.arange(0.0, 0.3, 0.002), noise, "zero", speed=10.0)
    car = paper_quarter_car(Spring(5e4) | Damper(1500.0) | between(drag, math.inf))
    assert simulate(car, road=rough, duration=0.2, step=2e-4).status.ok


CAR = paper_quarter_car(Spring(5e4) | Damper(1500.0))
COMFORT = J1


def with_in_series(law):
    """The car with a law in series with its damper."""
    return replace(CAR, strut=Spring(5e4) | Damper(1500.0) - law)


@pytest.mark.parametrize("statistical", list(StatisticalRole))
def test_statistical_linearisation_refuses_what_is_uneven_whatever_it_says_of_itself(statistical, monkeypatch):
    monkeypatch.setattr(UnevenFriction, "statistical", statistical)
    with pytest.raises(PerformanceIndexError, match="'u' in 'strut' is an uneven friction"):
        it.evaluate(with_in_series(UnevenFriction(300.0, 100.0, "u")), COMFORT, it.StatisticalLinearisation())


def test_a_clutch_is_not_told_to_have_no_drag():
    with pytest.raises(PerformanceIndexError, match=r"which simulate it\.$"):
        it.evaluate(with_in_series(OneWay(0.0, "w")), COMFORT, it.StatisticalLinearisation())


def test_a_budget_of_what_has_no_usual_size_asks_for_bounds():
    first, method = with_in_series(OneWay(0.0, "w")), it.ExpectedValue(realisations=2)
    with pytest.raises(DesignError, match=r"'w' is 0\. Give bounds=\(lower, upper\)"):
        it.break_even(first, CAR, COMFORT, parameter="w", method=method)


def test_a_constant_force_leaves_gains_as_they_are():
    struts = (Spring(5e4) | Damper(1500.0), Spring(5e4) | Damper(1500.0) | Push(800.0))
    plain, loaded = (paper_quarter_car(strut) for strut in struts)
    methods = (it.Norm(), it.ExpectedValue(realisations=2))
    found = {it.evaluate(car, it.LoadCarrying(), method).value for car in (plain, loaded) for method in methods}
    assert len(found) == 1


@pytest.mark.campaign
def test_a_constant_force_moves_the_equilibrium_and_no_mean_square():
    """R.m.s. values are of deviations from static equilibrium, by every method; a stop is met as much earlier."""
    index, method = it.SuspensionTravel(ROAD), it.ExpectedValue(realisations=2)
    stiffness, damper, buffer = 5e4, Damper(1500.0), Spring(1e5) | Damper(1e3)

    def found(part: Network, by: object = method) -> it.Estimate:
        return it.evaluate(paper_quarter_car(Spring(stiffness) | damper | part), index, by)

    plain = it.evaluate(paper_quarter_car(Spring(stiffness) | damper), index, it.Norm())
    assert found(Push(800.0)).value == pytest.approx(plain.value, rel=1e-12)
    assert found(Push(800.0) | Friction(20.0)).value == pytest.approx(found(Friction(20.0)).value, rel=1e-6)
    loaded = found(Push(100.0) | (buffer - OneSidedStop(3e-3)))
    assert loaded.value == pytest.approx(found(buffer - OneSidedStop(3e-3 - 100.0 / stiffness)).value, rel=1e-6)
    assert loaded.value != pytest.approx(plain.value, rel=1e-3)
    by = it.StatisticalLinearisation()
    assert found(Push(800.0) | Friction(20.0), by).value == found(Friction(20.0), by).value


def test_new_values_that_change_what_holds_are_refused():
    car = paper_quarter_car(Spring(5e4) | Damper(1500.0) | Reach(30.0, "u"))
    system = piecewise(car)
    assert with_element_values(system, {"u": 20.0}).limits.tolist() == [[-10.0, 20.0]]
    with pytest.raises(DesignError, match="'u' changes whether it holds against small forces"):
        with_element_values(system, {"u": 70.0})


@dataclass(frozen=True)
class Reach(Push):
    """Holds between a limit that grows with another, and that."""

    switch = SwitchRole(GuardRole.FORCE, "down", "stick", "up")

    @property
    def limits(self) -> tuple[float, float]:
        return (-10.0 if self.coefficient < 50.0 else 10.0), self.coefficient


def test_a_constant_force_changes_no_peak_gain():
    """It moves the mean, with and without friction beside it; the gain is of the motion about that."""
    index, method = it.PeakResponse("force", "mass_displacement", amplitude=100.0), it.ExpectedValue()
    strut = Spring(STIFFNESS) | Damper(100.0) | Friction(0.01)
    plain, moved = (it.evaluate(oscillator(one), index, method) for one in (strut, strut | Push(80.0)))
    assert moved.status.ok
    assert moved.value == pytest.approx(plain.value, rel=1e-5)
    assert moved.peaks[0].omega == pytest.approx(plain.peaks[0].omega, rel=1e-2)


def test_no_state_beyond_an_infinite_limit_is_tried_for_the_length_of_a_step():
    system = piecewise(oscillator(Spring(STIFFNESS) | Damper(40.0) - OneWay(0.0) | Friction(5.0)))
    table = tabulate([pushed(0.0)], [0.0], 0.1, 1e-3)
    begun = start_finely(system, table, np.zeros(system.order))
    assert begun.modes.state[: begun.count].tolist() == [[-1, 1]]
    assert np.all(np.isfinite(begun.modes.maps))
