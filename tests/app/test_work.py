"""Long work: told as it goes on, stopped at its next check, and there again for a page that was loaded again."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from app.conftest import DOCUMENT, ask, changed, threads
from starlette.testclient import TestClient

from inerter.app import jobs
from inerter.app.kinds import KINDS, WorkKind
from inerter.app.working import _Telling, events_of
from inerter.files.study import checking
from inerter.work.progress import ProgressStep

LONG = changed(study={"sweep": {"k": {"from": "10 kN/m", "to": "30 kN/m", "points": 100_000}}, "indices": ["J1"]})


def begin(client: TestClient, **body: Any) -> str:
    return str(ask(client, "work", **body)["id"])


def events(client: TestClient, number: str, last: str = "0") -> list[tuple[int, str, Any]]:
    text = client.get(f"/api/work/{number}/events", headers={"Last-Event-ID": last}).text
    found = []
    for block in text.strip().split("\n\n") if text.strip() else []:
        fields = dict(line.split(": ", 1) for line in block.split("\n"))
        found.append((int(fields["id"]), fields["event"], json.loads(fields["data"])))
    return found


def _so_far(server: Any, number: str) -> list[str]:
    """What work that goes on has told."""
    return [event["told"] for event in events_of(server.root / "work" / number)[0] if event["event"] == "progress"]


def _wait_for(found: Callable[[], Any]) -> Any:
    """What is found at last; only a hang reaches the limit."""
    limit = time.monotonic() + 240.0
    while not (value := found()):
        assert time.monotonic() < limit
        time.sleep(0.02)
    return value


def until(client: TestClient, number: str, *states: str) -> Any:
    def told() -> Any:
        job = client.get(f"/api/work/{number}").json()
        return job if job["state"] in states else None

    return _wait_for(told)


@pytest.mark.campaign
def test_a_long_sweep_stops_at_its_next_check(client: TestClient) -> None:
    number = begin(client, kind="run", study=LONG)
    _wait_for(lambda: client.get(f"/api/work/{number}").json()["done"] >= 2)
    assert client.delete(f"/api/work/{number}").json()["state"] == "running"
    told = until(client, number, "stopped")
    assert 2 <= told["done"] < 100_000
    found = events(client, number)
    assert [event for _, event, _ in found[-1:]] == ["stopped"]
    assert client.get(f"/api/work/{number}/result").status_code == 404
    names = [row["name"] for row in client.get(f"/api/work/{number}/files").json()["files"]]
    assert "journal.jsonl" in names  # what was computed is kept
    after = client.post("/api/work", json={"kind": "compare", "study": DOCUMENT, "layouts": ["S1", "S3"], "wait": 30})
    assert after.json()["state"] == "done"  # the queue goes on
    assert client.delete(f"/api/work/{number}").json()["state"] == "forgotten"
    assert client.get(f"/api/work/{number}").status_code == 404


def test_a_sweep_that_is_being_prepared_tells_how_far_it_is_and_stops(
    client: TestClient, server: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each layout is assembled at many of its points, however long that takes: here 20 s."""
    check = checking._check_design
    monkeypatch.setattr(checking, "_sound", None)
    monkeypatch.setattr(checking, "_check_design", lambda *design: (time.sleep(0.05), check(*design)))
    number = begin(client, kind="run", study=LONG)
    _wait_for(lambda: len(_so_far(server, number)) >= 4)
    client.delete(f"/api/work/{number}")
    assert until(client, number, "stopped")["done"] == 0
    told = _so_far(server, number)
    assert "preparing 0 of 400" in told
    assert len({*told}) == len(told)
    assert "preparing 399 of 400" not in told
    assert client.get(f"/api/work/{number}/files").json()["files"] == []


def test_a_page_that_is_loaded_again_sees_all(client: TestClient) -> None:
    number = begin(client, kind="optimise", study=DOCUMENT, title="mine")
    until(client, number, "done")
    listed = {row["id"]: row for row in client.get("/api/work").json()["work"]}
    assert (listed[number]["title"], listed[number]["done"], listed[number]["total"]) == ("mine", 4, 4)
    found = events(client, number)
    assert [event for _, event, _ in found][-1] == "done"
    assert [data["done"] for _, event, data in found if event == "progress"] == sorted(
        data["done"] for _, event, data in found if event == "progress"
    )
    middle = found[0][0]
    assert events(client, number, str(middle)) == [one for one in found if one[0] > middle]
    assert events(client, number, "nonsense") == found


def test_work_that_waits_is_stopped_at_once(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(KINDS, "endless", WorkKind("endless", "Without end", (), "app.test_work:endless"))
    first, second = begin(client, kind="endless"), begin(client, kind="optimise", study=DOCUMENT)
    assert client.delete(f"/api/work/{second}").json()["state"] == "stopped"
    until(client, first, "running")
    client.delete(f"/api/work/{first}")
    until(client, first, "stopped")


def endless(request: Any, folder: Any, tell: Any) -> Any:
    while True:
        tell(0, 1, "")
        time.sleep(0.01)


@pytest.mark.parametrize(
    "body",
    [
        {"kind": "run", "study": {}},
        {"kind": "run"},
        {"kind": "sweep", "study": DOCUMENT},
        {"kind": "sweep", "study": DOCUMENT, "sweep": {"zz": ["1 kg", "2 kg"]}},
        {"kind": "compare", "study": DOCUMENT, "layouts": ["S1"]},
        {"kind": "compare", "study": DOCUMENT, "designs": [{"layout": "S1"}] * 5},
        {"kind": "identify"},
        {"kind": "front", "study": DOCUMENT, "indices": ["J1"]},
        {"kind": "optimise", "study": DOCUMENT, "layouts": ["S9"]},
    ],
)
def test_work_that_cannot_be_done_has_a_sentence(client: TestClient, body: Any) -> None:
    told = ask(client, "work", **body, wait=30)
    assert told["state"] == "failed"
    assert told["sentence"].strip().endswith((".", "?"))
    assert events(client, told["id"])[-1][1] == "failed"


def test_a_further_kind_is_one_row(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(KINDS, "count", WorkKind("count", "Counting", (), "app.test_work:count"))
    told = ask(client, "work", kind="count", wait=30)
    assert (told["state"], told["title"], told["result"]) == ("done", "Counting", {"counted": 3})


def count(request: Any, folder: Any, tell: Any) -> Any:
    for number in range(3):
        tell(number, 3, "")
    return {"counted": 3}


_OF_S3 = {"layout": "S3", "values": {}}
TITLES: list[tuple[dict[str, Any], str]] = [
    ({"kind": "run"}, "Run the whole study"),
    ({"kind": "optimise", "layouts": ["S1", "S3"], "indices": ["J1"]}, "Best J1 of S1 and S3"),
    ({"kind": "sweep", "sweep": {"k": {"from": "1 N/m", "to": "9 N/m"}}}, "Sweep of k from 1 N/m to 9 N/m"),
    ({"kind": "sweep", "sweep": {"k": {"factor": 2}, "b": ["1 kg", "2 kg"]}}, "Sweep of k and b"),
    ({"kind": "sweep"}, "Sweep"),
    ({"kind": "front", "indices": ["J1", "J3", "J5"]}, "Trade-off front of J1, J3 and J5"),
    ({"kind": "margins", "design": _OF_S3}, "Break-even values of S3"),
    ({"kind": "margins", "layout": "S3"}, "Break-even values of S3"),
    ({"kind": "report", "designs": [_OF_S3, {"layout": "S1", "values": {}}]}, "Report of S3"),
]


@pytest.mark.parametrize(("asked", "subject"), TITLES, ids=str)
def test_a_job_is_called_by_what_it_is_about(server: Any, asked: dict[str, Any], subject: str) -> None:
    kind = asked["kind"]
    """The title of the study is told beside that, since most jobs are of the study that is open."""
    for title, told in (("A car", "A car"), ("", ""), (5, "")):
        job = server.jobs.add(kind, {**asked, "study": {"title": title}}).to_dict()
        assert (job["title"], job["study"]) == (subject, told)
    assert server.jobs.add(kind, asked).title == subject
    assert server.jobs.add(kind, asked, "My own").title == "My own"


@pytest.mark.parametrize(
    ("done", "total", "seconds", "left"),
    [
        (50, 1000, 10.0, ""),
        (250, 1000, 10.0, ", about 30 s left"),
        (500, 1000, 600.0, ", about 10 min left"),
        (1000, 1000, 9.0, ""),
        (1, 4, 10.0, ""),
    ],
)
def test_the_running_step_is_told_with_the_time_that_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, done: int, total: int, seconds: float, left: str
) -> None:
    """Where many small parts tell it, and not at the beginning; a step that is repeated is not told again."""
    monkeypatch.setattr("inerter.app.working.time.monotonic", lambda: 1e5 + seconds)
    telling, step = _Telling(tmp_path, count=(done, total), begun=(1e5, 0)), ProgressStep("starts", 3, 16)
    for tell in (lambda: telling.step(step), lambda: telling(done, total, "drawing"), lambda: telling.step(step)):
        telling.last = 0.0
        tell()
    told = [event["told"] for event in events_of(tmp_path)[0]]
    assert told == [f"starts 3 of 16{left}", f"drawing{left}", f"drawing{left}"]


def test_a_kind_that_a_person_may_begin_says_what_it_does(client: TestClient) -> None:
    told = {kind["key"]: kind for kind in client.get("/api/about").json()["work"]}
    assert {key for key, kind in told.items() if kind["description"]} == {"run", "sweep", "front", "search"}
    assert all(kind["description"].endswith(".") for kind in told.values() if kind["lacking"])


def test_a_fault_is_told_and_the_queue_goes_on(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(KINDS, "fault", WorkKind("fault", "A fault", (), "app.test_work:nothing_of_that_name"))
    told = ask(client, "work", kind="fault", wait=30)
    assert told["state"] == "failed"
    assert told["sentence"]
    assert ask(client, "work", kind="optimise", study=DOCUMENT, wait=30)["state"] == "done"


def test_only_so_much_work_is_kept(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jobs, "_MOST", 3)
    numbers = [begin(client, kind="run", study={}, wait=20) for _ in range(5)]
    there = [row["id"] for row in client.get("/api/work").json()["work"]]
    assert there[-1] == numbers[-1]
    assert len(there) <= 3


def test_a_server_that_begins_again_knows_what_was_left(client: TestClient, server: Any, tmp_path: Path) -> None:
    """What is done is there with its result; what was cut short says so, also where a line was."""
    number = begin(client, kind="optimise", study=DOCUMENT, title="mine", wait=30)
    result = client.get(f"/api/work/{number}/result").content
    shutil.copytree(server.root / "work" / number, tmp_path / "work" / number)
    cut = tmp_path / "work" / "cut"
    shutil.copytree(server.root / "work" / number, cut)
    text = (cut / "events.jsonl").read_bytes()
    (cut / "events.jsonl").write_bytes(text[: text.index(b'{"event": "done"') + 9])
    (tmp_path / "work" / "empty").mkdir()
    with threads() as executor:
        known = jobs.Jobs(tmp_path / "work", executor).known
    assert {job.id: job.state for job in known.values()} == {number: "done", "cut": "stopped"}
    assert jobs.result_of(known[number]) == result
    assert (known[number].title, known[number].to_dict()["done"]) == ("mine", 4)
    assert known["cut"].sentence.endswith(".")
    assert known["cut"].to_dict()["state"] == "stopped"


@pytest.mark.parametrize("text", ['{"kind": "run", "title": "dear to me"}', "[]", '"run"', "no JSON"])
def test_a_folder_of_somebody_elses_is_not_taken_for_work(tmp_path: Path, text: str) -> None:
    """What is known can be forgotten with its folder, by age too."""
    own = tmp_path / "mine"
    own.mkdir()
    (own / "request.json").write_text(text, encoding="utf-8")
    with threads() as executor:
        assert jobs.Jobs(tmp_path, executor).known == {}
    assert [path.name for path in own.iterdir()] == ["request.json"]
    assert (own / "request.json").read_text(encoding="utf-8") == text
