"""Requests of the interface as data, from which routes and their description are generated."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from inerter.work.origin import VERSION

_PROBLEM = {
    "type": "object",
    "properties": {
        "sentence": {"type": "string"},
        "outdated": {"type": "boolean"},
        "problems": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {
                    "place": {"type": "array", "items": {"type": "string"}},
                    **{key: {"type": "string"} for key in ("got", "fault", "expected", "hint", "sentence")},
                },
            },
        },
    },
    "required": ["sentence"],
}
_REFUSALS = {
    "400": "The request is wrong",
    "401": "The token is missing or wrong",
    "403": "Another host or origin",
    "404": "Not found",
    "409": "A newer request has come",
    "413": "The body is too large",
    "500": "The work failed",
}


@dataclass(frozen=True)
class Endpoint:
    """A request: its verb and path, what it is for, the shape of its body, what answers it, and as what."""

    verb: str
    path: str
    summary: str
    handler: Callable[..., Any]  # a coroutine function, or one that is called in a thread
    body: type[BaseModel] | None = None
    media: str = "application/json"
    accepts: str = "application/json"  # where the body has no shape of ours, its type
    query: tuple[str, ...] = ()


def openapi(endpoints: Iterable[Endpoint]) -> dict[str, Any]:
    """The description of the interface (OpenAPI 3.1)."""
    several = list(endpoints)
    bodies: list[Any] = [(body, "validation") for body in dict.fromkeys(e.body for e in several) if body is not None]
    _, schemas = models_json_schema(bodies, ref_template="#/components/schemas/{model}")
    paths: dict[str, dict[str, Any]] = {}
    for endpoint in several:
        paths.setdefault(endpoint.path.replace(":path", ""), {})[endpoint.verb.lower()] = _operation(endpoint)
    return {
        "openapi": "3.1.0",
        "info": {"title": "inerter workbench", "version": VERSION},
        "security": [{"token": []}],
        "paths": paths,
        "components": {
            "schemas": {**schemas.get("$defs", {}), "Refusal": _PROBLEM},
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}},
        },
    }


def _operation(endpoint: Endpoint) -> dict[str, Any]:
    answer = {"description": "The answer", "content": {endpoint.media: {}}}
    refused = {"application/json": {"schema": {"$ref": "#/components/schemas/Refusal"}}}
    names = [part.strip("{}").split(":")[0] for part in endpoint.path.split("/") if part.startswith("{")]
    parameters = [{"name": name, "in": "path", "required": True, "schema": {"type": "string"}} for name in names]
    parameters += [{"name": name, "in": "query", "schema": {"type": "string"}} for name in endpoint.query]
    operation: dict[str, Any] = {
        "summary": endpoint.summary,
        "parameters": parameters,
        "responses": {
            "200": answer,
            **{status: {"description": why, "content": refused} for status, why in _REFUSALS.items()},
        },
    }
    if endpoint.body is not None:
        schema = {"schema": {"$ref": f"#/components/schemas/{endpoint.body.__name__}"}}
        operation["requestBody"] = {"required": True, "content": {"application/json": schema}}
    elif endpoint.verb == "POST":
        operation["requestBody"] = {"required": True, "content": {endpoint.accepts: {}}}
    return operation
