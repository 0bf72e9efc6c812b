"""The command line as a person meets it."""

from __future__ import annotations

import json
import re
import resource
import runpy
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from folders import EXAMPLES

import inerter
import inerter as it
from inerter.cli.main import app, call

SMALL = (EXAMPLES / "quarter-car.toml").read_text(encoding="utf-8").replace('["J1", "J3", "J5"]', '["J1"]')


def fails(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The sentence of a refused request: exit code 2, nothing on stdout, no traceback."""
    assert call(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("inerter: ")
    assert "Traceback" not in err
    return err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run"], "STUDY"),
        (["bogus"], "bogus"),
        (["run", "missing.toml"], "file not found"),
        (["check", "missing.toml"], "file not found"),
        (["check", str(EXAMPLES)], "folder"),
        (["run", "a.toml", "b.toml"], "b.toml"),
        (["run", "a.toml", "--nope"], "--nope"),
        (["run", str(EXAMPLES / "quarter-car.toml"), "-j", "0"], "--jobs"),
        (["run", str(EXAMPLES / "quarter-car.toml"), "-j", "many"], "many"),
        (["run", str(EXAMPLES / "quarter-car.toml"), "-j", "1.5"], 'for -j: got "1.5"; expected an integer.'),
        (["plot", "results", "--kind", "bode", "--point", "1.5"], "expected an integer"),
        (["identify", "a.csv", "--model", "ideal", "--seed", "0.5"], "expected an integer"),
        (["new", "-o", "/dev/full/car.toml"], "folder not found"),
        (["reproduce", "some-paper"], "wang-su-2008"),
        (["reproduce", "wang-su-2008", "--only", "all"], "table1"),
        (["run", str(EXAMPLES / "quarter-car.toml"), "-o", __file__], "is a file"),
    ],
)
def test_wrong_requests(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert words in fails(arguments, capsys)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["run"], "STUDY is missing."),
        (["identify", "--model", "ideal"], "RECORDS is missing."),
        (["rig", "a.toml"], "--output is missing."),
        (["run", "a.toml", "-o"], "-o is given without its value."),
        (["run", "check", "a b.toml"], 'Unexpected argument: "a b.toml".'),
    ],
)
def test_a_missing_or_surplus_argument_is_named(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fails(arguments, capsys) == f"inerter: {sentence}\nTry: inerter {arguments[0]} --help\n"


@pytest.mark.parametrize(("example", "command"), [("quarter-car", "run"), ("stick_slip", "simulate")])
def test_a_file_in_the_place_of_a_command_is_told_its_command(
    example: str, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = EXAMPLES / f"{example}.toml"
    assert f"\nTry: inerter {command} {shlex.quote(str(path))}\n" in fails([str(path)], capsys)
    assert "\nTry: inerter --help\n" in fails(["none.toml"], capsys)


@pytest.mark.parametrize("command", ["", "run", "check", "simulate", "rig", "identify", "reproduce"])
def test_the_help_that_is_proposed_is_that_of_the_command(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [*command.split(), "--nope"]
    proposed = re.search(r"^Try: inerter (.*)$", fails(arguments, capsys), re.MULTILINE)
    assert proposed is not None
    assert proposed[1].split() == [*command.split(), "--help"]
    assert call(proposed[1].split()) == 0
    assert f"inerter {command}".strip() in capsys.readouterr().out


@pytest.mark.parametrize("name", ["plain", "Rallye für 2"])
def test_what_continues_an_interrupted_command_is_a_whole_command(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The words of the shell that the hint becomes ask for the same work, and --resume."""

    def interrupt(*arguments: object, **settings: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("inerter.cli.commands.run_study", interrupt)
    monkeypatch.setattr("inerter.papers.wang_su_2008.reproduce.reproduce", interrupt)
    study, folder = tmp_path / f"{name}.toml", tmp_path / name
    study.write_bytes((EXAMPLES / "quarter-car.toml").read_bytes())
    for asked in (
        ["run", str(study), "-o", str(folder)],
        ["run", str(study), "-o", str(folder), "-j", "2", "--json"],
        ["reproduce", "wang-su-2008", "--only", "linear", "--only", "rig", "-o", str(folder)],
    ):
        assert call(asked) == 130
        said = capsys.readouterr().err.splitlines()[-1]
        words = said.removeprefix("inerter: interrupted; completed results are kept. Continue with: inerter ")
        assert sorted(shlex.split(words)) == sorted([*asked, "--resume"])


def test_an_identification_that_is_interrupted_early_says_so_in_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*arguments: object, **settings: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("inerter.cli.identify.run_identification", interrupt)
    time = np.arange(200) / 200.0
    it.write_record(it.Record(time, 1e-3 * np.cos(9.0 * time), np.cos(9.0 * time)), tmp_path / "a.csv")
    assert call(["identify", str(tmp_path / "a.csv"), "--model", "ideal", "-o", str(tmp_path / "out")]) == 130
    assert capsys.readouterr().err.splitlines()[-1] == "inerter: interrupted before there was a fit."


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('k = "120 kN/m"', 'k = "120"', "elements.k"),
        ('k = "120 kN/m"', 'k = "-120 kN/m"', "elements.k"),
        ('"k | c"', '"k | q"', "layouts.S1"),
        ('"k | c"', '"k | | c"', "layouts.S1"),
        ("[road]", "[raod]", "raod"),
        ('baseline = "S1"', 'baseline = "S9"', "study.baseline"),
        ('"1 kg", to = "2000 kg"', '"2000 kg", to = "1 kg"', "elements.b"),
        ('"1 kg", to = "2000 kg"', '"1 kg"', 'elements.b.to: missing; expected to = "1000 kg".'),
        ('from = "1 kg", to = "2000 kg"', 'to = "2000 kg"', 'elements.b.from: missing; expected from = "2 kg".'),
        ('from = "1 kg", to = "2000 kg"', 'to = "2000"', 'elements.b.from: missing; expected from = "100 N s/m".'),
    ],
)
def test_bad_study_files(tmp_path: Path, old: str, new: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert old in SMALL
    path = tmp_path / "bad.toml"
    path.write_text(SMALL.replace(old, new), encoding="utf-8")
    message = fails(["check", str(path)], capsys)
    assert words in message
    assert "bad.toml" in message


@pytest.mark.parametrize("command", ["", *(name for name in app if not name.startswith("-"))])
def test_examples_of_the_help_fit_a_terminal(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    """A command that wraps is copied in two halves."""
    assert call([*filter(None, [command]), "--help"]) == 0
    examples = (app[command] if command else app).help_epilogue
    assert examples in capsys.readouterr().out.replace(" \n", "\n")
    assert max(map(len, examples.splitlines())) <= 80


def test_a_template_in_place_of_a_folder_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for options in ([], ["--force"]):
        message = fails(["new", "-o", str(tmp_path), *options], capsys)
        assert "this is a folder. Choose a file with -o, such as" in message
    assert not list(tmp_path.iterdir())


def test_run_writes_everything_and_prints_the_best(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study, folder = tmp_path / "small.toml", tmp_path / "out"
    study.write_text(SMALL, encoding="utf-8")
    assert call(["run", str(study), "-o", str(folder), "-j", "1"]) == 0
    out, err = capsys.readouterr()
    assert "S3 is 18.7 % better than S1 in ride comfort (J1)." in out
    assert max(map(len, out.splitlines())) <= 80
    assert "report.html" in err
    names = {path.name for path in folder.iterdir()}
    assert names >= {"summary.csv", "results.nc", "report.html", "figures", "study.resolved.toml", "versions.json"}
    assert {path.name for path in (folder / "figures").iterdir()} == {
        *(f"{name}.{kind}" for name in ("improvement", "response-J1") for kind in ("svg", "png")),
        *(f"layout-{name}.svg" for name in tomllib.loads(SMALL)["layouts"]),
    }
    assert call(["run", str(study), "-o", str(folder)]) == 2
    assert "--force" in capsys.readouterr().err


def test_reproduction_never_replaces_what_is_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "report.html").write_text("mine")
    assert "holds report.html, not results of" in fails(["reproduce", "wang-su-2008", "-o", str(tmp_path)], capsys)
    assert (tmp_path / "report.html").read_text() == "mine"


@pytest.mark.usefixtures("undrawn")
def test_json_is_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study = tmp_path / "small.toml"
    study.write_text(SMALL.replace('S2 = "k | c | b"', 'S2 = "k | b"'), encoding="utf-8")
    assert call(["run", str(study), "-o", str(tmp_path / "out"), "-j", "1", "--json"]) == 0
    designs = {d["layout"]: d for d in json.loads(capsys.readouterr().out)["designs"]}
    assert designs["S3"]["value"] == pytest.approx(2.4281, abs=1e-4)  # Wang and Su (2008), Table 1
    assert designs["S3"]["parameters"]["b"] == pytest.approx(366.52, abs=0.01)
    assert designs["S2"]["value"] == "inf"
    assert designs["S2"]["status"].startswith("marginal")


def test_what_check_says_fits_a_terminal(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(EXAMPLES)
    for study in ("ball_screw.toml", "half-car.toml", "stiffness-sweep.toml"):
        assert call(["check", study]) == 0
        out = capsys.readouterr().out
        assert out.startswith(f"{study}: ok. ")
        assert max(map(len, out.splitlines())) <= 80


@pytest.mark.marathon
def test_a_real_ball_screw_with_its_errors_and_its_budget(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (EXAMPLES / "ball_screw.toml").read_text(encoding="utf-8")
    study, folder = tmp_path / "screw.toml", tmp_path / "out"
    study.write_text(text.replace('["J1", "J3", "J5"]', '["J1"]').replace('force = "1 kN"', ""), encoding="utf-8")
    assert call(["check", str(study)]) == 0
    assert "3 designs to find, and 2 break-even values." in " ".join(capsys.readouterr().out.split())
    assert call(["run", str(study), "-o", str(folder), "-j", "1"]) == 0
    out, err = capsys.readouterr()
    assert "5 designs and break-even values" in err
    assert out.isascii()
    assert max(map(len, out.splitlines())) <= 80
    (friction,) = re.findall(r"S3, J1 .*up to (\d+) \+- (\d+) N$", out, re.MULTILINE)
    assert 300 < int(friction[0]) < 600
    words = " ".join(out.split())
    assert re.search(
        r"S3 is 16\.0\d+ \+- 0\.0\d+ % better than S1 .*, with its friction; without friction still S3, 16\.2 % bet",
        words,
    )
    assert {path.name for path in folder.iterdir()} >= {"budgets.csv", "summary.csv", "report.html"}
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Break-even values: where each layout is better than S1, by simulation" in page
    assert "The methods side by side" in page
    assert "Each mean is over 8 random inputs, which seed 0 decides" in page
    assert (folder / "figures" / "methods.svg").exists()
    assert call(["run", str(study), "-o", str(folder), "-j", "1", "--resume", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [found["layout"] for found in data["budgets"]] == ["S2", "S3"]
    assert data["designs"][-1]["realisations"] == 8
    assert data["designs"][-1]["standard_error"] > 0.0


@pytest.mark.parametrize("name", ["best_strut.py", "three_axles.py", "rattle.py"])
def test_python_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(EXAMPLES / name), run_name="__main__")


def test_check_says_what_linear_analysis_leaves_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study = tmp_path / "notes.toml"
    text = SMALL.replace('"k | c | b"', '"k | c | (b | f)"').replace('"k | c - b"', '"k - c"')
    study.write_text(text.replace('cs = "3200 N s/m"', 'cs = "3200 N s/m"\nf = "10 N"\nspare = "1 kg"'))
    assert call(["check", str(study)]) == 0
    out = capsys.readouterr().out
    assert "S2: friction 'f' in 'strut' left out" in out
    assert "S3: no static equilibrium: no spring supports the body" in out
    assert "no layout uses spare" in out


def test_designs_with_the_same_status_are_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study = tmp_path / "undamped.toml"
    study.write_text(SMALL.replace('"k | c | b"', '"k | b"').replace('"k | c - b"', '"b | k"'))
    call(["run", str(study), "-o", str(tmp_path / "out")])
    (line,) = [line for line in capsys.readouterr().err.splitlines() if "undamped mode" in line]
    assert line.startswith("inerter: S2 J1; S3 J1: marginal: ")


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["--version"]) == 0
    assert inerter.__version__ in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["simulate", "--help"], ["reproduce", "--help"]])
def test_help_has_examples_and_is_quick(arguments: list[str]) -> None:
    command = [sys.executable, "-c", "from inerter.cli.start import main; main()", *arguments]
    taken = []  # seconds of the processor
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        if taken[-1] < 0.5:
            break
    assert "Example" in text
    assert max(map(len, text.splitlines())) <= 80
    assert min(taken) < 0.5


def test_one_design_needs_no_compiler() -> None:
    program = """
import sys, inerter as it
assert not {"numpy", "scipy"} & set(sys.modules)
car = it.QuarterCar(sprung_mass=300, unsprung_mass=40, tyre_stiffness=2e5, strut=it.Spring(2e4) | it.Damper(1500))
road = it.Road(roughness=5e-7, speed=25)
for index in (it.RideComfort(road), it.TyreLoad(road), it.LoadCarrying()):
    assert it.evaluate(car, index, it.Norm()).status.ok
assert "numba" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", program], check=True)
