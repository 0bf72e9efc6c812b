"""Section [signal] of a file: keys of every kind of signal, and the resulting signal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from inerter.files.common.codec import Codec, Declaration, KeyPath, LoadContext, TableCodec, section
from inerter.files.common.codecs import TaggedCodec, any_of
from inerter.files.common.entries import TEXT, one_of
from inerter.files.common.roads import road_of
from inerter.files.common.signal_kinds import BOTH, SIGNALS, UNITS, unit_of
from inerter.files.common.vehicle_tables import units_of_inputs
from inerter.signals.signal import Signal


@dataclass(frozen=True)
class SignalRequest:
    """A signal by its kind, what it moves, and the values of the kind's keys."""

    kind: str
    input: str
    values: dict[str, Any]
    force_unit: str | None = None  # where the vehicle names the force itself

    @property
    def unit(self) -> str:
        """Unit of the signal: m, N or N m."""
        return self.force_unit or unit_of(self.input)

    @property
    def units(self) -> dict[str, str]:
        """SI unit of each key of the signal's kind; empty if dimensionless."""
        return {name: one.of(self.unit).unit for name, one in SIGNALS[self.kind].keys.items()}

    @property
    def inputs(self) -> tuple[Path, ...]:
        """File of the signal's samples, if it has one."""
        return (Path(self.values["file"]),) if "file" in self.values else ()

    @property
    def on_tracks(self) -> bool:
        """Whether the file of the signal must give one for each track."""
        return self.values.get("track") == BOTH

    def make(self) -> Signal:
        """Signal of an input that is not a road; raises as `tracks` does."""
        return self.tracks()[""]

    def tracks(self, values: Mapping[str, Any] | None = None) -> dict[str, Signal]:
        """The signal of each track, "left" and "right"; of a single one by the name "". `values` are of [road], by key.

        Raises `SignalError` if its values do not go together, or its file cannot be read.
        """
        kind, given = SIGNALS[self.kind], values or {}
        road = None if given.get("roughness") is None else road_of(given)
        known = {"road": road, "speed": given.get("speed"), "unit": self.unit}
        found = kind.make(**self.values, **{name: known[name] for name in kind.given})
        return {"": found} if isinstance(found, Signal) else dict(found)


def signal_of(path: Path, inputs: Mapping[str, str], entry: dict[str, Any]) -> SignalRequest:
    """Signal request of a section [signal]; relative file names are relative to the folder of `path`.

    `inputs` are what it may move, with the unit of each; it moves the first if nothing else is said.
    """
    values = dict(entry)
    kind, moved = values.pop("kind"), values.pop("input") or next(iter(inputs), "road")
    if "file" in values:
        values["file"] = str((path.parent / values["file"]).absolute())
    unit = inputs.get(moved)
    return SignalRequest(kind, moved, values, None if unit == unit_of(moved) else unit)


@dataclass(frozen=True)
class SignalCodec(Codec):
    """Section [signal], whose kind determines its keys, and whose input their units."""

    in_unit: Mapping[str, TaggedCodec]  # by the unit of what is moved

    def load(self, raw: Any, context: LoadContext) -> dict[str, Any]:
        """The kind, what is moved, and the values of the kind's keys."""
        moved = raw.get("input") if isinstance(raw, Mapping) else None
        known = units_of_inputs(context.tables.get("vehicle"))
        own = known.get(moved) if isinstance(moved, str | None) else None
        return self.in_unit[own or unit_of(moved)].load(raw, context)  # type: ignore[no-any-return]

    def dump(self, value: SignalRequest) -> dict[str, Any]:
        """The section, in SI units."""
        return self.in_unit[value.unit].dump({"kind": value.kind, "input": value.input, **value.values})

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of any kind in any unit."""
        return any_of([codec.schema() for codec in self.in_unit.values()])

    def table_codecs(self, place: KeyPath) -> Iterator[tuple[KeyPath, TableCodec]]:
        """The tables of all kinds in all units."""
        for codec in self.in_unit.values():
            yield from codec.table_codecs(place)


def signal_section(kind: str) -> Declaration:
    """The section [signal] with all kinds of signals; `kind` is that of an example."""
    return section(
        "signal",
        SignalCodec({unit: _in_unit(unit) for unit in UNITS}),
        "Signal of one input; its kind determines the other keys of this section.",
        f'a section [signal] with kind = "{kind}"',
    )


def _in_unit(unit: str) -> TaggedCodec:
    tables = {kind: _table(kind, unit) for kind in SIGNALS}
    return TaggedCodec(
        "kind", lambda: tables, one_of("a kind of signal", SIGNALS), lambda s: str(s["kind"]), "multisine"
    )


def _table(kind: str, unit: str) -> TableCodec:
    def make(**values: Any) -> dict[str, Any]:
        return {"kind": kind, **values}

    keys = {name: one.of(unit) for name, one in SIGNALS[kind].keys.items()}
    own = [section(name, one.codec(one.unit), one.sentence, one.example, one.default) for name, one in keys.items()]
    moved = section("input", TEXT, "Input that has the signal; default: road, displacement or force.", default=None)
    return TableCodec((*own, moved), make, tag=("kind", kind, "The kind of signal."))
