"""The compiled index of a network in a vehicle: rational arithmetic, its own error bound, and differences."""

from __future__ import annotations

import math

import numpy as np
import pytest
from campaigns import sampled
from port_members import CompiledMember, random_member

from inerter import Bridge, Damper, Inerter, Spring
from inerter.methods.network_norm import network_program

BLOCK = 40
ROOT = 4e-16  # of the last operations, which the bound leaves out


@pytest.mark.parametrize("block", sampled(range(125), range(2)))
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


@pytest.mark.parametrize("blocks", [1, pytest.param(40, marks=pytest.mark.marathon)])
def test_an_index_is_seldom_unknown(blocks):
    members = [random_member(number, extreme=0.0) for number in range(BLOCK * blocks)]
    found = [member.compiled() for member in members if member is not None]
    assert sum(error == math.inf for _, error, _ in found) <= 0.1 * len(found)


@pytest.mark.parametrize("block", sampled(range(40), range(1)))
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
