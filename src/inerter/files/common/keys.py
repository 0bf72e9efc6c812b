"""The keys of files, each with what the JSON Schema of its kind says of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from inerter.files.common.kinds import kinds
from inerter.files.common.schema import INSTEAD, UNIT, USUAL
from inerter.registry import cache_until_registration

ANY_NAME = "NAME"  # stands in a place for a name of the author's own
_DECIDES = ("model", "kind")  # keys whose value decides which others there are


@dataclass(frozen=True)
class Key:
    """A key, by the path to it with points between; empty or None is what it does not have."""

    place: str
    sentence: str = ""
    unit: str = ""
    words: tuple[str, ...] = ()  # all that it may be
    example: Any = None
    default: Any = None
    needed: bool = False
    instead: str = ""  # lines of other keys, one of which is needed in its place
    section: bool = False  # whether it holds other keys
    repeated: bool = False  # whether it is a section that may occur several times, [[place]]
    of: str = ""  # the model or kind that has it, where not all have
    files: tuple[str, ...] = ()  # kinds of files that have its section

    @property
    def name(self) -> str:
        """The last part of its place."""
        return self.place.rpartition(".")[2]

    @property
    def section_name(self) -> str:
        """The first part of its place."""
        return self.place.partition(".")[0]

    @property
    def other_units(self) -> tuple[str, ...]:
        """Units in common use, other than the key's own."""
        return tuple(unit for unit in USUAL.get(self.unit, ()) if unit != self.unit)


def keys_of(schema: Mapping[str, Any]) -> list[Key]:
    """Keys in a JSON Schema of a file that have a sentence, sections before their keys."""
    return [key for key in _below(schema, "") if key.sentence]


@cache_until_registration
def keys_of_files() -> tuple[Key, ...]:
    """Keys of all kinds of files; of a section that several have, those of the first, which is that of study files."""
    found: list[Key] = []
    every = {kind.plural: keys_of(kind.schema()) for kind in kinds()}
    for keys in every.values():
        known = {key.section_name for key in found}
        for key in keys:
            if key.section_name not in known:
                files = (
                    plural for plural, others in every.items() if any(one.place == key.section_name for one in others)
                )
                found.append(replace(key, files=tuple(files)))
    return tuple(found)


def below(keys: Iterable[Key], section: Key) -> list[Key]:
    """The keys that a section holds."""
    return [key for key in keys if key.place.startswith(f"{section.place}.")]


def find_keys(keys: Iterable[Key], wanted: str) -> list[Key]:
    """The keys that `wanted` may mean: a place, the end of one, or a place with a name of the author's own in it."""
    parts = wanted.strip().strip("[]").split(".")
    return _merge_equal_keys(key for key in keys if _ends(key, parts))


def _merge_equal_keys(keys: Iterable[Key]) -> list[Key]:
    """Keys of several models, or in several units, as one where they say the same."""
    alike: dict[tuple[str, ...], list[Key]] = {}
    for key in keys:
        alike.setdefault((key.place, key.sentence), []).append(key)
    return [
        replace(
            same[0],
            of=", ".join(dict.fromkeys(key.of for key in same if key.of)),
            unit=" or ".join(dict.fromkeys(key.unit for key in same if key.unit)),
            words=tuple(dict.fromkeys(word for key in same for word in key.words)),
        )
        for same in alike.values()
    ]


def _ends(key: Key, parts: list[str]) -> bool:
    own = key.place.split(".")[-len(parts) :]
    named = any(one != ANY_NAME for one in own)
    return len(own) == len(parts) and named and all(a in (ANY_NAME, b) for a, b in zip(own, parts, strict=True))


def _below(schema: Mapping[str, Any], place: str, of: str = "") -> Iterator[Key]:
    """The keys that a table has."""
    for one in _alternatives(schema):
        one = one.get("items", one)  # of a list of tables, those of each
        own, needed = _model_of_table(one) or of, one.get("required", ())
        for name, key in one.get("properties", {}).items():
            yield from _key(key, f"{place}.{name}" if place else name, name in needed, own)
        if isinstance(more := one.get("additionalProperties"), dict):
            yield from _key(more, f"{place}.{ANY_NAME}", False, own)


def _key(schema: Mapping[str, Any], place: str, needed: bool, of: str) -> Iterator[Key]:
    """Key of a schema, and the keys below it."""
    ways = list(_alternatives(schema))
    said = {**next((one for one in ways if "properties" not in one), {}), **schema}
    held = list(_below(schema, place, of))
    words = said.get("enum") or said.get("items", {}).get("enum") or ([said["const"]] if "const" in said else [])
    yield Key(
        place=place,
        sentence=said.get("description") or next((one["description"] for one in ways if "description" in one), ""),
        unit=said.get(UNIT, ""),
        words=tuple(words),
        example=next(iter(said.get("examples", ())), None),
        default=said.get("default"),
        needed=needed or INSTEAD in said,
        instead=said.get(INSTEAD, ""),
        section=bool(held),
        repeated=bool(held) and said.get("type") == "array",
        of=of,
    )
    yield from held


def _alternatives(schema: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Schemas that an entry may satisfy: the schema itself, or each of its `anyOf`."""
    if "anyOf" not in schema:
        yield schema
    for one in schema.get("anyOf", ()):
        yield from _alternatives(one)


def _model_of_table(schema: Mapping[str, Any]) -> str:
    """The model or kind that alone has this table."""
    decided = (schema.get("properties", {}).get(key, {}).get("const", "") for key in _DECIDES)
    return next(filter(None, decided), "")
