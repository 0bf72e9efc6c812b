"""What several tests of exports use."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def examples() -> str:
    return str(Path(__file__).parents[2] / "examples")
