"""Examples of the package as a first screen shows them: each with the question that it answers, and its network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

from inerter.app.about import examples
from inerter.app.start import to_document
from inerter.app.study_parts import parts_of_document
from inerter.vehicle.registry import VEHICLES

Card = dict[str, Any]

_OF_SECTIONS = {  # of the file, or keys of its section `study`
    "sweep": "Where is it worth it?",
    "tolerance": "What if values scatter?",
    "budgets": "How much friction or backlash is allowable?",
    "trade_off": "What does one index cost the other?",
    "conditions": "What is best over all operating conditions?",
    "subject_to": "What is best within constraints?",
}
_OF_FREE_NETWORKS = "Which network is the best of all?"
_OWN_VEHICLE = {"mechanism": "Own vehicle, of masses and struts"}


@lru_cache(1)
def example_cards() -> dict[str, Any]:
    """Studies in the order of their questions, and the name of the one to begin with a vehicle."""
    found = [_card(name, to_document(path.name, path.read_text("utf-8"))["study"]) for name, path in examples().items()]
    found.sort(key=lambda card: (_place(card["question"]), not _is_plain(card)))
    asked: set[str] = set()
    for card in found:
        card["heading"] = card["title"] if card["question"] in asked else card["question"]
        asked.add(card["question"])
    models = {key: key.replace("-", " ").capitalize() for key, model in VEHICLES.items() if model.moved == "road"}
    beginnings = {title: _beginning(found, model) for model, title in (models | _OWN_VEHICLE).items()}
    return {
        "examples": found,
        "vehicles": [{"title": title, "name": name} for title, name in beginnings.items() if name is not None],
    }


def _card(name: str, study: Mapping[str, Any]) -> Card:
    parts = parts_of_document(study)
    is_free = any(layout["free_networks"] for layout in parts["layouts"].values())
    trees = [network for network in parts["networks"] if "tree" in network]
    title = study.get("title", name)
    return {
        "name": name,
        "title": title,
        "question": _OF_FREE_NETWORKS if is_free else _question(study) or title,
        "study": study,
        "tree": max(trees, key=lambda network: len(network["names"]), default={"tree": None})["tree"],
        "kinds": {element: one["kind"] for element, one in parts["elements"].items()},
        "is_free": is_free,
    }


def _question(study: Mapping[str, Any]) -> str:
    """Question of a study beyond its designs, else of its vehicle; empty where neither is listed."""
    keys = {*study, *study.get("study", {})}
    asked = (question for key, question in _OF_SECTIONS.items() if key in keys)
    model = VEHICLES.get(study["vehicle"].get("model"))
    return next(asked, model.question if model else "")


def _place(question: str) -> int:
    """Vehicles come first, then sections of a study, then other questions."""
    order = [*(model.question for model in VEHICLES.values() if model.question), *_OF_SECTIONS.values()]
    return order.index(question) if question in order else len(order)


def _is_plain(card: Card) -> bool:
    """Whether an example is that of its vehicle, and asks nothing else."""
    return bool(card["name"] == card["study"]["vehicle"].get("model"))


def _beginning(cards: Sequence[Card], model: str) -> str | None:
    """Name of the example of a vehicle: the plain one, else the shortest; None without one."""
    own = [card for card in cards if card["study"]["vehicle"].get("model") == model and not card["is_free"]]
    nearest = sorted(own, key=lambda card: (not _is_plain(card), len(str(card["study"]))))
    return str(nearest[0]["name"]) if nearest else None
