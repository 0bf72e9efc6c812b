"""Whatever an executor does to chunks and results, a run ends with right numbers or a sentence."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns import sampled
from study_text import study_text
from wang_su import J1, paper_quarter_car

import inerter as it
from inerter.cli import cluster as of_command
from inerter.cli.main import call
from inerter.errors import DesignError, InerterError, WorkError
from inerter.work.chunks import Chunk, ChunkResult
from inerter.work.pool import Pool
from inerter.work.running import map_items, running_on

STUDY = study_text(
    'indices = ["J1", "J3"]\noptimise = "norm"\nbudgets = ["b"]\nsweep = { k = ["10 kN/m", "20 kN/m", "30 kN/m"] }',
    elements='k = "20 kN/m"\nc = { from = "100 N s/m", to = "10 kN s/m" }\nb = "30 kg"',
    layouts='S1 = "k | c"\nS2 = "k | c | b"',
).replace('budgets = ["b"]\n', "")
Call = Callable[..., Any]


class Faulty(Executor):
    """Calls at once, and does some of the calls in a wrong way: those whose number `when` picks."""

    def __init__(self, fault: Callable[[Faulty, Call, Any, Chunk[Any]], Any], when: Callable[[int], bool]) -> None:
        self.fault, self.when, self.calls = fault, when, 0
        self.before: Any = None

    def submit(self, call: Call, /, *args: Any, **keywords: Any) -> Future[Any]:
        self.calls += 1
        future: Future[Any] = Future()
        try:
            found = self.fault(self, call, *args) if self.when(self.calls) else call(*args)
            if isinstance(found, ChunkResult) and found.chunk == args[1].number:
                self.before = found
            future.set_result(found)
        except Exception as error:
            future.set_exception(error)
        return future


def earlier(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
    """The chunk before this once more, and this one lost."""
    return self.before


def shortened(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
    return call(work, replace(chunk, items=chunk.items[:-1]))


def lengthened(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
    return call(work, replace(chunk, items=(*chunk.items, chunk.items[0])))


def cut_off(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
    found = call(work, chunk)
    return replace(found, results=found.results[1:])


def nothing(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
    return None


def a_list(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
    return list(call(work, chunk).results)


def relabelled(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
    """The results of another chunk, said to be of this one."""
    return replace(self.before, chunk=chunk.number) if self.before else None


def raising(error: Exception) -> Callable[..., Any]:
    def fault(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
        raise error

    fault.__name__ = type(error).__name__
    return fault


def without_memory(self: Faulty, call: Call, work: Any, chunk: Chunk[Any]) -> Any:
    def greedy(item: Any) -> Any:
        raise MemoryError

    return call(greedy, chunk)


FAULTS = (
    *(earlier, shortened, lengthened, cut_off, nothing, a_list, relabelled, without_memory),
    *map(raising, (MemoryError(), OSError("the network is gone"), ValueError("odd"), KeyError("x"), CancelledError())),
    raising(ModuleNotFoundError("No module named 'inerter'", name="inerter")),
)
NEVER_MENDED = {"CancelledError", "ModuleNotFoundError"}  # of these there is a sentence at the first


def now_and_then(seed: int) -> Callable[[int], bool]:
    draws = random.Random(seed)
    return lambda number: number > 1 and draws.random() < 0.3


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> it.Study:
    path = tmp_path_factory.mktemp("study") / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    return it.load_study(path)


@pytest.fixture(scope="module")
def right(study: it.Study, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("right") / "out"
    it.run_study(study, folder)
    return (folder / "summary.csv").read_bytes()


def ended(work: Callable[[], Any]) -> tuple[Any, WorkError | None]:
    """What work gives, or the error with which it ends."""
    try:
        return work(), None
    except WorkError as error:
        return None, error


def once(number: int) -> bool:
    return number == 2


def ever_after(number: int) -> bool:
    return number > 2


ALWAYS_RUN = {(earlier, once), (earlier, ever_after), (nothing, once), (without_memory, ever_after)}
RUNS = sampled(product(FAULTS, (once, ever_after)), ALWAYS_RUN, kept=6)


@pytest.mark.parametrize(("fault", "when"), RUNS, ids=lambda given: given.__name__)
def test_a_run_ends_right_or_with_a_sentence_and_nothing_is_lost(
    fault: Callable[..., Any], when: Callable[[int], bool], study: it.Study, right: bytes, tmp_path: Path
) -> None:
    executor, out = Faulty(fault, when), tmp_path / "out"
    found, error = ended(lambda: it.run_study(study, out, executor=executor))
    if found is None:
        assert re.fullmatch(r"[^\n]{20,600}\. Completed results are kept; continue with --resume\.", str(error))
        assert fault.__name__ in NEVER_MENDED or (not when(1) and (when(3) or fault is relabelled))
        again = it.run_study(study, out, resume=True)
        assert again.computed < 12  # at least the first chunk is kept
        assert (out / "summary.csv").read_bytes() == right
        return
    assert "missing" not in {str(one) for one in found.data.status.values.ravel()}
    if found.failed:  # without memory to the end: by name, and nothing else
        assert fault.__name__ in {"without_memory", "MemoryError"}
        assert all("no memory left" in line for line in found.failures)
    else:
        assert (out / "summary.csv").read_bytes() == right


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
@pytest.mark.parametrize("seed", range(3))
def test_values_are_right_or_there_is_a_sentence(fault: Callable[..., Any], seed: int) -> None:
    items = [float(number) for number in range(200)]
    with Pool(executor=Faulty(fault, now_and_then(seed))) as pool, running_on(pool):
        found, error = ended(lambda: map_items(np.sqrt, items))
    assert found == [np.sqrt(item) for item in items] or (
        found is None and re.fullmatch(r"[^\n]{20,600}\.", str(error))
    )


@pytest.mark.parametrize(
    "executor", [object(), "dask", 4, Executor, {}], ids=["object", "text", "number", "class", "mapping"]
)
def test_what_is_no_executor_is_told(executor: Any, study: it.Study, tmp_path: Path) -> None:
    car = paper_quarter_car(it.Spring(120e3) | it.Damper(it.free(1e3, 1e4)))
    comfort = J1
    for work in (
        lambda: it.run_study(study, tmp_path / "out", executor=executor),
        lambda: it.optimise(car, comfort, it.Norm(), executor=executor),
        lambda: it.evaluate_many(car, comfort, {"c": [2e3]}, it.Norm(), executor=executor),
    ):
        with pytest.raises(InerterError, match=r"`executor`: .* cannot run calls\. Expected one of concurrent.futures"):
            work()


def test_what_gives_no_future_is_told() -> None:
    class Direct(Executor):
        def submit(self, call: Call, /, *args: Any, **keywords: Any) -> Any:
            return call(*args)

    with Pool(executor=Direct()) as pool, pytest.raises(WorkError, match=r"expected a Future"):
        list(pool.spread(abs, [1]))


def test_an_error_of_the_work_is_raised_as_it_is_and_what_came_with_it_is_given() -> None:
    def third(item: int) -> int:
        if item == 3:
            raise DesignError("the third")
        return item

    found: list[int] = []
    with Pool(executor=Faulty(nothing, lambda number: False)) as pool:
        results = pool.spread(third, range(10))
        with pytest.raises(DesignError, match="the third"):
            found.extend(results)
    assert {0, 1, 2} <= set(found)


def test_work_here_without_memory_is_a_status(study: it.Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def greedy(*args: object, **settings: object) -> None:
        raise MemoryError

    monkeypatch.setattr("inerter.files.study.cases.optimise", greedy)
    found = it.run_study(study, tmp_path / "out")
    assert found.failed
    assert all("no memory left" in line for line in found.failures)


ENDS = (RuntimeError("ConnectionPool closing."), OSError("Connection refused"), TimeoutError(), ValueError("closed"))


@pytest.mark.parametrize("error", ENDS, ids=repr)
@pytest.mark.parametrize("call_that_fails", ["nthreads", "run_on_scheduler", "run", "scheduler_info"])
def test_a_scheduler_that_ends_while_a_run_connects_is_told(
    error: Exception, call_that_fails: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: Any
) -> None:
    distributed = pytest.importorskip("distributed")
    from inerter.work.cluster import process_versions  # noqa: PLC0415

    class Client(distributed.Client):  # type: ignore[misc,name-defined]
        """Of a scheduler with one worker, which ends at one of the calls."""

        def __init__(self, *args: object, **settings: object) -> None:
            self.gone = False

        def __enter__(self) -> Client:
            return self

        def __exit__(self, *error: object) -> None:
            pass

        def __del__(self) -> None:
            pass

        def _reached(self, call: str) -> None:
            self.gone = self.gone or call == call_that_fails
            if self.gone:
                raise error

        @property
        def status(self) -> str:
            return "closed" if self.gone else "running"

        @status.setter
        def status(self, value: str) -> None:
            pass

        def nthreads(self, *args: object, **settings: object) -> dict[str, int]:
            self._reached("nthreads")
            return {"tcp://1": 1}

        def run_on_scheduler(self, *args: object, **settings: object) -> object:
            self._reached("run_on_scheduler")
            return process_versions()

        def run(self, *args: object, **settings: object) -> dict[str, object]:
            self._reached("run")
            return {"tcp://1": process_versions()}

        def scheduler_info(self, *args: object, **settings: object) -> dict[str, object]:
            self._reached("scheduler_info")
            return {"address": "tcp://0", "workers": {"tcp://1": {"host": "here", "nthreads": 1}}}

        def get_executor(self, **settings: object) -> Executor:
            executor = Faulty(nothing, lambda number: False)
            executor._client = self  # type: ignore[attr-defined]
            return executor

    monkeypatch.setattr(of_command, "_ANSWER", "1s")
    monkeypatch.setattr(distributed, "Client", Client)
    path = tmp_path / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    assert call(["run", str(path), "-o", str(tmp_path / "out"), "--scheduler", "tcp://127.0.0.1:1"]) == 1
    said = capfd.readouterr().err
    assert re.search(r"^inerter: the scheduler has ended, or the connection to it was lost", said, re.M), said
    assert "ConnectionPool" not in said
