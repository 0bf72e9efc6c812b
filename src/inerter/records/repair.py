"""Faulty samples of a record, and the record with them interpolated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.records.dropouts import find_dropouts
from inerter.records.gaps import fill_missing_values
from inerter.records.instants import Instant, held_value_instants, joint_instants, mask_of, spike_instants
from inerter.records.record import Record
from inerter.records.slower_channels import at_readings

Mask = NDArray[np.bool_]
_ROLES = ("displacement", "force")
_WIDEST = {"displacement": 3, "force": 1}  # samples of a spike: an impact through a load cell is two or three wide
_SLOW = 0.35  # of the sampling rate: bandwidth of a load cell below which an impact takes several samples
_TALL = 0.6  # of the range of nearly all forces


@dataclass(frozen=True)
class FaultyInstants:
    """Spikes and held values of each channel, and joints between pieces, in the order of time."""

    spikes: dict[str, list[Instant]]
    held: dict[str, list[Instant]]
    joints: list[Instant]

    def mask(self, role: str, size: int) -> Mask:
        """Samples (size,) of a channel that a spike or a held value replaced."""
        return mask_of([*self.spikes[role], *self.held[role]], size)


def faulty_instants(record: Record) -> FaultyInstants:
    """The samples of displacement and force that contradict those before and after them."""
    held = _held_together(record)
    found: dict[str, list[Instant]] = {}
    for role in _ROLES:
        values = getattr(record, role)
        inside = mask_of(held[role], record.time.size)
        least = _least_spike(record) if role == "force" else 0.0
        found[role] = []
        for spike in spike_instants(values, _WIDEST[role]):
            if abs(spike.size) <= least or inside[spike.start - 1 : spike.stop + 1].any():
                continue
            if np.ptp(values[spike.start - 1 : spike.stop]) == 0.0:  # as large as the sample before: it was repeated
                held[role].append(replace(spike, start=spike.start - 1))
            else:
                found[role].append(spike)
        held[role].sort(key=lambda instant: instant.start)
    excused = mask_of([*held["displacement"], *held["force"], *found["displacement"]], record.time.size)
    for loss in find_dropouts(record):
        excused[loss.after : loss.after + 2] = True
    return FaultyInstants(found, held, joint_instants(record, excused) if record.uniform else [])


def _held_together(record: Record) -> dict[str, list[Instant]]:
    """Held values of each channel, also where only the other one shows that the recorder missed samples."""
    held = {role: held_value_instants(getattr(record, role), smooth=role == "displacement") for role in _ROLES}
    result = {}
    for role, other in zip(_ROLES, reversed(_ROLES), strict=True):
        values = getattr(record, role)
        known = mask_of(held[role], record.time.size)
        same = (i for i in held[other] if not known[i.start : i.stop].any() and np.ptp(values[i.start : i.stop]) == 0.0)
        result[role] = sorted([*held[role], *(Instant(i.start, i.stop, 0.0) for i in same)], key=lambda i: i.start)
    return result


def _least_spike(record: Record) -> float:
    """Size [N] of a spike that cannot be an impact.

    A load cell that is slow for the sampling spreads an impact over several samples. A fast one may read it in one
    sample, but then as one of the forces of which there are more.
    """
    bandwidth = record.force_bandwidth
    if bandwidth is not None and bandwidth < _SLOW / record.interval:
        return 0.0
    return _TALL * float(np.ptp(np.quantile(record.force, (0.005, 0.995))))


def repair(record: Record) -> Record:
    """The record at the readings of its slower channels, with spikes and held values interpolated by cubic splines.

    Joints between pieces are kept.
    """
    return without_faulty_samples(at_readings(record))


def without_faulty_samples(record: Record) -> Record:
    """The record with spikes and held values interpolated by cubic splines."""
    faulty = faulty_instants(record)
    changes, notes = {}, []
    for role in _ROLES:
        missing = faulty.mask(role, record.time.size)
        missing[:2] = missing[-2:] = False
        if missing.any():
            changes[role] = fill_missing_values(record.time, getattr(record, role), missing)
            notes.append(f"Spikes and held values of the {role}, interpolated: {int(missing.sum())} samples.")
    return record.with_notes(*notes, **changes)
