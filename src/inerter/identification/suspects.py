"""What may be wrong with a device's model or its sensors, by name, and how each is said with its numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Any

from inerter.records.remedy import Action, Remedy, Text
from inerter.units import format_quantity

Details = Mapping[str, Any]


class Suspect(StrEnum):
    """The name of a hypothesis."""

    GAIN = "gain"
    DELAY = "delay"
    FILTERED_DISPLACEMENT = "filtered displacement"
    FILTERED_FORCE = "filtered force"
    DRIFT = "drift"
    FIXTURE_MASS = "fixture mass"
    OFFSET = "offset or asymmetric friction"
    LOST_SAMPLES = "lost samples"
    DRY_FRICTION = "dry friction"
    VISCOUS_FRICTION = "viscous friction"
    ELASTIC = "elastic device"
    RIGID = "rigid device"
    BACKLASH = "backlash"
    STRIBECK = "Stribeck friction"
    BY_POSITION = "friction by position"
    ASYMMETRIC = "asymmetric friction"
    RIPPLE = "friction ripple"
    PRESLIDING = "presliding"
    QUADRATIC = "quadratic damping"
    STIFFENING = "stiffening shaft"
    SECOND_GAP = "second gap"
    SATURATION = "saturation"
    CLOCK_DRIFT = "clock drift"
    CROSS_TALK = "cross-talk"
    FRAME = "frame resonance"
    HUM = "hum"
    CHANGED_DEVICE = "changed device"
    SPIKES = "spikes"
    HELD = "held values"
    JOINED = "joined pieces"

    def sentence(self, details: Details) -> str:
        """What it says of the device or its sensors, to go on after a colon."""
        return _SENTENCES[self](details)

    def remedy(self, details: Details) -> Text:
        """What would put it right."""
        return _REMEDIES[self](details)


def _delay(d: Details) -> str:
    return f"the {'force' if d['delay'] > 0.0 else 'displacement'} is late by {1e3 * abs(d['delay']):.3g} ms"


def _corner(d: Details) -> str:
    return "any size" if d["time"] <= 0.0 else format_quantity(0.5 / math.pi / d["time"], "Hz")


def _lost(d: Details) -> str:
    records = (
        ", ".join(f"{count} at {at:.4g} s" for count, at in places[:4]) + (", ..." if len(places) > 4 else "")
        for places in d["places"]
    )
    return f"samples are lost while the clock goes on ({'; '.join(records)})"


def _stribeck(d: Details) -> str:
    return (
        f"friction falls with speed (Stribeck), from {format_quantity(d['at_rest'], 'N', 3)} at rest to "
        f"{format_quantity(d['beyond'], 'N', 3)} beyond {format_quantity(d['speed'], 'm/s', 2)}"
    )


def _offset(d: Details) -> str:
    size = format_quantity(abs(d["offset"]), "N")
    return f"the load cell has an offset of {size}, or friction is larger in one direction by as much"


def _asymmetric(d: Details) -> str:
    up, down = (format_quantity(d[way], "N", 3) for way in ("up", "down"))
    return f"friction is {up} in one direction and {down} in the other"


def _at(d: Details) -> str:
    times = ", ".join(f"{t:.4g}" for t in d["times"]) + (", ..." if d["count"] > len(d["times"]) else "")
    return f"{d['count']} {'place' if d['count'] == 1 else 'places'}, at {times} s"


def _clock(d: Details) -> str:
    way = "later" if d["growth"] > 0.0 else "earlier"
    return (
        f"the clocks of force and displacement differ by {1e6 * abs(d['rate']):.3g} ppm, so that the force comes "
        f"{1e3 * abs(d['growth']):.3g} ms {way} at the end than at the start"
    )


def _hum(d: Details) -> str:
    return (
        f"the force contains hum of {format_quantity(d['amplitude'], 'N', 3)} at {d['frequency']:.4g} Hz, or at an "
        f"alias of it such as {d['rate'] - d['frequency']:.4g} Hz"
    )


def _saturation(d: Details) -> str:
    upper, lower = (format_quantity(d[end], "N", 3) for end in ("upper", "lower"))
    return f"the force is cut off above {upper} and below -{lower} (load cell or amplifier saturated)"


def _changed(d: Details) -> str:
    values = ", ".join(
        f"{name} {format_quantity(before, unit, 3)} before and {format_quantity(after, unit, 3)} after"
        for name, unit, before, after in d["values"]
    )
    return f"the device changes at {d['time']:.4g} s" + (f": {values}" if values else "")


def _cross_talk(d: Details) -> str:
    return f"the load cell picks up {format_quantity(d['size'], d['unit'], 3)} of the {d['signal']}"


def _second_gap(d: Details) -> str:
    slack, more = format_quantity(d["slack"], "m", 2), format_quantity(d["stiffness"], "N/m", 2)
    return f"a second gap closes in the shaft at a deflection of {slack}, beyond which it is stiffer by {more}"


def _always(said: str) -> Callable[[Details], str]:
    return lambda details: said


_SENTENCES: Mapping[Suspect, Callable[[Details], str]] = {
    Suspect.GAIN: _always("the gain of the load cell is not one"),
    Suspect.DELAY: _delay,
    Suspect.FILTERED_DISPLACEMENT: lambda d: f"the displacement went through a low pass of {_corner(d)}",
    Suspect.FILTERED_FORCE: lambda d: f"the force went through a low pass of {_corner(d)}",
    Suspect.DRIFT: lambda d: f"the zero of the load cell drifts, by {format_quantity(d['drift'], 'N', 2)}",
    Suspect.FIXTURE_MASS: lambda d: (
        f"{format_quantity(d['mass'], 'kg')} move with the table between load cell and device"
    ),
    Suspect.OFFSET: _offset,
    Suspect.LOST_SAMPLES: _lost,
    Suspect.DRY_FRICTION: _always("the device has dry friction"),
    Suspect.VISCOUS_FRICTION: _always("friction grows with speed"),
    Suspect.ELASTIC: _always("the device gives way"),
    Suspect.RIGID: _always("nothing in the device gives way"),
    Suspect.BACKLASH: _always("the device has backlash"),
    Suspect.STRIBECK: _stribeck,
    Suspect.BY_POSITION: lambda d: (
        f"friction depends on the position, by {format_quantity(d['range'], 'N', 3)} over the stroke"
    ),
    Suspect.ASYMMETRIC: _asymmetric,
    Suspect.RIPPLE: lambda d: (
        f"friction varies periodically along the stroke, by {format_quantity(d['size'], 'N', 2)} to either side every "
        f"{format_quantity(d['pitch'], 'm', 3)}"
    ),
    Suspect.PRESLIDING: lambda d: (
        f"friction builds up over {format_quantity(d['distance'], 'm', 2)} of travel after each reversal (presliding)"
    ),
    Suspect.QUADRATIC: lambda d: (
        f"a damping grows with the square of the speed, {format_quantity(d['most'], 'N', 2)} at the largest"
    ),
    Suspect.STIFFENING: lambda d: (
        f"the shaft {'stiffens' if d['share'] > 0.0 else 'softens'} under load, by {100.0 * abs(d['share']):.2g} % at "
        f"the largest force"
    ),
    Suspect.SECOND_GAP: _second_gap,
    Suspect.SATURATION: _saturation,
    Suspect.CLOCK_DRIFT: _clock,
    Suspect.CROSS_TALK: _cross_talk,
    Suspect.FRAME: lambda d: (
        f"the frame of the load cell resonates at {d['frequency']:.3g} Hz (damping ratio {d['ratio']:.2g})"
    ),
    Suspect.HUM: _hum,
    Suspect.CHANGED_DEVICE: _changed,
    Suspect.SPIKES: lambda d: f"spikes replace samples at {_at(d)}",
    Suspect.HELD: lambda d: f"the recorder held values at {_at(d)}",
    Suspect.JOINED: lambda d: f"the record is joined from pieces of different runs at {_at(d)}",
}


def _other(details: Details) -> Text:
    return (f"take a model such as {details['layout']} ({details['model']})",)


def _law(details: Details) -> Text:
    return ("no model has such friction; the values with it, where there are any, are the ones to go by",)


def _constant(*text: str | Remedy) -> Callable[[Details], Text]:
    return lambda details: text


_REMEDIES: Mapping[Suspect, Callable[[Details], Text]] = {
    Suspect.GAIN: _constant(),
    Suspect.DELAY: _constant("fit the delay too, with ", Remedy(Action.FIT_DELAY)),
    Suspect.FILTERED_DISPLACEMENT: _constant(
        "take the displacement before the filter, or make the filter of the force the same"
    ),
    Suspect.FILTERED_FORCE: _constant(
        "give the bandwidth of the load cell and its amplifier, ", Remedy(Action.FORCE_BANDWIDTH)
    ),
    Suspect.DRIFT: _constant("warm the load cell up, or take the drift away, ", Remedy(Action.DETREND)),
    Suspect.FIXTURE_MASS: _constant(
        "weigh what moves with the table between load cell and device, and give it, ", Remedy(Action.FIXTURE_MASS)
    ),
    Suspect.OFFSET: _constant("fit the offset too, with ", Remedy(Action.FIT_OFFSET)),
    Suspect.LOST_SAMPLES: _constant("read the file with ", Remedy(Action.GAPS, "fill"), ", which puts them in"),
    Suspect.DRY_FRICTION: _other,
    Suspect.VISCOUS_FRICTION: _other,
    Suspect.ELASTIC: _other,
    Suspect.RIGID: _other,
    Suspect.BACKLASH: _other,
    Suspect.STRIBECK: _law,
    Suspect.BY_POSITION: _law,
    Suspect.ASYMMETRIC: _law,
    Suspect.RIPPLE: _law,
    Suspect.PRESLIDING: _law,
    Suspect.QUADRATIC: _law,
    Suspect.STIFFENING: _law,
    Suspect.SECOND_GAP: _law,
    Suspect.SATURATION: _constant("move less, or give the range of the load cell so that such samples are left out"),
    Suspect.CLOCK_DRIFT: _constant("sample both channels by one clock"),
    Suspect.CROSS_TALK: _constant("separate the cables of the sensors, and read the load cell without the device"),
    Suspect.FRAME: _constant("stiffen the frame, or excite well below its resonance"),
    Suspect.HUM: _constant("check grounding and shielding, and filter against aliasing before sampling"),
    Suspect.CHANGED_DEVICE: _constant("fit the parts before and after as separate records, ", Remedy(Action.TRIM)),
    Suspect.SPIKES: _constant("check cables and connectors, or interpolate those samples, ", Remedy(Action.REPAIR)),
    Suspect.HELD: _constant("interpolate those samples, ", Remedy(Action.REPAIR)),
    Suspect.JOINED: _constant("fit each piece as a record of its own, ", Remedy(Action.TRIM)),
}
