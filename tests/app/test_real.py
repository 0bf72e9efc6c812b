"""A real server, as the command line starts it: its link, where it listens, many connections, its end."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from app.conftest import DOCUMENT, ask
from folders import EXAMPLES

import inerter as it
from inerter.app.documents import study_from
from inerter.app.running import _text_of
from inerter.cli.main import call

START = "from inerter.cli.start import main; main()"


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[httpx.Client, subprocess.Popen[str], Path]]:
    """A client with the token, the process, and the folder that it puts its things in."""
    home = tmp_path_factory.mktemp("home")
    command = [sys.executable, "-c", START, "serve", str(EXAMPLES / "quarter-car.toml"), "--no-browser"]
    environment = {**os.environ, "TMPDIR": str(home)}
    environment.pop("INERTER_TOKEN", None)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdout is not None
    link = process.stdout.readline().strip()
    base, _, token = link.partition("/#token=")
    with httpx.Client(base_url=base, headers={"Authorization": f"Bearer {token}"}, timeout=60.0) as client:
        yield client, process, home
    if process.poll() is None:
        process.kill()
    process.wait()
    process.stdout.close()


def children_of(process: subprocess.Popen[str]) -> list[str]:
    """The processes that a process has started, from whichever of its threads."""
    return [one for path in Path(f"/proc/{process.pid}/task").glob("*/children") for one in path.read_text().split()]


def works(number: str) -> bool:
    """Whether there is a process of that number that has not ended."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def listening(port: int) -> set[str]:
    """The addresses of this machine on which something listens at a port."""
    found = set()
    for name, size in (("tcp", 8), ("tcp6", 32)):
        for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]:
            address, number = line.split()[1].split(":")
            if line.split()[3] == "0A" and int(number, 16) == port:
                found.add(address if size == 32 else socket.inet_ntoa(bytes.fromhex(address)[::-1]))
    return found


def test_it_answers_as_python_does(served: Any) -> None:
    client, _, _ = served
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/?", str(client.base_url))
    start = client.get("/api/start").json()
    assert start["name"] == "quarter-car.toml"
    assert start["problems"] == []
    about = client.get("/api/about").json()
    assert about["version"] == it.__version__
    design = {"layout": "S3", "values": {"c": 3000.0, "b": 50.0}}
    answer = client.post(
        "/api/panel/indices", json={"study": DOCUMENT, "designs": [design], "client": "a", "sequence": 1}
    )
    study = study_from(DOCUMENT)
    car = study.design("S3").with_values(design["values"])
    for row in answer.json()["designs"][0]["results"]:
        assert row["value"] == it.evaluate(car, study.index(row["index"]), it.Norm()).value


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="no list of sockets")
def test_nothing_listens_on_another_address(served: Any) -> None:
    client, _, _ = served
    assert listening(client.base_url.port) == {"127.0.0.1"}


def test_others_are_refused(served: Any) -> None:
    client, _, _ = served
    assert client.get("/api/about", headers={"Authorization": ""}).status_code == 401
    assert client.get("/api/about", headers={"Host": "evil.example"}).status_code == 403
    assert client.get("/api/about", headers={"Origin": "http://evil.example"}).status_code == 403
    with socket.create_connection(("127.0.0.1", client.base_url.port)) as raw:
        raw.sendall(b"GET /../../../etc/passwd HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % client.base_url.port)
        assert raw.recv(100).startswith(b"HTTP/1.1 404")
    with socket.create_connection(("127.0.0.1", client.base_url.port)) as raw:
        raw.sendall(b"\x16\x03\x01 nonsense\r\n\r\n")
        assert raw.recv(100).startswith(b"HTTP/1.1 400")


def test_a_thousand_connections_do_no_harm(served: Any) -> None:
    """All are taken, those that say nothing too, and one more is answered soon."""
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard < 1200:
        pytest.skip("this machine does not allow as many")
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    client, process, _ = served
    port = client.base_url.port
    request = b"GET /api/start HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nAuthorization: %s\r\n\r\n"
    token = client.headers["Authorization"].encode()
    try:
        with ExitStack() as stack:
            several = [stack.enter_context(socket.create_connection(("127.0.0.1", port), 30.0)) for _ in range(1000)]
            for connection in several[::2]:  # the others say nothing
                connection.sendall(request % (port, token))
            assert client.get("/api/start").status_code == 200
            for connection in several[::2]:
                assert connection.recv(20).startswith(b"HTTP/1.1 200")
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
    assert client.get("/api/start").status_code == 200
    assert process.poll() is None


@pytest.mark.campaign
def test_it_ends_and_leaves_nothing(served: Any) -> None:
    """The last of these tests: an end in the midst of long work leaves no folder and no process behind."""
    client, process, home = served
    sweep = {"k": {"from": "10 kN/m", "to": "30 kN/m", "points": 10_000}}
    work = ask(client, "work", kind="sweep", study=DOCUMENT, sweep=sweep)["id"]
    deadline = time.monotonic() + 60.0
    while client.get(f"/api/work/{work}").json()["done"] < 1 and time.monotonic() < deadline:
        time.sleep(0.05)
    told = client.get(f"/api/work/{work}").json()
    assert told["state"] == "running", told
    children = children_of(process)
    assert len(children) >= 2
    process.send_signal(signal.SIGTERM)
    assert process.wait(20.0) == 0
    assert list(home.glob("inerter-*")) == []
    deadline = time.monotonic() + 5.0
    while left := [child for child in children if works(child)]:
        assert time.monotonic() < deadline, left
        time.sleep(0.05)


def test_wrong_requests_of_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each is one sentence and exit code 2, before anything is served."""
    monkeypatch.setenv("INERTER_TOKEN", "a-token-that-is-long-enough")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        for arguments, words in (
            ([str(tmp_path / "nothing.toml")], "no such file"),
            (["--port", port], "is not available"),
            (["--port", "99999"], "65535"),
            (["--limit", "0"], "bytes"),
        ):
            assert call(["serve", "--no-browser", *arguments]) == 2
            told = capsys.readouterr()
            assert words in told.err.lower()
            assert len(told.err.strip().splitlines()) == 1
            assert told.out == ""
    monkeypatch.setenv("INERTER_TOKEN", "short")
    assert call(["serve", "--no-browser"]) == 2


def test_without_the_extra_there_is_a_sentence() -> None:
    program = (
        "import sys\nimport inerter as it\n"
        "for name in ('starlette', 'uvicorn', 'pydantic'):\n"
        "    sys.modules[name] = None\n"
        "    try: it.serve(browser=False)\n"
        "    except it.InerterError as error: print(error)\n"
        "    del sys.modules[name]"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60.0, check=False)
    assert found.stdout.count('pip install "inerter[web]"') == 3, found


def test_the_command_line_loads_none_of_it() -> None:
    program = (
        "import sys, json\nfrom inerter.cli.main import call\n"
        "for words in (['--help'], ['serve', '--help']): call(words)\n"
        "print(json.dumps([name for name in sys.modules if name.split('.')[0] in ('starlette', 'uvicorn')"
        " or (name.startswith('inerter.app.') and name != 'inerter.app.serve')]))"
    )
    command = [sys.executable, "-c", program]
    found = subprocess.run(command, capture_output=True, text=True, timeout=60.0, check=False)
    assert json.loads(found.stdout.splitlines()[-1]) == []


@pytest.mark.marathon
def test_processes_that_die_cost_what_they_did(tmp_path: Path) -> None:
    """Whichever process of a server is killed, at random times: it answers again, and what was done says so."""
    random = np.random.default_rng(0)
    command = [sys.executable, "-c", START, "serve", "--no-browser", "--folder", str(tmp_path / "kept")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        base, _, token = process.stdout.readline().strip().partition("/#token=")
        body = {"study": DOCUMENT, "layouts": ["S3"], "methods": ["norm"]}
        with httpx.Client(base_url=base, headers={"Authorization": f"Bearer {token}"}, timeout=60.0) as client:
            wanted = ask(client, "panel/indices", **body)["designs"]
            client.post("/api/panel/optimise", json=body).raise_for_status()
            for _ in range(3):
                work = ask(client, "work", kind="run", study=DOCUMENT)["id"]
                time.sleep(float(random.uniform(0.0, 1.0)))
                os.kill(int(random.choice(children_of(process))), signal.SIGKILL)
                deadline = time.monotonic() + 60.0
                while (told := client.get(f"/api/work/{work}").json())["state"] in ("waiting", "running"):
                    assert time.monotonic() < deadline
                    time.sleep(0.05)
                assert told["state"] in ("done", "failed")
                assert told["state"] == "done" or "ended" in told["sentence"]
                answers = [client.post("/api/panel/indices", json=body) for _ in range(2)]
                assert answers[0].status_code in (200, 500)
                assert answers[1].json()["designs"] == wanted
        process.terminate()
    assert (tmp_path / "kept" / "work").is_dir()


def test_a_folder_that_can_be_none_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").touch()
    command = [sys.executable, "-c", START, "serve", "--no-browser", "--folder", str(tmp_path / "mine.txt")]
    told = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert told.returncode == 2
    assert "mine.txt: cannot be used as the folder of jobs" in told.stderr
    assert len(told.stderr.splitlines()) == 1


def test_a_study_object_is_served_as_the_file_that_asks_the_same(tmp_path: Path) -> None:
    study = it.load_study(EXAMPLES / "limits.toml")
    named = _text_of(study)
    assert named is not None
    path = tmp_path / named[0]
    path.write_text(named[1], encoding="utf-8")
    assert it.load_study(path).to_tables() == study.to_tables()


SWALLOWED = """
import os, signal, sys
from inerter.app import running

def load(name, real=running.import_module):
    try:
        if name.startswith("inerter"):
            os.kill(os.getpid(), signal.{})
    except BaseException:  # as libraries do
        print("swallowed", flush=True)
    return real(name)

running.import_module = load
running.run(None, port=None, browser=False, limits=(10, 10), folder=None, tell=print)
print("ended", flush=True)
"""


@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT"])
def test_an_interrupt_that_what_is_loaded_swallows_ends_it_all_the_same(name: str, tmp_path: Path) -> None:
    command = [sys.executable, "-c", SWALLOWED.replace("{}", name)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=60, check=False)
    assert done.stdout.splitlines()[1:] == ["swallowed", "ended"], done.stderr
