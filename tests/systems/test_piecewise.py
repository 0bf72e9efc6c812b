"""The piecewise-linear system of a layout: what is found once for all its values."""

from dataclasses import replace

import numpy as np
import pytest

import inerter as it
from inerter.errors import DesignError
from inerter.systems import kinematics
from inerter.systems.piecewise import piecewise, with_element_values


def car(body=180.0, k=1e5, c=2e3, friction=10.0, gap=1e-3, b=None):
    screw = it.Damper(c, name="c") - it.Gap(gap) - (it.Inerter(300.0) | it.Friction(friction, name="friction"))
    strut = it.Spring(k, name="k") | screw
    return it.QuarterCar(body, 25.0, 1.2e5, strut if b is None else strut | it.Inerter(b) - it.Inerter(20.0))


def arrays(system):
    known = system.kinematics
    yield from (system.balance, known.moving, known.lengths, known.elements, system.limits)
    yield from (*system.motions, *system.rates, *system.elongations, system.kinetic, system.inertia, system.positions)


def alone(vehicle):
    """The system as the first of its layout."""
    kinematics._cached_analysis.cache_clear()
    return piecewise(vehicle)


@pytest.mark.parametrize(
    "other",
    [
        car(body=200.0, k=2e5, c=1e3, friction=20.0, gap=2e-3),
        car(friction=0.0),
        car(gap=0.0),
        car(b=5.0),
        car(b=50.0),
    ],
)
def test_a_system_does_not_depend_on_those_built_before(other):
    expected = alone(other)
    alone(car())
    piecewise(car(b=10.0))
    found = piecewise(other)
    for one, two in zip(arrays(found), arrays(expected), strict=True):
        np.testing.assert_array_equal(one, two)
    assert [b.element for b in found.graph.branches] == [b.element for b in expected.graph.branches]
    assert found.moves_elements == expected.moves_elements


def test_other_values_give_the_system_of_the_other_design():
    found = with_element_values(piecewise(car()), {"sprung": 200.0, "k": 2e5, "c": 1e3, "friction": 20.0})
    expected = piecewise(car(body=200.0, k=2e5, c=1e3, friction=20.0))
    for one, two in zip(arrays(found), arrays(expected), strict=True):
        np.testing.assert_array_equal(one, two)
    assert found.mechanism.coordinates == expected.mechanism.coordinates
    assert piecewise(car()).mechanism.coordinates[0].inertia == 180.0


@pytest.mark.parametrize(
    ("vehicle", "values", "said"),
    [
        (car(), {"spring": 1.0}, "Unknown element or coordinate 'spring'"),
        (car(), {"friction": 0.0}, "any positive number"),
        (car(friction=0.0), {"friction": 1.0}, "nothing else"),
        (car(), {"k": "1e5"}, "any positive number"),
        (car(b=5.0), {"k": 1e5}, "between inerters alone"),
    ],
)
def test_values_that_change_the_layout_are_refused(vehicle, values, said):
    with pytest.raises(DesignError, match=said):
        with_element_values(piecewise(vehicle), values)


def test_an_output_of_a_point_is_there_whatever_was_simulated_before():
    mechanism = car().mechanism()
    piecewise(mechanism)
    seat = it.TrackedPoint("seat", {"sprung": 1.0})
    assert "seat_acceleration" in piecewise(replace(mechanism, points=(seat,))).outputs
