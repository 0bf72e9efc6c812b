"""How records are to be fitted: what `identify` and `choose` share."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypedDict

from inerter.checks import is_number
from inerter.errors import IdentificationError, UnitError
from inerter.records.uncertain import Uncertain, parse_uncertain

POINTS = 128  # that a search starts from


@dataclass(frozen=True)
class FitOptions:
    """The options of a fit; every one may be given to `identify` and `choose` as a keyword of its own too.

    Sensors may have an `offset` of their own in each record, and one `gain` and one `delay` (up to a number of seconds)
    of the force in all; by default a delay is sought where the bandwidth of a load cell is not known, because that is
    what its filter does to slow forces. The last part `check` of each record is not fitted but kept to check the fit
    on; `lead` [s] at the start, or as much as the start of the device matters, are not compared either. The motion is
    smoothed below `bandwidth` [Hz], by default as far as it stands out of its noise. `starts` points are drawn from a
    Sobol sequence with `seed`.

    `force_scale` and `displacement_scale` are true values over readings, the same in all records, with their standard
    uncertainties (k = 1), such as "1 +- 1 %": readings are multiplied by them, and intervals include the uncertainty.

    Raises `IdentificationError` for a `check` that is no fraction from 0 to 0.6, fewer than 8 starts, or a scale that
    is no positive number with an uncertainty below half of it.

    >>> options = FitOptions(seed=1).changed(gain=True)
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

    def __post_init__(self) -> None:
        if not is_number(self.check) or not 0.0 <= self.check <= 0.6:
            raise IdentificationError(f"The part kept for the check is a fraction from 0 to 0.6, got {self.check!r}.")
        if isinstance(self.starts, bool) or not isinstance(self.starts, int) or self.starts < 8:
            raise IdentificationError(f"The number of starts is a whole number from 8 on, got {self.starts!r}.")
        for name in ("force_scale", "displacement_scale"):
            given = getattr(self, name)
            if given is not None:
                object.__setattr__(self, name, _scale(name, given))
        if self.gain and self.force_scale is not None:
            raise IdentificationError(
                "A gain of the load cell is fitted or its scale is known: leave out gain or force_scale."
            )

    def changed(self, **changes: object) -> FitOptions:
        """The same with some of them changed.

        Raises `IdentificationError` for one that there is not.
        """
        unknown = [name for name in changes if name not in OptionChanges.__annotations__]
        if unknown:
            known = ", ".join(OptionChanges.__annotations__)
            raise IdentificationError(f"There is no option {unknown[0]!r} of a fit (there are: {known}).")
        return replace(self, **changes)  # type: ignore[arg-type]


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
