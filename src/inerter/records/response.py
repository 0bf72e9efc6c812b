"""`frequency_response` of measured records: dynamic stiffness, force over displacement, with its confidence band."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import OK, RecordError, Status, StatusKind
from inerter.formatting import format_quantity, format_share
from inerter.norms.response import frequency_response as linear_response
from inerter.records.periods import common_periods, whole_periods
from inerter.records.record import Record
from inerter.records.result import Response, format_sources, response_from_values
from inerter.records.spectra import HarmonicLines, Spectra, lines_of, welch
from inerter.systems.linear import LinearSystem
from inerter.validation import check_positive

Matrix = NDArray[np.float64]
Complex = NDArray[np.complex128]
Estimator = Literal["H1", "H2", "Hv"]
ESTIMATORS = ("H1", "H2", "Hv")
_ALIKE = 1e-4  # relative difference of periods that count as one


@overload
def frequency_response(system: LinearSystem, omega: ArrayLike, pade_order: int | None = None) -> Complex: ...
@overload
def frequency_response(
    system: Record | Sequence[Record], *, estimator: Estimator = "H1", segment: float | None = None
) -> Response: ...
def frequency_response(
    system: LinearSystem | Record | Sequence[Record],
    omega: ArrayLike | None = None,
    pade_order: int | None = None,
    *,
    estimator: Estimator = "H1",
    segment: float | None = None,
) -> Complex | Response:
    """The response of a linear system at given frequencies, or that of a rig from one or more of its records.

    **A linear system**: G(j omega), shape (len(omega), outputs, sources), omega in rad/s. Inputs of one source are one
    column, each arrival with its factor exp(-j omega delay), or with a Pade approximant for each delay between one
    arrival and the next. Infinite where omega is a pole. That of a mechanism is evaluated without rounding where its
    matrices, rounded, may be off by more than 1e-9 of it. Raises `LinearSystemError` unless omega holds finite numbers.

    **Records**: dynamic stiffness, force over displacement, as a `Response` at the frequencies of the displacement.
    Where the displacement is periodic, with `record.period` or an estimated one, amplitudes of the excited harmonics
    are averaged over whole periods before they are divided, so that noise in either channel causes no bias; the scatter
    between periods gives the band (Pintelon and Schoukens, System Identification, 2nd ed. 2012, ch. 2). For several
    records of one period, the scatter between records gives the band, which includes the effect of friction and
    backlash at different phases. Records of different periods, such as sines, are combined into one response. Where it
    is not periodic, spectra are averaged over Hann-windowed segments of `segment` seconds, by default a sixteenth of
    all the time (Welch 1967), and the band follows from the coherence and the number of averages (Bendat and Piersol,
    Random Data, 4th ed. 2010, sec. 9.2).

    `estimator` is used where more than one record or segment is averaged. "H1", the default, is unbiased under noise in
    the force, since the load cell is the noisier channel and friction adds force uncorrelated with the displacement;
    noise in the displacement makes its gain too small. "H2" is the contrary; "Hv" is their geometric mean, for equal
    noise in both.

    Raises `RecordError` for records that are too short, not uniformly sampled, or do not move.

    >>> import inerter as it, numpy as np
    >>> t = np.arange(2000) * 1e-3
    >>> moved = 1e-3 * np.sin(2 * np.pi * 5 * t)
    >>> found = it.frequency_response(it.Record(t, moved, 2e4 * moved))
    >>> found.frequency.round(9), found.gain.round(6)
    (array([5.]), array([20000.]))
    """
    if isinstance(system, Record) or (
        isinstance(system, Sequence) and system and all(isinstance(part, Record) for part in system)
    ):
        if omega is not None or pade_order is not None:
            raise RecordError("The frequencies of a record are those of its displacement: leave out omega.")
        return measured_response([system] if isinstance(system, Record) else list(system), estimator, segment)
    if not isinstance(estimator, str) or estimator != "H1" or segment is not None:
        raise RecordError("An estimator and a segment apply to records only; the response of a linear system is exact.")
    return linear_response(system, math.nan if omega is None else omega, pade_order)  # type: ignore[arg-type]


def measured_response(records: Sequence[Record], estimator: Estimator = "H1", segment: float | None = None) -> Response:
    """`frequency_response` of records."""
    _check(records)
    if estimator not in ESTIMATORS:
        raise RecordError(f"The estimator is one of {', '.join(ESTIMATORS)}, got {estimator!r}.")
    if segment is not None:
        check_positive(RecordError, "The length of a segment", segment, "s")
    periods = None if segment is not None else common_periods(records)
    if periods is None:
        found = averaged_response(records, welch(records, segment), estimator)
        return replace(found, notes=(*found.notes, *_resolution_notes(found)))
    parts = [
        _periodic_response(
            [record for record, own in zip(records, periods, strict=True) if own in group], group, estimator
        )
        for group in _group_periods(periods)
    ]
    return parts[0] if len(parts) == 1 else _join_responses(parts, records)


def averaged_response(records: Sequence[Record], spectra: Spectra, estimator: str) -> Response:
    """The response from averaged spectra."""
    if not spectra.omega.size:
        raise RecordError(
            f"{format_sources(records)}: the coherence between force and displacement is not significant. Excite more "
            f"strongly, or record longer."
        )
    coherence = spectra.coherence
    size = np.maximum(np.abs(spectra.fx), 1e-300)
    factor = {"H1": 1.0 / spectra.xx, "H2": spectra.ff / size**2, "Hv": np.sqrt(spectra.ff / spectra.xx) / size}
    value = spectra.fx * factor[estimator]
    scatter = np.sqrt((1.0 - coherence) / np.maximum(coherence, 1e-300) / (spectra.count - 1.0))
    averages = np.full(value.size, spectra.count)
    return response_from_values(records, spectra.omega, value, coherence, scatter, averages, estimator, spectra.notes)


def _periodic_response(records: Sequence[Record], group: Sequence[float], estimator: Estimator) -> Response:
    """The response of records of one period."""
    period = float(np.mean(group))
    parts = [whole_periods(record, period) for record in records]
    every = lines_of(parts)
    chosen = every.is_excited()
    if not chosen.any():
        raise RecordError(
            f"{format_sources(records)}: no harmonic of a period of {format_quantity(period, 's', 6)} exceeds the "
            f"scatter of the displacement. Check the period."
        )
    lines, left_out = every.at(chosen).without_transients()
    counts = [x.shape[0] for x in lines.displacement]
    if counts == [1]:
        raise RecordError(
            f"{format_sources(records)}: too short: one whole period of {format_quantity(period, 's', 6)}. Record two "
            f"or more: the uncertainty of the response follows from their scatter."
        )
    many = f"{counts[0]} periods" if len(counts) == 1 else f"{len(counts)} records of {min(counts)} or more periods"
    notes = [
        f"Periodic: {many} of {format_quantity(period, 's', 6)}, {chosen.sum()} of {chosen.size} harmonics excited."
    ]
    notes += [note for part in parts for note in part.notes]
    left = ("period" if n == 1 else f"{n} periods" for n in left_out if n)
    notes += [f"Left out the first {some}: transient in the force." for some in left]
    if chosen.sum() == 1:
        notes.append(_distortion(every, chosen))
    elif len(parts) == 1:
        notes.append(
            "The band covers the scatter between periods only; the effect of friction and backlash at other phases of "
            "the excitation requires several records."
        )
    status = _periodicity_status(lines.displacement, records)
    if len(parts) > 1:
        x, force = (np.array([a.mean(axis=0) for a in of]) for of in (lines.displacement, lines.force))
        found = averaged_response(records, _products(lines.omega, x, force), estimator)
        return replace(found, notes=(*notes, *found.notes), status=status)
    (x,), (force,) = lines.displacement, lines.force
    value = force.mean(axis=0) / x.mean(axis=0)
    strays = np.sum(np.abs(force - value * x) ** 2, axis=0) / (counts[0] - 1) / counts[0]
    scatter = np.sqrt(strays) / np.maximum(np.abs(force.mean(axis=0)), 1e-300)
    spectra = _products(lines.omega, x, force)
    averages = np.full(value.size, float(counts[0]))
    return response_from_values(
        records, lines.omega, value, spectra.coherence, scatter, averages, "periodic", tuple(notes), status
    )


def _products(omega: Matrix, x: Complex, force: Complex) -> Spectra:
    return Spectra(
        omega,
        np.mean(np.abs(x) ** 2, axis=0),
        np.mean(np.abs(force) ** 2, axis=0),
        np.mean(force * x.conj(), axis=0),
        float(x.shape[0]),
    )


def _distortion(lines: HarmonicLines, chosen: NDArray[np.bool_]) -> str:
    """Sentence on the harmonic distortion of a sine."""
    words = []
    at = int(np.argmax(chosen))
    for name, amplitudes in (("displacement", lines.displacement), ("force", lines.force)):
        power = np.mean([np.abs(a.mean(axis=0)) ** 2 for a in amplitudes], axis=0)[at :: at + 1]
        others = math.sqrt(power[1:].sum() / power[0]) if power[0] > 0.0 else math.inf
        third = math.sqrt(power[2] / power[0]) if power.size > 2 and power[0] > 0.0 else 0.0
        words.append(f"of the {name} {format_share(others, 2)} (the third alone {format_share(third, 2)})")
    distortion = " and ".join(words)
    return f"Sinusoidal excitation: harmonic distortion {distortion}; the response is that of the fundamental alone."


def _periodicity_status(x: Sequence[Complex], records: Sequence[Record]) -> Status:
    """Whether the displacement is the same in all periods of a record."""
    for amplitudes, record in zip(x, records, strict=True):
        mean = amplitudes.mean(axis=0)
        change = math.sqrt(float(np.mean(np.abs(amplitudes - mean) ** 2)) / float(np.mean(np.abs(mean) ** 2)))
        if change > 0.1:
            return Status(
                StatusKind.INACCURATE,
                f"the displacement of {record.source!r} changes by {format_share(change, 2)} from period to period; "
                f"check its period",
            )
    return OK


def _resolution_notes(found: Response) -> list[str]:
    """A note where the bias of the response by the resolution of the segments exceeds its band.

    The Hann window averages the response over frequencies of variance (spacing)^2 / 3, which shifts it by a sixth of
    its second difference.
    """
    value, spacing = found.value, np.diff(found.omega)
    if spacing.size < 2:
        return []
    adjacent = spacing < 1.5 * spacing.min()
    bias = np.abs(value[2:] - 2.0 * value[1:-1] + value[:-2]) / 6.0
    wide = 0.5 * (found.band[1] - found.band[0])[1:-1]
    count = int(np.sum(adjacent[1:] & adjacent[:-1] & (bias > wide)))
    if not count:
        return []
    return [f"Segments too short to resolve the response at {count} frequencies: its bias exceeds its band."]


def _join_responses(parts: Sequence[Response], records: Sequence[Record]) -> Response:
    """Responses at different frequencies as one; of one frequency, that with the most averages."""
    omega = np.concatenate([part.omega for part in parts])
    averages = np.concatenate([part.averages for part in parts])
    order = np.lexsort((-averages, omega))
    fresh = np.diff(omega[order], prepend=-1.0) > _ALIKE * omega[order]
    chosen = order[fresh]

    def all_of(name: str) -> Matrix:
        return np.asarray(np.concatenate([getattr(part, name) for part in parts], axis=-1)[..., chosen])

    return Response(
        omega=omega[chosen],
        gain=all_of("gain"),
        phase=all_of("phase"),
        coherence=all_of("coherence"),
        band=all_of("band"),
        phase_band=all_of("phase_band"),
        averages=averages[chosen],
        amplitude=math.sqrt(np.mean([part.amplitude**2 for part in parts])),
        estimator="periodic",
        source=format_sources(records),
        status=next((part.status for part in parts if not part.status.ok), OK),
        notes=tuple(f"{part.source}: {note}" for part in parts for note in part.notes),
    )


def _group_periods(periods: Sequence[float]) -> list[list[float]]:
    """Periods in groups that count as one."""
    groups: list[list[float]] = []
    for period in sorted(set(periods)):
        if groups and period <= groups[-1][0] * (1.0 + _ALIKE):
            groups[-1].append(period)
        else:
            groups.append([period])
    return groups


def _check(records: Sequence[Record]) -> None:
    for record in records:
        if not record.uniform:
            raise RecordError(
                f"The samples of {record.source!r} are not evenly spaced, as spectra require. Resample the record."
            )
        if _is_constant(record.displacement):
            raise RecordError(f"The displacement of {record.source!r} is constant, so the response is undefined.")
    if all(_is_constant(record.force) for record in records):
        raise RecordError(f"The force of {format_sources(records)} is constant, so the response is undefined.")


def _is_constant(values: Matrix) -> bool:
    return bool(np.ptp(values) <= 1e-12 * np.max(np.abs(values)))
