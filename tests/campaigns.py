"""Which members of a family are always tested, and which with the marker `campaign` or `marathon`."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def sampled(
    members: Iterable[Any],
    always: Collection[Any] = (),
    seldom: Collection[Any] = (),
    *,
    often: Collection[Any] = (),
    kept: int | None = None,
) -> list[Any]:
    """Parameters of which some are tested always, some `seldom`, in a marathon, and the others in a campaign.

    Of a family with many members the campaign takes those that are named as `often`, and about so many of the others
    as are to be `kept`, evenly spread; the rest are a marathon. A tuple is several parameters.
    """
    members = list(members)
    assert all(member in members for member in [*always, *seldom, *often])
    others = [member for member in members if member not in [*always, *seldom, *often]]
    spread = others if kept is None else [others[i * len(others) // kept] for i in range(kept)]
    campaign = [*often, *spread]
    return [
        pytest.param(
            *(member if isinstance(member, tuple) else (member,)),
            marks=[] if member in always else pytest.mark.campaign if member in campaign else pytest.mark.marathon,
        )
        for member in members
    ]
