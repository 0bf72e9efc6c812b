"""Possible causes of a misfit, in the model of the device or its sensors, by name, and their sentences."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Any

from inerter.formatting import format_alike, format_number, format_quantity, format_share
from inerter.records.remedy import Action, Remedy, Text

Details = Mapping[str, Any]


class Suspect(StrEnum):
    """Name of a possible cause."""

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
    HIGH_PASSED_FORCE = "high-pass filtered force"
    HIGH_PASSED_DISPLACEMENT = "high-pass filtered displacement"
    END_STOP = "end stop"
    IN_MOTION = "motion before the record"
    HUM = "hum"
    CHANGED_DEVICE = "changed device"
    SPIKES = "spikes"
    HELD = "held values"
    SLOWER = "channel at a lower rate"
    JOINED = "joined pieces"
    BEYOND_BOUNDS = "value beyond the bounds"

    def sentence(self, details: Details) -> str:
        """The cause in words, for use after a colon."""
        return _SENTENCES[self](details)

    def remedy(self, details: Details) -> Text:
        """The remedy in words."""
        return _REMEDIES[self](details)


def _delay_text(d: Details) -> str:
    late = "force" if d["delay"] > 0.0 else "displacement"
    return f"the {late} is delayed by {format_quantity(abs(d['delay']), 's', 3)}"


def _corner_frequency_text(d: Details) -> str:
    return "any frequency" if d["time"] <= 0.0 else format_quantity(0.5 / math.pi / d["time"], "Hz")


def _dropped_samples_text(d: Details) -> str:
    records = (
        ", ".join(f"{count} at {format_quantity(at, 's')}" for count, at in places[:4])
        + (", ..." if len(places) > 4 else "")
        for places in d["places"]
    )
    return f"samples were dropped without a gap in the time channel ({'; '.join(records)})"


def _filtered_force_text(d: Details) -> str:
    if "unstated" in d:
        return f"the load cell, whose bandwidth is not stated, filters the force at {_corner_frequency_text(d)}"
    return f"the force was low-pass filtered at {_corner_frequency_text(d)}"


def _stribeck_text(d: Details) -> str:
    at_rest, beyond = format_alike([d["at_rest"], d["beyond"]], "N", 3)
    speed = format_quantity(d["speed"], "m/s", 2)
    return f"friction falls with speed (Stribeck), from {at_rest} at rest to {beyond} beyond {speed}"


def _offset_text(d: Details) -> str:
    size = format_quantity(abs(d["offset"]), "N")
    return f"the load cell has an offset of {size}, or friction is larger in one direction by as much"


def _asymmetric_text(d: Details) -> str:
    up, down = format_alike([d["up"], d["down"]], "N", 3)
    return f"friction is {up} in one direction and {down} in the other"


def _places_text(d: Details) -> str:
    times = ", ".join(format_number(t, 4) for t in d["times"]) + (", ..." if d["count"] > len(d["times"]) else "")
    return f"{d['count']} {'place' if d['count'] == 1 else 'places'}, at {times} s"


def _clock_text(d: Details) -> str:
    way = "later" if d["growth"] > 0.0 else "earlier"
    return (
        f"the clocks of force and displacement differ by {format_number(1e6 * abs(d['rate']), 3)} ppm, so that the "
        f"force is {format_quantity(abs(d['growth']), 's', 3)} {way} at the end than at the start"
    )


def _high_pass_text(d: Details) -> str:
    return format_quantity(0.5 * d["rate"] / math.pi, "Hz", 2)


def _end_stop_text(d: Details) -> str:
    stiffness, reach = format_quantity(d["stiffness"], "N/m", 2), format_quantity(d["reach"], "m", 2)
    ends = f"{d['ends'][0]} end" if len(d["ends"]) == 1 else "ends"
    return f"an end stop of {stiffness} is touched within {reach} of the {ends} of the motion"


def _hum_text(d: Details) -> str:
    return (
        f"the force contains hum of {format_quantity(d['amplitude'], 'N', 3)} at "
        f"{format_quantity(d['frequency'], 'Hz')}, or at an alias of it such as "
        f"{format_quantity(d['rate'] - d['frequency'], 'Hz')}"
    )


def _saturation_text(d: Details) -> str:
    upper, lower = format_alike([d["upper"], d["lower"]], "N", 3)
    return f"the force is clipped above {upper} and below -{lower} (load cell or amplifier saturated)"


def _changed_device_text(d: Details) -> str:
    values = ", ".join(
        f"{name} {' before and '.join(format_alike([before, after], unit, 3))} after"
        for name, unit, before, after in d["values"]
    )
    return f"the device changes at {format_quantity(d['time'], 's')}" + (f": {values}" if values else "")


def _cross_talk_text(d: Details) -> str:
    return f"the load cell picks up {format_quantity(d['size'], d['unit'], 3)} of the {d['signal']}"


def _beyond_bounds_text(d: Details) -> str:
    values = (
        f"{name} is {'larger' if larger else 'smaller'} than {format_quantity(bound, unit, 3)}, a bound of the search"
        for name, unit, bound, larger in d["values"]
    )
    return " and ".join(values)


def _second_gap_text(d: Details) -> str:
    slack, more = format_quantity(d["slack"], "m", 2), format_quantity(d["stiffness"], "N/m", 2)
    return f"a second gap closes in the shaft at a deflection of {slack}, beyond which it is stiffer by {more}"


def _slower_channels_text(d: Details) -> str:
    return " and ".join(
        f"the {role} was measured at one sample in {every} only, and {way} in between"
        for role, every, way in d["channels"]
    )


def _always(said: str) -> Callable[[Details], str]:
    return lambda details: said


_SENTENCES: Mapping[Suspect, Callable[[Details], str]] = {
    Suspect.GAIN: _always("the gain of the load cell is not one"),
    Suspect.DELAY: _delay_text,
    Suspect.FILTERED_DISPLACEMENT: lambda d: f"the displacement was low-pass filtered at {_corner_frequency_text(d)}",
    Suspect.FILTERED_FORCE: _filtered_force_text,
    Suspect.DRIFT: lambda d: f"the zero of the load cell drifts, by {format_quantity(d['drift'], 'N', 2)}",
    Suspect.FIXTURE_MASS: lambda d: (
        f"a fixture mass of {format_quantity(d['mass'], 'kg')} between load cell and device"
    ),
    Suspect.OFFSET: _offset_text,
    Suspect.LOST_SAMPLES: _dropped_samples_text,
    Suspect.DRY_FRICTION: _always("the device has dry friction"),
    Suspect.VISCOUS_FRICTION: _always("friction grows with speed"),
    Suspect.ELASTIC: _always("the device is compliant"),
    Suspect.RIGID: _always("the device is rigid"),
    Suspect.BACKLASH: _always("the device has backlash"),
    Suspect.STRIBECK: _stribeck_text,
    Suspect.BY_POSITION: lambda d: (
        f"friction depends on the position, by {format_quantity(d['range'], 'N', 3)} over the stroke"
    ),
    Suspect.ASYMMETRIC: _asymmetric_text,
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
        f"the shaft {'stiffens' if d['share'] > 0.0 else 'softens'} under load, by {format_share(abs(d['share']), 2)} "
        f"at the largest force"
    ),
    Suspect.SECOND_GAP: _second_gap_text,
    Suspect.SATURATION: _saturation_text,
    Suspect.CLOCK_DRIFT: _clock_text,
    Suspect.CROSS_TALK: _cross_talk_text,
    Suspect.FRAME: lambda d: (
        f"the frame of the load cell resonates at {format_quantity(d['frequency'], 'Hz', 3)} (damping ratio "
        f"{format_number(d['ratio'], 2)})"
    ),
    Suspect.HIGH_PASSED_FORCE: lambda d: (
        f"the force was high-pass filtered at {_high_pass_text(d)}, as by a piezoelectric load cell or AC coupling"
    ),
    Suspect.HIGH_PASSED_DISPLACEMENT: lambda d: (
        f"the displacement was high-pass filtered at {_high_pass_text(d)}, as by AC coupling or integration of an "
        f"acceleration"
    ),
    Suspect.END_STOP: _end_stop_text,
    Suspect.IN_MOTION: _always("the device already moved when the record began, although the table was nearly at rest"),
    Suspect.HUM: _hum_text,
    Suspect.CHANGED_DEVICE: _changed_device_text,
    Suspect.SPIKES: lambda d: f"spikes replace samples at {_places_text(d)}",
    Suspect.HELD: lambda d: f"the recorder held values at {_places_text(d)}",
    Suspect.SLOWER: _slower_channels_text,
    Suspect.JOINED: lambda d: f"the record is joined from pieces of different runs at {_places_text(d)}",
    Suspect.BEYOND_BOUNDS: _beyond_bounds_text,
}


def _model_remedy(details: Details) -> Text:
    return (f"use a model such as {details['layout']} ({details['model']})",)


def _law_remedy(details: Details) -> Text:
    return ("no model includes this law; use the values under this hypothesis, where available",)


def _constant(*text: str | Remedy) -> Callable[[Details], Text]:
    return lambda details: text


_REMEDIES: Mapping[Suspect, Callable[[Details], Text]] = {
    Suspect.GAIN: _constant(),
    Suspect.DELAY: _constant("estimate the delay too, with ", Remedy(Action.FIT_DELAY)),
    Suspect.FILTERED_DISPLACEMENT: _constant("use the unfiltered displacement, or filter the force in the same way"),
    Suspect.FILTERED_FORCE: _constant(
        "state the bandwidth of the load cell and its amplifier, ", Remedy(Action.FORCE_BANDWIDTH)
    ),
    Suspect.DRIFT: _constant("warm the load cell up, or remove the drift, ", Remedy(Action.DETREND)),
    Suspect.FIXTURE_MASS: _constant(
        "weigh the fixture between load cell and device, and state its mass, ", Remedy(Action.FIXTURE_MASS)
    ),
    Suspect.OFFSET: _constant("estimate the offset too, with ", Remedy(Action.FIT_OFFSET)),
    Suspect.LOST_SAMPLES: _constant("read the file with ", Remedy(Action.GAPS, "fill"), ", which interpolates them"),
    Suspect.DRY_FRICTION: _model_remedy,
    Suspect.VISCOUS_FRICTION: _model_remedy,
    Suspect.ELASTIC: _model_remedy,
    Suspect.RIGID: _model_remedy,
    Suspect.BACKLASH: _model_remedy,
    Suspect.STRIBECK: _law_remedy,
    Suspect.BY_POSITION: _law_remedy,
    Suspect.ASYMMETRIC: _law_remedy,
    Suspect.RIPPLE: _law_remedy,
    Suspect.PRESLIDING: _law_remedy,
    Suspect.QUADRATIC: _constant("estimate it too, with ", Remedy(Action.FIT_QUADRATIC)),
    Suspect.STIFFENING: _law_remedy,
    Suspect.SECOND_GAP: _law_remedy,
    Suspect.SATURATION: _constant("reduce the motion, or state the range of the load cell to exclude such samples"),
    Suspect.CLOCK_DRIFT: _constant("sample both channels with one clock"),
    Suspect.CROSS_TALK: _constant("separate the cables of the sensors, and read the load cell without the device"),
    Suspect.FRAME: _constant("stiffen the frame, or excite well below its resonance"),
    Suspect.HIGH_PASSED_FORCE: _constant(
        "measure static forces too (DC coupling, a longer time constant), or move well above that frequency"
    ),
    Suspect.HIGH_PASSED_DISPLACEMENT: _constant("measure the displacement down to standstill, or move well above it"),
    Suspect.IN_MOTION: _constant("begin the record at rest, or discard its first samples (lead)"),
    Suspect.END_STOP: _constant("move less, or farther from the end of the stroke"),
    Suspect.HUM: _constant("check grounding and shielding, and use an anti-aliasing filter"),
    Suspect.CHANGED_DEVICE: _constant("fit the parts before and after as separate records, ", Remedy(Action.TRIM)),
    Suspect.SPIKES: _constant("check cables and connectors, or interpolate those samples, ", Remedy(Action.REPAIR)),
    Suspect.HELD: _constant("interpolate those samples, ", Remedy(Action.REPAIR)),
    Suspect.SLOWER: _constant(
        "record both channels at one rate, or keep the measured samples alone, ", Remedy(Action.REPAIR)
    ),
    Suspect.JOINED: _constant("fit each piece as a separate record, ", Remedy(Action.TRIM)),
    Suspect.BEYOND_BOUNDS: _constant("give the value wider bounds in the elements of the model"),
}
