"""Netlists of struts: force is current, velocity voltage, and so a spring k is 1/k H, a damper 1/c ohm, an inerter b F.

Each strut is a subcircuit between the nodes `upper` and `lower`, whose admittance is that of the strut [N s/m].
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import count

from inerter.errors import ExportError
from inerter.exports.kind import ExportKind
from inerter.exports.kinds.matlab import exact
from inerter.exports.request import ExportSpec
from inerter.networks.elements import Element, Network
from inerter.networks.elements.roles import LinearRole
from inerter.networks.transform import parts_between

_LETTERS = {LinearRole.STIFFNESS: "L", LinearRole.DAMPING: "R", LinearRole.MASS: "C"}
_WORD = re.compile(r"[^A-Za-z0-9_]")


def _make(request: ExportSpec, suffix: str) -> str:
    found, notes = request.linear_networks()
    networks = dict(zip(_subcircuit_names(list(found)), found.values(), strict=True))
    head = [f"* {' '.join((request.title or 'struts').split())}, written by inerter"]
    if len(networks) > 1 or request.title:
        head.append(f"* subcircuits: {', '.join(networks)}")
    head += [
        "* force [N] is current [A], velocity [m/s] is voltage [V]",
        "* spring k: inductor 1/k; damper c: resistor 1/c; inerter b: capacitor b",
        "* loops of springs have no operating point; analyse with .options noopac",
    ]
    head += [f"* {note}" for note in notes]
    return "\n".join([*head, *(line for one in networks.items() for line in subcircuit(*one)), ""])


def subcircuit(name: str, network: Network) -> list[str]:
    """Lines of the subcircuit of a linear network without free values."""
    lines = list(_Netlist().lines(network, "upper", "lower"))
    return [f".subckt {name} upper lower", *lines, f".ends {name}"]


def _subcircuit_names(names: Sequence[str]) -> list[str]:
    """Names of subcircuits: those that differ by capitals alone are numbered all, so that none stands for another."""
    small = [name.lower() for name in names]
    numbered = [f"{name}_{small[: i + 1].count(name.lower())}" for i, name in enumerate(names)]
    different = _Names()
    told = (new if small.count(name.lower()) > 1 else name for name, new in zip(names, numbered, strict=True))
    return [different.add(name) for name in told]


class _Names:
    """Names in the syntax of SPICE, which does not tell capital letters from others, each different."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def add(self, name: str) -> str:
        """The name, with a number if it is taken."""
        stem = _WORD.sub("_", name)
        numbered = (stem if number == 1 else f"{stem}_{number}" for number in count(1))
        made = next(one for one in numbered if one.lower() not in self._taken)
        self._taken.add(made.lower())
        return made


class _Netlist:
    """Names of inner nodes and of parts, each once."""

    def __init__(self) -> None:
        self._nodes = 0
        self._names = _Names()

    def lines(self, network: Network, upper: str, lower: str) -> Iterator[str]:
        if isinstance(network, Element):
            yield self._part(network, upper, lower)
            return
        parts = parts_between(network, upper, lower, self._node)
        if not parts:
            raise ExportError(f"A netlist has no part for {network!r}.")
        for part in parts:
            yield from self.lines(*part)

    def _node(self, number: int) -> str:
        self._nodes += 1
        return f"n{self._nodes}"

    def _part(self, element: Element, upper: str, lower: str) -> str:
        letter, number = _LETTERS[element.linear], element.coefficient
        value = number if letter == "C" else 1.0 / number
        return f"{self._names.add(f'{letter}{element.label}')} {upper} {lower} {exact(value)}"


SPICE = ExportKind(
    "spice", "netlists of the struts, force as current", (".cir", ".sp"), _make, takes=("linear", "part")
)
