"""Functions called in worker processes of the server, by name, so that the server need not import their modules."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pkgutil import resolve_name
from typing import Any

from inerter.app.wire import encode_json, refusal_of


def load(*homes: str) -> None:
    """Import modules in a worker process, so that its first call is as fast as later ones."""
    for home in homes:
        first = getattr(import_module(home), "first", None)
        if first is not None:
            first()


def call(home: str, *args: Any) -> tuple[int, Any]:
    """Status and body of a call of the function named `home`: bytes, other data as JSON text, or a refusal."""
    return run_call(lambda: resolve_name(home)(*args))


def panel(home: str, key: str, body: dict[str, Any]) -> tuple[int, Any]:
    """Status and body of the answer of a panel, with the sequence number of its request."""
    sequence = body.get("sequence", 0)
    return run_call(lambda: {"sequence": sequence, **resolve_name(home)(key, body)})


def run_call(function: Callable[[], Any]) -> tuple[int, Any]:
    """Status and body of a call of `function`: bytes, other data as JSON text, or a refusal."""
    try:
        found = function()
    except Exception as error:
        refused = refusal_of(error)
        return refused.status, refused.body
    return 200, found if isinstance(found, bytes) else encode_json(found)
