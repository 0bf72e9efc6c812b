"""A unit that was read wrongly is named before other causes are sought, from what a unit does to an inertance."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from growing_tones import growing_tones

import inerter as it
from inerter.errors import RecordError
from inerter.identification.wrong_units import WRONG_UNITS

INERTANCE, FRICTION, NOISE = 120.0, 30.0, 0.2  # [kg], [N], [N]
MODEL = it.Inerter(it.free(20.0, 400.0, name="b")) | it.Friction(it.free(0.0, 500.0, name="f"))


def record(fixture: float = 0.0) -> it.Record:
    """Two tones that grow from rest, and the force of a rigid inerter with friction and a fixture, in closed form."""
    random, time = np.random.default_rng(5), np.arange(500) / 200.0
    x, v, a = growing_tones(time)
    force = (INERTANCE + fixture) * a + FRICTION * np.sign(v)
    return it.Record(
        time, x + 1e-7 * random.standard_normal(500), force + NOISE * random.standard_normal(500),
        source="bench.csv", force_bandwidth=5000.0, fixture_mass=fixture or None,
    )  # fmt: skip


FACTORS = [  # of the readings, and what is named
    (1e-3, 1.0, "a force in kN that was read in N", "units={'force': 'kN'}"),
    (1.0, 180.0 / math.pi, "a displacement in degree that was read in radian", "the displacement for one degree"),
    *(
        pytest.param(*row, marks=pytest.mark.campaign)
        for row in (
            (1e3, 1.0, "a force in N that was read in kN", "units={'force': 'N'}"),
            (1.0 / 9.80665, 1.0, "a force in kgf that was read in N", "units={'force': 'kgf'}"),
            (1.0, 1e3, "a displacement in mm that was read in m", "units={'displacement': 'mm'}"),
            (1.0, 1.0 / 25.4, "a displacement in inch that was read in mm", "units={'displacement': 'inch'}"),
        )
    ),
]


@pytest.mark.filterwarnings("ignore::UserWarning")  # of metres of displacement
@pytest.mark.parametrize(("force", "moved", "text", "remedy"), FACTORS)
def test_a_wrong_unit_is_named_with_the_inertance_in_the_right_one(
    force: float, moved: float, text: str, remedy: str
) -> None:
    right = record()
    wrong = replace(right, force=force * right.force, displacement=moved * right.displacement)
    with pytest.raises(RecordError, match=r"No values within the bounds explain 'bench\.csv'") as refused:
        it.identify(wrong, MODEL, starts=16)
    said = str(refused.value)
    assert f"{text} (an inertance of 120 kg)" in said, said
    first = said.split("; they do with ")[1].split(" or ", maxsplit=1)[0]
    assert text not in first or f"Correct the unit, such as {remedy}" in said, said


def test_a_wrong_unit_is_named_beside_a_fixture_mass() -> None:
    """The fixture is not in that unit: in newtons it would take a thousand times what was read."""
    right = record(40.0)
    with pytest.raises(RecordError, match=r"a force in kN that was read in N \(an inertance of 120 kg\)"):
        it.identify(replace(right, force=1e-3 * right.force), MODEL, starts=16)


def test_a_wrong_unit_contradicts_a_known_inertance() -> None:
    known = it.Inerter(INERTANCE) | it.Friction(it.free(0.0, 500.0, name="f"))
    right = record()
    with pytest.raises(RecordError, match=r"a force in lbf that was read in N \(an inertance of 120 kg\)"):
        it.identify(replace(right, force=right.force / 4.4482216), known, starts=16)


@pytest.mark.campaign
def test_the_right_unit_raises_nothing_and_a_bound_is_told_as_well() -> None:
    right = record()
    b = it.identify(right, MODEL, starts=16).parameters["b"]
    assert b.best == pytest.approx(INERTANCE, rel=0.01)
    small = it.Inerter(it.free(1.0, 60.0, name="b")) | it.Friction(it.free(0.0, 500.0, name="f"))
    with pytest.raises(RecordError, match="or change the bounds"):
        it.identify(right, small, starts=16)


def test_each_unit_has_its_inverse() -> None:
    factors = {(unit.role, unit.true, unit.read): unit.factor for unit in WRONG_UNITS}
    for (role, true, read), factor in factors.items():
        assert factors[role, read, true] * factor == pytest.approx(1.0, rel=1e-15)
