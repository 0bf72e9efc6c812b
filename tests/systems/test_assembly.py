"""Assembly against a nodal solve that shares no code with it, and the laws that any mechanism obeys."""

import numpy as np
import pytest
from campaigns import sampled
from nodal import Nodal, eliminate
from strategies import random_half_car, random_network, random_quarter_car
from wang_su import J1, paper_half_car, paper_quarter_car

from inerter import (
    GROUND,
    Coordinate,
    Damper,
    Force,
    Friction,
    Gap,
    Inerter,
    Mechanism,
    Norm,
    RoadInput,
    Spring,
    Strut,
    Tyre,
    evaluate,
    frequency_response,
    hinf_norm,
    state_space,
)
from inerter.errors import LinearSystemError, StatusKind
from inerter.norms.stability import stability

QUARTER = ("sprung_acceleration", "sprung_displacement", "tyre_load")
HALF = (
    "sprung_acceleration",
    "pitch_acceleration",
    "sprung_displacement",
    "tyre_front_load",
    "tyre_rear_load",
)


def solved(system, omega):
    """C (j omega - A)^-1 B + D by elimination in extended precision: what the matrices say, without rounding."""
    s = 1j * np.asarray(omega, np.clongdouble)[:, None, None]
    n = system.order
    B = np.broadcast_to(system.B.astype(np.clongdouble), (s.size, *system.B.shape)).copy()
    X = eliminate(s * np.eye(n) - system.A, B) if n else B
    return np.einsum("pn,fnm->fpm", system.C.astype(np.clongdouble), X) + system.D


def difference(G, mechanism, inputs, outputs, omega):
    """Largest difference from the nodal solve.

    Relative to the larger response of the output at that frequency to any input of the same kind: what one axle's road
    does to the other axle's tyre may be billions of times less than what its own road does.
    """
    nodal, worst = Nodal(mechanism, omega), 0.0
    roads = {road.name for road in mechanism.roads}
    for i, output in enumerate(outputs):
        expected = np.array([nodal.response(output, name) for name in inputs]).T
        for kind in (True, False):
            columns = [j for j, name in enumerate(inputs) if (name in roads) is kind]
            if columns:
                size = np.abs(expected[:, columns]).max(axis=1)
                error = np.abs(G[:, i, columns] - expected[:, columns]).max(axis=1)
                worst = max(worst, float(np.max(error / size)))
    return worst


def random_frequencies(rng, count=10):
    """From 0.01 to 1000 Hz, at random, so that no undamped resonance is hit."""
    return 2 * np.pi * 10 ** rng.uniform(-2, 3, count)


def mismatch(car, outputs, omega, response=frequency_response):
    system = state_space(car, outputs=outputs)
    return difference(response(system, omega), car.mechanism(), system.inputs, outputs, omega)


@pytest.mark.parametrize("chunk", sampled(range(10), often=[0], kept=0))
def test_five_hundred_random_networks_in_both_cars(chunk):
    for seed in range(50 * chunk, 50 * chunk + 50):
        rng = np.random.default_rng(seed)
        front, rear = random_network(rng), random_network(rng)
        for car, outputs in ((paper_quarter_car(front), QUARTER), (paper_half_car(front, rear), HALF)):
            assert mismatch(car, outputs, random_frequencies(rng), solved) < 1e-9, seed


@pytest.mark.parametrize("chunk", sampled(range(4), [0], often=[1], kept=0))
def test_random_networks_in_random_cars_by_the_public_frequency_response(chunk):
    for seed in range(1000 + 25 * chunk, 1000 + 25 * chunk + 25):
        rng = np.random.default_rng(seed)
        front, rear = random_network(rng), random_network(rng)
        for car, outputs in ((random_quarter_car(rng, front), QUARTER), (random_half_car(rng, front, rear), HALF)):
            assert mismatch(car, outputs, random_frequencies(rng)) < 1e-9, seed


k, c, b = Spring(4e4), Damper(2e3), Inerter(60.0)
DEGENERATE = {
    "no spring": c,
    "no damper": k,
    "inerter alone": b,
    "k - k": k - Spring(1e5),
    "b - b": b - Inerter(20.0),
    "c - c": c - Damper(5e3),
    "k - b": k - b,
    "k - c": k - c,
    "twins": k | k | c | c | b | b,
    "twin branches": (k - c) | (k - c) | (k - c),
    "k - k - k": Spring(1e5) - Spring(2e5) - Spring(3e5) | c,
    "b - b - b": Inerter(10.0) - Inerter(20.0) - Inerter(30.0) | k | c,
    "b - b beside itself": (b - Inerter(20.0)) | (Inerter(5.0) - Inerter(9.0)) | k | c,
    "chain of chains": (k - Spring(1e5) | b - Inerter(5.0)) - (c - Damper(1e3) | k - c) | k,
    "delta of springs": ((k | Spring(1e3) - Spring(2e3)) - Spring(5e4)) | c,
    "series of twins": (k | Spring(1e5)) - (k | Spring(3e5)) | (c | c) - (c | c) | (b | b) - (b | b),
}


@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate_struts_in_both_cars(name):
    strut, rng = DEGENERATE[name], np.random.default_rng(0)
    for car, outputs in ((paper_quarter_car(strut), QUARTER), (paper_half_car(strut, strut), HALF)):
        assert mismatch(car, outputs, random_frequencies(rng, 40)) < 1e-9


@pytest.mark.parametrize(
    ("strut", "order"),
    [
        (k | c, 4),
        (k | c | b, 4),
        (k | c - b, 5),
        (k | (Spring(1e6) | Damper(3200.0)) - b | c, 6),
        (k - Spring(1e5) | c, 4),  # two springs in series are one
        (k | Spring(1e3) | c, 4),  # and side by side too
        (k | c - Damper(1e3), 4),
        (k | c | b - Inerter(20.0), 4),  # the node between two inerters is no state
        (k | c | Inerter(5.0) - Inerter(20.0) - Inerter(7.0), 4),
        (k | k - c, 5),
        (k | (k - c) | (k - c), 6),
        (k | c | k - b, 6),
        (k | c | k - c - b, 6),
        (k | c | (k - Spring(1e5)) - c - Damper(1e3) - (b - Inerter(20.0)), 6),
        (c, 3),  # the travel of a strut without a spring is no state
        (b | c, 3),
    ],
)
def test_no_more_states_than_energies(strut, order):
    assert state_space(paper_quarter_car(strut), "road").order == order


@pytest.mark.parametrize("strut", [b, b - Inerter(20.0), k, k - Spring(1e5), b | k])
def test_chains_of_one_kind_make_no_motion_of_their_own(strut):
    """A free node or a sum of elongations that stays constant would show up as a pole at zero."""
    poles = np.linalg.eigvals(state_space(paper_quarter_car(strut), "road").A)
    assert np.abs(poles).min() > 1.0


def twice(strut):
    return state_space(paper_quarter_car(strut), outputs=QUARTER)


@pytest.mark.parametrize(
    ("one", "same"),
    [
        (k - Spring(6e4) | c, Spring(4e4 * 6e4 / 10e4) | c),
        (k | c - Damper(3e3), k | Damper(1.2e3)),
        (k | c | b - Inerter(30.0), k | c | Inerter(20.0)),
        (k | k | c, Spring(8e4) | c),
        (k | c - b, k | b - c),
        (k | (c | Damper(1e3)) - b, k | Damper(3e3) - b),
    ],
)
def test_equivalent_networks_make_equivalent_systems(one, same):
    omega = np.geomspace(0.1, 1e4, 50)
    np.testing.assert_allclose(frequency_response(twice(one), omega), frequency_response(twice(same), omega), rtol=1e-8)


def three_axles(front, middle, rear):
    """A rigid body on three axles, one of them a bogie lever, a dynamic absorber, a strut to the ground, soft tyres."""
    return Mechanism(
        coordinates=(
            Coordinate("body", 900.0),
            Coordinate("pitch", 700.0, angle=True),
            Coordinate("lever", 8.0, angle=True),
            Coordinate("first", 30.0),
            Coordinate("second", 25.0),
            Coordinate("third", 27.0),
            Coordinate("absorber", 12.0),
        ),
        struts=(
            Strut("front", front, upper={"body": 1.0, "pitch": 1.3}, lower={"first": 1.0}),
            Strut("middle", middle, upper={"body": 1.0, "pitch": -0.4, "lever": 0.25}, lower={"second": 1.0}),
            Strut("rear", rear, upper={"body": 1.0, "pitch": -1.1, "lever": -0.35}, lower={"third": 1.0}),
            Strut("stop", Spring(3e3) | Damper(50.0), upper={"lever": 1.0}, lower={"pitch": 1.0}),
            Strut("tuned", Spring(2e4) | Inerter(3.0), upper={"absorber": 1.0}, lower={"first": 1.0}),
            Strut("sky", Damper(800.0) - Inerter(500.0), upper={"body": 1.0}, lower=GROUND),
        ),
        tyres=(
            Tyre("tyre1", Spring(2e5) | Damper(60.0), {"first": 1.0}, "road1"),
            Tyre("tyre2", Spring(1.5e5) - Spring(2e6), {"second": 1.0}, "road2"),
            Tyre("tyre3", Spring(1.8e5) | Damper(40.0) - Spring(1e5), {"third": 1.0}, "road3"),
        ),
        roads=(RoadInput("road1"), RoadInput("road2", distance=1.7), RoadInput("road3", distance=2.4)),
        forces=(Force("load", {"body": 1.0, "pitch": 0.5}), Force("push", {"third": -1.0})),
    )


OUTPUTS = (
    *(f"{name}_acceleration" for name in ("body", "pitch", "lever", "first", "absorber")),
    *(f"{name}_velocity" for name in ("body", "third")),
    *(f"{name}_displacement" for name in ("body", "absorber")),
    *(f"{name}_travel" for name in ("front", "rear", "sky")),
    *(f"{name}_force" for name in ("front", "middle", "rear", "stop", "tuned", "sky")),
    *(f"tyre{i}_load" for i in (1, 2, 3)),
    *(f"tyre{i}_deflection" for i in (1, 2, 3)),
)


@pytest.mark.parametrize("seed", range(12))
def test_any_mechanism_agrees_with_the_nodal_solve(seed):
    rng = np.random.default_rng(seed)
    mechanism = three_axles(*(random_network(rng, depth=2, most=5) for _ in range(3)))
    omega = random_frequencies(rng, 30)
    system = state_space(mechanism, outputs=OUTPUTS)
    assert difference(frequency_response(system, omega), mechanism, system.inputs, OUTPUTS, omega) < 1e-8


@pytest.mark.parametrize("seed", sampled(range(30), range(10), kept=10))
def test_no_passive_mechanism_is_unstable(seed):
    rng = np.random.default_rng(seed)
    for car in (random_quarter_car(rng, random_network(rng)), three_axles(*(random_network(rng) for _ in range(3)))):
        assert stability(state_space(car)).kind is not StatusKind.UNSTABLE


@pytest.mark.parametrize("seed", range(10))
def test_responses_are_reciprocal(seed):
    """The displacement at A for a force at B is that at B for a force at A (Maxwell and Betti)."""
    rng = np.random.default_rng(seed)
    car = random_half_car(rng, Spring(3e4) | random_network(rng), Spring(4e4) | random_network(rng))
    system = state_space(car, ["sprung_force", "pitch_moment"], ["sprung_displacement", "pitch_displacement"])
    G = solved(system, random_frequencies(rng))
    scale = np.sqrt(np.abs(G[:, 0, 0] * G[:, 1, 1]))
    assert np.max(np.abs(G[:, 0, 1] - G[:, 1, 0]) / scale) < 1e-9


def test_at_rest_the_tyres_carry_the_load():
    car = paper_half_car(k | c | b, Spring(3e4) | c - b)
    G = frequency_response(state_space(car, "sprung_force", ["tyre_front_load", "tyre_rear_load"]), 0.0)[0, :, 0]
    assert G.sum() == pytest.approx(1.0, rel=1e-10)  # in tension against an upward force
    assert G[0] * car.distance_front == pytest.approx(G[1] * car.distance_rear, rel=1e-10)


def test_at_rest_a_force_is_carried_by_the_springs_in_series():
    system = state_space(paper_quarter_car(k | c - b), "sprung_force", "sprung_displacement")
    assert frequency_response(system, 0.0)[0, 0, 0] == pytest.approx(1 / 4e4 + 1 / 120e3, rel=1e-12)


def test_at_low_speed_the_car_follows_the_road():
    system = state_space(
        paper_half_car(k | c, k | c), ["road_front", "road_rear"], ["sprung_velocity", "pitch_velocity"]
    )
    G = frequency_response(system, 1e-9)[0].real
    np.testing.assert_allclose(G.sum(axis=1), [1.0, 0.0], atol=1e-9)


def test_a_force_on_an_inerter_alone_meets_the_mass_and_the_inertance():
    system = state_space(paper_quarter_car(b), "sprung_force", "sprung_acceleration")
    expected = 1 / (181.75 + 60.0 * 25.0 / 85.0)  # far above the tyre's resonance
    assert abs(frequency_response(system, 1e6)[0, 0, 0]) == pytest.approx(expected, rel=1e-6)


def test_what_linear_analysis_leaves_out_is_noted():
    screw = (Spring(1e6, "ks") | Damper(3200.0)) - Gap(1e-4, "play") - (b | Friction(10.0, "f"))
    system = state_space(paper_quarter_car(k | c | screw | Damper(1.0, "idler") - Friction(2.0, "slip")))
    for words in ("friction 'f' and 'slip' in 'strut'", "gap 'play'", "'idler'"):
        assert any(words in note for note in system.notes)
    plain = state_space(paper_quarter_car(k | c | (Spring(1e6) | Damper(3200.0)) - b))
    np.testing.assert_allclose(
        np.sort_complex(np.linalg.eigvals(system.A)), np.sort_complex(np.linalg.eigvals(plain.A))
    )


def test_names_are_one_to_one_with_rows_and_columns():
    system = state_space(three_axles(k | c - b, k | c - b, k - Spring(5.0) | c - b))
    assert len(set(system.states)) == system.order
    assert system.B.shape == (system.order, len(system.inputs))
    assert system.C.shape == (len(system.outputs), system.order)


def test_springs_that_share_a_chain_make_states_of_different_names():
    strut = ((k - c) | (k - b) | Spring(2e4)) - Spring(3e3) | c
    assert len(set(state_space(paper_quarter_car(strut)).states)) == state_space(paper_quarter_car(strut)).order


def test_inputs_and_outputs_come_in_the_order_asked_for():
    car = paper_half_car(k | c, k | c)
    whole = state_space(car)
    inputs, outputs = ["pitch_moment", "road_front"], ["tyre_rear_load", "sprung_velocity"]
    part = state_space(car, inputs, outputs)
    assert (list(part.inputs), list(part.outputs)) == (inputs, outputs)
    np.testing.assert_allclose(
        frequency_response(part, [3.0, 30.0]),
        frequency_response(whole.subsystem(inputs, outputs), [3.0, 30.0]),
        rtol=1e-9,
    )


def test_a_road_that_is_no_input_lies_still():
    car = paper_half_car(k | c, k | c)
    alone = state_space(car, "road_front", "tyre_rear_load")
    assert hinf_norm(alone).value == pytest.approx(
        hinf_norm(state_space(car).subsystem("road_front", "tyre_rear_load")).value
    )


def test_a_second_system_of_units_changes_no_response():
    """Masses in t, lengths in mm and forces in N: a displacement per force is then 1000 times larger."""
    si = frequency_response(
        state_space(paper_quarter_car(k | c - b), "sprung_force", "sprung_displacement"), [1.0, 10.0, 99.0]
    )
    car = type(paper_quarter_car(k))(0.18175, 0.025, 120.0, Spring(40.0) | Damper(2.0) - Inerter(0.060))
    mm = frequency_response(state_space(car, "sprung_force", "sprung_displacement"), [1.0, 10.0, 99.0])
    np.testing.assert_allclose(mm, 1000.0 * si, rtol=1e-11)


def test_unknown_inputs_and_outputs_are_refused_with_the_known_ones():
    with pytest.raises(LinearSystemError, match=r"Unknown output 'nose_load'.*tyre_front_load"):
        state_space(paper_half_car(k | c, k | c), outputs=["nose_load"])
    with pytest.raises(LinearSystemError, match=r"Unknown input 'wind'.*road_rear"):
        state_space(paper_half_car(k | c, k | c), inputs=["wind"])


def test_matrices_without_a_certain_digit_are_refused_and_the_indices_are_there_all_the_same():
    strut = Spring(1e5) | Damper(1e3) - Inerter(1e300)
    car = paper_quarter_car(strut)
    with pytest.raises(LinearSystemError, match="no digit of its matrices is certain"):
        state_space(car)
    rigid = paper_quarter_car(Spring(1e5) | Damper(1e3))  # so heavy an inerter is a fixed end
    comfort = J1
    assert evaluate(car, comfort, Norm()).value == pytest.approx(evaluate(rigid, comfort, Norm()).value, rel=1e-9)
