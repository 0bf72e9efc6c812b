"""Where the printed numbers come from: what each convention of 2008 does to them, measured on this reproduction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inerter.papers.wang_su_2008.linear import Linear
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rows import RUNS, SimulatedRow


@dataclass(frozen=True)
class Origin:
    """One reason why a printed number is what it is, and by how much it matters."""

    title: str
    text: str


def origins(found: Reproduction) -> list[Origin]:
    """Every reason for which there are numbers."""
    result: list[Origin] = []
    rows = list(found.rows.values())
    if found.linear is not None:
        result += [_pade(found.linear), _filter(found.linear), _lever(), _not_optimal(found.linear)]
    expected = [row for row in rows if row.row.table in (1, 3)]
    if expected:
        result += [_hold(expected), _single_peak(expected), _scatter(expected)]
    first = [row for row in rows if row.row.table == 2]
    if first:
        result.append(_gains(first))
    return result


def _pade(linear: Linear) -> Origin:
    changes = {
        f"{c.row.title}": 100.0 * (c.exact / c.paper2008 - 1.0)
        for c in linear.compared
        if (c.row.table, c.row.index) == (2, "J1")
    }
    name = max(changes, key=lambda key: abs(changes[key]))
    return Origin(
        "A Padé approximant of the wheelbase delay",
        f"The half car's norms take the road's delay between the axles as a fifth-order Padé approximant. With the "
        f"exact delay J1 changes by up to {changes[name]:+.2f} % ({name}).",
    )


def _filter(linear: Linear) -> Origin:
    changes = [
        100.0 * (c.exact / c.paper2008 - 1.0) for c in linear.compared if (c.row.table, c.row.index) == (2, "J3")
    ]
    return Origin(
        "A high-pass filter in J3 of the half car",
        "The tyre loads of the half car are divided by s + 2π rad/s in place of s, because they were thought not to "
        f"vanish at zero frequency. With the true delay they do, and J3 without the filter is {min(changes):.1f} to "
        f"{max(changes):.1f} % higher.",
    )


def _lever() -> Origin:
    return Origin(
        "A lever that the formula of J1 leaves out",
        "J1 of the half car adds the pitch acceleration times the mean distance of the axles, (l_f + l_r)/2 = 1.02 m; "
        "the printed formula has no such factor, the printed numbers do.",
    )


def _not_optimal(linear: Linear) -> Origin:
    gains = {f.row.title: f.gain_percent for f in linear.found if f.row.index == "J5" and f.gain_percent > 0.05}
    listed = "; ".join(f"{title}: {gain:.2f} %" for title, gain in gains.items())
    return Origin(
        "Designs for J5 that are not optimal",
        "The optima of J5 have two or three equal peaks, at which a search for a smooth minimum stops early. Lower "
        f"values than the printed ones exist for {listed}."
        if gains
        else "All printed designs for J5 are optimal.",
    )


def _hold(rows: list[SimulatedRow]) -> Origin:
    changes = {
        f"{row.row.index} of {row.row.title}": 100.0 * (row.paper2008 / row.exact - 1.0)
        for row in rows
        if row.row.table == 1 and not row.row.has_friction and row.row.index != "J5"
    }
    listed = "; ".join(f"{name}: {change:+.2f} %" for name, change in changes.items() if abs(change) > 0.1)
    return Origin(
        "A road that is held for 1 ms",
        "The expected values were simulated on a road that jumps every millisecond. Its steps shake what has a direct "
        f"path for high frequencies: against the norm, {listed}. The paper takes this for agreement within the method.",
    )


def _single_peak(rows: list[SimulatedRow]) -> Origin:
    apart = {
        f"{row.row.title} (Table {row.row.table})": 100.0 * (row.exact / row.paper2008 - 1.0)
        for row in rows
        if row.row.index == "J5" and row.exact > 1.001 * row.paper2008
    }
    listed = "; ".join(f"{name}: {change:.2f} % higher" for name, change in apart.items())
    return Origin(
        "One of two equal peaks of J5",
        "The designs that are best for J5 have two (quarter car) or three (half car) equally high peaks, and friction "
        "lowers one and raises another. The printed values follow one of them, not always the highest. Which one it "
        f"was is told by the value itself. Over all frequencies J5 is: {listed}.",
    )


def _scatter(rows: list[SimulatedRow]) -> Origin:
    strong = [row for row in rows if row.row.nonlinearity == "friction 100 N" and row.row.index != "J5"]
    weak = [row for row in rows if row.row.nonlinearity == "friction 10 N" and row.row.index != "J5"]
    errors = [100.0 * max(r.paper2008_error / r.paper2008 for r in some) for some in (weak, strong) if some]
    words = " and ".join(f"{error:.2f} % at {force} N" for error, force in zip(errors, (10, 100), strict=False))
    return Origin(
        "The scatter of four runs",
        f"The paper averages {RUNS} runs and gives no error bars. The standard error of {RUNS} roads is up to {words} "
        "of friction, which is as large as some of the effects that are discussed.",
    )


def _gains(rows: list[SimulatedRow]) -> Origin:
    peaks = [100.0 * abs(row.difference) for row in rows if row.row.index == "J5"]
    rest = [100.0 * abs(row.difference) for row in rows if row.row.index != "J5"]
    return Origin(
        "Gains of a nonlinear system",
        "Method 1 divides the spectrum of the output by that of the noise. Where the noise happens to be small and "
        "friction adds output of its own, the ratio is huge: a maximum over all frequencies has no expectation, and "
        f"what was done against that is not printed. Smoothed over ±0.2 Hz, J5 comes out within {np.min(peaks):.1f} to "
        f"{np.max(peaks):.1f} % of the printed values, J1 and J3 within {np.max(rest):.1f} %.",
    )
