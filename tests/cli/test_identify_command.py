"""`inerter identify` as a person meets it."""

from __future__ import annotations

import csv
import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from study_text import PAPER_CAR, RIG_FIT, study_text
from troubled_rig import Device, Sensors, Tones, measured

import inerter as it
from inerter.cli.main import call
from inerter.errors import IdentificationError
from inerter.files.identification import running as identification_run
from inerter.files.identification.loading import load_identification
from inerter.identification import diagnosis
from inerter.identification.statements.identifiability import Identifiability, Verdict
from inerter.records.uncertain import Uncertain

SCREW = it.Spring(1e6) | it.Damper(3200.0)
FILES = {"fit.json", "residuals.csv", "response.json", "report.html", "figures"}
SETTINGS = 'indices = ["J1"]\nevaluate = ["expected-value"]\nrealisations = 2'
STUDY = study_text(SETTINGS, vehicle=PAPER_CAR, elements="PASTED", layouts="")


@pytest.fixture(scope="session")
def bench() -> it.Record:
    """A second of the paper's experiment."""
    rig = it.VirtualRig(SCREW - (it.Inerter(113.0) | it.Friction(10.0)), seed=0, sampling=500.0)
    return rig.run(it.cosine(amplitude=1e-3, frequency=3.0), duration=1.0)


@pytest.fixture(scope="session")
def fits() -> list[it.Fit]:
    """What the command has found for bench.csv, once it has run."""
    return []


@pytest.fixture(scope="session")
def fitted(bench: it.Record, fits: list[it.Fit], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with bench.csv, rig.toml and the results of the command in out/."""
    folder = tmp_path_factory.mktemp("identify")
    real = identification_run.identify

    def kept(*arguments: object, **settings: object) -> it.Fit:
        fits.append(real(*arguments, **settings))  # type: ignore[arg-type]
        return fits[-1]

    it.write_record(bench, folder / "bench.csv")
    (folder / "rig.toml").write_text(RIG_FIT, encoding="utf-8")
    arguments = [str(folder / "bench.csv"), "--config", str(folder / "rig.toml"), "-o", str(folder / "out"), "--json"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(identification_run, "identify", kept)
        assert call(["identify", *arguments]) == 0
    return folder


def test_the_folder_holds_numbers_residuals_figures_and_the_page(fitted: Path) -> None:
    folder = fitted / "out"
    assert {path.name for path in folder.iterdir()} - {".inerter"} == FILES
    drawn = {path.name for path in (folder / "figures").iterdir()}
    assert drawn == {
        f"{name}.svg" for name in ("profiles", "record", "fit", "window", "residuals", "loops", "response")
    }
    data = json.loads((folder / "fit.json").read_text())
    for name, truth in {"b": 113.0, "f": 10.0}.items():
        found = data["parameters"][name]
        assert found["value"] == pytest.approx(truth, rel=0.02)
        assert found["interval"][0] < found["value"] < found["interval"][1]
        assert found["told"]
    assert data["layout"] == "(ks | cs) - (b | f)"
    assert data["status"] == "ok"
    with (folder / "residuals.csv").open() as file:
        rows = list(csv.DictReader(file))
    fit = [float(row["residual [N]"]) for row in rows if row["part"] == "fit"]
    assert np.sqrt(np.mean(np.square(fit))) == pytest.approx(data["records"][0]["fitted"]["rms"])
    assert len(rows) == data["records"][0]["samples"]


def test_text_says_all_in_80_columns(
    fitted: Path, fits: list[it.Fit], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[int] = []

    def known(records: list[it.Record], *arguments: object, **settings: object) -> it.Fit:
        given.extend(len(record.time) for record in records)
        return fits[0]

    monkeypatch.chdir(fitted)
    monkeypatch.setattr(identification_run, "identify", known)
    assert call(["identify", "bench.csv", "--config", "rig.toml", "--trim", "0:0.8", "--unit", "force=N"]) == 0
    assert given == [401]
    out, err = capsys.readouterr()
    for words in ("501 samples", "Trimmed", "95 % interval", "Fit of each record", "check", "[elements]", "Status: ok"):
        assert words in out.replace("401 samples", "501 samples")
    assert max(map(len, out.splitlines())) <= 80
    assert out.isascii()
    assert "bench-results/report.html" in err
    assert (fitted / "bench-results" / "report.html").exists()


def test_a_doubtful_unit_is_told_before_the_fit(
    bench: it.Record, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fit(*arguments: object, **settings: object) -> it.Fit:
        err = capsys.readouterr().err
        assert '--unit "time=ms"' in err
        raise IdentificationError("begun")

    monkeypatch.setattr(identification_run, "identify", fit)
    it.write_record(replace(bench, time=1e3 * bench.time), tmp_path / "ms.csv")
    assert call(["identify", str(tmp_path / "ms.csv"), "--model", "ball-screw", "-o", str(tmp_path / "out")]) == 2
    assert "begun" in capsys.readouterr().err


def test_the_elements_can_be_pasted_into_a_study(fitted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    block = json.loads((fitted / "out" / "fit.json").read_text())["elements"]
    tables = tomllib.loads(block)
    assert tables["layouts"] == {"device": "(ks | cs) - (b | f)"}
    assert tables["elements"]["ks"] == "1 MN/m"
    pasted = block.replace("[elements]", '[elements]\nk = "120 kN/m"\nc = "3 kN s/m"')
    pasted = pasted.replace('"(ks | cs)', '"k | c | (ks | cs)')
    (fitted / "study.toml").write_text(STUDY.replace("[elements]\nPASTED\n[layouts]\n", pasted), encoding="utf-8")
    assert call(["check", str(fitted / "study.toml")]) == 0
    assert "ok" in capsys.readouterr().out


@pytest.mark.usefixtures("undrawn")
def test_the_elements_can_be_simulated_as_they_are(fitted: Path) -> None:
    block = json.loads((fitted / "out" / "fit.json").read_text())["elements"]
    rest = '[vehicle]\nmodel = "rig"\n[signal]\nkind = "cosine"\namplitude = "1 mm"\nfrequency = "3 Hz"\n'
    (fitted / "motion.toml").write_text(f'{rest}{block}\n[simulation]\nduration = "0.1 s"\n', encoding="utf-8")
    assert call(["simulate", str(fitted / "motion.toml"), "-o", str(fitted / "motion")]) == 0


def test_a_fit_that_is_not_ok_is_written_and_returns_1(
    fitted: Path, fits: list[it.Fit], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    bad = it.Status(it.StatusKind.INACCURATE, "the model explains 12.0 % of the force only")

    def poor(*arguments: object, **settings: object) -> it.Fit:
        (fit,) = fits
        verdicts = {n: Identifiability(n, Verdict.WITHHELD) for n in fit.parameters}
        parameters = {n: replace(p, value=float("nan")) for n, p in fit.parameters.items()}
        return replace(fit, status=bad, identifiable=verdicts, parameters=parameters)

    monkeypatch.setattr(identification_run, "identify", poor)
    folder = fitted / "poor"
    arguments = [str(fitted / "bench.csv"), "--config", str(fitted / "rig.toml"), "-o", str(folder)]
    assert call(["identify", *arguments]) == 1
    out, err = capsys.readouterr()
    assert "explains 12.0 %" in err
    assert "withheld" in out
    assert "unreliable estimates" in out
    assert {path.name for path in folder.iterdir()} - {".inerter"} == FILES
    assert "Unreliable estimates" in (folder / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def rattled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Records of an independent rig: a displacement that is 4 ms late, and 6 kg between load cell and device."""
    folder = tmp_path_factory.mktemp("rattled")
    (folder / "rig.toml").write_text(RIG_FIT, encoding="utf-8")
    device = Device(b=113.0, f=10.0, ks=1e6, cs=3200.0)
    motion = Tones((2e-3, 4e-4), (1.5, 4.0), (0.0, 1.0))
    for name, sensors in {"late": Sensors(displacement_late=4e-3), "heavy": Sensors(fixture=6.0)}.items():
        it.write_record(it.Record(*measured(device, motion, sensors, 1.2, 1)), folder / f"{name}.csv")
    return folder


@pytest.mark.campaign
def test_a_faulty_sensor_is_named_in_the_first_line(
    rattled: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of three hypotheses, since each is a fit."""
    whole, tried = diagnosis.hypotheses, {"delay", "gain", "filtered force"}
    monkeypatch.setattr(diagnosis, "hypotheses", lambda *given: [h for h in whole(*given) if h.name in tried])
    folder = rattled / "out"
    arguments = [str(rattled / "late.csv"), "--config", str(rattled / "rig.toml"), "-o", str(folder)]
    assert call(["identify", *arguments]) == 1
    out, err = capsys.readouterr()
    first = " ".join(out.partition("\n\n")[0].split())
    assert first.startswith("Unreliable estimates: the residual is ")
    assert "the displacement is delayed by 4" in first
    assert "the displacement is delayed by 4" in err
    assert max(map(len, out.splitlines())) <= 80
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.index("Unreliable estimates:") < page.index("the displacement is delayed") < page.index("Parameters")
    data = json.loads((folder / "fit.json").read_text())
    assert data["status"].startswith("inaccurate")
    assert "delay" in [e["name"] for e in data["explanations"][:2]]
    assert data["misfit"]["fitted"] > 1.5


@pytest.mark.marathon
def test_a_known_mass_in_front_of_the_cell_is_an_option(rattled: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [str(rattled / "heavy.csv"), "--config", str(rattled / "rig.toml"), "-o", str(rattled / "heavy")]
    sensors = ["--fixture-mass", "6 kg", "--force-noise", "0.15 N", "--displacement-noise", "0.42 um"]
    assert call(["identify", *arguments, *sensors, "--json"]) == 0
    b = json.loads(capsys.readouterr().out)["parameters"]["b"]
    assert b["interval"][0] <= 113.0 <= b["interval"][1]
    assert call(["identify", *arguments, "--fixture-mass", "6 N", "--force"]) == 2
    assert "--fixture-mass" in capsys.readouterr().err


def test_a_folder_is_replaced_on_demand_only(fitted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (fitted / "out" / "fit.json").read_bytes()
    arguments = [str(fitted / "bench.csv"), "--config", str(fitted / "rig.toml"), "-o", str(fitted / "out")]
    assert call(["identify", *arguments]) == 2
    assert "--force" in capsys.readouterr().err
    assert (fitted / "out" / "fit.json").read_bytes() == before


def test_an_interruption_keeps_the_fit(
    fitted: Path, fits: list[it.Fit], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(identification_run, "identify", lambda *arguments, **settings: fits[0])
    monkeypatch.setattr("inerter.cli.identify.write_identification", stop)
    folder = fitted / "stopped"
    arguments = [str(fitted / "bench.csv"), "--config", str(fitted / "rig.toml"), "-o", str(folder)]
    assert call(["identify", *arguments]) == 130
    assert "fit.json is complete" in capsys.readouterr().err
    assert json.loads((folder / "fit.json").read_text())["status"] == "ok"


def csv_text(time: np.ndarray, x: np.ndarray, force: np.ndarray, header: str = "time [s],x [mm],force [N]") -> bytes:
    rows = "\n".join(",".join(f"{v:.6g}" for v in row) for row in np.column_stack([time, x, force]))
    return f"{header}\n{rows}\n".encode()


TIME = np.arange(400) / 200.0
X, F = np.cos(6.0 * np.pi * TIME), -40.0 * np.cos(6.0 * np.pi * TIME) - 10.0 * np.sign(np.sin(6.0 * np.pi * TIME))
GOOD = csv_text(TIME, X, F)
BURST = csv_text(TIME, np.where((TIME > 0.5) & (TIME < 1.0), np.nan, X), F)
MODEL = ["--model", "ball-screw", "--starts", "8"]
# name of the file, its bytes, arguments, words of the sentence
BAD: dict[str, tuple[str, bytes, list[str], str]] = {
    "empty": ("a.csv", b"", MODEL, "empty"),
    "no numbers": ("a.csv", b"hello\nworld\n", MODEL, "rows of numbers not found"),
    "wrong suffix": ("a.xlsx", GOOD, MODEL, "unsupported file suffix '.xlsx'"),
    "no suffix": ("a", GOOD, MODEL, "unsupported file suffix ''"),
    "text named tdms": ("a.tdms", GOOD, MODEL, "indicates TDMS"),
    "truncated tdms": ("a.tdms", b"TDSm\x0e\0\0\0", MODEL, "a.tdms"),
    "truncated mdf": ("a.mf4", b"MDF     4.10    ", MODEL, "a.mf4"),
    "truncated mat": ("a.mat", b"MATLAB 5.0 MAT-file" + b" " * 60, MODEL, "a.mat"),
    "mdf named csv": ("a.csv", b"MDF     4.10    " * 9, MODEL, "Rename"),
    "missing channel": ("a.csv", GOOD, [*MODEL, "--force-channel", "Load"], "unknown channel 'Load'"),
    "missing number": ("a.csv", GOOD, [*MODEL, "--displacement", "7"], "counted from 0"),
    "no obvious names": ("a.csv", GOOD.replace(b"force", b"alpha"), MODEL, "--force-channel 'alpha'"),
    "one channel twice": ("a.csv", GOOD, [*MODEL, "--force-channel", "x"], "both"),
    "unknown unit": ("a.csv", GOOD.replace(b"[mm]", b"[mn]"), MODEL, '--unit "displacement=mm"'),
    "no unit": ("a.csv", GOOD.replace(b" [N]", b""), MODEL, '--unit "force=N"'),
    "a mass": ("a.csv", GOOD.replace(b"[N]", b"[kg]"), MODEL, '--unit "force=kgf"'),
    "unit of no channel": ("a.csv", GOOD, [*MODEL, "--unit", "load=N"], "--unit"),
    "half a unit": ("a.csv", GOOD, [*MODEL, "--unit", "force"], "--unit force=kgf"),
    "burst of nan": ("a.csv", BURST, MODEL, "--gaps"),
    "burst too long to fill": ("a.csv", BURST, [*MODEL, "--gaps", "fill"], "too many to interpolate"),
    "gaps of no kind": ("a.csv", GOOD, [*MODEL, "--gaps", "maybe"], "--gaps"),
    "constant displacement": ("a.csv", csv_text(TIME, 0 * X + 1, F), MODEL, "displacement is constant"),
    "constant force": ("a.csv", csv_text(TIME, X, 0 * F), MODEL, "force is constant"),
    "three samples": ("a.csv", csv_text(TIME[:3], X[:3], F[:3]), MODEL, "at least 4 samples"),
    "thirty samples": ("a.csv", csv_text(TIME[:30], X[:30], F[:30]), MODEL, "at least 50"),
    "times go back": ("a.csv", csv_text(TIME[::-1], X, F), MODEL, "--interval"),
    "uneven": ("a.csv", csv_text(TIME**2, X, F), MODEL, "--resample"),
    "no times": ("a.csv", csv_text(TIME, X, F, "q [1],x [mm],force [N]"), MODEL, "--interval"),
    "times and an interval": ("a.csv", GOOD, [*MODEL, "--time", "time", "--interval", "1 ms"], "not both"),
    "interval without a unit": ("a.csv", GOOD, [*MODEL, "--interval", "0.001"], "--interval"),
    "negative interval": ("a.csv", GOOD, [*MODEL, "--interval=-1 ms"], "not positive"),
    "range in kg": ("a.csv", GOOD, [*MODEL, "--force-range", "100 kg"], "--force-range"),
    "trimmed away": ("a.csv", GOOD, [*MODEL, "--trim", "5:6"], "lasts from"),
    "trim of no numbers": ("a.csv", GOOD, [*MODEL, "--trim", "all"], "FROM:TO"),
    "unknown model": ("a.csv", GOOD, ["--model", "ball-scew"], 'Did you mean "ball-screw"'),
    "no model": ("a.csv", GOOD, [], "--model"),
    "few starts": ("a.csv", GOOD, ["--model", "ball-screw", "--starts", "2"], "at least 8"),
    "negative seed": ("a.csv", GOOD, [*MODEL, "--seed", "-1"], "seed"),
    "no such config": ("a.csv", GOOD, ["--config", "nowhere.toml"], "nowhere.toml"),
    "unknown option": ("a.csv", GOOD, [*MODEL, "--frobnicate"], "frobnicate"),
}


@pytest.mark.parametrize(("name", "data", "arguments", "words"), BAD.values(), ids=BAD)
def test_bad_requests_are_one_sentence(
    name: str, data: bytes, arguments: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, folder = tmp_path / name, tmp_path / "out"
    file.write_bytes(data)
    assert call(["identify", str(file), *arguments, "-o", str(folder)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert words in err
    assert "Traceback" not in err
    said = [line for line in err.splitlines() if line.startswith("inerter: ")]
    assert len(said) == 1
    assert not (folder / "fit.json").exists()


CONFIGS = {
    "unknown section": ('[signal]\nkind = "sine"', "inerter simulate"),
    "unknown key": ('[record]\nforces = "Load"', "record.forces"),
    "unit of no channel": ('[record]\nunits = { load = "N" }', "record.units"),
    "gaps": ('[record]\ngaps = "none"', "record.gaps"),
    "unknown model": ('[model]\nname = "screw"', "model.name"),
    "name and layout": ('[model]\nname = "ball-screw"\nlayout = "b"\n[elements]\nb = "1 kg"', "expected one of them"),
    "nothing free": ('[model]\nlayout = "b"\n[elements]\nb = "1 kg"', "nothing to identify"),
    "not in elements": ('[model]\nlayout = "b | f"\n[elements]\nb = { from = "1 kg", to = "9 kg" }', "not in"),
    "reversed": ('[model]\nlayout = "b"\n[elements]\nb = { from = "9 kg", to = "1 kg" }', "reversed"),
    "from zero": ('[model]\nlayout = "k"\n[elements]\nk = { from = "0 N/m", to = "1 N/m" }', "elements.k"),
    "unused": ('[model]\nlayout = "b"\n[elements]\nb = { from = "1 kg", to = "9 kg" }\nf = "1 N"', "elements.f"),
    "of no model": ('[model]\nname = "ball-screw"\n[elements]\nbb = "1 kg"', "elements.bb"),
    "of another kind": ('[model]\nname = "ball-screw"\n[elements]\nb = "1 N"', "expected one in kg"),
    "starts": ("[fit]\nstarts = 4", "fit.starts"),
    "check": ("[fit]\ncheck = 0.9", "fit.check"),
    "delay": ('[fit]\ndelay = "1 mm"', "fit.delay"),
    "syntax": ("[fit", "line 1"),
}


@pytest.mark.parametrize(("text", "words"), CONFIGS.values(), ids=CONFIGS)
def test_what_is_wrong_in_a_configuration_is_said(
    text: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    (tmp_path / "a.csv").write_bytes(GOOD)
    assert call(["identify", str(tmp_path / "a.csv"), "--config", str(tmp_path / "rig.toml")]) == 2
    err = capsys.readouterr().err
    assert words in err
    assert err.startswith("inerter: rig.toml: ")
    assert "Traceback" not in err


SCALES = {
    ("--force-scale", "one"): 'alone or with its standard uncertainty, such as "1" or "1 +- 1 %".',
    ("--displacement-scale", "1 +- 80 %"): "expected an uncertainty below half of the value.",
    ("--fixture-mass", "2 kg +- "): "--fixture-mass: ",
}


@pytest.mark.parametrize("option", SCALES, ids=lambda option: option[0])
def test_scales_that_cannot_be_read_are_refused_in_one_sentence(
    option: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(["identify", "bench.csv", "--model", "ideal", *option]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert said[0].startswith(f"inerter: {option[0]}: ")
    assert SCALES[option] in said[0]


def test_a_configuration_states_scales_and_an_uncertain_fixture(tmp_path: Path) -> None:
    text = (
        '[record]\nfixture_mass = "2 kg +- 10 g"\n[fit]\nforce_scale = "1 +- 2 % (k = 2)"\ndisplacement_scale = "1"\n'
    )
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    request = load_identification(tmp_path / "rig.toml")
    assert request.record.fixture_mass == Uncertain(2.0, 0.01, "kg")
    assert request.settings["force_scale"] == Uncertain(1.0, 0.01)
    assert request.settings["displacement_scale"] == Uncertain(1.0, 0.0)
