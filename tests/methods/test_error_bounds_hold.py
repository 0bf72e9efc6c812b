"""What estimates say of their errors holds, for random members over vehicles, indices and methods.

`benchmarks/error_bounds.py` judges many more of the same members, and says how much larger than errors bounds are.
"""

from __future__ import annotations

from dataclasses import replace

import pytest
from bounded import (
    SEEN,
    VEHICLES,
    against_exact,
    intervals,
    linear_member,
    member_under_a_sine,
    member_with_a_damped_stop,
    member_with_friction,
    of_finer_steps,
    of_hardly_any_friction,
    of_linearisation,
)
from campaigns import sampled

import inerter as it

ROADS, GAINS = it.ExpectedValue(realisations=2, jobs=1), it.ApproximateLinear(realisations=2)


def check(judged):
    assert judged is None or not judged.exceeded, judged


@pytest.mark.parametrize("number", sampled(range(330), range(len(VEHICLES)), kept=20))
def test_norms_are_within_their_bound_of_rational_arithmetic(number):
    pytest.importorskip("flint", reason="python-flint is not installed")
    member = linear_member(number)
    try:
        check(against_exact(member))
    except it.InerterError as error:  # a question that this vehicle does not answer
        pytest.skip(str(error))


@pytest.mark.parametrize("number", sampled(range(60), [21], often=[19], kept=2))
def test_where_friction_turns_between_samples_the_bound_knows(number):
    check(of_finer_steps(member_with_friction(number), ROADS))


@pytest.mark.parametrize("number", sampled(range(60), [2], kept=3))
def test_where_a_stop_is_met_between_samples_the_bound_knows(number):
    """The force of its damper jumps, and with it the acceleration."""
    for method in (replace(ROADS, period=10), GAINS):
        check(of_finer_steps(member_with_a_damped_stop(number), method))


@pytest.mark.parametrize("number", sampled(range(24), seldom=range(3, 24), kept=2))
def test_gains_are_within_their_bound_of_shorter_steps(number):
    check(of_finer_steps(member_with_friction(number), GAINS))


@pytest.mark.parametrize("number", sampled(range(len(SEEN), 60), kept=3))
def test_with_hardly_any_friction_roads_give_the_norm(number):
    check(of_hardly_any_friction(member_with_friction(number), ROADS))


@pytest.mark.parametrize("number", sampled(range(60), kept=2))
def test_sines_are_within_their_bound_of_shorter_steps(number):
    check(of_finer_steps(member_under_a_sine(number), ROADS))


@pytest.mark.parametrize("number", sampled(range(120), seldom=range(4, 120), kept=2))
def test_linearisation_is_within_its_bound_of_simulations(number):
    check(of_linearisation(member_with_friction(number), 16))
    check(of_linearisation(member_under_a_sine(number), 2))


@pytest.mark.marathon
def test_nineteen_of_twenty_intervals_hold():
    found = [intervals(member_with_friction(n), lambda seed: it.ExpectedValue(seed=seed), 12) for n in range(12)]
    held, count = (sum(one[i] for one in found if one is not None) for i in (0, 1))
    assert 0.93 < held / count < 0.98
