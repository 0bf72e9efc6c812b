"""Claims of the paper on curves over the static stiffness (Figures 11, 13 and 14)."""

from __future__ import annotations

from itertools import combinations, pairwise

from inerter.papers.wang_su_2008.between import WORSE, Found, crossings, excess_there
from inerter.papers.wang_su_2008.judging import Claim, Evidence, Statement, is_near, kilo
from inerter.papers.wang_su_2008.over_stiffness import Array, Curves, Intersection
from inerter.papers.wang_su_2008.paper import CLAIMS

_SOFT = 60e3  # [N/m] half the stiffness for which Table 1 is printed: what is called small here
_LAYOUTS = ("S2", "S3")


def elastic_claims(curves: Curves, between: Found) -> list[Claim]:
    """Claims on Figure 11: an elastic shaft alone."""
    return [_claim_1(curves), _claim_2(curves, between), _claim_3(curves, between)]


def friction_claims(curves: Curves) -> list[Claim]:
    """Claims on Figures 13 and 14: friction by Method 1, alone and with an elastic shaft."""
    return [claim(curves) for claim in (_claim_4, _claim_5, _claim_8, _claim_9, _claim_10)]


def _shrinks(curves: Curves, index: str) -> list[Statement]:
    """Whether the optimum is worse with a hard shaft than with none, and worse still with a soft one, at every k."""
    parts, base = [], curves.of("S1", index)
    for layout in _LAYOUTS:
        ideal, hard, soft = (layout + kind for kind in ("", "-hard", "-soft"))
        exceptions = curves.k[curves.worse(ideal, hard, index) | curves.worse(hard, soft, index)]
        losses = [100.0 * (curves.of(name, index) - curves.of(ideal, index)) / base for name in (hard, soft)]
        text = f"{layout}: the benefit shrinks by up to {losses[0].max():.2f} (hard) and {losses[1].max():.2f} (soft) "
        parts.append(Statement(f"{text}percentage points{_but(exceptions)}", exceptions.size == 0))
    return parts


def _claim_1(curves: Curves) -> Claim:
    return Claim(1, CLAIMS[1], tuple(_shrinks(curves, "J1")))


def _claim_2(curves: Curves, between: Found) -> Claim:
    parts = []
    for kind in ("soft", "hard"):
        excess = curves.excess(f"S3-{kind}", "S3", "J3")
        found = crossings(between, "J3", f"S3-{kind}", "S3")
        once = bool(excess[0] < 0.0 < excess[-1]) and len(found) == 1
        text = f"{kind}: better below k = {kilo(found)} kN/m, by at most {-100.0 * float(excess.min()):.2f} %"
        parts.append(Statement(text, once, once and is_near(found[0], 120e3, curves.step)))
    return Claim(2, CLAIMS[2], tuple(parts))


def _claim_3(curves: Curves, between: Found) -> Claim:
    parts = _shrinks(curves, "J5")
    for kind in ("soft", "hard"):
        found = crossings(between, "J5", f"S3-{kind}", "S1")
        there = excess_there(between, "J5", f"S3-{kind}", "S1")
        where = f", and worse from k = {kilo(found, ' to ')} kN/m" if len(found) == 2 else ""
        word = "worse" if there > 0.0 else "better"
        text = f"at 55 kN/m S3 {kind} is {abs(100.0 * there):.2f} % {word} than S1{where}"
        parts.append(Statement(text, there > WORSE))
    return Claim(3, CLAIMS[3], tuple(parts))


def _claim_4(curves: Curves) -> Claim:
    parts = []
    for layout in _LAYOUTS:
        for index in ("J1", "J3"):
            none, ten, twenty = layout, f"{layout}-10N", f"{layout}-20N"
            costs = [100.0 * curves.excess(name, none, index) for name in (ten, twenty)]
            contrary = curves.k[curves.worse(none, ten, index) | curves.worse(ten, twenty, index)]
            spans = [f"{cost.min():.1f} to {cost.max():.1f} % ({f} N)" for f, cost in zip((10, 20), costs, strict=True)]
            parts.append(
                Statement(
                    f"{index} of {layout}: friction costs {' and '.join(spans)}{_but(contrary)}", contrary.size == 0
                )
            )
    for layout in _LAYOUTS:
        name = f"{layout}-10N"
        found, soft = curves.crossings(name, "S1", "J1"), bool(curves.worse(name, "S1", "J1")[0])
        where = f"worse than S1's up to k = {_at(found)} kN/m" if soft else "not certainly worse than S1's at small k"
        once = soft and len(found) == 1
        parts.append(
            Statement(f"J1 of {layout} with 10 N is {where}", once, once and _is_at(found[0], 15e3, curves.step))
        )
    for layout in _LAYOUTS:
        name = f"{layout}-10N"
        last = -100.0 * curves.excess(name, "S1", "J1")[-1]
        text = f"J1 of {layout} with 10 N is {last:.1f} % better than S1's at k = {kilo([curves.k[-1]], '', 0)} kN/m"
        parts.append(Statement(text, bool(curves.worse("S1", name, "J1")[-1])))
    return Claim(4, CLAIMS[4], tuple(parts))


def _claim_5(curves: Curves) -> Claim:
    parts, soft = [], curves.k <= _SOFT
    for layout, index in (("S2", "J3"), ("S3", "J3"), ("S2", "J5")):
        for force in (10, 20):
            name = f"{layout}-{force}N"
            there = soft & curves.worse(name, "S1", index)
            text = f"{index} of {layout} with {force} N: nowhere worse"
            if there.any():
                most = 100.0 * float(curves.excess(name, "S1", index)[there].max())
                at = kilo(curves.k[there].tolist(), ", ", 0)
                text = f"{index} of {layout} with {force} N: worse than S1's at k = {at} kN/m, by at most {most:.2f} %"
            parts.append(Statement(text, bool(there.any())))
    return Claim(
        5,
        CLAIMS[5],
        tuple(parts),
        note=f"Looked at up to k = {kilo([_SOFT], '', 0)} kN/m; worse means beyond two standard errors.",
    )


def _claim_8(curves: Curves) -> Claim:
    parts = []
    for layout, printed in (("S2", 50e3), ("S3", 150e3)):
        friction, elastic, both = (f"{layout}-{kind}" for kind in ("10N", "soft", "soft-10N"))
        found = curves.crossings(friction, elastic, "J1")
        gap = curves.excess(friction, elastic, "J1")
        text = f"{layout}: friction alone is better than elasticity alone above k = {_at(found)} kN/m"
        once = bool(gap[0] > 0.0 > gap[-1]) and len(found) == 1
        parts.append(Statement(text, once, once and _is_at(found[0], printed, curves.step)))
        exceptions = curves.not_worst(both, (layout, friction, elastic), "J1")
        text = f"{layout}: both together are the worst{' at every k' if not exceptions.size else ''}{_but(exceptions)}"
        parts.append(Statement(text, exceptions.size == 0))
    return Claim(8, CLAIMS[8], tuple(parts))


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
        signs = ["<" if curves.certainly_better(a, b, "J3", at) else "≈" for a, b in pairwise(found)]
        line = "".join(f"{words[n.removeprefix(layout)]} {sign} " for n, sign in zip(found, [*signs, ""], strict=True))
        contrary = [curves.certainly_better(layout + b, layout + a, "J3", at) for a, b in combinations(order, 2)]
        parts.append(Statement(f"{layout} {where} kN/m: {line.rstrip()}", not any(contrary)))
    equal = [
        f"{layout} at k = {_at(curves.crossings(f'{layout}-10N', f'{layout}-soft', 'J3'))} kN/m" for layout in _LAYOUTS
    ]
    return Claim(
        9,
        CLAIMS[9],
        tuple(parts),
        note=f"≈: no certain difference. Friction alone and elasticity alone are equal in {' and in '.join(equal)}.",
    )


def _claim_10(curves: Curves) -> Claim:
    parts = []
    for layout in _LAYOUTS:
        friction, elastic, both = (f"{layout}-{kind}" for kind in ("10N", "soft", "soft-10N"))
        exceptions = curves.not_worst(both, (layout, friction, elastic), "J5")
        text = f"{layout}: both together are the worst{' at every k' if not exceptions.size else ''}{_but(exceptions)}"
        parts.append(Statement(text, exceptions.size == 0))
    more, less = curves.worse("S3-soft", "S3-10N", "J5"), curves.worse("S3-10N", "S3-soft", "J5")
    text = (
        f"S3: elasticity costs more than friction at {int(more.sum())} of {more.size} stiffnesses, less at "
        f"{int(less.sum())}, with no certain difference at the others"
    )
    parts.append(Statement(text, bool(more.any()) and not less.any()))
    found = curves.crossings("S2-10N", "S2-soft", "J5")
    friction_more, elastic_more = curves.worse("S2-10N", "S2-soft", "J5"), curves.worse("S2-soft", "S2-10N", "J5")
    text = f"S2: friction and elasticity cost the same at k = {_at(found, ', ')} kN/m, elasticity more above"
    holds = bool(friction_more.any() and elastic_more[-1])
    parts.append(Statement(text, holds, len(found) == 1 and _is_at(found[0], 140e3, curves.step)))
    return Claim(10, CLAIMS[10], tuple(parts))


def claim_13(evidence: Evidence) -> Claim:
    """The last claim, on curves and on the half car's table."""
    assert evidence.curves is not None
    curves, parts = Curves(evidence.curves), []
    for index in ("J1", "J3", "J5"):
        for layout in ("S2-soft-10N", "S3-soft-10N"):
            better = -100.0 * curves.excess(layout, "S1", index)
            exceptions = curves.k[curves.worse(layout, "S1", index)]
            text = f"{index} of {layout.split('-')[0]}: {better[-1]:.1f} % better at 300 kN/m"
            but = f", worse at k = {kilo(exceptions.tolist(), ', ', 0)} kN/m" if exceptions.size else ""
            parts.append(Statement(text + but, bool(better[-1] > 0.0) and exceptions.size == 0))
    half = [evidence.improvement(3, index, case)[0] for index in ("J1", "J3", "J5") for case in (7, 13)]
    parts.append(Statement(f"half car, Method 2: {min(half):.1f} to {max(half):.1f} % better", min(half) > 0.0))
    return Claim(13, CLAIMS[13], tuple(parts), note="Worse means beyond two standard errors.")


def _but(exceptions: Array) -> str:
    return f", but not at k = {kilo(exceptions.tolist(), ', ', 0)} kN/m" if exceptions.size else ""


def _at(found: list[Intersection], between: str = " and ") -> str:
    return (
        between.join(f"{c.k / 1e3:.1f}{f' ± {c.error / 1e3:.1f}' if c.error else ''}" for c in found) or "(no crossing)"
    )


def _is_at(found: Intersection, printed: float, step: float) -> bool:
    return is_near(found.k, printed, step, found.error)
