"""`inerter export` as a person meets it."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy
from campaigns import sampled
from folders import EXAMPLES
from study_text import HALF_CAR, study_text, with_changes
from wang_su import J1, paper_quarter_car

import inerter as it
from inerter.cli.main import call

STUDY = (EXAMPLES / "quarter-car.toml").read_text(encoding="utf-8")
SHORT = re.sub(r"^S[12]e? = .*\n|^S3e = .*\n", "", STUDY, flags=re.MULTILINE)
SHORT = SHORT.replace('["J1", "J3", "J5"]', '["J1", "J3"]').replace('baseline = "S1"', 'baseline = "S3"')
REAL = (
    SHORT.replace('S3 = "k | c - b"', 'S3 = "k | c - (b | f)"')
    .replace("[layouts]", "[layouts]\n")
    .replace('b = { from = "1 kg", to = "2000 kg" }', 'b = "300 kg"\nf = "20 N"')
    .replace('c = { from = "100 N s/m", to = "100 kN s/m" }', 'c = "7 kN s/m"')
    .replace('optimise = "norm"', "")
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "car.toml").write_text(SHORT, encoding="utf-8")
    (tmp_path / "real.toml").write_text(REAL, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.campaign
def test_a_study_and_its_results_give_the_same_design(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["export", "car.toml", "--index", "J1", "--to", "matlab"]) == 0
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines()[-1] == "inerter: matrices with names and units for MATLAB and Octave: car-S3-J1.mat"
    assert call(["run", "car.toml", "-o", "results"]) == 0
    assert call(["export", "results", "--index", "J1", "--to", "matlab", "-o", "from-results.mat"]) == 0
    one, other = (scipy.io.loadmat(folder / name) for name in ("car-S3-J1.mat", "from-results.mat"))
    assert np.array_equal(one["A"], other["A"])
    k, c, b = it.Spring(120e3), it.Damper(it.free(100, 1e5, name="c")), it.Inerter(it.free(1, 2000, name="b"))
    car = paper_quarter_car(k | c - b)
    best = it.optimise(car, J1, it.Norm(), seed=0)
    assert np.array_equal(one["A"], it.named_system(best.design, form="descriptor").A)


@pytest.mark.parametrize("form", ["state-space", "descriptor"])
def test_the_form_of_the_matrices_is_an_option(form: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["export", "real.toml", "--to", "matlab", "--linear"]
    assert call([*arguments, "--form", form]) == 0
    assert ("E" in scipy.io.loadmat(folder / "real-S3.mat")) == (form == "descriptor")
    assert call([*arguments, "--form", "dss", "-o", "other.mat"]) == 2
    assert 'Invalid value "dss" for --form. Choose from: "descriptor", "state-space".' in capsys.readouterr().err
    assert not (folder / "other.mat").exists()


def test_of_a_study_with_conditions_the_vehicle_is_that_of_the_file(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    loads = "\n".join(f'[[conditions]]\nvehicle.sprung_mass = "{mass} kg"\n' for mass in (150, 250))
    (folder / "loads.toml").write_text(f"{REAL}\n{loads}", encoding="utf-8")
    assert call(["export", "loads.toml", "--to", "matlab", "--linear", "-o", "loads.mat"]) == 0
    said = " ".join(capsys.readouterr().err.split())
    assert "those of the file itself, not of one of its conditions; --condition chooses one" in said
    assert call(["export", "real.toml", "--to", "matlab", "--linear", "-o", "real.mat"]) == 0
    assert "conditions" not in capsys.readouterr().err
    titles = {name: str(scipy.io.loadmat(folder / f"{name}.mat")["title"][0]) for name in ("loads", "real")}
    assert titles["loads"] == f"{titles['real']}, with the numbers outside the conditions"
    one, other = (scipy.io.loadmat(folder / f"{name}.mat") for name in ("loads", "real"))
    assert np.array_equal(one["A"], other["A"])


BUS = study_text(
    'indices = ["J1"]',
    vehicle=HALF_CAR,
    elements='k = "40 kN/m"\nc = "1 kN s/m"\nb = "140 kg"\nk2 = { tied = "0.5 * k" }',
    layouts='S3 = "k | c - b | k2"',
).replace('model = "quarter-car"\n', "", 1)
LADEN = [('sprung_mass = "363.5 kg"', 'sprung_mass = "800 kg"'), ('k = "40 kN/m"', 'k = "55 kN/m"')]
SLOW = ('speed = "25 m/s"', 'speed = "15 m/s"')
LOADS = """[[conditions]]
[[conditions]]
name = "laden"
vehicle.sprung_mass = "800 kg"
k = "55 kN/m"
road.speed = "15 m/s"
"""


@pytest.mark.parametrize("kind", ["matlab", "csv"])
def test_a_condition_is_exported_as_the_study_of_its_numbers(
    kind: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Masses, elements and what is tied to them, and in tables the delay between the axles."""
    files = {"loads": BUS.replace("[study]", f"{LOADS}[study]"), "one": BUS, "two": with_changes(BUS, *LADEN, SLOW)}
    for name, text in files.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    for name in ("one", "two"):
        assert call(["export", f"{name}.toml", "--to", kind]) == 0
    for condition, name in (("1", "one"), ("laden", "two")):
        assert call(["export", "loads.toml", "--to", kind, "--condition", condition]) == 0
        assert "conditions" not in capsys.readouterr().err
        path = folder / f"loads-S3-condition-{1 if name == 'one' else 2}{it.EXPORTS[kind].suffixes[0]}"
        alone = folder / f"{name}-S3{path.suffix}"
        if kind == "matlab":
            found, expected = scipy.io.loadmat(path), scipy.io.loadmat(alone)
            assert str(found["title"][0]).endswith(f", in condition {condition}")
            assert np.array_equal(found["A"], expected["A"])
        else:
            found, expected = ([line for line in p.read_text().splitlines() if line[:1] != "#"] for p in (path, alone))
            assert found == expected
    curves = [(folder / f"{name}-S3{it.EXPORTS[kind].suffixes[0]}").read_bytes() for name in ("one", "two")]
    assert curves[0] != curves[1]


def test_tables_of_a_point_of_a_sweep_are_those_at_its_speed(folder: Path) -> None:
    sweep = 'sweep = { road.speed = ["25 m/s", "15 m/s"] }'
    for name, text in (("swept", f"{BUS}{sweep}\n"), ("slow", with_changes(BUS, SLOW))):
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    assert call(["export", "swept.toml", "--to", "csv", "--point", "2"]) == 0
    assert call(["export", "slow.toml", "--to", "csv"]) == 0
    found, expected = ((folder / f"{name}.csv").read_text().splitlines() for name in ("swept-S3-point-2", "slow-S3"))
    assert [line for line in found if line[:1] != "#"] == [line for line in expected if line[:1] != "#"]


@pytest.mark.parametrize(
    ("given", "text", "says"),
    [("ladn", LOADS, 'has no condition "ladn", but 1, laden. Did you mean "laden"?'), ("1", "", "has no conditions")],
)
def test_a_condition_that_is_not_there_is_refused(
    given: str, text: str, says: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "loads.toml").write_text(BUS.replace("[study]", f"{text}[study]"), encoding="utf-8")
    for command in (["export", "loads.toml", "--to", "matlab"], ["plot", "loads.toml", "--kind", "bode"]):
        assert call([*command, "--condition", given]) == 2
        assert says in " ".join(capsys.readouterr().err.split())
    assert not list(folder.glob("loads-*"))


def _stiffer(path: Path) -> None:
    path.write_text(path.read_text(encoding="utf-8").replace('k = "120 kN/m"', 'k = "130 kN/m"'), encoding="utf-8")


def _halved(path: Path) -> None:
    with h5py.File(path, "r+") as results:
        results["parameter_value"][...] *= 0.5


@pytest.mark.parametrize(
    ("name", "change", "says"),
    [
        pytest.param("study.resolved.toml", _stiffer, "was edited since", marks=pytest.mark.campaign),
        ("results.nc", _halved, "was edited since"),
        ("results.nc", Path.unlink, "has no results.nc"),
    ],
)
def test_results_that_were_edited_are_neither_exported_nor_drawn(
    name: str, change: Callable[[Path], None], says: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(["run", "car.toml", "-o", "results"]) == 0
    change(folder / "results" / name)
    capsys.readouterr()
    for command in (["export", "--to", "spice", "-o", "new.cir"], ["plot", "--kind", "bode", "-o", "new.svg"]):
        assert call([command[0], "results", "--index", "J1", *command[1:]]) == 2
        out, err = capsys.readouterr()
        assert (out, says in err) == ("", True), err
        assert not list(folder.glob("new*"))


KINDS = ["matlab", "csv", "netcdf", "modelica", "fmu", "fmu3", "spice", "svg", "pdf", "latex"]


@pytest.mark.parametrize("kind", sampled(KINDS, [kind for kind in KINDS if kind != "fmu3"]))
def test_every_kind(kind: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    linear = [] if kind in ("svg", "pdf", "latex", "fmu", "fmu3") else ["--linear"]
    assert call(["export", "real.toml", "--to", kind, *linear]) == 0
    path = folder / f"real-S3{it.EXPORTS[kind].suffixes[0]}"
    assert path.stat().st_size > 100
    before = path.read_bytes()
    assert call(["export", "real.toml", "--to", kind, *linear]) == 2
    assert "exists. Replace it with --force" in capsys.readouterr().err
    path.write_bytes(before + b" ")
    assert call(["export", "real.toml", "--to", kind, *linear, "--force"]) == 2
    assert "this command did not write it, or it was edited since" in capsys.readouterr().err
    path.write_bytes(before)
    assert call(["export", "real.toml", "--to", kind, *linear, "--force"]) == 0


def test_friction_is_refused_in_a_sentence(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["export", "real.toml", "--to", "modelica", "-o", "real.mo"]) == 2
    err = capsys.readouterr().err.strip().splitlines()
    assert len(err) == 1
    assert "friction 'f' in 'strut' left out" in err[0]
    assert not (folder / "real.mo").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["car.toml", "--to", "matlab"], "has several indices, J1, J3. Choose one with --index."),
        (["car.toml", "--to", "matlab", "--index", "J7"], 'has no index "J7", but J1, J3.'),
        (["car.toml", "--to", "matlab", "--index", "J1", "--layout", "s3"], '"s3", but S3. Did you mean "S3"?'),
        (["car.toml", "--to", "matlab", "--index", "J1", "--layout", "S9"], 'has no layout "S9", but S3.'),
        (["car.toml", "--to", "matlab", "--index", "J1", "--point", "2"], "has no sweep"),
        (["car.toml", "--to", "excel", "--index", "J1"], 'Unknown kind of export "excel"; available: svg, pdf, '),
        (["car.toml", "--to", "Simulink", "--index", "J1"], "spice, csv, netcdf. Try: --to fmu"),
        (["car.toml", "--to", "matlba", "--index", "J1"], 'Did you mean "matlab"?'),
        (["car.toml", "--to", "control", "--index", "J1"], "is an object of Python"),
        *((["car.toml"], f"\n  {kind.key} ") for kind in it.EXPORTS.values() if kind.is_file),
        (["car.toml", "--to", "matlab", "--index", "J1", "-o", "car.txt"], "suffix .mat or .m."),
        (["car.toml", "--to", "matlab", "--index", "J1", "-o", "none/car.mat"], "folder not found"),
        (["nothing.toml", "--to", "matlab"], "nothing.toml"),
        ([".", "--to", "matlab"], "study.resolved.toml"),
        (["real.toml", "--to", "matlab", "--linear", "--only", "wheel_speed"], "Unknown output 'wheel_speed'"),
    ],
)
def test_what_cannot_be_exported_is_one_sentence(
    arguments: list[str], sentence: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path.name for path in folder.iterdir()}
    assert call(["export", *arguments]) == 2
    err = capsys.readouterr().err.strip()
    assert sentence in err
    assert "Traceback" not in err
    assert {path.name for path in folder.iterdir()} == before


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--to", "fmu", "--speed", "20"], '--speed: Got "20": unit missing'),
        (["--to", "matlab", "--part", "strut"], "An export to matlab does not accept part: "),
        (["--to", "svg", "--linear"], "An export to svg does not accept linear: "),
        (["--to", "csv", "--form", "descriptor"], "An export to csv does not accept form: "),
        (["--to", "spice", "--only", "tyre_load"], "An export to spice does not accept outputs: "),
    ],
)
def test_an_option_is_refused_before_any_search(
    arguments: list[str],
    sentence: str,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("inerter.cli.export.chosen_design", None)
    assert folder.is_dir()
    assert call(["export", "car.toml", "--index", "J1", *arguments]) == 2
    assert sentence in capsys.readouterr().err


def test_a_point_of_a_sweep(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    swept = REAL.replace('baseline = "S3"', 'baseline = "S3"\nsweep = { k = ["60 kN/m", "90 kN/m"] }')
    (folder / "sweep.toml").write_text(swept, encoding="utf-8")
    assert call(["export", "sweep.toml", "--to", "spice", "--linear"]) == 2
    assert "Choose a point with --point, 1 to 2." in capsys.readouterr().err
    assert call(["export", "sweep.toml", "--to", "spice", "--linear", "--point", "2"]) == 0
    text = (folder / "sweep-S3-point-2.cir").read_text()
    assert float(re.search(r"^Lk \w+ \w+ (\S+)$", text, re.MULTILINE)[1]) == 1.0 / 90e3  # type: ignore[index]
