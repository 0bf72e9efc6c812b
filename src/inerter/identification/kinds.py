"""What can be found in an identification, and how it is said: doubts, notes, the next experiment, a choice, stages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import StrEnum

from inerter.records.finding import Finding
from inerter.records.remedy import Action, Remedy, Text
from inerter.units import format_quantity, format_with_interval


class FitFinding(StrEnum):
    """The kinds of findings in an identification."""

    # why a fit is not to be relied on
    UNPREDICTABLE = "unpredictable"
    SUSPECTED = "suspected"
    MISFIT = "misfit"
    SATURATED = "saturated"
    # what has to be known about the estimates
    FORCE_REVERSED = "force-reversed"
    OFFSET = "offset"
    MOVING_MASS = "moving-mass"
    INCLUDED = "included"
    # the next experiment
    FASTER_REVERSALS = "faster-reversals"
    SLOW_COSINE = "slow-cosine"
    LARGER_ACCELERATIONS = "larger-accelerations"
    HIGHER_FREQUENCIES = "higher-frequencies"
    BREAK_AWAY = "break-away"
    NARROWER = "narrower"
    CALIBRATE = "calibrate"
    # the choice between models
    BEST = "best"
    FEWEST_UNKNOWNS = "fewest-unknowns"
    NOT_REACHED = "not-reached"
    FAILED = "failed"
    # the staged protocol
    FRICTION_LEVEL = "friction-level"
    FRICTION_LAW = "friction-law"
    OTHER_FRICTION = "other-friction"
    GIVEN_INERTANCE = "given-inertance"
    SATURATED_CHECK = "saturated-check"
    RESPONSE = "response"

    def text(self, finding: Finding) -> Text:
        """The parts of the sentence of such a finding."""
        return _TEXTS[self](finding)


def _unpredictable(f: Finding) -> Text:
    return (
        f"errors as small as those of the encoder change {f.numbers['changed']:.1f} % of the force of this device, so "
        f"none of its parameters is identifiable; try a record in which it rattles less",
    )


def _suspected(f: Finding) -> Text:
    return (f.numbers["likeliest"].sentence,)


def _misfit(f: Finding) -> Text:
    n = f.numbers
    times = f"the model leaves {n['times']:.2g} times what the errors of the sensors leave"
    share = "" if n["explained"] is None else f", and explains {n['explained']:.1f} % of the force only"
    if n["likeliest"] is None:
        where = "" if n["where"] is None else f", but {n['where'].sentence}"
        return (f"{times}{share}; nothing that was tried explains it{where}",)
    others = ", or ".join(e.sentence for e in n["as_good"])
    verb = "explains" if len(n["as_good"]) == 1 else "explain"
    other = f", or {others}, which {verb} it as well" if others else ""
    return (f"{times}{share}; likeliest: {n['likeliest'].sentence}{other}",)


def _saturated(f: Finding) -> Text:
    return (f"the load cell was saturated in {100.0 * f.numbers['share']:.0f} % of the samples",)


def _reversed(f: Finding) -> Text:
    return (f"{f.about}: the force counted compression as positive; it was reversed.",)


def _offset(f: Finding) -> Text:
    size = format_quantity(f.numbers["offset"], "N", 3)
    return (
        f"{f.about}: the offset of {size} may be one of the load cell or asymmetric friction, larger in one direction, "
        f"of which the friction identified is the mean.",
    )


def _moving_mass(f: Finding) -> Text:
    return (
        f"{f.about}: holds what moves with the table between load cell and device, which the records do not separate "
        f"from an inertance; weigh it, and give it as ",
        *(Remedy(Action.FIXTURE_MASS), "."),
    )


_SCALES = {  # what 1 % more of it makes of the values
    "force_scale": ("force", "1 % more force makes stiffness, damping, inertance and friction 1 % larger"),
    "displacement_scale": (
        "displacement",
        "1 % more displacement makes stiffness, damping and inertance 1 % smaller and a gap 1 % larger",
    ),
}
_SCALE_REMEDIES = {"force_scale": Action.FORCE_SCALE, "displacement_scale": Action.DISPLACEMENT_SCALE}


def _included(f: Finding) -> Text:
    known = [f"a scale of the {what} of {f.numbers[n]}" for n, (what, _) in _SCALES.items() if f.numbers[n]]
    mass = f.numbers["fixture_mass_error"]
    known += [] if mass is None else [f"a fixture mass known to {format_quantity(mass, 'kg', 3)}"]
    text = f"Intervals include {' and '.join(known)} (standard uncertainty, k = 1). " if known else ""
    text += "All values include all compliance between encoder and device, which no record shows"
    unknown = [n for n in _SCALES if not f.numbers[n]]
    if not unknown:
        return (f"{text}.",)
    sensors = " and the ".join(_SCALES[n][0] for n in unknown)
    text += f", and errors in the scale of the {sensors}: {_SCALES[unknown[0]][1]}. State a known uncertainty as "
    return (text, Remedy(_SCALE_REMEDIES[unknown[0]], "1 +- 1 %"), ".")


def _room(f: Finding) -> str:
    """What the load cell still bears."""
    limit = f.numbers["limit"]
    return "" if limit is None else f", up to the {limit:.0f} N of the load cell"


def _faster(f: Finding) -> Text:
    n = f.numbers
    return (
        f"{f.about}: a faster motion in which the force reverses often (now up to {n['fastest']:.3g} Hz and "
        f"{n['peak']:.3g} N{_room(f)}), sampled so that crossing {format_quantity(n['width'], 'm')} takes several "
        f"samples.",
    )


def _slow(f: Finding) -> Text:
    return (f"{f.about}: a slow cosine, 0.1 Hz and {format_quantity(f.numbers['travel'], 'm')}, without the flywheel.",)


def _larger(f: Finding) -> Text:
    wider = format_quantity(f.numbers["travel"], "m")
    return (f"{f.about}: larger accelerations: {wider} at the same frequency, or twice the frequency.",)


def _higher(f: Finding) -> Text:
    return (
        f"{f.about}: a multisine or sweep of small amplitude up to twice the present {f.numbers['fastest']:.3g} Hz or "
        f"more{_room(f)}.",
    )


def _break_away(f: Finding) -> Text:
    held = format_quantity(f.numbers["held"], "N", 3)
    return (f"{f.about}: a larger or faster motion, whose force exceeds the {held} that the friction held{_room(f)}.",)


def _narrower(f: Finding) -> Text:
    n = f.numbers
    changes = [
        f"{n['larger']:g} times the amplitude" if n["larger"] != 1.0 else "",
        f"{n['faster']:g} times the frequencies" if n["faster"] != 1.0 else "",
        f"{n['longer']} times as long" if n["longer"] != 1 else "",
    ]
    amplitude, duration = format_quantity(n["amplitude"], "m", 3), format_quantity(n["duration"], "s", 3)
    return (
        f"{f.about}: the same motion, {', '.join(filter(None, changes))} (amplitude {amplitude}, up to "
        f"{n['highest']:.3g} Hz, {duration}): interval {_width(n['expected'], f)} wide instead of "
        f"{_width(n['width'], f)}.",
    )


def _width(width: float, f: Finding) -> str:
    share = f" ({100.0 * width / abs(f.numbers['value']):.2g} %)" if f.numbers["value"] else ""
    return f"{format_quantity(width, f.numbers['unit'], 2)}{share}"


def _calibrate(f: Finding) -> Text:
    n = f.numbers
    fixed, width = (format_quantity(n[name], n["unit"], 2) for name in ("fixed", "width"))
    return (
        f"{f.about}: a better calibration of the sensors: their scales alone make {fixed} of the interval, {width} "
        f"wide, which no other motion makes smaller.",
    )


def _next(f: Finding) -> str:
    """How much the best of those that are not as good leaves."""
    n = f.numbers
    if n["next"] is None:
        return ""
    how = f"{n['ratio']:.3g} times" if n["ratio"] > 2.0 else f"{100.0 * (n['ratio'] - 1.0):.2g} % above"
    return f" The next, {n['next']}, leaves {how} the loss of the best."


def _unknowns(f: Finding) -> str:
    many = f.numbers["unknowns"]
    return "one unknown" if many == 1 else f"{many} unknowns"


def _best(f: Finding) -> Text:
    return (f"{f.about}: predicts the check part best, with {_unknowns(f)}.{_next(f)}",)


def _fewest(f: Finding) -> Text:
    n = f.numbers
    return (
        f"{f.about}: with {_unknowns(f)} it predicts the check part as well as {n['best']} with {n['best_unknowns']} "
        f"(loss larger by {100.0 * n['behind']:.2g} %).{_next(f)}",
    )


def _not_reached(f: Finding) -> Text:
    return (
        f"{f.about}: does not reach {f.numbers['other']}, of the same parts, so this is not its best fit; try more "
        f"starts.",
    )


def _failed(f: Finding) -> Text:
    return (f"{f.about}: cannot be fitted. ", *f.numbers["error"])


def _level(f: Finding) -> Text:
    level, interval = format_with_interval(f.numbers["level"], f.numbers["lower"], f.numbers["upper"], "N")
    return (f"Friction {level} ({interval}) from the test without flywheel.",)


def _other_friction(f: Finding) -> Text:
    return (
        f"The faster test asks for another friction than the slow one: at the end of its interval, "
        f"{format_quantity(f.numbers['best'], 'N')}. The friction may depend on speed or on the load of the flywheel.",
    )


def _given_inertance(f: Finding) -> Text:
    return (f"The inertance was given: {format_quantity(f.numbers['inertance'], 'kg')}.",)


def _saturated_check(f: Finding) -> Text:
    return (
        f"The load cell was saturated in {100.0 * f.numbers['share']:.2g} % of the check, which no model's response "
        f"has in it: move less.",
    )


def _response(f: Finding) -> Text:
    differ, octaves = f.numbers["differ"], f.numbers["octaves"]
    if octaves and not differ:
        return (f"The check agrees in all {octaves} octaves.",)
    return (f"The check differs in {differ} of {octaves} octaves.",)


_TEXTS: Mapping[FitFinding, Callable[[Finding], Text]] = {
    FitFinding.UNPREDICTABLE: _unpredictable,
    FitFinding.SUSPECTED: _suspected,
    FitFinding.MISFIT: _misfit,
    FitFinding.SATURATED: _saturated,
    FitFinding.FORCE_REVERSED: _reversed,
    FitFinding.OFFSET: _offset,
    FitFinding.MOVING_MASS: _moving_mass,
    FitFinding.INCLUDED: _included,
    FitFinding.FASTER_REVERSALS: _faster,
    FitFinding.SLOW_COSINE: _slow,
    FitFinding.LARGER_ACCELERATIONS: _larger,
    FitFinding.HIGHER_FREQUENCIES: _higher,
    FitFinding.BREAK_AWAY: _break_away,
    FitFinding.NARROWER: _narrower,
    FitFinding.CALIBRATE: _calibrate,
    FitFinding.BEST: _best,
    FitFinding.FEWEST_UNKNOWNS: _fewest,
    FitFinding.NOT_REACHED: _not_reached,
    FitFinding.FAILED: _failed,
    FitFinding.FRICTION_LEVEL: _level,
    FitFinding.FRICTION_LAW: lambda f: (f.numbers["law"].sentence,),
    FitFinding.OTHER_FRICTION: _other_friction,
    FitFinding.GIVEN_INERTANCE: _given_inertance,
    FitFinding.SATURATED_CHECK: _saturated_check,
    FitFinding.RESPONSE: _response,
}
