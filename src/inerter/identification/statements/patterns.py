"""Patterns in the force residual of a fit, and their sentences: time, position, speed or frequency."""

from __future__ import annotations

from inerter.formatting import format_alike, format_number, format_quantity, format_share
from inerter.records.finding import Finding, FindingKind

TRAVEL, FRICTION = "travel since the last reversal", "position, against the motion"
UNITS = {  # of what the residual may depend on
    "displacement": "m",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "force": "N",
    "force rate": "N/s",
    TRAVEL: "m",
    FRICTION: "m",
}
COEFFICIENTS = {  # of the residual on a signal: its physical meaning and unit
    "constant": ("an offset of the load cell", "N"),
    "displacement": ("a stiffness", "N/m"),
    "velocity": ("a damping", "N s/m"),
    "acceleration": ("an inertance", "kg"),
    "direction": ("a friction force", "N"),
    "force": ("a gain of the load cell", ""),
    "force rate": ("a delay of the force", "s"),
}


def _times_text(f: Finding) -> str:
    before, after = (format_number(f.numbers[when], 2) for when in ("before", "after"))
    return f"{before} times the sensor noise before, {after} times after{_with_motion(f)}"


def _with_motion(f: Finding) -> str:
    """Words on a change of the motion at the same time, which may be all that changes."""
    return ", where the motion changes too" if f.numbers.get("motion") else ""


def _grows_text(f: Finding) -> str:
    n = f.numbers
    way = "grows" if n["after"] > n["before"] else "decreases"
    motion = ", together with the acceleration of the motion" if n["motion"] else ""
    before, after = format_number(n["before"], 2), format_number(n["after"], 2)
    return f"the misfit {way} over the record, from {before} to {after} times the sensor noise{motion}"


def _size(f: Finding, key: str) -> str:
    unit = COEFFICIENTS[f.about][1]
    size = f.numbers[key]
    return format_quantity(size, unit, 3) if unit else format_share(size)


def _coefficient_step_text(f: Finding) -> str:
    like = COEFFICIENTS[f.about][0]
    change, time = _size(f, "change"), format_quantity(f.numbers["time"], "s")
    return f"the misfit is like {like} that changes by {change} at {time}{_with_motion(f)}"


def _coefficient_trend_text(f: Finding) -> str:
    like = COEFFICIENTS[f.about][0]
    return f"the misfit is like {like} that changes steadily, by {_size(f, 'change')} over the record"


def _channel_text(f: Finding) -> str:
    n = f.numbers
    return f"the misfit {'grows' if n['correlation'] > 0.0 else 'decreases'} with the {f.about} of the run"


def _other_quantities_text(f: Finding) -> str:
    """Quantities on which the residual depends as well, as in a motion of one frequency."""
    others = f.numbers.get("others", ())
    return f" or the {' or the '.join(others)} (not separated by this motion)" if others else ""


def _mean_text(f: Finding) -> str:
    if f.about == FRICTION:
        return f"the misfit is position-dependent friction{_other_quantities_text(f)}: {_range_text(f)}"
    return f"the misfit depends on the {f.about}{_other_quantities_text(f)}: {_range_text(f)}"


def _range_text(f: Finding) -> str:
    n, unit = f.numbers, UNITS[f.about]
    low, high = format_alike([n["at_least"], n["at_most"]], unit, 2)
    least, most = format_alike([n["least"], n["most"]], "N", 2)
    return f"{least} at {low}, {most} at {high}"


def _spread_text(f: Finding) -> str:
    n = f.numbers
    how = "grows" if n["high"] > n["low"] else "decreases"
    low, high = format_alike([n["low"], n["high"]], "N", 2)
    return (
        f"the scatter of the misfit {how} with the size of the {f.about}{_other_quantities_text(f)}, from {low} to "
        f"{high}"
    )


def _positions_text(f: Finding) -> str:
    at = [format_quantity(place, "m", 3) for place in f.numbers["places"]]
    where = "one position" if len(at) == 1 else f"{len(at)} positions"
    return f"the misfit is concentrated at {where}: {', '.join(at)}"


def _line_text(f: Finding) -> str:
    n = f.numbers
    foreign = "not excited by the motion" if n["foreign"] else "excited by the motion"
    if n["multiple"] > 1:
        foreign = f"{n['multiple']} times that of the motion: a nonlinear law, not a disturbance"
    elif n["resonates"]:
        foreign = "where the device resonates: any fault excites that"
    size = format_quantity(n["amplitude"], "N", 3)
    return f"the misfit is a spectral line of {size} at {format_quantity(n['frequency'], 'Hz')}, {foreign}"


def _band_text(f: Finding) -> str:
    n = f.numbers
    where = ", above the motion" if n["low"] > n["highest"] else ""
    where = ", where the device resonates: any fault excites that" if n["resonates"] else where
    low, high = format_alike([n["low"], n["high"]], "Hz", 3)
    return f"the misfit lies between {low} and {high}{where}"


def _instants_text(f: Finding) -> str:
    n = f.numbers
    times = ", ".join(format_number(t, 4) for t in n["times"])
    more = ", ..." if n["count"] > len(n["times"]) else ""
    where = "one instant" if n["count"] == 1 else f"{n['count']} instants"
    lasting = "one sample" if n["longest"] == 1 else f"up to {n['longest']} samples"
    leaps = ", where the force jumps from sample to sample" if n["leaps"] else ""
    size = format_quantity(n["largest"], "N", 3)
    return f"the misfit is concentrated at {where}, up to {size} for {lasting}: at {times}{more} s{leaps}"


class MisfitPattern(FindingKind):
    """The kinds of patterns in a residual; their sentences are for use after a colon."""

    BEGINS = "begins", lambda f: f"the misfit begins at {format_quantity(f.numbers['time'], 's')}: {_times_text(f)}"
    ENDS = "ends", lambda f: f"the misfit ends at {format_quantity(f.numbers['time'], 's')}: {_times_text(f)}"
    LEVEL_STEP = (
        "level-step",
        lambda f: f"the misfit changes at {format_quantity(f.numbers['time'], 's')}: {_times_text(f)}",
    )
    GROWS = "grows", _grows_text
    COEFFICIENT_STEP = "coefficient-step", _coefficient_step_text
    COEFFICIENT_TREND = "coefficient-trend", _coefficient_trend_text
    CHANNEL = "channel", _channel_text
    MEAN = "mean", _mean_text
    SPREAD = "spread", _spread_text
    POSITIONS = "positions", _positions_text
    LINE = "line", _line_text
    BAND = "band", _band_text
    INSTANTS = "instants", _instants_text
