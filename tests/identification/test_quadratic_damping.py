"""A damping that grows with the square of the speed, estimated with the values of a device."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from faulty_rig import Rig, laws, model, record_of
from quick_fits import quick_fit
from test_hidden_laws import DAMPING, INERTANCE, record

import inerter as it
from inerter.errors import IdentificationError
from inerter.identification.friction_models import QUADRATIC_DAMPING, quadratic_damping
from inerter.identification.hypotheses import Hypothesis
from inerter.identification.initial_estimate import chain_of
from inerter.identification.models import MODELS
from inerter.identification.options import FitOptions
from inerter.identification.scales import scale_effects
from inerter.identification.solving import SolvedFit

RIG = Rig(**laws()["quadratic"])
VALUES = {"b": RIG.b, "f": RIG.f, "ks": RIG.ks, "cs": RIG.cs}
SQUARE = 1500.0  # [N s^2/m^2]


def assumed(device: it.Network, fastest: float, peak: float) -> tuple[Hypothesis, ...]:
    chain = chain_of(device)
    assert chain is not None
    return (quadratic_damping(chain, fastest, peak),)


@cache
def rigid_fit(force: float = 1.0, moved: float = 1.0) -> SolvedFit:
    """A fit to a rigid device whose sensors read values that are so much too small."""
    read = record(SQUARE, 2)
    read = replace(read, force=read.force * force, displacement=read.displacement * moved)
    device = MODELS["ideal-viscous"]
    start = {"b": INERTANCE, "c": DAMPING, QUADRATIC_DAMPING: SQUARE}
    return quick_fit(read, device, start, assumed(device, 0.2, 500.0))


@pytest.mark.campaign
def test_values_of_an_elastic_device_are_those_beside_the_damping() -> None:
    """By a rig that shares no code; without the law the inertance alone is more than ten standard errors off."""
    read = record_of(RIG)
    law = assumed(model(RIG), 0.05, float(np.abs(read.force).max()))
    truth = {**VALUES, QUADRATIC_DAMPING: RIG.numbers[0]}
    with_it = quick_fit(read, model(RIG), {**VALUES, QUADRATIC_DAMPING: 0.3 * RIG.numbers[0]}, law)
    assert with_it.misfit.is_noise_limited
    assert not quick_fit(read, model(RIG), VALUES).misfit.is_noise_limited
    space, best = with_it.problem.space, with_it.optimum
    errors = dict(zip(space.names, best.errors * space.slopes(best.point), strict=True))
    for name, value in space.values_by_name(best.point).items():
        assert abs(value - truth[name]) < 4.0 * errors[name], (name, value, errors[name])
        assert errors[name] < 0.1 * truth[name]


@pytest.mark.campaign
def test_values_follow_the_scales_of_the_sensors() -> None:
    plain = rigid_fit()
    names = plain.problem.space.names
    found = scale_effects(
        plain.problem,
        plain.optimum,
        FitOptions(force_scale="1 +- 2 %", displacement_scale="1 +- 1 %"),  # type: ignore[arg-type]
    )
    assert found is not None
    others = rigid_fit(force=1.02), rigid_fit(moved=1.01)
    for row, scaled, by in zip(found.changes, others, (0.02, 0.01), strict=True):
        values, other = (one.problem.space.to_values(one.optimum.point) for one in (plain, scaled))
        i = names.index(QUADRATIC_DAMPING)
        assert row[i] == pytest.approx(other[i] - values[i], abs=0.2 * by * values[i])


def test_the_law_goes_to_other_processes() -> None:
    solution = rigid_fit()
    sent = pickle.loads(pickle.dumps(solution.problem))
    np.testing.assert_array_equal(
        sent.residual(solution.optimum.point), solution.problem.residual(solution.optimum.point)
    )


def test_devices_that_are_not_a_chain_are_refused() -> None:
    device = it.Spring(it.free(1e3, 1e5, name="k")) | it.Inerter(it.free(1.0, 100.0, name="b"))
    with pytest.raises(IdentificationError, match="quadratic_damping: the model must be an inerter"):
        it.identify(record(SQUARE, 2), device, starts=8, quadratic_damping=True)


@pytest.mark.campaign
def test_a_fit_from_nothing_gives_the_damping_and_what_is_beside_it() -> None:
    fit = it.identify(record(SQUARE, 3), "ideal-viscous", starts=8, quadratic_damping=True)
    assert fit.status.ok, fit.status
    for name, true in ({"b": INERTANCE, "c": DAMPING, QUADRATIC_DAMPING: SQUARE}).items():
        low, high = fit.parameters[name].interval
        assert low <= true <= high, name
        assert high - low < 0.5 * true, name
