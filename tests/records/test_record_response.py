"""Frequency responses of records against closed forms, and how often their bands hold the truth."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from campaigns import sampled
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

import inerter as it
from inerter.errors import LinearSystemError, RecordError
from inerter.records.periods import period_of
from inerter.records.response import ESTIMATORS, _resolution_notes
from inerter.records.smoothing import resolution
from inerter.records.spectra import HarmonicLines

RATE = 500.0
OMEGA = 2.0 * np.pi
DEVICE = it.Spring(2e4) | it.Damper(300.0) - it.Inerter(40.0)


def response_of(device, omega):
    return 1j * omega * device.admittance(1j * omega)


def multisine(seed, device=DEVICE, period=2.0, count=40, periods=5, rate=RATE, slope=1.0):
    """A record without noise of a linear device in its steady state, from its formula."""
    rng = np.random.default_rng(seed)
    omega = OMEGA / period * np.arange(1, count + 1)
    lines = 1e-3 * (omega / omega[0]) ** -slope * np.exp(2j * np.pi * rng.uniform(size=count))
    time = np.arange(round(periods * period * rate)) / rate
    waves = np.exp(1j * np.outer(time, omega))
    return it.Record(time, (waves @ lines).real, (waves @ (lines * response_of(device, omega))).real)


def noisy(record, seed, force, displacement=0.0):
    rng = np.random.default_rng([seed, 7])
    return record.with_notes(
        displacement=record.displacement + displacement * rng.normal(size=record.time.size),
        force=record.force + force * rng.normal(size=record.time.size),
    )


def random(seed, device=DEVICE, samples=20000, force=0.0, displacement=0.0):
    """A record of a random displacement, band-limited, with its force by Fourier transform (it repeats, unseen)."""
    rng = np.random.default_rng(seed)
    spectrum = np.fft.rfft(rng.normal(size=2 * samples))
    frequency = np.fft.rfftfreq(2 * samples, 1.0 / RATE)
    spectrum *= 1e-3 / (1.0 + (frequency / 10.0) ** 4) * (frequency > 0.0)
    omega = np.maximum(OMEGA * frequency, 1e-9)
    x, f = (np.fft.irfft(s)[:samples] for s in (spectrum, spectrum * response_of(device, omega)))
    return noisy(it.Record(np.arange(samples) / RATE, x, f), seed, force, displacement)


@pytest.mark.parametrize(("samples", "enough"), [(16, True), (15, False)])
def test_the_shortest_segment_has_sixteen_samples(samples, enough):
    segment = samples / RATE
    if enough:
        it.frequency_response(random(0, force=0.5), segment=segment)
    else:
        with pytest.raises(RecordError, match="at least 16 samples"):
            it.frequency_response(random(0, force=0.5), segment=segment)


WEIGHTS = np.abs(np.fft.fft(signal.windows.hann(64, sym=False))[[-1, 0, 1]]) ** 2  # of a line and its neighbours


@pytest.mark.parametrize(("share", "told"), [(0.97, True), (1.03, False)])
def test_a_bend_that_a_window_levels_by_more_than_the_band_is_told(share, told):
    """A response that is a parabola of the frequency, and what the mean under a Hann window's spectrum makes of it."""
    line = np.arange(20.0)
    shift = np.average([1.0, 0.0, 1.0], weights=WEIGHTS)
    gain = 1e3 + line**2
    found = it.Response(
        omega=OMEGA * (1.0 + line), gain=gain, phase=np.zeros(20), coherence=np.ones(20),
        band=gain + share * shift * np.array([[-1.0], [1.0]]), phase_band=np.zeros((2, 20)),
        averages=np.full(20, 9.0), amplitude=1.0, estimator="H1", source="parabola",
    )  # fmt: skip
    assert [note.partition(":")[0].partition("response at ")[2] for note in _resolution_notes(found)] == [
        "18 frequencies"
    ] * told


# --- periodic -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slope", sampled([0.0, 1.0, 2.0], [1.0]))
def test_a_simulated_steady_state_is_the_linear_response(slope):
    """The rig's own linear system, through a simulation, at the lines of a multisine: without noise exact."""
    omega = OMEGA * 0.5 * np.arange(1, 31)
    truth = it.linear_response(DEVICE, omega)
    system = it.state_space(it.Rig(DEVICE), outputs="device_force")
    assert truth.value == pytest.approx(1j * omega * it.frequency_response(system, omega)[:, 0, 0], rel=1e-9)
    time, moved = np.arange(2000) / 1000.0, multisine(0, count=30, periods=1, rate=1000.0, slope=slope)
    source = it.Signal.sampled(
        np.append(moved.time, 2.0), np.append(moved.displacement, moved.displacement[0]), periodic=True
    )
    run = it.simulate(it.Rig(DEVICE), displacement=source, initial="periodic", step=1e-3)
    x, force = (np.tile(run[name][:2000], 3) for name in ("displacement", "device_force"))
    assert time.size == 2000
    found = it.frequency_response(it.Record(np.arange(6000) / 1000.0, x, force))
    assert found.omega == pytest.approx(omega, rel=1e-9)
    assert np.abs(found.value / truth.value - 1.0).max() < 1e-6
    assert found.coherence == pytest.approx(1.0, abs=1e-12)
    assert found.status.ok


def coverage(responses, device):
    """The parts of frequencies at which the bands of gain and phase hold those of the device, and their number."""
    hits, count = np.zeros(2), 0
    for found in responses:
        truth = response_of(device, found.omega)
        for i, (value, band) in enumerate(((np.abs(truth), found.band), (np.angle(truth), found.phase_band))):
            hits[i] += np.sum((band[0] <= value) & (value <= band[1]))
        count += found.omega.size
    return hits / count, count


@pytest.mark.parametrize(("records", "known"), sampled(product([1, 4], [True, False]), [(1, True), (4, False)]))
def test_the_band_of_periodic_records_holds_the_truth_in_95_of_100(records, known):
    """Noise in force and displacement: both bands, of one record and of several."""
    responses = []
    for seed in range(40 // records):
        parts = [noisy(multisine(10 * seed + i, periods=4), 10 * seed + i, 0.5, 1e-6) for i in range(records)]
        responses.append(it.frequency_response([part.with_notes(period=2.0 if known else None) for part in parts]))
    held, count = coverage(responses, DEVICE)
    assert count > 1500 / records
    assert np.all((held > 0.92) & (held < 0.975)), held


def test_noise_in_the_displacement_does_not_bias_the_mean_over_periods():
    record = noisy(multisine(1, periods=400, count=5), 1, 0.0, 3e-4)
    found = it.frequency_response(record.with_notes(period=2.0))
    truth = response_of(DEVICE, found.omega)
    assert np.all(np.abs(np.abs(found.value / truth) - 1.0) < 0.01)
    assert found.coherence.max() > 0.9


def sine(frequency, line):
    """A record of the device under the real part of a rotating line."""
    time = np.arange(line.size) / RATE
    return it.Record(time, line.real, (line * response_of(DEVICE, np.array([OMEGA * frequency]))).real)


@settings(max_examples=30)
@given(st.floats(0.31, 20.0), st.floats(1e-5, 1e-2), st.floats(-np.pi, np.pi), st.integers(0, 2**32 - 1))
def test_a_sine_of_any_frequency_is_one_line(frequency, amplitude, phase, seed):
    time = np.arange(4000) / RATE
    line = amplitude * np.exp(1j * (OMEGA * frequency * time + phase))
    found = it.frequency_response(noisy(sine(frequency, line), seed, 1e-9 * amplitude))
    assert found.frequency == pytest.approx([frequency], rel=1e-5)
    assert found.value == pytest.approx(response_of(DEVICE, found.omega), rel=1e-4)
    assert "Sinusoidal excitation" in found.notes[-1]


@given(st.floats(2.0, 50.0), st.floats(0.5, 5.0), st.integers(75, 1250))
@settings(max_examples=40)
def test_friction_turns_the_gain_of_a_sine_by_its_describing_function(force, frequency, quarter):
    """b | f moved by X sin(omega t): F = -b omega^2 X + j 4 f / pi at the fundamental (Gelb and Vander Velde 1968)."""
    amplitude, omega, b, samples = 1e-3, OMEGA * frequency, 113.0, 4 * quarter
    angle = 2.0 * np.pi * (np.arange(5 * samples) + 0.5) / samples
    x = amplitude * np.sin(angle)
    record = it.Record(angle / omega, x, -b * omega**2 * x + force * np.sign(np.cos(angle)))
    found = it.frequency_response(record)
    expected = -b * omega**2 + 1j * 4.0 * force / np.pi / amplitude
    assert found.value == pytest.approx([expected], rel=20.0 / samples**2)
    again = it.frequency_response(record.with_notes(displacement=2.0 * x, force=record.force - b * omega**2 * x))
    assert abs(again.value[0].imag) == pytest.approx(0.5 * abs(found.value[0].imag), rel=0.02)


def test_a_sine_tells_its_harmonics():
    angle = 2.0 * np.pi * (np.arange(6000) + 0.5) / 1000
    record = it.Record(angle, np.sin(angle), 10.0 * np.sign(np.cos(angle)))
    assert (
        "of the force 48 % (the third alone 33 %)" in it.frequency_response(record).notes[-1]
    )  # sqrt(pi^2/8 - 1), 1/3


def test_sines_of_several_frequencies_tell_one_response():
    frequencies = (1.0, 2.5, 7.0)
    time = np.arange(3000) / RATE
    parts = [sine(frequency, 1e-3 * np.exp(1j * OMEGA * frequency * time)) for frequency in frequencies]
    found = it.frequency_response(parts[::-1])
    assert found.frequency == pytest.approx(frequencies, rel=1e-9)
    assert found.value == pytest.approx(response_of(DEVICE, found.omega), rel=1e-7)


def test_what_has_not_settled_is_left_out():
    record = multisine(3, periods=8)
    start = 200.0 * np.exp(-record.time / 0.7)
    found = it.frequency_response(noisy(record.with_notes(force=record.force + start), 3, 0.01))
    assert found.averages[0] < 8
    assert any("transient in the force" in note for note in found.notes)
    assert found.value == pytest.approx(response_of(DEVICE, found.omega), rel=5e-3)


def test_only_the_lines_of_the_excitation_are_told():
    """Every third harmonic is excited; a steep spectrum, an encoder and noise do not add any."""
    rng = np.random.default_rng(0)
    order = np.arange(3, 120, 3)
    time = np.arange(5000) / RATE
    lines = 1e-2 / order**2 * np.exp(2j * np.pi * rng.uniform(size=order.size))
    x = (np.exp(1j * OMEGA / 2.0 * np.outer(time, order)) @ lines).real
    x = 1e-7 * np.round((x + 2e-8 * rng.normal(size=x.size)) / 1e-7)
    found = it.frequency_response(it.Record(time, x, x * 1e4))
    assert found.frequency == pytest.approx(order / 2.0, rel=1e-6)


@pytest.mark.parametrize("periods", [2, 5, 20])
def test_noise_far_above_the_excitation_is_none_of_it(periods):
    for seed in range(10):
        record = noisy(multisine(seed, periods=periods, slope=0.0), seed, 1.0, 3e-5)
        assert it.frequency_response(record.with_notes(period=2.0)).frequency == pytest.approx(np.arange(1, 41) / 2.0)


def test_a_displacement_that_changes_is_told():
    record = multisine(0, periods=12)
    swell = 1.0 + 0.5 * np.sin(0.3 * record.time)
    found = it.frequency_response(
        record.with_notes(displacement=swell * record.displacement, force=swell * record.force, period=2.0)
    )
    assert found.status.kind is it.StatusKind.INACCURATE
    assert "check its period" in found.status.message


@given(st.floats(0.2, 3.0), st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_the_period_is_found(period, seed):
    record = multisine(seed, period=period, periods=7.3 / period * 1.0 if period > 2.4 else 3.4, count=12)
    record = noisy(record, seed, 0.0, 1e-6)
    assert period_of(record.displacement) == pytest.approx(period * RATE, abs=0.05)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=15)
def test_noise_and_sweeps_do_not_repeat(seed):
    assert period_of(random(seed, samples=4000).displacement) is None
    time = np.arange(5000) / RATE
    assert period_of(signal.chirp(time, 0.5, 10.0, 20.0, phi=seed % 360)) is None


def test_steps_of_an_encoder_are_seen():
    x = np.random.default_rng(0).normal(size=4000)
    assert resolution(0.01 * np.round(x / 0.01)) == pytest.approx(0.01)
    assert resolution(x) == 0.0
    assert resolution(np.tile(x[:10], 50)) == 0.0


# --- random -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("records", [1, 3])
def test_the_band_of_random_records_holds_the_truth_in_95_of_100(records):
    """A spring beside a damper: the response is smooth within a segment, so that only scatter is left."""
    device = it.Spring(2e4) | it.Damper(300.0)
    held, count = coverage(
        [
            it.frequency_response([random(10 * seed + i, device, force=0.2) for i in range(records)])
            for seed in range(30 // records)
        ],
        device,
    )
    assert count > 3000 / records
    assert np.all((held > 0.90) & (held < 0.99)), held


def test_more_averages_narrow_the_band_with_their_root():
    few, many = (it.frequency_response(random(0, samples=n, force=0.5), segment=2.0) for n in (10000, 160000))
    assert many.averages[0] / few.averages[0] == pytest.approx(16.0, rel=0.1)
    low = few.frequency < 8.0
    widths = [np.median((r.band[1] - r.band[0])[: low.sum()] / r.gain[: low.sum()]) for r in (few, many)]
    assert widths[0] / widths[1] == pytest.approx(4.0, rel=0.3)


def test_the_estimators_are_biased_as_they_are_said_to_be():
    """A spring with noise in one channel: H1 is k / (1 + noise), H2 is k (1 + noise), Hv lies between."""
    x = random(0, it.Spring(1e4), samples=200000).displacement
    rng = np.random.default_rng(1)
    white = np.fft.irfft(np.fft.rfft(rng.normal(size=x.size)) * np.abs(np.fft.rfft(x)) / np.sqrt(x.size))
    white *= 0.3 * x.std() / white.std()
    time = np.arange(x.size) / RATE
    gains = {}
    for estimator in ESTIMATORS:
        gains[estimator] = [
            np.median(it.frequency_response(it.Record(time, *pair), estimator=estimator).gain) / 1e4
            for pair in ((x, 1e4 * (x + white)), (x + white, 1e4 * x))
        ]
    assert gains["H1"] == pytest.approx([1.0, 1.0 / 1.09], rel=0.02)
    assert gains["H2"] == pytest.approx([1.09, 1.0], rel=0.02)
    assert gains["Hv"] == pytest.approx([1.09**0.5, 1.09**-0.5], rel=0.02)


def test_coherence_is_the_share_of_the_force_that_follows():
    record = random(5, it.Spring(1e4), samples=100000)
    rng = np.random.default_rng(2)
    same = np.fft.irfft(np.fft.rfft(rng.normal(size=100000)) * np.abs(np.fft.rfft(record.force)) / np.sqrt(1e5))
    same *= record.force.std() / same.std()
    found = it.frequency_response(record.with_notes(force=record.force + same), segment=2.0)
    assert np.median(found.coherence[found.frequency < 15.0]) == pytest.approx(0.5, abs=0.05)


def test_nothing_is_told_where_nothing_moves():
    found = it.frequency_response(random(0, force=1.0, displacement=1e-9))
    assert found.frequency.max() < 150.0
    assert np.all(np.isfinite(found.gain) & np.isfinite(found.band) & np.isfinite(found.phase))
    assert any("no displacement" in note for note in found.notes)


def test_a_sweep_tells_the_frequencies_that_it_passed():
    device = it.Spring(2e4) | it.Damper(300.0)
    time = np.arange(30000) / RATE
    angle = OMEGA * (1.0 * time + 0.5 * 9.0 / 60.0 * time**2)
    x, v = 1e-3 * np.sin(angle), 1e-3 * OMEGA * (1.0 + 9.0 / 60.0 * time) * np.cos(angle)
    found = it.frequency_response(noisy(it.Record(time, x, 2e4 * x + 300.0 * v), 0, 0.1))
    inside = found.lines((found.frequency > 1.5) & (found.frequency < 9.5))
    assert inside.omega.size > 20
    assert np.abs(inside.value / response_of(device, inside.omega) - 1.0).max() < 0.01


def test_a_resonance_that_the_segments_do_not_resolve_is_told():
    found = it.frequency_response(random(0, it.Spring(2e4) - it.Inerter(20.0)), segment=1.0)
    assert any("too short to resolve" in note for note in found.notes)


# --- laws ---------------------------------------------------------------------------------------------------------


@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3), st.booleans(), st.integers(0, 100))
@settings(max_examples=15)
def test_units_scale_the_gain_and_leave_phase_and_coherence(length, force, periodic, seed):
    record = noisy(multisine(seed), seed, 1.0) if periodic else random(seed, samples=4000, force=0.1)
    one = it.frequency_response(record)
    other = it.frequency_response(
        record.with_notes(displacement=length * record.displacement, force=force * record.force)
    )
    assert other.omega == pytest.approx(one.omega)
    assert other.band == pytest.approx(one.band * force / length, rel=1e-6)
    assert other.phase == pytest.approx(one.phase, abs=1e-8)
    assert other.coherence == pytest.approx(one.coherence, abs=1e-8)


@given(st.booleans(), st.integers(0, 100))
@settings(max_examples=15)
def test_bands_hold_the_estimate_and_passive_phases_do_not_jump(periodic, seed):
    record = noisy(multisine(seed), seed, 0.1) if periodic else random(seed, samples=8000, force=0.02)
    found = it.frequency_response(record)
    assert np.all((found.band[0] <= found.gain) & (found.gain <= found.band[1]) & (found.band[0] >= 0.0))
    assert np.all((found.phase_band[0] <= found.phase) & (found.phase <= found.phase_band[1]))
    assert np.all((found.coherence >= 0.0) & (found.coherence <= 1.0))
    assert np.all(np.diff(found.omega) > 0.0)
    strong = found.coherence > 0.99
    assert np.abs(np.diff(found.phase[strong])).max() < np.pi


# --- results and refusals -----------------------------------------------------------------------------------------


def test_results_to_xarray_and_csv(tmp_path):
    found = it.frequency_response(noisy(multisine(0), 0, 1.0))
    data = found.to_xarray()
    assert data["gain"].attrs["units"] == "N/m"
    assert data["gain_low"].values == pytest.approx(found.band[0])
    found.to_csv(tmp_path / "response.csv")
    header, *rows = (tmp_path / "response.csv").read_text(encoding="utf-8").splitlines()
    assert header.startswith("frequency [Hz],gain [N/m],gain_low [N/m]")
    assert [float(row.split(",")[1]) for row in rows] == found.gain.tolist()
    with pytest.raises(RecordError, match="Cannot write"):
        found.to_csv(tmp_path / "nowhere" / "response.csv")


TIME = np.arange(1000) / RATE
SINE = np.sin(OMEGA * TIME)


def of(x=SINE, f=SINE, time=TIME, **more):
    return it.Record(time, x, f, **more)


REFUSED = {
    "constant displacement": (
        lambda: it.frequency_response(of(x=np.ones(1000))),
        "displacement of 'record' is constant",
    ),
    "constant force": (lambda: it.frequency_response(of(f=np.ones(1000))), "force of record is constant"),
    "uneven": (lambda: it.frequency_response(of(time=TIME**1.1)), "Resample the record"),
    "four samples": (lambda: it.frequency_response(of(TIME[:4] ** 2, SINE[:4], TIME[:4])), "Too short"),
    "less than a period": (lambda: it.frequency_response(of(period=3.0)), "too few for one period of 3 s"),
    "one period": (lambda: it.frequency_response(of(period=1.5)), "Record two or more"),
    "a wrong period": (lambda: it.frequency_response(multisine(0).with_notes(period=1.37)), "Check the period"),
    "an estimator that is none": (lambda: it.frequency_response(of(), estimator="H3"), "H1, H2, Hv, got 'H3'"),
    "no length": (lambda: it.frequency_response(of(), segment=0.0), "positive number of s"),
    "too long": (lambda: it.frequency_response(of(), segment=5.0), "Too short"),
    "some repeat": (lambda: it.frequency_response([of(), random(0)]), "Estimate their responses separately"),
    "other rates": (
        lambda: it.frequency_response([random(0), random(1).with_notes(time=np.arange(20000) / 400.0)]),
        "Resample them",
    ),
    "frequencies": (lambda: it.frequency_response(of(), [1.0]), "leave out omega"),
    "nothing in common": (
        lambda: it.frequency_response(
            random(3).with_notes(force=np.random.default_rng(5).normal(size=20000)), segment=20.0
        ),
        "coherence between force and displacement",
    ),
}


@pytest.mark.parametrize(("ask", "message"), REFUSED.values(), ids=REFUSED)
def test_records_that_tell_nothing_are_refused_in_a_sentence(ask, message):
    with pytest.raises(RecordError, match=message):
        ask()


def test_a_linear_system_is_answered_as_before():
    system = it.LinearSystem([[-1.0]], [[1.0]], [[1.0]], [[0.0]])
    assert it.frequency_response(system=system, omega=[1.0])[0, 0, 0] == pytest.approx(0.5 - 0.5j)
    with pytest.raises(LinearSystemError, match="finite frequencies"):
        it.frequency_response(system)
    with pytest.raises(LinearSystemError):
        it.frequency_response("nothing", [1.0])
    with pytest.raises(RecordError, match="apply to records"):
        it.frequency_response(system, [1.0], segment=1.0)


@pytest.mark.parametrize(("share", "both"), [(0.2, False), (0.26, True)])
def test_a_second_sine_counts_by_its_share_of_the_squared_velocity(share, both):
    """95 % of it in one harmonic make a motion a sine: a second one counts from a velocity of 0.229 of the first on."""
    omega = OMEGA * np.arange(1.0, 41.0)
    rng = np.random.default_rng(3)
    x = 1e-9 * (rng.normal(size=(6, 40)) + 1j * rng.normal(size=(6, 40)))
    x[:, 1] += 1e-3
    x[:, 19] += share * 1e-3 * omega[1] / omega[19]
    chosen = HarmonicLines(omega, (x,), (x,), 0.0).is_excited()
    assert np.flatnonzero(chosen).tolist() == ([1, 19] if both else [1])
