"""Candidate devices by name, and inertance from the drawing."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import inerter as it
from inerter.errors import IdentificationError
from inerter.identification.geometry import ball_screw_inertance, rack_and_pinion_inertance
from inerter.identification.models import MODELS, MOUNT, is_rigid, on_rig, with_mount
from inerter.networks.transform import with_values

VALUES = {"ks": 1e6, "cs": 3200.0, "gap": 1e-4, "b": 113.0, "f": 10.0, "c": 50.0}
sizes = st.floats(1e-4, 1e3)


def test_every_family_has_a_viscous_twin():
    uniform_whitening = [name for name in MODELS if not name.endswith("-viscous")]
    assert uniform_whitening == ["ideal", "friction", "elastic", "elastic-friction", "backlash", "ball-screw"]
    for name in uniform_whitening:
        mine, its = names(name), names(f"{name}-viscous")
        assert its == mine | {"c"}
        assert ("f" in mine, "ks" in mine, "gap" in mine) == (
            name in ("friction", "elastic-friction", "ball-screw"),
            name not in ("ideal", "friction"),
            name in ("backlash", "ball-screw"),
        )


def names(model):
    return {element.value.name for element in MODELS[model].elements()}


def test_the_ball_screw_is_that_of_figure_6b():
    expected = (it.Spring(1e6) | it.Damper(3200.0)) - it.Gap(1e-4) - (it.Inerter(113.0) | it.Friction(10.0))
    s = 2j * math.pi * np.array([0.5, 3.0, 30.0])
    assert with_values(MODELS["ball-screw"], VALUES).admittance(s) == pytest.approx(expected.admittance(s), rel=1e-12)


def test_rigid_devices_stand_on_the_load_cell_and_nothing_rings():
    for name, model in MODELS.items():
        assert is_rigid(model) == (name.split("-viscous")[0] in ("ideal", "friction"))
        assert with_mount(model) == model
        assert (on_rig(model, None).cell_bandwidth is not None) == is_rigid(model)
        assert on_rig(model, 120.0).cell_bandwidth == 120.0
    assert with_mount(it.Gap(1e-4) - it.Inerter(5.0)) == MOUNT - it.Gap(1e-4) - it.Inerter(5.0)
    assert with_mount(it.Spring(1e4)) == it.Spring(1e4)


@given(sizes, sizes, st.floats(1e-3, 1.0))
def test_energy_of_the_turning_flywheel_is_that_of_the_inertance(inertia, pitch, speed):
    turning = 0.5 * inertia * (2.0 * math.pi * speed / pitch) ** 2
    assert 0.5 * ball_screw_inertance(inertia, pitch) * speed**2 == pytest.approx(turning, rel=1e-12)


@given(sizes, sizes, sizes, st.floats(0.0, 1e3), st.floats(1e-3, 1.0))
def test_energy_of_gears_is_that_of_the_inertance(inertia, radius, ratio, pinion, speed):
    omega = speed / radius
    turning = 0.5 * inertia * (ratio * omega) ** 2 + 0.5 * pinion * omega**2
    found = rack_and_pinion_inertance(inertia, radius, ratio, pinion)
    assert 0.5 * found * speed**2 == pytest.approx(turning, rel=1e-12)


@given(sizes, st.floats(1e-3, 1.0))
def test_a_screw_is_a_rack_on_a_pinion_of_its_pitch(inertia, pitch):
    assert ball_screw_inertance(inertia, pitch) == pytest.approx(
        rack_and_pinion_inertance(inertia, pitch / (2.0 * math.pi)), rel=1e-12
    )


@given(st.floats(0.1, 10.0), st.floats(0.01, 0.3), st.floats(0.005, 0.1), st.floats(0.005, 0.1), st.floats(0.005, 0.1))
def test_smith_2002(mass, gyration, pinion, gear, flywheel_pinion):
    """b = m alpha_1^2 alpha_2^2 with alpha_1 = gamma / r_3 and alpha_2 = r_2 / r_1, section III."""
    expected = mass * (gyration / flywheel_pinion) ** 2 * (gear / pinion) ** 2
    found = rack_and_pinion_inertance(mass * gyration**2, pinion, gear / flywheel_pinion)
    assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("bad", [0.0, -1.0, float("nan"), float("inf"), "1", True, None])
def test_no_size_that_none_can_have(bad):
    for call in (
        lambda: ball_screw_inertance(bad, 5e-3),
        lambda: ball_screw_inertance(1e-3, bad),
        lambda: rack_and_pinion_inertance(bad, 0.01),
        lambda: rack_and_pinion_inertance(1e-3, bad),
        lambda: rack_and_pinion_inertance(1e-3, 0.01, bad),
    ):
        with pytest.raises(IdentificationError, match="positive"):
            call()
    if bad != 0.0 or bad is False:
        with pytest.raises(IdentificationError, match="pinion"):
            rack_and_pinion_inertance(1e-3, 0.01, 1.0, bad)
