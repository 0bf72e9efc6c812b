"""What is called in processes of the server: functions by their names, so that the server need not load them."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pkgutil import resolve_name
from typing import Any

from inerter.app.wire import encoded, refusal_of


def load(*homes: str) -> None:
    """Load modules, and have what is called first be as quick as what is called later."""
    for home in homes:
        first = getattr(import_module(home), "first", None)
        if first is not None:
            first()


def call(home: str, *args: Any) -> tuple[int, Any]:
    """What a function gives: bytes as they are, other data as text of JSON; or the status and body of a refusal."""
    return called(lambda: resolve_name(home)(*args))


def panel(home: str, key: str, body: dict[str, Any]) -> tuple[int, Any]:
    """The same of a panel, whose answer has the sequence of its request."""
    sequence = body.get("sequence", 0)
    return called(lambda: {"sequence": sequence, **resolve_name(home)(key, body)})


def called(function: Callable[[], Any]) -> tuple[int, Any]:
    """The same of a function that is there."""
    try:
        found = function()
    except Exception as error:
        refused = refusal_of(error)
        return refused.status, refused.body
    return 200, found if isinstance(found, bytes) else encoded(found)
