"""Work on a real scheduler of dask with workers that are processes of their own: the same bytes, whatever ends."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from campaigns import sampled
from clusters import PATIENCE, Cluster, cluster, kill, results
from folders import EXAMPLES
from study_text import PAPER_CAR, study_text
from wang_su import J1, paper_quarter_car

import inerter as it
from inerter.cli.cluster import cluster_executor
from inerter.cli.main import call
from inerter.errors import WorkError
from inerter.work.pool import Pool
from inerter.work.processes import Processes

SOURCES = Path(it.__file__).parent
KILL = "__import__('os').kill(__import__('os').getpid(), 9)"
STUDY = study_text(
    """indices = ["J1", "J3"]
evaluate = ["expected-value", "norm"]
realisations = ROADS
baseline = "S1"
sweep = { k = { from = "60 kN/m", to = "180 kN/m", points = POINTS } }""",
    vehicle=PAPER_CAR,
    elements='k = "120 kN/m"\nc = "4 kN s/m"\nb = "366 kg"\nf = "30 N"',
    layouts='S1 = "k | c"\nS3 = "k | c - (b | f)"',
    title='title = "With friction, on simulated roads"',
)


def inerter(*words: object, **environment: str) -> subprocess.Popen[str]:
    """The command line, under way."""
    return subprocess.Popen(
        [sys.executable, "-c", "from inerter.cli.start import main; main()", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **environment},
        start_new_session=True,
    )


def done(process: subprocess.Popen[str], code: int = 0) -> str:
    """What it said, once it has ended as it should."""
    output, errors = process.communicate(timeout=4 * PATIENCE)
    assert process.returncode == code, errors
    assert "Traceback" not in errors
    return output if code == 0 else errors


def study_file(folder: Path, points: int, roads: int) -> Path:
    path = folder / "study.toml"
    path.write_text(STUDY.replace("POINTS", str(points)).replace("ROADS", str(roads)))
    return path


def finished(folder: Path) -> int:
    """How many cases are in the journal of a run that is under way."""
    try:
        lines = [path.read_bytes().count(b"\n") for path in folder.rglob("journal.jsonl")]
    except FileNotFoundError:  # a draft came or went meanwhile
        return 0
    return max(lines, default=1) - 1


def wait_until(what: Callable[[], bool], process: subprocess.Popen[str] | None = None) -> None:
    deadline = time.monotonic() + 2 * PATIENCE
    while not what():
        assert time.monotonic() < deadline
        assert process is None or process.poll() is None, process.communicate()
        time.sleep(0.02)


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, bytes]:
    """The larger study by one process."""
    folder = tmp_path_factory.mktemp("alone")
    it.run_study(it.load_study(study_file(folder, 12, 8)), folder / "out")
    return results(folder / "out")


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Cluster]:
    (tmp_path / "cluster").mkdir()
    with cluster(tmp_path / "cluster") as made:
        yield made


@pytest.mark.campaign
def test_a_study_on_a_cluster_is_the_same_to_the_last_byte(tmp_path: Path, there: Cluster) -> None:
    study = study_file(tmp_path, 2, 2)
    it.run_study(it.load_study(study), tmp_path / "own")
    process = inerter("run", study, "-o", tmp_path / "there", "--scheduler-file", there.file)
    output, errors = process.communicate(timeout=2 * PATIENCE)
    assert process.returncode == 0, errors
    assert "worker" in errors
    assert "on 1 machine" in errors
    assert results(tmp_path / "there") == results(tmp_path / "own")
    assert "S3" in output


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["--scheduler", "somewhere"], 2, "expected, for example, tcp://HOST:8786"),
        (["--scheduler", "tcp://127.0.0.1:9", "-j", "2"], 2, "Leave --jobs out"),
        (["--tls-cert", "mine.pem"], 2, "without a scheduler"),
        (["--scheduler", "tcp://127.0.0.1:9", "--scheduler-file", "s.json"], 2, "give one of them"),
        (["--scheduler-file", "s.json"], 1, "s.json: file not found"),
    ],
)
def test_a_cluster_that_cannot_be_is_told(
    words: list[str], code: int, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(["run", str(EXAMPLES / "quarter-car.toml"), "-o", str(tmp_path / "out"), *words]) == code
    errors = capsys.readouterr().err
    assert says in errors
    assert errors.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.marathon
def test_no_scheduler_answers(tmp_path: Path) -> None:
    words = ("-o", tmp_path / "out", "--scheduler", "tcp://127.0.0.1:9")
    errors = done(inerter("run", EXAMPLES / "quarter-car.toml", *words), 1)
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in errors
    assert "connecting to the scheduler" in errors


TROUBLES = ["none", "one killed, one added", "all killed, new ones started"]


@pytest.mark.timeout(900)
@pytest.mark.parametrize("trouble", sampled(TROUBLES, kept=0))
def test_whatever_workers_come_and_go(trouble: str, alone: Mapping[str, bytes], tmp_path: Path, there: Cluster) -> None:
    process = inerter("run", study_file(tmp_path, 12, 8), "-o", tmp_path / "out", "--scheduler", there.address)
    wait_until(lambda: finished(tmp_path) >= 5, process)
    first, second = there.processes[1:]
    if trouble == "one killed, one added":
        kill(first)
        there.start_worker()
    elif trouble != "none":
        kill(first)
        kill(second)
        time.sleep(5.0)
        there.start_worker()
        there.start_worker()
    done(process)
    assert results(tmp_path / "out") == alone


@pytest.mark.marathon
@pytest.mark.timeout(900)
def test_what_one_executor_began_another_ends(alone: Mapping[str, bytes], tmp_path: Path, there: Cluster) -> None:
    """By own processes and on a cluster until the command is killed, there until the scheduler is, and by processes."""
    study, out = study_file(tmp_path, 12, 8), tmp_path / "out"
    own, far = ("-j", 2), ("--scheduler", there.address)
    kept = [b""]

    def begin(*words: object) -> subprocess.Popen[str]:
        process = inerter("run", study, "-o", out, *words)
        wait_until(lambda: finished(tmp_path) >= kept[-1].count(b"\n") + 3, process)
        return process

    def keep() -> None:
        journal = next(tmp_path.rglob("journal.jsonl")).read_bytes()
        kept.append(journal[: journal.rindex(b"\n") + 1])

    for words in (own, ("--resume", *far)):
        process = begin(*words)
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        keep()
    process = begin("--resume", *far)
    kill(there.processes[0])
    assert "executor has ended" in done(process, 1)
    keep()
    done(inerter("run", study, "-o", out, "--resume", *own))
    keep()
    assert results(out) == alone
    assert all(later.startswith(earlier) for earlier, later in pairwise(kept))  # nothing was done again


@pytest.mark.marathon
@pytest.mark.timeout(900)
def test_values_an_identification_and_a_table_are_the_same(tmp_path: Path, there: Cluster) -> None:
    k, c, b = it.Spring(120e3), it.Damper(4000.0), it.Inerter(366.0)
    strut = k | c - (b | it.Friction(30.0))
    car = paper_quarter_car(strut)
    comfort, roads = J1, it.ExpectedValue(realisations=16)
    record = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), seed=1).run(it.cosine(1e-3, 3.0), 1.0)
    with cluster_executor(there.address, None, {}) as workers, Processes(2) as processes:
        there.start_worker()
        values = [it.evaluate(car, comfort, roads, executor=executor) for executor in (None, processes, workers)]
        fits = [it.identify(record, "friction", starts=8, executor=executor) for executor in (None, processes, workers)]
    assert values[0] == values[1] == values[2]
    assert repr(fits[0].parameters) == repr(fits[1].parameters) == repr(fits[2].parameters)
    assert fits[0].simulations == fits[1].simulations == fits[2].simulations
    command = ("reproduce", "wang-su-2008", "--only", "table1")
    done(inerter(*command, "-o", tmp_path / "own", "-j", 2))
    done(inerter(*command, "-o", tmp_path / "there", "--scheduler", there.address))
    tables = {path.name for path in (tmp_path / "own").glob("*.csv")}
    assert "simulated-rows.csv" in tables
    for name in tables:
        assert (tmp_path / "own" / name).read_bytes() == (tmp_path / "there" / name).read_bytes()


@pytest.mark.marathon
@pytest.mark.timeout(900)
def test_what_kills_every_worker_is_named_and_the_rest_complete(tmp_path: Path, there: Cluster) -> None:
    for process in there.processes[1:]:
        kill(process)
    for _ in range(2):
        there.start_worker("--nanny")
    mark = f"__import__('tempfile').mkstemp(dir={str(tmp_path)!r}, prefix='mark') and "
    items = [f"abs({-i})" for i in range(40)]
    items.insert(20, f"{mark}{KILL}")
    with cluster_executor(there.address, None, {}) as workers, Pool(executor=workers) as pool:
        found: list[Any] = list(pool.spread(eval, items, lost=lambda item: item))
    assert sorted(map(str, found)) == sorted([*map(str, range(40)), items[20]])
    assert len(list(tmp_path.glob("mark*"))) == 3


@pytest.mark.marathon
@pytest.mark.timeout(900)
def test_workers_of_another_kind_are_refused(tmp_path: Path) -> None:
    """Without the package; with other sources of it; and one of these that comes when the work has begun."""
    shutil.copytree(SOURCES, tmp_path / "other" / "inerter", ignore=shutil.ignore_patterns("__pycache__"))
    with (tmp_path / "other" / "inerter" / "norms" / "h2.py").open("a") as source:
        source.write("\n# another line\n")
    (tmp_path / "none").mkdir()
    (tmp_path / "none" / "inerter.py").write_text(
        "raise ModuleNotFoundError('No module named inerter', name='inerter')"
    )
    study = study_file(tmp_path, 12, 8)
    for name, says in (
        ("other", "has other sources of inerter"),
        ("none", "cannot load this package ("),
    ):
        (tmp_path / name / "cluster").mkdir()
        with cluster(tmp_path / name / "cluster", 1, PYTHONPATH=str(tmp_path / name)) as made:
            words = ("run", study, "-o", tmp_path / "out", "--scheduler", made.address)
            errors = done(inerter(*words), 1)
            assert says in errors
            assert errors.count("\n") == 1
    (tmp_path / "cluster").mkdir()
    with cluster(tmp_path / "cluster", 1) as made:
        process = inerter("run", study, "-o", tmp_path / "out", "--scheduler", made.address, "--force")
        wait_until(lambda: finished(tmp_path) >= 2, process)
        made.start_worker(PYTHONPATH=str(tmp_path / "other"))
        assert "another version of inerter" in done(process, 1)


@pytest.mark.campaign
def test_a_scheduler_without_workers_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inerter.work.cluster._FIRST", 1.0)
    with (
        cluster(tmp_path, 0) as made,
        cluster_executor(made.address, None, {}) as workers,
        pytest.raises(WorkError, match=r"no workers.*dask worker tcp://"),
    ):
        Pool(executor=workers)
