"""Where a study looks for a budget of a stiffness: against the crossing in closed form."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest
from campaigns import sampled
from study_text import study_text

from inerter.files.study.loading import load_study
from inerter.files.study.running import run_study


@pytest.mark.parametrize("kept", sampled([1 / 110, 1 / 90, 900, 1100], [1 / 110, 900]))
def test_from_a_thousandth_to_a_hundred_times_the_present_value(kept: float, tmp_path: Path) -> None:
    """J1^2 goes as c kt + k^2 (m + mu) / c: of two dampings alike at k = sqrt(kt c c' / (m + mu))."""
    expected = math.sqrt(150e3 * 1e3 * 3e3 / 285.0)
    elements = f'k = "{expected * kept!r} N/m"\nc = "3 kN s/m"\nlight = "1 kN s/m"'
    settings = 'indices = ["J1"]\nbreak_even = ["k"]\nbaseline = "usual"\nevaluate = ["statistical-linearisation"]'
    layouts = 'usual = "k | light"\nfirm = "k | c"'
    path = tmp_path / "study.toml"
    path.write_text(study_text(settings, elements=elements, layouts=layouts), encoding="utf-8")
    run_study(load_study(path), tmp_path / "out")
    with (tmp_path / "out" / "budgets.csv").open(encoding="utf-8") as stream:
        (found,) = csv.DictReader(stream)
    if 1 / 100 < kept < 1000:
        assert float(found["value"]) == pytest.approx(expected, rel=1e-4)
    else:
        assert "the design is better for " + ("no" if kept < 1.0 else "every") in found["status"]
