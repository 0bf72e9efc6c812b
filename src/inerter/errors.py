"""Exceptions of the package, the `Status` of a result, and the sources of its numerical error.

Invalid input raises where it enters. A numerical failure of one case among many is a `Status`. The error bound of a
result is the sum of its `ErrorSource`s.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from math import nan

from inerter.deprecation import warn_renamed
from inerter.statements import Severity, Statement


class InerterError(Exception, Statement):
    """Base of all errors of this package. Invalid request; the message contains a remedy.

    >>> import inerter as it
    >>> try:
    ...     it.Spring(-1.0)
    ... except it.InerterError as error:
    ...     print(type(error).__name__)
    NetworkError
    """

    severity = Severity.ERROR


class NetworkError(InerterError, ValueError):
    """Invalid element, expression or network."""


class SynthesisError(InerterError, ValueError):
    """Admittance with invalid coefficients, or one for which no network was found."""


class NotPositiveRealError(SynthesisError):
    """Admittance that no passive network has: its real part is negative at `s` [rad/s], where Re s >= 0.

    `admittance` is its value at `s` [N s/m].
    """

    def __init__(self, text: str, s: complex = nan, admittance: complex = nan) -> None:
        super().__init__(text, s, admittance)
        self.s = s
        self.admittance = admittance

    def __str__(self) -> str:
        return str(self.args[0])


class MechanismError(InerterError, ValueError):
    """Invalid vehicle or mechanism."""


class LinearSystemError(InerterError, ValueError):
    """Matrices of inconsistent shapes, or a norm that does not exist for a system."""


class PerformanceIndexError(InerterError, ValueError):
    """Performance index that is undefined for a vehicle, or has invalid settings."""


class DesignError(InerterError, ValueError):
    """Missing, unexpected or inconsistent design variables."""


class UnitError(InerterError, ValueError):
    """Quantity without a unit, with an unknown unit, or with a unit of another dimension."""


class SignalError(InerterError, ValueError):
    """Invalid signal, or a time outside its definition."""


class SimulationError(InerterError, ValueError):
    """Simulation with an invalid request."""


class RecordError(InerterError, ValueError):
    """Unusable measured record, or unusable file of one.

    Its `args` are the parts of the message: text and remedies, which the command line formats as options.
    """

    def __str__(self) -> str:
        return "".join(map(str, self.args))


class IdentificationError(InerterError, ValueError):
    """Model and records for which identification is impossible."""


class RegistryError(InerterError, ValueError):
    """Invalid entry of a registry, or a distribution whose entries cannot be loaded."""


class UnknownEntryError(RegistryError, KeyError):
    """Key without an entry in a registry."""

    def __str__(self) -> str:
        return str(self.args[0])  # a KeyError would put it in quotes


class ExportError(InerterError, ValueError):
    """Design that the format of another program cannot say, or unusable request for one."""


class StudyError(InerterError, ValueError):
    """Unusable study file or result folder."""


class WorkError(InerterError):
    """Failed computation of a valid request; completed results are kept."""

    severity = Severity.WARNING


class StatusKind(StrEnum):
    """Kind of the status of a result.

    >>> import inerter as it
    >>> it.Status().kind is it.StatusKind.OK
    True
    """

    OK = "ok"
    UNSTABLE = "unstable"
    MARGINAL = "marginal"
    DIRECT_TERM = "direct-term"
    INACCURATE = "inaccurate"
    UNBOUNDED = "unbounded"
    INFEASIBLE = "infeasible"
    FAILED = "failed"

    @property
    def severity(self) -> Severity:
        """Severity of such a status."""
        return _SEVERITIES[self]


_SEVERITIES = {  # the most severe first, also among equal severities
    StatusKind.FAILED: Severity.WARNING,
    StatusKind.INFEASIBLE: Severity.WARNING,
    StatusKind.UNSTABLE: Severity.WARNING,
    StatusKind.MARGINAL: Severity.WARNING,
    StatusKind.DIRECT_TERM: Severity.WARNING,
    StatusKind.INACCURATE: Severity.WARNING,
    StatusKind.UNBOUNDED: Severity.INFO,  # that a design is better at every value is an answer
    StatusKind.OK: Severity.INFO,
}
_RANKS = {kind: rank for rank, kind in enumerate(_SEVERITIES)}


@dataclass(frozen=True)
class Status(Statement):
    """Reliability of a result, with an explanation unless it is `ok`.

    >>> import inerter as it
    >>> undamped = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3))
    >>> found = it.evaluate(undamped, it.RideComfort(it.Road(5e-7, 25.0)), it.Norm())
    >>> found.value, found.status.ok, found.status.kind.value
    (inf, False, 'marginal')
    >>> bool(found.status)  # as `ok`
    False
    """

    kind: StatusKind = StatusKind.OK
    message: str = ""

    @property
    def ok(self) -> bool:
        """True if the result is reliable."""
        return self.kind is StatusKind.OK

    def __bool__(self) -> bool:
        """True if the result is reliable, as `ok`."""
        return self.ok

    @property
    def severity(self) -> Severity:
        """Severity of its kind."""
        return self.kind.severity

    @property
    def sentence(self) -> str:
        """The explanation; empty if there is none."""
        return self.message

    def to_json(self) -> dict[str, str]:
        """Kind and message, for answers and files."""
        return {"status": self.kind.value, "message": self.message}

    @property
    def doubt(self) -> str:
        """The status as text; empty if it is ok."""
        return "" if self.ok else str(self)

    def __str__(self) -> str:
        return self.kind.value if not self.message else f"{self.kind.value}: {self.message}"

    @staticmethod
    def parts(text: str) -> tuple[str, str]:
        """Kind and message of a status as text; for a case that was not computed, that text and no message."""
        kind, _, message = text.partition(": ")
        return kind, message


OK = Status()


@dataclass(frozen=True)
class ErrorSource:
    """Named source of numerical error with its relative `bound`.

    `shared` has the effects of an error of the road, which changes all values at once, with their signs: one, or one
    for each band of frequencies, whose root of the sum of squares is the bound. `improvement_bound` counts the
    difference of the effects on both values. It is empty for an error of this value alone.

    >>> import inerter as it
    >>> it.Estimate(2.0, "m/s^2", error_sources=(it.ErrorSource("rounding", 1e-12),)).error_bound  # relative
    1e-12
    """

    name: str
    bound: float
    shared: tuple[float, ...] = ()


def worst_of(statuses: Iterable[Status]) -> Status:
    """Status of a result that depends on several: the most severe one, the first among equals."""
    return min(statuses, key=lambda status: _RANKS[status.kind], default=OK)


def with_article(word: str) -> str:
    """A word with its indefinite article, for messages."""
    is_vowel = word[0] in "aeiou" and not word.startswith(("one", "uni"))
    return f"{'an' if is_vowel else 'a'} {word}"


_RENAMED: dict[str, type[InerterError]] = {
    "IndicatorError": PerformanceIndexError,
    "RowError": RegistryError,
    "UnknownRowError": UnknownEntryError,
}


def __getattr__(name: str) -> object:
    if name not in _RENAMED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warn_renamed(name, _RENAMED[name].__name__)
    return _RENAMED[name]
