"""Command-line options on reading files of measurements and on the search of an identification."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter

from inerter.cli.options import Whole
from inerter.errors import StudyError


@dataclass(frozen=True)
class ReadingOptions:
    """Options on channels, samples and sensors; None where not given."""

    displacement: Annotated[str | None, Parameter(help="Displacement channel: name, or number from 0.")] = None
    force_channel: Annotated[str | None, Parameter(help="Force channel: name, or number from 0.")] = None
    time: Annotated[str | None, Parameter(help="Time channel: name, or number from 0.")] = None
    unit: Annotated[
        tuple[str, ...],
        Parameter(
            negative="",
            show_default=False,
            help="Unit of a channel if missing or wrong in the file, such as force=kgf; repeatable.",
        ),
    ] = ()
    interval: Annotated[
        str | None, Parameter(help='Sampling interval if the file has no time channel, such as "1 ms".')
    ] = None
    gaps: Annotated[
        str | None,
        Parameter(
            help='Treatment of missing samples: refuse, fill, longest, or the longest gap to fill, such as "50 ms".'
        ),
    ] = None
    trim: Annotated[str | None, Parameter(help="Time interval to use, FROM:TO in seconds.")] = None
    resample: Annotated[str | None, Parameter(help='New sampling interval, such as "1 ms".')] = None
    period: Annotated[str | None, Parameter(help='Period of the excitation, such as "10 s"; default: detected.')] = None
    force_range: Annotated[str | None, Parameter(help='Measuring range of the load cell, such as "981 N".')] = None
    force_bandwidth: Annotated[
        str | None, Parameter(help='Bandwidth of the load cell and its amplifier, such as "300 Hz".')
    ] = None
    force_noise: Annotated[
        str | None, Parameter(help='R.m.s. force noise, such as "0.5 N"; default: estimated from the record.')
    ] = None
    displacement_noise: Annotated[
        str | None, Parameter(help='R.m.s. displacement noise, such as "1 um"; default: estimated from the record.')
    ] = None
    fixture_mass: Annotated[
        str | None, Parameter(help='Fixture mass between load cell and device, such as "2 kg +- 10 g".')
    ] = None


DEFAULT_READING = ReadingOptions()


@dataclass(frozen=True)
class SearchOptions:
    """Options on the search and on the scales of the sensors; None where not given."""

    seed: Annotated[int | None, Whole, Parameter(help="Seed of the starting points; default: 0.")] = None
    starts: Annotated[int | None, Whole, Parameter(help="Number of starting points of the search, at least 8.")] = None
    force_scale: Annotated[
        str | None,
        Parameter(
            help='Scale factor of the force, true over measured, with standard uncertainty (k = 1), such as "1 +- 1 %".'
        ),
    ] = None
    displacement_scale: Annotated[
        str | None, Parameter(help='Scale factor of the displacement, true over measured, such as "1 +- 0.1 %".')
    ] = None


DEFAULT_SEARCH = SearchOptions()


def time_interval(option: str, text: str) -> tuple[float | None, float | None]:
    """Ends of a time interval FROM:TO in seconds, None for an open one; raises `StudyError` for another text."""
    begin, colon, end = text.partition(":")
    try:
        times = tuple(float(part) if part.strip() else None for part in (begin, end))
    except ValueError:
        colon = ""
    if not colon:
        raise StudyError(f'Got {option} "{text}"; expected FROM:TO in seconds, such as {option} 0.5:4.')
    return times[0], times[1]
