"""Arguments of `identify`: distinct records, and a model, which may be given by name."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from difflib import get_close_matches
from itertools import combinations

import numpy as np

from inerter.errors import IdentificationError
from inerter.formatting import format_quantity
from inerter.identification.models import MODELS
from inerter.networks.elements import Network
from inerter.records.inspection import PLAUSIBLE, extreme_sizes, questionable_units
from inerter.records.record import Record
from inerter.validation import in_message

_FEWEST = 4  # samples of two records at the same times that show that they are the same
_SOFTEST = 1.0  # [N/m] of the force over the displacement of any device
_SAME = 1e-9  # of the largest value: differences of one sample by conversion of units and formats


def checked_records(records: object) -> list[Record]:
    """The records as a list.

    Raises `IdentificationError` unless they are one record or several, of different samples: samples that count twice
    would make intervals narrower than they are. Nor may a channel have a size that no sensor reads, or displacement and
    force be in the place of each other.
    """
    given = [records] if isinstance(records, Record) else list(records) if isinstance(records, Sequence) else []
    if not given or not all(isinstance(r, Record) for r in given):
        raise IdentificationError(
            f"identify(...) requires a record or a list of records, such as [read_record('bench.csv')], got "
            f"{records!r}."
        )
    for record in given:
        for finding in extreme_sizes(record):
            raise IdentificationError(f"{record.source}: {finding.sentence}")
        _check_columns(record)
    for (i, one), (j, other) in combinations(enumerate(given, 1), 2):
        if share_samples(one, other):
            raise IdentificationError(
                f"Record {i} ({one.source}) and record {j} ({other.source}) contain the same samples, which would "
                f"count twice and make the intervals too narrow. Leave one of them out."
            )
    return given


def check_progress(progress: object) -> None:
    """Raise `IdentificationError` unless `progress` is a function or None."""
    if progress is not None and not callable(progress):
        raise IdentificationError(f"`progress` must be a function or None, got {in_message(progress)}.")


def _check_columns(record: Record) -> None:
    """Raise `IdentificationError` for a displacement of metres under a force of less than 1 N per metre."""
    travel, load = (0.5 * float(np.ptp(values)) for values in (record.displacement, record.force))
    if travel > PLAUSIBLE["displacement"] and load < _SOFTEST * travel:
        raise IdentificationError(
            f"{record.source}: the displacement has an amplitude of {format_quantity(travel, 'm', 3)} and the force "
            f"one of {format_quantity(load, 'N', 3)}, so the columns are probably swapped. Exchange displacement and "
            f"force, or correct their units."
        )


def warn_of_units(records: Sequence[Record]) -> None:
    """Warn of records whose units may be wrong, before a fit that may then take hours."""
    for record in records:
        for finding in questionable_units(record):
            warnings.warn(f"{record.source}: {finding.sentence}", UserWarning, stacklevel=3)


def share_samples(one: Record, other: Record) -> bool:
    """Whether two records are equal at all common times, as a record and a part or copy of it."""
    tick = 1e-3 * one.interval
    _, mine, its = np.intersect1d(np.round(one.time / tick), np.round(other.time / tick), return_indices=True)
    moves = mine.size >= _FEWEST and float(np.ptp(one.displacement[mine])) > 0.0
    return moves and all(
        np.allclose(a[mine], b[its], rtol=0.0, atol=_SAME * float(np.abs(a).max()))
        for a, b in ((one.displacement, other.displacement), (one.force, other.force))
    )


def model_of(model: object) -> Network:
    """The device itself, or one of `MODELS` by its name.

    Raises `IdentificationError` for anything else.
    """
    if isinstance(model, Network):
        return model
    if isinstance(model, str) and model in MODELS:
        return MODELS[model]
    close = get_close_matches(model.lower(), MODELS, n=1) if isinstance(model, str) else []
    hint = f" Did you mean {close[0]!r}?" if close else ""
    raise IdentificationError(
        f"model: unknown model {model!r}; available: {', '.join(MODELS)}.{hint} Or define a network, such as "
        f"Spring(free(1e5, 1e7, name='ks')) - Inerter(free(1, 500, name='b'))."
    )
