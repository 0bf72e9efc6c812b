"""The section [signal] of a file: its shape for every kind of signal, and the signal that it asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, PlainValidator, create_model

from inerter.files.common.entries import one_of, text
from inerter.files.common.shape import ANY, one_of_shapes
from inerter.files.common.signal_kinds import BOTH, NEEDED, SIGNALS, UNITS, unit_of
from inerter.files.common.tables import Shape, Shapes
from inerter.files.common.vehicle_shapes import Driving
from inerter.rows import made_of_rows
from inerter.signals.coherence import Coherence
from inerter.signals.road import Road
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
        """Of the signal: m, N or N m."""
        return self.force_unit or unit_of(self.input)

    @property
    def units(self) -> dict[str, str]:
        """Of the values; empty for what has none."""
        return {name: key.of(self.unit).unit for name, key in SIGNALS[self.kind].keys.items()}

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The files that it is read from."""
        return (Path(self.values["file"]),) if "file" in self.values else ()

    @property
    def on_tracks(self) -> bool:
        """Whether its file is to give a signal for each track."""
        return self.values.get("track") == BOTH

    def make(self) -> Signal:
        """The signal of what has no road; raises as `tracks` does."""
        return self.tracks()[""]

    def tracks(
        self, speed: float | None = None, roughness: float | None = None, coherence: Coherence | None = None
    ) -> dict[str, Signal]:
        """The signal of each track, "left" and "right"; of a single one by the name "".

        Raises `SignalError` if its values do not go together, or its file cannot be read.
        """
        kind = SIGNALS[self.kind]
        road = None if speed is None or roughness is None else Road(roughness, speed, coherence)
        known = {"road": road, "speed": speed, "unit": self.unit}
        found = kind.make(**self.values, **{name: known[name] for name in kind.given})
        return {"": found} if isinstance(found, Signal) else dict(found)

    def resolved(self) -> dict[str, Any]:
        """How a file says it, in SI units."""
        units = self.units
        values = {
            name: f"{v!r} {units[name]}" if units[name] else v for name, v in self.values.items() if v is not None
        }
        return {"kind": self.kind, "input": self.input, **values}


def signal_of(path: Path, inputs: Mapping[str, str], entry: dict[str, Any]) -> SignalRequest:
    """The signal that a section [signal] asks for; its file is looked for beside that at `path`.

    `inputs` are what it may move, with the unit of each; it moves the first if nothing else is said.
    """
    values = dict(entry)
    kind, moved = values.pop("kind"), values.pop("input") or next(iter(inputs), "road")
    if "file" in values:
        values["file"] = str((path.parent / values["file"]).absolute())
    unit = inputs.get(moved)
    return SignalRequest(kind, moved, values, None if unit == unit_of(moved) else unit)


class AnySignal(Shape):
    """A signal whose kind is missing or unknown: nothing more can be said about its keys."""

    model_config = ConfigDict(extra="ignore")
    kind: Annotated[str, PlainValidator(one_of("a kind of signal", SIGNALS))] = Field(examples=['kind = "multisine"'])


@made_of_rows
def signal_shapes() -> tuple[Any, Shapes]:
    """The section [signal] of any kind in any unit, and its shapes by place."""
    made = {f"<{kind} in {unit}>": _signal_shape(kind, unit) for kind in SIGNALS for unit in UNITS}
    shapes: dict[str, type[Shape]] = {ANY: AnySignal, **made}
    return one_of_shapes(shapes, _signal_tag), {("signal", tag): shape for tag, shape in shapes.items()}


def _signal_shape(kind: str, unit: str) -> type[Shape]:
    keys = {name: key.of(unit) for name, key in SIGNALS[kind].keys.items()}
    fields: dict[str, Any] = {
        name: (Annotated[Any, key.check(key.unit)], Field(default=key.default, examples=[key.example]))
        for name, key in keys.items()
    }
    fields["kind"] = (Literal[kind], NEEDED)
    fields["input"] = (Annotated[str | None, PlainValidator(text)], None)
    return create_model(f"{kind} in {unit}", __base__=Shape, **fields)


def _signal_tag(signal: Any) -> str:
    kind = signal.get("kind") if isinstance(signal, dict) else None
    if not isinstance(kind, str) or kind not in SIGNALS:
        return ANY
    moved = signal.get("input")
    own = signal.units.get(moved) if isinstance(signal, Driving) and isinstance(moved, str | None) else None
    return f"<{kind} in {own or unit_of(moved)}>"
