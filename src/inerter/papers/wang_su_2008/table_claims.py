"""Claims of the paper on its tables: what friction and elasticity cost of the improvement over S1."""

from __future__ import annotations

from inerter.papers.wang_su_2008.between import WORSE
from inerter.papers.wang_su_2008.judging import (
    Claim,
    ClaimPart,
    EstimatedQuantity,
    Evidence,
    exact_value,
    rounding_interval,
    statement,
    within,
)
from inerter.papers.wang_su_2008.rows import SimulatedRow

_STEP = 0.5  # percentage points: the steps in which the paper gives losses (0.5, 1, 2.5)
_POINTS = "percentage points"


def quarter_car_claims(evidence: Evidence) -> list[Claim]:
    """Claims on Table 1."""
    return [claim(evidence) for claim in (_claim_6, _claim_7, _claim_11)]


def _loss(what: str, cost: EstimatedQuantity, low: float, high: float) -> ClaimPart:
    """The statement that something costs an improvement anything, with the printed range of how much."""
    text = f"{what} loses {_points(cost)} {_POINTS}"
    return statement(text, within(cost, low=0.0), within(cost, low, high), by=[cost], unit=_POINTS)


def _points(cost: EstimatedQuantity) -> str:
    return f"{cost.value:.2f}" + (f" ± {cost.half_width():.2f}" if cost.error else "")


def _claim_6(evidence: Evidence) -> Claim:
    parts = []
    for layout, (ideal, ten) in {"S2": (2, 4), "S3": (7, 9)}.items():
        for index in ("J1", "J3"):
            small = evidence.cost(1, index, ideal, ten)
            text = f"{index} of {layout}: 10 N cost {_points(small)} {_POINTS}"
            parts.append(statement(text, within(small, -_STEP, _STEP), by=[small], unit=_POINTS))
    for layout, (ideal, hundred), printed in (("S2", (2, 5), 1.0), ("S3", (7, 10), 2.5)):
        cost = evidence.cost(1, "J3", ideal, hundred)
        parts.append(_loss(f"J3 of {layout} with 100 N", cost, *rounding_interval(printed, _STEP)))
    ride = [
        f"{layout} {_points(evidence.cost(1, 'J1', *cases))}" for layout, cases in {"S2": (2, 5), "S3": (7, 10)}.items()
    ]
    note = f"Negligible: less than half a percentage point. With 100 N J1 loses {' and '.join(ride)} {_POINTS}."
    return Claim(6, parts, note)


def _claim_7(evidence: Evidence) -> Claim:
    parts, followed = [], []
    for layout, ideal, cases in (("S2", 2, (4, 5)), ("S3", 7, (9, 10))):
        reference = evidence.rows[1, f"J5 {ideal}"]
        for case, force in zip(cases, (10, 100), strict=True):
            row = evidence.rows[1, f"J5 {case}"]
            base = reference.exact
            change = exact_value(row).minus(exact_value(reference)).times(100.0 / base)
            verdict = within(change, low=100.0 * WORSE) if layout == "S2" else within(change, high=-100.0 * WORSE)
            text = f"{layout} with {force} N: {change.value:+.2f} % over all frequencies"
            parts.append(statement(text, verdict, by=[change]))
            followed.append(_nearest_peak_text(layout, force, row, reference))
    return Claim(7, parts, note=f"At the peak nearest to the printed value: {'; '.join(followed)}.")


def _nearest_peak_text(layout: str, force: int, row: SimulatedRow, reference: SimulatedRow) -> str:
    peak = row.nearest
    assert peak is not None
    return f"{layout} with {force} N {100.0 * (peak.gain / reference.exact - 1.0):+.2f} % ({peak.omega:.1f} rad/s)"


def _claim_11(evidence: Evidence) -> Claim:
    ranges = {"J1": (2.0, 3.0), "J3": rounding_interval(0.5, _STEP)}
    parts = [
        _loss(f"{index} of {layout}", evidence.cost(1, index, *cases), *ranges[index])
        for layout, cases in {"S2": (2, 6), "S3": (7, 11)}.items()
        for index in ranges
    ]
    return Claim(11, parts)


def claim_12(evidence: Evidence) -> Claim:
    """The claim on the half car, Tables 2 and 3."""
    cases = {"S2": (2, 7), "S3": (8, 13)}
    parts = [
        _loss(f"Method 2, {index} of {layout}", evidence.cost(3, index, *pair), low, high)
        for index, (low, high) in {"J1": (2.0, 3.0), "J3": (0.0, 1.0)}.items()
        for layout, pair in cases.items()
    ]
    load = {layout: evidence.cost(3, "J5", *pair) for layout, pair in cases.items()}
    parts.append(_loss("Method 2, J5 of S3", load["S3"], *rounding_interval(6.5, _STEP)))
    text = f"Method 2, J5 of S2 loses {_points(load['S2'])} {_POINTS}, less than that of S3"
    lead = load["S3"].minus(load["S2"])
    parts.append(statement(text, within(lead, low=0.0), by=[lead], unit=_POINTS))
    parts += [
        _loss(f"Method 1, J5 of {layout}", evidence.cost(2, "J5", *pair), *rounding_interval(8.0, 1.0))
        for layout, pair in cases.items()
    ]
    return Claim(12, parts)
