"""Lines of the symbols of elements, in points (1/72 inch) around their middle."""

from __future__ import annotations

from math import cos, pi, sin

Point = tuple[float, float]
SymbolLine = tuple[Point, ...]

HALF_WIDTH, HALF_HEIGHT = 8.0, 20.0  # of a symbol with its leads


def circle(x: float, y: float, radius: float) -> SymbolLine:
    """A circle as a line."""
    angles = [2.0 * pi * i / 60 for i in range(61)]
    return tuple((x + radius * cos(angle), y + radius * sin(angle)) for angle in angles)


_PITCH = 24.0 / 7
COIL: SymbolLine = (  # seen from the side, with its leads
    (0.0, HALF_HEIGHT),
    (0.0, 12.0),
    *((6.5 * (-1) ** i, 12.0 - (i + 0.5) * _PITCH) for i in range(7)),
    (0.0, -12.0),
    (0.0, -HALF_HEIGHT),
)
BOX: tuple[SymbolLine, ...] = (  # for elements without a symbol
    ((-8.0, 9.0), (-8.0, -9.0), (8.0, -9.0), (8.0, 9.0), (-8.0, 9.0)),
    ((0.0, 20.0), (0.0, 9.0)),
    ((0.0, -9.0), (0.0, -20.0)),
)
