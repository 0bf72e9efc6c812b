"""Terminals and pipes of any kind: never a traceback, and the work is done all the same."""

from __future__ import annotations

import errno
import os
import shlex
import subprocess
import sys
from itertools import product
from pathlib import Path

import pytest
from campaigns import sampled
from folders import EXAMPLES
from study_text import study_text

from inerter.cli.main import call

COMMAND = f"{shlex.quote(sys.executable)} -m inerter"

TITLE = 'title = "Größe ☃"'
STUDY = study_text('indices = ["J1"]', layouts='S1 = "k | c"', title=TITLE)


@pytest.fixture
def home(tmp_path: Path) -> Path:
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    (tmp_path / "rattle.toml").write_bytes((EXAMPLES / "backlash_rattle.toml").read_bytes())
    return tmp_path


def shell(line: str, home: Path, **environment: str) -> tuple[int, str, str]:
    """Run a line of a shell, in which `inerter` stands for the command."""
    found = subprocess.run(
        ["bash", "-o", "pipefail", "-c", line.replace("inerter", COMMAND)],
        cwd=home, env={**os.environ, **environment}, capture_output=True, check=False, timeout=250,
    )  # fmt: skip
    return found.returncode, found.stdout.decode(errors="replace"), found.stderr.decode(errors="replace")


ENDS = {
    "a reader who has seen enough": "inerter {} | head -1",
    "no reader at all": "inerter {} | true",
    "a closed output": "inerter {} >&-",
    "closed output and errors": "inerter {} >&- 2>&-",
    "closed errors": "inerter {} 2>&-",
    "nothing open": "inerter {} <&- >&- 2>&-",
    "errors to a reader who has seen enough": "inerter {} 2>&1 | head -c 10",
}


RUN, SIMULATE = "run study.toml -j 1 -o out", "simulate rattle.toml -o out"


@pytest.mark.parametrize(
    ("line", "arguments"),
    sampled(product(ENDS.values(), (RUN, SIMULATE)), often=[(ENDS["no reader at all"], RUN)], kept=0),
)
def test_results_are_whole_whoever_listens(line: str, arguments: str, home: Path) -> None:
    code, out, err = shell(line.format(arguments), home)
    assert code == 0
    assert "Traceback" not in out + err
    assert "Exception" not in out + err
    assert (home / "out" / "figures").is_dir()
    assert next((home / "out").glob("*.nc")).read_bytes()[:4] == b"\x89HDF"  # nothing was printed into a file


POOR = {
    "ascii": {"PYTHONIOENCODING": "ascii"},
    "C": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
}
SAID = {  # the exit code, and what is in the text
    "inerter run study.toml -j 1 -o out": (0, "Gr\\xf6\\xdfe"),
    "inerter check 'ü.toml'": (2, "file not found"),
    "inerter run --help": (0, "Usage"),
}


@pytest.mark.parametrize(("line", "terminal"), sampled(product(SAID, POOR), [("inerter check 'ü.toml'", "C")], kept=0))
def test_a_terminal_that_knows_few_characters(line: str, terminal: str, home: Path) -> None:
    code, out, err = shell(line, home, **POOR[terminal])
    assert code == SAID[line][0]
    assert "Traceback" not in out + err
    assert SAID[line][1] in out + err
    assert out.isascii()


@pytest.mark.campaign
def test_a_disk_that_takes_no_more_output_is_told_and_loses_no_results(home: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no device that is full")
    code, _, err = shell("inerter run study.toml -j 1 -o out > /dev/full", home)
    assert code == 1
    assert "inerter: standard output: No space left on device. The results are written all the same." in err
    assert "Traceback" not in err
    assert (home / "out" / "report.html").exists()


def test_results_are_written_where_a_command_writes_any(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    monkeypatch.setattr("inerter.cli.main.output_error", lambda: full)
    for arguments in (["check", str(EXAMPLES / "quarter-car.toml")], ["--help"], ["run", "--help"], ["--version"]):
        assert call(arguments) == 1
        assert capsys.readouterr().err == "inerter: standard output: No space left on device.\n"


@pytest.mark.campaign
def test_a_name_that_is_no_text(home: Path) -> None:
    name = os.fsencode(home) + b"/caf\xe9.toml"
    os.rename(os.fsencode(home / "study.toml"), name)
    text = Path(os.fsdecode(name)).read_text(encoding="utf-8")
    Path(os.fsdecode(name)).write_text(text.replace(TITLE, ""), encoding="utf-8")  # so that its name is its title
    code, out, err = shell("inerter run caf*.toml -j 1", home)
    assert code == 0, err
    assert "Traceback" not in out + err
    assert "caf\\udce9" in out


END = """
import atexit, sys
import inerter.cli.main as commands
from inerter.cli import start
command = commands.main
commands.main = lambda: (atexit.register(print, "what a library does last"), command())[1]
sys.argv = ["inerter", *sys.argv[1:]]
start.main()
"""


@pytest.mark.parametrize(("arguments", "code"), [(["--version"], 0), (["check", "none.toml"], 2)])
def test_a_command_ends_after_what_was_registered_for_its_end(arguments: list[str], code: int) -> None:
    found = subprocess.run([sys.executable, "-c", END, *arguments], capture_output=True, text=True, check=False)
    assert (found.returncode, found.stdout.splitlines()[-1]) == (code, "what a library does last")


def test_an_error_of_the_program_has_its_traceback() -> None:
    broken = END.replace("command())[1]", "command(1))[1]")
    found = subprocess.run([sys.executable, "-c", broken], capture_output=True, text=True, check=False)
    assert found.returncode == 1
    assert "TypeError" in found.stderr
