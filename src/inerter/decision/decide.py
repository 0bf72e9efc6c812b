"""`decide`: designs ranked by one index, and the verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from math import isfinite
from typing import Any

from inerter.decision.caveats import Caveat, Contest, Over, caveats_of, unchosen_clause, unknown_limits
from inerter.decision.of_study import remedy_of
from inerter.decision.results import DesignResult, Improvement, improvement_of, possibly_least
from inerter.formatting import capital, format_list
from inerter.methods.compare import Comparison
from inerter.methods.registry import brief_words_of
from inerter.statements import Severity, Statement

# of two designs by their numbers, in an index, in the goal also in the condition of a number; None if there is none
Compare = Callable[[int, int, str, int | None], Comparison | None]


class VerdictKind(StrEnum):
    """Reliability of a verdict."""

    ANSWER = "answer"
    DOUBT = "doubt"  # a value on which it depends is unreliable
    NONE = "none"  # no design can be called the best


@dataclass(frozen=True)
class DecisionVerdict(Statement):
    """Verdict in one sentence, with its caveats."""

    text: str
    answer: VerdictKind
    caveats: tuple[Caveat, ...] = ()

    @property
    def severity(self) -> Severity:
        """Warning unless it is an answer."""
        return Severity.INFO if self.answer is VerdictKind.ANSWER else Severity.WARNING

    @property
    def sentence(self) -> str:
        """The verdict in words."""
        return f"Not certain: {self.text}" if self.answer is VerdictKind.DOUBT else self.text

    def to_json(self) -> dict[str, Any]:
        """The verdict with its caveats as a plain dictionary."""
        caveats = [
            {"kind": one.kind.value, "sentence": one.sentence, "severity": one.severity.value} for one in self.caveats
        ]
        return {"sentence": self.sentence, "severity": self.answer.value, "caveats": caveats}


@dataclass(frozen=True)
class Decision:
    """Designs in their order, the rank of each (None if it is not ranked), the winners, and the verdict.

    Designs that are equally good as the best one share rank 1. `order` has the numbers of the designs as they were
    given.
    """

    designs: tuple[DesignResult, ...]
    order: tuple[int, ...]
    ranks: tuple[int | None, ...]
    winners: tuple[DesignResult, ...]
    verdict: DecisionVerdict


def decide_by_comparison(
    designs: Sequence[DesignResult],
    compare: Compare,
    method: str,
    conditions: Sequence[str] = (),
    left_out: Sequence[str] = (),
    left_out_baseline: str = "",
) -> Decision:
    """Decision on designs by the values of a method, with improvements over the baseline, and those in `conditions`.

    `compare` gives the comparison of two designs by their numbers.
    """
    base = next((i for i, one in enumerate(designs) if one.is_baseline), None)

    def by(i: int, index: str, condition: int | None = None) -> Improvement | None:
        found = None if base is None or i == base else improvement_of(compare(i, base, index, condition))
        return found if found is not None and isfinite(found.percent) else None

    results = [
        replace(
            one,
            goal=replace(one.goal, improvement=by(i, one.goal.index)),
            others=tuple(replace(other, improvement=by(i, other.index)) for other in one.others),
            in_conditions=tuple(
                (name, found) for c, name in enumerate(conditions) if (found := by(i, one.goal.index, c)) is not None
            ),
        )
        for i, one in enumerate(designs)
    ]
    number = {id(one): i for i, one in enumerate(results)}
    return decide(
        results,
        lambda one, other: improvement_of(compare(number[id(one)], number[id(other)], one.goal.index, None)),
        method=brief_words_of(method) if method else "",
        remedy=remedy_of(method) if method else "",
        left_out=left_out,
        left_out_baseline=left_out_baseline,
    )


def decide(
    designs: Sequence[DesignResult],
    over: Over,
    *,
    method: str = "",
    remedy: str = "",
    left_out: Sequence[str] = (),
    left_out_baseline: str = "",
) -> Decision:
    """Rank designs by the goal, and state the verdict.

    A design with a broken limit, an infinite or missing value, or a value that nobody has chosen is not ranked. `over`
    gives the improvement of one design over another, or None; it is called for the best one only. `method` is the
    method in words, `remedy` the name of one that models what it neglects; `left_out` are names of designs that are not
    valid, with the baseline if it is one of them.
    """
    ranked = sorted((one for one in designs if one.is_ranked), key=lambda one: one.goal.value)
    winners = _winners(designs, ranked, over)
    rest = [one for one in ranked if one not in winners]
    others = sorted((one for one in designs if one not in ranked), key=_order)
    contest = Contest(designs, winners, over, method, remedy, left_out, left_out_baseline)
    ranks = [*[1] * len(winners), *range(len(winners) + 1, len(ranked) + 1), *[None] * len(others)]
    ordered, places = (*winners, *rest, *others), {id(one): place for place, one in enumerate(designs)}
    order = tuple(places[id(one)] for one in ordered)
    return Decision(ordered, order, tuple(ranks), tuple(winners), _verdict(contest, rest))


def _winners(designs: Sequence[DesignResult], ranked: Sequence[DesignResult], over: Over) -> list[DesignResult]:
    """Ranked designs that may have the lowest value: the simplest first, else in the given order."""
    order = {id(one): place for place, one in enumerate(designs)}
    found = possibly_least([one.goal.value for one in ranked], lambda i, j: over(ranked[i], ranked[j]))
    return sorted((ranked[i] for i in found), key=lambda one: (one.n_elements, order[id(one)]))


def _order(design: DesignResult) -> tuple[bool, bool, float]:
    """Order of designs that are not ranked: with a broken limit, without a value, not chosen."""
    value, is_chosen = design.goal.value, not design.unchosen
    return not is_chosen, not isfinite(value), value if is_chosen and isfinite(value) else 0.0


def _verdict(contest: Contest, rest: Sequence[DesignResult]) -> DecisionVerdict:
    text, is_answer = _sentence(contest, rest)
    doubts = [one for one in contest.complete if one.goal.is_doubtful and not one.breaks_limit]
    unsure = doubts or any(map(unknown_limits, contest.winners))
    answer = VerdictKind.NONE if not is_answer else VerdictKind.DOUBT if unsure else VerdictKind.ANSWER
    return DecisionVerdict(text, answer, tuple(caveats_of(contest)))


def _sentence(contest: Contest, rest: Sequence[DesignResult]) -> tuple[str, bool]:
    """Sentence of the verdict, and whether it is an answer."""
    base, winners = contest.baseline, contest.winners
    unchosen = [one for one in contest.designs if one.unchosen]
    if unchosen and len(unchosen) == len(contest.designs):
        return f"{unchosen_clause(unchosen)}: choose values, or find the best ones.", False
    if base is not None and base.unchosen:
        return f"{unchosen_clause([base])}: nothing can be compared with it.", False
    if not winners:
        return _no_winner(contest, unchosen), False
    if len(contest.designs) == 1:
        goal, name = winners[0].goal, winners[0].name
        return f"{capital(goal.words)} of {name} is {goal.text}; there is no other strut to compare it with.", False
    if base in winners:
        return _sentence_on_baseline(contest, rest, unchosen)
    lead = winners[0]
    by = lead.goal.improvement
    if base is None or by is None or not isfinite(by.percent):
        return _sentence_without_baseline(contest, rest), True
    if base.breaks_limit and (by.is_equal or by.percent < 0.0):
        return (
            f"{_best(contest)} in {lead.goal.words} of the struts that satisfy the constraints{_friction(contest)}, "
            f"{by.than(base.name)}, which does not satisfy them.",
            True,
        )
    if len(winners) == 1:
        return f"{lead.name} is {by.words} than {base.name} in {lead.goal.words}{_friction(contest)}.", True
    if by.is_equal:  # as good as the best, which is better than the baseline
        known = [(one.name, own) for one in winners if (own := one.goal.improvement) is not None and not own.is_equal]
        better = "".join(f"; {name} is {own.words} than {base.name}" for name, own in known[:1])
        return f"{_best(contest)} in {lead.goal.words}{_friction(contest)}{better}.", True
    return f"{_best(contest)} in {lead.goal.words}, {by.words} than {base.name}{_friction(contest)}.", True


def _no_winner(contest: Contest, unchosen: Sequence[DesignResult]) -> str:
    """Sentence where no design is ranked."""
    broken = [one for one in contest.complete if one.breaks_limit]
    if broken:
        closest = min(broken, key=lambda one: one.excess)
        worst = max((one for one in closest.limits if one.kept is False), key=lambda one: one.excess, default=None)
        if worst is None:
            return f"No strut satisfies the constraints, so none is best in {closest.goal.words}."
        return (
            f"No strut satisfies the constraints: {closest.name} is the closest, with {worst.of} {worst.value} (limit: "
            f"{worst.side})."
        )
    if unchosen:
        return f"{unchosen_clause(unchosen)}: choose values, or find the best ones."
    if not contest.designs:
        return "There is no strut to compare."
    return f"No strut has a finite value of {contest.designs[0].goal.words}."


def _sentence_on_baseline(
    contest: Contest, rest: Sequence[DesignResult], unchosen: Sequence[DesignResult]
) -> tuple[str, bool]:
    """Sentence where the baseline is among the best."""
    base = next(one for one in contest.winners if one.is_baseline)
    equal, goal = [one for one in contest.winners if one is not base], base.goal.words
    if equal:
        names = [one.name for one in equal]
        verb = "is" if len(equal) == 1 else "are"
        difference = f" (difference {by.size})" if (by := _by(equal[0], base, contest.over)) is not None else ""
        return f"{format_list(names)} {verb} as good as {base.name} in {goal}, and no better{difference}.", True
    if rest:
        by = rest[0].goal.improvement
        worse = f"; {rest[0].name}, the next, is {by.words}" if by is not None and isfinite(by.percent) else ""
        return f"No strut is better than {base.name} in {goal}{worse}.", True
    if broken := [one.name for one in contest.complete if one.breaks_limit]:
        verb = "does" if len(broken) == 1 else "do"
        return f"{base.name} is the only strut that satisfies the constraints; {format_list(broken)} {verb} not.", True
    if unchosen:
        return f"{unchosen_clause(unchosen)}: choose values, or find the best ones.", False
    return f"No strut but {base.name} has a finite value of {goal}.", True


def _sentence_without_baseline(contest: Contest, rest: Sequence[DesignResult]) -> str:
    """Sentence where there is no baseline, or where it has no finite value."""
    lead, base = contest.winners[0], contest.baseline
    goal = lead.goal
    text = f"{_best(contest)} in {goal.words}{_friction(contest)}, {goal.text}"
    by = contest.over(lead, rest[0]) if rest else None
    if by is not None and isfinite(by.percent) and by.percent > 0.0:
        text += f", {by.words} than {rest[0].name}"
    if base is not None and not isfinite(base.goal.value):
        text += f"; {base.name} has no finite value"
    return f"{text}."


def _best(contest: Contest) -> str:
    """Subject and verb: the best design, or several that are equally good."""
    winners = contest.winners
    if len(winners) == 1:
        return f"{winners[0].name} is best"
    by = _by(winners[0], winners[1], contest.over)
    difference = f" (difference {by.size})" if by is not None else ""
    return f"{format_list([one.name for one in winners])} are equally good{difference}"


def _by(one: DesignResult, other: DesignResult, over: Over) -> Improvement | None:
    return one.goal.improvement if other.is_baseline else over(one, other)


def _friction(contest: Contest) -> str:
    """Clause on the friction and backlash that the values include or neglect; empty if there is none."""
    winners, base = contest.winners, contest.baseline
    whose = "its" if len(winners) == 1 else "their"
    if kinds := _kinds(words for one in winners for words in one.modelled):
        return f", with {whose} {kinds}"
    if kinds := _kinds(words for one in winners for words in one.neglected):
        return f", without {whose} {kinds}"
    kinds = _kinds(() if base is None else base.neglected)
    return f", without the {kinds} of {base.name}" if base is not None and kinds else ""


def _kinds(elements: Iterable[str]) -> str:
    """Kinds of elements in words, each once."""
    kinds = list(dict.fromkeys(words.split()[0] for words in elements))
    return format_list(kinds) if kinds else ""
