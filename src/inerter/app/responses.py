"""Answers as responses of the web."""

from __future__ import annotations

import mimetypes
from collections.abc import AsyncIterator
from pathlib import Path

from starlette.responses import Response, StreamingResponse

_KNOWN = {".js": "text/javascript", ".mjs": "text/javascript", ".toml": "text/plain", ".nc": "application/x-netcdf"}


def media_type(name: str) -> str:
    """The type of a file by the end of its name."""
    suffix = Path(name).suffix
    return _KNOWN.get(suffix) or mimetypes.types_map.get(suffix, "application/octet-stream")


def as_json(body: bytes, status: int = 200) -> Response:
    """A text of JSON."""
    return Response(body, status, media_type="application/json")


def as_events(events: AsyncIterator[bytes]) -> Response:
    """Server-sent events."""
    return StreamingResponse(events, media_type="text/event-stream")
