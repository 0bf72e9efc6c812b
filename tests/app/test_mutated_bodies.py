"""Bodies that nobody would send: each endpoint answers them or says what is wrong, and never fails."""

from __future__ import annotations

import copy
import json
import random
import time
from collections.abc import Iterator
from typing import Any

import pytest
from app.conftest import DOCUMENT
from campaigns import sampled
from folders import EXAMPLES
from starlette.testclient import TestClient

DESIGN = {"layout": "S3", "values": {"c": "2 kN s/m", "b": 100.0}, "name": "mine"}
PANEL = {
    "study": DOCUMENT,
    "client": "a test",
    "sequence": 1,
    "designs": [DESIGN, {"layout": "S1", "values": {"c": 1500.0}}],
    "baseline": {"layout": "S1", "values": {"c": 1500.0}},
    "indices": ["J1"],
    "methods": ["norm"],
}
ONE = {**{key: value for key, value in PANEL.items() if key != "designs"}, "design": DESIGN}
SEARCHED = {
    **DOCUMENT,
    "elements": {**DOCUMENT["elements"], "any": {"network": 1, "dampers": {"from": "10 N s/m", "to": "1 kN s/m"}}},
    "layouts": {**DOCUMENT["layouts"], "any": "k | any"},
}
BODIES: dict[str, dict[str, Any]] = {
    "study/read": {"text": (EXAMPLES / "quarter-car.toml").read_text(), "name": "a.toml"},
    "study/read document": {"study": DOCUMENT},
    "study/check": {"study": DOCUMENT},
    "study/parts": {"study": SEARCHED},
    "study/rename": {"study": DOCUMENT, "names": {"k": "spring", "c": "b", "b": "c"}},
    "study/device": {
        "study": DOCUMENT,
        "network": "k | c",
        "device": {"elements": {"b": "9 kg"}, "layouts": {"d": "b"}},
    },
    "study/write": {"study": DOCUMENT, "designs": [DESIGN]},
    "network/parse": {"text": "k | c - (b | f)", "elements": ["k", "c", "b", "f"]},
    "quantity": {"text": "5 kN/m", "unit": "N/m", "digits": 4},
    "quantities": {"items": [{"text": "5 kN/m"}, {"value": 5.0, "unit": "kg"}]},
    "panel/indices": PANEL,
    "panel/compare": PANEL,
    "panel/response": PANEL,
    "panel/mechanism": ONE,
    "panel/optimise": {"study": DOCUMENT, "layouts": ["S1"], "indices": ["J1"], "method": "norm"},
    "panel/history": {**ONE, "duration": 0.05, "step": 5e-4, "seed": 1, "outputs": ["sprung_displacement"]},
    "panel/tolerance": {**ONE, "index": "J1", "spread": {"c": 0.1}, "samples": 16, "seed": 1, "method": "norm"},
    "panel/budget": {**ONE, "index": "J1", "parameter": "c", "method": "norm"},
    "figure": {"kind": "networks", "format": "svg", "study": DOCUMENT, "designs": [DESIGN]},
    "export/design": {"kind": "svg", "suffix": ".svg", "study": DOCUMENT, "design": DESIGN, "index": "J1"},
    "export/csv": {"panel": "indices", "request": PANEL},
    "work": {"kind": "optimise", "study": DOCUMENT, "layouts": ["S1"], "indices": ["J1"], "wait": 0.0},
    "work sweep": {"kind": "sweep", "study": DOCUMENT, "layouts": ["S1"], "sweep": {"k": ["10 kN/m", "20 kN/m"]}},
    "work front": {"kind": "front", "study": DOCUMENT, "layouts": ["S1"], "indices": ["J1", "J3"], "points": 3},
    "work identify": {"kind": "identify", "records": [], "model": "ideal", "config": {"fit": {"seed": 1}}},
}
MARKUP = "<img src=x onerror=alert(1)>"
ODD: list[Any] = [
    None, True, False, 0, -1, 1, 3.5, 1e308, -1e308, 5e-324, 10**30, 10**400, "", " ", "\0", "\u202eabc", "\ud800", "x",
    "x" * 300, MARKUP, "\"'><b>", "5 kg", "5", "nan", "inf N/m", "1e999 N/m", "1e50 N/m", "1e-50 kg", "0 kg", "-3 N/m",
    "k | (", "k |", "((((k", "J1", "../../etc/passwd", "__proto__", "constructor", "\uff11 N/m", [], {}, [[]], [None],
    {"": ""}, {"from": "1 kg", "to": "2 kg"}, {"from": 1}, {"tied": "k"}, {"network": 3}, {"kind": 7}, {"k": {"k": {}}},
    [1] * 50, {str(i): i for i in range(50)},
]  # fmt: skip
LONGEST = 30.0  # [s] of an answer, on a busy machine


def _places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield path
    if isinstance(value, dict):
        for key in value:
            yield from _places(value[key], (*path, key))
    elif isinstance(value, list):
        for i, each in enumerate(value):
            yield from _places(each, (*path, i))


def _mutated(body: dict[str, Any], chance: random.Random) -> dict[str, Any]:
    """The body with one to three of its entries changed, taken away, doubled or put under another name."""
    body = copy.deepcopy(body)
    for _ in range(chance.randint(1, 3)):
        places = [path for path in _places(body) if path]
        if not places:
            break
        path = chance.choice(places)
        inside: Any = body
        for key in path[:-1]:
            inside = inside[key]
        last = path[-1]
        how = chance.choice(["odd", "odd", "odd", "gone", "named", "nested"])
        if how == "gone":
            del inside[last]
        elif how == "named" and isinstance(inside, dict):
            inside[chance.choice([each for each in ODD if isinstance(each, str)])] = inside.pop(last)
        elif how == "nested":
            inside[last] = chance.choice([[inside[last]], {"x": inside[last]}, [inside[last]] * 2])
        else:
            inside[last] = copy.deepcopy(chance.choice(ODD))
    return body


def _is_about(path: str) -> str:
    return path.partition(" ")[0]


def _send(client: TestClient, path: str, body: dict[str, Any]) -> tuple[int, Any, str]:
    text = json.dumps(body)
    begun = time.monotonic()
    answer = client.post(f"/api/{_is_about(path)}", content=text.encode("utf-8", "surrogatepass"))
    assert time.monotonic() - begun < LONGEST, text
    if _is_about(path) == "work" and answer.status_code == 201:
        name = answer.json()["id"]
        client.delete(f"/api/work/{name}")
        return answer.status_code, answer.json(), text
    told = answer.json() if answer.headers["content-type"] == "application/json" else None
    return answer.status_code, told, text


def _check(status: int, told: Any, text: str) -> None:
    assert status in (200, 201, 400, 404, 409), (status, told, text)
    if status not in (200, 201):
        assert isinstance(told["sentence"], str), text
        assert told["sentence"], text
        assert "This cannot be computed" not in told["sentence"], (told, text)  # an error that nothing foresees
        assert "Traceback" not in told["sentence"]


@pytest.mark.parametrize("path", BODIES)
def test_the_bodies_that_are_changed_are_valid(client: TestClient, path: str) -> None:
    status, told, _ = _send(client, path, BODIES[path])
    assert status in (200, 201), told


@pytest.mark.parametrize(("path", "seed"), sampled([(path, seed) for path in BODIES for seed in range(10)],
                                                   always=[(path, 0) for path in BODIES], kept=9))  # fmt: skip
def test_no_body_is_a_fault_of_the_program(client: TestClient, path: str, seed: int) -> None:
    """Thirty bodies by each seed: 90 for every endpoint in a campaign, 270 in a marathon."""
    chance = random.Random(f"{path} {seed}")
    for _ in range(8 if seed == 0 else 30):
        _check(*_send(client, path, _mutated(BODIES[path], chance)))


@pytest.mark.parametrize("seed", range(3))
def test_no_bytes_are_a_fault_of_the_program(client: TestClient, seed: int) -> None:
    chance = random.Random(seed)
    for path, body in BODIES.items():
        text = bytearray(json.dumps(body).encode())
        for _ in range(chance.randint(1, 4)):
            text[chance.randrange(len(text))] = chance.randrange(256)
        answer = client.post(f"/api/{_is_about(path)}", content=bytes(text))
        if answer.status_code == 201:
            client.delete(f"/api/work/{answer.json()['id']}")
        assert answer.status_code in (200, 201, 400, 404, 409), (answer.text, bytes(text))
