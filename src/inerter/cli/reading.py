"""Command-line options on reading files of measurements and on the search of an identification."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter


@dataclass(frozen=True)
class ReadingOptions:
    """Options on channels, samples and sensors; None where not given."""

    displacement: Annotated[str | None, Parameter(help="The channel of the displacement: name, or number from 0.")] = (
        None
    )
    force_channel: Annotated[str | None, Parameter(help="The channel of the force: name, or number from 0.")] = None
    time: Annotated[str | None, Parameter(help="The channel of the times: name, or number from 0.")] = None
    unit: Annotated[
        tuple[str, ...],
        Parameter(
            negative="",
            show_default=False,
            help="A unit where the file has none or a wrong one: force=kgf. Several times.",
        ),
    ] = ()
    interval: Annotated[str | None, Parameter(help='Between samples, where the file has no times: "1 ms".')] = None
    gaps: Annotated[
        str | None, Parameter(help='What missing samples are: refuse, fill, longest, or filled up to "50 ms".')
    ] = None
    trim: Annotated[str | None, Parameter(help="Seconds to use, FROM:TO.")] = None
    resample: Annotated[str | None, Parameter(help='New interval between samples: "1 ms".')] = None
    period: Annotated[str | None, Parameter(help='Of an excitation that repeats: "10 s"; else it is found.')] = None
    force_range: Annotated[str | None, Parameter(help='What the load cell can read: "981 N".')] = None
    force_bandwidth: Annotated[
        str | None, Parameter(help='Bandwidth of the load cell and its amplifier: "300 Hz".')
    ] = None
    force_noise: Annotated[
        str | None, Parameter(help='Noise of the load cell, r.m.s.: "0.5 N"; estimated from the record if left out.')
    ] = None
    displacement_noise: Annotated[
        str | None, Parameter(help='Noise of the displacement, r.m.s.: "1 um"; estimated from the record if left out.')
    ] = None
    fixture_mass: Annotated[
        str | None, Parameter(help='Mass that moves with the table between load cell and device: "2 kg +- 10 g".')
    ] = None


AS_THEY_ARE = ReadingOptions()


@dataclass(frozen=True)
class SearchOptions:
    """Options on the search and on the scales of the sensors; None where not given."""

    seed: Annotated[int | None, Parameter(help="Of the starting points; 0 if left out.")] = None
    starts: Annotated[int | None, Parameter(help="Starting points of the search, 8 or more.")] = None
    force_scale: Annotated[
        str | None, Parameter(help='True force over the reading, with standard uncertainty (k = 1): "1 +- 1 %".')
    ] = None
    displacement_scale: Annotated[str | None, Parameter(help='The same of the displacement: "1 +- 0.1 %".')] = None


AS_USUAL = SearchOptions()
