"""Claims of the paper on curves over the static stiffness (Figures 11, 13 and 14)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, pairwise

import numpy as np

from inerter.papers.wang_su_2008.between import WORSE, Found, crossings, excess_there
from inerter.papers.wang_su_2008.judging import (
    Claim,
    ClaimPart,
    ClaimVerdict,
    EstimatedQuantity,
    Evidence,
    combined_verdict,
    everywhere,
    kilo,
    rounding_interval,
    somewhere_above,
    statement,
    within,
)
from inerter.papers.wang_su_2008.over_stiffness import Curves

_SOFT = 60e3  # [N/m] half the stiffness for which Table 1 is printed: what is called small here
_LAYOUTS = ("S2", "S3")


def elastic_claims(curves: Curves, between: Found) -> list[Claim]:
    """Claims on Figure 11: an elastic shaft alone."""
    return [Claim(1, _shrinks(curves, "J1")), _claim_2(curves, between), _claim_3(curves, between)]


def friction_claims(curves: Curves) -> list[Claim]:
    """Claims on Figures 13 and 14: friction by Method 1, alone and with an elastic shaft."""
    return [claim(curves) for claim in (_claim_4, _claim_5, _claim_8, _claim_9, _claim_10)]


def _rising(curves: Curves, names: Sequence[str], index: str) -> tuple[ClaimVerdict, list[EstimatedQuantity]]:
    """Whether each curve is nowhere below the one before it, and somewhere above; and how much higher each is."""
    gaps = [curves.uncertain_excess(higher, lower, index) for lower, higher in pairwise(names)]
    every = [gap for steps in gaps for gap in steps]
    return combined_verdict([everywhere(every, low=-WORSE), *(somewhere_above(steps, WORSE) for steps in gaps)]), every


def _where_contrary(curves: Curves, names: Sequence[str], index: str) -> str:
    """The stiffnesses at which a curve lies below the one before it, certainly or perhaps, in words."""
    gaps = [curves.uncertain_excess(higher, lower, index) for lower, higher in pairwise(names)]
    return _exceptions(curves, [[gap.times(-1.0) for gap in steps] for steps in gaps])


def _exceptions(curves: Curves, gaps: Sequence[Sequence[EstimatedQuantity]]) -> str:
    """The stiffnesses at which one of the quantities lies above `WORSE`, certainly or perhaps, in words."""
    count = sum(map(len, gaps))
    contrary = [
        any(within(g, high=WORSE, comparisons=count) is ClaimVerdict.CONTRADICTED for g in at) for at in _at(gaps)
    ]
    open_ = [any(within(g, high=WORSE) is not ClaimVerdict.SHOWN for g in at) for at in _at(gaps)]
    unsure = [o and not c for o, c in zip(open_, contrary, strict=True)]
    said = f", but not at k = {kilo(curves.k[contrary].tolist(), ', ', 0)} kN/m" if any(contrary) else ""
    return said + (f", not certain at {sum(unsure)} of {len(unsure)} stiffnesses" if any(unsure) else "")


def _at(gaps: Sequence[Sequence[EstimatedQuantity]]) -> list[tuple[EstimatedQuantity, ...]]:
    return list(zip(*gaps, strict=True))


def _percent(found: Sequence[EstimatedQuantity]) -> list[EstimatedQuantity]:
    return [one.times(100.0) for one in found]


def _shrinks(curves: Curves, index: str) -> list[ClaimPart]:
    """Whether the optimum is worse with a hard shaft than with none, and worse still with a soft one, at every k."""
    parts, base = [], curves.of("S1", index)
    for layout in _LAYOUTS:
        names = ideal, hard, soft = [layout + kind for kind in ("", "-hard", "-soft")]
        verdict, gaps = _rising(curves, names, index)
        losses = [100.0 * (curves.of(name, index) - curves.of(ideal, index)) / base for name in (hard, soft)]
        text = f"{layout}: the benefit shrinks by up to {losses[0].max():.2f} (hard) and {losses[1].max():.2f} (soft) "
        text += f"percentage points{_where_contrary(curves, names, index)}"
        parts.append(statement(text, verdict, by=_percent(gaps), at_once=len(gaps)))
    return parts


def _claim_2(curves: Curves, between: Found) -> Claim:
    parts = []
    for kind in ("soft", "hard"):
        gaps = curves.uncertain_excess(f"S3-{kind}", "S3", "J3")
        found = crossings(between, "J3", f"S3-{kind}", "S3")
        ends = [within(gaps[0], high=-WORSE), within(gaps[-1], low=WORSE)]
        least = -100.0 * min(gap.value for gap in gaps)
        text = f"{kind}: better below k = {kilo(found)} kN/m, by at most {least:.2f} %"
        once = combined_verdict(ends) if len(found) == 1 else ClaimVerdict.CONTRADICTED
        number = within(EstimatedQuantity(found[0]), *rounding_interval(120e3, curves.step)) if found else None
        parts.append(statement(text, once, number, by=_percent([gaps[0], gaps[-1]])))
    return Claim(2, parts)


def _claim_3(curves: Curves, between: Found) -> Claim:
    parts = _shrinks(curves, "J5")
    for kind in ("soft", "hard"):
        found = crossings(between, "J5", f"S3-{kind}", "S1")
        there = EstimatedQuantity(excess_there(between, "J5", f"S3-{kind}", "S1"))
        where = f", and worse from k = {kilo(found, ' to ')} kN/m" if len(found) == 2 else ""
        word = "worse" if there.value > 0.0 else "better"
        text = f"at 55 kN/m S3 {kind} is {abs(100.0 * there.value):.2f} % {word} than S1{where}"
        parts.append(statement(text, within(there, low=WORSE), by=[there.times(100.0)]))
    return Claim(3, parts)


def _claim_4(curves: Curves) -> Claim:
    parts = []
    for layout in _LAYOUTS:
        for index in ("J1", "J3"):
            names = none, ten, twenty = [layout, f"{layout}-10N", f"{layout}-20N"]
            verdict, gaps = _rising(curves, names, index)
            costs = [100.0 * curves.excess(name, none, index) for name in (ten, twenty)]
            spans = [f"{cost.min():.1f} to {cost.max():.1f} % ({f} N)" for f, cost in zip((10, 20), costs, strict=True)]
            text = f"{index} of {layout}: friction costs {' and '.join(spans)}{_where_contrary(curves, names, index)}"
            parts.append(statement(text, verdict, by=_percent(gaps), at_once=len(gaps)))
    for layout in _LAYOUTS:
        name = f"{layout}-10N"
        soft, found = curves.uncertain_excess(name, "S1", "J1")[0].times(100.0), curves.crossings(name, "S1", "J1")
        text = f"J1 of {layout} with 10 N is {_against(soft)} than S1's at k = {kilo(curves.k[:1], '', 0)} kN/m"
        text += f", and equal at k = {_crossing_text(found)} kN/m" if found else ""
        verdict = within(soft, low=100.0 * WORSE)
        parts.append(statement(text, verdict, _near(found, 15e3, curves.step), by=[soft]))
    for layout in _LAYOUTS:
        last = curves.uncertain_excess(f"{layout}-10N", "S1", "J1")[-1].times(100.0)
        text = f"J1 of {layout} with 10 N is {_against(last)} than S1's at k = {kilo(curves.k[-1:], '', 0)} kN/m"
        parts.append(statement(text, within(last, high=-100.0 * WORSE), by=[last]))
    return Claim(4, parts)


def _claim_5(curves: Curves) -> Claim:
    parts, soft = [], curves.k <= _SOFT
    for layout, index in (("S2", "J3"), ("S3", "J3"), ("S2", "J5")):
        for force in (10, 20):
            gaps = _percent(curves.uncertain_excess(f"{layout}-{force}N", "S1", index)[: int(soft.sum())])
            certain = [within(g, high=100.0 * WORSE, comparisons=len(gaps)) is ClaimVerdict.CONTRADICTED for g in gaps]
            largest = max(gaps, key=lambda gap: gap.value)
            text = f"{index} of {layout} with {force} N: not certainly worse than S1's, at most {_against(largest)}"
            if any(certain):
                at = kilo(curves.k[soft][certain].tolist(), ", ", 0)
                text = f"{index} of {layout} with {force} N: worse than S1's at k = {at} kN/m, "
                text += f"by up to {largest.value:.2f} %"
            parts.append(statement(text, somewhere_above(gaps, 100.0 * WORSE), by=gaps, at_once=len(gaps)))
    return Claim(5, parts, note=f"Evaluated up to k = {kilo([_SOFT], '', 0)} kN/m.")


def _worst(curves: Curves, layout: str, index: str) -> ClaimPart:
    """Whether a layout with friction and elasticity is nowhere better than with one or none of them."""
    both = f"{layout}-soft-10N"
    gaps = [curves.uncertain_excess(layout + kind, both, index) for kind in ("", "-10N", "-soft")]
    every = [gap for steps in gaps for gap in steps]
    text = f"{layout}: both together are the worst{_exceptions(curves, gaps) or ' at every k'}"
    return statement(text, everywhere(every, high=WORSE), by=_percent(every), at_once=len(every))


def _claim_8(curves: Curves) -> Claim:
    parts = []
    for layout, printed in (("S2", 50e3), ("S3", 150e3)):
        gaps = _percent(curves.uncertain_excess(f"{layout}-10N", f"{layout}-soft", "J1"))
        found = curves.crossings(f"{layout}-10N", f"{layout}-soft", "J1")
        text = f"{layout}: friction alone is better than elasticity alone above k = {_crossing_text(found)} kN/m"
        ends = [within(gaps[0], low=100.0 * WORSE), within(gaps[-1], high=-100.0 * WORSE)]
        once = combined_verdict(ends) if len(found) == 1 else combined_verdict([*ends, ClaimVerdict.UNDETERMINED])
        parts.append(statement(text, once, _near(found, printed, curves.step), by=[gaps[0], gaps[-1]]))
        parts.append(_worst(curves, layout, "J1"))
    return Claim(8, parts)


def _claim_9(curves: Curves) -> Claim:
    words = {"": "ideal", "-soft": "elastic", "-10N": "friction", "-soft-10N": "both"}
    printed = (
        ("S2", "below 50", curves.k < 50e3, ("", "-soft", "-10N", "-soft-10N")),
        ("S2", "above 140", curves.k > 140e3, ("", "-10N", "-soft", "-soft-10N")),
        ("S3", "below 30", curves.k < 30e3, ("-soft", "-soft-10N", "", "-10N")),
        ("S3", "above 230", curves.k > 230e3, ("", "-10N", "-soft", "-soft-10N")),
    )
    parts = []
    for layout, where, at, order in printed:
        found = curves.order([layout + kind for kind in words], "J3", at)
        steps = [within(curves.mean_excess(b, a, "J3", at), low=WORSE) for a, b in pairwise(found)]
        signs = ["<" if step is ClaimVerdict.SHOWN else "≈" for step in steps]
        line = "".join(f"{words[n.removeprefix(layout)]} {sign} " for n, sign in zip(found, [*signs, ""], strict=True))
        gaps = [curves.mean_excess(layout + b, layout + a, "J3", at) for a, b in combinations(order, 2)]
        text = f"{layout} {where} kN/m: {line.rstrip()}"
        parts.append(statement(text, everywhere(gaps, low=WORSE), by=_percent(gaps), at_once=len(gaps)))
    equal = [
        f"{layout} at k = {_crossing_text(curves.crossings(f'{layout}-10N', f'{layout}-soft', 'J3'))} kN/m"
        for layout in _LAYOUTS
    ]
    return Claim(
        9,
        parts,
        note="≈: no certain difference of more than 0.01 %. Friction alone and elasticity alone are equal in "
        f"{' and in '.join(equal)}.",
    )


def _claim_10(curves: Curves) -> Claim:
    parts = [_worst(curves, layout, "J5") for layout in _LAYOUTS]
    more = curves.uncertain_excess("S3-soft", "S3-10N", "J5")
    counts = [
        sum(within(gap.times(sign), low=WORSE, comparisons=len(more)) is ClaimVerdict.SHOWN for gap in more)
        for sign in (1.0, -1.0)
    ]
    text = (
        f"S3: elasticity certainly costs more than friction at {counts[0]} of {len(more)} stiffnesses, less at "
        f"{counts[1]}"
    )
    verdict = combined_verdict([everywhere(more, low=-WORSE), somewhere_above(more, WORSE)])
    parts.append(statement(text, verdict, by=_percent(more), at_once=len(more)))
    gaps, found = curves.uncertain_excess("S2-10N", "S2-soft", "J5"), curves.crossings("S2-10N", "S2-soft", "J5")
    below = [gap for gap, k in zip(gaps, curves.k, strict=True) if k < 140e3]
    text = f"S2: friction and elasticity cost the same at k = {_crossing_text(found, ', ')} kN/m, elasticity more above"
    verdict = combined_verdict([somewhere_above(below, WORSE), within(gaps[-1], high=-WORSE)])
    number = _near(found, 140e3, curves.step)
    parts.append(statement(text, verdict, number, by=_percent([*below, gaps[-1]]), at_once=len(below)))
    return Claim(10, parts)


def claim_13(evidence: Evidence) -> Claim:
    """The last claim, on curves and on the half car's table."""
    assert evidence.curves is not None
    curves, parts = Curves(evidence.curves), []
    for index in ("J1", "J3", "J5"):
        for layout in ("S2-soft-10N", "S3-soft-10N"):
            gaps = curves.uncertain_excess(layout, "S1", index)
            last = gaps[-1].times(100.0)
            where = f"than S1's at k = {kilo(curves.k[-1:], '', 0)} kN/m{_exceptions(curves, [gaps])}"
            text = f"{index} of {layout.split('-')[0]}: {_against(last)} {where}"
            verdict = combined_verdict([everywhere(gaps, high=WORSE), within(last, high=-100.0 * WORSE)])
            parts.append(statement(text, verdict, by=_percent(gaps), at_once=len(gaps)))
    half = [evidence.improvement(3, index, case) for index in ("J1", "J3", "J5") for case in (7, 13)]
    spread = np.array([one.value for one in half])
    text = f"half car, Method 2: {spread.min():.1f} to {spread.max():.1f} % better"
    parts.append(statement(text, everywhere(half, low=0.0), by=half, at_once=len(half)))
    return Claim(13, parts)


def _against(gap: EstimatedQuantity) -> str:
    """Difference [%] with the half-width of its 95 % confidence interval, and "worse" or "better", as text."""
    scatter = f" ± {gap.half_width():.2f}" if gap.error else ""
    return f"{abs(gap.value):.2f}{scatter} % {'worse' if gap.value > 0.0 else 'better'}"


def _crossing_text(found: Sequence[EstimatedQuantity], between: str = " and ") -> str:
    parts = [f"{c.value / 1e3:.1f}{f' ± {c.half_width() / 1e3:.1f}' if c.error else ''}" for c in found]
    return between.join(parts) or "(no crossing)"


def _near(found: Sequence[EstimatedQuantity], printed: float, step: float) -> ClaimVerdict:
    """Whether the only crossing lies at the printed stiffness, which was read off a figure in steps."""
    return within(found[0], *rounding_interval(printed, step)) if len(found) == 1 else ClaimVerdict.UNDETERMINED
