"""Access control: requests from this machine, under its own name, with the token, and of limited size."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import dataclass
from secrets import compare_digest
from typing import Any

from inerter.app.wire import Refusal, encode_json

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

HOSTS = ("127.0.0.1", "localhost")
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; font-src 'self'; "
    "connect-src 'self'; frame-src blob:; manifest-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
_HEADERS = {
    "content-security-policy": _POLICY,
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-store",
}


@dataclass(frozen=True)
class AccessGuard:
    """Lets requests through to `app` that come from this machine's page or from a script with the token."""

    app: App
    token: str
    port: int
    limit: int  # bytes of a body
    record_limit: int  # of a record, which goes to disk

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        headers = [(name.lower(), value) for name, value in scope["headers"]]
        try:
            self._check(scope, headers)
            limit = self.record_limit if scope["path"] == "/api/records" else self.limit
            await self.app(scope, _limit_body(receive, headers, limit), _with_headers(send))
        except Refusal as refused:
            await refuse(refused, send)

    def _check(self, scope: Scope, headers: list[tuple[bytes, bytes]]) -> None:
        allowed = {f"{host}:{self.port}" for host in HOSTS}
        hosts = [value.decode("latin-1").lower() for name, value in headers if name == b"host"]
        if len(hosts) != 1 or hosts[0] not in allowed:
            raise Refusal(403, "This server accepts requests to 127.0.0.1 only.")
        origins = [value.decode("latin-1").lower() for name, value in headers if name == b"origin"]
        if any(origin not in {f"http://{host}" for host in allowed} for origin in origins):
            raise Refusal(403, "This server accepts requests from its own page only.")
        sites = [value for name, value in headers if name == b"sec-fetch-site"]
        if scope["path"].startswith("/api") and any(site not in (b"same-origin", b"none") for site in sites):
            raise Refusal(403, "This server accepts requests from its own page only.")
        if scope["path"].startswith("/api") and not self._knows(headers):
            raise Refusal(401, "The token is missing or wrong. Open the link that the server has printed.")

    def _knows(self, headers: list[tuple[bytes, bytes]]) -> bool:
        given = [value for name, value in headers if name == b"authorization"]
        return len(given) == 1 and compare_digest(given[0], f"Bearer {self.token}".encode())


async def refuse(refused: Refusal, send: Send) -> None:
    """Answer with a refusal."""
    body = encode_json(refused.body)
    headers = [(b"content-type", b"application/json"), (b"content-length", str(len(body)).encode())]
    if refused.status in (401, 413):
        headers.append((b"connection", b"close"))
    await _with_headers(send)({"type": "http.response.start", "status": refused.status, "headers": headers})
    await send({"type": "http.response.body", "body": body})


def _limit_body(receive: Receive, headers: list[tuple[bytes, bytes]], limit: int) -> Receive:
    """The body of a request, refused if it says that it is larger than the limit, or turns out to be."""
    told = [value for name, value in headers if name == b"content-length"]
    too_large = Refusal(413, f"The body is larger than {limit} bytes, the limit of this server.")
    if any(not value.isdigit() or int(value) > limit for value in told):
        raise too_large
    seen = 0

    async def read() -> MutableMapping[str, Any]:
        nonlocal seen
        message = await receive()
        seen += len(message.get("body", b""))
        if seen > limit:
            raise too_large
        return message

    return read


def _with_headers(send: Send) -> Send:
    async def send_with_headers(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            given = {name.lower() for name, _ in message["headers"]}
            more = [(k.encode(), v.encode()) for k, v in _HEADERS.items() if k.encode() not in given]
            message = {**message, "headers": [*message["headers"], *more]}
        await send(message)

    return send_with_headers
