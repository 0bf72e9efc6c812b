"""Why simulated rows differ from the printed ones."""

from __future__ import annotations

from inerter.papers.wang_su_2008.rows import DIFFERS, EITHER, OTHER_PEAK, SimulatedRow


def reason(r: SimulatedRow) -> str:
    """Reason for the difference of a row from the printed value; empty if scatter or rounding explains it."""
    if r.verdict == OTHER_PEAK:
        peak = r.compatible[0]
        return (
            f"the printed value follows the peak at {peak.omega:.1f} rad/s, {peak.gain:.5g} m/N, which is not the "
            "highest; the rule of selection is not printed"
        )
    if r.verdict == EITHER:
        peaks = " or ".join(f"{peak.omega:.1f} rad/s, {peak.gain:.5g} m/N" for peak in r.candidates)
        return f"as from a start at rest at the peak at {peaks}; the printed value is consistent with each of them"
    if r.verdict != DIFFERS:
        return ""
    if r.row.index == "J5" and r.row.table == 2:
        return (
            "the maximum of raw gains has no expected value where friction adds output that is uncorrelated with the "
            "input; the averaging is not printed. Here: smoothed over 0.2 Hz to both sides"
        )
    if not r.row.has_friction and r.score is None:
        return "the printed value differs from the printed linear norm, which is impossible for a linear design"
    return f"{abs(r.score or 0.0):.1f} standard errors off; no convention that was tried explains it"
