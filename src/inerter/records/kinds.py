"""What can be found in a record, and how it is said."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import StrEnum

from inerter.records.finding import Finding
from inerter.records.record import CHANNELS
from inerter.records.remedy import Action, Remedy, Text

COARSE = 20.0  # steps over the range of a channel, with fewer of which it is read coarsely
LARGE = 0.5  # of the amplitude: a mean that may be an offset
CLEAR = 0.3  # least correlation that says anything
SEEN = 3.0  # standard errors of a delay that is seen
_LIMITED = (
    "it looks cut off there, and what lies above is lost. A fit leaves these samples out, a frequency response does "
    "not: reduce the motion, or ",
    Remedy(Action.TRIM),
    " those stretches away.",
)


class RecordFinding(StrEnum):
    """The kinds of findings in a record."""

    FEW_SAMPLES = "few-samples"
    SAMPLING = "sampling"
    GAPS = "gaps"
    JITTER = "jitter"
    LOST_SAMPLES = "lost-samples"
    FILLED = "filled"
    CUT = "cut"
    CONSTANT = "constant"
    IMPLAUSIBLE = "implausible"
    SATURATION = "saturation"
    DISPLACEMENT_STEPS = "displacement-steps"
    FORCE_STEPS = "force-steps"
    DISPLACEMENT_OFFSET = "displacement-offset"
    FORCE_OFFSET = "force-offset"
    DISPLACEMENT_DRIFT = "displacement-drift"
    FORCE_DRIFT = "force-drift"
    SWAPPED = "swapped"
    SPIKES = "spikes"
    HELD = "held"
    JOINED = "joined"
    HIDDEN_JITTER = "hidden-jitter"
    CLOCK_DRIFT = "clock-drift"
    HUM = "hum"
    LINE = "line"
    SIGN = "sign"
    FORCE_REVERSED = "force-reversed"
    DELAY = "delay"
    BANDWIDTH = "bandwidth"
    UNDERSAMPLED = "undersampled"

    def text(self, finding: Finding) -> Text:
        """The parts of the sentence of such a finding."""
        return _TEXTS[self](finding)


def _sampled(f: Finding) -> str:
    n, usual = f.numbers, f.numbers["interval"]
    return f"{n['samples']:.0f} samples over {n['duration']:.6g} s, every {usual:.6g} s ({1.0 / usual:.6g} Hz)"


def _few(f: Finding) -> Text:
    many = f"{f.numbers['samples']:.0f}"
    return (f"There are only {many} samples; a fit needs hundreds, over several periods of the motion.",)


def _sampling(f: Finding) -> Text:
    return (f"{_sampled(f)}, {'evenly spaced' if f.numbers['even'] else 'not quite evenly spaced'}.",)


def _gaps(f: Finding) -> Text:
    n = f.numbers
    return (
        f"{_sampled(f)}, with {n['gaps']:.0f} gaps of up to {n['longest']:.4g} s, the first at {n['first']:.6g} s: "
        f"about {n['lost']:.0f} samples are lost. Use ",
        *(Remedy(Action.FILL_GAPS), " for short ones, ", Remedy(Action.TRIM), " for long ones."),
    )


def _jitter(f: Finding) -> Text:
    n = f.numbers
    rounded = f" The times are written in steps of {n['step']:.3g} s." if n["step"] > 0.0 else ""
    return (
        f"{_sampled(f)}, but unevenly: the intervals scatter by {100.0 * n['jitter']:.3g} %.{rounded} If the clock was "
        f"even, read the file with ",
        *(Remedy(Action.INTERVAL, n["interval"]), "; else use ", Remedy(Action.RESAMPLE), "."),
    )


def _lost(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The displacement leaps along itself at {n['places']:.0f} places, the first at {n['first']:.4g} s: about "
        f"{n['samples']:.0f} samples are lost while the clock goes on. Read the file with ",
        *(Remedy(Action.GAPS, "fill"), ", which puts them in."),
    )


def _spikes(f: Finding) -> Text:
    n, unit = f.numbers, CHANNELS[f.about]
    return (
        f"The {f.about} has {_many(n['places'], 'spike')} of up to {n['largest']:.4g} {unit} in {n['samples']:.0f} "
        f"samples, the first at {n['first']:.4g} s. Check cables and connectors, or use ",
        *(Remedy(Action.REPAIR), "."),
    )


def _held(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The {f.about} repeats one value at {_many(n['places'], 'place')}, for up to {n['longest']:.0f} samples, the "
        f"first at {n['first']:.4g} s: the recorder missed samples and held the last one. Use ",
        *(Remedy(Action.REPAIR), ", or ", Remedy(Action.TRIM), " those stretches away."),
    )


def _joined(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The displacement jumps at {_many(n['places'], 'place')}, by up to {n['largest']:.4g} m within one interval, "
        f"the first at {n['first']:.4g} s: the pieces before and after belong to different runs. Use ",
        *(Remedy(Action.TRIM), " and fit each piece as a record of its own."),
    )


def _many(count: float, noun: str) -> str:
    return f"one {noun}" if count == 1.0 else f"{count:.0f} {noun}s"


def _hidden_jitter(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The displacement scatters in proportion to its speed, as sampling instants that jitter by "
        f"{1e3 * n['jitter']:.3g} ms (r.m.s., {100.0 * n['jitter'] / n['interval']:.0f} % of an interval) would make "
        f"it, although the times are even. Sample both channels by one hardware clock, or record the true times.",
    )


def _clock_drift(f: Finding) -> Text:
    n = f.numbers
    growth = f"{1e3 * abs(n['growth']):.3g} ms {'later' if n['growth'] > 0.0 else 'earlier'}"
    return (
        f"The phase between force and displacement moves steadily, as if the force came {growth} at the end than at "
        f"the start (standard error {1e3 * n['standard_error']:.2g} ms): the clocks of the channels differ by "
        f"{1e6 * abs(n['rate']):.3g} ppm, or the losses of the device change. Sample both channels by one clock.",
    )


def _line(f: Finding) -> Text:
    n = f.numbers
    alias = f" or an alias of it, such as {n['rate'] - n['frequency']:.4g} Hz"
    return (
        f"The force has a line of {n['amplitude']:.3g} N at {n['frequency']:.4g} Hz that stands alone in its spectrum "
        f"and is no multiple of the motion: pickup at that frequency{alias}. Check grounding and shielding, and filter "
        f"against aliasing before sampling.",
    )


def _filled(f: Finding) -> Text:
    many, longest = f"{f.numbers['samples']:.0f}", f"{f.numbers['longest']:.0f}"
    return (f"Samples of the {f.about} that were missing and interpolated: {many}, up to {longest} in a row.",)


def _cut(f: Finding) -> Text:
    return ("The file was cut short; its last samples are missing.",)


def _constant(f: Finding) -> Text:
    return (
        f"The {f.about} is constant, {f.numbers['value']:.6g} {CHANNELS[f.about]}, so nothing can be fitted. Was the "
        f"sensor connected, and is it the right channel?",
    )


def _implausible(f: Finding) -> Text:
    size = f"{f.numbers['amplitude']:.4g} {CHANNELS[f.about]}"
    return (f"The {f.about} has an amplitude of {size}, hard to believe. Is its unit right?",)


def _saturation(f: Finding) -> Text:
    n = f.numbers
    if "extremes" not in n:
        return (
            f"The load cell is at its limit of {n['limit']:.6g} N for {100.0 * n['share']:.2g} % of the samples: ",
            *_LIMITED,
        )
    where = " and ".join(f"{value:.6g} N for {longest} samples" for value, longest in n["extremes"])
    return (f"The force stays at an extreme of {where} in a row: ", *_LIMITED)


def _steps(f: Finding) -> Text:
    n = f.numbers
    coarse = " That is coarse: use more of the sensor's range." if n["levels"] < COARSE else ""
    step = f"{n['step']:.3g} {CHANNELS[f.about]}"
    return (f"The {f.about} is read in steps of {step}, {n['levels']:.0f} of them over its range.{coarse}",)


def _offset(f: Finding) -> Text:
    n, unit = f.numbers, CHANNELS[f.about]
    said = f"The {f.about} has a mean of {n['mean']:.4g} {unit}, with an amplitude of {n['amplitude']:.4g} {unit}."
    if not abs(n["mean"]) > LARGE * n["amplitude"]:
        return (said,)
    return (f"{said} If it should be zero at rest, use ", Remedy(Action.REMOVE_OFFSET), ".")


def _drift(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The {f.about} drifts by {n['change']:.4g} {CHANNELS[f.about]} from the first quarter to the last, "
        f"{100.0 * abs(n['change']) / n['range']:.0f} % of its range. Use ",
        *(Remedy(Action.DETREND), "."),
    )


def _swapped(f: Finding) -> Text:
    ratio = f.numbers["displacement"] / max(f.numbers["force"], 1e-12)
    return (
        f"The displacement is {ratio:.3g} times as rough as the force from sample to sample, where motion is the "
        f"smoother one. Are the two columns swapped?",
    )


def _hum(f: Finding) -> Text:
    n = f.numbers
    hum = f"{n['amplitude']:.3g} N at {n['frequency']:g} Hz"
    return (f"The force holds hum of the mains: {hum}. Check the grounding of the cell.",)


def _correlations(f: Finding) -> str:
    n = f.numbers
    return (
        f"correlation {n['with_acceleration']:+.2f} with the acceleration, {n['with_velocity']:+.2f} with the velocity"
    )


def _sign(f: Finding) -> Text:
    inertia, loss = f.numbers["with_acceleration"], f.numbers["with_velocity"]
    if max(abs(inertia), abs(loss)) < CLEAR:
        return (f"The force follows neither motion nor its rates clearly ({_correlations(f)}).",)
    if inertia < -CLEAR:
        how = f"takes in work ({_correlations(f)}), as that of a spring does"
        return (f"The force goes against the acceleration but {how}.",)
    return (f"The force has the sign of inertia and losses ({_correlations(f)}).",)


def _reversed(f: Finding) -> Text:
    return (
        f"The force is reversed: it goes against the motion, and the device gives out work ({_correlations(f)}). Force "
        f"is positive in tension, displacement when the device grows longer.",
        Remedy(Action.REVERSE_FORCE),
    )


_WHY = {
    "acceleration": "the measured acceleration does not follow that of the displacement",
    "force": "it is not excited over a wide enough band below the resonance of the device",
}


def _delay(f: Finding) -> Text:
    n = f.numbers
    if "delay" not in n:
        return (
            f"A delay between force and displacement cannot be identified from this record alone: {_WHY[f.about]}. "
            f"Record a sweep or multisine, or an acceleration, or leave the delay free when the model is fitted.",
        )
    late, margin = n["delay"], f"(standard error {1e3 * n['standard_error']:.2g} ms)"
    if f.severity == "info":
        return (f"No delay between force and motion is seen {margin}.",)
    how = f"{1e3 * abs(late):.3g} ms {'later' if late >= 0.0 else 'earlier'} than the displacement"
    said = (
        f"The measured acceleration is {how}, so presumably is the force"
        if f.about == "acceleration"
        else f"The force is {how}, if the device is inertia, losses and elasticity below resonance"
    )
    return (f"{said} {margin}. ", Remedy(Action.SHIFT_FORCE, late), " removes it.")


def _bandwidth(f: Finding) -> Text:
    n = f.numbers
    why = "as asked" if n["asked"] else f"the displacement stands out of its noise up to {n['highest']:.3g} Hz"
    return (
        f"Smoothed to {n['bandwidth']:.4g} Hz ({why}), which takes {100.0 * n['attenuation']:.2g} % at "
        f"{n['highest']:.3g} Hz and leaves noise of {n['velocity_noise']:.2g} m/s in the velocity and "
        f"{n['acceleration_noise']:.2g} m/s^2 in the acceleration (r.m.s.).",
    )


def _undersampled(f: Finding) -> Text:
    n = f.numbers
    return (
        f"The displacement moves at up to {n['highest']:.3g} Hz, and its samples show no more than {n['limit']:.4g} "
        f"Hz: what is faster appears as slower. Sample at five times the highest frequency of the motion.",
    )


_TEXTS: Mapping[RecordFinding, Callable[[Finding], Text]] = {
    RecordFinding.FEW_SAMPLES: _few,
    RecordFinding.SAMPLING: _sampling,
    RecordFinding.GAPS: _gaps,
    RecordFinding.JITTER: _jitter,
    RecordFinding.LOST_SAMPLES: _lost,
    RecordFinding.FILLED: _filled,
    RecordFinding.CUT: _cut,
    RecordFinding.CONSTANT: _constant,
    RecordFinding.IMPLAUSIBLE: _implausible,
    RecordFinding.SATURATION: _saturation,
    RecordFinding.DISPLACEMENT_STEPS: _steps,
    RecordFinding.FORCE_STEPS: _steps,
    RecordFinding.DISPLACEMENT_OFFSET: _offset,
    RecordFinding.FORCE_OFFSET: _offset,
    RecordFinding.DISPLACEMENT_DRIFT: _drift,
    RecordFinding.FORCE_DRIFT: _drift,
    RecordFinding.SWAPPED: _swapped,
    RecordFinding.SPIKES: _spikes,
    RecordFinding.HELD: _held,
    RecordFinding.JOINED: _joined,
    RecordFinding.HIDDEN_JITTER: _hidden_jitter,
    RecordFinding.CLOCK_DRIFT: _clock_drift,
    RecordFinding.HUM: _hum,
    RecordFinding.LINE: _line,
    RecordFinding.SIGN: _sign,
    RecordFinding.FORCE_REVERSED: _reversed,
    RecordFinding.DELAY: _delay,
    RecordFinding.BANDWIDTH: _bandwidth,
    RecordFinding.UNDERSAMPLED: _undersampled,
}
