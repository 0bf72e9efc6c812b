"""The paper's thirteen claims, each judged by the numbers of this reproduction."""

from __future__ import annotations

from inerter.papers.wang_su_2008.curve_claims import claim_13, elastic_claims, friction_claims
from inerter.papers.wang_su_2008.judging import Claim, Evidence
from inerter.papers.wang_su_2008.over_stiffness import Curves
from inerter.papers.wang_su_2008.table_claims import claim_12, quarter_car_claims


def judge(evidence: Evidence) -> list[Claim]:
    """Claims of the paper for which results are available, with their verdicts."""
    found: list[Claim] = []
    if evidence.figure11 is not None:
        found += elastic_claims(Curves(evidence.figure11), evidence.between)
    if evidence.curves is not None:
        found += friction_claims(Curves(evidence.curves))
    if evidence.has_tables(1):
        found += quarter_car_claims(evidence)
    if evidence.has_tables(2, 3) and evidence.linear:
        found.append(claim_12(evidence))
    if evidence.curves is not None and evidence.has_tables(1, 2, 3):
        found.append(claim_13(evidence))
    return sorted(found, key=lambda claim: claim.number)
