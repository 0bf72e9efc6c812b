"""Exceptions of the package, and the `Status` that a number carries when it is not an ordinary one.

Bad input raises, where it enters. A numerical failure of one case among many is a `Status`. What a number may be off by
is made of `ErrorSource`s.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from inerter.renamed import warn_renamed


class InerterError(Exception):
    """Base of all errors of this package: the request was wrong, and the message says how to mend it."""


class NetworkError(InerterError, ValueError):
    """An element, an expression or a network that cannot be."""


class MechanismError(InerterError, ValueError):
    """A vehicle or mechanism that cannot be assembled."""


class LinearSystemError(InerterError, ValueError):
    """Matrices that do not fit, or a norm asked of a system that does not have it."""


class PerformanceIndexError(InerterError, ValueError):
    """An index that the vehicle cannot answer, or that is set up wrongly."""


class DesignError(InerterError, ValueError):
    """Free values where none may be, none where some must be, or values that do not fit them."""


class UnitError(InerterError, ValueError):
    """A quantity without a unit, with an unknown one, or with one of another dimension."""


class SignalError(InerterError, ValueError):
    """A signal that cannot be, or that is asked for a time that it does not know."""


class SimulationError(InerterError, ValueError):
    """A simulation that cannot be run as it was asked for."""


class RecordError(InerterError, ValueError):
    """A measured record, or a file of one, that cannot be used.

    Its `args` are the parts of the message: text, and remedies, which the command line says in its own words.
    """

    def __str__(self) -> str:
        return "".join(map(str, self.args))


class IdentificationError(InerterError, ValueError):
    """A model and records from which nothing can be identified."""


class RowError(InerterError, ValueError):
    """A row that cannot stand in its table, or a distribution whose rows cannot be loaded."""


class UnknownRowError(RowError, KeyError):
    """A key that no row of a table has."""

    def __str__(self) -> str:
        return str(self.args[0])  # a KeyError would put it in quotes


class StudyError(InerterError, ValueError):
    """A study file, or a result folder, that cannot be used."""


class WorkError(InerterError):
    """The request was right, but the work could not be finished; what was computed is kept."""


class StatusKind(StrEnum):
    """What kind of number a result is."""

    OK = "ok"
    UNSTABLE = "unstable"
    MARGINAL = "marginal"
    DIRECT_TERM = "direct-term"
    INACCURATE = "inaccurate"
    UNBOUNDED = "unbounded"
    INFEASIBLE = "infeasible"
    FAILED = "failed"


@dataclass(frozen=True)
class Status:
    """How far a number can be trusted, with a sentence for the reader when it is not simply `ok`."""

    kind: StatusKind = StatusKind.OK
    message: str = ""

    @property
    def ok(self) -> bool:
        """True for an ordinary, trustworthy number."""
        return self.kind is StatusKind.OK

    def __str__(self) -> str:
        return self.kind.value if not self.message else f"{self.kind.value}: {self.message}"

    @staticmethod
    def parts(text: str) -> tuple[str, str]:
        """Kind and message of what a table holds as text; of a case that was not computed its word, and none."""
        kind, _, message = text.partition(": ")
        return kind, message


OK = Status()


@dataclass(frozen=True)
class ErrorSource:
    """A named part of the error of a number: `bound`, relative to the number, is not exceeded."""

    name: str
    bound: float


_GRAVEST_FIRST = (
    StatusKind.FAILED,
    StatusKind.INFEASIBLE,
    StatusKind.UNSTABLE,
    StatusKind.MARGINAL,
    StatusKind.DIRECT_TERM,
    StatusKind.UNBOUNDED,
    StatusKind.INACCURATE,
    StatusKind.OK,
)


def worst_of(statuses: Iterable[Status]) -> Status:
    """The status of what is made of several numbers: the gravest of theirs, the first of those that are alike."""
    return min(statuses, key=lambda status: _GRAVEST_FIRST.index(status.kind), default=OK)


def with_article(word: str) -> str:
    """A word of a message after its indefinite article."""
    is_vowel = word[0] in "aeiou" and not word.startswith(("one", "uni"))
    return f"{'an' if is_vowel else 'a'} {word}"


def __getattr__(name: str) -> object:
    if name != "IndicatorError":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warn_renamed(name, "PerformanceIndexError")
    return PerformanceIndexError
