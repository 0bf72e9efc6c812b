"""The completed share of a search: it begins at 0, never falls, and its stages follow one another without a jump."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from wang_su import ROAD, paper_quarter_car

import inerter as it
from inerter.optimisation.constrained_search import ConstrainedProblem
from inerter.optimisation.optimise import _costly_searches
from inerter.work.progress import ProgressStep, receiving_steps

COMFORT, LOAD = it.RideComfort(ROAD), it.at_most(it.TyreLoad(ROAD), 520.0)
CAR = paper_quarter_car(
    it.Spring(it.free(30e3, 200e3)) | it.Damper(it.free(500.0, 5e4)) - it.Inerter(it.free(1.0, 5e3))
)
LIGHTER = replace(CAR, unsprung_mass=it.free(20.0, 30.0))  # with a free value that is not in the strut
SEARCHES = {
    "norm": lambda: it.optimise(LIGHTER, COMFORT, it.Norm(), starts=6),
    "peak gain": lambda: it.optimise(LIGHTER, it.LoadCarrying(), it.Norm(), starts=6),
    "constraint": lambda: it.optimise(LIGHTER, COMFORT, it.Norm(), subject_to=[LOAD], starts=6),
    "peak gain with a constraint": lambda: it.optimise(CAR, it.LoadCarrying(), it.Norm(), subject_to=[LOAD], starts=3),
}


class Steps(list):
    """The steps that are reported."""

    def tell(self, step: ProgressStep) -> None:
        self.append(step)

    def count_evaluation(self) -> None:
        pass


@pytest.mark.parametrize("search", SEARCHES.values(), ids=SEARCHES)
def test_shares_rise_from_0_to_at_most_1_without_a_jump_between_stages(search):
    steps = Steps()
    with receiving_steps(steps):
        search()
    shared = [step for step in steps if step.share is not None]
    shares = np.array([step.share for step in shared])
    assert shares[0] == 0.0
    assert np.all(np.diff(shares) >= 0.0)
    assert shares[-1] <= 1.0
    stages = [(before, after) for before, after in pairwise(shared) if before.what != after.what]
    assert stages
    for before, after in stages:
        if before.what == "starts":  # whose last step says all of its share
            assert before.done == before.total
            assert after.share == before.share
    ends = [step for step in shared if step.what == "ends"]
    for step in ends:  # equal parts of what is left after the first searches
        first = next(each.share for each in reversed(shared) if each.what == "starts")
        assert step.share == pytest.approx(first + (1.0 - first) * step.done / step.total)


class Bowl:
    """(x / 3)^2 + (3 / x)^2 of each value."""

    def values(self, points):
        return np.sum((points / 3.0) ** 2 + (3.0 / points) ** 2, axis=1)


def test_searches_by_simulation_take_equal_parts_after_their_quick_beginnings():
    problem = ConstrainedProblem(Bowl(), (), np.array([1.0]), np.array([10.0]))
    steps = Steps()
    with receiving_steps(steps):
        found, count = _costly_searches(problem, [np.array([2.0]), np.array([6.0]), np.array([9.0])])
    assert count == 3
    assert [end.point[0] for end in found] == pytest.approx([3.0, 3.0], rel=1e-2)
    for number, (low, high) in enumerate([(0.1, 0.55), (0.55, 1.0)], start=1):
        inside = [step for step in steps if step.within == (f"search {number} of 2",) and step.total]
        assert inside
        expected = [low + (high - low) * step.done / step.total for step in inside]
        assert [step.share for step in inside] == pytest.approx(expected)
