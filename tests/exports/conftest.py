"""What several tests of exports use."""

from __future__ import annotations

import pytest
from folders import EXAMPLES


@pytest.fixture(scope="session")
def examples() -> str:
    return str(EXAMPLES)
