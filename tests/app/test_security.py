"""Who is refused: without the token, under another name, from another page, with too much, on paths elsewhere."""

from __future__ import annotations

import asyncio
from itertools import product
from typing import Any

import pytest
from app.conftest import DOCUMENT, LIMIT, PORT, RECORD_LIMIT, TOKEN, ask
from hypothesis import given
from hypothesis import strategies as st
from starlette.testclient import TestClient

from inerter.app.requests import ENDPOINTS
from inerter.app.routes import WEB

HOST = f"127.0.0.1:{PORT}"


def asked(client: TestClient, path: str, headers: list[tuple[str, str]], verb: str = "GET", body: bytes = b"") -> Any:
    """The status, the headers and the body that answer a raw request: nothing mends its path or adds a header."""
    sent: list[Any] = []
    scope = {
        "type": "http",
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "scheme": "http",
        "method": verb,
        "path": path.partition("?")[0],
        "raw_path": path.encode("utf-8", "surrogateescape"),
        "query_string": path.partition("?")[2].encode(),
        "root_path": "",
        "headers": [(name.encode(), value.encode("latin-1")) for name, value in headers],
        "client": ("127.0.0.1", 1),
        "server": ("127.0.0.1", PORT),
        "state": {},
    }

    bodies = [body]

    async def receive() -> Any:
        if not bodies:
            await asyncio.Event().wait()  # nobody goes away
        return {"type": "http.request", "body": bodies.pop(), "more_body": False}

    async def send(message: Any) -> None:
        sent.append(message)

    assert client.portal is not None
    client.portal.call(client.app, scope, receive, send)
    text = b"".join(message.get("body", b"") for message in sent[1:])
    return sent[0]["status"], dict(sent[0]["headers"]), text


BEARER = ("authorization", f"Bearer {TOKEN}")


@pytest.mark.parametrize("endpoint", ENDPOINTS, ids=lambda e: f"{e.verb} {e.path}")
@pytest.mark.parametrize(
    "token",
    [[], [("authorization", "")], [("authorization", "Bearer")], [("authorization", f"Bearer {TOKEN}x")],
     [("authorization", TOKEN)], [("authorization", f"Basic {TOKEN}")], [BEARER, BEARER],
     [("cookie", f"token={TOKEN}")]],
)  # fmt: skip
def test_nothing_is_told_without_the_token(client: TestClient, endpoint: Any, token: Any) -> None:
    status, _, text = asked(client, endpoint.path, [("host", HOST), *token], endpoint.verb, b"{}")
    assert status == 401
    assert TOKEN.encode() not in text


@pytest.mark.parametrize(
    "host",
    ["evil.example", f"evil.example:{PORT}", "127.0.0.1", f"127.0.0.1:{PORT + 1}", f"127.0.0.1.evil.example:{PORT}", "",
     f"0.0.0.0:{PORT}", f"[::1]:{PORT}", f"127.0.0.1:{PORT}@evil.example"],
)  # fmt: skip
@pytest.mark.parametrize("path", ["/", "/api/about"])
def test_another_host_is_refused(client: TestClient, host: str, path: str) -> None:
    assert asked(client, path, [("host", host), BEARER])[0] == 403


def test_a_request_has_one_host(client: TestClient) -> None:
    assert asked(client, "/api/about", [BEARER])[0] == 403
    assert asked(client, "/api/about", [("host", HOST), ("host", "evil.example"), BEARER])[0] == 403
    assert asked(client, "/api/about", [("host", f"localhost:{PORT}"), BEARER])[0] == 200


OWN = {"origin": f"http://{HOST}", "sec-fetch-site": "same-origin"}
ORIGINS = ["http://evil.example", "null", f"https://{HOST}", "http://127.0.0.1", f"http://127.0.0.1:{PORT + 1}",
           f"http://{HOST}.evil.example", "file://", ""]  # fmt: skip
FOREIGN = [*product(["origin"], ORIGINS), *product(["sec-fetch-site"], ["cross-site", "same-site", "anything"])]


@pytest.mark.parametrize(("header", "value"), FOREIGN)
def test_what_another_page_sends_is_refused(client: TestClient, header: str, value: str) -> None:
    for sent, code in ((value, 403), (OWN[header], 200)):
        assert asked(client, "/api/about", [("host", HOST), BEARER, (header, sent)])[0] == code


TRICKS = [
    "..",
    "../..",
    "%2e%2e",
    "..%2f",
    "....//",
    "..\\",
    "%5c..",
    "~",
    "/etc/passwd",
    "C:\\",
    "\0",
    ".",
    "",
    "//",
    "%00",
    "\udce4",
    "a" * 5000,
]


@given(
    parts=st.lists(
        st.sampled_from([*TRICKS, "etc", "passwd", "pyproject.toml", "index.html", "__init__.py"]), max_size=5
    )
)
def test_no_path_leads_out_of_the_page(client: TestClient, parts: list[str]) -> None:
    """Whatever a path is made of, it is a file of the page or nothing."""
    path = "/" + "/".join(parts)
    status, headers, text = asked(client, path, [("host", HOST)])
    assert status in (200, 404, 401)
    if status == 200:
        assert text in {file.read_bytes() for file in WEB.rglob("*") if file.is_file()}
    assert b"root:" not in text
    assert b"content-security-policy" in headers


def test_no_path_leads_out_of_a_piece_of_work(client: TestClient, server: Any) -> None:
    job = server.jobs.add("optimise", {"study": {}})
    secret = job.folder / "secret"
    (job.folder / "results").mkdir()
    secret.write_text("secret")
    (job.folder / "results" / "link").symlink_to(secret)
    (job.folder / "results" / "good.txt").write_text("good")
    headers = [("host", HOST), BEARER]
    assert asked(client, f"/api/work/{job.id}/files/good.txt", headers)[2] == b"good"
    for name in ("../secret", "link", "good.txt/../../secret", str(secret), "//" + str(secret), *TRICKS):
        status, _, text = asked(client, f"/api/work/{job.id}/files/{name}", headers)
        assert status in (404, 200)
        assert text != b"secret"
    for name in TRICKS:
        assert asked(client, f"/api/work/{name}/result", headers)[0] in (404, 405)


@pytest.mark.parametrize("told", [True, False])
@pytest.mark.parametrize(("path", "limit"), [("/api/study/read", LIMIT), ("/api/records?name=x.csv", RECORD_LIMIT)])
def test_a_body_over_the_limit_is_refused(client: TestClient, server: Any, path: str, limit: int, told: bool) -> None:
    more = [("content-length", str(limit + 1))] if told else []
    headers = [("host", HOST), BEARER, *more]
    status, _, text = asked(client, path, headers, "POST", b"" if told else b"x" * (limit + 1))
    assert status == 413
    assert str(limit).encode() in text
    assert asked(client, path, [("host", HOST), BEARER], "POST", b"x" * limit)[0] == 400
    assert server.records.known == {}


@pytest.mark.parametrize("length", ["-1", "1e3", "", "12, 13", "0x10"])
def test_a_length_that_is_none_is_refused(client: TestClient, length: str) -> None:
    headers = [("host", HOST), BEARER, ("content-length", length)]
    assert asked(client, "/api/study/read", headers, "POST", b"{}")[0] == 413


def test_a_record_goes_to_disk_as_it_comes(server: Any, client: TestClient) -> None:
    """The pieces of a body are on disk before the next one is asked for."""
    sizes: list[int] = []

    async def pieces() -> Any:
        for _ in range(20):
            yield b"x" * 1000
            await asyncio.sleep(0.0)
            files = list(server.records.root.rglob("*.csv"))
            sizes.append(sum(path.stat().st_size for path in files))

    assert client.portal is not None
    number = client.portal.call(server.records.take, "big.csv", pieces())
    assert server.records.get(number).stat().st_size == 20_000
    assert max(sizes[:-1]) > 0
    server.records.forget(number)


MARKUP = [
    "<script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    "\"'><svg/onload=1>",
    "=1+1",
    "{{7*7}}",
    "${7*7}",
    "__import__('os')",
    "\u202e",
]


@pytest.mark.parametrize("markup", MARKUP)
def test_markup_in_names_is_text(client: TestClient, markup: str) -> None:
    """Names with markup come back as they are, in JSON that a browser takes for nothing else, or are refused."""
    answer = client.post(
        "/api/panel/indices",
        json={"study": {**DOCUMENT, "title": markup}, "designs": [{"layout": "S1", "name": markup}]},
    )
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.json()["designs"][0]["name"] == markup
    body = {"panel": "indices", "request": {"study": DOCUMENT, "designs": [{"layout": "S1", "name": markup}]}}
    table = client.post("/api/export/csv", json=body)
    assert table.status_code == 200
    assert not table.text.splitlines()[1].lstrip('"').startswith(("=", "+", "-", "@"))
    spoilt = {**DOCUMENT, "layouts": {**DOCUMENT["layouts"], markup: "k | c"}}
    assert ask(client, "study/check", study=spoilt)["problems"]
    spoilt = {**DOCUMENT, "elements": {**DOCUMENT["elements"], markup: "1 kg"}}
    assert ask(client, "study/check", study=spoilt)["problems"]


@pytest.mark.parametrize("path", ["/", "/api/about", "/api/nothing", "/nothing"])
def test_every_answer_keeps_the_page_to_itself(client: TestClient, path: str) -> None:
    headers = client.get(path).headers
    policy = headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "http" not in policy.replace("https", "http").split("frame-src")[0]
    assert "frame-ancestors 'none'" in policy
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"] == "no-store"
    assert "set-cookie" not in headers
    assert "access-control-allow-origin" not in headers
