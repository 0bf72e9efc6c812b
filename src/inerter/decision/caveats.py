"""Caveats of a verdict, in the order in which they are told; none is dropped."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from typing import TypeVar

from inerter.decision.results import DesignResult, Improvement, IndexResult, LimitResult
from inerter.errors import StatusKind
from inerter.formatting import capital, format_list
from inerter.statements import Severity, Statement

Over = Callable[[DesignResult, DesignResult], Improvement | None]
Words = TypeVar("Words", bound=Hashable)
_MOST_NAMES = 3  # of values, in a sentence


class CaveatKind(StrEnum):
    """Kind of a caveat, in the order in which caveats are told."""

    WORSE = "worse"  # another index gets worse
    CONDITION = "condition"  # the index gets worse in an operating condition
    STATUS = "status"  # a value is unreliable, infinite or missing
    LEFT_OUT = "left-out"  # a design is not valid
    TIE = "tie"  # a difference is not significant
    LIMIT = "limit"  # a limit is broken, or its quantity not known
    NEGLECTED = "neglected"  # friction or backlash that the method neglects
    IDEAL = "ideal"  # an ideal inerter that is compared with one with friction or backlash
    BOUND = "bound"  # a value is at its bound
    UNCHOSEN = "unchosen"  # a design variable has no value yet


@dataclass(frozen=True)
class Caveat(Statement):
    """Caveat of a verdict."""

    kind: CaveatKind
    text: str
    level: Severity = Severity.WARNING

    @property
    def severity(self) -> Severity:
        """Info where the verdict holds all the same."""
        return self.level

    @property
    def sentence(self) -> str:
        """The caveat in words."""
        return self.text


@dataclass(frozen=True)
class Contest:
    """Designs that are compared, those that may be the best, and the improvement of one over another."""

    designs: Sequence[DesignResult]
    winners: Sequence[DesignResult]
    over: Over
    method: str = ""  # in words
    remedy: str = ""  # method that models friction and backlash
    left_out: Sequence[str] = ()  # names of designs that are not valid
    left_out_baseline: str = ""  # of these the baseline

    @property
    def baseline(self) -> DesignResult | None:
        """Baseline among the designs."""
        return next((one for one in self.designs if one.is_baseline), None)

    @property
    def complete(self) -> list[DesignResult]:
        """Designs with a value for every design variable."""
        return [one for one in self.designs if not one.unchosen]


def caveats_of(contest: Contest) -> list[Caveat]:
    """All caveats: by kind, and by the order of the designs."""
    found = [
        *_worse(contest),
        *_worse_in_conditions(contest),
        *_statuses(contest),
        *_left_out(contest),
        *_ties(contest),
        *_limits(contest),
        *_neglect_caveats(contest),
        *_ideal_inerters(contest),
        *_bounds(contest),
        *_unchosen(contest),
    ]
    return list(dict.fromkeys(found))


def unchosen_clause(designs: Sequence[DesignResult]) -> str:
    """Clause on design variables without a value, named where they are few and the same in all designs."""
    variables = {one.unchosen for one in designs}
    names = next(iter(variables)) if len(variables) == 1 else ()
    of = f"{format_list(names)} of " if 0 < len(names) <= _MOST_NAMES else ""
    return f"No value of {of}{format_list([one.name for one in designs])} has been chosen yet"


def _worse(contest: Contest) -> Iterator[Caveat]:
    base = contest.baseline
    if base is None:
        return
    worse: dict[str, dict[str, list[str]]] = {}  # names of the designs by index and by how much they are worse
    for one in contest.winners:
        for other in one.others if one is not base else ():
            if (by := other.improvement) is not None and not by.is_equal and by.percent < 0.0:
                worse.setdefault(capital(other.words), {}).setdefault(by.size, []).append(one.name)
    for index, sizes in worse.items():
        clauses = [
            f"{format_list(names)}{'' if i else ' is' if len(names) == 1 else ' are'} {size}"
            for i, (size, names) in enumerate(sizes.items())
        ]
        yield Caveat(CaveatKind.WORSE, f"{index} gets worse: {format_list(clauses)} worse than {base.name}.")


def _worse_in_conditions(contest: Contest) -> Iterator[Caveat]:
    base = contest.baseline
    for one in contest.winners if base is not None else ():
        worse = [(name, by) for name, by in one.in_conditions if not by.is_equal and by.percent < 0.0]
        if not worse or base is None:
            continue
        if len(worse) == 1:
            text = f"{one.name} is {worse[0][1].words} than {base.name} in condition {worse[0][0]}."
        elif len(worse) <= _MOST_NAMES:
            names = format_list([f"{name} ({by.size})" for name, by in worse])
            text = f"{one.name} is worse than {base.name} in conditions {names}."
        else:
            name, by = min(worse, key=lambda each: each[1].percent)
            many = f"{len(worse)} of {len(one.in_conditions)} conditions"
            text = f"{one.name} is worse than {base.name} in {many}, by {by.size} in condition {name}."
        yield Caveat(CaveatKind.CONDITION, text)


def _statuses(contest: Contest) -> Iterator[Caveat]:
    shown = [*contest.winners, *filter(None, [contest.baseline])]
    values = [(one.name, one.goal) for one in contest.complete if one.goal.status.kind is not StatusKind.INFEASIBLE]
    values += [(one.name, other) for one in shown if not one.unchosen for other in one.others]
    by_reason: dict[tuple[str, str], list[tuple[str, IndexResult]]] = {}
    for name, result in values:
        if result.doubt(name):
            by_reason.setdefault((result.doubt(""), result.index), []).append((name, result))
    for several in by_reason.values():
        names = list(dict.fromkeys(name for name, _ in several))
        yield Caveat(CaveatKind.STATUS, several[0][1].doubt(format_list(names)))


def _left_out(contest: Contest) -> Iterator[Caveat]:
    if contest.left_out_baseline:
        text = f"The baseline {contest.left_out_baseline} is not valid: nothing is compared with it."
        yield Caveat(CaveatKind.LEFT_OUT, text)
    if others := [name for name in contest.left_out if name != contest.left_out_baseline]:
        be, rank = ("is", "it is") if len(others) == 1 else ("are", "they are")
        yield Caveat(CaveatKind.LEFT_OUT, f"{format_list(others)} {be} not valid; {rank} not ranked.")


def _ties(contest: Contest) -> Iterator[Caveat]:
    base = contest.baseline
    for other in contest.winners[2:] if base not in contest.winners else ():
        first = contest.winners[0]
        if (by := contest.over(first, other)) is not None:
            text = f"{first.name} and {other.name} are equally good too (difference {by.size})."
            yield Caveat(CaveatKind.TIE, text, Severity.INFO)
    equal = [
        (one.name, by)
        for one in contest.designs
        if one.is_ranked and one not in contest.winners and (by := one.goal.improvement) is not None and by.is_equal
    ]
    if base is not None and equal:
        largest = max((by for _, by in equal), key=lambda by: abs(by.percent))
        be, difference = ("is", "difference") if len(equal) == 1 else ("are", "differences of at most")
        names = format_list([name for name, _ in equal])
        text = f"{names} {be} no better than {base.name} ({difference} {largest.size})."
        yield Caveat(CaveatKind.TIE, text, Severity.INFO)


def _limits(contest: Contest) -> Iterator[Caveat]:
    best = min((one.goal.value for one in contest.winners), default=-1.0)
    for design in contest.complete:
        broken = [f"{one.words} ({one.value})" for one in design.limits if one.kept is False]
        if broken:
            lower = isfinite(design.goal.value) and design.goal.value < best
            text = f"{design.name} breaks {format_list(broken)}"
            text += f"; its lower {design.goal.words}, {design.goal.text}, does not count" if lower else ""
            yield Caveat(
                CaveatKind.LIMIT, f"{text}.", Severity.WARNING if lower or design.is_baseline else Severity.INFO
            )
        elif design.breaks_limit:
            reason = f": {design.goal.status.message.rstrip('.')}" if design.goal.status.message else ""
            yield Caveat(CaveatKind.LIMIT, f"{design.name} has no feasible design{reason}.")
        for one in unknown_limits(design):
            reason = f" ({one.message.rstrip('.')})" if one.message else ""
            yield Caveat(CaveatKind.LIMIT, f"Whether {design.name} keeps {one.words} is not known{reason}.")


def unknown_limits(design: DesignResult) -> list[LimitResult]:
    """Limits of which it is not known whether the design keeps them."""
    return [one for one in design.limits if one.kept is None]


def _neglect_caveats(contest: Contest) -> Iterator[Caveat]:
    for what, names in _names_by(contest.complete, lambda one: one.neglected).items():
        remedy = f"; {contest.remedy} models it" if contest.remedy else ""
        by = f" by {contest.method}" if contest.method else ""
        yield Caveat(CaveatKind.NEGLECTED, f"{capital(what)} of {format_list(names)} is neglected{by}{remedy}.")


def _ideal_inerters(contest: Contest) -> Iterator[Caveat]:
    names: dict[bool, list[str]] = {True: [], False: []}  # by whether friction or backlash is modelled
    for one in contest.complete:
        if one.has_inerter:
            names[bool(one.modelled)].append(one.name)
    if names[True] and names[False]:
        be = "inerter of {} is" if len(names[False]) == 1 else "inerters of {} are"
        have = "has" if len(names[True]) == 1 else "have"
        text = (
            f"The {be.format(format_list(names[False]))} ideal; {format_list(names[True])} {have} friction or backlash."
        )
        yield Caveat(CaveatKind.IDEAL, text)


def _bounds(contest: Contest) -> Iterator[Caveat]:
    places = _names_by(contest.winners, lambda one: one.at_bounds)
    clauses = [
        f"{at.name} of {format_list(names)}{'' if i else ' is'} at its {at.bound} bound ({at.value})"
        for i, (at, names) in enumerate(places.items())
    ]
    if clauses:
        beyond = "it" if len(clauses) == 1 else "these bounds"
        who = "design" if len({name for names in places.values() for name in names}) == 1 else "designs"
        text = f"{format_list(clauses)}; beyond {beyond} the {who} may be better."
        yield Caveat(CaveatKind.BOUND, text, Severity.INFO)


def _unchosen(contest: Contest) -> Iterator[Caveat]:
    by_variables: dict[tuple[str, ...], list[DesignResult]] = {}
    for design in contest.designs:
        if design.unchosen and contest.complete:  # else the verdict says it of all
            by_variables.setdefault(design.unchosen, []).append(design)
    for designs in by_variables.values():
        end = "it is not ranked" if len(designs) == 1 else "they are not ranked"
        yield Caveat(CaveatKind.UNCHOSEN, f"{unchosen_clause(designs)}; {end}.")


def _names_by(
    designs: Iterable[DesignResult], words: Callable[[DesignResult], Iterable[Words]]
) -> dict[Words, list[str]]:
    found: dict[Words, list[str]] = {}
    for design in designs:
        for what in words(design):
            found.setdefault(what, []).append(design.name)
    return found
