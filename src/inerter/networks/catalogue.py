"""Layouts from the literature: expressions for the parser, with their sources."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Layout:
    """A strut layout by name. The names in its expression are those of its elements."""

    name: str
    expression: str
    source: str


_WANG_SU = "Wang and Su (2008), Figure 1"
_SMITH_WANG = "Smith and Wang (2004), layouts S1 to S8 by their admittances"

LAYOUTS: dict[str, Layout] = {
    row.name: row
    for row in (
        Layout("S1", "k | c", _WANG_SU),
        Layout("S2", "k | c | b", _WANG_SU),
        Layout("S3", "k | c - b", _WANG_SU),
        Layout("SW1", "K | c", _SMITH_WANG),
        Layout("SW2", "K | kb - c", _SMITH_WANG),
        Layout("SW3", "K | c | b", _SMITH_WANG),
        Layout("SW4", "K | kb - (c | b)", _SMITH_WANG),
        Layout("SW5", "K | c - b", _SMITH_WANG),
        Layout("SW6", "K | kb - c - b", _SMITH_WANG),
        Layout("SW7", "K | (c | k1) - (b | k2)", _SMITH_WANG),
        Layout("SW8", "K | kb - (c | k1) - (b | k2)", _SMITH_WANG),
        Layout("ball-screw", "(ks | cs) - gap - (b | f)", "Wang and Su (2008), Figure 6b"),
    )
}
