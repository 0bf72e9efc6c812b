"""Parts of a study document, finished or not, that a page draws and edits: networks, elements and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from inerter.app.parts import parse_network
from inerter.app.wire import Refusal
from inerter.files.common.free_networks import is_free_network
from inerter.files.common.problem import EntryError
from inerter.files.study.drafts import Draft, WrittenNumber, rename_elements

Document = Mapping[str, Any]


def parts_of_document(document: Document) -> dict[str, Any]:
    """Networks as trees, elements of layouts, kinds of elements, and numbers with their keys in the document."""
    draft = Draft(document)
    given = document.get("elements")
    entries = given if isinstance(given, Mapping) else {}
    known = list(entries)
    kinds = {name: element.key for name, element in draft.elements.items()}
    free_networks = {name for name, entry in entries.items() if is_free_network(entry)}
    return {
        "networks": [
            {"path": list(keys), "text": text, **parse_network(text, None), **parse_network(text, known)}
            for keys, text in draft.networks.items()
        ],
        "layouts": {
            name: {
                "elements": own,
                "free": draft.free[name],
                "free_networks": [element for element in own if element in free_networks],
            }
            for name, own in draft.layouts.items()
        },
        "elements": {
            name: {
                "kind": kinds.get(name),
                "layouts": [layout for layout, used in draft.elements_by_layout.items() if name in used],
            }
            for name in known
        },
        "numbers": [_number(number) for number in draft.numbers],
    }


def _number(written: WrittenNumber) -> dict[str, Any]:
    number = written.number
    return {
        "path": list(written.keys),
        "place": written.place.label,
        "words": number.words,
        "sentence": written.sentence,
        "unit": number.unit,
        "value": number.value if isinstance(number.value, int | float) else None,
        "may_be_free": number.may_be_free,
        "name": written.name,
    }


def renamed_document(document: Document, names: Mapping[str, str]) -> dict[str, Any]:
    """The document with other names of elements."""
    try:
        return {"study": rename_elements(document, names)}
    except EntryError as error:
        raise Refusal(400, str(error)) from None
