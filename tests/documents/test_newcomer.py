"""The newcomer's path: from an empty folder and an empty environment to exports, in less than a quarter of an hour."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest
from campaigns import sampled
from folders import ROOT
from newcomer import ANSWER, PAGE, changes, steps, with_lines
from pages import assert_printed, printed, text_of

from inerter.cli.main import call

STUDY = "my-car.toml"
QUARTER = 15 * 60.0  # [s]


def test_files_of_the_path_are_sound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The changes of each step give a file without problems."""
    monkeypatch.chdir(tmp_path)
    assert len(changes()) == 3
    assert call(["new", "quarter-car", "-o", STUDY]) == 0
    for change in changes():
        changed = with_lines(Path(STUDY).read_text(encoding="utf-8"), change)
        assert all(line in changed for line in change.splitlines())
        Path(STUDY).write_text(changed, encoding="utf-8")
        assert call(["check", STUDY]) == 0, capsys.readouterr().err


def test_the_answer_is_what_the_last_run_prints() -> None:
    said = re.search(r"rides ([\d.]+) % better", text_of(PAGE))
    assert said is not None
    assert printed(PAGE, ANSWER).partition("by each method")[2].partition("Limit of")[0].split()[-2] == f"+{said[1]}"


@pytest.mark.campaign
def test_the_path_ends_as_its_page_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its last run and what follows, without those before it."""
    monkeypatch.chdir(tmp_path)
    for step in steps():
        if not re.match(r"inerter |python3 ", step):
            changed = with_lines(Path(STUDY).read_text(encoding="utf-8"), step)
            Path(STUDY).write_text(changed, encoding="utf-8")
        elif re.match(r"inerter new |inerter export ", step) or step == ANSWER:
            capsys.readouterr()
            assert call(shlex.split(step)[1:]) == 0
            if step == ANSWER:
                assert_printed(capsys.readouterr().out, PAGE, ANSWER)
    assert_exported(tmp_path)


def assert_exported(folder: Path) -> None:
    assert "sprung_acceleration" in (folder / "my-car.m").read_text(encoding="utf-8")
    assert "modelDescription.xml" in zipfile.ZipFile(folder / "my-car.fmu").namelist()


@pytest.mark.timeout(1500)
@pytest.mark.parametrize("start", sampled(["installed", "empty"], kept=0))
def test_the_path_takes_less_than_a_quarter_of_an_hour(start: str, tmp_path: Path) -> None:
    """As a newcomer types it; from an empty machine nothing is installed, and nothing is compiled."""
    for name in ("src", "examples", "pyproject.toml", "README.md", "LICENSE"):
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        copy(ROOT / name, tmp_path / name)
    path = os.pathsep.join([str(tmp_path / ".venv" / "bin"), str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path}
    environment.pop("PYTHONPATH", None)
    commands = steps()
    assert "pip install" in commands[0]
    if start == "empty":
        environment["XDG_CACHE_HOME"] = str(tmp_path / "cache")
    else:
        del commands[0]
    begin = time.monotonic()
    for step in commands:
        if not re.match(r"inerter |python3 ", step):
            study = tmp_path / STUDY
            study.write_text(with_lines(study.read_text(encoding="utf-8"), step), encoding="utf-8")
            continue
        shell = ["bash", "-euc", step]
        done = subprocess.run(shell, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{step}: {done.stderr[-2000:]}"
        if step == ANSWER:
            assert_printed(done.stdout, PAGE, ANSWER)
    elapsed = time.monotonic() - begin
    print(f"the newcomer's path: {elapsed:.0f} s")
    assert elapsed < QUARTER
    assert_exported(tmp_path)
    assert (tmp_path / "mine.svg").stat().st_size > 1000
