"""The figures of an identification, each with its caption, drawn one after the other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from inerter.figures.identification import (
    MotionCurve,
    ProfileCurve,
    loops_figure,
    profile_figure,
    record_figure,
    residual_figure,
    response_figure,
    time_figure,
)
from inerter.figures.misfit import ResidualSamples, misfit_figure
from inerter.files.identification.running import IdentificationResult, Responses
from inerter.formatting import choose_scale, format_quantity, format_range
from inerter.identification.fit import Localisation, RecordFit
from inerter.identification.statements.patterns import MisfitPattern
from inerter.methods.averages import NORMAL_QUANTILE
from inerter.report.identified_values import ResultKind, result_kind, value_and_interval

Matrix = NDArray[np.float64]
_PERIODS = 4.0  # of the motion in a window that can be read
_FEWEST = 30  # samples of a window
_LAGS = 60


@dataclass(frozen=True, eq=False)
class IdentificationFigure:
    """A figure, the name of its file, its section of the page, and its caption."""

    name: str
    section: str  # "profiles", "response", or "record" and "fit" with the number of the record
    figure: Figure
    caption: str


def figures(found: IdentificationResult, answered: Responses) -> Iterator[IdentificationFigure]:
    """All figures, one after the other."""
    names = found.fit.parameters if found.explains else ()
    curves = [c for name in names if (c := _profile(found, name)) is not None]
    if curves:
        scaled = any(found.fit.settings.get(name) for name in ("force_scale", "displacement_scale"))
        yield IdentificationFigure(
            "profiles", "profiles", profile_figure(curves), _PROFILES + (_SCALED if scaled else "")
        )
    for number, (reading, comparison) in enumerate(zip(found.readings, found.fit.comparisons, strict=True)):
        end = f"-{number + 1}" if len(found.readings) > 1 else ""
        source = comparison.record.source
        received = record_figure(reading.received, comparison.record)
        yield IdentificationFigure(f"record{end}", f"record{number}", received, f"{source}, as received and as used.")
        if found.fit.localisations:
            place = found.fit.localisations[number]
            caption = f"{source}: residual force; {place.sentence}. {_MISFIT}"
            yield IdentificationFigure(
                f"misfit{end}", f"misfit{number}", misfit_figure(residual_samples(comparison, place)), caption
            )
        for name, figure, caption in _fit_figure(comparison):
            yield IdentificationFigure(f"{name}{end}", f"fit{number}", figure, f"{source}: {caption}")
    if answered.measured is not None:
        figure = response_figure(answered.measured, answered.model, answered.linear)
        yield IdentificationFigure("response", "response", figure, _response_caption(answered))


def last_periods(comparison: RecordFit) -> tuple[int, int]:
    """The samples of a few periods of the motion at the end of what was fitted."""
    used = np.flatnonzero(comparison.fitted)
    first, last = int(used[0]), int(used[-1])
    x = comparison.experiment.motion.displacement[first : last + 1]
    above = x > 0.5 * (x.max() + x.min())
    turns = max(int(np.count_nonzero(above[1:] != above[:-1])), 1)
    length = max(int(_PERIODS * 2.0 * (last - first) / turns), _FEWEST)
    return max(first, last - length), last


def residual_samples(c: RecordFit, place: Localisation) -> ResidualSamples:
    """The samples of a record that were fitted or checked, with the motion and what sensors would leave there."""
    used = c.fitted | c.checked
    motion = c.experiment.motion
    lines = [float(f.numbers["frequency"]) for f in place.patterns if f.kind is MisfitPattern.LINE]
    instants = next((f.numbers for f in place.patterns if f.kind is MisfitPattern.INSTANTS), None)
    return ResidualSamples(
        c.record.time[used], c.residual[used], motion.displacement[used], motion.velocity[used],
        (c.model - c.offset)[used], c.draws[:, used], c.record.interval, place.changes[:2], lines,
        None if instants is None else instants["at"],
    )  # fmt: skip


def _fit_figure(c: RecordFit) -> Iterator[tuple[str, Figure, str]]:
    record, (first, last) = c.record, last_periods(c)
    measured = MotionCurve("measured", record.time, record.displacement, record.force)
    model = MotionCurve("model", record.time, record.displacement, c.model)
    part = (float(record.time[first]), float(record.time[last]))
    yield "fit", time_figure(measured, model), f"the model over the measurement, {_fitted_part(c)}."
    inside = slice(max(first - 1, 0), last + 2)
    near = [MotionCurve(m.label, m.time[inside], m.displacement[inside], m.force[inside]) for m in (measured, model)]
    yield "window", time_figure(near[0], near[1], part), f"{format_range(*part, 's')} of it."
    used = np.flatnonzero(c.fitted | c.checked)
    whole = slice(int(used[0]), int(used[-1]) + 1)
    lags, correlation, bound = _autocorrelation(c.whitened)
    yield (
        "residuals",
        residual_figure(
            record.time[whole],
            np.where(c.fitted | c.checked, c.residual, np.nan)[whole],
            lags * record.interval,
            correlation,
            min(bound, 1.0),
        ),
        "what the model leaves of the force; on the right the autocorrelation of the fitted part after weighting and "
        "whitening, on which the intervals rest.",
    )
    loop = slice(first, last + 1)
    yield (
        "loops",
        loops_figure(record.displacement[loop], c.experiment.motion.velocity[loop], record.force[loop], c.model[loop]),
        f"the force over displacement and velocity, {format_range(*part, 's')}; the velocity is that of the "
        f"displacement smoothed to {format_quantity(c.experiment.motion.bandwidth, 'Hz')}.",
    )


def _fitted_part(c: RecordFit) -> str:
    if not c.checked.any():
        return "all of it fitted"
    start = float(c.record.time[int(np.flatnonzero(c.checked)[0])])
    return f"which was fitted up to {format_quantity(start, 's')} and is checked from there on"


def _autocorrelation(white: Matrix) -> tuple[Matrix, Matrix, float]:
    """Lags [samples], the autocorrelation of the residuals at them, and the bound for white noise."""
    x = np.clip(white - np.median(white), -4.0, 4.0)
    count = min(_LAGS, x.size // 4)
    square = max(float(x @ x), 1e-300)
    lags = np.arange(count + 1)
    return (
        lags.astype(float),
        np.array([float(x[k:] @ x[: x.size - k]) / square for k in lags]),
        NORMAL_QUANTILE / x.size**0.5,
    )


def _profile(found: IdentificationResult, name: str) -> ProfileCurve | None:
    parameter = found.fit.parameters[name]
    if len(parameter.profile) < 2:
        return None
    points = np.array(sorted(parameter.profile))
    ends = (points[0, 0], points[-1, 0])
    own = choose_scale([parameter.best if parameter.best > 0.01 * ends[1] else ends[1]], parameter.unit)
    value, _ = value_and_interval(found, name)
    low, high = parameter.interval
    return ProfileCurve(
        label=name,
        values=points[:, 0] * own.factor,
        rises=points[:, 1],
        interval=(low * own.factor, high * own.factor),
        unit=own.unit,
        remark="" if result_kind(found, name) is ResultKind.VALUE else value,
    )


def _response_caption(answered: Responses) -> str:
    assert answered.measured is not None
    size = format_quantity(answered.measured.amplitude, "m", 3)
    model = "" if answered.model is None else f", the model's at the same amplitude ({size} r.m.s.)"
    return f"Force over displacement: measured, corrected for the fitted sensor errors{model}, and linear."


_PROFILES = (
    "Profile likelihoods: increase of the cost of the best fit with one parameter fixed and all others fitted, over "
    "the threshold of a 95 % confidence interval. Dots were computed. A curve that remains below the line on one side "
    "has no bound there."
)
_SCALED = " Intervals are wider than the curves by the uncertainty of the scales, which no record shows."
_MISFIT = (
    "The residual is the measured force less that of the model. (a) over time, with the times at which it changes, or "
    "the largest of single samples in a window; (b) amplitude spectrum, with its isolated lines; (c) to "
    "(e) over displacement, velocity and model force, with means of bins (their axes leave out the most extreme 0.6 % "
    "of the samples, which (a) shows); (f) mean over displacement and velocity (restoring-force surface)."
)
