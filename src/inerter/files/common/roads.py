"""Section [road] of a file: its keys, the spectrum fitted to a measured profile, and the coherence of two tracks."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from textwrap import wrap
from typing import Any

from inerter.errors import RecordError
from inerter.field_metadata import fields_of
from inerter.files.common import profiles
from inerter.files.common.codec import (
    REQUIRED,
    Scalar,
    TableCodec,
    key,
    keyed_dataclass,
    keys_in,
    section,
    table_of,
    without_none,
)
from inerter.files.common.entries import TEXT, QuantityCodec, declaration_of, word
from inerter.files.common.problem import EntryError, Problem, at, invalid_entry
from inerter.files.common.suggest import some
from inerter.formatting import capital, format_number, format_quantity, format_range, format_share
from inerter.roads.spectrum import N0, POINTS, SAMPLING, RoadSpectrum, road_spectrum
from inerter.signals.coherence import Coherence
from inerter.signals.road import ROAD_CLASSES, Road, RoadShape
from inerter.validation import is_number
from inerter.vehicle.mechanism import TRACKS

EFFECT, OTHER_EFFECT, ROAD_ERROR = "road.effect", "road.other_effect", "road.error"  # variables, dimension of results
ROAD_QUANTITIES = sorted(fields_of(Road), key=lambda f: f.name != "speed")  # which comes first
_LEVEL = "level"
_FORMS = 'track = "1.5 m", level = 0.6 or wavenumber = "0.2 cycle/m"'
_ROUGH = ("roughness", "class", "profile")  # keys that say how rough a road is
_OTHER_SOURCES = 'class = "C", or profile = "road.csv"'
_OF_PROFILES = ("track", "columns", "units", "interval", "sampling")
_SIDES = tuple(filter(None, TRACKS))
_WAVINESS, _TO = 1.5, 2.5  # of profiles for which a road of waviness 2 stands without a warning
_WIDTH = 110  # of a remark
_FOLDED = 0.01  # of a line, by which it is corrected without a word
_FEWEST = 12  # bands of a line, which are an octave, without a warning


def _from_minus_one(value: Any) -> float:
    if not is_number(value) or not -1.0 <= value <= 1.0:
        raise invalid_entry(value, expected="a number from -1 to 1 without quotes, such as 0.6")
    return float(value)


_LEVELS = Scalar(_from_minus_one, lambda: {"type": "number", "minimum": -1, "maximum": 1})


@keyed_dataclass
class CoherenceTable:
    """Coherence between left and right track: of an isotropic surface, constant over frequency, or of first order."""

    track: float | None = key(
        QuantityCodec("m", if_given=True),
        "Distance between the tracks, on an isotropic surface.",
        'track = "1.5 m"',
        default=None,
        words="track of the coherence",
    )
    level: float | None = key(
        _LEVELS,
        "Coherence of the tracks (signed, not its square) at all spatial frequencies, or its limit for long waves.",
        "level = 0.6",
        default=None,
    )
    wavenumber: float | None = key(
        QuantityCodec("cycle/m", if_given=True),
        "Spatial frequency at which the first-order coherence falls to half its level.",
        'wavenumber = "0.2 cycle/m"',
        default=None,
        words="wavenumber of the coherence",
    )


def _of_one_form(values: dict[str, float]) -> dict[str, float]:
    """Values of the coherence with the defaults of its form; raises `EntryError` for none or for two forms at once."""
    names = list(values)
    if not names:
        raise EntryError(got="an empty table", expected=_FORMS)
    if "track" in values and len(names) > 1:
        raise EntryError(got=f"both {names[0]} and {names[1]}", expected="track alone, or level and wavenumber")
    return {_LEVEL: 1.0, **values} if "wavenumber" in values else values


COHERENCE = table_of(CoherenceTable, make=without_none, check=_of_one_form, about=CoherenceTable.__doc__)


@keyed_dataclass
class RoadSource:
    """Source of the roughness where the file states none: a road class, or a measured profile."""

    letter: str | None = key(
        word("a class of ISO 8608", ROAD_CLASSES),
        "Road class of ISO 8608, as an alternative to a roughness.",
        'class = "C"',
        default=None,
        name="class",
    )
    profile: str | None = key(
        TEXT,
        "File of a measured elevation profile, as an alternative to a roughness; the road is the spectrum of "
        "waviness 2 fitted to it.",
        'profile = "road.csv"',
        default=None,
    )
    track: str | None = key(
        word("a side", _SIDES),
        "Track of a profile with two tracks; default: their mean.",
        'track = "left"',
        default=None,
    )
    columns: dict[str, str | int] | None = key(
        Scalar(profiles.columns, lambda: profiles.COLUMNS_SCHEMA),
        "Columns of a profile, by name or number from 0, if they are not recognised.",
        profiles.COLUMNS_EXAMPLE,
        default=None,
    )
    units: dict[str, str] | None = key(
        Scalar(profiles.units, lambda: profiles.UNITS_SCHEMA),
        "Units of a profile whose table has none.",
        profiles.UNITS_EXAMPLE,
        default=None,
    )
    interval: float | None = key(
        QuantityCodec("m", if_given=True),
        "Distance between rows of a profile without a distance column.",
        profiles.SPACING_EXAMPLE,
        default=None,
    )
    sampling: str | None = key(
        word("a sampling", SAMPLING),
        "Heights of a profile: points (default), averages over an interval, or filtered.",
        'sampling = "filtered"',
        default=None,
    )


def _rough_in_one_way(table: Mapping[str, Any]) -> Mapping[str, Any]:
    """Table with the roughness of a class, or a placeholder until a profile is read."""
    names = [name for name in _ROUGH if name in table]
    if len(names) > 1:
        *others, last = names
        both, of = ("both ", "two") if len(names) == 2 else ("", "three")
        raise EntryError(got=f"{both}{', '.join(others)} and {last}", expected=f"one of the {of}")
    for name in _OF_PROFILES:
        if name in table and "profile" not in table:
            article = {"track": "a ", "interval": "an ", "sampling": "a "}.get(name, "")
            raise EntryError(got=f"{article}{name} but no profile", expected=f"a profile, or no {name}")
    if names in (["class"], ["profile"]):
        known = ROAD_CLASSES.get(str(table.get("class")), ROAD_CLASSES["A"])
        return {**table, "roughness": f"{known.roughness!r} m^3/cycle"}
    return table


def road_codec(*, rough: bool = True) -> TableCodec:
    """The section [road], as a dictionary of its values; with `rough` it must state a roughness or a source of it."""
    speed, roughness, *others = map(declaration_of, ROAD_QUANTITIES)
    roughness = replace(roughness, implied=_OTHER_SOURCES, default=REQUIRED if rough else None)
    return TableCodec(
        (
            *(speed, roughness, *others),
            *keys_in(RoadSource),
            section(
                "coherence",
                COHERENCE,
                "Coherence between the left and right tracks of vehicles on two tracks; identical if left out.",
                'coherence = { track = "1.5 m" }',
                None,
            ),
        ),
        before=_rough_in_one_way,
        about="Road and speed.",
    )


@dataclass(frozen=True)
class MeasuredLine:
    """Line of waviness 2 fitted to the spectrum of a profile, which represents its road, and the quality of the fit."""

    path: Path
    digest: str  # SHA-256 of the file
    side: str  # left or right; empty: of two tracks the mean
    spectrum: RoadSpectrum  # of the profile, with its own line
    reading: tuple[str, ...] = ()  # sentences about how the file was read
    sampling: str = POINTS

    @cached_property
    def road(self) -> Road:
        """The road of waviness 2, at any speed."""
        return self.spectrum.road(1.0)

    @property
    def source(self) -> str:
        """Name of the measured profile, with its track if it has several."""
        return f"the {self.side} track of {self.path.name}" if self.side else self.path.name

    @property
    def note(self) -> str:
        """Sentence on the fitted road: source, class, roughness, and the waviness and scatter of the free fit."""
        letter = self.road.iso8608_class.letter
        band = format_range(self.spectrum.lowest, self.spectrum.highest, "cycle/m", 3)
        return (
            f"the road is the spectrum of waviness 2 fitted to {self.source}: class {letter} of ISO 8608, roughness "
            f"{format_quantity(self.road.roughness, 'm^3/cycle', 6)}; a fit with free waviness to "
            f"{self.spectrum.bands} bands from {band} has a waviness of {format_number(self.spectrum.waviness, 3)}, "
            f"and the bands scatter about it by a factor of {format_number(self.spectrum.scatter, 3)}{self._correction}"
            + "".join(f". {said.rstrip('.')}" for said in self.reading)
        )

    @property
    def _correction(self) -> str:
        """Sentence on the correction for sampling [%]; empty if it is small."""
        change = 100.0 * (1.0 / self.spectrum.folded - 1.0)
        if abs(change) < 100.0 * _FOLDED:
            return ""
        what = "of points" if self.sampling == POINTS else "of averages over an interval"
        return (
            f". Elevations are taken as those {what}, in which waves shorter than two intervals appear as longer ones; "
            f"that correction is {format_share(0.01 * change, 2, '+')}. If they were filtered before sampling, state "
            'sampling = "filtered"'
        )

    @property
    def warnings(self) -> Iterator[str]:
        """Warnings on differences between the fitted and the measured road."""
        if not _WAVINESS <= self.spectrum.waviness <= _TO:
            below, above = ("smoother", "rougher") if self.spectrum.waviness > 2.0 else ("rougher", "smoother")
            yield (
                f"Beware: {self.source} has a waviness of {format_number(self.spectrum.waviness, 3)}, and the road of "
                f"the study has 2: below {format_quantity(self._same, 'cycle/m', 2)} it is {below} than the measured "
                f"one, above {above}."
            )
        if self.spectrum.bands < _FEWEST:
            yield (
                f"Beware: the road is fitted to no more than {self.spectrum.bands} bands of {self.source}, from "
                f"{format_range(self.spectrum.lowest, self.spectrum.highest, 'cycle/m', 2)}; measure a longer profile "
                f"with closer points."
            )

    @property
    def _same(self) -> float:
        """Spatial frequency at which both fitted lines are equal [cycle/m]."""
        own = self.spectrum
        return float(N0 * (own.unevenness / own.standard) ** (1.0 / (own.waviness - 2.0)))


def line_through(road: Mapping[str, Any] | None, beside: Path) -> tuple[MeasuredLine | None, list[Problem]]:
    """Line of waviness 2 fitted to the measured profile of a road, None without a profile, and its problems.

    The path of the profile is relative to the folder of the file at `beside`.
    """
    if road is None or road["profile"] is None:
        return None, []
    name, side, sampling = road["profile"], road["track"] or "", road["sampling"] or POINTS
    path = (beside.parent / name).absolute()
    try:
        if not path.is_file():
            place = "in the folder of this file" if Path(name).name == name else "as seen from this file"
            fault = "this is a folder" if path.is_dir() else f"file not found {place}"
            raise invalid_entry(name, fault=fault, expected=_PROFILE)
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        measured = profiles.read(path, road["columns"], road["units"], road["interval"])
        spectrum = road_spectrum(measured, side=side, sampling=sampling)
    except EntryError as error:
        problem = error.problem
        return None, [at(("road", "profile"), got=problem.got, fault=problem.fault, expected=problem.expected)]
    except (RecordError, OSError, ValueError) as error:  # the last: a name that no file can have
        return None, [at(("road", "profile"), str(error))]
    return MeasuredLine(path, digest, side, spectrum, measured.notes, sampling), []


_PROFILE = 'a table of distances and heights, such as profile = "road.csv"'


def remark(line: MeasuredLine | None) -> str:
    """Comment lines above the roughness that was fitted to a profile; empty without one."""
    if line is None:
        return ""
    text = (
        f"{capital(line.note)}. Results of this file have that roughness, and leave the errors of the "
        f"profile out. SHA-256 of the file: {line.digest}"
    )
    return "".join(f"# {part}\n" for part in wrap(text, _WIDTH)) + "\n"


def without_source(values: Mapping[str, Any], line: MeasuredLine | None) -> dict[str, Any]:
    """Values of a section [road] in a resolved file, with the roughness of a measured `line` if there is one."""
    own = {field.key: values[field.key] for field in ROAD_QUANTITIES}
    measured = {} if line is None else {"roughness": line.road.roughness}
    return {**own, **measured, "coherence": values["coherence"]}


def road_of(values: Mapping[str, Any], shape: RoadShape | None = None) -> Road:
    """The road of a section [road] with these values; a measured road has a `shape`."""
    own = {field.name: values[field.key] for field in ROAD_QUANTITIES}
    return Road(**own, coherence=_coherence_of(values["coherence"]), shape=shape)


def road_values(road: Road, coherence: Mapping[str, float]) -> dict[str, Any]:
    """The values of the section [road] of a road, with those of its coherence."""
    return {**{field.key: getattr(road, field.name) for field in ROAD_QUANTITIES}, "coherence": coherence or None}


def _coherence_of(values: Mapping[str, float] | None) -> Coherence | None:
    if not values:
        return None
    if "track" in values:
        return Coherence.isotropic(values["track"])
    if "wavenumber" in values:
        return Coherence.first_order(values["wavenumber"], values[_LEVEL])
    return Coherence.constant(values[_LEVEL])


def track_problems(place: tuple[str, ...], tracks: Mapping[str, str] | None) -> Iterator[Problem]:
    """Problems of a track coherence at `place`, for a vehicle whose roads lie on these `tracks`.

    Empty where `tracks` is None: the vehicle cannot be built, which is reported elsewhere.
    """
    if tracks is None:
        return
    loose = [name for name, side in tracks.items() if not side]
    if len(loose) == len(tracks):
        fault = "this vehicle has no left and right track"
        yield at(place, fault=fault, expected='a vehicle with two tracks, such as model = "full-car", or no coherence')
    elif loose:
        fault = f"{some(loose)} is on neither track"
        yield at(place, fault=fault, expected='track = "left" or "right" for each road of the vehicle')
