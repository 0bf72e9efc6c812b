"""The paper's thirteen claims, each judged by the numbers of this reproduction."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from inerter.papers.wang_su_2008.between import WORSE, Found, crossings, excess_there
from inerter.papers.wang_su_2008.rows import SimulatedRow

Array = NDArray[np.float64]
_FEW = 12  # exceptions among 120 points of four curves: the rule holds, and they are told
_SOFT = 60e3  # [N/m] what is called a small stiffness
_STATIC = 80e3  # [N/m] up to here the static compliance, which friction lowers, may decide J5
HOLDS, OTHER_NUMBER, FAILS = "holds", "holds with another number", "does not hold"


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, what was found, and the numbers that say so."""

    number: int
    statement: str
    verdict: str  # "holds", "holds with another number", "does not hold"
    evidence: str


@dataclass(frozen=True, eq=False)
class Evidence:
    """What claims are judged by; None or empty where that part was not computed."""

    figure11: xr.Dataset | None = None
    between: Found = field(default_factory=dict)  # its swept values; there if Figure 11 is
    curves: xr.Dataset | None = None  # of Figures 11, 13 and 14
    rows: dict[tuple[int, str], SimulatedRow] = field(default_factory=dict)  # by table and "index case"
    linear: dict[tuple[int, str], float] = field(default_factory=dict)  # exact norms, the same

    def has_tables(self, *tables: int) -> bool:
        """Whether the simulated rows of these tables are there."""
        return all(any(table == key[0] for key in self.rows) for table in tables)


def judge(evidence: Evidence) -> list[Claim]:
    """Every claim for which there is evidence."""
    found: list[Claim] = []
    if evidence.figure11 is not None:
        ideal = Curves(evidence.figure11)
        found += [_claim_1(ideal), _claim_2(ideal, evidence.between), _claim_3(ideal, evidence.between)]
    if evidence.curves is not None:
        friction = Curves(evidence.curves)
        found += [claim(friction) for claim in (_claim_4, _claim_5, _claim_8, _claim_9, _claim_10)]
    if evidence.has_tables(1):
        found += [claim(evidence) for claim in (_claim_6, _claim_7, _claim_11)]
    if evidence.has_tables(2, 3):
        found.append(_claim_12(evidence))
    if evidence.curves is not None and evidence.has_tables(1, 2, 3):
        found.append(_claim_13(evidence))
    return sorted(found, key=lambda claim: claim.number)


# --- Over the stiffness.


@dataclass(frozen=True, eq=False)
class Curves:
    """Indices over the static stiffness, and where two of them cross."""

    data: xr.Dataset

    @property
    def k(self) -> Array:
        """Static stiffness [N/m]."""
        return np.asarray(self.data["k"].values)

    def of(self, layout: str, index: str) -> Array:
        """The values of one curve."""
        return np.asarray(self.data["value"].sel(layout=layout, index=index).values)

    def error(self, layout: str, index: str) -> Array:
        """Their standard errors."""
        if "standard_error" not in self.data:
            return np.zeros(self.k.size)
        return np.asarray(self.data["standard_error"].sel(layout=layout, index=index).fillna(0.0).values)

    def excess(self, one: str, other: str, index: str) -> Array:
        """How much higher `one` is than `other`, relative."""
        return np.asarray(self.of(one, index) / self.of(other, index) - 1.0)

    def worse(self, one: str, other: str, index: str) -> NDArray[np.bool_]:
        """Where `one` is higher than `other` by more than can be seen, and than two standard errors."""
        error = np.hypot(self.error(one, index), self.error(other, index)) / self.of(other, index)
        return np.asarray(self.excess(one, other, index) > WORSE + 2.0 * error)

    def crossings(self, one: str, other: str, index: str) -> list[float]:
        """Where `one` becomes better or worse than `other` [N/m], by linear interpolation between swept values.

        A stretch between two turns counts if the difference is certain anywhere on it.
        """
        gap, k = self.excess(one, other, index), self.k
        certain = self.worse(one, other, index) | self.worse(other, one, index)
        stretches = np.split(np.arange(k.size), 1 + np.flatnonzero(np.diff(np.sign(gap)) != 0))
        counted = [stretches[0], *(s for s in stretches[1:-1] if certain[s].any()), stretches[-1]]
        turns = [(s[-1], after[0]) for s, after in pairwise(counted) if gap[s[-1]] * gap[after[0]] < 0.0]
        return [float(k[i] + (k[j] - k[i]) * gap[i] / (gap[i] - gap[j])) for i, j in turns]

    def order(self, layouts: Iterable[str], index: str, at: NDArray[np.bool_]) -> list[str]:
        """The layouts, best first, where `at` holds, by their mean relative to the first one."""
        chosen = list(layouts)
        mean = {name: float(np.mean(self.excess(name, chosen[0], index)[at])) for name in chosen}
        return sorted(chosen, key=mean.__getitem__)


def _shrinks(curves: Curves, index: str) -> tuple[bool, list[str]]:
    """Whether the optimum is worse with a hard shaft than with none, and worse still with a soft one, at every k."""
    holds, evidence = True, []
    base = curves.of("S1", index)
    for layout in ("S2", "S3"):
        ideal, hard, soft = (curves.of(layout + kind, index) for kind in ("", "-hard", "-soft"))
        exceptions = curves.k[(hard < ideal * (1.0 - WORSE)) | (soft < hard * (1.0 - WORSE))]
        holds &= exceptions.size == 0
        losses = [100.0 * (curve - ideal) / base for curve in (hard, soft)]
        but = f", but not at k = {_kilo(exceptions.tolist(), ', ', 0)} kN/m" if exceptions.size else ""
        evidence.append(
            f"{layout}: the benefit shrinks by up to {losses[0].max():.2f} (hard) and {losses[1].max():.2f} (soft) "
            f"percentage points{but}"
        )
    return holds, evidence


def _claim_1(curves: Curves) -> Claim:
    holds, evidence = _shrinks(curves, "J1")
    return Claim(
        1,
        "Elastic effect only: the benefit in J1 shrinks, more so with the softer setting.",
        _verdict(holds),
        "; ".join(evidence) + ".",
    )


def _claim_2(curves: Curves, between: Found) -> Claim:
    lines, holds, places = [], True, []
    for kind in ("soft", "hard"):
        excess = curves.excess(f"S3-{kind}", "S3", "J3")
        found = crossings(between, "J3", f"S3-{kind}", "S3")
        holds &= bool(excess[0] < 0.0 < excess[-1]) and len(found) == 1
        places += found
        lines.append(f"{kind}: better below k = {_kilo(found)} kN/m, by at most {-100.0 * float(excess.min()):.2f} %")
    return Claim(
        2,
        "Elastic effect only: J3 of S3 is slightly better than with an ideal inerter below k = 120 kN/m, worse above.",
        _verdict(holds, _near(places, 120e3, 5e3)),
        "; ".join(lines) + ".",
    )


def _claim_3(curves: Curves, between: Found) -> Claim:
    shrinks, evidence = _shrinks(curves, "J5")
    near = False
    for kind in ("soft", "hard"):
        found = crossings(between, "J5", f"S3-{kind}", "S1")
        there = excess_there(between, "J5", f"S3-{kind}", "S1")
        near |= there > WORSE
        where = f", and worse from k = {_kilo(found, ' to ')} kN/m" if len(found) == 2 else ""
        evidence.append(f"at 55 kN/m S3 {kind} is {abs(100.0 * there):.2f} % {_worse(there)} than S1{where}")
    return Claim(
        3,
        "Elastic effect only: the benefit in J5 shrinks, more so with the softer setting; elastic S3 is worse than S1 "
        "near k = 55 kN/m.",
        _verdict(near, shrinks),
        "; ".join(evidence) + ".",
    )


def _claim_4(curves: Curves) -> Claim:
    evidence, exceptions, places, better = [], 0, [], True
    for layout in ("S2", "S3"):
        for index in ("J1", "J3"):
            ten, twenty = (curves.excess(f"{layout}-{f}N", layout, index) for f in (10, 20))
            wrong = curves.k[(ten <= 0.0) | (twenty <= ten)]
            exceptions += wrong.size
            but = f", but not at k = {_kilo(wrong.tolist(), ', ', 0)} kN/m" if wrong.size else ""
            evidence.append(
                f"{index} of {layout}: friction costs {_span(100.0 * ten)} (10 N) and {_span(100.0 * twenty)} (20 N)"
                f"{but}"
            )
        found = curves.crossings(f"{layout}-10N", "S1", "J1")
        places += found
        last = 100.0 * curves.excess(f"{layout}-10N", "S1", "J1")[-1]
        better &= bool(last < 0.0)
        evidence.append(
            f"J1 of {layout} with 10 N is worse than S1's up to k = {_kilo(found)} kN/m, and {-last:.1f} % better at "
            f"k = {_kilo([curves.k[-1]], '', 0)} kN/m"
        )
    return Claim(
        4,
        "Friction only, Method 1: J1 and J3 degrade, more with 20 N than with 10 N; for k up to about 15 kN/m J1 is "
        "worse than S1's; at large k it is still better.",
        _verdict(better and exceptions <= _FEW, exceptions == 0 and bool(places) and all(p <= 20e3 for p in places)),
        "; ".join(evidence) + ".",
    )


def _claim_5(curves: Curves) -> Claim:
    evidence, worse = [], {}
    soft = curves.k <= _SOFT
    for layout, index in (("S2", "J3"), ("S3", "J3"), ("S2", "J5")):
        for force in (10, 20):
            name = f"{layout}-{force}N"
            excess = curves.excess(name, "S1", index)
            there = soft & curves.worse(name, "S1", index)
            at = curves.k[there]
            worse[layout, index, force] = at.size > 0
            where = f"worse than S1's at k = {_kilo(at.tolist(), ', ', 0)} kN/m" if at.size else "nowhere worse"
            most = f", by at most {100.0 * float(excess[there].max()):.2f} %" if at.size else ""
            evidence.append(f"{index} of {layout} with {force} N: {where}{most}")
    return Claim(
        5,
        "Friction only, Method 1: at small k J3 of S2 and S3 is worse than S1's, and so is J5 of S2.",
        _verdict(all(value for key, value in worse.items() if key[2] == 20), all(worse.values())),
        f"Up to k = {_kilo([_SOFT], '', 0)} kN/m, beyond two standard errors: " + "; ".join(evidence) + ".",
    )


def _claim_8(curves: Curves) -> Claim:
    holds, numbers, evidence = True, True, []
    for layout, printed in (("S2", 50e3), ("S3", 150e3)):
        friction, elastic, both = (f"{layout}-{kind}" for kind in ("10N", "soft", "soft-10N"))
        found = curves.crossings(friction, elastic, "J1")
        gap = curves.excess(friction, elastic, "J1")
        holds &= bool(gap[0] > 0.0 > gap[-1])
        numbers &= len(found) == 1 and _near(found, printed, 15e3)
        worst = _always_worst(curves, both, (layout, friction, elastic), "J1")
        holds &= worst.size == 0
        rest = "" if worst.size == 0 else f", but not at k = {_kilo(worst.tolist(), ', ', 0)} kN/m"
        evidence.append(
            f"{layout}: friction alone is better than elasticity alone above k = {_kilo(found)} kN/m; both together "
            f"are always the worst{rest}"
        )
    return Claim(
        8,
        "Both effects, Method 1, J1: at large k friction alone is better than elasticity alone, below k = 50 kN/m (S2) "
        "and 150 kN/m (S3) the contrary; both together are always the worst.",
        _verdict(holds, numbers),
        "; ".join(evidence) + ".",
    )


def _claim_9(curves: Curves) -> Claim:
    words = {"": "ideal", "-soft": "elastic", "-10N": "friction", "-soft-10N": "both"}
    printed = (
        ("S2", "below 50", curves.k < 50e3, ("", "-soft", "-10N", "-soft-10N")),
        ("S2", "above 140", curves.k > 140e3, ("", "-10N", "-soft", "-soft-10N")),
        ("S3", "below 30", curves.k < 30e3, ("-soft", "-soft-10N", "", "-10N")),
        ("S3", "above 230", curves.k > 230e3, ("", "-10N", "-soft", "-soft-10N")),
    )
    right, evidence = [], []
    for layout, where, at, order in printed:
        found = [name.removeprefix(layout) for name in curves.order([layout + kind for kind in words], "J3", at)]
        right.append(tuple(found) == order)
        line = " < ".join(words[kind] for kind in found)
        evidence.append(f"{layout} {where} kN/m: {line}{'' if right[-1] else ' (the paper has another order)'}")
    for layout in ("S2", "S3"):
        found_at = curves.crossings(f"{layout}-10N", f"{layout}-soft", "J3")
        evidence.append(f"{layout}: friction alone and elasticity alone are equal at k = {_kilo(found_at)} kN/m")
    return Claim(
        9,
        "Both effects, Method 1, J3, best first: S2 with soft k: ideal, elastic, friction, both; S2 above 140 kN/m: "
        "ideal, friction, elastic, both; S3 below 30 kN/m: elastic, both, ideal, friction; S3 above 230 kN/m: ideal, "
        "friction, elastic, both.",
        HOLDS if all(right) else OTHER_NUMBER if sum(right) >= 3 else FAILS,
        "; ".join(evidence) + ".",
    )


def _claim_10(curves: Curves) -> Claim:
    evidence, holds, always = [], True, True
    for layout in ("S2", "S3"):
        friction, elastic, both = (f"{layout}-{kind}" for kind in ("10N", "soft", "soft-10N"))
        exceptions = _always_worst(curves, both, (layout, friction, elastic), "J5")
        holds &= not np.any(exceptions > _STATIC)
        always &= exceptions.size == 0
        rest = "" if exceptions.size == 0 else f", but not at k = {_kilo(exceptions.tolist(), ', ', 0)} kN/m"
        evidence.append(f"{layout}: both together are the worst{rest}")
    more, less = curves.worse("S3-soft", "S3-10N", "J5"), curves.worse("S3-10N", "S3-soft", "J5")
    holds &= bool(np.any(more)) and not np.any(less)
    evidence.append(
        f"S3: elasticity costs more than friction at {int(more.sum())} of {more.size} stiffnesses, less at "
        f"{int(less.sum())}, with no certain difference at the others"
    )
    found = curves.crossings("S2-10N", "S2-soft", "J5")
    evidence.append(
        f"S2: friction and elasticity cost the same at k = {_kilo(found, ', ')} kN/m, elasticity more above"
    )
    return Claim(
        10,
        "Both effects, Method 1, J5: both together are the worst; S3 is influenced more by elasticity than by "
        "friction, S2 by elasticity at large k and by friction below 140 kN/m.",
        _verdict(holds, always and len(found) == 1 and _near(found, 140e3, 20e3)),
        "; ".join(evidence) + ".",
    )


def _always_worst(curves: Curves, one: str, others: Iterable[str], index: str) -> Array:
    """Stiffnesses at which `one` is certainly not the worst."""
    return curves.k[np.any([curves.worse(other, one, index) for other in others], axis=0)]


# --- From the tables.


def _improvement(evidence: Evidence, table: int, index: str, case: int, *, exact: bool = True) -> float:
    """Improvement over the traditional suspension of a row of a table [%], under the same conventions."""
    values = []
    for name in (f"{index} {case}", f"{index} 1"):
        row = evidence.rows.get((table, name))
        values.append(evidence.linear[table, name] if row is None else row.exact if exact else row.paper2008)
    return 100.0 * (1.0 - values[0] / values[1])


def _claim_6(evidence: Evidence) -> Claim:
    small, lines, costs = True, [], {}
    for layout, (ideal, ten, hundred) in {"S2": (2, 4, 5), "S3": (7, 9, 10)}.items():
        for index in ("J1", "J3"):
            base = _improvement(evidence, 1, index, ideal)
            cost = [base - _improvement(evidence, 1, index, case) for case in (ten, hundred)]
            small &= abs(cost[0]) < 0.5
            costs[layout, index] = cost[1]
            lines.append(f"{index} of {layout}: 10 N cost {cost[0]:.2f}, 100 N {cost[1]:.2f} percentage points")
    near = abs(costs["S2", "J3"] - 1.0) <= 0.5 and abs(costs["S3", "J3"] - 2.5) <= 0.5
    return Claim(
        6,
        "Friction only, Method 2: 10 N is negligible for J1 and J3; 100 N costs J3 about 1 % (S2) and 2.5 % (S3) of "
        "the improvement.",
        _verdict(small, near),
        "; ".join(lines) + ".",
    )


def _claim_7(evidence: Evidence) -> Claim:
    lines, worse, better, at_followed = [], True, True, True
    for layout, ideal, cases in (("S2", 2, (4, 5)), ("S3", 7, (9, 10))):
        reference = evidence.rows[1, f"J5 {ideal}"]
        for case, force in zip(cases, (10, 100), strict=True):
            row = evidence.rows[1, f"J5 {case}"]
            over_all = 100.0 * (row.exact / reference.exact - 1.0)
            followed = 100.0 * (row.paper2008 / reference.paper2008 - 1.0)
            if layout == "S2":
                worse &= over_all > 0.0
            else:
                better, at_followed = better and over_all < 0.0, at_followed and followed < 0.0
            lines.append(
                f"{layout} with {force} N: {over_all:+.2f} % over all frequencies, {followed:+.2f} % at the peak that "
                f"the paper followed ({row.omega:.1f} rad/s)"
            )
    verdict = HOLDS if worse and better else FAILS
    note = "The peak that the paper followed falls, the other one rises" if at_followed and not better else ""
    return Claim(
        7,
        "Friction only, Method 2: J5 becomes worse for S2 and slightly better for S3.",
        verdict,
        "; ".join(lines) + "." + (f" {note}." if note else ""),
    )


def _claim_11(evidence: Evidence) -> Claim:
    costs = {
        (layout, index): _improvement(evidence, 1, index, ideal) - _improvement(evidence, 1, index, both)
        for layout, (ideal, both) in {"S2": (2, 6), "S3": (7, 11)}.items()
        for index in ("J1", "J3")
    }
    lines = [f"{index} of {layout} loses {cost:.2f} percentage points" for (layout, index), cost in costs.items()]
    ride = [cost for (_, index), cost in costs.items() if index == "J1"]
    tyre = [cost for (_, index), cost in costs.items() if index == "J3"]
    return Claim(
        11,
        "Both effects, Method 2, quarter car: J1 degrades by 2 to 3 %, J3 by about 0.5 %.",
        _verdict(
            all(cost > 0.0 for cost in costs.values()),
            all(1.95 <= cost <= 3.05 for cost in ride) and all(abs(cost - 0.5) <= 0.25 for cost in tyre),
        ),
        "; ".join(lines) + ".",
    )


def _claim_12(evidence: Evidence) -> Claim:
    lines, costs = [], {}
    for index in ("J1", "J3", "J5"):
        for layout, (ideal, both) in {"S2": (2, 7), "S3": (8, 13)}.items():
            cost = _improvement(evidence, 3, index, ideal) - _improvement(evidence, 3, index, both)
            costs[index, layout] = cost
            lines.append(f"Method 2, {index} of {layout}: {cost:.2f}")
    first = {}
    for layout, (ideal, both) in {"S2": (2, 7), "S3": (8, 13)}.items():
        first[layout] = _improvement(evidence, 2, "J5", ideal) - _improvement(evidence, 2, "J5", both)
        lines.append(f"Method 1, J5 of {layout}: {first[layout]:.2f}")
    as_printed = (
        all(1.95 <= costs["J1", layout] <= 3.05 for layout in ("S2", "S3"))
        and all(costs["J3", layout] < 1.0 for layout in ("S2", "S3"))
        and abs(max(costs["J5", "S2"], costs["J5", "S3"]) - 6.5) <= 0.5
        and all(abs(cost - 8.0) <= 1.0 for cost in first.values())
    )
    return Claim(
        12,
        "Both effects, half car: by Method 2 J1 degrades by 2 to 3 %, J3 by less than 1 %, J5 by up to 6.5 % (S3); by "
        "Method 1 J5 by about 8 % for S2 and S3.",
        _verdict(all(cost > 0.0 for cost in [*costs.values(), *first.values()]), as_printed),
        "Percentage points of the improvement. " + "; ".join(lines) + ".",
    )


def _claim_13(evidence: Evidence) -> Claim:
    assert evidence.curves is not None
    curves, lines, holds = Curves(evidence.curves), [], True
    for index in ("J1", "J3", "J5"):
        for layout in ("S2-soft-10N", "S3-soft-10N"):
            excess = curves.excess(layout, "S1", index)
            holds &= bool(excess[-1] < 0.0)
            worse = curves.k[curves.worse(layout, "S1", index)]
            but = (
                f", worse beyond two standard errors at k = {_kilo(worse.tolist(), ', ', 0)} kN/m" if worse.size else ""
            )
            lines.append(f"{index} of {layout.split('-')[0]}: {-100.0 * excess[-1]:.1f} % better at 300 kN/m{but}")
    half = [_improvement(evidence, 3, index, case) for index in ("J1", "J3", "J5") for case in (7, 13)]
    holds &= min(half) > 0.0
    lines.append(f"half car, Method 2: {min(half):.1f} to {max(half):.1f} % better")
    return Claim(
        13,
        "The suspension with a nonlinear inerter is still better than the traditional one, especially at large k.",
        _verdict(holds),
        "; ".join(lines) + ".",
    )


def _verdict(holds: bool, as_printed: bool = True) -> str:
    return (HOLDS if as_printed else OTHER_NUMBER) if holds else FAILS


def _near(places: list[float], printed: float, within: float) -> bool:
    return bool(places) and all(abs(place - printed) <= within for place in places)


def _worse(excess: float) -> str:
    return "worse" if excess > 0.0 else "better"


def _span(values: Array) -> str:
    return f"{values.min():.1f} to {values.max():.1f} %"


def _kilo(values: list[float], between: str = " and ", digits: int = 1) -> str:
    return between.join(f"{value / 1e3:.{digits}f}" for value in values) or "(no crossing)"
