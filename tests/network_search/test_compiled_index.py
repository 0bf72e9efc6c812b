"""The compiled index of a network in a vehicle: rational arithmetic, its own error bound, and differences."""

from __future__ import annotations

import math

import numpy as np
import pytest
from campaigns import sampled
from port_members import CompiledMember, random_member

from inerter import Bridge, Damper, Inerter, Spring
from inerter.kernels.network_gains import peaks_in_lanes, peaks_in_turn
from inerter.kernels.network_lanes import indices_in_lanes
from inerter.kernels.network_norms import indices
from inerter.methods.network_norm import network_program

BLOCK = 40
PEAKS = 160  # of which one in six or seven has a peak that the compiled code knows
ROOT = 4e-16  # of the last operations, which the bound leaves out


@pytest.mark.parametrize("block", sampled(range(125), range(1), kept=1))
def test_an_index_is_within_its_bound_of_rational_arithmetic(block):
    pytest.importorskip("flint", reason="python-flint is not installed")
    compared = 0
    for number in range(BLOCK * block, BLOCK * (block + 1)):
        member = random_member(number)
        exact = None if member is None else member.exact()
        if member is None or exact is None:
            continue
        value, error, _ = member.compiled()
        if error == math.inf:  # unknown, of a motion without damping to 25 digits or more
            continue
        assert value == exact or abs(value / exact - 1.0) <= error + ROOT, member.name
        compared += 1
    assert compared > BLOCK // 5


@pytest.mark.parametrize("number", [2583, 2637, 3693])
def test_a_bound_holds_where_a_difference_loses_its_digits(number):
    """A bound of first order at quotients that are wrong says nothing: it was exceeded 20 to 100 000 times."""
    pytest.importorskip("flint", reason="python-flint is not installed")
    member = random_member(number, extreme=0.4)
    value, error, _ = member.compiled()
    assert error == math.inf or abs(value / member.exact() - 1.0) <= error + ROOT


@pytest.mark.parametrize("block", sampled(range(25), kept=1))
def test_a_peak_gain_is_within_its_bound_of_rational_arithmetic(block):
    pytest.importorskip("flint", reason="python-flint is not installed")
    compared = 0
    for number in range(PEAKS * block, PEAKS * (block + 1)):
        member = random_member(number, extreme=0.1, peaks=True)
        found = None if member is None else side_by_side(member, 1, number)
        if found is None or found[1][0] == math.inf or (exact := member.exact()) is None:
            continue
        (value,), (error,) = found[:2]
        assert abs(value * math.sqrt(found[2]) / exact - 1.0) <= error + ROOT, member.name
        compared += 1
    assert compared > 0


@pytest.mark.parametrize("peaks", [False, True])
@pytest.mark.parametrize("block", sampled(range(50), often=range(1), kept=0))
def test_designs_side_by_side_have_the_digits_of_designs_in_turn(block, peaks):
    compared = 0
    for number in range(BLOCK * block, BLOCK * (block + 1)):
        member = random_member(number, extreme=0.4, peaks=peaks)
        found = None if member is None else side_by_side(member, 21, number)
        if found is not None:
            assert np.array_equal(found[:2], in_turn(member, 21, number), equal_nan=True), member.name
            compared += 1
    assert compared > 0


def side_by_side(member: CompiledMember, count: int, number: int) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Values, their relative errors and the weight of the (last) squared norm; None if the index is infinite."""
    program = network_program(member.network)
    port, errors = member.over_network.port(program), np.zeros(count)
    if port is None or port.weights.size == 0:
        return None
    compiled = peaks_in_lanes if member.over_network.is_peak else indices_in_lanes
    values = compiled(member.designs(count, number), program.program, port, errors)
    return values, errors, float(port.weights[-1])


def in_turn(member: CompiledMember, count: int, number: int) -> tuple[np.ndarray, np.ndarray]:
    program = network_program(member.network)
    port, errors, points = member.over_network.port(program), np.zeros(count), member.designs(count, number)
    if member.over_network.is_peak:
        return peaks_in_turn(points, program.program, port, errors), errors
    rows = np.ascontiguousarray(points.T)
    return indices(rows, program.program, port, np.zeros((0, rows.shape[1])), errors), errors


@pytest.mark.parametrize("blocks", [1, pytest.param(40, marks=pytest.mark.marathon)])
def test_an_index_is_seldom_unknown(blocks):
    members = [random_member(number, extreme=0.0) for number in range(BLOCK * blocks)]
    found = [member.compiled() for member in members if member is not None]
    assert sum(error == math.inf for _, error, _ in found) <= 0.1 * len(found)


@pytest.mark.parametrize("block", sampled(range(40), range(1), kept=1))
def test_gradients_are_those_of_differences(block):
    for number in range(BLOCK * block, BLOCK * (block + 1)):
        member = random_member(number, extreme=0.0)
        if member is None or not member.compiled()[1] < 1e-10:
            continue
        value, _, gradient = member.compiled(gradient=True)
        if 0.0 < value < math.inf:
            slopes = gradient * member.values / value
            assert slopes == pytest.approx(differences(member), rel=1e-6, abs=1e-6), member.name


def differences(member: CompiledMember) -> np.ndarray:
    """Slopes d log J / d log x by differences of fourth order."""
    slopes = np.zeros(member.values.size)
    h = 2e-4
    for i in range(slopes.size):
        for steps, weight in ((-2, 1.0), (-1, -8.0), (1, 8.0), (2, -1.0)):
            values = member.values.copy()
            values[i] *= math.exp(steps * h)
            slopes[i] += weight * math.log(member.compiled(values=values)[0]) / (12.0 * h)
    return slopes


def test_powers_and_degrees_of_an_admittance():
    k, c, b = Spring(1.0), Damper(1.0), Inerter(1.0)
    programs = [network_program(network) for network in (k, c, b, k | c - b, Bridge(k, b, b, k, c))]
    assert [(p.power, p.top, p.bottom) for p in programs] == [(-1, 0, 0), (0, 0, 0), (1, 0, 0), (-1, 2, 1), (0, 4, 4)]
