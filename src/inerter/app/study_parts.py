"""Parts of a study document, finished or not, that a page draws and edits: networks, elements and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from typing import Any

from inerter.app.parts import parse_network
from inerter.app.wire import Refusal
from inerter.files.common.free_networks import is_free_network
from inerter.files.common.problem import EntryError
from inerter.files.study.drafts import Draft, WrittenNumber, rename_elements
from inerter.networks.elements.roles import LinearRole
from inerter.networks.parser import replace_in_expression

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


def struts_with_device(document: Document, network: str, device: Document) -> dict[str, Any]:
    """Struts that a device joins: in place of its first inerter, else in parallel, and in series with its first damper.

    Of the last two either may be the better. Elements of the device get new names where the document has others of
    theirs. Raises `Refusal` for a device without a network, or with elements that cannot be renamed.
    """
    known = Draft(document).elements
    given, entries = document.get("elements"), device.get("elements")
    given, entries = (table if isinstance(table, Mapping) else {} for table in (given, entries))
    taken = {*given, *entries}
    names: dict[str, str] = {}
    for name in entries:
        if name in given and given[name] != entries[name]:
            names[name] = next(f"{name}{i}" for i in count(2) if f"{name}{i}" not in taken)
            taken.add(names[name])
    renamed = renamed_document(device, names)["study"]
    own = renamed["elements"] if entries else {}
    joined = next((text for text in Draft(renamed).networks.values() if "tree" in parse_network(text, own)), None)
    if joined is None:
        raise Refusal(400, "There is no device that could be taken: it has no network.")
    inside = [name for name in parse_network(network, None).get("names", ()) if name in known]
    first = {known[name].linear: name for name in reversed(inside)}
    inerter, damper = first.get(LinearRole.MASS), first.get(LinearRole.DAMPING)
    if inerter is not None:
        struts = [(f"in place of {inerter}", replace_in_expression(network, {inerter: joined}))]
    else:
        struts = [("in parallel", f"{network} | {joined}" if network.strip() else joined)]
        if damper is not None:
            in_series = replace_in_expression(network, {damper: f"{damper} - ({joined})"})
            struts.append((f"in series with {damper}", in_series))
    return {"elements": own, "struts": [{"words": words, "network": text} for words, text in struts]}


def renamed_document(document: Document, names: Mapping[str, str]) -> dict[str, Any]:
    """The document with other names of elements."""
    try:
        return {"study": rename_elements(document, names)}
    except EntryError as error:
        raise Refusal(400, str(error)) from None
