"""Options of a fit, common to `identify` and `select_model`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypedDict

from inerter.deprecation import RenamedAttribute
from inerter.errors import IdentificationError, UnitError
from inerter.records.uncertain import Uncertain, parse_uncertain
from inerter.validation import check_whole, is_flag, is_number

POINTS = 128  # starts of a search


@dataclass(frozen=True)
class FitOptions:
    """The options of a fit; each is also a keyword of `identify` and `select_model`.

    The force may have one `offset` per record, and one common `gain` and `delay` (up to a number of seconds); by
    default a delay is estimated where the bandwidth of a load cell is unknown, because its filter delays slow forces.
    The last part `check` of each record is validation data, which is not fitted; `lead` [s] at the start, or as long as
    the initial state of the device matters, are not compared either. The motion is low-pass filtered at `bandwidth`
    [Hz], by default above the highest frequency that exceeds its noise floor. `starts` points are drawn from a Sobol'
    sequence with `seed`.

    `force_scale` and `displacement_scale` are true values over readings, the same in all records, with their standard
    uncertainties (k = 1), such as "1 +- 1 %": readings are multiplied by them, and intervals include the uncertainty.

    With `quadratic_damping` the device, a chain of a shaft, a gap and an inerter, has a damping in parallel with the
    inerter whose force is c2 v abs(v); its coefficient c2 [N s^2/m^2] is a parameter of the fit. No study has such an
    element.

    Raises `IdentificationError` for a `check` that is not a fraction from 0 to 0.6, fewer than 8 starts, or a scale
    that is not a positive number with an uncertainty below half of it.

    >>> options = FitOptions(seed=1).replace(gain=True)
    >>> options.seed, options.gain, options.check
    (1, True, 0.2)
    """

    seed: int = 0
    offset: bool = True
    gain: bool = False
    delay: bool | float | None = None  # [s]
    check: float = 0.2
    bandwidth: float | None = None  # [Hz]
    lead: float | None = None  # [s]
    starts: int = POINTS
    force_scale: Uncertain | None = None  # or a text such as "1 +- 1 %"
    displacement_scale: Uncertain | None = None
    quadratic_damping: bool = False

    def __post_init__(self) -> None:
        if not is_number(self.check) or not 0.0 <= self.check <= 0.6:
            raise IdentificationError(f"check: the validation fraction must be from 0 to 0.6, got {self.check!r}.")
        check_whole(IdentificationError, "starts", self.starts, 8)
        for name in ("offset", "gain", "quadratic_damping"):
            if not is_flag(getattr(self, name)):
                raise IdentificationError(f"{name} must be True or False, got {getattr(self, name)!r}.")
        for name in ("force_scale", "displacement_scale"):
            given = getattr(self, name)
            if given is not None:
                object.__setattr__(self, name, _scale(name, given))
        if self.gain and self.force_scale is not None:
            raise IdentificationError(
                "gain and force_scale exclude each other: the gain is either estimated or known. Leave out one of them."
            )

    def replace(self, **changes: object) -> FitOptions:
        """The same options with some of them replaced.

        Raises `IdentificationError` for an unknown option.
        """
        unknown = [name for name in changes if name not in OptionChanges.__annotations__]
        if unknown:
            known = ", ".join(OptionChanges.__annotations__)
            raise IdentificationError(f"unknown option {unknown[0]!r} of a fit; available: {known}.")
        return replace(self, **changes)  # type: ignore[arg-type]

    changed = RenamedAttribute("replace")


def options_of(options: object, changes: Mapping[str, object]) -> FitOptions:
    """The options with some of them replaced; raises `IdentificationError` for others, or an unknown one."""
    if not isinstance(options, FitOptions):
        raise IdentificationError(f"The options of a fit must be FitOptions(...), got {options!r}.")
    return options.replace(**changes)


def _scale(name: str, given: object) -> Uncertain:
    try:
        return parse_uncertain(given)
    except UnitError as error:
        raise IdentificationError(f"{name}: {error}") from None


DEFAULTS = FitOptions()


class OptionChanges(TypedDict, total=False):
    """The fields of `FitOptions` as keywords, for type checkers and editors."""

    seed: int
    offset: bool
    gain: bool
    delay: bool | float | None
    check: float
    bandwidth: float | None
    lead: float | None
    starts: int
    force_scale: Uncertain | str | float | None
    displacement_scale: Uncertain | str | float | None
    quadratic_damping: bool
