"""Which members of a family are always tested, and which with the marker `campaign` or `marathon`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Any

import pytest


def sampled(members: Iterable[Any], always: Collection[Any], seldom: Collection[Any] = ()) -> list[Any]:
    """Parameters of which some are tested always, some `seldom`, in a marathon, and the others in a campaign.

    A tuple is several parameters.
    """
    members = list(members)
    assert all(member in members for member in [*always, *seldom])
    other = {True: pytest.mark.marathon, False: pytest.mark.campaign}
    return [
        pytest.param(
            *(member if isinstance(member, tuple) else (member,)),
            marks=[] if member in always else [other[member in seldom]],
        )
        for member in members
    ]


def in_parts(parts: Sequence[Any], kept: int) -> list[Any]:
    """Parameters of which about so many, evenly spread, are a campaign, and the others a marathon; as `sampled`."""
    every = -(-len(parts) // kept)
    return [
        pytest.param(
            *(part if isinstance(part, tuple) else (part,)),
            marks=pytest.mark.marathon if i % every else pytest.mark.campaign,
        )
        for i, part in enumerate(parts)
    ]
