import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from campaigns import sampled
from hypothesis import given, settings
from hypothesis import strategies as st
from rigs import BALL_SCREW, PAPER, device, fit_test
from scipy.stats import chi2

import inerter as it
from inerter.identification.experiment import experiment_of, load_cell_output
from inerter.identification.initial_estimate import chain_of, guess_of
from inerter.identification.models import MODELS
from inerter.identification.noise import noise_whitening
from inerter.identification.parameter_space import space_of
from inerter.identification.residual_tests import portmanteau
from inerter.identification.statements.findings import FitFinding
from inerter.identification.verdicts import suggestions
from inerter.systems.piecewise import piecewise

QUIET = {"encoder_noise": 0.0, "encoder_resolution": 0.0, "force_noise": 0.0, "force_resolution": 0.0}


@pytest.fixture(scope="module")
def paper() -> it.Fit:
    return it.identify([fit_test(seed=1, duration=2.5)], BALL_SCREW, seed=0, starts=16)


@pytest.mark.campaign
def test_the_experiment_of_the_paper(paper):
    """Every parameter within 2 % of the truth and inside its interval; no backlash is an upper bound, not a number."""
    assert paper.status.ok
    for name in ("ks", "cs", "b", "f"):
        parameter = paper.parameters[name]
        assert parameter.value == pytest.approx(PAPER[name], rel=0.02)
        assert parameter.interval[0] <= PAPER[name] <= parameter.interval[1]
        assert paper.identifiable[name]
    gap = paper.parameters["gap"]
    assert math.isnan(gap.value)
    assert gap.interval[0] == 0.0
    assert gap.interval[1] < 1e-6
    assert not paper.identifiable["gap"]
    assert "not identifiable: only an upper bound, " in paper.identifiable["gap"].sentence
    assert any(sentence.startswith("gap:") for sentence in paper.next_experiment)


@pytest.mark.campaign
def test_no_motion_is_proposed_for_a_gap_within_a_step_of_the_encoder(paper):
    """An encoder of 1 um cannot show a gap that is crossed within 1 um, whatever the motion."""
    space = SimpleNamespace(names=("gap",), kinds=(it.Gap,))
    found = {}
    for upper in (0.4e-6, 0.6e-6):
        parameters = {"gap": replace(paper.parameters["gap"], interval=(0.0, upper))}
        (found[upper],) = suggestions(space, parameters, paper.identifiable, paper.comparisons)
    assert [finding.kind for finding in found.values()] == [FitFinding.BELOW_RESOLUTION, FitFinding.FASTER_REVERSALS]
    assert "less than a step of the displacement (1 um)" in found[0.4e-6].sentence
    assert "crossing 1.2 um takes several samples" in found[0.6e-6].sentence


@pytest.mark.campaign
def test_what_a_fit_says_of_itself(paper):
    comparison = paper.comparisons[0]
    assert comparison.variance_explained() > 0.999
    assert comparison.variance_explained(check=True) > 0.999
    assert comparison.rms() < 0.3
    assert comparison.whiteness > 1e-3
    assert paper.correlation.shape == (5, 5)
    assert np.allclose(np.diag(paper.correlation), 1.0)
    assert paper.covariance[3, 3] > 0.0
    assert it.Rig(paper.device).free_values() == {}
    for parameter in paper.parameters.values():  # profiles touch zero at the best fit and rise to the threshold
        assert min(rise for _, rise in parameter.profile) == 0.0
        assert max(rise for _, rise in parameter.profile) > 0.7


@pytest.mark.marathon
def test_backlash_is_found_where_it_rattles():
    fit = it.identify([fit_test(seed=2, gap=1e-4)], BALL_SCREW, seed=0)
    assert fit.parameters["gap"].value == pytest.approx(1e-4, rel=0.02)
    assert fit.parameters["b"].value == pytest.approx(113.0, rel=0.02)
    assert list(fit.comparisons[0].openings) == ["gap"]
    assert fit.comparisons[0].openings["gap"] > 20


FREE_SHAFT = it.Spring(it.free(1e5, 1e7, name="ks")) | it.Damper(it.free(100, 2e4, name="cs"))
FREE_FLYWHEEL = it.Inerter(it.free(10, 500, name="b")) | it.Friction(it.free(0, 100, name="f"))


@pytest.mark.parametrize("kind", sampled(["rigid", "elastic"], kept=1))
def test_two_records_share_parameters_and_have_their_own_offsets(kind):
    """One record tells the friction, the other the rest; the load cell is set to zero anew for each."""
    model = FREE_FLYWHEEL if kind == "rigid" else FREE_SHAFT - FREE_FLYWHEEL
    names = list(it.Rig(model).free_values())
    true = it.Rig(model).with_values({name: PAPER[name] for name in names}).device
    first = it.VirtualRig(true, seed=3, force_offset=4.0).run(it.cosine(amplitude=1e-3, frequency=3.0), 2.0)
    slow = it.VirtualRig(true, seed=4, force_offset=-2.5).run(it.cosine(amplitude=5e-3, frequency=0.5), 4.0)
    fit = it.identify([first, slow], model, seed=0, starts=8)
    assert [c.offset for c in fit.comparisons] == pytest.approx([4.0, -2.5], abs=0.02)
    for name in names:
        assert fit.parameters[name].value == pytest.approx(PAPER[name], rel=0.02)


@pytest.mark.parametrize("kind", sampled(["rigid", "elastic"], kept=0))
def test_gain_and_delay_of_the_sensor(kind):
    flywheel = it.Inerter(113.0) | it.Friction(it.free(0, 100, name="f"))
    shaft = it.Spring(it.free(1e5, 1e7, name="ks")) | it.Damper(it.free(100, 2e4, name="cs"))
    model = flywheel if kind == "rigid" else shaft - flywheel
    true = it.Rig(model).with_values({name: PAPER[name] for name in it.Rig(model).free_values()})
    rig = it.VirtualRig(true.device, seed=5, force_gain=1.05, force_delay=0.004)
    record = rig.run(it.cosine(amplitude=1e-3, frequency=3.0), duration=2.0)
    fit = it.identify([record], model, seed=0, gain=True, delay=True, starts=8)
    assert fit.parameters["sensor gain"].value == pytest.approx(1.05, rel=2e-3)
    assert fit.parameters["sensor delay"].value == pytest.approx(0.004, abs=2e-4)
    assert any(note.startswith("sensor delay: the force lags the displacement, by ") for note in fit.notes)
    assert fit.parameters["f"].value == pytest.approx(10.0, rel=0.02)


@pytest.mark.campaign
def test_a_reversed_load_cell_is_noticed():
    rig = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), seed=6, reversed=True)
    turned = it.identify([rig.run(it.cosine(1e-3, 3.0), 1.0)], FREE_FLYWHEEL, seed=0, starts=8)
    assert any("reversed" in note for note in turned.notes)
    assert turned.parameters["b"].value == pytest.approx(113.0, rel=0.02)


@pytest.mark.campaign
def test_times_that_a_file_rounds_are_even_ones():
    """2048 samples a second have intervals of 0.48828125 ms, which seven decimals show as 0.4882 and 0.4883 ms."""
    true = it.Inerter(113.0) | it.Friction(10.0)
    record = it.VirtualRig(true, sampling=2048.0, seed=6).run(it.cosine(1e-3, 6.0), 0.5)
    found = it.identify([replace(record, time=np.round(record.time, 7))], FREE_FLYWHEEL, seed=0, starts=8)
    assert found.parameters["b"].best == pytest.approx(113.0, rel=0.02)


@pytest.mark.campaign
def test_a_record_that_begins_in_motion():
    """The start of the device is then unknown, and is left out for as long as it matters."""
    rig = it.VirtualRig((it.Spring(1e6) | it.Damper(3200.0)) - (it.Inerter(113.0) | it.Friction(10.0)), seed=7)
    record = rig.run(it.cosine(amplitude=1e-3, frequency=3.0), duration=5.0, start=0.1)
    fit = it.identify([record], FREE_SHAFT - (it.Inerter(113.0) | it.Friction(10.0)), seed=0, starts=8)
    assert fit.comparisons[0].lead >= 0.5
    assert fit.parameters["ks"].value == pytest.approx(1e6, rel=0.02)


@pytest.mark.campaign
def test_what_is_not_identifiable_gets_no_number():
    """A slow motion tells the friction; nothing of the inertance but that it is small."""
    record = it.VirtualRig(device(b=5.0), seed=8).run(it.cosine(amplitude=1e-3, frequency=0.4), duration=3.0)
    model = (it.Spring(1e6) | it.Damper(3200)) - (
        it.Inerter(it.free(0.1, 500, name="b")) | it.Friction(it.free(0, 100, name="f"))
    )
    fit = it.identify([record], model, seed=0, starts=8)
    assert fit.parameters["f"].value == pytest.approx(10.0, rel=0.02)
    assert math.isnan(fit.parameters["b"].value) == (not fit.identifiable["b"])
    assert fit.parameters["b"].interval[1] > 1.2 * fit.parameters["b"].interval[0]
    assert fit.parameters["b"].interval[0] <= 5.0 <= fit.parameters["b"].interval[1]


@pytest.mark.campaign
def test_a_model_that_is_not_the_device_says_so():
    record = fit_test(seed=9, duration=1.5)
    fit = it.identify(
        [record], it.Spring(it.free(1e3, 1e6, name="k")) | it.Damper(it.free(1, 1e4, name="c")), seed=0, starts=8
    )
    assert not fit.status.ok
    assert "explained" in fit.status.message
    assert all(math.isnan(p.value) for p in fit.parameters.values())


@pytest.mark.parametrize("gap", [0.0, 1e-4])
def test_perfect_sensors_are_predicted_to_rounding(gap):
    """The model that made a record predicts it: the load cell's filter and the table's motion are the same twice."""
    record = fit_test(gap=gap, sensors=QUIET)
    experiment = experiment_of(record, bandwidth=100.0)
    force = experiment.force(piecewise(it.Rig(device(gap=gap), record.force_bandwidth)))
    assert load_cell_output(record) == "reading_force"
    assert np.abs(force - record.force)[600:4900].max() < 2e-3 * np.abs(record.force).max() / 50.0


def test_the_first_guess_needs_no_simulation():
    experiment = experiment_of(fit_test(seed=3, sensors=QUIET))
    guess = guess_of(chain_of(it.Rig(BALL_SCREW).device), [experiment])
    assert guess["b"][0] == pytest.approx(113.0, rel=0.03)
    assert guess["f"][0] == pytest.approx(10.0, rel=0.1)


@given(st.lists(st.floats(1e-3, 1e6), min_size=5, max_size=5))
@settings(max_examples=30, deadline=None)
def test_coordinates_and_values_go_both_ways(factors):
    space = space_of(it.Rig(BALL_SCREW))
    values = np.clip(np.array(factors), space.lower, space.upper)
    assert space.to_values(space.to_coordinates(values)) == pytest.approx(values, rel=1e-12)


def test_residuals_like_those_of_the_sensors_are_white_and_others_are_not():
    """Whitened by the spectrum of draws, not by their own, which would excuse any."""
    rng = np.random.default_rng(0)
    drawn = rng.standard_normal((13, 6000))
    colour = np.array([np.convolve(row, [1.0, 0.8, 0.5, 0.2], "same") for row in drawn])
    by = noise_whitening(colour[:12], 1e-3, np.ones(6000, dtype=bool))
    assert chi2.sf(portmanteau(colour[12]), 20) < 1e-6
    assert chi2.sf(portmanteau(by(colour[12])), 20) > 1e-3
    assert chi2.sf(portmanteau(by(drawn[12])), 20) < 1e-6
    assert np.std(by(colour[12])) == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"records": []}, "requires a record"),
        ({"records": "bench.csv"}, "requires a record"),
        ({"model": it.Spring(1.0)}, "no free values"),
        ({"check": 0.9}, "fraction must be from 0 to 0.6"),
        ({"starts": 2}, "at least 8"),
        ({"delay": -1.0}, "delay must be True, False or its largest size in s, got -1.0"),
        ({"delay": 0.6}, "up to 0.6 s is sought, but .* lasts 1 s"),
        ({"records": [fit_test(duration=0.03)], "delay": True}, "up to 20 ms is sought, but .* lasts 30 ms"),
        ({"gain": True}, "not identifiable"),
        ({"lead": 99.0}, "shorter"),
    ],
)
def test_requests_that_cannot_be(change, sentence):
    record = fit_test(duration=1.0)
    given_ = {"records": [record], "model": BALL_SCREW, **change}
    with pytest.raises(it.InerterError, match=sentence):
        it.identify(given_.pop("records"), given_.pop("model"), **given_)


@pytest.mark.parametrize("model", ["friction", "ball-screw"])
def test_a_force_of_noise_alone_is_guessed_from_its_largest(model: str) -> None:
    """A load cell that is not connected: nothing of its low-passed force exceeds the noise."""
    record = fit_test(duration=1.0)
    noise = 20.0 * np.random.default_rng(0).standard_normal(record.time.size)
    guess = guess_of(chain_of(it.Rig(MODELS[model]).device), [experiment_of(record.with_notes(force=noise))])
    assert all(np.isfinite(value) and np.isfinite(width) for value, width in guess.values())


def test_constant_channels_are_refused():
    record = fit_test(duration=1.0)
    for name in ("displacement", "force"):
        flat = record.with_notes(**{name: np.full(record.time.size, 2.0)})
        with pytest.raises(it.InerterError, match="constant"):
            it.identify([flat], BALL_SCREW)


def test_a_load_cell_that_is_far_faster_than_the_samples_is_refused():
    """Times in ms that count as s: each of these steps would be computed in a thousand."""
    record = fit_test(duration=1.0)
    refused = pytest.raises(it.InerterError, match=r"are 1 s apart, .* of 1000 Hz is too fast .* unit of its times")
    with pytest.warns(UserWarning, match="implausibly slow"), refused:
        it.identify([record.with_notes(time=1e3 * record.time, force_bandwidth=1e3)], BALL_SCREW)


IMPOSSIBLE = {
    "forces of nN": ({"force": 1e-8}, BALL_SCREW, r"N r\.m\.s\., .* is at least .* units of the record"),
    "forces of GN": ({"force": 1e9}, "friction", r"N r\.m\.s\., .* is at most .* units of the record"),
    "times in ms as s": (
        {"time": 1e3},
        "friction",
        r"are 1 s apart, at which the device is too fast.* unit of its times",
    ),
}


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("what", IMPOSSIBLE)
def test_records_that_no_values_within_the_bounds_can_explain_are_refused_at_once(what: str) -> None:
    """A search for them would end far from the record, after minutes or hours."""
    factors, model, sentence = IMPOSSIBLE[what]
    record = fit_test(duration=1.0)
    wrong = record.with_notes(**{name: factor * getattr(record, name) for name, factor in factors.items()})
    with pytest.raises(it.InerterError, match=sentence):
        it.identify(wrong.with_notes(force_range=None, force_bandwidth=None, force_noise=None), model)


SENSORS = {
    "displacement_noise": (
        1.0,
        r"displacement of .* is stated as 1 m r\.m\.s\., more than the displacement itself, .*unit",
    ),
    "force_noise": (1e5, r"noise of the force of .* is stated as .* r\.m\.s\., more than the force itself, .*unit"),
    "fixture_mass": (
        1e9,
        r"A fixture of 1e\+09 kg between load cell and device takes .* the load cell reads .* unit of the",
    ),
    "force_bandwidth": (1e-300, r"A load cell of 1e-300 Hz reads nothing of .*, which lasts 1 s\. Check the unit"),
}


@pytest.mark.parametrize("name", SENSORS)
def test_stated_sensors_that_leave_nothing_to_fit_are_refused(name):
    wrong, sentence = SENSORS[name]
    with pytest.raises(it.InerterError, match=sentence):
        it.identify([fit_test(duration=1.0).with_notes(**{name: wrong})], BALL_SCREW)
