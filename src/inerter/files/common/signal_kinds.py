"""Kinds of signals available in simulation files, one registry entry each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from inerter.errors import RecordError, RegistryError, SignalError
from inerter.files.common import profiles
from inerter.files.common.codec import REQUIRED, Codec, Scalar
from inerter.files.common.entries import TEXT, YES_OR_NO, any_quantity, positive, whole, word
from inerter.registry import Registry, cache_until_registration
from inerter.signals.harmonics import cosine, flat_multisine, random_road, sine
from inerter.signals.records import held_noise, read_signal
from inerter.signals.signal import Signal
from inerter.signals.tables import HOLDS
from inerter.signals.transients import bump, chirp, step
from inerter.vehicle.mechanism import GROUND_ACCELERATION, TRACKS
from inerter.vehicle.registry import VEHICLES

BOTH = "both"  # tracks of a profile, each under its own wheels
UNITS = ("m", "N", "N m", "m/s^2")  # of what a signal can be
_SQUARES = {"m": "m^2", "N": "N^2", "N m": "N^2 m^2", "m/s^2": "(m/s^2)^2"}
_SIZES = {"m": "1 mm", "N": "100 N", "N m": "100 N m", "m/s^2": "1 m/s^2"}


class SignalKey(NamedTuple):
    """A key of [signal]. In `unit` and `example`, {unit}, {square} and {size} stand for those of the input.

    >>> import inerter as it
    >>> it.SIGNALS["chirp"].keys["duration"].unit
    's'
    """

    unit: str  # empty for what has none
    example: str
    default: Any = REQUIRED
    codec: Callable[[str], Codec] = positive  # given the unit: what a value may be
    sentence: str = ""

    def of(self, unit: str) -> SignalKey:
        """Key of a signal in `unit`, with the placeholders of its unit and example replaced."""
        words = {"unit": unit, "square": _SQUARES[unit], "size": _SIZES[unit]}
        return self._replace(unit=self.unit.format(**words), example=self.example.format(**words))


def _plain(codec: Codec) -> Callable[[str], Codec]:
    return lambda unit: codec


def _size(name: str, sentence: str) -> SignalKey:
    return SignalKey("{unit}", f'{name} = "{{size}}"', codec=any_quantity, sentence=sentence)


def _lowest(value: str, default: Any = REQUIRED) -> SignalKey:
    return SignalKey("Hz", f'lowest = "{value} Hz"', default, sentence="Lowest frequency.")


def _highest(value: str, default: Any = REQUIRED) -> SignalKey:
    return SignalKey("Hz", f'highest = "{value} Hz"', default, sentence="Highest frequency.")


def _escape_braces(example: str) -> str:
    """Example with its braces doubled, so that formatting keeps them."""
    return example.replace("{", "{{").replace("}", "}}")


_SEED = SignalKey("", "seed = 0", 0, _plain(whole(0, 2**63 - 1)), "Seed of the random numbers.")
_FILE = SignalKey("", 'file = "road.csv"', codec=_plain(TEXT), sentence="File of the samples.")
_AMPLITUDE = _size("amplitude", "Amplitude.")
_HEIGHT = _size("height", "Height.")
_WAVE = {
    "amplitude": _AMPLITUDE,
    "frequency": SignalKey("Hz", 'frequency = "3 Hz"', sentence="Frequency."),
    "phase": SignalKey("rad", 'phase = "90 deg"', 0.0, any_quantity, "Phase at time zero."),
}


@dataclass(frozen=True)
class SignalKind:
    """Kind of signal: `make` takes the keys of [signal] and `given`, some of `road`, `speed` and `unit`.

    It returns a signal, or one for the left and one for the right track.

    >>> import inerter as it
    >>> sorted(it.SIGNALS["step"].keys)
    ['height', 'time']
    """

    key: str
    make: Callable[..., Signal | Mapping[str, Signal]]
    keys: Mapping[str, SignalKey]
    given: tuple[str, ...] = ("speed",)
    needs: tuple[str, ...] = ()  # keys of [road]
    of_roads: bool = False  # a force cannot be of this kind
    random: bool = False  # a road with the coherence that [road] says


def _measured_road(file: str, track: str, speed: float, **reading: Any) -> Signal | Mapping[str, Signal]:
    try:
        measured = profiles.read(file, **reading)
    except RecordError as problem:
        raise SignalError(str(problem)) from None
    if track != BOTH:
        return measured.to_signal(speed, track)
    found = measured.signals(speed)
    if isinstance(found, Signal):
        raise SignalError(f"{Path(file).name} has one track; leave the track out, or give a profile of two.")
    return found


_OWN = (
    SignalKind(
        "multisine",
        random_road,
        {"seed": _SEED, "lowest": _lowest("0.1", 0.1), "highest": _highest("1000", 1000.0)},
        given=("road",),
        needs=("speed", "roughness"),
        of_roads=True,
        random=True,
    ),
    SignalKind(
        "flat-multisine",
        flat_multisine,
        {
            "seed": _SEED,
            "rms": SignalKey("{unit}", 'rms = "{size}"', sentence="R.m.s. value of the whole signal."),
            "lowest": _lowest("0.1"),
            "highest": _highest("20"),
        },
    ),
    SignalKind("sine", sine, _WAVE),
    SignalKind("cosine", cosine, _WAVE),
    SignalKind(
        "chirp",
        chirp,
        {
            "amplitude": _AMPLITUDE,
            "lowest": _lowest("0.5"),
            "highest": _highest("20"),
            "duration": SignalKey("s", 'duration = "10 s"', sentence="Time from the lowest to the highest frequency."),
        },
    ),
    SignalKind(
        "step",
        step,
        {"height": _HEIGHT, "time": SignalKey("s", 'time = "1 s"', 0.0, any_quantity, "Time of the step.")},
    ),
    SignalKind(
        "bump",
        bump,
        {
            "height": _HEIGHT,
            "length": SignalKey("m", 'length = "1 m"', sentence="Length of the bump."),
            "start": SignalKey("s", 'start = "0.5 s"', 0.0, any_quantity, "Time at which the bump begins."),
        },
        needs=("speed",),
        of_roads=True,
    ),
    SignalKind(
        "held-noise",
        held_noise,
        {
            "seed": _SEED,
            "power": SignalKey(
                "{square}/Hz", 'power = "1e-8 {square}/Hz"', sentence="Two-sided density at low frequencies."
            ),
            "interval": SignalKey("s", 'interval = "1 ms"', 1e-3, sentence="Time for which each sample is held."),
            "duration": SignalKey("s", 'duration = "100 s"', 100.0, sentence="Period after which the signal repeats."),
        },
    ),
    SignalKind(
        "sampled",
        lambda file, **others: read_signal(path=file, **others),
        {
            "file": _FILE,
            "hold": SignalKey(
                "", 'hold = "cubic"', "cubic", _plain(word("a hold", HOLDS)), "Interpolation between samples."
            ),
            "periodic": SignalKey("", "periodic = true", False, _plain(YES_OR_NO), "Whether the samples repeat."),
        },
        given=("speed", "unit"),
    ),
    SignalKind(
        "profile",
        _measured_road,
        {
            "file": _FILE,
            "track": SignalKey(
                "", 'track = "left"', "", _plain(word("a side", (*TRACKS, BOTH))), "Track of a profile with two tracks."
            ),
            "columns": SignalKey(
                "",
                _escape_braces(profiles.COLUMNS_EXAMPLE),
                None,
                _plain(Scalar(profiles.columns, lambda: profiles.COLUMNS_SCHEMA)),
                "Columns of a profile, by name or number from 0, if they are not recognised.",
            ),
            "units": SignalKey(
                "",
                _escape_braces(profiles.UNITS_EXAMPLE),
                None,
                _plain(Scalar(profiles.units, lambda: profiles.UNITS_SCHEMA)),
                "Units of a profile whose table has none.",
            ),
            "interval": SignalKey(
                "m",
                profiles.SPACING_EXAMPLE,
                None,
                sentence="Distance between rows of a profile without a distance column.",
            ),
        },
        needs=("speed",),
        of_roads=True,
    ),
)
SIGNALS: Registry[SignalKind] = Registry("kind of signal", "key", ("make", "keys"), _OWN)


def unit_of(name: object) -> str:
    """The unit of an input by its name."""
    return _force_units().get(str(name), "m")


@cache_until_registration
def _force_units() -> dict[str, str]:
    """Raises `RegistryError` if a force has two units, or one that no signal has."""
    found = {GROUND_ACCELERATION: "m/s^2"}
    for kind in VEHICLES.values():
        for force, unit in kind.forces.items():
            if unit not in UNITS:
                raise RegistryError(
                    f"{kind.__name__} has a force {force!r} in {unit}; a signal is in {', '.join(UNITS)}."
                )
            if found.setdefault(force, unit) != unit:
                raise RegistryError(f"{kind.__name__} has {force!r} in {unit}, and another vehicle in {found[force]}.")
    return found
