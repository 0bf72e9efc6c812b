"""Available vehicles, indices, methods and examples, taken from the registries."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any

import inerter
from inerter.app.kinds import KINDS
from inerter.app.panels import PANELS
from inerter.exports.registry import EXPORTS
from inerter.field_metadata import Field, fields_of, mounts_of
from inerter.files.common.free_networks import FREE_NETWORK, new_free_network
from inerter.files.common.roads import ROAD_QUANTITIES
from inerter.files.common.signal_kinds import SIGNALS
from inerter.files.identification.running import FIT
from inerter.files.identification.sections import CHOOSE, CHOOSE_WORDS
from inerter.files.simulation.running import RESOLVED as RESOLVED_SIMULATION
from inerter.files.study import KIND
from inerter.files.study.chosen_design import WITHOUT_CONDITIONS
from inerter.files.study.limits import SENSES
from inerter.files.study.running import RESOLVED as RESOLVED_STUDY
from inerter.formatting import capital, in_words, typeset_unit, unit_choices
from inerter.identification.models import MODELS, model_words
from inerter.indices.names import index_words
from inerter.indices.registry import INDICES, index_choices
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import METHODS, averages, method_settings, searches, words_of
from inerter.networks.elements import Element
from inerter.networks.elements.registry import ELEMENTS
from inerter.records.readers import FORMATS
from inerter.signals.road import ROAD_CLASSES
from inerter.vehicle.registry import VEHICLES

_FOLDERS = ("app/examples", "../../examples")  # in the package, and beside its sources


def about() -> dict[str, Any]:
    """Rows of every kind, each with what a page needs to show it."""
    return {
        "version": inerter.__version__,
        "elements": [_element(kind) for kind in ELEMENTS.values()],
        "indices": [_index(symbol) for symbol in INDICES],
        "methods": [_method(name) for name in METHODS],
        "vehicles": [
            {
                "key": key,
                "fields": _fields(fields_of(kind)),
                "mounts": list(mounts_of(kind)),
                "moved": kind.moved,
                "forces": dict(kind.forces),
                "outline": kind.outline,
                "is_rig": kind.moved not in ("road", *kind.forces),
            }
            for key, kind in VEHICLES.items()
        ],
        "road": _fields(ROAD_QUANTITIES),
        "named_values": {
            field.unit: {
                name: f"{round(1e6 * one.mean)}e-6 m^3"
                for one in ROAD_CLASSES.values()
                for name in (one.letter, one.words)
                if name
            }
            for field in ROAD_QUANTITIES
            if field.key == "roughness"
        },
        "units": {
            unit: [
                {"least": least, "most": most, "factor": scale.factor, "unit": typeset_unit(scale.unit)}
                for least, most, scale in choices
            ]
            for unit, choices in unit_choices().items()
        },
        "free_networks": [
            {"key": one.name, **schema}
            for one in FREE_NETWORK.keys
            if (schema := one.schema()).get("type") in ("integer", "boolean")
        ],
        "new_free_network": new_free_network(),
        "signals": [_signal(key) for key in SIGNALS],
        "conventions": list(CONVENTIONS),
        "limit_sides": [{"key": side, "words": in_words(side)} for side in SENSES],
        "panels": [{"key": panel.key, "title": panel.title} for panel in PANELS.values()],
        "work": [
            {name: getattr(kind, name) for name in ("key", "title", "keys", "resumes", "description", "lacking")}
            for kind in KINDS.values()
        ],
        "exports": [
            {"key": key, **{name: getattr(kind, name) for name in ("description", "suffixes", "requires", "takes")}}
            for key, kind in EXPORTS.items()
            if kind.is_file
        ],
        "export_note": f"{capital(WITHOUT_CONDITIONS)}.",
        "models": [
            {"key": CHOOSE, "title": "all models", "words": CHOOSE_WORDS},
            *({"key": name, "title": name, "words": model_words(name)} for name in MODELS),
        ],
        "record_suffixes": list(FORMATS),
        "result_sources": [RESOLVED_STUDY, RESOLVED_SIMULATION, FIT],
        "examples": list(examples()),
    }


@lru_cache(1)
def examples() -> dict[str, Path]:
    """The study files that come with the package, by their names."""
    here = Path(__file__).parents[1]
    folder = next((here / place for place in _FOLDERS if (here / place).is_dir()), here / _FOLDERS[0])
    found = {path.stem: path for path in sorted(folder.glob("*.toml"))}
    return {name: path for name, path in found.items() if set(KIND.sections) <= set(tables(path))}


def tables(path: Path) -> dict[str, Any]:
    """The tables of a file that comes with the package."""
    return tomllib.loads(path.read_text(encoding="utf-8"))


def _element(kind: type[Element]) -> dict[str, Any]:
    said = ("key", "symbol", "quantity", "unit", "sentence", "example", "may_vanish", "tried", "unit_note")
    return {
        **{name: getattr(kind, name) for name in said},
        "more": _fields(kind.more),
        "linear": kind.linear.name.lower(),
        "switches": kind.switch is not None,
        "states": list(kind.switch.states.values()) if kind.switch else [],
        "drawing": [[list(point) for point in line] for line in kind.drawing],
    }


def _index(symbol: str) -> dict[str, Any]:
    kind = INDICES[symbol]
    return {
        "symbol": symbol,
        **{name: text for name in ("title", "unit", "response") if isinstance(text := getattr(kind, name), str)},
        "words": index_words()[symbol],
        "settings": _fields(fields_of(kind)),
        "choices": [dataclasses.asdict(one) for one in index_choices(symbol) if one.options],
    }


def _method(name: str) -> dict[str, Any]:
    kind: Any = METHODS[name]
    return {
        "name": name,
        "title": f"{kind.nonlinearity_support.words} ({name.replace('-', ' ')})",
        "words": words_of(name),
        "sees": kind.nonlinearity_support.name.lower(),
        "searches": searches(name),
        "averages": averages(name),
        "settings": _fields(method_settings(name)),
    }


def _signal(key: str) -> dict[str, Any]:
    kind = SIGNALS[key]
    keys = [{"key": name, "unit": told.unit, "example": told.example} for name, told in kind.keys.items()]
    return {"key": key, "keys": keys, "of_roads": kind.of_roads}


def _fields(fields: Iterable[Field]) -> list[dict[str, Any]]:
    return [dataclasses.asdict(field) for field in fields]
