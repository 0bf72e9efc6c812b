"""`inerter new`: a file for every vehicle that runs as it is, and never takes the place of another."""

import errno
import pathlib
import re
import tomllib

import pytest
from jsonschema import Draft202012Validator

from inerter.cli.main import call
from inerter.field_metadata import fields_of
from inerter.files.study import KIND
from inerter.files.study.checking import check_study
from inerter.files.study.loading import load_study
from inerter.files.study.sections import study_models
from inerter.files.study.starting import starting_text
from inerter.vehicle.registry import VEHICLES


@pytest.mark.parametrize("model", study_models())
def test_a_start_for_every_vehicle(model, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert call(["new", model]) == 0
    text = (tmp_path / f"{model}.toml").read_text(encoding="utf-8")
    study = load_study(tmp_path / f"{model}.toml")
    check_study(study)
    assert study.model == model
    assert study.optimise
    assert len(study.layouts) >= 2
    assert Draft202012Validator(KIND.schema()).is_valid(tomllib.loads(text))
    for field in fields_of(VEHICLES[model]) if model in VEHICLES else ():
        assert re.search(rf"{field.key} = .*# {re.escape(field.sentence.rstrip('.'))}\n", text)
    assert max(map(len, text.split("\n"))) <= 120
    assert f"inerter run {model}.toml" in capsys.readouterr().err
    assert call(["new", model]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert (tmp_path / f"{model}.toml").read_text(encoding="utf-8") == text


def test_the_command_for_a_name_with_spaces_can_be_pasted(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert call(["new", "-o", "my car.toml"]) == 0
    assert "run it: inerter run 'my car.toml'" in capsys.readouterr().err
    assert "# Run it: inerter run 'my car.toml'\n" in (tmp_path / "my car.toml").read_text(encoding="utf-8")


def test_what_is_a_remark_can_be_taken_in():
    """Every key that is only told is one that the file may have."""
    text = starting_text("quarter-car")
    told = re.findall(r"^# (\w+ = .*)$", text, re.MULTILINE)
    assert len(told) > 6
    editor = Draft202012Validator(KIND.schema())
    for line in told:
        with_it = tomllib.loads(text + f"{line}\n")
        assert editor.is_valid(with_it), line


@pytest.mark.campaign
def test_it_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call(["new"]) == 0
    assert call(["run", "quarter-car.toml", "-j", "1"]) == 0
    assert (tmp_path / "quarter-car-results" / "report.html").exists()


def test_a_place_that_takes_no_file_is_one_sentence(tmp_path, monkeypatch, capsys):
    def refuse(self, *arguments, **more):
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(pathlib.Path, "open", refuse)
    assert call(["new", "-o", str(tmp_path / "car.toml")]) == 2
    assert "car.toml: cannot be written (Read-only file system). Choose another" in capsys.readouterr().err


def test_it_can_be_printed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert call(["new", "half-car", "-o", "-"]) == 0
    assert capsys.readouterr().out == starting_text("half-car")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["rig"], "inerter simulate"),
        (["half_car"], 'Did you mean "half-car"?'),
        (["half-car", "-o", "none/car.toml"], "folder not found"),
        (["half-car", "-o", "."], "."),
    ],
)
def test_what_cannot_be_written_is_told(arguments, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert call(["new", *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())
