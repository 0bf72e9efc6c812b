"""The section [road] of a file: its shape, and what stands for a measured profile and for two tracks that differ."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from textwrap import wrap
from typing import Annotated, Any

from pydantic import ConfigDict, Field, model_validator

from inerter.checks import is_number
from inerter.errors import RecordError
from inerter.fields import Field as Quantity
from inerter.files.common import profiles
from inerter.files.common.entries import TEXT, positive, word
from inerter.files.common.problem import EntryError, Problem, at
from inerter.files.common.schema import checked
from inerter.files.common.suggest import some
from inerter.files.common.tables import Shape
from inerter.roads.spectrum import N0, POINTS, SAMPLING, RoadSpectrum, road_spectrum
from inerter.signals.coherence import Coherence
from inerter.signals.road import ROAD_CLASSES, Road, RoadShape
from inerter.units import format_quantity, shown
from inerter.vehicle.mechanism import TRACKS

_TRACK = Quantity("track", "m", "From track to track, of a surface as rough in every direction.", "1.5 m", "track")
_CORNER = Quantity(
    "wavenumber", "cycle/m", "Of first order: where it is half of its level.", "0.2 cycle/m", "wavenumber"
)
COHERENCE = (_TRACK, _CORNER)  # what has a unit
_LEVEL = "level"
_FORMS = 'track = "1.5 m", level = 0.6 or wavenumber = "0.2 cycle/m"'
_ROUGH = ("roughness", "class", "profile")  # keys that say how rough a road is
_OF_PROFILES = ("track", "columns", "units", "interval", "sampling")
_SIDES = tuple(filter(None, TRACKS))
_WAVINESS, _TO = 1.5, 2.5  # of profiles for which a road of waviness 2 stands without a warning
_WIDTH = 110  # of a remark
_FOLDED = 0.01  # of a line, by which it is corrected without a word
_FEWEST = 12  # bands of a line, which are an octave, without a warning


def _from_minus_one(value: Any) -> float:
    if not is_number(value) or not -1.0 <= value <= 1.0:
        raise EntryError(got=shown(value), expected="a number from -1 to 1 without quotes, such as 0.6")
    return float(value)


class CoherenceTable(Shape):
    """How alike left and right track are: as on an isotropic surface, everywhere alike, or of first order."""

    track: Annotated[float | None, positive("m")] = Field(
        default=None, description=_TRACK.sentence, examples=[f'track = "{_TRACK.example}"']
    )
    level: Annotated[
        float | None, checked(_from_minus_one, lambda: {"type": "number", "minimum": -1, "maximum": 1})
    ] = Field(default=None, description="At all wavenumbers, or in long waves.", examples=["level = 0.6"])
    wavenumber: Annotated[float | None, positive("cycle/m")] = Field(
        default=None, description=_CORNER.sentence, examples=[f'wavenumber = "{_CORNER.example}"']
    )

    @model_validator(mode="after")
    def _of_one_form(self) -> CoherenceTable:
        given = list(self.model_dump(exclude_none=True))
        if not given:
            raise EntryError(got="an empty table", expected=_FORMS)
        if self.track is not None and len(given) > 1:
            raise EntryError(got=f"both {given[0]} and {given[1]}", expected="track alone, or level and wavenumber")
        return self


class RoadTable(Shape):
    """A table [road] may say the class of a road, or a measured profile of it, in place of its roughness."""

    model_config = ConfigDict(json_schema_extra=lambda schema: schema["required"].remove("roughness"))
    letter: Annotated[str | None, word("a class of ISO 8608", ROAD_CLASSES)] = Field(
        default=None, alias="class", description="Of ISO 8608, in place of a roughness.", examples=['class = "C"']
    )
    profile: Annotated[str | None, TEXT] = Field(
        default=None,
        description="A file of measured heights, in place of a roughness: the road is the line of waviness 2 through "
        "their spectrum.",
        examples=['profile = "road.csv"'],
    )
    track: Annotated[str | None, word("a track", _SIDES)] = Field(
        default=None,
        description="Of a profile of two tracks: the one that is taken; their mean if left out.",
        examples=['track = "left"'],
    )
    columns: Annotated[dict[str, str | int] | None, checked(profiles.columns, lambda: profiles.COLUMNS_SCHEMA)] = Field(
        default=None,
        description="Of a profile: which column is which, by name or number from 0, where that is not obvious.",
        examples=[profiles.COLUMNS_EXAMPLE],
    )
    units: Annotated[dict[str, str] | None, checked(profiles.units, lambda: profiles.UNITS_SCHEMA)] = Field(
        default=None, description="Of a profile whose table has none.", examples=[profiles.UNITS_EXAMPLE]
    )
    interval: Annotated[float | None, positive("m")] = Field(
        default=None,
        description="Of a profile without distances: from row to row.",
        examples=[profiles.SPACING_EXAMPLE],
    )
    sampling: Annotated[str | None, word("a sampling", SAMPLING)] = Field(
        default=None,
        description="Of a profile: its heights are those of points (if left out), averages over an interval, or were "
        "filtered before.",
        examples=['sampling = "filtered"'],
    )
    coherence: CoherenceTable | None = Field(
        default=None,
        description="How alike left and right track are, for vehicles on two tracks; the same road if left out.",
        examples=['coherence = { track = "1.5 m" }'],
    )

    @model_validator(mode="before")
    @classmethod
    def _rough_in_one_way(cls, table: Any) -> Any:
        if not isinstance(table, dict):
            return table
        given = [key for key in _ROUGH if key in table]
        if len(given) > 1:
            *others, last = given
            both, of = ("both ", "two") if len(given) == 2 else ("", "three")
            raise EntryError(got=f"{both}{', '.join(others)} and {last}", expected=f"one of the {of}")
        for key in _OF_PROFILES:
            if key in table and "profile" not in table:
                fault = f"there is no profile that {'they are' if key in ('columns', 'units') else 'it is'} of"
                article = {"track": "a ", "interval": "an ", "sampling": "a "}.get(key, "")
                raise EntryError(got=article + key, fault=fault, expected=f"profile, or no {key}")
        if given in (["class"], ["profile"]):
            known = ROAD_CLASSES.get(str(table.get("class")), ROAD_CLASSES["A"])  # of another, or until it is read
            return {**table, "roughness": f"{known.roughness!r} m^3/cycle"}
        return table


@dataclass(frozen=True)
class MeasuredLine:
    """The line of waviness 2 through the spectrum of a profile, which stands for its road, and how well it does."""

    path: Path
    digest: str  # SHA-256 of the file
    track: str  # empty: of two tracks the mean
    roughness: float  # [m^3/cycle]
    unevenness: float  # of the profile's own line, at n0 [m^3]
    waviness: float  # of that line
    scatter: float  # of the bands about it, as a factor
    bands: int
    lowest: float  # [cycle/m]
    highest: float
    shape: RoadShape | None = None  # of the spectrum about the line of waviness 2
    reading: tuple[str, ...] = ()  # sentences about how the file was read
    sampling: str = POINTS
    folded: float = 1.0  # the line of the samples over that of the road

    @property
    def source(self) -> str:
        """What was measured."""
        return f"the {self.track} track of {self.path.name}" if self.track else self.path.name

    @property
    def note(self) -> str:
        """What stands for the road, and what the profile says of itself."""
        letter = Road(self.roughness, 1.0).iso8608_class.letter
        own = f"its own line, through {self.bands} bands from {self.lowest:.3g} to {self.highest:.3g} cycle/m,"
        return (
            f"the road is the line of waviness 2 through {self.source}, of class {letter} of ISO 8608, with "
            f"the roughness {format_quantity(self.roughness, 'm^3/cycle', 6)}; {own} "
            f"has the waviness {self.waviness:.2f} and "
            f"a scatter by a factor of {self.scatter:.2f}{self._correction}"
            + "".join(f". {said.rstrip('.')}" for said in self.reading)
        )

    @property
    def _correction(self) -> str:
        """By how much the line is another one than that of the samples; empty if by little."""
        change = 100.0 * (1.0 / self.folded - 1.0)
        if abs(change) < 100.0 * _FOLDED:
            return ""
        what = "of points" if self.sampling == POINTS else "averages over an interval"
        return (
            f". Taken as heights {what}, which show waves too that are shorter than two intervals, the line is changed "
            f'by {change:+.2g} %; if they were filtered before, say sampling = "filtered"'
        )

    @property
    def warnings(self) -> Iterator[str]:
        """Why the road may be another one."""
        if not _WAVINESS <= self.waviness <= _TO:
            below, above = ("smoother", "rougher") if self.waviness > 2.0 else ("rougher", "smoother")
            yield (
                f"Beware: {self.source} has a waviness of {self.waviness:.2f}, and the road that stands for it one of "
                f"2: below {self._same:.2g} cycle/m it is {below} than the measured one, above {above}."
            )
        if self.bands < _FEWEST:
            yield (
                f"Beware: the road stands on {self.bands} bands of {self.source} alone, from {self.lowest:.2g} to "
                f"{self.highest:.2g} cycle/m; a longer profile, with points closer together, tells more."
            )

    @property
    def _same(self) -> float:
        """Where both lines are the same [cycle/m]."""
        return float(N0 * (0.5 * self.unevenness * N0**2 / self.roughness) ** (1.0 / (self.waviness - 2.0)))


def line_through(table: RoadTable | None, beside: Path) -> tuple[MeasuredLine | None, list[Problem]]:
    """What stands for the measured profile of a road, if there is one, and what is wrong with it.

    The file is looked for beside that at `beside`.
    """
    if table is None or table.profile is None:
        return None, []
    path, track = (beside.parent / table.profile).absolute(), table.track or ""
    try:
        if not path.is_file():
            place = "beside this file" if Path(table.profile).name == table.profile else "as seen from this file"
            raise EntryError(got=shown(table.profile), fault=f"there is no such file {place}", expected=_PROFILE)
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        measured = profiles.read(path, table.columns, table.units, table.interval)
        sampling = table.sampling or POINTS
        spectrum = road_spectrum(measured, track=track, sampling=sampling)
    except EntryError as error:
        problem = error.problem
        return None, [at(("road", "profile"), got=problem.got, fault=problem.fault, expected=problem.expected)]
    except (RecordError, OSError, ValueError) as error:  # the last: a name that no file can have
        return None, [at(("road", "profile"), str(error))]
    line = _line(path, digest, track, spectrum, measured.notes)
    return replace(line, sampling=sampling), []


_PROFILE = 'a table of distances and heights, such as profile = "road.csv"'


def remark(line: MeasuredLine | None) -> str:
    """What a file says above the roughness that stands for a profile."""
    if line is None:
        return ""
    text = f"{line.note[0].upper()}{line.note[1:]}. SHA-256 of the file: {line.digest}"
    return "".join(f"# {part}\n" for part in wrap(text, _WIDTH)) + "\n"


def _line(path: Path, digest: str, track: str, spectrum: RoadSpectrum, reading: tuple[str, ...]) -> MeasuredLine:
    return MeasuredLine(
        path=path,
        digest=digest,
        track=track,
        roughness=spectrum.road(1.0).roughness,
        unevenness=spectrum.unevenness,
        waviness=spectrum.waviness,
        scatter=spectrum.scatter,
        bands=spectrum.bands,
        lowest=spectrum.lowest,
        highest=spectrum.highest,
        shape=spectrum.road(1.0).shape,
        reading=reading,
        folded=spectrum.folded,
    )


def coherence_values(table: RoadTable | None) -> dict[str, float]:
    """What a road says of its coherence, by key, with what is left out of one that has a default."""
    if table is None or table.coherence is None:
        return {}
    given: dict[str, float] = table.coherence.model_dump(exclude_none=True)
    return {_LEVEL: 1.0, **given} if "wavenumber" in given else given


def coherence_of(values: Mapping[str, float]) -> Coherence | None:
    """The coherence that such values say; None for none."""
    if not values:
        return None
    if "track" in values:
        return Coherence.isotropic(values["track"])
    if "wavenumber" in values:
        return Coherence.first_order(values["wavenumber"], values[_LEVEL])
    return Coherence.constant(values[_LEVEL])


def coherence_entry(values: Mapping[str, float]) -> dict[str, str | float]:
    """How a file says it, in SI units."""
    units = {field.key: field.unit for field in COHERENCE}
    return {key: f"{value!r} {units[key]}" if key in units else value for key, value in values.items()}


def track_problems(place: tuple[str, ...], tracks: Mapping[str, str] | None) -> Iterator[Problem]:
    """Why tracks that differ, asked for at `place`, do not suit a vehicle of whose roads these are the `tracks`.

    None if they are not known.
    """
    if tracks is None:
        return
    loose = [name for name, track in tracks.items() if not track]
    if len(loose) == len(tracks):
        fault = "this vehicle does not meet the road on a left and a right track"
        yield at(place, fault=fault, expected='one that does, such as model = "full-car", or none of it')
    elif loose:
        fault = f"{some(loose)} is on neither track"
        yield at(place, fault=fault, expected='track = "left" or "right" for each road of the vehicle')
