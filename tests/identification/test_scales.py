"""Errors of scale in intervals: by the law that values follow, by fits to scaled records, and by drawing errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from scipy.stats import binom
from troubled_records import clean, model_of, record_of

import inerter as it
from inerter.errors import IdentificationError, RecordError
from inerter.identification.experiment import experiment_of
from inerter.identification.intervals import best_fit_of, steps_of
from inerter.identification.noise import uniform_whitening
from inerter.identification.options import FitOptions
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.identification.scales import ScaleEffects, scale_effects
from inerter.identification.search import improve

VALUES = {"ks": 2e5, "cs": 2e3, "gap": 1e-4, "b": 50.0, "f": 8.0}
SHAFT = it.Spring(it.free(1e4, 1e7, name="ks")) | it.Damper(it.free(10, 2e4, name="cs"))
GAP, B, F = it.Gap(it.free(0, 1e-3, name="gap")), it.free(1, 500, name="b"), it.free(0, 100, name="f")
MODELS = {
    "elastic-friction": SHAFT - (it.Inerter(B) | it.Friction(F)),
    "ball-screw": SHAFT - GAP - (it.Inerter(B) | it.Friction(F)),
    "known inertance": SHAFT - (it.Inerter(50.0) | it.Friction(F)),
}
POWERS = {"ks": (1, -1), "cs": (1, -1), "gap": (0, 1), "b": (1, -1), "f": (1, 0)}
FORCE, MOVED = "1 +- 2 %", "1 +- 1 %"


def problem(model: it.Network, force: float = 1.0, moved: float = 1.0) -> FitProblem:
    """A record whose sensors read values that are so much too small."""
    names = it.Rig(model).free_values()
    rig = it.VirtualRig(it.Rig(model).with_values({n: VALUES[n] for n in names}).device, sampling=500.0)
    record = rig.run(it.cosine(4e-3, 2.0) + it.cosine(5e-4, 9.0), duration=1.5)
    record = replace(record, displacement=record.displacement * moved, force=record.force * force)
    experiment = experiment_of(record)
    return FitProblem(it.Rig(model), space_of(it.Rig(model)), [experiment], [uniform_whitening(experiment.kept, 0.12)])


@pytest.mark.parametrize("name", sampled(MODELS, ["elastic-friction"]))
def test_effects_are_those_of_fits_to_records_with_other_scales(name: str) -> None:
    """Where nothing is known from elsewhere the law is exact; else the other values make up for what is."""
    plainly = problem(MODELS[name])
    space = plainly.space
    start = space.coordinates_of(VALUES)
    optimum = best_fit_of(plainly, start)
    found = scale_effects(plainly, optimum, FitOptions(force_scale=FORCE, displacement_scale=MOVED))  # type: ignore[arg-type]
    assert found is not None
    for row, scales in zip(found.changes, ((1.02, 1.0), (1.0, 1.01)), strict=True):
        other = problem(MODELS[name], *scales)
        point, *_ = improve(other, optimum.point, 12, steps_of(optimum), 3.0)
        moved = space.to_values(point) - space.to_values(optimum.point)
        noise = 2.0 * optimum.errors * space.slopes(optimum.point)
        assert np.all(np.abs(row - moved) <= 0.1 * np.abs(moved) + noise), (row, moved)
        if name != "known inertance":
            law = [space.values_by_name(optimum.point)[n] * POWERS[n][scales[0] == 1.0] for n in space.names]
            assert row == pytest.approx(np.array(law) * (sum(scales) - 2.0))


def test_both_errors_add_up_in_squares_and_a_single_end_moves_by_the_scale() -> None:
    effects = ScaleEffects(np.array([[2.0, 0.0], [0.0, 0.0]]), np.array([0.02, 0.01]))
    low, high = effects.widen(0, (97.0, 104.0), 100.0, (True, True))
    assert (100.0 - low, high - 100.0) == pytest.approx((np.hypot(3.0, 3.92), np.hypot(4.0, 3.92)), rel=1e-3)
    assert effects.widen(1, (25.0, 500.0), 500.0, (True, False)) == pytest.approx(
        (25.0 * (1 - 0.0196), 500.0), rel=1e-4
    )
    assert effects.widen(1, (0.0, 2.0), 1.0, (False, True)) == pytest.approx((0.0, 2.0 * 1.0196), rel=1e-4)


@pytest.mark.campaign
def test_values_follow_the_scales_that_are_given() -> None:
    record = it.VirtualRig(it.Inerter(56.6), sampling=200.0).run(it.cosine(2e-3, 3.0), duration=1.0)
    ideal = it.Inerter(it.free(1.0, 500.0, name="b"))
    free = it.identify(record, ideal, starts=8)
    fit = it.identify(record, ideal, starts=8, force_scale="1.05 +- 2 % (k = 2)", displacement_scale="0.98 +- 0.5 %")
    b, before = fit.parameters["b"], free.parameters["b"]
    assert b.value == pytest.approx(before.value * 1.05 / 0.98, rel=1e-4)
    error = float(np.hypot(before.standard_error * b.value / before.value, b.value * np.hypot(0.01, 0.005)))
    assert b.standard_error == pytest.approx(error, rel=0.05)
    assert b.interval[1] - b.interval[0] == pytest.approx(3.92 * error, rel=0.05)
    assert np.sqrt(fit.covariance[0, 0]) == pytest.approx(error, rel=0.05)
    notes = " ".join(fit.notes)
    assert "scale of the force of 1.05 +- 1 %" in notes
    assert "0.98 +- 0.5 %" in notes
    assert "compliance between encoder and device" in notes
    assert "errors in the scale of the force and the displacement: 1 % more force" in " ".join(free.notes)
    assert any(f.kind == "calibrate" for f in fit.suggestions)  # no other motion makes it known better


@pytest.mark.parametrize("name", ["force", "displacement"])
def test_a_scale_that_no_reading_can_be_multiplied_by_is_named(name: str) -> None:
    """Readings that are then infinite are not missing: no gaps can be filled."""
    time = np.arange(200) / 100.0
    record = it.Record(time, 5.0 + 0.5 * np.sin(time), 10.0 * np.sin(time), source="bench.csv")
    with pytest.raises(RecordError, match=rf"^The {name} of 'bench.csv' has values .* multiplied by 1e\+308.* scale"):
        it.identify(record, "ideal", **{f"{name}_scale": 1e308})


@pytest.mark.parametrize(
    "wrong",
    [
        {"force_scale": "one"},
        {"displacement_scale": "1 +- 70 %"},
        {"force_scale": -1.0},
        {"gain": True, "force_scale": "1 +- 1 %"},
    ],
)
def test_scales_that_cannot_be_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(IdentificationError, match=r"force_scale|displacement_scale"):
        FitOptions(**wrong)  # type: ignore[arg-type]


@pytest.mark.marathon
@pytest.mark.timeout(3600)
def test_intervals_with_drawn_errors_of_scale_hold_the_truth() -> None:
    held = []
    for number in range(60):
        random, case = np.random.default_rng([77, number]), replace(clean(number, 21)[0], duration=1.5)
        record = record_of(case, number)
        force, moved = 1.0 + 0.02 * random.standard_normal(), 1.0 + 0.01 * random.standard_normal()
        read = replace(record, force=record.force / force, displacement=record.displacement / moved)
        fit = it.identify(read, model_of(case), starts=8, force_scale=FORCE, displacement_scale=MOVED)
        for name, p in fit.parameters.items():
            if fit.identifiable[name] and fit.status.ok:
                held.append(p.interval[0] <= case.truth[name] <= p.interval[1])
    assert sum(held) >= binom.ppf(0.025, len(held), 0.95)
