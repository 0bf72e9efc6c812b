"""Roads of files: measured profiles, and tracks that differ, give what the same calls in Python give."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from study_text import assert_refused, load_text, study_text

import inerter as it
from inerter.app.documents import read
from inerter.errors import StudyError
from inerter.files.common.keys import find_keys, keys_of
from inerter.files.simulation.loading import load_simulation
from inerter.files.simulation.request import write_simulation
from inerter.files.study import KIND
from inerter.files.study.cases import cases, run_case
from inerter.files.study.checking import study_notes
from inerter.files.study.conditions import condition_of
from inerter.files.study.loading import load_study
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.results import dataset
from inerter.files.study.running import run_study
from inerter.files.study.study import StrutLayout, Study
from inerter.formatting import format_number
from inerter.methods.error_bounds import improvement_bound
from inerter.report.conclusions import conclusion_sentences
from inerter.report.verdicts import study_decision

ROUGH = 'roughness = "5e-7 m^3/cycle"'
CAR = """model = "full-car"
sprung_mass = "1400 kg"
pitch_inertia = "2400 kg m^2"
roll_inertia = "520 kg m^2"
unsprung_mass_front = "45 kg"
unsprung_mass_rear = "40 kg"
tyre_stiffness_front = "220 kN/m"
tyre_stiffness_rear = "220 kN/m"
distance_front = "1.2 m"
distance_rear = "1.5 m"
track_front = "1.52 m"
track_rear = "1.5 m"
"""
OWN = 'model = "mechanism"\n[vehicle.coordinates]\nbody = "250 kg"\nwheel = "35 kg"\n' + (
    "[vehicle.struts]\nstrut = { upper = { body = 1 }, lower = { wheel = 1 } }\n"
    '[vehicle.tyres]\nfirst = { port = { wheel = 1 }, road = "left", network = "k" }\n'
    'second = { port = { wheel = 1 }, road = "right", network = "k" }\n'
    '[vehicle.roads]\nleft = { track = "left" }\nright = {}\n'
    "[vehicle.measures]\ncomfort = { body_acceleration = 1 }\n"
)
FORMS = {
    'track = "1.5 m"': it.Coherence.isotropic(1.5),
    "level = 0.6": it.Coherence.constant(0.6),
    'wavenumber = "0.2 cycle/m"': it.Coherence.first_order(0.2),
    'wavenumber = "0.2 cycle/m", level = 0.7': it.Coherence.first_order(0.2, 0.7),
}


def text_of(road: str, *, vehicle: str = "", settings: str = 'indices = ["J1"]', more: str = "") -> str:
    """A study file with these lines in the place of a roughness, of a quarter car if no vehicle is given."""
    text = study_text(settings).replace(ROUGH, road) + more
    start, end = text.index('model = "quarter-car"'), text.index("[road]")
    return text[:start] + vehicle + text[end:] if vehicle else text


def heights(seed: int, waviness: float = 2.0, points: int = 2000, spacing: float = 0.1, class_of: float = 64e-6):
    """A random profile of that waviness, with Gd(n0) `class_of`."""
    n = np.fft.rfftfreq(points, spacing)[1:]
    size = np.sqrt(class_of * (n / 0.1) ** -waviness / (2.0 * spacing) * points)
    phases = np.exp(2j * np.pi * np.random.default_rng(seed).random(n.size))
    return np.fft.irfft(np.concatenate([[0.0], size * phases]), points)


def write_profile(path: Path, *tracks: np.ndarray, spacing: float = 0.1) -> Path:
    """A CSV file of one track, or of two."""
    names = ["left", "right"] if len(tracks) == 2 else ["height"]
    header = ",".join(["distance [m]", *(f"{name} [mm]" for name in names)])
    rows = np.column_stack([spacing * np.arange(tracks[0].size), *(1e3 * track for track in tracks)])
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.9g")
    return path


@pytest.fixture
def load(tmp_path: Path) -> Callable[..., Study]:
    """Loads a study file beside road.csv, a profile of two tracks."""
    write_profile(tmp_path / "road.csv", heights(1), heights(2))

    def load_file(road: str, **parts: str) -> Study:
        return load_text(tmp_path, text_of(road, **parts))

    return load_file


def full_car(strut: it.Network) -> it.FullCar:
    return it.FullCar(1400.0, 2400.0, 520.0, 45.0, 40.0, 220e3, 220e3, 1.2, 1.5, 1.52, 1.5, front=strut, rear=strut)


S1 = it.Spring(20e3, "k") | it.Damper(1e3, "c")


def value(study: Study) -> float:
    """The first value of a study."""
    case = next(iter(cases(study)))
    return float(run_case(study, case).values["norm"][case.index])


# --- the same as in Python ---


@pytest.mark.parametrize("form", FORMS)
def test_a_coherence_is_that_of_python_to_the_last_digit(load, form):
    study = load(f"{ROUGH}\ncoherence = {{ {form} }}", vehicle=CAR)
    road = it.Road(5e-7, 25.0, coherence=FORMS[form])
    assert study.road == road
    assert value(study) == it.evaluate(full_car(S1), it.RideComfort(road), it.Norm()).value


@pytest.mark.parametrize("track", ["", "left", "right"])
def test_a_profile_is_its_road_of_waviness_two(load, tmp_path, track):
    study = load('profile = "road.csv"' + (f'\ntrack = "{track}"' if track else ""))
    spectrum = it.road_spectrum(it.read_profile(tmp_path / "road.csv"), side=track)
    assert study.road == spectrum.road(25.0)
    assert study.road.shape == spectrum.road(25.0).shape
    case = next(iter(cases(study)))
    by_python = it.evaluate(study.design(case.layout), it.RideComfort(spectrum.road(25.0)), it.Norm())
    assert run_case(study, case).error_bounds["norm"]["J1"] == by_python.error_bound > 1e-3  # by the line
    assert study.road.roughness == pytest.approx(0.5 * 64e-6 * 0.01, rel=0.1)  # that it was made with
    assert value(study) == it.evaluate(study.design("S1"), it.RideComfort(spectrum.road(25.0)), it.Norm()).value


TWO_SPEEDS = """
[[conditions]]
road.speed = "15 m/s"
[[conditions]]
road.speed = "30 m/s"
"""


@pytest.mark.parametrize("over", ["", "mean", "worst"])
def test_designs_on_a_measured_road_share_its_errors(load, tmp_path, over):
    """Bounds of improvements are those of both estimates in Python, smaller than of values on roads of their own."""
    settings = 'indices = ["J1", "J3"]' + (f'\nconditions = "{over}"' if over else "")
    study = load('profile = "road.csv"', settings=settings, more=TWO_SPEEDS if over else "")
    study = replace(study, layouts={**study.layouts, "soft": StrutLayout({"strut": "k - k | c"})}, baseline="S1")
    data = run_study(study, tmp_path / "out").data
    bound_of_soft = data.improvement_bound.sel(layout="soft").sel({"method": "norm"})
    for index in study.indices:
        one, base = (it.evaluate(study.design(n), study.over_conditions(index), it.Norm()) for n in ("soft", "S1"))
        pairs, found = [(one, base)], [bound_of_soft.sel(index=index).item()]
        if over:
            pairs += zip(one.in_conditions, base.in_conditions, strict=True)
            here = data["in_conditions.improvement_bound"].sel(layout="soft", index=index).sel({"method": "norm"})
            found += here.values.tolist()
        for bound, (own, other) in zip(found, pairs, strict=True):
            errors = own.error_bound, other.error_bound, own.shared_errors, other.shared_errors
            assert bound == pytest.approx(improvement_bound(own.value, other.value, *errors), rel=1e-9)
        if over != "worst":  # where another condition may be the worst in truth
            assert found[0] < improvement_bound(one.value, base.value, one.error_bound, base.error_bound)
    softer = next(design for design in study_decision(data, "J1").designs if design.name == "soft")
    (load_of_it,) = softer.others
    assert load_of_it.improvement.bound == pytest.approx(bound_of_soft.sel(index="J3").item(), rel=1e-9)


def test_a_sweep_of_the_roughness_may_mix_its_units(load):
    study = load(
        ROUGH,
        settings='indices = ["J1"]\nsweep = { road.roughness = ["1 cm^3/cycle", "256e-6 m^3", "1e-5 m^3/cycle"] }',
    )
    assert study.sweeps[0].values == pytest.approx([1e-6, 0.5 * 256e-6 * 0.01, 1e-5], rel=1e-12)
    assert study.sweeps[0].written == ""  # in SI units


@pytest.mark.parametrize(("key", "unit", "other"), [("track", "m", 0.9), ("wavenumber", "cycle/m", 0.31)])
def test_numbers_of_a_coherence_are_swept_and_vary_between_conditions(load, key, unit, other):
    form = next(form for form in FORMS if form.startswith(key))
    parts = {
        "vehicle": CAR,
        "settings": f'indices = ["J1"]\nsweep = {{ road.coherence.{key} = ["1 {unit}", "{other} {unit}"] }}',
    }
    swept = load(f"{ROUGH}\ncoherence = {{ {form} }}", **parts)
    make = {"track": it.Coherence.isotropic, "wavenumber": it.Coherence.first_order}[key]
    assert [swept.at([v]).road.coherence for v in (1.0, other)] == [make(1.0), make(other)]
    more = f'[[conditions]]\n[[conditions]]\n"road.coherence.{key}" = "{other} {unit}"\nroad.speed = "20 m/s"\n'
    study = load(f"{ROUGH}\ncoherence = {{ {form} }}", vehicle=CAR, more=more)
    first, second = (condition_of(study, one).of(study.index("J1")).road for one in study.conditions)
    assert (first.coherence, first.speed) == (FORMS[form], 25.0)
    assert (second.coherence, second.speed) == (make(other), 20.0)


# --- written, resumed, in several processes ---


@pytest.mark.parametrize("form", FORMS)
def test_a_resolved_study_needs_no_profile(load, tmp_path, form):
    study = load(f'profile = "road.csv"\ncoherence = {{ {form} }}', vehicle=CAR)
    (tmp_path / "road.csv").unlink()
    again = tmp_path / "elsewhere.toml"
    again.write_text(write_resolved(study), encoding="utf-8")
    assert load_study(again) == study
    assert "road.csv" in again.read_text(encoding="utf-8")
    assert load_study(again).to_tables() == study.to_tables()


def test_a_profile_that_has_changed_is_another_study(load, tmp_path):
    text = {"road": 'profile = "road.csv"', "settings": 'indices = ["J1"]'}
    folder = tmp_path / "results"
    first = run_study(load(**text), folder)
    told = json.loads((folder / "versions.json").read_text(encoding="utf-8"))
    assert list(told["inputs"]) == ["road.csv"]
    assert len(told["inputs"]["road.csv"]) == 64
    assert first.data.attrs["notes"].startswith("the road is the spectrum of waviness 2 fitted to road.csv")
    assert run_study(load(**text), folder, resume=True).computed == 0
    before = (folder / "summary.csv").read_bytes()
    write_profile(tmp_path / "road.csv", 1.001 * heights(1), heights(2))
    with pytest.raises(StudyError, match=r'another study or version \(road\.roughness ".*" there, ".*" here\)'):
        run_study(load(**text), folder, resume=True)
    assert (folder / "summary.csv").read_bytes() == before


@pytest.mark.marathon
def test_processes_give_the_same_bytes(load, tmp_path):
    study = load(
        'profile = "road.csv"\ncoherence = { track = "1.5 m" }', vehicle=CAR, settings='indices = ["J1", "J3"]'
    )
    for jobs in (1, 2):
        run_study(study, tmp_path / f"{jobs}", jobs=jobs)
    for name in ("summary.csv", "study.resolved.toml", "versions.json"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes(), name


def test_a_profile_is_never_replaced_by_results(load, tmp_path):
    study = load('profile = "summary.csv"') if (tmp_path / "road.csv").rename(tmp_path / "summary.csv") else None
    with pytest.raises(StudyError):
        run_study(study, tmp_path, force=True)
    assert it.read_profile(tmp_path / "summary.csv").right is not None


# --- what is told ---


@pytest.mark.parametrize(
    ("waviness", "below"), [(1.2, "rougher than the measured one"), (2.0, ""), (3.1, "smoother than the measured one")]
)
def test_a_waviness_that_is_not_two_is_told_first(load, tmp_path, waviness, below):
    write_profile(tmp_path / "road.csv", heights(3, waviness, class_of=16e-6))
    study = load('profile = "road.csv"\nsampling = "filtered"')
    (note,) = study_notes(study)[:1]
    assert f"has a waviness of {format_number(study.line.spectrum.waviness, 3)}" in note
    assert study.line.spectrum.waviness == pytest.approx(waviness, abs=0.1)
    warnings = list(study.line.warnings)
    assert len(warnings) == bool(below)
    if below:  # where both lines are alike, the roughness is that of the profile
        (first,) = warnings
        assert below in first
        n = float(first.split("below ")[1].split()[0])
        assert 16e-6 * (n / 0.1) ** -waviness == pytest.approx(2 * study.road.roughness / n**2, rel=0.3)


def test_a_warning_is_the_first_line_of_the_answer(load, tmp_path):
    write_profile(tmp_path / "road.csv", heights(3, 3.1, class_of=16e-6))
    study = load('profile = "road.csv"')
    case = next(iter(cases(study)))
    data = dataset(study, {case: run_case(study, case)})
    assert conclusion_sentences(data, study)[0] == next(iter(study.line.warnings))
    assert len(conclusion_sentences(data, study)) > 1


def test_a_line_through_few_bands_is_told_first(load, tmp_path):
    write_profile(tmp_path / "road.csv", heights(4, points=20, spacing=1.0), spacing=1.0)
    study = load('profile = "road.csv"')
    told = list(study.line.warnings)
    assert f"no more than {study.line.spectrum.bands} bands of road.csv" in told[-1]
    assert told == [one for one in told if one.startswith("Beware")]


def test_what_explains_files_knows_roads():
    keys = keys_of(KIND.schema())
    places = {key.place for key in keys}
    assert places >= {f"road.{key}" for key in ("profile", "track", "coherence", "coherence.track", "coherence.level")}
    (corner,) = find_keys(keys, "coherence.wavenumber")
    assert (corner.unit, corner.example) == ("cycle/m", "0.2 cycle/m")


# --- what is said about a bad one ---

RANDOM = 'kind = "multisine"\nseed = 3'
COHERENT = f"{ROUGH}\ncoherence = "
BAD = {
    "roughness and profile": (f'{ROUGH}\nprofile = "road.csv"', "", "road", "both roughness and profile"),
    "class and profile": ('class = "C"\nprofile = "road.csv"', "", "road", "both class and profile"),
    "all three": (f'{ROUGH}\nclass = "C"\nprofile = "road.csv"', "", "road", "one of the three"),
    "none": ("", "", "road.roughness", "missing"),
    "no file": ('profile = "roads.csv"', "", "road.profile", "file not found"),
    "a folder": ('profile = "."', "", "road.profile", "this is a folder"),
    "not a name": ('profile = "a\\u0000b"', "", "road.profile", "."),
    "not text": ("profile = 3", "", "road.profile", "text"),
    "not a table": ('profile = "study.toml"', "", "road.profile", ".toml"),
    "nonsense": ('profile = "bad.csv"', "", "road.profile", "bad.csv"),
    "too short": ('profile = "short.csv"', "", "road.profile", "too short"),
    "flat": ('profile = "flat.csv"', "", "road.profile", "flat"),
    "no such track": ('profile = "one.csv"\ntrack = "left"', "", "road.profile", "unknown track"),
    "another word": ('profile = "road.csv"\ntrack = "middle"', "", "road.track", "right"),
    "track of nothing": (f'{ROUGH}\ntrack = "left"', "", "road", "got a track but no profile"),
    "interval of nothing": (f'{ROUGH}\ninterval = "1 m"', "", "road", "got an interval but no profile"),
    "columns of nothing": (f"{ROUGH}\ncolumns = {{ height = 1 }}", "", "road", "got columns but no profile"),
    "one track": (COHERENT + '{ track = "1.5 m" }', "", "road.coherence", "no left and right track"),
    "one of two": (COHERENT + "{ level = 0.5 }", OWN, "road.coherence", "right is on neither track"),
    "a vehicle that cannot be": (
        COHERENT + "{ level = 0.5 }",
        OWN.replace('road = "right"', 'road = "middle"'),
        "vehicle.tyres.second.road",
        "a road",
    ),
    "two forms": (COHERENT + '{ track = "1.5 m", level = 0.5 }', CAR, "road.coherence", "track alone"),
    "three forms": (
        COHERENT + '{ track = "1.5 m", wavenumber = "1 cycle/m" }',
        CAR,
        "road.coherence",
        "both track and wavenumber",
    ),
    "empty": (COHERENT + "{}", CAR, "road.coherence", "empty"),
    "too alike": (COHERENT + "{ level = 1.5 }", CAR, "road.coherence.level", "-1 to 1"),
    "with a unit": (COHERENT + '{ level = "0.5" }', CAR, "road.coherence.level", "without quotes"),
    "yes": (COHERENT + "{ level = true }", CAR, "road.coherence.level", "-1 to 1"),
    "unknown": (COHERENT + "{ distance = 1 }", CAR, "road.coherence.distance", "unknown key"),
    "negative": (COHERENT + '{ track = "-1 m" }', CAR, "road.coherence.track", "not positive"),
    "another unit": (COHERENT + '{ wavenumber = "0.2 rad/m" }', CAR, "road.coherence.wavenumber", "cycle/m"),
    "a word": (COHERENT + '"isotropic"', CAR, "road.coherence", "not a table"),
}


@pytest.mark.parametrize(("road", "vehicle", "place", "words"), BAD.values(), ids=BAD)
def test_a_bad_road_is_refused_with_the_place(load, tmp_path, road, vehicle, place, words):
    (tmp_path / "bad.csv").write_text("a,b\nx,y\n", encoding="utf-8")
    write_profile(tmp_path / "short.csv", heights(5, points=8))
    write_profile(tmp_path / "flat.csv", np.zeros(500))
    write_profile(tmp_path / "one.csv", heights(6))
    assert_refused(lambda: load(road, vehicle=vehicle), place, [words])


def test_a_missing_profile_is_told_with_the_other_problems(load):
    with pytest.raises(StudyError) as refused:
        load('profile = "roads.csv"', settings='indices = ["J1"]\nbaseline = "S7"')
    assert [line.split(": ")[1] for line in str(refused.value).splitlines()] == ["road.profile", "study.baseline"]


@pytest.mark.parametrize("label", ["road.coherence.level", "road.coherence.track", "road.coherence"])
def test_what_is_no_number_of_a_coherence_is_not_swept(load, label):
    form = 'wavenumber = "0.2 cycle/m", level = 0.7'
    settings = f'indices = ["J1"]\nsweep = {{ "{label}" = ["1 m", "2 m"] }}'
    with pytest.raises(StudyError, match=r"no number at road\.coherence"):
        load(f"{ROUGH}\ncoherence = {{ {form} }}", vehicle=CAR, settings=settings)


# --- the page, and simulations ---


def test_the_page_reads_profiles_beside_it_alone(tmp_path, monkeypatch):
    write_profile(tmp_path / "road.csv", heights(1))
    inside = tmp_path / "inside"
    inside.mkdir()
    monkeypatch.chdir(tmp_path)
    assert read(text_of('profile = "road.csv"'))["problems"] == []
    opened = read(text_of('profile = "road.csv"\ncoherence = { level = 0.5 }', vehicle=CAR))
    assert opened["study"]["road"] == {"speed": "25 m/s", "profile": "road.csv", "coherence": {"level": 0.5}}
    assert opened["problems"] == []
    write_profile(tmp_path / "road.csv", np.zeros(500))
    (problem,) = read(text_of('profile = "road.csv"'))["problems"]
    assert "flat" in problem["sentence"]
    monkeypatch.chdir(inside)
    for name in ("road.csv", "../road.csv", str(tmp_path / "road.csv")):
        (problem,) = read(text_of(f'profile = "{name}"'))["problems"]
        assert (problem["place"], "folder" in problem["sentence"]) == (["road", "profile"], True)


@pytest.mark.parametrize("form", FORMS)
def test_a_simulation_drives_over_both_tracks(tmp_path, form):
    request = simulation(tmp_path, f"{COHERENT}{{ {form} }}", f'{RANDOM}\nlowest = "1 Hz"\nhighest = "30 Hz"')
    expected = it.two_tracks(it.Road(5e-7, 25.0, coherence=FORMS[form]), 3, 1.0, 30.0)
    assert_same(request.signals(), expected)
    again = tmp_path / "again.toml"
    again.write_text(write_simulation(request), encoding="utf-8")
    assert load_simulation(again) == request


def test_a_simulation_drives_over_both_measured_tracks(tmp_path):
    path = write_profile(tmp_path / "road.csv", heights(1), heights(2))
    request = simulation(tmp_path, "", 'kind = "profile"\nfile = "road.csv"\ntrack = "both"')
    assert_same(request.signals(), it.read_profile(path).signals(25.0))
    run = request.run()
    alone = it.simulate(full_car(S1), road=it.read_profile(path).signals(25.0), duration=0.2, step=2e-4)
    assert np.array_equal(run["roll_acceleration"], alone["roll_acceleration"])
    assert run.rms("roll_acceleration") > 0.0
    measured = simulation(tmp_path, 'profile = "road.csv"\ntrack = "right"', 'kind = "multisine"')
    assert measured.roughness == it.road_spectrum(it.read_profile(path), side="right").road(1.0).roughness
    assert path in measured.inputs


@pytest.mark.parametrize(
    ("road", "signal", "vehicle", "place"),
    [
        (COHERENT + "{ level = 0.5 }", 'kind = "sine"\namplitude = "1 mm"\nfrequency = "2 Hz"', CAR, "road.coherence"),
        (COHERENT + "{ level = 0.5 }", 'kind = "multisine"', "", "road.coherence"),
        ("", 'kind = "profile"\nfile = "road.csv"\ntrack = "both"', "", "signal.track"),
        ("", 'kind = "profile"\nfile = "one.csv"\ntrack = "both"', CAR, "signal"),
        ('profile = "no.csv"', 'kind = "multisine"', CAR, "road.profile"),
    ],
)
def test_a_simulation_that_cannot_have_two_tracks_is_refused(tmp_path, road, signal, vehicle, place):
    write_profile(tmp_path / "road.csv", heights(1), heights(2))
    write_profile(tmp_path / "one.csv", heights(1))
    with pytest.raises(StudyError) as refused:
        simulation(tmp_path, road, signal, vehicle)
    (line,) = str(refused.value).splitlines()
    assert line.startswith(f"file.toml: {place}: ")


def simulation(folder: Path, road: str, signal: str, vehicle: str = CAR):
    text = text_of(road, vehicle=vehicle)
    text = text[: text.index("[study]")].replace('S2 = "k | c | b"\n', "")
    path = folder / "file.toml"
    path.write_text(f'{text}[signal]\n{signal}\n[simulation]\nduration = "0.2 s"\n', encoding="utf-8")
    return load_simulation(path)


def assert_same(signals, expected):
    time = np.linspace(0.0, 5.0, 101)
    assert list(signals) == list(expected) == ["left", "right"]
    for track in signals:
        assert np.array_equal(signals[track](time), expected[track](time))
    assert not np.array_equal(signals["left"](time), signals["right"](time))


@pytest.mark.parametrize(
    ("header", "renamed"),
    [
        ("recorrido [m], izquierda [mm], derecha [mm]", "distance [m], height [mm], other [mm]"),
        ("s [m], izquierda [mm], derecha [mm]", "s [m], height [mm], other [mm]"),
        ("weg, hoehe", "distance [m], height [mm]"),
        ("x, z", "x [m], z [mm]"),
        ("x [s], z [mm]", "x [m], z [mm]"),
        ("x [m], y [mm], z [mm]", "x [m], height [mm], other [mm]"),
        ("", "distance [m], height [mm]"),
    ],
)
def test_what_is_advised_about_the_columns_of_a_profile_can_be_done(header: str, renamed: str, tmp_path: Path) -> None:
    """In its file, or by the keys that are named, which may need to be followed one after another."""
    count, path = (header or renamed).count(",") + 1, tmp_path / "study.toml"
    rng = np.random.default_rng(9)
    heights = np.cumsum(rng.normal(size=(4000, count - 1)), axis=0)
    lines = [", ".join(f"{x:.6g}" for x in (0.1 * i, *row)) for i, row in enumerate(heights)]
    (tmp_path / "road.csv").write_text("\n".join([*filter(None, [header]), *lines]), encoding="utf-8")
    keys: dict[str, str] = {}
    while True:
        said = "".join(f"{key} = {{ {entries} }}\n" for key, entries in keys.items())
        path.write_text(text_of(f'profile = "road.csv"\n{said}'), encoding="utf-8")
        try:
            by_keys = load_study(path).line
            break
        except StudyError as error:
            (line,) = str(error).splitlines()
            assert "in the file" in line or "after the name" in line
            advised = re.search(r"(columns|units) = \{ (.*?) \}", line)
            assert advised, line
            key, entries = advised.groups()
            keys[key] = ", ".join(filter(None, [keys.get(key), entries]))
        assert len(said) < 200
    assert header == "x [s], z [mm]" or keys
    (tmp_path / "road.csv").write_text("\n".join([renamed, *lines]), encoding="utf-8")
    path.write_text(text_of('profile = "road.csv"'), encoding="utf-8")
    assert by_keys is not None
    assert by_keys.road.roughness == pytest.approx(load_study(path).line.road.roughness, rel=1e-12)


BAD_KEYS = {
    'columns = { depth = "z" }': "road.columns",
    "columns = { height = -1 }": "road.columns",
    "columns = 3": "road.columns",
    'units = { height = "N" }': "road.units",
    "units = {}": "road.units",
    'interval = "0 m"': "road.interval",
    'columns = { height = "no" }': "unknown or repeated column 'no' for the height",
}


@pytest.mark.parametrize("keys", BAD_KEYS)
def test_bad_keys_of_a_profile_are_one_sentence(keys: str, tmp_path: Path) -> None:
    (tmp_path / "road.csv").write_text("distance [m], height [mm]\n0, 1\n1, 2\n2, 1\n", encoding="utf-8")
    path = tmp_path / "study.toml"
    path.write_text(text_of(f'profile = "road.csv"\n{keys}'), encoding="utf-8")
    with pytest.raises(StudyError) as caught:
        load_study(path)
    (line,) = str(caught.value).splitlines()
    assert BAD_KEYS[keys] in line
    path.write_text(text_of(f'roughness = "5e-7 m^3/cycle"\n{keys}'), encoding="utf-8")
    with pytest.raises(StudyError):
        load_study(path)


def test_a_simulation_reads_a_profile_by_its_keys(tmp_path: Path) -> None:
    """A table without a header and with remarks, in a file in UTF-16: the motion of the same table with a header."""
    rows = [f"{0.1 * i:.1f};{np.sin(0.1 * i):.6f}".replace(".", ",") for i in range(400)]
    (tmp_path / "bare.csv").write_text("\n".join(f"{row};ok" for row in rows) + "\nEnde\n", encoding="utf-16")
    (tmp_path / "named.csv").write_text("\n".join(["distance [m];height [mm]", *rows]), encoding="utf-8")
    keys = 'columns = { distance = 0, height = 1 }\nunits = { distance = "m", height = "mm" }'
    bare = simulation(tmp_path, "", f'kind = "profile"\nfile = "bare.csv"\n{keys}', vehicle="")
    named = simulation(tmp_path, "", 'kind = "profile"\nfile = "named.csv"', vehicle="")
    time = np.linspace(0.0, 1.0, 50)
    assert np.array_equal(bare.make_signal()(time), named.make_signal()(time))
    (tmp_path / "again.toml").write_text(write_simulation(bare), encoding="utf-8")
    assert load_simulation(tmp_path / "again.toml") == bare
    assert "columns" not in named.to_tables()["signal"]
