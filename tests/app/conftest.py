"""A server whose processes are threads of the tests, and a page that asks it."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from starlette.testclient import TestClient

from inerter.app.routes import application
from inerter.app.server import Server
from inerter.app.start import InitialStudy

TOKEN, PORT, LIMIT, RECORD_LIMIT = "a-token-of-the-tests", 8000, 100_000, 1_000_000
DOCUMENT: dict[str, Any] = {
    "title": "A car",
    "vehicle": {
        "model": "quarter-car",
        "sprung_mass": "250 kg",
        "unsprung_mass": "35 kg",
        "tyre_stiffness": "150 kN/m",
    },
    "road": {"speed": "25 m/s", "roughness": "5e-7 m^3/cycle"},
    "elements": {
        "k": "20 kN/m",
        "c": {"from": "100 N s/m", "to": "100 kN s/m"},
        "b": {"from": "1 kg", "to": "1000 kg"},
        "f": "20 N",
    },
    "layouts": {"S1": "k | c", "S3": "k | c - (b | f)"},
    "study": {"indices": ["J1", "J3"], "optimise": "norm", "baseline": "S1"},
}


def threads() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Server:
    return Server(tmp_path_factory.mktemp("server"), InitialStudy(), process=threads)


@pytest.fixture(scope="module")
def client(server: Server) -> Iterator[TestClient]:
    app = application(server, TOKEN, PORT, LIMIT, RECORD_LIMIT)
    headers = {"Authorization": f"Bearer {TOKEN}"}
    with TestClient(app, f"http://127.0.0.1:{PORT}", headers=headers) as client:  # type: ignore[arg-type]
        yield client


def ask(client: TestClient, path: str, /, **body: Any) -> Any:
    """The answer to a request."""
    return client.post(f"/api/{path}", json=body).json()


def changed(**tables: Any) -> dict[str, Any]:
    """The document with some keys of its tables changed."""
    return {**DOCUMENT, **{name: {**DOCUMENT[name], **table} for name, table in tables.items()}}
