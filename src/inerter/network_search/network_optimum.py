"""The optimum of one network of a search, as plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

from inerter.networks.enumeration import Topology


@dataclass(frozen=True)
class SearchedNetwork:
    """The optimum of one network: its value [SI] and those of its elements, or the reason why there is none."""

    topology: Topology
    n_starts: int = 0
    n_converged: int = 0
    value: float = inf
    values: tuple[float, ...] = ()  # of the elements in the order of the expression
    others: dict[str, float] = field(default_factory=dict)  # free values beside the network
    reason: str = ""  # why there is no value, or why it is not certain
