"""Units that were read wrongly: a force in kN taken for N has no inertance within the bounds, but a thousandth of it.

All values follow a wrong unit by powers, with the same residual, so that only an inertance outside its bounds, or other
than a known one, shows it. A regression without simulation gives the inertance; where a usual unit brings it to where
it should be, a search with that unit tells whether it explains the record.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from inerter.errors import RecordError
from inerter.formatting import format_list, format_quantity
from inerter.identification.experiment import Experiment
from inerter.identification.initial_estimate import Chain, apparent_inertance
from inerter.identification.options import FitOptions
from inerter.identification.scales import POWERS, apply_scales
from inerter.networks.elements import Free, Network
from inerter.networks.elements.roles import LinearRole
from inerter.records.record import Record
from inerter.records.remedy import Action, Remedy, Text
from inerter.records.uncertain import Uncertain
from inerter.units import STANDARD_GRAVITY

_BEYOND = 1.2  # times its bound: an inertance that no noise of the regression explains
_POUND = 0.45359237  # [kg]


@dataclass(frozen=True)
class WrongUnit:
    """A channel, its true unit and the one in which it was read, and the size of the true unit over that one."""

    role: str
    true: str
    read: str
    factor: float

    @property
    def remedy(self) -> Text:
        """What to state, where a unit of the channel says it."""
        if self.true in _ANGLES:
            return (f"the displacement for one {self.true}, the lead over one turn in this unit",)
        return (Remedy(Action.UNIT, (self.role, self.true)),)

    def correct(self, record: Record) -> Record:
        """The record read in the true unit."""
        scale = Uncertain(self.factor)
        force = self.role == "force"
        return apply_scales(record, FitOptions(force_scale=scale) if force else FitOptions(displacement_scale=scale))


_ANGLES = ("degree", "radian")
_PAIRS = (  # channel, two units, and the size of the first over that of the second; the most frequent first
    ("force", "kN", "N", 1e3),
    ("displacement", "m", "mm", 1e3),
    ("force", "kgf", "N", STANDARD_GRAVITY),
    ("displacement", "radian", "degree", 180.0 / math.pi),
    ("displacement", "inch", "mm", 25.4),
    ("force", "lbf", "N", STANDARD_GRAVITY * _POUND),
    ("displacement", "cm", "mm", 10.0),
)
WRONG_UNITS = tuple(
    unit
    for role, larger, smaller, factor in _PAIRS
    for unit in (WrongUnit(role, larger, smaller, factor), WrongUnit(role, smaller, larger, 1.0 / factor))
)


class WrongUnitError(RecordError):
    """Records that no values within the bounds explain, but others in a usual unit."""


def likely_units(
    chain: Chain | None, records: Sequence[Record], experiments: Sequence[Experiment]
) -> Iterator[tuple[WrongUnit, list[Record]]]:
    """The units that bring an implausible inertance within its bounds, each with the records read in them.

    None where the inertance of every record is within its bounds, or near a known one, or the device is no chain.
    """
    if chain is None:
        return
    total = [apparent_inertance(chain, e) for e in experiments]
    wrong = [not _is_plausible(chain, e, b) for e, b in zip(experiments, total, strict=True)]
    if not any(wrong):
        return
    for unit in WRONG_UNITS:
        column = ("force", "displacement").index(unit.role)
        by = unit.factor ** POWERS[LinearRole.MASS][column]
        parts = zip(experiments, total, wrong, strict=True)
        if all(_is_plausible(chain, e, by * b) for e, b, is_wrong in parts if is_wrong):
            yield unit, [unit.correct(r) if is_wrong else r for r, is_wrong in zip(records, wrong, strict=True)]


def _is_plausible(chain: Chain, e: Experiment, total: float) -> bool:
    """Whether an inertance with the fixture mass is that of the device, or within its bounds."""
    value, inertance = chain.inerter.value, total - (e.record.fixture_mass or 0.0)
    low, high = (value.lower, value.upper) if isinstance(value, Free) else 2 * (chain.inerter.coefficient,)
    return low / _BEYOND <= inertance <= high * _BEYOND


def wrong_unit_error(sources: Sequence[str], found: Sequence[tuple[WrongUnit, Network]]) -> WrongUnitError:
    """The error that names the units, each with the inertance of the device that explains the records with it."""
    texts = []
    for unit, device in found:
        (inertance,) = (e.coefficient for e in device.elements() if e.linear is LinearRole.MASS)
        size = format_quantity(inertance, "kg", 3)
        texts.append(f"a {unit.role} in {unit.true} that was read in {unit.read} (an inertance of {size})")
    return WrongUnitError(
        f"No values within the bounds explain {format_list([repr(source) for source in sources])}; they do with "
        f"{' or '.join(texts)}. Correct the unit, such as ",
        *found[0][0].remedy,
        ", or change the bounds.",
    )
