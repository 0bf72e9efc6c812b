"""Frictions that never slip and stops that are never reached: every method gives the norm of the design without."""

from __future__ import annotations

import numpy as np
import pytest

import inerter as it
from inerter import ApproximateLinear, Damper, ExpectedValue, Friction, Gap, Inerter, Spring, StatisticalLinearisation
from inerter.methods.method import NonlinearitySupport

ROAD = it.Road(5e-7, 25.0)
J1, J3, J5 = it.RideComfort(ROAD), it.TyreLoad(ROAD), it.LoadCarrying(1000.0)
ROADS, GAINS = ExpectedValue(realisations=2), ApproximateLinear(realisations=2)
HELD, FAR = Friction(1e9), Gap(1.0)  # [N], [m]


def check(bodies, without, idle, index, method):
    """Asserts that a value of the car with idle elements is that of the one without, within its bound."""
    norm = it.evaluate(it.QuarterCar(*bodies, without), index, it.Norm()).value
    found = it.evaluate(it.QuarterCar(*bodies, idle), index, method)
    off = abs(found.value - norm)
    assert np.isnan(off) or off <= (found.error_bound + 1e-9) * norm + 13.0 * (found.standard_error or 0.0)
    return found


def held(spring, damping, more):
    main = Spring(spring) | Damper(damping)
    return main | Spring(more), main | Spring(more, name="q") - HELD


@pytest.mark.parametrize(
    ("bodies", "spring", "damping", "more", "index", "method"),
    [
        ((450.0, 42.0, 190e3), 10e3, 6000.0, 100e3, J5, GAINS),  # creeping it would have twice the gain, at zero
        ((450.0, 42.0, 190e3), 20e3, 4000.0, 40e3, J5, GAINS),
        ((583.9, 55.8, 109807.9), 29481.8, 1986.8, 124562.6, J5, GAINS),  # the resonance is narrow
        ((227.6, 33.1, 145136.4), 49031.5, 934.4, 485342.2, J1, ROADS),
        ((227.6, 33.1, 145136.4), 49031.5, 934.4, 485342.2, J3, ROADS),
        ((169.7, 34.7, 249058.3), 47262.4, 1190.9, 439943.7, J3, GAINS),
    ],
)
def test_a_friction_that_never_slips_is_rigid(bodies, spring, damping, more, index, method):
    assert check(bodies, *held(spring, damping, more), index, method).status.ok


def test_what_is_not_known_of_a_gain_below_the_harmonics_counts():
    """Damped beyond its critical value, the car has its largest gain at zero, where a damper in place of the friction
    would creep."""
    found = check((450.0, 42.0, 190e3), *held(10e3, 6000.0, 3e3), J5, GAINS)
    sources = {source.name: source.bound for source in found.error_sources}
    assert sources["band below the lowest frequency"] > 1e-3


@pytest.mark.parametrize(
    ("bodies", "spring", "damping", "behind"),
    [
        ((209.4, 47.7, 114003.3), 16252.5, 2079.2, Spring(162000.4) | Damper(1167.8)),
        ((177.4, 45.4, 117508.7), 55689.7, 2245.9, Spring(107394.5)),
        ((378.0, 22.0, 204925.9), 21792.6, 1413.4, Spring(90118.9)),
    ],
)
def test_a_stop_that_is_never_reached_changes_no_tyre_load(bodies, spring, damping, behind):
    """With closed gaps resonances are far larger, of which lines 1/10 Hz apart miss more than of the motion itself."""
    main = Spring(spring) | Damper(damping)
    assert check(bodies, main, main | FAR - behind, J3, ROADS).status.ok


@pytest.mark.campaign
@pytest.mark.parametrize("method", [ROADS, GAINS, StatisticalLinearisation()], ids=lambda method: method.name)
@pytest.mark.parametrize("index", [J1, J3, J5], ids=lambda index: index.symbol)
def test_random_cars_with_idle_elements(index, method):
    random, ok = np.random.default_rng(18), 0
    for _ in range(20):
        mass, unsprung, tyre, spring, share, stiffer, inertance = 10.0 ** random.uniform(
            [2.2, 1.3, 5.0, 4.0, -1.0, -0.5, 1.0], [2.8, 1.8, 5.5, 4.8, -0.2, 1.0, 2.5]
        )
        damping = 2.0 * share * np.sqrt(spring * mass)
        main, more, damper = Spring(spring) | Damper(damping), Spring(stiffer * spring, name="q"), Damper(0.4 * damping)
        idle = [
            (main | more, main | more - HELD),
            (main | more, main | more - (HELD | damper)),
            (main | more - damper, main | more - damper - HELD),
            (main | more, main | more - (Inerter(inertance) | HELD)),
            (main, main | FAR - (more | damper)),
            (main, main | FAR - ((Spring(1e6) | Damper(3200.0)) - Inerter(inertance))),
        ]
        gaps = method.nonlinearity_support is NonlinearitySupport.BOTH
        designs = idle[random.integers(0, len(idle) if gaps else 4)]
        ok += check((mass, unsprung, tyre), *designs, index, method).status.ok
    assert ok > 5
