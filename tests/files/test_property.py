"""The law of result folders: whatever is asked, a file that this package did not write is byte for byte as before."""

from __future__ import annotations

import os
import random
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from campaigns import sampled
from limits import file_size
from world import PARTS, RIG_FILE, SIMULATION_FILE, STUDY, TABLE, cheap, files_of, inputs

from inerter.cli.main import call
from inerter.files.common.listing import MARK
from inerter.files.identification.loading import IdentificationRequest, RecordRequest
from inerter.files.identification.running import IdentificationResult, read, run_identification

FOLDERS = ("out", "out/figures", "other", ".", "out/table1", "link", "deep/er", "study-results")
NAMES = (
    *("summary.csv", "results.nc", "report.html", "journal.jsonl", "tasks.jsonl", "trajectory.csv", "events.csv"),
    *("simulation.toml", "study.resolved.toml", "fit.json", "residuals.csv", "versions.json", "budgets.csv"),
    *("figures/simulation.svg", "figures/improvement.png", "figures/fit.svg", "notes.md", "bench.csv", ".lock"),
    *(f"{MARK}", f"{MARK}/files.json", f"{MARK}/notes", "figure11/summary.csv", "a b.txt", "ü.csv", "SUMMARY.CSV"),
)


@dataclass
class User:
    """What a user has in a folder, and what must not change in it."""

    home: Path
    draw: random.Random
    own: dict[str, bytes | str | None] = field(default_factory=dict)

    def some_path(self) -> Path:
        return self.home / self.draw.choice(FOLDERS) / self.draw.choice(NAMES)

    def act(self) -> str:
        """Do something with files, as users do."""
        acts = [self.write, self.write, self.edit, self.link, self.copy, self.remove, self.divert]
        try:
            return self.draw.choice(acts)()
        except OSError as error:  # what is in the way of a user is none of our business
            return str(error)

    def write(self) -> str:
        path = self.some_path()
        if os.path.lexists(path):
            return "nothing"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(self.draw.randbytes(self.draw.randrange(40)))
        return f"wrote {self.keep(path)}"

    def edit(self) -> str:
        """A file that may be one of ours becomes the user's."""
        files = [name for name, content in files_of(self.home).items() if isinstance(content, bytes)]
        name = self.draw.choice([name for name in files if f"{MARK}/" not in name and name not in PARTS] or PARTS)
        path = self.home / name
        change = self.draw.choice([b"\n", b"x", b"# mine\n"])
        path.write_bytes(path.read_bytes() + change)
        return f"edited {self.keep(path)}"

    def link(self) -> str:
        path, target = self.some_path(), self.draw.choice([*self.home.rglob("*"), self.home])
        path.parent.mkdir(parents=True, exist_ok=True)
        if os.path.lexists(path) or MARK in target.parts:
            return "nothing"
        if self.draw.random() < 0.4 and target.is_file():
            path.hardlink_to(target)  # the same file under another name: what either holds, stays
        else:
            path.symlink_to(target if self.draw.random() < 0.5 else os.path.relpath(target, path.parent))
        return f"linked {self.keep(path)} to {target}"

    def copy(self) -> str:
        """A folder, as a safe copy or by mistake into another; a copy with its list is a folder of results too."""
        source, target = self.home / self.draw.choice(FOLDERS), self.home / f"copy{self.draw.randrange(3)}"
        if target.exists() or not source.is_dir() or source.resolve() == self.home:
            return "nothing"
        shutil.copytree(source, target, symlinks=True)
        return f"copied {source} to {target}"

    def divert(self) -> str:
        """A folder is moved to where there is more room, with a link in its place; what is in it is looked after."""
        folders = [path for path in self.home.rglob("*") if path.is_dir() and not path.is_symlink()]
        folders = [path for path in folders if MARK not in path.parts and not path.name.startswith("moved")]
        figures = [path for path in folders if path.name == "figures"]
        target = self.home / f"moved{self.draw.randrange(9)}"
        if not folders or target.exists():
            return "nothing"
        path = self.draw.choice(figures or folders)
        shutil.move(path, target)
        path.symlink_to(target, target_is_directory=True)
        for file in target.rglob("*") if not (target / MARK).exists() else ():  # results as a whole stay results
            if MARK not in file.parts:
                self.keep(file)
        return f"moved {self.keep(path)} to {target}"

    def remove(self) -> str:
        path = self.draw.choice([path for path in self.home.rglob("*") if MARK not in path.parts])
        if path.name in PARTS:
            return "nothing"
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()
        return f"removed {path}"

    def keep(self, path: Path) -> str:
        """From now on a file is the user's, under each of its names."""
        name = (path.parent.resolve() / path.name).relative_to(self.home.resolve()).as_posix()
        self.own[name] = files_of(self.home)[name]
        return name

    def forget(self) -> None:
        """What the user has removed is the user's no more; hard links carry an edit to every name."""
        found = files_of(self.home)
        self.own = {name: found[name] for name in self.own if name in found}


def command(user: User, habit: str) -> list[str]:
    """One of all commands with options of any kind, sensible or not; most often what the user is used to."""
    draw = user.draw
    usual = draw.random() < 0.6
    folder = draw.choice([*FOLDERS, "copy0", str(user.home / "out"), "out/../out"]) if not usual else "out"
    study, simulation, rig, bench = (draw.choice(list(paths_to(user.home / name))) for name in PARTS)
    match habit if usual else draw.choice(["run", "simulate", "identify", "rig", "reproduce", "check"]):
        case "run":
            found = ["run", draw.choice([study, study, "out/study.resolved.toml"]), "-j", "1"]
            found += draw.choice([[], ["--resume"], ["--force"], ["--force"], ["--json"]])
        case "simulate":
            found = ["simulate", draw.choice([simulation, simulation, "out/simulation.toml", "recorded.toml"])]
            found += draw.choice([[], ["--force"], ["--force"]])
        case "identify":
            found = ["identify", draw.choice([bench, bench, "out/residuals.csv", "out/trajectory.csv"])]
            found += ["--model", "ideal", *draw.choice([[], ["--force"], ["--force"]])]
        case "rig":
            target = draw.choice(["new.csv", "bench.csv", "out/bench.csv", "out/trajectory.csv", "rig.mat", "new.tdms"])
            return ["rig", rig, "-o", target, *draw.choice([[], ["--force"], ["--force"]])]
        case "reproduce":
            found = ["reproduce", "wang-su-2008", "--only", draw.choice(["linear", "figure12"]), "-j", "1"]
            found += draw.choice([[], ["--resume"], ["--force"], ["--force"]])
        case _:
            return ["check", study]
    return found if draw.random() < 0.1 else [*found, "-o", folder]


def read_by(arguments: list[str], home: Path) -> list[Path]:
    """The files that a command reads."""
    target = arguments[arguments.index("-o") + 1] if "-o" in arguments else ""
    words = [word for word in arguments[1:] if word != target]
    paths = [home / word for word in (*words, *(["table.csv"] if "recorded.toml" in words else []))]
    return [path for path in paths if path.is_file()]


def paths_to(path: Path) -> Iterator[str]:
    yield path.name
    yield str(path)
    if os.path.lexists(path.with_suffix(".link")):
        yield path.with_suffix(".link").name


@pytest.fixture(scope="session")
def identified(tmp_path_factory: pytest.TempPathFactory) -> IdentificationResult:
    """A fit, which is made once."""
    folder = tmp_path_factory.mktemp("bench")
    (folder / "bench.csv").write_text(TABLE)
    reading = read(folder / "bench.csv", RecordRequest())
    return run_identification([reading], IdentificationRequest(name="ideal", settings={"starts": 8}))


def broken(seed: int, steps: int, home: Path, capsys: pytest.CaptureFixture[str]) -> Iterator[str]:
    """What a course of acts and commands has done that it must not."""
    draw = random.Random(seed)
    user = User(home, draw)
    inputs(home)
    signal = 'kind = "sampled"\nfile = "table.csv"\n'
    head, _, tail = SIMULATION_FILE.partition('kind = "cosine"\namplitude = "1 mm"\nfrequency = "5 Hz"\n')
    (home / "recorded.toml").write_text(head + signal + tail)
    (home / "table.csv").write_text("time [s],value [mm]\n0,0\n0.1,1\n0.2,0\n")
    (home / "link").symlink_to("other", target_is_directory=True)
    (home / "study.link").symlink_to("study.toml")
    (home / "bench.link").hardlink_to(home / "bench.csv")
    user.own = files_of(home)
    course, habit = [], draw.choice(["run", "simulate", "identify", "reproduce", "rig"])
    for step in range(steps):
        if draw.random() < 0.4 and step > 1:
            course.append(user.act())
            user.forget()
            continue
        if draw.random() < 0.3:  # other results than before
            mass, length = draw.randrange(200, 300), draw.randrange(1, 9)
            (home / "study.toml").write_text(STUDY.replace("250 kg", f"{mass} kg"))
            (home / "simulation.toml").write_text(SIMULATION_FILE.replace('"1 mm"', f'"{length} mm"'))
            (home / "rig.toml").write_text(RIG_FILE.replace('"1 mm"', f'"{length} mm"'))
            user.forget()
        arguments = command(user, habit)
        before = files_of(home)
        given = {path: path.read_bytes() for path in read_by(arguments, home)}
        size = draw.choice([10**9] * 8 + [0, 300, 2000, 20_000])
        capsys.readouterr()
        with file_size(size):
            code = call(arguments)
        course.append(f"{' '.join(arguments)} -> {code}")
        after, err = files_of(home), capsys.readouterr().err
        for name, content in user.own.items():
            if after.get(name, "gone") != content:
                yield f"seed {seed}: {name} changed by {course[-1]}, after {course}"
        for path, content in given.items():
            if not path.exists() or path.read_bytes() != content:
                yield f"seed {seed}: {path} was read and changed by {course[-1]}"
        if code not in (0, 1, 2):
            yield f"seed {seed}: {course}"
        if code == 2 and after != before:
            changed = [name for name in {**before, **after} if before.get(name, "") != after.get(name, "")]
            yield f"seed {seed}: refused, and yet {changed} changed: {course}, {err}"
        if code and not any(line.startswith("inerter: ") for line in err.splitlines()):
            yield f"seed {seed}: no word: {course}, {err}"
        if any(".inerter-" in name for name in after):
            yield f"seed {seed}: something is left: {course}"


def courses(seeds: range, steps: int, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys, identified) -> list[str]:
    found = []
    with cheap(identified):
        for seed in seeds:
            home = folder / str(seed)
            home.mkdir()
            monkeypatch.chdir(home)
            found += list(broken(seed, steps, home, capsys))
            shutil.rmtree(home)
    return found


@pytest.mark.parametrize(("seed", "steps"), sampled([(0, 16), (1, 16)], kept=1))
def test_what_is_a_users_stays(
    seed: int,
    steps: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    identified: IdentificationResult,
) -> None:
    assert courses(range(seed, seed + 1), steps, tmp_path, monkeypatch, capsys, identified) == []


@pytest.mark.marathon
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("part", range(10))
def test_what_is_a_users_stays_in_many_courses(
    part: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    identified: IdentificationResult,
) -> None:
    seeds = range(1000 + 40 * part, 1040 + 40 * part)
    assert courses(seeds, 25, tmp_path, monkeypatch, capsys, identified) == []
