"""Kinds of findings in an identification, and their sentences: reliability, notes, experiments, selection, stages."""

from __future__ import annotations

from inerter.formatting import format_alike, format_number, format_quantity, format_share, format_with_interval
from inerter.records.finding import Finding, FindingKind
from inerter.records.remedy import Action, Remedy, Text

_FEW = 10.0  # samples in a period of a motion, below which it may be interpolated less exactly than it is read


def _misfit_text(f: Finding) -> str:
    n = f.numbers
    times = f"the residual is {format_number(n['times'], 2)} times the sensor noise"
    explained = n["explained"]
    share = "" if explained is None else f", and the variance explained is only {format_number(explained, 3)} %"
    if n["likeliest"] is None:
        where = "" if n["where"] is None else f", but {n['where'].sentence}"
        return f"{times}{share}; no tested cause accounts for it{where}. {_trial_text(f)}"
    others = ", or ".join(e.sentence for e in n["as_good"])
    other = f"; equally likely: {others}" if others else ""
    return f"{times}{share}; most likely cause: {n['likeliest'].sentence}{other}"


def _trial_text(f: Finding) -> str:
    """Next steps where no cause of a misfit is known."""
    if f.numbers["sampled"] < _FEW:
        return (
            f"The motion has only some {format_number(f.numbers['sampled'], 2)} samples in a period, between which "
            f"errors of interpolation may exceed the noise: sample it faster, or move more slowly"
        )
    return (
        "Fit other models and parts of the record, and repeat the test at another amplitude: where the estimates "
        "differ, the model lacks a law"
    )


def _unpredictable_text(f: Finding) -> str:
    better = "motion with less rattling" if f.numbers["rattles"] else "larger motion"
    return (
        f"the force is too sensitive to encoder noise ({format_number(f.numbers['changed'], 3)} % change) to identify "
        f"any parameter; record a {better}"
    )


def _saturation_text(f: Finding) -> str:
    share = format_share(f.numbers["share"], 2)
    return f"the load cell was saturated in {share} of the samples; reduce the motion"


def _late_text(f: Finding) -> str:
    late, other = ("force", "displacement") if f.numbers["delay"] > 0.0 else ("displacement", "force")
    return f"{f.about}: the {late} lags the {other}, by {format_quantity(abs(f.numbers['delay']), 's', 3)}."


def _offset_text(f: Finding) -> str:
    size = format_quantity(f.numbers["offset"], "N", 3)
    return (
        f"{f.about}: the offset of {size} may be an offset of the load cell or asymmetric friction; in that case the "
        f"identified friction is the mean of both directions."
    )


_SCALES = {  # sensitivity of the values
    "force_scale": ("force", "1 % more force makes stiffness, damping, inertance and friction 1 % larger"),
    "displacement_scale": (
        "displacement",
        "1 % more displacement makes stiffness, damping and inertance 1 % smaller and a gap 1 % larger",
    ),
}
_SCALE_REMEDIES = {"force_scale": Action.FORCE_SCALE, "displacement_scale": Action.DISPLACEMENT_SCALE}


def _included_uncertainty_text(f: Finding) -> Text:
    known = [f"a scale of the {what} of {f.numbers[n]}" for n, (what, _) in _SCALES.items() if f.numbers[n]]
    mass = f.numbers["fixture_mass_error"]
    known += [] if mass is None else [f"a fixture mass known to {format_quantity(mass, 'kg', 3)}"]
    text = f"Intervals include {' and '.join(known)} (standard uncertainty, k = 1). " if known else ""
    text += (
        "All values include what no record shows: the compliance between encoder and device, and an error of the clock "
        "(1 % fast makes damping 1 % and inertance 2 % larger)"
    )
    unknown = [n for n in _SCALES if not f.numbers[n]]
    if not unknown:
        return (f"{text}.",)
    sensors = " and the ".join(_SCALES[n][0] for n in unknown)
    text += f"; and errors in the scale of the {sensors}: {_SCALES[unknown[0]][1]}. State a known uncertainty as "
    return (text, Remedy(_SCALE_REMEDIES[unknown[0]], "1 +- 1 %"), ".")


def _force_margin_text(f: Finding) -> str:
    """Force up to which the load cell has range."""
    limit = f.numbers["limit"]
    return "" if limit is None else f", up to the {format_quantity(limit, 'N')} of the load cell"


def _faster_reversals_text(f: Finding) -> str:
    n = f.numbers
    return (
        f"{f.about}: a faster motion with frequent force reversals (present motion: up to "
        f"{format_quantity(n['fastest'], 'Hz', 3)} and {format_quantity(n['peak'], 'N', 3)}{_force_margin_text(f)}), "
        f"sampled so that crossing {format_quantity(n['width'], 'm')} takes several samples."
    )


def _larger_accelerations_text(f: Finding) -> str:
    wider = format_quantity(f.numbers["travel"], "m")
    return f"{f.about}: larger accelerations: {wider} at the same frequency, or twice the frequency."


def _break_away_text(f: Finding) -> str:
    held = format_quantity(f.numbers["held"], "N", 3)
    return (
        f"{f.about}: a larger or faster motion, with a force above the {held} at which the friction did not "
        f"slip{_force_margin_text(f)}."
    )


def _narrower_interval_text(f: Finding) -> str:
    n = f.numbers
    changes = [
        f"{format_number(n['larger'])} times the amplitude" if n["larger"] != 1.0 else "",
        f"{format_number(n['faster'])} times the frequencies" if n["faster"] != 1.0 else "",
        f"{n['longer']} times as long" if n["longer"] != 1 else "",
    ]
    amplitude, duration = format_quantity(n["amplitude"], "m", 3), format_quantity(n["duration"], "s", 3)
    return (
        f"{f.about}: the same motion, {', '.join(filter(None, changes))} (amplitude {amplitude}, up to "
        f"{format_quantity(n['highest'], 'Hz', 3)}, {duration}): expected interval width {_width(n['expected'], f)} "
        f"instead of {_width(n['width'], f)}."
    )


def _width(width: float, f: Finding) -> str:
    share = f" ({format_share(width / abs(f.numbers['value']), 2)})" if f.numbers["value"] else ""
    return f"{format_quantity(width, f.numbers['unit'], 2)}{share}"


def _calibrate_text(f: Finding) -> str:
    n = f.numbers
    fixed, width = format_alike([n["fixed"], n["width"]], n["unit"], 2)
    return (
        f"{f.about}: a better calibration of the sensors: their scales alone cause {fixed} of the interval width of "
        f"{width}, which no other motion can reduce."
    )


def _next_candidate_text(f: Finding) -> str:
    """Loss of the best candidate that is not as good."""
    n = f.numbers
    if n["next"] is None:
        return ""
    ratio = n["ratio"]
    how = f"{format_number(ratio, 3)} times" if ratio > 2.0 else f"{format_share(ratio - 1.0, 2)} above"
    return f" Next candidate: {n['next']}, {how} the loss of the best."


def _unknowns_text(f: Finding) -> str:
    many = f.numbers["unknowns"]
    return "one unknown" if many == 1 else f"{many} unknowns"


def _fewest_unknowns_text(f: Finding) -> str:
    n = f.numbers
    return (
        f"{f.about}: with {_unknowns_text(f)}, prediction of the validation data as good as {n['best']} with "
        f"{n['best_unknowns']} (loss {format_share(n['behind'], 2)} higher).{_next_candidate_text(f)}"
    )


def _friction_level_text(f: Finding) -> str:
    level, interval = format_with_interval(f.numbers["level"], f.numbers["lower"], f.numbers["upper"], "N")
    return f"Friction {level} ({interval}) from the test without flywheel."


def _response_text(f: Finding) -> str:
    differ, octaves = f.numbers["differ"], f.numbers["octaves"]
    if octaves and not differ:
        return f"The validation record agrees in all {octaves} octaves."
    return f"The validation record differs in {differ} of {octaves} octaves."


class FitFinding(FindingKind):
    """The kinds of findings in an identification."""

    # unreliable estimates
    UNPREDICTABLE = "unpredictable", _unpredictable_text
    UNRELATED = (
        "unrelated",
        "the force follows the displacement at no frequency; check that both channels are those of this device and of "
        "the same run, and that the device moves",
    )
    SUSPECTED = "suspected", lambda f: f.numbers["likeliest"].sentence
    MISFIT = "misfit", _misfit_text
    SATURATED = "saturated", _saturation_text
    SCALES = (
        "inconsistent-scales",
        lambda f: (
            f"the {f.about} is {format_number(f.numbers['factor'], 4)} times that of the displacement, so the unit, "
            f"the scale or the sign of one of them is wrong"
        ),
    )
    # notes on the estimates
    LATE = "late", _late_text
    FORCE_REVERSED = "force-reversed", lambda f: f"{f.about}: force positive in compression; reversed."
    OFFSET = "offset", _offset_text
    MOVING_MASS = (
        "moving-mass",
        lambda f: (
            (
                f"{f.about} includes the fixture mass between load cell and device, which cannot be separated from the "
                f"inertance. Weigh it and state it as ",
                *(Remedy(Action.FIXTURE_MASS), "."),
            )
        ),
    )
    INCLUDED = "included", _included_uncertainty_text
    # recommended experiments
    FASTER_REVERSALS = "faster-reversals", _faster_reversals_text
    BELOW_RESOLUTION = (
        "below-resolution",
        lambda f: (
            f"{f.about}: the whole backlash is below {format_quantity(f.numbers['width'], 'm')}, less than a step of "
            f"the displacement ({format_quantity(f.numbers['step'], 'm', 3)}), and may be taken as zero."
        ),
    )
    SLOW_COSINE = (
        "slow-cosine",
        lambda f: (
            f"{f.about}: a slow cosine, 0.1 Hz and {format_quantity(f.numbers['travel'], 'm')}, without the flywheel."
        ),
    )
    LARGER_ACCELERATIONS = "larger-accelerations", _larger_accelerations_text
    HIGHER_FREQUENCIES = (
        "higher-frequencies",
        lambda f: (
            f"{f.about}: a multisine or sweep of small amplitude up to twice the present "
            f"{format_quantity(f.numbers['fastest'], 'Hz', 3)} or more{_force_margin_text(f)}."
        ),
    )
    BREAK_AWAY = "break-away", _break_away_text
    NARROWER = "narrower", _narrower_interval_text
    CALIBRATE = "calibrate", _calibrate_text
    # the choice between models
    BEST = (
        "best",
        lambda f: (
            f"{f.about}: best prediction of the validation data, with {_unknowns_text(f)}.{_next_candidate_text(f)}"
        ),
    )
    FEWEST_UNKNOWNS = "fewest-unknowns", _fewest_unknowns_text
    NOT_REACHED = (
        "not-reached",
        lambda f: (
            f"{f.about}: not converged: the loss exceeds that of {f.numbers['other']}, which has a subset of its "
            f"elements or equivalent ones. Increase the number of starts."
        ),
    )
    FAILED = "failed", lambda f: (f"{f.about}: cannot be fitted. ", *f.numbers["error"])
    # the staged protocol
    FRICTION_LEVEL = "friction-level", _friction_level_text
    FRICTION_LAW = "friction-law", lambda f: f.numbers["law"].sentence
    OTHER_FRICTION = (
        "other-friction",
        lambda f: (
            f"The faster test is consistent only with a different friction force, at the end of its interval: "
            f"{format_quantity(f.numbers['best'], 'N')}. The friction may depend on speed or on the load of the "
            f"flywheel."
        ),
    )
    GIVEN_INERTANCE = (
        "given-inertance",
        lambda f: f"The inertance was given: {format_quantity(f.numbers['inertance'], 'kg')}.",
    )
    SATURATED_CHECK = (
        "saturated-check",
        lambda f: (
            f"The load cell was saturated in {format_share(f.numbers['share'], 2)} of the validation record, which no "
            f"model includes. Reduce the motion."
        ),
    )
    RESPONSE = "response", _response_text
