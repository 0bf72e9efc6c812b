"""Result folders: what is a user's stays, old results stay until new ones are whole, and a cut at any point heals."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import random
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest
from campaigns import sampled
from filelock import FileLock
from limits import file_size
from world import PARTS, RIG_FILE, SIMULATION_FILE, STUDY, cheap, files_of, inputs, is_whole, results_of

from inerter.cli.main import call
from inerter.files.common.listing import listing

RUN = ["run", "study.toml", "-j", "1", "-o", "out"]
SIMULATE = ["simulate", "simulation.toml", "-o", "out"]
REPRODUCE = ["reproduce", "wang-su-2008", "--only", "linear", "-j", "1", "-o", "out"]
OTHER = STUDY.replace("S2 =", "S3 =").replace('"J3"]', '"J3", "J5"]\nseed = 9')


@pytest.fixture(scope="session")
def _compiled(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Whatever commands compile is in its cache."""
    folder = tmp_path_factory.mktemp("compiled")
    inputs(folder)
    assert call(["simulate", str(folder / "simulation.toml"), "-o", str(folder / "out")]) == 0


@pytest.fixture
def home(_compiled: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with the files that commands read, in which they run."""
    inputs(tmp_path)
    monkeypatch.chdir(tmp_path)
    with cheap():
        yield tmp_path


def refused_with(arguments: list[str], options: Iterable[str], home: Path, capsys: Any, words: str) -> None:
    """A command is refused with each option, in a sentence that has these words."""
    for option in options:
        assert words in refused([*arguments, *option.split()], home, capsys)


def refused(arguments: list[str], home: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The sentence of a command that is refused and changes nothing."""
    before = files_of(home)
    capsys.readouterr()
    assert call(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("inerter: ")
    assert err.count("\n") == 1
    assert files_of(home) == before
    return err


FOREIGN: dict[str, Callable[[Path], object]] = {
    "a text": lambda out: (out / "thesis.txt").write_text("mine"),
    "names of ours": lambda out: [(out / name).write_text("mine") for name in ("summary.csv", "report.html")],
    "a folder of figures": lambda out: ((out / "figures").mkdir(), (out / "figures" / "a.svg").write_text("mine")),
    "a linked folder": lambda out: (out / "figures").symlink_to(out.parent, target_is_directory=True),
    "a journal of an older version": lambda out: (out / "journal.jsonl").write_text('{"format": 1}\n'),
    "a list that is none": lambda out: ((out / ".inerter").mkdir(), (out / ".inerter" / "files.json").write_text("[]")),
    "a list of nothing": lambda out: (
        (out / ".inerter").mkdir(),
        (out / ".inerter" / "files.json").write_text('{"files": {}}'),
        (out / "mine").write_text("mine"),
    ),
    "another thing of that name": lambda out: (out / ".inerter").write_text("mine"),
    "a list that leads elsewhere": lambda out: (
        (out / ".inerter").mkdir(),
        (out / ".inerter" / "files.json").write_text('{"files": {"../study.toml": {"by": "run", "sha256": ["0"]}}}'),
    ),
    "a hidden file": lambda out: (out / ".lock").write_text("mine"),
}


@pytest.mark.parametrize("command", [RUN, SIMULATE, REPRODUCE], ids=lambda c: c[0])
@pytest.mark.parametrize("fill", FOREIGN.values(), ids=FOREIGN)
def test_a_folder_that_is_not_ours_is_refused_whatever_is_asked(
    fill: Callable[[Path], object], command: list[str], home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (home / "out").mkdir()
    fill(home / "out")
    for option in ([], ["--force"], *([["--resume"]] if command[0] != "simulate" else [])):
        message = refused([*command, *option], home, capsys)
        assert "another folder with -o" in message
        assert "--force" not in message or "--force" in option
        assert "--resume" not in message or "--resume" in option


@pytest.mark.parametrize("command", sampled([RUN, SIMULATE, REPRODUCE], [RUN]), ids=lambda c: c[0])
def test_what_a_user_changed_or_added_is_not_replaced(
    command: list[str], home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(command) == 0
    assert is_whole(home / "out")
    names = [name for name in results_of(home / "out") if (home / "out" / name).is_file()]
    assert len(names) > 5
    for name in names:
        path = home / "out" / name
        before = path.read_bytes()
        path.write_bytes(before + b" ")
        message = refused([*command, "--force"], home, capsys)
        assert name in message
        path.unlink()
        path.symlink_to(home / PARTS[0])
        assert name in refused([*command, "--force"], home, capsys)
        path.unlink()
        path.write_bytes(before)
    assert call([*command, "--force"]) == 0


def test_a_name_of_ours_that_is_not_listed_is_not_replaced(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(RUN) == 0
    (home / "out" / "budgets.csv").write_text("mine")
    refused_with(RUN, ("--force", "--resume"), home, capsys, "budgets.csv was not written by inerter")


def test_a_folder_of_figures_that_becomes_a_link_is_not_written_to(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(RUN) == 0
    elsewhere = home / "elsewhere"
    shutil.move(home / "out" / "figures", elsewhere)
    (home / "out" / "figures").symlink_to(elsewhere, target_is_directory=True)
    refused_with(RUN, ("--force", "--resume"), home, capsys, "figures")
    shutil.rmtree(elsewhere)
    elsewhere.mkdir()
    assert "figures" in refused([*RUN, "--force"], home, capsys)


def test_files_that_nobody_knows_stay(home: Path) -> None:
    assert call(RUN) == 0
    mine = [home / "out" / name for name in ("notes.md", "figures/my.svg", "figures/raw/a.csv", "table1/a")]
    for path in mine:
        path.parent.mkdir(exist_ok=True)
        path.write_text("mine")
    (home / "study.toml").write_text(OTHER)
    assert call([*RUN, "--force"]) == 0
    assert {path.read_text() for path in mine} == {"mine"}
    assert "J5" in (home / "out" / "summary.csv").read_text()


def test_force_leaves_nothing_of_the_old_results(home: Path) -> None:
    assert call(REPRODUCE) == 0
    assert (home / "out" / "figure11" / "summary.csv").exists()
    assert call([*REPRODUCE[:3], "figure12", *REPRODUCE[4:], "--force"]) == 0
    assert set(results_of(home / "out")) == {
        *("tasks.jsonl", "report.html", "figures", "figures/fit.svg", "figures/record.svg"),
    }


def test_results_of_another_command_are_not_replaced(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(RUN) == 0
    refused_with(SIMULATE, ("", "--force"), home, capsys, "holds the results of inerter run")


def test_a_record_in_a_folder_of_results_is_no_result(home: Path) -> None:
    assert call(RUN) == 0
    assert call(["rig", "rig.toml", "-o", "out/bench.csv"]) == 0
    before = (home / "out" / "bench.csv").read_bytes()
    assert call([*RUN, "--force"]) == 0
    assert (home / "out" / "bench.csv").read_bytes() == before
    assert call(["rig", "rig.toml", "-o", "out/bench.csv", "--force"]) == 0


def test_a_record_makes_no_folder_of_results(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["rig", "rig.toml", "-o", "new.csv"]) == 0
    assert "nothing here is known" in refused([*RUN[:-1], ".", "--force"], home, capsys)


def spellings(path: Path) -> Iterator[Path]:
    """Other paths to the same file."""
    yield path
    yield path.parent / ".." / path.parent.name / path.name
    link = path.parent.parent / "link.csv"
    link.symlink_to(path)
    yield link
    hard = path.parent.parent / "hard.csv"
    hard.hardlink_to(path)
    yield hard
    folder = path.parent.parent / "folder"
    folder.symlink_to(path.parent, target_is_directory=True)
    yield folder / path.name


def test_an_input_is_never_replaced_by_whatever_path_it_is_given(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(SIMULATE) == 0
    (home / "out" / "trajectory.csv").unlink()
    shutil.copy(home / "bench.csv", home / "out" / "own.csv")
    table = "time [s],value [mm]\n0,0\n0.1,1\n0.2,0\n"
    signal = 'kind = "sampled"\nfile = "{}"\n'
    body, _, tail = SIMULATION_FILE.partition('kind = "cosine"\namplitude = "1 mm"\nfrequency = "5 Hz"\n')
    (home / "table.csv").write_text(table)
    (home / "recorded.toml").write_text(body + signal.format("table.csv") + tail)
    command = ["simulate", "recorded.toml", "-o", "out"]
    assert call([*command, "--force"]) == 0
    path = home / "out" / "events.csv"
    known = listing(home / "out")
    path.write_text(table)  # as if a table had been written there
    entry = json.loads((home / "out" / ".inerter" / "files.json").read_text())
    entry["files"]["events.csv"]["sha256"] = [hashlib.sha256(table.encode()).hexdigest()]
    (home / "out" / ".inerter" / "files.json").write_text(json.dumps(entry))
    assert known is not None
    for given in spellings(path):
        (home / "recorded.toml").write_text(body + signal.format(given) + tail)
        assert "this command reads events.csv" in refused([*command, "--force"], home, capsys)


def test_the_resolved_study_may_be_resumed_in_its_folder_but_not_replaced(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(RUN) == 0
    before = results_of(home / "out")
    command = ["run", "out/study.resolved.toml", *RUN[2:]]
    assert call([*command, "--resume"]) == 0
    assert results_of(home / "out") == before
    assert "this command reads study.resolved.toml" in refused([*command, "--force"], home, capsys)


@pytest.mark.parametrize("where", ["out", "deep/er/out"])
def test_work_that_is_refused_late_leaves_no_folder(where: str, home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (home / "simulation.toml").write_text(SIMULATION_FILE.replace('"5 Hz"', '"50 kHz"'))
    assert "too long" in refused([*SIMULATE[:-1], where], home, capsys)


def test_a_folder_in_use_is_refused(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(RUN) == 0
    with FileLock(home / "out" / ".inerter" / "lock"):
        refused_with(RUN, ("--force", "--resume"), home, capsys, "another run is writing")


def test_no_right_to_write_is_a_wrong_request(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with patch.object(Path, "mkdir", side_effect=PermissionError(errno.EACCES, "Permission denied")):
        assert "cannot be written (Permission denied)" in refused(RUN, home, capsys)


@pytest.mark.parametrize(
    ("command", "again"),
    sampled(product([RUN, SIMULATE, REPRODUCE], [False, True]), [(SIMULATE, False)], kept=2),
    ids=lambda value: value[0] if isinstance(value, list) else ("new", "force")[value],
)
def test_a_full_disk_is_one_sentence_and_old_results_stay(
    command: list[str], again: bool, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Files may grow to more and more bytes, until all is written."""
    if again:
        assert call(command) == 0
        (home / "study.toml").write_text(OTHER)
        (home / "simulation.toml").write_text(SIMULATION_FILE.replace('"1 mm"', '"2 mm"'))
    before = results_of(home / "out") if again else {}
    sizes = [0, 1, 60, 300, 800, 1500, 2500, 4000, 7000, 15000, 30000, 60000, 10**6]
    codes = []
    for size in sizes:
        capsys.readouterr()
        with file_size(size):
            codes.append(call([*command, *(["--force"] if again else [])]))
        err = capsys.readouterr().err
        if codes[-1]:
            said = [line for line in err.splitlines() if line.startswith("inerter: ")]
            assert len(said) == 1
            assert "File too large" in said[0]
            assert not list(home.rglob(".inerter-*"))
            if again:
                assert results_of(home / "out") == before
        else:
            break
        if not again:
            shutil.rmtree(home / "out", ignore_errors=True)
    assert codes[-1] == 0
    assert set(codes[:-1]) == {1}
    assert len(codes) > 4
    assert is_whole(home / "out")


STEPS = ("os.fsync", "os.replace", "os.unlink", "os.mkdir", "os.rename", "os.rmdir")


@contextmanager
def cut(after: int, end: Callable[[], Any]) -> Iterator[list[int]]:
    """Inside, `end` is called before one of the steps by which files are written, moved or removed."""
    count = [0]

    def counted(real: Callable[..., Any]) -> Callable[..., Any]:
        def step(*arguments: Any, **more: Any) -> Any:
            count[0] += 1
            if count[0] == after:
                end()
            return real(*arguments, **more)

        return step

    names = [name.partition(".")[2] for name in STEPS]
    patches = [patch.object(os, name, counted(getattr(os, name))) for name in names]
    for each in patches:
        each.start()
    try:
        yield count
    finally:
        for each in patches:
            each.stop()


def steps_of(command: list[str]) -> int:
    """How many steps a command takes."""
    with cut(0, lambda: None) as count:
        assert call(command) == 0
    return count[0]


def killed(command: list[str], after: int) -> int:
    """Run a command in a process that is killed before one of its steps; the exit code, 9 if it was."""
    child = os.fork()
    if child == 0:  # nothing of this process may go on in the child
        try:
            with cut(after, lambda: os._exit(9)):
                os._exit(call(command))
        finally:
            os._exit(77)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def mine(home: Path) -> None:
    for name in ("out/mine.txt", "out/figures/mine.svg"):
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).write_text("mine")


def chosen(count: int, every: bool) -> list[int]:
    """All steps, or some of them."""
    steps = list(range(1, count + 1))
    return steps if every else sorted(random.Random(count).sample(steps, min(count, 2)))


LONG = [pytest.mark.marathon, pytest.mark.timeout(7200)]
EVERY = pytest.mark.parametrize(
    "every", [pytest.param(False, marks=pytest.mark.campaign), pytest.param(True, marks=LONG)], ids=["some", "every"]
)


def kills(first: list[str], *others: list[str]) -> pytest.MarkDecorator:
    """Some steps of the first command always, of the second in a campaign; of others, and every step, in a marathon."""
    some = [(command, False) for command in (first, *others)]
    some = sampled(some, some[:1], some[2:])
    parts = [*some, *(pytest.param(c, True, marks=LONG) for c in (first, *others))]
    return pytest.mark.parametrize(
        ("command", "every"), parts, ids=lambda value: value[0] if isinstance(value, list) else ("some", "every")[value]
    )


@kills(RUN, SIMULATE, REPRODUCE)
def test_a_kill_at_a_step_of_force_leaves_old_or_new_results(command: list[str], every: bool, home: Path) -> None:
    """And a further command finishes; what is the user's stays in either case."""
    assert call(command) == 0
    mine(home)
    old = results_of(home / "out")
    saved(home)
    (home / "study.toml").write_text(OTHER)
    (home / "simulation.toml").write_text(SIMULATION_FILE.replace('"1 mm"', '"2 mm"'))
    count = steps_of([*command, "--force"])
    new = results_of(home / "out")
    assert command is REPRODUCE or new != old
    for after in chosen(count, every):
        restored(home)
        assert killed([*command, "--force"], after) == 9
        found = results_of(home / "out")
        for name, content in found.items():
            assert content in (old.get(name), new.get(name)), (after, name)
        assert {name for name in old if name not in found} <= set(old) - set(new)
        going_on = command is RUN and (home / "out" / ".inerter" / "new").exists()
        assert call([*command, "--resume" if going_on else "--force"]) == 0, after
        assert without_journals(results_of(home / "out")) == without_journals(new), after
        assert is_whole(home / "out")
        assert not list(home.rglob(".inerter-*"))


@kills(RUN, REPRODUCE)
def test_a_kill_at_a_step_can_be_resumed(command: list[str], every: bool, home: Path) -> None:
    count = steps_of(command)
    whole = without_journals(results_of(home / "out"))
    for after in chosen(count, every):
        shutil.rmtree(home / "out")
        assert killed(command, after) == 9
        assert call([*command, "--resume"]) == 0, after
        assert without_journals(results_of(home / "out")) == whole, after
        assert is_whole(home / "out")


@EVERY
def test_a_kill_while_a_record_is_written_leaves_the_old_or_the_new_one(every: bool, home: Path) -> None:
    command = ["rig", "rig.toml", "-o", "out/new.csv"]
    (home / "out").mkdir()
    assert call(command) == 0
    old = (home / "out" / "new.csv").read_bytes()
    saved(home)
    (home / "rig.toml").write_text(RIG_FILE.replace('"1 mm"', '"2 mm"'))
    count = steps_of([*command, "--force"])
    new = (home / "out" / "new.csv").read_bytes()
    for after in chosen(count, every):
        restored(home)
        assert killed([*command, "--force"], after) == 9
        assert (home / "out" / "new.csv").read_bytes() in (old, new)
        assert call([*command, "--force"]) == 0, after
        assert (home / "out" / "new.csv").read_bytes() == new


@EVERY
def test_an_error_at_a_step_is_one_sentence(every: bool, home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A disk that is full at one of them, whichever library takes it."""

    def full() -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    assert call(RUN) == 0
    mine(home)
    old = results_of(home / "out")
    (home / "study.toml").write_text(OTHER)
    saved(home)
    count = steps_of([*RUN, "--force"])
    new = results_of(home / "out")
    for after in chosen(count, every):
        restored(home)
        capsys.readouterr()
        with cut(after, full):
            code = call([*RUN, "--force"])
        said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("inerter: ")]
        assert code in (0, 1), after  # where it is about what may be left, the work is done
        assert code == 0 or (len(said) == 1 and "No space left" in said[0]), said
        found = results_of(home / "out")
        assert all(content in (old.get(name), new.get(name)) for name, content in found.items())
        assert call([*RUN, "--force"]) == 0
        assert results_of(home / "out") == new


def saved(home: Path) -> None:
    shutil.copytree(home / "out", home / "saved", symlinks=True)


def restored(home: Path) -> None:
    """Bring the folder back to what was saved."""
    shutil.rmtree(home / "out")
    shutil.copytree(home / "saved", home / "out", symlinks=True)


def without_journals(found: dict[str, Any]) -> dict[str, Any]:
    """In these, the same lines may stand in another order."""
    return {name: content for name, content in found.items() if not name.endswith(".jsonl")}
