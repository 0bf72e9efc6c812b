"""Claims of the paper on its tables: what friction and elasticity cost of the improvement over S1."""

from __future__ import annotations

from inerter.papers.wang_su_2008.judging import Claim, Evidence, Statement, is_near
from inerter.papers.wang_su_2008.paper import CLAIMS
from inerter.papers.wang_su_2008.rows import SimulatedRow

_SAID = 0.5  # percentage points: the steps in which the paper speaks of losses (0.5, 1, 2.5)


def quarter_car_claims(evidence: Evidence) -> list[Claim]:
    """Claims on Table 1."""
    return [claim(evidence) for claim in (_claim_6, _claim_7, _claim_11)]


def _claim_6(evidence: Evidence) -> Claim:
    parts = []
    for layout, (ideal, ten) in {"S2": (2, 4), "S3": (7, 9)}.items():
        for index in ("J1", "J3"):
            small, error = evidence.cost(1, index, ideal, ten)
            text = f"{index} of {layout}: 10 N cost {small:.2f} percentage points"
            parts.append(Statement(text, abs(small) < _SAID + 2.0 * error))
    for layout, (ideal, hundred), printed in (("S2", (2, 5), 1.0), ("S3", (7, 10), 2.5)):
        ride, _ = evidence.cost(1, "J1", ideal, hundred)
        cost, error = evidence.cost(1, "J3", ideal, hundred)
        text = f"{layout} with 100 N: J3 loses {cost:.2f} ± {error:.2f}, J1 {ride:.2f} percentage points"
        parts.append(Statement(text, cost > 2.0 * error, is_near(cost, printed, _SAID, error)))
    return Claim(6, CLAIMS[6], tuple(parts), note="Negligible: less than half a percentage point.")


def _claim_7(evidence: Evidence) -> Claim:
    parts, followed = [], []
    for layout, ideal, cases in (("S2", 2, (4, 5)), ("S3", 7, (9, 10))):
        reference = evidence.rows[1, f"J5 {ideal}"]
        for case, force in zip(cases, (10, 100), strict=True):
            row = evidence.rows[1, f"J5 {case}"]
            change = 100.0 * (row.exact / reference.exact - 1.0)
            text = f"{layout} with {force} N: {change:+.2f} % over all frequencies"
            parts.append(Statement(text, change > 0.0 if layout == "S2" else change < 0.0))
            followed.append(_followed(layout, force, row, reference))
    return Claim(7, CLAIMS[7], tuple(parts), note=f"At the peak nearest to the printed value: {'; '.join(followed)}.")


def _followed(layout: str, force: int, row: SimulatedRow, reference: SimulatedRow) -> str:
    peak = row.nearest
    assert peak is not None
    return f"{layout} with {force} N {100.0 * (peak.gain / reference.exact - 1.0):+.2f} % ({peak.omega:.1f} rad/s)"


def _claim_11(evidence: Evidence) -> Claim:
    parts = []
    for layout, (ideal, both) in {"S2": (2, 6), "S3": (7, 11)}.items():
        for index in ("J1", "J3"):
            cost, error = evidence.cost(1, index, ideal, both)
            said = _between(cost, 2.0, 3.0, error) if index == "J1" else is_near(cost, 0.5, _SAID, error)
            parts.append(Statement(f"{index} of {layout} loses {cost:.2f} percentage points", cost > 2.0 * error, said))
    return Claim(11, CLAIMS[11], tuple(parts))


def claim_12(evidence: Evidence) -> Claim:
    """The claim on the half car, Tables 2 and 3."""
    parts, load = [], {}
    for index in ("J1", "J3", "J5"):
        for layout, (ideal, both) in {"S2": (2, 7), "S3": (8, 13)}.items():
            cost, error = evidence.cost(3, index, ideal, both)
            said = {"J1": _between(cost, 2.0, 3.0, error), "J3": cost < 1.0 + 2.0 * error, "J5": True}[index]
            if index == "J5":
                load[layout] = cost
                said = layout == "S2" or (is_near(cost, 6.5, _SAID, error) and cost == max(load.values()))
            text = f"Method 2, {index} of {layout} loses {cost:.2f} percentage points"
            parts.append(Statement(text, cost > 2.0 * error, said))
    for layout, (ideal, both) in {"S2": (2, 7), "S3": (8, 13)}.items():
        cost, error = evidence.cost(2, "J5", ideal, both)
        text = f"Method 1, J5 of {layout} loses {cost:.2f} ± {error:.2f} percentage points"
        parts.append(Statement(text, cost > 2.0 * error, is_near(cost, 8.0, 1.0, error)))
    return Claim(12, CLAIMS[12], tuple(parts))


def _between(value: float, low: float, high: float, error: float) -> bool:
    return low - 2.0 * error <= value <= high + 2.0 * error
