"""Values that the search of a fit does not reach are a cause of a misfit, which is named, with the values there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from growing_tones import growing_tones
from quick_fits import explained, quick_fit

import inerter as it
from inerter.identification.diagnosis import beyond_bounds
from inerter.identification.models import MODELS
from inerter.identification.statements.causes import Suspect

INERTANCE, FRICTION, NOISE = 120.0, 800.0, 0.5  # [kg], [N], [N]; the friction of the catalogue ends at 500 N


def record(friction: float = FRICTION) -> it.Record:
    """Two tones that grow from rest, and the force of a rigid inerter with friction, in closed form."""
    random, time = np.random.default_rng(3), np.arange(400) / 200.0
    x, v, a = growing_tones(time)
    force = INERTANCE * a + friction * np.sign(v)
    return it.Record(
        time, x + 1e-7 * random.standard_normal(400), force + NOISE * random.standard_normal(400),
        force_bandwidth=5000.0, force_noise=NOISE, displacement_noise=1e-7,
    )  # fmt: skip


def test_bounds_are_widened_of_the_values_that_end_there() -> None:
    solution = quick_fit(record(), MODELS["friction"], {"b": 100.0, "f": 499.0})
    problem, point = solution.problem, solution.optimum.point
    (wider,) = beyond_bounds(problem, point)
    assert wider.device is not None
    bounds = {name: (value.lower, value.upper) for name, value in it.Rig(wider.device).free_values().items()}
    assert bounds["b"] == (0.5, 5000.0)
    assert bounds["f"][0] == 0.0
    assert bounds["f"][1] > FRICTION
    inside = problem.space.coordinates_of({"b": 100.0, "f": 400.0})
    assert beyond_bounds(problem, inside) == []
    at_nothing = problem.space.coordinates_of({"b": 0.5, "f": 0.0})  # no friction is no bound of the search
    (wider,) = beyond_bounds(replace(problem), at_nothing)
    assert wider.details({"b": 0.4, "f": 0.0})["values"] == (("b", "kg", 0.5, False),)


@pytest.mark.campaign
def test_a_friction_beyond_its_bound_is_not_called_another_law() -> None:
    found, _ = explained(quick_fit(record(), MODELS["friction"], {"b": 100.0, "f": 499.0}))
    assert found[0].name is Suspect.BEYOND_BOUNDS, found[0].sentence
    assert "f is larger than 500 N" in found[0].sentence
    (b, _), (f, _) = found[0].estimates["b"], found[0].estimates["f"]
    assert abs(b / INERTANCE - 1.0) < 0.01
    assert abs(f / FRICTION - 1.0) < 0.01


UNITS = [  # factors of force and displacement; channel, true unit and unit as read
    (1e-3, 1.0, {("force", "kN", "N")}),
    (1e3, 1.0, {("force", "N", "kN")}),
    (1.0, 1e-3, {("displacement", "m", "mm")}),
    (1.0, 1.0, set()),
]


@pytest.mark.parametrize(("force", "moved", "units"), UNITS)
def test_a_wrong_unit_brings_all_values_within_their_bounds(
    force: float, moved: float, units: set[tuple[str, str, str]]
) -> None:
    """Of 120 kg and 30 N; a force of kN that is read in N has 30 mN of friction, a displacement none other."""
    solution = quick_fit(record(), MODELS["friction"], {"b": 100.0, "f": 499.0})
    (wider,) = beyond_bounds(solution.problem, solution.optimum.point)
    details = wider.details({"b": 120.0 * force / moved, "f": 30.0 * force})
    found = {(role, true, read) for role, true, read, _ in details["units"]}
    assert units <= found if units else not found - {("displacement", "mm", "m")}
    for role, true, _, values in details["units"]:
        if (role, true) in {(r, t) for r, t, _ in units}:
            assert dict(values) == pytest.approx({"b": 120.0, "f": 30.0})


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("factor", "unit", "start"), [(1e-3, "kN", {"b": 0.5, "f": 0.5}), (1e3, "N", {"b": 4e3, "f": 490.0})]
)
def test_a_force_in_a_wrong_unit_is_named(factor: float, unit: str, start: dict[str, float]) -> None:
    given = record(300.0)
    wrong = replace(given, force=factor * given.force, force_noise=factor * NOISE)
    found, _ = explained(quick_fit(wrong, MODELS["friction"], start))
    assert found[0].name is Suspect.BEYOND_BOUNDS, found[0].sentence
    assert found[0].estimates["b"][0] == pytest.approx(factor * INERTANCE, rel=0.01)
    assert f"a force in {unit} that was read in " in found[0].sentence
    assert f"units={{'force': '{unit}'}}" in found[0].remedy
