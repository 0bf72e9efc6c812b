"""The kinds of signals that a simulation file can ask for: one row each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from pydantic import PlainValidator

from inerter.files.common.entries import one_of, positive, quantity, text, whole, yes_or_no
from inerter.rows import Rows
from inerter.signals.harmonics import cosine, flat_multisine, multisine, sine
from inerter.signals.records import held_noise, profile, recorded
from inerter.signals.signal import Signal
from inerter.signals.tables import HOLDS
from inerter.signals.transients import bump, chirp, step
from inerter.vehicle.registry import VEHICLES

NEEDED: Any = ...
UNITS = ("m", "N", "N m")  # of what a signal can be
_SQUARES = {"m": "m^2", "N": "N^2", "N m": "N^2 m^2"}
_SIZES = {"m": "1 mm", "N": "100 N", "N m": "100 N m"}


class Key(NamedTuple):
    """A key of [signal]. In `unit` and `example`, {unit}, {square} and {size} stand for those of the input."""

    unit: str  # empty for what has none
    check: Callable[[str], PlainValidator]  # given the unit
    example: str
    default: Any = NEEDED

    def of(self, unit: str) -> Key:
        """The same key of a signal in `unit`."""
        words = {"unit": unit, "square": _SQUARES[unit], "size": _SIZES[unit]}
        return self._replace(unit=self.unit.format(**words), example=self.example.format(**words))


def _plain(check: Callable[[Any], Any]) -> Callable[[str], PlainValidator]:
    return lambda unit: PlainValidator(check)


def _size(name: str) -> Key:
    return Key("{unit}", quantity, f'{name} = "{{size}}"')


def _frequency(name: str, value: str, default: Any = NEEDED) -> Key:
    return Key("Hz", positive, f'{name} = "{value} Hz"', default)


_SEED = Key("", lambda unit: whole(0, 2**63 - 1), "seed = 0", 0)
_FILE = Key("", _plain(text), 'file = "road.csv"')
_WAVE = {
    "amplitude": _size("amplitude"),
    "frequency": _frequency("frequency", "3"),
    "phase": Key("rad", quantity, 'phase = "90 deg"', 0.0),
}


@dataclass(frozen=True)
class SignalKind:
    """How one kind is made: `make` takes the keys of [signal] and `given`, some of `road`, `speed` and `unit`."""

    key: str
    make: Callable[..., Signal]
    keys: Mapping[str, Key]
    given: tuple[str, ...] = ("speed",)
    needs: tuple[str, ...] = ()  # keys of [road]
    of_roads: bool = False  # a force cannot be of this kind


_OWN = (
    SignalKind(
        "multisine",
        multisine,
        {"seed": _SEED, "lowest": _frequency("lowest", "0.1", 0.1), "highest": _frequency("highest", "1000", 1000.0)},
        given=("road",),
        needs=("speed", "roughness"),
        of_roads=True,
    ),
    SignalKind(
        "flat-multisine",
        flat_multisine,
        {
            "seed": _SEED,
            "rms": Key("{unit}", positive, 'rms = "{size}"'),
            "lowest": _frequency("lowest", "0.1"),
            "highest": _frequency("highest", "20"),
        },
    ),
    SignalKind("sine", sine, _WAVE),
    SignalKind("cosine", cosine, _WAVE),
    SignalKind(
        "chirp",
        chirp,
        {
            "amplitude": _size("amplitude"),
            "lowest": _frequency("lowest", "0.5"),
            "highest": _frequency("highest", "20"),
            "duration": Key("s", positive, 'duration = "10 s"'),
        },
    ),
    SignalKind("step", step, {"height": _size("height"), "time": Key("s", quantity, 'time = "1 s"', 0.0)}),
    SignalKind(
        "bump",
        bump,
        {
            "height": _size("height"),
            "length": Key("m", positive, 'length = "1 m"'),
            "start": Key("s", quantity, 'start = "0.5 s"', 0.0),
        },
        needs=("speed",),
        of_roads=True,
    ),
    SignalKind(
        "held-noise",
        held_noise,
        {
            "seed": _SEED,
            "power": Key("{square}/Hz", positive, 'power = "1e-8 {square}/Hz"'),
            "interval": Key("s", positive, 'interval = "1 ms"', 1e-3),
            "duration": Key("s", positive, 'duration = "100 s"', 100.0),
        },
    ),
    SignalKind(
        "sampled",
        lambda file, **others: recorded(path=file, **others),
        {
            "file": _FILE,
            "hold": Key("", _plain(one_of("a hold", HOLDS)), 'hold = "cubic"', "cubic"),
            "periodic": Key("", _plain(yes_or_no), "periodic = true", False),
        },
        given=("speed", "unit"),
    ),
    SignalKind(
        "profile", lambda file, speed: profile(path=file, speed=speed), {"file": _FILE}, needs=("speed",), of_roads=True
    ),
)
SIGNALS: Rows[SignalKind] = Rows("kind of signal", "key", ("make", "keys"), _OWN)


def unit_of(name: object) -> str:
    """The unit of an input by its name."""
    return {force: unit for kind in VEHICLES.values() for force, unit in kind.forces.items()}.get(str(name), "m")
