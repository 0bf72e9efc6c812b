"""Coordinates without mass: networks that meet at a node of a mechanism are one network with that node inside."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from nodal import Nodal
from quadrature import h2_by_quadrature
from strategies import random_network
from wang_su import ROAD

import inerter as it
from inerter import (
    Bridge,
    Coordinate,
    Damper,
    Friction,
    Gap,
    Inerter,
    Mechanism,
    OutputWeight,
    PerformanceOutputs,
    RoadInput,
    Spring,
    Strut,
    Tyre,
)
from inerter.errors import InerterError, LinearSystemError, MechanismError
from inerter.norms.exact import h2_exactly

TOP, BOTTOM = {"body": 1.0}, {"wheel": 1.0}
MEASURES = PerformanceOutputs((OutputWeight("body_acceleration"),), (OutputWeight("tyre_load"),))


def mechanism(struts, *nodes: str) -> Mechanism:
    masses = (Coordinate("body", 181.75), Coordinate("wheel", 25.0))
    return Mechanism(
        (*masses, *(Coordinate(name, 0.0) for name in nodes)),
        (Strut("spring", Spring(2e4) | Damper(500.0), TOP, BOTTOM), *struts),
        (Tyre("tyre", Spring(120e3), BOTTOM, "road"),),
        (RoadInput("road"),),
        measures=MEASURES,
    )


def with_bridge(arms) -> Mechanism:
    return mechanism([Strut("bridge", Bridge(*arms), TOP, BOTTOM)])


def with_nodes(arms) -> Mechanism:
    left, right = {"left": 1.0}, {"right": 1.0}
    ends = ((TOP, left), (left, BOTTOM), (TOP, right), (right, BOTTOM), (left, right))
    struts = [Strut(f"arm_{n}", arm, *end) for n, arm, end in zip("abcde", arms, ends, strict=True)]
    return mechanism(struts, "left", "right")


@pytest.mark.parametrize("seed", range(25))
def test_a_bridge_over_two_massless_coordinates_has_the_norms_of_a_bridge(seed):
    rng = np.random.default_rng(seed)
    arms = [random_network(rng, 2, 3) for _ in "abcde"]
    one, other = with_bridge(arms), with_nodes(arms)
    for index in (it.RideComfort(ROAD), it.TyreLoad(ROAD)):
        value, same = (it.evaluate(car, index, it.Norm()) for car in (one, other))
        assert value.status.ok == same.status.ok
        if value.status.ok:
            assert same.value == pytest.approx(value.value, rel=1e-8)
    outputs = ["body_acceleration", "tyre_load"]
    systems = [it.state_space(car, inputs=["road"], outputs=outputs) for car in (one, other)]
    G, same_G = (it.frequency_response(system, np.geomspace(0.1, 1e3, 20)) for system in systems)
    np.testing.assert_allclose(same_G, G, rtol=1e-7, atol=1e-9 * np.abs(G).max())


def test_the_exact_path_takes_massless_coordinates():
    arms = (Spring(1e4), Damper(2e3), Inerter(50.0), Damper(1e3), Spring(2e4))
    norms = [
        h2_exactly(it.state_space(car, inputs=["road"], outputs=["body_acceleration"]), None)[0]
        for car in (with_bridge(arms), with_nodes(arms))
    ]
    np.testing.assert_allclose(norms[0], norms[1], rtol=1e-14)


def test_velocities_and_displacements_of_a_massless_coordinate_by_the_balance_of_its_forces():
    """A spring and a damper in series: c (v_body - v_node) = k (x_node - x_wheel)."""
    k, c = 3e4, 800.0
    node = {"node": 1.0}
    car = mechanism([Strut("d", Damper(c), TOP, node), Strut("s", Spring(k), node, BOTTOM)], "node")
    names = ["body_velocity", "wheel_velocity", "node_velocity", "node_displacement", "d_force", "s_force"]
    omega = np.array([0.7, 8.0, 60.0])
    body, wheel, velocity, place, d, s = np.moveaxis(
        it.frequency_response(it.state_space(car, inputs=["road"], outputs=names), omega)[:, :, 0], 1, 0
    )
    s_ = 1j * omega
    np.testing.assert_allclose(velocity, (c * body + k / s_ * wheel) / (c + k / s_), rtol=1e-9)
    np.testing.assert_allclose(place, velocity / s_, rtol=1e-9)
    np.testing.assert_allclose(d, s, rtol=1e-9)


BETWEEN_SPRINGS = [
    Spring(3e4),
    Spring(3e4) | Spring(8e4) - Inerter(5.0),
    Spring(3e4) | Spring(8e4) - Damper(700.0),
    Spring(3e4) | Spring(8e4) - Inerter(5.0) - Damper(700.0),
    Spring(3e4) | Bridge(Spring(2e5), Inerter(3.0), Spring(1e4), Inerter(2.0), Spring(1e5)),
]


@pytest.mark.parametrize("upper", BETWEEN_SPRINGS)
def test_every_output_of_a_node_between_springs_by_nodal_equations(upper):
    node = {"node": 1.0}
    car = mechanism([Strut("upper", upper, TOP, node), Strut("lower", Spring(9e4), node, BOTTOM)], "node")
    omega = np.geomspace(0.5, 1e3, 12)
    nodal = Nodal(car, omega)
    for form in ("state-space", "descriptor"):
        system = it.named_system(car, form=form)
        assert len({state.name for state in system.states}) == system.A.shape[0]
        assert "node_velocity" in [output.name for output in system.outputs]
        expected = np.array([nodal.response(output.name, "road") for output in system.outputs]).T
        size = np.abs(expected).max(axis=0)
        difference = np.abs(system.response(omega)[:, :, 0] - expected) / size
        assert difference.max() < 1e-10
        for i, output in enumerate(system.outputs):  # a state that is called like an output is that output
            own = np.array([float(state.name == output.name) for state in system.states])
            if own.any():
                np.testing.assert_allclose(system.C[i], own, rtol=0.0, atol=1e-12)


SWITCHING = [
    (Spring(1e4), Damper(2e3), Inerter(50.0), Damper(1e3), Spring(2e4) | Friction(20.0)),
    (Spring(1e4) | Friction(30.0), Damper(2e3), Damper(800.0), Damper(1e3), Spring(2e4) - Gap(2e-4)),
    (Spring(1e4), Damper(2e3) | Friction(8.0), Spring(3e4) | Damper(600.0), Damper(1e3), Inerter(30.0) | Friction(5.0)),
    (
        (Spring(4e5) | Damper(900.0)) - Gap(2e-4) - (Inerter(40.0) | Friction(10.0)),
        Damper(2e3),
        Damper(800.0),
        Spring(2e4) | Damper(1e3),
        Damper(500.0),
    ),
]


@pytest.mark.parametrize("build", [with_bridge, with_nodes])
@pytest.mark.parametrize("arms", sampled([(arms,) for arms in SWITCHING], [(arms,) for arms in SWITCHING[2:]]))
def test_friction_and_gaps_in_bridges_by_both_integrators(arms, build):
    car, road = build(arms), it.multisine(ROAD, seed=3)
    run = it.simulate(car, road=road, duration=1.0, step=2e-4, energy=True)
    assert run.status.ok
    assert run.energy.relative_residual < 1e-8
    errors = []
    for step in (4e-5, 1e-5):
        check = it.simulate(
            car, road=road, duration=1.0, step=step, every=round(2e-4 / step), integrator="time-stepping"
        )
        names = ("body_velocity", "wheel_velocity", "tyre_load")
        errors.append(max(np.sqrt(np.mean((check[n] - run[n]) ** 2)) / run.rms(n) for n in names))
    assert errors[1] < 2e-3
    assert errors[1] < 0.5 * errors[0] or errors[1] < 1e-6


@pytest.mark.parametrize("arms", SWITCHING)
def test_a_bridge_moves_as_its_arms_over_massless_coordinates(arms):
    road = it.multisine(ROAD, seed=4)
    one, other = (it.simulate(build(arms), road=road, duration=1.0, step=2e-4) for build in (with_bridge, with_nodes))
    for name in ("body_velocity", "tyre_load", "body_displacement"):
        np.testing.assert_allclose(other[name], one[name], atol=1e-7 * np.abs(one[name]).max())


def test_a_massless_coordinate_has_no_acceleration_and_no_weight():
    car = with_nodes(SWITCHING[0])
    system = it.state_space(car)
    assert {"left_velocity", "left_displacement", "body_acceleration"} - set(system.outputs) <= {"left_displacement"}
    assert "left_acceleration" not in system.outputs
    with pytest.raises(InerterError, match="left_acceleration"):
        it.state_space(car, outputs=["left_acceleration"])
    assert it.static_tyre_loads(car) == it.static_tyre_loads(with_bridge(SWITCHING[0]))


def test_a_massless_coordinate_that_nothing_holds_is_refused():
    node = {"node": 1.0}
    loose = mechanism([Strut("s", Friction(3.0), TOP, node), Strut("g", Gap(1e-3), node, BOTTOM)], "node")
    with pytest.raises(MechanismError):
        it.evaluate(loose, it.RideComfort(ROAD), it.Norm())
    apart = mechanism([Strut("s", Gap(1e-3), TOP, node), Strut("g", Gap(1e-3), node, BOTTOM)], "node")
    with pytest.raises(MechanismError, match="is unconstrained"):
        it.simulate(apart, road=it.multisine(ROAD, seed=0), duration=0.1)
    with pytest.raises(MechanismError, match="'node' is unconstrained"):
        mechanism([], "node")


def test_a_negative_mass_is_refused():
    with pytest.raises(MechanismError, match="Mass of 'body'"):
        Mechanism((Coordinate("body", -1.0),), (Strut("s", Spring(1.0), TOP, {}),))


def test_norm_with_a_massless_coordinate_by_quadrature_of_the_nodal_solution():
    car = with_nodes((Spring(1e4), Damper(2e3), Inerter(50.0), Damper(1e3), Spring(2e4)))
    norm = it.h2_norm(it.state_space(car, inputs=["road"], outputs=["body_acceleration"]))
    response = lambda w: Nodal(car, w).response("body_acceleration", "road")[:, None].astype(complex)  # noqa: E731
    assert norm == pytest.approx(h2_by_quadrature(response, [0.0], 2e4), rel=1e-7)


def test_a_force_on_what_only_springs_hold_leaves_it_no_velocity():
    body, node = it.Coordinate("body", 100.0), it.Coordinate("node", 0.0)
    upper = it.Strut("upper", it.Spring(1e4, "k1"), upper={"body": 1.0}, lower={"node": 1.0})
    lower = it.Strut("lower", it.Spring(2e4, "k2"), upper={"node": 1.0}, lower=it.GROUND)
    held = it.Mechanism((body, node), (upper, lower), forces=(it.Force("push", {"node": 1.0}),))
    assert it.state_space(held, ["push"], ["body_displacement"]).D[0, 0] == 0.0
    with pytest.raises(LinearSystemError, match=r"A force acts on node, which only springs hold"):
        it.state_space(held, ["push"], ["k2_velocity"])
