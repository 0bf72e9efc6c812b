"""Bridges: Kirchhoff's nodal equations, arms that are open or rigid, and their expressions."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from campaigns import sampled
from hypothesis import given
from hypothesis import strategies as st
from nodal import Nodal
from quadrature import h2_by_quadrature
from strategies import logarithmic, networks, random_network
from wang_su import paper_quarter_car

import inerter as it
from inerter import Bridge, Coordinate, Damper, Force, Friction, Gap, Inerter, Mechanism, Spring, Strut
from inerter.app.answers import tree_of
from inerter.app.parts import parse_network
from inerter.errors import NetworkError
from inerter.networks.elements import Network, Parallel, Series
from inerter.networks.parser import format_expression, names, rename_in_expression
from inerter.networks.transform import linearise, map_elements
from inerter.systems.graph import full_graph, linear_graph

S = 1j * np.geomspace(1e-2, 1e4, 25)
ARMS = "abcde"
OPEN, RIGID = Friction(1.0), Gap(1e-3)


def random_bridge(rng: np.random.Generator, depth: int = 2) -> Bridge:
    """A bridge whose arms are networks, some of them bridges."""
    arms = [random_bridge(rng, depth - 1) if depth and rng.random() < 0.15 else random_network(rng, 2, 3) for _ in ARMS]
    return Bridge(*arms)


def nodal_admittance(network: Network, s: complex) -> complex:
    """Force over velocity by the nodal matrix, each node a row, solved with the lower end held."""
    nodes = 2
    placed: list[tuple[complex, int, int]] = []

    def place(part: Network, upper: int, lower: int) -> None:
        nonlocal nodes
        if isinstance(part, Parallel):
            for each in part.parts:
                place(each, upper, lower)
        elif isinstance(part, Series):
            ends = [upper, *range(nodes, nodes + len(part.parts) - 1), lower]
            nodes += len(part.parts) - 1
            for each, one, other in zip(part.parts, ends[:-1], ends[1:], strict=True):
                place(each, one, other)
        elif isinstance(part, Bridge):
            left, right = nodes, nodes + 1
            nodes += 2
            place(part.a, upper, left)
            place(part.b, left, lower)
            place(part.c, upper, right)
            place(part.d, right, lower)
            place(part.e, left, right)
        else:
            law = {Spring: part.value / s, Damper: part.value, Inerter: part.value * s}
            placed.append((law[type(part)], upper, lower))

    place(network, 0, 1)
    Y = np.zeros((nodes, nodes), dtype=np.clongdouble)
    for value, one, other in placed:
        Y[[one, other], [one, other]] += value
        Y[[one, other], [other, one]] -= value
    inner = np.arange(2, nodes)
    K = Y[np.ix_(inner, inner)]
    scale = np.sqrt(np.abs(np.diag(K)))
    inverse = np.linalg.solve((K / np.outer(scale, scale)).astype(complex), np.diag(1.0 / scale).astype(complex))
    inverse = np.diag(1.0 / scale) @ inverse
    for _ in range(2):
        inverse = inverse + inverse @ (np.eye(len(inner)) - K @ inverse)
    return complex(Y[0, 0] - Y[0, inner] @ inverse @ Y[inner, 0])


@pytest.mark.parametrize("seed", range(200))
def test_the_admittance_is_that_of_the_nodal_equations(seed):
    rng = np.random.default_rng(seed)
    bridge = random_bridge(rng)
    network = bridge if rng.random() < 0.5 else random_network(rng, 2, 3) | bridge
    points = [0.3, 2.0 + 5.0j, 40.0 + 1.0j, 300.0]
    expected = np.array([nodal_admittance(network, s) for s in points])
    np.testing.assert_allclose(network.admittance(points), expected, rtol=1e-10)


def series_parallel(arm: str, lost: Network, a: Network, b: Network, c: Network, d: Network, e: Network) -> Network:
    """The bridge without one arm, drawn by hand."""
    open_arm = {
        "a": lambda: c - (d | e - b),
        "b": lambda: (a - e | c) - d,
        "c": lambda: a - (b | e - d),
        "d": lambda: (a | c - e) - b,
        "e": lambda: a - b | c - d,
    }
    rigid_arm = {
        "a": lambda: b | (e | c) - d,
        "b": lambda: a | c - (e | d),
        "c": lambda: d | (e | a) - b,
        "d": lambda: c | a - (e | b),
        "e": lambda: (a | c) - (b | d),
    }
    return (open_arm if lost is OPEN else rigid_arm)[arm]()


@pytest.mark.parametrize("lost", [OPEN, RIGID])
@pytest.mark.parametrize("arm", ARMS)
@given(arms=st.tuples(*[networks(2, 4)] * 5))
def test_an_open_or_a_rigid_arm_leaves_a_series_parallel_network(arm, lost, arms):
    given_arms = dict(zip(ARMS, arms, strict=True))
    bridge = Bridge(**{**given_arms, arm: lost})
    expected = series_parallel(arm, lost, **given_arms).admittance(S)
    np.testing.assert_allclose(bridge.admittance(S), expected, rtol=1e-12)
    left = linearise(bridge)
    np.testing.assert_allclose(left.network.admittance(S), expected, rtol=1e-12)
    assert left.idle == ()


def lose_some(draw, network):
    return map_elements(network, lambda element: draw(st.sampled_from([element, element, OPEN, RIGID])))


@st.composite
def bridges_with_losses(draw):
    return lose_some(draw, Bridge(*(draw(networks(1, 3)) for _ in ARMS)))


@given(bridges_with_losses())
def test_any_arms_may_be_open_or_rigid(bridge):
    """Against arms that are almost open or rigid."""
    almost = map_elements(
        bridge, lambda e: Damper(1e-30) if isinstance(e, Friction) else Damper(1e30) if isinstance(e, Gap) else e
    )
    limit, left = complex(nodal_limit(almost)), linearise(bridge)
    found = complex(bridge.admittance(2.0))
    if left.network is None:
        assert found == (float("inf") if left.rigid else 0.0)
        assert abs(limit) > 1e20 if left.rigid else abs(limit) < 1e-20
    else:
        assert found == pytest.approx(complex(left.network.admittance(2.0)), rel=1e-12)
        assert found == pytest.approx(limit, rel=1e-9)


def nodal_limit(network: Network) -> complex:
    """The admittance at s = 2 by eliminating node after node in exact numbers."""
    nodes, edges = 2, list[tuple[Fraction, int, int]]()

    def place(part: Network, upper: int, lower: int) -> None:
        nonlocal nodes
        if isinstance(part, Bridge):
            left, right = nodes, nodes + 1
            nodes += 2
            ends = ((upper, left), (left, lower), (upper, right), (right, lower), (left, right))
            for arm, (one, other) in zip((part.a, part.b, part.c, part.d, part.e), ends, strict=True):
                place(arm, one, other)
        elif isinstance(part, Parallel):
            for each in part.parts:
                place(each, upper, lower)
        elif isinstance(part, Series):
            ends_ = [upper, *range(nodes, nodes + len(part.parts) - 1), lower]
            nodes += len(part.parts) - 1
            for each, one, other in zip(part.parts, ends_[:-1], ends_[1:], strict=True):
                place(each, one, other)
        else:
            power = {Spring: Fraction(1, 2), Damper: Fraction(1), Inerter: Fraction(2)}[type(part)]
            edges.append((Fraction(part.value) * power, upper, lower))

    place(network, 0, 1)
    for node in range(2, nodes):  # star to mesh
        star = [(y, other if one == node else one) for y, one, other in edges if node in (one, other)]
        edges = [edge for edge in edges if node not in edge[1:]]
        total = sum(y for y, _ in star)
        edges += [
            (y * y2 / total, one, other)
            for i, (y, one) in enumerate(star)
            for y2, other in star[i + 1 :]
            if one != other
        ]
    return float(sum((y for y, one, other in edges if {one, other} == {0, 1}), Fraction(0)))


@given(st.tuples(*[logarithmic(1e-60, 1e60)] * 5))
def test_values_may_be_far_apart(values):
    bridge = Bridge(*map(Damper, values))
    assert bridge.admittance(2.0).real == pytest.approx(nodal_limit(bridge), rel=1e-14)


@given(st.tuples(*[networks(2, 4)] * 5))
def test_a_bridge_is_the_same_from_either_side_and_upside_down(arms):
    a, b, c, d, e = arms
    expected = Bridge(a, b, c, d, e).admittance(S)
    for same in (Bridge(c, d, a, b, e), Bridge(b, a, d, c, e)):
        np.testing.assert_allclose(same.admittance(S), expected, rtol=1e-12)


@given(st.tuples(*[networks(2, 4)] * 5), st.floats(0.1, 100.0), st.floats(-100.0, 100.0))
def test_a_bridge_absorbs_power(arms, real, imaginary):
    Y = Bridge(*arms).admittance(complex(real, imaginary))
    assert Y.real > -1e-12 * abs(Y)


def test_idle_elements_of_a_bridge_are_listed():
    k, c, b, k2 = Spring(1e4, "k"), Damper(2e3, "c"), Inerter(50.0, "b"), Spring(2e4, "k2")
    assert linearise(Bridge(k, OPEN, c, b, OPEN)).idle == ("k",)
    assert linearise(Bridge(RIGID, k, RIGID, b, k2)).idle == ("k2",)
    assert linearise(Bridge(OPEN, k, OPEN, b, k2)).network is None


INNER = ({"a": 1.0, "b": -1.0, "e": -1.0}, {"c": 1.0, "d": -1.0, "e": 1.0})  # forces on the left and right node


@pytest.mark.parametrize("lost", [OPEN, RIGID])
@pytest.mark.parametrize("arm", ARMS)
def test_forces_keep_their_signs_in_linear_analysis(arm, lost):
    """They balance at all nodes of the bridge as it is drawn; the force of a rigid arm follows at one of them."""
    arms = {
        n: Parallel((Spring(1e4 * (i + 1), f"k{n}"), Damper(100.0 * (i + 2), f"c{n}")), name=f"arm_{n}")
        for i, n in enumerate(ARMS)
    }
    bridge = replace(Bridge(**{**arms, arm: lost}), name="whole")
    car = paper_quarter_car(bridge | Damper(300.0, "c")).mechanism()
    rest = [n for n in ARMS if n != arm]
    names = [
        "whole_force",
        "strut_force",
        "c_force",
        *(f"{kind}{n}_force" for kind in ["k", "c", "arm_"] for n in rest),
    ]
    found = it.frequency_response(it.state_space(car, outputs=names), [7.0])[0, :, 0]
    whole, strut, c, *several = found
    k, d, groups = np.array(several).reshape(3, 4)
    np.testing.assert_allclose(groups, k + d, rtol=1e-10)
    assert whole + c == pytest.approx(strut, rel=1e-10)
    force = dict(zip(rest, groups, strict=True))
    node = next(node for node in INNER if arm in node)
    force[arm] = 0.0 if lost is OPEN else -node[arm] * sum(force[n] * node[n] for n in node if n != arm)
    for one in INNER:
        assert sum(force[n] * one[n] for n in one) == pytest.approx(0.0, abs=1e-10 * abs(whole))
    assert force["a"] + force["c"] == pytest.approx(whole, rel=1e-10)
    assert force["b"] + force["d"] == pytest.approx(whole, rel=1e-10)


def test_the_force_of_a_bridge_whose_arms_b_and_c_are_rigid_is_the_sum_of_the_others():
    springs = {n: Spring(1e4 * (i + 1), f"k{n}") for i, n in enumerate("ade")}
    bridge = Bridge(springs["a"], RIGID, RIGID, springs["d"], springs["e"])
    car = paper_quarter_car(bridge | Damper(1e3, "c"))
    system = it.state_space(car, outputs=["strut_force", "ka_force", "kd_force", "ke_force", "c_force"])
    force, a, d, e, c = it.frequency_response(system, [5.0])[0, :, 0]
    assert a + d - e + c == pytest.approx(force, rel=1e-12)
    assert e / d == pytest.approx(-springs["e"].value / springs["d"].value, rel=1e-12)
    assert linear_graph(car.mechanism()).nodes == ("sprung", "unsprung")
    assert len(full_graph(car.mechanism()).nodes) == 4


@pytest.mark.parametrize("seed", range(20))
def test_the_response_of_a_mechanism_is_that_of_its_admittance(seed):
    """A mass on a bridge: the velocity under a unit force is 1 / (m s + Y)."""
    rng = np.random.default_rng(seed)
    bridge = random_bridge(rng, 1) | Spring(2e3) | Damper(50.0)
    mass = Mechanism((Coordinate("body", 100.0),), (Strut("strut", bridge, {"body": 1.0}, {}),), forces=(BODY,))
    omega = np.geomspace(0.5, 200.0, 9)
    found = it.frequency_response(it.state_space(mass, outputs=["body_velocity"]), omega)[:, 0, 0]
    np.testing.assert_allclose(found, 1.0 / (1j * omega * 100.0 + bridge.admittance(1j * omega)), rtol=1e-8)


BODY = Force("push", {"body": 1.0})


def test_static_stiffness_of_a_bridge_of_springs_and_its_gradient():
    values = {"ka": 1e4, "kb": 3e4, "kc": 2e4, "kd": 1.5e4, "ke": 5e4}
    bridge = Bridge(*(Spring(it.free(1e3, 1e5, name)) for name in values))
    stiffness = it.static_stiffness("strut")
    whole = stiffness.as_objective(paper_quarter_car(bridge), it.Norm())
    point = np.array(list(values.values()))
    value, gradient = whole.value_and_gradient(point)
    assert value == pytest.approx(nodal_admittance(Bridge(*map(Spring, values.values())), 1.0).real, rel=1e-12)
    for i in range(5):
        step = np.eye(5)[i] * 1e-4 * point
        both = whole.values(np.array([point + step, point - step]))
        assert gradient[i] == pytest.approx((both[0] - both[1]) / (2.0 * step[i]), rel=1e-6)


PARTS = {
    "k": Spring(1e5, "k"),
    "c": Damper(2e3, "c"),
    "b": Inerter(30.0, "b"),
    "f": Friction(5.0, "f"),
    "bridge": Spring(2e5, "bridge"),
}
expressions = st.recursive(
    st.sampled_from(list(PARTS)),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["|", " - "]), inner).map("".join),
        inner.map(lambda text: f"({text})"),
        st.tuples(st.sampled_from(["bridge(", "bridge  ( "]), st.tuples(*[inner] * 5).map(" , ".join)).map(
            lambda two: f"{two[0]}{two[1]})"
        ),
    ),
    max_leaves=14,
)


@given(expressions)
def test_an_expression_is_read_written_and_read_again(text):
    network = it.network(text, **PARTS)
    labels = [element.label for element in network.elements()]
    written = format_expression(network, labels)
    assert it.network(written, **PARTS) == network
    assert format_expression(it.network(written, **PARTS), labels) == written
    assert set(names(text)) == set(labels)


@given(expressions)
def test_an_expression_with_other_names_is_the_network_with_other_names(text):
    others = {"k": "c", "c": "bridge", "bridge": "k1"}
    renamed = rename_in_expression(text, others)
    after = {others.get(name, name): part for name, part in PARTS.items()}
    assert it.network(renamed, **after) == it.network(text, **PARTS)


def test_the_page_gets_the_tree_of_a_bridge_with_places():
    found = parse_network("k | bridge(k, c - b, f, k, c)", PARTS)
    spring, bridge = found["tree"]["parts"]
    assert (spring["kind"], bridge["kind"], len(bridge["parts"])) == ("element", "bridge", 5)
    assert (bridge["from"], bridge["to"], bridge["parts"][1]["kind"]) == (4, 29, "series")
    assert found["names"] == ["k", "c", "b", "f"]
    assert tree_of(it.network("bridge(k, c, b, f, k)", **PARTS))["kind"] == "bridge"


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        ("bridge(k, c, b, f)", 18, "',' expected here, as a bridge has 5 arms"),
        ("bridge(k, c, b, f, k, c)", 21, "')' expected here"),
        ("bridge()", 8, "element name or '(' expected here"),
        ("k | bridge(k, c | , b, f, k)", 19, "element name or '(' expected here"),
        ("k, c", 2, "'|', '-' or the end expected here"),
        ("bridge(k, c, b, x, k)", 17, "undefined element 'x'"),
        ("bridge(k, c, b, f, k", 21, "')' expected here"),
    ],
)
def test_an_error_in_a_bridge_names_its_column(text, column, words):
    with pytest.raises(NetworkError) as refusal:
        it.network(text, **PARTS)
    assert f"column {column}:" in str(refusal.value)
    assert words in str(refusal.value)


def test_an_arm_must_be_a_network():
    with pytest.raises(NetworkError, match="Expected an element or a network"):
        Bridge(Spring(1.0), Spring(1.0), 3.0, Spring(1.0), Spring(1.0))


@pytest.mark.parametrize("seed", sampled(range(3), [1], kept=1))
def test_norms_of_a_car_on_a_bridge_by_quadrature(seed):
    rng = np.random.default_rng(100 + seed)
    car = paper_quarter_car(Spring(2e4) | Bridge(*(random_network(rng, 1, 2) for _ in ARMS)) | Damper(1e3))
    nodal = lambda omega: Nodal(car.mechanism(), omega)  # noqa: E731
    for output in ("sprung_acceleration", "tyre_load"):
        norm = it.h2_norm(it.state_space(car, inputs=["road"], outputs=[output]))
        assert norm == pytest.approx(
            h2_by_quadrature(lambda w, o=output: nodal(w).response(o, "road")[:, None].astype(complex), [0.0], 2e4),
            rel=1e-7,
        )
