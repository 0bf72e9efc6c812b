"""Numbers and units as the library writes them, for tests of the page that have no server: `web/tests/numbers.json`.

Written anew by `PYTHONPATH=src:tests python tests/page_numbers.py`.
"""

from __future__ import annotations

import json
import random
from typing import Any

from folders import ROOT

from inerter.app.about import about
from inerter.formatting import choose_scale, format_number, typeset, typeset_unit

FIXTURE = ROOT / "web/tests/numbers.json"
DIGITS, UNITS = (2, 3, 4, 5), ("N/m", "N s/m", "kg", "m", "m/N", "N", "m/s^2")
EDGES = [0.0, 1.0, 10.0, 1e4, 123456.0, 1234567.0, 999999.6, 1e6, 12345678.9, 1e9, 1e-3, 1e-4, 9.99999e-5, 0.05, 1e-5]


def fixture() -> dict[str, Any]:
    """Texts of numbers by digits, the units of the page's table, and units that suit sizes."""
    chance = random.Random(83)
    values = [sign * 10 ** chance.uniform(-12.0, 12.0) for sign in (1.0, -1.0) for _ in range(100)] + EDGES
    scales = [(unit, abs(value), choose_scale([value], unit)) for unit in UNITS for value in values[::4]]
    return {
        "numbers": [[value, digits, typeset(format_number(value, digits))] for value in values for digits in DIGITS],
        "units": about()["units"],
        "suited": [[unit, size, scale.factor, typeset_unit(scale.unit)] for unit, size, scale in scales],
    }


if __name__ == "__main__":
    FIXTURE.write_text(json.dumps(fixture()).replace("], [", "],\n[") + "\n", encoding="utf-8")
