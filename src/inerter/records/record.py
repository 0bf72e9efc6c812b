"""A measured record: force and displacement over time, their source and their processing."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.deprecation import RenamedAttribute
from inerter.errors import RecordError
from inerter.formatting import format_alike, format_number, format_quantity, format_range
from inerter.records.remedy import Action, Remedy
from inerter.validation import is_number

Matrix = NDArray[np.float64]
CHANNELS = {"time": "s", "displacement": "m", "force": "N", "velocity": "m/s", "acceleration": "m/s^2"}
REQUIRED = ("time", "displacement", "force")
UNIFORM = 1e-3  # of an interval: times that stray less from an even spacing count as even


@dataclass(frozen=True, eq=False)
class Record:
    """Channels measured by a rig: vectors of one length over uniform or other increasing time, in SI units.

    The displacement is that of the moved end of the device; the force is positive in tension, as everywhere here.
    `notes` list the processing of the channels since they were received, one sentence each.

    Raises `RecordError` for channels that are not finite real vectors of one length of at least 4, or times that do not
    increase.

    >>> import inerter as it
    >>> import numpy as np
    >>> time = np.arange(5) * 0.01  # s
    >>> record = it.Record(time, displacement=1e-3 * time, force=2.0 * time)  # m, N
    >>> round(record.duration, 9), round(record.interval, 9)
    (0.04, 0.01)
    """

    time: Matrix  # (n,) [s]
    displacement: Matrix  # (n,) [m]
    force: Matrix  # (n,) [N]
    velocity: Matrix | None = None  # (n,) [m/s], where it was measured
    acceleration: Matrix | None = None  # (n,) [m/s^2], where it was measured
    source: str = "record"
    notes: tuple[str, ...] = ()
    force_range: float | None = None  # [N] the largest force that the load cell can read, where it is known
    force_bandwidth: float | None = None  # [Hz] of the load cell (second order, Butterworth), where it is known
    force_noise: float | None = None  # [N] r.m.s. of one sample, with what its steps add, where it is known
    displacement_noise: float | None = None  # [m] the same of the displacement
    fixture_mass: float | None = None  # [kg] of the fixture between load cell and device, moving with the table
    fixture_mass_error: float | None = None  # [kg] its standard uncertainty (k = 1), where it is known
    period: float | None = None  # [s] of the excitation, where it is known to repeat
    meta: dict[str, Any] = field(default_factory=dict)  # further contents of the file, such as its units
    further: Mapping[str, Matrix] = field(default_factory=dict)  # (n,) each: other channels by name, as a temperature

    def __post_init__(self) -> None:
        self._check_types()
        size = None
        for name in CHANNELS:
            if getattr(self, name) is None and name not in REQUIRED:
                continue
            array = _vector(f"The {name} of a record", getattr(self, name))
            size = array.size if size is None else size
            if array.size != size:
                raise RecordError(
                    f"The channels of a record must have one length; time has {size} samples, {name} {array.size}."
                )
            bad = np.flatnonzero(~np.isfinite(array))
            if bad.size:
                raise RecordError(
                    f"The {name} of {self.source!r} has {bad.size} samples that are not finite, the first at "
                    f"sample {bad[0]}. Trim them away, or read the file with ",
                    *(Remedy(Action.GAPS, "fill"), "."),
                )
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        for name, values in self.further.items():
            array = _vector(f"The further channel {name!r}", values)
            if array.shape != self.time.shape or not np.all(np.isfinite(array)):
                raise RecordError(
                    f"The further channel {name!r} must have {self.time.size} finite samples like the time; got "
                    f"shape {array.shape}."
                )
        if self.time.size < 4:
            cut = "" if self.time.size else " Is the file complete?"
            raise RecordError(f"A record must have at least 4 samples; {self.source!r} has {self.time.size}.{cut}")
        if not np.all(np.diff(self.time) > 0.0):
            at = int(np.argmax(np.diff(self.time) <= 0.0)) + 1
            raise RecordError(
                f"The times of {self.source!r} must increase, but do not at sample {at} (t = "
                f"{format_quantity(self.time[at], 's', 6)}). Where a file rounds or repeats its times, read it with ",
                *(Remedy(Action.INTERVAL), " instead."),
            )
        for name in (
            "force_range",
            "force_bandwidth",
            "force_noise",
            "displacement_noise",
            "fixture_mass",
            "fixture_mass_error",
            "period",
        ):
            value = getattr(self, name)
            if value is not None and (not is_number(value) or value <= 0.0):
                raise RecordError(f"The {name} of a record must be a positive number, got {value!r}.")

    def _check_types(self) -> None:
        """Raise `RecordError` for fields other than channels that are of another type than theirs."""
        words = isinstance(self.notes, (tuple, list)) and all(isinstance(note, str) for note in self.notes)
        for name, fits, wanted in (
            ("source", isinstance(self.source, str), "a string"),
            ("notes", words, "a tuple of strings"),
            ("meta", isinstance(self.meta, Mapping), "a mapping"),
            ("further", isinstance(self.further, Mapping), "a mapping of names to vectors"),
        ):
            if not fits:
                raise RecordError(f"The {name} of a record must be {wanted}, got {reprlib.repr(getattr(self, name))}.")

    def channels(self) -> dict[str, Matrix]:
        """All channels that there are, by name."""
        return {name: getattr(self, name) for name in CHANNELS if getattr(self, name) is not None}

    @property
    def interval(self) -> float:
        """Mean sampling interval [s]."""
        return float(self.time[-1] - self.time[0]) / (self.time.size - 1)

    @property
    def duration(self) -> float:
        """Time from the first sample to the last [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def uniform(self) -> bool:
        """Whether the samples are evenly spaced, within `UNIFORM` of an interval."""
        even = self.time[0] + self.interval * np.arange(self.time.size)
        return bool(np.max(np.abs(self.time - even)) <= UNIFORM * self.interval)

    def with_notes(self, *sentences: str, **changes: Any) -> Record:
        """The same record with changed fields, and sentences about the processing added to its notes.

        Further channels are interpolated to times that change.
        """
        if self.further and "time" in changes and "further" not in changes:
            changes["further"] = {n: np.interp(changes["time"], self.time, v) for n, v in self.further.items()}
        return replace(self, notes=(*self.notes, *sentences), **changes)

    noted = RenamedAttribute("with_notes")

    def samples(self, chosen: slice, *sentences: str) -> Record:
        """The record with some of its samples."""
        return self.with_notes(*sentences, **{name: values[chosen] for name, values in self.channels().items()})

    def trim(self, start: float | None = None, stop: float | None = None) -> Record:
        """The samples from `start` to `stop` [s], both included.

        Raises `RecordError` if fewer than 4 are left.
        """
        first, last = float(self.time[0]), float(self.time[-1])
        begin, end = (d if v is None else v for v, d in ((start, first), (stop, last)))
        for value in (begin, end):
            if not is_number(value):
                raise RecordError(f"A record is trimmed at times in s, got {value!r}.")
        slack = 1e-6 * self.interval
        a, b = np.searchsorted(self.time, [begin - slack, end + slack])
        if b - a < 4:
            span = " and ".join(format_alike([begin, end], "s", 6))
            raise RecordError(
                f"Between {span} {self.source!r} has {max(b - a, 0)} samples; it lasts from "
                f"{format_range(first, last, 's', 6)}."
            )
        return self.samples(slice(int(a), int(b)), f"Trimmed to {format_range(begin, end, 's', 6)}.")

    def split(self, fraction: float = 0.7) -> tuple[Record, Record]:
        """Estimation data, the first `fraction` of the samples, and validation data, the rest.

        Raises `RecordError` unless both parts have at least 4 samples.
        """
        if not is_number(fraction) or not 0.0 < fraction < 1.0:
            raise RecordError(f"The estimation fraction must be a number between 0 and 1; got {fraction!r}.")
        at = math.floor(fraction * self.time.size)
        if not 4 <= at <= self.time.size - 4:
            raise RecordError(
                f"A record of {self.time.size} samples cannot be split at {format_number(fraction)}: a part is too "
                f"short."
            )
        cut = float(self.time[at])
        return (
            self.samples(slice(0, at), f"Estimation data: before {format_quantity(cut, 's', 6)}."),
            self.samples(slice(at, None), f"Validation data: after {format_quantity(cut, 's', 6)}."),
        )


def scale_readings(what: str, values: Matrix, factor: float, out: Matrix | None = None) -> Matrix:
    """The values in units that are larger by `factor`.

    Raises `RecordError` where they become too large for numbers, which would look like missing samples.
    """
    try:
        with np.errstate(over="raise"):
            return np.multiply(values, factor, out=out)
    except FloatingPointError:
        raise RecordError(
            f"{what} has values that are too large when multiplied by {format_number(factor)}. Check its unit and "
            f"scale."
        ) from None


def _vector(what: str, values: object) -> Matrix:
    """The values as a vector, with nan where a masked array has none.

    Raises `RecordError` unless they are a vector of real numbers.
    """
    try:
        array = np.asarray(values)
    except ValueError:  # lists of different lengths
        array = np.asarray(None)
    if array.ndim != 1 or array.dtype.kind not in "fiu":
        got = reprlib.repr(values) if array.ndim == 0 else f"{array.dtype}, shape {array.shape}"
        raise RecordError(f"{what} must be a vector of real numbers, got {got}.")
    missing = values.mask if isinstance(values, np.ma.MaskedArray) else False
    whole: Matrix = np.ascontiguousarray(array, dtype=np.float64)
    return np.where(missing, np.nan, whole) if np.any(missing) else whole
