"""Panels: quick answers about designs. A further one is one more row, and a function that answers it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from inerter.methods.registry import DEFAULT, METHODS, is_blind


@dataclass(frozen=True)
class Panel:
    """Panel: its title, the function that answers it, and whether it is answered at once without simulation."""

    key: str
    title: str
    home: str
    quick: bool = True


PANELS = {
    panel.key: panel
    for panel in (
        Panel("indices", "Indices compared with the baseline", "inerter.app.comparing:indices"),
        Panel("decision", "Designs ranked by one index, and the verdict", "inerter.app.deciding:decision"),
        Panel("margins", "Break-even values, other speeds, tolerances", "inerter.app.deciding:margins", quick=False),
        Panel("compare", "Two to four designs side by side", "inerter.app.comparing:compare_designs"),
        Panel("response", "Frequency response", "inerter.app.answers:response"),
        Panel("mechanism", "The mechanism of the vehicle", "inerter.app.answers:mechanism"),
        Panel("optimise", "Optimal values", "inerter.app.answers:optimum"),
        Panel("history", "Motion on a road", "inerter.app.answers:motion", quick=False),
        Panel("tolerance", "Index under tolerances", "inerter.app.answers:scatter", quick=False),
        Panel("budget", "Break-even friction, backlash or compliance", "inerter.app.answers:break_even", quick=False),
    )
}


def at_once(key: str, body: Mapping[str, Any]) -> bool:
    """Whether an answer takes no longer than a slider waits: nothing is simulated for it."""
    study = body.get("study")
    asked = study.get("study") if isinstance(study, Mapping) else None
    asked = asked if isinstance(asked, Mapping) else {}
    named = body.get("methods") or asked.get("evaluate")
    search = (body.get("method") or asked.get("optimise")) if key == "optimise" else None
    methods = [search or DEFAULT, *(named if isinstance(named, list | tuple) else ())]
    return PANELS[key].quick and all(is_blind(name) for name in methods if isinstance(name, str) and name in METHODS)
