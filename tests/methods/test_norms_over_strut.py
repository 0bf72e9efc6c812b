"""Many designs of one strut: the same digits as one by one, in parts and as a whole, and those of other code."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from wang_su import ROAD, paper_quarter_car

import inerter as it
from inerter.methods.network_norm import index_over_strut

INDICES = [it.RideComfort(ROAD), it.TyreLoad(ROAD), it.LoadCarrying()]
CAR = paper_quarter_car(
    it.Spring(120e3) | it.Damper(it.free(1e2, 1e5, "c"), "c") - it.Inerter(it.free(1.0, 2e3, "b"), "b")
)


def designs(count):
    rng = np.random.default_rng(1)
    return {"c": 10.0 ** rng.uniform(2.0, 5.0, count), "b": 10.0 ** rng.uniform(0.0, 3.3, count)}


def test_parts_and_single_designs_have_the_digits_of_the_whole():
    values = designs(200)
    whole = it.evaluate_many(CAR, INDICES, values, it.Norm())
    with ThreadPoolExecutor(2) as executor:
        np.testing.assert_array_equal(it.evaluate_many(CAR, INDICES, values, it.Norm(), executor=executor), whole)
    for i in range(5):
        one = it.evaluate_many(CAR, INDICES, {name: column[i] for name, column in values.items()}, it.Norm())
        np.testing.assert_array_equal(one[0], whole[i])


def test_values_are_those_of_one_evaluation():
    values = designs(20)
    many = it.evaluate_many(CAR, INDICES, values, it.Norm())
    for i, row in enumerate(many):
        car = CAR.with_values({name: float(column[i]) for name, column in values.items()})
        np.testing.assert_allclose(row, [it.evaluate(car, index, it.Norm()).value for index in INDICES], rtol=1e-11)


def test_a_vehicle_is_prepared_once_for_all_its_struts():
    c, b = it.Damper(it.free(1e2, 1e5, "c")), it.Inerter(it.free(1.0, 2e3, "b"))
    struts = [it.Spring(80e3) | c, it.Spring(120e3) | c - b, it.Spring(120e3) | (it.Spring(1e6) - b) | c]
    heavy = it.QuarterCar(300.0, 25.0, 120e3, struts[0])
    for index in INDICES:
        found = [index_over_strut(car, index).index for car in [*map(paper_quarter_car, struts), heavy]]
        assert found[0] is found[1] is found[2] is not found[3]
        best = [it.optimise(car, index, it.Norm()) for car in (paper_quarter_car(struts[0]), heavy)]
        assert best[0].value != best[1].value
