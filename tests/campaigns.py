"""Which parts of a campaign are run with the marker `campaign`; all of them are with `campaign or marathon`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest


def in_parts(parts: Sequence[Any], kept: int) -> list[Any]:
    """Parameters of which about so many, evenly spread, are a campaign, and the others a marathon."""
    every = -(-len(parts) // kept)
    return [
        pytest.param(part, marks=pytest.mark.marathon if i % every else pytest.mark.campaign)
        for i, part in enumerate(parts)
    ]
