"""The staged protocol on a virtual rig with the parameters of Wang and Su (2008), section 4."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled

import inerter as it
from inerter.errors import IdentificationError
from inerter.identification.staged_protocol import Band
from inerter.papers.wang_su_2008 import rig

TRUE = {"ks": 1e6, "cs": 3200.0, "b": 113.0, "f": 10.0}
SHAFT = it.Spring(1e6) | it.Damper(3200.0)


def device(inertance):
    return SHAFT - (it.Inerter(inertance) | it.Friction(10.0))


@pytest.fixture(scope="module")
def slow():
    return it.VirtualRig(device(5.0), seed=1).run(it.cosine(1e-3, 0.1), 20.0)


@pytest.fixture(scope="module")
def fast():
    return it.VirtualRig(device(113.0), seed=2).run(it.cosine(1e-3, 3.0), 5.0)


@pytest.mark.marathon
def test_the_papers_experiment():
    """Every value within 2 %, and the backlash as an upper bound; the check agrees in all octaves."""
    found = rig.rig_test_from_json(rig.compute(rig.NAME))
    assert [p.name for p in found.parameters] == ["f", "ks", "cs", "gap", "b"]
    for p in found.parameters:
        if p.name == "gap":
            assert np.isnan(p.value)
            assert p.interval[0] == 0.0
            assert p.interval[1] < 2e-5
            assert "not identifiable: only an upper bound" in p.sentence
        else:
            assert abs(p.difference) < 0.02
    assert found.status == "ok"
    assert found.notes[-1] == "The validation record agrees in all 6 octaves."
    measured, model, linear, ideal = (found.responses[name] for name in ("measured", "model", "linear", "ideal"))
    off = [np.median(np.abs(r.value / measured.value - 1.0)) for r in (model, linear, ideal)]
    assert off[0] < 0.01 < off[1] < off[2]
    assert np.isinf(model.averages).all()
    assert np.std(found.fit["force"] - found.fit["model"]) < 0.3
    assert np.std(found.friction["force"] - found.friction["model"]) < 0.3


@pytest.mark.marathon
def test_with_the_inertance_of_the_geometry_and_a_model_without_backlash(slow, fast):
    model = (it.Spring(it.free(1e5, 1e7, name="ks")) | it.Damper(it.free(100.0, 2e4, name="cs"))) - (
        it.Inerter(it.free(1.0, 500.0, name="b")) | it.Friction(it.free(0.0, 100.0, name="f"))
    )
    found = it.identify_staged(slow, fast, inertance=113.0, shaft_inertance=5.0, model=model, starts=8)
    assert list(found.parameters) == ["ks", "cs", "f"]
    for name, p in found.parameters.items():
        assert p.value == pytest.approx(TRUE[name], rel=0.02)
        assert p.interval[0] < p.interval[1]
    assert found.response is None
    assert found.friction.law.law == "coulomb"
    assert abs(found.friction.offset) < 0.05
    assert any("was given: 113 kg" in note for note in found.notes)
    inner = found.fit.parameters["f"].interval  # the friction moved within its interval, and no further
    assert found.friction.law.interval[0] * 0.998 <= inner[0] <= inner[1] <= found.friction.law.interval[1] * 1.002


@pytest.mark.parametrize("saturated", sampled([True, False], kept=1))
def test_a_check_that_does_not_agree_is_told(slow, fast, saturated):
    """Another flywheel in the check, with a saturated load cell or without."""
    model = SHAFT - (it.Inerter(it.free(1.0, 500.0, name="b")) | it.Friction(it.free(0.0, 100.0, name="f")))
    other = it.VirtualRig(device(150.0), seed=3).run(it.flat_multisine(0, 1e-4, 1.0, 16.0), 6.0)
    cut = replace(other, force=np.clip(other.force, -150.0, 150.0), force_range=150.0)
    found = it.identify_staged(slow, fast, cut if saturated else other, model=model, starts=8)
    assert not any(band.agrees for band in found.response.bands[-2:])
    assert "differs" in found.response.bands[-1].verdict
    assert any("saturated" in note for note in found.notes) == saturated


def test_protocols_that_cannot_be(slow, fast):
    none = it.VirtualRig(SHAFT - it.Inerter(5.0), seed=0).run(it.cosine(1e-3, 0.1), 20.0)
    with pytest.raises(IdentificationError, match="friction is not identifiable"):
        it.identify_staged(none, fast)
    with pytest.raises(IdentificationError, match="friction element named f"):
        it.identify_staged(slow, fast, model=it.Inerter(it.free(1.0, 10.0, name="b")))
    with pytest.raises(IdentificationError, match="positive"):
        it.identify_staged(slow, fast, inertance=-1.0)


@pytest.mark.parametrize("size", [-0.03, -1e-6, 0.0, 1e-6, 0.03])
@pytest.mark.parametrize("lines", [1, 4])
def test_what_rounds_to_nothing_has_no_sign_and_one_line_is_no_range(size, lines):
    said = Band(0.5, 0.5 * lines, lines, size, size, 0.01, True).verdict
    assert ("+" in said) == (size > 0.01)
    assert ("-" in said) == (size < -0.01)
    assert said.startswith("0.5 Hz:" if lines == 1 else "0.5 to 2 Hz:")
