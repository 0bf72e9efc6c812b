"""Kinds of findings in a record, and their sentences."""

from __future__ import annotations

import math

from inerter.formatting import (
    format_alike,
    format_number,
    format_quantity,
    format_share,
    format_with_error,
    significant_digits,
)
from inerter.records.finding import Finding, FindingKind
from inerter.records.record import CHANNELS
from inerter.records.remedy import Action, Remedy, Text
from inerter.statements import Severity

COARSE = 20.0  # resolution steps over the range of a channel, below which its resolution is coarse
LARGE = 0.5  # of the amplitude: a mean that may be an offset
CLEAR = 0.3  # least significant correlation
SEEN = 3.0  # standard errors of a significant delay
_LIMITED = (
    "it appears clipped (saturated). A fit excludes these samples, a frequency response does not: reduce the motion, "
    "or ",
    Remedy(Action.TRIM),
    " these intervals away.",
)


def _format_sampling(f: Finding) -> str:
    usual, duration = f.numbers["interval"], format_quantity(f.numbers["duration"], "s", 6)
    every = f"every {format_quantity(usual, 's', 6)} ({format_quantity(1.0 / usual, 'Hz', 6)})"
    return f"{round(f.numbers['samples'])} samples over {duration}, {every}"


def _gaps_text(f: Finding) -> Text:
    n = f.numbers
    return (
        f"{_format_sampling(f)}, with {round(n['gaps'])} gaps of up to {format_quantity(n['longest'], 's')}, the first "
        f"at {format_quantity(n['first'], 's', 6)}: about {round(n['lost'])} samples are missing. Use ",
        *(Remedy(Action.FILL_GAPS), " for short ones, ", Remedy(Action.TRIM), " for long ones."),
    )


def _jitter_text(f: Finding) -> Text:
    n = f.numbers
    rounded = f" The resolution of the times is {format_quantity(n['step'], 's', 3)}." if n["step"] > 0.0 else ""
    return (
        f"{_format_sampling(f)}, but unevenly: the intervals vary by {format_share(n['jitter'])} (r.m.s.).{rounded} If "
        f"the clock was even, read the file with ",
        *(Remedy(Action.INTERVAL, n["interval"]), "; else use ", Remedy(Action.RESAMPLE), "."),
    )


def _lost_samples_text(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The displacement skips ahead at {_format_count(n['places'], 'instant')}, the first at "
        f"{format_quantity(n['first'], 's')}: about {round(n['samples'])} samples were dropped without a gap in the "
        f"time channel. Read the file with ",
        *(Remedy(Action.GAPS, "fill"), ", which interpolates them."),
    )


def _spikes_text(f: Finding) -> Text:
    n, unit = f.numbers, CHANNELS[f.about]
    return (
        f"The {f.about} has {_format_count(n['places'], 'spike')} of up to {format_quantity(n['largest'], unit)} in "
        f"{round(n['samples'])} samples, the first at {format_quantity(n['first'], 's')}. Check cables and connectors, "
        f"or use ",
        *(Remedy(Action.REPAIR), "."),
    )


def _held_values_text(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The {f.about} repeats one value at {_format_count(n['places'], 'place')}, for up to {round(n['longest'])} "
        f"samples, the first at {format_quantity(n['first'], 's')}: the recorder missed samples and held the last one. "
        f"Use ",
        *(Remedy(Action.REPAIR), ", or ", Remedy(Action.TRIM), " these intervals away."),
    )


def _slower_channel_text(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The {f.about} was measured at one sample in {format_number(n['every'], 4)} only, and {n['way']} in between. "
        f"Record both channels at one rate, or keep the measured samples alone, ",
        *(Remedy(Action.REPAIR), "."),
    )


def _joint_text(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The displacement jumps at {_format_count(n['places'], 'place')}, by up to "
        f"{format_quantity(n['largest'], 'm')} within one interval, the first at {format_quantity(n['first'], 's')}: "
        f"the pieces before and after belong to different runs. Use ",
        *(Remedy(Action.TRIM), " and fit each piece as a separate record."),
    )


def _format_count(count: float, noun: str) -> str:
    return f"one {noun}" if count == 1.0 else f"{round(count)} {noun}s"


def _hidden_jitter_text(f: Finding) -> str:
    n = f.numbers
    return (
        f"The noise of the displacement grows with speed although the times are even: sampling jitter of "
        f"{format_quantity(n['jitter'], 's', 3)} (r.m.s., {format_share(n['jitter'] / n['interval'], 2)} of an "
        f"interval). Sample both channels with one hardware clock, or record the true times."
    )


def _clock_drift_text(f: Finding) -> str:
    n = f.numbers
    late, error = format_with_error(abs(n["growth"]), n["standard_error"], "s")
    rate = format_number(1e6 * abs(n["rate"]), significant_digits(n["rate"], n["standard_error"] / abs(n["growth"]), 3))
    return (
        f"The phase between force and displacement drifts: the force is {late} "
        f"{'later' if n['growth'] > 0.0 else 'earlier'} at the end than at the start (standard error {error}). The "
        f"clocks of the channels differ by {rate} ppm, or the losses of the device change. Sample both channels with "
        f"one clock."
    )


def _line_text(f: Finding) -> str:
    n = f.numbers
    alias = f" or an alias of it, such as {format_quantity(n['rate'] - n['frequency'], 'Hz')}"
    return (
        f"The force has an isolated spectral line of {format_quantity(n['amplitude'], 'N', 3)} at "
        f"{format_quantity(n['frequency'], 'Hz')} that is no harmonic of the motion: pickup at that frequency{alias}. "
        f"Check grounding and shielding, and use an anti-aliasing filter."
    )


def _filled_samples_text(f: Finding) -> str:
    many, longest = round(f.numbers["samples"]), round(f.numbers["longest"])
    return f"Missing samples of the {f.about}, interpolated: {many}, up to {longest} in a row."


def _implausible_amplitude_text(f: Finding) -> str:
    size = format_quantity(f.numbers["amplitude"], CHANNELS[f.about])
    return f"The {f.about} has an implausible amplitude of {size}. Check its unit."


def _time_scale_text(f: Finding) -> Text:
    n = f.numbers
    motion = f"{_format_sampling(f)}, with an acceleration of {format_quantity(n['acceleration'], 'm/s^2', 3)} (r.m.s.)"
    if n["inertial"] is None:
        return (
            f"The motion is implausibly fast: {motion}. Check the unit of the times, such as ",
            *(Remedy(Action.UNIT, ("time", "s")), "."),
        )
    return (
        f"The motion is implausibly slow: {motion}, with which even 1 t adds only "
        f"{format_quantity(n['inertial'], 'N', 3)} to the force. Check the unit of the times, such as ",
        *(Remedy(Action.UNIT, ("time", "ms")), "."),
        " If it is right, the record shows friction and stiffness only.",
    )


def _saturation_text(f: Finding) -> Text:
    n = f.numbers
    if "extremes" not in n:
        return (
            f"The force reaches the range of the load cell, {format_quantity(n['limit'], 'N', 6)}, for "
            f"{format_share(n['share'], 2)} of the samples: ",
            *_LIMITED,
        )
    where = " and ".join(f"{format_quantity(value, 'N', 6)} for {longest}" for value, longest in n["extremes"])
    return (f"The force is constant at an extreme of {where} consecutive samples: ", *_LIMITED)


def _resolution_text(f: Finding) -> str:
    n = f.numbers
    coarse = " That is coarse: use more of the range of the sensor." if n["levels"] < COARSE else ""
    step = format_quantity(n["step"], CHANNELS[f.about], 3)
    return f"The {f.about} has a resolution of {step}, {round(n['levels'])} steps over its range.{coarse}"


def _offset_text(f: Finding) -> Text:
    n = f.numbers
    mean, amplitude = format_alike([n["mean"], n["amplitude"]], CHANNELS[f.about])
    said = f"The {f.about} has a mean of {mean}, with an amplitude of {amplitude}."
    if not abs(n["mean"]) > LARGE * n["amplitude"]:
        return (said,)
    return (f"{said} If the {f.about} should be zero at rest, use ", Remedy(Action.REMOVE_OFFSET), ".")


def _drift_text(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The {f.about} drifts by {format_quantity(n['change'], CHANNELS[f.about])} from the first quarter to the "
        f"last, {format_share(abs(n['change']) / n['range'], 2)} of its range. Use ",
        *(Remedy(Action.DETREND), "."),
    )


_DERIVATIVES = {"velocity": "first", "acceleration": "second"}
_UNITS = {9.80665: "g and m/s^2", 1e3: "mm and m", 1e6: "um and m", 25.4: "inch and mm"}  # by their ratio
_CLOSE = 0.03  # relative difference from such a ratio


def _inconsistent_scales_text(f: Finding) -> Text:
    factor = f.numbers["factor"]
    near = (u for ratio, u in _UNITS.items() if abs(abs(math.log(abs(factor))) - math.log(ratio)) < _CLOSE)
    units = next((f", the ratio of {pair}" for pair in near), "")
    return (
        f"The {f.about} is {format_number(factor, 4)} times the {_DERIVATIVES[f.about]} derivative of the "
        f"displacement{units}: the unit, the scale or the sign of one of them is wrong. Models are fitted to the "
        f"displacement. Correct that channel, such as ",
        *(Remedy(Action.UNIT, ("displacement", "mm")), "."),
    )


def _swapped_columns_text(f: Finding) -> str:
    ratio = f.numbers["displacement"] / max(f.numbers["force"], 1e-12)
    return (
        f"The displacement is {format_number(ratio, 3)} times as rough as the force from sample to sample, but a "
        f"displacement should be smoother than the force. Check whether the two columns are swapped."
    )


def _hum_text(f: Finding) -> str:
    n, (unit, sensor) = f.numbers, {"force": ("N", "the load cell")}.get(f.about, ("m", "its sensor"))
    hum = f"{format_quantity(n['amplitude'], unit, 3)} at {format_quantity(n['frequency'], 'Hz', 6)}"
    return f"The {f.about} contains mains hum: {hum}. Check the grounding of {sensor}."


def _format_correlations(f: Finding) -> str:
    inertia, loss = (format_number(f.numbers[f"with_{which}"], 2, "+") for which in ("acceleration", "velocity"))
    return f"correlation {inertia} with the acceleration, {loss} with the velocity"


def _sign_text(f: Finding) -> str:
    inertia, loss = f.numbers["with_acceleration"], f.numbers["with_velocity"]
    if max(abs(inertia), abs(loss)) < CLEAR:
        return f"The force has no clear correlation with the motion ({_format_correlations(f)})."
    if inertia < -CLEAR:
        return (
            f"The force opposes the acceleration but dissipates energy ({_format_correlations(f)}), as below the "
            f"resonance with a spring."
        )
    return f"The force has the sign of inertia and losses ({_format_correlations(f)})."


_WHY = {
    "acceleration": "the measured acceleration does not follow that of the displacement",
    "force": "it is not excited over a wide enough band below the resonance of the device",
}


def _delay_text(f: Finding) -> Text:
    n = f.numbers
    if "delay" not in n:
        return (
            f"A delay between force and displacement cannot be identified from this record alone: {_WHY[f.about]}. "
            f"Record a sweep or multisine, or an acceleration, or leave the delay free when the model is fitted.",
        )
    late, error = n["delay"], n["standard_error"]
    if f.severity is Severity.INFO:
        known = format_quantity(error, "s", 2)
        return (f"No significant delay between force and motion (standard error {known}).",)
    size, known = format_with_error(abs(late), error, "s")
    how = f"{size} {'later' if late >= 0.0 else 'earlier'} than the displacement"
    said = (
        f"The measured acceleration is {how}, so presumably is the force"
        if f.about == "acceleration"
        else f"The force is {how}, if the device is inertia, losses and elasticity below resonance"
    )
    return (f"{said} (standard error {known}). ", Remedy(Action.SHIFT_FORCE, late), " removes it.")


def _bandwidth_text(f: Finding) -> str:
    n = f.numbers
    why = (
        "as specified"
        if n["asked"]
        else f"the displacement exceeds its noise floor up to {format_quantity(n['highest'], 'Hz', 3)}"
    )
    return (
        f"Displacement low-pass filtered at {format_quantity(n['bandwidth'], 'Hz')} ({why}): attenuation "
        f"{format_share(n['attenuation'], 2)} at {format_quantity(n['highest'], 'Hz', 3)}, r.m.s. noise "
        f"{format_quantity(n['velocity_noise'], 'm/s', 2)} in the velocity and "
        f"{format_quantity(n['acceleration_noise'], 'm/s^2', 2)} in the acceleration."
    )


def _undersampling_text(f: Finding) -> str:
    n = f.numbers
    return (
        f"The displacement has components up to {format_quantity(n['highest'], 'Hz', 3)}, close to the Nyquist "
        f"frequency of {format_quantity(n['limit'], 'Hz')}: faster components are aliased. Sample at five times the "
        f"highest frequency of the motion."
    )


class RecordFinding(FindingKind):
    """The kinds of findings in a record."""

    FEW_SAMPLES = (
        "few-samples",
        lambda f: (
            f"The record has only {round(f.numbers['samples'])} samples; a fit requires hundreds, over several periods "
            f"of the motion."
        ),
    )
    SAMPLING = (
        "sampling",
        lambda f: f"{_format_sampling(f)}, {'evenly spaced' if f.numbers['even'] else 'not exactly evenly spaced'}.",
    )
    GAPS = "gaps", _gaps_text
    JITTER = "jitter", _jitter_text
    LOST_SAMPLES = "lost-samples", _lost_samples_text
    FILLED = "filled", _filled_samples_text
    CUT = "cut", "The file is truncated: its last samples are missing."
    CONSTANT = (
        "constant",
        lambda f: (
            f"The {f.about} is constant, {format_quantity(f.numbers['value'], CHANNELS[f.about], 6)}, so no model can "
            f"be fitted. Check the connection of the sensor and the selection of the channel."
        ),
    )
    EXTREME = (
        "extreme",
        lambda f: (
            f"The {f.about} has values of {format_quantity(f.numbers['size'], CHANNELS[f.about])}, which no sensor "
            f"reads, so no model can be fitted. Check its unit, and the file."
        ),
    )
    IMPLAUSIBLE = "implausible", _implausible_amplitude_text
    TIME_SCALE = "time-scale", _time_scale_text
    SCALES = "inconsistent-scales", _inconsistent_scales_text
    SATURATION = "saturation", _saturation_text
    DISPLACEMENT_STEPS = "displacement-steps", _resolution_text
    FORCE_STEPS = "force-steps", _resolution_text
    DISPLACEMENT_OFFSET = "displacement-offset", _offset_text
    FORCE_OFFSET = "force-offset", _offset_text
    DISPLACEMENT_DRIFT = "displacement-drift", _drift_text
    FORCE_DRIFT = "force-drift", _drift_text
    SWAPPED = "swapped", _swapped_columns_text
    SPIKES = "spikes", _spikes_text
    HELD = "held", _held_values_text
    SLOWER = "slower-channel", _slower_channel_text
    JOINED = "joined", _joint_text
    HIDDEN_JITTER = "hidden-jitter", _hidden_jitter_text
    CLOCK_DRIFT = "clock-drift", _clock_drift_text
    HUM = "hum", _hum_text
    LINE = "line", _line_text
    SIGN = "sign", _sign_text
    FORCE_REVERSED = (
        "force-reversed",
        lambda f: (
            (
                f"The force is reversed: it opposes the motion, and the device would generate energy "
                f"({_format_correlations(f)}). Force is positive in tension, displacement when the device lengthens.",
                Remedy(Action.REVERSE_FORCE),
            )
        ),
    )
    DELAY = "delay", _delay_text
    BANDWIDTH = "bandwidth", _bandwidth_text
    UNDERSAMPLED = "undersampled", _undersampling_text


QUESTIONABLE = (  # units and columns, which a user may correct before a fit
    RecordFinding.IMPLAUSIBLE,
    RecordFinding.TIME_SCALE,
    RecordFinding.SCALES,
    RecordFinding.SWAPPED,
)
