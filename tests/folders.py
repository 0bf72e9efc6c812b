"""The folders of the repository that tests read, and the examples as tables."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"


def example_tables(name: str) -> dict[str, Any]:
    """The tables of the example file of that name."""
    return tomllib.loads((EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"))
