"""Cars as mechanisms: what mounting, levers and free values mean."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import networks
from wang_su import J1, ROAD, paper_half_car, paper_quarter_car

from inerter import (
    GROUND,
    Coordinate,
    Damper,
    Force,
    Inerter,
    Mechanism,
    Spring,
    Strut,
    free,
    frequency_response,
    state_space,
)
from inerter.errors import MechanismError
from inerter.indices.definition import Combination
from inerter.systems.piecewise import piecewise

k, c, b = Spring(60e3), Damper(3e3), Inerter(50.0)


@given(st.floats(0.1, 10.0))
def test_a_lever_multiplies_an_element_by_its_square(lever):
    def rigid(network, arm):
        return Mechanism(
            coordinates=(Coordinate("arm", 3.0, angle=True),),
            struts=(Strut("s", network, {"arm": arm}, GROUND),),
            forces=(Force("moment", {"arm": 1.0}),),
        )

    omega = np.array([0.5, 20.0, 300.0])
    levered = frequency_response(state_space(rigid(k | c - b, lever), outputs="arm_displacement"), omega)
    square = lever**2
    direct = Spring(60e3 * square) | Damper(3e3 * square) - Inerter(50.0 * square)
    expected = frequency_response(state_space(rigid(direct, 1.0), outputs="arm_displacement"), omega)
    np.testing.assert_allclose(levered, expected, rtol=1e-10)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_strut_may_be_mounted_upside_down(sign):
    def spring_mass(upper, lower):
        return Mechanism(
            coordinates=(Coordinate("a", 2.0), Coordinate("z", 3.0)),
            struts=(Strut("s", k - b | c, upper, lower), Strut("base", k, {"z": 1.0}, GROUND)),
            forces=(Force("f", {"a": 1.0}),),
        )

    turned = spring_mass({"z": 1.0}, {"a": 1.0}) if sign < 0 else spring_mass({"a": 1.0}, {"z": 1.0})
    plain = spring_mass({"a": 1.0}, {"z": 1.0})
    outputs, omega = ["a_displacement", "s_force", "s_travel"], np.array([1.0, 50.0])
    ratio = frequency_response(state_space(turned, outputs=outputs), omega) / frequency_response(
        state_space(plain, outputs=outputs), omega
    )
    np.testing.assert_allclose(ratio[:, :, 0], [[1.0, sign, sign]] * 2, rtol=1e-10)


@given(networks(depth=2, most=5))
def test_the_force_of_a_strut_is_its_admittance_times_its_velocity(network):
    omega = np.array([0.7, 9.0, 120.0])
    system = state_space(paper_quarter_car(network), "road", ["strut_force", "sprung_velocity", "unsprung_velocity"])
    force, upper, lower = frequency_response(system, omega)[:, :, 0].T
    size = np.abs(network.admittance(1j * omega)) * (np.abs(upper) + np.abs(lower))
    difference = np.abs(force - network.admittance(1j * omega) * (upper - lower))
    assert np.max(difference / size) < 1e-9


def test_forces_balance_in_every_motion():
    """Newton's law for the body, and for the pitch with the lever arms."""
    car = paper_half_car(k | c - b, k | c | b)
    outputs = ["sprung_acceleration", "pitch_acceleration", "front_force", "rear_force"]
    heave, pitch, front, rear = frequency_response(state_space(car, "road_front", outputs), [3.0, 40.0])[:, :, 0].T
    np.testing.assert_allclose(car.sprung_mass * heave, -(front + rear), rtol=1e-10)
    np.testing.assert_allclose(
        car.pitch_inertia * pitch, -car.distance_front * front + car.distance_rear * rear, rtol=1e-9
    )


def test_free_values_come_in_the_order_of_writing_and_are_fixed_one_by_one():
    strut = k | Damper(free(1.0, 2.0, "c")) - Inerter(free(3.0, 4.0, "b"))
    car = paper_quarter_car(strut)
    assert list(car.free_values()) == ["c", "b"]
    one = car.with_values({"b": 3.5})
    assert list(one.free_values()) == ["c"]
    assert one.with_values({"c": 1.5}) == car.with_values({"c": 1.5, "b": 3.5})
    assert car.with_values({}) == car


def test_free_values_of_a_mechanism_include_its_tyres():
    mechanism = paper_quarter_car(k | Damper(free(1.0, 2.0, "c"))).mechanism()
    tyre = type(mechanism.tyres[0])("tyre", Spring(free(1e5, 2e5, "kt")), {"unsprung": 1.0}, "road")
    open_ = Mechanism(mechanism.coordinates, mechanism.struts, (tyre,), mechanism.roads)
    assert list(open_.free_values()) == ["c", "kt"]
    assert open_.with_values({"c": 1.5, "kt": 1.2e5}).free_values() == {}


def test_pitch_counts_in_comfort_with_the_mean_lever():
    definition = J1.definition(paper_half_car(k | c, k | c).mechanism())
    assert [(o.output, o.weight) for o in definition.outputs] == [
        ("sprung_acceleration", 1.0),
        ("pitch_acceleration", pytest.approx(1.02)),  # (0.775 + 1.265) / 2, Wang and Su (2008)
    ]
    assert definition.combination is Combination.SUM_OF_RMS


def test_the_road_velocity_of_the_paper():
    """Wang and Su (2008): F = 2 pi sqrt(V kappa) with V = 25 m/s and kappa = 5e-7 m^3/cycle."""
    assert ROAD.velocity_intensity == pytest.approx(2.0 * np.pi * np.sqrt(12.5e-6), rel=1e-15)


@pytest.mark.parametrize(
    ("mass", "damper", "remedy"),
    [
        (250.0, 1e-27, "Omit such a small element."),
        (250.0, 1e30, "Replace such a large element by a rigid joint."),
        (1e-27, 3e3, "Omit such a small inertia."),
        (1e30, 3e3, "Fix such a heavy body to the ground."),
    ],
)
def test_a_size_beyond_double_precision_is_refused_with_its_own_remedy(mass, damper, remedy):
    body = Mechanism((Coordinate("body", mass),), (Strut("s", k | Damper(damper), {"body": 1.0}, GROUND),))
    with pytest.raises(MechanismError) as refused:
        piecewise(body)
    assert str(refused.value).endswith(remedy)
