"""Answers and errors as they go over the wire."""

from __future__ import annotations

import json
from typing import Any

from inerter.app.documents import problems_of
from inerter.errors import InerterError, WorkError
from inerter.formatting import printed_text
from inerter.report.json_data import json_data

# keys of sentences and lists of them
_SENTENCES = ("sentence", "short", "status", "reason", "remedy", "findings", "residual")


class Refusal(Exception):  # noqa: N818 -- an answer, not a fault
    """A request that is refused, with the status of the answer and a sentence."""

    def __init__(self, status: int, /, sentence: str, **more: Any) -> None:
        super().__init__(status, sentence, more)
        self.status, self.body = status, {"sentence": sentence, **more}


def encode_json(data: Any) -> bytes:
    """Data as JSON: nan is null, infinity is text, arrays are lists."""
    return json.dumps(json_data(data), ensure_ascii=False, allow_nan=False).encode("utf-8", "backslashreplace")


def typeset_sentences(answer: Any, key: str = "") -> Any:
    r"""Answer with its sentences in printed form.

    >>> typeset_sentences({"sentence": "below 3 um", "unit": "um"})
    {'sentence': 'below 3\xa0µm', 'unit': 'um'}
    """
    if isinstance(answer, dict):
        return {name: typeset_sentences(one, name) for name, one in answer.items()}
    if isinstance(answer, list | tuple):
        return [typeset_sentences(one, key) for one in answer]
    return printed_text(answer) if key in _SENTENCES and isinstance(answer, str) else answer


def decode_json(text: bytes) -> Any:
    """Data from JSON; raises `Refusal` where it is none."""
    try:
        return json.loads(text, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        raise Refusal(400, f"The body is not JSON ({_shortly(error)}).") from None


def refusal_of(error: Exception) -> Refusal:
    """Refusal of a request for an exception of the library, with its problems."""
    if isinstance(error, WorkError):
        return Refusal(500, str(error))
    if isinstance(error, InerterError):
        return Refusal(400, str(error), problems=problems_of(error))
    return Refusal(400, f"This cannot be computed ({_shortly(error)}).", problems=[])


def _no_number(text: str) -> Any:
    raise ValueError(f"{text} is not a JSON number")


def _shortly(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:200]
