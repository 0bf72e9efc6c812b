"""What `inerter check` does, in calls of the library: only what it needs is loaded."""

from __future__ import annotations

from pathlib import Path
from textwrap import wrap

from inerter.files.common.suggest import some
from inerter.files.study.budgets import budget_cases
from inerter.files.study.cases import cases
from inerter.files.study.checking import check_study, study_notes
from inerter.files.study.fronts import front_cases
from inerter.files.study.loading import load_study
from inerter.files.study.plausibility import input_warnings, road_sentence
from inerter.files.study.tolerances import tolerance_cases

_WIDTH = 80


def check(study: Path) -> int:
    """Check a study file; returns the exit code."""
    loaded = load_study(study)
    check_study(loaded)
    count = len(cases(loaded))
    counts = {
        "budgets": len(budget_cases(loaded)),
        "fronts": len(front_cases(loaded)),
        "tolerances": len(tolerance_cases(loaded)),
    }
    further = "".join(f", and {number} {kind}" for kind, number in counts.items() if number)
    swept = "".join(f", {sweep.label} at {len(sweep.values)} values" for sweep in loaded.sweeps)
    _say(
        f"{study}: ok. {loaded.model}; layouts {some(loaded.layouts)}; indices {', '.join(loaded.indices)}{swept}"
        f": {count} designs to {'find' if loaded.optimise else 'judge'}{further}."
    )
    if road := road_sentence(loaded):
        _say(f"{road}.")
    for warning in input_warnings(loaded):
        _say(warning)
    for note in study_notes(loaded):
        _say(f"Note: {note}.")
    return 0


def _say(text: str) -> None:
    print("\n".join(wrap(text, _WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)))
