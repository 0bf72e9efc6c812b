"""Free networks in files: `{ network = 4, springs = { from = "1 kN/m", to = "1 MN/m" } }` among the elements."""

from __future__ import annotations

from typing import Any

from inerter.files.common.codec import Declaration, TableCodec, attributes, section
from inerter.files.common.entries import (
    YES_OR_NO,
    Amount,
    positive,
    range_between,
    range_codec,
    whole,
)
from inerter.files.common.problem import EntryError
from inerter.networks.elements import Damper, Element, Inerter, Spring
from inerter.networks.free_network import FreeNetwork

NETWORK = "network"
EXAMPLE_LINE = 'any = { network = 4, springs = { from = "1 kN/m", to = "10 MN/m" } } in [elements]'
_MOST = 7  # elements
_FEW = 3  # elements of a network that a search finds in minutes
_KINDS: dict[str, tuple[type[Element], str, str]] = {
    "springs": (Spring, "1 kN/m", "10 MN/m"),
    "dampers": (Damper, "10 N s/m", "1 MN s/m"),
    "inerters": (Inerter, "10 g", "100 t"),
}


def is_free_network(raw: Any) -> bool:
    """Whether an entry of a file is one of a free network."""
    return isinstance(raw, dict) and NETWORK in raw


def new_free_network() -> dict[str, Any]:
    """Entry of a free network to begin with: of few elements of each kind, within bounds that are wide for any vehicle.

    >>> new_free_network()["springs"]
    {'from': '1 kN/m', 'to': '10 MN/m'}
    """
    bounds = {kinds: {"from": lower, "to": upper} for kinds, (_, lower, upper) in _KINDS.items()}
    return {NETWORK: _FEW, **bounds}


def _bounds_codec(kinds: str) -> TableCodec:
    """The least and the largest value of the elements of a kind."""
    kind, lower, upper = _KINDS[kinds]

    def bounds(lower: float, upper: float) -> tuple[float, float]:
        range_between(Amount(kind.unit, lower), Amount(kind.unit, upper))
        return lower, upper

    return range_codec(positive(kind.unit), lower, upper, bounds)


def _kind_keys() -> list[Declaration]:
    bounds = [
        section(
            name,
            _bounds_codec(name),
            f"Bounds of each of the {name} of a free network; no {name} if left out.",
            f'{name} = {{ from = "{lower}", to = "{upper}" }}',
            None,
        )
        for name, (_, lower, upper) in _KINDS.items()
    ]
    counts = [
        section(f"{name}_at_most", whole(0, _MOST), f"Largest number of {name}.", f"{name}_at_most = 2", None)
        for name in _KINDS
    ]
    return bounds + counts


def _free_network(**values: Any) -> FreeNetwork:
    if all(values[name] is None for name in _KINDS):
        name, (_, lower, upper) = next(iter(_KINDS.items()))
        expected = f'bounds of one or more kinds, such as {name} = {{ from = "{lower}", to = "{upper}" }}'
        raise EntryError(got="a free network without elements", expected=expected)
    if values["min_elements"] > values["max_elements"]:
        given = f"at_least = {values['min_elements']}, network = {values['max_elements']}"
        raise EntryError(got=given, expected="at_least no more than network")
    return FreeNetwork(**values)


FREE_NETWORK = TableCodec(
    (
        Declaration(
            whole(1, _MOST),
            "Largest number of elements of a free network, all of whose networks inerter search compares.",
            "network = 4",
            name=NETWORK,
            attribute="max_elements",
        ),
        Declaration(
            whole(1, _MOST), "Least number of elements.", "at_least = 2", 1, name="at_least", attribute="min_elements"
        ),
        *_kind_keys(),
        section(
            "bridges", YES_OR_NO, "Whether networks with bridges of five arms are included.", "bridges = true", False
        ),
    ),
    _free_network,
    attributes,
    about="A free network: inerter search finds the best one of all that some elements can form.",
)
