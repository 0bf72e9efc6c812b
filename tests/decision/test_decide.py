"""Verdicts on random results: what they may claim, and what they must not leave out."""

from __future__ import annotations

from dataclasses import replace
from math import inf, isfinite, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inerter.decision.caveats import CaveatKind, Over
from inerter.decision.decide import Decision, VerdictKind, decide
from inerter.decision.results import AtBound, DesignResult, Improvement, IndexResult, LimitResult
from inerter.errors import OK, Status, StatusKind

STATUSES = [OK, OK, OK, Status(StatusKind.INACCURATE, "it sticks"), Status(StatusKind.UNSTABLE, "pole at 3 rad/s")]
VALUES = st.sampled_from([1.0, 1.0 + 1e-12, 1.0003, 1.01, 1.3, 2.0, 2.5, inf, nan])
CONDITIONS = [(), (("wet", Improvement(-1.2)), ("dry", Improvement(4.0))), (("wet", Improvement(-1.2, is_tie=True)),)]
CONDITIONS.append(tuple((f"{i}", Improvement(float(i - 4))) for i in range(1, 8)))
LIMITS = st.builds(
    lambda kept, excess: LimitResult("travel", "at most 8 mm", "9 mm", kept, excess),
    st.sampled_from([True, True, False, None]),
    st.floats(0.0, 1.0),
)


def improvement(one: float, other: float, scatter: float) -> Improvement | None:
    """Improvement of a value over another, of which the difference has this standard error."""
    if not isfinite(one) or not isfinite(other):
        return None
    percent = 100.0 * (1.0 - one / other)
    return Improvement(percent, scatter or nan, is_tie=abs(percent) <= 2.0 * scatter + 1e-7)


@st.composite
def results(draw: st.DrawFn) -> tuple[list[DesignResult], Over]:
    """Designs with values, limits and statuses of every kind, compared with a baseline or without one."""
    count, scatter = draw(st.integers(1, 5)), draw(st.sampled_from([0.0, 0.0, 0.3, 20.0]))
    base = draw(st.integers(-1, count - 1))
    rows = [(draw(VALUES), draw(VALUES), draw(st.sampled_from(STATUSES))) for _ in range(count)]
    unchosen = [draw(st.sampled_from([(), (), (), ("c", "b")])) for _ in range(count)]

    def compared(i: int, k: int) -> Improvement | None:
        if base in (-1, i) or unchosen[i] or unchosen[base]:
            return None
        return improvement(rows[i][k], rows[base][k], scatter)

    designs = [
        DesignResult(
            name=f"S{i + 1}",
            goal=IndexResult("J1", "ride comfort", "m/s^2", rows[i][0], rows[i][2], improvement=compared(i, 0)),
            in_conditions=draw(st.sampled_from(CONDITIONS)) if compared(i, 0) is not None else (),
            others=(IndexResult("J3", "dynamic tyre load", "N", rows[i][1], improvement=compared(i, 1)),),
            limits=tuple(draw(st.lists(LIMITS, max_size=2))),
            unchosen=unchosen[i],
            at_bounds=draw(st.sampled_from([(), (AtBound("c", "upper", "10 kN s/m"),)])),
            neglected=draw(st.sampled_from([(), ("friction f",)])),
            is_baseline=i == base,
            n_elements=draw(st.integers(2, 4)),
        )
        for i in range(count)
    ]
    return designs, lambda one, other: improvement(one.goal.value, other.goal.value, scatter)


def kinds(decision: Decision, of: str) -> set[CaveatKind]:
    """Kinds of the caveats that name a design."""
    return {
        one.kind for one in decision.verdict.caveats if of in one.sentence.replace(",", " ").split(" than ")[0].split()
    }


@given(results())
def test_a_winner_keeps_the_limits_and_has_a_value(found: tuple[list[DesignResult], Over]) -> None:
    designs, over = found
    decision = decide(designs, over)
    for one in decision.winners:
        assert isfinite(one.goal.value)
        assert not one.unchosen
        assert all(limit.kept is not False for limit in one.limits)
    assert sorted(one.name for one in decision.designs) == sorted(one.name for one in designs)
    ranked = [one for one, rank in zip(decision.designs, decision.ranks, strict=True) if rank is not None]
    assert ranked == list(decision.designs[: len(ranked)])
    assert {one.name for one in ranked} == {one.name for one in designs if one.is_ranked}
    later = [one.goal.value for one in ranked[len(decision.winners) :]]
    assert later == sorted(later)


@given(results())
def test_an_unreliable_value_is_never_an_answer(found: tuple[list[DesignResult], Over]) -> None:
    """A doubtful value of any design that is compared makes the verdict doubtful, and is told."""
    decision = decide(*found)
    verdict = decision.verdict
    for one in decision.designs:
        if not one.unchosen and one.goal.is_doubtful and not one.breaks_limit:
            assert verdict.answer is not VerdictKind.ANSWER
        if not one.unchosen and (one.goal.is_doubtful or not isfinite(one.goal.value)):
            assert CaveatKind.STATUS in kinds(decision, one.name)
    for one in decision.winners:
        if any(limit.kept is None for limit in one.limits):
            assert verdict.answer is not VerdictKind.ANSWER
    assert (verdict.answer is VerdictKind.DOUBT) == verdict.sentence.startswith("Not certain: ")


@given(results())
def test_no_caveat_is_left_out(found: tuple[list[DesignResult], Over]) -> None:
    decision = decide(*found)
    order = [list(CaveatKind).index(one.kind) for one in decision.verdict.caveats]
    assert order == sorted(order)
    for one in decision.designs:
        told = kinds(decision, one.name)
        if one.unchosen:
            assert CaveatKind.UNCHOSEN in told or all(each.unchosen for each in decision.designs)
            continue
        assert not one.neglected or CaveatKind.NEGLECTED in told
        assert all(limit.kept for limit in one.limits) or CaveatKind.LIMIT in told
    for one in decision.winners:
        by = one.others[0].improvement
        assert not one.at_bounds or CaveatKind.BOUND in kinds(decision, one.name)
        assert by is None or by.is_equal or by.percent > 0.0 or CaveatKind.WORSE in kinds(decision, one.name)
        lost = [name for name, by in one.in_conditions if by.percent < 0.0 and not by.is_tie and not one.is_baseline]
        assert bool(lost) == (CaveatKind.CONDITION in kinds(decision, one.name))


@given(results())
def test_what_is_equally_good_is_not_called_better(found: tuple[list[DesignResult], Over]) -> None:
    designs, over = found
    decision = decide(designs, over)
    text = decision.verdict.sentence
    assert text.endswith(".")
    assert not {"nan", "None", "n/a"} & set(text.replace(",", " ").split())
    base = next((one for one in designs if one.is_baseline), None)
    for one in decision.winners:
        by = one.goal.improvement
        if base is not None and by is not None and by.is_equal:
            assert f"better than {base.name}" not in text.replace("No strut is better", "")
    if len(decision.winners) > 1 and decision.verdict.answer is not VerdictKind.NONE:
        assert "equally good" in text or " as good as " in text
    for one in decision.winners:
        by = over(min(decision.winners, key=_value), one)
        assert decision.winners[0] is one or by is None or by.is_equal


def _value(one: DesignResult) -> float:
    return one.goal.value


@given(results(), st.randoms(use_true_random=False))
def test_the_order_of_the_designs_decides_nothing(found: tuple[list[DesignResult], Over], random: object) -> None:
    """But the order of those that are equally good, and of those that are not ranked."""
    designs, over = found
    mixed = list(designs)
    random.shuffle(mixed)  # type: ignore[attr-defined]
    one, other = decide(designs, over), decide(mixed, over)
    assert {w.name for w in one.winners} == {w.name for w in other.winners}
    assert one.verdict.answer is other.verdict.answer
    assert len(one.verdict.caveats) == len(other.verdict.caveats)


def design(name: str, value: float, **more: object) -> DesignResult:
    by = more.pop("by", None)
    status = more.pop("status", OK)
    goal = IndexResult("J1", "ride comfort", "m/s^2", value, status, improvement=by)  # type: ignore[arg-type]
    return DesignResult(name, goal, **more)  # type: ignore[arg-type]


BASE = design("S1", 3.0, is_baseline=True)
BROKEN = LimitResult("suspension travel", "at most 8 mm", "8.4 mm", False, 0.05)
BETTER = Improvement(16.0, 0.02)


@pytest.mark.parametrize(
    ("designs", "answer", "sentence"),
    [
        (
            [BASE, design("S3", 2.52, by=BETTER, modelled=("friction f",))],
            VerdictKind.ANSWER,
            "S3 is 16.000 +- 0.020 % better than S1 in ride comfort (J1), with its friction.",
        ),
        (
            [BASE, design("S3", 2.52, by=BETTER, neglected=("friction f", "friction g"))],
            VerdictKind.ANSWER,
            "S3 is 16.000 +- 0.020 % better than S1 in ride comfort (J1), without its friction.",
        ),
        (
            [design("S1", 3.0, is_baseline=True, neglected=("gap g",)), design("S3", 2.52, by=BETTER)],
            VerdictKind.ANSWER,
            "S3 is 16.000 +- 0.020 % better than S1 in ride comfort (J1), without the gap of S1.",
        ),
        (
            [BASE, design("S2", 2.7, by=Improvement(10.0)), design("S3", 2.703, by=Improvement(9.9))],
            VerdictKind.ANSWER,
            "S2 and S3 are equally good (difference 0.10 +- 0.30 %) in ride comfort (J1), 10.0 % better than S1.",
        ),
        (
            [BASE, design("S2", 2.943, by=Improvement(-0.3, bound=3.0)), design("S3", 2.94, by=Improvement(2.0))],
            VerdictKind.ANSWER,
            "S2 and S3 are equally good (difference 0.10 +- 0.30 %) in ride comfort (J1); S3 is 2.0 % better than S1.",
        ),
        (
            [BASE, design("S3", 2.999, by=Improvement(0.03))],
            VerdictKind.ANSWER,
            "S3 is as good as S1 in ride comfort (J1), and no better (difference 0.0 %).",
        ),
        (
            [BASE, design("S3", 2.99, by=Improvement(0.3, bound=1.9))],
            VerdictKind.ANSWER,
            "S3 is as good as S1 in ride comfort (J1), and no better (difference 0.3 % within errors of up to 1.9 %).",
        ),
        (
            [BASE, design("S3", 2.99, by=Improvement(0.3, bound=inf))],
            VerdictKind.ANSWER,
            "S3 is as good as S1 in ride comfort (J1), and no better (difference 0.3 % within errors as large as the "
            "values).",
        ),
        (
            [BASE, design("S3", 2.94, by=Improvement(2.0, 0.1, bound=1.9))],
            VerdictKind.ANSWER,
            "S3 is 2 % better than S1 in ride comfort (J1).",
        ),
        (
            [BASE, design("S3", 3.3, by=Improvement(-10.0))],
            VerdictKind.ANSWER,
            "No strut is better than S1 in ride comfort (J1); S3, the next, is 10.0 % worse.",
        ),
        (
            [design("S1", 3.0, is_baseline=True, limits=(BROKEN,)), design("S3", 3.3, by=Improvement(-10.0))],
            VerdictKind.ANSWER,
            "S3 is best in ride comfort (J1) of the struts that satisfy the constraints, 10.0 % worse than S1, which "
            "does not satisfy them.",
        ),
        (
            [design("S1", 3.0, is_baseline=True, limits=(BROKEN,)), design("S3", 2.0, by=BETTER, limits=(BROKEN,))],
            VerdictKind.NONE,
            "No strut satisfies the constraints: S1 is the closest, with suspension travel 8.4 mm (limit: at most "
            "8 mm).",
        ),
        (
            [BASE, design("S3", 2.0, unchosen=("c", "b"))],
            VerdictKind.NONE,
            "No value of c and b of S3 has been chosen yet: choose values, or find the best ones.",
        ),
        (
            [BASE, design("S3", 2.52, by=BETTER, status=Status(StatusKind.INACCURATE, "it sticks"))],
            VerdictKind.DOUBT,
            "Not certain: S3 is 16.000 +- 0.020 % better than S1 in ride comfort (J1).",
        ),
        (
            [design("S1", nan, is_baseline=True, status=Status(StatusKind.FAILED, "no")), design("S3", 2.5)],
            VerdictKind.DOUBT,
            "Not certain: S3 is best in ride comfort (J1), 2.5 m/s^2; S1 has no finite value.",
        ),
        (
            [design("S2", 2.5), design("S3", 2.6)],
            VerdictKind.ANSWER,
            "S2 is best in ride comfort (J1), 2.5 m/s^2, 3.8 % better than S3.",
        ),
        ([BASE], VerdictKind.NONE, "Ride comfort (J1) of S1 is 3 m/s^2; there is no other strut to compare it with."),
    ],
    ids=lambda one: one.value if isinstance(one, VerdictKind) else "",
)
def test_sentences(designs: list[DesignResult], answer: VerdictKind, sentence: str) -> None:
    def over(one: DesignResult, other: DesignResult) -> Improvement | None:
        if other.is_baseline:
            return one.goal.improvement
        percent = 100.0 * (1.0 - one.goal.value / other.goal.value)
        close = 0.0 < abs(percent) < 0.2
        return Improvement(-0.1, 0.3, is_tie=True) if close else Improvement(percent)

    told = decide(designs, over).verdict
    assert (told.answer, told.sentence) == (answer, sentence)


def test_what_gets_worse_is_said_once_for_equally_good_designs() -> None:
    def worse(*percent: float) -> tuple[IndexResult, ...]:
        titles = [("J3", "dynamic tyre load"), ("J5", "dynamic load carrying")]
        pairs = zip(titles, percent, strict=False)
        return tuple(IndexResult(*of, "N", 1.0, improvement=Improvement(by)) for of, by in pairs)

    more = [("S2", worse(-4.0, -2.0)), ("S3", worse(-4.0, -3.0)), ("S4", worse(-4.0))]
    winners = [design(name, 2.5, by=Improvement(10.0), others=others) for name, others in more]
    caveats = decide([BASE, *winners], lambda one, other: Improvement(0.0, is_tie=True)).verdict.caveats
    assert [one.sentence for one in caveats if one.kind is CaveatKind.WORSE] == [
        "Dynamic tyre load (J3) gets worse: S2, S3 and S4 are 4.0 % worse than S1.",
        "Dynamic load carrying (J5) gets worse: S2 is 2.0 % and S3 3.0 % worse than S1.",
    ]


def test_ideal_inerters_beside_real_ones_are_named() -> None:
    """Friction or backlash costs part of the improvement: whoever compares a strut without any is told so."""

    def told(*rows: DesignResult) -> list[str]:
        caveats = decide([BASE, *rows], lambda one, other: Improvement(5.0)).verdict.caveats
        return [one.sentence for one in caveats if one.kind is CaveatKind.IDEAL]

    ideal = [design(f"S{i}", 2.5, has_inerter=True) for i in (2, 3)]
    real = design("S4", 2.6, has_inerter=True, modelled=("friction f",))
    relaxation = design("S5", 2.7)
    assert told(*ideal, relaxation) == told(real, relaxation) == []
    assert told(ideal[0], real) == ["The inerter of S2 is ideal; S4 has friction or backlash."]
    assert told(*ideal, real, relaxation) == ["The inerters of S2 and S3 are ideal; S4 has friction or backlash."]


def test_values_at_bounds_are_said_in_one_sentence() -> None:
    k, b = AtBound("k", "lower", "15 kN/m"), AtBound("b", "upper", "200 kg")

    def told(*at_bounds: tuple[AtBound, ...]) -> list[str]:
        winners = [
            replace(design(f"S{i}", 2.5, by=Improvement(10.0)), at_bounds=found) for i, found in enumerate(at_bounds, 2)
        ]
        caveats = decide([BASE, *winners], lambda one, other: Improvement(0.0, is_tie=True)).verdict.caveats
        return [one.sentence for one in caveats if one.kind is CaveatKind.BOUND]

    assert told((), ()) == []
    assert told((k,), ()) == ["k of S2 is at its lower bound (15 kN/m); beyond it the design may be better."]
    assert told((k,), (k,)) == ["k of S2 and S3 is at its lower bound (15 kN/m); beyond it the designs may be better."]
    assert told((k, b), (k,)) == [
        "k of S2 and S3 is at its lower bound (15 kN/m) and b of S2 at its upper bound (200 kg); beyond these bounds "
        "the designs may be better."
    ]
