"""The application: routes made of the requests that there are, the files of the page, and what answers errors."""

from __future__ import annotations

import re
from asyncio import to_thread
from collections.abc import AsyncIterator, Awaitable, Callable
from concurrent.futures import Executor
from contextlib import asynccontextmanager
from inspect import iscoroutinefunction
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from inerter.app.api_description import Endpoint
from inerter.app.guard import AccessGuard, App
from inerter.app.requests import ENDPOINTS
from inerter.app.responses import as_json, media_type
from inerter.app.server import Server
from inerter.app.start import InitialStudy
from inerter.app.wire import Refusal, decode_json, encode_json, refusal_of
from inerter.errors import InerterError

WEB = Path(__file__).with_name("web")


def of_file(
    file: tuple[str, str, Path | None] | None,
    root: Path,
    quick: Executor,
    token: str,
    port: int,
    limits: tuple[int, int],
) -> App:
    """The application that begins with a study (name, text, file), if any; `root` is where it keeps its things."""
    return application(
        Server(root, InitialStudy.of(*file) if file else InitialStudy(), quick=quick), token, port, *limits
    )


def application(server: Server, token: str, port: int, limit: int, record_limit: int) -> App:
    """The application that a server of the web runs."""

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        async with server.running():
            yield

    routes = [Route(e.path, _make_route(server, e), methods=[e.verb]) for e in ENDPOINTS]
    routes.append(Route("/{path:path}", _page, methods=["GET"]))
    handlers: dict[Any, Any] = {Refusal: _refusal_response, 404: _unknown, 405: _unknown, Exception: _fault}
    app = Starlette(routes=routes, lifespan=lifespan, exception_handlers=handlers)
    return AccessGuard(app, token, port, limit, record_limit)


def _make_route(server: Server, endpoint: Endpoint) -> Callable[[Request], Awaitable[Response]]:
    async def route(request: Request) -> Response:
        try:
            given = () if endpoint.body is None else (_validate_body(endpoint.body, decode_json(await request.body())),)
            if iscoroutinefunction(endpoint.handler):
                found = await endpoint.handler(server, request, *given)
            else:
                found = await to_thread(endpoint.handler, server, request, *given)
        except ClientDisconnect:
            return Response(status_code=400)
        except InerterError as error:
            raise refusal_of(error) from None
        return found if isinstance(found, Response) else as_json(encode_json(found))

    return route


async def _page(request: Request) -> Response:
    """A file of the page, which holds nothing that is not in the package."""
    path = request.path_params["path"] or "index.html"
    if path.startswith("api/") or path == "api" or path not in _files():
        raise Refusal(404, "Page not found.")
    return FileResponse(_files()[path], media_type=media_type(path))


def _files() -> dict[str, Path]:
    return {path.relative_to(WEB).as_posix(): path for path in WEB.rglob("*") if path.is_file()}


async def _refusal_response(request: Request, refused: Refusal) -> Response:
    return as_json(encode_json(refused.body), refused.status)


async def _unknown(request: Request, error: Any) -> Response:
    return as_json(
        encode_json({"sentence": "Unknown request; /api/openapi.json describes all requests."}),
        error.status_code,
    )


async def _fault(request: Request, error: Exception) -> Response:
    where = re.sub(r"\s+", " ", f"{type(error).__name__}: {error}")[:300]
    return as_json(encode_json({"sentence": f"This is a fault of the program ({where}). Nothing else is lost."}), 500)


def _validate_body(shape: type[BaseModel], body: Any) -> BaseModel:
    try:
        return shape.model_validate(body)
    except ValidationError as error:
        problems = [
            {"place": [str(key) for key in detail["loc"]], "sentence": _sentence(detail)} for detail in error.errors()
        ]
        raise Refusal(400, str(problems[0]["sentence"]), problems=problems) from None


def _sentence(detail: Any) -> str:
    place = ".".join(str(key) for key in detail["loc"]) or "the body"
    said = str(detail["msg"])
    return f"{place}: {said[:1].lower()}{said[1:]}."
