"""What several tests of exports use."""

from __future__ import annotations

import pytest
from folders import EXAMPLES

from inerter.exports.kinds.fmu import platforms


@pytest.fixture(scope="session")
def examples() -> str:
    return str(EXAMPLES)


@pytest.fixture
def unoptimised(monkeypatch: pytest.MonkeyPatch) -> None:
    """Libraries of FMUs compile in a third of the time; the motions of `test_fmu.py` are of those that users get."""
    options = tuple("-O0" if option == "-O2" else option for option in platforms._OPTIONS)
    assert options != platforms._OPTIONS
    monkeypatch.setattr(platforms, "_OPTIONS", options)
