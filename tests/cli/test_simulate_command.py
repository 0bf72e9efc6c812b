"""`inerter simulate` as a person meets it."""

from __future__ import annotations

import csv
import io
import json
import re
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from campaigns import sampled
from folders import EXAMPLES

from inerter.cli.main import call
from inerter.files.simulation.loading import load_simulation

RATTLE = (EXAMPLES / "backlash_rattle.toml").read_text(encoding="utf-8").replace('"2 s"', '"0.5 s"')
FILES = {"trajectory.csv", "trajectory.nc", "events.csv", "simulation.toml", "figures"}


@pytest.fixture
def rattle(tmp_path: Path) -> Path:
    path = tmp_path / "rattle.toml"
    path.write_text(RATTLE, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str, str]:
    """The results folder of the command, and what it said."""
    home = tmp_path_factory.mktemp("rattle")
    (home / "rattle.toml").write_text(RATTLE, encoding="utf-8")
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        assert call(["simulate", str(home / "rattle.toml"), "-o", str(home / "out")]) == 0
    return home / "out", out.getvalue(), err.getvalue()


def test_everything_is_written_and_said(simulated: tuple[Path, str, str]) -> None:
    folder, out, err = simulated
    for words in ("device force", "gap g ", "in the gap", "friction f", "unaccounted for", "Status: ok"):
        assert words in out
    assert max(map(len, out.splitlines())) <= 80
    assert out.isascii()
    assert str(folder) in err
    assert {path.name for path in folder.iterdir()} - {".inerter"} == FILES
    assert {path.name for path in (folder / "figures").iterdir()} == {"simulation.svg", "simulation.png"}


def test_files_hold_the_same_motion(simulated: tuple[Path, str, str]) -> None:
    folder, *_ = simulated
    run = load_simulation(folder / "simulation.toml").run()
    with (folder / "trajectory.csv").open() as file:
        header, *rows = csv.reader(file)
    assert header[:2] == ["time [s]", "displacement [m]"]
    force = np.array(rows, dtype=float)[:, header.index("device_force [N]")]
    assert np.array_equal(force, run["device_force"])
    with xr.open_dataset(folder / "trajectory.nc", engine="h5netcdf") as data:
        assert np.array_equal(data["device_force"], run["device_force"])
        assert data["device_force"].attrs["units"] == "N"
    with (folder / "events.csv").open() as file:
        assert [(float(t), e, a, b) for t, e, a, b in list(csv.reader(file))[1:]] == [
            (e.time, e.element, e.before, e.after) for e in run.events
        ]
    assert "# inerter" in (folder / "simulation.toml").read_text()


@pytest.mark.usefixtures("undrawn")
def test_the_summary_of_a_measured_road_names_the_keys_that_were_given(tmp_path: Path, capsys) -> None:
    rows = "".join(f"{0.1 * i:.1f},{np.sin(0.1 * i):.6f}\n" for i in range(400))
    (tmp_path / "road.csv").write_text(f"distance [m],height [mm]\n{rows}", encoding="utf-8")
    text = (EXAMPLES / "stick_slip.toml").read_text(encoding="utf-8")
    text = re.sub(r"\[signal\].*?\n\n", '[signal]\nkind = "profile"\nfile = "road.csv"\n\n', text, flags=re.DOTALL)
    text = re.sub(r'duration = ".*?"', 'duration = "0.1 s"', text)
    (tmp_path / "car.toml").write_text(f'{text}\n[road]\nspeed = "25 m/s"\n', encoding="utf-8")
    assert call(["simulate", str(tmp_path / "car.toml"), "-o", str(tmp_path / "out")]) == 0
    assert "road: profile, file road.csv\n" in capsys.readouterr().out


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(("step", "is_coarse"), [("0.2 s", True), ("10 ms", False)])
def test_samples_that_are_too_far_apart_are_told(step: str, is_coarse: bool, tmp_path: Path) -> None:
    """With four samples in a period of the road, the r.m.s. acceleration is 26 % too small."""
    path = tmp_path / "car.toml"
    text = (EXAMPLES / "stick_slip.toml").read_text(encoding="utf-8")
    path.write_text(text.replace('step = "0.2 ms"', f'step = "{step}"'), encoding="utf-8")
    out = io.StringIO()
    with redirect_stdout(out), redirect_stderr(io.StringIO()):
        assert call(["simulate", str(path), "-o", str(tmp_path / "out")]) == 0
    told = "Note: Fewer than about ten samples for each oscillation of sprung acceleration, tyre load"
    assert (told in " ".join(out.getvalue().split())) is is_coarse
    rms = float(out.getvalue().partition("sprung acceleration")[2].split()[0])
    assert (rms == pytest.approx(0.5392, rel=0.01)) is not is_coarse


@pytest.mark.usefixtures("undrawn")
def test_json_is_json(rattle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["simulate", str(rattle), "-o", str(tmp_path / "out"), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["status"] == "ok"
    assert data["rms"]["device_force"]["unit"] == "N"
    for element in data["nonlinear"].values():
        assert sum(element["shares"].values()) == pytest.approx(1.0, abs=1e-12)
    assert abs(data["energy"]["residual"]) < 1e-10


@pytest.mark.usefixtures("undrawn")
def test_results_are_replaced_on_demand_only(
    rattle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert call(["simulate", str(rattle)]) == 0
    events = Path("rattle-results") / "events.csv"
    before = events.read_bytes()
    assert call(["simulate", str(rattle)]) == 2
    message = capsys.readouterr().err
    assert "--force" in message
    assert "--resume" not in message

    rattle.write_text(RATTLE.replace('frequency = "3 Hz"', 'frequency = "30 kHz"'), encoding="utf-8")
    assert call(["simulate", str(rattle), "--force"]) == 2
    assert "rattle.toml: simulation: a step of 0.1 ms is too long" in capsys.readouterr().err
    assert events.read_bytes() == before
    rattle.write_text(RATTLE.replace('frequency = "3 Hz"', 'frequency = "4 Hz"'), encoding="utf-8")
    assert call(["simulate", str(rattle), "--force"]) == 0
    assert events.read_bytes() != before


def test_what_there_is_is_written_when_the_status_is_not_ok(
    rattle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing damps a mass on springs, so that its motion never becomes that of the road."""
    text = (EXAMPLES / "stick_slip.toml").read_text(encoding="utf-8").replace('"k | c | f"', '"k"')
    rattle.write_text(text.replace('duration = "4 s"', 'initial = "periodic"'), encoding="utf-8")
    folder = tmp_path / "out"
    assert call(["simulate", str(rattle), "-o", str(folder)]) == 1
    out, err = capsys.readouterr()
    assert "rattle.toml: inaccurate: periodic steady state not reached after 300 periods" in err
    assert "Status: inaccurate" in out
    assert {path.name for path in folder.iterdir()} - {".inerter"} == FILES


@pytest.mark.parametrize("height", ["1e308 N", "-1e101 N"])
def test_a_signal_beyond_all_bounds_is_one_sentence(
    rattle: Path, tmp_path: Path, height: str, capsys: pytest.CaptureFixture[str]
) -> None:
    signal = f'kind = "step"\ninput = "sprung_force"\nheight = "{height}"\n'
    text = (EXAMPLES / "stick_slip.toml").read_text(encoding="utf-8")
    head, _, tail = text.partition('kind = "sine"\namplitude = "10 mm"\nfrequency = "1.25 Hz"\n')
    assert tail
    rattle.write_text(head + signal + tail, encoding="utf-8")
    assert call(["simulate", str(rattle), "-o", str(tmp_path / "out")]) == 2
    assert "is too large to compute with" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("window", sampled(["0.1:0.2", "0.1:9", "-1:0.3"], ["-1:0.3"]))
def test_a_window(rattle: Path, tmp_path: Path, window: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["simulate", str(rattle), "-o", str(tmp_path / "out"), f"--window={window}"]) == 0
    assert "The figure shows" in capsys.readouterr().out


@pytest.mark.parametrize("window", ["", "1", "0.3:0.1", "a:b", "2:4", "nan:1", "0.1:0.10001"])
def test_a_wrong_window(rattle: Path, tmp_path: Path, window: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["simulate", str(rattle), "-o", str(tmp_path / "out"), f"--window={window}"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "--window is FROM:TO in seconds" in err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"10 N"', '"10"', "elements.f"),
        ('"10 N"', '{ from = "1 N", to = "9 N" }', "elements.f"),
        ('"cosine"', '"cos"', "signal.kind"),
        ('"rig"', '"ring"', "vehicle.model"),
        ("[signal]", "[study]\nseed = 1\n[signal]", "inerter run"),
        ('"0.5 s"', '"0.50001 s"', "simulation.step"),
    ],
)
def test_bad_files(rattle: Path, old: str, new: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert old in RATTLE
    rattle.write_text(RATTLE.replace(old, new), encoding="utf-8")
    assert call(["simulate", str(rattle)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("inerter: rattle.toml: ")
    assert words in err
    assert "Traceback" not in err


def test_a_study_is_not_a_simulation(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["simulate", str(EXAMPLES / "quarter-car.toml")]) == 2
    assert "inerter run" in capsys.readouterr().err
    assert call(["run", str(EXAMPLES / "stick_slip.toml")]) == 2
    assert "inerter simulate" in capsys.readouterr().err


@pytest.mark.parametrize("name", sampled(["stick_slip", "half_car_friction"]))
def test_examples_run(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (EXAMPLES / f"{name}.toml").read_text(encoding="utf-8")
    short = tmp_path / "short.toml"
    short.write_text(text.replace('duration = "10 s"', 'duration = "1 s"'), encoding="utf-8")
    assert call(["simulate", str(short), "-o", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out
    stuck = [float(line.partition("stuck ")[2].partition(" %")[0]) for line in out.splitlines() if "stuck" in line]
    assert stuck
    assert min(stuck) > 20.0  # per cent: what the example is there to show
