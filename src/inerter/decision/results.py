"""Results of designs that a decision compares: values, improvements over the baseline, and limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, isfinite, isnan, nan

from inerter.errors import OK, Status, StatusKind
from inerter.figures.labels import NOTICEABLE
from inerter.formatting import capital, format_percent_size, format_quantity
from inerter.indices.names import title_with_name
from inerter.methods.compare import Comparison
from inerter.methods.error_bounds import improvement_bound
from inerter.methods.method import Estimate
from inerter.methods.ties import equally_least

_LARGE_ERRORS = "errors as large as the values"


@dataclass(frozen=True)
class Improvement:
    """Improvement of one design over another in an index [%], positive where its value is lower."""

    percent: float
    error: float = nan  # standard error [%]
    bound: float = nan  # largest other error [%]
    is_tie: bool = False  # whether the difference is not significant
    status: Status = OK

    @property
    def is_equal(self) -> bool:
        """Whether neither is known to be better: its size is not significant, within its error, or rounds to 0.0 %."""
        return self.is_tie or abs(self.percent) < NOTICEABLE or abs(self.percent) <= self.bound

    @property
    def size(self) -> str:
        """Size of the difference as text, without a sign; with its largest error where that is not smaller."""
        if NOTICEABLE <= abs(self.percent) <= self.bound:
            most = f"errors of up to {format_percent_size(self.bound)}" if isfinite(self.bound) else _LARGE_ERRORS
            return f"{format_percent_size(abs(self.percent), self.error)} within {most}"
        return format_percent_size(abs(self.percent), self.error, self.bound)

    @property
    def words(self) -> str:
        """Difference in words, to follow "is" and to precede "than"."""
        size = format_percent_size(abs(self.percent), self.error, self.bound)
        return f"{size} {'better' if self.percent > 0.0 else 'worse'}"

    def than(self, other: str) -> str:
        """Comparison with the other design in words, to follow "is": "5 % better than S1", "as good as S1"."""
        if not self.is_equal:
            return f"{self.words} than {other}"
        return f"as good as {other}{f' within {_LARGE_ERRORS}' if self.bound == inf else ''}"


def improvement_of(two: Comparison | None) -> Improvement | None:
    """Improvement of the first design over the second, in per cent of its value; None without a comparison."""
    if two is None:
        return None
    one, other = two.first, two.second
    errors = one.error_bound, other.error_bound, one.shared_errors, other.shared_errors
    bound = improvement_bound(one.value, other.value, *errors)
    error = nan if one.standard_error is None else two.percent_error
    return Improvement(-two.percent, error, bound, two.is_tie, two.status)


def possibly_least(values: Sequence[float], over: Callable[[int, int], Improvement | None]) -> list[int]:
    """Numbers of the values that cannot be told from the lowest one, in their order; none that is not finite.

    `over` gives the improvement of the design of one number over that of another, or None.
    """
    equal = equally_least(values)
    best = min(equal, key=lambda i: values[i], default=None)

    def is_equal(i: int) -> bool:
        return best is not None and isfinite(values[i]) and (by := over(best, i)) is not None and by.is_equal

    return [i for i in range(len(values)) if i in equal or is_equal(i)]


def is_doubtful(value: float, status: Status) -> bool:
    """Whether a value is nan, or finite with a status that is not ok."""
    return isnan(value) or (isfinite(value) and not status.ok)


@dataclass(frozen=True)
class IndexResult:
    """Value of an index of one design, and its improvement over the baseline; None if they cannot be compared."""

    index: str
    title: str
    unit: str
    value: float
    status: Status = OK
    standard_error: float = nan
    error_bound: float = nan
    improvement: Improvement | None = None

    @classmethod
    def of(cls, index: str, title: str, estimate: Estimate) -> IndexResult:
        """Result of an estimate, not yet compared."""
        error, bound = estimate.quantity.error, estimate.error_bound
        return cls(index, title, estimate.unit, estimate.value, estimate.status, error, bound)

    @property
    def words(self) -> str:
        """Title of the index with its name."""
        return title_with_name(self.title, self.index)

    @property
    def text(self) -> str:
        """Value with unit and uncertainty."""
        return format_quantity(self.value, self.unit, error=self.standard_error, bound=self.error_bound)

    @property
    def is_doubtful(self) -> bool:
        """Whether the value is nan, or finite with a status that is not ok."""
        return is_doubtful(self.value, self.status)

    def doubt(self, of: str) -> str:
        """Sentence on a value of the design `of` that is unreliable, infinite or missing; empty for a reliable one."""
        reason = f" ({str(self.status).rstrip('.')})" if not self.status.ok else ""
        if isnan(self.value):
            return f"{capital(self.words)} of {of} is not computed{reason}."
        if not isfinite(self.value):
            return f"{capital(self.words)} of {of} is infinite{reason}."
        return f"{capital(self.words)} of {of} is unreliable{reason}." if reason else ""


@dataclass(frozen=True)
class LimitResult:
    """Limited quantity of a design: `kept` is None where its value is not known."""

    of: str  # the quantity, in words
    side: str  # "at most 8 mm"
    value: str  # text with unit
    kept: bool | None
    excess: float = inf  # logarithm of value over limit, towards the forbidden side
    message: str = ""

    @property
    def words(self) -> str:
        """Limit in words."""
        return f"{self.of} {self.side}"


@dataclass(frozen=True)
class AtBound:
    """Design variable at its lower or upper bound."""

    name: str
    bound: str  # "lower" or "upper"
    value: str  # text with unit


@dataclass(frozen=True)
class DesignResult:
    """Results of one design; `modelled` and `neglected` are its friction and gaps, by the method's support."""

    name: str
    goal: IndexResult
    others: tuple[IndexResult, ...] = ()
    in_conditions: tuple[tuple[str, Improvement], ...] = ()  # of the goal, in each of several conditions by its name
    limits: tuple[LimitResult, ...] = ()
    unchosen: tuple[str, ...] = ()
    at_bounds: tuple[AtBound, ...] = ()
    modelled: tuple[str, ...] = ()
    neglected: tuple[str, ...] = ()
    is_baseline: bool = False
    n_elements: int = 0
    has_inerter: bool = False

    @property
    def breaks_limit(self) -> bool:
        """Whether a limit is broken, or no design keeps the limits."""
        return self.goal.status.kind is StatusKind.INFEASIBLE or any(one.kept is False for one in self.limits)

    @property
    def is_ranked(self) -> bool:
        """Whether all values are chosen, no limit is broken, and the index has a finite value."""
        return not self.unchosen and not self.breaks_limit and isfinite(self.goal.value)

    @property
    def excess(self) -> float:
        """Excess of the limit that is broken most."""
        return max((one.excess for one in self.limits), default=inf)
