"""One road at several axles: the exact norm against quadrature, the Pade norm against the approximant's own states."""

import math
from functools import cache
from itertools import pairwise, product

import numpy as np
import pytest
from campaigns import sampled
from nodal import Nodal
from quadrature import h2_by_quadrature
from strategies import random_half_car, random_stable
from wang_su import paper_half_car

from inerter import (
    Coordinate,
    Damper,
    Inerter,
    LinearSystem,
    Mechanism,
    RoadInput,
    Spring,
    Strut,
    Tyre,
    h2_norm,
    state_space,
)
from inerter.errors import LinearSystemError
from inerter.kernels.h2 import propagate_columns
from inerter.norms.delay import pade, propagate, transfer
from inerter.norms.exact import h2_exactly
from inerter.norms.h2 import h2

k, c, b = Spring(60e3), Damper(3000.0), Inerter(150.0)
STRUTS = {
    "S1": k | c,
    "S2": k | c | b,
    "S3": k | c - b,
    "S3 elastic": k | c - (Spring(1e6) | Damper(3200.0)) - b,
    "S2 elastic": k | c | (Spring(1e5) | Damper(300.0)) - b,
}
OUTPUTS = ("sprung_acceleration", "pitch_acceleration", "tyre_front_load", "tyre_rear_load")


def axles(mechanism, outputs):
    """For each output, its response to each road's velocity; what was computed once serves all outputs."""
    names = [road.name for road in mechanism.roads]

    @cache
    def everything(frequencies):
        nodal = Nodal(mechanism, np.frombuffer(frequencies))
        return {out: np.array([nodal.response(out, name) for name in names], complex).T for out in outputs}

    def axle(output):
        return lambda omega: everything(np.ascontiguousarray(omega).tobytes())[output]

    return {output: axle(output) for output in outputs}


@pytest.mark.parametrize(
    ("name", "speed"), sampled(product(STRUTS, [25.0, 7.0]), [(name, 25.0) for name in STRUTS], kept=3)
)
def test_half_car_with_the_exact_delay(name, speed):
    car = paper_half_car(STRUTS[name], STRUTS[name])
    delays = [0.0, (car.distance_front + car.distance_rear) / speed]
    system = state_space(car, ["road_front", "road_rear"], OUTPUTS).with_delays("road", delays)
    exact, responses = h2(system).outputs, axles(car.mechanism(), OUTPUTS)
    for i, output in enumerate(OUTPUTS):
        expected = h2_by_quadrature(responses[output], delays, edge=4000.0)
        assert exact[i] == pytest.approx(expected, rel=1e-9), output


def three_axles(strut):
    """Three axles under one rigid body: statically indeterminate, so that a slow road profile prestresses the tyres."""
    arms = (1.2, -0.3, -1.5)
    return Mechanism(
        coordinates=(
            Coordinate("body", 700.0),
            Coordinate("pitch", 500.0, angle=True),
            *(Coordinate(f"wheel{i}", 20.0 + i) for i in range(3)),
        ),
        struts=tuple(
            Strut(f"strut{i}", strut, upper={"body": 1.0, "pitch": arm}, lower={f"wheel{i}": 1.0})
            for i, arm in enumerate(arms)
        ),
        tyres=tuple(Tyre(f"tyre{i}", Spring(110e3 + 5e3 * i), {f"wheel{i}": 1.0}, f"road{i}") for i in range(3)),
        roads=tuple(RoadInput(f"road{i}", distance=1.2 - arm) for i, arm in enumerate(arms)),
    )


@pytest.mark.parametrize("name", sampled(["S1", "S2", "S3"], ["S3"]))
def test_three_axles_two_delays_and_a_drift_that_cancels(name):
    """Each road alone would stress the tyres without bound; one road that reaches all axles does not."""
    mechanism = three_axles(STRUTS[name])
    delays = [road.distance / 20.0 for road in mechanism.roads]
    outputs = ["body_acceleration", "pitch_acceleration", "tyre0_load", "tyre1_load", "tyre2_load"]
    system = state_space(mechanism, outputs=outputs).with_delays("road", delays)
    result, responses = h2(system), axles(mechanism, outputs)
    assert result.status.ok
    for i, output in enumerate(outputs):
        expected = h2_by_quadrature(responses[output], delays, edge=4000.0)
        assert result.outputs[i] == pytest.approx(expected, rel=1e-8), output
        if output.endswith("load"):
            assert h2_norm(system.subsystem("road0", output)) == math.inf


def approximant(order, time):
    """State space of the diagonal Pade approximant of exp(-s time), from its coefficients, in controllable form."""
    coefficients = [
        math.factorial(2 * order - i) / (math.factorial(i) * math.factorial(order - i)) * time**i
        for i in range(order + 1)
    ]
    a = np.array(coefficients) / coefficients[-1]
    p = a * (-1.0) ** np.arange(order + 1)
    A = np.diag(np.ones(order - 1), 1)
    A[-1] = -a[:-1]
    B = np.eye(order)[:, -1:]
    return A, B, (p[:-1] - p[-1] * a[:-1])[None, :], p[-1]


def with_chain(system, order, delays):
    """The system with a chain of approximants between its inputs: from one arrival of the road to the next."""
    A, B, C, D = system.A, system.B[:, :1].copy(), system.C, system.D[:, :1].copy()
    signal, direct = np.zeros((1, A.shape[0])), 1.0  # what arrives, in states and directly
    for j in range(1, system.B.shape[1]):
        a, b, c_, d = approximant(order, delays[j] - delays[j - 1])
        n, grown = A.shape[0], A.shape[0] + order
        A2 = np.zeros((grown, grown))
        A2[:n, :n], A2[n:, :n], A2[n:, n:] = A, b @ signal, a
        signal = np.hstack([d * signal, c_])
        B, direct = np.vstack([B, b * direct]), d * direct
        column = np.vstack([system.B[:, j : j + 1], np.zeros((grown - system.order, 1))])
        A, B = A2 + column @ signal, B + column * direct
        C = np.hstack([C, np.zeros((C.shape[0], order))]) + system.D[:, j : j + 1] @ signal
        D = D + system.D[:, j : j + 1] * direct
    return LinearSystem(A, B, C, D)


def by_kronecker(system):
    """Each state first in units that make its variance one, found by a first solve."""
    A, B, C = system.A, system.B, system.C
    for _ in range(2):
        eye = np.eye(A.shape[0])
        operator = np.kron(eye, A) + np.kron(A, eye)
        P = np.linalg.solve(operator, -(B @ B.T).ravel()).reshape(A.shape)
        size = np.sqrt(np.abs(np.diag(P)))
        A, B, C, P = A / size[:, None] * size, B / size[:, None], C * size, P / np.outer(size, size)
    return np.sqrt(np.diag(C @ P @ C.T))


@pytest.mark.parametrize("order", range(1, 7))
@pytest.mark.parametrize("name", ["S1", "S3"])
def test_half_car_with_a_pade_delay(order, name):
    car = paper_half_car(STRUTS[name], STRUTS[name])
    system = state_space(car, ["road_front", "road_rear"], OUTPUTS)
    delays = [0.0, 2.04 / 25.0]
    expected = by_kronecker(with_chain(system, order, delays))
    np.testing.assert_allclose(h2(system.with_delays("road", delays), order).outputs, expected, rtol=1e-9)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_two_pade_delays_in_a_chain(order):
    system = random_stable(np.random.default_rng(order), 6, 3, 2, 0.05)
    delays = [0.0, 0.3, 0.75]
    expected = by_kronecker(with_chain(system, order, delays))
    np.testing.assert_allclose(h2(system.with_delays("road", delays), order).outputs, expected, rtol=1e-9)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_norm_without_rounding_has_the_pade_delays_too(order):
    """A half car's road at two axles, from its transfer functions against the states of the approximant."""
    car = paper_half_car(STRUTS["S1"], STRUTS["S3"])
    system = state_space(car, ["road_front", "road_rear"], OUTPUTS)
    delays = [0.0, 2.04 / 25.0]
    found, status = h2_exactly(system.with_delays("road", delays), order)
    assert status.ok
    np.testing.assert_allclose(found, by_kronecker(with_chain(system, order, delays)), rtol=1e-8)


@pytest.mark.parametrize("order", range(1, 11))
def test_a_pade_approximant_passes_every_frequency_and_is_exact_to_its_order(order):
    omega = np.linspace(0.0, 30.0, 200)
    assert np.max(np.abs(np.abs(transfer(omega, 1.0, order)) - 1.0)) < 1e-9
    x = 0.2 * order
    error = abs(transfer(np.array([x]), 1.0, order)[0] - np.exp(-1j * x))
    share = math.factorial(order) ** 2 / (math.factorial(2 * order) * math.factorial(2 * order + 1))
    assert error < 2.0 * share * x ** (2 * order + 1) + 1e-9


@pytest.mark.parametrize("order", [0, 11, 2.5, "5"])
def test_orders_that_there_are_not(order):
    with pytest.raises(LinearSystemError, match="order 1 to 10"):
        pade(order)


def test_the_pade_norm_tends_to_the_exact_one():
    car = paper_half_car(STRUTS["S1"], STRUTS["S1"])
    system = state_space(car, ["road_front", "road_rear"], "sprung_acceleration").with_delays("road", [0.0, 0.0816])
    exact = h2_norm(system)
    errors = [abs(h2_norm(system, order) / exact - 1.0) for order in (2, 4, 6, 8, 10)]
    assert all(later < 0.1 * earlier for earlier, later in pairwise(errors))


@pytest.mark.parametrize("seed", range(5))
def test_no_delay_is_one_input_and_an_endless_one_is_two(seed):
    system = random_stable(np.random.default_rng(seed), 8, 2, 2, 0.1)
    together = LinearSystem(system.A, system.B.sum(axis=1, keepdims=True), system.C, np.zeros((2, 1)))
    assert h2_norm(system.with_delays("road", [0.0, 0.0])) == pytest.approx(h2_norm(together), rel=1e-12)
    assert h2_norm(system.with_delays("road", [0.0, 1e5])) == pytest.approx(h2_norm(system), rel=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_only_differences_of_delays_count_and_not_the_order_of_inputs(seed):
    rng = np.random.default_rng(seed)
    car = random_half_car(rng, STRUTS["S1"], STRUTS["S3"])
    system = state_space(car, ["road_front", "road_rear"], OUTPUTS)
    base = h2(system.with_delays("road", [0.0, 0.1])).outputs
    np.testing.assert_allclose(h2(system.with_delays("road", [0.4, 0.5])).outputs, base, rtol=1e-9)
    turned = system.subsystem(["road_rear", "road_front"]).with_delays("road", [0.1, 0.0])
    np.testing.assert_allclose(h2(turned).outputs, base, rtol=1e-10)


def test_driving_backwards_differs_for_one_output_but_not_for_a_symmetric_car():
    strut = STRUTS["S1"]
    car = type(paper_half_car(strut, strut))(400.0, 200.0, 25.0, 25.0, 1e5, 1e5, 1.0, 1.0, strut, strut)
    system = state_space(car, ["road_front", "road_rear"], OUTPUTS)
    forwards = h2(system.with_delays("road", [0.0, 0.1])).outputs
    backwards = h2(system.with_delays("road", [0.1, 0.0])).outputs
    np.testing.assert_allclose(forwards[:2], backwards[:2], rtol=1e-10)
    np.testing.assert_allclose(forwards[2:], backwards[3:1:-1], rtol=1e-10)
    assert abs(forwards[2] / forwards[3] - 1.0) > 1e-3


@pytest.mark.parametrize("damping", [1e4, 1e6])
def test_a_stiff_design_keeps_its_digits(damping):
    """A damper so hard that its rate is 1e6 times the car's must not cost the exponential of the delay its digits."""
    car = paper_half_car(k | c | Damper(damping) - Inerter(2.0), k | c | Damper(damping) - Inerter(2.0))
    delays = [0.0, 0.0816]
    system = state_space(car, ["road_front", "road_rear"], OUTPUTS[:1]).with_delays("road", delays)
    expected = h2_by_quadrature(axles(car.mechanism(), OUTPUTS[:1])[OUTPUTS[0]], delays, edge=4000.0)
    assert h2_norm(system) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("compiled", [False, True])
def test_the_rounding_bound_of_an_exponential_doubles_with_the_delay(compiled):
    """Each squaring doubles the error of a rotation, which keeps its size (Higham, Functions of Matrices, 10.3)."""
    A, u = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([0.6, 0.8])
    none, nothing = np.zeros((2, 2)), (np.zeros(0, complex), np.zeros(0, complex), 0.0)

    def error_and_bound(time):
        if compiled:
            out, bound = np.empty(2), np.empty(2)
            propagate_columns(A, none, time, u, np.zeros(2), nothing, out, bound)
        else:
            moved, unsure = propagate(A, none, u[:, None], np.zeros((2, 1)), time, None)
            out, bound = moved[:, 0], unsure[:, 0]
        turned = np.array([[math.cos(time), math.sin(time)], [-math.sin(time), math.cos(time)]]) @ u
        return np.abs(out - turned).max(), bound.max()

    found = [error_and_bound(float(2**power)) for power in range(6, 14)]
    assert all(error <= bound < 3e4 * max(error, 1e-16 * 2**i) for i, (error, bound) in enumerate(found))
    ratios = [later / earlier for (_, earlier), (_, later) in pairwise(found)]
    assert np.exp(np.mean(np.log(ratios))) == pytest.approx(2.0, rel=0.05)
