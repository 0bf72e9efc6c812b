"""Possible causes of a misfit, in the model of the device or its sensors, by name, and their sentences."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Any, Self

from inerter.formatting import format_alike, format_number, format_quantity, format_share
from inerter.records.remedy import Action, Remedy, Text

Details = Mapping[str, Any]
_SHORT_AVERAGE = 0.1  # of a delay: an average over less is that delay alone


def _delay_text(d: Details) -> str:
    late = "force" if d["delay"] > 0.0 else "displacement"
    return f"the {late} is delayed by {format_quantity(abs(d['delay']), 's', 3)}"


def _averaged_force_text(d: Details) -> str:
    if d["time"] < _SHORT_AVERAGE * abs(d["delay"]):
        return _delay_text(d)
    late = f"{'late' if d['delay'] > 0.0 else 'early'} by {format_quantity(abs(d['delay']), 's', 3)}"
    return f"the force is a moving average over {format_quantity(d['time'], 's', 3)}, {late}"


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
    if "stated" in d:
        stated = "is not stated" if d["stated"] is None else f"is stated as {format_quantity(d['stated'], 'Hz', 3)}"
        return f"the load cell, whose bandwidth {stated}, filters the force at {_corner_frequency_text(d)}"
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


def _saturation_text(d: Details) -> str:
    limits = [(word, sign * d[key]) for word, key, sign in (("above", "upper", 1.0), ("below", "lower", -1.0))]
    known = [(word, limit) for word, limit in limits if math.isfinite(limit)]
    sizes = format_alike([limit for _, limit in known], "N", 3)
    where = " and ".join(f"{word} {size}" for (word, _), size in zip(known, sizes, strict=True))
    return f"the force is clipped {where} (load cell or amplifier saturated)"


def _changed_device_text(d: Details) -> str:
    values = ", ".join(
        f"{name} {' before and '.join(format_alike([before, after], unit, 3))} after"
        for name, unit, before, after in d["values"]
    )
    return f"the device changes at {format_quantity(d['time'], 's')}" + (f": {values}" if values else "")


def _beyond_bounds_text(d: Details) -> str:
    values = " and ".join(
        f"{name} is {'larger' if larger else 'smaller'} than {format_quantity(bound, unit, 3)}, a bound of the search"
        for name, unit, bound, larger in d["values"]
    )
    units = {name: unit for name, unit, _, _ in d["values"]}
    scaled = (
        f"{role} in {true} that was read in {read} (with {true} "
        + " and ".join(f"{name} is {format_quantity(v, units[name], 3)}" for name, v in within if name in units)
        + ")"
        for role, true, read, within in d["units"]
    )
    probable = " or ".join(f"a {text}" for text in scaled)
    return f"{values}, as of {probable}" if probable else values


def _beyond_bounds_remedy(d: Details) -> Text:
    units = [part for role, true, _, _ in d["units"] for part in (Remedy(Action.UNIT, (role, true)), " or ")]
    checked: Text = ("check the unit, ", *units[:-1], "; or ") if units else ()
    return (*checked, "give the value wider bounds in the elements of the model")


def _second_gap_text(d: Details) -> str:
    slack, more = format_quantity(d["slack"], "m", 2), format_quantity(d["stiffness"], "N/m", 2)
    return f"a second gap closes in the shaft at a deflection of {slack}, beyond which it is stiffer by {more}"


def _model_remedy(d: Details) -> str:
    return f"use a model such as {d['layout']} ({d['model']})"


_NOT_MODELLED = "no model includes this law; use the values under this hypothesis, where available"


class Suspect(StrEnum):
    """Name of a possible cause, with its sentence and its remedy: texts, or functions that format them."""

    _sentence: str | Callable[[Details], str]
    _remedy: str | Text | Callable[[Details], str | Text]

    def __new__(
        cls, key: str, sentence: str | Callable[[Details], str], remedy: str | Text | Callable[[Details], str | Text]
    ) -> Self:
        suspect = str.__new__(cls, key)
        suspect._value_, suspect._sentence, suspect._remedy = key, sentence, remedy
        return suspect

    GAIN = "gain", "the gain of the load cell is not one", ()
    ASYMMETRIC_GAIN = (
        "gain by direction",
        lambda d: (
            f"the gain of the load cell is {format_share(2.0 * abs(d['share']), 2)} "
            f"{'larger' if d['share'] > 0.0 else 'smaller'} in tension than in compression"
        ),
        "calibrate the load cell in both directions, and correct the force by that calibration",
    )
    NONLINEAR_GAIN = (
        "gain by load",
        lambda d: (
            f"the gain of the load cell {'increases' if d['share'] > 0.0 else 'decreases'} with the load, by "
            f"{format_share(abs(d['share']), 2)} at the largest force"
        ),
        "calibrate the load cell up to the largest force, and correct the force by that calibration",
    )
    DELAY = "delay", _delay_text, ("estimate the delay too, with ", Remedy(Action.FIT_DELAY))
    FILTERED_DISPLACEMENT = (
        "filtered displacement",
        lambda d: f"the displacement was low-pass filtered at {_corner_frequency_text(d)}",
        "use the unfiltered displacement, or filter the force in the same way",
    )
    FILTERED_FORCE = (
        "filtered force",
        _filtered_force_text,
        ("state the bandwidth of the load cell and its amplifier, ", Remedy(Action.FORCE_BANDWIDTH)),
    )
    AVERAGED_FORCE = (
        "averaged force",
        _averaged_force_text,
        "record the force without averaging and by the clock of the displacement, or remove a delay, "
        "shift_force(record, delay)",
    )
    DRIFT = (
        "drift",
        lambda d: f"the zero of the load cell drifts, by {format_quantity(d['drift'], 'N', 2)}",
        ("warm the load cell up, or remove the drift, ", Remedy(Action.DETREND)),
    )
    FIXTURE_MASS = (
        "fixture mass",
        lambda d: f"a fixture mass of {format_quantity(d['mass'], 'kg')} between load cell and device",
        ("weigh the fixture between load cell and device, and state its mass, ", Remedy(Action.FIXTURE_MASS)),
    )
    OFFSET = (
        "offset or asymmetric friction",
        _offset_text,
        ("estimate the offset too, with ", Remedy(Action.FIT_OFFSET)),
    )
    LOST_SAMPLES = (
        "lost samples",
        _dropped_samples_text,
        ("read the file with ", Remedy(Action.GAPS, "fill"), ", which interpolates them"),
    )
    DRY_FRICTION = "dry friction", "the device has dry friction", _model_remedy
    VISCOUS_FRICTION = "viscous friction", "friction grows with speed", _model_remedy
    ELASTIC = "elastic device", "the device is compliant", _model_remedy
    RIGID = "rigid device", "the device is rigid", _model_remedy
    BACKLASH = "backlash", "the device has backlash", _model_remedy
    STRIBECK = "Stribeck friction", _stribeck_text, _NOT_MODELLED
    BY_POSITION = (
        "friction by position",
        lambda d: f"friction depends on the position, by {format_quantity(d['range'], 'N', 3)} over the stroke",
        _NOT_MODELLED,
    )
    ASYMMETRIC = "asymmetric friction", _asymmetric_text, _NOT_MODELLED
    RIPPLE = (
        "friction ripple",
        lambda d: (
            f"friction varies periodically along the stroke, by {format_quantity(d['size'], 'N', 2)} to either side "
            f"every {format_quantity(d['pitch'], 'm', 3)}"
        ),
        _NOT_MODELLED,
    )
    PRESLIDING = (
        "presliding",
        lambda d: (
            f"friction builds up over {format_quantity(d['distance'], 'm', 2)} of travel after each reversal "
            f"(presliding)"
        ),
        _NOT_MODELLED,
    )
    QUADRATIC = (
        "quadratic damping",
        lambda d: f"a damping grows with the square of the speed, {format_quantity(d['most'], 'N', 2)} at the largest",
        ("estimate it too, with ", Remedy(Action.FIT_QUADRATIC)),
    )
    STIFFENING = (
        "stiffening shaft",
        lambda d: (
            f"the shaft {'stiffens' if d['share'] > 0.0 else 'softens'} under load, by "
            f"{format_share(abs(d['share']), 2)} at the largest force"
        ),
        _NOT_MODELLED,
    )
    SECOND_GAP = "second gap", _second_gap_text, _NOT_MODELLED
    SATURATION = (
        "saturation",
        _saturation_text,
        "reduce the motion, or state the range of the load cell to exclude such samples",
    )
    CLOCK_DRIFT = "clock drift", _clock_text, "sample both channels with one clock"
    CROSS_TALK = (
        "cross-talk",
        lambda d: f"the load cell picks up {format_quantity(d['size'], d['unit'], 3)} of the {d['signal']}",
        "separate the cables of the sensors, and read the load cell without the device",
    )
    FRAME = (
        "frame resonance",
        lambda d: (
            f"the frame of the load cell resonates at {format_quantity(d['frequency'], 'Hz', 3)} (damping ratio "
            f"{format_number(d['ratio'], 2)})"
        ),
        "stiffen the frame, or excite well below its resonance",
    )
    HIGH_PASSED_FORCE = (
        "high-pass filtered force",
        lambda d: (
            f"the force was high-pass filtered at {_high_pass_text(d)}, as by a piezoelectric load cell or AC coupling"
        ),
        "measure static forces too (DC coupling, a longer time constant), or move well above that frequency",
    )
    HIGH_PASSED_DISPLACEMENT = (
        "high-pass filtered displacement",
        lambda d: (
            f"the displacement was high-pass filtered at {_high_pass_text(d)}, as by AC coupling or integration of an "
            f"acceleration"
        ),
        "measure the displacement down to standstill, or move well above it",
    )
    END_STOP = "end stop", _end_stop_text, "move less, or farther from the end of the stroke"
    IN_MOTION = (
        "motion before the record",
        "the device already moved when the record began, although the table was nearly at rest",
        "begin the record at rest, or discard its first samples (lead)",
    )
    HUM = (
        "hum",
        lambda d: (
            f"the {d['channel']} contains hum of {format_quantity(d['amplitude'], d['unit'], 3)} at "
            f"{format_quantity(d['frequency'], 'Hz')}, or at an alias of it such as "
            f"{format_quantity(d['rate'] - d['frequency'], 'Hz')}"
        ),
        "check grounding and shielding, and use an anti-aliasing filter",
    )
    CHANGED_DEVICE = (
        "changed device",
        _changed_device_text,
        ("fit the parts before and after as separate records, ", Remedy(Action.TRIM)),
    )
    SPIKES = (
        "spikes",
        lambda d: f"spikes replace samples at {_places_text(d)}",
        ("check cables and connectors, or interpolate those samples, ", Remedy(Action.REPAIR)),
    )
    HELD = (
        "held values",
        lambda d: f"the recorder held values at {_places_text(d)}",
        ("interpolate those samples, ", Remedy(Action.REPAIR)),
    )
    SLOWER = (
        "channel at a lower rate",
        lambda d: " and ".join(
            f"the {role} was measured at one sample in {format_number(every, 4)} only, and {way} in between"
            for role, every, way in d["channels"]
        ),
        ("record both channels at one rate, or keep the measured samples alone, ", Remedy(Action.REPAIR)),
    )
    JOINED = (
        "joined pieces",
        lambda d: f"the record is joined from pieces of different runs at {_places_text(d)}",
        ("fit each piece as a separate record, ", Remedy(Action.TRIM)),
    )
    BEYOND_BOUNDS = (
        "value beyond the bounds",
        _beyond_bounds_text,
        _beyond_bounds_remedy,
    )

    def sentence(self, details: Details) -> str:
        """The cause in words, for use after a colon."""
        return self._sentence(details) if callable(self._sentence) else self._sentence

    def remedy(self, details: Details) -> Text:
        """The remedy in words."""
        remedy = self._remedy(details) if callable(self._remedy) else self._remedy
        return (remedy,) if isinstance(remedy, str) else remedy
