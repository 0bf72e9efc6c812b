"""`inerter check` of every kind of file: says what it is, and refuses in one sentence what its command would refuse."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from folders import EXAMPLES
from study_text import study_text

from inerter.cli.main import call
from inerter.files.common.kinds import kind_of, kinds

SIMULATION = (EXAMPLES / "stick_slip.toml").read_text(encoding="utf-8")
RIG = (EXAMPLES / "rig_fit.toml").read_text(encoding="utf-8")
CONFIGURATION = """
[model]
layout = "(ks | cs) - (b | f)"
[elements]
ks = "1000 kN/m"
cs = { from = "10 N s/m", to = "20 kN s/m" }
b = { from = "1 kg", to = "500 kg" }
f = "10 N"
"""


def check(tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    path = tmp_path / "file.toml"
    path.write_text(text, encoding="utf-8")
    code = call(["check", str(path)])
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    return code, " ".join((out + err).split())


def replaced(text: str, key: str, value: str) -> str:
    changed, count = re.subn(rf"^{key} *=.*$", f"{key} = {value}", text, flags=re.MULTILINE)
    assert count == 1, key
    return changed


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_example_is_sound(example: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["check", str(example)]) == 0
    out, err = capsys.readouterr()
    assert ": ok. " in " ".join(out.split())
    assert "Warning" not in out
    assert err == ""
    assert max(map(len, out.splitlines())) <= max(80, len(str(example)) + 8)


def test_several_files_are_checked_and_each_wrong_one_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for folder, text in {"a": SIMULATION, "b": SIMULATION.replace("duration", "durations"), "c": RIG}.items():
        Path(folder).mkdir()
        Path(folder, "file.toml").write_text(text, encoding="utf-8")
    files = ["a/file.toml", "b/file.toml", "none.toml", "c/file.toml"]
    assert call(["check", *files]) == 2
    out, err = capsys.readouterr()
    assert [line.partition(": ")[0] for line in out.splitlines() if ": ok. " in line] == ["a/file.toml", "c/file.toml"]
    first, *lines = err.splitlines()
    assert first == "inerter: b/file.toml:"
    assert lines[0].startswith("file.toml: simulation.duration")
    assert lines[-1].startswith("inerter: none.toml: file not found")
    assert call(["check", "a/file.toml", "c/file.toml"]) == 0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (SIMULATION, "Simulation of quarter-car with strut = k | c | f; road: sine; 4 s, 20000 steps of 0.2 ms"),
        (RIG, "Virtual rig with (ks | cs) - (b | f); displacement: cosine; 5001 samples over 5 s, at 1000 Hz."),
        (CONFIGURATION, "inerter identify: the layout (ks | cs) - (b | f); to be identified: cs, b."),
        ('[model]\nname = "choose"\n', "inerter identify: the best of "),
        ('[record]\nforce = "Load"\n', "which also needs --model."),
    ],
)
def test_check_says_what_a_file_is(tmp_path, capsys, text, said):
    code, answer = check(tmp_path, text, capsys)
    assert code == 0
    assert said in answer


@pytest.mark.parametrize("sections", [(), ("vehicle", "layouts"), ("studdy",)])
def test_what_is_of_no_kind_is_taken_for_a_study(sections):
    assert kind_of({section: {} for section in sections}).command == "run"


def test_all_sections_of_a_kind_make_it_that_kind():
    for kind in kinds():
        assert kind_of({section: {} for section in (*kind.sections, "elements", "layouts")}) is kind


@pytest.mark.skipif(not Path("/dev/fd").is_dir(), reason="this system has no path of a pipe")
@pytest.mark.parametrize(
    "text", [SIMULATION, RIG, CONFIGURATION, (EXAMPLES / "quarter-car.toml").read_text(encoding="utf-8")]
)
def test_a_pipe_is_read_once(capsys: pytest.CaptureFixture[str], text: str) -> None:
    reader, writer = os.pipe()
    os.write(writer, text.encode())
    os.close(writer)
    try:
        code = call(["check", f"/dev/fd/{reader}"])
    finally:
        os.close(reader)
    out, err = capsys.readouterr()
    assert (code, err) == (0, "")
    assert f"/dev/fd/{reader}: ok. " in out
    assert "also needs" not in out  # as of an empty configuration


BAD_SIMULATIONS = {
    "duration": ("duration", '"4.00005 s"', "whole number of steps"),
    "step": ("frequency", '"5 kHz"', "too long"),
    "memory": ("duration", '"100000 s"', "GiB"),
    "steps": ("duration", '"1e9 s"', "at most 1e9 are possible"),
    "kind": ("kind", '"sin"', "signal.kind"),
    "layout": ("strut", '"k | c | | f"', "layouts.strut"),
}


def refused_by_both(tmp_path, capsys, text, command, output="out"):
    """What `check` says of a file that it refuses; the command itself says the same."""
    code, said = check(tmp_path, text, capsys)
    assert code == 2
    assert call([command, str(tmp_path / "file.toml"), "-o", str(tmp_path / output)]) == 2
    assert " ".join(capsys.readouterr().err.split()) == said
    return said


@pytest.mark.parametrize("name", BAD_SIMULATIONS)
def test_check_refuses_a_simulation_as_simulate_does(tmp_path, capsys, name):
    key, value, words = BAD_SIMULATIONS[name]
    text = replaced(SIMULATION, key, value) if key in SIMULATION else f"{SIMULATION}\n{key} = {value}\n"
    assert words in refused_by_both(tmp_path, capsys, text, "simulate")


@pytest.mark.parametrize(
    "changes",
    [
        {"initial": '"periodic"', "duration": '"4 s"'},
        {"initial": '"periodic"', "integrator": '"time-stepping"'},
        {"integrator": '"time-stepping"', "energy": "true"},
    ],
    ids=["period", "periodic stepping", "energy of stepping"],
)
def test_check_sees_what_only_the_integration_would_refuse(tmp_path, capsys, changes):
    keys = "|".join(changes)
    rest = re.sub(rf"^({keys}) *=.*\n", "", SIMULATION, flags=re.MULTILINE)
    head, _, tail = rest.partition("[simulation]\n")
    added = "".join(f"{key} = {value}\n" for key, value in changes.items())
    refused_by_both(tmp_path, capsys, f"{head}[simulation]\n{added}{tail}", "simulate")


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("duration", '"1 ms"', "less than 4 samples"),
        ("duration", '"1e9 s"', "rig: "),
        ("kind", '"multisine"', "signal"),
    ],
)
def test_check_refuses_a_rig_as_rig_does(tmp_path, capsys, key, value, words):
    assert words in refused_by_both(tmp_path, capsys, replaced(RIG, key, value), "rig", "out.csv")


def test_a_simulation_on_a_road_says_its_class_and_doubts_what_no_road_is(tmp_path, capsys):
    text = (EXAMPLES / "half_car_friction.toml").read_text(encoding="utf-8")
    _, said = check(tmp_path, text, capsys)
    assert "Road: class B of ISO 8608 (Gd(n0) = 40e-6 m^3, n0 = 0.1 cycle/m), at 25 m/s." in said
    assert "Warning" not in said
    _, said = check(tmp_path, replaced(text, "roughness", '"256e-6 m^3/cycle"'), capsys)
    assert "Warning: no public road is as rough as class G" in said
    _, said = check(tmp_path, replaced(text, "sprung_mass", '"363.5 g"'), capsys)
    assert "Warning: no half car is like this one: sprung mass 0.3635 kg, less than 2 kg." in said


FRICTION = study_text(
    'indices = ["own"]\nevaluate = ["METHOD"]',
    elements='k = "60 kN/m"\nc = "3 kN s/m"\nf = "30 N"',
    layouts='S = "k | c | f"\n[indices.own]\nkind = "KIND"\nelement = "f"',
)


@pytest.mark.parametrize("kind", ["element-force", "element-stroke", "element-velocity"])
@pytest.mark.parametrize("method", ["norm", "statistical-linearisation"])
def test_check_refuses_a_friction_where_its_force_or_motion_cannot_be_had(tmp_path, capsys, kind, method):
    said = refused_by_both(tmp_path, capsys, FRICTION.replace("KIND", kind).replace("METHOD", method), "run")
    assert "layouts.S: " in said
    assert "expected-value" in said or "'f_stroke'" in said


@pytest.mark.parametrize("kind", ["element-force", "element-stroke"])
def test_check_accepts_a_friction_where_it_can(tmp_path, capsys, kind):
    code, said = check(tmp_path, FRICTION.replace("KIND", kind).replace("METHOD", "expected-value"), capsys)
    assert (code, "ok" in said) == (0, True)
