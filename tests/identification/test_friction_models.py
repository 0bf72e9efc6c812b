"""Laws of friction that are proposed are ones that a device can have."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import device, fit_test

from inerter.identification.experiment import experiment_of
from inerter.identification.friction_models import ChainValues, _march, law_hypotheses, simulate_chain
from inerter.identification.hypotheses import Hypothesis
from inerter.identification.initial_estimate import chain_of

CHAIN = chain_of(device(f=27.5))
FASTEST, STROKE = 0.02, 1e-3


def law(name: str) -> Hypothesis:
    assert CHAIN is not None
    return next(h for h in law_hypotheses(CHAIN, FASTEST, STROKE) if h.name == name)


@given(st.floats(0.0, 1.0))
def test_friction_resists_in_both_directions_however_it_differs(place: float) -> None:
    """At every value that a fit may come to, both are positive, and their mean is that of the model."""
    asymmetric = law("asymmetric friction")
    (skew,) = asymmetric.unknowns
    told = asymmetric.details({skew.name: skew.lower + place * (skew.upper - skew.lower)})
    assert min(told["up"], told["down"]) > 0.0
    assert 0.5 * (told["up"] + told["down"]) == pytest.approx(27.5)


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_friction_by_position_varies_between_none_and_its_largest(tilt: float, bend: float) -> None:
    by_position = law("friction by position")
    tilted, bent = by_position.unknowns
    told = by_position.details({tilted.name: tilt * tilted.upper, bent.name: bend * bent.upper})["range"]
    x = np.linspace(-STROKE, STROKE, 101)
    most = float(np.max(27.5 + tilt * tilted.upper * x + bend * bent.upper * x**2))
    assert told <= max(most, 0.0) * (1.0 + 1e-9)


@pytest.mark.parametrize("skew", [-0.99, -0.4, 0.0, 0.99])
def test_a_skewed_friction_takes_energy_and_differs_by_its_share(skew: float) -> None:
    """A rigid device without inertance has a force of friction alone, which opposes every motion."""
    experiment = experiment_of(fit_test(seed=1, duration=1.0))
    v = experiment.motion.velocity
    force = simulate_chain(ChainValues(f=20.0, skew=skew), experiment, experiment.size)
    moves = np.abs(v) > 1e-6
    assert np.all((force * v)[moves] > 0.0)
    assert force[moves & (v > 0.0)] == pytest.approx(20.0 * (1.0 + skew))
    assert force[moves & (v < 0.0)] == pytest.approx(-20.0 * (1.0 - skew))


def test_the_force_is_computed_from_the_types_that_its_code_is_prepared_for() -> None:
    experiment = experiment_of(fit_test(seed=1, duration=1.0))
    simulate_chain(ChainValues(ks=1e6, cs=3200.0, b=113.0, f=20.0), experiment, experiment.size // 2)
    assert len(_march.ready().signatures) == 1
